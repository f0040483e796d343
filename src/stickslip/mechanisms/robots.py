"""Robots of rigid links with friction in every joint: arms in a row, and trees of links."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.errors import ParameterError, UnknownNameError
from stickslip.maths import Scalar
from stickslip.mechanisms import rigid_bodies
from stickslip.mechanisms.base import BoundedMechanism, Contact, Stop, stops_between
from stickslip.mechanisms.drives import Drive
from stickslip.mechanisms.electric_motor import DCMotor, driving, driving_force, driving_inertia
from stickslip.quantities import Parametrised, Quantity, unchecked

T = TypeVar("T")


def checked_parts(owner: str, kind: type[T], parts: object, least: int) -> tuple[T, ...]:
    """Return the parts of a mechanism as a tuple; refuse those of another kind, or too few."""
    result = tuple(parts) if isinstance(parts, Iterable) else (parts,)
    if len(result) < least or not all(isinstance(part, kind) for part in result):
        raise ParameterError(
            f"{owner} must be at least {least} of {kind.__name__}(...) in a tuple, got {parts!r}."
        )
    return result


# An arm of links in a row, in a vertical plane.


@dataclass(frozen=True, kw_only=True)
class Link(Parametrised):
    """A link of an arm, with the joint at its upper end and the motor that turns it there.

    A motor sits on the link before its joint, or on the ground.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import Sine
    >>> Link(
    ...     mass=0.5,
    ...     length=0.3,
    ...     centre=0.15,
    ...     inertia=0.015,
    ...     torque=Sine(amplitude=2.0, frequency=1.0),
    ... ).centre
    0.15
    """

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass, what is fixed to the link included."""
    length: Annotated[float, Quantity("l", "m", above=0)]
    """Distance of the next joint; of the last link, that of its end, which matters to pictures."""
    centre: Annotated[float, Quantity("c", "m")]
    """Distance of the centre of mass from the joint, along the link."""
    inertia: Annotated[float, Quantity("J", "kg m^2", low=0)]
    """Moment of inertia about the joint."""
    rotor_inertia: Annotated[float, Quantity("J_r", "kg m^2", low=0)] = 0.0
    """Moment of inertia of the motor's rotor."""
    gear_ratio: Annotated[float, Quantity("n", above=0)] = 1.0
    """Speed of the motor over that of its joint."""
    damping: Annotated[float, Quantity("d", "N m s/rad", low=0)] = 0.0
    """Damper in the joint."""
    torque: Drive | DCMotor | None = None
    """Torque at the joint, behind the gear [N m]; or a `DCMotor`, which has rotor and gear."""

    def __post_init__(self) -> None:
        """Check that a rotor is given once."""
        super().__post_init__()
        if isinstance(self.torque, DCMotor) and (self.rotor_inertia or self.gear_ratio != 1.0):
            raise ParameterError(
                "Link.torque is a DCMotor, which has rotor_inertia (J_r) and gear_ratio (n) of its"
                " own: leave those of the Link out."
            )


def planar_bodies(links: Sequence[Link]) -> list[rigid_bodies.Body]:
    """Return links in a row, each along its x-axis, which turn about parallel axes."""
    result: list[rigid_bodies.Body] = []
    reach: Scalar = 0.0
    for i, link in enumerate(links):
        # Of motion in a plane, the inertia about the axis is all that counts.
        inertia = ((0.0,) * 3, (0.0,) * 3, (0.0, 0.0, link.inertia))
        place, moment = (reach, 0.0, 0.0), (link.mass * link.centre, 0.0, 0.0)
        motor = link.torque if isinstance(link.torque, DCMotor) else link
        rotor, gear = motor.rotor_inertia, motor.gear_ratio
        result.append(
            rigid_bodies.Body(
                i - 1, rigid_bodies.UNIT, place, link.mass, moment, inertia, rotor=rotor, gear=gear
            )
        )
        reach = link.length
    return result


@dataclass(frozen=True, kw_only=True)
class SerialArm(rigid_bodies.JointedMechanism):
    """Links in a row in a vertical plane, with friction in each joint.

    The angles `q1`, `q2` and so on are 0 where the arm hangs; each but the first is relative to the
    link before. The contacts are `joint-1`, `joint-2` and so on, with a load of 1, so that friction
    levels read as torques [N m]. `TwoLinkArm` is the arm with two links under names of its own.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> from stickslip.mechanisms import Link, SerialArm
    >>> arm = SerialArm(links=(Link(mass=0.5, length=0.3, centre=0.15, inertia=0.015),) * 3)
    >>> run = simulate(arm, Coulomb(kinetic_coefficient=0.2), t_end=2.0, y0={"q1": 1.0})
    >>> run.contacts, [event.contact for event in run.events][:3]
    (('joint-1', 'joint-2', 'joint-3'), ['joint-2', 'joint-2', 'joint-1'])
    """

    name: ClassVar[str] = "serial-arm"
    moving_part: ClassVar[str] = "arm"
    contact_names: ClassVar[str] = "joint-1, joint-2, ..."

    links: tuple[Link, ...]
    """The links in their order, one or more."""
    gravity: Annotated[float, Quantity("g", "m/s^2", low=0)] = 9.81
    """Acceleration of free fall; 0 where the arm moves in a horizontal plane."""

    def __post_init__(self) -> None:
        """Check the parameters and the links."""
        super().__post_init__()
        object.__setattr__(self, "links", checked_parts("SerialArm.links", Link, self.links, 1))

    @property
    @override
    def coordinates(self) -> tuple[str, ...]:  # type: ignore[override]  # of an instance
        """Angles of the joints."""
        return tuple(f"q{i + 1}" for i in range(len(self.links)))

    @property
    @override
    def rates(self) -> tuple[str, ...]:  # type: ignore[override]
        """Angular velocities of the joints."""
        return tuple(f"q{i + 1}_dot" for i in range(len(self.links)))

    @property
    @override
    def units(self) -> tuple[str, ...]:  # type: ignore[override]
        """SI units of the angles."""
        return ("rad",) * len(self.links)

    @override
    def bodies(self) -> Sequence[rigid_bodies.Body]:
        return planar_bodies(self.links)

    @override
    def free_fall(self) -> rigid_bodies.Vector:
        return (self.gravity, 0.0, 0.0)

    @override
    def motors(
        self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar], drives: Mapping[str, Scalar]
    ) -> Mapping[str, Scalar]:
        return {
            name: driving_force(link.torque, drives, q[name], q_dot[name], f"torque-{i + 1}")
            for i, (name, link) in enumerate(zip(self.coordinates, self.links, strict=True))
        }

    @override
    def damped(self, q_dot: Mapping[str, Scalar]) -> Mapping[str, Scalar]:
        pairs = zip(self.coordinates, self.links, strict=True)
        return {name: -1.0 * link.damping * q_dot[name] for name, link in pairs}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return tuple(
            Contact(name=f"joint-{i + 1}", slip=name, load=1.0)
            for i, name in enumerate(self.coordinates)
        )

    @override
    def drives(self) -> Mapping[str, Drive]:
        result: dict[str, Drive] = {}
        for i, link in enumerate(self.links):
            result |= driving(link.torque, f"torque-{i + 1}")
        return result


# An arm with two revolute joints.


@dataclass(frozen=True, kw_only=True)
class TwoLinkArm(rigid_bodies.JointedMechanism):
    """Two links in a vertical plane with friction in both joints.

    Both angles are 0 where the arm hangs; that of the elbow is relative to the upper link. Drives
    are torques at the joints, behind the gears. The load of both contacts is 1, so that friction
    levels read as torques [N m]. The motor of the elbow sits at the shoulder or in the upper link
    and turns with the elbow's angle times the gear ratio.

    What a motion can tell is the moment of inertia of each link about its joint, the products of
    mass and distance of the centre of mass, and the inertia of the rotors. With masses and the
    upper length known, all of these are linear in ``upper_centre``, ``upper_inertia``,
    ``lower_centre``, ``lower_inertia`` and ``rotor_inertia``, which `fit` identifies.

    Source: M. W. Spong, S. Hutchinson, M. Vidyasagar, "Robot Modeling and Control", 2006.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> arm = TwoLinkArm(
    ...     upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
    ...     lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03,
    ... )  # fmt: skip
    >>> laws = {
    ...     "shoulder": Coulomb(kinetic_coefficient=0.2),
    ...     "elbow": Coulomb(kinetic_coefficient=0.1),
    ... }
    >>> simulate(arm, laws, t_end=30.0, y0={"shoulder": 1.0}).status.name
    'AT_REST'
    """

    name: ClassVar[str] = "two-link-arm"
    coordinates: ClassVar[tuple[str, ...]] = ("shoulder", "elbow")
    rates: ClassVar[tuple[str, ...]] = ("shoulder_dot", "elbow_dot")
    units: ClassVar[tuple[str, ...]] = ("rad", "rad")
    contact_names: ClassVar[str] = "shoulder, elbow"
    moving_part: ClassVar[str] = "arm"

    upper_mass: Annotated[float, Quantity("m_1", "kg", above=0)]
    """Mass of the upper link, what is fixed to it included."""
    upper_length: Annotated[float, Quantity("l_1", "m", above=0)]
    """Distance of the elbow from the shoulder."""
    upper_centre: Annotated[float, Quantity("c_1", "m")]
    """Distance of the upper link's centre of mass from the shoulder, towards the elbow."""
    upper_inertia: Annotated[float, Quantity("J_1", "kg m^2", low=0)]
    """Moment of inertia of the upper link about the shoulder."""
    lower_mass: Annotated[float, Quantity("m_2", "kg", above=0)]
    """Mass of the lower link."""
    lower_centre: Annotated[float, Quantity("c_2", "m")]
    """Distance of the lower link's centre of mass from the elbow."""
    lower_inertia: Annotated[float, Quantity("J_2", "kg m^2", low=0)]
    """Moment of inertia of the lower link about the elbow."""
    rotor_inertia: Annotated[float, Quantity("J_r", "kg m^2", low=0)] = 0.0
    """Moment of inertia of each motor's rotor."""
    gear_ratio: Annotated[float, Quantity("n", above=0)] = 1.0
    """Speed of a motor over that of its joint."""
    shoulder_drive: Drive | None = None
    """Torque at the shoulder [N m]."""
    elbow_drive: Drive | None = None
    """Torque at the elbow [N m]."""
    gravity: Annotated[float, Quantity("g", "m/s^2", low=0)] = 9.81
    """Acceleration of free fall."""

    @override
    def bodies(self) -> Sequence[rigid_bodies.Body]:
        motor = {"rotor_inertia": self.rotor_inertia, "gear_ratio": self.gear_ratio}
        upper = unchecked(
            Link,
            mass=self.upper_mass,
            length=self.upper_length,
            centre=self.upper_centre,
            inertia=self.upper_inertia,
            torque=None,
            **motor,
        )
        lower = unchecked(
            Link,
            mass=self.lower_mass,
            length=0.0,  # nothing is joined behind it
            centre=self.lower_centre,
            inertia=self.lower_inertia,
            torque=None,
            **motor,
        )
        return planar_bodies((upper, lower))

    @override
    def free_fall(self) -> rigid_bodies.Vector:
        return (self.gravity, 0.0, 0.0)

    @override
    def motors(
        self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar], drives: Mapping[str, Scalar]
    ) -> Mapping[str, Scalar]:
        return {name: drives.get(f"{name}_drive", 0.0) for name in self.coordinates}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return tuple(Contact(name=name, slip=name, load=1.0) for name in self.coordinates)

    @override
    def drives(self) -> Mapping[str, Drive]:
        shoulder = driving(self.shoulder_drive, "shoulder_drive")
        return {**shoulder, **driving(self.elbow_drive, "elbow_drive")}


# A robot of rigid links in a tree, with friction in every joint.

EXACT = 1e-15
"""Entries of rotations this near to -1, 0 or 1 are taken for it, so that terms drop out."""
COLUMNS = ("t", "mode", "friction", "normal_force")
"""Names that columns of runs have; a coordinate that would have one gets ``_joint`` behind it."""
ENTRIES = ("xx", "yy", "zz", "xy", "xz", "yz")
"""Entries of an inertia."""
SMALLEST = 1e-12
"""Share of the largest entry that a pivot of a mass matrix may not fall below."""


def _added(symbol: str, unit: str, of_slides: str = "") -> Quantity:
    """Return the quantity of what fits of links find."""
    return Quantity(symbol, unit, structural=True, nuisance=True, or_unit=of_slides)


def coordinate_of(joint: str) -> str:
    """Return the name of the coordinate of a joint.

    Examples
    --------
    >>> coordinate_of("left/elbow-joint"), coordinate_of("mode")
    ('left_elbow_joint', 'mode_joint')
    """
    name = re.sub(r"\W+", "_", joint, flags=re.ASCII).strip("_")
    return f"{name}_joint" if name in COLUMNS else name


@dataclass(frozen=True, kw_only=True)
class RobotJoint(Parametrised):
    """A joint of a robot and the link that it carries, with what is fixed to that link.

    The link's axes are at the joint. Numbers of inertia, centre, damping and armature that are 0 or
    whole stand in the equations as they are, which makes them shorter; others are parameters.

    Examples
    --------
    >>> hinge = RobotJoint(joint="hinge", mass=2.0, centre_x=0.1, inertia_zz=0.03, axis=(0, 0, 1))
    >>> hinge.contact_name
    'hinge'
    """

    joint: str
    """Name of the joint."""
    kind: Literal["revolute", "prismatic"] = "revolute"
    """Whether it turns about its axis or slides along it."""
    parent: str = ""
    """Name of the joint whose link carries this one; the ground if empty."""
    place: tuple[float, ...] = (0.0, 0.0, 0.0)
    """Place of the joint at 0, in axes of the link that carries it [m]."""
    orientation: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    """Axes of the link while the joint is at 0: the rotation that takes its vectors to axes of the
    link that carries it, nine numbers row by row."""
    axis: tuple[float, ...] = (0.0, 0.0, 1.0)
    """Axis of the joint, in axes of the link; its length does not matter."""
    mass: Annotated[float, Quantity("m", "kg", low=0)]
    """Mass of the link."""
    centre_x: Annotated[float, Quantity("c_x", "m", structural=True)] = 0.0
    """Centre of mass."""
    centre_y: Annotated[float, Quantity("c_y", "m", structural=True)] = 0.0
    """Centre of mass."""
    centre_z: Annotated[float, Quantity("c_z", "m", structural=True)] = 0.0
    """Centre of mass."""
    inertia_xx: Annotated[float, Quantity("J_xx", "kg m^2", low=0, structural=True)] = 0.0
    """Moment of inertia about the x-axis through the centre of mass."""
    inertia_yy: Annotated[float, Quantity("J_yy", "kg m^2", low=0, structural=True)] = 0.0
    """Moment of inertia about the y-axis through the centre of mass."""
    inertia_zz: Annotated[float, Quantity("J_zz", "kg m^2", low=0, structural=True)] = 0.0
    """Moment of inertia about the z-axis through the centre of mass."""
    inertia_xy: Annotated[float, Quantity("J_xy", "kg m^2", structural=True)] = 0.0
    """Product of inertia about the centre of mass, with the sign of the matrix entry."""
    inertia_xz: Annotated[float, Quantity("J_xz", "kg m^2", structural=True)] = 0.0
    """Product of inertia about the centre of mass, with the sign of the matrix entry."""
    inertia_yz: Annotated[float, Quantity("J_yz", "kg m^2", structural=True)] = 0.0
    """Product of inertia about the centre of mass, with the sign of the matrix entry."""
    added_moment_x: Annotated[float, _added("h_x", "kg m")] = 0.0
    """First moment of mass that a fit of the links adds to mass times centre."""
    added_moment_y: Annotated[float, _added("h_y", "kg m")] = 0.0
    """First moment of mass that a fit of the links adds to mass times centre."""
    added_moment_z: Annotated[float, _added("h_z", "kg m")] = 0.0
    """First moment of mass that a fit of the links adds to mass times centre."""
    added_inertia_xx: Annotated[float, _added("L_xx", "kg m^2")] = 0.0
    """Entry of the inertia about the joint that a fit of the links adds."""
    added_inertia_yy: Annotated[float, _added("L_yy", "kg m^2")] = 0.0
    """Entry of the inertia about the joint that a fit of the links adds."""
    added_inertia_zz: Annotated[float, _added("L_zz", "kg m^2")] = 0.0
    """Entry of the inertia about the joint that a fit of the links adds."""
    added_inertia_xy: Annotated[float, _added("L_xy", "kg m^2")] = 0.0
    """Entry of the inertia about the joint that a fit of the links adds."""
    added_inertia_xz: Annotated[float, _added("L_xz", "kg m^2")] = 0.0
    """Entry of the inertia about the joint that a fit of the links adds."""
    added_inertia_yz: Annotated[float, _added("L_yz", "kg m^2")] = 0.0
    """Entry of the inertia about the joint that a fit of the links adds."""
    added_armature: Annotated[float, _added("I_a", "kg m^2", "kg")] = 0.0
    """Inertia that a fit of the links adds to the armature."""
    damping: Annotated[
        float, Quantity("d", "N m s/rad", low=0, or_unit="N s/m", structural=True)
    ] = 0.0
    """Damper in the joint."""
    armature: Annotated[float, Quantity("J_a", "kg m^2", low=0, or_unit="kg", structural=True)] = (
        0.0
    )
    """Inertia of motor and gear as it acts on the joint: that of the rotor times the square of the
    gear ratio. What the rotor's spin does to other joints is neglected."""
    coupling: Mapping[str, float] | tuple[tuple[str, float], ...] = ()
    """Joints before this one that turn its motor too, and how far: the coordinate is the angle of
    the joint plus these multiples of theirs, as in wrists whose motors sit behind other joints.
    Friction, effort, damper and armature act along the coordinate."""
    effort: Drive | DCMotor | None = None
    """Torque [N m] or force [N] at the joint, behind the gear; or a `DCMotor`, whose rotor adds to
    the armature."""
    lower_stop: Annotated[float, Quantity("q_l", "rad", or_unit="m")] | None = None
    """Hard stop that the joint does not fall below; none if not given."""
    upper_stop: Annotated[float, Quantity("q_u", "rad", or_unit="m")] | None = None
    """Hard stop that the joint does not rise above; none if not given."""
    restitution: Annotated[float, Quantity("e", low=0, high=1)] = 0.0
    """Speed after an impact on a stop over the speed before."""

    def __post_init__(self) -> None:
        """Check the parameters and the geometry."""
        super().__post_init__()
        owner = f"RobotJoint {self.joint!r}"
        if not re.search(r"[A-Za-z]", str(self.joint)):
            raise ParameterError(
                f"RobotJoint.joint must be a name with letters from a to z, got {self.joint!r}."
            )
        if self.kind not in ("revolute", "prismatic"):
            raise ParameterError(
                f"{owner}: kind must be 'revolute' or 'prismatic', got {self.kind!r}."
            )
        for name, count in (("place", 3), ("orientation", 9), ("axis", 3)):
            object.__setattr__(self, name, _numbers(owner, name, getattr(self, name), count))
        if not sum(x * x for x in self.axis):
            raise ParameterError(f"{owner}: axis must not be (0, 0, 0).")
        object.__setattr__(self, "coupling", self._coupled())
        if self.coupling and (self.lower_stop, self.upper_stop) != (None, None):
            raise ParameterError(
                f"{owner}: a joint with a coupling takes no lower_stop or upper_stop, which would"
                " be of its angle and not of the coordinate: leave them out."
            )
        rows: NDArray[np.float64] = np.array(self.rotation)
        if np.abs(rows @ rows.T - np.eye(3)).max() > 1e-6 or np.linalg.det(rows) < 0.0:
            raise ParameterError(
                f"{owner}: orientation must be a rotation matrix, got {self.orientation}."
            )

    def _coupled(self) -> tuple[tuple[str, float], ...]:
        """Return names and multiples of the coupling, which may be given as a mapping."""
        given = self.coupling
        try:
            result = tuple((str(name), float(factor)) for name, factor in dict(given).items())
        except (TypeError, ValueError):
            result = ((self.joint, math.nan),)
        if not all(name != self.joint and abs(factor) < 1e9 for name, factor in result):
            raise ParameterError(
                f"RobotJoint {self.joint!r}: coupling must be multiples below 1e9 by other joint,"
                f" such as {{'elbow': 1.0}}, got {given!r}."
            )
        return result

    @property
    def rotation(self) -> rigid_bodies.Matrix:
        """The orientation as rows."""
        a = self.orientation
        return (a[0], a[1], a[2]), (a[3], a[4], a[5]), (a[6], a[7], a[8])

    @property
    def coordinate(self) -> str:
        """Name of the joint's coordinate."""
        return coordinate_of(self.joint)

    @property
    def contact_name(self) -> str:
        """Name of the contact in the joint."""
        name = "-".join(re.findall(r"[a-z0-9]+", self.joint.lower()))
        return name if name[0].isalpha() else f"joint-{name}"

    @property
    def own_axes(self) -> rigid_bodies.Matrix:
        """Axes of `body`, row by row, in those of the link: the third is the joint's."""
        return _with_z_along(self.axis)

    def body(self, parent: int, carrier_axes: rigid_bodies.Matrix) -> rigid_bodies.Body:
        """Return the link as a body whose z-axis is that of the joint.

        Parameters
        ----------
        parent : int
            Index of the body that carries it.
        carrier_axes : matrix
            Axes of that body, row by row, in those of its link.

        Returns
        -------
        Body
            The body.
        """
        axes = self.own_axes
        frame = tuple(
            rigid_bodies.times(carrier_axes, rigid_bodies.times(self.rotation, row)) for row in axes
        )
        centre = (self.centre_x, self.centre_y, self.centre_z)
        more = (self.added_moment_x, self.added_moment_y, self.added_moment_z)
        moment = rigid_bodies.plus([self.mass * c for c in centre], more)
        own, added = (
            rigid_bodies.symmetric(*(getattr(self, f"{name}_{entry}") for entry in ENTRIES))
            for name in ("inertia", "added_inertia")
        )
        # About the joint: that about the centre of mass, and mass times distance squared.
        inertia = rigid_bodies.both(
            rigid_bodies.both(own, rigid_bodies.about(self.mass, rigid_bodies.NONE, centre)), added
        )
        return rigid_bodies.Body(
            parent,
            tuple(tuple(map(_exact, row)) for row in frame),
            rigid_bodies.times(carrier_axes, self.place),
            self.mass,
            rigid_bodies.times(axes, moment),
            rigid_bodies.turned(axes, inertia),
            slides=self.kind == "prismatic",
            armature=self.armature + self.added_armature + driving_inertia(self.effort),
        )


def _numbers(owner: str, name: str, given: object, count: int) -> tuple[float, ...]:
    """Return so many finite numbers."""
    try:
        result = tuple(float(x) for x in given)  # type: ignore[attr-defined]  # or it is refused
    except (TypeError, ValueError):
        result = ()
    if len(result) != count or not all(abs(x) < 1e9 for x in result):
        raise ParameterError(f"{owner}: {name} must be {count} numbers below 1e9, got {given!r}.")
    return result


def _exact(x: float) -> float:
    """Return an entry of a rotation, -1, 0 or 1 where it is one but for roundings."""
    return float(round(x)) if abs(x - round(x)) < EXACT else x


def _with_z_along(axis: Sequence[float]) -> rigid_bodies.Matrix:
    """Return axes, row by row, whose third is along a given one.

    Along one of the old axes the others are old ones too, so that nothing but their names changes.
    """
    size = sum(x * x for x in axis) ** 0.5
    z = [_exact(x / size) for x in axis]
    most = max(range(3), key=lambda i: abs(z[i]))
    helper = [float(i == (most + 2) % 3) for i in range(3)]
    x = _crossed(helper, z)
    size = sum(k * k for k in x) ** 0.5
    x = [_exact(k / size) for k in x]
    return tuple(x), tuple(map(_exact, _crossed(z, x))), tuple(z)


def _crossed(a: Sequence[float], b: Sequence[float]) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


@dataclass(frozen=True, kw_only=True)
class Robot(BoundedMechanism, rigid_bodies.JointedMechanism):
    """Rigid links in a tree, joined by joints that turn or slide, with friction in each.

    `read_urdf` makes one of a robot description. Coordinates have the names of the joints, with
    ``_dot`` for their rates, and contacts the same names in kebab case, with a load of 1, so that
    friction levels read as torques [N m] or forces [N]. Gravity points along -z of the ground.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> from stickslip.mechanisms import RobotJoint
    >>> door = Robot(joints=(RobotJoint(joint="Hinge", mass=20.0, centre_x=0.4, inertia_zz=1.3),))
    >>> run = simulate(door, Coulomb(kinetic_coefficient=3.0), t_end=9.0, y0={"Hinge_dot": 2.0})
    >>> round(float(run["Hinge"][-1]), 9)  # J omega^2 / (2 M), J = 4.5 kg m^2
    3.0
    """

    name: ClassVar[str] = "robot"
    moving_part: ClassVar[str] = "robot"
    contact_names: ClassVar[str] = "the joints"

    joints: tuple[RobotJoint, ...]
    """The joints, each behind the one that carries it."""
    gravity: Annotated[float, Quantity("g", "m/s^2", low=0)] = 9.81
    """Acceleration of free fall."""

    def __post_init__(self) -> None:
        """Check that the joints form a tree and that each moves something."""
        super().__post_init__()
        joints = checked_parts("Robot.joints", RobotJoint, self.joints, 1)
        object.__setattr__(self, "joints", joints)
        seen: dict[str, RobotJoint] = {}
        for joint in joints:
            if joint.parent and joint.parent not in seen:
                raise UnknownNameError(
                    f"parent of Robot joint {joint.joint!r}, which must stand before it:",
                    joint.parent,
                    seen,
                )
            for name in dict(joint.coupling):
                if name not in seen:
                    raise UnknownNameError(
                        f"joint in the coupling of {joint.joint!r}, which must stand before it:",
                        name,
                        seen,
                    )
            seen[joint.joint] = joint
        states = (*self.coordinates, *self.rates)
        for names in ([j.joint for j in joints], states, self._names()):
            twice = sorted({name for name in names if names.count(name) > 1})
            if twice:
                raise ParameterError(
                    f"Robot: two joints, or a joint and a rate, are called {twice[0]!r}: rename"
                    " one."
                )
        self._check_masses()

    def _check_masses(self) -> None:
        """Refuse a joint that moves no mass: its acceleration would not be determined."""
        # Away from 0, where links may line up so that a joint moves nothing in that pose alone.
        places = [0.3 + 0.1 * i for i in range(len(self.joints))]
        rows = [
            [float(x) for x in row] for row in rigid_bodies.mass_matrix_of(self.bodies(), places)
        ]
        largest = max(rows[i][i] for i in range(len(rows)))
        # elimination from the ends of the tree: a pivot is what a joint moves by itself
        for k in reversed(range(len(rows))):
            pivot = rows[k][k]
            if not pivot > SMALLEST * largest:
                raise ParameterError(
                    f"Robot: the joint {self.joints[k].joint!r} moves no mass or inertia"
                    f" ({pivot:.3g} of {largest:.3g}): give the links behind it theirs, or lock the"
                    " joint."
                )
            for i in range(k):
                share = rows[i][k] / pivot
                for j in range(k):
                    rows[i][j] -= share * rows[k][j]

    def _names(self) -> tuple[str, ...]:
        return tuple(joint.contact_name for joint in self.joints)

    @property
    @override
    def coordinates(self) -> tuple[str, ...]:  # type: ignore[override]  # of an instance
        """Angles and places of the joints."""
        return tuple(joint.coordinate for joint in self.joints)

    @property
    @override
    def rates(self) -> tuple[str, ...]:  # type: ignore[override]
        """Their rates."""
        return tuple(f"{name}_dot" for name in self.coordinates)

    @property
    @override
    def units(self) -> tuple[str, ...]:  # type: ignore[override]
        """SI units of the coordinates."""
        return tuple("m" if joint.kind == "prismatic" else "rad" for joint in self.joints)

    @override
    def bodies(self) -> Sequence[rigid_bodies.Body]:
        index = {joint.joint: i for i, joint in enumerate(self.joints)}
        index[""] = rigid_bodies.BASE
        axes = {joint.joint: joint.own_axes for joint in self.joints} | {"": rigid_bodies.UNIT}
        return [joint.body(index[joint.parent], axes[joint.parent]) for joint in self.joints]

    @override
    def transmission(self) -> Sequence[Sequence[float]] | None:
        if not any(joint.coupling for joint in self.joints):
            return None
        rows: dict[str, list[float]] = {}
        for i, joint in enumerate(self.joints):
            row = [float(i == j) for j in range(len(self.joints))]
            for name, factor in dict(joint.coupling).items():
                # The coordinate is the angle plus these multiples: the angle is the coordinate less
                # them.
                row = [a - factor * b for a, b in zip(row, rows[name], strict=True)]
            rows[joint.joint] = row
        return list(rows.values())

    @override
    def free_fall(self) -> rigid_bodies.Vector:
        return (0.0, 0.0, -1.0 * self.gravity)

    @override
    def motors(
        self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar], drives: Mapping[str, Scalar]
    ) -> Mapping[str, Scalar]:
        result = {}
        for joint in self.joints:
            x, name = joint.coordinate, f"effort-{joint.contact_name}"
            result[x] = driving_force(joint.effort, drives, q[x], q_dot[x], name)
        return result

    @override
    def damped(self, q_dot: Mapping[str, Scalar]) -> Mapping[str, Scalar]:
        return {
            joint.coordinate: -1.0 * joint.damping * q_dot[joint.coordinate]
            for joint in self.joints
        }

    @override
    def start(self) -> Mapping[str, Scalar]:
        """Return the middle of the range of joints whose stops exclude 0."""
        result: dict[str, Scalar] = {}
        for joint in self.joints:
            low, high = joint.lower_stop, joint.upper_stop
            if (low is not None and low > 0.0) or (high is not None and high < 0.0):
                ends = [end for end in (low, high) if end is not None]
                result[joint.coordinate] = sum(ends) / len(ends)
        return result

    @override
    def stops(self) -> tuple[Stop, ...]:
        return tuple(
            stop
            for joint in self.joints
            for stop in stops_between(
                joint.coordinate, joint.lower_stop, joint.upper_stop, joint.restitution
            )
        )

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return tuple(
            Contact(name=joint.contact_name, slip=joint.coordinate, load=1.0)
            for joint in self.joints
        )

    @override
    def drives(self) -> Mapping[str, Drive]:
        result: dict[str, Drive] = {}
        for joint in self.joints:
            result |= driving(joint.effort, f"effort-{joint.contact_name}")
        return result
