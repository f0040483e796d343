"""Parts of friction laws by name: ``law(dahl(level + stribeck) + power)``."""

from collections.abc import Mapping
from types import MappingProxyType

from stickslip.friction.parts import curves, extras, factors, flows, levels, memories, signs
from stickslip.friction.parts.base import Part

PARTS: Mapping[str, Part] = MappingProxyType(
    {
        kind.name: kind()
        for module in (levels, curves, extras, flows, factors, signs, memories)
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, Part) and hasattr(kind, "name")
    }
)
"""The parts that laws are composed of."""
