"""Levels of friction over the load: what sliding needs at a speed, and what a contact holds."""

import math
from typing import Annotated, final

from typing_extensions import Doc, override

from stickslip.friction.coefficients import (
    FadingExponent,
    KineticCoefficient,
    StaticCoefficient,
    StribeckVelocity,
)
from stickslip.friction.parts.base import Extra, Level, Slip, SmoothLevel, Values
from stickslip.maths import Scalar, exp, log, power, tanh, where
from stickslip.quantities import Quantity

AT_LARGEST = Doc("Speed at which friction peaks, if the static level is above the kinetic one.")
VANISHED = 36.0
"""exp(-36) = 2.3e-16: beyond this the exponential is below the last digit of its factor."""


def fade(speed: Scalar, stribeck_velocity: Scalar, exponent: Scalar) -> Scalar:
    """Return exp(-(v/v_s)^n), and 0 where that is below rounding.

    The layer in which it is not zero is often crossed in less than a millisecond. Naming its end
    makes the solver step onto it and not over it.
    """
    layer = stribeck_velocity * power(VANISHED, 1.0 / exponent)
    return where(speed < layer, exp(-power(speed / stribeck_velocity, exponent)), 0.0)


@final
class Kinetic(Level):
    """One level, whatever the speed."""

    name = "level"
    title = "Coulomb"
    tex = r"\mu_k"
    rest = "kinetic_coefficient"
    vanishes = {"kinetic_coefficient": 0.0}
    below = ("step",)
    kinetic_coefficient: KineticCoefficient

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        return p.kinetic_coefficient + 0.0 * s.speed  # an array of speeds gives an array


class Surplus(Level):
    """A static level above the kinetic one, of which less is left the faster the contact slides."""

    rest = "static_coefficient"
    vanishes = {"static_coefficient": "kinetic_coefficient"}
    below = ("peak",)

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        return (p.static_coefficient - p.kinetic_coefficient) * self.left(p, s)

    def left(self, p: Values, s: Slip) -> Scalar:
        """Return the share of the surplus that is left at a speed."""
        raise NotImplementedError


@final
class Step(Level):
    """A static level that ends with rest."""

    name = "step"
    title = "static"
    tex = ""
    rest = "static_coefficient"
    vanishes = {"static_coefficient": "kinetic_coefficient"}
    static_coefficient: StaticCoefficient | None = None

    @override
    def sliding(self, p: Values, s: Slip) -> None:
        return None


@final
class Peak(Level):
    """A break-away level above the one at which sliding begins."""

    name = "peak"
    title = "break-away peak"
    tex = ""
    rest = "break_away_coefficient"
    vanishes = {"break_away_coefficient": "static_coefficient"}
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
            Doc("Largest friction force at rest, where that is above the one of vanishing speed."),
        ]
        | None
    ) = None

    @override
    def sliding(self, p: Values, s: Slip) -> None:
        return None


@final
class Stribeck(Surplus):
    """A static surplus that fades exponentially."""

    name = "stribeck"
    title = "Stribeck"
    tex = r"(\mu_s - \mu_k) e^{-|v/v_s|^n}"
    static_coefficient: StaticCoefficient
    stribeck_velocity: StribeckVelocity
    fading_exponent: FadingExponent = 2.0

    @override
    def left(self, p: Values, s: Slip) -> Scalar:
        return fade(s.speed, p.stribeck_velocity, p.fading_exponent)


@final
class Tustin(Surplus):
    """A static surplus that fades exponentially, with a corner at rest."""

    name = "tustin"
    title = "Tustin"
    compared = False
    tex = r"(\mu_s - \mu_k) e^{-|v|/v_s}"
    static_coefficient: StaticCoefficient
    stribeck_velocity: StribeckVelocity

    @override
    def left(self, p: Values, s: Slip) -> Scalar:
        return fade(s.speed, p.stribeck_velocity, 1.0)


@final
class Lorentz(Surplus):
    """A static surplus that fades with the square of the speed."""

    name = "lorentz"
    title = "Hess and Soom"
    compared = False
    tex = r"\frac{\mu_s - \mu_k}{1 + (v/v_s)^2}"
    static_coefficient: StaticCoefficient
    stribeck_velocity: StribeckVelocity

    @override
    def left(self, p: Values, s: Slip) -> Scalar:
        u = s.speed / p.stribeck_velocity
        return 1.0 / (1.0 + u * u)


@final
class Hyperbolic(Surplus):
    """A static surplus that fades with the speed itself."""

    name = "hyperbolic"
    title = "Popp and Stelter"
    compared = False
    tex = r"\frac{\mu_s - \mu_k}{1 + |v|/v_s}"
    static_coefficient: StaticCoefficient
    stribeck_velocity: StribeckVelocity

    @override
    def left(self, p: Values, s: Slip) -> Scalar:
        return 1.0 / (1.0 + s.speed / p.stribeck_velocity)


@final
class BrownMcPhee(SmoothLevel):
    """One smooth curve that peaks near mu_s at the transition velocity."""

    name = "brown_mcphee"
    title = "Brown and McPhee"
    tex = r"\left[\mu_k \tanh(4u) + (\mu_s - \mu_k) \frac{u}{(u^2/4 + 3/4)^2}\right]"
    tex_where = r"u = |v|/v_t"
    kinetic_coefficient: KineticCoefficient
    static_coefficient: StaticCoefficient
    transition_velocity: Annotated[
        float,
        Quantity("v_t", "m/s", above=0, scale="speed", bounds=(1e-4, 1.0), start=0.01),
        AT_LARGEST,
    ]

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        mu_k, mu_s = p.kinetic_coefficient, p.static_coefficient
        u = s.speed / p.transition_velocity
        d = 0.25 * u * u + 0.75
        return mu_k * tanh(4.0 * u) + (mu_s - mu_k) * u / (d * d)


@final
class Simscape(SmoothLevel):
    """The curve of the Translational Friction block: a bump on a hyperbolic tangent."""

    name = "simscape"
    title = "Simscape"
    tex = r"\left[\sqrt{2e} (\mu_s - \mu_k) u e^{-u^2} + \mu_k \tanh(10 |v|/v_b)\right]"
    tex_where = r"u = |v|/(\sqrt 2 v_b)"
    kinetic_coefficient: KineticCoefficient
    static_coefficient: StaticCoefficient
    breakaway_velocity: Annotated[
        float,
        Quantity("v_b", "m/s", above=0, scale="speed", bounds=(1e-4, 1.0), start=0.01),
        AT_LARGEST,
    ]

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        mu_k, mu_s = p.kinetic_coefficient, p.static_coefficient
        u = s.speed / (math.sqrt(2.0) * p.breakaway_velocity)
        bump = math.sqrt(2.0 * math.e) * (mu_s - mu_k) * exp(-u * u) * u
        return bump + mu_k * tanh(10.0 * s.speed / p.breakaway_velocity)


@final
class Logarithmic(Extra):
    """A level that grows with the logarithm of the speed, from 0 at rest."""

    name = "logarithmic"
    title = "logarithmic level"
    holds = False
    tex = r"a \ln(1 + |v|/v_0)"
    vanishes = {"logarithmic_coefficient": 0.0}
    logarithmic_coefficient: Annotated[
        float,
        Quantity("a", low=0, scale="level", bounds=(0.0, 2.0), start=0.05),
        Doc("Growth of the level with the logarithm of the speed."),
    ]
    reference_velocity: Annotated[
        float,
        Quantity("v_0", "m/s", above=0, scale="speed", bounds=(1e-5, 1.0), start=0.01),
        Doc("Speed above which the growth is logarithmic."),
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        return 0.0

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        return p.logarithmic_coefficient * log(1.0 + s.speed / p.reference_velocity)


def rate(symbol: str, start: float, at_least: str | None = None) -> Quantity:
    """Return the quantity of the inverse of a speed."""
    return Quantity(
        symbol, "s/m", above=0, at_least=at_least, scale="1/speed", bounds=(1.0, 1e4), start=start
    )


@final
class Makkar(SmoothLevel):
    """Differences of hyperbolic tangents: a bump on a rise to the kinetic level."""

    name = "makkar"
    title = "Makkar"
    compared = False
    tex = (
        r"\left[\gamma_1 (\tanh \gamma_2 |v| - \tanh \gamma_3 |v|)"
        r" + \mu_k \tanh \gamma_5 |v|\right]"
    )
    bump_coefficient: Annotated[
        float,
        Quantity("gamma_1", low=0, scale="level", bounds=(0.0, 2.0), start=0.1),
        Doc("Level that the bump adds at most, reached if it rises much faster than it falls."),
    ]
    fall_rate: Annotated[float, rate("gamma_3", 10.0), Doc("How fast the bump falls.")]
    rise_rate: Annotated[
        float,
        rate("gamma_2", 100.0, "fall_rate"),
        Doc("How fast the bump rises; it is none below fall_rate, where friction would drive."),
    ]
    kinetic_coefficient: KineticCoefficient
    smoothing_rate: Annotated[
        float, rate("gamma_5", 100.0), Doc("How fast the kinetic level is reached.")
    ]

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        v, mu_k = s.speed, p.kinetic_coefficient
        bump = p.bump_coefficient * (tanh(p.rise_rate * v) - tanh(p.fall_rate * v))
        return bump + mu_k * tanh(p.smoothing_rate * v)


@final
class BengisuAkay(SmoothLevel):
    """A parabola up to the static level, and an exponential down to the kinetic one."""

    name = "bengisu_akay"
    title = "Bengisu and Akay"
    compared = False
    tex = r"h"
    tex_where = (
        r"h = \begin{cases} \mu_s \frac{|v|}{v_0} \left(2 - \frac{|v|}{v_0}\right) & |v| < v_0 \\"
        r" \mu_k + (\mu_s - \mu_k) e^{-\xi (|v| - v_0)} & |v| \ge v_0 \end{cases}"
    )
    kinetic_coefficient: KineticCoefficient
    static_coefficient: StaticCoefficient
    peak_velocity: Annotated[
        float,
        Quantity("v_0", "m/s", above=0, scale="speed", bounds=(1e-4, 1.0), start=0.01),
        AT_LARGEST,
    ]
    fall_rate: Annotated[float, rate("xi", 10.0), Doc("How fast friction falls beyond its peak.")]

    @override
    def sliding(self, p: Values, s: Slip) -> Scalar:
        mu_k, mu_s, u = p.kinetic_coefficient, p.static_coefficient, s.speed / p.peak_velocity
        beyond = mu_k + (mu_s - mu_k) * exp(-p.fall_rate * (s.speed - p.peak_velocity))
        return where(s.speed < p.peak_velocity, mu_s * u * (2.0 - u), beyond)
