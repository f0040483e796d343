"""Random axes with known friction, and noisy records of them: truths to check fits against."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip import (
    Axis,
    CoulombViscous,
    Dahl,
    DirectionDependent,
    EventDriven,
    FrictionLaw,
    Measurement,
    PowerViscous,
    QuadraticDrag,
    Stribeck,
    simulate,
)
from stickslip.errors import SimulationError
from stickslip.mechanisms.drives import Sampled

Array: TypeAlias = NDArray[np.float64]
Random: TypeAlias = np.random.Generator

LEVELS = (
    "kinetic_coefficient",
    "static_coefficient",
    "forward_kinetic_coefficient",
    "backward_kinetic_coefficient",
)
"""Fields of laws that drift together."""
PIECES = 20
"""Pieces of a record in each of which levels that drift are constant."""
REVERSALS = 6
"""Least number of reversals of a record."""
FREE: Mapping[str, tuple[str, ...]] = {
    "dahl": ("kinetic_coefficient", "bristle_stiffness", "viscous_coefficient")
}
"""Fields of a law that are looked for, where not all of its `fit_order`."""
SOLVER = EventDriven(tier="compiled", tolerance=1e-9, stiff_tolerance=1e-6, max_steps=1_000_000)


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """What the parameters of a random law are drawn from."""

    level: float
    """Kinetic friction [N]."""
    speed: float
    """Largest speed [m/s] of the motion that is aimed at."""
    stroke: float
    """Its range [m]."""


@dataclass(frozen=True, kw_only=True)
class Rig:
    """An axis, its friction, and how well it is measured."""

    axis: Axis
    law: FrictionLaw
    speed: float
    """Largest speed [m/s] of the motion that is aimed at."""
    rate: float
    """Samples per second [Hz]."""
    duration: float
    """Of a record [s]."""
    noise: float
    """Standard deviation of the position's error [m]."""
    disturbance: float
    """Standard deviation of the force that is not measured, over that of the one that is."""
    correlation_time: float
    """Of that force [s]."""
    ramps: bool
    """Whether speeds are ramped up and down, as point-to-point motions do; else sums of sines."""
    drift: float = 0.0
    """Growth of friction levels over a record, over their mean, which is that of the law."""


def between(random: Random, low: float, high: float) -> float:
    """Draw from numbers spread evenly over powers of ten."""
    return float(10.0 ** random.uniform(math.log10(low), math.log10(high)))


def _viscous(random: Random, s: Sizes) -> float:
    return s.level / s.speed * float(random.uniform(0.2, 1.5))


def _coulomb_viscous(random: Random, s: Sizes) -> FrictionLaw:
    return CoulombViscous(kinetic_coefficient=s.level, viscous_coefficient=_viscous(random, s))


def _direction_dependent(random: Random, s: Sizes) -> FrictionLaw:
    viscous = _viscous(random, s)
    levels, slopes = random.uniform(0.05, 0.3, 2) * random.choice((-1.0, 1.0), 2)
    return DirectionDependent(
        forward_kinetic_coefficient=s.level * (1.0 + levels),
        backward_kinetic_coefficient=s.level * (1.0 - levels),
        forward_viscous_coefficient=viscous * (1.0 + slopes),
        backward_viscous_coefficient=viscous * (1.0 - slopes),
    )


def _power_viscous(random: Random, s: Sizes) -> FrictionLaw:
    exponent = float(random.uniform(0.3, 0.7))
    share = float(random.uniform(0.4, 1.5))
    return PowerViscous(
        kinetic_coefficient=s.level,
        viscous_coefficient=share * s.level / s.speed**exponent,
        viscous_exponent=exponent,
    )


def _quadratic_drag(random: Random, s: Sizes) -> FrictionLaw:
    return QuadraticDrag(
        kinetic_coefficient=s.level,
        viscous_coefficient=0.5 * _viscous(random, s),
        quadratic_coefficient=s.level / s.speed**2 * float(random.uniform(0.5, 2.0)),
    )


def _stribeck(random: Random, s: Sizes) -> FrictionLaw:
    return Stribeck(
        kinetic_coefficient=s.level,
        static_coefficient=s.level * float(random.uniform(1.2, 1.6)),
        stribeck_velocity=between(random, 0.03, 0.2) * s.speed,
        viscous_coefficient=_viscous(random, s),
    )


def _dahl(random: Random, s: Sizes) -> FrictionLaw:
    return Dahl(
        kinetic_coefficient=s.level,
        bristle_stiffness=s.level / (between(random, 2e-3, 2e-2) * s.stroke),
        viscous_coefficient=_viscous(random, s),
    )


TRUTHS: Mapping[str, Callable[[Random, Sizes], FrictionLaw]] = {
    "coulomb-viscous": _coulomb_viscous,
    "direction-dependent": _direction_dependent,
    "power-viscous": _power_viscous,
    "quadratic-drag": _quadratic_drag,
    "stribeck": _stribeck,
    "dahl": _dahl,
}
"""How each true law is drawn."""


def draw(random: Random, truth: str) -> Rig:
    """Return a random rig whose friction is of a kind."""
    inertia, speed = between(random, 0.5, 100.0), between(random, 0.05, 0.5)
    slowest = 2.0  # s, the usual time of a stroke
    accelerating = inertia * speed / (0.25 * slowest)
    level = accelerating * between(random, 0.3, 3.0)
    sizes = Sizes(level=level, speed=speed, stroke=speed * slowest)
    law = TRUTHS[truth](random, sizes)
    # a law with a level for each direction has no constant force beside them
    offset = (
        0.0 if isinstance(law, DirectionDependent) else level * float(random.uniform(-0.2, 0.2))
    )
    return Rig(
        axis=Axis(inertia=inertia, offset=offset),
        law=law,
        speed=speed,
        rate=float(random.choice((200.0, 500.0, 1000.0))),
        duration=float(random.uniform(15.0, 25.0)),
        noise=sizes.stroke * between(random, 1e-5, 1e-4),
        disturbance=float(random.uniform(0.01, 0.04)),
        correlation_time=between(random, 0.05, 0.5),
        ramps=bool(random.integers(2)),
    )


def record(rig: Rig, random: Random) -> tuple[Measurement, Array]:
    """Return a record of a rig and the force that disturbed it; motions that stall are drawn anew.

    The axis is pushed as its own friction asks for on the way that is aimed at: nothing feeds the
    disturbance back.
    """
    for _ in range(20):
        t = np.arange(0.0, rig.duration, 1.0 / rig.rate)
        force = pushing(rig, t, random)
        wandering = rig.disturbance * float(np.std(force)) * autocorrelated(rig, len(t), random)
        pushed = Sampled(times=t.tolist(), values=(force + wandering).tolist())
        try:
            x, v = _moved(rig, pushed, t)
        except SimulationError:
            continue
        moving = np.sign(v[np.abs(v) > 0.02 * rig.speed])
        if np.count_nonzero(np.diff(moving)) >= REVERSALS:
            x = x + rig.noise * random.standard_normal(len(t))
            return Measurement(time=t, position=x, force=force), wandering
    raise SimulationError(f"no record of {rig.law.name} reverses {REVERSALS} times.")


def _moved(rig: Rig, pushed: Sampled, t: Array) -> tuple[Array, Array]:
    """Return positions and velocities (n,); levels that drift are constant in each piece."""
    pieces = PIECES if rig.drift else 1
    parts = np.array_split(np.arange(len(t)), pieces)
    x, v = np.empty_like(t), np.empty_like(t)
    start: list[float] | None = None
    for number, rows in enumerate(parts):
        growth = 1.0 + rig.drift * ((number + 0.5) / pieces - 0.5)
        known = {field: getattr(rig.law, field, None) for field in LEVELS}
        levels = {field: growth * level for field, level in known.items() if level is not None}
        first, last = int(rows[0]), min(int(rows[-1]) + 1, len(t) - 1)
        drive = Sampled(
            times=[u - float(t[first]) for u in pushed.times[first:]], values=pushed.values[first:]
        )
        run = simulate(
            replace(rig.axis, drive=drive),
            replace(rig.law, **levels),  # type: ignore[arg-type]  # fields that it has, as was seen
            t_end=float(t[last] - t[first]),
            y0=start,
            solver=SOLVER,
        )
        states = run.at(t[rows] - t[first])
        x[rows], v[rows] = states["x"], states["v"]
        ends = run.at(np.array([float(t[last] - t[first])]))
        start = [float(ends[name][0]) for name in run.states]
    return x, v


def pushing(rig: Rig, t: Array, random: Random) -> Array:
    """Return the force (n,) that moves the undisturbed axis on its way, held between samples."""
    v = ramped(rig, t, random) if rig.ramps else waving(rig, t, random)
    a = np.gradient(v, t)
    if rig.law.states:
        friction = [float(rig.law.steady(speed, 1.0)) for speed in v.tolist()]
    else:
        friction = [float(rig.law.force(speed, 1.0)) for speed in v.tolist()]  # type: ignore[attr-defined]
    pushed: Array = rig.axis.inertia * a + np.array(friction) + rig.axis.offset
    return pushed


def waving(rig: Rig, t: Array, random: Random) -> Array:
    """Return velocities (n,) of a sum of sines that begins at rest."""
    waves = [
        random.uniform(0.3, 1.0) * np.sin(2.0 * math.pi * f * t)
        for f in (between(random, 0.12, 0.3), between(random, 0.3, 0.7), between(random, 0.7, 2))
    ]
    v = np.sum(waves, axis=0)
    return np.asarray(rig.speed * v / np.max(np.abs(v)))


def ramped(rig: Rig, t: Array, random: Random) -> Array:
    """Return velocities (n,) that are ramped to a speed, held and ramped down, there and back."""
    corners, speeds, sign = [0.0], [0.0], 1.0
    while corners[-1] < t[-1]:
        peak = sign * rig.speed * float(random.uniform(0.2, 1.0))
        rise, hold = random.uniform(0.15, 0.5), random.uniform(0.1, 1.2)
        for stretch, speed in ((rise, peak), (hold, peak), (rise, 0.0)):
            corners.append(corners[-1] + float(stretch))
            speeds.append(speed)
        sign = -sign
    return np.interp(t, corners, speeds)


def autocorrelated(rig: Rig, count: int, random: Random) -> Array:
    """Return a first-order autoregression (n,) of unit variance."""
    from scipy.signal import lfilter

    decay = math.exp(-1.0 / (rig.rate * rig.correlation_time))
    shocks = math.sqrt(1.0 - decay**2) * random.standard_normal(count)
    shocks[0] /= math.sqrt(1.0 - decay**2)
    return np.asarray(lfilter([1.0], [1.0, -decay], shocks))
