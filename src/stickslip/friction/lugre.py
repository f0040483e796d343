"""LuGre friction: bristles with damping whose strength follows the Stribeck curve."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Self, final

from typing_extensions import override

from stickslip.friction.base import BristleLaw, Containment
from stickslip.friction.coefficients import (
    BristleStiffness,
    FadingExponent,
    PositiveKineticCoefficient,
    StribeckVelocity,
    ViscousCoefficient,
    ViscousExponent,
)
from stickslip.friction.power_viscous import viscous_force
from stickslip.friction.stribeck import fade
from stickslip.maths import Scalar, sign
from stickslip.quantities import Quantity

__all__ = ["LuGre"]


@final
@dataclass(frozen=True, kw_only=True)
class LuGre(BristleLaw):
    """Presliding, Stribeck curve, frictional lag and rate-dependent break-away with one state.

    The viscous part may grow with a power of the speed, as that of a lubricant that thins; below a
    micrometre a second it is linear.

    Load-normalised: stiffness and damping multiply the normal force. `from_forces` takes the
    classical parameters.

    Examples
    --------
    >>> law = LuGre.from_forces(
    ...     load=1.0,
    ...     kinetic_force=1.0,
    ...     static_force=1.5,
    ...     stribeck_velocity=1e-3,
    ...     bristle_stiffness=1e5,
    ...     bristle_damping=316.0,
    ...     viscous_coefficient=0.4,
    ... )
    >>> round(law.steady(0.1, load=1.0), 9)
    1.04
    """

    name: ClassVar[str] = "lugre"
    title: ClassVar[str] = "LuGre"
    formula: ClassVar[str] = (
        r"F = (\sigma_0 z + \sigma_1 \dot z) N + \sigma_2 |v|^p \operatorname{sgn} v, \quad"
        r" \dot z = v - \frac{\sigma_0 |v|}{g(v)} z, \quad"
        r" g = \mu_k + (\mu_s - \mu_k) e^{-|v/v_s|^n}"
    )
    sources: ClassVar[tuple[str, ...]] = ("canudas1995", "canudas1999")
    fit_order: ClassVar[tuple[str, ...]] = (
        "kinetic_coefficient",
        "viscous_coefficient",
        "bristle_stiffness",
        "static_coefficient",
        "stribeck_velocity",
        "bristle_damping",
    )
    contained: ClassVar[tuple[Containment, ...]] = (
        Containment(
            law="dahl",
            values={
                "kinetic_coefficient": "kinetic_coefficient",
                "viscous_coefficient": "viscous_coefficient",
                "bristle_stiffness": "bristle_stiffness",
                "viscous_exponent": "viscous_exponent",
                "static_coefficient": "kinetic_coefficient",
                "bristle_damping": 0.0,
            },
            where={"exponent": 1.0},
        ),
        Containment(
            law="stribeck",
            values={
                "kinetic_coefficient": "kinetic_coefficient",
                "viscous_coefficient": "viscous_coefficient",
                "static_coefficient": "static_coefficient",
                "stribeck_velocity": "stribeck_velocity",
                "exponent": "exponent",
                "viscous_exponent": 1.0,
                "bristle_damping": 0.0,
            },
            limits=("bristle_stiffness",),
        ),
    )

    kinetic_coefficient: PositiveKineticCoefficient
    """Friction force over the normal force at speeds well above the Stribeck velocity."""
    static_coefficient: Annotated[
        float,
        Quantity(
            "mu_s",
            above=0,
            at_least="kinetic_coefficient",
            scale="level",
            bounds=(0.0, 10.0),
            start=1.1,
        ),
    ]
    """Largest steady friction force over the normal force, at vanishing speed."""
    stribeck_velocity: StribeckVelocity
    """Speed at which the static surplus has fallen to 1/e."""
    bristle_stiffness: BristleStiffness
    """Stiffness of the bristles over the normal force."""
    bristle_damping: Annotated[
        float, Quantity("sigma_1", "s/m", low=0, scale="damping", bounds=(1e-3, 1e3), start=1.0)
    ]
    """Damping of the bristles over the normal force."""
    viscous_coefficient: ViscousCoefficient = 0.0
    """Viscous part of the force at 1 m/s, over that speed: its growth with the slip speed where
    it is linear."""
    exponent: FadingExponent = 2.0
    """Shape of the Stribeck fading."""
    viscous_exponent: ViscousExponent = 1.0
    """Power of the speed in the viscous part: 1 is linear, below 1 the lubricant thins."""

    @classmethod
    def from_forces(
        cls,
        *,
        load: float,
        kinetic_force: float,
        static_force: float,
        stribeck_velocity: float,
        bristle_stiffness: float,
        bristle_damping: float,
        viscous_coefficient: float = 0.0,
        exponent: float = 2.0,
        viscous_exponent: float = 1.0,
        static_switch: bool = False,
    ) -> Self:
        """Build the law from forces [N], a stiffness [N/m] and a damping [N s/m] at a load [N].

        Parameters
        ----------
        load : float
            Normal force at which the others were measured, above 0 [N].
        kinetic_force : float
            Friction force of fast sliding, viscous part left out [N].
        static_force : float
            Largest friction force of slow sliding [N].
        stribeck_velocity : float
            Speed at which the static part fades [m/s].
        bristle_stiffness : float
            Stiffness of the contact at rest [N/m].
        bristle_damping : float
            Damping of the bristles [N s/m].
        viscous_coefficient : float, default 0.0
            Viscous coefficient, not over the load [N s/m].
        exponent : float, default 2.0
            Exponent of the Stribeck curve [1].
        viscous_exponent : float, default 1.0
            Power of the speed in the viscous part [1].
        static_switch : bool, default False
            Whether the contact also sticks up to its break-away level, as in the law.

        Returns
        -------
        type of the law
            The law with forces, stiffness and damping over the load.

        Raises
        ------
        ParameterError
            If a number is out of its range.
        """
        load = Quantity("N", "N", above=0).check(cls.__name__, "load", load)
        return cls(
            kinetic_coefficient=kinetic_force / load,
            static_coefficient=static_force / load,
            stribeck_velocity=stribeck_velocity,
            bristle_stiffness=bristle_stiffness / load,
            bristle_damping=bristle_damping / load,
            viscous_coefficient=viscous_coefficient,
            exponent=exponent,
            viscous_exponent=viscous_exponent,
            static_switch=static_switch,
        )

    def _g(self, velocity: Scalar) -> Scalar:
        mu_k, mu_s = self.kinetic_coefficient, self.static_coefficient
        return mu_k + (mu_s - mu_k) * fade(abs(velocity), self.stribeck_velocity, self.exponent)

    def _viscous(self, velocity: Scalar) -> Scalar:
        return viscous_force(velocity, self.viscous_coefficient, self.viscous_exponent)

    @override
    def force(self, velocity: Scalar, bristles: tuple[Scalar, ...], load: Scalar) -> Scalar:
        (z,) = bristles
        (z_dot,) = self.bristle_rates(velocity, bristles, load)
        sigma_0, sigma_1 = self.bristle_stiffness, self.bristle_damping
        return (sigma_0 * z + sigma_1 * z_dot) * load + self._viscous(velocity)

    @override
    def bristle_rates(
        self, velocity: Scalar, bristles: tuple[Scalar, ...], load: Scalar
    ) -> tuple[Scalar, ...]:
        (z,) = bristles
        return (velocity - self.bristle_stiffness * abs(velocity) / self._g(velocity) * z,)

    @override
    def steady(self, velocity: Scalar, load: Scalar) -> Scalar:
        return self._g(velocity) * load * sign(velocity) + self._viscous(velocity)

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return self.static_coefficient * load
