"""Places in the vectors of a run, and the layout of what it records.

One vector `w` holds all numbers of a run: compiled code passes one array and counts no references.
It begins with what the equations read: value, slope and start of each drive, drive values given
from outside, the parameters; their room is a round number, so that kernels serve many laws.

Docstrings of kernels list the slots that a function reads and writes, with all that it calls. It
reads what must be there when it begins; what it writes and does not read is its result, or scratch
that nothing may rely on. `drives` are the places before GIVEN. Parameters and drives, which the
equations read whenever they are asked, are not listed. A name in back quotes is an argument that
gives a place.
"""

from stickslip.kernels.backend import Vector, vector
from stickslip.kernels.model_interface import (
    N_CHANNELS,
    N_COORDINATES,
    N_DRIVES,
    N_GUARDS,
    N_STATES,
    N_WALLS,
    PARAMETER_ROOM,
)

__all__ = [
    "ADDRESS",
    "BOOKS",
    "DEEPEST",
    "DENSE",
    "DENSE_SIZE",
    "DOP853_STAGES",
    "DRIFT",
    "END",
    "EVENTS",
    "EVENT_COLUMNS",
    "FLAGS",
    "FRACTION",
    "GIVEN",
    "GROSS",
    "INTERVAL",
    "LENGTH",
    "LOST",
    "LOWEST",
    "MATRIX",
    "MODE",
    "PIECE",
    "PIVOTS",
    "POINT",
    "POLYNOMIAL",
    "REACHED",
    "REJECTED",
    "RESIDUAL",
    "ROOM",
    "ROUNDING",
    "ROW_COLUMNS",
    "ROW_DENSE",
    "SAMPLED",
    "SAMPLES",
    "SCALE",
    "SERIES",
    "SIZE",
    "SLOPE",
    "SLOPES",
    "SLOW",
    "STAGES",
    "STALLS",
    "STATUS",
    "STEP",
    "STEPPER",
    "STEPS",
    "STRIDE",
    "SUPPLIED",
    "TAKEN",
    "TERMS",
    "TIME",
    "VALUES",
    "VIOLATION",
    "WALLS",
    "WALL_COLUMNS",
    "WHOLES",
    "Y1",
    "Y",
    "longer",
]

DOP853_STAGES = 16
SERIES = 20
"""Most terms of a series after the first."""
TERMS = 7
"""Terms of the nested form of dense output after the first."""
SAMPLES = 8
"""Parts of a step at whose ends guards are looked at."""
DEEPEST = 40
"""Halvings of an interval after which two roots that have not parted are one, and touch only."""
INTERVAL = SERIES + 3
"""An interval: its start, its width, the Bernstein coefficients of a polynomial on it."""
WALL_COLUMNS = 3 + N_COORDINATES
"""A hard stop: position, restitution, mass that its impulse meets, then for each coordinate the
change of its rate over that of the stopped one."""

# Read by the equations.
GIVEN = 3 * N_DRIVES  # values of the drives given from outside
ADDRESS = PARAMETER_ROOM - 1  # where the compiled equations are, as an address

# Present time, steps to try (of a stepper, of a series), work supplied and taken by friction,
# largest guard violation and event residual, fraction of a step that holds, and its length, work
# of either sign, work taken by hard stops.
TIME = PARAMETER_ROOM
STEP = TIME + 1
STRIDE = TIME + 2
SUPPLIED = TIME + 3
TAKEN = TIME + 4
VIOLATION = TIME + 5
RESIDUAL = TIME + 6
FRACTION = TIME + 7
LENGTH = TIME + 8
GROSS = TIME + 9
LOST = TIME + 10

# State, new state, its slope, sizes reached, state at the end of a run, a point inside a step,
# room for values of functions.
Y = TIME + 11
Y1 = Y + N_STATES
SLOPE = Y1 + N_STATES
SCALE = SLOPE + N_STATES
END = SCALE + N_STATES
POINT = END + N_STATES
VALUES = POINT + N_STATES

# Stages, matrix, its pivots, df/dt, dense output.
STAGES = VALUES + N_STATES + N_GUARDS + N_CHANNELS + 8
MATRIX = STAGES + DOP853_STAGES * N_STATES
PIVOTS = MATRIX + N_STATES * N_STATES
DRIFT = PIVOTS + N_STATES
DENSE = DRIFT + N_STATES
DENSE_SIZE = 1 + (SERIES + 1) * N_STATES

# Guards at points of a step, their largest sizes, the least of those that end runs, their slopes,
# one as a polynomial, its intervals, hard stops.
SAMPLED = DENSE + DENSE_SIZE
REACHED = SAMPLED + (SAMPLES + 1) * N_GUARDS
LOWEST = REACHED + N_GUARDS
SLOPES = LOWEST + N_GUARDS
POLYNOMIAL = SLOPES + N_GUARDS * (N_STATES + 1)
ROOM = POLYNOMIAL + SERIES + 1
WALLS = ROOM + (DEEPEST + 2) * INTERVAL
SIZE = WALLS + N_WALLS * WALL_COLUMNS

# Whole-numbered state: contact mode, switch flags, piece of the drives, how the run ended, steps
# recorded, steps rejected, events recorded, events in a row without progress, stepper of the mode,
# short steps in a row, whether work is booked.
MODE = 0
FLAGS = 1
PIECE = 2
STATUS = 3
STEPS = 4
REJECTED = 5
EVENTS = 6
STALLS = 7
STEPPER = 8
SLOW = 9
BOOKS = 10
WHOLES = 11

# A recorded step: from, to, length of the dense output, mode, flags, piece; then the dense output,
# of which a series keeps the first state only: it is made again when it is asked for.
ROW_DENSE = 6
ROW_COLUMNS = ROW_DENSE + 1 + (TERMS + 1) * N_STATES

ROUNDING = 4.5e-16
"""Two units in the last place of 1: times closer than this, relatively, are the same."""

# A recorded event: time, mode before, mode after, guard, flags after, margin.
EVENT_COLUMNS = 6


def longer(values: Vector) -> Vector:
    """Return a copy with twice the room."""
    copy = vector(2 * len(values))
    for i in range(len(values)):
        copy[i] = values[i]
    return copy
