"""The laws that records are compared with by default, each one part above another."""

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import final

from stickslip.friction.registry import CandidateSpec, law, specification

BELOW = ("viscous", "coulomb")
"""Laws below the lowest rung."""


@final
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
    found: dict[str, Rung] = {}
    level = [Rung()]
    while level:
        found |= {rung.specification.name: rung for rung in level}
        above = dict.fromkeys(one for rung in level for one in rung.above())
        level = [one for one in above if one not in found.values()]
    return found


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
