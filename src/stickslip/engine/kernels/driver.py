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
from stickslip.engine.kernels.backend import Vector, Wholes
from stickslip.engine.kernels.numerics import FEW_NODES, FEW_WEIGHTS, NODES, WEIGHTS, interpolate

# The books of a run: rows of steps, work done, violations found.

NOTABLE = 1e-10
"""Share of its largest size by which a guard is violated more than the dense output's rounding."""
FEW_TERMS = 6
"""A series that ends so early is that of a very short step, over which few nodes do."""


def add_work(w: Vector, whole: Wholes) -> None:
    """Add the work done in the part of the step that holds."""
    point = whole[layout.POINT]
    values = whole[layout.VALUES]
    share = w[layout.FRACTION]
    h = w[layout.LENGTH]
    if whole[layout.N_CONTACTS] > 0:
        equations.ask_here(equations.BOOK, w, whole)
        return
    terms = w[whole[layout.DENSE]]
    # A short series and the dense output of Rodas, which is marked below 0, are of low degree: the
    # few nodes integrate them as exactly.
    few = 0.0 < terms <= FEW_TERMS or terms < 0.0
    supplied, taken, gross = 0.0, 0.0, 0.0
    # The nodes lie in the part of the step that holds: beyond an event the dense output is that of
    # a mode which has ended.
    for node in range(len(FEW_NODES) if few else len(NODES)):
        x = share * (FEW_NODES[node] if few else NODES[node])
        interpolate(w, whole, x, point)
        equations.power(w[layout.TIME] + x * h, w, whole, point, values)
        weight = share * h * (FEW_WEIGHTS[node] if few else WEIGHTS[node])
        supplied += weight * w[values]
        taken += weight * w[values + 1]
        # Sizes are added whatever their sign: the energy error is judged against all work that was
        # done, not against what is left of it.
        gross += weight * (abs(w[values]) + abs(w[values + 1]))
    w[layout.SUPPLIED] += supplied
    w[layout.TAKEN] += taken
    w[layout.GROSS] += gross


def record(log: Vector, end: float, w: Vector, whole: Wholes) -> None:
    """Write one row of the log."""
    dense = whole[layout.DENSE]
    n = whole[layout.N_STATES]
    at = whole[layout.STEPS] * whole[layout.ROW_COLUMNS]
    log[at] = w[layout.TIME]
    log[at + 1] = end
    log[at + 2] = w[layout.LENGTH]
    log[at + 3] = whole[layout.MODE]
    log[at + 4] = whole[layout.FLAGS]
    log[at + 5] = whole[layout.PIECE]
    # Of a series the start is enough: its terms follow from the equations again, to the last bit.
    terms = 0 if w[dense] > 0.0 else layout.TERMS
    for i in range(1 + (terms + 1) * n):
        log[at + layout.ROW_DENSE + i] = w[dense + i]
    if whole[layout.N_CONTACTS] > 0:
        note_modes(at + whole[layout.ROW_COLUMNS], log, whole)
    whole[layout.STEPS] += 1


def note_modes(end: int, log: Vector, whole: Wholes) -> None:
    """Write modes, flags and openings to the end of a row that ends before a place."""
    n, contacts = whole[layout.N_PAIRS], whole[layout.N_CONTACTS]
    at = end - n - 2 * contacts
    for i in range(n):
        log[at + i] = whole[whole[layout.MODES] + i]
    for c in range(contacts):
        log[at + n + c] = whole[whole[layout.LAW_FLAGS] + c]
        log[at + n + contacts + c] = whole[whole[layout.OPEN] + c]


def audit(guard: int, start: float, w: Vector, whole: Wholes) -> None:
    """Note how far guards are violated at the end of a step, relative to their largest size yet.

    A steep guard may fall far between two ticks of the clock: what counts is where it was a tick
    before.
    """
    values, h = whole[layout.VALUES], w[layout.LENGTH]
    guard_roots.guard_values(w[layout.TIME], 0.0, w, whole, whole[layout.Y], values)
    for i in range(whole[layout.N_GUARDS]):
        value = w[values + i]
        if value < 0.0:  # what is left of forces that balance is their rounding
            value = min(
                0.0, value + guard_roots.BALANCED * guard_roots.size_of_balance(i, w, whole)
            )
        if value < 0.0:
            size = guard_roots.guard_size(i, w, whole)
            # The only guard of one contact that is a speed, not a force: its size is kept with the
            # states.
            if i == layout.STOP and whole[layout.N_CONTACTS] == 0:
                size = max(size, w[whole[layout.SCALE] + whole[layout.SLIP]])
            if value < -NOTABLE * size:
                before = max(
                    0.0, w[layout.FRACTION] - guard_roots.CLOCK * max(1.0, w[layout.TIME] / h)
                )
                value = min(0.0, max(value, guard_roots.guard_at(i, before, start, h, w, whole)))
                guard_roots.guard_values(
                    w[layout.TIME], 0.0, w, whole, whole[layout.Y], values
                )  # `guard_at` has overwritten them
            at = layout.RESIDUAL if i == guard else layout.VIOLATION
            if size > 0.0:
                w[at] = max(w[at], -value / size)


def close_step(guard: int, stop: float, w: Vector, whole: Wholes) -> None:
    """Move time and state to the end of the step."""
    n = whole[layout.N_STATES]
    y = whole[layout.Y]
    y1 = whole[layout.Y1]
    scale = whole[layout.SCALE]
    share = w[layout.FRACTION]
    h = w[layout.LENGTH]
    start = w[layout.TIME]
    end = start + share * h
    if guard == guard_roots.NO_GUARD:
        if w[layout.SPARE] > 0.0:
            guard_roots.forget_spare(w, whole)
        # The stepper's own result, which the dense output repeats only to rounding.
        for i in range(n):
            w[y + i] = w[y1 + i]
        # The end of a piece is met to the last bit: by the time the next piece of the drives is
        # chosen.
        if abs(stop - end) <= layout.ROUNDING * max(abs(stop), abs(h)):
            end = stop
    else:
        interpolate(w, whole, share, y)
    for i in range(n):
        w[scale + i] = max(w[scale + i], abs(w[y + i]))
    if whole[layout.N_CONTACTS] > 0:
        equations.ask_here(equations.MOTION, w, whole)
    w[layout.TIME] = end
    if share > 0.0:
        audit(guard, start, w, whole)


# A recorded run at any times: its rows hold all that is needed.


def row_at(log: Vector, count: int, t: float, whole: Wholes) -> int:
    """Return the last row that begins at or before a time."""
    width = whole[layout.ROW_COLUMNS]
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


def piece_at(table: Vector, first: int, t: float, whole: Wholes) -> int:
    """Return the piece of the drives that holds at a time, `first` or a later one."""
    width = 1 + 3 * whole[layout.N_DRIVES]
    piece = first
    while (piece + 1) * width < len(table) and table[(piece + 1) * width] <= t:
        piece += 1
    return piece


def restore_modes(end: int, log: Vector, w: Vector, whole: Wholes) -> None:
    """Bring back the modes, flags and openings of a row that ends before a place."""
    n, contacts = whole[layout.N_PAIRS], whole[layout.N_CONTACTS]
    at = end - n - 2 * contacts
    for i in range(n):
        whole[whole[layout.MODES] + i] = int(log[at + i])
    for c in range(contacts):
        whole[whole[layout.LAW_FLAGS] + c] = int(log[at + n + c])
        whole[whole[layout.OPEN] + c] = int(log[at + n + contacts + c])
    equations.ask_here(equations.RESTORE, w, whole)


def restore_start(log: Vector, row: int, table: Vector, w: Vector, whole: Wholes) -> None:
    """Bring back the start of a row in Y, its mode, and the piece of its drives."""
    n = whole[layout.N_STATES]
    y = whole[layout.Y]
    at = row * whole[layout.ROW_COLUMNS]
    whole[layout.MODE] = int(log[at + 3])
    whole[layout.FLAGS] = int(log[at + 4])
    equations.load_piece(table, int(log[at + 5]), w, whole)
    for i in range(n):
        w[y + i] = log[at + layout.ROW_DENSE + 1 + i]
    if whole[layout.N_CONTACTS] > 0:
        restore_modes(at + whole[layout.ROW_COLUMNS], log, w, whole)


def restore(log: Vector, row: int, table: Vector, w: Vector, whole: Wholes) -> None:
    """Bring back the start of a row in Y, its dense output, mode and piece of the drives."""
    n = whole[layout.N_STATES]
    y = whole[layout.Y]
    dense = whole[layout.DENSE]
    at = row * whole[layout.ROW_COLUMNS]
    restore_start(log, row, table, w, whole)
    # The terms of a series are not kept: the same equations give them again.
    if log[at + layout.ROW_DENSE] > 0.0 and whole[layout.N_CONTACTS] > 0:
        w[layout.TIME] = log[at]
        equations.ask_of(equations.SERIES_FROM, log[at + 2], w, whole, y, 0)
    elif log[at + layout.ROW_DENSE] > 0.0:
        steppers.series_fill(log[at], log[at + 2], w, whole, y)
    else:
        for i in range(1 + (layout.TERMS + 1) * n):
            w[dense + i] = log[at + layout.ROW_DENSE + i]


def play(
    log: Vector,
    count: int,
    times: Vector,
    table: Vector,
    w: Vector,
    whole: Wholes,
    states: Vector,
    forces: Vector,
    rows: Vector,
) -> None:
    """Write states, friction, loads and what else is recorded, and the row, of each of the times.

    A body at rest for good is one row, during which its drives go on.
    """
    width = whole[layout.ROW_COLUMNS]
    point = whole[layout.POINT]
    values = whole[layout.VALUES]
    n = whole[layout.N_STATES]
    columns = whole[layout.N_COLUMNS]
    row = -1
    piece = 0
    equations.put_constants(w, whole)
    if whole[layout.N_CONTACTS] > 0:
        equations.ask(equations.PREPARE, log[0], w, whole)
    for i in range(len(times)):
        t = times[i]
        here = row
        # Times mostly increase: the row at hand is tried before any is searched for.
        if row < 0 or t < log[row * width] or not t < log[row * width + 1]:
            here = row_at(log, count, t, whole)
        at = here * width
        # A body at rest has one row for many pieces. Within it they are gone through onwards from
        # the last one, and from the first one again where times go back.
        if here != row or t < times[i - 1]:
            piece = int(log[at + 5])
        if here != row:
            row = here
            restore(log, row, table, w, whole)
        interpolate(w, whole, (t - log[at]) / log[at + 2], point)
        piece = piece_at(table, piece, t, whole)
        equations.load_piece(table, piece, w, whole)
        equations.recorded(t, w, whole, point, values)
        for j in range(n):
            states[i * n + j] = equations.state_seen(point, j, w, whole)
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


def attempt(h: float, w: Vector, whole: Wholes, rtol: float) -> float:
    """Try a step with the mode's stepper, fill its dense output if it is good enough."""
    y = whole[layout.Y]
    t = w[layout.TIME]
    if whole[layout.STEPPER] == layout.EXACT:
        if whole[layout.N_CONTACTS] > 0:
            equations.ask_of(equations.SERIES_STEP, h, w, whole, y, whole[layout.VALUES])
            return w[whole[layout.VALUES]]
        return steppers.series_step(t, h, w, whole, y)
    if whole[layout.STEPPER] == layout.STIFF:
        error = steppers.rodas_step(t, h, w, whole, rtol)
        if error <= 1.0:
            steppers.rodas_dense(w, whole)
        return error
    error = steppers.dop853_step(t, h, w, whole, rtol)
    if error <= 1.0:
        steppers.dop853_dense(t, h, w, whole)
    return error


def resized(h: float, error: float, w: Vector, whole: Wholes) -> float:
    """Return the next step length for an error over the tolerance."""
    if whole[layout.STEPPER] == layout.EXACT:
        if error == 0.0:
            return h * GROWTH[int(w[whole[layout.DENSE]])]
        # the tail goes with h^SERIES; 1e60 and more, or NaN, is cut to what 1e60 gives
        return h * (0.95 * math.pow(error, -1.0 / layout.SERIES) if error < 1e60 else 1e-3)
    if error == 0.0:
        return 10.0 * h
    if not error < 1e30:  # NaN, too
        return 0.1 * h
    # powers of h with which the estimates fall; 0.9, 0.2 and 10 are those of DOPRI5
    order = 5.0 if whole[layout.STEPPER] == layout.STIFF else 8.0
    return h * min(10.0, max(0.2, 0.9 * math.pow(error, -1.0 / order)))


def accepted_step(
    stop: float, w: Vector, whole: Wholes, rtol: float, cap: float, slot: int
) -> float:
    """Shorten the step until it is accurate; return its length, 0 if there is none."""
    stepper = whole[layout.STEPPER]
    t = w[layout.TIME]
    h = min(w[slot], cap)
    if stepper == layout.EXACT and whole[layout.N_CONTACTS] > 0:
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
            whole[layout.STATUS] = layout.STEP_TOO_SMALL
            return 0.0
        error = attempt(h, w, whole, rtol)
        proposed = resized(h, error, w, whole)
        if error <= 1.0:
            # a step cut short by the end of a piece says little of the next one
            w[slot] = max(proposed, w[slot]) if last else proposed
            if stepper != layout.STIFF:
                steppers.watch_stiffness(h, w, whole)
            return h
        whole[layout.REJECTED] += 1
        h = proposed


def finer(h: float, slot: int, w: Vector, whole: Wholes) -> float:
    """Return the length with which a step should be taken again, 0 if its samples show the guards.

    Nothing else keeps steps short where a body is held and only its load or the force on it change.
    The next step is no longer than these guards allow.
    """
    t = w[layout.TIME]
    coarse = guard_roots.coarseness(t, h, w, whole)
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


def retry_length(guard: int, h: float, stop: float, w: Vector, whole: Wholes) -> float:
    """Return the length with which a step should be taken again, 0 if it stands."""
    t = w[layout.TIME]
    fraction = w[layout.FRACTION]
    if (
        guard >= whole[layout.FIRST_WALL]
        and fraction == 0.0
        and mode_transitions.approach(guard, w, whole) > 0.0
    ):
        return 0.0  # it is at its stop
    if guard != guard_roots.NO_GUARD and fraction == 0.0 and not guard_roots.reverses(guard, whole):
        return shorter_start(h, stop, w)
    if guard != guard_roots.NO_GUARD and 0.0 < fraction < OVERSHOT:
        if t + 0.25 * fraction * h > t:
            return BEYOND * fraction * h
        # what is at rest begins with the errors that others leave in the dense output, and what is
        # far from its threshold does not fall within the rounding of the time
        begins = w[whole[layout.SAMPLED] + guard]
        if begins == 0.0 or begins > guard_roots.NEGLIGIBLE * guard_roots.guard_size(
            guard, w, whole
        ):
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


def bounce_length(guard: int, h: float, w: Vector, whole: Wholes) -> float:
    """Return the length with which a series should be taken again, 0 if it stands.

    Fractions are found to rounding of 1, within which a short bounce would be lost. What falls at
    once does so truly if its first coefficient that is not zero, however small, is negative. That
    goes for what begins to slip, too: next to faster or larger motions its own may be too small for
    the step, whose last terms are then its largest.
    """
    fraction = w[layout.FRACTION]
    if whole[layout.N_CONTACTS] > 0 and fraction == 0.0 and guard_roots.is_speed(guard, whole):
        begins = w[layout.POLYNOMIAL] == 0.0 and first_coefficient(w) > 0.0
        shorter = h / 8.0 if begins and h > TINIEST * (w[layout.TIME] + h) else 0.0
    elif guard < whole[layout.FIRST_WALL] or fraction >= BOUNCE:
        shorter = 0.0
    elif fraction == 0.0 and whole[layout.N_CONTACTS] > 0:
        shorter = h / 8.0 if not mode_transitions.approach(guard, w, whole) > 0.0 else 0.0
    elif fraction == 0.0:
        shorter = h / 8.0 if not first_coefficient(w) < 0.0 else 0.0
    else:
        shorter = 2.0 * fraction * h
    return shorter if w[layout.TIME] + shorter / 8.0 > w[layout.TIME] else 0.0


def unmoved(guard: int, doubted: int, sought: int, w: Vector, whole: Wholes) -> int:
    """Return the guard that has fallen although the step is too short to move it, or NO_GUARD.

    That is one that fell at once in longer steps, `doubted`, or, as a run begins on its threshold,
    a switch at whose fall the step was to end, `sought`. Another, which begins below zero by
    rounding and rose in longer steps, says nothing in so short a one.
    """
    if (
        guard == guard_roots.NO_GUARD
        and doubted != guard_roots.NO_GUARD
        and not guard_roots.rises(doubted, w, whole)
    ):
        return doubted
    own = whole[layout.FIRST_LIMIT] - whole[layout.N_SWITCHES] <= sought < whole[layout.FIRST_LIMIT]
    if (
        whole[layout.STEPS] >= guard_roots.EARLY
        or not own
        or not (guard == guard_roots.NO_GUARD or w[layout.FRACTION] == 0.0)
    ):
        return guard_roots.NO_GUARD
    return sought if guard_roots.stays(sought, w, whole) else guard_roots.NO_GUARD


def advance(stop: float, w: Vector, whole: Wholes, rtol: float, cap: float) -> int:
    """Take one step up to the first event; return the guard that ended it, or NO_GUARD.

    On return FRACTION and LENGTH hold the fraction of the step that holds and its length. A body
    that starts from rest towards a guard that would be violated at once gets shorter steps before
    that is believed; it is, too, where they are so short that the guard does not change at all. A
    step that ends beyond an event is taken again up to just beyond it: the mode's equations, and so
    the error estimate, mean little where the mode does not hold, and the dense output is best where
    the step ends. Neither concerns the series of a linear mode, but for bounces.
    """
    exact = whole[layout.STEPPER] == layout.EXACT
    slot = layout.STEP
    if exact:
        slips = whole[layout.N_CONTACTS] > 0 or abs(whole[layout.MODE]) == 1
        # What slips and what is held may change on very different scales: each goes on with its own
        # length.
        slot = layout.STRIDE if slips else layout.HELD_STRIDE
    before = w[slot]
    doubted, sought = guard_roots.NO_GUARD, guard_roots.NO_GUARD
    guard_roots.note_spare(w, whole)
    while True:
        h = accepted_step(stop, w, whole, rtol, cap, slot)
        if h == 0.0:
            return guard_roots.NO_GUARD
        if exact:
            if whole[layout.N_CONTACTS] > 0:
                guard = equations.ask_here(equations.CROSSING, w, whole)
            else:
                guard = guard_roots.first_crossing(w[layout.TIME], h, w, whole)
            shorter = bounce_length(guard, h, w, whole)
        else:
            guard = guard_roots.first_violation(w[layout.TIME], h, w, whole)
            shorter = finer(h, slot, w, whole) if guard_roots.is_held(whole) else 0.0
            if shorter > 0.0:
                w[slot] = shorter
                continue
            fallen = unmoved(guard, doubted, sought, w, whole)
            if fallen != guard_roots.NO_GUARD:
                guard = fallen
                w[layout.FRACTION] = 0.0
            else:
                shorter = retry_length(guard, h, stop, w, whole)
            if shorter > 0.0:
                doubted = guard if w[layout.FRACTION] == 0.0 else guard_roots.NO_GUARD
                sought = guard if w[layout.FRACTION] > 0.0 else guard_roots.NO_GUARD
        if shorter > 0.0:
            w[slot] = shorter
            continue
        # A series has noted its sizes where its crossings were looked for.
        if w[layout.FRACTION] > 0.0 and not exact:
            guard_roots.note_sizes(w, whole)
        w[layout.LENGTH] = h
        if guard != guard_roots.NO_GUARD and w[layout.FRACTION] == 0.0:
            w[slot] = before  # the step was tried in a mode that does not hold
        return guard


# The run: steps, events, pieces of the drives, rest.

MEMORY = 0.1
"""Weight of the last time between events in their mean."""
FEW_STALLS = 20
"""Events at one instant that several contacts may have, beside those of each contact and switch."""


def stay(end: float, w: Vector, whole: Wholes, log: Vector) -> None:
    """Record a body that stays where it is up to a time."""
    dense_size = whole[layout.DENSE_SIZE]
    dense = whole[layout.DENSE]
    n = whole[layout.N_STATES]
    y = whole[layout.Y]
    for i in range(dense_size):
        w[dense + i] = 0.0
    for i in range(n):
        w[dense + 1 + i] = w[y + i]
    if whole[layout.ALWAYS_EXACT]:
        w[dense] = 1.0  # a series, of which the first state is kept
    # Places within a row are divided by its length, which must not be 0.
    w[layout.LENGTH] = end - w[layout.TIME] if end > w[layout.TIME] else 1.0
    record(log, end, w, whole)


def turns_switch(guard: int, whole: Wholes) -> bool:
    """Whether a guard is that of a switch of the equations of one contact."""
    return whole[layout.N_CONTACTS] == 0 and layout.SWITCH <= guard < whole[layout.FIRST_LIMIT]


def finish_step(
    guard: int,
    stop: float,
    t_end: float,
    w: Vector,
    whole: Wholes,
    table: Vector,
    log: Vector,
    events: Vector,
) -> None:
    """Book the step just taken and pass on to what follows it."""
    start = w[layout.TIME]
    if w[layout.FRACTION] > 0.0:
        if whole[layout.BOOKS]:
            add_work(w, whole)
        record(log, start, w, whole)
    close_step(guard, stop, w, whole)
    # The end in the log was only that of the step: `close_step` may have put it on the start of a
    # piece.
    if w[layout.FRACTION] > 0.0:
        log[(whole[layout.STEPS] - 1) * whole[layout.ROW_COLUMNS] + 1] = w[layout.TIME]
        if whole[layout.N_CONTACTS] > 0:
            note_rhythm(guard, w[layout.TIME] - start, w)
    if guard != guard_roots.NO_GUARD:
        change(guard, w, whole, events)
    # Only after the event: a run that is taken up again at its end time begins behind all that
    # happens there.
    if whole[layout.STATUS] == layout.RUNNING and w[layout.TIME] >= t_end:
        whole[layout.STATUS] = layout.END_TIME
    elif whole[layout.STATUS] == layout.RUNNING and w[layout.TIME] >= stop:
        equations.enter_pieces(table, w, whole)
        settle_all(w, whole, events)
    elif whole[layout.STATUS] == layout.RUNNING and turns_switch(guard, whole):
        mode_transitions.settle(w, whole, events)  # what a switch stands for may jump with it
    if guard != guard_roots.NO_GUARD or w[layout.TIME] >= stop:
        if not has_sizes(w, whole):
            give_sizes(t_end, w, whole)
        steppers.choose_stepper(equations.next_stop(table, t_end, whole), w, whole)


def note_rhythm(guard: int, taken: float, w: Vector) -> None:
    """Follow the mean length of steps that end with an event; one without an event raises it."""
    if guard == guard_roots.NO_GUARD or w[layout.RHYTHM] == math.inf:
        w[layout.RHYTHM] = max(taken, w[layout.RHYTHM]) if guard == guard_roots.NO_GUARD else taken
    else:
        w[layout.RHYTHM] += MEMORY * (taken - w[layout.RHYTHM])


def most_stalls(whole: Wholes) -> int:
    """Return how many events in a row several contacts may have at one instant."""
    return (
        FEW_STALLS
        + 4 * whole[layout.N_CONTACTS]
        + 2 * whole[layout.N_SWITCHES]
        + whole[layout.N_WALLS]
    )


def take_changes(w: Vector, whole: Wholes, events: Vector) -> None:
    """Take the new events of several contacts over into the rows of events."""
    t = w[layout.TIME]
    most = most_stalls(whole)
    for k in range(whole[layout.CHANGED]):
        at = whole[layout.EVENTS] * layout.EVENT_COLUMNS
        for i in range(layout.EVENT_COLUMNS):
            events[at + i] = w[whole[layout.CHANGES] + k * layout.EVENT_COLUMNS + i]
        mode_transitions.count_event(t, whole, events, most)


def change(guard: int, w: Vector, whole: Wholes, events: Vector) -> None:
    """Make what follows from a guard that has fallen."""
    if whole[layout.N_CONTACTS] > 0:
        equations.ask_of(equations.CHANGE, w[layout.TIME], w, whole, guard, 0)
        take_changes(w, whole, events)
        if whole[layout.CHANGED] == 0:  # what falls at once, again and again, may change nothing
            whole[layout.STALLS] = whole[layout.STALLS] + 1 if w[layout.FRACTION] == 0.0 else 0
            if whole[layout.STALLS] > most_stalls(whole):
                whole[layout.STATUS] = layout.ZENO
    else:
        mode_transitions.handle_event(guard, w, whole, events)


def settle_all(w: Vector, whole: Wholes, events: Vector) -> None:
    """Make what follows from a jump of forces."""
    if whole[layout.N_CONTACTS] > 0:
        equations.ask_here(equations.SETTLE, w, whole)
        take_changes(w, whole, events)
    else:
        mode_transitions.turn_switches(w, whole, events)
        mode_transitions.settle(w, whole, events)


def give_sizes(t_end: float, w: Vector, whole: Wholes) -> None:
    """Set the sizes that errors are compared with, by the state and the forces at hand."""
    if whole[layout.N_CONTACTS] > 0:
        equations.ask(equations.FIRST_SIZES, t_end, w, whole)
    else:
        steppers.first_sizes(w[layout.TIME], t_end, w, whole)


def has_sizes(w: Vector, whole: Wholes) -> bool:
    """Whether anything has moved yet, or forces were at hand that gave what rests a size."""
    found = False
    for i in range(whole[layout.N_STATES]):
        found = found or w[whole[layout.SCALE] + i] != 0.0
    return found


def begin(table: Vector, t_end: float, w: Vector, whole: Wholes, events: Vector) -> None:
    """Set what follows from the start: piece, mode, sizes, stepper."""
    n_guards = whole[layout.N_GUARDS]
    lowest = whole[layout.LOWEST]
    equations.put_constants(w, whole)
    equations.enter_pieces(table, w, whole)
    if whole[layout.N_CONTACTS] > 0:
        equations.ask_here(equations.BEGIN, w, whole)
        take_changes(w, whole, events)
        w[layout.RHYTHM] = math.inf  # no event has been met that could shorten a series
    else:
        mode_transitions.initial_mode(w, whole)
        mode_transitions.settle(w, whole, events)
    give_sizes(t_end, w, whole)
    for i in range(n_guards):
        w[lowest + i] = math.inf
    w[layout.STEP] = 0.0
    w[layout.STRIDE] = math.inf
    w[layout.HELD_STRIDE] = math.inf
    steppers.choose_stepper(equations.next_stop(table, t_end, whole), w, whole)


def go_on(table: Vector, t_end: float, w: Vector, whole: Wholes, events: Vector) -> None:
    """Take a run up that reached its end time, as if it had only met a new piece of the drives."""
    whole[layout.STATUS] = layout.RUNNING
    equations.enter_pieces(table, w, whole)
    settle_all(w, whole, events)
    steppers.choose_stepper(equations.next_stop(table, t_end, whole), w, whole)


def log_is_full(whole: Wholes, log: Vector) -> bool:
    """Whether there is no room for the rows of a step and of its end."""
    return (whole[layout.STEPS] + 2) * whole[layout.ROW_COLUMNS] > len(log)


def events_are_full(whole: Wholes, events: Vector) -> bool:
    """Whether there is no room for a step, a jump and what it switches, and a limit after each."""
    return (whole[layout.EVENTS] + whole[layout.MOST_EVENTS]) * layout.EVENT_COLUMNS > len(events)


def run(
    w: Vector,
    whole: Wholes,
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
    if whole[layout.STATUS] == layout.END_TIME:
        go_on(table, t_end, w, whole, events)
    elif whole[layout.STATUS] in (layout.STEP_LIMIT, layout.FULL):
        whole[layout.STATUS] = layout.RUNNING
    else:
        begin(table, t_end, w, whole, events)
    while whole[layout.STATUS] == layout.RUNNING:
        # Before the step: the caller comes back with longer vectors, and nothing may have happened
        # twice.
        if log_is_full(whole, log) or events_are_full(whole, events):
            whole[layout.STATUS] = layout.FULL
            return
        if equations.rests_for_good(w, whole, bounds):
            stay(t_end, w, whole, log)
            whole[layout.STATUS] = layout.AT_REST
            break
        stop = equations.next_stop(table, t_end, whole)
        guard = advance(stop, w, whole, rtol, cap)
        if whole[layout.STATUS] == layout.RUNNING:
            finish_step(guard, stop, t_end, w, whole, table, log, events)
        if whole[layout.STEPS] >= limit and whole[layout.STATUS] == layout.RUNNING:
            whole[layout.STATUS] = layout.STEP_LIMIT
    if whole[layout.STEPS] == 0:  # where not one step could be taken, the start is all there is
        stay(w[layout.TIME], w, whole, log)
