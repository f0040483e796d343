"""JSON documents, files that are read whole or hashed, and those written whole or not at all."""

import contextlib
import ctypes
import dataclasses
import enum
import errno
import glob
import hashlib
import json
import math
import os
import re
import secrets
import shutil
import signal
import stat
import sys
import tempfile
import threading
import time
from collections.abc import Collection, Iterator, Mapping, Sequence
from io import BufferedReader
from pathlib import Path
from typing import Any
from xml.parsers import expat

from stickslip.errors import InputError

SCHEMA_VERSION = 1
LIST = ".stickslip"
"""File that lists what was written into a folder, with hashes."""
ABANDONED = 3600.0
"""Age from which a temporary folder is taken to be left by a process that was killed [s]."""
YOUNG = 10.0
"""Age up to which a folder for temporary files may not have its lock yet [s]."""
NOT_XML = (expat.ExpatError, LookupError, ValueError)
"""What the parser raises; of encodings that are unknown, or of several bytes, not its own error."""
DEEPEST = 200
"""Elements of a model within each other at most."""
MOST_ELEMENTS = 200_000
"""Elements of a model at most."""
PRIVATE = "stickslip-private-"
"""Beginning of the names of folders for temporary files."""
LARGEST = 20_000_000
"""Bytes of a model that are read at most; meshes are in files of their own."""
UNFINISHED = re.compile(r"\.(.+)\.tmp-[0-9a-f]{8}", re.DOTALL)
"""Name of a file while it is written."""


def open_regular(path: Path) -> BufferedReader:
    """Open a file for reading; fail, and do not wait, where it is a pipe or a device."""

    def opener(name: str, flags: int) -> int:
        return os.open(name, flags | getattr(os, "O_NONBLOCK", 0))

    file = open(path, "rb", opener=opener)  # noqa: SIM115  # Path.open has no opener
    if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        file.close()
        raise OSError(errno.EINVAL, "is not a regular file")
    return file


def regular_bytes(path: Path) -> bytes:
    """Return the bytes of a file, or fail as `open_regular` does."""
    with open_regular(path) as file:
        return file.read()


def read_bytes(path: Path, name: str = "") -> bytes:
    """Return the bytes of a model, which messages call by a name or its path."""
    name = name or str(path)
    try:
        with open_regular(path) as stream:
            data = stream.read(LARGEST + 1)
    except OSError as error:
        raise InputError(f"{name} cannot be read: {error.strerror or error}.") from None
    if len(data) > LARGEST:
        raise InputError(f"{name} has more than {LARGEST} bytes, too many for a model.")
    return data


def sha256_of(path: Path) -> str:
    """Return the checksum of a file, as ``sha256sum`` prints it."""
    with open_regular(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def with_files(digest: str, files: Sequence[Path]) -> str:
    """Return the SHA-256 of a digest and the contents of files; the digest as it is without any.

    Names do not count: a file that was moved is the same input.

    Examples
    --------
    >>> with_files("0123", [])
    '0123'
    """
    if not files:
        return digest
    whole = hashlib.sha256(digest.encode())
    for path in files:
        with open_regular(path) as file:
            whole.update(hashlib.file_digest(file, "sha256").digest())
    return whole.hexdigest()


def of_files(files: Sequence[Path]) -> dict[str, str]:
    """Return the SHA-256 of each file by its name, as ``sha256sum`` prints it.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "record.csv")
    ...     _ = file.write_text("")
    ...     of_files([file])["record.csv"][:8]
    'e3b0c442'
    """
    return {path.name: sha256_of(path) for path in files}


def check_xml(data: bytes, name: str) -> None:
    """Refuse what is not well-formed XML, or stands for more than its length.

    Entities may stand for any length. Functions that call themselves go down elements within
    elements, and an element takes a hundred times the memory of its tag.
    """
    parser = expat.ParserCreate()
    depth = elements = 0

    def refuse(*_: object) -> None:
        raise InputError(f"{name} declares entities, which models do not need: leave them out.")

    def begin(*_: object) -> None:
        nonlocal depth, elements
        depth, elements = depth + 1, elements + 1
        if depth > DEEPEST:
            raise InputError(f"{name} has elements nested more than {DEEPEST} deep.")
        if elements > MOST_ELEMENTS:
            raise InputError(f"{name} has more than {MOST_ELEMENTS:,} elements.")

    def finish(*_: object) -> None:
        nonlocal depth
        depth -= 1

    parser.StartElementHandler, parser.EndElementHandler = begin, finish
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except InputError:
        raise
    except NOT_XML as error:
        raise InputError(f"{name} is not XML: {error}.") from None


def document(kind: str, content: Mapping[str, Any]) -> dict[str, Any]:
    """Return a JSON document of a kind, with the version of its form.

    Examples
    --------
    >>> document("fit", {"rms": math.nan})["rms"] is None
    True
    """
    from importlib.metadata import version

    head = {"schema": f"stickslip/{kind}/{SCHEMA_VERSION}", "stickslip": version("stickslip")}
    return {**head, **json_value(content)}


def json_text(content: Mapping[str, Any]) -> str:
    """Return a JSON document as text."""
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_folder(
    folder: Path, files: Mapping[str, str | bytes], *, stale: Collection[str] = ()
) -> None:
    """Write files into a folder so that at any moment it holds the old ones or the new ones.

    A list of the files with their hashes is kept beside them (`LIST`). Only files of this list that
    nobody has changed since are replaced or removed; all others in the folder stay as they are.

    Where the operating system can exchange two folders in one step (Linux), the new folder is made
    beside the old one and takes its place. Elsewhere, and in the working directory, where there is
    no folder beside, the old files go before the new ones come, and the first is replaced in one
    step: who ends the process between leaves some of the old files or some of the new, never both.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as place:
    ...     write_folder(Path(place) / "report", {"index.html": "first"})
    ...     write_folder(Path(place) / "report", {"index.html": "second"})
    ...     (Path(place) / "report" / "index.html").read_text()
    'second'
    """
    contents = {name: _encoded(folder / name, text) for name, text in files.items()}
    check_replaceable(folder, files)
    before = _listed(folder) or {}
    gone = {name for name in set(stale) - set(files) if _is_listed(folder / name, before)}
    if not (contents or gone):
        return
    after = {name: digests for name, digests in before.items() if name not in gone}
    after |= {name: [hashlib.sha256(data).hexdigest()] for name, data in contents.items()}
    try:
        target = folder.resolve()
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            _exchange_folder(target, {**contents, LIST: _list(after)}, gone)
        except OSError:  # another system, a mount point, a file that cannot be linked, no room
            target.mkdir(exist_ok=True)
            # Whenever it ends, what is there is on the list, and may be replaced the next time.
            both = {name: before.get(name, []) + after.get(name, []) for name in before | after}
            files_there = [(target / name, data) for name, data in contents.items()]
            lists = [(target / LIST, _list(digests)) for digests in (both, after)]
            stale_there = [target / name for name in (*list(contents)[1:], *gone)]
            _write_each([lists[0], *files_there, lists[1]], before=1, gone=stale_there)
    except OSError as error:
        raise unwritable(folder, error) from error


def unwritable(path: Path, error: OSError) -> InputError:
    """Return the error of a file or folder that cannot be written."""
    return InputError(f"{path} cannot be written: {error.strerror or error}.")


def check_replaceable(folder: Path, names: Collection[str]) -> None:
    """Refuse to replace files in a folder that were not written there, or changed since."""
    listed = _listed(folder)
    wrong = [name for name in names if not _is_listed(folder / name, listed or {})]
    for name in [*wrong, *([LIST] if listed is None else [])]:
        if os.path.lexists(folder / name):
            what = "was changed since" if name in (listed or {}) else "was not written by stickslip"
            raise InputError(
                f"{folder / name} {what}, so it is not replaced: move or delete it, or choose"
                " another folder."
            )


def is_earlier(folder: Path, names: Collection[str]) -> bool:
    """Return whether a folder holds nothing but files of these names as they were written there.

    What a process that was killed has left of such a file counts as one.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as place:
    ...     folder = Path(place) / "report"
    ...     write_folder(folder, {"index.html": "first"})
    ...     first = is_earlier(folder, ["index.html"])
    ...     _ = (folder / "notes.txt").write_text("mine")
    ...     first, is_earlier(folder, ["index.html"])
    (True, False)
    """
    listed, found = _listed(folder), [*folder.iterdir()]
    ours = {LIST, *names} if listed is not None else set()
    return bool(found) and all(
        path.is_file() and not path.is_symlink() and becomes(path) in {LIST, *names}
        if becomes(path)
        else path.name in ours and (path.name == LIST or _is_listed(path, listed or {}))
        for path in found
    )


def write_files(files: Mapping[Path, str | bytes]) -> None:
    """Write files that belong together; old ones never stand beside new ones."""
    contents = {path: _encoded(path, text) for path, text in files.items()}
    path = next(iter(contents))
    try:
        for path in contents:
            path.parent.mkdir(parents=True, exist_ok=True)
        _write_each(list(contents.items()), before=0, gone=list(contents)[1:])
    except OSError as error:
        raise unwritable(path, error) from error


def _encoded(path: Path, content: str | bytes) -> bytes:
    """Return what is written to a file; UTF-8 has no bytes of names that are none themselves."""
    try:
        return content if isinstance(content, bytes) else content.encode("utf-8")
    except UnicodeEncodeError as error:
        text = ascii(error.object[max(error.start - 20, 0) : error.end + 20])
        raise InputError(
            f"{path} cannot be written: it would have {text}, which is not UTF-8: rename the file"
            " or folder, or give another text."
        ) from None


def write_file(path: Path, content: str | bytes) -> None:
    """Write a file so that it appears whole or not at all."""
    write_files({path: content})


def remove_unfinished(folder: Path, names: Collection[str]) -> None:
    """Remove what a process that was killed has left of files that it was writing to a folder.

    Nobody else may be writing these files.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as place:
    ...     left = Path(place) / ".runs.csv.tmp-0123abcd"
    ...     _ = left.write_text("x")
    ...     remove_unfinished(Path(place), ["runs.csv"])
    ...     left.exists()
    False
    """
    for path in folder.iterdir() if folder.is_dir() else ():
        if becomes(path) in names:
            with contextlib.suppress(OSError):
                path.unlink()


def becomes(path: Path) -> str:
    """Return the name of the file that a temporary one becomes; empty of other files."""
    result = UNFINISHED.fullmatch(path.name)
    return result[1] if result else ""


@contextlib.contextmanager
def private_folder() -> Iterator[Path]:
    """Make a folder for temporary files, which is removed however the work with it ends.

    It also ends by the signal to terminate. What a process that was killed has left is removed by
    the next one, which finds that nobody holds the lock of the folder any more.

    Examples
    --------
    >>> with private_folder() as place:
    ...     _ = (place / "large").write_text("x")
    >>> place.exists()
    False
    """
    _remove_abandoned()
    with _ending_orderly(), tempfile.TemporaryDirectory(prefix=PRIVATE) as name:
        place = Path(name)
        with (place / ".lock").open("wb") as lock:
            is_free(lock.fileno())
            yield place


@contextlib.contextmanager
def _ending_orderly() -> Iterator[None]:
    """Let the signal to terminate end the work by an exception, unless somebody handles it."""
    own = threading.current_thread() is threading.main_thread()
    if not own or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield
        return

    def end(number: int, _: object) -> None:
        raise SystemExit(128 + number)

    signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def is_free(lock: int) -> bool:
    """Take the lock of an open file, and return whether nobody had it.

    The system frees it when the file is closed, or the process ends in whatever way.
    """
    try:
        _take(lock)
    except OSError:  # held by another
        return False
    return True


def _take(lock: int) -> None:
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(lock, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _remove_abandoned() -> None:
    """Remove folders for temporary files that processes of the same user have left."""
    for left in Path(tempfile.gettempdir()).glob(f"{PRIVATE}*"):
        with contextlib.suppress(OSError):
            result = left.lstat()
            old = time.time() - result.st_mtime > YOUNG
            # Windows has a folder for each user.
            user = os.getuid() if hasattr(os, "getuid") else result.st_uid
            if old and stat.S_ISDIR(result.st_mode) and result.st_uid == user:
                with open_regular(left / ".lock") as lock:
                    abandoned = is_free(lock.fileno())
                if abandoned:  # after it is closed: Windows removes no open file
                    shutil.rmtree(left)


def _list(digests: Mapping[str, Sequence[str]]) -> bytes:
    return json_text(document("files", {"files": digests})).encode()


def _listed(folder: Path) -> dict[str, list[str]] | None:
    """Return the hashes that files written into a folder may have, by name; None without a list."""
    try:
        content = json.loads(regular_bytes(folder / LIST))
        if content["schema"] != f"stickslip/files/{SCHEMA_VERSION}":
            return None
        return {str(name): list(map(str, hashes)) for name, hashes in content["files"].items()}
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return None


def _is_listed(path: Path, listed: Mapping[str, Collection[str]]) -> bool:
    """Whether a file is as it was written."""
    if path.is_symlink() or not path.is_file() or path.name not in listed:
        return False
    return hashlib.sha256(path.read_bytes()).hexdigest() in listed[path.name]


def _exchange_folder(folder: Path, contents: Mapping[str, bytes], gone: Collection[str]) -> None:
    """Make a folder beside another with all that stays, and let it take its place in one step."""
    if Path.cwd().is_relative_to(folder):
        raise OSError(errno.EBUSY, "is the working directory")
    _sweep_up(folder)
    new = folder.with_name(f".{folder.name}.tmp-{secrets.token_hex(4)}")
    new.mkdir()
    try:
        left_out = {*contents, *gone}
        if folder.exists():
            shutil.copystat(folder, new)

            def ignored(where: str, names: list[str]) -> set[str]:
                return left_out.intersection(names) if Path(where) == folder else set()

            # Not copied but linked: who has a file open goes on writing to the same one.
            shutil.copytree(
                folder,
                new,
                symlinks=True,
                ignore=ignored,
                copy_function=os.link,
                dirs_exist_ok=True,
            )
        for name, data in contents.items():
            _write_new(new / name, data)
        if folder.exists():
            _exchange(new, folder)
            for late in new.iterdir():  # now the old folder: what somebody has just put there
                if late.name not in left_out and not os.path.lexists(folder / late.name):
                    late.rename(folder / late.name)
        else:
            new.rename(folder)
    except shutil.Error as error:  # of many files
        raise OSError(errno.EIO, "a file cannot be linked") from error
    finally:
        shutil.rmtree(new, ignore_errors=True)


def _sweep_up(folder: Path) -> None:
    """Remove what processes that were killed have left beside a folder."""
    for left in folder.parent.glob(f".{glob.escape(folder.name)}.tmp-*"):
        with contextlib.suppress(OSError):
            if time.time() - left.stat().st_ctime > ABANDONED:
                shutil.rmtree(left)


def _exchange(path: Path, other: Path) -> None:
    """Exchange two folders in one step, where the system can."""
    libc = ctypes.CDLL(None, use_errno=True) if sys.platform == "linux" else None
    call = getattr(libc, "renameat2", None)
    if call is None:
        raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))
    here, exchange = -100, 2  # AT_FDCWD and RENAME_EXCHANGE of the Linux kernel
    if call(here, os.fsencode(path), here, os.fsencode(other), exchange):
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def _write_each(
    contents: Sequence[tuple[Path, bytes]], *, before: int, gone: Collection[Path]
) -> None:
    """Write files one after the other, of which all were made before one is put in its place.

    What has to be gone is removed just before the file with the number `before`.
    """
    made: list[tuple[Path, Path]] = []
    try:
        for path, data in contents:
            made.append((path, _beside(path, data)))
        for index, (path, temporary) in enumerate(made):
            if index == before:
                for old in gone:
                    old.unlink(missing_ok=True)
            temporary.replace(path)
    finally:
        for _, temporary in made:
            temporary.unlink(missing_ok=True)


def json_value(value: Any) -> Any:
    """Return a value as JSON has it: no number is null, and dataclasses are objects.

    Arrays become lists, members of an enumeration their names, and what has `to_dict` that.

    Examples
    --------
    >>> json_value({"rms": math.nan, "ends": (0.0, 1.0), "file": Path("run.csv")})
    {'rms': None, 'ends': [0.0, 1.0], 'file': 'run.csv'}
    """
    if isinstance(value, float):
        return value + 0.0 if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): json_value(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [json_value(item) for item in value]
    if isinstance(value, enum.Enum):
        return value.name
    for method in ("to_dict", "tolist"):
        if hasattr(value, method):
            return json_value(getattr(value, method)())
    if dataclasses.is_dataclass(value):
        return {
            part.name: json_value(getattr(value, part.name)) for part in dataclasses.fields(value)
        }
    return str(value) if isinstance(value, Path) else value


def _beside(path: Path, content: bytes) -> Path:
    """Write a temporary file beside a path."""
    temporary = path.with_name(f".{path.name[:100]}.tmp-{secrets.token_hex(4)}")
    _write_new(temporary, content)
    return temporary


def _write_new(path: Path, content: bytes) -> None:
    """Write a file that is not there yet; leave none if that fails."""
    try:
        with path.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
    except BaseException:
        path.unlink(missing_ok=True)
        raise
