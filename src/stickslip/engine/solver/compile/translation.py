"""Program text in LLVM's language: equations and kernels, from the text that the plain tier runs.

Both are written in a small part of Python, in which the type of everything is known: real and whole
numbers, truth values, vectors of reals and of whole numbers, functions with annotations, branches,
loops, and a few functions of `math`. That much is translated here, statement by statement, and
anything else is refused. No rule lets LLVM change a result: sums keep their order, nothing is
fused, and division by zero gives infinity or NaN.
"""

import ast
import math
import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from stickslip.errors import CompilationError

WHOLE, REAL, TRUTH = "i64", "double", "i1"
VECTOR, WHOLES = "vector", "wholes"
"""Kinds of values: numbers by LLVM's names, and vectors, which are a place and a length."""
ELEMENTS = {VECTOR: REAL, WHOLES: WHOLE}
ARITHMETIC: Mapping[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("add", "fadd"),
    ast.Sub: ("sub", "fsub"),
    ast.Mult: ("mul", "fmul"),
    ast.Div: ("", "fdiv"),
    ast.BitAnd: ("and", ""),
    ast.BitOr: ("or", ""),
    ast.BitXor: ("xor", ""),
    ast.LShift: ("shl", ""),
    ast.RShift: ("ashr", ""),
}
"""Operations on whole and on real numbers; what has no word is refused, or translated by itself."""
COMPARISONS: Mapping[type[ast.cmpop], tuple[str, str]] = {
    ast.Eq: ("eq", "oeq"),
    ast.NotEq: ("ne", "une"),
    ast.Lt: ("slt", "olt"),
    ast.LtE: ("sle", "ole"),
    ast.Gt: ("sgt", "ogt"),
    ast.GtE: ("sge", "oge"),
}
ENTRY = "entry.point"
"""Label of the first block of a function, which no parameter can be called."""
FUNCTIONS = {
    "sin": ("llvm.sin.f64", 1),
    "cos": ("llvm.cos.f64", 1),
    "exp": ("llvm.exp.f64", 1),
    "log": ("llvm.log.f64", 1),
    "sqrt": ("llvm.sqrt.f64", 1),
    "tanh": ("tanh", 1),
    "atan": ("atan", 1),
    "log2": ("log2", 1),
    "pow": ("pow", 2),
}
"""What stands for the functions of `math`, and how many numbers they take.

LLVM calls the C library for all of them but the root, which processors have, as Python does. It may
join the sine and cosine of one number, which changes neither, but not put another function in the
place of a power: `pow` is therefore called by its name, and not as an intrinsic."""
DECLARED = {
    **{
        name: f"double @{symbol}({', '.join([REAL] * n)})"
        for name, (symbol, n) in FUNCTIONS.items()
    },
    "fabs": "double @llvm.fabs.f64(double)",
    "ceil": "double @llvm.ceil.f64(double)",
    "to whole": "i64 @llvm.fptosi.sat.i64.f64(double)",
}
CONSTANTS = {"math.inf": math.inf, "math.nan": math.nan}
KEPT = "pow"
LARGEST = 2**63


RARE = "rare"
"""Decorator of functions that are not to be part of those that call them."""


@dataclass(frozen=True)
class Value:
    """Something in LLVM's language."""

    kind: str
    """WHOLE, REAL, TRUTH, VECTOR or WHOLES."""
    text: str
    """A constant, or the name of a result; of a vector, that of its place."""
    length: str = ""
    """Of a vector, its length."""


@dataclass(frozen=True)
class Signature:
    """How a function is called."""

    symbol: str
    """Its name in LLVM's language."""
    parameters: tuple[tuple[str, str], ...]
    """Names and kinds of its parameters."""
    results: tuple[str, ...] = ()
    """Kinds of what it returns, none, one or several."""

    @property
    def result(self) -> str:
        """The type that it returns."""
        if not self.results:
            return "void"
        return self.results[0] if len(self.results) == 1 else f"{{ {', '.join(self.results)} }}"


Meaning: TypeAlias = bool | int | float | tuple[float, ...] | tuple[int, ...] | Signature
"""What a name outside a function stands for."""


@dataclass(frozen=True)
class Function:
    """A function to translate."""

    node: ast.FunctionDef
    """Its definition."""
    signature: Signature
    """How it is called; the definition has the same parameters."""
    meaning: Callable[[str], Meaning | None]
    """What names outside it stand for, those in modules with the name of the module before."""
    title: str
    """Where it stands, for messages."""


def translated(functions: Iterable[Function]) -> str:
    """Return the definitions of functions, and the declarations of what they use."""
    parts, tables, used = [], dict[str, str](), set[str]()
    for function in functions:
        body = _Body(function, tables)
        parts.append(body.text())
        used |= body.used
    constants = [
        f"{name} = private unnamed_addr constant [{words.count(',') + 1} x {words.split()[0]}]"
        f" [{words}]"
        for words, name in tables.items()
    ]
    declared = [
        f"declare {DECLARED[name]} nounwind willreturn memory(none)"
        + (" nobuiltin" if name == KEPT else "")
        for name in sorted(used)
    ]
    return "\n".join([*constants, *parts, *declared, ""])


def exported(name: str, signature: Signature) -> str:
    """Return a function that is seen from outside and calls another with what it is given."""
    taken, given = _parameters(signature), _passed(_arguments(signature))
    call = f"call {signature.result} @{signature.symbol}({given})"
    if signature.result == "void":
        lines = [f"  {call}", "  ret void"]
    else:
        lines = [f"  %r = {call}", f"  ret {signature.result} %r"]
    return "\n".join([f"define {signature.result} @{name}({taken}) nounwind {{", *lines, "}"])


def call_by_address(signature: Signature, passed: Sequence[str]) -> str:
    """Return a function that calls another by an address, the bits of a number in a vector."""
    (vector, _), (place, _) = signature.parameters[:2]
    given = {value.text.removeprefix("%"): value for value in _arguments(signature)}
    return "\n".join(
        [
            f"define internal void @{signature.symbol}({_parameters(signature)}) nounwind {{",
            f"  %where = getelementptr i64, ptr %{vector}, i64 %{place}",
            "  %bits = load i64, ptr %where",
            "  %function = inttoptr i64 %bits to ptr",
            f"  call void %function({_passed(given[name] for name in passed)})",
            "  ret void",
            "}",
        ]
    )


def _type(kind: str) -> str:
    return "ptr" if kind in ELEMENTS else kind


def _kind(number: float) -> str:
    return TRUTH if isinstance(number, bool) else WHOLE if isinstance(number, int) else REAL


def _constant(number: float) -> str:
    if isinstance(number, bool):
        return str(number).lower()
    return (
        str(number) if isinstance(number, int) else f"0x{struct.pack('>d', number).hex().upper()}"
    )


def _parameters(signature: Signature) -> str:
    """Return the parameters of a definition: a vector is a place and a length.

    A function has one vector of whole numbers, and no vector of reals shares memory with it.
    """
    parts = []
    # With two vectors of whole numbers, nothing tells that they do not overlap.
    alone = sum(kind == WHOLES for _, kind in signature.parameters) == 1
    for name, kind in signature.parameters:
        if kind in ELEMENTS:
            parts += [f"ptr {'noalias ' if kind == WHOLES and alone else ''}%{name}"]
            parts += [f"i64 %{name}.length"]
        else:
            parts.append(f"{kind} %{name}")
    return ", ".join(parts)


def _arguments(signature: Signature) -> list[Value]:
    return [Value(kind, f"%{name}", f"%{name}.length") for name, kind in signature.parameters]


def _passed(values: Iterable[Value]) -> str:
    return ", ".join(
        f"ptr {value.text}, i64 {value.length}"
        if value.kind in ELEMENTS
        else f"{value.kind} {value.text}"
        for value in values
    )


def _others(node: ast.FunctionDef) -> list[ast.expr]:
    """Return the decorators of a function beside `backend.rare`."""
    return [
        part for part in node.decorator_list if not (isinstance(part, ast.Name) and part.id == RARE)
    ]


class _Body:
    """The translation of one function.

    Local numbers have places on the stack, which LLVM's first pass turns into values.
    """

    def __init__(self, function: Function, tables: dict[str, str]) -> None:
        node, taken = function.node, function.signature.parameters
        given = node.args
        more = given.posonlyargs, given.kwonlyargs, given.defaults, _others(node)
        self.function = function
        if [a.arg for a in given.args] != [name for name, _ in taken]:
            raise self._refused(node, f"must take ({', '.join(name for name, _ in taken)})")
        if given.vararg or given.kwarg or any(more):
            raise self._refused(node)
        self.used: set[str] = set()
        self._tables = tables
        self._places: list[str] = []
        self._lines: list[str] = []
        self._count = 0
        self._block = ENTRY
        # Labels of the loops around: where to go on, and where to leave.
        self._around: list[tuple[str, str]] = []
        self._kinds: dict[str, str] = {}
        self._vectors: dict[str, Value] = {}

    def text(self) -> str:
        """Return the definition."""
        signature, node = self.function.signature, self.function.node
        names = set[str]()
        for (name, kind), value in zip(signature.parameters, _arguments(signature), strict=True):
            names.add(name)
            if kind in ELEMENTS:
                self._vectors[name] = value
            else:
                self._store_local(name, value, names, node)
        # The end of the body is reached: nothing was returned on some way.
        if self._statements(node.body, names):
            if signature.results:
                raise self._refused(node, "may end without a result")
            self._line("ret void")
        head = (
            f"define internal {signature.result} @{signature.symbol}({_parameters(signature)})"
            f" nounwind{' cold noinline' if node.decorator_list else ''} {{"
        )
        return "\n".join([head, f"{ENTRY}:", *self._places, *self._lines, "}"])

    # --- statements: each returns whether the next one is reached; `names` have values

    def _statements(self, body: Sequence[ast.stmt], names: set[str]) -> bool:
        for i, statement in enumerate(body):
            if not self._statement(statement, names):
                if body[i + 1 :]:
                    # Python would run past it in silence; here it is a mistake in a kernel.
                    raise self._refused(body[i + 1], "is never reached")
                return False
        return True

    def _statement(self, statement: ast.stmt, names: set[str]) -> bool:
        match statement:
            case ast.Expr(value=ast.Constant(value=str())):
                pass
            case ast.Expr(value=ast.Call() as call):
                self._call(call, names)
            case ast.Assign(targets=[target], value=value):
                self._assign(target, value, names)
            case ast.AugAssign(target=target, op=op, value=value):
                left = ast.copy_location(_loaded(target), statement)
                whole = ast.copy_location(ast.BinOp(left, op, value), statement)
                self._assign(target, whole, names)
            case ast.If():
                return self._branch(statement, names)
            case ast.For():
                return self._for(statement, names)
            case ast.While(orelse=[]):
                return self._while(statement, names)
            case ast.Break() | ast.Continue() if self._around:
                self._line(f"br label %{self._around[-1][isinstance(statement, ast.Break)]}")
                return False
            case ast.Return(value=value):
                self._return(value, names, statement)
                return False
            case _:
                raise self._refused(statement)
        return True

    def _assign(self, target: ast.expr, value: ast.expr, names: set[str]) -> None:
        match target:
            case ast.Name(id=name):
                self._store_local(name, self._value(value, names), names, target)
            case ast.Subscript():
                self._store(target, self._value(value, names), names)
            case ast.Tuple(elts=targets):
                values = self._several(value, len(targets), names)
                for node, results in zip(targets, values, strict=True):
                    match node:
                        case ast.Name(id=name):
                            self._store_local(name, results, names, node)
                        case ast.Subscript():
                            self._store(node, results, names)
                        case _:
                            raise self._refused(node)
            case _:
                raise self._refused(target)

    def _several(self, node: ast.expr, count: int, names: set[str]) -> list[Value]:
        """Return the values that stand to the right of several names."""
        match node:
            case ast.Tuple(elts=values) if len(values) == count:
                return [self._value(value, names) for value in values]
            case ast.Call(func=ast.Name(id="divmod"), args=[left, right], keywords=[]) if (
                count == 2
            ):
                words = self._whole(left, names), self._whole(right, names)
                return [self._floored(*words), self._remainder(*words)]
            case ast.Call():
                results = self._called(node, names)
                if len(results) == count:
                    return results
        raise self._refused(node)

    def _store_local(self, name: str, value: Value, names: set[str], node: ast.AST) -> None:
        if value.kind in ELEMENTS:
            if name in self._kinds or self._vectors.get(name, value) != value:
                raise self._refused(node, "is a vector that is named twice")
            self._vectors[name] = value
            names.add(name)
            return
        if name in self._vectors:
            raise self._refused(node, "was a vector")
        kind = self._kinds.get(name)
        if kind is None:
            kind = self._kinds[name] = value.kind
            # In the first block: inside a loop each round would take more of the stack.
            self._places.append(f"  %{name}.place = alloca {kind}")
        if kind == REAL and value.kind == WHOLE:
            value = self._real_of(value)
        if value.kind != kind:
            raise self._refused(node, f"was {_word(kind)} and becomes {_word(value.kind)}")
        self._line(f"store {kind} {value.text}, ptr %{name}.place")
        names.add(name)

    def _store(self, target: ast.Subscript, value: Value, names: set[str]) -> None:
        place, kind = self._place(target, names)
        if kind == REAL:
            value = self._real_of(value)
        elif value.kind == TRUTH:
            value = self._whole_of(value)
        if value.kind != kind:
            raise self._refused(target, f"holds {_word(kind)}")
        self._line(f"store {kind} {value.text}, ptr {place}")

    def _return(self, value: ast.expr | None, names: set[str], node: ast.AST) -> None:
        signature = self.function.signature
        wanted = signature.results
        if value is None or not wanted:
            if value is not None or wanted:
                raise self._refused(node, f"does not return {_words(wanted)}")
            self._line("ret void")
            return
        if len(wanted) == 1:
            results = [self._value(value, names)]
        else:
            results = self._several(value, len(wanted), names)
        results = [
            self._real_of(item) if kind == REAL else item
            for item, kind in zip(results, wanted, strict=True)
        ]
        if tuple(item.kind for item in results) != wanted:
            raise self._refused(node, f"does not return {_words(wanted)}")
        if len(results) == 1:
            self._line(f"ret {wanted[0]} {results[0].text}")
            return
        # A result of several values is built up from an undefined one.
        whole = Value(signature.result, "undef")
        for i, result in enumerate(results):
            text = f"insertvalue {whole.kind} {whole.text}, {result.kind} {result.text}, {i}"
            whole = self._result(signature.result, text)
        self._line(f"ret {whole.kind} {whole.text}")

    def _branch(self, node: ast.If, names: set[str]) -> bool:
        label = self._label()
        condition = self._truth(node.test, names)
        otherwise = "else" if node.orelse else "end"
        self._fork(condition, f"then.{label}", f"{otherwise}.{label}")
        # Names that have a value after a branch are those that have one on all ways that arrive.
        arriving = [] if node.orelse else [set(names)]
        for side, body in (("then", node.body), ("else", node.orelse)):
            if body:
                self._begin(f"{side}.{label}")
                own = set(names)
                if self._statements(body, own):
                    arriving.append(own)
                    self._line(f"br label %end.{label}")
        if arriving:
            self._begin(f"end.{label}")
            names.update(set.intersection(*arriving))
        return bool(arriving)

    def _while(self, node: ast.While, names: set[str]) -> bool:
        label = self._label()
        self._line(f"br label %test.{label}")
        self._begin(f"test.{label}")
        condition = self._truth(node.test, names)
        self._fork(condition, f"loop.{label}", f"done.{label}")
        self._loop(node.body, label, f"test.{label}", set(names))
        self._begin(f"done.{label}")
        match node.test:
            # An endless loop that nothing breaks has no code behind it.
            case ast.Constant(value=True) if not _breaks(node):
                self._line("unreachable")
                return False
        return True

    def _for(self, node: ast.For, names: set[str]) -> bool:
        """Translate a loop over a range, whose ends are found out before it begins."""
        match node:
            case ast.For(
                target=ast.Name(id=name),
                iter=ast.Call(func=ast.Name(id="range"), args=[_, *_] as ends, keywords=[]),
                orelse=[],
            ) if len(ends) <= 3:
                # As in Python, ends are found out before the loop: changing them inside has no
                # effect.
                values = [self._whole(end, names) for end in ends]
            case _:
                raise self._refused(node)
        label, step = self._label(), 1
        if len(values) == 3:
            try:
                step = int(values.pop().text)
            except ValueError:
                step = 0
            if step == 0:
                raise self._refused(node, "needs a constant step")
        start, end = values if len(values) == 2 else (Value(WHOLE, "0"), values[0])
        counter = f"%count.{label}"
        self._places.append(f"  {counter} = alloca i64")
        self._line(f"store i64 {start.text}, ptr {counter}")
        self._line(f"br label %test.{label}")
        self._begin(f"test.{label}")
        at = self._result(WHOLE, f"load i64, ptr {counter}")
        word = "slt" if step > 0 else "sgt"
        more = self._result(TRUTH, f"icmp {word} i64 {{}}, {{}}", at, end)
        self._fork(more.text, f"loop.{label}", f"done.{label}")
        own = set(names)
        self._begin(f"loop.{label}")
        # The loop's name gets its value from the counter, so that assigning to it changes no round.
        self._store_local(name, at, own, node.target)
        self._loop(node.body, label, f"next.{label}", own, begun=True)
        self._begin(f"next.{label}")
        at = self._result(WHOLE, f"load i64, ptr {counter}")
        following = self._result(WHOLE, f"add nsw i64 {{}}, {step}", at)
        self._line(f"store i64 {following.text}, ptr {counter}")
        self._line(f"br label %test.{label}")
        self._begin(f"done.{label}")
        return True

    def _loop(
        self,
        body: Sequence[ast.stmt],
        label: int,
        following: str,
        names: set[str],
        begun: bool = False,
    ) -> None:
        if not begun:
            self._begin(f"loop.{label}")
        self._around.append((following, f"done.{label}"))
        if self._statements(body, names):
            self._line(f"br label %{following}")
        self._around.pop()

    # --- expressions

    def _truth(self, node: ast.expr, names: set[str]) -> str:
        """Return whether an expression holds; a number does if it is not zero."""
        match node:
            case ast.BoolOp(op=op, values=values):
                return self._joined(op, values, names)
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                result = self._truth(operand, names)
                return self._result(TRUTH, f"xor i1 {result}, true").text
            case ast.Compare():
                return self._compared(node, names)
        value = self._value(node, names)
        if value.kind == TRUTH:
            return value.text
        if value.kind == WHOLE:
            return self._result(TRUTH, "icmp ne i64 {}, 0", value).text
        raise self._refused(node, "is no condition")

    def _joined(self, op: ast.boolop, values: Sequence[ast.expr], names: set[str]) -> str:
        """Translate `and` and `or`, which ask no further than they have to."""
        label = self._label()
        # What decides is known at the first part that has that value; later ones are not evaluated.
        decided = "false" if isinstance(op, ast.And) else "true"
        ways = []
        for i, value in enumerate(values):
            result = self._truth(value, names)
            if i == len(values) - 1:
                ways.append(f"[ {result}, %{self._block} ]")
                self._line(f"br label %end.{label}")
                break
            ways.append(f"[ {decided}, %{self._block} ]")
            targets = (f"more.{label}.{i}", f"end.{label}")
            yes, no = targets if isinstance(op, ast.And) else targets[::-1]
            self._fork(result, yes, no)
            self._begin(f"more.{label}.{i}")
        self._begin(f"end.{label}")
        return self._result(TRUTH, f"phi i1 {', '.join(ways)}").text

    def _compared(self, node: ast.Compare, names: set[str]) -> str:
        """Translate a comparison, a chain of them, or a search among constants."""
        match node:
            case ast.Compare(
                left=one, ops=[ast.In() | ast.NotIn() as word], comparators=[ast.Tuple(elts=among)]
            ):
                return self._found(one, word, among, names)
        values = [self._value(node.left, names)]
        values += [self._value(comparator, names) for comparator in node.comparators]
        text = ""
        for op, left, right in zip(node.ops, values, values[1:], strict=False):
            if type(op) not in COMPARISONS or {left.kind, right.kind} & {VECTOR, WHOLES}:
                raise self._refused(node)
            result = self._comparison(op, left, right)
            text = self._result(TRUTH, f"and i1 {text}, {result}").text if text else result
        return text

    def _found(
        self, node: ast.expr, word: ast.cmpop, among: Sequence[ast.expr], names: set[str]
    ) -> str:
        """Return whether a number is one of several, or is none of them."""
        text, value = "false", self._value(node, names)
        for expression in among:
            other = self._value(expression, names)
            if not {value.kind, other.kind} <= {WHOLE, REAL}:
                raise self._refused(expression, "is no number")
            result = self._comparison(ast.Eq(), value, other)
            text = self._result(TRUTH, f"or i1 {text}, {result}").text
        if isinstance(word, ast.NotIn):
            text = self._result(TRUTH, f"xor i1 {text}, true").text
        return text

    def _comparison(self, op: ast.cmpop, left: Value, right: Value) -> str:
        words = COMPARISONS[type(op)]
        # Whole numbers are compared as such: as reals they would lose digits beyond 2^53.
        if left.kind == right.kind != REAL:
            return self._result(TRUTH, f"icmp {words[0]} {left.kind} {{}}, {{}}", left, right).text
        left, right = self._real_of(left), self._real_of(right)
        return self._result(TRUTH, f"fcmp {words[1]} double {{}}, {{}}", left, right).text

    def _value(self, node: ast.expr, names: set[str]) -> Value:
        match node:
            case ast.Constant(value=bool() | int() | float() as number):
                return self._number(number, node)
            case ast.Name() | ast.Attribute(value=ast.Name()):
                return self._named(node, names)
            case ast.Subscript(slice=ast.Slice()):
                return self._slice(node, names)
            case ast.Subscript():
                place, kind = self._place(node, names)
                return self._result(kind, f"load {kind}, ptr {place}")
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return self._negative(operand, names)
            case ast.UnaryOp(op=ast.Invert(), operand=operand):
                return self._result(WHOLE, "xor i64 {}, -1", self._whole(operand, names))
            case ast.UnaryOp(op=ast.Not()) | ast.BoolOp() | ast.Compare():
                return Value(TRUTH, self._truth(node, names))
            case ast.BinOp():
                return self._arithmetic(node, names)
            case ast.IfExp():
                return self._choice(node, names)
            case ast.Call():
                return self._result_of(node, names)
        raise self._refused(node)

    def _result_of(self, node: ast.Call, names: set[str]) -> Value:
        value = self._call(node, names)
        if value is None:
            raise self._refused(node, "has no result")
        return value

    def _number(self, number: float, node: ast.AST) -> Value:
        if isinstance(number, int) and not -LARGEST <= number < LARGEST:
            raise self._refused(node, "is too large")
        return Value(_kind(number), _constant(number))

    def _named(self, node: ast.Name | ast.Attribute, names: set[str]) -> Value:
        name = ast.unparse(node)
        if name in names:
            if name in self._vectors:
                return self._vectors[name]
            kind = self._kinds[name]
            return self._result(kind, f"load {kind}, ptr %{name}.place")
        result = None
        if name.partition(".")[0] not in {*self._kinds, *self._vectors}:
            result = CONSTANTS.get(name, self.function.meaning(name))
        if isinstance(result, tuple):
            return self._table(result)
        if result is None or isinstance(result, Signature):
            raise self._refused(node, "has no value here")
        return self._number(result, node)

    def _table(self, numbers: tuple[float, ...]) -> Value:
        kind = _kind(numbers[0])
        words = ", ".join(f"{kind} {_constant(number)}" for number in numbers)
        # One table for each set of numbers, however many functions read it.
        name = self._tables.setdefault(words, f"@table.{len(self._tables)}")
        return Value(VECTOR if kind == REAL else WHOLES, name, str(len(numbers)))

    def _negative(self, operand: ast.expr, names: set[str]) -> Value:
        value = self._value(operand, names)
        # `fneg` also turns the sign of 0, which 0 - x would not.
        if value.kind == REAL:
            return self._result(REAL, "fneg double {}", value)
        if value.kind == WHOLE and value.text.isdecimal():
            return Value(WHOLE, f"-{value.text}")
        return self._result(WHOLE, "sub i64 0, {}", self._as_whole(value, operand))

    def _arithmetic(self, node: ast.BinOp, names: set[str]) -> Value:
        """Translate a sum or a product, whose terms may be more than functions may call deep."""
        # From the inside out, by a list: generated sums are longer than Python may recurse.
        rest: list[ast.BinOp] = []
        first: ast.expr = node
        while isinstance(first, ast.BinOp):
            rest.append(first)
            first = first.left
        value = self._value(first, names)
        for part in reversed(rest):
            value = self._operation(part, value, self._value(part.right, names))
        return value

    def _operation(self, node: ast.BinOp, left: Value, right: Value) -> Value:
        whole = left.kind == right.kind == WHOLE
        if not {left.kind, right.kind} <= {WHOLE, REAL}:
            raise self._refused(node)
        match node.op:
            case ast.FloorDiv() if whole:
                return self._floored(left, right)
            case ast.Mod() if whole:
                return self._remainder(left, right)
            case ast.Pow() if not whole:
                return self._function("pow", [self._real_of(left), self._real_of(right)])
        words = ARITHMETIC.get(type(node.op), ("", ""))
        if whole and words[0]:
            return self._result(WHOLE, f"{words[0]} i64 {{}}, {{}}", left, right)
        if not words[1]:
            raise self._refused(node)
        left, right = self._real_of(left), self._real_of(right)
        return self._result(REAL, f"{words[1]} double {{}}, {{}}", left, right)

    def _floored(self, left: Value, right: Value) -> Value:
        """Divide whole numbers; the quotient is rounded down, as in Python."""
        # Processors round quotients towards 0.
        quotient = self._result(WHOLE, "sdiv i64 {}, {}", left, right)
        less = self._result(WHOLE, "sub i64 {}, 1", quotient)
        return self._selected(self._rounds_up(left, right), less, quotient)

    def _remainder(self, left: Value, right: Value) -> Value:
        rest = self._result(WHOLE, "srem i64 {}, {}", left, right)
        more = self._result(WHOLE, "add i64 {}, {}", rest, right)
        return self._selected(self._rounds_up(left, right), more, rest)

    def _rounds_up(self, left: Value, right: Value) -> str:
        """Return whether the processor's quotient is above the exact one."""
        rest = self._result(WHOLE, "srem i64 {}, {}", left, right)
        inexact = self._result(TRUTH, "icmp ne i64 {}, 0", rest)
        signs = self._result(WHOLE, "xor i64 {}, {}", rest, right)
        differ = self._result(TRUTH, "icmp slt i64 {}, 0", signs)
        return self._result(TRUTH, "and i1 {}, {}", inexact, differ).text

    def _choice(self, node: ast.IfExp, names: set[str]) -> Value:
        label = self._label()
        condition = self._truth(node.test, names)
        self._fork(condition, f"then.{label}", f"else.{label}")
        result, blocks = [], []
        for side, part in (("then", node.body), ("else", node.orelse)):
            self._begin(f"{side}.{label}")
            result.append(self._value(part, names))
            blocks.append(self._block)
            self._line(f"br label %end.{label}")
        # Both sides have to be of one kind: there is one place for the value.
        if result[0].kind != result[1].kind:
            raise self._refused(node, f"is {_word(result[0].kind)} or {_word(result[1].kind)}")
        self._begin(f"end.{label}")
        return self._met(result, blocks)

    def _met(self, found: Sequence[Value], blocks: Sequence[str]) -> Value:
        """Return the value of the way that was taken."""

        def chosen(kind: str, texts: Iterable[str]) -> str:
            ways = ", ".join(f"[ {t}, %{b} ]" for t, b in zip(texts, blocks, strict=True))
            return self._result(kind, f"phi {kind} {ways}").text

        kind = found[0].kind
        place = chosen(_type(kind), (value.text for value in found))
        if kind in ELEMENTS:
            return Value(kind, place, chosen(WHOLE, (value.length for value in found)))
        return Value(kind, place)

    # --- calls

    def _call(self, node: ast.Call, names: set[str]) -> Value | None:
        match node:
            case ast.Call(keywords=[_, *_]):
                raise self._refused(node)
            case ast.Call(func=ast.Attribute(value=ast.Name(id="math"), attr=name), args=given):
                return self._of_math(name, [self._real(part, names) for part in given], node)
            case ast.Call(func=ast.Name(id="len"), args=[one]):
                value = self._value(one, names)
                if value.kind in ELEMENTS:
                    return Value(WHOLE, value.length)
            case ast.Call(func=ast.Name(id="abs"), args=[one]):
                return self._magnitude(self._value(one, names), one)
            case ast.Call(func=ast.Name(id="int"), args=[one]):
                return self._cut(self._value(one, names))
            case ast.Call(func=ast.Name(id="float"), args=[one]):
                return self._real(one, names)
            case ast.Call(func=ast.Name(id="min" | "max" as name), args=[_, _, *_] as given):
                values = [self._value(expression, names) for expression in given]
                if {value.kind for value in values} <= {WHOLE, REAL}:
                    return self._extreme(name, values)
            case ast.Call(func=ast.Name() | ast.Attribute(value=ast.Name())):
                results = self._called(node, names)
                return results[0] if len(results) == 1 else None
        raise self._refused(node)

    def _called(self, node: ast.Call, names: set[str]) -> list[Value]:
        """Call a function of this or another module; return its results."""
        meaning, called = None, ast.unparse(node.func)
        if called.partition(".")[0] not in names:
            meaning = self.function.meaning(called)
        if not isinstance(meaning, Signature) or node.keywords:
            raise self._refused(node)
        if len(node.args) != len(meaning.parameters):
            raise self._refused(node, f"takes {len(meaning.parameters)} arguments")
        values = []
        for argument, (name, kind) in zip(node.args, meaning.parameters, strict=True):
            value = self._value(argument, names)
            if kind == REAL:
                value = self._real_of(value)
            if value.kind != kind:
                raise self._refused(
                    argument, f"is {_word(value.kind)}, where {name} is {_word(kind)}"
                )
            values.append(value)
        call = f"call {meaning.result} @{meaning.symbol}({_passed(values)})"
        if not meaning.results:
            self._line(call)
            return []
        result = self._result(meaning.result, call)
        if len(meaning.results) == 1:
            return [result]
        return [
            self._result(kind, f"extractvalue {result.kind} {result.text}, {i}")
            for i, kind in enumerate(meaning.results)
        ]

    def _of_math(self, name: str, values: Sequence[Value], node: ast.AST) -> Value:
        match name, values:
            case "isnan", [value]:
                # NaN is the only number that is not equal to itself: unordered with itself.
                return self._result(TRUTH, "fcmp uno double {}, {}", value, value)
            case "ceil", [value]:
                return self._cut(self._function(name, [value]))
        if name in FUNCTIONS and len(values) == FUNCTIONS[name][1]:
            return self._function(name, values)
        raise self._refused(node)

    def _function(self, name: str, values: Sequence[Value]) -> Value:
        self.used.add(name)
        symbol = DECLARED[name].partition("(")[0].replace("double ", "call double ")
        return self._result(REAL, f"{symbol}({_passed(values)})")

    def _magnitude(self, value: Value, node: ast.AST) -> Value:
        if value.kind == REAL:
            return self._function("fabs", [value])
        value = self._as_whole(value, node)
        negative = self._result(WHOLE, "sub i64 0, {}", value)
        below = self._result(TRUTH, "icmp slt i64 {}, 0", value).text
        return self._selected(below, negative, value)

    def _cut(self, value: Value) -> Value:
        """Return a number without what is behind its point."""
        if value.kind != REAL:
            return self._whole_of(value)
        self.used.add("to whole")
        # Saturating: out of range the plain conversion is undefined, and tiers would differ.
        return self._result(WHOLE, "call i64 @llvm.fptosi.sat.i64.f64(double {})", value)

    def _extreme(self, name: str, values: Sequence[Value]) -> Value:
        """Return the least or the greatest: the first one, unless another is beyond it."""
        kind = WHOLE if all(value.kind == WHOLE for value in values) else REAL
        result = values[0] if kind == WHOLE else self._real_of(values[0])
        for value in values[1:]:
            other = value if kind == WHOLE else self._real_of(value)
            # Strictly beyond, as Python compares: of equal numbers, or beside NaN, the first stays.
            op = ast.Lt() if name == "min" else ast.Gt()
            beyond = self._comparison(op, other, result)
            result = self._selected(beyond, other, result)
        return result

    # --- kinds

    def _real(self, node: ast.expr, names: set[str]) -> Value:
        value = self._real_of(self._value(node, names))
        if value.kind != REAL:
            raise self._refused(node, f"is {_word(value.kind)}")
        return value

    def _whole(self, node: ast.expr, names: set[str]) -> Value:
        return self._as_whole(self._value(node, names), node)

    def _as_whole(self, value: Value, node: ast.AST) -> Value:
        if value.kind != WHOLE:
            raise self._refused(node, "is no whole number")
        return value

    def _real_of(self, value: Value) -> Value:
        """Return a number as a real one."""
        if value.kind == TRUTH:
            return self._result(REAL, "uitofp i1 {} to double", value)
        if value.kind != WHOLE:
            return value
        # A constant needs no instruction.
        if value.text.lstrip("-").isdecimal():
            return Value(REAL, _constant(float(value.text)))
        return self._result(REAL, "sitofp i64 {} to double", value)

    def _whole_of(self, value: Value) -> Value:
        """Return a truth value as 0 or 1."""
        if value.kind != TRUTH:
            return value
        return self._result(WHOLE, "zext i1 {} to i64", value)

    # --- places

    def _vector(self, node: ast.expr, names: set[str]) -> Value:
        value = self._value(node, names)
        if value.kind not in ELEMENTS:
            raise self._refused(node, "is no vector")
        return value

    def _place(self, node: ast.Subscript, names: set[str]) -> tuple[str, str]:
        vector = self._vector(node.value, names)
        return self._within(vector, self._whole(node.slice, names)), ELEMENTS[vector.kind]

    def _within(self, vector: Value, index: Value) -> str:
        text = f"getelementptr {ELEMENTS[vector.kind]}, ptr {vector.text}, i64 {{}}"
        return self._result("ptr", text, index).text

    def _slice(self, node: ast.Subscript, names: set[str]) -> Value:
        """Return a part of a vector, which is only read: a list would be copied."""
        match node:
            case ast.Subscript(value=of, slice=ast.Slice(lower=lower, upper=upper, step=None)) if (
                lower is not None and upper is not None
            ):
                vector = self._vector(of, names)
                first, end = self._whole(lower, names), self._whole(upper, names)
                length = self._result(WHOLE, "sub i64 {}, {}", end, first).text
                return Value(vector.kind, self._within(vector, first), length)
        raise self._refused(node)

    # --- lines

    def _fork(self, condition: str, yes: str, no: str) -> None:
        self._line(f"br i1 {condition}, label %{yes}, label %{no}")

    def _selected(self, condition: str, yes: Value, no: Value) -> Value:
        kind = yes.kind
        return self._result(kind, f"select i1 {condition}, {kind} {{}}, {kind} {{}}", yes, no)

    def _refused(
        self, node: ast.AST, reason: str = "is outside the subset that is compiled"
    ) -> CompilationError:
        shown = ast.unparse(node).partition("\n")[0]
        line = getattr(node, "lineno", 0)
        return CompilationError(f"{self.function.title}, line {line}: {shown!r} {reason}.")

    def _result(self, kind: str, text: str, *values: Value) -> Value:
        self._count += 1
        name = f"%.{self._count}"
        words = [value.text for value in values]
        self._line(f"{name} = {text.format(*words) if words else text}")
        return Value(kind, name)

    def _label(self) -> int:
        self._count += 1
        return self._count

    def _begin(self, block: str) -> None:
        self._lines.append(f"{block}:")
        self._block = block

    def _line(self, text: str) -> None:
        self._lines.append(f"  {text}")


def _loaded(target: ast.expr) -> ast.expr:
    """Return what is assigned to as something that is read."""
    match target:
        case ast.Name(id=name):
            return ast.Name(name, ast.Load())
        case ast.Subscript(value=value, slice=where):
            return ast.Subscript(value, where, ast.Load())
    return target


def _breaks(loop: ast.While) -> bool:
    """Whether anything within a loop may break it off, or another one inside."""
    return any(isinstance(node, ast.Break) for node in ast.walk(loop))


def _word(kind: str) -> str:
    words = {WHOLE: "a whole number", REAL: "a real number", TRUTH: "a truth value"}
    return words.get(kind, "a vector")


def _words(kinds: Sequence[str]) -> str:
    return " and ".join(map(_word, kinds)) or "nothing"
