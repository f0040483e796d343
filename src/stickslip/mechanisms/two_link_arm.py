"""An arm with two revolute joints."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.maths import Scalar
from stickslip.mechanisms.base import Contact
from stickslip.mechanisms.rigid_bodies import Body, JointedMechanism, Vector
from stickslip.mechanisms.serial_arm import Link, planar_bodies
from stickslip.quantities import Quantity, unchecked


@final
@dataclass(frozen=True, kw_only=True)
class TwoLinkArm(JointedMechanism):
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
    def bodies(self) -> Sequence[Body]:
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
            length=0.0,
            centre=self.lower_centre,
            inertia=self.lower_inertia,
            torque=None,
            **motor,
        )
        return planar_bodies((upper, lower))

    @override
    def free_fall(self) -> Vector:
        return (self.gravity, 0.0, 0.0)

    @override
    def motors(
        self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar], drives: Mapping[str, Scalar]
    ) -> Mapping[str, Scalar]:
        return {name: drives.get(f"{name}_drive", 0.0) for name in self.coordinates}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (
            Contact(name="shoulder", slip="shoulder", load=1.0),
            Contact(name="elbow", slip="elbow", load=1.0),
        )

    @override
    def drives(self) -> Mapping[str, Drive]:
        given = {"shoulder_drive": self.shoulder_drive, "elbow_drive": self.elbow_drive}
        return {name: drive for name, drive in given.items() if drive is not None}
