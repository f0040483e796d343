"""Pages run once: what their cells print is kept until anything changes that it can depend on."""

import hashlib
import importlib.metadata
import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from jupyter_cache import get_cache

EXTENSIONS = Path(__file__).parent
ROOT = EXTENSIONS.parents[1]
KEPT = EXTENSIONS.parent / "_build" / "executed"


def sources() -> Iterator[Path]:
    """Files that decide what a cell prints, beside the cells of its page."""
    yield from (EXTENSIONS / "examples.py", EXTENSIONS / "commands.py")
    yield from sorted((ROOT / "docs/howto/files").glob("*.zip"))
    for path in sorted((ROOT / "src").rglob("*")):
        if path.is_file() and "__pycache__" not in path.parts:
            yield path


def digest() -> str:
    """Return a hash of the package, of all that is installed, and of where records are."""
    installed = {f"{d.name} {d.version}" for d in importlib.metadata.distributions()}
    text = [sys.version, os.environ.get("STICKSLIP_DATA", ""), *sorted(installed)]
    whole = hashlib.sha256("\n".join(text).encode())
    for path in sources():
        whole.update(f"\n{path.relative_to(ROOT)}\n".encode())
        whole.update(hashlib.sha256(path.read_bytes()).digest())
    return whole.hexdigest()[:32]


def kept() -> str:
    """Return the folder of what was printed by this package, and remove that of others."""
    folder = KEPT / digest()
    for other in KEPT.glob("*"):
        if other != folder:
            shutil.rmtree(other)
    assert get_cache(folder).db  # made here, as processes that read pages side by side would race
    return str(folder)
