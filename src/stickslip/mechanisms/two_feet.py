"""A body that slides on two feet."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.maths import Scalar
from stickslip.mechanisms.base import Contact, ContactInputs, Mechanism, gear_inputs
from stickslip.quantities import Quantity


@final
@dataclass(frozen=True, kw_only=True)
class TwoFeet(Mechanism):
    """A body that slides on a front and a rear foot.

    Its height `y` and its tilt `phi` are held at 0, and what each foot carries follows from both:
    friction acts below the centre of mass, so that the front foot is pressed down while the body
    slides forward. A run ends where a foot lifts off. The spring and the drive act at the height
    of the centre of mass. The contacts are `front` and `rear`.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> body = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15)
    >>> laws = {
    ...     "front": Coulomb(kinetic_coefficient=0.6),
    ...     "rear": Coulomb(kinetic_coefficient=0.2),
    ... }
    >>> run = simulate(body, laws, t_end=1.0, y0={"v": 1.0})
    >>> run.at(0.1)["normal_force:front"].round(3), run.at(0.1)["normal_force:rear"].round(3)
    (array([10.256]), array([9.364]))
    """

    name: ClassVar[str] = "two-feet"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)
    moving_part: ClassVar[str] = "body"
    contact_names: ClassVar[str] = "front, rear"

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of the body."""
    front: Annotated[float, Quantity("a", "m", above=0)]
    """Distance of the front foot ahead of the centre of mass."""
    rear: Annotated[float, Quantity("b", "m", above=0)]
    """Distance of the rear foot behind it."""
    height: Annotated[float, Quantity("h", "m", low=0)] = 0.0
    """Height of the centre of mass above the ground."""
    stiffness: Annotated[float, Quantity("k", "N/m", low=0)] = 0.0
    """Spring towards x = 0."""
    damping: Annotated[float, Quantity("c", "N s/m", low=0)] = 0.0
    """Damper beside it."""
    drive: Drive | None = None
    """Force along the ground [N]."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        return 0.5 * self.mass * (q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"])

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        return self.mass * self.gravity * q["y"] + 0.5 * self.stiffness * q["x"] * q["x"]

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return {"x": drives.get("drive", 0.0) - self.damping * q_dot["x"]}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        slip = {"x": 1.0, "phi": self.height}
        return (
            Contact(slip=slip, normal={"y": 1.0, "phi": self.front}, name="front"),
            Contact(slip=slip, normal={"y": 1.0, "phi": -1.0 * self.rear}, name="rear"),
        )

    @override
    def held(self) -> tuple[str, ...]:
        return ("y", "phi")

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        others = -self.stiffness * q["x"] - self.damping * q_dot["x"]
        both = gear_inputs(drives.get("drive", 0.0), others, position=q["x"])
        return {"front": both, "rear": both}

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.drive is None else {"drive": self.drive}
