"""Compiles before anything waits: many pairs at once, or in a process of its own."""

import atexit
import contextlib
import dataclasses
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip.described import Described
from stickslip.errors import CompilationError, InputError
from stickslip.formulation import Model, formulate
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.solver.compile.equations_code import EquationsCode, code_of
from stickslip.solver.compile.image_cache import cache_directory, is_writable
from stickslip.solver.compile.kernels_code import KERNELS
from stickslip.solver.compile.modules import waiting
from stickslip.solver.compile.object_code import ObjectCode

Progress = Callable[[int, int, str], object]

SWITCH = "STICKSLIP_BACKGROUND"
"""Variable of the environment that forbids the process if it is 0."""
POLITE = 10
"""How much less urgent than this one the process is."""
ON_WINDOWS = ("CREATE_NO_WINDOW", "BELOW_NORMAL_PRIORITY_CLASS")
"""What makes it so on Windows, without a window of its own."""

_begun: list[subprocess.Popen[bytes]] = []
"""The process, once there is one."""


@dataclass(frozen=True, kw_only=True)
class WarmUp(metaclass=Described):
    """What a warm-up did: machine code is kept for the kernels, and for the equations of pairs."""

    kernels_compiled: bool
    """Whether the kernels, which all pairs share, were compiled, or else were there already."""
    equations_compiled: int
    """Pairs whose equations were compiled."""
    equations_found: int
    """Pairs whose equations were there already."""
    seconds: float
    """How long it took [s]."""
    folder: Path
    """Where the machine code is kept."""


def warm_up(
    pairs: Iterable[tuple[Mechanism, FrictionLaw]],
    *,
    progress: Progress | None = None,
) -> WarmUp:
    """Compile the equations of many mechanisms with their laws, and what all of them share.

    Afterwards this process has them, and others load them in tenths of a second. What is in the
    cache is left as it is. After an interrupt, what was finished stays in the cache.

    Parameters
    ----------
    pairs : iterable of (Mechanism, FrictionLaw)
        What will be run; only the structure counts, not the values of parameters.
    progress : callable, optional
        Called with the number of parts done and of all to compile, and the part in work, when one
        begins and when it is done.

    Returns
    -------
    WarmUp
        What was compiled and what was there already.

    Raises
    ------
    InputError
        If something has to be compiled and the cache directory cannot be written to.
    CompilationError
        If something could not be compiled, or the cache did not keep it.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> block = SpringBlock(mass=1.0, stiffness=100.0)
    >>> done = warm_up([(block, Coulomb(kinetic_coefficient=0.25))])  # doctest: +SKIP
    """
    start = time.perf_counter()
    models = [_formulated(pair) for pair in pairs]
    codes = list(dict.fromkeys(code_of(model) for model in models))
    parts: list[ObjectCode] = [KERNELS, *codes]
    absent = [part for part in parts if not part.is_kept()]
    compiled = _compiled(absent, progress) if absent else set()
    return WarmUp(
        kernels_compiled=KERNELS in compiled,
        equations_compiled=len(compiled.intersection(codes)),
        equations_found=len(set(codes) - compiled),
        seconds=time.perf_counter() - start,
        folder=cache_directory(),
    )


def _formulated(pair: Any) -> Model:
    """Return the model of a pair, checked."""
    match pair:
        case (Mechanism() as mechanism, FrictionLaw() as law):
            return formulate(mechanism, law)
    raise InputError(f"pairs must hold (mechanism, law), got {pair!r}.")


def _compiled(parts: Sequence[ObjectCode], progress: Progress | None) -> set[ObjectCode]:
    """Compile parts; return those that were really not there."""
    if not is_writable():
        raise InputError(
            f"{cache_directory()} cannot be written to, so machine code would be lost. Set"
            " STICKSLIP_CACHE to a writable folder."
        )
    if progress is None:
        waiting()
    new = set[ObjectCode]()
    for done, part in enumerate(parts):
        _tell(progress, done, len(parts), part)
        if part.load():
            new.add(part)
        if not part.is_kept():
            raise CompilationError(f"the cache did not keep {part.title}, which was compiled.")
        _tell(progress, done + 1, len(parts), part)
    return new


def _tell(progress: Progress | None, done: int, total: int, part: ObjectCode) -> None:
    if progress is not None:
        progress(done, total, part.title)


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
