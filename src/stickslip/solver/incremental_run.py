"""A run that goes on stretch by stretch, because what drives it is told as late as it begins."""

import math
from bisect import bisect_left
from collections.abc import Sequence
from time import thread_time
from typing import final

from stickslip.formulation import formulate
from stickslip.friction import FrictionLaw, Laws
from stickslip.kernels.equations import state_seen
from stickslip.kernels.state_layout import EVENT_COLUMNS, MOST_EVENTS, ROW_COLUMNS, STEPS, TIME, Y
from stickslip.mechanisms import Mechanism
from stickslip.solver.backend import runner_of
from stickslip.solver.drive_schedule import Inputs, gather
from stickslip.solver.event_driven import BareRun, EventDriven, bare_run, trajectory_of
from stickslip.solver.initial_states import within_stops
from stickslip.solver.run import FIRST_ROWS, STRETCH, Record, work_of
from stickslip.trajectory import Trajectory


@final
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
        solver: EventDriven,
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
        self._log = runner.zeros(FIRST_ROWS * runner.header[ROW_COLUMNS])
        self._events = runner.zeros(2 * runner.header[MOST_EVENTS] * EVENT_COLUMNS)
        for i, value in enumerate(within_stops(mechanism, y0), runner.header[Y]):
            self._w[i] = float(value)

    @property
    def t(self) -> float:
        """Time that is reached [s]."""
        return float(self._w[TIME])

    def state(self) -> list[float]:
        """Return the states at that time."""
        first = self.runner.header[Y]
        if not self._begun:  # until then they are in coordinates of the mechanism
            return [float(x) for x in self._w[first : first + len(self.model.states)]]
        states = range(len(self.model.states))
        return [float(state_seen(first, i, self._w, self._whole)) for i in states]

    def advance(self, until: float, lines: Sequence[tuple[float, float]]) -> bool:
        """Run on to a time, each drive along a line; return whether it was reached."""
        last, now = bisect_left(self._starts, until), self.t
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
        if self.solver.tier != "auto" or self._whole[STEPS] < self._asks_at:
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
        return trajectory_of(mechanism, self.law, self.model, inputs, record, tolerance, self.t_end)

    def bare(self, mechanism: Mechanism) -> BareRun:
        """Return the run as `finished` does, without a certificate."""
        inputs, record = self._recorded(mechanism)
        return bare_run(mechanism, self.law, self.model, inputs, record, self.t_end)

    def _recorded(self, mechanism: Mechanism) -> tuple[Inputs, Record]:
        """Return the numbers of the run, and what the kernels wrote down of it."""
        inputs = gather(mechanism, self.law, self.model, self.t_end)
        whole = [int(x) for x in self._whole]
        spent = self._spent if self.solver.tier == "auto" else None
        return inputs, Record(self.runner, self._log, self._events, self._w, whole, spent)
