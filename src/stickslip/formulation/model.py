"""A law and a mechanism joined: the text of their equations, and what its numbers mean."""

from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from threading import RLock

import symengine as se

from stickslip.formulation.contact_model import contact_model
from stickslip.formulation.infix import Case, Cases, program
from stickslip.formulation.linearity import linear_where, waves_of
from stickslip.formulation.mechanics import Mechanics, derive_mechanics, impact_events, wall_guards
from stickslip.formulation.model_type import Model
from stickslip.formulation.modes import PAINLEVE, Mode, ModeEquations, mode_equations
from stickslip.formulation.trace import Switchboard, Symbols, Traced, symbols_of
from stickslip.friction import FrictionLaw, Laws, bound
from stickslip.kernels.header import ModeSizes
from stickslip.kernels.state_layout import LIFT_OFF, SWITCH
from stickslip.mechanisms import Mechanism, of_contact, refuse_sampling, stops_of
from stickslip.quantities import parameters, shadow, structure

_MODELS: OrderedDict[Hashable, Model] = OrderedDict()
"""Models by the structure of their mechanism and law, those last asked for at the end."""
MOST_MODELS = 256
_LOCK = RLock()
"""Held while these are looked up: equations are traced by one of several threads."""


def formulate(mechanism: Mechanism, law: FrictionLaw | Laws, *, slopes: bool = False) -> Model:
    """Trace a law and a mechanism and derive what the solver needs.

    Equations of the same structure are traced once in a process. With `slopes` the text has the
    derivatives with respect to parameters too.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> model = formulate(SpringBlock(mass=1.0), Coulomb(kinetic_coefficient=0.2))
    >>> model.states
    ('x', 'v')
    """
    key = structure(mechanism), structure(law), slopes
    with _LOCK:
        try:
            model = _MODELS.get(key)
        except TypeError:  # a field of the user's that cannot be looked up
            return _formulated(mechanism, law, slopes)
        if model is not None:
            _MODELS.move_to_end(key)
            return model
        model = _MODELS[key] = _formulated(mechanism, law, slopes)
        while len(_MODELS) > MOST_MODELS:
            _MODELS.popitem(last=False)
        return model


def _is_of_parts(mechanism: Mechanism, law: FrictionLaw | Laws) -> bool:
    """Whether the equations are parts, as those of several contacts are."""
    contacts = mechanism.contacts()
    if isinstance(law, Laws) or len(contacts) > 1:
        return True
    if any(isinstance(way, Mapping) for one in contacts for way in (one.slip, one.normal)):
        return True
    # what does not slip may rest at a stop too, beside whatever the contact does
    inside = any(stop.coordinate not in contacts[0].slips for stop in stops_of(mechanism))
    return inside or type(mechanism).loads is not Mechanism.loads


def _formulated(mechanism: Mechanism, law: FrictionLaw | Laws, slopes: bool) -> Model:
    """Trace and derive; write the text."""
    refuse_sampling(mechanism)
    if _is_of_parts(mechanism, law):
        return contact_model(mechanism, law, slopes=slopes)
    assert isinstance(law, FrictionLaw)  # laws by contact are of parts
    board, index = Switchboard(), _places(mechanism, law)
    symbols, mechanics, modes = _derived(mechanism, law, index, board)
    quantities = _quantities(symbols, index.values()) if slopes else []
    switches = list(board.switches.values())
    functions = _functions(symbols, mechanics, modes, board, quantities)
    first = 4 * len(symbols.drives) + 1 + len(index)
    text, constants = program(functions, index.values(), first)
    sizes = _sizes(symbols, mechanics, modes, len(switches), len(index), constants)
    if "waves" in functions:
        sizes = replace(sizes, waves=sizes.states + sizes.guards)
    return Model(
        title=f"{type(mechanism).__name__} with {type(law).__name__}",
        sizes=sizes,
        text=text,
        states=(*mechanism.coordinates, *mechanism.rates, *law.states),
        parameter_paths=tuple(index),
        places=tuple(sizes.first_parameter + i for i in range(len(index))),
        drives=tuple(symbols.drives),
        has_slopes=slopes,
        switch_events=tuple(switch.events for switch in board.switches.values()),
        impact_events=impact_events(mechanics.walls, mechanism.coordinates, mechanics.slip),
        limits=_limits(modes),
        latched=any(switch.hold is not None for switch in switches),
        channels=tuple(mechanics.efforts.values()),
    )


def _derived(
    mechanism: Mechanism, law: FrictionLaw, index: Mapping[str, int], board: Switchboard
) -> tuple[Symbols, Mechanics, Mapping[Mode, ModeEquations]]:
    """Return symbols, equations of motion, and what holds in each mode."""

    def symbol(path: str) -> Traced:
        return Traced(se.Symbol(f"p{index[path]}"), board)

    twin = shadow(mechanism, "mechanism", symbol)
    constants = frozenset(f"p{i}" for i in index.values())
    symbols = symbols_of(twin, len(law.states), constants, board)
    mechanics = derive_mechanics(
        twin,
        symbols.t,
        dict(zip(mechanism.coordinates, symbols.coordinates, strict=True)),
        dict(zip(mechanism.coordinates, symbols.rates, strict=True)),
        symbols.drives,
        board,
    )
    modes = mode_equations(
        mechanics,
        _informed(shadow(law, "friction", symbol), twin, symbols, board),
        coordinate_rates=symbols.rates,
        bristles=symbols.bristles,
        constants=symbols.constants,
        board=board,
    )
    return symbols, mechanics, modes


def _informed(
    law: FrictionLaw, mechanism: Mechanism, symbols: Symbols, board: Switchboard
) -> FrictionLaw:
    """Return a law that sees what the mechanism tells of its contact."""
    if not law.inputs:
        return law

    def traced(names: Iterable[str], values: Iterable[se.Expr]) -> dict[str, Traced]:
        return {name: Traced(one, board) for name, one in zip(names, values, strict=True)}

    told = mechanism.contact_inputs(
        Traced(symbols.t, board),
        traced(mechanism.coordinates, symbols.coordinates),
        traced(mechanism.coordinates, symbols.rates),
        traced(symbols.drives, symbols.drives.values()),
    )
    (contact,) = mechanism.contacts()
    return bound(law, of_contact(told, contact.name))


def _places(mechanism: Mechanism, law: FrictionLaw) -> dict[str, int]:
    """Return the place of each parameter in the vector of a run.

    Value, slope and start of each drive come before them, and what may be given in their place.
    """
    first = 4 * len(mechanism.drives()) + 1
    roots = ((mechanism, "mechanism"), (law, "friction"))
    paths = [path for root, prefix in roots for path, _, _ in parameters(root, prefix)]
    return {path: first + i for i, path in enumerate(paths)}


def _functions(
    symbols: Symbols,
    mechanics: Mechanics,
    modes: Mapping[Mode, ModeEquations],
    board: Switchboard,
    quantities: list[se.Symbol],
) -> dict[str, Cases]:
    """Return the module's own part: what the kernels find under these names."""
    y, t, closed = symbols.states, symbols.t, symbols.closed
    switches = list(board.switches.values())
    rates = {mode: [closed(e) for e in equations.rates] for mode, equations in modes.items()}
    guards = _guards(mechanics, modes, len(switches), closed)
    flags = [switch.symbol for switch in switches]
    margins = [closed(board.deciding(s)) for s in switches]

    waves = waves_of([e for mode in modes for e in (*rates[mode], *guards[mode])], t, y)
    linear = {
        mode: linear_where(
            [waves.replaced(e) for e in (*rates[mode], *guards[mode])],
            [*y, t, *waves.symbols.values()],
            flags,
        )
        for mode in modes
    }

    def each(part: Callable[[Mode], Case]) -> Cases:
        return {int(mode): part(mode) for mode in modes}

    def same(case: Case) -> Cases:
        return {None: case}

    parts = {
        "field": each(lambda m: rates[m]),
        "jacobian": each(lambda m: _slopes(rates[m], y)),
        "time_slope": each(lambda m: [e.diff(t) for e in rates[m]]),
        "guards": each(lambda m: guards[m]),
        "guard_slopes": each(lambda m: _slopes(guards[m], [*y, t])),
        "linear": each(lambda m: [linear[m]]),
        "contact": each(lambda m: [closed(e) for e in _contact(modes[m])]),
        "power": each(lambda m: [closed(e) for e in modes[m].power]),
        "energy": same([mechanics.energy]),
        "margins": same(margins),
        "diagram": same(_diagram(symbols, mechanics, closed)),
        "rest": same(_rest(symbols, modes)),
        "walls": same(mechanics.wall_rows()),
    }
    if waves.symbols and any(linear.values()):
        terms = {m: [waves.term(e) for e in (*rates[m], *guards[m])] for m in modes}
        parts["waves"] = each(
            lambda m: (
                [*terms[m], *[e.diff(t) for e in terms[m]], waves.square]
                if linear[m] != 0
                else [se.Integer(0)] * (2 * len(terms[m]) + 1)
            )
        )
    if quantities:
        parts["field_slopes"] = each(lambda m: _slopes(rates[m], quantities))
        parts["guard_parameters"] = each(lambda m: _slopes(guards[m], quantities))
    if quantities and mechanics.walls:
        impacts = dict(enumerate(mechanics.rates_after(symbols.rates)))
        parts["impact"] = impacts
        parts["impact_slopes"] = {k: _slopes(after, y) for k, after in impacts.items()}
        parts["impact_parameters"] = {k: _slopes(a, quantities) for k, a in impacts.items()}
    return parts


def _guards(
    mechanics: Mechanics,
    modes: Mapping[Mode, ModeEquations],
    switches: int,
    closed: Callable[[se.Expr], se.Expr],
) -> dict[Mode, list[se.Expr]]:
    """Return the guards of each mode in the order of their indices, the walls' last."""
    limits = _limits(modes)
    return {
        mode: [closed(equations.guards.get(i, se.Integer(0))) for i in range(SWITCH + switches)]
        + [closed(equations.limits.get(name, se.Integer(0))) for name in limits]
        + wall_guards(mechanics.walls, int(mode))
        for mode, equations in modes.items()
    }


def _limits(modes: Mapping[Mode, ModeEquations]) -> tuple[str, ...]:
    """Return the names of all limits that any mode has, that of the equations' meaning first."""
    names = dict.fromkeys(name for equations in modes.values() for name in equations.limits)
    return tuple(sorted(names, key=lambda name: name != PAINLEVE))


def _contact(equations: ModeEquations) -> list[se.Expr]:
    """Return what `contact` gives: forces at the contact, then the channels."""
    return [*equations.contact, *equations.channels.values()]


def _quantities(symbols: Symbols, parameters: Iterable[int]) -> list[se.Symbol]:
    """Return all numbers that equations read: those of the drives, then the parameters."""
    return [se.Symbol(f"p{place}") for place in (*range(3 * len(symbols.drives)), *parameters)]


def _slopes(expressions: Sequence[se.Expr], symbols: Sequence[se.Symbol]) -> Case:
    """Return the derivatives of each expression with respect to each symbol."""
    return [e.diff(symbol) for e in expressions for symbol in symbols]


def _sizes(
    symbols: Symbols,
    mechanics: Mechanics,
    modes: Mapping[Mode, ModeEquations],
    switches: int,
    parameters: int,
    constants: int,
) -> ModeSizes:
    return ModeSizes(
        coordinates=len(symbols.coordinates),
        bristles=len(symbols.bristles),
        slip=len(symbols.coordinates) + mechanics.slip,
        switches=switches,
        limits=len(_limits(modes)),
        channels=len(mechanics.efforts),
        drives=len(symbols.drives),
        parameters=parameters,
        constants=constants,
        waves=0,
        walls=tuple((wall.coordinate, wall.side) for wall in mechanics.walls),
        can_stick=Mode.STICK in modes,
        can_lift=any(LIFT_OFF in equations.guards for equations in modes.values()),
        rest_is_final=_rest_is_final(symbols, modes),
    )


def _diagram(
    symbols: Symbols, mechanics: Mechanics, closed: Callable[[se.Expr], se.Expr]
) -> list[se.Expr]:
    """Return accelerations, normal force, needed friction and power for a given friction force."""
    friction = se.Symbol(f"p{3 * len(symbols.drives)}")
    motion = mechanics.slipping(friction, se.Integer(0))
    _, needed = mechanics.sticking()
    supplied = mechanics.power(motion, symbols.rates)
    return [closed(e) for e in (*motion.accelerations, motion.normal, needed, supplied)]


def _rest(symbols: Symbols, modes: Mapping[Mode, ModeEquations]) -> list[se.Expr]:
    """Return needed friction, break-away level and normal force for given drive values."""
    if Mode.STICK not in modes:
        return [se.Integer(0)] * 3
    _, normal, needed, level = modes[Mode.STICK].contact
    return [e.subs(symbols.given) for e in (needed, level, normal)]


def _rest_is_final(symbols: Symbols, modes: Mapping[Mode, ModeEquations]) -> bool:
    """Whether a held body can only be moved by its drives: nothing else changes in time."""
    if Mode.STICK not in modes:
        return False
    stick = modes[Mode.STICK]
    still = all(rate == 0 for rate in stick.rates)
    timed = any(symbols.t in e.free_symbols for e in [*stick.guards.values(), *stick.contact])
    return still and not timed
