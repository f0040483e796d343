"""Programs that are compiled: the equations of a model, and the kernels that all models share.

Equations are text already, a function for each thing that kernels ask. They are translated together
and called through one function, by number and address, so that kernels know no model.

Kernels are translated from the modules of `stickslip.engine.kernels` as they stand: from the
entries all functions are followed that one of them names, and their annotations say what everything
is. They are one file, compiled once on a machine. The name of a file is a hash of all that decides
what is in it: program, numbers of functions, sources of the translation, version of llvmlite, and
the processor; so no file is ever wrong, and an old one is never found.

From Python a kernel is a C function. Arrays are checked, as a wrong one would be written over: each
becomes the address of its numbers, and their count.
"""

import ast
import ctypes
import functools
import inspect
import re
import sys
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import FunctionType, ModuleType, SimpleNamespace
from typing import Any

import numpy as np

from stickslip.engine import kernels
from stickslip.engine.formulation import Model
from stickslip.engine.kernels import backend, entries, equations
from stickslip.engine.kernels.backend import IntVector, Vector
from stickslip.engine.solver.compile import translation
from stickslip.engine.solver.compile.object_code import ObjectCode, maker, name_of
from stickslip.errors import CompilationError

# Machine code of a model's equations: made by LLVM in a tenth of a second, from the plain text.

ENTRY = "equations"
"""The function that calls the others by their numbers; no other is seen from outside."""
LAW_FUNCTIONS = {
    re.compile(r"law_(\d+)"): equations.LAW,
    re.compile(r"law_margins_(\d+)"): equations.LAW_MARGINS,
    re.compile(r"law_slopes_(\d+)"): equations.LAW_SLOPES_OF,
    re.compile(r"law_margin_slopes_(\d+)"): equations.LAW_MARGIN_SLOPES,
}
"""Names of the functions of laws, one for each structure, and the number of the first."""
TAKEN = (
    ("mode", translation.WHOLE),
    ("flags", translation.WHOLE),
    ("t", translation.REAL),
    ("w", translation.VECTOR),
    ("at", translation.WHOLE),
    ("to", translation.WHOLE),
)


@dataclass(frozen=True)
class EquationsCode(ObjectCode):
    """Machine code of the equations of a mechanism with a law, whatever their parameters."""

    pair: str = field(compare=False)
    """Mechanism and law in words."""
    program: str
    """Program text of the functions."""
    numbers: tuple[tuple[str, int], ...]
    """Names of the functions that are called, and their numbers."""

    @property
    def title(self) -> str:
        return self.pair

    @property
    def name(self) -> str:
        return name_of("\n".join([maker(), repr(self.numbers), self.program]))

    @property
    def symbols(self) -> Sequence[str]:
        return (ENTRY,)

    @property
    def seconds(self) -> float:
        return 0.1

    @property
    def address(self) -> int:
        """Address of a C function of (number, mode, flags, t, w, size, at, to)."""
        return self.addresses[ENTRY]

    def text(self) -> str:
        functions = []
        for node in ast.parse(self.program).body:
            if not isinstance(node, ast.FunctionDef):
                shown = ast.unparse(node).partition("\n")[0]
                raise CompilationError(f"equations, line {node.lineno}: {shown!r} is no function.")
            signature = translation.Signature(f"f.{node.name}", TAKEN)
            functions.append(translation.Function(node, signature, _nothing, "equations"))
        return "\n".join([translation.translated(functions), *_chosen(dict(self.numbers))])


def _nothing(_name: str) -> None:
    """Say that no name outside a function stands for anything."""


def _chosen(numbers: dict[str, int]) -> list[str]:
    """Return a function that calls the others by their number; others do nothing."""
    given = "i64 %mode, i64 %flags, double %t, ptr %w, i64 %w.length, i64 %at, i64 %to"
    lines = [f"define void @{ENTRY}(i64 %name, {given}) nounwind {{"]
    cases = " ".join(f"i64 {number}, label %is.{number}" for number in numbers.values())
    lines.append(f"  switch i64 %name, label %none [{cases}]")
    for name, number in numbers.items():
        lines += [f"is.{number}:", f"  tail call void @f.{name}({given})", "  ret void"]
    return [*lines, "none:", "  ret void", "}"]


@functools.lru_cache(maxsize=256)
def numbered(model: Model) -> dict[str, int]:
    """Return the numbers by which kernels call the functions of a model's equations."""
    result = {name: i for i, name in enumerate(equations.CALLED)}
    for numbers, start in LAW_FUNCTIONS.items():
        result |= {
            match[0]: start + int(match[1])
            for name in model.sizes.lengths()
            if (match := numbers.fullmatch(name))
        }
    return {name: number for name, number in result.items() if f"def {name}(" in model.text}


@functools.lru_cache(maxsize=256)
def code_of(model: Model) -> EquationsCode:
    """Return the machine code of a model's equations, which may have yet to be made."""
    return EquationsCode(model.title, model.text, tuple(numbered(model).items()))


# Machine code of the kernels, which all mechanisms and laws share: one file on a machine.
#
# Functions are translated from the modules of `stickslip.engine.kernels` as they stand, those that
# the entries reach; their annotations say what everything is.

KINDS: dict[Any, str] = {
    Vector: translation.VECTOR,
    IntVector: translation.WHOLES,
    float: translation.REAL,
    int: translation.WHOLE,
    bool: translation.TRUTH,
}
"""Kinds of values by their annotations."""
CALLED_BY_ADDRESS = {
    backend.call_model: ("name", "mode", "flags", "t", "w", "at", "to"),
    backend.call_contacts: ("name", "t", "w", "iw", "at", "to"),
}
"""What is called by an address in a vector, and what it is given."""
NUMBERS: Mapping[str, Any] = {translation.REAL: ctypes.c_double, translation.WHOLE: ctypes.c_int64}
ARRAYS = {translation.VECTOR: np.dtype(np.float64), translation.WHOLES: np.dtype(np.int64)}
PLACE = ctypes.c_char * 0
"""What stands at the start of any memory that may be written."""
SECONDS = 6.0


@dataclass(frozen=True)
class KernelsCode(ObjectCode):
    """Machine code of the kernels."""

    @property
    def title(self) -> str:
        return "the solver"

    @property
    def name(self) -> str:
        return _name()

    @property
    def symbols(self) -> Sequence[str]:
        return entries.__all__

    @property
    def seconds(self) -> float:
        return SECONDS

    def text(self) -> str:
        functions = [function_of(function) for function in _reached()]
        called = [
            translation.call_by_address(signature_of(function), order)
            for function, order in CALLED_BY_ADDRESS.items()
        ]
        outside = [
            translation.exported(name, signature_of(getattr(entries, name)))
            for name in self.symbols
        ]
        return "\n".join([translation.translated(functions), *called, *outside])

    def functions(self) -> SimpleNamespace:
        """Return the entries as Python functions of arrays, once they are ready."""
        return SimpleNamespace(
            **{
                name: as_function(address, signature_of(getattr(entries, name)))
                for name, address in self.addresses.items()
            }
        )


KERNELS = KernelsCode()
"""Those of this version."""


@functools.cache
def _name() -> str:
    """Return the name of the file: a hash of the text of all kernels."""
    folder = Path(kernels.__file__).parent
    # What translates them counts as well.
    sources = [path.read_text("utf-8") for path in (Path(__file__), *sorted(folder.rglob("*.py")))]
    return name_of("\n".join([maker(), *sources]))


def _reached() -> list[FunctionType]:
    """Return the functions that the entries call, directly or not."""
    result = dict[FunctionType, None]()
    waiting = [getattr(entries, name) for name in entries.__all__]
    while waiting:
        function = waiting.pop()
        if (
            function not in result
            and function not in CALLED_BY_ADDRESS
            and function is not backend.rare
        ):
            result[function] = None
            waiting += _callees(function)
    return list(result)


def _callees(function: FunctionType) -> Iterator[FunctionType]:
    for node in ast.walk(_definition(function)):
        if isinstance(node, ast.Name | ast.Attribute):
            other = _outside(function, ast.unparse(node))
            if isinstance(other, FunctionType):
                yield other


def _outside(function: FunctionType, name: str) -> object:
    """Return what a name outside a function stands for, which may be one in a module."""
    module, _, last = name.rpartition(".")
    if not module:
        return function.__globals__.get(last)
    result = function.__globals__.get(module)
    return getattr(result, last, None) if isinstance(result, ModuleType) else None


@functools.cache
def _definitions(module: str) -> Mapping[str, ast.FunctionDef]:
    tree = ast.parse(inspect.getsource(sys.modules[module]))
    return {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}


def _definition(function: FunctionType) -> ast.FunctionDef:
    return _definitions(function.__module__)[function.__name__]


@functools.cache
def signature_of(function: FunctionType) -> translation.Signature:
    """Return how a kernel is called, from its annotations."""
    # not from the source: to parse it takes longer than to load the machine code
    kinds, code = function.__annotations__, function.__code__
    place = function.__module__.removeprefix(f"{kernels.__name__}.")
    names = code.co_varnames[: code.co_argcount]
    taken = tuple((name, _kind(kinds.get(name), function)) for name in names)
    return translation.Signature(f"{place}.{function.__name__}", taken, _results(function))


def _results(function: FunctionType) -> tuple[str, ...]:
    returned: Any = function.__annotations__.get("return", "")
    kinds = () if returned is None else (returned,)
    if typing.get_origin(returned) is tuple:
        kinds = typing.get_args(returned)
    return tuple(_kind(kind, function) for kind in kinds)


def _kind(annotation: object, function: FunctionType) -> str:
    if annotation in KINDS:
        return KINDS[annotation]
    shown = repr(annotation) if annotation else "nothing"
    raise CompilationError(
        f"{function.__module__}.{function.__name__}: {shown} is no annotation that is compiled."
    )


def function_of(function: FunctionType) -> translation.Function:
    """Return a kernel as it is translated, with what the names in it stand for."""

    def meaning(name: str) -> translation.Meaning | None:
        result = _outside(function, name)
        if isinstance(result, FunctionType):
            return signature_of(result)
        return result if isinstance(result, bool | int | float | tuple) else None

    title = f"{function.__module__}.{function.__name__}"
    return translation.Function(_definition(function), signature_of(function), meaning, title)


def as_function(address: int, signature: translation.Signature) -> Callable[..., Any]:
    """Return machine code as a function of arrays and numbers, which are checked."""
    kinds = [kind for _, kind in signature.parameters]
    types: list[Any] = []
    for kind in kinds:
        types += [NUMBERS[kind]] if kind in NUMBERS else [ctypes.c_void_p, ctypes.c_int64]
    result = NUMBERS[signature.results[0]] if signature.results else None
    bare = ctypes.CFUNCTYPE(result, *types)(address)
    wanted = [(name, ARRAYS.get(kind)) for name, kind in signature.parameters]
    # Looked up once, and not in each call.
    from_buffer, addressof = PLACE.from_buffer, ctypes.addressof

    def call(*arguments: Any) -> Any:
        given: list[Any] = []
        for argument, (name, dtype) in zip(arguments, wanted, strict=True):
            if dtype is None:
                given.append(argument)
                continue
            try:
                place = from_buffer(argument)
                fits = argument.dtype == dtype and argument.ndim == 1
            except (TypeError, ValueError, BufferError):  # not writable, or with gaps
                fits = False
            if not fits:
                raise TypeError(
                    f"{signature.symbol}: {name} must be a writable array of {dtype} in one row."
                )
            given += addressof(place), len(argument)
        return bare(*given)

    return call
