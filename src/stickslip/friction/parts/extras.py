"""Levels that an input of the contact adds: loads of gears, pressures of seals."""

from typing import Annotated, final

from typing_extensions import Doc, override

from stickslip.friction.parts.base import Becomes, Extra, Slip, Values
from stickslip.friction.parts.levels import fade
from stickslip.maths import Scalar, where
from stickslip.quantities import Quantity


class Fading(Extra):
    """A level that fades as the static surplus does."""

    needs = ("stribeck_velocity", "fading_exponent")

    @override
    def left(self, p: Values, s: Slip) -> Scalar:
        return fade(s.speed, p.stribeck_velocity, p.fading_exponent)


@final
class Weight(Extra):
    """In proportion to the size of an input."""

    name = "weight"
    title = "load"
    argument = "input"
    tex = r"\mu_{1} |{0}|"
    vanishes = {"coefficient": 0.0}
    coefficient: Annotated[
        float,
        Quantity("mu_{0}", "1/{0}", low=0, scale="level", bounds=(0.0, 2.0), start=0.05),
        Doc("Growth of the level with the size of the input."),
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        (x,) = s.inputs
        return p.coefficient * abs(x)


@final
class WeightFading(Fading):
    """In proportion to the size of an input, fading as the static surplus does."""

    name = "weight_fading"
    title = "load that fades"
    argument = "input"
    tex = r"\mu_{s{1}} |{0}| e^{-|v/v_s|^n}"
    vanishes = {"static_surplus": 0.0}
    static_surplus: Annotated[
        float,
        Quantity("mu_s{0}", "1/{0}", low=0, scale="level", bounds=(0.0, 2.0), start=0.05),
        Doc("Growth of the level at vanishing speed with the size of the input, beside the rest."),
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        (x,) = s.inputs
        return p.static_surplus * abs(x)


@final
class Weight2(Extra):
    """In proportion to the square of an input."""

    name = "weight2"
    title = "load squared"
    argument = "input"
    tex = r"c_{1} {0}^2"
    vanishes = {"quadratic_coefficient": 0.0}
    quadratic_coefficient: Annotated[
        float,
        Quantity("c_{0}", "1/{0}^2", low=0, scale="level", bounds=(0.0, 2.0), start=0.05),
        Doc("Growth of the level with the square of the input."),
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        (x,) = s.inputs
        return p.quadratic_coefficient * x * x


def share(symbol: str) -> Quantity:
    """Return the quantity of a share of a torque that a gear loses."""
    return Quantity(symbol, "1/N", low=0, scale="level/force", bounds=(0.0, 1.0), start=0.05)


@final
class Gear(Extra):
    """The load of a gear that does not lose as much of the motor's torque as of the other side's.

    Where ``k_m motor = k_e external`` it is 0, although the gear is loaded.
    """

    name = "gear"
    title = "load of a gear"
    inputs = ("motor", "external")
    tex = r"|k_m \tau_m - k_e \tau_e|"
    vanishes = {"motor_friction": 0.0, "external_friction": 0.0}
    becomes = (
        Becomes(
            name="weight",
            argument="transmitted",
            values=dict.fromkeys(
                ("motor_friction", "external_friction"), "transmitted_coefficient"
            ),
        ),
    )
    motor_friction: Annotated[
        float, share("k_m"), Doc("Share of the motor's torque that is lost, over the load.")
    ]
    external_friction: Annotated[
        float, share("k_e"), Doc("Share of the external torque that is lost, over the load.")
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        motor, external = s.inputs
        return abs(p.motor_friction * motor - p.external_friction * external)


@final
class GearStribeck(Fading):
    """A load of the gear, fading as the static surplus does."""

    name = "gear_stribeck"
    title = "load of a gear that fades"
    inputs = ("motor", "external")
    tex = r"|k_{ms} \tau_m - k_{es} \tau_e| e^{-|v/v_s|^n}"
    vanishes = {"motor_static_friction": 0.0, "external_static_friction": 0.0}
    becomes = (
        Becomes(
            name="weight_fading",
            argument="transmitted",
            values=dict.fromkeys(
                ("motor_static_friction", "external_static_friction"), "transmitted_static_surplus"
            ),
        ),
    )
    motor_static_friction: Annotated[
        float,
        share("k_ms"),
        Doc("Share of the motor's torque that is lost beside the rest at vanishing speed."),
    ]
    external_static_friction: Annotated[
        float,
        share("k_es"),
        Doc("Share of the external torque that is lost beside the rest at vanishing speed."),
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        motor, external = s.inputs
        return abs(p.motor_static_friction * motor - p.external_static_friction * external)


def growth(symbol: str) -> Quantity:
    """Return the quantity of a growth with the square of a torque."""
    return Quantity(symbol, "1/N^2", low=0, scale="level/force^2", bounds=(0.0, 1.0), start=0.05)


@final
class GearQuadratic(Fading):
    """The square of the smaller one of two torques that oppose each other, fading.

    It jumps where both are equal.
    """

    name = "gear_quadratic"
    title = "load of a gear squared"
    inputs = ("motor", "external")
    tex = r"Q e^{-|v/v_s|^n}"
    tex_where = (
        r"Q = \begin{cases} q_e \tau_e^2 & |\tau_e| < |\tau_m| \\ q_m \tau_m^2 & |\tau_e| >"
        r" |\tau_m| \end{cases} \text{ where } \tau_m \tau_e < 0, \text{ else } 0"
    )
    vanishes = {"motor_quadratic": 0.0, "external_quadratic": 0.0}
    motor_quadratic: Annotated[
        float, growth("q_m"), Doc("Growth with the square of the motor's torque, if smaller.")
    ]
    external_quadratic: Annotated[
        float, growth("q_e"), Doc("Growth with the square of the external torque, if smaller.")
    ]

    @override
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        motor, external = s.inputs
        squared = where(
            abs(motor) > abs(external),
            p.external_quadratic * external * external,
            p.motor_quadratic * motor * motor,
        )
        return where(motor * external < 0.0, squared, 0.0)
