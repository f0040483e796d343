r"""What a record says before any run: its motion between gaps, and a plain balance of its forces.

With a Butterworth low pass :math:`P`, forward and backward on all columns, least squares give

.. math::
    P F = J\, P \ddot x + c\, P \dot x + F_c\, P\, \mathrm{sgn}\, \dot x + o

where searches begin: an inertia, a level, a viscous part and a constant force.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement, as_recorded, between_gaps, with_voltage
from stickslip.errors import InputError
from stickslip.identify.fits.contact_inputs import check_loads, inputs_along, load_along
from stickslip.identify.fits.motions import (
    HARMONICS,
    HIGHEST,
    LEAST,
    ORDER,
    PATH,
    FilteredMotion,
    filtered_motion,
    mean_force,
    passed_by_balance,
    play,
    positive_noise,
    smoothed,
)
from stickslip.identify.fits.record_forces import (
    applied_force,
    goes_straight,
    known_forces,
    positions_of,
)
from stickslip.identify.fits.settings import MOST, ROUNDS, SETTLED, Hold
from stickslip.identify.fits.shooting.initial_states import Path
from stickslip.mechanisms import Mechanism
from stickslip.show.formatting import number

Array = NDArray[np.float64]

HUBER = 1.345
"""Residuals beyond this many standard deviations weigh less; 95 % as efficient as least squares."""
POSITION_SHARE, PARALLEL_SHARE = 0.1, 0.02
"""Shares of the sampling frequency that filters of the position, and of all columns, pass."""
MARGIN = 49
"""Samples dropped at the start, where filters and differences begin."""
CHATTER = 2.0
"""Reach within which positions that bristles follow are chatter, over the noise that is left."""
OVERSAMPLED = 0.25
"""Most that the filter passes over half the frequency of these samples."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """A stretch of a record without a gap, at even times."""

    number: int
    """Which record it is of."""
    mechanism: Mechanism
    """As set in this record."""
    record: Measurement
    """What was measured."""
    time: Array
    """Times (n,) [s]."""
    raw: Array
    """Positions (n,) [m] there."""
    passed: float
    """What the common filter passes, over half the sampling frequency."""
    motion: FilteredMotion
    """The motion, filtered."""
    force: Array
    """What drives it (n,) [N], as second differences see it."""
    mass: float
    """What moves [kg]."""
    rest: Array
    """Forces (n,) [N] but for friction, inertia and a constant."""


def pieces_of(mechanism: Mechanism, measurement: Measurement, hold: Hold) -> Iterator[Piece]:
    """Yield the stretches of records that are long enough to be filtered."""
    for which, given in enumerate(measurement.records()):
        record = with_voltage(mechanism, given, hold)
        set_up = as_recorded(mechanism, record)
        for segment in between_gaps(record):
            count = np.asarray(segment.time).size
            if count < LEAST:
                continue
            recorded = np.asarray(segment.time, dtype=float)
            time = np.linspace(recorded[0], recorded[-1], count)
            raw = np.interp(time, recorded, positions_of(segment))
            passed, dt = passed_by_balance(raw), float(time[1] - time[0])
            motion = filtered_motion(raw, dt, passed, tracked="position" in segment.quantities())
            applied = applied_force(set_up, segment)
            force = np.zeros(count)
            if applied is not None:
                force = mean_force(applied, joined=goes_straight(segment, hold))
                force = np.interp(time, recorded, force)
            mass, rest = known_forces(set_up, motion.position, motion.velocity, force)
            yield Piece(
                number=which,
                mechanism=set_up,
                record=segment,
                time=time,
                raw=raw,
                passed=passed,
                motion=motion,
                force=force,
                mass=mass,
                rest=rest,
            )


@dataclass(frozen=True, kw_only=True, eq=False)
class PlainBalance:
    """What a least-squares balance of forces says.

    Examples
    --------
    >>> from stickslip import Axis
    >>> t = np.arange(0.0, 20.0, 0.01)
    >>> force = -6.0 * np.sin(2.0 * t) + 5.0 * np.sign(np.cos(2.0 * t)) + 0.5
    >>> record = Measurement(time=t, position=np.sin(2.0 * t) / 2.0, force=force)
    >>> found = PlainBalance.of(Axis(inertia=1.0), record, inertia=True)
    >>> {name: round(x, 1) for name, x in found.values.items()}
    {'viscous': 0.0, 'level': 5.0, 'offset': 0.5, 'inertia': 3.0}
    """

    values: Mapping[str, float]
    """Estimates by name; ``"inertia"`` is that of the mechanism where it is not looked for."""
    time: Array
    """Times (n,) [s]."""
    velocity: Array
    """Filtered velocities (n,) [m/s]."""
    friction: Array
    """Force less inertia and springs (n,) [N]: friction and offset."""
    left: float
    """What the balance leaves of the forces, over their root mean square."""

    @classmethod
    def of(cls, mechanism: Mechanism, measurement: Measurement, *, inertia: bool) -> "PlainBalance":
        """Return the balance of a measurement, with its inertia if that is looked for."""
        parts, mass = list[Array](), 0.0
        for given in measurement.records():
            record = with_voltage(mechanism, given, "zero")
            set_up = as_recorded(mechanism, record)
            for segment in between_gaps(record):
                if np.asarray(segment.time).size >= LEAST:
                    mass, columns = _columns(set_up, segment)
                    parts.append(columns)
        if not parts:
            longest = max(len(np.asarray(piece.time)) for record in measurement.records()
                          for piece in between_gaps(record))  # fmt: skip
            raise InputError(
                "a balance of forces, which gives the start values, needs a stretch of at least"
                f" {LEAST} samples without a gap, and the longest has {longest}: record longer, or"
                " resample at even times."
            )
        rest, velocity, level, offset, a, taken, time = np.concatenate(parts).T
        table, wanted = np.column_stack([velocity, level, offset]), rest - taken
        if inertia:
            table, wanted = np.column_stack([table, a]), rest
        values = _solved(table, wanted)
        names = ("viscous", "level", "offset", "inertia")
        result = {"inertia": mass} | dict(zip(names, values.tolist(), strict=False))
        return cls(
            values={name: result[name] for name in names},
            time=time,
            velocity=velocity,
            friction=wanted - table[:, 3:] @ values[3:],
            left=float(np.linalg.norm(wanted - table @ values) / (np.linalg.norm(wanted) + 1e-300)),
        )

    def refuse_nonsense(self, *, driven: bool) -> None:
        """Refuse a motion that friction would have to drive, and forces that explain nothing."""
        said = ", ".join(f"{name} {number(x)}" for name, x in self.values.items())
        if not driven and max(self.values["level"], self.values["viscous"]) < 0.0:
            raise InputError(
                "no drive was given, and friction alone cannot cause this motion: linear regression"
                f" gives {said}. Give the force if there was one; only a free decay needs none."
            )
        if driven and self.values["inertia"] < 0.0 and self.left > MOST:
            raise InputError(
                f"inertia and sliding friction leave {100.0 * self.left:.0f} % of the force: linear"
                f" regression gives {said}, which therefore says nothing. Friction may hold the"
                " body for most of the record, so that it moves by deflection only, or another"
                " force acts. Record moves in which the body slides; check the meaning of each"
                " column."
            )


def _columns(mechanism: Mechanism, record: Measurement) -> tuple[float, Array]:
    """Return what moves [kg], and filtered columns (n, 6) with the times, of one stretch.

    Forces but for friction, velocities, their signs, ones, accelerations and what inertia takes.
    """
    time, x = np.asarray(record.time, dtype=float), positions_of(record)
    dt = float(np.ptp(time)) / (len(time) - 1)
    smooth = _both_ways(x, _share(x, POSITION_SHARE))
    v = np.gradient(smooth, dt)
    applied = applied_force(mechanism, record)
    force = 0.0 * x if applied is None else applied
    kept = slice(min(MARGIN, len(x) // 20), None)
    x, v, a, force = smooth[kept], v[kept], np.gradient(v, dt)[kept], force[kept]
    mass, rest = known_forces(mechanism, x, v, force)
    columns = np.column_stack([rest, v, np.sign(v), np.ones_like(v), a, mass * a])
    return mass, np.column_stack([_both_ways(columns, _share(x, PARALLEL_SHARE)), time[kept]])


def _share(x: Array, least: float) -> float:
    """Return what a filter passes, over half the sampling frequency."""
    mean = float(np.std(np.diff(x))) / max(2.0 * np.pi * float(np.std(x)), 1e-300)
    return 2.0 * min(max(least, HARMONICS * mean), max(HIGHEST, least))


def _both_ways(columns: Array, share: float) -> Array:
    """Return columns (n, ...) after the low pass, mirrored over three samples an order."""
    from scipy import signal

    b, a = signal.butter(ORDER, share)
    return np.asarray(signal.filtfilt(b, a, columns, axis=0, padlen=3 * (max(len(a), len(b)) - 1)))


def _solved(table: Array, wanted: Array) -> Array:
    """Return least-squares values (p,), large residuals weighing less (Huber)."""
    size = np.linalg.norm(table, axis=0)
    scaled = table / np.where(size > 0.0, size, 1.0)
    values = np.asarray(np.linalg.lstsq(table, wanted, rcond=None)[0], dtype=float)
    for _ in range(ROUNDS):
        residual = wanted - table @ values
        deviation = 1.4826 * float(np.median(np.abs(residual))) or 1.0
        weights = np.minimum(1.0, HUBER * deviation / np.maximum(np.abs(residual), 1e-300))
        weighted = scaled.T * weights
        before = values
        normal = np.linalg.lstsq(weighted @ scaled, weighted @ wanted, rcond=1e-12)[0]
        values = np.asarray(normal / np.where(size > 0.0, size, 1.0), dtype=float)
        if np.max(np.abs(values - before) * size) <= SETTLED * np.max(np.abs(values) * size):
            break
    return values


def motions_of(
    mechanism: Mechanism, measurement: Measurement, *, hold: Hold, samples: float
) -> list[tuple[int, Path, float]]:
    """Return records between gaps: which it is, its motion, and what held it at first [N].

    Bristles follow the motion as finely as noise allows even where the common filter passes less:
    unlike friction, what they do is not linear in the motion, and no filter makes up for it.

    Examples
    --------
    >>> from stickslip import Axis
    >>> t = np.arange(0.0, 20.0, 0.01)
    >>> record = Measurement(time=t, position=np.sin(2.0 * t), force=np.cos(t))
    >>> ((number, path, held),) = motions_of(Axis(inertia=3.0), record, hold="zero", samples=2e3)
    >>> number, len(path.travel), round(held, 6)
    (0, 1999, 1.0)
    """
    check_loads(measurement)
    result = []
    for item in pieces_of(mechanism, measurement, hold):
        if item.motion.resting.all():
            continue
        x, v, count = item.motion.position, item.motion.velocity, len(item.time)
        inputs = inputs_along(
            item.mechanism, item.record, item.time, position=x, velocity=v, force=item.force
        )
        every = max(1, min(math.ceil(count / samples), int(OVERSAMPLED / item.passed)))
        picked = slice(None, None, every)
        path = Path(
            time=item.time[picked],
            velocity=v[picked],
            load=load_along(item.mechanism, item.record, count)[picked],
            travel=np.diff(travelled(item.raw)[picked]),
            inputs={name: values[picked] for name, values in inputs.items()},
        )
        result.append((item.number, path, float(item.rest[0])))
    return result


def travelled(raw: Array) -> Array:
    """Return positions (n,) along which bristles move, freed of chatter.

    Noise of positions at rest relaxes a bristle: they stay where they are within its reach. Beyond
    it they are the measured ones again: left behind by the reach, as by play, they would lose a way
    at each reversal, and Dahl friction seemed 7 to 20 % stiffer than it was, with 80 um to yield
    and 0.6 to 2 um of noise; so, 2 to 3 %.
    """
    band = PATH * min(passed_by_balance(raw, resolved=True), HIGHEST)
    x = smoothed(raw, band)
    moved = np.diff(play(x, CHATTER * positive_noise(raw) * math.sqrt(band)), prepend=math.inf)
    return np.asarray(x[np.maximum.accumulate(np.where(moved, np.arange(len(x)), 0))])
