"""Laws of the literature, each a composition with what its source says of it."""

import math
from collections.abc import Mapping
from typing import Annotated, Any

from typing_extensions import Doc

from stickslip.friction.base import ALWAYS, Passivity, StaticCoefficient, Typical
from stickslip.friction.classes import composed
from stickslip.quantities import Quantity

BRISTLE_DAMPING = Passivity(
    condition="if sigma_2 >= sigma_1 N (mu_s / mu_k - 1)",
    holds=lambda law, load: _is_viscous_enough(law, load, ""),
)
"""What constant damping of bristles asks of the viscous part; of both directions if they differ."""


def _is_viscous_enough(law: Any, load: float, side: str) -> bool:
    level, rest = (getattr(law, f"{side}{name}_coefficient") for name in ("kinetic", "static"))
    viscous = getattr(law, f"{side}viscous_coefficient")
    return bool(viscous >= law.bristle_damping * load * (rest / level - 1.0))


SIDES = ("forward_", "backward_")


def _each(name: str) -> tuple[str, ...]:
    """Return the fields of a parameter that each direction has."""
    return tuple(side + name for side in SIDES)


def _both_ways(values: Mapping[str, float], *names: str) -> dict[str, float]:
    """Return values that are the same in both directions, under the names of each."""
    ways = {key: values[name] for name in names for key in _each(name)}
    return ways | {name: value for name, value in values.items() if name not in names}


LEVEL = {"kinetic_coefficient": 1.0}
SLIDING = {**LEVEL, "viscous_coefficient": 0.4}
FADING = {**SLIDING, "static_coefficient": 1.5, "stribeck_velocity": 1e-3}
"""The curve of Canudas de Wit et al. (1995), which the examples of other laws share."""
SMOOTH = {"smoothing_velocity": 1e-3}
STIFF = {"bristle_stiffness": 1e5}
DAMPED = {**STIFF, "bristle_damping": 316.227766}
CREEPS = (
    "It never sticks: below its largest force a body creeps at the speed at which friction balances"
    " the force."
)
OFFSET = "A constant force cannot be distinguished from half the difference of the levels."
DRIFTS = "Under a constant force with a ripple below break-away a body drifts instead of resting."


@composed("level + step")
class Coulomb:
    """Constant kinetic friction, with an optional higher static level.

    >>> law.break_away(load=9.81)
    3.4335
    """

    name = "coulomb"
    title = "Coulomb"
    sources = ("coulomb1785", "morin1833")
    on_request = False
    typical = Typical(values={"kinetic_coefficient": 0.25, "static_coefficient": 0.35})
    fit_order = ("kinetic_coefficient",)


@composed("viscous")
class Viscous:
    """Friction of a fluid film, proportional to the speed, without a static level.

    A body under it never comes to rest in finite time.

    >>> law.force(0.5, load=9.81)
    0.2
    """

    name = "viscous"
    title = "Viscous"
    sources = ("reynolds1886",)
    on_request = False
    typical = Typical(values={"viscous_coefficient": 0.4})
    defects = "A body under it never comes to rest."


@composed("level + viscous + step")
class CoulombViscous:
    """A constant level plus a viscous part proportional to the speed.

    >>> law.force(0.5, load=10.0)
    10.2
    """

    name = "coulomb-viscous"
    title = "Coulomb + viscous"
    sources = ("coulomb1785", "reynolds1886", "morin1833")
    on_request = False
    typical = Typical(values=SLIDING)
    fit_order = ("kinetic_coefficient", "viscous_coefficient")


@composed("level + step + viscous")
class CoulombViscousStatic:
    """A static level, a lower kinetic level, and a viscous part proportional to the speed.

    The third of the classical laws. `CoulombViscous` with a static coefficient has the same forces,
    but there the static level is given; here it is a parameter like the others, and fitted where
    the data tell it.

    >>> law.force(0.5, load=10.0), law.break_away(load=10.0)
    (10.2, 15.0)
    """

    name = "coulomb-viscous-static"
    title = "Coulomb + viscous + static"
    sources = ("coulomb1785", "morin1833", "reynolds1886")
    typical = Typical(values={**SLIDING, "static_coefficient": 1.5})
    fit_order = ("kinetic_coefficient", "viscous_coefficient", "static_coefficient")

    static_coefficient: StaticCoefficient


@composed("both_ways(level + viscous)")
class DirectionDependent:
    """Separate levels and viscous parts for each direction: screws, cable drives, preloaded guides.

    A constant force cannot be distinguished from half of their difference: give the mechanism
    an offset, or let the levels differ, not both, unless something else tells them apart.

    >>> law.towards(-1).title, law.towards(-1).break_away(load=1.0)
    ('Coulomb + viscous', 20.6277)
    """

    name = "direction-dependent"
    title = "Direction-dependent"
    sources = ("armstrong1991", "janot2019")
    typical = Typical(
        source="janot2019",
        values={
            "forward_kinetic_coefficient": 20.1440,
            "backward_kinetic_coefficient": 20.6277,
            "forward_viscous_coefficient": 166.7061,
            "backward_viscous_coefficient": 240.4236,
        },
    )
    defects = OFFSET
    fit_order = (*_each("kinetic_coefficient"), *_each("viscous_coefficient"))

    forward_viscous_coefficient = 0.0
    backward_viscous_coefficient = 0.0


@composed("level + power")
class PowerViscous:
    """A constant level plus a power of the speed, as for shear-thinning lubricants.

    Below a micrometre a second the power gives way to the straight line that meets it there. With
    no level a body creeps to rest along this line in no finite time, as with viscous friction.

    >>> law.force(0.25, load=1.0)
    1.2
    """

    name = "power-viscous"
    title = "Coulomb + power of speed"
    sources = ("coulomb1785", "bittencourt2012")
    typical = Typical(values={**SLIDING, "viscous_exponent": 0.5})
    defects = "Below 1 the power has no bounded slope at rest: below 1e-6 m/s it is linear."
    fit_order = ("kinetic_coefficient", "viscous_coefficient", "viscous_exponent")

    viscous_exponent: Annotated[
        float,
        Quantity("p", above=0, structural=True, scale="none", bounds=(0.2, 3.0), start=0.8),
        Doc("Power of the speed: 1 is viscous friction, below 1 the lubricant thins."),
    ] = 0.5


@composed("level + viscous + drag")
class QuadraticDrag:
    """A constant level, a viscous part and quadratic drag, for motion through air or oil.

    >>> law.force(-0.5, load=1.0)
    -1.25
    """

    name = "quadratic-drag"
    title = "Coulomb + viscous + drag"
    sources = ("coulomb1785", "reynolds1886", "newton1687")
    typical = Typical(values={**SLIDING, "quadratic_coefficient": 0.2})

    viscous_coefficient = 0.0
    quadratic_coefficient = 0.0


@composed("level + stribeck + viscous + peak")
class Stribeck:
    """A kinetic level, a static excess that decays with speed, and a viscous part.

    The force that rest gives way to may lie above what sliding begins with: the factor ``peak`` of
    the Modelica library is ``break_away_coefficient / static_coefficient``.

    >>> round(law.force(1e-9, load=10.0), 6), law.force(1.0, load=10.0), law.break_away(10.0)
    (15.0, 10.4, 15.0)
    """

    name = "stribeck"
    title = "Stribeck"
    sources = ("stribeck1902", "bo1982", "armstrong1991", "otter1999")
    on_request = False
    typical = Typical(values=FADING)
    defects = (
        "The static surplus is left in less than a millisecond: few records resolve its shape."
    )
    fit_order = (
        "kinetic_coefficient",
        "viscous_coefficient",
        "stribeck_velocity",
        "static_coefficient",
    )

    viscous_coefficient = 0.0


@composed("dahl(level) + power")
class Dahl:
    """Elastic at small displacements, Coulomb friction at large ones: hysteresis without stiction.

    A viscous part may stand beside the bristles; that of a lubricant that thins grows with a power
    of the speed below 1, as in the joints of robots. Below a micrometre a second it is linear.

    >>> law.steady(-0.1, load=9.81)
    -9.85
    """

    name = "dahl"
    title = "Dahl"
    sources = ("dahl1968",)
    on_request = False
    typical = Typical(values={**SLIDING, **STIFF})
    passivity = ALWAYS
    defects = "It has no static level. " + DRIFTS
    fit_order = (
        "kinetic_coefficient",
        "bristle_stiffness",
        "viscous_coefficient",
        "yield_exponent",
    )

    viscous_coefficient = 0.0
    viscous_exponent = 1.0


@composed("lugre(level + stribeck) + power")
class LuGre:
    """Presliding, Stribeck curve, frictional lag and rate-dependent break-away with one state.

    The viscous part may grow with a power of the speed, as that of a lubricant that thins; below a
    micrometre a second it is linear.

    >>> round(law.steady(0.1, load=1.0), 9)
    1.04
    """

    name = "lugre"
    title = "LuGre"
    sources = ("canudas1995", "canudas1999")
    on_request = False
    typical = Typical(source="canudas1995", values={**FADING, **DAMPED})
    passivity = BRISTLE_DAMPING
    defects = DRIFTS
    fit_order = (
        "kinetic_coefficient",
        "viscous_coefficient",
        "bristle_stiffness",
        "static_coefficient",
        "stribeck_velocity",
        "bristle_damping",
    )

    viscous_coefficient = 0.0
    viscous_exponent = 1.0


@composed("level + tustin + viscous")
class Tustin:
    """A static surplus that fades exponentially with the speed itself, and a viscous part.

    It is `Stribeck` with the exponent 1.

    >>> round(law.force(1e-3, load=1.0), 6)
    1.18434
    """

    name = "tustin"
    title = "Tustin"
    sources = ("tustin1947",)
    typical = Typical(values=FADING)
    defects = "The curve has a corner at rest."


@composed("level + lorentz + viscous")
class HessSoom:
    """A static surplus that fades with the square of the speed, and a viscous part.

    >>> round(law.force(1e-3, load=1.0), 6)
    1.2504
    """

    name = "hess-soom"
    title = "Hess and Soom"
    sources = ("hess1990",)
    typical = Typical(values=FADING)
    defects = (
        "The surplus fades slowly: a thousandth of it is left at 32 times the Stribeck velocity."
    )


@composed("level + hyperbolic + viscous")
class PoppStelter:
    """A static surplus that fades in inverse proportion to the speed, and a viscous part.

    >>> round(law.force(3e-3, load=1.0), 6)
    1.1262
    """

    name = "popp-stelter"
    title = "Popp and Stelter"
    sources = ("popp1990",)
    typical = Typical(values=FADING)
    defects = (
        "The surplus fades slowly: a thousandth of it is left at 999 times the Stribeck velocity."
    )


@composed("level + stribeck + power")
class StribeckPower:
    """A static surplus that fades with the speed, and a power of the speed as viscous part.

    The curve of a lubricated robot joint: boundary lubrication at rest, a lubricant that thins at
    high speed. Below a micrometre a second the power is linear.

    >>> round(law.force(0.25, load=1.0), 6)
    1.17411
    """

    name = "stribeck-power"
    title = "Stribeck + power of speed"
    sources = ("stribeck1902", "bittencourt2012")
    fit_order = (
        "kinetic_coefficient",
        "viscous_coefficient",
        "viscous_exponent",
        "stribeck_velocity",
        "static_coefficient",
    )
    typical = Typical(values={**FADING, "viscous_exponent": 0.6})

    viscous_exponent = 1.0


@composed("both_ways(level + stribeck + viscous)")
class DirectionalStribeck:
    """Stribeck friction with all parameters of its own in each direction.

    >>> law.directional, law.towards(-1).title
    (True, 'Stribeck')
    """

    name = "directional-stribeck"
    title = "Stribeck by direction"
    sources = ("stribeck1902", "armstrong1991")
    fit_order = tuple(key for name in Stribeck.fit_order for key in _each(name))
    typical = Typical(values=_both_ways(FADING, *FADING))
    defects = OFFSET


@composed("level + saturating")
class SaturatingViscous:
    """A constant level plus the traction of a lubricant that saturates with the speed.

    >>> round(law.force(0.5, load=1.0), 6)
    1.15708
    """

    name = "saturating-viscous"
    title = "Coulomb + saturating viscous"
    sources = ("coulomb1785", "reynolds1886")
    typical = Typical(values={**SLIDING, "saturation_velocity": 0.5})
    defects = "The arctangent is a choice of this package, no formula of a publication."


@composed("tanh(level) + viscous")
class TanhCoulomb:
    """A hyperbolic tangent in place of the sign, and a viscous part.

    >>> round(law.force(1e-3, load=1.0), 6), law.break_away(1.0)
    (0.761994, 0.0)
    """

    name = "tanh"
    title = "Coulomb by tanh"
    sources = ("andersson2007",)
    typical = Typical(values={**SLIDING, **SMOOTH})
    defects = CREEPS


@composed("atan(level) + viscous")
class ArctanCoulomb:
    """An inverse tangent in place of the sign, and a viscous part.

    >>> round(law.force(1e-3, load=1.0), 6)
    0.5004
    """

    name = "arctan"
    title = "Coulomb by arctan"
    sources = ("mostaghel1997",)
    typical = Typical(values={**SLIDING, **SMOOTH})
    defects = CREEPS + " The level is approached slowly: at 64 times the smoothing velocity to 1 %."


@composed("root(level) + viscous")
class RootCoulomb:
    """The speed over the root of its square plus a constant in place of the sign.

    >>> round(law.force(1e-3, load=1.0), 6)
    0.707507
    """

    name = "root"
    title = "Coulomb by a square root"
    sources = ("mostaghel1997",)
    typical = Typical(values={**SLIDING, **SMOOTH})
    defects = CREEPS


@composed("ramp(level)")
class Ambrosio:
    """Coulomb friction with a straight line through rest.

    The published law has a second, smaller speed below which there is no friction at all; it is 0
    here.

    >>> law.force(5e-4, load=1.0), law.force(2e-3, load=1.0)
    (0.5, 1.0)
    """

    name = "ambrosio"
    title = "Ambrósio"
    sources = ("ambrosio2003",)
    typical = Typical(values={**LEVEL, **SMOOTH})
    defects = CREEPS


@composed("threlfall(level)")
class Threlfall:
    """Coulomb friction that rises exponentially from rest to its level at the smoothing velocity.

    The published rise is divided by 0.95; here it is divided by 1 - exp(-3) = 0.9502, so that there
    is no jump where it ends.

    >>> round(law.force(5e-4, load=1.0), 6), law.force(2e-3, load=1.0)
    (0.817574, 1.0)
    """

    name = "threlfall"
    title = "Threlfall"
    sources = ("threlfall1978",)
    typical = Typical(values={**LEVEL, **SMOOTH})
    defects = CREEPS


@composed("tanh(level + stribeck) + viscous")
class TanhStribeck:
    """A Stribeck curve with a hyperbolic tangent in place of the sign.

    >>> round(law.force(3e-4, load=1.0), 6)
    1.449881
    """

    name = "tanh-stribeck"
    title = "Stribeck by tanh"
    sources = ("andersson2007",)
    typical = Typical(values={**FADING, "smoothing_velocity": 1e-4})
    defects = CREEPS + " The peak stays below mu_s."


@composed("brown_mcphee + viscous")
class BrownMcPhee:
    """One smooth curve that peaks near mu_s at the transition velocity, and a viscous part.

    There it is mu_s less mu_k (1 - tanh 4), 0.0007 mu_k.

    >>> round(law.force(1e-3, load=1.0), 2)
    1.5
    """

    name = "brown-mcphee"
    title = "Brown and McPhee"
    sources = ("brown2016",)
    typical = Typical(values={**SLIDING, "static_coefficient": 1.5, "transition_velocity": 1e-3})
    defects = CREEPS


@composed("simscape + viscous")
class Simscape:
    """The curve of the Translational Friction block: a bump on a hyperbolic tangent.

    Without the viscous part it is mu_s at the break-away velocity, less mu_k (1 - tanh 10), which
    is 4e-9 mu_k. It is largest there if mu_s is above mu_k.

    >>> round(law.force(1e-3, load=1.0), 6)
    1.5004
    """

    name = "simscape"
    title = "Simscape"
    sources = ("simscape",)
    typical = Typical(values={**SLIDING, "static_coefficient": 1.5, "breakaway_velocity": 1e-3})
    defects = CREEPS


@composed("dahl(level + stribeck) + power")
class DahlStribeck:
    """Bristles that yield as Dahl's at a level that falls with the speed.

    >>> law.steady(1.0, load=1.0), law.break_away(1.0)
    (1.4, 1.5)
    """

    name = "dahl-stribeck"
    title = "Dahl + Stribeck"
    sources = ("dahl1968", "stribeck1902", "bittencourt2012")
    fit_order = (
        "kinetic_coefficient",
        "bristle_stiffness",
        "viscous_coefficient",
        "viscous_exponent",
        "static_coefficient",
        "stribeck_velocity",
    )
    typical = Typical(values={**FADING, **STIFF, "viscous_exponent": 0.6})
    passivity = ALWAYS
    defects = DRIFTS

    viscous_exponent = 1.0


@composed("dahl(both_ways[levels](level + stribeck)) + both_ways[levels](power)")
class DirectionalDahl:
    """Bristles that yield at levels of their own in each direction, beside a thinning lubricant.

    >>> law.directional, law.towards(-1).title
    (True, 'Dahl + Stribeck')
    """

    name = "directional-dahl"
    title = "Dahl + Stribeck by direction"
    sources = ("dahl1968", "stribeck1902", "bittencourt2012")
    fit_order = (
        *_each("kinetic_coefficient"),
        "bristle_stiffness",
        *_each("viscous_coefficient"),
        "viscous_exponent",
        *_each("static_coefficient"),
        "stribeck_velocity",
    )
    typical = Typical(
        values={
            **_both_ways(
                FADING, "kinetic_coefficient", "static_coefficient", "viscous_coefficient"
            ),
            **STIFF,
            "viscous_exponent": 0.6,
        }
    )
    passivity = ALWAYS
    defects = DRIFTS

    viscous_exponent = 1.0


@composed("lugre_fading(level + stribeck) + viscous")
class LuGreFading:
    """LuGre bristles whose damping fades with the speed.

    >>> round(law.steady(0.1, load=1.0), 9)
    1.04
    """

    name = "lugre-fading"
    title = "LuGre with fading damping"
    sources = ("olsson1996",)
    fit_order = (*LuGre.fit_order, "damping_velocity")
    typical = Typical(values={**FADING, **DAMPED, "damping_velocity": 1e-3})
    passivity = Passivity(
        condition="if sigma_1 v_d <= 4 sqrt(2 e) mu_k",
        holds=lambda law, _load: (
            law.bristle_damping * law.damping_velocity
            <= 4.0 * math.sqrt(2.0 * math.e) * law.kinetic_coefficient
        ),
    )
    defects = DRIFTS


@composed("lugre(both_ways[levels](level + stribeck)) + both_ways[levels](viscous)")
class DirectionalLuGre:
    """LuGre bristles with levels and viscous parts of their own in each direction.

    >>> law.directional, law.towards(-1).title
    (True, 'LuGre + viscous')
    """

    name = "directional-lugre"
    title = "LuGre by direction"
    sources = ("canudas1995",)
    fit_order = (
        *_each("kinetic_coefficient"),
        *_each("viscous_coefficient"),
        "bristle_stiffness",
        *_each("static_coefficient"),
        "stribeck_velocity",
        "bristle_damping",
    )
    typical = Typical(
        values={
            **_both_ways(
                FADING, "kinetic_coefficient", "static_coefficient", "viscous_coefficient"
            ),
            **DAMPED,
        }
    )
    passivity = Passivity(
        condition="if sigma_2 >= sigma_1 N (mu_s / mu_k - 1) in each direction",
        holds=lambda law, load: all(_is_viscous_enough(law, load, side) for side in SIDES),
    )
    defects = DRIFTS


@composed("elasto_plastic(level + stribeck) + viscous")
class ElastoPlastic:
    """A bristle that does not yield below a share of its largest deflection, and so does not drift.

    >>> law.rates(1.0, 1.0, (0.5e-5,))  # below the elastic share the bristle moves with the body
    (1.0,)
    """

    name = "elasto-plastic"
    title = "Elasto-plastic"
    sources = ("dupont2002",)
    fit_order = (*LuGre.fit_order, "elastic_share")
    typical = Typical(values={**FADING, **DAMPED, "elastic_share": 0.7})
    passivity = BRISTLE_DAMPING


@composed("bouc_wen(level) + viscous")
class BoucWen:
    """A loop whose sides bend differently on loading and on unloading, and a viscous part.

    >>> law.rates(1.0, 1.0, (0.5e-5,)), law.rates(-1.0, 1.0, (0.5e-5,))
    ((0.75,), (-1.0,))
    """

    name = "bouc-wen"
    title = "Bouc-Wen"
    sources = ("bouc1967", "wen1976")
    typical = Typical(values={**SLIDING, **STIFF})
    passivity = ALWAYS
    defects = DRIFTS + " Inner loops do not close: what was before a turn is forgotten."


@composed("maxwell[4](level) + viscous")
class MaxwellSlip:
    """Four elastic elements that yield one after the other, and a viscous part.

    Inner loops close, and after that the force goes on along the outer loop: a non-local memory.

    >>> law.states, law.steady(1.0, load=1.0)
    (('z1', 'z2', 'z3', 'z4'), 1.4)
    """

    name = "maxwell-slip"
    title = "Maxwell slip, 4 elements"
    sources = ("iwan1966",)
    typical = Typical(values={**SLIDING, **STIFF})
    passivity = ALWAYS
    defects = "Its first loading is a line of four straight pieces."


# Laws that ask the contact for more than speed and load.


@composed("level + viscous * exponential[temperature]")
class WarmViscous:
    """A constant level plus a viscous part that falls as the lubricant warms up.

    The viscous coefficient is that at 0 degC.

    >>> from stickslip.friction import bound
    >>> [round(bound(law, {"temperature": T}).force(0.5, load=1.0), 6) for T in (0.0, 40.0)]
    [1.2, 1.060239]
    """

    name = "warm-viscous"
    title = "Coulomb + viscous that warms up"
    sources = ("simoni2015",)
    typical = Typical(values={**SLIDING, "viscous_temperature_decay": 0.03})
    defects = "A record of one temperature cannot tell the decay from the viscous coefficient."
    compared = False


@composed(
    "level + stribeck * linear[temperature, stribeck_velocity] + weight[gravity]"
    " + weight_fading[gravity] + viscous * exponential[temperature]"
)
class JointLoadTemperature:
    """Friction of a robot's joint that grows with its load and changes with the temperature.

    Level and static surplus grow with the size of the load torque; the Stribeck velocity grows and
    the viscous part falls with the temperature. Of the source only the abstract could be read: it
    adds load torque and temperature to a static model. No term and none of its published values
    are compared with it; the values below are made up.

    >>> law.inputs
    ('temperature', 'gravity')
    """

    name = "joint-load-temperature"
    title = "Joint with load and temperature"
    sources = ("bittencourt2012",)
    typical = Typical(
        values={
            **FADING,
            "stribeck_velocity_temperature_slope": 0.02,
            "gravity_coefficient": 0.05,
            "gravity_static_surplus": 0.05,
            "viscous_temperature_decay": 0.03,
        }
    )
    passivity = Passivity(
        condition="1 + alpha_T T > 0, so that the Stribeck velocity is above 0",
        holds=lambda law, _load: law.stribeck_velocity_temperature_slope >= 0.0,
    )
    defects = (
        "One Stribeck velocity for both parts, and a viscous part that any temperature takes away:"
        " the source may have more terms."
    )
    compared = False


@composed("level * ripple[position] + viscous")
class Cogging:
    """A level with one harmonic of the position, as of meshing teeth, and a viscous part.

    Of an angle, the harmonic is the number of periods in a turn.

    >>> from stickslip.friction import bound
    >>> bound(law, {"position": 0.0}).break_away(load=1.0)
    1.3
    """

    name = "cogging"
    title = "Coulomb with teeth + viscous"
    sources = ("coulomb1785", "reynolds1886")
    typical = Typical(
        values={
            **SLIDING,
            "level_position_cosine": 0.3,
            "level_position_sine": 0.1,
            "level_position_harmonic": 12.0,
        }
    )
    passivity = Passivity(
        condition="a_x^2 + b_x^2 <= 1",
        holds=lambda law, _load: law.level_position_cosine**2 + law.level_position_sine**2 <= 1.0,
    )
    defects = "A force of cogging that is there at rest too, and drives, is none of friction."


@composed("level + viscous")
class BamM1:
    """The first one of six laws of servo motors: Coulomb friction and a viscous part.

    >>> round(law.force(1.0, load=1.0), 7)
    0.0241137
    """

    name = "bam-m1"
    title = "BAM M1, Coulomb"
    sources = ("duclusaud2025",)
    typical = Typical(
        values={"kinetic_coefficient": 0.0182117, "viscous_coefficient": 0.005902},
        source="duclusaud2025",
    )


@composed("level + stribeck + viscous")
class BamM2:
    """The second law of servo motors: with a static surplus that fades.

    The surplus that its source prints is ``static_coefficient - kinetic_coefficient``.

    >>> law.contained[0].law
    'stribeck'
    """

    name = "bam-m2"
    title = "BAM M2, Stribeck"
    sources = ("duclusaud2025",)
    typical = Typical(
        values={
            "kinetic_coefficient": 0.0186015,
            "static_coefficient": 0.0197028,
            "stribeck_velocity": 0.261268,
            "fading_exponent": 4.0,
            "viscous_coefficient": 0.00404797,
        },
        source="duclusaud2025",
    )


@composed("level + weight[transmitted] + viscous")
class BamM3:
    """The third law of servo motors: a level that grows with the torque that the gear transmits.

    >>> from stickslip.friction import bound
    >>> bound(law, {"transmitted": -2.0}).break_away(load=1.0)
    0.53047369
    """

    name = "bam-m3"
    title = "BAM M3, load of the gear"
    sources = ("duclusaud2025",)
    typical = Typical(
        values={
            "kinetic_coefficient": 0.00231969,
            "transmitted_coefficient": 0.264077,
            "viscous_coefficient": 0.0169039,
        },
        source="duclusaud2025",
    )


@composed("level + stribeck + weight[transmitted] + weight_fading[transmitted] + viscous")
class BamM4:
    """The fourth law of servo motors: a load of the gear of which a part fades with the speed.

    >>> [one.law for one in law.contained]
    ['stribeck', 'bam-m3']
    """

    name = "bam-m4"
    title = "BAM M4, load of the gear and Stribeck"
    sources = ("duclusaud2025",)
    typical = Typical(
        values={
            "kinetic_coefficient": 0.00215218,
            "static_coefficient": 0.00256646,
            "stribeck_velocity": 0.117806,
            "fading_exponent": 1.0,
            "transmitted_coefficient": 0.251587,
            "transmitted_static_surplus": 0.0520285,
            "viscous_coefficient": 0.0178197,
        },
        source="duclusaud2025",
    )


@composed("level + stribeck + gear + gear_stribeck + viscous")
class BamM5:
    """The fifth law of servo motors: a gear that loses another share of each torque.

    >>> law.inputs, [one.law for one in law.contained]
    (('motor', 'external'), ['bam-m4'])
    """

    name = "bam-m5"
    title = "BAM M5, directions of the gear"
    sources = ("duclusaud2025",)
    typical = Typical(
        values={
            "kinetic_coefficient": 0.00203918,
            "static_coefficient": 0.00203919,
            "stribeck_velocity": 0.222587,
            "fading_exponent": 2.32884,
            "motor_friction": 0.230076,
            "external_friction": 0.258258,
            "motor_static_friction": 5.00448e-07,
            "external_static_friction": 0.117008,
            "viscous_coefficient": 0.0186865,
        },
        source="duclusaud2025",
    )
    defects = "Where k_m tau_m = k_e tau_e it has no load, although the gear is loaded."


@composed("level + stribeck + gear + gear_stribeck + gear_quadratic + viscous")
class BamM6:
    """The sixth law of servo motors: with the square of the smaller of two opposed torques.

    >>> [one.law for one in law.contained]
    ['bam-m5']
    """

    name = "bam-m6"
    title = "BAM M6, quadratic in the torque"
    sources = ("duclusaud2025",)
    typical = Typical(
        values={
            "kinetic_coefficient": 0.00232584,
            "static_coefficient": 0.00251147,
            "stribeck_velocity": 0.115329,
            "fading_exponent": 1.0,
            "motor_friction": 0.23063,
            "external_friction": 0.260779,
            "motor_static_friction": 1.91577e-06,
            "external_static_friction": 0.151588,
            "motor_quadratic": 0.00559596,
            "external_quadratic": 0.00377471,
            "viscous_coefficient": 0.0185448,
        },
        source="duclusaud2025",
    )
    defects = BamM5.defects + " It jumps where both torques are equally large and opposed."


@composed("lugre(level + stribeck + weight[transmitted]) + viscous")
class LuGreGear:
    """Bristles whose largest force grows with the torque that a gear transmits.

    >>> law.inputs, law.states
    (('transmitted',), ('z',))
    """

    name = "lugre-gear"
    title = "LuGre with the load of a gear"
    sources = ("canudas1995", "duclusaud2025")
    typical = Typical(values={**FADING, **DAMPED, "transmitted_coefficient": 0.1})
    passivity = Passivity(
        condition=f"{BRISTLE_DAMPING.condition}, while the gear transmits the same torque",
        holds=BRISTLE_DAMPING.holds,
    )
    defects = DRIFTS


@composed("gms[4](level + stribeck) + viscous")
class GMS:
    """Generalised Maxwell slip: four elements that slip until the velocity turns, and lag then.

    An element that slips follows the Stribeck curve behind at the rate of the attraction, which is
    the frictional lag; before that inner loops close, as those of Maxwell slip do.

    >>> law.steady(0.1, load=1.0), law.force(0.1, 1.0, (1e-6, 1e-6, 1e-6, 1e-6))
    (1.04, 0.14)
    """

    name = "gms"
    title = "Generalised Maxwell slip, 4 elements"
    sources = ("albender2005", "lampaert2003")
    fit_order = (*LuGre.fit_order[:-1], "attraction")
    typical = Typical(values={**FADING, **STIFF, "attraction": 10.0})
    passivity = Passivity(
        condition="if mu_s = mu_k",
        holds=lambda law, _: bool(law.static_coefficient == law.kinetic_coefficient),
    )
    defects = (
        "Elements that slip slowly grow stronger at no cost, so that with a falling curve it can"
        " return more than it took."
    )


@composed("reset(level)")
class HaessigFriedland:
    """Reset integrator: a damped spring, stiffer while it sticks, and a level where it gives way.

    >>> law.break_away(1.0), law.steady(0.1, load=1.0)
    (1.5, 1.0)
    """

    name = "haessig-friedland"
    title = "Haessig-Friedland reset integrator"
    sources = ("haessig1991", "olsson1998")
    typical = Typical(values={**LEVEL, **STIFF, "bristle_damping": 100.0, "sticking_surplus": 0.5})
    passivity = ALWAYS
    defects = "The force jumps where the spring gives way, and where slip turns."


@composed("bliman_sorine(level)")
class BlimanSorine:
    """Two springs of which one is taken off: break-away exceeds the level, and fades by distance.

    Nothing in it depends on the speed. The model of first order is Dahl's plain law.

    >>> round(law.break_away(1.0), 6), law.steady(0.1, load=1.0)
    (1.203253, 1.0)
    """

    name = "bliman-sorine"
    title = "Bliman-Sorine, second order"
    sources = ("bliman1995", "olsson1998")
    typical = Typical(values={**LEVEL, **STIFF, "surplus_share": 0.5, "distance_ratio": 0.2})
    passivity = ALWAYS
    defects = DRIFTS + " The force of break-away comes back with distance, not with time."
