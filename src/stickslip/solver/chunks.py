"""Runs many rows in chunks: the work of an ensemble, cut so that it fits any executor."""

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.executors import check_executor, spread
from stickslip.formulation import Model, formulate
from stickslip.friction import FrictionLaw, Laws
from stickslip.kernels.batch import EVIDENCE
from stickslip.kernels.sensitivities import sense_size
from stickslip.kernels.state_layout import EVENT_COLUMNS, ROW_COLUMNS, SIZE, Y
from stickslip.mechanisms import Mechanism
from stickslip.solver.backend import Runner, runner_of
from stickslip.solver.drive_schedule import schedule, values_of
from stickslip.solver.event_driven import EventDriven
from stickslip.solver.run import FIRST_ROWS
from stickslip.solver.sensitivities import Directions, directions_of

Array = NDArray[np.float64]
MOST_ROWS = 4096
"""Runs in a chunk: some ten milliseconds of work, and memory that does not grow with the whole."""
MOST_NUMBERS = 1 << 21
"""Numbers that the drives' tables of a chunk may have."""


@dataclass(frozen=True)
class Job:
    """What all chunks have in common; can be sent to another process."""

    mechanism: Mechanism
    """What moves."""
    law: FrictionLaw | Laws
    """Friction of its contact."""
    y0: tuple[float, ...]
    """State at time 0: coordinates, rates, bristles [SI]."""
    t_end: float
    """Last time of each run [s]."""
    kinds: Array
    """What the kernels keep of each run: kind and subject of each column."""
    gradients: tuple[str, ...]
    """Full paths of which sensitivities are wanted."""
    solver: EventDriven
    """Tolerance, most steps and tier of the runs."""
    told: tuple[str, ...]
    """States that begin where the mechanism says."""

    def model(self) -> Model:
        """Return the equations, with their slopes where they are needed."""
        return formulate(self.mechanism, self.law, slopes=bool(self.gradients))


@dataclass(frozen=True)
class Chunk:
    """Some rows of an ensemble, or what came of them."""

    start: int
    """Index of the first row in the ensemble."""
    results: Array
    """(rows, columns)."""
    statuses: NDArray[np.int8]
    """(rows,): how each run ended, as a code of the kernels."""
    evidence: Array
    """(rows, 5): energy error, guard violation, event residual, steps, rejected steps."""
    gradients: Array
    """(rows, states, paths): sensitivities at the end."""


def run_chunk(job: Job, start: int, columns: Mapping[str, Array], arguments: Array) -> Chunk:
    """Run some rows, whose parameters stand in `columns`, an array (rows,) by path.

    `arguments` of what is kept have a row for all of them, or one each.
    """
    model = job.model()
    runner = _runner(job)
    vector = runner.flat
    rows = len(next(iter(columns.values())))
    driven = {path: column for path, column in columns.items() if path.count(".") > 1}
    plan = schedule(job.mechanism, driven, rows if driven else 1, job.t_end)
    along = directions_of(
        job.mechanism, job.law, job.gradients, columns, plan.table, job.t_end, job.told
    )
    width = len(job.kinds) // 2
    results, evidence = runner.zeros(rows * width), runner.zeros(rows * EVIDENCE)
    statuses, gradients = runner.zeros(rows), runner.zeros(rows * along.start.size)
    call: list[Any] = [
        vector(np.column_stack(list(columns.values()))),
        vector(_places(model, columns)),
        _base(job, runner),
        vector(plan.table),
        vector(plan.bounds if plan.bounds.size else np.zeros((len(plan.table), 1))),
        vector(plan.time_scale / 6.0),
        vector(job.kinds),
        vector(arguments),
    ]
    written: list[Any] = [results, statuses, evidence]
    if job.gradients:
        run = runner.kernels.enter_batch_sensed
        written += [vector(along.start), vector(along.table), vector(along.own), along.quantities]
        written.append(gradients)
    else:
        run = runner.kernels.enter_batch
    *settings, whole, log, events = _settings(job, runner, along)
    row = 0
    while (row := run(row, rows, *call, *settings, whole, log, events, *written)) < rows:
        log, events = runner.with_room(whole, log, events)
    return Chunk(
        start,
        np.reshape(results, (rows, width)),
        np.asarray(statuses, dtype=np.int8),
        np.reshape(evidence, (rows, -1)),
        np.reshape(gradients, (rows, *along.start.shape)),
    )


def _settings(job: Job, runner: Runner, along: Directions) -> list[Any]:
    """Return what the runs of a chunk are made with: end, limits, and room to work in."""
    header, whole = runner.header, runner.whole()
    size = max(header[SIZE], sense_size(along.quantities, len(along.own), whole))
    return [
        job.t_end,
        job.solver.tolerance_for(job.law),
        int(job.solver.max_steps),
        runner.zeros(size),
        whole,
        runner.zeros(FIRST_ROWS * header[ROW_COLUMNS]),
        runner.zeros(FIRST_ROWS * EVENT_COLUMNS),
    ]


def _runner(job: Job) -> Runner:
    return runner_of(job.model(), compiled=job.solver.tier != "python")


def _places(model: Model, columns: Mapping[str, Array]) -> list[float]:
    """Return where in the vector of a run each column goes."""
    y = model.sizes.header[Y]
    paths = dict(zip(model.parameter_paths, model.places, strict=True))
    paths |= {f"initial.{state}": y + i for i, state in enumerate(model.states)}
    return [float(paths[path]) for path in columns]


def _base(job: Job, runner: Runner) -> Any:
    """Return the vector of a run with the numbers that all rows share."""
    model = job.model()
    values = values_of(job.mechanism, job.law)
    numbers = [float(values[path]) for path in model.parameter_paths]
    base = runner.working(numbers)
    for i, value in enumerate(job.y0, runner.header[Y]):
        base[i] = value
    return base


def _cuts(
    job: Job, columns: Mapping[str, Array], arguments: Array
) -> Iterator[tuple[Job, int, Mapping[str, Array], Array]]:
    """Yield the arguments of `run_chunk` for each chunk: no row is in two of them."""
    pieces = schedule(job.mechanism, {}, 1, job.t_end).table.size + 1
    rows = max(1, min(MOST_ROWS, MOST_NUMBERS // pieces))
    for start in range(0, len(next(iter(columns.values()))), rows):
        part = slice(start, start + rows)
        own = {path: column[part] for path, column in columns.items()}
        yield job, start, own, arguments[part] if len(arguments) > 1 else arguments


def run_chunks(
    job: Job,
    columns: Mapping[str, Array],
    arguments: Array,
    executor: Executor | None,
    keep: Callable[[Chunk], bool],
) -> None:
    """Run all rows and hand over each chunk as it comes; `keep` says whether to go on."""
    check_executor(executor)
    _runner(job)  # compiled here, if it has to be, and not in all threads at once
    cuts = [*_cuts(job, columns, arguments)]
    if executor is None and len(cuts) == 1:  # a thread would cost more than many a chunk
        keep(run_chunk(*cuts[0]))
        return
    spread(run_chunk, cuts, keep, executor)
