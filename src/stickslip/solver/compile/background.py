"""Compiles in a process of its own what runs would have to wait for."""

import contextlib
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from stickslip.solver.compile.codegen import contacts_text, kernels_text
from stickslip.solver.compile.compile_units import CompileUnit
from stickslip.solver.compile.module_cache import cache_directory, is_writable

__all__ = ["compile_in_background", "main"]

SWITCH = "STICKSLIP_BACKGROUND"
"""Variable of the environment that forbids the process if it is 0."""
POLITE = 10
"""How much less urgent than this one the process is."""

_begun: set[CompileUnit] = set()


def compile_in_background(units: Sequence[CompileUnit]) -> bool:
    """Begin to compile units in another process, once; return whether that is being done.

    The process ends by itself; what it compiled is found in the cache by whoever asks later. Where
    the cache cannot be written to there is none, nor where ``STICKSLIP_BACKGROUND`` is 0.

    Parameters
    ----------
    units : sequence of CompileUnit
        What is not compiled yet.

    Returns
    -------
    bool
        Whether a process was begun for all of them, now or earlier.
    """
    new = [unit for unit in units if unit not in _begun]
    if not new:
        return True
    if os.environ.get(SWITCH) == "0" or not _is_python() or not is_writable():
        return False
    wanted = json.dumps([[unit.text == kernels_text(), list(unit.entries)] for unit in new])
    try:
        subprocess.Popen(
            [sys.executable, "-c", f"from {__name__} import main; main()", wanted],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=cache_directory(),  # where nobody else's modules lie
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        )
    except OSError:
        return False
    _begun.update(new)
    return True


def _is_python() -> bool:
    """Whether what runs is an interpreter, and no program that holds one."""
    return Path(sys.executable or "").name.startswith(("python", "pypy"))


def main() -> None:
    """Compile the units that the command line names."""
    with contextlib.suppress(AttributeError, OSError):
        os.nice(POLITE)
    for kernels, entries in json.loads(sys.argv[1]):
        text = kernels_text() if kernels else contacts_text()
        CompileUnit("", text, tuple(entries)).load()
