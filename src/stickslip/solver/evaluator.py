"""The equations of a model, called with plain numbers."""

import functools
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from stickslip.formulation import Model
from stickslip.kernels.driver import piece_at
from stickslip.kernels.equations import load_piece, put_constants
from stickslip.kernels.mode_transitions import set_flags
from stickslip.kernels.state_layout import GIVEN, N_DRIVES, SIZE, Sizes, Y
from stickslip.solver.backend import runner_of
from stickslip.solver.compile.modules import plain_equations
from stickslip.solver.drive_schedule import Inputs


@functools.lru_cache(maxsize=256)
def _lengths(sizes: Sizes) -> Mapping[str, int]:
    """Return how many numbers each function writes."""
    return MappingProxyType(sizes.lengths())


class Equations:
    """Evaluates the equations of one mechanism with one law at any state."""

    def __init__(self, model: Model, inputs: Inputs) -> None:
        """Take the equations, and the parameters."""
        runner = runner_of(model, compiled=False)
        self.sizes = sizes = model.sizes
        self.functions = plain_equations(model)
        self.table: Any = inputs.table.data  # gives plain numbers, and only those asked for
        self.lengths = _lengths(sizes)
        self.whole: list[int] = runner.whole()
        self.w: list[Any] = [*runner.working(inputs.p), *[0.0] * max(self.lengths.values())]
        put_constants(self.w, self.whole)
        self.width = 1 + 3 * self.whole[N_DRIVES]
        self.load(0)

    def load(self, piece: int) -> None:
        """Load a piece of the drives."""
        self.piece = piece
        load_piece(self.table, piece, self.w, self.whole)

    def load_at(self, t: float) -> None:
        """Load the piece of the drives that holds at a time; times mostly go forwards."""
        begun = self.piece * self.width
        first = self.piece if begun < len(self.table) and self.table[begun] <= t else 0
        self.load(piece_at(self.table, first, t, self.whole))  # whose numbers a loop may change

    def linear(self, t: float) -> list[float]:
        """Return the linear part of each drive at a time, in the piece that is loaded."""
        first = self.piece * self.width + 1
        row = self.table[first : first + self.width - 1]
        return [row[k] + row[k + 1] * (t - row[k + 2]) for k in range(0, len(row), 3)]

    def _put(self, y: Sequence[Any]) -> None:
        first, n = self.whole[Y], self.sizes.states
        self.w[first : first + n] = y[:n]

    def flags(self, t: float, y: Sequence[Any]) -> int:
        """Return the flags of the switches that a state asks for."""
        self._put(y)
        return set_flags(t, self.w, self.whole, self.whole[Y], 0, 0)

    def __call__(
        self,
        name: str,
        mode: int,
        flags: int,
        t: float,
        y: Sequence[Any],
        given: Sequence[Any] = (),
    ) -> list[Any]:
        """Return what a function of the module gives, `given` in place of its drives."""
        self._put(y)
        return self.here(name, mode, flags, t, given)

    def here(
        self, name: str, mode: int, flags: int, t: float, given: Sequence[Any] = ()
    ) -> list[Any]:
        """Return what a function gives at the state that flags were last asked for."""
        to, length = self.whole[SIZE], self.lengths[name]
        place = self.whole[GIVEN]
        self.w[place : place + len(given)] = given
        self.functions[name](mode, flags, t, self.w, self.whole[Y], to)
        return self.w[to : to + length]
