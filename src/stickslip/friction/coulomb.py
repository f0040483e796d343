"""Coulomb friction: one level, whatever the speed."""

from dataclasses import dataclass
from typing import ClassVar, final

from typing_extensions import override

from stickslip.friction.base import SetValuedLaw
from stickslip.friction.coefficients import KineticCoefficient, StaticCoefficient
from stickslip.maths import Scalar

__all__ = ["Coulomb"]


@final
@dataclass(frozen=True, kw_only=True)
class Coulomb(SetValuedLaw):
    """Constant kinetic friction, with an optional higher static level.

    Examples
    --------
    >>> Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35).break_away(load=9.81)
    3.4335
    """

    name: ClassVar[str] = "coulomb"
    title: ClassVar[str] = "Coulomb"
    formula: ClassVar[str] = (
        r"F = \mu_k N \operatorname{sgn} v, \quad |F| \le \mu_s N \text{ at rest}"
    )
    sources: ClassVar[tuple[str, ...]] = ("coulomb1785", "morin1833")
    fit_order: ClassVar[tuple[str, ...]] = ("kinetic_coefficient",)

    kinetic_coefficient: KineticCoefficient
    """Friction force while sliding, over the normal force."""
    static_coefficient: StaticCoefficient | None = None
    """Largest friction force the contact holds at rest, over the normal force."""

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        mu_k = self.kinetic_coefficient
        return mu_k * load + 0.0 * speed

    @override
    def break_away(self, load: Scalar) -> Scalar:
        mu_s = (
            self.kinetic_coefficient if self.static_coefficient is None else self.static_coefficient
        )
        return mu_s * load
