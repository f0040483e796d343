"""Settings of a rig in words, and in the units in which they are read."""

import math

from stickslip.show.formatting import number


def unit_of(unit: str) -> tuple[str, float]:
    """Return the unit that settings are read in, and its numbers over those in SI.

    Examples
    --------
    >>> unit_of("m"), unit_of("N"), unit_of("rad")[0]
    (('mm', 1000.0), ('N', 1.0), '°')
    """
    return {"m": ("mm", 1e3), "rad": ("°", math.degrees(1.0))}.get(unit, (unit, 1.0))


def rounded_setting(value: float, unit: str) -> float:
    """Return a setting [SI] with three digits in the unit that it is read in.

    Examples
    --------
    >>> rounded_setting(0.0123456, "m"), math.degrees(rounded_setting(0.314, "rad"))
    (0.0123, 18.0)
    """
    _, factor = unit_of(unit)
    return float(f"{factor * value:.3g}") / factor


def words_of(path: str) -> str:
    """Return what a parameter of the mechanism is called.

    Examples
    --------
    >>> words_of("mechanism.compression"), words_of("mechanism.drive.drive.frequency")
    ('compression', 'drive frequency')
    """
    words = path.removeprefix("mechanism.").replace(".", " ").replace("_", " ").split()
    return " ".join(dict.fromkeys(words))  # a drive of a motor is its drive


def setting_text(value: float, unit: str) -> str:
    """Return a setting [SI] with its unit, lengths in millimetres and angles in degrees.

    Examples
    --------
    >>> setting_text(0.1, "m"), setting_text(math.radians(5.0), "rad")
    ('100 mm', '5°')
    """
    shown, factor = unit_of(unit)
    return f"{number(factor * value, 6)} {shown}".replace(" °", "°")
