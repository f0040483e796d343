"""Suites that mechanisms and laws of other packages can run on themselves."""

from stickslip.testing.friction import check_friction
from stickslip.testing.mechanisms import check_mechanism
from stickslip.testing.report import Finding, Report

__all__ = ["Finding", "Report", "check_friction", "check_mechanism"]
