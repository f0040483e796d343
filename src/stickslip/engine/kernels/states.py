"""States of laws along given motions: bristles by the step.

Along a motion that is known, velocity and inputs are constant in a step, and each state z of a law
follows by the law's own formula, or from its rate r(z) by exponential Rosenbrock steps of order 3
(exprb32; Hochbruck and Ostermann, Acta Numerica 19, 2010), which are exact where r is linear in z.
An error above `TOLERANCE` cuts the step into equal parts, the same for all copies of a law, so that
slopes are differences between them.
"""

import math

from stickslip.engine.kernels.backend import Vector

# States of a law along a motion, one step after the other: compiled beside the law's equations.
#
# A vector ``w`` holds what these read: duration, velocity, load and contact inputs of a step, the
# parameters of one copy of the law, its states, and whether its latched switches are on.

TOLERANCE = 1e-3
"""Error of a step over the largest deflection: below the noise of any force, and forgotten with the
next reversal."""
MOST_PARTS = 8
"""Parts that a step between two samples is cut into at most."""
REACH = 0.5
"""Way that a part may go over the largest deflection, where bristles come to yield all of a sudden
and slopes say nothing about the error."""
NUDGE = 1e-7
"""Share of the largest deflection by which bristles are moved for slopes."""
MARGIN = 1e-6
"""Share of the way at the first rate by which rounding may exceed it."""
SEEN = 1e-5
"""Error over the largest deflection that rounding of slopes does not make."""
STILL = 1e-10
"""Rate over the first one that is none."""
SERIES = 0.05
"""Argument below which the functions of the exponential are summed as series."""
LEAST = 1e-300
"""What keeps quotients finite, and nothing else."""


def move(w: Vector) -> None:
    """Move the states by the law's own formula, and turn its switches; written for each law."""
    raise NotImplementedError


def rate(z: float, w: Vector) -> float:
    """Return the rate of a single state; written for each law."""
    raise NotImplementedError


def by_formula(
    columns: int,
    parameters: int,
    states: int,
    flags: int,
    steps: int,
    copies: int,
    motion: Vector,
    p: Vector,
    out: Vector,
    w: Vector,
) -> None:
    """Write states (states, steps + 1, copies), of which the first ones are there."""
    first = columns + parameters
    for c in range(copies):
        for j in range(parameters):
            w[columns + j] = p[c * parameters + j]
        for j in range(states):
            w[first + j] = out[j * (steps + 1) * copies + c]
        for j in range(flags):
            w[first + states + j] = 0.0
        for i in range(steps):
            for j in range(columns):
                w[j] = motion[i * columns + j]
            move(w)
            for j in range(states):
                out[(j * (steps + 1) + i + 1) * copies + c] = w[first + j]


def by_rates(
    columns: int,
    parameters: int,
    steps: int,
    copies: int,
    motion: Vector,
    p: Vector,
    out: Vector,
    w: Vector,
) -> None:
    """Write a single state (steps + 1, copies), of which the first ones are there.

    All copies take the same parts of a step: slopes are differences between them.
    """
    size, parts = 0.0, 1
    for c in range(copies):
        size = max(size, abs(out[c]))
    for i in range(steps):
        for j in range(columns):
            w[j] = motion[i * columns + j]
        parts = max(1, parts - 1)
        while True:
            worst, largest = 0.0, size
            for c in range(copies):
                for j in range(parameters):
                    w[columns + j] = p[c * parameters + j]
                z, error = stepped(out[i * copies + c], parts, size, w)
                out[(i + 1) * copies + c] = z
                worst, largest = max(worst, error), max(largest, abs(z))
            size = largest
            if not (worst > TOLERANCE * size) or parts >= MOST_PARTS:
                break
            more = 1.1 * parts * math.pow(worst / (TOLERANCE * size), 1.0 / 3.0)
            parts = min(max(math.ceil(min(more, 1.0 * MOST_PARTS)), parts + 1), MOST_PARTS)


def stepped(z: float, parts: int, size: float, w: Vector) -> tuple[float, float]:
    """Return the state after a step in equal parts, and the largest error.

    Exponential Rosenbrock steps of order 3 (exprb32, doi:10.1017/S0962492910000048): exact for laws
    that are linear in the deflection, such as LuGre's and Dahl's, and stable however many
    presliding lengths a step crosses.
    """
    h, worst = w[0] / parts, 0.0
    for _ in range(parts):
        f = rate(z, w)
        nudge = NUDGE * max(abs(z), max(size, abs(h * f)) + LEAST)
        slope = (rate(z + nudge, w) - f) / nudge
        x = min(h * slope, 50.0)
        if abs(x) < SERIES:
            phi_3 = (1.0 + x / 4.0 * (1.0 + x / 5.0 * (1.0 + x / 6.0 * (1.0 + x / 7.0)))) / 6.0
            phi_1 = 1.0 + x * (0.5 + x * phi_3)
        else:
            phi_1 = (math.exp(x) - 1.0) / x
            phi_3 = ((phi_1 - 1.0) / x - 0.5) / x
        there = z + h * phi_1 * f
        result = rate(there, w)
        rest = result - f - slope * (there - z)
        correction = 2.0 * h * phi_3 * rest
        new, error = there + correction, abs(correction)
        if result * f <= 0.0 and error > SEEN * size:  # it comes to yield all of a sudden
            limit = REACH * max(size, 1e-3 * abs(h * f), LEAST)
            error = TOLERANCE * size * math.pow(abs(h * f) / limit, 3.0)
            # ten times the way that is left: arrived, whatever the slopes promise
            share = 0.0 if f == 0.0 else (new - z) / (h * f)
            if abs(h * f) > 10.0 * size or not (-MARGIN <= share <= 1.0 + MARGIN):
                new = there
        z, worst = held_back(z, f, new, w), max(worst, error)
    return z, worst


def held_back(z: float, f: float, new: float, w: Vector) -> float:
    """Return a step that does not cross the deflection at which the rate is zero.

    At constant velocity no solution does, but a step may where the law yields all of a sudden, as
    Dahl's does with an exponent below 1.
    """
    f_high = rate(new, w)
    if not (f_high * f < 0.0 and abs(new - z) > 1e-9 * abs(z)):
        return new
    low, high, f_low, middle = z, new, f, new
    for _ in range(40):
        spread = f_high - f_low
        middle = high - f_high * (high - low) / (1.0 if spread == 0.0 else spread)
        f_middle = rate(middle, w)
        # the rate of a law that is linear in the deflection is 0 after one step, but for rounding
        result = abs(f_middle) <= STILL * abs(f)
        # Illinois: the end that stays counts half
        if f_middle * f > 0.0:
            low, f_low, f_high = middle, f_middle, 0.5 * f_high
            if result:
                high = middle
        else:
            high, f_high, f_low = middle, f_middle, 0.5 * f_low
            if result:
                low = middle
        if abs(high - low) - 1e-10 * abs(new) <= 0.0:
            break
    return middle
