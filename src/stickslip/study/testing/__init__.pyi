# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.study.testing.friction import check_friction as check_friction
from stickslip.study.testing.mechanisms import check_mechanism as check_mechanism
from stickslip.study.testing.report import ConformanceFinding as ConformanceFinding
from stickslip.study.testing.report import Report as Report

__all__ = [
    "ConformanceFinding",
    "Report",
    "check_friction",
    "check_mechanism",
]
