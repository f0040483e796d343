"""Coulomb and viscous friction together, with a static level if one is given."""

from dataclasses import dataclass
from typing import ClassVar, final

from typing_extensions import override

from stickslip.friction.base import Containment, SetValuedLaw
from stickslip.friction.coefficients import (
    KineticCoefficient,
    StaticCoefficient,
    ViscousCoefficient,
)
from stickslip.maths import Scalar

__all__ = ["CoulombViscous"]


@final
@dataclass(frozen=True, kw_only=True)
class CoulombViscous(SetValuedLaw):
    """A constant level plus a viscous part proportional to the speed.

    Examples
    --------
    >>> law = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.1)
    >>> law.force(0.5, load=10.0)
    2.55
    """

    name: ClassVar[str] = "coulomb-viscous"
    title: ClassVar[str] = "Coulomb + viscous"
    formula: ClassVar[str] = (
        r"F = \mu_k N \operatorname{sgn} v + \sigma_2 v, \quad |F| \le \mu_s N \text{ at rest}"
    )
    sources: ClassVar[tuple[str, ...]] = ("coulomb1785", "reynolds1886", "morin1833")
    fit_order: ClassVar[tuple[str, ...]] = ("kinetic_coefficient", "viscous_coefficient")
    contained: ClassVar[tuple[Containment, ...]] = (
        Containment(
            law="coulomb",
            values={
                "kinetic_coefficient": "kinetic_coefficient",
                "viscous_coefficient": 0.0,
            },
        ),
        Containment(
            law="viscous",
            values={
                "kinetic_coefficient": 0.0,
                "viscous_coefficient": "viscous_coefficient",
            },
        ),
    )

    kinetic_coefficient: KineticCoefficient
    """Friction force over the normal force as the speed goes to zero."""
    viscous_coefficient: ViscousCoefficient
    """Growth of the friction force with the slip speed."""
    static_coefficient: StaticCoefficient | None = None
    """Largest friction force the contact holds at rest, over the normal force."""

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        mu_k, sigma_2 = self.kinetic_coefficient, self.viscous_coefficient
        return mu_k * load + sigma_2 * speed

    @override
    def break_away(self, load: Scalar) -> Scalar:
        mu_s = (
            self.kinetic_coefficient if self.static_coefficient is None else self.static_coefficient
        )
        return mu_s * load
