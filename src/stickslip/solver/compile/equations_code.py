"""Machine code of a model's equations: made by LLVM in a tenth of a second, from the plain text."""

import ast
import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import final

from typing_extensions import override

from stickslip.errors import CompilationError
from stickslip.formulation import Model
from stickslip.kernels.equations import CALLED, LAW, LAW_MARGIN_SLOPES, LAW_MARGINS, LAW_SLOPES_OF
from stickslip.solver.compile.image_cache import name_of
from stickslip.solver.compile.object_code import ObjectCode, maker
from stickslip.solver.compile.translation import (
    REAL,
    VECTOR,
    WHOLE,
    Function,
    Signature,
    translated,
)

ENTRY = "equations"
"""The function that calls the others by their numbers; no other is seen from outside."""
LAW_FUNCTIONS = {
    re.compile(r"law_(\d+)"): LAW,
    re.compile(r"law_margins_(\d+)"): LAW_MARGINS,
    re.compile(r"law_slopes_(\d+)"): LAW_SLOPES_OF,
    re.compile(r"law_margin_slopes_(\d+)"): LAW_MARGIN_SLOPES,
}
"""Names of the functions of laws, one for each structure, and the number of the first."""
TAKEN = (
    ("mode", WHOLE),
    ("flags", WHOLE),
    ("t", REAL),
    ("w", VECTOR),
    ("at", WHOLE),
    ("to", WHOLE),
)


@final
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
    @override
    def title(self) -> str:
        return self.pair

    @property
    @override
    def name(self) -> str:
        return name_of("\n".join([maker(), repr(self.numbers), self.program]))

    @property
    @override
    def symbols(self) -> Sequence[str]:
        return (ENTRY,)

    @property
    @override
    def seconds(self) -> float:
        return 0.1

    @property
    def address(self) -> int:
        """Address of a C function of (number, mode, flags, t, w, size, at, to)."""
        return self.addresses[ENTRY]

    @override
    def text(self) -> str:
        functions = []
        for node in ast.parse(self.program).body:
            if not isinstance(node, ast.FunctionDef):
                shown = ast.unparse(node).partition("\n")[0]
                raise CompilationError(f"equations, line {node.lineno}: {shown!r} is no function.")
            signature = Signature(f"f.{node.name}", TAKEN)
            functions.append(Function(node, signature, _nothing, "equations"))
        return "\n".join([translated(functions), *_chosen(dict(self.numbers))])


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
    found = {name: i for i, name in enumerate(CALLED)}
    for numbers, start in LAW_FUNCTIONS.items():
        found |= {
            match[0]: start + int(match[1])
            for name in model.sizes.lengths()
            if (match := numbers.fullmatch(name))
        }
    return {name: number for name, number in found.items() if f"def {name}(" in model.text}


@functools.lru_cache(maxsize=256)
def code_of(model: Model) -> EquationsCode:
    """Return the machine code of a model's equations, which may have yet to be made."""
    return EquationsCode(model.title, model.text, tuple(numbered(model).items()))
