"""What readings cover: speeds and loads, how often, in what order, and whether levels stay.

A friction map tells a law only where it has readings, more than one of each, and in an order that
is none of the setting: a drift then reads as an effect of it. In a record, a level that does not
stay leaves fewer independent values than there are samples.
"""

import math
from collections.abc import Collection, Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from stickslip.data import measurement
from stickslip.data.checking.finding import OTHER_SPEEDS, OTHER_WAY, TURN, Finding, Severity
from stickslip.data.checking.motion import Motion
from stickslip.data.differentiation import acceleration_of, smooth
from stickslip.data.tolerances import (
    DECADE,
    FEW_SAMPLES,
    FEWEST,
    FEWEST_SAMPLES,
    LISTED,
    MOSTLY,
    NEARLY_ALL,
    SIX_DIGITS,
    SLIGHT,
    SMALL,
)
from stickslip.mechanisms import Mechanism, load_stated
from stickslip.show.formatting import count, lower_first, number, percent, quantities, quantity

# Friction maps and single numbers: what they cover, how often, how surely.

FEW_SPEEDS: Final = 5
CHANCE: Final = 0.005
"""Probability of a mean as low by noise alone, below which a sign is told."""
SLOWEST: Final = 5
"""Readings of a direction that show what friction is at the slowest speeds ..."""
ACTING: Final = ("force", "reference", "friction", "load", "spring_force", "pull")
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
        yield _map("error", "All velocities are 0: no motion was recorded.", numbers)
        return
    if not friction.any():
        yield _map("error", "All values of friction are 0: it was not recorded.", numbers)
        return
    low, high = quantities([float(velocity.min()), float(velocity.max())], record.unit("velocity"))
    few = distinct < FEWEST
    text = f"{count(velocity.size, 'point')} at {count(distinct, 'velocity', 'velocities')}"
    text += f" from {low} to {high}"
    text += f": a friction curve needs at least {FEWEST} velocities." if few else "."
    if distinct < FEW_SPEEDS:
        yield _map("warning", text, numbers, measure=OTHER_SPEEDS)
    else:
        yield _map("info", text, numbers)
    if velocity.min() >= 0 or velocity.max() <= 0:
        way = "forward" if velocity.max() > 0 else "backward"
        text = f"All velocities are {way}: friction level and offset cannot be separated."
        yield _map("warning", text, numbers, measure=OTHER_WAY)
    if distinct == velocity.size:
        text = "No velocity is repeated: scatter cannot be separated from the shape of the curve."
        yield _map("info", text, numbers)
    along = (np.sign(velocity) * friction)[moving]
    against, rest = float(np.mean(along < 0)), len(along) - 1.0
    # noise alone has either sign: on eleven points four times in a hundred on nine of them
    if against > 0.8 and np.mean(along) * rest**0.5 < stdtrit(rest, CHANCE) * np.std(along):
        text = f"Friction is opposite in sign to the velocity on {percent(against)} of the points."
        text += f" Sign convention: friction has the sign of the slip velocity; {TURN}."
        sign = {"opposite_share": against}
        yield Finding(kind="friction sign", severity="error", sentence=text, numbers=sign)


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
    found: NDArray[np.bool_] = velocity == 0.0
    # Few readings below a gap of a decade are at rest; more of them are a range of speeds.
    gaps = np.flatnonzero(ordered[1:] > DECADE * ordered[:-1])
    few = gaps[gaps < max(SMALL * speed.size, 1.0)]
    if not few.size:
        return found
    slow = speed <= ordered[few[-1]]
    levels = [_level(side * velocity[~slow], side * friction[~slow]) for side in (-1.0, 1.0)]
    # Without a level in a direction nothing tells rest from a law that fades.
    if any(level == 0.0 for level in levels):
        return found
    below, above = levels
    inside = (friction > -MOSTLY * below) & (friction < MOSTLY * above)
    return np.asarray(found | (slow & inside))


def _level(velocity: measurement.Array, friction: measurement.Array) -> float:
    """Return friction at the slowest forward speeds; 0 if it has no level, infinite of none."""
    forward = np.flatnonzero(velocity > 0.0)
    if not forward.size:
        return np.inf
    slowest = forward[np.argsort(velocity[forward], kind="stable")][:SLOWEST]
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
    yield Finding(
        kind="rest",
        severity="warning" if slow else "info",
        sentence=(
            f"{count(resting, 'reading')} at {at} {verb} taken for a body at rest, where friction"
            " has any value up to its level, and left out of sliding: all others are at"
            f" {slowest} or faster."
        ),
        measure="Measure at speeds below the slowest, for long enough to slide" if slow else "",
        numbers={"readings": float(resting)},
    )


LARGEST: Final = 2.0
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
    if load is None or load <= LEAST_LOAD or not 0.0 < largest < min(LARGEST, SMALL * load):
        return
    most, pressed = quantity(largest, record.unit("friction")), quantity(load, "N")
    yield Finding(
        kind="units",
        severity="warning",
        sentence=(
            f"Friction reaches {most} at a load of {pressed}, {percent(largest / load)} of it. If"
            " the values are friction coefficients, state their unit as 1: they are then"
            " multiplied by the load."
        ),
        numbers={"friction": largest, "load": load},
    )


def lost(records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    """Yield what the files say that they hold and do not, once for all trials of a file."""
    for sentence in dict.fromkeys(line for record in records for line in record.lost):
        yield Finding(
            kind="lost",
            sentence=sentence,
            severity="warning",
            measure="Save or export the record again, complete",
        )


def volts(records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    """Say of which forces volts were recorded."""
    for name in dict.fromkeys(name for record in records for name in record.volts):
        yield Finding(kind="volts", sentence=volts_sentence(name), severity="info")


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
    for name in apart:
        yield Finding(
            kind="unused column",
            severity="warning",
            sentence=(
                f"Column {name!r} is not used but differs between the trials: declare it as a"
                " condition to fit each trial separately."
            ),
        )
    inputs = [name for name in records[0].inputs if all(name in trial.inputs for trial in records)]
    rest = [name for name in rest if name not in inputs]
    if inputs:
        yield Finding(
            kind="contact input",
            sentence=f"Measured beside: {', '.join(inputs)}; laws may depend on it, such as"
            f" level + viscous * exponential[{inputs[0]}].",
        )
    if rest:
        listed = ", ".join(map(repr, rest[:LISTED])) + (
            f" and {len(rest) - LISTED} more" if len(rest) > LISTED else ""
        )
        verb = "Column {} is" if len(rest) == 1 else "Columns {} are"
        yield Finding(kind="unused column", sentence=f"{verb.format(listed)} not used.")
    conditions = dict.fromkeys(
        name
        for record in records
        for name in record.conditions
        if measurement.condition_name(name) not in used
    )
    if conditions and records[0].travelled:
        yield Finding(
            kind="conditions",
            severity="warning",
            sentence=(
                f"Conditions ({', '.join(conditions)}) are not used: a trial with a single value"
                " cannot be fitted separately. Where a condition is a parameter of the mechanism,"
                " give it as such, e.g. mechanism.load."
            ),
        )


def _map(
    severity: Severity, sentence: str, numbers: dict[str, float], *, measure: str = ""
) -> Finding:
    return Finding(
        kind="coverage", severity=severity, sentence=sentence, numbers=numbers, measure=measure
    )


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
    yield Finding(
        kind="settings",
        severity="warning" if few else "info",
        sentence=text,
        measure="Measure at further settings" if few else "",
        numbers={"readings": readings, "settings": len(kinds), "repeats": repeats},
    )
    bare = sum(not record.uncertainty for record in records)
    if bare:
        none = bare == len(records)
        which = "No reading has an" if none else f"{bare} of {len(records)} readings have no"
        yield Finding(
            kind="uncertainty",
            severity="warning",
            sentence=f"{which} uncertainty: give one, such as half of the last digit.",
            numbers={"without": bare},
        )
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
    yield Finding(
        kind="uncertainty",
        severity="warning" if wrong else "info",
        sentence=f"The uncertainty of friction is stated: {text}{cure}.",
        numbers={"low": low, "median": middle, "high": high},
    )


def alike(records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    """Say which trials in time lack what acts on the others."""
    if any(record.time is None for record in records):
        return
    for name in ACTING:
        bare = [i for i, record in enumerate(records) if name not in record.quantities()]
        if not bare or len(bare) == len(records):
            continue
        has = next(i for i in range(len(records)) if i not in bare)
        labels = [records[i].name or f"trial {i + 1}" for i in (has, bare[0])]
        word = name.replace("_", " ")
        cure = f"give {word} for each trial"
        cure += ", 0 where no force acted" if name == "force" else ""
        yield Finding(
            kind="trials",
            severity="error",
            sentence=(
                f"{word.capitalize()} was measured in {labels[0]!r} but not in {labels[1]!r}:"
                f" {cure}, or fit the trials separately."
            ),
            numbers={"without": len(bare)},
        )


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
        yield Finding(
            kind="repeated trial",
            severity="warning",
            sentence=(
                f"{own!r} has the samples of {other!r}: counted twice, they make intervals too"
                " narrow. Leave one of them out."
            ),
        )


def _negative(name: str, records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    if measurement.QUANTITIES[name].unit != "m" and name not in measurement.TRAVELS:
        return
    noun = name.replace("_", " ")
    values = np.concatenate(
        [np.atleast_1d(r.values(name)) for r in records if getattr(r, name) is not None]
    )
    if measurement.QUANTITIES[name].unit == "m" and float(np.abs(values).max()) > 100.0:
        largest = float(np.abs(values).max())
        yield Finding(
            kind="units",
            severity="warning",
            sentence=f"{noun.capitalize()} reaches {quantity(largest, 'm')}: check that the values"
            " are in metres.",
            numbers={name: largest},
        )
    elif name in measurement.TRAVELS and not values.any():
        yield Finding(
            kind="constant",
            severity="error",
            sentence=f"Every {noun} is 0: no motion was recorded.",
        )


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
    found = {}
    for path in paths:
        values = [{**record.overrides, **record.initial}.get(path) for record in records]
        if any(not isinstance(value, (int, float)) for value in values):
            return {}
        numbers = np.array(values, dtype=float)
        if np.ptp(numbers) > 0.0:
            found[path] = monotone(numbers)
    return found if all(found.values()) else {}


def order_of_settings(records: Sequence[measurement.Measurement]) -> Iterator[Finding]:
    """Say of readings that what was set is in order; of a table, the judge says it."""
    for path, how in [*settings_in_order(records).items()][:1]:
        what = path.rpartition(".")[2].replace("_", " ")
        yield Finding(
            kind="order",
            sentence=f"The {what} {how} from trial to trial; if it was set in this order, a slow"
            f" drift reads as an effect of the {what}.",
            measure=f"Measure in random order, or repeat the first {what} at the end",
        )


def with_order(lines: Sequence[str], findings: Sequence[Finding], most: int) -> tuple[str, ...]:
    """Return what to measure, so many lines at most: at last in another order, if one was found.

    Examples
    --------
    >>> order = Finding(kind="order", sentence="It rises.", measure="Measure in random order")
    >>> with_order(["Measure at 1 m/s.", "Warm it up."], [order], 2)
    ('Measure at 1 m/s.', 'Measure in random order: it rises.')
    """
    found = [
        f"{finding.measure}: {lower_first(finding.sentence)}"
        for finding in findings
        if finding.kind == "order"
    ][:1]
    return (*lines[: most - len(found)], *found)


# Levels of forces: whether they stay, and how many independent values there are.

FORCES: Final = ("force", "friction", "spring_force", "load")
SURE: Final = 2.0
"""Standard errors by which the means of two halves differ, not to be chance in most cases."""
FEWEST_FOR_DRIFT: Final = 200
"""Samples of two halves of which the means of blocks are known."""


class Level(NamedTuple):
    """A signal without what the motion explains of it."""

    name: str
    """Name of the quantity."""
    what: str
    """Where it comes from, in words."""
    values: measurement.Array
    """What remains of the signal (n,)."""
    size: float
    """Root mean square of the whole signal."""
    unit: str = "N"
    """SI unit of the signal."""


def levels(record: measurement.Measurement, motion: Motion | None) -> Iterator[Level]:
    """Yield forces less what acceleration, velocity and direction explain of them."""
    for name in FORCES:
        if not isinstance(getattr(record, name), np.ndarray):
            continue
        values = np.asarray(record.values(name))
        size = float(np.sqrt(np.mean(values**2)))
        words = name.replace("_", " ")
        if motion is None or name == "load":
            yield Level(name, words, values, size, record.unit(name))
            continue
        columns = [acceleration_of(record), motion.velocity, motion.directions]
        matrix = np.stack([*columns, np.ones(values.size)], axis=1)
        scale = np.sqrt(np.mean(matrix**2, axis=0))
        matrix = matrix / np.where(scale > 0, scale, 1.0)
        found = np.linalg.lstsq(matrix, values, rcond=None)[0]
        # The constant stays in: it is the level that is looked at.
        left = values - matrix[:, :3] @ found[:3]
        what = (
            f"{words} after subtraction of its dependence on acceleration, velocity and direction"
        )
        yield Level(name, what, left, size, record.unit(name))


def independent(values: measurement.Array) -> float:
    """Return how many independent values have a mean as sure as these, from how long they agree.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> white = rng.normal(size=10_000)
    >>> bool(independent(white) > 9_000), bool(independent(np.repeat(white, 10)) < 11_000)
    (True, True)
    """
    from scipy.fft import irfft, next_fast_len, rfft

    n = values.size
    centred = values - values.mean()
    power = float(centred @ centred)
    if power <= 1e-24 * float(values @ values):
        return float(n)
    # Padded to twice the length, so that the correlation does not wrap around.
    padded = next_fast_len(2 * n, real=True)
    seen = irfft(np.abs(rfft(centred, padded)) ** 2, padded)[:n] / power
    # Up to the first value that is not positive: noise of later ones would add up.
    below = np.flatnonzero(seen <= 0)
    last = int(below[0]) if below.size else n
    return float(min(n, n / (1.0 + 2.0 * float(np.sum(seen[1:last])))))


def drift(found: list[Level]) -> Iterator[Finding]:
    """Say which forces change their mean from the first half to the second."""
    for level in found:
        if level.values.size < FEWEST_FOR_DRIFT or level.size == 0.0 or np.ptp(level.values) == 0.0:
            continue
        halves = np.array_split(level.values, 2)
        means = [float(half.mean()) for half in halves]
        change, doubt = means[1] - means[0], math.hypot(*map(_doubt, halves))
        sure = abs(change) / doubt if doubt else np.inf
        if sure < SURE or abs(change) < 0.01 * level.size:
            continue
        matters = abs(change) >= SLIGHT * level.size
        first, second = quantities(means, level.unit)
        word = "rises" if change > 0 else "falls"
        text = f"Mean {level.what} {word} from {first} in the first half to {second} in the second"
        text += f" ({percent(abs(change) / level.size)} of its level,"
        text += f" {number(float(sure), 2)} standard errors)"
        text += ": fit the halves separately, or fit the drifting parameter." if matters else "."
        yield Finding(
            kind="drift",
            severity="warning" if matters else "info",
            sentence=text,
            measure=(
                "Repeat this record after an hour of running, to separate warm-up effects from the"
                " friction law"
            ),
            numbers={
                "first": means[0],
                "second": means[1],
                "standard_error": doubt,
                "relative": change / level.size,
            },
        )


def _doubt(values: measurement.Array) -> float:
    """Return the standard error of a mean from the scatter of the means of blocks."""
    means = [float(block.mean()) for block in np.array_split(values, FEWEST_SAMPLES)]
    return float(np.std(means, ddof=1)) / float(np.sqrt(FEWEST_SAMPLES))


def effective(record: measurement.Measurement, levels: list[Level]) -> Iterator[Finding]:
    """Say how many independent values the record has, and of what."""
    chosen = next((level for level in levels if level.name != "load"), None)
    time = record.time
    if chosen is not None:
        what, values = chosen.what, chosen.values
    elif time is not None and (record.position is not None or record.velocity is not None):
        name = "position" if record.position is not None else "velocity"
        own = np.asarray(record.values(name))
        what, values = f"{name} minus its smooth component", own - smooth(time, own)
    else:
        return
    if values.size < FEW_SAMPLES or np.ptp(values) == 0.0:
        return
    size = independent(values)
    few = size < 0.9 * values.size  # two digits of nearly all would be more than all
    shown = number(size, 2) if few else number(math.floor(size), 9)
    yield Finding(
        kind="effective size",
        severity="warning" if size < FEW_SAMPLES else "info",
        sentence=(
            f"Effective sample size before any fit: {shown} of {number(values.size, 9)}"
            f" samples (from the autocorrelation of the {what})."
        ),
        numbers={"samples": values.size, "independent": size},
    )
