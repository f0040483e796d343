"""What the page of a selection on records shows."""

from stickslip.report.records.sections import sections

__all__ = ["sections"]
