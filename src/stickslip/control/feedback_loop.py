"""Closes the loop: a controller that samples, computes and holds, around an exact simulation."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, Protocol

from typing_extensions import override

from stickslip.control.actuation import places_of
from stickslip.control.sampling import Commands, Sensors, Stretch, Timing, drive_of
from stickslip.display import InPanels, Summary
from stickslip.errors import InputError
from stickslip.formatting import number, quantity
from stickslip.friction import Friction
from stickslip.mechanisms import Mechanism
from stickslip.simulation import END, event_driven_law, initial_state, refuse
from stickslip.solver import EventDriven, IncrementalRun
from stickslip.tables import Tabular
from stickslip.trajectory import Status, Trajectory

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    from numpy.typing import NDArray

REPORTS = 100
"""Calls of a progress callback in a run."""


class Controller(Protocol):
    """Computes a command from what is measured.

    Any function will do; one that commands several drives returns a mapping. One that keeps a state
    has a ``reset()``, which is called before a run.
    """

    def __call__(self, t: float, measured: Mapping[str, float], /) -> float:
        """Return the command at a sample.

        Parameters
        ----------
        t : float
            Time of the sample [s].
        measured : mapping
            Coordinates and rates by name, as they are measured.
        """
        ...


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ClosedLoop(InPanels, Tabular):
    """A run in closed loop: the motion, and what the controller saw and said at each sample.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> law = Coulomb(kinetic_coefficient=1.0)
    >>> loop = closed_loop(
    ...     Axis(inertia=1.0),
    ...     law,
    ...     lambda t, seen: 100.0 * (0.1 - seen["x"]) - 10.0 * seen["v"],
    ...     period=1e-3,
    ...     t_end=2.0,
    ... )
    >>> loop.run.status.name, len(loop.t), bool(abs(loop.run["x"][-1] - 0.1) < 0.01)
    ('END_TIME', 2000, True)
    """

    run: Trajectory
    """The motion, certified as any run is."""
    mechanism: Mechanism
    """The mechanism with all commands as its drive: `simulate` makes the same run of it."""
    t: "NDArray[np.float64]"
    """Times of the samples (n,) [s]."""
    measured: Mapping[str, "NDArray[np.float64]"]
    """What the controller saw (n,), by state."""
    requested: "NDArray[np.float64]"
    """What it returned (n,), before limits; of m drives (n, m)."""
    commands: "NDArray[np.float64]"
    """The same in whole steps within the limit (n,) or (n, m): what acts, a delay later."""
    period: float
    """Time between samples [s]."""
    delay: float
    """Time from a sample to its command [s]."""
    drives: tuple[str, ...] = ()
    """Names of several drives (m,), in the order of columns of commands."""

    @property
    def status(self) -> Status:
        """How the run ended."""
        return self.run.status

    @override
    def to_dataframe(self) -> "pd.DataFrame":
        """Return what was measured, requested and commanded as a pandas DataFrame, a row a sample.

        `run` has the motion, with a ``to_dataframe`` of its own.
        """
        import pandas as pd

        seen = {f"measured_{name}": values for name, values in self.measured.items()}
        commands = {"requested": self.requested, "command": self.commands}
        if self.drives:
            commands = {
                f"{what}:{name}": values[:, i]
                for i, name in enumerate(self.drives)
                for what, values in commands.items()
            }
        return pd.DataFrame({"t": self.t, **seen, **commands})

    @override
    def _over(self) -> str:
        return "t"

    @override
    def _column_units(self) -> Mapping[str, str]:
        return {"t": "s", **{f"measured_{name}": self.run.units[name] for name in self.measured}}

    @override
    def _summary(self) -> Summary:
        rows = (
            ("time", f"{number(self.run.span[0], 6)} to {number(self.run.span[1], 6)} s"),
            ("samples", f"{len(self.t)}, one every {quantity(self.period, 's')}"),
            ("events", len(self.run.events)),
            ("certified", "yes" if self.run.certificate.certified else "no"),
        )
        return Summary(sentence=self.run.ending, rows=rows)


def closed_loop(
    mechanism: Mechanism,
    law: Friction,
    controller: Controller | Callable[[float, Mapping[str, float]], float | Mapping[str, float]],
    *,
    period: float,
    t_end: float,
    delay: float = 0.0,
    hold: Literal["zero", "first"] = "zero",
    drive: str | Sequence[str] | None = None,
    limit: float | None = None,
    step: float | None = None,
    y0: Mapping[str, float] | Sequence[float] | None = None,
    noise: Mapping[str, float] | None = None,
    quantisation: Mapping[str, float] | None = None,
    seed: int = 0,
    solver: EventDriven | None = None,
    progress: Callable[[int, int], object] | None = None,
    throw: bool = True,
) -> ClosedLoop:
    """Simulate a mechanism with friction under a controller that samples and holds.

    The mechanism is solved exactly between samples: it sticks, breaks away and stops when it does,
    not when the controller looks. The run is one run, not a chain of them, and has one certificate.

    Parameters
    ----------
    mechanism : Mechanism
        What moves. A drive that it has already in the place of the command stays and is added to
        it, as a disturbance.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back; laws by contact where there are several.
    controller : callable
        Called with the time and what is measured (coordinates and rates by name) at each sample;
        gives the command, or commands by the names in `drive` where that has several. Its
        ``reset()`` is called first, if it has one.
    period : float
        Time between samples [s]; the first is at time 0.
    t_end : float
        Last time [s].
    delay : float
        Time from a sample to the moment at which its command acts [s], any multiple or part of the
        period. Nothing is commanded before.
    hold : {"zero", "first"}
        Whether a command is held, or goes on along the line through it and the one before.
    drive : str or sequence of str, optional
        Path of the drive that is commanded, such as ``"pendulum.drive"``; not needed where the
        mechanism has one. A sequence names several, as the joints of an arm have.
    limit : float, optional
        Largest command, in the drive's unit; a larger one is cut. None if not given.
    step : float, optional
        Step of commands, in the drive's unit, such as the voltage of one count of a PWM; commands
        are rounded to it. None if they have none.
    y0 : mapping or sequence, optional
        Initial states, as in `simulate`.
    noise : mapping, optional
        Standard deviation of what is measured, by state.
    quantisation : mapping, optional
        Step of the sensor, by state.
    seed : int
        Of the noise.
    solver : EventDriven, optional
        Tolerances and tier.
    progress : callable, optional
        Called a hundred times with the number of samples done and of all; if it returns False, the
        run ends there and is `Status.CANCELLED`.
    throw : bool
        Raise if the run ends early or is not certified, as `simulate` does.

    Returns
    -------
    ClosedLoop
        The motion, the samples and the commands.

    Raises
    ------
    InputError
        If an argument cannot be used, or the controller gives no finite number.
    SimulationError
        If the run ends early or is not certified, and `throw` is true.

    Examples
    --------
    A proportional controller cannot move the axis out of its stiction:

    >>> from stickslip import Axis, Coulomb
    >>> loop = closed_loop(
    ...     Axis(inertia=1.0),
    ...     Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5),
    ...     lambda t, seen: 100.0 * (0.014 - seen["x"]),
    ...     period=1e-3,
    ...     t_end=1.0,
    ... )
    >>> float(loop.commands[-1].round(9)), float(loop.run["x"][-1])
    (1.4, 0.0)
    """
    solver = EventDriven() if solver is None else solver
    law = event_driven_law(mechanism, law)
    _check(controller, solver, hold, limit)
    timing = Timing(period=period, delay=delay, limit=limit, step=step)
    last = END.check("closed_loop", "t_end", t_end)
    names = (*mechanism.coordinates, *mechanism.rates)
    sensors = Sensors(names, noise=noise, quantisation=quantisation, seed=seed)
    samples = timing.times(last)
    places = places_of(mechanism, drive)
    commands = {name: Commands(timing, samples, hold, last) for name in places}
    driven, own = mechanism, []
    for place, command in zip(places.values(), commands.values(), strict=True):
        driven, name = place.commanded(driven, command.untold())
        own.append(name)
    start = initial_state("closed_loop", mechanism, law, y0)
    onward = IncrementalRun(driven, law, drives=own, y0=start, t_end=last, solver=solver)
    several = drive is not None and not isinstance(drive, str)
    walk = _Walk(onward, controller, sensors, commands, timing, several)
    book = walk.made([*samples, last], progress)
    driven = mechanism
    for name, place in places.items():
        driven, _ = place.commanded(driven, drive_of(hold, book.stretches[name], book.end))
    return _result(onward, driven, book, timing, names, tuple(places) if several else (), throw)


def _check(
    controller: object,
    solver: object,
    hold: str,
    limit: float | None,
) -> None:
    if not callable(controller):
        raise InputError(
            "controller must be callable with the time and the measured quantities, got"
            f" {controller!r}."
        )
    if not isinstance(solver, EventDriven) or solver.estimate_error:
        raise InputError(
            f"solver must be an EventDriven(...) without estimate_error, got {solver!r}."
        )
    if hold not in ("zero", "first"):
        raise InputError(f"hold must be 'zero' or 'first', got {hold!r}.")
    if hold == "first" and limit is not None:
        raise InputError(
            "hold='first' may exceed a limit between samples: set the motor's own limit, or"
            " hold='zero'."
        )


@dataclass
class _Book:
    """What happened at the samples."""

    t: list[float]
    measured: list[dict[str, float]]
    asked: list[list[float]]
    stretches: dict[str, list[Stretch]]
    """By drive."""
    end: float = 0.0
    """End of the last stretch [s]."""
    cancelled: bool = False


@dataclass
class _Walk:
    """What goes from sample to sample."""

    onward: IncrementalRun
    controller: Any
    sensors: Sensors
    commands: Mapping[str, Commands]
    """By drive."""
    timing: Timing
    several: bool
    """Whether drives were named in a sequence, so that commands come by name."""

    def made(self, times: Sequence[float], progress: Callable[[int, int], object] | None) -> _Book:
        """Go from sample to sample; `times` are theirs and the end."""
        getattr(self.controller, "reset", lambda: None)()
        book, count = _Book([], [], [], {name: [] for name in self.commands}), len(times) - 1
        every = max(count // REPORTS, 1)
        for k in range(count):
            t, end = times[k], times[k + 1]
            seen = self.sensors.read(self.onward.state())
            asked = self._asked(self.controller(t, seen), t)
            book.t.append(t)
            book.measured.append(seen)
            book.asked.append(asked)
            for command, value in zip(self.commands.values(), asked, strict=True):
                command.told.append(self.timing.within(value))
            if not self._onward(k, t, end, book):
                return book
            if progress is not None and ((k + 1) % every == 0 or k + 1 == count):
                book.cancelled = progress(k + 1, count) is False and k + 1 < count
                if book.cancelled:
                    break
        return book

    def _onward(self, k: int, t: float, end: float, book: _Book) -> bool:
        """Run from a sample to the next; return whether it was reached."""
        told = {name: one.stretches(k, t, end) for name, one in self.commands.items()}
        together = list(zip(*told.values(), strict=True))
        ends = [*[lines[0][0] for lines in together[1:]], end]
        for lines, until in zip(together, ends, strict=True):
            for name, line in zip(told, lines, strict=True):
                book.stretches[name].append(line)
            book.end = until
            if not self.onward.advance(until, [(value, slope) for _, value, slope in lines]):
                return False
        return True

    def _asked(self, command: Any, t: float) -> list[float]:
        """Return the numbers that the controller gave, in the order of drives."""
        if not self.several:
            return [_number(command, t)]
        names = list(self.commands)
        if not isinstance(command, Mapping) or set(command) != set(names):
            raise InputError(
                f"the controller must return commands by drive, {{{', '.join(map(repr, names))}}},"
                f" got {command!r} at t = {number(t, 6)} s."
            )
        return [_number(command[name], t) for name in names]


def _number(command: Any, t: float) -> float:
    try:
        value = float(command)
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise InputError(
            f"the controller must return a finite number, got {command!r} at t = {number(t, 6)} s."
        )
    return value


def _result(
    onward: IncrementalRun,
    driven: Mechanism,
    book: _Book,
    timing: Timing,
    names: Sequence[str],
    drives: tuple[str, ...],
    throw: bool,
) -> ClosedLoop:
    import numpy as np

    run = onward.finished(driven)
    if book.cancelled:
        run = replace(run, status=Status.CANCELLED)
    if throw:
        refuse(run)
    asked = np.array(book.asked)
    asked = asked if drives else asked[:, 0]
    commands = np.array([timing.within(value) for value in asked.flat]).reshape(asked.shape)
    return ClosedLoop(
        run=run,
        mechanism=driven,
        t=np.array(book.t),
        measured={name: np.array([seen[name] for seen in book.measured]) for name in names},
        requested=asked,
        commands=commands,
        period=timing.period,
        delay=timing.delay,
        drives=drives,
    )
