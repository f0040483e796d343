"""Single samples far off those beside, which fits and selections leave out."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.data import Measurement
from stickslip.identify.fits.results import ModelError
from stickslip.identify.fits.series.inverse_dynamics import LEAST
from stickslip.identify.fits.settings import ROUNDS
from stickslip.identify.fits.signals import SHARES, far_off

OUTLIERS = "outliers"
"""Name of the finding of samples far off those beside."""


def outlying(counts: Mapping[str, int]) -> tuple[ModelError, ...]:
    """Return which columns have samples far off those beside, by how many they are."""
    return tuple(
        ModelError(
            kind=OUTLIERS,
            finding=(
                f"{count} {'sample' if count == 1 else 'samples'} of the {column}"
                f" {'lies' if count == 1 else 'lie'} far off those beside."
            ),
            consequence="Straight lines between the samples beside stand in their place.",
            effect=float(count),
            interval=(math.nan, math.nan),
            share=0.0,
            moved=(),
        )
        for column, count in counts.items()
    )


def without_outliers(measurement: Measurement) -> tuple[Measurement, Mapping[str, int]]:
    """Return a measurement with single samples far off those beside on lines between these.

    And how many they are, by column; none of records without times.

    Examples
    --------
    >>> t = np.arange(0.0, 10.0, 0.02)
    >>> x, u = np.sin(t), np.cos(t)
    >>> u[100] += 5.0
    >>> _, counts = without_outliers(Measurement(time=t, position=x, force=u))
    >>> dict(counts)
    {'force': 1}
    """
    counts: dict[str, int] = {}
    if not all(isinstance(one.time, np.ndarray) for one in measurement.records()):
        return measurement, counts
    for _ in range(ROUNDS):
        records, before = [], sum(counts.values())
        for record in measurement.records():
            columns: dict[str, Any] = {}
            time = np.asarray(record.time, dtype=float)
            for name in SHARES.keys() & {*record.quantities()}:
                x = np.asarray(record.values(name), dtype=float)
                far = far_off(x, name) if len(x) >= LEAST else np.zeros(len(x), dtype=bool)
                if far.any():
                    columns[name] = np.where(far, np.interp(time, time[~far], x[~far]), x)
                    counts[name] = counts.get(name, 0) + int(far.sum())
            records.append(replace(record, **columns) if columns else record)
        if sum(counts.values()) == before:
            break
        measurement = (
            replace(measurement, trials=tuple(records)) if measurement.trials else records[0]
        )
    return measurement, counts
