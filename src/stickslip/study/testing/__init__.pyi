# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.study.testing.suites import ConformanceFinding as ConformanceFinding
from stickslip.study.testing.suites import Report as Report
from stickslip.study.testing.suites import check_friction as check_friction
from stickslip.study.testing.suites import check_mechanism as check_mechanism

__all__ = [
    "ConformanceFinding",
    "Report",
    "check_friction",
    "check_mechanism",
]
