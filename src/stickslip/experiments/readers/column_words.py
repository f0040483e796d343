"""Words in the names of columns that say what a column is not: a motion, or a force."""

import re
from collections.abc import Sequence
from typing import Final

WANTED: Final = (
    "soll",
    "set",
    "setpoint",
    "cmd",
    "command",
    "desired",
    "demand",
    "target",
    "goal",
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
    "deviation",
    "diff",
    "following",
    "acceleration",
    "beschleunigung",
    "power",
    "leistung",
    "enable",
    "freigabe",
)
"""What names of columns contain that none of the quantities has."""
OTHER_WORDS: Final = (
    *("lag", "er", "err", "temp", "dev", "std", "pwm", "acc", "delta"),
    *("wear", "verschleiss", "height", "hoehe", "depth", "rolling", "entrainment"),
    *("amplitude", "amplituden", "radius", "diameter", "durchmesser", "width", "breite"),
    *("thickness", "dicke", "frequency", "frequenz"),
)
"""The same as words of their own."""
_WRITTEN_OUT: Final = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss"})


def parts_of(name: str) -> list[str]:
    """Return the words in a name, umlauts written out."""
    spaced = re.sub(r"(?<=[a-zäöüß])(?=[A-Z])", " ", name).casefold().translate(_WRITTEN_OUT)
    return [part for part in re.split(r"[\W\d_]+", spaced) if part]


def is_wanted(parts: Sequence[str]) -> bool:
    """Whether words are those of a wanted value."""
    joined = "".join(parts)
    return any(part in WANTED for part in parts) or any(
        joined.startswith(word) or joined.endswith(f"{word}wert") for word in WANTED
    )


def is_barred(parts: Sequence[str]) -> bool:
    """Whether the words of a name are those of an error, a condition or wear.

    Examples
    --------
    >>> is_barred(parts_of("joint_pid.jointEr.position")), is_barred(parts_of("motor.position"))
    (True, False)
    """
    joined = "".join(parts)
    barred = any(part in OTHER_WORDS or part.endswith("err") for part in parts)  # poserr
    return barred or any(word in joined for word in OTHER)
