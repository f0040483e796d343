"""What a fixed step makes of a run: chatter, drift and reverse motion that is not there."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.selection.criteria import Criteria, criteria_of
from stickslip.simulation import simulate
from stickslip.solver import FixedStep, Method

__all__ = ["FixedStepRow", "compare_fixed_steps"]


@dataclass(frozen=True, kw_only=True)
class FixedStepRow:
    """One fixed-step run beside the exact one."""

    dt: float | None
    """Step [s]; None for the event-driven run."""
    stick_rule: bool
    """Whether the body is held at a sign change of its velocity."""
    criteria: Criteria
    """What the run does."""
    reversals: int
    """Sign changes of the velocity."""


def compare_fixed_steps(
    mechanism: Mechanism,
    law: FrictionLaw,
    *,
    t_end: float,
    y0: Mapping[str, float] | None = None,
    steps: Sequence[float] = (0.01, 0.001),
    method: Method = "euler",
) -> tuple[FixedStepRow, ...]:
    """Run a mechanism event-driven, and as a block diagram with each step.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> rows = compare_fixed_steps(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> [row.reversals > 0 for row in rows]
    [False, False, True, False, True]
    """
    rows = []
    settings: list[tuple[float | None, bool]] = [(None, True)]
    settings += [(dt, stick_rule) for dt in steps for stick_rule in (True, False)]
    for dt, stick_rule in settings:
        solver = None
        if dt is not None:
            solver = FixedStep(dt=dt, method=method, stick_rule=stick_rule)
        run = simulate(mechanism, law, t_end=t_end, y0=y0, solver=solver)
        slip = mechanism.contacts()[0].slip
        v = run[mechanism.rates[mechanism.coordinates.index(slip)]]
        signs = [1 if value > 0 else -1 for value in v if value != 0]
        rows.append(
            FixedStepRow(
                dt=dt,
                stick_rule=stick_rule,
                criteria=criteria_of(run, mechanism),
                reversals=sum(a != b for a, b in itertools.pairwise(signs)),
            )
        )
    return tuple(rows)
