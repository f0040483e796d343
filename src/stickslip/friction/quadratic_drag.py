"""Coulomb and viscous friction with a drag that grows with the square of the speed."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.friction.base import Containment, SetValuedLaw
from stickslip.friction.coefficients import KineticCoefficient, ViscousCoefficient
from stickslip.maths import Scalar
from stickslip.quantities import Quantity

__all__ = ["QuadraticDrag"]


@final
@dataclass(frozen=True, kw_only=True)
class QuadraticDrag(SetValuedLaw):
    """A constant level, a viscous part and quadratic drag, for motion through air or oil.

    Examples
    --------
    >>> law = QuadraticDrag(
    ...     kinetic_coefficient=0.5, viscous_coefficient=2.0, quadratic_coefficient=8.0
    ... )
    >>> law.force(-0.5, load=1.0)
    -3.5
    """

    name: ClassVar[str] = "quadratic-drag"
    title: ClassVar[str] = "Coulomb + viscous + drag"
    formula: ClassVar[str] = (
        r"F = \left(\mu_k N + \sigma_2 |v| + c v^2\right) \operatorname{sgn} v,"
        r" \quad |F| \le \mu_k N \text{ at rest}"
    )
    sources: ClassVar[tuple[str, ...]] = ("coulomb1785", "reynolds1886", "newton1687")
    fit_order: ClassVar[tuple[str, ...]] = (
        "kinetic_coefficient",
        "viscous_coefficient",
        "quadratic_coefficient",
    )
    contained: ClassVar[tuple[Containment, ...]] = (
        Containment(
            law="coulomb-viscous",
            values={
                "kinetic_coefficient": "kinetic_coefficient",
                "viscous_coefficient": "viscous_coefficient",
                "quadratic_coefficient": 0.0,
            },
        ),
    )
    on_request: ClassVar[bool] = True

    kinetic_coefficient: KineticCoefficient
    """Friction force over the normal force as the speed goes to zero."""
    viscous_coefficient: ViscousCoefficient = 0.0
    """Growth of the friction force with the slip speed."""
    quadratic_coefficient: Annotated[
        float, Quantity("c", "N s^2/m^2", low=0, scale="drag", bounds=(0.0, 100.0), start=0.1)
    ] = 0.0
    """Growth of the friction force with the square of the slip speed."""

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        mu_k, sigma_2, c = (
            self.kinetic_coefficient,
            self.viscous_coefficient,
            self.quadratic_coefficient,
        )
        return mu_k * load + (sigma_2 + c * speed) * speed

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return self.kinetic_coefficient * load
