"""Hard stops: which one a body touches, whether it is pressed there, and what an impact does."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.enums import BREAK_BACKWARD, BREAK_FORWARD
from stickslip.kernels.equations import ENERGY, FIELD, GUARDS, WALLS_OF, evaluate
from stickslip.kernels.state_layout import (
    BOOKS,
    FIRST_WALL,
    FLAGS,
    GROSS,
    HEADER,
    LOST,
    MODE,
    N_CHANNELS,
    N_COORDINATES,
    N_WALLS,
    SCALE,
    SLIP,
    STEPS,
    SUPPLIED,
    TIME,
    VALUES,
    WALL_COLUMNS,
    WALLS,
    Y,
)

RESTING = 1e-9
"""Share of the largest speed so far below which a body that is pressed bounces no more."""
INSTANT = 1e-13
"""Share of the time that has passed below which a bounce is too short to be stepped through."""
BLUR = 1.8e-15
"""Rounding of a place, eight units in its last digit, over the place."""
ELASTIC = 1e-3
"""Least share of the energy that an impact is taken to cost in what rounding can sustain."""


def wall_coordinate(wall: int, whole: Wholes) -> int:
    """Return the index of the coordinate that a stop bounds."""
    return whole[HEADER + 2 * wall]


def wall_side(wall: int, whole: Wholes) -> int:
    """Return 1 for a stop above, -1 for one below."""
    return whole[HEADER + 2 * wall + 1]


def touched(flags: int, w: Vector, whole: Wholes) -> int:
    """Return the side of the stop that the slipping body touches: 1 upper, -1 lower, 0 none.

    A body that has come to rest beyond its stop, by rounding, is put onto it.
    """
    y, walls_at, columns = whole[Y], whole[WALLS], whole[WALL_COLUMNS]
    if whole[N_WALLS] == 0:
        return 0
    evaluate(WALLS_OF, 0, flags, w[TIME], w, y, walls_at)
    place = y + whole[SLIP] - whole[N_COORDINATES]
    for wall in range(whole[N_WALLS]):
        position = w[walls_at + wall * columns]
        side = wall_side(wall, whole)
        if side * (w[place] - position) >= 0.0:
            w[place] = position
            return side
    return 0


def pressed_by(side: int, flags: int, w: Vector, whole: Wholes) -> float:
    """Return the force that is missing for the slipping body to leave its stop."""
    values = whole[VALUES]
    evaluate(GUARDS, 2 * side, flags, w[TIME], w, whole[Y], values)
    return w[values + (BREAK_BACKWARD if side > 0 else BREAK_FORWARD)]


def approach(guard: int, w: Vector, whole: Wholes) -> float:
    """Return the speed with which a coordinate nears the stop that a guard belongs to."""
    wall = guard - whole[FIRST_WALL]
    return (
        wall_side(wall, whole) * w[whole[Y] + whole[N_COORDINATES] + wall_coordinate(wall, whole)]
    )


def resting_speed(t: float, size: float, push: float, place: float, restitution: float) -> float:
    """Return the speed of an impact below which a body that is pressed stays at its stop.

    A tiny share of the largest speed; but the bounce must also last some units of the time's last
    digit, and its impact cost a height that is not lost in the rounding of the place: of a bounce
    that gains by rounding what it loses by impact there is no end.
    """
    cost = max(1.0 - restitution * restitution, ELASTIC)
    blurred = math.sqrt(2.0 * abs(push) * BLUR * abs(place) / cost)
    return max(RESTING * size, INSTANT * abs(t * push), blurred)


def energy_now(w: Vector, whole: Wholes) -> float:
    """Return the energy of the state, where guides may do work in an impact; else 0.

    A guide keeps the rate of its coordinate. Its impulse follows from the changes of the others,
    and its work is what the energy changes by and the stops do not take.
    """
    if whole[N_CHANNELS] == 0:
        return 0.0
    evaluate(ENERGY, whole[MODE], whole[FLAGS], w[TIME], w, whole[Y], whole[VALUES])
    return w[whole[VALUES]]


def strike(wall: int, w: Vector, whole: Wholes) -> None:
    """Change the rates by an impact of the slipping body."""
    y = whole[Y]
    walls_at = whole[WALLS]
    coordinates = whole[N_COORDINATES]
    flags = whole[FLAGS]
    evaluate(WALLS_OF, 0, flags, w[TIME], w, y, walls_at)
    at = walls_at + wall * whole[WALL_COLUMNS]
    side = wall_side(wall, whole)
    rate = coordinates + wall_coordinate(wall, whole)
    restitution = w[at + 1]
    w[y + wall_coordinate(wall, whole)] = w[at]
    evaluate(FIELD, whole[MODE], flags, w[TIME], w, y, whole[VALUES])
    push = side * w[whole[VALUES] + rate]
    smallest = resting_speed(w[TIME], w[whole[SCALE] + rate], push, w[at], restitution)
    speed = approach(whole[FIRST_WALL] + wall, w, whole)
    if speed <= smallest and pressed_by(side, flags, w, whole) > 0.0:
        restitution = 0.0
    if speed > 0.0:
        before = energy_now(w, whole)
        for i in range(coordinates):
            w[y + coordinates + i] -= (1.0 + restitution) * side * speed * w[at + 3 + i]
        w[y + rate] = 0.0 - side * restitution * speed
        if whole[BOOKS] and whole[STEPS] > 0:  # books open after what happens as a run begins
            lost = 0.5 * w[at + 2] * (1.0 - restitution * restitution) * speed * speed
            w[LOST] += lost
            w[GROSS] += lost
            if whole[N_CHANNELS] > 0:
                w[SUPPLIED] += energy_now(w, whole) - before + lost
