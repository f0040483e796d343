"""Whether settings were taken in their order: then a drift reads as an effect of the setting."""

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from stickslip.experiments.checking.finding import Finding
from stickslip.experiments.measurement import Array, Measurement
from stickslip.formatting import lower_first

FEWEST: Final = 3
"""Settings from which on an order is none by chance alone."""
NEARLY: Final = 0.1
"""Places that a setting is from its place in order at most, over their number: a drift over these
few is hardly seen."""


def monotone(settings: Array) -> str:
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
        off = np.max(np.abs(np.argsort(rising, kind="stable") - np.arange(rising.size)))
        if off <= NEARLY * rising.size:
            return f"mostly {how}" if off else how
    return ""


def _orders(velocity: Array) -> list[str]:
    """Return how the speeds of each direction go; one with hardly a reading has no order."""
    sides = (velocity[velocity < 0.0], velocity[velocity > 0.0])
    return [monotone(side) for side in sides if side.size >= FEWEST]


def speeds_in_order(velocity: Array) -> bool:
    """Whether the speeds of a table are in order: those of each direction by themselves.

    Examples
    --------
    >>> speeds_in_order(np.array([-0.4, -0.2, -0.1, 0.1, 0.2, 0.4]))
    True
    >>> speeds_in_order(np.array([0.1, 0.4, 0.2])), speeds_in_order(np.array([0.1, 0.2, 0.4, 0.1]))
    (False, False)
    >>> speeds_in_order(np.array([0.1, 0.2, 0.4, -0.1]))
    True
    """
    found = _orders(velocity)
    return bool(found) and all(found)


def settings_in_order(records: Sequence[Measurement]) -> dict[str, str]:
    """Return how each parameter goes that was set anew from trial to trial, if all are in order.

    Examples
    --------
    >>> def read(compression):
    ...     return Measurement(travel=0.2, overrides={"mechanism.compression": compression})
    >>> settings_in_order([read(0.05), read(0.10), read(0.15)])
    {'mechanism.compression': 'increases'}
    >>> settings_in_order([read(0.05), read(0.10), read(0.15), read(0.05)])
    {}
    """
    paths = dict.fromkeys(path for one in records for path in (*one.overrides, *one.initial))
    found = {}
    for path in paths:
        values = [{**one.overrides, **one.initial}.get(path) for one in records]
        if any(not isinstance(value, (int, float)) for value in values):
            return {}
        numbers = np.array(values, dtype=float)
        if np.ptp(numbers) > 0.0:
            found[path] = monotone(numbers)
    return found if all(found.values()) else {}


def speeds(record: Measurement) -> Iterator[Finding]:
    """Say of a table that its speeds are in order."""
    velocity = np.asarray(record.values("velocity"))
    if speeds_in_order(velocity):
        how = "mostly " if any(one.startswith("mostly") for one in _orders(velocity)) else ""
        said = f"The speeds are {how}in order from row to row; if they were measured"
        yield _finding(said, "speed")


def settings(records: Sequence[Measurement]) -> Iterator[Finding]:
    """Say of readings that what was set is in order."""
    for path, how in [*settings_in_order(records).items()][:1]:
        what = path.rpartition(".")[2].replace("_", " ")
        yield _finding(f"The {what} {how} from trial to trial; if it was set", what)


def _finding(said: str, what: str) -> Finding:
    return Finding(
        kind="order",
        sentence=f"{said} in this order, a slow drift reads as an effect of the {what}.",
        measure=f"Measure in random order, or repeat the first {what} at the end",
    )


def with_order(lines: Sequence[str], findings: Sequence[Finding], most: int) -> tuple[str, ...]:
    """Return what to measure, so many lines at most: at last in another order, if one was found.

    Examples
    --------
    >>> table = Measurement(velocity=[0.1, 0.2, 0.4], friction=[2.0, 2.1, 2.3])
    >>> [one[:23] for one in with_order(["Measure at 1 m/s.", "Warm it up."], [*speeds(table)], 2)]
    ['Measure at 1 m/s.', 'Measure in random order']
    """
    found = [
        f"{one.measure}: {lower_first(one.sentence)}" for one in findings if one.kind == "order"
    ][:1]
    return (*lines[: most - len(found)], *found)
