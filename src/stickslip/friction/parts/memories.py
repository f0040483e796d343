"""Contacts that remember: states around a curve of levels."""

import functools
import math
from dataclasses import MISSING
from typing import Annotated

from typing_extensions import Doc, override

from stickslip.friction.base import BristleDamping, BristleStiffness
from stickslip.friction.parts.base import Becomes, Memory, Parameter, Slip, Values
from stickslip.maths import Scalar, exp, latched, log, power, sign, sin, sqrt, where
from stickslip.quantities import Quantity

ROUNDED = 1e-12
"""Share of the level that is nothing: broken powers are rounded within its root."""
LEAST_DIVISOR = 1e-300
"""What keeps quotients finite, and nothing else."""

ABOVE_ONE = 1.0 + 1e-15
"""1 and little more, in one number: in symbolic equations 1 + `LEAST_DIVISOR` is 1."""

BENT = 1e-18
"""Square of the share of the friction level within which a loop is rounded."""


class Dahl(Memory):
    """A spring that yields."""

    name = "dahl"
    title = "Dahl"
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

    usual = "level + stribeck"
    tex_where = r"\dot z = v - \frac{\sigma_0 |v|}{g} z"

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        # The rate vanishes at z = g / sigma_0 in the sense of the slip: steady sliding has the
        # force g.
        return (s.along - p.bristle_stiffness * abs(s.along) / g * z[0],)


class LuGre(LuGreBristle):
    """A bristle with a constant damping."""

    name = "lugre"
    title = "LuGre"
    becomes = (
        Becomes(name="dahl", values={"bristle_damping": 0.0}),
        Becomes(name="", values={"bristle_damping": 0.0}, limits=("bristle_stiffness",)),
    )
    bristle_stiffness: BristleStiffness
    bristle_damping: BristleDamping


class LuGreFading(LuGreBristle):
    """A bristle whose damping fades with the speed, which can make the law passive."""

    name = "lugre_fading"
    title = "LuGre fading"
    compared = False
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


class ElastoPlastic(Bristle):
    """A bristle that does not yield below a share of its largest deflection."""

    name = "elasto_plastic"
    title = "elasto-plastic"
    usual = "level + stribeck"
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
        # u within rho and 1, rounded: alpha is flat there, and steady sliding must be no switch
        least = 0.5 * (u + 1.0 - sqrt((u - 1.0) * (u - 1.0) + BENT))
        within = 0.5 * (least + rho + sqrt((least - rho) * (least - rho) + BENT))
        alpha = 0.5 + 0.5 * sin(math.pi * (within - 0.5 * (1.0 + rho)) / (1.0 - rho))
        return (s.along * (1.0 - alpha * u),)


class BoucWen(Memory):
    """A loop whose sides bend differently on loading and on unloading."""

    name = "bouc_wen"
    title = "Bouc-Wen"
    compared = False
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
        Quantity("beta", low=0, high=0.5, scale="none", bounds=(0.0, 0.5), start=0.25),
        Doc(
            "Share of yielding on either way: 1/2 unloads along a straight line, 0 more stiffly."
            " Above 1/2, bristles bent beyond a level that has fallen would bend on without end."
        ),
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


class Elements(Memory):
    """Elastic elements of equal stiffness that yield one after the other: a memory of all turns."""

    argument = "number"
    tex = r"\textstyle\frac{\sigma_0}{{0}} \sum_i z_i"

    @override
    def states(self, argument: str) -> tuple[str, ...]:
        return tuple(f"z{i + 1}" for i in range(int(argument)))

    @override
    def force(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> Scalar:
        return p.bristle_stiffness / len(z) * sum(z[1:], start=z[0])


def shares(z: tuple[Scalar, ...]) -> list[float]:
    """Return the levels of elements over their shares of the stiffness: even, with the mean 1."""
    return [2.0 * (i + 1) / (len(z) + 1.0) for i in range(len(z))]


def pulled(z: Scalar, limit: Scalar, s: Slip, time: Scalar) -> Scalar:
    """Return a deflection after some time at a constant velocity, which ends just past a limit."""
    way, step = sign(s.along), abs(s.along) * time
    # Just past the limit, where the switch of the element has turned.
    room = limit * (1.0 + ROUNDED) - z * way
    return z + way * where(step < room, step, room)


class Maxwell(Elements):
    """Elements that slide under constant forces; a level that falls with speed scales their sum."""

    name = "maxwell"
    title = "Maxwell slip"
    limited = True
    tex = r"\textstyle\frac{g}{g(0)} \frac{\sigma_0}{{0}} \sum_i z_i"
    tex_where = (
        r"\dot z_i = v \text{ while } \sigma_0 z_i \operatorname{sgn} v <"
        r" \tfrac{2 i}{{0} + 1} g(0), \text{ else } 0"
    )
    becomes = (Becomes(name="", values={}, limits=("bristle_stiffness",)),)
    bristle_stiffness: BristleStiffness

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        # Elements yield at the level at rest, whatever the speed: `force` has what speed leaves of
        # it.
        length, way = s.rest / p.bristle_stiffness, sign(s.along)
        left = (share * length - bend * way for share, bend in zip(shares(z), z, strict=True))
        return tuple(where(room > 0.0, s.along, 0.0) for room in left)

    @override
    def moved(
        self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar, time: Scalar
    ) -> tuple[Scalar, ...]:
        length = s.rest / p.bristle_stiffness
        return tuple(
            pulled(bend, share * length, s, time) for share, bend in zip(shares(z), z, strict=True)
        )

    @override
    def force(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> Scalar:
        return g / s.rest * super().force(p, s, z, g)


class GMS(Elements):
    """Elements that slip until the velocity turns, and lag behind the level while they do."""

    name = "gms"
    title = "GMS"
    usual = "level + stribeck"
    tex_where = (
        r"\dot z_i = v \text{ until } \sigma_0 z_i \operatorname{sgn} v = \tfrac{2 i}{{0} + 1} g,"
        r" \text{ then } C \left(\tfrac{2 i}{({0} + 1) \sigma_0} \operatorname{sgn} v"
        r" - \tfrac{z_i}{g} \right) \text{ until } v = 0"
    )
    becomes = (Becomes(name="", values={}, limits=("bristle_stiffness", "attraction")),)
    bristle_stiffness: BristleStiffness
    attraction: Annotated[
        float,
        Quantity("C", "1/s", above=0, scale="speed*stiffness", bounds=(1e-3, 1e3), start=0.3),
        Doc("Rate at which the friction of slipping elements approaches the level, over the load."),
    ]

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        sigma_0, way = p.bristle_stiffness, sign(s.along)
        return tuple(
            latched(
                bend * way - share * g / sigma_0,  # slips from where it reaches its level
                bend * s.along,  # until slip turns
                p.attraction * (share / sigma_0 * way - bend / g),
                s.along,
            )
            for share, bend in zip(shares(z), z, strict=True)
        )

    @override
    def moved(
        self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar, time: Scalar
    ) -> tuple[Scalar, ...]:
        way, fades = sign(s.along), exp(-p.attraction * time / g)
        result = []
        for share, bend in zip(shares(z), z, strict=True):
            limit = share * g / p.bristle_stiffness
            reached = bend * way + abs(s.along) * time - limit
            slips = limit * way + (bend - limit * way) * fades
            sticks = where(bend * way > limit, slips, pulled(bend, limit, s, time))
            # what slipped the other way sticks, and slips from where it reaches its level
            hold = where(bend * s.along > 0.0, 1.0, where(reached > 0.0, 0.0, -1.0))
            result.append(where(hold > 0.0, latched(reached, hold, slips, sticks), sticks))
        return tuple(result)


class Reset(Memory):
    """A spring that is stiffer while it sticks: its force falls to the level where it gives way."""

    name = "reset"
    title = "reset integrator"
    compared = False
    drops = limited = True
    tex = r"\left(\tfrac{g}{g(0)} (1 + a)\, \sigma_0 z + \sigma_1 \dot z\right)"
    tex_where = (
        r"\dot z = v \text{ while } \sigma_0 z \operatorname{sgn} v < g(0),"
        r" \text{ else } \dot z = a = 0"
    )
    becomes = (
        Becomes(
            name="",
            values={"sticking_surplus": 0.0, "bristle_damping": 0.0},
            limits=("bristle_stiffness",),
        ),
    )
    bristle_stiffness: BristleStiffness
    bristle_damping: BristleDamping
    sticking_surplus: Annotated[
        float,
        Quantity("a", low=0, scale="none", bounds=(0.0, 10.0), start=0.2),
        Doc("What break-away exceeds the level at rest by, over this level."),
    ]

    def sticks(self, p: Values, s: Slip, z: Scalar, yes: Scalar, no: Scalar) -> Scalar:
        """Return `yes` while the spring sticks, else `no`."""
        return where(s.rest / p.bristle_stiffness - z * sign(s.along) > 0.0, yes, no)

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        return (self.sticks(p, s, z[0], s.along, 0.0),)

    @override
    def moved(
        self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar, time: Scalar
    ) -> tuple[Scalar, ...]:
        return (pulled(z[0], s.rest / p.bristle_stiffness, s, time),)

    @override
    def force(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> Scalar:
        # As with elements: the spring ends at the level at rest, and is scaled by what speed leaves
        # of it.
        spring = g / s.rest * p.bristle_stiffness * z[0]
        a, (z_dot,) = p.sticking_surplus, self.rates(p, s, z, g)
        return spring * self.sticks(p, s, z[0], 1.0 + a, 1.0) + p.bristle_damping * z_dot

    @override
    def peak(self, p: Values) -> Scalar:
        return 1.0 + p.sticking_surplus


class BlimanSorine(Memory):
    """Two springs that yield against each other: break-away exceeds the level by a distance."""

    name = "bliman_sorine"
    title = "Bliman-Sorine"
    compared = False
    tex = r"\sigma_0 \left(z_1 - \tfrac{\eta b}{1 + b} z_2\right)"
    tex_where = (
        r"\dot z_1 = v - \tfrac{\sigma_0 |v|}{(1 + b) g} z_1,"
        r" \quad \dot z_2 = v - \eta \tfrac{\sigma_0 |v|}{(1 + b) g} z_2"
    )
    becomes = (
        Becomes(name="dahl", values={"surplus_share": 0.0, "yield_exponent": 1.0}),
        Becomes(name="", values={"surplus_share": 0.0}, limits=("bristle_stiffness",)),
    )
    bristle_stiffness: BristleStiffness
    surplus_share: Annotated[
        float,
        Quantity("b", low=0, scale="none", bounds=(0.0, 10.0), start=0.3),
        Doc("Level of the second spring, which is taken off, over the level of friction."),
    ]
    distance_ratio: Annotated[
        float,
        Quantity("eta", above=0, high=1, scale="none", bounds=(1e-3, 1.0), start=0.2),
        Doc("Distance in which the first spring yields over that of the second."),
    ]

    @override
    def states(self, argument: str) -> tuple[str, ...]:
        return ("z1", "z2")

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        yields = p.bristle_stiffness * abs(s.along) / ((1.0 + p.surplus_share) * g)
        return s.along - yields * z[0], s.along - p.distance_ratio * yields * z[1]

    @override
    def force(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> Scalar:
        b = p.surplus_share
        return p.bristle_stiffness * (z[0] - p.distance_ratio * b / (1.0 + b) * z[1])

    @override
    def peak(self, p: Values) -> Scalar:
        b, eta = p.surplus_share + LEAST_DIVISOR, p.distance_ratio
        x = log((1.0 + b) / (b * eta)) / (ABOVE_ONE - eta)  # where the force falls again
        return 1.0 + b * (1.0 - eta) * exp(-eta * x)


class Relaxing(Memory):
    """A spring that yields, with springs beside it that relax: stretched tissue.

    Each of these is a spring in line with a dashpot. What yields takes the share of the slip that
    the whole force has of the level, so that the force times this share is never below 0: with
    the energies of the springs, and what the dashpots take, the part is passive for any values.
    """

    name = "relaxing"
    title = "relaxing tissue"
    argument = "number"
    compared = False
    dissipates = relaxes = True
    tex = r"\left(\sigma_0 z + \textstyle\sum_i k_i q_i\right)"
    tex_where = (
        r"\dot z = v - \frac{|v|}{g} \left(\sigma_0 z + \textstyle\sum_i k_i q_i\right), \quad"
        r" \dot q_i = \dot z - q_i / \tau_i"
    )
    bristle_stiffness: BristleStiffness

    def __init__(self, count: int = 1) -> None:
        self.count = count

    @override
    def of(self, argument: str) -> "Relaxing":
        return Relaxing(int(argument)) if argument.isdecimal() else self

    @functools.cached_property
    @override
    def parameters(self) -> tuple[Parameter, ...]:
        result = list(super().parameters)
        for i in range(self.count):
            stiffness = Quantity(
                f"k_{i + 1}", "1/m", low=0, scale="stiffness", bounds=(0.0, 1e3), start=1.0
            )
            time = Quantity(
                f"tau_{i + 1}", "s", above=0, scale="none", bounds=(1e-3, 1e2), start=1.0
            )
            hints = {
                f"relaxing_stiffness_{i + 1}": Annotated[
                    float, stiffness, Doc("Stiffness that relaxes, over the normal force.")
                ],
                f"relaxation_time_{i + 1}": Annotated[
                    float, time, Doc("Time in which its force falls to 1/e.")
                ],
            }
            result += [Parameter(name=k, hint=v, default=MISSING) for k, v in hints.items()]
        return tuple(result)

    @property
    @override
    def becomes(self) -> tuple[Becomes, ...]:  # type: ignore[override]  # of as many
        none = {f"relaxing_stiffness_{i + 1}": 0.0 for i in range(self.count)}
        return (
            Becomes(name="dahl", values={**none, "yield_exponent": 1.0}),
            Becomes(name="", values={**none}, limits=("bristle_stiffness",)),
        )

    @override
    def states(self, argument: str) -> tuple[str, ...]:
        return ("z", *(f"q{i + 1}" for i in range(int(argument))))

    @override
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        z_dot = s.along - abs(s.along) / g * self.force(p, s, z, g)
        times = (getattr(p, f"relaxation_time_{i + 1}") for i in range(self.count))
        return (z_dot, *(z_dot - q / time for q, time in zip(z[1:], times, strict=True)))

    @override
    def force(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> Scalar:
        springs = (getattr(p, f"relaxing_stiffness_{i + 1}") for i in range(self.count))
        result = p.bristle_stiffness * z[0]
        for k, q in zip(springs, z[1:], strict=True):
            result = result + k * q
        return result
