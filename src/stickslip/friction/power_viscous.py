"""Coulomb friction and a viscous part that grows with a power of the speed."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.friction.base import SetValuedLaw
from stickslip.maths import Scalar, power
from stickslip.quantities import Quantity

__all__ = ["PowerViscous"]


@final
@dataclass(frozen=True, kw_only=True)
class PowerViscous(SetValuedLaw):
    """A level, and a part that grows with a power of the speed: shear-thinning lubricants.

    Examples
    --------
    >>> law = PowerViscous(kinetic_coefficient=2.0, viscous_coefficient=4.0, exponent=0.5)
    >>> law.force(0.25, load=1.0)
    4.0
    """

    name: ClassVar[str] = "power-viscous"
    title: ClassVar[str] = "Coulomb + power of speed"
    formula: ClassVar[str] = (
        r"F = \left(\mu_k N + \sigma_2 v_1 |v / v_1|^n\right) \operatorname{sgn} v, \quad"
        r" v_1 = 1\,\mathrm{m/s}, \quad |F| \le \mu_k N \text{ at rest}"
    )
    sources: ClassVar[tuple[str, ...]] = ("coulomb1785", "bittencourt2012")
    fit_order: ClassVar[tuple[str, ...]] = (
        "kinetic_coefficient",
        "viscous_coefficient",
        "exponent",
    )

    kinetic_coefficient: Annotated[float, Quantity("mu_k", low=0)]
    """Friction force over the normal force as the speed goes to zero."""
    viscous_coefficient: Annotated[float, Quantity("sigma_2", "N s/m", low=0)]
    """Speed-dependent part of the force at 1 m/s, over that speed."""
    exponent: Annotated[float, Quantity("n", above=0, structural=True)] = 0.5
    """Power of the speed: 1 is viscous friction, below 1 the lubricant thins."""

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        mu_k, sigma_2, n = self.kinetic_coefficient, self.viscous_coefficient, self.exponent
        return mu_k * load + sigma_2 * power(speed, n)

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return self.kinetic_coefficient * load
