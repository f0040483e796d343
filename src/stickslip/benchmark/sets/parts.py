"""Parts of records that are fitted, and parts that judge."""

from collections.abc import Sequence

import numpy as np

from stickslip.catalogue import dataset
from stickslip.experiments import Measurement, rows_of


def between(record: Measurement, first: float, end: float) -> Measurement:
    """Return the samples of a record from one time on, up to another, in seconds of its clock."""
    time = np.asarray(record.time)
    rows = np.searchsorted(time, [first, end])
    return rows_of(record, int(rows[0]), int(rows[1]))


def together(name: str, files: Sequence[str]) -> Measurement:
    """Return files of a record as trials of one measurement."""
    record = dataset(name)
    return Measurement(trials=tuple(record.measurement(file) for file in files), name=name)
