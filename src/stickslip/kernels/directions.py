"""Directions of several contacts: coordinates, slips that follow from them, cuts of loops.

A slip that is a constant combination of coordinates along which others slip closes a loop. It has
an index behind those of the coordinates, as if it were one, and so has each cut, a motion in which
the loop breaks open. The force along a cut is what forces would do in that motion.

While a closing slip is held and its parts are not, one of them follows from the others.
"""

from stickslip.kernels.backend import Vector, Wholes, rare
from stickslip.kernels.state_layout import FOLLOWED, FOLLOWERS, LOOPS, N_COORDINATES, N_DIRECTIONS

ROUNDED = 1e-15
"""Share of the sizes of its parts below which a closing slip is at rest."""


def factor_of(i: int, j: int, w: Vector, whole: Wholes) -> float:
    """Return the factor of a coordinate in a direction or a cut."""
    n = whole[N_COORDINATES]
    if i < n:
        return 1.0 if i == j else 0.0
    return w[whole[LOOPS] + (i - n) * n + j]


def combined(i: int, at: int, w: Vector, whole: Wholes) -> float:
    """Return what a vector of the coordinates is along a direction or a cut."""
    if i < whole[N_COORDINATES]:
        return w[at + i]
    return summed(i, at, w, whole)


@rare
def summed(i: int, at: int, w: Vector, whole: Wholes) -> float:
    """Return what a vector of the coordinates is along a closing slip or a cut."""
    n, total = whole[N_COORDINATES], 0.0
    row = whole[LOOPS] + (i - n) * n
    for j in range(n):
        total += w[row + j] * w[at + j]
    return total


def size_along(i: int, at: int, w: Vector, whole: Wholes) -> float:
    """Return how large the parts are of what a vector is along a direction or a cut."""
    if i < whole[N_COORDINATES]:
        return abs(w[at + i])
    return size_of_sum(i, at, w, whole)


@rare
def size_of_sum(i: int, at: int, w: Vector, whole: Wholes) -> float:
    """Return how large the parts are of what a vector is along a closing slip or a cut."""
    n, total = whole[N_COORDINATES], 0.0
    row = whole[LOOPS] + (i - n) * n
    for j in range(n):
        total += abs(w[row + j] * w[at + j])
    return total


def slip_rate_along(i: int, at: int, w: Vector, whole: Wholes) -> float:
    """Return the rate along a direction; what is left of a sum by rounding is 0."""
    n = whole[N_COORDINATES]
    if i < n:
        return w[at + n + i]
    return closing_rate(i, at + n, w, whole)


@rare
def closing_rate(i: int, rates: int, w: Vector, whole: Wholes) -> float:
    """Return the rate along a closing slip, 0 where it is rounding."""
    rate = summed(i, rates, w, whole)
    return 0.0 if abs(rate) <= ROUNDED * size_of_sum(i, rates, w, whole) else rate


def spread(i: int, force: float, to: int, w: Vector, whole: Wholes) -> None:
    """Take a force along a direction away from those along the coordinates."""
    if i < whole[N_COORDINATES]:
        w[to + i] -= force
    else:
        spread_out(i, force, to, w, whole)


@rare
def spread_out(i: int, force: float, to: int, w: Vector, whole: Wholes) -> None:
    """Take a force along a closing slip away from those along the coordinates."""
    n = whole[N_COORDINATES]
    row = whole[LOOPS] + (i - n) * n
    for j in range(n):
        w[to + j] -= w[row + j] * force


@rare
def bind(to: int, stride: int, w: Vector, whole: Wholes) -> None:
    """Let coordinates follow from others where a closing slip is held."""
    n = whole[N_COORDINATES]
    for d in range(whole[N_DIRECTIONS] - n):
        follower, row = whole[whole[FOLLOWERS] + d], whole[FOLLOWED] + d * n
        if follower >= 0:
            total = 0.0
            for j in range(n):
                if j != follower:
                    total -= w[row + j] * w[to + j * stride]
            w[to + follower * stride] = total
