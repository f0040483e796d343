# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.study import benchmark as benchmark
from stickslip.study import characterization as characterization
from stickslip.study import control as control
from stickslip.study import optimisation as optimisation
from stickslip.study import sweep as sweep
from stickslip.study import testing as testing

__all__ = [
    "benchmark",
    "characterization",
    "control",
    "optimisation",
    "sweep",
    "testing",
]
