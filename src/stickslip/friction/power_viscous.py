"""Coulomb friction and a viscous part that grows with a power of the speed."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.friction.base import Containment, SetValuedLaw
from stickslip.friction.coefficients import KineticCoefficient, ViscousCoefficient
from stickslip.maths import Scalar, power, where
from stickslip.quantities import Quantity

__all__ = ["PowerViscous", "viscous_force"]

PLATEAU = 1e-6
"""Speed [m/s] below which the part that depends on the speed is proportional to it.

The slope of a power below 1 has no bound towards v = 0: a body that creeps there would ask for ever
shorter steps, and lubricants do not thin at such speeds either.
"""


def viscous_force(velocity: Scalar, coefficient: Scalar, exponent: Scalar) -> Scalar:
    """Return sigma_2 |v|^p sgn v [N], and below `PLATEAU` the straight line that meets it there.

    Parameters
    ----------
    velocity : float or array
        Slip velocity [m/s].
    coefficient : float
        Viscous coefficient sigma_2 [N s/m]: the force at 1 m/s, over that speed.
    exponent : float
        Power p of the speed. With 1 the equations are those of linear viscous friction.

    Returns
    -------
    float or array
        Viscous part of the friction force, with the sign of the velocity [N].

    Examples
    --------
    >>> viscous_force(-0.25, 4.0, 0.5), viscous_force(-0.25, 4.0, 1.0)
    (-2.0, -1.0)
    """
    if isinstance(exponent, (float, int)) and exponent == 1.0:
        return coefficient * velocity
    return coefficient * _thinning(abs(velocity), exponent) * velocity


def _thinning(speed: Scalar, exponent: Scalar) -> Scalar:
    """Return the viscosity at a speed, over that at 1 m/s."""
    # named by its switch, the end of the plateau is stepped onto and not over
    w = where(speed < PLATEAU, PLATEAU, speed)
    return power(w, exponent - 1.0)


@final
@dataclass(frozen=True, kw_only=True)
class PowerViscous(SetValuedLaw):
    """A constant level plus a power of the speed, as for shear-thinning lubricants.

    Below a micrometre a second, `PLATEAU`, the power gives way to the straight line that meets it
    there. With no level a body creeps to rest along this line in no finite time, as with viscous
    friction.

    Examples
    --------
    >>> law = PowerViscous(kinetic_coefficient=2.0, viscous_coefficient=4.0, exponent=0.5)
    >>> law.force(0.25, load=1.0)
    4.0
    """

    name: ClassVar[str] = "power-viscous"
    title: ClassVar[str] = "Coulomb + power of speed"
    formula: ClassVar[str] = (
        r"F = \left(\mu_k N + \sigma_2 |v| (w / v_1)^{n - 1}\right) \operatorname{sgn} v, \quad"
        r" w = \max(|v|, 10^{-6} v_1), \quad v_1 = 1\,\mathrm{m/s},"
        r" \quad |F| \le \mu_k N \text{ at rest}"
    )
    sources: ClassVar[tuple[str, ...]] = ("coulomb1785", "bittencourt2012")
    fit_order: ClassVar[tuple[str, ...]] = (
        "kinetic_coefficient",
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
            },
        ),
    )
    on_request: ClassVar[bool] = True

    kinetic_coefficient: KineticCoefficient
    """Friction force over the normal force as the speed goes to zero."""
    viscous_coefficient: ViscousCoefficient
    """Speed-dependent part of the force at 1 m/s, over that speed."""
    exponent: Annotated[
        float, Quantity("n", above=0, structural=True, scale="none", bounds=(0.2, 3.0), start=0.8)
    ] = 0.5
    """Power of the speed: 1 is viscous friction, below 1 the lubricant thins."""

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        mu_k, sigma_2, n = self.kinetic_coefficient, self.viscous_coefficient, self.exponent
        return mu_k * load + sigma_2 * _thinning(speed, n) * speed

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return self.kinetic_coefficient * load
