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
from stickslip.solver.compile.codegen import (
    contacts_text,
    equations_text,
    kernels_text,
    numbered,
    plain_text,
)
from stickslip.solver.compile.compile_units import CompileUnit, parts_of
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

SHORT = 2.0
"""Compiling that takes less is not worth a message [s]."""


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

    Only the first process that runs a model waits for its equations, and only the first of all for
    the kernels.

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
    parts = parts_of(model, runs=not ensembles, ensembles=ensembles)
    waiting(parts)
    for part in parts:
        part.load()
    equations = module_of(equations_text(model), compiled=True)
    contacts = 0
    if model.contacts:
        contacts = int(module_of(contacts_text(), compiled=True).contacts.address)
    kernels = module_of(kernels_text(), compiled=True)
    return Tier(kernels, int(equations.equations.address), contacts)


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
    return all(part.is_ready() for part in parts_of(model, runs=not ensembles, ensembles=ensembles))


def waiting(parts: Sequence[CompileUnit], processes: int = 1) -> None:
    """Tell who watches that these are compiled and how long it takes, if it is worth a word.

    Parameters
    ----------
    parts : sequence of CompileUnit
        What is about to be loaded.
    processes : int, default 1
        How many compile at a time, by which the estimate is divided.
    """
    absent = [part for part in parts if not part.is_ready() and not part.is_kept()]
    seconds = sum(part.seconds() for part in absent) / processes
    if seconds < SHORT:
        return
    titles = list(dict.fromkeys(part.title for part in absent))
    more = f" and {len(titles) - 1} more" if len(titles) > 1 else ""
    notice(f"Compiling the equations of {titles[0]}{more} (about {seconds:.0f} s, once) ...")
