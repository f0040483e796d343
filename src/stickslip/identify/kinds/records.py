r"""Records of one coordinate in time: the force balance along the measured motion.

1. **Balance.** What drives the coordinate, :math:`F`, and all other known forces of the mechanism,
   :math:`F_k(x, v)` (gravity, springs, dampers), move an inertia against friction,

   .. math:: F + F_k(x, v) - J \ddot x = \sum_j c_j\, X_j(x, v, z, t).

   Both sides pass the same filter :math:`B` without phase, so that it biases nothing that is linear
   in the coefficients: the response is :math:`y = B[F + F_k]` less :math:`J B[\ddot x]` where the
   inertia is known, and a column is :math:`B[X_j]`. Velocities that enter :math:`X_j` in other ways
   than linearly have a band twice as wide. Where friction was measured, :math:`y` is its own
   :math:`B[F]`; where nothing drives the motion (decays, coast-downs), :math:`F = 0`.
2. **Band.** Noise :math:`\sigma` of the position, sampled every :math:`h`, has accelerations
   of variance :math:`2 h \sigma^2 (2\pi)^4 f^5 / 5` up to :math:`f`. The band :math:`f_c` is that
   at which they cost 1 % of the force, within bounds of the mean frequency of the motion: no time
   scale is one in seconds. Rows are kept six for each :math:`1/f_c`, none at rest.
3. **Memory.** A bristle of length :math:`r` follows the way: with :math:`u = 1 - s z` for the
   direction :math:`s`, :math:`du/d|x| = -u^n / r`. The exponent :math:`n` is 0 for an elastic
   bristle that yields at once, 1 for Dahl's. Without memory :math:`z` is the direction of motion.
   The length of each exponent that alone explains most goes into the vocabulary.
4. **Terms** are functions of signals (`Signals`), whether along a record (`Along`), or in steady
   motion at asked velocities (`Steady`), where bristles are stretched and nothing accelerates.
5. **Blocks** are stretches of all records, and each record where there are several. Rows within
   :math:`3/f_c` of a block are not learned from while it is left out.
6. **Twins** are the same records in a band of .6 and 1.5 times the width: the bias of the balance
   becomes spread. The covariance counts single stretches (`SPREAD`), as another record differs by
   as much; where there are several records it is theirs that counts.

Source of the parallel filter: M. Gautier, "Dynamic identification of robots with power model",
1997; of the bristle: P. R. Dahl, "A solid friction model", 1968.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, final

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.signal import lfilter
from typing_extensions import override

from stickslip.errors import InputError
from stickslip.experiments import Measurement, as_recorded, between_gaps, with_voltage
from stickslip.identify.ensemble import Ensemble, PredictionBand, band_of
from stickslip.identify.forces import TRANSMITTED, Unknown, forces_along, with_transmitted
from stickslip.identify.laws import CHANGING, FLOWS, POINTS, TITLES, Composition, compose
from stickslip.identify.problem import (
    MEMORY,
    Array,
    Column,
    Mask,
    Points,
    Problem,
    Shape,
    Structure,
    Term,
)
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import Mechanism

STRETCHES = 20
"""Stretches that records are cut into, which are left out one at a time."""
SPREAD = 20.0
"""Another record differs as single stretches do: covariance of their mean times their number."""
TWINS = (0.6, 1.5)
"""Bands of the same record, over the usual one, whose differences count as uncertainty."""
SHARE = 0.01
"""Share of the force that noise of the acceleration may have."""
WIDEST, NARROWEST = 130.0, 1.5
"""Limits of the band over the mean frequency of the motion."""
SAMPLED = 0.15
"""Largest band over the sampling rate."""
ROWS = 6.0
"""Rows for each 1/fc."""
MOST_ROWS = 5000
"""Rows of all records; beyond it fewer for each 1/fc, three at least."""
APART = 3.0
"""Distance over 1/fc from which rows are independent."""
STILL = 8.0
"""Range of positions within 1/fc that is rest, over their noise."""
SOFT = 0.5
"""Rows far out lose weight softly: they hold the slow motion that tells a Stribeck step."""
FEWEST = 60
"""Samples of a record at least."""
EXPONENTS = (0.0, 1.0, 2.0)
"""Exponents of bristles: yields at once, Dahl, slower."""
SHORTEST = 5.0
"""Shortest bristle over the noise of positions: what is shorter is made by it."""
LENGTHS = 10
"""Lengths of bristles that are looked at, from the noise to a quarter of the range."""
HALVINGS = 5
"""Times that the step between lengths is halved about the best."""
BENDING = (1e-4, 1e-2, 1.0)
"""Penalties of the bending of the measured curve, in units of the noise."""
PAIRED = 0.5
"""Part of what one memory leaves that two must explain to be looked at."""
KNOTS = 10
"""Knots of the measured curve over speed."""
LATER = (0.62, 1.6)
"""Multiples of a delay that a neighbour on the grid shows; half of it would only smooth noise."""
LATEST = 0.1
"""Delays and lags of the force over the period of the motion, at most."""
LIKELY = 3.0
"""Records that the usual spread of records is worth, where it is estimated."""
RINGS = 0.4
"""Largest resonance over the band."""
CALM = 0.7
"""Part of the band in which accelerations of a load are looked at: else such terms fit the noise
that the acceleration of the motor has."""
CLEAN = 20.0
"""Force over its noise from which parameters have the full price."""
NATS = 2.0
"""Least price of a parameter: log likelihood of independent rows."""
WAVES = 2
"""Wave numbers of the place that are looked at."""
NEIGHBOURS = 40
"""Part of all rows, on either side, whose noise a speed has."""
SPEEDS = 7
"""Stribeck velocities that are tried first."""
SAME = 1e-3
"""Part of a column that others may leave of it that say the same."""
RUNNING_IN = (0.0, 0.1, 0.3)
"""Time constants of drifts over the length of the record; 0: steady."""


@final
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
    unknown: Mapping[str, Unknown] = field(default_factory=dict)
    """By path, what parameters of the mechanism change that are to be found beside an inertia."""
    load: Array | None = None
    """Normal force (n,) [N]."""
    inputs: Mapping[str, Array] = field(default_factory=dict)
    """Temperatures and other inputs of the contact (n,)."""
    held: bool = False
    """Whether each force holds until the next sample, and so acts half a sample later."""
    friction: bool = False
    """Whether the force is friction itself: nothing accelerates by it."""
    located: bool = True
    """Whether positions were measured; else they are the integral of the velocity."""

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
            load=at(self.load),
            inputs={name: np.interp(time, self.time, x) for name, x in self.inputs.items()},
        )


def records_of(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    unknown: Sequence[str] = (),
    offset: bool = True,
    held: bool = True,
) -> list[Record]:
    """Return the records of a measurement between its gaps, with the known forces of a mechanism.

    Its constant force is one of them unless it is to be found (`offset`).

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
        found += [_record(own, one, unknown, offset=offset, held=held) for one in pieces]
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
    mechanism: Mechanism, given: Measurement, unknown: Sequence[str], *, offset: bool, held: bool
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
    inputs = with_transmitted(inputs)
    if "friction" in known:
        return Record(
            time=time, position=x, velocity=velocity, load=load, inputs=inputs, friction=True,
            force=np.asarray(record.values("friction"), dtype=float), located=located,
        )  # fmt: skip
    v = np.gradient(x, time) if velocity is None else velocity
    forces = forces_along(mechanism, record, x, v, unknown)
    constant = 0.0 if offset else float(getattr(mechanism, "offset", 0.0))
    inertia: float | None = forces.inertia
    found = dict(forces.unknown)
    for path, one in forces.unknown.items():  # an inertia and nothing else
        if not np.any(one.force) and abs(one.inertia - 1.0) < 1e-9 and not forces.inertia:
            inertia = None
            del found[path]
    return Record(
        time=time, position=x, velocity=velocity, inertia=inertia, inputs=inputs,
        load=forces.load if load is None else load, force=forces.driven - constant,
        unknown=found, held=held, located=located,
        mechanism=forces.still if np.ptp(forces.still) > 0.0 else None,
    )  # fmt: skip


@final
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
        self, x: Array, *, slope: int = 0, wider: float = 1.0, late: float = 0.0, full: bool = False
    ) -> Array:
        """Return columns (n, ...) after the filter, derived `slope` times, `late` [s]; or rows."""
        pad, rows, size = self._sizes
        ends = 2.0 * x[:1] - x[pad:0:-1], 2.0 * x[-1:] - x[-2 : -pad - 2 : -1]
        rest = size - self.count - 2 * pad
        # the two ends are joined by a line, so that nothing jumps
        first, last = ends[0][:1], ends[1][-1:]
        share = np.linspace(0.0, 1.0, rest + 2)[1:-1].reshape(-1, *(1,) * (x.ndim - 1))
        whole = np.concatenate([ends[0], x, ends[1], last + share * (first - last)])
        spectrum = fft.rfft(whole, axis=0)
        f = fft.rfftfreq(size, self.step)
        pass_ = (2j * np.pi * f) ** slope / (1.0 + (f / (wider * self.band)) ** 8)
        pass_ = pass_ * np.exp(-2j * np.pi * f * late)
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
    known = np.diff(np.unique(np.round(x / max(float(np.ptp(x)), 1e-300), 12))) * float(np.ptp(x))
    known = known[known > 1e-11 * float(np.ptp(x))]
    least = float(known.min()) if known.size else 0.0
    steps = known[known < 50.0 * least] / max(least, 1e-300)
    even = len(steps) > 20 and float(np.mean(np.abs(steps - np.round(steps)) < 0.05)) > 0.95
    third = np.diff(x, 3)
    size = max(len(third) // STRETCHES, 8)
    parts = [third[i * size : (i + 1) * size].std() for i in range(max(len(third) // size, 1))]
    quiet = float(np.quantile(parts, 0.2)) / math.sqrt(20.0)
    return max(least / math.sqrt(12.0) if even else 0.0, quiet, 1e-9 * float(np.ptp(x)), 1e-300)


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


@final
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
    size: float
    """Root mean square of the response [N]."""


@final
class Along:
    """Signals along records: full columns (n,) by name, and the filter that makes rows of them."""

    def __init__(self, records: Sequence[Record], frame: Frame | None, band: float) -> None:
        self.records = [one.on(_even(one.time)) for one in records]
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
        self.band, self._frame = band, frame
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

    def _full(self, make: Callable[[Record, Filter], Array]) -> Array:
        both = zip(self.records, self.filters, strict=True)
        return np.concatenate([make(one, filt) for one, filt in both])

    def _used(self, k: int) -> Mask:
        """Return which rows are away from the ends and not at rest."""
        one, filt = self.records[k], self.filters[k]
        half = max(int(0.5 / filt.band / filt.step), 2)
        if one.located:
            q = one.position
            within = maximum_filter1d(q, 2 * half + 1) - minimum_filter1d(q, 2 * half + 1)
            still = within < STILL * noise_of(q)
        else:
            assert one.velocity is not None
            v = np.abs(filt(one.velocity, full=True))
            still = maximum_filter1d(v, 2 * half + 1) < 3.0 * noise_of(one.velocity) * math.sqrt(
                min(2.0 * filt.step * filt.band, 1.0)
            )
        still = maximum_filter1d(still.astype(np.uint8), 4 * half + 1) > 0
        ends = min(math.ceil(2.0 / filt.band / filt.step), len(still) // 20)
        still[:ends] = still[len(still) - ends :] = True
        kept: Mask = ~still[:: filt.every]
        return kept

    # ---- signals
    @cached_property
    def noise(self) -> float:
        """Largest standard deviation of the noise of positions [m]."""
        return max(noise_of(one.position) for one in self.records)

    @cached_property
    def position(self) -> Array:
        """Positions as measured (n,) [m]."""
        return self._full(lambda one, _: one.position)

    @cached_property
    def velocity(self) -> Array:
        """Velocities (n,) [m/s] in twice the band."""

        def made(one: Record, filt: Filter) -> Array:
            if one.velocity is not None:
                return filt(one.velocity, wider=2.0, full=True)
            return filt(one.position, slope=1, wider=2.0, full=True)

        return self._full(made)

    @cached_property
    def acceleration(self) -> Array:
        """Accelerations at the rows [m/s^2]."""
        return self.rows_of(
            [
                filt(one.position, slope=2) if one.velocity is None else filt(one.velocity, slope=1)
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

    def wave(self, number: float) -> Array:
        """Return sine and cosine (n, 2) of the place."""
        angle = number * self.place
        return np.column_stack([np.sin(angle), np.cos(angle)])

    def early(self, delay: float) -> Array:
        """Return the recorded force at the rows, less what comes a delay later [N]."""
        return self.seen(self.raw) - self.seen(self.raw, late=-delay)

    @cached_property
    def mechanism(self) -> Array:
        """Known forces of the mechanism at the rows [N]."""
        return self.seen(
            self._full(lambda one, _: 0.0 * one.time if one.mechanism is None else one.mechanism)
        )

    def taken(self, path: str) -> Array:
        """Return what a parameter that is looked for takes at the rows, for each unit of it [N]."""
        own = [one.unknown[path] for one in self.records]
        inertia = np.array([one.inertia for one in own])[self.record]
        force = self.seen(self._full(lambda one, _: one.unknown[path].force))
        return np.asarray(inertia * self.acceleration - force)

    @cached_property
    def raw(self) -> Array:
        """Forces as recorded (n,) [N]."""
        return self._full(lambda one, _: one.force)

    @cached_property
    def direction(self) -> Array:
        """Direction of the motion (n,): the last one that stands above the noise."""

        def made(one: Record, filt: Filter) -> Array:
            if one.velocity is not None:
                v = filt(one.velocity, wider=2.0, full=True)
                noise = noise_of(one.velocity) * math.sqrt(min(4.0 * filt.step * filt.band, 1.0))
            else:
                v = filt(one.position, slope=1, wider=2.0, full=True)
                noise = noise_of(one.position) * math.sqrt(
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
            chatter = (
                0.5 * noise_of(one.position) * math.sqrt(min(2.0 * filt.step * filt.band, 1.0))
            )
            return followed(filt(one.position, full=True), chatter)

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

    def loose(self, half: float) -> Array:
        """Return accelerations of a load in a gap, less those of the motor, at the rows."""

        def made(one: Record, filt: Filter) -> Array:
            v = filt(one.position, slope=1, wider=2.0, full=True)
            x = filt(one.position, wider=2.0, full=True)
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

    def full_acceleration(self) -> Array:
        """Return accelerations (n,) in half the band [m/s^2]: where they are no noise."""
        return self._full(lambda one, filt: filt(one.position, slope=2, wider=CALM, full=True))

    def knotted(self) -> Array:
        """Return logarithms of speeds (n,)."""
        return np.asarray(np.log(np.maximum(np.abs(self.velocity), math.exp(self.frame.knots[0]))))


def _even(time: Array) -> Array:
    step = float(np.median(np.diff(time)))
    return np.asarray(time[0] + step * np.arange(int((time[-1] - time[0]) / step + 1e-6) + 1))


@final
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

    acceleration = force_rate = mechanism = property(lambda self: self._none)

    def seen(self, x: Array, **options: Any) -> Array:
        """Return a column itself; nothing filters it, and its slope is 0."""
        return 0.0 * x if options.get("slope") else x

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

    def wave(self, _: float) -> Array:
        """Return 0: the mean over places."""
        return np.zeros((len(self.velocity), 2))

    def early(self, _: float) -> Array:
        """Return 0: steady forces do not change."""
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


ASKED = 40
"""Speeds of each direction at which the band is stated."""
DRAWN = 600
"""Points of a figure, about."""
ONE_WAY = 0.02
"""Share of the rows below which a direction counts as not moved in."""
LEAST_EXPONENT = 0.2
"""Exponent of bristles that yield at once, in laws: the least that those have."""
PATHS = (
    "offset", "drift", "viscous_drift", "offset_drift", "spring", "bow", "ripple", "mechanism",
    "lag", "inertia_error", "inertia",
)  # fmt: skip
"""Terms of the rig and faults whose coefficient is their size; of two, their root mean square."""
UNLIKE = ("stribeck_direction", "curve", "second", "place", "level_ripple", "adhesion")
"""Terms that no law of `stickslip.friction` has."""
SHAPED = ("delay", "clip", "backlash", "flexible")
"""Those whose shape is their size."""


@final
class RecordsProblem(Problem):
    """Records of one coordinate, as the judge sees them."""

    independent = False
    softness = SOFT
    curved = frozenset(
        {"level", "viscous", "stribeck", "drag", "power", "saturating", "viscous_direction",
         "stribeck_direction"}
    )  # fmt: skip

    def __init__(
        self,
        records: Sequence[Record],
        *,
        like: "RecordsProblem | None" = None,
        band: float = 1.0,
        normal: float = 1.0,
        inertia_path: str = "mechanism.inertia",
        load_slopes: Mapping[str, tuple[float, float]] | None = None,
        offset: str = "offset",
    ) -> None:
        self._made_of = records, like, band, normal, inertia_path, load_slopes, offset
        self.records: list[Record] = (
            _by_best_sensor(records) if like is None else _alike(records, like.records[0])
        )
        first = self.records[0]
        self.finds_inertia = first.inertia is None and not first.friction
        base = _band(self.records) if like is None else like.frame.band
        self.rows = Along(self.records, None if like is None else like.frame, band * base)
        self.frame: Frame = _frame(self.rows, base) if like is None else like.frame
        self.rows._frame = self.frame
        self._widths: dict[Column, int] = {}
        self.normal: float = normal if like is None else like.normal
        self.inertia_path: str = inertia_path if like is None else like.inertia_path
        self.load_slopes: Mapping[str, tuple[float, float]] = (
            load_slopes or {} if like is None else like.load_slopes
        )
        self.offset: str = offset if like is None else like.offset
        known = 0.0 if first.inertia is None else first.inertia
        self.response = self.rows.force - known * self.rows.acceleration
        self.stretches, self.blocks, self.excluded = _blocks(self.rows)
        self.always = frozenset(first.unknown) | {
            *(["inertia"] if self.finds_inertia else []),
            *(["offset"] if self.offset.startswith("mechanism.") else []),
        }
        if like is None:
            found = _screened(self)
            self.terms = _terms(self, *found)
            self.references = _references(self, found[0][:2])
        else:
            self.terms, self.references = like.terms, like.references
        self.usual = [
            tuple(sorted(self.always.union(names)))
            for names in (
                ("level",), ("level", "offset"), ("level", "viscous"), ("viscous",),
                ("level", "offset", "viscous"), ("level", "stribeck", "viscous"),
                ("level", "offset", "stribeck", "viscous"), ("drag", "level"),
                ("drag", "level", "viscous"), ("drag", "viscous"), ("level", "power"),
                ("adhesion", "level"), ("adhesion", "level", "viscous"),
                ("adhesion", "level", "stribeck", "viscous"), ("adhesion", "level", "power"),
            )
        ]  # fmt: skip
        self.instead = {"offset": TITLES["level_direction"]} if self.offset else {}
        self.remembering: set[tuple[frozenset[str], bool]] = set()
        self.spread = _spread(self) if like is None else like.spread

    @override
    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes it again in another process: its terms are functions."""
        return _made, self._made_of, {"only": self.only, "remembering": self.remembering}

    @override
    def price(self, size: float) -> float:
        """Return the share of the error that a parameter must save: 6 %, less where noise is large.

        Where noise is small beside the force everything is significant, and what counts is whether
        it is material; where it is large a parameter must only be significant.
        """
        filt = self.rows.filters[0]
        independent = 2.0 * self.rows.band * filt.every * filt.step * self.rows.count
        material = THRESHOLDS.material * min(size / CLEAN, 1.0)
        return float(min(max(NATS / independent, material), THRESHOLDS.material))

    @override
    def scales(self, fitted: Array) -> Sequence[Array]:
        """Return the speed, with which noise grows."""
        return [np.maximum(np.abs(self.rows.seen(self.rows.velocity)), self.frame.low)]

    @cached_property
    def _twins(self) -> list["RecordsProblem"]:
        return [RecordsProblem(self.records, like=self, band=one) for one in TWINS]

    @property
    @override
    def twins(self) -> Sequence[Problem]:
        """The same records in other bands."""
        return self._twins if abs(self.rows.band / self.frame.band - 1.0) < 1e-9 else ()

    @override
    def allowed(self, structure: Structure) -> bool:
        """Return whether terms may stand together, and a law is one that is compared."""
        if not super().allowed(structure):
            return False
        if not self.remembering or not self.is_law(structure):
            return True
        names = frozenset(name for name, _ in structure if self.terms[name].role == "law")
        return (names, MEMORY in self.family(structure)) in self.remembering

    def of(self, records: Sequence[Record]) -> "RecordsProblem":
        """Return other records of the same rig, in the same band and terms."""
        return RecordsProblem(records, like=self)

    @override
    def at(
        self,
        velocity: Any,
        load: Any = None,
        inputs: Mapping[str, Any] | None = None,
    ) -> Steady:
        """Return rows of steady motion at velocities (n,) [m/s] and the mean of time."""
        over = 1.0 if load is None else np.asarray(load, dtype=float) / self.normal
        v = np.atleast_1d(np.asarray(velocity, dtype=float))
        return Steady(frame=self.frame, velocity=v, over=over, inputs=inputs or {})

    @override
    def speeds(self, rows: Any) -> Array:
        """Return the speeds of rows (n,)."""
        speed = np.abs(rows.seen(rows.velocity))
        return np.asarray(np.maximum(speed, 1e-3 * self.frame.low))

    @override
    def curve_rows(self) -> tuple[Array, Any, float]:
        """Return speeds (n,) through which a curve is drawn as a law, their rows, and the load."""
        speeds = np.geomspace(self.frame.low, self.frame.top, POINTS)
        return speeds, self.at(speeds), self.normal

    @override
    def points(self, structure: Structure, coefficients: Array) -> Points:
        """Return the response less what a structure says of the rig, thinned out."""
        at, friction = 0, self.response.copy()
        for name, shape in structure:
            size = self.width(name, shape)
            if self.terms[name].role in ("rig", "fault"):
                x = np.reshape(self.terms[name].columns(self.rows, shape), (self.rows.count, -1))
                friction -= x @ coefficients[at : at + size]
            at += size
        rows = np.arange(0, self.rows.count, max(self.rows.count // DRAWN, 1))
        velocity = self.rows.seen(self.rows.velocity)
        load = np.ones(len(rows))
        return Points(velocity=velocity[rows], friction=friction[rows], load=load, rows=rows)

    @override
    def asked(self) -> Steady:
        """Return the rows over which the band is stated: the directions that were moved in."""
        v = self.rows.seen(self.rows.velocity)
        speeds = np.geomspace(self.frame.low, self.frame.top, ASKED)
        sides = [side for side in (-1.0, 1.0) if np.mean(side * v > self.frame.low) > ONE_WAY]
        return self.at(np.sort(np.concatenate([side * speeds for side in sides])))

    @override
    def composition(self, structure: Structure, coefficients: Array) -> Composition:
        """Return the law that a structure with coefficients (d, p) is, at the usual load."""
        at, rig = 0, dict[str, Array]()
        terms: dict[str, tuple[Shape, Array]] = {}
        memory: Shape = (0.0, 0.0)
        unlike = False
        for name, shape in structure:
            term = self.terms[name]
            size = self.width(name, shape)
            own, at = coefficients[:, at : at + size], at + size
            memory = shape[:2] if term.shared and shape[0] else memory
            if (of_rig := self._of_rig(name, shape, own)) is not None:
                rig |= of_rig
            elif name in UNLIKE:
                unlike = True
            elif term.role == "law":
                entries = shape[term.shared :]
                if name == "level" and entries:
                    rig["load_exponent"] = np.full(len(own), entries[0])
                terms[name] = (() if name == "level" else entries), own
        normal = self._normals(rig, len(coefficients))
        for name, (entries, own) in terms.items():
            if name not in FLOWS and name != "gear" and "viscous" not in name:
                terms[name] = entries, own / normal[:, None]
        values = {}
        if memory[0]:
            level = terms.get("level", ((), np.zeros((len(coefficients), 1))))[1][:, 0]
            values = {"bristle_stiffness": level / memory[0]}
            values |= {"yield_exponent": np.full(len(coefficients), max(memory[1], LEAST_EXPONENT))}
        found = compose(
            terms,
            self.frame.inputs,
            len(coefficients),
            memory="dahl" if memory[0] else "",
            memory_values=values,
            memory_fixed=("yield_exponent",),
        )
        return replace(found, rig=rig, text="" if unlike else found.text)

    def _of_rig(self, name: str, shape: Shape, own: Array) -> dict[str, Array] | None:
        """Return the property of rig or record (d,) that a term is, by path; None of others."""
        unknown = self.records[0].unknown
        if name in SHAPED:
            return {name: np.full(len(own), shape[0])}
        if name in unknown:
            return {name: unknown[name].given + own[:, 0]}
        if name in PATHS:
            path = {"inertia": self.inertia_path, "offset": self.offset}.get(name, name)
            return {path: own[:, 0] if own.shape[1] == 1 else np.linalg.norm(own, axis=1)}
        return None

    def _normals(self, rig: Mapping[str, Array], count: int) -> Array:
        """Return the normal forces (d,) of draws, which parameters that were found may change."""
        found = np.full(count, self.normal)
        for path, (slope, given) in self.load_slopes.items():
            found = found + slope * (rig[path] - given)
        return np.asarray(np.maximum(found, 1e-9 * self.normal))

    @cached_property
    def _rest(self) -> Steady:
        return self.at(self.frame.low)

    def width(self, name: str, shape: Shape) -> int:
        """Return the number of coefficients of a term."""
        if (name, shape) not in self._widths:
            one = np.reshape(self.terms[name].columns(self._rest, shape), (1, -1))
            self._widths[name, shape] = one.shape[1]
        return self._widths[name, shape]


def _made(
    records: Sequence[Record],
    like: RecordsProblem | None,
    band: float,
    normal: float,
    inertia_path: str,
    load_slopes: Mapping[str, tuple[float, float]] | None,
    offset: str,
) -> RecordsProblem:
    return RecordsProblem(
        records, like=like, band=band, normal=normal, inertia_path=inertia_path,
        load_slopes=load_slopes, offset=offset,
    )  # fmt: skip


def readings(
    ensemble: Ensemble, residual: Array, other: RecordsProblem, level: float = 0.95
) -> PredictionBand:
    """Return the band of the response of other records: what laws predict, and the noise."""
    problem = ensemble.problem
    speed = np.abs(problem.rows.seen(problem.rows.velocity))
    order = np.argsort(speed)
    place = np.searchsorted(speed[order], np.abs(other.rows.seen(other.rows.velocity)))
    rng = np.random.default_rng(ensemble.seed + 3)
    curves = ensemble.curves(other.rows)
    near = max(len(speed) // NEIGHBOURS, 10)  # rows with about the same speed share their noise
    at = place + rng.integers(-near, near + 1, size=curves.shape)
    return band_of(curves + residual[order][np.clip(at, 0, len(order) - 1)], level)


def mean_frequency(records: Sequence[Record]) -> float:
    """Return the mean frequency of the motion [Hz]: of positions, or of velocities if higher."""
    found = []
    for one in records:
        h = float(np.median(np.diff(one.time)))
        width = max(len(one.time) // 400, 1)
        kernel = np.ones(width) / width
        q = np.convolve(one.position, kernel, mode="valid")
        v = np.gradient(q, h)[2:-2]
        if one.velocity is not None:
            v = np.convolve(one.velocity, kernel, mode="valid")[2:-2]
        v = np.convolve(v, kernel, mode="valid")
        a = np.gradient(v, h)
        of_position = float(np.std(v)) / max(float(np.std(q)), 1e-300)
        of_velocity = float(np.std(a)) / max(float(np.sqrt(np.mean(v * v))), 1e-300)
        found.append(max(of_position, of_velocity) / (2.0 * math.pi))
    return float(np.median(found))


def _allowed_band(records: Sequence[Record], noise: float) -> float:
    """Return the band [Hz] in which noise of the sensor is an acceleration of a size [m/s^2]."""
    h = max(float(np.median(np.diff(one.time))) for one in records)
    if records[0].velocity is None:
        ratio = noise / max(noise_of(one.position) for one in records)
        return float((5.0 * ratio**2 / (2.0 * h * (2.0 * math.pi) ** 4)) ** 0.2)
    ratio = noise / max(noise_of(one.velocity) for one in records if one.velocity is not None)
    return float((3.0 * ratio**2 / (2.0 * h * (2.0 * math.pi) ** 2)) ** (1.0 / 3.0))


def _by_best_sensor(records: Sequence[Record]) -> list[Record]:
    """Return records without velocities where positions tell accelerations better."""
    both = all(one.velocity is not None and one.located for one in records)
    if not both:
        return list(records)
    bare = [replace(one, velocity=None) for one in records]
    f = mean_frequency(bare)
    typical = (2.0 * math.pi * f) * float(np.std(np.asarray(records[0].velocity)))
    by_position = _allowed_band(bare, SHARE * typical)
    return bare if by_position > _allowed_band(records, SHARE * typical) else list(records)


def _alike(records: Sequence[Record], first: Record) -> list[Record]:
    """Return records with the sensors that were used of others."""
    if first.velocity is None:
        return [replace(one, velocity=None) for one in records]
    return list(records)


def _band(records: Sequence[Record]) -> float:
    """Return the band [Hz] in which noise of the motion costs little of the force."""
    h = max(float(np.median(np.diff(one.time))) for one in records)
    mean = mean_frequency(records)
    longest = max(float(one.time[-1] - one.time[0]) for one in records)
    top = min(SAMPLED / h, WIDEST * mean)
    low = min(max(NARROWEST * mean, STRETCHES / longest), SAMPLED / h)
    top = max(top, low)
    first = records[0]
    if first.friction:
        return top
    trial = Along(records, None, min(20.0 * mean + low, top))
    if first.inertia is None or any(one.inertia for one in first.unknown.values()):
        v = trial.seen(trial.velocity)
        slow = 0.02 * float(np.quantile(np.abs(v), 0.98)) + 1e-300
        x = np.column_stack([
            trial.acceleration, np.tanh(v / slow), v, np.ones_like(v),
            *(trial.taken(path) for path, one in first.unknown.items() if not one.inertia),
        ])  # fmt: skip
        inertia = abs(float(np.linalg.lstsq(x, trial.force, rcond=None)[0][0]))
    else:
        inertia = first.inertia
    allowed = SHARE * float(np.std(trial.force))
    if not np.any(trial.raw):  # a free motion: friction is what is left
        left = Along(records, None, low)
        allowed = 0.1 * float(np.std(left.force - inertia * left.acceleration))
    band = _allowed_band(records, allowed / max(inertia, 1e-300))
    return float(np.clip(band, low, top))


def _frame(rows: Along, band: float) -> Frame:
    """Return what the columns of records are scaled by."""
    speed = np.abs(rows.seen(rows.velocity))
    top = float(np.quantile(speed, 0.99))
    low = max(top / 200.0, float(np.quantile(speed, 0.02)))
    knots = np.unique(np.log(np.maximum(np.quantile(speed, np.linspace(0.02, 1.0, KNOTS)), low)))
    bend = np.diff(np.eye(len(knots)), 2, axis=0)
    values, basis = np.linalg.eigh(bend.T @ bend)
    values = np.where(values < 1e-8 * values.max(), 0.0, values)
    low_x, high_x = float(rows.position.min()), float(rows.position.max())
    loads = [one.load for one in rows.records if one.load is not None]
    varies = bool(loads) and float(np.ptp(np.concatenate(loads))) > 0.05 * float(
        np.median(loads[0])
    )
    names = set.intersection(*({*one.inputs} for one in rows.records))
    inputs = {name: np.concatenate([one.inputs[name] for one in rows.records]) for name in names}
    return Frame(
        band=band,
        noise=rows.noise,
        top=top,
        low=low,
        middle=0.5 * (low_x + high_x),
        relaxed=0.0 if low_x <= 0.0 <= high_x else 0.5 * (low_x + high_x),
        span=high_x - low_x,
        start=float(rows.records[0].time[0]),
        duration=max(float(one.time[-1] - one.time[0]) for one in rows.records),
        load=float(np.exp(np.mean(np.log(np.concatenate(loads))))) if varies else 1.0,
        inputs={name: float(np.mean(x)) for name, x in sorted(inputs.items()) if np.ptp(x) > 0.0},
        knots=knots,
        basis=basis,
        bending=values,
        size=float(np.sqrt(np.mean(rows.force**2))) or 1.0,
    )


def _blocks(rows: Along) -> tuple[NDArray[np.intp], list[Mask], list[Mask]]:
    """Return the number of the stretch of each row, blocks, and rows that are near each."""
    count, at = rows.count, np.arange(rows.count)
    parts = max(min(STRETCHES, count), 1)
    stretch = np.minimum(at * parts // max(count, 1), parts - 1)
    per = rows.filters[0].every * rows.filters[0].step * rows.band
    gap = math.ceil(APART / per)
    blocks = [stretch == k for k in range(parts)]
    near = []
    for block in blocks:
        own = np.flatnonzero(block)
        close = (at >= own[0] - gap) & (at <= own[-1] + gap)
        near.append(block | (close & np.isin(rows.record, np.unique(rows.record[block]))))
    for k in range(len(rows.records)):
        if len(rows.records) > 1 and np.any(rows.record == k):
            blocks.append(rows.record == k)
            near.append(rows.record == k)
    return stretch, blocks, near


def _screened(problem: RecordsProblem) -> tuple[list[Shape], list[float], list[float]]:
    """Return the memories whose plain law leaves least, and wave numbers of what is left.

    Those of the force, then those of the level: of what is left times the direction.
    """
    rows, frame = problem.rows, problem.frame
    lengths = np.geomspace(SHORTEST * frame.noise, frame.span / 4.0, LENGTHS)
    plain = [np.ones(rows.count), rows.seen(rows.velocity)]
    plain += [rows.acceleration] if problem.finds_inertia else []
    plain += [rows.taken(path) for path in problem.records[0].unknown]
    left: dict[Shape, tuple[float, Array]] = {}

    def try_(memory: Shape) -> None:
        x = np.column_stack([*plain, rows.seen(rows.state(*memory) * rows.load)])
        x = x / np.sqrt(np.mean(x * x, axis=0) + 1e-300)
        gram = x.T @ x + 1e-9 * len(x) * np.eye(x.shape[1])
        e = problem.response - x @ np.linalg.solve(gram, x.T @ problem.response)
        left[memory] = float(np.mean(e * e)), e

    for n in EXPONENTS:
        for x in lengths:
            try_((float(x), n))
    ratio = float(lengths[1] / lengths[0])
    best = []
    for n in EXPONENTS:
        for k in range(HALVINGS):  # about the best, halfway to its neighbours
            top = min((one for one in left if one[1] == n), key=lambda one: left[one][0])
            for side in (-1.0, 1.0):
                try_((top[0] * ratio ** (side * 0.5 ** (k + 1)), n))
        best.append(min((one for one in left if one[1] == n), key=lambda one: left[one][0]))
    shorter = _of_two(problem, [(float(x), 1.0) for x in lengths], plain)
    if shorter is not None and all(abs(math.log(shorter[0] / one[0])) > 0.2 for one in best):
        best.append(shorter)
    for memory in [*rows._states]:  # the others are not needed any more
        if memory not in best:
            del rows._states[memory]
    try_((0.0, 0.0))
    e = min(left.values(), key=lambda one: one[0])[1]
    q, side = rows.seen(rows.place), rows.seen(rows.direction * rows.load)
    most = min(120.0 * math.pi / frame.span, math.pi / (8.0 * frame.noise))
    numbers = np.arange(3.0 * math.pi / frame.span, most, 0.5 / frame.span)
    few = slice(None, None, max(rows.count // 1500, 1))
    turning = np.exp(-1j * np.outer(numbers, q[few]))
    best.sort(key=lambda one: left[one][0])
    first, second = (_peaks(numbers, turning @ one[few]) for one in (e, side * e))
    return [(0.0, 0.0), *best], first, second


def _of_two(
    problem: RecordsProblem, memories: Sequence[Shape], plain: Sequence[Array]
) -> Shape | None:
    """Return the shorter of two memories that together leave much less than the best one alone."""
    rows = problem.rows
    states = [rows.seen(rows.state(*one) * rows.load) for one in memories]
    x = np.column_stack([*plain, *states])
    x = x / np.sqrt(np.mean(x * x, axis=0) + 1e-300)
    gram, moment = x.T @ x + 1e-9 * len(x) * np.eye(x.shape[1]), x.T @ problem.response
    n, total = len(plain), float(problem.response @ problem.response)

    def left(*which: int) -> float:
        at = [*range(n), *(n + k for k in which)]
        c = np.linalg.solve(gram[np.ix_(at, at)], moment[at])
        return total - float(c @ moment[at]) if np.all(c[n:] > 0.0) else math.inf

    count = len(memories)
    pairs = {(i, j): left(i, j) for i in range(count) for j in range(i + 1, count)}
    best = min(pairs, key=lambda one: pairs[one])
    alone = min(left(k) for k in range(count))
    return memories[best[0]] if pairs[best] < (1.0 - PAIRED) * alone else None


def _peaks(numbers: Array, spectrum: Any) -> list[float]:
    """Return the wave numbers of the largest peaks of a spectrum."""
    power = np.abs(spectrum)
    peaks = np.flatnonzero((power[1:-1] >= power[:-2]) & (power[1:-1] >= power[2:])) + 1
    return [float(numbers[j]) for j in sorted(peaks.tolist(), key=lambda j: -power[j])[:WAVES]]


def _references(problem: RecordsProblem, memories: Sequence[Shape]) -> list[Structure]:
    base: list[Column] = [(name, ()) for name in problem.always - {"offset"}]
    constant: list[Column] = [("offset", ())] if problem.offset else []
    gear = TRANSMITTED in problem.frame.inputs
    return [
        tuple(
            sorted(
                [
                    *base,
                    ("curve", (*memory, side, bend)),
                    *constant,
                    *([("gear", memory)] if gear else []),
                ]
            )
        )
        for memory in memories
        for side in (0.0, 1.0)
        for bend in BENDING
    ]


def _by_curve(problem: RecordsProblem) -> tuple[Array, Array]:
    """Return the columns (n, p) of the measured curve, of size 1, and what they leave (n,)."""
    rows = problem.rows
    left, found = math.inf, (np.zeros((0, 0)), np.zeros(0))
    for structure in problem.references:
        x = np.hstack([np.reshape(problem.terms[name].columns(rows, shape), (rows.count, -1))
                       for name, shape in structure])  # fmt: skip
        x = x / (np.sqrt(np.mean(x * x, axis=0)) + 1e-300)
        gram = x.T @ x + 1e-6 * len(x) * np.eye(x.shape[1])
        e = problem.response - x @ np.linalg.solve(gram, x.T @ problem.response)
        if np.median(np.abs(e)) < left:
            left, found = float(np.median(np.abs(e))), (x, e)
    return found


def goes_straighter(problem: RecordsProblem) -> bool:
    """Return whether forces that were taken as held go straight from sample to sample instead.

    The measured curve then leaves less of them half a sample earlier.
    """
    rows = problem.rows
    if not any(one.held for one in rows.records):
        return False
    late = [
        f(one.force) - f(one.force, late=0.5 * f.step * one.held)
        for one, f in zip(rows.records, rows.filters, strict=True)
    ]
    x, left = _by_curve(problem)
    y = problem.response + rows.rows_of(late)
    gram = x.T @ x + 1e-6 * len(x) * np.eye(x.shape[1])
    other = y - x @ np.linalg.solve(gram, x.T @ y)
    return bool(np.median(np.abs(other)) < np.median(np.abs(left)))


def _spread(problem: RecordsProblem) -> float:
    """Return how far another record differs, over the covariance of the mean of stretches.

    Of R records alike, another differs by R times the variance of their mean, which is that of
    sums over records of the scores of the fit over that of sums over stretches. One record tells
    nothing of it; few are weighed with the usual `SPREAD`.
    """
    count = len(problem.records)
    if count < 2:
        return SPREAD
    x, left = _by_curve(problem)
    inverse = np.linalg.pinv(x.T @ x + 1e-6 * len(x) * np.eye(x.shape[1]), hermitian=True)
    e = np.clip(left, *np.quantile(left, (0.01, 0.99)))

    def variance(groups: NDArray[np.intp]) -> float:
        scores = np.zeros((int(groups.max()) + 1, x.shape[1]))
        np.add.at(scores, groups, x * e[:, None])
        own = len(np.unique(groups))
        return float(np.sum((x @ inverse @ scores.T) ** 2)) * own / max(own - 1, 1)

    ratio = variance(problem.rows.record) / (variance(problem.stretches) + 1e-300)
    found = (1.0 + count) * max(ratio, 1.0 / count)
    share = (count - 1.0) / (count - 1.0 + LIKELY)
    return float(SPREAD ** (1.0 - share) * found**share)


def _alike_terms(rows: Along, path: str, terms: Sequence[Term]) -> frozenset[str]:
    """Return the terms that are the same columns as a parameter that is looked for, or a constant.

    What one says the other need not: of both, the share of each would be open.
    """
    x = np.column_stack([rows.taken(path), np.ones(rows.count)])
    x = x / (np.sqrt(np.mean(x * x, axis=0)) + 1e-300)
    found = set[str]()
    for term in terms:
        if term.role == "curve" or term.name == "offset" or not term.shapes:
            continue
        y = np.reshape(term.columns(rows, term.shapes[0]), (rows.count, -1))
        left = y - x @ np.linalg.lstsq(x, y, rcond=None)[0]
        if np.sqrt(np.mean(left * left)) < SAME * np.sqrt(np.mean(y * y)):
            found.add(term.name)
    return frozenset(found)


def _fading(clock: Array, constant: float) -> Array:
    """Return a drift over time (n,): straight, or one that fades with a time constant."""
    return clock if constant == 0.0 else np.exp(-(clock + 0.5) / constant)


def _terms(  # noqa: C901  # a vocabulary is a list
    problem: RecordsProblem,
    memories: Sequence[Shape],
    waves: Sequence[float],
    level_waves: Sequence[float],
) -> dict[str, Term]:
    """Return the vocabulary of records."""
    rows, frame = problem.rows, problem.frame
    driven = bool(np.any(rows.raw)) and not problem.records[0].friction
    loaded = frame.load != 1.0
    lengths = np.geomspace(SHORTEST * frame.noise, frame.span / 4.0, LENGTHS)
    ratio = float(lengths[1] / lengths[0])
    speeds = np.geomspace(frame.low, frame.top, SPEEDS)
    faster = float(speeds[1] / speeds[0])
    falls = [(float(v), float(n)) for v in speeds for n in (1, 2)]
    loads: list[Shape] = [(), (0.67,), (0.8,)] if loaded else [()]
    base = frozenset({"level", "curve", *(["adhesion"] if loaded else [])})
    flows = frozenset({"power", "drag", "saturating"})

    def law(of: Callable[[Any, Shape], Array]) -> Callable[[Any, Shape], Array]:
        return lambda r, s: r.seen(of(r, s))

    def on_state(of: Callable[[Any, Shape], Array]) -> Callable[[Any, Shape], Array]:
        """Return columns of the state of the memory, which the shape begins with."""

        def columns(r: Any, shape: Shape) -> Array:
            z, x = r.state(*shape[:2]) * r.load, of(r, shape[2:])
            return np.asarray(r.seen(z * x if x.ndim == 1 else z[:, None] * x))

        return columns

    def curve(r: Any, shape: Shape) -> Array:
        x = r.knotted()
        hats = np.array([np.interp(x, frame.knots, one) for one in frame.basis.T]).T
        z = (r.state(*shape[:2]) * r.load)[:, None]
        return np.asarray(r.seen(np.hstack([z * hats, np.abs(z) * hats]) if shape[2] else z * hats))

    def of_memory(*own: Shape) -> list[Shape]:
        return [(*memory, *one) for memory in memories for one in own]

    on_memory: dict[str, Any] = {"shared": 2}
    step = (ratio**0.25, 1.0)  # the screening went as far as that
    terms = [
        Term(name="level", role="law", columns=on_state(
                lambda r, s: np.ones(len(r.velocity)) if not s else r.load ** (s[0] - 1.0)),
             shapes=of_memory(*loads), steps=(*step, 1.15), nonnegative=True, title=TITLES["level"],
             rank=0, **on_memory),
        Term(name="viscous", role="law", columns=law(lambda r, _: r.velocity),
             title=TITLES["viscous"], rank=1),
        Term(name="offset", role="rig", columns=law(lambda r, _: np.ones(len(r.velocity))),
             title=TITLES["offset"], rank=2),
        Term(name="stribeck", role="law",
             columns=on_state(lambda r, s: np.exp(-(np.abs(r.velocity) / s[0]) ** s[1])),
             shapes=of_memory(*falls), steps=(*step, faster, 1.0), nonnegative=True, needs=base,
             title=TITLES["stribeck"], rank=4, **on_memory),
        Term(name="viscous_direction", role="law", columns=law(lambda r, _: np.abs(r.velocity)),
             needs=frozenset({"viscous", "power", "drag"}),
             title=TITLES["viscous_direction"], rank=5),
        Term(name="level_direction", role="law", needs=base,
             columns=lambda r, s: r.seen(np.abs(r.state(*s)) * r.load), steps=step,
             # without a memory it is an offset
             shapes=[one for one in memories if one[0] > 0.0 or not problem.offset],
             title=TITLES["level_direction"], rank=5, **on_memory),
        Term(name="drag", role="law", columns=law(lambda r, _: r.velocity * np.abs(r.velocity)),
             excludes=flows - {"drag"}, nonnegative=True,
             title=TITLES["drag"], rank=6),
        Term(name="power", role="law",
             columns=law(lambda r, s: np.sign(r.velocity) * np.abs(r.velocity) ** s[0]),
             shapes=[(p,) for p in (0.33, 0.5, 0.67, 0.8, 1.5)], steps=(1.25,), nonnegative=True,
             excludes=(flows | {"viscous"}) - {"power"}, title=TITLES["power"], rank=7),
        Term(name="stribeck_direction", role="law", needs=frozenset({"stribeck"}),
             columns=law(lambda r, s: np.exp(-(np.abs(r.velocity) / s[0]) ** s[1])),
             shapes=falls, steps=(faster, 1.0),
             title=TITLES["stribeck_direction"], rank=8),
        Term(name="second", role="law", needs=frozenset({"level", "curve"}),
             columns=law(lambda r, s: r.state(*s) * r.load),
             shapes=[(float(x), n) for x in lengths for n in (0.0, 1.0)], steps=(ratio, 1.0),
             nonnegative=True, title="second memory", rank=9),
        Term(name="place", role="law", needs=base, cost=2, columns=on_state(
                lambda r, _: np.column_stack([r.place / frame.span, (r.place / frame.span) ** 2])),
             shapes=of_memory(()), steps=step, title="level that changes with the place", rank=10,
             **on_memory),
        Term(name="drift", role="rig", needs=base,
             columns=on_state(lambda r, s: _fading(r.clock, s[0])),
             shapes=of_memory(*((x,) for x in RUNNING_IN)), steps=(*step, 1.5),
             title="level that changes with time", rank=13, **on_memory),
        Term(name="viscous_drift", role="rig", needs=frozenset({"viscous", "power", "drag"}),
             columns=law(lambda r, s: r.velocity * _fading(r.clock, s[0])),
             shapes=[(x,) for x in RUNNING_IN], steps=(1.5,),
             title="viscous friction that changes with time", rank=14),
        Term(name="offset_drift", role="rig", needs=frozenset({"offset"}),
             columns=law(lambda r, s: _fading(r.clock, s[0])),
             shapes=[(x,) for x in RUNNING_IN], steps=(1.5,),
             title="offset that changes with time", rank=15),
        Term(name="spring", role="rig", columns=law(lambda r, _: r.stretch), title="spring",
             rank=15),
        Term(name="bow", role="rig", columns=law(lambda r, _: r.place**2), rank=16,
             title="force that bends with the place"),
        Term(name="curve", role="curve", columns=curve, shapes=(), cost=5,
             precision=lambda shape: shape[3] * np.tile(frame.bending, 1 + int(shape[2])),
             title=TITLES["curve"], **on_memory),
    ]  # fmt: skip
    if waves and level_waves:
        terms += [
            Term(name="ripple", role="rig", cost=2, shapes=[(k,) for k in waves], steps=(1.02,),
                 columns=law(lambda r, s: r.wave(s[0])), title="ripple over the place",
                 rank=11),
            Term(name="level_ripple", role="law", cost=2, needs=base,
                 columns=on_state(lambda r, s: r.wave(s[0])),
                 shapes=of_memory(*((k,) for k in level_waves)), steps=(*step, 1.02),
                 title="level that ripples over the place", rank=12, **on_memory),
        ]  # fmt: skip
    if loaded:
        terms.append(
            Term(name="adhesion", role="law", columns=on_state(lambda r, _: 1.0 / r.load),
                 shapes=of_memory(()), steps=step, nonnegative=True,
                 title="level that no load changes", rank=3, **on_memory)
        )  # fmt: skip
    if TRANSMITTED in frame.inputs:
        terms.append(
            Term(name="gear", role="law", columns=on_state(
                    lambda r, _: (r.input(TRANSMITTED) + frame.inputs[TRANSMITTED]) / r.load),
                 shapes=of_memory(()), steps=step, nonnegative=True, rank=3,
                 title="share of what the gear transmits", **on_memory)
        )  # fmt: skip
    for name in frame.inputs.keys() - {TRANSMITTED}:
        terms += [
            Term(name=f"level*{name}", role="law", needs=base, shapes=of_memory(()), steps=step,
                 columns=on_state(lambda r, _, name=name: r.input(name)),  # type: ignore[misc]
                 title=CHANGING["level"].format(name), rank=10, **on_memory),
            Term(name=f"viscous*{name}", role="law", needs=frozenset({"viscous"}), rank=11,
                 columns=law(lambda r, _, name=name: r.velocity * r.input(name)),  # type: ignore[misc]
                 title=CHANGING["viscous"].format(name)),
        ]  # fmt: skip
    if any(one.mechanism is not None for one in problem.records):
        terms.append(
            Term(name="mechanism", role="rig", columns=lambda r, _: r.mechanism, rank=3,
                 limits=(-2.0, 2.0), title="known forces larger or smaller than given")
        )  # fmt: skip
    if problem.finds_inertia:
        terms.append(
            Term(name="inertia", role="rig", columns=lambda r, _: r.acceleration,
                 nonnegative=True, title="inertia", rank=0)
        )  # fmt: skip
    for path, one in problem.records[0].unknown.items():
        terms.append(
            Term(name=path, role="rig", columns=lambda r, _, path=path: r.taken(path),  # type: ignore[misc]
                 limits=one.limits, rank=0, title=path.rpartition(".")[2].replace("_", " "),
                 excludes=_alike_terms(rows, path, terms))
        )  # fmt: skip
    if driven or problem.records[0].friction:
        late = LATEST / mean_frequency(problem.records)
        # the noise of positions leaves the moment of a reversal open by as much
        rate = float(np.sqrt(np.mean(rows.acceleration**2)))
        least = max(rows.filters[0].step, 0.5 * math.sqrt(2.0 * frame.noise / rate))
        delays = np.geomspace(least, max(late, 2.0 * least), 7)
        terms += [
            Term(name="lag", role="rig", columns=lambda r, _: r.force_rate, limits=(-late, 0.0),
                 title="lag of the force", rank=17),
            Term(name="delay", role="rig", columns=lambda r, s: r.early(s[0]), limits=LATER,
                 shapes=[(side * float(x),) for x in delays for side in (1.0, -1.0)],
                 steps=(float(delays[1] / delays[0]),), cost=0, excludes=frozenset({"lag"}),
                 title="delay of the force", rank=17),
        ]  # fmt: skip
    if driven:
        limits = np.quantile(np.abs(rows.raw), (0.85, 0.93, 0.97))
        rings = np.geomspace(0.1, RINGS, 8) * frame.band
        gaps = np.geomspace(30.0 * frame.noise, frame.span / 16.0, 6)
        terms += [
            Term(name="clip", role="fault", columns=lambda r, s: r.seen(r.excess(s[0])),
                 shapes=[(float(x),) for x in limits], steps=(float(limits[1] / limits[0]),),
                 limits=(0.7, 1.3), title="force that is clipped", rank=18),
            Term(name="backlash", role="fault", columns=lambda r, s: r.loose(s[0]),
                 shapes=[(float(x),) for x in gaps], steps=(float(gaps[1] / gaps[0]),),
                 nonnegative=True, title="backlash", rank=19, needs=problem.always),
            Term(name="flexible", role="fault", needs=problem.always,
                 columns=lambda r, s: r.seen(r.ringing(r.full_acceleration(), s[0])),
                 shapes=[(float(x),) for x in rings], steps=(float(rings[1] / rings[0]),),
                 nonnegative=True, title="flexible coupling", rank=20),
        ]  # fmt: skip
        if not problem.finds_inertia and problem.records[0].inertia:
            inertia = problem.records[0].inertia
            terms.append(
                Term(name="inertia_error", role="fault", columns=lambda r, _: r.acceleration,
                     limits=(-0.7 * inertia, inertia), rank=16,
                     title="inertia, or gain of the force, other than given")
            )  # fmt: skip
    left_out = set[str]() if problem.offset else {"offset", "offset_drift"}
    if len(np.unique(np.sign(rows.direction))) < 2:  # places pass once, as times do
        left_out |= {"place", "spring", "bow", "ripple", "level_ripple"}
    if not driven and not problem.records[0].friction:  # a free motion slows with time
        left_out |= {"drift", "viscous_drift", "offset_drift"}
        if problem.always - {"offset"}:  # all other forces are known by those of the mechanism
            left_out |= {"mechanism"}
    return {one.name: one for one in terms if one.name not in left_out}
