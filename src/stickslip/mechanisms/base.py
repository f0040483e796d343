"""What a mechanism is: energies, forces, and the contacts at which it rubs."""

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Literal, TypeAlias, final

from typing_extensions import override

from stickslip.described import Described
from stickslip.drives import Drive
from stickslip.errors import ParameterError, UnknownNameError
from stickslip.formatting import number
from stickslip.maths import Scalar, cos, sin
from stickslip.quantities import (
    Parametrised,
    Quantity,
    all_paths,
    full_path,
    is_rotary,
    motion_kinds,
)

Incline: TypeAlias = Annotated[float, Quantity("beta", "rad", low=-1.57, high=1.57)]
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
class Mechanism(Parametrised, ABC):
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
        t: Scalar,  # noqa: ARG002  # for those whose loads change
        q: Mapping[str, Scalar],  # noqa: ARG002
        q_dot: Mapping[str, Scalar],  # noqa: ARG002
        drives: Mapping[str, Scalar],  # noqa: ARG002
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
        t: Scalar,  # noqa: ARG002  # for those that can tell
        q: Mapping[str, Scalar],  # noqa: ARG002
        q_dot: Mapping[str, Scalar],  # noqa: ARG002
        drives: Mapping[str, Scalar],  # noqa: ARG002
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

    def guided(self) -> Mapping[str, Guide]:
        """Return the coordinates whose acceleration is prescribed, by coordinate."""
        return {}

    def held(self) -> tuple[str, ...]:
        """Return coordinates held at 0 beside the contact's normal one, for their reactions."""
        return ()

    def limits(
        self,
        forces: Mapping[str, Scalar],  # noqa: ARG002  # for those that have limits
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
    on the contact is neglected.
    """

    @override
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

    @override
    def __post_init__(self) -> None:
        """Check the parameters, and that their units are of one kind of motion."""
        if not isinstance(self.rotary, bool):
            raise ParameterError(
                f"{type(self).__name__}.rotary must be True or False, got {self.rotary!r}."
            )
        kinds = motion_kinds(type(self), vars(self))
        object.__setattr__(self, "rotary", is_rotary(kinds, True if self.rotary else None))
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
    found: dict[str, float] = {}
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
        if stop.coordinate in found:
            raise ParameterError(f"{owner} is given twice; give it once.")
        found[stop.coordinate] = stop.position
    return found


def stops_between(
    coordinate: str, lower: Scalar | None, upper: Scalar | None, restitution: Scalar
) -> tuple[Stop, ...]:
    """Return the stops of a coordinate that are fitted: those whose position is not None.

    Examples
    --------
    >>> [stop.side for stop in stops_between("x", None, 0.1, 0.5)]
    ['upper']
    """
    below = Stop(coordinate=coordinate, position=lower, side="lower", restitution=restitution)
    above = Stop(coordinate=coordinate, position=upper, side="upper", restitution=restitution)
    return tuple(stop for stop in (below, above) if stop.position is not None)


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
        t: Scalar,  # noqa: ARG002
        q: Mapping[str, Scalar],  # noqa: ARG002
        q_dot: Mapping[str, Scalar],  # noqa: ARG002
        drives: Mapping[str, Scalar],  # noqa: ARG002
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
    return full_path(path, all_paths(mechanism, PREFIX))


def quantity_at(mechanism: Mechanism, path: str) -> Quantity:
    """Return the quantity at a full path, or say which known paths are nearest."""
    known = all_paths(mechanism, PREFIX)
    if path not in known:
        raise UnknownNameError("parameter", path, known)
    return known[path]
