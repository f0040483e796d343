"""How a text file holds its table: code page, separators, what stands above the rows, its times.

Times of day and dates become seconds; they are repaired on request only.
"""

import csv
import functools
import itertools
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from stickslip.data.measurement import Array
from stickslip.data.readers.toml import read_bytes
from stickslip.data.tolerances import FEWEST_SAMPLES, HALF, LONGEST_LINE, NEARLY_ALL, PER_MILLE
from stickslip.data.units import read_number
from stickslip.errors import InputError, UnknownNameError, concerning
from stickslip.quantities import Quantity
from stickslip.show.described import Described
from stickslip.show.formatting import count, quantity
from stickslip.units import is_of, is_unit, split_number

if TYPE_CHECKING:
    import pandas as pd


# Times of samples: times of day and dates as seconds, and their repair, on request only.

DAY: Final = 86_400.0
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
    result = _STAMP.fullmatch(there.iloc[0]) if len(there) else None
    if result is None:
        return None
    if not result["date"]:
        return _of_day(texts.str.replace(",", ".", regex=False))
    # One pattern for all is parsed a hundred times faster than each by its own, and that of the
    # first as it stands spares the time of making all alike, which is longer.
    for alike in (False, True):
        try:
            pattern = _pattern(there, result, alike=alike)
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
    # one that falls by more than half a day has passed midnight
    days = np.cumsum(np.diff(times[there], prepend=times[there[0]]) < -DAY / 2)
    times[there] += DAY * days
    return times


# Rows that follow each other at a rate, where no column has their times; lines that state one.

_SAMPLES: Final = (
    "(?:sampl(?:e|es|ing)|scan|acquisition|acq|daq|data|record(?:ing)?|logging|frame|capture"
    "|abtast|mess|aufzeichnungs)"
)
_STATED: Final = re.compile(
    rf"""(?:(?<![^\W\d_])(?:
          (?P<rate>{_SAMPLES}[ _-]*(?:rate|freq|frequency|frequenz)|samples?[ ]*(?:per|/)[ ]*s\w*
            |sampled[ ]+(?:at|with))
          |(?:sampl(?:e|ing)|scan|time|abtast|mess|zeit)[ _-]*
            (?:period|intervall?|step|schritt(?:weite)?|increment|inkrement|spacing)
          |sample[ _-]?time|abtastzeit)
        |(?:^|[,;|\t])[^\w,;|\t]*(?:(?P<short>rate|f_?s)|dt|δt|delta[ _]?t|t_?s))(?![^\W_])
        (?:\s*[\[(<{{]\s*(?P<unit>[^\[\]()<>{{}}]*?)\s*[\])>}}])?
        [\s:=,;|"]*(?P<number>\.?\d[\d.,]*(?:e[+-]?\d+)?)(?<![.,])(?![:\d])""",
    re.VERBOSE | re.IGNORECASE,
)
"""Words that say how rows follow each other, and a number; short ones begin a line or a cell."""
_BEHIND: Final = re.compile(r'(?P<cell>["\s]*[,;|\t]["\s]*)?\s*(?P<unit>[^\W\d_][^\s,;|"]*|1/s)')
_HERTZ: Final = re.compile(r"([kM]?)(?:hz|sps|sa?/s|samples?/s(?:ec)?|fps|1/s)", re.IGNORECASE)


def regular_times(rate: object, rows: int) -> Array | None:
    """Return times (rows,) [s] of rows at a rate, or a step apart; None if a text is no such.

    Examples
    --------
    >>> regular_times("50 Hz", 3).tolist(), regular_times("0.5 ms", 2).tolist()
    ([0.0, 0.02, 0.04], [0.0, 0.0005])
    >>> regular_times("t", 3), regular_times("50", 3), regular_times("50 mm", 3)
    (None, None, None)
    """
    result = split_number(rate)
    unit = result["unit"] if result else None
    with concerning("columns.time"):
        if unit and is_of(unit, "Hz"):
            return np.arange(rows, dtype=float) / read_number(rate, Quantity("f", "Hz", above=0.0))
        if unit and is_of(unit, "s"):
            return np.arange(rows, dtype=float) * read_number(
                rate, Quantity("Delta t", "s", above=0.0)
            )
    return None


def stated_rates(lines: Sequence[str], layout: "Layout") -> dict[str, str]:
    """Return the rates that lines above a header state, and what each says.

    Examples
    --------
    >>> stated_rates(["Rig 3", "# Abtastrate: 0,5 kHz"], Layout(separator=";", decimal=","))
    {'0.5 kHz': "as line 2 states: 'Abtastrate: 0,5 kHz'"}
    >>> stated_rates(["dt [ms],2,gain,5", "baud rate: 115200", "frequency: 5 Hz"], Layout())
    {'2 ms': "as line 1 states: 'dt [ms] 2'"}
    """
    result: dict[float, tuple[str, str]] = {}
    for place, line in enumerate(lines, 1):
        cells = cells_of(line, ",") if layout.separator == "," else []
        text = "\t".join(cells) if cells and not re.search(r"\d", cells[0]) else line
        for hit in _STATED.finditer(text):
            rate, end = _stated_rate(hit, layout.decimal)
            step = regular_times(rate, 2)
            if step is not None:
                said = " ".join(text[hit.start() : end].strip(' \t,;|"#%').split())
                why = f"as line {place} states: {said!r}"
                result.setdefault(float(f"{step[1]:.6g}"), (rate, why))
    return dict(result.values())


def _stated_rate(hit: re.Match[str], decimal: str) -> tuple[str, int]:
    """Return a rate or a step with its unit, and where it ends; empty if the unit is another one.

    A unit stands in brackets before the number, or behind it; without any, it is of SI.
    """
    base = "Hz" if hit["rate"] or hit["short"] else "s"
    behind = _BEHIND.match(hit.string, hit.end())
    own = _unit_of_rate(behind["unit"], base) if behind else ""
    if hit["unit"] is not None or (behind and not behind["cell"]):
        unit = own or _unit_of_rate(hit["unit"] or "", base)
    else:
        unit = own or base
    other, text = "," if decimal == "." else ".", hit["number"]
    if re.fullmatch(rf"[1-9]\d{{0,2}}(?:\{other}\d{{3}})+(?:\{decimal}\d+)?", text):
        text = text.replace(other, "")
    text = text.replace(",", ".")
    fits = unit and text.count(".") < 2 and float(text) > 0.0
    return f"{text} {unit}" if fits else "", behind.end() if own and behind else hit.end()


def _unit_of_rate(unit: str, base: str) -> str:
    """Return a unit as the package spells it; empty if it is not of the kind of the base."""
    if base == "s":
        return unit if unit and is_of(unit, "s") else ""
    result = _HERTZ.fullmatch(unit)
    return f"{result[1].replace('K', 'k')}Hz" if result and unit[:1] != "m" else ""


Repair: TypeAlias = Literal["sort", "gaps", "hold"]
"""What can be repaired: ``"sort"`` the samples by time and drop doubles, drop ``"gaps"``, and
``"hold"`` what drives until its next value."""
DRIVES: Final = ("force", "current", "voltage", "reference")
"""Quantities that may be commands, which hold until the next."""


def repairs(given: str | Sequence[str] | None) -> tuple[Repair, ...]:
    """Return the repairs asked for: what is held has no gaps, and times must be there to be sorted.

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
    result, done = dict(columns), []
    how = {"hold": _held, "gaps": _without_gaps, "sort": _sorted}
    for step in steps:
        result, remarks = how[step](result)
        done += remarks
    return result, tuple(done)


def _held(columns: dict[str, Array]) -> tuple[dict[str, Array], list[str]]:
    """Return columns of which those that drive keep their last value where cells are empty."""
    result, filled = dict(columns), 0
    for name, values in columns.items():
        if name.partition(".")[0] in DRIVES:
            there = np.isfinite(values)
            last = np.maximum.accumulate(np.where(there, np.arange(values.size), 0))
            result[name] = values[last]
            filled += int(np.count_nonzero(np.isfinite(result[name]) & ~there))
    return result, [f"held the last value in {count(filled, 'empty cell')}"] if filled else []


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
    usual = (
        steps[steps > PER_MILLE * np.quantile(steps, NEARLY_ALL, method="lower")]
        if steps.size
        else steps
    )
    return PER_MILLE * float(np.median(usual)) if usual.size else 0.0


Separator: TypeAlias = Literal[";", "\t", ",", "|", " "]
Decimal: TypeAlias = Literal[".", ","]
SEPARATORS: Final[tuple[Separator, ...]] = get_args(Separator)
"""Marks between cells, the surest first: commas also stand in numbers, and blanks in names."""
MARKS: Final = {";": "semicolons", ",": "commas", "\t": "tabs", "|": "bars", " ": "blanks"}
"""What they are called."""
LOOKED_AT: Final = 400
"""Lines at the top among which header and rows are sought."""
CODE_PAGES: Final = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
MISSING: Final = ("", "nan", "inf", "+inf", "-inf", "na", "n/a", "null", "none", "true", "false")
"""Words of cells, in any case, that stand for a number that is missing, or for none."""
BRACKETS: Final = ("[]", "()", "<>", "{}")
NO_UNIT: Final = ("-", "\N{EN DASH}", "\N{MINUS SIGN}", "1")
"""What stands in a header for the unit of a pure number."""
_NUMBER: Final = re.compile(
    r"""[+-]?(?:\d+(?:[.'\ \u2019\u00a0\u202f]\d{3})*(?:[.,]\d*)?   # 12, 0,5, 1.592,0
        |\d{1,3}(?:,\d{3})+(?:\.\d*)?                               # 1,592.0
        |[.,]\d+)(?:[eE][+-]?\d+)?""",
    re.VERBOSE,
)
DOUBTED: Final = re.compile(
    rf"""\s*(?P<value>{_NUMBER.pattern})
        (?:\s*(?:±|\+/?[-−])\s*(?P<doubt>{_NUMBER.pattern})|\((?P<digits>\d+)\))?\s*""",
    re.VERBOSE,
)
"""A number, perhaps with its uncertainty: 3.51 ± 0.1, 3,51 +- 0,1, or 3.51(10) in last digits."""
_BLANKS: Final = "'\u2019 \u00a0\u202f"
_BLANK_CELLS: Final = re.compile(
    r"[^\W\d][^\s\[\](]*+(?:[ \t]*(?:\[[^\[\]]*+\]|\([^()]*+\)))++(?!\S)|\S++"
)
"""Cells between blanks: a name takes the brackets behind it, as in Torque [N m], with it."""
_GROUPS: Final = r"[+-]?[1-9]\d{{0,2}}(?:\{}\d{{3}})+"
"""A whole number with a mark between thousands, to be put in."""
_DECIMAL: Final = r"(?:0\{0}\d+|\d+\{0}(?:\d{{1,2}}|\d{{4,}}))"
"""Numbers in which a mark is a decimal one."""
_LONE: Final = re.compile(r"(?![+-]?[1-9]\d{0,2},\d{3}$)[^.,]*,[^.,]*")
"""A number with a comma that does not part thousands."""
_THOUSANDS: Final = {
    ",": re.compile(rf"(?<![.{_BLANKS}]\d\d)\d([.{_BLANKS}])\d{{3}}(?:\1\d{{3}})*+,\d"),
    ".": re.compile(rf"(?<![,{_BLANKS}]\d\d)\d([,{_BLANKS}])\d{{3}}(?:\1\d{{3}})*+\.\d"),
}
"""By decimal mark: a number that has both this and a mark between thousands, from its first one."""


@dataclass(frozen=True, kw_only=True)
class Layout(metaclass=Described):
    """How a text file holds its table, as `guess_data` finds it and `load_measurement` takes it.

    Examples
    --------
    >>> Layout(separator=";", decimal=",", preface=3, units_row=True).decimal
    ','
    """

    encoding: str = "utf-8-sig"
    """Code page, such as ``"cp1252"`` of older programs under Windows."""
    separator: Separator = ","
    """What stands between cells; a blank stands for any number of blanks and tabs."""
    decimal: Decimal = "."
    """Decimal mark, a point or a comma."""
    thousands: str = ""
    """Mark between thousands; empty if there is none."""
    preface: int = 0
    """Number of lines above the header, comments and empty lines included."""
    units_row: bool = False
    """Whether the row below the header holds the units of the columns."""

    def __post_init__(self) -> None:
        """Check all; a wrong mark would make text of numbers."""
        for name, allowed in (("separator", SEPARATORS), ("decimal", get_args(Decimal))):
            given = getattr(self, name)
            if given not in allowed:
                listed = ", ".join(map(repr, allowed))
                raise InputError(f"layout.{name} must be one of {listed}, got {given!r}.")
        if len(self.thousands) > 1 or (self.thousands and self.thousands == self.decimal):
            raise InputError(
                "layout.thousands must be one character other than the decimal mark, got"
                f" {self.thousands!r}."
            )
        lines: object = self.preface
        if not isinstance(lines, int) or isinstance(lines, bool) or lines < 0:
            raise InputError(f"layout.preface must be a number of lines, got {self.preface!r}.")
        try:
            "".encode(self.encoding)
        except LookupError:
            raise InputError(
                f"layout.encoding must be a code page such as utf-8 or cp1252, got"
                f" {self.encoding!r}."
            ) from None


@dataclass(frozen=True, kw_only=True)
class Text:
    """The upper lines of a file as cells."""

    layout: Layout
    """How the file holds its table."""
    names: tuple[str, ...]
    """Names of the columns as they stand in the header."""
    units: tuple[str, ...]
    """Units of the columns, from a row below the header; empty where there is none."""
    assumed: str
    """A number with a mark of which it is only assumed what it parts; empty if none has."""
    rivals: tuple[int, ...]
    """Lines, counted from 0, that may as well be the header: names, or what describes them."""


def bytes_of(path: Path) -> bytes:
    """Return what a text file holds, its lines ended by line feeds."""
    data = read_bytes(path)
    return data if b"\n" in data else data.replace(b"\r", b"\n")


def decoded(data: bytes) -> tuple[str, str]:
    """Return a text and its code page.

    Examples
    --------
    >>> decoded("µm".encode("cp1252")), decoded("µm".encode("utf-16"))
    (('µm', 'cp1252'), ('µm', 'utf-16'))
    """
    encoding = next((name for mark, name in CODE_PAGES.items() if data.startswith(mark)), "")
    if not encoding and b"\0" in data[:LOOKED_AT]:
        even, odd = (data[start:LOOKED_AT:2].count(0) for start in (0, 1))
        if min(even, odd) == 0 and max(even, odd) > LOOKED_AT / 8:
            encoding = "utf-16-be" if even else "utf-16-le"
    for name in [encoding] if encoding else ["utf-8-sig", "cp1252"]:
        try:
            return data.decode(name), name
        except UnicodeDecodeError:
            continue
    return data.decode(encoding or "cp1252", errors="replace"), encoding or "cp1252"


def cells_of(line: str, separator: str) -> list[str]:
    """Return the cells of a line, quotes removed."""
    return [cell.strip() for cell in bare_cells(line, separator, skipinitialspace=True)]


def bare_cells(line: str, separator: str, *, skipinitialspace: bool = False) -> list[str]:
    """Return the cells of a line as they stand; one beyond what `csv` takes is cut."""
    if separator == " ":  # a header may be marked as a comment
        return [cell[0] for cell in _BLANK_CELLS.finditer(line.lstrip("#% \t"))]
    try:
        result = csv.reader([line], delimiter=separator, skipinitialspace=skipinitialspace)
        return next(result, [])
    except csv.Error:
        return [cell[:LONGEST_LINE] for cell in line.split(separator)]


def is_number(cell: str) -> bool:
    """Whether a cell holds a number, with either decimal mark and perhaps marks between thousands.

    Examples
    --------
    >>> [is_number(cell) for cell in ("0,5", "1.592,0", "12 000", "1e-3", "Weg", "1;2")]
    [True, True, True, True, False, False]
    """
    return _NUMBER.fullmatch(cell) is not None


def doubted_parts(cell: str) -> list[str]:
    """Return a number and its uncertainty as they stand in a cell; nothing if it has none.

    Examples
    --------
    >>> [doubted_parts(cell) for cell in ("3,51 ± 0,1", "3.51+/-0.1", "3.51(10)", "3.51")]
    [['3,51', '0,1'], ['3.51', '0.1'], ['3.51', '10'], []]
    """
    result = DOUBTED.fullmatch(cell)
    doubt = result and (result["doubt"] or result["digits"])
    return [result["value"], doubt] if result and doubt else []


def layout_of(text: str, encoding: str) -> Text | None:
    r"""Return how a text holds its table; None if it has no header above rows of numbers.

    Examples
    --------
    >>> found = layout_of("Zeit;Weg\ns;mm\n0,0;1,5\n0,1;1,6\n", "utf-8-sig")
    >>> found.layout.decimal, found.layout.units_row, found.names, found.units
    (',', True, ('Zeit', 'Weg'), ('s', 'mm'))
    """
    lines = upper_lines(text)
    for width, first, separator in _tables(lines):
        table = _table(text, encoding, lines, first, width, separator)
        if table is not None:
            return table
    return None


def _tables(lines: Sequence[str]) -> Iterator[tuple[int, int, Separator]]:
    """Yield how many cells rows of numbers have, the first line of these, and the mark between.

    The mark that leaves fewest words beside numbers, and then makes most cells, parts them.
    """
    result = sorted(
        (
            (*rows, -place, mark)
            for place, mark in enumerate(SEPARATORS)
            if not place or any(mark in line for line in lines)
            for rows in _rows(lines, mark)
        ),
        reverse=True,
    )
    yield from ((width, first, mark) for _, width, first, _, mark in result)


def without_names(text: str) -> str:
    r"""Return what a text lacks that has rows of numbers and no names above; empty if it has some.

    Examples
    --------
    >>> without_names("1 2 3\n4 5 6\n")
    'its first line holds numbers, ... names of the 3 columns, separated by blanks, such as ...'
    >>> without_names("t;x\n1;2\n3;4\n")
    ''
    """
    lines = upper_lines(text)
    width, first, mark = next(_tables(lines), (0, 0, ""))
    if (
        not mark
        or not any(map(str.strip, lines[first + 1 :]))
        or layout_of(text, "utf-8") is not None
    ):
        return ""
    columns = (
        f"names of the {width} columns, separated by {MARKS[mark]}, such as time and position"
        if width > 1
        else "name of the column"
    )
    if any(map(is_content, lines[:first])):
        return (
            f"its rows of numbers begin in line {first + 1}, and no line above has names for all"
            f" columns. Add a line above them with the {columns}"
        )
    return f"its first line holds numbers, not names. Add a first line with the {columns}"


def _table(
    text: str, encoding: str, lines: Sequence[str], first: int, width: int, separator: Separator
) -> Text | None:
    """Return the table whose rows begin at a line, if there is a header above it."""
    above = {index: cells_of(lines[index], separator) for index in range(first)}
    heads = [index for index, cells in above.items() if is_head(cells, width)]
    # A comment is a header where there is no other.
    heads = [index for index in heads if lines[index][0] != "#"] or heads
    if not heads:
        return None
    widths = {width, len(cells_of(lines[first], separator))}
    named = {index: _names_in(above[index]) for index in heads}
    rank = {
        index: (not widths.isdisjoint(_widths(above[index])), len(names), len({*names}))
        for index, names in named.items()
    }
    header, units = max(heads, key=lambda index: (rank[index], index)), tuple[str, ...]()
    for index, label in itertools.pairwise(heads):
        few = len(named[label]) < 2 * len(named[index])
        near = not any(map(str.strip, lines[index + 1 : label]))
        whole = len(named[index]) >= width and not are_units(above[index])
        share = HALF if whole else 1.0
        if near and few and are_units(above[label], len(named[index]), share):
            header, units, rank[label] = index, tuple(map(unit_in, above[label])), (False, 0, 0)
    rivals = tuple(index for index in heads if index != header and rank[index] >= rank[header])
    rows = tuple(tuple(cells_of(line, separator)) for line in lines[first:] if line.strip())
    names = _padded(cells_of(lines[header], separator), max(width, len(rows[0])))
    decimal, thousands, assumed = marks_of(text, rows, separator)
    return Text(
        layout=Layout(
            encoding=encoding,
            separator=separator,
            decimal=decimal,
            thousands=thousands,
            preface=header,
            units_row=bool(units),
        ),
        names=names,
        units=_padded(units, len(names)) if units else (),
        assumed=assumed,
        rivals=rivals,
    )


def upper_lines(text: str, first: int = 0) -> list[str]:
    r"""Return the upper lines from one on, cut by hand: a long file has more than anybody needs.

    Of comments and empty lines before them there may be any number.

    Examples
    --------
    >>> upper_lines("# rig 3\nt,x\n0,1\n", 1)
    ['t,x', '0,1']
    """
    result: list[str] = []
    position = line = counted = 0
    while position < len(text) and counted < LOOKED_AT:
        end = text.find("\n", position)
        end = len(text) if end < 0 else end
        if line >= first:
            cut = text[position : min(end, position + LONGEST_LINE)]
            result.append(cut.rstrip("\r").lstrip("\ufeff"))
            counted += bool(counted or is_content(result[-1]))
        position, line = end + 1, line + 1
    return result


def is_content(line: str) -> bool:
    """Whether a line is neither a comment nor empty.

    Examples
    --------
    >>> is_content("t,x"), is_content("# rig 3"), is_content("  ")
    (True, False, False)
    """
    return bool(line.strip()) and line[0] != "#"


def _rows(lines: Sequence[str], separator: str) -> Iterator[tuple[int, int, int]]:
    """Yield, if rows of numbers are separated by a mark, where they begin.

    That is the number of words among them, negative; the number of cells that are not empty at the
    end of all rows; the first line.
    """
    counted = functools.cache(lambda index: _counted(lines[index], separator))
    full = [index for index, line in enumerate(lines) if line.strip()]
    for place, index in enumerate(full):
        if not counted(index)[0]:
            continue
        following = [counted(i) for i in full[place : place + FEWEST_SAMPLES]]
        sizes = {size for size, _, _ in following}
        if len(sizes) == 1 and min(sizes) > 0:
            words = sum(words for _, _, words in following)
            yield -words, max(width for _, width, _ in following), index
            return


def _counted(line: str, separator: str) -> tuple[int, int, int]:
    """Return the numbers of cells, of those up to the last that is not empty, and of words.

    All are 0 unless most of the cells are numbers.
    """
    if not is_content(line):
        return 0, 0, 0
    cells = cells_of(line, separator)
    _, width = _widths(cells)
    numbers = sum(is_number(cell) or is_stamp(cell) or bool(doubted_parts(cell)) for cell in cells)
    words = sum(cell.casefold() not in MISSING for cell in cells) - numbers
    return (len(cells), width, words) if numbers > words else (0, 0, 0)


def _widths(cells: Sequence[str]) -> tuple[int, int]:
    """Return the numbers of cells, and of those up to the last that is not empty."""
    return len(cells), max((place for place, cell in enumerate(cells, 1) if cell), default=0)


def is_row(line: str, separator: str) -> bool:
    """Whether most cells of a line are numbers.

    Examples
    --------
    >>> is_row("0;0,5;start", ";"), is_row("Rate;100", ";")
    (True, False)
    """
    return _counted(line, separator)[0] > 0


def is_head(cells: Sequence[str], width: int = 1) -> bool:
    """Whether cells above rows of a width may be their names or their units: most are no numbers.

    Examples
    --------
    >>> is_head(["Zeit", "Weg", "2"]), is_head(["0", "0,5"]), is_head(["nan", "", "n/a"])
    (True, False, False)
    """
    there = sum(cell.casefold() not in MISSING for cell in cells)
    return len(cells) >= width and 2 * len(_names_in(cells)) > there


def _names_in(cells: Sequence[str]) -> list[str]:
    """Return the cells that are neither numbers nor times nor missing."""
    return [
        cell
        for cell in cells
        if cell in NO_UNIT or not (cell.casefold() in MISSING or is_number(cell) or is_stamp(cell))
    ]


def are_units(cells: Sequence[str], names: int = 1, share: float = 1.0) -> bool:
    """Whether cells hold units and nothing else: several, or for most of some names.

    With a `share` below 1, more than it are units, not all of one letter, which may be names.

    Examples
    --------
    >>> are_units(["s", "[mm]", ""], 3), are_units(["A", "", ""], 3), are_units(["t", "x"])
    (True, False, False)
    >>> are_units(["s", "rad", "rad.s"], 3, 0.5), are_units(["t", "F", "x"], 3, 0.5)
    (True, False)
    """
    named = [cell for cell in cells if cell]
    units = [
        cell
        for cell in named
        if cell[0] + cell[-1] in BRACKETS or unit_in(cell) in NO_UNIT or is_unit(unit_in(cell))
    ]
    enough = len(named) > 1 or 2 * len(named) > names
    odd = len(units) > share * len(named) and max(map(len, units)) > 1
    return enough and (len(units) == len(named) or odd)


def unit_in(cell: str) -> str:
    """Return the unit of a cell that holds nothing else, without the brackets around it.

    Examples
    --------
    >>> unit_in("[mm]"), unit_in("(1/min)"), unit_in("in mm"), unit_in("N")
    ('mm', '1/min', 'mm', 'N')
    >>> unit_in("mm (Position)")
    'mm'
    """
    unit, bracket, rest = cell.strip().partition(" (")  # and what is measured in it
    named = unit and bracket and rest.endswith(")")
    bare = (unit if named else cell).strip().strip("[]()<>{}").strip()
    return bare.removeprefix("in ") if bare != "in" else bare


def headed(name: str, label: str) -> str:
    """Return a name with the unit of its label in brackets, if that is one.

    Examples
    --------
    >>> headed("Weg", "in mm"), headed("Weg", "raw")
    ('Weg [mm]', 'Weg')
    """
    unit = unit_in(label)
    return f"{name} [{unit}]" if unit and is_unit(unit) else name


def _padded(cells: Sequence[str], width: int) -> tuple[str, ...]:
    return (*cells, *[""] * (width - len(cells)))


def marks_of(
    text: str, rows: Sequence[Sequence[str]], separator: str
) -> tuple[Literal[".", ","], str, str]:
    r"""Return the decimal mark, that between thousands, and a number for which it is only assumed.

    Examples
    --------
    >>> marks_of("0,5;1.592\n", [["0,5", "1.592"]], ";")
    (',', '.', '1.592')
    >>> marks_of("0.5;1,592\n", [["0.5", "1,592"]], ";")
    (',', '', '1,592')
    >>> marks_of("0.5;1,592\n0.6;0,9\n", [["0.5", "1,592"]], ";")
    (',', '', '')
    """
    decimal, thousands = _marks(text, rows, separator)
    # commas alone are decimal, but for those in quotes; beside numbers with points they may not be
    numbers = [cell for row in rows for cell in row if is_number(cell)]
    both = separator == "," or any("." in cell for cell in numbers)
    mark = "," if decimal == "," and both and not thousands else thousands
    grouped = [cell for cell in numbers if mark and mark in cell]
    sure = mark not in (".", ",") or not all(
        re.fullmatch(_GROUPS.format(mark), cell) and cell.count(mark) == 1 for cell in grouped
    )
    sure = sure or (mark == decimal and is_decimal(mark, text, separator))
    return decimal, thousands, "" if sure else next(iter(grouped), "")


def is_decimal(mark: str, text: str, separator: str) -> bool:
    r"""Whether a number anywhere in a text shows a mark to be decimal, as no 0,900 has thousands.

    Examples
    --------
    >>> is_decimal(",", "t;x\n0;1,592\n1;0,900\n", ";"), is_decimal(",", "t;x\n0;1,592\n", ";")
    (True, False)
    """
    number = _DECIMAL.format(mark)
    marks = ".,".replace(separator, "")
    alone = f'"{number}"' if mark == separator else rf"(?<![\d{marks}]){number}(?![\d{marks}])"
    return re.search(alone, text) is not None


def _marks(
    text: str, rows: Sequence[Sequence[str]], separator: str
) -> tuple[Literal[".", ","], str]:
    """Return the decimal mark and that between thousands.

    Marks between thousands are sought in the whole text: a number may pass a thousand late.
    """
    cells = [part for row in rows for cell in row for part in doubted_parts(cell) or [cell]]
    numbers = [cell for cell in cells if is_number(cell)]
    decimal: Literal[".", ","] = "."
    if separator == " " and any("." in cell for cell in numbers):
        return ".", ""
    if separator != "," or any('"' in line for line in upper_lines(text)[:LOOKED_AT]):
        marked = [cell for cell in numbers if separator != "," or "," in cell]
        grouped = all(re.fullmatch(_GROUPS.format(","), cell) for cell in marked)
        if separator == "," and grouped and any("." in cell for cell in numbers):
            return ".", _other_mark(numbers, ".")
        last = Counter(mark for cell in numbers for mark in _last_mark(cell))
        both = any("." in cell and "," in cell for cell in numbers)
        # A comma that parts no thousands is decimal: as text, numbers with points are read too.
        lone = separator != "," and any(map(_LONE.fullmatch, numbers))
        if last[","] and (both or lone or last[","] >= last["."]):
            decimal = ","
    other = "," if decimal == "." else "."
    several = separator != "," or '"' in text
    possible = [mark for mark in (other, *_BLANKS) if mark != separator and mark in text]
    result = _THOUSANDS[decimal].search(text) if several and possible else None
    if result and result[1] != separator:
        return decimal, result[1]
    blanks = [cell for cell in numbers if any(mark in cell for mark in _BLANKS)]
    if blanks:
        return decimal, next(mark for mark in _BLANKS if mark in blanks[0])
    return decimal, _other_mark(numbers, decimal)


def _last_mark(cell: str) -> Iterator[str]:
    marks = [mark for mark in cell if mark in ".,"]
    # One that comes twice parts thousands.
    if marks and marks.count(marks[-1]) == 1:
        yield marks[-1]


def _other_mark(numbers: Sequence[str], decimal: str) -> str:
    """Return the mark that is no decimal one but stands in whole numbers, such as 1.592.

    Where it stands elsewhere too, as in 0.15, a file has both decimal marks, and none is dropped.
    """
    other = "," if decimal == "." else "."
    result = [cell for cell in numbers if other in cell]
    whole = _GROUPS.format(other)
    return other if result and all(re.fullmatch(whole, cell) for cell in result) else ""
