"""Decimal digits: the arithmetic beneath `stickslip.report.numbers`."""

import math
from decimal import ROUND_HALF_UP, Decimal
from typing import Final

NO_BREAK_SPACE: Final = "\N{NO-BREAK SPACE}"
MINUS: Final = "\N{MINUS SIGN}"
NOT_FINITE: Final = "not finite"
UNBOUNDED: Final = "unbounded"

_SUPERSCRIPTS: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def rounded_doubt(half_width: Decimal) -> tuple[Decimal, int]:
    """Return the half width rounded, and the power of ten of its last digit."""
    place = power_of(half_width)
    one = at_place(half_width, place)
    two = at_place(half_width, place - 1)
    if power_of(one) > place:  # 0.96 becomes 1.0
        return one, place
    return (two, place - 1) if two.as_tuple().digits[0] == 1 else (one, place)


def decimal(value: float) -> Decimal:
    """Return the shortest decimal number that reads back as `value`."""
    return Decimal(repr(float(value)))


def power_of(number: Decimal) -> int:
    """Return the power of ten of the first digit, 0 for zero."""
    return number.adjusted() if number else 0


def at_place(number: Decimal, place: int) -> Decimal:
    """Return a number rounded, halves away from zero, to the power of ten `place`."""
    # Scaled by hand: `quantize` refuses more digits than the context holds.
    return number.scaleb(-place).to_integral_value(ROUND_HALF_UP).scaleb(place)


def plain(number: Decimal, place: int) -> str:
    """Return the text of a number that is already rounded to the power of ten `place`."""
    text = f"{abs(number):,.{max(-place, 0)}f}"
    return MINUS + text if number < 0 else text


def power_factor(power: int) -> str:
    """Return "× 10ⁿ"."""
    return f"×{NO_BREAK_SPACE}10{str(power).translate(_SUPERSCRIPTS)}"


def mantissa(text: str) -> tuple[str, str]:
    """Return a formatted number apart from its power of ten."""
    number, times, factor = text.partition(f"{NO_BREAK_SPACE}×")
    return number, f"×{factor}" if times else ""


def glued(text: str) -> str:
    """Return a text in which no line may end."""
    return text.replace(" ", NO_BREAK_SPACE)


def in_words(value: float) -> str:
    """Return what a number that is not finite is."""
    return UNBOUNDED if math.isinf(value) else NOT_FINITE
