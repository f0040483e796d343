"""Hard stops: which one a body touches, whether it is pressed there, and what an impact does."""

import math

from stickslip.kernels.backend import Vector
from stickslip.kernels.enums import BREAK_BACKWARD, BREAK_FORWARD, SWITCH
from stickslip.kernels.model_interface import (
    N_COORDINATES,
    N_LIMITS,
    N_SWITCHES,
    N_WALLS,
    SLIP,
    WALL_COORDINATES,
    WALL_SIDES,
    field,
    guards,
    walls,
)
from stickslip.kernels.state_layout import (
    BOOKS,
    FLAGS,
    GROSS,
    LOST,
    MODE,
    SCALE,
    STEPS,
    TIME,
    VALUES,
    WALL_COLUMNS,
    WALLS,
    Y,
)

__all__ = ["FIRST_LIMIT", "FIRST_WALL", "approach", "pressed_by", "strike", "touched"]

FIRST_LIMIT = SWITCH + N_SWITCHES
"""Index of the guard of the first limit."""
FIRST_WALL = FIRST_LIMIT + N_LIMITS
"""Index of the guard of the first hard stop."""
RESTING = 1e-9
"""Share of the largest speed so far below which a body that is pressed bounces no more."""
INSTANT = 1e-13
"""Share of the time that has passed below which a bounce is too short to be stepped through."""
BLUR = 1.8e-15
"""Rounding of a place, eight units in its last digit, over the place."""
ELASTIC = 1e-3
"""Least share of the energy that an impact is taken to cost in what rounding can sustain."""


def touched(flags: int, w: Vector) -> int:
    """Return the side of the stop that the slipping body touches: 1 upper, -1 lower, 0 none.

    A body that has come to rest beyond its stop, by rounding, is put onto it.

    Reads: TIME, Y.
    Writes: Y, WALLS.

    Parameters
    ----------
    flags : int
        Bit j is set where the condition of switch j holds.
    w : array (SIZE,)
        Vector of the run.

    Returns
    -------
    int
        1 for an upper stop, -1 for a lower one, 0 for none.
    """
    if N_WALLS == 0:
        return 0
    walls(0, flags, w[TIME], w, Y, WALLS)
    place = Y + SLIP - N_COORDINATES
    for wall in range(N_WALLS):
        position = w[WALLS + wall * WALL_COLUMNS]
        side = WALL_SIDES[wall]
        if Y + WALL_COORDINATES[wall] == place and side * (w[place] - position) >= 0.0:
            w[place] = position
            return side
    return 0


def pressed_by(side: int, flags: int, w: Vector) -> float:
    """Return the force that is missing for the slipping body to leave its stop.

    Reads: TIME, Y.
    Writes: VALUES.

    Parameters
    ----------
    side : int
        1 for an upper stop, -1 for a lower one.
    flags : int
        Bit j is set where the condition of switch j holds.
    w : array (SIZE,)
        Vector of the run.

    Returns
    -------
    float
        Missing force [N]; below 0 the body leaves.
    """
    guards(2 * side, flags, w[TIME], w, Y, VALUES)
    return w[VALUES + (BREAK_BACKWARD if side > 0 else BREAK_FORWARD)]


def approach(guard: int, w: Vector) -> float:
    """Return the speed with which a coordinate nears the stop that a guard belongs to.

    Reads: Y.

    Parameters
    ----------
    guard : int
        Index of the guard of a stop, `FIRST_WALL` or above.
    w : array (SIZE,)
        Vector of the run.

    Returns
    -------
    float
        Speed, positive towards the stop.
    """
    wall = guard - FIRST_WALL
    return WALL_SIDES[wall] * w[Y + N_COORDINATES + WALL_COORDINATES[wall]]


def resting_speed(t: float, size: float, push: float, place: float, restitution: float) -> float:
    """Return the speed of an impact below which a body that is pressed stays at its stop.

    A tiny share of the largest speed; but the bounce must also last some units of the time's last
    digit, and its impact cost a height that is not lost in the rounding of the place: of a bounce
    that gains by rounding what it loses by impact there is no end.
    """
    cost = max(1.0 - restitution * restitution, ELASTIC)
    blurred = math.sqrt(2.0 * abs(push) * BLUR * abs(place) / cost)
    return max(RESTING * size, INSTANT * abs(t * push), blurred)


def strike(wall: int, w: Vector, whole: Vector) -> bool:
    """Change the rates by an impact; return whether a coordinate that does not slip stays there.

    Reads: TIME, GROSS, LOST, Y, SCALE, MODE, FLAGS, STEPS, BOOKS.
    Writes: GROSS, LOST, Y, VALUES, WALLS.

    Parameters
    ----------
    wall : int
        Index of the stop.
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole-numbered state of the run.

    Returns
    -------
    bool
        Whether the coordinate stays at its stop, which the run cannot follow.
    """
    flags = int(whole[FLAGS])
    walls(0, flags, w[TIME], w, Y, WALLS)
    at = WALLS + wall * WALL_COLUMNS
    side = WALL_SIDES[wall]
    rate = N_COORDINATES + WALL_COORDINATES[wall]
    restitution = w[at + 1]
    w[Y + WALL_COORDINATES[wall]] = w[at]
    field(int(whole[MODE]), flags, w[TIME], w, Y, VALUES)
    push = side * w[VALUES + rate]
    smallest = resting_speed(w[TIME], w[SCALE + rate], push, w[at], restitution)
    if rate == SLIP:
        push = pressed_by(side, flags, w)
    speed = approach(FIRST_WALL + wall, w)
    if speed <= smallest and push > 0.0:
        restitution = 0.0
    if speed > 0.0:
        for i in range(N_COORDINATES):
            w[Y + N_COORDINATES + i] -= (1.0 + restitution) * side * speed * w[at + 3 + i]
        w[Y + rate] = 0.0 - side * restitution * speed
        if whole[BOOKS] and whole[STEPS] > 0:  # books open after what happens as a run begins
            lost = 0.5 * w[at + 2] * (1.0 - restitution * restitution) * speed * speed
            w[LOST] += lost
            w[GROSS] += lost
    return rate != SLIP and push > 0.0 and (speed <= 0.0 or restitution == 0.0)
