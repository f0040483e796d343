"""Which laws a record is compared with."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import (
    Coulomb,
    CoulombViscous,
    Dahl,
    DirectionDependent,
    FrictionLaw,
    LuGre,
    PowerViscous,
    QuadraticDrag,
    Stribeck,
    Viscous,
    contained_laws,
    containment_of,
)
from stickslip.friction import laws as known_laws

__all__ = [
    "CONTROL",
    "REFERENCE",
    "CandidateSpec",
    "check_apart",
    "contains",
    "specifications",
]

REFERENCE = "coulomb-viscous"
"""What is always used: the row that others are compared with."""
CONTROL = "no-friction"
"""What shows how much friction matters at all."""


@final
@dataclass(frozen=True, kw_only=True)
class CandidateSpec:
    """A candidate: a law, and which of its parameters are looked for."""

    name: str
    """Key of the candidate."""
    title: str
    """Name in running text."""
    law: FrictionLaw | type[FrictionLaw]
    """Its type, or an instance whose values are the start."""
    free: tuple[str, ...] | None = None
    """Fields that are looked for; all of `fit_order` if None."""


LAWS: tuple[type[FrictionLaw], ...] = (
    Viscous,
    Coulomb,
    CoulombViscous,
    DirectionDependent,
    PowerViscous,
    QuadraticDrag,
    Stribeck,
    LuGre,
)
PLAIN_DAHL = ("kinetic_coefficient", "bristle_stiffness", "viscous_coefficient")


def specifications(
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
) -> tuple[CandidateSpec, ...]:
    """Return the candidates: those given, or all that records are compared with by default.

    A name stands for the candidate of that name, or for a law with all it can fit.

    Raises
    ------
    InputError
        If there is none, a name is not known, or two have one name.

    Examples
    --------
    >>> [one.name for one in specifications(None)][-3:]
    ['stribeck-exponent', 'dahl', 'dahl-exponent']
    >>> [one.title for one in specifications(["coulomb", "dahl-exponent"])]
    ['Coulomb', 'Dahl with exponent']
    """
    if laws is None:
        return _usual()
    if isinstance(laws, Mapping):
        found = [_given(name, law) for name, law in laws.items()]
    else:
        found = [_called(one) if isinstance(one, str) else _given(one.name, one) for one in laws]
    if not found:
        raise InputError("there is no friction law to try: give at least one in `laws`.")
    check_apart([one.name for one in found])
    return tuple(found)


def check_apart(names: Sequence[str]) -> None:
    """Refuse candidates of one name, of which results would tell only one.

    Raises
    ------
    InputError
        With what to give instead.

    Examples
    --------
    >>> check_apart(["coulomb", "viscous"])
    """
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise InputError(
            f"two of `laws` are called {twice[0]!r}: give a mapping with a name for each, such as"
            f' {{"{twice[0]}-a": ..., "{twice[0]}-b": ...}}.'
        )


def contains(rich: CandidateSpec, simple: CandidateSpec) -> bool:
    """Whether a candidate is another one for some values of what is looked for.

    Examples
    --------
    >>> by_name = {one.name: one for one in specifications(None)}
    >>> contains(by_name["dahl-exponent"], by_name["dahl"])
    True
    >>> contains(by_name["lugre"], by_name["dahl-exponent"])
    False
    """
    kinds = [one.law if isinstance(one.law, type) else type(one.law) for one in (rich, simple)]
    free, fewer = (
        set(kind.fit_order if one.free is None else one.free)
        for kind, one in zip(kinds, (rich, simple), strict=True)
    )
    if kinds[0] is kinds[1]:
        return fewer < free
    if kinds[1].name not in contained_laws(kinds[0]):
        return False
    first = containment_of(kinds[0], kinds[1].name)
    return first is None or not (set(first.where) & fewer)


def _usual() -> tuple[CandidateSpec, ...]:
    return (
        *(_given(law.name, law) for law in LAWS),
        CandidateSpec(
            name="stribeck-exponent",
            title="Stribeck with exponent",
            law=Stribeck,
            free=(*Stribeck.fit_order, "exponent"),
        ),
        CandidateSpec(name="dahl", title="Dahl", law=Dahl, free=PLAIN_DAHL),
        CandidateSpec(name="dahl-exponent", title="Dahl with exponent", law=Dahl),
    )


def _given(name: str, law: FrictionLaw | type[FrictionLaw]) -> CandidateSpec:
    return CandidateSpec(name=name, title=law.title, law=law)


def _called(name: str) -> CandidateSpec:
    known = {law: _given(law, kind) for law, kind in known_laws().items()}
    known |= {one.name: one for one in _usual()}
    if name not in known:
        raise UnknownNameError("friction law", name, known)
    return known[name]


def control() -> CandidateSpec:
    """Return the candidate without friction."""
    law = Coulomb(kinetic_coefficient=0.0)
    return CandidateSpec(name=CONTROL, title="No friction", law=law, free=())
