"""Times of day, and dates with them, as seconds."""

import re
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

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
    texts = column.astype("string").str.strip()
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
    texts = texts.str.replace(r"[T\s,]+(?=\d{1,2}:)", " ", regex=True)
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
