"""What a case gives back, and how its times are taken."""

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

TOLERANCES = tuple(10.0 ** (-half / 2) for half in range(8, 27))
"""Tried from the loosest on, until the error is small enough."""
REPEATS = 7


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One solver on one case."""

    solver: str
    tolerance: float
    """The loosest tolerance that keeps the error below that of the case."""
    error: float
    """Relative error against the closed form or the reference."""
    first: float
    """Time of the first run of the process, at the loosest tolerance [s]: imports and equations."""
    times: tuple[float, ...]
    """Times of the runs after it [s]."""

    @property
    def median(self) -> float:
        return statistics.median(self.times)


@dataclass(frozen=True, kw_only=True)
class Result:
    """One case: solvers at the same error, stickslip first."""

    title: str
    what: str
    """What is computed, and what the error is measured against."""
    error: float
    """The relative error that every solver must stay below."""
    entries: tuple[Entry, ...]


def at_error(
    solver: str,
    run: Callable[[float], object],
    error_of: Callable[[object], float],
    largest: float,
    repeats: int = REPEATS,
) -> Entry:
    """Time a solver at the loosest tolerance whose error is small enough.

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
    repeats : int
        Timed runs.
    """
    first = None
    for tolerance in TOLERANCES:
        start = time.perf_counter()
        found = run(tolerance)
        first = time.perf_counter() - start if first is None else first
        error = error_of(found)
        if error <= largest:
            break
    else:
        raise ArithmeticError(f"{solver} does not reach an error of {largest:g}.")
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        run(tolerance)
        times.append(time.perf_counter() - start)
    return Entry(solver=solver, tolerance=tolerance, error=error, first=first, times=tuple(times))


def largest_error(found: Sequence[float], exact: Sequence[float]) -> float:
    """Return the largest relative difference; infinite where the numbers are not as many."""
    if len(found) != len(exact):
        return float("inf")
    return max(abs(f - e) / abs(e) for f, e in zip(found, exact, strict=True))
