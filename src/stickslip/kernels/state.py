"""Places in the two state vectors of a run, and the layout of what it records."""

from stickslip.kernels.dense import TERMS
from stickslip.kernels.model import N_STATES
from stickslip.kernels.tier import Vector, vector

__all__ = [
    "DENSE_AT",
    "EVENTS",
    "EVENT_COLUMNS",
    "FLAGS",
    "MODE",
    "PIECE",
    "REJECTED",
    "RESIDUAL",
    "ROUNDING",
    "ROW_COLUMNS",
    "STALLS",
    "STATE_AT",
    "STATUS",
    "STEP",
    "STEPS",
    "SUPPLIED",
    "TAKEN",
    "TIME",
    "VIOLATION",
    "grown",
]

# Real-valued state: present time, step to try, work supplied, work taken by friction, largest
# guard violation, largest event residual.
TIME = 0
STEP = 1
SUPPLIED = 2
TAKEN = 3
VIOLATION = 4
RESIDUAL = 5

# Whole-numbered state: contact mode, switch flags, piece of the drives, how the run ended, steps
# recorded, steps rejected, events recorded, events in a row without progress.
MODE = 0
FLAGS = 1
PIECE = 2
STATUS = 3
STEPS = 4
REJECTED = 5
EVENTS = 6
STALLS = 7

# A recorded step: from, to, length of the dense output, mode, flags, piece; states; dense output.
STATE_AT = 6
DENSE_AT = STATE_AT + N_STATES
ROW_COLUMNS = DENSE_AT + TERMS * N_STATES

ROUNDING = 4.5e-16
"""Two units in the last place of 1: times closer than this, relatively, are the same."""

# A recorded event: time, mode before, mode after, guard, flags after, margin.
EVENT_COLUMNS = 6


def grown(values: Vector, size: int) -> Vector:
    """Return the vector itself if it has room for `size`, else a copy twice as long."""
    if size <= len(values):
        return values
    larger = vector(2 * size)
    for i in range(len(values)):
        larger[i] = values[i]
    return larger
