"""Expressions to program text.

One printer for Python, in the subset that `solver.compile.translation` knows: functions come from
`math` alone.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import symengine as se

from stickslip.formulation.infix import INDENT, Block, Syntax
from stickslip.formulation.trace import collapsed
from stickslip.kernels.state_layout import NUMBERS

__all__ = ["Case", "function"]

Case = Sequence[se.Expr]
"""The expressions that one case of a function writes, in order."""

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


def function(name: str, cases: Mapping[Any, Case]) -> str:
    """Return the text of a function that reads the vector ``w`` and writes expressions to it.

    Symbols y0, y1, ... stand at the place ``at`` and after it, p0, p1, ... at NUMBERS and after
    it; the results go to the place ``to`` and after it.

    Parameters
    ----------
    name : str
        Name of the function.
    cases : mapping
        Expressions by the value of ``mode``; the single key None if there is no such choice.

    Returns
    -------
    str
        Text of the definition, which ends with a line break.
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
