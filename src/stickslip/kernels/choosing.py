"""Which stepper a mode takes: its exact series, DOP853, or Rodas5P where it is stiff."""

from stickslip.kernels.codes import EXACT, SMOOTH, STIFF
from stickslip.kernels.layout import FLAGS, MATRIX, MODE, SLOW, STEP, STEPPER, TIME, VALUES, Y1, Y
from stickslip.kernels.model import HAS_BRISTLES, N_STATES, linear
from stickslip.kernels.sizes import size_of
from stickslip.kernels.tier import Vector

__all__ = ["choose_stepper", "watch_stiffness"]

FIRST_SHARE = 1e-3
"""First step of a run over the time to its first stop, before errors tell."""
SLOW_CHANGE = 0.01
"""Change of every state in a step, over its size, that is slow."""
SLOW_STEPS = 15
"""Steps in a row that damping keeps short although all is slow, after which a mode is stiff."""


def choose_stepper(stop: float, w: Vector, whole: Vector) -> None:
    """Choose for the mode that begins."""
    mode = int(whole[MODE])
    whole[SLOW] = 0
    if HAS_BRISTLES and mode != 0:
        whole[STEPPER] = STIFF
    else:
        linear(mode, int(whole[FLAGS]), w[TIME], w, Y, VALUES)
        whole[STEPPER] = EXACT if w[VALUES] > 0.0 else SMOOTH
    if w[STEP] == 0.0 and whole[STEPPER] != EXACT:
        w[STEP] = FIRST_SHARE * (stop - w[TIME])


def watch_stiffness(h: float, w: Vector, whole: Vector) -> None:
    """Go over to Rodas5P where steps stay short for the sake of a motion that has died away.

    The Jacobian at the start of the step stands at MATRIX; less its trace is the sum of all
    dampings.
    """
    n = N_STATES
    damping = 0.0
    for i in range(n):
        damping -= w[MATRIX + i * n + i]
    slow = h * damping > 1.0
    for i in range(n):
        change = abs(w[Y1 + i] - w[Y + i])
        slow = slow and change <= SLOW_CHANGE * size_of(i, 0.0, w)
    whole[SLOW] = whole[SLOW] + 1 if slow else 0
    if whole[SLOW] > SLOW_STEPS:
        whole[STEPPER] = STIFF
        w[STEP] = h
