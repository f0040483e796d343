"""Loads the two tiers of a model: its plain module, or machine code for its equations."""

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType

from stickslip.formulation import Model
from stickslip.solver.compile.codegen import equations_text, kernels_text, module_text
from stickslip.solver.compile.compile_units import CompileUnit, parts_of
from stickslip.solver.compile.messages import notice
from stickslip.solver.compile.module_cache import cache_directory, module_of

__all__ = ["Compiled", "cache_directory", "is_loaded", "load", "load_compiled", "waiting"]

SHORT = 2.0
"""Compiling that takes less is not worth a message [s]."""


@dataclass(frozen=True)
class Compiled:
    """The compiled tier of a model."""

    kernels: ModuleType
    """The kernels of its shape."""
    address: int
    """Where its equations are in memory."""


@functools.lru_cache(maxsize=256)
def load(model: Model) -> ModuleType:
    """Return the plain module of a model, from memory, from its file, or new."""
    return module_of(module_text(model))


@functools.lru_cache(maxsize=256)
def load_compiled(model: Model, *, ensembles: bool = False) -> Compiled:
    """Return the compiled tier of a model, with what single runs or what ensembles need.

    Only the first process that runs a model waits for its equations, and only the first that runs
    any of its shape for the kernels.

    Parameters
    ----------
    model : Model
        Equations of a mechanism with a law.
    ensembles : bool, default False
        Whether for ensembles, or else for single runs.

    Returns
    -------
    Compiled
        The module of the kernels and the address of the equations.
    """
    parts = parts_of(model, runs=not ensembles, ensembles=ensembles)
    waiting(parts)
    for part in parts:
        part.load()
    equations = module_of(equations_text(model), compiled=True)
    kernels = module_of(kernels_text(model.shape), compiled=True)
    return Compiled(kernels, int(equations.equations.address))


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
