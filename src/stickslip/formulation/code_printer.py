"""Expressions to program text.

One printer for Python, in the subset that `solver.compile.translation` knows. Rules that make tiers
agree bit for bit: whole powers are products, constants are printed by `repr`, functions come from
`math` alone. A Piecewise becomes an if/else whose branches have a scope of their own, so that
nothing of the branch not taken is evaluated.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import symengine as se

from stickslip.formulation.trace import collapsed, has_switch
from stickslip.kernels.state_layout import NUMBERS

__all__ = ["Case", "function"]

Case = Sequence[se.Expr]
"""The expressions that one case of a function writes, in order."""

INDENT = "    "
FEW_ZEROS = 3
"""More zeros than this are stored by a loop."""
NAMED = {
    "sin": "math.sin",
    "cos": "math.cos",
    "tanh": "math.tanh",
    "atan": "math.atan",
    "log": "math.log",
}


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
        body = _Body(depth)
        expressions = [collapsed(e) for e in case]
        body.unpack(expressions)
        body.write(body.scope(expressions))
        body.line("return")
        lines += body.lines
    return "\n".join(lines) + "\n"


class _Body:
    """The statements of one function body."""

    def __init__(self, depth: int) -> None:
        self.lines: list[str] = []
        self.depth = depth
        self.count = 0

    def line(self, text: str) -> None:
        self.lines.append(INDENT * self.depth + text)

    def fresh(self) -> str:
        self.count += 1
        return f"c{self.count}"

    def unpack(self, expressions: Sequence[se.Expr]) -> None:
        """Load the elements of y and p that occur into local names."""
        names = {str(s) for e in expressions for s in e.free_symbols}
        for name in sorted(names, key=lambda n: (n[0], len(n), n)):
            if name[0] in "yp" and name[1:].isdigit():
                place = NUMBERS + int(name[1:]) if name[0] == "p" else f"at + {name[1:]}"
                self.line(f"{name} = w[{place}]")

    def write(self, texts: Sequence[str]) -> None:
        """Store the results; where most are zero, zeros first."""
        zeros = texts.count("0.0")
        if zeros > FEW_ZEROS:
            self.line(f"for i in range({len(texts)}):")
            self.line(f"{INDENT}w[to + i] = 0.0")
        for index, text in enumerate(texts):
            if zeros <= FEW_ZEROS or text != "0.0":
                self.line(f"w[to + {index}] = {text}")

    def scope(self, expressions: Sequence[se.Expr]) -> list[str]:
        """Write what the expressions need and return their texts."""
        lifted: dict[str, tuple[str, se.Piecewise]] = {}
        flat = [_lift(e, lifted, self) for e in expressions]
        for name, piecewise in lifted.values():
            self._branch(name, piecewise)
        shared, reduced = se.cse(flat)
        names: dict[str, str] = {}
        for symbol, value in shared:
            text = self.text(value, names)
            names[str(symbol)] = self.fresh()
            self.line(f"{names[str(symbol)]} = {text}")
        return [self.text(e, names) for e in reduced]

    def _branch(self, name: str, piecewise: se.Piecewise) -> None:
        yes, condition, no, _ = piecewise.args
        self.line(f"if {self._condition(condition)}:")
        for value, closing in ((yes, "else:"), (no, "")):
            self.depth += 1
            (text,) = self.scope([value])
            self.line(f"{name} = {text}")
            self.depth -= 1
            if closing:
                self.line(closing)

    def _condition(self, condition: se.Basic) -> str:
        low, high = condition.args
        flag = str(high)
        if flag[0] == "s" and flag[1:].isdigit():
            return f"flags & {1 << int(flag[1:])}"
        (left, right) = self.scope([low, high])
        return f"{left} < {right}"

    def text(self, e: se.Expr, names: Mapping[str, str]) -> str:
        """Return the text of an expression; a temporary is written first where one is needed."""
        if e.is_Symbol:
            return names.get(str(e), str(e))
        if e.is_Number:
            return repr(float(e))
        if e.is_Add:
            terms = [self.text(term, names) for term in e.args]
            return terms[0] + "".join(
                f" - {term[1:]}" if term.startswith("-") else f" + {term}" for term in terms[1:]
            )
        if e.is_Mul:
            return self._product(e, names)
        if e.is_Pow:
            return self._power(e, names)
        return f"{NAMED[type(e).__name__.lower()]}({self.text(e.args[0], names)})"

    def _factor(self, e: se.Expr, names: Mapping[str, str]) -> str:
        text = self.text(e, names)
        return f"({text})" if e.is_Add or text.startswith("-") else text

    def _product(self, e: se.Expr, names: Mapping[str, str]) -> str:
        above, below, sign = [], [], ""
        for factor in e.args:
            if factor == -1:
                sign = "-"
            elif factor.is_Number and factor < 0:
                sign = "-"
                above.append(repr(-float(factor)))
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
            return f"math.exp({self.text(exponent, names)})"
        if _negative(exponent):
            return f"1.0/({self.text(base**-exponent, names)})"
        if exponent == se.Rational(1, 2):
            return f"math.sqrt({self.text(base, names)})"
        if not exponent.is_Integer:
            return f"math.pow({self.text(base, names)}, {self.text(exponent, names)})"
        text = self.text(base, names)
        if not base.is_Symbol:
            name = self.fresh()
            self.line(f"{name} = {text}")
            text = name
        return "(" + "*".join([text] * int(exponent)) + ")"


def _negative(exponent: se.Expr) -> bool:
    return bool(exponent.is_Number and exponent < 0)


def _lift(e: se.Expr, lifted: dict[str, tuple[str, se.Piecewise]], body: _Body) -> se.Expr:
    """Replace the outermost Piecewise parts by names."""
    if isinstance(e, se.Piecewise):
        key = str(e)
        if key not in lifted:
            lifted[key] = (body.fresh(), e)
        return se.Symbol(lifted[key][0])
    if not e.args or not has_switch(e):
        return e
    return e.func(*[_lift(part, lifted, body) for part in e.args])
