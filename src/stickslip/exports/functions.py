"""The functions that a law becomes: its forces, one step in discrete time, its compensation.

The step holds the applied force constant, as a controller does between two samples. While the body
slips, velocity and bristles go on by a method of Rosenbrock and Wanner of second order (ROS2 of
Verwer et al., SIAM J. Sci. Comput. 20, 1999) with gamma = 1 - 1/sqrt(2), which is L-stable and has
order 2 whatever matrix stands in for the Jacobian. So what would not damp is left out of the
Jacobian: then the pivots of its linear systems are at least 1, no step can fail, and stiff bristles
need no smaller period. Where the velocity passes 0, the period is divided: the body rests for what is left of it
if break-away allows, or slips on in the other sense.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Final, TypeAlias

import symengine as se

from stickslip.exports.equations import LOAD, VELOCITY, BySense, Equations
from stickslip.exports.program import (
    Assign,
    Branch,
    Call,
    Function,
    Statement,
    Variable,
    floored,
    used,
)
from stickslip.formulation import collapsed
from stickslip.quantities import turned

__all__ = ["functions_of"]

GAMMA: Final = 1.0 - 1.0 / math.sqrt(2.0)
ZERO, ONE = se.Integer(0), se.Integer(1)
NORMAL, SPEED, SENSE = map(se.Symbol, ("normal", "speed", "direction"))
APPLIED, MASS, PERIOD = map(se.Symbol, ("applied", "mass", "period"))
MEANINGS: Final = {
    "velocity": ("m/s", "slip velocity"),
    "load": ("N", "normal force; taken as 0 where it is negative"),
    "applied": ("N", "force on the body without friction, constant over the period"),
    "period": ("s", "length of the step, above 0"),
    "displacement": ("m", "displacement in the period"),
    "friction": ("N", "mean friction force in the period"),
    "width": ("m/s", "speed below which the force fades to 0, above 0"),
    "factor": ("1", "share of friction that is compensated, 1 for all of it"),
    "force": ("N", "friction force, with the sign of the velocity"),
    "speed": ("m/s", "slip speed in the direction"),
}
WITH_BRISTLES: Final = "Friction force at a velocity and a bristle state."
WITHOUT: Final = (
    "Friction force at a velocity; 0 at rest, where it may be any force up to break-away."
)
Body: TypeAlias = tuple[Statement, ...]


def functions_of(law: Equations, *, turning: bool = False) -> tuple[Function, ...]:
    """Return the functions of a law, each after those that it calls.

    Parameters
    ----------
    law : Equations
        The law.
    turning : bool
        Whether it is about an axis, so that forces are torques and displacements angles.

    Returns
    -------
    tuple of Function
        ``friction``, ``break_away``, ``step`` and ``compensation``, ``rates`` and ``steady`` of a
        law with bristles, and what they call.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> from stickslip.exports.equations import equations_of
    >>> [one.name for one in functions_of(equations_of(Coulomb(kinetic_coefficient=0.2)))]
    ['friction', 'break_away', 'slip', 'slide', 'departure', 'step', 'compensation']
    """
    return tuple(_turned(one) if turning else one for one in _Writer(law).functions())


def _turned(function: Function) -> Function:
    """Return a function of forces as one of torques, in units and in words."""

    def about_axis(one: Variable) -> Variable:
        words = one.meaning.replace("friction force", "friction torque")
        words = words.replace("force on the body", "torque on the body").replace(
            "mass of the body", "moment of inertia of the body"
        )
        # the normal force of a contact is one wherever it slips
        unit = one.unit if one.name == "load" else turned(one.unit)
        return replace(one, unit=unit, meaning=words)

    return replace(
        function,
        inputs=tuple(map(about_axis, function.inputs)),
        outputs=tuple(map(about_axis, function.outputs)),
    )


def _variable(name: str, meaning: str = "", *, of: str = "", positive: bool = False) -> Variable:
    unit, words = MEANINGS[of or name]
    return Variable(name=name, unit=unit, meaning=meaning or words, positive=positive)


class _Writer:
    """Writes the functions of one law."""

    def __init__(self, law: Equations) -> None:
        self.law = law
        self.states = [se.Symbol(name) for name in law.bristles]
        self.ends = [f"{name}_end" for name in law.bristles]
        self.bristles = tuple(
            Variable(name=name, unit="m", meaning="bristle state") for name in law.bristles
        )
        self.new_bristles = tuple(
            Variable(name=name, unit="m", meaning="bristle state at the end") for name in self.ends
        )
        # of forward slip, as a function of the speed; the other sense is turned round
        self.ahead = self._local(law.slip.ahead, 1)
        self.back = self._local(law.slip.back, -1)
        self.slips = ["force", *(f"{name}_rate" for name in law.bristles)]

    def functions(self) -> Iterator[Function]:
        yield self._friction()
        if self.law.bristles:
            yield self._rates()
        if self.law.steady is not None:
            yield self._steady(self.law.steady)
        yield self._break_away()
        yield self._slip()
        yield self._slide()
        yield self._departure()
        yield self._step()
        yield self._compensation()

    def _local(self, values: tuple[se.Expr, ...], side: int) -> tuple[se.Expr, ...]:
        """Return what holds in one sense of slip as seen along it."""
        turned_round = {VELOCITY: side * SPEED, **{z: side * z for z in self.states}}
        return tuple(side * one.subs(turned_round).subs({LOAD: NORMAL}) for one in values)

    def _friction(self) -> Function:
        forces = BySense(
            ahead=self.law.slip.ahead[:1], back=self.law.slip.back[:1], rest=self.law.slip.rest[:1]
        )
        return Function(
            name="friction",
            summary=WITH_BRISTLES if self.states else WITHOUT,
            inputs=(_variable("velocity"), *self.bristles, _variable("load")),
            outputs=(_variable("force"),),
            body=_loaded(_by_velocity(("force",), forces)),
        )  # fmt: skip

    def _rates(self) -> Function:
        names, slip = tuple(self.slips[1:]), self.law.slip
        rates = BySense(ahead=slip.ahead[1:], back=slip.back[1:], rest=slip.rest[1:])
        return Function(
            name="rates",
            summary="Time derivatives of the bristle states.",
            inputs=(_variable("velocity"), *self.bristles, _variable("load")),
            outputs=self._rate_variables(),
            body=_loaded(_by_velocity(names, rates)),
        )

    def _steady(self, forces: BySense) -> Function:
        return Function(
            name="steady",
            summary="Friction force after long sliding at a constant velocity.",
            inputs=(_variable("velocity"), _variable("load")),
            outputs=(_variable("force"),),
            body=_loaded(_by_velocity(("force",), forces)),
        )

    def _break_away(self) -> Function:
        ahead, back = (one.subs({LOAD: NORMAL}) for one in self.law.break_away)
        level = ("level",)
        return Function(
            name="break_away",
            summary="Largest friction force at rest.",
            inputs=(self._direction("1 forward, -1 backward"), _variable("load")),
            outputs=(Variable(name="level", unit="N", meaning="break-away friction force"),),
            body=_loaded(_either(Assign(level, (ahead,)), Assign(level, (back,)))),
        )

    def _slip(self) -> Function:
        """Write the law itself, as seen along the direction of slip."""
        names = tuple(self.slips)
        return Function(
            name="slip",
            summary="Friction in one direction of slip, along which all are counted.",
            inputs=(
                _variable("speed"),
                *self.bristles,
                self._direction("1 forward, -1 backward"),
                _variable("load"),
            ),
            outputs=(
                _variable("force", "friction force against the direction"),
                *self._rate_variables(),
            ),
            body=_loaded(_either(Assign(names, self.ahead), Assign(names, self.back))),
            inner=True,
        )

    def _rate_variables(self) -> tuple[Variable, ...]:
        return tuple(
            Variable(name=name, unit="m/s", meaning="time derivative of a bristle state")
            for name in self.slips[1:]
        )

    def _slide(self) -> Function:
        """Write one step of slip, all quantities as seen along the direction of slip."""
        force, *rates = map(se.Symbol, self.slips)
        state = [SPEED, *self.states]
        mid = [se.Symbol(f"{one}_mid") for one in state]
        names, later = (
            [f"{stage}_{one}" for one in ("v", *self.law.bristles)] for stage in ("first", "second")
        )
        first, second = list(map(se.Symbol, names)), list(map(se.Symbol, later))
        slope = [(APPLIED - force) / MASS, *rates]
        inside = [one + PERIOD * other for one, other in zip(state, first, strict=True)]
        ends = [
            one + PERIOD * (1.5 * a + 0.5 * b)
            for one, a, b in zip(state, first, second, strict=True)
        ]
        return Function(
            name="slide",
            summary="Speed and bristle states after slip in one direction, along which all count.",
            inputs=(
                _variable("speed"),
                *self.bristles,
                _variable("applied"),
                _variable("load"),
                self._mass(),
                _variable("period"),
                self._direction("1 forward, -1 backward"),
            ),
            outputs=(
                _variable("speed_end", "slip speed at the end", of="speed"),
                *self.new_bristles,
            ),
            body=(
                *_loaded(self._slopes()),
                *self._matrix(),
                *self._solved(slope, names),
                *floored(str(mid[0]), inside[0]),
                *(
                    Assign((str(one),), (value,))
                    for one, value in list(zip(mid, inside, strict=True))[1:]
                ),
                Call(tuple(self.slips), "slip", (*mid, SENSE, LOAD)),
                *self._solved([a - 2 * b for a, b in zip(slope, first, strict=True)], later),
                Assign(("speed_end", *self.ends), tuple(ends)),
            ),
            inner=True,
        )

    def _slopes(self) -> Body:
        """Assign the force, the rates, and the slopes of all; rates of bristles negative."""
        names = ["force_v"]
        for z in self.law.bristles:
            names += [f"force_{z}", f"rate_v_{z}", f"rate_{z}"]
        sides = []
        for force, *rates in (self.ahead, self.back):
            slopes = [force.diff(SPEED)]
            for z, rate in zip(self.states, rates, strict=True):
                slopes += [force.diff(z), rate.diff(SPEED), -rate.diff(z)]
            sides.append(Assign((*self.slips, *names), (force, *rates, *map(collapsed, slopes))))
        return _either(*sides)

    def _matrix(self) -> Body:
        """Assign the entries of the linear system, whose matrix has the shape of an arrow."""
        r = GAMMA * PERIOD
        pivot = 1 + r * se.Symbol("force_v") / MASS
        body: list[Statement] = []
        for z in self.law.bristles:
            weight, pull, follow = (se.Symbol(f"{one}_{z}") for one in ("weight", "pull", "follow"))
            body += [
                Branch(se.Symbol(f"rate_{z}"), ZERO, (Assign((f"rate_{z}",), (ZERO,)),)),
                Assign((str(weight),), (1 + r * se.Symbol(f"rate_{z}"),)),
                Assign((str(pull),), (r * se.Symbol(f"force_{z}") / MASS,)),
                Assign((str(follow),), (r * se.Symbol(f"rate_v_{z}") / weight,)),
            ]
            pivot = pivot + pull * follow
        least = Branch(se.Symbol("pivot"), ONE, (Assign(("pivot",), (ONE,)),))
        return (*body, Assign(("pivot",), (pivot,)), least)

    def _solved(self, right: list[se.Expr], names: list[str]) -> Body:
        """Assign the solution of the linear system for a right side."""
        speed, *bristles = names
        top, *others = right
        after: list[Statement] = []
        for name, z, one in zip(bristles, self.law.bristles, others, strict=True):
            weight, pull, follow = (se.Symbol(f"{one}_{z}") for one in ("weight", "pull", "follow"))
            top = top - pull * one / weight
            after.append(Assign((name,), (one / weight + follow * se.Symbol(speed),)))
        return (Assign((speed,), (top / se.Symbol("pivot"),)), *after)

    def _departure(self) -> Function:
        """Write the sense in which a body at rest begins to slip."""
        return Function(
            name="departure",
            summary="Direction in which slip begins from rest, 0 if the body sticks.",
            inputs=(_variable("applied"), *self.bristles, _variable("load")),
            outputs=(self._direction("1 forward, -1 backward, 0 at rest"),),
            body=self._held() if self.law.holds else self._let_go(),
            inner=True,
        )

    def _held(self) -> Body:
        out = ("direction",)
        return (
            Call(("ahead",), "break_away", (ONE, LOAD)),
            Call(("back",), "break_away", (-ONE, LOAD)),
            Branch(
                se.Symbol("ahead"),
                APPLIED,
                (Assign(out, (ONE,)),),
                (
                    Branch(
                        se.Symbol("back"),
                        -APPLIED,
                        (Assign(out, (-ONE,)),),
                        (Assign(out, (ZERO,)),),
                    ),
                ),
            ),
        )

    def _let_go(self) -> Body:
        out = ("direction",)
        return (
            Call(("force",), "friction", (ZERO, *self.states, LOAD)),
            Branch(APPLIED, se.Symbol("force"), (Assign(out, (-ONE,)),), (Assign(out, (ONE,)),)),
        )

    def _step(self) -> Function:
        moved = ("velocity_end", *self.ends, "displacement", "friction", "sticks")
        return Function(
            name="step",
            summary="Motion over one period of a body under a constant force and friction.",
            inputs=(
                _variable("applied"),
                _variable("velocity", "slip velocity at the start; 0 at rest"),
                *self.bristles,
                _variable("load"),
                replace(self._mass(), positive=True),
                _variable("period", positive=True),
            ),
            outputs=(
                _variable(moved[0], "slip velocity at the end; exactly 0 at rest", of="velocity"),
                *self.new_bristles,
                _variable("displacement"),
                _variable("friction"),
                Variable(
                    name="sticks",
                    unit="",
                    meaning="1 if the body rests at the end, else 0"
                    if self.law.holds
                    else "0: bristles carry friction at rest",
                ),
            ),
            body=self._stepped(),
        )

    def _stepped(self) -> Body:
        velocity_end, sense = se.Symbol("velocity_end"), se.Symbol("sense")
        at_rest = Call(("sense",), "departure", (APPLIED, *self.states, LOAD))
        stays = (
            Assign(("velocity_end", "displacement"), (ZERO, ZERO)),
            *(Assign((end,), (z,)) for end, z in zip(self.ends, self.states, strict=True)),
        )
        return (
            Branch(
                ZERO,
                VELOCITY,
                (Assign(("sense",), (ONE,)),),
                (Branch(VELOCITY, ZERO, (Assign(("sense",), (-ONE,)),), (at_rest,)),),
            ),
            *((Branch(ZERO, sense * sense, self._moves(), stays),) if self.law.holds
              else self._moves()),
            Assign(("sticks",), (ZERO,)),
            *((Branch(sense * sense, ONE, (Assign(("sticks",), (ONE,)),)),)
              if self.law.holds else ()),
            Assign(("friction",), (APPLIED - MASS * (velocity_end - VELOCITY) / PERIOD,)),
        )  # fmt: skip

    def _moves(self) -> Body:
        """Slip in the sense of the velocity, and divide the period where it ends."""
        sense, speed_end = se.Symbol("sense"), se.Symbol("speed_end")
        start = sense * VELOCITY
        z_ends = list(map(se.Symbol, self.ends))
        share = se.Symbol("share")
        slide = Call(
            ("speed_end", *self.ends),
            "slide",
            (start, *(sense * z for z in self.states), sense * APPLIED, LOAD, MASS, PERIOD, sense),
        )
        back = tuple(
            Assign((str(end),), (sense * end,)) for end in z_ends
        )  # from the direction of slip to that of the velocity
        passed = (
            Assign(("share",), (ZERO,)),
            Branch(ZERO, start, (Assign(("share",), (start / (start - speed_end),)),)),
            Assign(("used", "rest"), (share * PERIOD, (1 - share) * PERIOD)),
            Assign(("displacement",), (VELOCITY * se.Symbol("used") / 2,)),
            *(
                Assign((str(end),), (z + (end - z) * share,))
                for end, z in zip(z_ends, self.states, strict=True)
            ),
            Call(("sense",), "departure", (APPLIED, *z_ends, LOAD)),
            *self._goes_on(z_ends, back),
        )
        through = (
            Assign(
                ("velocity_end", "displacement"),
                (sense * speed_end, (VELOCITY + sense * speed_end) * PERIOD / 2),
            ),
        )
        return (slide, *back, Branch(ZERO, speed_end, through, passed))

    def _goes_on(self, z_ends: list[se.Expr], back: Body) -> Body:
        """Slip from rest for what is left of the period, unless the body is held."""
        sense, rest = se.Symbol("sense"), se.Symbol("rest")
        speed_end, displacement = se.Symbol("speed_end"), se.Symbol("displacement")
        floor = (Branch(speed_end, ZERO, (Assign(("speed_end",), (ZERO,)),)),)
        on: Body = (
            Call(
                ("speed_end", *self.ends),
                "slide",
                (ZERO, *(sense * z for z in z_ends), sense * APPLIED, LOAD, MASS, rest, sense),
            ),
            *back,
            *(floor if not self.states else ()),
            Assign(("velocity_end",), (sense * speed_end,)),
            Assign(("displacement",), (displacement + sense * speed_end * rest / 2,)),
        )
        if not self.law.holds:
            return on
        return (Branch(ZERO, sense * sense, on, (Assign(("velocity_end",), (ZERO,)),)),)

    def _compensation(self) -> Function:
        width, share = se.Symbol("width"), se.Symbol("share")
        crossing = share * (3 - share * share) / 2
        force = "steady" if self.law.steady is not None else "friction"
        size = se.Piecewise((VELOCITY, VELOCITY > ZERO), (-VELOCITY, True))
        return Function(
            name="compensation",
            summary="Force that compensates friction, faded to 0 below a speed.",
            inputs=(
                _variable("velocity", "measured or desired velocity"),
                _variable("load"),
                _variable("width", positive=True),
                _variable("factor"),
            ),
            outputs=(_variable("force", "force to add to that of the controller"),),
            body=(
                Call(("force",), force, (VELOCITY, LOAD)),
                Assign(("share",), (size / width,)),
                Branch(ONE, share, (Assign(("share",), (ONE,)),)),
                Assign(("force",), (se.Symbol("factor") * crossing * se.Symbol("force"),)),
            ),
        )

    def _direction(self, meaning: str) -> Variable:
        return Variable(name="direction", unit="", meaning=meaning)

    def _mass(self) -> Variable:
        return Variable(name="mass", unit="kg", meaning="mass of the body, above 0")


def _loaded(body: Body) -> Body:
    """Let statements begin with the normal force that they use, which none pulls on."""
    return (*floored("normal", LOAD), *body) if "normal" in used(body) else body


def _by_velocity(names: tuple[str, ...], values: BySense) -> Body:
    """Assign what holds in each sense of slip and at rest, once where it is the same."""
    ahead, back, rest = (
        Assign(names, tuple(one.subs({LOAD: NORMAL}) for one in side))
        for side in (values.ahead, values.back, values.rest)
    )
    still = tuple(one.subs({VELOCITY: ZERO}) for one in ahead.values)
    if ahead == back and still == rest.values:
        return (ahead,)
    return (Branch(ZERO, VELOCITY, (ahead,), (Branch(VELOCITY, ZERO, (back,), (rest,)),)),)


def _either(ahead: Assign, back: Assign) -> Body:
    """Assign what holds in the direction of slip, once where it is the same in both."""
    pairs = zip(ahead.values, back.values, strict=True)
    if all(a == b or se.expand(a - b) == 0 for a, b in pairs):
        return (ahead,)
    return (Branch(ZERO, SENSE, (ahead,), (back,)),)
