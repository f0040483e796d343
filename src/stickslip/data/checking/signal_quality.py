"""Single signals: their times, constant, saturated or jumping values, doubtful units, mains hum."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from stickslip.data.checking.finding import OTHER_SPEEDS, Finding, Severity
from stickslip.data.checking.motion import Motion
from stickslip.data.differentiation import interval_of, noise_of, step_of
from stickslip.data.measurement import QUANTITIES, SAMPLED, Array, Measurement
from stickslip.data.tolerances import (
    FEWEST,
    FEWEST_SAMPLES,
    GAP,
    MOSTLY,
    NEGLIGIBLE,
    PER_MILLE,
    SIX_DIGITS,
)
from stickslip.show.formatting import count, joined, number, percent, quantity

# Narrow lines at the frequency of the mains and its harmonics.

MAINS: Final = (50.0, 60.0)
"""Frequencies of mains [Hz]."""
ORDERS: Final = (1, 2, 3, 4, 5)
"""Harmonics looked at; a rectifier has its ripple at the second."""
WANDER: Final = 0.2
"""Mains keep to this [Hz] nearly all the time (EN 50160: 0.5 Hz for 99.5 % of a year)."""
BLOCK: Final = 20.0
"""Length of the blocks whose spectra are averaged [s]: mains wander more in longer ones."""
BAND_HALF_WIDTH: Final = 0.15
"""Half width, over its frequency, of the band that a line must stand out of. That of 50 Hz does not
reach 60 Hz, and 45 and 55 Hz, of a motion of 5 Hz with all its harmonics, lie within it."""
STANDS: Final = 8.0
"""A line has so many times the largest power beside it: noise of a few averages stays below."""
BASES: Final = (2, 3, 4, 5)
"""A line is a harmonic of another motion if there is a stronger one at such a part of it."""
LOBE: Final = 3
"""Bins to each side over which the window spreads a line."""
FEWEST_BINS: Final = 100
"""Bins below a line at least."""
CURE: Final = (
    "Shield and ground the sensor's cable and record again, or remove the line with a notch filter"
)
"""What is to be done about hum."""


@dataclass(frozen=True, kw_only=True)
class MainsLine:
    """A narrow line of a spectrum."""

    frequency: float
    """Where it is [Hz]."""
    mains: float
    """Frequency of the mains that it belongs to [Hz]."""
    order: int
    """Harmonic of the mains."""
    share: float
    """Share of the variance that it carries."""
    amplitude: float
    """Amplitude, in the unit of the signal."""


def lines_of(values: Array, step: float) -> tuple[MainsLine, ...]:
    """Return the lines of the mains in a signal, the fundamental or its first harmonic first.

    Examples
    --------
    >>> t = np.arange(0.0, 20.0, 1e-3)
    >>> wave = np.sin(2.0 * np.pi * 1.3 * t) + 0.05 * np.sin(2.0 * np.pi * 49.98 * t)
    >>> [(round(line.frequency, 2), round(line.amplitude, 3)) for line in lines_of(wave, 1e-3)]
    [(49.98, 0.05)]
    """
    power, width = _spectrum(values, step)
    variance = float(np.var(values))
    if not variance > 0.0 or not np.isfinite(variance):
        return ()
    found = []
    for mains in MAINS:
        lines: list[MainsLine] = []
        for order in ORDERS:
            near = order * mains
            if order == 1:  # that of a harmonic may be the place of another one
                near = _folded(near, 1.0 / step)
            place = _standing(power, near, width)
            if place is None or (not lines and _is_harmonic(power, place, width)):
                continue
            rows = slice(place - LOBE, place + LOBE + 1)
            share = float(power[rows].sum()) / variance
            # Between bins: the mean of three, weighted by their power.
            center = float(np.average(np.arange(place - 1, place + 2), weights=power[rows][2:5]))
            lines.append(
                MainsLine(
                    frequency=center * width,
                    mains=mains,
                    order=order,
                    share=min(share, 1.0),
                    amplitude=float(np.sqrt(2.0 * min(share, 1.0) * variance)),
                )
            )
        # A rectifier may leave the second harmonic alone; higher ones alone are of other motions.
        if any(line.order <= 2 for line in lines):
            found.append(tuple(lines))
    return max(found, key=lambda lines: sum(line.share for line in lines), default=())


def is_narrow(values: Array, step: float, frequency: float) -> bool:
    """Whether a signal has a narrow line at a frequency [Hz], of the mains or not.

    Below some 16 periods in a block of 20 s, a line cannot be told from a broader peak.

    Examples
    --------
    >>> t = np.arange(0.0, 20.0, 1e-3)
    >>> noise = np.random.default_rng(0).normal(size=len(t))
    >>> [is_narrow(noise + np.sin(2.0 * np.pi * 37.0 * t), 1e-3, f) for f in (37.0, 50.0)]
    [True, False]
    """
    power, width = _spectrum(values, step)
    return _standing(power, frequency, width) is not None


def _spectrum(values: Array, step: float) -> tuple[Array, float]:
    """Return the power in each bin (m,), averaged over half overlapping blocks, and their width."""
    length = min(len(values), max(round(BLOCK / step), 2))
    starts = range(0, len(values) - length + 1, max(length // 2, 1))
    # The window keeps strong lines from leaking over the band beside them.
    window = np.hanning(length)
    total = np.zeros(length // 2 + 1)
    ramp = np.linspace(-1.0, 1.0, length)
    for start in starts:
        part = values[start : start + length]
        # Without mean and trend, whose leaking would hide lines.
        part = part - part.mean() - ramp * (ramp @ part) / (ramp @ ramp)
        total += np.abs(np.fft.rfft(window * part)) ** 2
    weight = float(window @ window) or 1.0  # a window of two samples has none
    # so that the sum over all bins is the variance (Parseval)
    return 2.0 * total / (len(starts) * length * weight), 1.0 / (length * step)


def _folded(frequency: float, rate: float) -> float:
    """Return where a frequency is seen that is sampled at a rate."""
    folded = frequency % rate
    return min(folded, rate - folded)


def _is_harmonic(power: Array, place: int, width: float) -> bool:
    """Whether a line is a harmonic of a stronger one."""
    bases = (_standing(power, place * width / part, width) for part in BASES)
    return any(base is not None and power[base] > power[place] for base in bases)


def _standing(power: Array, frequency: float, width: float) -> int | None:
    """Return the bin of a line near a frequency that stands out of the band about it."""
    reach = round(WANDER / width) + 1
    middle = round(frequency / width)
    aside = round(BAND_HALF_WIDTH * middle)
    # The band must be wider than line and lobe, and end below half the sampling frequency.
    if aside < 2 * (reach + LOBE) or middle + reach + 2 * LOBE >= len(power):
        return None
    place = middle - reach + int(np.argmax(power[middle - reach : middle + reach + 1]))
    beside = np.concatenate(
        [power[middle - aside : place - LOBE], power[place + LOBE + 1 : middle + aside + 1]]
    )
    return place if power[place] > STANDS * float(beside.max()) else None


def words_of(lines: tuple[MainsLine, ...]) -> str:
    """Return lines in words, such as ``"50 Hz, with harmonics at 100 and 150 Hz"``.

    Examples
    --------
    >>> line = MainsLine(frequency=50.01, mains=50.0, order=1, share=0.1, amplitude=1.0)
    >>> words_of((line,))
    '50 Hz'
    """
    first, *rest = lines
    text = f"{number(first.frequency)} Hz"
    if abs(first.frequency - first.order * first.mains) > 2.0 * WANDER:
        text += f" (alias of {number(first.order * first.mains)} Hz)"
    if rest:
        text += f", with harmonics at {', '.join(number(line.frequency) for line in rest)} Hz"
    return text


def hum(record: Measurement) -> Iterator[Finding]:
    """Name lines of the mains in what was sampled."""
    time = np.asarray(record.time)
    step = float(np.median(np.diff(time)))
    count = round(float(time[-1] - time[0]) / step) + 1
    if not FEWEST_BINS <= count <= 10 * len(time):  # mostly gaps
        return
    even = time[0] + step * np.arange(count)
    for name in SAMPLED:
        values = getattr(record, name)
        if not isinstance(values, np.ndarray):
            continue
        lines = lines_of(np.interp(even, time, values), step)
        if not lines:
            continue
        share = sum(line.share for line in lines)
        size = quantity(lines[0].amplitude, record.unit(name))
        yield Finding(
            kind="mains hum",
            severity="warning" if share >= PER_MILLE else "info",
            sentence=(
                f"{name.replace('_', ' ').capitalize()} has a narrow spectral line at"
                f" {words_of(lines)}, with an amplitude of {size} and {percent(share)} of the"
                f" variance: mains hum. {CURE}."
            ),
            numbers={
                "frequency": lines[0].frequency,
                "amplitude": lines[0].amplitude,
                "share": share,
            },
        )


FEW: Final = 50
UNEVEN: Final = 0.2
SEEN: Final = 1e-5
"""Deviation below which only the last digits of the times differ."""
SHOWN: Final = 3
MILLISECONDS = " If they are in milliseconds, give --unit time=ms."
SLOWEST, FASTEST = 5.0, 1e6
"""Sampling frequencies [Hz] of forces and motions between which nobody wonders."""


def length(time: Array) -> Iterator[Finding]:
    """Say whether a record is too short for anything."""
    n = time.size
    if n >= FEW:
        return
    sentence = "estimates from so few samples are unreliable."
    if n < FEWEST_SAMPLES:
        sentence = f"a fit needs at least {FEWEST_SAMPLES}."
    yield Finding(
        kind="length",
        severity="error" if n < FEWEST_SAMPLES else "warning",
        sentence=f"The record has only {count(n, 'sample')}: {sentence}",
        measure="Record more samples",
        numbers={"samples": n},
    )


def sampling(time: Array) -> Iterator[Finding]:
    """Say how many samples there are, at which rate, and how evenly spaced."""
    steps, dt = np.diff(time), interval_of(time)
    regular = steps[steps <= GAP * dt]
    off = np.abs(regular - dt) / dt
    worst, typical = float(off.max()), float(np.sqrt(np.mean(off**2)))
    odd = float(np.mean(off > 0.5))
    rate, span = 1.0 / dt, float(time[-1] - time[0])
    text = f"{count(time.size, 'sample')} at {quantity(rate, 'Hz')} over {quantity(span, 's')}"
    if worst <= NEGLIGIBLE:
        least = "below 0.001 %" if worst < SEEN else percent(worst)
        between = " between gaps" if regular.size < steps.size else ""
        text += f", evenly spaced{between} (largest deviation {least})."
    elif odd and odd < NEGLIGIBLE:
        long, short = regular > 1.5 * dt, regular < 0.5 * dt
        # beside a short step, a long one is that of a sample off its time, and none is missing
        beside = int(np.sum((long[:-1] & short[1:]) | (short[:-1] & long[1:])))
        missing = max(0, int(np.sum(np.rint(regular[long] / dt) - 1)) - beside)
        early = max(0, int(np.sum(short)) - beside)
        what = [f"{count(missing, 'single sample')} missing"] if missing else []
        what += [f"{count(early, 'sample')} come{'s' * (early == 1)} early"] if early else []
        what += [f"{count(beside, 'sample')} off the grid"] if beside else []
        steps_off = count(int(np.sum(off > 0.5)), "step")
        text += f", evenly spaced except for {steps_off} ({joined(what)})."
    else:
        text += (
            f", with intervals that scatter by {percent(typical)} (largest deviation"
            f" {percent(worst)})."
        )
        if typical > UNEVEN:
            text += " Velocities derived from positions are unreliable."
    yield Finding(
        kind="sampling",
        severity="warning" if typical > UNEVEN else "info",
        sentence=text,
        measure="Record at even intervals" if typical > UNEVEN else "",
        numbers={
            "samples": time.size,
            "rate": rate,
            "duration": span,
            "largest_deviation": worst,
            "scatter": typical,
        },
    )


def gaps(time: Array) -> Iterator[Finding]:
    """Say where samples are missing: steps over three times the usual one."""
    steps, dt = np.diff(time), interval_of(time)
    at = np.flatnonzero(steps > GAP * dt)
    if not at.size:
        return
    largest = at[np.argsort(steps[at], kind="stable")[::-1]][:SHOWN]
    for i in np.sort(largest):
        missing = round(float(steps[i]) / dt) - 1
        yield Finding(
            kind="gap",
            severity="warning",
            sentence=(
                f"Gap of {quantity(float(steps[i]), 's')} after {quantity(float(time[i]), 's', 6)}"
                f" ({count(missing, 'sample')} missing)."
            ),
            numbers={"time": float(time[i]), "duration": float(steps[i]), "samples": missing},
        )
    if at.size > SHOWN:
        total = float(np.sum(steps[at]))
        yield Finding(
            kind="gap",
            severity="warning",
            sentence=(
                f"{number(at.size, 6)} gaps longer than {number(GAP)} sampling intervals in total,"
                f" {percent(total / float(time[-1] - time[0]))} of the time; the longest are"
                " listed."
            ),
            numbers={"gaps": at.size, "duration": total},
        )


def usual(record: Measurement) -> Iterator[Finding]:
    """Ask for the unit of times at which no controller or camera takes forces and positions.

    Friction itself may be slow: rock is sampled once a second.
    """
    known = {*record.quantities()}
    driven = "force" in known and bool(known & {"position", "velocity"})
    if record.time is None or not (driven or record.line is not None):
        return
    dt = interval_of(record.time)
    if known & {"friction", "spring_force", "pull"} or SLOWEST <= 1.0 / dt <= FASTEST:
        return
    yield Finding(
        kind="units",
        severity="warning",
        sentence=(
            f"{'Force and motion' if driven else 'Positions'} were sampled every"
            f" {quantity(dt, 's')}, {quantity(1.0 / dt, 'Hz')}: check that times are in"
            f" seconds.{MILLISECONDS if 1.0 / dt < SLOWEST else ''}"
        ),
        numbers={"interval": dt},
    )


LIMITED: Final = ("force", "spring_force")
"""What an amplifier or a sensor may limit; a friction that stays the same may be just that."""
NAMES: Final = {name: name.replace("_", " ") for name in QUANTITIES}
LARGEST_VALUES: Final = {
    **{"m": 100.0, "m/s": 300.0, "N": 1e7, "rad": 1e5, "rad/s": 1e4, "N m": 1e7},
    **{"V": 1e4, "A": 1e4},
}
HUGE: Final = 1e60
WORDS: Final = {"m": "metres", "N": "newtons", "rad": "radians", "V": "volts", "A": "amperes"}
SPANNED: Final = ("m", "rad")
IMPOSSIBLE_SPEED: Final = 1000.0
"""Speed [m/s] of a bullet: no body with friction that is measured moves faster."""
LONGEST_RUN: Final = 20
"""Samples that a signal must sit at its extreme to count as saturated."""
LONGER: Final = 8
"""... and how many times longer than at the levels beside it: a rounded peak is 5 times as long."""
SIDE: Final = 8
"""Samples beside a position's flat extreme at least that show whether it comes or leaves slowly."""
FLAT: Final = 6
"""... and at most a sixth of the flat: where a rounded peak is cut off, both sides are straight."""
SINGLE_STEP: Final = (1.5, 2.5)
"""Way in twice the time over that in the time itself: 2 at one speed, 4 from rest, 1 in a jump."""
CLEAR: Final = 10.0
"""Steps or noises of a position that this way must have; from rest, 2.8 is the least ratio then."""
VISIBLE: Final = 2**16
"""Steps over the whole range beyond which only those of a position are worth a word."""
COARSE: Final = 100
SLOWLY: Final = ("position", "velocity", "force", "load")
"""Signals that may be logged more slowly than others; a command or a table may be so by itself."""
LEVELS: Final = 8
"""Values at least of a signal that was logged more slowly; fewer may have been commanded."""


def arrays(record: Measurement) -> Iterator[tuple[str, Array]]:
    """Yield what was sampled, by name."""
    for name in SAMPLED:
        if isinstance(getattr(record, name), np.ndarray):
            yield name, np.asarray(record.values(name))


def constant(record: Measurement) -> Iterator[Finding]:
    """Name signals that never change, where that means that nothing was recorded."""
    for name, values in arrays(record):
        if np.ptp(values) > 0.0 or name in {"load", "reference", "pull"}:
            continue
        value = quantity(float(values[0]), record.unit(name))
        text, severity = _never(name, float(values[0]))
        single = name == "velocity" and severity == "warning"
        yield Finding(
            kind="constant",
            severity=severity,
            sentence=f"{NAMES[name].capitalize()} is constant{text.format(value)}",
            measure=OTHER_SPEEDS if single else "",
            numbers={name: float(values[0])},
        )


def _never(name: str, value: float) -> tuple[str, Severity]:
    """Return what it means that a signal never changes."""
    if name == "position" or (name == "velocity" and value == 0.0):
        return ": no motion was recorded.", "error"
    if name == "velocity":
        return " ({}): a single speed gives one point of the friction law.", "warning"
    if name == "force":  # a body that slows down by itself is a good experiment
        return " ({}): friction follows from the motion alone.", "info"
    return " ({}): it was not recorded, or can be replaced by a single number.", "warning"


def unusable(record: Measurement) -> Iterator[Finding]:
    """Name signals whose squares no computer can add, and times that give no speeds."""
    if record.time is not None:
        late, least = float(np.abs(record.time).max()), float(np.diff(record.time).min())
        if late > HUGE or least < 1 / HUGE:
            yield Finding(
                kind="units",
                severity="error",
                sentence=(
                    f"Times reach {quantity(late, 's')} in steps of {quantity(least, 's')} or"
                    " more: such values exceed the numerical range."
                ),
                numbers={"time": late, "step": least},
            )
    for name, values in arrays(record):
        largest = float(np.abs(values).max())
        if largest > HUGE:
            text = f"reaches {quantity(largest, record.unit(name))}: such values exceed"
            yield Finding(
                kind="units",
                severity="error",
                sentence=f"{NAMES[name].capitalize()} {text} the numerical range.",
                numbers={name: largest},
            )


def unmoved(record: Measurement) -> Iterator[Finding]:
    """Say that a position does no more than its noise."""
    if record.position is None:
        return
    values = np.asarray(record.values("position"))
    noise, spread = noise_of(values, step_of(values)), float(np.std(values))
    two = np.unique(values).size == 2
    if values.size < 20 or not (two or 0.0 < spread < 2 * noise):
        return
    span = float(np.ptp(values))
    said = quantity(span, record.unit("position"))
    yield Finding(
        kind="constant",
        severity="error",
        sentence=(
            f"Position takes two values only, {said} apart: no motion was recorded."
            if two
            else f"Position stays within {said}, its noise level: no motion was recorded."
        ),
        numbers={"span": span, "noise": noise},
    )


def jumps(record: Measurement) -> Iterator[Finding]:
    """Find steps of position in a single sample that no neighbouring speed allows."""
    time = record.time
    if time is None or record.position is None or time.size < FEWEST_SAMPLES:
        return
    position = np.asarray(record.values("position"))
    repeats = _repeats(position)
    if repeats > 1:  # of values that are held, from one to the next
        first = np.flatnonzero(np.diff(position, prepend=np.nan) != 0)
        rows = np.union1d(first, np.maximum(first[1:] - repeats, 0))
        time, position = time[rows], position[rows]
    if time.size < FEWEST_SAMPLES:
        return
    dt = np.diff(time)
    speed = np.diff(position) / dt
    size = np.pad(np.abs(speed), 2, mode="edge")
    # Of two speeds on either side the second largest: a single bad sample makes two steps.
    beside = np.stack([size[:-4], size[1:-3], size[3:-1], size[4:]])
    allowed = np.partition(beside, 2, axis=0)[2]
    change = np.diff(speed)
    # 1.4826 median absolute deviations are a standard deviation of normal noise.
    spread = 1.4826 * float(np.median(np.abs(change - np.median(change))))
    # Noise of the speeds, and two counts of the sensor within a sample, are no jump.
    doubt = 10 * spread + 2 * max(step_of(position), _count_size(position)) / dt
    at = np.flatnonzero(np.abs(speed) > 5 * allowed + doubt)
    at = at[np.diff(at, prepend=-9) > 1]  # up and down again is one
    worst = at[np.argsort(-np.abs(speed[at] * dt[at]), kind="stable")][:SHOWN]
    for i in np.sort(worst):
        step, usual = float(speed[i] * dt[i]), float(allowed[i] * dt[i])
        yield Finding(
            kind="jump",
            severity="warning",
            sentence=(
                f"Position jumps by {quantity(step, record.unit('position'))} within one sample"
                f" after {quantity(float(time[i]), 's', 6)}; between neighbouring samples it"
                f" changes by at most {quantity(usual, record.unit('position'))}."
            ),
            numbers={"time": float(time[i]), "step": step, "neighbours": usual},
        )
    if at.size > SHOWN:
        yield Finding(
            kind="jump",
            severity="warning",
            sentence=f"{number(at.size, 7)} such jumps of position in total; the largest are"
            " listed.",
            numbers={"jumps": at.size},
        )


def _count_size(position: Array) -> float:
    """Return the count of an encoder that was interpolated to other times, or 0.

    Between counts it goes in a straight line within a sample, but where it stays it stays at one.
    """
    held = position[1:][np.diff(position) == 0.0]
    return step_of(held) if np.unique(held).size >= FEWEST_SAMPLES else 0.0


def _runs(values: Array) -> tuple[Array, Array]:
    """Return the levels a signal holds one after the other, and for how many samples each."""
    # NaN differs from all: the first value begins a run.
    first = np.flatnonzero(np.diff(values, prepend=np.nan) != 0)
    return values[first], np.diff(np.append(first, values.size))


def _repeats(values: Array) -> int:
    """Return how often each value is repeated, where nearly all are just as often; else 1."""
    _, lengths = _runs(values)
    usual = int(np.median(lengths))
    # A constant, or a few levels of a command, are held on purpose.
    often = len(lengths) >= LEVELS and np.mean(lengths == usual) >= MOSTLY
    return usual if usual >= FEWEST and often else 1


def _ends(values: Array) -> Iterator[tuple[str, int, float]]:
    """Yield both ends of a signal: in words, 1 for the largest value and -1, and the value."""
    yield "largest", 1, float(values.max())
    yield "smallest", -1, float(values.min())


def saturated(record: Measurement) -> Iterator[Finding]:
    """Name forces that sit at their extreme for many samples in a row."""
    for name, values in arrays(record):
        span = float(np.ptp(values))
        if name not in LIMITED or span == 0.0 or not bool(np.any(np.diff(values) == 0)):
            continue
        levels, lengths = _runs(values)
        for way, end, extreme in _ends(values):
            there = levels == extreme
            # Levels within a tenth of the range tell how long a rounded peak stays.
            near = (np.abs(levels - extreme) < 0.1 * span) & ~there
            longest = int(lengths[there].max())
            beside = int(lengths[near].max()) if near.any() else 1
            if longest < max(LONGEST_RUN, LONGER * beside):
                continue
            share = float(np.sum(lengths[there])) / values.size
            yield Finding(
                kind="saturation",
                severity="warning",
                sentence=(
                    f"{NAMES[name].capitalize()} stays at its {way} value,"
                    f" {quantity(extreme, record.unit('force'))}, for up to {number(longest, 7)}"
                    f" consecutive samples, {percent(share)} of the record: the amplifier or"
                    " sensor saturates, unless the drive was constant there."
                ),
                measure="Record within the range of amplifier and sensor",
                numbers={"level": extreme, "end": end, "longest": longest, "share": share},
            )


def cut_off(record: Measurement) -> Iterator[Finding]:
    """Name positions that stay at their extreme, and come there and leave at full speed.

    What has mass slows down before it rests, and speeds up from rest: where both are missing, the
    sensor's range ended and the motion went on.
    """
    if record.time is None or record.position is None:
        return
    values = np.asarray(record.values("position"))
    step = step_of(values)
    clear = CLEAR * max(step, noise_of(values, step))
    levels, lengths = _runs(values)
    ends = np.cumsum(lengths)
    for way, end, extreme in _ends(values):
        short = np.abs(values - extreme)
        found = [
            int(lengths[k])
            for k in np.flatnonzero((levels == extreme) & (lengths >= FLAT * SIDE))
            if _straight(short[ends[k] - 1 :], clear, int(lengths[k]))
            and _straight(short[: ends[k] - lengths[k] + 1][::-1], clear, int(lengths[k]))
        ]
        if found:
            yield Finding(
                kind="saturation",
                severity="warning",
                sentence=(
                    f"Position stays at its {way} value,"
                    f" {quantity(extreme, record.unit('position'))}, for up to"
                    f" {number(max(found), 7)} consecutive samples, and reaches and leaves it"
                    " without slowing down: the sensor is at the end of its range, unless the"
                    " motion was driven in this way."
                ),
                measure="Record within the range of the sensor",
                numbers={
                    "level": extreme,
                    "end": end,
                    "longest": max(found),
                    "times": len(found),
                },
            )


def _straight(short: Array, clear: float, length: int) -> bool:
    """Whether a position goes from a flat of some length, at [0], at a speed it has at once."""
    far = np.flatnonzero(short[: length // FLAT + 1] >= clear)
    if not far.size:
        return False
    n = max(SIDE, int(far[0]))
    if 2 * n >= short.size:
        return False
    return (
        bool(SINGLE_STEP[0] <= short[2 * n] / short[n] <= SINGLE_STEP[1])
        if short[n] > 0.0
        else False
    )


def held(record: Measurement) -> Iterator[Finding]:
    """Name forces and positions that were logged more slowly than the rest, each value repeated."""
    if record.time is None:
        return
    for name, values in arrays(record):
        usual = _repeats(values)
        if name not in SLOWLY or usual == 1:
            continue
        # A value held for n samples is (n - 1) / 2 samples late on average.
        late = 0.5 * (usual - 1) * float(np.median(np.diff(record.time)))
        yield Finding(
            kind="held samples",
            severity="warning",
            sentence=(
                f"{NAMES[name].capitalize()} changes only every {number(usual, 7)} samples: it was"
                f" logged at a lower rate, and lags by {quantity(late, 's')} on average. Leave out"
                " the rows between."
            ),
            numbers={"samples": usual, "delay": late},
        )


def _own_step(values: Array) -> float:
    """Return the step in which values came before they were interpolated to other times, if so.

    Between two counts an interpolation has fractions of them, which of times on two grids are whole
    numbers of a much finer step. Where a sample is repeated, both sides had the same count.
    """
    step = step_of(values)
    repeated = np.unique(values[1:][np.diff(values) == 0.0])
    if step == 0.0 or repeated.size < FEWEST_SAMPLES:
        return step
    return max(step, step_of(repeated))


def quantised(record: Measurement) -> Iterator[Finding]:
    """Name the steps in which signals come, such as that of an encoder."""
    for name, values in arrays(record):
        step = _own_step(values)
        if step == 0.0 or name == "reference":
            continue
        levels = float(np.ptp(values)) / step
        if levels > VISIBLE and name != "position":
            continue
        coarse = levels < COARSE and name == "position"
        text = f"{NAMES[name].capitalize()} is quantised in steps of"
        text += f" {quantity(step, record.unit(name))}, {number(levels)} over its range"
        yield Finding(
            kind="quantisation",
            severity="warning" if coarse else "info",
            sentence=text + (": velocities derived from it are coarse." if coarse else "."),
            measure="Record larger motions, or with a finer resolution" if coarse else "",
            numbers={"step": step, "levels": levels},
        )


def plausible(record: Measurement) -> Iterator[Finding]:
    """Ask for the unit of numbers that no rig has."""
    for name, values in arrays(record):
        unit = record.unit(name)
        largest, span = float(np.abs(values).max()), float(np.ptp(values))
        if unit in SPANNED:
            largest = span
        slid = name == "position" and record.friction is not None  # hundreds of metres, on a disc
        if largest > LARGEST_VALUES[unit] and not slid:
            words = WORDS.get(unit, unit)
            what = "spans" if unit in SPANNED else "reaches"
            yield _doubted(
                name,
                f"{what} {quantity(largest, unit)}: check that the values are in {words}.",
                largest,
            )
        elif name == "position" and not record.turning and 0.0 < span < SIX_DIGITS:
            yield _doubted(
                name,
                f"spans {quantity(span, 'm')}: check that the values are in metres.",
                span,
            )


def has_speed(record: Measurement) -> bool:
    """Whether positions along a line say how fast a record is; about an axis any speed may be."""
    return record.position is not None and record.velocity is None and not record.turning


def too_fast(record: Measurement, motion: Motion | None) -> Iterator[Finding]:
    """Ask for the units of a speed that no rig has, and refuse those that no mechanism has."""
    if motion is None or not has_speed(record) or motion.fastest <= LARGEST_VALUES["m/s"]:
        return
    speed = quantity(motion.fastest, "m/s")
    text = f"changes at {speed}: check that the values are in metres and seconds."
    if certain := motion.fastest > IMPOSSIBLE_SPEED:
        text = (
            f"changes at {speed}, faster than any mechanism: give its unit, as --unit position=mm,"
            " or that of the times, as --unit time=ms."
        )
    elif float(np.ptp(record.values("position"))) > LARGEST_VALUES["m"]:
        return  # which was said
    found = _doubted("position", text, motion.fastest)
    yield replace(found, severity="error") if certain else found


def lifted(record: Measurement) -> Iterator[Finding]:
    """Say where a load presses nothing."""
    if not isinstance(record.load, np.ndarray):
        return
    values = np.asarray(record.values("load"))
    share = float(np.mean(values <= 0.0))
    if share:
        yield Finding(
            kind="load",
            severity="warning",
            sentence=(
                f"Load is zero or negative on {percent(share)} of the samples (smallest"
                f" {quantity(float(values.min()), 'N')}): the contact is open there; leave these"
                " samples out."
            ),
            numbers={"share": share, "smallest": float(values.min())},
        )


def _doubted(name: str, text: str, value: float) -> Finding:
    return Finding(
        kind="units",
        severity="warning",
        sentence=f"{NAMES[name].capitalize()} {text}",
        numbers={name: value},
    )
