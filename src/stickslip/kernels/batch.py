"""Many runs one after the other, of each of which some numbers are kept."""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.coordinates import state_seen
from stickslip.kernels.dense_evaluation import restore_start
from stickslip.kernels.driver import run
from stickslip.kernels.enums import FULL
from stickslip.kernels.model_interface import energy
from stickslip.kernels.reducers import reduced
from stickslip.kernels.sensitivities import columns_at, sense
from stickslip.kernels.state_layout import (
    BOOKS,
    END,
    EVENTS,
    GROSS,
    LOST,
    N_COORDINATES,
    N_STATES,
    NUMBERS,
    POLYNOMIAL,
    REACHED,
    REJECTED,
    RESIDUAL,
    ROW_COLUMNS,
    SLOPES,
    STAGES,
    STATUS,
    STEPS,
    SUPPLIED,
    TAKEN,
    TIME,
    VALUES,
    VIOLATION,
    WHOLES,
    Y,
)

EVIDENCE = 5
"""Energy error, guard violation, event residual, steps, rejected steps."""


def prepare_row(
    row: int, columns: Vector, places: Vector, base: Vector, w: Vector, whole: Wholes
) -> None:
    """Set the vectors of a run back, with the numbers of one row in their places."""
    stages = whole[STAGES]
    reached = whole[REACHED]
    slopes = whole[SLOPES]
    for i in range(POLYNOMIAL):
        w[i] = base[i]
    for i in range(NUMBERS, stages):
        w[i] = base[i]
    for i in range(reached, slopes):
        w[i] = 0.0
    for i in range(len(places)):
        w[int(places[i])] = columns[row * len(places) + i]
    books = whole[BOOKS]
    for i in range(WHOLES):
        whole[i] = 0
    whole[BOOKS] = books


def energy_at(t: float, w: Vector, whole: Wholes) -> float:
    """Return the energy of the state in Y."""
    values = whole[VALUES]
    energy(t, w, whole, whole[Y], values)
    return w[values]


def potential_at(t: float, w: Vector, whole: Wholes) -> float:
    """Return the energy of the state in Y at rest, where it is left."""
    n = whole[N_COORDINATES]
    for i in range(n, 2 * n):
        w[whole[Y] + i] = 0.0
    return energy_at(t, w, whole)


def keep_evidence(
    at: int, w: Vector, whole: Wholes, table: Vector, log: Vector, evidence: Vector
) -> None:
    """Write how far the run may be trusted, and keep its last state."""
    n = whole[N_STATES]
    end = whole[END]
    y = whole[Y]
    for i in range(n):
        w[end + i] = state_seen(y, i, w, whole)
    last = energy_at(w[TIME], w, whole)
    size = max(abs(last), w[GROSS], last - potential_at(w[TIME], w, whole))
    restore_start(log, 0, table, w, whole)
    first = energy_at(log[0], w, whole)
    size = max(abs(first), size, first - potential_at(log[0], w, whole))
    mismatch = abs(last - first - w[SUPPLIED] + w[TAKEN] + w[LOST])
    evidence[at] = mismatch / size if mismatch != 0.0 else 0.0  # what is no number stays none
    evidence[at + 1] = w[VIOLATION]
    evidence[at + 2] = w[RESIDUAL]
    evidence[at + 3] = whole[STEPS]
    evidence[at + 4] = whole[REJECTED]


def batch_row(
    row: int,
    columns: Vector,
    places: Vector,
    base: Vector,
    table: Vector,
    bounds: Vector,
    cap: float,
    outputs: Vector,
    arguments: Vector,
    t_end: float,
    rtol: float,
    limit: int,
    w: Vector,
    whole: Wholes,
    log: Vector,
    events: Vector,
    results: Vector,
    statuses: Vector,
    evidence: Vector,
) -> bool:
    """Make one run, or go on with it, and keep its outputs; return whether it found room."""
    n = len(outputs) // 2
    if whole[STATUS] != FULL:
        prepare_row(row, columns, places, base, w, whole)
    run(w, whole, table, bounds, t_end, rtol, cap, limit, log, events)
    if whole[STATUS] == FULL:
        return False
    statuses[row] = whole[STATUS]
    keep_evidence(row * EVIDENCE, w, whole, table, log, evidence)
    asked = row * 2 * n if len(arguments) > 2 * n else 0
    for j in range(n):
        results[row * n + j] = reduced(
            int(outputs[2 * j]), int(outputs[2 * j + 1]), arguments[asked + 2 * j],
            arguments[asked + 2 * j + 1], w, whole, table, log, events,
        )  # fmt: skip
    return True


def batch(
    first: int,
    count: int,
    columns: Vector,
    places: Vector,
    base: Vector,
    tables: Vector,
    bounds: Vector,
    caps: Vector,
    outputs: Vector,
    arguments: Vector,
    t_end: float,
    rtol: float,
    limit: int,
    w: Vector,
    whole: Wholes,
    log: Vector,
    events: Vector,
    results: Vector,
    statuses: Vector,
    evidence: Vector,
) -> int:
    """Run all rows from one on; return the first that is not done, for want of room for its rows.

    The caller makes room, and calls again with that row.

    `columns` has a row a run: the numbers that go to `places` of the vector of a run, which is
    `base` otherwise. `tables`, `bounds`, `caps` and `arguments` have a row a run, or one for all.
    `outputs` has kind and subject of each output, `arguments` two numbers for each.
    """
    width, room = len(tables) // len(caps), len(bounds) // len(caps)
    for row in range(first, count):
        own = row if len(caps) > 1 else 0
        done = batch_row(
            row, columns, places, base, tables[own * width : (own + 1) * width],
            bounds[own * room : (own + 1) * room], caps[own], outputs, arguments, t_end, rtol,
            limit, w, whole, log, events, results, statuses, evidence,
        )  # fmt: skip
        if not done:
            return row
    return count


def sense_end(
    row: int,
    table: Vector,
    starts: Vector,
    slopes: Vector,
    own: Vector,
    q: int,
    w: Vector,
    whole: Wholes,
    log: Vector,
    events: Vector,
    gradients: Vector,
) -> None:
    """Take the sensitivities at the end of a run.

    `starts` has those at its start, `slopes` the derivatives of its table, `own` and `q` are as in
    `sense`; `gradients` gets states by directions.
    """
    size = len(starts)
    first = columns_at(0, q, len(own), whole)
    for i in range(size):
        w[first + i] = starts[i]
    steps = whole[STEPS]
    last = (steps - 1) * whole[ROW_COLUMNS]
    end = log[last + 1 : last + 2]
    sense(
        log, steps, events, whole[EVENTS], end, table, slopes, own, q, w, whole, gradients,
        row * size,
    )  # fmt: skip


def batch_sensed(
    first: int, count: int, columns: Vector, places: Vector, base: Vector, tables: Vector,
    bounds: Vector, caps: Vector, outputs: Vector, arguments: Vector, t_end: float, rtol: float,
    limit: int, w: Vector, whole: Wholes, log: Vector, events: Vector, results: Vector,
    statuses: Vector, evidence: Vector, starts: Vector, slopes: Vector, own: Vector, q: int,
    gradients: Vector,
) -> int:  # fmt: skip
    """Run rows as `batch` does, and take the sensitivities at their ends."""
    width, room = len(tables) // len(caps), len(bounds) // len(caps)
    long = len(slopes) // len(caps)
    for row in range(first, count):
        at = row if len(caps) > 1 else 0
        table = tables[at * width : (at + 1) * width]
        done = batch_row(
            row, columns, places, base, table, bounds[at * room : (at + 1) * room], caps[at],
            outputs, arguments, t_end, rtol, limit, w, whole, log, events, results, statuses,
            evidence,
        )  # fmt: skip
        if not done:
            return row
        sense_end(
            row, table, starts, slopes[at * long : (at + 1) * long], own, q, w, whole, log, events,
            gradients,
        )  # fmt: skip
    return count
