"""Coulomb and viscous friction with a static level of its own."""

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

__all__ = ["CoulombViscousStatic"]


@final
@dataclass(frozen=True, kw_only=True)
class CoulombViscousStatic(SetValuedLaw):
    """A static level, a lower kinetic level, and a viscous part proportional to the speed.

    The third of the classical laws. `CoulombViscous` with a static coefficient has the same forces,
    but there the static level is given; here it is a parameter like the others, and fitted where
    the data tell it.

    Examples
    --------
    >>> law = CoulombViscousStatic(
    ...     kinetic_coefficient=0.25, static_coefficient=0.35, viscous_coefficient=0.1
    ... )
    >>> law.force(0.5, load=10.0), law.break_away(load=10.0)
    (2.55, 3.5)
    """

    name: ClassVar[str] = "coulomb-viscous-static"
    title: ClassVar[str] = "Coulomb + viscous + static"
    formula: ClassVar[str] = (
        r"F = \mu_k N \operatorname{sgn} v + \sigma_2 v, \quad |F| \le \mu_s N \text{ at rest}"
    )
    sources: ClassVar[tuple[str, ...]] = ("coulomb1785", "morin1833", "reynolds1886")
    fit_order: ClassVar[tuple[str, ...]] = (
        "kinetic_coefficient",
        "viscous_coefficient",
        "static_coefficient",
    )
    on_request: ClassVar[bool] = True
    contained: ClassVar[tuple[Containment, ...]] = (
        Containment(
            law="coulomb-viscous",
            values={
                "kinetic_coefficient": "kinetic_coefficient",
                "viscous_coefficient": "viscous_coefficient",
                "static_coefficient": "kinetic_coefficient",
            },
        ),
    )

    kinetic_coefficient: KineticCoefficient
    """Friction force over the normal force as the speed goes to zero."""
    static_coefficient: StaticCoefficient
    """Largest friction force the contact holds at rest, over the normal force."""
    viscous_coefficient: ViscousCoefficient
    """Growth of the friction force with the slip speed."""

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        return self.kinetic_coefficient * load + self.viscous_coefficient * speed

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return self.static_coefficient * load
