"""The mechanisms by name; packages add theirs under the entry point ``stickslip.mechanisms``."""

import functools
from collections.abc import Mapping
from types import MappingProxyType

from stickslip.mechanisms.axis import Axis
from stickslip.mechanisms.base import Mechanism
from stickslip.mechanisms.capsule import Capsule
from stickslip.mechanisms.pendulum import Pendulum
from stickslip.mechanisms.pendulum_cart import PendulumCart
from stickslip.mechanisms.spring_block import SpringBlock
from stickslip.mechanisms.towed_block import TowedBlock
from stickslip.mechanisms.two_mass_axis import TwoMassAxis
from stickslip.quantities import gathered

__all__ = ["MECHANISMS", "mechanisms"]

MECHANISMS: Mapping[str, type[Mechanism]] = MappingProxyType(
    {
        mechanism.name: mechanism
        for mechanism in (
            SpringBlock,
            TowedBlock,
            Axis,
            TwoMassAxis,
            Pendulum,
            PendulumCart,
            Capsule,
        )
    }
)
"""The mechanisms that come with the package, by kebab-case name."""


@functools.cache
def mechanisms() -> Mapping[str, type[Mechanism]]:
    """Return all mechanisms by name: ours and those of installed packages.

    Examples
    --------
    >>> sorted(mechanisms())
    ['axis', 'capsule', 'pendulum', 'pendulum-cart', 'spring-block', 'towed-block', 'two-mass-axis']
    """
    return gathered(MECHANISMS, "stickslip.mechanisms", Mechanism)  # type: ignore[type-abstract]  # a base
