"""Which laws a composition contains: those that are left as parts vanish or become simpler."""

import dataclasses
import functools
from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

from stickslip.friction import notation
from stickslip.friction.base import Containment, FrictionLaw
from stickslip.friction.composition import SIDES, Composition
from stickslip.friction.parts import PARTS
from stickslip.friction.parts.base import Becomes
from stickslip.friction.parts.levels import Surplus
from stickslip.quantities import fields_of

Values: TypeAlias = Mapping[str, float | str]
"""Value, or the parameter that it equals, by meaning."""
Reduction: TypeAlias = tuple[notation.Term, Values, tuple[str, ...]]
"""A simpler term, what leads there, and what goes to infinity for it."""


def containment_of(kind: type[FrictionLaw], simpler: type[FrictionLaw]) -> Containment | None:
    """Return how a type of law contains another one; None if it does not.

    Examples
    --------
    >>> from stickslip import Coulomb, Dahl, LuGre
    >>> from stickslip.friction import law
    >>> containment_of(LuGre, Dahl).limits, containment_of(Coulomb, Dahl)
    ((), None)
    >>> containment_of(law("both_ways(level + stribeck) + power"), Coulomb).values[
    ...     "viscous_coefficient"
    ... ]
    0.0
    """
    declared = next((inner for inner in kind.contained if inner.law == simpler.name), None)
    if declared is not None or kind is simpler or None in (kind.made_of, simpler.made_of):
        return declared
    reached = _below(kind)
    for form in _forms(simpler.made_of.term, simpler):
        if form in reached:
            found = _containment(kind.made_of, simpler, *reached[form])
            known = fields_of(kind)
            fixed = {n: v for n, v in found.values.items() if not isinstance(v, str)}
            # Not with a value that the richer law does not allow, as at the open end of a range.
            return found if all(known[n].allows(v) for n, v in fixed.items()) else None
    return None


@functools.cache
def _below(kind: type[FrictionLaw]) -> Mapping[str, tuple[Values, tuple[str, ...]]]:
    """Return by composition what leads from a law to each simpler one, on the shortest way."""
    c = kind.made_of
    found: dict[str, tuple[Values, tuple[str, ...]]] = {}
    level: list[Reduction] = [(c.term, {}, ())]
    while level:
        below: list[Reduction] = []
        for term, values, limits in level:
            for simpler, more, lost in _reductions(term):
                form = notation.canonical(simpler)
                if form not in found and form != notation.canonical(c.term):
                    found[form] = {**values, **more}, (*limits, *lost)
                    below.append((simpler, *found[form]))
        level = below
    return found


def _forms(term: notation.Term, kind: type[FrictionLaw]) -> Iterator[str]:
    """Yield the compositions of a law: its own, and those that exponents at their defaults make.

    Optional parts that are not given are not there either.
    """
    yield notation.canonical(term)
    given = [
        parameter.name
        for name in term.parts()
        if name.name in notation.OPTIONAL
        for parameter in name.parameters
    ]
    if given and all(getattr(kind, name, dataclasses.MISSING) is None for name in given):
        yield notation.canonical(notation.without_optional(term))
    for simpler, values, limits in _reductions(term):
        here = {name: value for name, value in values.items() if name in kind.made_of.fields}
        shapes = (kind.made_of.fields[name].quantity.structural for name in here)
        at_default = all(getattr(kind, name, None) == value for name, value in here.items())
        if here and not limits and all(shapes) and at_default:
            yield from _forms(simpler, kind)


def nearest_contained(
    c: Composition, kind: type[FrictionLaw], known: Mapping[str, Any]
) -> Iterator[Containment]:
    """Yield the laws with a name that are reached first; what these contain is theirs.

    What is known are entries by their canonical composition; only of laws that are found are
    classes asked for.
    """
    found: dict[str, tuple[type[FrictionLaw], Containment]] = {}

    def find(law: Any, values: Values, limits: tuple[str, ...]) -> None:
        if law.name not in found:
            found[law.name] = law.law, _containment(c, law.law, values, limits)

    def named(term: notation.Term) -> Any:
        """Return the law of a term, or of the same with a power of the speed that is 1."""
        plain, raised = (known.get(notation.canonical(part)) for part in (term, _with_power(term)))
        return plain if plain is not None or raised is None or raised.name == kind.name else raised

    same = named(c.term)
    # a name of its own for the same parts, where optional ones have to be there
    if same is not None and same.name != kind.name:
        find(same, dict(_vanished(c.term)), ())
    level: list[Reduction] = [(c.term, {}, ())]
    seen = {notation.canonical(c.term)}
    while level:
        below: list[Reduction] = []
        for term, values, limits in level:
            for simpler, more, lost in _reductions(term):
                if notation.canonical(simpler) in seen:
                    continue
                seen.add(notation.canonical(simpler))
                state = simpler, {**values, **more}, (*limits, *lost)
                there = named(simpler)
                # without its optional parts it is itself; a law that is tried only on request
                # stands between no others
                is_own = there is not None and there.name == kind.name
                if there is None or is_own or (there.on_request and not kind.on_request):
                    below.append(state)
                else:
                    find(there, *state[1:])
        level = below
    by_name = {law.name: law for law in known.values()}
    within = {name for law, _ in found.values() for name in _all_within(law, by_name)}
    yield from (containment for law, containment in found.values() if law.name not in within)


def _with_power(term: notation.Term) -> notation.Term:
    """Return a term with a power of the speed in place of a viscous part."""
    match term:
        case notation.Name(name="viscous"):
            return notation.Name("power")
        case notation.Sum(items=items):
            return notation.Sum(tuple(map(_with_power, items)))
        case notation.Around(head=head, inner=inner):
            return notation.Around(head, _with_power(inner))
        case notation.Product(first=first, factors=factors):
            return notation.Product(_with_power(first), factors)
        case _:
            return term


def _all_within(kind: type[FrictionLaw], known: Mapping[str, Any]) -> Iterator[str]:
    for containment in kind.contained:
        yield containment.law
        yield from _all_within(known[containment.law].law, known)


def _vanished(term: notation.Term) -> Iterator[tuple[str, float | str]]:
    """Yield the values for which optional parts are not there."""
    for name in term.parts():
        if name.name in notation.OPTIONAL:
            yield from _vanishing(name).items()


def _containment(
    c: Composition, simpler: type[FrictionLaw], values: Values, limits: tuple[str, ...]
) -> Containment:
    mine, theirs = c.fields, simpler.made_of.fields
    found: dict[str, float | str] = {
        field: field for field in mine if field in theirs and field not in (*values, *limits)
    }
    gone = [limit for limit in limits if limit in mine]
    for field in values:
        value = values[field]
        # What a parameter becomes on the way may itself have got a value later: followed to the
        # end.
        while isinstance(value, str) and value in values:
            value = values[value]
        if field not in mine:
            continue
        if value in limits:  # of both directions, which became one before
            gone.append(field)
        elif not (isinstance(value, str) and value not in theirs):
            found[field] = value
    defaults = {entry.name: entry.default for entry in dataclasses.fields(simpler)}
    reached = {value for value in found.values() if isinstance(value, str)}
    # What nothing leads to must have its default in the simpler law.
    where: dict[str, Any] = {
        field: defaults[field]
        for field in theirs
        if field not in reached and defaults[field] not in (None, dataclasses.MISSING)
    }
    power = "viscous_exponent"
    if power in where and power not in mine and power not in values:
        where[power] = 1.0  # whatever its default is
    return Containment(
        law=simpler.name,
        values=found,
        limits=tuple(gone),
        where=where,
    )


def _reductions(term: notation.Term) -> Iterator[Reduction]:
    """Yield the terms one step simpler."""
    match term:
        case notation.Sum(items=items):
            yield from _without(items)
            for index, item in enumerate(items):
                for simpler, values, limits in _reductions(item):
                    yield (
                        notation.summed(
                            (*items[:index], *notation.terms_of(simpler), *items[index + 1 :])
                        ),
                        values,
                        limits,
                    )
        case notation.Around(head=notation.Name(name="both_ways"), inner=inner):
            yield from _of_both_ways(term.head, inner)
        case notation.Around(head=head, inner=inner):
            for becoming in head.part.becomes:
                name, values, limits = _became(head, becoming)
                yield inner if name is None else notation.Around(name, inner), values, limits
            for simpler, values, limits in _reductions(inner):
                yield notation.Around(head, simpler), values, limits
        case notation.Product():
            yield from _of_product(term)
        case notation.Name():
            for becoming in term.part.becomes:
                name, values, limits = _became(term, becoming)
                assert name is not None  # only what stands around a term leaves it
                yield name, values, limits


def _became(
    name: notation.Name, becomes: Becomes
) -> tuple[notation.Name | None, Values, tuple[str, ...]]:
    """Return the simpler part, None where what stands in the brackets is left."""
    kept = name.argument if becomes.name in PARTS and PARTS[becomes.name].argument else ""
    simpler = notation.Name(becomes.name, becomes.argument or kept) if becomes.name else None
    values = {name.meaning(own): value for own, value in becomes.values.items()}
    return simpler, values, tuple(map(name.meaning, becomes.limits))


def _vanishing(name: notation.Name, stem: str = "") -> dict[str, float | str]:
    """Return the values for which a part is not there, or a factor is 1."""
    return {name.meaning(own, stem): value for own, value in (name.part.vanishes or {}).items()}


def _of_product(term: notation.Product) -> Iterator[Reduction]:
    """Yield a product without one of its factors, and with less that they multiply."""
    for index, factor in enumerate(term.factors):
        others = (*term.factors[:index], *term.factors[index + 1 :])
        left = notation.Product(term.first, others) if others else term.first
        yield left, _vanishing(factor, term.stem(factor)), ()
    for simpler, values, limits in _reductions(term.first):
        product = notation.Product(simpler, term.factors)
        known = {key for name in simpler.parts() for key in map(name.meaning, _own(name))}
        if not all(name.modulated in known for name in term.factors if name.modulated):
            continue  # a factor of a parameter that is not there any more
        # parameters of factors are called by what these multiply
        called = {
            factor.meaning(own, term.stem(factor)): factor.meaning(own, product.stem(factor))
            for factor in term.factors
            for own in _own(factor)
        }
        same = {before: after for before, after in called.items() if before != after}
        yield product, {**values, **same}, limits


def _own(name: notation.Name) -> tuple[str, ...]:
    return tuple(parameter.name for parameter in name.part.parameters)


def _of_both_ways(head: notation.Name, inner: notation.Term) -> Iterator[Reduction]:
    """Yield what is left where both directions are equal, or lose the same part."""
    # without a prefix as well: [levels] leaves some parameters to both directions
    prefixes = [*(prefix for prefix, _ in SIDES.values()), ""]
    fields = Composition(inner).fields
    yield inner, {side + field: field for field in fields for side in prefixes if side}, ()
    for simpler, values, limits in _reductions(inner):
        both = {
            side + name: side + value if isinstance(value, str) else value
            for name, value in values.items()
            for side in prefixes
        }
        yield (
            notation.Around(head, simpler),
            both,
            tuple(side + limit for limit in limits for side in prefixes),
        )


def _without(items: tuple[notation.Term, ...]) -> Iterator[Reduction]:
    """Yield a sum without one of its parts, and without what stands on this one."""
    for index, item in enumerate(items):
        name = item.first if isinstance(item, notation.Product) else item
        if not isinstance(name, notation.Name) or name.part.vanishes is None:
            continue
        others = (*items[:index], *items[index + 1 :])
        rest = tuple(other for other in others if _named(other) not in name.part.below)
        left = {own for term in rest for part in term.parts() for own in _own(part)}
        needed = {own for term in rest for part in term.parts() for own in part.part.needs}
        surplus = any(isinstance(part.part, Surplus) for term in rest for part in _levels(term))
        if rest and needed <= left and not (name.name == "level" and surplus):
            yield notation.summed(rest), _vanishing(name), ()


def _named(term: notation.Term) -> str:
    """Return the name of the part that a term is, with factors or without; empty of others."""
    first = term.first if isinstance(term, notation.Product) else term
    return first.name if isinstance(first, notation.Name) else ""


def _levels(term: notation.Term) -> Iterator[notation.Name]:
    return (name for name in term.parts() if name.role == "level")
