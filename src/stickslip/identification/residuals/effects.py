"""Errors of models, rigs and records, as what they add to the balance of forces."""

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from stickslip.identification.sensor_response import SensorResponse

Array = NDArray[np.float64]

WAVES = 40
"""Waves over the stroke that are looked for at most."""
SPEEDS = (0.05, 0.1, 0.2, 0.4)
"""Speeds over the largest at which a peak of friction near rest is looked for. Slower, rows are few
and see what is at rest through the filter."""
WAYS = (0.003, 0.01, 0.03, 0.1)
"""Ways after a reversal, over the stroke, within which something else is looked for."""
LIMITS = (0.6, 0.75, 0.9)
"""Quantiles of the force's size from which a limit is looked for."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Signals:
    """What errors are made of, all samples of all stretches (n,) end to end."""

    time: Array
    """From the start of each record [s]."""
    position: Array
    """Measured position [m]."""
    velocity: Array
    """Slip velocity [m/s]."""
    level: Array
    """Sign of slip times the load."""
    since: Array
    """Way since the last reversal [m]."""
    force: Array
    """Filtered force that inertia and friction take [N]; friction by the law where it was
    measured."""
    acceleration: Array | None
    """Filtered as well; None where friction was measured."""
    edges: tuple[int, ...]
    """Where stretches begin, and the end."""

    def each(self, of: Callable[[Array, Array], Array]) -> Array:
        """Return a function of times and forces, stretch by stretch (n,)."""
        spans = [slice(a, b) for a, b in itertools.pairwise(self.edges)]
        return np.concatenate([of(self.time[own], self.force[own]) for own in spans])

    @property
    def rate(self) -> Array:
        """Rate of the force [N/s]."""
        return self.each(lambda t, force: np.gradient(force, t))

    @property
    def bend(self) -> Array:
        """Second rate of the force [N/s^2]."""
        return self.each(lambda t, force: np.gradient(np.gradient(force, t), t))

    @property
    def stroke(self) -> float:
        """Range of the position [m]."""
        return float(np.ptp(self.position))

    @property
    def middle(self) -> Array:
        """Position from the middle of the stroke [m]."""
        return self.position - 0.5 * float(self.position.max() + self.position.min())

    @property
    def pace(self) -> Array:
        """Velocity over the largest speed."""
        return np.asarray(self.velocity / max(float(np.max(np.abs(self.velocity))), 1e-300))

    @property
    def course(self) -> Array:
        """Time over the duration, from -1/2 to 1/2."""
        return np.asarray(self.time / max(float(np.ptp(self.time)), 1e-300) - 0.5)


@dataclass(frozen=True, eq=False)
class Effect:
    """What an error adds to the balance of forces, but for its coefficients."""

    kind: str
    """Name of the error, a key of the table of sentences."""
    columns: Callable[[Signals], tuple[Array, ...]]
    """Columns (n,) of it."""
    scale: float = 0.0
    """What these are made with: a length, a force, a time, a share of the speed."""
    filtered: bool = False
    """Whether they are made of what came through the filter."""


def effects(s: Signals, passed: float, *, driven: bool) -> Iterator[Effect]:
    """Yield the errors that are looked for, those with fewer coefficients first.

    Delays of a friction sensor are not among them: they are found by their profile (`delays.py`).
    """
    if driven:
        yield delay_of(0.0)
        yield Effect("clock", lambda s: (s.time * s.rate,), filtered=True)
        yield Effect("flexibility", lambda s: (s.bend,), filtered=True)
    if driven or s.acceleration is None:
        for limit in np.quantile(np.abs(s.force), LIMITS).tolist():
            yield Effect("force limit", partial(_beyond, limit), limit)
    if s.acceleration is not None:
        yield Effect("inertia", _of_acceleration, filtered=True)
    yield Effect("offset", lambda s: (np.ones_like(s.time),))
    yield Effect("drift of the level", lambda s: (s.course * s.level,))
    yield Effect("drift of the offset", lambda s: (s.course,))
    yield Effect("drift of the viscous part", lambda s: (s.course * s.pace,))
    yield Effect("asymmetry", lambda s: (np.abs(s.pace),))
    yield Effect("speed", lambda s: (s.pace * np.abs(s.pace),))
    for share in SPEEDS:
        yield Effect("speed", partial(_peak, share), share)
    yield Effect("spring", lambda s: (s.middle,))
    yield Effect(
        "position friction", lambda s: (2.0 * s.level * s.middle / s.stroke,), 2.0 * s.stroke
    )
    for way in (share * s.stroke for share in WAYS):
        yield Effect("after reversals", partial(_after_reversals, _level, way), way)
        if s.acceleration is not None:
            yield Effect("after reversals", partial(_after_reversals, _acceleration, way), way)
    # of finer waves, the filter leaves nothing at the usual speed
    speeds = np.abs(s.velocity)
    usual = float(np.percentile(speeds, 75.0))
    if usual == 0.0:  # most of the record is rest
        usual = float(np.max(speeds)) or math.inf
    finest = max(int(min(passed * s.stroke / usual, WAVES)), 1)
    for length in (2.0 * s.stroke / k for k in range(1, 2 * finest + 1)):
        yield Effect("position force", partial(_waves, _one, length), length)
        yield Effect("position friction", partial(_waves, _level, length), length)
        yield Effect("imbalance", partial(_waves, _squared, length), length)


def _one(s: Signals) -> Array:
    return np.ones_like(s.time)


def _level(s: Signals) -> Array:
    return s.level


def _acceleration(s: Signals) -> Array:
    assert s.acceleration is not None
    return s.acceleration


def _of_acceleration(s: Signals) -> tuple[Array, ...]:
    return (_acceleration(s),)


def _squared(s: Signals) -> Array:
    return np.asarray(s.pace**2)


def _waves(of: Callable[[Signals], Array], length: float, s: Signals) -> tuple[Array, ...]:
    """Return what goes with cosine and sine of the position at a wavelength [m]."""
    phase = 2.0 * math.pi / length * s.middle
    return of(s) * np.cos(phase), of(s) * np.sin(phase)


def _after_reversals(of: Callable[[Signals], Array], way: float, s: Signals) -> tuple[Array, ...]:
    """Return what fades with the way [m] after each reversal."""
    return (of(s) * np.exp(-s.since / way),)


def _beyond(limit: float, s: Signals) -> tuple[Array, ...]:
    """Return what of the force is beyond a limit [N] to either side."""
    return (np.sign(s.force) * np.maximum(np.abs(s.force) - limit, 0.0),)


def _peak(share: float, s: Signals) -> tuple[Array, ...]:
    """Return friction that falls from rest within a share of the largest speed."""
    return (s.level * np.exp(-np.abs(s.pace) / share),)


def delay_of(delay: float) -> Effect:
    """Return what a force that acts late leaves: to first order, or of a known delay [s]."""

    def columns(s: Signals) -> tuple[Array, ...]:
        if not delay:
            return (s.rate,)
        return (s.each(lambda t, force: (force - np.interp(t - delay, t, force)) / delay),)

    return Effect("delay", columns, delay, filtered=True)


def shown_by(response: SensorResponse) -> Effect:
    """Return what a friction sensor with a response leaves, over the time that it is late."""

    def columns(s: Signals) -> tuple[Array, ...]:
        return (s.each(lambda t, force: (force - response.shown(t, force)) / response.late),)

    return Effect("lag" if response.lag else "delay", columns, -response.late, filtered=True)
