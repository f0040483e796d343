"""Which laws a measurement is compared with, which of them suit it, and how that is watched."""

import math
import tempfile
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, Protocol, TypeAlias, TypeVar

from stickslip.errors import InputError
from stickslip.friction import (
    CandidateSpec,
    FrictionLaw,
    specification,
    usual_specifications,
)

LEFT_OUT = "skipped: the search was stopped"
"""Why a candidate has no fit whose turn did not come."""
Watch: TypeAlias = Callable[[str, float], object]
"""Called with a candidate and the least residual so far, not a number before it begins.

False ends the search of a candidate that has begun, and leaves out one that has not. Judging, of
which each candidate is told as ``"held-out blocks: <its name>, 2 of 10"``, is never cut short: what
was compared on other blocks than the rest could not be ranked.
"""
PATIENCE = 0.2
"""Time between looks at whether the search is still wanted [s]."""


def specifications(
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
) -> tuple[CandidateSpec, ...]:
    """Return the candidates: those given, or all that records may be compared with by default.

    A name stands for the candidate of that name, or for a law with all it can fit.

    Examples
    --------
    >>> [one.name for one in specifications(None)][:3]
    ['viscous', 'coulomb', 'coulomb-viscous']
    >>> [one.title for one in specifications(["coulomb", "dahl-exponent"])]
    ['Coulomb', 'Dahl with exponent']
    """
    if laws is None:
        return usual_specifications()
    if isinstance(laws, Mapping):
        found = [CandidateSpec.of(name, law) for name, law in laws.items()]
    else:
        found = [
            specification(one) if isinstance(one, str) else CandidateSpec.of(one.name, one)
            for one in laws
        ]
    check_any(found)
    check_apart([one.name for one in found])
    return tuple(found)


def check_any(laws: Collection[object]) -> None:
    """Refuse to compare no laws at all."""
    if not laws:
        raise InputError("no friction law was given: name at least one in `laws`.")


def check_apart(names: Sequence[str]) -> None:
    """Refuse candidates of one name, of which results would tell only one.

    Examples
    --------
    >>> check_apart(["coulomb", "viscous"])
    """
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise InputError(
            f"two of `laws` are called {twice[0]!r}: give a mapping with a name for each, such as"
            f' {{"{twice[0]}-a": ..., "{twice[0]}-b": ...}}.'
        )


class Residual(Protocol):
    """What a fit leaves."""

    @property
    def rms(self) -> float:
        """Root mean square."""


class Tried(Protocol):
    """A candidate with its fit, if there is one."""

    @property
    def fit(self) -> Residual | None:
        """The fit."""


C = TypeVar("C", bound=Tried)


@dataclass(frozen=True)
class _Wanted:
    """Says in any process of this machine whether a search is to go on: a file ends it."""

    end: Path

    def __call__(self, _name: str, _residual: float) -> bool:
        return not self.end.exists()


@dataclass(frozen=True)
class _Workers(Generic[C]):
    """Candidates in the work of other processes, watched and stopped from this one."""

    executor: Executor
    watch: Watch | None
    wanted: _Wanted
    futures: dict[Future[C], str] = field(default_factory=dict)
    """What is in work, with the name of the candidate."""

    def begin(self, name: str, work: Callable[..., C], *arguments: object) -> None:
        """Begin work, which is given what says whether it is still wanted as its last argument."""
        self.futures[self.executor.submit(work, *arguments, self.wanted)] = name

    def ended(self) -> dict[str, C]:
        """Wait a moment; return by name what has ended since, and ask whether to go on."""
        done, _ = wait(self.futures, timeout=PATIENCE, return_when=FIRST_COMPLETED)
        found = {self.futures.pop(future): future.result() for future in done}
        news = [(name, _residual(one)) for name, one in found.items()]
        news += [(name, math.nan) for name in self.futures.values()][:1]
        if self.watch is not None and any(self.watch(*item) is False for item in news):
            self.wanted.end.touch()
        return found


@contextmanager
def watched(executor: Executor, watch: Watch | None) -> Iterator[_Workers[Any]]:
    """Let workers fit candidates while somebody watches here."""
    with tempfile.TemporaryDirectory() as folder:
        yield _Workers(executor, watch, _Wanted(Path(folder, "end")))


def fitted_side_by_side(
    fitted: Callable[..., C],
    chosen: Sequence[CandidateSpec],
    watch: Watch | None,
    executor: Executor | None,
) -> list[C]:
    """Return the candidates in order, each fitted by a worker; without any, one after the other.

    `watch` is called here: with the least residual of each candidate when its search ends, and in
    between to ask whether to go on. When it answers False, searches end with the best so far.
    """
    if executor is None:
        return [fitted(one, watch) for one in chosen]
    found: dict[str, C] = {}
    with watched(executor, watch) as workers:
        for one in chosen:
            workers.begin(one.name, fitted, one)
        while len(found) < len(chosen):
            found.update(workers.ended())
    return [found[one.name] for one in chosen]


def _residual(candidate: Tried) -> float:
    return candidate.fit.rms if candidate.fit else math.nan
