"""The mechanisms by name; packages add theirs under the entry point ``stickslip.mechanisms``."""

import functools
from collections.abc import Mapping
from types import MappingProxyType

from stickslip.mechanisms import MECHANISM_MODULES
from stickslip.mechanisms.base import Mechanism
from stickslip.quantities import gathered, own_classes

MECHANISMS: Mapping[str, type[Mechanism]] = MappingProxyType(
    {
        kind.name: kind
        for kind in own_classes("stickslip.mechanisms", MECHANISM_MODULES, Mechanism)  # type: ignore[type-abstract]  # a base
    }
)
"""The mechanisms that come with the package, by kebab-case name."""


@functools.cache
def mechanisms() -> Mapping[str, type[Mechanism]]:
    """Return all mechanisms by name: ours and those of installed packages.

    Examples
    --------
    >>> sorted(mechanisms())[:5]
    ['axis', 'block-chain', 'capsule', 'pendulum', 'pendulum-cart']
    """
    return gathered(MECHANISMS, "stickslip.mechanisms", Mechanism)  # type: ignore[type-abstract]  # a base
