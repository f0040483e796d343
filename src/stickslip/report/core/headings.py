"""Headings that pages of several kinds share."""

from typing import Final

from stickslip.formatting import in_words, quantity

CERTIFICATE: Final = "Certificate of the computation"


def checks_heading(warned: int, source: str = "its checks") -> str:
    """Return the heading of the section on a record and its checks.

    Examples
    --------
    >>> checks_heading(0), checks_heading(2)
    ('The record: no warnings from its checks', 'The record: two warnings from its checks')
    """
    if not warned:
        return "The record: no warnings from its checks"
    noun = "warning" if warned == 1 else "warnings"
    return f"The record: {in_words(warned)} {noun} from {source}"


def ended_early(t: float) -> str:
    """Return what is said first of a run that ended before its end time.

    Examples
    --------
    >>> ended_early(0.25)
    'The run ends early, at 0.25 s'
    """
    return f"The run ends early, at {quantity(t, 's')}"


def identified_heading(count: int) -> str:
    """Return the heading of the section on parameters that are all identified.

    Examples
    --------
    >>> identified_heading(2), identified_heading(5)
    ('Both parameters are identified', 'All five parameters are identified')
    """
    if count == 1:
        return "The parameter is identified"
    if count == 2:
        return "Both parameters are identified"
    return f"All {in_words(count)} parameters are identified"
