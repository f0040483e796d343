"""What numba compiles at once: the kernels, or what decides on several contacts."""

from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from stickslip.formulation import Model
from stickslip.solver.compile.codegen import contacts_text, kernels_text
from stickslip.solver.compile.module_cache import is_kept, keep, locked, module_of

__all__ = ["CompileUnit", "has_kernels", "units_of"]

CONTACTS = "contacts"
"""A function that is called by its address; it is compiled when its module is executed."""
RUNS = ("enter_run", "enter_play")
ENSEMBLES = ("enter_batch",)
SENSES = ("enter_sense",)
SENSED_ENSEMBLES = ("enter_batch_sensed",)
"""Entries of the kernels; one entry calls no other, and each has files of its own."""
TAKES = {
    "enter_run": "VWVVfffiVV",
    "enter_play": "ViVVVWVVV",
    "enter_batch": "iVVVVVVVVffiVWVVVVV",
    "enter_sense": "ViViVVVViVWV",
    "enter_batch_sensed": "iVVVVVVVVffiVWVVVVVVVViV",
}
"""Arguments of the entries: (V)ectors of reals, of (W)holes, and single re(f)als and whole (i)."""
SECONDS = {
    CONTACTS: 30,
    RUNS[0]: 5,
    RUNS[1]: 2,
    ENSEMBLES[0]: 10,
    SENSES[0]: 10,
    SENSED_ENSEMBLES[0]: 10,
}
KERNELS = 20
"""What compiling takes [s of processor time, measured], for a message; the entries of a unit share
a part."""

_ready: set[tuple[str, str]] = set()
"""Texts and entries whose machine code is in this process."""


@dataclass(frozen=True)
class CompileUnit:
    """Machine code that is compiled at once and kept in files of its own."""

    title: str
    """What it is, for a message."""
    text: str
    """Text of its module."""
    entries: tuple[str, ...]
    """Functions that are called from outside."""

    def is_ready(self) -> bool:
        """Whether it is in this process."""
        return all((self.text, entry) in _ready for entry in self.entries)

    def is_kept(self) -> bool:
        """Whether it can be loaded."""
        return all(is_kept(self.text, entry) for entry in self.entries)

    def seconds(self) -> float:
        """Return about how long compiling takes."""
        return KERNELS + sum(SECONDS.get(entry, 0) for entry in self.entries)

    def load(self) -> bool:
        """Load it, or compile it and keep it; return whether it was compiled."""
        if self.is_kept():
            return self._load()
        with locked(self.text):
            return self._load()

    def _load(self) -> bool:
        module = module_of(self.text, compiled=True)
        compiled = [_compile(module, entry) for entry in self.entries]
        for entry in self.entries:
            if not is_kept(self.text, entry):
                keep(self.text, entry, _files(module, entry))
            _ready.add((self.text, entry))
        return any(compiled)


def has_kernels() -> bool:
    """Whether any machine code of kernels is in this process."""
    return bool(_ready)


def _compile(module: ModuleType, entry: str) -> bool:
    """Load or compile one function; return whether it was compiled."""
    function: Any = getattr(module, entry)
    if entry == CONTACTS:
        return not function.cache_hits  # it was compiled when the module was executed
    signature = _signature(entry)
    function.compile(signature)
    return bool(function.stats.cache_misses)


def _signature(entry: str) -> tuple[Any, ...]:
    from numba import types

    kinds = {"V": types.float64[::1], "W": types.int64[::1], "f": types.float64, "i": types.int64}
    return tuple(kinds[letter] for letter in TAKES[entry])


def _files(module: ModuleType, entry: str) -> list[Path]:
    """Return the files that hold the machine code of a function."""
    function: Any = getattr(module, entry)
    cache = function._cache if entry == CONTACTS else function.stats  # numba has no other way
    return list(Path(cache.cache_path).glob(f"{module.__name__}.{entry}-*.nb[ic]"))


def units_of(model: Model, *, runs: bool = True, ensembles: bool) -> list[CompileUnit]:
    """Return what single runs of a model need beside its equations, or ensembles, or both.

    Of a model with slopes, what sensitivities need.

    Parameters
    ----------
    model : Model
        Equations of a mechanism with a law.
    runs : bool, default True
        Whether single runs are wanted.
    ensembles : bool
        Whether ensembles are wanted.

    Returns
    -------
    list of CompileUnit
        The kernels first. The same units serve all models with one contact, or with several.
    """
    if model.has_slopes:
        entries = (SENSES if runs else ()) + (SENSED_ENSEMBLES if ensembles else ())
    else:
        entries = (RUNS if runs else ()) + (ENSEMBLES if ensembles else ())
    units = [CompileUnit("the solver", kernels_text(), entries)]
    if model.contacts:
        units.append(CompileUnit("the decisions of several contacts", contacts_text(), (CONTACTS,)))
    return units
