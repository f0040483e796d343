"""Classes of laws that are made of compositions, with a name or without."""

import abc
import dataclasses
import functools
import inspect
from collections.abc import Callable, Mapping
from typing import TypeVar, final

from stickslip.friction.base import BristleLaw, FrictionLaw, SetValuedLaw
from stickslip.friction.composition import Composition
from stickslip.friction.containment import Contained
from stickslip.friction.equations import equations_of, one_way
from stickslip.friction.formulas import formula_of
from stickslip.friction.notation import Term, canonical, read
from stickslip.friction.parts.base import Parameter
from stickslip.friction.text import for_floats

__all__ = ["HOME", "class_of", "composed"]

K = TypeVar("K", bound=FrictionLaw)
KNOWN: dict[str, type[FrictionLaw]] = {}
"""Laws that have a name by their canonical composition; of equal ones the first."""
HOME = "stickslip.friction.registry"
"""Module in which pickle looks for classes without a name."""


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
        equations = equations_of(composition, lambda: class_of(one_way(composition.term)))
        for name, equation in equations.items():
            if name not in vars(kind):
                setattr(kind, name, equation)
        kind.composition, kind.made_of = composition.term, composition
        kind.directional = composition.directional
        kind.contained = Contained(composition, KNOWN)  # type: ignore[assignment]  # a descriptor
        if "formula" not in vars(kind):
            kind.formula = formula_of(composition)
        abc.update_abstractmethods(kind)
        made = final(dataclasses.dataclass(frozen=True, kw_only=True)(kind))
        for name, arguments in FLOATS.items():
            if name in equations and (composition.memory is not None or not made.directional):
                setattr(made, name, for_floats(made, name, equations[name], arguments))
        if made.__module__ != HOME:
            KNOWN.setdefault(canonical(composition.term), made)
        return made

    return of


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
    c = Composition(read(text), {})
    named = KNOWN.get(canonical(c.term))
    if named is not None:
        return named
    base = BristleLaw if c.memory is not None else FrictionLaw if c.directional else SetValuedLaw
    space = {
        "__module__": HOME,
        "__qualname__": text,
        "__doc__": f"The composition {text}.",
        "name": text,
        "title": text,
        "sources": (),
        "on_request": True,
    }
    return composed(text)(type(text, (base,), space))
