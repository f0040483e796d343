"""An arm of links in a row, in a vertical plane."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.errors import ParameterError
from stickslip.maths import Scalar
from stickslip.mechanisms.base import Contact
from stickslip.mechanisms.electric_motor import DCMotor, driving, driving_force
from stickslip.mechanisms.lining import checked_parts
from stickslip.mechanisms.rigid_bodies import UNIT, Body, JointedMechanism, Vector
from stickslip.quantities import Parametrised, Quantity


@final
@dataclass(frozen=True, kw_only=True)
class Link(Parametrised):
    """A link of an arm, with the joint at its upper end and the motor that turns it there.

    A motor sits on the link before its joint, or on the ground.

    Examples
    --------
    >>> from stickslip.drives import Sine
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

    @override
    def __post_init__(self) -> None:
        """Check that a rotor is given once."""
        super().__post_init__()
        if isinstance(self.torque, DCMotor) and (self.rotor_inertia or self.gear_ratio != 1.0):
            raise ParameterError(
                "Link.torque is a DCMotor, which has rotor_inertia (J_r) and gear_ratio (n) of its"
                " own: leave those of the Link out."
            )


def planar_bodies(links: Sequence[Link]) -> list[Body]:
    """Return links in a row, each along its x-axis, which turn about parallel axes."""
    found: list[Body] = []
    reach: Scalar = 0.0
    for i, link in enumerate(links):
        inertia = ((0.0,) * 3, (0.0,) * 3, (0.0, 0.0, link.inertia))
        place, moment = (reach, 0.0, 0.0), (link.mass * link.centre, 0.0, 0.0)
        motor = link.torque if isinstance(link.torque, DCMotor) else link
        rotor, gear = motor.rotor_inertia, motor.gear_ratio
        found.append(Body(i - 1, UNIT, place, link.mass, moment, inertia, rotor=rotor, gear=gear))
        reach = link.length
    return found


@final
@dataclass(frozen=True, kw_only=True)
class SerialArm(JointedMechanism):
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

    @override
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
    def bodies(self) -> Sequence[Body]:
        return planar_bodies(self.links)

    @override
    def free_fall(self) -> Vector:
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
        found: dict[str, Drive] = {}
        for i, link in enumerate(self.links):
            found |= driving(link.torque, f"torque-{i + 1}")
        return found
