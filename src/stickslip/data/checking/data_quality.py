"""What a measurement can tell and what is wrong with it, before anything is fitted.

`check` gathers the remarks of all families. What no fit is made from is refused in the same words
by every verb.
"""

import html
import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from stickslip.data import measurement
from stickslip.data.checking import motion
from stickslip.data.checking.finding import (
    OTHER_SPEEDS,
    OTHER_WAY,
    SEVERITIES,
    TURN,
    Finding,
    Severity,
    grouped,
    remark,
    sentences_of,
)
from stickslip.data.checking.motion import Motion
from stickslip.data.differentiation import (
    QUARTILE,
    REPLACED,
    as_readings,
    interval_of,
    noise_of,
    outlier_sentence,
    step_of,
    without_outliers,
)
from stickslip.data.measurement import (
    QUANTITIES,
    SAMPLED,
    Array,
    Measurement,
    as_turning,
    quantity_called,
)
from stickslip.data.rig import check_record
from stickslip.data.tolerances import (
    DECADE,
    FEWEST,
    FEWEST_SAMPLES,
    GAP,
    HALF,
    LISTED,
    MOSTLY,
    NEARLY_ALL,
    NEGLIGIBLE,
    PER_MILLE,
    ROUNDED,
    SIX_DIGITS,
    SMALL,
)
from stickslip.data.travels import is_filmed, other_drives
from stickslip.data.units import LARGEST_NUMBER
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.mechanisms import (
    PREFIX,
    BoundedMechanism,
    Mechanism,
    cycle_or_none,
    load_stated,
    slip_names,
)
from stickslip.quantities import vary
from stickslip.show.display import Tabular
from stickslip.show.formatting import (
    count,
    joined,
    lower_first,
    number,
    percent,
    quantities,
    quantity,
    unbroken,
)

if TYPE_CHECKING:
    import pandas as pd


# What readings cover: speeds and loads, how often, in what order, and whether levels stay.
#
# A friction map tells a law only where it has readings, more than one of each, and in an order that
# is none of the setting: a drift then reads as an effect of it. In a record, a level that does not
# stay leaves fewer independent values than there are samples.

# Friction maps and single numbers: what they cover, how often, how surely.

FEW_SPEEDS: Final = 5
"""Speeds, or slowest readings of a direction, that show how friction goes with speed."""
CHANCE: Final = 0.005
"""Probability of a mean as low by noise alone, below which a sign is told."""
ACTING_SIGNALS: Final = ("force", "reference", "friction", "load", "spring_force", "pull")
"""What acts on a body: where it is not given, a fit takes it that nothing does."""


def coverage(record: measurement.Measurement) -> Iterator[Finding]:
    """Say which velocities a friction map has."""
    velocity = np.asarray(record.values("velocity"))
    friction = np.asarray(record.values("friction"))
    speed = np.abs(velocity)
    distinct = _distinct(velocity)
    moving = velocity != 0
    numbers = {
        "points": velocity.size,
        "velocities": distinct,
        "slowest": float(speed.min()),
        "fastest": float(speed.max()),
        "forward_share": float(np.mean(velocity > 0)),
    }
    if not moving.any():
        text = "All velocities are 0: no motion was recorded."
        yield remark("coverage", "error", text, **numbers)
        return
    if not friction.any():
        text = "All values of friction are 0: it was not recorded."
        yield remark("coverage", "error", text, **numbers)
        return
    low, high = quantities([float(velocity.min()), float(velocity.max())], record.unit("velocity"))
    few = distinct < FEWEST
    text = f"{count(velocity.size, 'point')} at {count(distinct, 'velocity', 'velocities')}"
    text += f" from {low} to {high}"
    text += f": a friction curve needs at least {FEWEST} velocities." if few else "."
    yield remark("coverage", distinct < FEW_SPEEDS, text, OTHER_SPEEDS, **numbers)
    if velocity.min() >= 0 or velocity.max() <= 0:
        way = "forward" if velocity.max() > 0 else "backward"
        text = f"All velocities are {way}: friction level and offset cannot be separated."
        yield remark("coverage", "warning", text, OTHER_WAY, **numbers)
    if distinct == velocity.size:
        text = "No velocity is repeated: scatter cannot be separated from the shape of the curve."
        yield remark("coverage", "info", text, **numbers)
    along = (np.sign(velocity) * friction)[moving]
    against, rest = float(np.mean(along < 0)), len(along) - 1.0
    # noise alone has either sign: on eleven points four times in a hundred on nine of them
    if against > 0.8 and np.mean(along) * rest**0.5 < stdtrit(rest, CHANCE) * np.std(along):
        text = f"Friction is opposite in sign to the velocity on {percent(against)} of the points."
        text += f" Sign convention: friction has the sign of the slip velocity; {TURN}."
        yield remark("friction sign", "error", text, opposite_share=against)


def resting_readings(velocity: measurement.Array, friction: measurement.Array) -> NDArray[np.bool_]:
    """Return which readings (n,) are of a body at rest, at which friction may have any value.

    Their speeds are not resolved from zero: far below those of all others, which show a level to
    which their friction, over the load if that changes, does not reach. Where friction fades
    towards the slowest speeds, as that of a smooth law does, slower readings slide.

    Examples
    --------
    >>> speeds = np.array([-0.2, -0.1, 1e-4, 0.1, 0.2, 0.3, -0.3])
    >>> resting_readings(speeds, np.array([-2.2, -2.1, 0.4, 2.1, 2.2, 2.3, -2.3])).tolist()
    [False, False, True, False, False, False, False]
    >>> bool(resting_readings(speeds, np.array([-2.2, -2.1, 2.1, 2.1, 2.2, 2.3, -2.3])).any())
    False
    """
    speed = np.abs(velocity)
    ordered = np.sort(speed)
    result: NDArray[np.bool_] = velocity == 0.0
    # Few readings below a gap of a decade are at rest; more of them are a range of speeds.
    gaps = np.flatnonzero(ordered[1:] > DECADE * ordered[:-1])
    few = gaps[gaps < max(SMALL * speed.size, 1.0)]
    if not few.size:
        return result
    slow = speed <= ordered[few[-1]]
    levels = [_level(side * velocity[~slow], side * friction[~slow]) for side in (-1.0, 1.0)]
    # Without a level in a direction nothing tells rest from a law that fades.
    if any(level == 0.0 for level in levels):
        return result
    below, above = levels
    inside = (friction > -MOSTLY * below) & (friction < MOSTLY * above)
    return np.asarray(result | (slow & inside))


def _level(velocity: measurement.Array, friction: measurement.Array) -> float:
    """Return friction at the slowest forward speeds; 0 if it has no level, infinite of none."""
    forward = np.flatnonzero(velocity > 0.0)
    if not forward.size:
        return np.inf
    slowest = forward[np.argsort(velocity[forward], kind="stable")][:FEW_SPEEDS]
    level = float(np.median(friction[slowest]))
    return level if float(friction[slowest[0]]) >= NEARLY_ALL * level > 0.0 else 0.0


def resting(record: measurement.Measurement) -> Iterator[Finding]:
    """Say which readings of a friction map are those of a body at rest."""
    velocity = np.asarray(record.values("velocity"))
    friction = np.asarray(record.values("friction"))
    if isinstance(record.load, np.ndarray) and np.all(record.values("load")):
        friction = friction / np.asarray(record.values("load"))
    at_rest = resting_readings(velocity, friction)
    if not at_rest.any() or at_rest.all():
        return
    fastest, slowest = quantities(
        [float(np.abs(velocity[at_rest]).max()), float(np.abs(velocity[~at_rest]).min())],
        record.unit("velocity"),
    )
    resting = int(at_rest.sum())
    verb = "are" if resting > 1 else "is"
    slow = bool(velocity[at_rest].any())
    at = f"speeds of at most {fastest}" if slow else "a speed of 0"
    text = (
        f"{count(resting, 'reading')} at {at} {verb} taken for a body at rest, where friction"
        " has any value up to its level, and left out of sliding: all others are at"
        f" {slowest} or faster."
    )
    yield remark(
        "rest",
        slow,
        text,
        "Measure at speeds below the slowest, for long enough to slide",
        readings=float(resting),
    )


LARGEST_COEFFICIENT: Final = 2.0
"""Coefficients of friction hardly exceed this."""
LEAST_LOAD: Final = 10.0
"""Load [N] above which forces and coefficients are of different sizes."""


def coefficient(record: measurement.Measurement, mechanism: Mechanism | None) -> Iterator[Finding]:
    """Doubt friction that is a small share of its load and of the size of a coefficient."""
    if record.friction is None:
        return
    if record.load is None:
        load = load_stated(mechanism, record.overrides)
    else:
        load = float(np.median(np.atleast_1d(record.values("load"))))
    largest = float(np.abs(np.atleast_1d(record.values("friction"))).max())
    if (
        load is None
        or load <= LEAST_LOAD
        or not 0.0 < largest < min(LARGEST_COEFFICIENT, SMALL * load)
    ):
        return
    most, pressed = quantity(largest, record.unit("friction")), quantity(load, "N")
    text = (
        f"Friction reaches {most} at a load of {pressed}, {percent(largest / load)} of it. If"
        " the values are friction coefficients, state their unit as 1: they are then"
        " multiplied by the load."
    )
    yield remark("units", "warning", text, friction=largest, load=load)


def lost(records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    """Yield what the files say that they hold and do not, once for all trials of a file."""
    for sentence in dict.fromkeys(line for record in records for line in record.lost):
        yield remark("lost", "warning", sentence, "Save or export the record again, complete")


def volts(records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    """Say of which forces volts were recorded."""
    for name in dict.fromkeys(name for record in records for name in record.volts):
        yield remark("volts", "info", volts_sentence(name))


def volts_sentence(name: str) -> str:
    """Return what a force that was recorded in volts is only of some amplifiers."""
    force = name.replace(".", " of ", 1)
    return (
        f"The {force} is made of volts. If they are those at a motor, what its speed induces counts"
        " as viscous friction: give the motor as the drive of the mechanism, and the column as"
        " voltage. A sensor, or an amplifier that sets the current, has none."
    )


def unused(records: Sequence[measurement.Measurement], used: Collection[str]) -> Iterator[Finding]:
    """Name columns that nothing was read from, those first that differ between trials.

    Names of conditions that are used are given.
    """
    names = dict.fromkeys(name for record in records for name in record.unused)
    apart: list[str] = []
    rest: list[str] = []
    for name in names:
        values = [record.unused.get(name) for record in records]
        known = {value for value in values if value is not None}
        (apart if len(known) > 1 and None not in values else rest).append(name)
    inputs = [name for name in records[0].inputs if all(name in trial.inputs for trial in records)]
    for name in (name for name in apart if name not in inputs):
        text = (
            f"Column {name!r} is not used but differs between the trials: what friction changes"
            " with it is part of the difference between runs."
        )
        yield remark("unused column", "warning", text)
    rest = [name for name in rest if name not in inputs]
    if inputs:
        text = (
            f"Measured beside: {', '.join(inputs)}; laws may depend on it, such as"
            f" level + viscous * exponential[{inputs[0]}]."
        )
        yield remark("contact input", "info", text)
    if rest:
        listed = joined([*map(repr, rest)], LISTED)
        verb = "Column {} is" if len(rest) == 1 else "Columns {} are"
        yield remark("unused column", "info", f"{verb.format(listed)} not used.")
    conditions = dict.fromkeys(
        name
        for record in records
        for name in record.conditions
        if measurement.condition_name(name) not in used
    )
    if conditions and records[0].travelled:
        text = (
            f"Conditions ({', '.join(conditions)}) are not used: a trial with a single value"
            " cannot be fitted separately. Where a condition is a parameter of the mechanism,"
            " give it as such, e.g. mechanism.load."
        )
        yield remark("conditions", "warning", text)


def _distinct(values: measurement.Array) -> int:
    ordered = np.sort(values)
    largest = float(np.abs(ordered).max())
    return 1 + int(np.count_nonzero(np.diff(ordered) > SIX_DIGITS * largest))


def settings(
    records: Sequence[measurement.Measurement], used: Collection[str]
) -> Iterator[Finding]:
    """Say how many settings single numbers come from, and whether their doubt is known.

    Names of conditions that are used are given: they are settings too.
    """

    def setting(record: measurement.Measurement) -> tuple[tuple[str, object], ...]:
        own = {k: v for k, v in record.conditions.items() if measurement.condition_name(k) in used}
        return tuple(sorted({**record.overrides, **record.initial, **own}.items()))

    kinds = {setting(record) for record in records}
    apart = {(name, *setting(record)) for record in records for name in record.quantities()}
    readings = sum(
        int(np.size(getattr(record, name))) for record in records for name in record.quantities()
    )
    repeats = readings - len(apart)
    text = f"{count(readings, 'reading')} at {count(len(kinds), 'setting')}"
    text += f", {count(repeats, 'repeat')}." if repeats else ", no repeats."
    # What other readings determine is for their kind to say.
    few = len(kinds) == 1 and bool(records[0].travelled)
    if few:
        text += " One setting determines one parameter and cannot rank models."
    yield remark(
        "settings",
        few,
        text,
        "Measure at further settings",
        readings=readings,
        settings=len(kinds),
        repeats=repeats,
    )
    bare = sum(not record.uncertainty for record in records)
    if bare:
        none = bare == len(records)
        which = "No reading has an" if none else f"{bare} of {len(records)} readings have no"
        text = f"{which} uncertainty: give one, such as half of the last digit."
        yield remark("uncertainty", "warning", text, without=bare)
    for name in sorted({name for record in records for name in record.quantities()}):
        yield from _negative(name, records)


def stated(record: measurement.Measurement) -> Iterator[Finding]:
    """Say which uncertainties of friction are stated in a table, and what is doubtful of them.

    Examples
    --------
    >>> rows = {"velocity": [0.1, 0.2, 0.4], "friction": [2.0, 3.0, 4.0]}
    >>> table = measurement.Measurement(**rows, uncertainty={"friction": [0.1, 0.2, 0.0]})
    >>> for finding in stated(table):
    ...     print(finding)
    The uncertainty of friction is stated: 0.1 N in the median, from 0 N to 0.2 N; it is 0 ...
    """
    if "friction" not in record.uncertainty:
        return
    size, unit = np.abs(np.atleast_1d(record.values("friction"))), record.unit("friction")
    doubt = np.broadcast_to(record.uncertainty["friction"], size.shape)
    low, middle, high = (float(f(doubt)) for f in (np.min, np.median, np.max))
    least, usual, most = quantities([low, middle, high], unit)
    text = f"{usual} in the median, from {least} to {most}" if low < high else usual
    rows = {"0": int(np.sum(doubt == 0.0)), "above the reading": int(np.sum(doubt > size))}
    wrong = [f"{what} in {n} of {size.size} rows" for what, n in rows.items() if n]
    cure = f"; it is {' and '.join(wrong)}: correct or leave out the column" if wrong else ""
    yield remark(
        "uncertainty",
        bool(wrong),
        f"The uncertainty of friction is stated: {text}{cure}.",
        low=low,
        median=middle,
        high=high,
    )


def alike(records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    """Say which trials in time lack what acts on the others."""
    if any(record.time is None for record in records):
        return
    for name in ACTING_SIGNALS:
        bare = [i for i, record in enumerate(records) if name not in record.quantities()]
        if not bare or len(bare) == len(records):
            continue
        has = next(i for i in range(len(records)) if i not in bare)
        labels = [records[i].name or f"trial {i + 1}" for i in (has, bare[0])]
        word = name.replace("_", " ")
        cure = f"give {word} for each trial"
        cure += ", 0 where no force acted" if name == "force" else ""
        text = (
            f"{word.capitalize()} was measured in {labels[0]!r} but not in {labels[1]!r}:"
            f" {cure}, or fit the trials separately."
        )
        yield remark("trials", "error", text, without=len(bare))


def same(record: measurement.Measurement, other: measurement.Measurement) -> bool:
    """Whether what both records have is the same, sample by sample.

    Examples
    --------
    >>> from stickslip import Measurement
    >>> run = {"time": [0.0, 1.0], "position": [0.0, 0.1]}
    >>> same(Measurement(**run), Measurement(**run, force=[1.0, 2.0]))
    True
    """
    if record.joints and other.joints:
        both = record.joints.keys() & other.joints.keys()
        return bool(both) and all(same(record.joints[name], other.joints[name]) for name in both)
    pairs = [
        (getattr(record, name), getattr(other, name))
        for name in ("time", *measurement.QUANTITIES)
        if getattr(record, name) is not None and getattr(other, name) is not None
    ]
    if sum(np.ndim(mine) > 0 for mine, _ in pairs) < 2:
        return False  # times, and single numbers, may well be alike
    return all(np.array_equal(mine, yours) for mine, yours in pairs)


def repeated(records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    """Name trials that hold the samples of an earlier one."""
    for i, record in enumerate(records):
        first = next((k for k in range(i) if same(records[k], record)), None)
        if first is None:
            continue
        own, other = (records[k].name or f"trial {k + 1}" for k in (i, first))
        text = (
            f"{own!r} has the samples of {other!r}: counted twice, they make intervals too"
            " narrow. Leave one of them out."
        )
        yield remark("repeated trial", "warning", text)


def _negative(name: str, records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    if measurement.QUANTITIES[name].unit != "m" and name not in measurement.TRAVELS:
        return
    noun = name.replace("_", " ")
    values = np.concatenate(
        [np.atleast_1d(r.values(name)) for r in records if getattr(r, name) is not None]
    )
    if measurement.QUANTITIES[name].unit == "m" and float(np.abs(values).max()) > 100.0:
        largest = float(np.abs(values).max())
        text = (
            f"{noun.capitalize()} reaches {quantity(largest, 'm')}: check that the values"
            " are in metres."
        )
        yield remark("units", "warning", text, **{name: largest})
    elif name in measurement.TRAVELS and not values.any():
        yield remark("constant", "error", f"Every {noun} is 0: no motion was recorded.")


# Whether settings were taken in their order: then a drift reads as an effect of the setting.


def monotone(settings: measurement.Array) -> str:
    """Return how settings go from one to the next: "increases", "decreases" or neither, empty.

    A setting may be repeated before the next one is taken. Of many, some may have changed places
    with the next: they increase "mostly". One that comes again later ends the order, and shows a
    drift by itself.

    Examples
    --------
    >>> monotone(np.array([0.1, 0.1, 0.2, 0.4])), monotone(np.array([0.1, 0.2, 0.4, 0.1]))
    ('increases', '')
    >>> monotone(np.array([10, 9, 8, 7, 5, 6, 4, 3, 2, 1]))
    'mostly decreases'
    """
    if np.unique(settings).size < FEWEST:
        return ""
    for how, rising in (("increases", settings), ("decreases", -settings)):
        # How far each setting is from its place in sorted order.
        off = np.max(np.abs(np.argsort(rising, kind="stable") - np.arange(rising.size)))
        if off <= SMALL * rising.size:
            return f"mostly {how}" if off else how
    return ""


def settings_in_order(records: Sequence[measurement.Measurement]) -> dict[str, str]:
    """Return how each parameter goes that was set anew from trial to trial, if all are in order.

    Examples
    --------
    >>> from stickslip import Measurement
    >>> def read(compression):
    ...     return Measurement(travel=0.2, overrides={"mechanism.compression": compression})
    >>> settings_in_order([read(0.05), read(0.10), read(0.15)])
    {'mechanism.compression': 'increases'}
    >>> settings_in_order([read(0.05), read(0.10), read(0.15), read(0.05)])
    {}
    """
    paths = dict.fromkeys(
        path for record in records for path in (*record.overrides, *record.initial)
    )
    result = {}
    for path in paths:
        values = [{**record.overrides, **record.initial}.get(path) for record in records]
        if any(not isinstance(value, (int, float)) for value in values):
            return {}
        numbers = np.array(values, dtype=float)
        if np.ptp(numbers) > 0.0:
            result[path] = monotone(numbers)
    return result if all(result.values()) else {}


def order_of_settings(records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    """Say of readings that what was set is in order; of a table, the judge says it."""
    for path, how in [*settings_in_order(records).items()][:1]:
        what = path.rpartition(".")[2].replace("_", " ")
        text = (
            f"The {what} {how} from trial to trial; if it was set in this order, a slow"
            f" drift reads as an effect of the {what}."
        )
        yield remark(
            "order", "info", text, f"Measure in random order, or repeat the first {what} at the end"
        )


def with_order(lines: Sequence[str], findings: Sequence[Finding], most: int) -> tuple[str, ...]:
    """Return what to measure, so many lines at most: at last in another order, if one was found.

    Examples
    --------
    >>> order = Finding(kind="order", sentence="It rises.", measure="Measure in random order")
    >>> with_order(["Measure at 1 m/s.", "Warm it up."], [order], 2)
    ('Measure at 1 m/s.', 'Measure in random order: it rises.')
    """
    result = [
        f"{finding.measure}: {lower_first(finding.sentence)}"
        for finding in findings
        if finding.kind == "order"
    ][:1]
    return (*lines[: most - len(result)], *result)


# What a measurement can tell and what is wrong with it, before anything is fitted.

# Single signals: their times, constant, saturated or jumping values, doubtful units, mains hum.

# Narrow lines at the frequency of the mains and its harmonics.

MAINS: Final = (50.0, 60.0)
"""Frequencies of mains [Hz]."""
ORDERS: Final = range(1, 6)
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
LOBE: Final = 3
"""Bins to each side over which the window spreads a line."""
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
    result = []
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
            result.append(tuple(lines))
    return max(result, key=lambda lines: sum(line.share for line in lines), default=())


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
    from scipy.signal import welch

    length = min(len(values), max(round(BLOCK / step), FEWEST_SAMPLES))
    # Without mean and trend, whose leaking would hide lines; the window keeps strong ones in place.
    power = welch(values, 1.0 / step, np.hanning(length), detrend="linear")[1]
    width = 1.0 / (length * step)
    return power * width, width  # whose sum is the variance (Parseval)


def _folded(frequency: float, rate: float) -> float:
    """Return where a frequency is seen that is sampled at a rate."""
    folded = frequency % rate
    return min(folded, rate - folded)


def _is_harmonic(power: Array, place: int, width: float) -> bool:
    """Whether a line is a harmonic of a stronger one."""
    bases = (_standing(power, place * width / part, width) for part in ORDERS[1:])
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
    if not FEWEST_SAMPLES <= count <= DECADE * len(time):  # mostly gaps
        return
    even = time[0] + step * np.arange(count)
    for name, values in arrays(record):
        lines = lines_of(np.interp(even, time, values), step)
        if not lines:
            continue
        share = sum(line.share for line in lines)
        size = quantity(lines[0].amplitude, record.unit(name))
        text = (
            f"{name.replace('_', ' ').capitalize()} has a narrow spectral line at"
            f" {words_of(lines)}, with an amplitude of {size} and {percent(share)} of the"
            f" variance: mains hum. {CURE}."
        )
        yield remark(
            "mains hum",
            share >= PER_MILLE,
            text,
            frequency=lines[0].frequency,
            amplitude=lines[0].amplitude,
            share=share,
        )


UNEVEN: Final = 1.0 - MOSTLY
"""Scatter of steps over the usual one from which velocities are of the clock as well."""
MILLISECONDS = " If they are in milliseconds, give --unit time=ms."
SLOWEST, FASTEST = 5.0, 1e6
"""Sampling frequencies [Hz] of forces and motions between which nobody wonders."""


RELIABLE: Final = 50
"""Samples without which estimates are unreliable."""


def length(time: Array) -> Iterator[Finding]:
    """Say whether a record is too short for anything."""
    n = time.size
    if n >= RELIABLE:
        return
    sentence = "estimates from so few samples are unreliable."
    if n < FEWEST_SAMPLES:
        sentence = f"a fit needs at least {FEWEST_SAMPLES}."
    yield remark(
        "length",
        "error" if n < FEWEST_SAMPLES else "warning",
        f"The record has only {count(n, 'sample')}: {sentence}",
        "Record more samples",
        samples=n,
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
        least = "below 0.001 %" if worst < PER_MILLE * NEGLIGIBLE else percent(worst)
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
    yield remark(
        "sampling",
        typical > UNEVEN,
        text,
        "Record at even intervals",
        samples=time.size,
        rate=rate,
        duration=span,
        largest_deviation=worst,
        scatter=typical,
    )


def gaps(time: Array) -> Iterator[Finding]:
    """Say where samples are missing: steps over three times the usual one."""
    steps, dt = np.diff(time), interval_of(time)
    at = np.flatnonzero(steps > GAP * dt)
    if not at.size:
        return
    largest = at[np.argsort(steps[at], kind="stable")[::-1]][:LISTED]
    for i in np.sort(largest):
        missing = round(float(steps[i]) / dt) - 1
        text = (
            f"Gap of {quantity(float(steps[i]), 's')} after {quantity(float(time[i]), 's', 6)}"
            f" ({count(missing, 'sample')} missing)."
        )
        yield remark(
            "gap", "warning", text, time=float(time[i]), duration=float(steps[i]), samples=missing
        )
    if at.size > LISTED:
        total = float(np.sum(steps[at]))
        text = (
            f"{number(at.size, 6)} gaps longer than {number(GAP)} sampling intervals in total,"
            f" {percent(total / float(time[-1] - time[0]))} of the time; the longest are"
            " listed."
        )
        yield remark("gap", "warning", text, gaps=at.size, duration=total)


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
    text = (
        f"{'Force and motion' if driven else 'Positions'} were sampled every"
        f" {quantity(dt, 's')}, {quantity(1.0 / dt, 'Hz')}: check that times are in"
        f" seconds.{MILLISECONDS if 1.0 / dt < SLOWEST else ''}"
    )
    yield remark("units", "warning", text, interval=dt)


LIMITED: Final = ("force", "spring_force")
"""What an amplifier or a sensor may limit; a friction that stays the same may be just that."""
NAMES: Final = {name: name.replace("_", " ") for name in QUANTITIES}
LARGEST_VALUES: Final = {
    **{"m": 100.0, "m/s": 300.0, "N": 1e7, "rad": 1e5, "rad/s": 1e4, "N m": 1e7},
    **{"V": 1e4, "A": 1e4},
}
HUGE: Final = LARGEST_NUMBER**2
"""Sizes whose squares no computer can add."""
WORDS: Final = {"m": "metres", "N": "newtons", "rad": "radians", "V": "volts", "A": "amperes"}
SPANNED: Final = ("m", "rad")
IMPOSSIBLE_SPEED: Final = 1000.0
"""Speed [m/s] of a bullet: no body with friction that is measured moves faster."""
LONGEST_RUN: Final = 2 * FEWEST_SAMPLES
"""Samples that a signal must sit at its extreme to count as saturated."""
LONGER: Final = 8
"""... and how many times longer than at the levels beside it: a rounded peak is 5 times as long."""
SIDE: Final = 8
"""Samples beside a position's flat extreme at least that show whether it comes or leaves slowly."""
FLAT: Final = 6
"""... and at most a sixth of the flat: where a rounded peak is cut off, both sides are straight."""
SINGLE_STEP: Final = (1.5, 2.5)
"""Way in twice the time over that in the time itself: 2 at one speed, 4 from rest, 1 in a jump."""
VISIBLE: Final = 2**16
"""Steps over the whole range beyond which only those of a position are worth a word."""
COARSE: Final = 100
SLOWLY: Final = ("position", "velocity", "force", "load")
"""Signals that may be logged more slowly than others; a command or a table may be so by itself."""


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
        text = f"{NAMES[name].capitalize()} is constant{text.format(value)}"
        yield remark(
            "constant", severity, text, OTHER_SPEEDS if single else "", **{name: float(values[0])}
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
            text = (
                f"Times reach {quantity(late, 's')} in steps of {quantity(least, 's')} or"
                " more: such values exceed the numerical range."
            )
            yield remark("units", "error", text, time=late, step=least)
    for name, values in arrays(record):
        largest = float(np.abs(values).max())
        if largest > HUGE:
            reached = quantity(largest, record.unit(name))
            text = f"reaches {reached}: such values exceed the numerical range."
            yield _doubted(name, text, largest, "error")


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
    text = (
        f"Position takes two values only, {said} apart: no motion was recorded."
        if two
        else f"Position stays within {said}, its noise level: no motion was recorded."
    )
    yield remark("constant", "error", text, span=span, noise=noise)


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
    spread = float(np.median(np.abs(change - np.median(change)))) / QUARTILE
    # Noise of the speeds, and two counts of the sensor within a sample, are no jump.
    # Positions that were interpolated between counts go straight, but where they stay it is at one.
    held = position[1:][np.diff(position) == 0.0]
    count = step_of(held) if np.unique(held).size >= FEWEST_SAMPLES else 0.0
    doubt = 10 * spread + 2 * max(step_of(position), count) / dt
    at = np.flatnonzero(np.abs(speed) > 5 * allowed + doubt)
    at = at[np.diff(at, prepend=-9) > 1]  # up and down again is one
    at = at[~_are_counts(position, at)]
    worst = at[np.argsort(-np.abs(speed[at] * dt[at]), kind="stable")][:LISTED]
    for i in np.sort(worst):
        step, usual = float(speed[i] * dt[i]), float(allowed[i] * dt[i])
        text = (
            f"Position jumps by {quantity(step, record.unit('position'))} within one sample"
            f" after {quantity(float(time[i]), 's', 6)}; between neighbouring samples it"
            f" changes by at most {quantity(usual, record.unit('position'))}."
        )
        yield remark("jump", "warning", text, time=float(time[i]), step=step, neighbours=usual)
    if at.size > LISTED:
        text = f"{number(at.size, 7)} such jumps of position in total; the largest are listed."
        yield remark("jump", "warning", text, jumps=at.size)


def _are_counts(position: Array, at: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return which steps (k,) of positions are those of a coarse sensor, of whatever noise or grid.

    It stays at each count, its steps are alike, and between them it hardly moves.
    """
    moved = np.abs(np.diff(position))
    after = position[np.minimum(at + 2, moved.size)]
    stays = np.abs(after - position[at]) > HALF * moved[at]
    if np.count_nonzero(stays) < FEWEST_SAMPLES:
        return np.zeros(at.size, dtype=bool)
    count = float(np.median(moved[at[stays]]))
    between = float(np.median(np.abs(position[at[1:]] - after[:-1])))
    return stays & (moved[at] < 2.0 * count) & (between < ROUNDED * count)


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
    often = len(lengths) >= FEWEST_SAMPLES and np.mean(lengths == usual) >= MOSTLY
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
            text = (
                f"{NAMES[name].capitalize()} stays at its {way} value,"
                f" {quantity(extreme, record.unit('force'))}, for up to {number(longest, 7)}"
                f" consecutive samples, {percent(share)} of the record: the amplifier or"
                " sensor saturates, unless the drive was constant there."
            )
            numbers = {"level": extreme, "end": end, "longest": longest, "share": share}
            yield remark(
                "saturation",
                "warning",
                text,
                "Record within the range of amplifier and sensor",
                **numbers,
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
    # From rest, 2.8 is the least ratio of ways at ten steps or noises.
    clear = DECADE * max(step, noise_of(values, step))
    levels, lengths = _runs(values)
    ends = np.cumsum(lengths)
    for way, end, extreme in _ends(values):
        short = np.abs(values - extreme)
        result = [
            int(lengths[k])
            for k in np.flatnonzero((levels == extreme) & (lengths >= FLAT * SIDE))
            if _straight(short[ends[k] - 1 :], clear, int(lengths[k]))
            and _straight(short[: ends[k] - lengths[k] + 1][::-1], clear, int(lengths[k]))
        ]
        if result:
            text = (
                f"Position stays at its {way} value,"
                f" {quantity(extreme, record.unit('position'))}, for up to"
                f" {number(max(result), 7)} consecutive samples, and reaches and leaves it"
                " without slowing down: the sensor is at the end of its range, unless the"
                " motion was driven in this way."
            )
            yield remark(
                "saturation",
                "warning",
                text,
                "Record within the range of the sensor",
                level=extreme,
                end=end,
                longest=max(result),
                times=len(result),
            )


def _straight(short: Array, clear: float, length: int) -> bool:
    """Whether a position goes from a flat of some length, at [0], at a speed it has at once."""
    far = np.flatnonzero(short[: length // FLAT + 1] >= clear)
    if not far.size:
        return False
    n = max(SIDE, int(far[0]))
    if 2 * n >= short.size:
        return False
    return bool(SINGLE_STEP[0] * short[n] <= short[2 * n] <= SINGLE_STEP[1] * short[n] > 0.0)


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
        text = (
            f"{NAMES[name].capitalize()} changes only every {number(usual, 7)} samples: it was"
            f" logged at a lower rate, and lags by {quantity(late, 's')} on average. Leave out"
            " the rows between."
        )
        yield remark("held samples", "warning", text, samples=usual, delay=late)


def _own_step(values: Array) -> float:
    """Return the step in which values came before they were interpolated to other times, if so.

    Between two counts an interpolation has fractions of them, which of times on two grids are whole
    numbers of a much finer step. Where a sample is repeated, both sides had the same count.
    """
    step, moved = step_of(values), np.abs(np.diff(values))
    repeated = np.unique(values[1:][moved == 0.0])
    if step == 0.0 or repeated.size < FEWEST_SAMPLES:
        return step
    held = step_of(repeated)
    # of counts as long, each sample repeats the one before but for the way between them
    repeats = float(np.sum(np.maximum(1.0 - moved / max(held, step), 0.0)))
    return max(held, step) if 0.5 * repeats < np.sum(moved == 0.0) else step


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
        text += ": velocities derived from it are coarse." if coarse else "."
        yield remark(
            "quantisation",
            coarse,
            text,
            "Record larger motions, or with a finer resolution",
            step=step,
            levels=levels,
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
    yield _doubted("position", text, motion.fastest, "error" if certain else "warning")


def lifted(record: Measurement) -> Iterator[Finding]:
    """Say where a load presses nothing."""
    if not isinstance(record.load, np.ndarray):
        return
    values = np.asarray(record.values("load"))
    share = float(np.mean(values <= 0.0))
    if share:
        text = (
            f"Load is zero or negative on {percent(share)} of the samples (smallest"
            f" {quantity(float(values.min()), 'N')}): the contact is open there; leave these"
            " samples out."
        )
        yield remark("load", "warning", text, share=share, smallest=float(values.min()))


def _doubted(name: str, text: str, value: float, severity: Severity = "warning") -> Finding:
    return remark("units", severity, f"{NAMES[name].capitalize()} {text}", **{name: value})


# What a measurement can tell and what is wrong with it, before anything is fitted.

RESTING_BODY = "the body rested, which bounds its friction at rest."
"""What it means that a body does not move in one of several trials."""
RESTING_JOINT = "the joint rests, which says little of its friction."
"""What it means that a joint does not move."""
FORWARD = "forward_share"
"""Number of a finding about the directions of a motion."""
MASSES = ("inertia", "mass")
"""Last names of parameters to which the force of a motion is in proportion."""
MARKS = {"info": "", "warning": "Warning: ", "error": "Error: "}


@dataclass(frozen=True, kw_only=True)
class Checks(Tabular):
    """What was found about a measurement.

    Examples
    --------
    >>> from stickslip import Measurement, check
    >>> found = check(Measurement(travel=0.2, uncertainty=0.005))
    >>> found.worst, [finding.kind for finding in found.findings]
    ('warning', ['settings'])
    """

    findings: tuple[Finding, ...]
    """In the order in which they are read."""
    name: str = ""
    """Of the measurement."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """All findings as sentences, each after the name of its trial where there are several."""
        return tuple(map(str, self.findings))

    @property
    def worst(self) -> Severity:
        """``"error"`` if no fit should be made, ``"warning"``, or ``"info"``."""
        ranks = [SEVERITIES.index(finding.severity) for finding in self.findings]
        return SEVERITIES[max(ranks, default=0)]

    def of(self, kind: str) -> tuple[Finding, ...]:
        """Return the findings of a kind.

        Parameters
        ----------
        kind : str
            Such as ``"gap"``.

        Returns
        -------
        tuple of Finding
            None of them if there is nothing to say.

        Examples
        --------
        >>> from stickslip import Measurement, check
        >>> len(check(Measurement(travel=0.2, uncertainty=0.005)).of("settings"))
        1
        """
        return tuple(finding for finding in self.findings if finding.kind == kind)

    def to_dict(self) -> dict[str, Any]:
        """Return the findings as plain texts and numbers."""
        return {
            "name": self.name,
            "worst": self.worst,
            "findings": [finding.to_dict() for finding in self.findings],
        }

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the findings as a pandas DataFrame, a row each."""
        import pandas as pd

        columns = ["kind", "severity", "record", "sentence"]
        rows = [
            (finding.kind, finding.severity, finding.record, str(finding))
            for finding in self.findings
        ]
        return pd.DataFrame(rows, columns=columns)

    def __str__(self) -> str:
        """Return one sentence a line, warnings and errors marked."""
        return "\n".join(f"{MARKS[f.severity]}{f}" for f in self.findings)

    def __repr__(self) -> str:
        return f"<Checks of {self.name or 'a measurement'}, {self.worst}\n{self}>"

    def _repr_html_(self) -> str:
        lines = []
        for finding in self.findings:
            # No line ends between a number and its unit.
            text = html.escape(unbroken(str(finding)))
            mark = MARKS[finding.severity]
            lines.append(f"<li>{f'<strong>{mark}</strong>' if mark else ''}{text}</li>")
        return f"<ul>{''.join(lines)}</ul>"


def check(
    measurement: Measurement,
    *,
    mechanism: Mechanism | None = None,
    vary: str | Collection[str] = (),
    conditions: Collection[str] = (),
) -> Checks:
    """Say what a measurement can tell and what is wrong with it.

    Parameters
    ----------
    measurement : Measurement
        A record in time, a friction map, or readings; several trials are checked one by one.
    mechanism : Mechanism, optional
        What was measured: its parameters must be those that trials override, positions must lie
        between its stops, and forces must be of the size that its motion takes.
    vary : str or collection of str, optional
        Parameters of the mechanism that are fitted as well, by path or last name. With a mass among
        them, forces are not compared with it: the one given is where a search begins.
    conditions : collection of str, optional
        Names of conditions of trials that are used: they tell settings apart.

    Returns
    -------
    Checks
        Sentences with numbers, warnings and errors.

    Raises
    ------
    InputError
        If it is no measurement.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Measurement, check
    >>> time = np.arange(2000) / 1000
    >>> record = Measurement(time=time, position=0.05 * np.sin(2 * np.pi * time))
    >>> print(check(record).sentences[0])
    2,000 samples at 1 kHz over 2 s, evenly spaced (largest deviation below 0.001 %).
    """
    if not isinstance(measurement, Measurement):
        raise InputError(
            f"check takes a Measurement, got {type(measurement).__name__}: read a file with"
            " load_measurement."
        )
    if mechanism is not None:
        measurement = as_turning(measurement, mechanism.units)
    # Findings of a joint that turns have units of turning.
    result = _findings(measurement, mechanism, conditions)
    return Checks(findings=tuple(_beside_mass(result, vary)), name=measurement.name)


def faults(
    measurement: Measurement,
    *,
    mechanism: Mechanism | None = None,
    vary: str | Collection[str] = (),
) -> tuple[Finding, ...]:
    """Return the errors that `check` finds, without the work for what is no error.

    Examples
    --------
    >>> still = Measurement(time=np.arange(50.0), position=np.zeros(50))
    >>> [str(one) for one in faults(still)]
    ['Position is constant: no motion was recorded.']
    """
    result = _beside_mass(_findings(measurement, mechanism, grave=True), vary)
    return tuple(finding for finding in result if finding.severity == "error")


def _beside_mass(findings: Iterable[Finding], vary: str | Collection[str]) -> Iterator[Finding]:
    """Yield findings without those about a mass that is fitted."""
    names = [vary] if isinstance(vary, str) else vary
    free = any(name.rpartition(".")[2] in MASSES for name in names)
    yield from (
        finding for finding in findings if not (free and "explained" in finding.numbers)
    )  # the numbers of a mass


def _findings(
    measurement: Measurement,
    mechanism: Mechanism | None,
    conditions: Collection[str] = (),
    *,
    grave: bool = False,
) -> Iterator[Finding]:
    """Yield all findings; with ``grave`` only those of checks that can find errors."""
    records = measurement.records()
    if records[0].time is not None:
        measurement = as_readings(measurement)
        if measurement.kind == "friction-map":
            yield motion.readings(records[0].time)
        records = measurement.records()
    if measurement.kind == "scalars":
        yield from settings(records, conditions)
        yield from () if grave else order_of_settings(records)
    yield from lost((measurement, *records))
    yield from volts(records)
    yield from alike(records)
    if not grave:
        yield from repeated(records)
    own = [*_of_records(measurement, mechanism, grave)]
    yield from _beside_others(own, len(records)) if measurement.trials else own
    if not grave:
        yield from unused(records, conditions)


def _of_records(
    measurement: Measurement, mechanism: Mechanism | None, grave: bool
) -> Iterator[Finding]:
    """Yield what is found of each record by itself."""
    for trial, record in enumerate(measurement.records(), 1):
        label = (record.name or f"trial {trial}") if measurement.trials else ""
        fits = [*_fits(record, mechanism)]
        if record.joints:
            yield from _joints(record, mechanism, label, grave)
            own = fits
        else:
            # Where a record does not fit its mechanism, comparisons of both would say so once more.
            own = [*_record(record, None if _wrong(fits) else mechanism, grave), *fits]
        yield from (replace(finding, record=label) for finding in own)


def _beside_others(findings: Sequence[Finding], trials: int) -> Iterator[Finding]:
    """Yield findings of trials without faults that are none where others move, or otherwise."""
    still = {finding.record for finding in findings if _still(finding)}
    shares: dict[str, list[float]] = {}
    for finding in findings:
        if finding.kind == "reversals" and FORWARD in finding.numbers:
            shares.setdefault(_joint_of(finding), []).append(finding.numbers[FORWARD])
    # Trials in one direction only are no fault where others go the other way.
    both = {joint for joint, all_ in shares.items() if min(all_) < 1.0 and max(all_) > 0.0}
    for finding in findings:
        if _still(finding) and len(still) < trials:
            yield _resting(finding, RESTING_JOINT if _joint_of(finding) else RESTING_BODY)
        elif finding.measure == OTHER_WAY and _joint_of(finding) in both:
            yield motion.beside_other_way(finding)
        else:
            yield finding


def _joints(
    record: Measurement, mechanism: Mechanism | None, label: str, grave: bool
) -> Iterator[Finding]:
    """Yield what is found of each joint by itself, after its name; what all share, once.

    Its force is not compared with its motion alone, since it drives those of the others too.
    """
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True)) if mechanism else {}
    joints = {
        name: replace(trial, turning=True) if units.get(name) == "rad" else trial
        for name, trial in record.joints.items()
    }
    result = {name: [*_record(trial, None, grave, coupled=True)] for name, trial in joints.items()}
    moving = [name for name, own in result.items() if not any(map(_still, own))]
    # what jitter looks like in a joint that rests says nothing
    for name in {*result}.difference(moving) if moving else ():
        result[name] = [_resting(item, RESTING_JOINT) for item in result[name] if _still(item)]
    shared = set.intersection(*({item.sentence for item in result[x]} for x in moving or result))
    # What all moving joints share is said once, in the place of the first.
    first = (moving or [*result])[0]
    for name, own in result.items():
        for finding in own:
            if finding.sentence not in shared:
                yield replace(finding, record=f"{label}, {name}" if label else name)
            elif name == first:
                yield replace(finding, record=label)


def _joint_of(finding: Finding) -> str:
    """Return the joint of a trial that a finding is about; empty of a record without joints."""
    return finding.record.partition(", ")[2]


def _still(finding: Finding) -> bool:
    return finding.kind == "constant" and finding.severity == "error"


def _resting(finding: Finding, means: str) -> Finding:
    """Return that something rests, as no fault where others move, and what that means."""
    why = finding.sentence.removesuffix("no motion was recorded.")
    return replace(finding, severity="info", sentence=f"{why}{means}")


def _wrong(found: Sequence[Finding]) -> bool:
    return any(finding.severity == "error" for finding in found)


def _agreement(
    record: Measurement,
    mechanism: Mechanism | None,
    moving: motion.Motion | None,
    *,
    coupled: bool,
) -> Iterator[Finding]:
    """Yield what signals say of each other; force says nothing where two of them contradict."""
    agree = [*motion.velocity_and_position(record)]
    yield from agree
    yield from motion.friction_sign(record, moving)
    # Where signals contradict each other, energies would only repeat it.
    if not _wrong(agree) and not coupled:
        yield from motion.energy(record, mechanism)
        yield from motion.proportion(record, mechanism)


def _record(
    record: Measurement, mechanism: Mechanism | None, grave: bool, *, coupled: bool = False
) -> Iterator[Finding]:
    """Yield the findings about one record."""
    huge = [*unusable(record)]
    yield from huge
    if huge:
        return
    if record.kind == "friction-map":
        yield from coverage(record)
        yield from resting(record)
        if not grave:
            yield from stated(record)
            yield from plausible(record)
    if not grave:
        yield from coefficient(record, mechanism)
    if record.time is None:
        return
    yield from length(record.time)
    if not grave:
        yield from sampling(record.time)
        yield from gaps(record.time)
    record, times = without_outliers(record)  # of which no motion and no force is made
    for column, at in times.items():
        # Those of joints stay where they are.
        text = " ".join([outlier_sentence(column, at), *[REPLACED] * (not coupled)])
        numbers = {"samples": len(at), "first": at[0]}
        yield remark("outliers", "warning", text, **numbers)
    still = [*constant(record), *unmoved(record)]
    yield from still
    # What only asks for errors needs a motion for its speed, or to compare it with friction.
    needed = isinstance(record.friction, np.ndarray) or has_speed(record)
    moving = None if _wrong(still) or (grave and not needed) else motion.motion_of(record)
    fast = [*too_fast(record, moving)]
    yield from fast
    still += fast  # comparisons of such a motion would say so once more
    enough = isinstance(record.time, np.ndarray) and (record.time.size >= FEWEST_SAMPLES)
    if not grave:
        yield from _signals(record, mechanism, enough)
    if enough and not _wrong(still):
        yield from _agreement(record, mechanism, moving, coupled=coupled)
    if enough and not grave and not _wrong(still):
        yield from _course(record, mechanism, moving)


def _signals(record: Measurement, mechanism: Mechanism | None, enough: bool) -> Iterator[Finding]:
    """Yield what each signal tells by itself."""
    yield from motion.missing(record, mechanism)
    for of_sizes in (plausible, usual, motion.straight):
        yield from of_sizes(record)
    if not enough:
        return
    for of_signals in (jumps, saturated, held, cut_off, quantised, lifted, hum):
        yield from of_signals(record)
    if record.position is None and record.velocity is None:
        text = "Neither position nor velocity is given: directions and rests cannot be determined."
        yield remark("motion", "info", text)


def _course(
    record: Measurement,
    mechanism: Mechanism | None,
    moving: motion.Motion | None,
) -> Iterator[Finding]:
    """Yield what the course of the motion tells."""
    if moving is not None:
        yield from motion.reversals(moving, offset=motion.has_offset(record, mechanism))
        yield from motion.rests(moving)
        yield from motion.slow(moving)


def _fits(record: Measurement, mechanism: Mechanism | None) -> Iterator[Finding]:
    """Yield what does not fit the mechanism."""
    if mechanism is None:
        return
    try:
        if record.overrides or record.initial:
            check_record(mechanism, record, record.name or "the record")
    except InputError as error:
        yield remark("mechanism", "error", str(error))
        return
    if record.position is None:
        return
    if is_filmed(record) and cycle_or_none(vary(mechanism, PREFIX, record.overrides)) is not None:
        for sentence in other_drives(mechanism, record):
            yield remark("drive frequency", "error", sentence)
    position, unit = np.atleast_1d(record.values("position")), record.unit("position")
    stops = mechanism.stops() if isinstance(mechanism, BoundedMechanism) else ()
    # Stops inside of a mechanism, as of a joint's play, bound no position that was measured.
    inside = any(wall.coordinate not in slip_names(mechanism) for wall in stops)
    bounds = (("lower_stop", -1.0, position.min()), ("upper_stop", 1.0, position.max()))
    lower, upper = (None if inside else getattr(mechanism, name, None) for name, *_ in bounds)
    room = math.inf if lower is None or upper is None else float(upper) - float(lower)
    span = float(np.ptp(position))
    if span > DECADE * room:
        text = (
            f"Position spans {quantity(span, unit)}, and the stops of the mechanism are"
            f" {quantity(room, unit)} apart: give the unit of the position, as --unit"
            " position=mm, or correct the stops."
        )
        yield remark("mechanism", "error", text, span=span, room=room)
        return
    for name, side, reached in bounds:
        stop = None if inside else getattr(mechanism, name, None)  # of what was measured
        if stop is not None and side * (float(reached) - float(stop)) > 0:
            text = (
                f"Position reaches {quantity(float(reached), unit)}, beyond {name} of the"
                f" mechanism at {quantity(float(stop), unit)}: check the zero and the unit of"
                " position."
            )
            yield remark("mechanism", "warning", text, reached=float(reached), stop=float(stop))


# What no fit is made from, refused in the same words by every verb.

ACTING = ("force", "reference", "friction")
"""What acts on a body: a second record without it would be predicted as if nothing did."""


def refuse_faults(
    measurement: Measurement, mechanism: Mechanism, vary: Collection[str] = ()
) -> None:
    """Refuse a measurement with errors that `check` finds where some parameters are fitted.

    Examples
    --------
    >>> from stickslip import Axis
    >>> still = Measurement(time=list(range(50)), position=[0.0] * 50)
    >>> refuse_faults(still, Axis(inertia=1.0))
    Traceback (most recent call last):
    stickslip.errors.InputError: This record cannot be fitted. Position is constant: ...
    """
    wrong = faults(measurement, mechanism=mechanism, vary=vary)
    if wrong:
        raise refusal(wrong)


def refusal(wrong: Sequence[Finding]) -> InputError:
    """Return what refuses a record with these errors."""
    return InputError(f"This record cannot be fitted. {findings_text(wrong)}")


def findings_text(findings: Sequence[Finding]) -> str:
    """Return findings as one text: what several trials have in common once, after their names."""
    return " ".join(sentences_of(grouped(findings)))


def refuse_unused(measurement: Measurement, inside: Collection[str] = ()) -> None:
    """Refuse settings of records in time or of friction that would have no effect.

    Examples
    --------
    >>> refuse_unused(Measurement(time=[0.0, 1.0], position=[0.0, 0.1], initial={"x": 1.0}))
    Traceback (most recent call last):
    stickslip.errors.InputError: Measurement.initial (x) of the record has no effect on ...
    """
    for record in measurement.records():
        label = f"record {record.name!r}" if record.name else "the record"
        for name, why in (
            ("initial", "the initial states of its segments are estimated"),
            ("uncertainty", "intervals come from the residuals of the fit"),
        ):
            # Rows of a table may be weighted by what is stated of each.
            known = {*inside, *["friction"] * (record.kind == "friction-map")}
            given = ", ".join(state for state in getattr(record, name) if state not in known)
            if given:
                raise InputError(
                    f"Measurement.{name} ({given}) of {label} has no effect on fits to records:"
                    f" {why}. Leave it out."
                )


def refuse_lack(
    first: Measurement, second: Measurement, *, which: str = "the second record"
) -> None:
    """Refuse a record that has not what another one has that a fit was made to.

    Examples
    --------
    >>> time, x = [0.0, 1.0], [0.0, 0.1]
    >>> driven = Measurement(time=time, position=x, force=x)
    >>> refuse_lack(driven, Measurement(time=time, position=x))
    Traceback (most recent call last):
    stickslip.errors.InputError: the second record has no force (u) [N], which ...
    """
    needed = [name for name in first.quantities() if name.partition(".")[0] in ACTING]
    for name in needed:
        for record in second.records():
            if name in record.quantities():
                continue
            label = f"{which} {record.name!r}" if record.name else which
            quantity = quantity_called(name)
            cure = " Where no force acted, give a force of 0." if name == "force" else ""
            raise InputError(
                f"{label} has no {name} ({quantity.symbol}) [{quantity.unit}], which the fitted"
                f" record has; it has {', '.join(record.quantities())}.{cure}"
            )


def refuse_same(first: Measurement, second: Measurement) -> None:
    """Refuse a second record that holds what the fit is made to, number by number.

    Examples
    --------
    >>> run = {"time": [0.0, 1.0], "position": [0.0, 0.1]}
    >>> refuse_same(Measurement(**run, name="run 1"), Measurement(**run))
    Traceback (most recent call last):
    stickslip.errors.InputError: the second record is identical to the fitted one ('run 1'), ...
    """
    for record in second.records():
        for other in first.records():
            if not same(record, other):
                continue
            name = record.name or other.name
            label = f" ({name!r})" if name else ""
            raise InputError(
                f"the second record is identical to the fitted one{label}, sample by sample, so its"
                " error would not be that on another. Give another record."
            )


@contextmanager
def with_doubts(measurement: Measurement, mechanism: Mechanism) -> Iterator[None]:
    """Add what `check` warns of to the message of a record that turns out not to serve.

    Examples
    --------
    >>> from stickslip import Axis
    >>> few = Measurement(time=list(range(20)), velocity=[0.1 * (i % 5) for i in range(20)])
    >>> with with_doubts(few, Axis(inertia=1.0)):
    ...     raise InputError("it does not serve.")
    Traceback (most recent call last):
    stickslip.errors.InputError: it does not serve. Warnings of the data check: ...
    """
    try:
        yield
    except (ParameterError, UnknownNameError):  # of what was asked, not of the record
        raise
    except InputError as error:
        result = check(measurement, mechanism=mechanism).findings
        doubts = [finding for finding in result if finding.severity == "warning"]
        if not doubts:
            raise
        text = str(error).rstrip()
        text += "" if text.endswith((".", "!", "?")) else "."
        # The class tells callers what went wrong: it stays.
        text = " ".join([text, "Warnings of the data check:", findings_text(doubts)])
        raise type(error)(text) from None
