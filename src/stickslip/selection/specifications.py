"""Which laws a record is compared with."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

from stickslip.errors import InputError
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
)

__all__ = ["CONTROL", "REFERENCE", "Specification", "specifications"]

REFERENCE = "coulomb-viscous"
"""What is always used: the row that others are compared with."""
CONTROL = "no-friction"
"""What shows how much friction matters at all."""


@final
@dataclass(frozen=True, kw_only=True)
class Specification:
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
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw]] | None,
) -> tuple[Specification, ...]:
    """Return the candidates: those given, or all that records are compared with by default.

    Raises
    ------
    InputError
        If there is none.

    Examples
    --------
    >>> [one.name for one in specifications(None)][-3:]
    ['lugre', 'dahl', 'dahl-exponent']
    """
    if laws is None:
        return (
            *(Specification(name=law.name, title=law.title, law=law) for law in LAWS),
            Specification(name="dahl", title="Dahl", law=Dahl, free=PLAIN_DAHL),
            Specification(name="dahl-exponent", title="Dahl with exponent", law=Dahl),
        )
    chosen = laws.items() if isinstance(laws, Mapping) else [(law.name, law) for law in laws]
    found = tuple(Specification(name=name, title=law.title, law=law) for name, law in chosen)
    if not found:
        raise InputError("there is no friction law to try: give at least one in `laws`.")
    return found


def control() -> Specification:
    """Return the candidate without friction."""
    law = Coulomb(kinetic_coefficient=0.0)
    return Specification(name=CONTROL, title="No friction", law=law, free=())
