"""What is asked of a mechanism with several contacts, by number: see `contacts.answers`."""

from stickslip.kernels.backend import Vector, Wholes, call_contacts
from stickslip.kernels.state_layout import ANSWER, SEVERAL, TIME, Y

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


def ask_of(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Ask at a state, for numbers."""
    call_contacts(w, SEVERAL, whole, name, t, at, to)


def ask(name: int, t: float, w: Vector, whole: Wholes) -> int:
    """Ask at the present state; return the answer, a whole number."""
    call_contacts(w, SEVERAL, whole, name, t, whole[Y], 0)
    return whole[ANSWER]


def ask_here(name: int, w: Vector, whole: Wholes) -> int:
    """Ask at the present time and state; return the answer, a whole number."""
    return ask(name, w[TIME], w, whole)
