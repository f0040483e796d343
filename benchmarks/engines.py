"""The pushed and held block in other engines: travel, creep, and time."""

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass, field

from benchmarks.block import by_stickslip
from benchmarks.block.problem import HEAVY, HOLD_TIME, LIGHT, TRAVEL, Run
from benchmarks.measuring import REPEATS, TIERS, Missing, with_times
from benchmarks.peers import Engine, StallError, found

UNTRIED = Missing(solver="Siconos", reason="not on PyPI; no run is written for it")


@dataclass(frozen=True, kw_only=True)
class Held:
    """One engine on the block."""

    solver: str
    levels: str
    """Which levels of friction it has."""
    travel_error: float
    """Place before the hold, relative to the closed form, less 1."""
    creep: float
    """Movement while held below both levels [m]."""
    slide: float
    """Movement while held between the two [m]."""
    first: float
    """Time to build the model and run it once [s]."""
    run: Run = field(repr=False, compare=False)
    """Runs it again."""
    times: tuple[float, ...] = ()
    """Times of the runs after the first [s]."""

    @property
    def time(self) -> float:
        """The median [s]."""
        return statistics.median(self.times)


@dataclass(frozen=True, kw_only=True)
class Holding:
    """The block in all engines, stickslip first."""

    entries: tuple[Held | Missing, ...]


def held(engine: Engine, seconds: float) -> Held | Missing:
    """Return what an engine makes of the block."""
    start = time.perf_counter()
    try:
        run = engine.build(LIGHT, seconds)
        light = run()
        first = time.perf_counter() - start
        heavy = engine.build(HEAVY, seconds)()
    except StallError as stall:
        return Missing(solver=engine.name, word="gave up", reason=str(stall))
    return Held(
        solver=engine.name,
        levels=engine.levels,
        travel_error=light.before / TRAVEL - 1,
        creep=light.after - light.before,
        slide=heavy.after - heavy.before,
        first=first,
        run=run,
    )


def run(
    repeats: int = REPEATS, tiers: Sequence[str] = tuple(TIERS), seconds: float = HOLD_TIME
) -> Holding:
    """Run the case; `seconds` is how long the block is held."""
    engines = [*by_stickslip.engines(tuple(tiers)), *found("block")]
    entries = [e if isinstance(e, Missing) else held(e, seconds) for e in engines]
    return Holding(entries=with_times((*entries, UNTRIED), repeats))
