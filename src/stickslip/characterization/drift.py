"""Forces below the level of sliding: whether the body drifts or creeps."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from typing_extensions import override

from stickslip.characterization.base import Characteristic
from stickslip.characterization.bench import Array, Bench
from stickslip.drives import Drive, PiecewiseLinear, Pulse, Sine
from stickslip.errors import InputError
from stickslip.formatting import number, quantity
from stickslip.mechanisms import Axis
from stickslip.simulation import simulate
from stickslip.trajectory import Trajectory

BIAS, RIPPLE, FREQUENCY = 0.5, 0.4, 10.0
"""Constant and swinging part of the force over the lowest level; frequency [Hz]."""
SETTLED, LONG, WINDOW = 2.0, 8.0, 0.5
"""When drift begins to count, how long it counts, and over how long positions are means [s]."""
SAMPLES = 2000
FOREVER = 1e9
GROWN = 0.2
"""Share of a run in which a constant force is reached: a sudden one would set swings off."""
STILL = 1e-3
"""Drift over the presliding length that counts as none."""


@final
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
        return abs(self.distance) <= STILL * self.length

    @property
    def rate(self) -> float:
        """Speed of the drift [m/s]."""
        return self.distance / self.lasts

    @property
    @override
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
    end = SETTLED + LONG
    run = _pushed(bench, Pulse(level=bias, duration=FOREVER), ripple, end)
    t = np.linspace(0.0, end, SAMPLES + 1)
    return Drift(
        t=t,
        position=run.at(np.minimum(t, run.span[1]))["x"],
        distance=_mean(run, end) - _mean(run, SETTLED),
        lasts=LONG,
        length=bench.reach,
        threshold=bench.threshold,
        conditions=(
            f"{quantity(bench.mass, 'kg')} under {quantity(bias, 'N')} and a ripple of"
            f" {quantity(ripple, 'N')} at {quantity(FREQUENCY, 'Hz')}; {bench.threshold}:"
            f" {quantity(high, 'N')}."
        ),
    )


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Creep(Characteristic):
    """The speed of a body under a constant force below the level of sliding."""

    test: ClassVar[str] = "creep"
    title: ClassVar[str] = "Creep below the level"
    columns: ClassVar[Mapping[str, str]] = {"t": "s", "position": "m"}
    over: ClassVar[str] = "t"

    force: float
    """The force [N]."""
    t: Array
    """Times (n,) [s]."""
    position: Array
    """Position (n,) [m]."""
    speed: float
    """Mean speed in the second half of the run [m/s]."""
    predicted: float
    """Speed at which steady friction equals the force [m/s]; 0 where it is held at rest."""
    length: float
    """Displacement that counts as large here: the presliding length [m]."""

    @property
    def stays(self) -> bool:
        """Whether the body stays in its place."""
        return bool(abs(self.speed * self.t[-1]) <= STILL * self.length)

    @property
    @override
    def sentence(self) -> str:
        if self.stays:
            return "It does not creep: a constant force below break-away is held."
        if self.predicted > 0.0 or self.speed > 0.0:
            return (
                f"It creeps: {quantity(self.speed, 'm/s')} under half the level of sliding, so that"
                " a load that is parked does not stay."
            )
        return "It moves back: its deflection relaxes under a constant force."


def creep(bench: Bench, *, force: float | None = None, t_end: float = 10.0) -> Creep:
    """Push a body with a constant force below the level of sliding.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> print(creep(Bench(law=Coulomb(kinetic_coefficient=1.0))).sentence)
    It does not creep: a constant force below break-away is held.
    """
    force = BIAS * bench.levels[0] if force is None else force
    grown = GROWN * t_end
    path = PiecewiseLinear(times=(0.0, grown), values=(0.0, force))
    # beside what deflects a damper, which rest does not feel: swings would creep on their own
    damper = np.sqrt(bench.mass * bench.levels[1] / bench.length) if bench.length else 0.0
    run = _pushed(bench, path, 0.0, t_end, damping=float(damper))
    t = np.linspace(0.0, t_end, SAMPLES + 1)
    seen = run.at(np.minimum(t, run.span[1]))
    return Creep(
        force=force,
        t=t,
        position=seen["x"],
        speed=2.0 * (_mean(run, t_end) - _mean(run, 0.5 * t_end)) / t_end,
        predicted=_balanced(bench, force),
        length=bench.reach,
        conditions=(
            f"{quantity(bench.mass, 'kg')} under {quantity(force, 'N')}, reached in"
            f" {quantity(grown, 's')}, for {quantity(t_end, 's')} in all."
            + (f" Damper: {number(float(damper))} N s/m." if damper else "")
        ),
    )


def _pushed(
    bench: Bench, bias: Drive, ripple: float, end: float, damping: float = 0.0
) -> Trajectory:
    """Return the run of a body under a force and a ripple."""
    force = bias + Sine(amplitude=ripple, frequency=FREQUENCY)
    axis = Axis(inertia=bench.mass, drive=force, load=bench.load, damping=damping)
    return simulate(bench.on(axis), bench.law, t_end=end, y0=bench.deflected())


def _mean(run: Trajectory, until: float) -> float:
    """Return the mean position in the half second before a time."""
    times = np.linspace(until - WINDOW, until, SAMPLES)
    return float(run.at(np.minimum(times, run.span[1]))["x"].mean())


def _balanced(bench: Bench, force: float) -> float:
    """Return the least speed at which steady friction equals a force; 0 where rest holds it."""
    from scipy.optimize import brentq

    def excess(speed: float) -> float:
        return float(bench.curve.steady(speed, bench.load)) - force

    speeds = bench.speed * np.geomspace(1e-9, 1e6, 301)
    if float(bench.curve.break_away(bench.load)) >= force or excess(speeds[0]) >= 0.0:
        return 0.0
    above = [speed for speed in speeds if excess(speed) >= 0.0]
    if not above:
        return float("inf")
    return float(brentq(excess, speeds[0], above[0], xtol=1e-300, rtol=1e-13))
