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


def answer(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Answer one question; whole numbers are left in ANSWER."""
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
    """Write slopes along states, time, or all quantities."""
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
    """Answer what is asked of the course of a run."""
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
    """Set what follows from a state at which a run begins, or is taken up again."""
    if name == RESTORE:
        refactor(w, whole)
    elif name == PREPARE:
        prepare(t, w, whole)
    elif name == FIRST_SIZES:
        first_contact_sizes(t, w, whole)
    elif name == BEGIN:
        begin_contacts(w, whole)
