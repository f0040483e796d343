"""Sizes, and drives of those sizes: what random cases are drawn from."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from random import Random

from stickslip.mechanisms.drives import (
    Drive,
    HalfSine,
    PiecewiseLinear,
    Pulse,
    Ramp,
    Sampled,
    Sine,
    Square,
    Sum,
)
from stickslip.mechanisms.drives.feedback import StateFeedback
from stickslip.mechanisms.drives.shapes import DRIVES

WIDEST: Mapping[str, tuple[float, float]] = {
    "kg": (1e-6, 1e4),
    "N/m": (1e-3, 1e9),
    "1": (1e-4, 1e1),
    "m/s": (1e-9, 1e1),
    "1/m": (1e0, 1e9),
    "s/m": (1e-4, 1e5),
    "N s/m": (1e-6, 1e7),
    "N s^2/m^2": (1e-6, 1e7),
    "m": (1e-9, 1e3),
    "N": (1e-6, 1e5),
    "s": (1e-4, 1e4),
    "m/s^2": (1e-1, 1e2),
}
"""Range of each unit; what is derived from others is brought back into it."""


def decade(rng: Random, low: float, high: float) -> float:
    """Return a number between two, spread evenly over powers of ten."""
    return 10.0 ** rng.uniform(math.log10(low), math.log10(high))


def around(rng: Random, size: float, below: float, above: float) -> float:
    """Return a number so many powers of ten below to above a size."""
    return size * 10.0 ** rng.uniform(-below, above)


def within(unit: str, number: float) -> float:
    """Return the number, or the end of its unit's range that it lies beyond."""
    low, high = WIDEST.get(unit, (0.0, math.inf))
    return min(max(number, low), high)


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """What is typical in one case, so that its numbers go together."""

    mass: float
    stiffness: float
    level: float
    """Friction over load."""
    load: float
    wild: bool
    """Each number is drawn from all of its unit's range instead."""

    @property
    def time(self) -> float:
        """Time in which the mass on the spring turns by one radian [s]."""
        return math.sqrt(self.mass / self.stiffness)

    @property
    def force(self) -> float:
        """Break-away force [N]."""
        return self.level * self.load

    @property
    def length(self) -> float:
        """Stretch of the spring at break-away [m]."""
        return self.force / self.stiffness

    def of(self, unit: str) -> float:
        """Return the typical size of a unit, 1 if it has none."""
        known = {
            "kg": self.mass,
            "N/m": self.stiffness,
            "1": self.level,
            "N": self.load,
            "m": self.length,
            "m/s": self.length / self.time,
            "1/m": 30.0 * self.level / self.length,
            "s/m": 0.3 * self.level * self.time / self.length,
            "N s/m": 0.1 * self.mass / self.time,
            "N s^2/m^2": 0.1 * self.mass / self.length,
            "s": self.time,
            "N m": self.force * self.length,
        }
        return within(unit, known.get(unit, 1.0))

    def draw(self, rng: Random, unit: str, spread: float = 0.7) -> float:
        """Return a number of a unit."""
        if self.wild and unit in WIDEST:
            return decade(rng, *WIDEST[unit])
        return within(unit, around(rng, self.of(unit), spread, spread))


def sizes(rng: Random) -> Sizes:
    """Return the sizes of a case."""
    mass = decade(rng, *WIDEST["kg"])
    stiffness = mass / decade(rng, 1e-4, 1e1) ** 2
    level = decade(rng, 1e-3, 10.0)
    load = 1.0 if rng.random() < 0.2 else 9.81 * mass
    return Sizes(
        mass=mass,
        stiffness=within("N/m", stiffness),
        level=level,
        load=load,
        wild=rng.random() < 0.2,
    )


def _level(rng: Random, force: float) -> float:
    """Return a force: none, exactly the given one, or about as large."""
    chance = rng.random()
    if chance < 0.08:
        return 0.0
    size = force if chance < 0.2 else around(rng, force, 0.5, 0.9)
    return rng.choice((-1.0, 1.0)) * size


def _pulse(rng: Random, force: float, time: float, t_end: float) -> Drive:
    duration = rng.choice((0.0, 1e-12, 1e-6, 1.0, 1.0, 1.0, 1.0)) * around(rng, time, 1.0, 1.0)
    start = rng.choice((0.0, 0.0, rng.uniform(0.0, t_end), -0.5 * duration))
    return Pulse(level=_level(rng, force), duration=duration, start=start)


def _ramp(rng: Random, force: float, time: float, t_end: float) -> Drive:
    start = rng.choice((0.0, 0.0, rng.uniform(-0.5, 1.1) * t_end))
    return Ramp(rate=_level(rng, force) / around(rng, time, 0.5, 1.5), start=start)


def _sine(rng: Random, force: float, time: float, t_end: float) -> Drive:
    frequency = around(rng, 0.16 / time, 1.5, 0.5)
    if rng.random() < 0.15:
        frequency = decade(rng, 1e-9, 1e9)
    phase = rng.choice((0.0, 0.5 * math.pi, rng.uniform(-4.0, 4.0)))
    return Sine(amplitude=_level(rng, force), frequency=frequency, phase=phase)


def _line(rng: Random, force: float, time: float, t_end: float) -> Drive:
    times = sorted(rng.uniform(-0.1, 1.1) * t_end for _ in range(rng.randint(1, 8)))
    if rng.random() < 0.3:
        times += [math.nextafter(times[-1], math.inf), times[-1] + around(rng, time, 9.0, 0.0)]
    times = sorted(set(times))
    return PiecewiseLinear(times=tuple(times), values=tuple(_level(rng, force) for _ in times))


def _sampled(rng: Random, force: float, time: float, t_end: float) -> Drive:
    count = rng.randint(1, 30)
    interval = rng.choice((t_end / count, around(rng, time, 1.0, 1.0)))
    return Sampled(
        times=tuple(i * interval for i in range(count)),
        values=tuple(_level(rng, force) for _ in range(count)),
        hold=rng.choice(("zero", "first")),
    )


def _square(rng: Random, force: float, time: float, t_end: float) -> Drive:
    return Square(
        high=_level(rng, force),
        low=rng.choice((0.0, _level(rng, force))),
        period=around(rng, time, 1.0, 1.0),
        duty=rng.choice((0.0, 1.0, 0.5, rng.random())),
        start=rng.choice((0.0, rng.uniform(-0.5, 1.0) * t_end)),
    )


def _half_sine(rng: Random, force: float, time: float, t_end: float) -> Drive:
    return HalfSine(
        amplitude=_level(rng, force),
        period=around(rng, time, 1.0, 1.0),
        duty=rng.choice((1.0, 0.5, rng.uniform(0.01, 1.0))),
        start=rng.choice((0.0, rng.uniform(-0.5, 1.0) * t_end)),
    )


MAKERS: Mapping[type[Drive], Callable[[Random, float, float, float], Drive]] = {
    Pulse: _pulse,
    Ramp: _ramp,
    HalfSine: _half_sine,
    Sine: _sine,
    PiecewiseLinear: _line,
    Sampled: _sampled,
    Square: _square,
}
FOLLOWING = {kind for kind in DRIVES.values() if issubclass(kind, StateFeedback)}
"""Drives that follow states of one mechanism, with tests of their own."""
assert set(MAKERS) == set(DRIVES.values()) - FOLLOWING, "a new drive needs a maker here"


def draw_drive(
    rng: Random, kinds: tuple[type[Drive], ...], force: float, time: float, t_end: float
) -> Drive | None:
    """Return a drive of the given kinds: nothing, one, or a sum."""
    parts = tuple(MAKERS[kind](rng, force, time, t_end) for kind in kinds)
    if len(parts) < 2:
        return parts[0] if parts else None
    return Sum(parts=parts)
