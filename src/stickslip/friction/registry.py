"""The laws by name; installed packages add theirs under the entry point ``stickslip.friction``."""

import functools
import re
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, dataclass, replace
from typing import Any

from stickslip.errors import InputError
from stickslip.friction import LAW_MODULES
from stickslip.friction import named as entries
from stickslip.friction.base import FrictionLaw
from stickslip.friction.classes import CATALOGUE, Entry, class_of
from stickslip.friction.notation import Term, read
from stickslip.friction.parts import PARTS
from stickslip.friction.rate_state import RATE_STATE_FORMS
from stickslip.quantities import gathered, named, own_classes

PLAIN_DAHL = ("kinetic_coefficient", "bristle_stiffness", "viscous_coefficient")
BELOW = ("viscous", "coulomb")
"""Laws below the lowest rung."""


class _Lazy(Mapping[str, type[FrictionLaw]]):
    """Classes of laws by name; that of a composition is made when it is asked for."""

    def __init__(self) -> None:
        own = {name: module for name, module in LAW_MODULES.items() if module != "registry"}
        kinds = own_classes("stickslip.friction", own, FrictionLaw)  # type: ignore[type-abstract]  # a base
        self._known: dict[str, Entry | type[FrictionLaw]] = dict(CATALOGUE)
        self._known |= {kind.name: kind for kind in kinds}

    def __getitem__(self, name: str) -> type[FrictionLaw]:
        result = self._known[name]
        return result.law if isinstance(result, Entry) else result

    def __contains__(self, name: object) -> bool:
        return name in self._known

    def __iter__(self) -> Iterator[str]:
        return iter(self._known)

    def __len__(self) -> int:
        return len(self._known)


LAWS: Mapping[str, type[FrictionLaw]] = _Lazy()
"""The laws that come with the package, by kebab-case name."""


@dataclass(frozen=True, kw_only=True)
class CandidateSpec:
    """A candidate for records: a law, and which of its parameters are looked for."""

    name: str
    """Key of the candidate."""
    title: str
    """Name in running text."""
    law: FrictionLaw | type[FrictionLaw]
    """Its type, or an instance whose values are the start."""
    free: tuple[str, ...] | None = None
    """Fields that are looked for; all of `fit_order` if None."""

    @classmethod
    def of(cls, name: str, law: FrictionLaw | type[FrictionLaw]) -> "CandidateSpec":
        """Return a law with all it can fit."""
        return cls(name=name, title=law.title, law=law)


@functools.cache
def laws() -> Mapping[str, type[FrictionLaw]]:
    """Return all laws by name: ours and those of installed packages.

    Examples
    --------
    >>> list(laws())[:2]
    ['coulomb', 'viscous']
    """
    return gathered(LAWS, "stickslip.friction", FrictionLaw)  # type: ignore[type-abstract]  # a base


def listed() -> Mapping[str, Entry | type[FrictionLaw]]:
    """Return what says of each law its title, sources and composition: entry, or class of its own.

    Examples
    --------
    >>> listed()["lugre"].title
    'LuGre'
    """
    known = laws()
    return {name: CATALOGUE[name] if name in CATALOGUE else known[name] for name in known}


def law_type(name: str) -> type[FrictionLaw]:
    """Return the law of that name, or say which known names are nearest.

    Examples
    --------
    >>> law_type("lugre").title
    'LuGre'
    """
    if is_composition(name):
        return law(name)
    for spec in special_specifications() if name not in laws() else ():
        if spec.name == name:
            raise InputError(
                f"{name} is available only for fits to records: {spec.law.name} with its exponent"
                f" fitted as well. Give {spec.law.name} here."
            )
    kind: type[FrictionLaw] = _law_named(laws(), name)
    return kind


def with_typical_values(given: FrictionLaw | type[FrictionLaw] | str) -> FrictionLaw | None:
    """Return a law; one that is given by type or name with its typical values, None if it has none.

    Examples
    --------
    >>> with_typical_values("coulomb")
    Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
    """
    if isinstance(given, FrictionLaw):
        return given
    kind = law_type(given) if isinstance(given, str) else given
    return None if kind.typical is None else kind(**kind.typical.values)


def special_specifications() -> tuple[CandidateSpec, ...]:
    """Return the candidates for records that are laws with other parameters free than usual.

    Examples
    --------
    >>> [one.name for one in special_specifications()]
    ['stribeck-exponent', 'dahl', 'dahl-power', 'dahl-exponent', 'lugre-power']
    """
    stribeck, dahl, lugre = (LAWS[name] for name in ("stribeck", "dahl", "lugre"))
    power = "viscous_exponent"
    return tuple(
        CandidateSpec(name=name, title=title, law=law, free=free)
        for name, title, law, free in (
            (
                "stribeck-exponent",
                "Stribeck with exponent",
                stribeck,
                (*stribeck.fit_order, "fading_exponent"),
            ),
            ("dahl", "Dahl", dahl, PLAIN_DAHL),
            ("dahl-power", "Dahl + power of speed", dahl, (*PLAIN_DAHL, power)),
            ("dahl-exponent", "Dahl with exponent", dahl, dahl.fit_order),
            ("lugre-power", "LuGre + power of speed", lugre, (*lugre.fit_order, power)),
        )
    )


def specification(name: str) -> CandidateSpec:
    """Return the candidate for records of that name: a special one, or a law with all it can fit.

    Examples
    --------
    >>> specification("dahl").free
    ('kinetic_coefficient', 'bristle_stiffness', 'viscous_coefficient')
    >>> specification("dahl-exponent").title
    'Dahl with exponent'
    >>> specification("dahl(level) + power").free
    ('kinetic_coefficient', 'bristle_stiffness', 'viscous_coefficient', 'viscous_exponent')
    """
    if is_composition(name):
        kind = law(name)
        written = tuple(
            field
            for field, item in kind.made_of.fields.items()
            if item.quantity.scale
            and not (item.quantity.structural and item.default is not MISSING)
        )
        # a law of that name may hold the exponent of a power that is written here
        same = {*written} == {*kind.fit_order}
        return replace(CandidateSpec.of(name, kind), free=None if same else written)
    special = {spec.name: spec for spec in special_specifications()}
    if name in special:
        return special[name]
    _law_named(dict.fromkeys((*laws(), *special)), name)  # refuses unknown names
    return CandidateSpec.of(name, laws()[name])


def law(composition: str | Term) -> type[FrictionLaw]:
    """Return the class of laws that a composition stands for; the same one each time.

    Examples
    --------
    >>> law("viscous + level").__name__
    'CoulombViscous'
    >>> Thinning = law("dahl(level + lorentz) + power")
    >>> Thinning.composition
    dahl(level + lorentz) + power
    >>> Thinning.title, Thinning.contained[0].law
    ('Dahl + Hess and Soom + power of speed', 'dahl')
    """
    if not isinstance(composition, str | Term):
        raise InputError(f"a composition must be a text or a sum of parts, got {composition!r}.")
    text = str(composition).strip()
    entry = CATALOGUE.get(text)
    if entry is None or text == entry.composition:
        return class_of(read(composition) if isinstance(composition, str) else composition)
    said = (
        f"The law named {text} is {entry.composition}: give that, or the class"
        f" stickslip.friction.{entry.statement.__name__}."
    )
    if text not in PARTS:
        raise InputError(said)
    try:
        class_of(read(text))
    except InputError as error:
        raise InputError(f"{error} {said}") from None
    raise InputError(f"{text!r} alone is a part. {said}")


def __getattr__(name: str) -> type[FrictionLaw]:
    entry = vars(entries).get(name)
    if isinstance(entry, Entry):
        return entry.law
    try:
        return law(name)
    except InputError:
        raise AttributeError(name) from None


def is_composition(name: str) -> bool:
    """Whether the name of a law is a composition: of several parts, or of one without a law's name.

    Examples
    --------
    >>> [is_composition(name) for name in ("level + viscous", "lorentz", "coulomb-viscous")]
    [True, True, False]
    """
    return bool(re.search(r"[+*(\[]", name)) or (name in PARTS and name not in laws())


def _law_named(known: Mapping[str, Any], name: str) -> Any:
    if name in RATE_STATE_FORMS and name not in known:
        raise InputError(
            f"{name} is a law for velocity steps, that is for a record with time, pull and friction"
            " but neither position nor velocity; it does not fit other records, nor can `simulate`"
            " run it."
        )
    return named(known, name, "friction law")


def contained_laws(kind: type[FrictionLaw]) -> tuple[str, ...]:
    """Return the registry names of all laws that a type of law contains, the nearest first.

    Examples
    --------
    >>> from stickslip import LuGre
    >>> contained_laws(LuGre)
    ('dahl', 'stribeck', 'coulomb-viscous', 'viscous', 'coulomb')
    """
    return tuple(dict.fromkeys(_walk(kind)))


def _walk(kind: type[FrictionLaw]) -> Iterator[str]:
    known, level = laws(), [kind]
    while level:
        names = [inner.law for law in level for inner in law.contained if inner.law in known]
        yield from names
        level = [known[name] for name in dict.fromkeys(names)]


@dataclass(frozen=True, kw_only=True)
class Rung:
    """Which parts a law has beside a level and a viscous part.

    Examples
    --------
    >>> Rung(both_ways=True, stribeck=True).composition
    'both_ways(level + stribeck + viscous)'
    >>> Rung(memory="dahl", both_ways=True, flow="power").composition
    'dahl(both_ways[levels](level)) + both_ways[levels](power)'
    """

    both_ways: bool = False
    """Whether the directions differ."""
    stribeck: bool = False
    """Whether a static surplus fades with the speed."""
    flow: str = "viscous"
    """``"viscous"``, ``"power"`` or ``"drag"``, which stands beside the viscous part."""
    memory: str = ""
    """``"dahl"`` or ``"lugre"``; empty without."""
    exponent: bool = False
    """Whether the exponent of what yields or fades is looked for."""

    @property
    def composition(self) -> str:
        """The law as a sum of parts."""
        levels = "level + stribeck" if self.stribeck else "level"
        flow = "viscous + drag" if self.flow == "drag" else self.flow
        around = "both_ways[levels]({})" if self.both_ways else "{}"
        if self.memory:
            return f"{self.memory}({around.format(levels)}) + {around.format(flow)}"
        whole = f"{levels} + {flow}"
        return f"both_ways({whole})" if self.both_ways else whole

    @property
    def specification(self) -> CandidateSpec:
        """The candidate: that of a name, or else that of the composition."""
        if self.exponent:
            return specification(f"{self.memory or 'stribeck'}-exponent")
        if self in SPECIAL:
            return specification(SPECIAL[self])
        own = law(self.composition)
        return CandidateSpec(name=own.name, title=own.title, law=own)

    def above(self) -> Iterator["Rung"]:
        """Yield what has one part more."""
        if self.exponent:
            return
        if not self.both_ways:
            yield replace(self, both_ways=True)
        if not self.stribeck:
            yield replace(self, stribeck=True)
        if self.flow == "viscous":
            yield replace(self, flow="power")
            if not self.memory:
                yield replace(self, flow="drag")
        if self in (Rung(stribeck=True), Rung(memory="dahl")):
            yield replace(self, exponent=True)
        if not self.memory and self.flow != "drag":
            yield replace(self, memory="dahl")
        if self.memory == "dahl" or (self.stribeck and not self.memory and self.flow != "drag"):
            yield replace(self, memory="lugre", stribeck=True)


SPECIAL = {
    Rung(memory="dahl"): "dahl",
    Rung(memory="dahl", flow="power"): "dahl-power",
    Rung(memory="lugre", stribeck=True): "lugre",
    Rung(memory="lugre", stribeck=True, flow="power"): "lugre-power",
}
"""Candidates of which exponents are held that their laws have."""


@functools.cache
def rungs() -> Mapping[str, Rung]:
    """Return all rungs by the name of their candidate, from the lowest upwards.

    Examples
    --------
    >>> list(rungs())[:4]
    ['coulomb-viscous', 'direction-dependent', 'stribeck', 'power-viscous']
    """
    result: dict[str, Rung] = {}
    level = [Rung()]
    while level:
        result |= {rung.specification.name: rung for rung in level}
        above = dict.fromkeys(step for rung in level for step in rung.above())
        level = [rung for rung in above if rung not in result.values()]
    return result


def usual_specifications() -> tuple[CandidateSpec, ...]:
    """Return what records may be compared with by default, the simplest first.

    Examples
    --------
    >>> [one.name for one in usual_specifications()][:4]
    ['viscous', 'coulomb', 'coulomb-viscous', 'direction-dependent']
    """
    return (
        *(specification(name) for name in BELOW),
        *(rung.specification for rung in rungs().values()),
    )
