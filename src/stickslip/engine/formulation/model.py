"""A law and a mechanism joined: the text of their equations, and what its numbers mean.

1. The mechanism and the law are traced with symbols in place of states and parameters.
2. One contact: its equations are derived in each mode (rest, slip in both senses, pressed to a
   stop), each with guards that end it. Several contacts: their equations are parts, in which no
   mode stands, since n contacts have 3^n modes; kernels put them together.
3. The expressions become the text of one self-contained numeric module.

Models of one structure are traced once in a process, whatever their numbers are.
"""

import math
from collections import OrderedDict
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import partial
from threading import RLock
from typing import Any, Final

import symengine as se

from stickslip.engine.formulation import mechanics as dynamics
from stickslip.engine.formulation import modes as mode_text
from stickslip.engine.formulation import trace
from stickslip.engine.formulation.trace import collapsed, rebuilt
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.state_layout import NUMBERS
from stickslip.errors import InputError, TracingError
from stickslip.friction import FrictionLaw, Laws, bound, bristle_names
from stickslip.mechanisms import Mechanism, of_contact, refuse_sampling, stops_of
from stickslip.quantities import parameters, shadow, structure

# Expressions to statements of infix languages: one printer, what differs as data.
#
# Rules that make tiers agree bit for bit: whole powers are products, constants are printed by
# `repr`. A Piecewise becomes an if/else whose branches have a scope of their own, so that nothing
# of the branch not taken is evaluated.

INDENT = "    "
Case = Sequence[se.Expr]
"""The expressions that one case of a function writes, in order."""
Cases = Mapping[Any, Case]
"""Cases of a function by the value of ``mode``; the single key None if there is no such choice."""
CONSTANTS: Final = "constants"
"""Name of the function that writes what the others need of parameters alone."""
FEW_ZEROS = 3
"""More zeros than this are stored by a loop."""


@dataclass(frozen=True, kw_only=True)
class Syntax:
    """How an infix language writes what expressions need."""

    functions: Mapping[str, str]
    """Names of the functions of one argument by the names of SymEngine, ``exp`` and ``sqrt``
    included."""
    power: str
    """A power whose exponent is no whole number, of ``{base}`` and ``{exponent}``."""
    assign: str
    """Statement that gives ``{name}`` the ``{value}``."""
    branch: str
    """Head of what happens where ``{condition}`` holds."""
    otherwise: str
    """Head of what happens where it does not."""
    end: str = ""
    """Line after a branch; none if empty."""
    switch: str = ""
    """Condition of a switch of the solver by its ``{bit}``, where there are any."""


class Block:
    """Statements in a language, and the names of the temporaries that they assign.

    Parameters
    ----------
    syntax : Syntax
        The language.
    depth : int
        Levels by which lines are indented.
    """

    def __init__(self, syntax: Syntax, depth: int, plain: set[se.Expr] | None = None) -> None:
        self.syntax = syntax
        self.plain = set() if plain is None else plain
        self.lines: list[str] = []
        self.temporaries: list[str] = []
        self.depth = depth
        self.count = 0

    def line(self, text: str) -> None:
        """Add a line."""
        self.lines.append(INDENT * self.depth + text)

    def assign(self, name: str, value: str) -> None:
        """Add the assignment of a text to a name."""
        self.line(self.syntax.assign.format(name=name, value=value))

    def fresh(self) -> str:
        """Return the name of a new temporary: c1, c2, ..., which nothing else may be called."""
        self.count += 1
        self.temporaries.append(f"c{self.count}")
        return self.temporaries[-1]

    def scope(self, expressions: Sequence[se.Expr]) -> list[str]:
        """Write what the expressions need and return their texts."""
        lifted: dict[str, tuple[str, se.Piecewise]] = {}
        flat = [_lift(e, lifted, self) for e in expressions]
        for name, piecewise in lifted.values():
            # Within a branch of its own: what the other side computes must not be evaluated.
            self._branch(name, piecewise)
        # Common parts once, in the order of the expressions: sums keep their order in all tiers.
        shared, reduced = se.cse(flat)
        names: dict[str, str] = {}
        for symbol, value in shared:
            text = self._text(value, names)
            names[str(symbol)] = self.fresh()
            self.assign(names[str(symbol)], text)
        return [self._text(e, names) for e in reduced]

    def _branch(self, name: str, piecewise: se.Piecewise) -> None:
        yes, condition, no, _ = piecewise.args
        syntax = self.syntax
        self.line(syntax.branch.format(condition=self._condition(condition)))
        for value, closing in ((yes, syntax.otherwise), (no, syntax.end)):
            self.depth += 1
            (text,) = self.scope([value])
            self.assign(name, text)
            self.depth -= 1
            if closing:
                self.line(closing)

    def _condition(self, condition: se.Basic) -> str:
        low, high = condition.args
        flag = str(high)
        # A flag of the solver is a bit; other conditions are comparisons of numbers.
        if self.syntax.switch and flag[0] == "s" and flag[1:].isdigit():
            return self.syntax.switch.format(bit=1 << int(flag[1:]))
        (left, right) = self.scope([low, high])
        return f"{left} < {right}"

    def _text(self, e: se.Expr, names: Mapping[str, str]) -> str:
        """Return the text of an expression; a temporary is written first where one is needed."""
        if e.is_Symbol:
            return names.get(str(e), str(e))
        if e.is_Number:
            return _constant(e)
        if e.is_Add:
            # The order of terms is the printer's, and the same in all languages.
            terms = [self._text(term, names) for term in e.args]
            return terms[0] + "".join(
                f" - {term[1:]}" if term.startswith("-") else f" + {term}" for term in terms[1:]
            )
        if e.is_Mul:
            return self._product(e, names)
        if e.is_Pow:
            return self._power(e, names)
        return self._call(type(e).__name__.lower(), e.args[0], names)

    def _call(self, function: str, argument: se.Expr, names: Mapping[str, str]) -> str:
        return f"{self.syntax.functions[function]}({self._text(argument, names)})"

    def _factor(self, e: se.Expr, names: Mapping[str, str]) -> str:
        text = self._text(e, names)
        return f"({text})" if e.is_Add or text.startswith("-") else text

    def _product(self, e: se.Expr, names: Mapping[str, str]) -> str:
        above, below, sign = [], [], ""
        for factor in e.args:
            # Signs and negative powers apart: -a/b instead of a*-1*b**-1, as rounding differs.
            if factor.is_Number and factor < 0:
                sign = "-"
                if factor != -1:
                    above.append(_constant(-factor))
            elif factor.is_Pow and factor.args[0] != se.E and _negative(factor.args[1]):
                below.append(self._factor(factor.args[0] ** -factor.args[1], names))
            else:
                above.append(self._factor(factor, names))
        top = sign + ("*".join(above) or "1.0")
        if not below:
            return top
        bottom = "*".join(below)
        return f"{top}/({bottom})" if "*" in bottom or "/" in bottom else f"{top}/{bottom}"

    def _power(self, e: se.Expr, names: Mapping[str, str]) -> str:
        base, exponent = e.args
        if base == se.E:
            return self._call("exp", exponent, names)
        if _negative(exponent):
            return f"1.0/({self._text(base**-exponent, names)})"
        # A root is rounded correctly by all languages; a power need not be.
        if exponent == se.Rational(1, 2):
            return self._call("sqrt", base, names)
        if not exponent.is_Integer:
            return self.syntax.power.format(
                base=self._text(base, names), exponent=self._text(exponent, names)
            )
        text = self._text(base, names)
        # Whole powers are products of a name, which all languages round alike.
        if not base.is_Symbol:
            name = self.fresh()
            self.assign(name, text)
            text = name
        return "(" + "*".join([text] * int(exponent)) + ")"


def _constant(e: se.Expr) -> str:
    value = float(e)
    if not math.isfinite(value):
        raise TracingError(f"an equation contains {value}, which no language has a constant for")
    return repr(value)


def _negative(exponent: se.Expr) -> bool:
    return bool(exponent.is_Number and exponent < 0)


def _lift(e: se.Expr, lifted: dict[str, tuple[str, se.Piecewise]], block: Block) -> se.Expr:
    """Replace the outermost Piecewise parts by names."""

    def named(switch: se.Piecewise) -> se.Symbol:
        key = str(switch)
        if key not in lifted:
            lifted[key] = (block.fresh(), switch)
        return se.Symbol(lifted[key][0])

    return rebuilt(e, named, block.plain)


PYTHON: Final = Syntax(
    functions={
        name: f"math.{name}" for name in ("exp", "sqrt", "sin", "cos", "tanh", "atan", "log")
    },
    power="math.pow({base}, {exponent})",
    assign="{name} = {value}",
    branch="if {condition}:",
    otherwise="else:",
    switch="flags & {bit}",
)


def program(
    functions: Mapping[str, Cases], parameters: Collection[int], first: int
) -> tuple[str, int]:
    """Return the text of functions, and how many constants they read.

    Functions of parameters alone, such as the sine of an incline, become constants behind all
    parameters: ``constants`` writes them, once for a run. What only one side of a switch needs is
    left where it is.
    """
    everything = [e for cases in functions.values() for case in cases.values() for e in case]
    calls = _calls_of(everything, {f"p{i}" for i in parameters})
    if calls:
        # Worked out once a run instead of at each evaluation.
        result = {e: se.Symbol(f"p{first + i}") for i, e in enumerate(calls)}
        functions = {
            name: {mode: [e.xreplace(result) for e in case] for mode, case in cases.items()}
            for name, cases in functions.items()
        }
        functions[CONSTANTS] = {None: calls}
    plain: set[se.Expr] = set()
    texts = [function(name, cases, plain) for name, cases in functions.items()]
    return "\n\n".join(texts), len(calls)


def _calls_of(expressions: Sequence[se.Expr], known: Set[str]) -> list[se.Expr]:
    """Return the calls whose symbols are all known, on no side of a switch.

    Parts that several others share, of which recursions make many, are looked at once.
    """
    result: dict[se.Expr, None] = {}
    seen: set[se.Expr] = set()
    waiting = [*reversed(expressions)]
    while waiting:
        e = waiting.pop()
        # What stands inside a branch may have no value on its other side.
        if e in seen or not e.args or isinstance(e, se.Piecewise):
            continue
        seen.add(e)
        names = {str(s) for s in e.free_symbols} if _is_call(e) else set()
        if names and names <= known:
            result[e] = None
        else:
            waiting.extend(reversed(e.args))
    return list(result)


def _is_call(e: se.Expr) -> bool:
    """Whether an expression is printed as the call of a function."""
    if e.is_Pow:
        base, exponent = e.args
        return bool(base == se.E or not exponent.is_Integer)
    return not (e.is_Add or e.is_Mul)


def function(name: str, cases: Cases, plain: set[se.Expr] | None = None) -> str:
    """Return the text of a function that reads the vector ``w`` and writes expressions to it.

    Symbols y0, y1, ... stand at the place ``at`` and after it, p0, p1, ... at NUMBERS and after
    it; the results go to the place ``to`` and after it.
    """
    plain = set() if plain is None else plain
    lines = [f"def {name}(mode, flags, t, w, at, to):"]
    for mode, case in cases.items():
        depth = 1
        if mode is not None:
            lines.append(f"{INDENT}if mode == {mode}:")
            depth = 2
        block = Block(PYTHON, depth, plain)
        expressions = [collapsed(e, plain) for e in case]
        _unpack(block, expressions)
        _write(block, block.scope(expressions))
        block.line("return")
        lines += block.lines
    return "\n".join(lines) + "\n"


def _unpack(block: Block, expressions: Sequence[se.Expr]) -> None:
    """Load the elements of y and p that occur into local names."""
    names = {str(s) for e in expressions for s in e.free_symbols}
    # By letter, then by number: the text must not depend on the order of a set.
    for name in sorted(names, key=lambda n: (n[0], len(n), n)):
        if name[0] in "yp" and name[1:].isdigit():
            place = NUMBERS + int(name[1:]) if name[0] == "p" else f"at + {name[1:]}"
            block.assign(name, f"w[{place}]")


def _write(block: Block, texts: Sequence[str]) -> None:
    """Store the results; where most are zero, zeros first."""
    zeros = texts.count("0.0")
    if zeros > FEW_ZEROS:
        block.line(f"for i in range({len(texts)}):")
        block.line(f"{INDENT}w[to + i] = 0.0")
    for index, text in enumerate(texts):
        if zeros <= FEW_ZEROS or text != "0.0":
            block.assign(f"w[to + {index}]", text)


# A law and a mechanism joined: the text of their equations, and what its numbers mean.

# The text of the parts of a mechanism's equations, and what its numbers mean.


@dataclass(frozen=True)
class _Own:
    """The laws of the contacts that rub."""

    contacts: tuple[str, ...]
    """Names of these contacts."""
    laws: tuple[FrictionLaw, ...]
    """The law of each."""
    shared: tuple[int, ...]
    """Index of each one's numbers: contacts with one law have the same."""
    distinct: tuple[tuple[str, FrictionLaw], ...]
    """Prefix of the paths, and the law, of each set of numbers."""
    kinds: tuple[int, ...]
    """Index of the structure of each contact's law."""
    structures: tuple[FrictionLaw, ...]
    """A law of each structure."""

    def shadows(self, rows: Sequence[int], board: trace.Switchboard) -> dict[str, FrictionLaw]:
        """Return laws by contact whose parameters are symbols, of which each row begins before."""
        twins = []
        # Contacts that share a law share its numbers, and so its symbols.
        for row, (prefix, law) in zip(rows, self.distinct, strict=False):
            place = {p: row + i for i, (p, _, _) in enumerate(parameters(law, prefix), 1)}
            symbol = partial(_symbol, place, board)
            twins.append(shadow(law, prefix, symbol))
        return {name: twins[index] for name, index in zip(self.contacts, self.shared, strict=True)}


def _symbol(place: Mapping[str, int], board: trace.Switchboard, path: str) -> trace.Traced:
    return trace.Traced(se.Symbol(f"p{place[path]}"), board)


def _own_laws(mechanism: Mechanism, law: FrictionLaw | Laws) -> _Own:
    if isinstance(law, Laws):
        names, laws = (
            tuple(name for name, _ in law.members),
            tuple(member for _, member in law.members),
        )
        shared = tuple(range(len(laws)))
        distinct = tuple((f"friction.{name}", member) for name, member in law.members)
    else:
        names = tuple(contact.name for contact in mechanism.contacts())
        laws, shared = (law,) * len(names), (0,) * len(names)
        distinct = (("friction", law),)
    keys = list(dict.fromkeys(structure(member) for member in laws))
    kinds = tuple(keys.index(structure(member)) for member in laws)
    # Equations of a law are written once for each structure, whatever its values are.
    structures = tuple(laws[kinds.index(kind)] for kind in range(len(keys)))
    return _Own(names, laws, shared, distinct, kinds, structures)


def contact_model(
    mechanism: Mechanism, law: FrictionLaw | Laws, *, slopes: bool = False
) -> trace.Model:
    """Trace a mechanism with several contacts and their laws."""
    own = _own_laws(mechanism, law)
    board = trace.Switchboard()
    paths = [path for path, _, _ in parameters(mechanism, "mechanism")]
    # Value, slope and start of each drive, its value from outside, and the time stand before them.
    first = 4 * len(mechanism.drives()) + 1
    index = {path: first + i for i, path in enumerate(paths)}
    twin = shadow(mechanism, "mechanism", partial(_symbol, index, board))
    bristles = [len(friction.states) for friction in own.laws]
    constants = frozenset(f"p{i}" for i in index.values())
    symbols = trace.symbols_of(twin, sum(bristles), constants, board)
    rows = layout.law_rows(
        first + len(paths),
        [len(list(parameters(friction, prefix))) for prefix, friction in own.distinct],
        [len(friction.inputs) for friction in own.laws],
        bristles,
    )
    parts = mode_text.derive_parts(
        twin,
        own.shadows(rows, board),
        symbols.t,
        dict(zip(mechanism.coordinates, symbols.coordinates, strict=True)),
        dict(zip(mechanism.coordinates, symbols.rates, strict=True)),
        symbols.drives,
        _motion(symbols, len(own.contacts)),
        board,
    )
    laws = [mode_text.law_parts(friction, len(friction.states)) for friction in own.structures]
    for reacts, kind, contact in zip(parts.reacts, own.kinds, own.contacts, strict=True):
        if reacts and laws[kind].switched_by_load:
            raise InputError(
                f"{own.structures[kind].name} has a switch that depends on the load, which is a"
                f" reaction at the contact {contact!r} and known only after the switch: let a"
                " switch depend on the slip velocity or on contact inputs, or give the contact a"
                " load."
            )
    equations = _Equations(symbols, parts, board)
    quantities = len(paths) + sum(
        len(list(parameters(friction, p))) for p, friction in own.distinct
    )
    along: list[se.Symbol | None] = []
    dampens = equations.dampens() or any(friction.may_dampen for friction in laws)
    # Motions that die away may be stiff; others need no slopes, which cost time to derive.
    if slopes or dampens:  # what is stiff is integrated with the Jacobian
        along = [*symbols.states, symbols.t]
    if slopes:
        drives = [se.Symbol(f"p{i}") for i in range(3 * len(symbols.drives))]
        own_symbols = [se.Symbol(f"p{i}") for i in index.values()]
        along += [*drives, *own_symbols, *[None] * (quantities - len(paths))]
    columns = equations.part_slopes(along)
    # The constants stand behind all parameters, laws' ones included.
    text, result = program(_contact_functions(equations, columns), index.values(), rows[-1])
    sizes = layout.ContactSizes(
        coordinates=len(mechanism.coordinates),
        bristles=sum(bristles),
        switches=len(board.switches),
        drives=len(equations.symbols.drives),
        parameters=len(paths),
        constants=result,
        waves=len(equations.time_slopes) if equations.waves.symbols else 0,
        rest_is_final=equations.rest_is_final(),
        slips=parts.directions.slips,
        looped=parts.directions.loops.looped,
        closing=len(parts.directions.loops.closing),
        cuts=len(parts.directions.loops.cuts),
        turned=bool(parts.directions.forward),
        kinds=own.kinds,
        shared=own.shared,
        numbers=tuple(len(list(parameters(friction, prefix))) for prefix, friction in own.distinct),
        inputs_of=tuple(len(friction.inputs) for friction in own.laws),
        bristles_of=tuple(bristles),
        holds=tuple(friction.holds for friction in own.laws),
        directional=tuple(friction.directional for friction in own.laws),
        reacts=parts.reacts,
        held=len(parts.held),
        channels=len(parts.efforts),
        own_limits=len(parts.limits),
        walls=tuple((wall.coordinate, wall.side) for wall in parts.walls),
        mass=tuple(parts.mass),
        slopes=tuple(equations.slopes),
        time_slopes=tuple(equations.time_slopes),
        law_switches=max((len(friction.switch_events) for friction in laws), default=0),
        constant_mass=equations.constant_mass(),
        constant_loads=equations.constant_loads(),
        affine=equations.affine(),
        exact=not dampens and equations.affine() and all(friction.is_linear for friction in laws),
        supplies=parts.supplied != 0,
        part_slopes=tuple(tuple(column) for column in columns),
    )
    places = [sizes.first_parameter + i for i in range(len(paths))]
    law_paths = []
    for (prefix, member), row in zip(own.distinct, sizes.law_places(), strict=True):
        for i, (path, _, _) in enumerate(parameters(member, prefix), 1):
            law_paths.append(path)
            places.append(row + i)
    events = [switch.events for switch in board.switches.values()]
    return trace.Model(
        title=f"{type(mechanism).__name__} with {_titles(own)}",
        sizes=sizes,
        text="\n\n".join([text, *_texts_of_laws(laws, along=bool(columns))]),
        states=(
            *mechanism.coordinates,
            *mechanism.rates,
            *bristle_names(tuple(contact.name for contact in mechanism.contacts()), law),
        ),
        parameter_paths=(*paths, *law_paths),
        places=tuple(places),
        drives=tuple(symbols.drives),
        switch_events=tuple(events),
        impact_events=dynamics.impact_events(
            parts.walls, mechanism.coordinates, _only_slip(mechanism)
        ),
        limits=(*(mode_text.PAINLEVE,) * any(parts.reacts), *parts.limits),
        latched=any(friction.latched for friction in laws),
        channels=tuple(parts.efforts),
        turning=_turning(parts, index),
        contacts=own.contacts,
        closing=parts.closing,
        alone=len(mechanism.contacts()) == 1,
        law_switch_events=tuple(
            (*laws[kind].switch_events, *[None] * sizes.law_switches)[: sizes.law_switches]
            for kind in own.kinds
        ),
    )


def _only_slip(mechanism: Mechanism) -> int | None:
    """Return the index of the coordinate along which the only contact slips, if there is one."""
    slips = [name for contact in mechanism.contacts() for name in contact.slips]
    return mechanism.coordinates.index(slips[0]) if len(slips) == 1 else None


def _motion(symbols: trace.Symbols, contacts: int) -> mode_text.EffortSymbols:
    """Return symbols of the accelerations, and of the friction, that stand behind a state."""
    first, n = len(symbols.states), len(symbols.coordinates)
    behind = [se.Symbol(f"y{first + i}") for i in range(n + contacts)]
    return mode_text.EffortSymbols(behind[:n], behind[n:])


def _turning(parts: mode_text.ContactParts, index: Mapping[str, int]) -> tuple[str, ...]:
    """Return the paths of the parameters on which the change of coordinates depends."""
    directions = parts.directions
    entries = [*(e for row in directions.forward for e in row), *directions.loops.numbers()]
    names = {name for e in entries for name in _names(e)}
    return tuple(path for path, i in index.items() if f"p{i}" in names)


def _titles(own: _Own) -> str:
    return " and ".join(dict.fromkeys(type(law).__name__ for law in own.laws))


class _Equations:
    """The parts with the drives put in, and their slopes."""

    def __init__(
        self, symbols: trace.Symbols, parts: mode_text.ContactParts, board: trace.Switchboard
    ) -> None:
        self.symbols, self.parts = symbols, parts
        self.switched = bool(board.switches)
        closed = symbols.closed
        n = len(parts.coordinates)
        self.forces = [closed(e) for e in parts.forces]
        self.given_forces = [e.subs(symbols.given) for e in parts.forces[:n]]
        self.loads = [closed(e) for e in parts.loads]
        self.inputs = [closed(e) for own in parts.inputs for e in own.values()]
        self.supplied = closed(parts.supplied)
        self.efforts = [closed(e) for e in parts.efforts.values()]
        self.limits = [closed(e) for e in parts.limits.values()]
        states = [*symbols.coordinates, *symbols.rates]
        # Only slopes that are not 0: kernels go along the list instead of a matrix.
        self.slopes = {
            (i, k): slope
            for i in range(n)
            for k, state in enumerate(states)
            if str(state) in _names(self.forces[i])
            and (slope := trace.collapsed(self.forces[i].diff(state))) != 0
        }
        self.time_slopes = {
            i: slope
            for i in range(n)
            if "t" in _names(self.forces[i])
            and (slope := trace.collapsed(self.forces[i].diff(symbols.t))) != 0
        }
        self.waves = trace.waves_of(self.forces[:n], symbols.t, states)
        self.moving = {str(s) for s in (*states, *self.waves.symbols.values())} | {"t"}
        self.margins = [closed(switch.margin) for switch in board.switches.values()]
        self.flags = [switch.symbol for switch in board.switches.values()]
        self.geometry = [
            *parts.directions.factors,
            *[e for row in parts.held_slips for e in row],
            *[e for row in parts.held_normals for e in row],
        ]

    @property
    def walls(self) -> list[se.Expr]:
        """Place and restitution of each stop."""
        return [e for wall in self.parts.walls for e in (wall.position, wall.restitution)]

    def part_slopes(self, along: Sequence[se.Symbol | None]) -> list[dict[int, se.Expr]]:
        """Return the derivatives of all parts, by row, along each variable; None is in no part.

        Rows are those of M a - h, with the accelerations behind the states, of moving coordinates
        and of held ones; then come loads, how contacts slip, margins of switches, places and
        restitutions of stops, and contact inputs.
        """
        behind = _motion(self.symbols, 0).accelerations
        # M a - h with the accelerations as further variables: its slopes are all that kernels need.
        rows = [-e for e in self.forces]
        for (i, j), entry in self.parts.mass.items():
            rows[i] += entry * behind[j]
            if j < i < len(self.parts.coordinates):
                rows[j] += entry * behind[i]
        rows += [*self.loads, *self.geometry, *self.margins, *self.walls, *self.inputs]
        names = [_names(e) for e in rows]
        return [
            {
                i: slope
                for i, e in enumerate(rows)
                # Cheap first: most parts do not have the variable at all.
                if str(x) in names[i] and (slope := trace.collapsed(e.diff(x))) != 0
            }
            if x is not None
            else {}
            for x in along
        ]

    def varies(self, e: se.Expr) -> bool:
        """Whether an expression changes in a run."""
        # By names first, as expanding is slow; cancelled terms may leave none of them.
        return bool(_names(e) & self.moving) and bool(_names(se.expand(e)) & self.moving)

    def dampens(self) -> bool:
        """Whether the power that goes in has products of rates: motions die away, or grow."""
        rates = {str(rate) for rate in self.symbols.rates}
        # Damping is power that is quadratic in rates.
        return any(_names(self.supplied.diff(v)) & rates for v in self.symbols.rates)

    def constant_mass(self) -> bool:
        """Whether the mass matrix is constant."""
        return not any(self.varies(e) for e in self.parts.mass.values())

    def constant_loads(self) -> bool:
        """Whether all prescribed loads and contact inputs are constant."""
        given = [*self.loads, *self.inputs]
        # the drives' numbers change from piece to piece
        changing = self.moving | {f"p{i}" for i in range(3 * len(self.symbols.drives))}
        return not any(_flags(e) or _names(e) & changing for e in given)

    @property
    def margin_slopes(self) -> list[se.Expr]:
        """Derivatives of each margin along states and time."""
        along = [*self.symbols.states, self.symbols.t]
        return [trace.collapsed(e.diff(x)) for e in self.margins for x in along]

    def affine(self) -> bool:
        """Whether all is affine in states and time together, whatever the flags are.

        Forces may have harmonics in time beside.
        """
        # Sines and cosines in time are symbols here: affine in them is what series can do.
        forces = [self.waves.replaced(e) for e in self.forces[: len(self.parts.coordinates)]]
        along = [*self.symbols.states, self.symbols.t]
        linear = (
            trace.linear_where(forces, [*along, *self.waves.symbols.values()], self.flags),
            trace.linear_where(self.margins, along, self.flags),
        )
        return (
            linear == (1, 1)
            and self.constant_mass()
            and self.constant_loads()
            and not any(self.parts.reacts)
            and not self.limits
        )

    def rest_is_final(self) -> bool:
        """Whether nothing but the drives can move what is held."""
        # Time, switches, changing loads and reactions may end a rest without a drive.
        timed = any("t" in _names(e) for e in self.given_forces)
        ends = any(self.parts.reacts) or bool(self.limits)
        return not timed and not self.switched and self.constant_loads() and not ends


def _names(e: se.Expr) -> set[str]:
    return {str(s) for s in e.free_symbols}


def _flags(e: se.Expr) -> set[str]:
    return {name for name in _names(e) if name[0] == "s" and name[1:].isdigit()}


def _contact_functions(
    equations: _Equations, columns: Sequence[Mapping[int, se.Expr]]
) -> dict[str, Cases]:
    """Return what the kernels find under these names, but for the laws."""
    parts = equations.parts
    same: Mapping[str, Sequence[se.Expr]] = {
        "forces": equations.forces,
        "masses": list(parts.mass.values()),
        "loads": [*equations.loads, *equations.inputs],
        "geometry": equations.geometry,
        "force_slopes": [*equations.slopes.values(), *equations.time_slopes.values()],
        "energy": [parts.energy],
        "power": [equations.supplied],
        "margins": equations.margins,
        "margin_slopes": equations.margin_slopes,
        "rest": equations.given_forces,
    }
    if equations.waves.symbols:
        terms = [equations.waves.term(equations.forces[i]) for i in equations.time_slopes]
        rates = [e.diff(equations.symbols.t) for e in terms]
        same = {**same, "waves": [*terms, *rates, equations.waves.square]}
    turning = (*parts.directions.forward, *parts.directions.backward)
    some: Mapping[str, Sequence[se.Expr]] = {
        "turning": [e for row in turning for e in row],
        "loops": parts.directions.loops.numbers(),
        "efforts": equations.efforts,
        "limits": equations.limits,
        "walls": equations.walls,
    }
    # What a mechanism has none of needs no function.
    same = {**same, **{name: case for name, case in some.items() if case}}
    if columns:
        same = {**same, "part_slopes": [e for column in columns for e in column.values()]}
    return {name: {None: list(case)} for name, case in same.items()}


def _texts_of_laws(laws: Sequence[mode_text.LawParts], *, along: bool) -> list[str]:
    """Return the functions of each law, once per structure, and their slopes if wanted."""
    texts = []
    for kind, law in enumerate(laws):
        texts.append(function(f"law_{kind}", {side: list(c) for side, c in law.numbers.items()}))
        texts.append(function(f"law_margins_{kind}", {None: law.margins}))
        if along:
            sides = {side: list(case) for side, case in law.slopes.items()}
            texts.append(function(f"law_slopes_{kind}", sides))
            texts.append(function(f"law_margin_slopes_{kind}", {None: law.margin_slopes}))
    return texts


_MODELS: OrderedDict[Hashable, trace.Model] = OrderedDict()
"""Models by the structure of their mechanism and law, those last asked for at the end."""
MOST_MODELS = 256
_LOCK = RLock()
"""Held while these are looked up: equations are traced by one of several threads."""


def formulate(
    mechanism: Mechanism, law: FrictionLaw | Laws, *, slopes: bool = False
) -> trace.Model:
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
    # Under the lock: two threads that ask for one model must not trace it twice.
    with _LOCK:
        try:
            model = _MODELS.get(key)
        except TypeError:  # a field of the user's that has no hash: traced anew each time
            return _formulated(mechanism, law, slopes)
        if model is not None:
            _MODELS.move_to_end(key)
            return model
        # Recently asked models stay: ensembles and fits ask for few structures, many times.
        model = _MODELS[key] = _formulated(mechanism, law, slopes)
        while len(_MODELS) > MOST_MODELS:
            _MODELS.popitem(last=False)
        return model


def _is_of_parts(mechanism: Mechanism, law: FrictionLaw | Laws) -> bool:
    """Whether the equations are parts, as those of several contacts are."""
    contacts = mechanism.contacts()
    if isinstance(law, Laws) or len(contacts) > 1:
        return True
    # Slips that are sums, and loads that contacts share, are of parts even with one contact.
    if any(
        isinstance(way, Mapping) for contact in contacts for way in (contact.slip, contact.normal)
    ):
        return True
    # what does not slip may rest at a stop too, beside whatever the contact does
    inside = any(stop.coordinate not in contacts[0].slips for stop in stops_of(mechanism))
    return inside or type(mechanism).loads is not Mechanism.loads


def _formulated(mechanism: Mechanism, law: FrictionLaw | Laws, slopes: bool) -> trace.Model:
    """Trace and derive; write the text."""
    refuse_sampling(mechanism)
    if _is_of_parts(mechanism, law):
        return contact_model(mechanism, law, slopes=slopes)
    assert isinstance(law, FrictionLaw)  # laws by contact are of parts
    board, index = trace.Switchboard(), _places(mechanism, law)
    symbols, mechanics, modes = _derived(mechanism, law, index, board)
    # all numbers that equations read: those of the drives, then the parameters
    numbers = (*range(3 * len(symbols.drives)), *index.values()) if slopes else ()
    quantities = [se.Symbol(f"p{place}") for place in numbers]
    switches = list(board.switches.values())
    functions = _mode_functions(symbols, mechanics, modes, board, quantities)
    # Drives, their values from outside, and a place for the time come before parameters.
    first = 4 * len(symbols.drives) + 1 + len(index)
    text, constants = program(functions, index.values(), first)
    sizes = layout.ModeSizes(
        coordinates=len(symbols.coordinates),
        bristles=len(symbols.bristles),
        slip=len(symbols.coordinates) + mechanics.slip,
        switches=len(switches),
        limits=len(_limits(modes)),
        channels=len(mechanics.efforts),
        drives=len(symbols.drives),
        parameters=len(index),
        constants=constants,
        waves=0,
        walls=tuple((wall.coordinate, wall.side) for wall in mechanics.walls),
        can_stick=mode_text.Mode.STICK in modes,
        can_lift=any(layout.LIFT_OFF in equations.guards for equations in modes.values()),
        rest_is_final=_rest_is_final(symbols, modes),
    )
    # In series one place a state and a guard holds what harmonics add.
    if "waves" in functions:
        sizes = replace(sizes, waves=sizes.states + sizes.guards)
    return trace.Model(
        title=f"{type(mechanism).__name__} with {type(law).__name__}",
        sizes=sizes,
        text=text,
        states=(*mechanism.coordinates, *mechanism.rates, *law.states),
        parameter_paths=tuple(index),
        places=tuple(sizes.first_parameter + i for i in range(len(index))),
        drives=tuple(symbols.drives),
        switch_events=tuple(switch.events for switch in board.switches.values()),
        impact_events=dynamics.impact_events(
            mechanics.walls, mechanism.coordinates, mechanics.slip
        ),
        limits=_limits(modes),
        latched=any(switch.hold is not None for switch in switches),
        channels=tuple(mechanics.efforts.values()),
    )


def _derived(
    mechanism: Mechanism, law: FrictionLaw, index: Mapping[str, int], board: trace.Switchboard
) -> tuple[trace.Symbols, dynamics.Mechanics, Mapping[mode_text.Mode, mode_text.ModeEquations]]:
    """Return symbols, equations of motion, and what holds in each mode."""

    def symbol(path: str) -> trace.Traced:
        return trace.Traced(se.Symbol(f"p{index[path]}"), board)

    twin = shadow(mechanism, "mechanism", symbol)
    constants = frozenset(f"p{i}" for i in index.values())
    symbols = trace.symbols_of(twin, len(law.states), constants, board)
    mechanics = dynamics.derive_mechanics(
        twin,
        symbols.t,
        dict(zip(mechanism.coordinates, symbols.coordinates, strict=True)),
        dict(zip(mechanism.coordinates, symbols.rates, strict=True)),
        symbols.drives,
        board,
    )
    modes = mode_text.mode_equations(
        mechanics,
        _informed(shadow(law, "friction", symbol), twin, symbols, board),
        coordinate_rates=symbols.rates,
        bristles=symbols.bristles,
        constants=symbols.constants,
        board=board,
        closed=symbols.closed,
    )
    return symbols, mechanics, modes


def _informed(
    law: FrictionLaw, mechanism: Mechanism, symbols: trace.Symbols, board: trace.Switchboard
) -> FrictionLaw:
    """Return a law that sees what the mechanism tells of its contact."""
    if not law.inputs:
        return law

    def traced(names: Iterable[str], values: Iterable[se.Expr]) -> dict[str, trace.Traced]:
        return {name: trace.Traced(value, board) for name, value in zip(names, values, strict=True)}

    inputs = mechanism.contact_inputs(
        trace.Traced(symbols.t, board),
        traced(mechanism.coordinates, symbols.coordinates),
        traced(mechanism.coordinates, symbols.rates),
        traced(symbols.drives, symbols.drives.values()),
    )
    (contact,) = mechanism.contacts()
    return bound(law, of_contact(inputs, contact.name))


def _places(mechanism: Mechanism, law: FrictionLaw) -> dict[str, int]:
    """Return the place of each parameter in the vector of a run.

    Value, slope and start of each drive come before them, and what may be given in their place.
    """
    first = 4 * len(mechanism.drives()) + 1
    roots = ((mechanism, "mechanism"), (law, "friction"))
    paths = [path for root, prefix in roots for path, _, _ in parameters(root, prefix)]
    return {path: first + i for i, path in enumerate(paths)}


def _mode_functions(
    symbols: trace.Symbols,
    mechanics: dynamics.Mechanics,
    modes: Mapping[mode_text.Mode, mode_text.ModeEquations],
    board: trace.Switchboard,
    quantities: list[se.Symbol],
) -> dict[str, Cases]:
    """Return the module's own part: what the kernels find under these names."""
    y, t, closed = symbols.states, symbols.t, symbols.closed
    switches = list(board.switches.values())
    rates = {mode: [closed(e) for e in equations.rates] for mode, equations in modes.items()}
    guards = _guards(mechanics, modes, len(switches), closed)
    flags = [switch.symbol for switch in switches]
    margins = [closed(board.deciding(s)) for s in switches]

    # Guards have to be affine too: events of a linear mode are roots of its polynomials.
    waves = trace.waves_of([e for mode in modes for e in (*rates[mode], *guards[mode])], t, y)
    linear = {
        mode: trace.linear_where(
            [waves.replaced(e) for e in (*rates[mode], *guards[mode])],
            [*y, t, *waves.symbols.values()],
            flags,
        )
        for mode in modes
    }

    def each(part: Callable[[mode_text.Mode], Case]) -> Cases:
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
        # Modes that are not linear are not stepped by series, and never asked for waves.
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
    mechanics: dynamics.Mechanics,
    modes: Mapping[mode_text.Mode, mode_text.ModeEquations],
    switches: int,
    closed: Callable[[se.Expr], se.Expr],
) -> dict[mode_text.Mode, list[se.Expr]]:
    """Return the guards of each mode in the order of their indices, the walls' last."""
    limits = _limits(modes)
    return {
        mode: [
            closed(equations.guards.get(i, se.Integer(0))) for i in range(layout.SWITCH + switches)
        ]
        + [closed(equations.limits.get(name, se.Integer(0))) for name in limits]
        + dynamics.wall_guards(mechanics.walls, int(mode))
        for mode, equations in modes.items()
    }


def _limits(modes: Mapping[mode_text.Mode, mode_text.ModeEquations]) -> tuple[str, ...]:
    """Return the names of all limits that any mode has, that of the equations' meaning first."""
    names = dict.fromkeys(name for equations in modes.values() for name in equations.limits)
    # The pivot first, as with several contacts, whose kernels know it as limit 0.
    return tuple(sorted(names, key=lambda name: name != mode_text.PAINLEVE))


def _contact(equations: mode_text.ModeEquations) -> list[se.Expr]:
    """Return what `contact` gives: forces at the contact, then the channels."""
    return [*equations.contact, *equations.channels.values()]


def _slopes(expressions: Sequence[se.Expr], symbols: Sequence[se.Symbol]) -> Case:
    """Return the derivatives of each expression with respect to each symbol."""
    return [e.diff(symbol) for e in expressions for symbol in symbols]


def _diagram(
    symbols: trace.Symbols, mechanics: dynamics.Mechanics, closed: Callable[[se.Expr], se.Expr]
) -> list[se.Expr]:
    """Return accelerations, normal force, needed friction and power for a given friction force."""
    friction = se.Symbol(f"p{3 * len(symbols.drives)}")
    # With a load factor of 0: the force is given, whatever the load is.
    motion = mechanics.slipping(friction, se.Integer(0))
    _, needed = mechanics.sticking()
    supplied = mechanics.power(motion, symbols.rates)
    return [closed(e) for e in (*motion.accelerations, motion.normal, needed, supplied)]


def _rest(
    symbols: trace.Symbols, modes: Mapping[mode_text.Mode, mode_text.ModeEquations]
) -> list[se.Expr]:
    """Return needed friction, break-away level and normal force for given drive values."""
    if mode_text.Mode.STICK not in modes:
        return [se.Integer(0)] * 3
    _, normal, needed, level = modes[mode_text.Mode.STICK].contact
    return [e.subs(symbols.given) for e in (needed, level, normal)]


def _rest_is_final(
    symbols: trace.Symbols, modes: Mapping[mode_text.Mode, mode_text.ModeEquations]
) -> bool:
    """Whether a held body can only be moved by its drives: nothing else changes in time."""
    if mode_text.Mode.STICK not in modes:
        return False
    stick = modes[mode_text.Mode.STICK]
    still = all(rate == 0 for rate in stick.rates)
    # Guards and forces both: a level that changes with time ends a rest as well as a force does.
    timed = any(symbols.t in e.free_symbols for e in [*stick.guards.values(), *stick.contact])
    return still and not timed
