"""Registers of hobby servos that logs hold as they were read: counts, not degrees or amperes.

Dynamixel: control tables of the series X, https://emanual.robotis.com. Feetech: series STS, on
which public drivers agree; no manual of the maker was found. See also the page on hobby servos.
"""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, final

import numpy as np
import pandas as pd

from stickslip.errors import InputError
from stickslip.experiments.measurement import Array
from stickslip.formatting import joined
from stickslip.units import shown

TURN: Final = "4096 counts/rev"
"""Counts of an angle in both."""
STEPS: Final = (360.0 / 4096.0, 360.0 / 4095.0)
"""Steps of servos [deg] that count 12 bits a turn, by either convention."""
FEWEST: Final = 20
"""Steps from which they show that they are multiples of one."""
WHOLE: Final = 0.05
"""Distance of a step from such a multiple; 24 bits leave 1e-4."""
MOST: Final = 0.98
"""Share of the steps that are multiples."""
RADIANS: Final = 13.0
"""A joint with limits does not turn as far [rad]: two turns either way."""
SIGNED: Final = re.compile(r"(?:present|goal)(?:position|velocity|speed|current|pwm)")
"""Registers that have a sign."""
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
    sign_bit: bool = False
    """Whether the highest bit of a register is its sign; else negative numbers are complements."""

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
        sign_bit=True,
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


def are_degrees(positions: Sequence[Array]) -> bool:
    """Whether all positions come in the steps in which servos count a turn, in degrees.

    Examples
    --------
    >>> counts = np.arange(2048.0, 2090.0)
    >>> are_degrees([360.0 / 4096.0 * counts]), are_degrees([0.1 * counts])
    (True, False)
    """
    gaps = [np.diff(np.unique(one)) for one in positions]
    moved = [one for one in gaps if one.size >= FEWEST]
    return bool(moved) and any(
        all(np.mean(np.abs(one / step - np.rint(one / step)) < WHOLE) > MOST for one in moved)
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
    changed = [name for name, one in signed.items() if not one.equals(data[name])]
    if servo is None or not changed:
        return data, []
    how = "bit 15 is the sign" if servo.sign_bit else "negative numbers are two's complements"
    return data.assign(**{name: signed[name] for name in changed}), [
        f"Registers of a {servo.title} were recorded without their sign, and are read with it, as"
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
