"""A disc and the pads that brake it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.maths import Scalar
from stickslip.mechanisms.base import Contact, ContactInputs, Mechanism, gear_inputs
from stickslip.mechanisms.lining import Lining, checked_parts, pressing_drives, pressing_forces
from stickslip.quantities import Quantity


@final
@dataclass(frozen=True, kw_only=True)
class DiscBrake(Mechanism):
    """A disc that pads brake, each at its radius.

    The contacts are `pad-1`, `pad-2` and so on. While the pads hold the disc, they share the torque
    that this takes in proportion to the torques at which they would break away.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> from stickslip.mechanisms import Lining
    >>> brake = DiscBrake(
    ...     inertia=0.5, pads=(Lining(radius=0.10, load=100.0), Lining(radius=0.12, load=80.0))
    ... )
    >>> run = simulate(brake, Coulomb(kinetic_coefficient=0.4), t_end=2.0, y0={"omega": 20.0})
    >>> round(float(run["phi"][-1]), 9)  # 0.5 J omega^2 over the torque
    12.755102041
    """

    name: ClassVar[str] = "disc-brake"
    coordinates: ClassVar[tuple[str, ...]] = ("phi",)
    rates: ClassVar[tuple[str, ...]] = ("omega",)
    units: ClassVar[tuple[str, ...]] = ("rad",)
    moving_part: ClassVar[str] = "disc"
    contact_names: ClassVar[str] = "pad-1, pad-2, ..."

    inertia: Annotated[float, Quantity("J", "kg m^2", above=0)]
    """Moment of inertia of the disc and what turns with it."""
    pads: tuple[Lining, ...]
    """The pads, one or more."""
    stiffness: Annotated[float, Quantity("k", "N m/rad", low=0)] = 0.0
    """Torsion spring towards phi = 0."""
    damping: Annotated[float, Quantity("c", "N m s/rad", low=0)] = 0.0
    """Damper beside it."""
    drive: Drive | None = None
    """Torque on the disc [N m]."""

    @override
    def __post_init__(self) -> None:
        """Check the parameters and the pads."""
        super().__post_init__()
        object.__setattr__(self, "pads", checked_parts("DiscBrake.pads", Lining, self.pads, 1))

    def _linings(self) -> dict[str, Lining]:
        """Return the pads by name."""
        return {f"pad-{i + 1}": one for i, one in enumerate(self.pads)}

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        return 0.5 * self.inertia * q_dot["phi"] * q_dot["phi"]

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        return 0.5 * self.stiffness * q["phi"] * q["phi"]

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return {"phi": drives.get("drive", 0.0) - self.damping * q_dot["phi"]}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return tuple(one.contact("phi", name) for name, one in self._linings().items())

    @override
    def loads(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return pressing_forces(self._linings(), drives)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        others = -self.stiffness * q["phi"] - self.damping * q_dot["phi"]
        return {  # forces at the radius of each pad, whose torques these are
            name: gear_inputs(
                drives.get("drive", 0.0) / pad.radius,
                others / pad.radius,
                position=pad.radius * q["phi"],
            )
            for name, pad in self._linings().items()
        }

    @override
    def drives(self) -> Mapping[str, Drive]:
        own = {} if self.drive is None else {"drive": self.drive}
        return {**own, **pressing_drives(self._linings())}
