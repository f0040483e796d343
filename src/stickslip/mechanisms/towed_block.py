"""A block pulled over rough ground through a spring; the same as a mass on a belt."""

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
class TowedBlock(Mechanism):
    """A block on rough ground, pulled by a spring and a damper whose far end moves steadily.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    >>> run = simulate(block, Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5), t_end=20.0)
    >>> starts = [event.t for event in run.events if event.reason == "break-away"]
    >>> round(starts[1] - starts[0], 5)
    7.61126
    """

    name: ClassVar[str] = "towed-block"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)
    moving_part: ClassVar[str] = "block"

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of the block."""
    stiffness: Annotated[float, Quantity("k", "N/m", above=0)]
    """Stiffness of the spring."""
    speed: Annotated[float, Quantity("V", "m/s")]
    """Speed of the far end of the spring."""
    damping: Annotated[float, Quantity("c", "N s/m", low=0)] = 0.0
    """Damper beside the spring."""
    load: Annotated[float, Quantity("N", "N", low=0)] | None = None
    """Normal force; the weight if not given."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""
    modulation: Drive | None = None
    """Force that presses the block beside the load [N]; where it lifts it off, a run ends."""

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        upward = q_dot.get("y", 0.0)
        return 0.5 * self.mass * (q_dot["x"] * q_dot["x"] + upward * upward)

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        stretch = self.speed * t - q["x"]
        return 0.5 * self.stiffness * stretch * stretch

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        found = {"x": self.damping * (self.speed - q_dot["x"])}
        if self.modulation is not None:
            found["y"] = -(self.steady_load + drives["modulation"])
        return found

    @override
    def contacts(self) -> tuple[Contact, ...]:
        if self.modulation is not None:
            return (Contact(slip="x", normal="y"),)
        return (Contact(slip="x", load=self.steady_load),)

    @property
    def steady_load(self) -> float:
        """Normal force without its modulation [N]."""
        return self.mass * self.gravity if self.load is None else self.load

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        pull = self.stiffness * (self.speed * t - q["x"])
        pull = pull + self.damping * (self.speed - q_dot["x"])
        return gear_inputs(pull, 0.0, position=q["x"])

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.modulation is None else {"modulation": self.modulation}
