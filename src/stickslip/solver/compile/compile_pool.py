"""Processes that compile for this one, and their supervision."""

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Any, final

from stickslip.errors import CompilationError
from stickslip.solver.compile.compile_units import CompileUnit

__all__ = ["Report", "compile_all"]

Report = Callable[[CompileUnit, bool | None], object]
"""Called with a part and whether it was compiled: None when it begins, False if it was there."""
Outcome = bool | Exception | None
LAST_WORDS = 2000
"""Characters of a dead process' last words that are worth printing."""


@final
class Process:
    """One Python process that compiles a part at a time.

    It is a program of its own and no fork, which threads would not survive; unlike the processes of
    `multiprocessing` it never runs the caller's script again.

    Parameters
    ----------
    python : str
        Path of the interpreter.

    Raises
    ------
    CompilationError
        If the process cannot be started.
    """

    def __init__(self, python: str) -> None:
        paths = [str(Path(path).resolve()) for path in sys.path]
        self._words = tempfile.TemporaryFile()  # noqa: SIM115  # closed in `stop`
        try:
            self._process = subprocess.Popen(
                [python, "-P", "-m", "stickslip.solver.compile.compile_worker"],
                env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._words,
                encoding="utf-8",
            )
        except OSError as error:
            self._words.close()
            raise CompilationError(f"no process for compilation can be started: {error}") from error

    def compile(self, part: CompileUnit) -> bool:
        """Compile or load a part there; return whether it was compiled."""
        task = {"title": part.title, "text": part.text, "entries": part.entries}
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps(task) + "\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except (OSError, ValueError):
            line = ""
        if not line:
            raise CompilationError(f"{self._end()} while compiling {part.title}.{self._said()}")
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise CompilationError(f"{part.title} cannot be compiled: {answer['error']}")
        return bool(answer["compiled"])

    def _end(self) -> str:
        code = self._process.wait()
        if code >= 0:
            return f"a compiling process ended with code {code}"
        hint = " (out of memory?)" if code == -signal.SIGKILL else ""
        return f"a compiling process was ended by signal {-code}{hint}"

    def _said(self) -> str:
        self._words.seek(0)
        words = self._words.read().decode("utf-8", "replace").strip()[-LAST_WORDS:]
        return f" Its last output:\n{words}" if words else ""

    def stop(self) -> None:
        """End it, whatever it does; what it has compiled so far is in the cache."""
        self._process.kill()
        self._process.wait()

    def close(self) -> None:
        """Let go of what belonged to it."""
        for pipe in (self._process.stdin, self._process.stdout, self._words):
            if pipe is not None:
                try:
                    pipe.close()
                except OSError:  # what was still to be written to a dead process
                    continue


def compile_all(parts: Sequence[CompileUnit], jobs: int, report: Report) -> None:
    """Compile parts in processes of their own, the first ones first.

    Parameters
    ----------
    parts : sequence of CompileUnit
        What is compiled, in this order.
    jobs : int
        Processes at a time.
    report : Report
        Called when a part begins, with None, and when it is done, with whether it was compiled;
        False if it was there.
    """
    python = _python()
    if python is None:
        for part in parts:
            report(part, None)
            report(part, part.load())
        return
    tasks: SimpleQueue[CompileUnit] = SimpleQueue()
    for part in parts:
        tasks.put(part)
    news: SimpleQueue[tuple[CompileUnit, Outcome]] = SimpleQueue()
    crew: list[Process] = []
    threads: list[Thread] = []
    try:
        for _ in range(min(jobs, len(parts))):
            crew.append(Process(python))
            threads.append(Thread(target=_work, args=(crew[-1], tasks, news), daemon=True))
            threads[-1].start()
        for part, outcome in _until_done(news, len(parts)):
            report(part, outcome)
    finally:
        for process in crew:
            process.stop()
        for thread in threads:
            thread.join()
        for process in crew:
            process.close()


def _work(
    process: Process,
    tasks: "SimpleQueue[CompileUnit]",
    news: "SimpleQueue[tuple[CompileUnit, Outcome]]",
) -> None:
    """Give a process task after task, and pass on what comes of them."""
    while True:
        try:
            part = tasks.get_nowait()
        except Empty:
            return
        news.put((part, None))
        try:
            news.put((part, process.compile(part)))
        except Exception as error:
            news.put((part, error))
            return


def _until_done(
    news: "SimpleQueue[tuple[CompileUnit, Outcome]]", count: int
) -> Iterator[tuple[CompileUnit, bool | None]]:
    """Yield what happens until all parts are there; raise what a process raised."""
    while count:
        part, outcome = news.get()
        if isinstance(outcome, Exception):
            raise outcome
        count -= outcome is not None
        yield part, outcome


def _python() -> str | None:
    """Return the interpreter, unless this one is built into another program."""
    name = sys.executable or ""
    frozen = getattr(sys, "frozen", False)
    return name if Path(name).name.lower().startswith("python") and not frozen else None
