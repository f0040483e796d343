"""Which stepper a mode takes: its exact series, DOP853, or Rodas5P where it is stiff."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.enums import EXACT, SMOOTH, STIFF
from stickslip.kernels.error_scale import size_of
from stickslip.kernels.model_interface import jacobian, linear
from stickslip.kernels.rodas5p import rodas_step
from stickslip.kernels.state_layout import (
    DENSE,
    HAS_BRISTLES,
    MATRIX,
    MODE,
    N_CONTACTS,
    N_COORDINATES,
    N_STATES,
    N_VARIABLES,
    PULLS,
    SCALE,
    SLIP,
    SLOW,
    STEP,
    STEPPER,
    TIME,
    VALUES,
    Y1,
    Y,
)

FIRST_SHARE = 1e-3
"""First step of a run over the time to its first stop, before errors tell."""
PROBE = 1e-3
"""Stretch of time, over that to the next stop, that tells the sizes of states at rest."""
PROBES = 8
"""Stretches that are tried, each shorter by the same factor."""
PROBED = 1e-9
"""Size of a state over its change in that stretch, at least."""
BEYOND_HALF = 1e6
"""Change of a state in that stretch, over that in half of it, beyond which neither tells its size:
friction may grow exponentially at speeds against the mode, which stages of long steps reach."""
BLURRED = 4e4
"""Time over that stretch at which its rounding blurs all that a growing load does in it.

What tolerates less than the rounding of the time takes short steps until the state is larger.
"""
SLOW_CHANGE = 0.01
"""Change of every state in a step, over its size, that is slow."""
SLOW_STEPS = 15
"""Steps in a row that damping keeps short although all is slow, after which a mode is stiff; as
many as in the test of stiffness in Hairer's DOP853."""


def choose_stepper(stop: float, w: Vector, whole: Wholes) -> None:
    """Choose for the mode that begins."""
    values = whole[VALUES]
    whole[SLOW] = 0
    if whole[N_CONTACTS] == 0 and whole[HAS_BRISTLES] and abs(whole[MODE]) == 1:
        whole[STEPPER] = STIFF
    else:
        linear(w[TIME], w, whole, whole[Y], values)
        others = STIFF if whole[N_CONTACTS] > 0 and whole[HAS_BRISTLES] else SMOOTH
        whole[STEPPER] = EXACT if w[values] > 0.0 else others
    if whole[STEPPER] != EXACT:
        if whole[N_CONTACTS] == 0:
            probe_sizes(stop, w, whole)
        if not stop + w[STEP] > stop:  # none yet, or one left over from an event soon after 0
            w[STEP] = FIRST_SHARE * (stop - w[TIME])


def note_pulls(w: Vector, whole: Wholes) -> None:
    """Note how large the forces are on coordinates that have had no rate yet.

    Where they balance, as those of a spring without tension far from 0 do, what is left of them as
    others begin to move is no more than their rounding for a while.
    """
    n, coordinates, slopes = whole[N_STATES], whole[N_COORDINATES], whole[MATRIX]
    jacobian(w[TIME], w, whole, whole[Y], slopes)
    for i in range(coordinates):
        rate = coordinates + i
        w[whole[PULLS] + i] = 0.0
        if w[whole[SCALE] + rate] == 0.0:
            for j in range(n):
                w[whole[PULLS] + i] += abs(w[slopes + rate * n + j] * w[whole[Y] + j])


def probe_sizes(stop: float, w: Vector, whole: Wholes) -> None:
    """Give a size to states that have none yet: a small part of what a first stretch brings.

    What is at rest begins as a power of time, which no relative error control gets started.
    """
    n = whole[N_STATES]
    scale = whole[SCALE]
    y1 = whole[Y1]
    slip = whole[SLIP]
    y = whole[Y]
    mode = whole[MODE]
    half = whole[DENSE]
    missing = False
    for i in range(n):
        missing = missing or w[scale + i] == 0.0
    if missing:
        note_pulls(w, whole)
    h = PROBE * (stop - w[TIME])
    trials = 0
    while missing and trials < PROBES and w[TIME] + h > w[TIME]:
        trials += 1
        rodas_step(w[TIME], 0.5 * h, w, whole, 1.0)
        for i in range(n):
            w[half + i] = abs(w[y1 + i] - w[y + i])
        error = rodas_step(w[TIME], h, w, whole, 1.0)
        for i in range(n):
            if w[scale + i] == 0.0 and abs(w[y1 + i] - w[y + i]) > BEYOND_HALF * w[half + i]:
                error = math.inf
        if error <= 1.0 and w[y1 + slip] * whole[MODE] >= 0.0:
            blurred = abs(w[TIME]) / (BLURRED * h)
            share = max(PROBED, min(1.0, blurred * blurred))
            for i in range(n):
                w[scale + i] = max(w[scale + i], share * abs(w[y1 + i] - w[y + i]))
            missing = False
        elif whole[HAS_BRISTLES] and error <= 1.0 and w[y + slip] == 0.0 and whole[MODE] == mode:
            whole[MODE] = -mode  # what leads to the body tells only later which way it is drawn
        else:
            h *= PROBE
            whole[MODE] = mode
    whole[MODE] = mode


def watch_stiffness(h: float, w: Vector, whole: Wholes) -> None:
    """Go over to Rodas5P where steps stay short for the sake of a motion that has died away.

    Less the trace of the Jacobian, at the start of the step, is the sum of all dampings. It is
    asked for only where nothing changes much.
    """
    if whole[N_CONTACTS] > 0 and whole[N_VARIABLES] == 0:
        return  # there are no slopes, for nothing dies away
    y1 = whole[Y1]
    y = whole[Y]
    n = whole[N_STATES]
    slow = True
    for i in range(n):
        change = abs(w[y1 + i] - w[y + i])
        slow = slow and change <= SLOW_CHANGE * size_of(i, 0.0, w, whole)
    if slow:
        slow = h * damping_of(w, whole) > 1.0
    whole[SLOW] = whole[SLOW] + 1 if slow else 0
    if whole[SLOW] > SLOW_STEPS:
        whole[STEPPER] = STIFF
        w[STEP] = h


def damping_of(w: Vector, whole: Wholes) -> float:
    """Return the sum of all rates at which motions die away, less those at which others grow.

    The series of one contact has the Jacobian at hand.
    """
    matrix, n = whole[MATRIX], whole[N_STATES]
    if whole[STEPPER] != EXACT or whole[N_CONTACTS] > 0:
        jacobian(w[TIME], w, whole, whole[Y], matrix)
    damping = 0.0
    for i in range(n):
        damping -= w[matrix + i * n + i]
    return damping
