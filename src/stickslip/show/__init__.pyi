# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.show import plots as plots
from stickslip.show import report as report

__all__ = [
    "plots",
    "report",
]
