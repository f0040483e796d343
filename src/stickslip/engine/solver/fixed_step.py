"""A block diagram with a fixed step: what chatter, drift and false reversals come from.

Hard stops are those of an integrator with limits, whose state is reset. A coordinate that ends a
step beyond its stop is put onto it, and its rate is reversed, times the restitution; the others
change by the same impulse as in exact runs. The speed is that with which it passed the stop, by the
depth it has come to. An impact so slow that steps do not tell its rebounds apart is one without
restitution, which ends the bounces. What is at rest at its stop
is held while it is pressed, as by friction, and leaves as its press ends.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.formulation import PAINLEVE
from stickslip.engine.solver.block_diagram import (
    BlockDiagram,
    BreakAway,
    ContactDiagram,
    Diagram,
    SoftConstraint,
    limits_of,
)
from stickslip.engine.solver.run import Solver, column_units
from stickslip.engine.solver.starts import refuse_limits, within_stops
from stickslip.engine.trajectory import Certificate, Status, Trajectory
from stickslip.errors import InputError, ParameterError
from stickslip.friction import FrictionLaw, Laws, PrintedForm
from stickslip.mechanisms import Mechanism, has_one_slip, stops_of
from stickslip.quantities import Quantity
from stickslip.show.formatting import joined, number

Method: TypeAlias = Literal["euler", "semi-implicit", "heun", "rk4"]
"""Integrators of a fixed step."""

NUDGE = 1e-9
"""Deflection over which the rate of a bristle is differentiated [m]; bristles deflect by more."""
MOST_STEPS = 1e7
"""Steps that a run may take: each keeps its state, and this many take some minutes."""

Tableau: TypeAlias = tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]

TABLEAUS: dict[str, Tableau] = {
    "euler": (((),), (1.0,)),
    "semi-implicit": (((),), (1.0,)),  # coordinates then move by the new rates
    "heun": (((), (1.0,)), (0.5, 0.5)),
    "rk4": (((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0)), (1 / 6, 1 / 3, 1 / 3, 1 / 6)),
}
"""Runge-Kutta coefficients: rows of stages, then weights."""


@dataclass(frozen=True, kw_only=True)
class FixedStep(Solver):
    """Evaluates the friction block literally at every stage of a fixed step.

    Nothing is located: a reversal is noticed one step late, and a law without the stick rule
    chatters about zero velocity. Its certificate says what that cost. A coordinate that
    a profile guides is where the profile says at every stage.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(
    ...     rig,
    ...     Coulomb(kinetic_coefficient=0.25),
    ...     t_end=1.0,
    ...     solver=FixedStep(dt=0.01, stick_rule=False),
    ... )
    >>> bool(run["v"].min() < 0)
    True
    """

    dt: Annotated[float, Quantity("dt", "s", above=0)]
    """Step."""
    method: Method = "euler"
    """Integrator: forward Euler, semi-implicit Euler, Heun, or Runge-Kutta of order 4.
    With semi-implicit Euler, coordinates move by the new rates, and bristles as if the speed
    stayed."""
    stick_rule: bool | None = None
    """Hold the body when its velocity changes sign within a step and break-away is not exceeded; if
    not given, with friction laws but not with equations as printed, which have no such rule. Heun
    and Runge-Kutta can change the sign between their stages but not between the ends of steps,
    which the rule does not see: the body then hovers at a small speed instead of resting."""
    break_away: BreakAway | None = None
    """Friction of a body at rest that the applied force exceeds: the break-away level (``static``),
    as (5) of the source paper and Karnopp (1985) have it, that of sliding (``kinetic``), or none,
    since sgn 0 = 0 (``zero``); if not given, static. Bristles, equations as printed and a soft
    constraint have their own, beside which none is taken."""
    zero_velocity_band: Annotated[float, Quantity("D_v", "m/s", low=0)] = 0.0
    """Hold it too when a step ends within this speed and break-away is not exceeded (Karnopp)."""
    soft: SoftConstraint | None = None
    """Hold it softly, as MuJoCo does, in place of both rules; of a law without memory."""
    viscous: Annotated[float, Quantity("D", "N s/m", low=0)] = 0.0
    """Part of the law's friction over velocity that steps take with the velocity at their end, as
    MuJoCo does with the damping of joints; of one contact."""

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.method not in TABLEAUS:
            raise ParameterError(
                f"FixedStep.method must be one of {', '.join(TABLEAUS)}, got {self.method!r}."
            )
        if self.break_away not in (None, *(known := get_args(BreakAway))):
            raise ParameterError(
                f"FixedStep.break_away must be one of {', '.join(known)}, got {self.break_away!r}."
            )

    def run(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws | PrintedForm,
        *,
        y0: Sequence[float],
        t_end: float,
        told: Sequence[str] = (),
    ) -> Trajectory:
        if self.stick_rule is None:
            rule = not isinstance(law, PrintedForm)
            return replace(self, stick_rule=rule).run(mechanism, law, y0=y0, t_end=t_end, told=told)
        y0 = within_stops(mechanism, y0)
        diagram = _diagram(self, mechanism, law, t_end, y0)
        if self.dt > t_end:
            raise ParameterError(
                f"FixedStep.dt (dt) must be at most t_end = {number(t_end, 6)} s, got"
                f" {number(self.dt, 6)}."
            )
        if t_end > MOST_STEPS * self.dt:
            raise ParameterError(
                f"FixedStep.dt (dt) must be at least {number(t_end / MOST_STEPS)} s for t_end ="
                f" {number(t_end, 6)} s, got {number(self.dt, 6)}: more than {number(MOST_STEPS)}"
                " steps."
            )
        times = self._times(t_end)
        y = diagram.begun(y0)
        rests = tuple(
            self.soft is None and ((self.stick_rule and y[slip] == 0) or self._within_band(y[slip]))
            for slip in diagram.slips
        )
        # What is pressed to a stop is held there from the start, whatever the speed band says.
        rests = tuple(a or b for a, b in zip(rests, diagram.stopped(y), strict=True))
        held = diagram.holds(0.0, y, rests)
        for slip, stuck in zip(diagram.slips, held, strict=True):
            y[slip] = 0.0 if stuck else y[slip]
        rows = [diagram.sample(0.0, y, held)]
        balances = [diagram.balance(0.0, y, held, rows[0])]
        status = Status.END_TIME
        for t, following in itertools.pairwise(times):
            try:
                y, held = self._step(diagram, t, following - t, y, held)
                # After the step: integrators of diagrams know impacts as resets, not as events.
                y, held = diagram.struck(following, following - t, y, held)
                diagram.turn(following, y)
                row = diagram.sample(following, y, held)
                # Large steps may diverge: a run ends with its last finite sample, not with an
                # exception.
                if not all(map(math.isfinite, row)):
                    status = Status.NOT_FINITE
                    break
                balance = diagram.balance(following, y, held, row)
            except (ArithmeticError, ValueError):
                status = Status.NOT_FINITE
                break
            rows.append(row)
            balances.append(balance)
            if diagram.lifts(row):
                status = Status.LIFT_OFF
                break
        # Between samples everything is joined by straight lines.
        samples = np.array(rows)
        names, contacts = diagram.columns, mechanism.contacts()
        return Trajectory(
            t=samples[:, 0],
            names=names,
            units=column_units(mechanism, names[2 * len(mechanism.coordinates) :]),
            events=(),
            status=status,
            certificate=_certificate(samples[:, 0], np.array(balances), diagram),
            span=(0.0, float(samples[-1, 0])),
            evaluate=_Lines(names, samples),
            only_contact=contacts[0].name if len(contacts) == 1 else "",
            step_times=samples[:, 0],
            states=tuple(name for name in names if name.partition(":")[0] not in OF_CONTACTS),
        )

    def _times(self, t_end: float) -> list[float]:
        """Return the ends of the steps; the last one is shorter if it must be."""
        # A step that is missing by rounding only is no further step.
        count = math.floor(t_end / self.dt * (1 + 1e-12))
        times = [i * self.dt for i in range(count + 1)]
        if t_end - times[-1] > 1e-9 * self.dt:
            return [*times, t_end]
        return [*times[:-1], t_end]

    def _within_band(self, velocity: float) -> bool:
        return self.zero_velocity_band > 0 and abs(velocity) <= self.zero_velocity_band

    def _step(
        self, diagram: BlockDiagram, t: float, dt: float, y: list[float], held: tuple[bool, ...]
    ) -> tuple[list[float], tuple[bool, ...]]:
        """Advance one step; by the rules for rest, stop what a contact holds."""
        tableau = TABLEAUS[self.method]
        kept = diagram.holds(t, y, held)
        new = _advanced(diagram, tableau, t, y, dt, kept)
        if self.method == "semi-implicit":
            n = diagram.coordinates
            # Coordinates move by the new rates, which makes the method symplectic for a free
            # oscillator.
            new[:n] = [x + dt * rate for x, rate in zip(y[:n], new[n : 2 * n], strict=True)]
            for i in range(2 * n, len(y)):  # exact for bristles that decay in proportion
                decay = dt * _slope(diagram, t, y, kept, i)
                new[i] = y[i] + (math.expm1(decay) / decay if decay else 1.0) * (new[i] - y[i])
            new = diagram.led(t + dt, new)
        # A soft constraint creeps: no rule for rest applies to it.
        if self.soft is not None:
            return new, kept
        # Karnopp's rule: a sign change, or a speed within the band, asks whether the contact holds.
        slips = list(zip(diagram.slips, kept, strict=True))
        turned = [
            not stuck and ((self.stick_rule and y[i] * new[i] < 0) or self._within_band(new[i]))
            for i, stuck in slips
        ]
        if not any(turned):
            return new, kept
        stopped = list(new)
        for (i, _), turns in zip(slips, turned, strict=True):
            stopped[i] = 0.0 if turns else new[i]
        caught = diagram.holds(
            t + dt, stopped, tuple(a or b for a, b in zip(kept, turned, strict=True))
        )
        after = tuple(a or b for a, b in zip(kept, caught, strict=True))
        # If nothing holds, the step stands as it is, past its reversal.
        if not any(turns and holds for turns, holds in zip(turned, caught, strict=True)):
            return new, kept
        for (i, _), turns, holds in zip(slips, turned, caught, strict=True):
            stopped[i] = new[i] if turns and not holds else stopped[i]
        return stopped, after


def _slope(
    diagram: BlockDiagram, t: float, y: Sequence[float], held: tuple[bool, ...], i: int
) -> float:
    """Return the rate of a bristle by its deflection [1/s]."""
    moved = [*y]
    moved[i] += NUDGE
    return (diagram.rates(t, moved, held)[i] - diagram.rates(t, y, held)[i]) / NUDGE


def _diagram(
    solver: FixedStep,
    mechanism: Mechanism,
    law: FrictionLaw | Laws | PrintedForm,
    t_end: float,
    y0: Sequence[float],
) -> BlockDiagram:
    """Return the diagram of a mechanism, whose equations are parts where contacts are several."""
    contacts, soft = mechanism.contacts(), solver.soft
    _refuse_break_away(solver, law)
    break_away = solver.break_away or "static"
    if not isinstance(law, Laws) and has_one_slip(mechanism) and not stops_of(mechanism):
        refuse_limits(mechanism, limits_of(mechanism))
        if soft is not None and (isinstance(law, PrintedForm) or law.states):
            raise InputError(
                f"FixedStep.soft holds a body by a law without memory, not by {law.name}: leave it"
                " out."
            )
        return Diagram.build(mechanism, law, t_end, y0, break_away, soft, solver.viscous, solver.dt)
    if soft is not None or solver.viscous:
        raise InputError(
            "FixedStep.soft and viscous take a mechanism with one contact that slips along a"
            f" coordinate and no hard stops, but {mechanism.name} has"
            f" {', '.join(contact.name for contact in contacts) or 'others'}: leave them out."
        )
    if isinstance(law, PrintedForm):
        names = ", ".join(contact.name for contact in contacts) or "hard stops"
        raise InputError(
            f"{law.name} is an equation as printed, for one contact that slips along a coordinate"
            f" without stops, but {type(mechanism).__name__} has {names}: give"
            f" {law.corrected.__name__}(...)."
        )
    limits = limits_of(mechanism)
    refuse_limits(mechanism, tuple(name for name in limits if name != PAINLEVE))
    return ContactDiagram.build(mechanism, law, t_end, y0, break_away)


def _refuse_break_away(solver: FixedStep, law: FrictionLaw | Laws | PrintedForm) -> None:
    """Refuse a friction out of rest where nothing asks for it."""
    if solver.break_away is None:
        return
    laws = [member for _, member in law.members] if isinstance(law, Laws) else [law]
    if solver.soft is not None:
        why = "a soft constraint has its own"
    elif isinstance(law, PrintedForm):
        why = f"{law.name}, an equation as printed, has its own"
    elif all(form.states for form in laws):
        names = joined([*dict.fromkeys(form.name for form in laws)])
        why = f"the bristles of {names} carry friction there"
    else:
        return
    raise InputError(
        f"FixedStep.break_away is friction in the first step out of rest, and {why}: leave it out,"
        f" got {solver.break_away!r}."
    )


def _advanced(
    diagram: BlockDiagram,
    tableau: Tableau,
    t: float,
    y: list[float],
    dt: float,
    held: tuple[bool, ...],
) -> list[float]:
    """Take one Runge-Kutta step."""
    stages, weights = tableau
    slopes: list[list[float]] = []
    for row in stages:
        # At the first stage a guided coordinate may have to be moved before anything is asked.
        if not row and not diagram.leads:  # the state itself, which the diagram knows by now
            slopes.append(diagram.rates(t, y, held))
            continue
        at = t + dt * sum(row)
        point = diagram.led(at, _moved(y, dt, row, slopes))
        slopes.append(diagram.rates(at, point, held))
    return diagram.led(t + dt, _moved(y, dt, weights, slopes))


def _moved(
    y: Sequence[float], dt: float, weights: Sequence[float], slopes: Sequence[Sequence[float]]
) -> list[float]:
    """Return a state moved along slopes, each with its weight; few of them without a loop."""
    # Written out for few stages: this runs at each stage of each step.
    match weights, slopes:
        case (a,), (first,):
            return [value + dt * (a * p) for value, p in zip(y, first, strict=True)]
        case (a, b), (first, second):
            return [
                value + dt * (a * p + b * q) for value, p, q in zip(y, first, second, strict=True)
            ]
    return [
        value + dt * sum(w * slope[i] for w, slope in zip(weights, slopes, strict=True))
        for i, value in enumerate(y)
    ]


OF_CONTACTS = ("friction", "normal_force", "mode")
"""Columns that are no states, with the name of a contact after a colon where there are several."""


@dataclass(frozen=True)
class _Lines:
    """Gives columns between samples, joined by straight lines; the mode stays."""

    names: tuple[str, ...]
    """Names of the columns."""
    rows: NDArray[np.float64]
    """Time and columns (n, 1 + columns)."""

    def __call__(self, t: NDArray[np.float64]) -> Mapping[str, NDArray[np.float64]]:
        rows = self.rows
        # The mode at a time is that of the sample before it: halves of modes mean nothing.
        latest = np.searchsorted(rows[:, 0], t, side="right") - 1
        return {
            name: rows[latest, i]
            if name.partition(":")[0] == "mode"
            else np.interp(t, rows[:, 0], rows[:, i])
            for i, name in enumerate(self.names, start=1)
        }


def _certificate(
    t: NDArray[np.float64], balances: NDArray[np.float64], diagram: BlockDiagram
) -> Certificate:
    """Say what the fixed step cost, by energies and powers: it is never certified."""
    energy = balances[:, 0]
    power = np.column_stack([balances[:, 1], balances[:, 2:].sum(axis=1)])
    # By the same straight lines that users get between samples.
    work = np.asarray(np.trapezoid(power, t, axis=0))
    own = np.asarray(np.trapezoid(balances[:, 2:], t, axis=0)).tolist()
    size = max(abs(energy[0]), abs(energy[-1]), *np.abs(work))
    mismatch = abs(energy[-1] - energy[0] - work[0] + work[1] + diagram.lost)
    return Certificate(
        energy_error=float(mismatch / size) if 0 < size < math.inf else float(mismatch),
        energy_start=float(energy[0]),
        energy_end=float(energy[-1]),
        work_supplied=float(work[0]),
        work_friction=float(work[1]),
        work_stops=diagram.lost,
        guard_violation=0.0,
        event_residual=0.0,
        stick_drift=0.0,
        steps=len(t) - 1,
        rejected=0,
        work=dict(zip(diagram.contacts, own, strict=False)),
        problems=("fixed step: events were not located and the error was not controlled",),
    )
