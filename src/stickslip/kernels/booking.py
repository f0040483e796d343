"""The books of a run: rows of steps, work done, violations found."""

from stickslip.kernels.codes import STOP
from stickslip.kernels.dense import TERMS, interpolate
from stickslip.kernels.model import N_GUARDS, N_STATES, SLIP, power
from stickslip.kernels.roots import NO_GUARD, SAMPLES, guard_values
from stickslip.kernels.state import (
    DENSE_AT,
    FLAGS,
    MODE,
    PIECE,
    RESIDUAL,
    ROUNDING,
    ROW_COLUMNS,
    STATE_AT,
    STEPS,
    SUPPLIED,
    TAKEN,
    TIME,
    VIOLATION,
)
from stickslip.kernels.tier import Vector

__all__ = ["add_work", "close_step", "record"]

# Gauss-Legendre nodes and weights on 0 to 1, for the work done in a step
NODES = (
    0.0254460438286207,
    0.12923440720030277,
    0.2970774243113014,
    0.5,
    0.7029225756886985,
    0.8707655927996972,
    0.9745539561713793,
)
WEIGHTS = (
    0.06474248308443487,
    0.13985269574463843,
    0.19091502525255935,
    0.20897959183673465,
    0.19091502525255935,
    0.13985269574463843,
    0.06474248308443487,
)


def add_work(
    t: float,
    h: float,
    share: float,
    y: Vector,
    real: Vector,
    whole: Vector,
    p: Vector,
    dense: Vector,
    point: Vector,
    values: Vector,
) -> None:
    """Add the work done in a share of a step."""
    for node in range(len(NODES)):
        x = share * NODES[node]
        interpolate(y, dense, x, point)
        power(int(whole[MODE]), int(whole[FLAGS]), t + x * h, point, p, values)
        real[SUPPLIED] += share * h * WEIGHTS[node] * values[0]
        real[TAKEN] += share * h * WEIGHTS[node] * values[1]


def record(
    log: Vector, t: float, end: float, h: float, y: Vector, dense: Vector, whole: Vector
) -> None:
    """Write one row of the log."""
    at = int(whole[STEPS]) * ROW_COLUMNS
    log[at] = t
    log[at + 1] = end
    log[at + 2] = h
    log[at + 3] = whole[MODE]
    log[at + 4] = whole[FLAGS]
    log[at + 5] = whole[PIECE]
    for i in range(N_STATES):
        log[at + STATE_AT + i] = y[i]
    for i in range(TERMS * N_STATES):
        log[at + DENSE_AT + i] = dense[i]
    whole[STEPS] += 1


def audit(
    guard: int,
    t: float,
    y: Vector,
    real: Vector,
    whole: Vector,
    p: Vector,
    scale: Vector,
    samples: Vector,
    values: Vector,
    reached: Vector,
) -> None:
    """Note how far guards are violated at the end of a step, relative to their largest size yet."""
    guard_values(int(whole[MODE]), int(whole[FLAGS]), t, y, p, scale, values)
    for i in range(N_GUARDS):
        # a step may be a rounding long, and what it sees no measure of anything
        for s in range(SAMPLES + 1):
            reached[i] = max(reached[i], abs(samples[s * N_GUARDS + i]))
        size = max(reached[i], scale[SLIP]) if i == STOP else reached[i]
        if values[i] < 0.0 and size > 0.0:
            at = RESIDUAL if i == guard else VIOLATION
            real[at] = max(real[at], -values[i] / size)


def close_step(
    guard: int,
    stop: float,
    y: Vector,
    real: Vector,
    whole: Vector,
    p: Vector,
    work: tuple[Vector, ...],
    buffers: tuple[Vector, ...],
) -> None:
    """Move time and state to the end of the step."""
    y1, scale, dense = work[1], work[3], work[7]
    point, found, samples, values, reached = buffers
    share, h = found[0], found[1]
    end = real[TIME] + share * h
    if guard == NO_GUARD:
        for i in range(N_STATES):
            point[i] = y1[i]
        if abs(stop - end) <= ROUNDING * max(abs(stop), abs(h)):
            end = stop
    else:
        interpolate(y, dense, share, point)
    for i in range(N_STATES):
        y[i] = point[i]
        scale[i] = max(scale[i], abs(point[i]))
    real[TIME] = end
    if share > 0.0:
        audit(guard, end, y, real, whole, p, scale, samples, values, reached)
