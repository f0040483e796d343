"""A composition made ready: its parts in their places, the parameters of its law, its formula."""

import dataclasses
import functools
import itertools
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NoReturn, TypeAlias, cast

from stickslip.errors import InputError, UnknownNameError
from stickslip.friction.notation import (
    BOTH_WAYS,
    PER_DIRECTION,
    Around,
    Name,
    Product,
    Sum,
    Term,
    terms_of,
)
from stickslip.friction.parts.base import (
    Extra,
    Factor,
    Flow,
    Level,
    Memory,
    Parameter,
    Part,
    Slip,
    SmoothLevel,
)
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.quantities import Quantity
from stickslip.show.described import with_marks

# A composition made ready: its parts in their places, and the parameters of its law.

SIDES = {1: ("forward_", "+"), -1: ("backward_", "-")}
"""Prefix of parameters and mark of symbols, by direction."""

Names: TypeAlias = Mapping[str, str | tuple[str, str]]
"""Field of the law by a part's own name of it; two where the directions have their own."""
Choose: TypeAlias = Callable[[Any, Any], Any]
"""Chooses between the values for the two directions."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Leaf:
    """A part in its place: what its parameters are called, and what stands around it."""

    part: Part
    names: Names
    inputs: tuple[str, ...] = ()
    """Contact inputs that it asks for."""
    sign: "Leaf | None" = None
    """The smooth sign around it."""
    factors: "tuple[Leaf, ...]" = ()
    """Factors behind it."""
    modulated: "Mapping[str, tuple[Leaf, ...]]" = dataclasses.field(default_factory=dict)
    """Factors of parameters, by the part's own name of these."""

    def __str__(self) -> str:
        holds = self.inputs if self.part.argument == "input" else ()
        return self.part.name + "".join(f"[{hold}]" for hold in holds)

    def told(self, law: Any, slip: Slip, choose: Choose | None) -> tuple[Any, Slip]:
        """Return the parameters of a law as the part calls them, and what it asks for."""
        if self.inputs:
            slip = dataclasses.replace(slip, inputs=tuple(map(law.contact, self.inputs)))
        if self.part.directional:
            slip = dataclasses.replace(slip, choose=choose)
        if not (self.names or self.modulated):
            return law, slip
        return _Values(law, self, choose), slip

    def times(self, value: Any, law: Any, slip: Slip, choose: Choose | None) -> Any:
        """Return a value of the part times its factors."""
        for leaf in self.factors:
            value = value * leaf.factor(law, slip, choose)
        return value

    def factor(self, law: Any, slip: Slip, choose: Choose | None) -> Any:
        """Return the number that a factor multiplies with."""
        assert isinstance(self.part, Factor)
        return self.part.factor(*self.told(law, slip, choose))


class _Values:
    """The parameters of a law under the names that a part has for them."""

    __slots__ = ("_choose", "_law", "_leaf")

    def __init__(self, law: Any, leaf: Leaf, choose: Choose | None) -> None:
        self._law, self._leaf, self._choose = law, leaf, choose

    def __getattr__(self, name: str) -> Any:
        field = self._leaf.names.get(name, name)
        # The directions have fields of their own, between which the sign of the slip chooses.
        if isinstance(field, tuple):
            assert self._choose is not None
            value = self._choose(*(getattr(self._law, key) for key in field))
        else:
            value = getattr(self._law, field)
        for factor in self._leaf.modulated.get(name, ()):
            value = value * factor.factor(self._law, STILL, self._choose)
        return value


STILL = Slip(speed=0.0, along=0.0)
"""A contact at rest; factors do not ask for the slip."""


class Composition:
    """A term made ready: the fields of its law, and the parts that its equations are summed of.

    Parameters
    ----------
    term : Term
        The term.

    Raises
    ------
    InputError
        If the parts cannot stand together; the message says what can.
    """

    def __init__(self, term: Term) -> None:
        self.term = term
        self.fields: dict[str, Parameter] = {}
        self.memory: Leaf | None = None
        self.factors: dict[str, Leaf] = {}
        self.argument = ""
        self.inside: list[Leaf] = []
        self.outside: list[Leaf] = []
        self._refuse_twice()
        # A memory has its levels inside, where its equations divide by them; all else stands beside
        # it.
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
        self._check_number(head)
        self.inside = self._leaves(item.inner, "", inside=True)
        self.argument = head.argument
        self.memory = Leaf(part=head.part, names=self._enter(head, ""))

    def _check_number(self, name: Name) -> None:
        """Refuse a part that is shaped by a number which is not there."""
        if name.part.argument == "number" and not name.argument:
            memory = name.role == "memory"
            what = f"how many elements {name} has" if memory else f"up to which power {name} goes"
            self._refuse(f"does not say {what}: write {name}[{4 if memory else 2}].")

    def _leaves(self, term: Term, sides: str, *, inside: bool) -> list[Leaf]:
        """Enter the parameters of a term; return its parts."""
        match term:
            case Sum(items=items):
                return [leaf for item in items for leaf in self._leaves(item, sides, inside=inside)]
            case Around(head=head, inner=inner):
                if head.role == BOTH_WAYS and not sides:
                    return _scoped(self._leaves(inner, head.argument or "all", inside=inside))
                self._check_around(head, inner, inside=inside)
                return self._smoothed(head, self._leaves(inner, sides, inside=False))
            case Product(first=Around(head=Name(role="memory") as head), factors=factors):
                self._refuse(
                    f"has {factors[0]} behind the memory {head.name}: write it inside, as in"
                    f" {head}(level * {factors[0]})."
                )
            case Product(first=first):
                return self._multiplied(term, self._leaves(first, sides, inside=inside), sides)
            case Name(name=name, role=role):
                if role in (BOTH_WAYS, "memory", "sign"):
                    asks = role == "memory" and term.part.argument and not term.argument
                    whole = f"{name}[4]" if asks else term
                    self._refuse(f"has {name} without brackets: write {whole}(level).")
                if role == "factor":
                    self._refuse(
                        f"has the factor {term} without what it multiplies: write level * {term}."
                    )
                if inside and role != "level":
                    self._refuse(
                        f"has {name} inside a memory, which holds levels only"
                        + (f": write {self._memory()}(level) + {name}." if role == "flow" else ".")
                    )
                self._check_number(term)
                # a memory divides by its levels; what an extra adds may be 0
                names = self._enter(term, sides, inside=inside and isinstance(term.part, Level))
                return [Leaf(part=term.part, names=names, inputs=term.inputs)]
        raise AssertionError(term)

    def _multiplied(self, term: Product, leaves: list[Leaf], sides: str) -> list[Leaf]:
        """Enter the parameters of factors; return what they multiply with them."""
        whole: tuple[Leaf, ...] = ()
        modulated: dict[str, tuple[Leaf, ...]] = {}
        for factor in term.factors:
            names = self._enter(factor, sides, stem=term.stem(factor), owner=str(term))
            leaf = Leaf(part=factor.part, names=names, inputs=factor.inputs)
            self.factors[str(Product(term.first, (factor,)))] = leaf
            if factor.modulated:
                self._check_modulated(factor, leaves)
                there = modulated.get(factor.modulated, ())
                modulated[factor.modulated] = (*there, leaf)
            else:
                whole = (*whole, leaf)
        return [
            dataclasses.replace(
                part,
                factors=(*part.factors, *whole),
                modulated={**part.modulated, **modulated},
            )
            for part in leaves
        ]

    def _check_modulated(self, factor: Name, leaves: list[Leaf]) -> None:
        """Refuse a factor of a parameter that is not there, or that shapes the equations."""
        known = {parameter.name: parameter for leaf in leaves for parameter in leaf.part.parameters}
        if factor.modulated not in known:
            raise UnknownNameError(f"parameter in {factor}:", factor.modulated, known)
        if known[factor.modulated].quantity.structural:
            self._refuse(f"has {factor} on an exponent, which is a constant: leave it out.")

    def _memory(self) -> Name:
        """Return the memory of the term, as it is written."""
        return next(name for name in self.term.parts() if name.role == "memory")

    def _check_around(self, head: Name, inner: Term, *, inside: bool) -> None:
        """Refuse what cannot stand around a term."""
        if head.role == BOTH_WAYS:
            self._refuse("has both_ways inside both_ways: leave one of them out.")
        if head.role == "memory":
            self._refuse(
                f"has the memory {head.name} inside another term: a memory is a term of its own,"
                f" such as {head.name}(level) + viscous."
            )
        if head.role != "sign":
            self._refuse(
                f"has brackets behind {head.name}, which takes none: write {head} + {inner}."
            )
        if inside:
            self._refuse(
                f"has {head.name} inside a memory, which is smooth by itself: leave it out."
            )

    def _smoothed(self, head: Name, leaves: list[Leaf]) -> list[Leaf]:
        if not all(isinstance(leaf.part, (Level, Extra)) and not leaf.sign for leaf in leaves):
            self._refuse(
                f"has other parts than levels inside {head.name}: write them beside it, as in"
                f" {head.name}(level) + viscous."
            )
        for name in (leaf.part.name for leaf in leaves if not leaf.part.tex):
            self._refuse(f"has {name} inside {head}, which is 0 at rest: leave {name} out.")
        smooth = Leaf(part=head.part, names=self._enter(head, ""))
        return [dataclasses.replace(leaf, sign=smooth) for leaf in _scoped(leaves)]

    def _refuse_twice(self) -> None:
        parts = [name for name in self.term.parts() if name.role not in (BOTH_WAYS, "factor")]
        memories = [part.name for part in parts if part.role == "memory"]
        if len(memories) > 1:
            self._refuse(f"has two memories, {' and '.join(memories)}: keep one of them.")
        named = [str(part) for part in parts]
        for name in dict.fromkeys(named):
            if named.count(name) > 1:
                self._refuse(f"has {name} twice: leave one of them out.")
        owners: dict[str, str] = {}
        for part in parts:
            for parameter in part.part.parameters:
                name = part.meaning(parameter.name)
                other = owners.setdefault(name, str(part))
                if other != str(part):
                    self._refuse_beside(other, part)
                    self._refuse(
                        f"has {other} and {part}, which both have {name}: keep one of them."
                    )

    def _refuse_beside(self, other: str, part: Name) -> None:
        """Refuse a level beside or inside a part that is a whole level of its own."""
        roles = {
            str(name): name.role for name in self.term.parts() if str(name) in (other, str(part))
        }
        whole = [name for name, role in roles.items() if role == "smooth level"]
        if len(whole) == 1 and "level" in roles.values():
            (level,) = (name for name in roles if name not in whole)
            self._refuse(
                f"has {level} besides {whole[0]}, which is a whole level of its own and takes no"
                f" brackets: write {whole[0]}, or {whole[0]} + viscous."
            )

    def _check(self) -> None:
        """Refuse levels that have nothing to stand on."""
        if self.memory is not None and not any(
            leaf.part.name in ("level", "table") for leaf in self.inside
        ):
            self._refuse(
                f"has {self.inside[0]} without level, by which a memory divides: write level +"
                f" {self.inside[0]}."
            )
        if self.memory is not None:
            self._check_ratio(self.memory)
        for leaves in (self.inside, self.outside):
            levels = [leaf.part for leaf in leaves if isinstance(leaf.part, Level)]
            names = [part.name for part in levels]
            known = {parameter.name for leaf in leaves for parameter in leaf.part.parameters}
            for leaf in (part for part in leaves if not known.issuperset(part.part.needs)):
                self._refuse(
                    f"has {leaf} without stribeck, as which it fades: write level + stribeck +"
                    f" {leaf}."
                )
            if levels and "level" not in names:
                self._refuse(f"has {names[0]} without level: write level + {names[0]}.")
            held = [leaf for leaf in leaves if isinstance(leaf.part, (Level, Extra))]
            if len({leaf.sign and leaf.sign.part.name for leaf in held}) > 1:
                self._refuse(
                    f"has only some of {' and '.join(map(str, held))} inside a smooth sign: write"
                    " all inside, or none."
                )
            if "peak" in names and all(part.rest != "static_coefficient" for part in levels):
                self._refuse("has peak without a static surplus: write level + stribeck + peak.")

    def _check_ratio(self, memory: Leaf) -> None:
        """Refuse inputs that change the levels of both directions by different ratios.

        States that stop at limits keep them where an input changes the level, and their force grows
        with the ratio of the level to what it is without inputs.
        """
        names = [name for leaf in self.inside for name in leaf.names.values()]
        if not (
            cast(Memory, memory.part).limited and any(isinstance(name, tuple) for name in names)
        ):
            return
        first = self.inside[0].factors
        shared = all(leaf.factors == first for leaf in self.inside)
        shared &= not any("coefficient" in name for leaf in self.inside for name in leaf.modulated)
        varying = [str(leaf) for leaf in self.inside if leaf.inputs]
        varying += [str(factor) for leaf in self.inside for factor in leaf.factors]
        split = any(isinstance(name, tuple) for leaf in first for name in leaf.names.values())
        if varying and (split or not shared or any(leaf.inputs for leaf in self.inside)):
            self._refuse(
                f"has {varying[0]} and both_ways inside {memory.part.name}, whose force would jump"
                f" where slip turns, as the input changes the levels of both directions by"
                " different ratios: leave one of them out, or take dahl, lugre or gms."
            )

    def _enter(
        self, name: Name, sides: str, *, inside: bool = False, stem: str = "", owner: str = ""
    ) -> Names:
        """Enter the parameters of a part; return what they are called where that differs."""
        names: dict[str, str | tuple[str, str]] = {}
        for parameter in name.parameters:
            given = name.meaning(parameter.name, stem)
            # Without brackets both_ways doubles all parameters, with [levels] those that scale with
            # levels.
            doubled = sides == "all" or (bool(sides) and parameter.quantity.scale in PER_DIRECTION)
            made = []
            for prefix, mark in SIDES.values() if doubled else (("", ""),):
                field = prefix + given
                if owner and field in self.fields:
                    self._refuse(
                        f"has {field} twice: put all that {name} multiplies in one pair of"
                        " brackets, and write it once."
                    )
                change = functools.partial(self._placed, owner or name.name, prefix, mark, inside)
                hint = with_marks(parameter.hint, change)
                self.fields[field] = dataclasses.replace(parameter, name=field, hint=hint)
                made.append(field)
            if doubled:
                names[parameter.name] = (made[0], made[1])
            elif made[0] != parameter.name:
                names[parameter.name] = made[0]
        return names

    def _placed(self, part: str, prefix: str, mark: str, inside: bool, q: Any) -> Any:
        """Return the quantity of a part's parameter as it is in this law, all else as it is."""
        if not isinstance(q, Quantity):
            return q
        symbol = q.symbol
        if mark:
            stem, _, index = symbol.partition("_")
            symbol = f"{stem}_{mark}" if index in ("k", "2", "") else f"{symbol}{mark}"
        # Parts may have a symbol in common: the later one gets the first letter of its part, then
        # numbers.
        taken = {field.quantity.symbol for field in self.fields.values()}
        if symbol in taken:
            first = f"{symbol}_{part.lstrip('(')[0]}"
            others = (f"{first}{i}" for i in range(2, len(taken) + 3))
            symbol = next(name for name in (first, *others) if name not in taken)
        # A memory divides by its levels: inside one they must be above 0, not only at least 0.
        positive = inside and q.scale == "level" and q.low == 0
        return dataclasses.replace(
            q,
            symbol=symbol,
            low=-math.inf if positive else q.low,
            above=0.0 if positive else q.above,
            at_least=q.at_least and prefix + q.at_least,
            scale=q.scale + mark if q.scale in PER_DIRECTION else q.scale,
        )

    @property
    def inputs(self) -> tuple[str, ...]:
        """The contact inputs that its law asks for, in the order of the text."""
        return tuple(dict.fromkeys(key for name in self.term.parts() for key in name.inputs))

    @property
    def drops(self) -> bool:
        """Whether friction falls at once where a state reaches its limit."""
        return any(getattr(name.part, "drops", False) for name in self.term.parts())

    @property
    def directional(self) -> bool:
        """Whether the directions have parameters of their own."""
        return any(name.name == BOTH_WAYS or name.part.directional for name in self.term.parts())


def _scoped(leaves: list[Leaf]) -> list[Leaf]:
    """Let the parts of a sum see each other's parameters."""
    known: dict[str, str | tuple[str, str]] = {}
    modulated: dict[str, tuple[Leaf, ...]] = {}
    for leaf in leaves:
        # names with a contact input in them are the part's alone: two may have the same
        known |= {} if leaf.part.argument == "input" else leaf.names
        modulated |= leaf.modulated
    return [
        dataclasses.replace(leaf, names={**known, **leaf.names}, modulated=modulated)
        for leaf in leaves
    ]


# The formula of a composition in LaTeX, put together from those of its parts.

SGN = r"\operatorname{sgn} v"
GREEK = ("mu", "sigma", "alpha", "beta", "gamma", "rho", "theta", "xi")


def formula_of(c: Composition) -> str:
    r"""Return the formula of a composition.

    Examples
    --------
    >>> from stickslip.friction import law
    >>> law("level + viscous").formula.partition(",")[0]
    'F = \\mu_k N \\operatorname{sgn} v + \\sigma_2 v'
    """
    if c.directional and c.memory is None:
        ahead, back = (_force(c, side) for side in (0, 1))
        # In each case the sign of v is known, and no sgn is left to write.
        forward = ahead.replace(f" {SGN}", "")
        backward = f"-{back}".replace(f" {SGN}", "") if SGN in back else back
        return rf"F = \begin{{cases}} {forward} & v > 0 \\ {backward} & v < 0 \end{{cases}}"
    terms = [f"F = {_force(c)}"]
    if c.memory is not None:
        sides = (0, 1) if c.directional else (None,)
        curves = [" + ".join(_levels(c, c.inside, side)) for side in sides]
        terms += [_placed(c, c.memory, c.memory.part.tex_where), f"g = {_cases(curves)}"]
        varies = any(leaf.inputs or leaf.factors or leaf.modulated for leaf in c.inside)
        if varies and cast(Memory, c.memory.part).limited:
            # inputs leave the limits of deflections as they are
            base = [leaf for leaf in c.inside if isinstance(leaf.part, Level)][-1:]
            rests = [
                _placed(
                    c,
                    replace(leaf, modulated={}),
                    _tex(STANDARD[cast(Level, leaf.part).rest]),
                    side,
                )
                for leaf in base
                for side in sides
            ]
            where = rf"g_0 = {_cases(rests)}" if base else r"g_0 = g(0) \text{ without inputs}"
            terms = [*(term.replace("g(0)", "g_0") for term in terms), where]
    for leaf in (*c.inside, *c.outside):
        terms += [_placed(c, leaf, leaf.part.tex_where)] if leaf.part.tex_where else []
    terms += _rest(c)
    return r", \quad ".join(terms)


def _cases(curves: Sequence[str]) -> str:
    """Return the LaTeX of both directions, or of one that holds in both."""
    if len(set(curves)) == 1:
        return curves[0]
    return rf"\begin{{cases}} {curves[0]} & v > 0 \\ {curves[-1]} & v < 0 \end{{cases}}"


def _force(c: Composition, side: int | None = None) -> str:
    held = [] if c.memory is None else [f"{_placed(c, c.memory, c.memory.part.tex)} N"]
    signs = [leaf.sign.part.tex if leaf.sign else None for leaf in c.outside]
    for smooth in dict.fromkeys(signs):
        own = [leaf for leaf, sign in zip(c.outside, signs, strict=True) if sign == smooth]
        levels = _levels(c, own, side)
        text = levels[0] if len(levels) == 1 else rf"\left[{' + '.join(levels)}\right]"
        sign = (
            SGN
            if smooth is None
            else next(_placed(c, leaf.sign, smooth) for leaf in own if leaf.sign)
        )
        held += [f"{text} N {sign}"] if levels else []
    flows = [_term(c, leaf, side) for leaf in c.outside if isinstance(leaf.part, Flow)]
    return " + ".join([*held, *flows])


def _term(c: Composition, leaf: Leaf, side: int | None, tex: str = "") -> str:
    """Return the LaTeX of a part, or another one in its place, with its factors."""
    placed = _placed(c, leaf, tex or leaf.part.tex, side)
    factors = [_placed(c, factor, factor.part.tex, side) for factor in leaf.factors]
    if factors and " + " in placed and not placed.startswith(BRACKETS):
        placed = rf"\left({placed}\right)"
    return r" \, ".join([placed, *factors])


BRACKETS = ("(", "|", r"\left", r"\frac")


def _levels(c: Composition, leaves: Iterable[Leaf], side: int | None = None) -> list[str]:
    return [
        _term(c, leaf, side)
        for leaf in leaves
        if isinstance(leaf.part, (Level, Extra, SmoothLevel)) and leaf.part.tex
    ]


def _rest(c: Composition) -> Sequence[str]:
    """Return what holds at rest, where that is one level."""
    chain = [
        (leaf, leaf.part.rest)
        for leaf in c.outside
        if isinstance(leaf.part, Level) and leaf.sign is None
    ]
    if c.memory is not None or not chain:
        return []
    symbols = [_placed(c, leaf, _tex(STANDARD[rest])) for leaf, rest in chain]
    if any(leaf.factors for leaf, _ in chain):
        steps = (f"({name} - {before})" for before, name in itertools.pairwise(symbols))
        levels = zip((leaf for leaf, _ in chain), (symbols[0], *steps), strict=True)
        terms = [_term(c, leaf, None, tex) for leaf, tex in levels]
    else:
        terms = [symbols[-1]]
    extras = [leaf for leaf in c.outside if isinstance(leaf.part, Extra) and leaf.part.holds]
    terms += [_term(c, leaf, None, leaf.part.tex.replace(FADED, "")) for leaf in extras]
    whole = terms[0] if len(terms) == 1 else rf"\left[{' + '.join(terms)}\right]"
    text = rf"|F| \le {whole} N \text{{ at rest}}"
    return (
        [text, rf"{symbols[-1]} \ge {symbols[-2]}"] if chain[-1][0].part.name == "peak" else [text]
    )


FADED = " e^{-|v/v_s|^n}"
"""What parts fade with, which is 1 at rest."""


def _placed(c: Composition, leaf: Leaf, tex: str, side: int | None = None) -> str:
    """Return a part's LaTeX with the symbols and the argument that it has in this law."""
    of_input = leaf.part.argument == "input"
    x = CONTACT_INPUTS[leaf.inputs[0]] if of_input else None
    number = str(getattr(leaf.part, "degree", c.argument))
    text = tex.replace("{0}", x.tex if x else number).replace("{1}", x.index if x else "")
    own = {
        parameter.name: parameter.quantity.symbol.replace("{0}", x.index if x else "")
        for parameter in leaf.part.parameters
    }
    for name in {*own, *leaf.names, *leaf.modulated}:
        field = leaf.names.get(name, name)
        chosen = field if isinstance(field, str) else field[side or 0]
        given = c.fields.get(chosen)
        standard = own.get(name, STANDARD.get(name))
        factors = [_placed(c, leaf, leaf.part.tex, side) for leaf in leaf.modulated.get(name, ())]
        renamed = given is not None and given.quantity.symbol != standard
        if given is not None and standard is not None and (renamed or factors):
            before, after = _tex(standard), _tex(given.quantity.symbol)
            after = rf"({' '.join([after, *factors])})" if factors else after
            # Whole symbols only: not within another word, nor where an index goes on.
            there = rf"(\^)?(?<![A-Za-z\\]){re.escape(before)}(?![A-Za-z_])"
            text = re.sub(there, functools.partial(_raised, after), text)
    return text


STANDARD = {
    "kinetic_coefficient": "mu_k",
    "static_coefficient": "mu_s",
    "break_away_coefficient": "mu_b",
    "stribeck_velocity": "v_s",
    "fading_exponent": "n",
}
"""Symbols of parameters that parts take from each other."""


def _raised(symbol: str, match: re.Match[str]) -> str:
    return f"^{{{symbol}}}" if match[1] else symbol


def _tex(symbol: str) -> str:
    r"""Return a plain-text symbol in LaTeX.

    Examples
    --------
    >>> _tex("mu_k"), _tex("sigma_+"), _tex("v_s")
    ('\\mu_k', '\\sigma_+', 'v_s')
    """
    stem, underscore, index = symbol.partition("_")
    head = rf"\{stem}" if stem in GREEK else stem
    return f"{head}_{{{index}}}" if len(index) > 1 else head + underscore + index
