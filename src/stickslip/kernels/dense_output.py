"""Dense output: the solution inside a step, as a function of the fraction x of its length.

Its first entry is the number of terms of a power series, or 0 for the nested form of the other
steppers, y0 + x (F0 + (1 - x) (F1 + x (F2 + (1 - x) (F3 + x (F4 + (1 - x) (F5 + x F6)))))).
"""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.state_layout import DENSE, N_STATES

__all__ = ["interpolate"]


def interpolate(w: Vector, whole: Wholes, x: float, to: int) -> None:
    """Evaluate the step at the fraction `x` of its length.

    Reads: DENSE.
    Writes: `to`.

    Parameters
    ----------
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    x : float
        Fraction of the length, 0 to 1.
    to : int
        Place in `w` of the states (N_STATES,).
    """
    dense = whole[DENSE]
    n = whole[N_STATES]
    terms = int(w[dense])
    if terms > 0:
        for i in range(n):
            at = dense + 1 + i
            value = w[at + terms * n]
            for k in range(terms - 1, -1, -1):
                value = value * x + w[at + k * n]
            w[to + i] = value
        return
    rest_of_step = 1.0 - x
    for i in range(n):
        at = dense + 1 + i
        value = w[at + 7 * n] * x + w[at + 6 * n]
        value = value * rest_of_step + w[at + 5 * n]
        value = value * x + w[at + 4 * n]
        value = value * rest_of_step + w[at + 3 * n]
        value = value * x + w[at + 2 * n]
        value = value * rest_of_step + w[at + n]
        w[to + i] = value * x + w[at]
