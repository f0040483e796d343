"""Plays a recorded run back at any times."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from stickslip.formulation import Model
from stickslip.solver.tables import Inputs

__all__ = ["Playback"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Playback:
    """The rows of a run: start, end, length, mode, flags, piece, states, dense output."""

    model: Model
    module: ModuleType
    inputs: Inputs
    rows: Array

    @classmethod
    def from_log(
        cls, model: Model, module: ModuleType, inputs: Inputs, log: Sequence[float], count: int
    ) -> Self:
        """Take the recorded part of a log."""
        width = module.ROW_COLUMNS
        rows = np.array(log[: count * width], dtype=np.float64).reshape(count, width)
        return cls(model, module, inputs, rows)

    def span(self) -> tuple[float, float]:
        """Return the first and the last time."""
        return float(self.rows[0, 0]), float(self.rows[-1, 1])

    def times(self) -> Array:
        """Return the ends of the steps."""
        return np.append(self.rows[:, 0], self.rows[-1, 1])

    def states(self, t: Array, index: NDArray[np.intp]) -> Array:
        """Return the states (n, states) at times in given rows."""
        rows = self.rows[index]
        n = self.module.N_STATES
        x = ((t - rows[:, 0]) / rows[:, 2])[:, None]
        dense = rows[:, self.module.DENSE_AT :].reshape(len(t), self.module.TERMS, n)
        return _nested(dense, x) + rows[:, self.module.STATE_AT : self.module.DENSE_AT]

    def parameters(self, piece: int) -> list[float]:
        """Return the parameters with a piece of the drives loaded."""
        p = list(self.inputs.p)
        self.module.load_piece(self.inputs.table, piece, p)
        return p

    def __call__(self, t: Array) -> Mapping[str, Array]:
        """Return all columns at an array of times."""
        last = len(self.rows) - 1
        index = np.clip(np.searchsorted(self.rows[:, 0], t, side="right") - 1, 0, last)
        states = self.states(t, index)
        forces = self._forces(t, index, states)
        columns: dict[str, Any] = dict(zip(self.model.states, states.T, strict=True))
        columns |= {"friction": forces[:, 0], "normal_force": forces[:, 1]}
        return columns | {"mode": self.rows[index, 3].astype(np.int8)}

    def _forces(self, t: Array, index: NDArray[np.intp], states: Array) -> Array:
        """Return friction and normal force (n, 2)."""
        forces = np.empty((len(t), 2))
        out = [0.0] * 4
        # a body at rest for good is one row, during which its drives go on
        starts = self.inputs.table[:: 1 + 3 * self.module.N_DRIVES]
        pieces = np.maximum(self.rows[index, 5], np.searchsorted(starts, t, side="right") - 1)
        loaded = {int(piece): self.parameters(int(piece)) for piece in set(pieces)}
        for i, row in enumerate(index):
            mode, flags, piece = (*map(int, self.rows[row, 3:5]), int(pieces[i]))
            self.module.contact(mode, flags, float(t[i]), states[i].tolist(), loaded[piece], out)
            forces[i] = out[:2]
        return forces


def _nested(dense: Array, x: Array) -> Array:
    """Evaluate the form of `stickslip.kernels.dense` for arrays, without the first state."""
    rest = 1.0 - x
    value = dense[:, 6] * x + dense[:, 5]
    for term, factor in ((4, rest), (3, x), (2, rest), (1, x), (0, rest)):
        value = value * factor + dense[:, term]
    return value * x
