"""Data sets of LeRobot, versions 2.0 to 3.0: episodes of a robot's states and actions."""

from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from stickslip.documents import open_regular
from stickslip.errors import InputError, check_size
from stickslip.experiments.measurement import Array
from stickslip.experiments.readers.parquet import check_parquet
from stickslip.experiments.readers.servo_registers import RADIANS, are_degrees
from stickslip.experiments.readers.table import Table, read_json
from stickslip.formatting import count, number
from stickslip.mechanisms import coordinate_of

INFO: Final = "meta/info.json"
"""File in the folder of a data set that describes it."""
EPISODES: Final = "data/*/*.parquet"
"""Files in that folder that hold the episodes."""
FEATURES: Final = {
    "observation.state": "position",
    "observation.velocity": "velocity",
    "observation.effort": "force",
    "observation.torque": "force",
    "observation.current": "current",
    "action": "reference",
}
"""Features that are read, and what their numbers are unless their names say otherwise."""
ENDS: Final = {
    "pos": "position",
    "position": "position",
    "vel": "velocity",
    "velocity": "velocity",
    "effort": "force",
    "torque": "force",
    "current": "current",
}
"""Ends of names, as in shoulder_pan.pos."""
ALIKE: Final = 1e-3
"""Share of a frame by which times that are numbers of frames may differ by rounding."""
NO_RADIANS: Final = "which is no angle in rad"
"""What is said of positions whose unit is not known."""


def read_lerobot(path: Path, _names: Collection[str] = ()) -> Table:
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
    rows = sum(one["episode_index"].shape[0] for one in tables)
    data = {name: _joined(path, name, tables) for name in tables[0]}
    order = np.lexsort((data["frame_index"], data["episode_index"]))
    data = {name: values[order] for name, values in data.items()}
    fps = float(info["fps"])
    times, how = _times(data, fps)
    columns: dict[str, Array] = {"trial": data["episode_index"], "time [s]": times}
    for name in wanted:
        for column, values in _columns(path, name, features[name], data[name]):
            columns.setdefault(column, values)
    remarks = (*how, *_remarks(columns))
    if _largest(columns) > RADIANS and are_degrees(_positions(columns)):
        angles = ("position.", "reference.")
        columns = {f"{x} [deg]" if x.startswith(angles) else x: y for x, y in columns.items()}
    return Table(data=pd.DataFrame(columns), remarks=remarks, lost=(*_lost(info, rows),))


def _info(path: Path) -> Mapping[str, Any]:
    """Return the description of a data set, what is used of it checked."""
    found = read_json(path)
    if not isinstance(found, dict) or not isinstance(found.get("features"), dict):
        raise InputError(f"{path}: has no features: is it the info.json of a LeRobot data set?")
    fps = found.get("fps")
    if isinstance(fps, bool) or not isinstance(fps, int | float) or not 0.0 < fps < 1e6:
        raise InputError(f"{path}: fps must be a number of frames per second, got {fps!r}.")
    if not all(isinstance(one, dict) for one in found["features"].values()):
        raise InputError(f"{path}: each of the features must be a table with its names and shape.")
    return found


def _part(path: Path, names: Collection[str]) -> tuple[dict[str, Array], float]:
    """Return the columns of one file: (n,), and of a list in each row (n, k), and their size."""
    import pyarrow as pa
    import pyarrow.compute as pc
    import pyarrow.parquet as pq

    try:
        with open_regular(path) as stream, pq.ParquetFile(stream) as file:
            size = check_parquet(str(path), file, names)
            missing = [one for one in names if one not in file.schema_arrow.names]
            if missing:
                listed = ", ".join(file.schema_arrow.names)
                raise InputError(f"{path}: has no column {missing[0]!r}; there are {listed}.")
            table = file.read(columns=[*names])
        found = {}
        for name in names:
            column = table.column(name).combine_chunks()
            rows = len(column)
            if name in FEATURES and pa.types.is_nested(column.type):
                flat = column.flatten().to_numpy(zero_copy_only=False)
                sizes = {*pc.list_value_length(column).to_pylist()}
                if len(sizes) != 1 or sizes & {None, 0}:
                    raise InputError(f"{path}: the lists of {name!r} have different lengths.")
                found[name] = flat.reshape(rows, -1).astype(float)
            else:
                values = column.to_numpy(zero_copy_only=False).astype(float)
                found[name] = values[:, None] if name in FEATURES else values
        return found, size
    except InputError:
        raise
    except Exception as error:
        # pyarrow has an exception tree of its own.
        reason = str(error).splitlines()[0].rstrip(".")
        raise InputError(f"{path}: is not a Parquet file, or is damaged: {reason}.") from None


def _joined(path: Path, name: str, tables: Collection[Mapping[str, Array]]) -> Array:
    """Return a column of all files."""
    parts = [one[name] for one in tables]
    if len({one.shape[1:] for one in parts}) > 1:
        raise InputError(f"{path}: {name!r} has not as many numbers in all files of the data.")
    return np.concatenate(parts)


def _times(data: Mapping[str, Array], fps: float) -> tuple[Array, tuple[str, ...]]:
    """Return times [s], and whether they are frames that were counted and not measured."""
    counted = data["frame_index"] / fps
    away = np.abs(data["timestamp"] - counted)
    # Times are stored with 24 bits.
    rounding = 2.0**-23 * np.maximum(np.abs(counted), 1.0)
    if np.all(away <= ALIKE / fps + rounding):
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
    found: dict[str, Array] = {}
    for place, one in enumerate(names):
        stem, _, end = one.rpartition(".")
        known = ENDS.get(end, "") if stem else ""
        what = known or FEATURES[name]
        if name == "action":
            what = "reference" if known in ("", "position") else f"command.{known}"
        joint = coordinate_of(stem if known else one)
        column = f"{what}.{joint}"
        if not joint or column in found:
            raise InputError(f"{path}: the names of {name} have {one!r} twice, or empty.")
        found[column] = values[:, place]
    yield from found.items()


def _names(given: Any, size: int) -> list[str]:
    """Return the names of joints: a list, one within a table, or numbers where there are none."""
    while isinstance(given, dict) and len(given) == 1:
        given = next(iter(given.values()))
    if isinstance(given, dict) and len(given) == size:
        given = [*given]
    named = isinstance(given, list) and len(given) == size
    if named and all(isinstance(one, str) and one for one in given):
        return [*given]
    return [f"motor_{place}" for place in range(size)]


def _lost(info: Mapping[str, Any], rows: int) -> Iterator[str]:
    """Yield that a data set has other frames than it says."""
    total = info.get("total_frames")
    if isinstance(total, int) and total != rows:
        yield f"info.json tells of {count(total, 'frame')}, and the files have {rows:,}."


def _remarks(columns: Mapping[str, Array]) -> Iterator[str]:
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
    return [one for one in known if one.size]


def _largest(columns: Mapping[str, Array]) -> float:
    """Return the largest size of a position; 0 where none is known."""
    return max((float(np.abs(one).max()) for one in _positions(columns)), default=0.0)
