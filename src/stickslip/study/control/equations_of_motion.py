"""The equations of motion of a mechanism as numbers, and where it takes a command.

In M q'' = h - W F + B u, the mass matrix M, the forces h, the directions W of friction and B of the
drive are evaluated at a state.
"""

import dataclasses
import typing
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import Viscous
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.drives import Drive, PiecewiseAffine, Profile, Sampled
from stickslip.quantities import Parametrised, Quantity
from stickslip.show.described import Described

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


# Where a mechanism takes the command of a controller.


class Place(NamedTuple):
    """A field, of a mechanism or of a part of it, that holds a drive."""

    path: tuple[str, ...]
    """Names of fields from the mechanism down, and numbers of parts where there are several."""

    @property
    def name(self) -> str:
        """The path as it is written."""
        return ".".join(self.path)

    def commanded(
        self, mechanism: Mechanism, command: Sampled | PiecewiseAffine
    ) -> tuple[Mechanism, str]:
        """Return a mechanism with a command there, and what it calls that drive.

        A drive that is there already stays, and the command is added to it.
        """
        driven = _put(mechanism, self.path, command)
        held = _got(driven, self.path)
        for name, drive in driven.drives().items():
            if drive is held:
                return driven, name
        raise InputError(
            f"{type(mechanism).__name__}.{self.name} is not a drive that can be commanded:"
            f" drives() must list it (it lists {', '.join(driven.drives()) or 'none'})."
        )


def _got(root: Any, path: tuple[str, ...]) -> Any:
    for name in path:
        root = root[int(name)] if isinstance(root, tuple) else getattr(root, name)
    return root


def _put(root: Any, path: tuple[str, ...], command: Drive) -> Any:
    if not path:
        return command if root is None else root + command
    first, rest = path[0], path[1:]
    new = _put(_got(root, (first,)), rest, command)
    if isinstance(root, tuple):  # one of several parts
        return tuple(new if str(i) == first else part for i, part in enumerate(root))
    return dataclasses.replace(root, **{first: new})


def _places(root: Parametrised, path: tuple[str, ...] = ()) -> Iterator[Place]:
    """Yield the fields that hold a drive, or may."""
    hints = typing.get_type_hints(type(root))
    imposed = root.imposed if isinstance(root, Mechanism) else frozenset[str]()
    for field in dataclasses.fields(root):
        value = getattr(root, field.name)
        here = (*path, field.name)
        if isinstance(value, Profile) or (not path and field.name in imposed):
            continue  # what is imposed leaves nothing to command
        if isinstance(value, Drive) or (
            value is None and Drive in typing.get_args(hints[field.name])
        ):
            yield Place(here)
        elif isinstance(value, Parametrised):
            yield from _places(value, here)
        elif isinstance(value, tuple):
            for i, part in enumerate(value):
                if isinstance(part, Parametrised):
                    yield from _places(part, (*here, str(i)))


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
    found = [p for p in known.values() if short in (p.name, p.path[0], p.path[-1])]
    if len(found) != 1:
        raise UnknownNameError("drive", drive, known)
    return found[0]


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
    found = {name: place_of(mechanism, name) for name in drives}
    if not found or len(set(found.values())) < len(drives):
        raise InputError(f"drive must name different drives, one or more, got {list(drives)!r}.")
    return found


def every_place(mechanism: Mechanism) -> dict[str, Place]:
    """Return all places at which a mechanism can be commanded, by their paths."""
    known = {place.name: place for place in _places(mechanism)}
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

        equations, w, whole = self.equations, self.equations.w, self.equations.whole
        n, count, first = whole[at.N_COORDINATES], whole[at.N_CONTACTS], whole[at.Y]
        equations.load_at(t)
        if drive >= 0:
            w[self.places[drive]] += 1.0
        w[first : first + 2 * n], w[at.TIME] = state, t
        # Twice: first what turns states, then what depends on the turned state.
        prepare(t, w, whole)
        turn_states(first, 0, w, whole)
        set_own_flags(0, w, whole)
        # All slip: friction is given, and nothing holds.
        for i in range(whole[at.N_DIRECTIONS]):
            whole[whole[at.MODES] + i] = FORWARD
        prepare(t, w, whole)
        put_mass(t, w, whole, first)
        factorise(w, whole)
        evaluate(FORCES, 0, whole[at.FLAGS], t, w, first, whole[at.FORCE])
        evaluate(LOADS, 0, whole[at.FLAGS], t, w, first, whole[at.LOAD])
        # A given friction, whatever the loads are.
        for c in range(count):
            w[whole[at.FRICTION_CONSTANT] + c] = 1.0 if c == contact else 0.0
            w[whole[at.FRICTION_FACTOR] + c] = 0.0
        if whole[at.N_REACTIONS] > 0:
            react(w, whole)
        forces, load = whole[at.FORCE], whole[at.LOAD]
        return np.array(w[forces : forces + n]), np.array(w[load : load + count])

    def __call__(self, t: float, state: Sequence[float]) -> dict[str, Any]:
        """Return the numbers of `Dynamics` in coordinates of the mechanism."""
        from stickslip.engine.kernels import state_layout as at
        from stickslip.engine.kernels.equations import factor_of

        h, loads = self.at(t, state)
        w, whole = self.equations.w, self.equations.whole
        n, count = whole[at.N_COORDINATES], whole[at.N_CONTACTS]

        def matrix(place: int) -> Any:
            return np.array(w[place : place + n * n]).reshape(n, n)

        mass = matrix(whole[at.MASS])
        turn = matrix(whole[at.TURN]) if whole[at.IS_TURNED] else np.eye(n)
        slips = np.zeros((n, count))
        for c in range(count):
            for j in range(n):
                along = factor_of(whole[whole[at.SLIPS] + c], j, w, whole)
                slips[j, c] = along * w[whole[at.SLIP_FACTORS] + c]
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
    found = evaluator(t, state)
    single = not every and (drive is None or isinstance(drive, str))
    if single:
        for name in ("command_direction", "normal_by_command"):
            found[name] = found[name][:, 0]
    if not several:
        found["friction_direction"] = found["friction_direction"][:, 0]
        found["normal"] = float(found["normal"][0])
        found["normal_by_friction"] = float(found["normal_by_friction"][0, 0])
        by_command = found["normal_by_command"][0]
        found["normal_by_command"] = float(by_command) if single else by_command
        found["contacts"] = ()
    return Dynamics(**found, drives=() if single else tuple(places))
