"""What the page of a selection on features of stick-slip shows."""

from stickslip.report.features.sections import feature_sections

__all__ = ["feature_sections"]
