"""Repair of the time base of a record, on request and never in silence."""

from collections.abc import Mapping, Sequence
from typing import Literal, TypeAlias, get_args

import numpy as np

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments.measurement import Array
from stickslip.formatting import count, quantity

NEAR = 1e-3
"""Share of the usual step of time below which two samples are of one time."""
LONG = 0.9
"""Quantile of the steps that is taken for a usual one: not a double, and not a gap."""

Repair: TypeAlias = Literal["sort", "gaps"]
"""What can be repaired: ``"sort"`` the samples by time and drop doubles, drop ``"gaps"``."""


def repairs(given: str | Sequence[str] | None) -> tuple[Repair, ...]:
    """Return the repairs asked for, those of gaps first, since times must be there to be sorted.

    Examples
    --------
    >>> repairs(["sort", "gaps"]), repairs(None)
    (('gaps', 'sort'), ())
    """
    names = () if given is None else (given,) if isinstance(given, str) else tuple(given)
    for name in names:
        if name not in get_args(Repair):
            raise UnknownNameError("repair", name, get_args(Repair))
    return tuple(name for name in get_args(Repair)[::-1] if name in names)


def repaired(
    columns: Mapping[str, Array], steps: Sequence[Repair]
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """Return the columns of a record after repairs, and what was done in words.

    Examples
    --------
    >>> columns = {"time": np.array([0.0, 2.0, 1.0, 1.0]), "position": np.array([0.0, 2.0, 1, 1])}
    >>> found, done = repaired(columns, ["sort"])
    >>> found["time"].tolist(), done
    ([0.0, 1.0, 2.0], ('sorted by time (2 samples out of order)', 'dropped 1 exact duplicate'))
    """
    found, done = dict(columns), []
    for step in steps:
        found, remarks = (_without_gaps if step == "gaps" else _sorted)(found)
        done += remarks
    return found, tuple(done)


def _without_gaps(columns: dict[str, Array]) -> tuple[dict[str, Array], list[str]]:
    good = np.all([np.isfinite(values) for values in columns.values()], axis=0)
    dropped = int(good.size - np.count_nonzero(good))
    if not dropped:
        return columns, []
    if dropped == good.size:
        raise InputError(
            'no sample is finite in all columns: repair="gaps" would remove every sample.'
        )
    kept = {name: values[good] for name, values in columns.items()}
    return kept, [f"dropped {count(dropped, 'non-finite sample')}"]


def _sorted(columns: dict[str, Array]) -> tuple[dict[str, Array], list[str]]:
    if "time" not in columns:
        raise InputError(
            'repair="sort" needs a column of times, and there is none: name it, as'
            ' columns={"time": "..."}.'
        )
    remarks = []
    time = columns["time"]
    late = int(np.count_nonzero(time < np.maximum.accumulate(time)))
    if late:
        order = np.argsort(time, kind="stable")
        columns = {name: values[order] for name, values in columns.items()}
        remarks.append(f"sorted by time ({count(late, 'sample')} out of order)")
    columns, more = _single(columns)
    return columns, [*remarks, *more]


def _single(columns: dict[str, Array]) -> tuple[dict[str, Array], list[str]]:
    """Return sorted columns with one sample a time: doubles dropped, what conflicts averaged."""
    near = nearly_zero(columns["time"])
    groups = np.concatenate([[0], np.cumsum(np.diff(columns["time"]) > near)])
    if groups[-1] + 1 == groups.size:
        return columns, []
    table = np.stack(list(columns.values()), axis=1)
    # Within a time, values in any order: equal samples then stand side by side.
    order = np.lexsort((*table.T[::-1], groups))
    table, groups = table[order], groups[order]
    same = np.concatenate([[False], np.all(np.diff(table, axis=0) == 0, axis=1)])
    table, groups = table[~same], groups[~same]
    first, sizes = np.flatnonzero(np.diff(groups, prepend=-1)), np.bincount(groups)
    # The first and the mean deviation from it, so that a single sample keeps its last digit.
    deviation = table - table[first][groups]
    single = table[first] + np.add.reduceat(deviation, first, axis=0) / sizes[:, None]
    exact, several = int(np.count_nonzero(same)), np.flatnonzero(sizes > 1)
    time = table[:, list(columns).index("time")]
    apart = time[first[several] + sizes[several] - 1] - time[first[several]]
    conflicts = int(np.count_nonzero(apart == 0.0))
    remarks = [f"dropped {count(exact, 'exact duplicate')}"] if exact else []
    if conflicts:
        remarks.append(f"averaged the values at {count(conflicts, 'duplicate time')}")
    if conflicts < apart.size:
        remarks.append(
            f"averaged {count(apart.size - conflicts, 'group')} of samples at nearly the same time"
            f" (at most {quantity(float(apart.max()), 's', 2)} apart)"
        )
    return dict(zip(columns, single.T.copy(), strict=True)), remarks


def nearly_zero(time: Array) -> float:
    """Return the step of time that separates no samples [s]: a thousandth of the usual step.

    The usual step is the median of those that are not themselves nearly zero.

    Examples
    --------
    >>> round(nearly_zero(np.array([0.0, 1e-9, 0.001, 0.001 + 1e-9, 0.002, 5.0])), 9)
    1e-06
    """
    steps = np.diff(time)
    usual = steps[steps > NEAR * np.quantile(steps, LONG, method="lower")] if steps.size else steps
    return NEAR * float(np.median(usual)) if usual.size else 0.0
