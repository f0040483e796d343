"""Layout of a run: places in its two vectors, named whole numbers, and the sizes of a model.

One vector `w` holds all real numbers of a run and one vector `iw` all whole ones: compiled
code passes two arrays and counts no references, and one compilation serves all mechanisms and
laws.

`w` begins with what has one size in all runs. Then come the numbers that the equations read:
value, slope and start of each drive, values given from outside, the parameters; then what has a
size of its own in each model. `iw` begins with the state of a run; then come sizes and places
in `w`, which follow from the sizes of a model (`Sizes.header`), and tables.

Docstrings of kernels list the slots that a function reads and writes, with all that it calls. It
reads what must be there when it begins; what it writes and does not read is its result, or
scratch that nothing may rely on. `drives` are the places before GIVEN. What the equations read
whenever they are asked, drives, parameters and where they are themselves, is not listed, nor are
sizes and places, nor what becomes of the slots of several contacts where these are called by
their address. A name in back quotes is an argument that gives a place.
"""

import functools
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate

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
SPARE = 18
"""Acceleration that is rounding, of what begins to slip from rest in a step; 0 if nothing does."""

# A guard as a polynomial, its intervals.
POLYNOMIAL = 19
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

# Places in `iw` of tables: row and column of each entry of the mass matrix and of each slope,
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

# Places in `iw`: number of bristle states of each contact, room for modes.
BRISTLE_COUNTS = 109
KEPT = 110

# Places in `w`: bounds of the drives, rows of events that are new.
BOX = 111
CHANGES = 112

ALWAYS_EXACT = 113
"""Place in `iw` of whether all modes are exact, 1 or 0: rows of steps are short then."""

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
"""Place in `iw` of how each coordinate meets its stop in an impact."""

IS_TURNED = 131
"""Place in `iw` of whether the coordinates are not those of the mechanism, 1 or 0."""
TURN = 132
"""Place in `w` of the matrix that gives them by those of the mechanism, and of its inverse."""
HOLDS = 133
"""Place in `iw` of whether each contact's law may hold it, 1 or 0."""

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
"""Place in `iw` of the mode in which each contact's law was asked last."""

CONSTANTS = 146
"""Place in `w` of what the equations need of parameters alone; 0 if there is nothing."""

# Contact inputs of laws, which stand behind the loads: how many there are; places in `iw` of the
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


# Sizes of a model, and the whole numbers of a run that follow from them.

LAW_NUMBERS = 7
"""Numbers that a law writes before the rates of its bristles."""
WALL_NUMBERS = 2
"""Numbers of a hard stop where several contacts rub: position, restitution."""


@dataclass(frozen=True, kw_only=True)
class Sizes(ABC):
    """How much of everything a model has, and what it can do."""

    coordinates: int
    """Moving coordinates."""
    bristles: int
    """Bristle states."""
    switches: int
    """Conditions of the equations."""
    drives: int
    """Drives."""
    parameters: int
    """Parameters of the mechanism, and of the law where the equations are those of modes."""
    constants: int
    """Numbers that the equations need of parameters alone."""
    rest_is_final: bool
    """Whether only drives can move what is held."""
    waves: int
    """Rows that may have harmonic terms in time where modes are exact: rates and guards of one
    contact, forces where several rub; 0 if none has any."""

    @property
    def states(self) -> int:
        """Coordinates, rates, bristles."""
        return 2 * self.coordinates + self.bristles

    @property
    @abstractmethod
    def guards(self) -> int:
        """Guards of a mode."""

    @property
    @abstractmethod
    def columns(self) -> int:
        """Columns that a recorded run has beside its states."""

    @property
    def first_parameter(self) -> int:
        """Place of the first parameter in the vector of a run."""
        return NUMBERS + 4 * self.drives + 1

    @property
    def header(self) -> tuple[int, ...]:
        """The whole numbers of a run that begins: its state, 0, then sizes, places and tables."""
        return _header(self)

    @abstractmethod
    def lengths(self) -> dict[str, int]:
        """Return how many numbers the functions of the equations write, by their names."""

    @abstractmethod
    def _own(self) -> dict[int, int]:
        """Return the sizes that kinds of models have in their own way, by slot."""

    @abstractmethod
    def _tables(self) -> Iterator[tuple[int | None, tuple[int, ...]]]:
        """Yield the slot of each table, and the table."""

    def _rooms(self) -> dict[int, int]:
        """Return the room of each slot in the vector of a run, in their order."""
        n, guards = self.states, self.guards
        return {
            CONSTANTS: self.constants,
            Y: n,
            Y1: n,
            SCALE: n,
            END: n,
            POINT: n,
            VALUES: n + guards + self.columns + 8,
            PULLS: self.coordinates,  # before the stages: set back for each run
            STAGES: DOP853_STAGES * n,
            MATRIX: n * n,
            PIVOTS: n,
            DRIFT: n,
            DENSE: 1 + (SERIES + 1) * n,
            SAMPLED: (SAMPLES + 1) * guards,
            REACHED: guards,
            LOWEST: guards,
            SLOPES: guards * (n + 1),
            WAVES: SERIES + 2 + 2 * self.waves,
        }


@functools.lru_cache(maxsize=256)
def _header(sizes: Sizes) -> tuple[int, ...]:
    """Return the whole numbers of a run that begins."""
    n = sizes.states
    iw = [0] * HEADER
    iw[N_STATES] = n
    iw[N_COORDINATES] = sizes.coordinates
    iw[N_GUARDS] = sizes.guards
    iw[N_SWITCHES] = sizes.switches
    iw[N_COLUMNS] = sizes.columns
    iw[N_DRIVES] = sizes.drives
    iw[HAS_BRISTLES] = int(sizes.bristles > 0)
    iw[REST_IS_FINAL] = int(sizes.rest_is_final)
    iw[N_WAVES] = sizes.waves
    iw[DENSE_SIZE] = 1 + (SERIES + 1) * n
    iw[ROW_COLUMNS] = ROW_DENSE + 1 + (TERMS + 1) * n
    iw[WALL_COLUMNS] = 3 + sizes.coordinates
    iw[GIVEN] = NUMBERS + 3 * sizes.drives
    for slot, size in sizes._own().items():
        iw[slot] = size
    place = sizes.first_parameter + sizes.parameters
    for slot, room in sizes._rooms().items():
        iw[slot] = place
        place += room
    if not sizes.constants:
        iw[CONSTANTS] = 0
    iw[SIZE] = place
    for table, numbers in sizes._tables():
        if table is not None:
            iw[table] = len(iw)
        iw += numbers
    return tuple(iw)


@dataclass(frozen=True, kw_only=True)
class ModeSizes(Sizes):
    """Of a model whose equations are those of the modes of one contact."""

    slip: int
    """Index of the slip velocity among the states."""
    limits: int
    """Conditions that end a run."""
    channels: int
    """Efforts of guided coordinates."""
    walls: tuple[tuple[int, int], ...]
    """Index of the coordinate and side, 1 above and -1 below, of each hard stop."""
    can_stick: bool
    """Whether the contact can be held."""
    can_lift: bool
    """Whether the normal force can change."""

    @property
    def guards(self) -> int:
        """Guards of a mode."""
        return SWITCH + self.switches + self.limits + len(self.walls)

    @property
    def columns(self) -> int:
        """Friction, normal force, efforts."""
        return 2 + self.channels

    def lengths(self) -> dict[str, int]:
        """Return how many numbers the functions of the equations write, by their names."""
        n, guards = self.states, self.guards
        quantities = 3 * self.drives + self.parameters
        return {
            "field": n,
            "jacobian": n * n,
            "time_slope": n,
            "guards": guards,
            "guard_slopes": guards * (n + 1),
            "linear": 1,
            "contact": 4 + self.channels,
            "power": 2,
            "energy": 1,
            "margins": self.switches,
            "diagram": self.coordinates + 3,
            "rest": 3,
            "walls": len(self.walls) * (3 + self.coordinates),
            "constants": self.constants,
            "waves": 2 * self.waves + int(self.waves > 0),
            "field_slopes": n * quantities,
            "guard_parameters": guards * quantities,
            "impact": self.coordinates,
            "impact_slopes": self.coordinates * n,
            "impact_parameters": self.coordinates * quantities,
        }

    def _own(self) -> dict[int, int]:
        return {
            N_LIMITS: self.limits,
            N_WALLS: len(self.walls),
            N_CHANNELS: self.channels,
            SLIP: self.slip,
            CAN_STICK: int(self.can_stick),
            CAN_LIFT: int(self.can_lift),
            FIRST_LIMIT: SWITCH + self.switches,
            FIRST_WALL: SWITCH + self.switches + self.limits,
            MOST_EVENTS: 4 + self.switches * self.switches,
        }

    def _rooms(self) -> dict[int, int]:
        return {**super()._rooms(), WALLS: len(self.walls) * (3 + self.coordinates)}

    def _tables(self) -> Iterator[tuple[int | None, tuple[int, ...]]]:
        yield None, tuple(number for wall in self.walls for number in wall)


def law_rows(
    first: int, numbers: Sequence[int], inputs_of: Sequence[int], bristles_of: Sequence[int]
) -> tuple[int, ...]:
    """Return where the row of each law begins, and where the last one ends.

    A row has a speed, parameters, contact inputs, bristles and a load.
    """
    beside = 2 + max(inputs_of, default=0) + max(bristles_of, default=0)
    return tuple(accumulate((number + beside for number in numbers), initial=first))


@dataclass(frozen=True, kw_only=True)
class ContactSizes(Sizes):
    """Of a model whose equations are parts, at which any number of contacts rub."""

    slips: tuple[int, ...]
    """Index of the direction along which each contact slips: a coordinate, or a closing slip."""
    looped: frozenset[int]
    """Indices of the coordinates that have a part in a loop of contacts."""
    closing: int
    """Slips that close loops."""
    cuts: int
    """Motions that break loops open."""
    turned: bool
    """Whether the coordinates are not those of the mechanism."""
    kinds: tuple[int, ...]
    """Index of each contact's law among those of different structure."""
    shared: tuple[int, ...]
    """Index of the numbers that each contact's law has: contacts may share a law."""
    numbers: tuple[int, ...]
    """How many parameters each of these has."""
    inputs_of: tuple[int, ...]
    """How many contact inputs each contact's law has."""
    bristles_of: tuple[int, ...]
    """How many bristle states each contact has."""
    holds: tuple[bool, ...]
    """Whether each contact's law holds it: it is set-valued, or has a rule for rest."""
    directional: tuple[bool, ...]
    """Whether each contact's law depends on the direction."""
    reacts: tuple[bool, ...]
    """Whether each contact's load is a reaction."""
    held: int
    """Held coordinates."""
    channels: int
    """Efforts of guided coordinates."""
    own_limits: int
    """Conditions of the mechanism that end a run."""
    walls: tuple[tuple[int, int], ...]
    """Index of the coordinate and side, 1 above and -1 below, of each hard stop."""
    mass: tuple[tuple[int, int], ...]
    """Row and column of each entry of the mass matrix."""
    slopes: tuple[tuple[int, int], ...]
    """Row and column of each slope of the forces along the states."""
    time_slopes: tuple[int, ...]
    """Row of each slope of the forces in time."""
    law_switches: int
    """Most conditions of a law."""
    constant_mass: bool
    """Whether the mass matrix is constant."""
    constant_loads: bool
    """Whether all loads are constant."""
    affine: bool
    """Whether the forces are affine in states and time, at any flags, and loads constant."""
    exact: bool
    """Whether all modes are, whatever the flags are, and never stiff: rows keep one state only."""
    supplies: bool
    """Whether anything puts power in."""
    part_slopes: tuple[tuple[int, ...], ...]
    """Rows of the parts that change with each variable: states, time, then, if there are slopes
    with respect to them, numbers of drives and parameters."""

    @property
    def directions(self) -> int:
        """Coordinates, then slips that follow from them."""
        return self.coordinates + self.closing

    @property
    def pairs(self) -> int:
        """Directions, then cuts: each has two guards."""
        return self.directions + self.cuts

    @property
    def _loop_numbers(self) -> int:
        """Closing slips and cuts by coordinates, and what of the former is in the latter."""
        return (self.closing + self.cuts) * self.coordinates + self.cuts * self.closing

    @property
    def contacts(self) -> int:
        """Contacts."""
        return len(self.slips)

    @property
    def guards(self) -> int:
        """Two of each pair, switches and opening of each contact, switches, limits, stops."""
        own = 2 * self.pairs + self.contacts * (self.law_switches + 1)
        return own + self.switches + self.limits + len(self.walls)

    @property
    def limits(self) -> int:
        """Conditions that end a run: the pivot of reactions that depend on friction, then own."""
        return int(any(self.reacts)) + self.own_limits

    @property
    def columns(self) -> int:
        """Friction, load and mode of each contact, efforts."""
        return 3 * self.contacts + self.channels

    def lengths(self) -> dict[str, int]:
        """Return how many numbers the functions of the equations write, by their names."""
        own = {
            "constants": self.constants,
            "energy": 1,
            "power": 1,
            "margins": self.switches,
            "margin_slopes": self.switches * (self.states + 1),
            "rest": self.coordinates,
            "forces": self.coordinates + self.held,
            "masses": len(self.mass),
            "loads": self.contacts + sum(self.inputs_of),
            "geometry": self.contacts * (1 + 2 * self.held),
            "force_slopes": len(self.slopes) + len(self.time_slopes),
            "waves": 2 * self.waves + int(self.waves > 0),
            "part_slopes": sum(map(len, self.part_slopes)),
        }
        some = {
            "turning": 2 * self.coordinates**2 * self.turned,
            "loops": self._loop_numbers,
            "efforts": self.channels,
            "limits": self.own_limits,
            "walls": WALL_NUMBERS * len(self.walls),
        }
        own |= {name: length for name, length in some.items() if length}
        for kind in set(self.kinds):
            own[f"law_{kind}"] = LAW_NUMBERS + self._most_bristles
            own[f"law_margins_{kind}"] = self.law_switches
            own[f"law_slopes_{kind}"] = self._law_slopes
            own[f"law_margin_slopes_{kind}"] = self.law_switches * self._most_variables
        return own

    @property
    def _most_variables(self) -> int:
        """Speed, parameters, contact inputs, bristles and load of a law."""
        numbers = [max(self.numbers, default=0)]
        return law_rows(0, numbers, self.inputs_of, self.bristles_of)[-1]

    @property
    def _law_slopes(self) -> int:
        """Slopes of a law in one direction, or of its margins."""
        return max(4 + self._most_bristles, self.law_switches) * self._most_variables

    @property
    def _part_rows(self) -> int:
        """Rows of the parts that have slopes."""
        rows = self.coordinates + self.held + self.contacts * (2 + 2 * self.held)
        return rows + self.switches + WALL_NUMBERS * len(self.walls) + sum(self.inputs_of)

    def law_places(self) -> tuple[int, ...]:
        """Return the place in the vector of a run of the numbers of each law."""
        return self._law_rows[:-1]

    @property
    def _law_rows(self) -> tuple[int, ...]:
        first = self.first_parameter + self.parameters
        return law_rows(first, self.numbers, self.inputs_of, self.bristles_of)

    @property
    def _most_bristles(self) -> int:
        return max(self.bristles_of, default=0)

    def _own(self) -> dict[int, int]:
        diagonal = self.constant_mass and all(
            row == column for row, column in self.mass if row < self.coordinates
        )
        diagonal = diagonal and self.closing == 0
        first_wall = self.guards - len(self.walls)
        return {
            N_LIMITS: self.limits,
            N_WALLS: len(self.walls),
            N_CHANNELS: self.channels,
            IS_TURNED: int(self.turned),
            WALL_COLUMNS: WALL_NUMBERS,
            FIRST_LIMIT: first_wall - self.limits,
            FIRST_WALL: first_wall,
            MOST_EVENTS: 2 * self._most_changes,  # of a step that ends where drives jump
            ROW_COLUMNS: ROW_DENSE
            + 1
            + (1 if self.exact else TERMS + 1) * self.states
            + self.pairs
            + 2 * self.contacts,
            N_DIRECTIONS: self.directions,
            N_PAIRS: self.pairs,
            N_CONTACTS: self.contacts,
            N_HELD: self.held,
            N_REACTIONS: sum(self.reacts),
            N_INPUTS: sum(self.inputs_of),
            N_MASSES: len(self.mass),
            N_SLOPES: len(self.slopes),
            N_TIME_SLOPES: len(self.time_slopes),
            LAW_SWITCHES: self.law_switches,
            CONSTANT_MASS: int(self.constant_mass),
            DIAGONAL: int(diagonal),
            CONSTANT_LOADS: int(self.constant_loads),
            AFFINE: int(self.affine),
            ALWAYS_EXACT: int(self.exact),
            SUPPLIES: int(self.supplies),
            N_VARIABLES: len(self.part_slopes),
            LAW_SLOPE_ROOM: self._law_slopes,
        }

    def _rooms(self) -> dict[int, int]:
        n, c, reacting = self.coordinates, self.contacts, sum(self.reacts)
        rows, pairs = n + self.held, self.pairs
        widest = max(self.states, pairs)
        return {
            LAW_ROWS: self._law_rows[-1] - self._law_rows[0],  # its table has their places
            **super()._rooms(),
            POINT: widest,
            DRIFT: widest,
            SLIP_FACTORS: c,
            HELD_SLIPS: c * self.held,
            HELD_NORMALS: c * self.held,
            FORCE: rows,
            MASS: rows * n,
            CHOLESKY: n * n,
            ACCELERATION: n,
            NEEDED: pairs,
            LEVELS: 2 * pairs,
            FRICTION: c,
            LOAD: c + sum(self.inputs_of),
            FRICTION_CONSTANT: c,
            FRICTION_FACTOR: c,
            LEVEL_CONSTANT: 2 * c,
            LEVEL_FACTOR: 2 * c,
            DAMPING: c,
            BRISTLE_RATES: self.bristles,
            LAW_VALUES: 1
            + LAW_NUMBERS
            + len(self.mass)
            + self.switches
            + self.law_switches
            + 4 * self._most_bristles,
            NEEDED_SERIES: (SERIES + 2) * pairs,
            SLOPE_VALUES: len(self.slopes) + len(self.time_slopes) + 1,
            ROOTS: 2 * pairs,
            BOUNDS: 2 * pairs,
            REACTION_ROWS: (reacting + 2) * (self.held + reacting + 2),
            WORKS: c,
            BOX: 2 * self.drives,
            CHANGES: self._most_changes * EVENT_COLUMNS,
            WALLS: WALL_NUMBERS * len(self.walls),
            MOTION_POINT: self.states + n + c,
            TURN: 2 * n * n * self.turned,
            **(self._slope_rooms() if self.part_slopes else {}),
            **(self._loop_rooms() if self.closing else {}),
        }

    def _loop_rooms(self) -> dict[int, int]:
        n = self.coordinates
        return {
            LOOPS: self._loop_numbers,
            FOLLOWED: self.closing * n,
            PROJECTED: n * n,
            BORNE: n,
            SHARES: n * (n + 2) + 2 * self.directions,
            REACHED_SO_FAR: n,
        }

    @property
    def _most_changes(self) -> int:
        """Most events of an instant: of each contact, stop, switch, and what ends the run."""
        return self.contacts + len(self.walls) + self.switches * self.switches + 4

    def _slope_rooms(self) -> dict[int, int]:
        n, c = self.coordinates, self.contacts
        return {
            PART_SLOPES: sum(map(len, self.part_slopes)),
            LAW_SLOPES: 3 * c * self._law_slopes,
            PART_COLUMN: self._part_rows,
            ACCELERATION_SLOPES: n,
            NEEDED_SLOPES: self.pairs,
            LOAD_SLOPES: c,
            FRICTION_SLOPES: c,
            LEVEL_SLOPES: 2 * self.pairs,
            BRISTLE_SLOPES: self.bristles,
        }

    def _tables(self) -> Iterator[tuple[int | None, tuple[int, ...]]]:
        n, c = self.directions, self.contacts
        places = self.law_places()
        first, bristles = 0, []
        for count in self.bristles_of:
            bristles.append(first if count else -1)
            first += count
        rigid = [0] * n + [1] * self.cuts
        for slip, holds in zip(self.slips, self.holds, strict=True):
            rigid[slip] |= int(holds)
        yield None, tuple(number for wall in self.walls for number in wall)
        yield MASS_ROWS, tuple(row for row, _ in self.mass)
        yield MASS_COLUMNS, tuple(column for _, column in self.mass)
        yield SLOPE_ROWS, tuple(row for row, _ in self.slopes)
        yield SLOPE_COLUMNS, tuple(column for _, column in self.slopes)
        yield TIME_ROWS, self.time_slopes
        yield SLIPS, self.slips
        yield KINDS, self.kinds
        yield BRISTLES, tuple(bristles)
        yield BRISTLE_COUNTS, self.bristles_of
        yield REACTS, tuple(map(int, self.reacts))
        yield LAW_ROWS, tuple(places[index] for index in self.shared)
        counts = zip(self.shared, self.inputs_of, strict=True)
        yield LAW_BRISTLES, tuple(1 + self.numbers[index] + own for index, own in counts)
        yield INPUTS, tuple(accumulate(self.inputs_of, initial=0))[:-1]
        yield INPUT_COUNTS, self.inputs_of
        yield DIRECTIONAL, tuple(map(int, self.directional))
        yield HOLDS, tuple(map(int, self.holds))
        yield RIGID, tuple(rigid)
        closing = range(self.coordinates, n)
        yield LOOPED, tuple(int(i in self.looped or i in closing) for i in range(self.pairs))
        yield FOLLOWERS, (-1,) * self.closing
        yield MODES, (0,) * self.pairs
        yield LAW_FLAGS, (0,) * c
        yield OPEN, (0,) * c
        yield CANDIDATES, (0,) * n
        yield FORCED, (0,) * n
        yield BEFORE, (0,) * n
        yield KEPT, (0,) * n
        yield STRUCK, (0,) * n
        yield CLOSED, (0,) * c
        yield ASKED, (0,) * c
        ends = accumulate(map(len, self.part_slopes), initial=0)
        yield PART_STARTS, tuple(ends)
        yield PART_ROWS, tuple(row for rows in self.part_slopes for row in rows)
        yield VARIABLE_PLACES, self._law_variables()

    def _law_variables(self) -> tuple[int, ...]:
        """Return the place of each variable that is a law's parameter, 0 for all others."""
        before = self.states + 1 + 3 * self.drives + self.parameters
        if len(self.part_slopes) <= before:
            return (0,) * len(self.part_slopes)
        own = zip(self.law_places(), self.numbers, strict=True)
        places = tuple(row + 1 + i for row, number in own for i in range(number))
        return (*(0,) * before, *places)
