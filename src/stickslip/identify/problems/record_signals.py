"""Signals along records of one coordinate: one filter for all, and bristles along the way.

`Along` has them for the rows of records, `Steady` what stands in their place in steady motion.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from scipy import fft
from scipy.interpolate import CubicSpline
from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d
from scipy.signal import lfilter

from stickslip.data import Measurement, as_recorded, between_gaps, with_voltage
from stickslip.errors import InputError
from stickslip.identify.forces import (
    Unknown,
    forces_along,
    transmitted_of,
    with_transmitted,
)
from stickslip.identify.problem import STRETCHES, Array, Mask
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters

ROWS = 6.0
"""Rows for each 1/fc."""
MOST_ROWS = 5000
"""Rows of all records; beyond it fewer for each 1/fc, three at least."""
STILL = 8.0
"""Range of positions within 1/fc that is rest, over their noise."""
SAMPLES = 40.0
"""Samples for each 1/fc of what is integrated along a free motion."""
LEAST_ENERGY = 0.02
"""Part of the energy that is lost from which its noise grows no less."""
FEWEST = 60
"""Samples of a record at least."""
SCALED = math.sqrt(np.finfo(float).eps)
"""Share by which positions and velocities are scaled to see what known forces change by."""
CALM = 0.7
"""Part of the band in which accelerations of a load are looked at: else such terms fit the noise
that the acceleration of the motor has."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """What was measured of one coordinate without a gap, in SI units."""

    time: Array
    """Times (n,) [s], growing."""
    position: Array
    """Positions (n,) [m] or [rad]."""
    force: Array
    """What drives the coordinate (n,) [N], or friction where that was measured."""
    velocity: Array | None = None
    """Velocities (n,) [m/s], where they were measured."""
    inertia: float | None = None
    """Inertia [kg]; None where it is to be found."""
    mechanism: Array | None = None
    """Known forces of the mechanism that change along the motion (n,) [N]."""
    scaled: Array | None = None
    """What those change by for each unit of the scale of positions and velocities (n,) [N]."""
    unknown: Mapping[str, Unknown] = field(default_factory=dict)
    """By path, what parameters of the mechanism change that are to be found beside an inertia."""
    load: Array | None = None
    """Normal force (n,) [N]."""
    inputs: Mapping[str, Array] = field(default_factory=dict)
    """Temperatures and other inputs of the contact (n,)."""
    transmitted: Array | None = None
    """What the gear transmits, with the sign of the motor (n,) [N], where it has both."""
    constant: float = 0.0
    """Known constant resistance, which `force` is without [N]."""
    held: bool = False
    """Whether each force holds until the next sample, and so acts half a sample later."""
    hold_doubt: float = 0.0
    """Standard deviation of when the force acts, over half a sample."""
    driven: bool = False
    """Whether something drives the motion that is no force of the record, such as inner bodies."""
    friction: bool = False
    """Whether the force is friction itself: nothing accelerates by it."""
    located: bool = True
    """Whether positions were measured; else they are the integral of the velocity."""
    began: float | None = None
    """Where it is taken to have begun [m] or [rad], if forces depend on a place not measured."""

    gain: float = 1.0
    """Noise of the force that all accelerations take over that of its own."""
    rarer: float = 1.0
    """Steps of the measurement over those of the record, where it was made finer."""

    @cached_property
    def position_noise(self) -> float:
        """Standard deviation of white noise of the positions with as much below any band."""
        return noise_of(self.position[:: round(self.rarer)]) * math.sqrt(self.rarer)

    @cached_property
    def velocity_noise(self) -> float:
        """The same of the velocities."""
        assert self.velocity is not None
        return noise_of(self.velocity[:: round(self.rarer)]) * math.sqrt(self.rarer)

    def on(self, time: Array) -> "Record":
        """Return the record at other times, by straight lines."""

        def at(x: Array | None) -> Array | None:
            return None if x is None else np.interp(time, self.time, x)

        return replace(
            self,
            time=time,
            position=np.interp(time, self.time, self.position),
            force=np.interp(time, self.time, self.force),
            velocity=at(self.velocity),
            mechanism=at(self.mechanism),
            unknown={
                path: replace(one, force=np.interp(time, self.time, one.force))
                for path, one in self.unknown.items()
            },
            scaled=at(self.scaled),
            load=at(self.load),
            transmitted=at(self.transmitted),
            inputs={name: np.interp(time, self.time, x) for name, x in self.inputs.items()},
        )


def records_of(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    unknown: Sequence[str] = (),
    offset: bool = True,
    held: bool = True,
    doubts: Mapping[str, float] | None = None,
) -> list[Record]:
    """Return the records of a measurement between its gaps, with the known forces of a mechanism.

    Its constant force is one of them unless it is to be found (`offset`). Standard uncertainties
    of the mechanism (`doubts`) are by path.

    Examples
    --------
    >>> from stickslip import Axis
    >>> t = np.arange(0.0, 10.0, 0.1)
    >>> decay = Measurement(time=t, velocity=5.0 - 0.4 * t)
    >>> (one,) = records_of(Axis(inertia=2.0), decay)
    >>> one.inertia, float(one.force.max())
    (2.0, 0.0)
    """
    found = []
    for given in measurement.records():
        label = f"record {given.name!r}" if given.name else "the record"
        known = given.quantities()
        if not isinstance(given.time, np.ndarray) or not {"position", "velocity"} & set(known):
            raise InputError(
                f"a force balance needs position (x) [m] or velocity (v) [m/s] in time, and {label}"
                f" has {', '.join(known) or 'nothing'}: give arrays with time [s]."
            )
        own = as_recorded(mechanism, given)
        pieces = [one for one in between_gaps(given) if len(np.asarray(one.time)) >= FEWEST]
        if not pieces:
            raise InputError(
                f"a force balance needs at least {FEWEST} samples without a gap, and {label} has"
                f" {max(len(np.asarray(one.time)) for one in between_gaps(given))}: record longer,"
                " or faster."
            )
        known_to = doubts or {}
        found += [_record(own, one, unknown, known_to, offset=offset, held=held) for one in pieces]
    if unknown and not any(_tells_scale(one) for one in found):
        raise InputError(
            "without a force only friction over inertia can be found: give the inertia (J) [kg] of"
            " the mechanism, or the force."
        )
    return found


def _tells_scale(record: Record) -> bool:
    """Return whether a force or an inertia of a record is known, by which all others are scaled."""
    known = record.mechanism is not None or bool(record.inertia)
    return known or record.friction or bool(np.any(record.force))


def _record(
    mechanism: Mechanism,
    given: Measurement,
    unknown: Sequence[str],
    doubts: Mapping[str, float],
    *,
    offset: bool,
    held: bool,
) -> Record:
    """Return one piece of a record."""
    record = with_voltage(mechanism, given, "zero")
    known, time = record.quantities(), np.asarray(record.time, dtype=float)
    velocity = np.asarray(record.values("velocity"), float) if "velocity" in known else None
    located = "position" in known
    if located:
        x = np.asarray(record.values("position"), dtype=float)
    else:
        assert velocity is not None
        x = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))])
    load = None
    if "load" in known:
        load = np.broadcast_to(np.asarray(record.values("load"), dtype=float), x.shape)
        if not np.all(load > 0.0):
            raise InputError(
                f"Measurement.load (N) must be above 0 N, got {float(load.min()):.4g}: give the"
                " normal force, one number or one for each sample."
            )
    inputs = {
        name: np.broadcast_to(np.asarray(values, dtype=float), x.shape)
        for name, values in record.contact_inputs().items()
    }
    transmitted = transmitted_of(inputs)
    inputs = with_transmitted(inputs)
    if "friction" in known:
        return Record(
            time=time, position=x, velocity=velocity, load=load, inputs=inputs, friction=True,
            unknown=_without_forces(mechanism, x, doubts),
            force=np.asarray(record.values("friction"), dtype=float), located=located,
            transmitted=transmitted,
        )  # fmt: skip
    v = np.gradient(x, time) if velocity is None else velocity
    forces = forces_along(mechanism, record, x, v, unknown, doubts)
    began = None if located else _began(mechanism, record, x, v, unknown)
    if began is not None:
        x = x + began
        forces = forces_along(mechanism, record, x, v, unknown, doubts)
    scaled = None
    if np.ptp(forces.still) > 0.0 and len(mechanism.coordinates) == 1:
        larger = forces_along(mechanism, record, (1.0 + SCALED) * x, (1.0 + SCALED) * v, unknown)
        scaled = (larger.still - forces.still) / SCALED
    found_too = offset and "mechanism.offset" in unknown
    constant = 0.0 if found_too else float(getattr(mechanism, "offset", 0.0))
    inertia: float | None = forces.inertia
    found = dict(forces.unknown)
    for path, one in forces.unknown.items():  # an inertia and nothing else
        alone = not np.any(one.force) and abs(one.inertia - 1.0) < 1e-9 and not one.doubt
        if alone and not forces.inertia:
            inertia = None
            del found[path]
    return Record(
        time=time, position=x, velocity=velocity, inertia=inertia, inputs=inputs,
        load=forces.load if load is None else load, force=forces.driven - constant,
        constant=constant, unknown=found, held=held, located=located,
        driven=len(mechanism.coordinates) > 1,
        mechanism=forces.still if np.ptp(forces.still) > 0.0 else None, scaled=scaled,
        transmitted=transmitted, began=began,
    )  # fmt: skip


def _began(
    mechanism: Mechanism, record: Measurement, x: Array, v: Array, unknown: Sequence[str]
) -> float | None:
    """Return where a record of velocities began, by the known forces that depend on the place.

    None where none do, or the mechanism says where it rests. The balance of momenta over short
    parts of the record, with level, viscous friction and what is looked for, leaves least from
    there. It is looked for all around an axis, then by steps of Gauss and Newton. A constant force
    would hide it.
    """
    if len(mechanism.coordinates) > 1 or getattr(mechanism, "rest_angle", None) is not None:
        return None
    time, h = np.asarray(record.time, dtype=float), SCALED * (float(np.ptp(x)) + 1e-300)
    near = [forces_along(mechanism, record, x + side, v, []).still for side in (-h, h)]
    if not np.any(np.abs(near[1] - near[0]) > SCALED * h * np.max(np.abs(near), initial=0.0)):
        return None
    ends = np.unique(np.linspace(0, len(time) - 1, STRETCHES**2 + 1).astype(int))
    gained = np.diff(v[ends])

    def summed(y: Array) -> Array:
        steps = 0.5 * (y[1:] + y[:-1]) * np.diff(time)
        return np.diff(np.concatenate([[0.0], np.cumsum(steps)])[ends])

    def left(start: float) -> Array:
        """Return what the balance leaves of each part, from a start."""
        own = forces_along(mechanism, record, x + start, v, unknown)
        rows = [summed(np.sign(v)), summed(v)]
        rows += [one.inertia * gained - summed(one.force) for one in own.unknown.values()]
        y = summed(own.driven + own.still) - own.inertia * gained
        table = np.column_stack(rows)
        sizes = np.max(np.abs(table), axis=0) + 1e-300
        found = np.linalg.lstsq(table / sizes, y, rcond=None)[0] / sizes
        limits = [one.limits for one in own.unknown.values()]
        outside = any(
            not low <= value <= high for value, (low, high) in zip(found[2:], limits, strict=True)
        )
        # a mass below 0 would hang upside down
        return np.asarray(y if outside else y - table @ found)

    around = np.linspace(-math.pi, math.pi, STRETCHES, endpoint=False) if record.turning else [0.0]
    best = min(map(float, around), key=lambda start: float(np.sum(left(start) ** 2)))
    for _ in range(THRESHOLDS.refinements):
        moved = (left(best + h) - left(best - h)) / (2.0 * h)
        best -= float(moved @ left(best)) / (float(moved @ moved) + 1e-300)
    return math.remainder(best, 2.0 * math.pi) if record.turning else best


def _without_forces(
    mechanism: Mechanism, x: Array, doubts: Mapping[str, float]
) -> dict[str, Unknown]:
    """Return doubtful parameters of a mechanism where friction was measured: they change loads."""
    values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    return {
        path: Unknown(force=np.zeros_like(x), inertia=0.0, given=values[path], doubt=doubt)
        for path, doubt in doubts.items()
    }


@dataclass(frozen=True, kw_only=True, eq=False)
class Filter:
    """A low pass of fourth order forward and backward for one piece, and its derivatives."""

    count: int
    step: float
    band: float
    """Where it passes half the amplitude [Hz]."""
    every: int
    """Samples from row to row."""

    @cached_property
    def _sizes(self) -> tuple[int, int, int]:
        pad = min(self.count - 1, math.ceil(3.0 / (self.band * self.step)))
        rows = fft.next_fast_len(math.ceil((self.count + 2 * pad) / self.every), real=True)
        return pad, rows, rows * self.every

    def __call__(
        self,
        x: Array,
        *,
        slope: int = 0,
        wider: float = 1.0,
        late: float = 0.0,
        full: bool = False,
        blue: float = math.inf,
        bent: bool = False,
    ) -> Array:
        """Return columns (n, ...) after the filter, derived `slope` times, `late` [s]; or rows.

        Columns are continued beyond their ends by the values there, twice, less the column. Those
        of accelerations then follow from places that are `bent` as at the ends.

        Noise that grows from a frequency `blue` [Hz] on is white after it.
        """
        pad, rows, size = self._sizes
        ends = 2.0 * x[:1] - x[pad:0:-1], 2.0 * x[-1:] - x[-2 : -pad - 2 : -1]
        if bent:
            near = min(math.ceil(0.5 / (self.band * self.step)) + 3, self.count)
            k = np.arange(near)
            squares = [np.polynomial.polynomial.polyfit(k, y, 2)[2] for y in (x[:near], x[-near:])]
            beyond = np.arange(1, pad + 1) ** 2.0
            ends = ends[0] + 2.0 * squares[0] * beyond[::-1], ends[1] + 2.0 * squares[1] * beyond
        rest = size - self.count - 2 * pad
        # the two ends are joined by a line, so that nothing jumps
        first, last = ends[0][:1], ends[1][-1:]
        share = np.linspace(0.0, 1.0, rest + 2)[1:-1].reshape(-1, *(1,) * (x.ndim - 1))
        whole = np.concatenate([ends[0], x, ends[1], last + share * (first - last)])
        spectrum = fft.rfft(whole, axis=0)
        f = fft.rfftfreq(size, self.step)
        pass_ = (2j * np.pi * f) ** slope / (1.0 + (f / (wider * self.band)) ** 8)
        pass_ = pass_ * np.exp(-2j * np.pi * f * late) / np.hypot(1.0, f / blue)
        spectrum *= pass_.reshape(-1, *(1,) * (x.ndim - 1))
        if full:
            return np.asarray(fft.irfft(spectrum, size, axis=0)[pad : pad + self.count])
        # rows start at the first sample: the spectrum is cut after it is turned by the pad
        turn = np.exp(2j * np.pi * f * pad * self.step).reshape(-1, *(1,) * (x.ndim - 1))
        few = (spectrum * turn)[: rows // 2 + 1]
        return np.asarray(fft.irfft(few, rows, axis=0) / self.every)[: self.rows]

    @property
    def rows(self) -> int:
        """Number of rows."""
        return (self.count - 1) // self.every + 1


def noise_of(x: Array) -> float:
    """Return the standard deviation of white noise of values (n,), at least their rounding.

    From the third differences in the quiet twentieths of a record, or the step of the encoder.

    Examples
    --------
    >>> x = np.sin(0.01 * np.arange(4000.0))
    >>> noise_of(np.round(x, 3)) > 2.5e-4, noise_of(x) < 1e-6
    (True, True)
    """
    range_ = float(np.ptp(x))
    if range_ == 0.0:
        return 1e-300
    known = np.diff(np.unique(np.round(x / range_, 12))) * range_
    known = known[known > 1e-11 * range_]
    # files round the steps of an encoder, to 48 and 49 um as it may be: their mean is the step
    least = float(np.mean(known[known < 1.5 * known.min()])) if known.size else 0.0
    steps = known[known < 50.0 * least] / max(least, 1e-300)
    even = len(steps) > 20 and float(np.mean(np.abs(steps - np.round(steps)) < 0.05)) > 0.95
    third = np.diff(x, 3)
    size = max(len(third) // STRETCHES, 8)
    parts = [third[i * size : (i + 1) * size].std() for i in range(max(len(third) // size, 1))]
    quiet = float(np.quantile(parts, 0.2)) / math.sqrt(20.0)
    return max(least / math.sqrt(12.0) if even else 0.0, quiet, 1e-9 * range_)


def followed(path: Array, reach: float) -> Array:
    """Return positions (n,) that stay where they are within a reach: what play does.

    Examples
    --------
    >>> followed(np.array([0.0, 1.0, 3.0, 2.0, -2.0]), 1.0).tolist()
    [0.0, 0.0, 2.0, 2.0, -1.0]
    """
    at, found = float(path[0]), []
    for x in path.tolist():
        at = x - reach if at < x - reach else x + reach if at > x + reach else at
        found.append(at)
    return np.array(found)


def coasting(position: Array, velocity: Array, half: float, step: float) -> Array:
    """Return positions (n,) of a load that moves on within a gap until it is pushed."""
    x, v, found = float(position[0]), float(velocity[0]), []
    for q, pushed in zip(position.tolist(), velocity.tolist(), strict=True):
        x += step * v
        if x > q + half:
            x, v = q + half, min(v, pushed)
        elif x < q - half:
            x, v = q - half, max(v, pushed)
        found.append(x)
    return np.array(found)


def bristle(path: Array, length: float, exponent: float, start: float = 0.0) -> Array:
    """Return the state (n,) in [-1, 1] of a bristle along a way.

    Between turns of the way, with u = 1 - s z and the way x over the length, u falls as
    u0 - x, u0 exp(-x), or (u0^(1-n) - (1-n) x)^(1/(1-n)).

    Examples
    --------
    >>> bristle(np.array([0.0, 0.5, 2.0, 1.5]), 1.0, 0.0).tolist()
    [0.0, 0.5, 1.0, 0.5]
    """
    way = np.sign(np.diff(path))
    moved = np.flatnonzero(way)
    found = np.full(len(path), start)
    if not len(moved):
        return found
    turns = moved[1:][way[moved[1:]] != way[moved[:-1]]]
    edges = [int(moved[0]), *turns.tolist(), len(path) - 1]
    z = start
    for a, b in pairwise(edges):
        side = float(way[a])
        x = np.abs(path[a + 1 : b + 1] - path[a]) / length
        u = 1.0 - side * z
        if exponent == 0.0:
            u = np.maximum(u - x, 0.0)
        elif exponent == 1.0:
            u = u * np.exp(-x)
        else:
            power = max(u, 1e-12) ** (1.0 - exponent) - (1.0 - exponent) * x
            u = np.maximum(power, 0.0) ** (1.0 / (1.0 - exponent))
        found[a + 1 : b + 1] = side * (1.0 - u)
        z = float(found[b])
    return found


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """What columns are scaled by: that of the records that were fitted, for any rows."""

    band: float
    """Band [Hz]."""
    noise: float
    """Standard deviation of the position [m]."""
    top: float
    """Speed that one in a hundred rows exceeds [m/s]."""
    low: float
    """Slowest speed that is told from rest [m/s]."""
    middle: float
    """Middle of the positions, where places count from [m]."""
    relaxed: float
    """Where springs are relaxed: 0, or the middle where 0 was not passed [m]."""
    span: float
    """Their range [m]."""
    start: float
    duration: float
    """Time of the first sample and length of the longest record [s]."""
    load: float
    """Geometric mean of the load [N]; 1 where it does not change."""
    inputs: Mapping[str, float]
    """Means of inputs."""
    knots: Array
    """Logarithms of the speeds at which the measured curve bends (k,)."""
    basis: Array
    """Eigenvectors of its bending (k, k)."""
    bending: Array
    """Their eigenvalues (k,)."""
    unit: float
    """What the work or impulse of free motions is divided by: of a steady force it has its size."""


class Along:
    """Signals along records: full columns (n,) by name, and the filter that makes rows of them."""

    def __init__(
        self, records: Sequence[Record], frame: Frame | None, band: float, *, free: str = ""
    ) -> None:
        self.records = [one.on(_even(one.time)) for one in records]
        if free:  # what is integrated turns between samples
            self.records = [_finer(one, band) for one in self.records]
        total = sum(one.time[-1] - one.time[0] for one in self.records)
        per = float(np.clip(MOST_ROWS / (total * band), 0.5 * ROWS, ROWS))
        self.filters = []
        for one in self.records:
            h = float(one.time[1] - one.time[0])
            self.filters.append(
                Filter(
                    count=len(one.time), step=h, band=band, every=max(int(1 / (per * band * h)), 1)
                )
            )
        self.band, self._frame, self.free = band, frame, free
        lengths = [len(one.time) for one in self.records]
        self._cuts = np.cumsum(lengths)[:-1]
        self._kept = [self._used(k) for k in range(len(lengths))]
        self.count = int(sum(rows.sum() for rows in self._kept))
        self.record = np.repeat(np.arange(len(lengths)), [int(rows.sum()) for rows in self._kept])
        """Number of the record of each row."""
        self._states: dict[tuple[float, float], Array] = {}

    # ---- rows
    def rows_of(self, parts: Sequence[Array]) -> Array:
        """Return the rows that are compared (n, ...) of filtered pieces."""
        return np.concatenate([x[rows] for x, rows in zip(parts, self._kept, strict=True)])

    def seen(self, x: Array, **options: Any) -> Array:
        """Return a full column (n, ...) as the filter shows it, at the rows."""
        pieces = np.split(x, self._cuts)
        return self.rows_of(
            [f(one, **options) for f, one in zip(self.filters, pieces, strict=True)]
        )

    def acting(self, x: Array) -> Array:
        """Return what a force (n, ...) does at the rows.

        As the filter shows it, or of a free motion what it has done since the start.
        """
        return self._centred(self._done(x)) if self.free else self.seen(x)

    def _done(self, x: Array) -> list[Array]:
        """Return the work of a force (n, ...), or its impulse, or what moves by it, every few."""
        parts = []
        for force, q, filt in zip(np.split(x, self._cuts), self.ways, self.filters, strict=True):
            if self.free == "work":
                done = _summed(force, np.diff(q))
            else:
                done = _summed(force, filt.step)
                done = _summed(done, filt.step) if self.moves else done
            parts.append(done / self.frame.unit)
        return self._whitened(parts)

    def _whitened(self, parts: Sequence[Array]) -> list[Array]:
        """Return integrals (n, ...) every few samples, so that their noise is white.

        White noise e of places x = A sin(w t) gives an energy the noise J w^2 (2 x e) and the
        slope of J v e: its power grows as 4 + (f / f_0)^2, from twice the frequency f_0 on.
        """
        if self.free == "momentum":
            return self._means(parts)
        if not self.moves:
            return [x[:: f.every] for x, f in zip(parts, self.filters, strict=True)]
        found = []
        for x, q, filt in zip(parts, self.ways, self.filters, strict=True):
            rate = float(np.std(np.gradient(q, filt.step)) / np.std(q))
            found.append(filt(x, blue=rate / math.pi))
        return found

    def _means(self, parts: Sequence[Array]) -> list[Array]:
        """Return means (n, ...) over the samples of each row, whose noise is white if theirs is."""
        each = zip(parts, self.filters, strict=True)
        return [uniform_filter1d(x, f.every, axis=0)[:: f.every] for x, f in each]

    def _centred(self, parts: Sequence[Array]) -> Array:
        """Return rows (n, ...) less what depends on where and how the motion of a record began."""
        found = []
        for x, rows, basis in zip(parts, self._kept, self._begun, strict=True):
            own = x[rows]
            found.append(own - basis[0] @ (basis[1] @ own))
        return np.concatenate(found)

    @cached_property
    def _begun(self) -> list[tuple[Array, Array]]:
        """Columns (n, k) of what is open at the start of each record, and their pseudoinverse."""
        found = []
        begun = [np.ones((len(one.time), 1)) for one in self.records]
        if self.free == "momentum" and self.moves:
            begun = [np.column_stack([x, np.linspace(-1.0, 1.0, len(x))]) for x in begun]
        every = zip(self._means(begun), self._kept, self._energies, strict=True)
        for means, rows, energy in every:
            x, n = means[rows], int(rows.sum())
            # noise of the energy grows as its root
            weight = 1.0 / energy[:, None] if self.free == "work" else np.ones((n, 1))
            found.append((x, np.linalg.pinv(x.T @ (weight * x)) @ (weight * x).T))
        return found

    @property
    def moves(self) -> bool:
        """Whether positions were measured, and no velocities."""
        return self.records[0].velocity is None

    @cached_property
    def ways(self) -> list[Array]:
        """Positions of each record as the filter shows them (n,) [m]."""
        return [
            filt(one.position, bent=True, full=True)
            for one, filt in zip(self.records, self.filters, strict=True)
        ]

    @cached_property
    def _has(self) -> list[Array]:
        """Energy, momentum or what moved of an inertia of 1 kg, every few samples."""
        if self.free == "momentum":
            own = [one.position if self.moves else one.velocity for one in self.records]
            return self._whitened([x / self.frame.unit for x in own if x is not None])
        found = []
        for one, filt in zip(self.records, self.filters, strict=True):
            v = filt(one.position, bent=True, slope=1, full=True) if self.moves else None
            if one.velocity is not None:
                v = filt(one.velocity, full=True)
            assert v is not None
            found.append(0.5 * v * v / self.frame.unit)
        return self._whitened(found)

    @cached_property
    def _lost(self) -> list[Array]:
        """What friction has done since the start, every few samples: as `_done` of its force."""
        given = zip(self.records, self._done(self._shown), self._has, strict=True)
        return [done - (one.inertia or 0.0) * has for one, done, has in given]

    @cached_property
    def _energies(self) -> list[Array]:
        """Energy that is left at the rows of each record, at least a part of what is lost."""
        found = []
        for lost, rows in zip(self._lost, self._kept, strict=True):
            left = lost[rows].max(initial=-np.inf) - lost[rows]
            found.append(left + LEAST_ENERGY * np.ptp(lost) + 1e-300)
        return found

    @property
    def energy(self) -> Array:
        """Energy that is left at the rows."""
        return np.concatenate(self._energies)

    @cached_property
    def swing(self) -> Array:
        """Largest speeds within half a period of the rows, with which noise of the energy grows."""
        found = []
        for q, filt, rows in zip(self.ways, self.filters, self._kept, strict=True):
            speed = np.abs(np.gradient(q, filt.step))
            half = math.pi * float(np.std(q) / np.sqrt(np.mean(speed**2)))
            largest = maximum_filter1d(speed, max(round(half / filt.step), 1))
            found.append(largest[:: filt.every][rows])
        return np.concatenate(found)

    @cached_property
    def lost(self) -> Array:
        """What friction has done at the rows, less what depends on the start."""
        return self._centred(self._lost)

    @cached_property
    def _shown(self) -> Array:
        """Known forces of the mechanism (n,) as the filter shows them [N]."""
        parts = zip(np.split(self._known, self._cuts), self.filters, strict=True)
        return np.concatenate([filt(x, full=True) for x, filt in parts])

    def _full(self, make: Callable[[Record, Filter], Array]) -> Array:
        both = zip(self.records, self.filters, strict=True)
        return np.concatenate([make(one, filt) for one, filt in both])

    @cached_property
    def times(self) -> Array:
        """Times of the rows (n,) [s]."""
        both = zip(self.records, self.filters, strict=True)
        return self.rows_of([one.time[:: filt.every] for one, filt in both])

    def _used(self, k: int) -> Mask:
        """Return which rows are not at rest, and away from the ends unless the motion goes on."""
        one, filt = self.records[k], self.filters[k]
        half = max(int(0.5 / filt.band / filt.step), 2)
        if one.located:
            q = one.position
            within = maximum_filter1d(q, 2 * half + 1) - minimum_filter1d(q, 2 * half + 1)
            still = within < STILL * noise_of(q)
        else:
            assert one.velocity is not None
            v = np.abs(filt(one.velocity, full=True))
            still = maximum_filter1d(v, 2 * half + 1) < 3.0 * one.velocity_noise * math.sqrt(
                min(2.0 * filt.step * filt.band, 1.0)
            )
        still = maximum_filter1d(still.astype(np.uint8), 4 * half + 1) > 0
        # where a record is continued shows, and the energy of few swings knows it for long
        parts = STRETCHES // 2 if self.free else STRETCHES
        ends = min(math.ceil(2.0 / filt.band / filt.step), len(still) // parts)
        if self.free != "momentum":
            still[:ends] = still[len(still) - ends :] = True
        kept: Mask = ~still[:: filt.every]
        return kept

    # ---- signals
    @cached_property
    def noise(self) -> float:
        """Largest standard deviation of the noise of positions [m]; of velocities, within 1/fc."""
        found = []
        for one, filt in zip(self.records, self.filters, strict=True):
            if one.located:
                found.append(one.position_noise)
            else:
                share = math.sqrt(min(2.0 * filt.step * filt.band, 1.0))
                found.append(one.velocity_noise * share / (2.0 * math.pi * filt.band))
        return max(found)

    def white(self, inertia: float) -> float:
        """Return the mean square at the rows of the noise of forces and accelerations [N^2]."""
        rng, found = np.random.default_rng(3), []
        for one, filt in zip(self.records, self.filters, strict=True):
            noise = rng.normal(size=len(one.time))
            parts = [noise_of(one.force) * filt(noise)]
            if not one.friction and one.velocity is None:
                parts.append(inertia * one.position_noise * filt(noise, slope=2))
            elif not one.friction:
                parts.append(inertia * one.velocity_noise * filt(noise, slope=1))
            found.append(sum(float(np.mean(x * x)) for x in parts))
        return float(np.mean(found))

    @cached_property
    def position(self) -> Array:
        """Positions as measured (n,) [m]."""
        return self._full(lambda one, _: one.position)

    @cached_property
    def velocity(self) -> Array:
        """Velocities (n,) [m/s] in twice the band, or of a motion that goes on by a polynomial."""

        def made(one: Record, filt: Filter) -> Array:
            if one.velocity is not None:
                return filt(one.velocity, wider=2.0, full=True)
            if self.free == "momentum":
                smooth = smooth_slope(one.position, filt.step, round(one.rarer))
                if smooth is not None:
                    return smooth
            return filt(one.position, bent=True, slope=1, wider=2.0, full=True)

        return self._full(made)

    @cached_property
    def acceleration(self) -> Array:
        """Accelerations at the rows [m/s^2]."""
        return self.rows_of(
            [
                filt(one.position, bent=True, slope=2)
                if one.velocity is None
                else filt(one.velocity, slope=1)
                for one, filt in zip(self.records, self.filters, strict=True)
            ]
        )

    @cached_property
    def force(self) -> Array:
        """Forces at the rows [N], less what the mechanism takes."""
        found = self.rows_of(
            [
                filt(one.force, late=0.5 * filt.step * one.held)
                for one, filt in zip(self.records, self.filters, strict=True)
            ]
        )
        return found + self.mechanism

    @cached_property
    def force_rate(self) -> Array:
        """Rates of the recorded force at the rows [N/s]."""
        return self.seen(self.raw, slope=1)

    @property
    def half_sample(self) -> Array:
        """Changes of the recorded force at the rows in half a sample [N]."""
        steps = np.array([filt.step for filt in self.filters])
        return np.asarray(0.5 * steps[self.record] * self.force_rate)

    def wave(self, number: float) -> Array:
        """Return sine and cosine (n, 2) of the place."""
        angle = number * self.place
        return np.column_stack([np.sin(angle), np.cos(angle)])

    def early(self, delay: float) -> Array:
        """Return the recorded force at the rows, less what comes a delay later [N]."""
        return self.held(self.raw) - self.held(self.raw, late=-delay)

    def held(self, x: Array, late: float = 0.0) -> Array:
        """Return a part of the recorded force (n,) at the rows, which holds as the force does."""
        pieces = zip(self.records, self.filters, np.split(x, self._cuts), strict=True)
        return self.rows_of(
            [filt(part, late=0.5 * filt.step * one.held + late) for one, filt, part in pieces]
        )

    @cached_property
    def mechanism(self) -> Array:
        """Known forces of the mechanism at the rows [N]."""
        return self.acting(self._shown) if self.free else self.seen(self._known)

    @cached_property
    def _known(self) -> Array:
        """Known forces of the mechanism (n,), and what drives a free motion: a constant one."""

        def made(one: Record, _: Filter) -> Array:
            driven = one.force if self.free else 0.0 * one.time
            return driven if one.mechanism is None else driven + one.mechanism

        return self._full(made)

    @cached_property
    def scaled(self) -> Array:
        """What known forces change by for each unit of the scale of the motion, at the rows [N]."""
        return self.seen(
            self._full(lambda one, _: 0.0 * one.time if one.scaled is None else one.scaled)
        )

    @cached_property
    def transmitted(self) -> Array:
        """What a gear transmits, with the sign of the motor (n,) [N]."""
        return self._full(
            lambda one, _: 0.0 * one.time if one.transmitted is None else one.transmitted
        )

    @property
    def inertial(self) -> Array:
        """What an inertia of 1 kg takes at the rows [N]."""
        return self._centred(self._has) if self.free else self.acceleration

    def taken(self, path: str) -> Array:
        """Return what a parameter that is looked for takes at the rows, for each unit of it [N]."""
        own = [one.unknown[path] for one in self.records]
        force = self._full(lambda one, _: one.unknown[path].force)
        if self.free:
            parts = zip(own, self._has, self._done(force), strict=True)
            return self._centred([one.inertia * has - done for one, has, done in parts])
        inertia = np.array([one.inertia for one in own])[self.record]
        return np.asarray(inertia * self.acceleration - self.seen(force))

    @cached_property
    def raw(self) -> Array:
        """Forces as recorded (n,) [N]."""
        return self._full(lambda one, _: one.force)

    @cached_property
    def direction(self) -> Array:
        """Direction of the motion (n,): the last one that stands above the noise."""

        def made(one: Record, filt: Filter) -> Array:
            if self.free == "momentum":  # it goes on, whatever noise says
                return np.full(len(one.time), np.sign(one.position[-1] - one.position[0]))
            if one.velocity is not None:
                v = filt(one.velocity, wider=2.0, full=True)
                noise = one.velocity_noise * math.sqrt(min(4.0 * filt.step * filt.band, 1.0))
            else:
                v = filt(one.position, bent=True, slope=1, wider=2.0, full=True)
                noise = one.position_noise * math.sqrt(
                    2.0 * filt.step * (2.0 * math.pi) ** 2 * filt.band**3 / 3.0
                )
            side = np.where(np.abs(v) > 3.0 * noise, np.sign(v), 0.0)
            sure = np.flatnonzero(side)
            if not len(sure):
                return side
            last = np.maximum.accumulate(np.where(side != 0.0, np.arange(len(side)), 0))
            found = side[last]
            found[: sure[0]] = side[sure[0]]
            turned = side[sure[1:]] != side[sure[:-1]]
            for i, j in zip(sure[:-1][turned], sure[1:][turned], strict=True):
                # between sure directions it turns where that agrees most with the velocity
                k = int(np.argmax(np.cumsum(v[i:j]) * side[i]))
                found[i + k + 1 : j] = side[j]
            return np.asarray(found)

        return self._full(made)

    @cached_property
    def path(self) -> Array:
        """Positions along which bristles move (n,) [m], freed of the chatter of noise."""

        def made(one: Record, filt: Filter) -> Array:
            chatter = 0.5 * one.position_noise * math.sqrt(min(2.0 * filt.step * filt.band, 1.0))
            return followed(filt(one.position, bent=True, full=True), chatter)

        return self._full(made)

    def state(self, length: float, exponent: float) -> Array:
        """Return the state of a bristle (n,), or the direction where its length is 0."""
        key = length, exponent
        if key not in self._states:
            if length == 0.0:
                self._states[key] = self.direction
            else:
                found = [
                    bristle(one, length, exponent, self._strained(record))
                    for one, record in zip(
                        np.split(self.path, self._cuts), self.records, strict=True
                    )
                ]
                self._states[key] = np.concatenate(found)
        return self._states[key]

    @staticmethod
    def _strained(record: Record) -> float:
        """Return the state of bristles at the first sample, which friction shows."""
        if not record.friction:
            return 0.0
        top = float(np.quantile(np.abs(record.force), 0.8)) + 1e-300
        first = record.force[: max(len(record.force) // 500, 2)]
        return float(np.clip(np.median(first) / top, -1.0, 1.0))

    @property
    def frame(self) -> Frame:
        """What columns are scaled by."""
        assert self._frame is not None
        return self._frame

    @cached_property
    def place(self) -> Array:
        """Positions from `Frame.middle` (n,) [m]."""
        return self.position - self.frame.middle

    @cached_property
    def stretch(self) -> Array:
        """Positions from where springs are relaxed (n,) [m]."""
        return self.position - self.frame.relaxed

    @cached_property
    def clock(self) -> Array:
        """Time (n,), from -0.5 at the start to 0.5 at the end of the records that were fitted."""
        return self._full(lambda one, _: (one.time - self.frame.start) / self.frame.duration - 0.5)

    @cached_property
    def load(self) -> Array:
        """Loads (n,) over the usual one."""
        return self._full(
            lambda one, _: (
                1.0 + 0.0 * one.time
                if one.load is None or self.frame.load == 1.0
                else np.maximum(one.load, 0.0) / self.frame.load
            )
        )

    def input(self, name: str) -> Array:
        """Return an input (n,), less its mean in the records that were fitted."""
        mean = self.frame.inputs[name]
        return self._full(lambda one, _: one.inputs.get(name, mean + 0.0 * one.time) - mean)

    def excess(self, limit: float) -> Array:
        """Return by how much recorded forces exceed a limit (n,) [N]."""
        return np.asarray(np.sign(self.raw) * np.maximum(np.abs(self.raw) - limit, 0.0))

    @cached_property
    def balanced(self) -> Array:
        """Forces (n,) [N] that a plain balance of the motion takes, without those of the mechanism.

        What is made of these has no part of the noise of the recorded force, and turns with the
        motion.
        """
        parts = [self._full(lambda one, filt: filt(one.position, bent=True, slope=2, full=True))]
        parts += [self.direction * self.load, self.velocity, np.ones(len(self.direction))]
        x = np.column_stack([self.acceleration, *(self.seen(part) for part in parts[1:])])
        c = np.linalg.lstsq(x, self.force, rcond=1e-9)[0]
        return np.asarray(np.column_stack(parts) @ c - self._known)

    def within(self, limit: float) -> Array:
        """Return forces up to a limit (n,) [N]: what a dead zone takes of them."""
        return np.asarray(np.clip(self.balanced, -limit, limit))

    def loose(self, half: float) -> Array:
        """Return accelerations of a load in a gap, less those of the motor, at the rows."""

        def made(one: Record, filt: Filter) -> Array:
            v = filt(one.position, bent=True, slope=1, wider=2.0, full=True)
            x = filt(one.position, bent=True, wider=2.0, full=True)
            return filt(coasting(x, v, half, filt.step) - x, slope=2, wider=CALM)

        both = zip(self.records, self.filters, strict=True)
        return self.rows_of([made(one, filt) for one, filt in both])

    def ringing(self, x: Array, frequency: float) -> Array:
        """Return what a resonance adds to a column (n,): its response less the column."""
        parts = []
        for one, filt in zip(np.split(x, self._cuts), self.filters, strict=True):
            w = 2.0 * math.pi * frequency * filt.step
            r, turn = math.exp(-0.05 * w), math.cos(w)
            a = np.array([1.0, -2.0 * r * turn, r * r])
            parts.append(lfilter([0.0, a.sum()], a, one - one[0]) - one + one[0])
        return np.concatenate(parts)

    def relaxing(self, constant: float) -> Array:
        """Return the way (n,) that a spring is stretched which relaxes in a time constant."""
        pieces = zip(np.split(self.velocity, self._cuts), self.filters, strict=True)
        parts = []
        for v, filt in pieces:
            keep = math.exp(-filt.step / constant)
            parts.append(lfilter([constant * (1.0 - keep)], [1.0, -keep], v))
        return np.concatenate(parts)

    def full_acceleration(self) -> Array:
        """Return accelerations (n,) in half the band [m/s^2]: where they are no noise."""
        return self._full(lambda one, filt: filt(one.position, slope=2, wider=CALM, full=True))

    def knotted(self) -> Array:
        """Return logarithms of speeds (n,)."""
        return np.asarray(np.log(np.maximum(np.abs(self.velocity), math.exp(self.frame.knots[0]))))


def _summed(x: Array, step: Array | float) -> Array:
    """Return integrals (n, ...) of values over steps (n - 1,)."""
    step = np.reshape(step, (-1, *(1,) * (x.ndim - 1)))
    done = np.cumsum(0.5 * (x[1:] + x[:-1]) * step, axis=0)
    return np.concatenate([np.zeros_like(done[:1]), done])


def smooth_slope(x: Array, step: float, every: int = 1) -> Array | None:
    """Return the slope (n,) of the polynomial that predicts values best, each from all others.

    Its degree is at most the number of stretches of a record; None where it leaves more than the
    noise of the values. Of values (n,) between which others are interpolated, only `every` few
    are measured.

    Examples
    --------
    >>> t = 0.1 * np.arange(50.0)
    >>> bool(np.allclose(smooth_slope(t**3 - t, 0.1), 3.0 * t**2 - 1.0))
    True
    """
    at, y = np.linspace(-1.0, 1.0, len(x)), x[::every]
    many = math.ceil(len(y) / MOST_ROWS)  # of more rows, means
    kept = len(y) // many * many
    means = [one[:kept].reshape(-1, many).mean(axis=1) for one in (at[::every], y)]
    q, r = np.linalg.qr(legendre.legvander(means[0], min(STRETCHES, len(means[0]) - 2)))
    left = means[1][:, None] - np.cumsum(q * (q.T @ means[1]), axis=1)
    errors = np.mean((left / (1.0 - np.cumsum(q**2, axis=1))) ** 2, axis=0)
    best = int(np.argmin(errors)) + 1
    noise = np.var(np.diff(y, 3)) / 20.0 / many + (THRESHOLDS.rounding * np.std(y)) ** 2
    if errors[best - 1] > 2.0 * noise:
        return None
    c = np.linalg.solve(r[:best, :best], q[:, :best].T @ means[1])
    slope = legendre.legval(at, legendre.legder(c))
    return np.asarray(slope * 2.0 / (step * (len(x) - 1)))


def _finer(record: Record, band: float) -> Record:
    """Return a record with enough samples for each 1/band, between its own as a spline goes."""
    step = float(record.time[1] - record.time[0])
    times = math.ceil(SAMPLES * band * step)
    if times < 2:
        return record
    count = times * (len(record.time) - 1) + 1
    time = record.time[0] + step / times * np.arange(count)

    def at(x: Array) -> Array:
        return np.asarray(CubicSpline(record.time, x)(time))

    return replace(
        record.on(time),
        position=at(record.position),
        velocity=None if record.velocity is None else at(record.velocity),
        mechanism=None if record.mechanism is None else at(record.mechanism),
        scaled=None if record.scaled is None else at(record.scaled),
        unknown={p: replace(one, force=at(one.force)) for p, one in record.unknown.items()},
        rarer=float(times),
    )


def _even(time: Array) -> Array:
    step = float(np.median(np.diff(time)))
    return np.asarray(time[0] + step * np.arange(int((time[-1] - time[0]) / step + 1e-6) + 1))


@dataclass(frozen=True, kw_only=True, eq=False)
class Steady:
    """Steady motion at velocities (n,): bristles are stretched, and nothing accelerates."""

    frame: Frame
    velocity: Array
    """Velocities (n,) [m/s]."""
    moment: float = 0.0
    """Time, from -0.5 at the start to 0.5 at the end of the records."""
    at: float = 0.0
    """Distance from the middle of the positions [m]."""
    over: Array | float = 1.0
    """Load over the usual one."""
    inputs: Mapping[str, Array | float] = field(default_factory=dict)
    """Inputs of the contact; their means if not given."""

    @property
    def load(self) -> Array:
        """Loads (n,) over the usual one."""
        return self._none + self.over

    @property
    def _none(self) -> Array:
        return np.zeros(len(self.velocity))

    acceleration = inertial = force_rate = half_sample = mechanism = property(
        lambda self: self._none
    )
    scaled = transmitted = property(lambda self: self._none)

    def seen(self, x: Array, **options: Any) -> Array:
        """Return a column itself; nothing filters it, and its slope is 0."""
        return 0.0 * x if options.get("slope") else x

    acting = held = seen

    def state(self, *_: float) -> Array:
        """Return the direction."""
        return np.asarray(np.sign(self.velocity))

    @property
    def clock(self) -> Array:
        """Time (n,)."""
        return self._none + self.moment

    @property
    def place(self) -> Array:
        """Positions from the middle (n,) [m]."""
        return self._none + self.at

    @property
    def stretch(self) -> Array:
        """Return 0: springs are relaxed."""
        return self._none

    def input(self, name: str) -> Array:
        """Return an input, less its mean in the records that were fitted."""
        mean = self.frame.inputs[name]
        return self._none + self.inputs.get(name, mean) - mean

    def taken(self, _: str) -> Array:
        """Return 0: the mechanism gives no force."""
        return self._none

    def excess(self, _: float) -> Array:
        """Return 0: steady forces are not clipped."""
        return self._none

    within = excess

    def wave(self, _: float) -> Array:
        """Return 0: the mean over places."""
        return np.zeros((len(self.velocity), 2))

    def early(self, _: float) -> Array:
        """Return 0: steady forces do not change."""
        return self._none

    def relaxing(self, _: float) -> Array:
        """Return 0: a spring that relaxes is no friction."""
        return self._none

    def loose(self, _: float) -> Array:
        """Return 0: a gap stays closed."""
        return self._none

    def ringing(self, *_: Any) -> Array:
        """Return 0: nothing rings."""
        return self._none

    def full_acceleration(self) -> Array:
        """Return 0."""
        return self._none

    def knotted(self) -> Array:
        """Return logarithms of speeds (n,)."""
        return np.asarray(np.log(np.maximum(np.abs(self.velocity), math.exp(self.frame.knots[0]))))
