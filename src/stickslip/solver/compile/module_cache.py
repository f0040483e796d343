"""Keeps generated modules and object code as files, and knows which modules have machine code.

The text of a module says all that it does, so its hash names it. Modules are files in the user's
cache directory, written atomically; a directory that cannot be written to is no obstacle. Object
code ("images") is a file that begins with a hash of itself, so that damage is noticed before any of
it runs.

Machine code is run, and numba's files of it are pickles, which run what they hold when they are
read. They are therefore loaded only from folders and files that no other user but root can have
written. A module itself is compiled from its text in memory: no file decides what it does.
"""

import atexit
import contextlib
import errno
import functools
import hashlib
import os
import shlex
import shutil
import stat
import sys
import tempfile
import threading
import warnings
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import platformdirs

__all__ = [
    "cache_directory",
    "has_image",
    "image_of",
    "is_kept",
    "is_writable",
    "keep",
    "keep_image",
    "locked",
    "module_of",
    "name_of",
    "processor",
]

MACHINE_CODE = "__pycache__"
"""Folder beside a module where numba keeps what it compiled."""
HAS_MODES = os.name == "posix"
"""Whether files have owners and mode bits; Windows has access lists, and a user's are his own."""
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
OTHERS_ENTER = stat.S_IXGRP | stat.S_IXOTH
SEAL = 32
"""Bytes of the hash before object code."""
LONGEST_WAIT = 600.0
"""Waiting for another process that compiles a module [s]: kernels take some 30 s of processor time,
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
    try:
        path = _made_folder() / f"{name}.py"
        if not path.exists() or path.read_text("utf-8", "replace") != text:
            _write(path, text.encode())
        if compiled:
            path = _with_machine_code(path)
    except OSError as error:
        if compiled:
            _warn(cache_directory(), error.strerror or str(error))
        path = _temporary_folder() / f"{name}.py"
        _write(path, text.encode())
    return _executed(name, path, text, compiled=compiled)


@functools.cache  # once for each reason, whatever filters there are
def _warn(folder: Path, reason: str) -> None:
    warnings.warn(
        f"{folder} cannot be used ({reason}): compiled modules are lost when this process ends."
        " Set STICKSLIP_CACHE to a folder of your own that you can write to.",
        stacklevel=4,
    )


def _resolved(folder: Path) -> Path:
    """Return a folder with links followed, so that what is judged is what is used."""
    try:
        return folder.resolve()
    except RuntimeError as error:  # Python 3.11 and 3.12, where links go round in circles
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(folder)) from error


def _made_folder(folder: Path | None = None) -> Path:
    """Return a folder, the cache directory if none is given; make it if it is not there.

    Raises
    ------
    OSError
        If it cannot be made, or others may write to it.
    """
    folder = _resolved(folder or cache_directory())
    for part in (*reversed(folder.parents), folder):
        if not part.exists():
            part.mkdir(mode=0o700, exist_ok=True)
    return _trusted(folder)


def _trusted(folder: Path) -> Path:
    """Return a folder if only this user and root can have put there what it holds.

    It belongs to one of them and nobody else may write to it. Nobody else may rename the folders
    above it either, where a group that has this user or root as its only member is nobody else.
    Whose those are is not asked: containers and networks show homes under other owners.

    Parameters
    ----------
    folder : Path
        An existing folder, links followed.

    Raises
    ------
    OSError
        If it is not there, or another user may write to it.
    """
    if HAS_MODES:
        _refuse_foreign(folder, folder.stat(), OTHERS_WRITE)
        for parent in folder.parents:
            status = parent.stat()
            mode = status.st_mode & OTHERS_WRITE
            if mode & stat.S_IWGRP and _is_private(status.st_gid):
                mode &= ~stat.S_IWGRP
            if mode and not status.st_mode & stat.S_ISVTX:
                raise _not_trusted(parent, _open_to_others(parent, "go-w"))
    return folder


def _refuse_foreign(path: Path, status: os.stat_result, modes: int) -> None:
    """Refuse what is another user's, or has one of these mode bits."""
    if status.st_uid not in (os.geteuid(), 0):
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
    import grp
    import pwd

    if group == 0:
        return True
    try:
        own, user = grp.getgrgid(group), pwd.getpwuid(os.geteuid())
    except KeyError:
        return False
    named_alike = user.pw_gid == group and own.gr_name == user.pw_name
    return named_alike and set(own.gr_mem) <= {user.pw_name}


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
    inner = path.parent / MACHINE_CODE
    found = list(inner.glob(f"{path.stem}.*"))
    _refuse_foreign_files(path.parent, found)
    if _takes_machine_code(path.parent):
        if not inner.exists():  # open to those to whom the folder is
            modes = stat.S_IMODE(path.parent.stat().st_mode) & ~OTHERS_WRITE
            inner.mkdir(mode=modes, exist_ok=True)
        return path
    if not found:
        _warn(cache_directory(), "read-only")
    copy = _temporary_folder() / path.name
    (copy.parent / MACHINE_CODE).mkdir(exist_ok=True)
    shutil.copy2(path, copy)
    for file in found:
        shutil.copy2(file, copy.parent / MACHINE_CODE)
    return copy


def _refuse_foreign_files(folder: Path, files: Sequence[Path]) -> None:
    """Refuse files that may be another's, and folders in a trusted folder that hold them.

    A file of one's own that others may write to is one's own if they cannot enter its folder.
    """
    if HAS_MODES:
        modes = OTHERS_WRITE if folder.stat().st_mode & OTHERS_ENTER else 0
        inner = folder / MACHINE_CODE
        holders = {file.parent for file in files} | ({inner} if inner.exists() else set())
        for path in (*holders, *files):
            status = path.lstat()
            if stat.S_ISLNK(status.st_mode):
                raise _not_trusted(path, f"{path} is a link: remove it")
            _refuse_foreign(path, status, modes)


def _executed(name: str, path: Path, text: str, *, compiled: bool) -> ModuleType:
    """Run a text as the module of a file, which debuggers show and beside which numba writes."""
    module = ModuleType(name)
    module.__file__ = str(path)
    sys.modules[name] = module  # before it runs: what is compiled then must find it by its name
    try:
        with _numba_folder_judged(name) if compiled else contextlib.nullcontext():
            exec(compile(text, path, "exec", dont_inherit=True), module.__dict__)
    except BaseException:
        del sys.modules[name]
        raise
    return module


@contextlib.contextmanager
def _numba_folder_judged(name: str) -> Iterator[None]:
    """Let numba pass over a folder of its own (NUMBA_CACHE_DIR) that others may write to."""
    import numba

    config: Any = numba.config
    given = config.CACHE_DIR
    if given:
        try:
            folder = _made_folder(Path(given))
            _refuse_foreign_files(folder, list(folder.glob(f"*/{name}.*")))
        except OSError:
            config.CACHE_DIR = ""
    try:
        yield
    finally:
        config.CACHE_DIR = given


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
            return _takes_machine_code(folder)
    except PermissionError as error:
        if error.errno == errno.EPERM:  # not for want of a permission: it has too many
            _warn(cache_directory(), error.strerror)
        return False
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

    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):
            path = _made_folder() / f"{name_of(text)}.lock"
            # No fallback to a file that merely exists, which would outlive a dead owner.
            stack.enter_context(FileLock(path, timeout=LONGEST_WAIT, fallback_to_soft=False))
        yield


def _stamp(folder: Path, text: str, entry: str) -> Path:
    return folder / f"{name_of(text)}.{entry}.{_processor()}.ready"


@functools.cache
def processor() -> tuple[str, str, str]:
    """Return the kind of processor that is compiled for, as numba is told, too.

    Returns
    -------
    triple, name, features : str
        As LLVM calls them.
    """
    from llvmlite import binding

    name = os.environ.get("NUMBA_CPU_NAME") or binding.get_host_cpu_name()
    own = "" if name == "generic" else binding.get_host_cpu_features().flatten()
    return binding.get_process_triple(), name, os.environ.get("NUMBA_CPU_FEATURES") or own


@functools.cache
def _processor() -> str:
    """Return a short name of the kind of processor."""
    return hashlib.sha256("\n".join(processor()).encode()).hexdigest()[:12]


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
        folder = _trusted(_resolved(cache_directory()))
        lines = _stamp(folder, text, entry).read_text("utf-8").splitlines()
        return bool(lines) and all((folder / line).exists() for line in lines)
    except (OSError, ValueError):
        return False


def keep(text: str, entry: str, files: Iterable[Path]) -> None:
    """Note which files hold the machine code of a function, and close them to others.

    Nothing is noted in a folder that cannot be written to.

    Parameters
    ----------
    text : str
        Program text of the module.
    entry : str
        Name of the function.
    files : iterable of Path
        Files of its machine code.
    """
    with contextlib.suppress(OSError):
        folder, lines = _made_folder(), []
        for file in files:
            lines.append(str(file.relative_to(folder) if file.is_relative_to(folder) else file))
            mode = file.stat().st_mode
            if HAS_MODES and mode & OTHERS_WRITE:  # numba leaves them as the umask says
                file.chmod(stat.S_IMODE(mode) & ~OTHERS_WRITE)
        _write(_stamp(folder, text, entry), "\n".join(sorted(lines)).encode())


def _image(folder: Path, name: str) -> Path:
    return folder / f"{name}.{_processor()}.image"


def _seal(name: str, content: bytes) -> bytes:
    """Return what vouches for object code under its name."""
    return hashlib.sha256(name.encode() + content).digest()


def has_image(name: str) -> bool:
    """Whether there is a file of object code of this name, for this kind of processor."""
    try:
        return _image(_trusted(_resolved(cache_directory())), name).exists()
    except OSError:
        return False


def image_of(name: str) -> bytes | None:
    """Return the object code of a name, unless it is absent, damaged, or may be another's.

    Parameters
    ----------
    name : str
        Name of the object code, which says all that it depends on but the processor.

    Returns
    -------
    bytes or None
        The object code.
    """
    try:
        folder = _made_folder()
        path = _image(folder, name)
        if not path.exists() and not path.is_symlink():
            return None
        _refuse_foreign_files(folder, [path])
        content = path.read_bytes()
    except OSError as error:
        _warn(cache_directory(), error.strerror or str(error))
        return None
    seal, content = content[:SEAL], content[SEAL:]
    return content if seal == _seal(name, content) else None


def keep_image(name: str, content: bytes) -> None:
    """Keep object code in a file; a folder that cannot be written to is no obstacle.

    Parameters
    ----------
    name : str
        Name of the object code.
    content : bytes
        The object code.
    """
    with contextlib.suppress(OSError):
        _write(_image(_made_folder(), name), _seal(name, content) + content)
