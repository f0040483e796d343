"""Forces that vanish at rest, smooth functions in place of the sign, and factors of parts."""

import functools
import math
from collections.abc import Mapping
from dataclasses import MISSING
from typing import Annotated

from typing_extensions import Doc, override

from stickslip.friction.base import ViscousCoefficient, ViscousExponent
from stickslip.friction.parts import base
from stickslip.maths import Scalar, arctan, cos, exp, power, sin, sqrt, tanh, where
from stickslip.quantities import Quantity

# Forces that vanish at rest and do not depend on the load.

PLATEAU = 1e-6
"""Speed [m/s] below which a power of the speed gives way to the straight line that meets it there.

The slope of a power below 1 has no bound towards v = 0: a body that creeps there would ask for ever
shorter steps, and lubricants do not thin at such speeds either.
"""


class Viscous(base.Flow):
    """In proportion to the speed."""

    name = "viscous"
    tex = r"\sigma_2 v"
    vanishes = {"viscous_coefficient": 0.0}
    viscous_coefficient: ViscousCoefficient

    @override
    def flow(self, p: base.Values, s: base.Slip) -> Scalar:
        return p.viscous_coefficient * s.along


class Power(base.Flow):
    """A power of the speed, as of lubricants that thin; linear below `PLATEAU`."""

    name = "power"
    title = "power of speed"
    tex = r"\sigma_2 |v|^p \operatorname{sgn} v"
    vanishes = {"viscous_coefficient": 0.0}
    becomes = (base.Becomes(name="viscous", values={"viscous_exponent": 1.0}),)
    viscous_coefficient: ViscousCoefficient
    viscous_exponent: ViscousExponent

    @override
    def flow(self, p: base.Values, s: base.Slip) -> Scalar:
        sigma_2, n = p.viscous_coefficient, p.viscous_exponent
        if isinstance(n, (float, int)) and n == 1.0:  # it has a slope at rest, and needs no plateau
            return sigma_2 * s.along
        # named by its switch, the end of the plateau is stepped onto and not over
        w = where(s.speed < PLATEAU, PLATEAU, s.speed)
        return sigma_2 * power(w, n - 1.0) * s.along


class Drag(base.Flow):
    """In proportion to the square of the speed, as of motion through air or oil."""

    name = "drag"
    tex = r"c v |v|"
    vanishes = {"quadratic_coefficient": 0.0}
    quadratic_coefficient: Annotated[
        float,
        Quantity("c", "N s^2/m^2", low=0, scale="drag", bounds=(0.0, 100.0), start=0.1),
        Doc("Growth of the friction force with the square of the slip speed."),
    ]

    @override
    def flow(self, p: base.Values, s: base.Slip) -> Scalar:
        return p.quadratic_coefficient * s.speed * s.along


class Saturating(base.Flow):
    """The traction of a lubricant that saturates with the speed."""

    name = "saturating"
    title = "saturating viscous"
    tex = r"\sigma_2 v_m \arctan(v / v_m)"
    vanishes = {"viscous_coefficient": 0.0}
    becomes = (base.Becomes(name="viscous", values={}, limits=("saturation_velocity",)),)
    viscous_coefficient: ViscousCoefficient
    saturation_velocity: Annotated[
        float,
        Quantity("v_m", "m/s", above=0, scale="speed", bounds=(1e-2, 1e2), start=0.5),
        Doc("Speed above which the force grows ever more slowly."),
    ]

    @override
    def flow(self, p: base.Values, s: base.Slip) -> Scalar:
        v_m = p.saturation_velocity
        return p.viscous_coefficient * v_m * arctan(s.along / v_m)


class Polynomial(base.Flow):
    """A polynomial of the speed, up to the power in its brackets."""

    name = "polynomial"
    title = "polynomial of speed"
    opposes = False
    argument = "number"
    tex = r"\textstyle\sum_{i=1}^{{0}} c_i |v|^i \operatorname{sgn} v"

    def __init__(self, degree: int = 1) -> None:
        self.degree = degree

    @override
    def of(self, argument: str) -> base.Part:
        return Polynomial(int(argument)) if argument.isdecimal() else self

    @property
    def _names(self) -> tuple[str, ...]:
        return tuple(f"speed_coefficient_{i + 1}" for i in range(self.degree))

    @functools.cached_property
    @override
    def parameters(self) -> tuple[base.Parameter, ...]:
        return tuple(
            base.Parameter(name=name, hint=_coefficient(i + 1), default=MISSING)
            for i, name in enumerate(self._names)
        )

    @property
    @override
    def vanishes(self) -> Mapping[str, float | str]:  # type: ignore[override]  # of as many
        """Coefficients of all powers, each at zero."""
        return dict.fromkeys(self._names, 0.0)

    @property
    @override
    def becomes(self) -> tuple[base.Becomes, ...]:  # type: ignore[override]
        first, *others = self._names
        values: dict[str, float | str] = {first: "viscous_coefficient"}
        return (base.Becomes(name="viscous", values={**values, **dict.fromkeys(others, 0.0)}),)

    @override
    def flow(self, p: base.Values, s: base.Slip) -> Scalar:
        # Horner's scheme from the highest power on; the last factor v has the sign.
        result: Scalar = 0.0
        for name in reversed(self._names):
            result = result * s.speed + getattr(p, name)
        return result * s.along


def _coefficient(power: int) -> object:
    """Return the type of the coefficient of a power of the speed."""
    raised = f"^{power}" if power > 1 else ""
    start = 0.1 if power == 1 else 0.0
    return Annotated[
        float,
        Quantity(
            f"c_{power}",
            f"N s{raised}/m{raised}",
            scale=f"force/speed{raised}",
            bounds=(-10.0, 10.0),
            start=start,
        ),
        Doc(f"Coefficient of the power {power} of the speed; friction is passive if none is < 0."),
    ]


# What multiplies a part, or one of its parameters, as an input of the contact changes.


class Linear(base.Factor):
    """A straight line through 1 where the input is 0."""

    name = "linear"
    tex = r"(1 + \alpha_{1} {0})"
    vanishes = {"slope": 0.0}
    slope: Annotated[
        float,
        Quantity("alpha_{0}", "1/{0}", scale="none", bounds=(-1.0, 1.0), start=0.0),
        Doc("Relative change of what is multiplied, over the input."),
    ]

    @override
    def factor(self, p: base.Values, s: base.Slip) -> Scalar:
        (x,) = s.inputs
        return 1.0 + p.slope * x


class Exponential(base.Factor):
    """A decay from 1 where the input is 0, as of a viscosity with the temperature."""

    name = "exponential"
    opposes = True
    tex = r"e^{-\beta_{1} {0}}"
    vanishes = {"decay": 0.0}
    decay: Annotated[
        float,
        Quantity("beta_{0}", "1/{0}", scale="none", bounds=(-1.0, 1.0), start=0.0),
        Doc("Relative decrease of what is multiplied, over the input."),
    ]

    @override
    def factor(self, p: base.Values, s: base.Slip) -> Scalar:
        (x,) = s.inputs
        return exp(-p.decay * x)


class Ripple(base.Factor):
    """One harmonic of the input, as of cogging and tooth mesh."""

    name = "ripple"
    positive_if = "if a^2 + b^2 <= 1 of each ripple"
    tex = r"(1 + a_{1} \cos(m_{1} {0}) + b_{1} \sin(m_{1} {0}))"
    vanishes = {"cosine": 0.0, "sine": 0.0}
    cosine: Annotated[
        float,
        Quantity("a_{0}", low=-1, high=1, scale="none", bounds=(-0.7, 0.7), start=0.0),
        Doc("Relative amplitude of the cosine."),
    ]
    sine: Annotated[
        float,
        Quantity("b_{0}", low=-1, high=1, scale="none", bounds=(-0.7, 0.7), start=0.0),
        Doc("Relative amplitude of the sine; friction stays above 0 where a^2 + b^2 < 1."),
    ]
    harmonic: Annotated[
        float,
        Quantity("m_{0}", "1/{0}", above=0),
        Doc("Phase over the input: of an angle the number of periods in a turn."),
    ] = 1.0

    @override
    def factor(self, p: base.Values, s: base.Slip) -> Scalar:
        (x,) = s.inputs
        phase = p.harmonic * x
        return 1.0 + p.cosine * cos(phase) + p.sine * sin(phase)

    @override
    def positive(self, p: base.Values) -> bool:
        return bool(p.cosine**2 + p.sine**2 <= 1.0)


# Smooth functions of the speed in place of the sign: such laws creep and never stick.

SmoothingVelocity = Annotated[
    float,
    Quantity("v_t", "m/s", above=0, scale="speed", bounds=(1e-4, 1.0), start=0.01),
    Doc("Speed over which the sign of the force changes."),
]


class Tanh(base.SmoothSign):
    """A hyperbolic tangent."""

    name = "tanh"
    tex = r"\tanh(v / v_t)"
    smoothing_velocity: SmoothingVelocity

    @override
    def shape(self, p: base.Values, s: base.Slip) -> Scalar:
        return tanh(s.speed / p.smoothing_velocity)


class Atan(base.SmoothSign):
    """An inverse tangent, which approaches the level slowly."""

    name = "atan"
    title = "arctan"
    compared = False
    tex = r"\frac{2}{\pi} \arctan(v / v_t)"
    smoothing_velocity: SmoothingVelocity

    @override
    def shape(self, p: base.Values, s: base.Slip) -> Scalar:
        return 2.0 / math.pi * arctan(s.speed / p.smoothing_velocity)


class Root(base.SmoothSign):
    """The speed over the root of its square plus a constant."""

    name = "root"
    title = "square root"
    compared = False
    tex = r"v / \sqrt{v^2 + v_t^2}"
    smoothing_velocity: SmoothingVelocity

    @override
    def shape(self, p: base.Values, s: base.Slip) -> Scalar:
        v_t = p.smoothing_velocity
        return s.speed / sqrt(s.speed * s.speed + v_t * v_t)


class Ramp(base.SmoothSign):
    """A straight line up to the smoothing velocity."""

    name = "ramp"
    compared = False
    tex = r"\min(|v| / v_t, 1) \operatorname{sgn} v"
    smoothing_velocity: SmoothingVelocity

    @override
    def shape(self, p: base.Values, s: base.Slip) -> Scalar:
        v_t = p.smoothing_velocity
        return where(s.speed < v_t, s.speed / v_t, 1.0)


class Threlfall(base.SmoothSign):
    """An exponential rise that reaches the level at the smoothing velocity."""

    name = "threlfall"
    title = "Threlfall"
    compared = False
    tex = (
        r"\frac{1 - e^{-3|v|/v_t}}{1 - e^{-3}} \operatorname{sgn} v"
        r" \text{ below } v_t, \operatorname{sgn} v \text{ above}"
    )
    smoothing_velocity: SmoothingVelocity

    @override
    def shape(self, p: base.Values, s: base.Slip) -> Scalar:
        v_t = p.smoothing_velocity
        # Divided by its value at v_t, so that the level is reached there.
        rise = (1.0 - exp(-3.0 * s.speed / v_t)) / (1.0 - math.exp(-3.0))
        return where(s.speed < v_t, rise, 1.0)
