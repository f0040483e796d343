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
from stickslip.experiments import (
    Checks,
    Measurement,
    check,
    findings_text,
    refuse_lack,
    refuse_same,
    refuse_unused,
)
from stickslip.friction import (
    CandidateSpec,
    Coulomb,
    FrictionLaw,
    contained_laws,
    containment_of,
    specification,
    usual_specifications,
)
from stickslip.identification import FittedLaw, inside
from stickslip.mechanisms import Mechanism

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


def checked(
    mechanism: Mechanism,
    measurement: Measurement,
    validate: Measurement | None = None,
    which: str = "This record",
    *,
    unknown: Sequence[str] = (),
    conditions: Collection[str] = (),
) -> Checks:
    """Return what the record can tell; refuse one that cannot decide.

    Parameters of the mechanism that are fitted are named, and conditions of trials that are used.
    """
    if validate is not None:
        refuse_lack(measurement, validate, which="the second record")
        refuse_unused(validate, inside(mechanism, validate))
        refuse_same(measurement, validate)
        checked(
            mechanism,
            validate,
            which="The second record",
            unknown=unknown,
            conditions=conditions,
        )
    checks = check(measurement, mechanism=mechanism, vary=unknown, conditions=conditions)
    if checks.worst == "error":
        wrong = [one for one in checks.findings if one.severity == "error"]
        raise InputError(f"{which} cannot be used for a selection. {findings_text(wrong)}")
    return checks


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


def control() -> CandidateSpec:
    """Return the candidate without friction."""
    law = Coulomb(kinetic_coefficient=0.0)
    return CandidateSpec(name="no-friction", title="No friction", law=law, free=())


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


def contains(rich: CandidateSpec, simple: CandidateSpec) -> bool:
    """Whether a candidate is another one for some values of what is looked for.

    Examples
    --------
    >>> by_name = {one.name: one for one in specifications(None)}
    >>> contains(by_name["dahl-exponent"], by_name["dahl"])
    True
    >>> contains(by_name["lugre"], by_name["dahl-exponent"])
    False
    """
    kinds = [one.law if isinstance(one.law, type) else type(one.law) for one in (rich, simple)]
    free, fewer = (
        set(kind.fit_order if one.free is None else one.free)
        for kind, one in zip(kinds, (rich, simple), strict=True)
    )
    if kinds[0] is kinds[1]:
        return fewer < free
    how = containment_of(kinds[0], kinds[1])
    if how is None:
        return kinds[1].name in contained_laws(kinds[0])
    held = {source for name, source in how.values.items() if name not in free}
    return not (held | set(how.where)) & fewer


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
    fitted: Fitted[C],
    chosen: Sequence[CandidateSpec],
    watch: Watch | None,
    executor: Executor | None,
    found: dict[str, C] | None = None,
    *,
    leader: str = "",
) -> list[C]:
    """Return the candidates in order, each fitted by a worker; without any, one after the other.

    A candidate is fitted after those that it contains, from which its search begins too. Those
    that take long are fitted last, after the `leader`, which is expected to be the best, and are
    told the least mean square of the others.

    `watch` is called here: with the least residual of each candidate when its search ends, and in
    between to ask whether to go on. When it answers False, searches end with the best so far.
    """
    found = {} if found is None else found
    waiting = [one for one in chosen if one.name not in found]
    if executor is None:
        while waiting:
            one = next(one for one in waiting if not _awaited(one, waiting, leader))
            nested, rival = _contained(one, chosen, found), _rival(one, chosen, found, leader)
            found[one.name] = fitted(one, nested, rival, watch)
            waiting.remove(one)
        return [found[one.name] for one in chosen]
    with watched(executor, watch) as workers:
        while unfinished := [one for one in chosen if one.name not in found]:
            for one in [one for one in waiting if not _awaited(one, unfinished, leader)]:
                nested, rival = _contained(one, chosen, found), _rival(one, chosen, found, leader)
                workers.begin(one.name, fitted, one, nested, rival)
                waiting.remove(one)
            found.update(workers.ended())
    return [found[one.name] for one in chosen]


def _awaited(one: CandidateSpec, unfinished: Sequence[CandidateSpec], leader: str) -> bool:
    """Whether a fit has not ended that is to end before that of a candidate."""
    return any(
        contains(one, other) or _knows(one, other, leader)
        for other in unfinished
        if other is not one
    )


def _knows(one: CandidateSpec, other: CandidateSpec, leader: str) -> bool:
    """Whether a candidate is fitted with what another leaves in mind."""
    before = not takes_long(other.law) or other.name == leader != one.name
    return takes_long(one.law) and before and not contains(other, one)


def _rival(
    one: CandidateSpec, chosen: Sequence[CandidateSpec], found: Mapping[str, Tried], leader: str
) -> float:
    """Return the least mean square of those whose fits ended before; 0 if none did."""
    known = (found[other.name].fitted_law for other in chosen if _knows(one, other, leader))
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
