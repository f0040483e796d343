"""Logs of servos with a pendulum in JSON, as Rhoban/bam and K-Scale's sysid write them."""

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from stickslip.errors import InputError, check_size
from stickslip.experiments.readers.table import Table, read_json
from stickslip.formatting import joined, number
from stickslip.units import shown

COLUMNS: Final = {
    "timestamp": "timestamp [s]",
    "position": "position [rad]",
    "speed": "speed [rad/s]",
    "goal_position": "goal_position [rad]",
    "input_volts": "supply [V]",
    "temp": "temp [degC]",
    "present_current": "present_current [mA]",
    "load": "reported load [1]",
    "torque": "reported torque [1]",
}
"""What is called how, with its unit; load and torque are what the firmware of a servo reports."""
SETTINGS: Final = {
    "mass": "kg", "arm_mass": "kg", "length": "m", "offset": "rad", "kp": "", "ki": "", "kd": "",
    "vin": "V", "dt": "s",
}  # fmt: skip
"""What stands above the entries, and its unit."""


def read_servo(path: Path, _names: Collection[str] = ()) -> Table:
    """Return the entries of a log as rows, what is no number left out."""
    found = read_json(path)
    entries = found.get("entries") if isinstance(found, dict) else None
    if not isinstance(entries, list) or not all(isinstance(one, dict) for one in entries):
        raise InputError(
            f"{path}: has no list of entries, as logs of servos by Rhoban/bam and K-Scale have:"
            " save other JSON as CSV or Parquet."
        )
    names = [*dict.fromkeys(name for one in entries for name in one)]
    check_size(str(path), float(len(entries) * len(names)), "split the log")
    for name in ("timestamp", "position"):
        if entries and name not in names:
            listed = joined([shown(one) for one in names])
            raise InputError(f"{path}: its entries have no {name!r}; they have {listed}.")
    columns = {
        COLUMNS.get(name, name): [_number(one.get(name)) for one in entries] for name in names
    }
    for name, values in columns.items():
        if name.split(" ")[0] in ("timestamp", "position") and not np.isfinite(values).any():
            raise InputError(f"{path}: no {name.split(' ')[0]!r} of its entries is a number.")
    kept = {name: values for name, values in columns.items() if np.isfinite(values).any()}
    return Table(data=pd.DataFrame(kept, dtype=float), remarks=_remarks(found, names))


def _number(value: Any) -> float:
    """Return a number, 1 or 0 for true or false, and NaN for everything else."""
    try:
        return float(value) if isinstance(value, int | float) else np.nan
    except OverflowError:  # an integer of JSON has any number of digits
        return np.nan


def _remarks(found: Mapping[str, Any], names: Collection[str]) -> tuple[str, ...]:
    """Return what the file states of the rig, and what its numbers are not."""
    told = [
        f"{name} {number(_number(found[name]), 4)} {unit}".rstrip()
        for name, unit in SETTINGS.items()
        if not isinstance(found.get(name), bool) and np.isfinite(_number(found.get(name)))
    ]
    words = [f"{name} {found[name]}" for name in ("motor", "trajectory") if name in found]
    said = []
    if told or words:
        said.append(
            f"The file states {joined([*words, *told])}: an axis is assumed, and a pendulum with"
            " such a mass at the end of its arm is a mechanism of type pendulum."
        )
    raw = [one for one in ("load", "torque", "current") if one in names]
    if raw:
        said.append(
            f"{joined(raw)} of the servo: what the firmware reports has no stated unit, and is not"
            " taken for a torque."
        )
    return tuple(said)
