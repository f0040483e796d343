"""The explanation of series: the structure that the evidence supports, its ties and its faults."""

import math
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.evidence.balance import Balance
from stickslip.evidence.faults import Fault, faults_of
from stickslip.evidence.fits import Fit, design, matched
from stickslip.evidence.intervals import Interval, intervals_of, refined, widened
from stickslip.evidence.rule import Rule
from stickslip.evidence.search import MOST_TIES, Progress, Search
from stickslip.evidence.series import Series
from stickslip.evidence.structure import GIVEN, Family, Structure
from stickslip.evidence.terms import TERMS, Term
from stickslip.evidence.values import Value, key_of
from stickslip.evidence.vocabulary import vocabulary as usual_vocabulary

Array = NDArray[np.float64]

PLAIN = ((1.0, "viscous"), (2.0, "quadratic"))
"""Exponents of the speed that have a kind of their own."""
UNUSUAL = 3
"""Rank from which a term has to differ from 0 surely."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Explanation:
    """What explains a measurement."""

    best: Fit
    """The most usual structure that the rule does not tell apart from the best."""
    ties: tuple[Fit, ...]
    """Others that are not told apart from it, the most usual first."""
    faults: tuple[Fault, ...]
    """What is wrong with the rig or the measurement, if anything."""
    intervals: dict[str, Interval]
    """Value, lower and upper limit (95 %) of every parameter, by channel and kind."""
    scale: float
    """Root of the mean square [N] of the friction."""
    family: dict[Family, Fit]
    """The best fit of every family that was met."""
    trail: tuple[str, ...]
    """The best structure of each level of the search."""
    evaluated: int
    """Hypotheses that were judged."""
    seconds: float
    """Time [s] that it took."""
    balance: Balance = field(repr=False)
    """The rows that were compared."""

    @property
    def left(self) -> float:
        """Return the held-out error over the friction."""
        return self.best.rms / self.scale


def begin(balance: Balance) -> Structure:
    """Return the structure that a search begins with.

    Known columns, an inertia where the force drives one, and a level: in proportion to the load
    where that is measured.
    """
    terms = set()
    for one in balance.parts:
        terms |= {Term("known", (), "*", name) for name in one.extra}
        if one.inertia:
            terms.add(Term("inertia", (), one.channel))
        loaded = "load" in one.covariates
        terms.add(
            Term("load", (), one.channel, "load") if loaded else Term("level", (), one.channel)
        )
    return Structure(tuple(sorted(terms, key=str)))


def explain(
    series: Sequence[Series] | Balance,
    *,
    rule: Rule | None = None,
    fc: float | None = None,
    vocabulary: Iterable[Term] | None = None,
    progress: Progress | None = None,
) -> Explanation:
    """Return the structure that explains series, by one search over laws, nuisances and faults.

    The band `fc` [Hz] and the candidates are chosen if they are not given; `progress` is told the
    share that is done, from 0 to 1, and the best structure after each level. An `InputError` says
    why a record cannot be judged by its force balance.

    Examples
    --------
    >>> t = 0.002 * np.arange(5000)
    >>> force = 2.0 * np.sign(np.cos(t)) + 0.01 * np.random.default_rng(1).normal(size=5000)
    >>> found = explain([Series(t, np.sin(t), force, inertia=False)])
    >>> str(found.best.structure), round(found.intervals["-/level"][0], 2)
    ('level', 2.0)
    """
    began = time.perf_counter()
    rule = rule or Rule()
    balance = series if isinstance(series, Balance) else Balance(series, fc)
    candidates = list(usual_vocabulary(balance) if vocabulary is None else vocabulary)
    search = Search(balance, rule, candidates, progress)
    whole = begin(balance)
    start = _admissible(search, whole)
    # what the start cannot have may be found beside other terms
    search.terms += [term for term in whole.terms if term not in start.terms]
    found = search.run(start)
    best = _refined(search, found.best)
    if best.structure.family != found.best.structure.family:
        best = _refined(search, best)
    if progress is not None:
        progress(0.9, str(best.structure))
    intervals = widened(balance, best, intervals_of(balance, best))
    while (rest := _surer(best, intervals)) is not None:
        best = _refined(search, search.fit(rest))
        intervals = widened(balance, best, intervals_of(balance, best))
    ties = [one for one in found.ties if one.structure.family != best.structure.family]
    faults = faults_of(search, best, ties, intervals)
    if progress is not None:
        progress(1.0, str(best.structure))
    return Explanation(
        best=best,
        ties=tuple(ties[:MOST_TIES]),
        faults=faults,
        intervals=intervals,
        scale=found.scale,
        family=found.family,
        trail=found.trail,
        evaluated=search.evaluated,
        seconds=time.perf_counter() - began,
        balance=balance,
    )


def _refined(search: Search, found: Fit) -> Fit:
    """Return a fit off its grids, without what does not earn its place there."""
    best = refined(search.balance, found)
    return search.prune(best) if best.ok else found


def _surer(found: Fit, intervals: Mapping[str, Interval]) -> Structure | None:
    """Return the structure without the unusual term that is the least sure, if any is not.

    One whose interval holds 0 lowers the error, but not in one way: it stands for something else.
    A power whose exponent may be 1 or 2 is viscous friction or drag.
    """
    structure = found.structure
    for term in structure.free:
        if term.kind == "power":
            _, low, high = intervals[Value(term, 0).name]
            for exponent, kind in PLAIN:
                plain = replace(term, kind=kind, par=())
                if low <= exponent <= high and not structure.clashes(plain):
                    return structure.without(term).having(plain)
    doubts = {}
    for term in structure.free:
        names = TERMS[term.kind].columns
        keys = [f"{key_of(term)}.{name}" for name in names] or [key_of(term)]
        if TERMS[term.kind].rank < UNUSUAL or keys[0] not in intervals:
            continue
        size = math.hypot(*(intervals[key][0] for key in keys))
        half = math.hypot(*(0.5 * (intervals[key][2] - intervals[key][1]) for key in keys))
        if half >= size:
            doubts[term] = half / max(size, 1e-300)
    if not doubts:
        return None
    return structure.without(max(doubts, key=lambda term: doubts[term]))


def _admissible(search: Search, structure: Structure) -> Structure:
    """Return a start that physics admits.

    A motion may not show its inertia, and a joint may have no level that the record shows.
    """
    while True:
        found = search.fit(structure)
        if found.ok:
            return structure
        wrong = [
            term
            for term, value in zip(found.owner, found.coef, strict=True)
            if TERMS[term.kind].positive and value < 0.0
        ]
        for term in wrong:
            structure = structure.without(term)
            viscous = Term("viscous", (), term.channel)
            if term.kind in ("level", "load"):
                structure = structure.having(viscous)
        if not wrong or not any(term.kind not in GIVEN for term in structure.terms):
            raise InputError(
                "the friction comes out negative: on average the force acts against the velocity of"
                " the body that it moves. Check the sign of the force against that of the position."
            )


def predict(fitted: Fit, series: Sequence[Series], like: Balance) -> tuple[Balance, Array, Array]:
    """Return what a fit predicts of other series of the same joints.

    These are the rows of the balance `like` of the fit, predicted forces (n,) [N], and errors
    (n,) [N], as the force channel shows them: at open rows the distance to what the law allows.

    Examples
    --------
    >>> t = 0.002 * np.arange(5000)
    >>> record = [Series(t, np.sin(t), 2.0 * np.sign(np.cos(t)), inertia=False)]
    >>> found = explain(record)
    >>> _, _, error = predict(found.best, record, found.balance)
    >>> bool(np.std(error) < 0.02)
    True
    """
    there = Balance(series, like=like)
    made = design(there, fitted.structure)
    values = fitted.coef[matched(fitted.owner, made.owners)]
    return there, made.columns @ values, made.errors(values)
