"""What the page of a selection on travels shows."""

from stickslip.report.travels.sections import travel_sections

__all__ = ["travel_sections"]
