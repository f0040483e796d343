# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.engine import executors as executors
from stickslip.engine import formulation as formulation
from stickslip.engine import solver as solver
from stickslip.engine.solver import EventCount as EventCount
from stickslip.engine.solver import EventTimes as EventTimes
from stickslip.engine.solver import Final as Final
from stickslip.engine.solver import Max as Max
from stickslip.engine.solver import Mean as Mean
from stickslip.engine.solver import Min as Min
from stickslip.engine.solver import Samples as Samples
from stickslip.engine.solver import Sensitivity as Sensitivity
from stickslip.engine.trajectory import Certificate as Certificate
from stickslip.engine.trajectory import Ensemble as Ensemble
from stickslip.engine.trajectory import Event as Event
from stickslip.engine.trajectory import Status as Status
from stickslip.engine.trajectory import Trajectory as Trajectory

__all__ = [
    "Certificate",
    "Ensemble",
    "Event",
    "EventCount",
    "EventTimes",
    "Final",
    "Max",
    "Mean",
    "Min",
    "Samples",
    "Sensitivity",
    "Status",
    "Trajectory",
    "executors",
    "formulation",
    "solver",
]
