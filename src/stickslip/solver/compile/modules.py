"""Loads the two tiers of a model: its plain equations, or machine code for them."""

import functools
import linecache
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from stickslip.formulation import Model
from stickslip.kernels import entries
from stickslip.solver.compile.codegen import numbered, plain_text
from stickslip.solver.compile.equations_code import code_of
from stickslip.solver.compile.image_cache import name_of
from stickslip.solver.compile.kernels_code import KERNELS
from stickslip.solver.compile.messages import notice

Equation: TypeAlias = Callable[[int, int, float, Any, int, int], None]


@dataclass(frozen=True)
class Tier:
    """One tier of a model."""

    kernels: Any
    """The kernels: `stickslip.kernels.entries`, or machine code of the same functions."""
    equations: Any
    """The equations: functions by their number, or the address of the compiled ones."""
    contacts: Any
    """What works out the equations of several contacts, or its address."""


@functools.lru_cache(maxsize=256)
def plain_equations(model: Model) -> Mapping[str, Equation]:
    """Return the equations of a model by name, as functions in plain Python.

    Arithmetic errors give NaN, as they do in compiled code.
    """
    text = plain_text(model)
    place = f"<{name_of(text)}>"
    linecache.cache[place] = len(text), None, text.splitlines(keepends=True), place  # for debuggers
    module: dict[str, Any] = {}
    exec(compile(text, place, "exec", dont_inherit=True), module)
    return {
        name: _fenced(module[name], length)
        for name, length in model.sizes.lengths().items()
        if name in module
    }


def _fenced(function: Equation, length: int) -> Equation:
    """Turn arithmetic errors into NaN, as compiled code does."""

    def guarded(mode: int, flags: int, t: float, w: Any, at: int, to: int) -> None:
        try:
            function(mode, flags, t, w, at, to)
        except (ArithmeticError, ValueError):
            for i in range(to, to + length):
                w[i] = math.nan

    return guarded


@functools.lru_cache(maxsize=256)
def load(model: Model) -> Tier:
    """Return the plain tier of a model."""
    functions = plain_equations(model)
    numbers = numbered(model)
    known = {numbers[name]: own for name, own in functions.items() if name in numbers}
    return Tier(entries, known, entries.enter_contacts)


@functools.lru_cache(maxsize=256)
def load_compiled(model: Model) -> Tier:
    """Return the compiled tier of a model.

    The first process of all compiles the kernels, which takes some seconds; equations take
    hundredths of a second.
    """
    waiting()
    KERNELS.load()
    equations = code_of(model)
    equations.load()
    return Tier(_entries(), equations.address, KERNELS.addresses["enter_contacts"])


def object_files(model: Model, *, common: bool) -> dict[str, bytes]:
    """Return the machine code of a model and of the kernels as files that a linker takes."""
    waiting(common=common)
    return {
        "kernels.o": KERNELS.image(common=common),
        "equations.o": code_of(model).image(common=common),
    }


@functools.cache
def _entries() -> Any:
    return KERNELS.functions()


def is_loaded(model: Model) -> bool:
    """Whether this process has the compiled tier of a model already: nothing has to be loaded."""
    return KERNELS.is_ready() and code_of(model).is_ready()


def waiting(*, common: bool = False) -> None:
    """Tell who watches that the kernels have to be compiled, and how long it takes."""
    if not KERNELS.is_kept(common=common) and (common or not KERNELS.is_ready()):
        notice(f"Compiling {KERNELS.title} (about {KERNELS.seconds:.0f} s, once) ...")
