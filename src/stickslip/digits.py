"""Decimal digits of numbers and ranges, rounded to what is known of them.

A true minus, commas in thousands, no-break spaces where a line must not end.
"""

import math
from decimal import ROUND_HALF_UP, Decimal
from typing import Final

from stickslip.errors import InputError

__all__ = [
    "DIGITS_OF_A_FLOAT",
    "MINUS",
    "NOT_FINITE",
    "NO_BREAK_SPACE",
    "PLAIN_POWERS",
    "UNBOUNDED",
    "at_place",
    "decimal",
    "fixed",
    "glued",
    "in_words",
    "interval",
    "mantissa",
    "plain",
    "power_factor",
    "power_of",
    "rounded_doubt",
    "significant",
    "within",
]

NO_BREAK_SPACE: Final = "\N{NO-BREAK SPACE}"
MINUS: Final = "\N{MINUS SIGN}"
NOT_FINITE: Final = "not finite"
UNBOUNDED: Final = "unbounded"
PLAIN_POWERS: Final = range(-4, 7)
DIGITS_OF_A_FLOAT: Final = 15

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
    """Return a number rounded, halves away from zero, to the power of ten `place`.

    Parameters
    ----------
    number : Decimal
        The number.
    place : int
        Power of ten of the last digit that is kept.

    Returns
    -------
    Decimal
        The rounded number.
    """
    # Scaled by hand: `quantize` refuses more digits than the context holds.
    return number.scaleb(-place).to_integral_value(ROUND_HALF_UP).scaleb(place)


def plain(number: Decimal, place: int) -> str:
    """Return the text of a number that is already rounded to the power of ten `place`.

    Parameters
    ----------
    number : Decimal
        The number, rounded.
    place : int
        Power of ten of its last digit; -2 shows two decimals.

    Returns
    -------
    str
        Text with commas between thousands and a true minus sign.
    """
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


def fixed(value: float, decimals: int) -> str:
    """Return a number with a given number of decimals.

    Parameters
    ----------
    value : float
        The number.
    decimals : int
        How many digits follow the point.

    Returns
    -------
    str
        The number, or what it is in words if it is not finite.

    Examples
    --------
    >>> fixed(1234.567, 1), fixed(-0.001, 2)
    ('1,234.6', '0.00')
    """
    if not math.isfinite(value):
        return in_words(value)
    if power_of(decimal(value)) >= DIGITS_OF_A_FLOAT:
        return significant(value, 3)
    return plain(at_place(decimal(value), -decimals), -decimals)


def interval(low: float, high: float) -> str:
    """Return a range, its ends rounded to two digits of its width.

    Parameters
    ----------
    low, high : float
        The ends; infinite if that side is open.

    Returns
    -------
    str
        Such as "0.249 to 0.261".

    Raises
    ------
    InputError
        If `low` is above `high`.

    Examples
    --------
    >>> interval(0.24871, 0.26113), interval(-math.inf, 0.7), interval(0.0, math.inf)
    ('0.249 to 0.261', 'at most 0.700', 'at least 0')
    """
    if math.isnan(low) or math.isnan(high):
        return NOT_FINITE
    if low > high:
        raise InputError(f"a range has its low end first, got {low!r}, {high!r}.")
    if math.isinf(high):
        return f"at least {significant(low, 3)}" if math.isfinite(low) else UNBOUNDED
    if math.isinf(low):
        return f"at most {significant(high, 3)}"
    if low == high:
        return f"exactly {significant(low, 6)}"
    place, digits = _shared(low, high)
    if digits:
        return " to ".join(significant(end, digits) for end in (low, high))
    return " to ".join(plain(at_place(decimal(end), place), place) for end in (low, high))


def within(value: float, low: float, high: float) -> str:
    """Return a value with as many digits as `interval` shows of the range that it lies in.

    Parameters
    ----------
    value : float
        The value.
    low, high : float
        The ends of its range; three digits of the value if one of them is infinite.

    Returns
    -------
    str
        Such as "0.255" of 0.249 to 0.261.

    Examples
    --------
    >>> within(0.25512, 0.24871, 0.26113), within(4.999965, 4.99985, 5.00008)
    ('0.255', '4.99997')
    >>> within(-2.26e-5, -3.33e-4, 2.88e-4), within(5.7312, 5.7312, math.inf)
    ('−0.00002', '5.73')
    """
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        return significant(value, 3)
    place, digits = _shared(low, high)
    return (
        significant(value, max(digits, 3))
        if digits
        else plain(at_place(decimal(value), place), place)
    )


def _shared(low: float, high: float) -> tuple[int, int]:
    """Return the power of ten that both ends are rounded to, or how many digits each has else."""
    ends = [decimal(low), decimal(high)]
    place = power_of(ends[1] - ends[0]) - 1
    place = max(place, power_of(decimal(max(abs(low), abs(high)))) - DIGITS_OF_A_FLOAT + 1)
    lost = any(end and power_of(end) < place for end in ends)
    odd = any(end and power_of(end) not in PLAIN_POWERS for end in ends)
    if not (lost or odd):
        return place, 0
    # One rounding cannot show both ends: over many powers of ten each has its own.
    digits = min(max(power_of(max(ends, key=abs)) - place + 1, 2), DIGITS_OF_A_FLOAT)
    return place, 2 if lost else digits


def significant(value: float, digits: int) -> str:
    r"""Return a number rounded to some significant digits.

    Parameters
    ----------
    value : float
        The number.
    digits : int
        How many digits to keep, at least 1.

    Returns
    -------
    str
        Plain from 0.0001 to 9,999,999 and as a power of ten beyond.

    Raises
    ------
    InputError
        If `digits` is below 1.

    Examples
    --------
    >>> significant(0.2, 3), significant(24841, 5), significant(2e9, 2), significant(-3.14159, 3)
    ('0.200', '24,841', '2.0\xa0×\xa010⁹', '−3.14')
    """
    if digits < 1:
        raise InputError(f"at least 1 digit must be kept, got {digits!r}.")
    if not math.isfinite(value):
        return in_words(value)
    if value == 0:
        return "0"
    exact = decimal(value)
    place = power_of(exact) - digits + 1
    number = at_place(exact, place)
    power = power_of(number)
    place = power - digits + 1
    if power in PLAIN_POWERS:
        return plain(number, place)
    mantissa = plain(number.scaleb(-power), place - power)
    return f"{mantissa}{NO_BREAK_SPACE}{power_factor(power)}"
