"""Where a body that a spring pulls sticks and slips, over belt speed and stiffness."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.characterization.base import Characteristic
from stickslip.characterization.bench import Array, Bench
from stickslip.characterization.presliding import presliding_length
from stickslip.formatting import quantity
from stickslip.friction import FrictionLaw
from stickslip.maths import Latches
from stickslip.mechanisms import TowedBlock
from stickslip.simulation import ensemble
from stickslip.solver import Max, Min

GRID = (12, 5)
"""Speeds and stiffnesses of the map."""
SPEEDS = (0.3, 300.0)
"""Speeds of the map over the one at which friction changes."""
STIFFNESSES = (0.1, 10.0)
"""Stiffnesses of the map over that of the bench."""
PERIODS = 40.0
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
STEP = 1e-6
"""Share of their sizes by which states are moved for slopes."""


@final
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
    @override
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

    @override
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
    v = bench.speed * np.geomspace(*SPEEDS, GRID[0]) if speeds is None else np.array(speeds, float)
    k = (
        bench.stiffness * np.geomspace(*STIFFNESSES, GRID[1])
        if stiffnesses is None
        else np.array(stiffnesses, float)
    )
    told = progress or (lambda _done, _all: None)
    speed, stiffness = (grid.ravel() for grid in np.meshgrid(v, k))
    amplitude, sticks, bad = _runs(bench, speed, stiffness)
    told(1, HALVINGS + 1)
    shape = len(k), len(v)
    sticks, amplitude = sticks.reshape(shape), amplitude.reshape(shape)
    last = np.array([np.flatnonzero(row)[-1] if row.any() else -1 for row in sticks])
    inner = (last >= 0) & (last < len(v) - 1)
    low, high = v[np.maximum(last, 0)], v[np.minimum(last + 1, len(v) - 1)]
    for n in range(HALVINGS):
        if inner.any():
            middle = np.sqrt(low * high)
            stuck = np.zeros(len(k), dtype=bool)
            stuck[inner] = _runs(bench, middle[inner], k[inner])[1]
            low, high = np.where(stuck, middle, low), np.where(stuck, high, middle)
        told(n + 2, HALVINGS + 1)
    boundary = np.where(inner, np.sqrt(low * high), np.where(last < 0, np.nan, np.inf))
    return StickSlipMap(
        speed=v,
        stiffness=k,
        amplitude=amplitude,
        sticks=sticks,
        boundary=boundary,
        linear=np.array([np.nan if bench.latched else _linear_limit(bench, one, v) for one in k]),
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
    needed = STRETCHES * stretched + PERIODS * 2.0 * np.pi * np.sqrt(bench.mass / stiffness)
    amplitude, sticks = np.zeros(len(speed)), np.zeros(len(speed), dtype=bool)
    bad = 0
    group = np.floor(np.log(needed) / np.log(RATIO)).astype(int)
    for one in np.unique(group):
        chosen = np.flatnonzero(group == one)
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
    unstable = [_grows(bench, stiffness, float(one)) for one in speeds]
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
    return bool(values.real.max() > 1e-9 * np.abs(values).max())


def slopes_at(bench: Bench, speed: float) -> Array:
    """Return how body and states react to small changes in steady sliding (n, n) [1/s]."""
    law, load = bench.curve, bench.load
    at = np.array([speed, *settled(law, load, speed)])
    columns = []
    for i, size in enumerate([speed, *([bench.reach] * len(law.states))]):
        step = np.zeros(len(at))
        step[i] = STEP * size
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
        found = law.rates(speed, load, tuple(float(one) * length for one in shares))
        return np.asarray(found, dtype=float) / speed

    found = root(rates, np.full(len(law.states), 0.9))
    return tuple(round(float(one) * length, 17) for one in found.x)
