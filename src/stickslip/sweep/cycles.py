"""Cycles of the drives: what each of them brings, and after how many a motion closes."""

import math
from dataclasses import dataclass
from typing import Self, final

import numpy as np

from stickslip.mechanisms import WHOLE, Mechanism, slip_among
from stickslip.sweep.parameter_grid import Array
from stickslip.trajectory import Trajectory

CLOSED = 1e-3
"""Share of the size of a state within which samples count as the same point."""
GRID = 2000
"""Evenly spaced times of a cycle at which extremes are sought, beside the solver's own."""
STEADY = 1e-3
"""Share of the travel within which cycles count as the same."""
STILL = 1e-6
"""Share of the ways to and fro below which a travel is rounding, or what is left of a transient."""
MOST_TIMES = 100_000
"""Times of all cycles together: of very many cycles each has fewer."""


@final
@dataclass(frozen=True, kw_only=True)
class DrivenCycle:
    """What the slipping body does in one cycle of the drives."""

    begin: float
    """When it begins [s]."""
    period: float
    """How long it lasts [s]."""
    travel: float
    """Last position less the first [m] or [rad]."""
    back_slip: float
    """All motion against the direction of the travel [m] or [rad]."""
    least_velocity: float
    """Lowest velocity [m/s] or [rad/s]."""
    least_normal_force: float
    """Lowest normal force of any contact [N]."""

    @property
    def advance(self) -> float:
        """Travel [m] or [rad], exactly 0 where it is rounding of the ways to and fro."""
        return self.travel if self.moves_on else 0.0

    @property
    def backward(self) -> float:
        """All motion in the negative direction [m] or [rad]."""
        return self.back_slip + max(-self.travel, 0.0)

    @property
    def mean_velocity(self) -> float:
        """Travel over duration [m/s] or [rad/s]."""
        return self.travel / self.period

    @property
    def moves_on(self) -> bool:
        """Whether the travel is more than rounding of the ways to and fro."""
        return abs(self.travel) > STILL * (abs(self.travel) + self.back_slip)

    def repeats(self, before: Self) -> bool:
        """Whether the travel is that of the cycle before, as once a motion has settled."""
        return abs(self.travel - before.travel) <= STEADY * abs(self.travel)


def cycles_in(
    run: Trajectory, mechanism: Mechanism, period: float, coordinate: str | None = None
) -> tuple[DrivenCycle, ...]:
    """Return what a run does in each whole cycle from its start on, along one coordinate.

    Examples
    --------
    >>> import math
    >>> from stickslip import Coulomb, PendulumCart, simulate
    >>> from stickslip.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    >>> cart = PendulumCart(
    ...     cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    ... )
    >>> run = simulate(cart, Coulomb(kinetic_coefficient=0.2), t_end=2 * swing.period)
    >>> [round(one.travel, 7) for one in cycles_in(run, cart, swing.period)]
    [0.0248596, 0.0634659]
    """
    slip, rate = slip_among(mechanism, coordinate, "cycles_in")
    loads = [name for name in run.names if name.partition(":")[0] == "normal_force"]
    first, last = run.span
    count = math.floor((last - first) / period * (1.0 + WHOLE))
    found = []
    samples = max(min(GRID, MOST_TIMES // max(count, 1)), 2)
    for k in range(count):
        begin, end = first + k * period, min(first + (k + 1) * period, last)
        # the velocity changes its sign at the solver's own times, so that back-slip is exact
        own = run.t[(run.t > begin) & (run.t < end)]
        seen = run.at(np.union1d(np.linspace(begin, end, samples), own))
        x = seen[slip]
        travel = float(x[-1] - x[0])
        found.append(
            DrivenCycle(
                begin=begin,
                period=period,
                travel=travel,
                back_slip=float(np.maximum(-math.copysign(1.0, travel) * np.diff(x), 0.0).sum()),
                least_velocity=float(seen[rate].min()),
                least_normal_force=min(float(seen[name].min()) for name in loads),
            )
        )
    return tuple(found)


def period_of(samples: Array, scale: Array | float, tolerance: float = CLOSED) -> int:
    """Return after how many samples an orbit closes, 0 if it does not within half of them.

    Examples
    --------
    >>> period_of(np.array([1.0, 3.0, 1.0, 3.0, 1.0, 3.0]), 3.0)
    2
    >>> period_of(np.array([1.0, 3.0, 2.0, 5.0, 1.5, 0.2]), 3.0)
    0
    """
    points = np.reshape(samples, (len(samples), -1))
    if not np.isfinite(points).all():
        return 0
    limit = tolerance * np.broadcast_to(scale, points.shape[1:])
    for period in range(1, len(points) // 2 + 1):
        if (np.abs(points[period:] - points[:-period]) <= limit).all():
            return period
    return 0
