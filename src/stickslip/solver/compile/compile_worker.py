"""A process that compiles parts: started as a program, told what to do line by line.

Tasks come as JSON on standard input and answers leave as JSON on standard output. It ends with its
input, so it outlives nobody, and leaves it to who started it to be interrupted.
"""

import json
import os
import signal
import sys

from stickslip.solver.compile.compile_units import CompileUnit

__all__ = ["serve"]


def serve() -> None:
    """Compile what the input asks for until it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # whatever libraries print is no answer
    for line in sys.stdin:
        print(json.dumps(_answer(**json.loads(line))), file=answers, flush=True)


def _answer(title: str, text: str, entries: list[str]) -> dict[str, object]:
    part = CompileUnit(title, text, tuple(entries))
    try:
        compiled = part.load()
    except Exception as error:
        return {"error": f"{type(error).__name__}: {error}"}
    return (
        {"compiled": compiled}
        if part.is_kept()
        else {"error": "the cache did not keep the compiled module"}
    )


if __name__ == "__main__":
    try:
        serve()
    except BrokenPipeError:  # nobody waits for the answer; the cache has what was compiled
        os._exit(1)
