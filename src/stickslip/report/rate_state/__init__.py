"""What the page of a selection on velocity steps shows."""

from stickslip.report.rate_state.sections import rate_state_sections

__all__ = ["rate_state_sections"]
