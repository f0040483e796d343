# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.study import characterization as characterization
from stickslip.study import control as control
from stickslip.study import optimisation as optimisation
from stickslip.study import sweep as sweep
from stickslip.study import testing as testing

__all__ = [
    "characterization",
    "control",
    "optimisation",
    "sweep",
    "testing",
]
