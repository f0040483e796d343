"""Faults of a rig or a measurement that a structure names, in groups that are not told apart."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from stickslip.evidence.fits import Fit, design
from stickslip.evidence.intervals import Interval
from stickslip.evidence.moves import moves
from stickslip.evidence.search import Search
from stickslip.evidence.structure import LATE_OR_ELASTIC, SHOWN_LATE, Structure
from stickslip.evidence.terms import TERMS, Term
from stickslip.evidence.values import Value, key_of, polished

NEAR = 1.37
"""Error of a neighbour over that of the best fit from which it is excluded. Measured: at least 1.4
for the others of a true delay, 1.05 to 1.35 where a delay is named for a gap or a coupling."""
LESS = 0.93
"""Error of a fit with a neighbour beside a fault from which that fault is not all there is: no
margin of the rule, as either is so small. Measured: 0.95 at least beside eight true delays, 0.91
beside one that was named for a gap."""


@final
@dataclass(frozen=True, kw_only=True)
class Fault:
    """What is wrong with the rig or the measurement."""

    kinds: tuple[str, ...]
    """Kinds of terms that explain it and are not told apart, the one of the best fit first."""
    channel: str
    """The joint; empty if it is of all."""
    size: float
    """Root of the mean square [N] of the force that it explains."""
    share: float
    """That force over the friction."""
    value: float | None
    """Its parameter in SI units: a delay [s], a gap [m], a frequency [Hz], a limit [N], or the
    coefficient of a term without one."""
    interval: tuple[float, float] | None
    """Limits (95 %) of that, if there are any."""


def faults_of(
    search: Search, best: Fit, ties: Sequence[Fit], intervals: Mapping[str, Interval]
) -> tuple[Fault, ...]:
    """Return the faults that a fit names, each with the others that would do as well."""
    groups: list[list[Term]] = []
    for term in best.structure.faults:
        late = term.kind in LATE_OR_ELASTIC
        own = next((one for one in groups if late and one[0].kind in LATE_OR_ELASTIC), None)
        if own is None:
            groups.append([term])
        else:
            own.append(term)
    return tuple(_fault(search, best, ties, intervals, group) for group in groups)


def _fault(
    search: Search,
    best: Fit,
    ties: Sequence[Fit],
    intervals: Mapping[str, Interval],
    group: Sequence[Term],
) -> Fault:
    """Return one fault: the terms of a group in the best fit, and what may stand for them."""
    largest = max(group, key=lambda term: _size(search, best, [term]))
    kinds = [largest.kind, *(term.kind for term in group if term is not largest)]
    known = {term.kind for term in (*search.terms, *search.delays)}
    if len({*kinds}) == 1:
        kinds += _instead(search, best, ties, group)
    if not _alone(best, ties, group):
        kinds += [kind for kind in LATE_OR_ELASTIC if kind in known]
    size = _size(search, best, group)
    value, interval = _value(best, largest, intervals)
    return Fault(
        kinds=tuple(dict.fromkeys(kinds)),
        channel="" if largest.channel == "*" else largest.channel,
        size=size,
        share=size / search.scale,
        value=value,
        interval=interval,
    )


def _alone(best: Fit, ties: Sequence[Fit], group: Sequence[Term]) -> bool:
    """Return whether one fault explains what a group does, and no neighbour beside it leaves less.

    Where two are needed, none of those that are late or elastic is surely one of them.
    """
    kinds = {term.kind for term in group}
    if not kinds <= {*LATE_OR_ELASTIC}:
        return True
    return len(kinds) == 1 and not any(
        one.rms < LESS * best.rms
        and kinds < {term.kind for term in one.structure.faults} & {*LATE_OR_ELASTIC}
        for one in ties
    )


def _instead(search: Search, best: Fit, ties: Sequence[Fit], group: Sequence[Term]) -> list[str]:
    """Return kinds of faults with one of which, in place of a group, a fit is not worse."""
    rest = best.structure
    for term in group:
        rest = rest.without(term)
    alike = group[0].kind in LATE_OR_ELASTIC
    found = []
    for kind in dict.fromkeys(term.kind for term in (*search.terms, *search.delays)):
        if not TERMS[kind].fault or best.structure.has(kind):
            continue
        options = _best_with(search, rest, kind)
        options += [one for one in ties if [term.kind for term in one.structure.faults] == [kind]]
        equal = [one for one in options if one.ok and not search.better(best, one)]
        if alike and kind in LATE_OR_ELASTIC:
            equal += [one for one in options if one.ok and one.rms < NEAR * best.rms]
        else:
            equal = [one for one in equal if search.better(one, search.fit(rest))]
        if equal:
            found.append(kind)
    return found


def _best_with(search: Search, rest: Structure, kind: str) -> list[Fit]:
    """Return the best fit of a structure with a fault of a kind, if there is any."""
    if not rest.terms:
        return []
    if kind in SHOWN_LATE:
        options = search.late(rest, [kind])[:1]
    else:
        ranked = moves(search.balance, rest, [term for term in search.terms if term.kind == kind])
        options = [one.applied(rest) for one in ranked if one.gone is None][:1]
    return [search.fit(polished(search.balance, one)) for one in options]


def _size(search: Search, best: Fit, terms: Sequence[Term]) -> float:
    """Return the root of the mean square [N] of the force that terms explain."""
    balance = search.balance
    made = design(balance, best.structure)
    own = np.array([one in terms for one in made.owners], dtype=bool)
    force = made.columns[:, own] @ best.coef[own]
    if any(term.kind in SHOWN_LATE for term in terms):
        force = force + balance.late(*best.structure.late) - balance.force
    return float(np.sqrt(np.mean(force[balance.use] ** 2)))


def _value(
    best: Fit, term: Term, intervals: Mapping[str, Interval]
) -> tuple[float | None, tuple[float, float] | None]:
    """Return the parameter of a fault and its limits, if there are any."""
    if term.par:
        known = intervals.get(Value(term, 0).name)
        return term.par[0], None if known is None else known[1:]
    known = intervals.get(key_of(term))
    coefficients = best.of(term.kind, term.channel)
    return coefficients[0] if coefficients else None, None if known is None else known[1:]
