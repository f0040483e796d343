"""Runs many rows in chunks: the work of an ensemble, cut so that it fits any executor."""

import os
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.formulation import Model, formulate
from stickslip.friction import FrictionLaw, Laws
from stickslip.kernels.batch import EVIDENCE
from stickslip.kernels.sensitivities import sense_size
from stickslip.kernels.state_layout import EVENT_COLUMNS, ROW_COLUMNS, SIZE, Y
from stickslip.mechanisms import Mechanism
from stickslip.solver.backend import Runner, runner_of
from stickslip.solver.drive_schedule import schedule, values_of
from stickslip.solver.event_driven import EventDriven
from stickslip.solver.reducers import Output, asked, is_gradient
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
    outputs: Mapping[str, Output]
    """What is kept of each run, by name."""
    solver: EventDriven
    """Tolerance, most steps and tier of the runs."""
    count: int
    """Number of runs."""
    told: tuple[str, ...]
    """States that begin where the mechanism says."""

    def gradients(self) -> tuple[str, ...]:
        """Return the full paths of which sensitivities are wanted."""
        return tuple(sorted({o.parameter for o in self.outputs.values() if is_gradient(o)}))

    def model(self) -> Model:
        """Return the equations, with their slopes where they are needed."""
        return formulate(self.mechanism, self.law, slopes=bool(self.gradients()))


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


def run_chunk(job: Job, start: int, columns: Mapping[str, Array]) -> Chunk:
    """Run some rows, whose parameters stand in `columns`, an array (rows,) by path."""
    model = job.model()
    runner = _runner(job)
    vector = runner.flat
    rows = len(next(iter(columns.values())))
    driven = {path: column for path, column in columns.items() if path.count(".") > 1}
    plan = schedule(job.mechanism, driven, rows if driven else 1, job.t_end)
    kinds, arguments, _ = asked(job.outputs, model, job.t_end, job.count)
    own = arguments[start : start + rows] if len(arguments) > 1 else arguments
    along = directions_of(
        job.mechanism, job.law, job.gradients(), columns, plan.table, job.t_end, job.told
    )
    width = len(kinds) // 2
    results, evidence = runner.zeros(rows * width), runner.zeros(rows * EVIDENCE)
    statuses, gradients = runner.zeros(rows), runner.zeros(rows * along.start.size)
    call: list[Any] = [
        vector(np.column_stack(list(columns.values()))),
        vector(_places(model, columns)),
        _base(job, runner),
        vector(plan.table),
        vector(plan.bounds if plan.bounds.size else np.zeros((len(plan.table), 1))),
        vector(plan.time_scale / 6.0),
        vector(kinds),
        vector(own),
    ]
    written: list[Any] = [results, statuses, evidence]
    if job.gradients():
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


def _cuts(job: Job, columns: Mapping[str, Array]) -> Iterator[tuple[int, Mapping[str, Array]]]:
    """Yield first row and columns of each chunk."""
    pieces = schedule(job.mechanism, {}, 1, job.t_end).table.size + 1
    rows = max(1, min(MOST_ROWS, MOST_NUMBERS // pieces))
    for start in range(0, job.count, rows):
        yield start, {path: column[start : start + rows] for path, column in columns.items()}


def run_chunks(
    job: Job,
    columns: Mapping[str, Array],
    executor: Executor | None,
    keep: Callable[[Chunk], bool],
) -> None:
    """Run all rows and hand over each chunk as it comes; `keep` says whether to go on."""
    if not (executor is None or hasattr(executor, "submit")):
        raise InputError(f"executor must be a concurrent.futures.Executor, got {executor!r}.")
    _runner(job)  # compiled here, if it has to be, and not in all threads at once
    cuts = [*_cuts(job, columns)]
    if executor is None and len(cuts) == 1:  # a thread would cost more than many a chunk
        keep(run_chunk(job, *cuts[0]))
        return
    own = ThreadPoolExecutor(os.cpu_count() or 1) if executor is None else None
    pool = executor or own
    assert pool is not None
    most = 2 * (os.cpu_count() or 1) + 2
    pending: set[Future[Chunk]] = set()
    try:
        for start, part in cuts:
            pending.add(pool.submit(run_chunk, job, start, part))
            while len(pending) >= most:
                pending, going = _collect(pending, keep)
                if not going:
                    return
        while pending:
            pending, going = _collect(pending, keep)
            if not going:
                return
    finally:
        for future in pending:
            future.cancel()
        if own is not None:
            own.shutdown(cancel_futures=True)


def _collect(
    pending: set[Future[Chunk]], keep: Callable[[Chunk], bool]
) -> tuple[set[Future[Chunk]], bool]:
    """Wait for the next chunks; return what is still pending, and whether to go on."""
    done, waiting = wait(pending, return_when=FIRST_COMPLETED)
    going = True
    for future in done:
        chunk = future.result()
        going = going and keep(chunk)
    return waiting, going
