"""Sections that cannot cost a page: one that fails becomes a line."""

from collections.abc import Callable

from stickslip.report.blocks import Paragraph
from stickslip.report.documents import Section

__all__ = ["guarded"]


def guarded(name: str, nav: str, make: Callable[[], Section | None]) -> Section | None:
    """Return a section, or in its place a line that says why it could not be made.

    Parameters
    ----------
    name, nav : str
        Address and name of the section, should it fail.
    make : callable
        Returns the section, or None if there is nothing to show.

    Examples
    --------
    >>> def fails():
    ...     raise ValueError("no such figure")
    >>> guarded("motion", "Motion", fails).blocks[0].text
    'This section could not be made: no such figure.'
    """
    try:
        return make()
    except Exception as error:  # whatever it is, the result is worth more
        what = (str(error) or type(error).__name__).rstrip(".")
        line = Paragraph(text=f"This section could not be made: {what}.")
        return Section(id=name, nav=nav, heading=nav, blocks=(line,))
