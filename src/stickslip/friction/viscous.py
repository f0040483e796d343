"""Viscous friction: in proportion to the speed, nothing at rest."""

from dataclasses import dataclass
from typing import ClassVar, final

from typing_extensions import override

from stickslip.friction.base import SetValuedLaw
from stickslip.friction.coefficients import ViscousCoefficient
from stickslip.maths import Scalar

__all__ = ["Viscous"]


@final
@dataclass(frozen=True, kw_only=True)
class Viscous(SetValuedLaw):
    """Friction of a fluid film, proportional to the speed, without a static level.

    Examples
    --------
    >>> Viscous(viscous_coefficient=2.0).force(0.5, load=9.81)
    1.0
    """

    name: ClassVar[str] = "viscous"
    title: ClassVar[str] = "Viscous"
    formula: ClassVar[str] = r"F = \sigma_2 v"
    sources: ClassVar[tuple[str, ...]] = ("reynolds1886",)
    fit_order: ClassVar[tuple[str, ...]] = ("viscous_coefficient",)

    viscous_coefficient: ViscousCoefficient
    """Friction force over slip speed."""

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        sigma_2 = self.viscous_coefficient
        return sigma_2 * speed

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return 0.0 * load
