"""Parts of friction laws by name: ``law(dahl(level + stribeck) + power)``."""

from collections.abc import Mapping
from types import MappingProxyType

from stickslip.friction.parts import flows, levels, memories
from stickslip.friction.parts.base import Part

PARTS: Mapping[str, Part] = MappingProxyType(
    {
        kind.name: kind()
        for module in (levels, flows, memories)
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, Part) and hasattr(kind, "name")
    }
)
"""The parts that laws are composed of."""
