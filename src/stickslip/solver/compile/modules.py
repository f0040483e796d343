"""Loads the two tiers of a model: its plain equations, or machine code for them."""

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, TypeAlias

from stickslip.formulation import Model
from stickslip.kernels import entries
from stickslip.kernels.contacts.answers import answer
from stickslip.solver.compile.codegen import contacts_text, kernels_text, numbered, plain_text
from stickslip.solver.compile.compile_units import CompileUnit, units_of
from stickslip.solver.compile.equations_code import code_of
from stickslip.solver.compile.messages import notice
from stickslip.solver.compile.module_cache import cache_directory, module_of

__all__ = [
    "Tier",
    "cache_directory",
    "is_loaded",
    "load",
    "load_compiled",
    "plain_equations",
    "waiting",
]

Equation: TypeAlias = Callable[[int, int, float, Any, int, int], None]


@dataclass(frozen=True)
class Tier:
    """One tier of a model."""

    kernels: ModuleType
    """The kernels: `stickslip.kernels.entries`, or the compiled module of the same functions."""
    equations: Any
    """The equations: functions by their number, or the address of the compiled ones."""
    contacts: Any
    """What works out the equations of several contacts, or its address."""


@functools.lru_cache(maxsize=256)
def plain_equations(model: Model) -> Mapping[str, Equation]:
    """Return the equations of a model by name, as functions in plain Python.

    Arithmetic errors give NaN, as they do in compiled code.
    """
    module = module_of(plain_text(model))
    return {
        name: _fenced(getattr(module, name), length)
        for name, length in model.sizes.lengths().items()
        if hasattr(module, name)
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
    return Tier(entries, known, answer)


@functools.lru_cache(maxsize=256)
def load_compiled(model: Model, *, ensembles: bool = False) -> Tier:
    """Return the compiled tier of a model, with what single runs or what ensembles need.

    The first process of all waits for the kernels, for half a minute; equations take hundredths of
    a second.

    Parameters
    ----------
    model : Model
        Equations of a mechanism with a law.
    ensembles : bool, default False
        Whether for ensembles, or else for single runs.

    Returns
    -------
    Tier
        The module of the kernels and the address of the equations.
    """
    units = units_of(model, runs=not ensembles, ensembles=ensembles)
    waiting(units)
    for unit in units:
        unit.load()
    equations = code_of(model)
    equations.load()
    contacts = 0
    if model.contacts:
        contacts = int(module_of(contacts_text(), compiled=True).contacts.address)
    kernels = module_of(kernels_text(), compiled=True)
    return Tier(kernels, equations.address, contacts)


def is_loaded(model: Model, *, ensembles: bool = False) -> bool:
    """Whether this process has the compiled tier of a model already.

    Parameters
    ----------
    model : Model
        Equations of a mechanism with a law.
    ensembles : bool, default False
        Whether for ensembles, or else for single runs.

    Returns
    -------
    bool
        Whether nothing needs to be loaded or compiled.
    """
    units = units_of(model, runs=not ensembles, ensembles=ensembles)
    return code_of(model).is_ready() and all(unit.is_ready() for unit in units)


def waiting(units: Sequence[CompileUnit]) -> None:
    """Tell who watches which of these have to be compiled and how long it takes.

    Parameters
    ----------
    units : sequence of CompileUnit
        What is about to be loaded.
    """
    absent = [unit for unit in units if not unit.is_ready() and not unit.is_kept()]
    if absent:
        titles = " and ".join(unit.title for unit in absent)
        seconds = sum(unit.seconds() for unit in absent)
        notice(f"Compiling {titles} (about {seconds:.0f} s, once) ...")
