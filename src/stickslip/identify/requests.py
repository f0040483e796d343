"""Laws that a user asks to compare, as families of terms."""

from collections.abc import Collection, Iterable, Mapping

from stickslip.errors import InputError
from stickslip.friction import PARTS, FrictionLaw, law_type
from stickslip.identify.problem import Family
from stickslip.show.formatting import joined

IGNORED = ("peak", "step")
"""Optional parts: without a value for them, a law lacks them."""
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
    found: set[str] = set()
    parts = [str(one) for one in kind.composition.parts()]
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
        found.add(name)
        other = BOTH_WAYS.get(name) if both else None
        if other == "level_direction" and other not in known:
            other = "offset"  # under one load they are the same
        if other is not None and other in known:
            found.add(other)
            found -= {"stribeck"} if other == "stribeck_sides" else set()
    text = str(kind.composition)
    for name in inputs:
        for part in ("level", "viscous"):
            if f"{part} * linear[{name}]" in text and f"{part}*{name}" in known:
                found.add(f"{part}*{name}")
    if unknown:
        memory = [one for one in unknown if one in PARTS and PARTS[one].role == "memory"]
        why = (
            "tells the memories of Dahl and LuGre, and only in time: use stickslip.fit for its"
            " parameters"
            if memory
            else f"is not explained by {joined(unknown)} here: use stickslip.fit for its parameters"
        )
        raise InputError(
            f"{kind.title} friction cannot be compared on this measurement, which {why}. Compared"
            f" can be {', '.join(known)} and sums of these."
        )
    return tuple(sorted(found))


def families_of(
    laws: Mapping[str, FrictionLaw] | Iterable[FrictionLaw | type[FrictionLaw] | str],
    known: Collection[str],
) -> tuple[Family, ...]:
    """Return the families of laws, each once."""
    given = laws.values() if isinstance(laws, Mapping) else laws
    return tuple(dict.fromkeys(family_of_law(law, known) for law in given))
