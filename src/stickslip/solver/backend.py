"""The kernels of a tier, and the vectors they take."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip.formulation import Model
from stickslip.solver.compile.modules import load, load_compiled

__all__ = ["Runner", "runner_of"]


@dataclass(frozen=True)
class Runner:
    """Calls the kernels of one tier for one model."""

    module: ModuleType
    """The generated module whose kernels are called."""
    address: int
    """Where the compiled equations are; 0 in the plain tier, whose module holds them."""

    def vector(self, numbers: Iterable[float]) -> Any:
        """Return numbers as the tier takes them: a list, or an array."""
        values = [float(number) for number in numbers]
        return np.array(values) if self.address else values

    def flat(self, numbers: ArrayLike) -> Any:
        """Return an array's numbers one after the other, as the tier takes them."""
        values = np.array(numbers, dtype=np.float64, order="C").ravel()  # one that can be written
        return values if self.address else values.tolist()

    def zeros(self, size: int) -> Any:
        """Return a vector of zeros."""
        return np.zeros(size) if self.address else [0.0] * size

    def whole(self) -> Any:
        """Return the whole-numbered state of a run that begins."""
        size = self.module.WHOLES
        return np.zeros(size, dtype=np.int64) if self.address else [0] * size

    def working(self, numbers: Sequence[float], first: int) -> Any:
        """Return the vector of a run, with the parameters in it from a place on.

        Parameters
        ----------
        numbers : sequence of float
            Parameters in the order of the model [SI].
        first : int
            Place of the first one.

        Returns
        -------
        array or list (SIZE,)
            The vector, laid out as in `kernels.state_layout`; all else is 0.
        """
        w = self.zeros(self.module.SIZE)
        for i, number in enumerate(numbers, first):
            w[i] = number
        if self.address:
            w[self.module.ADDRESS :].view(np.int64)[0] = self.address
        return w


def runner_of(model: Model, *, compiled: bool, ensembles: bool = False) -> Runner:
    """Return the runner of a tier; the compiled one compiles what is not there yet.

    What single runs need is compiled, or what ensembles do.

    Parameters
    ----------
    model : Model
        Equations of a mechanism with a law.
    compiled : bool
        Whether to take machine code, or else plain Python.
    ensembles : bool, default False
        Whether the compiled tier is for ensembles, or else for single runs.

    Returns
    -------
    Runner
        What calls the kernels.
    """
    if not compiled:
        return Runner(load(model), 0)
    machine = load_compiled(model, ensembles=ensembles)
    return Runner(machine.kernels, machine.address)
