"""Contacts that remember: states around a curve of levels."""

import math
from typing import Annotated, final

from typing_extensions import Doc, override

from stickslip.friction.coefficients import BristleDamping, BristleStiffness
from stickslip.friction.parts.base import Becomes, Memory, Slip, Values
from stickslip.maths import Scalar, exp, power, sign, sin, where
from stickslip.quantities import Quantity

ROUNDED = 1e-12
"""Square of the share of the friction level within which an exponent other than 1 is rounded."""

BENT = 1e-20
"""Square of the share of the friction level within which a loop is rounded."""


@final
class Dahl(Memory):
    """A spring that yields."""

    name = "dahl"
    tex = r"\sigma_0 z"
    tex_where = (
        r"\dot z = v\, \operatorname{sgn}(r)\, |r|^n, \quad"
        r" r = 1 - \frac{\sigma_0 z}{g} \operatorname{sgn} v"
    )
    becomes = (Becomes(name="", values={"yield_exponent": 1.0}, limits=("bristle_stiffness",)),)
    bristle_stiffness: BristleStiffness
    yield_exponent: Annotated[
        float,
        Quantity("n", above=0, structural=True, scale="none", bounds=(0.2, 3.0), start=0.8),
        Doc("Sharpness of yielding: 1 is Dahl's plain law, towards 0 elastic then plastic."),
    ] = 1.0

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        r = 1.0 - p.bristle_stiffness * z[0] * sign(s.along) / g
        # sgn(r) |r|^n, rounded where rounding errors decide the side and n < 1 has no slope
        return (s.along * r * power(r * r + ROUNDED, 0.5 * (p.yield_exponent - 1.0)),)

    @override
    def force(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> Scalar:
        return p.bristle_stiffness * z[0]


class Bristle(Memory):
    """A spring that yields, with a damper beside it."""

    tex = r"(\sigma_0 z + \sigma_1 \dot z)"

    @override
    def force(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> Scalar:
        (z_dot,) = self.rates(p, s, z, g)
        return p.bristle_stiffness * z[0] + self.damping(p, s) * z_dot

    def damping(self, p: Values, s: Slip) -> Scalar:
        """Return the damping of the bristle at a speed."""
        return p.bristle_damping


class LuGreBristle(Bristle):
    """A bristle whose share of yielding grows with its deflection."""

    tex_where = r"\dot z = v - \frac{\sigma_0 |v|}{g} z"

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        return (s.along - p.bristle_stiffness * abs(s.along) / g * z[0],)


@final
class LuGre(LuGreBristle):
    """A bristle with a constant damping."""

    name = "lugre"
    becomes = (
        Becomes(name="dahl", values={"bristle_damping": 0.0}),
        Becomes(name="", values={"bristle_damping": 0.0}, limits=("bristle_stiffness",)),
    )
    bristle_stiffness: BristleStiffness
    bristle_damping: BristleDamping


@final
class LuGreFading(LuGreBristle):
    """A bristle whose damping fades with the speed, which can make the law passive."""

    name = "lugre_fading"
    tex = r"(\sigma_0 z + \sigma_1 e^{-(v/v_d)^2} \dot z)"
    becomes = (
        Becomes(name="lugre", values={}, limits=("damping_velocity",)),
        Becomes(name="dahl", values={"bristle_damping": 0.0}),
    )
    bristle_stiffness: BristleStiffness
    bristle_damping: BristleDamping
    damping_velocity: Annotated[
        float,
        Quantity("v_d", "m/s", above=0, scale="speed", bounds=(1e-4, 10.0), start=0.1),
        Doc("Speed at which the damping has fallen to 1/e."),
    ]

    @override
    def damping(self, p: Values, s: Slip) -> Scalar:
        u = s.along / p.damping_velocity
        return p.bristle_damping * exp(-u * u)


@final
class ElastoPlastic(Bristle):
    """A bristle that does not yield below a share of its largest deflection."""

    name = "elasto_plastic"
    tex_where = (
        r"\dot z = v (1 - \alpha u), \quad u = \frac{\sigma_0 z}{g} \operatorname{sgn} v, \quad"
        r" \alpha = \tfrac12 + \tfrac12 \sin \pi \frac{u - (1 + \rho)/2}{1 - \rho}"
        r" \text{ for } \rho < u < 1, \; 0 \text{ below}, \; 1 \text{ above}"
    )
    becomes = (Becomes(name="", values={"bristle_damping": 0.0}, limits=("bristle_stiffness",)),)
    bristle_stiffness: BristleStiffness
    bristle_damping: BristleDamping
    elastic_share: Annotated[
        float,
        Quantity("rho", low=0, high=0.999, scale="none", bounds=(0.0, 0.99), start=0.7),
        Doc("Share of the largest deflection up to which nothing yields."),
    ]

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        # deflection along slip, over the one of steady sliding
        u, rho = p.bristle_stiffness * z[0] * sign(s.along) / g, p.elastic_share
        rise = 0.5 + 0.5 * sin(math.pi * (u - 0.5 * (1.0 + rho)) / (1.0 - rho))
        alpha = where(u > rho, where(u < 1.0, rise, 1.0), 0.0)
        return (s.along * (1.0 - alpha * u),)


@final
class BoucWen(Memory):
    """A loop whose sides bend differently on loading and on unloading."""

    name = "bouc_wen"
    tex = r"\sigma_0 z"
    tex_where = (
        r"\dot z = v \left(1 - |u|^n \left[\beta + (1 - \beta) \operatorname{sgn}(u v)\right]"
        r"\right), \quad u = \sigma_0 z / g"
    )
    becomes = (Becomes(name="", values={}, limits=("bristle_stiffness",)),)
    bristle_stiffness: BristleStiffness
    loop_exponent: Annotated[
        float,
        Quantity("n", above=0, structural=True, scale="none", bounds=(0.5, 10.0), start=1.5),
        Doc("Sharpness of yielding."),
    ] = 2.0
    loop_share: Annotated[
        float,
        Quantity("beta", low=0, high=1, scale="none", bounds=(0.0, 1.0), start=0.5),
        Doc("Share of yielding that unloading has as well: 1/2 unloads along a straight line."),
    ] = 0.5

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        u, beta = p.bristle_stiffness * z[0] / g, p.loop_share
        # |u|^n and |u|^n sgn u, rounded so that both have slopes at u = 0
        size, n = u * u + BENT, p.loop_exponent
        loads = u * power(size, 0.5 * (n - 1.0)) * sign(s.along)
        return (s.along * (1.0 - beta * power(size, 0.5 * n) - (1.0 - beta) * loads),)

    @override
    def force(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> Scalar:
        return p.bristle_stiffness * z[0]


@final
class Maxwell(Memory):
    """Elastic elements of equal stiffness that yield one after the other: a memory of all turns."""

    name = "maxwell"
    argument = "number"
    tex = r"\textstyle\frac{\sigma_0}{{0}} \sum_i z_i"
    tex_where = (
        r"\dot z_i = v \text{ while } \sigma_0 z_i \operatorname{sgn} v < \tfrac{2 i}{{0} + 1} g,"
        r" \text{ else } 0"
    )
    becomes = (Becomes(name="", values={}, limits=("bristle_stiffness",)),)
    bristle_stiffness: BristleStiffness

    @override
    def states(self, argument: str) -> tuple[str, ...]:
        return tuple(f"z{i + 1}" for i in range(int(argument)))

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        sigma_0, way = p.bristle_stiffness, sign(s.along)
        # levels over shares of the stiffness grow as 1, 2, ..., n, and their mean is g
        left = (2.0 * (i + 1) / (len(z) + 1.0) * g / sigma_0 - one * way for i, one in enumerate(z))
        return tuple(where(room > 0.0, s.along, 0.0) for room in left)

    @override
    def force(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> Scalar:
        return p.bristle_stiffness / len(z) * sum(z[1:], start=z[0])
