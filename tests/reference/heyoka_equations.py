"""The equations of a mechanism with a law, traced straight into expressions of heyoka.

Nothing but the text of laws and mechanisms is shared with the package: Lagrange's equations are
heyoka's, and friction and normal force solve two linear equations. One set of equations serves
every mode: the mode, the sides of the switches and the piece of the drives are numbers in them.
"""

import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import heyoka as hy

from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.quantities import shadow

ZERO = hy.expression(0.0)


@dataclass
class Switch:
    """A condition that `where` put into the equations: it holds while its margin is positive."""

    margin: hy.expression
    side: str
    """Name of the number that is 1 where it holds and -1 where it does not."""
    events: tuple[str, str] | None


@dataclass
class Tracing:
    """What symbols share: the numbers handed out, the signs known, the switches met."""

    numbers: dict[str, int] = field(default_factory=dict)
    signs: dict[hy.expression, hy.expression] = field(default_factory=dict)
    switches: dict[str, Switch] = field(default_factory=dict)

    def number(self, name: str) -> hy.expression:
        """Return the parameter of the integrator that has this name."""
        return hy.par[self.numbers.setdefault(name, len(self.numbers))]

    def sign(self, margin: hy.expression, events: tuple[str, str] | None = None) -> hy.expression:
        """Return the sign of an expression: that of the mode, or the side of a switch."""
        if margin in self.signs:
            return self.signs[margin]
        switch = self.switches.setdefault(
            str(margin), Switch(margin, f"side {len(self.switches)}", events)
        )
        return self.number(switch.side)


def plain(value: Any) -> hy.expression:
    """Return the expression of a symbol or a number."""
    return value.expr if isinstance(value, Symbol) else hy.expression(float(value))


def _binary(operation: Callable[[Any, Any], Any]) -> tuple[Callable, Callable]:
    def forward(self: "Symbol", other: Any) -> "Symbol":
        return Symbol(operation(self.expr, plain(other)), self.tracing)

    def backward(self: "Symbol", other: Any) -> "Symbol":
        return Symbol(operation(plain(other), self.expr), self.tracing)

    return forward, backward


@dataclass(frozen=True, eq=False)
class Symbol:
    """An expression of heyoka that laws and mechanisms can calculate with."""

    expr: hy.expression
    tracing: Tracing

    __array_ufunc__ = None  # NumPy leaves mixed operations to us
    __add__, __radd__ = _binary(operator.add)
    __sub__, __rsub__ = _binary(operator.sub)
    __mul__, __rmul__ = _binary(operator.mul)
    __truediv__, __rtruediv__ = _binary(operator.truediv)
    __pow__ = _binary(operator.pow)[0]
    __gt__, __lt__ = _binary(operator.sub)
    __ge__, __le__ = __gt__, __lt__

    def __neg__(self) -> "Symbol":
        return Symbol(-self.expr, self.tracing)

    def __pos__(self) -> "Symbol":
        return self

    def __abs__(self) -> "Symbol":
        return Symbol(self.tracing.sign(self.expr) * self.expr, self.tracing)

    def __maths__(self, name: str, *arguments: Any) -> "Symbol":
        if name == "where":  # a comparison is the symbol of its margin
            yes, no, events = arguments
            side = self.tracing.sign(self.expr, events)
            chosen = 0.5 * (1.0 + side) * plain(yes) + 0.5 * (1.0 - side) * plain(no)
            return Symbol(chosen, self.tracing)
        if name == "sign":
            return Symbol(self.tracing.sign(self.expr), self.tracing)
        if name == "power":
            base, exponent = arguments
            return Symbol(plain(base) ** plain(exponent), self.tracing)
        return Symbol(getattr(hy, name)(self.expr), self.tracing)


@dataclass(frozen=True, kw_only=True)
class Equations:
    """The equations of all modes at once, and the names of the numbers in them."""

    rates: list[tuple[hy.expression, hy.expression]]
    """States and their time derivatives."""
    slip: int
    """Index of the slip velocity among the states."""
    friction: hy.expression
    """Friction force; while stuck the one that is needed."""
    normal: hy.expression
    levels: tuple[hy.expression, hy.expression]
    """Largest friction force at rest, against forward and against backward slip."""
    numbers: Mapping[str, int]
    switches: list[Switch]


def equations(mechanism: Mechanism, law: FrictionLaw) -> Equations:
    """Trace a mechanism and a law and derive their equations."""
    tracing = Tracing()

    def symbol(path: str) -> Symbol:
        return Symbol(tracing.number(path), tracing)

    twin = shadow(mechanism, "mechanism", symbol)
    friction_twin = shadow(law, "friction", symbol)
    (contact,) = twin.contacts()
    held = () if contact.normal is None else (contact.normal,)
    names = [*twin.coordinates, *held]
    q = {name: hy.make_vars(f"q_{name}") for name in names}
    q_dot = {name: hy.make_vars(f"v_{name}") for name in names}
    v, forward = q_dot[contact.slip], tracing.number("direction")
    tracing.signs.update({v: forward, -v: -forward, forward * v: hy.expression(1.0)})

    F, N, stuck = (tracing.number(name) for name in ("F", "N", "stuck"))
    acceleration = _accelerations(twin, q, q_dot, tracing)
    z = [hy.make_vars(name) for name in law.states]
    sliding, z_dot = _friction(friction_twin, v, z, N, tracing)
    press = acceleration[contact.normal] if held else N - plain(contact.load)
    rub = stuck * acceleration[contact.slip] + (1.0 - stuck) * (F - sliding)
    solved = _solved(press, rub, N, F)
    ahead, back = (
        hy.subs(plain(friction_twin.towards(side).break_away(Symbol(N, tracing))), solved)
        for side in (1, -1)
    )

    moving = {name: hy.subs(acceleration[name], solved) for name in twin.coordinates}
    moving[contact.slip] = (1.0 - stuck) * moving[contact.slip]
    return Equations(
        rates=[
            *[(q[name], q_dot[name]) for name in moving],
            *[(q_dot[name], rate) for name, rate in moving.items()],
            *[(s, (1.0 - stuck) * hy.subs(r, solved)) for s, r in zip(z, z_dot, strict=True)],
        ],
        slip=len(moving) + list(moving).index(contact.slip),
        friction=solved[F],
        normal=solved[N],
        levels=(ahead, back),
        numbers=tracing.numbers,
        switches=list(tracing.switches.values()),
    )


def _accelerations(
    twin: Mechanism,
    q: Mapping[str, hy.expression],
    q_dot: Mapping[str, hy.expression],
    tracing: Tracing,
) -> dict[str, hy.expression]:
    """Return accelerations under the still unknown friction F and normal force N."""
    (contact,) = twin.contacts()
    time = Symbol(hy.time, tracing)
    places, speeds = ({name: Symbol(e, tracing) for name, e in part.items()} for part in (q, q_dot))
    drives = {
        name: Symbol(tracing.number(f"{name} value"), tracing)
        + Symbol(tracing.number(f"{name} slope"), tracing)
        * (time - Symbol(tracing.number(f"{name} start"), tracing))
        + drive.smooth(time)
        for name, drive in twin.drives().items()
    }
    forces = twin.forces(time, places, speeds, drives)
    lagrangian = plain(twin.kinetic_energy(places, speeds)) - plain(
        twin.potential_energy(time, places)
    )
    if contact.normal is not None:
        lagrangian += tracing.number("N") * q[contact.normal]
    # heyoka takes forces as the derivative of a function of the rates, so they are put in later
    given = {tracing.number(f"force {name}"): plain(force) for name, force in forces.items()}
    power = tracing.number("F") * q_dot[contact.slip] - sum(
        (tracing.number(f"force {name}") * q_dot[name] for name in forces), ZERO
    )
    rates = hy.lagrangian(lagrangian, list(q.values()), list(q_dot.values()), power)
    held = {e: ZERO for part in (q, q_dot) for name, e in part.items() if name == contact.normal}
    return {
        name: hy.subs(hy.subs(rate, given), held)
        for name, (_, rate) in zip(q, rates[len(q) :], strict=True)
    }


def _friction(
    law: FrictionLaw, v: hy.expression, z: list[hy.expression], N: hy.expression, tracing: Tracing
) -> tuple[hy.expression, list[hy.expression]]:
    """Return the friction of a slipping contact and the rates of the bristles."""
    velocity, load = Symbol(v, tracing), Symbol(N, tracing)
    if not law.states:
        forward = tracing.number("direction")
        speed = Symbol(forward * v, tracing)
        ahead, back = (plain(law.towards(side).sliding(speed, load)) for side in (1, -1))
        chosen = 0.5 * (1.0 + forward) * ahead + 0.5 * (1.0 - forward) * back
        return forward * (chosen if law.directional else ahead), []
    bristles = tuple(Symbol(e, tracing) for e in z)
    rates = law.rates(velocity, load, bristles)
    return plain(law.force(velocity, load, bristles)), [plain(rate) for rate in rates]


def _solved(
    press: hy.expression, rub: hy.expression, N: hy.expression, F: hy.expression
) -> dict[hy.expression, hy.expression]:
    """Return N and F that make both expressions, which are linear in them, zero."""
    (a, b, e), (c, d, f) = (
        (hy.diff(row, N), hy.diff(row, F), -hy.subs(row, {N: ZERO, F: ZERO}))
        for row in (press, rub)
    )
    pivot = a * d - b * c
    return {N: (e * d - b * f) / pivot, F: (a * f - e * c) / pivot}
