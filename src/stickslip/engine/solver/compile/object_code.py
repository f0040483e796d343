"""Machine code that LLVM makes, kept in files and put into memory."""

import contextlib
import errno
import functools
import hashlib
import itertools
import os
import shlex
import stat
import sys
import tempfile
import threading
import warnings
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeAlias

import platformdirs

from stickslip.engine.solver.compile import translation
from stickslip.errors import CompilationError

# Keeps object code ("images") in files, one for each kind of processor.
#
# A file begins with a hash of itself, so that damage is noticed before any of it runs, and is
# written atomically. A directory that cannot be written to is no obstacle.
#
# Machine code is run: it is therefore loaded only from folders and files that no other user but
# root can have written.

Processor: TypeAlias = tuple[str, str, str]
"""A kind of processor: triple, name and features, as LLVM calls them."""
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
OTHERS_ENTER = stat.S_IXGRP | stat.S_IXOTH
BASE_FEATURES = "+64bit,+sse2"
"""What any x86-64 processor can do: without it, LLVM ends the process if it does not know a name.
"""
SEAL = 32
"""Bytes of the hash before object code."""


def cache_directory() -> Path:
    """Return where machine code is kept: ``STICKSLIP_CACHE``, or the user's cache."""
    named = os.environ.get("STICKSLIP_CACHE")
    return Path(named) if named else Path(platformdirs.user_cache_dir("stickslip")) / "code"


@functools.lru_cache(maxsize=256)
def name_of(text: str) -> str:
    """Return the name of what is made of a text."""
    return "stickslip_" + hashlib.sha256(text.encode()).hexdigest()[:32]


@functools.cache  # once for each reason, whatever filters there are
def _warn(folder: Path, reason: str) -> None:
    warnings.warn(
        f"{folder} cannot be used ({reason}): machine code is lost when this process ends."
        " Set STICKSLIP_CACHE to a folder of your own that you can write to.",
        stacklevel=4,
    )


def _resolved(folder: Path) -> Path:
    """Return a folder with links followed, so that what is judged is what is used."""
    try:
        return folder.resolve()
    except RuntimeError as error:  # Python 3.11 and 3.12, where links go round in circles
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(folder)) from error


def _made_folder() -> Path:
    """Return the cache directory; make it if it is not there."""
    folder = _resolved(cache_directory())
    for part in (*reversed(folder.parents), folder):
        if not part.exists():
            part.mkdir(mode=0o700, exist_ok=True)
    return _trusted(folder)


def _trusted(folder: Path) -> Path:
    """Return a folder if only this user and root can have put there what it holds.

    It belongs to one of them and nobody else may write to it. Nobody else may rename the folders
    above it either, where a group that has this user or root as its only member is nobody else.
    Whose those are is not asked: containers and networks show homes under other owners. Windows has
    access lists in place of owners and mode bits, and what lies in a user's folders is his own.
    """
    if sys.platform != "win32":
        _refuse_foreign(folder, folder.stat(), OTHERS_WRITE)
        for parent in folder.parents:
            status = parent.stat()
            mode = status.st_mode & OTHERS_WRITE
            if mode & stat.S_IWGRP and _is_private(status.st_gid):
                mode &= ~stat.S_IWGRP
            # With the sticky bit, as in /tmp, nobody renames what is another's.
            if mode and not status.st_mode & stat.S_ISVTX:
                raise _not_trusted(parent, _open_to_others(parent, "go-w"))
    return folder


def _refuse_foreign(path: Path, status: os.stat_result, modes: int) -> None:
    """Refuse what is another user's, or has one of these mode bits."""
    if sys.platform != "win32":
        if status.st_uid not in (os.geteuid(), 0):  # root may write anywhere anyway
            raise _not_trusted(path, f"{path} belongs to another user")
        if status.st_mode & modes:
            raise _not_trusted(path, _open_to_others(path, "-R go-w"))


def _open_to_others(path: Path, modes: str) -> str:
    return f"others may write to {path}: run chmod {modes} {shlex.quote(str(path))}"


def _not_trusted(path: Path, reason: str) -> OSError:
    return PermissionError(errno.EPERM, reason, str(path))


@functools.cache
def _is_private(group: int) -> bool:
    """Whether nobody is in a group but root, or this user, whose name it then has."""
    private = group == 0
    if sys.platform != "win32" and not private:
        import grp
        import pwd

        with contextlib.suppress(KeyError):
            own, user = grp.getgrgid(group), pwd.getpwuid(os.geteuid())
            named_alike = user.pw_gid == group and own.gr_name == user.pw_name
            private = named_alike and set(own.gr_mem) <= {user.pw_name}
    return private


def _refuse_foreign_file(path: Path) -> None:
    """Refuse a file in a trusted folder that may be another's.

    A file of one's own that others may write to is one's own if they cannot enter its folder.
    """
    status = path.lstat()
    if stat.S_ISLNK(status.st_mode):
        raise _not_trusted(path, f"{path} is a link: remove it")
    open_to_others = path.parent.stat().st_mode & OTHERS_ENTER
    _refuse_foreign(path, status, OTHERS_WRITE if open_to_others else 0)


def _write(path: Path, content: bytes) -> None:
    """Write a file so that others see all of it or nothing."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(temporary).chmod(0o644)  # another user may run what this one compiled
        Path(temporary).replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise


def is_writable() -> bool:
    """Whether the cache directory is used and can be written to; it is made if it is not there."""
    try:
        folder = _made_folder()
        with tempfile.TemporaryFile(dir=folder):
            return True
    except PermissionError as error:
        if error.errno == errno.EPERM:  # not for want of a permission: it has too many
            _warn(cache_directory(), error.strerror)
        return False
    except OSError:
        return False


@functools.cache
def processor() -> Processor:
    """Return the kind of processor that is compiled for: this one, or that of ``STICKSLIP_CPU``."""
    from llvmlite import binding

    triple, named = binding.get_process_triple(), os.environ.get("STICKSLIP_CPU")
    if named:
        return triple, named, BASE_FEATURES if triple.startswith("x86_64") else ""
    return triple, binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()


def common_processor() -> Processor:
    """Return what all processors of this platform can do, for code that other machines run."""
    triple, _, _ = processor()
    return triple, "x86-64" if triple.startswith("x86_64") else "generic", ""


def _label(kind: Processor) -> str:
    """Return a short name of a kind of processor."""
    return hashlib.sha256("\n".join(kind).encode()).hexdigest()[:12]


@functools.cache
def _processor() -> str:
    """Return a short name of the kind of processor that this process compiles for."""
    return _label(processor())


def _image(folder: Path, name: str, kind: Processor | None = None) -> Path:
    return folder / f"{name}.{_processor() if kind is None else _label(kind)}.image"


def _seal(name: str, content: bytes) -> bytes:
    """Return what vouches for object code under its name."""
    return hashlib.sha256(name.encode() + content).digest()


def has_image(name: str, kind: Processor | None = None) -> bool:
    """Whether there is a file of object code of this name, for a kind of processor."""
    try:
        return _image(_trusted(_resolved(cache_directory())), name, kind).exists()
    except OSError:
        return False


def image_of(name: str, kind: Processor | None = None) -> bytes | None:
    """Return the object code of a name, unless it is absent, damaged, or may be another's."""
    try:
        folder = _made_folder()
        path = _image(folder, name, kind)
        if not path.exists() and not path.is_symlink():
            return None
        _refuse_foreign_file(path)
        content = path.read_bytes()
    except OSError as error:
        _warn(cache_directory(), error.strerror or str(error))
        return None
    seal, content = content[:SEAL], content[SEAL:]
    return content if seal == _seal(name, content) else None


def keep_image(name: str, content: bytes, *, warns: bool, kind: Processor | None = None) -> None:
    """Keep object code in a file; a folder that cannot be written to is no obstacle."""
    try:
        _write(_image(_made_folder(), name, kind), _seal(name, content) + content)
    except OSError as error:
        if warns and not has_image(name, kind):  # Windows replaces no file that another reads
            _warn(cache_directory(), error.strerror or str(error))


# Machine code that LLVM makes, keeps in a file, and puts into memory.
#
# LLVM gets settings under which it does not change a result: no fast mathematics, no fused
# products. Code that is loaded stays until the process ends, since vectors of runs hold addresses
# in it.

LONG_SECONDS = 1.0
"""Time for compiling [s] that nobody should spend in each process without being told."""
_LOCK = threading.RLock()
_loaded: dict["ObjectCode", tuple[Mapping[str, int], Any]] = {}
"""Addresses of functions, and what keeps them in memory."""
_numbers = itertools.count()
"""What is put into memory needs names that were never used."""


class ObjectCode(ABC):
    """Functions that are compiled at once and kept in one file."""

    @property
    @abstractmethod
    def title(self) -> str:
        """What it is, for a message."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of its file, which depends on all that decides what is in it but the processor."""

    @property
    @abstractmethod
    def symbols(self) -> Sequence[str]:
        """Names of the functions that are called from outside."""

    @property
    @abstractmethod
    def seconds(self) -> float:
        """Processor time that compiling takes [s, measured], for a message."""

    @abstractmethod
    def text(self) -> str:
        """Return the functions in LLVM's language."""

    def is_ready(self) -> bool:
        """Whether it is in this process."""
        return self in _loaded

    def is_kept(self, *, common: bool = False) -> bool:
        """Whether there is a file of it for this kind of processor, or for all of the platform."""
        return has_image(self.name, common_processor() if common else None)

    @property
    def addresses(self) -> Mapping[str, int]:
        """Address of each function, once it is ready."""
        return _loaded[self][0]

    def load(self) -> bool:
        """Load it, or compile it and keep it; return whether it was compiled.

        Two processes that do so at once both compile: to wait for each other would take as long.
        """
        with _LOCK:
            # Code may be in this process whose file was removed since: it is made for others then.
            if self.is_ready() and self.is_kept():
                return False
            image, compiled = self._image(None)
            if not self.is_ready():
                _loaded[self] = _linked(self.name, image, self.symbols)
            return compiled

    def image(self, *, common: bool) -> bytes:
        """Return the object code itself, which a linker takes."""
        with _LOCK:
            return self._image(common_processor() if common else None)[0]

    def _image(self, kind: Processor | None) -> tuple[bytes, bool]:
        """Return the object code for a kind of processor, and whether it had to be compiled."""
        image = image_of(self.name, kind)
        if image is not None:
            return image, False
        image = _compiled(self.text(), kind)
        keep_image(self.name, image, warns=self.seconds > LONG_SECONDS, kind=kind)
        return image, True


@functools.cache
def maker() -> str:
    """Return what decides, beside a text, which machine code comes of it."""
    sources = [Path(path).read_text("utf-8") for path in (__file__, translation.__file__)]
    return name_of("\n".join([f"llvmlite {version('llvmlite')}", *sources]))


@functools.cache
def _machine(kind: Processor) -> Any:
    """Return LLVM's description of a kind of processor."""
    from llvmlite import binding

    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    triple, name, features = kind
    target = binding.Target.from_triple(triple)
    # Code that may lie anywhere in memory, far from the C library.
    return target.create_target_machine(cpu=name, features=features, opt=3, reloc="pic")


def _compiled(text: str, kind: Processor | None = None) -> bytes:
    """Return the object code of a module."""
    from llvmlite import binding

    machine = _machine(kind or processor())
    module = binding.parse_assembly(text, binding.create_context())
    module.triple = machine.triple
    module.data_layout = str(machine.target_data)
    module.verify()
    options = binding.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = False
    builder = binding.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


@functools.cache
def _linker() -> Any:
    from llvmlite import binding

    return binding.create_lljit_compiler(_machine(processor()), use_jit_link=True)


def _linked(name: str, image: bytes, symbols: Sequence[str]) -> tuple[Mapping[str, int], Any]:
    """Put object code into memory; return the addresses of its functions, and its keeper."""
    from llvmlite import binding

    library = binding.JITLibraryBuilder().add_object_img(image).add_current_process()
    for symbol in symbols:
        library.export_symbol(symbol)
    try:
        tracker = library.link(_linker(), f"{name}.{next(_numbers)}")
    except RuntimeError as error:
        raise CompilationError(f"compiled code cannot be loaded: {error}") from error
    return {symbol: tracker[symbol] for symbol in symbols}, tracker
