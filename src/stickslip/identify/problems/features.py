"""What the rows of a record may be told apart by: signals, and what they derive from the motion."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from stickslip.identify.problem import SIDE, Array, Mask

WAVES = 12
"""Waves over the range of the places at most."""
TURN, BEYOND, STROKE = (
    "time since the last turn", "way since the last turn", "length of the last stroke",
)  # fmt: skip
REST, PAUSE = "time since the last rest", "length of the last rest"


def features_along(rows: Any) -> Mapping[str, Array]:
    """Return the features of the rows of records, `Along`: (n,), of places (n, d)."""
    per_record: dict[str, list[Array]] = {}
    cuts = np.cumsum([len(one.time) for one in rows.records])[:-1]
    pieces = [np.split(x, cuts) for x in (rows.direction, rows.path, rows.velocity)]
    for k, record in enumerate(rows.records):
        side, path, velocity = (one[k] for one in pieces)
        found = _since(record.time, side, path, np.abs(velocity) < rows.frame.low)
        for name, x in found.items():
            per_record.setdefault(name, []).append(x)
    seen = rows.seen(rows.velocity)
    features = {
        SIDE: _at_rows(rows, rows.direction),
        "speed": np.abs(seen),
        "logarithm of the speed": np.log(np.maximum(np.abs(seen), rows.frame.low)),
        "time": _at_rows(rows, rows.clock),
        "place": _waves(_at_rows(rows, rows.place) / rows.frame.span),
        "acceleration": rows.acceleration,
        "jerk": rows.seen(rows.velocity, slope=2),
        "load": rows.seen(rows.load),
        **{name: rows.seen(rows.input(name)) for name in rows.frame.inputs},
    }
    return features | {
        name: _at_rows(rows, np.concatenate(parts)) for name, parts in per_record.items()
    }


def features_in_steady_motion(rows: Any) -> Mapping[str, Array]:
    """Return the features of rows in steady motion, `Steady` (n,): the last turn is long ago."""
    velocity, zero = rows.velocity, np.zeros(len(rows.velocity))
    unknown, long_ago = zero + np.nan, zero + 1e300
    return {
        SIDE: np.sign(velocity),
        "speed": np.abs(velocity),
        "logarithm of the speed": np.log(np.maximum(np.abs(velocity), rows.frame.low)),
        "time": unknown,
        "place": np.full((len(zero), 1 + 2 * WAVES), np.nan),
        "acceleration": zero,
        "jerk": zero,
        "load": rows.load,
        **{name: rows.input(name) for name in rows.frame.inputs},
        "way": unknown,
        TURN: long_ago,
        BEYOND: long_ago,
        STROKE: unknown,
        REST: long_ago,
        PAUSE: unknown,
    }


def _at_rows(rows: Any, x: Array) -> Array:
    """Return the values of a full column (n,) at the rows, without the filter."""
    cuts = np.cumsum([len(one.time) for one in rows.records])[:-1]
    parts = zip(np.split(x, cuts), rows.filters, strict=True)
    found: Array = rows.rows_of([one[:: filt.every] for one, filt in parts])
    return found


def _waves(place: Array) -> Array:
    """Return the place (n,) over its range, and waves of it (n, 1 + 2 w)."""
    angle = 2.0 * np.pi * place[:, None] * np.arange(1, WAVES + 1)
    return np.hstack([place[:, None], np.sin(angle), np.cos(angle)])


def _since(time: Array, side: Array, path: Array, resting: Mask) -> dict[str, Array]:
    """Return what has passed since turns and rests along a record (n,)."""
    at = np.arange(len(time))
    turned = np.concatenate([[True], side[1:] != side[:-1]])
    turn = np.maximum.accumulate(np.where(turned, at, 0))
    before = np.maximum.accumulate(np.where(turned, turn[np.maximum(at - 1, 0)], 0))
    still = np.concatenate([[True], resting[1:]])
    rest = np.maximum.accumulate(np.where(still, at, 0))
    moving = np.maximum.accumulate(np.where(~still, at, 0))
    return {
        "way": np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path)))]),
        TURN: time - time[turn],
        BEYOND: np.abs(path - path[turn]),
        STROKE: np.abs(path[turn] - path[before]),
        REST: time - time[rest],
        PAUSE: time[rest] - time[moving[rest]],
    }
