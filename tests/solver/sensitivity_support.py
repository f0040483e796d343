"""Derivatives of whole runs by differences, to compare sensitivities with."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip import EventDriven, simulate
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary

PYTHON = EventDriven(tier="python")
TIGHT = EventDriven(tier="python", tolerance=1e-13, stiff_tolerance=1e-11)
"""Less noise for differences to enlarge."""


@dataclass(frozen=True)
class Case:
    """A run that can be made again with other numbers."""

    rig: Mechanism
    law: FrictionLaw
    t_end: float
    y0: tuple[float, ...]

    def paths(self) -> dict[str, float]:
        """Return all that sensitivities can be taken of, and what it is."""
        values = {path: x for path, _, x in parameters(self.rig, "mechanism")}
        values |= {path: x for path, _, x in parameters(self.law, "friction")}
        names = self.run().states
        return values | {f"initial.{n}": x for n, x in zip(names, self.y0, strict=True)}

    def run(self, solver: EventDriven = PYTHON, **changes: float) -> Any:
        """Run with some numbers changed, by path."""
        rig, law, start = self.rig, self.law, list(self.y0)
        for path, value in changes.items():
            if path.startswith("mechanism."):
                rig = vary(rig, "mechanism", {path: value})
            elif path.startswith("friction."):
                law = vary(law, "friction", {path: value})
            else:
                names = (*rig.coordinates, *rig.rates, "z")
                start[names.index(path.removeprefix("initial."))] = value
        return simulate(rig, law, t_end=self.t_end, y0=start, solver=solver, throw=False)


def sensitivities(run: Any, path: str, t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the sensitivities of all states (n, states) at times (n,)."""
    there = run.at(t)
    return np.column_stack([there.sensitivity(state, path) for state in run.states])


def differences(
    case: Case, path: str, t: NDArray[np.float64], step: float, *, side: int = 0
) -> NDArray[np.float64]:
    """Return derivatives (n, states): central or one-sided differences, extrapolated."""

    def moved(by: float) -> NDArray[np.float64]:
        there = case.run(TIGHT, **{path: value + by}).at(t)
        return np.column_stack([there[state] for state in there.states])

    value = case.paths()[path]
    if side == 0:
        wide, narrow = (
            (moved(h) - moved(-h)) / (2 * h) for h in (step, step / 2)
        )
        return (4 * narrow - wide) / 3
    here, h = moved(0.0), side * step
    one, two, four = ((moved(h / k) - here) / (h / k) for k in (1, 2, 4))
    return ((4 * four - two) * 1.0 * 2 - (2 * two - one) * 2) / 3 + 0 * (2 * two - one)
