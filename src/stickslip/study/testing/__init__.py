"""Suites that mechanisms and laws of other packages can run on themselves."""

from stickslip.study.testing.friction import check_friction
from stickslip.study.testing.mechanisms import check_mechanism
from stickslip.study.testing.report import ConformanceFinding, Report

__all__ = ["ConformanceFinding", "Report", "check_friction", "check_mechanism"]


def __dir__() -> list[str]:
    return sorted(__all__)
