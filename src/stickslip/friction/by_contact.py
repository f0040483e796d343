"""Laws of several contacts: one for each, or one that all share."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias, TypeVar, final

from stickslip.errors import InputError, UnknownNameError
from stickslip.friction.base import FrictionLaw
from stickslip.quantities import Group

T = TypeVar("T")


@final
@dataclass(frozen=True, kw_only=True)
class Laws(Group):
    """The laws of several contacts by the contacts' names.

    Paths of their parameters have the name of the contact, as in
    ``friction.elbow.kinetic_coefficient``.
    """

    members: tuple[tuple[str, FrictionLaw], ...]
    """Names of contacts, and their laws."""

    @property
    def name(self) -> str:
        """Names of the contacts with those of their laws."""
        return ", ".join(f"{contact}: {name}" for contact, name in self.names.items())

    @property
    def names(self) -> dict[str, str]:
        """Names of the laws by contact."""
        return {contact: law.name for contact, law in self.members}

    @property
    def title(self) -> str:
        """The contacts with their laws in running text."""
        return ", ".join(f"{contact}: {law.title}" for contact, law in self.members)


Friction: TypeAlias = FrictionLaw | Mapping[str, FrictionLaw | None] | Laws
"""One law for all contacts, or laws by the name of the contact; None where nothing rubs."""


def assigned(contacts: tuple[str, ...], law: Friction) -> FrictionLaw | Laws:
    """Return laws by contact, checked; or the one law that a single contact has, or all share.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> laws = assigned(
    ...     ("shoulder", "elbow"),
    ...     {"elbow": Coulomb(kinetic_coefficient=0.1), "shoulder": None},
    ... )
    >>> [name for name, _ in laws.members]
    ['elbow']
    """
    if isinstance(law, FrictionLaw):
        return law
    if isinstance(law, Laws):  # it names those that rub
        law = dict.fromkeys(contacts) | dict(law.members)
    if not isinstance(law, Mapping):
        raise InputError(
            "law must be a FrictionLaw, or a mapping from the names of contacts to laws, got"
            f" {law!r}."
        )
    known = given_to(contacts, law)
    for name, one in known.items():
        if one is not None and not isinstance(one, FrictionLaw):
            raise InputError(f"the law of the contact {name!r} must be a FrictionLaw, got {one!r}.")
    members = tuple((name, one) for name, one in known.items() if one is not None)
    return members[0][1] if len(contacts) == 1 else Laws(members=members)


def given_to(contacts: tuple[str, ...], laws: Mapping[str, T | None]) -> dict[str, T | None]:
    """Return what is given for each contact, in their order.

    Examples
    --------
    >>> given_to(("shoulder", "elbow"), {"elbow": "coulomb", "shoulder": None})
    {'shoulder': None, 'elbow': 'coulomb'}
    """
    for name in laws:
        if name not in contacts:
            raise UnknownNameError("contact", name, contacts)
    missing = [name for name in contacts if name not in laws]
    if missing:
        raise InputError(
            f"no law is given for the contact {missing[0]!r}: add {missing[0]!r}: None if nothing"
            " rubs there."
        )
    if all(laws[name] is None for name in contacts):
        raise InputError(
            "no contact has a law: give one of them a law, with levels of 0 if need be."
        )
    return {name: laws[name] for name in contacts}


def law_of(contact: str, law: FrictionLaw | Laws) -> FrictionLaw | None:
    """Return the law of a contact, None where nothing rubs."""
    return dict(law.members).get(contact) if isinstance(law, Laws) else law


def bristle_names(contacts: tuple[str, ...], law: FrictionLaw | Laws) -> tuple[str, ...]:
    """Return the names of the bristle states; with several contacts, ``z:elbow`` and its like.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> bristle_names(("left", "right"), Dahl(kinetic_coefficient=0.2, bristle_stiffness=1e4))
    ('z:left', 'z:right')
    """
    if len(contacts) == 1:
        own = law_of(contacts[0], law)
        return () if own is None else own.states
    laws = [(name, law_of(name, law)) for name in contacts]
    return tuple(f"{z}:{name}" for name, one in laws if one is not None for z in one.states)
