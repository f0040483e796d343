"""The report of a selection on records: a verdict as a page."""

from stickslip.report.records.page import record_document, record_page

__all__ = ["record_document", "record_page"]
