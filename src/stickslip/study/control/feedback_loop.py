"""The loop: a controller samples, computes and holds around an exact simulation; its cycles."""

import dataclasses
import itertools
import math
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    NamedTuple,
    Protocol,
    TypeAlias,
)

import numpy as np

from stickslip.engine.simulation import END, event_driven_law, initial_state, refuse
from stickslip.engine.solver import EventDriven, IncrementalRun
from stickslip.engine.trajectory import Status, Trajectory
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.friction import Friction, FrictionLaw, Viscous, bound, is_bound
from stickslip.mechanisms import Mechanism, slip_of, within_limit
from stickslip.mechanisms.drives import Drive, PiecewiseAffine, Profile, Sampled
from stickslip.quantities import Parametrised, Quantity
from stickslip.show.described import Described
from stickslip.show.display import InPanels, Summary, Tabular
from stickslip.show.formatting import number, quantity
from stickslip.study.tolerances import FEWEST_CYCLES, FINE, ROUNDING

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import ArrayLike, NDArray

# The equations of motion as numbers: in M q'' = h - W F + B u, the mass matrix M, the forces h, the
# directions W of friction and B of the drive are evaluated at a state.


# Where a mechanism takes the command of a controller.


class Place(NamedTuple):
    """A field, of a mechanism or of a part of it, that holds a drive."""

    path: tuple[str, ...]
    """Names of fields from the mechanism down, and numbers of parts where there are several."""

    @property
    def name(self) -> str:
        """The path as it is written."""
        return ".".join(self.path)

    def drive(self, mechanism: Mechanism) -> Drive | None:
        """Return the drive that a mechanism has there; None if there is none."""
        result: Drive | None = _got(mechanism, self.path)
        return result

    def driven(self, mechanism: Mechanism, drive: Drive) -> tuple[Mechanism, list[str]]:
        """Return a mechanism with a drive there, and the names by which it lists that."""
        new: Mechanism = _put(mechanism, self.path, drive)
        held = self.drive(new)
        return new, [name for name, other in new.drives().items() if other is held]

    def commanded(
        self, mechanism: Mechanism, command: Sampled | PiecewiseAffine
    ) -> tuple[Mechanism, str]:
        """Return a mechanism with a command there, and what it calls that drive.

        A drive that is there already stays, and the command is added to it.
        """
        before = self.drive(mechanism)
        driven, names = self.driven(mechanism, command if before is None else before + command)
        if not names:
            raise InputError(
                f"{type(mechanism).__name__}.{self.name} is not a drive that can be commanded:"
                f" drives() must list it (it lists {', '.join(driven.drives()) or 'none'})."
            )
        return driven, names[0]


def _got(root: Any, path: tuple[str, ...]) -> Any:
    for name in path:
        root = root[int(name)] if isinstance(root, tuple) else getattr(root, name)
    return root


def _put(root: Any, path: tuple[str, ...], drive: Drive) -> Any:
    if not path:
        return drive
    first, rest = path[0], path[1:]
    new = _put(_got(root, (first,)), rest, drive)
    if isinstance(root, tuple):  # one of several parts
        return tuple(new if str(i) == first else part for i, part in enumerate(root))
    return dataclasses.replace(root, **{first: new})


def drive_places(root: Parametrised, path: tuple[str, ...] = ()) -> Iterator[Place]:
    """Yield the fields of a mechanism and its parts that hold a drive, or may; no profiles.

    Examples
    --------
    >>> from stickslip import PendulumCart
    >>> cart = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3)
    >>> [place.name for place in drive_places(cart)]
    ['pendulum.drive', 'ground']
    """
    hints = typing.get_type_hints(type(root))
    for known in dataclasses.fields(root):
        value = getattr(root, known.name)
        here = (*path, known.name)
        if isinstance(value, Profile):
            continue  # what is imposed leaves nothing to command
        if isinstance(value, Drive) or (
            value is None and Drive in typing.get_args(hints[known.name])
        ):
            yield Place(here)
        elif isinstance(value, Parametrised):
            yield from drive_places(value, here)
        elif isinstance(value, tuple):
            for i, part in enumerate(value):
                if isinstance(part, Parametrised):
                    yield from drive_places(part, (*here, str(i)))


def place_of(mechanism: Mechanism, drive: str | None) -> Place:
    """Return the place of a drive by its name, or the only one.

    Examples
    --------
    >>> from stickslip import Axis, PendulumCart
    >>> place_of(Axis(inertia=1.0), None).name
    'drive'
    >>> place_of(PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3), "pendulum").name
    'pendulum.drive'
    """
    known = every_place(mechanism)
    kind = type(mechanism).__name__
    if drive is None:
        if len(known) > 1:
            raise InputError(f"{kind} has several drives: name one, drive={' or '.join(known)}.")
        return next(iter(known.values()))
    if drive in known:
        return known[drive]
    short = drive.removeprefix("mechanism.")
    result = [p for p in known.values() if short in (p.name, p.path[0], p.path[-1])]
    if len(result) != 1:
        raise UnknownNameError("drive", drive, known)
    return result[0]


def places_of(mechanism: Mechanism, drives: str | Sequence[str] | None) -> dict[str, Place]:
    """Return the places of drives by the names that were given; by path where none was.

    Examples
    --------
    >>> from stickslip import TwoLinkArm
    >>> arm = TwoLinkArm(
    ...     upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
    ...     lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03,
    ... )  # fmt: skip
    >>> list(places_of(arm, ("shoulder_drive", "elbow_drive")))
    ['shoulder_drive', 'elbow_drive']
    """
    if drives is None or isinstance(drives, str):
        place = place_of(mechanism, drives)
        return {place.name: place}
    result = {name: place_of(mechanism, name) for name in drives}
    if not result or len(set(result.values())) < len(drives):
        raise InputError(f"drive must name different drives, one or more, got {list(drives)!r}.")
    return result


def every_place(mechanism: Mechanism) -> dict[str, Place]:
    """Return all places at which a mechanism can be commanded, by their paths."""
    places = drive_places(mechanism)
    known = {place.name: place for place in places if place.path[0] not in mechanism.imposed}
    if not known:
        raise InputError(
            f"{type(mechanism).__name__} has no drive that a controller can command: give it a"
            " force or a torque (a prescribed motion cannot be commanded)."
        )
    return known


# The equations of motion of a mechanism as numbers: M, h, the directions of friction and drive.

TIME = Quantity("t", "s")


@dataclass(frozen=True, kw_only=True, eq=False)
class Dynamics(metaclass=Described):
    """A mechanism at one moment: ``M a = h - W F + B u`` and ``N = N_0 + N_F F + N_u u``.

    F is the friction force at the contact, u the command; all else that acts is in h and N_0. Of c
    contacts and d commands these are vectors, and their directions have columns for each.
    """

    coordinates: tuple[str, ...]
    """Names in the order of rows."""
    mass: "NDArray[np.float64]"
    """Mass matrix M (n, n)."""
    forces: "NDArray[np.float64]"
    """Forces h (n,), among them those of drives that are not commanded."""
    friction_direction: "NDArray[np.float64]"
    """W (n,), of several contacts (n, c): 1 at the coordinate that slips."""
    command_direction: "NDArray[np.float64]"
    """B (n,), of several commands (n, d); zeros where nothing is commanded."""
    normal: Any
    """Normal force N_0 without friction and command [N], of several contacts (c,)."""
    normal_by_friction: Any
    """N_F, of several contacts (c, c)."""
    normal_by_command: Any
    """N_u, of several contacts (c,) or (c, d)."""
    contacts: tuple[str, ...] = ()
    """Names of the contacts where there are several, in the order of columns."""
    drives: tuple[str, ...] = ()
    """Names of the commanded drives where there are several, in the order of columns."""

    def accelerations(
        self, friction: "ArrayLike" = 0.0, command: "ArrayLike" = 0.0
    ) -> "NDArray[np.float64]":
        """Return the accelerations (n,) under a friction force and a command.

        Parameters
        ----------
        friction : float or array (c,), default 0.0
            Friction force, with the sign of the slip velocity [N].
        command : float or array (d,), default 0.0
            Value of the commanded drive, in its unit.

        Returns
        -------
        array (n,)
            Accelerations of the free coordinates [unit of the coordinate / s^2].
        """
        right = (
            self.forces
            - _times(self.friction_direction, friction)
            + _times(self.command_direction, command)
        )
        return np.asarray(np.linalg.solve(self.mass, right))

    def normal_force(self, friction: "ArrayLike" = 0.0, command: "ArrayLike" = 0.0) -> Any:
        """Return the normal force under a friction force and a command [N].

        Parameters
        ----------
        friction : float or array (c,), default 0.0
            Friction force, with the sign of the slip velocity [N].
        command : float or array (d,), default 0.0
            Value of the commanded drive, in its unit.

        Returns
        -------
        float or array (c,)
            Normal force of the contact [N].
        """
        by_friction = _times(self.normal_by_friction, friction)
        by_command = _times(self.normal_by_command, command)
        total = np.asarray(self.normal + by_friction + by_command)
        return total if self.contacts else total.item()


def _times(direction: Any, amount: Any) -> Any:
    """Return what an amount does along a direction, or several along their columns."""
    if np.ndim(direction) < 2:
        return direction * np.asarray(amount)
    return np.asarray(direction) @ np.broadcast_to(amount, np.shape(direction)[-1:])


class Evaluator:
    """Evaluates the equations of a mechanism, affine in frictions and commands, by their parts."""

    def __init__(self, mechanism: Mechanism, places: Mapping[str, Place]) -> None:
        """Derive them, with the drives at these places commanded."""
        from stickslip.engine.formulation import contact_model
        from stickslip.engine.kernels.state_layout import NUMBERS
        from stickslip.engine.solver import Equations, gather

        if mechanism.guided():
            raise InputError(
                f"{type(mechanism).__name__} has a prescribed motion, whose effort is an output:"
                " give it a torque or a force instead."
            )
        drives = []
        for place in places.values():
            # A command of 0 makes room for commands among the drives' numbers.
            mechanism, name = place.commanded(mechanism, Sampled(times=(0.0,), values=(0.0,)))
            drives.append(name)
        self.mechanism = mechanism
        law = Viscous(viscous_coefficient=0.0)  # friction is given; any law will do
        self.model = model = contact_model(mechanism, law)
        self.equations = Equations(model, gather(mechanism, law, model, 0.0))
        self.places = [NUMBERS + 3 * model.drives.index(name) for name in drives]

    def at(
        self, t: float, state: Sequence[float], contact: int = -1, drive: int = -1
    ) -> tuple[Any, Any]:
        """Return forces and loads with a unit of friction at a contact, or of a drive."""
        from stickslip.engine.kernels import state_layout as at
        from stickslip.engine.kernels.contacts.assembly import factorise, prepare, put_mass, react
        from stickslip.engine.kernels.contacts.transitions import set_own_flags
        from stickslip.engine.kernels.equations import FORCES, LOADS, evaluate, turn_states
        from stickslip.engine.kernels.state_layout import FORWARD

        equations, w, iw = self.equations, self.equations.w, self.equations.iw
        n, count, first = iw[at.N_COORDINATES], iw[at.N_CONTACTS], iw[at.Y]
        equations.load_at(t)
        if drive >= 0:
            w[self.places[drive]] += 1.0
        w[first : first + 2 * n], w[at.TIME] = state, t
        # Twice: first what turns states, then what depends on the turned state.
        prepare(t, w, iw)
        turn_states(first, 0, w, iw)
        set_own_flags(0, w, iw)
        # All slip: friction is given, and nothing holds.
        for i in range(iw[at.N_DIRECTIONS]):
            iw[iw[at.MODES] + i] = FORWARD
        prepare(t, w, iw)
        put_mass(t, w, iw, first)
        factorise(w, iw)
        evaluate(FORCES, 0, iw[at.FLAGS], t, w, first, iw[at.FORCE])
        evaluate(LOADS, 0, iw[at.FLAGS], t, w, first, iw[at.LOAD])
        # A given friction, whatever the loads are.
        for c in range(count):
            w[iw[at.FRICTION_CONSTANT] + c] = 1.0 if c == contact else 0.0
            w[iw[at.FRICTION_FACTOR] + c] = 0.0
        if iw[at.N_REACTIONS] > 0:
            react(w, iw)
        forces, load = iw[at.FORCE], iw[at.LOAD]
        return np.array(w[forces : forces + n]), np.array(w[load : load + count])

    def __call__(self, t: float, state: Sequence[float]) -> dict[str, Any]:
        """Return the numbers of `Dynamics` in coordinates of the mechanism."""
        from stickslip.engine.kernels import state_layout as at
        from stickslip.engine.kernels.equations import factor_of

        h, loads = self.at(t, state)
        w, iw = self.equations.w, self.equations.iw
        n, count = iw[at.N_COORDINATES], iw[at.N_CONTACTS]

        def matrix(place: int) -> Any:
            return np.array(w[place : place + n * n]).reshape(n, n)

        mass = matrix(iw[at.MASS])
        turn = matrix(iw[at.TURN]) if iw[at.IS_TURNED] else np.eye(n)
        slips = np.zeros((n, count))
        for c in range(count):
            for j in range(n):
                along = factor_of(iw[iw[at.SLIPS] + c], j, w, iw)
                slips[j, c] = along * w[iw[at.SLIP_FACTORS] + c]
        frictions = [self.at(t, state, contact=c)[1] - loads for c in range(count)]
        commands = [self.at(t, state, drive=d) for d in range(len(self.places))]
        # Back in coordinates of the mechanism: T^T M T and T^T h.
        return {
            "coordinates": self.mechanism.coordinates,
            "mass": turn.T @ mass @ turn,
            "forces": turn.T @ h,
            "friction_direction": turn.T @ slips,
            "command_direction": np.column_stack([turn.T @ (item - h) for item, _ in commands]),
            "normal": loads,
            "normal_by_friction": np.column_stack(frictions),
            "normal_by_command": np.column_stack([normal - loads for _, normal in commands]),
            "contacts": self.model.contacts,
        }


def _states(given: Mapping[str, float], names: Sequence[str]) -> list[float]:
    for name in given:
        if name not in names:
            raise UnknownNameError("state", name, names)
    return [float(given.get(name, 0.0)) for name in names]


def dynamics_at(
    mechanism: Mechanism,
    t: float = 0.0,
    q: Mapping[str, float] | None = None,
    q_dot: Mapping[str, float] | None = None,
    *,
    drive: str | Sequence[str] | None = None,
) -> Dynamics:
    """Return mass matrix, forces and normal force of a mechanism at a state.

    Parameters
    ----------
    mechanism : Mechanism
        What moves, without prescribed motions.
    t : float
        Time [s], for drives and moved supports.
    q : mapping, optional
        Coordinates by name; 0 where not given.
    q_dot : mapping, optional
        Their rates, by the names of the rates.
    drive : str or sequence of str, optional
        What is commanded, as in `closed_loop`. Of a mechanism with several contacts, all drives
        that can be if not given.

    Returns
    -------
    Dynamics
        The numbers, by which laws of control are written.

    Raises
    ------
    InputError
        If the mechanism has a prescribed motion or nothing to command.

    Examples
    --------
    >>> from stickslip import PendulumCart
    >>> cart = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3)
    >>> here = dynamics_at(cart, q={"theta": 0.0})
    >>> here.mass.round(12)
    array([[ 0.6  , -0.03 ],
           [-0.03 ,  0.009]])
    >>> round(here.normal_force(), 9)
    5.886
    """
    t = TIME.check("dynamics_at", "t", t)
    several = len(mechanism.contacts()) > 1
    every = several and drive is None
    places = every_place(mechanism) if every else places_of(mechanism, drive)
    evaluator = Evaluator(mechanism, places)
    state = _states(q or {}, mechanism.coordinates) + _states(q_dot or {}, mechanism.rates)
    result = evaluator(t, state)
    single = not every and (drive is None or isinstance(drive, str))
    if single:
        for name in ("command_direction", "normal_by_command"):
            result[name] = result[name][:, 0]
    if not several:
        result["friction_direction"] = result["friction_direction"][:, 0]
        result["normal"] = float(result["normal"][0])
        result["normal_by_friction"] = float(result["normal_by_friction"][0, 0])
        by_command = result["normal_by_command"][0]
        result["normal_by_command"] = float(by_command) if single else by_command
        result["contacts"] = ()
    return Dynamics(**result, drives=() if single else tuple(places))


# Closes the loop: a controller that samples, computes and holds, around an exact simulation.

Stretch: TypeAlias = tuple[float, float, float]
"""Start of a stretch of constant or straight command [s], its value there, its slope."""
SPREAD = Quantity("sigma", low=0)
STEP = Quantity("q", above=0)
REPORTS = 100
"""Calls of a progress callback in a run."""


@dataclass(frozen=True, kw_only=True)
class Timing(Parametrised):
    """Settings of a loop, checked."""

    period: Annotated[float, Quantity("T_s", "s", above=0)]
    """Time between samples [s]."""
    delay: Annotated[float, Quantity("tau", "s", low=0)] = 0.0
    """Time from a sample to the moment at which its command takes effect [s]."""
    limit: Annotated[float, Quantity("u_max", above=0)] | None = None
    """Largest magnitude of a command, in its unit; None if there is none."""
    step: Annotated[float, Quantity("u_q", above=0)] | None = None
    """Step of commands, in their unit; None if they have none."""

    def times(self, t_end: float) -> list[float]:
        """Return the times of the samples before the end."""
        # Rounding of the end must not add a sample there.
        return [k * self.period for k in range(math.ceil(t_end / self.period - ROUNDING))]

    def lag(self) -> tuple[int, float]:
        """Return the delay as whole periods and a rest [s]."""
        iw = round(self.delay / self.period)
        if abs(self.delay - iw * self.period) <= ROUNDING * self.period:
            return iw, 0.0
        iw = math.floor(self.delay / self.period)
        return iw, self.delay - iw * self.period

    def within(self, command: float) -> float:
        """Return a command in whole steps, within the limit."""
        if self.step is not None:
            command = self.step * round(command / self.step)
        if self.limit is None:
            return command
        return min(max(command, -self.limit), self.limit)


class Commands:
    """Commands as they take effect: after the delay, and held."""

    def __init__(self, timing: Timing, samples: Sequence[float], hold: str, t_end: float) -> None:
        """Take the times of the samples."""
        self.periods, self.rest = timing.lag()
        self.period, self.hold = timing.period, hold
        self.issued: list[float] = []
        # Pieces of the drive begin at samples, and where commands act that are late by part of a
        # period.
        ends = [*samples[1:], t_end]
        middle = [t + self.rest for t in samples if self.rest > 0.0]
        inner = [t for t, end in zip(middle, ends, strict=False) if t < end]
        self._breaks, self._end = sorted([*samples, *inner]), t_end

    def zeros(self) -> Sampled | PiecewiseAffine:
        """Return the drive before anything is commanded: zeros, piece by piece."""
        return drive_of(self.hold, [(t, 0.0, 0.0) for t in self._breaks], self._end)

    def _line(self, index: int) -> tuple[float, float]:
        """Return value and slope of a command at its own start; nothing acts before the first."""
        if index < 0:
            return 0.0, 0.0
        now = self.issued[index]
        if self.hold == "zero" or index == 0:
            return now, 0.0
        return now, (now - self.issued[index - 1]) / self.period

    def stretches(self, index: int, start: float, end: float) -> list[Stretch]:
        """Return what acts from a sample to the next, in one stretch or two."""
        value, slope = self._line(index - self.periods)
        if self.rest <= 0.0:
            return [(start, value, slope)]
        # The command before goes on until the new one acts.
        old, steep = self._line(index - self.periods - 1)
        first = (start, old + steep * (self.period - self.rest), steep)
        middle = start + self.rest
        return [first, (middle, value, slope)] if middle < end else [first]


def drive_of(hold: str, stretches: Sequence[Stretch], end: float) -> Sampled | PiecewiseAffine:
    """Return commands as a drive; a line ends, at the end at the latest, and its value is held."""
    if hold == "zero":
        times, values, _ = (tuple(column) for column in zip(*stretches, strict=True))
        return Sampled(times=times, values=values)
    start, value, slope = stretches[-1]
    lines = [*stretches, (end, value + slope * (end - start), 0.0)]
    times, values, slopes = (tuple(column) for column in zip(*lines, strict=True))
    return PiecewiseAffine(times=times, values=values, slopes=slopes)


class Sensors:
    """Reads states as a controller gets them: noise first, then quantisation.

    Examples
    --------
    >>> sensors = Sensors(("x", "v"), quantisation={"x": 0.01})
    >>> sensors.read([0.123, 0.456])
    {'x': 0.12, 'v': 0.456}
    """

    def __init__(
        self,
        names: Sequence[str],
        *,
        noise: Mapping[str, float] | None = None,
        quantisation: Mapping[str, float] | None = None,
        seed: int = 0,
    ) -> None:
        """Take the names of what is measured."""
        self.names = tuple(names)
        self._noise = self._checked("noise", noise or {}, SPREAD)
        self._steps = self._checked("quantisation", quantisation or {}, STEP)
        self._random = np.random.default_rng(seed)

    def _checked(
        self, what: str, given: Mapping[str, float], quantity: Quantity
    ) -> dict[str, float]:
        for name in given:
            if name not in self.names:
                raise UnknownNameError(f"state in {what}", name, self.names)
        return {k: quantity.check("closed_loop", f"{what}[{k!r}]", v) for k, v in given.items()}

    def read(self, state: Sequence[float]) -> dict[str, float]:
        """Return what is measured of a state, by name."""
        result = dict(zip(self.names, state, strict=False))  # bristles are seen by nobody
        for name, spread in self._noise.items():
            result[name] += spread * float(self._random.standard_normal())
        for name, step in self._steps.items():
            result[name] = step * round(result[name] / step)
        return result


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

    def _over(self) -> str:
        return "t"

    def _column_units(self) -> Mapping[str, str]:
        return {"t": "s", **{f"measured_{name}": self.run.units[name] for name in self.measured}}

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
    driven, listed = mechanism, []
    for place, command in zip(places.values(), commands.values(), strict=True):
        driven, name = place.commanded(driven, command.zeros())
        listed.append(name)
    start = initial_state("closed_loop", mechanism, law, y0)
    onward = IncrementalRun(driven, law, drives=listed, y0=start, t_end=last, solver=solver)
    several = drive is not None and not isinstance(drive, str)
    walk = _Walk(onward, controller, sensors, commands, timing, several)
    walk.go([*samples, last], progress)
    # Once more with all that was commanded: `simulate` makes the same run of it.
    driven = mechanism
    for name, place in places.items():
        driven, _ = place.commanded(driven, drive_of(hold, walk.stretches[name], walk.end))
    drives = tuple(places) if several else ()
    run = onward.finished(driven)
    if walk.cancelled:
        run = replace(run, status=Status.CANCELLED)
    if throw:
        refuse(run)
    requested = np.array(walk.requested)
    requested = requested if drives else requested[:, 0]
    limited = np.array([timing.within(value) for value in requested.flat]).reshape(requested.shape)
    return ClosedLoop(
        run=run,
        mechanism=driven,
        t=np.array(walk.t),
        measured={name: np.array([seen[name] for seen in walk.measured]) for name in names},
        requested=requested,
        commands=limited,
        period=timing.period,
        delay=timing.delay,
        drives=drives,
    )


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
class _Walk:
    """What goes from sample to sample, and what happened there."""

    onward: IncrementalRun
    controller: Any
    sensors: Sensors
    commands: Mapping[str, Commands]
    """By drive."""
    timing: Timing
    several: bool
    """Whether drives were named in a sequence, so that commands come by name."""
    t: list[float] = field(default_factory=list)
    measured: list[dict[str, float]] = field(default_factory=list)
    requested: list[list[float]] = field(default_factory=list)
    end: float = 0.0
    """End of the last stretch [s]."""
    cancelled: bool = False

    def __post_init__(self) -> None:
        """Begin with no stretches of commands, by drive."""
        self.stretches: dict[str, list[Stretch]] = {name: [] for name in self.commands}

    def go(self, times: Sequence[float], progress: Callable[[int, int], object] | None) -> None:
        """Go from sample to sample; `times` are theirs and the end."""
        getattr(self.controller, "reset", lambda: None)()
        count = len(times) - 1
        every = max(count // REPORTS, 1)
        for k, (t, end) in enumerate(itertools.pairwise(times)):
            seen = self.sensors.read(self.onward.state())
            request = self._request(self.controller(t, seen), t)
            self.t.append(t)
            self.measured.append(seen)
            self.requested.append(request)
            for command, value in zip(self.commands.values(), request, strict=True):
                command.issued.append(self.timing.within(value))
            if not self._onward(k, t, end):
                return
            if progress is not None and ((k + 1) % every == 0 or k + 1 == count):
                self.cancelled = progress(k + 1, count) is False and k + 1 < count
                if self.cancelled:
                    return

    def _onward(self, k: int, t: float, end: float) -> bool:
        """Run from a sample to the next; return whether it was reached."""
        pieces = {name: command.stretches(k, t, end) for name, command in self.commands.items()}
        together = list(zip(*pieces.values(), strict=True))
        ends = [*[lines[0][0] for lines in together[1:]], end]
        for lines, self.end in zip(together, ends, strict=True):
            for name, line in zip(pieces, lines, strict=True):
                self.stretches[name].append(line)
            if not self.onward.advance(self.end, [(value, slope) for _, value, slope in lines]):
                return False
        return True

    def _request(self, command: Any, t: float) -> list[float]:
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


# Limit cycles: whether a run repeats itself, how far it swings and how often.

Kind: TypeAlias = Literal["limit cycle", "growing", "decaying", "irregular", "none"]

TOLERANCE = Quantity("eps", above=0, high=1)


@dataclass(frozen=True, kw_only=True)
class LimitCycle(metaclass=Described):
    """What a run does after its beginning.

    Numbers are those of the median cycle, and NaN where there are too few cycles.
    """

    kind: Kind
    """Whether cycles are alike, grow, decay, or differ without order; ``"none"`` if there are less
    than three."""
    amplitude: float
    """Half of the distance of the extremes, in the state's unit."""
    period: float
    """Time of a cycle [s]."""
    centre: float
    """Mean of the extremes."""
    amplitude_spread: float
    """Largest less smallest amplitude of a cycle, over the median."""
    period_spread: float
    """The same of periods."""
    cycles: int
    """Whole cycles seen."""
    stuck: float
    """Share of time in which friction or a stop holds the body."""

    @property
    def is_limit_cycle(self) -> bool:
        """Whether it is a limit cycle."""
        return self.kind == "limit cycle"


def limit_cycle(
    run: Trajectory | ClosedLoop,
    state: str = "x",
    *,
    since: float | None = None,
    tolerance: float = 0.02,
    least: float = 0.0,
) -> LimitCycle:
    """Look for a limit cycle in a run.

    A cycle is from one upward crossing of the middle to the next; a crossing counts if the state
    goes on by a tenth of its range on either side.

    Parameters
    ----------
    run : Trajectory or ClosedLoop
        The run; of several contacts, as one of them sees it (`Trajectory.contact`).
    state : str
        A column of the run.
    since : float, optional
        When to begin to look [s]; half-way if not given.
    tolerance : float
        Spread of amplitudes and periods, over their medians, up to which cycles are alike.
    least : float
        Amplitude below which a motion counts as none, in the state's unit.

    Returns
    -------
    LimitCycle
        Kind, amplitude, period.

    Raises
    ------
    InputError
        If `since` or `tolerance` is out of its range, or the run has several contacts.
    UnknownNameError
        If the run has no column of that name.

    Examples
    --------
    >>> from stickslip import Coulomb, TowedBlock, simulate
    >>> block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> cycle = limit_cycle(simulate(block, law, t_end=80.0), "v")
    >>> cycle.kind, round(cycle.period, 4), round(cycle.stuck, 3)
    ('limit cycle', 7.6113, 0.657)
    """
    run = run.run if isinstance(run, ClosedLoop) else run
    if run.contacts:
        raise InputError(
            f"limit_cycle: this run has several contacts ({', '.join(run.contacts)}): give it as"
            f" one of them sees it, such as run.contact({run.contacts[0]!r})."
        )
    tolerance = TOLERANCE.check("limit_cycle", "tolerance", tolerance)
    if state not in run.names:
        raise UnknownNameError("column", state, run.names)
    first, last = run.span
    begin = 0.5 * (first + last) if since is None else float(since)
    if not first <= begin < last:
        raise InputError(
            f"limit_cycle: since must lie between {number(first, 6)} and {number(last, 6)} s, got"
            f" {number(begin, 6)}."
        )
    # Ends of steps too: fast extremes lie between even times.
    times = np.union1d(
        np.linspace(begin, last, 5 * FINE), run.t[(run.t >= begin) & (run.t <= last)]
    )
    values = run.at(times)[state]
    starts = _crossings(times, values)
    if len(starts) <= FEWEST_CYCLES or 0.5 * float(np.ptp(values)) < least:
        return _described("none", np.empty((0, 3)), run, (begin, last))
    edges = np.searchsorted(times, starts)
    parts = [values[a:b] for a, b in itertools.pairwise(edges)]
    rows = [
        (0.5 * (part.max() - part.min()), period, 0.5 * (part.max() + part.min()))
        for part, period in zip(parts, np.diff(starts), strict=True)
    ]
    cycles = np.array(rows)
    return _described(_kind(cycles, tolerance), cycles, run, (starts[0], starts[-1]))


def _crossings(t: Any, x: Any) -> Any:
    """Return the times of upward crossings of the middle, small ones left out."""
    # With hysteresis: a side is known only beyond a tenth of the range from the middle.
    middle, reach = 0.5 * (x.max() + x.min()), 0.1 * np.ptp(x)
    side = np.where(x > middle + reach, 1, np.where(x < middle - reach, -1, 0))
    sided = np.flatnonzero(side)
    ups = [k for k in range(1, len(sided)) if side[sided[k]] > 0 > side[sided[k - 1]]]
    result = []
    for k in ups:
        a, b = sided[k - 1], sided[k]
        # The first sample above the middle, and a straight line from the one before.
        i = a + int(np.flatnonzero(x[a + 1 : b + 1] > middle)[0])
        result.append(t[i] + (t[i + 1] - t[i]) * (middle - x[i]) / (x[i + 1] - x[i]))
    return np.array(result)


def _spread(values: Any) -> float:
    return float(np.ptp(values) / np.median(values))


def _kind(cycles: Any, tolerance: float) -> Kind:
    """Return what a series of cycles (n, 3) is."""
    amplitudes = cycles[:, 0]
    if max(_spread(amplitudes), _spread(cycles[:, 1])) <= tolerance:
        return "limit cycle"
    changes = np.diff(amplitudes)
    if _spread(amplitudes) > tolerance and (changes > 0.0).all():
        return "growing"
    if _spread(amplitudes) > tolerance and (changes < 0.0).all():
        return "decaying"
    return "irregular"


def _described(kind: Kind, cycles: Any, run: Trajectory, span: tuple[float, float]) -> LimitCycle:
    """Put the numbers of cycles (n, 3) together."""
    first, last = span
    held = [max(min(b, last) - max(a, first), 0.0) for a, b in run.stick_spans()]
    amplitude, period, centre = np.median(cycles, axis=0) if len(cycles) else (np.nan,) * 3
    return LimitCycle(
        kind=kind,
        amplitude=float(amplitude),
        period=float(period),
        centre=float(centre),
        amplitude_spread=_spread(cycles[:, 0]) if len(cycles) else np.nan,
        period_spread=_spread(cycles[:, 1]) if len(cycles) else np.nan,
        cycles=len(cycles),
        stuck=float(sum(held) / (last - first)),
    )


# Controllers: PID, compensation of friction, and partial feedback linearisation.

# PID control with a bounded integral part.

Signal: TypeAlias = float | Callable[[float], float]
"""A number, or a function of time."""


def value_at(signal: Signal, t: float) -> float:
    """Return the value of a number or a function of time.

    Examples
    --------
    >>> value_at(2.0, 0.5), value_at(lambda t: 2.0 * t, 0.5)
    (2.0, 1.0)
    """
    return float(signal(t)) if callable(signal) else float(signal)


@dataclass
class _PidMemory:
    """What a controller remembers from one sample to the next."""

    t: float | None = None
    place: float = 0.0
    speed: float = 0.0
    integral: float = 0.0


@dataclass(frozen=True, kw_only=True)
class PID(Parametrised):
    """Proportional, integral and derivative action on a measured coordinate.

    ``u = K_p e + K_i * integral(e) + K_d (r' - v) + feedforward``, with ``e = r - x``. The integral
    is the sum of the errors at the samples, times the time since the sample before. Where the
    command is at its limit, the integral does not grow further beyond it (conditional integration),
    or is led back with a time constant (back-calculation).

    Settings are frozen as everywhere; what changes from sample to sample is kept beside them, and
    forgotten by `reset`.

    Examples
    --------
    >>> pid = PID(proportional=10.0, integral=2.0, reference=0.5)
    >>> pid(0.0, {"x": 0.1, "v": 0.0}), round(pid(0.1, {"x": 0.1, "v": 0.0}), 12)
    (4.0, 4.08)
    """

    proportional: Annotated[float, Quantity("K_p")]
    """Command per error."""
    integral: Annotated[float, Quantity("K_i")] = 0.0
    """Command per error and second."""
    derivative: Annotated[float, Quantity("K_d")] = 0.0
    """Command per error's rate."""
    reference: Signal = 0.0
    """Where to be, a number or a function of time."""
    reference_rate: Signal = 0.0
    """Its rate."""
    state: str = "x"
    """The coordinate that is controlled."""
    rate: str | None = "v"
    """Its measured rate; None if it is not measured but estimated from the coordinate."""
    filter_time: Annotated[float, Quantity("T_f", "s", low=0)] = 0.0
    """Time constant that smooths an estimated rate."""
    limit: Annotated[float, Quantity("u_max", above=0)] | None = None
    """Largest command; the integral part knows it, unlike that of `closed_loop`."""
    tracking_time: Annotated[float, Quantity("T_t", "s", above=0)] | None = None
    """Time constant of back-calculation; conditional integration if not given."""
    feedforward: Controller | None = None
    """What is added before the limit, such as a compensation of friction."""
    _memory: _PidMemory = field(default_factory=_PidMemory, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.tracking_time is not None and self.limit is None:
            raise ParameterError(
                "PID.tracking_time (T_t) sets the anti-windup at a limit: give limit too."
            )
        if self.feedforward is not None and not callable(self.feedforward):
            raise ParameterError(
                f"PID.feedforward must be callable like a controller, got {self.feedforward!r}."
            )

    def reset(self) -> None:
        """Forget all samples."""
        object.__setattr__(self, "_memory", _PidMemory())
        getattr(self.feedforward, "reset", lambda: None)()

    def __call__(self, t: float, measured: Mapping[str, float]) -> float:
        """Return the command at a sample."""
        memory = self._memory
        since = 0.0 if memory.t is None else t - memory.t
        place = _seen("PID", measured, self.state)
        speed = self._speed(measured, place, since)
        error = value_at(self.reference, t) - place
        command = self.proportional * error
        command += self.derivative * (value_at(self.reference_rate, t) - speed)
        if self.feedforward is not None:
            command += self.feedforward(t, measured)
        # The integral part is added within the limit, so that it does not wind up there.
        result, integral = self._integrated(command, error, since)
        memory.t, memory.place, memory.speed, memory.integral = t, place, speed, integral
        return result

    def _speed(self, measured: Mapping[str, float], place: float, since: float) -> float:
        """Return the measured rate, or an estimate."""
        if self.rate is not None:
            return _seen("PID", measured, self.rate)
        # One sample tells no rate.
        if since <= 0.0:
            return 0.0
        raw = (place - self._memory.place) / since
        # A first-order low pass, discretised backwards: stable whatever the interval is.
        share = since / (self.filter_time + since)
        return self._memory.speed + share * (raw - self._memory.speed)

    def _integrated(self, command: float, error: float, since: float) -> tuple[float, float]:
        """Return the whole command within the limit, and the integral part to remember."""
        before = self._memory.integral
        grown = before + self.integral * error * since
        limit = math.inf if self.limit is None else self.limit
        result, integral = within_limit(command, before, grown, limit)
        if self.tracking_time is not None:
            share = min(since / self.tracking_time, 1.0)
            # Back-calculation: what the limit took off is led back within the tracking time.
            return result, grown + share * (result - (command + grown))
        return result, integral


def _seen(what: str, measured: Mapping[str, float], name: str) -> float:
    if name not in measured:
        known = ", ".join(measured) or "none"
        raise InputError(f"{what}: {name!r} is not measured; measured quantities: {known}.")
    return measured[name]


# Compensation of friction by the force that an identified law gives.

Load: TypeAlias = float | Callable[[float, Mapping[str, float]], float]
"""A normal force [N] or a contact input, or a function of time and what is measured."""


def sliding_force(law: FrictionLaw, velocity: float, load: float) -> float:
    """Return the friction force of steady sliding [N], 0 at rest.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> sliding_force(Coulomb(kinetic_coefficient=0.25), -0.1, load=4.0)
    -1.0
    """
    # The sign of rest is open; a push of break-away would chatter.
    if velocity == 0.0:
        return 0.0
    if isinstance(law, FrictionLaw):
        return float(law.steady(velocity, load))
    raise InputError(
        f"{type(law).__name__} is not a friction law that can be compensated: give"
        " one such as Coulomb(...)."
    )


@dataclass(frozen=True, kw_only=True)
class FrictionCompensation(Parametrised):
    """A controller that pushes with a law's friction force, in the direction of motion.

    Within the crossing ``|v| < width`` the force is that of the law times ``s (3 - s^2) / 2`` with
    ``s = |v| / width``: smooth, 0 at rest, and exactly the law's from the width on.
    """

    law: FrictionLaw
    """The identified law."""
    width: Annotated[float, Quantity("w", "m/s", above=0)]
    """Speed below which the force fades to 0, which noise would else turn into chatter."""
    factor: Annotated[float, Quantity("kappa", low=0)] = 1.0
    """Share of friction that is compensated; above 1 it is over-compensated."""
    load: Load = 1.0
    """Normal force."""
    inputs: Mapping[str, Load] = field(default_factory=dict)
    """Contact inputs of the law, by name."""
    velocity: str | Callable[[float], float] = "v"
    """Name of a measured rate, or the desired velocity as a function of time."""

    def __post_init__(self) -> None:
        """Check the law."""
        super().__post_init__()
        if not isinstance(self.law, FrictionLaw):
            raise ParameterError(
                f"FrictionCompensation.law must be a friction law, got {self.law!r}."
            )
        for name in self.inputs:
            if name not in self.law.inputs:
                raise UnknownNameError(f"contact input of {self.law.name}", name, self.law.inputs)
        for name in () if is_bound(self.law) else self.law.inputs:
            if name not in self.inputs:
                raise InputError(
                    f"compensation: the friction law {self.law.name} depends on {name}: give it,"
                    f" as inputs={{{name!r}: ...}}, a number or a function of time and what is"
                    " measured."
                )

    def __call__(self, t: float, measured: Mapping[str, float]) -> float:
        """Return the force at a sample."""
        speed = (
            float(self.velocity(t))
            if callable(self.velocity)
            else _seen("compensation", measured, self.velocity)
        )
        load, *inputs = (
            value(t, measured) if callable(value) else value
            for value in (self.load, *self.inputs.values())
        )
        law = self.law
        if inputs:
            law = bound(law, dict(zip(self.inputs, inputs, strict=True)))
        share = min(abs(speed) / self.width, 1.0)
        # 0 at rest with a slope, 1 at the width without one: no kink in either place.
        crossing = 0.5 * share * (3.0 - share * share)
        return self.factor * crossing * sliding_force(law, speed, load)


def compensation(
    law: FrictionLaw,
    *,
    width: float,
    factor: float = 1.0,
    load: Load = 1.0,
    inputs: Mapping[str, Load] | None = None,
    velocity: str | Callable[[float], float] = "v",
) -> FrictionCompensation:
    """Return a controller that compensates friction by an identified law.

    Parameters
    ----------
    law : FrictionLaw
        The law; of a law with bristles, its steady sliding.
    width : float
        Speed below which the compensation fades to 0 [m/s].
    factor : float
        Share of friction that is compensated: 1 exactly, less or more.
    load : float or callable
        Normal force [N], or a function of time and what is measured.
    inputs : mapping of str to float or callable, optional
        Contact inputs of the law in the same way, such as ``{"temperature": 35.0}`` [degC].
    velocity : str or callable
        Name of the measured rate, or the desired velocity as a function of time, which has no
        noise and does not feed back.

    Returns
    -------
    FrictionCompensation
        A controller; give it to `PID` as ``feedforward``.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> push = compensation(Coulomb(kinetic_coefficient=2.0), width=0.01, factor=0.9)
    >>> [round(push(0.0, {"v": v}), 9) for v in (-0.1, 0.0, 0.005, 0.01)]
    [-1.8, 0.0, 1.2375, 1.8]
    """
    return FrictionCompensation(
        law=law, width=width, factor=factor, load=load, inputs=inputs or {}, velocity=velocity
    )


# Partial feedback linearisation: one coordinate follows, friction and all else being known.


@dataclass
class _LinearisationMemory:
    """What is kept from sample to sample."""

    evaluator: Evaluator | None = None
    command: float = 0.0
    singular: list[float] = field(default_factory=list)


Line: TypeAlias = tuple[float, float]
"""Friction at the contact as a line over the normal force: without load, and its slope."""


def _table(found: Mapping[str, Any]) -> Any:
    """Return accelerations and normal force (3, n + 1): free, by friction, by command.

    Row 0 is what is without both; the others are what a unit of each adds.
    """
    right = [found["forces"], -found["friction_direction"][:, 0], found["command_direction"][:, 0]]
    normal = (
        found["normal"][0],
        found["normal_by_friction"][0, 0],
        found["normal_by_command"][0, 0],
    )
    return np.column_stack([np.linalg.solve(found["mass"], np.transpose(right)).T, normal])


@dataclass(frozen=True, kw_only=True)
class PartialLinearisation(Parametrised):
    """A controller that lets one coordinate of a mechanism follow a reference.

    At each sample it computes the command under which the tracked coordinate accelerates by
    ``r'' + K_d (r' - q') + K_p (r - q)``, from the mechanism's equations with the friction of a law
    in them. The normal force depends on the command and friction on the normal force; the three are
    solved together. A body at rest stays (the friction is then what holds it) as long as the law
    can hold it.

    *Collocated*: the tracked coordinate is the one the drive acts on, such as ``theta`` of
    `PendulumCart`. *Non-collocated*: it is another, such as ``x``, which the drive moves through
    the pendulum; what the pendulum does meanwhile is what is left, and it need not be bounded.

    The law is singular where the command does not accelerate the tracked coordinate: for ``x`` of
    the cart at ``cos(theta) = 0`` without friction, and with it where the rod lies on the cone of
    friction, ``tan(theta) = -1 / mu`` at slip forwards and ``1 / mu`` backwards; and where the
    command would lift the cart, N <= 0. It then repeats its last command, and `singular` has the
    times. Near such a place commands are large: give `closed_loop` a limit.

    Examples
    --------
    >>> from stickslip import Coulomb, PendulumCart
    >>> cart = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3)
    >>> steer = PartialLinearisation(
    ...     mechanism=cart,
    ...     law=Coulomb(kinetic_coefficient=0.2),
    ...     track="theta",
    ...     stiffness=100.0,
    ...     damping=20.0,
    ...     reference=0.1,
    ... )
    >>> round(steer(0.0, {"x": 0.0, "theta": 0.0, "v": 0.0, "omega": 0.0}), 9)
    0.09
    """

    mechanism: Mechanism
    """What moves, as it is modelled."""
    law: FrictionLaw
    """What holds it back, as it is modelled."""
    track: str
    """The coordinate that follows."""
    stiffness: Annotated[float, Quantity("K_p", "1/s^2", low=0)]
    """Acceleration per error."""
    damping: Annotated[float, Quantity("K_d", "1/s", low=0)]
    """Acceleration per error's rate."""
    reference: Signal = 0.0
    """Where to be, a number or a function of time."""
    reference_rate: Signal = 0.0
    """Its rate."""
    reference_acceleration: Signal = 0.0
    """The rate of that."""
    drive: str | None = None
    """What is commanded, as in `closed_loop`."""
    rest_speed: Annotated[float, Quantity("v_0", "m/s", low=0)] = 0.0
    """Slip speed up to which the body counts as being at rest; noise needs some."""
    least: Annotated[float, Quantity("E", low=0)] = 0.0
    """Acceleration per command below which the law counts as singular; where there is none at all
    it is, whatever is given here."""
    _memory: _LinearisationMemory = field(
        default_factory=_LinearisationMemory, init=False, repr=False, compare=False
    )

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.track not in self.mechanism.coordinates:
            raise ParameterError(
                "PartialLinearisation.track must be one of the coordinates"
                f" {', '.join(self.mechanism.coordinates)}, got {self.track!r}."
            )

    @property
    def singular(self) -> tuple[float, ...]:
        """Times of the samples at which the law was singular since the last `reset` [s]."""
        return tuple(self._memory.singular)

    def reset(self) -> None:
        """Forget the last command and the singular times."""
        object.__setattr__(self, "_memory", _LinearisationMemory(evaluator=self._memory.evaluator))

    def __call__(self, t: float, measured: Mapping[str, float]) -> float:
        """Return the command at a sample."""
        memory = self._memory
        if memory.evaluator is None:
            place = places_of(self.mechanism, self.drive)
            memory.evaluator = Evaluator(self.mechanism, place)
        names = (*self.mechanism.coordinates, *self.mechanism.rates)
        missing = [name for name in names if name not in measured]
        if missing:
            raise InputError(f"PartialLinearisation needs measurements of {', '.join(missing)}.")
        table = _table(memory.evaluator(t, [measured[name] for name in names]))
        slip = self.mechanism.coordinates.index(slip_of(self.mechanism))
        speed = measured[self.mechanism.rates[slip]]
        command = self._command(table, slip, speed, self._target(t, measured))
        if command is None:
            memory.singular.append(t)
        else:
            memory.command = command
        return memory.command

    def _target(self, t: float, measured: Mapping[str, float]) -> float:
        """Return the acceleration that the tracked coordinate shall have."""
        rate = self.mechanism.rates[self.mechanism.coordinates.index(self.track)]
        return (
            value_at(self.reference_acceleration, t)
            + self.damping * (value_at(self.reference_rate, t) - measured[rate])
            + self.stiffness * (value_at(self.reference, t) - measured[self.track])
        )

    def _command(self, table: Any, slip: int, speed: float, target: float) -> float | None:
        """Return the command, None where there is none."""
        row = self.mechanism.coordinates.index(self.track)
        if abs(speed) > self.rest_speed:
            # Slip tells the direction of friction.
            return self._sliding(table, row, target, self._line(speed))
        if row == slip:  # it must break away, to where it is asked to go
            side = 1.0 if target > 0.0 else -1.0
            return self._sliding(table, row, target, self._holding(side))
        held, friction, normal = self._stuck(table, row, slip, target)
        # What holds is within the cone of friction: the body stays.
        if held is None or abs(friction) <= float(self.law.break_away(normal)):
            return held
        side = 1.0 if friction > 0.0 else -1.0
        # The limit of slip from rest: no speed yet, and already a direction.
        return self._sliding(table, row, target, self._line(side * 1e-300))

    def _line(self, speed: float) -> Line:
        # Laws are affine in the load: two loads tell the line.
        none, loaded = (sliding_force(self.law, speed, load) for load in (0.0, 1.0))
        return none, loaded - none

    def _holding(self, side: float) -> Line:
        none, loaded = (side * float(self.law.break_away(load)) for load in (0.0, 1.0))
        return none, loaded - none

    def _sliding(self, table: Any, row: int, target: float, friction: Line) -> float | None:
        """Solve acceleration, normal force and friction for the command."""
        (free, by_friction, by_command), (n_0, n_f, n_u) = table[:, row], table[:, -1]
        # N = n_0 + n_f F + n_u u and F = c + s N, solved for N.
        c, s = friction
        pivot = 1.0 - s * n_f
        if pivot <= 0.0:
            return None  # Painleve's paradox
        constant = (c + s * n_0) / pivot
        slope = s * n_u / pivot
        gain = by_command + by_friction * slope
        if self._is_singular(gain, abs(by_command) + abs(by_friction * slope)):
            return None
        command = (target - free - by_friction * constant) / gain
        normal = n_0 + n_f * (constant + slope * command) + n_u * command
        return float(command) if normal > 0.0 else None

    def _is_singular(self, gain: float, size: float) -> bool:
        # What is left of parts that cancel is rounding.
        return abs(gain) <= max(self.least, ROUNDING * size)

    def _stuck(
        self, table: Any, row: int, slip: int, target: float
    ) -> tuple[float | None, float, float]:
        """Return command, friction and normal force while the contact holds."""
        # Friction that holds makes the acceleration of the slip 0: F = -(s_0 + s_u u) / s_f.
        (a_0, a_f, a_u), (s_0, s_f, s_u), (n_0, n_f, n_u) = (table[:, i] for i in (row, slip, -1))
        gain = a_u - a_f * s_u / s_f
        if self._is_singular(gain, abs(a_u) + abs(a_f * s_u / s_f)):
            return None, 0.0, 0.0
        command = (target - a_0 + a_f * s_0 / s_f) / gain
        friction = -(s_0 + s_u * command) / s_f
        normal = n_0 + n_f * friction + n_u * command
        return (float(command) if normal > 0.0 else None), float(friction), float(normal)
