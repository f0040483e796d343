"""The notation of laws: ``dahl(both_ways[levels](level + stribeck)) + power``, read and written.

A text is a sum of products of names, with arguments in square brackets and terms in round ones:

    sum      =  product { "+" product }
    product  =  one { "*" one }
    one      =  "(" sum ")"  |  name [ "[" arguments "]" ] [ "(" sum ")" ]

1. The text is cut into names, arguments and marks, each with its place for messages (`TOKEN`).
2. `_Reader` reads them from left to right, a method for each line of the grammar (recursive
   descent). Sums within sums are one sum. Which part may stand where, such as a factor behind what
   it multiplies, terms check as they are put together, in Python as in texts.
3. `str` of a term is a text that reads as the same term; `canonical` is the same text for terms
   that differ in the order of sums and factors, or in that both directions of a sum are the sum of
   both directions of its terms.
"""

import dataclasses
import re
from abc import ABC
from collections.abc import Iterator
from dataclasses import dataclass, replace

from stickslip.errors import InputError, UnknownNameError, nearest
from stickslip.friction.parts import PARTS
from stickslip.friction.parts.base import Level, Memory, Parameter, Part
from stickslip.friction.parts.levels import Surplus, curve_text
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS, checked_inputs
from stickslip.quantities import Quantity
from stickslip.show.described import with_marks

OPTIONAL = ("step", "peak")
"""Parts that a law of a name may lack: without values for them, it is the law that lacks them."""
BOTH_WAYS = "both_ways"
"""What stands around terms that have parameters of their own for each direction."""
PER_DIRECTION = ("level", "slope")
"""Scales of parameters that ``both_ways[levels]`` doubles."""


class Directions(Part):
    """What stands for `BOTH_WAYS` among the parts: it has no parameters, and no equation."""

    name = role = BOTH_WAYS
    argument = "levels"


DIRECTIONS = Directions()


class Term(ABC):  # noqa: B024  # what is asked of all of them is here
    """A part, or a sum or something around it; `str` writes what `read` reads.

    Terms are added, called and given arguments as their text says: ``maxwell[4](level) + viscous``.
    """

    def __add__(self, other: "Term") -> "Term":
        return summed((*terms_of(self), *terms_of(_term(other))))

    def __mul__(self, other: "Term") -> "Term":
        factor = _term(other)
        if isinstance(self, Name) and self.role == "factor":
            raise InputError(
                f"a factor stands behind what it multiplies: write {_bracketed(factor)} * {self}."
            )
        if not (isinstance(factor, Name) and factor.role == "factor"):
            raise InputError(
                f"behind * stands a factor, not {factor}: one of {', '.join(FACTORS)}, with what it"
                " depends on in brackets, such as viscous * exponential[temperature]."
            )
        if isinstance(self, Product):
            return Product(self.first, (*self.factors, factor))
        return Product(self, (factor,))

    def parts(self) -> Iterator["Name"]:
        """Yield the names of all parts in it, from left to right."""
        match self:
            case Name():
                yield self
            case Product(first=first, factors=factors):
                yield from first.parts()
                yield from factors
            case Sum(items=items):
                for item in items:
                    yield from item.parts()
            case Around(head=head, inner=inner):
                yield head
                yield from inner.parts()

    @property
    def title(self) -> str:
        """What a law without a name is called in running text."""
        title = _title(self)
        parts = [part.part for part in self.parts() if part.name != BOTH_WAYS]
        if any(isinstance(piece, Surplus) for piece in parts) and all(
            isinstance(piece, Level) for piece in parts
        ):  # Stribeck is a law with a viscous part
            title = f"{title} without viscous part"
        return title[:1].upper() + title[1:]

    def __repr__(self) -> str:
        return str(self)


@dataclass(frozen=True, repr=False)
class Name(Term):
    """A part by its name, with what stands in brackets behind it."""

    name: str
    argument: str = ""

    def __post_init__(self) -> None:
        if self.name != BOTH_WAYS and self.name not in PARTS:
            raise UnknownNameError("part of a friction law", self.name, (*PARTS, BOTH_WAYS))
        if self.name != BOTH_WAYS and PARTS[self.name].argument == "curve":
            if not self.argument:
                raise InputError(
                    f'{self.name} does not say which curve: write {self.name}["curve.csv"], a file'
                    f" of speeds and levels, or its points, {self.name}[0: 2, 0.01: 1.8]."
                )
            object.__setattr__(self, "argument", curve_text(self.argument))
        if self.argument and self.name == BOTH_WAYS and self.argument != "levels":
            close = nearest(self.argument, ["levels"])
            raise InputError(
                f"{self}: the brackets of both_ways hold nothing (all parameters differ between the"
                " directions) or levels (levels and viscous parts do)."
                + (f" Did you mean {BOTH_WAYS}[levels]?" if close else "")
            )
        holds = self.part.argument
        if self.argument and not holds:
            raise InputError(f"{self}: {self.name} has no argument: write {self.name}.")
        if holds == "number" and self.argument and not re.fullmatch(r"[1-9][0-9]?", self.argument):
            what = "number of elements" if self.role == "memory" else "highest power"
            raise InputError(f"{self}: the {what} must be a whole number from 1 to 99.")
        if holds == "input":
            self._check_input()

    def _check_input(self) -> None:
        """Check the contact input in the brackets, and that only a factor has more there."""
        if not self.argument:
            raise InputError(
                f"{self} does not say what it depends on: write {self.name}[temperature], or"
                f" another one of {', '.join(CONTACT_INPUTS)}."
            )
        checked_inputs([self.input])
        if self.role != "factor" and "," in self.argument:
            raise InputError(f"{self}: the brackets of {self.name} hold one contact input.")

    def __getitem__(self, argument: object) -> "Name":
        several = argument if isinstance(argument, tuple) else (argument,)
        return replace(self, argument=", ".join(map(str, several)))

    def __call__(self, inner: Term) -> "Around":
        """Return this around a term."""
        return Around(self, _term(inner))

    def __str__(self) -> str:
        return f"{self.name}[{self.argument}]" if self.argument else self.name

    @property
    def role(self) -> str:
        """Where it may stand."""
        return self.part.role

    @property
    def part(self) -> Part:
        """The part that is named."""
        return PARTS.get(self.name, DIRECTIONS).of(self.argument)

    @property
    def input(self) -> str:
        """The contact input in its brackets; empty where these hold something else."""
        return self.argument.partition(",")[0] if self.part.argument == "input" else ""

    @property
    def inputs(self) -> tuple[str, ...]:
        """The contact inputs that it asks for."""
        return self.part.inputs or ((self.input,) if self.input else ())

    @property
    def modulated(self) -> str:
        """The parameter that a factor multiplies; empty where it multiplies all before it."""
        return self.argument.partition(", ")[2] if self.input else ""

    def meaning(self, parameter: str, stem: str = "") -> str:
        """Return a parameter's name in laws, of a factor with the stem of what it multiplies."""
        return "_".join(filter(None, (stem, self.input, parameter)))

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters of the part, with symbols and units as the contact input has them."""
        if not self.input:
            return self.part.parameters
        over = CONTACT_INPUTS[self.input].over
        return tuple(
            dataclasses.replace(
                parameter,
                hint=with_marks(
                    parameter.hint, lambda mark: over(mark) if isinstance(mark, Quantity) else mark
                ),
            )
            for parameter in self.part.parameters
        )


@dataclass(frozen=True, repr=False)
class Product(Term):
    """Factors behind what they multiply."""

    first: Term
    factors: tuple[Name, ...]

    def __str__(self) -> str:
        return " * ".join((_bracketed(self.first), *map(str, self.factors)))

    def stem(self, factor: Name) -> str:
        """Return what parameters of a factor begin with: the part or the parameter it multiplies.

        Of several parts it is empty.
        """
        named = [part for part in self.first.parts() if part.role in MULTIPLIED]
        only = "_".join(filter(None, (named[0].name, named[0].input))) if len(named) == 1 else ""
        return factor.modulated or only


@dataclass(frozen=True, repr=False)
class Sum(Term):
    """Parts beside each other."""

    items: tuple[Term, ...]

    def __str__(self) -> str:
        return " + ".join(map(str, self.items))


@dataclass(frozen=True, repr=False)
class Around(Term):
    """A memory, a smooth sign or `BOTH_WAYS` around a term."""

    head: Name
    inner: Term

    def __str__(self) -> str:
        return f"{self.head}({self.inner})"


FACTORS = tuple(name for name, part in PARTS.items() if part.role == "factor")
MULTIPLIED = ("level", "smooth level", "flow")
"""Roles of parts that factors multiply."""


def _bracketed(term: Term) -> str:
    return f"({term})" if isinstance(term, Sum) else str(term)


def _term(other: object) -> Term:
    if not isinstance(other, Term):
        raise InputError(f"{other!r} is no part of a friction law: parts are {', '.join(PARTS)}.")
    return other


def terms_of(term: Term) -> tuple[Term, ...]:
    """Return the terms of a sum; the term itself if it is none."""
    return term.items if isinstance(term, Sum) else (term,)


def summed(items: tuple[Term, ...]) -> Term:
    """Return the sum of terms; a single one is itself."""
    return items[0] if len(items) == 1 else Sum(items)


def _title(term: Term) -> str:
    """Return the parts by their names; what differs by direction stands first if not all does.

    Examples
    --------
    >>> _title(read("both_ways[levels](level + stribeck) + power"))
    'Stribeck by direction + power of speed'
    >>> _title(read("dahl(both_ways[levels](level + stribeck)) + both_ways[levels](power)"))
    'Dahl + Stribeck + power of speed by direction'
    >>> _title(read("lugre(level + stribeck) + viscous * exponential[temperature]"))
    'LuGre + viscous by temperature'
    """
    parts = list(_titles(term))
    both = " + ".join(title for title, directional in parts if directional)
    return " + ".join(
        ([f"{both} by direction"] if both else [])
        + [title for title, directional in parts if not directional]
    )


def _titles(term: Term) -> Iterator[tuple[str, bool]]:
    """Yield the names of parts, and whether they differ by direction."""
    match term:
        case Name():
            title = term.part.title or term.name
            yield (f"{term.input} {title}" if term.input else title), False
        case Sum(items=items):
            falls = any(isinstance(item, Name) and isinstance(item.part, Surplus) for item in items)
            for item in items:
                if not (falls and item == Name("level")):
                    yield from _titles(item)
        case Product(first=first, factors=factors):
            inputs = dict.fromkeys(factor.input for factor in factors)
            yield f"{_title(first)} by {' and '.join(inputs)}", False
        case Around(head=head, inner=inner):
            within = list(_titles(inner))
            if head.name == BOTH_WAYS:
                yield from ((title, True) for title, _ in within)
            elif not isinstance(head.part, Memory):
                yield f"{_title(inner)} by {head.part.title or head.name}", False
            else:
                yield head.part.title, all(both for _, both in within)
                if [title for title, _ in within] != [t for t, _ in _titles(read(head.part.usual))]:
                    yield from within


def canonical(term: Term) -> str:
    """Return a text that is the same for compositions that differ in the order of their sums.

    Both directions of a sum are the sum of both directions of its terms.
    """
    return " + ".join(sorted(_canonical(term)))


def _canonical(term: Term) -> Iterator[str]:
    match term:
        case Sum(items=items):
            for item in items:
                yield from _canonical(item)
        case Around(head=Name(name="both_ways") as head, inner=inner):
            for entry in terms_of(inner):
                # Where all parameters scale with levels, both_ways and both_ways[levels] are the
                # same.
                scales = {p.quantity.scale for name in entry.parts() for p in name.part.parameters}
                whole = Name(BOTH_WAYS) if scales <= {*PER_DIRECTION} else head
                yield from (f"{whole}({text})" for text in _canonical(entry))
        case Around(head=head, inner=inner):
            yield f"{head}({canonical(inner)})"
        case Product(first=first, factors=factors):
            text = canonical(first)
            yield " * ".join((f"({text})" if "+" in text else text, *sorted(map(str, factors))))
        case _:
            yield str(term)


def without_optional(term: Term) -> Term:
    """Return a sum without the parts that it may lack.

    Examples
    --------
    >>> without_optional(read("level + stribeck + viscous + peak"))
    level + stribeck + viscous
    """
    return summed(tuple(item for item in terms_of(term) if str(item) not in OPTIONAL))


TOKEN = re.compile(
    r"\s*(?:(?P<name>[A-Za-z_][\w-]*)|(?P<argument>\[[^\]]*\])|(?P<mark>[()+*])|(?P<other>\S))"
)

MOST_CHARACTERS, MOST_BRACKETS = 2_000, 20
"""Characters and brackets of a law: one with all parts and a curve of measured levels has fewer."""


def read(text: str) -> Term:
    """Return the term that a text stands for.

    Examples
    --------
    >>> read("lugre(level+stribeck)+power")
    lugre(level + stribeck) + power
    """
    # Before anything is read: the reader calls itself for each bracket.
    if len(text) > MOST_CHARACTERS or text.count("(") > MOST_BRACKETS:
        raise InputError(
            f"the friction law {text[:40]!r}... cannot be read: a law has at most {MOST_CHARACTERS}"
            f" characters and {MOST_BRACKETS} brackets, got {len(text)} and {text.count('(')}."
        )
    return _Reader(text).whole()


class _Reader:
    """Reads a text from left to right: sums of names with arguments and brackets."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = [
            (match.lastgroup, match[match.lastgroup or 0], match.start(match.lastgroup or 0))
            for match in TOKEN.finditer(text)
        ]
        self.at = 0

    def whole(self) -> Term:
        """Return the term of the whole text."""
        result = self.sum()
        if self.at < len(self.tokens):
            self.refuse("'+' or '*'")
        return result

    def sum(self) -> Term:
        items = [*terms_of(self.product())]
        while self.took("+"):
            items += terms_of(self.product())
        return summed(tuple(items))

    def product(self) -> Term:
        result = self.one()
        place = self.here()[2]
        while self.took("*"):
            factor = self.one()
            try:
                result = result * factor
            except InputError as error:
                raise InputError(
                    f"the friction law {self.text!r} cannot be read at character {place + 1}:"
                    f" {error}"
                ) from None
            place = self.here()[2]
        return result

    def one(self) -> Term:
        if self.took("("):
            return self.closed()
        kind, word, place = self.here()
        if kind != "name":
            self.refuse("the name of a part")
        self.at += 1
        kind, argument, _ = self.here()
        self.at += kind == "argument"
        given = argument[1:-1].split(",") if kind == "argument" else ()
        if argument[1:2] in ("'", '"'):
            given = [argument[1:-1]]  # the name of a file
        try:
            name = Name(word.replace("-", "_"), ", ".join(text.strip() for text in given))
        except UnknownNameError as error:
            of = error.kind.partition(" of ")[0]
            raise UnknownNameError(
                f"{of} at character {place + 1} of the friction law {self.text!r}:",
                word if of == "part" else error.name,
                error.known,
            ) from None
        return name(self.closed()) if self.took("(") else name

    def closed(self) -> Term:
        result = self.sum()
        if not self.took(")"):
            self.refuse("')'")
        return result

    def here(self) -> tuple[str | None, str, int]:
        return self.tokens[self.at] if self.at < len(self.tokens) else (None, "", len(self.text))

    def took(self, mark: str) -> bool:
        """Whether a mark stands here, which is then passed."""
        stands = self.here()[:2] == ("mark", mark)
        self.at += stands
        return stands

    def refuse(self, wanted: str) -> None:
        _, word, place = self.here()
        raise InputError(
            f"the friction law {self.text!r} cannot be read: expected {wanted} at character"
            f" {place + 1}, got {repr(word) if word else 'the end'}."
        )
