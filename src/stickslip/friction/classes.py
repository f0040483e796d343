"""Classes of laws that are made of compositions, with a name or without."""

import abc
import dataclasses
import functools
import inspect
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib.resources import files
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias, cast, final

from stickslip.errors import InputError, nearest
from stickslip.friction import base as laws
from stickslip.friction import notation
from stickslip.friction.base import Containment, FrictionLaw
from stickslip.friction.composition import SIDES, STILL, Choose, Composition, Leaf, formula_of
from stickslip.friction.parts import PARTS
from stickslip.friction.parts.base import (
    Becomes,
    Extra,
    Factor,
    Flow,
    Level,
    Memory,
    Parameter,
    Slip,
    SmoothLevel,
    SmoothSign,
)
from stickslip.friction.parts.levels import Surplus
from stickslip.maths import Scalar, latched, power, sign, where
from stickslip.quantities import fields_of, unchecked

# Where laws come from: the bibliography of this package, in plain text.

ENTRY = re.compile(r"^@\w+\{([\w-]+),\n(.*?)^\}", re.DOTALL | re.MULTILINE)
FIELD = re.compile(r"^ *(\w+) *= *\{(.*)\},$", re.MULTILINE)
INITIAL, SHORT = re.compile(r"(\w)\w*\.?"), r"\1."
PLACES = (
    *("booktitle", "journal", "type", "school", "institution", "number", "publisher"),
    *("address", "note", "year"),
)
"""Fields that say where something was published, in their order."""


class Citation(NamedTuple):
    """A publication in words."""

    authors: str
    """Initials and surnames; empty where nobody is named."""
    title: str
    where: str
    """Journal with volume and number, or publisher; year."""


def _read(text: str) -> Iterator[tuple[str, Citation]]:
    """Yield the entries of a BibTeX file with a field in each line."""
    for key, body in ENTRY.findall(text):
        own = {name: re.sub("[{}]", "", value) for name, value in FIELD.findall(body)}
        authors = ", ".join(map(_short, filter(None, own.get("author", "").split(" and "))))
        if "volume" in own:
            issue = f"({own.pop('number')})" if "number" in own else ""
            own["journal"] += f" {own['volume']}{issue}"
        where = ", ".join(own[place] for place in PLACES if place in own)
        yield key, Citation(authors, own["title"], where)


def _short(name: str) -> str:
    """Return a name with initials.

    Examples
    --------
    >>> _short("Canudas de Wit, Carlos"), _short("Wen, Yi-Kwei"), _short("The MathWorks")
    ('C. Canudas de Wit', 'Y.-K. Wen', 'The MathWorks')
    """
    surname, _, given = name.partition(", ")
    return f"{INITIAL.sub(SHORT, given)} {surname}".strip()


CITATIONS: Mapping[str, Citation] = MappingProxyType(
    dict(_read(files(__package__).joinpath("references.bib").read_text(encoding="utf-8")))
)
"""Publications by key."""
SOURCES: Mapping[str, str] = MappingProxyType(
    {key: ". ".join(filter(None, citation)) + "." for key, citation in CITATIONS.items()}
)
"""Citation in plain text by key."""


# Classes of laws that are made of compositions, with a name or without.

# Which laws a composition contains: those that are left as parts vanish or become simpler.

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
            result = _containment(kind.made_of, simpler, *reached[form])
            known = fields_of(kind)
            fixed = {n: v for n, v in result.values.items() if not isinstance(v, str)}
            # Not with a value that the richer law does not allow, as at the open end of a range.
            return result if all(known[n].allows(v) for n, v in fixed.items()) else None
    return None


@functools.cache
def _below(kind: type[FrictionLaw]) -> Mapping[str, tuple[Values, tuple[str, ...]]]:
    """Return by composition what leads from a law to each simpler one, on the shortest way."""
    c = kind.made_of
    result: dict[str, tuple[Values, tuple[str, ...]]] = {}
    level: list[Reduction] = [(c.term, {}, ())]
    while level:
        below: list[Reduction] = []
        for term, values, limits in level:
            for simpler, more, lost in _reductions(term):
                form = notation.canonical(simpler)
                if form not in result and form != notation.canonical(c.term):
                    result[form] = {**values, **more}, (*limits, *lost)
                    below.append((simpler, *result[form]))
        level = below
    return result


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
    result: dict[str, tuple[type[FrictionLaw], Containment]] = {}

    def find(law: Any, values: Values, limits: tuple[str, ...]) -> None:
        if law.name not in result:
            result[law.name] = law.law, _containment(c, law.law, values, limits)

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
    within = {name for law, _ in result.values() for name in _all_within(law, by_name)}
    yield from (containment for law, containment in result.values() if law.name not in within)


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
    result: dict[str, float | str] = {
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
            result[field] = value
    defaults = {entry.name: entry.default for entry in dataclasses.fields(simpler)}
    reached = {value for value in result.values() if isinstance(value, str)}
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
        values=result,
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


# Classes of laws that are made of compositions, with a name or without.

LEAST_FACTOR = 1e-3
"""Factor at which runs end: a memory divides by its level, and below 0 friction would drive."""
NAMES: Mapping[str, Any] = {
    name: getattr(math, name)
    for name in ("atan", "copysign", "cos", "exp", "log", "sin", "sqrt", "tanh")
} | {"latched": latched, "power": power, "sign": sign}
DISPATCH = """
def evaluated(law, {signature}):
    if {floats}:
        try:
            shape = ({shape})
            function = known.get(shape)
            if function is None:
                function = known[shape] = made(law)
            return function(law, {given})
        except (AttributeError, IndexError, TypeError, ValueError):
            pass  # parameters are arrays or symbols
    return equation(law, {given})
"""
HOME = "stickslip.friction.registry"
"""Module in which pickle looks for classes without a name."""
PUBLIC = "stickslip.friction"
"""Where it looks for those with one."""
MACHINERY = ("__dict__", "__weakref__", "__abstractmethods__", "_abc_impl")
"""Attributes of classes that belong to one class alone."""
FLOATS = {
    "sliding": ("speed", "load"),
    "force": ("velocity", "load", "states"),
    "rates": ("velocity", "load", "states"),
    "steady": ("velocity", "load"),
}
"""Equations that have a text of their own for floats, with their arguments."""


def equations_of(c: Composition, one_way: Callable[[int], type[Any]]) -> dict[str, Any]:
    """Return the methods of the class of a composition, by name."""
    more: dict[str, Any] = {"limits": _limits(c)}
    if c.memory is None and not c.directional:
        return more | _set_valued(c)
    if c.directional:
        more["towards"] = _towards(c, one_way)
    return more | (_directional() if c.memory is None else _with_memory(c, c.memory))


def one_way(term: notation.Term, side: int) -> notation.Term:
    """Return the term of one direction, 1 or -1."""
    match term:
        case notation.Around(head=notation.Name(name="both_ways"), inner=inner):
            return one_way(inner, side)
        case notation.Sum(items=items):
            return notation.summed(
                tuple(part for item in items for part in notation.terms_of(one_way(item, side)))
            )
        case notation.Around(head=head, inner=inner):
            return notation.Around(head, one_way(inner, side))
        case notation.Product(first=first, factors=factors):
            return notation.Product(one_way(first, side), factors)
        case notation.Name(part=part) if part.directional:
            return term[part.one_way(side)]
        case _:
            return term


def _level(leaves: Sequence[Leaf], law: Any, slip: Slip, choose: Choose | None = None) -> Scalar:
    """Return the level of sliding, over the load; None where no part has one."""
    result = []
    for leaf in leaves:
        if isinstance(leaf.part, (Level, Extra, SmoothLevel)):
            value = leaf.part.sliding(*leaf.told(law, slip, choose))
            if value is not None:
                value = leaf.times(value, law, slip, choose)
            if leaf.sign is not None and value is not None:
                smooth = cast(SmoothSign, leaf.sign.part)
                value = value * smooth.shape(*leaf.sign.told(law, slip, choose))
            result.append(value)
    return _total(result)


def _rest(leaves: Sequence[Leaf], law: Any, choose: Choose | None = None) -> Scalar:
    """Return the level at rest, over the load: the last whole level that is given, and extras."""
    own = [leaf for leaf in leaves if not leaf.sign]
    ranks = ("kinetic_coefficient", "static_coefficient", "break_away_coefficient")
    held = {leaf.part.rest: leaf for leaf in own if isinstance(leaf.part, Level)}
    result: Scalar = 0.0
    steps: list[Scalar] = []
    for leaf in (held[rest] for rest in ranks if rest in held):
        given = getattr(leaf.told(law, STILL, choose)[0], cast(Level, leaf.part).rest)
        if given is not None:
            steps.append(leaf.times(given - result if steps else given, law, STILL, choose))
            result = given
    # a level of its own, and not the sum of its steps, where no factor tells these apart
    total = _total(steps) if any(leaf.factors for leaf in held.values()) else result
    for leaf in own:
        if isinstance(leaf.part, Extra) and leaf.part.holds:
            value = leaf.part.at_rest(*leaf.told(law, STILL, choose))
            total = total + leaf.times(value, law, STILL, choose)
    return total


def _flow(leaves: Sequence[Leaf], law: Any, slip: Slip, choose: Choose | None = None) -> Scalar:
    """Return the force of the parts without levels; None where there are none."""
    return _total(
        [
            leaf.times(leaf.part.flow(*leaf.told(law, slip, choose)), law, slip, choose)
            for leaf in leaves
            if isinstance(leaf.part, Flow)
        ]
    )


def _total(values: Sequence[Scalar]) -> Scalar | None:
    """Return the sum; None where nothing is summed."""
    there = [value for value in values if value is not None]
    return functools.reduce(lambda total, other: total + other, there) if there else None


def _by_velocity(velocity: Scalar) -> Choose:
    return lambda forward, backward: where(velocity < 0.0, backward, forward)


def _least(forward: Scalar, backward: Scalar) -> Scalar:
    return where(forward < backward, forward, backward)


def _set_valued(c: Composition) -> dict[str, Any]:
    """Return the equations of a law without memory."""

    def sliding(self: Any, speed: Scalar, load: Scalar) -> Scalar:
        slip = Slip(speed=speed, along=speed)
        level = _level(c.outside, self, slip)
        return _total([None if level is None else level * load, _flow(c.outside, self, slip)])

    def break_away(self: Any, load: Scalar) -> Scalar:
        return _rest(c.outside, self) * load

    return {"sliding": sliding, "break_away": break_away}


def _with_memory(c: Composition, leaf: Leaf) -> dict[str, Any]:
    """Return the equations of a law with a memory."""
    memory = cast(Memory, leaf.part)
    # what inputs change scales the force, stiffness included, as a load does: limits of deflections
    # that moved would leave what slides behind, or free it again without end
    fixed = [
        dataclasses.replace(part, factors=(), modulated={}) for part in c.inside if not part.inputs
    ]

    def at(self: Any, velocity: Scalar) -> tuple[Slip, Choose, Scalar]:
        choose = _by_velocity(velocity)
        rest = _rest(fixed, self, choose)
        slip = Slip(speed=abs(velocity), along=velocity, rest=rest)
        return slip, choose, _level(c.inside, self, slip, choose)

    def beside(self: Any, slip: Slip, choose: Choose, load: Scalar) -> Scalar:
        level = _level(c.outside, self, slip, choose)
        scaled = None if level is None else sign(slip.along) * level * load
        return _total([scaled, _flow(c.outside, self, slip, choose)])

    names = memory.states(c.argument)

    def force(self: Any, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...] = ()) -> Scalar:
        if len(states) != len(names):
            raise InputError(
                f"the friction law {self.name} has {len(names)} states ({', '.join(names)}): give"
                f" force(velocity, load, states), got {len(states)} states."
            )
        slip, choose, g = at(self, velocity)
        held = memory.force(leaf.told(self, slip, choose)[0], slip, states, g)
        return _total([held * load, beside(self, slip, choose, load)])

    def rates(
        self: Any,
        velocity: Scalar,
        load: Scalar,  # noqa: ARG001
        states: tuple[Scalar, ...],
    ) -> tuple[Scalar, ...]:
        slip, choose, g = at(self, velocity)
        return memory.rates(leaf.told(self, slip, choose)[0], slip, states, g)

    def moved(
        self: Any,
        velocity: Scalar,
        load: Scalar,  # noqa: ARG001
        states: tuple[Scalar, ...],
        time: Scalar,
    ) -> tuple[Scalar, ...] | None:
        slip, choose, g = at(self, velocity)
        return memory.moved(leaf.told(self, slip, choose)[0], slip, states, g, time)

    def steady(self: Any, velocity: Scalar, load: Scalar) -> Scalar:
        slip, choose, g = at(self, velocity)
        return _total([g * load * sign(velocity), beside(self, slip, choose, load)])

    def break_away(self: Any, load: Scalar) -> Scalar:
        return memory.peak(leaf.told(self, STILL, _least)[0]) * _rest(c.inside, self, _least) * load

    return {
        "states": names,
        "force": force,
        "rates": rates,
        "moved": moved,
        "steady": steady,
        "break_away": break_away,
    }


def _directional() -> dict[str, Any]:
    """Return the equations of a law without memory that differs between the directions."""

    def force(
        self: Any,
        velocity: Scalar,
        load: Scalar,
        states: tuple[Scalar, ...] = (),  # noqa: ARG001
    ) -> Scalar:
        ahead, back = (self.towards(side).force(velocity, load) for side in (1, -1))
        return where(velocity < 0.0, back, ahead)

    def break_away(self: Any, load: Scalar) -> Scalar:
        return _least(*(self.towards(side).break_away(load) for side in (1, -1)))

    return {"force": force, "break_away": break_away}


def _limits(c: Composition) -> Callable[[Any], dict[str, Scalar]]:
    """Return the method that gives the factors that may fall below 0."""
    result = {text: leaf for text, leaf in c.factors.items() if not leaf.part.opposes}

    def limits(self: Any) -> dict[str, Scalar]:
        if c.directional:
            return {
                f"{way} {text}": margin
                for side, way in ((1, "forward"), (-1, "backward"))
                for text, margin in self.towards(side).limits().items()
            }
        return {
            f"{text} falls below {LEAST_FACTOR:g}": leaf.factor(self, STILL, None) - LEAST_FACTOR
            for text, leaf in result.items()
        }

    return limits


def _towards(c: Composition, one_way: Callable[[int], type[Any]]) -> Callable[[Any, int], Any]:
    """Return the method that gives the law of one direction."""

    def towards(self: Any, direction: int) -> Any:
        side = 1 if direction > 0 else -1
        kind, prefix = one_way(side), SIDES[side][0]
        values: dict[str, Any] = {}
        for name, field in kind.made_of.fields.items():
            own = next((key for key in (prefix + name, name) if key in c.fields), None)
            values[name] = field.default if own is None else getattr(self, own)
        if kind.states:
            values["static_switch"] = self.static_switch
        law: Any = unchecked(kind, **values)
        return laws.bound(law, vars(self)[laws.BOUND]) if laws.is_bound(self) else law

    return towards


class Written:
    """An expression in Python; what is done to it is written down."""

    __slots__ = ("text",)
    __hash__ = None  # type: ignore[assignment]  # an expression is no value

    def __init__(self, text: str) -> None:
        self.text = text

    def __maths__(self, name: str, *arguments: Scalar) -> "Written":
        """Write a function of `stickslip.maths`; of a choice only the branch taken is evaluated."""
        if name == "where":
            yes, no, _ = arguments
            return Written(f"({_text(yes)} if {self.text} else {_text(no)})")
        given = [*map(_text, arguments)]
        match name, arguments:
            case "power", (_, float(exponent)) if exponent.is_integer():
                return Written(f"({given[0]} ** {given[1]})")
            case "sign", _ if given[0].isidentifier():
                return Written(f"(copysign(1.0, {given[0]}) if {given[0]} else 0.0)")
        return Written(f"{name}({', '.join(given)})")

    def __add__(self, other: Scalar) -> "Written":
        return Written(f"({self.text} + {_text(other)})")

    def __radd__(self, other: Scalar) -> "Written":
        return Written(f"({_text(other)} + {self.text})")

    def __sub__(self, other: Scalar) -> "Written":
        return Written(f"({self.text} - {_text(other)})")

    def __rsub__(self, other: Scalar) -> "Written":
        return Written(f"({_text(other)} - {self.text})")

    def __mul__(self, other: Scalar) -> "Written":
        return Written(f"({self.text} * {_text(other)})")

    def __rmul__(self, other: Scalar) -> "Written":
        return Written(f"({_text(other)} * {self.text})")

    def __truediv__(self, other: Scalar) -> "Written":
        return Written(f"({self.text} / {_text(other)})")

    def __rtruediv__(self, other: Scalar) -> "Written":
        return Written(f"({_text(other)} / {self.text})")

    def __neg__(self) -> "Written":
        return Written(f"(-{self.text})")

    def __abs__(self) -> "Written":
        return Written(f"abs({self.text})")

    def __lt__(self, other: Scalar) -> "Written":
        return Written(f"{self.text} < {_text(other)}")

    def __gt__(self, other: Scalar) -> "Written":
        return Written(f"{self.text} > {_text(other)}")

    def __bool__(self) -> bool:
        raise TypeError(
            "a condition in equations of friction is written with stickslip.maths.where"
        )


def _text(value: Scalar) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(map(_text, value))},)"
    return value.text if isinstance(value, Written) else repr(float(value))


def for_floats(
    kind: type, name: str, equation: Callable[..., Scalar], arguments: Sequence[str]
) -> Callable[..., Scalar]:
    """Return a method that evaluates floats by text of its own, and all else by the equation.

    The text is written at the first call, which puts it in the place of this method.
    """

    @functools.wraps(equation)
    def first(law: Any, *given: Scalar, **named: Scalar) -> Scalar:
        setattr(kind, name, _dispatching(kind, equation, arguments))
        return getattr(law, name)(*given, **named)

    return first


def _dispatching(
    kind: type, equation: Callable[..., Scalar], arguments: Sequence[str]
) -> Callable[..., Scalar]:
    """Return the method by text: a function for each shape of laws, written when it is met."""
    shaping = [name for name, measured in fields_of(kind).items() if measured.structural]
    shaping += [name for name in fields_of(kind) if getattr(kind, name, 0.0) is None]
    known: dict[tuple[float | None, ...], Callable[..., Scalar]] = {}

    def made(law: Any) -> Callable[..., Scalar]:
        """Return the function for laws that are shaped as this one."""
        values: dict[str, Any] = {}
        lines = []
        for name, quantity in fields_of(kind).items():
            value = getattr(law, name)
            if quantity.stands_in_equations(value):
                value = Written(f"p_{name}")
                lines.append(f"    p_{name} = law.{name}\n")
            values[name] = value
        inputs = {name: Written(f"x_{name}") for name in law.inputs}
        lines += [f"    x_{name} = law.contact({name!r})\n" for name in law.inputs]
        twin: Any = laws.bound(unchecked(kind, **values), inputs)
        given = [
            tuple(Written(f"{name}[{i}]") for i in range(len(law.states)))
            if name == "states"
            else Written(name)
            for name in arguments
        ]
        result = _text(equation(twin, *given))
        used = "".join(line for line in lines if line.split()[0] in result)
        text = f"def made(law, {', '.join(arguments)}):\n{used}    return {result}\n"
        space = dict(NAMES)
        exec(text, space)
        function: Callable[..., Scalar] = space["made"]
        return function

    # Whether the short text serves is asked of each argument: `float` itself, neither array nor
    # symbol.
    scalars = [name for name in arguments if name != "states"]
    scalars += [f"law.contact({name!r})" for name in getattr(kind, "inputs", ())]
    floats = " and ".join(f"type({key}) is float" for key in scalars)
    # what shapes the equations: a whole exponent, a level that is not given
    shape = "".join(
        f"law.{name} if law.{name}.is_integer() else None, "
        if fields_of(kind)[name].structural
        else f"law.{name} is None, "
        for name in shaping
    )
    given = ", ".join(arguments)
    signature = given.replace("states", "states=()")
    space: dict[str, Any] = {"made": made, "equation": equation, "known": known}
    exec(DISPATCH.format(given=given, signature=signature, floats=floats, shape=shape), space)
    return functools.wraps(equation)(space["evaluated"])


@dataclasses.dataclass(frozen=True, kw_only=True)
class Entry:
    """A law of the catalogue: what is said of it, and its class, which is made when asked for."""

    composition: str
    """Its parts, as they are written in the entry."""
    statement: type
    """The class statement, which says what the law is called and where it comes from."""

    def __getattr__(self, name: str) -> Any:
        """Return what the entry says; what it leaves out is as in all laws."""
        if name.startswith("_") or name == "statement":
            raise AttributeError(name)
        return getattr(self.statement if hasattr(self.statement, name) else laws.FrictionLaw, name)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states of the contact."""
        heads = (part for part in notation.read(self.composition).parts() if part.role == "memory")
        return tuple(
            state for head in heads for state in cast(Memory, head.part).states(head.argument)
        )

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of what it asks of the contact."""
        names = notation.read(self.composition).parts()
        return tuple(dict.fromkeys(key for name in names for key in name.inputs))

    @property
    def on_request(self) -> bool:
        """Whether it is tried on travels only where it is named, as unless the entry says not."""
        return getattr(self.statement, "on_request", True)

    @property
    def compared(self) -> bool:
        """Whether the formula was compared with its source: that of the law, and of its parts."""
        own = getattr(self.statement, "compared", True)
        return own and all(head.part.compared for head in notation.read(self.composition).parts())

    @functools.cached_property
    def law(self) -> type[laws.FrictionLaw]:
        """The class of the law."""
        said = {k: v for k, v in vars(self.statement).items() if k not in MACHINERY}
        space = {**said, "__module__": PUBLIC}
        c = Composition(notation.read(self.composition))
        made = _made(c, self.statement.__name__, space)
        made.__doc__ = self._documented(made)
        return made

    def _documented(self, law: type[laws.FrictionLaw]) -> str:
        """Return the docstring of the class: what is known of it, and an example with values."""
        prose, mark, example = inspect.cleandoc(self.statement.__doc__ or "").partition(">>> ")
        notes = "\n\n".join([f".. math:: {law.formula}", *(f"{k}: {v}" for k, v in said_of(law))])
        if unknown := [key for key in law.sources if key not in SOURCES]:
            close = nearest(unknown[0], SOURCES)
            raise InputError(
                f"the law {law.name} of friction/named.py has the source {unknown[0]!r}, which"
                " friction/references.bib does not have: "
                + (f"write {close}, or " if close else "")
                + "add its entry there, one field a line."
            )
        sections = {"Notes": notes, "References": "\n\n".join(SOURCES[key] for key in law.sources)}
        if law.typical is not None:
            name, values = law.__name__, law.typical.values.items()
            given = "".join(f"...     {field}={value!r},\n" for field, value in values)
            made = f">>> from stickslip import {name}\n>>> law = {name}(\n{given}... )\n"
            sections["Examples"] = made + mark + example
        return prose.rstrip() + "".join(
            f"\n\n{heading}\n{'-' * len(heading)}\n{text}" for heading, text in sections.items()
        )


def said_of(law: Any) -> Iterator[tuple[str, str]]:
    """Yield what an entry, or a class, says of its law beside formula and sources."""
    if law.composition is not None:
        yield "Composition", str(law.composition)
    if law.typical is not None:
        key = law.typical.source
        yield ("Published values" if key else "Example values"), str(law.typical)
    if law.passivity is not None:
        yield "Passive", law.passivity.condition
    if law.defects:
        yield "Known defects", law.defects
    if not law.compared:
        yield "Note", "formula not compared with its source"


CATALOGUE: dict[str, Entry] = {}
"""Entries by the name of their law, in the order in which they are listed."""


def composed(text: str) -> Callable[[type], Entry]:
    """Return what makes a class statement an entry of the catalogue.

    The statement says what the law is called and where it comes from. It may give parameters a
    default, or another quantity, as a dataclass does. Fields and equations are those of the parts.
    """

    def entered(statement: type) -> Entry:
        entry = Entry(composition=text, statement=statement)
        return CATALOGUE.setdefault(entry.name, entry)

    return entered


@functools.cache
def _by_parts() -> Mapping[str, Entry]:
    """Return the entries by canonical compositions, with optional parts and without.

    Of equal ones it is the first.
    """
    result: dict[str, Entry] = {}
    for entry in CATALOGUE.values():
        term = notation.read(entry.composition)
        for form in (term, notation.without_optional(term)):
            result.setdefault(notation.canonical(form), entry)
    return MappingProxyType(result)


class Contained:
    """The attribute `contained` of a class of laws, which is worked out when it is asked for."""

    def __init__(self, composition: Composition, known: Callable[[], Mapping[str, Any]]) -> None:
        self._found = functools.cache(
            lambda kind: tuple(nearest_contained(composition, kind, known()))
        )

    def __get__(self, law: object, kind: type[laws.FrictionLaw]) -> tuple[laws.Containment, ...]:
        return self._found(kind)


def _made(c: Composition, name: str, space: Mapping[str, Any]) -> type[laws.FrictionLaw]:
    """Return the class of a composition, with what is said of it."""
    without: Any = laws.FrictionLaw if c.directional else laws.SetValuedLaw
    base: Any = laws.BristleLaw if c.memory is not None else without
    kind: Any = type(base)(name, (base,), dict(space))
    for field, hint in inspect.get_annotations(kind).items():
        c.fields[field] = Parameter(name=field, hint=hint, default=dataclasses.MISSING)
    # Parameters with a range first: exponents stand last in signatures and tables.
    fields = sorted(c.fields.values(), key=lambda item: item.quantity.structural)
    for parameter in fields:
        if parameter.default is not dataclasses.MISSING and parameter.name not in space:
            setattr(kind, parameter.name, parameter.default)
    kind.__annotations__ = {entry.name: entry.hint for entry in fields}
    equations = equations_of(c, lambda side: class_of(one_way(c.term, side)))
    for key, equation in equations.items():
        if key not in space:
            setattr(kind, key, equation)
    kind.composition, kind.made_of = c.term, c
    kind.directional, kind.inputs = c.directional, c.inputs
    kind.on_request = bool(space.get("on_request", True))
    # A formula is as well compared as the least of its parts.
    kind.compared = kind.compared and all(head.part.compared for head in c.term.parts())
    kind.contained = Contained(c, _by_parts)
    if kind.passivity is None:
        kind.passivity = _passivity(c)
    if "formula" not in space:
        kind.formula = formula_of(c)
    # Methods came after the class: what is abstract has to be found anew.
    abc.update_abstractmethods(kind)
    made: Any = final(dataclasses.dataclass(frozen=True, kw_only=True)(kind))
    for key, arguments in FLOATS.items():
        if key in equations and (c.memory is not None or not made.directional):
            setattr(made, key, for_floats(made, key, equations[key], arguments))
    return made  # type: ignore[no-any-return]  # a class made by a call


def _passivity(c: Composition) -> laws.Passivity | None:
    """Return when the parts of a composition take energy alone; None where they do not tell."""
    parts = [head.part for head in c.term.parts()]
    doubtful = [part for part in parts if not (part.opposes or getattr(part, "dissipates", False))]
    conditions = {getattr(part, "positive_if", "") for part in doubtful}
    # an input that changes scales stiffness too, and with it what springs hold already
    if (c.memory and c.inputs) or "" in conditions:
        return None
    if not doubtful:
        return laws.ALWAYS

    def holds(law: Any, _load: float) -> bool:
        given = laws.anywhere(law)
        return all(
            cast(Factor, leaf.part).positive(leaf.told(given, STILL, way)[0])
            for leaf in c.factors.values()
            for way in (lambda forward, _: forward, lambda _, backward: backward)
        )

    return laws.Passivity(condition=" and ".join(sorted(conditions)), holds=holds)


def class_of(term: notation.Term) -> type[laws.FrictionLaw]:
    """Return the class of a term: that with a name, or one that has its text as name."""
    return _by_text(str(term))


@functools.cache
def _by_text(text: str) -> type[laws.FrictionLaw]:
    c = Composition(notation.read(text))  # refuses what cannot stand together
    entry = _by_parts().get(notation.canonical(c.term))
    if entry is not None:
        return entry.law
    said = {
        "__module__": HOME,
        "__qualname__": text,
        "__doc__": f"The composition {text}.",
        "name": text,
        "title": c.term.title,
        "sources": (),
    }
    return _made(c, text, said)
