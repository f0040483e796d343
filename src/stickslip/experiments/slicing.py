"""Parts of a record: some of its rows, or what lies between its gaps."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from stickslip.experiments.differentiation import GAP, interval_of
from stickslip.experiments.measurement import SAMPLED, Measurement


def rows_of(record: Measurement, first: int, end: int) -> Measurement:
    """Return the rows of a record in time from one on, up to another that is left out.

    Examples
    --------
    >>> record = Measurement(time=[0.0, 1.0, 2.0], position=[5.0, 6.0, 7.0], load=9.0)
    >>> part = rows_of(record, 1, 3)
    >>> part.time.tolist(), part.position.tolist(), part.load
    ([1.0, 2.0], [6.0, 7.0], 9.0)
    """
    return _picked(record, slice(first, end))


def _picked(record: Measurement, rows: slice) -> Measurement:
    columns = {
        name: getattr(record, name)[rows]
        for name in ("time", *SAMPLED)
        if isinstance(getattr(record, name), np.ndarray)
    }
    inputs = {
        name: one[rows] if isinstance(one, np.ndarray) else one
        for name, one in record.inputs.items()
    }
    joints = {name: _picked(one, rows) for name, one in record.joints.items()}
    return replace(record, **columns, inputs=inputs, joints=joints)


def between_gaps(record: Measurement) -> tuple[Measurement, ...]:
    """Return the parts of a record in time between steps over three times the usual one.

    Examples
    --------
    >>> record = Measurement(time=[0.0, 1.0, 2.0, 9.0, 10.0, 11.0], position=[0, 1, 2, 9, 10, 11])
    >>> [part.time.tolist() for part in between_gaps(record)]
    [[0.0, 1.0, 2.0], [9.0, 10.0, 11.0]]
    """
    time = np.asarray(record.time)
    cuts = np.flatnonzero(np.diff(time) > GAP * interval_of(time)) + 1
    if not cuts.size:
        return (record,)
    edges = [0, *cuts.tolist(), time.size]
    # One row alone has no step of time, and is no record.
    return tuple(rows_of(record, a, b) for a, b in pairwise(edges) if b - a > 1)
