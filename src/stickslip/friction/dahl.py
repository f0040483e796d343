"""Dahl friction: a spring that yields."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Self, final

from typing_extensions import override

from stickslip.friction.base import BristleLaw, Containment
from stickslip.friction.coefficients import (
    BristleStiffness,
    PositiveKineticCoefficient,
    ViscousCoefficient,
    ViscousExponent,
)
from stickslip.friction.power_viscous import viscous_force
from stickslip.maths import Scalar, power, sign
from stickslip.quantities import Quantity

__all__ = ["Dahl"]

ROUNDED = 1e-12
"""Square of the share of the friction level within which an exponent other than 1 is rounded."""


@final
@dataclass(frozen=True, kw_only=True)
class Dahl(BristleLaw):
    """Elastic at small displacements, Coulomb friction at large ones: hysteresis without stiction.

    A viscous part may stand beside the bristles; that of a lubricant that thins grows with a power
    of the speed below 1, as in the joints of robots. Below a micrometre a second it is linear.

    Examples
    --------
    >>> law = Dahl.from_forces(load=9.81, kinetic_force=2.4525, bristle_stiffness=1e5)
    >>> round(law.kinetic_coefficient, 9), round(law.bristle_stiffness, 3)
    (0.25, 10193.68)
    """

    name: ClassVar[str] = "dahl"
    title: ClassVar[str] = "Dahl"
    formula: ClassVar[str] = (
        r"F = \sigma_0 z N + \sigma_2 |v|^p \operatorname{sgn} v, \quad"
        r" \dot z = v\, \operatorname{sgn}(r)\, |r|^n, \quad"
        r" r = 1 - \frac{\sigma_0 z}{\mu_k} \operatorname{sgn} v"
    )
    sources: ClassVar[tuple[str, ...]] = ("dahl1968",)
    fit_order: ClassVar[tuple[str, ...]] = (
        "kinetic_coefficient",
        "bristle_stiffness",
        "viscous_coefficient",
        "exponent",
    )
    contained: ClassVar[tuple[Containment, ...]] = (
        Containment(
            law="coulomb-viscous",
            values={
                "kinetic_coefficient": "kinetic_coefficient",
                "viscous_coefficient": "viscous_coefficient",
                "exponent": 1.0,
                "viscous_exponent": 1.0,
            },
            limits=("bristle_stiffness",),
        ),
    )

    kinetic_coefficient: PositiveKineticCoefficient
    """Friction force over the normal force after long sliding."""
    bristle_stiffness: BristleStiffness
    """Slope of friction against displacement at the start, over the normal force."""
    exponent: Annotated[
        float, Quantity("n", above=0, structural=True, scale="none", bounds=(0.2, 3.0), start=0.8)
    ] = 1.0
    """Sharpness of yielding: 1 is Dahl's plain law, towards 0 elastic then perfectly plastic."""
    viscous_coefficient: ViscousCoefficient = 0.0
    """Viscous part of the force at 1 m/s, over that speed: its growth with the slip speed where
    it is linear."""
    viscous_exponent: ViscousExponent = 1.0
    """Power of the speed in the viscous part: 1 is linear, below 1 the lubricant thins."""

    @classmethod
    def from_forces(
        cls,
        *,
        load: float,
        kinetic_force: float,
        bristle_stiffness: float,
        exponent: float = 1.0,
        viscous_coefficient: float = 0.0,
        viscous_exponent: float = 1.0,
        static_switch: bool = False,
    ) -> Self:
        """Build the law from a force [N] and a stiffness [N/m] measured at a load [N].

        Parameters
        ----------
        load : float
            Normal force at which the others were measured, above 0 [N].
        kinetic_force : float
            Friction force of sliding [N].
        bristle_stiffness : float
            Stiffness of the contact at rest [N/m].
        exponent : float, default 1.0
            Exponent of the transition to sliding [1], as in the law.
        viscous_coefficient : float, default 0.0
            Viscous coefficient, not over the load [N s/m].
        viscous_exponent : float, default 1.0
            Power of the speed in the viscous part [1].
        static_switch : bool, default False
            Whether the contact also sticks up to its break-away level, as in the law.

        Returns
        -------
        type of the law
            The law with forces and stiffness over the load.

        Raises
        ------
        ParameterError
            If a number is out of its range.
        """
        load = Quantity("N", "N", above=0).check(cls.__name__, "load", load)
        return cls(
            kinetic_coefficient=kinetic_force / load,
            bristle_stiffness=bristle_stiffness / load,
            exponent=exponent,
            viscous_coefficient=viscous_coefficient,
            viscous_exponent=viscous_exponent,
            static_switch=static_switch,
        )

    def _viscous(self, velocity: Scalar) -> Scalar:
        return viscous_force(velocity, self.viscous_coefficient, self.viscous_exponent)

    @override
    def force(self, velocity: Scalar, bristles: tuple[Scalar, ...], load: Scalar) -> Scalar:
        (z,) = bristles
        return self.bristle_stiffness * z * load + self._viscous(velocity)

    @override
    def bristle_rates(
        self, velocity: Scalar, bristles: tuple[Scalar, ...], load: Scalar
    ) -> tuple[Scalar, ...]:
        (z,) = bristles
        r = 1.0 - self.bristle_stiffness * z * sign(velocity) / self.kinetic_coefficient
        # sgn(r) |r|^n, rounded where rounding errors decide the side and n < 1 has no slope
        return (velocity * r * power(r * r + ROUNDED, 0.5 * (self.exponent - 1.0)),)

    @override
    def steady(self, velocity: Scalar, load: Scalar) -> Scalar:
        return self.kinetic_coefficient * load * sign(velocity) + self._viscous(velocity)

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return self.kinetic_coefficient * load
