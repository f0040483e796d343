"""Symbols that flow through laws and mechanisms, what of a mechanism they show, and the model.

`Traced` wraps a SymEngine expression and refuses what would silently go wrong: Python's ``if`` on a
symbol, equality, powers with a traced exponent. Comparisons decided by `where` become *switches*:
conditions frozen within a step, whose change the solver locates as an event. From the expressions
follow which coordinates are guided or held, and which modes have constant coefficients.
"""

from __future__ import annotations

import math
import numbers
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NoReturn

import symengine as se

from stickslip.engine.kernels.state_layout import Sizes
from stickslip.errors import InputError, TracingError, not_finite
from stickslip.friction import FrictionLaw
from stickslip.maths import NO_COMPARISON
from stickslip.mechanisms import Guide, Mechanism, normal_of, stops_of

LONGEST_EXPRESSION = 2000
"""Characters of an expression beyond which it is not expanded to look for cancellations."""

EXACT = 1024
"""Largest numerator and denominator that are kept as whole numbers."""


@dataclass(frozen=True)
class Switch:
    """A condition of the equations: it holds while `margin` is positive."""

    margin: se.Expr
    """Positive where the condition holds."""
    symbol: se.Symbol
    """Stands for the condition in the equations, which ask whether it is positive."""
    events: tuple[str, str] | None
    """Names in the events of a run, when it comes true and ceases to hold; None inside."""
    hold: se.Expr | None = None
    """What a latched switch lasts by once it is on; None of one that ends with its condition."""


@dataclass
class Switchboard:
    """Collects the switches met while tracing, and knows the signs that the mode fixes."""

    switches: dict[str, Switch] = field(default_factory=dict)
    """Switches by the expanded text of their margin, in the order in which they were met."""
    signs: dict[str, int] = field(default_factory=dict)
    """Sign, 1 or -1, of symbols that the mode fixes, by name."""

    def switch(
        self, margin: se.Expr, events: tuple[str, str] | None, hold: se.Expr | None = None
    ) -> Switch:
        """Return the switch of a margin, a new one if it was not met before."""
        # Expanded: the same condition may be written in several ways, and is one switch.
        key = str(se.expand(margin)) + ("" if hold is None else f" while {se.expand(hold)}")
        if key not in self.switches:
            symbol = se.Symbol(f"s{len(self.switches)}")
            self.switches[key] = Switch(margin, symbol, events, hold)
        return self.switches[key]

    def deciding(self, switch: Switch) -> se.Expr:
        """Return the margin of a switch where one mode follows another.

        What a latched one lasts by comes first, unless it is 0. Its margin does not depend on other
        switches but on what these ask for: while they settle, none must make it latch.
        """
        if switch.hold is None:
            return switch.margin
        margin, hold = self.settled(switch.margin), self.settled(switch.hold)
        on = se.Piecewise((hold, hold > 0), (margin, True))
        lasts = se.Piecewise((on, switch.symbol > 0), (margin, True))
        return se.Piecewise((hold, hold < 0), (lasts, True))

    def settled(self, e: se.Expr) -> se.Expr:
        """Put the margins of switches in place of their symbols; a margin may have switches too."""
        # A margin may have symbols of switches that were met before it: the last one first.
        for switch in reversed(self.switches.values()):
            if switch.hold is None:
                e = e.subs({switch.symbol: switch.margin})
        return e

    def known_sign(self, expr: se.Expr) -> int | None:
        """Return the sign of an expression where the mode or its being a number fixes it."""
        if expr.is_Number:
            return int(bool(expr > 0)) - int(bool(expr < 0))
        if str(expr) in self.signs:
            return self.signs[str(expr)]
        # |v| and |-v| are switched by one sign.
        if str(-expr) in self.signs:
            return -self.signs[str(-expr)]
        return None

    def choose(
        self,
        margin: se.Expr,
        yes: se.Expr,
        no: se.Expr,
        events: tuple[str, str] | None = None,
        hold: se.Expr | None = None,
    ) -> se.Expr:
        """Return `yes` where the margin is positive, else `no`."""
        sign = self.known_sign(margin)
        if sign is not None:
            return yes if sign > 0 else no
        if yes == no:
            return yes
        switch = self.switch(margin, events, hold)
        return se.Piecewise((yes, switch.symbol > 0), (no, True))


def expression(value: Any) -> se.Expr:
    """Return the SymEngine expression of a traced value or a number."""
    if isinstance(value, Traced):
        return value.expr
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TracingError(
            f"an equation contains {value!r}, which is neither a number nor a symbol"
        )
    if not math.isfinite(value):
        raise TracingError(not_finite(value))
    top, bottom = float(value).as_integer_ratio()
    # 0.5 and its like stay exact, so that factors from energies cancel instead of piling up
    return (
        se.Integer(top) / bottom if bottom <= EXACT and abs(top) <= EXACT else se.RealDouble(value)
    )


class Traced:
    """A symbol or expression in equations under tracing.

    Parameters
    ----------
    expr : Expr
        The expression.
    board : Switchboard
        Collects the switches that comparisons of it make.
    """

    __slots__ = ("board", "expr")
    __array_ufunc__ = None  # NumPy leaves mixed operations to us

    def __init__(self, expr: se.Expr, board: Switchboard) -> None:
        self.expr = expr
        self.board = board

    def _new(self, expr: se.Expr) -> Traced:
        return Traced(expr, self.board)

    def __repr__(self) -> str:
        return f"Traced({self.expr})"

    def __add__(self, other: Any) -> Traced:
        return self._new(self.expr + expression(other))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Traced:
        return self._new(self.expr - expression(other))

    def __rsub__(self, other: Any) -> Traced:
        return self._new(expression(other) - self.expr)

    def __mul__(self, other: Any) -> Traced:
        return self._new(self.expr * expression(other))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Traced:
        return self._new(self.expr / expression(other))

    def __rtruediv__(self, other: Any) -> Traced:
        return self._new(expression(other) / self.expr)

    def __neg__(self) -> Traced:
        return self._new(-self.expr)

    def __pos__(self) -> Traced:
        return self

    def __pow__(self, exponent: Any) -> Traced:
        if isinstance(exponent, (float, int)) and float(exponent).is_integer():
            # A negative base is fine for whole powers alone.
            return self._new(self.expr ** int(exponent))
        raise TracingError(
            "** requires a whole-number exponent here; use stickslip.maths.power or sqrt"
        )

    def __rpow__(self, base: Any) -> NoReturn:
        raise TracingError("** requires a whole-number exponent here; use stickslip.maths.power")

    def __abs__(self) -> Traced:
        return self._new(self.board.choose(self.expr, self.expr, -self.expr))

    def __gt__(self, other: Any) -> Condition:
        return Condition(self.expr - expression(other), self.board)

    __ge__ = __gt__

    def __lt__(self, other: Any) -> Condition:
        return Condition(expression(other) - self.expr, self.board)

    __le__ = __lt__

    def __bool__(self) -> NoReturn:
        raise TracingError(
            "a traced value has no truth value: write stickslip.maths.where(condition, yes, no)"
            " instead of if, and, or, min, max"
        )

    def __eq__(self, other: object) -> NoReturn:
        raise TracingError(
            "a traced value cannot be compared for equality: use stickslip.maths.where with < or >"
        )

    __hash__ = None  # type: ignore[assignment]  # equality is refused, so hashing is too

    def __float__(self) -> NoReturn:
        raise TracingError(
            "a traced value is not a number: use exp, sin, sqrt, ... of stickslip.maths, not math"
        )

    def __maths__(self, name: str, *arguments: Any) -> Traced:
        """Serve the functions of `stickslip.maths`."""
        if name == "power":
            return self._power(*arguments)
        if name == "latched":
            margin, hold, yes, no = map(expression, arguments)
            return self._new(self.board.choose(margin, yes, no, hold=hold))
        if name == "where":
            raise TracingError(NO_COMPARISON)
        if name == "sign":
            return self._new(self.board.choose(self.expr, se.Integer(1), se.Integer(-1)))
        return self._new(getattr(se, name)(self.expr))

    def _power(self, base: Any, exponent: Any) -> Traced:
        b = expression(base)
        if isinstance(exponent, (float, int)) and float(exponent).is_integer():
            return self._new(b ** int(exponent))
        n = expression(exponent)
        # A number to the power of an expression is an exponential, which has a derivative
        # everywhere.
        if b.is_Number:
            positive = float(b) > 0.0
            return self._new(se.exp(n * math.log(float(b))) if positive else se.Integer(0))
        # 0 where the base is not positive, as `stickslip.maths.power` has it for numbers.
        return self._new(se.Piecewise((b**n, b > 0), (se.Integer(0), True)))


class Condition:
    """A comparison of traced values, waiting for `where`.

    Parameters
    ----------
    margin : Expr
        Positive where the comparison holds.
    board : Switchboard
        Collects the switch when `where` asks.
    """

    __slots__ = ("board", "margin")

    def __init__(self, margin: se.Expr, board: Switchboard) -> None:
        self.margin = margin
        self.board = board

    def __bool__(self) -> NoReturn:
        raise TracingError(
            "a comparison of traced values has no truth value: write"
            " stickslip.maths.where(condition, yes, no) instead of if, and, or, min, max"
        )

    def __maths__(self, name: str, yes: Any, no: Any, events: tuple[str, str] | None) -> Traced:
        """Serve `stickslip.maths.where`."""
        chosen = self.board.choose(self.margin, expression(yes), expression(no), events)
        return Traced(chosen, self.board)


def is_zero(e: se.Expr) -> bool:
    """Whether the terms of an expression cancel; long ones are not examined."""
    return bool(e == 0) or (len(str(e)) <= LONGEST_EXPRESSION and bool(se.expand(e) == 0))


def collapsed(e: se.Expr, plain: set[se.Expr] | None = None) -> se.Expr:
    """Merge branches that became equal, as they do after a derivative."""
    known = set() if plain is None else plain

    def merged(switch: se.Piecewise) -> se.Expr:
        yes, condition, no, _ = switch.args
        yes, no = collapsed(yes, known), collapsed(no, known)
        # Derivatives of |v| and its like have branches that no longer differ.
        return yes if se.expand(yes - no) == 0 else se.Piecewise((yes, condition), (no, True))

    return rebuilt(e, merged, known)


def rebuilt(
    e: se.Expr, change: Callable[[se.Piecewise], se.Expr], plain: set[se.Expr] | None = None
) -> se.Expr:
    """Return an expression with its outermost switches changed.

    Parts that several others share, of which recursions make many, are looked at once. Those
    without a switch are added to `plain`, so that expressions of the same parts pass them over.
    """
    seen: dict[se.Expr, se.Expr] = {}
    known = set() if plain is None else plain

    def changed(part: se.Expr) -> se.Expr:
        if part.is_Atom or part in known:
            return part
        if part in seen:
            return seen[part]
        if isinstance(part, se.Piecewise):
            new = change(part)
        else:
            old = part.args
            parts = [changed(item) for item in old]
            # By identity: what has no switch inside is kept as it is, without a comparison of
            # trees.
            if all(map(operator.is_, parts, old)):
                known.add(part)
                return part
            new = part.func(*parts)
        seen[part] = new
        return new

    return changed(e)


@dataclass(frozen=True)
class Symbols:
    """The symbols of one formulation."""

    t: se.Symbol
    """Time."""
    coordinates: list[se.Symbol]
    """Of the coordinates."""
    rates: list[se.Symbol]
    """Of their rates."""
    bristles: list[se.Symbol]
    """Of the bristle states."""
    drives: dict[str, se.Symbol]
    """Of the drives' values by name."""
    inputs: dict[se.Symbol, se.Expr]
    """Expression of each drive."""
    given: dict[se.Symbol, se.Symbol]
    """Place of each drive where its value is given from outside."""
    constants: frozenset[str]
    """Names of the symbols of parameters."""

    def closed(self, e: se.Expr) -> se.Expr:
        """Put the drives' expressions in."""
        return e.subs(self.inputs)

    @property
    def states(self) -> list[se.Symbol]:
        """Coordinates, rates, bristles."""
        return [*self.coordinates, *self.rates, *self.bristles]


def symbols_of(
    twin: Mechanism, bristles: int, constants: frozenset[str], board: Switchboard
) -> Symbols:
    """Return the symbols of a mechanism whose parameters are symbols."""
    n = len(twin.coordinates)
    y = [se.Symbol(f"y{i}") for i in range(2 * n + bristles)]
    t = se.Symbol("t")
    names = (*twin.coordinates, *twin.rates)
    seen = {name: Traced(s, board) for name, s in zip(names, y, strict=False)}
    drives, inputs = {}, {}
    for k, (name, drive) in enumerate(twin.drives().items()):
        value, slope, start = (se.Symbol(f"p{3 * k + i}") for i in range(3))
        drives[name] = se.Symbol(f"d{k}")
        # A drive is a straight line in each piece; what shapes it is traced along with it.
        linear = value + slope * (t - start)
        shaped = drive.shaped(Traced(linear, board), Traced(t, board)) + drive.fed(seen)
        inputs[drives[name]] = expression(shaped)
    given = {d: se.Symbol(f"p{3 * len(drives) + k}") for k, d in enumerate(drives.values())}
    return Symbols(t, y[:n], y[n : 2 * n], y[2 * n :], drives, inputs, given, constants)


# What is linear: modes with constant coefficients, solved in closed form; friction in the load.

MOST_SWITCHES = 4
"""A mode that depends on more switches than this is not examined."""


@dataclass(frozen=True)
class Waves:
    """Sines and cosines in time, all of one frequency, by which linear equations may be driven."""

    symbols: Mapping[se.Expr, se.Symbol]
    """What stands for each of them."""
    square: se.Expr
    """Square of their angular frequency."""

    def replaced(self, e: se.Expr) -> se.Expr:
        """Return an expression with symbols for the waves."""
        return e.xreplace(self.symbols) if self.symbols else e

    def term(self, e: se.Expr) -> se.Expr:
        """Return what the waves add to an expression that is affine in them."""
        replaced = self.replaced(e)
        slopes = {wave: collapsed(replaced.diff(symbol)) for wave, symbol in self.symbols.items()}
        return sum((slope * wave for wave, slope in slopes.items()), se.Integer(0))


def waves_of(expressions: Sequence[se.Expr], t: se.Symbol, states: Sequence[se.Symbol]) -> Waves:
    """Return the waves in expressions; none where their frequencies differ, or change."""
    # Only what depends on time: sines of places are no waves.
    atoms = {a for e in expressions for a in e.atoms(se.sin, se.cos) if not _free_of(a, {str(t)})}
    moving = {str(t), *map(str, states)}
    squares = {se.expand(a.args[0].diff(t) ** 2) for a in atoms}
    steady = all(_free_of(square, moving) for square in squares)
    alone = all(_free_of(a.args[0], moving - {str(t)}) for a in atoms)
    if len(squares) != 1 or not (steady and alone):
        # Steps by series know harmonics of one frequency.
        return Waves({}, se.Integer(0))
    ordered = sorted(atoms, key=str)
    return Waves({a: se.Symbol(f"wave{i}") for i, a in enumerate(ordered)}, squares.pop())


def linear_where(
    expressions: Sequence[se.Expr], variables: Sequence[se.Symbol], switches: Sequence[se.Symbol]
) -> se.Expr:
    """Return 1 where all expressions are affine in the variables together, else 0."""
    names = {str(s) for e in expressions for s in e.free_symbols}
    used = [switch for switch in switches if str(switch) in names]
    # Each switch doubles the cases: few of them are examined.
    if len(used) > MOST_SWITCHES:
        return se.Integer(0)
    return _decide(list(expressions), list(variables), used, {})


def _decide(
    expressions: list[se.Expr],
    variables: list[se.Symbol],
    pending: list[se.Symbol],
    fixed: Mapping[str, bool],
) -> se.Expr:
    if not pending:
        affine = all(_affine(_chosen(e, fixed), variables) for e in expressions)
        return se.Integer(int(affine))
    first, *others = pending
    # Both sides of a switch: linear where it is on, or off, or always.
    yes, no = (
        _decide(expressions, variables, others, {**fixed, str(first): value})
        for value in (True, False)
    )
    return yes if yes == no else se.Piecewise((yes, first > 0), (no, True))


def _chosen(e: se.Expr, fixed: Mapping[str, bool]) -> se.Expr:
    """Return an expression with the branches that hold for given switches."""

    def chosen(switch: se.Piecewise) -> se.Expr:
        yes, condition, no, _ = switch.args
        name = str(condition.args[1])
        return _chosen(yes if fixed[name] else no, fixed) if name in fixed else switch

    return rebuilt(e, chosen)


def _affine(e: se.Expr, variables: list[se.Symbol]) -> bool:
    """Whether no slope of the expression depends on a variable."""
    names = {str(variable) for variable in variables}
    return all(_free_of(e.diff(variable), names) for variable in variables)


def _free_of(e: se.Expr, names: set[str]) -> bool:
    # Names are cheap to look at; expanding is not, and long expressions count as dependent.
    if not names & {str(s) for s in e.free_symbols}:
        return True
    if len(str(e)) > LONGEST_EXPRESSION:
        return False
    return not names & {str(s) for s in se.expand(e).free_symbols}


def load_factor(law: FrictionLaw, friction: se.Expr, load: se.Symbol) -> se.Expr:
    """Return b of friction a + b N."""
    factor = collapsed(friction.diff(load))
    if se.expand(collapsed(factor.diff(load))) != 0:
        raise TracingError(
            f"{type(law).__name__}: friction must be affine in the load, F = a + b N; its second"
            " derivative with respect to N is not zero"
        )
    return factor


# Coordinates that do not move freely: those that drives guide, and those held at 0.

TAKEN = ("t", "friction", "normal_force", "mode")
"""Columns that every run has."""
RESERVED = ("lift-off", "painleve")
"""Limits that the solver knows itself."""


def held_of(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the coordinates held at 0, the contact's normal one first."""
    normal = normal_of(mechanism)
    held = (*(() if normal is None else (normal,)), *mechanism.held())
    for name in held:
        if name in mechanism.coordinates or held.count(name) > 1:
            raise InputError(
                f"{type(mechanism).__name__} holds {name!r} at 0, but that coordinate moves or is"
                " already held: give held coordinates names of their own."
            )
    return held


def guides_of(
    mechanism: Mechanism, slips: Sequence[str], drives: Mapping[str, se.Symbol]
) -> dict[int, se.Expr]:
    """Return the accelerations of guided coordinates by index."""
    result = {}
    for name, guide in mechanism.guided().items():
        wrong = _fault(mechanism, slips, name, guide, list(drives))
        if wrong:
            raise InputError(f"{type(mechanism).__name__}: {wrong}")
        result[mechanism.coordinates.index(name)] = drives[guide.drive]
    return result


def _fault(
    mechanism: Mechanism, slips: Sequence[str], name: str, guide: object, drives: Sequence[str]
) -> str:
    """Return why a coordinate cannot be guided so, or nothing."""
    if name in slips:
        which = "the" if len(set(slips)) == 1 else "a"
        return f"{name} is {which} slip coordinate, whose motion cannot be prescribed."
    others = [coordinate for coordinate in mechanism.coordinates if coordinate not in slips]
    if name not in others or not isinstance(guide, Guide) or guide.drive not in drives:
        return (
            f"{name!r} is guided by {guide!r}; only {', '.join(others) or 'no coordinate'} can be"
            " guided, by a Guide(...) that names one of the drives"
            f" {', '.join(drives) or '(none)'}."
        )
    if name in {stop.coordinate for stop in stops_of(mechanism)}:
        return (
            f"the motion of {name} is prescribed, so it cannot have hard stops. Leave the stops"
            " out, or drive it by a force."
        )
    if guide.effort in (*mechanism.coordinates, *mechanism.rates, *TAKEN):
        return (
            f"the effort on {name} is named {guide.effort!r}, the name of another column of the"
            " run: give it another name."
        )
    return ""


def own_limits(mechanism: Mechanism, forces: Mapping[str, object]) -> Mapping[str, object]:
    """Return the limits that a mechanism has of its own."""
    owner = type(mechanism).__name__
    try:
        limits = mechanism.limits(forces)
    except KeyError as error:
        raise InputError(
            f"{owner}.limits refers to the force {error.args[0]!r}; the forces are"
            f" {', '.join(forces) or 'none'}."
        ) from None
    for name in RESERVED:
        if name in limits:
            raise InputError(
                f"{owner} has a limit {name!r}, a name reserved for the solver: give it another"
                " name."
            )
    return limits


# What a formulated mechanism with its friction is: text, sizes, and the meaning of each number.


@dataclass(frozen=True, kw_only=True)
class Model:
    """The equations of a mechanism with a law, ready to be run, and the meaning of each number."""

    title: str
    """Mechanism and law in words."""
    sizes: Sizes
    """How much of everything it has, for the vectors of a run."""
    text: str
    """Program text: the functions that the kernels call."""
    states: tuple[str, ...]
    """Names of the states, coordinates before rates before bristles."""
    parameter_paths: tuple[str, ...]
    """Paths of the parameters in their order."""
    places: tuple[int, ...]
    """Place of each parameter in the vector of a run."""
    drives: tuple[str, ...]
    """Names of the drives; each owns three places at the beginning: value, slope, start."""
    switch_events: tuple[tuple[str, str] | None, ...]
    """What each switch is called in events, when it comes true and when it ceases to hold."""
    impact_events: tuple[str | None, ...]
    """What an impact of each coordinate is called in events; None where it has no hard stop."""
    limits: tuple[str, ...]
    """What the limits are called that end a run."""
    latched: bool
    """Whether it has latched switches: the state alone does not tell which switches are on."""
    channels: tuple[str, ...]
    """What the efforts of guided coordinates are called."""
    contacts: tuple[str, ...] = ()
    """Names of the contacts, where several rub: the equations are parts then."""
    alone: bool = False
    """Whether there is but one contact, whose equations are parts all the same."""
    turning: tuple[str, ...] = ()
    """Paths of the parameters on which the change of coordinates depends, where slips are sums."""
    closing: tuple[str, ...] = ()
    """Names of the contacts whose slips follow from those of others."""
    law_switch_events: tuple[tuple[tuple[str, str] | None, ...], ...] = ()
    """What the switches of each contact's law are called in events."""

    def __hash__(self) -> int:
        """Return the hash of the text, which Python works out once: each run looks models up."""
        return hash(self.text)

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns that a run has beside its states."""
        if not self.contacts:
            return ("friction", "normal_force", *self.channels)
        kinds = ("friction", "normal_force", "mode")
        own = (self.column(kind, name) for kind in kinds for name in self.contacts)
        return (*own, *self.channels)

    def column(self, kind: str, contact: str) -> str:
        """Return the column of a contact: its name stands in it where there are several."""
        return kind if self.alone else f"{kind}:{contact}"
