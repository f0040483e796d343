"""Stribeck friction: the static level fades to the kinetic one as the speed grows."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.friction.base import Containment, SetValuedLaw
from stickslip.friction.coefficients import (
    FadingExponent,
    KineticCoefficient,
    StaticCoefficient,
    StribeckVelocity,
    ViscousCoefficient,
)
from stickslip.maths import Scalar, exp, power, where
from stickslip.quantities import Quantity

__all__ = ["Stribeck", "fade"]

VANISHED = 36.0
"""exp(-36) = 2.3e-16: beyond this the exponential is below the last digit of its factor."""


def fade(speed: Scalar, stribeck_velocity: Scalar, exponent: Scalar) -> Scalar:
    """Return exp(-(v/v_s)^n), and 0 where that is below rounding.

    The layer in which it is not zero is often crossed in less than a millisecond. Naming its end
    makes the solver step onto it and not over it.

    Parameters
    ----------
    speed : float or array
        Slip speed, not negative [m/s].
    stribeck_velocity : float or array
        Stribeck velocity v_s, above 0 [m/s].
    exponent : float or array
        Exponent n, above 0 [1].

    Returns
    -------
    float or array
        Share of the static part that is left, 0 to 1.

    Examples
    --------
    >>> fade(0.0, 0.01, 2), fade(1.0, 0.01, 2)
    (1.0, 0.0)
    """
    layer = stribeck_velocity * power(VANISHED, 1.0 / exponent)
    return where(speed < layer, exp(-power(speed / stribeck_velocity, exponent)), 0.0)


@final
@dataclass(frozen=True, kw_only=True)
class Stribeck(SetValuedLaw):
    """A kinetic level, a static excess that decays with speed, and a viscous part.

    The force that rest gives way to may lie above what sliding begins with: the factor ``peak`` of
    the Modelica library is ``break_away_coefficient / static_coefficient``.

    Examples
    --------
    >>> law = Stribeck(kinetic_coefficient=0.25, static_coefficient=0.35, stribeck_velocity=0.01)
    >>> law.force(1e-9, load=10.0), law.force(1.0, load=10.0)
    (3.49999999999999, 2.5)
    >>> law.break_away(10.0)
    3.5
    """

    name: ClassVar[str] = "stribeck"
    title: ClassVar[str] = "Stribeck"
    formula: ClassVar[str] = (
        r"F = \left[\mu_k + (\mu_s - \mu_k) e^{-|v/v_s|^n}\right] N \operatorname{sgn} v"
        r" + \sigma_2 v, \quad |F| \le \mu_b N \text{ at rest}, \quad \mu_b \ge \mu_s"
    )
    sources: ClassVar[tuple[str, ...]] = ("stribeck1902", "bo1982", "armstrong1991", "otter1999")
    fit_order: ClassVar[tuple[str, ...]] = (
        "kinetic_coefficient",
        "viscous_coefficient",
        "stribeck_velocity",
        "static_coefficient",
    )
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
    """Friction force over the normal force once the static surplus has faded."""
    static_coefficient: StaticCoefficient
    """Friction force over the normal force where sliding begins; what the contact holds at rest,
    unless a break-away level is given."""
    stribeck_velocity: StribeckVelocity
    """Speed at which the static surplus has fallen to 1/e."""
    viscous_coefficient: ViscousCoefficient = 0.0
    """Growth of the friction force with the slip speed."""
    exponent: FadingExponent = 2.0
    """Shape of the fading: 1 Tustin, 2 Gaussian."""
    break_away_coefficient: (
        Annotated[
            float,
            Quantity(
                "mu_b",
                low=0,
                at_least="static_coefficient",
                scale="level",
                bounds=(0.0, 10.0),
                start=1.2,
            ),
        ]
        | None
    ) = None
    """Largest friction force the contact holds at rest, over the normal force, where that lies
    above the level at which sliding begins; equal to it if not given."""

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        mu_k, mu_s, sigma_2 = (
            self.kinetic_coefficient,
            self.static_coefficient,
            self.viscous_coefficient,
        )
        s = fade(speed, self.stribeck_velocity, self.exponent)
        return (mu_k + (mu_s - mu_k) * s) * load + sigma_2 * speed

    @override
    def break_away(self, load: Scalar) -> Scalar:
        mu_s, mu_b = self.static_coefficient, self.break_away_coefficient
        return (mu_s if mu_b is None else mu_b) * load
