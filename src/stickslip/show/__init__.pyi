# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.show import plots as plots
from stickslip.show import report as report

__all__ = [
    "plots",
    "report",
]
