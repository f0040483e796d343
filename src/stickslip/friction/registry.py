"""The laws by name; installed packages add theirs under the entry point ``stickslip.friction``."""

import functools
from collections.abc import Iterator, Mapping
from types import MappingProxyType

from stickslip.friction.base import FrictionLaw
from stickslip.friction.coulomb import Coulomb
from stickslip.friction.coulomb_viscous import CoulombViscous
from stickslip.friction.coulomb_viscous_static import CoulombViscousStatic
from stickslip.friction.dahl import Dahl
from stickslip.friction.direction_dependent import DirectionDependent
from stickslip.friction.lugre import LuGre
from stickslip.friction.power_viscous import PowerViscous
from stickslip.friction.quadratic_drag import QuadraticDrag
from stickslip.friction.stribeck import Stribeck
from stickslip.friction.viscous import Viscous
from stickslip.quantities import gathered, named

__all__ = ["LAWS", "contained_laws", "law_type", "laws"]

LAWS: Mapping[str, type[FrictionLaw]] = MappingProxyType(
    {
        law.name: law
        for law in (
            Coulomb,
            Viscous,
            CoulombViscous,
            CoulombViscousStatic,
            DirectionDependent,
            PowerViscous,
            QuadraticDrag,
            Stribeck,
            Dahl,
            LuGre,
        )
    }
)
"""The laws that come with the package, by kebab-case name."""


@functools.cache
def laws() -> Mapping[str, type[FrictionLaw]]:
    """Return all laws by name: ours and those of installed packages.

    Examples
    --------
    >>> sorted(laws())[:2]
    ['coulomb', 'coulomb-viscous']
    """
    return gathered(LAWS, "stickslip.friction", FrictionLaw)  # type: ignore[type-abstract]  # a base


def law_type(name: str) -> type[FrictionLaw]:
    """Return the law of that name, or say which known names are nearest.

    Examples
    --------
    >>> law_type("lugre").title
    'LuGre'
    """
    law: type[FrictionLaw] = named(laws(), name, "friction law")
    return law


def contained_laws(kind: type[FrictionLaw]) -> tuple[str, ...]:
    """Return the registry names of all laws that a type of law contains, the nearest first.

    Examples
    --------
    >>> from stickslip import LuGre
    >>> contained_laws(LuGre)
    ('dahl', 'stribeck', 'coulomb-viscous', 'coulomb', 'viscous')
    """
    return tuple(dict.fromkeys(_walk(kind)))


def _walk(kind: type[FrictionLaw]) -> Iterator[str]:
    known, level = laws(), [kind]
    while level:
        names = [one.law for law in level for one in law.contained if one.law in known]
        yield from names
        level = [known[name] for name in dict.fromkeys(names)]
