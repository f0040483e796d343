"""Trade-offs between goals of a motion: the Pareto front by the method of epsilon-constraints.

Speed is to be large; the energy per travel and the back-slip are to be small. The front is walked
along one of the two others:

1. Its ends: the motion that is fastest within the limits, and the one that costs least, which has
   the largest travel per work, or is the fastest without any back-slip.
2. Between their costs, evenly spread bounds: the fastest motion with the cost as a further limit,
   searched from the motion whose cost is nearest.
3. What another motion beats in both speed and cost is dropped.

Each motion is the result of `optimise_profile`: certified, within all limits, in all scenarios.

Source: Y. Y. Haimes, L. S. Lasdon, D. A. Wismer, IEEE Trans. Syst. Man Cybern. 1 (1971) 296-297.
"""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.errors import ConvergenceError, InputError, ParameterError, not_whole
from stickslip.friction import Friction
from stickslip.mechanisms import Mechanism
from stickslip.optimisation.optimise import optimise_profile
from stickslip.optimisation.problem import GoalName, Limits
from stickslip.optimisation.result import Optimum
from stickslip.tables import Tabular

if TYPE_CHECKING:
    import pandas as pd

CostName: TypeAlias = Literal["energy", "back_slip"]
COSTS = {"energy": "J/m", "back_slip": "m"}
"""What a front trades speed for, with units: names of `Limits` and of `Cycle`."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class ParetoFront(Tabular):
    """Motions none of which another beats in both speed and cost, the fastest first."""

    cost: CostName
    """What speed is traded for."""
    motions: tuple[Optimum, ...]
    """Results of `optimise_profile`, the fastest first."""

    @property
    def speeds(self) -> NDArray[np.float64]:
        """Mean speeds (n,) [m/s]."""
        return np.array([speed_of(motion) for motion in self.motions])

    @property
    def costs(self) -> NDArray[np.float64]:
        """Energies per travel [J/m] or back-slips per cycle [m] (n,), the worst scenario's."""
        return np.array([cost_of(motion, self.cost) for motion in self.motions])

    @override
    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each motion."""
        import pandas as pd

        return pd.DataFrame(
            {
                "speed": self.speeds,
                self.cost: self.costs,
                "profile": [str(motion.profile) for motion in self.motions],
            }
        )


def cost_of(motion: Optimum, cost: CostName) -> float:
    """Return the cost of a motion in the scenario that does worst."""
    return max(float(getattr(cycle, cost)) for cycle in motion.best.cycles)


def pareto_front(
    mechanism: Mechanism,
    law: Friction,
    *,
    limits: Limits,
    cost: CostName = "energy",
    points: int = 7,
    progress: Callable[[int, int], object] | None = None,
    **options: object,
) -> ParetoFront:
    """Find motions that trade mean speed for energy or for back-slip.

    Parameters
    ----------
    mechanism : Mechanism
        With a prescribed motion, see `optimise_profile`.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back.
    limits : Limits
        What the motions may take.
    cost : {"energy", "back_slip"}
        Work of the motor over the travel [J/m], or back-slip per cycle [m].
    points : int
        Motions between the ends of the front.
    progress : callable, optional
        Called with the motions that were optimised and how many there will be; if it returns
        False, the front so far is the result.
    **options : object
        ``kind``, ``scenarios``, ``interval``, ``quantile``, ``evaluations``, ``seed``,
        ``executor`` and the others of `optimise_profile`, for each motion.

    Returns
    -------
    ParetoFront
        The motions, the fastest first.

    Raises
    ------
    InputError
        If an argument cannot be used.
    ParameterError
        If the number of points is no whole number of at least 0.
    ConvergenceError
        If no motion keeps the limits.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb
    >>> from stickslip.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> from stickslip.optimisation import Limits, pareto_front
    >>> stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    >>> limits = Limits(position=0.01, rate=0.8, acceleration=100.0)
    >>> law = Coulomb(kinetic_coefficient=0.2)
    >>> front = pareto_front(capsule, law, limits=limits, points=1, evaluations=10)
    >>> bool((front.speeds[1:] < front.speeds[:-1]).all())
    True
    """
    if cost not in COSTS:
        raise InputError(f"cost must be {' or '.join(map(repr, COSTS))}, got {cost!r}.")
    if type(points) is not int or points < 0:
        raise ParameterError(not_whole("points", 0, points))
    motions: list[Optimum] = []

    def search(goal: GoalName = "speed", bound: float | None = None) -> bool:
        """Optimise with a bound of the cost; return whether the walk goes on."""
        near = min(motions, key=lambda m: abs(cost_of(m, cost) - (bound or 0.0)), default=None)
        given = limits if bound is None else dataclasses.replace(limits, **{cost: bound})
        start = mechanism if near is None else near.mechanism
        try:
            motions.append(optimise_profile(start, law, limits=given, goal=goal, **options))  # type: ignore[arg-type]  # those of the other function
        except ConvergenceError:
            if not motions:
                raise
        return progress is None or progress(len(motions), 2 + points) is not False

    running = search()
    if running and cost_of(motions[0], cost) > 0.0:
        running = search("economy") if cost == "energy" else search(bound=0.0)
    costs = [cost_of(motion, cost) for motion in motions]
    for bound in np.linspace(max(costs), min(costs), points + 2)[1:-1].tolist():
        if not running or len(set(costs)) < 2:
            break
        running = search(bound=bound)
    return ParetoFront(cost=cost, motions=_not_beaten(motions, cost))


def speed_of(motion: Optimum) -> float:
    """Return the mean speed of a motion in the scenario that does worst [m/s]."""
    return min(cycle.travel / cycle.period for cycle in motion.best.cycles)


def _not_beaten(motions: list[Optimum], cost: CostName) -> tuple[Optimum, ...]:
    """Return the motions that no other beats, the fastest first."""
    ranked = sorted(motions, key=lambda motion: (-speed_of(motion), cost_of(motion, cost)))
    front: list[Optimum] = []
    for motion in ranked:
        if speed_of(motion) > 0.0 and (
            not front or cost_of(motion, cost) < cost_of(front[-1], cost)
        ):
            front.append(motion)
    return tuple(front)
