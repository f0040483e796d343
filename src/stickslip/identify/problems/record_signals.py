"""Records of one coordinate as balances take them: one filter for all, bristles along the way."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy import fft

from stickslip.data import Measurement, as_recorded, between_gaps, with_voltage
from stickslip.errors import InputError
from stickslip.identify.bands import Array
from stickslip.identify.forces import (
    Unknown,
    forces_along,
    transmitted_of,
    with_transmitted,
)
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters

FEWEST = 60
"""Samples of a record at least."""
STRETCHES = 20
"""Stretches of a record, of which some are quiet."""
ALIKE = 1e-3
"""Relative difference up to which forces are in proportion to a parameter."""
CHANGED = math.sqrt(np.finfo(float).eps)
"""Share of the range by which positions are moved to see what known forces change by."""


class NotToldError(InputError):
    """Forces along the motion alone do not tell what is looked for; runs may."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """What was measured of one coordinate without a gap, in SI units."""

    time: Array
    """Times (n,) [s], growing."""
    position: Array
    """Positions (n,) [m] or [rad]."""
    force: Array
    """What drives the coordinate (n,) [N], or friction where that was measured."""
    rig: Mechanism | None = None
    """What was recorded, as it was then."""
    velocity: Array | None = None
    """Velocities (n,) [m/s], where they were measured."""
    inertia: float | None = None
    """Inertia [kg]; None where it is to be found."""
    mechanism: Array | None = None
    """Known forces of the mechanism that change along the motion (n,) [N]."""
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
    driven: bool = False
    """Whether something drives the motion that is no force of the record, such as inner bodies."""
    friction: bool = False
    """Whether the force is friction itself: nothing accelerates by it."""
    joint: bool = False
    """Whether it is that of one joint of several, whose motion is in `mechanism`."""
    located: bool = True
    """Whether positions were measured; else they are the integral of the velocity."""
    began: float | None = None
    """Where it is taken to have begun [m] or [rad], if forces depend on a place not measured."""

    gain: float = 1.0
    """Noise of the force that all accelerations take over that of its own."""

    @cached_property
    def position_noise(self) -> float:
        """Standard deviation of white noise of the positions with as much below any band."""
        return noise_of(self.position)

    @cached_property
    def velocity_noise(self) -> float:
        """The same of the velocities."""
        assert self.velocity is not None
        return noise_of(self.velocity, speed=True)

    def each(self, of: Callable[[Array], Array]) -> "Record":
        """Return the record with something else of each channel."""

        def or_none(x: Array | None) -> Array | None:
            return None if x is None else of(x)

        return replace(
            self,
            time=of(self.time),
            position=of(self.position),
            force=of(self.force),
            velocity=or_none(self.velocity),
            mechanism=or_none(self.mechanism),
            load=or_none(self.load),
            transmitted=or_none(self.transmitted),
            inputs={name: of(x) for name, x in self.inputs.items()},
            unknown={path: replace(x, force=of(x.force)) for path, x in self.unknown.items()},
        )

    def on(self, time: Array) -> "Record":
        """Return the record at other times, by straight lines."""
        return self.each(lambda x: np.interp(time, self.time, x))


def records_of(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    unknown: Sequence[str] = (),
    offset: bool = True,
    held: bool = True,
    doubts: Mapping[str, float] | None = None,
    linear: bool = True,
) -> list[Record]:
    """Return the records of a measurement between its gaps, with the known forces of a mechanism.

    Its constant force is one of them unless it is to be found (`offset`). Standard uncertainties
    of the mechanism (`doubts`) are by path. Where forces are not `linear` in what is looked for in
    one record, none are taken as such.

    Examples
    --------
    >>> from stickslip import Axis
    >>> t = np.arange(0.0, 10.0, 0.1)
    >>> decay = Measurement(time=t, velocity=5.0 - 0.4 * t)
    >>> (one,) = records_of(Axis(inertia=2.0), decay)
    >>> one.inertia, float(one.force.max())
    (2.0, 0.0)
    """
    result = []
    for given in measurement.records():
        label = f"record {given.name!r}" if given.name else "the record"
        known = given.quantities()
        if not isinstance(given.time, np.ndarray) or not {"position", "velocity"} & set(known):
            raise InputError(
                f"a force balance needs position (x) [m] or velocity (v) [m/s] in time, and {label}"
                f" has {', '.join(known) or 'nothing'}: give arrays with time [s]."
            )
        own = as_recorded(mechanism, given)
        pieces = [
            segment for segment in between_gaps(given) if len(np.asarray(segment.time)) >= FEWEST
        ]
        if not pieces:
            longest = max(len(np.asarray(segment.time)) for segment in between_gaps(given))
            raise NotToldError(
                f"a force balance needs at least {FEWEST} samples without a gap, and {label} has"
                f" {longest}: record longer, or faster."
            )
        known_to = doubts or {}
        result += [
            _record(own, piece, unknown, known_to, offset=offset, held=held, linear=linear)
            for piece in pieces
        ]
    for path in result[0].unknown.keys() & {*unknown}:
        own_ = [item.unknown[path] for item in result]
        if not any(np.any(item.force) or item.inertia for item in own_):
            name = path.removeprefix("mechanism.")
            raise InputError(f"vary: nothing in these records changes with {name}: leave it out.")
        if linear and len({(item.bent, item.given) for item in own_}) > 1:
            return records_of(
                mechanism, measurement, unknown=unknown, offset=offset, held=held, doubts=doubts,
                linear=False,
            )  # fmt: skip
    if unknown and not any(_tells_scale(item) for item in result):
        raise InputError(
            "without a force only friction over inertia can be found: give the inertia (J) [kg] of"
            " the mechanism, or the force."
        )
    return result


def _tells_scale(record: Record) -> bool:
    """Return whether a force or an inertia of a record is known, by which all others are scaled."""
    if record.friction or np.any(record.force):
        return True
    inertia = record.inertia or 0.0
    forces = 0.0 * record.time if record.mechanism is None else record.mechanism
    taken = [inertia, *forces]
    # what all are in proportion to, as to a mass, tells no scale where it is looked for
    bent = (item for item in record.unknown.values() if item.bent)
    whole = ([item.given * item.inertia, *(item.given * item.force)] for item in bent)
    return bool(np.any(taken)) and not any(np.allclose(taken, item, rtol=ALIKE) for item in whole)


def _record(
    mechanism: Mechanism,
    given: Measurement,
    unknown: Sequence[str],
    doubts: Mapping[str, float],
    *,
    offset: bool,
    held: bool,
    linear: bool,
) -> Record:
    """Return one piece of a record."""
    record = with_voltage(mechanism, given)
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
    found_too = offset and "mechanism.offset" in unknown
    constant = 0.0 if found_too else float(getattr(mechanism, "offset", 0.0))
    if "friction" in known:
        return Record(
            time=time, position=x, velocity=velocity, load=load, inputs=inputs, friction=True,
            rig=mechanism,
            unknown=_without_forces(mechanism, x, doubts),
            force=np.asarray(record.values("friction"), dtype=float) - constant,
            constant=constant, located=located,
            transmitted=transmitted,
        )  # fmt: skip
    v = np.gradient(x, time) if velocity is None else velocity
    forces = forces_along(mechanism, record, x, v, unknown, doubts, linear=linear)
    began = None if located else _began(mechanism, record, x, v, unknown)
    if began is not None:
        x = x + began
        forces = forces_along(mechanism, record, x, v, unknown, doubts, linear=linear)
    inertia: float | None = forces.inertia
    result = dict(forces.unknown)
    for path, item in forces.unknown.items():  # an inertia and nothing else
        alone = not np.any(item.force) and abs(item.inertia - 1.0) < 1e-9 and not item.doubt
        if alone and not forces.inertia:
            inertia = None
            del result[path]
    return Record(
        time=time, position=x, velocity=velocity, inertia=inertia, inputs=inputs,
        load=forces.load if load is None else load, force=forces.driven - constant,
        constant=constant, unknown=result, held=held, located=located,
        driven=len(mechanism.coordinates) > 1,
        mechanism=forces.still if np.ptp(forces.still) > 0.0 else None,
        transmitted=transmitted, began=began, rig=mechanism,
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
    time, h = np.asarray(record.time, dtype=float), CHANGED * (float(np.ptp(x)) + 1e-300)
    near = [forces_along(mechanism, record, x + side, v, []).still for side in (-h, h)]
    if not np.any(np.abs(near[1] - near[0]) > CHANGED * h * np.max(np.abs(near), initial=0.0)):
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
        rows += [item.inertia * gained - summed(item.force) for item in own.unknown.values()]
        y = summed(own.driven + own.still) - own.inertia * gained
        table = np.column_stack(rows)
        sizes = np.max(np.abs(table), axis=0) + 1e-300
        result = np.linalg.lstsq(table / sizes, y, rcond=None)[0] / sizes
        limits = [item.limits for item in own.unknown.values()]
        outside = any(
            not low <= value <= high for value, (low, high) in zip(result[2:], limits, strict=True)
        )
        # a mass below 0 would hang upside down
        return np.asarray(y if outside else y - table @ result)

    around = np.linspace(-math.pi, math.pi, STRETCHES, endpoint=False) if record.turning else [0.0]
    best = min(map(float, around), key=lambda start: float(np.sum(left(start) ** 2)))
    for _ in range(THRESHOLDS.refinements):
        moved = (left(best + h) - left(best - h)) / (2.0 * h)
        best -= float(moved @ left(best)) / (float(moved @ moved) + 1e-300)
    return math.remainder(best, 2.0 * math.pi) if record.turning else best


def _without_forces(
    mechanism: Mechanism, x: Array, doubts: Mapping[str, float]
) -> dict[str, Unknown]:
    """Return doubtful parameters of a mechanism where friction was measured.

    They change loads, or are a constant force beside friction.
    """
    values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    return {
        path: Unknown(
            force=np.full_like(x, float(path.endswith(".offset"))),
            inertia=0.0,
            given=values[path],
            doubt=doubt,
        )
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
        channel: Callable[[Array], Array] | None = None,
        full: bool = False,
        bent: bool = False,
    ) -> Array:
        """Return columns (n, ...) after the filter, derived `slope` times, `late` [s]; or rows.

        A `channel` passes shares of frequencies [Hz].

        Columns are continued beyond their ends by the values there, twice, less the column. Those
        of accelerations then follow from places that are `bent` as at the ends.
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
        # rows start at the first sample: the spectrum is cut after it is turned by the pad
        count, late = (size, late) if full else (rows, late - pad * self.step)
        f = fft.rfftfreq(size, self.step)[: count // 2 + 1]
        pass_ = (2j * np.pi * f) ** slope / (1.0 + (f / (wider * self.band)) ** 8)
        if late:
            pass_ = pass_ * np.exp(-2j * np.pi * f * late)
        pass_ = pass_ * (count / size) * (channel(f) if channel else 1.0)
        kept = fft.rfft(whole, axis=0)[: len(f)] * pass_.reshape(-1, *(1,) * (x.ndim - 1))
        result = fft.irfft(kept, count, axis=0, overwrite_x=True)
        return np.asarray(result[pad : pad + self.count] if full else result[: self.rows])

    @property
    def rows(self) -> int:
        """Number of rows."""
        return (self.count - 1) // self.every + 1


def step_of(x: Array, *, speed: bool = False) -> float:
    """Return the step of an encoder by which values (n,) differ; 0 if they have none.

    A few speeds may be those that were set: counts are multiples of the step, and go by one step
    to and fro.

    Examples
    --------
    >>> step_of(np.round(np.sin(0.01 * np.arange(4000.0)), 3))
    0.001
    >>> counts = np.diff(np.floor(0.3 * np.arange(400.0)))
    >>> step_of(counts, speed=True), step_of(np.repeat([-0.1, 0.1], 200), speed=True)
    (1.0, 0.0)
    """
    range_ = float(np.ptp(x))
    if range_ == 0.0:
        return 0.0
    known = np.diff(np.unique(np.round(x / range_, 12))) * range_
    known = known[known > 1e-11 * range_]
    # files round the steps of an encoder, to 48 and 49 um as it may be: their mean is the step
    least = float(np.mean(known[known < 1.5 * known.min()])) if known.size else 0.0
    steps = known[known < 50.0 * least] / max(least, 1e-300)
    few = 0 < FEWEST * len(known) < len(x) and not (speed and _are_set(x / least))
    whole = np.abs(steps - np.round(steps)) < 0.05
    return least if (few or len(steps) > 20) and np.mean(whole) > 0.95 else 0.0


def _are_set(counts: Array) -> bool:
    """Return whether speeds over a step (n,) are held or jump farther, as no counts do."""
    at, whole = np.flatnonzero(np.diff(counts)), np.all(np.abs(counts - np.round(counts)) < 0.05)
    by_one = whole and np.median(np.abs(np.diff(counts)[at])) < 1.5
    return not (by_one and len(at) > 1 and np.quantile(np.diff(at), 0.25) <= 2.0)


def noise_of(x: Array, *, speed: bool = False) -> float:
    """Return the standard deviation of white noise of values (n,), at least their rounding.

    From the third differences in the quiet twentieths of a record, or the step of the encoder.

    Examples
    --------
    >>> x = np.sin(0.01 * np.arange(4000.0))
    >>> noise_of(np.round(x, 3)) > 2.5e-4, noise_of(x) < 1e-6
    (True, True)
    """
    third = np.diff(x, 3)
    size = max(len(third) // STRETCHES, 8)
    parts = [third[i * size : (i + 1) * size].std() for i in range(max(len(third) // size, 1))]
    quiet = float(np.quantile(parts, 0.2)) / math.sqrt(20.0)
    return max(step_of(x, speed=speed) / math.sqrt(12.0), quiet, 1e-9 * float(np.ptp(x)), 1e-300)


def bristle(path: Array, length: float, exponent: float, start: float = 0.0) -> Array:
    """Return the state (n,) in [-1, 1] of a bristle along a way, from its state at the start.

    Between turns of the way, with u = 1 - s z and the way x over the length, u falls as
    u0 - x, u0 exp(-x), or (u0^(1-n) - (1-n) x)^(1/(1-n)).

    Examples
    --------
    >>> bristle(np.array([0.0, 0.5, 2.0, 1.5]), 1.0, 0.0).tolist()
    [0.0, 0.5, 1.0, 0.5]
    >>> bristle(np.array([0.0, 0.5, 2.0, 1.5]), 1.0, 0.0, start=1.0).tolist()
    [1.0, 1.0, 1.0, 0.5]
    """
    way = np.sign(np.diff(path))
    moved = np.flatnonzero(way)
    result = np.full(len(path), start)
    if not len(moved):
        return result
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
        result[a + 1 : b + 1] = side * (1.0 - u)
        z = float(result[b])
    return result
