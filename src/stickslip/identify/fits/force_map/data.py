"""Records of friction, made ready to be predicted along their measured motion."""

import functools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from stickslip.data import (
    Measurement,
    noise_of,
    resting_readings,
    step_of,
    usual_top_speed,
)
from stickslip.errors import InputError, check_even_times
from stickslip.identify.fits.contact_inputs import inputs_along
from stickslip.identify.fits.estimation.bristle_integration import Path
from stickslip.identify.fits.settings import LEAST
from stickslip.identify.fits.signals import GAP, LowPass, low_pass
from stickslip.mechanisms import Mechanism, normal_of, only_contact
from stickslip.quantities import vary
from stickslip.show.formatting import joined, number

Array = NDArray[np.float64]

QUIET = 0.005
"""Standard deviation that noise may leave in velocities, over the largest speed. The less they are
smoothed, the less reversals shift."""
BENDING = 0.3
"""Half the length of the parabolas that give velocities, over the mean period per radian, at most:
they take 1 % off the speed of a sine."""
GROWTH = 1.2
"""Factor between the lengths of parabolas that are tried for velocities."""
SEGMENTS = 40
"""Segments of a record where no length is given, and of a table at most."""
BEYOND = 4.0
"""Standard deviations of the noise of positions from which a displacement is one: one in 16,000
samples of normal noise lies beyond."""
FINEST = 1e-5
"""Least displacement over the range of positions that is resolved: what is finer may come from a
filter before the record."""
SLOW = 0.01
"""Share of the largest speed below which a body may be at rest, if positions do not change."""
SLOWEST = 0.1
"""Share of the largest speed that a law may take as unresolved at most."""
CREEPING = 1e-3
"""Share of the largest speed that a displacement within what is resolved may have at rest."""

FEWEST = 5
"""Rows that a table must have: three unknowns, and what tells whether they hold."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionSegment:
    """A record between two gaps, or a table: friction, and the motion that it came with."""

    record: int
    """Which record it is of."""
    path: Path
    """The motion; the times of a table are its row numbers."""
    friction: Array
    """Friction force (n,) [N], measured or derived."""
    segment: NDArray[np.intp]
    """Segment that each sample belongs to (n,); below 0 if it is not compared."""
    timed: bool = True
    """Whether the samples are a motion in time; those of a table are not."""
    regressors: Array | None = None
    """What a unit of each parameter of the mechanism takes off derived friction (n, k), filtered as
    it is: of a mass, the acceleration."""
    resting: NDArray[np.bool_] | None = None
    """Samples (n,) at which the sensor resolves no motion; None where this is not known."""
    held: Array | None = None
    """Friction (n,) [N] that would balance all other forces on a body at rest."""
    held_regressors: Array | None = None
    """What a unit of each parameter takes off that (n, k), not filtered; None for nothing."""
    applied: Array | None = None
    """Force that was applied (n,) [N], filtered as friction is; None where nothing needs it."""
    resolution: float = 0.0
    """Displacement [m] that the sensor may not resolve."""
    slack: float = 0.0
    """Force [N] by which noise of a friction sensor exceeds what holds a body at rest."""
    slowness: float = 0.0
    """Speed [m/s] that samples at rest may have without memory of it: it was not resolved."""
    passed: float = 0.0
    """What the filter of derived friction passes, over half the sampling frequency; 0 if none."""
    blur: float = 0.0
    """Weight of both neighbours of a sample in the mean force that second differences see. A
    triangle from one original sample before to one after has a variance of a sixth of a step."""
    zeros: Array | None = None
    """What a unit of the zero of each position adds to derived friction (n, m), filtered as it is;
    None where positions count from where the mechanism's do."""
    weighed: bool = False
    """Whether the load is the weight of the mechanism's mass."""

    def rows_of(self, segments: Sequence[int] | None) -> NDArray[np.bool_]:
        """Return which samples (n,) are of some segments; all if none are given."""
        if segments is None:
            return self.segment >= 0
        return np.isin(self.segment, np.asarray(segments, dtype=np.intp))

    def seen(self, force: Array) -> Array:
        """Return forces (n,) or (n, copies) as the friction of the stretch shows them: filtered."""
        if not self.passed:
            return force
        padded = np.concatenate([force[:1], force, force[-1:]])
        bend = padded[:-2] - 2.0 * force + padded[2:]
        return smoothed(force + self.blur * bend, self.passed)

    def loaded(self, factor: float) -> "MotionSegment":
        """Return the same motion with a multiple of its load."""
        return replace(self, path=replace(self.path, load=factor * self.path.load))

    def until(self, count: int) -> "MotionSegment":
        """Return the first samples."""
        path = replace(
            self.path,
            time=self.path.time[:count],
            velocity=self.path.velocity[:count],
            load=self.path.load[:count],
            travel=self.path.travel[: count - 1],
            inputs={name: x[:count] for name, x in self.path.inputs.items()},
            input_slopes={name: x[:count] for name, x in self.path.input_slopes.items()},
        )
        return replace(
            self,
            path=path,
            friction=self.friction[:count],
            segment=self.segment[:count],
            regressors=_first(self.regressors, count),
            resting=None if self.resting is None else self.resting[:count],
            held=_first(self.held, count),
            held_regressors=_first(self.held_regressors, count),
            applied=_first(self.applied, count),
            zeros=_first(self.zeros, count),
        )


def moved(one: MotionSegment, change: Array) -> MotionSegment:
    """Return a stretch as if friction had been derived with other parameters of the mechanism."""
    if one.regressors is None:
        return one
    held = one.held
    if held is not None and one.held_regressors is not None:
        held = held - one.held_regressors @ change
    path = one.path.moved(change)
    return replace(one, path=path, friction=one.friction - one.regressors @ change, held=held)


def blur_of(every: int) -> float:
    """Return `MotionSegment.blur` where every so many original samples one was picked.

    Examples
    --------
    >>> 2.0 * blur_of(1), 2.0 * blur_of(3) * 3**2  # the variance, in squared original steps
    (0.16666666666666666, 0.16666666666666666)
    """
    return 1.0 / (12.0 * every**2)


def _first(rows: Array | None, count: int) -> Array | None:
    return None if rows is None else rows[:count]


def stretches_of(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    segment: float | None = None,
    samples: float = np.inf,
) -> tuple[MotionSegment, ...]:
    """Return the stretches of a measurement of friction.

    Examples
    --------
    >>> from stickslip import Axis, Measurement
    >>> table = Measurement(velocity=np.linspace(-1.0, 1.0, 20), friction=np.ones(20))
    >>> (one,) = stretches_of(Axis(inertia=1.0, load=5.0), table)
    >>> one.timed, float(one.path.load[0])
    (False, 5.0)
    """
    if segment is not None and not segment > 0.0:
        raise InputError(f"segment must be above 0 s, got {segment!r}.")
    if not samples >= LEAST:
        raise InputError(f"samples must be at least {LEAST}, got {samples!r}.")
    check_loads(measurement)
    found: list[MotionSegment] = []
    for index, record in enumerate(measurement.records()):
        _check(record)
        set_up = vary(mechanism, "mechanism", record.overrides)
        load = load_along(set_up, record, np.asarray(record.values("friction")).size)
        count = max((int(one.segment.max()) + 1 for one in found), default=0)
        if record.time is None:
            found.append(_table(index, set_up, record, load, count))
        else:
            own = _series(index, record, load, count, segment, samples)
            found.extend(_informed(one, set_up, record) for one in own)
    return tuple(found)


def _check(record: Measurement) -> None:
    """Refuse a record that is not one of friction."""
    label = f"record {record.name!r}" if record.name else "the record"
    known = record.quantities()
    had = f"{label} has only {joined(known)}"
    if "friction" not in known:
        raise InputError(f"a force map needs friction (F) [N], and {had}.")
    if record.time is None and record.kind != "friction-map":
        raise InputError(
            f"a force map needs arrays, and {had} as single numbers: give friction and velocity"
            " as arrays, with time [s] if the law has a memory."
        )
    if not {"velocity", "position"} & set(known):
        raise InputError(
            f"a force map needs velocity (v) [m/s] or position (x) [m] beside friction, and {had}."
            f"{_other_way(record)}"
        )
    size = len(np.atleast_1d(record.values("friction")))
    if record.time is None and size < FEWEST:
        raise InputError(
            f"a table of friction needs at least {FEWEST} rows, and {label} has {size}: measure"
            " friction at more speeds."
        )
    if record.time is not None and size < LEAST:
        raise InputError(f"a force map needs at least {LEAST} samples, and {label} has {size}.")


def _other_way(record: Measurement) -> str:
    """Return what fits friction under a load point, if there is one."""
    if "pull" not in record.quantities():
        return ""
    return (
        " Friction under a load point is fitted by rate-and-state laws: leave out the route, or"
        " give route='rate-state'."
    )


def check_loads(measurement: Measurement) -> None:
    """Refuse trials of which some only have a measured load."""
    loads = {"load" in record.quantities() for record in measurement.records()}
    if len(loads) > 1:
        raise InputError(
            "load (N) was measured in only some of the trials: give Measurement.load [N] for each"
            " trial, or for none to use that of the mechanism."
        )


def weighs(mechanism: Mechanism, record: Measurement) -> bool:
    """Whether the load of a record is the weight of a mechanism, and not measured or prescribed."""
    return "load" not in record.quantities() and any(
        contact.normal is not None for contact in mechanism.contacts()
    )


def load_along(mechanism: Mechanism, record: Measurement, count: int) -> Array:
    """Return the normal force at each sample (n,) [N]: measured, else the mechanism's."""
    label = f"record {record.name!r}" if record.name else "the record"
    if "load" in record.quantities():
        load = np.broadcast_to(np.asarray(record.values("load"), dtype=float), count)
        where = "Measurement.load (N)"
    else:
        load = np.full(count, _own_load(mechanism))
        where = f"the load of {type(mechanism).__name__} (N)"
    if not np.all(load > 0.0):
        raise InputError(
            f"{where} of {label} must be above 0 N, got {number(float(np.min(load)))}: give the"
            " normal force in Measurement.load, one number or one for each sample."
        )
    return load


def _own_load(mechanism: Mechanism) -> float:
    """Return the normal force of a mechanism: prescribed, or the weight on a held coordinate."""
    contact, normal = only_contact(mechanism), normal_of(mechanism)
    if normal is None:
        return float(cast("float", contact.load)) if contact.load is not None else 0.0
    at = dict.fromkeys((*mechanism.coordinates, normal), 0.0)
    # weight is linear in the height, so that the difference over 1 m is exact
    above = mechanism.potential_energy(0.0, {**at, normal: 0.5})
    below = mechanism.potential_energy(0.0, {**at, normal: -0.5})
    return float(above - below)


def _informed(one: MotionSegment, mechanism: Mechanism, record: Measurement) -> MotionSegment:
    """Return a stretch with its contact inputs."""
    time, times = one.path.time, np.asarray(record.time, dtype=float)
    signals: dict[str, Any] = {
        name: np.interp(time, times, np.asarray(record.values(name)))
        for name in ("position", "force")
        if name in record.quantities()
    }
    known = inputs_along(mechanism, record, time, velocity=one.path.velocity, **signals)
    return replace(one, path=replace(one.path, inputs=known))


def _table(
    number: int, mechanism: Mechanism, record: Measurement, load: Array, first: int
) -> MotionSegment:
    friction = np.asarray(record.values("friction"), dtype=float)
    velocity = np.asarray(record.values("velocity"), dtype=float)
    resting = resting_readings(velocity, friction / load)
    velocity = np.where(resting, 0.0, velocity)
    rows = np.arange(len(velocity))
    time, held = rows.astype(float), record.force
    force = np.asarray(record.values("force")) if isinstance(held, np.ndarray) else math.nan
    known = inputs_along(mechanism, record, time, velocity=velocity, force=force)
    path = Path(
        time=time, velocity=velocity, load=load, travel=np.zeros(len(rows) - 1), inputs=known
    )
    return MotionSegment(
        record=number,
        path=path,
        friction=friction,
        segment=first + _dealt(len(velocity)),
        timed=False,
        resting=resting,
        held=friction,
    )


def _dealt(count: int) -> NDArray[np.intp]:
    """Return the segment of each row of a table (n,): rows are dealt out in turn."""
    segments = min(SEGMENTS, count)
    share = np.arange(count) % segments
    return np.asarray((share % 2) * ((segments + 1) // 2) + share // 2)


def _series(
    number: int,
    record: Measurement,
    load: Array,
    first: int,
    segment: float | None,
    samples: float,
) -> Iterator[MotionSegment]:
    """Yield the stretches of a record in time, leaving out those too short to use."""
    time = np.asarray(record.time, dtype=float)
    friction = np.asarray(record.values("friction"), dtype=float)
    length = segment if segment is not None else float(np.ptp(time)) / SEGMENTS
    every = max(1, int(np.ceil(len(time) / samples)))
    steps = np.diff(time)
    cuts = np.flatnonzero(steps > GAP * np.median(steps)) + 1
    for rows in np.split(np.arange(len(time)), cuts):
        if len(rows) < LEAST:
            continue
        position, velocity, slowness = _motion(record, time, rows)
        picked = slice(None, None, every)
        t = time[rows][picked]
        span = float(t[-1] - t[0])
        count = max(1, round(span / length))
        share = np.minimum((t - t[0]) / span * count, count - 1).astype(np.intp)
        yield MotionSegment(
            record=number,
            path=Path(
                time=t,
                velocity=velocity[picked],
                load=load[rows][picked],
                travel=np.diff(position[picked]),
            ),
            friction=friction[rows][picked],
            segment=first + share,
            resting=velocity[picked] == 0.0,
            held=friction[rows][picked],
            slack=BEYOND * noise_of(friction[rows]),
            slowness=slowness,
        )
        first += count


def _motion(record: Measurement, time: Array, rows: NDArray[np.intp]) -> tuple[Array, Array, float]:
    """Return position and velocity of a stretch, each measured or from the other one.

    Velocities are 0 where none is resolved (`_resolved`). The third value is the speed [m/s] that
    they may have there.

    Positions are not filtered, but held while nothing moves: bristles see displacement, which noise
    changes least, and on measured loops every filter that was tried made the prediction worse.
    """
    known, t = record.quantities(), time[rows]
    if "velocity" in known:
        recorded = np.asarray(record.values("velocity"), dtype=float)[rows]
        doubt = _noise_beside_motion(recorded)
        velocity = recorded
        fast = usual_top_speed(velocity)
    if "position" not in known:
        steps = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(t)
        position = np.concatenate([[0.0], np.cumsum(steps)])
        unsure = min(BEYOND * doubt, SLOWEST * fast)
        return position, np.where(np.abs(velocity) <= unsure, 0.0, velocity), unsure
    recorded = np.asarray(record.values("position"), dtype=float)[rows]
    step = step_of(recorded)
    reach = reach_of(recorded, _noise_beside_motion(recorded, step))
    position = recorded
    derived = "velocity" not in known
    if derived:
        velocity, doubt = _velocity(t, position, step)
        fast = usual_top_speed(velocity)
    slowness = min(max(SLOW * fast, BEYOND * doubt), SLOWEST * fast)
    unsure = slowness if derived else min(BEYOND * doubt, slowness)
    velocity = _resolved(t, position, velocity, reach, slowness, unsure)
    # where nothing moves, the noise of positions would let bristles relax
    moving = np.append(True, (velocity[1:] != 0.0) | (velocity[:-1] != 0.0))
    last = np.maximum.accumulate(np.where(moving, np.arange(len(t)), 0))
    return position[last], velocity, slowness


def _resolved(
    time: Array, position: Array, velocity: Array, reach: float, slowness: float, unsure: float
) -> Array:
    """Return velocities (n,) [m/s] that are 0 where the sensor does not resolve any.

    At rest positions stay within their reach [m], for so long that what they may have gone
    meanwhile is slow beside the largest speed, and velocities are below `slowness` [m/s].
    Velocities whose direction is not sure, below `unsure` [m/s], have that of the displacements
    before and after them; at reversals, where these differ, it is not known.

    Inverse dynamics has a rule of its own (`filtered_motion`): its velocities are filtered, and its
    rows see rests through a filter, whose memory decides which are too short to count.
    """
    moved, ways = _displacements(position, 2.0 * reach)
    number = np.searchsorted(moved, np.arange(len(time)), side="right")
    first, last = np.append(0, moved), np.append(moved, len(time)) - 1
    fast = usual_top_speed(velocity)
    span = np.where(last - first >= LEAST, time[last] - time[first], 0.0)
    resting = (CREEPING * fast * span > 2.0 * reach)[number] & (np.abs(velocity) <= slowness)
    if len(moved):
        slow = np.abs(velocity) <= unsure
        before, after = np.append(ways[0], ways)[number], np.append(ways, ways[-1])[number]
        velocity = np.where(slow, before * np.abs(velocity), velocity)
        resting |= slow & (before != after)
    return np.where(resting, 0.0, velocity)


def reach_of(position: Array, noise: float) -> float:
    """Return the displacement to either side that positions with noise do not resolve."""
    return max(BEYOND * noise, FINEST * float(np.ptp(position)))


def _noise_beside_motion(values: Array, step: float = 0.0) -> float:
    """Return the standard deviation of noise, which few samples in a period do not raise."""
    return min(noise_of(values, step), noise_of(values, step, order=6))


def _displacements(position: Array, least: float) -> tuple[NDArray[np.intp], Array]:
    """Return at which samples positions have gone farther than a distance, and which ways (k,)."""
    found, ways, at = [], [], float(position[0])
    for i, x in enumerate(position.tolist()):
        if abs(x - at) > least:
            found.append(i)
            ways.append(math.copysign(1.0, x - at))
            at = x
    return np.array(found, dtype=np.intp), np.array(ways)


def smoothed(columns: Array, passed: float) -> Array:
    """Return columns (n,) or (n, m) filtered forward and backward, so that nothing is delayed."""
    return _low_pass(passed).passed(columns)


@functools.lru_cache(maxsize=64)
def _low_pass(passed: float) -> LowPass:
    """Return the filter, whose design takes as long as its use on a few seconds of a record."""
    return low_pass(0.5, passed, most=1.0)


def _velocity(time: Array, position: Array, step: float) -> tuple[Array, float]:
    """Return the velocity (n,) [m/s] by parabolas, which shift no phase, and its deviation.

    Positions were recorded in steps [m], or 0. The parabolas are as short as the noise of positions
    allows. White noise s leaves a standard deviation of s sqrt(3 / (k (k + 1) (2 k + 1))) where k
    neighbours to either side count.
    """
    from scipy.signal import savgol_filter

    steps = round((time[-1] - time[0]) / float(np.median(np.diff(time))))
    check_even_times(steps)
    even = np.linspace(time[0], time[-1], steps + 1)
    x, dt = np.interp(even, time, position), float(even[1] - even[0])
    noise, half, most = _noise_beside_motion(x, step), 0, max(steps // 2, 1)
    while half < most:
        half = min(max(half + 1, int(GROWTH * half)), most)
        v = (x[2 * half :] - x[: -2 * half]) / (2 * half * dt)  # in which noise shows least
        doubt = noise * math.sqrt(3.0 / (half * (half + 1) * (2 * half + 1))) / dt
        frequency = float(np.std(v)) / max(float(np.std(x)), 1e-300)
        fast = usual_top_speed(v)
        if doubt <= QUIET * fast or (half + 1) * dt * frequency > BENDING:
            break
    slope = savgol_filter(x, 2 * half + 1, 2, deriv=1, delta=dt)
    return np.asarray(np.interp(time, even, slope), dtype=float), doubt
