"""Equations in LLVM's language, from the very text that the plain tier runs.

The printer of equations (`formulation.code_printer`) uses little of Python: functions of whole and
real numbers, places of the vector ``w``, products and sums, a few functions of `math`, branches,
and loops that store zeros. That much is translated here, statement by statement, and anything else
is refused. No rule lets LLVM change a result: sums keep their order, nothing is fused, and division
by zero gives infinity or NaN.
"""

import ast
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NoReturn, final

from stickslip.errors import CompilationError

__all__ = ["ENTRY", "translated"]

ENTRY = "equations"
"""The function that calls the others by their numbers; no other is seen from outside."""
WHOLE, REAL = "i64", "double"
VECTOR = "w"
ARGUMENTS = {"mode": WHOLE, "flags": WHOLE, "t": REAL, "at": WHOLE, "to": WHOLE}
NAMES = ["mode", "flags", "t", VECTOR, "at", "to"]
TAKEN = "i64 %name, i64 %mode, i64 %flags, double %t, ptr %w, i64 %at, i64 %to"
ARITHMETIC: Mapping[type[ast.operator], str] = {
    ast.Add: "fadd",
    ast.Sub: "fsub",
    ast.Mult: "fmul",
    ast.Div: "fdiv",
}
FUNCTIONS = {
    "sin": ("llvm.sin.f64", 1),
    "cos": ("llvm.cos.f64", 1),
    "exp": ("llvm.exp.f64", 1),
    "log": ("llvm.log.f64", 1),
    "sqrt": ("llvm.sqrt.f64", 1),
    "tanh": ("tanh", 1),
    "atan": ("atan", 1),
    "pow": ("pow", 2),
}
"""What stands for the functions of `math`, and how many numbers they take.

LLVM calls the C library for all of them but the root, which processors have, as Python does. It may
join the sine and cosine of one number, which changes neither, but not put another function in the
place of a power: `pow` is therefore called by its name, and not as an intrinsic."""
DECLARED = "declare double @{}({}) nounwind willreturn memory(none){}"
KEPT = " nobuiltin"
LARGEST = 2**63


@dataclass(frozen=True)
class Value:
    """A number in LLVM's language."""

    kind: str
    """WHOLE or REAL."""
    text: str
    """A constant, or the name of a result."""


Names = dict[str, Value]


def translated(text: str, numbers: Mapping[str, int]) -> str:
    """Return the text of a module for LLVM with one function, which calls others by number.

    Parameters
    ----------
    text : str
        Program text of the functions.
    numbers : mapping of str to int
        Names of those that can be called, and their numbers. A number that is none of these does
        nothing.

    Returns
    -------
    str
        The module, which says nothing of a processor.

    Raises
    ------
    CompilationError
        If the text has anything that the printer of equations does not use.
    """
    parts, used = [], set[str]()
    for node in ast.parse(text).body:
        if not isinstance(node, ast.FunctionDef):
            _refuse(node)
        function = _Function(node)
        parts.append(function.text())
        used |= function.used
    declared = [_declaration(name) for name in sorted(used)]
    return "\n".join([*parts, _entry(numbers), *declared, ""])


def _declaration(name: str) -> str:
    symbol, count = FUNCTIONS[name]
    return DECLARED.format(symbol, ", ".join([REAL] * count), KEPT if name == "pow" else "")


def _entry(numbers: Mapping[str, int]) -> str:
    """Return the function that calls the others; it passes on what it was given."""
    lines = [f"define void @{ENTRY}({TAKEN}) nounwind {{"]
    cases = " ".join(f"i64 {number}, label %is.{number}" for number in numbers.values())
    lines.append(f"  switch i64 %name, label %none [{cases}]")
    for name, number in numbers.items():
        lines += [f"is.{number}:", f"  tail call void @f.{name}({TAKEN})", "  ret void"]
    return "\n".join([*lines, "none:", "  ret void", "}"])


def _refuse(node: ast.AST, reason: str = "is outside the subset that is compiled") -> NoReturn:
    shown = ast.unparse(node).partition("\n")[0]
    line = getattr(node, "lineno", 0)
    raise CompilationError(f"equations, line {line}: {shown!r} {reason}.")


@final
class _Function:
    """The translation of one function.

    Local names stand for values and never for places, so that LLVM has nothing left to find out;
    where branches join, each name that both assign gets the value of the branch taken.
    """

    def __init__(self, node: ast.FunctionDef) -> None:
        given = node.args
        more = given.posonlyargs, given.kwonlyargs, given.defaults, node.decorator_list
        names = [argument.arg for argument in given.args]
        if names != NAMES or given.vararg or given.kwarg or any(more):
            _refuse(node, f"must take ({', '.join(NAMES)})")
        self.node = node
        self.used: set[str] = set()
        self._lines: list[str] = []
        self._count = 0
        self._block = "start"

    def text(self) -> str:
        """Return the definition."""
        names = {name: Value(kind, f"%{name}") for name, kind in ARGUMENTS.items()}
        if self._statements(self.node.body, names):
            self._line("ret void")
        head = f"define internal void @f.{self.node.name}({TAKEN}) nounwind {{"
        return "\n".join([head, "start:", *self._lines, "}"])

    # --- statements: each returns whether the next one is reached

    def _statements(self, body: Sequence[ast.stmt], names: Names) -> bool:
        for i, statement in enumerate(body):
            match statement:
                case ast.Assign(targets=[ast.Name(id=name)], value=value) if name not in NAMES:
                    names[name] = self._real(value, names)
                case ast.Assign(targets=[ast.Subscript() as target], value=value):
                    self._store(target, value, names)
                case ast.If():
                    if not self._branch(statement, names):
                        return self._ends(body[i + 1 :])
                case ast.For():
                    self._loop(statement, names)
                case ast.Return(value=None):
                    self._line("ret void")
                    return self._ends(body[i + 1 :])
                case _:
                    _refuse(statement)
        return True

    def _ends(self, rest: Sequence[ast.stmt]) -> bool:
        if rest:
            _refuse(rest[0], "is never reached")
        return False

    def _store(self, target: ast.Subscript, value: ast.expr, names: Names) -> None:
        number = self._real(value, names)
        self._line(f"store double {number.text}, ptr {self._place(target, names)}")

    def _branch(self, node: ast.If, names: Names) -> bool:
        label = self._label()
        condition = self._condition(node.test, names)
        otherwise = "else" if node.orelse else "end"
        self._line(f"br i1 {condition}, label %then.{label}, label %{otherwise}.{label}")
        arriving: list[tuple[str, Names]] = [] if node.orelse else [(self._block, dict(names))]
        for side, body in (("then", node.body), ("else", node.orelse)):
            if body:
                self._begin(f"{side}.{label}")
                own = dict(names)
                if self._statements(body, own):
                    arriving.append((self._block, own))
                    self._line(f"br label %end.{label}")
        if arriving:
            self._begin(f"end.{label}")
            self._join(arriving, names)
        return bool(arriving)

    def _join(self, arriving: Sequence[tuple[str, Names]], names: Names) -> None:
        """Let names have the values that they have in all branches that arrive here."""
        first = arriving[0][1]
        names.clear()
        for name in first:
            values = [(own[name], block) for block, own in arriving if name in own]
            if len(values) < len(arriving):
                continue
            if len({value for value, _ in values}) == 1:
                names[name] = first[name]
                continue
            choice = ", ".join(f"[ {value.text}, %{block} ]" for value, block in values)
            names[name] = self._result(REAL, f"phi double {choice}")

    def _loop(self, node: ast.For, names: Names) -> None:
        """Translate a loop over whole numbers from 0, which does nothing but store."""
        match node:
            case ast.For(
                target=ast.Name(id=name),
                iter=ast.Call(
                    func=ast.Name(id="range"), args=[ast.Constant(value=int(count))], keywords=[]
                ),
                orelse=[],
            ) if name not in NAMES and not isinstance(count, bool):
                pass
            case _:
                _refuse(node)
        if any(not isinstance(statement, ast.Assign) for statement in node.body) or count < 1:
            _refuse(node)
        label, before = self._label(), self._block
        self._line(f"br label %loop.{label}")
        self._begin(f"loop.{label}")
        index = f"%i.{label}"
        self._line(f"{index} = phi i64 [ 0, %{before} ], [ %n.{label}, %loop.{label} ]")
        for statement in node.body:
            match statement:
                case ast.Assign(targets=[ast.Subscript() as target], value=value):
                    self._store(target, value, {**names, name: Value(WHOLE, index)})
                case _:
                    _refuse(statement)
        self._line(f"%n.{label} = add i64 {index}, 1")
        self._line(f"%more.{label} = icmp slt i64 %n.{label}, {count}")
        self._line(f"br i1 %more.{label}, label %loop.{label}, label %done.{label}")
        self._begin(f"done.{label}")

    # --- expressions

    def _condition(self, node: ast.expr, names: Names) -> str:
        match node:
            case ast.Compare(left=left, ops=[ast.Eq()], comparators=[right]):
                words = self._whole(left, names), self._whole(right, names)
                return self._result("", "icmp eq i64 {}, {}", *words).text
            case ast.Compare(left=left, ops=[ast.Lt()], comparators=[right]):
                words = self._real(left, names), self._real(right, names)
                return self._result("", "fcmp olt double {}, {}", *words).text
            case ast.BinOp(left=left, op=ast.BitAnd(), right=right):
                words = self._whole(left, names), self._whole(right, names)
                return self._result(
                    "", "icmp ne i64 {}, 0", self._result(WHOLE, "and i64 {}, {}", *words)
                ).text
        _refuse(node)

    def _real(self, node: ast.expr, names: Names) -> Value:
        match node:
            case ast.Constant(value=float(number)):
                return Value(REAL, f"0x{struct.pack('>d', number).hex().upper()}")
            case ast.Name():
                return self._named(node, names, REAL)
            case ast.Subscript():
                return self._result(REAL, f"load double, ptr {self._place(node, names)}")
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return self._result(REAL, "fneg double {}", self._real(operand, names))
            case ast.BinOp():
                return self._arithmetic(node, names)
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id="math"), attr=name),
                args=arguments,
                keywords=[],
            ) if name in FUNCTIONS and len(arguments) == FUNCTIONS[name][1]:
                values = [self._real(argument, names) for argument in arguments]
                self.used.add(name)
                given = ", ".join(f"double {value.text}" for value in values)
                return self._result(REAL, f"call double @{FUNCTIONS[name][0]}({given})")
        _refuse(node)

    def _arithmetic(self, node: ast.BinOp, names: Names) -> Value:
        """Translate a sum or a product, whose terms may be more than functions may call deep."""
        rest: list[ast.BinOp] = []
        first: ast.expr = node
        while isinstance(first, ast.BinOp):
            if type(first.op) not in ARITHMETIC:
                _refuse(first)
            rest.append(first)
            first = first.left
        value = self._real(first, names)
        for part in reversed(rest):
            operation = f"{ARITHMETIC[type(part.op)]} double {{}}, {{}}"
            value = self._result(REAL, operation, value, self._real(part.right, names))
        return value

    def _whole(self, node: ast.expr, names: Names) -> Value:
        match node:
            case ast.Constant(value=int(number)) if not isinstance(number, bool):
                if number >= LARGEST:
                    _refuse(node, "is too large")
                return Value(WHOLE, str(number))
            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int())):
                return Value(WHOLE, f"-{self._whole(node.operand, names).text}")
            case ast.Name():
                return self._named(node, names, WHOLE)
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                words = self._whole(left, names), self._whole(right, names)
                return self._result(WHOLE, "add i64 {}, {}", *words)
        _refuse(node)

    def _named(self, node: ast.Name, names: Names, kind: str) -> Value:
        value = names.get(node.id)
        if value is None:
            _refuse(node, "has no value here")
        if value.kind != kind:
            _refuse(node, "is a whole number" if kind == REAL else "is no whole number")
        return value

    def _place(self, node: ast.Subscript, names: Names) -> str:
        if not (isinstance(node.value, ast.Name) and node.value.id == VECTOR):
            _refuse(node)
        place = self._whole(node.slice, names)
        return self._result("", "getelementptr double, ptr %w, i64 {}", place).text

    # --- lines

    def _result(self, kind: str, text: str, *values: Value) -> Value:
        self._count += 1
        name = f"%v{self._count}"
        self._line(f"{name} = {text.format(*(value.text for value in values))}")
        return Value(kind, name)

    def _label(self) -> int:
        self._count += 1
        return self._count

    def _begin(self, block: str) -> None:
        self._lines.append(f"{block}:")
        self._block = block

    def _line(self, text: str) -> None:
        self._lines.append(f"  {text}")
