"""What a run gives back: states in time, events, how it ended, and how far to trust it."""

import enum
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.errors import InputError, UnknownNameError, check_size
from stickslip.show.described import Described
from stickslip.show.display import InPanels, OnAxes, Summary, require_library
from stickslip.show.formatting import number, quantity, residue

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

UNLOADED = 3
"""Mode of a contact that is open."""


class Status(enum.Enum):
    """How a run ended."""

    END_TIME = "Reached the end time."
    AT_REST = "Came to rest: no drive can move the body again."
    LIFT_OFF = "Lift-off: the normal force fell to zero."
    PAINLEVE = "Painlevé paradox: the rigid-body equations have no unique solution here."
    LIMIT = "The mechanism reached one of its limits."
    STEP_LIMIT = "Reached the maximum number of steps before the end time."
    STEP_TOO_SMALL = "The step size fell below rounding error: the equations are singular here."
    NOT_FINITE = "The state diverged: it is no longer finite."
    ZENO = "Zeno behaviour: events accumulate at one instant, and the run cannot be continued."
    CANCELLED = "The run was cancelled."

    @property
    def complete(self) -> bool:
        """Whether the run covers all the time asked for."""
        return self in (Status.END_TIME, Status.AT_REST)

    @property
    def label(self) -> str:
        """The first words, up to the colon or the full stop, as figures show them."""
        return self.value.partition(":")[0].rstrip(".")


@dataclass(frozen=True, kw_only=True)
class Event(metaclass=Described):
    """A change of what the contact or the mechanism does."""

    t: float
    """When [s]."""
    contact: str
    """Name of the contact, empty where there is only one."""
    from_mode: int
    """Before: 0 stick, 1 slip forward, -1 slip backward, 2 at the upper hard stop, -2 at the lower,
    3 without load."""
    to_mode: int
    """The same, after."""
    reason: str
    """What happened, in words."""
    margin: float
    """At a stop that friction makes: break-away level less the friction needed to stay [N]; else 0.
    """


@dataclass(frozen=True, kw_only=True)
class Certificate(metaclass=Described):
    """Evidence, gathered outside error control, that a run solves its equations.

    Errors, violations and residuals are relative to the size the quantity had in the run.
    """

    energy_error: float
    """Mismatch of energy, work supplied and work taken by friction and stops."""
    energy_start: float
    """Mechanical energy at the start [J]."""
    energy_end: float
    """Mechanical energy at the end [J]."""
    work_supplied: float
    """Work of drives, dampers and moved supports [J]."""
    work_friction: float
    """Work taken by friction [J]."""
    work_stops: float = 0.0
    """Work taken by impacts at hard stops [J]; one at the very start comes before the books."""
    guard_violation: float
    """Largest violation of a mode's conditions at the end of a step."""
    event_residual: float
    """Largest distance from its condition at which an event was located."""
    stick_drift: float
    """Largest movement while stuck [m]."""
    steps: int
    """Accepted steps."""
    rejected: int
    """Rejected steps."""
    error_estimate: float | None = None
    """Largest difference of a state to a run with half the tolerance, if that was asked for."""
    work: Mapping[str, float] = field(default_factory=dict)
    """Work taken by friction at each contact [J], where there are several."""
    decisions: int = 0
    """Instants at which several contacts were decided to hold or to slip together."""
    ambiguous: int = 0
    """Those of them at which the rigid model allows another answer."""
    indeterminate: tuple[tuple[str, ...], ...] = ()
    """Contacts that held together with more forces than the rigid model determines: the motion does
    not depend on how they share them, and that was told by a rule."""
    margins: Mapping[str, float] = field(default_factory=dict)
    """How near the run came to what would have ended it, by the name of the event: the least margin
    over the largest, 0 where it ended so. Empty where nothing of the kind can happen."""
    warnings: tuple[str, ...] = ()
    """What the run came near to, and the work of friction that drove it."""
    problems: tuple[str, ...] = ()
    """Why the run is not certified; empty if it is."""

    @property
    def certified(self) -> bool:
        """Whether every check passed."""
        return not self.problems


@dataclass(frozen=True)
class _Seen:
    """Gives the columns of one of several contacts, by the names that they have with one."""

    evaluate: Callable[["NDArray[np.float64]"], Mapping[str, "NDArray[np.float64]"]]
    """Gives all columns at an array of times."""
    columns: Mapping[str, str]
    """Names of the columns, by those that they have here."""

    def __call__(self, t: "NDArray[np.float64]") -> Mapping[str, "NDArray[np.float64]"]:
        result = self.evaluate(t)
        return {name: result[column] for name, column in self.columns.items()}


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Trajectory(InPanels):
    """A run: an array for each state, defined at any time between its start and its end.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> run.status.value
    'Came to rest: no drive can move the body again.'
    >>> [event.reason for event in run.events]
    ['block leaves the spring', 'stop']
    >>> run.at([0.1, 0.2])["x"].round(4)
    array([0.0347, 0.1069])
    """

    t: "NDArray[np.float64]"
    """Times (n,) [s]: the ends of the steps, or the times asked of `at`."""
    names: tuple[str, ...]
    """Names that ``run[name]`` knows."""
    units: Mapping[str, str]
    """SI unit of each name."""
    events: tuple[Event, ...]
    """Physical transitions in the order of time."""
    status: Status
    """How the run ended."""
    certificate: Certificate
    """How far to trust it."""
    span: tuple[float, float]
    """First and last time for which the run is defined."""
    evaluate: Callable[["NDArray[np.float64]"], Mapping[str, "NDArray[np.float64]"]] = field(
        repr=False
    )
    """Gives the columns at an array of times."""
    states: tuple[str, ...] = ()
    """Names of the states among the columns."""
    differentiate: (
        Callable[["NDArray[np.float64]", Sequence[str]], "NDArray[np.float64]"] | None
    ) = field(default=None, repr=False)
    """Gives the sensitivities (n, states, paths) at an array of times, where the solver can."""
    only_contact: str = ""
    """Name of the contact where there is one; empty if it has no name, or there are several."""
    cause: str = ""
    """Why the run ended early and what to do, in words, where more can be said than the status."""
    step_times: "NDArray[np.float64] | None" = field(default=None, repr=False)
    """Times (m,) [s] between which modes stay, of runs whose events are not located."""

    @property
    def ending(self) -> str:
        """How the run ended and why, in words."""
        if self.status is Status.AT_REST and not self.moves:
            return "It stayed at rest: no drive can move the body."
        return f"{self.status.value} {self.cause}".rstrip()

    @property
    def moves(self) -> bool:
        """Whether any state but at rest is left, or anything happens, between start and end."""
        if self.events or not self.states:
            return True
        first, last = self.evaluate(self.t[:1]), self.evaluate(self.t[-1:])
        return any(bool(first[name][0] != last[name][0]) for name in self.states)

    @cached_property
    def _columns(self) -> Mapping[str, "NDArray[np.float64]"]:
        return self.evaluate(self.t)

    def __getitem__(self, name: str) -> "NDArray[np.float64]":
        """Return a column (n,): a state, ``"friction"``, ``"normal_force"`` or ``"mode"``."""
        if name not in self.names:
            raise UnknownNameError("column", name, self.names)
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        """Yield the names of the columns, as a mapping does."""
        return iter(self.names)

    def __contains__(self, name: object) -> bool:
        """Whether there is a column of that name."""
        return name in self.names

    def at(self, t: "ArrayLike") -> "Trajectory":
        """Return the run at other times.

        Parameters
        ----------
        t : array_like (n,)
            Times [s] within `span`, in any order.

        Raises
        ------
        InputError
            If a time is no number, or lies outside the run.
        """
        try:
            times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        except (TypeError, ValueError):
            column = f"; the column is run[{t!r}]" if isinstance(t, str) and t in self.names else ""
            raise InputError(f"times must be numbers [s], got {t!r}{column}.") from None
        check_size("times of a run", times.size * len(self.names), "ask for fewer")
        first, last = self.span
        if times.size and not (times.min() >= first and times.max() <= last):
            raise InputError(
                f"times must lie between {number(first, 6)} and {number(last, 6)} s, the span of"
                f" this run, got {number(times.min(), 6)} to {number(times.max(), 6)} s."
            )
        return replace(self, t=times)

    def sensitivity(self, state: str, parameter: str) -> "NDArray[np.float64]":
        """Return how a state changes with a parameter or an initial state, at the times `t`.

        Exact derivatives of the solution, the moments of events included; where the state itself
        jumps in its derivative, at an event, that after it. NaN where there is no
        derivative, such as after two impacts at the same time.

        Parameters
        ----------
        state : str
            Name of a state, such as ``"x"``.
        parameter : str
            Path such as ``"friction.kinetic_coefficient"`` or ``"initial.x"``, or its last name or
            its symbol (``"mu_k"``) where only one has it.

        Returns
        -------
        array (n,)
            Derivative of the state with respect to the parameter, SI units over SI units.

        Raises
        ------
        InputError
            If the solver gives no sensitivities, or a name is unknown.
        UnknownNameError
            If the run has no state of that name.

        Examples
        --------
        >>> from stickslip import Coulomb, SpringBlock, simulate
        >>> from stickslip.mechanisms.drives import Pulse
        >>> block = SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))
        >>> run = simulate(block, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
        >>> float(run.at(1.0).sensitivity("x", "kinetic_coefficient")[0].round(9))
        -0.815494393
        """
        if self.differentiate is None:
            raise InputError("this run has no sensitivities: run it with solver=EventDriven().")
        if state not in self.states:
            raise UnknownNameError("state", state, self.states)
        result = self.differentiate(self.t, [parameter])
        return result[:, self.states.index(state), 0]

    def sampled(self, count: int = 400) -> "Trajectory":
        """Return the run at evenly spaced times, ends included."""
        check_size("samples of a run", count * len(self.names), "ask for fewer")
        return self.at(np.linspace(*self.span, count))

    @property
    def contacts(self) -> tuple[str, ...]:
        """Names of the contacts where there are several; empty where there is one."""
        first = "friction:"
        return tuple(name.removeprefix(first) for name in self.names if name.startswith(first))

    def contact(self, name: str) -> "Trajectory":
        """Return the run as one of several contacts sees it.

        Its columns ``"friction"``, ``"normal_force"`` and ``"mode"`` and its events are those of
        the contact, so that it can be used as a run with one contact. The states are the same. A
        run with one contact is its own view.

        Parameters
        ----------
        name : str
            Name of the contact.

        Returns
        -------
        Trajectory
            A view of this run.

        Raises
        ------
        UnknownNameError
            If there is no contact of that name.
        """
        if name == self.only_contact and not self.contacts:
            return self
        if name not in self.contacts:
            known = self.contacts or [key for key in (self.only_contact,) if key]
            raise UnknownNameError("contact", name, known)
        own = {f"{kind}:{name}": kind for kind in ("friction", "normal_force", "mode")}
        # States of bristles of other contacts stay, as states of the run.
        kept = [column for column in self.names if ":" not in column or column in own]
        kept += [z for z in self.states if ":" in z]
        seen = {own.get(column, column): column for column in kept}
        return replace(
            self,
            names=tuple(own.get(column, column) for column in kept),
            units={own.get(column, column): unit for column, unit in self.units.items()},
            events=tuple(event for event in self.events if event.contact == name),
            evaluate=_Seen(self.evaluate, seen),
            only_contact=name,
        )

    def stick_spans(self) -> list[tuple[float, float]]:
        """Return the stretches of time in which friction or a hard stop holds the body.

        Raises
        ------
        InputError
            If there are several contacts: ask one of them, as in
            ``run.contact("elbow").stick_spans()``.
        """
        if self.contacts:
            raise InputError(
                f"this run has several contacts ({', '.join(self.contacts)}): ask one of them, as"
                f" in run.contact({self.contacts[0]!r}).stick_spans()."
            )
        changes = self._modes()
        ends = [t for t, _ in changes[1:]] + [self.span[1]]
        spans: list[tuple[float, float]] = []
        for (start, mode), end in zip(changes, ends, strict=True):
            # 1 and -1 slip, and nothing holds what is not loaded.
            if abs(mode) in (1, UNLOADED) or end <= start:
                continue
            # Stretches that touch, as where one kind of holding follows another, are one.
            if spans and math.isclose(spans[-1][1], start, abs_tol=0.0):
                spans[-1] = (spans[-1][0], end)
            else:
                spans.append((start, end))
        return spans

    def stick_time(self) -> float:
        """Return how long friction or a hard stop holds the body [s], as `stick_spans` does."""
        return sum(end - start for start, end in self.stick_spans())

    def _modes(self) -> list[tuple[float, int]]:
        """Return the modes of the contact, each with the time from which it holds."""
        # Events that were not located say nothing between steps.
        if self.step_times is not None:
            modes = self.evaluate(self.step_times)["mode"].tolist()
            pairs = list(zip(self.step_times.tolist(), map(int, modes), strict=True))
            return pairs[:1] + [b for a, b in itertools.pairwise(pairs) if a[1] != b[1]]
        # Without events the run is in one mode throughout.
        first = self.events[0].from_mode if self.events else self.at(self.span[0])["mode"][0]
        return [(self.span[0], int(first)), *((event.t, event.to_mode) for event in self.events)]

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the columns as a pandas DataFrame with the time in front."""
        import pandas as pd

        # Adding 0 makes -0.0 a plain 0.
        return pd.DataFrame({"t": self.t, **{name: self[name] for name in self.names}}) + 0

    def to_xarray(self) -> "xr.Dataset":
        """Return the columns as an xarray Dataset over time, with units.

        Raises
        ------
        InputError
            If xarray is not installed.
        """
        require_library("xarray", "xarray", "use to_dataframe")
        import xarray as xr

        columns = {
            name: ("t", self[name], {"units": self.units.get(name, "1")}) for name in self.names
        }
        times = {"t": ("t", self.t, {"units": "s"})}
        return xr.Dataset(columns, times, {"status": self.status.value})

    def _count(self, contact: str) -> int:
        return sum(event.contact == contact for event in self.events)

    def _last_values(self) -> Iterator[tuple[str, str]]:
        """Yield the row of the values at the last time, if there is one; other times are named."""
        if len(self.t):
            at = "" if self.t[-1] == self.span[1] else f" at {number(self.t[-1], 6)} s"
            yield f"last values{at}", ", ".join(self._last(name) for name in self.states)

    def _last(self, name: str) -> str:
        return f"{name} = {quantity(float(self[name][-1]), self.units[name], 4)}"

    def _summary(self) -> Summary:
        rows = (
            ("time", f"{number(self.span[0], 6)} to {number(self.span[1], 6)} s"),
            ("columns", ", ".join(self.names)),
            *self._last_values(),
            ("events", len(self.events)),
            ("energy error", residue(self.certificate.energy_error)),
            ("certified", "yes" if self.certificate.certified else "no"),
            *(
                (name, f"{self._count(name)} events, {number(work, 3)} J taken by friction")
                for name, work in self.certificate.work.items()
            ),
        )
        notes = (*self.certificate.problems, *self.certificate.warnings)
        return Summary(sentence=self.ending, rows=rows, notes=notes)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Ensemble(OnAxes):
    """Many runs of one mechanism with one law: outputs, status and certificate, a row a run.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Coulomb, SpringBlock, ensemble
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> law = Coulomb(kinetic_coefficient=0.25)
    >>> levels = {"kinetic_coefficient": np.array([0.2, 0.25, 0.3])}
    >>> runs = ensemble(rig, law, levels, t_end=1.0)
    >>> runs["x"].round(4)
    array([0.2548, 0.2039, 0.1699])
    >>> runs.status[0].value
    'Came to rest: no drive can move the body again.'
    """

    outputs: Mapping[str, "NDArray[np.float64]"]
    """Numbers kept of each run: (n,), or (n, m) where an output has several."""
    parameters: Mapping[str, "NDArray[np.float64]"]
    """What was varied, an array (n,) by full path."""
    status: "NDArray[np.object_]"
    """How each run ended, a `Status` each (n,)."""
    certified: "NDArray[np.bool_]"
    """Whether each run passed every check of its certificate (n,)."""
    energy_error: "NDArray[np.float64]"
    """Mismatch of energy and work (n,), as in `Certificate`."""
    guard_violation: "NDArray[np.float64]"
    """Largest violation of a mode's conditions (n,)."""
    event_residual: "NDArray[np.float64]"
    """Largest distance from its condition at which an event was located (n,)."""
    steps: "NDArray[np.int64]"
    """Accepted steps (n,)."""
    units: Mapping[str, str]
    """SI unit of each output and of each path that was varied, ``"1"`` where it has none."""

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self.status)

    def __getitem__(self, name: str) -> "NDArray[np.float64]":
        """Return an output (n,) or (n, m)."""
        if name not in self.outputs:
            raise UnknownNameError("output", name, self.outputs)
        return self.outputs[name]

    def to_dataframe(self) -> "pd.DataFrame":
        """Return parameters, outputs, status and certificate, a row a run."""
        import pandas as pd

        columns: dict[str, Any] = dict(self.parameters)
        for name, values in self.outputs.items():
            if values.ndim == 1:
                columns[name] = values
            else:
                columns |= {f"{name}.{i}": values[:, i] for i in range(values.shape[1])}
        columns["status"] = [status.name for status in self.status]
        return pd.DataFrame(columns | {"certified": self.certified})

    def to_xarray(self) -> "xr.Dataset":
        """Return the same as an xarray Dataset over the runs, with units.

        Parameters are coordinates; an output with several numbers has a dimension of its own,
        ``"way_index"`` for ``"way"``.

        Raises
        ------
        InputError
            If xarray is not installed.
        """
        require_library("xarray", "xarray", "use to_dataframe")
        import xarray as xr

        of = {name: {"units": unit} for name, unit in self.units.items()}
        columns: dict[str, Any] = {
            name: (("run",) if values.ndim == 1 else ("run", f"{name}_index"), values, of[name])
            for name, values in self.outputs.items()
        }
        columns["status"] = ("run", [status.name for status in self.status])
        columns["certified"] = ("run", self.certified)
        coordinates = {path: ("run", v, of[path]) for path, v in self.parameters.items()}
        return xr.Dataset(columns, coordinates)

    def _summary(self) -> Summary:
        counts = {s: int((self.status == s).sum()) for s in Status}
        rows = [("runs", str(len(self))), ("outputs", ", ".join(self.outputs))]
        rows += [(status.value, str(count)) for status, count in counts.items() if count]
        rows.append(("certified", str(int(self.certified.sum()))))
        complete = sum(count for status, count in counts.items() if status.complete)
        return Summary(sentence=completed(complete, len(self)), rows=rows)


def completed(count: int, runs: int) -> str:
    """Return the sentence that says how many of several runs were completed."""
    return f"{count} of {runs} runs were completed."
