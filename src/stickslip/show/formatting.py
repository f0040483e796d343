"""Numbers, units, lists and counts as text: one rule for each kind, for terminals, files and pages.

A number is rounded to what is known, and is never ``nan`` or ``2.9e-15``:

- with an error (`estimate`): the error has one digit, two if it begins with 1, and the value ends
  where the error ends;
- between two ends (`interval`, `within`): two digits of the width;
- without a known error (`number`): three significant digits, without zeros at the end;
- shares (`percent`): two significant digits; ratios and leftovers likewise two and one.

A true minus, commas in thousands, powers of ten below 0.0001 and from 10,000,000 on. What is not
finite is said in words.

A unit is the multiple that saves leading zeros. Spaces are ordinary ones; a page keeps lines from
ending within a number by `unbroken`.
"""

import json
import math
import re
from collections.abc import Iterable, Sequence
from decimal import ROUND_HALF_UP, Decimal
from typing import Final, NamedTuple

import numpy as np

from stickslip.errors import InputError

MINUS: Final = "\N{MINUS SIGN}"
NOT_FINITE: Final = "not finite"
NO_VALUE: Final = "—"
"""A cell of a table without a value."""
UNBOUNDED: Final = "unbounded"
PLAIN_POWERS: Final = range(-4, 7)
DIGITS_OF_A_FLOAT: Final = 15
MOST_DIGITS: Final = 6
"""Digits of a value however small its error: an error below the tolerances of runs says nothing."""

_SUPERSCRIPTS: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class EstimateText(NamedTuple):
    """A value and its error as two texts, which a space joins to what `estimate` returns."""

    value: str
    """The value, rounded as its error allows."""
    doubt: str
    """The error with its sign, or why there is none."""


def significant(value: float, digits: int = 3) -> str:
    """Return a number rounded to some significant digits, zeros at its end kept.

    Examples
    --------
    >>> significant(0.2, 3), significant(24841, 5), significant(2e9, 2), significant(-3.14159)
    ('0.200', '24,841', '2.0 × 10⁹', '−3.14')
    """
    if digits < 1:
        raise InputError(f"at least 1 digit must be kept, got {digits!r}.")
    if not math.isfinite(value):
        return _not_finite(value)
    if value == 0:
        return "0"
    exact = _decimal(value)
    # Rounding may carry: 9.996 becomes 10.0, whose first digit is one place higher.
    shown = _at_place(exact, _power_of(exact) - digits + 1)
    power = _power_of(shown)
    if power in PLAIN_POWERS:
        return _plain(shown, power - digits + 1)
    return f"{_plain(shown.scaleb(-power), 1 - digits)} × {_ten_to(power)}"


def number(value: float, digits: int = 3) -> str:
    """Return a number rounded to some significant digits, without zeros at its end.

    Examples
    --------
    >>> number(24841.3), number(-0.3), number(2.5e9), number(math.inf)
    ('24,800', '−0.3', '2.5 × 10⁹', 'unbounded')
    """
    text, times, power = significant(value, digits).partition(" × ")
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return text + times + power


def signed(value: float, digits: int = 3) -> str:
    """Return a number as `number` does, with a sign also if it is positive.

    Examples
    --------
    >>> signed(0.25), signed(-0.25), signed(0.0)
    ('+0.25', '−0.25', '0')
    """
    return ("+" if math.isfinite(value) and value > 0 else "") + number(value, digits)


def fixed(value: float, decimals: int) -> str:
    """Return a number with a given number of decimals, for the columns of a table.

    Examples
    --------
    >>> fixed(1234.567, 1), fixed(-0.001, 2)
    ('1,234.6', '0.00')
    """
    if not math.isfinite(value):
        return _not_finite(value)
    if _power_of(_decimal(value)) >= DIGITS_OF_A_FLOAT:
        return significant(value, 3)
    return _plain(_at_place(_decimal(value), -decimals), -decimals)


def estimate(value: float, half_width: float) -> str:
    """Return a value with its error, both ending at the same digit.

    The error has one digit, or two if it begins with 1.

    Examples
    --------
    >>> estimate(158.2, 4.1), estimate(231.4, 11.9), estimate(0.0195, 0.00073)
    ('158 ± 4', '231 ± 12', '0.0195 ± 0.0007')
    >>> estimate(2.13e-6, 4e-8), estimate(52.9447753, 1.4e-14), estimate(0.25512, math.inf)
    ('(2.13 ± 0.04) × 10⁻⁶', '52.9448', '0.255 (uncertainty unbounded)')
    """
    return " ".join(part for part in estimate_text(value, half_width) if part)


def estimate_text(value: float, half_width: float) -> EstimateText:
    """Return the two parts of `estimate`, for a page that sets them in different sizes.

    Examples
    --------
    >>> estimate_text(21.13, 0.42)
    EstimateText(value='21.1', doubt='± 0.4')
    """
    if half_width < 0:
        raise InputError(f"a half width is not negative, got {half_width!r}.")
    if not math.isfinite(value):
        return EstimateText(_not_finite(value), "")
    if not math.isfinite(half_width):
        return EstimateText(number(value), f"(uncertainty {_not_finite(half_width)})")
    # Half a unit of the last digit that a value has at most.
    if half_width <= 0.5 * 10.0**-MOST_DIGITS * abs(value):
        return EstimateText(number(value, MOST_DIGITS), "")
    shown, error, place, power = _rounded(value, half_width)
    if power == 0:
        return EstimateText(_plain(shown, place), f"± {_plain(error, place)}")
    value_text, error_text = (_plain(part.scaleb(-power), place - power) for part in (shown, error))
    return EstimateText(f"({value_text}", f"± {error_text}) × {_ten_to(power)}")


def is_skewed(value: float, low: float, high: float) -> bool:
    """Return whether an end of a range is off that of `estimate` by more than its last digit.

    Examples
    --------
    >>> is_skewed(0.25, 0.24, 0.262), is_skewed(0.25, 0.24, 0.31), is_skewed(0.0, 0.0, 0.4)
    (False, True, True)
    """
    half = 0.5 * (high - low)
    if not (math.isfinite(half) and half > 0.5 * 10.0**-MOST_DIGITS * abs(value)):
        return False
    place = _rounded(value, half)[2]
    return bool(abs(_decimal(0.5 * (low + high)) - _decimal(value)) > Decimal(1).scaleb(place))


def rounded(value: float, half_width: float) -> str:
    """Return a value alone, ending at the digit where `estimate` ends it.

    Examples
    --------
    >>> rounded(21.13, 0.42), rounded(2.13e-6, 4e-8), rounded(21.13, math.inf)
    ('21.1', '2.13 × 10⁻⁶', '21.1')
    """
    text, doubt = estimate_text(value, half_width)
    shown, error, power = doubt.partition(") × ")
    return text.removeprefix("(") + (f" × {power}" if shown and error else "")


def interval(low: float, high: float) -> str:
    """Return a range, its ends rounded to two digits of its width.

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
        return f"at least {significant(low)}" if math.isfinite(low) else "not bounded"
    if math.isinf(low):
        return f"at most {significant(high)}"
    if low == high:
        return f"exactly {number(low, MOST_DIGITS)}"
    place, digits = _shared(low, high)
    if digits:
        return " to ".join(significant(end, digits) for end in (low, high))
    return " to ".join(_plain(_at_place(_decimal(end), place), place) for end in (low, high))


def within(value: float, low: float, high: float) -> str:
    """Return a value with as many digits as `interval` shows of the range that it lies in.

    Examples
    --------
    >>> within(0.25512, 0.24871, 0.26113), within(4.999965, 4.99985, 5.00008)
    ('0.255', '4.99997')
    >>> within(-2.26e-5, -3.33e-4, 2.88e-4), within(5.7312, 5.7312, math.inf)
    ('−0.00002', '5.73')
    >>> within(759.0, -math.inf, math.inf)
    'not identified'
    """
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        return significant(value) if math.isfinite(max(low, -high)) else "not identified"
    place, digits = _shared(low, high)
    if digits:
        return significant(value, max(digits, 3))
    return _plain(_at_place(_decimal(value), place), place)


def percent(fraction: float) -> str:
    """Return a fraction in per cent with two digits.

    Examples
    --------
    >>> percent(0.019), percent(0.2306), percent(0.999), percent(12.34), percent(0.05)
    ('1.9 %', '23 %', '99.9 %', '1,234 %', '5 %')
    """
    if not math.isfinite(fraction):
        return _not_finite(fraction)
    share = 100 * _decimal(fraction)
    # Near 100 % another digit: 99.6 % is not 100 %.
    digits = 2 if abs(fraction) < 0.995 else max(_power_of(share) + 1, 3)
    return f"{number(float(share), digits)} %"


def signed_percent(fraction: float) -> str:
    """Return a fraction in per cent with two digits and always a sign, except for zero.

    Examples
    --------
    >>> signed_percent(0.0191), signed_percent(-0.23), signed_percent(0.0)
    ('+1.9 %', '−23 %', '0 %')
    """
    plus = "+" if math.isfinite(fraction) and fraction > 0 else ""
    return plus + percent(fraction)


def ratio(value: float) -> str:
    """Return how many times one thing is another, with two digits.

    Examples
    --------
    >>> ratio(3.78), ratio(1.0), ratio(1234.0)
    ('3.8 ×', '1.0 ×', '1,200 ×')
    """
    return f"{significant(value, 2)} ×" if math.isfinite(value) else _not_finite(value)


def residue(value: float) -> str:
    """Return a small leftover, such as an energy mismatch, with one digit.

    Examples
    --------
    >>> residue(2.9e-15), residue(0.0), residue(0.021)
    ('3 × 10⁻¹⁵', 'exactly 0', '0.02')
    """
    return significant(value, 1) if value != 0 else "exactly 0"


def _rounded(value: float, half_width: float) -> tuple[Decimal, Decimal, int, int]:
    """Return value and error rounded, the place of their last digit, and their power of ten."""
    exact = _decimal(half_width)
    place = _power_of(exact)
    error, finer = _at_place(exact, place), _at_place(exact, place - 1)
    # 0.96 becomes 1.0, and what begins with 1 has two digits.
    if _power_of(error) == place and finer.as_tuple().digits[0] == 1:
        error, place = finer, place - 1
    shown = _at_place(_decimal(value), place)
    # The larger of both tells the power: a value may be less than its error.
    power = max(part.adjusted() for part in (shown, error) if part)
    return shown, error, place, 0 if power in PLAIN_POWERS else power


def _shared(low: float, high: float) -> tuple[int, int]:
    """Return the power of ten that both ends are rounded to, or how many digits each has else."""
    ends = [_decimal(low), _decimal(high)]
    place = _power_of(ends[1] - ends[0]) - 1
    # Doubles have no more digits than that.
    place = max(place, _power_of(_decimal(max(abs(low), abs(high)))) - DIGITS_OF_A_FLOAT + 1)
    lost = any(end and _power_of(end) < place for end in ends)
    odd = any(end and _power_of(end) not in PLAIN_POWERS for end in ends)
    if not (lost or odd):
        return place, 0
    # One rounding cannot show both ends: over many powers of ten each has its own.
    digits = min(max(_power_of(max(ends, key=abs)) - place + 1, 2), DIGITS_OF_A_FLOAT)
    return place, 2 if lost else digits


def _decimal(value: float) -> Decimal:
    """Return the shortest decimal number that reads back as `value`."""
    return Decimal(repr(float(value)))


def _power_of(exact: Decimal) -> int:
    """Return the power of ten of the first digit, 0 for zero."""
    return exact.adjusted() if exact else 0


def _at_place(exact: Decimal, place: int) -> Decimal:
    """Return a number rounded, halves away from zero, to the power of ten `place`."""
    # Scaled by hand: `quantize` refuses more digits than the context holds.
    return exact.scaleb(-place).to_integral_value(ROUND_HALF_UP).scaleb(place)


def _plain(shown: Decimal, place: int) -> str:
    """Return the text of a number that is already rounded to the power of ten `place`."""
    text = f"{abs(shown):,.{max(-place, 0)}f}"
    return MINUS + text if shown < 0 else text


def _ten_to(power: int) -> str:
    return f"10{str(power).translate(_SUPERSCRIPTS)}"


def _not_finite(value: float) -> str:
    return UNBOUNDED if math.isinf(value) else NOT_FINITE


PREFIXES: Final = {
    "m": ((1e3, 1e-3, "km"), (0.1, 1e3, "mm"), (1e-4, 1e6, "µm")),
    "m/s": ((0.1, 1e3, "mm/s"), (1e-4, 1e6, "µm/s")),
    "s": ((0.1, 1e3, "ms"), (1e-4, 1e6, "µs")),
    "rad": ((0.1, 1e3, "mrad"), (1e-4, 1e6, "µrad")),
    "rad/s": ((0.1, 1e3, "mrad/s"), (1e-4, 1e6, "µrad/s")),
    "N m": ((0.1, 1e3, "mN m"), (1e-4, 1e6, "µN m")),
    "N": ((0.1, 1e3, "mN"), (1e-4, 1e6, "µN")),
    "kg": ((0.1, 1e3, "g"), (1e-4, 1e6, "mg")),
    "Hz": ((1e3, 1e-3, "kHz"), (0.1, 1e3, "mHz")),
}
"""By SI unit: the size from which a larger unit or below which a smaller one is shown, its factor
and its name. The only such table."""
_LEAST: Final = 10.0**PLAIN_POWERS.start


class Scale(NamedTuple):
    """The multiple of a unit in which values are shown: of one, of a column, of an axis.

    Examples
    --------
    >>> scale = scale_of([0.0195], "N")
    >>> scale, scale.quantity(0.0195), scale.estimate(0.0195, 0.00073)
    (Scale(factor=1000.0, unit='mN'), '19.5 mN', '19.5 ± 0.7 mN')
    """

    factor: float
    """What an SI value is multiplied by."""
    unit: str
    """The unit that is shown."""

    def number(self, value: float, digits: int = 3) -> str:
        """Return an SI value in this unit, without the unit."""
        return number(self.factor * value, digits)

    def quantity(self, value: float, digits: int = 3) -> str:
        """Return an SI value with this unit."""
        return with_unit(self.number(value, digits), self.unit)

    def error(self, value: float, digits: int = 3) -> str:
        """Return an SI error or residual with this unit, zeros at its end kept.

        Examples
        --------
        >>> Scale(1e3, "mm").error(0.01), Scale(1e3, "mm").quantity(0.01)
        ('10.0 mm', '10 mm')
        """
        return with_unit(significant(self.factor * value, digits), self.unit)

    def interval(self, low: float, high: float) -> str:
        """Return an SI range in this unit, its ends rounded to two digits of its width.

        Examples
        --------
        >>> Scale(1e3, "mm").interval(0.0982, 0.1017), Scale(1e3, "mm").interval(0.02, 0.02)
        ('98.2 to 101.7 mm', '20 mm')
        >>> Scale(1.0, "N").interval(2.0, math.inf)
        'at least 2.00 N'
        """
        # Ends that are the same to all digits shown are one value.
        if high - low <= 10.0**-MOST_DIGITS * max(abs(low), abs(high)) < math.inf:
            return self.quantity(low, MOST_DIGITS)
        return with_unit(interval(self.factor * low, self.factor * high), self.unit)

    def estimate(self, value: float, half_width: float) -> str:
        """Return an SI value with its error and this unit."""
        return with_unit(estimate(self.factor * value, self.factor * half_width), self.unit)

    def estimate_text(self, value: float, half_width: float) -> EstimateText:
        """Return an SI value and its error apart, without the unit."""
        return estimate_text(self.factor * value, self.factor * half_width)


def scale_of(values: Iterable[float], unit: str) -> Scale:
    """Return the multiple of a unit that saves leading zeros; the largest value chooses.

    Examples
    --------
    >>> scale_of([0.02, -0.05], "m"), scale_of([0.2], "m/s"), scale_of([6e-12], "m")
    (Scale(factor=1000.0, unit='mm'), Scale(factor=1.0, unit='m/s'), Scale(factor=1.0, unit='m'))
    """
    sizes = np.abs(np.asarray(values if isinstance(values, np.ndarray) else list(values), float))
    size = float(np.max(sizes, initial=0.0, where=np.isfinite(sizes)))
    result = Scale(1.0, unit)
    for bound, factor, name in PREFIXES.get(unit, ()):
        edge = bound * (1 - 1e-9)  # 0.1 m may be a little less
        if (factor < 1.0 and size >= edge) or (factor > 1.0 and 0.0 < size < edge):
            result = Scale(factor, name)
    # A power of ten is read more easily with the unit of SI.
    return result if size == 0.0 or result.factor * size >= _LEAST else Scale(1.0, unit)


def quantities(
    values: Sequence[float], unit: str, digits: int = 3, *, degrees: bool = False
) -> list[str]:
    """Return numbers with their unit, which the largest of them chooses.

    Examples
    --------
    >>> quantities([0.156, 0.148], "N"), quantities([0.002, 0.0305], "m")
    (['0.156 N', '0.148 N'], ['2 mm', '30.5 mm'])
    >>> quantities([math.pi / 18], "rad", degrees=True), quantities([0.82, 0.0033], "kg")
    (['10°'], ['0.82 kg', '0.0033 kg'])
    """
    if degrees and unit == "rad":
        return [f"{number(math.degrees(value), digits)}°" for value in values]
    scale = scale_of(values, unit)
    return [scale.quantity(value, digits) for value in values]


def quantity(value: float, unit: str, digits: int = 3, *, degrees: bool = False) -> str:
    """Return a number with its unit, in thousandths where it would begin with zeros.

    Examples
    --------
    >>> quantity(24.84, "s"), quantity(0.0005, "m"), quantity(1000.02, "Hz"), quantity(5e-8, "m")
    ('24.8 s', '0.5 mm', '1 kHz', '0.05 µm')
    >>> quantity(6e-12, "m"), quantity(0.25, "1")
    ('6 × 10⁻¹² m', '0.25')
    """
    return quantities([value], unit, digits, degrees=degrees)[0]


def span(low: float, high: float, unit: str, digits: int = 3) -> str:
    """Return the ends of a range with the unit that both share.

    Examples
    --------
    >>> span(0.061, 0.0644, "m"), span(9.81, 9.81, "N"), span(900.0, 1200.0, "m")
    ('61 to 64.4 mm', '9.81 N', '0.9 to 1.2 km')
    """
    scale = scale_of([low, high], unit)
    least, most = (scale.number(end, digits) for end in (low, high))
    return with_unit(most if least == most else f"{least} to {most}", scale.unit)


def at_worst(size: str, place: str) -> str:
    """Return what follows the half-width of a band that is wider somewhere.

    Examples
    --------
    >>> "± 2 %" + at_worst("8 %", "10 mm/s")
    '± 2 % in the median, and to ± 8 % at worst, at 10 mm/s'
    """
    return f" in the median, and to ± {size} at worst, at {place}"


def unit_text(unit: str) -> str:
    """Return a unit as it is printed: exponents raised, nothing for a pure number.

    Examples
    --------
    >>> unit_text("N s^2/m^2"), unit_text("1"), unit_text("N/degC")
    ('N s²/m²', '', 'N/°C')
    """
    if unit == "1":
        return ""
    unit = re.sub(r"\bdeg(?=[CF]\b)", "°", unit)
    return re.sub(r"\^(-?\d+)", lambda m: m[1].translate(_SUPERSCRIPTS), unit)


def with_unit(text: str, unit: str) -> str:
    """Return a formatted number and its unit.

    Examples
    --------
    >>> with_unit("158 ± 4", "N s^2/m^2"), with_unit("unbounded", "N"), with_unit("0.25", "1")
    ('158 ± 4 N s²/m²', 'unbounded', '0.25')
    """
    unit = unit_text(unit)
    return f"{text} {unit}" if unit and any(sign.isdigit() for sign in text) else text


NO_BREAK_SPACE: Final = "\N{NO-BREAK SPACE}"
_WORDS: Final = [
    "no",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
]
_UNIT: Final = (
    r"(?:1/)?(?:(?:[kmµMG]?(?:m|s|N|J|Pa|rad|Hz|W|V|g)|K|°C)(?![A-Za-z])"
    r"[²³⁴⁻¹]*(?:\^\d)?/?)+(?![A-Za-z\d])"
)
_WITHIN: Final = re.compile(
    rf"(?<=[\d)⁰¹²³⁴⁵⁶⁷⁸⁹])(?: {_UNIT})+"  # a number and its unit
    r"|(?<=[\d)]) (?=[%±×✓!](?![A-Za-z]))"
    r"|(?<=[±×]) (?=\d)"
    r"|(?<=\$) = (?=[\d(−])"  # a symbol and its value
)


_HIDDEN: Final = re.compile(
    "[\x00-\x1f\x7f-\x9f"  # control characters, with which terminals are steered
    "\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"  # turn the direction of what follows
    "\u2028\u2029\ufeff\ufff9-\ufffb\U000e0000-\U000e007f"
    "\ud800-\udfff]"  # halves of characters: bytes of a file name that are no text
)


def printable(text: str, *, lines: bool = False) -> str:
    r"""Return a text of unknown origin as it may go to a terminal or a page.

    Characters that steer a terminal, turn the direction of writing or are no characters are
    replaced by their escapes, which JSON knows too.

    Examples
    --------
    >>> print(printable("\x1b[31mred, \u202edesrever"))
    \u001b[31mred, \u202edesrever
    >>> print(printable("one\ntwo"))
    one\ntwo
    """
    return _HIDDEN.sub(
        lambda item: item[0] if lines and item[0] in "\n\t" else json.dumps(item[0])[1:-1], text
    )


def unbroken(text: str) -> str:
    r"""Return a text whose lines do not end within a number and its unit, as pages want it.

    Examples
    --------
    >>> unbroken("158 ± 4 N s/m at (2.5 ± 0.2) × 10⁻⁷ m")
    '158\xa0±\xa04\xa0N\xa0s/m at (2.5\xa0±\xa00.2)\xa0×\xa010⁻⁷\xa0m'
    >>> unbroken("5 samples in 2 s, in 3 ways")
    '5 samples in 2\xa0s, in 3 ways'
    """
    return _WITHIN.sub(lambda match: match[0].replace(" ", NO_BREAK_SPACE), text)


def count(size: int, word: str, many: str = "") -> str:
    """Return how many of something there are.

    Examples
    --------
    >>> count(1, "sample"), count(24841, "sample"), count(0, "gap")
    ('1 sample', '24,841 samples', 'no gaps')
    """
    return f"1 {word}" if size == 1 else f"{f'{size:,}' if size else 'no'} {many or word + 's'}"


def in_words(size: int) -> str:
    """Return a small whole number in words.

    Examples
    --------
    >>> in_words(5), in_words(25)
    ('five', '25')
    """
    return _WORDS[size] if 0 <= size < len(_WORDS) else f"{size:,}"


def joined(parts: Sequence[str], most: int | None = None) -> str:
    """Return a list as it stands in a sentence; of more than `most` parts, the first ones.

    Examples
    --------
    >>> joined(["1", "2", "3", "4"], 3)
    '1, 2 and 2 more'
    >>> joined(["Dahl", "LuGre", "Stribeck"]), joined(["Dahl"]), joined([])
    ('Dahl, LuGre and Stribeck', 'Dahl', '')
    """
    if most is not None and len(parts) > most:
        parts = [*parts[: most - 1], f"{len(parts) - most + 1} more"]
    return f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else "".join(parts)


def capital(text: str) -> str:
    """Return a text with its first letter in upper case, the others as they are.

    Examples
    --------
    >>> capital("viscous and LuGre")
    'Viscous and LuGre'
    """
    return text[:1].upper() + text[1:]


def lower_first(text: str) -> str:
    """Return a text with its first letter in lower case, the others as they are.

    Examples
    --------
    >>> lower_first("The rig: mass and stiffness.")
    'the rig: mass and stiffness.'
    """
    return text[:1].lower() + text[1:]


def parameter_words(path: str) -> str:
    """Return the name of a parameter in words, as it stands within a sentence.

    Examples
    --------
    >>> parameter_words("friction.kinetic_coefficient"), parameter_words("stribeck_velocity")
    ('kinetic coefficient', 'Stribeck velocity')
    """
    return path.rpartition(".")[2].replace("_", " ").replace("stribeck", "Stribeck")
