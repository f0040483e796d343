"""What errors are judged against: the sizes that the states have had in the run."""

from stickslip.kernels.model import N_COORDINATES, N_STATES, N_SWITCHES, SLIP, field
from stickslip.kernels.switching import set_flags
from stickslip.kernels.tier import Vector, vector

__all__ = ["first_sizes", "size_of"]

LEAST = 1e-9
"""Least speed that counts, over that which the contact's own force gives in the time of the run."""


def first_sizes(t: float, t_end: float, y: Vector, p: Vector, scale: Vector) -> None:
    """Set the sizes at the start.

    A body at rest has no speed to compare with. Where friction falls steeply from rest, it leaves
    as a power of time, which no relative error control gets started; a floor far below any speed
    of interest does. It follows from the forces at rest, and so from the scale of the problem.
    """
    resting = vector(N_STATES)
    forward = vector(N_STATES + N_SWITCHES)
    backward = vector(N_STATES + N_SWITCHES)
    for i in range(N_STATES):
        scale[i] = abs(y[i])
        resting[i] = y[i]
    resting[SLIP] = 0.0
    flags = set_flags(t, resting, p, 0, forward)
    field(1, flags, t, resting, p, forward)
    field(-1, flags, t, resting, p, backward)
    floor = LEAST * 0.5 * abs(forward[SLIP] - backward[SLIP]) * (t_end - t)
    scale[SLIP] = max(scale[SLIP], floor)


def size_of(i: int, h: float, y: Vector, y1: Vector, scale: Vector) -> float:
    """Return what an error of state `i` in a step is judged against."""
    size = max(scale[i], abs(y[i]), abs(y1[i]))
    if i < N_COORDINATES:
        return max(size, abs(h) * scale[i + N_COORDINATES])
    return size
