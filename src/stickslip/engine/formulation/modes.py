"""The equations in each mode of one contact, and those of several contacts as parts.

With M q'' = h - W F (`mechanics`) and a law F = a(v, z) + b(v, z) N, affine in the load N:

    slip, v > 0 or v < 0:  q'' from both; N from the row of the held normal coordinate, one equation
                           with the pivot 1 + (row M^-1 W) b, which is 0 in Painleve's paradox
    stick:                 q''_s = 0; the others follow; what is left of the row of s is the needed
                           friction r
    at a stop:             as stick, but friction takes what it can of the force towards the stop

What ends a mode are its guards, which fall below 0: v in the direction of slip; levels of both
directions less r and plus r; the force away from a stop that friction does not hold; N, where it
can change; and each condition `where` of law and mechanism that the rates or guards of the mode
depend on. Limits that end a run stand beside them: those that mechanism and law have, and the
pivot.

Where several contacts rub, n of them would have 3^n modes. Their equations are parts instead: mass
matrix, forces without friction, loads, how contacts slip, and each law once for each structure.
What holds in which mode is worked out by the kernels (`kernels.contacts`).
"""

import enum
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import symengine as se

from stickslip.engine.formulation import mechanics as dynamics
from stickslip.engine.formulation import trace
from stickslip.engine.formulation.slip_directions import (
    SlipDirections,
    direction_of,
    slip_directions,
)
from stickslip.engine.kernels import state_layout as layout
from stickslip.errors import InputError, TracingError, UnknownNameError
from stickslip.friction import FrictionLaw, bound
from stickslip.maths import Scalar
from stickslip.mechanisms import Contact, Mechanism, of_contact
from stickslip.quantities import parameters, shadow

# The modes of one contact: what holds in each, and what ends it.

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
    mechanics: dynamics.Mechanics
    law: FrictionLaw
    velocity: se.Symbol
    coordinate_rates: list[se.Symbol]
    bristles: list[se.Symbol]
    constants: frozenset[str]
    board: trace.Switchboard
    closed: Callable[[se.Expr], se.Expr]

    def traced(self, value: se.Expr) -> trace.Traced:
        return trace.Traced(value, self.board)

    def level(self, normal: se.Expr, direction: int) -> se.Expr:
        return trace.expression(self.law.towards(direction).break_away(self.traced(normal)))

    def varies(self, e: se.Expr) -> bool:
        return bool({str(s) for s in e.free_symbols} - self.constants)

    def limits(self, motion: dynamics.Motion) -> dict[str, se.Expr]:
        """Return what the mechanism must not do, and where the equations lose their meaning."""
        reactions = {
            name: self.traced(force) for name, force in self.mechanics.reactions(motion).items()
        }
        own = trace.own_limits(self.mechanics.mechanism, reactions)
        result = {name: trace.expression(margin) for name, margin in own.items()}
        of_law = self.law.limits() if self.law.inputs else {}
        result |= {name: trace.expression(margin) for name, margin in of_law.items()}
        if motion.pivot.free_symbols:
            result[PAINLEVE] = motion.pivot - NEAREST
        return result

    def channels(self, motion: dynamics.Motion) -> dict[str, se.Expr]:
        """Return the efforts of guided coordinates by what they are called."""
        mechanics, reactions = self.mechanics, self.mechanics.reactions(motion)
        return {name: reactions[mechanics.coordinates[i]] for i, name in mechanics.efforts.items()}

    def lift_off(self, normal: se.Expr) -> dict[int, se.Expr]:
        """Return a guard where the normal force can change at all."""
        # one that parameters alone give would cost a guard in every step and never fall
        return {layout.LIFT_OFF: normal} if self.varies(normal) else {}


def mode_equations(
    mechanics: dynamics.Mechanics,
    law: FrictionLaw,
    *,
    coordinate_rates: Sequence[se.Symbol],
    bristles: Sequence[se.Symbol],
    constants: frozenset[str],
    board: trace.Switchboard,
    closed: Callable[[se.Expr], se.Expr],
) -> Mapping[Mode, ModeEquations]:
    """Return the equations of every mode that the law has; drives may have switches too."""
    velocity = coordinate_rates[mechanics.slip]
    context = _Context(
        mechanics, law, velocity, list(coordinate_rates), list(bristles), constants, board, closed
    )
    modes = {}
    for mode in (Mode.SLIP_FORWARD, Mode.SLIP_BACKWARD):
        # the sign of the slip is known in a mode: |v| is v or -v there, without a switch
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
    # A law may differ by direction; in a mode the direction is known.
    law, v = context.law.towards(int(mode)), context.velocity
    load = se.Symbol("N")
    z = tuple(context.traced(symbol) for symbol in context.bristles)
    arguments = context.traced(v), context.traced(load), z
    friction = trace.expression(law.force(*arguments))
    bristle_rates = [trace.expression(rate) for rate in law.rates(*arguments)]
    if any(load in switch.margin.free_symbols for switch in context.board.switches.values()):
        raise TracingError(
            f"{type(law).__name__}: a switch of sliding friction must not depend on the load, which"
            " is known only after friction: let it depend on the slip velocity or on contact"
            " inputs."
        )
    factor = trace.load_factor(law, friction, load)
    constant = friction.subs({load: 0})  # laws are affine in the load, as `load_factor` checks
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
        guards={layout.STOP: v * int(mode), **context.lift_off(normal)},
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
    # a column that is shown: guards watch both directions by themselves
    level = ahead if ahead == back else se.Piecewise((ahead, needed > 0), (back, True))
    return ModeEquations(
        rates=[e.subs(held) for e in rates],
        guards={
            layout.BREAK_FORWARD: ahead - needed,
            layout.BREAK_BACKWARD: back + needed,
            **context.lift_off(normal),
        },
        contact=[needed, normal, needed, level],
        power=[
            context.mechanics.power(motion, context.coordinate_rates).subs(held),
            se.Integer(0),  # friction does no work at rest
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
    # Bristles alone hold nothing: they push as they are bent, and relax.
    if not context.law.holds:
        z = tuple(context.traced(symbol) for symbol in context.bristles)
        arguments = context.traced(context.velocity), context.traced(normal), z
        friction = trace.expression(context.law.force(*arguments)).subs(held)
        relaxing = [trace.expression(rate).subs(held) for rate in context.law.rates(*arguments)]
        rates = [*rates[: len(rates) - len(z)], *relaxing]
        missing = side * (needed - friction)
    else:
        # friction resists the stop's side with the level of the other direction's slip
        leaving, holding = (context.level(normal, -side), context.level(normal, side))
        missing = leaving.subs(held) + side * needed
        # At the stop friction takes up to its level, and the stop what is beyond.
        taken = side * needed > holding.subs(held)
        friction = se.Piecewise((side * holding.subs(held), taken), (needed, True))
    leave = layout.BREAK_BACKWARD if side > 0 else layout.BREAK_FORWARD
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
    # A margin may have switches in turn, and so have theirs: until no new symbol appears.
    pending = [*equations.rates, *guards.values(), *equations.limits.values()]
    pending = [context.closed(e) for e in pending] if context.board.switches else []
    while pending:
        names = {str(s) for e in pending for s in e.free_symbols} - used
        used |= names
        pending = []
        for index, switch in enumerate(context.board.switches.values()):
            if str(switch.symbol) in names:
                pending.append(switch.margin)
                if context.varies(switch.margin):
                    on = switch.symbol > 0
                    # While it is on, a latched switch has no guard: `deciding` tells its end.
                    lasts = switch.margin if switch.hold is None else se.Integer(1)
                    guards[layout.SWITCH + index] = se.Piecewise(
                        (lasts, on), (-switch.margin, True)
                    )
    return replace(equations, guards=guards)


# Parts of the equations of a mechanism with several contacts; no mode enters them.


@dataclass(frozen=True)
class ContactParts:
    """Equations of motion ``M q'' + W F = h`` of a mechanism, and where it rubs."""

    coordinates: tuple[str, ...]
    """Names of the moving coordinates."""
    held: tuple[str, ...]
    """Names of the held ones, those that normal forces act on first."""
    contacts: tuple[str, ...]
    """Names of the contacts that rub."""
    directions: SlipDirections
    """What each of them slips along."""
    held_slips: tuple[tuple[se.Expr, ...], ...]
    """How friction of each acts on each held coordinate."""
    held_normals: tuple[tuple[se.Expr, ...], ...]
    """How a unit of load of each acts on each held coordinate."""
    reacts: tuple[bool, ...]
    """Whether the load of each is a reaction."""
    mass: Mapping[tuple[int, int], se.Expr]
    """Entries of the lower triangle of the mass matrix, and of the rows of held coordinates."""
    forces: tuple[se.Expr, ...]
    """Forces on the moving coordinates, then on the held ones, friction left out."""
    loads: tuple[se.Expr, ...]
    """Prescribed load of each contact, 0 where it is a reaction."""
    inputs: tuple[Mapping[str, se.Expr], ...]
    """What the law of each contact asks of it, by name."""
    energy: se.Expr
    """Kinetic and potential energy [J]."""
    supplied: se.Expr
    """Power that drives, dampers, moved supports and guides put in [W]."""
    efforts: Mapping[str, se.Expr]
    """What each guided coordinate takes, by the name of its column."""
    limits: Mapping[str, se.Expr]
    """Margins of the mechanism's own limits by name."""
    walls: tuple[dynamics.Wall, ...]
    """Hard stops."""

    @property
    def closing(self) -> tuple[str, ...]:
        """Names of the contacts whose slips follow from those of others."""
        n = len(self.coordinates)
        named = zip(self.contacts, self.directions.slips, strict=True)
        return tuple(name for name, slip in named if slip >= n)


@dataclass(frozen=True)
class EffortSymbols:
    """Symbols of what follows from a state: they stand behind it where efforts are worked out."""

    accelerations: Sequence[se.Symbol]
    """Of the moving coordinates."""
    friction: Sequence[se.Symbol]
    """Of the contacts that rub."""


def derive_parts(
    mechanism: Mechanism,
    rubbing: Mapping[str, FrictionLaw],
    t: se.Symbol,
    q: Mapping[str, se.Symbol],
    q_dot: Mapping[str, se.Symbol],
    drives: Mapping[str, se.Symbol],
    motion: EffortSymbols,
    board: trace.Switchboard,
) -> ContactParts:
    """Trace the energies, forces and contacts of a mechanism whose parameters are symbols."""
    contacts = tuple(contact for contact in mechanism.contacts() if contact.name in rubbing)
    held = _held(mechanism, contacts)
    directions = slip_directions(mechanism, contacts)
    # Symbols stand for coordinates of the equations; the mechanism sees its own.
    rows = dynamics.lagrange_rows(mechanism, t, q, q_dot, drives, held, board, directions)
    places, rates = (
        dict(zip(q, directions.seen(list(symbols.values())), strict=True)) for symbols in (q, q_dot)
    )
    seen = [
        {k: trace.Traced(s, board) for k, s in given.items()} for given in (places, rates, drives)
    ]
    loads = _loads(mechanism, contacts, mechanism.loads(trace.Traced(t, board), *seen))
    informed = _informed(mechanism, rubbing, trace.Traced(t, board), *seen)
    _check_shares(mechanism, contacts, directions, held)
    # Guided coordinates and slips exclude each other: a prescribed motion leaves friction nothing
    # to do.
    guides = trace.guides_of(
        mechanism, [list(q)[i] for i in directions.slips if i < len(q)], drives
    )
    arms = [_along(direction_of(contact.slip), held) for contact in contacts]
    # What held and guided coordinates take: rows of the equations that nothing else uses.
    needs = {list(q)[i]: i for i in guides} | {name: len(q) + k for k, name in enumerate(held)}
    reactions = {name: _taken(i, rows, guides, arms, motion) for name, i in needs.items()}
    forces, mass = _guided(rows, guides)
    # A reaction that parameters alone give is a load like any other: no contact has to be solved
    # for.
    fixed = _constant_load(contacts, reactions)
    traced = {name: trace.Traced(force, board) for name, force in reactions.items()}
    limits = {**trace.own_limits(mechanism, traced), **_limits_of_laws(mechanism, informed)}
    _check_switches(mechanism, motion, board)
    guided = mechanism.guided()
    work = [reactions[name] * q_dot[name] for name in guided]
    parts = ContactParts(
        coordinates=tuple(q),
        held=held,
        contacts=tuple(contact.name for contact in contacts),
        directions=directions,
        held_slips=tuple(arms),
        held_normals=tuple(_along(direction_of(contact.normal), held) for contact in contacts),
        reacts=tuple(contact.normal is not None and fixed is None for contact in contacts),
        mass=mass,
        forces=forces,
        loads=loads if fixed is None else (fixed,),
        inputs=tuple(
            {name: trace.expression(law.contact(name)) for name in law.inputs}
            for law in (informed[contact.name] for contact in contacts)
        ),
        energy=rows.energy,
        supplied=rows.supplied + sum(work, se.Integer(0)),
        efforts={guide.effort: reactions[name] for name, guide in guided.items()},
        limits={name: trace.expression(margin) for name, margin in limits.items()},
        walls=dynamics.derive_walls(mechanism, q),
    )
    _check_loops(mechanism, parts)
    _check_stops(mechanism, parts)
    return parts


def _constant_load(contacts: Sequence[Contact], reactions: Mapping[str, se.Expr]) -> se.Expr | None:
    """Return the reaction of the only contact where parameters alone give it, which is a load."""
    if len(contacts) != 1 or not isinstance(contacts[0].normal, str):
        return None
    reaction = se.expand(reactions[contacts[0].normal])
    constant = all(str(symbol).startswith("p") for symbol in reaction.free_symbols)
    return reaction if constant else None


def _check_switches(mechanism: Mechanism, motion: EffortSymbols, board: trace.Switchboard) -> None:
    """Refuse switches that latch, and limits that switch with a force, as its size does."""
    behind = {str(symbol) for symbol in (*motion.accelerations, *motion.friction)}
    for switch in board.switches.values():
        if switch.hold is not None:
            raise InputError(
                f"{type(mechanism).__name__} has a latched switch of its own, with which mechanisms"
                " of several contacts are not formulated: use stickslip.maths.where."
            )
        if behind & {str(symbol) for symbol in switch.margin.free_symbols}:
            raise InputError(
                f"{type(mechanism).__name__} has several contacts, with which its limits may not"
                " switch with a force by abs or where: give a limit for each sign of the force."
            )


def _taken(
    row: int,
    rows: dynamics.Rows,
    guides: Mapping[int, se.Expr],
    arms: Sequence[Sequence[se.Expr]],
    motion: EffortSymbols,
) -> se.Expr:
    """Return the force that a guided or held coordinate needs beside those of the equations."""
    total = -rows.forces[row]  # M a - h, with the accelerations that guided coordinates are told
    for j, entry in enumerate(rows.mass[row]):
        total += entry * guides.get(j, motion.accelerations[j])
    held = row - len(rows.mass[row])  # rows behind the moving ones are of held coordinates
    if held >= 0:
        for arm, friction in zip(arms, motion.friction, strict=True):
            total += arm[held] * friction
    return total


def _guided(
    rows: dynamics.Rows, guides: Mapping[int, se.Expr]
) -> tuple[tuple[se.Expr, ...], dict[tuple[int, int], se.Expr]]:
    """Return forces and mass matrix with what guided coordinates do put on the side of the forces.

    Each of these has an equation of its own then, of which its acceleration is the solution.
    """
    forces, mass = list(rows.forces), {}
    for i, row in enumerate(rows.mass):
        for j, entry in enumerate(row):
            if entry == 0:
                continue
            if j in guides and i != j:
                forces[i] -= entry * guides[j]
            elif i not in guides and (i >= len(row) or j <= i):
                mass[i, j] = entry
    # Any inertia will do: nothing couples to the row any more, and its own keeps numbers of one
    # size.
    for i, acceleration in guides.items():
        mass[i, i] = se.Integer(1) if rows.mass[i][i] == 0 else rows.mass[i][i]
        forces[i] = mass[i, i] * acceleration
    return tuple(forces), mass


def _along(table: Mapping[str, se.Expr], held: Sequence[str]) -> tuple[se.Expr, ...]:
    return tuple(table.get(name, se.Integer(0)) for name in held)


def _held(mechanism: Mechanism, contacts: Sequence[Contact]) -> tuple[str, ...]:
    """Return the held coordinates, those that normal forces act on first."""
    normals = dict.fromkeys(name for contact in contacts for name in direction_of(contact.normal))
    others = [name for name in mechanism.held() if name not in normals]
    owner = type(mechanism).__name__
    for name in (*normals, *others):
        if name in mechanism.coordinates:
            raise InputError(
                f"{owner} holds {name!r} at 0, but that coordinate moves: give held coordinates"
                " names of their own."
            )
    reacting = [contact.name for contact in contacts if contact.normal is not None]
    idle = [
        contact.name
        for contact in mechanism.contacts()
        if contact.normal is not None and contact.name not in reacting
    ]
    if idle:  # its reaction holds a coordinate, and has to be watched for lift-off
        raise InputError(
            f"{owner}: {', '.join(idle)} has no law but carries load: give it a law with levels of"
            " 0, such as Coulomb(kinetic_coefficient=0.0), where nothing rubs."
        )
    if len(reacting) != len(normals):
        raise InputError(
            f"{owner}: the loads of {', '.join(reacting)} are not determined by the"
            f" {len(normals)} held coordinates {', '.join(normals)}: give one of them a load, or"
            " let a support give way."
        )
    return (*normals, *others)


def _check_shares(
    mechanism: Mechanism,
    contacts: Sequence[Contact],
    directions: SlipDirections,
    held: Sequence[str],
) -> None:
    """Refuse reactions that depend on how contacts of one coordinate share what holds it."""
    # Prescribed loads do not depend on how friction is shared.
    if all(contact.normal is None for contact in contacts):
        return
    known: dict[int, tuple[str, list[se.Expr]]] = {}
    for contact, index, factor in zip(contacts, directions.slips, directions.factors, strict=True):
        arms = [se.expand(e / factor) for e in _along(direction_of(contact.slip), held)]
        other, expected = known.setdefault(index, (contact.name, arms))
        if arms != expected:
            raise InputError(
                f"{type(mechanism).__name__}: the contacts {other!r} and {contact.name!r} slip"
                " along one coordinate but act differently on the held ones, so that the loads"
                " depend on how they share friction while they stick: let them slip at the same"
                " height."
            )


def _check_loops(mechanism: Mechanism, parts: ContactParts) -> None:
    """Refuse what loops of contacts are not combined with."""
    if not parts.directions.loops.closing:
        return
    names = ", ".join(parts.closing)
    what = ""
    if any(parts.reacts):
        what = "loads that are reactions, which would depend on how forces are shared: give loads"
    elif parts.walls:
        what = "hard stops: let springs stiffen in their place"
    if what:
        raise InputError(
            f"{type(mechanism).__name__}: the slips of {names} follow from those of others. Such"
            f" loops of contacts are not combined with {what}, or give {names} no law (None)."
        )


def _check_stops(mechanism: Mechanism, parts: ContactParts) -> None:
    """Refuse stops that carry a part of what friction holds, where that presses on a contact."""
    stopped = {wall.coordinate for wall in parts.walls}
    for name, index, arms in zip(
        parts.contacts, parts.directions.slips, parts.held_slips, strict=True
    ):
        if any(parts.reacts) and index in stopped and any(arm != 0 for arm in arms):
            raise InputError(
                f"{type(mechanism).__name__}: the coordinate {parts.coordinates[index]!r} has a"
                f" hard stop, and friction of the contact {name!r} along it acts on held"
                " coordinates, so that the loads depend on how stop and friction share a force:"
                " give the contacts loads, or leave out the stop."
            )


def _informed(
    mechanism: Mechanism,
    rubbing: Mapping[str, FrictionLaw],
    t: trace.Traced,
    *motion: Mapping[str, trace.Traced],
) -> Mapping[str, FrictionLaw]:
    """Return laws that see what the mechanism tells of their contacts."""
    if not any(law.inputs for law in rubbing.values()):
        return rubbing
    inputs = mechanism.contact_inputs(t, *motion)
    return {name: bound(law, of_contact(inputs, name)) for name, law in rubbing.items()}


def _limits_of_laws(mechanism: Mechanism, laws: Mapping[str, FrictionLaw]) -> dict[str, Scalar]:
    """Return what ends a run because a law has no meaning beyond it, with the contact's name."""
    alone = len(mechanism.contacts()) == 1
    return {
        limit if alone else f"{contact}: {limit}": margin
        for contact, law in laws.items()
        for limit, margin in (law.limits() if law.inputs else {}).items()
    }


def _loads(
    mechanism: Mechanism, contacts: Sequence[Contact], given: Mapping[str, Scalar]
) -> tuple[se.Expr, ...]:
    """Return the prescribed loads, 0 where a load is a reaction."""
    known = [contact.name for contact in mechanism.contacts()]
    for name in given:
        if name not in known:
            raise UnknownNameError(f"contact in {type(mechanism).__name__}.loads", name, known)
    result = []
    for contact in contacts:
        prescribed = given.get(contact.name, contact.load)
        if contact.normal is not None and prescribed is not None:
            raise InputError(
                f"{type(mechanism).__name__}: the load of the contact {contact.name!r} is the"
                " reaction of its normal coordinate and cannot be prescribed too."
            )
        if contact.normal is None and prescribed is None:
            raise InputError(
                f"{type(mechanism).__name__}: the contact {contact.name!r} has neither a normal"
                " coordinate nor a load: give one of them."
            )
        result.append(se.Integer(0) if contact.normal is not None else trace.expression(prescribed))
    return tuple(result)


@dataclass(frozen=True)
class LawParts:
    """What kernels ask of a law of one structure, by direction of slip."""

    numbers: Mapping[int, Sequence[se.Expr]]
    """As `kernels.contacts.assembly.ask_law` writes them."""
    slopes: Mapping[int, Sequence[se.Expr]]
    """Derivatives of constant and factor of friction and level, and of the rates of bristles, with
    respect to speed, parameters, contact inputs, bristles and load: a row each."""
    margins: Sequence[se.Expr]
    """Margins of its switches."""
    margin_slopes: Sequence[se.Expr]
    """Their derivatives with respect to the same."""
    switch_events: tuple[tuple[str, str] | None, ...]
    """What each switch is called in events, when it comes true and when it ceases to hold."""
    latched: bool
    """Whether a switch is latched."""
    switched_by_load: bool
    """Whether a margin changes with the load."""

    @property
    def is_linear(self) -> bool:
        """Whether friction is affine in the speed, and no switch changes how."""
        return not self.margins and all(case[6] == 1 for case in self.numbers.values())

    @property
    def may_dampen(self) -> bool:
        """Whether friction changes with the speed, or there are bristles, so that it may be stiff.

        Both are seen at the slopes of friction along the speed and at the rates of bristles.
        """
        cases = self.numbers.values()
        return any(case[4] != 0 or case[5] != 0 or len(case) > layout.LAW_NUMBERS for case in cases)


def law_parts(law: FrictionLaw, bristles: int) -> LawParts:
    """Trace a law: y0 is the slip speed, then come parameters, contact inputs, bristles and load.

    These are the variables along which slopes are taken, in this order.
    """
    board = trace.Switchboard()
    paths = [path for path, _, _ in parameters(law, "friction")]
    place = {path: i + 1 for i, path in enumerate(paths)}
    # Parameters are variables as the speed is: slopes are taken along all of them.
    twin = shadow(law, "friction", lambda path: trace.Traced(se.Symbol(f"y{place[path]}"), board))
    speed, load = se.Symbol("y0"), se.Symbol("N")
    variables = [
        speed,
        *(se.Symbol(f"y{1 + k}") for k in range(len(paths) + len(law.inputs) + bristles + 1)),
    ]
    own_load, states = variables[-1], variables[-1 - bristles : -1]
    inputs = variables[1 + len(paths) :]
    twin = bound(
        twin,
        {name: trace.Traced(item, board) for name, item in zip(law.inputs, inputs, strict=False)},
    )
    numbers, slopes = {}, {}
    # Both directions, with the speed along the slip positive in each.
    for side in (1, -1):
        member = twin.towards(side)
        # y0 is the speed along the direction: above 0 in slip, so that |v| needs no switch.
        board.signs = {"y0": 1}
        arguments = (
            trace.Traced(side * speed, board),
            trace.Traced(load, board),
            tuple(trace.Traced(z, board) for z in states),
        )
        friction = side * trace.expression(
            member.force(*arguments)
        )  # back to the direction of the slip
        rates = [trace.expression(rate) for rate in member.rates(*arguments)]
        board.signs = {}
        level = trace.expression(member.break_away(trace.Traced(load, board)))
        factor, level_factor = (trace.load_factor(law, part, load) for part in (friction, level))
        constant, level_constant = friction.subs({load: 0}), level.subs({load: 0})
        flags = [switch.symbol for switch in board.switches.values()]
        linear = trace.linear_where([constant, factor], [speed], flags)
        # Series take a constant damping: neither bristles, nor damping that goes with the load.
        if rates or se.expand(trace.collapsed(factor.diff(speed))) != 0:
            linear = se.Integer(0)
        numbers[side] = [
            constant,
            factor,
            level_constant,
            level_factor,
            trace.collapsed(constant.diff(speed)),
            trace.collapsed(factor.diff(speed)),
            linear,
            *[rate.subs({load: own_load}) for rate in rates],
        ]
        case = [*numbers[side][:4], *numbers[side][layout.LAW_NUMBERS :]]
        slopes[side] = [e.diff(x) for e in case for x in variables]
    margins = []
    for switch in board.switches.values():
        if switch.hold is None:
            margins.append(switch.margin.subs({load: own_load}))
            continue
        # With the margins of other switches in it: while these settle, none must make it latch.
        lasts = se.Piecewise(
            (se.Integer(1), switch.symbol > 0), (board.settled(switch.margin), True)
        )
        margins.append(lasts.subs({load: own_load}))
        # kernels let the switches of a direction begin anew where slip turns or stops
        if switch.hold.subs({speed: 0}) != 0:
            raise InputError(
                f"{law.name} has a latched switch that outlasts slip, with which the equations of"
                " several contacts are not formulated: let hold be 0 where the slip velocity is."
            )
    return LawParts(
        numbers=numbers,
        slopes=slopes,
        margins=margins,
        margin_slopes=[e.diff(x) for e in margins for x in variables],
        switch_events=tuple(switch.events for switch in board.switches.values()),
        latched=any(switch.hold is not None for switch in board.switches.values()),
        switched_by_load=any(own_load in e.free_symbols for e in margins),
    )
