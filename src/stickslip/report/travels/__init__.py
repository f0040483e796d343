"""The report of a selection: a verdict as a page."""

from stickslip.report.travels.page import selection_page

__all__ = ["selection_page"]
