"""How C and MATLAB write a law as a program: what differs is data, the printer is one."""

import math
import re
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, TypeAlias, TypeVar

import symengine as se

from stickslip.engine.formulation import Block, Syntax, collapsed
from stickslip.exports.program import (
    LOAD,
    PERIOD,
    VELOCITY,
    Assign,
    Branch,
    BySense,
    Call,
    Constant,
    Equations,
    Function,
    Leave,
    Repeat,
    Statement,
    Subject,
    Variable,
    assigned,
    called,
    floored,
    renamed,
    used,
)
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.quantities import turned
from stickslip.show.formatting import lower_first

# The functions that a law becomes: its forces, one step in discrete time, its compensation.
#
# The step holds the applied force constant, as a controller does between two samples. Both methods
# have order 2 and damp what is stiff, so that no period is too long to be stable.
#
# Without bristles, slip goes on by ROS2 (Verwer et al., SIAM J. Sci. Comput. 20, 1999), which has
# order 2 whatever stands in for the slope of friction: where friction falls with speed, 0 does.
# Where the velocity passes 0, the period is divided: the body rests for what is left of it if
# break-away
# allows, or slips on in the other sense.
#
# With bristles, it is the diagonally implicit method of two stages with gamma = 1 - 1/sqrt(2)
# (Alexander, SIAM J. Numer. Anal. 14, 1977). In a stage the deflection follows from the velocity in
# closed form, or by a root in a bracket where its rate is not linear in it; the velocity is then
# the only unknown, and is found in a bracket too.

# With it both methods, of slip with and without bristles, are of second order and L-stable.
GAMMA: Final = 1.0 - 1.0 / math.sqrt(2.0)
EXPANSIONS, ROOTS = 40, 60
"""Most times that a bracket is widened, and that it is divided; a few are the rule."""
DROPS: Final = (
    " Where a bristle gives way, friction falls at once: the velocity may then err by that fall"
    " times the period over the mass."
)
ROOT_TOLERANCE: Final = 1e-13
"""Miss of a root over the size of what it is sought among, at which a search ends."""
ZERO, ONE = se.Integer(0), se.Integer(1)
NORMAL, SPEED, SENSE = map(se.Symbol, ("normal", "speed", "direction"))
APPLIED, MASS = map(se.Symbol, ("applied", "mass"))
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
T = TypeVar("T")


def functions_of(law: Equations, *, rotary: bool = False) -> tuple[Function, ...]:
    """Return the functions of a law, each after those that it calls.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> from stickslip.exports.program import equations_of
    >>> [one.name for one in functions_of(equations_of(Coulomb(kinetic_coefficient=0.2)))]
    ['friction', 'break_away', 'slip', 'slide', 'departure', 'step', 'compensation']
    """
    made = [
        _turned(function) if rotary else function for function in _FunctionWriter(law).functions()
    ]
    # Inputs go behind the load, wherever a function has it.
    places = {
        function.name: 1 + [v.name for v in function.inputs].index("load")
        for function in made
        if law.inputs and any(v.name == "load" for v in function.inputs)
    }
    inputs = input_variables(law, rotary=rotary)
    return tuple(_informed(part, places, inputs) for part in made) if places else tuple(made)


def input_variables(law: Equations, *, rotary: bool) -> tuple[Variable, ...]:
    """Return the contact inputs of a law as arguments of its functions."""
    return tuple(
        Variable(
            name=name,
            unit=turned(CONTACT_INPUTS[key].unit, rotary),
            meaning=lower_first(CONTACT_INPUTS[key].meaning.rstrip(".")),
        )
        for name, key in law.inputs.items()
    )


def _informed(
    function: Function, places: Mapping[str, int], inputs: tuple[Variable, ...]
) -> Function:
    """Return a function that has contact inputs behind its load, and passes them on."""

    def with_inputs(items: tuple[T, ...], name: str, more: tuple[T, ...]) -> tuple[T, ...]:
        place = places.get(name)
        return items if place is None else (*items[:place], *more, *items[place:])

    def passed(body: Body) -> Body:
        return tuple(map(of, body))

    def of(step: Statement) -> Statement:
        match step:
            case Call():
                symbols = tuple(se.Symbol(v.name) for v in inputs)
                return replace(step, arguments=with_inputs(step.arguments, step.function, symbols))
            case Branch():
                return replace(step, yes=passed(step.yes), no=passed(step.no))
            case Repeat():
                return replace(step, body=passed(step.body))
            case _:
                return step

    own = with_inputs(function.inputs, function.name, inputs)
    return replace(function, inputs=own, body=passed(function.body))


ROTARY_NAMES: Final = {"mass": "inertia", "force": "torque"}
"""Names of variables -> those of a rotary axis."""
ROTARY_WORDS: Final = {
    r"(?<!normal )\bforce\b": "torque",
    r"\bForce\b": "Torque",
    r"\bmass\b": "moment of inertia",
    r"\bdisplacement\b": "angle",
    r"\bslip velocity\b": "angular velocity",
}
"""Words on forces -> those on torques; the normal force of a contact is one wherever it slips."""


def rotary_words(text: str) -> str:
    """Return a text on a body that slides as one on a body that turns.

    Examples
    --------
    >>> rotary_words("friction force at a normal force of 2 N")
    'friction torque at a normal force of 2 N'
    """
    for words, other in ROTARY_WORDS.items():
        text = re.sub(words, other, text)
    return text


def turned_variable(variable: Variable) -> Variable:
    """Return a variable of a body that slides as that of one that turns.

    Examples
    --------
    >>> turned_variable(Variable(name="mass", unit="kg", meaning="mass of the body"))
    Variable(name='inertia', unit='kg m^2', meaning='moment of inertia of the body', positive=False)
    """
    return replace(
        variable,
        name=ROTARY_NAMES.get(variable.name, variable.name),
        unit=variable.unit if variable.name == "load" else turned(variable.unit),
        meaning=rotary_words(variable.meaning),
    )


def _turned(function: Function) -> Function:
    """Return a function of forces as one of torques, in names, units and words."""
    return replace(
        function,
        summary=rotary_words(function.summary),
        inputs=tuple(map(turned_variable, function.inputs)),
        outputs=tuple(map(turned_variable, function.outputs)),
        body=renamed(function.body, ROTARY_NAMES),
    )


def _variable(name: str, meaning: str = "", *, of: str = "", positive: bool = False) -> Variable:
    unit, words = MEANINGS[of or name]
    return Variable(name=name, unit=unit, meaning=meaning or words, positive=positive)


class _FunctionWriter:
    """Writes the functions of one law."""

    def __init__(self, law: Equations) -> None:
        self.law = law
        self.states = [se.Symbol(name) for name in (*law.bristles, *law.flags)]
        self.ends = [f"{state}_end" for state in self.states]
        kinds = [("m", "bristle state")] * len(law.bristles)
        kinds += [("", "1 while the element slips, else 0")] * len(law.flags)
        self.bristles = tuple(
            Variable(name=str(state), unit=unit, meaning=meaning)
            for state, (unit, meaning) in zip(self.states, kinds, strict=True)
        )
        self.new_bristles = tuple(
            replace(bristle, name=f"{bristle.name}_end", meaning=f"{bristle.meaning} at the end")
            for bristle in self.bristles
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
        if self.law.bristles:
            yield self._settle()
            yield self._implicit()
            yield self._two_stages()
        else:
            yield self._slide()
        if self.law.holds:
            yield self._departure()
        yield self._step()
        yield self._compensation()

    def _local(self, values: tuple[se.Expr, ...], side: int) -> tuple[se.Expr, ...]:
        """Return what holds in one sense of slip as seen along it."""
        deflections = self.states[: len(self.law.bristles)]
        turned_round = {VELOCITY: side * SPEED, **{z: side * z for z in deflections}}
        return tuple(side * value.subs(turned_round).subs({LOAD: NORMAL}) for value in values)

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
        )

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
        ahead, back = (item.subs({LOAD: NORMAL}) for item in self.law.break_away)
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
        """Write one step of slip without bristles, as seen along the direction of slip."""
        (ahead,), (back,) = self.ahead, self.back
        force, slope, pivot = map(se.Symbol, ("force", "force_v", "pivot"))
        first, second = map(se.Symbol, ("first_v", "second_v"))
        names = ("force", "force_v")
        return Function(
            name="slide",
            summary="Speed after slip in one direction, along which all are counted.",
            inputs=(
                _variable("speed"),
                *self._moved_by(),
                self._direction("1 forward, -1 backward"),
            ),
            outputs=(_variable("speed_end", "slip speed at the end", of="speed"),),
            body=(
                *_loaded(
                    _either(
                        Assign(names, (ahead, collapsed(ahead.diff(SPEED)))),
                        Assign(names, (back, collapsed(back.diff(SPEED)))),
                    )
                ),
                *floored("pivot", slope),
                Assign(("pivot",), (1 + GAMMA * PERIOD * pivot / MASS,)),
                Assign(("first_v",), ((APPLIED - force) / (MASS * pivot),)),
                *floored("speed_mid", SPEED + PERIOD * first),
                Call(("force",), "slip", (se.Symbol("speed_mid"), SENSE, LOAD)),
                Assign(("second_v",), (((APPLIED - force) / MASS - 2 * first) / pivot,)),
                Assign(("speed_end",), (SPEED + PERIOD * (1.5 * first + 0.5 * second),)),
            ),
            inner=True,
        )

    def _moved_by(self) -> tuple[Variable, ...]:
        return (_variable("applied"), _variable("load"), self._mass(), _variable("period"))

    def _settle(self) -> Function:
        """Write the deflections that an implicit step ends with at a velocity."""
        return Function(
            name="settle",
            summary="Bristle states at the end of an implicit step with a velocity.",
            inputs=(_variable("velocity"), *self.bristles, _variable("load"), _variable("period")),
            outputs=self.new_bristles,
            body=tuple(part for place in range(len(self.states)) for part in self._settled(place))
            if self.law.moved is None
            else _loaded(_by_velocity(tuple(self.ends), self.law.moved)),
            inner=True,
        )

    def _settled(self, place: int) -> Body:
        """Write the deflection of one bristle, whose rate falls with it."""
        z, end = self.states[place], se.Symbol(self.ends[place])
        slip = self.law.slip
        rates = [side[1 + place].subs({LOAD: NORMAL}) for side in (slip.ahead, slip.back)]
        slopes = [collapsed(-rate.diff(z)) for rate in rates]
        if not any(z in slope.free_symbols for slope in slopes):
            names = ("rate", "drop")
            pairs = zip(rates, slopes, strict=True)
            # Rates affine in the deflection: the implicit step is a division.
            ahead, back = (Assign(names, (rate, slope)) for rate, slope in pairs)
            rest = Assign(names, (slip.rest[1 + place].subs({LOAD: NORMAL}), ZERO))
            drop = se.Symbol("drop")
            step = PERIOD * se.Symbol("rate") / (1 + PERIOD * drop)
            return (
                *_loaded((_senses(ahead, back, rest),)),
                # A deflection that grows by itself is stepped explicitly: divisors stay at least 1.
                Branch(drop, ZERO, (Assign(("drop",), (ZERO,)),)),
                Assign((str(end),), (z + step,)),
            )
        values = [rate.subs({z: end}) for rate in rates]
        rest = slip.rest[1 + place].subs({LOAD: NORMAL, z: end})
        ahead, back, still = (Assign(("rate",), (value,)) for value in (*values, rest))
        evaluated = _loaded((_senses(ahead, back, still),))
        miss = Assign(("miss",), (end - z - PERIOD * se.Symbol("rate"),))
        return (
            Assign((str(end),), (z,)),
            *evaluated,
            Assign(("low", "miss_low"), (z, -PERIOD * se.Symbol("rate"))),
            Assign((str(end),), (z + PERIOD * se.Symbol("rate"),)),
            *_root(str(end), (*evaluated, miss)),
        )

    def _implicit(self) -> Function:
        """Write one stage, an implicit Euler step."""
        velocity_end = se.Symbol("velocity_end")
        ends = tuple(map(se.Symbol, self.ends))
        change = PERIOD / MASS * (APPLIED - se.Symbol("force"))
        evaluated: Body = (
            Call(tuple(self.ends), "settle", (velocity_end, *self.states, LOAD, PERIOD)),
            Call(("force",), "friction", (velocity_end, *ends, LOAD)),
            Assign(("miss",), (velocity_end - VELOCITY - change,)),
        )
        shift = se.Symbol("shift")
        widened: Body = (
            Branch(
                ZERO,
                se.Symbol("miss") * se.Symbol("miss_low"),
                (
                    Assign(("low", "miss_low"), (velocity_end, se.Symbol("miss"))),
                    Assign(("shift",), (2 * shift,)),
                    Assign(("velocity_end",), (velocity_end + shift,)),
                ),
                (Leave(),),
            ),
        )
        return Function(
            name="implicit",
            summary="Velocity and bristle states after an implicit Euler step.",
            inputs=(_variable("velocity"), *self.bristles, *self._moved_by()),
            outputs=self._slid(),
            body=(
                Assign(("velocity_end",), (VELOCITY,)),
                *evaluated,
                Assign(("low", "miss_low"), (VELOCITY, se.Symbol("miss"))),
                Assign(("shift",), (-se.Symbol("miss"),)),
                Assign(("velocity_end",), (VELOCITY + shift,)),
                Repeat(EXPANSIONS, (*evaluated, *widened)),
                *_root("velocity_end", evaluated),
            ),
            inner=True,
        )

    def _slid(self) -> tuple[Variable, ...]:
        return (
            _variable("velocity_end", "slip velocity at the end", of="velocity"),
            *self.new_bristles,
        )

    def _two_stages(self) -> Function:
        """Write one step with bristles, of two implicit stages."""
        outputs = ("velocity_end", *self.ends)
        given = (APPLIED, LOAD, MASS, GAMMA * PERIOD)
        ratio = (1.0 - GAMMA) / GAMMA
        states = (VELOCITY, *self.states)
        between: list[Statement] = [
            Assign((end,), (state + ratio * (se.Symbol(end) - state),))
            for end, state in zip(outputs, states, strict=True)
        ]
        if self.law.moved is not None:  # a straight line would lead elements past their limits
            rest = (1.0 - GAMMA) * PERIOD
            reached = (se.Symbol("velocity_end"), *self.states, LOAD, rest)
            between = [Call(tuple(self.ends), "settle", reached), between[0]]
        return Function(
            name="slide",
            summary="Velocity and bristle states after a period.",
            inputs=(_variable("velocity"), *self.bristles, *self._moved_by()),
            outputs=self._slid(),
            body=(
                Call(outputs, "implicit", (*states, *given)),
                *between,
                Call(outputs, "implicit", (*map(se.Symbol, outputs), *given)),
            ),
            inner=True,
        )

    def _departure(self) -> Function:
        """Write the sense in which a body at rest begins to slip."""
        out = ("direction",)
        backward = Branch(
            se.Symbol("back"), -APPLIED, (Assign(out, (-ONE,)),), (Assign(out, (ZERO,)),)
        )
        return Function(
            name="departure",
            summary="Direction in which slip begins from rest, 0 if the body sticks.",
            inputs=(_variable("applied"), _variable("load")),
            outputs=(self._direction("1 forward, -1 backward, 0 at rest"),),
            body=(
                Call(("ahead",), "break_away", (ONE, LOAD)),
                Call(("back",), "break_away", (-ONE, LOAD)),
                Branch(se.Symbol("ahead"), APPLIED, (Assign(out, (ONE,)),), (backward,)),
            ),
            inner=True,
        )

    def _step(self) -> Function:
        moved = ("velocity_end", *self.ends, "displacement", "friction", "sticks")
        return Function(
            name="step",
            summary="Motion over one period of a body under a constant force and friction."
            + DROPS * self.law.drops,
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
        # What the body was given less what it kept: the mean force, whatever the steps within were.
        closing = Assign(("friction",), (APPLIED - MASS * (velocity_end - VELOCITY) / PERIOD,))
        if not self.law.holds:
            moved = (
                *self._sliding(VELOCITY, tuple(self.states), PERIOD),
                Assign(("displacement",), ((VELOCITY + velocity_end) * PERIOD / 2,)),
            )
            return (*moved, Assign(("sticks",), (ZERO,)), closing)
        at_rest = Call(("sense",), "departure", (APPLIED, LOAD))
        stays: Body = (
            Assign(("velocity_end", "displacement"), (ZERO, ZERO)),
            *(Assign((end,), (z,)) for end, z in zip(self.ends, self.states, strict=True)),
        )
        return (
            _senses(Assign(("sense",), (ONE,)), Assign(("sense",), (-ONE,)), at_rest),
            Branch(ZERO, sense * sense, self._moves(), stays),
            Assign(("sticks",), (ZERO,)),
            Branch(sense * sense, ONE, (Assign(("sticks",), (ONE,)),)),
            closing,
        )

    def _sliding(self, velocity: se.Expr, states: tuple[se.Expr, ...], period: se.Expr) -> Body:
        """Assign velocity and bristle states after slip, in the sense where that matters."""
        sense = se.Symbol("sense")
        if self.states:
            given = (velocity, *states, APPLIED, LOAD, MASS, period)
            return (Call(("velocity_end", *self.ends), "slide", given),)
        return (
            Call(
                ("velocity_end",),
                "slide",
                (sense * velocity, sense * APPLIED, LOAD, MASS, period, sense),
            ),
            Assign(("velocity_end",), (sense * se.Symbol("velocity_end"),)),
        )

    def _moves(self) -> Body:
        """Slip in the sense of the velocity, and divide the period where it ends."""
        sense, end = se.Symbol("sense"), se.Symbol("velocity_end")
        share, used, rest = map(se.Symbol, ("share", "used", "rest"))
        z_ends = tuple(map(se.Symbol, self.ends))
        # A trapezium: velocities are known at both ends.
        through: Body = (Assign(("displacement",), ((VELOCITY + end) * PERIOD / 2,)),)
        # A step of friction alone does not turn a body round.
        backwards = Branch(sense * end, ZERO, (Assign(("velocity_end",), (ZERO,)),))
        on: Body = (
            *self._sliding(ZERO, z_ends, rest),
            *((backwards,) if not self.states else ()),
            Assign(("displacement",), (se.Symbol("displacement") + end * rest / 2,)),
        )
        passed: Body = (
            Assign(("share",), (ZERO,)),
            # Where a straight line between both velocities crosses 0.
            Branch(ZERO, sense * VELOCITY, (Assign(("share",), (VELOCITY / (VELOCITY - end),)),)),
            Assign(("used", "rest"), (share * PERIOD, (1 - share) * PERIOD)),
            Assign(("displacement",), (VELOCITY * used / 2,)),
            *(
                Assign((str(item),), (z + (item - z) * share,))
                for item, z in zip(z_ends, self.states, strict=True)
            ),
            Call(("sense",), "departure", (APPLIED, LOAD)),
            Branch(ZERO, sense * sense, on, (Assign(("velocity_end",), (ZERO,)),)),
        )
        return (
            *self._sliding(VELOCITY, tuple(self.states), PERIOD),
            Branch(ZERO, sense * end, through, passed),
        )

    def _compensation(self) -> Function:
        width, share = se.Symbol("width"), se.Symbol("share")
        crossing = share * (3 - share * share) / 2
        force = "steady" if self.law.steady is not None else "friction"
        size = se.Piecewise((-VELOCITY, VELOCITY < ZERO), (VELOCITY, True))
        faded = Assign(("force",), (se.Symbol("factor") * crossing * se.Symbol("force"),))
        rest = Assign(("force",), (ZERO,))  # without a sign, as it would have from the velocity
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
                Branch(ZERO, share, (faded,), (rest,)),
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
        Assign(names, tuple(level.subs({LOAD: NORMAL}) for level in side))
        for side in (values.ahead, values.back, values.rest)
    )
    still = tuple(value.subs({VELOCITY: ZERO}) for value in ahead.values)
    if ahead == back and still == rest.values:
        return (ahead,)
    return (_senses(ahead, back, rest),)


def _senses(ahead: Statement, back: Statement, rest: Statement) -> Branch:
    """Do one thing at a velocity above 0, another below, and a third at rest."""
    return Branch(ZERO, VELOCITY, (ahead,), (Branch(VELOCITY, ZERO, (back,), (rest,)),))


def _either(ahead: Assign, back: Assign) -> Body:
    """Assign what holds in the direction of slip, once where it is the same in both."""
    pairs = zip(ahead.values, back.values, strict=True)
    if all(a == b or se.expand(a - b) == 0 for a, b in pairs):
        return (ahead,)
    return (Branch(ZERO, SENSE, (ahead,), (back,)),)


def _root(name: str, evaluated: Body) -> Body:
    """Move a name to where its miss is 0, from there to ``low`` with ``miss_low`` (Illinois).

    The bracket may be given by an estimate of the name alone; without a change of sign it stays.
    """
    at, low, miss, miss_low = map(se.Symbol, (name, "low", "miss", "miss_low"))
    tried, miss_at = se.Symbol("tried"), se.Symbol("miss_tried")
    # The square of a share of the first bracket: misses are compared as squares, which need no
    # root.
    scale = ROOT_TOLERANCE * ROOT_TOLERANCE * (at - low) * (at - low)
    return (
        *evaluated,
        Assign(("scale",), (scale,)),
        Assign(("tried", "miss_tried"), (at, miss)),
        Repeat(
            ROOTS,
            (
                Branch(
                    miss_at * miss_low,
                    ZERO,
                    (
                        Assign(
                            (name,), ((low * miss_at - tried * miss_low) / (miss_at - miss_low),)
                        ),
                        *evaluated,
                        Branch(
                            miss * miss_at,
                            ZERO,
                            (Assign(("low", "miss_low"), (tried, miss_at)),),
                            # Illinois: halving the miss at the end that stays shrinks the
                            # bracket from both sides.
                            (Assign(("miss_low",), (miss_low / 2,)),),
                        ),
                        Assign(("tried", "miss_tried"), (at, miss)),
                        Branch(miss * miss, se.Symbol("scale"), (Leave(),)),
                    ),
                    (Leave(),),
                ),
            ),
        ),
    )


# How C and MATLAB write a law as a program: what differs is data, the printer is one.

WIDTH: Final = 96
INDENT: Final = "    "
SAME_NAMES: Final = {name: name for name in ("exp", "sqrt", "sin", "cos", "tanh", "atan", "log")}


@dataclass(frozen=True, kw_only=True)
class Language:
    """What differs between languages below the heads of functions."""

    syntax: Syntax
    """Expressions, assignments and branches."""
    chained: str
    """Head of a branch that stands elsewhere in another, with its ``{condition}``."""
    joined: str
    """What stands between the name of the program and that of a function."""
    single: str
    """A call with one result: ``{name}``, ``{function}``, ``{arguments}``."""
    several: tuple[str, ...]
    """Lines of a call with several results, which are ``{names}``; a line with ``{name}`` stands
    for each of them."""
    repeat: tuple[str, str]
    """Head and end of what is repeated so many ``{times}``."""
    leave: str
    """What ends it before."""
    constant: str
    """Definition of a constant: ``{name}``, ``{value}``, ``{unit}``, ``{text}``."""
    declaration: str
    """Declaration of ``{names}``; none if empty."""


C: Final = Language(
    syntax=Syntax(
        functions=SAME_NAMES,
        power="pow({base}, {exponent})",
        assign="{name} = {value};",
        branch="if ({condition}) {{",
        otherwise="} else {",
        end="}",
    ),
    chained="}} else if ({condition}) {{",
    joined="{program}_{function}",
    single="{name} = {function}({arguments});",
    several=(
        "{{",
        "    const {function}_result result = {function}({arguments});",
        "    {name} = result.{output};",
        "}}",
    ),
    repeat=("for (int turn = 0; turn < {times}; turn++) {{", "}"),
    leave="break;",
    constant="const double {name} = {value}; /* [{unit}] {text} */",
    declaration="double {names};",
)
MATLAB: Final = Language(
    syntax=Syntax(
        functions=SAME_NAMES,
        power="power({base}, {exponent})",
        assign="{name} = {value};",
        branch="if {condition}",
        otherwise="else",
        end="end",
    ),
    chained="elseif {condition}",
    joined="{program}_{function}",
    single="{name} = {function}({arguments});",
    several=("[{names}] = {function}({arguments});",),
    repeat=("for turn = 1:{times}", "end"),
    leave="break",
    constant="{name} = {value}; % [{unit}] {text}",
    declaration="",
)


@dataclass(frozen=True, kw_only=True)
class Written:
    """A function's inside in a language."""

    constants: tuple[str, ...]
    """Definitions of the parameters that it uses."""
    declarations: tuple[str, ...]
    """Declarations of its variables, results excluded where the language declares them."""
    statements: tuple[str, ...]
    """What it does."""


def written(
    function: Function,
    language: Language,
    program: str,
    constants: Sequence[Constant],
    functions: Mapping[str, Function],
    *,
    results: bool,
) -> Written:
    """Return what stands inside of a function."""
    block = Block(language.syntax, 1)
    _Writer(block=block, language=language, program=program, functions=functions).write(
        function.body
    )
    lines = tuple(block.lines)
    own = {output.name for output in function.outputs}
    kept = [name for name in dict.fromkeys(assigned(function.body)) if results or name not in own]
    names = [*kept, *block.temporaries]
    used = [constant for constant in constants if contains(lines, constant.name)]
    return Written(
        constants=tuple(
            INDENT
            + language.constant.format(
                name=value.name, value=repr(value.value), unit=value.unit, text=value.meaning
            )
            for value in used
        ),
        declarations=_declared(names, language),
        statements=lines,
    )


def contains(lines: Sequence[str], name: str) -> bool:
    """Return whether a line contains a name as a word."""
    word = re.compile(rf"\b{name}\b")
    return any(word.search(line) for line in lines)


def _declared(names: Sequence[str], language: Language) -> tuple[str, ...]:
    if not language.declaration or not names:
        return ()
    rows = textwrap.wrap(", ".join(names), WIDTH)
    return tuple(INDENT + language.declaration.format(names=row.rstrip(",")) for row in rows)


@dataclass(frozen=True, kw_only=True)
class _Writer:
    """Writes statements into a block."""

    block: Block
    language: Language
    program: str
    functions: Mapping[str, Function]

    def write(self, body: Sequence[Statement]) -> None:
        for statement in body:
            if isinstance(statement, Assign):
                texts = self.block.scope(list(statement.values))
                for name, text in zip(statement.names, texts, strict=True):
                    self.block.assign(name, text)
            elif isinstance(statement, Branch):
                self._branch(statement)
            elif isinstance(statement, Repeat):
                self._repeat(statement)
            elif isinstance(statement, Leave):
                self.block.line(self.language.leave)
            else:
                self._call(statement)

    def _repeat(self, loop: Repeat) -> None:
        head, end = self.language.repeat
        self.block.line(head.format(times=loop.times))
        self._indented(loop.body)
        self.block.line(end)

    def _branch(self, branch: Branch, *, chained: bool = False) -> None:
        """Write a branch; one that alone stands elsewhere in another goes on as its chain."""
        left, right = self.block.scope([branch.left, branch.right])
        syntax = self.language.syntax
        head = self.language.chained if chained else syntax.branch
        self.block.line(head.format(condition=f"{left} < {right}"))
        self._indented(branch.yes)
        if len(branch.no) == 1 and isinstance(branch.no[0], Branch) and _is_plain(branch.no[0]):
            self._branch(branch.no[0], chained=True)
        elif branch.no:
            self.block.line(syntax.otherwise)
            self._indented(branch.no)
        if not chained:
            self.block.line(syntax.end)

    def _indented(self, body: Sequence[Statement]) -> None:
        self.block.depth += 1
        self.write(body)
        self.block.depth -= 1

    def _call(self, call: Call) -> None:
        arguments = ", ".join(self.block.scope(list(call.arguments)))
        called = self.language.joined.format(program=self.program, function=call.function)
        pairs = list(zip(call.names, self.functions[call.function].outputs, strict=True))
        for form in self.language.several if len(pairs) > 1 else (self.language.single,):
            for name, output in pairs if "{name}" in form else pairs[:1]:
                self.block.line(
                    form.format(
                        name=name,
                        output=output.name,
                        names=", ".join(call.names),
                        function=called,
                        arguments=arguments,
                    )
                )


def _is_plain(branch: Branch) -> bool:
    """Whether the condition of a branch needs no temporaries."""
    return all(e.is_Symbol or e.is_Number or (-e).is_Symbol for e in (branch.left, branch.right))


@dataclass(frozen=True, kw_only=True)
class Source:
    """A law as a program in a language."""

    subject: Subject
    """What is exported."""
    language: Language
    """The language."""
    safe: Callable[[str], str]
    """Makes a text one that a comment of the language can hold."""

    @cached_property
    def functions(self) -> tuple[Function, ...]:
        """All functions that are called or may be, each after those that it calls."""
        every = functions_of(self.subject.equations, rotary=self.subject.rotary)
        wanted = {part.name for part in every if not part.inner}
        for function in reversed(every):  # each stands after those that it calls
            if function.name in wanted:
                wanted |= set(called(function.body))
        return tuple(part for part in every if part.name in wanted)

    @cached_property
    def constants(self) -> tuple[Constant, ...]:
        """Parameters of the law, whose words a comment can hold."""
        return tuple(
            Constant(name=c.name, value=c.value, unit=c.unit, meaning=self.safe(c.meaning))
            for c in self.subject.constants()
        )

    def inside(self, function: Function, *, results: bool) -> Written:
        """Return what stands inside of a function."""
        return written(
            function,
            self.language,
            self.subject.name,
            self.constants,
            {part.name: part for part in self.functions},
            results=results,
        )

    def name_of(self, function: Function) -> str:
        """Return the name of a function with that of the program."""
        return self.language.joined.format(program=self.subject.name, function=function.name)

    def header(self) -> list[str]:
        """Return the lines that say what the program is."""
        return [self.safe(line) for line in self.subject.header()]


def commented(lines: Sequence[str], before: str) -> Iterator[str]:
    """Yield lines as comments, long ones folded."""
    for line in lines:
        indent = line[: len(line) - len(line.lstrip())]
        folded = textwrap.wrap(
            line, WIDTH - len(before), subsequent_indent=indent + "  ", break_long_words=False
        )
        yield from (f"{before}{part}".rstrip() for part in folded or [""])
