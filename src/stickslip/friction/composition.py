"""Classes of laws that are composed of parts: their parameters, their equations, their names."""

import abc
import dataclasses
import functools
import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, NoReturn, TypeAlias, TypeVar, cast, final

from typing_extensions import Doc

from stickslip.errors import InputError
from stickslip.friction.base import BristleLaw, DirectionalLaw, FrictionLaw, SetValuedLaw
from stickslip.friction.containment import Contained
from stickslip.friction.formulas import formula_of
from stickslip.friction.notation import (
    BOTH_WAYS,
    Around,
    Name,
    Sum,
    Term,
    canonical,
    read,
    summed,
    terms_of,
)
from stickslip.friction.parts.base import (
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
                        f"has {name} inside a memory, which holds levels only: write it beside the"
                        f" memory, as in dahl(level) + {name}."
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

    def _check(self) -> None:
        """Refuse levels that have nothing to stand on."""
        for leaves in (self.inside, self.outside):
            levels = [leaf.part for leaf in leaves if isinstance(leaf.part, Level)]
            names = [part.name for part in levels]
            surplus = [part.name for part in levels if part.rest == "static_coefficient"]
            if levels and "level" not in names:
                self._refuse(f"has {names[0]} without level: write level + {names[0]}.")
            if len(surplus) > 1:
                self._refuse(f"has two static surpluses, {' and '.join(surplus)}: keep one.")
            if "peak" in names and not surplus:
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
                if field not in self.fields:
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


def _level(leaves: Sequence[Leaf], law: Any, slip: Slip, choose: Choose | None = None) -> Scalar:
    """Return the level of sliding, over the load; None where no part has one."""
    found = []
    for leaf in leaves:
        if isinstance(leaf.part, (Level, SmoothLevel)):
            value = leaf.part.sliding(leaf.values(law, choose), slip)
            if leaf.sign is not None and value is not None:
                smooth = cast(SmoothSign, leaf.sign.part)
                value = value * smooth.shape(leaf.sign.values(law, choose), slip)
            found.append(value)
    return _total(found)


def _rest(leaves: Sequence[Leaf], law: Any, choose: Choose | None = None) -> Scalar:
    """Return the level at rest, over the load: the last whole level that is given."""
    found = 0.0
    ranks = ("kinetic_coefficient", "static_coefficient", "break_away_coefficient")
    held = {
        leaf.part.rest: leaf for leaf in leaves if isinstance(leaf.part, Level) and not leaf.sign
    }
    for rest in ranks:
        given = getattr(held[rest].values(law, choose), rest) if rest in held else None
        found = found if given is None else given
    return found


def _flow(leaves: Sequence[Leaf], law: Any, slip: Slip, choose: Choose | None = None) -> Scalar:
    """Return the force of the parts without levels; None where there are none."""
    flows = [leaf for leaf in leaves if isinstance(leaf.part, Flow)]
    return _total([cast(Flow, leaf.part).flow(leaf.values(law, choose), slip) for leaf in flows])


def _total(values: Sequence[Scalar]) -> Scalar | None:
    """Return the sum; None where nothing is summed."""
    there = [one for one in values if one is not None]
    return functools.reduce(lambda one, other: one + other, there) if there else None


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
        slip = Slip(speed=speed, along=speed)
        level = _level(c.outside, self, slip)
        return _total([None if level is None else level * load, _flow(c.outside, self, slip)])

    def break_away(self: Any, load: Scalar) -> Scalar:
        return _rest(c.outside, self) * load

    return {"sliding": sliding, "break_away": break_away}


def _with_memory(c: Composition, leaf: Leaf) -> dict[str, Any]:
    """Return the equations of a law with a memory."""
    memory = cast(Memory, leaf.part)

    def at(self: Any, velocity: Scalar) -> tuple[Slip, Choose, Scalar]:
        slip, choose = Slip(speed=abs(velocity), along=velocity), _by_velocity(velocity)
        return slip, choose, _level(c.inside, self, slip, choose)

    def beside(self: Any, slip: Slip, choose: Choose, load: Scalar) -> Scalar:
        level = _level(c.outside, self, slip, choose)
        scaled = None if level is None else sign(slip.along) * level * load
        return _total([scaled, _flow(c.outside, self, slip, choose)])

    def force(self: Any, velocity: Scalar, bristles: tuple[Scalar, ...], load: Scalar) -> Scalar:
        slip, choose, g = at(self, velocity)
        held = memory.force(leaf.values(self, choose), slip, bristles, g)
        return _total([held * load, beside(self, slip, choose, load)])

    def bristle_rates(
        self: Any,
        velocity: Scalar,
        bristles: tuple[Scalar, ...],
        load: Scalar,  # noqa: ARG001
    ) -> tuple[Scalar, ...]:
        slip, choose, g = at(self, velocity)
        return memory.rates(leaf.values(self, choose), slip, bristles, g)

    def steady(self: Any, velocity: Scalar, load: Scalar) -> Scalar:
        slip, choose, g = at(self, velocity)
        return _total([g * load * sign(velocity), beside(self, slip, choose, load)])

    def break_away(self: Any, load: Scalar) -> Scalar:
        return _rest(c.inside, self, _least) * load

    return {
        "bristles": memory.states(c.argument),
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
        case Around(head=head, inner=inner):
            return Around(head, _one_way(inner))
        case _:
            return term


def _directional(c: Composition) -> dict[str, Any]:
    """Return the equations of a law without memory that differ between the directions."""

    def towards(self: Any, direction: int) -> SetValuedLaw:
        kind = cast(type[SetValuedLaw], law(_one_way(c.term)))
        prefix = SIDES[1 if direction > 0 else -1][0]
        mine = {meaning: field for field, meaning in c.meanings.items()}
        values: dict[str, Any] = {}
        for name, meaning in kind.made_of.meanings.items():
            own = mine.get(prefix + meaning, mine.get(meaning))
            values[name] = kind.made_of.fields[name].default if own is None else getattr(self, own)
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
        if kind.composition is not None:
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
