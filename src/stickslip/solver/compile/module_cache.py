"""Keeps generated modules as files, and knows which of them have machine code beside them.

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
import threading
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import ModuleType

import platformdirs

__all__ = [
    "cache_directory",
    "is_kept",
    "is_writable",
    "keep",
    "locked",
    "module_of",
    "name_of",
]

MACHINE_CODE = "__pycache__"
"""Folder beside a module where numba keeps what it compiled."""
LONGEST_WAIT = 600.0
"""Waiting for another process that compiles a module [s]: kernels take some 20 s of processor time,
so that one which takes longer is taken to hang."""


def cache_directory() -> Path:
    """Return where generated modules are kept: ``STICKSLIP_CACHE``, or the user's cache."""
    named = os.environ.get("STICKSLIP_CACHE")
    return Path(named) if named else Path(platformdirs.user_cache_dir("stickslip")) / "modules"


@functools.lru_cache(maxsize=256)
def name_of(text: str) -> str:
    """Return the name of the module with this text."""
    return "stickslip_" + hashlib.sha256(text.encode()).hexdigest()[:32]


_LOADING = threading.RLock()


def module_of(text: str, *, compiled: bool = False) -> ModuleType:
    """Return the module of a text, from memory, from its file, or new.

    Parameters
    ----------
    text : str
        Program text.
    compiled : bool, default False
        Whether the module is for numba, which keeps machine code beside its file.

    Returns
    -------
    ModuleType
        The module; one object in a process for each text.
    """
    name = name_of(text)
    with _LOADING:  # a module is known by its name before it is whole
        known = sys.modules.get(name)
        return _from_file(name, text, compiled=compiled) if known is None else known


def _from_file(name: str, text: str, *, compiled: bool) -> ModuleType:
    path = cache_directory() / f"{name}.py"
    try:
        if not path.exists() or path.read_text("utf-8", "replace") != text:
            _write(path, text)
        return _executed(name, _with_machine_code(path) if compiled else path)
    except OSError as error:
        if compiled:
            _warn(error.strerror or str(error))
        path = _temporary_folder() / f"{name}.py"
        _write(path, text)
        return _executed(name, path)


def _warn(reason: str) -> None:
    warnings.warn(
        f"{cache_directory()} cannot be used ({reason}): compiled modules are lost when this"
        " process ends. Set STICKSLIP_CACHE to a writable folder.",
        stacklevel=4,
    )


@functools.cache
def _temporary_folder() -> Path:
    """Return a folder that lives as long as this process."""
    folder = tempfile.mkdtemp(prefix="stickslip-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


def _takes_machine_code(folder: Path) -> bool:
    inner = folder / MACHINE_CODE
    return os.access(inner if inner.exists() else folder, os.W_OK)


def _with_machine_code(path: Path) -> Path:
    """Return where numba finds what belongs to a module: it reads only where it could write."""
    if _takes_machine_code(path.parent):
        return path
    found = list((path.parent / MACHINE_CODE).glob(f"{path.stem}.*"))
    if not found:
        _warn("read-only")
    copy = _temporary_folder() / path.name
    (copy.parent / MACHINE_CODE).mkdir(exist_ok=True)
    shutil.copy2(path, copy)
    for file in found:
        shutil.copy2(file, copy.parent / MACHINE_CODE)
    return copy


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
        Path(temporary).chmod(0o644)  # another user may run what this one compiled
        Path(temporary).replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise


def is_writable() -> bool:
    """Whether the cache directory can be written to; it is made if it is not there."""
    try:
        folder = cache_directory()
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return _takes_machine_code(folder)
    except OSError:
        return False


@contextlib.contextmanager
def locked(text: str) -> Iterator[None]:
    """Let one process at a time compile a module, on every operating system.

    The operating system drops the lock when its process ends. Where there is no lock to be had (a
    read-only folder, a file system without locks), or an owner hangs, the module is compiled twice,
    which is safe: files are replaced as a whole.
    """
    from filelock import FileLock

    path = cache_directory() / f"{name_of(text)}.lock"
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            # No fallback to a file that merely exists, which would outlive a dead owner.
            stack.enter_context(FileLock(path, timeout=LONGEST_WAIT, fallback_to_soft=False))
        yield


def _stamp(text: str, entry: str) -> Path:
    return cache_directory() / f"{name_of(text)}.{entry}.{_processor()}.ready"


@functools.cache
def _processor() -> str:
    """Return a short name of the kind of processor that numba compiles for."""
    from llvmlite import binding

    name = os.environ.get("NUMBA_CPU_NAME") or binding.get_host_cpu_name()
    own = "" if name == "generic" else binding.get_host_cpu_features().flatten()
    kind = (binding.get_process_triple(), name, os.environ.get("NUMBA_CPU_FEATURES") or own)
    return hashlib.sha256("\n".join(kind).encode()).hexdigest()[:12]


def is_kept(text: str, entry: str) -> bool:
    """Whether the machine code of a function is in files that this kind of processor can load.

    It is if an earlier process said so and the files that it named are still there.

    Parameters
    ----------
    text : str
        Program text of the module.
    entry : str
        Name of the function.

    Returns
    -------
    bool
        Whether nothing needs to be compiled.
    """
    try:
        lines = _stamp(text, entry).read_text("utf-8").splitlines()
        folder = cache_directory()
        return bool(lines) and all((folder / line).exists() for line in lines)
    except (OSError, ValueError):
        return False


def keep(text: str, entry: str, files: Iterable[Path]) -> None:
    """Note which files hold the machine code of a function, unless nothing can be noted.

    Parameters
    ----------
    text : str
        Program text of the module.
    entry : str
        Name of the function.
    files : iterable of Path
        Files of its machine code.
    """
    folder = cache_directory()
    lines = [str(f.relative_to(folder) if f.is_relative_to(folder) else f) for f in files]
    with contextlib.suppress(OSError):
        _write(_stamp(text, entry), "\n".join(sorted(lines)))
