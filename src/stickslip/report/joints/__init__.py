"""What the page of a selection for several joints shows."""

from stickslip.report.joints.sections import joint_sections

__all__ = ["joint_sections"]
