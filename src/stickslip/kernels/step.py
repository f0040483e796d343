"""One step: as long as accuracy allows, up to the first event."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.dop853 import dop853_dense, dop853_step
from stickslip.kernels.enums import EXACT, STEP_TOO_SMALL, STIFF
from stickslip.kernels.error_scale import VANISHED
from stickslip.kernels.guard_roots import (
    EARLY,
    NEGLIGIBLE,
    NO_GUARD,
    coarseness,
    first_violation,
    guard_size,
    is_held,
    is_speed,
    note_sizes,
    reverses,
    rises,
    stays,
)
from stickslip.kernels.hard_stops import approach
from stickslip.kernels.linear_events import first_crossing
from stickslip.kernels.questions import CROSSING, SERIES_STEP, ask_here, ask_of
from stickslip.kernels.rodas5p import rodas_dense, rodas_step
from stickslip.kernels.state_layout import (
    DENSE,
    FIRST_LIMIT,
    FIRST_WALL,
    FRACTION,
    HELD_STRIDE,
    LENGTH,
    MODE,
    N_CONTACTS,
    N_SWITCHES,
    POLYNOMIAL,
    REJECTED,
    RHYTHM,
    SAMPLED,
    SERIES,
    STATUS,
    STEP,
    STEPPER,
    STEPS,
    STRIDE,
    TIME,
    VALUES,
    Y,
)
from stickslip.kernels.stepper_selection import watch_stiffness
from stickslip.kernels.taylor_series import series_step

OVERSHOT = 0.98
"""A step is taken again if the event lies before this part of it."""
BEYOND = 1.002
"""Length of the new step over the time to the event, so that the event lies at its end."""
STRETCH = 1.01
"""A step that nearly reaches the end of a piece is stretched to it. STRETCH x BEYOND x OVERSHOT is
below 1: a step taken again up to an event must not be stretched back."""
AHEAD = 3.0
"""Length of a series over that of steps that end with an event: a shorter one ends earlier, and
fewer guards have falls in it."""
GROWTH = tuple(
    math.inf if terms < 4 else max(1.0, (VANISHED * math.factorial(terms)) ** (-1.0 / terms))
    for terms in range(SERIES + 1)
)
"""How much longer a step may be than one whose series has ended after so many terms, as that of an
exponential would. A shorter series is a polynomial, which ends at any length."""
TINIEST = 1e-18
"""Length of a step, over the end of the piece, below which no shorter one is tried."""
BOUNCE = 1e-3
"""Fraction of a series below which an impact is looked for in a shorter one."""


def attempt(h: float, w: Vector, whole: Wholes, rtol: float) -> float:
    """Try a step with the mode's stepper, fill its dense output if it is good enough."""
    y = whole[Y]
    t = w[TIME]
    if whole[STEPPER] == EXACT:
        if whole[N_CONTACTS] > 0:
            ask_of(SERIES_STEP, h, w, whole, y, whole[VALUES])
            return w[whole[VALUES]]
        return series_step(t, h, w, whole, y)
    if whole[STEPPER] == STIFF:
        error = rodas_step(t, h, w, whole, rtol)
        if error <= 1.0:
            rodas_dense(w, whole)
        return error
    error = dop853_step(t, h, w, whole, rtol)
    if error <= 1.0:
        dop853_dense(t, h, w, whole)
    return error


def resized(h: float, error: float, w: Vector, whole: Wholes) -> float:
    """Return the next step length for an error over the tolerance."""
    if whole[STEPPER] == EXACT:
        if error == 0.0:
            return h * GROWTH[int(w[whole[DENSE]])]
        # the tail goes with h^SERIES; 1e60 and more, or NaN, is cut to what 1e60 gives
        return h * (0.95 * math.pow(error, -1.0 / SERIES) if error < 1e60 else 1e-3)
    if error == 0.0:
        return 10.0 * h
    if not error < 1e30:
        return 0.1 * h
    # powers of h with which the estimates fall; 0.9, 0.2 and 10 are those of DOPRI5
    order = 5.0 if whole[STEPPER] == STIFF else 8.0
    return h * min(10.0, max(0.2, 0.9 * math.pow(error, -1.0 / order)))


def accepted_step(
    stop: float, w: Vector, whole: Wholes, rtol: float, cap: float, slot: int
) -> float:
    """Shorten the step until it is accurate; return its length, 0 if there is none."""
    stepper = whole[STEPPER]
    t = w[TIME]
    h = min(w[slot], cap)
    if stepper == EXACT and whole[N_CONTACTS] > 0:
        h = min(h, AHEAD * w[RHYTHM])
    left = stop - t
    while True:
        last = STRETCH * h >= left
        if last:
            h = left
        elif 2.0 * h > left:  # two equal steps, and no splinter at the end
            h = 0.5 * left
        if not t + h > t:
            whole[STATUS] = STEP_TOO_SMALL
            return 0.0
        error = attempt(h, w, whole, rtol)
        proposed = resized(h, error, w, whole)
        if error <= 1.0:
            # a step cut short by the end of a piece says little of the next one
            w[slot] = max(proposed, w[slot]) if last else proposed
            if stepper != STIFF:
                watch_stiffness(h, w, whole)
            return h
        whole[REJECTED] += 1
        h = proposed


def finer(h: float, slot: int, w: Vector, whole: Wholes) -> float:
    """Return the length with which a step should be taken again, 0 if its samples show the guards.

    Nothing else keeps steps short where a body is held and only its load or the force on it change.
    The next step is no longer than these guards allow.
    """
    t = w[TIME]
    coarse = coarseness(t, h, w, whole)
    if coarse == 0.0:
        return 0.0
    good = h * max(0.1, 0.9 * math.pow(coarse, -0.2)) if coarse < math.inf else 0.1 * h
    if coarse <= 1.0:
        w[slot] = min(w[slot], good)
        return 0.0
    return good if t + good / 8.0 > t else 0.0


def shorter_start(h: float, stop: float, w: Vector) -> float:
    """Return the length with which a step is taken again that falls at its start, 0 if it stands.

    Time 0 has no rounding: what falls at once is believed where a step is a tiny part of the piece.
    """
    return h / 8.0 if w[TIME] + h / 64.0 > w[TIME] and h > TINIEST * stop else 0.0


def retry_length(guard: int, h: float, stop: float, w: Vector, whole: Wholes) -> float:
    """Return the length with which a step should be taken again, 0 if it stands."""
    t = w[TIME]
    fraction = w[FRACTION]
    if guard >= whole[FIRST_WALL] and fraction == 0.0 and approach(guard, w, whole) > 0.0:
        return 0.0  # it is at its stop
    if guard != NO_GUARD and fraction == 0.0 and not reverses(guard, whole):
        return shorter_start(h, stop, w)
    if guard != NO_GUARD and 0.0 < fraction < OVERSHOT:
        if t + 0.25 * fraction * h > t:
            return BEYOND * fraction * h
        # what is at rest begins with the errors that others leave in the dense output, and what is
        # far from its threshold does not fall within the rounding of the time
        begins = w[whole[SAMPLED] + guard]
        if begins == 0.0 or begins > NEGLIGIBLE * guard_size(guard, w, whole):
            return shorter_start(h, stop, w)
    return 0.0


def first_coefficient(w: Vector) -> float:
    """Return the first coefficient of a guard that is not zero, of one that falls at once.

    One that is zero throughout has none, and 0 is returned.
    """
    k = POLYNOMIAL
    while w[k] == 0.0 and k < POLYNOMIAL + SERIES:
        k += 1
    return w[k]


def bounce_length(guard: int, h: float, w: Vector, whole: Wholes) -> float:
    """Return the length with which a series should be taken again, 0 if it stands.

    Fractions are found to rounding of 1, within which a short bounce would be lost. What falls at
    once does so truly if its first coefficient that is not zero, however small, is negative. That
    goes for what begins to slip, too: next to faster or larger motions its own may be too small for
    the step, whose last terms are then its largest.
    """
    fraction = w[FRACTION]
    if whole[N_CONTACTS] > 0 and fraction == 0.0 and is_speed(guard, whole):
        begins = w[POLYNOMIAL] == 0.0 and first_coefficient(w) > 0.0
        shorter = h / 8.0 if begins and h > TINIEST * (w[TIME] + h) else 0.0
    elif guard < whole[FIRST_WALL] or fraction >= BOUNCE:
        shorter = 0.0
    elif fraction == 0.0 and whole[N_CONTACTS] > 0:
        shorter = h / 8.0 if not approach(guard, w, whole) > 0.0 else 0.0
    elif fraction == 0.0:
        shorter = h / 8.0 if not first_coefficient(w) < 0.0 else 0.0
    else:
        shorter = 2.0 * fraction * h
    return shorter if w[TIME] + shorter / 8.0 > w[TIME] else 0.0


def unmoved(guard: int, doubted: int, sought: int, w: Vector, whole: Wholes) -> int:
    """Return the guard that has fallen although the step is too short to move it, or NO_GUARD.

    That is one that fell at once in longer steps, `doubted`, or, as a run begins on its threshold,
    a switch at whose fall the step was to end, `sought`. Another, which begins below zero by
    rounding and rose in longer steps, says nothing in so short a one.
    """
    if guard == NO_GUARD and doubted != NO_GUARD and not rises(doubted, w, whole):
        return doubted
    own = whole[FIRST_LIMIT] - whole[N_SWITCHES] <= sought < whole[FIRST_LIMIT]
    if whole[STEPS] >= EARLY or not own or not (guard == NO_GUARD or w[FRACTION] == 0.0):
        return NO_GUARD
    return sought if stays(sought, w, whole) else NO_GUARD


def advance(stop: float, w: Vector, whole: Wholes, rtol: float, cap: float) -> int:
    """Take one step up to the first event; return the guard that ended it, or NO_GUARD.

    On return FRACTION and LENGTH hold the fraction of the step that holds and its length. A body
    that starts from rest towards a guard that would be violated at once gets shorter steps before
    that is believed; it is, too, where they are so short that the guard does not change at all. A
    step that ends beyond an event is taken again up to just beyond it: the mode's equations, and so
    the error estimate, mean little where the mode does not hold, and the dense output is best where
    the step ends. Neither concerns the series of a linear mode, but for bounces.
    """
    exact = whole[STEPPER] == EXACT
    slot = STEP
    if exact:
        slips = whole[N_CONTACTS] > 0 or abs(whole[MODE]) == 1
        slot = STRIDE if slips else HELD_STRIDE
    before = w[slot]
    doubted, sought = NO_GUARD, NO_GUARD
    while True:
        h = accepted_step(stop, w, whole, rtol, cap, slot)
        if h == 0.0:
            return NO_GUARD
        if exact:
            if whole[N_CONTACTS] > 0:
                guard = ask_here(CROSSING, w, whole)
            else:
                guard = first_crossing(w[TIME], h, w, whole)
            shorter = bounce_length(guard, h, w, whole)
        else:
            guard = first_violation(w[TIME], h, w, whole)
            shorter = finer(h, slot, w, whole) if is_held(whole) else 0.0
            if shorter > 0.0:
                w[slot] = shorter
                continue
            fallen = unmoved(guard, doubted, sought, w, whole)
            if fallen != NO_GUARD:
                guard = fallen
                w[FRACTION] = 0.0
            else:
                shorter = retry_length(guard, h, stop, w, whole)
            if shorter > 0.0:
                doubted = guard if w[FRACTION] == 0.0 else NO_GUARD
                sought = guard if w[FRACTION] > 0.0 else NO_GUARD
        if shorter > 0.0:
            w[slot] = shorter
            continue
        if w[FRACTION] > 0.0 and not exact:
            note_sizes(w, whole)
        w[LENGTH] = h
        if guard != NO_GUARD and w[FRACTION] == 0.0:
            w[slot] = before  # the step was tried in a mode that does not hold
        return guard
