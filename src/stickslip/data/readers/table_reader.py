"""Files of any format as columns by the quantity they hold, and conditions of trials in them."""

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from stickslip import errors
from stickslip.data.measurement import STATED, TRAVELS
from stickslip.data.readers import binary, csv_reader, robots
from stickslip.data.readers.bags import BAGS, MCAP, METADATA, PARTS, read_bag, read_mcap
from stickslip.data.readers.columns import (
    VOCABULARY,
    Column,
    is_half_width,
    stated_unit,
    without_unit,
)
from stickslip.data.readers.layout import Layout, regular_times, seconds_of, unit_in
from stickslip.data.readers.table import TRIAL, FileTable
from stickslip.data.readers.toml import check_file, check_path
from stickslip.data.readers.tracks import SEPARATOR, seconds
from stickslip.data.tolerances import SLIGHT
from stickslip.show.formatting import number
from stickslip.units import CELSIUS, converted, factor, is_pixel, shown, split_number

# The file formats that are read, each by one function: a new one is a file and an entry here.

TEXT: Final = (".csv", ".tsv", ".txt", ".dat", ".asc", ".lvm", ".log", ".prn")
"""Endings of text files, beside those that have none."""


@dataclass(frozen=True, kw_only=True)
class Format:
    """A format of data files."""

    endings: tuple[str, ...]
    """Endings of its files, in lower case, or the ends of their names."""
    read: Callable[[Path, Collection[str]], FileTable]
    """Reads a file; what it is told are the columns that are wanted by name."""
    streamed: bool = False
    """Whether a file may be of any size, because only parts of it are kept."""
    within: str = ""
    """Path of such a file in a folder that may be given instead."""
    beside: tuple[str, ...] = ()
    """Patterns of the files in that folder that hold the data."""


FORMATS: Final = (
    Format(endings=TEXT, read=lambda path, _: csv_reader.read_text(path)),
    Format(endings=binary.PARQUET, read=binary.read_parquet),
    Format(endings=(".mat",), read=binary.read_mat),
    Format(endings=binary.MDF, read=binary.read_mdf),
    Format(endings=binary.TDMS, read=binary.read_tdms),
    Format(endings=csv_reader.SPREADSHEET, read=csv_reader.read_spreadsheet),
    Format(endings=MCAP, read=read_mcap, streamed=True),
    Format(endings=BAGS, read=read_bag, streamed=True),
    Format(endings=(METADATA,), read=read_bag, within=METADATA, beside=PARTS),
    Format(
        endings=("info.json",),
        read=robots.read_lerobot,
        within=robots.INFO,
        beside=(robots.EPISODES,),
    ),
    Format(endings=(".json",), read=robots.read_servo),
)
"""Formats by the ends of the names of their files."""


def format_of(path: Path) -> Format | None:
    """Return the format of a file by its name; None if it is read by no function.

    Examples
    --------
    >>> format_of(Path("run.CSV")) is FORMATS[0], format_of(Path("rig.toml"))
    (True, None)
    """
    if is_text(path):
        return FORMATS[0]
    name = path.name.lower()
    return next((form for form in FORMATS if name.endswith(form.endings)), None)


def is_text(path: Path) -> bool:
    """Whether a file is read as text: by its ending, or as it has none.

    Examples
    --------
    >>> [is_text(Path(name)) for name in ("run.CSV", "log", "run_0.5mm", "run.mat", "info.json")]
    [True, True, True, False, False]
    """
    ending = path.suffix.lower()
    return ending in TEXT or not ending[1:2].isalpha()


def data_file(path: Path) -> Path:
    """Return the file to read of a folder that holds a log; a file as it is."""
    inside = (path / form.within for form in FORMATS if form.within)
    return next((file for file in inside if file.is_file()), path)


def log_name(path: Path) -> str:
    """Return what a file is called without its ending; a log in a folder is called like that.

    Examples
    --------
    >>> log_name(Path("run.csv")), log_name(Path("run_0.5mm")), log_name(Path("a/metadata.yaml"))
    ('run', 'run_0.5mm', 'a')
    """
    known = format_of(path)
    if known is None or not known.within:
        return path.stem if path.suffix[1:2].isalpha() else path.name
    return path.absolute().parents[len(Path(known.within).parts) - 1].name


def log_files(path: Path) -> list[Path]:
    """Return the files that hold what one stands for: several of a log in a folder."""
    file = data_file(path)
    known = format_of(file)
    if known is None or not known.within:
        return [file]
    folder = file.parents[len(Path(known.within).parts) - 1]
    return [file, *(place for pattern in known.beside for place in sorted(folder.glob(pattern)))]


# Columns of CSV, Parquet and MATLAB files, by the quantity they hold.

SECOND: Final = "position, second coordinate"
"""What the second column of a position in a plane is known by."""
TIMES: Final = ("t", "time")
"""Names of a column of times, in either case, where a position has none other."""
RUN: Final = frozenset({"t", "friction", "normal_force", "mode"})
"""Columns by which a file shows that a run of this package wrote it."""
STATES: Final = ({"x": "position", "v": "velocity"}, {"theta": "position", "omega": "velocity"})
"""What the states of one body are called there, on a line and about an axis."""
NO_UNIT = ("-", "\N{EN DASH}", "\N{MINUS SIGN}")
"""What stands in the brackets of a header for the unit of a pure number."""
_HEADER = re.compile(r"(?P<name>[^\[\]]*+)(?:\[(?P<unit>[^\[\]]*+)\])?+")
LONGEST_NAME: Final = 500
"""Characters of the name of a column at most: what is sought in names takes the square of them."""


_PART_OF_STAMP = re.compile(
    r"(?:(?P<stamp>.*?)[._/ ])?(?P<nano>n|nano)?(?:secs?|seconds?)", re.IGNORECASE
)
"""header.stamp.secs and header.stamp.nsecs, stamp_sec and stamp_nanosec."""


@dataclass(frozen=True, kw_only=True)
class QuantityTable:
    """A table whose columns are known by the quantities they hold."""

    file: str
    """Name of the file, for messages."""
    data: pd.DataFrame
    """The table, one row per sample or trial."""
    names: Mapping[str, str]
    """Quantity, parameter path, or the column's own name -> column in the data."""
    units: Mapping[str, str | None]
    """Unit by the same names; None where numbers are in SI."""
    first_row: int
    """Line of the first row in the file, or 1 where there are no lines."""
    remarks: tuple[str, ...] = ()
    """What the reader decided and a user should know."""
    lost: tuple[str, ...] = ()
    """What the file lacks."""
    rates: Mapping[str, str] = field(default_factory=dict)
    """Rates of the rows that the file states, and where."""

    def is_empty(self, name: str) -> bool:
        """Return whether no cell of a column holds anything, as of a channel that was off."""
        return bool(self.data[self.names[name]].isna().all())

    def as_headed(self) -> "QuantityTable":
        """Return the table with all columns known by their headers, as who names them does."""
        known = {header: name for name, header in _headers(self.file, self.data)[0].items()}
        own = {key: known[header] for key, header in self.names.items()}
        return replace(
            self,
            names={own[key]: header for key, header in self.names.items()},
            units={own[key]: unit for key, unit in self.units.items()},
        )

    def at_rate(self, rate: str) -> "QuantityTable":
        """Return the table with a column, called like a rate, of the times of its rows."""
        times = regular_times(rate, len(self.data))
        if times is None or rate in self.names:
            return self
        return replace(
            self,
            data=self.data.assign(**{rate: times}),
            names={**self.names, rate: rate},
            units={**self.units, rate: "s"},
        )

    def column(self, given: Column) -> Column:
        """Return the column, or the two of a position, that a name stands for."""
        if isinstance(given, str):
            return _known_column(self.file, given, self.names)
        first, second = (_known_column(self.file, name, self.names) for name in given)
        return first, second

    def line(self, row: int) -> str:
        """Return where a row stands in the file."""
        kind = "line" if self.first_row > 1 else "row"
        return f"{kind} {self.first_row + int(self.data.index[row])}"

    def place(self, name: str, row: int) -> str:
        """Return where a cell stands, for messages."""
        return f"{self.file}: column {self.names[name]!r}, {self.line(row)}"

    def numbers(self, name: str, target: str | None) -> NDArray[np.float64]:
        """Return a column (n,) as numbers in the target unit, or in SI."""
        return self.scaled(name, self.raw(name), target)

    def raw(
        self, name: str, *, holes: bool = False, repairable: bool = False
    ) -> NDArray[np.float64]:
        """Return a column (n,) as the numbers that stand there.

        All are finite, unless `holes` lets cells be empty, NaN or infinite. `repairable` says that
        the caller has an option that would.
        """
        column = self.data[self.names[name]]
        if name == "time" and not pd.api.types.is_numeric_dtype(column.dtype):
            column = _times(column)
        cells = pd.Series(np.nan, column.index) if _is_other(column) else column
        values = pd.to_numeric(cells, errors="coerce").to_numpy(dtype=float, na_value=np.nan)
        wrong = ~np.isfinite(values)
        if holes:  # what is a number or nothing at all may stay
            wrong &= column.notna().to_numpy() & np.isnan(values)
        bad = np.flatnonzero(wrong)
        if bad.size:
            first = csv_reader.culprit(column.iloc[bad].tolist())
            row, cell = int(bad[first]), column.iloc[bad].tolist()[first]
            got = "nothing" if pd.isna(cell) else shown(cell)
            hole = pd.isna(cell) or np.isinf(values[row])
            cure = ' To drop such samples, give repair="gaps".' if repairable and hole else ""
            raise errors.ParameterError(
                f"{self.place(name, row)}: must be a finite number, got {got}."
                f"{cure or csv_reader.grouped(cell)}"
            )
        return values

    def scaled(
        self, name: str, values: NDArray[np.float64], target: str | None
    ) -> NDArray[np.float64]:
        """Convert values of a column from its unit to the target unit, or to SI."""
        unit = self.units.get(name)
        if unit is None:
            return values
        try:
            if target == CELSIUS:
                return np.asarray(converted(values, unit, target))
            scale = factor(unit, target)
        except errors.ParameterError as error:
            cure = f'; give metres per pixel as gain={{"{name}": ...}}' if is_pixel(unit) else ""
            raise errors.ParameterError(
                f"{self.file}: column {self.names[name]!r} {error}{cure}."
            ) from None
        # Division by a whole number rounds once, so that 35 mm is the float 0.035.
        whole = round(1.0 / scale) if scale < 1.0 else 0
        return values / whole if whole and 1.0 / whole == scale else values * scale


def _times(column: "pd.Series[Any]") -> "pd.Series[Any]":
    """Return time stamps as seconds, and everything else as it is."""
    stamps = seconds_of(column)
    if stamps is not None:
        return pd.Series(stamps, index=column.index)
    # h:mm:ss:cc, as well as numbers
    return column.map(lambda cell: cell if seconds(cell) is None else seconds(cell))


def _is_other(column: "pd.Series[Any]") -> bool:
    """Whether a column holds neither real numbers nor text: others would convert to some."""
    kinds = pd.api.types
    if kinds.is_bool_dtype(column.dtype) or kinds.is_complex_dtype(column.dtype):
        return True
    return not any(
        check(column.dtype)
        for check in (kinds.is_numeric_dtype, kinds.is_string_dtype, kinds.is_object_dtype)
    )


def is_data_file(path: Path) -> bool:
    """Whether the ending of a file is one that is read as a measurement.

    Examples
    --------
    >>> is_data_file(Path("run.CSV")), is_data_file(Path("rig.toml"))
    (True, False)
    """
    file = data_file(path)
    return format_of(file) is not None and (bool(file.suffix) or file.is_file())


def read_frame(
    path: str | Path,
    *,
    columns: Mapping[str, Column],
    units: Mapping[str, str],
    layout: Layout | None = None,
    also: Collection[str] = (),
) -> QuantityTable:
    """Read a file and find out what its columns hold.

    `also` names columns that are wanted whatever they hold, of files that have more than a table.
    """
    check_path(path)
    path = data_file(Path(path))
    check_file(path)
    file = str(path)
    known = format_of(path)
    if known is None or not known.streamed:
        errors.check_size(
            file, path.stat().st_size, "split it", unit="bytes", most=16 * errors.MOST_NUMBERS
        )
    single = dict(_single(columns))
    if layout is not None and not is_text(path):
        raise errors.InputError(
            f"{file}: a layout is that of a text file, such as .csv: leave it out."
        )
    if known is None:
        *endings, last = (ending for form in FORMATS for ending in form.endings)
        raise errors.InputError(
            f"{file}: must be a {', '.join(endings)} or {last} file, got {path.suffix}. Save other"
            " spreadsheets as CSV."
        )
    named = dict.fromkeys((*single.values(), *also))
    wanted = [name for name in named if regular_times(name, 1) is None]
    table = known.read(path, wanted) if layout is None else csv_reader.read_text(path, layout)
    data, signs = robots.with_signs(table.data)
    return frame_of(
        data,
        file,
        columns=single,
        units=units,
        first_row=table.first_row,
        remarks=(*table.remarks, *signs),
        lost=table.lost,
        rates=table.rates,
    )


def frame_of(
    data: pd.DataFrame,
    file: str,
    *,
    columns: Mapping[str, Column],
    units: Mapping[str, str],
    first_row: int = 1,
    remarks: Sequence[str] = (),
    lost: Sequence[str] = (),
    rates: Mapping[str, str] | None = None,
) -> QuantityTable:
    """Find out what the columns of a table hold; times may be a rate instead of a column."""
    if data.empty:
        raise errors.InputError(f"{file}: has no rows.")
    errors.check_columns(file, len(data.columns))
    longest = max(map(str, data.columns), key=len, default="")
    if len(longest) > LONGEST_NAME:
        raise errors.InputError(
            f"{file}: the name of a column, {shown(longest)}, has {len(longest):,} characters; it"
            f" may have {LONGEST_NAME}."
        )
    single = dict(_single(columns))
    times = regular_times(single.get("time"), len(data))
    if times is not None and single["time"] not in data.columns:
        data = data.assign(**{single["time"]: times})
    stated = single.get(STATED, "")
    constant = split_number(stated)
    if constant is not None and not is_half_width(stated) and stated not in data.columns:
        header = f"{stated} [{constant['unit'] or ''}]"
        data = data.assign(**{header: float(constant["number"])})
    found = _named(file, data, first_row, single, units)
    return replace(found, remarks=tuple(remarks), lost=tuple(lost), rates=rates or {})


def _single(columns: Mapping[str, Column]) -> Iterator[tuple[str, str]]:
    """Yield each column with what it is known by."""
    for quantity, column in columns.items():
        if isinstance(column, str):
            yield quantity, column
        else:
            yield from zip((quantity, SECOND), column, strict=True)


def _named(
    file: str,
    data: pd.DataFrame,
    first_row: int,
    columns: Mapping[str, str],
    units: Mapping[str, str],
) -> QuantityTable:
    names, found_units = _headers(file, data)
    data = data.set_axis(list(map(str, data.columns)), axis=1)
    own, own_units = dict(names), dict(found_units)
    for name, (parts, stamp) in _joined_stamps(data, names).items():
        for part in parts:  # still known to whoever names them
            del names[part], found_units[part]
        names[name] = own[name] = name
        found_units[name] = own_units[name] = "s"
        data = data.assign(**{name: stamp})
    unread = [name for name, column in columns.items() if not column]
    for quantity in unread:
        names.pop(quantity, None)
        found_units.pop(quantity, None)
    columns = {name: column for name, column in columns.items() if column}
    # A mapped column is known by its quantity alone, so none is used twice.
    for column in columns.values():
        key = _known_column(file, column, own)
        names.pop(key, None)
        found_units.pop(key, None)
    for quantity, column in columns.items():
        key = _known_column(file, column, own)
        names[quantity] = own[key]
        of = "position" if quantity == SECOND else quantity
        found_units[quantity] = own_units[key] or stated_unit(own[key], of)
    _recognise(names, found_units, of_run=not columns and names.keys() >= RUN)
    for name, unit in units.items():
        if name not in names:
            known = [label for label in names if label != SECOND]
            raise errors.UnknownNameError(f"column in units of {file}:", name, known)
        found_units[name] = "1" if unit in NO_UNIT else unit
    _called_plainly(names, found_units, unread)
    if SECOND in names:
        _check_plane(file, names, found_units, "position" in units)
    return QuantityTable(file=file, data=data, names=names, units=found_units, first_row=first_row)


def _called_plainly(
    names: dict[str, str], units: dict[str, str | None], unread: Collection[str]
) -> None:
    """Call what a record in time, or a table of friction, has under other plain names.

    A speed has no sign: beside positions it is no velocity.
    """
    if not {"time", "friction"} & names.keys() or {*TRAVELS} & names.keys():
        return
    for quantity, meaning in VOCABULARY.items():
        word = next((word for word in meaning.plain if word in names), "")
        signed = word != "speed" or "position" not in names
        if word and signed and quantity not in (*names, *unread):
            names[quantity], units[quantity] = names.pop(word), units.pop(word)


def _recognise(names: dict[str, str], units: dict[str, str | None], *, of_run: bool) -> None:
    """Call the states of a run, and what stands beside others, by their quantities."""
    beside = f"{without_unit(names.get('friction', ''))}_uncertainty"
    if beside in names:  # of cells such as 3.51 ± 0.1
        names.setdefault(STATED, names.pop(beside))
        units.setdefault(STATED, units.pop(beside))
    states = next((state for state in STATES if of_run and state.keys() <= names.keys()), {})
    for word, quantity in states.items():
        names[quantity], units[quantity] = names.pop(word), units.pop(word)
    key = next((name for name in names if name.casefold() in TIMES), "")
    if key and "position" in names and "time" not in names:
        names["time"], units["time"] = names.pop(key), units.pop(key)


def _headers(file: str, data: pd.DataFrame) -> tuple[dict[str, str], dict[str, str | None]]:
    """Return the header of each column by its name, and its unit if brackets hold one."""
    names: dict[str, str] = {}
    found_units: dict[str, str | None] = {}
    for header in map(str, data.columns):
        match = _HEADER.fullmatch(header.strip())
        name, unit = (match["name"].rstrip(), match["unit"]) if match else (header, None)
        if unit and unit.isdigit() and f"{name}[{unit}]" in header:  # position[0]: an index
            name, unit = header, None
        if name in names:
            raise csv_reader.ambiguous(file, name)
        names[name] = header
        found_units[name] = "1" if unit in NO_UNIT else unit and (unit_in(unit) or None)
    return names, found_units


def _joined_stamps(
    data: pd.DataFrame, names: Mapping[str, str]
) -> dict[str, tuple[Sequence[str], NDArray[np.float64]]]:
    """Return times [s] of which two columns hold seconds and nanoseconds, as in ROS, and these two.

    Times count from the first whole second, so that no digit is lost.
    """
    found: dict[str, tuple[Sequence[str], NDArray[np.float64]]] = {}
    parts = {name: match for name in names if (match := _PART_OF_STAMP.fullmatch(name))}
    for fine, match in parts.items():
        both = [name for name, other in parts.items() if other["stamp"] == match["stamp"]]
        stamp = match["stamp"] or "stamp"
        if not match["nano"] or len(both) != 2 or stamp in names:
            continue
        both.sort(key=fine.__eq__)
        whole, rest = (data[names[name]] for name in both)
        if all(pd.api.types.is_numeric_dtype(column.dtype) for column in (whole, rest)):
            whole = whole.astype(float)  # differences of unsigned numbers would be none
            begin = next(iter(whole.dropna()), 0.0)
            found[stamp] = both, (whole - begin + 1e-9 * rest).to_numpy(dtype=float)
    return found


def _check_plane(
    file: str, names: Mapping[str, str], units: dict[str, str | None], said: bool
) -> None:
    """Give both coordinates of a position one unit, or say that they have two."""
    if said:
        units[SECOND] = units["position"]
    if units[SECOND] != units["position"]:
        raise errors.InputError(
            f"{file}: the columns {names['position']!r} and {names[SECOND]!r} of the position have"
            ' different units: give one unit for both, as units={"position": "..."}.'
        )


def _known_column(file: str, column: Any, own: Mapping[str, str]) -> str:
    for name, header in own.items():
        if column in (name, header):
            return name
    of_run = next((state for state in STATES if own.keys() >= RUN | state.keys()), {})
    for word, quantity in {"t": "time", **of_run}.items():
        if of_run and column == quantity:
            return word
    bare = [name for name in own if without_unit(name).casefold() == str(column).casefold()]
    if len(bare) == 1:
        return bare[0]
    # The coordinate of the only track has a short name too.
    short = [name for name in own if name.rpartition(SEPARATOR)[2].lower() == str(column).lower()]
    if len(short) == 1:
        return short[0]
    if short:
        pair = [name for name in own if name.startswith(short[0].rpartition(SEPARATOR)[0])][:2]
        raise errors.InputError(
            f"{file}: {len(short)} tracks have a column {column!r}: {', '.join(map(repr, short))}."
            f' Choose one, as columns={{"position": ["{pair[0]}", "{pair[-1]}"]}}.'
        )
    raise errors.UnknownNameError(f"column of {file}:", str(column), own)


# Conditions of trials from the columns of files, and the columns that nothing was read from.

KELVINS = ("K", "°C", "degC", "°F", "degF")
"""Units of temperatures."""


def by_trial(frame: QuantityTable) -> Iterator[tuple[str, QuantityTable]]:
    """Yield the rows of each trial with its name, in the order in which they come.

    A table without a column of trials, or with one trial only, is yielded as it is.
    """
    if TRIAL not in frame.names:
        yield "", frame
        return
    cells = frame.data[frame.names[TRIAL]]
    if cells.isna().any():
        row = int(np.flatnonzero(cells.isna())[0])
        raise errors.InputError(
            f"{frame.place(TRIAL, row)}: the trial of this row is missing: fill the cell."
        )
    if cells.nunique() == 1:
        yield "", frame
        return
    for value in cells.unique():
        name = f"{TRIAL} {value:g}" if isinstance(value, float) else f"{TRIAL} {value}"
        yield name, replace(frame, data=frame.data[cells == value])


def condition_keys(frame: QuantityTable, columns: Sequence[str]) -> dict[str, str]:
    """Return the column of each condition, by name, with its unit if the column has one."""
    found = {}
    for name in columns:
        own = next(
            (
                key
                for key, header in frame.names.items()
                if name in (key, header, header.partition("[")[0].strip())
            ),
            None,
        )
        if own is None:
            raise errors.UnknownNameError(
                f"column in conditions of {frame.file}:", name, frame.names
            )
        unit = frame.units.get(own)
        found[f"{own} [{unit}]" if unit not in (None, "1") else own] = own
    return found


def condition_cells(frame: QuantityTable, name: str) -> list[float | str | None]:
    """Return the cells of a column as numbers, or as texts if one is none; None where empty."""
    column = frame.data[frame.names[name]]
    numbers = pd.to_numeric(column, errors="coerce")
    if numbers.notna().sum() == column.notna().sum() and column.dtype != bool:
        return [float(cell) if np.isfinite(cell) else None for cell in numbers.astype(float)]
    return [None if pd.isna(cell) else str(cell).strip() or None for cell in column]


def conditions_in(frame: QuantityTable, columns: Sequence[str]) -> dict[str, float | str]:
    """Return the conditions of a record, whose columns have one value each.

    A condition without any value is left out.
    """
    found: dict[str, float | str] = {}
    for key, name in condition_keys(frame, columns).items():
        cells = [cell for cell in condition_cells(frame, name) if cell is not None]
        values = set(cells)
        if not values:
            continue
        known = [cell for cell in cells if isinstance(cell, float)]
        if len(values) == 1:
            found[key] = cells[0]
        elif len(known) == len(cells) and (
            np.ptp(known) <= SLIGHT * abs(float(np.mean(known)))
            or _is_temperature(name, frame.units.get(name))
        ):
            found[key] = float(np.mean(known))
        else:
            shown = (
                f"from {number(min(known))} to {number(max(known))}"
                if len(known) == len(cells)
                else f"{len(values)} texts"
            )
            raise errors.InputError(
                f"{frame.file}: column {frame.names[name]!r} changes within the trial ({shown}),"
                " but a condition has one value per trial. Split the record, or leave the"
                " condition out."
            )
    return found


def _is_temperature(name: str, unit: str | None) -> bool:
    """Whether a column is one of temperatures, which no experimenter can hold."""
    words = re.split(r"[\W\d_]+", name.casefold())
    named = any(
        w == "temp" or w.startswith("temperatur") or w.endswith("temperatur") for w in words
    )
    return named or unit in KELVINS


def unused_in(frame: QuantityTable, used: Collection[str]) -> dict[str, float | str | None]:
    """Return the columns that nothing was read from, with their value if they have one."""
    found: dict[str, float | str | None] = {}
    for name in frame.names:
        if name in used or not name:
            continue
        column = frame.data[frame.names[name]]
        alike = len(column) > 0 and bool((column == column.iloc[0]).all())
        found[name] = (
            condition_cells(replace(frame, data=frame.data[:1]), name)[0] if alike else None
        )
    return found
