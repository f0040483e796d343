"""The memory of a search: what came of every motion tried, in a file that survives a crash."""

import hashlib
import json
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias, final

from stickslip.documents import unwritable, write_file
from stickslip.errors import InputError

Row: TypeAlias = tuple[float, float]
"""Goal and violation of one motion."""
FORM = "stickslip/profile-search/1"


@final
class Memory:
    """Goals and violations by search and generation; what a file has already is not run again.

    A search asks for the same motions again in the same order, so their results are all there is
    to know: no random state is kept, and the file is plain JSON.

    Parameters
    ----------
    path : str, Path or None
        File of the memory; None keeps it in this process only.
    subject : str
        Text of the problem; a file that belongs to another one is refused.

    Raises
    ------
    InputError
        If the file cannot be read or written, or belongs to another problem.

    Examples
    --------
    >>> memory = Memory(None, "one problem")
    >>> memory.recall("spline", 0) is None
    True
    >>> memory.keep("spline", [(0.06, 0.0)])
    >>> memory.recall("spline", 0)
    [(0.06, 0.0)]
    """

    def __init__(self, path: str | Path | None, subject: str) -> None:
        if not (path is None or isinstance(path, (str, os.PathLike))):
            raise InputError(f"state must be the path of a file, got {path!r}.")
        self.path = None if path is None else Path(path)
        self.digest = hashlib.sha256(subject.encode()).hexdigest()
        self.searches: dict[str, list[list[Row]]] = {}
        if self.path is not None and self.path.exists():
            self.searches = self._read(self.path)
        if self.path is not None:
            _refuse_unwritable(self.path)

    def recall(self, search: str, generation: int) -> list[Row] | None:
        """Return what came of a generation, if that is known."""
        known = self.searches.get(search, [])
        return known[generation] if generation < len(known) else None

    def keep(self, search: str, rows: Sequence[Row]) -> None:
        """Add a generation; the file appears whole or not at all."""
        self.searches.setdefault(search, []).append(list(rows))
        if self.path is not None:
            content = {"form": FORM, "problem": self.digest, "searches": self.searches}
            write_file(self.path, json.dumps(content))

    def _read(self, path: Path) -> dict[str, list[list[Row]]]:
        try:
            content: Any = json.loads(path.read_text(encoding="utf-8"))
            if content["form"] != FORM:
                raise KeyError
            found = {
                str(name): [[(float(a), float(b)) for a, b in rows] for rows in generations]
                for name, generations in content["searches"].items()
            }
            digest = content["problem"]
        except OSError as error:
            raise InputError(f"{path} cannot be read: {error.strerror}.") from error
        except (AttributeError, KeyError, RecursionError, TypeError, ValueError):
            raise InputError(
                f"{path} is not the saved state of a profile search: name another file, or remove"
                " it."
            ) from None
        if digest != self.digest:
            raise InputError(
                f"{path} is the saved state of another search (different mechanism, law, goal,"
                " limit, seed, number of evaluations, or version): repeat the same request, or"
                " name another file."
            )
        return found


def _refuse_unwritable(path: Path) -> None:
    """Say at once what writing would only say after the first generation."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise unwritable(path, error) from error
