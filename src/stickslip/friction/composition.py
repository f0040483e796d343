"""A composition made ready: its parts in their places, and the parameters of its law."""

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping
from typing import Annotated, Any, NoReturn, TypeAlias, final

from stickslip.described import alternatives, marks
from stickslip.errors import InputError
from stickslip.friction.notation import (
    BOTH_WAYS,
    PER_DIRECTION,
    Around,
    Name,
    Sum,
    Term,
    terms_of,
)
from stickslip.friction.parts.base import Level, Parameter, Part
from stickslip.quantities import Quantity

__all__ = ["SIDES", "Choose", "Composition", "Leaf"]

SIDES = {1: ("forward_", "+"), -1: ("backward_", "-")}
"""Prefix of parameters and mark of symbols, by direction."""

Names: TypeAlias = Mapping[str, str | tuple[str, str]]
"""Field of the law by a part's own name of it; two where the directions have their own."""
Choose: TypeAlias = Callable[[Any, Any], Any]
"""Chooses between the values for the two directions."""


@final
@dataclasses.dataclass(frozen=True, kw_only=True)
class Leaf:
    """A part in its place: what its parameters are called, and the smooth sign around it."""

    part: Part
    names: Names
    sign: "Leaf | None" = None

    def values(self, law: Any, choose: Choose | None) -> Any:
        """Return the parameters of a law as the part calls them."""
        return _Values(law, self.names, choose) if self.names else law


class _Values:
    """The parameters of a law under the names that a part has for them."""

    __slots__ = ("_choose", "_law", "_names")

    def __init__(self, law: Any, names: Names, choose: Choose | None) -> None:
        self._law, self._names, self._choose = law, names, choose

    def __getattr__(self, name: str) -> Any:
        field = self._names.get(name, name)
        if isinstance(field, tuple):
            assert self._choose is not None
            return self._choose(*(getattr(self._law, one) for one in field))
        return getattr(self._law, field)


@final
class Composition:
    """A term made ready: the fields of its law, and the parts that its equations are summed of.

    Parameters
    ----------
    term : Term
        The term.
    names : mapping of str to str
        Fields by the names that parts have for them, where these differ.

    Raises
    ------
    InputError
        If the parts cannot stand together; the message says what can.
    """

    def __init__(self, term: Term, names: Mapping[str, str]) -> None:
        self.term, self.renamed = term, names
        self.fields: dict[str, Parameter] = {}
        self.meanings: dict[str, str] = {}
        self.memory: Leaf | None = None
        self.argument = ""
        self.inside: list[Leaf] = []
        self.outside: list[Leaf] = []
        self._refuse_twice()
        for item in terms_of(term):
            if isinstance(item, Around) and item.head.role == "memory":
                self._remember(item)
            else:
                self.outside += self._leaves(item, "", inside=False)
        self.inside, self.outside = _scoped(self.inside), _scoped(self.outside)
        self._check()

    def _refuse(self, sentence: str) -> NoReturn:
        raise InputError(f"the friction law {str(self.term)!r} {sentence}")

    def _remember(self, item: Around) -> None:
        """Enter a memory and the curve inside it."""
        head = item.head
        if head.part.argument and not head.argument:
            self._refuse(f"does not say how many elements {head} has: write {head}[4].")
        self.inside = self._leaves(item.inner, "", inside=True)
        self.argument = head.argument
        self.memory = Leaf(part=head.part, names=self._enter(head, ""))

    def _leaves(self, term: Term, sides: str, *, inside: bool) -> list[Leaf]:
        """Enter the parameters of a term; return its parts."""
        match term:
            case Sum(items=items):
                return [leaf for one in items for leaf in self._leaves(one, sides, inside=inside)]
            case Around(head=head, inner=inner):
                if head.role == BOTH_WAYS and not sides:
                    return _scoped(self._leaves(inner, head.argument or "all", inside=inside))
                self._check_around(head, inside=inside)
                return self._smoothed(head, self._leaves(inner, sides, inside=False))
            case Name(name=name, role=role):
                if role in (BOTH_WAYS, "memory", "sign"):
                    self._refuse(f"has {name} without brackets: write {name}(level).")
                if inside and role != "level":
                    self._refuse(
                        f"has {name} inside a memory, which holds levels only"
                        + (f": write dahl(level) + {name}." if role == "flow" else ".")
                    )
                return [Leaf(part=term.part, names=self._enter(term, sides, inside=inside))]
        raise AssertionError(term)

    def _check_around(self, head: Name, *, inside: bool) -> None:
        """Refuse what cannot stand around a term."""
        if head.role == BOTH_WAYS:
            self._refuse("has both_ways inside both_ways: leave one of them out.")
        if head.role == "memory":
            self._refuse(
                f"has the memory {head.name} inside another term: a memory is a term of its own,"
                f" such as {head.name}(level) + viscous."
            )
        if head.role != "sign":
            self._refuse(f"has brackets behind {head.name}, which takes none.")
        if inside:
            self._refuse(
                f"has {head.name} inside a memory, which is smooth by itself: leave it out."
            )

    def _smoothed(self, head: Name, leaves: list[Leaf]) -> list[Leaf]:
        if not all(isinstance(leaf.part, Level) and leaf.sign is None for leaf in leaves):
            self._refuse(
                f"has other parts than levels inside {head.name}: write them beside it, as in"
                f" {head.name}(level) + viscous."
            )
        for name in (leaf.part.name for leaf in leaves if not leaf.part.tex):
            self._refuse(f"has {name} inside {head}, which is 0 at rest: leave {name} out.")
        smooth = Leaf(part=head.part, names=self._enter(head, ""))
        return [dataclasses.replace(leaf, sign=smooth) for leaf in _scoped(leaves)]

    def _refuse_twice(self) -> None:
        parts = [name for name in self.term.parts() if name.name != BOTH_WAYS]
        memories = [one.name for one in parts if one.role == "memory"]
        if len(memories) > 1:
            self._refuse(f"has two memories, {' and '.join(memories)}: keep one of them.")
        named = [one.name for one in parts]
        for name in dict.fromkeys(named):
            if named.count(name) > 1:
                self._refuse(f"has {name} twice: leave one of them out.")
        owners: dict[str, str] = {}
        for one in parts:
            for parameter in one.part.parameters:
                other = owners.setdefault(parameter.name, one.name)
                if other != one.name:
                    self._refuse(
                        f"has {other} and {one.name}, which both have {parameter.name}: keep one"
                        " of them."
                    )

    def _check(self) -> None:
        """Refuse levels that have nothing to stand on."""
        for leaves in (self.inside, self.outside):
            levels = [leaf.part for leaf in leaves if isinstance(leaf.part, Level)]
            names = [part.name for part in levels]
            if levels and "level" not in names:
                self._refuse(f"has {names[0]} without level: write level + {names[0]}.")
            if (
                len({leaf.sign and leaf.sign.part.name for leaf in leaves if leaf.part in levels})
                > 1
            ):
                self._refuse(
                    f"has only some of {' and '.join(names)} inside a smooth sign: write all"
                    " inside, or none."
                )
            if "peak" in names and all(part.rest != "static_coefficient" for part in levels):
                self._refuse("has peak without a static surplus: write level + stribeck + peak.")

    def _enter(self, name: Name, sides: str, *, inside: bool = False) -> Names:
        """Enter the parameters of a part; return what they are called where that differs."""
        names: dict[str, str | tuple[str, str]] = {}
        for one in name.part.parameters:
            given = self.renamed.get(one.name, one.name)
            doubled = sides == "all" or (bool(sides) and one.quantity.scale in PER_DIRECTION)
            made = []
            for prefix, mark in SIDES.values() if doubled else (("", ""),):
                field, meaning = prefix + given, prefix + one.name
                if self.meanings.setdefault(field, meaning) != meaning:
                    self._refuse(f"has two parameters called {field}, of different meaning.")
                change = functools.partial(self._placed, name.name, prefix, mark, inside)
                self.fields[field] = dataclasses.replace(
                    one, name=field, hint=_changed(one.hint, change)
                )
                made.append(field)
            if doubled:
                names[one.name] = (made[0], made[1])
            elif given != one.name:
                names[one.name] = given
        return names

    def _placed(self, part: str, prefix: str, mark: str, inside: bool, q: Quantity) -> Quantity:
        """Return the quantity of a part's parameter as it is in this law."""
        symbol = q.symbol
        if mark:
            stem, _, index = symbol.partition("_")
            symbol = f"{stem}_{mark}" if index in ("k", "2", "") else f"{symbol}{mark}"
        if symbol in {one.quantity.symbol for one in self.fields.values()}:
            symbol = f"{symbol}_{part[0]}"
        # a memory divides by its levels
        positive = inside and q.scale == "level" and q.low == 0
        return dataclasses.replace(
            q,
            symbol=symbol,
            low=-math.inf if positive else q.low,
            above=0.0 if positive else q.above,
            at_least=q.at_least and prefix + self.renamed.get(q.at_least, q.at_least),
            scale=q.scale + mark if q.scale in PER_DIRECTION else q.scale,
        )

    @property
    def directional(self) -> bool:
        """Whether the directions have parameters of their own."""
        return any(name.name == BOTH_WAYS for name in self.term.parts())


def _scoped(leaves: list[Leaf]) -> list[Leaf]:
    """Let the parts of a sum see each other's parameters."""
    known: dict[str, str | tuple[str, str]] = {}
    for leaf in leaves:
        known |= leaf.names
    return [dataclasses.replace(leaf, names={**known, **leaf.names}) for leaf in leaves]


def _changed(hint: Any, change: Callable[[Quantity], Quantity]) -> Any:
    """Return a hint with its quantity changed."""
    found = []
    for one in alternatives(hint):
        told = tuple(change(mark) if isinstance(mark, Quantity) else mark for mark in marks(one))
        found.append(Annotated[(one.__origin__, *told)] if told else one)
    return functools.reduce(lambda one, other: one | other, found)
