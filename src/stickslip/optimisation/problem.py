"""What is searched: the goal of a motion and what it breaks, over all scenarios."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import Annotated, Literal, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.described import Described
from stickslip.drives import Profile
from stickslip.formatting import quantity
from stickslip.mechanisms import Mechanism
from stickslip.optimisation.cycle_metrics import SAMPLES, Cycle, fitted, measure, units_of_limits
from stickslip.optimisation.scenarios import Scenarios
from stickslip.quantities import Parametrised, Quantity, vary

Array = NDArray[np.float64]

UNIT_OF_BACK_SLIP = 1e-3
"""What counts as one unit of violation where no back-slip at all is allowed [m]."""
ROUNDING = 1e-9
"""Share of a limit by which it may be exceeded: a motion that just reaches it is rounded."""
SAFETY = 1e-5
"""Share of each limit that a search leaves: extremes are looked for more finely in the end."""
FAILED = 10.0
"""Violation of a motion that cannot be gone through or does not repeat itself."""
FINER = 4097
"""Times of a cycle at which the extremes of a result are looked for."""
GoalName: TypeAlias = Literal["travel", "speed", "economy"]


@final
@dataclass(frozen=True, kw_only=True)
class Limits(Parametrised):
    """What a motion may take; a limit that is not given does not hold.

    Parameters
    ----------
    position : float
        Largest distance of the inner body from its middle: angle [rad] or half a stroke [m].
    rate : float
        Largest speed of it [rad/s] or [m/s].
    acceleration : float, optional
        Largest acceleration of it [rad/s^2] or [m/s^2].
    effort : float, optional
        Largest torque [N m] or force [N].
    load_share : float
        Least normal force over the weight. At 0 the run itself ends where the body lifts off.
    back_slip : float, optional
        Longest way that the body slips back in a cycle [m].
    energy : float, optional
        Largest positive work of the motor over the travel [J/m].

    Examples
    --------
    >>> import math
    >>> Limits(position=math.radians(60.0), rate=12.0, effort=0.6).load_share
    0.0
    """

    position: Annotated[float, Quantity("q_max", above=0)]
    rate: Annotated[float, Quantity("w_max", above=0)]
    acceleration: Annotated[float, Quantity("a_max", above=0)] | None = None
    effort: Annotated[float, Quantity("tau_max", above=0)] | None = None
    load_share: Annotated[float, Quantity("n_min", low=0, high=1)] = 0.0
    back_slip: Annotated[float, Quantity("s_back", "m", low=0)] | None = None
    energy: Annotated[float, Quantity("E_max", "J/m", above=0)] | None = None

    def given(self) -> dict[str, float]:
        """Return the limits that hold by name.

        Examples
        --------
        >>> Limits(position=0.5, rate=2.0).given()
        {'position': 0.5, 'rate': 2.0, 'load_share': 0.0}
        """
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in values.items() if value is not None}


@final
@dataclass(frozen=True, kw_only=True)
class Margin(metaclass=Described):
    """How far a motion stays from one limit.

    Examples
    --------
    >>> Margin(name="rate", allowed=12.0, reached=11.5, unit="rad/s").margin
    0.5
    >>> Margin(name="position", allowed=0.01, reached=0.010000000000000231, unit="m").margin
    0.0
    """

    name: str
    """Which limit."""
    allowed: float
    """The limit."""
    reached: float
    """The extreme over the cycle, of all scenarios."""
    unit: str
    """Unit of both."""

    @property
    def margin(self) -> float:
        """What is left [unit]; below 0 where the limit is broken, by more than rounding."""
        left = self.allowed - self.reached
        if self.name == "load_share":
            left = -left
        allowance = ROUNDING * (self.allowed or UNIT_OF_BACK_SLIP)
        return 0.0 if -allowance <= left < 0.0 else left

    @property
    def share(self) -> float:
        """What is left over the limit itself; for loads and where nothing is allowed, as it is."""
        if self.name == "load_share":
            return self.margin
        return self.margin / (self.allowed or UNIT_OF_BACK_SLIP)


@final
@dataclass(frozen=True, kw_only=True)
class Goal(metaclass=Described):
    """What is to be large."""

    name: str
    """Its name on the command line."""
    title: str
    """Its name in reports."""
    unit: str
    """Its unit."""
    value: Callable[[Cycle], float] = field(repr=False)
    """Read off a cycle."""


def _travel(cycle: Cycle) -> float:
    return cycle.travel


def _speed(cycle: Cycle) -> float:
    return cycle.travel / cycle.period


def _economy(cycle: Cycle) -> float:
    return cycle.travel / cycle.work if cycle.work > 0.0 else 0.0


GOALS: Mapping[str, Goal] = {
    goal.name: goal
    for goal in (
        Goal(name="travel", title="travel per cycle", unit="m", value=_travel),
        Goal(name="speed", title="mean speed", unit="m/s", value=_speed),
        Goal(name="economy", title="travel per work", unit="m/J", value=_economy),
    )
}
"""The goals by name."""


@final
@dataclass(frozen=True, kw_only=True)
class ScoredMotion(metaclass=Described):
    """A profile, what it brings, and what it leaves of each limit.

    Examples
    --------
    >>> from stickslip.drives import ThreePhase
    >>> swing = ThreePhase(amplitude=0.8, fast=120.0, slow=30.0)
    >>> ScoredMotion(profile=swing, value=0.06, margins=(), cycles=()).feasible
    False
    """

    profile: Profile
    """The motion."""
    value: float
    """Its goal, in SI units; 0 where it is not known."""
    margins: tuple[Margin, ...]
    """What is left of each limit; none where the run ended early."""
    cycles: tuple[Cycle, ...]
    """The steady cycle of each scenario."""

    @property
    def early_end(self) -> str:
        """When a run ended early, and why, in words; empty where all lasted."""
        run = self._cut_short
        if run is None:
            return ""
        return f"its run stopped at {quantity(run.run.span[1], 's')}: {run.run.ending}"

    @property
    def _cut_short(self) -> Cycle | None:
        return next((cycle for cycle in self.cycles if cycle.lasted < 1.0), None)

    def shown(self, goal: Goal) -> Cycle:
        """Return the cycle of the scenario that does worst, or of the first that ended early."""
        return self._cut_short or min(self.cycles, key=goal.value)

    @property
    def violation(self) -> float:
        """What is broken, as the sum of shares of the limits; 0 if nothing is."""
        ends = [FAILED * (2.0 - c.lasted) for c in self.cycles if not c.repeats]
        return sum(ends) + sum(max(0.0, -m.share) for m in self.margins)

    @property
    def feasible(self) -> bool:
        """Whether every scenario repeats itself within all limits."""
        return bool(self.cycles) and self.violation <= 0.0


@final
@dataclass(frozen=True, kw_only=True)
class Problem:
    """A mechanism, scenarios, a goal and limits."""

    mechanism: Mechanism
    """With any prescribed motion and without a limit of its motor."""
    scenarios: Scenarios
    """What it must stand."""
    goal: Goal
    """What is to be large."""
    limits: Limits
    """What it may take."""

    def cases(self, profile: Profile) -> list[Mechanism]:
        """Return the mechanism of each scenario with a motion."""
        moved = fitted(self.mechanism, profile)
        changes = self.scenarios.changes
        return [vary(moved, "mechanism", own) if own else moved for own in changes]

    def judge(self, profile: Profile, *, samples: int = SAMPLES) -> ScoredMotion:
        """Run a motion through all scenarios."""
        pairs = zip(self.cases(profile), self.scenarios.laws, strict=True)
        cycles = tuple(measure(mechanism, law, samples=samples) for mechanism, law in pairs)
        if any(cycle.lasted < 1.0 for cycle in cycles):
            return ScoredMotion(profile=profile, value=0.0, margins=(), cycles=cycles)
        values = self.values(cycles)
        return ScoredMotion(
            profile=profile,
            value=float(self.scenarios.weights(values) @ values),
            margins=self._margins(cycles),
            cycles=cycles,
        )

    def values(self, cycles: tuple[Cycle, ...]) -> Array:
        """Return the goal of each scenario (n,)."""
        return np.array([self.goal.value(cycle) for cycle in cycles])

    def _margins(self, cycles: tuple[Cycle, ...]) -> tuple[Margin, ...]:
        units = units_of_limits(self.mechanism)
        worst = {"load_share": min}
        return tuple(
            Margin(
                name=name,
                allowed=allowed,
                reached=worst.get(name, max)(getattr(cycle, name) for cycle in cycles),
                unit=units[name],
            )
            for name, allowed in self.limits.given().items()
        )

    def tighter(self) -> "Problem":
        """Return the problem with a little less of each limit, for searching."""
        given = self.limits.given()
        changed = {name: value * (1.0 - SAFETY) for name, value in given.items()}
        changed["load_share"] = min(1.0, given["load_share"] + SAFETY)
        return Problem(
            mechanism=self.mechanism,
            scenarios=self.scenarios,
            goal=self.goal,
            limits=Limits(**changed),
        )
