"""Times of samples: times of day and dates as seconds, and their repair, on request only."""

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments.measurement import Array
from stickslip.formatting import count, quantity

if TYPE_CHECKING:
    import pandas as pd

DAY: Final = 86_400.0
HALF: Final = DAY / 2
"""A time of day that falls by more than this has passed midnight."""
_CLOCK: Final = r"\d{1,2}:\d{2}(?::\d{2}(?:[.,]\d{1,9})?)?(?:\s*(?P<half>[AaPp][Mm]))?"
_DATE: Final = r"(?:\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[./-]\d{1,2}[./-]\d{2,4})"
_STAMP: Final = re.compile(
    rf"(?:(?P<date>{_DATE})(?:[T\s]+|\s*,\s*))?(?P<clock>{_CLOCK})\s*(?P<zone>Z|[+-]\d{{2}}:?\d{{2}})?"
)


def is_stamp(cell: str) -> bool:
    """Whether a cell is a time of day, perhaps with a date, or a date alone.

    Examples
    --------
    >>> [is_stamp(c) for c in ("12:30:00,5", "01.03.2024 12:30:00", "2024-03-01", "0,5", "12")]
    [True, True, True, False, False]
    """
    return bool(_STAMP.fullmatch(cell) or re.fullmatch(_DATE, cell))


def seconds_of(column: "pd.Series[Any]") -> NDArray[np.float64] | None:
    """Return time stamps (n,) as seconds: with dates, since the first; else, since midnight.

    Examples
    --------
    >>> import pandas as pd
    >>> seconds_of(pd.Series(["23:59:59,5", "00:00:00,25"])).tolist()
    [86399.5, 86400.25]
    >>> seconds_of(pd.Series(["01.03.2024 12:00:00", "01.03.2024 12:00:00,5"])).tolist()
    [0.0, 0.5]
    >>> seconds_of(pd.Series(["2024-03-01T23:59:59Z", "2024-03-02T00:00:01.25Z"])).tolist()
    [0.0, 2.25]
    >>> seconds_of(pd.Series(["3/1/24 11:59:59 PM", "3/2/24 12:00:01 AM"])).tolist()
    [0.0, 2.0]
    """
    import pandas as pd

    if pd.api.types.is_datetime64_any_dtype(column.dtype):
        return _since_first(column)
    try:
        texts = column.astype("string").str.strip()
    except UnicodeEncodeError:  # halves of characters
        return None
    there = texts.dropna()
    found = _STAMP.fullmatch(there.iloc[0]) if len(there) else None
    if found is None:
        return None
    if not found["date"]:
        return _of_day(texts.str.replace(",", ".", regex=False))
    # One pattern for all is parsed a hundred times faster than each by its own, and that of the
    # first as it stands spares the time of making all alike, which is longer.
    for alike in (False, True):
        try:
            pattern = _pattern(there, found, alike=alike)
            stamps = pd.to_datetime(_alike(texts) if alike else texts, format=pattern, utc=True)
        except (ValueError, OverflowError):
            continue
        return _since_first(stamps)
    return None


def _alike(texts: "pd.Series[Any]") -> "pd.Series[Any]":
    """Return stamps with a point and a fraction behind their seconds, and one blank between."""
    texts = texts.str.replace(r"(?<![T\s,])[T\s,]++(?=\d{1,2}:)", " ", regex=True)
    texts = texts.str.replace(r"(:\d{2}),(?=\d)", r"\1.", regex=True)
    return texts.str.replace(r"(:\d{2}:\d{2})(?![.\d:])", r"\1.0", regex=True)


def _pattern(texts: "pd.Series[Any]", found: re.Match[str], *, alike: bool) -> str:
    """Return the format of stamps, of which the first was found to be one, or of `_alike` ones."""
    mark = next(mark for mark in "-/." if mark in found["date"])
    parts = found["date"].split(mark)
    year = "%Y" if len(max(parts, key=len)) == 4 else "%y"
    if len(parts[0]) == 4:
        order = [year, "%m", "%d"]
    else:
        day_first = mark != "/" or bool(
            (texts.str.extract(r"^(\d+)")[0].astype(int) > 12).any()  # no month
        )
        order = [*(["%d", "%m"] if day_first else ["%m", "%d"]), year]
    clock = "%I" if found["half"] else "%H"
    fraction = re.search(r"[.,](?=\d)", found["clock"])
    point = "." if alike else fraction[0] if fraction else ""
    seconds = f":%S{point}{'%f' * bool(point)}" if found["clock"].count(":") > 1 else ""
    between = " " if alike else found[0][found.end("date") : found.start("clock")]
    before_zone = found[0][found.end("clock") : found.start("zone")] if found["zone"] else ""
    half = f"{' ' if ' ' in found['clock'] else ''}%p" if found["half"] else ""
    zone = f"{before_zone}%z" if found["zone"] else ""
    return f"{mark.join(order)}{between}{clock}:%M{seconds}{half}{zone}"


def _since_first(stamps: "pd.Series[Any]") -> NDArray[np.float64]:
    elapsed = stamps - stamps.dropna().iloc[0]
    return np.array(elapsed.dt.total_seconds(), dtype=float)


def _of_day(texts: "pd.Series[Any]") -> NDArray[np.float64] | None:
    """Return times of day as seconds since midnight, on over the next one."""
    import pandas as pd

    stamps = pd.to_timedelta(texts.where(texts.str.count(":") != 1, texts + ":00"), errors="coerce")
    if stamps[texts.notna()].isna().any():
        return None
    times = np.array(stamps.dt.total_seconds(), dtype=float)
    there = np.flatnonzero(np.isfinite(times))
    days = np.cumsum(np.diff(times[there], prepend=times[there[0]]) < -HALF)
    times[there] += DAY * days
    return times


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
