"""Smooth functions of the speed in place of the sign: such laws creep and never stick."""

import math
from typing import Annotated, final

from typing_extensions import Doc, override

from stickslip.friction.parts.base import Slip, SmoothSign, Values
from stickslip.maths import Scalar, arctan, exp, sqrt, tanh, where
from stickslip.quantities import Quantity

SmoothingVelocity = Annotated[
    float,
    Quantity("v_t", "m/s", above=0, scale="speed", bounds=(1e-4, 1.0), start=0.01),
    Doc("Speed over which the sign of the force changes."),
]


@final
class Tanh(SmoothSign):
    """A hyperbolic tangent."""

    name = "tanh"
    tex = r"\tanh(v / v_t)"
    smoothing_velocity: SmoothingVelocity

    @override
    def shape(self, p: Values, s: Slip) -> Scalar:
        return tanh(s.speed / p.smoothing_velocity)


@final
class Atan(SmoothSign):
    """An inverse tangent, which approaches the level slowly."""

    name = "atan"
    title = "arctan"
    compared = False
    tex = r"\frac{2}{\pi} \arctan(v / v_t)"
    smoothing_velocity: SmoothingVelocity

    @override
    def shape(self, p: Values, s: Slip) -> Scalar:
        return 2.0 / math.pi * arctan(s.speed / p.smoothing_velocity)


@final
class Root(SmoothSign):
    """The speed over the root of its square plus a constant."""

    name = "root"
    title = "square root"
    compared = False
    tex = r"v / \sqrt{v^2 + v_t^2}"
    smoothing_velocity: SmoothingVelocity

    @override
    def shape(self, p: Values, s: Slip) -> Scalar:
        v_t = p.smoothing_velocity
        return s.speed / sqrt(s.speed * s.speed + v_t * v_t)


@final
class Ramp(SmoothSign):
    """A straight line up to the smoothing velocity."""

    name = "ramp"
    compared = False
    tex = r"\min(|v| / v_t, 1) \operatorname{sgn} v"
    smoothing_velocity: SmoothingVelocity

    @override
    def shape(self, p: Values, s: Slip) -> Scalar:
        v_t = p.smoothing_velocity
        return where(s.speed < v_t, s.speed / v_t, 1.0)


@final
class Threlfall(SmoothSign):
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
    def shape(self, p: Values, s: Slip) -> Scalar:
        v_t = p.smoothing_velocity
        rise = (1.0 - exp(-3.0 * s.speed / v_t)) / (1.0 - math.exp(-3.0))
        return where(s.speed < v_t, rise, 1.0)
