"""Fits candidates at the same time, watched and stopped from here."""

import math
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, TypeVar

from stickslip.friction import BristleLaw
from stickslip.selection.specifications import Specification

__all__ = ["Fitted", "fitted_side_by_side", "takes_long"]

PATIENCE = 0.2
"""Time between looks at whether the search is still wanted [s]."""

Watch = Callable[[str, float], object]


class Residual(Protocol):
    """What a fit leaves."""

    @property
    def rms(self) -> float:
        """Root mean square."""


class Tried(Protocol):
    """A candidate with its fit, if there is one."""

    @property
    def name(self) -> str:
        """Key of the candidate."""

    @property
    def fit(self) -> Residual | None:
        """The fit."""


C = TypeVar("C", bound=Tried)
C_co = TypeVar("C_co", bound=Tried, covariant=True)


class Fitted(Protocol[C_co]):
    """Fits one candidate; may be sent to other processes."""

    def __call__(self, one: Specification, watch: Watch | None = None, /) -> C_co:
        """Return the candidate with its fit."""


@dataclass(frozen=True)
class _Wanted:
    """Says in any process of this machine whether a search is to go on: a file ends it."""

    end: Path

    def __call__(self, _name: str, _residual: float) -> bool:
        return not self.end.exists()


def fitted_side_by_side(
    fitted: Fitted[C],
    chosen: Sequence[Specification],
    watch: Watch | None,
    executor: Executor | None,
) -> list[C]:
    """Return the candidates in order, each fitted by a worker; without any, one after the other.

    `watch` is called here: with the least residual of each candidate when its search ends, and in
    between to ask whether to go on. When it answers False, searches end with the best so far.
    """
    if executor is None:
        return [fitted(one, watch) for one in chosen]
    with tempfile.TemporaryDirectory() as folder:
        wanted = _Wanted(Path(folder, "end"))
        # what takes longest begins first, so that no worker waits for it alone at the end
        order = sorted(chosen, key=lambda one: not takes_long(one.law))
        futures = {executor.submit(fitted, one, wanted): one for one in order}
        pending: set[Future[C]] = set(futures)
        while pending:
            done, pending = wait(pending, timeout=PATIENCE, return_when=FIRST_COMPLETED)
            news = [(one.result().name, _residual(one.result())) for one in done]
            news += [(futures[one].name, math.nan) for one in futures if one in pending][:1]
            if watch is not None and any(watch(*item) is False for item in news):
                wanted.end.touch()
        found = {one.name: future.result() for future, one in futures.items()}
    return [found[one.name] for one in chosen]


def takes_long(law: object) -> bool:
    """Whether fits of a law, or of a type of law, take several times as long as those of most."""
    return issubclass(law if isinstance(law, type) else type(law), BristleLaw)


def _residual(candidate: Tried) -> float:
    return candidate.fit.rms if candidate.fit else math.nan
