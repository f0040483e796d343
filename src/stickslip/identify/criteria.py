"""The criteria of the source paper: of a run, beside runs with fixed steps; limits of intervals."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.engine.simulation import simulate
from stickslip.engine.solver import BreakAway, FixedStep, Method
from stickslip.engine.trajectory import Status, Trajectory
from stickslip.friction import FrictionLaw
from stickslip.identify.fits import READINGS, ROUNDING, Estimate, Fit
from stickslip.maths import Latches
from stickslip.mechanisms import Mechanism, slip_names
from stickslip.quantities import parameters
from stickslip.show.described import Described
from stickslip.show.formatting import capital, percent, quantity

GRID = 4000
"""Times at which a run is looked at, beside its steps."""
NUDGE = float(np.cbrt(np.finfo(float).eps))
"""Share of the largest deflection over which a rate is differentiated, to either side."""


@dataclass(frozen=True, kw_only=True)
class Criteria(metaclass=Described):
    """What a run does, in the paper's terms, with numbers instead of yes and no alone."""

    travel: float
    """Last position less the first [m]."""
    least_velocity: float
    """Lowest velocity [m/s]."""
    largest_return: float
    """Largest back-slip from the farthest point so far in the direction of the travel [m]."""
    velocity_never_negative: bool
    """Criterion 1. A law with elastic presliding fails it rightly: the body springs back."""
    displacement_never_decreases: bool
    """Criterion 2."""
    relative_error: float | None
    """Criterion 3: travel less measured travel, over the measured one; None without one."""
    work_in: float
    """Energy at the start and work of the drives [J], the left side of the paper's eq. (11)."""
    work_friction: float
    """Work taken by friction [J]."""
    work_left: float
    """Energy that the mechanism still has at the end [J]; eq. (11) leaves it out."""
    stop_time: float | None
    """When the body came to its last stop [s]; None if it still moves."""


def criteria_of(run: Trajectory, mechanism: Mechanism, measured: float | None = None) -> Criteria:
    """Evaluate the criteria on a run.

    Parameters
    ----------
    run : Trajectory
        The run.
    mechanism : Mechanism
        Whose run it is; names the slip coordinate.
    measured : float, optional
        Measured travel [m].

    Returns
    -------
    Criteria
        Travel [m], least velocity [m/s], energies [J] and stop time [s], and whether criteria hold.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> criteria_of(run, rig).velocity_never_negative
    False
    """
    slip, rate = slip_names(mechanism)
    times = np.union1d(np.linspace(*run.span, GRID), run.t)
    seen = run.at(times)
    x, v = seen[slip], seen[rate]
    travel = float(x[-1] - x[0])
    way = math.copysign(1.0, travel) * x
    back = float(np.max(np.maximum.accumulate(way) - way))
    fall = float(np.max(np.maximum.accumulate(x) - x))
    least = float(v.min())
    book = run.certificate
    still = v[-1] == 0.0 and run.events
    return Criteria(
        travel=travel,
        least_velocity=least,
        largest_return=back,
        velocity_never_negative=bool(least >= -ROUNDING * np.abs(v).max()),
        displacement_never_decreases=bool(fall <= ROUNDING * np.abs(x - x[0]).max()),
        relative_error=None if not measured else (travel - measured) / measured,
        work_in=book.energy_start + book.work_supplied,
        work_friction=book.work_friction,
        work_left=book.energy_end,
        stop_time=run.events[-1].t if still else None,
    )


# Which estimates of a fit may be quoted one by one, and what limits their intervals.


def limits_of(fit: Fit[Any]) -> tuple[str, ...]:
    """Return what limits each interval of a fit, with the path of the parameter.

    It is the record or the readings, or the uncertainty of the mechanism.
    """
    stated = {item.path: item for item in fit.estimates if item.sources}
    limits = {p: limit_text(x, fit.rig_uncertainties, fit.readings) for p, x in stated.items()}
    return tuple(f"{path}:{limit}" for path, limit in limits.items() if limit)


def limit_text(
    estimate: Estimate, stated: Sequence[tuple[Mechanism, Mapping[str, float]]], readings: str
) -> str:
    """Return which source makes most of an interval, as a sentence; empty if there is only one.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, fit
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(
    ...     travel=0.2, uncertainty=0.001, parameter_uncertainties={"stiffness": 3.0}
    ... )
    >>> (level,) = fit(rig, Coulomb, reading).estimates
    >>> limit_text(level, [(rig, {"mechanism.stiffness": 3.0})], "the reading")
    ' The stiffness (3 %) contributes more to its uncertainty than the reading.'
    """
    rig = {path: error for path, error in estimate.sources.items() if path != READINGS}
    if not rig:
        return ""
    path = max(rig, key=lambda item: rig[item])
    known = f"the {path.rpartition('.')[2].replace('_', ' ')}{_known_to(path, stated)}"
    if rig[path] > estimate.sources[READINGS]:
        return f" {capital(known)} contributes more to its uncertainty than {readings}."
    verb = "contribute" if readings.endswith("s") else "contributes"
    return f" {capital(readings)} {verb} more to its uncertainty than {known}."


def _known_to(path: str, stated: Sequence[tuple[Mechanism, Mapping[str, float]]]) -> str:
    """Return the uncertainty of a parameter in brackets: its share, or itself if that differs."""
    pairs = set()
    for mechanism, doubts in stated:
        known = {p: (value, q.unit) for p, q, value in parameters(mechanism, "mechanism")}
        if path in doubts:
            pairs.add((doubts[path], *known[path]))
    shares = {percent(doubt / abs(value)) for doubt, value, _ in pairs if value}
    if len(shares) == 1:
        return f" ({shares.pop()})"
    sizes = {quantity(doubt, unit, 2) for doubt, _, unit in pairs}
    return f" ({sizes.pop()})" if len(sizes) == 1 else ""


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
    _, rate = slip_names(mechanism)
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
    _, rate = slip_names(mechanism)
    seen = run.at(np.union1d(np.linspace(*run.span, GRID), run.t))
    deflections = [seen[name] for name in law.states]
    fastest = 0.0
    for i, z in enumerate(deflections):
        nudge = NUDGE * float(np.abs(z).max())
        if nudge == 0.0:
            continue
        rates = []
        for side in (nudge, -nudge):
            states = (*deflections[:i], z + side, *deflections[i + 1 :])
            with Latches([True] * len(states)):  # where every element slips, each by itself
                rates.append(law.rates(seen[rate], seen["normal_force"], states)[i])
        decay = np.abs(np.asarray(rates[0] - rates[1])) / (2.0 * nudge)
        fastest = max(fastest, float(decay.max()))
    return 2.0 / fastest if fastest > 0.0 else None
