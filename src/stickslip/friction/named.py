"""Laws of the literature, each a composition with what its source says of it."""

from typing import Annotated

from typing_extensions import Doc

from stickslip.friction.classes import composed
from stickslip.friction.coefficients import StaticCoefficient
from stickslip.quantities import Quantity


@composed("level + step")
class Coulomb:
    """Constant kinetic friction, with an optional higher static level.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35).break_away(load=9.81)
    3.4335
    """

    name = "coulomb"
    title = "Coulomb"
    sources = ("coulomb1785", "morin1833")
    fit_order = ("kinetic_coefficient",)


@composed("viscous")
class Viscous:
    """Friction of a fluid film, proportional to the speed, without a static level.

    A body under it never comes to rest in finite time.

    Examples
    --------
    >>> from stickslip import Viscous
    >>> Viscous(viscous_coefficient=2.0).force(0.5, load=9.81)
    1.0
    """

    name = "viscous"
    title = "Viscous"
    sources = ("reynolds1886",)


@composed("level + viscous + step")
class CoulombViscous:
    """A constant level plus a viscous part proportional to the speed.

    Examples
    --------
    >>> from stickslip import CoulombViscous
    >>> law = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.1)
    >>> law.force(0.5, load=10.0)
    2.55
    """

    name = "coulomb-viscous"
    title = "Coulomb + viscous"
    sources = ("coulomb1785", "reynolds1886", "morin1833")
    fit_order = ("kinetic_coefficient", "viscous_coefficient")


@composed("level + step + viscous")
class CoulombViscousStatic:
    """A static level, a lower kinetic level, and a viscous part proportional to the speed.

    The third of the classical laws. `CoulombViscous` with a static coefficient has the same forces,
    but there the static level is given; here it is a parameter like the others, and fitted where
    the data tell it.

    Examples
    --------
    >>> from stickslip import CoulombViscousStatic
    >>> law = CoulombViscousStatic(
    ...     kinetic_coefficient=0.25, static_coefficient=0.35, viscous_coefficient=0.1
    ... )
    >>> law.force(0.5, load=10.0), law.break_away(load=10.0)
    (2.55, 3.5)
    """

    name = "coulomb-viscous-static"
    title = "Coulomb + viscous + static"
    sources = ("coulomb1785", "morin1833", "reynolds1886")
    fit_order = ("kinetic_coefficient", "viscous_coefficient", "static_coefficient")
    on_request = True

    static_coefficient: StaticCoefficient


@composed("both_ways(level + viscous)")
class DirectionDependent:
    """Separate levels and viscous parts for each direction: screws, cable drives, preloaded guides.

    A constant force is not told apart from half the difference of the levels: give the mechanism
    an offset, or let the levels differ, not both, unless something else tells them apart.

    Examples
    --------
    >>> from stickslip import DirectionDependent
    >>> law = DirectionDependent(
    ...     forward_kinetic_coefficient=20.1,
    ...     backward_kinetic_coefficient=20.6,
    ...     forward_viscous_coefficient=166.7,
    ...     backward_viscous_coefficient=240.4,
    ... )
    >>> law.towards(-1)
    CoulombViscous(kinetic_coefficient=20.6, viscous_coefficient=240.4, static_coefficient=None)
    """

    name = "direction-dependent"
    title = "Direction-dependent"
    sources = ("armstrong1991", "janot2019")
    fit_order = (
        "forward_kinetic_coefficient",
        "backward_kinetic_coefficient",
        "forward_viscous_coefficient",
        "backward_viscous_coefficient",
    )
    on_request = True

    forward_viscous_coefficient = 0.0
    backward_viscous_coefficient = 0.0


@composed("level + power", names={"viscous_exponent": "exponent"})
class PowerViscous:
    """A constant level plus a power of the speed, as for shear-thinning lubricants.

    Below a micrometre a second the power gives way to the straight line that meets it there. With
    no level a body creeps to rest along this line in no finite time, as with viscous friction.

    Examples
    --------
    >>> from stickslip import PowerViscous
    >>> law = PowerViscous(kinetic_coefficient=2.0, viscous_coefficient=4.0, exponent=0.5)
    >>> law.force(0.25, load=1.0)
    4.0
    """

    name = "power-viscous"
    title = "Coulomb + power of speed"
    sources = ("coulomb1785", "bittencourt2012")
    fit_order = ("kinetic_coefficient", "viscous_coefficient", "exponent")
    on_request = True

    exponent: Annotated[
        float,
        Quantity("n", above=0, structural=True, scale="none", bounds=(0.2, 3.0), start=0.8),
        Doc("Power of the speed: 1 is viscous friction, below 1 the lubricant thins."),
    ] = 0.5


@composed("level + viscous + drag")
class QuadraticDrag:
    """A constant level, a viscous part and quadratic drag, for motion through air or oil.

    Examples
    --------
    >>> from stickslip import QuadraticDrag
    >>> law = QuadraticDrag(
    ...     kinetic_coefficient=0.5, viscous_coefficient=2.0, quadratic_coefficient=8.0
    ... )
    >>> law.force(-0.5, load=1.0)
    -3.5
    """

    name = "quadratic-drag"
    title = "Coulomb + viscous + drag"
    sources = ("coulomb1785", "reynolds1886", "newton1687")
    on_request = True

    viscous_coefficient = 0.0
    quadratic_coefficient = 0.0


@composed("level + stribeck + viscous + peak", names={"fading_exponent": "exponent"})
class Stribeck:
    """A kinetic level, a static excess that decays with speed, and a viscous part.

    The force that rest gives way to may lie above what sliding begins with: the factor ``peak`` of
    the Modelica library is ``break_away_coefficient / static_coefficient``.

    Examples
    --------
    >>> from stickslip import Stribeck
    >>> law = Stribeck(kinetic_coefficient=0.25, static_coefficient=0.35, stribeck_velocity=0.01)
    >>> law.force(1e-9, load=10.0), law.force(1.0, load=10.0)
    (3.49999999999999, 2.5)
    >>> law.break_away(10.0)
    3.5
    """

    name = "stribeck"
    title = "Stribeck"
    sources = ("stribeck1902", "bo1982", "armstrong1991", "otter1999")
    fit_order = (
        "kinetic_coefficient",
        "viscous_coefficient",
        "stribeck_velocity",
        "static_coefficient",
    )

    viscous_coefficient = 0.0


@composed("dahl(level) + power", names={"yield_exponent": "exponent"})
class Dahl:
    """Elastic at small displacements, Coulomb friction at large ones: hysteresis without stiction.

    A viscous part may stand beside the bristles; that of a lubricant that thins grows with a power
    of the speed below 1, as in the joints of robots. Below a micrometre a second it is linear.

    Examples
    --------
    >>> from stickslip import Dahl
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
class LuGre:
    """Presliding, Stribeck curve, frictional lag and rate-dependent break-away with one state.

    The viscous part may grow with a power of the speed, as that of a lubricant that thins; below a
    micrometre a second it is linear.

    Examples
    --------
    >>> from stickslip import LuGre
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
