"""Laws whose contact deflects before it slips."""

from stickslip.friction.base import BristleLaw
from stickslip.friction.composition import composed


@composed("dahl(level) + power", names={"yield_exponent": "exponent"})
class Dahl(BristleLaw):
    """Elastic at small displacements, Coulomb friction at large ones: hysteresis without stiction.

    A viscous part may stand beside the bristles; that of a lubricant that thins grows with a power
    of the speed below 1, as in the joints of robots. Below a micrometre a second it is linear.

    Examples
    --------
    >>> law = Dahl(kinetic_coefficient=0.25, bristle_stiffness=1e4)
    >>> law.steady(-0.1, load=9.81)
    -2.4525
    """

    name = "dahl"
    title = "Dahl"
    sources = ("dahl1968",)
    fit_order = (
        "kinetic_coefficient",
        "bristle_stiffness",
        "viscous_coefficient",
        "exponent",
    )

    viscous_coefficient = 0.0
    viscous_exponent = 1.0


@composed("lugre(level + stribeck) + power", names={"fading_exponent": "exponent"})
class LuGre(BristleLaw):
    """Presliding, Stribeck curve, frictional lag and rate-dependent break-away with one state.

    The viscous part may grow with a power of the speed, as that of a lubricant that thins; below a
    micrometre a second it is linear.

    Examples
    --------
    >>> law = LuGre(
    ...     kinetic_coefficient=1.0,
    ...     static_coefficient=1.5,
    ...     stribeck_velocity=1e-3,
    ...     bristle_stiffness=1e5,
    ...     bristle_damping=316.0,
    ...     viscous_coefficient=0.4,
    ... )
    >>> round(law.steady(0.1, load=1.0), 9)
    1.04
    """

    name = "lugre"
    title = "LuGre"
    sources = ("canudas1995", "canudas1999")
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
