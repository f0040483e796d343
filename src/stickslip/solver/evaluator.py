"""The functions of a generated module, called with plain numbers."""

from collections.abc import Sequence
from typing import Any

from stickslip.formulation import Model
from stickslip.solver.backend import runner_of
from stickslip.solver.drive_schedule import Inputs

__all__ = ["Equations"]


class Equations:
    """Evaluates the equations of one mechanism with one law at any state."""

    def __init__(self, model: Model, inputs: Inputs) -> None:
        """Take the equations, and the parameters.

        Parameters
        ----------
        model : Model
            Equations of a mechanism with a law.
        inputs : Inputs
            Parameters and drives.
        """
        runner = runner_of(model, compiled=False)
        self.module = module = runner.module
        self.table = inputs.table.tolist()
        n = module.N_STATES
        self.sizes = {
            "contact": 4 + module.N_CHANNELS,
            "diagram": module.N_COORDINATES + 3,
            "energy": 1,
            "guard_slopes": module.N_GUARDS * (n + 1),
            "guards": module.N_GUARDS,
            "jacobian": n * n,
            "linear": 1,
            "margins": module.N_SWITCHES,
            "power": 2,
            "rest": 3,
        }
        self.w: list[Any] = [
            *runner.working(inputs.p, inputs.first),
            *[0.0] * max(self.sizes.values()),
        ]
        self.load(0)

    def load(self, piece: int) -> None:
        """Load a piece of the drives."""
        self.module.load_piece(self.table, piece, self.w)

    def load_at(self, t: float) -> None:
        """Load the piece of the drives that holds at a time."""
        self.load(max(self.module.piece_at(self.table, 0, t), 0))

    def _put(self, y: Sequence[Any]) -> None:
        self.w[self.module.Y : self.module.Y + self.module.N_STATES] = y[: self.module.N_STATES]

    def flags(self, t: float, y: Sequence[Any]) -> int:
        """Return the flags of the switches that a state asks for.

        Parameters
        ----------
        t : float
            Time [s].
        y : sequence of object (n,)
            State.

        Returns
        -------
        int
            Bit j is set where the condition of switch j holds.
        """
        self._put(y)
        return int(self.module.set_flags(t, self.w, self.module.Y, 0))

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
        module, size = self.module, self.sizes.get(name, self.module.N_STATES)
        self.w[module.GIVEN : module.GIVEN + len(given)] = given
        getattr(module, name)(mode, flags, t, self.w, module.Y, module.SIZE)
        return self.w[module.SIZE : module.SIZE + size]
