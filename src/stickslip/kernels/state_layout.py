"""Places in the two vectors of a run, and the layout of what it records.

One vector `w` holds all real numbers of a run and one vector `whole` all whole ones: compiled code
passes two arrays and counts no references, and one compilation serves all mechanisms and laws.

`w` begins with what has one size in all runs. Then come the numbers that the equations read: value,
slope and start of each drive, values given from outside, the parameters; then what has a size of
its own in each model. `whole` begins with the state of a run; then come sizes and places in `w`,
which `header` writes, and tables.

Docstrings of kernels list the slots that a function reads and writes, with all that it calls. It
reads what must be there when it begins; what it writes and does not read is its result, or scratch
that nothing may rely on. `drives` are the places before GIVEN. What the equations read whenever
they are asked, drives, parameters and where they are themselves, is not listed, nor are sizes and
places. A name in back quotes is an argument that gives a place.
"""

from stickslip.kernels.backend import Vector, vector

__all__ = [
    "ADDRESS",
    "BOOKS",
    "CAN_LIFT",
    "CAN_STICK",
    "DEEPEST",
    "DENSE",
    "DENSE_SIZE",
    "DOP853_STAGES",
    "DRIFT",
    "END",
    "EVENTS",
    "EVENT_COLUMNS",
    "FIRST_LIMIT",
    "FIRST_WALL",
    "FLAGS",
    "FRACTION",
    "GIVEN",
    "GROSS",
    "HAS_BRISTLES",
    "HEADER",
    "INTERVAL",
    "LENGTH",
    "LOST",
    "LOWEST",
    "MATRIX",
    "MODE",
    "MOST_EVENTS",
    "NUMBERS",
    "N_CHANNELS",
    "N_COORDINATES",
    "N_DRIVES",
    "N_GUARDS",
    "N_LIMITS",
    "N_STATES",
    "N_SWITCHES",
    "N_WALLS",
    "PIECE",
    "PIVOTS",
    "POINT",
    "POLYNOMIAL",
    "REACHED",
    "REJECTED",
    "RESIDUAL",
    "REST_IS_FINAL",
    "ROOM",
    "ROUNDING",
    "ROW_COLUMNS",
    "ROW_DENSE",
    "SAMPLED",
    "SAMPLES",
    "SCALE",
    "SERIES",
    "SIZE",
    "SLIP",
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

# Present time, steps to try (of a stepper, of a series), work supplied and taken by friction,
# largest guard violation and event residual, fraction of a step that holds, and its length, work
# of either sign, work taken by hard stops.
TIME = 0
STEP = 1
STRIDE = 2
SUPPLIED = 3
TAKEN = 4
VIOLATION = 5
RESIDUAL = 6
FRACTION = 7
LENGTH = 8
GROSS = 9
LOST = 10

# Where the equations are: an address, or the functions themselves.
ADDRESS = 11

# A guard as a polynomial, its intervals.
POLYNOMIAL = 12
ROOM = POLYNOMIAL + SERIES + 1
NUMBERS = ROOM + (DEEPEST + 2) * INTERVAL
"""Where the numbers begin that the equations read."""

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
"""Length of the state; sizes and places follow."""

# Sizes: states, coordinates, guards, switches, limits, channels, hard stops, drives; index of the
# slip velocity; what the model can do, 1 or 0; index of the guard of the first limit and of the
# first hard stop; most events of one step; columns of a row.
N_STATES = 11
N_COORDINATES = 12
N_GUARDS = 13
N_SWITCHES = 14
N_LIMITS = 15
N_CHANNELS = 16
N_WALLS = 17
N_DRIVES = 18
SLIP = 19
CAN_STICK = 20
CAN_LIFT = 21
HAS_BRISTLES = 22
REST_IS_FINAL = 23
FIRST_LIMIT = 24
FIRST_WALL = 25
MOST_EVENTS = 26
WALL_COLUMNS = 27
"""Columns of a hard stop: position, restitution, mass that its impulse meets, then for each
coordinate the change of its rate over that of the stopped one."""
DENSE_SIZE = 28
ROW_COLUMNS = 29

# Places in `w`: values of the drives given from outside; state, new state, sizes reached, state at
# the end of a run, a point inside a step, room for values of functions; stages, matrix, its
# pivots, df/dt, dense output; guards at points of a step, their largest sizes, the least of those
# that end runs, their slopes; hard stops; the end.
GIVEN = 30
Y = 31
Y1 = 32
SCALE = 33
END = 34
POINT = 35
VALUES = 36
STAGES = 37
MATRIX = 38
PIVOTS = 39
DRIFT = 40
DENSE = 41
SAMPLED = 42
REACHED = 43
LOWEST = 44
SLOPES = 45
WALLS = 46
SIZE = 47
HEADER = 48
"""Length of state, sizes and places; behind it stand coordinate and side of each hard stop."""

# A recorded step: from, to, length of the dense output, mode, flags, piece; then the dense output,
# of which a series keeps the first state only: it is made again when it is asked for.
ROW_DENSE = 6

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
