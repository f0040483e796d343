"""What a mechanism is: energies, forces, contacts at which it rubs, and the cycle of its drives."""

import dataclasses
import functools
import math
import re
from abc import ABC, abstractmethod
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Literal, TypeAlias, TypeVar, final

import numpy as np
from typing_extensions import override

from stickslip import quantities
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.maths import Scalar, cos, sin
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS, checked_inputs
from stickslip.mechanisms.drives import Drive, parts_of
from stickslip.show.described import Described
from stickslip.show.formatting import number

Incline: TypeAlias = Annotated[float, quantities.Quantity("beta", "rad", low=-1.57, high=1.57)]
"""Angle of the ground from the horizontal: with a positive one, positive x is uphill."""


ContactInputs: TypeAlias = Mapping[str, Scalar | Mapping[str, Scalar]]
"""Inputs of a contact by name; those of one of several contacts under the name of the contact."""


PREFIX = "mechanism"
"""What the paths of its parameters begin with."""
LINKS = "links"
"""What ``vary`` calls all that fits find of the inertial parameters of a robot's links."""
_KEBAB = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


@dataclass(frozen=True, kw_only=True)
class Contact(metaclass=Described):
    """A frictional contact: the coordinate that slips, and the normal force.

    Parameters
    ----------
    slip : str, or mapping of str to float
        Coordinate whose rate is the slip velocity; or the slip velocity as a combination of rates,
        factors by coordinate, such as a radius.
    normal : str, or mapping of str to float, optional
        A coordinate held at 0 whose reaction is the normal force; or how a unit of normal force
        acts on several held coordinates, factors by coordinate.
    load : float, optional
        The normal force [N] where it is prescribed instead. A mechanism whose loads change tells
        them in `loads`.
    name : str
        Tells contacts apart where there are several; kebab-case, since it stands in columns
        (``friction:elbow``) and in paths (``friction.elbow.kinetic_coefficient``).

    Raises
    ------
    ParameterError
        If the name is not in kebab case.
    """

    slip: str | Mapping[str, Scalar]
    normal: str | Mapping[str, Scalar] | None = None
    load: Scalar | None = None
    name: str = ""

    def __post_init__(self) -> None:
        """Check the name."""
        if self.name and not _KEBAB.fullmatch(self.name):
            raise ParameterError(
                f"Contact.name must be in kebab case, lower-case letters, digits and hyphens after"
                f" a letter, such as 'left-pad', got {self.name!r}."
            )

    @property
    def slips(self) -> tuple[str, ...]:
        """Coordinates whose rates make the slip velocity."""
        return (self.slip,) if isinstance(self.slip, str) else tuple(self.slip)

    @property
    def normals(self) -> tuple[str, ...]:
        """Held coordinates on which the normal force acts."""
        if self.normal is None or isinstance(self.normal, str):
            return () if self.normal is None else (self.normal,)
        return tuple(self.normal)


@dataclass(frozen=True, kw_only=True)
class Stop(metaclass=Described):
    """A hard stop: a coordinate that reaches its position bounces, or stays while it is pressed.

    Parameters
    ----------
    coordinate : str
        Coordinate that is stopped, of any kind.
    position : float
        Where it is stopped, in the coordinate's unit; it does not move.
    side : {"lower", "upper"}
        Whether the coordinate may not fall below the position or not rise above it.
    restitution : float
        Speed after an impact over the speed before, 0 to 1.
    """

    coordinate: str
    position: Scalar
    side: Literal["lower", "upper"]
    restitution: Scalar = 0.0


@dataclass(frozen=True, kw_only=True)
class Guide(metaclass=Described):
    """A coordinate with a prescribed motion: a drive gives its acceleration.

    Parameters
    ----------
    drive : str
        Name of the drive whose value is the acceleration.
    effort : str
        What the force or torque is called that it takes; a column of runs.
    unit : str
        Its unit.
    """

    drive: str
    effort: str
    unit: str


@dataclass(frozen=True, kw_only=True)
class Mechanism(quantities.Parametrised, ABC):
    """A mechanism without its friction, given by Lagrange's method.

    The equations use `stickslip.maths` and are derived, not typed: mass matrix, forces, normal
    force and all derivatives follow from the energies. Coordinates that a contact holds at 0 stand
    in the energies like any other.
    """

    name: ClassVar[str]
    """Key in the registry and ``type`` in rig files."""
    coordinates: ClassVar[tuple[str, ...]]
    """State names of the moving coordinates; where their number depends on a field, a property."""
    rates: ClassVar[tuple[str, ...]]
    """State names of their time derivatives."""
    units: ClassVar[tuple[str, ...]]
    """SI units of the coordinates."""
    moving_part: ClassVar[str] = "body"
    """What slips on the contact, as reports call it."""
    contact_names: ClassVar[str] = ""
    """Names of the contacts where there may be several, as listings show them."""
    imposed: ClassVar[frozenset[str]] = frozenset()
    """Fields of drives from outside, as of shaking ground, which no controller commands."""
    computed: ClassVar[frozenset[str]] = frozenset()
    """Coordinates that stand for numbers of a controller: they have no energy."""

    @property
    @final
    def title(self) -> str:
        """The kind in running text, which stands for a rig without a title of its own."""
        return self.name.replace("-", " ").capitalize()

    @abstractmethod
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        """Return the kinetic energy [J] at coordinates and rates, both by coordinate name.

        Parameters
        ----------
        q : mapping of str to float or array
            Coordinates by name, held ones included.
        q_dot : mapping of str to float or array
            Their rates, by name of the coordinate.

        Returns
        -------
        float or array
            Kinetic energy [J].
        """

    @abstractmethod
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        """Return the potential energy [J]; time stands in it where a support is moved.

        Parameters
        ----------
        t : float or array
            Time [s].
        q : mapping of str to float or array
            Coordinates by name, held ones included.

        Returns
        -------
        float or array
            Potential energy [J].
        """

    @abstractmethod
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        """Return the other generalised forces by coordinate, friction left out.

        Parameters
        ----------
        t : float
            Time [s].
        q, q_dot : mapping
            Coordinates and their rates by coordinate name.
        drives : mapping
            Present values of the drives by name.

        Returns
        -------
        mapping of str to float or array
            Generalised forces by coordinate, those on held ones included; what is left out is 0.
        """

    @abstractmethod
    def contacts(self) -> tuple[Contact, ...]:
        """Return the contacts."""

    def loads(
        self,
        t: Scalar,  # for those whose loads change
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        """Return the prescribed loads of contacts by name; where left out, that of the contact.

        A contact whose load falls to 0 opens, and closes when it rises again.

        Parameters
        ----------
        t : float or array
            Time [s].
        q : mapping of str to float or array
            Coordinates by name.
        q_dot : mapping of str to float or array
            Their rates, by name of the coordinate.
        drives : mapping
            Present values of the drives by name.

        Returns
        -------
        mapping of str to float or array
            Loads [N] by name of the contact.
        """
        return {}

    def contact_inputs(
        self,
        t: Scalar,  # for those that can tell
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        """Return what friction laws may ask of the contact beside speed and load.

        Forces count along the motion of what slips, those of the drive and the others apart: a
        motor that holds a weight has the opposite sign of gravity, and the gear between both
        transmits ``motor - external``, twice the weight.

        Parameters
        ----------
        t : float or array
            Time [s].
        q : mapping of str to float or array
            Coordinates by name.
        q_dot : mapping of str to float or array
            Their rates, by name of the coordinate.
        drives : mapping
            Present values of the drives by name.

        Returns
        -------
        mapping of str to float or array
            Some of `CONTACT_INPUTS`, by name. Where several contacts rub, a mapping of them by the
            name of the contact.
        """
        return {}

    @abstractmethod
    def drives(self) -> Mapping[str, Drive]:
        """Return the drives that are fitted, by name."""

    def start(self) -> Mapping[str, Scalar]:
        """Return the states at time 0 that are not 0 unless ``y0`` says otherwise, by name."""
        return {}

    def carried(self) -> Mapping[str, Scalar]:
        """Return how fast a belt or a pulled spring carries coordinates along [m/s] or [rad/s].

        Time is in the equations through these alone: moved on by speed times time, the coordinates
        obey the equations of time 0, so that motions may repeat themselves with any period.
        """
        return {}

    def guided(self) -> Mapping[str, Guide]:
        """Return the coordinates whose acceleration is prescribed, by coordinate."""
        return {}

    def held(self) -> tuple[str, ...]:
        """Return coordinates held at 0 beside the contact's normal one, for their reactions."""
        return ()

    def limits(
        self,
        forces: Mapping[str, Scalar],  # for those that have limits
    ) -> Mapping[str, Scalar]:
        """Return what ends a run as it falls below 0, by the name of the event.

        Parameters
        ----------
        forces : mapping
            Reactions of the held coordinates (the contact's normal force by the name of its
            normal coordinate), and the efforts of guided coordinates, by coordinate.
        """
        return {}


@dataclass(frozen=True, kw_only=True)
class BoundedMechanism(Mechanism, ABC):
    """A mechanism with hard stops.

    An impact reverses the coordinate's rate, times the restitution, by an impulse along that
    coordinate; the other rates change as the mass matrix tells. Friction has no share in the
    impulse: forces that are bounded do nothing in no time, and that the stop's impulse may press
    on the contact, or lift it, is neglected.
    """

    def __post_init__(self) -> None:
        """Check the parameters, and that the stops leave room between them."""
        super().__post_init__()
        lower, upper = _by_coordinate(self, "lower"), _by_coordinate(self, "upper")
        for coordinate in lower.keys() & upper.keys():
            if not lower[coordinate] < upper[coordinate]:
                raise ParameterError(
                    f"{type(self).__name__}: the upper stop of {coordinate} must lie above the"
                    f" lower one at {number(lower[coordinate], 6)}, got"
                    f" {number(upper[coordinate], 6)}."
                )

    @abstractmethod
    def stops(self) -> tuple[Stop, ...]:
        """Return the stops, at most one on each side of a coordinate."""


@dataclass(frozen=True, kw_only=True)
class LinearOrRotary(Mechanism, ABC):
    """A mechanism whose coordinates are all lengths or all angles."""

    rotary: bool = False
    """Whether coordinates are angles [rad] and forces are torques [N m]; units of values, such as
    kg m^2, set it, and so does a fit to angles."""

    def __post_init__(self) -> None:
        """Check the parameters, and that their units are of one kind of motion."""
        if not isinstance(self.rotary, bool):
            raise ParameterError(
                f"{type(self).__name__}.rotary must be True or False, got {self.rotary!r}."
            )
        kinds = quantities.motion_kinds(type(self), vars(self))
        object.__setattr__(
            self, "rotary", quantities.is_rotary(kinds, True if self.rotary else None)
        )
        super().__post_init__()

    @property
    @override
    def units(self) -> tuple[str, ...]:  # type: ignore[override]
        """SI units of the coordinates."""
        return ("rad" if self.rotary else "m",) * len(self.coordinates)


def gear_inputs(motor: Scalar, external: Scalar, **others: Scalar) -> dict[str, Scalar]:
    """Return contact inputs of a force of the drive and the sum of all others.

    Examples
    --------
    >>> gear_inputs(5.0, -5.0)["transmitted"]  # a motor that holds a weight
    10.0
    """
    return {"motor": motor, "external": external, "transmitted": motor - external, **others}


def as_rotary(mechanism: Mechanism) -> Mechanism:
    """Return a mechanism that may be linear or rotary as a rotary one; others as they are.

    Examples
    --------
    >>> from stickslip import Axis, SpringBlock
    >>> as_rotary(Axis(inertia=2.0)).units, as_rotary(SpringBlock(mass=1.0)).units
    (('rad',), ('m',))
    """
    return replace(mechanism, rotary=True) if isinstance(mechanism, LinearOrRotary) else mechanism


def _by_coordinate(mechanism: BoundedMechanism, side: str) -> dict[str, float]:
    """Return the positions of the stops of one side by coordinate."""
    result: dict[str, float] = {}
    for stop in mechanism.stops():
        owner = f"{type(mechanism).__name__}: the {stop.side} stop of {stop.coordinate}"
        if stop.side not in ("lower", "upper"):
            raise ParameterError(f"{owner} must be 'lower' or 'upper', got {stop.side!r}.")
        if stop.coordinate not in mechanism.coordinates:
            known = ", ".join(mechanism.coordinates)
            raise ParameterError(f"{owner} must be on one of the coordinates {known}.")
        if not 0.0 <= stop.restitution <= 1.0:
            raise ParameterError(
                f"{owner} must have a restitution from 0 to 1, got {stop.restitution:g}."
            )
        if stop.side != side:
            continue
        if stop.coordinate in result:
            raise ParameterError(f"{owner} is given twice; give it once.")
        result[stop.coordinate] = stop.position
    return result


def stops_between(
    coordinate: str, lower: Scalar | None, upper: Scalar | None, restitution: Scalar
) -> tuple[Stop, ...]:
    """Return the stops of a coordinate that are fitted: those whose position is not None.

    Examples
    --------
    >>> [stop.side for stop in stops_between("x", None, 0.1, 0.5)]
    ['upper']
    """
    ends: Any = ("lower", lower), ("upper", upper)
    return tuple(
        Stop(coordinate=coordinate, position=position, side=side, restitution=restitution)
        for side, position in ends
        if position is not None
    )


def height(incline: Scalar, along: Scalar, off: Scalar) -> Scalar:
    """Return how high a point lies that is so far along inclined ground and so far off it [m].

    Examples
    --------
    >>> round(height(0.3, 2.0, 0.0), 6), height(0.0, 2.0, 0.5)
    (0.59104, 0.5)
    """
    return along * sin(incline) + off * cos(incline)


def stops_of(mechanism: Mechanism) -> tuple[Stop, ...]:
    """Return the stops of any mechanism.

    Examples
    --------
    >>> from stickslip import Axis, TowedBlock
    >>> len(stops_of(Axis(inertia=1.0, lower_stop=-0.1, upper_stop=0.1)))
    2
    >>> stops_of(TowedBlock(mass=1.0, stiffness=2.0, speed=0.1))
    ()
    """
    return mechanism.stops() if isinstance(mechanism, BoundedMechanism) else ()


@dataclass(frozen=True, kw_only=True)
class MatrixMechanism(Mechanism, ABC):
    """A mechanism whose equations ``M(q) q'' = h(t, q, q') - W F`` are known already.

    `mass_matrix` gives M and `forces` all of h: weight, springs, dampers, drives, centrifugal and
    Coriolis terms. The contact names the coordinate along which friction F acts (W). Its normal
    coordinate, and others that are held at 0, have a row of M and a force too, from which their
    reactions follow.

    `potential_energy` serves the energy balance only, by which the certificate of a run is judged.
    Nothing is derived from it, so it must fit the forces.

    Examples
    --------
    >>> from stickslip import Coulomb, MatrixMechanism, simulate
    >>> from stickslip.mechanisms import Contact
    >>> class Sledge(MatrixMechanism):
    ...     name, coordinates, rates, units = "sledge", ("x",), ("v",), ("m",)
    ...
    ...     def mass_matrix(self, q):
    ...         return [[2.0], [0.0]]  # rows of x and of y, which the ground holds
    ...
    ...     def forces(self, t, q, q_dot, drives):
    ...         return {"y": -2.0 * 9.81}
    ...
    ...     def potential_energy(self, t, q):
    ...         return 2.0 * 9.81 * q["y"]
    ...
    ...     def contacts(self):
    ...         return (Contact(slip="x", normal="y"),)
    ...
    ...     def drives(self):
    ...         return {}
    >>> run = simulate(Sledge(), Coulomb(kinetic_coefficient=0.1), t_end=5.0, y0={"v": 1.962})
    >>> round(float(run["x"][-1]), 9)  # v^2 / (2 mu g)
    1.962
    """

    @abstractmethod
    def mass_matrix(self, q: Mapping[str, Scalar]) -> Sequence[Sequence[Scalar]]:
        """Return the rows of the mass matrix: one for each coordinate, then one for each held one.

        Each row has one number for each coordinate, in their order. The first of the held ones is
        the contact's normal coordinate if it has one, the others are those of `held`.

        Parameters
        ----------
        q : mapping
            Coordinates by name.
        """

    def power(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Scalar | None:
        """Return the power [W] that drives put in and dampers take out, or None.

        With it, a run whose forces do not fit its energies is not certified. With None, it is taken
        from the forces themselves, and the certificate speaks of the integration alone.

        Parameters
        ----------
        t : float or array
            Time [s].
        q : mapping of str to float or array
            Coordinates by name, held ones included.
        q_dot : mapping of str to float or array
            Their rates, by name of the coordinate.
        drives : mapping of str to float or array
            Present values of the drives by name.

        Returns
        -------
        float or array or None
            Power supplied [W].
        """
        return None

    @final
    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        rates = [q_dot[name] for name in self.coordinates]
        rows = self.mass_matrix(q)[: len(rates)]
        momenta = [sum((m * rate for m, rate in zip(row, rates, strict=True)), 0.0) for row in rows]
        return 0.5 * sum((p * rate for p, rate in zip(momenta, rates, strict=True)), 0.0)


def canonical_path(mechanism: Mechanism, path: str) -> str:
    """Return the full path for a full path, or for a last name that only one parameter has.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> canonical_path(SpringBlock(mass=1.0), "compression")
    'mechanism.compression'
    """
    return quantities.full_path(path, quantities.all_paths(mechanism, PREFIX))


def quantity_at(mechanism: Mechanism, path: str) -> quantities.Quantity:
    """Return the quantity at a full path, or say which known paths are nearest."""
    known = quantities.all_paths(mechanism, PREFIX)
    if path not in known:
        raise UnknownNameError("parameter", path, known)
    return known[path]


# Facts of the only contact of a mechanism: what slips there, and what presses at rest.

MOST_CONTACTS = 1000
"""Contacts for which equations are derived: the time grows with their square, to half a minute."""
PRESSING = ("load", "mass", "gravity")
"""Parameters of a mechanism that its load may come from."""


def checked_contacts(mechanism: Mechanism) -> tuple[Contact, ...]:
    """Return the contacts of a mechanism, if they can be simulated at its parameters.

    Examples
    --------
    >>> from stickslip import BlockChain
    >>> len(checked_contacts(BlockChain(blocks=100, mass=1.0, coupling=1.0)))
    100
    """
    owner = type(mechanism).__name__
    try:
        result = mechanism.contacts()
    except ArithmeticError as error:
        raise InputError(
            f"{owner}: the contacts cannot be worked out at these values of its parameters"
            f" ({error}). Change the values, or write slips and loads that are finite there."
        ) from error
    if len(result) > MOST_CONTACTS:
        raise InputError(
            f"{owner} has {len(result)} contacts, but no more than {MOST_CONTACTS} can be"
            " simulated: leave some out."
        )
    for contact in result:
        for name, factor in {} if isinstance(contact.slip, str) else contact.slip.items():
            if isinstance(factor, int | float) and not math.isfinite(factor):
                raise InputError(
                    f"{owner}: the slip of the contact {contact.name!r} has the factor {factor} for"
                    f" {name} at these values of its parameters: it must be finite."
                )
    return result


def only_contact(mechanism: Mechanism) -> Contact:
    """Return the contact of a mechanism that has one."""
    contacts = mechanism.contacts()
    if len(contacts) != 1:
        names = ", ".join(contact.name for contact in contacts)
        raise InputError(
            f"{type(mechanism).__name__} has {len(contacts)} contacts ({names}); this takes a"
            " mechanism with one."
        )
    return contacts[0]


def has_one_slip(mechanism: Mechanism) -> bool:
    """Return whether there is one contact, which slips along a coordinate.

    Examples
    --------
    >>> from stickslip import Pendulum, TwoFeet
    >>> has_one_slip(Pendulum(mass=1.0, length=0.5))
    True
    >>> has_one_slip(TwoFeet(mass=1.0, front=0.1, rear=0.1))
    False
    """
    contacts = mechanism.contacts()
    return len(contacts) == 1 and isinstance(contacts[0].slip, str)


def slips_by_angle(mechanism: Mechanism, contact: Contact | None = None) -> bool:
    """Return whether a contact slips by an angle, or by the sum or difference of angles.

    Examples
    --------
    >>> from stickslip import Axis, Pendulum
    >>> [
    ...     slips_by_angle(one)
    ...     for one in (
    ...         Axis(inertia=1.0),
    ...         Axis(inertia=1.0, rotary=True),
    ...         Pendulum(mass=1.0, length=0.5),
    ...     )
    ... ]
    [False, True, True]
    """
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    return all(
        units.get(q) == "rad" and abs(factor) == 1.0
        for place in (mechanism.contacts() if contact is None else (contact,))
        for q, factor in ({place.slip: 1.0} if isinstance(place.slip, str) else place.slip).items()
    )


def slip_of(mechanism: Mechanism) -> str:
    """Return the coordinate that slips at the only contact.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> slip_of(Pendulum(mass=1.0, length=0.5))
    'theta'
    """
    slip = only_contact(mechanism).slip
    if not isinstance(slip, str):
        raise InputError(
            f"{type(mechanism).__name__} slips along a combination of coordinates"
            f" ({', '.join(slip)}); this takes a mechanism that slips along one."
        )
    return slip


def slipping(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the moving coordinates along which contacts slip, in their order.

    Examples
    --------
    >>> from stickslip import PendulumCart, TwoFeet
    >>> slipping(TwoFeet(mass=1.0, front=0.1, rear=0.1))
    ('x',)
    >>> slipping(PendulumCart(cart_mass=0.5, ball_mass=0.2, length=0.3, pivot_load=1.0))
    ('x', 'theta')
    """
    slips = {name for contact in mechanism.contacts() for name in contact.slips}
    return tuple(name for name in mechanism.coordinates if name in slips)


def slip_among(mechanism: Mechanism, coordinate: str | None, owner: str) -> tuple[str, str]:
    """Return a coordinate and its rate: as asked, or the only one along which contacts slip.

    Examples
    --------
    >>> from stickslip import BlockChain, Pendulum
    >>> slip_among(Pendulum(mass=1.0, length=0.5), None, "basins")
    ('theta', 'omega')
    >>> slip_among(BlockChain(blocks=3, mass=1.0, coupling=1.0), "x2", "basins")
    ('x2', 'v2')
    """
    if coordinate is None:
        among = slipping(mechanism)
        if len(among) != 1:
            raise InputError(
                f"{owner}: the contacts of {type(mechanism).__name__} slip along several"
                f" coordinates ({', '.join(among)}): name one, such as coordinate={among[0]!r}."
            )
        (coordinate,) = among
    if coordinate not in mechanism.coordinates:
        raise UnknownNameError("coordinate", coordinate, mechanism.coordinates)
    return coordinate, mechanism.rates[mechanism.coordinates.index(coordinate)]


def normal_of(mechanism: Mechanism) -> str | None:
    """Return the held coordinate whose reaction is the normal force of the only contact."""
    normal = only_contact(mechanism).normal
    if normal is not None and not isinstance(normal, str):
        raise InputError(
            f"{type(mechanism).__name__} is carried by several held coordinates"
            f" ({', '.join(normal)}); this takes a mechanism that is carried by one."
        )
    return normal


def slip_names(mechanism: Mechanism) -> tuple[str, str]:
    """Return the names of the coordinate that slips at the only contact, and of its rate.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> slip_names(Pendulum(mass=1.0, length=0.5))
    ('theta', 'omega')
    """
    slip = slip_of(mechanism)
    return slip, mechanism.rates[mechanism.coordinates.index(slip)]


def static_normal_force(mechanism: Mechanism) -> float:
    """Return the normal force at the only contact while nothing moves [N].

    That is the weight, on an incline its part along the normal; or the load of a contact for which
    one is prescribed.

    Examples
    --------
    >>> from stickslip import Axis, Capsule
    >>> round(static_normal_force(Capsule(capsule_mass=0.8, inner_mass=0.2)), 9)
    9.81
    >>> static_normal_force(Axis(inertia=1.0, load=20.0))
    20.0
    """
    contact, normal = only_contact(mechanism), normal_of(mechanism)
    if normal is None:
        return float(1.0 if contact.load is None else contact.load)
    places = dict.fromkeys((*mechanism.coordinates, normal), 0.0)
    # Weight along the normal is what the energy grows by over 1 m: it is linear in the place.
    raised = mechanism.potential_energy(0.0, places | {normal: 1.0})
    return float(raised - mechanism.potential_energy(0.0, places))


def static_normal_forces(mechanism: Mechanism) -> dict[str, float]:
    """Return the normal force at each contact while nothing moves [N], by the contact's name.

    Examples
    --------
    >>> from stickslip import TwoFeet
    >>> body = TwoFeet(mass=2.0, front=0.3, rear=0.2)
    >>> {name: round(force, 9) for name, force in static_normal_forces(body).items()}
    {'front': 7.848, 'rear': 11.772}
    """
    contacts = mechanism.contacts()
    if len(contacts) == 1 and not isinstance(contacts[0].normal, Mapping):
        return {contacts[0].name: static_normal_force(mechanism)}
    result = {
        contact.name: float(1.0 if contact.load is None else contact.load) for contact in contacts
    }
    carried = [contact for contact in contacts if contact.normal is not None]
    held = list(dict.fromkeys(name for contact in carried for name in contact.normals))
    if not held:
        return result
    still = dict.fromkeys((*mechanism.coordinates, *held, *mechanism.held()), 0.0)

    def weight(name: str) -> float:  # central, since a tilt raises a body by its square, too
        ends = (mechanism.potential_energy(0.0, still | {name: side}) for side in (1e-3, -1e-3))
        up, down = ends
        return float(up - down) / 2e-3

    # The normal forces balance the weight along all held coordinates.
    rows = [[_factor(contact, name) for contact in carried] for name in held]
    forces, _, rank, _ = np.linalg.lstsq(
        np.array(rows, dtype=float), np.array([weight(name) for name in held]), rcond=None
    )
    if rank < len(carried):
        names = ", ".join(contact.name for contact in carried)
        raise InputError(
            f"the weight of {type(mechanism).__name__} does not tell what {names} carry."
        )
    return result | dict(zip((contact.name for contact in carried), forces.tolist(), strict=True))


def load_stated(mechanism: Mechanism | None, overrides: Mapping[str, float]) -> float | None:
    """Return the load that a mechanism states [N], or None where it has one only by default.

    Examples
    --------
    >>> from stickslip import Axis
    >>> load_stated(Axis(inertia=1.0, load=50.0), {}), load_stated(Axis(inertia=1.0), {})
    (50.0, None)
    """
    if mechanism is None:
        return None
    fields = mechanism.__dataclass_fields__
    pressing = {f"{PREFIX}.{name}" for name in PRESSING if name in fields}
    own = {path: value for path, value in overrides.items() if path in pressing}
    varied = quantities.vary(mechanism, PREFIX, own)
    loads = [contact.load for contact in varied.contacts()]
    if len(loads) != 1 or not isinstance(loads[0], int | float) or loads[0] <= 0.0:
        return None
    # A default of 1 N stands for levels that are forces, and is no load that anybody stated.
    usual = "load" in fields and fields["load"].default == loads[0]
    return None if usual and f"{PREFIX}.load" not in own else float(loads[0])


def _factor(contact: Contact, name: str) -> float:
    """Return how a unit of normal force acts on a held coordinate."""
    if isinstance(contact.normal, str) or contact.normal is None:
        return 1.0 if contact.normal == name else 0.0
    return float(contact.normal.get(name, 0.0))


# How long a cycle of a mechanism's drives is.

WHOLE = 1e-9
"""How far from a whole number the ratio of two periods may be: the rounding of their inputs."""


def cycle_of(mechanism: Mechanism) -> float:
    """Return the time after which all drives of a mechanism repeat themselves [s].

    Parameters
    ----------
    mechanism : Mechanism
        Its drives are `Sine`, `Square` or motion profiles, or sums of them; the period of the
        slowest must be a whole multiple of those of the others.

    Returns
    -------
    float
        The period [s].

    Raises
    ------
    InputError
        If there is no drive, or one does not repeat itself, or they have no common cycle.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms.drives import Sine
    >>> cycle_of(Axis(inertia=1.0, drive=Sine(amplitude=2.0, frequency=4.0)))
    0.25
    """
    name = type(mechanism).__name__
    periods = [
        _period(f"{name}: the drive {key!r}", part)
        for key, drive in mechanism.drives().items()
        for part in parts_of(drive)
        if not part.steady
    ]
    if not periods:
        raise InputError(
            f"{name} has no drive and therefore no drive period; give the period [s] explicitly."
        )
    longest = max(periods)
    for period in periods:
        if abs(longest / period - round(longest / period)) > WHOLE * longest / period:
            raise InputError(
                f"{name}: drives with periods of {number(period, 6)} and {number(longest, 6)} s"
                " have no common period equal to the longer one; give the period [s] explicitly."
            )
    return longest


def redriven(root: Any, change: Callable[[Drive], Drive]) -> Any:
    """Return a mechanism, or a part of one, with its drives changed.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms.drives import Sine
    >>> axis = Axis(inertia=1.0, drive=Sine(amplitude=1.0, frequency=2.0))
    >>> redriven(axis, lambda drive: replace(drive, amplitude=3.0)).drive.amplitude
    3.0
    """
    if isinstance(root, Drive):
        return change(root)
    if isinstance(root, tuple):
        return tuple(redriven(part, change) for part in root)
    if not isinstance(root, quantities.Parametrised):
        return root
    old = {known.name: getattr(root, known.name) for known in dataclasses.fields(root)}
    new = {name: redriven(part, change) for name, part in old.items()}
    return replace(root, **{name: part for name, part in new.items() if part != old[name]})


def cycle_or_none(mechanism: Mechanism) -> float | None:
    """Return the time after which all drives repeat themselves [s], None where they do not.

    Examples
    --------
    >>> from stickslip import Axis
    >>> cycle_or_none(Axis(inertia=1.0)) is None
    True
    """
    try:
        return cycle_of(mechanism)
    except InputError:
        return None


def repeats(mechanism: Mechanism) -> bool:
    """Whether a drive of a mechanism, or a part of one, repeats itself.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms.drives import Pulse, Sine
    >>> push, shake = Pulse(level=2.0, duration=0.1), Sine(amplitude=2.0, frequency=4.0)
    >>> repeats(Axis(inertia=1.0, drive=push)), repeats(Axis(inertia=1.0, drive=push + shake))
    (False, True)
    """
    parts = (part for drive in mechanism.drives().values() for part in parts_of(drive))
    return any(part.repeats() is not None for part in parts)


def _period(owner: str, drive: Drive) -> float:
    period = drive.repeats()
    if period is None:
        raise InputError(
            f"{owner} is a {type(drive).__name__}, which is not known to be periodic; give the"
            " period [s] explicitly."
        )
    return float(period)


# Contact inputs that a mechanism is told: a temperature, a pressure, what a sensor recorded.

M = TypeVar("M", bound=Mechanism)
GivenInputs: TypeAlias = Mapping[str, Drive | float | Mapping[str, Drive | float]]
"""Inputs by name, or by contact and name."""


def input_names(mechanism: Mechanism, contact: str = "") -> tuple[str, ...]:
    """Return the names of the inputs of a contact that a mechanism knows.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> input_names(given_inputs(SpringBlock(mass=1.0), {"temperature": 20.0}))[-1:]
    ('temperature',)
    """
    # Any name has a value here: asked for are the names of the inputs alone.
    anywhere: Mapping[str, float] = defaultdict(float)
    return tuple(of_contact(mechanism.contact_inputs(0.0, anywhere, anywhere, anywhere), contact))


def of_contact(inputs: ContactInputs, contact: str) -> dict[str, Scalar]:
    """Return the inputs of one contact, of all that a mechanism tells.

    Examples
    --------
    >>> of_contact({"temperature": 20.0, "elbow": {"gravity": 3.0}}, "elbow")
    {'temperature': 20.0, 'gravity': 3.0}
    """
    own = inputs.get(contact, {})
    whole = {name: value for name, value in inputs.items() if not isinstance(value, Mapping)}
    return {**whole, **(own if isinstance(own, Mapping) else {})}


def given_names(mechanism: Mechanism, contact: str = "") -> tuple[str, ...]:
    """Return the names of the inputs of a contact that a mechanism was given.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> given_names(given_inputs(SpringBlock(mass=1.0), {"temperature": 20.0}))
    ('temperature',)
    """
    return tuple(
        dict.fromkeys(name for at, name in told_fields(mechanism).values() if at in ("", contact))
    )


def given_inputs(mechanism: M, inputs: GivenInputs) -> M:
    """Return a mechanism that tells its laws more contact inputs.

    Each is a number in the unit of its kind (a temperature in degC), a text with a unit, or a
    drive: by its name for all contacts, by contact and name for one, which stands before those for
    all.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock, TwoFeet
    >>> warm = given_inputs(SpringBlock(mass=1.0), {"temperature": 35.0})
    >>> type(warm).__name__, warm.contact_temperature
    ('SpringBlock', 35.0)
    >>> sledge = TwoFeet(mass=2.0, front=0.3, rear=0.2)
    >>> given_inputs(sledge, {"rear": {"temperature": 300.0}}).contact_rear_temperature
    300.0
    """
    if not inputs:
        return mechanism
    given = {**_flat(without_given(mechanism)[1]), **_flat(inputs)}
    known = [place.name for place in mechanism.contacts()]
    for contact in known:
        if ("", contact) in given:
            raise InputError(
                f"inputs of the contact {contact!r} are given by name, such as"
                f" {{{contact!r}: {{'temperature': 20.0}}}}, got {given['', contact]!r}."
            )
    checked_inputs(name for _, name in given)
    for contact, _ in given:
        if contact and contact not in known:
            raise UnknownNameError(f"contact of {type(mechanism).__name__}", contact, known)
    key = tuple((*at, isinstance(value, Drive)) for at, value in given.items())
    kind = _told(_bare(type(mechanism)), key)
    fields = {field.name: getattr(mechanism, field.name) for field in dataclasses.fields(mechanism)}
    result: Any = kind(**{**fields, **{input_field(*at): value for at, value in given.items()}})
    return result  # type: ignore[no-any-return]


def without_given(mechanism: Mechanism) -> tuple[Mechanism, dict[str, Any]]:
    """Return a mechanism as it was before it was given contact inputs, and these by name.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> without_given(given_inputs(SpringBlock(mass=1.0), {"temperature": 35.0}))[1]
    {'temperature': 35.0}
    """
    kind = _bare(type(mechanism))
    own = {entry.name: getattr(mechanism, entry.name) for entry in dataclasses.fields(kind)}
    given: dict[str, Any] = {}
    for field, (contact, name) in told_fields(mechanism).items():
        part = given.setdefault(contact, {}) if contact else given
        part[name] = getattr(mechanism, field)
    return kind(**own), given


def _flat(inputs: GivenInputs) -> dict[tuple[str, str], Drive | float]:
    """Return inputs by contact and name; the contact is empty where all are told."""
    result: dict[tuple[str, str], Drive | float] = {}
    for key, value in inputs.items():
        if isinstance(value, Mapping):
            result |= {(key, name): drive for name, drive in value.items()}
        else:
            result["", key] = value
    return result


def told_fields(mechanism: Mechanism) -> Mapping[str, tuple[str, str]]:
    """Return contact and name of each input that a mechanism was given, by its field.

    Drives have the names of their fields; the contact is empty where all are told.

    Examples
    --------
    >>> from stickslip.mechanisms import SpringBlock
    >>> told_fields(given_inputs(SpringBlock(mass=1.0), {"temperature": 20.0}))
    {'contact_temperature': ('', 'temperature')}
    """
    return {input_field(*at): at for at in getattr(mechanism, "told_inputs", ())}


def input_field(contact: str, name: str) -> str:
    """Return the field, and the drive, of an input that a mechanism is given.

    Examples
    --------
    >>> input_field("pad-2", "temperature")
    'contact_pad_2_temperature'
    """
    return "_".join(("contact", *re.findall(r"\w+", contact), name))


def _bare(kind: type[Mechanism]) -> type[Mechanism]:
    """Return the type of a mechanism without given inputs."""
    return getattr(kind, "told_of", kind)


@functools.cache
def _told(kind: type[Mechanism], inputs: tuple[tuple[str, str, bool], ...]) -> type[Mechanism]:
    """Return the type of a mechanism with contact inputs: numbers, and drives where it says so."""
    # Cached: mechanisms with the same inputs are of one type.
    moving = {input_field(contact, name) for contact, name, drive in inputs if drive}

    def drives(self: Any) -> Mapping[str, Drive]:
        return {**kind.drives(self), **{field: getattr(self, field) for field in sorted(moving)}}

    def contact_inputs(
        self: Any,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        result: dict[str, Any] = {**kind.contact_inputs(self, t, q, q_dot, drives)}
        for contact, name, _ in inputs:
            field = input_field(contact, name)
            value = drives[field] if field in moving else getattr(self, field)
            if contact:
                result[contact] = {**result.get(contact, {}), name: value}
            else:
                result[name] = value
        return result

    def reduce(self: Any) -> tuple[Any, ...]:  # a type that no module has
        return given_inputs, without_given(self)

    space = {
        "drives": drives,
        "contact_inputs": contact_inputs,
        "__reduce__": reduce,
        "told_of": kind,
        "told_inputs": tuple((contact, name) for contact, name, _ in inputs),
        "__module__": kind.__module__,
        "__doc__": kind.__doc__,
    }
    fields: list[tuple[str, Any]] = [
        (
            input_field(contact, name),
            Drive if drive else Annotated[float, CONTACT_INPUTS[name].quantity()],
        )
        for contact, name, drive in inputs
    ]
    made = dataclasses.make_dataclass(
        kind.__name__, fields, bases=(kind,), namespace=space, frozen=True, kw_only=True
    )
    made.__qualname__ = kind.__qualname__
    return made
