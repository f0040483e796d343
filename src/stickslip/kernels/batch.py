"""Many runs one after the other, of each of which some numbers are kept."""

from stickslip.kernels.driver import run
from stickslip.kernels.layout import (
    BOOKS,
    END,
    FLAGS,
    GROSS,
    REACHED,
    REJECTED,
    RESIDUAL,
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
from stickslip.kernels.model import N_STATES, energy
from stickslip.kernels.playback import restore
from stickslip.kernels.reducing import reduced
from stickslip.kernels.tier import Vector

__all__ = ["EVIDENCE", "batch"]

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
    mismatch = abs(last - first - w[SUPPLIED] + w[TAKEN])
    evidence[at] = mismatch / size if size > 0.0 else 0.0
    evidence[at + 1] = w[VIOLATION]
    evidence[at + 2] = w[RESIDUAL]
    evidence[at + 3] = whole[STEPS]
    evidence[at + 4] = whole[REJECTED]


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
    n = len(outputs) // 2
    width, room = len(tables) // len(caps), len(bounds) // len(caps)
    for row in range(count):
        own = row if len(caps) > 1 else 0
        table = tables[own * width : (own + 1) * width]
        prepare_row(row, columns, places, base, w, whole)
        log, events = run(
            w, whole, table, bounds[own * room : (own + 1) * room], t_end, rtol, caps[own], limit,
            log, events,
        )  # fmt: skip
        statuses[row] = whole[STATUS]
        keep_evidence(row * EVIDENCE, w, whole, table, log, evidence)
        asked = row * 2 * n if len(arguments) > 2 * n else 0
        for j in range(n):
            results[row * n + j] = reduced(
                int(outputs[2 * j]), int(outputs[2 * j + 1]), arguments[asked + 2 * j],
                arguments[asked + 2 * j + 1], w, whole, table, log, events,
            )  # fmt: skip
