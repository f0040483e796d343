"""A mechanism with friction as initial-value problems of SciPy, one for each stretch of a mode."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.display import require_library
from stickslip.errors import InputError, SimulationError
from stickslip.formulation import formulate
from stickslip.friction import Friction, PrintedForm
from stickslip.kernels.drive_segments import enter_pieces, next_stop
from stickslip.kernels.enums import RUNNING
from stickslip.kernels.guard_roots import guard_values
from stickslip.kernels.mode_transitions import (
    handle_event,
    initial_mode,
    settle,
    turn_switches,
)
from stickslip.kernels.model_interface import field
from stickslip.kernels.state_layout import (
    EVENT_COLUMNS,
    EVENTS,
    FIRST_LIMIT,
    MODE,
    MOST_EVENTS,
    N_GUARDS,
    POINT,
    SCALE,
    STALLS,
    STATUS,
    TIME,
    VALUES,
    Y,
)
from stickslip.mechanisms import Mechanism
from stickslip.simulation import check_pair, initial_state
from stickslip.solver import Equations, column_units, gather, status_of
from stickslip.trajectory import Status

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = ["ModeProblem", "ModeSolution", "to_ivp"]

Array = NDArray[np.float64]
EventFunction: TypeAlias = Callable[[float, Sequence[float]], float]

MOST = 100_000
"""Stretches after which `ModeProblem.solve` gives up."""
FINE = 200
"""Steps that `ModeProblem.solve` takes at least."""
INACTIVE = 1.0
"""Value of a guard that the mode does not have."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class ModeSolution:
    """What `ModeProblem.solve` has found: the steps of SciPy, mode after mode."""

    names: tuple[str, ...]
    """Names of the states."""
    units: Mapping[str, str]
    """SI unit of each."""
    t: Array
    """Times (n,) [s]; that of a change of mode stands twice, before and after it."""
    y: Array
    """States (n, states) [SI]."""
    mode: NDArray[np.int8]
    """Mode of each (n,): 0 stick, 1 and -1 slip, 2 and -2 at a stop."""
    events: tuple[tuple[float, int, int], ...]
    """Time [s], mode before and mode after of each change."""
    status: Status
    """How it ended."""
    evaluations: int
    """Evaluations of the right-hand side."""

    def __getitem__(self, name: str) -> Array:
        """Return a state (n,) by its name."""
        return self.y[:, self.names.index(name)]

    def to_dataframe(self) -> "pd.DataFrame":
        """Return time, states and mode as columns of a pandas DataFrame."""
        import pandas as pd

        columns = dict(zip(self.names, self.y.T, strict=True))
        return pd.DataFrame({"t": self.t, **columns, "mode": self.mode})

    def to_xarray(self) -> "xr.Dataset":
        """Return states and mode as an xarray Dataset over time, with units.

        Raises
        ------
        InputError
            If xarray is not installed.
        """
        require_library("xarray", "xarray", "use to_dataframe")
        import xarray as xr

        columns: dict[str, Any] = {
            name: ("t", column, {"units": self.units[name]})
            for name, column in zip(self.names, self.y.T, strict=True)
        }
        columns["mode"] = ("t", self.mode, {"units": "1"})
        return xr.Dataset(
            columns, {"t": ("t", self.t, {"units": "s"})}, {"status": self.status.value}
        )


@final
class ModeProblem:
    """Right-hand side and terminal events of the mode at hand, as `solve_ivp` takes them.

    `fun` and `events` belong to the present mode and piece of the drives, up to `stop`. After a
    stretch, `go_on` passes to what holds next: call `solve_ivp` again from `t` and `y`, until
    `status` is not None. `solve` is that loop.

    Examples
    --------
    >>> from scipy.integrate import solve_ivp
    >>> from stickslip import Coulomb, SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> problem = to_ivp(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> found = solve_ivp(problem.fun, (problem.t, problem.stop), problem.y, events=problem.events)
    >>> problem.mode, found.status, round(float(found.t[-1]), 2)
    (1, 1, 0.19)
    """

    def __init__(
        self,
        mechanism: Mechanism,
        law: Friction,
        *,
        t_end: float,
        y0: Mapping[str, float] | Sequence[float] | None = None,
    ) -> None:
        """Derive the equations, and find the mode that holds at time 0.

        Parameters
        ----------
        mechanism : Mechanism
            What moves, with one contact.
        law : FrictionLaw
            Friction of the contact.
        t_end : float
            Last time [s].
        y0 : mapping or sequence, optional
            Initial states, as in `simulate`.

        Raises
        ------
        InputError
            If the law is a printed form, or there are several contacts.
        """
        laws = check_pair(mechanism, law)
        if isinstance(laws, PrintedForm):
            raise InputError(
                f"to_ivp takes laws with modes, got {law!r}: give another law, or run it with"
                " simulate and FixedStep(...)."
            )
        if not (math.isfinite(t_end) and t_end > 0.0):
            raise InputError(f"t_end [s] must be above 0, got {t_end!r}.")
        self._model = model = formulate(mechanism, laws)
        if model.contacts:
            raise InputError(
                f"to_ivp takes mechanisms with one contact, and this {type(mechanism).__name__} has"
                f" {len(model.contacts)} ({', '.join(model.contacts)}): run it with simulate."
            )
        self.names, self.t_end = model.states, float(t_end)
        bristles = model.states[2 * len(mechanism.coordinates) :]
        self._units = column_units(mechanism, bristles)
        inputs = gather(mechanism, laws, model, self.t_end)
        equations = Equations(model, inputs)
        self._w, self._whole, self._table = equations.w, equations.whole, inputs.table.tolist()
        self._rows = [0.0] * (2 * (self._whole[MOST_EVENTS] + 2) * EVENT_COLUMNS)
        self.changes: list[tuple[float, int, int]] = []
        start = initial_state("to_ivp", mechanism, laws, y0)
        self._w[self._whole[Y] : self._whole[Y] + len(start)] = start
        enter_pieces(self._table, self._w, self._whole)
        initial_mode(self._w, self._whole)
        self._settle()
        self.events = [self._event(guard) for guard in range(self._whole[N_GUARDS])]

    @property
    def t(self) -> float:
        """Time that is reached [s]."""
        return float(self._w[TIME])

    @property
    def y(self) -> Array:
        """State there (n,) [SI]."""
        first = self._whole[Y]
        return np.array(self._w[first : first + len(self.names)], dtype=np.float64)

    @property
    def mode(self) -> int:
        """0 stick, 1 and -1 slip forward and backward, 2 and -2 pressed against a stop."""
        return int(self._whole[MODE])

    @property
    def stop(self) -> float:
        """Time up to which the drives are smooth [s], `t_end` at the latest."""
        return float(next_stop(self._table, self.t_end, self._whole))

    @property
    def status(self) -> Status | None:
        """How the motion ended; None while it goes on."""
        if self._whole[STATUS] != RUNNING:
            return status_of(self._whole[STATUS], self._model)
        return Status.END_TIME if self.t >= self.t_end else None

    def fun(self, t: float, y: Sequence[float]) -> list[float]:
        """Return the time derivatives of the states in the present mode.

        Parameters
        ----------
        t : float
            Time [s].
        y : sequence of float (n,)
            State [SI].

        Returns
        -------
        list of float (n,)
            Derivatives [SI].
        """
        to = self._whole[VALUES]
        field(t, self._w, self._whole, self._put(y), to)
        return self._w[to : to + len(self.names)]

    def _put(self, y: Sequence[float]) -> int:
        """Write a state beside that of the problem; return its place."""
        point = int(self._whole[POINT])
        self._w[point : point + len(self.names)] = map(float, y)
        return point

    def _event(self, guard: int) -> EventFunction:
        """Return a guard as an event of SciPy, which ends a stretch where it falls below 0."""

        def event(t: float, y: Sequence[float]) -> float:
            to = self._whole[VALUES]
            guard_values(t, self._w, self._whole, self._put(y), to)
            value = float(self._w[to + guard])
            return INACTIVE if value == 0.0 else value

        known: Any = event  # SciPy reads attributes of functions
        known.terminal, known.direction = True, -1.0
        return event

    def go_on(self, t: float, y: Sequence[float], guard: int | None = None) -> None:
        """Move to the end of a stretch, and to the mode or piece of the drives that holds next.

        Parameters
        ----------
        t : float
            Time that the stretch reached [s].
        y : sequence of float (n,)
            State there [SI].
        guard : int, optional
            Index of the event that ended it; None if it reached `stop`.
        """
        w, whole = self._w, self._whole
        stop, first = self.stop, whole[Y]
        w[TIME] = float(t)
        w[first : first + len(self.names)] = map(float, y)
        for i, value in enumerate(self.y):
            w[whole[SCALE] + i] = max(w[whole[SCALE] + i], abs(float(value)))
        if guard is not None:
            self._changing(handle_event, guard)
            if guard < whole[FIRST_LIMIT]:
                self._settle()
        elif t >= stop:
            w[TIME] = stop
            enter_pieces(self._table, w, whole)
            self._changing(turn_switches)
            self._settle()

    def _settle(self) -> None:
        if self._whole[STATUS] == RUNNING:
            self._changing(settle)

    def _changing(self, transition: Callable[..., None], *before: int) -> None:
        """Make a transition and note what it changed."""
        whole, old = self._whole, self.mode
        self._rows[:EVENT_COLUMNS] = self._rows[whole[EVENTS] * EVENT_COLUMNS :][:EVENT_COLUMNS]
        whole[EVENTS], whole[STALLS] = 0, 0
        transition(*before, self._w, whole, self._rows)
        if self.mode != old:
            self.changes.append((self.t, old, self.mode))

    def solve(
        self,
        *,
        method: str = "DOP853",
        rtol: float = 1e-10,
        atol: float = 1e-12,
        max_step: float | None = None,
    ) -> ModeSolution:
        """Integrate by `scipy.integrate.solve_ivp` to the end, anew after each event.

        Parameters
        ----------
        method : str, default "DOP853"
            Method of `solve_ivp`; ``"Radau"`` for laws with bristles.
        rtol, atol : float
            Tolerances of `solve_ivp`.
        max_step : float, optional
            Longest step [s]; a two-hundredth of `t_end` if not given. SciPy looks for events
            between the ends of steps, so it misses two of one kind within a step: where a body is
            held, nothing else keeps steps short.

        Returns
        -------
        ModeSolution
            Steps, modes and events.

        Raises
        ------
        SimulationError
            If SciPy fails, or modes change without end.
        """
        from scipy.integrate import solve_ivp

        longest = self.t_end / FINE if max_step is None else max_step
        times, states, modes = [np.array([self.t])], [self.y[None]], [np.array([self.mode])]
        evaluations = 0
        for _ in range(MOST):
            if self.status is not None:
                break
            found = solve_ivp(
                self.fun, (self.t, self.stop), self.y, method=method, rtol=rtol, atol=atol,
                max_step=longest, events=self.events,
            )  # fmt: skip
            if found.status < 0:
                raise SimulationError(f"solve_ivp failed at t = {found.t[-1]:g} s: {found.message}")
            evaluations += int(found.nfev)
            times.append(found.t[1:])
            states.append(found.y.T[1:])
            modes.append(np.full(len(found.t) - 1, self.mode))
            hit = [k for k, at in enumerate(found.t_events) if len(at)]
            self.go_on(found.t[-1], found.y[:, -1], hit[0] if hit else None)
            times.append(np.array([self.t]))
            states.append(self.y[None])
            modes.append(np.array([self.mode]))
        status = self.status
        if status is None:
            raise SimulationError(
                f"the mode changed {MOST} times until t = {self.t:g} s: run it with simulate, which"
                " says why."
            )
        return ModeSolution(
            names=self.names,
            units={name: self._units[name] for name in self.names},
            t=np.concatenate(times),
            y=np.concatenate(states),
            mode=np.concatenate(modes).astype(np.int8),
            events=tuple(self.changes),
            status=status,
            evaluations=evaluations,
        )


def to_ivp(
    mechanism: Mechanism,
    law: Friction,
    *,
    t_end: float,
    y0: Mapping[str, float] | Sequence[float] | None = None,
) -> ModeProblem:
    """Return a mechanism with a law as initial-value problems of `scipy.integrate.solve_ivp`.

    Modes, and what follows an event, are those of `simulate`; steps and times of events are
    SciPy's.

    Parameters
    ----------
    mechanism : Mechanism
        What moves, with one contact.
    law : FrictionLaw
        Friction of the contact.
    t_end : float
        Last time [s].
    y0 : mapping or sequence, optional
        Initial states, as in `simulate`.

    Returns
    -------
    ModeProblem
        Right-hand side, events, and a loop that goes on after each.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> found = to_ivp(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0).solve()
    >>> round(float(found["x"][-1]), 7), [event[1:] for event in found.events]
    (0.2038736, [(1, 0)])
    """
    return ModeProblem(mechanism, law, t_end=t_end, y0=y0)
