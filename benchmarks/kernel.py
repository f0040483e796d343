"""The compiled kernel alone: one run as an ensemble or a fit pays for it, without objects."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from stickslip.engine.formulation import formulate
from stickslip.engine.kernels.batch import happened
from stickslip.engine.kernels.state_layout import (
    EVENT_COLUMNS,
    EVENTS,
    REJECTED,
    ROW_COLUMNS,
    STEPS,
    Y,
)
from stickslip.engine.solver.backend import runner_of
from stickslip.engine.solver.certify import directions_of, working
from stickslip.engine.solver.reducers import reasons
from stickslip.engine.solver.starts import gather
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism

LIMIT = 1_000_000
"""Steps after which a run is given up."""


class Kernel:
    """One run of a pair, whose vectors are made once; each run sets them back and fills them.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw
        What holds it back.
    t_end : float
        Last time [s].
    compiled : bool
        Compiled, or the same text in plain Python.
    start : mapping, optional
        Initial states by name; the others are 0.
    slopes : bool
        With the derivatives of the equations, which sensitivities need.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        law: FrictionLaw,
        t_end: float,
        *,
        compiled: bool = True,
        start: Mapping[str, float] | None = None,
        slopes: bool = False,
    ) -> None:
        self.pair = mechanism, law
        self.t_end = t_end
        self.model = formulate(mechanism, law, slopes=slopes)
        self.runner = runner_of(self.model, compiled=compiled)
        self.header = self.runner.header
        self.inputs = gather(mechanism, law, self.model, t_end)
        self._base = self.runner.working(self.inputs.p)
        for state, value in (start or {}).items():
            self._base[self.header[Y] + self.model.states.index(state)] = value
        self._fresh = self.runner.iw()
        self.w, self.iw = self._base.copy(), self._fresh.copy()
        self._tables = [self.runner.flat(self.inputs.table)]
        bounds = self.inputs.bounds if len(self.inputs.bounds) else [0.0]
        self._tables.append(self.runner.flat(bounds))
        self.log = self.runner.zeros(64 * self.header[ROW_COLUMNS])
        self.events = self.runner.zeros(64 * EVENT_COLUMNS)

    def run(self, tolerance: float) -> "Kernel":
        """Run from time 0 to the end; the record stays here until the next run."""
        self.w[:] = self._base
        self.iw[:] = self._fresh
        self.log, self.events = self.runner.run(
            self.w, self.iw, *self._tables, self.t_end, tolerance,
            self.inputs.time_scale / 6.0, LIMIT, self.log, self.events,
        )  # fmt: skip
        return self

    def steps(self) -> int:
        """Return the steps of the last run, rejected ones included."""
        return int(self.iw[STEPS] + self.iw[REJECTED])

    def final(self) -> list[float]:
        """Return the last state."""
        return [float(self.w[self.header[Y] + i]) for i in range(len(self.model.states))]

    def changes(self) -> list[float]:
        """Return the times of the physical events of the last run."""
        names, width = reasons(self.model), EVENT_COLUMNS
        events, iw = list(self.events), list(self.iw)
        return [
            float(self.events[i * width])
            for i in range(int(self.iw[EVENTS]))
            if names[happened(events, i, iw)] is not None
        ]

    def states(self, times: Sequence[float]) -> np.ndarray:
        """Return the states (states, n) of the last run at increasing times."""
        n, width = len(self.model.states), len(times)
        states, rows = self.runner.zeros(n * width), self.runner.zeros(width)
        forces = self.runner.zeros(2 * width)
        self.runner.kernels.enter_play(
            self.log, int(self.iw[STEPS]), self.runner.vector(times),
            self._tables[0], self.runner.working(self.inputs.p),
            self.runner.iw(), states, forces, rows,
        )  # fmt: skip
        return np.reshape(states, (width, n)).T

    def change(self, path: str, value: float) -> None:
        """Set a parameter of the mechanism or the law, not of a drive, for the next runs."""
        self._base[self.model.places[self.model.parameter_paths.index(path)]] = value

    def sensing(self, paths: Sequence[str]) -> Callable[[], np.ndarray]:
        """Return what gives the sensitivities (states, paths) at the end of the last run."""
        table = self.inputs.table[None, :]
        model = formulate(*self.pair)
        along = directions_of(self.pair[0], model, paths, {}, table, self.t_end)
        flat, shape = self.runner.flat, along.start.shape
        w = working(self.runner, self.runner.working(self.inputs.p), along)
        fresh = w.copy()
        out, end = self.runner.zeros(along.start.size), self.runner.vector([self.t_end])
        slopes, own = flat(along.table), flat(along.own)

        def sense() -> np.ndarray:
            w[:] = fresh
            self.runner.kernels.enter_sense(
                self.log, int(self.iw[STEPS]), self.events,
                int(self.iw[EVENTS]), end, self._tables[0], slopes, own,
                along.quantities, w, self.runner.iw(), out, 0,
            )  # fmt: skip
            return np.reshape(out, shape)

        return sense
