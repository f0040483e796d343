"""Loads generated modules and keeps their files.

The text of a module says all that it does, so its hash names it. Modules are files in the user's
cache directory, written atomically; a directory that cannot be written to is no obstacle.
"""

import atexit
import contextlib
import functools
import hashlib
import importlib.util
import os
import shutil
import sys
import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import platformdirs

from stickslip.formulation import Model
from stickslip.solver.texts import equations_text, kernels_text, module_text

__all__ = ["Compiled", "cache_directory", "is_loaded", "load", "load_compiled"]


def cache_directory() -> Path:
    """Return where generated modules are kept: ``STICKSLIP_CACHE``, or the user's cache."""
    named = os.environ.get("STICKSLIP_CACHE")
    return Path(named) if named else Path(platformdirs.user_cache_dir("stickslip")) / "modules"


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
    return _module(module_text(model))


@functools.lru_cache(maxsize=256)
def load_compiled(model: Model) -> Compiled:
    """Return the compiled tier of a model; machine code lies beside the files of its modules.

    Only the first process that runs a model waits for its equations, and only the first that runs
    any of its shape for the kernels.
    """
    equations = _module(equations_text(model), compiled=True)
    kernels = _module(kernels_text(model.shape), compiled=True)
    return Compiled(kernels, int(equations.equations.address))


def is_loaded(model: Model) -> bool:
    """Whether this process has the compiled tier of a model already."""
    texts = equations_text(model), kernels_text(model.shape)
    return all(_name(text) in sys.modules for text in texts)


def _module(text: str, *, compiled: bool = False) -> ModuleType:
    """Return the module of a text, from memory, from its file, or new."""
    name = _name(text)
    return sys.modules[name] if name in sys.modules else _from_file(name, text, compiled=compiled)


@functools.lru_cache(maxsize=256)
def _name(text: str) -> str:
    return "stickslip_" + hashlib.sha256(text.encode()).hexdigest()[:32]


def _from_file(name: str, text: str, *, compiled: bool) -> ModuleType:
    path = cache_directory() / f"{name}.py"
    try:
        if not path.exists() or path.read_text("utf-8", "replace") != text:
            _write(path, text)
        return _executed(name, path)
    except OSError as error:
        path = _temporary_folder() / f"{name}.py"
        if compiled:
            warnings.warn(
                f"{cache_directory()} cannot be used ({error.strerror}): compiled modules are lost"
                " with this process. Set STICKSLIP_CACHE to a folder that can be written.",
                stacklevel=4,
            )
        _write(path, text)
        return _executed(name, path)


@functools.cache
def _temporary_folder() -> Path:
    """Return a folder that lives as long as this process."""
    folder = tempfile.mkdtemp(prefix="stickslip-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


def _executed(name: str, path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise OSError(f"cannot load {path}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # before it runs: what is compiled then must find it by its name
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def _write(path: Path, text: str) -> None:
    """Write a file so that others see all of it or nothing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        Path(temporary).replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise
