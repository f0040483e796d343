"""Registers of hobby servos that logs hold as they were read: counts, not degrees or amperes.

Dynamixel: control tables of the series X, https://emanual.robotis.com. Feetech: series STS, on
which public drivers agree; no manual of the maker was found. See also the page on hobby servos.
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, final

import numpy as np
import pandas as pd

from stickslip.errors import InputError
from stickslip.units import shown

TURN: Final = "4096 counts/rev"
"""Counts of an angle in both."""
ID: Final = "id"
"""Name of the column that says which servo was read."""


@final
@dataclass(frozen=True, kw_only=True)
class Servo:
    """A family of servos."""

    title: str
    marks: frozenset[str]
    """Registers that the other family has not."""
    units: Mapping[str, str]
    """Quantity -> unit of its numbers."""
    gains: Mapping[str, float | str]
    """Quantity -> what a count is."""
    remarks: Mapping[str, str] = field(default_factory=dict)
    """Quantity -> what the model decides."""

    @property
    def why(self) -> str:
        """What speaks for a column, in words."""
        return f"as a register of a {self.title}"

    def doubts(self, read: Collection[str], given: Collection[str]) -> list[str]:
        """Return what the model decides of the quantities that are read and were not given."""
        return [text for name, text in self.remarks.items() if name in read and name not in given]


SERVOS: Final = (
    Servo(
        title="Dynamixel",
        marks=frozenset({"presentpwm", "presentinputvoltage", "goalpwm", "velocitytrajectory"}),
        units={"position": "count", "reference": "count", "velocity": "count", "current": "mA"},
        gains={"position": TURN, "reference": TURN, "velocity": "0.229 rpm/count"},
        remarks={
            "current": "A count of the current is 1 mA of an XL330 or XC330, which is assumed, and"
            " 2.69 mA of an XM430 or XH430: give it as --gain current=2.69."
        },
    ),
    Servo(
        title="Feetech STS",
        marks=frozenset({"presentload", "presentvoltage", "presentspeed"}),
        units={"position": "count", "reference": "count", "velocity": "count", "current": "mA"},
        gains={
            "position": TURN,
            "reference": TURN,
            "velocity": "0.0146484375 rpm/count",  # a count of the angle each second
            "current": 6.5,
        },
        remarks={
            "position": "A servo of the series SCS has 1024 counts: give --gain"
            " position='1024 counts/rev'."
        },
    ),
)


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
    ('Dynamixel', None)
    """
    registers = {register_name(name) for name in names}
    if not registers & {"presentposition", "goalposition"}:
        return None
    return next((servo for servo in SERVOS if servo.marks & registers), None)


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
