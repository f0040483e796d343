"""The notation of laws: ``dahl(both_ways[levels](level + stribeck)) + power``, read and written."""

import re
from abc import ABC
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import final

from typing_extensions import override

from stickslip.errors import InputError, UnknownNameError
from stickslip.friction.parts import PARTS
from stickslip.friction.parts.base import Part

__all__ = [
    "BOTH_WAYS",
    "OPTIONAL",
    "PER_DIRECTION",
    "Around",
    "Name",
    "Sum",
    "Term",
    "canonical",
    "read",
    "summed",
    "terms_of",
]

OPTIONAL = ("step", "peak")
"""Parts that laws of one name may have or not."""
BOTH_WAYS = "both_ways"
"""What stands around terms that have parameters of their own for each direction."""
PER_DIRECTION = ("level", "slope")
"""Scales of parameters that ``both_ways[levels]`` doubles."""


class Term(ABC):  # noqa: B024  # what is asked of all of them is here
    """A part, or a sum or something around it; `str` writes what `read` reads.

    Terms are added, called and given arguments as their text says: ``maxwell[4](level) + viscous``.
    """

    def __add__(self, other: "Term") -> "Term":
        return summed((*terms_of(self), *terms_of(_term(other))))

    def parts(self) -> Iterator["Name"]:
        """Yield the names of all parts in it, from left to right."""
        match self:
            case Name():
                yield self
            case Sum(items=items):
                for item in items:
                    yield from item.parts()
            case Around(head=head, inner=inner):
                yield head
                yield from inner.parts()

    @override
    def __repr__(self) -> str:
        return str(self)


@final
@dataclass(frozen=True, repr=False)
class Name(Term):
    """A part by its name, with what stands in brackets behind it."""

    name: str
    argument: str = ""

    def __post_init__(self) -> None:
        if self.name != BOTH_WAYS and self.name not in PARTS:
            raise UnknownNameError("part of a friction law", self.name, (*PARTS, BOTH_WAYS))
        if self.argument and self.name == BOTH_WAYS and self.argument != "levels":
            raise InputError(
                f"{self}: the brackets of both_ways hold nothing (all parameters differ between the"
                " directions) or levels (levels and viscous parts do)."
            )
        holds = "levels" if self.name == BOTH_WAYS else self.part.argument
        if self.argument and not holds:
            raise InputError(f"{self}: {self.name} has no argument: write {self.name}.")
        if holds == "number" and self.argument and not re.fullmatch(r"[1-9][0-9]?", self.argument):
            raise InputError(f"{self}: the number of elements must be 1 to 99.")

    def __getitem__(self, argument: object) -> "Name":
        return replace(self, argument=str(argument))

    def __call__(self, inner: Term) -> "Around":
        """Return this around a term."""
        return Around(self, _term(inner))

    @override
    def __str__(self) -> str:
        return f"{self.name}[{self.argument}]" if self.argument else self.name

    @property
    def role(self) -> str:
        """Where it may stand."""
        return BOTH_WAYS if self.name == BOTH_WAYS else self.part.role

    @property
    def part(self) -> Part:
        """The part that is named."""
        return PARTS[self.name]


@final
@dataclass(frozen=True, repr=False)
class Sum(Term):
    """Parts beside each other."""

    items: tuple[Term, ...]

    @override
    def __str__(self) -> str:
        return " + ".join(map(str, self.items))


@final
@dataclass(frozen=True, repr=False)
class Around(Term):
    """A memory, a smooth sign or `BOTH_WAYS` around a term."""

    head: Name
    inner: Term

    @override
    def __str__(self) -> str:
        return f"{self.head}({self.inner})"


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


def canonical(term: Term) -> str:
    """Return a text that is the same for compositions that differ in the order of their sums.

    Both directions of a sum are the sum of both directions of its terms.
    """
    return " + ".join(sorted(_canonical(term)))


def _canonical(term: Term) -> Iterator[str]:
    match term:
        case Sum(items=items):
            for one in items:
                yield from _canonical(one)
        case Around(head=Name(name="both_ways") as head, inner=inner):
            for one in terms_of(inner):
                scales = {p.quantity.scale for name in one.parts() for p in name.part.parameters}
                whole = Name(BOTH_WAYS) if scales <= {*PER_DIRECTION} else head
                yield from (f"{whole}({text})" for text in _canonical(one))
        case Around(head=head, inner=inner):
            yield f"{head}({canonical(inner)})"
        case _ if str(term) not in OPTIONAL:
            yield str(term)


TOKEN = re.compile(
    r"\s*(?:(?P<name>[A-Za-z_][\w-]*)|(?P<argument>\[[^\]]*\])|(?P<mark>[()+])|(?P<other>\S))"
)

LONGEST, DEEPEST = 500, 20
"""Characters and brackets of a law: one with all parts in it has fewer."""


def read(text: str) -> Term:
    """Return the term that a text stands for.

    Raises
    ------
    InputError
        If it cannot be read; the message names the place.
    UnknownNameError
        If it names a part that does not exist.

    Examples
    --------
    >>> read("lugre(level+stribeck)+power")
    lugre(level + stribeck) + power
    """
    if len(text) > LONGEST or text.count("(") > DEEPEST:
        raise InputError(
            f"the friction law {text[:40]!r}... cannot be read: a law has at most {LONGEST}"
            f" characters and {DEEPEST} brackets, got {len(text)} and {text.count('(')}."
        )
    return _Reader(text).whole()


class _Reader:
    """Reads a text from left to right: sums of names with arguments and brackets."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = [
            (found.lastgroup, found[found.lastgroup or 0], found.start(found.lastgroup or 0))
            for found in TOKEN.finditer(text)
        ]
        self.at = 0

    def whole(self) -> Term:
        """Return the term of the whole text."""
        found = self.sum()
        if self.at < len(self.tokens):
            self.refuse("'+'")
        return found

    def sum(self) -> Term:
        items = [*terms_of(self.one())]
        while self.took("+"):
            items += terms_of(self.one())
        return summed(tuple(items))

    def one(self) -> Term:
        if self.took("("):
            return self.closed()
        kind, word, place = self.here()
        if kind != "name":
            self.refuse("the name of a part")
        self.at += 1
        kind, argument, _ = self.here()
        self.at += kind == "argument"
        try:
            name = Name(
                word.replace("-", "_"), argument[1:-1].strip() if kind == "argument" else ""
            )
        except UnknownNameError as error:
            raise UnknownNameError(
                f"part at character {place + 1} of the friction law {self.text!r}:",
                word,
                error.known,
            ) from None
        return name(self.closed()) if self.took("(") else name

    def closed(self) -> Term:
        found = self.sum()
        if not self.took(")"):
            self.refuse("')'")
        return found

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
