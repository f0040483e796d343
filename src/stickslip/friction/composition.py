"""Classes of laws that are composed of parts: their parameters, their equations, their names."""

import abc
import dataclasses
import functools
import inspect
import typing
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, TypeAlias, TypeVar, final

from typing_extensions import Doc

from stickslip.errors import InputError
from stickslip.friction.base import BristleLaw, DirectionalLaw, FrictionLaw, SetValuedLaw
from stickslip.friction.containment import Contained
from stickslip.friction.formulas import formula_of
from stickslip.friction.notation import (
    BOTH_WAYS,
    Around,
    Name,
    Product,
    Sum,
    Term,
    canonical,
    read,
    summed,
    terms_of,
)
from stickslip.friction.parts.base import (
    Factor,
    Flow,
    Level,
    Memory,
    Parameter,
    Part,
    Slip,
    SmoothLevel,
    SmoothSign,
    alternatives,
    marks,
)
from stickslip.friction.text import for_floats
from stickslip.maths import Scalar, sign, where
from stickslip.quantities import Quantity, unchecked

__all__ = ["Composition", "composed", "law", "named_laws"]

SIDES = {1: ("forward_", "+"), -1: ("backward_", "-")}
"""Prefix of parameters and mark of symbols, by direction."""
RANKS = {"static_coefficient": 1, "break_away_coefficient": 2}
"""Order of levels at rest: each is the whole level as far as those before it go."""
PER_DIRECTION = ("level", "slope")
"""Scales of parameters that ``both_ways[levels]`` doubles."""

K = TypeVar("K", bound=FrictionLaw)
Names: TypeAlias = Mapping[str, str | tuple[str, str]]
"""Field of the law by a part's own name of it; two where the directions have their own."""
Choose: TypeAlias = Callable[[Any, Any], Any]
"""Chooses between the values for the two directions."""


@final
@dataclasses.dataclass(frozen=True, kw_only=True)
class Leaf:
    """A part in its place: what its parameters are called, and what modulates it."""

    part: Part
    argument: str
    names: Names
    factors: tuple["Leaf", ...] = ()
    sign: "Leaf | None" = None

    def asks(self, law: Any, slip: Slip, choose: Choose | None) -> tuple[Any, Slip]:
        """Return what the equations of the part are given."""
        told = dataclasses.replace(slip, argument=self.argument) if self.argument else slip
        return _Values(law, self.names, choose) if self.names else law, told

    def modulated(self, value: Scalar, law: Any, slip: Slip, choose: Choose | None) -> Scalar:
        """Return what the part gives, times the factors beside it."""
        for one in self.factors:
            value = value * typing.cast(Factor, one.part).factor(*one.asks(law, slip, choose))
        return value


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
    """A term made ready: the fields of its law, and the leaves that its equations are summed of.

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
        inside: list[Leaf] = []
        outside: list[Leaf] = []
        for item in terms_of(term):
            if (
                isinstance(item, Around)
                and item.head.name != BOTH_WAYS
                and item.head.part.role == "memory"
            ):
                inside = self._remembered(item)
            else:
                outside += self._leaves(item, "", inside=False)
        self.inside, self.outside = self._scoped(inside), self._scoped(outside)
        self._check()

    def _refuse(self, sentence: str) -> typing.NoReturn:
        raise InputError(f"the friction law {str(self.term)!r} {sentence}")

    def _remembered(self, item: Around) -> list[Leaf]:
        """Enter a memory; return the leaves of the curve inside."""
        if self.memory is not None:
            self._refuse(
                f"has two memories, {self.memory.part.name} and {item.head.name}: keep one of them."
            )
        if item.head.part.argument and not item.head.argument:
            self._refuse(f"does not say how many elements {item.head} has: write {item.head}[4].")
        leaves = self._leaves(item.inner, "", inside=True)
        self.memory = Leaf(
            part=item.head.part, argument=item.head.argument, names=self._enter(item.head, "")
        )
        return leaves

    def _leaves(self, term: Term, sides: str, *, inside: bool) -> list[Leaf]:
        match term:
            case Sum(items=items):
                return self._scoped(
                    [leaf for item in items for leaf in self._leaves(item, sides, inside=inside)]
                )
            case Product(first=first, factors=factors):
                leaves = self._leaves(first, sides, inside=inside)
                stem = first.part.stem.format(first.argument) if isinstance(first, Name) else ""
                marks = tuple(self._factor(one, sides, stem) for one in factors)
                return [
                    dataclasses.replace(leaf, factors=(*leaf.factors, *marks)) for leaf in leaves
                ]
            case Around(head=Name(name="both_ways"), inner=inner):
                if sides:
                    self._refuse("has both_ways inside both_ways: leave one of them out.")
                return self._leaves(inner, term.head.argument or "all", inside=inside)
            case Around(head=head, inner=inner) if head.part.role == "sign":
                if inside:
                    self._refuse(
                        f"has {head.name} inside a memory, which is smooth by itself: leave"
                        f" {head.name} out."
                    )
                return self._smoothed(head, self._leaves(inner, sides, inside=False))
            case Around(head=head) if head.part.role == "memory":
                self._refuse(
                    f"has the memory {head.name} inside another term: a memory is a term of its"
                    f" own, such as {head.name}(level) + viscous."
                )
            case Around(head=head):
                self._refuse(
                    f"has brackets behind {head.name}, which takes none: write {head.name} + ... ."
                )
            case Name():
                return [self._leaf(term, sides, inside=inside)]
        raise AssertionError(term)

    def _leaf(self, name: Name, sides: str, *, inside: bool) -> Leaf:
        if name.name == BOTH_WAYS or name.part.role in ("memory", "sign"):
            self._refuse(f"has {name.name} without brackets: write {name.name}(level).")
        if name.part.role == "factor":
            self._refuse(
                f"has the factor {name} alone: a factor stands behind a part, as in level * {name}."
            )
        if inside and name.part.role != "level":
            self._refuse(
                f"has {name} inside a memory, which holds levels only: write it beside the memory,"
                f" as in dahl(level) + {name}."
            )
        return Leaf(
            part=name.part, argument=name.argument, names=self._enter(name, sides, inside=inside)
        )

    def _factor(self, term: Term, sides: str, stem: str) -> Leaf:
        if not (isinstance(term, Name) and term.name != BOTH_WAYS and term.part.role == "factor"):
            self._refuse(f"multiplies by {term}, which is no factor.")
        return Leaf(part=term.part, argument=term.argument, names=self._enter(term, sides, stem))

    def _smoothed(self, head: Name, leaves: list[Leaf]) -> list[Leaf]:
        smooth = Leaf(part=head.part, argument="", names=self._enter(head, ""))
        if not all(isinstance(leaf.part, Level) and leaf.sign is None for leaf in leaves):
            self._refuse(
                f"has other parts than levels inside {head.name}: write them beside it, as in"
                f" {head.name}(level) + viscous."
            )
        return [dataclasses.replace(leaf, sign=smooth) for leaf in leaves]

    def _scoped(self, leaves: list[Leaf]) -> list[Leaf]:
        """Let the leaves of a sum see each other's parameters."""
        known: dict[str, str | tuple[str, str]] = {}
        for leaf in leaves:
            known |= leaf.names
        return [dataclasses.replace(leaf, names={**known, **leaf.names}) for leaf in leaves]

    def _check(self) -> None:
        """Refuse what cannot be meant."""
        named = [str(name) for name in self.term.parts()]
        twice = next(
            (
                one
                for one in named
                if named.count(one) > 1 and one != BOTH_WAYS and not one.startswith(BOTH_WAYS)
            ),
            None,
        )
        if twice is not None:
            self._refuse(f"has {twice} twice: leave one of them out.")
        for leaves in (self.inside, self.outside):
            levels = [leaf.part for leaf in leaves if isinstance(leaf.part, Level)]
            chain = [part for part in levels if part.rest]
            fading = [part.name for part in chain if part.rest == "static_coefficient"]
            if chain and all(part.name != "level" for part in chain):
                name = chain[0].name
                self._refuse(
                    f"has {name} without level, which it is a surplus on: write level + {name}."
                )
            if len(fading) > 1:
                self._refuse(f"has two static surpluses, {' and '.join(fading)}: keep one of them.")
            if any(part.name == "peak" for part in chain) and not fading:
                self._refuse(
                    "has peak without a static surplus before it: write level + stribeck + peak."
                )
        if self.memory is not None and not any(
            isinstance(leaf.part, Level) for leaf in self.inside
        ):
            self._refuse("has a memory without a level in it.")

    def _enter(self, name: Name, sides: str, stem: str = "", *, inside: bool = False) -> Names:
        """Enter the parameters of a part; return what they are called where that differs."""
        names: dict[str, str | tuple[str, str]] = {}
        part = name.part
        for one in part.parameters:
            own = one.name
            given = "_".join(
                filter(None, (stem if part.role == "factor" else "", _filled(own, name)))
            )
            given = self.renamed.get(given, given)
            doubled = sides == "all" or (bool(sides) and one.quantity.scale in PER_DIRECTION)
            made = []
            for prefix, mark in SIDES.values() if doubled else (("", ""),):
                change = functools.partial(
                    self._placed, name=name, stem=stem, prefix=prefix, mark=mark, inside=inside
                )
                field, meaning = prefix + given, prefix + _filled(own, name)
                if self.meanings.setdefault(field, meaning) != meaning:
                    self._refuse(f"has two parameters called {field}, of different meaning.")
                if field not in self.fields:
                    self.fields[field] = Parameter(
                        name=field, hint=_changed(one.hint, change), default=one.default
                    )
                made.append(field)
            if doubled:
                names[own] = (made[0], made[1])
            elif made[0] != own:
                names[own] = made[0]
        return names

    def _placed(
        self, q: Quantity, *, name: Name, stem: str, prefix: str, mark: str, inside: bool
    ) -> Quantity:
        """Return the quantity of a part's parameter as it is in this law."""
        symbol = _filled(q.symbol, name, stem)
        if mark:
            stem, _, index = symbol.partition("_")
            symbol = f"{stem}_{mark}" if index in ("k", "2", "") else f"{symbol}{mark}"
        others = {f.quantity.symbol for f in self.fields.values()}
        if symbol in others:
            symbol = f"{symbol}_{name.name[0]}"
        # a memory divides by its levels
        positive = inside and q.scale == "level" and q.low == 0
        return dataclasses.replace(
            q,
            symbol=symbol,
            low=-float("inf") if positive else q.low,
            above=0.0 if positive else q.above,
            at_least=q.at_least and prefix + self.renamed.get(q.at_least, q.at_least),
            scale=q.scale + mark if q.scale in PER_DIRECTION else q.scale,
        )

    @property
    def directional(self) -> bool:
        """Whether the directions have parameters of their own."""
        return any(name.name == BOTH_WAYS for name in self.term.parts())

    def levels(
        self, leaves: Sequence[Leaf], law: Any, slip: Slip, choose: Choose | None
    ) -> Scalar | None:
        """Return the level of sliding, over the load; None where no part has one."""
        found = []
        for leaf in leaves:
            if not isinstance(leaf.part, (Level, SmoothLevel)):
                continue
            p, s = leaf.asks(law, slip, choose)
            value = leaf.part.sliding(p, s)
            if value is not None:
                value = leaf.modulated(value, law, slip, choose)
                if leaf.sign is not None:
                    value = value * typing.cast(SmoothSign, leaf.sign.part).shape(
                        *leaf.sign.asks(law, slip, choose)
                    )
                found.append(value)
        return _total(found)

    def rest(
        self, leaves: Sequence[Leaf], law: Any, inputs: Mapping[str, Scalar], choose: Choose | None
    ) -> Scalar | None:
        """Return the level at rest, over the load; None where no part has one.

        Surpluses are whole levels less the ones before: of neighbours with the same factors, only
        the last whole level is left.
        """
        slip = Slip(speed=0.0, along=0.0, direction=1.0, inputs=inputs)
        held = [leaf for leaf in leaves if isinstance(leaf.part, Level) and leaf.sign is None]
        held.sort(key=lambda leaf: RANKS.get(leaf.part.rest, 0))
        chains: dict[tuple[str, ...], list[tuple[Leaf, Scalar]]] = {}
        found: list[Scalar] = []
        for leaf in held:
            part = typing.cast(Level, leaf.part)
            p, s = leaf.asks(law, slip, choose)
            whole = getattr(p, part.rest) if part.rest else None
            chain = chains.setdefault(
                tuple(f"{one.part.name}[{one.argument}]" for one in leaf.factors), []
            )
            if whole is not None and (chain or part.name == "level"):
                chain.append((leaf, whole))
            elif not part.rest or whole is not None:
                found.append(leaf.modulated(part.at_rest(p, s), law, slip, choose))
        kept = [
            leaf.modulated(whole, law, slip, choose)
            for *_, (leaf, whole) in filter(None, chains.values())
        ]
        return _total([*kept, *found])

    def flows(
        self, leaves: Sequence[Leaf], law: Any, slip: Slip, choose: Choose | None
    ) -> Scalar | None:
        """Return the force of the parts without levels."""
        found = []
        for leaf in leaves:
            if isinstance(leaf.part, Flow):
                value = leaf.part.flow(*leaf.asks(law, slip, choose))
                found.append(leaf.modulated(value, law, slip, choose))
        return _total(found)


def _total(values: Sequence[Scalar]) -> Scalar | None:
    """Return the sum; None where nothing is summed."""
    there = [one for one in values if one is not None]
    return functools.reduce(lambda one, other: one + other, there) if there else None


def _filled(text: str, name: Name, stem: str = "") -> str:
    """Put the argument of a part where its texts leave room for it."""
    argument = name.argument if name.part.argument == "input" else ""
    return text.replace("{0}", f"{stem}_{argument}" if stem else argument)


def _changed(hint: Any, change: Callable[[Quantity], Quantity]) -> Any:
    """Return a hint with its quantity changed."""
    found = []
    for one in alternatives(hint):
        told = tuple(change(mark) if isinstance(mark, Quantity) else mark for mark in marks(one))
        found.append(Annotated[(one.__origin__, *told)] if told else one)
    return functools.reduce(lambda one, other: one | other, found)


def _by_velocity(velocity: Scalar) -> Choose:
    return lambda forward, backward: where(velocity < 0.0, backward, forward)


def _least(forward: Scalar, backward: Scalar) -> Scalar:
    return where(forward < backward, forward, backward)


def _set_valued(c: Composition) -> dict[str, Any]:
    """Return the equations of a law without memory."""

    def sliding(self: Any, speed: Scalar, load: Scalar) -> Scalar:
        slip = Slip(speed=speed, along=speed, direction=1.0, inputs={})
        level = c.levels(c.outside, self, slip, None)
        return _total(
            [None if level is None else level * load, c.flows(c.outside, self, slip, None)]
        )

    def break_away(self: Any, load: Scalar) -> Scalar:
        level = c.rest(c.outside, self, {}, None)
        return (0.0 if level is None else level) * load

    return {"sliding": sliding, "break_away": break_away}


def _with_memory(c: Composition, leaf: Leaf) -> dict[str, Any]:
    """Return the equations of a law with a memory."""
    memory = typing.cast(Memory, leaf.part)

    def at(self: Any, velocity: Scalar) -> tuple[Slip, Choose, Scalar]:
        slip = Slip(speed=abs(velocity), along=velocity, direction=sign(velocity), inputs={})
        choose = _by_velocity(velocity)
        return slip, choose, c.levels(c.inside, self, slip, choose)

    def beside(self: Any, slip: Slip, choose: Choose, load: Scalar) -> Scalar | None:
        level = c.levels(c.outside, self, slip, choose)
        return _total(
            [
                None if level is None else slip.direction * level * load,
                c.flows(c.outside, self, slip, choose),
            ]
        )

    def force(self: Any, velocity: Scalar, bristles: tuple[Scalar, ...], load: Scalar) -> Scalar:
        slip, choose, g = at(self, velocity)
        held = memory.force(*leaf.asks(self, slip, choose), bristles, g)
        return _total([held * load, beside(self, slip, choose, load)])

    def bristle_rates(
        self: Any,
        velocity: Scalar,
        bristles: tuple[Scalar, ...],
        load: Scalar,  # noqa: ARG001
    ) -> tuple[Scalar, ...]:
        slip, choose, g = at(self, velocity)
        return memory.rates(*leaf.asks(self, slip, choose), bristles, g)

    def steady(self: Any, velocity: Scalar, load: Scalar) -> Scalar:
        slip, choose, g = at(self, velocity)
        return _total([g * load * slip.direction, beside(self, slip, choose, load)])

    def break_away(self: Any, load: Scalar) -> Scalar:
        return c.rest(c.inside, self, {}, _least) * load

    return {
        "bristles": memory.states(leaf.argument),
        "force": force,
        "bristle_rates": bristle_rates,
        "steady": steady,
        "break_away": break_away,
    }


def _one_way(term: Term) -> Term:
    """Return the term of one direction."""
    match term:
        case Around(head=Name(name="both_ways"), inner=inner):
            return inner
        case Sum(items=items):
            return summed(tuple(one for item in items for one in terms_of(_one_way(item))))
        case Product(first=first, factors=factors):
            return Product(_one_way(first), factors)
        case Around(head=head, inner=inner):
            return Around(head, _one_way(inner))
        case _:
            return term


def _directional(c: Composition) -> dict[str, Any]:
    """Return the equations of a law without memory that differ between the directions."""

    def towards(self: Any, direction: int) -> SetValuedLaw:
        kind = law(_one_way(c.term))
        prefix = SIDES[1 if direction > 0 else -1][0]
        values = {}
        for field in dataclasses.fields(kind):
            own = prefix + field.name if prefix + field.name in c.fields else field.name
            values[field.name] = getattr(self, own) if own in c.fields else field.default
        return unchecked(kind, **values)

    return {"towards": towards}


def composed(text: str, *, names: Mapping[str, str] | None = None) -> Callable[[type[K]], type[K]]:
    """Return what makes a class of laws of a class statement: fields and equations of its parts.

    The statement says what the law is called and where it comes from. It may give parameters a
    default, or another quantity, as a dataclass does.

    Parameters
    ----------
    text : str
        The composition.
    names : mapping of str to str, optional
        Fields by the names that parts have for them, where these differ.
    """
    composition = Composition(read(text), names or {})

    def of(kind: type[K]) -> type[K]:
        for name, hint in inspect.get_annotations(kind).items():
            composition.fields[name] = Parameter(name=name, hint=hint, default=dataclasses.MISSING)
        fields = sorted(composition.fields.values(), key=lambda one: one.quantity.structural)
        for field in fields:
            if field.default is not dataclasses.MISSING and field.name not in vars(kind):
                setattr(kind, field.name, field.default)
        kind.__annotations__ = {field.name: field.hint for field in fields}
        equations = _equations(composition)
        for name, equation in equations.items():
            if name not in vars(kind):
                setattr(kind, name, equation)
        kind.composition, kind.made_of = composition.term, composition
        kind.contained = Contained(composition)  # type: ignore[assignment]  # a descriptor
        if "formula" not in vars(kind):
            kind.formula = formula_of(composition)
        kind.__doc__ = documented(inspect.cleandoc(kind.__doc__ or ""), fields)
        abc.update_abstractmethods(kind)
        made = final(dataclasses.dataclass(frozen=True, kw_only=True)(kind))
        for name, arguments in FLOATS.items():
            if name in equations:
                setattr(made, name, for_floats(made, equations[name], arguments))
        return made

    return of


FLOATS = {
    "sliding": ("speed", "load"),
    "force": ("velocity", "bristles", "load"),
    "bristle_rates": ("velocity", "bristles", "load"),
    "steady": ("velocity", "load"),
}
"""Equations that have a text of their own for floats, with their arguments."""


def documented(text: str, parameters: Sequence[Parameter]) -> str:
    """Return the docstring of a class with a section on its parameters, before its examples."""
    lines = ["Parameters", "----------"]
    for one in parameters:
        optional = type(None) in alternatives(one.hint)
        lines.append(f"{one.name} : {'float or None' if optional else 'float'}")
        meaning = next(
            (mark.documentation for mark in marks(one.hint) if isinstance(mark, Doc)), ""
        )
        q = one.quantity
        lines.append(f"    {meaning.removesuffix('.')} ({q.symbol} [{q.unit}], {q.range}).")
    before, heading, after = text.partition("Examples\n--------\n")
    return "\n".join([before.rstrip(), "", *lines, *(["", heading + after] if heading else [])])


def _equations(c: Composition) -> dict[str, Any]:
    if c.memory is not None:
        return _with_memory(c, c.memory)
    return _directional(c) if c.directional else _set_valued(c)


def law(composition: str | Term) -> type[FrictionLaw]:
    """Return the class of laws that a composition stands for; the same one each time.

    Parameters
    ----------
    composition : str or term
        Parts, such as ``"lugre(level + stribeck) + power"``: ``+`` puts parts beside each other,
        ``*`` modulates one by a factor, brackets stand around what a memory, a smooth sign or
        ``both_ways`` is applied to.

    Returns
    -------
    type
        Subclass of `FrictionLaw`; that of the package where the composition has a name.

    Raises
    ------
    InputError
        If the text cannot be read, or its parts cannot stand together.
    UnknownNameError
        If it names an unknown part.

    Examples
    --------
    >>> law("viscous + level").__name__
    'CoulombViscous'
    >>> Thinning = law("dahl(level + stribeck) + power")
    >>> Thinning.composition
    dahl(level + stribeck) + power
    >>> [name for name in Thinning.__dataclass_fields__][:3]
    ['static_switch', 'bristle_stiffness', 'kinetic_coefficient']
    """
    term = read(composition) if isinstance(composition, str) else composition
    if not isinstance(term, Term):
        raise InputError(f"a composition must be a text or a sum of parts, got {composition!r}.")
    return _law(str(term))


@functools.cache
def _law(text: str) -> type[FrictionLaw]:
    c = Composition(read(text), {})
    return named_laws().get(canonical(c.term)) or _free(c)


@functools.cache
def named_laws() -> Mapping[str, type[FrictionLaw]]:
    """Return the laws that have a name, by their canonical composition; of equal ones the first."""
    from stickslip.friction.registry import LAWS  # made of classes that this module makes

    found: dict[str, type[FrictionLaw]] = {}
    for kind in LAWS.values():
        if issubclass(kind, FrictionLaw) and kind.composition is not None:
            found.setdefault(canonical(kind.composition), kind)
    return found


def _free(c: Composition) -> type[FrictionLaw]:
    """Return the class of a composition that has no name; it is found again by its text."""
    text = str(c.term)
    base = BristleLaw if c.memory is not None else DirectionalLaw if c.directional else SetValuedLaw
    space = {
        "__module__": __name__,
        "__qualname__": text,
        "__doc__": f"The composition {text}.",
        "name": text,
        "title": text,
        "sources": (),
        "on_request": True,
    }
    return composed(text)(type(text, (base,), space))


def __getattr__(name: str) -> type[FrictionLaw]:
    # where pickle looks for a class without a name
    try:
        return law(name)
    except InputError:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}") from None
