"""Numbers within sentences: plain where they can be, else a power of ten, never ``1.1e+02``."""

from typing import Final

__all__ = ["short"]

SUPERSCRIPTS: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MOST_PLAIN: Final = 6
"""Largest power of ten that is written out."""


def short(value: float, digits: int = 3) -> str:
    r"""Return a number to so many digits at most.

    Examples
    --------
    >>> short(110.0, 2), short(0.25), short(12_345.0), short(4.2e-10, 2)
    ('110', '0.25', '12,300', '4.2\xa0×\xa010⁻¹⁰')
    """
    text = f"{value:.{digits}g}"
    mantissa, found, power = text.partition("e")
    if not found:
        return text
    if 0 <= int(power) <= MOST_PLAIN:
        return f"{float(text):,.0f}"
    raised = str(int(power)).translate(SUPERSCRIPTS)
    return f"{mantissa}\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}10{raised}"
