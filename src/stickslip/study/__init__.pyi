# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.study import control as control
from stickslip.study import optimisation as optimisation
from stickslip.study import sweep as sweep
from stickslip.study.presliding import PreslidingLoop as PreslidingLoop
from stickslip.study.presliding import presliding_length as presliding_length
from stickslip.study.presliding import presliding_loop as presliding_loop
from stickslip.study.testing import check_law as check_law

__all__ = [
    "PreslidingLoop",
    "check_law",
    "control",
    "optimisation",
    "presliding_length",
    "presliding_loop",
    "sweep",
]
