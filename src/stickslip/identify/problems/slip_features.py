"""What the force of the spring tells of a slider that it pulls: slips, levels, frequency."""

import html
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import (
    CURE,
    Finding,
    MainsLine,
    Measurement,
    is_narrow,
    lines_of,
    sentences_of,
    words_of,
)
from stickslip.errors import InputError, check_even_times
from stickslip.identify import THRESHOLDS
from stickslip.identify.fits import BLOCKS
from stickslip.maths import NORMAL_95
from stickslip.mechanisms import Mechanism, TowedBlock
from stickslip.show.described import Described
from stickslip.show.formatting import estimate, interval, number, percent, quantity, within

Array: TypeAlias = NDArray[np.float64]

LARGE = 0.25
"""A fall counts from this share of the median fall on: smaller ones are creep."""
HIGHEST = 5.0
"""Frequencies are sought up to so many times the natural one."""
AGREE = 0.25
"""Logarithm by which the top of a spectrum and the rate of regular slips may differ: irregular
slips with a coefficient of variation of 0.2 reach 0.1."""
Regime: TypeAlias = Literal["stick-slip", "inertial oscillation", "steady sliding"]
COMPARED: tuple[str, ...] = ("frequency", "mean", "standard_deviation")
"""Features that a simulated limit cycle is compared by."""
FEATURES = "features"
"""What `fit` and `select` call the way that compares features."""
READ = 2e-3
"""Features are read off samples to this share at best, however regular the record is."""
LONG = 1.5
"""Cycles longer than so many natural periods are of sticking and slipping."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Slips:
    """Slips of a record, one entry each."""

    place: NDArray[np.intp]
    """Sample in the middle of each slip (n,)."""
    level: Array
    """Highest force before each (n,)."""
    drop: Array
    """How far the force falls (n,)."""
    slope: Array
    """Slope of the force between slips (n - 1,), by sample."""


def slips_of(force: Array, half_period: int) -> Slips:
    """Return the slips of a force sampled evenly, each lasting about half a natural period.

    Examples
    --------
    >>> saw = np.tile(np.linspace(0.0, 1.0, 100), 5)
    >>> found = slips_of(saw, 3)
    >>> len(found.place), found.slope.round(4)
    (4, array([0.0101, 0.0101, 0.0101]))
    """
    from scipy.ndimage import uniform_filter1d
    from scipy.signal import find_peaks

    n = max(half_period, 1)
    smooth = uniform_filter1d(force, max(n // 2, 1))
    fall = np.zeros_like(force)
    fall[n:-n] = smooth[: -2 * n] - smooth[2 * n :]
    lag = max(n // 2, 1)
    rises = smooth[lag:] - smooth[:-lag]
    rise = float(np.median(rises))  # while it sticks, which is most of the time
    scatter = 1.4826 * float(np.median(np.abs(rises - rise)))
    usual = -rise * 2 * n / lag
    height = usual + THRESHOLDS.outlying * scatter + 1e-9 * float(np.ptp(force))
    place, _ = find_peaks(fall, height=height, distance=2 * n)
    if len(place):
        place = place[fall[place] >= LARGE * np.median(fall[place])]
    level = np.array([smooth[max(i - 3 * n, 0) : i + 1].max() for i in place])
    low = np.array([smooth[i : i + 3 * n].min() for i in place])
    spans = [(i + 2 * n, j - n) for i, j in pairwise(place)]
    slopes = [np.polyfit(np.arange(j - i), force[i:j], 1)[0] for i, j in spans if j - i > n]
    return Slips(place=place, level=level, drop=level - low, slope=np.array(slopes))


def cycles_of(force: Array, period: float) -> NDArray[np.intp]:
    """Return where the cycles of a force (n,) begin: where it has come from low to high.

    What changes over two periods or more does not count.

    Examples
    --------
    >>> wave = np.sin(2.0 * np.pi * np.arange(1000.0) / 40.0) + np.linspace(0.0, 3.0, 1000)
    >>> np.unique(np.diff(cycles_of(wave, 40.0)[2:-2])).tolist()
    [40]
    """
    from scipy.ndimage import uniform_filter1d

    fast = force - uniform_filter1d(force, max(round(2.0 * period), 1))
    limit = float(np.median(np.abs(fast)))  # half of the force is above or below that
    outside = np.flatnonzero(np.abs(fast) > limit)
    high = fast[outside] > 0.0
    return np.asarray(outside[1:][high[1:] & ~high[:-1]], dtype=np.intp)


def spectra_of(force: Array, blocks: int, highest: float = 0.5) -> tuple[Array, Array]:
    """Return frequencies by sample (m,) and the spectra of half overlapping blocks (k, m)."""
    from scipy.fft import next_fast_len, rfft

    length = 2 * len(force) // (blocks + 1)
    starts = np.linspace(0, len(force) - length, blocks).astype(int)
    window = np.hanning(length)
    ramp = np.linspace(-1.0, 1.0, length)
    padded = next_fast_len(len(force), real=True)
    frequency = np.fft.rfftfreq(padded)
    kept = frequency <= highest
    spectra = []
    for start in starts:
        part = force[start : start + length]
        part = part - part.mean() - ramp * (ramp @ part) / (ramp @ ramp)
        spectra.append(np.abs(rfft(window * part, padded)[kept]) ** 2)
    return np.asarray(frequency[kept], dtype=float), np.array(spectra)


def peak_of(frequency: Array, spectrum: Array) -> float:
    """Return the frequency that carries most, counted by octaves: slow wandering does not.

    Examples
    --------
    >>> t = np.arange(4000.0)
    >>> frequency, spectra = spectra_of(np.sin(2.0 * np.pi * 0.0437 * t) + 1e-3 * t, 8)
    >>> round(peak_of(frequency, spectra.mean(axis=0)), 4)
    0.0437
    """
    carried = frequency * spectrum
    i = int(np.argmax(carried[1:-1])) + 1
    while 0 < i < len(spectrum) - 1 and spectrum[i] < max(spectrum[i - 1], spectrum[i + 1]):
        nearest = i + (1 if spectrum[i + 1] > spectrum[i - 1] else -1)
        if abs(frequency[nearest] - frequency[int(np.argmax(carried))]) > 0.1 * frequency[i]:
            break  # counting by octaves moves a line by far less: this is the slope of another one
        i = nearest
    i = min(max(i, 1), len(spectrum) - 2)
    before, here, after = np.log(np.maximum(spectrum[i - 1 : i + 2], 1e-300))
    bend = before - 2.0 * here + after
    # more than half a bin is no top of a peak, but the end of what was looked at
    shift = min(max(0.5 * (before - after) / bend, -0.5), 0.5) if bend < 0.0 else 0.0
    return float(frequency[i] + shift * (frequency[1] - frequency[0]))


def frequency_of(
    force: Array, step: float, *, natural: float, slips: NDArray[np.intp] | None
) -> float:
    """Return the frequency of a force [Hz]: of its slips if there are any, else of its spectrum.

    Examples
    --------
    >>> saw = np.tile(np.linspace(0.0, 1.0, 100), 40)
    >>> round(frequency_of(saw, 0.01, natural=20.0, slips=np.arange(100, 4000, 100)), 6)
    1.0
    """
    frequencies, spectra = spectra_of(force, 2 * BLOCKS - 1, HIGHEST * natural * step)
    top = peak_of(frequencies, spectra.mean(axis=0)) / step
    if slips is not None:
        tops = [peak_of(frequencies, item) for item in spectra[::2]]
        _refuse_contradiction(top, _error(tops), force, step, slips)
        return (len(slips) - 1) / (step * float(np.ptp(slips)))
    if _hum(force, step, top):
        raise InputError(
            "the force shows mains hum and no stick-slip: no slips are detected, the power per"
            f" octave is largest at {quantity(top, 'Hz', 4)}, and the line at"
            f" {words_of(_hum(force, step, top))} is narrow. {CURE}. Motion of the block at"
            " exactly this frequency cannot be distinguished from hum: record it at another speed."
        )
    return top


def _error(values: Sequence[float] | Array) -> float:
    """Return the standard error of the logarithm of the mean of values above 0."""
    return float(np.std(np.log(values)) / math.sqrt(max(len(values) - 1, 1)))


def _hum(force: Array, step: float, top: float) -> tuple[MainsLine, ...]:
    """Return the lines of the mains, if one is the top of the spectrum or they falsify features."""
    lines = lines_of(force, step)
    left = 1.0 - sum(line.share for line in lines)
    # of the variance: what the standard deviation would be without them
    falsify = math.sqrt(max(left, 0.0)) < 1.0 - THRESHOLDS.pattern
    return lines if falsify or any(abs(line.frequency / top - 1.0) < 0.01 for line in lines) else ()


def _refuse_contradiction(
    top: float, error: float, force: Array, step: float, slips: NDArray[np.intp]
) -> None:
    """Refuse a record whose spectrum has its top [Hz] above the rate of its slips.

    Below it, a spectrum shows how levels wander from slip to slip. `error` is that of the logarithm
    of the top.
    """
    count, waits = len(slips), step * np.diff(slips)
    rate = 1.0 / float(waits.mean())
    apart = math.log(top / rate)
    narrow = apart > AGREE and is_narrow(force, step, top)
    errors = error, _error(waits)
    contradict = narrow or apart > AGREE + THRESHOLDS.outlier * math.hypot(*errors)
    lines = _hum(force, step, top)
    if not contradict and not lines:
        return
    result = (
        f"{count} slips are {quantity(1.0 / rate, 's')} apart on average, a rate of"
        f" {quantity(rate, 'Hz')}"
    )
    if lines:
        said = f"the force has mains hum at {words_of(lines)}, but {result}"
        cure = f"{CURE}."
    else:
        said = (
            "the spectrum and the slips disagree: the power per octave is largest at"
            f" {quantity(top, 'Hz')}, but {result}"
        )
        cure = f"Find the cause of the force at {quantity(top, 'Hz')}, or use a notch filter."
    raise InputError(f"{said}: the features would mix two motions. {cure}")


def refuse_without_cycles(force: Array, step: float, top: float) -> None:
    """Refuse a slow force with too few slips to be stick-slip, unless it has smooth cycles.

    `top` is the frequency [Hz] of its spectrum.

    Examples
    --------
    >>> t = np.arange(0.0, 20.0, 0.01)
    >>> refuse_without_cycles(np.sin(2.0 * np.pi * t), 0.01, 1.0)
    """
    cycles = cycles_of(force, 1.0 / (top * step))
    rate = (
        (len(cycles) - 1) / (step * float(np.ptp(cycles)))
        if len(cycles) > THRESHOLDS.fewest
        else 0.0
    )
    if rate == 0.0 or abs(math.log(top / rate)) > AGREE:
        said = f"but it passes through {len(cycles)} cycles"
        said += f", which are {quantity(rate, 'Hz')}" if rate else " only"
        raise InputError(
            "the force shows no stick-slip: fewer than four slips are detected. Its power per"
            f" octave is largest at {quantity(top, 'Hz')}, {said}. Record for longer or with less"
            " noise."
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class StickSlipFeatures(metaclass=Described):
    """Features of one record; forces are over the load, so they read as coefficients."""

    mean: float
    """Mean force."""
    standard_deviation: float
    """Standard deviation of the force."""
    frequency: float
    """Slips a second; that of the spectrum where the motion is not stick-slip [Hz]."""
    natural_frequency: float
    """sqrt(k/m) / (2 pi) of the nominal mass [Hz]."""
    slips: int
    """Number of slips; 0 where the motion is not stick-slip."""
    waiting_times: Array
    """Times between slips (slips - 1,) [s]."""
    levels: Array
    """Highest force before each slip (slips,)."""
    drops: Array
    """Fall of the force in each slip (slips,)."""
    slope_ratio: float
    """Median slope of the force between slips over k V; NaN without slips."""
    halves: tuple[float, float]
    """Mean force in the first and the second half."""
    drifts: bool
    """Whether the mean changes from the first half to the second, beyond its doubt."""
    regime: Regime
    """Kind of motion."""
    stretches: Array
    """Logarithms of frequency, mean and standard deviation (s, 3) of stretches of whole cycles."""
    findings: tuple[Finding, ...]
    """What can be said: of kinds ``"frequency"``, ``"slips"``, ``"scatter"`` and ``"drift"``."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """The findings in words."""
        return sentences_of(self.findings)

    @property
    def too_fast(self) -> bool:
        """Whether the frequency is not that of the nominal mass: it is above the natural one."""
        return self.frequency > (1.0 + THRESHOLDS.material) * self.natural_frequency

    @property
    def waiting_time(self) -> float:
        """Median time between slips [s]; NaN with fewer than two."""
        return float(np.median(self.waiting_times)) if len(self.waiting_times) else math.nan

    @property
    def break_away(self) -> float:
        """Mean of the highest force before slips; NaN without slips."""
        return float(self.levels.mean()) if self.slips else math.nan

    @property
    def drop(self) -> float:
        """Median fall of the force in a slip; NaN without slips."""
        return float(np.median(self.drops)) if self.slips else math.nan

    @property
    def compared(self) -> Array:
        """Frequency, mean and standard deviation (3,)."""
        return np.array([getattr(self, name) for name in COMPARED])

    @property
    def covariance(self) -> Array:
        """Of the logarithms of frequency, mean and standard deviation (3, 3)."""
        return np.asarray(np.cov(self.stretches.T) / len(self.stretches) + READ**2 * np.eye(3))

    def __str__(self) -> str:
        """Return the numbers in a line, then the sentences."""
        head = (
            f"{self.regime}: {quantity(self.frequency, 'Hz')}, mean F/N {number(self.mean)},"
            f" standard deviation {number(self.standard_deviation)}"
        )
        return "\n".join([head, *self.sentences])

    def __repr__(self) -> str:
        return f"<StickSlipFeatures: {str(self).splitlines()[0]}>"

    def _repr_html_(self) -> str:
        return "".join(f"<p>{html.escape(line)}</p>" for line in str(self).splitlines())

    def to_dict(self) -> Mapping[str, Any]:
        """Return the features as plain numbers and strings."""
        numbers = {
            "regime": self.regime,
            "frequency": self.frequency,
            "natural_frequency": self.natural_frequency,
            "mean": self.mean,
            "standard_deviation": self.standard_deviation,
            "slips": self.slips,
            "median_waiting_time": self.waiting_time,
            "break_away": self.break_away,
            "break_away_spread": float(self.levels.std()) if self.slips else math.nan,
            "drop": self.drop,
            "slope_ratio": self.slope_ratio,
            "drifts": self.drifts,
            "sentences": list(self.sentences),
        }
        empty = (name for name, v in numbers.items() if isinstance(v, float) and math.isnan(v))
        return {**numbers, **dict.fromkeys(empty)}


def features_of(measurement: Measurement, *, mechanism: Mechanism) -> StickSlipFeatures:
    """Return the features of the force of a spring that pulls a block.

    Slips are falls of the force over half a natural period that stand out of its scatter and are
    at least a quarter of the median fall. The frequency of stick-slip is one over the mean time
    between them. That of other motions is where a spectrum, averaged over half overlapping eighths
    of the record, carries most by octave; for stick-slip it is the cross-check.

    Parameters
    ----------
    measurement : Measurement
        One record with ``time`` and ``spring_force`` [N].
    mechanism : TowedBlock
        Mass, stiffness, pulling speed and load.

    Returns
    -------
    StickSlipFeatures
        With forces over the load.

    Raises
    ------
    InputError
        If the record or the mechanism will not do; if the spectrum contradicts the slips by more
        than the doubt of both; if what the spectrum shows is mains hum.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> t = np.linspace(20.0, 200.0, 9001)
    >>> run = simulate(block, law, t_end=200.0).at(t)
    >>> record = Measurement(time=t, spring_force=2.0 * (0.1 * t - run["x"]))
    >>> features = features_of(record, mechanism=block)
    >>> features.regime, features.slips, round(features.waiting_time, 2)
    ('stick-slip', 24, 7.62)
    """
    block = towed(mechanism)
    step, force = evenly(measurement, block)
    natural = math.sqrt(block.stiffness / block.mass) / (2.0 * math.pi)
    result = slips_of(force, max(1, round(0.5 / natural / step)))
    events, waiting = result.place, step * np.diff(result.place)
    # it sticks between slips that are far apart
    several = len(waiting) >= THRESHOLDS.fewest
    slow = several and float(np.median(waiting)) * natural > LONG
    read = frequency_of(force, step, natural=natural, slips=events if slow else None)
    regime: Regime = "stick-slip" if slow else _regime(force, read, natural)
    if regime == "stick-slip" and not slow:
        refuse_without_cycles(force, step, read)
    stretches = stretches_of(force, read * step, events if slow else None)
    if regime != "stick-slip":
        none = np.empty(0)
        result = Slips(place=result.place[:0], level=none, drop=none, slope=none)
        waiting = none
    pull = block.stiffness * block.speed * step / block.steady_load
    halves = tuple(float(part.mean()) for part in np.array_split(force, 2))
    parts: dict[str, Any] = {
        "mean": float(np.exp(stretches[:, 1]).mean() * np.sign(force.mean())),
        "standard_deviation": float(np.sqrt(np.exp(2.0 * stretches[:, 2]).mean())),
        "frequency": read,
        "natural_frequency": natural,
        "slips": len(result.place),
        "waiting_times": waiting,
        "levels": result.level,
        "drops": result.drop,
        "slope_ratio": float(np.median(result.slope)) / pull if len(result.slope) else math.nan,
        "halves": halves,
        "drifts": _drifts(force),
        "regime": regime,
        "stretches": stretches - [math.log(step), 0.0, 0.0],
    }
    plain = StickSlipFeatures(**parts, findings=())
    return StickSlipFeatures(**parts, findings=findings_of(plain))


def _drifts(force: Array) -> bool:
    """Return whether the mean of a force changes from its first half to its second."""
    halves = np.array([x.mean() for x in np.array_split(force, 2 * BLOCKS)]).reshape(2, -1)
    change, doubt = np.ptp(halves.mean(axis=1)), math.sqrt(halves.var(axis=1).sum() / BLOCKS)
    return bool(change > max(NORMAL_95 * doubt, 0.5 * THRESHOLDS.material * abs(np.mean(force))))


def towed(mechanism: Mechanism) -> TowedBlock:
    """Return the mechanism if a spring pulls it at a steady speed."""
    if not isinstance(mechanism, TowedBlock) or mechanism.speed <= 0.0:
        raise InputError(
            f"features of stick-slip need a TowedBlock with a speed above 0 m/s, got {mechanism!r}."
        )
    if not mechanism.steady_load > 0.0:
        raise InputError(
            "TowedBlock.load (N) must be above 0 N, got 0: features of stick-slip compare a force"
            " with the load. Give the load of the block."
        )
    return mechanism


def evenly(measurement: Measurement, block: TowedBlock) -> tuple[float, Array]:
    """Return the time between samples [s] and the force over the load, sampled evenly."""
    if measurement.trials or measurement.time is None or measurement.spring_force is None:
        raise InputError(
            "features of stick-slip need one record with time and spring_force [N]. Convert a"
            " coefficient to a force with gain={'spring_force': load}."
        )
    time = measurement.time
    force = np.asarray(measurement.values("spring_force")) / block.steady_load
    step = float(np.median(np.diff(time)))
    count = round(float(time[-1] - time[0]) / step) + 1
    check_even_times(count)
    natural = math.sqrt(block.stiffness / block.mass) / (2.0 * math.pi)
    if count < 100 or step * natural > 0.25:
        raise InputError(
            f"features of stick-slip need at least 100 samples and 4 in a natural period of"
            f" {quantity(1.0 / natural, 's')}, got {count} samples {quantity(step, 's')} apart."
        )
    if count * step * natural < 1.0:
        raise InputError(
            f"features of stick-slip need a record of one natural period or more, here"
            f" {quantity(1.0 / natural, 's')}, got {quantity(count * step, 's')}: check mass and"
            " stiffness of the block."
        )
    return step, np.interp(time[0] + step * np.arange(count), time, force)


def _regime(force: Array, frequency: float, natural: float) -> Regime:
    """Return what moves without slips that stand out."""
    if is_steady(float(force.mean()), float(force.std())):
        return "steady sliding"
    return "inertial oscillation" if frequency * LONG > natural else "stick-slip"


def is_steady(mean: float, spread: float) -> bool:
    """Whether a force with a mean and a standard deviation is that of steady sliding.

    Examples
    --------
    >>> is_steady(0.3, 0.001), is_steady(0.3, 0.01)
    (True, False)
    """
    return spread < THRESHOLDS.pattern * abs(mean)


def stretches_of(force: Array, frequency: float, slips: NDArray[np.intp] | None) -> Array:
    """Return logarithms of frequency, mean and standard deviation (s, 3) of whole cycles.

    Noise of the sensor, by second differences of neighbouring samples, is taken from the variance;
    what changes from stretch to stretch is in none. Cycles of a `frequency`, by sample, begin at
    slips if there are any; without cycles, stretches are alike in length.

    Examples
    --------
    >>> wave = 1.0 + 0.1 * np.sin(2.0 * np.pi * np.arange(4000.0) / 40.0)
    >>> found = np.exp(stretches_of(wave, 0.025, None))
    >>> found.shape, found.mean(axis=0).round(4).tolist()
    ((8, 3), [0.025, 1.0, 0.0707])
    """
    begins = cycles_of(force, 1.0 / frequency) if slips is None else slips
    count = len(begins) - 1
    if count < THRESHOLDS.fewest:
        begins, count = np.linspace(0, len(force), BLOCKS + 1).astype(np.intp), BLOCKS
    number = min(BLOCKS, max(THRESHOLDS.fewest, count // 2))
    chosen = np.linspace(0, count, number + 1).round().astype(np.intp)
    edges = begins[chosen]
    parts = [force[i:j] for i, j in pairwise(edges)]
    bends = np.diff(force, 2)
    noise = (1.4826 * float(np.median(np.abs(bends)))) ** 2 / 6.0
    spread = np.array([float(part.var()) for part in parts])
    spread = np.maximum(spread - noise, 0.25 * spread + 1e-30)
    rates = np.log(np.diff(chosen) / np.diff(edges))
    means = np.log(np.maximum([abs(float(part.mean())) for part in parts], 1e-300))
    return np.column_stack([rates - rates.mean() + math.log(frequency), means,
                            0.5 * np.log(spread)])  # fmt: skip


def findings_of(found: StickSlipFeatures) -> tuple[Finding, ...]:
    """Return what can be said of features of a record."""
    said = []

    def add(kind: str, sentence: str) -> None:
        said.append(Finding(kind=kind, sentence=sentence))

    ratio = found.frequency / found.natural_frequency
    error = math.sqrt(found.covariance[0, 0])
    if found.too_fast and found.regime == "inertial oscillation":
        low, high = ratio * math.exp(-2.0 * error), ratio * math.exp(2.0 * error)
        add(
            "frequency",
            f"The observed frequency is {within(ratio, low, high)} ({interval(low, high)}) times"
            " sqrt(k/m)/(2 pi) of the nominal mass: a rigid body of the nominal mass cannot"
            f" oscillate so fast; an effective mass of {number(1.0 / ratio**2, 2)} times the"
            " nominal one could.",
        )
    if found.slips > 1:
        spread = found.waiting_times.std() / found.waiting_times.mean()
        add(
            "slips",
            f"{found.slips} slips, {quantity(found.waiting_time, 's')} apart in the median;"
            " break-away at"
            f" {estimate(found.break_away, float(found.levels.std()))}, median drop"
            f" {number(found.drop)},"
            f" slope between slips {number(found.slope_ratio, 2)} k V.",
        )
        if spread > 0.2:
            add(
                "scatter",
                f"Waiting times scatter by {percent(spread)}: a law with fixed parameters predicts"
                " a single waiting time and cannot explain the scatter.",
            )
    if found.drifts:
        first, second = found.halves
        add(
            "drift",
            f"The record drifts: the mean F/N is {number(first)} in the first half and"
            f" {number(second)} in the second. Features of the whole record mix"
            " different states.",
        )
    return tuple(said)
