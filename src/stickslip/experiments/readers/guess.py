"""What a file seems to hold: its layout, its columns, their units; and what speaks for it."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final, final

import numpy as np
import pandas as pd
from typing_extensions import override

from stickslip.described import Described
from stickslip.errors import InputError
from stickslip.experiments.measurement import QUANTITIES, TRAVELS, Array
from stickslip.experiments.readers.csv_reader import refuse_numbers
from stickslip.experiments.readers.layout import Layout, decoded, layout_of
from stickslip.experiments.readers.reader_options import Column, Reading, motor_constants
from stickslip.experiments.readers.scope_channels import SCOPE, is_scope
from stickslip.experiments.readers.table_reader import TEXT, Frame, read_frame
from stickslip.experiments.readers.time_base import Repair, nearly_zero
from stickslip.experiments.readers.time_stamps import is_stamp, seconds_of
from stickslip.experiments.readers.toml import check_file
from stickslip.formatting import count, number
from stickslip.units import factor, is_of, is_unit, shown

__all__ = ["Guess", "guess_data"]

NAMES: Final[Mapping[str, tuple[str, ...]]] = {
    "time": (
        *("time", "zeit", "timestamp", "zeitstempel", "uhrzeit", "datetime", "elapsed", "stamp"),
        "t",
    ),
    "position": (
        *("position", "pos", "weg", "lage", "winkel", "angle", "displacement", "verschiebung"),
        *("auslenkung", "stroke", "hub", "drehwinkel", "lageistwert", "travel", "encoder"),
        *("x", "q", "s", "phi", "theta", "φ", "ϕ", "θ"),
    ),
    "velocity": (
        *("velocity", "speed", "geschwindigkeit", "drehzahl", "winkelgeschwindigkeit"),
        *("omega", "vel", "v", "n", "ω"),
    ),
    "force": (
        *("force", "kraft", "torque", "moment", "drehmoment", "antriebskraft", "antriebsmoment"),
        *("thrust", "effort", "f", "m", "tau", "τ"),
    ),
    "current": ("current", "strom", "motorstrom", "stromistwert", "iq", "amps", "i"),
    "friction": (
        *("friction", "reibung", "reibkraft", "reibungskraft", "reibmoment", "reibungsmoment"),
        *("frictionforce", "fr"),
    ),
    "load": ("load", "normalkraft", "normalforce", "anpresskraft", "last", "fn"),
    "reference": (
        *("reference", "setpoint", "sollposition", "sollweg", "solllage", "sollwert"),
        *("sollwinkel", "lagesollwert", "target"),
    ),
}
"""Names of columns by quantity, in English and German, umlauts written out."""
UNITS: Final[Mapping[str, tuple[str, ...]]] = {
    "time": ("s",),
    "current": ("A",),
    "friction": ("N", "N m", "1"),
    **{
        name: tuple(filter(None, (QUANTITIES[name].unit, QUANTITIES[name].or_unit)))
        for name in ("position", "velocity", "force", "load", "reference")
    },
}
"""Kinds of units of each quantity."""
WANTED: Final = (
    "soll",
    "set",
    "cmd",
    "command",
    "desired",
    "demand",
    "target",
    "ref",
    "reference",
    "vorgabe",
)
"""What names of wanted values contain: only a wanted position is read."""
OTHER: Final = (
    "error",
    "fehler",
    "abweichung",
    "schlepp",
    "temperatur",
    "status",
    "index",
    "spannung",
)
"""What names of columns contain that none of the quantities has."""
TURNING: Final = (
    *("winkel", "angle", "drehzahl", "omega", "torque", "moment", "phi", "theta", "rot"),
    *("joint", "effort", "φ", "ϕ", "θ", "ω", "tau", "τ"),
)
"""What names of columns contain where an axis turns."""
EPOCH: Final = {"ms": 1e3, "us": 1e6, "ns": 1e9}
"""Parts of a second in which times are counted from 1970: numbers of ten digits and 3, 6 or 9 more.
"""
CHECKED: Final = 5_000
"""Samples at the top that show what a column holds."""
WHOLE, PART, INSIDE, BY_UNIT, BY_VALUES = 4.0, 3.0, 2.0, 0.5, 0.4
"""How much speaks for a column: its name, a part of it, a word in it, its unit, its numbers."""
_STYLES: Final = (
    re.compile(r"(?P<name>.*?)\s*[\[(<{](?P<unit>[^\[\]()<>{}]+)[\])>}]\s*"),
    re.compile(r"(?P<name>.+?)\s+in\s+(?P<unit>\S.*)"),
    re.compile(r"(?P<name>.+?)\s*/\s*(?P<unit>\S.*)"),
    re.compile(r"(?P<name>.+)[_ ,.;:-](?P<unit>[^\s_]+)"),
)
"""How headers carry units: Weg [mm], Weg (mm), Weg in mm, Weg / mm, Weg_mm."""
_WRITTEN_OUT: Final = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss"})


@final
@dataclass(frozen=True, kw_only=True)
class Guess(metaclass=Described):
    """What a file seems to hold, as `guess_data` returns it.

    `columns`, `units`, `gain`, `repair` and `layout` are arguments of `load_measurement`, and so is
    `motor_constant` unless it is empty.
    """

    file: str
    """The file."""
    layout: Layout | None
    """How a text file holds its table; None for other files."""
    columns: Mapping[str, Column]
    """Quantity -> name of its column."""
    units: Mapping[str, str]
    """Quantity -> unit of its column, where the header has none in brackets."""
    gain: Mapping[str, str] = field(default_factory=dict)
    """Quantity -> assumed size of a count, where it is counted."""
    motor_constant: str = ""
    """Assumed force or torque per current, where the file has a current and no force."""
    repair: tuple[Repair, ...] = ()
    """What has to be repaired: gaps, or times out of order."""
    turning: bool = False
    """Whether the axis turns."""
    reasons: Mapping[str, str] = field(default_factory=dict)
    """Layout, quantity or setting -> what was found, and why."""
    doubts: tuple[str, ...] = ()
    """What the file does not tell, and was assumed."""

    @property
    def reading(self) -> Reading:
        """How the file is read."""
        return Reading(
            columns=self.columns,
            units=self.units,
            gain=self.gain,
            motor_constant=motor_constants(self.motor_constant) if self.motor_constant else {},
            repair=self.repair,
            layout=self.layout,
        )

    @override
    def __str__(self) -> str:
        width = max(map(len, self.reasons), default=0)
        lines = [f"{name:{width}}  {why}" for name, why in self.reasons.items()]
        return "\n".join([*lines, *(f"! {doubt}" for doubt in self.doubts)])


@dataclass(frozen=True, kw_only=True)
class _Found:
    """A column that may hold a quantity."""

    score: float
    name: str
    """Name of the column, its unit left out."""
    unit: str | None
    stated: bool
    """Whether the reader finds the unit in the header by itself."""
    why: str
    others: tuple[str, ...] = ()
    """Columns for which as much speaks."""


def guess_data(
    path: str | Path,
    *,
    columns: Mapping[str, Column] | None = None,
    units: Mapping[str, str] | None = None,
) -> Guess:
    r"""Find out how a file holds a record: layout, columns, units, and what has to be repaired.

    Names of columns are known in English and German; a column without such a name is known by its
    unit, if no other has one of its kind. Nothing is guessed of the mechanism but whether it turns.

    Parameters
    ----------
    path : str or Path
        A file that `load_measurement` reads. Above the header of a text file there may be any
        lines, and below it a row of units.
    columns : mapping of str to str, optional
        Columns of quantities that are known, as in `load_measurement`.
    units : mapping of str to str, optional
        Units that are known, as in `load_measurement`.

    Returns
    -------
    Guess
        What was found, with reasons and doubts.

    Raises
    ------
    InputError
        If the file is no table, or seems to hold no record of a motion or of friction.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "messung.csv")
    ...     rows = "".join(f"{t / 100:.2f};{t * t}\n".replace(".", ",") for t in range(20))
    ...     _ = file.write_text(f"Prüfstand 3\nZeit;Weg\ns;µm\n{rows}", encoding="cp1252")
    ...     guess = guess_data(file)
    >>> guess.columns, guess.layout.decimal, guess.layout.units_row, guess.layout.encoding
    ({'time': 'Zeit', 'position': 'Weg'}, ',', True, 'cp1252')
    >>> guess.reasons["position"]
    "column 'Weg' in µm, by its name"
    """
    check_file(path)
    layout, reasons = _layout(Path(path))
    given = dict(columns or {})
    frame = read_frame(path, columns={}, units={}, layout=layout)
    found = _assigned(frame, given, units or {})
    _check_enough(frame, found)
    turning = _turns(found)
    known = {
        q: one.unit
        for q, one in found.items()
        if one.unit and (not one.stated or is_of(one.unit, "count"))
    }
    counted = [q for q, one in found.items() if one.unit and is_of(one.unit, "count")]
    reasons |= {q: _column_text(one) for q, one in found.items()}
    times = _times(frame, found["time"]) if "time" in found else None
    if times is not None:
        reasons["time"] += _rate_text(times)
    reasons["motion"] = "about an axis" if turning else "along a line"
    repair = _repairs(frame, found, times)
    if repair:
        why = {"gaps": "cells are empty or not finite", "sort": "times do not increase everywhere"}
        reasons["repair"] = " and ".join(f"{one}: {why[one]}" for one in repair)
    return Guess(
        file=str(path),
        layout=layout,
        columns={q: given.get(q, one.name) for q, one in found.items()},
        units={**known, **(units or {})},
        gain=dict.fromkeys(counted, "0.001 rad/count" if turning else "0.001 mm/count"),
        motor_constant=("1 N m/A" if turning else "1 N/A") * ("current" in found),
        repair=repair,
        turning=turning,
        reasons=reasons,
        doubts=tuple(_doubts(found, turning, units or {})),
    )


def _layout(path: Path) -> tuple[Layout | None, dict[str, str]]:
    """Return how a text file holds its table, and what was found in words."""
    if path.suffix.lower() not in TEXT:
        return None, {}
    text, encoding = decoded(path.read_bytes())
    if is_scope(text):
        return None, {"cells": SCOPE}
    found = layout_of(text, encoding)
    if found is None:
        # The reader says what is wrong; what it reads in spite of that has its own layout.
        read_frame(path, columns={}, units={})
        refuse_numbers(path, text)
        return None, {}
    layout = found.layout
    marks = {";": "semicolons", ",": "commas", "\t": "tabs", "|": "bars", " ": "blanks"}
    decimal = "comma" if layout.decimal == "," else "point"
    thousands = f", thousands parted by {layout.thousands!r}" if layout.thousands else ""
    header = ", ".join(map(repr, (name for name in found.names if name)))
    reasons = {
        "code page": layout.encoding.removesuffix("-sig"),
        "cells": f"parted by {marks[layout.separator]}, decimal {decimal}{thousands}",
        "header": f"line {layout.preface + 1}: {header if len(header) < 200 else header[:200]}",
    }
    if found.units:
        where = "row below the header" if layout.units_row else "labels of LabVIEW above the header"
        reasons["units"] = f"{where}: {', '.join(found.units)}"
    return layout, reasons


def _assigned(
    frame: Frame, given: Mapping[str, Column], units: Mapping[str, str]
) -> dict[str, _Found]:
    """Return the column of each quantity, those for which most speaks first."""
    taken: dict[str, _Found] = {}
    left = [name for name in frame.names if name]
    for quantity, column in given.items():
        names = (column,) if isinstance(column, str) else column
        own = [name for name in left if name in names or frame.names[name] in names]
        left = [name for name in left if name not in own]
        stated = frame.units.get(own[0]) if own else None
        unit = units.get(quantity, stated)
        taken[quantity] = _Found(
            score=9.0, name=str(names[0]), unit=unit, stated=unit == stated, why="as given"
        )
    # Columns of a motion along a line, or of one about an axis: those for which more speaks.
    kinds = [_by_kind(frame, left, taken, turning) for turning in (False, True)]
    taken = max(kinds, key=lambda found: sum(one.score for one in found.values()))
    if "current" in taken and "force" in taken:
        del taken["current" if taken["force"].score >= taken["current"].score else "force"]
    if "time" not in taken and "force" in taken and "velocity" in taken and "friction" not in taken:
        taken["friction"] = taken.pop("force")
    order = ("time", *(q for q in NAMES if q != "time"))
    return {q: taken[q] for q in (*order, *taken) if q in taken}


def _by_kind(
    frame: Frame, left: Sequence[str], given: Mapping[str, _Found], turning: bool
) -> dict[str, _Found]:
    """Return the column of each quantity, if all units are those of one kind of motion."""
    taken = dict(given)
    offers = [
        (found.score, -place, quantity, found)
        for place, name in enumerate(left)
        for quantity in NAMES
        for found in _offers(frame, name, quantity)
        if _is_of_kind(found, quantity, turning)
    ]
    for _, _, quantity, found in sorted(offers, key=lambda one: one[:2], reverse=True):
        alike = quantity in taken and found.name != taken[quantity].name
        if alike and found.score == taken[quantity].score and quantity not in given:
            taken[quantity] = replace(taken[quantity], others=(*taken[quantity].others, found.name))
        if quantity in taken or found.name in {one.name for one in taken.values()}:
            continue
        if "force" in taken and quantity == "current" and taken["force"].score >= PART:
            continue  # measured as well, but the force is what is wanted
        taken[quantity] = found
    return taken


def _is_of_kind(found: _Found, quantity: str, turning: bool) -> bool:
    kinds = UNITS[quantity]
    if found.unit is None or len(kinds) < 2 or is_of(found.unit, "count"):
        return True
    return not is_of(found.unit, kinds[not turning])


def _offers(frame: Frame, name: str, quantity: str) -> Iterable[_Found]:
    """Yield what speaks for a column as that of a quantity, if anything does."""
    column = frame.data[frame.names[name]]
    stated = frame.units.get(name)
    bare, unit = (name, stated) if stated else _unit_in_name(name, quantity)
    if unit is not None and unit.isupper() and not _fits(unit, quantity):
        unit = unit.lower() if _fits(unit.lower(), quantity) else unit  # MM is no molarity
    since = _since_epoch(column) if quantity == "time" and unit is None else None
    unit = since or unit
    fits = unit is not None and _fits(unit, quantity)
    counts = unit is not None and quantity in ("position", "reference") and is_of(unit, "count")
    if unit is not None and not fits and not counts:
        return
    if quantity == "time" and not _may_be_times(column):
        return
    if quantity != "time" and not pd.api.types.is_numeric_dtype(column.dtype):
        return
    stamps = "" if pd.api.types.is_numeric_dtype(column.dtype) else "time stamps, "
    score, why = _named_score(bare, quantity)
    if since:
        why = f"{why}, as its numbers count from 1970".removeprefix(", ")
        score = score or BY_UNIT
    elif score and fits:
        score += 1.0
    if not score and counts and not bare:
        score, why = BY_UNIT, "by its name"
    if not score and fits and unit != "1" and quantity not in ("reference", "load"):
        score, why = BY_UNIT, "by its unit"
    if not score and quantity == "time" and _increases(column):
        score, why = BY_VALUES, "because it increases"
    if score:
        yield _Found(score=score, name=name, unit=unit, stated=unit == stated, why=stamps + why)


def _since_epoch(column: "pd.Series[Any]") -> str | None:
    """Return the unit of times that count from 1970 in parts of a second, by their size."""
    part = column.iloc[:CHECKED].dropna()
    if part.empty or not pd.api.types.is_numeric_dtype(part.dtype):
        return None
    size = float(part.median())
    return next((unit for unit, per in EPOCH.items() if 1e9 * per <= size < 1e10 * per), None)


def _named_score(name: str, quantity: str) -> tuple[float, str]:
    """Return how well a name fits a quantity, and that in words."""
    spaced = re.sub(r"(?<=[a-zäöüß])(?=[A-Z])", " ", name).casefold().translate(_WRITTEN_OUT)
    parts = [part for part in re.split(r"[\W\d_]+", spaced) if part]
    joined = "".join(parts)
    if any(word in joined for word in OTHER):
        return 0.0, ""
    wanted = any(part in WANTED for part in parts) or any(
        joined.startswith(word) or joined.endswith(f"{word}wert") for word in WANTED
    )
    words = NAMES[quantity]
    if quantity == "reference" and wanted:
        if any(word in joined for word in NAMES["position"] if len(word) > 2) or joined in words:
            return WHOLE + 0.5, "by its name"
        return 0.0, ""
    if wanted and quantity not in ("force", "time"):
        return 0.0, ""
    less = 1.5 if wanted else 0.0
    if joined in words:
        return WHOLE - less, "by its name"
    if any(part in words and (len(part) > 1 or len(parts) < 3) for part in parts):
        return PART - less, "by its name"
    if any(word in joined for word in words if len(word) > 3):
        return INSIDE - less, "by its name"
    return 0.0, ""


def _unit_in_name(name: str, quantity: str) -> tuple[str, str | None]:
    """Return a name without the unit that it carries, one of the quantity if there is one."""
    found = [style.fullmatch(name) for style in _STYLES]
    parts = [(one["name"], one["unit"].strip()) for one in found if one and is_unit(one["unit"])]
    own = [part for part in parts if _fits(part[1], quantity)]
    if not parts and len(name) > 1 and name.casefold() not in NAMES[quantity] and is_unit(name):
        return "", name  # counts, rpm
    last = _STYLES[-1].fullmatch(name)
    # A last word may be anything, and is a unit only if it is one of the quantity.
    others = [part for part in parts if last is None or part[1] != last["unit"]]
    return next(iter((*own, *others)), (name, None))


def _fits(unit: str, quantity: str) -> bool:
    return any(is_of(unit, kind) for kind in UNITS[quantity])


def _may_be_times(column: "pd.Series[Any]") -> bool:
    """Whether times may stand in a column: stamps, or numbers that mostly increase."""
    part = column.iloc[:CHECKED].dropna()
    if part.empty:
        return False
    if not pd.api.types.is_numeric_dtype(part.dtype):
        if isinstance(part.iloc[0], str) and not is_stamp(part.iloc[0].strip()):
            return False
        seconds = seconds_of(part)
        return seconds is not None and len(seconds) > 1 and bool(np.ptp(seconds) > 0.0)
    steps = np.diff(part.to_numpy(dtype=float))
    return steps.size > 0 and bool(np.mean(steps > 0.0) > 0.9)


def _increases(column: "pd.Series[Any]") -> bool:
    """Whether a column increases in steps of nearly one size, or holds time stamps."""
    part = column.iloc[:CHECKED].dropna()
    if not pd.api.types.is_numeric_dtype(part.dtype):
        return True  # stamps, as was found before
    steps = np.diff(part.to_numpy(dtype=float))
    return bool(np.all(steps > 0.0) and np.ptp(steps) < 0.1 * np.median(steps))


def _check_enough(frame: Frame, found: Mapping[str, _Found]) -> None:
    """Refuse what is neither a motion in time nor friction at velocities."""
    listed = ", ".join(map(shown, [name for name in frame.names if name][:12]))
    for name in frame.names if "time" not in found else ():
        if _named_score(_unit_in_name(name, "time")[0], "time")[0] >= PART:
            frame.raw(name)  # says which cell is no number, if that is why it was passed over
    if any(name in frame.names for name in TRAVELS):
        raise InputError(
            f"{frame.file}: is a table of travels, one trial a row, not a record: name it in a rig"
            " file of your mechanism, as [data] file, or as --data of `stickslip select`."
        )
    map_of = {"velocity", "friction"} <= set(found)
    if "time" not in found and not map_of:
        raise InputError(
            f"{frame.file}: no column seems to hold times; the columns are {listed}. Name it, as"
            ' columns={"time": "..."}.'
        )
    if not ({"position", "velocity"} & set(found)):
        raise InputError(
            f"{frame.file}: no column seems to hold a position or a velocity; the columns are"
            f' {listed}. Name it, as columns={{"position": "..."}}.'
        )


def _turns(found: Mapping[str, _Found]) -> bool:
    """Whether an axis turns: by units, or by names where there are none."""
    for quantity, one in found.items():
        kinds = UNITS.get(quantity, ())
        if one.unit and len(kinds) > 1:
            straight, turns = (is_of(one.unit, kind) for kind in kinds[:2])
            if straight or turns:
                return turns
    moving = [one.name.casefold() for q, one in found.items() if q not in ("time", "load")]
    return any(word in name for name in moving for word in TURNING)


def _column_text(one: _Found) -> str:
    return f"column {one.name!r}{f' in {one.unit}' if one.unit else ''}, {one.why}"


def _rate_text(times: Array) -> str:
    """Return number and rate of the samples in words."""
    step = float(np.median(np.diff(times[np.isfinite(times)])))
    samples = count(len(times), "sample")
    return f"; {samples}, {number(1.0 / step, 4)} Hz" if step > 0.0 else f"; {samples}"


def _times(frame: Frame, one: _Found) -> Array | None:
    """Return the times of a record [s], NaN where there are none."""
    key = next((k for k in frame.names if one.name in (k, frame.names[k])), None)
    if key is None:
        return None
    column = frame.data[frame.names[key]]
    if not pd.api.types.is_numeric_dtype(column.dtype):
        return seconds_of(column)
    values = column.to_numpy(dtype=float)
    return values * (factor(one.unit, "s") if one.unit else 1.0)


def _repairs(frame: Frame, found: Mapping[str, _Found], times: Array | None) -> tuple[Repair, ...]:
    """Return what the reader would refuse, and can repair."""
    headers = [
        frame.names[key]
        for one in found.values()
        for key in frame.names
        if one.name in (key, frame.names[key])
    ]
    cells = frame.data[headers]
    gaps = bool((cells.isna() | cells.isin([np.inf, -np.inf])).any(axis=None))
    there = np.zeros(0) if times is None else times[np.isfinite(times)]
    late = bool(np.any(np.diff(there) <= nearly_zero(np.sort(there))))
    steps: dict[Repair, bool] = {"gaps": gaps, "sort": late}
    return tuple(name for name, needed in steps.items() if needed)


def _doubts(found: Mapping[str, _Found], turning: bool, units: Mapping[str, str]) -> Iterable[str]:
    """Yield what was assumed."""
    for quantity, one in found.items():
        stamps = quantity == "time" and one.unit is None and "stamp" in one.why
        if one.unit is None and quantity not in units and not stamps:
            kinds = UNITS.get(quantity, ("SI",))
            yield (
                f"The column {one.name!r} has no unit: {kinds[-1 if turning else 0]} is assumed for"
                f" the {quantity}."
            )
        elif one.unit is not None and is_of(one.unit, "count"):
            yield (
                f"The column {one.name!r} is in {one.unit}: give the counts per unit of length or"
                " angle as its gain."
            )
    for quantity, one in found.items():
        for other in one.others:
            yield (
                f"The column {other!r} may be the {quantity} as well as {one.name!r}, which comes"
                " first."
            )
    if "current" in found:
        unit = "N m/A" if turning else "N/A"
        yield (
            f"The file has a current and no {'torque' if turning else 'force'}: a motor constant of"
            f" 1 {unit} is assumed. Replace it by that of the data sheet, times the gear ratio."
        )
    if not {"force", "current", "friction"} & set(found):
        yield "The file has no force: the body is assumed to move without a drive."
