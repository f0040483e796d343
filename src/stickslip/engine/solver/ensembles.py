"""Ensembles: parameters as arrays in, arrays of outputs out.

All runs have the same equations and differ in numbers.

1. Values are checked: their ranges for all, and the objects that the extreme ones make.
2. Rows are cut into chunks, of bounded memory, and of some work each where runs are known to take
   long; a chunk is a task of the executor, or of a thread.
3. A chunk has one vector of a run, with what all rows share; for each row its numbers are put into
   their places (`kernels.batch`). Drives that vary have a schedule a row, others one for all.
4. Of each run the kernels keep outputs, how it ended, and the evidence of a certificate; where no
   room is left for steps or events, they come back, get more, and go on with that row.

Rows do not depend on each other, and not on how they were cut: results are those of `simulate`, to
the bit, on any number of threads.
"""

import itertools
import math
import os
from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, replace
from time import thread_time
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.engine.executors import check_executor, spread, threads
from stickslip.engine.formulation import Model, formulate
from stickslip.engine.kernels import state_layout
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.batch import EVIDENCE, kept_size
from stickslip.engine.kernels.equations import state_seen
from stickslip.engine.kernels.sensitivities import sense_size
from stickslip.engine.kernels.state_layout import EVENT_COLUMNS, ROW_COLUMNS, SIZE, Y
from stickslip.engine.solver import certify, event_driven, reducers, starts
from stickslip.engine.solver.backend import Runner, runner_of
from stickslip.engine.solver.event_driven import EventDriven, status_of
from stickslip.engine.solver.run import FIRST_ROWS, STRETCH, Record, path_units, work_of
from stickslip.engine.solver.starts import Inputs, gather, values_of, within_stops
from stickslip.engine.trajectory import Ensemble, Status, Trajectory
from stickslip.errors import InputError, ParameterError, check_size, concerning
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, parameters, standing_path, vary

# Runs that go on stretch by stretch, because what drives them is given as late as it begins.
#
# Kernels stop at the end of a stretch as at an end time, and go on from there with all that a run
# knows: mode, length of step, sizes for errors, works.
#
# 1. One run has a table of the drives with a piece for each stretch, zeros at first. What a stretch
#    is told is added to its pieces, as a line in time. Steps and events of all stretches are one
#    record, and so one trajectory with one certificate.
# 2. Nothing that is not told yet may be taken for rest: bounds of the drives are infinite.
# 3. Many runs are kept as rows of what is needed between stretches alone; room for a run is there
#    once for each thread (`_Share`). Drives are constant in a stretch, and nothing is recorded.

# A run that goes on stretch by stretch, because what drives it is told as late as it begins.


class IncrementalRun:
    """A run from time 0 on, of which some drives are told stretch by stretch.

    Nothing is started anew between stretches: mode, events, work and errors go on, and what is
    recorded is one run with one certificate.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws,
        *,
        drives: Sequence[str],
        y0: Sequence[float],
        t_end: float,
        solver: event_driven.EventDriven,
    ) -> None:
        """Begin at time 0.

        `drives` are the names of the drives that are told; the mechanism's own ones have zeros,
        with a piece for each stretch.
        """
        self.law, self.t_end, self.solver = law, t_end, solver
        self.model = model = formulate(mechanism, law)
        self._work = work_of(model)
        self._spent, self._asks_at = 0.0, STRETCH
        compiled = solver.tier == "compiled" or (solver.tier == "auto" and self._work.is_enough())
        self.runner = runner = runner_of(model, compiled=compiled)
        inputs = gather(mechanism, law, model, t_end)
        self._width = 1 + 3 * len(model.drives)
        self._columns = [1 + 3 * model.drives.index(drive) for drive in drives]
        self._starts = inputs.table[:: self._width].tolist()
        self._row, self._begun = 0, False
        self._table = runner.flat(inputs.table)
        # what is not told yet may do anything, so no rest is for good
        self._bounds = runner.vector([math.inf] * max(len(inputs.bounds), 1))
        self._cap = inputs.time_scale / 6.0
        self._w, self._iw = runner.working(inputs.p), runner.iw()
        self._log = runner.zeros(FIRST_ROWS * runner.header[layout.ROW_COLUMNS])
        self._events = runner.zeros(2 * runner.header[layout.MOST_EVENTS] * layout.EVENT_COLUMNS)
        for i, value in enumerate(within_stops(mechanism, y0), runner.header[layout.Y]):
            self._w[i] = float(value)

    @property
    def t(self) -> float:
        """Time that is reached [s]."""
        return float(self._w[layout.TIME])

    def state(self) -> list[float]:
        """Return the states at that time."""
        first = self.runner.header[layout.Y]
        if not self._begun:  # until then they are in coordinates of the mechanism
            return [float(x) for x in self._w[first : first + len(self.model.states)]]
        states = range(len(self.model.states))
        return [float(state_seen(first, i, self._w, self._iw)) for i in states]

    def advance(self, until: float, lines: Sequence[tuple[float, float]]) -> bool:
        """Run on to a time, each drive along a line; return whether it was reached."""
        last, now = bisect_left(self._starts, until), self.t
        # In all pieces of the stretch: lines are told from now on, and rows count from their
        # starts.
        for row in range(self._row, last):
            for column, (value, slope) in zip(self._columns, lines, strict=True):
                at = row * self._width + column
                self._table[at] += value + slope * max(self._starts[row] - now, 0.0)
                self._table[at + 1] += slope
        self._row, self._begun = last, True
        start = thread_time()
        self._log, self._events = self.runner.run(
            self._w,
            self._iw,
            self._table,
            self._bounds,
            until,
            self.solver.tolerance_for(self.law),
            self._cap,
            int(self.solver.max_steps),
            self._log,
            self._events,
        )
        if not self.runner.compiled:
            self._count(thread_time() - start)
        return bool(self.t >= until)

    def _count(self, seconds: float) -> None:
        """Count the time of a stretch in plain Python; take machine code as soon as it pays."""
        self._work.add(seconds)
        self._spent += seconds
        if self.solver.tier != "auto" or self._iw[layout.STEPS] < self._asks_at:
            return
        self._asks_at += STRETCH
        if self._work.is_enough(self._spent):
            self.runner = runner = runner_of(self.model, compiled=True)
            self._w, self._iw = runner.taken_over(self._w), runner.int_vectors(self._iw)
            self._log, self._events, self._table, self._bounds = map(
                runner.flat, (self._log, self._events, self._table, self._bounds)
            )

    def finished(self, mechanism: Mechanism) -> Trajectory:
        """Return the run, of the mechanism with the drives that were told."""
        inputs, record = self._recorded(mechanism)
        tolerance = self.solver.tolerance_for(self.law)
        return event_driven.trajectory_of(
            mechanism, self.law, self.model, inputs, record, tolerance, self.t_end
        )

    def bare(self, mechanism: Mechanism) -> event_driven.BareRun:
        """Return the run as `finished` does, without a certificate."""
        inputs, record = self._recorded(mechanism)
        return event_driven.bare_run(mechanism, self.law, self.model, inputs, record, self.t_end)

    def _recorded(self, mechanism: Mechanism) -> tuple[Inputs, Record]:
        """Return the numbers of the run, and what the kernels wrote down of it."""
        inputs = gather(mechanism, self.law, self.model, self.t_end)
        iw = [int(x) for x in self._iw]
        spent = self._spent if self.solver.tier == "auto" else None
        return inputs, Record(self.runner, self._log, self._events, self._w, iw, spent)


# Many runs of one mechanism that go on together, stretch by stretch, in machine code.

FEWEST_RUNS = 16
"""Runs of a thread below which one more thread costs more than it saves."""

Array = NDArray[np.float64]


class IncrementalEnsemble:
    """Runs whose drives are told for all of them at once, a constant value for each stretch.

    Mode, step lengths and sizes go on from stretch to stretch, as in `IncrementalRun`; what the
    runs did before is not recorded. Each run may begin anew at any time.

    Parameters
    ----------
    mechanism : Mechanism
        What moves; its drives say nothing but their number.
    law : FrictionLaw or Laws
        Friction of its contact.
    count : int
        Number of runs.
    solver : EventDriven
        Tolerance, and most steps of a stretch.
    threads : int, optional
        Most threads; as many as there are processors if not given.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws,
        *,
        count: int,
        solver: event_driven.EventDriven,
        threads: int | None = None,
    ) -> None:
        """Make room for the runs; each has to begin before it can go on."""
        if threads is not None and threads < 1:
            raise InputError(f"threads must be at least 1, got {threads!r}.")
        self.mechanism, self.law, self.count, self.solver = mechanism, law, count, solver
        self.threads = threads
        self.model = model = formulate(mechanism, law)
        inputs = gather(mechanism, law, model, 0.0)
        self._p, self._cap = inputs.p, inputs.time_scale / 6.0
        self._tolerance, self._most = solver.tolerance_for(law), int(solver.max_steps)
        header = model.sizes.header
        check_size("ensemble", float(count) * kept_size([*header]), "make fewer runs together")
        self._width, self._y = (
            kept_size([*header]),
            layout.POLYNOMIAL + header[layout.Y] - layout.NUMBERS,
        )
        self._kept = np.zeros((count, self._width))
        # sizes of those that have not begun count too: the kernels look at all rows
        self._int_vectors = np.tile(np.array([*header], dtype=np.int64), (count, 1))
        self.leave(range(count))
        self._work()

    def _work(self) -> None:
        """Get the code, and room to work in."""
        self._runner = runner = runner_of(self.model, compiled=True)
        w = runner.working(self._p)
        self._fresh = np.concatenate([w[: layout.POLYNOMIAL], w[layout.NUMBERS :]])
        most = os.cpu_count() or 1 if self.threads is None else self.threads
        shares = max(1, min(most, self.count // FEWEST_RUNS))
        cuts = [self.count * k // shares for k in range(shares + 1)]
        self._shares = [_Share(runner, a, b) for a, b in itertools.pairwise(cuts)]
        self._pool = ThreadPoolExecutor(max(1, shares - 1))  # starts no thread before it has work
        self._bounds = runner.vector([math.inf] * max(2 * runner.header[layout.N_DRIVES], 1))

    def __getstate__(self) -> dict[str, Any]:
        """Pickle numbers only: code and threads belong to a process."""
        left = ("_runner", "_fresh", "_shares", "_pool", "_bounds")
        return {name: value for name, value in vars(self).items() if name not in left}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Get code and threads of this process."""
        vars(self).update(state)
        self._work()
        # Addresses of this process in place of those of the pickle.
        self._kept[:, layout.ADDRESS : layout.SEVERAL + 1] = self._fresh[
            layout.ADDRESS : layout.SEVERAL + 1
        ]

    @property
    def t(self) -> Array:
        """Time that each run has reached (count,) [s]."""
        return self._kept[:, layout.TIME].copy()

    @property
    def states(self) -> Array:
        """States of the runs (count, n) [SI]."""
        result = self._kept[:, self._y : self._y + len(self.model.states)].copy()
        header = self.model.sizes.header
        if header[layout.IS_TURNED]:  # from the first stretch on, to coordinates of the equations
            n = header[layout.N_COORDINATES]
            first = layout.POLYNOMIAL + header[layout.TURN] - layout.NUMBERS + n * n
            rows = self._int_vectors[:, layout.STATUS] != layout.RUNNING
            back = self._kept[rows, first : first + n * n].reshape(-1, n, n)
            moving = result[rows, : 2 * n].reshape(-1, 2, n)
            result[rows, : 2 * n] = np.einsum("rij,rbj->rbi", back, moving).reshape(-1, 2 * n)
        return result

    @property
    def running(self) -> NDArray[np.bool_]:
        """Whether each run can go on (count,)."""
        codes = self._int_vectors[:, layout.STATUS]
        return np.isin(codes, (layout.RUNNING, layout.END_TIME))

    def status(self, row: int) -> Status:
        """Return how the last stretch of a run ended."""
        return event_driven.status_of(int(self._int_vectors[row, layout.STATUS]), self.model)

    def begin(
        self,
        rows: Sequence[int] | NDArray[np.intp],
        states: Array,
        mechanism: Mechanism | None = None,
        law: FrictionLaw | Laws | None = None,
    ) -> None:
        """Let some runs begin anew at time 0, with other parameters if these are given.

        Parameters
        ----------
        rows : sequence of int
            Which runs.
        states : array (rows, n)
            Where they begin [SI].
        mechanism : Mechanism, optional
            The same with other values.
        law : FrictionLaw or Laws, optional
            One with the same equations and other values.

        Raises
        ------
        InputError
            If a state is not finite.
        """
        if not np.isfinite(states).all():
            raise InputError(f"states must be finite, got {states!r}.")
        mechanism = mechanism or self.mechanism
        placed = [within_stops(mechanism, state) for state in states]
        values = values_of(mechanism, law or self.law)
        self._kept[rows] = self._fresh
        self._int_vectors[rows] = self._runner.header
        for path, place in zip(self.model.parameter_paths, self.model.places, strict=True):
            self._kept[rows, layout.POLYNOMIAL + place - layout.NUMBERS] = values[path]
        self._kept[rows, self._y : self._y + len(self.model.states)] = placed

    def leave(self, rows: Sequence[int] | NDArray[np.intp]) -> None:
        """Let some runs go no further until they begin anew."""
        # A status with which the kernels pass over a run.
        self._int_vectors[rows, layout.STATUS] = layout.STEP_TOO_SMALL

    def advance(self, untils: Array, values: Array) -> None:
        """Go on with all runs that have not ended, the drives having constant values.

        Parameters
        ----------
        untils : array (count,)
            Times at which the stretch ends [s].
        values : array (count, drives)
            Values of the drives in it [SI].

        Raises
        ------
        InputError
            If there is not a value for each run and drive.
        """
        shapes = {"untils": (self.count,), "values": (self.count, len(self.model.drives))}
        for (name, shape), given in zip(shapes.items(), (untils, values), strict=True):
            if given.size != math.prod(shape):
                raise InputError(f"{name} must have the shape {shape}, got {given.shape}.")
        flat = self._runner.flat
        shared = (flat(values), flat(untils), self._bounds, self._tolerance, self._cap, self._most)
        runs = (self._kept.reshape(-1), self._int_vectors.reshape(-1))  # the same memory
        # This thread takes the first share itself.
        first, *others = self._shares
        waiting = [self._pool.submit(share.go_on, shared, runs) for share in others]
        first.go_on(shared, runs)
        for future in waiting:
            future.result()


class _Share:
    """The runs of one thread, and its room to work in."""

    def __init__(self, runner: Runner, first: int, count: int) -> None:
        header = runner.header
        self.runner, self.first, self.count = runner, first, count
        self._room = (
            runner.zeros(header[layout.SIZE]),
            runner.int_vectors(header),
            runner.zeros(1 + 3 * header[layout.N_DRIVES]),
        )
        self._log = runner.zeros(FIRST_ROWS * header[layout.ROW_COLUMNS])
        self._events = runner.zeros(2 * header[layout.MOST_EVENTS] * layout.EVENT_COLUMNS)

    def go_on(self, shared: tuple[Any, ...], runs: tuple[Any, ...]) -> None:
        """Go on with the runs by a stretch."""
        enter, row = self.runner.kernels.enter_stretches, self.first
        iw = self._room[1]
        while True:
            row = enter(row, self.count, *shared, *runs, *self._room, self._log, self._events)
            if row == self.count:
                return
            self._log, self._events = self.runner.with_room(iw, self._log, self._events)


# Ensembles: parameters as arrays in, arrays of outputs out.


MOST_ROWS = 4096
"""Runs in a chunk: some ten milliseconds of work, and memory that does not grow with the whole."""
LEAST_WORK = 0.01
"""Processor time [s] of a chunk that is worth a thread, where runs are known to take long."""
MOST_NUMBERS = 1 << 21
"""Numbers that the drives' tables of a chunk may have."""
RESERVED = ("status", "certified")
"""Columns that a table of an ensemble has of itself."""
FEWER = "make several smaller ensembles"


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
    # Without drives that vary, one schedule serves all rows. Parameters of drives have a dot more
    # than those of the mechanism itself; so have laws by contact, which cost a schedule a row.
    driven = {path: column for path, column in columns.items() if path.count(".") > 1}
    plan = starts.schedule(job.mechanism, driven, rows if driven else 1, job.t_end)
    along = certify.directions_of(
        job.mechanism, model, job.gradients, columns, plan.table, job.t_end, job.told
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
    *settings, iw, log, events = _settings(job, runner, along)
    row, begun = 0, thread_time()
    # The kernels come back where rows or events find no room, and go on with the same run.
    while (row := run(row, rows, *call, *settings, iw, log, events, *written)) < rows:
        log, events = runner.with_room(iw, log, events)
    # Processor time of a run, by which later ensembles of this model are cut into chunks.
    work_of(model).pace = (thread_time() - begun) / rows
    return Chunk(
        start,
        np.reshape(results, (rows, width)),
        np.asarray(statuses, dtype=np.int8),
        np.reshape(evidence, (rows, -1)),
        np.reshape(gradients, (rows, *along.start.shape)),
    )


def _settings(job: Job, runner: Runner, along: certify.Directions) -> list[Any]:
    """Return what the runs of a chunk are made with: end, limits, and room to work in."""
    header, iw = runner.header, runner.iw()
    # Sensitivities stand behind the vector of a run, which is longer then.
    size = max(header[SIZE], sense_size(along.quantities, len(along.own), iw))
    return [
        job.t_end,
        job.solver.tolerance_for(job.law),
        int(job.solver.max_steps),
        runner.zeros(size),
        iw,
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
    values = starts.values_of(job.mechanism, job.law)
    numbers = [float(values[path]) for path in model.parameter_paths]
    base = runner.working(numbers)
    for i, value in enumerate(job.y0, runner.header[Y]):
        base[i] = value
    return base


def _cuts(
    job: Job, columns: Mapping[str, Array], arguments: Array, shares: int
) -> Iterator[tuple[Job, int, Mapping[str, Array], Array]]:
    """Yield the arguments of `run_chunk` for each chunk: no row is in two of them.

    Runs that are known to take long are divided into so many shares.
    """
    pieces = starts.schedule(job.mechanism, {}, 1, job.t_end).table.size + 1
    count = len(next(iter(columns.values())))
    # A chunk holds the tables of all its rows: fewer rows where drives have many pieces.
    rows = max(1, min(MOST_ROWS, MOST_NUMBERS // pieces))
    pace = work_of(job.model()).pace
    if pace * count > 2.0 * LEAST_WORK:
        # A chunk that is worth a thread, and not more of them than there are shares.
        rows = min(rows, max(math.ceil(LEAST_WORK / pace), math.ceil(count / shares)))
    for start in range(0, count, rows):
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
    cuts = [*_cuts(job, columns, arguments, threads() if executor is None else 1)]
    if executor is None and len(cuts) == 1:  # a thread would cost more than many a chunk
        keep(run_chunk(*cuts[0]))
        return
    spread(run_chunk, cuts, keep, executor)


def run_ensemble(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    varied: Mapping[str, ArrayLike],
    *,
    y0: Sequence[float],
    told: Sequence[str],
    t_end: float,
    outputs: Sequence[str] | Mapping[str, reducers.Output] | None,
    solver: EventDriven,
    executor: Executor | None,
    progress: Callable[[int, int], object] | None,
) -> Ensemble:
    """Run an ensemble; see `stickslip.ensemble`, and `told` in `Solver.run`."""
    model = formulate(mechanism, law)
    columns, count = check_columns(mechanism, law, varied)
    wanted = _outputs(mechanism, law, model, outputs)
    told = tuple(state for state in told if f"initial.{state}" not in columns)
    kinds, arguments, places = reducers.asked(wanted, model, t_end, count)
    gradients = tuple(
        sorted({output.parameter for output in wanted.values() if reducers.is_gradient(output)})
    )
    job = Job(mechanism, law, tuple(y0), t_end, kinds, gradients, solver, told)
    parts = _Parts(job, model, wanted, places, count)

    def keep(chunk: Chunk) -> bool:
        parts.add(chunk)
        answer = None if progress is None else progress(parts.done, count)
        return answer is None or bool(answer)

    begun = starts.starts_as_told(mechanism, columns, told)
    begun = starts.starts_within_stops(mechanism, begun, y0)
    # Where anything is extreme; to look at the masses of each row would take too long.
    for row in _extreme(columns):
        state = [
            float(begun.get(f"initial.{name}", np.full(count, value))[row])
            for name, value in zip(mechanism.coordinates, y0, strict=False)
        ]
        starts.refuse_masses(_varied(mechanism, "mechanism", columns, row), state)
    run_chunks(job, begun, arguments, executor, keep)
    bristles = model.states[2 * len(mechanism.coordinates) :]
    units = path_units(mechanism, law, bristles)
    units |= {state: units[f"initial.{state}"] for state in model.states}
    return parts.joined(columns, units)


class _Parts:
    """What came of the chunks so far."""

    def __init__(
        self,
        job: Job,
        model: Model,
        wanted: Mapping[str, reducers.Output],
        places: Mapping[str, slice],
        count: int,
    ) -> None:
        self.job, self.model, self.wanted, self.places = job, model, wanted, places
        columns, slopes = len(job.kinds) // 2, len(model.states) * len(job.gradients)
        check_size("ensemble", count * (columns + EVIDENCE + slopes), FEWER)
        # What a cancelled ensemble has not run stays NaN.
        self.results = np.full((count, columns), np.nan)
        self.codes = np.zeros(count, dtype=np.int8)
        self.evidence = np.full((count, EVIDENCE), np.nan)
        self.gradients = np.full((count, len(model.states), len(job.gradients)), np.nan)
        self.done = 0

    def add(self, chunk: Chunk) -> None:
        """Keep what came of a chunk."""
        rows = slice(chunk.start, chunk.start + len(chunk.statuses))
        self.results[rows], self.codes[rows] = chunk.results, chunk.statuses
        self.evidence[rows], self.gradients[rows] = chunk.evidence, chunk.gradients
        self.done += len(chunk.statuses)

    def joined(self, columns: Mapping[str, Array], units: Mapping[str, str]) -> Ensemble:
        """Return all of it."""
        wanted, evidence = self.wanted, self.evidence
        for name, output in wanted.items():
            if reducers.is_gradient(output):
                state = self.model.states.index(output.state)
                direction = self.job.gradients.index(output.parameter)
                self.results[:, self.places[name]] = self.gradients[:, state, direction, None]
        # A status for each code of the kernels, limits behind all others.
        most = state_layout.LIMITED + len(self.model.limits)
        status = np.array([status_of(code, self.model) for code in range(most)])[self.codes]
        return Ensemble(
            outputs={
                name: reducers.value_of(self.results, place, wanted[name])
                for name, place in self.places.items()
            },
            parameters=columns,
            status=status,
            certified=certify.passes(evidence, status, self.job.solver.tolerance_for(self.job.law)),
            energy_error=evidence[:, 0],
            guard_violation=evidence[:, 1],
            event_residual=evidence[:, 2],
            steps=np.nan_to_num(evidence[:, 3]).astype(np.int64),
            units={
                **{path: units[path] for path in columns},
                **{name: reducers.output_unit(reducer, units) for name, reducer in wanted.items()},
            },
        )


def _outputs(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    model: Model,
    outputs: Sequence[str] | Mapping[str, reducers.Output] | None,
) -> Mapping[str, reducers.Output]:
    if isinstance(outputs, (str, reducers.Output)):
        raise InputError(f"outputs must be a sequence of names or a mapping, got {outputs!r}.")
    for name in outputs or ():
        if not _is_name(name):
            raise InputError(
                "outputs must be names of states, or a mapping from names other than"
                f" {', '.join(RESERVED)} to Final, Max, ...; got {name!r}."
            )
    if outputs is None or not isinstance(outputs, Mapping):
        return {
            name: reducers.Final(name) for name in (model.states if outputs is None else outputs)
        }
    for name, output in outputs.items():
        if not isinstance(output, reducers.Output):
            raise InputError(
                f"outputs[{name!r}] must be Final, Max, Min, Mean, Samples, EventTimes,"
                f" EventCount or Sensitivity, got {output!r}."
            )
    known, roots = certify.quantities_of(mechanism, law, model), certify.roots_of(mechanism, law)
    return {
        name: replace(o, parameter=standing_path(o.parameter, known, roots))
        if reducers.is_gradient(o)
        else o
        for name, o in outputs.items()
    }


def _is_name(name: object) -> bool:
    return isinstance(name, str) and name not in RESERVED


def check_columns(
    mechanism: Mechanism, law: FrictionLaw | Laws, varied: Mapping[str, ArrayLike]
) -> tuple[dict[str, Array], int]:
    """Return what varies by full path, checked, and the number of runs."""
    model = formulate(mechanism, law)
    if not isinstance(varied, Mapping):
        raise InputError(f"parameters must be a mapping from paths to arrays, got {varied!r}.")
    known = certify.quantities_of(mechanism, law, model)
    check_size("ensemble", sum(map(np.size, varied.values())), FEWER)
    roots = certify.roots_of(mechanism, law)
    given = {
        standing_path(path, known, roots): _numbers(path, values) for path, values in varied.items()
    }
    if len(given) < len(varied):
        raise InputError("parameters must name each parameter only once, got: " + ", ".join(varied))
    lengths = {len(values) for values in given.values() if values.ndim}
    if len(lengths) != 1:
        sizes = ", ".join(f"{path} {np.size(values)}" for path, values in given.items()) or "none"
        raise InputError(
            "parameters must contain at least one array, and arrays of equal length, got: " + sizes
        )
    (count,) = lengths
    if count == 0:
        raise InputError("parameters must contain at least one value each, got empty arrays.")
    # A copy: a broadcast number is one place that all rows share.
    columns = {path: np.broadcast_to(values, count).copy() for path, values in given.items()}
    _check(mechanism, law, model, columns, known)
    return columns, count


def as_numbers(path: str, values: ArrayLike) -> Array:
    """Return values of a parameter as an array."""
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{path} must be an array of numbers, got {values!r}.") from None


def _numbers(path: str, values: ArrayLike) -> Array:
    array = as_numbers(path, values)
    if array.ndim > 1:
        raise InputError(f"{path} must be an array (n,), got one of {array.shape}.")
    return array


def _check(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    model: Model,
    columns: Mapping[str, Array],
    known: Mapping[str, Quantity],
) -> None:
    """Check ranges of all numbers, and the objects that the extreme ones make."""
    for path, values in columns.items():
        owner, _, name = path.rpartition(".")
        if not np.isfinite(values).all():
            odd = int(np.flatnonzero(~np.isfinite(values))[0])
            raise ParameterError(
                f"{path} must be finite in all runs, got {values[odd]} in run {odd}."
            )
        for value in (values.min(), values.max()):
            known[path].check(owner, name, float(value))
    # Ranges hold by the extremes; what depends on several parameters is checked there alone.
    for row in sorted(_extreme(columns) | starts.narrowest(mechanism, columns)):
        own = _varied(mechanism, "mechanism", columns, row)
        try:
            starts.refuse_turned(own, model)
        except InputError as error:
            raise InputError(f"run {row}: {error}") from None
        _varied(law, "friction", columns, row)
    _check_order(law, "friction", columns)


def _extreme(columns: Mapping[str, Array]) -> set[int]:
    """Return the runs with the least and the largest value of anything."""
    return {int(f(values)) for values in columns.values() for f in (np.argmin, np.argmax)}


def _varied(root: Any, prefix: str, columns: Mapping[str, Array], row: int) -> Any:
    own = {p: float(v[row]) for p, v in columns.items() if p.startswith(prefix + ".")}
    with concerning(f"run {row}:"):
        return vary(root, prefix, own) if own else root


def _check_order(law: FrictionLaw | Laws, prefix: str, columns: Mapping[str, Array]) -> None:
    """Check the order of parameters that must not fall below others, in all runs."""
    values = {path: value for path, _, value in parameters(law, prefix)}
    for path, quantity, value in parameters(law, prefix):
        if quantity.at_least is None:
            continue
        floor = f"{path.rpartition('.')[0]}.{quantity.at_least}"
        low = columns.get(floor, np.array(values[floor]))
        below = np.atleast_1d(columns.get(path, np.array(value)) < low)
        if below.any():
            _varied(law, prefix, columns, int(np.argmax(below)))
