"""The books of a run: rows of steps, work done, violations found."""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.dense_output import interpolate
from stickslip.kernels.enums import STOP
from stickslip.kernels.gauss_legendre import FEW_NODES, FEW_WEIGHTS, NODES, WEIGHTS
from stickslip.kernels.guard_roots import CLOCK, NO_GUARD, guard_at, guard_size, guard_values
from stickslip.kernels.model_interface import power
from stickslip.kernels.questions import BOOK, MOTION, ask_here
from stickslip.kernels.state_layout import (
    DENSE,
    FLAGS,
    FRACTION,
    GROSS,
    LAW_FLAGS,
    LENGTH,
    MODE,
    MODES,
    N_CONTACTS,
    N_GUARDS,
    N_PAIRS,
    N_STATES,
    OPEN,
    PIECE,
    POINT,
    RESIDUAL,
    ROUNDING,
    ROW_COLUMNS,
    ROW_DENSE,
    SCALE,
    SLIP,
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

NOTABLE = 1e-10
"""Share of its largest size by which a guard is violated more than the dense output's rounding."""
FEW_TERMS = 6
"""A series that ends so early is that of a very short step, over which few nodes do."""


def add_work(w: Vector, whole: Wholes) -> None:
    """Add the work done in the part of the step that holds."""
    point = whole[POINT]
    values = whole[VALUES]
    share = w[FRACTION]
    h = w[LENGTH]
    if whole[N_CONTACTS] > 0:
        ask_here(BOOK, w, whole)
        return
    terms = w[whole[DENSE]]
    few = 0.0 < terms <= FEW_TERMS or terms < 0.0
    supplied, taken, gross = 0.0, 0.0, 0.0
    for node in range(len(FEW_NODES) if few else len(NODES)):
        x = share * (FEW_NODES[node] if few else NODES[node])
        interpolate(w, whole, x, point)
        power(w[TIME] + x * h, w, whole, point, values)
        weight = share * h * (FEW_WEIGHTS[node] if few else WEIGHTS[node])
        supplied += weight * w[values]
        taken += weight * w[values + 1]
        gross += weight * (abs(w[values]) + abs(w[values + 1]))
    w[SUPPLIED] += supplied
    w[TAKEN] += taken
    w[GROSS] += gross


def record(log: Vector, end: float, w: Vector, whole: Wholes) -> None:
    """Write one row of the log."""
    dense = whole[DENSE]
    n = whole[N_STATES]
    at = whole[STEPS] * whole[ROW_COLUMNS]
    log[at] = w[TIME]
    log[at + 1] = end
    log[at + 2] = w[LENGTH]
    log[at + 3] = whole[MODE]
    log[at + 4] = whole[FLAGS]
    log[at + 5] = whole[PIECE]
    terms = 0 if w[dense] > 0.0 else TERMS
    for i in range(1 + (terms + 1) * n):
        log[at + ROW_DENSE + i] = w[dense + i]
    if whole[N_CONTACTS] > 0:
        note_modes(at + whole[ROW_COLUMNS], log, whole)
    whole[STEPS] += 1


def note_modes(end: int, log: Vector, whole: Wholes) -> None:
    """Write modes, flags and openings to the end of a row that ends before a place."""
    n, contacts = whole[N_PAIRS], whole[N_CONTACTS]
    at = end - n - 2 * contacts
    for i in range(n):
        log[at + i] = whole[whole[MODES] + i]
    for c in range(contacts):
        log[at + n + c] = whole[whole[LAW_FLAGS] + c]
        log[at + n + contacts + c] = whole[whole[OPEN] + c]


def audit(guard: int, start: float, w: Vector, whole: Wholes) -> None:
    """Note how far guards are violated at the end of a step, relative to their largest size yet.

    A steep guard may fall far between two ticks of the clock: what counts is where it was a tick
    before.
    """
    values, h = whole[VALUES], w[LENGTH]
    guard_values(w[TIME], w, whole, whole[Y], values)
    for i in range(whole[N_GUARDS]):
        value = w[values + i]
        if value < 0.0:
            size = guard_size(i, w, whole)
            if i == STOP and whole[N_CONTACTS] == 0:
                size = max(size, w[whole[SCALE] + whole[SLIP]])
            if value < -NOTABLE * size:
                before = max(0.0, w[FRACTION] - CLOCK * max(1.0, w[TIME] / h))
                value = min(0.0, max(value, guard_at(i, before, start, h, w, whole)))
                guard_values(w[TIME], w, whole, whole[Y], values)
            at = RESIDUAL if i == guard else VIOLATION
            if size > 0.0:
                w[at] = max(w[at], -value / size)


def close_step(guard: int, stop: float, w: Vector, whole: Wholes) -> None:
    """Move time and state to the end of the step."""
    n = whole[N_STATES]
    y = whole[Y]
    y1 = whole[Y1]
    scale = whole[SCALE]
    share = w[FRACTION]
    h = w[LENGTH]
    start = w[TIME]
    end = start + share * h
    if guard == NO_GUARD:
        for i in range(n):
            w[y + i] = w[y1 + i]
        if abs(stop - end) <= ROUNDING * max(abs(stop), abs(h)):
            end = stop
    else:
        interpolate(w, whole, share, y)
    for i in range(n):
        w[scale + i] = max(w[scale + i], abs(w[y + i]))
    if whole[N_CONTACTS] > 0:
        ask_here(MOTION, w, whole)
    w[TIME] = end
    if share > 0.0:
        audit(guard, start, w, whole)
