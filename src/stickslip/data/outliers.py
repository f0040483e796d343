"""Single samples far off those beside, as a dropped reading is: checks name them, fits go on.

A step is none, as the median of five samples follows it, nor is the turn of a swing, beside which
samples differ as much. What is more frequent belongs to the signal.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from stickslip.data.differentiation import usual_top_speed
from stickslip.data.measurement import Array, Measurement
from stickslip.show.formatting import joined, number

FAR: Final = 10.0
"""Least distance of an outlier from the median of its neighbours, over that which a tenth exceeds.
"""
APART: Final = 3.0
"""The same over the change from a sample to the next, the usual one and those beside ..."""
BESIDE: Final = 9
"""Samples about it of which the change counts."""
OUT: Final = 1.25
"""Least distance of an outlier beside a step from both of its sides, over its height ..."""
OFTEN: Final = 0.2
"""... at a share of the steps at most: peaks at more of them are those of break-aways."""
SHARES: Final = {"position": 0.005, "velocity": 0.005, "force": 0.5, "friction": 0.5}
"""... and over the range. What has mass moves smoothly; a force that is commanded may have peaks.
"""
SELDOM: Final = 0.01
"""Most outliers over the samples: what is more frequent belongs to the signal ..."""
FEW: Final = 3
"""... unless they are so few."""
LEAST: Final = 30
"""Samples of a record whose outliers are looked for."""
ROUNDS: Final = 200
"""Most rounds in which outliers are looked for, each beside what the one before left."""
LISTED: Final = 6
"""Times in a sentence at most."""
REPLACED: Final = "Straight lines between the samples beside stand in their place."
"""What becomes of outliers of a record of one coordinate."""


def outlier_sentence(column: str, times: Sequence[float]) -> str:
    """Return which samples of a column lie far off those beside them.

    Examples
    --------
    >>> outlier_sentence("velocity", [25.7, 80.1])
    '2 samples of the velocity lie far off those beside, at 25.7 and 80.1 s.'
    """
    count, said = len(times), [number(time, 6) for time in times[:LISTED]]
    what = f"{count} samples of the {column} lie" if count > 1 else f"1 sample of the {column} lies"
    where = f"the first at {joined(said)}" if count > LISTED else f"at {joined(said)}"
    return f"{what} far off those beside, {where} s."


def without_outliers(
    measurement: Measurement,
) -> tuple[Measurement, Mapping[str, tuple[float, ...]]]:
    """Return a measurement with single samples far off those beside on lines between these.

    And their times [s] by column, of all records; none of records without times.

    Examples
    --------
    >>> t = np.arange(0.0, 10.0, 0.02)
    >>> x, u = np.sin(t), np.cos(t)
    >>> u[100] += 5.0
    >>> _, times = without_outliers(Measurement(time=t, position=x, force=u))
    >>> dict(times)
    {'force': (2.0,)}
    """
    found: dict[str, tuple[float, ...]] = {}
    records = tuple(_without(record, found) for record in measurement.records())
    if found:
        measurement = replace(measurement, trials=records) if measurement.trials else records[0]
    return measurement, found


def _without(record: Measurement, found: dict[str, tuple[float, ...]]) -> Measurement:
    """Return a record without outliers, whose times are added to those found."""
    if record.time is None or record.time.size < LEAST:
        return record
    columns: dict[str, Any] = {}
    for name in SHARES.keys() & {*record.quantities()}:
        x = raw = np.asarray(getattr(record, name), dtype=float)
        for _ in range(ROUNDS):
            far = far_off(x, name)
            if not far.any():
                break
            x = np.where(far, np.interp(record.time, record.time[~far], x[~far]), x)
        if x is not raw:
            columns[name] = x
            found[name] = (*found.get(name, ()), *record.time[x != raw].tolist())
    return replace(record, **columns) if columns else record


def far_off(x: Array, column: str) -> NDArray[np.bool_]:
    """Return which samples (n,) of a column, single or in pairs, lie far off those beside them.

    A value beyond both sides of a step is one where other steps have none. A body at rest may slip
    within a sample: there, only a speed beyond those of a motion is no speed.

    Examples
    --------
    >>> x = np.sin(0.01 * np.arange(500.0))
    >>> x[[100, 300, 301]] += 3.0
    >>> np.flatnonzero(far_off(x, "position")).tolist()
    [100, 300, 301]
    """
    # Imported here, as what has no times needs no filter.
    from scipy.ndimage import label, maximum_filter1d, median_filter, minimum_filter1d

    middle = median_filter(x, 5)
    for end in (middle, middle[::-1]):  # which goes on there as it ran beside
        end[:2] = end[2] + (end[2] - end[4]) * np.array([1.0, 0.5])
    apart = np.abs(x - middle)
    steps = np.abs(np.diff(x))
    usual = float(np.median(steps[steps > 0.0])) if steps.any() else 0.0
    beside = maximum_filter1d(np.abs(np.diff(middle, append=middle[-1])), BESIDE)
    least = max(
        FAR * float(np.quantile(apart, 0.9)), SHARES[column] * float(np.ptp(middle)), APART * usual
    )
    top, bottom = maximum_filter1d(middle, BESIDE), minimum_filter1d(middle, BESIDE)
    lone = (apart > least) & (np.maximum(x - top, bottom - x) > OUT * beside)
    if lone.any():
        steps = label(beside >= 0.5 * beside[lone].min())[1]
        lone &= label(lone)[1] <= OFTEN * steps
    far: NDArray[np.bool_] = lone | ((apart > least) & (apart > APART * beside))
    for end, off, at in ((x, apart, far), (x[::-1], apart[::-1], far[::-1])):
        # A motion may turn there, as fast as it moves beside.
        at[:2] &= off[:2] > FAR * max(least, float(np.max(np.abs(np.diff(end[3 : 3 + BESIDE])))))
    if column == "velocity":
        fastest = usual_top_speed(middle)
        moves = fastest > least
        far &= (np.abs(middle) > least) | (moves & (np.abs(x) > OUT * fastest))
    return far if far.sum() <= max(SELDOM * x.size, FEW) else np.zeros(x.size, dtype=bool)
