"""Fits candidates at the same time, watched and stopped from here."""

import math
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from stickslip.friction import CandidateSpec, FrictionLaw
from stickslip.identification import FittedLaw
from stickslip.selection.candidates import Watch, contains

PATIENCE = 0.2
"""Time between looks at whether the search is still wanted [s]."""


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

    @property
    def fitted_law(self) -> FittedLaw | None:
        """The fit as searches of richer laws begin from it, if they can."""


C = TypeVar("C", bound=Tried)
C_co = TypeVar("C_co", bound=Tried, covariant=True)


class Fitted(Protocol[C_co]):
    """Fits one candidate; may be sent to other processes."""

    def __call__(
        self,
        one: CandidateSpec,
        contained: Sequence[FittedLaw],
        rival: float,
        watch: Watch | None = None,
        /,
    ) -> C_co:
        """Return the candidate with its fit, whose search begins from contained laws too.

        It may be cut short if it leaves far more than a mean square, that of a `rival`.
        """


@dataclass(frozen=True)
class _Wanted:
    """Says in any process of this machine whether a search is to go on: a file ends it."""

    end: Path

    def __call__(self, _name: str, _residual: float) -> bool:
        return not self.end.exists()


@dataclass(frozen=True)
class Workers(Generic[C]):
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
def watched(executor: Executor, watch: Watch | None) -> Iterator[Workers[Any]]:
    """Let workers fit candidates while somebody watches here."""
    with tempfile.TemporaryDirectory() as folder:
        yield Workers(executor, watch, _Wanted(Path(folder, "end")))


def fitted_side_by_side(
    fitted: Fitted[C],
    chosen: Sequence[CandidateSpec],
    watch: Watch | None,
    executor: Executor | None,
    found: dict[str, C] | None = None,
) -> list[C]:
    """Return the candidates in order, each fitted by a worker; without any, one after the other.

    A candidate is fitted after those that it contains, from which its search begins too. Those
    that take long are fitted last, and are told the least mean square of the others.

    `watch` is called here: with the least residual of each candidate when its search ends, and in
    between to ask whether to go on. When it answers False, searches end with the best so far.
    """
    found = {} if found is None else found
    waiting = [one for one in chosen if one.name not in found]
    if executor is None:
        while waiting:
            one = next(one for one in waiting if not _awaited(one, waiting))
            found[one.name] = fitted(
                one, _contained(one, chosen, found), _rival(one, chosen, found), watch
            )
            waiting.remove(one)
        return [found[one.name] for one in chosen]
    with watched(executor, watch) as workers:
        while unfinished := [one for one in chosen if one.name not in found]:
            for one in [one for one in waiting if not _awaited(one, unfinished)]:
                nested, rival = _contained(one, chosen, found), _rival(one, chosen, found)
                workers.begin(one.name, fitted, one, nested, rival)
                waiting.remove(one)
            found.update(workers.ended())
    return [found[one.name] for one in chosen]


def _awaited(one: CandidateSpec, unfinished: Sequence[CandidateSpec]) -> bool:
    """Whether a fit has not ended that is to end before that of a candidate."""
    return any(
        contains(one, other) or _knows(one, other) for other in unfinished if other is not one
    )


def _knows(one: CandidateSpec, other: CandidateSpec) -> bool:
    """Whether a candidate is fitted with what another leaves in mind."""
    return takes_long(one.law) and not takes_long(other.law) and not contains(other, one)


def _rival(
    one: CandidateSpec, chosen: Sequence[CandidateSpec], found: Mapping[str, Tried]
) -> float:
    """Return the least mean square of those whose fits ended before; 0 if none did."""
    known = (found[other.name].fitted_law for other in chosen if _knows(one, other))
    return min((law.cost / law.rows for law in known if law is not None), default=0.0)


def _contained(
    one: CandidateSpec, chosen: Sequence[CandidateSpec], found: Mapping[str, Tried]
) -> tuple[FittedLaw, ...]:
    """Return the fits of candidates that a candidate contains."""
    # in an order of their own: what a search comes to must not hang on that of the candidates
    ordered = sorted(chosen, key=lambda other: other.name)
    simpler = (found[other.name].fitted_law for other in ordered if contains(one, other))
    return tuple(law for law in simpler if law is not None)


def takes_long(law: FrictionLaw | type[FrictionLaw] | None) -> bool:
    """Whether fits of a law, or of a type of law, take several times as long as those of most."""
    return law is not None and bool(law.states)


def _residual(candidate: Tried) -> float:
    return candidate.fit.rms if candidate.fit else math.nan
