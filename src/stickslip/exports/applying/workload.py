"""What a model asks of MuJoCo, refused before any of it is done.

A few characters of a model stand for any amount of memory or time: copies of a body, points of a
cloth, sizes of arenas and tables, steps of a nanosecond, solvers that never stop. MuJoCo does what
it is told. Textures and skins, which no motion depends on, are left out (`running.py`).
"""

import contextlib
import math
import re
import stat
import time
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Final, TypeVar

from stickslip.errors import InputError, check_size
from stickslip.exports.applying.markup import Markup, Tag

T = TypeVar("T")
CURE: Final = "run a smaller model, with the same joints"
MOST_ELEMENTS: Final = 20_000
"""Elements of a model, copies included: large robots with their rooms have some thousand."""
MOST_NUMBERS: Final = 10_000_000
"""Numbers of a table that a model has MuJoCo make."""
MOST_ITERATIONS: Final = 10_000
"""Iterations of a solver in a step; the default is 100."""
MOST_STEPS: Final = 500_000
"""Steps of a motion: ten seconds of 20 us."""
LARGEST_FILE: Final = 200_000_000
"""Bytes of a file that a model names, such as a mesh."""
LARGEST_ARENA: Final = 2**30
LARGEST_GROWTH: Final = 4 * 2**30
"""Bytes that MuJoCo may take for a model: its arena, its tables and what makes them."""
LONGEST: Final = 120.0
"""Processor time that a motion may take [s]."""
COPIES: Final = ("replicate", "composite", "flexcomp")
COUNTS: Final = ("nrow", "ncol", "dim", "nsample", "ninterp", "maxhullvert", "octree_maxdepth")
ITERATIONS: Final = ("iterations", "ls_iterations", "noslip_iterations", "ccd_iterations")
FOLDERS: Final = ("meshdir", "texturedir", "assetdir")
_BYTES: Final = re.compile(r"\s*(\d{1,30})([kmgtpe]?)\s*", re.IGNORECASE)


def check_workload(parts: list[Markup]) -> None:
    """Refuse a model, in the files that it is made of, that takes more than a robot does."""
    main = parts[0].path
    dirs = {
        tag.attributes[key] for one in parts for tag in one.root.walk() for key in FOLDERS
        if key in tag.attributes
    }  # fmt: skip
    total = 0.0
    for part in parts:
        for tag, copies in _copied(part.root, 1.0):
            total += copies
            where = f"{part.path}, line {tag.line}"
            check_size(str(main), total, CURE, unit="elements", most=MOST_ELEMENTS)
            for what, amount, most in _amounts(tag):
                check_size(f"{where}: {what}", amount * copies, CURE, unit="of it", most=most)
            _check_files(tag, where, {main.parent, part.path.parent}, dirs)


def check_steps(path: Path, time: float, step: float) -> None:
    """Refuse a motion of so many steps that it takes minutes."""
    steps = time / step if step > 0.0 else math.inf
    check_size(
        f"{path}: time step of {step:g} s", steps, "make it longer", unit="steps", most=MOST_STEPS
    )


@contextlib.contextmanager
def limited_memory() -> Iterator[None]:
    """Let what MuJoCo makes of a model fail where it grows beyond measure, whatever asked for it.

    It is the memory of the process that has a limit meanwhile, where the system knows one.
    """
    try:
        import resource

        pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
        before = resource.getrlimit(resource.RLIMIT_AS)
        limits = [one for one in before if one != resource.RLIM_INFINITY]
        most = min([pages * resource.getpagesize() + LARGEST_GROWTH, *limits])
        resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
    except (ImportError, OSError):  # not Linux
        yield
        return
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def timed(steps: Iterable[T]) -> Iterator[T]:
    """Yield the steps of a motion, unless they take too much processor time.

    Examples
    --------
    >>> [*timed([1.0, 2.0])]
    [1.0, 2.0]
    """
    start = time.process_time()
    for one in steps:
        if time.process_time() - start > LONGEST:
            raise InputError(f"a motion takes more than {LONGEST:g} s of processor time: {CURE}.")
        yield one


def _copied(tag: Tag, copies: float) -> Iterator[tuple[Tag, float]]:
    """Yield each element with how often MuJoCo makes it."""
    if tag.name in COPIES:
        copies *= max(math.prod(_numbers(tag.attributes.get("count", "1"))), 1.0)
    yield tag, copies
    for one in tag.children:
        yield from _copied(one, copies)


def _amounts(tag: Tag) -> Iterator[tuple[str, float, float]]:
    """Yield what an element has MuJoCo make or do, how much of it, and the limit."""
    values: Mapping[str, str] = tag.attributes
    table = math.prod(max(_largest(values[key]), 1.0) for key in COUNTS if key in values)
    yield "numbers", table, MOST_NUMBERS
    for key in ITERATIONS:
        if key in values:
            yield key, _largest(values[key]), MOST_ITERATIONS
    if tag.name == "numeric" and "size" in values:
        yield "numbers", _largest(values["size"]), MOST_NUMBERS
    if "builtin" in values and tag.name == "mesh":
        yield "points of a mesh", _largest(values.get("params", "1")) ** 2, MOST_NUMBERS
    if tag.name == "size":
        for key, text in values.items():
            if key == "memory":
                yield "bytes of memory", _bytes(text), LARGEST_ARENA
            else:
                yield key, _largest(text), MOST_NUMBERS


def _check_files(tag: Tag, where: str, places: set[Path], dirs: set[str]) -> None:
    """Refuse a file that would be read without end, or that is a model within the model."""
    name = tag.attributes.get("file", "")
    if not name or tag.name in ("texture", "skin", "include"):
        return
    for path in (place / folder / name for place in places for folder in ("", *dirs)):
        try:
            found = path.stat()
        except (OSError, ValueError):
            continue
        size = found.st_size if stat.S_ISREG(found.st_mode) else math.inf
        check_size(f"{where}: the file {name}", size, CURE, unit="bytes", most=LARGEST_FILE)
        if tag.name == "model":
            check_size(
                f"{where}: models within the model", 1.0, "include it", unit="files", most=0.0
            )


def _numbers(text: str) -> list[float]:
    found = []
    for word in text.split():
        try:
            found.append(abs(float(word)))
        except ValueError:
            continue  # MuJoCo says what it cannot read
    return found


def _largest(text: str) -> float:
    return max(_numbers(text), default=0.0)


def _bytes(text: str) -> float:
    found = _BYTES.fullmatch(text)
    return float(found[1]) * 1024.0 ** " kmgtpe".index(found[2].lower() or " ") if found else 0.0
