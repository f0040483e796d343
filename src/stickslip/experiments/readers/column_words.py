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
    *("error", "fehler", "abweichung", "deviation", "difference", "differenz", "schlepp"),
    *("temperatur", "status", "enable", "freigabe"),
)
"""What words of columns begin or end with that none of the quantities has."""
OTHER_WORDS: Final = (
    *("diff", "following", "lag", "er", "err", "temp", "temperature", "dev", "std", "pwm"),
)
"""Such words as they stand."""
LAST: Final = ("index", "power", "leistung", "diff", "err")
"""Such words where a name ends with them: a power, but not the position of a power drive."""
NO_MOTION: Final = (
    *("acc", "accel", "delta", "wear", "verschleiss", "height", "hoehe", "depth", "tiefe"),
    *("amplitude", "amplituden", "radius", "diameter", "durchmesser", "width", "breite"),
    *("thickness", "dicke", "frequency", "frequenz", "acceleration", "beschleunigung"),
)
"""Words of columns that are no motion, but may be forces: the amplitude of a friction force."""
MOTION: Final = ("position", "velocity", "reference")
"""Quantities of a motion."""
ROLLING: Final = ("rolling", "entrainment", "rollgeschwindigkeit")
"""Words of speeds at which surfaces pass together, without sliding."""
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


def is_barred(parts: Sequence[str], quantity: str) -> bool:
    """Whether the words of a name are those of an error, a condition or wear, not of a quantity.

    Examples
    --------
    >>> is_barred(parts_of("pid.jointEr.position"), "position")
    True
    >>> [is_barred(parts_of("force amplitude"), q) for q in ("position", "force")]
    [True, False]
    """
    if quantity in MOTION and any(part.startswith(NO_MOTION[-2:]) for part in parts):
        return True
    if any(part in OTHER_WORDS or (quantity in MOTION and part in NO_MOTION) for part in parts):
        return True
    if any(part.startswith(OTHER) or part.endswith((*OTHER, "err")) for part in parts):
        return True  # poserr
    return bool(parts) and parts[-1].endswith(LAST)
