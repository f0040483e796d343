"""Impacts at hard stops where several contacts rub: those of one instant are solved together.

Each stop that a coordinate reaches gives it an impulse, after which its speed is that before times
the restitution, away from the stop. A coordinate that rests at its stop gets one too, if it would
else move into it. All other rates follow by the mass matrix: what friction holds is no exception,
for a bounded force does nothing in no time.
"""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.contacts.assembly import put_mass, refresh
from stickslip.kernels.contacts.factors import factorise, solve_free
from stickslip.kernels.contacts.stops import finite, margin_of, stopped_side
from stickslip.kernels.enums import FREE, HELD_FAST
from stickslip.kernels.hard_stops import (
    approach,
    energy_now,
    resting_speed,
    wall_coordinate,
    wall_side,
)
from stickslip.kernels.state_layout import (
    ACCELERATION,
    BOOKS,
    BOUNDS,
    CONSTANT_MASS,
    DIAGONAL,
    FIRST_WALL,
    GROSS,
    KEPT,
    LEVELS,
    LOST,
    MASS,
    MODES,
    N_CHANNELS,
    N_COORDINATES,
    N_WALLS,
    NEEDED,
    REACHED,
    SCALE,
    STEPS,
    STRUCK,
    SUPPLIED,
    TIME,
    WALL_COLUMNS,
    WALLS,
    Y,
)

STRIKES = 2
"""A coordinate that reaches its stop."""
RESTS = 1
"""One that is at its stop already and would move into it."""
AT_ONCE = 1e-13
"""Distance from a stop, over the largest so far, below which it is reached in the instant too."""


def strike_stops(guard: int, w: Vector, whole: Wholes) -> None:
    """Change all rates by the impacts of an instant.

    STRUCK tells then which coordinates have reached a stop: 2.
    """
    n, y, change = whole[N_COORDINATES], whole[Y], whole[BOUNDS]
    first = whole[FIRST_WALL]
    for i in range(n):
        whole[whole[STRUCK] + i] = 0
        w[change + i] = 0.0
    for wall in range(whole[N_WALLS]):
        reach = AT_ONCE * w[whole[REACHED] + first + wall]
        meets = margin_of(wall, w, whole, y) <= reach and approach(first + wall, w, whole) > 0.0
        if first + wall == guard or meets:
            i = wall_coordinate(wall, whole)
            w[y + i] = w[whole[WALLS] + wall * whole[WALL_COLUMNS]]
            whole[whole[STRUCK] + i] = STRIKES
    refresh(w[TIME], w, whole, y)
    for wall in range(whole[N_WALLS]):
        i = wall_coordinate(wall, whole)
        if whole[whole[STRUCK] + i] == STRIKES and margin_of(wall, w, whole, y) == 0.0:
            rebound = restitution_of(wall, w, whole)
            w[change + i] = -(1.0 + rebound) * w[y + n + i]
    before = energy_now(w, whole)
    share_impulses(w, whole)
    book_impacts(w, whole)
    for i in range(n):
        rate = w[y + n + i] + w[change + i]
        w[y + n + i] = 0.0 if whole[whole[STRUCK] + i] == RESTS else rate
    if whole[N_CHANNELS] > 0 and whole[BOOKS] and whole[STEPS] > 0:
        w[SUPPLIED] += energy_now(w, whole) - before  # with what is lost, what the guides have done


def restitution_of(wall: int, w: Vector, whole: Wholes) -> float:
    """Return the restitution of an impact, 0 where it is so slow that the coordinate stays.

    Everything is worked out for the modes at hand, before and after.
    """
    y, modes = whole[Y], whole[MODES]
    i, side = wall_coordinate(wall, whole), wall_side(wall, whole)
    at = whole[WALLS] + wall * whole[WALL_COLUMNS]
    restitution = w[at + 1]
    push = side * w[whole[ACCELERATION] + i]
    size = w[whole[SCALE] + whole[N_COORDINATES] + i]
    if approach(whole[FIRST_WALL] + wall, w, whole) > resting_speed(
        w[TIME], size, push, w[at], restitution
    ):
        return restitution
    mode = whole[modes + i]
    whole[modes + i] = HELD_FAST
    refresh(w[TIME], w, whole, y)
    level = finite(w[whole[LEVELS] + 2 * i + (1 if side > 0 else 0)])
    pressed = side * w[whole[NEEDED] + i] + level > 0.0
    whole[modes + i] = mode
    refresh(w[TIME], w, whole, y)
    return 0.0 if pressed else restitution


def share_impulses(w: Vector, whole: Wholes) -> None:
    """Write the changes of all rates, from those of the coordinates that meet their stops.

    A stop that would have to pull gives no impulse; one at which a coordinate rests gives one where
    that would else move into it. Factors and accelerations are those of the impacts afterwards: a
    decision has to follow.
    """
    n, y, change, struck = whole[N_COORDINATES], whole[Y], whole[BOUNDS], whole[STRUCK]
    if not whole[CONSTANT_MASS]:
        put_mass(w[TIME], w, whole, y)
    for i in range(n):
        whole[whole[KEPT] + i] = whole[whole[MODES] + i]
    for _ in range(2 * whole[N_WALLS]):
        follow(w, whole)
        settled = True
        for i in range(n):
            side = stopped_side(i, w, whole, y)
            if side == 0:
                continue
            if whole[struck + i] == 0 and side * (w[y + n + i] + w[change + i]) > 0.0:
                whole[struck + i] = RESTS
                w[change + i] = -w[y + n + i]
                settled = False
            elif whole[struck + i] == RESTS and side * impulse(i, w, whole) > 0.0:
                whole[struck + i] = 0
                settled = False
        if settled:
            break
    for i in range(n):
        whole[whole[MODES] + i] = whole[whole[KEPT] + i]


def follow(w: Vector, whole: Wholes) -> None:
    """Write the changes of the rates that no stop gives: momentum along them stays."""
    n, change, found = whole[N_COORDINATES], whole[BOUNDS], whole[ACCELERATION]
    for i in range(n):
        whole[whole[MODES] + i] = FREE if whole[whole[STRUCK] + i] == 0 else HELD_FAST
    if not whole[DIAGONAL]:
        factorise(w, whole)
    for i in range(n):
        w[found + i] = 0.0
        for j in range(n):
            if whole[whole[STRUCK] + j] != 0 and j != i:
                w[found + i] -= w[whole[MASS] + i * n + j] * w[change + j]
    solve_free(w, whole, found)
    for i in range(n):
        if whole[whole[STRUCK] + i] == 0:
            w[change + i] = w[found + i]


def impulse(i: int, w: Vector, whole: Wholes) -> float:
    """Return the impulse along a coordinate that the changes of the rates take."""
    n, total = whole[N_COORDINATES], 0.0
    for j in range(n):
        total += w[whole[MASS] + i * n + j] * w[whole[BOUNDS] + j]
    return total


def book_impacts(w: Vector, whole: Wholes) -> None:
    """Book what the stops take; books open after what happens as a run begins."""
    n, y, change = whole[N_COORDINATES], whole[Y], whole[BOUNDS]
    if not whole[BOOKS] or whole[STEPS] == 0:
        return
    lost = 0.0
    for i in range(n):
        if whole[whole[STRUCK] + i] != 0:
            mean = w[y + n + i] + 0.5 * w[change + i]
            lost -= impulse(i, w, whole) * mean
    w[LOST] += lost
    w[GROSS] += lost
    if whole[N_CHANNELS] > 0:
        w[SUPPLIED] += lost
