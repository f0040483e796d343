"""What errors are judged against: the sizes that the states have had in the run."""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.equations import FIELD, evaluate
from stickslip.kernels.mode_transitions import set_flags
from stickslip.kernels.state_layout import (
    N_COORDINATES,
    N_STATES,
    POINT,
    SCALE,
    SLIP,
    VALUES,
    Y1,
    Y,
)

__all__ = ["first_sizes", "size_of"]

LEAST = 1e-9
"""Least speed that counts, over that which the contact's own force gives in the time of the run."""


def first_sizes(t: float, t_end: float, w: Vector, whole: Wholes) -> None:
    """Set the sizes at the start.

    A body at rest has no speed to compare with. Where friction falls steeply from rest, it leaves
    as a power of time, which no relative error control gets started; a floor far below any speed
    of interest does. It follows from the forces at rest, and so from the scale of the problem.

    Reads: Y.
    Writes: SCALE, POINT, VALUES.

    Parameters
    ----------
    t : float
        Time [s].
    t_end : float
        End of the run [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    """
    n = whole[N_STATES]
    scale = whole[SCALE]
    y = whole[Y]
    point = whole[POINT]
    slip = whole[SLIP]
    values = whole[VALUES]
    for i in range(n):
        w[scale + i] = abs(w[y + i])
        w[point + i] = w[y + i]
    w[point + slip] = 0.0
    flags = set_flags(t, w, whole, point, 0)
    evaluate(FIELD, 1, flags, t, w, point, values)
    forward = w[values + slip]
    evaluate(FIELD, -1, flags, t, w, point, values)
    floor = LEAST * 0.5 * abs(forward - w[values + slip]) * (t_end - t)
    w[scale + slip] = max(w[scale + slip], floor)


def size_of(i: int, h: float, w: Vector, whole: Wholes) -> float:
    """Return what an error of state `i` in a step is judged against.

    Reads: Y, Y1, SCALE.

    Parameters
    ----------
    i : int
        Index of the state.
    h : float
        Length of the step [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.

    Returns
    -------
    float
        Size, in the unit of the state; 0 if it has had none.
    """
    scale = whole[SCALE]
    coordinates = whole[N_COORDINATES]
    size = max(w[scale + i], abs(w[whole[Y] + i]), abs(w[whole[Y1] + i]))
    if i < coordinates:
        return max(size, abs(h) * w[scale + i + coordinates])
    return size
