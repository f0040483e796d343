"""The equations of a run: generated functions asked by number, coordinates, drives.

Steppers ask for rates, Jacobians and guards of "the mechanism with its friction in its present
mode". What answers is a generated function of that mode where one contact rubs, and the kernels of
`contacts`, which assemble the equations of the coordinates that move, where several do. Both are
called by their place in the vector of the run, so that one text of kernels serves all models.

Where slips of contacts are sums of coordinates, q' = T q are the coordinates of the equations and
q those of the mechanism. Drives are constant, linear or harmonic in pieces; each piece ends at a
time that is known ahead.
"""

import math

from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector, call_contacts, call_model, rare

# Generated functions of a model, asked by number.
#
# The vector of a run names them at ADDRESS. All read that vector: the numbers of drives and
# parameters, and what stands from the place `at` on. They write to the place `to` and after it.
#
# Where one contact rubs, they are the equations of each mode. Where several do, they are parts of
# the equations, which no mode enters: forces, mass matrix, loads, and each law once per structure.

ANY_RATE = 0.7309
"""A rate [m/s or rad/s] that no threshold is likely to have: it tells what depends on rates."""
FIELD = 0
JACOBIAN = 1
TIME_SLOPE = 2
GUARDS = 3
GUARD_SLOPES = 4
LINEAR = 5
CONTACT = 6
POWER = 7
MARGINS = 8
REST = 9
ENERGY = 10
FIELD_SLOPES = 11
GUARD_PARAMETERS = 12
WALLS_OF = 13
FORCES = 14
MASSES = 15
LOADS = 16
GEOMETRY = 17
FORCE_SLOPES = 18
PART_SLOPES_OF = 19
EFFORTS = 20
LIMITS = 21
TURNING = 22
LOOPS_OF = 23
CONSTANTS_OF = 24
IMPACT = 25
IMPACT_SLOPES = 26
IMPACT_PARAMETERS = 27
WAVES_OF = 28
MARGIN_SLOPES_OF = 29
CALLED: tuple[str, ...] = (
    "field",
    "jacobian",
    "time_slope",
    "guards",
    "guard_slopes",
    "linear",
    "contact",
    "power",
    "margins",
    "rest",
    "energy",
    "field_slopes",
    "guard_parameters",
    "walls",
    "forces",
    "masses",
    "loads",
    "geometry",
    "force_slopes",
    "part_slopes",
    "efforts",
    "limits",
    "turning",
    "loops",
    "constants",
    "impact",
    "impact_slopes",
    "impact_parameters",
    "waves",
    "margin_slopes",
)
"""Names of the generated functions by these numbers."""
LAW = 1000
"""Law k of a model with several contacts has this number and k."""
LAW_MARGINS = 1_000_000
"""The margins of its switches have this number and k."""
LAW_SLOPES_OF = 2_000_000
"""Its slopes have this number and k."""
LAW_MARGIN_SLOPES = 3_000_000
"""The slopes of the margins have this number and k."""


def evaluate(name: int, mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Call one function of the equations in any mode."""
    call_model(w, layout.ADDRESS, name, mode, flags, t, at, to)


def put_constants(w: Vector, iw: IntVector) -> None:
    """Write what the equations need of parameters alone, where there is such a thing."""
    if iw[layout.CONSTANTS] > 0:
        evaluate(CONSTANTS_OF, 0, 0, 0.0, w, 0, iw[layout.CONSTANTS])


# What is asked of a mechanism with several contacts, by number: see `contacts.transitions`.

BEGIN = 0
RATES = 1
GUARDS_OF = 2
COLUMNS = 3
POWERS = 4
IS_LINEAR = 5
FIRST_SIZES = 6
MOTION = 7
BOOK = 8
STAYS = 9
SETTLE = 10
CHANGE = 11
SERIES_FROM = 12
SERIES_STEP = 13
CROSSING = 14
RESTORE = 15
PREPARE = 16
STATE_SLOPES = 17
TIME_SLOPES = 18
QUANTITY_SLOPES = 19
GUARD_STATES = 20
GUARD_QUANTITIES = 21
IMPACT_STATES = 22
IMPACT_QUANTITIES = 23


def ask_of(name: int, t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Ask at a state, for numbers."""
    call_contacts(w, layout.SEVERAL, iw, name, t, at, to)


def ask(name: int, t: float, w: Vector, iw: IntVector) -> int:
    """Ask at the present state; return the answer, a whole number."""
    call_contacts(w, layout.SEVERAL, iw, name, t, iw[layout.Y], 0)
    return iw[layout.ANSWER]


def ask_here(name: int, w: Vector, iw: IntVector) -> int:
    """Ask at the present time and state; return the answer, a whole number."""
    return ask(name, w[layout.TIME], w, iw)


# The coordinates of the mechanism and those of its equations, which differ where slips are sums.
#
# One matrix, constant in a run, gives those of the equations, and its inverse those of the
# mechanism; rates follow alike, and so do sensitivities.


def turn_columns(at: int, m: int, back: int, w: Vector, iw: IntVector) -> None:
    """Turn `m` columns of states in place, row by row; bristles stay as they are."""
    n, values = iw[layout.N_COORDINATES], iw[layout.VALUES]
    if not iw[layout.IS_TURNED]:
        return
    matrix = iw[layout.TURN] + back * n * n
    for block in range(2):
        for c in range(m):
            place = at + block * n * m + c
            for i in range(n):
                total = 0.0
                for j in range(n):
                    total += w[matrix + i * n + j] * w[place + j * m]
                w[values + i] = total
            for i in range(n):
                w[place + i * m] = w[values + i]


def turn_states(at: int, back: int, w: Vector, iw: IntVector) -> None:
    """Turn one state in place, as `turn_columns` does."""
    turn_columns(at, 1, back, w, iw)


def state_seen(at: int, state: int, w: Vector, iw: IntVector) -> float:
    """Return one of the states of the mechanism."""
    n = iw[layout.N_COORDINATES]
    if not iw[layout.IS_TURNED] or state >= 2 * n:
        return w[at + state]
    block, row = divmod(state, n)
    total = 0.0
    for j in range(n):
        total += w[iw[layout.TURN] + n * n + row * n + j] * w[at + block * n + j]
    return total


# Directions of several contacts: coordinates, slips that follow from them, cuts of loops.
#
# A slip that is a constant combination of coordinates along which others slip closes a loop. It has
# an index behind those of the coordinates, as if it were one, and so has each cut, a motion in
# which the loop breaks open. The force along a cut is what forces would do in that motion.
#
# While a closing slip is held and its parts are not, one of them follows from the others.

ROUNDED = 1e-15
"""Share of the sizes of its parts below which a closing slip is at rest."""


def factor_of(i: int, j: int, w: Vector, iw: IntVector) -> float:
    """Return the factor of a coordinate in a direction or a cut."""
    n = iw[layout.N_COORDINATES]
    if i < n:
        return 1.0 if i == j else 0.0
    return w[iw[layout.LOOPS] + (i - n) * n + j]


def combined(i: int, at: int, w: Vector, iw: IntVector) -> float:
    """Return what a vector of the coordinates is along a direction or a cut."""
    if i < iw[layout.N_COORDINATES]:
        return w[at + i]
    return summed(i, at, w, iw)


@rare
def summed(i: int, at: int, w: Vector, iw: IntVector) -> float:
    """Return what a vector of the coordinates is along a closing slip or a cut."""
    n, total = iw[layout.N_COORDINATES], 0.0
    row = iw[layout.LOOPS] + (i - n) * n
    for j in range(n):
        total += w[row + j] * w[at + j]
    return total


def size_along(i: int, at: int, w: Vector, iw: IntVector) -> float:
    """Return how large the parts are of what a vector is along a direction or a cut."""
    if i < iw[layout.N_COORDINATES]:
        return abs(w[at + i])
    return size_of_sum(i, at, w, iw)


@rare
def size_of_sum(i: int, at: int, w: Vector, iw: IntVector) -> float:
    """Return how large the parts are of what a vector is along a closing slip or a cut."""
    n, total = iw[layout.N_COORDINATES], 0.0
    row = iw[layout.LOOPS] + (i - n) * n
    for j in range(n):
        total += abs(w[row + j] * w[at + j])
    return total


def slip_rate_along(i: int, at: int, w: Vector, iw: IntVector) -> float:
    """Return the rate along a direction; what is left of a sum by rounding is 0."""
    n = iw[layout.N_COORDINATES]
    if i < n:
        return w[at + n + i]
    return closing_rate(i, at + n, w, iw)


@rare
def closing_rate(i: int, rates: int, w: Vector, iw: IntVector) -> float:
    """Return the rate along a closing slip, 0 where it is rounding."""
    rate = summed(i, rates, w, iw)
    return 0.0 if abs(rate) <= ROUNDED * size_of_sum(i, rates, w, iw) else rate


def spread(i: int, force: float, to: int, w: Vector, iw: IntVector) -> None:
    """Take a force along a direction away from those along the coordinates."""
    if i < iw[layout.N_COORDINATES]:
        w[to + i] -= force
    else:
        spread_out(i, force, to, w, iw)


@rare
def spread_out(i: int, force: float, to: int, w: Vector, iw: IntVector) -> None:
    """Take a force along a closing slip away from those along the coordinates."""
    n = iw[layout.N_COORDINATES]
    row = iw[layout.LOOPS] + (i - n) * n
    for j in range(n):
        w[to + j] -= w[row + j] * force


@rare
def bind(to: int, stride: int, w: Vector, iw: IntVector) -> None:
    """Let coordinates follow from others where a closing slip is held."""
    n = iw[layout.N_COORDINATES]
    for d in range(iw[layout.N_DIRECTIONS] - n):
        follower, row = iw[iw[layout.FOLLOWERS] + d], iw[layout.FOLLOWED] + d * n
        if follower >= 0:
            total = 0.0
            for j in range(n):
                if j != follower:
                    total -= w[row + j] * w[to + j * stride]
            w[to + follower * stride] = total


# The pieces of the drives: which one holds, when the next begins, whether any still moves.


def load_piece(table: Vector, row: int, w: Vector, iw: IntVector) -> None:
    """Put one row of the drives' table where the equations read it."""
    n_drives = iw[layout.N_DRIVES]
    width = 1 + 3 * n_drives
    for i in range(3 * n_drives):
        w[layout.NUMBERS + i] = table[row * width + 1 + i]


def next_stop(table: Vector, t_end: float, iw: IntVector) -> float:
    """Return the start of the next piece of the drives, or the end."""
    width = 1 + 3 * iw[layout.N_DRIVES]
    following = (iw[layout.PIECE] + 1) * width
    return min(table[following], t_end) if following < len(table) else t_end


def enter_pieces(table: Vector, w: Vector, iw: IntVector) -> None:
    """Load the piece of the drives that holds now."""
    width = 1 + 3 * iw[layout.N_DRIVES]
    while (iw[layout.PIECE] + 1) * width < len(table) and (
        table[(iw[layout.PIECE] + 1) * width] <= w[layout.TIME]
    ):
        iw[layout.PIECE] += 1
    load_piece(table, iw[layout.PIECE], w, iw)


def rests_for_good(w: Vector, iw: IntVector, bounds: Vector) -> bool:
    """Whether no drive can move the held body any more, nor pull it off its stop.

    `bounds` has least and largest value of each drive from the start of each piece on.
    """
    n_drives = iw[layout.N_DRIVES]
    given = iw[layout.GIVEN]
    y = iw[layout.Y]
    values = iw[layout.VALUES]
    if iw[layout.N_CONTACTS] > 0:
        for k in range(2 * iw[layout.N_DRIVES]):
            w[iw[layout.BOX] + k] = bounds[iw[layout.PIECE] * iw[layout.N_DRIVES] * 2 + k]
        return ask_here(STAYS, w, iw) == 1
    if not iw[layout.REST_IS_FINAL] or abs(iw[layout.MODE]) == 1:
        return False
    side = 0.5 * iw[layout.MODE]
    for corner in range(1 << n_drives):
        for k in range(n_drives):
            at = (iw[layout.PIECE] * n_drives + k) * 2 + ((corner >> k) & 1)
            w[given + k] = bounds[at]
            if not abs(bounds[at]) < math.inf:
                return False
        evaluate(REST, 0, iw[layout.FLAGS], w[layout.TIME], w, y, values)
        pull = abs(w[values]) if side == 0.0 else -side * w[values]
        if pull > w[values + 1] or w[values + 2] < 0.0:
            return False
    return True


# The equations of a mechanism with its friction, in the modes and with the flags of the run.


def put(one: int, several: int, t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write what equations of one contact, or of several, give for the mode of the run."""
    if iw[layout.N_CONTACTS] > 0:
        ask_of(several, t, w, iw, at, to)
    else:
        evaluate(one, iw[layout.MODE], iw[layout.FLAGS], t, w, at, to)


def field(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Time derivatives of the states."""
    put(FIELD, RATES, t, w, iw, at, to)


def jacobian(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Derivatives of the field with respect to the states, row by row."""
    put(JACOBIAN, STATE_SLOPES, t, w, iw, at, to)


def time_slope(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Derivatives of the field with respect to time."""
    put(TIME_SLOPE, TIME_SLOPES, t, w, iw, at, to)


def guards(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Quantities that are not negative while the mode lasts, by the indices of `enums`."""
    put(GUARDS, GUARDS_OF, t, w, iw, at, to)


def guard_slopes(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Derivatives of each guard with respect to the states and then to time."""
    put(GUARD_SLOPES, GUARD_STATES, t, w, iw, at, to)


def linear(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Whether field and guards are affine in state and time together: 1 or 0."""
    if iw[layout.N_CONTACTS] > 0:
        w[to] = ask_here(IS_LINEAR, w, iw)
    else:
        evaluate(LINEAR, iw[layout.MODE], iw[layout.FLAGS], t, w, at, to)


def recorded(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write what a run records beside its states.

    That is friction, normal force and the efforts of guided coordinates; of several contacts
    friction, then load, then mode of each.
    """
    if iw[layout.N_CONTACTS] > 0:
        ask_of(COLUMNS, t, w, iw, at, to)
        return
    evaluate(CONTACT, iw[layout.MODE], iw[layout.FLAGS], t, w, at, to)
    for k in range(2, iw[layout.N_COLUMNS]):  # needed friction and level stand between
        w[to + k] = w[to + k + 2]


def power(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Power supplied, power taken by friction."""
    put(POWER, POWERS, t, w, iw, at, to)


def energy(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Mechanical energy; the same in all modes."""
    evaluate(ENERGY, iw[layout.MODE], iw[layout.FLAGS], t, w, at, to)


def field_slopes(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Derivatives of the field with respect to all quantities: drives' numbers, parameters."""
    put(FIELD_SLOPES, QUANTITY_SLOPES, t, w, iw, at, to)


def guard_parameters(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Derivatives of each guard with respect to all quantities."""
    put(GUARD_PARAMETERS, GUARD_QUANTITIES, t, w, iw, at, to)


def impact_slopes(case: int, t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Derivatives of the rates after an impact with respect to the states before it.

    Of several contacts, STRUCK and BOUNDS tell which coordinates are stopped, and what the rates
    change by.
    """
    if iw[layout.N_CONTACTS] > 0:
        ask_of(IMPACT_STATES, t, w, iw, at, to)
    else:
        evaluate(IMPACT_SLOPES, case, iw[layout.FLAGS], t, w, at, to)


def impact_parameters(case: int, t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Derivatives of the rates after an impact with respect to all quantities."""
    if iw[layout.N_CONTACTS] > 0:
        ask_of(IMPACT_QUANTITIES, t, w, iw, at, to)
    else:
        evaluate(IMPACT_PARAMETERS, case, iw[layout.FLAGS], t, w, at, to)
