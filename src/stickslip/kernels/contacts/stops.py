"""Hard stops of mechanisms with several contacts: where they are, and what they hold.

A coordinate that rests at its stop is held like any other, but that nothing moves it towards the
stop: its level on that side is infinite. It is at its stop where its place is that of the stop to
the last bit, onto which an impact puts it.
"""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.enums import BACKWARD, FORWARD, HELD_FAST
from stickslip.kernels.hard_stops import wall_coordinate, wall_side
from stickslip.kernels.state_layout import FIRST_WALL, MODES, N_WALLS, WALL_COLUMNS, WALLS


def margin_of(wall: int, w: Vector, whole: Wholes, at: int) -> float:
    """Return the distance of a coordinate from a stop."""
    position = w[whole[WALLS] + wall * whole[WALL_COLUMNS]]
    return wall_side(wall, whole) * (position - w[at + wall_coordinate(wall, whole)])


def stopped_side(i: int, w: Vector, whole: Wholes, at: int) -> int:
    """Return the side of the stop at which a coordinate is: 1 upper, -1 lower, 0 none."""
    for wall in range(whole[N_WALLS]):
        if wall_coordinate(wall, whole) == i and margin_of(wall, w, whole, at) == 0.0:
            return wall_side(wall, whole)
    return 0


def raise_levels(levels: int, w: Vector, whole: Wholes, at: int) -> None:
    """Make the levels of held coordinates infinite towards the stops at which they are."""
    for wall in range(whole[N_WALLS]):
        i = wall_coordinate(wall, whole)
        held = whole[whole[MODES] + i] == HELD_FAST
        if held and margin_of(wall, w, whole, at) == 0.0:
            w[levels + 2 * i + (0 if wall_side(wall, whole) > 0 else 1)] = math.inf


def finite(level: float) -> float:
    """Return a level, 0 for that of a stop."""
    return level if level < math.inf else 0.0


def stop_guards(w: Vector, whole: Wholes, at: int, to: int, always: float) -> None:
    """Write the guards of the stops: distances of the coordinates that may reach them."""
    for wall in range(whole[N_WALLS]):
        mode = whole[whole[MODES] + wall_coordinate(wall, whole)]
        away = mode in (FORWARD, BACKWARD) and mode != wall_side(wall, whole)
        idle = mode == HELD_FAST or away
        margin = always if idle else margin_of(wall, w, whole, at)
        w[to + whole[FIRST_WALL] + wall] = margin
