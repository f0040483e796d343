"""Compiles the equations of many pairs at once, before anything waits for them."""

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
from stickslip.solver.compile.equations_code import code_of
from stickslip.solver.compile.image_cache import cache_directory, is_writable
from stickslip.solver.compile.kernels_code import KERNELS
from stickslip.solver.compile.modules import waiting
from stickslip.solver.compile.object_code import ObjectCode

Progress = Callable[[int, int, str], object]


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
