"""Many runs one after the other, of each of which some numbers are kept."""

from stickslip.kernels.backend import Vector, vector
from stickslip.kernels.dense_evaluation import restore
from stickslip.kernels.driver import run
from stickslip.kernels.model_interface import N_STATES, energy
from stickslip.kernels.reducers import reduced
from stickslip.kernels.sensitivities import columns_at, sense
from stickslip.kernels.state_layout import (
    BOOKS,
    END,
    EVENTS,
    FLAGS,
    GROSS,
    LOST,
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

__all__ = ["EVIDENCE", "batch", "batch_sensed"]

EVIDENCE = 5
"""Energy error, guard violation, event residual, steps, rejected steps."""


def prepare_row(
    row: int, columns: Vector, places: Vector, base: Vector, w: Vector, whole: Vector
) -> None:
    """Set the vectors of a run back, with the numbers of one row in their places."""
    for i in range(STAGES):
        w[i] = base[i]
    for i in range(REACHED, SLOPES):
        w[i] = 0.0
    for i in range(len(places)):
        w[int(places[i])] = columns[row * len(places) + i]
    books = whole[BOOKS]
    for i in range(WHOLES):
        whole[i] = 0
    whole[BOOKS] = books


def energy_of(flags: int, t: float, w: Vector) -> float:
    """Return the energy of the state in Y."""
    energy(0, flags, t, w, Y, VALUES)
    return w[VALUES]


def keep_evidence(
    at: int, w: Vector, whole: Vector, table: Vector, log: Vector, evidence: Vector
) -> None:
    """Write how far the run may be trusted, and keep its last state."""
    for i in range(N_STATES):
        w[END + i] = w[Y + i]
    last = energy_of(int(whole[FLAGS]), w[TIME], w)
    restore(log, 0, table, w)
    first = energy_of(int(log[4]), log[0], w)
    size = max(abs(first), abs(last), w[GROSS])
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
    whole: Vector,
    log: Vector,
    events: Vector,
    results: Vector,
    statuses: Vector,
    evidence: Vector,
) -> tuple[Vector, Vector]:
    """Make one run and keep its outputs; return the rows of its steps and of its events."""
    n = len(outputs) // 2
    prepare_row(row, columns, places, base, w, whole)
    log, events = run(w, whole, table, bounds, t_end, rtol, cap, limit, log, events)
    statuses[row] = whole[STATUS]
    keep_evidence(row * EVIDENCE, w, whole, table, log, evidence)
    asked = row * 2 * n if len(arguments) > 2 * n else 0
    for j in range(n):
        results[row * n + j] = reduced(
            int(outputs[2 * j]), int(outputs[2 * j + 1]), arguments[asked + 2 * j],
            arguments[asked + 2 * j + 1], w, whole, table, log, events,
        )  # fmt: skip
    return log, events


def batch(
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
    whole: Vector,
    log: Vector,
    events: Vector,
    results: Vector,
    statuses: Vector,
    evidence: Vector,
) -> None:
    """Run all rows.

    `columns` has a row a run: the numbers that go to `places` of the vector of a run, which is
    `base` otherwise. `tables`, `bounds`, `caps` and `arguments` have a row a run, or one for all.
    `outputs` has kind and subject of each output, `arguments` two numbers for each.
    """
    width, room = len(tables) // len(caps), len(bounds) // len(caps)
    for row in range(count):
        own = row if len(caps) > 1 else 0
        log, events = batch_row(
            row, columns, places, base, tables[own * width : (own + 1) * width],
            bounds[own * room : (own + 1) * room], caps[own], outputs, arguments, t_end, rtol,
            limit, w, whole, log, events, results, statuses, evidence,
        )  # fmt: skip


def sense_end(
    row: int,
    table: Vector,
    starts: Vector,
    slopes: Vector,
    own: Vector,
    q: int,
    w: Vector,
    whole: Vector,
    log: Vector,
    events: Vector,
    gradients: Vector,
) -> None:
    """Take the sensitivities at the end of a run.

    `starts` has those at its start, `slopes` the derivatives of its table, `own` and `q` are as in
    `sense`; `gradients` gets states by directions.
    """
    size = len(starts)
    first = columns_at(0, q, len(own))
    for i in range(size):
        w[first + i] = starts[i]
    steps = int(whole[STEPS])
    end = vector(1)
    end[0] = log[(steps - 1) * ROW_COLUMNS + 1]
    found = vector(size)
    sense(log, steps, events, int(whole[EVENTS]), end, table, slopes, own, q, w, found)
    for i in range(size):
        gradients[row * size + i] = found[i]


def batch_sensed(
    count: int, columns: Vector, places: Vector, base: Vector, tables: Vector, bounds: Vector,
    caps: Vector, outputs: Vector, arguments: Vector, t_end: float, rtol: float, limit: int,
    w: Vector, whole: Vector, log: Vector, events: Vector, results: Vector, statuses: Vector,
    evidence: Vector, starts: Vector, slopes: Vector, own: Vector, q: int, gradients: Vector,
) -> None:  # fmt: skip
    """Run all rows as `batch` does, and take the sensitivities at their ends."""
    width, room = len(tables) // len(caps), len(bounds) // len(caps)
    long = len(slopes) // len(caps)
    for row in range(count):
        at = row if len(caps) > 1 else 0
        table = tables[at * width : (at + 1) * width]
        log, events = batch_row(
            row, columns, places, base, table, bounds[at * room : (at + 1) * room], caps[at],
            outputs, arguments, t_end, rtol, limit, w, whole, log, events, results, statuses,
            evidence,
        )  # fmt: skip
        sense_end(
            row, table, starts, slopes[at * long : (at + 1) * long], own, q, w, whole, log, events,
            gradients,
        )  # fmt: skip
