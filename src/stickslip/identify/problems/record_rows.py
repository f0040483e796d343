r"""Rows of the force balance of one coordinate, at several cutoffs.

1. A record goes on an even grid. Counters that were reset go on where they were.
2. Of samples that are much finer than the cutoff, means of several are taken.
3. The cutoff is where the noise of positions costs `COST` of the force through the acceleration:
   more of it goes into the force through feedback, and biases what grows with the speed. White
   noise of deviation :math:`\sigma` in samples of :math:`h` gives an acceleration below :math:`f_c`

   .. math:: \sigma_a^2 = 2 h \sigma^2 (2 \pi)^4 f_c^5 / 5 .

   How far curves depend on it is in the posterior: rows are made at each of `CUTOFFS` times it.
4. Velocity, way and direction have the middle cutoff, and are those of all rows.
5. Rows are taken `PER` times for each 1/cutoff, without rests, ends, and the start of the way, on
   which it is not known how far bristles are stretched.
6. Where a record begins as the body leaves rest, at :math:`t_0`, and only then has its slow speeds,
   the balance times a step at :math:`t_0` is filtered. As velocity and acceleration are 0 before,

   .. math:: H[\theta(t - t_0) (F - f(v))] = J\, H[\ddot x] ,

   whatever holds the body until then, and rows go on to that start.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

from stickslip.errors import InputError
from stickslip.identify.fits import SURE, play
from stickslip.identify.problems.record_signals import Filter, Record, noise_of, step_of

Array: TypeAlias = NDArray[np.float64]
Places: TypeAlias = NDArray[np.intp]
Mask: TypeAlias = NDArray[np.bool_]

RESTS = (
    "the body rests throughout the record, or moves by no more than the noise of its position:"
    " friction cannot be determined. Move it farther."
)
COST = 0.0015
"""Noise of the inertial force over the standard deviation of the force, or over its root mean
square where the motion goes one way: at 1 % of it, viscous friction of axes in a loop is wrong by
.3 to 1.9 %."""
CUTOFFS = (0.7, 1.0, 1.4)
"""Cutoffs over that of `COST`: noise costs .4 to 2.3 times as much."""
LOW, MIDDLE = 0, 1
SEEN, RAISED, COSTLY = 0.5, 1.3, 0.012
"""Part of the motion that rows must have, and factor by which the cutoff is raised else, up to
another cost: of slips between rests, under a force that was recorded, little is away from rests at
a low cutoff."""
PERIODS = 8.0
"""Least cutoff over the frequency of the motion: else no speed is resolved between turns."""
ON, BACK = 5.0, 0.1
"""The same beside a way that goes on, where this share of the record at least goes back: at 3 the
band of a cart whose friction noise hides does not hold the truth."""
SLOW, PARTS = 0.05, 20
"""Steps over the largest that are motion, and parts in which their noise is looked at."""
HIGHEST, LOWEST, MEASURED = 150.0, 4.0, 60.0
"""Limits of the cutoff [Hz], and that of friction that was measured, which nothing accelerates."""
SAMPLES = 0.15
"""Largest cutoff times the step."""
SAMPLED = 36.0
"""Samples for each 1/cutoff, beyond which means of several are taken."""
PER, FINER = 2.2, 3
"""Rows for each 1/cutoff, and how many times as many the filter gives, so that nothing aliases."""
MOST_ROWS = 6000
"""Rows at most; of longer records, fewer for each 1/cutoff."""
STILL, TRAVEL = 8.0, 80.0
"""Range of positions within 1/cutoff that is rest, over their noise; and in all the record that is
motion, however short its slips and rests are."""
WIDER, LITTLE = 2.0, 0.1
"""Least band of the velocity over that of the rows, and its noise over its change in a sample up to
which it is wider."""
AWAY = 2.5
"""Distance from rests, over 1/cutoff."""
LEAST, FEWEST = 0.05, 25
"""Part of the samples, or rows, that must be away from rests; else those not at rest are rows, or
all. More samples than these stand beside their like where a sensor clips."""
ENDS, ENDS_MEASURED = 2.0, 0.5
"""Distance from the ends, over 1/cutoff: of a balance, and of friction that was measured."""
WAY, WAY_MEASURED = 0.1, 0.8
"""Way over the range of positions from which on bristles are stretched as the motion says."""
UNUSED = 0.5
"""Speeds of a start over the slowest of the rows below which that start is worth rows."""
AFTER = 0.5
"""Time from a start to the first row, over 1/cutoff."""
RESTED = 3.0
"""Rest that is laid before a start, over 1/cutoff: filters reach as far."""
SHORTEST = 10
"""Part of a record that both are at most, for the start of a motion tells its inertia."""
THIRD = 20.0
"""Variance of third differences over that of white noise."""
SIGMA = 1.4826
"""Standard deviation over the median size, of normal noise."""
TURNS = 0.6
"""Distance of turns that count as two, over 1/cutoff."""
RESET = 20.0
"""Jump of a counter that is no motion, over the largest steps around it."""
ALONG = 3.0
"""Band of the way over that of the rows: at a turn a filter rounds more than short bristles are
long."""
SHORT = 10.0
"""Length over the noise of positions from which on a bristle is seen."""
COARSE = 2.0
"""Step of an encoder over the noise of its values, from which nothing but the step is their noise:
it is the root of 12 where there is no other."""
MOMENT = 2
"""Samples about a turn that do not tell when it was."""
OTHER_UNIT = 0.3
"""Inertia that the motion shows, over that given, below which that is in another unit."""
ROUNDED = 1e-12
"""Range of positions over their size up to which nothing moves, and of forces that are equal."""


def checked(records: Sequence[Record]) -> None:
    """Refuse records of which no balance can be made, with the channel that is at fault."""
    for item in records:
        channels = {
            "time": item.time, "position (x)": item.position, "force (F)": item.force,
            "velocity (v)": item.velocity, "load": item.load, "known force": item.mechanism,
            "transmitted force": item.transmitted, **item.inputs,
        }  # fmt: skip
        for name, x in channels.items():
            if x is not None and not np.all(np.isfinite(x)):
                at = int(np.argmax(~np.isfinite(x)))
                raise InputError(
                    f"the {name} of a record must be finite, got {x[at]} at sample {at}: leave out"
                    " the samples that were not recorded."
                )
        still = item.velocity is not None and not np.any(item.velocity)
        if still and np.ptp(item.position) > 0.0:
            raise InputError(
                "the velocity (v) of a record is 0 throughout although its position changes: give"
                " the column of the velocity, or leave it out."
            )
    if not any(moves(record) for record in records):
        raise InputError(
            "a force balance needs motion, and the position (x) does not change: give the column"
            " of the position of this coordinate, or a record in which it moves."
        )
    if all(_is_silent(record) for record in records):
        raise InputError(
            "a force balance needs a force, and the force (F) is 0 throughout: give the column of"
            " the force or of friction, or the inertia of what moves freely."
        )


def moves(record: Record) -> bool:
    """Return whether the position of a record changes by more than its numbers are rounded.

    Examples
    --------
    >>> t = np.arange(4.0)
    >>> moves(Record(time=t, position=t, force=t)), moves(Record(time=t, position=0 * t, force=t))
    (True, False)
    """
    x = record.position
    return bool(np.ptp(x) > ROUNDED * np.max(np.abs(x), initial=0.0))


def _is_silent(record: Record) -> bool:
    """Return whether nothing says how large forces are."""
    known = record.mechanism is not None and np.any(record.mechanism)
    gives = record.inertia is not None and record.inertia > 0.0
    return not (np.any(record.force) or (not record.friction and (known or gives)))


def even(record: Record) -> Record:
    """Return a record on an even grid, whose position goes on where a counter was reset."""
    step = float(np.median(np.diff(record.time)))
    count = int((record.time[-1] - record.time[0]) / step + 1e-6) + 1
    counted = replace(record, position=continued(record.position))
    return counted.on(record.time[0] + step * np.arange(count))


def continued(position: Array) -> Array:
    """Return positions (n,) without the jumps of a counter that is reset.

    Examples
    --------
    >>> continued(np.array([0.0, 1.0, 2.0, 3.0, -497.0, -496.0, -495.0])).tolist()
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    """
    steps = np.diff(position)
    size = np.abs(steps)
    if len(size) < 5:
        return position
    around = np.zeros_like(size)
    for by in (-2, -1, 1, 2):
        around = np.maximum(around, np.roll(size, by))
    jumps = np.flatnonzero(
        (size > RESET * around) & (size > RESET * np.median(size)) & (around > 0.0)
    )
    steps[jumps] = 0.5 * (np.roll(steps, 1)[jumps] + np.roll(steps, -1)[jumps])
    if not len(jumps):
        return position
    return np.asarray(position[0] + np.concatenate([[0.0], np.cumsum(steps)]))


def means(x: Array, count: int) -> Array:
    """Return means of so many samples each (n // count,)."""
    kept = len(x) // count * count
    return np.asarray(x[:kept].reshape(-1, count).mean(axis=1))


def averaged(record: Record, count: int) -> Record:
    """Return means of so many samples each."""
    return record.each(lambda x: means(x, count))


def noise_in_motion(record: Record) -> float:
    """Return the standard deviation of the noise of positions, at least that while it moves.

    At rest a coarse encoder has none, and in motion that of its steps.
    """
    v = np.abs(np.gradient(record.position))
    moving = np.convolve(v, np.full(9, 1.0 / 9.0), mode="same") > SLOW * np.quantile(v, 0.999)
    third = np.diff(record.position, 3)[moving[3:]]
    size = len(third) // PARTS
    if size < PARTS or np.mean(moving) > 0.7:
        return record.position_noise
    parts = [float(np.std(third[k * size : (k + 1) * size])) for k in range(PARTS)]
    return max(record.position_noise, float(np.quantile(parts, 0.2)) / math.sqrt(THIRD))


def cutoff_of(record: Record, cost: float = COST) -> float:
    """Return the cutoff of a record on an even grid [Hz], at which noise has a cost."""
    step = float(record.time[1] - record.time[0])
    widest = Filter(count=len(record.time), step=step, band=0.2 / step, every=1)
    v, _ = motion(record, widest)
    size = max(float(np.std(record.position)), ROUNDED * float(np.max(np.abs(record.position))))
    frequency = float(np.std(v)) / (size + 1e-300) / (2.0 * math.pi)
    if min(np.mean(v > 0.0), np.mean(v < 0.0)) > BACK:  # a way that goes on hides the turns
        apart = record.position - np.mean(v) * (record.time - record.time[0])
        between = 2.0 * math.pi * (float(np.std(apart)) + ROUNDED * size)
        frequency = max(frequency, ON / PERIODS * float(np.std(v)) / between)
    least = min(PERIODS * frequency, 0.2 / step)
    if record.friction:
        return min(max(0.1 / step, least), 0.2 / step, MEASURED)
    band = min(max(10.0, least), 0.2 / step)
    first = Filter(count=len(record.time), step=step, band=band, every=1)
    v, a = motion(record, first)
    side = v / (np.abs(v) + 0.02 * float(np.abs(v).max()) + 1e-300)
    columns = [a, side, v, np.ones_like(v)]
    columns += [first(item.force, full=True) for item in record.unknown.values()]
    force = first(record.force, full=True)
    if record.mechanism is not None:
        force = force + first(record.mechanism, full=True)
    x = np.column_stack(columns)
    size = np.sqrt(np.mean(x * x, axis=0)) + 1e-300
    inertia = abs(float(np.linalg.lstsq(x / size, force, rcond=1e-9)[0][0])) / float(size[0])
    if record.inertia and inertia > OTHER_UNIT * record.inertia:
        inertia = record.inertia
    most = min(SAMPLES / step, HIGHEST)
    # noise that costs no more at the largest cutoff decides nothing, nor has to be above 0
    costs = record.gain * inertia * _noise_of_acceleration(record, most)
    # one way the force may hardly change, and noise matters beside its size
    both_ways = min(np.mean(v > 0.0), np.mean(v < 0.0)) > BACK
    whole = float(np.std(force) if both_ways else np.sqrt(np.mean(force**2)))
    share = cost * whole / costs if costs > 0.0 else 1.0
    band = most * min(share, 1.0) ** (2.0 / (5.0 if record.velocity is None else 3.0))
    return float(np.clip(max(band, least), min(LOWEST, most), most))


def _noise_of_acceleration(record: Record, band: float) -> float:
    """Return the deviation that white noise of the sensor gives accelerations below a band."""
    by_place, step = record.velocity is None, float(record.time[1] - record.time[0])
    noise = noise_in_motion(record) if by_place else record.velocity_noise
    return noise * _derived(step, band, 2 if by_place else 1)


def _derived(step: float, band: float, times: int) -> float:
    """Return the deviation of white noise derived so many times below a band, over its own."""
    return math.sqrt(2.0 * step * band / (2.0 * times + 1.0)) * (2.0 * math.pi * band) ** times


def mean_frequency(records: Sequence[Record]) -> float:
    """Return the mean frequency of the motion [Hz]: of positions, or of velocities if higher."""
    result = []
    for record in records:
        h = float(np.median(np.diff(record.time)))
        width = max(len(record.time) // 400, 1)
        kernel = np.ones(width) / width
        q = np.convolve(record.position, kernel, mode="valid")
        v = np.gradient(q, h)[2:-2]
        if record.velocity is not None:
            v = np.convolve(record.velocity, kernel, mode="valid")[2:-2]
        v = np.convolve(v, kernel, mode="valid")
        a = np.gradient(v, h)
        of_position = float(np.std(v)) / max(float(np.std(q)), 1e-300)
        of_velocity = float(np.std(a)) / max(float(np.sqrt(np.mean(v * v))), 1e-300)
        result.append(max(of_position, of_velocity) / (2.0 * math.pi))
    return float(np.median(result))


def motion(record: Record, filt: Filter) -> tuple[Array, Array]:
    """Return velocities, in twice the band, and accelerations (n,)."""
    return velocity_of(record, filt, WIDER), acceleration_of(record, filt, full=True)


def acceleration_of(record: Record, filt: Filter, *, full: bool = False) -> Array:
    """Return accelerations (n,) [m/s^2], or at the rows."""
    if record.velocity is not None:
        return filt(record.velocity, slope=1, full=full)
    return filt(record.position, bent=True, slope=2, full=full)


def velocity_of(record: Record, filt: Filter, wider: float) -> Array:
    """Return velocities (n,) in so many times the band."""
    if record.velocity is not None:
        return filt(record.velocity, wider=wider, full=True)
    return filt(record.position, bent=True, slope=1, wider=wider, full=True)


@dataclass(frozen=True, kw_only=True)
class Acting:
    """How recorded forces act."""

    delay: float = 0.0
    """How much later than recorded [s]."""
    order: int = 0
    """Order of the low pass that makes it late: what was recorded has passed it if the delay is
    below 0, what acts else. 0 if all frequencies are as late."""
    clipped: bool = False
    """Whether more acts than recorded where the sensor shows as much as it can."""

    def passes(self, frequency: Array) -> Array:
        """Return the share of frequencies (n,) [Hz] that acts, of what was recorded.

        Examples
        --------
        >>> frequency = np.array([0.5 / np.pi])
        >>> Acting(delay=-1.0, order=1).passes(frequency).tolist()
        [(1+1j)]
        >>> Acting(delay=1.0, order=2).passes(frequency).round(1).tolist()
        [(0.4-0.8j)]
        """
        phase = 2j * np.pi * frequency * abs(self.delay)
        if not self.order:
            return np.asarray(np.exp(-math.copysign(1.0, self.delay) * phase))
        low = 1.0 + phase + 0.5 * (self.order - 1) * phase**2
        return np.asarray(low if self.delay < 0.0 else 1.0 / low)


AS_RECORDED = Acting()


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """A record on an even grid, and its motion."""

    record: Record
    given: Record
    """The same before means were taken."""
    cutoff: float
    """Middle cutoff [Hz]."""
    every: int
    """Samples from one of the finer rows to the next."""
    hidden: Array | float = 0.0
    """Force above what its sensor shows, about, if that clips (n,) [N]."""
    wider: float = WIDER
    """Band of the velocity over that of the rows. At a turn the acceleration jumps with the
    friction: a narrow band turns it at another time, and a wide one has noise."""
    start_time: float = -math.inf
    """Time at which the body leaves rest, if rows go on to it [s]."""

    @cached_property
    def step(self) -> float:
        """Time from sample to sample [s]."""
        return float(self.record.time[1] - self.record.time[0])

    @cached_property
    def sample(self) -> float:
        """Time from sample to sample before means were taken [s]."""
        return float(self.given.time[1] - self.given.time[0])

    @property
    def held(self) -> float:
        """How much later a force acts than recorded as it may hold until the next sample [s]."""
        return 0.5 * self.sample * self.given.held

    def acted(self, acting: Acting) -> Array:
        """Return the forces that act, but for their delay (n,) [N]."""
        return self.record.force + acting.clipped * self.hidden

    @cached_property
    def clipped(self) -> Array:
        """Share of the samples at an end of the range of forces, with its sign (n,).

        Of single samples and their like at either end none are: peaks are no limits of a sensor.
        Nor is that to which a force jumps by half of it or more, as a command does.
        """
        force, result = self.given.force, np.zeros(len(self.given.force))
        beside = np.pad(force, 1, constant_values=np.nan)
        for side, end in ((-1.0, np.min(force)), (1.0, np.max(force))):
            # a jump that is put on an even grid is off by the rounding of times in its slope
            equal = side * force >= side * end - 1e3 * ROUNDED * abs(end)
            first, last = np.flatnonzero(np.diff(np.pad(equal, 1).astype(int))).reshape(-1, 2).T
            near = 2.0 * np.fmax(side * beside[first], side * beside[last + 1]) > side * end
            equal[equal] = np.repeat(near, last - first)
            if np.sum(equal[1:] & equal[:-1]) > FEWEST and side * end > 0.0:
                result[equal] = side
        return means(result, round(self.step / self.sample))

    @property
    def _fewer(self) -> float:
        """What noise falls by where means are taken."""
        return math.sqrt(self.sample / self.step)

    @cached_property
    def filters(self) -> tuple[Filter, ...]:
        """The filters of all cutoffs."""
        count = len(self.record.time)
        return tuple(
            Filter(count=count, step=self.step, band=k * self.cutoff, every=self.every)
            for k in CUTOFFS
        )

    @cached_property
    def noise(self) -> float:
        """Standard deviation of the noise of positions [m]."""
        if self.given.located:
            return noise_in_motion(self.given) * self._fewer
        share = math.sqrt(min(2.0 * self.step * self.cutoff, 1.0))
        return self.velocity_noise * share / (2.0 * math.pi * self.cutoff)

    @property
    def velocity_noise(self) -> float:
        """Standard deviation of the noise of velocities, where they were measured [m/s]."""
        return self.given.velocity_noise * self._fewer

    @property
    def resolution(self) -> float:
        """Speed below which an encoder steps too seldom for the filter to show it [m/s]; or 0."""
        by_place = self.record.velocity is None
        x = self.given.position if by_place else np.asarray(self.given.velocity)
        step, noise = (of(x, speed=not by_place) for of in (step_of, noise_of))
        if step < COARSE * noise:  # noise beside the steps makes them finer
            return 0.0
        seen = min(SURE * self.wider * self.cutoff * self.sample, 1.0)
        return seen * step / (self.sample if by_place else 1.0)

    @cached_property
    def widest(self) -> float:
        """Band of the velocity over that of the rows, up to which noise moves turns by little."""
        usual = velocity_of(self.record, self.filters[MIDDLE], WIDER)
        changes = LITTLE * float(np.sqrt(np.mean(np.diff(usual) ** 2)))
        share = changes / (self._speed_noise(WIDER) + 1e-300)
        more = share ** (2.0 / 3.0 if self.record.velocity is None else 2.0)
        return WIDER * float(np.clip(more, 1.0, max(0.2 / self.step / self.cutoff / WIDER, 1.0)))

    def _speed_noise(self, wider: float) -> float:
        """Return the noise of velocities in so many times the band [m/s]."""
        band = wider / WIDER * self.cutoff
        if self.record.velocity is None:
            return self.noise * math.sqrt(2.0 * self.step * (2.0 * math.pi) ** 2 * band**3 / 3.0)
        return self.velocity_noise * math.sqrt(min(4.0 * self.step * band, 1.0))

    @cached_property
    def velocity(self) -> Array:
        """Velocities (n,) [m/s]."""
        return velocity_of(self.record, self.filters[MIDDLE], self.wider)

    @cached_property
    def acceleration(self) -> Array:
        """Accelerations in the middle band (n,) [m/s^2]."""
        return acceleration_of(self.record, self.filters[MIDDLE], full=True)

    @cached_property
    def way(self) -> Array:
        """Positions along which bristles move (n,) [m], freed of the chatter of noise."""
        return self._followed(1.0)

    @cached_property
    def _finer_way(self) -> Array:
        return self._followed(max(min(ALONG, 0.2 / self.step / self.cutoff), 1.0))

    def _followed(self, wider: float) -> Array:
        """Return positions that a band over the cutoff lets pass, without chatter (n,)."""
        chatter = 0.5 * self.noise * math.sqrt(min(2.0 * self.step * wider * self.cutoff, 1.0))
        smooth = self.filters[MIDDLE](self.record.position, bent=True, wider=wider, full=True)
        return play(smooth, chatter)

    def along(self, length: float) -> Array:
        """Return the way of a bristle (n,): with less of the filter where noise is short of it."""
        return self._finer_way if length > SHORT * self.noise else self.way

    @cached_property
    def direction(self) -> Array:
        """Direction (n,): the last that stands above the noise, until the velocity changes sign."""
        noise = self._speed_noise(self.wider)
        v = self.velocity
        side = np.where(np.abs(v) > SURE * noise, np.sign(v), 0.0)
        sure = np.flatnonzero(side)
        if not len(sure):
            return side
        last = np.maximum.accumulate(np.where(side != 0.0, np.arange(len(side)), sure[0]))
        result = side[last]
        turned = side[sure[1:]] != side[sure[:-1]]
        for i, j in zip(sure[:-1][turned], sure[1:][turned], strict=True):
            # between sure directions it turns where that agrees most with the velocity
            k = int(np.argmax(np.cumsum(v[i:j]) * side[i]))
            result[i + k + 1 : j] = side[j]
        return np.asarray(result)

    @cached_property
    def still(self) -> Mask:
        """Whether a sample is at rest (n,)."""
        half = max(int(0.5 / self.cutoff / self.step), 2)
        if self.record.located:
            q = self.record.position
            within = maximum_filter1d(q, 2 * half + 1) - minimum_filter1d(q, 2 * half + 1)
            still = within < STILL * self.given.position_noise
        else:
            limit = SURE * self.noise * 2.0 * math.pi * self.cutoff
            still = maximum_filter1d(np.abs(self.velocity), 2 * half + 1) < limit
        wide = np.asarray(maximum_filter1d(still.astype(np.uint8), 4 * half + 1) > 0)
        return still if np.all(wide) and self.travels else wide

    @property
    def travels(self) -> bool:
        """Whether it goes much farther than noise, and so does not rest throughout."""
        noise = max(self.noise, self.given.position_noise)
        return self.given.located and bool(np.ptp(self.record.position) > TRAVEL * noise)

    @property
    def start(self) -> float:
        """State of bristles at the first sample: stretched in motion, whatever was before."""
        return 0.0 if self.still[0] else float(self.direction[0])

    @cached_property
    def turns(self) -> Places:
        """Samples at which the motion turns."""
        at = np.flatnonzero((np.diff(self.direction) != 0.0) & ~self.still[1:]) + 1
        apart = TURNS / self.cutoff / self.step
        return at[np.diff(at, prepend=-math.inf) > apart]

    @cached_property
    def turned_in(self) -> float:
        """Way from a turn within `MOMENT` samples, in the median [m]; 0 without turns."""
        at = self.turns[(self.turns >= MOMENT) & (self.turns < len(self.way) - MOMENT)]
        if not len(at):
            return 0.0
        q = self.record.position
        return float(np.median(np.maximum(*(np.abs(q[at + k] - q[at]) for k in (-MOMENT, MOMENT)))))

    @cached_property
    def beside(self) -> float:
        """Standard deviation of a sample of the force about what the filter shows of it [N]."""
        apart = self.record.force - self.filters[MIDDLE](self.record.force, full=True)
        return SIGMA * float(np.median(np.abs(apart[~self.still]))) if np.any(~self.still) else 0.0

    @cached_property
    def passed(self) -> float:
        """Speed that is passed within `MOMENT` samples of a turn, in the median [m/s]."""
        at = self.turns[(self.turns >= MOMENT) & (self.turns < len(self.velocity) - MOMENT)]
        speed = np.abs(self.velocity)
        passed = np.maximum(speed[at - MOMENT], speed[at + MOMENT])
        return float(np.median(passed)) if len(at) else 0.0

    def usable(self, cutoff: float) -> Mask:
        """Return which samples can be rows at a cutoff (n,)."""
        measured, q, time = self.record.friction, self.way, self.record.time
        count = len(q)
        rest = 2 * int(AWAY / cutoff / self.step) + 1
        away = maximum_filter1d(self.still.astype(np.uint8), rest) == 0
        tries = (away, ~self.still, np.ones(count, dtype=bool))
        many = min(LEAST * count, FEWEST / (PER * cutoff * self.step))  # samples of so many rows
        result = next(item for item in tries if np.sum(item) > many or item is tries[-1]).copy()
        ends = int((ENDS_MEASURED if measured else ENDS) / cutoff / self.step) + 1
        most = count // SHORTEST
        ends = min(ends, most)
        result[:ends] = result[count - ends :] = False
        least = WAY_MEASURED if measured else WAY
        moved = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(q)))])
        if moved[-1] > (1.0 + least) * np.ptp(q):  # else it never comes back
            result[:most] &= moved[:most] > least * np.ptp(q)
        if math.isfinite(self.start_time):  # each row up to the first that is used without it
            after = (time > self.start_time + AFTER / cutoff) & (
                time < time[int(np.argmax(result))]
            )
            result = (result & (time > self.start_time)) | after
        return result

    def rests(self, cutoff: float) -> Mask:
        """Return which samples are at rest, whatever the filter shows of the motion (n,)."""
        away = 2 * int(AWAY / cutoff / self.step) + 1
        result = np.asarray(minimum_filter1d(self.still.astype(np.uint8), away) > 0)
        ends = min(int(ENDS / cutoff / self.step) + 1, len(result) // 10)
        result[:ends] = result[len(result) - ends :] = False
        return result & (self.record.time > self.start_time)

    def with_start(self, slowest: float) -> "Piece":
        """Return the piece with rows from the start on, if slower than the `slowest` row [m/s]."""
        v, noise = np.abs(self.velocity), SURE * self._speed_noise(self.wider)
        first = int(np.argmax(v > noise))
        last = first + max(int(1.0 / self.wider / self.cutoff / self.step), 2)
        time, ramp = self.record.time[first:last], v[first:last]
        if math.isfinite(self.start_time) or len(ramp) < 2 or ramp[0] > UNUSED * slowest:
            return self
        rate, at = np.polyfit(time - time[0], ramp, 1).tolist()
        begun = float(time[0]) - at / rate if rate > 0.0 else -math.inf
        if begun < self.record.time[0] - 1.5 * self.step:
            return self  # it moved before
        count = math.ceil(RESTED / min(CUTOFFS) / self.cutoff / self.step)
        many = round(self.step / self.sample)
        return replace(
            self, record=_rested(self.record, count), given=_rested(self.given, count * many),
            start_time=begun,
        )  # fmt: skip


def _rested(record: Record, count: int) -> Record:
    """Return a record with so many samples of rest before it."""
    step = float(record.time[1] - record.time[0])
    longer = record.each(lambda x: np.concatenate([np.full(count, x[0]), x]))
    time = record.time[0] + step * np.arange(-count, len(record.time))
    v = longer.velocity
    if v is not None:
        v[:count] = 0.0
    return replace(longer, time=time, velocity=v)


def _unresolved(pieces: Sequence[Piece]) -> str:
    """Return why no sample of records can be a row."""
    moving = sum(float(np.sum(~piece.still)) * piece.step for piece in pieces)
    total = sum(len(piece.still) * piece.step for piece in pieces)
    return (
        f"the motion is too short for the noise of its sensor: {moving:.2g} s of {total:.3g} s are"
        f" motion, and at {pieces[0].cutoff:.2g} Hz, which the noise allows, none of it is away"
        " from rests, from the ends and from where the way begins. Record a longer motion, or"
        " measure it with less noise."
    )


class BalanceRows:
    """Rows of all pieces at one cutoff: those in motion, or those at rest."""

    def __init__(
        self, pieces: Sequence[Piece], which: int, every: int, acting: Acting = AS_RECORDED, *,
        rests: bool = False,
    ) -> None:  # fmt: skip
        self.pieces, self.which, self.acting = pieces, which, acting
        self.picks: list[Places] = []
        """Finer rows of each piece that are taken."""
        far = []
        for piece in pieces:
            filt = piece.filters[which]
            usable = piece.rests(filt.band) if rests else piece.usable(filt.band)
            fine = np.arange(0, filt.rows, every)
            pick = fine[usable[fine * piece.every]]
            self.picks.append(pick)
            far.append(_distance(piece, usable)[pick * piece.every] * filt.band)
        self.far = np.concatenate(far)
        """Distance to a turn or a rest, over 1/cutoff (n,)."""
        self.count = len(self.far)
        if not self.count and not rests:
            raise InputError(_unresolved(pieces))
        sizes = [len(pick) for pick in self.picks]
        self.piece = np.repeat(np.arange(len(pieces)), sizes)
        """Number of the piece of each row."""
        self.velocity = self.taken([item.velocity for item in pieces])
        self.position = self.taken([item.record.position for item in pieces])
        self.time = self.taken([item.record.time for item in pieces])

    def taken(self, parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
        """Return values of the samples at the rows (n,)."""
        each = zip(parts, self.picks, self.pieces, strict=True)
        return np.concatenate([x[pick * piece.every] for x, pick, piece in each])

    def seen(
        self, parts: Sequence[Array], *, slope: int = 0, acting: Acting | None = None
    ) -> Array:
        """Return columns of the pieces (n, ...) as the filter shows them, or as they act."""
        channel = acting.passes if acting and acting.delay else None
        result = []
        for column, pick, piece in zip(parts, self.picks, self.pieces, strict=True):
            x, times, late = column, slope, piece.held if acting else 0.0
            if math.isfinite(piece.start_time):  # a step at the start, which is not derived
                x, times = (np.gradient(x, piece.step, axis=0) if slope else x), 0
                x = (x.T * (piece.record.time > piece.start_time)).T
            filt = piece.filters[self.which]
            result.append(filt(x, slope=times, late=late, channel=channel)[pick])
        return np.concatenate(result)

    def sensed(self, inertia: float) -> Array:
        """Return what the noise of sensors makes of the rows of a balance (n,) [N].

        That of the force is looked at where it is: spikes are noise where they stand.
        """
        result = []
        for piece, pick in zip(self.pieces, self.picks, strict=True):
            band, step = piece.filters[self.which].band, piece.step
            third = np.zeros_like(piece.record.force)
            third[1:-2] = np.diff(piece.acted(self.acting), 3) ** 2 / THIRD
            width = max(round(1.0 / band / step), 1)
            here = uniform_filter1d(uniform_filter1d(third, width), width)[pick * piece.every]
            by_place = piece.record.velocity is None
            noise = piece.noise if by_place else piece.velocity_noise
            of_inertia = inertia * noise * _derived(step, band, 2 if by_place else 1)
            result.append(_derived(step, band, 0) ** 2 * here + of_inertia**2)
        return np.asarray(np.sqrt(np.concatenate(result)))

    def slowest(self, speeds: Array, share: float) -> float:
        """Return the speed below which a share of rows is, or that of the first row of a start."""
        begins = any(math.isfinite(piece.start_time) for piece in self.pieces)
        return float(np.quantile(speeds, 0.0 if begins else share))

    @cached_property
    def hidden(self) -> Array:
        """Share of the force that is hidden if its sensor clips (n,)."""
        parts = [piece.clipped for piece in self.pieces]
        return np.minimum(np.abs(self.seen(parts, acting=self.acting)), 1.0)

    @cached_property
    def acceleration(self) -> Array:
        """Accelerations (n,) [m/s^2]."""
        each = zip(self.pieces, self.picks, strict=True)
        return np.concatenate(
            [acceleration_of(p.record, p.filters[self.which])[pick] for p, pick in each]
        )

    def unknown(self, path: str) -> Array:
        """Return what a unit of a parameter that is looked for takes (n,)."""
        own = [p.record.unknown[path] for p in self.pieces]  # each as its trial was set up
        inertia = np.array([item.inertia for item in own])[self.piece]
        return np.asarray(inertia * self.acceleration - self.seen([item.force for item in own]))

    @cached_property
    def force(self) -> Array:
        """Forces, with those of the mechanism (n,) [N]."""
        result, records = self.driven(self.acting), [piece.record for piece in self.pieces]
        if any(record.mechanism is not None for record in records):
            result += self.seen(
                [0.0 * x.time if x.mechanism is None else x.mechanism for x in records]
            )
        return result

    def driven(self, acting: Acting, slope: int = 0) -> Array:
        """Return recorded forces as they act (n,) [N], derived `slope` times."""
        forces = [piece.acted(acting) for piece in self.pieces]
        return self.seen(forces, slope=slope, acting=acting)

    @cached_property
    def response(self) -> Array:
        """What friction and what is not known balance (n,) [N]."""
        inertia = np.array([piece.record.inertia or 0.0 for piece in self.pieces])
        if not np.any(inertia) or self.pieces[0].record.friction:
            return self.force
        return self.force - inertia[self.piece] * self.acceleration


def _distance(piece: Piece, usable: Mask) -> Array:
    """Return the time from each sample to one that is not used, or turns (n,) [s]."""
    bad = ~usable
    bad[1:] |= np.diff(piece.direction) != 0.0
    bad &= piece.record.time > piece.start_time + AFTER / piece.cutoff
    at, count = np.arange(len(bad)), len(bad)
    last = np.maximum.accumulate(np.where(bad, at, -count))
    after = np.minimum.accumulate(np.where(bad, at, 2 * count)[::-1])[::-1]
    return np.minimum(at - last, after - at) * piece.step


def by_best_sensor(records: Sequence[Record]) -> list[Record]:
    """Return records without velocities where positions tell accelerations better.

    Velocities that are late, filtered on their way or from another place, have an error along their
    second derivative: it is most of what the two differ by beyond the noise of positions.
    """
    moving = [even(record) for record in records if moves(record)]
    if not all(record.velocity is not None and record.located for record in records):
        return [*records]
    bare = [replace(item, velocity=None) for item in moving]
    band = float(np.median([cutoff_of(item) for item in [*moving, *bare]]))
    less = []
    for place, item in zip(bare, moving, strict=True):
        count = len(item.time)
        filt = Filter(count=count, step=float(np.diff(item.time[:2])[0]), band=band, every=1)
        inner = slice(count // SHORTEST, -count // SHORTEST)
        apart = (acceleration_of(item, filt) - acceleration_of(place, filt))[inner]
        late = filt(np.asarray(item.velocity), slope=2)[inner]
        bias = float(late @ apart) ** 2 / (float(late @ late) + 1e-300) / len(late)
        by_place, by_speed = (_noise_of_acceleration(x, band) ** 2 for x in (place, item))
        if bias < 0.5 * (float(np.mean(apart**2)) - by_place):
            bias = 0.0  # of the positions: coarse, periodic or in another unit
        less.append(by_place < max(bias, by_speed))
    better = 2 * sum(less) > len(less)
    return [replace(record, velocity=None) for record in records] if better else [*records]


def pieces_of(
    records: Sequence[Record], cutoff: float | None = None, highest: float = math.inf
) -> tuple[list[Piece], int]:
    """Return the pieces of records, and how many of the finer rows go on one that is taken.

    The cutoff [Hz] is that of other rows, or the median of the records, and not above the highest.
    """
    fitted = cutoff is None
    checked(records)
    grids = [even(item) for item in records if moves(item)]  # what rests says nothing of sliding
    if cutoff is None:
        cutoff = min(float(np.median([cutoff_of(grid) for grid in grids])), highest)
    pieces, every = _at(grids, cutoff)
    driven = all(np.any(grid.force) and not grid.friction for grid in grids)
    if fitted and driven and _share(pieces) < SEEN:
        highest = min(highest, float(np.median([cutoff_of(grid, COSTLY) for grid in grids])))
        while _share(pieces) < SEEN and RAISED * cutoff < highest:
            cutoff *= RAISED
            pieces, every = _at(grids, cutoff)
    if fitted and all(np.all(piece.still) and not piece.travels for piece in pieces):
        raise InputError(RESTS)
    return pieces, every


def _share(pieces: Sequence[Piece]) -> float:
    """Return the part of the motion that can be rows."""
    moving = [np.abs(piece.velocity) > SURE * piece._speed_noise(piece.wider) for piece in pieces]
    used = [piece.usable(piece.cutoff) & x for piece, x in zip(pieces, moving, strict=True)]
    total = sum(int(np.sum(x)) for x in moving)
    return sum(int(np.sum(x)) for x in used) / max(total, 1)


def _at(grids: Sequence[Record], cutoff: float) -> tuple[list[Piece], int]:
    """Return the pieces of records on even grids at a cutoff, and the finer rows to one taken."""
    total = sum(grid.time[-1] - grid.time[0] for grid in grids)
    top = max(CUTOFFS) * cutoff
    pieces = []
    for entry in grids:
        step = float(entry.time[1] - entry.time[0])
        means = max(int(1.0 / (SAMPLED * cutoff * step)), 1)
        every = max(int(1.0 / (PER * FINER * top * step * means)), 1)
        record = averaged(entry, means) if means > 1 else entry
        pieces.append(Piece(record=record, given=entry, cutoff=cutoff, every=every))
    taken = max(1.0 / (PER * top), total / MOST_ROWS)
    return pieces, max(round(taken / (pieces[0].every * pieces[0].step)), 1)
