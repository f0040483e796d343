"""The equations of a mechanism with its friction, in the modes and with the flags of the run."""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.equations import (
    CONTACT,
    ENERGY,
    FIELD,
    FIELD_SLOPES,
    GUARD_PARAMETERS,
    GUARD_SLOPES,
    GUARDS,
    IMPACT_PARAMETERS,
    IMPACT_SLOPES,
    JACOBIAN,
    LINEAR,
    POWER,
    TIME_SLOPE,
    evaluate,
)
from stickslip.kernels.questions import (
    COLUMNS,
    GUARD_QUANTITIES,
    GUARD_STATES,
    GUARDS_OF,
    IMPACT_QUANTITIES,
    IMPACT_STATES,
    IS_LINEAR,
    POWERS,
    QUANTITY_SLOPES,
    RATES,
    STATE_SLOPES,
    TIME_SLOPES,
    ask_here,
    ask_of,
)
from stickslip.kernels.state_layout import FLAGS, MODE, N_COLUMNS, N_CONTACTS


def field(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Time derivatives of the states."""
    if whole[N_CONTACTS] > 0:
        ask_of(RATES, t, w, whole, at, to)
    else:
        evaluate(FIELD, whole[MODE], whole[FLAGS], t, w, at, to)


def jacobian(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of the field with respect to the states, row by row."""
    if whole[N_CONTACTS] > 0:
        ask_of(STATE_SLOPES, t, w, whole, at, to)
    else:
        evaluate(JACOBIAN, whole[MODE], whole[FLAGS], t, w, at, to)


def time_slope(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of the field with respect to time."""
    if whole[N_CONTACTS] > 0:
        ask_of(TIME_SLOPES, t, w, whole, at, to)
    else:
        evaluate(TIME_SLOPE, whole[MODE], whole[FLAGS], t, w, at, to)


def guards(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Quantities that are not negative while the mode lasts, by the indices of `enums`."""
    if whole[N_CONTACTS] > 0:
        ask_of(GUARDS_OF, t, w, whole, at, to)
    else:
        evaluate(GUARDS, whole[MODE], whole[FLAGS], t, w, at, to)


def guard_slopes(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of each guard with respect to the states and then to time."""
    if whole[N_CONTACTS] > 0:
        ask_of(GUARD_STATES, t, w, whole, at, to)
    else:
        evaluate(GUARD_SLOPES, whole[MODE], whole[FLAGS], t, w, at, to)


def linear(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Whether field and guards are affine in state and time together: 1 or 0."""
    if whole[N_CONTACTS] > 0:
        w[to] = ask_here(IS_LINEAR, w, whole)
    else:
        evaluate(LINEAR, whole[MODE], whole[FLAGS], t, w, at, to)


def recorded(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write what a run records beside its states.

    That is friction, normal force and the efforts of guided coordinates; of several contacts
    friction, then load, then mode of each.
    """
    if whole[N_CONTACTS] > 0:
        ask_of(COLUMNS, t, w, whole, at, to)
        return
    evaluate(CONTACT, whole[MODE], whole[FLAGS], t, w, at, to)
    for k in range(2, whole[N_COLUMNS]):  # needed friction and level stand between
        w[to + k] = w[to + k + 2]


def power(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Power supplied, power taken by friction."""
    if whole[N_CONTACTS] > 0:
        ask_of(POWERS, t, w, whole, at, to)
    else:
        evaluate(POWER, whole[MODE], whole[FLAGS], t, w, at, to)


def energy(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Mechanical energy; the same in all modes."""
    evaluate(ENERGY, whole[MODE], whole[FLAGS], t, w, at, to)


def field_slopes(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of the field with respect to all quantities: drives' numbers, parameters."""
    if whole[N_CONTACTS] > 0:
        ask_of(QUANTITY_SLOPES, t, w, whole, at, to)
    else:
        evaluate(FIELD_SLOPES, whole[MODE], whole[FLAGS], t, w, at, to)


def guard_parameters(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of each guard with respect to all quantities."""
    if whole[N_CONTACTS] > 0:
        ask_of(GUARD_QUANTITIES, t, w, whole, at, to)
    else:
        evaluate(GUARD_PARAMETERS, whole[MODE], whole[FLAGS], t, w, at, to)


def impact_slopes(case: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of the rates after an impact with respect to the states before it.

    Of several contacts, STRUCK and BOUNDS tell which coordinates are stopped, and what the rates
    change by.
    """
    if whole[N_CONTACTS] > 0:
        ask_of(IMPACT_STATES, t, w, whole, at, to)
    else:
        evaluate(IMPACT_SLOPES, case, whole[FLAGS], t, w, at, to)


def impact_parameters(case: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of the rates after an impact with respect to all quantities."""
    if whole[N_CONTACTS] > 0:
        ask_of(IMPACT_QUANTITIES, t, w, whole, at, to)
    else:
        evaluate(IMPACT_PARAMETERS, case, whole[FLAGS], t, w, at, to)
