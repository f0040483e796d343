"""A mechanism with friction as initial-value problems of SciPy, one for each stretch of a mode."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.engine import solver
from stickslip.engine.formulation import formulate
from stickslip.engine.kernels import exchange
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.equations import next_stop
from stickslip.engine.kernels.guard_roots import guard_values
from stickslip.engine.simulation import check_pair, initial_state
from stickslip.engine.trajectory import Status
from stickslip.errors import InputError, SimulationError
from stickslip.friction import Friction, PrintedForm
from stickslip.mechanisms import Mechanism
from stickslip.show.described import Described
from stickslip.show.display import require_library

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

Array = NDArray[np.float64]
EventFunction: TypeAlias = Callable[[float, Sequence[float]], float]
Change: TypeAlias = tuple[float, int, int] | tuple[float, int, int, str]

MOST_STRETCHES = 100_000
"""Stretches after which `ModeProblem.solve` gives up."""
FINE = 200
"""Steps that `ModeProblem.solve` takes at least."""
MOST_FALLS = 1000
"""Changes at one instant after which there is no end of them."""
INACTIVE = 1.0
"""Value of a guard that the mode does not have."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ModeSolution(metaclass=Described):
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
    """Mode of each (n,), of several contacts (n, c): 0 stick, 1 and -1 slip, 2 and -2 at a stop, 3
    without load."""
    events: tuple[Change, ...]
    """Time [s], mode before and mode after of each change, of several contacts with its name."""
    status: Status
    """How it ended."""
    evaluations: int
    """Evaluations of the right-hand side."""
    contacts: tuple[str, ...] = ()
    """Names of the contacts where there are several, in the order of the columns of `mode`."""

    def __getitem__(self, name: str) -> Array:
        """Return a state (n,) by its name."""
        return self.y[:, self.names.index(name)]

    def to_dataframe(self) -> "pd.DataFrame":
        """Return time, states and modes as columns of a pandas DataFrame."""
        import pandas as pd

        columns = dict(zip(self.names, self.y.T, strict=True))
        return pd.DataFrame({"t": self.t, **columns, **self._modes()})

    def _modes(self) -> dict[str, NDArray[np.int8]]:
        """Return the modes by column, as those of `simulate` are called."""
        if not self.contacts:
            return {"mode": self.mode}
        return {f"mode:{contact}": self.mode[:, i] for i, contact in enumerate(self.contacts)}

    def to_xarray(self) -> "xr.Dataset":
        """Return states and modes as an xarray Dataset over time, with units.

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
        columns |= {name: ("t", mode, {"units": "1"}) for name, mode in self._modes().items()}
        return xr.Dataset(
            columns, {"t": ("t", self.t, {"units": "s"})}, {"status": self.status.value}
        )


class ModeProblem:
    """Right-hand side and terminal events of the modes at hand, as `solve_ivp` takes them.

    `fun` and `events` belong to the present modes and piece of the drives, up to `stop`. After a
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
            What moves.
        law : FrictionLaw or mapping of str to FrictionLaw
            What holds it back, as in `simulate`.
        t_end : float
            Last time [s].
        y0 : mapping or sequence, optional
            Initial states, as in `simulate`.

        Raises
        ------
        InputError
            If the law is a printed form, or `t_end` is not above 0.
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
        self.names, self.t_end = model.states, float(t_end)
        self.contacts = () if model.alone else tuple(model.contacts)
        bristles = model.states[2 * len(mechanism.coordinates) :]
        self._units = solver.column_units(mechanism, bristles)
        inputs = solver.gather(mechanism, laws, model, self.t_end)
        equations = solver.Equations(model, inputs)
        self._w, self._whole, self._table = equations.w, equations.whole, inputs.table.tolist()
        self._tolerance = solver.EventDriven().tolerance_for(laws)
        self._longest = inputs.time_scale / 6.0
        self._rows = [0.0] * (2 * (self._whole[layout.MOST_EVENTS] + 2) * layout.EVENT_COLUMNS)
        self._log = [0.0] * (2 * self._whole[layout.ROW_COLUMNS])
        self._known: tuple[float, list[float], list[float]] | None = None
        self.changes: list[Change] = []
        start = initial_state("to_ivp", mechanism, laws, y0)
        self._put(solver.within_stops(mechanism, start), layout.Y)
        self._happen(exchange.ENTER)
        self._look()
        self.events = [self._event(guard) for guard in range(self._whole[layout.N_GUARDS])]

    @property
    def t(self) -> float:
        """Time that is reached [s]."""
        return self._t

    @property
    def y(self) -> Array:
        """State there (n,) [SI]."""
        self._ask(exchange.SHOWN)
        return np.array(self._seen(layout.POINT, len(self.names)), dtype=np.float64)

    @property
    def mode(self) -> int | tuple[int, ...]:
        """0 stick, 1 and -1 slip, 2 and -2 pressed against a stop; a tuple of several contacts."""
        if not self._model.contacts:
            return int(self._whole[layout.MODE])
        self._ask(exchange.SHOWN)
        self._ask(exchange.COLUMNS_AT)
        count = len(self._model.contacts)  # columns have friction and loads first
        modes = tuple(int(mode) for mode in self._seen(layout.VALUES, 3 * count)[2 * count :])
        return modes if self.contacts else modes[0]

    @property
    def stop(self) -> float:
        """Time up to which the drives are smooth [s], `t_end` at the latest."""
        return float(next_stop(self._table, self.t_end, self._whole))

    @property
    def status(self) -> Status | None:
        """How the motion ended; None while it goes on."""
        if self._whole[layout.STATUS] != layout.RUNNING:
            return solver.status_of(self._whole[layout.STATUS], self._model)
        return Status.END_TIME if self.t >= self.t_end else None

    def fun(self, t: float, y: Sequence[float]) -> list[float]:
        """Return the time derivatives of the states in the present modes.

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
        self._w[layout.TIME] = float(t)
        self._put(y, layout.POINT)
        self._ask(exchange.RATES_AT)
        return self._seen(layout.STAGES, len(self.names))

    def _ask(self, question: int, guard: int = 0) -> int:
        """Ask the kernels at the time and states in the vector of the run."""
        return exchange.exchange(
            question, guard, self.t_end, self._tolerance, self._longest, self._w, self._whole,
            self._table, self._log, self._rows,
        )  # fmt: skip

    def _put(self, y: Sequence[float], slot: int) -> None:
        """Write a state to its place in the vector of the run."""
        at = self._whole[slot]
        self._w[at : at + len(self.names)] = map(float, y)

    def _seen(self, slot: int, n: int) -> list[float]:
        """Return numbers from a place in the vector of the run."""
        at = self._whole[slot]
        return self._w[at : at + n]

    def _guards(self, t: float, y: Sequence[float]) -> list[float]:
        """Return all guards, those of the state that was asked about last without new work."""
        state = [float(value) for value in y]
        if self._known is None or self._known[:2] != (t, state):
            self._w[layout.TIME] = float(t)
            self._put(state, layout.POINT)
            at, to = self._whole[layout.POINT], self._whole[layout.SAMPLED]
            exchange.take_over(at, self._w, self._whole)
            guard_values(t, float(t) - self._t, self._w, self._whole, at, to)
            self._known = (t, state, self._seen(layout.SAMPLED, self._whole[layout.N_GUARDS]))
        return self._known[2]

    def _event(self, guard: int) -> EventFunction:
        """Return a guard as an event of SciPy, which ends a stretch where it falls below 0."""

        def event(t: float, y: Sequence[float]) -> float:
            value = float(self._guards(t, y)[guard])
            return INACTIVE if value == 0.0 else value

        known: Any = event  # SciPy reads attributes of functions
        known.terminal, known.direction = True, -1.0
        return event

    def go_on(self, t: float, y: Sequence[float], guard: int | None = None) -> None:
        """Move to the end of a stretch, and to the modes or piece of the drives that hold next.

        Parameters
        ----------
        t : float
            Time that the stretch reached [s].
        y : sequence of float (n,)
            State there [SI].
        guard : int, optional
            Index of the event that ended it; None if it reached `stop`.
        """
        stop = self.stop
        begins = guard is None and t >= stop
        self._w[layout.TIME] = stop if begins else float(t)
        self._put(y, layout.Y)
        self._ask(exchange.PLACE)
        self._ask(exchange.NOTE)
        if guard is not None:
            self._happen(exchange.FALLEN, guard)
        elif begins and stop < self.t_end:
            self._happen(exchange.JUMP)
        self._look()

    def _look(self) -> None:
        """Let everything happen that falls at once, and note the time."""
        self._t = float(self._w[layout.TIME])
        for _ in range(MOST_FALLS):
            if self.status is not None or not self._happen(exchange.LOOK):
                break
        else:
            raise SimulationError(
                f"the mode changed {MOST_FALLS} times at t = {self._t:g} s: run it with simulate,"
                " which says why."
            )
        self._w[layout.TIME], self._known = self._t, None

    def _happen(self, question: int, guard: int = 0) -> int:
        """Let something happen, and note what it changed."""
        whole, rows = self._whole, self._rows
        old = min(whole[layout.EVENTS], 1)
        rows[: old * layout.EVENT_COLUMNS] = rows[
            (whole[layout.EVENTS] - old) * layout.EVENT_COLUMNS :
        ][: old * layout.EVENT_COLUMNS]
        whole[layout.EVENTS] = old
        found = self._ask(question, guard)
        for row in range(old, whole[layout.EVENTS]):
            t, before, after, *_, contact = rows[row * layout.EVENT_COLUMNS :][
                : layout.EVENT_COLUMNS
            ]
            if before != after:
                change = (float(t), int(before), int(after))
                self.changes.append(
                    (*change, self.contacts[int(contact)]) if self.contacts else change
                )
        return found

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
        for _ in range(MOST_STRETCHES):
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
            modes.append(
                np.array([self.mode] * (len(found.t) - 1)).reshape(-1, *modes[0].shape[1:])
            )
            hit = [k for k, at in enumerate(found.t_events) if len(at)]
            self.go_on(found.t[-1], found.y[:, -1], hit[0] if hit else None)
            times.append(np.array([self.t]))
            states.append(self.y[None])
            modes.append(np.array([self.mode]))
        status = self.status
        if status is None:
            raise SimulationError(
                f"the mode changed {MOST_STRETCHES} times until t = {self.t:g} s: run it with"
                " simulate, which says why."
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
            contacts=self.contacts,
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
        What moves.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back, as in `simulate`.
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
