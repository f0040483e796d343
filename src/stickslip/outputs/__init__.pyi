# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.solver import EventCount as EventCount
from stickslip.solver import EventTimes as EventTimes
from stickslip.solver import Final as Final
from stickslip.solver import Max as Max
from stickslip.solver import Mean as Mean
from stickslip.solver import Min as Min
from stickslip.solver import Samples as Samples

__all__ = [
    "EventCount",
    "EventTimes",
    "Final",
    "Max",
    "Mean",
    "Min",
    "Samples",
]
