"""Numbers in sentences: three digits, a unit without leading zeros, commas in thousands."""

import math
from collections.abc import Sequence
from typing import Final

__all__ = ["capital", "count", "joined", "number", "percent", "quantities", "quantity"]

MINUS: Final = "\N{MINUS SIGN}"
SCALES: Final = {
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
and its name."""
_PLAIN: Final = (1e-4, 1e7)


def number(value: float, digits: int = 3) -> str:
    """Return a number rounded to some digits, without zeros that say nothing.

    Parameters
    ----------
    value : float
        The number.
    digits : int
        Significant digits.

    Returns
    -------
    str
        Plain from 0.0001 to 9,999,999 and as a power of ten beyond.

    Examples
    --------
    >>> number(24841.3), number(-0.3), number(2.5e9), number(math.inf)
    ('24,800', '−0.3', '2.5 × 10⁹', 'unbounded')
    """
    if not math.isfinite(value):
        return "not a number" if math.isnan(value) else "unbounded"
    rounded = float(f"{value:.{digits}g}")
    sign = MINUS if rounded < 0 else ""
    size = abs(rounded)
    if size == 0 or _PLAIN[0] <= size < _PLAIN[1]:
        decimals = 0 if size == 0 else max(0, digits - 1 - math.floor(math.log10(size)))
        text = f"{size:,.{decimals}f}"
        return sign + (text.rstrip("0").rstrip(".") if "." in text else text)
    mantissa, _, power = f"{size:.{digits - 1}e}".partition("e")
    mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
    return f"{sign}{mantissa} × 10{_raised(int(power))}"


def _raised(power: int) -> str:
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def quantities(
    values: Sequence[float], unit: str, digits: int = 3, *, degrees: bool = False
) -> list[str]:
    """Return numbers with their unit, which the largest of them chooses.

    Parameters
    ----------
    values : sequence of float
        The numbers, SI.
    unit : str
        Their SI unit.
    digits : int
        Significant digits.
    degrees : bool
        Whether angles are given in degrees: those of a rig, not those of a joint that moves.

    Returns
    -------
    list of str
        One text for each.

    Examples
    --------
    >>> quantities([0.156, 0.148], "N"), quantities([0.002, 0.0305], "m")
    (['0.156 N', '0.148 N'], ['2 mm', '30.5 mm'])
    >>> quantities([math.pi / 18], "rad", degrees=True), quantities([0.82, 0.0033], "kg")
    (['10°'], ['0.82 kg', '0.0033 kg'])
    """
    if degrees and unit == "rad":
        return [f"{number(math.degrees(value), digits)}°" for value in values]
    size = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    factor, shown = _scale(size, unit)
    texts = [number(factor * value, digits) for value in values]
    return [text if shown in {"", "1"} else f"{text} {shown}" for text in texts]


def _scale(size: float, unit: str) -> tuple[float, str]:
    """Return the factor and the unit in which a size has no leading zeros."""
    found = (1.0, unit)
    for bound, factor, name in SCALES.get(unit, ()):
        edge = bound * (1 - 1e-9)  # 0.1 m may be a little less
        if (factor < 1.0 and size >= edge) or (factor > 1.0 and 0.0 < size < edge):
            found = (factor, name)
    return found


def quantity(value: float, unit: str, digits: int = 3, *, degrees: bool = False) -> str:
    """Return a number with its unit, in thousandths where it would begin with zeros.

    Examples
    --------
    >>> quantity(24.84, "s"), quantity(0.0005, "m"), quantity(1000.02, "Hz"), quantity(5e-8, "m")
    ('24.8 s', '0.5 mm', '1 kHz', '0.05 µm')
    """
    return quantities([value], unit, digits, degrees=degrees)[0]


def span(low: float, high: float, unit: str, digits: int = 3) -> str:
    """Return the ends of a range with the unit that both share.

    Examples
    --------
    >>> span(0.061, 0.0644, "m"), span(9.81, 9.81, "N"), span(900.0, 1200.0, "m")
    ('61 to 64.4 mm', '9.81 N', '900 to 1,200 m')
    """
    least, most = quantities([low, high], unit, digits)
    return most if least == most else f"{least.partition(' ')[0]} to {most}"


def percent(share: float) -> str:
    """Return a share in per cent with two digits.

    Examples
    --------
    >>> percent(0.0542), percent(0.97), percent(1.0), percent(0.0)
    ('5.4 %', '97 %', '100 %', '0 %')
    """
    return f"{number(100 * share, 2 if abs(share) < 0.995 else 3)} %"


def count(size: int, word: str, many: str = "") -> str:
    """Return how many of something there are.

    Examples
    --------
    >>> count(1, "sample"), count(24841, "sample"), count(0, "gap")
    ('1 sample', '24,841 samples', 'no gaps')
    """
    return (
        f"{size:,} {word}" if size == 1 else f"{f'{size:,}' if size else 'no'} {many or word + 's'}"
    )


def joined(parts: Sequence[str]) -> str:
    """Return a list as it stands in a sentence.

    Examples
    --------
    >>> joined(["Dahl", "LuGre", "Stribeck"]), joined(["Dahl"]), joined([])
    ('Dahl, LuGre and Stribeck', 'Dahl', '')
    """
    return f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else "".join(parts)


def capital(text: str) -> str:
    """Return a text with its first letter in upper case, the others as they are.

    Examples
    --------
    >>> capital("viscous and LuGre")
    'Viscous and LuGre'
    """
    return text[:1].upper() + text[1:]
