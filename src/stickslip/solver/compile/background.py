"""Compiles in a process of its own what runs would have to wait for."""

import atexit
import contextlib
import json
import multiprocessing
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
ON_WINDOWS = ("CREATE_NO_WINDOW", "BELOW_NORMAL_PRIORITY_CLASS")
"""What makes it so on Windows, without a window of its own."""

_begun: dict[CompileUnit, subprocess.Popen[bytes]] = {}
"""Processes by what they compile."""


def compile_in_background(units: Sequence[CompileUnit]) -> bool:
    """Begin to compile units in another process, once; return whether that is being done.

    The process ends by itself; what it compiled is found in the cache by whoever asks later. There
    is none where the cache cannot be written to, nor in a worker of `multiprocessing`, nor where
    ``STICKSLIP_BACKGROUND`` is 0. One that has failed is not begun again.

    Parameters
    ----------
    units : sequence of CompileUnit
        What is not compiled yet.

    Returns
    -------
    bool
        Whether processes for all of them are at work.
    """
    new = [unit for unit in units if unit not in _begun]
    if not new:
        return all(_begun[unit].poll() is None for unit in units)
    if os.environ.get(SWITCH) == "0" or not _is_python() or not is_writable():
        return False
    if multiprocessing.parent_process() is not None:
        return False
    wanted = json.dumps([[unit.text == kernels_text(), list(unit.entries)] for unit in new])
    places = [str(Path(place).absolute()) for place in sys.path]
    try:
        process = subprocess.Popen(
            [sys.executable, "-c", f"from {__name__} import main; main()", wanted],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=cache_directory(),  # where nobody else's modules lie
            start_new_session=True,
            creationflags=sum(getattr(subprocess, name, 0) for name in ON_WINDOWS),
            env={**os.environ, "PYTHONPATH": os.pathsep.join(places)},
        )
    except OSError:
        return False
    _begun.update(dict.fromkeys(new, process))
    return True


@atexit.register
def _leave() -> None:
    """Let processes go on by themselves, without a warning that they still run."""
    for process in _begun.values():
        process.returncode = process.returncode or 0


def _is_python() -> bool:
    """Whether what runs is an interpreter, and no program that holds one."""
    name = Path(sys.executable or "").name.lower()
    return name.startswith(("python", "pypy")) and not getattr(sys, "frozen", False)


def main() -> None:
    """Compile the units that the command line names."""
    with contextlib.suppress(AttributeError, OSError):
        os.nice(POLITE)
    for kernels, entries in json.loads(sys.argv[1]):
        text = kernels_text() if kernels else contacts_text()
        CompileUnit("", text, tuple(entries)).load()
