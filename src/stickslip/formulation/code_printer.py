"""Expressions to program text.

One printer for Python, in the subset that `solver.compile.translation` knows: functions come from
`math` alone.
"""

from collections.abc import Collection, Mapping, Sequence, Set
from typing import Any, Final

import symengine as se

from stickslip.formulation.infix import INDENT, Block, Syntax
from stickslip.formulation.trace import collapsed
from stickslip.kernels.state_layout import NUMBERS

Case = Sequence[se.Expr]
"""The expressions that one case of a function writes, in order."""

Cases = Mapping[Any, Case]
"""Cases of a function by the value of ``mode``; the single key None if there is no such choice."""

CONSTANTS: Final = "constants"
"""Name of the function that writes what the others need of parameters alone."""

FEW_ZEROS = 3
"""More zeros than this are stored by a loop."""
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
        found = {e: se.Symbol(f"p{first + i}") for i, e in enumerate(calls)}
        functions = {
            name: {mode: [e.xreplace(found) for e in case] for mode, case in cases.items()}
            for name, cases in functions.items()
        }
        functions[CONSTANTS] = {None: calls}
    texts = [function(name, cases) for name, cases in functions.items()]
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


def function(name: str, cases: Cases) -> str:
    """Return the text of a function that reads the vector ``w`` and writes expressions to it.

    Symbols y0, y1, ... stand at the place ``at`` and after it, p0, p1, ... at NUMBERS and after
    it; the results go to the place ``to`` and after it.
    """
    lines = [f"def {name}(mode, flags, t, w, at, to):"]
    for mode, case in cases.items():
        depth = 1
        if mode is not None:
            lines.append(f"{INDENT}if mode == {mode}:")
            depth = 2
        block = Block(PYTHON, depth)
        expressions = [collapsed(e) for e in case]
        _unpack(block, expressions)
        _write(block, block.scope(expressions))
        block.line("return")
        lines += block.lines
    return "\n".join(lines) + "\n"


def _unpack(block: Block, expressions: Sequence[se.Expr]) -> None:
    """Load the elements of y and p that occur into local names."""
    names = {str(s) for e in expressions for s in e.free_symbols}
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
