"""What a fixed step makes of a run: chatter, drift and reverse motion that is not there."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.engine.simulation import simulate
from stickslip.engine.solver import BreakAway, FixedStep, Method
from stickslip.engine.trajectory import Status, Trajectory
from stickslip.friction import FrictionLaw
from stickslip.identify.candidates.criteria import GRID, Criteria, criteria_of
from stickslip.maths import Latches, Scalar
from stickslip.mechanisms import Mechanism, slip_of

NUDGE = float(np.cbrt(np.finfo(float).eps))
"""Share of the largest deflection over which a rate is differentiated, to either side."""


@dataclass(frozen=True, kw_only=True)
class FixedStepRow:
    """One fixed-step run beside the exact one."""

    dt: float | None
    """Step [s]; None for the event-driven run."""
    stick_rule: bool
    """Whether the body is held at a sign change of its velocity."""
    criteria: Criteria
    """What the run does, as far as it went."""
    reversals: int
    """Sign changes of the velocity."""
    run: Trajectory
    """The run itself."""

    @property
    def diverged(self) -> bool:
        """Whether the run grew beyond all numbers."""
        return self.run.status is Status.NOT_FINITE


def compare_fixed_steps(
    mechanism: Mechanism,
    law: FrictionLaw,
    *,
    t_end: float,
    y0: Mapping[str, float] | None = None,
    steps: Sequence[float] = (0.01, 0.001),
    method: Method = "euler",
    break_away: BreakAway | None = None,
) -> tuple[FixedStepRow, ...]:
    """Run a mechanism event-driven, and as a block diagram with each step.

    A run with a step that is too large for the law ends where it grows beyond all numbers;
    `largest_step` tells what bristles allow.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw
        Friction of its contact.
    t_end : float
        Time at which runs end [s].
    y0 : mapping of str to float, optional
        Initial states by name [SI]; those of the mechanism if not given.
    steps : sequence of float
        Fixed steps [s].
    method : str
        Integration method of the fixed-step runs.
    break_away : str, optional
        Friction in their first step out of rest, of a law without bristles: ``static`` if not
        given, ``kinetic`` or ``zero``.

    Returns
    -------
    tuple of FixedStepRow
        The event-driven run, then two runs for each step, with and without a rule that holds the
        body.

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
    slip = slip_of(mechanism)
    rate = mechanism.rates[mechanism.coordinates.index(slip)]
    for dt, stick_rule in settings:
        solver = None
        if dt is not None:
            solver = FixedStep(dt=dt, method=method, stick_rule=stick_rule, break_away=break_away)
        run = simulate(mechanism, law, t_end=t_end, y0=y0, solver=solver, throw=False)
        signs = [1 if value > 0 else -1 for value in run[rate] if value != 0]
        rows.append(
            FixedStepRow(
                dt=dt,
                stick_rule=stick_rule,
                criteria=criteria_of(run, mechanism),
                reversals=sum(a != b for a, b in itertools.pairwise(signs)),
                run=run,
            )
        )
    return tuple(rows)


def largest_step(mechanism: Mechanism, law: FrictionLaw, run: Trajectory) -> float | None:
    """Return the step above which forward Euler lets the bristles of a law grow in a run.

    It is 2 over the largest rate at which a deflection decays, which for LuGre friction is
    ``sigma_0 |v| / g(v)``.

    Examples
    --------
    >>> from stickslip import Dahl, SpringBlock, simulate
    >>> block = SpringBlock(mass=1.0)
    >>> law = Dahl.from_forces(load=9.81, kinetic_force=2.0, bristle_stiffness=1e4)
    >>> run = simulate(block, law, t_end=0.1, y0={"v": 1.0})
    >>> round(largest_step(block, law, run), 9)  # 2 F_c / (sigma_0 v)
    0.0004
    """
    if not law.states:
        return None
    slip = slip_of(mechanism)
    rate = mechanism.rates[mechanism.coordinates.index(slip)]
    seen = run.at(np.union1d(np.linspace(*run.span, GRID), run.t))
    deflections = [seen[name] for name in law.states]
    fastest = 0.0
    for i, z in enumerate(deflections):
        nudge = NUDGE * float(np.abs(z).max())
        if nudge == 0.0:
            continue
        above, below = (
            _rates(
                law,
                seen[rate],
                seen["normal_force"],
                (*deflections[:i], z + side * nudge, *deflections[i + 1 :]),
            )[i]
            for side in (1.0, -1.0)
        )
        decay = np.abs(np.asarray(above - below)) / (2.0 * nudge)
        fastest = max(fastest, float(decay.max()))
    return 2.0 / fastest if fastest > 0.0 else None


def _rates(
    law: FrictionLaw, v: Scalar, load: Scalar, states: tuple[Scalar, ...]
) -> tuple[Scalar, ...]:
    """Return the rates of states where every element slips, which then change by themselves."""
    with Latches([True] * len(states)):
        return law.rates(v, load, states)
