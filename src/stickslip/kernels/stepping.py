"""One step: as long as accuracy allows, up to the first event."""

import math

from stickslip.kernels.codes import STEP_TOO_SMALL, STOP
from stickslip.kernels.dop853 import dop853_dense, dop853_step
from stickslip.kernels.model import HAS_BRISTLES, N_STATES, field
from stickslip.kernels.rodas5p import rodas_dense, rodas_step
from stickslip.kernels.roots import NO_GUARD, first_violation
from stickslip.kernels.state import FLAGS, MODE, REJECTED, STATUS, STEP, TIME
from stickslip.kernels.tier import Vector

__all__ = ["advance"]

OVERSHOT = 0.99
"""A step is taken again if the event lies before this part of it."""
BEYOND = 1.002
"""Length of the new step over the time to the event, so that the event lies at its end."""


def attempt(
    mode: int,
    flags: int,
    t: float,
    y: Vector,
    h: float,
    p: Vector,
    rtol: float,
    work: tuple[Vector, ...],
) -> float:
    """Try a step with the mode's stepper, fill its dense output if it is good enough."""
    k, y1, slope, scale, matrix, pivots, drift, dense = work
    if HAS_BRISTLES and mode != 0:
        error = rodas_step(
            mode, flags, t, y, h, p, k, y1, slope, scale, rtol, matrix, pivots, drift
        )
        if error <= 1.0:
            rodas_dense(y, y1, k, dense)
        return error
    field(mode, flags, t, y, p, slope)
    for i in range(N_STATES):
        k[i] = slope[i]
    error = dop853_step(mode, flags, t, y, h, p, k, y1, slope, scale, rtol)
    if error <= 1.0:
        dop853_dense(mode, flags, t, y, h, p, k, y1, slope, dense)
    return error


def resized(h: float, error: float, mode: int) -> float:
    """Return the next step length for an error over the tolerance."""
    if error == 0.0:
        return 10.0 * h
    if not error < 1e30:
        return 0.1 * h
    order = 5.0 if HAS_BRISTLES and mode != 0 else 8.0
    return h * min(10.0, max(0.2, 0.9 * math.pow(error, -1.0 / order)))


def accepted_step(
    y: Vector,
    stop: float,
    real: Vector,
    whole: Vector,
    p: Vector,
    rtol: float,
    cap: float,
    work: tuple[Vector, ...],
) -> float:
    """Shorten the step until it is accurate; return its length, 0 if there is none."""
    mode = int(whole[MODE])
    flags = int(whole[FLAGS])
    t = real[TIME]
    h = min(real[STEP], cap)
    while True:
        last = t + 1.01 * h >= stop
        if last:
            h = stop - t
        elif t + 2.0 * h > stop:
            h = 0.5 * (stop - t)
        if not t + h > t:
            whole[STATUS] = STEP_TOO_SMALL
            return 0.0
        error = attempt(mode, flags, t, y, h, p, rtol, work)
        proposed = resized(h, error, mode)
        if error <= 1.0:
            real[STEP] = max(proposed, real[STEP]) if last else proposed
            return h
        whole[REJECTED] += 1
        h = proposed


def retry_length(guard: int, t: float, h: float, stop: float, found: Vector) -> float:
    """Return the length with which a step should be taken again, 0 if it stands."""
    never_armed = found[1] > 0.0
    if guard == STOP and never_armed and not HAS_BRISTLES:
        return h / 8.0 if t + h / 64.0 > t and h > 1e-9 * (stop - t) else 0.0
    if guard != NO_GUARD and 0.0 < found[0] < OVERSHOT and t + found[0] * h > t:
        return BEYOND * found[0] * h
    return 0.0


def advance(
    y: Vector,
    stop: float,
    real: Vector,
    whole: Vector,
    p: Vector,
    rtol: float,
    cap: float,
    work: tuple[Vector, ...],
    buffers: tuple[Vector, ...],
) -> int:
    """Take one step up to the first event; return the guard that ended it, or NO_GUARD.

    On return ``buffers[1]`` holds the fraction of the step that holds and its length. A body that
    starts from rest towards a guard that would be violated at once gets shorter steps before that
    is believed. A step that ends beyond an event is taken again up to just beyond it: the mode's
    equations, and so the error estimate, mean little where the mode does not hold, and the dense
    output is best where the step ends.
    """
    found = buffers[1]
    t = real[TIME]
    before = real[STEP]
    while True:
        h = accepted_step(y, stop, real, whole, p, rtol, cap, work)
        if h == 0.0:
            return NO_GUARD
        guard = first_violation(
            int(whole[MODE]), int(whole[FLAGS]), t, h, y, work[7], p, work[3], buffers
        )
        shorter = retry_length(guard, t, h, stop, found)
        if shorter > 0.0:
            real[STEP] = shorter
            continue
        found[1] = h
        if guard == NO_GUARD:
            found[0] = 1.0
        elif found[0] == 0.0:
            real[STEP] = before  # the step was tried in a mode that does not hold
        return guard
