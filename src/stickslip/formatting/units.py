"""Numbers with units, in the multiple of the unit that saves leading zeros."""

import math
import re
from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

import numpy as np

from stickslip.formatting.numbers import (
    MOST_DIGITS,
    PLAIN_POWERS,
    EstimateText,
    estimate,
    estimate_text,
    interval,
    number,
    significant,
)

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
_RAISED: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


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
    found = Scale(1.0, unit)
    for bound, factor, name in PREFIXES.get(unit, ()):
        edge = bound * (1 - 1e-9)  # 0.1 m may be a little less
        if (factor < 1.0 and size >= edge) or (factor > 1.0 and 0.0 < size < edge):
            found = Scale(factor, name)
    # A power of ten is read more easily with the unit of SI.
    return found if size == 0.0 or found.factor * size >= _LEAST else Scale(1.0, unit)


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
    return re.sub(r"\^(-?\d+)", lambda m: m[1].translate(_RAISED), unit)


def with_unit(text: str, unit: str) -> str:
    """Return a formatted number and its unit.

    Examples
    --------
    >>> with_unit("158 ± 4", "N s^2/m^2"), with_unit("unbounded", "N"), with_unit("0.25", "1")
    ('158 ± 4 N s²/m²', 'unbounded', '0.25')
    """
    unit = unit_text(unit)
    return f"{text} {unit}" if unit and any(sign.isdigit() for sign in text) else text
