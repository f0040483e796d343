"""What the page of a selection on records shows."""

from stickslip.report.records.sections import record_sections

__all__ = ["record_sections"]
