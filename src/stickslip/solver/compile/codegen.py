"""The text of generated modules: one model's equations, and the kernels for the compiled tier.

Both tiers have the same functions. In the plain one the kernels are the modules of
`stickslip.kernels` as they stand, and vectors are lists. In the compiled one all of them are one
module, which is compiled once for all equations and calls them by their address.
"""

import ast
import functools
import inspect
import platform
import re
from importlib.metadata import version
from pathlib import Path
from types import ModuleType
from typing import Any

from stickslip.formulation import Model
from stickslip.kernels import (
    batch,
    bernstein,
    dense_evaluation,
    dense_output,
    dop853,
    dop853_tableau,
    drive_segments,
    driver,
    enums,
    equations,
    error_scale,
    gauss_legendre,
    guard_roots,
    hard_stops,
    itp,
    linear_events,
    lu,
    mode_transitions,
    model_interface,
    radau_tableau,
    reducers,
    rodas5p,
    rodas5p_tableau,
    sensitivities,
    state_layout,
    step,
    step_log,
    stepper_selection,
    taylor_series,
)
from stickslip.kernels.equations import CALLED, LAW, LAW_MARGINS

__all__ = ["equations_text", "kernels_text", "numbered", "plain_text"]

KERNELS = (
    enums,
    state_layout,
    equations,
    model_interface,
    dense_output,
    hard_stops,
    mode_transitions,
    error_scale,
    dop853_tableau,
    dop853,
    lu,
    rodas5p_tableau,
    rodas5p,
    taylor_series,
    itp,
    guard_roots,
    bernstein,
    linear_events,
    drive_segments,
    stepper_selection,
    step,
    gauss_legendre,
    step_log,
    driver,
    dense_evaluation,
    reducers,
    radau_tableau,
    sensitivities,
    batch,
)
LAW_FUNCTION = re.compile(r"law_(\d+)")
MARGINS_FUNCTION = re.compile(r"law_margins_(\d+)")
"""Names of the functions of laws, one for each structure."""
KEPT = "run"
"""The one kernel with a file of its own, beside the entries: those of ensembles build on it."""
DEFINITION = re.compile(r"^def (\w+)", re.MULTILINE)
ENTRIES = """
enter_run = run
enter_play = play
enter_batch = batch
enter_sense = sense
enter_batch_sensed = batch_sensed
"""
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
EQUATIONS = """
from numba import cfunc, njit, types

jit = njit(nogil=True, error_model="numpy")
SIGNATURE = types.void(
    types.int64, types.int64, types.int64, types.float64, types.CPointer(types.float64),
    types.int64, types.int64
)
"""


@functools.cache
def _body(kernel: ModuleType) -> str:
    """Return a kernel's text without its imports, docstring and list of names."""
    tree = ast.parse(inspect.getsource(kernel))
    kept = []
    for node in tree.body:
        names = [t.id for t in getattr(node, "targets", []) if isinstance(t, ast.Name)]
        is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        skipped = (ast.Import, ast.ImportFrom, ast.AnnAssign)
        if isinstance(node, skipped) or "__all__" in names or is_text:
            continue
        kept.append(_bare(node))
    return "\n\n".join(ast.unparse(node) for node in kept)


def _bare(node: Any) -> Any:
    """Drop annotations and docstrings, which the module has no use for."""
    if isinstance(node, ast.FunctionDef):
        node.returns = None
        for argument in node.args.args:
            argument.annotation = None
        node.body = node.body[1:] if ast.get_docstring(node) else node.body
    return node


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
    before = Path(__file__).with_name("numba_prelude.py").read_text("utf-8")
    kernels = _marked(_joined(*(_body(kernel) for kernel in KERNELS)))
    return _joined(_head(True), before, kernels, ENTRIES)


@functools.lru_cache(maxsize=256)
def numbered(model: Model) -> dict[str, int]:
    """Return the numbers by which kernels call the functions of a model's equations."""
    found = {name: i for i, name in enumerate(CALLED)}
    for start, numbers in ((LAW, LAW_FUNCTION), (LAW_MARGINS, MARGINS_FUNCTION)):
        found |= {
            match[0]: start + int(match[1])
            for name in model.sizes.lengths()
            if (match := numbers.fullmatch(name))
        }
    return {name: number for name, number in found.items() if f"def {name}(" in model.text}


@functools.lru_cache(maxsize=256)
def equations_text(model: Model) -> str:
    """Return the text of the compiled equations of a model: one function that knows their names."""
    lines = ["@cfunc(SIGNATURE, cache=True)", "def equations(name, mode, flags, t, w, at, to):"]
    for name, i in numbered(model).items():
        lines += [f"    if name == {i}:", f"        {name}(mode, flags, t, w, at, to)"]
    return _joined(_head(True), EQUATIONS, _marked(model.text), "\n".join(lines))
