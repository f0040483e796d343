"""The equations of a mechanism with its friction, asked by number.

They are generated functions, which the vector of a run names at ADDRESS. All read that vector: the
numbers of drives and parameters, and the state from the place `at` on. They write to the place
`to` and after it. Mode and flags are those of the run; `evaluate` asks in any other.
"""

from stickslip.kernels.backend import Vector, Wholes, call_model
from stickslip.kernels.state_layout import ADDRESS, FLAGS, MODE

__all__ = [
    "CALLED",
    "CONTACT",
    "ENERGY",
    "FIELD",
    "FIELD_SLOPES",
    "GUARDS",
    "GUARD_PARAMETERS",
    "GUARD_SLOPES",
    "JACOBIAN",
    "LINEAR",
    "MARGINS",
    "POWER",
    "REST",
    "TIME_SLOPE",
    "WALLS_OF",
    "contact",
    "energy",
    "evaluate",
    "field",
    "field_slopes",
    "guard_parameters",
    "guard_slopes",
    "guards",
    "jacobian",
    "linear",
    "power",
    "time_slope",
]

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
)
"""Names of the generated functions by these numbers."""


def evaluate(name: int, mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Call one function of the equations in any mode.

    Reads: `at`.
    Writes: `to`.

    Parameters
    ----------
    name : int
        Number of the function.
    mode : int
        Contact mode: 1 or -1 slip, 0 stick, 2 or -2 pressed against a stop.
    flags : int
        Bit j is set where the condition of switch j holds.
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result; its length is the function's.
    """
    call_model(w, ADDRESS, name, mode, flags, t, at, to)


def field(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Time derivatives of the states.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (N_STATES,).
    """
    evaluate(FIELD, whole[MODE], whole[FLAGS], t, w, at, to)


def jacobian(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of the field with respect to the states, row by row.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (N_STATES N_STATES,).
    """
    evaluate(JACOBIAN, whole[MODE], whole[FLAGS], t, w, at, to)


def time_slope(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of the field with respect to time.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (N_STATES,).
    """
    evaluate(TIME_SLOPE, whole[MODE], whole[FLAGS], t, w, at, to)


def guards(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Quantities that are not negative while the mode lasts, by the indices of `enums`.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (N_GUARDS,).
    """
    evaluate(GUARDS, whole[MODE], whole[FLAGS], t, w, at, to)


def guard_slopes(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of each guard with respect to the states and then to time.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (N_GUARDS (N_STATES + 1),), row by row.
    """
    evaluate(GUARD_SLOPES, whole[MODE], whole[FLAGS], t, w, at, to)


def linear(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Whether field and guards are affine in state and time together: 1 or 0.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (1,).
    """
    evaluate(LINEAR, whole[MODE], whole[FLAGS], t, w, at, to)


def contact(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Friction force, normal force, needed friction, break-away level, then the channels.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (4 + N_CHANNELS,): forces [N], then efforts in their units.
    """
    evaluate(CONTACT, whole[MODE], whole[FLAGS], t, w, at, to)


def power(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Power supplied, power taken by friction.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (2,) [W].
    """
    evaluate(POWER, whole[MODE], whole[FLAGS], t, w, at, to)


def energy(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Mechanical energy; the same in all modes.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (1,) [J].
    """
    evaluate(ENERGY, whole[MODE], whole[FLAGS], t, w, at, to)


def field_slopes(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of the field with respect to all quantities: drives' numbers, parameters.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (N_STATES quantities,), row by row.
    """
    evaluate(FIELD_SLOPES, whole[MODE], whole[FLAGS], t, w, at, to)


def guard_parameters(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Derivatives of each guard with respect to all quantities.

    Reads: `at`, MODE, FLAGS.
    Writes: `to`.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    at : int
        Place in `w` of the state.
    to : int
        Place of the result (N_GUARDS quantities,), row by row.
    """
    evaluate(GUARD_PARAMETERS, whole[MODE], whole[FLAGS], t, w, at, to)
