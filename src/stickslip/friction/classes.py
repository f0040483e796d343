"""Classes of laws that are made of compositions, with a name or without."""

import abc
import dataclasses
import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, cast, final

from stickslip.errors import InputError, nearest
from stickslip.friction.base import ALWAYS, BristleLaw, FrictionLaw, SetValuedLaw
from stickslip.friction.composition import Composition
from stickslip.friction.containment import Contained
from stickslip.friction.equations import equations_of, for_floats, one_way
from stickslip.friction.formulas import formula_of
from stickslip.friction.notation import Term, canonical, read
from stickslip.friction.parts.base import Memory, Parameter
from stickslip.friction.sources import SOURCES

HOME = "stickslip.friction.registry"
"""Module in which pickle looks for classes without a name."""
PUBLIC = "stickslip.friction"
"""Where it looks for those with one."""


@final
@dataclasses.dataclass(frozen=True, kw_only=True)
class Entry:
    """A law of the catalogue: what is said of it, and its class, which is made when asked for."""

    composition: str
    """Its parts, as they are written in the entry."""
    names: Mapping[str, str]
    """Fields by the names that parts have for them, where these differ."""
    statement: type
    """The class statement, which says what the law is called and where it comes from."""

    def __getattr__(self, name: str) -> Any:
        """Return what the entry says; what it leaves out is as in all laws."""
        if name.startswith("_") or name == "statement":
            raise AttributeError(name)
        return getattr(self.statement if hasattr(self.statement, name) else FrictionLaw, name)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states of the contact."""
        heads = (one for one in read(self.composition).parts() if one.role == "memory")
        return tuple(
            state for one in heads for state in cast(Memory, one.part).states(one.argument)
        )

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of what it asks of the contact."""
        names = read(self.composition).parts()
        return tuple(dict.fromkeys(one for name in names for one in name.inputs))

    @property
    def on_request(self) -> bool:
        """Whether it is tried on travels only where it is named, as unless the entry says not."""
        return getattr(self.statement, "on_request", True)

    @property
    def compared(self) -> bool:
        """Whether the formula was compared with its source: that of the law, and of its parts."""
        own = getattr(self.statement, "compared", True)
        return own and all(one.part.compared for one in read(self.composition).parts())

    @functools.cached_property
    def law(self) -> type[FrictionLaw]:
        """The class of the law."""
        said = {k: v for k, v in vars(self.statement).items() if k not in MACHINERY}
        space = {**said, "__module__": PUBLIC}
        c = Composition(read(self.composition), self.names)
        made = _made(c, self.statement.__name__, space)
        made.__doc__ = self._documented(made)
        return made

    def _documented(self, law: type[FrictionLaw]) -> str:
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


MACHINERY = ("__dict__", "__weakref__", "__abstractmethods__", "_abc_impl")
"""Attributes of classes that belong to one class alone."""
CATALOGUE: dict[str, Entry] = {}
"""Entries by the name of their law, in the order in which they are listed."""


def composed(text: str, *, names: Mapping[str, str] | None = None) -> Callable[[type], Entry]:
    """Return what makes a class statement an entry of the catalogue.

    The statement says what the law is called and where it comes from. It may give parameters a
    default, or another quantity, as a dataclass does. Fields and equations are those of the parts.
    """

    def entered(statement: type) -> Entry:
        entry = Entry(composition=text, names=names or {}, statement=statement)
        return CATALOGUE.setdefault(entry.name, entry)

    return entered


@functools.cache
def _by_parts() -> Mapping[str, Entry]:
    """Return the entries by their canonical composition; of equal ones the first."""
    found: dict[str, Entry] = {}
    for entry in CATALOGUE.values():
        found.setdefault(canonical(read(entry.composition)), entry)
    return MappingProxyType(found)


def _made(c: Composition, name: str, space: Mapping[str, Any]) -> type[FrictionLaw]:
    """Return the class of a composition, with what is said of it."""
    without: Any = FrictionLaw if c.directional else SetValuedLaw
    base: Any = BristleLaw if c.memory is not None else without
    kind: Any = type(base)(name, (base,), dict(space))
    for field, hint in inspect.get_annotations(kind).items():
        c.fields[field] = Parameter(name=field, hint=hint, default=dataclasses.MISSING)
    fields = sorted(c.fields.values(), key=lambda one: one.quantity.structural)
    for one in fields:
        if one.default is not dataclasses.MISSING and one.name not in space:
            setattr(kind, one.name, one.default)
    kind.__annotations__ = {one.name: one.hint for one in fields}
    equations = equations_of(c, lambda: class_of(one_way(c.term)))
    for key, equation in equations.items():
        if key not in space:
            setattr(kind, key, equation)
    kind.composition, kind.made_of = c.term, c
    kind.directional, kind.inputs = c.directional, c.inputs
    kind.on_request = bool(space.get("on_request", True))
    kind.compared = kind.compared and all(one.part.compared for one in c.term.parts())
    kind.contained = Contained(c, _by_parts)
    if kind.passivity is None and all(one.part.opposes for one in c.term.parts()):
        kind.passivity = ALWAYS
    if "formula" not in space:
        kind.formula = formula_of(c)
    abc.update_abstractmethods(kind)
    made: Any = final(dataclasses.dataclass(frozen=True, kw_only=True)(kind))
    for key, arguments in FLOATS.items():
        if key in equations and (c.memory is not None or not made.directional):
            setattr(made, key, for_floats(made, key, equations[key], arguments))
    return made  # type: ignore[no-any-return]  # a class made by a call


FLOATS = {
    "sliding": ("speed", "load"),
    "force": ("velocity", "load", "states"),
    "rates": ("velocity", "load", "states"),
    "steady": ("velocity", "load"),
}
"""Equations that have a text of their own for floats, with their arguments."""


def class_of(term: Term) -> type[FrictionLaw]:
    """Return the class of a term: that with a name, or one that has its text as name."""
    return _by_text(str(term))


@functools.cache
def _by_text(text: str) -> type[FrictionLaw]:
    c = Composition(read(text), {})  # refuses what cannot stand together, optional parts included
    entry = _by_parts().get(canonical(c.term))
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
