"""The text of generated modules: one model's equations, and the kernels for numba.

Both tiers have the same functions. In the plain one the kernels are the modules of
`stickslip.kernels` as they stand, and vectors are lists. In the compiled one all of them are one
module, which is compiled once for all equations and calls them by their address; the equations are
translated from the text of the plain tier (`translation`).
"""

import ast
import functools
import importlib
import inspect
import pkgutil
import platform
import re
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

from stickslip import kernels
from stickslip.formulation import Model
from stickslip.kernels.equations import (
    CALLED,
    LAW,
    LAW_MARGIN_SLOPES,
    LAW_MARGINS,
    LAW_SLOPES_OF,
)

__all__ = ["contacts_text", "kernels_text", "numbered", "plain_text"]

FIRST = ("state_layout", "enums")
"""Modules of the kernels whose constants others build on."""
PYTHON = ("backend", "entries", "header")
"""Modules that differ between the tiers, or that only Python runs."""
LAW_FUNCTIONS = {
    re.compile(r"law_(\d+)"): LAW,
    re.compile(r"law_margins_(\d+)"): LAW_MARGINS,
    re.compile(r"law_slopes_(\d+)"): LAW_SLOPES_OF,
    re.compile(r"law_margin_slopes_(\d+)"): LAW_MARGIN_SLOPES,
}
"""Names of the functions of laws, one for each structure, and the number of the first."""
KEPT = "run"
"""The one kernel with a file of its own, beside the entries: those of ensembles build on it."""
DEFINITION = re.compile(r"^def (\w+)", re.MULTILINE)
ENTRIES = """
@kept
def enter_run(w, whole, table, bounds, t_end, rtol, cap, limit, log, events):
    return run(pointer(w), pointer(whole), table, bounds, t_end, rtol, cap, limit, log, events)


@kept
def enter_play(log, count, times, table, w, whole, states, forces, rows):
    play(log, count, times, table, pointer(w), pointer(whole), states, forces, rows)


@kept
def enter_batch(
    count, columns, places, base, tables, bounds, caps, outputs, arguments, t_end, rtol, limit,
    w, whole, log, events, results, statuses, evidence
):
    batch(
        count, columns, places, base, tables, bounds, caps, outputs, arguments, t_end, rtol, limit,
        pointer(w), pointer(whole), log, events, results, statuses, evidence
    )


@kept
def enter_batch_sensed(
    count, columns, places, base, tables, bounds, caps, outputs, arguments, t_end, rtol, limit,
    w, whole, log, events, results, statuses, evidence, starts, slopes, own, q, gradients
):
    batch_sensed(
        count, columns, places, base, tables, bounds, caps, outputs, arguments, t_end, rtol, limit,
        pointer(w), pointer(whole), log, events, results, statuses, evidence, starts, slopes, own,
        q, gradients
    )


@kept
def enter_sense(log, count, events, number, times, table, dtable, own, q, w, whole, out):
    sense(
        log, count, events, number, times, table, dtable, own, q, pointer(w), pointer(whole), out
    )
"""
CONTACTS = """
from numba import cfunc

SIGNATURE = types.void(
    types.int64, types.float64, types.CPointer(types.float64), types.CPointer(types.int64),
    types.int64, types.int64
)


@cfunc(SIGNATURE, cache=True)
def contacts(name, t, w, whole, at, to):
    answer(name, t, w, whole, at, to)
"""


def _modules() -> list[ModuleType]:
    """Return all modules of the kernels, those first on which others build."""
    prefix = f"{kernels.__name__}."
    names = [found.name for found in pkgutil.walk_packages(kernels.__path__, prefix)]
    own = [name for name in names if name.removeprefix(prefix) not in PYTHON]
    order = {prefix + name: i for i, name in enumerate(FIRST)}
    own.sort(key=lambda name: (order.get(name, len(order)), name))
    return [importlib.import_module(name) for name in own]


@functools.cache
def _body(kernel: ModuleType) -> str:
    """Return a kernel's text without its imports, annotations, docstrings and list of names.

    Statements stand as they are in the file: to write them anew from the syntax tree would take as
    long as loading the machine code.
    """
    source = inspect.getsource(kernel)
    lines = source.splitlines()
    kept = []
    for node in ast.parse(source).body:
        names = [t.id for t in getattr(node, "targets", []) if isinstance(t, ast.Name)]
        is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        skipped = (ast.Import, ast.ImportFrom, ast.AnnAssign)
        if isinstance(node, skipped) or "__all__" in names or is_text:
            continue
        first = node.lineno
        if isinstance(node, ast.FunctionDef):
            arguments = ", ".join(argument.arg for argument in node.args.args)
            kept.append(f"def {node.name}({arguments}):")
            first = node.body[1 if ast.get_docstring(node) else 0].lineno
        kept += [*lines[first - 1 : node.end_lineno], "", ""]
    return "\n".join(kept)


@functools.cache
def _head(compiled: bool) -> str:
    """Return the first lines; versions that a compiled file depends on so enter its hash."""
    origin = f"Generated by stickslip {version('stickslip')}"
    if compiled:
        others = ", ".join(f"{name} {version(name)}" for name in ("numba", "numpy"))
        origin += f" for {others}, Python {platform.python_version()}"
    return f'"""{origin}."""\n\nimport math\n'


def _marked(text: str) -> str:
    """Put every function under the decorator of its tier."""
    marked = DEFINITION.sub(r"@jit\ndef \1", text)
    return marked.replace(f"@jit\ndef {KEPT}(", f"@kept\ndef {KEPT}(")


def _joined(*parts: str) -> str:
    return "\n\n".join(parts) + "\n"


@functools.lru_cache(maxsize=256)
def plain_text(model: Model) -> str:
    """Return the text of the plain module of a model's equations."""
    return _joined(_head(False), model.text)


@functools.cache
def kernels_text() -> str:
    """Return the text of the compiled kernels."""
    return _joined(_compiled_kernels(), ENTRIES)


@functools.cache
def contacts_text() -> str:
    """Return the text of what works out the equations of several contacts, as one function."""
    return _joined(_compiled_kernels(), CONTACTS)


def _compiled_kernels() -> str:
    before = Path(__file__).with_name("numba_prelude.py").read_text("utf-8")
    text = _marked(_joined(*(_body(kernel) for kernel in _modules())))
    return _joined(_head(True), before, text)


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
