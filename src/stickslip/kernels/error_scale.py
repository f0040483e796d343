"""What errors are judged against: the sizes that the states have had in the run."""

from stickslip.kernels.backend import Vector
from stickslip.kernels.mode_transitions import set_flags
from stickslip.kernels.model_interface import N_COORDINATES, N_STATES, SLIP, field
from stickslip.kernels.state_layout import POINT, SCALE, VALUES, Y1, Y

__all__ = ["first_sizes", "size_of"]

LEAST = 1e-9
"""Least speed that counts, over that which the contact's own force gives in the time of the run."""


def first_sizes(t: float, t_end: float, w: Vector) -> None:
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
    """
    for i in range(N_STATES):
        w[SCALE + i] = abs(w[Y + i])
        w[POINT + i] = w[Y + i]
    w[POINT + SLIP] = 0.0
    flags = set_flags(t, w, POINT, 0)
    field(1, flags, t, w, POINT, VALUES)
    forward = w[VALUES + SLIP]
    field(-1, flags, t, w, POINT, VALUES)
    floor = LEAST * 0.5 * abs(forward - w[VALUES + SLIP]) * (t_end - t)
    w[SCALE + SLIP] = max(w[SCALE + SLIP], floor)


def size_of(i: int, h: float, w: Vector) -> float:
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

    Returns
    -------
    float
        Size, in the unit of the state; 0 if it has had none.
    """
    size = max(w[SCALE + i], abs(w[Y + i]), abs(w[Y1 + i]))
    if i < N_COORDINATES:
        return max(size, abs(h) * w[SCALE + i + N_COORDINATES])
    return size
