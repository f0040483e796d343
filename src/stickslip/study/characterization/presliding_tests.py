"""Tests before sliding: break-away by rate and dwell, drift, small loops."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from stickslip.engine.simulation import simulate
from stickslip.engine.solver import EventDriven
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, SimulationError
from stickslip.mechanisms import Axis
from stickslip.mechanisms.drives import Pulse, Ramp, Sine
from stickslip.show.formatting import quantity
from stickslip.study.characterization.bench import Array, Bench, Characteristic, there_and_back

# The force at which a body breaks away: against how fast it grows, and how long it rested.

RATES = (2.0 / 3.0, 4.0 / 3.0, 20.0 / 3.0, 20.0)
"""Rates of force over break-away [1/s]."""
DWELLS = (0.1, 1.0, 10.0, 100.0)
"""Times at rest [s]."""
FINE = 4001
"""Times at which a peak is looked at."""
PEAK_TOLERANCE = 0.01
"""Share by which peaks have to differ to depend on anything."""
MOST_STEPS = 100_000
"""Steps after which a run with a rest is given up: some laws switch without end at rest."""
FALL = 0.005
"""Share of the largest force by which it has to fall after a peak."""
GONE = 20.0
"""Presliding lengths that a body slides before it rests, and after."""


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
    def sentence(self) -> str:
        if np.isnan(self.force).all():
            return (
                "Friction has no peak at break-away: the body creeps or deflects into sliding, and"
                " no threshold is met."
            )
        peaked = ~np.isnan(self.force)
        seen = self.force[peaked]
        if np.ptp(seen) > PEAK_TOLERANCE * seen.max():
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
        if len(after) > 1 and np.ptp(after) > PEAK_TOLERANCE * after.max():
            return (
                f"{by_rate} It goes from {quantity(after[0], 'N')} after"
                f" {quantity(self.dwell[0], 's')} at rest to {quantity(after[-1], 'N')} after"
                f" {quantity(self.dwell[-1], 's')}."
            )
        return f"{by_rate} The time at rest does not matter." if len(after) else by_rate

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
    rates = [top * rate for rate in RATES] if rates is None else rates
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
    # A peak counts only where friction falls below it later, by more than ripples do.
    lowest_later = np.minimum.accumulate(force[::-1])[::-1][2:]
    falls = lowest_later < force[1:-1] - FALL * np.abs(force).max()
    found = np.flatnonzero(inner & falls)
    if not len(found):
        return float("nan")
    i = int(found[0]) + 1
    near = np.linspace(times[max(i - 2, 0)], times[min(i + 2, len(times) - 1)], FINE)
    return float(run.at(near)["friction"].max())


# Forces below the level of sliding that pulse: whether the body drifts.

BIAS, RIPPLE, FREQUENCY = 0.5, 0.4, 10.0
"""Constant and swinging part of the force over the lowest level; frequency [Hz]."""
DRIFT_SETTLED, DRIFT_TIME, DRIFT_WINDOW = 2.0, 8.0, 0.5
"""When drift begins to count, how long it counts, and over how long positions are means [s]."""
DRIFT_SAMPLES = 2000
FOREVER = 1e9
DRIFT_TOLERANCE = 1e-3
"""Drift over the presliding length that counts as none."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Drift(Characteristic):
    """The motion of a body under a force that swings and never reaches break-away."""

    test: ClassVar[str] = "drift"
    title: ClassVar[str] = "Drift below break-away"
    columns: ClassVar[Mapping[str, str]] = {"t": "s", "position": "m"}
    over: ClassVar[str] = "t"

    t: Array
    """Times (n,) [s]."""
    position: Array
    """Position (n,) [m]."""
    distance: float
    """How far the mean position moves in the time that counts [m]."""
    lasts: float
    """That time [s]."""
    length: float
    """Displacement that counts as large here: the presliding length [m]."""
    threshold: str
    """What the load stays below."""

    @property
    def stays(self) -> bool:
        """Whether the body stays in its place."""
        return abs(self.distance) <= DRIFT_TOLERANCE * self.length

    @property
    def rate(self) -> float:
        """Speed of the drift [m/s]."""
        return self.distance / self.lasts

    @property
    def sentence(self) -> str:
        if self.stays:
            return "It does not drift: under a load below break-away the body stays in its place."
        return (
            f"It drifts: {quantity(abs(self.distance), 'm')} in {quantity(self.lasts, 's')} under a"
            f" load that never reaches {self.threshold}."
        )


def drift(bench: Bench, *, bias: float | None = None, ripple: float | None = None) -> Drift:
    """Push a body with a constant force and a ripple that together stay below break-away.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=1.5, bristle_stiffness=1e5, viscous_coefficient=0.4)
    >>> print(drift(Bench(law=law), bias=0.5, ripple=0.4).sentence)
    It drifts: 0.616 mm in 8 s under a load that never reaches break-away.
    """
    low, high = bench.levels
    bias = BIAS * low if bias is None else bias
    ripple = RIPPLE * low if ripple is None else ripple
    if not abs(bias) + abs(ripple) < high:
        raise InputError(
            f"bias and ripple must stay below {bench.threshold} at {quantity(high, 'N')}, got"
            f" {quantity(bias, 'N')} and {quantity(ripple, 'N')}."
        )
    end = DRIFT_SETTLED + DRIFT_TIME
    run = _pushed(bench, bias, ripple, end)
    t = np.linspace(0.0, end, DRIFT_SAMPLES + 1)
    return Drift(
        t=t,
        position=run.at(np.minimum(t, run.span[1]))["x"],
        distance=_mean(run, end) - _mean(run, DRIFT_SETTLED),
        lasts=DRIFT_TIME,
        length=bench.reach,
        threshold=bench.threshold,
        conditions=(
            f"{quantity(bench.mass, 'kg')} under {quantity(bias, 'N')} and a ripple of"
            f" {quantity(ripple, 'N')} at {quantity(FREQUENCY, 'Hz')}; {bench.threshold}:"
            f" {quantity(high, 'N')}."
        ),
    )


def _pushed(bench: Bench, bias: float, ripple: float, end: float) -> Trajectory:
    """Return the run of a body under a force and a ripple."""
    force = Pulse(level=bias, duration=FOREVER) + Sine(amplitude=ripple, frequency=FREQUENCY)
    axis = Axis(inertia=bench.mass, drive=force, load=bench.load)
    return simulate(bench.on(axis), bench.law, t_end=end, y0=bench.deflected())


def _mean(run: Trajectory, until: float) -> float:
    """Return the mean position in the half second before a time."""
    times = np.linspace(until - DRIFT_WINDOW, until, DRIFT_SAMPLES)
    return float(run.at(np.minimum(times, run.span[1]))["x"].mean())


# Small displacements to and fro: what deflects before it slips, and what it remembers.

SLOW, SLOW_ENOUGH = 1e-4, 1e-2
"""Highest speed on the path over the one at which friction changes, so that only the path matters:
wanted, and allowed."""
LONGEST_WAY = 100.0
"""Time of a way as long as the amplitude for which the allowed speed is taken rather [s]."""
BRIEFEST_WAY = 1.0
"""The same of a contact that neither deflects nor holds, whose friction follows the speed alone:
small smoothing velocities ask for so many steps that a longer way ends a run early [s]."""
TURNS = (1.0, -1.0, 0.5, -0.25, 0.5, -1.0, 1.0)
"""Where the path turns, over its amplitude; the inner loop goes from the third and back to it."""
INNER = (0.8, 0.4, 0.8)
"""The same on first loading, where the memory is tested, over the presliding length."""
WAY_POINTS = 120
"""Points on each way."""
MEMORY_KEPT = 1e-3
"""Change of the force after a closed inner loop, over break-away, from which it is one."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Presliding(Characteristic):
    """Friction along a slow path to and fro, with a closed inner loop."""

    test: ClassVar[str] = "presliding"
    title: ClassVar[str] = "Presliding and memory"
    columns: ClassVar[Mapping[str, str]] = {"displacement": "m", "force": "N"}

    displacement: Array
    """Displacement (n,) [m]."""
    force: Array
    """Friction force (n,) [N]."""
    reversals: Array
    """Displacements at which the path turns (m,) [m]."""
    length: float
    """Displacement at which the first stiffness reaches break-away [m]; 0 if nothing deflects."""
    change: float
    """Force after a closed inner loop less the force before, on first loading [N]."""
    memory: Literal["local", "non-local", "none"]
    """Whether the force returns after a closed inner loop; none if nothing deflects."""
    sticks: bool
    """Whether some force leaves the body at rest."""

    @property
    def sentence(self) -> str:
        if not self.sticks:
            return (
                "It neither deflects nor holds: at small velocities there is next to no friction,"
                " so that reversals are smoother than measured ones."
            )
        if self.memory == "none":
            return (
                "It does not deflect: below break-away the contact is rigid, so that no force"
                " springs back when a motion turns."
            )
        deflects = f"It deflects by some {quantity(self.length, 'm')} before it slides"
        if self.memory == "non-local":
            return (
                f"{deflects}. After a closed inner loop the force is the one before: its memory is"
                " non-local, as that of measured contacts is."
            )
        way = "less" if self.change < 0.0 else "more"
        return (
            f"{deflects}. After a closed inner loop the force is"
            f" {quantity(abs(self.change), 'N')} {way} than before: its memory is local, so that"
            " small swings on top of a motion are predicted wrongly."
        )


def presliding(
    bench: Bench, *, amplitude: float | None = None, inner: tuple[float, float] | None = None
) -> Presliding:
    """Move the contact slowly along a path that turns, and test its memory.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=1.5, bristle_stiffness=1e5, viscous_coefficient=0.4)
    >>> found = presliding(Bench(law=law), inner=(1.2e-5, 0.6e-5))
    >>> found.memory, round(found.change, 3)
    ('local', -0.292)
    """
    reach = 2.0 * bench.reach if amplitude is None else amplitude
    wanted, allowed = SLOW * bench.speed, SLOW_ENOUGH * bench.speed
    if amplitude is None and not (bench.law.states or bench.sticks):
        reach = min(reach, BRIEFEST_WAY * allowed)
    speed = min(max(wanted, reach / LONGEST_WAY), allowed) if bench.law.states else allowed
    turns = reach * np.array(TURNS)
    x, force = _followed(bench, turns, speed)
    change = 0.0
    memory: Literal["local", "non-local", "none"] = "none"
    if bench.length > 0.0:
        begins, to = inner or (INNER[0] * bench.length, INNER[1] * bench.length)
        change = _changed(bench, begins, to, speed)
        local = abs(change) > MEMORY_KEPT * bench.levels[1]
        memory = "local" if local else "non-local"
    return Presliding(
        displacement=x,
        force=force,
        reversals=turns,
        length=bench.length,
        change=change,
        memory=memory,
        sticks=bench.sticks,
        conditions=(
            f"{quantity(reach, 'm')} to and fro at no more than {quantity(speed, 'm/s')}, normal"
            f" force {quantity(bench.load, 'N')}."
        ),
    )


def _followed(bench: Bench, turns: Array, speed: float) -> tuple[Array, Array]:
    """Return displacement and friction along a path."""
    path, arrivals = there_and_back([*turns], speed)
    run = simulate(bench.guided(path), bench.law, t_end=arrivals[-1], y0=bench.deflected())
    share = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, WAY_POINTS))  # even steps of displacement
    starts = np.concatenate([[0.0], arrivals[:-1]])
    times = np.concatenate([a + (b - a) * share[1:] for a, b in zip(starts, arrivals, strict=True)])
    times = np.union1d(times, run.t)  # steps end where a contact gives way
    seen = run.at(np.minimum(times, run.span[1]))
    return seen["x"], seen["friction"]


def _changed(bench: Bench, begins: float, to: float, speed: float) -> float:
    """Return by how much a closed inner loop changes the force."""
    path, arrivals = there_and_back([begins, to, begins], speed)
    run = simulate(bench.guided(path), bench.law, t_end=arrivals[-1], y0=bench.deflected())
    before, after = run.at(np.minimum(arrivals[[0, 2]], run.span[1]))["friction"]
    return float(after - before)
