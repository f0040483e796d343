"""What multiplies a part, or one of its parameters, as an input of the contact changes."""

from typing import Annotated, final

from typing_extensions import Doc, override

from stickslip.friction.parts.base import Factor, Slip, Values
from stickslip.maths import Scalar, cos, exp, sin
from stickslip.quantities import Quantity


@final
class Linear(Factor):
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
    def factor(self, p: Values, s: Slip) -> Scalar:
        (x,) = s.inputs
        return 1.0 + p.slope * x


@final
class Exponential(Factor):
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
    def factor(self, p: Values, s: Slip) -> Scalar:
        (x,) = s.inputs
        return exp(-p.decay * x)


@final
class Ripple(Factor):
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
    def factor(self, p: Values, s: Slip) -> Scalar:
        (x,) = s.inputs
        phase = p.harmonic * x
        return 1.0 + p.cosine * cos(phase) + p.sine * sin(phase)

    @override
    def positive(self, p: Values) -> bool:
        return bool(p.cosine**2 + p.sine**2 <= 1.0)
