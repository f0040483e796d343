"""What the page of a selection on features of stick-slip shows."""

from stickslip.report.features.sections import sections

__all__ = ["sections"]
