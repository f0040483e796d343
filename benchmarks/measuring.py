"""What a case gives back, and how its times are taken."""

import functools
import importlib.util
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from benchmarks.kernel import Kernel
from stickslip import EventDriven, simulate
from stickslip.engine import Trajectory
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism

TOLERANCES = tuple(10.0 ** (-half / 2) for half in range(8, 27))
"""Tried from the loosest on, until the error is small enough."""
REPEATS = 7
MANY = 60
"""Runs of which the least time counts, so that some of them find the machine quiet."""
BUDGET = 5.0
"""After this many seconds an entry is not run again, however few its runs were."""
BATCH = 0.01
"""A run shorter than this is repeated, and its mean time counts [s]."""
METHODS = ("DOP853", "LSODA", "Radau")
"""SciPy's, where modes and events are coded by hand."""
KERNEL = "stickslip, kernel alone"
TIERS = {
    "compiled": "stickslip, whole simulate(...) call",
    "python": "stickslip, the same in plain Python",
}


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One solver on one case."""

    solver: str
    tolerance: float
    """The loosest tolerance that keeps the error below that of the case."""
    error: float
    """Relative error against the closed form or the reference."""
    first: float
    """Time of the first run of the process [s]: imports, equations, machine code."""
    run: Callable[[], object] = field(repr=False, compare=False)
    """Runs it again."""
    times: tuple[float, ...] = ()
    """Processor times of the runs after the first [s]."""

    @property
    def time(self) -> float:
        """The least: other work on the machine lengthens it least [s]."""
        return min(self.times)


@dataclass(frozen=True, kw_only=True)
class Missing:
    """A solver without numbers."""

    solver: str
    word: str = "not installed"
    reason: str
    """Why, in words."""


@dataclass(frozen=True, kw_only=True)
class Target:
    """What a piece of work was meant to take, and what it takes."""

    work: str
    goal: str
    measured: str
    met: bool
    reason: str
    """Why it is missed, if it is."""


@dataclass(frozen=True, kw_only=True)
class Section:
    """A part of the page with a table of its own."""

    title: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...]
    targets: tuple[Target, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Result:
    """One case: solvers at the same error, stickslip first."""

    title: str
    what: str
    """What is computed, and what the error is measured against."""
    error: float
    """The relative error that every solver must stay below."""
    entries: tuple[Entry | Missing, ...]
    targets: tuple[Target, ...] = ()


def at_error(
    solver: str,
    run: Callable[[float], object],
    error_of: Callable[[object], float],
    largest: float,
) -> Entry:
    """Run a solver at the loosest tolerance whose error is small enough; its times come later.

    Parameters
    ----------
    solver : str
        What to call it.
    run : callable
        Runs it with a relative tolerance.
    error_of : callable
        Relative error of what `run` returned; not timed.
    largest : float
        Largest error that will do.
    """
    start, first = time.perf_counter(), None
    for tolerance in TOLERANCES:
        result = run(tolerance)
        first = time.perf_counter() - start if first is None else first
        error = error_of(result)
        if error <= largest:
            break
    else:
        raise ArithmeticError(f"{solver} does not reach an error of {largest:g}.")
    return Entry(
        solver=solver, tolerance=tolerance, error=error, first=first, run=lambda: run(tolerance)
    )


def with_times(
    entries: Sequence[object], repeats: int, clock: Callable[[], float] = time.perf_counter
) -> tuple[object, ...]:
    """Return entries with their times, taken in turns: a busy machine is busy for all of them."""
    times: list[list[float]] = [[] for _ in entries]
    spent = [0.0] * len(entries)
    for _ in range(repeats):
        for i, entry in enumerate(entries):
            if not isinstance(entry, Missing) and spent[i] < BUDGET:
                start = clock()
                times[i].append(mean_time(entry.run, clock))
                spent[i] += clock() - start
    return tuple(
        entry if isinstance(entry, Missing) else replace(entry, times=tuple(results))
        for entry, results in zip(entries, times, strict=True)
    )


def mean_time(run: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """Return the time of a run by a clock [s]."""
    runs, passed, start = 0, 0.0, clock()
    while passed < BATCH:
        run()
        runs, passed = runs + 1, clock() - start
    return passed / runs


def own_entries(
    mechanism: Mechanism,
    law: FrictionLaw,
    t_end: float,
    error_of: Callable[[Trajectory], float],
    error_of_kernel: Callable[[Kernel], float],
    largest: float,
    tiers: Sequence[str],
    setting: str = "tolerance",
) -> tuple[Entry, ...]:
    """Return stickslip's entries: the kernel, then whole calls; `setting` is what counts."""

    @functools.cache
    def kernel() -> Kernel:
        return Kernel(mechanism, law, t_end)

    def call(tier: str, tolerance: float) -> Trajectory:
        solver = EventDriven(tier=tier, **{setting: tolerance})
        return simulate(mechanism, law, t_end=t_end, solver=solver, throw=False)

    def entry(tier: str) -> Entry:
        return at_error(TIERS[tier], functools.partial(call, tier), error_of, largest)

    whole = tuple(entry(tier) for tier in tiers)
    if "compiled" not in tiers:
        return whole
    alone = at_error(KERNEL, lambda tolerance: kernel().run(tolerance), error_of_kernel, largest)
    return (alone, *whole)


def faster(
    work: str, least: float, entries: Sequence[object], peer: str, reason: str
) -> tuple[Target, ...]:
    """Return the target of being some times faster than a peer, or nothing without a kernel."""
    times = {e.solver: e.time for e in entries if not isinstance(e, Missing)}
    (other,) = (solver for solver in times if solver.startswith(peer))
    if KERNEL not in times:
        return ()
    ratio = times[other] / times[KERNEL]
    return (
        Target(
            work=work, goal=f">= {least:g} x {peer}", measured=f"{ratio:.0f} x",
            met=ratio >= least, reason=reason,
        ),
    )  # fmt: skip


def within(
    work: str, most: float, entries: Sequence[object], unit: str, reason: str
) -> tuple[Target, ...]:
    """Return the target of a time of the kernel in "us" or "ms", or nothing without a kernel."""
    times = {e.solver: e.time for e in entries if not isinstance(e, Missing)}
    if KERNEL not in times:
        return ()
    value = times[KERNEL] * {"us": 1e6, "ms": 1e3}[unit]
    return (
        Target(
            work=work, goal=f"<= {most:g} {unit}", measured=f"{value:.3g} {unit}",
            met=value <= most, reason=reason,
        ),
    )  # fmt: skip


def if_installed(library: str, solver: str, make: Callable[[], Entry]) -> Entry | Missing:
    """Return the entry of a library that a reader need not have."""
    if importlib.util.find_spec(library) is None:
        return Missing(solver=solver, reason=f"`pip install {library}`")
    return make()


def by_hand(
    heyoka: Callable[[float], object],
    scipy: Callable[[str, float], object],
    error_of: Callable[[object], float],
    largest: float,
) -> tuple[Entry | Missing, ...]:
    """Return the entries of the solvers whose modes and events are coded by hand."""
    name = "heyoka, modes and events by hand"
    return (
        if_installed("heyoka", name, lambda: at_error(name, heyoka, error_of, largest)),
        *(
            at_error(
                f"SciPy {method}, events by hand", functools.partial(scipy, method),
                error_of, largest,
            )
            for method in METHODS
        ),
    )  # fmt: skip


def largest_error(found: Sequence[float], exact: Sequence[float]) -> float:
    """Return the largest relative difference; infinite where the numbers are not as many."""
    if len(found) != len(exact):
        return float("inf")
    return max(abs(f - e) / abs(e) for f, e in zip(found, exact, strict=True))
