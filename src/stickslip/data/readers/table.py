"""What a reader of a file format returns, and errors of files that are damaged."""

import io
import json
import re
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import pandas as pd

from stickslip.data.tolerances import MOST_LISTED
from stickslip.errors import InputError, check_columns, check_size
from stickslip.show.documents import regular_bytes
from stickslip.show.formatting import count, joined
from stickslip.units import shown

FEWER_COLUMNS: Final = "split the file, or give fewer columns"
FEWER_CHANNELS: Final = "split the file, or save fewer channels"
"""What cures a table that is too large."""
_SURROGATE: Final = re.compile(rb"\\u[dD][89a-fA-F]")
TRIAL: Final = "trial"
"""Column that numbers or names trials."""
TIME: Final = "time [s]"
"""Column of times that a reader makes."""


@dataclass(frozen=True, kw_only=True)
class FileTable:
    """The columns of a file, their names as they stand there."""

    data: pd.DataFrame
    """One row per sample or trial; a header may carry its unit in brackets."""
    first_row: int = 1
    """Line of the first row in the file, or 1 where there are no lines."""
    remarks: tuple[str, ...] = ()
    """What was decided in reading and a user should know, one sentence each."""
    lost: tuple[str, ...] = ()
    """What the file says that it holds, or holds, and the table has not; one sentence each."""
    rates: Mapping[str, str] = field(default_factory=dict)
    """Rates of the rows that the file states, and where."""
    doubted: bool = False
    """Whether texts are numbers whose mark may be decimal or part thousands."""


def numbered_twice(names: Sequence[str]) -> list[str]:
    """Return names of which those that come again have a number behind them.

    Examples
    --------
    >>> numbered_twice(["x", "F", "x"])
    ['x', 'F', 'x (2)']
    """
    seen: Counter[str] = Counter()
    result = []
    for name in names:
        seen[name] += 1
        result.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return result


def left_out(names: Sequence[str], what: str = "another number of values") -> list[str]:
    """Return that columns are not read, as they have other times than those that are.

    Examples
    --------
    >>> left_out(["state.q"]), left_out([])
    (["Not read, as it has another number of values: 'state.q'."], [])
    """
    if not names:
        return []
    they = "it has" if len(names) == 1 else "they have"
    return [f"Not read, as {they} {what}: {joined([*map(shown, names)], MOST_LISTED)}."]


def further_cells(rows: int, width: int) -> list[str]:
    """Return that rows have cells for which there are no names.

    Examples
    --------
    >>> further_cells(2, 3), further_cells(0, 3)
    (['2 rows have more cells than the header has names, 3: the further ones are not read.'], [])
    """
    if not rows:
        return []
    have = "has" if rows == 1 else "have"
    return [
        f"{count(rows, 'row')} {have} more cells than the header has names, {width}: the further"
        " ones are not read."
    ]


def read_of(what: str, wanted: str, others: Sequence[str], why: str = "") -> list[str]:
    """Return which part of a file is read and which are not.

    Examples
    --------
    >>> read_of("sheet", "data", ["notes"]), read_of("sheet", "data", [])
    (["The sheet 'data' is read; 'notes' is not."], [])
    """
    if not others:
        return []
    are = "is" if len(others) == 1 else "are"
    return [
        f"The {what} {shown(wanted)} is read; {joined(list(map(shown, others)))}{why} {are} not."
    ]


def no_channel(path: Path) -> InputError:
    """Return the error of a file without a channel that could be read."""
    return InputError(f"{path}: contains no channel of numbers.")


def times_in(column: "pd.Series[Any]", channel: str) -> "pd.Series[float]":
    """Return the times of a channel as numbers, or say which cell is none.

    Examples
    --------
    >>> times_in(pd.Series(["0", "zehn"]), "Weg")
    Traceback (most recent call last):
    stickslip.errors.InputError: 'zehn' is not a time of the channel 'Weg'.
    """
    times = pd.to_numeric(column, errors="coerce").astype(float)
    if times.isna().any():
        wrong = column[times.isna()].iloc[0]
        raise InputError(f"{shown(wrong)} is not a time of the channel {shown(channel)}.")
    return times


def merged(tables: Sequence[pd.DataFrame]) -> tuple[pd.DataFrame, bool]:
    """Return tables by time as one with a column of times, and whether all have the same times.

    Where they have not, cells are empty.

    Examples
    --------
    >>> one = pd.DataFrame({"a": [1.0]}, index=pd.Index([0.0], name="t"))
    >>> merged([one, one.rename(columns={"a": "b"})])[0].to_dict("list")
    {'t': [0.0], 'a': [1.0], 'b': [1.0]}
    """
    if all(table.index.equals(tables[0].index) for table in tables):
        return pd.concat(tables, axis=1).reset_index(), True
    moments = sum(len(table) for table in tables)  # they may have none in common
    columns = sum(table.shape[1] for table in tables)
    check_size("the merged table", float(moments * columns), "give fewer channels")
    once = [table[~table.index.duplicated()] for table in tables]
    return pd.concat(once, axis=1).sort_index().reset_index(), False


def rows_of(lines: Sequence[str], separator: str, width: int, decimal: str = "") -> pd.DataFrame:
    """Return rows of cells as numbers, by the places of their columns; a blank cell is empty.

    The decimal mark is a comma where commas are in the rows and do not part cells, if nobody says.

    Examples
    --------
    >>> rows_of(["0;0,5", "1; "], ";", 2).fillna(-1.0).to_dict("list")
    {0: [0, 1], 1: [0.5, -1.0]}
    """
    commas = separator != "," and any("," in line for line in lines)
    check_columns("the table", width)
    check_size("the table", float(width * len(lines)), FEWER_COLUMNS)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            return pd.read_csv(
                io.StringIO("\n".join(lines)),
                sep=separator,
                decimal=decimal or ("," if commas else "."),
                header=None,
                names=list(range(width)),
                index_col=False,
                na_values=[" "],
                low_memory=False,
            )
    except (pd.errors.ParserError, pd.errors.ParserWarning, ValueError) as error:
        raise unequal_rows(error) from None


def unequal_rows(error: Exception) -> InputError:
    """Return the error of a text whose rows have not as many cells each, from that of pandas."""
    # What stands before it names the parser's language and nothing in the file.
    reason = str(error).strip().splitlines()[0].rpartition("error: ")[2].rstrip(".")
    return InputError(f"has rows of different lengths ({reason}).")


def json_of(data: bytes) -> Any:
    """Return what a text of JSON says, or raise ValueError: half a character is no text.

    Examples
    --------
    >>> json_of(b'{"x": 1}')
    {'x': 1}
    """
    result = json.loads(data)
    if _SURROGATE.search(data):
        json.dumps(result, ensure_ascii=False).encode("utf-8")
    return result


def one_line(error: Exception) -> str:
    r"""Return what an error of somebody else says, in a line without a full stop.

    Examples
    --------
    >>> one_line(ValueError("no end.\nmore")), one_line(KeyError())
    ('no end', 'KeyError')
    """
    return (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")


@contextmanager
def parsed_as(path: Path, kind: str) -> Iterator[None]:
    """Say of a file that a library stumbles over, with whatever error, that it is not of a kind."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        raise InputError(f"{path}: is not {kind}, or is damaged: {one_line(error)}.") from None


def read_json(path: Path) -> Any:
    """Return what a file holds, or say that it is damaged."""
    try:
        return json_of(regular_bytes(path))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: is not JSON, or is damaged: {error}.") from None
