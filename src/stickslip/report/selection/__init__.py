"""The report of a selection: a verdict as a page."""

from stickslip.report.selection.page import selection_page

__all__ = ["selection_page"]
