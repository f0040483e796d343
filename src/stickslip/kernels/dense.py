"""Dense output: the solution inside a step, in one form for all steppers.

y0 + x (F0 + (1 - x) (F1 + x (F2 + (1 - x) (F3 + x (F4 + (1 - x) (F5 + x F6)))))), x from 0 to 1.
"""

from stickslip.kernels.model import N_STATES
from stickslip.kernels.tier import Vector

__all__ = ["TERMS", "interpolate"]

TERMS = 7


def interpolate(y0: Vector, dense: Vector, x: float, out: Vector) -> None:
    """Evaluate the step at the fraction `x` of its length."""
    n = N_STATES
    rest_of_step = 1.0 - x
    for i in range(n):
        value = dense[6 * n + i] * x + dense[5 * n + i]
        value = value * rest_of_step + dense[4 * n + i]
        value = value * x + dense[3 * n + i]
        value = value * rest_of_step + dense[2 * n + i]
        value = value * x + dense[n + i]
        value = value * rest_of_step + dense[i]
        out[i] = value * x + y0[i]
