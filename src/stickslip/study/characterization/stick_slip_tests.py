"""Tests of motion with friction: stick-slip over speed and stiffness, hunting, cost of a run.

The boundary of stick-slip is found in three ways: by runs on a grid of speeds and stiffnesses and
bisection between them, by the eigenvalues of steady sliding, and in closed form where the law has a
static level above a constant sliding level.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.simulation import ensemble, simulate
from stickslip.engine.solver import Max, Min
from stickslip.friction import FrictionLaw
from stickslip.maths import Latches
from stickslip.mechanisms import Axis, TowedBlock
from stickslip.mechanisms.drives import Sine
from stickslip.show.formatting import number, quantity
from stickslip.study.characterization.bench import Array, Bench, Characteristic, presliding_length
from stickslip.study.control import PID, closed_loop, limit_cycle

# Where a body that a spring pulls sticks and slips, over belt speed and stiffness.

GRID = (12, 5)
"""Speeds and stiffnesses of the map."""
MAP_SPEEDS = (0.3, 300.0)
"""Speeds of the map over the one at which friction changes."""
MAP_STIFFNESSES = (0.1, 10.0)
"""Stiffnesses of the map over that of the bench."""
RUN_PERIODS = 40.0
"""Free periods that a run lasts, beside what the spring takes to be stretched."""
STRETCHES = 4.0
"""Times that the spring could be stretched from 0 to break-away in a run."""
LATE = 0.4
"""Share of a run from which on its motion counts."""
RATIO = 2.0
"""Ratio of durations up to which runs are made together."""
DAMPING = 0.02
"""Damping ratio of the spring: without, what a start leaves behind would never die out."""
STUCK = 0.1
"""Least speed over that of the belt below which the body sticks."""
HALVINGS = 8
"""Bisections of the boundary: to 1/256 of a grid step."""
DOUBLINGS = 60
"""Times that a formula for constant velocity is asked, each for twice as long."""
SLOPE_STEP = 1e-6
"""Share of their sizes by which states are moved for slopes."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class StickSlipMap(Characteristic):
    """Amplitudes of stick-slip over belt speed and stiffness, with the boundary."""

    test: ClassVar[str] = "map"
    title: ClassVar[str] = "Stick-slip map"
    columns: ClassVar[Mapping[str, str]] = {"speed": "m/s", "stiffness": "N/m"}

    speed: Array
    """Belt speeds (n,) [m/s]."""
    stiffness: Array
    """Stiffnesses of the spring (m,) [N/m]."""
    amplitude: Array
    """Half of the range of the body's speed, over that of the belt (m, n)."""
    sticks: Array
    """Whether the body sticks and slips (m, n)."""
    boundary: Array
    """Highest speed at which it does, by bisection (m,) [m/s]; NaN where none does, infinity where
    all do."""
    linear: Array
    """Highest speed at which steady sliding is unstable, by linearisation (m,) [m/s]; 0 where none
    is, infinity where it is at the highest speed of the map, NaN of laws with latched switches."""
    closed_form: Array
    """The boundary in closed form (m,) [m/s], where there is one: of laws with a static level above
    a sliding level that is the same at all speeds; else NaN."""
    uncertified: int
    """Runs that are not certified and count as sliding."""

    @property
    def sentence(self) -> str:
        place = len(self.stiffness) // 2
        at = quantity(self.stiffness[place], "N/m")
        limit = self.boundary[place]
        if not self.sticks.any():
            stable = ": steady sliding is stable" if (self.linear == 0.0).all() else ""
            return f"It nowhere sticks and slips in this range{stable}."
        if self.sticks.all():
            return (
                "It sticks and slips at every speed and stiffness of the map: it takes a damper, or"
                " a drive that is faster or stiffer than these."
            )
        if not np.isfinite(limit):
            what = "nowhere sticks and slips" if np.isnan(limit) else "sticks and slips everywhere"
            return f"On a spring of {at} it {what} at the speeds of the map."
        linear = self.linear[place]
        beyond = ""
        if np.isfinite(linear) and 0.0 < linear < 0.9 * limit:
            beyond = (
                f" Steady sliding is stable from {quantity(linear, 'm/s')} on, so that between the"
                " two it depends on the start."
            )
        elif linear == 0.0:
            beyond = (
                " Steady sliding is stable at every speed: only a start from rest or a blow leads"
                " to stick-slip."
            )
        return (
            f"On a spring of {at} it sticks and slips below {quantity(limit, 'm/s')}; drive faster,"
            f" or stiffer.{beyond}"
        )

    def _values(self) -> Mapping[str, NDArray[Any]]:
        speed, stiffness = np.meshgrid(self.speed, self.stiffness)
        return {
            "speed": speed.ravel(),
            "stiffness": stiffness.ravel(),
            "amplitude": self.amplitude.ravel(),
            "sticks": self.sticks.ravel(),
        }


def stick_slip_map(
    bench: Bench,
    *,
    speeds: Sequence[float] | None = None,
    stiffnesses: Sequence[float] | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> StickSlipMap:
    """Pull a body by a spring, stretched at first, at many speeds and stiffnesses."""
    v = (
        bench.speed * np.geomspace(*MAP_SPEEDS, GRID[0])
        if speeds is None
        else np.array(speeds, float)
    )
    k = (
        bench.stiffness * np.geomspace(*MAP_STIFFNESSES, GRID[1])
        if stiffnesses is None
        else np.array(stiffnesses, float)
    )
    report = progress or (lambda _done, _all: None)
    speed, stiffness = (grid.ravel() for grid in np.meshgrid(v, k))
    amplitude, sticks, bad = _runs(bench, speed, stiffness)
    report(1, HALVINGS + 1)
    shape = len(k), len(v)
    sticks, amplitude = sticks.reshape(shape), amplitude.reshape(shape)
    # The highest speed of each row at which it sticks: the boundary lies behind it.
    last = np.array([np.flatnonzero(row)[-1] if row.any() else -1 for row in sticks])
    inner = (last >= 0) & (last < len(v) - 1)
    low, high = v[np.maximum(last, 0)], v[np.minimum(last + 1, len(v) - 1)]
    for n in range(HALVINGS):
        if inner.any():
            # Speeds span decades: halved by their ratio.
            middle = np.sqrt(low * high)
            stuck = np.zeros(len(k), dtype=bool)
            stuck[inner] = _runs(bench, middle[inner], k[inner])[1]
            low, high = np.where(stuck, middle, low), np.where(stuck, high, middle)
        report(n + 2, HALVINGS + 1)
    boundary = np.where(inner, np.sqrt(low * high), np.where(last < 0, np.nan, np.inf))
    return StickSlipMap(
        speed=v,
        stiffness=k,
        amplitude=amplitude,
        sticks=sticks,
        boundary=boundary,
        linear=np.array([np.nan if bench.latched else _linear_limit(bench, item, v) for item in k]),
        closed_form=_closed_form(bench, k),
        uncertified=bad,
        conditions=(
            f"{quantity(bench.mass, 'kg')} pulled by a spring with a damping ratio of {DAMPING:g},"
            " from rest with the spring stretched to the level of sliding; normal force"
            f" {quantity(bench.load, 'N')}."
        ),
    )


def _runs(bench: Bench, speed: Array, stiffness: Array) -> tuple[Array, Array, int]:
    """Return amplitudes of speed over the belt's, who sticks, and how many runs are uncertified."""
    low, high = bench.levels
    rig = TowedBlock(mass=bench.mass, stiffness=1.0, speed=1.0, damping=1.0, load=bench.load)
    stretched = high / (stiffness * np.abs(speed))
    needed = STRETCHES * stretched + RUN_PERIODS * 2.0 * np.pi * np.sqrt(bench.mass / stiffness)
    amplitude, sticks = np.zeros(len(speed)), np.zeros(len(speed), dtype=bool)
    bad = 0
    # Runs of one ensemble end together: those of about one duration are made in one.
    group = np.floor(np.log(needed) / np.log(RATIO)).astype(int)
    for label in np.unique(group):
        chosen = np.flatnonzero(group == label)
        end = float(needed[chosen].max())
        varied = {
            "mechanism.speed": speed[chosen],
            "mechanism.stiffness": stiffness[chosen],
            "mechanism.damping": _damper(bench, stiffness[chosen]),
        }
        runs = ensemble(
            bench.on(rig),
            bench.law,
            {**varied, "initial.x": -low / stiffness[chosen]},
            t_end=end,
            outputs={"fast": Max("v", since=LATE * end), "slow": Min("v", since=LATE * end)},
            y0=bench.deflected(),
        )
        fast, slow = runs["fast"] / speed[chosen], runs["slow"] / speed[chosen]
        good = runs.certified
        bad += int((~good).sum())
        amplitude[chosen] = np.where(good, 0.5 * (fast - slow), np.nan)
        # Late in the run it nearly rests, and it overtakes the belt.
        sticks[chosen] = good & (slow < STUCK) & (fast > 1.0 + STUCK)
    return amplitude, sticks, bad


def _damper(bench: Bench, stiffness: Array | float) -> Array:
    """Return the damper beside a spring [N s/m]."""
    return np.asarray(2.0 * DAMPING * np.sqrt(bench.mass * stiffness))


def _closed_form(bench: Bench, stiffness: Array) -> Array:
    """Return the boundary of a law with two levels; NaN of others.

    While the body slips, its velocity relative to the belt is a damped swing; it sticks again if
    the next maximum reaches the belt's speed.
    """
    from scipy.optimize import brentq

    law, load = bench.curve, bench.load
    speeds = bench.speed * np.geomspace(1e-3, 1e3, 61)
    sliding = np.asarray(law.steady(speeds, load)) + np.zeros_like(speeds)
    surplus = float(law.towards(1).break_away(load)) - float(sliding[0])
    if law.states or np.ptp(sliding) > 1e-9 * sliding.max() or not surplus > 0.0:
        return np.full(len(stiffness), np.nan)
    share = np.sqrt(1.0 - DAMPING * DAMPING)

    def excess(ratio: float) -> float:
        phase = 2.0 * np.pi - np.arctan2(ratio * share, 1.0 - DAMPING * ratio)
        wave = np.cos(phase) + (DAMPING - ratio) / share * np.sin(phase)
        return float(np.exp(-DAMPING * phase / share) * wave - 1.0)

    critical = float(brentq(excess, 1e-6, 1e3))
    return np.asarray(surplus / (np.sqrt(stiffness * bench.mass) * critical))


def _linear_limit(bench: Bench, stiffness: float, speeds: Array) -> float:
    """Return the highest speed at which steady sliding on a spring is unstable."""
    unstable = [_grows(bench, stiffness, float(speed)) for speed in speeds]
    if not any(unstable):
        return 0.0
    last = int(np.flatnonzero(unstable)[-1])
    if last == len(speeds) - 1:
        return float("inf")
    low, high = float(speeds[last]), float(speeds[last + 1])
    for _ in range(40):
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if _grows(bench, stiffness, middle) else (low, middle)
    return float(np.sqrt(low * high))


def _grows(bench: Bench, stiffness: float, speed: float) -> bool:
    """Whether small motions about steady sliding grow: eigenvalues of spring, body and states."""
    inner = slopes_at(bench, speed)
    matrix = np.zeros((len(inner) + 1, len(inner) + 1))
    matrix[0, 1] = 1.0  # the body's place
    matrix[1, 0] = -stiffness / bench.mass
    matrix[1:, 1:] = inner
    matrix[1, 1] -= float(_damper(bench, stiffness)) / bench.mass
    values = np.linalg.eigvals(matrix)
    # Growth beyond the rounding of the largest eigenvalue.
    return bool(values.real.max() > 1e-9 * np.abs(values).max())


def slopes_at(bench: Bench, speed: float) -> Array:
    """Return how body and states react to small changes in steady sliding (n, n) [1/s]."""
    law, load = bench.curve, bench.load
    at = np.array([speed, *settled(law, load, speed)])
    columns = []
    for i, size in enumerate([speed, *([bench.reach] * len(law.states))]):
        step = np.zeros(len(at))
        step[i] = SLOPE_STEP * size
        sides = []
        # states have slipped: what is before that may be another side of a switch
        behind = at - step if i == 0 else at
        for v, *z in (at + step, behind):
            force = float(law.force(v, load, tuple(z)))
            with Latches([True] * len(z)):  # every element slips
                rates = law.rates(v, load, tuple(z))
            sides.append([-force / bench.mass, *map(float, rates)])
        columns.append((np.array(sides[0]) - np.array(sides[1])) / (at + step - behind)[i])
    return np.array(columns).T


def settled(law: FrictionLaw, load: float, speed: float) -> tuple[float, ...]:
    """Return the states of a law after long sliding at a speed.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=1.0, bristle_stiffness=1e5)
    >>> settled(law, 1.0, 0.1)
    (1e-05,)
    """
    from scipy.optimize import root

    if not law.states:
        return ()
    length = presliding_length(law, load)
    z, latches = (0.0,) * len(law.states), Latches(off=True)
    # Twice as long each time, until nothing changes any more.
    for doublings in range(DOUBLINGS):
        with latches:
            known = law.moved(speed, load, z, 2.0**doublings * length / speed)
        latches.turn()
        if known is None or known == z:
            break
        z = known
    if any(z):
        return z

    def rates(shares: Array) -> Array:
        found = law.rates(speed, load, tuple(float(share) * length for share in shares))
        return np.asarray(found, dtype=float) / speed

    found = root(rates, np.full(len(law.states), 0.9))
    return tuple(round(float(bend) * length, 17) for bend in found.x)


# An axis under PID control: whether it hunts about its target.

FASTER = 10.0
"""How much faster the loop is than that of the paper LuGre is from, whose cycles take 25 s."""
GAINS = (3.0 * FASTER**2, 4.0 * FASTER**3, 6.0 * FASTER)
"""Proportional, integral and derivative gain over the mass."""
SAMPLE_PERIOD, HUNTING_TIME, HUNTING_SETTLED = 0.002, 30.0, 0.3
"""Time between samples and duration of the run [s]; share of it that is left out."""
FAR = 2.0
"""Distance of the target, over that at which the proportional part equals break-away."""
HUNTING_SAMPLES = 2001
LEAST_HUNTING = 1e-3
"""Amplitude over the distance of the target that counts as none."""
TOLERANCE = 0.1
"""Spread of cycles that are alike: they are long, and few in a run."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Hunting(Characteristic):
    """The motion of an axis that a PID controller moves to a target."""

    test: ClassVar[str] = "limit-cycle"
    title: ClassVar[str] = "Hunting under PID control"
    columns: ClassVar[Mapping[str, str]] = {"t": "s", "position": "m"}
    over: ClassVar[str] = "t"

    t: Array
    """Times (n,) [s]."""
    position: Array
    """Position (n,) [m]."""
    target: float
    """Where the controller wants it to be [m]."""
    kind: str
    """What `stickslip.study.control.limit_cycle` says of the run after its beginning."""
    amplitude: float
    """Half of the range of the position in a cycle [m]; NaN without cycles."""
    period: float
    """Time of a cycle [s]; NaN without cycles."""
    error: float
    """Distance from the target at the end [m]."""

    @property
    def sentence(self) -> str:
        if self.kind in ("limit cycle", "growing", "irregular") and np.isfinite(self.amplitude):
            how = {"growing": ", and more from cycle to cycle", "irregular": " irregularly"}
            return (
                f"It hunts{how.get(self.kind, '')}: {quantity(self.amplitude, 'm')} to either side"
                f" of {quantity(self.target, 'm')} every {quantity(self.period, 's')}."
                " Less integral action, a dead band or compensation of friction ends it."
            )
        left = abs(self.error)
        if left <= LEAST_HUNTING * abs(self.target):
            return "It does not hunt: the integral part brings it to its target."
        ends = f"{quantity(left, 'm')} from its target of {quantity(self.target, 'm')}"
        what = "Its swing dies out" if self.kind == "decaying" else "No limit cycle is seen"
        return f"{what}: after {quantity(float(self.t[-1]), 's')} it is {ends}."


def hunting(bench: Bench, *, t_end: float = HUNTING_TIME) -> Hunting:
    """Move an axis to a target by a PID controller, and look for a limit cycle."""
    proportional, integral, derivative = (bench.mass * gain for gain in GAINS)
    target = FAR * bench.force / proportional
    loop = closed_loop(
        bench.on(Axis(inertia=bench.mass, load=bench.load)),
        bench.law,
        PID(proportional=proportional, integral=integral, derivative=derivative, reference=target),
        period=SAMPLE_PERIOD,
        t_end=t_end,
        y0=bench.deflected(),
    )
    cycle = limit_cycle(
        loop, since=HUNTING_SETTLED * t_end, tolerance=TOLERANCE, least=LEAST_HUNTING * target
    )
    t = np.linspace(0.0, t_end, HUNTING_SAMPLES)
    position = loop.run.at(np.minimum(t, loop.run.span[1]))["x"]
    return Hunting(
        t=t,
        position=position,
        target=target,
        kind=cycle.kind,
        amplitude=cycle.amplitude,
        period=cycle.period,
        error=float(position[-1] - target),
        conditions=(
            f"{quantity(bench.mass, 'kg')}, K_p = {proportional:g}, K_i = {integral:g},"
            f" K_d = {derivative:g}, sampled every {quantity(SAMPLE_PERIOD, 's')}, for"
            f" {quantity(t_end, 's')}."
        ),
    )


# What a law costs a solver: steps of a run, and the fastest rate of its equations.

COST_FORCE, COST_FREQUENCY, COST_TIME = 2.0, 1.0, 5.0
"""Amplitude of the force over break-away, its frequency [Hz] and the time of the run [s]."""
RATE_DECADES, RATE_SPEEDS = 3, 61
"""Speeds at which rates are looked at: so many decades about the one at which friction changes."""
EXPLICIT = 2.0
"""Rate times step up to which Euler's explicit method is stable."""
EASY = 1e3
"""Rate that fixed steps of milliseconds follow [1/s]."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Cost(Characteristic):
    """Steps of a run to and fro, and the fastest rates of the equations."""

    test: ClassVar[str] = "cost"
    title: ClassVar[str] = "Stiffness and cost"
    columns: ClassVar[Mapping[str, str]] = {"speed": "m/s", "rate": "1/s"}
    over: ClassVar[str] = "speed"

    steps: int
    """Steps of the event-driven solver."""
    events: int
    """Events that it located."""
    speed: Array
    """Slip speeds (n,) [m/s]."""
    rate: Array
    """Largest rate of the equations at each (n,) [1/s]."""

    @property
    def largest_rate(self) -> float:
        """Largest rate at any speed [1/s]; NaN if none is known."""
        return float(self.rate.max()) if len(self.rate) else np.nan

    @property
    def sentence(self) -> str:
        fast = self.largest_rate
        run = (
            f"{number(self.steps)} steps and {self.events} events for {quantity(COST_TIME, 's')} to"
            " and fro"
        )
        if np.isnan(fast):
            return f"{run}."
        step = EXPLICIT / fast if fast > 0.0 else np.inf
        if fast < EASY:
            need = "fixed steps of a millisecond follow it between its events"
        else:
            need = f"explicit fixed steps must be shorter than {quantity(step, 's')}"
        rate = f"the fastest rate is {number(fast)} per second" if fast else "no rate is fast"
        return f"{run}; {rate}, so that {need}."


def cost(bench: Bench) -> Cost:
    """Count the steps of a run to and fro, and find the fastest rate of the equations.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> cost(Bench(law=Coulomb(kinetic_coefficient=0.5))).largest_rate
    0.0
    """
    force = COST_FORCE * bench.force
    axis = Axis(
        inertia=bench.mass, drive=Sine(amplitude=force, frequency=COST_FREQUENCY), load=bench.load
    )
    run = simulate(bench.on(axis), bench.law, t_end=COST_TIME, y0=bench.deflected())
    speeds = bench.speed * np.geomspace(10.0**-RATE_DECADES, 10.0**RATE_DECADES, RATE_SPEEDS)
    between = f"from {quantity(speeds[0], 'm/s')} to {quantity(speeds[-1], 'm/s')}"
    if bench.latched:
        speeds = speeds[:0]
    rates = [float(np.abs(np.linalg.eigvals(slopes_at(bench, float(v)))).max()) for v in speeds]
    return Cost(
        steps=run.certificate.steps,
        events=len(run.events),
        speed=speeds,
        rate=np.array(rates),
        conditions=(
            f"{quantity(bench.mass, 'kg')} under a force of {quantity(force, 'N')} at"
            f" {quantity(COST_FREQUENCY, 'Hz')}; rates about steady sliding"
            f" {between if len(speeds) else 'are not known with latched switches'}."
        ),
    )
