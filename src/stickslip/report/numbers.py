"""Numbers as a reader wants them: rounded to what is known, and never as ``nan`` or ``2.9e-15``.

Every function returns plain text, for HTML, a terminal or a file alike. A true minus, commas in
thousands, no-break spaces where a line must not end. What is not a number is said in words.
"""

import math
from typing import NamedTuple

from stickslip import digits as dec
from stickslip.digits import NO_BREAK_SPACE, NOT_FINITE, UNBOUNDED, fixed, interval, significant
from stickslip.errors import InputError

__all__ = [
    "NOT_FINITE",
    "NO_BREAK_SPACE",
    "UNBOUNDED",
    "Estimate",
    "estimate",
    "fixed",
    "interval",
    "length",
    "percent",
    "ratio",
    "residue",
    "score",
    "signed_percent",
    "significant",
    "split_estimate",
    "with_unit",
]


class Estimate(NamedTuple):
    """A value and its doubt, as two texts."""

    value: str
    doubt: str


def estimate(value: float, half_width: float) -> str:
    r"""Return a value with the half width of its interval, both ending at the same digit.

    The half width has one digit, or two if it begins with 1.

    Parameters
    ----------
    value : float
        The estimate.
    half_width : float
        Half the width of its interval, or a standard error; not negative.

    Returns
    -------
    str
        Such as "158 ± 4".

    Raises
    ------
    InputError
        If the half width is negative.

    Examples
    --------
    >>> estimate(158.2, 4.1), estimate(231.4, 11.9), estimate(0.25512, math.inf)
    ('158\xa0±\xa04', '231\xa0±\xa012', '0.255 (doubt unbounded)')
    """
    parts = split_estimate(value, half_width)
    if not parts.doubt.startswith("±"):
        return " ".join(part for part in parts if part)
    number, factor = dec.mantissa(parts.value)
    if factor:
        doubt, _ = dec.mantissa(parts.doubt)
        return dec.glued(f"({number} {doubt}) {factor}")
    return dec.glued(f"{parts.value} {parts.doubt}")


def split_estimate(value: float, half_width: float) -> Estimate:
    r"""Return a value and its doubt apart, for a page that sets them in different sizes.

    Parameters
    ----------
    value : float
        The estimate.
    half_width : float
        Half the width of its interval, or a standard error; not negative.

    Returns
    -------
    Estimate
        The two texts.

    Raises
    ------
    InputError
        If the half width is negative.

    Examples
    --------
    >>> split_estimate(21.13, 0.42)
    Estimate(value='21.1', doubt='±\xa00.4')
    """
    if half_width < 0:
        raise InputError(f"a half width is not negative, got {half_width!r}.")
    if not math.isfinite(value):
        return Estimate(dec.in_words(value), "")
    if not math.isfinite(half_width):
        return Estimate(significant(value, 3), f"(doubt {dec.in_words(half_width)})")
    if half_width == 0:
        return Estimate(f"exactly {significant(value, 6)}", "")
    if half_width < abs(value) * 10**-dec.DIGITS_OF_A_FLOAT:
        return Estimate(significant(value, 6), "(doubt below rounding)")
    doubt, place = dec.rounded_doubt(dec.decimal(half_width))
    number = dec.at_place(dec.decimal(value), place)
    power = max(dec.power_of(number), dec.power_of(doubt))
    if power in dec.PLAIN_POWERS:
        return Estimate(dec.plain(number, place), f"±{NO_BREAK_SPACE}{dec.plain(doubt, place)}")
    factor = f"{NO_BREAK_SPACE}{dec.power_factor(power)}"
    scaled = [dec.plain(part.scaleb(-power), place - power) for part in (number, doubt)]
    return Estimate(scaled[0] + factor, f"±{NO_BREAK_SPACE}{scaled[1]}{factor}")


def score(value: float) -> str:
    """Return a score: two decimals below 10, one from 10 up.

    Parameters
    ----------
    value : float
        The score, in the unit of its column.

    Returns
    -------
    str
        The number.

    Examples
    --------
    >>> score(0.2412), score(12.58), score(math.inf)
    ('0.24', '12.6', 'unbounded')
    """
    return fixed(value, 1 if abs(value) >= 9.995 else 2)


def percent(fraction: float) -> str:
    r"""Return a fraction in percent with two digits.

    Parameters
    ----------
    fraction : float
        The fraction: 0.019 is 1.9 %.

    Returns
    -------
    str
        The percentage with its sign if it is negative.

    Examples
    --------
    >>> percent(0.019), percent(0.2306), percent(1.234)
    ('1.9\xa0%', '23\xa0%', '123\xa0%')
    """
    if not math.isfinite(fraction):
        return dec.in_words(fraction)
    number = 100 * dec.decimal(fraction)
    digits = 2 if abs(number) < 100 else dec.power_of(number) + 1
    return with_unit(significant(float(number), digits), "%")


def signed_percent(fraction: float) -> str:
    r"""Return a fraction in percent with two digits and always a sign, except for zero.

    Parameters
    ----------
    fraction : float
        The fraction: -0.23 is −23 %.

    Returns
    -------
    str
        The percentage.

    Examples
    --------
    >>> signed_percent(0.0191), signed_percent(-0.23), signed_percent(0.0)
    ('+1.9\xa0%', '−23\xa0%', '0\xa0%')
    """
    plus = "+" if math.isfinite(fraction) and fraction > 0 else ""
    return plus + percent(fraction)


def ratio(value: float) -> str:
    r"""Return how many times one thing is another, with one decimal.

    Parameters
    ----------
    value : float
        The ratio.

    Returns
    -------
    str
        Such as "3.8 ×".

    Examples
    --------
    >>> ratio(3.78)
    '3.8\xa0×'
    """
    return with_unit(fixed(value, 1), "×") if math.isfinite(value) else dec.in_words(value)


def residue(value: float) -> str:
    r"""Return a small leftover, such as an energy mismatch, with one digit.

    Parameters
    ----------
    value : float
        The leftover.

    Returns
    -------
    str
        Such as "3 × 10⁻¹⁵"; a true zero is "exactly 0".

    Examples
    --------
    >>> residue(2.9e-15), residue(0.0), residue(0.021)
    ('3\xa0×\xa010⁻¹⁵', 'exactly 0', '0.02')
    """
    return significant(value, 1) if value != 0 else "exactly 0"


def length(metres: float, digits: int = 3) -> str:
    r"""Return a length in metres, or in millimetres where metres would need leading zeros.

    Parameters
    ----------
    metres : float
        The length [m].
    digits : int
        Significant digits.

    Returns
    -------
    str
        The length with its unit.

    Examples
    --------
    >>> length(0.20387), length(0.0009, 1), length(6e-12, 1)
    ('0.204\xa0m', '0.9\xa0mm', '6\xa0×\xa010⁻¹²\xa0m')
    """
    if not math.isfinite(metres):
        return dec.in_words(metres)
    if abs(metres) >= 1e-6 and dec.power_of(dec.decimal(metres)) < -1:
        return with_unit(significant(float(dec.decimal(metres).scaleb(3)), digits), "mm")
    return with_unit(significant(metres, digits), "m")


def with_unit(number: str, unit: str) -> str:
    r"""Return a formatted number and its unit, which no line break parts.

    Parameters
    ----------
    number : str
        The number; words such as "unbounded" take no unit.
    unit : str
        The unit; nothing for a pure number.

    Returns
    -------
    str
        Both.

    Examples
    --------
    >>> with_unit("158 ± 4", "N s/m"), with_unit("unbounded", "N")
    ('158\xa0±\xa04\xa0N\xa0s/m', 'unbounded')
    """
    if not unit or not any(character.isdigit() for character in number):
        return number
    return dec.glued(f"{number} {unit}")
