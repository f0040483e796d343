"""What the page of a selection on travels shows."""

from stickslip.report.travels.sections import sections

__all__ = ["sections"]
