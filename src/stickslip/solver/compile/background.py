"""Compiles in a process of its own what runs would have to wait for."""

import atexit
import contextlib
import dataclasses
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from stickslip.solver.compile.equations_code import EquationsCode
from stickslip.solver.compile.image_cache import cache_directory, is_writable
from stickslip.solver.compile.kernels_code import KERNELS

SWITCH = "STICKSLIP_BACKGROUND"
"""Variable of the environment that forbids the process if it is 0."""
POLITE = 10
"""How much less urgent than this one the process is."""
ON_WINDOWS = ("CREATE_NO_WINDOW", "BELOW_NORMAL_PRIORITY_CLASS")
"""What makes it so on Windows, without a window of its own."""

_begun: list[subprocess.Popen[bytes]] = []
"""The process, once there is one."""


def compile_in_background(equations: EquationsCode) -> bool:
    """Begin to compile the kernels in another process, once; return whether that is being done.

    The process ends by itself; what it compiled is found in the cache by whoever asks later. There
    is none where the cache cannot be written to, nor in a worker of `multiprocessing`, nor where
    ``STICKSLIP_BACKGROUND`` is 0. One that has failed is not begun again.
    """
    if _begun:
        return _begun[0].poll() is None
    if os.environ.get(SWITCH) == "0" or not _is_python() or not is_writable():
        return False
    if multiprocessing.parent_process() is not None:
        return False
    places = [str(Path(place).absolute()) for place in sys.path]
    with contextlib.suppress(OSError), tempfile.TemporaryFile() as told:
        told.write(json.dumps(dataclasses.astuple(equations)).encode())
        told.seek(0)
        process = subprocess.Popen(
            [sys.executable, "-c", f"from {__name__} import main; main()"],
            stdin=told,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=cache_directory(),  # where nobody else's modules lie
            start_new_session=True,
            creationflags=sum(getattr(subprocess, name, 0) for name in ON_WINDOWS),
            env={**os.environ, "PYTHONPATH": os.pathsep.join(places)},
        )
        _begun.append(process)
    return bool(_begun)


@atexit.register
def _leave() -> None:
    """Let the process go on by itself, without a warning that it still runs."""
    for process in _begun:
        process.returncode = process.returncode or 0


def _is_python() -> bool:
    """Whether what runs is an interpreter, and no program that holds one."""
    name = Path(sys.executable or "").name.lower()
    return name.startswith(("python", "pypy")) and not getattr(sys, "frozen", False)


def main() -> None:
    """Compile the equations that stdin tells, and the kernels."""
    with contextlib.suppress(AttributeError, OSError):
        os.nice(POLITE)
    pair, program, numbers = json.load(sys.stdin)
    EquationsCode(pair, program, tuple((name, number) for name, number in numbers)).load()
    KERNELS.load()
