"""What the sections share."""

from typing import Literal

from stickslip.paper.audit import PaperAudit
from stickslip.report import Axis

__all__ = ["COLOURS", "travel_axis"]

COLOURS: dict[str, Literal["c1", "c2", "c3", "c4"]] = {"A": "c2", "B": "c1", "C": "c3"}
"""Colour of each reading of the rig."""

NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")


def in_words(number: int) -> str:
    """Return a small number in words."""
    return NUMBERS[number] if number < len(NUMBERS) else str(number)


def travel_axis(audit: PaperAudit, caption: str) -> Axis:
    """Return the travel axis of the tables, with the measured travel as its line.

    Parameters
    ----------
    audit : PaperAudit
        The audit, which has the measured travel.
    caption : str
        What the marks are.

    Returns
    -------
    Axis
        An axis from 0 to 0.5 m.
    """
    return Axis(
        low=0.0,
        high=0.5,
        ticks=(0.0, 0.1, 0.2, 0.3, 0.4, 0.5),
        reference=audit.measured,
        caption=caption,
    )
