"""The run: steps up to events, events, pieces of the drives, rest, its log, and why it ended.

A step is tried with the length that the last error allows, at most up to the end of the piece of
the drives. Then

1. an error above the tolerance retakes it shorter, and so does a guard that falls right where the
   step begins, until that is believed;
2. a step that ends beyond an event is taken again up to just beyond it, where the equations of the
   mode still mean something, and cut at the event by its dense output; the series of a linear mode
   is cut at once;
3. the step is logged; at an event or a new piece of the drives modes and switches are settled, and
   a stepper is chosen anew.

The run ends at its end time, at a rest that nothing can end, at a limit, or where steps or events
exceed what is allowed.

The log has one row for each step, with all that the dense output of the step needs, the modes and
flags, and the work done; so a recorded run is evaluated at any time by restoring its row.
"""

import math

from stickslip.engine.kernels import equations, guard_roots, mode_transitions, steppers
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector
from stickslip.engine.kernels.numerics import FEW_NODES, FEW_WEIGHTS, NODES, WEIGHTS, interpolate

# The books of a run: rows of steps, work done, violations found.

NOTABLE = 1e-10
"""Share of its largest size by which a guard is violated more than the dense output's rounding."""
FEW_TERMS = 6
"""A series that ends so early is that of a very short step, over which few nodes do."""


def add_work(w: Vector, iw: IntVector) -> None:
    """Add the work done in the part of the step that holds."""
    point = iw[layout.POINT]
    values = iw[layout.VALUES]
    share = w[layout.FRACTION]
    h = w[layout.LENGTH]
    if iw[layout.N_CONTACTS] > 0:
        equations.ask_here(equations.BOOK, w, iw)
        return
    terms = w[iw[layout.DENSE]]
    # A short series and the dense output of Rodas, which is marked below 0, are of low degree: the
    # few nodes integrate them as exactly.
    few = 0.0 < terms <= FEW_TERMS or terms < 0.0
    supplied, taken, gross = 0.0, 0.0, 0.0
    # The nodes lie in the part of the step that holds: beyond an event the dense output is that of
    # a mode which has ended.
    for node in range(len(FEW_NODES) if few else len(NODES)):
        x = share * (FEW_NODES[node] if few else NODES[node])
        interpolate(w, iw, x, point)
        equations.power(w[layout.TIME] + x * h, w, iw, point, values)
        weight = share * h * (FEW_WEIGHTS[node] if few else WEIGHTS[node])
        supplied += weight * w[values]
        taken += weight * w[values + 1]
        # Sizes are added whatever their sign: the energy error is judged against all work that was
        # done, not against what is left of it.
        gross += weight * (abs(w[values]) + abs(w[values + 1]))
    w[layout.SUPPLIED] += supplied
    w[layout.TAKEN] += taken
    w[layout.GROSS] += gross


def record(log: Vector, end: float, w: Vector, iw: IntVector) -> None:
    """Write one row of the log."""
    dense = iw[layout.DENSE]
    n = iw[layout.N_STATES]
    at = iw[layout.STEPS] * iw[layout.ROW_COLUMNS]
    log[at] = w[layout.TIME]
    log[at + 1] = end
    log[at + 2] = w[layout.LENGTH]
    log[at + 3] = iw[layout.MODE]
    log[at + 4] = iw[layout.FLAGS]
    log[at + 5] = iw[layout.PIECE]
    # Of a series the start is enough: its terms follow from the equations again, to the last bit.
    terms = 0 if w[dense] > 0.0 else layout.TERMS
    for i in range(1 + (terms + 1) * n):
        log[at + layout.ROW_DENSE + i] = w[dense + i]
    if iw[layout.N_CONTACTS] > 0:
        note_modes(at + iw[layout.ROW_COLUMNS], log, iw)
    iw[layout.STEPS] += 1


def note_modes(end: int, log: Vector, iw: IntVector) -> None:
    """Write modes, flags and openings to the end of a row that ends before a place."""
    n, contacts = iw[layout.N_PAIRS], iw[layout.N_CONTACTS]
    at = end - n - 2 * contacts
    for i in range(n):
        log[at + i] = iw[iw[layout.MODES] + i]
    for c in range(contacts):
        log[at + n + c] = iw[iw[layout.LAW_FLAGS] + c]
        log[at + n + contacts + c] = iw[iw[layout.OPEN] + c]


def audit(guard: int, start: float, w: Vector, iw: IntVector) -> None:
    """Note how far guards are violated at the end of a step, relative to their largest size yet.

    A steep guard may fall far between two ticks of the clock: what counts is where it was a tick
    before.
    """
    values, h = iw[layout.VALUES], w[layout.LENGTH]
    guard_roots.guard_values(w[layout.TIME], 0.0, w, iw, iw[layout.Y], values)
    for i in range(iw[layout.N_GUARDS]):
        value = w[values + i]
        if value < 0.0:  # what is left of forces that balance is their rounding
            value = min(0.0, value + guard_roots.BALANCED * guard_roots.size_of_balance(i, w, iw))
        if value < 0.0:
            size = guard_roots.guard_size(i, w, iw)
            # The only guard of one contact that is a speed, not a force: its size is kept with the
            # states.
            if i == layout.STOP and iw[layout.N_CONTACTS] == 0:
                size = max(size, w[iw[layout.SCALE] + iw[layout.SLIP]])
            if value < -NOTABLE * size:
                before = max(
                    0.0, w[layout.FRACTION] - guard_roots.CLOCK * max(1.0, w[layout.TIME] / h)
                )
                value = min(0.0, max(value, guard_roots.guard_at(i, before, start, h, w, iw)))
                guard_roots.guard_values(
                    w[layout.TIME], 0.0, w, iw, iw[layout.Y], values
                )  # `guard_at` has overwritten them
            at = layout.RESIDUAL if i == guard else layout.VIOLATION
            if size > 0.0:
                w[at] = max(w[at], -value / size)


def close_step(guard: int, stop: float, w: Vector, iw: IntVector) -> None:
    """Move time and state to the end of the step."""
    n = iw[layout.N_STATES]
    y = iw[layout.Y]
    y1 = iw[layout.Y1]
    scale = iw[layout.SCALE]
    share = w[layout.FRACTION]
    h = w[layout.LENGTH]
    start = w[layout.TIME]
    end = start + share * h
    if guard == guard_roots.NO_GUARD:
        if w[layout.SPARE] > 0.0:
            guard_roots.forget_spare(w, iw)
        # The stepper's own result, which the dense output repeats only to rounding.
        for i in range(n):
            w[y + i] = w[y1 + i]
        # The end of a piece is met to the last bit: by the time the next piece of the drives is
        # chosen.
        if abs(stop - end) <= layout.ROUNDING * max(abs(stop), abs(h)):
            end = stop
    else:
        interpolate(w, iw, share, y)
    for i in range(n):
        w[scale + i] = max(w[scale + i], abs(w[y + i]))
    if iw[layout.N_CONTACTS] > 0:
        equations.ask_here(equations.MOTION, w, iw)
    w[layout.TIME] = end
    if share > 0.0:
        audit(guard, start, w, iw)


# A recorded run at any times: its rows hold all that is needed.


def row_at(log: Vector, count: int, t: float, iw: IntVector) -> int:
    """Return the last row that begins at or before a time."""
    width = iw[layout.ROW_COLUMNS]
    low = 0
    high = count
    # Row `low` begins at or before the time, row `high` after it, or it is the end of the log.
    while high - low > 1:
        middle = (low + high) // 2
        if log[middle * width] <= t:
            low = middle
        else:
            high = middle
    return low


def piece_at(table: Vector, first: int, t: float, iw: IntVector) -> int:
    """Return the piece of the drives that holds at a time, `first` or a later one."""
    width = 1 + 3 * iw[layout.N_DRIVES]
    piece = first
    while (piece + 1) * width < len(table) and table[(piece + 1) * width] <= t:
        piece += 1
    return piece


def restore_modes(end: int, log: Vector, w: Vector, iw: IntVector) -> None:
    """Bring back the modes, flags and openings of a row that ends before a place."""
    n, contacts = iw[layout.N_PAIRS], iw[layout.N_CONTACTS]
    at = end - n - 2 * contacts
    for i in range(n):
        iw[iw[layout.MODES] + i] = int(log[at + i])
    for c in range(contacts):
        iw[iw[layout.LAW_FLAGS] + c] = int(log[at + n + c])
        iw[iw[layout.OPEN] + c] = int(log[at + n + contacts + c])
    equations.ask_here(equations.RESTORE, w, iw)


def restore_start(log: Vector, row: int, table: Vector, w: Vector, iw: IntVector) -> None:
    """Bring back the start of a row in Y, its mode, and the piece of its drives."""
    n = iw[layout.N_STATES]
    y = iw[layout.Y]
    at = row * iw[layout.ROW_COLUMNS]
    iw[layout.MODE] = int(log[at + 3])
    iw[layout.FLAGS] = int(log[at + 4])
    equations.load_piece(table, int(log[at + 5]), w, iw)
    for i in range(n):
        w[y + i] = log[at + layout.ROW_DENSE + 1 + i]
    if iw[layout.N_CONTACTS] > 0:
        restore_modes(at + iw[layout.ROW_COLUMNS], log, w, iw)


def restore(log: Vector, row: int, table: Vector, w: Vector, iw: IntVector) -> None:
    """Bring back the start of a row in Y, its dense output, mode and piece of the drives."""
    n = iw[layout.N_STATES]
    y = iw[layout.Y]
    dense = iw[layout.DENSE]
    at = row * iw[layout.ROW_COLUMNS]
    restore_start(log, row, table, w, iw)
    # The terms of a series are not kept: the same equations give them again.
    if log[at + layout.ROW_DENSE] > 0.0 and iw[layout.N_CONTACTS] > 0:
        w[layout.TIME] = log[at]
        equations.ask_of(equations.SERIES_FROM, log[at + 2], w, iw, y, 0)
    elif log[at + layout.ROW_DENSE] > 0.0:
        steppers.series_fill(log[at], log[at + 2], w, iw, y)
    else:
        for i in range(1 + (layout.TERMS + 1) * n):
            w[dense + i] = log[at + layout.ROW_DENSE + i]


def play(
    log: Vector,
    count: int,
    times: Vector,
    table: Vector,
    w: Vector,
    iw: IntVector,
    states: Vector,
    forces: Vector,
    rows: Vector,
) -> None:
    """Write states, friction, loads and what else is recorded, and the row, of each of the times.

    A body at rest for good is one row, during which its drives go on.
    """
    width = iw[layout.ROW_COLUMNS]
    point = iw[layout.POINT]
    values = iw[layout.VALUES]
    n = iw[layout.N_STATES]
    columns = iw[layout.N_COLUMNS]
    row = -1
    piece = 0
    equations.put_constants(w, iw)
    if iw[layout.N_CONTACTS] > 0:
        equations.ask(equations.PREPARE, log[0], w, iw)
    for i in range(len(times)):
        t = times[i]
        here = row
        # Times mostly increase: the row at hand is tried before any is searched for.
        if row < 0 or t < log[row * width] or not t < log[row * width + 1]:
            here = row_at(log, count, t, iw)
        at = here * width
        # A body at rest has one row for many pieces. Within it they are gone through onwards from
        # the last one, and from the first one again where times go back.
        if here != row or t < times[i - 1]:
            piece = int(log[at + 5])
        if here != row:
            row = here
            restore(log, row, table, w, iw)
        interpolate(w, iw, (t - log[at]) / log[at + 2], point)
        piece = piece_at(table, piece, t, iw)
        equations.load_piece(table, piece, w, iw)
        equations.recorded(t, w, iw, point, values)
        for j in range(n):
            states[i * n + j] = equations.state_seen(point, j, w, iw)
        for j in range(columns):
            forces[columns * i + j] = w[values + j]
        rows[i] = row


# One step: as long as accuracy allows, up to the first event.

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
    math.inf
    if terms < 4
    else max(1.0, (steppers.VANISHED * math.factorial(terms)) ** (-1.0 / terms))
    for terms in range(layout.SERIES + 1)
)
"""How much longer a step may be than one whose series has ended after so many terms, as that of an
exponential would. A shorter series is a polynomial, which ends at any length."""
TINIEST = 1e-18
"""Length of a step, over the end of the piece, below which no shorter one is tried."""
BOUNCE = 1e-3
"""Fraction of a series below which an impact is looked for in a shorter one."""


def attempt(h: float, w: Vector, iw: IntVector, rtol: float) -> float:
    """Try a step with the mode's stepper, fill its dense output if it is good enough."""
    y = iw[layout.Y]
    t = w[layout.TIME]
    if iw[layout.STEPPER] == layout.EXACT:
        if iw[layout.N_CONTACTS] > 0:
            equations.ask_of(equations.SERIES_STEP, h, w, iw, y, iw[layout.VALUES])
            return w[iw[layout.VALUES]]
        return steppers.series_step(t, h, w, iw, y)
    if iw[layout.STEPPER] == layout.STIFF:
        error = steppers.rodas_step(t, h, w, iw, rtol)
        if error <= 1.0:
            steppers.rodas_dense(w, iw)
        return error
    error = steppers.dop853_step(t, h, w, iw, rtol)
    if error <= 1.0:
        steppers.dop853_dense(t, h, w, iw)
    return error


def resized(h: float, error: float, w: Vector, iw: IntVector) -> float:
    """Return the next step length for an error over the tolerance."""
    if iw[layout.STEPPER] == layout.EXACT:
        if error == 0.0:
            return h * GROWTH[int(w[iw[layout.DENSE]])]
        # the tail goes with h^SERIES; 1e60 and more, or NaN, is cut to what 1e60 gives
        return h * (0.95 * math.pow(error, -1.0 / layout.SERIES) if error < 1e60 else 1e-3)
    if error == 0.0:
        return 10.0 * h
    if not error < 1e30:  # NaN, too
        return 0.1 * h
    # powers of h with which the estimates fall; 0.9, 0.2 and 10 are those of DOPRI5
    order = 5.0 if iw[layout.STEPPER] == layout.STIFF else 8.0
    return h * min(10.0, max(0.2, 0.9 * math.pow(error, -1.0 / order)))


def accepted_step(
    stop: float, w: Vector, iw: IntVector, rtol: float, cap: float, slot: int
) -> float:
    """Shorten the step until it is accurate; return its length, 0 if there is none."""
    stepper = iw[layout.STEPPER]
    t = w[layout.TIME]
    h = min(w[slot], cap)
    if stepper == layout.EXACT and iw[layout.N_CONTACTS] > 0:
        h = min(h, AHEAD * w[layout.RHYTHM])
    left = stop - t
    while True:
        last = STRETCH * h >= left
        if last:
            h = left
        elif 2.0 * h > left:  # two equal steps, and no splinter at the end
            h = 0.5 * left
        # The clock no longer tells the end of the step from its start.
        if not t + h > t:
            iw[layout.STATUS] = layout.STEP_TOO_SMALL
            return 0.0
        error = attempt(h, w, iw, rtol)
        proposed = resized(h, error, w, iw)
        if error <= 1.0:
            # a step cut short by the end of a piece says little of the next one
            w[slot] = max(proposed, w[slot]) if last else proposed
            if stepper != layout.STIFF:
                steppers.watch_stiffness(h, w, iw)
            return h
        iw[layout.REJECTED] += 1
        h = proposed


def finer(h: float, slot: int, w: Vector, iw: IntVector) -> float:
    """Return the length with which a step should be taken again, 0 if its samples show the guards.

    Nothing else keeps steps short where a body is held and only its load or the force on it change.
    The next step is no longer than these guards allow.
    """
    t = w[layout.TIME]
    coarse = guard_roots.coarseness(t, h, w, iw)
    if coarse == 0.0:
        return 0.0
    # Five samples make a polynomial of degree four, from which a guard differs by h^5.
    good = h * max(0.1, 0.9 * math.pow(coarse, -0.2)) if coarse < math.inf else 0.1 * h
    if coarse <= 1.0:
        w[slot] = min(w[slot], good)
        return 0.0
    # samples that the clock cannot tell apart show nothing
    return good if t + good / 8.0 > t else 0.0


def shorter_start(h: float, stop: float, w: Vector) -> float:
    """Return the length with which a step is taken again that falls at its start, 0 if it stands.

    Time 0 has no rounding: what falls at once is believed where a step is a tiny part of the piece.
    """
    return h / 8.0 if w[layout.TIME] + h / 64.0 > w[layout.TIME] and h > TINIEST * stop else 0.0


def retry_length(guard: int, h: float, stop: float, w: Vector, iw: IntVector) -> float:
    """Return the length with which a step should be taken again, 0 if it stands."""
    t = w[layout.TIME]
    fraction = w[layout.FRACTION]
    if (
        guard >= iw[layout.FIRST_WALL]
        and fraction == 0.0
        and mode_transitions.approach(guard, w, iw) > 0.0
    ):
        return 0.0  # it is at its stop
    if guard != guard_roots.NO_GUARD and fraction == 0.0 and not guard_roots.reverses(guard, iw):
        return shorter_start(h, stop, w)
    if guard != guard_roots.NO_GUARD and 0.0 < fraction < OVERSHOT:
        if t + 0.25 * fraction * h > t:
            return BEYOND * fraction * h
        # what is at rest begins with the errors that others leave in the dense output, and what is
        # far from its threshold does not fall within the rounding of the time
        begins = w[iw[layout.SAMPLED] + guard]
        if begins == 0.0 or begins > guard_roots.NEGLIGIBLE * guard_roots.guard_size(guard, w, iw):
            return shorter_start(h, stop, w)
    return 0.0


def first_coefficient(w: Vector) -> float:
    """Return the first coefficient of a guard that is not zero, of one that falls at once.

    One that is zero throughout has none, and 0 is returned.
    """
    k = layout.POLYNOMIAL
    while w[k] == 0.0 and k < layout.POLYNOMIAL + layout.SERIES:
        k += 1
    return w[k]


def bounce_length(guard: int, h: float, w: Vector, iw: IntVector) -> float:
    """Return the length with which a series should be taken again, 0 if it stands.

    Fractions are found to rounding of 1, within which a short bounce would be lost. What falls at
    once does so truly if its first coefficient that is not zero, however small, is negative. That
    goes for what begins to slip, too: next to faster or larger motions its own may be too small for
    the step, whose last terms are then its largest.
    """
    fraction = w[layout.FRACTION]
    if iw[layout.N_CONTACTS] > 0 and fraction == 0.0 and guard_roots.is_speed(guard, iw):
        begins = w[layout.POLYNOMIAL] == 0.0 and first_coefficient(w) > 0.0
        shorter = h / 8.0 if begins and h > TINIEST * (w[layout.TIME] + h) else 0.0
    elif guard < iw[layout.FIRST_WALL] or fraction >= BOUNCE:
        shorter = 0.0
    elif fraction == 0.0 and iw[layout.N_CONTACTS] > 0:
        shorter = h / 8.0 if not mode_transitions.approach(guard, w, iw) > 0.0 else 0.0
    elif fraction == 0.0:
        shorter = h / 8.0 if not first_coefficient(w) < 0.0 else 0.0
    else:
        shorter = 2.0 * fraction * h
    return shorter if w[layout.TIME] + shorter / 8.0 > w[layout.TIME] else 0.0


def unmoved(guard: int, doubted: int, sought: int, w: Vector, iw: IntVector) -> int:
    """Return the guard that has fallen although the step is too short to move it, or NO_GUARD.

    That is one that fell at once in longer steps, `doubted`, or, as a run begins on its threshold,
    a switch at whose fall the step was to end, `sought`. Another, which begins below zero by
    rounding and rose in longer steps, says nothing in so short a one.
    """
    if (
        guard == guard_roots.NO_GUARD
        and doubted != guard_roots.NO_GUARD
        and not guard_roots.rises(doubted, w, iw)
    ):
        return doubted
    own = iw[layout.FIRST_LIMIT] - iw[layout.N_SWITCHES] <= sought < iw[layout.FIRST_LIMIT]
    if (
        iw[layout.STEPS] >= guard_roots.EARLY
        or not own
        or not (guard == guard_roots.NO_GUARD or w[layout.FRACTION] == 0.0)
    ):
        return guard_roots.NO_GUARD
    return sought if guard_roots.stays(sought, w, iw) else guard_roots.NO_GUARD


def advance(stop: float, w: Vector, iw: IntVector, rtol: float, cap: float) -> int:
    """Take one step up to the first event; return the guard that ended it, or NO_GUARD.

    On return FRACTION and LENGTH hold the fraction of the step that holds and its length. A body
    that starts from rest towards a guard that would be violated at once gets shorter steps before
    that is believed; it is, too, where they are so short that the guard does not change at all. A
    step that ends beyond an event is taken again up to just beyond it: the mode's equations, and so
    the error estimate, mean little where the mode does not hold, and the dense output is best where
    the step ends. Neither concerns the series of a linear mode, but for bounces.
    """
    exact = iw[layout.STEPPER] == layout.EXACT
    slot = layout.STEP
    if exact:
        slips = iw[layout.N_CONTACTS] > 0 or abs(iw[layout.MODE]) == 1
        # What slips and what is held may change on very different scales: each goes on with its own
        # length.
        slot = layout.STRIDE if slips else layout.HELD_STRIDE
    before = w[slot]
    doubted, sought = guard_roots.NO_GUARD, guard_roots.NO_GUARD
    guard_roots.note_spare(w, iw)
    while True:
        h = accepted_step(stop, w, iw, rtol, cap, slot)
        if h == 0.0:
            return guard_roots.NO_GUARD
        if exact:
            if iw[layout.N_CONTACTS] > 0:
                guard = equations.ask_here(equations.CROSSING, w, iw)
            else:
                guard = guard_roots.first_crossing(w[layout.TIME], h, w, iw)
            shorter = bounce_length(guard, h, w, iw)
        else:
            guard = guard_roots.first_violation(w[layout.TIME], h, w, iw)
            shorter = finer(h, slot, w, iw) if guard_roots.is_held(iw) else 0.0
            if shorter > 0.0:
                w[slot] = shorter
                continue
            fallen = unmoved(guard, doubted, sought, w, iw)
            if fallen != guard_roots.NO_GUARD:
                guard = fallen
                w[layout.FRACTION] = 0.0
            else:
                shorter = retry_length(guard, h, stop, w, iw)
            if shorter > 0.0:
                doubted = guard if w[layout.FRACTION] == 0.0 else guard_roots.NO_GUARD
                sought = guard if w[layout.FRACTION] > 0.0 else guard_roots.NO_GUARD
        if shorter > 0.0:
            w[slot] = shorter
            continue
        # A series has noted its sizes where its crossings were looked for.
        if w[layout.FRACTION] > 0.0 and not exact:
            guard_roots.note_sizes(w, iw)
        w[layout.LENGTH] = h
        if guard != guard_roots.NO_GUARD and w[layout.FRACTION] == 0.0:
            w[slot] = before  # the step was tried in a mode that does not hold
        return guard


# The run: steps, events, pieces of the drives, rest.

MEMORY = 0.1
"""Weight of the last time between events in their mean."""
FEW_STALLS = 20
"""Events at one instant that several contacts may have, beside those of each contact and switch."""


def stay(end: float, w: Vector, iw: IntVector, log: Vector) -> None:
    """Record a body that stays where it is up to a time."""
    dense_size = iw[layout.DENSE_SIZE]
    dense = iw[layout.DENSE]
    n = iw[layout.N_STATES]
    y = iw[layout.Y]
    for i in range(dense_size):
        w[dense + i] = 0.0
    for i in range(n):
        w[dense + 1 + i] = w[y + i]
    if iw[layout.ALWAYS_EXACT]:
        w[dense] = 1.0  # a series, of which the first state is kept
    # Places within a row are divided by its length, which must not be 0.
    w[layout.LENGTH] = end - w[layout.TIME] if end > w[layout.TIME] else 1.0
    record(log, end, w, iw)


def turns_switch(guard: int, iw: IntVector) -> bool:
    """Whether a guard is that of a switch of the equations of one contact."""
    return iw[layout.N_CONTACTS] == 0 and layout.SWITCH <= guard < iw[layout.FIRST_LIMIT]


def finish_step(
    guard: int,
    stop: float,
    t_end: float,
    w: Vector,
    iw: IntVector,
    table: Vector,
    log: Vector,
    events: Vector,
) -> None:
    """Book the step just taken and pass on to what follows it."""
    start = w[layout.TIME]
    if w[layout.FRACTION] > 0.0:
        if iw[layout.BOOKS]:
            add_work(w, iw)
        record(log, start, w, iw)
    close_step(guard, stop, w, iw)
    # The end in the log was only that of the step: `close_step` may have put it on the start of a
    # piece.
    if w[layout.FRACTION] > 0.0:
        log[(iw[layout.STEPS] - 1) * iw[layout.ROW_COLUMNS] + 1] = w[layout.TIME]
        if iw[layout.N_CONTACTS] > 0:
            note_rhythm(guard, w[layout.TIME] - start, w)
    if guard != guard_roots.NO_GUARD:
        change(guard, w, iw, events)
    # Only after the event: a run that is taken up again at its end time begins behind all that
    # happens there.
    if iw[layout.STATUS] == layout.RUNNING and w[layout.TIME] >= t_end:
        iw[layout.STATUS] = layout.END_TIME
    elif iw[layout.STATUS] == layout.RUNNING and w[layout.TIME] >= stop:
        equations.enter_pieces(table, w, iw)
        settle_all(w, iw, events)
    elif iw[layout.STATUS] == layout.RUNNING and turns_switch(guard, iw):
        mode_transitions.settle(w, iw, events)  # what a switch stands for may jump with it
    if guard != guard_roots.NO_GUARD or w[layout.TIME] >= stop:
        if not has_sizes(w, iw):
            give_sizes(t_end, w, iw)
        steppers.choose_stepper(equations.next_stop(table, t_end, iw), w, iw)


def note_rhythm(guard: int, taken: float, w: Vector) -> None:
    """Follow the mean length of steps that end with an event; one without an event raises it."""
    if guard == guard_roots.NO_GUARD or w[layout.RHYTHM] == math.inf:
        w[layout.RHYTHM] = max(taken, w[layout.RHYTHM]) if guard == guard_roots.NO_GUARD else taken
    else:
        w[layout.RHYTHM] += MEMORY * (taken - w[layout.RHYTHM])


def most_stalls(iw: IntVector) -> int:
    """Return how many events in a row several contacts may have at one instant."""
    return FEW_STALLS + 4 * iw[layout.N_CONTACTS] + 2 * iw[layout.N_SWITCHES] + iw[layout.N_WALLS]


def take_changes(w: Vector, iw: IntVector, events: Vector) -> None:
    """Take the new events of several contacts over into the rows of events."""
    t = w[layout.TIME]
    most = most_stalls(iw)
    for k in range(iw[layout.CHANGED]):
        at = iw[layout.EVENTS] * layout.EVENT_COLUMNS
        for i in range(layout.EVENT_COLUMNS):
            events[at + i] = w[iw[layout.CHANGES] + k * layout.EVENT_COLUMNS + i]
        mode_transitions.count_event(t, iw, events, most)


def change(guard: int, w: Vector, iw: IntVector, events: Vector) -> None:
    """Make what follows from a guard that has fallen."""
    if iw[layout.N_CONTACTS] > 0:
        equations.ask_of(equations.CHANGE, w[layout.TIME], w, iw, guard, 0)
        take_changes(w, iw, events)
        if iw[layout.CHANGED] == 0:  # what falls at once, again and again, may change nothing
            iw[layout.STALLS] = iw[layout.STALLS] + 1 if w[layout.FRACTION] == 0.0 else 0
            if iw[layout.STALLS] > most_stalls(iw):
                iw[layout.STATUS] = layout.ZENO
    else:
        mode_transitions.handle_event(guard, w, iw, events)


def settle_all(w: Vector, iw: IntVector, events: Vector) -> None:
    """Make what follows from a jump of forces."""
    if iw[layout.N_CONTACTS] > 0:
        equations.ask_here(equations.SETTLE, w, iw)
        take_changes(w, iw, events)
    else:
        mode_transitions.turn_switches(w, iw, events)
        mode_transitions.settle(w, iw, events)


def give_sizes(t_end: float, w: Vector, iw: IntVector) -> None:
    """Set the sizes that errors are compared with, by the state and the forces at hand."""
    if iw[layout.N_CONTACTS] > 0:
        equations.ask(equations.FIRST_SIZES, t_end, w, iw)
    else:
        steppers.first_sizes(w[layout.TIME], t_end, w, iw)


def has_sizes(w: Vector, iw: IntVector) -> bool:
    """Whether anything has moved yet, or forces were at hand that gave what rests a size."""
    result = False
    for i in range(iw[layout.N_STATES]):
        result = result or w[iw[layout.SCALE] + i] != 0.0
    return result


def begin(table: Vector, t_end: float, w: Vector, iw: IntVector, events: Vector) -> None:
    """Set what follows from the start: piece, mode, sizes, stepper."""
    n_guards = iw[layout.N_GUARDS]
    lowest = iw[layout.LOWEST]
    equations.put_constants(w, iw)
    equations.enter_pieces(table, w, iw)
    if iw[layout.N_CONTACTS] > 0:
        equations.ask_here(equations.BEGIN, w, iw)
        take_changes(w, iw, events)
        w[layout.RHYTHM] = math.inf  # no event has been met that could shorten a series
    else:
        iw[layout.FLAGS] = 0
        mode_transitions.set_mode(w, iw)
        mode_transitions.settle(w, iw, events)
    give_sizes(t_end, w, iw)
    for i in range(n_guards):
        w[lowest + i] = math.inf
    w[layout.STEP] = 0.0
    w[layout.STRIDE] = math.inf
    w[layout.HELD_STRIDE] = math.inf
    steppers.choose_stepper(equations.next_stop(table, t_end, iw), w, iw)


def go_on(table: Vector, t_end: float, w: Vector, iw: IntVector, events: Vector) -> None:
    """Take a run up that reached its end time, as if it had only met a new piece of the drives."""
    iw[layout.STATUS] = layout.RUNNING
    equations.enter_pieces(table, w, iw)
    settle_all(w, iw, events)
    steppers.choose_stepper(equations.next_stop(table, t_end, iw), w, iw)


def log_is_full(iw: IntVector, log: Vector) -> bool:
    """Whether there is no room for the rows of a step and of its end."""
    return (iw[layout.STEPS] + 2) * iw[layout.ROW_COLUMNS] > len(log)


def events_are_full(iw: IntVector, events: Vector) -> bool:
    """Whether there is no room for a step, a jump and what it switches, and a limit after each."""
    return (iw[layout.EVENTS] + iw[layout.MOST_EVENTS]) * layout.EVENT_COLUMNS > len(events)


def run(
    w: Vector,
    iw: IntVector,
    table: Vector,
    bounds: Vector,
    t_end: float,
    rtol: float,
    cap: float,
    limit: int,
    log: Vector,
    events: Vector,
) -> None:
    """Integrate from the time and the state in `w` to `t_end`.

    `table` has a row a piece: start, then value, slope and start of each drive; `bounds` has least
    and largest value of each drive from the start of each piece on. A run that has reached an end
    time goes on from there: pieces may be told as late as they begin. One that has reached its step
    limit goes on as if there had been none. One that finds no room for further rows has the status
    FULL, and goes on with longer vectors that begin with the same rows.
    """
    if iw[layout.STATUS] == layout.END_TIME:
        go_on(table, t_end, w, iw, events)
    elif iw[layout.STATUS] in (layout.STEP_LIMIT, layout.FULL):
        iw[layout.STATUS] = layout.RUNNING
    else:
        begin(table, t_end, w, iw, events)
    while iw[layout.STATUS] == layout.RUNNING:
        # Before the step: the caller comes back with longer vectors, and nothing may have happened
        # twice.
        if log_is_full(iw, log) or events_are_full(iw, events):
            iw[layout.STATUS] = layout.FULL
            return
        if equations.rests_for_good(w, iw, bounds):
            stay(t_end, w, iw, log)
            iw[layout.STATUS] = layout.AT_REST
            break
        stop = equations.next_stop(table, t_end, iw)
        guard = advance(stop, w, iw, rtol, cap)
        if iw[layout.STATUS] == layout.RUNNING:
            finish_step(guard, stop, t_end, w, iw, table, log, events)
        if iw[layout.STEPS] >= limit and iw[layout.STATUS] == layout.RUNNING:
            iw[layout.STATUS] = layout.STEP_LIMIT
    if iw[layout.STEPS] == 0:  # where not one step could be taken, the start is all there is
        stay(w[layout.TIME], w, iw, log)
