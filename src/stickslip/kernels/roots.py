"""Where inside a step a guard is first violated."""

import math

from stickslip.kernels.codes import STOP
from stickslip.kernels.dense import interpolate
from stickslip.kernels.model import HAS_BRISTLES, N_GUARDS, SLIP, guards
from stickslip.kernels.tier import Vector, vector

__all__ = ["NOT_ARMED", "NO_GUARD", "SAMPLES", "first_violation", "guard_values"]

NO_GUARD = -1
NOT_ARMED = -2
SAMPLES = 8
QUIET = 1e-12
"""Share of the largest speed so far below which a reversal of a bristle law is left unnoticed.

The fields of both directions agree there to rounding, and a body that creeps to rest would else
reverse with every rounding error.
"""
GOLDEN = 0.6180339887498949
TINY = 2.220446049250313e-16


def guard_values(
    mode: int, flags: int, t: float, y: Vector, p: Vector, scale: Vector, out: Vector
) -> None:
    """Evaluate the guards, with the quiet zone of bristle laws."""
    guards(mode, flags, t, y, p, out)
    if HAS_BRISTLES and mode != 0:
        out[STOP] += QUIET * scale[SLIP]


def guard_at(
    guard: int,
    x: float,
    mode: int,
    flags: int,
    t: float,
    h: float,
    y0: Vector,
    dense: Vector,
    p: Vector,
    scale: Vector,
    point: Vector,
    values: Vector,
) -> float:
    """Return one guard at a fraction of the step."""
    interpolate(y0, dense, x, point)
    guard_values(mode, flags, t + x * h, point, p, scale, values)
    return values[guard]


def bisect(
    guard: int,
    low: float,
    high: float,
    mode: int,
    flags: int,
    t: float,
    h: float,
    y0: Vector,
    dense: Vector,
    p: Vector,
    scale: Vector,
    point: Vector,
    values: Vector,
) -> float:
    """Return the fraction just past a sign change, by the ITP method (Oliveira, Takahashi 2021)."""
    f_low = guard_at(guard, low, mode, flags, t, h, y0, dense, p, scale, point, values)
    f_high = guard_at(guard, high, mode, flags, t, h, y0, dense, p, scale, point, values)
    epsilon = max(TINY, TINY * abs(t) / abs(h))
    width = high - low
    limit = math.ceil(math.log2(max(width / epsilon, 1.0))) + 1
    for trial in range(limit + 1):
        middle = 0.5 * (low + high)
        if high - low <= 2.0 * epsilon:
            break
        radius = max(epsilon * 2.0 ** (limit - trial) - 0.5 * (high - low), 0.0)
        secant = (f_high * low - f_low * high) / (f_high - f_low)
        side = 1.0 if middle > secant else -1.0
        push = 0.2 / width * (high - low) ** 2
        x = middle if push > abs(middle - secant) else secant + side * push
        if abs(x - middle) > radius:
            x = middle - side * radius
        x = min(max(x, low + 0.5 * epsilon), high - 0.5 * epsilon)
        value = guard_at(guard, x, mode, flags, t, h, y0, dense, p, scale, point, values)
        if value < 0.0:
            high = x
            f_high = value
        else:
            low = x
            f_low = value
    return high


def dip(
    guard: int,
    low: float,
    high: float,
    mode: int,
    flags: int,
    t: float,
    h: float,
    y0: Vector,
    dense: Vector,
    p: Vector,
    scale: Vector,
    point: Vector,
    values: Vector,
) -> float:
    """Return a fraction between where the guard is negative, or -1 if its minimum is not."""
    a = high - GOLDEN * (high - low)
    b = low + GOLDEN * (high - low)
    f_a = guard_at(guard, a, mode, flags, t, h, y0, dense, p, scale, point, values)
    f_b = guard_at(guard, b, mode, flags, t, h, y0, dense, p, scale, point, values)
    for _ in range(40):
        if f_a < 0.0:
            return a
        if f_b < 0.0:
            return b
        if f_a < f_b:
            high = b
            b = a
            f_b = f_a
            a = high - GOLDEN * (high - low)
            f_a = guard_at(guard, a, mode, flags, t, h, y0, dense, p, scale, point, values)
        else:
            low = a
            a = b
            f_a = f_b
            b = low + GOLDEN * (high - low)
            f_b = guard_at(guard, b, mode, flags, t, h, y0, dense, p, scale, point, values)
    return -1.0


def bracket(
    guard: int,
    mode: int,
    flags: int,
    t: float,
    h: float,
    y0: Vector,
    dense: Vector,
    p: Vector,
    scale: Vector,
    samples: Vector,
    point: Vector,
    values: Vector,
    ends: Vector,
) -> int:
    """Look for a first sign change of one guard among the samples.

    Returns the guard with its bracket in `ends`, NO_GUARD, or NOT_ARMED for a guard that starts at
    zero and never becomes positive although it ends negative.
    """
    armed = samples[guard] > 0.0
    for s in range(1, SAMPLES + 1):
        value = samples[s * N_GUARDS + guard]
        before = samples[(s - 1) * N_GUARDS + guard]
        if armed and value < 0.0:
            ends[0] = (s - 1) / SAMPLES
            ends[1] = s / SAMPLES
            return guard
        if armed and s > 1:
            earlier = samples[(s - 2) * N_GUARDS + guard]
            # a minimum lies near `before`, and it is low enough to matter
            if before <= value and before < earlier and 4.0 * before < earlier + value:
                low = (s - 2) / SAMPLES
                x = dip(
                    guard, low, s / SAMPLES, mode, flags, t, h, y0, dense, p, scale, point, values
                )
                if x >= 0.0:
                    ends[0] = low
                    ends[1] = x
                    return guard
        armed = armed or value > 0.0
    if not armed and samples[SAMPLES * N_GUARDS + guard] < 0.0:
        return NOT_ARMED
    return NO_GUARD


def first_violation(
    mode: int,
    flags: int,
    t: float,
    h: float,
    y0: Vector,
    dense: Vector,
    p: Vector,
    scale: Vector,
    buffers: tuple[Vector, ...],
) -> int:
    """Find the first violated guard of a step.

    Returns its index with the fraction in ``found[0]``. ``found[1]`` is 1 where the guard was never
    armed, and the fraction then 0.
    """
    point, found, samples, values, _ = buffers
    for s in range(SAMPLES + 1):
        interpolate(y0, dense, s / SAMPLES, point)
        guard_values(mode, flags, t + s / SAMPLES * h, point, p, scale, values)
        for guard in range(N_GUARDS):
            samples[s * N_GUARDS + guard] = values[guard]
    best = NO_GUARD
    found[0] = 1.0
    found[1] = 0.0
    ends = vector(2)
    for guard in range(N_GUARDS):
        outcome = bracket(
            guard, mode, flags, t, h, y0, dense, p, scale, samples, point, values, ends
        )
        if outcome == NOT_ARMED:
            found[0] = 0.0
            found[1] = 1.0
            return guard
        if outcome >= 0 and ends[0] < found[0]:
            x = bisect(
                guard, ends[0], ends[1], mode, flags, t, h, y0, dense, p, scale, point, values
            )
            if x < found[0] or best == NO_GUARD:
                found[0] = x
                best = guard
    return best
