"""Machine code that integrates the states of a law along a motion, for many copies of it."""

import ast
import dataclasses
import functools
import itertools
from collections.abc import Hashable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.kernels import states
from stickslip.engine.solver.compile.object_code import ObjectCode, maker, name_of
from stickslip.engine.solver.compile.programs import as_function, function_of, signature_of
from stickslip.engine.solver.compile.translation import Function, exported, translated
from stickslip.errors import CompilationError, not_finite
from stickslip.friction import FrictionLaw, bound
from stickslip.quantities import shadow, structure, unchecked

Array = NDArray[np.float64]

STEP = ("h", "v", "n")
"""What a step has beside contact inputs: duration, velocity and load."""
FORMULA, RATES = "by_formula", "by_rates"
"""Entries: of laws whose states move by a formula, and of those with one state that do not."""


def states_along(law: FrictionLaw, motion: Array, inputs: tuple[str, ...], start: Array) -> Any:
    """Return states (b, steps + 1, copies) along a motion; None of laws that are not compiled.

    Parameters of the law may be arrays (copies,). The motion (steps, 3 + inputs) has duration [s],
    velocity [m/s], load [N] and contact inputs of each step; the states begin with (b, copies).
    """
    code = _code_of(_Shape(law, inputs))
    if code is None:
        return None
    code.load()
    states, copies = start.shape
    steps, columns = motion.shape
    out = np.zeros((states, steps + 1, copies))
    out[:, 0] = start
    table = np.empty((copies, len(code.paths)))
    for k, path in enumerate(code.paths):
        table[:, k] = getattr(law, path)
    # Room for the step, parameters, states and flags of one copy.
    size = columns + len(code.paths) + states + code.flags
    sizes = (columns, len(code.paths), *((states, code.flags) if code.entry == FORMULA else ()))
    given = (motion.ravel(), table.ravel(), out.ravel(), np.zeros(size))
    code.function(*sizes, steps, copies, *map(np.ascontiguousarray, given))
    return out


class _Shape:
    """A law by what shapes its equations: its parameters may be arrays, which have no hash."""

    __slots__ = ("inputs", "key", "law")

    def __init__(self, law: FrictionLaw, inputs: tuple[str, ...]) -> None:
        self.law, self.inputs = law, inputs
        self.key: Hashable = (structure(_scalars(law)), inputs)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Shape) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


def _scalars(law: FrictionLaw) -> FrictionLaw:
    """Return a law with one number for each array."""
    values = {entry.name: getattr(law, entry.name) for entry in dataclasses.fields(law)}
    arrays = {name: float(x.flat[0]) for name, x in values.items() if isinstance(x, np.ndarray)}
    return unchecked(type(law), **values | arrays)


@functools.lru_cache(maxsize=256)
def _code_of(shape: _Shape) -> "StatesCode | None":
    """Return the machine code of a law; None of one whose equations are not written down so."""
    law, paths = shape.law, list[str]()
    lines = _Lines()

    def symbol(path: str) -> "Written":
        if path[1:] not in paths:
            paths.append(path[1:])
        return Written(f"p_{path[1:]}", lines)

    try:
        own: Any = shadow(_scalars(law), "", symbol)
        h, v, n = (Written(name, lines) for name in STEP)
        own = bound(own, {name: Written(f"x_{name}", lines) for name in shape.inputs})
        z = tuple(Written(f"z{i}", lines) for i in range(len(law.states)))
        output = own.moved(v, n, z, h)
        entry = RATES if output is None else FORMULA
        # The entry for rates integrates one state.
        if output is None and len(z) > 1:
            return None
        output = own.rates(v, n, z) if output is None else output
        results = [lines.word(value) for value in output]
    except (TypeError, ValueError, ArithmeticError, AttributeError, CompilationError):
        # Equations of others may ask of numbers what no program can do: they run in NumPy.
        return None
    names = [*STEP, *(f"x_{name}" for name in shape.inputs), *(f"p_{path}" for path in paths)]
    reads = [f"{name} = w[{i}]" for i, name in enumerate(names)]
    at, flags = len(names), lines.latches
    if entry == RATES:
        body = [*reads, "z0 = z", *lines.written, f"return {results[0]}"]
        head = "def rate(z, w):"
    else:
        reads += [f"z{i} = w[{at + i}]" for i in range(len(z))]
        places = [at + len(z) + k for k in range(len(flags))]
        reads += [f"f{k} = w[{place}] > 0.0" for k, place in enumerate(places)]
        turned = [
            f"w[{place}] = {hold} >= 0.0 and ({margin} > 0.0 or (f{k} and {hold} > 0.0))"
            for k, (place, (margin, hold)) in enumerate(zip(places, flags, strict=True))
        ]
        # Latches turn last: all of a step sees the sides on which it began.
        body = [*reads, *lines.written]
        body += [f"w[{at + i}] = {result}" for i, result in enumerate(results)]
        body += [line.replace(" = ", " = 1.0 if ", 1) + " else 0.0" for line in turned]
        head = "def move(w):"
    program = "\n    ".join([head, *body])
    return StatesCode(law.name, entry, program, tuple(paths), len(flags))


@dataclass(frozen=True)
class StatesCode(ObjectCode):
    """Machine code of the states of a law along a motion."""

    law: str = field(compare=False)
    """Its name."""
    entry: str
    """Which way of stepping it needs."""
    program: str
    """Program text of its own equations."""
    paths: tuple[str, ...]
    """Its parameters, in the order in which the program reads them."""
    flags: int
    """Its latched switches."""

    @property
    def title(self) -> str:
        return f"the states of {self.law}"

    @property
    def name(self) -> str:
        return name_of("\n".join([maker(), _steps_text(), self.entry, self.program]))

    @property
    def symbols(self) -> tuple[str, ...]:
        return (self.entry,)

    @property
    def seconds(self) -> float:
        return 0.1

    def text(self) -> str:
        own = states.move if self.entry == FORMULA else states.rate
        (node,) = ast.parse(self.program).body
        assert isinstance(node, ast.FunctionDef)
        steps: list[Any] = [states.by_formula]
        if self.entry == RATES:
            steps = [states.by_rates, states.stepped, states.held_back]
        functions = [Function(node, signature_of(own), lambda _: None, self.title)]
        functions += [function_of(step) for step in steps]
        return f"{translated(functions)}\n{exported(self.entry, signature_of(steps[0]))}"

    @functools.cached_property
    def function(self) -> Any:
        """The entry as a function of numbers and arrays, once it is ready."""
        called = getattr(states, self.entry)
        return as_function(self.addresses[self.entry], signature_of(called))


@functools.cache
def _steps_text() -> str:
    """Return what decides on the steps: their text, with that of what compiles them."""
    return "\n".join(Path(name).read_text("utf-8") for name in (states.__file__, __file__))


class _Lines:
    """The lines of a program that numbers write while a law's equations run on them."""

    def __init__(self) -> None:
        self.written: list[str] = []
        self.latches: list[tuple[str, str]] = []
        self._known: dict[str, str] = {}
        self._numbers = itertools.count()

    def word(self, value: Any) -> str:
        """Return what stands for a number in an expression."""
        if isinstance(value, Written):
            return value.text
        number = float(value)
        if not np.isfinite(number):
            raise CompilationError(not_finite(value))
        return repr(number)

    def new(self, text: str) -> "Written":
        """Return the result of an expression, which is computed once."""
        if text not in self._known:
            name = f"t{next(self._numbers)}"
            self.written.append(f"{name} = {text}")
            self._known[text] = name
        return Written(self._known[text], self)


class Written:
    """A number of a program: each operation on it writes a line.

    Sums keep the order in which a law has them, so that results are those of NumPy.

    Parameters
    ----------
    text : str
        Its name.
    lines : _Lines
        The program.
    """

    __slots__ = ("lines", "text")
    __array_ufunc__ = None  # NumPy leaves mixed operations to us

    def __init__(self, text: str, lines: _Lines) -> None:
        self.text, self.lines = text, lines

    def _of(self, text: str, *values: Any) -> "Written":
        return self.lines.new(text.format(*map(self.lines.word, values)))

    def __add__(self, other: Any) -> "Written":
        return self._of("{} + {}", self, other)

    def __radd__(self, other: Any) -> "Written":
        return self._of("{} + {}", other, self)

    def __sub__(self, other: Any) -> "Written":
        return self._of("{} - {}", self, other)

    def __rsub__(self, other: Any) -> "Written":
        return self._of("{} - {}", other, self)

    def __mul__(self, other: Any) -> "Written":
        return self._of("{} * {}", self, other)

    def __rmul__(self, other: Any) -> "Written":
        return self._of("{} * {}", other, self)

    def __truediv__(self, other: Any) -> "Written":
        return self._of("{} / {}", self, other)

    def __rtruediv__(self, other: Any) -> "Written":
        return self._of("{} / {}", other, self)

    def __neg__(self) -> "Written":
        return self._of("-{}", self)

    def __pos__(self) -> "Written":
        return self

    def __abs__(self) -> "Written":
        return self._of("abs({})", self)

    def __pow__(self, exponent: Any) -> "Written":
        if float(exponent) == 2.0:  # as NumPy squares: the same bits
            return self * self
        return self._of("math.pow({}, {})", self, exponent)

    def __gt__(self, other: Any) -> "Written":
        return self._of("{} > {}", self, other)

    def __ge__(self, other: Any) -> "Written":
        return self._of("{} >= {}", self, other)

    def __lt__(self, other: Any) -> "Written":
        return self._of("{} < {}", self, other)

    def __le__(self, other: Any) -> "Written":
        return self._of("{} <= {}", self, other)

    def __bool__(self) -> bool:
        raise TypeError("a number of a program has no truth value")

    def __float__(self) -> float:
        raise TypeError("a number of a program is not known")

    def __maths__(self, name: str, *given: Any) -> "Written":
        """Serve the functions of `stickslip.maths`."""
        match name, given:
            case "where", (yes, no, *_):
                return self._of("{1} if {0} else {2}", self, yes, no)
            case "sign", (x,):
                return self._of("1.0 if {0} > 0.0 else (-1.0 if {0} < 0.0 else {0} * 0.0)", x)
            case "power", (base, exponent):
                return self._of("{}", self._power(base, exponent))
            case "latched", (margin, hold, yes, no):
                latches = self.lines.latches
                latches.append((self.lines.word(margin), self.lines.word(hold)))
                return self._of(f"{{}} if f{len(latches) - 1} else {{}}", yes, no)
        return self._of(f"math.{name}({{}})", *given)

    def _power(self, base: Any, exponent: Any) -> Any:
        if isinstance(exponent, (int, float)) and float(exponent).is_integer():
            return base**exponent
        return self._of("math.pow({0}, {1}) if {0} > 0.0 else 0.0", base, exponent)
