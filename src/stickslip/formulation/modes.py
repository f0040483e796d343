"""The modes of one contact: what holds in each, and what ends it."""

import enum
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import symengine as se

from stickslip.formulation.linearity import load_factor
from stickslip.formulation.mechanics import Mechanics, Motion
from stickslip.formulation.prescribed_motion import own_limits
from stickslip.formulation.trace import Switchboard, Traced, expression
from stickslip.friction import FrictionLaw
from stickslip.kernels.state_layout import BREAK_BACKWARD, BREAK_FORWARD, LIFT_OFF, STOP, SWITCH

PAINLEVE = "painleve"
"""What a limit is called that every mechanism has whose normal force depends on friction."""


NEAREST = 1e-6
"""Pivot at which a run ends, 1 being that without friction: the normal force grows as its inverse,
and a run that nears 0 ends there in ever shorter steps."""


class Mode(enum.IntEnum):
    """What the contact does."""

    STICK = 0
    SLIP_FORWARD = 1
    SLIP_BACKWARD = -1
    AT_UPPER_STOP = 2
    AT_LOWER_STOP = -2


@dataclass(frozen=True)
class ModeEquations:
    """Everything the solver evaluates in one mode, as expressions."""

    rates: list[se.Expr]
    """Time derivatives of the states."""
    guards: dict[int, se.Expr]
    """What ends the mode, by guard index; not negative while the mode lasts."""
    contact: list[se.Expr]
    """Friction force, normal force, needed friction, break-away level."""
    power: list[se.Expr]
    """Power supplied, power taken by friction."""
    channels: dict[str, se.Expr]
    """What else runs tell, by name: the efforts of guided coordinates."""
    limits: dict[str, se.Expr]
    """What ends the run as it falls below 0, by the name of the event."""


@dataclass(frozen=True)
class _Context:
    mechanics: Mechanics
    law: FrictionLaw
    velocity: se.Symbol
    coordinate_rates: list[se.Symbol]
    bristles: list[se.Symbol]
    constants: frozenset[str]
    board: Switchboard

    def traced(self, value: se.Expr) -> Traced:
        return Traced(value, self.board)

    def level(self, normal: se.Expr, direction: int) -> se.Expr:
        return expression(self.law.towards(direction).break_away(self.traced(normal)))

    def varies(self, e: se.Expr) -> bool:
        return bool({str(s) for s in e.free_symbols} - self.constants)

    def limits(self, motion: Motion) -> dict[str, se.Expr]:
        """Return what the mechanism must not do, and where the equations lose their meaning."""
        reactions = {
            name: self.traced(force) for name, force in self.mechanics.reactions(motion).items()
        }
        own = own_limits(self.mechanics.mechanism, reactions)
        found = {name: expression(margin) for name, margin in own.items()}
        of_law = self.law.limits() if self.law.inputs else {}
        found |= {name: expression(margin) for name, margin in of_law.items()}
        if motion.pivot.free_symbols:
            found[PAINLEVE] = motion.pivot - NEAREST
        return found

    def channels(self, motion: Motion) -> dict[str, se.Expr]:
        """Return the efforts of guided coordinates by what they are called."""
        mechanics, reactions = self.mechanics, self.mechanics.reactions(motion)
        return {name: reactions[mechanics.coordinates[i]] for i, name in mechanics.efforts.items()}

    def lift_off(self, normal: se.Expr) -> dict[int, se.Expr]:
        """Return a guard where the normal force can change at all."""
        return {LIFT_OFF: normal} if self.varies(normal) else {}


def mode_equations(
    mechanics: Mechanics,
    law: FrictionLaw,
    *,
    coordinate_rates: Sequence[se.Symbol],
    bristles: Sequence[se.Symbol],
    constants: frozenset[str],
    board: Switchboard,
) -> Mapping[Mode, ModeEquations]:
    """Return the equations of every mode that the law has."""
    velocity = coordinate_rates[mechanics.slip]
    context = _Context(
        mechanics, law, velocity, list(coordinate_rates), list(bristles), constants, board
    )
    modes = {}
    for mode in (Mode.SLIP_FORWARD, Mode.SLIP_BACKWARD):
        board.signs = {str(velocity): int(mode)}
        modes[mode] = _with_switches(_slip(context, mode), context)
        board.signs = {}
    if law.holds:
        modes[Mode.STICK] = _with_switches(_stick(context), context)
    for wall in mechanics.walls:
        if wall.coordinate == mechanics.slip:
            board.signs = {str(velocity): wall.side}
            modes[Mode(2 * wall.side)] = _with_switches(_pressed(context, wall.side), context)
            board.signs = {}
    return modes


def _slip(context: _Context, mode: Mode) -> ModeEquations:
    law, v = context.law.towards(int(mode)), context.velocity
    load = se.Symbol("N")
    z = tuple(context.traced(symbol) for symbol in context.bristles)
    arguments = context.traced(v), context.traced(load), z
    friction = expression(law.force(*arguments))
    bristle_rates = [expression(rate) for rate in law.rates(*arguments)]
    factor = load_factor(law, friction, load)
    constant = friction.subs({load: 0})
    motion = context.mechanics.slipping(constant, factor)
    normal = motion.normal
    friction = constant + factor * normal
    rates = [
        *context.coordinate_rates,
        *motion.accelerations,
        *[rate.subs({load: normal}) for rate in bristle_rates],
    ]
    return ModeEquations(
        rates=rates,
        guards={STOP: v * int(mode), **context.lift_off(normal)},
        contact=[friction, normal, friction, context.level(normal, int(mode))],
        power=[context.mechanics.power(motion, context.coordinate_rates), friction * v],
        channels=context.channels(motion),
        limits=context.limits(motion),
    )


def _stick(context: _Context) -> ModeEquations:
    held = {context.velocity: 0}
    motion, needed = context.mechanics.sticking()
    ahead, back = (context.level(motion.normal, side) for side in (1, -1))
    rates = [
        *context.coordinate_rates,
        *motion.accelerations,
        *[se.Integer(0)] * len(context.bristles),
    ]
    parts = [e.subs(held) for e in (motion.normal, needed, ahead, back)]
    normal, needed, ahead, back = parts
    level = ahead if ahead == back else se.Piecewise((ahead, needed > 0), (back, True))
    return ModeEquations(
        rates=[e.subs(held) for e in rates],
        guards={
            BREAK_FORWARD: ahead - needed,
            BREAK_BACKWARD: back + needed,
            **context.lift_off(normal),
        },
        contact=[needed, normal, needed, level],
        power=[
            context.mechanics.power(motion, context.coordinate_rates).subs(held),
            se.Integer(0),
        ],
        channels={name: e.subs(held) for name, e in context.channels(motion).items()},
        limits={name: e.subs(held) for name, e in context.limits(motion).items()},
    )


def _pressed(context: _Context, side: int) -> ModeEquations:
    """Held by a stop: friction takes what it can of the force towards it, the stop the rest.

    What ends it is a force away from the stop that friction does not hold. Bristles without a rule
    for rest keep their deflection's force, and what it leaves of the other forces presses.
    """
    equations = _stick(context)
    friction, normal, needed, level = equations.contact
    rates, held = equations.rates, {context.velocity: 0}
    if not context.law.holds:
        z = tuple(context.traced(symbol) for symbol in context.bristles)
        arguments = context.traced(context.velocity), context.traced(normal), z
        friction = expression(context.law.force(*arguments)).subs(held)
        relaxing = [expression(rate).subs(held) for rate in context.law.rates(*arguments)]
        rates = [*rates[: len(rates) - len(z)], *relaxing]
        missing = side * (needed - friction)
    else:
        # friction resists the stop's side with the level of the other direction's slip
        leaving, holding = (context.level(normal, -side), context.level(normal, side))
        missing = leaving.subs(held) + side * needed
        taken = side * needed > holding.subs(held)
        friction = se.Piecewise((side * holding.subs(held), taken), (needed, True))
    leave = BREAK_BACKWARD if side > 0 else BREAK_FORWARD
    return replace(
        equations,
        rates=rates,
        guards={leave: missing, **context.lift_off(normal)},
        contact=[friction, normal, needed, level],
    )


def _with_switches(equations: ModeEquations, context: _Context) -> ModeEquations:
    """Add a guard for each switch that this mode's rates or guards depend on."""
    used: set[str] = set()
    guards = dict(equations.guards)
    pending = [*equations.rates, *guards.values(), *equations.limits.values()]
    while pending:
        names = {str(s) for e in pending for s in e.free_symbols} - used
        used |= names
        pending = []
        for index, switch in enumerate(context.board.switches.values()):
            if str(switch.symbol) in names:
                pending.append(switch.margin)
                if context.varies(switch.margin):
                    on = switch.symbol > 0
                    lasts = switch.margin if switch.hold is None else se.Integer(1)
                    guards[SWITCH + index] = se.Piecewise((lasts, on), (-switch.margin, True))
    return replace(equations, guards=guards)
