"""A law and a mechanism joined: the text of their equations, and what its numbers mean."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import symengine as se

from stickslip.formulation.emit import Case, function
from stickslip.formulation.mechanics import Mechanics, derive_mechanics
from stickslip.formulation.modes import Mode, ModeEquations, mode_equations
from stickslip.formulation.trace import Switch, Switchboard, Traced, expression
from stickslip.friction import BristleLaw, FrictionLaw
from stickslip.kernels.codes import SWITCH
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, shadow

__all__ = ["Model", "formulate"]


@dataclass(frozen=True, kw_only=True)
class Model:
    """The equations of a mechanism with a law, ready to be run, and the meaning of each number."""

    text: str
    """Program text: constants and the functions that the kernels call."""
    states: tuple[str, ...]
    """Names of the states, coordinates before rates before bristles."""
    parameter_paths: tuple[str, ...]
    """Paths of the parameters in the order of the vector p."""
    drives: tuple[str, ...]
    """Names of the drives; each owns three more entries of p: value, slope, start."""
    switch_events: tuple[tuple[str, str] | None, ...]
    """What each switch is called in events, when it comes true and when it ceases to hold."""


@dataclass(frozen=True)
class _Symbols:
    """The symbols of one formulation."""

    t: se.Symbol
    coordinates: list[se.Symbol]
    rates: list[se.Symbol]
    bristles: list[se.Symbol]
    drives: dict[str, se.Symbol]
    inputs: dict[se.Symbol, se.Expr]
    """Expression of each drive."""
    constants: frozenset[str]

    @property
    def states(self) -> list[se.Symbol]:
        return [*self.coordinates, *self.rates, *self.bristles]


def formulate(mechanism: Mechanism, law: FrictionLaw) -> Model:
    """Trace a law and a mechanism and derive what the solver needs.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> model = formulate(SpringBlock(mass=1.0), Coulomb(kinetic_coefficient=0.2))
    >>> model.states
    ('x', 'v')
    """
    board = Switchboard()
    index: dict[str, int] = {}
    for root, prefix in ((mechanism, "mechanism"), (law, "friction")):
        for path, _, _ in parameters(root, prefix):
            index[path] = len(index)

    def symbol(path: str) -> Traced:
        return Traced(se.Symbol(f"p{index[path]}"), board)

    twin = shadow(mechanism, "mechanism", symbol)
    law_twin = shadow(law, "friction", symbol)
    symbols = _symbols(twin, law, len(index), board)
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
        law_twin,
        coordinate_rates=symbols.rates,
        bristles=symbols.bristles,
        constants=symbols.constants,
        board=board,
    )
    bristles = law.bristles if isinstance(law, BristleLaw) else ()
    return Model(
        text=_text(symbols, mechanics, modes, list(board.switches.values())),
        states=(*mechanism.coordinates, *mechanism.rates, *bristles),
        parameter_paths=tuple(index),
        drives=tuple(symbols.drives),
        switch_events=tuple(switch.events for switch in board.switches.values()),
    )


def _symbols(twin: Mechanism, law: FrictionLaw, size: int, board: Switchboard) -> _Symbols:
    n = len(twin.coordinates)
    m = len(law.bristles) if isinstance(law, BristleLaw) else 0
    y = [se.Symbol(f"y{i}") for i in range(2 * n + m)]
    t = se.Symbol("t")
    drives, inputs = {}, {}
    for k, (name, drive) in enumerate(twin.drives().items()):
        value, slope, start = (se.Symbol(f"p{size + 3 * k + i}") for i in range(3))
        drives[name] = se.Symbol(f"d{k}")
        linear = value + slope * (t - start)
        inputs[drives[name]] = linear + expression(drive.smooth(Traced(t, board)))
    constants = frozenset(f"p{i}" for i in range(size))
    return _Symbols(t, y[:n], y[n : 2 * n], y[2 * n :], drives, inputs, constants)


def _text(
    symbols: _Symbols,
    mechanics: Mechanics,
    modes: Mapping[Mode, ModeEquations],
    switches: list[Switch],
) -> str:
    """Write the module's own part: what the kernels find under these names."""
    y, t = symbols.states, symbols.t

    def closed(e: se.Expr) -> se.Expr:
        return e.subs(symbols.inputs)

    rates = {mode: [closed(e) for e in equations.rates] for mode, equations in modes.items()}

    def each(part: Callable[[Mode], Case]) -> dict[int | None, Case]:
        return {int(mode): part(mode) for mode in modes}

    def guard_row(mode: Mode) -> Case:
        guards = modes[mode].guards
        return [closed(guards.get(i, se.Integer(0))) for i in range(SWITCH + len(switches))]

    state = ("flags", "t", "y", "p")
    moving = ("mode", *state)
    parts = [
        _constants(symbols, mechanics, modes, switches),
        function("field", moving, each(lambda m: rates[m])),
        function("jacobian", moving, each(lambda m: [e.diff(s) for e in rates[m] for s in y])),
        function("time_slope", moving, each(lambda m: [e.diff(t) for e in rates[m]])),
        function("guards", moving, each(guard_row)),
        function("contact", moving, each(lambda m: [closed(e) for e in modes[m].contact])),
        function("power", moving, each(lambda m: [closed(e) for e in modes[m].power])),
        function("energy", state, {None: [mechanics.energy]}),
        function("margins", state, {None: [closed(s.margin) for s in switches]}),
        function("diagram", (*state, "d"), {None: _diagram(mechanics, closed)}),
        function("rest", (*state, "d"), {None: _rest(modes)}),
    ]
    return "\n\n".join(parts)


def _constants(
    symbols: _Symbols,
    mechanics: Mechanics,
    modes: Mapping[Mode, ModeEquations],
    switches: list[Switch],
) -> str:
    values = {
        "N_STATES": len(symbols.states),
        "N_COORDINATES": len(symbols.coordinates),
        "N_GUARDS": SWITCH + len(switches),
        "N_SWITCHES": len(switches),
        "N_DRIVES": len(symbols.drives),
        "SLIP": len(symbols.coordinates) + mechanics.slip,
        "CAN_STICK": Mode.STICK in modes,
        "HAS_BRISTLES": bool(symbols.bristles),
        "REST_IS_FINAL": _rest_is_final(symbols, modes),
    }
    return "\n".join(f"{name} = {value}" for name, value in values.items()) + "\n"


def _diagram(mechanics: Mechanics, closed: Callable[[se.Expr], se.Expr]) -> list[se.Expr]:
    """Return accelerations and normal force for a friction force d0, and the needed friction."""
    outside = se.Symbol("d0")
    friction = se.Symbol("F")  # kept apart until the drives, also called d, are put in
    accelerations, normal = mechanics.slipping(friction, se.Integer(0))
    _, _, needed = mechanics.sticking()
    return [closed(e).subs({friction: outside}) for e in (*accelerations, normal, needed)]


def _rest(modes: Mapping[Mode, ModeEquations]) -> list[se.Expr]:
    """Return needed friction and break-away level at rest for drive values given from outside."""
    if Mode.STICK not in modes:
        return [se.Integer(0), se.Integer(0)]
    _, _, needed, level = modes[Mode.STICK].contact
    return [needed, level]


def _rest_is_final(symbols: _Symbols, modes: Mapping[Mode, ModeEquations]) -> bool:
    """Whether a held body can only be moved by its drives: nothing else changes in time."""
    if Mode.STICK not in modes:
        return False
    stick = modes[Mode.STICK]
    still = all(rate == 0 for rate in stick.rates)
    timed = any(symbols.t in e.free_symbols for e in [*stick.guards.values(), *stick.contact])
    return still and not timed
