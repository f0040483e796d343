"""The force at which a body breaks away: against how fast it grows, and how long it rested."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from typing_extensions import override

from stickslip.characterization.base import Characteristic
from stickslip.characterization.bench import Array, Bench, there_and_back
from stickslip.drives import Ramp
from stickslip.errors import SimulationError
from stickslip.formatting import quantity
from stickslip.mechanisms import Axis
from stickslip.simulation import simulate
from stickslip.solver import EventDriven
from stickslip.trajectory import Trajectory

RATES = (2.0 / 3.0, 4.0 / 3.0, 20.0 / 3.0, 20.0)
"""Rates of force over break-away [1/s]."""
DWELLS = (0.1, 1.0, 10.0, 100.0)
"""Times at rest [s]."""
FINE = 4001
"""Times at which a peak is looked at."""
ALIKE = 0.01
"""Share by which peaks have to differ to depend on anything."""
MOST_STEPS = 100_000
"""Steps after which a run with a rest is given up: some laws switch without end at rest."""
FALL = 0.005
"""Share of the largest force by which it has to fall after a peak."""
GONE = 20.0
"""Presliding lengths that a body slides before it rests, and after."""


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class BreakAway(Characteristic):
    """Peaks of friction as a body breaks away."""

    test: ClassVar[str] = "break-away"
    title: ClassVar[str] = "Break-away"
    columns: ClassVar[Mapping[str, str]] = {"rate": "N/s", "dwell": "s", "force": "N"}

    rate: Array
    """Rates at which the force grows (n,) [N/s]."""
    force: Array
    """Peak of friction at each rate (n,) [N]; NaN where friction has none."""
    dwell: Array
    """Times at rest (m,) [s]."""
    force_after: Array
    """Peak of friction after each (m,) [N]; NaN where friction has none, or switches without end at
    rest."""

    @property
    @override
    def sentence(self) -> str:
        if np.isnan(self.force).all():
            return (
                "Friction has no peak at break-away: the body creeps or deflects into sliding, and"
                " no threshold is met."
            )
        peaked = ~np.isnan(self.force)
        seen = self.force[peaked]
        if np.ptp(seen) > ALIKE * seen.max():
            slow, fast = (quantity(self.rate[peaked][i], "N/s") for i in (0, -1))
            verb = "falls" if seen[-1] < seen[0] else "rises"
            by_rate = (
                f"Break-away {verb} from {quantity(seen[0], 'N', 4)} at {slow} to"
                f" {quantity(seen[-1], 'N', 4)} at {fast}: a static level measured by hand does"
                " not hold for fast starts."
            )
        else:
            by_rate = (
                f"Break-away takes {quantity(seen.max(), 'N', 4)} however fast the force grows."
            )
        after = self.force_after[~np.isnan(self.force_after)]
        if len(after) > 1 and np.ptp(after) > ALIKE * after.max():
            return (
                f"{by_rate} It goes from {quantity(after[0], 'N')} after"
                f" {quantity(self.dwell[0], 's')} at rest to {quantity(after[-1], 'N')} after"
                f" {quantity(self.dwell[-1], 's')}."
            )
        return f"{by_rate} The time at rest does not matter." if len(after) else by_rate

    @override
    def _values(self) -> Mapping[str, Array]:
        """Return a row for each rate, then for each time at rest."""
        return {
            "rate": np.append(self.rate, np.full(len(self.dwell), np.nan)),
            "force": np.append(self.force, self.force_after),
            "dwell": np.append(np.full(len(self.rate), np.nan), self.dwell),
        }


def break_away(
    bench: Bench, *, rates: Sequence[float] | None = None, dwells: Sequence[float] = DWELLS
) -> BreakAway:
    """Pull a body with forces that grow at several rates, and after several times at rest.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> [round(float(one), 6) for one in break_away(Bench(law=law), rates=(1.0, 30.0)).force]
    [1.5, 1.5]
    """
    top = bench.force
    rates = [top * one for one in RATES] if rates is None else rates
    return BreakAway(
        rate=np.array(rates, dtype=np.float64),
        force=np.array([_pulled(bench, rate) for rate in rates]),
        dwell=np.array(dwells, dtype=np.float64),
        force_after=np.array([_rested(bench, dwell) for dwell in dwells]),
        conditions=(
            f"{quantity(bench.mass, 'kg')} pulled by a growing force; normal force"
            f" {quantity(bench.load, 'N')}. After rest: moved at up to"
            f" {quantity(0.1 * bench.speed, 'm/s')}."
        ),
    )


def _pulled(bench: Bench, rate: float) -> float:
    """Return the first peak of friction under a force that grows."""
    if not bench.sticks:
        return float("nan")
    axis = Axis(inertia=bench.mass, drive=Ramp(rate=rate), load=bench.load)
    run = simulate(bench.on(axis), bench.law, t_end=2.0 * bench.levels[1] / rate)
    for event in run.events:
        if event.reason == "break-away":
            return float(rate * event.t)
    return _first_peak(run, run.t)


def _rested(bench: Bench, dwell: float) -> float:
    """Return the peak of friction as a body goes on that was stopped."""
    if not bench.sticks:
        return float("nan")
    way = GONE * bench.reach
    speeds = (10.0 * bench.speed, 0.1 * bench.speed)
    path, arrivals = there_and_back([way, 2.0 * way], speeds, [dwell, 0.0])
    try:
        run = simulate(
            bench.guided(path),
            bench.law,
            t_end=arrivals[-1],
            y0=bench.deflected(),
            solver=EventDriven(max_steps=MOST_STEPS),
        )
    except SimulationError:
        return float("nan")
    again = arrivals[0] + dwell
    for event in run.events:
        if event.reason == "break-away" and event.t >= again:
            return float(run.at([event.t])["pull"][0])
    last = again + 0.5 * (arrivals[-1] - again)  # as far as the body is not slowed down
    times = np.union1d(np.linspace(again, last, FINE), run.t[(run.t > again) & (run.t < last)])
    return _first_peak(run, times[times <= run.span[1]])


def _first_peak(run: Trajectory, times: Array) -> float:
    """Return the first peak of friction at some times and between them; NaN if there is none."""
    force = run.at(times)["friction"]
    least = 1e-9 * np.abs(force).max()
    inner = (force[1:-1] > force[:-2] + least) & (force[1:-1] >= force[2:])
    lowest_later = np.minimum.accumulate(force[::-1])[::-1][2:]
    falls = lowest_later < force[1:-1] - FALL * np.abs(force).max()
    found = np.flatnonzero(inner & falls)
    if not len(found):
        return float("nan")
    i = int(found[0]) + 1
    near = np.linspace(times[max(i - 2, 0)], times[min(i + 2, len(times) - 1)], FINE)
    return float(run.at(near)["friction"].max())
