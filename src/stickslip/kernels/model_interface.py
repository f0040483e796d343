"""Typed stand-ins for what exists only in a generated module: one mechanism with one law.

Kernels import these names so that they can be linted, typed and read; the generated module drops
the import and defines them. All functions read the vector of a run: parameters from its beginning,
the state from the place `at` on. They write to the place `to` and after it.
"""

from stickslip.kernels.backend import Vector

__all__ = [
    "CAN_LIFT",
    "CAN_STICK",
    "HAS_BRISTLES",
    "N_CHANNELS",
    "N_COORDINATES",
    "N_DRIVES",
    "N_GUARDS",
    "N_LIMITS",
    "N_STATES",
    "N_SWITCHES",
    "N_WALLS",
    "PARAMETER_ROOM",
    "REST_IS_FINAL",
    "SLIP",
    "WALL_COORDINATES",
    "WALL_SIDES",
    "contact",
    "energy",
    "field",
    "field_slopes",
    "guard_parameters",
    "guard_slopes",
    "guards",
    "jacobian",
    "linear",
    "margins",
    "power",
    "rest",
    "time_slope",
    "walls",
]

N_STATES: int = 0
N_COORDINATES: int = 0
N_GUARDS: int = 0
N_SWITCHES: int = 0
N_LIMITS: int = 0
N_CHANNELS: int = 0
N_WALLS: int = 0
N_DRIVES: int = 0
SLIP: int = 0
PARAMETER_ROOM: int = 0
CAN_STICK: bool = False
CAN_LIFT: bool = False
HAS_BRISTLES: bool = False
REST_IS_FINAL: bool = False
WALL_COORDINATES: tuple[int, ...] = ()
"""Coordinate of each hard stop; one more entry, so that there is one."""
WALL_SIDES: tuple[int, ...] = ()
"""1 where a stop lies above, -1 where it lies below; one more entry here too."""


def field(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Time derivatives of the states.

    Parameters
    ----------
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
        Place of the result (N_STATES,).
    """


def jacobian(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Derivatives of the field with respect to the states, row by row.

    Parameters
    ----------
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
        Place of the result (N_STATES N_STATES,).
    """


def time_slope(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Derivatives of the field with respect to time.

    Parameters
    ----------
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
        Place of the result (N_STATES,).
    """


def guards(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Quantities that are not negative while the mode lasts, by the indices of `codes`.

    Parameters
    ----------
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
        Place of the result (N_GUARDS,).
    """


def guard_slopes(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Derivatives of each guard with respect to the states and then to time.

    Parameters
    ----------
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
        Place of the result (N_GUARDS (N_STATES + 1),), row by row.
    """


def linear(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Whether field and guards are affine in state and time together: 1 or 0.

    Parameters
    ----------
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
        Place of the result (1,).
    """


def contact(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Friction force, normal force, needed friction, break-away level, then the channels.

    Parameters
    ----------
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
        Place of the result (4 + N_CHANNELS,): forces [N], then efforts in their units.
    """


def field_slopes(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Derivatives of the field with respect to all quantities: drives' numbers, parameters.

    Parameters
    ----------
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
        Place of the result (N_STATES quantities,), row by row.
    """


def guard_parameters(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Derivatives of each guard with respect to all quantities.

    Parameters
    ----------
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
        Place of the result (N_GUARDS quantities,), row by row.
    """


def energy(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Mechanical energy; the same in all modes.

    Parameters
    ----------
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
        Place of the result (1,) [J].
    """


def power(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Power supplied, power taken by friction.

    Parameters
    ----------
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
        Place of the result (2,) [W].
    """


def margins(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Margins of the switches, positive where their condition holds; the same in all modes.

    Parameters
    ----------
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
        Place of the result (N_SWITCHES,).
    """


def rest(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Needed friction, break-away level and normal force of a held body for given drive values.

    Parameters
    ----------
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
        Place of the result (3,) [N].
    """


def walls(mode: int, flags: int, t: float, w: Vector, at: int, to: int) -> None:
    """Hard stops, row by row, with the columns of `layout`; the same in all modes.

    Parameters
    ----------
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
        Place of the result (N_WALLS WALL_COLUMNS,).
    """
