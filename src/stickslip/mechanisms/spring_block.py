"""A block on rough ground, shot off by a spring or pushed by a force."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.errors import ParameterError
from stickslip.formatting import number
from stickslip.maths import Scalar, sin, where
from stickslip.mechanisms.base import (
    BoundedMechanism,
    Contact,
    ContactInputs,
    Incline,
    Stop,
    gear_inputs,
    height,
    stops_between,
)
from stickslip.quantities import Quantity


@final
@dataclass(frozen=True, kw_only=True)
class SpringBlock(BoundedMechanism):
    """A block that a compressed spring, a force, or both set in motion.

    The state `x` is the travel from the start, where the block is at rest. The spring pushes with
    ``stiffness * (compression - x)``; unless it is attached it only pushes, and the block leaves it
    at its natural length. A negative compression is a spring on the other side; a spring that is
    neither compressed nor attached is not touched.

    On an incline the block is pressed on the ground by ``mass * gravity * cos(incline)`` and pulled
    towards negative x by ``mass * gravity * sin(incline)``: positive x is uphill.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> round(float(run["x"][-1]), 7)
    0.2038736
    """

    name: ClassVar[str] = "spring-block"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)
    moving_part: ClassVar[str] = "block"

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of the block."""
    stiffness: Annotated[float, Quantity("k", "N/m", low=0)] = 0.0
    """Stiffness of the spring."""
    compression: Annotated[float, Quantity("x_0", "m")] = 0.0
    """How far the spring is compressed at the start."""
    attached: bool = False
    """Whether the block stays fastened to the spring and is pulled back by it."""
    drive: Drive | None = None
    """Force on the block [N]."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""
    incline: Incline = 0.0
    """Angle of the ground from the horizontal; where it is positive, positive x is uphill."""
    lower_stop: Annotated[float, Quantity("x_l", "m")] | None = None
    """Hard stop that x does not fall below; none if not given."""
    upper_stop: Annotated[float, Quantity("x_u", "m")] | None = None
    """Hard stop that x does not rise above; none if not given."""
    restitution: Annotated[float, Quantity("e", low=0, high=1)] = 0.0
    """Speed after an impact at a stop over the speed before; 0 if nothing bounces."""

    @override
    def __post_init__(self) -> None:
        """Check the parameters, and that a compressed spring is there."""
        super().__post_init__()
        if self.compression != 0 and self.stiffness == 0:
            raise ParameterError(
                f"SpringBlock.compression (x_0) is {number(self.compression, 6)} m but stiffness"
                " (k) is 0: there is no spring to compress. Give a stiffness above 0 N/m, or no"
                " compression."
            )
        if self.attached and self.stiffness == 0:
            raise ParameterError(
                "SpringBlock.attached is true but stiffness (k) is 0: there is no spring to attach"
                " to. Give a stiffness above 0 N/m, or attached=False."
            )

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        m = self.mass
        return 0.5 * m * (q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"])

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        m, g, k, gap = self.mass, self.gravity, self.stiffness, self.compression - q["x"]
        spring = self._touching(gap, 0.5 * k * gap * gap)
        return m * g * height(self.incline, q["x"], q["y"]) + spring

    def _touching(self, gap: Scalar, of_spring: Scalar) -> Scalar:
        """Return what the spring does: nothing where the block has left it."""
        if self.attached:
            return of_spring
        pushes = gap * self.compression > 0.0
        return where(pushes, of_spring, 0.0, ("spring touches", "block leaves the spring"))

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return {"x": drives.get("drive", 0.0)}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", normal="y"),)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        gap = self.compression - q["x"]
        weight = -self.mass * self.gravity * sin(self.incline)
        return gear_inputs(
            drives.get("drive", 0.0),
            self._touching(gap, self.stiffness * gap) + weight,
            gravity=weight,
            position=q["x"],
        )

    @override
    def stops(self) -> tuple[Stop, ...]:
        return stops_between("x", self.lower_stop, self.upper_stop, self.restitution)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.drive is None else {"drive": self.drive}
