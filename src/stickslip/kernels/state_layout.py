"""Places in the two vectors of a run, the layout of what it records, and named whole numbers.

One vector `w` holds all real numbers of a run and one vector `whole` all whole ones: compiled
code passes two arrays and counts no references, and one compilation serves all mechanisms and
laws.

`w` begins with what has one size in all runs. Then come the numbers that the equations read:
value, slope and start of each drive, values given from outside, the parameters; then what has a
size of its own in each model. `whole` begins with the state of a run; then come sizes and places
in `w`, which `header` writes, and tables.

Docstrings of kernels list the slots that a function reads and writes, with all that it calls. It
reads what must be there when it begins; what it writes and does not read is its result, or
scratch that nothing may rely on. `drives` are the places before GIVEN. What the equations read
whenever they are asked, drives, parameters and where they are themselves, is not listed, nor are
sizes and places, nor what becomes of the slots of several contacts where these are called by
their address. A name in back quotes is an argument that gives a place.
"""

# Whole numbers that pass between generated modules, kernels and their readers.

# Index of each guard in the vector of guards; switch j has index SWITCH + j. Limits, which end the
# run, follow the switches, and then the hard stops, here called walls.
STOP = 0
BREAK_FORWARD = 1
BREAK_BACKWARD = 2
LIFT_OFF = 3
SWITCH = 4

# What is kept of a run in an ensemble.
FINAL = 0
AT = 1
GREATEST = 2
SMALLEST = 3
MEAN = 4
EVENT_TIME = 5
EVENT_COUNT = 6
GRADIENT = 7

# Modes of a coordinate where several contacts rub: held, slipping, without friction; pushed to its
# static level, in decisions, is PUSHED times the direction.
HELD_FAST = 0
FORWARD = 1
BACKWARD = -1
FREE = 2
PUSHED = 3
UNLOADED = 3
"""Mode of a contact that is open, in what a run records."""

# What happened, in the records of events. An impact of coordinate i gives HIT + i; limits
# follow them, and then switch j has two codes, the second where it ceases to hold. With several
# contacts coordinates that leave their stops come last.
STOPPED = 0
REVERSED = 1
BROKE_AWAY = 2
LEFT_GROUND = 3
LEFT_STOP = 4
HIT = 5
OPENED = 5  # with several contacts: impacts follow these two
CLOSED_AGAIN = 6

# How a mode is stepped: DOP853, Rodas5P, series.
SMOOTH = 0
STIFF = 1
EXACT = 2

# How a run ended; limit j gives LIMITED + j.
RUNNING = 0
END_TIME = 1
AT_REST = 2
LIFTED_OFF = 3
STEP_LIMIT = 4
STEP_TOO_SMALL = 5
ZENO = 6
FULL = 7  # not yet: the caller makes room for rows, and calls again
LIMITED = 8

# Places, and sizes of what stands there.
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

# Where the equations are, and what works them out where several contacts rub: addresses, or the
# functions themselves.
ADDRESS = 11
SEVERAL = 12

# With several contacts: largest kinetic energy, mean length of steps that end with an event,
# determinant of the reactions' equations over that without friction, and the latter.
LIVELIEST = 13
RHYTHM = 14
PIVOT = 15
FRICTIONLESS = 16

HELD_STRIDE = 17
"""Length of the next series of one contact that is held; STRIDE is that of one that slips."""

# A guard as a polynomial, its intervals.
POLYNOMIAL = 18
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
# With several contacts: decisions, trials they took, those of which another was possible.
DECISIONS = 11
PIVOTINGS = 12
AMBIGUOUS = 13
# What they answered, and the rows of events that they left.
ANSWER = 14
CHANGED = 15
WHOLES = 16
"""Length of the state; sizes and places follow."""

# Sizes: states, coordinates, guards, switches, limits, columns beside the states, hard stops,
# drives; index of the slip velocity; what the model can do, 1 or 0; index of the guard of the first
# limit and of the first hard stop; most events of one step; columns of a row.
N_STATES = 16
N_COORDINATES = 17
N_GUARDS = 18
N_SWITCHES = 19
N_LIMITS = 20
N_COLUMNS = 21
N_WALLS = 22
N_DRIVES = 23
SLIP = 24
CAN_STICK = 25
CAN_LIFT = 26
HAS_BRISTLES = 27
REST_IS_FINAL = 28
FIRST_LIMIT = 29
FIRST_WALL = 30
MOST_EVENTS = 31
WALL_COLUMNS = 32
"""Columns of a hard stop: position, restitution; with one contact then the mass that its impulse
meets, and for each coordinate the change of its rate over that of the stopped one."""
DENSE_SIZE = 33
ROW_COLUMNS = 34

# Places in `w`: values of the drives given from outside; state, new state, sizes reached, state at
# the end of a run, a point inside a step, room for values of functions; accelerations by single
# forces, of which others leave little, of coordinates that began at rest; stages, matrix, its
# pivots, df/dt, dense output; guards at points of a step, their largest sizes, the least of those
# that end runs, their slopes; hard stops; the end.
GIVEN = 35
Y = 36
Y1 = 37
SCALE = 38
END = 39
POINT = 40
VALUES = 41
PULLS = 144
STAGES = 42
MATRIX = 43
PIVOTS = 44
DRIFT = 45
DENSE = 46
SAMPLED = 47
REACHED = 48
LOWEST = 49
SLOPES = 50
WALLS = 51
SIZE = 52

# Mechanisms with several contacts: contacts, 0 where the equations are those of the modes of one;
# held coordinates, contacts whose load is their reaction; entries of mass matrix, slopes of the
# forces along the states and in time; most switches of a law; what the parts of the equations are,
# 1 or 0: a mass matrix that is constant, or diagonal too, loads that are constant, forces that are
# affine, power that anything puts in.
N_CONTACTS = 53
N_HELD = 54
N_REACTIONS = 55
N_MASSES = 56
N_SLOPES = 57
N_TIME_SLOPES = 58
LAW_SWITCHES = 59
CONSTANT_MASS = 60
DIAGONAL = 61
CONSTANT_LOADS = 62
AFFINE = 63
SUPPLIES = 64

# Places in `whole` of tables: row and column of each entry of the mass matrix and of each slope,
# row of each slope in time; of each contact the coordinate along which it slips, its law, its
# bristles among all, whether its load is a reaction, the place in `w` of its law's numbers, that of
# the bristles there, whether its law depends on the direction; whether anything can hold a
# coordinate; then of each coordinate its mode, of each contact its law's flags and whether it is
# open, and room for decisions.
MASS_ROWS = 65
MASS_COLUMNS = 66
SLOPE_ROWS = 67
SLOPE_COLUMNS = 68
TIME_ROWS = 69
SLIPS = 70
KINDS = 71
BRISTLES = 72
REACTS = 73
LAW_ROWS = 74
LAW_BRISTLES = 75
DIRECTIONAL = 76
RIGID = 77
MODES = 78
LAW_FLAGS = 79
OPEN = 80
CANDIDATES = 81
FORCED = 82
BEFORE = 83
CLOSED = 84

# Places in `w`: factors of the contacts' slips; what they, and the reactions, do to held
# coordinates; forces, mass matrix, its factors, accelerations, needed friction, levels forward and
# backward of each coordinate; friction and load of each contact, its friction as constant and
# factor of the load, its levels as the same for both directions, its damping; rates of bristles,
# values of a law; the series of needed friction, slopes of the forces, roots of the guards, bounds
# of the polynomials, rows of the reactions' equations, work taken at each contact.
SLIP_FACTORS = 85
HELD_SLIPS = 86
HELD_NORMALS = 87
FORCE = 88
MASS = 89
CHOLESKY = 90
ACCELERATION = 91
NEEDED = 92
LEVELS = 93
FRICTION = 94
LOAD = 95
FRICTION_CONSTANT = 96
FRICTION_FACTOR = 97
LEVEL_CONSTANT = 98
LEVEL_FACTOR = 99
DAMPING = 100
BRISTLE_RATES = 101
LAW_VALUES = 102
NEEDED_SERIES = 103
SLOPE_VALUES = 104
ROOTS = 105
BOUNDS = 106
REACTION_ROWS = 107
WORKS = 108

# Places in `whole`: number of bristle states of each contact, room for modes.
BRISTLE_COUNTS = 109
KEPT = 110

# Places in `w`: bounds of the drives, rows of events that are new.
BOX = 111
CHANGES = 112

ALWAYS_EXACT = 113
"""Place in `whole` of whether all modes are exact, 1 or 0: rows of steps are short then."""

# Slopes of the parts: number of variables along which they are taken, room of a law's slopes in one
# direction; where the slopes along each variable begin, their rows, the place of each variable that
# is a law's parameter.
N_VARIABLES = 114
LAW_SLOPE_ROOM = 115
PART_STARTS = 116
PART_ROWS = 117
VARIABLE_PLACES = 118

# Places in `w`: a state with its accelerations and the friction of contacts behind it; slopes of
# the parts, of each contact's law forward and backward and of its margins; along one variable,
# those of the parts, of accelerations, needed friction, loads, friction, levels, bristle rates.
MOTION_POINT = 119
PART_SLOPES = 120
LAW_SLOPES = 121
PART_COLUMN = 122
ACCELERATION_SLOPES = 123
NEEDED_SLOPES = 124
LOAD_SLOPES = 125
FRICTION_SLOPES = 126
LEVEL_SLOPES = 127
BRISTLE_SLOPES = 128

N_CHANNELS = 129
"""Efforts of guided coordinates."""
STRUCK = 130
"""Place in `whole` of how each coordinate meets its stop in an impact."""

IS_TURNED = 131
"""Place in `whole` of whether the coordinates are not those of the mechanism, 1 or 0."""
TURN = 132
"""Place in `w` of the matrix that gives them by those of the mechanism, and of its inverse."""
HOLDS = 133
"""Place in `whole` of whether each contact's law may hold it, 1 or 0."""

# Loops of contacts. Directions are the coordinates, then the slips that follow from them and close
# loops; pairs of guards are those of the directions and of the cuts, the motions that break a loop
# open. Whether guards of a pair are left to the cuts, 1 or 0; the coordinate that follows from
# others while a closing slip is held, or -1.
N_DIRECTIONS = 134
N_PAIRS = 135
LOOPED = 136
FOLLOWERS = 137

# Places in `w`: closing slips and cuts by coordinates, and what of closing slips is in each cut;
# what followers follow from; the mass matrix where they do; forces that held contacts of loops have
# to bear; room to share them, and for accelerations.
LOOPS = 138
FOLLOWED = 139
PROJECTED = 140
BORNE = 141
SHARES = 142
REACHED_SO_FAR = 143

ASKED = 145
"""Place in `whole` of the mode in which each contact's law was asked last."""

CONSTANTS = 146
"""Place in `w` of what the equations need of parameters alone; 0 if there is nothing."""

# Contact inputs of laws, which stand behind the loads: how many there are; places in `whole` of the
# index of the first that each contact's law has, and of how many it has.
N_INPUTS = 147
INPUTS = 148
INPUT_COUNTS = 149

# Harmonic terms in time: rows that may have any; place in `w` of the factors of their powers, then
# of the terms, their rates, and the square of their angular frequency.
N_WAVES = 150
WAVES = 151

HEADER = 152
"""Length of state, sizes and places; tables stand behind it, that of the hard stops first:
coordinate and side of each."""

# A recorded step: from, to, length of the dense output, mode, flags, piece; then the dense output,
# of which a series keeps the first state only: it is made again when it is asked for. With several
# contacts, the modes of the coordinates, then flags and openings of the contacts follow.
ROW_DENSE = 6

ROUNDING = 4.5e-16
"""Two units in the last place of 1: times closer than this, relatively, are the same."""

# A recorded event: time, mode before, mode after, guard, flags after, margin, contact.
EVENT_COLUMNS = 7
