"""Plays a recorded run back at any times."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.formulation import Model
from stickslip.kernels.state_layout import ROW_COLUMNS
from stickslip.solver.backend import Runner
from stickslip.solver.drive_schedule import Inputs

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Playback:
    """The rows of a run: start, end, length, mode, flags, piece, states, dense output."""

    model: Model
    """The equations that were run."""
    runner: Runner
    """The kernels that ran them."""
    inputs: Inputs
    """Parameters and drives of the run."""
    log: Any
    """The rows one after the other, as the tier keeps them: a list or an array."""
    rows: Array
    """The same, a row a step."""

    @classmethod
    def from_log(
        cls, model: Model, runner: Runner, inputs: Inputs, log: Sequence[float], count: int
    ) -> Self:
        """Take the recorded part of a log."""
        width = runner.header[ROW_COLUMNS]
        log = log[: count * width]
        return cls(
            model, runner, inputs, log, np.asarray(log, dtype=np.float64).reshape(count, width)
        )

    @override
    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the rows; the log is made of them, as the tier takes it."""
        return _restored, (self.model, self.runner, self.inputs, self.rows)

    def span(self) -> tuple[float, float]:
        """Return the first and the last time."""
        return float(self.rows[0, 0]), float(self.rows[-1, 1])

    def times(self) -> Array:
        """Return the ends of the steps."""
        return self.column(0, self.rows[-1, 1])

    def column(self, index: int, last: float) -> Array:
        """Return a number of each row, and one more behind them."""
        found = np.empty(len(self.rows) + 1)
        found[:-1] = self.rows[:, index]
        found[-1] = last
        return found

    def played(self, t: Array) -> tuple[Array, Array, NDArray[np.intp]]:
        """Return states (n, states), forces (n, 2 + channels) and rows (n,) at times."""
        n, size, wide = len(self.model.states), len(t), self.model.sizes.columns
        states, forces, rows = (self.runner.zeros(size * width) for width in (n, wide, 1))
        self.runner.kernels.enter_play(
            self.log,
            len(self.rows),
            self.runner.flat(t),
            self.runner.flat(self.inputs.table),
            self.runner.working(self.inputs.p),
            self.runner.whole(),
            states,
            forces,
            rows,
        )
        return (
            np.reshape(states, (size, n)),
            np.reshape(forces, (size, wide)),
            np.asarray(rows, dtype=np.intp),
        )

    def __call__(self, t: Array) -> Mapping[str, Array]:
        """Return all columns at an array of times."""
        states, forces, rows = self.played(t)
        columns: dict[str, Any] = dict(zip(self.model.states, states.T, strict=True))
        columns |= dict(zip(self.model.columns, forces.T, strict=True))
        if self.model.contacts:
            for name in self.model.contacts:
                mode = self.model.column("mode", name)
                columns[mode] = columns[mode].astype(np.int8)
            return columns
        return columns | {"mode": self.rows[rows, 3].astype(np.int8)}


def _restored(model: Model, runner: Runner, inputs: Inputs, rows: Array) -> Playback:
    """Return the playback of a pickle."""
    return Playback(model, runner, inputs, runner.flat(rows), rows)
