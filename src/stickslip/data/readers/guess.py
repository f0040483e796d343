"""What a file seems to hold: its layout, its columns, their units; and what speaks for it."""

import itertools
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from stickslip.data import measurement
from stickslip.data.differentiation import READING_INTERVAL, are_steady_readings
from stickslip.data.readers import layout as text_layout
from stickslip.data.readers import robots
from stickslip.data.readers.columns import (
    GUESSED,
    INPUTS,
    STYLES,
    SURE_STYLES,
    VOCABULARY,
    WORDS,
    Column,
    Reading,
    doubted,
    is_barred,
    is_half_width,
    is_unit_of,
    is_voltage,
    is_wanted,
    meaning_of,
    motor_constants,
    parts_of,
)
from stickslip.data.readers.csv_reader import dialect_of, refuse_numbers
from stickslip.data.readers.table import TRIAL
from stickslip.data.readers.table_reader import (
    KELVINS,
    QuantityTable,
    by_trial,
    conditions_in,
    data_file,
    is_text,
    read_frame,
)
from stickslip.data.readers.toml import check_file, check_path
from stickslip.data.tolerances import (
    FEWEST_SAMPLES,
    GAP,
    HALF,
    INTERVAL,
    LARGEST_TEXT,
    LONGEST_LINE,
    LONGEST_NAME,
    MOST_LISTED,
    NEARLY_ALL,
    NEGLIGIBLE,
    ROUNDED,
    ROUNDING,
    SLIGHT,
)
from stickslip.errors import InputError, UnknownNameError
from stickslip.show.described import Described
from stickslip.show.formatting import count, joined, number, percent
from stickslip.units import CELSIUS, factor, is_of, is_unit, shown

DERIVATIVE: Final = re.compile(r"d(?:q|phi|theta|[φϕθ])|(?:x|q|s|pos|ang|angle|phi|theta|[φϕθ])dot")
"""How names of derivatives are made of those of coordinates."""
RATE: Final = re.compile(r"(?P<name>.+)_(?P<unit>[^\W\d_]+)_(?P<per>s2?|min)")
"""How names of columns that have no sign for it say a unit over a time."""
COUNTED: Final = {"millis": "ms", "micros": "us"}
"""Times of a microcontroller by the names of its functions."""
PHASE: Final = re.compile(r"(?<![^\W_])i[_ ]?[abcuvwdq](?![^\W_])|phase")
"""What names of currents contain that are of one phase of a motor, or of one of its axes."""
EPOCH: Final = {"ms": 1e3, "us": 1e6, "ns": 1e9}
"""Parts of a second in which times are counted from 1970: numbers of ten digits and 3, 6 or 9 more.
"""
CHECKED: Final = 5_000
"""Samples at the top that show what a column holds."""
WHOLE, PART, INSIDE, LETTER, BY_UNIT, BY_VALUES = 4.0, 3.0, 2.0, 1.9, 0.5, 0.4
"""How much speaks for a column: its name, a part of it, a word in it, a letter, its unit, its
numbers."""
OFFERED: Final[Mapping[str, tuple[str, ...]]] = {
    **{"s": ("s", "ms", "us", "ns"), "m": ("m", "mm", "um"), "m/s": ("m/s", "mm/s", "um/s")},
    **{"rad": ("rad", "deg", "rev"), "rad/s": ("rad/s", "deg/s", "rpm")},
}
"""Units that columns without one may have, by those of SI."""
FAR: Final = 100.0
"""Span of positions and velocities in SI units that columns without a unit hardly have."""
TURN: Final = 2.0 * np.pi
"""Span of an angle [rad] beyond which one without a unit may be in degrees."""
CURES: Final = {
    "position": (("mm", "um"), ("deg", "rev")),
    "velocity": (("mm/s", "rpm"), ("rpm", "deg/s")),
}
"""What such columns may be in, along a line and about an axis."""
UPSIDE_DOWN: Final = (
    "The last time stands first: the rows are sorted by time. If this column counts down to 0"
    " instead, motion and time would be reversed: replace it by times that increase."
)
READINGS: Final = (
    "The rows, each at another speed, are taken for steady readings of friction, not for samples of"
    " one motion. If they are such samples, give --columns time={!r} and --route balance."
)
BESIDE_LOAD: Final = "as the other force beside Fz"
UNDRIVEN: Final = ("The file has no force", "No column is known as a force")
"""How doubts begin that say that no force is known: of films none is needed."""
PER_LOAD: Final = "The column {!r} is a coefficient, and no load is known: one of 1 N is assumed."
PRESSED: Final = "The column {!r} is negative throughout: its gain of -1 makes a load of it."


@dataclass(frozen=True, kw_only=True)
class Guess(metaclass=Described):
    """What a file seems to hold, as `guess_data` returns it.

    `columns`, `units`, `gain`, `repair` and `layout` are arguments of `load_measurement`, and so is
    `motor_constant` unless it is empty.
    """

    file: str
    """The file."""
    layout: text_layout.Layout | None
    """How a text file holds its table; None for other files."""
    columns: Mapping[str, Column]
    """Quantity -> name of its column."""
    units: Mapping[str, str]
    """Quantity -> unit of its column, where the header has none in brackets."""
    gain: Mapping[str, float | str] = field(default_factory=dict)
    """Quantity -> size of a count or of a volt, assumed where it was not given."""
    assumed: tuple[str, ...] = ()
    """Quantities whose gain was neither given nor documented, but assumed."""
    motor_constant: str | Mapping[str, str] = ""
    """Force or torque per current, where a current drives the axis; assumed unless it was given, in
    which case `reasons` say so; by joint."""
    repair: tuple[text_layout.Repair, ...] = ()
    """What has to be repaired: gaps, or times out of order."""
    conditions: tuple[str, ...] = ()
    """Columns that seem to hold a condition, such as a temperature."""
    turning: bool = False
    """Whether the axis turns."""
    robot: str = ""
    """Description in URDF of the robot whose joints were recorded; empty for a single axis."""
    moving: tuple[str, ...] = ()
    """Joints of the description that move in the record."""
    locked: Mapping[str, float] = field(default_factory=dict)
    """Joints that do not move, or whose torque is not known, and where they stand [rad] or [m]."""
    delays: Mapping[str, float] = field(default_factory=dict)
    """Coordinate -> how far its motion lags behind the commanded one [s]."""
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
            conditions=self.conditions,
            rotary=self.turning or None,
        )

    def __str__(self) -> str:
        width = max(map(len, self.reasons), default=0)
        lines = [f"{name:{width}}  {why}" for name, why in self.reasons.items()]
        return "\n".join([*lines, *(f"! {doubt}" for doubt in self.doubts)])


@dataclass(frozen=True, kw_only=True)
class Found:
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
    most_moving: bool = False
    """Whether it is the axis of a sensor that moves most."""

    @property
    def unit_in_si(self) -> str:
        """The unit of positions in SI that its unit is a part of."""
        turns = self.unit is not None and is_of(self.unit, "rad")
        return "rad" if turns else "m"

    def odd_in(self, frame: QuantityTable) -> str:
        """Return what the header of a table has in the place of a unit, and is none."""
        stated = frame.units.get(self.name) or ""
        return stated if stated != "1" and not is_unit(stated) else ""


def guess_data(
    path: str | Path,
    *,
    columns: Mapping[str, Column] | None = None,
    units: Mapping[str, str] | None = None,
    gain: Mapping[str, float | str] | None = None,
    motor_constant: float | str | None = None,
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
    gain : mapping of str to float or str, optional
        Gains that are known, as in `load_measurement`.
    motor_constant : float or str, optional
        Force or torque per current, if it is known, as in `load_measurement`: the column of a
        current is then taken for what drives the axis, also beside one of a force.

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
    check_path(path)
    given_path, path = path, data_file(Path(path))
    check_file(path)
    look_ahead(path, columns or {}, units or {})
    layout, reasons = layout_and_reasons(path)
    named = [
        n for name in (columns or {}).values() for n in ([name] if isinstance(name, str) else name)
    ]
    stated = {q: name for q, name in (columns or {}).items() if q == measurement.STATED}
    frame = read_frame(path, columns=stated, units={}, layout=layout, also=named)
    frame = _timed(frame, columns or {})
    given = {quantity: frame.column(column) for quantity, column in (columns or {}).items()}
    result = assigned(frame, given, units or {}, by_current=motor_constant is not None)
    doubt = result.pop(measurement.STATED, None)
    frame = _without_rate(frame, result)
    untimed = "time" not in result and "current" in result
    untimed = untimed and _is_steady(frame, result, np.arange(float(len(frame.data))))
    _check_enough(frame, _as_friction(result) if untimed else result)
    servo, result = _of_servo(frame, result, units or {})
    result = result if servo is not None else _by_derivative(frame, result)
    if motor_constant is not None and "current" not in result:
        raise InputError(
            f"{path}: the motor constant belongs to a current, and no column seems to hold one."
            ' Name it, as columns={"current": "..."}.'
        )
    times = times_of(frame, result["time"]) if "time" in result else None
    trial, why = trial_column(frame, given, result, times)
    steady = ""
    if times is not None and "time" not in given and _is_steady(frame, result, times):
        clock, times = result.pop("time"), None
        steady = clock.name
        reasons["rows"] = (
            f"steady readings; their times, column {steady!r}, are read as their order"
        )
    by_current = bool(steady or untimed) and "current" in result
    renamed = _as_friction if steady or untimed else dict
    result, units, gain = renamed(result), renamed(units or {}), renamed(gain or {})
    if trial:
        given["trial"] = trial
        reasons["trial"] = f"column {trial!r}, {why}"
    assumed = reasons.pop("thousands", "")
    turning = servo is not None or _turns(
        _geared(result, gain or {}), motor_constant, [*frame.names]
    )
    numbered = {TRIAL: frame.names.get(trial, trial)} if trial else {}
    parts = [part for _, part in by_trial(replace(frame, names={**frame.names, **numbered}))]
    conditions = _conditions(frame, result, trial)
    if "temperature" not in result:
        result |= changing_temperature(parts, conditions)
    result |= contact_inputs(frame, result)
    result = _with_doubt(frame, result, doubt, table=times is None)
    alone = [column.name for column in result.values()] if len(parts) == 1 else []
    conditions = tuple(
        name
        for name in conditions
        if name not in alone and all(_has_one_value(part, name) for part in parts)
    )
    known = {
        q: column.unit
        for q, column in result.items()
        if column.unit and (not column.stated or is_of(column.unit, "count"))
    } | {q: _assumed(q, turning) for q, x in result.items() if not x.unit and x.odd_in(frame)}
    gains: dict[str, float | str] = {
        q: _gain(q, turning, column.unit) for q, column in result.items() if _is_raw(column.unit)
    }
    assumed_gains = {*gains}
    scale = _with_unit(motor_constant or 1, "N m/A" if turning else "N/A")
    if by_current:
        known["friction"] = result["friction"].unit or "A"
        result["friction"] = replace(result["friction"], unit=known["friction"])
        gains["friction"] = scale
    registers = [q for q, column in result.items() if servo is not None and column.why == servo.why]
    if servo is not None:
        gains |= {q: size for q, size in servo.gains.items() if q in registers}
    sure = {*(units or {}), *(gain or {}), *registers, measurement.STATED}
    pressed = "load" in result and "load" not in (gain or {})
    rubs = [x.name for q, x in result.items() if q == "friction" and is_of(x.unit or "", "1")]
    rubs = rubs if "load" not in result and not turning else []
    pressed = pressed and bool(np.all(_numbers(frame, result["load"]) < 0.0))
    if pressed:
        gains.setdefault("load", -1.0)
    reasons |= {q: column_text(column, given.get(q, column.name)) for q, column in result.items()}
    if times is not None:
        reasons["time"] += rate_text(times)
    if by_current or "current" in result:
        reasons["motor constant"] = f"{scale}, as given" if motor_constant else "not in the file"
    reasons["motion"] = "about an axis" if turning else "along a line"
    repair = repairs_of(frame, result, times, trial)
    if repair:
        reasons["repair"] = repair_text(repair)
    taken = {trial, steady, *conditions, *(column.name for column in result.values())}
    reasons |= _unread(frame, given, taken)
    if times is not None and not trial:
        _refuse_restarts(frame, times)
    backwards = times is not None and bool(np.all(np.diff(times[np.isfinite(times)]) < 0.0))
    # a column that readers take for times of samples says when readings were taken
    table = {"velocity", "friction"} <= {*result} and "position" not in result
    other_times = table and "time" in frame.names and not {"time"} & {*result, *given}
    return Guess(
        file=str(given_path),
        layout=layout,
        columns={
            **{q: given.get(q, column.name) for q, column in result.items()},
            **({"time": ""} if other_times else {}),
            **({"trial": trial} if trial and trial != "trial" else {}),
        },
        units={**known, **(units or {})},
        gain=gains | dict(gain or {}),
        assumed=tuple(q for q in gains if q in assumed_gains - {*registers, *(gain or {})}),
        conditions=conditions,
        motor_constant=scale if "current" in result else "",
        repair=repair,
        turning=turning,
        reasons=reasons,
        doubts=(
            *frame.lost,
            *frame.remarks,
            *rates_doubt(frame, result),
            *([assumed] if assumed else []),
            *([READINGS.format(steady)] if steady else []),
            *([_scale_doubt(turning)] if by_current and motor_constant is None else []),
            *([UPSIDE_DOWN] if backwards else []),
            *(servo.doubts(result, gain or {}) if servo is not None else ()),
            *([PRESSED.format(result["load"].name)] if pressed else []),
            *map(PER_LOAD.format, rubs),
            *_doubts(frame, result, turning, sure, motor_constant),
            *_offered(conditions, result),
        ),
    )


def look_ahead(path: Path, columns: Mapping[str, Column], units: Mapping[str, str]) -> None:
    """Refuse a long text by its top, if that holds no record, before all of it is read."""
    if not is_text(path) or path.stat().st_size <= LARGEST_TEXT:
        return
    with path.open("rb") as file:
        top = file.read(LONGEST_LINE)
    top = top if b"\n" in top else top.replace(b"\r", b"\n")
    text, encoding = text_layout.decoded(top)
    if encoding.startswith("utf-16") or dialect_of(text) is not None:
        return
    with TemporaryDirectory() as folder:
        part = Path(folder, path.name)
        part.write_bytes(top[: top.rfind(b"\n") + 1])
        try:
            layout, _ = layout_and_reasons(part)
            frame = _timed(read_frame(part, columns={}, units={}, layout=layout), columns)
            given = {quantity: frame.column(column) for quantity, column in columns.items()}
            _check_enough(frame, assigned(frame, given, units))
        except UnknownNameError:
            return  # which says what the names are, once all of the file was read
        except InputError as error:
            raise type(error)(str(error).replace(str(part), str(path))) from None


def _timed(frame: QuantityTable, columns: Mapping[str, Column]) -> QuantityTable:
    """Return a table by its headers, with the times of rows at a rate that is given or stated."""
    frame = frame.as_headed()
    given = columns.get("time", "")
    if isinstance(given, str) and given in frame.at_rate(given).names:
        return replace(frame.at_rate(given), rates={})
    return frame.at_rate(*frame.rates) if len(frame.rates) == 1 else frame


def _without_rate(frame: QuantityTable, found: Mapping[str, Found]) -> QuantityTable:
    """Return a table without the times of rows at a stated rate if it has others."""
    if "time" in found and found["time"].name in frame.rates:
        return frame
    return replace(frame, names={k: x for k, x in frame.names.items() if k not in frame.rates})


def layout_and_reasons(path: Path) -> tuple[text_layout.Layout | None, dict[str, str]]:
    """Return how a text file holds its table, and what was found in words."""
    if not is_text(path):
        return None, {}
    text, encoding = text_layout.decoded(text_layout.bytes_of(path))
    dialect = dialect_of(text)
    if dialect is not None:
        return None, {"cells": dialect.title}
    result = text_layout.layout_of(text, encoding)
    if result is None:
        # The reader says what is wrong; what it reads in spite of that has its own layout.
        read_frame(path, columns={}, units={})
        refuse_numbers(path, text)
        return None, {}
    layout = result.layout
    mark = text_layout.MARKS[layout.separator]
    decimal = "comma" if layout.decimal == "," else "point"
    thousands = f", thousands separated by {layout.thousands!r}" if layout.thousands else ""
    header = ", ".join(map(repr, (name for name in result.names if name)))
    reasons = {
        "code page": layout.encoding.removesuffix("-sig"),
        "cells": f"separated by {mark}, decimal {decimal}{thousands}",
        "header": f"line {layout.preface + 1}: {header if len(header) < 200 else header[:200]}",
    }
    if result.rivals:
        lines = joined([f"line {line + 1}" for line in result.rivals], MOST_LISTED)
        reasons["header"] += f"; or {lines}, which may hold names as well"
    if result.units:
        reasons["units"] = f"row below the header: {', '.join(result.units)}"
    if result.assumed:
        mark = layout.thousands or layout.decimal
        whole, part = result.assumed.replace(mark, ""), result.assumed.replace(mark, ".")
        reasons["thousands"] = (
            f"{result.assumed} is read as {whole}: other numbers have a decimal {decimal}. If it"
            f" stands for {result.assumed.replace(mark, layout.decimal)}, write all numbers with"
            " one decimal mark."
            if layout.thousands
            else f"{result.assumed} is read as {part}: no number shows whether its comma is decimal"
            f" or parts thousands. If it stands for {whole}, write numbers without a mark between"
            " thousands."
        )
    return layout, reasons


def assigned(
    frame: QuantityTable,
    given: Mapping[str, Column],
    units: Mapping[str, str],
    *,
    by_current: bool = False,
) -> dict[str, Found]:
    """Return the column of each quantity, those for which most speaks first.

    A current stands for a force that has none, or for any if the axis is driven `by_current`.
    """
    taken: dict[str, Found] = {}
    left = _of_one_joint(frame, given)
    for quantity, column in given.items():
        names = (column,) if isinstance(column, str) else column
        left = [name for name in left if name not in names]
        stated = frame.units.get(names[0])
        bare, unit = _bare_and_unit(names[0], stated, quantity)
        if not bare and unit is not None and not _may_have(unit, quantity):
            unit = None  # m1 is the name of a channel
        unit = units.get(quantity) or unit
        taken[quantity] = Found(
            score=9.0, name=names[0], unit=unit, stated=unit == stated, why="as given"
        )
    # Columns of a motion along a line, or of one about an axis: those for which more speaks.
    quantities = [q for q in GUESSED if not (by_current and q == "force")]
    kinds = [_by_kind(frame, left, taken, quantities, turning, units) for turning in (False, True)]
    taken = max(kinds, key=lambda kind: sum(item.score for item in kind.values()))
    if "current" in taken and "force" in taken:
        del taken["current" if taken["force"].score >= taken["current"].score else "force"]
    if "time" not in taken and "force" in taken and "velocity" in taken and "friction" not in taken:
        taken["friction"] = taken.pop("force")
    both = {"position", "velocity"} <= taken.keys()
    if both and _stays(frame, taken["position"]) and np.any(_numbers(frame, taken["velocity"])):
        del taken["position"]  # of a table, above which something else moves
    if {"force", "load", "velocity"} <= taken.keys() and _are_of_sensor(taken):
        taken["friction"] = replace(taken.pop("force"), why=BESIDE_LOAD)
    if {"force", "friction"} <= taken.keys() and _is_its_size(frame, taken):
        size = taken["friction"]
        taken["friction"] = replace(taken.pop("force"), why=f"as {size.name!r} is its size")
    return {q: taken[q] for q in (*GUESSED, *taken) if q in taken}


def _of_servo(
    frame: QuantityTable, found: Mapping[str, Found], units: Collection[str]
) -> tuple[robots.Servo | None, dict[str, Found]]:
    """Return the family of servos whose registers were read, and these with their units."""
    servo = robots.servo_of(frame.names)
    raw = {
        quantity: replace(column, unit=servo.units[quantity], stated=False, why=servo.why)
        for quantity, column in found.items()
        if servo is not None
        and quantity in servo.units
        and quantity not in units
        and column.unit is None
        and not (servo.in_counts and not robots.are_counts(frame.data[frame.names[column.name]]))
    }
    if servo is None or not {"position", "reference"} & found.keys():
        return None, dict(found)
    robots.check_one_servo(frame.file, frame.data, frame.names)
    return servo, {**found, **raw, **_angles(frame, {**found, **raw})}


def _angles(frame: QuantityTable, found: Mapping[str, Found]) -> dict[str, Found]:
    """Return positions of a servo that are no counts with their unit: degrees by their steps."""
    moving = {q: found[q] for q in ("position", "reference") if q in found}
    first = next(iter(moving.values()))
    known = _numbers(frame, first)
    known = known[np.isfinite(known)]
    most = float(np.abs(known).max(initial=0.0))
    if first.unit is None and most <= robots.RADIANS:
        return {}
    if first.unit is None and not robots.are_degrees([known]):
        raise InputError(
            f"{frame.file}: the column {shown(first.name)} of a servo reaches {number(most, 3)},"
            " and holds neither counts nor angles in rad: if it is in degrees, give --unit"
            f" {next(iter(moving))}=deg."
        )
    steps = ", as its steps are 360/4096 degrees" if first.unit is None else ""
    return {
        q: replace(column, unit=first.unit or "deg", stated=False, why=f"{column.why}{steps}")
        for q, column in moving.items()
        if column.unit is None and not is_of(first.unit or "deg", "count")
    }


def _by_derivative(frame: QuantityTable, found: Mapping[str, Found]) -> dict[str, Found]:
    """Return columns with the units in which the velocity is the derivative of the position.

    Of units that are not stated, as few as possible are not those of SI. A position that no name
    shows is sought by its derivative.
    """
    clock, speed = found.get("time"), found.get("velocity")
    times = None if clock is None else times_of(frame, clock)
    if clock is None or speed is None or times is None:
        return dict(found)
    taken = {column.name for column in found.values()}
    offers = [found["position"]] if "position" in found else []
    for name in [] if offers else _of_one_joint(frame, {"velocity": speed.name}):
        unit = _bare_and_unit(name, frame.units.get(name), "position")[1]
        if name not in taken and unit is None and not _is_other(name, "position"):
            offers.append(Found(score=BY_VALUES, name=name, unit=None, stated=False, why=""))
    for offer in offers:
        own = {"position": offer, "velocity": speed, "time": clock}
        ratio = _over_way(times, _numbers(frame, speed), _numbers(frame, offer))
        units = _units_between(own, ratio, _turns(own), float(np.median(np.diff(times))))
        if units is None:
            continue
        why = f"as its derivative is {speed.name!r}"
        changed = {"position": offer if offer.why else replace(offer, why=why)}
        for q, unit in units.items():
            why = ", ".join(filter(None, (own[q].why, f"as {speed.name!r} is then the derivative")))
            changed[q] = replace(own[q], unit=unit, stated=False, why=f"{why} of {offer.name!r}")
        found = {**found, **changed}
        break
    return {q: found[q] for q in sorted(found, key=[*GUESSED, *found].index)}


def _over_way(times: measurement.Array, speed: measurement.Array, x: measurement.Array) -> float:
    """Return positions (n,) over the integral of a velocity; 0 if they are in no proportion."""
    known = np.isfinite(times) & np.isfinite(speed) & np.isfinite(x)
    t, v, x = times[known], speed[known], x[known]
    steps = np.diff(t)
    varied = t.size >= FEWEST_SAMPLES and float(np.ptp(v)) > HALF * float(np.abs(v).max())
    if not varied or not np.ptp(x) or np.any(steps <= 0.0):
        return 0.0
    way = np.concatenate([[0.0], np.cumsum(steps * (v[1:] + v[:-1]) / 2.0)])
    alike = np.ptp(way) > 0.0 and np.corrcoef(way, x)[0, 1] > 1.0 - NEGLIGIBLE
    return float(np.polyfit(way, x, 1)[0]) if alike else 0.0


def _units_between(
    own: Mapping[str, Found], ratio: float, turning: bool, step: float
) -> dict[str, str] | None:
    """Return units, other than those of SI, by which a position is the integral of a velocity.

    They are None if no units do that, or several pairs as well. Times with steps of 1 or more are
    rather in a part of a second than speeds in one of their unit.
    """
    fits: list[dict[str, str]] = []
    for turns in (True,) if turning else (False, True):
        kinds = {q: meaning_of(q).units[turns * (q != "time")] for q in own}
        offered = [(own[q].unit or "",) if own[q].unit else OFFERED[kinds[q]] for q in own]
        for units in itertools.product(*offered) if ratio and not fits else ():
            pairs = dict(zip(own, units, strict=True))
            if not all(is_of(unit, kinds[q]) for q, unit in pairs.items()):
                continue
            x, v, t = (factor(unit, kinds[q]) for q, unit in pairs.items())
            # times in a stated unit were converted to seconds before
            if abs(ratio * x / (v * (1.0 if own["time"].unit else t)) - 1.0) < ROUNDED:
                fits.append({q: u for q, u in pairs.items() if u not in (own[q].unit, kinds[q])})
    fewest = [units for units in fits if len(units) == min(map(len, fits))]
    if len(fewest) > 1 and step >= 1.0:
        fewest = [units for units in fewest if "time" in units]
    return fewest[0] if len(fewest) == 1 else None


def _numbers(frame: QuantityTable, candidate: Found) -> measurement.Array:
    """Return the numbers of a column, NaN where there are none."""
    column = frame.data[frame.names[candidate.name]]
    return pd.to_numeric(column, errors="coerce").to_numpy(dtype=float, na_value=np.nan)


def _stays(frame: QuantityTable, column: Found) -> bool:
    """Whether a column that nobody named has one value throughout."""
    numbers = _numbers(frame, column)
    known = numbers[np.isfinite(numbers)]
    return column.why != "as given" and bool(np.all(known == known[:1]))


def _are_of_sensor(taken: Mapping[str, Found]) -> bool:
    """Whether force and load are those of one sensor, Fx beside Fz, whose speed is known."""
    ends = [parts_of(_unit_in_name(taken[q].name, q)[0])[-1:] for q in ("force", "load")]
    named = "as given" in {taken[q].why for q in ("force", "load")}
    return ends == [["fx"], ["fz"]] and not named and "friction" not in taken


def _is_its_size(frame: QuantityTable, taken: Mapping[str, Found]) -> bool:
    """Whether the friction of a tribometer is the size of the force, or that over the load.

    The force is then what the sensor shows, with its sign, and drives nothing.
    """
    force, friction = (np.abs(_numbers(frame, taken[name])) for name in ("force", "friction"))
    unit = taken["friction"].unit
    if taken["friction"].why == "as given" or taken["force"].why == "as given":
        return False
    if unit is not None and is_of(unit, "1"):
        if "load" not in taken:
            return False
        friction = friction * np.abs(_numbers(frame, taken["load"])) * factor(unit, "1")
    elif unit != taken["force"].unit:
        return False
    known = np.isfinite(force) & np.isfinite(friction)
    apart = np.abs(force - friction)[known]
    usual = float(np.median(force[known])) if known.any() else 0.0
    return usual > 0.0 and bool(np.median(apart) <= ROUNDED * usual)


def _by_kind(
    frame: QuantityTable,
    left: Sequence[str],
    given: Mapping[str, Found],
    quantities: Sequence[str],
    turning: bool,
    units: Mapping[str, str],
) -> dict[str, Found]:
    """Return the column of each quantity, if all units are those of one kind of motion.

    The `units` of quantities that are given are those of whatever columns these have.
    """
    taken = dict(given)
    offers = [
        (match.score, -place, quantity, match)
        for place, name in enumerate(left)
        for quantity in quantities
        for offer in _offers(frame, name, quantity)
        for match in [
            replace(offer, unit=units[quantity], stated=False) if units.get(quantity) else offer
        ]
        if _is_of_kind(match, quantity, turning)
    ]
    for _, _, quantity, match in sorted(offers, key=lambda offer: offer[:2], reverse=True):
        alike = quantity in taken and match.name != taken[quantity].name
        alike = alike and not _stays(frame, match)
        if alike and match.score == taken[quantity].score and quantity not in given:
            taken[quantity] = replace(taken[quantity], others=(*taken[quantity].others, match.name))
        if quantity in taken or match.name in {column.name for column in taken.values()}:
            continue
        if "force" in taken and quantity == "current" and taken["force"].score >= PART:
            continue  # measured as well, but the force is what is wanted
        taken[quantity] = match
    moving = {"position", "velocity"} & taken.keys()
    if len(moving) == 1 and not moving & given.keys():  # two might be of two axes
        taken |= {q: _most_moving(frame, taken[q]) for q in moving}
    return taken


def _most_moving(frame: QuantityTable, offer: Found) -> Found:
    """Return the component that moves most of those that are called alike but for their axis.

    A pendulum turns about one axis of a sensor, and any may be the first.
    """
    axis = re.compile(r"(?<![a-z])[xyz](?![a-z])", re.IGNORECASE)
    stem = axis.sub("", offer.name)
    alike = [name for name in offer.others if axis.sub("", name) == stem != offer.name]
    if not alike:
        return offer
    spreads = {
        name: float(np.nanstd(_numbers(frame, replace(offer, name=name))))
        for name in (offer.name, *alike)
        if frame.units.get(name) == frame.units.get(offer.name)
    }
    best = max(spreads, key=lambda name: spreads[name])
    others = tuple(name for name in (offer.name, *offer.others) if name != best)
    return replace(offer, name=best, others=others, most_moving=True)


def _is_of_kind(found: Found, quantity: str, turning: bool) -> bool:
    kinds = meaning_of(quantity).units
    if found.unit is None or len(kinds) < 2 or is_of(found.unit, "count"):
        return True
    return not is_of(found.unit, kinds[not turning])


def _offers(frame: QuantityTable, name: str, quantity: str) -> Iterable[Found]:
    """Yield what speaks for a column as that of a quantity, if anything does."""
    if frame.is_empty(name):
        return
    column = frame.data[frame.names[name]]
    numeric = pd.api.types.is_numeric_dtype(column.dtype)
    upside_down = quantity == "time" and _is_upside_down(column, name, frame.units.get(name))
    if quantity == "time" and not (upside_down or _may_be_times(column)):
        return
    if (quantity != "time" and not numeric) or name == "V":  # volts, not a velocity
        return
    stated = frame.units.get(name)
    bare, unit = _bare_and_unit(name, stated, quantity)
    if quantity == "time" and name in frame.rates:
        yield Found(score=BY_UNIT, name=name, unit=unit, stated=True, why=frame.rates[name])
        return
    since = _since_epoch(column) if quantity == "time" and unit is None else None
    score, why = _score(bare, unit, quantity)
    if since:
        unit = since
        why = f"{why}, as its numbers count from 1970".removeprefix(", ")
        score = score or BY_UNIT
    rises = quantity == "time" and not _is_named(name, WORDS["conditions"]) and _increases(column)
    if unit is None and not score and rises:
        score, why = BY_VALUES, "because it increases"
    if score:
        stamps = "" if numeric else "time stamps, "
        yield Found(score=score, name=name, unit=unit, stated=unit == stated, why=stamps + why)


def _bare_and_unit(name: str, stated: str | None, quantity: str) -> tuple[str, str | None]:
    """Return the name of a column without its unit, and the unit as it is spelt, or None."""
    if stated and not (stated == "1" or is_unit(stated)):
        return name, None
    bare, unit = (name, stated) if stated else _unit_in_name(name, quantity)
    if unit is not None and unit.isupper() and not is_unit_of(unit, quantity):
        unit = unit.lower() if is_unit_of(unit.lower(), quantity) else unit  # MM is no molarity
    if unit is None and quantity == "friction" and _is_coefficient(bare):
        return bare, "1"
    if unit is None and quantity == "time":
        return bare, COUNTED.get(bare)
    if unit is None:
        plain = re.sub("|".join(WORDS["voltage"]), "", bare, flags=re.IGNORECASE)
        return (plain, "V") if plain != bare else (bare, None)
    return bare, unit


def _is_coefficient(name: str) -> bool:
    """Whether a name is that of a coefficient, which is over the load."""
    return any(part in WORDS["coefficients"] or part.startswith("coeff") for part in parts_of(name))


def _score(bare: str, unit: str | None, quantity: str) -> tuple[float, str]:
    """Return how well name and unit of a column fit a quantity, and that in words."""
    fits = unit is not None and is_unit_of(unit, quantity)
    counts = unit is not None and quantity in ("position", "reference") and is_of(unit, "count")
    volts = unit is not None and bool(meaning_of(quantity).sensitivity) and is_of(unit, "V")
    if unit is not None and not _may_have(unit, quantity):
        return 0.0, ""
    if volts and len(bare.strip(" _")) < 2:  # u [V] and v [V] are voltages
        return 0.0, ""
    score, why = _named_score(bare, quantity)
    rivals = [other for other in GUESSED if not fits or is_unit_of(unit or "", other)]
    most = max(_named_score(bare, other)[0] for other in rivals)
    if score and score == most and not _last_says(bare, quantity):
        preferred = any(part in WORDS["preferred"] for part in parts_of(bare))
        return score + fits + 0.1 * preferred, why
    if counts and not bare:
        return BY_UNIT, "by its name"
    by_name = quantity in ("reference", "load", "friction")  # other forces have the same unit
    inside = any(_is_input(bare, other) for other in ("transmitted", "external", "gravity"))
    if (
        fits
        and unit not in ("1", "Hz")
        and not (by_name or most or inside or _is_other(bare, quantity))
    ):
        return BY_UNIT, "by its unit"
    return 0.0, ""


def _may_have(unit: str, quantity: str) -> bool:
    """Whether the column of a quantity may have a unit: one of its kind, counts or volts."""
    counts = quantity in ("position", "reference") and is_of(unit, "count")
    volts = bool(meaning_of(quantity).sensitivity) and is_of(unit, "V")
    return is_unit_of(unit, quantity) or counts or volts


def _since_epoch(column: "pd.Series[Any]") -> str | None:
    """Return the unit of times that count from 1970 in parts of a second, by their size."""
    part = column.iloc[:CHECKED].dropna()
    if part.empty or not pd.api.types.is_numeric_dtype(part.dtype):
        return None
    size = float(part.median())
    return next((unit for unit, per in EPOCH.items() if 1e9 * per <= size < 1e10 * per), None)


def _is_other(name: str, quantity: str) -> bool:
    """Whether a name is that of an error, a condition or a command, which a quantity is not."""
    parts = parts_of(name)
    return (
        is_barred(parts, quantity)
        or is_wanted(parts)
        or any(part in WORDS["conditions"] for part in parts)
    )


def _last_says(name: str, quantity: str) -> bool:
    """Whether the last part of a path, as in ``tau.Time``, says that a column is another one."""
    last = re.split(r"[./:]", name)[-1]
    if last == name or len(last) < 2 or _named_score(last, quantity)[0]:
        return False
    return any(_named_score(last, other)[0] >= WHOLE for other in GUESSED)


def _named_score(name: str, quantity: str) -> tuple[float, str]:
    """Return how well a name fits a quantity, and that in words."""
    first, joint = joint_in(name)
    if joint:
        return (WHOLE, "by its name") if first == quantity else (0.0, "")
    parts = parts_of(name)
    joined = "".join(parts)
    if _is_rival(parts, quantity):
        return 0.0, ""
    if quantity == "velocity" and DERIVATIVE.fullmatch(joined):
        return WHOLE + 0.2, "by its name"  # of q_d beside qdot, the d says less
    wanted = is_wanted(parts)
    words = meaning_of(quantity).names
    if quantity == "reference" and wanted:
        bare = "".join(part for part in parts if part not in WORDS["wanted"])
        moves = any(word in joined for word in VOCABULARY["position"].names if len(word) > 2)
        if moves or joined in words or bare in VOCABULARY["position"].names:
            return WHOLE + 0.5, "by its name"
        return 0.0, ""
    if wanted and quantity not in ("force", "time"):
        return 0.0, ""
    rolls = quantity == "velocity" and any(part in WORDS["rolling"] for part in parts)
    less = 1.5 if wanted or rolls else 0.0  # a sliding speed beside it comes first
    if joined in words:
        return WHOLE - less, "by its name"
    if any(part in words and len(part) > 1 for part in parts):
        return PART - less, "by its name"
    if any(word in joined for word in words if len(word) > 3):
        return INSIDE - less, "by its name"
    if len(parts) < 3 and any(part in words for part in parts):  # of force_x, x says less
        return LETTER - less, "by its name"
    return 0.0, ""


def _is_rival(parts: Sequence[str], quantity: str) -> bool:
    """Whether the words of a name are those of something else with the word of a quantity."""
    joined = "".join(parts)
    if is_barred(parts, quantity):
        return True
    if quantity == "load":
        return any(word in joined for word in ("torque", "moment", "present"))
    if quantity == "force":  # a friction torque is no torque of a drive
        return any(part in VOCABULARY["friction"].names for part in parts)
    if quantity == "position":  # the speed of an angle
        speed = any(len(part) > 1 and part in VOCABULARY["velocity"].names for part in parts)
        return speed or any(map(DERIVATIVE.fullmatch, (joined, *parts)))
    return False


def _unit_in_name(name: str, quantity: str) -> tuple[str, str | None]:
    """Return a name without the unit that it carries, one of the quantity if there is one."""
    if len(name) > LONGEST_NAME:
        return name, None
    result = [style.fullmatch(name) for style in STYLES]
    words = {hit["unit"].strip() for hit in result[len(SURE_STYLES) :] if hit}
    parts = [(hit["name"], hit["unit"].strip()) for hit in result if hit and is_unit(hit["unit"])]
    parts = [part for part in parts if not (part[1] in words and part[1] in WORDS["calendar"])]
    own = [part for part in parts if is_unit_of(part[1], quantity)]
    if not own and (rate := RATE.fullmatch(name)):  # speed_mm_s
        unit = f"{rate['unit']}/{rate['per']}"
        own = [(rate["name"], unit)] if is_unit(unit) and is_unit_of(unit, quantity) else []
    if (
        not parts
        and len(name) > 1
        and not name[-1].isdigit()  # A1, V1 and m1 are names of channels
        and name.casefold() not in meaning_of(quantity).names
        and not DERIVATIVE.fullmatch(name)
        and is_unit(name)
    ):
        return "", name  # counts, rpm
    others = [part for part in parts if part[1] not in words or part[1] in WORDS["volts"]]
    return next(iter((*own, *others)), (name, None))


def _may_be_times(column: "pd.Series[Any]") -> bool:
    """Whether times may stand in a column: stamps, or numbers that mostly increase."""
    part = column.iloc[:CHECKED].dropna()
    if part.empty:
        return False
    if not pd.api.types.is_numeric_dtype(part.dtype):
        if isinstance(part.iloc[0], str) and not text_layout.is_stamp(part.iloc[0].strip()):
            return False
        seconds = text_layout.seconds_of(part)
        return seconds is not None and len(seconds) > 1 and not _are_coarse(seconds)
    return share_later(part) > NEARLY_ALL


def _are_coarse(seconds: measurement.Array) -> bool:
    """Whether time stamps are equal in many rows: those of whole seconds are no times of samples.

    Sorting by time would average these rows.
    """
    return bool(np.mean(np.diff(seconds) == 0.0) > 1.0 - NEARLY_ALL)


def share_later(column: "pd.Series[Any]") -> float:
    """Return the share of the steps of a column of numbers that go up; 0 of a single row."""
    steps = np.diff(column.to_numpy(dtype=float))
    return float(np.mean(steps > 0.0)) if steps.size else 0.0


def _is_upside_down(column: "pd.Series[Any]", name: str, stated: str | None) -> bool:
    """Whether a column that is called time has the last time first."""
    part = column.iloc[:CHECKED].dropna()
    if len(part) < 2 or not pd.api.types.is_numeric_dtype(part.dtype):
        return False
    bare, _ = _bare_and_unit(name, stated, "time")
    return _named_score(bare, "time")[0] >= WHOLE and share_later(-part) > NEARLY_ALL


def clock_of(frame: QuantityTable, used: Collection[str]) -> tuple[str, measurement.Array] | None:
    """Return the column that says when steady readings were taken, and its times (n,) [s].

    It is called time, nothing else was read from it, though it may have been said to be no times of
    samples, and no time is twice in it.
    """
    keys = {header: name for name, header in frame.names.items()}
    for header in frame.data.columns:
        name = keys.get(header, str(header).partition("[")[0].strip())
        if not name or name in used:
            continue
        bare, unit = _bare_and_unit(name, frame.units.get(name), "time")
        if _named_score(bare, "time")[0] < WHOLE or (unit and not is_unit_of(unit, "time")):
            continue
        column = frame.data[header]
        numeric = pd.api.types.is_numeric_dtype(column.dtype)
        times = column.to_numpy(dtype=float) if numeric else text_layout.seconds_of(column)
        if times is not None and np.isfinite(times).all() and np.unique(times).size == times.size:
            return name, times
    return None


def _increases(column: "pd.Series[Any]") -> bool:
    """Whether a column increases in steps of nearly one size, or holds time stamps."""
    part = column.iloc[:CHECKED].dropna()
    if not pd.api.types.is_numeric_dtype(part.dtype):
        return True  # stamps, as was found before
    steps = np.diff(part.to_numpy(dtype=float))
    return bool(np.all(steps > 0.0) and np.ptp(steps) < 0.1 * np.median(steps))


def _check_enough(frame: QuantityTable, found: Mapping[str, Found]) -> None:
    """Refuse what is neither a motion in time nor friction at velocities."""
    listed = ", ".join(map(shown, [name for name in frame.names if name][:12]))
    for name in frame.names if "time" not in found else ():
        if _named_score(_unit_in_name(name, "time")[0], "time")[0] >= PART:
            frame.raw(name)  # says which cell is no number, if that is why it was passed over
    for name in frame.names:
        _refuse_faults(frame, name)
    if any(name in frame.names for name in measurement.TRAVELS):
        raise InputError(
            f"{frame.file}: is a table of travels, one trial a row, not a record: name it in a rig"
            " file of your mechanism, as [data] file, or as --data of `stickslip select`."
        )
    map_of = {"velocity", "friction"} <= set(found)
    if len(frame.data) < 2 and not map_of:
        raise InputError(f"{frame.file}: has one row of numbers: a record in time has at least 2.")
    if "time" not in found and not map_of:
        for name in frame.names:
            _refuse_disorder(frame, name)
        rates = joined([*frame.rates])
        several = f", and the lines above state several rates, {rates}" if rates else ""
        raise InputError(
            f"{frame.file}: no column seems to hold times{several}; the columns are {listed}. Name"
            ' it, as columns={"time": "..."}, or give the rate of the rows, as'
            ' columns={"time": "50 Hz"}.'
        )
    if not ({"position", "velocity"} & set(found)):
        for name in frame.names:
            _refuse_text(frame, name)
            _refuse_rotation(frame, name, found)
        raise InputError(
            f"{frame.file}: no column seems to hold a position or a velocity; the columns are"
            f' {listed}. Name it, as columns={{"position": "..."}}.'
        )


def _refuse_faults(frame: QuantityTable, name: str) -> None:
    """Say which cell of a quantity's column is no number, such as #DIV/0!, if most of them are."""
    column = frame.data[frame.names[name]]
    if pd.api.types.is_numeric_dtype(column.dtype) or not len(column):
        return
    bare = {q: _bare_and_unit(name, frame.units.get(name), q) for q in GUESSED if q != "time"}
    if not any(_score(*said, q)[0] >= LETTER for q, said in bare.items()):
        return
    cells = column.iloc[:CHECKED].dropna()
    if cells.map(lambda cell: text_layout.is_number(str(cell).strip())).mean() > HALF:
        frame.raw(name)


def _refuse_rotation(frame: QuantityTable, name: str, found: Mapping[str, Found]) -> None:
    """Ask for the radius of the contact where a speed is one of rotation, and forces are none."""
    unit = _bare_and_unit(name, frame.units.get(name), "velocity")[1]
    forces = [found[q].unit for q in ("force", "friction", "load") if q in found]
    turns = unit is not None and is_of(unit, "rad/s") and not is_of(unit, "count")
    if turns and any(force is not None and is_of(force, "N") for force in forces):
        raise InputError(
            f"{frame.file}: the column {shown(name)} is a speed of rotation, and forces are in N:"
            f" name it and give the radius of the contact, as --columns velocity={shown(name)}"
            " --gain velocity='9 mm/rad'."
        )


def _refuse_text(frame: QuantityTable, name: str) -> None:
    """Say which cell of a column is no number where its name is that of a motion."""
    column = frame.data[frame.names[name]]
    bare = {q: _bare_and_unit(name, frame.units.get(name), q) for q in ("position", "velocity")}
    named = any(_score(*said, q)[0] >= PART for q, said in bare.items())
    if named and len(column) and not pd.api.types.is_numeric_dtype(column.dtype):
        frame.raw(name)


def _refuse_disorder(frame: QuantityTable, name: str) -> None:
    """Say of a column that is called time why it holds none."""
    bare, unit = _bare_and_unit(name, frame.units.get(name), "time")
    column = frame.data[frame.names[name]]
    if _named_score(bare, "time")[0] < PART:
        return
    if not pd.api.types.is_numeric_dtype(column.dtype):
        seconds = text_layout.seconds_of(column.iloc[:CHECKED].dropna())
        if seconds is not None and len(seconds) > 1 and _are_coarse(seconds):
            raise InputError(
                f"{frame.file}: the column {shown(name)} has one time stamp for several rows: give"
                " times with parts of a second."
            )
        return
    later = share_later(column.iloc[:CHECKED].dropna())
    if later > NEARLY_ALL and unit:
        raise InputError(
            f"{frame.file}: the column {shown(name)} is in {unit}, which is no unit of time. Name"
            ' the right one, as units={"time": "s"}.'
        )
    raise InputError(
        f"{frame.file}: the column {shown(name)} holds no times of samples: from row to row, only"
        f" {percent(later)} of them increase. Sort the rows by time, or name another column, as"
        ' columns={"time": "..."}.'
    )


def _geared(found: Mapping[str, Found], gain: Mapping[str, float | str]) -> dict[str, Found]:
    """Return columns with the units that gains with a unit make of theirs: 9 mm/rad of rpm."""
    units = {q: str(gain[q]).partition(" ")[2] for q in found if isinstance(gain.get(q), str)}
    return {
        q: replace(read, unit=f"{units[q]} * {read.unit}") if read.unit and units.get(q) else read
        for q, read in found.items()
    }


def _turns(
    found: Mapping[str, Found],
    motor_constant: float | str | None = None,
    headers: Sequence[str] = (),
) -> bool:
    """Whether an axis turns: by units, or by names where there are none."""
    for quantity, column in found.items():
        kinds = meaning_of(quantity).units
        if column.unit and len(kinds) > 1:
            straight, turns = (is_of(column.unit, kind) for kind in kinds[:2])
            if straight or turns:
                return turns
    unit = motor_constant.strip().partition(" ")[2] if isinstance(motor_constant, str) else ""
    if unit:
        return is_of(unit, "N m/A")
    still = ("time", "load", "temperature")
    names = [candidate.name for q, candidate in found.items() if q not in still]
    moving = [name.casefold() for name in names]
    if any("ang" in parts_of(name) for name in names) or any(
        joint_in(name)[1] or (numbered(name)[1] and "q" in parts_of(name)) for name in moving
    ):
        return True  # coordinates of the joints of a robot
    if sum(bool(PHASE.search(name.casefold())) for name in headers) > 1:
        return True  # a motor by its phases
    place = found.get("position")
    if place is not None and place.unit and is_of(place.unit, "count") and "force" not in found:
        own = place.name.casefold()
        return "lin" not in own and ("enc" in own or "current" in found)
    return any(word in name for name in moving for word in WORDS["turning"])


def _with_unit(motor_constant: float | str, unit: str) -> str:
    """Return a motor constant with a unit; a plain number is in SI."""
    text = str(motor_constant).strip()
    return text if " " in text else f"{text} {unit}"


def column_text(candidate: Found, column: Column = "") -> str:
    """Return where a quantity was found, in words; a position may have two columns."""
    if text_layout.regular_times(candidate.name, 1) is not None:
        every = "at" if candidate.name.endswith("Hz") else "a step apart of"
        return f"rows {every} {candidate.name}, {candidate.why}"
    unit = f" in {candidate.unit}" if candidate.unit else ""
    if column and not isinstance(column, str):
        return f"columns {joined(list(map(repr, column)))}{unit}, {candidate.why}"
    return f"column {candidate.name!r}{unit}, {candidate.why}"


def rate_text(times: measurement.Array) -> str:
    """Return number and rate of the samples in words, and what gaps there are."""
    steps = np.diff(times[np.isfinite(times)])
    if np.all(steps < 0.0):  # the last one stands first
        steps = -steps
    step = float(np.median(steps))
    samples = count(len(times), "sample")
    if not step > 0.0:
        return f"; {samples}"
    wide = steps[steps > GAP * step]
    gaps = (
        f", {count(wide.size, 'gap')} of up to {number(float(wide.max()), 3)} s"
        if wide.size
        else ""
    )
    return f"; {samples}, {number(1.0 / step, 4)} Hz{gaps}"


def _as_friction(of_drive: Mapping[str, Any]) -> dict[str, Any]:
    """Return what belongs to quantities, that of a drive to the friction at steady speeds."""
    return {("friction" if q in ("force", "current") else q): x for q, x in of_drive.items()}


def _is_steady(frame: QuantityTable, found: Mapping[str, Found], times: measurement.Array) -> bool:
    """Whether rows are steady readings of friction, whose times say when they were taken."""
    resisting = [q for q in ("friction", "force", "current") if q in found]
    if len(resisting) != 1 or "velocity" not in found or "position" in found:
        return False
    columns = [frame.data[frame.names[found[q].name]] for q in ("velocity", *resisting)]
    rows = [times, *(pd.to_numeric(column, errors="coerce").to_numpy(float) for column in columns)]
    full = np.isfinite(rows).all(axis=0)
    return bool(full.sum() > 1) and are_steady_readings(*(row[full] for row in rows))


def times_of(frame: QuantityTable, offer: Found) -> measurement.Array | None:
    """Return the times of a record [s], NaN where there are none."""
    key = next((k for k in frame.names if offer.name in (k, frame.names[k])), None)
    if key is None:
        return None
    column = frame.data[frame.names[key]]
    if not pd.api.types.is_numeric_dtype(column.dtype):
        return text_layout.seconds_of(column)
    values = column.to_numpy(dtype=float)
    if offer.unit and not is_unit_of(offer.unit, "time"):
        raise InputError(
            f"{frame.file}: the column {shown(offer.name)} is in {offer.unit}, which is no unit of"
            " time: give its unit, as --unit time=s, or name another column."
        )
    return values * (factor(offer.unit, "s") if offer.unit else 1.0)


def repairs_of(
    frame: QuantityTable, found: Mapping[str, Found], times: measurement.Array | None, trial: str
) -> tuple[text_layout.Repair, ...]:
    """Return what the reader would refuse, and can repair."""
    gaps = not _full_rows(frame, found).all()
    late = False
    if times is not None:
        known = np.isfinite(times)
        there = times[known]
        back = np.diff(there) <= (0.0 if trial else text_layout.nearly_zero(np.sort(there)))
        if trial:  # each has times of its own
            numbers = frame.data[frame.names.get(trial, trial)].to_numpy()[known]
            back &= numbers[1:] == numbers[:-1]
        late = bool(back.any())
    held = bool(_held(frame, found))
    steps: dict[text_layout.Repair, bool] = {"hold": held, "gaps": gaps, "sort": late}
    return tuple(name for name, needed in steps.items() if needed)


def _full_rows(frame: QuantityTable, found: Mapping[str, Found]) -> NDArray[np.bool_]:
    """Return which rows have a finite number, or a text, in all columns that are read."""
    headers = [
        frame.names[key]
        for column in found.values()
        for key in frame.names
        if column.name in (key, frame.names[key])
    ]
    cells = frame.data[headers]
    return ~(cells.isna() | cells.isin([np.inf, -np.inf])).any(axis=1).to_numpy()


def _held(frame: QuantityTable, found: Mapping[str, Found]) -> list[str]:
    """Return the quantities that hold until their next value: what drives, in rows of its own.

    What was measured in rows of its own is interpolated before, if some rows have it all.
    """
    motion = {q: x for q, x in found.items() if q.partition(".")[0] not in text_layout.DRIVES}
    full, moves = _full_rows(frame, found), _full_rows(frame, motion)
    drives = [
        q for q, x in found.items() if q not in motion and not _full_rows(frame, {q: x}).all()
    ]
    words = {*WORDS["commands"], *WORDS["wanted"]}
    commands = all(q.startswith("reference") or _is_named(found[q].name, words) for q in drives)
    apart = full.mean() < HALF and moves.sum() > full.sum()
    return drives if apart and (commands or not full.any()) else []


def rates_doubt(frame: QuantityTable, found: Mapping[str, Found]) -> Iterator[str]:
    """Yield that most rows lack a cell, as where channels were sampled at other times."""
    if held := _held(frame, found):
        yield (
            f"Rows with {joined([repr(found[q].name) for q in held])} are others than those of the"
            " motion: each value holds until the next, as a command does."
        )
        return
    full = _full_rows(frame, found)
    cure = "Interpolate channels of different rates to the times of one of them first"
    if not full.any():
        raise InputError(f"{frame.file}: no row has all of its columns. {cure}.")
    if full.mean() < HALF:
        yield (
            f"Only {count(int(full.sum()), 'row')} of {full.size:,} have all of these columns, and"
            f" the others are left out. {cure}, if that is too few."
        )


def _refuse_restarts(frame: QuantityTable, times: measurement.Array) -> None:
    """Refuse several records below each other, which sorting by time would mix."""
    begins = restarts(times)
    if begins:
        raise InputError(
            f"{frame.file}: times begin again at {frame.line(begins[0])}: it seems to hold"
            f" {count(len(begins) + 1, 'record')} below each other. Number them in a column"
            " 'trial', or give each a file of its own."
        )


def restarts(times: measurement.Array) -> list[int]:
    """Return the rows at which further records begin, whose times begin again.

    Examples
    --------
    >>> restarts(np.tile(np.arange(100.0), 3))
    [100, 200]
    """
    rows = np.flatnonzero(np.isfinite(times))
    known = times[rows]
    back = np.flatnonzero(np.diff(known) < 0.0)
    # the first rows span nothing, and many steps back are no records
    least = HALF * float(np.ptp(known)) / (back.size + 1) if known.size else 0.0
    result, first = [], 0
    for last in back.tolist() if back.size < SLIGHT * known.size else ():
        span = float(np.ptp(known[first : last + 1]))
        if span > least and known[last] - known[last + 1] > HALF * span:
            result.append(int(rows[last + 1]))
            first = last + 1
    return result


def repair_text(repair: Sequence[text_layout.Repair]) -> str:
    """Return what is repaired, in words."""
    why = {
        "hold": "commands have rows of their own",
        "gaps": "cells are empty or not finite",
        "sort": "times do not increase everywhere",
    }
    return " and ".join(f"{name}: {why[name]}" for name in repair)


def _is_raw(unit: str | None) -> bool:
    """Whether a unit is one of a sensor, of which only its gain makes a quantity."""
    return unit is not None and (is_of(unit, "count") or is_of(unit, "V"))


def _gain(quantity: str, turning: bool, unit: str | None) -> str:
    """Return an assumed gain of a column in counts or volts."""
    if unit is not None and is_of(unit, "count"):
        return "0.001 rad/count" if turning else "0.001 mm/count"
    return meaning_of(quantity).sensitivity[turning]


def _of_one_joint(frame: QuantityTable, given: Mapping[str, Column]) -> list[str]:
    """Return the columns without those of further joints: q2 does not go with tau1."""
    known = [name for name in given.values() if isinstance(name, str)]
    inputs = inputs_in([*frame.names])
    names = [name for name in frame.names if name and (name in known or name not in inputs)]
    wanted = next((numbered(name)[1] for name in known if numbered(name)[1]), "")
    joint = wanted or _first_moving(frame, joints_in(names))
    if not joint:
        return names
    numbers = {numbered(name)[1] for name in names}
    families = {numbered(name)[0] for name in names if numbered(name)[1] == joint}
    others = numbers - {"", joint}
    return [
        name
        for name in names
        if name in known
        or not (
            numbered(name)[1] in others and (joint_in(name)[1] or numbered(name)[0] in families)
        )
    ]


def _first_moving(frame: QuantityTable, joints: Collection[str]) -> str:
    """Return the first joint that does not rest where another moves; empty if there are none."""
    spreads: dict[str, dict[str, float]] = {}
    for name in filter(None, frame.names if joints else ()):
        stem, joint = numbered(name)
        moves = any(_named_score(stem, quantity)[0] > 0.0 for quantity in ("position", "velocity"))
        if joint in joints and moves and not frame.is_empty(name):
            numbers = pd.to_numeric(frame.data[frame.names[name]], errors="coerce")
            spreads.setdefault(stem, {})[joint] = float(numbers.std())
    moving = (
        joint
        for joint in joints
        if all(of[joint] > NEGLIGIBLE * max(of.values()) for of in spreads.values() if joint in of)
    )
    return next(moving, next(iter(joints), ""))


def joint_in(name: str) -> tuple[str, str]:
    """Return quantity and joint of a column called by both; empty texts if it is not.

    Examples
    --------
    >>> joint_in("position.elbow"), joint_in("position.time"), joint_in("position.actual")
    (('position', 'elbow'), ('', ''), ('', ''))
    """
    first, _, joint = name.partition(".")
    known = first in ("time", *measurement.BY_JOINT, "reference", "current") and "." not in joint
    none = ("", *VOCABULARY["time"].names, *WORDS["measured"], *WORDS["wanted"])
    return (first, joint) if known and joint.casefold() not in none else ("", "")


def numbered(name: str) -> tuple[str, str]:
    """Return a name without the number or name of its joint, and that."""
    first, joint = joint_in(name)
    if joint:
        return f"{first}.#", joint
    bare = _unit_in_name(name, "position")[0] or name
    result = re.search(r"(?<!\d)(\d{1,2})(?!\d)(?=[^\d]*$)", bare)
    if result is None:
        return bare.casefold(), ""
    return (bare[: result.start()] + "#" + bare[result.end() :]).casefold(), result[1]


def inputs_in(names: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Return input and joint of columns such as motor.elbow, where a joint elbow moves.

    Examples
    --------
    >>> inputs_in(["position.elbow", "motor.elbow", "motor.position"])
    {'motor.elbow': ('motor', 'elbow')}
    """
    joints = _moving(names)
    parts = {name: name.partition(".") for name in names if measurement.is_beside(name)}
    return {name: (first, joint) for name, (first, _, joint) in parts.items() if joint in joints}


def _moving(names: Sequence[str]) -> dict[str, None]:
    """Return the names of joints whose positions or speeds have columns."""
    return dict.fromkeys(
        joint for first, joint in map(joint_in, names) if first in ("position", "velocity")
    )


def joints_in(names: Sequence[str]) -> dict[str, None]:
    """Return the numbers or names of joints, if positions or speeds of several have columns."""
    named = _moving(names)
    if len(named) > 1:
        return named
    stems: dict[str, dict[str, None]] = {}
    for name in names:
        stem, number_ = numbered(name)
        if number_ and not _is_other(stem, "position"):
            stems.setdefault(stem, {})[number_] = None
    several = [(stem, numbers) for stem, numbers in stems.items() if len(numbers) > 1]
    for stem, numbers in several:
        moves = any(_named_score(stem, q)[0] > 0.0 for q in ("position", "velocity"))
        driven = any(
            others == numbers and any(_named_score(name, q)[0] > 0.0 for q in ("force", "current"))
            for name, others in several
        )
        if moves and driven:  # positions alone may be those of several sensors of one axis
            return numbers
    return {}


def trial_column(
    frame: QuantityTable,
    given: Mapping[str, Column],
    found: Mapping[str, Found],
    times: measurement.Array | None,
) -> tuple[str, str]:
    """Return the column that numbers or names trials, and why; empty if none does.

    Whatever it is called, it is one that has another value where times begin again, and no value
    in two places.
    """
    if "trial" in given:
        return str(given["trial"]), "as given"
    taken = {column.name for column in found.values()}
    begins = [] if times is None else restarts(times)
    apart = ""
    for name in frame.names:
        if name in taken:
            continue
        cells = frame.data[frame.names[name]]
        values = cells.nunique()
        changes = np.flatnonzero((cells != cells.shift()).to_numpy())[1:].tolist()
        word = "".join(part for part in parts_of(name) if part not in WORDS["numbering"])
        # where it is named, all that it must do is come again; a "sample" may be a counter
        together = times is None or values == len(changes) + 1
        named = word in VOCABULARY["trial"].names or (together and word in WORDS["specimens"])
        if cells.isna().any() or not 1 < values <= (0.5 if named else SLIGHT) * len(cells):
            continue
        if named:
            return name, "by its name"
        if begins and not apart and changes == begins and values == len(begins) + 1:
            apart = name
    return apart, "which changes where times begin again"


def _conditions(frame: QuantityTable, found: Mapping[str, Found], trial: str) -> tuple[str, ...]:
    """Return the columns that seem to hold a condition."""
    taken = {*(column.name for column in found.values()), trial}
    return tuple(
        name
        for name in frame.names
        if name not in taken
        and (_is_named(name, WORDS["conditions"]) or _has_degrees(name, frame.units.get(name)))
        and bool(frame.data[frame.names[name]].notna().any())
    )


def _with_doubt(
    frame: QuantityTable, found: dict[str, Found], doubt: Found | None, *, table: bool
) -> dict[str, Found]:
    """Return columns with that of stated uncertainties, given or known by its name in a table."""
    table = table and {"velocity", "friction"} <= found.keys()
    offers = [doubt] if doubt else [*_doubt_offers(frame, found["friction"])] if table else []
    if not offers:
        return found
    first = max(offers, key=lambda offer: offer.score)
    others = tuple(offer.name for offer in offers if offer is not first)
    unit = None if _is_raw(first.unit) else first.unit  # then as the friction is
    kept = {q: column for q, column in found.items() if column.name != first.name}
    return {**kept, measurement.STATED: replace(first, unit=unit, others=others)}


def _doubt_offers(frame: QuantityTable, friction: Found) -> Iterator[Found]:
    """Yield columns with a word of errors in their name, and beside it the friction or nothing.

    Signed errors and codes of errors are none.
    """
    names = [*filter(None, frame.names)]
    own = parts_of(_bare_and_unit(friction.name, frame.units.get(friction.name), "friction")[0])
    forces = [
        [word] for q in ("friction", "force") for word in meaning_of(q).names if len(word) > 1
    ]
    for name in names:
        half, stated = is_half_width(frame.names[name]), frame.units.get(name)
        bare, unit = _bare_and_unit(name, stated, measurement.STATED)
        if half and not is_half_width(bare):  # 95 % is no unit
            bare, unit = f"{bare} 95 %", None
        elif not bare or parts_of(unit or "") == own:  # ci is no curie, u(F) is not in farads
            bare, unit = name, None
        first, *rest = parts_of(bare) or [""]
        of_force = rest == own or ("(" in bare and rest in [["f"], *forces])
        left = own if first == "u" and of_force else doubted(bare)
        # Without a unit, what stands before the friction may be of the velocity.
        behind = unit is not None or names.index(name) > names.index(friction.name)
        fits = unit in (None, friction.unit) or is_unit_of(unit or "", measurement.STATED)
        if fits and left is not None and (left in (own, *forces) or (behind and not left)):
            what = f"half-widths of 95 %, divided by {INTERVAL}"
            why = f"by its name: {what if half else 'the standard uncertainty of each reading'}"
            score = WHOLE if left else PART
            one = Found(score=score, name=name, unit=unit, stated=unit == stated, why=why)
            values = _numbers(frame, one)
            if np.any(values > 0.0) and not np.any(values < 0.0):
                yield one


def _is_named(name: str, words: Collection[str]) -> bool:
    """Whether the name of a column has one of the words, or ends as the German one of heat."""
    return any(part in words or part.endswith("temperatur") for part in parts_of(name))


def _unread(
    frame: QuantityTable, given: Mapping[str, Column], taken: Collection[str]
) -> dict[str, str]:
    """Return the columns that are neither given nor taken, as a reason."""
    read = {*taken}.union(*([name] if isinstance(name, str) else name for name in given.values()))
    left = [repr(name) for name in frame.names if name and name not in read]
    return {"not read": joined(left, MOST_LISTED)} if left else {}


def changing_temperature(
    parts: Sequence[QuantityTable], names: Iterable[str]
) -> Iterator[tuple[str, Found]]:
    """Yield the temperature that laws may contain: known at all times, and one that changes."""
    result = [
        Found(score=PART, name=name, unit=unit, stated=unit == stated, why=f"by its {why}")
        for name in names
        for named in [_is_named(name, WORDS["temperatures"])]
        for why in ["name" if named else "unit"]
        if named or _has_degrees(name, parts[0].units.get(name))
        for cells in [[part.data[part.names[name]] for part in parts]]
        if any(column.nunique() > 1 for column in cells)
        and all(np.isfinite(pd.to_numeric(column, errors="coerce")).all() for column in cells)
        for stated in [parts[0].units.get(name)]
        for unit in [_temperature_unit(name, stated)]
        if unit is None or unit in KELVINS
    ]
    if result:
        yield "temperature", replace(result[0], others=tuple(column.name for column in result[1:]))


def contact_inputs(frame: QuantityTable, taken: Mapping[str, Found]) -> Iterator[tuple[str, Found]]:
    """Yield what else friction may depend on, from columns that are named so and have no holes."""
    names = {column.name for column in taken.values()}
    for quantity in (name for name in INPUTS if name not in taken):
        own = [column for column in _input_offers(frame, quantity) if column.name not in names]
        full = [column for column in own if _is_full(frame, column.name)]
        if full:
            yield quantity, replace(full[0], others=tuple(column.name for column in full[1:]))


def _input_offers(frame: QuantityTable, quantity: str) -> Iterator[Found]:
    """Yield the columns whose name and unit are those of an input of the contact."""
    for name in filter(None, frame.names):
        stated = frame.units.get(name)
        bare, unit = _bare_and_unit(name, stated, quantity)
        fits = name == quantity if unit is None else is_unit_of(unit, quantity)
        if fits and _is_input(bare, quantity):
            yield Found(score=PART, name=name, unit=unit, stated=unit == stated, why="by its name")


def _is_input(bare: str, quantity: str) -> bool:
    """Whether a name is that of an input of the contact: its word alone, or any pressure."""
    parts = [part for part in parts_of(bare) if part not in WORDS["of forces"]]
    if quantity == "pressure":
        return any(part.endswith(meaning_of(quantity).names) for part in parts) and not _is_other(
            bare, quantity
        )
    return len(parts) == 1 and parts[0] in meaning_of(quantity).names


def _is_full(frame: QuantityTable, name: str) -> bool:
    """Whether all cells of a column are finite numbers."""
    column = frame.data[frame.names[name]]
    return bool(np.isfinite(pd.to_numeric(column, errors="coerce")).all())


def _spelt(name: str) -> list[str]:
    """Return the units that the name of a column has: T_oil (degC), Tmp °C."""
    return [m["unit"] for style in STYLES if (m := style.fullmatch(name))]


def _temperature_unit(name: str, stated: str | None) -> str | None:
    """Return the unit of a column of temperatures, in the header or in its name; C is no charge."""
    spelt = [stated] if stated else _spelt(name)
    return next((CELSIUS if key == "C" else key for key in spelt if key in ("C", *KELVINS)), stated)


def _has_degrees(name: str, stated: str | None) -> bool:
    """Whether a column is in degrees, in the header or in its name; K is a gain as well."""
    return any(unit in KELVINS and unit != "K" for unit in (stated, *_spelt(name)))


def _has_one_value(part: QuantityTable, name: str) -> bool:
    """Whether the reader takes one value of a condition for a trial."""
    try:
        conditions_in(part, [name])
    except InputError:
        return False
    return True


def _may_drive(frame: QuantityTable, name: str) -> bool:
    """Whether a column may hold what drives an axis, in volts or in the unit of another motion."""
    bare, unit = _bare_and_unit(name, frame.units.get(name), "force")
    volts = is_voltage(name)
    forced = any(_named_score(bare, q)[0] > 0.0 for q in ("force", "current"))
    forced = forced and not (_named_score(bare, "load")[0] or _is_other(bare, "force"))
    moves = any(_named_score(bare, q)[0] for q in ("position", "velocity", "reference"))
    forced = forced or (unit is None and not moves and _is_named(bare, WORDS["commands"]))
    if any(part in WORDS["supplies"] for part in parts_of(name)):
        return False
    return volts or forced or (unit is not None and is_unit(unit) and is_of(unit, "V"))


def _offered(conditions: Sequence[str], found: Mapping[str, Found]) -> Iterable[str]:
    """Yield what is said of conditions and of a temperature that were found by their names."""
    warm = found.get("temperature")
    if warm is not None and warm.why != "as given":
        mean = ", and its mean is a condition of each trial" if warm.name in conditions else ""
        yield (
            f"The column {warm.name!r} changes within a record: it is the temperature on which a"
            f" friction law may depend, such as level + viscous * exponential[temperature]{mean}."
        )
    for name in (condition for condition in conditions if warm is None or condition != warm.name):
        yield (
            f"The column {name!r} is taken for a condition of each trial, by its mean: fits of"
            " several trials say whether friction depends on it. If it is none, leave it out of"
            " conditions."
        )


def _doubts(
    frame: QuantityTable,
    found: Mapping[str, Found],
    turning: bool,
    units: Collection[str],
    constant: float | str | None,
) -> Iterable[str]:
    """Yield what was assumed."""
    joints = joints_in([name for name in frame.names if name])
    if len(joints) > 1:
        moving = next((read.name for q, read in found.items() if q in ("position", "velocity")), "")
        own = numbered(moving)[1] or next(iter(joints))
        yield (
            f"The file has {len(joints)} joints, and this is a rig file of joint {own}"
            f" alone{', the first that moves' * (own != next(iter(joints)))}. For another, name its"
            " position as --columns position=...; all of them together need the URDF of the robot,"
            " as --urdf robot.urdf."
        )
    for quantity, item in found.items():
        if quantity != "time" and item.why == "by its unit":
            yield f"Nothing but its unit says that {item.name!r} is the {quantity}: check it."
    yield from _unit_doubts(frame, found, turning, units)
    if "velocity" in found and set(parts_of(found["velocity"].name)) & {*WORDS["rolling"]}:
        yield (
            f"{found['velocity'].name!r} is read as the sliding velocity, as the file has no other"
            " speed: surfaces that roll slide at a part of it."
        )
    positions = _second_positions(frame, found)
    yield from positions.values()
    for quantity, item in found.items():
        chosen = "moves most" if item.most_moving else "comes first"
        for other in (name for name in item.others if name not in positions):
            yield (
                f"The column {other!r} may be the {quantity} as well as {item.name!r}, which"
                f" {chosen}."
            )
    yield from _left_out(frame, found)
    if "current" in found and not constant:
        yield _scale_doubt(turning)
    yield from _driving_doubts(frame, found)


def _unit_doubts(
    frame: QuantityTable, found: Mapping[str, Found], turning: bool, units: Collection[str]
) -> Iterator[str]:
    """Yield which units and gains are assumed or missing."""
    for quantity, item in found.items():
        stamps = quantity == "time" and item.unit is None and "stamp" in item.why
        if item.unit is None and quantity not in units and not stamps:
            unit, odd = _assumed(quantity, turning), item.odd_in(frame)
            said = f"The column {item.name!r} has no unit: {unit} is assumed"
            if odd:
                cure = f"--unit {quantity}={unit.replace(' ', '')}"
                said = f"{shown(odd)} is no unit: give it, as {cure}; {unit} is assumed"
            yield f"{said} for the {quantity}{_implausible(frame, quantity, item, turning)}."
        elif item.unit is not None and is_of(item.unit, "V") and quantity not in units:
            yield (
                f"The column {item.name!r} is in {item.unit}, and"
                f" {_gain(quantity, turning, item.unit)} is assumed: give the sensitivity of the"
                f" sensor as its gain, as --gain {quantity}='...'."
            )
        elif item.unit is not None and is_of(item.unit, "count") and quantity not in units:
            yield (
                f"The column {item.name!r} is in {item.unit}: give the counts per unit of length or"
                " angle as its gain."
            )


def _assumed(quantity: str, turning: bool) -> str:
    """Return the unit of a quantity that has none."""
    return (meaning_of(quantity).units or ("SI",))[:2][-1 if turning else 0]


def _implausible(frame: QuantityTable, quantity: str, one: Found, turning: bool) -> str:
    """Return what an assumed unit makes of a column, and the cure, where that is hardly true."""
    numbers = (every := _numbers(frame, one))[np.isfinite(every)]
    if numbers.size < 2:
        return ""
    step, span = float(np.median(np.abs(np.diff(numbers)))), float(np.ptp(numbers))
    if quantity == "time" and step >= READING_INTERVAL:
        return f", with {number(step, 3)} s between samples: if it counts ms, give --unit time=ms"
    far = TURN if turning and quantity == "position" else FAR
    if quantity in CURES and span > far:
        unit, cures = meaning_of(quantity).units[-1 if turning else 0], CURES[quantity][turning]
        size = f"over {number(span, 4)} {unit}: if it is in {' or '.join(cures)}"
        return f", {size}, give its unit, as --unit {quantity}={cures[0]}"
    return ""


def _scale_doubt(turning: bool) -> str:
    """Return that a motor constant is assumed."""
    unit = "N m/A" if turning else "N/A"
    return (
        f"The file has a current and no {'torque' if turning else 'force'}: the rig file has a"
        " question mark for the motor constant. Give that of the data sheet times the gear ratio,"
        f" as --motor-constant '0.12 {unit}'."
    )


def _second_positions(frame: QuantityTable, found: Mapping[str, Found]) -> dict[str, str]:
    """Return what is said of other columns that show the same motion as the position, by name."""
    first, said = found.get("position"), {}
    if first is None or first.name not in frame.names or first.unit is None or _is_raw(first.unit):
        return {}
    if not is_unit_of(first.unit, "position"):  # its gain makes a position of it
        return {}
    taken = {column.name for column in found.values()}
    x = _values(frame, first)
    for name in _of_one_joint(frame, {"position": first.name}):
        for other in _offers(frame, name, "position") if name not in taken else ():
            if _is_raw(other.unit) or other.unit is None or other.score < LETTER:
                continue
            y = _values(frame, other)
            both = np.isfinite(x) & np.isfinite(y)
            if both.sum() < 2 or not (np.ptp(x[both]) and np.ptp(y[both])):
                continue
            if abs(np.corrcoef(x[both], y[both])[0, 1]) < 1.0 - NEGLIGIBLE:
                continue
            ratio = float(np.polyfit(x[both], y[both], 1)[0])
            ratio = 1.0 if abs(ratio - 1.0) < ROUNDED else ratio
            apart = float(np.ptp((y - ratio * x)[both]) / abs(ratio))
            size = number(apart / factor(first.unit, first.unit_in_si), 3)
            if first.unit_in_si == other.unit_in_si and apart <= ROUNDING * float(np.ptp(x[both])):
                said[name] = (
                    f"Two columns are positions of this axis: {first.name!r} is read, and {name!r}"
                    f" is not; they are {'equal' if ratio == 1.0 else 'in one ratio throughout'}."
                )
                continue
            geared = f", which moves {number(ratio, 4)} times as far," if ratio != 1.0 else ""
            geared = geared if other.unit_in_si == first.unit_in_si else ""
            said[name] = (
                f"Two columns are positions of this axis: {first.name!r} is read, and {name!r}"
                f"{geared} is not. They differ by up to {size} {first.unit}, the lost motion"
                " between both: if friction acts where the other was measured, give it as"
                f" --columns position={name!r}."
            )
    return said


def _values(frame: QuantityTable, candidate: Found) -> measurement.Array:
    """Return a column (n,) of positions [m] or [rad], from any zero."""
    column = frame.data[frame.names[candidate.name]].to_numpy(dtype=float)
    return column * factor(candidate.unit, candidate.unit_in_si) if candidate.unit else column


def _left_out(frame: QuantityTable, found: Mapping[str, Found]) -> Iterable[str]:
    """Yield which columns of inputs of the contact are left out for their holes."""
    for quantity in INPUTS:
        for column in _input_offers(frame, quantity):
            if quantity not in found and not _is_full(frame, column.name):
                yield (
                    f"The column {column.name!r} seems to be the {quantity}, on which friction may"
                    " depend, but has empty cells: it is left out. To read only the rows that have"
                    f" it, name it, as --columns {quantity}={column.name!r}."
                )


def _driving_doubts(frame: QuantityTable, found: Mapping[str, Found]) -> Iterable[str]:
    """Yield what is not known of the force that drives the axis."""
    if not {"force", "current", "friction"} & set(found):
        taken = {column.name for column in found.values()}
        left = [name for name in frame.names if name and name not in taken]
        drives = [name for name in left if _may_drive(frame, name)]
        unread = [shown(name) for name in left if not _is_named(name, WORDS["conditions"])]
        if drives:
            yield (
                f"{UNDRIVEN[0]} that can be read as it is, but {drives[0]!r} may drive the"
                f" axis: give it as --columns force={drives[0]!r}, with its factor to newtons (N m"
                " of an axis that turns) as --gain force=..."
            )
        elif unread:
            yield (
                f"{UNDRIVEN[1]} by its name or unit; not read:"
                f" {joined(unread, MOST_LISTED)}. If one of them drives the body, give it as"
                " --columns force=...; else the body is assumed to move without a drive."
            )
        else:
            yield f"{UNDRIVEN[0]}: the body is assumed to move without a drive."
    elif "friction" in found and found["friction"].why == BESIDE_LOAD:
        yield (
            f"{found['friction'].name!r} is taken for the friction that a sensor shows. If it"
            f" drives the body, name it as --columns force={found['friction'].name!r}."
        )
    elif "force" in found and "load" in found:
        yield (
            f"{found['force'].name!r} is taken for the force that drives the body. If it is the"
            " friction that a sensor shows, as at a tribometer, name it as --columns"
            f" friction={found['force'].name!r}."
        )
