"""Logs of robots and servos: data sets of LeRobot, JSON of servos, and registers as counts."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from stickslip.data.measurement import Array
from stickslip.data.readers.binary import check_parquet
from stickslip.data.readers.table import FileTable, parsed_as, read_json
from stickslip.data.readers.toml import packaged
from stickslip.data.tolerances import FEWEST_SAMPLES, PER_MILLE, ROUNDED, SLIGHT
from stickslip.errors import InputError, check_size
from stickslip.mechanisms import coordinate_of
from stickslip.show.display import require_library
from stickslip.show.documents import open_regular
from stickslip.show.formatting import count, joined, number
from stickslip.units import shown

# Registers of hobby servos that logs hold as they were read: counts, not degrees or amperes.
#
# Dynamixel: control tables of the series X, https://emanual.robotis.com. Feetech: series STS, on
# which public drivers agree; no manual of the maker was found. See also the page on hobby servos.

_TABLES: Final = packaged("robots.toml")
STEPS: Final = (360.0 / 4096.0, 360.0 / 4095.0)
"""Steps of servos [deg] that count 12 bits a turn, by either convention."""
RADIANS: Final = 13.0
"""A joint with limits does not turn as far [rad]: two turns either way."""
SIGNED: Final = re.compile(r"(?:present|goal)(?:position|velocity|speed|current|pwm)")
"""Registers that have a sign."""
ID: Final = "id"
"""Name of the column that says which servo was read."""


@dataclass(frozen=True, kw_only=True)
class Servo:
    """A family of servos or drives."""

    title: str
    registers: str
    """Pattern of names of columns, of which a log has one."""
    marks: str
    """Pattern of others, by which the family is told from those below."""
    units: Mapping[str, str]
    """Quantity -> unit of its numbers."""
    gains: Mapping[str, float | str] = field(default_factory=dict)
    """Quantity -> what a count is."""
    remarks: Mapping[str, str] = field(default_factory=dict)
    """Quantity -> what the model decides."""
    sign_bit: bool = False
    """Whether the highest bit of a register is its sign; else negative numbers are complements."""
    in_counts: bool = True
    """Whether numbers are those of registers, which are whole, not those of a driver."""

    @property
    def why(self) -> str:
        """What speaks for a column, in words."""
        return f"as a register of {self.title}"

    def doubts(self, read: Collection[str], given: Collection[str]) -> list[str]:
        """Return what the model decides of the quantities that are read and were not given."""
        return [text for name, text in self.remarks.items() if name in read and name not in given]


SERVOS: Final = tuple(Servo(**servo) for servo in _TABLES["servos"])


def register_name(column: str) -> str:
    """Return the name of a column as that of a register.

    Examples
    --------
    >>> register_name("Present_Position"), register_name("present position [raw]")
    ('presentposition', 'presentpositionraw')
    """
    return re.sub(r"[\W_]+", "", column).casefold()


def servo_of(names: Collection[str]) -> Servo | None:
    """Return the family whose registers a table has; None if it has none of a servo.

    Examples
    --------
    >>> servo_of(["t", "Present_Position", "Present_PWM"]).title, servo_of(["t", "position"])
    ('a Dynamixel', None)
    >>> servo_of(["time", "axis0.pos_estimate"]).title
    'an ODrive'
    """

    def has(pattern: str) -> bool:
        return any(re.fullmatch(pattern, register_name(name)) for name in names)

    return next((servo for servo in SERVOS if has(servo.registers) and has(servo.marks)), None)


def are_counts(column: "pd.Series[Any]") -> bool:
    """Whether a column holds whole numbers, more than the radians of a turn.

    Examples
    --------
    >>> are_counts(pd.Series([2048, 2060])), are_counts(pd.Series([0.5, 1.0]))
    (True, False)
    """
    numbers = pd.to_numeric(column, errors="coerce").to_numpy(dtype=float, na_value=np.nan)
    known = numbers[np.isfinite(numbers)]
    return bool(known.size and np.all(known == np.round(known)) and np.abs(known).max() > 10.0)


def are_degrees(positions: Sequence[Array]) -> bool:
    """Whether all positions come in the steps in which servos count a turn, in degrees.

    Examples
    --------
    >>> counts = np.arange(2048.0, 2090.0)
    >>> are_degrees([360.0 / 4096.0 * counts]), are_degrees([0.1 * counts])
    (True, False)
    """
    gaps = [np.diff(np.unique(position)) for position in positions]
    moved = [gap for gap in gaps if gap.size >= 2 * FEWEST_SAMPLES]
    return bool(moved) and any(
        all(
            np.mean(np.abs(array / step - np.rint(array / step)) < SLIGHT) > 1.0 - ROUNDED
            for array in moved
        )
        for step in STEPS
    )


def with_signs(data: pd.DataFrame) -> tuple[pd.DataFrame, list[str]]:
    """Return a table with negative numbers of registers that were read as unsigned, and remarks.

    Examples
    --------
    >>> data = pd.DataFrame({"Present_PWM": [3, 2**16 - 2], "Present_Position": [2, 2**32 - 1]})
    >>> with_signs(data)[0].to_dict("list")
    {'Present_PWM': [3, -2], 'Present_Position': [2, -1]}
    """
    servo = servo_of(list(map(str, data.columns)))
    signed = {}
    for name in data.columns if servo is not None else ():
        if SIGNED.fullmatch(register_name(str(name))) and are_counts(data[name]):
            signed[name] = _signed(data[name], bool(servo and servo.sign_bit))
    changed = [name for name, column in signed.items() if not column.equals(data[name])]
    if servo is None or not changed:
        return data, []
    how = "bit 15 is the sign" if servo.sign_bit else "negative numbers are two's complements"
    return data.assign(**{name: signed[name] for name in changed}), [
        f"Registers of {servo.title} were recorded without their sign, and are read with it, as"
        f" {how}: {joined([shown(str(name)) for name in changed])}."
    ]


def _signed(column: "pd.Series[Any]", sign_bit: bool) -> "pd.Series[Any]":
    """Return the numbers of a register with their sign; one of 16 bits jumps where it changes."""
    least, most = column.min(), column.max()
    if least < 0 or most >= 2**32:
        return column
    if sign_bit:
        return column.where(column < 2**15, 2**15 - column) if most < 2**16 else column
    if most >= 2**31:
        return column.where(column < 2**31, column - 2**32)
    jumps = bool((column.dropna().diff().abs() > 2**15).any())
    if 2**15 <= most < 2**16 and jumps:
        return column.where(column < 2**15, column - 2**16)
    return column


def check_one_servo(file: str, data: pd.DataFrame, names: Mapping[str, str]) -> None:
    """Refuse rows of several servos in turn."""
    column = next((name for name in names if register_name(name) == ID), None)
    if column is None:
        return
    ids = data[names[column]].dropna().unique()
    if len(ids) > 1:
        raise InputError(
            f"{file}: has rows of {len(ids)} servos in turn, by its column {shown(column)}: give"
            " each a file of its own."
        )


# Logs of servos with a pendulum in JSON, as Rhoban/bam and K-Scale's sysid write them.

COLUMNS: Final[Mapping[str, str]] = _TABLES["columns"]
"""What is called how, with its unit; load and torque are what the firmware of a servo reports."""
SETTINGS: Final[Mapping[str, str]] = _TABLES["settings"]
"""What stands above the entries, and its unit."""


def read_servo(path: Path, _names: Collection[str] = ()) -> FileTable:
    """Return the entries of a log as rows, what is no number left out."""
    result = read_json(path)
    entries = result.get("entries") if isinstance(result, dict) else None
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise InputError(
            f"{path}: has no list of entries, as logs of servos by Rhoban/bam and K-Scale have:"
            " save other JSON as CSV or Parquet."
        )
    names = [*dict.fromkeys(name for entry in entries for name in entry)]
    check_size(str(path), float(len(entries) * len(names)), "split the log")
    for name in ("timestamp", "position"):
        if entries and name not in names:
            listed = joined([shown(heading) for heading in names])
            raise InputError(f"{path}: its entries have no {name!r}; they have {listed}.")
    columns = {
        COLUMNS.get(name, name): [_number(entry.get(name)) for entry in entries] for name in names
    }
    for name, values in columns.items():
        if name.split(" ")[0] in ("timestamp", "position") and not np.isfinite(values).any():
            raise InputError(f"{path}: no {name.split(' ')[0]!r} of its entries is a number.")
    kept = {name: values for name, values in columns.items() if np.isfinite(values).any()}
    return FileTable(data=pd.DataFrame(kept, dtype=float), remarks=_servo_remarks(result, names))


def _number(value: Any) -> float:
    """Return a number, 1 or 0 for true or false, and NaN for everything else."""
    try:
        return float(value) if isinstance(value, int | float) else np.nan
    except OverflowError:  # an integer of JSON has any number of digits
        return np.nan


def _servo_remarks(found: Mapping[str, Any], names: Collection[str]) -> tuple[str, ...]:
    """Return what the file states of the rig, and what its numbers are not."""
    stated = [
        f"{name} {number(_number(found[name]), 4)} {unit}".rstrip()
        for name, unit in SETTINGS.items()
        if not isinstance(found.get(name), bool) and np.isfinite(_number(found.get(name)))
    ]
    words = [f"{name} {found[name]}" for name in ("motor", "trajectory") if name in found]
    said = []
    if stated or words:
        said.append(
            f"The file states {joined([*words, *stated])}: an axis is assumed, and a pendulum with"
            " such a mass at the end of its arm is a mechanism of type pendulum."
        )
    raw = [heading for heading in ("load", "torque", "current") if heading in names]
    if raw:
        said.append(
            f"{joined(raw)} of the servo: what the firmware reports has no stated unit, and is not"
            " taken for a torque."
        )
    return tuple(said)


# Data sets of LeRobot, versions 2.0 to 3.0: episodes of a robot's states and actions.

INFO: Final = "meta/info.json"
"""File in the folder of a data set that describes it."""
EPISODES: Final = "data/*/*.parquet"
"""Files in that folder that hold the episodes."""
FEATURES: Final[Mapping[str, str]] = _TABLES["features"]
"""Features that are read, and what their numbers are unless their names say otherwise."""
ENDS: Final[Mapping[str, str]] = _TABLES["ends"]
"""Ends of names, as in shoulder_pan.pos."""
NO_RADIANS: Final = "which is no angle in rad"
"""What is said of positions whose unit is not known."""


def read_lerobot(path: Path, _names: Collection[str] = ()) -> FileTable:
    """Return all episodes as trials, with a column for each joint."""
    info = _info(path)
    features = info["features"]
    wanted = [name for name in FEATURES if name in features]
    if "observation.state" not in wanted:
        raise InputError(
            f"{path}: has no observation.state; the features are {', '.join(features) or 'none'}."
        )
    parts = sorted(path.parent.parent.glob(EPISODES))
    if not parts:
        raise InputError(f"{path}: there is no file {EPISODES} beside the folder of it.")
    tables: list[dict[str, Array]] = []
    size = 0.0
    for part in parts:
        own, numbers = _part(part, ["episode_index", "frame_index", "timestamp", *wanted])
        tables, size = [*tables, own], size + numbers
        check_size(str(path), size, "keep fewer episodes")
    rows = sum(table["episode_index"].shape[0] for table in tables)
    data = {name: _joined(path, name, tables) for name in tables[0]}
    order = np.lexsort((data["frame_index"], data["episode_index"]))
    data = {name: values[order] for name, values in data.items()}
    fps = float(info["fps"])
    times, how = _times(data, fps)
    columns: dict[str, Array] = {"trial": data["episode_index"], "time [s]": times}
    for name in wanted:
        for column, values in _columns(path, name, features[name], data[name]):
            columns.setdefault(column, values)
    remarks = (*how, *_data_set_remarks(columns))
    if _largest(columns) > RADIANS and are_degrees(_positions(columns)):
        angles = ("position.", "reference.")
        columns = {f"{x} [deg]" if x.startswith(angles) else x: y for x, y in columns.items()}
    return FileTable(data=pd.DataFrame(columns), remarks=remarks, lost=(*_lost(info, rows),))


def _info(path: Path) -> Mapping[str, Any]:
    """Return the description of a data set, what is used of it checked."""
    result = read_json(path)
    if not isinstance(result, dict) or not isinstance(result.get("features"), dict):
        raise InputError(f"{path}: has no features: is it the info.json of a LeRobot data set?")
    fps = result.get("fps")
    if isinstance(fps, bool) or not isinstance(fps, int | float) or not 0.0 < fps < 1e6:
        raise InputError(f"{path}: fps must be a number of frames per second, got {fps!r}.")
    if not all(isinstance(feature, dict) for feature in result["features"].values()):
        raise InputError(f"{path}: each of the features must be a table with its names and shape.")
    return result


def _part(path: Path, names: Collection[str]) -> tuple[dict[str, Array], float]:
    """Return the columns of one file: (n,), and of a list in each row (n, k), and their size."""
    pa = require_library("pyarrow", "parquet")
    pc, pq = (require_library(f"pyarrow.{name}", "parquet") for name in ("compute", "parquet"))
    with parsed_as(path, "a Parquet file"):
        with open_regular(path) as stream, pq.ParquetFile(stream) as file:
            size = check_parquet(str(path), file, names)
            missing = [heading for heading in names if heading not in file.schema_arrow.names]
            if missing:
                listed = ", ".join(file.schema_arrow.names)
                raise InputError(f"{path}: has no column {missing[0]!r}; there are {listed}.")
            table = file.read(columns=[*names])
        result = {}
        for name in names:
            column = table.column(name).combine_chunks()
            rows = len(column)
            if name in FEATURES and pa.types.is_nested(column.type):
                flat = column.flatten().to_numpy(zero_copy_only=False)
                sizes = {*pc.list_value_length(column).to_pylist()}
                if len(sizes) != 1 or sizes & {None, 0}:
                    raise InputError(f"{path}: the lists of {name!r} have different lengths.")
                result[name] = flat.reshape(rows, -1).astype(float)
            else:
                values = column.to_numpy(zero_copy_only=False).astype(float)
                result[name] = values[:, None] if name in FEATURES else values
        return result, size


def _joined(path: Path, name: str, tables: Collection[Mapping[str, Array]]) -> Array:
    """Return a column of all files."""
    parts = [table[name] for table in tables]
    if len({part.shape[1:] for part in parts}) > 1:
        raise InputError(f"{path}: {name!r} has not as many numbers in all files of the data.")
    return np.concatenate(parts)


def _times(data: Mapping[str, Array], fps: float) -> tuple[Array, tuple[str, ...]]:
    """Return times [s], and whether they are frames that were counted and not measured."""
    counted = data["frame_index"] / fps
    away = np.abs(data["timestamp"] - counted)
    # Times are stored with 24 bits.
    rounding = 2.0**-23 * np.maximum(np.abs(counted), 1.0)
    if np.all(away <= PER_MILLE / fps + rounding):
        return counted, (
            f"Times are frame numbers over {number(fps, 4)} fps: when a sample was measured is not"
            " in the data set, and a loop that was late looks like a jump of the motion.",
        )
    return data["timestamp"], ()


def _columns(
    path: Path, name: str, feature: Mapping[str, Any], values: Array
) -> Iterator[tuple[str, Array]]:
    """Yield the numbers of a feature by quantity and joint."""
    names = _names(feature.get("names"), values.shape[1])
    result: dict[str, Array] = {}
    for place, heading in enumerate(names):
        stem, _, end = heading.rpartition(".")
        known = ENDS.get(end, "") if stem else ""
        what = known or FEATURES[name]
        if name == "action":
            what = "reference" if known in ("", "position") else f"command.{known}"
        joint = coordinate_of(stem if known else heading)
        column = f"{what}.{joint}"
        if not joint or column in result:
            raise InputError(f"{path}: the names of {name} have {heading!r} twice, or empty.")
        result[column] = values[:, place]
    yield from result.items()


def _names(given: Any, size: int) -> list[str]:
    """Return the names of joints: a list, one within a table, or numbers where there are none."""
    while isinstance(given, dict) and len(given) == 1:
        given = next(iter(given.values()))
    if isinstance(given, dict) and len(given) == size:
        given = [*given]
    named = isinstance(given, list) and len(given) == size
    if named and all(isinstance(name, str) and name for name in given):
        return [*given]
    return [f"motor_{place}" for place in range(size)]


def _lost(info: Mapping[str, Any], rows: int) -> Iterator[str]:
    """Yield that a data set has other frames than it says."""
    total = info.get("total_frames")
    if isinstance(total, int) and total != rows:
        yield f"info.json tells of {count(total, 'frame')}, and the files have {rows:,}."


def _data_set_remarks(columns: Mapping[str, Array]) -> Iterator[str]:
    """Yield what a data set does not say."""
    largest = number(_largest(columns), 3)
    if _largest(columns) <= RADIANS:
        return
    if are_degrees(_positions(columns)):
        yield (
            f"Positions reach {largest} and come in steps of 360/4096: they are taken for degrees."
        )
    else:
        yield (
            f"Positions reach {largest}, {NO_RADIANS}: arms of hobby servos are recorded in"
            " degrees, or in percent of the range of each joint, which calibration alone makes"
            " angles of. If it is degrees: --unit position=deg."
        )


def _positions(columns: Mapping[str, Array]) -> list[Array]:
    """Return the known positions (n,) of each joint that has some."""
    known = [x[np.isfinite(x)] for name, x in columns.items() if name.startswith("position.")]
    return [array for array in known if array.size]


def _largest(columns: Mapping[str, Array]) -> float:
    """Return the largest size of a position; 0 where none is known."""
    return max((float(np.abs(position).max()) for position in _positions(columns)), default=0.0)
