"""The books of a run: rows of steps, work done, violations found."""

from stickslip.kernels.backend import Vector
from stickslip.kernels.dense_output import interpolate
from stickslip.kernels.enums import STOP
from stickslip.kernels.gauss_legendre import FEW_NODES, FEW_WEIGHTS, NODES, WEIGHTS
from stickslip.kernels.guard_roots import NO_GUARD, guard_values
from stickslip.kernels.model_interface import N_GUARDS, N_STATES, SLIP, power
from stickslip.kernels.state_layout import (
    DENSE,
    FLAGS,
    FRACTION,
    GROSS,
    LENGTH,
    MODE,
    PIECE,
    POINT,
    REACHED,
    RESIDUAL,
    ROUNDING,
    ROW_COLUMNS,
    ROW_DENSE,
    SCALE,
    STEPS,
    SUPPLIED,
    TAKEN,
    TERMS,
    TIME,
    VALUES,
    VIOLATION,
    Y1,
    Y,
)

__all__ = ["add_work", "close_step", "record"]

FEW_TERMS = 6
"""A series that ends so early is that of a very short step, over which few nodes do."""


def add_work(w: Vector, whole: Vector) -> None:
    """Add the work done in the part of the step that holds.

    Reads: TIME, SUPPLIED, TAKEN, FRACTION, LENGTH, GROSS, DENSE, MODE, FLAGS.
    Writes: SUPPLIED, TAKEN, GROSS, POINT, VALUES.

    Parameters
    ----------
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole-numbered state of the run.
    """
    share = w[FRACTION]
    h = w[LENGTH]
    few = 0.0 < w[DENSE] <= FEW_TERMS
    for node in range(len(FEW_NODES) if few else len(NODES)):
        x = share * (FEW_NODES[node] if few else NODES[node])
        interpolate(w, x, POINT)
        power(int(whole[MODE]), int(whole[FLAGS]), w[TIME] + x * h, w, POINT, VALUES)
        weight = share * h * (FEW_WEIGHTS[node] if few else WEIGHTS[node])
        w[SUPPLIED] += weight * w[VALUES]
        w[TAKEN] += weight * w[VALUES + 1]
        w[GROSS] += weight * (abs(w[VALUES]) + abs(w[VALUES + 1]))


def record(log: Vector, end: float, w: Vector, whole: Vector) -> None:
    """Write one row of the log.

    Reads: TIME, LENGTH, DENSE, MODE, FLAGS, PIECE, STEPS.
    Writes: STEPS.

    Parameters
    ----------
    log : array (rows ROW_COLUMNS,)
        Rows of steps.
    end : float
        Time up to which the row holds [s].
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole-numbered state of the run.
    """
    at = int(whole[STEPS]) * ROW_COLUMNS
    log[at] = w[TIME]
    log[at + 1] = end
    log[at + 2] = w[LENGTH]
    log[at + 3] = whole[MODE]
    log[at + 4] = whole[FLAGS]
    log[at + 5] = whole[PIECE]
    terms = 0 if w[DENSE] > 0.0 else TERMS
    for i in range(1 + (terms + 1) * N_STATES):
        log[at + ROW_DENSE + i] = w[DENSE + i]
    whole[STEPS] += 1


def audit(guard: int, w: Vector, whole: Vector) -> None:
    """Note how far guards are violated at the end of a step, relative to their largest size yet.

    Reads: TIME, VIOLATION, RESIDUAL, Y, SCALE, REACHED, MODE, FLAGS.
    Writes: VIOLATION, RESIDUAL, VALUES.
    """
    guard_values(int(whole[MODE]), int(whole[FLAGS]), w[TIME], w, Y, VALUES)
    for i in range(N_GUARDS):
        value = w[VALUES + i]
        if value < 0.0:
            size = max(w[REACHED + i], w[SCALE + SLIP]) if i == STOP else w[REACHED + i]
            at = RESIDUAL if i == guard else VIOLATION
            if size > 0.0:
                w[at] = max(w[at], -value / size)


def close_step(guard: int, stop: float, w: Vector, whole: Vector) -> None:
    """Move time and state to the end of the step.

    Reads: TIME, VIOLATION, RESIDUAL, FRACTION, LENGTH, Y1, SCALE, DENSE, REACHED, MODE, FLAGS.
    Writes: TIME, VIOLATION, RESIDUAL, Y, SCALE, VALUES.

    Parameters
    ----------
    guard : int
        Index of the guard that ended the step, or `NO_GUARD`.
    stop : float
        Time at which the piece of the drives ends [s]; an end within rounding of it is put onto it.
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole-numbered state of the run.
    """
    share = w[FRACTION]
    h = w[LENGTH]
    end = w[TIME] + share * h
    if guard == NO_GUARD:
        for i in range(N_STATES):
            w[Y + i] = w[Y1 + i]
        if abs(stop - end) <= ROUNDING * max(abs(stop), abs(h)):
            end = stop
    else:
        interpolate(w, share, Y)
    for i in range(N_STATES):
        w[SCALE + i] = max(w[SCALE + i], abs(w[Y + i]))
    w[TIME] = end
    if share > 0.0:
        audit(guard, w, whole)
