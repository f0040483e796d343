"""What an ensemble keeps of each of its runs."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from typing_extensions import TypeIs

from stickslip.engine.formulation import Model
from stickslip.engine.kernels import state_layout
from stickslip.errors import InputError, UnknownNameError
from stickslip.show.described import Described
from stickslip.show.formatting import number

Array: TypeAlias = NDArray[np.float64]
Number: TypeAlias = float | Sequence[float] | Array


@dataclass(frozen=True)
class Columns:
    """How kernels are asked for an output: a column each."""

    kind: int
    """What is kept, a code of `kernels.state_layout`."""
    subject: int
    """Index of the state, or code of what happened."""
    first: Array
    """From when on, or which event: (columns,) or (runs, columns)."""
    last: Array
    """Up to when, or at which contact, negative for any; of the same shape."""


class Output(ABC, metaclass=Described):
    """A number, or several, kept of each run."""

    @abstractmethod
    def columns(self, model: Model, t_end: float) -> Columns:
        """Return how kernels are asked for it.

        Parameters
        ----------
        model : Model
            The equations that are run, for the names of states and events.
        t_end : float
            Last time of each run [s].

        Returns
        -------
        Columns
            Kind, subject and arguments for the kernels.

        Raises
        ------
        InputError
            If a name is unknown, or a time is not within the run.
        """

    def is_single(self) -> bool:
        """Whether it is one number a run."""
        return True


def _state(model: Model, name: str) -> int:
    if name not in model.states:
        raise UnknownNameError("state in outputs", name, model.states)
    return model.states.index(name)


def _column(values: Number) -> Array:
    """Return numbers a run, or one number for all, as a column."""
    array = np.asarray(values, dtype=np.float64)
    if array.ndim > 1:
        raise InputError(
            f"an output takes a number, or one per run, got an array of {array.shape}."
        )
    return array.reshape(-1, 1) if array.ndim else array.reshape(1)


def _time(owner: str, name: str, values: Number, t_end: float) -> Array:
    array = _column(values)
    if not np.all((array >= 0.0) & (array <= t_end)):
        raise InputError(
            f"{owner}.{name} [s] must lie between 0 and t_end = {number(t_end, 6)} s, got"
            f" {number(array.min(), 6)} to {number(array.max(), 6)} s."
        )
    return array


@dataclass(frozen=True)
class Final(Output):
    """The value of a state at the end of the run.

    Examples
    --------
    >>> Final("x")
    Final(state='x')
    """

    state: str
    """Name of the state."""

    def columns(self, model: Model, t_end: float) -> Columns:
        none = np.zeros(1)
        return Columns(state_layout.FINAL, _state(model, self.state), none, none)


@dataclass(frozen=True)
class Max(Output):
    """The largest value of a state, also between steps.

    Parameters
    ----------
    state : str
        Name of the state.
    since : float or array (n,)
        From this time on [s].
    """

    state: str
    since: Number = 0.0

    def columns(self, model: Model, t_end: float) -> Columns:
        since = _time("Max", "since", self.since, t_end)
        return Columns(state_layout.GREATEST, _state(model, self.state), since, 0.0 * since)


@dataclass(frozen=True)
class Min(Output):
    """The smallest value of a state; parameters as in `Max`."""

    state: str
    """Name of the state."""
    since: Number = 0.0
    """From this time on [s]: a number or an array (n,)."""

    def columns(self, model: Model, t_end: float) -> Columns:
        since = _time("Min", "since", self.since, t_end)
        return Columns(state_layout.SMALLEST, _state(model, self.state), since, 0.0 * since)


@dataclass(frozen=True)
class Mean(Output):
    """The mean of a state over the last stretch of the run, such as its last cycles.

    Parameters
    ----------
    state : str
        Name of the state.
    last : float or array (n,), optional
        Length of the stretch [s]; all of the run if not given.
    """

    state: str
    last: Number | None = None

    def columns(self, model: Model, t_end: float) -> Columns:
        length = _time("Mean", "last", t_end if self.last is None else self.last, t_end)
        if not np.all(length > 0.0):
            raise InputError(f"Mean.last [s] must be above 0 s, got {number(length.min(), 6)} s.")
        since = t_end - length
        # Of the shape of `since`, which may have a number for each run.
        return Columns(state_layout.MEAN, _state(model, self.state), since, 0.0 * since + t_end)


@dataclass(frozen=True)
class Samples(Output):
    """A state at given times.

    Parameters
    ----------
    state : str
        Name of the state.
    times : sequence of float (m,), or array (n, m)
        Times [s], the same for all runs, or those of each. The result has the shape (n, m).
    """

    state: str
    times: Sequence[float] | Array

    def columns(self, model: Model, t_end: float) -> Columns:
        given = np.asarray(self.times, dtype=np.float64)
        times = _time("Samples", "times", given.ravel(), t_end).reshape(given.shape or -1)
        return Columns(state_layout.AT, _state(model, self.state), times, 0.0 * times)

    def is_single(self) -> bool:
        return False


@dataclass(frozen=True)
class EventTimes(Output):
    """When something happened for the first times; NaN where it did not.

    Parameters
    ----------
    reason : str
        What, as in `Event.reason`: ``"stop"``, ``"break-away"``, ...
    count : int
        How many times; from the last one backward if negative. The result has the shape
        (n, abs(count)).
    contact : str, optional
        At which of several contacts, by its name; at any of them if not given.
    """

    reason: str
    count: int = 1
    contact: str | None = None

    def columns(self, model: Model, t_end: float) -> Columns:
        if self.count == 0 or self.count != int(self.count):
            raise InputError(
                f"EventTimes.count must be a whole number other than 0, got {self.count!r}."
            )
        which = np.arange(self.count) if self.count > 0 else np.arange(-1, self.count - 1, -1)
        numbers = which.astype(np.float64)
        where = _contact(model, self.contact) + 0.0 * numbers
        return Columns(state_layout.EVENT_TIME, _reason(model, self.reason), numbers, where)

    def is_single(self) -> bool:
        return False


@dataclass(frozen=True)
class EventCount(Output):
    """How often something happened, by its `Event.reason`."""

    reason: str
    """What, as in `Event.reason`: ``"stop"``, ``"break-away"``, ..."""
    contact: str | None = None
    """At which of several contacts, by its name; at any of them if not given."""

    def columns(self, model: Model, t_end: float) -> Columns:
        where = np.full(1, _contact(model, self.contact))
        return Columns(state_layout.EVENT_COUNT, _reason(model, self.reason), np.zeros(1), where)


@dataclass(frozen=True)
class Sensitivity(Output):
    """How the last value of a state changes with a parameter or an initial state.

    Parameters
    ----------
    state : str
        Name of the state.
    parameter : str
        Path of the parameter, or its last name where only one has it.
    """

    state: str
    parameter: str

    def columns(self, model: Model, t_end: float) -> Columns:
        none = np.zeros(1)
        return Columns(state_layout.GRADIENT, _state(model, self.state), none, none)


def is_gradient(output: Output) -> TypeIs[Sensitivity]:
    """Whether an output is a sensitivity, which needs the slopes of the equations."""
    return isinstance(output, Sensitivity)


def output_unit(output: Output, units: Mapping[str, str]) -> str:
    """Return the SI unit of an output.

    Examples
    --------
    >>> units = {"x": "m", "friction.kinetic_coefficient": "1", "mechanism.stiffness": "N/m"}
    >>> output_unit(Sensitivity("x", "mechanism.stiffness"), units), output_unit(Max("x"), units)
    ('m/(N/m)', 'm')
    """
    match output:
        case EventTimes():
            return "s"
        case Sensitivity(state, parameter):
            over = units[parameter]
            several = f"({over})" if " " in over or "/" in over else over
            return units[state] if over == "1" else f"{units[state]}/{several}"
        case Final() | Max() | Min() | Mean() | Samples():
            return units[output.state]
    return "1"


def _reason(model: Model, reason: str) -> int:
    known = list(reasons(model))
    if reason not in known:
        raise UnknownNameError("reason of events", reason, [name for name in known if name])
    return known.index(reason)


def _contact(model: Model, name: str | None) -> float:
    """Return the index of a contact, -1 for any."""
    if name is None:
        return -1.0
    if not model.contacts:
        raise InputError(
            f"events are asked for at the contact {name!r}, but there is one contact: leave contact"
            " out."
        )
    if name not in model.contacts:
        raise UnknownNameError("contact of events", name, model.contacts)
    return float(model.contacts.index(name))


def reasons(model: Model) -> Sequence[str | None]:
    """Return the names of what happens, by their codes; None for what has no name."""
    pairs = [*model.switch_events, *(pair for own in model.law_switch_events for pair in own)]
    switched = [name for pair in pairs for name in pair or (None, None)]
    own = OF_CONTACTS if model.contacts else ()
    left = [name and name.replace("hits", "leaves") for name in model.impact_events if own]
    return [*REASONS, *own, *model.impact_events, *model.limits, *switched, *left]


REASONS = ("stop", "reversal", "break-away", "lift-off", "leaves stop")
OF_CONTACTS = ("opens", "closes")
"""What happens beside that where several contacts rub."""


def asked(
    outputs: Mapping[str, Output], model: Model, t_end: float, count: int
) -> tuple[Array, Array, dict[str, slice]]:
    """Return kinds and subjects, arguments with a row for all or a row a run, and their places."""
    kinds: list[float] = []
    arguments: list[Array] = []
    places: dict[str, slice] = {}
    for name, output in outputs.items():
        columns = output.columns(model, t_end)
        pair = np.stack([np.atleast_2d(columns.first), np.atleast_2d(columns.last)], axis=2)
        if len(pair) not in (1, count):
            raise InputError(f"output {name!r} has {len(pair)} numbers for {count} runs.")
        places[name] = slice(len(kinds) // 2, len(kinds) // 2 + pair.shape[1])
        kinds += [columns.kind, columns.subject] * pair.shape[1]
        arguments.append(pair)
    rows = max((len(pair) for pair in arguments), default=1)
    wide = [np.broadcast_to(pair, (rows, *pair.shape[1:])) for pair in arguments]
    flat = np.concatenate(wide, axis=1).reshape(rows, -1) if wide else np.zeros((1, 0))
    return np.array(kinds, dtype=np.float64), flat, places


def value_of(results: Array, place: slice, output: Output) -> Any:
    """Return an output's numbers (n,), or (n, m) where it has several a run."""
    result = results[:, place]
    return result[:, 0] if output.is_single() else result
