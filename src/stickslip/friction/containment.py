"""Which laws a composition contains: those that are left as parts vanish or become simpler."""

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias, final

from stickslip.friction.base import Containment, FrictionLaw
from stickslip.friction.composition import SIDES, Composition
from stickslip.friction.notation import (
    BOTH_WAYS,
    OPTIONAL,
    Around,
    Name,
    Sum,
    Term,
    canonical,
    summed,
    terms_of,
)
from stickslip.friction.parts.levels import Surplus

__all__ = ["Contained"]

Values: TypeAlias = Mapping[str, float | str]
"""Value, or the parameter that it equals, by meaning."""
Reduction: TypeAlias = tuple[Term, Values, tuple[str, ...]]
"""A simpler term, what leads there, and what goes to infinity for it."""


@final
class Contained:
    """The attribute `contained` of a class of laws, which is worked out when it is asked for."""

    def __init__(self, composition: Composition, known: Callable[[], Mapping[str, Any]]) -> None:
        self._composition, self._known = composition, known
        self._found: tuple[Containment, ...] | None = None

    def __get__(self, law: object, kind: type[FrictionLaw]) -> tuple[Containment, ...]:
        if self._found is None:
            self._found = tuple(_nearest(self._composition, kind, self._known()))
        return self._found


def _nearest(
    c: Composition, kind: type[FrictionLaw], known: Mapping[str, Any]
) -> Iterator[Containment]:
    """Yield the laws with a name that are reached first; what these contain is theirs.

    What is known are entries by their canonical composition; only of laws that are found are
    classes asked for.
    """
    found: dict[str, tuple[type[FrictionLaw], Containment]] = {}

    def find(one: Any, values: Values, limits: tuple[str, ...]) -> None:
        if one.name not in found:
            found[one.name] = one.law, _containment(c, one.law, values, limits)

    same = known.get(canonical(c.term))
    # a name of its own for the same parts, where optional ones have to be there
    if same is not None and same.name != kind.name:
        find(same, dict(_vanished(c.term)), ())
    level: list[Reduction] = [(c.term, {}, ())]
    seen = {canonical(c.term)}
    while level:
        below: list[Reduction] = []
        for term, values, limits in level:
            for simpler, more, lost in _reductions(term):
                if canonical(simpler) in seen:
                    continue
                seen.add(canonical(simpler))
                state = simpler, {**values, **more}, (*limits, *lost)
                there = known.get(canonical(simpler))
                # a law that is tried only on request stands between no others
                if there is None or (there.on_request and not kind.on_request):
                    below.append(state)
                else:
                    find(there, *state[1:])
        level = below
    by_name = {one.name: one for one in known.values()}
    within = {name for law, _ in found.values() for name in _all_within(law, by_name)}
    yield from (one for law, one in found.values() if law.name not in within)


def _all_within(kind: type[FrictionLaw], known: Mapping[str, Any]) -> Iterator[str]:
    for one in kind.contained:
        yield one.law
        yield from _all_within(known[one.law].law, known)


def _vanished(term: Term) -> Iterator[tuple[str, float | str]]:
    """Yield the values for which optional parts are not there."""
    for name in term.parts():
        if name.name in OPTIONAL:
            yield from (name.part.vanishes or {}).items()


def _containment(
    c: Composition, simpler: type[FrictionLaw], values: Values, limits: tuple[str, ...]
) -> Containment:
    mine = {meaning: field for field, meaning in c.meanings.items()}
    theirs = {meaning: field for field, meaning in simpler.made_of.meanings.items()}
    found: dict[str, float | str] = {
        field: theirs[meaning]
        for meaning, field in mine.items()
        if meaning in theirs and meaning not in (*values, *limits)
    }
    gone = [mine[one] for one in limits if one in mine]
    for meaning in values:
        value = values[meaning]
        while isinstance(value, str) and value in values:
            value = values[value]
        if meaning not in mine:
            continue
        if value in limits:  # of both directions, which became one before
            gone.append(mine[meaning])
        elif not (isinstance(value, str) and value not in theirs):
            found[mine[meaning]] = theirs[value] if isinstance(value, str) else value
    defaults = {one.name: one.default for one in dataclasses.fields(simpler)}
    reached = {value for value in found.values() if isinstance(value, str)}
    where: dict[str, Any] = {
        field: defaults[field]
        for field in theirs.values()
        if field not in reached and defaults[field] not in (None, dataclasses.MISSING)
    }
    return Containment(
        law=simpler.name,
        values=found,
        limits=tuple(gone),
        where=where,
    )


def _reductions(term: Term) -> Iterator[Reduction]:
    """Yield the terms one step simpler."""
    match term:
        case Sum(items=items):
            yield from _without(items)
            for index, item in enumerate(items):
                for simpler, values, limits in _reductions(item):
                    yield (
                        summed((*items[:index], *terms_of(simpler), *items[index + 1 :])),
                        values,
                        limits,
                    )
        case Around(head=Name(name="both_ways"), inner=inner):
            yield from _of_both_ways(term.head, inner)
        case Around(head=head, inner=inner):
            for one in head.part.becomes:
                yield Around(Name(one.name), inner) if one.name else inner, one.values, one.limits
            for simpler, values, limits in _reductions(inner):
                yield Around(head, simpler), values, limits
        case Name():
            for one in term.part.becomes:
                yield Name(one.name, term.argument), one.values, one.limits


def _of_both_ways(head: Name, inner: Term) -> Iterator[Reduction]:
    """Yield what is left where both directions are equal, or lose the same part."""
    # without a prefix as well: [levels] leaves some parameters to both directions
    prefixes = [*(prefix for prefix, _ in SIDES.values()), ""]
    meanings = Composition(inner, {}).meanings.values()
    yield inner, {side + one: one for one in meanings for side in prefixes if side}, ()
    for simpler, values, limits in _reductions(inner):
        both = {
            side + one: side + value if isinstance(value, str) else value
            for one, value in values.items()
            for side in prefixes
        }
        yield Around(head, simpler), both, tuple(side + one for one in limits for side in prefixes)


def _without(items: tuple[Term, ...]) -> Iterator[Reduction]:
    """Yield a sum without one of its parts, and without what stands on this one."""
    for index, item in enumerate(items):
        if not isinstance(item, Name) or item.name == BOTH_WAYS or item.part.vanishes is None:
            continue
        others = (*items[:index], *items[index + 1 :])
        rest = tuple(one for one in others if str(one) not in item.part.below)
        surplus = any(isinstance(one, Name) and isinstance(one.part, Surplus) for one in rest)
        if rest and not (item.name == "level" and surplus):
            yield summed(rest), item.part.vanishes, ()
