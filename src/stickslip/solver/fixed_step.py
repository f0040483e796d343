"""A block diagram with a fixed step: what chatter, drift and false reversals come from."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.errors import InputError, ParameterError
from stickslip.formatting import number
from stickslip.friction import FrictionLaw, Laws, PrintedForm
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity
from stickslip.solver.base import Solver, column_units, name_of_only_contact
from stickslip.solver.block_diagram import Diagram, limits_of
from stickslip.solver.initial_states import refuse_limits, refuse_stops
from stickslip.trajectory import Certificate, Status, Trajectory

__all__ = ["FixedStep", "Method"]

Method: TypeAlias = Literal["euler", "heun", "rk4"]
"""Integrators of a fixed step."""

MOST_STEPS = 1e7
"""Steps that a run may take: each keeps its state, and this many take some minutes."""

Tableau: TypeAlias = tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]

TABLEAUS: dict[str, Tableau] = {
    "euler": (((),), (1.0,)),
    "heun": (((), (1.0,)), (0.5, 0.5)),
    "rk4": (((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0)), (1 / 6, 1 / 3, 1 / 3, 1 / 6)),
}
"""Runge-Kutta coefficients: rows of stages, then weights."""

FRICTION = -3
"""Place of the friction force in a sample."""
NORMAL = -2
"""Place of the normal force in a sample."""


@final
@dataclass(frozen=True, kw_only=True)
class FixedStep(Solver):
    """Evaluates the friction block literally at every stage of a fixed step.

    Nothing is located: a reversal is noticed one step late, sgn 0 is 0, and a law without the
    stick rule chatters about zero velocity. Its certificate says what that cost. A coordinate that
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
    """Integrator: forward Euler, Heun, or the classical Runge-Kutta of order 4."""
    stick_rule: bool = True
    """Hold the body when its velocity changes sign within a step and break-away is not exceeded."""

    @override
    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.method not in TABLEAUS:
            raise ParameterError(
                f"FixedStep.method must be one of {', '.join(TABLEAUS)}, got {self.method!r}."
            )

    @override
    def run(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws | PrintedForm,
        *,
        y0: Sequence[float],
        t_end: float,
        told: Sequence[str] = (),
    ) -> Trajectory:
        if isinstance(law, Laws) or len(mechanism.contacts()) > 1:
            names = ", ".join(one.name for one in mechanism.contacts())
            raise InputError(
                f"FixedStep solves one contact, but {type(mechanism).__name__} has {names}: run it"
                " with EventDriven()."
            )
        refuse_stops(mechanism)
        refuse_limits(mechanism, limits_of(mechanism))
        diagram = Diagram.build(mechanism, law, t_end, y0)
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
        y = list(y0)
        held = self.stick_rule and y[diagram.slip] == 0 and diagram.holds(0.0, y)
        rows = [diagram.sample(0.0, y, held)]
        balances = [diagram.balance(0.0, y, rows[0][FRICTION])]
        status = Status.END_TIME
        for t, following in itertools.pairwise(times):
            try:
                y, held = self._step(diagram, t, following - t, y, held)
                row = diagram.sample(following, y, held)
                if not all(map(math.isfinite, row)):
                    status = Status.NOT_FINITE
                    break
                balance = diagram.balance(following, y, row[FRICTION])
            except (ArithmeticError, ValueError):
                status = Status.NOT_FINITE
                break
            rows.append(row)
            balances.append(balance)
            if row[NORMAL] < 0.0:
                status = Status.LIFT_OFF
                break
        return _trajectory(mechanism, diagram, np.array(rows), np.array(balances), status)

    def _times(self, t_end: float) -> list[float]:
        """Return the ends of the steps; the last one is shorter if it must be."""
        count = math.floor(t_end / self.dt * (1 + 1e-12))
        times = [i * self.dt for i in range(count + 1)]
        if t_end - times[-1] > 1e-9 * self.dt:
            return [*times, t_end]
        return [*times[:-1], t_end]

    def _step(
        self, diagram: Diagram, t: float, dt: float, y: list[float], held: bool
    ) -> tuple[list[float], bool]:
        """Advance one step; with the stick rule, stop at a sign change if the contact holds."""
        tableau = TABLEAUS[self.method]
        if held and diagram.holds(t, y):
            return _advanced(diagram, tableau, t, y, dt, held=True), True
        new = _advanced(diagram, tableau, t, y, dt, held=False)
        if self.stick_rule and y[diagram.slip] * new[diagram.slip] < 0:
            stopped = list(new)
            stopped[diagram.slip] = 0.0
            if diagram.holds(t + dt, stopped):
                return stopped, True
        return new, False


def _advanced(
    diagram: Diagram, tableau: Tableau, t: float, y: list[float], dt: float, *, held: bool
) -> list[float]:
    """Take one Runge-Kutta step."""
    stages, weights = tableau
    slopes: list[list[float]] = []
    for row in stages:
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


@dataclass(frozen=True)
class _Lines:
    """Gives columns between samples, joined by straight lines; the mode stays."""

    names: tuple[str, ...]
    """Names of the columns."""
    rows: NDArray[np.float64]
    """Time, columns and mode (n, 2 + columns)."""

    def __call__(self, t: NDArray[np.float64]) -> Mapping[str, NDArray[np.float64]]:
        rows = self.rows
        columns = {
            name: np.interp(t, rows[:, 0], rows[:, i]) for i, name in enumerate(self.names, start=1)
        }
        latest = np.searchsorted(rows[:, 0], t, side="right") - 1
        return {**columns, "mode": rows[latest, -1]}


def _trajectory(
    mechanism: Mechanism,
    diagram: Diagram,
    rows: NDArray[np.float64],
    balances: NDArray[np.float64],
    status: Status,
) -> Trajectory:
    """Wrap the samples; between them everything is joined by straight lines."""
    names = (
        *mechanism.coordinates,
        *mechanism.rates,
        *diagram.bristles,
        "friction",
        "normal_force",
    )
    return Trajectory(
        t=rows[:, 0],
        names=(*names, "mode"),
        units=column_units(mechanism, (*diagram.bristles, "friction", "normal_force", "mode")),
        events=(),
        status=status,
        certificate=_certificate(rows[:, 0], balances),
        span=(0.0, float(rows[-1, 0])),
        evaluate=_Lines(names, rows),
        only_contact=name_of_only_contact(mechanism),
    )


def _certificate(t: NDArray[np.float64], balances: NDArray[np.float64]) -> Certificate:
    """Say what the fixed step cost, by energies and powers (n, 3): it is never certified."""
    energy, power = balances[:, 0], balances[:, 1:]
    work = np.asarray(np.trapezoid(power, t, axis=0))
    size = max(abs(energy[0]), abs(energy[-1]), *np.abs(work))
    mismatch = abs(energy[-1] - energy[0] - work[0] + work[1])
    return Certificate(
        energy_error=float(mismatch / size) if 0 < size < math.inf else float(mismatch),
        energy_start=float(energy[0]),
        energy_end=float(energy[-1]),
        work_supplied=float(work[0]),
        work_friction=float(work[1]),
        guard_violation=0.0,
        event_residual=0.0,
        stick_drift=0.0,
        steps=len(t) - 1,
        rejected=0,
        problems=("fixed step: events were not located and the error was not controlled",),
    )
