"""Answers of a mechanism with several contacts to the questions of the other kernels."""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.contacts.assembly import prepare, refactor
from stickslip.kernels.contacts.guards import contact_guards, contacts_are_linear
from stickslip.kernels.contacts.motion import (
    book_contacts,
    contact_columns,
    contact_power,
    contact_rates,
    contacts_rest,
    first_contact_sizes,
    note_motion,
)
from stickslip.kernels.contacts.series import (
    contact_series,
    contact_series_step,
    first_contact_crossing,
)
from stickslip.kernels.contacts.slopes import (
    guard_slopes_along,
    impact_slopes_along,
    rate_slopes_along,
)
from stickslip.kernels.contacts.transitions import begin_contacts, change_contacts, settle_contacts
from stickslip.kernels.questions import (
    BEGIN,
    BOOK,
    CHANGE,
    COLUMNS,
    CROSSING,
    FIRST_SIZES,
    GUARD_QUANTITIES,
    GUARD_STATES,
    GUARDS_OF,
    IMPACT_QUANTITIES,
    IMPACT_STATES,
    IS_LINEAR,
    MOTION,
    POWERS,
    PREPARE,
    QUANTITY_SLOPES,
    RATES,
    RESTORE,
    SERIES_FROM,
    SERIES_STEP,
    SETTLE,
    STATE_SLOPES,
    STAYS,
    TIME_SLOPES,
)
from stickslip.kernels.state_layout import ANSWER, N_STATES, N_VARIABLES

__all__ = ["answer"]


def answer(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Answer one question; whole numbers are left in ANSWER.

    Reads: `at`, TIME, STEP, STRIDE, SUPPLIED, TAKEN, VIOLATION, RESIDUAL, FRACTION, LENGTH, GROSS,
    LOST, ADDRESS, SEVERAL, LIVELIEST, RHYTHM, PIVOT, FRICTIONLESS, HELD_STRIDE, POLYNOMIAL, ROOM,
    Y, SCALE, VALUES, PULLS, DENSE, REACHED, WALLS, LAW_ROWS, SLIP_FACTORS, HELD_SLIPS,
    HELD_NORMALS, FORCE, MASS, CHOLESKY, ACCELERATION, NEEDED, LEVELS, FRICTION, LOAD,
    FRICTION_CONSTANT, FRICTION_FACTOR, LEVEL_CONSTANT, LEVEL_FACTOR, DAMPING, BRISTLE_RATES,
    NEEDED_SERIES, SLOPE_VALUES, ROOTS, BOUNDS, REACTION_ROWS, WORKS, BOX, TURN, MOTION_POINT,
    LAW_SLOPES, BRISTLE_SLOPES, LOOPS, FOLLOWED, BORNE, REACHED_SO_FAR, MODE, FLAGS, STATUS, STEPS,
    STEPPER, BOOKS, DECISIONS, PIVOTINGS, AMBIGUOUS, MODES, LAW_FLAGS, OPEN, CANDIDATES, ASKED,
    STRUCK, FOLLOWERS.
    Writes: `to`, TIME, STEP, STRIDE, SUPPLIED, TAKEN, VIOLATION, RESIDUAL, FRACTION, LENGTH, GROSS,
    LOST, ADDRESS, SEVERAL, LIVELIEST, RHYTHM, PIVOT, FRICTIONLESS, HELD_STRIDE, POLYNOMIAL, ROOM,
    GIVEN, Y, Y1, SCALE, POINT, VALUES, DRIFT, DENSE, REACHED, WALLS, LAW_ROWS, SLIP_FACTORS, FORCE,
    MASS, CHOLESKY, ACCELERATION, NEEDED, LEVELS, FRICTION, LOAD, FRICTION_CONSTANT,
    FRICTION_FACTOR, LEVEL_CONSTANT, LEVEL_FACTOR, DAMPING, BRISTLE_RATES, LAW_VALUES,
    NEEDED_SERIES, SLOPE_VALUES, ROOTS, BOUNDS, REACTION_ROWS, WORKS, CHANGES, TURN, MOTION_POINT,
    PART_SLOPES, LAW_SLOPES, PART_COLUMN, ACCELERATION_SLOPES, NEEDED_SLOPES, LOAD_SLOPES,
    FRICTION_SLOPES, LEVEL_SLOPES, BRISTLE_SLOPES, LOOPS, FOLLOWED, PROJECTED, BORNE, SHARES,
    REACHED_SO_FAR, FLAGS, STATUS, DECISIONS, PIVOTINGS, AMBIGUOUS, ANSWER, CHANGED, MODES,
    LAW_FLAGS, OPEN, CANDIDATES, FORCED, BEFORE, CLOSED, ASKED, KEPT, STRUCK, FOLLOWERS.

    Parameters
    ----------
    name : int
        Number of the question.
    t : float
        Time, or for `SERIES_STEP` and `SERIES_FROM` the length of a step [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state; for `CHANGE` the guard that has fallen.
    to : int
        Place of the result.
    """
    if name == RATES:
        contact_rates(t, w, whole, at, to)
    elif name == GUARDS_OF:
        contact_guards(t, w, whole, at, to)
    elif name == COLUMNS:
        contact_columns(t, w, whole, at, to)
    elif name == POWERS:
        contact_power(t, w, whole, at, to)
    elif name < STATE_SLOPES:
        answer_of_run(name, t, w, whole, at, to)
    else:
        answer_of_slopes(name, t, w, whole, at, to)


def answer_of_slopes(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write slopes along states, time, or all quantities.

    Reads: `at`, FRICTIONLESS, Y, WALLS, LAW_ROWS, SLIP_FACTORS, HELD_SLIPS, HELD_NORMALS, MASS,
    CHOLESKY, LOAD, FRICTION_CONSTANT, FRICTION_FACTOR, LEVEL_CONSTANT, LEVEL_FACTOR, BOUNDS,
    REACTION_ROWS, LAW_SLOPES, BRISTLE_SLOPES, LOOPS, FOLLOWED, BORNE, FLAGS, MODES, LAW_FLAGS,
    OPEN, ASKED, STRUCK, FOLLOWERS.
    Writes: `to`, PIVOT, LAW_ROWS, FORCE, MASS, CHOLESKY, ACCELERATION, NEEDED, LEVELS, FRICTION,
    LOAD, FRICTION_CONSTANT, FRICTION_FACTOR, LEVEL_CONSTANT, LEVEL_FACTOR, DAMPING, BRISTLE_RATES,
    LAW_VALUES, REACTION_ROWS, MOTION_POINT, PART_SLOPES, LAW_SLOPES, PART_COLUMN,
    ACCELERATION_SLOPES, NEEDED_SLOPES, LOAD_SLOPES, FRICTION_SLOPES, LEVEL_SLOPES, BRISTLE_SLOPES,
    PROJECTED, BORNE, SHARES, MODES, ASKED, KEPT, STRUCK.
    """
    states = whole[N_STATES]
    quantities = whole[N_VARIABLES] - states - 1
    if name == STATE_SLOPES:
        rate_slopes_along(0, states, t, w, whole, at, to)
    elif name == TIME_SLOPES:
        rate_slopes_along(states, 1, t, w, whole, at, to)
    elif name == QUANTITY_SLOPES:
        rate_slopes_along(states + 1, quantities, t, w, whole, at, to)
    elif name == GUARD_STATES:
        guard_slopes_along(0, states + 1, t, w, whole, at, to)
    elif name == GUARD_QUANTITIES:
        guard_slopes_along(states + 1, quantities, t, w, whole, at, to)
    elif name == IMPACT_STATES:
        impact_slopes_along(0, states, t, w, whole, at, to)
    elif name == IMPACT_QUANTITIES:
        impact_slopes_along(states + 1, quantities, t, w, whole, at, to)


def answer_of_run(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Answer what is asked of the course of a run.

    Reads: `at`, TIME, STEP, STRIDE, SUPPLIED, TAKEN, VIOLATION, RESIDUAL, FRACTION, LENGTH, GROSS,
    LOST, ADDRESS, SEVERAL, LIVELIEST, RHYTHM, PIVOT, FRICTIONLESS, HELD_STRIDE, POLYNOMIAL, ROOM,
    Y, SCALE, VALUES, PULLS, DENSE, REACHED, WALLS, SLIP_FACTORS, HELD_SLIPS, HELD_NORMALS, FORCE,
    MASS, CHOLESKY, ACCELERATION, NEEDED, LEVELS, FRICTION, LOAD, FRICTION_CONSTANT,
    FRICTION_FACTOR, LEVEL_CONSTANT, LEVEL_FACTOR, DAMPING, NEEDED_SERIES, SLOPE_VALUES, ROOTS,
    BOUNDS, REACTION_ROWS, WORKS, BOX, TURN, MOTION_POINT, LOOPS, FOLLOWED, BORNE, REACHED_SO_FAR,
    MODE, FLAGS, STATUS, STEPS, STEPPER, BOOKS, DECISIONS, PIVOTINGS, AMBIGUOUS, MODES, LAW_FLAGS,
    OPEN, CANDIDATES, ASKED, STRUCK, FOLLOWERS.
    Writes: `to`, TIME, STEP, STRIDE, SUPPLIED, TAKEN, VIOLATION, RESIDUAL, FRACTION, LENGTH, GROSS,
    LOST, ADDRESS, SEVERAL, LIVELIEST, RHYTHM, PIVOT, FRICTIONLESS, HELD_STRIDE, POLYNOMIAL, ROOM,
    GIVEN, Y, Y1, SCALE, POINT, VALUES, DRIFT, DENSE, REACHED, WALLS, LAW_ROWS, SLIP_FACTORS, FORCE,
    MASS, CHOLESKY, ACCELERATION, NEEDED, LEVELS, FRICTION, LOAD, FRICTION_CONSTANT,
    FRICTION_FACTOR, LEVEL_CONSTANT, LEVEL_FACTOR, DAMPING, BRISTLE_RATES, LAW_VALUES,
    NEEDED_SERIES, SLOPE_VALUES, ROOTS, BOUNDS, REACTION_ROWS, WORKS, CHANGES, TURN, MOTION_POINT,
    LOOPS, FOLLOWED, PROJECTED, BORNE, SHARES, REACHED_SO_FAR, FLAGS, STATUS, DECISIONS, PIVOTINGS,
    AMBIGUOUS, ANSWER, CHANGED, MODES, LAW_FLAGS, OPEN, CANDIDATES, FORCED, BEFORE, CLOSED, ASKED,
    KEPT, STRUCK, FOLLOWERS.
    """
    if name == SERIES_STEP:
        w[to] = contact_series_step(t, w, whole)
    elif name == SERIES_FROM:
        contact_series(t, w, whole, at)
    elif name == CROSSING:
        whole[ANSWER] = first_contact_crossing(w, whole)
    elif name == CHANGE:
        change_contacts(at, w, whole)
    elif name == SETTLE:
        settle_contacts(w, whole)
    elif name == BOOK:
        book_contacts(w, whole)
    elif name == MOTION:
        note_motion(w, whole)
    elif name == IS_LINEAR:
        whole[ANSWER] = 1 if contacts_are_linear(w, whole) else 0
    elif name == STAYS:
        whole[ANSWER] = 1 if contacts_rest(w, whole) else 0
    else:
        answer_of_start(name, t, w, whole)


def answer_of_start(name: int, t: float, w: Vector, whole: Wholes) -> None:
    """Set what follows from a state at which a run begins, or is taken up again.

    Reads: TIME, LENGTH, PIVOT, FRICTIONLESS, Y, REACHED, WALLS, SLIP_FACTORS, HELD_SLIPS,
    HELD_NORMALS, MASS, CHOLESKY, LOAD, FRICTION_CONSTANT, FRICTION_FACTOR, LEVEL_CONSTANT,
    LEVEL_FACTOR, BOUNDS, REACTION_ROWS, TURN, LOOPS, FOLLOWED, BORNE, REACHED_SO_FAR, FLAGS,
    STATUS, DECISIONS, PIVOTINGS, AMBIGUOUS, MODES, LAW_FLAGS, OPEN, CANDIDATES, ASKED, FOLLOWERS.
    Writes: TIME, LIVELIEST, PIVOT, FRICTIONLESS, Y, SCALE, VALUES, WALLS, LAW_ROWS, SLIP_FACTORS,
    FORCE, MASS, CHOLESKY, ACCELERATION, NEEDED, LEVELS, FRICTION, LOAD, FRICTION_CONSTANT,
    FRICTION_FACTOR, LEVEL_CONSTANT, LEVEL_FACTOR, DAMPING, BRISTLE_RATES, LAW_VALUES, BOUNDS,
    REACTION_ROWS, CHANGES, TURN, MOTION_POINT, LOOPS, FOLLOWED, PROJECTED, BORNE, SHARES,
    REACHED_SO_FAR, FLAGS, STATUS, DECISIONS, PIVOTINGS, AMBIGUOUS, CHANGED, MODES, LAW_FLAGS, OPEN,
    CANDIDATES, FORCED, BEFORE, CLOSED, ASKED, KEPT, FOLLOWERS.
    """
    if name == RESTORE:
        refactor(w, whole)
    elif name == PREPARE:
        prepare(t, w, whole)
    elif name == FIRST_SIZES:
        first_contact_sizes(t, w, whole)
    elif name == BEGIN:
        begin_contacts(w, whole)
