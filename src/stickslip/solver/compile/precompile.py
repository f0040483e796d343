"""Compiles the equations of many pairs at once, before anything waits for them."""

import os
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip.errors import InputError
from stickslip.formulation import Model, formulate
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.solver.compile.compile_pool import compile_all
from stickslip.solver.compile.compile_units import CompileUnit, parts_of
from stickslip.solver.compile.module_cache import cache_directory, is_writable
from stickslip.solver.compile.modules import waiting

__all__ = ["Progress", "WarmUp", "warm_up"]

Progress = Callable[[int, int, str], object]


@dataclass(frozen=True, kw_only=True)
class WarmUp:
    """What a warm-up did: machine code is kept by module, the kernels or equations of a pair."""

    kernels_compiled: int
    """Modules of kernels that were compiled: one serves all pairs, one more several contacts."""
    kernels_found: int
    """Modules of kernels that were there already."""
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
    ensembles: bool = True,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> WarmUp:
    """Compile the equations of many mechanisms with their laws, in several processes.

    Afterwards this process and others load them in tenths of a second. What is in the cache is left
    as it is, and if all is, no process is started. An interrupt ends the processes; what they had
    finished stays in the cache.

    Parameters
    ----------
    pairs : iterable of (Mechanism, FrictionLaw)
        What will be run; only the structure counts, not the values of parameters.
    ensembles : bool
        Whether to compile what `stickslip.ensemble` needs, too: some seconds more, once.
    jobs : int, optional
        Number of processes; as many as there are cores if not given, and never more than there is
        to compile.
    progress : callable, optional
        Called with the number of modules done and of all to compile, and the pair in work, when one
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
        If a process died or could not compile something.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> block = SpringBlock(mass=1.0, stiffness=100.0)
    >>> done = warm_up([(block, Coulomb(kinetic_coefficient=0.25))])  # doctest: +SKIP
    """
    start = time.perf_counter()
    parts = _parts(pairs, ensembles=ensembles)
    processes = _checked(jobs)
    absent = [part for part in parts if not part.is_kept()]
    compiled = _compiled(absent, processes, progress) if absent else set()
    counts = {
        (shared, new): sum(p.is_shared == shared and (p in compiled) == new for p in parts)
        for shared in (True, False)
        for new in (True, False)
    }
    return WarmUp(
        kernels_compiled=counts[True, True],
        kernels_found=counts[True, False],
        equations_compiled=counts[False, True],
        equations_found=counts[False, False],
        seconds=time.perf_counter() - start,
        folder=cache_directory(),
    )


def _checked(jobs: int | None) -> int:
    if jobs is None:
        own: Callable[[int], set[int]] | None = getattr(os, "sched_getaffinity", None)
        return len(own(0)) if own is not None else os.cpu_count() or 1
    given: object = jobs
    if not isinstance(given, int) or isinstance(given, bool) or given < 1:
        raise InputError(f"jobs must be a whole number above 0, got {jobs!r}.")
    return given


def _parts(pairs: Iterable[tuple[Mechanism, FrictionLaw]], *, ensembles: bool) -> list[CompileUnit]:
    """Return each part once, kernels first since they take longest."""
    found: dict[str, CompileUnit] = {}
    for pair in pairs:
        for part in parts_of(_formulated(pair), ensembles=ensembles):
            found.setdefault(part.text, part)
    return sorted(found.values(), key=lambda part: not part.is_shared)


def _formulated(pair: Any) -> Model:
    """Return the model of a pair, checked."""
    match pair:
        case (Mechanism() as mechanism, FrictionLaw() as law):
            return formulate(mechanism, law)
    raise InputError(f"pairs must hold (mechanism, law), got {pair!r}.")


def _compiled(
    parts: Sequence[CompileUnit], jobs: int, progress: Progress | None
) -> set[CompileUnit]:
    """Compile parts; return those that were really not there."""
    if not is_writable():
        raise InputError(
            f"{cache_directory()} cannot be written to, so compiled modules would be lost. Set"
            " STICKSLIP_CACHE to a writable folder."
        )
    if progress is None:
        waiting(parts, min(jobs, len(parts)))
    done: dict[CompileUnit, bool] = {}

    def report(part: CompileUnit, outcome: bool | None) -> None:
        if outcome is not None:
            done[part] = outcome
        if progress is not None:
            progress(len(done), len(parts), part.title)

    compile_all(parts, jobs, report)
    return {part for part, new in done.items() if new}
