"""The text of generated modules: one model's equations, the kernels, and the tiers' differences.

Both tiers have the same functions. In the plain one they are together in one module, vectors are
lists, and arithmetic errors become NaN. In the compiled one the kernels serve all equations of the
same shape, and call them by their address: a further law compiles in a second.
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
    backend,
    batch,
    bernstein,
    dense_evaluation,
    dense_output,
    dop853,
    dop853_tableau,
    drive_segments,
    driver,
    enums,
    error_scale,
    gauss_legendre,
    guard_roots,
    hard_stops,
    itp,
    linear_events,
    lu,
    mode_transitions,
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

__all__ = ["equations_text", "kernels_text", "module_text"]

AFTER_MODEL = (
    enums,
    state_layout,
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
CALLED = (
    "field",
    "jacobian",
    "time_slope",
    "guards",
    "guard_slopes",
    "linear",
    "contact",
    "power",
    "margins",
    "rest",
    "energy",
    "field_slopes",
    "guard_parameters",
    "walls",
)
"""Functions of the equations that the kernels call."""
KEPT = "run"
"""The one kernel with a file of its own, beside the entries: those of ensembles build on it."""
PLAIN = """
def jit(function):
    return function
"""
DEFINITION = re.compile(r"^def (\w+)", re.MULTILINE)
FENCE = '''
def fenced(function, size):
    """Turn arithmetic errors into NaN, as compiled code does."""

    def guarded(mode, flags, t, w, at, to):
        try:
            function(mode, flags, t, w, at, to)
        except (ArithmeticError, ValueError):
            for i in range(to, to + size):
                w[i] = math.nan

    return guarded


field = fenced(field, N_STATES)
jacobian = fenced(jacobian, N_STATES * N_STATES)
time_slope = fenced(time_slope, N_STATES)
guards = fenced(guards, N_GUARDS)
guard_slopes = fenced(guard_slopes, N_GUARDS * (N_STATES + 1))
linear = fenced(linear, 1)
contact = fenced(contact, 4)
power = fenced(power, 2)
energy = fenced(energy, 1)
margins = fenced(margins, N_SWITCHES)
diagram = fenced(diagram, N_COORDINATES + 2)
rest = fenced(rest, 3)
walls = fenced(walls, N_WALLS * (3 + N_COORDINATES))
'''
FENCED_SLOPES = """
field_slopes = fenced(field_slopes, N_STATES * QUANTITIES)
guard_parameters = fenced(guard_parameters, N_GUARDS * QUANTITIES)
"""
PLAIN_ENTRIES = """
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
def enter_play(log, count, times, table, w, states, forces, rows):
    play(log, count, times, table, pointer(w), states, forces, rows)


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
def enter_sense(log, count, events, number, times, table, dtable, own, q, w, out):
    sense(log, count, events, number, times, table, dtable, own, q, pointer(w), out)
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
def _kernels() -> str:
    return "\n\n".join(_body(kernel) for kernel in AFTER_MODEL)


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
def module_text(model: Model) -> str:
    """Return the text of the plain module of a model: its equations and the kernels."""
    fence = FENCE + (FENCED_SLOPES if "\nQUANTITIES" in model.text else "")
    parts = (PLAIN, _body(backend), model.shape, model.text, fence, _kernels(), PLAIN_ENTRIES)
    return _joined(_head(False), *parts)


@functools.lru_cache(maxsize=64)
def kernels_text(shape: str) -> str:
    """Return the text of the compiled kernels for all equations of a shape."""
    calls = [
        f"def {name}(mode, flags, t, w, at, to):\n"
        f"    call_model(w, ADDRESS, {i}, mode, flags, t, at, to)"
        for i, name in enumerate(CALLED)
    ]
    before = Path(__file__).with_name("numba_prelude.py").read_text("utf-8")
    kernels = _marked(_joined(*calls, _kernels()))
    return _joined(_head(True), before, shape, kernels, ENTRIES)


@functools.lru_cache(maxsize=256)
def equations_text(model: Model) -> str:
    """Return the text of the compiled equations of a model: one function that knows their names."""
    lines = ["@cfunc(SIGNATURE, cache=True)", "def equations(name, mode, flags, t, w, at, to):"]
    named = [(i, name) for i, name in enumerate(CALLED) if f"def {name}(" in model.text]
    for i, name in named:
        lines += [f"    if name == {i}:", f"        {name}(mode, flags, t, w, at, to)"]
    return _joined(_head(True), EQUATIONS, _marked(model.text), "\n".join(lines))
