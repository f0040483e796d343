"""Runs that go on stretch by stretch, because what drives them is given as late as it begins.

Kernels stop at the end of a stretch as at an end time, and go on from there with all that a run
knows: mode, length of step, sizes for errors, works.

1. One run has a table of the drives with a piece for each stretch, zeros at first. What a stretch
   is told is added to its pieces, as a line in time. Steps and events of all stretches are one
   record, and so one trajectory with one certificate.
2. Nothing that is not told yet may be taken for rest: bounds of the drives are infinite.
3. Many runs are kept as rows of what is needed between stretches alone; room for a run is there
   once for each thread (`_Share`). Drives are constant in a stretch, and nothing is recorded.
"""

import itertools
import math
import os
from bisect import bisect_left
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from time import thread_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.formulation import formulate
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.batch import kept_size
from stickslip.engine.kernels.equations import state_seen
from stickslip.engine.solver import event_driven
from stickslip.engine.solver.backend import Runner, runner_of
from stickslip.engine.solver.run import FIRST_ROWS, STRETCH, Record, work_of
from stickslip.engine.solver.starts import Inputs, gather, values_of, within_stops
from stickslip.engine.trajectory import Status, Trajectory
from stickslip.errors import InputError, check_size
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism

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
        self._w, self._whole = runner.working(inputs.p), runner.whole()
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
        return [float(state_seen(first, i, self._w, self._whole)) for i in states]

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
            self._whole,
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
        if self.solver.tier != "auto" or self._whole[layout.STEPS] < self._asks_at:
            return
        self._asks_at += STRETCH
        if self._work.is_enough(self._spent):
            self.runner = runner = runner_of(self.model, compiled=True)
            self._w, self._whole = runner.taken_over(self._w), runner.wholes(self._whole)
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
        whole = [int(x) for x in self._whole]
        spent = self._spent if self.solver.tier == "auto" else None
        return inputs, Record(self.runner, self._log, self._events, self._w, whole, spent)


# Many runs of one mechanism that go on together, stretch by stretch, in machine code.

FEWEST_RUNS = 16
"""Runs of a thread below which one more thread costs more than it saves."""

Array = NDArray[np.float64]


class IncrementalEnsemble:
    """Runs whose drives are told for all of them at once, a constant value for each stretch.

    Mode, step lengths and sizes go on from stretch to stretch, as in `IncrementalRun`; what the
    runs did before is not recorded. Each run may begin anew at any time.
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
        self._wholes = np.tile(np.array([*header], dtype=np.int64), (count, 1))
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
        found = self._kept[:, self._y : self._y + len(self.model.states)].copy()
        header = self.model.sizes.header
        if header[layout.IS_TURNED]:  # from the first stretch on, to coordinates of the equations
            n = header[layout.N_COORDINATES]
            first = layout.POLYNOMIAL + header[layout.TURN] - layout.NUMBERS + n * n
            rows = self._wholes[:, layout.STATUS] != layout.RUNNING
            back = self._kept[rows, first : first + n * n].reshape(-1, n, n)
            moving = found[rows, : 2 * n].reshape(-1, 2, n)
            found[rows, : 2 * n] = np.einsum("rij,rbj->rbi", back, moving).reshape(-1, 2 * n)
        return found

    @property
    def running(self) -> NDArray[np.bool_]:
        """Whether each run can go on (count,)."""
        codes = self._wholes[:, layout.STATUS]
        return np.isin(codes, (layout.RUNNING, layout.END_TIME))

    def status(self, row: int) -> Status:
        """Return how the last stretch of a run ended."""
        return event_driven.status_of(int(self._wholes[row, layout.STATUS]), self.model)

    def begin(
        self,
        rows: Sequence[int] | NDArray[np.intp],
        states: Array,
        mechanism: Mechanism | None = None,
        law: FrictionLaw | Laws | None = None,
    ) -> None:
        """Let some runs begin anew at time 0, with other parameters if these are given."""
        if not np.isfinite(states).all():
            raise InputError(f"states must be finite, got {states!r}.")
        mechanism = mechanism or self.mechanism
        placed = [within_stops(mechanism, state) for state in states]
        values = values_of(mechanism, law or self.law)
        self._kept[rows] = self._fresh
        self._wholes[rows] = self._runner.header
        for path, place in zip(self.model.parameter_paths, self.model.places, strict=True):
            self._kept[rows, layout.POLYNOMIAL + place - layout.NUMBERS] = values[path]
        self._kept[rows, self._y : self._y + len(self.model.states)] = placed

    def leave(self, rows: Sequence[int] | NDArray[np.intp]) -> None:
        """Let some runs go no further until they begin anew."""
        # A status with which the kernels pass over a run.
        self._wholes[rows, layout.STATUS] = layout.STEP_TOO_SMALL

    def advance(self, untils: Array, values: Array) -> None:
        """Go on with all runs that have not ended, the drives having constant values."""
        shapes = {"untils": (self.count,), "values": (self.count, len(self.model.drives))}
        for (name, shape), given in zip(shapes.items(), (untils, values), strict=True):
            if given.size != math.prod(shape):
                raise InputError(f"{name} must have the shape {shape}, got {given.shape}.")
        flat = self._runner.flat
        shared = (flat(values), flat(untils), self._bounds, self._tolerance, self._cap, self._most)
        runs = (self._kept.reshape(-1), self._wholes.reshape(-1))  # the same memory
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
            runner.wholes(header),
            runner.zeros(1 + 3 * header[layout.N_DRIVES]),
        )
        self._log = runner.zeros(FIRST_ROWS * header[layout.ROW_COLUMNS])
        self._events = runner.zeros(2 * header[layout.MOST_EVENTS] * layout.EVENT_COLUMNS)

    def go_on(self, shared: tuple[Any, ...], runs: tuple[Any, ...]) -> None:
        """Go on with the runs by a stretch."""
        enter, row = self.runner.kernels.enter_stretches, self.first
        whole = self._room[1]
        while True:
            row = enter(row, self.count, *shared, *runs, *self._room, self._log, self._events)
            if row == self.count:
                return
            self._log, self._events = self.runner.with_room(whole, self._log, self._events)
