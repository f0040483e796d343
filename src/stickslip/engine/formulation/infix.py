"""Expressions to statements of infix languages: one printer, what differs as data.

Rules that make tiers agree bit for bit: whole powers are products, constants are printed by `repr`.
A Piecewise becomes an if/else whose branches have a scope of their own, so that nothing of the
branch not taken is evaluated.
"""

import math
from collections.abc import Collection, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any, Final

import symengine as se

from stickslip.engine.formulation.trace import collapsed, rebuilt
from stickslip.engine.kernels.state_layout import NUMBERS
from stickslip.errors import TracingError

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
        found = {e: se.Symbol(f"p{first + i}") for i, e in enumerate(calls)}
        functions = {
            name: {mode: [e.xreplace(found) for e in case] for mode, case in cases.items()}
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
    found: dict[se.Expr, None] = {}
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
            found[e] = None
        else:
            waiting.extend(reversed(e.args))
    return list(found)


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
