"""Laws that a user asks to compare: as families of terms, or laws that are no sum of these.

A sum of the vocabulary's parts is a family. Any other law without states is linearised
(`stickslip.identify.own_laws`) about the values at which it fits the median of the drawn curves
best; these are taken again where it is projected, until they stay.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.friction import PARTS, FrictionLaw, law_type
from stickslip.identify.forces import TRANSMITTED
from stickslip.identify.judgement import Judgement
from stickslip.identify.laws import own_composition
from stickslip.identify.own_laws import OwnLaw, is_own, starting
from stickslip.identify.posterior import Family
from stickslip.identify.problems.record_columns import through_gear
from stickslip.identify.problems.record_signals import NotToldError, Record
from stickslip.identify.vocabulary import PARTS as PARTS_OF_LAWS
from stickslip.show.formatting import joined

IGNORED = ("peak", "step")
"""Optional parts: without a value for them, a law lacks them."""
MAY_BE_HELD = frozenset({"viscous_exponent", "yield_exponent", "fading_exponent"})
"""Exponents that a family of the vocabulary need not find."""
NAMES: Mapping[str, str] = {"weight[transmitted]": "gear"}
"""Terms that are not called as the part is."""
REMEMBERED = ("dahl", "lugre")
"""Memories that records tell: they mark a family. The balance does not tell them apart, as the
damping of bristles is hardly a part of it."""
BOTH_WAYS: Mapping[str, str] = {
    "level": "level_direction",
    "stribeck": "stribeck_sides",
    "viscous": "viscous_direction",
}
"""Terms that make a part differ by direction."""


def family_of_law(law: FrictionLaw | type[FrictionLaw] | str, known: Collection[str]) -> Family:
    """Return the terms of a law among those that a measurement can tell.

    Examples
    --------
    >>> terms = ["level", "viscous", "stribeck"]
    >>> family_of_law("stribeck", terms)
    ('level', 'stribeck', 'viscous')
    >>> family_of_law("dahl", terms)
    Traceback (most recent call last):
    stickslip.errors.InputError: Dahl friction cannot be compared on this measurement, ...
    """
    kind = law_type(law) if isinstance(law, str) else law
    if kind.composition is None:
        raise InputError(
            f"{kind.title} friction cannot be compared on this measurement, as it is no sum of"
            f" parts: use stickslip.fit for its parameters. Compared can be {', '.join(known)} and"
            " sums of these."
        )
    result: set[str] = set()
    parts = [str(item) for item in kind.composition.parts()]
    both = any(part.startswith("both_ways") for part in parts)
    smooth = "tanh" in parts
    unknown = []
    inputs = [name.partition("[")[2].rstrip("]") for name in parts if name.startswith("linear[")]
    for part in parts:
        if part.startswith(("both_ways", "linear[")) or part in IGNORED:
            continue
        name = "tanh" if smooth and part == "level" else NAMES.get(part, part)
        if name not in known:
            unknown.append(part)
            continue
        result.add(name)
        other = BOTH_WAYS.get(name) if both else None
        if other == "level_direction" and other not in known:
            other = "offset"  # under one load they are the same
        if other is not None and other in known:
            result.add(other)
            result -= {"stribeck"} if other == "stribeck_sides" else set()
    text = str(kind.composition)
    for name in inputs:
        for part in ("level", "viscous"):
            if f"{part} * linear[{name}]" in text and f"{part}*{name}" in known:
                result.add(f"{part}*{name}")
    if unknown:
        memory = [item for item in unknown if item in PARTS and PARTS[item].role == "memory"]
        why = (
            "tells the memories of Dahl and LuGre, and only in time"
            if memory
            else f"is not explained by {joined(unknown)} here: use stickslip.fit for its parameters"
        )
        raise InputError(
            f"{kind.title} friction cannot be compared on this measurement, which {why}. Compared"
            f" can be {', '.join(known)} and sums of these."
        )
    return held_power(result, kind.fit_order)


def held_power(terms: Collection[str], varied: Collection[str]) -> Family:
    """Return terms, where a power of the speed is viscous unless its exponent is fitted.

    Examples
    --------
    >>> held_power(["level", "power"], ["kinetic_coefficient", "viscous_coefficient"])
    ('level', 'viscous')
    """
    held = "power" in terms and "viscous_exponent" not in varied
    return tuple(sorted({*terms} - {"power"} | {"viscous"} if held else terms))


def untold_states(law: type[FrictionLaw], held: Collection[str] = ()) -> NotToldError:
    """Return why a law with states, some parameters `held`, is not fitted."""
    parts = [*map(str, law.composition.parts())] if law.composition is not None else []
    others = [part for part in parts if part not in (*REMEMBERED, *PARTS_OF_LAWS, *IGNORED)]
    if not {*REMEMBERED} & {*parts}:
        cause = (
            "has states that no measurement tells here. Records of a force in time tell Dahl and"
            " LuGre friction: fit one of these, or a law without states."
        )
    elif others:
        cause = (
            f"has states, which fits do not follow beside {joined(others)}: fit Dahl or LuGre"
            " friction to records where that stays as it is, or a law without states."
        )
    elif held:
        cause = (
            f"has states, and is fitted with all of its parameters: {joined(sorted(held))} cannot"
            " be held. Leave out fixed, vary all of the law, or fit a law without states."
        )
    else:
        cause = (
            "has states that this measurement does not show: a record in time of a force that"
            " drives the motion, or of friction, shows them where bristles are stretched by more"
            " than the noise of the position. Record one, or fit a law without states."
        )
    return NotToldError(f"{law.title} friction {cause}")


ROUNDS = 3
"""Times that values about which laws are linear are taken, at most."""
STAYS = 0.2
"""Change of friction over what is allowed, up to which they stay."""


@dataclass(frozen=True, kw_only=True)
class LawToFit:
    """A law with the parameters that are fitted."""

    kind: type[FrictionLaw]
    varied: tuple[str, ...]
    """Names of its parameters that are fitted."""
    held: Mapping[str, float] = field(default_factory=dict)
    """Values of others, by name."""

    @property
    def is_family(self) -> bool:
        """Whether it may be a family of the vocabulary: other laws are linear about values."""
        if self.kind.composition is None:
            return False
        parts = [str(part) for part in self.kind.composition.parts()]
        optional = {"break_away_coefficient", *(["static_coefficient"] * ("step" in parts))}
        needed = {*self.kind.fit_order} - MAY_BE_HELD
        both = any(part.startswith("both_ways") for part in parts)
        if not {*self.varied} <= {*self.kind.fit_order}:
            return False
        return not both and needed <= {*self.varied} and not optional & {*self.varied}

    def family(self, known: Collection[str]) -> Family:
        """Return the family among terms that a measurement can tell."""
        return held_power(family_of_law(self.kind, known), self.varied)


@dataclass(frozen=True, kw_only=True)
class LawsToCompare:
    """Laws that a user asks to compare; all of the vocabulary if none."""

    families: tuple[Family, ...] = ()
    """Those that are sums of the vocabulary's parts."""
    own: tuple[OwnLaw, ...] = ()
    """Those of any other form."""
    fitted: bool = False
    """Whether it is one law, which is fitted."""

    @property
    def alone(self) -> tuple[Family, ...] | None:
        """Families that are compared; None of all, as others are placed beside them."""
        return None if self.own or not self.families else self.families


def laws_to_compare(
    laws: Mapping[str, Any] | Iterable[Any], known: Collection[str], load: float
) -> LawsToCompare:
    """Return laws (instances, types, names), each once, among terms that a measurement can tell.

    Laws of other forms begin at ordinary values under a load [N].
    """
    given = [*(laws.values() if isinstance(laws, Mapping) else laws)]
    families, own = list[Family](), list[OwnLaw]()
    for item in given:
        if isinstance(item, OwnLaw):
            own.append(item)
            continue
        fitted = isinstance(item, LawToFit)
        law = item.kind if fitted else law_type(item) if isinstance(item, str) else item
        kind: type[FrictionLaw] = law if isinstance(law, type) else type(law)
        to_fit = item if fitted else LawToFit(kind=kind, varied=tuple(law.fit_order))
        family = None
        if to_fit.is_family or kind.states or not to_fit.varied:
            try:
                family = to_fit.family(known) if fitted else family_of_law(law, known)
            except InputError:
                if kind.states and fitted:
                    raise untold_states(kind) from None
                if kind.states or not to_fit.varied:
                    raise
        if family is None:
            own.append(OwnLaw(law=starting(law, to_fit.held, load), varied=to_fit.varied))
        else:
            families.append(family)
    if not families and not own:
        raise InputError("laws is empty: name at least one law, or leave it out.")
    fitted = any(isinstance(item, LawToFit | OwnLaw) for item in given)
    return LawsToCompare(families=tuple(dict.fromkeys(families)), own=tuple(own), fitted=fitted)


def laws_for(laws: Any, records: Sequence[Record], load: float) -> LawsToCompare:
    """Return the laws that a user asks to compare on records; none of all."""
    if laws is None:
        return LawsToCompare()
    known = [*PARTS_OF_LAWS, "offset", "viscous_direction", *REMEMBERED]
    if any(record.load is not None for record in records):
        known.append("level_direction")
    if any(through_gear(record) is not None for record in records):
        known.append("gear")
    inputs = {name for record in records for name in record.inputs if name != TRANSMITTED}
    known += [f"{part}*{name}" for name in sorted(inputs) for part in ("level", "viscous")]
    return laws_to_compare(laws, known, load)


def with_own_laws(problem: Any, asked: LawsToCompare) -> Any:
    """Return a problem with the laws of any form that a user asks for."""
    problem.fitted = asked.fitted
    if not asked.own:
        return problem
    target = Judgement(problem).target
    rows = problem.slips(problem.places())
    for item in asked.own:
        unseen = [name for name in item.law.inputs if name not in rows.inputs]
        if unseen:
            raise InputError(
                f"{item.law.name} depends on the contact input {unseen[0]!r}, which fits of records"
                f" do not follow; here they follow {joined(rows.inputs) or 'none'}: give a law"
                " without it."
            )
    usual = float(problem.slips(problem.at(1.0)).load[0])
    told = [
        replace(item, load=usual).fitted(target.middle, target.allowed, rows) for item in asked.own
    ]
    for entry, given in zip(told, asked.own, strict=True):
        if given.varied and not entry.varied:
            raise InputError(
                f"nothing that was measured depends on what is varied of {entry.law.title}"
                " friction."
            )
    values = [item.values for item in told]
    for _ in range(ROUNDS):
        structures = [item.structure(x) for item, x in zip(told, values, strict=True)]
        result = problem.with_laws(structures, asked.families)
        rungs = [rung for rung in Judgement(result).rungs if is_own(rung.structure)]
        before, values = values, list(values)
        for k, entry in enumerate(told):
            own = [x for x in rungs if any(n in dict(structures[k]) for n in dict(x.structure))]
            if own:
                best = min(own, key=lambda x: x.excess)
                composed = own_composition(best.structure, best.coefficients[None])
                at = entry.at([float(composed.values[name][0]) for name in entry.varied])
                values[k] = replace(entry, law=at).values
        moved = [
            float(np.max(np.abs(item.friction(x, rows) - item.friction(y, rows)) / target.allowed))
            for item, x, y in zip(told, values, before, strict=True)
        ]
        if max(moved) <= STAYS:
            break
    return result
