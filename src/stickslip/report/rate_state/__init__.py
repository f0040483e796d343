"""What the page of a selection on velocity steps shows."""

from stickslip.report.rate_state.sections import sections

__all__ = ["sections"]
