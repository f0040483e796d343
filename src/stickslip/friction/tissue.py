"""Environments of capsules in a body, as compositions of parts, with what is known of each.

The normal force that a bowel adds by its hoop stress is no part of a law: it is
`Capsule.squeeze`. Values stand here only where a source states them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from stickslip.friction.base import FrictionLaw
from stickslip.friction.registry import law
from stickslip.quantities import Given


@dataclass(frozen=True, kw_only=True)
class Tissue:
    """An environment: the composition of its friction, and where that comes from.

    Examples
    --------
    >>> wet = TISSUES["wet"]
    >>> wet.ranges["kinetic_coefficient"]
    (0.0004, 0.018)
    >>> wet.law.passivity.condition
    'always'
    """

    composition: str
    """Sum of parts."""
    meaning: str
    """What it stands for, in one sentence."""
    sources: tuple[str, ...]
    """Keys of the bibliography."""
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Least and largest values that the first source measured."""

    @property
    def law(self) -> type[FrictionLaw]:
        """The class of its laws, which has the condition under which these are passive."""
        return law(self.composition)

    def sample(self, count: int = 20, *, seed: int = 0, **values: Given) -> list[FrictionLaw]:
        """Return laws drawn over what was measured, each value in a range as likely.

        `values` are parameters that all of them have: those without a range have to be given, or
        a `ParameterError` names them.

        Examples
        --------
        >>> laws = TISSUES["wet"].sample(50)
        >>> 0.0004 <= min(one.kinetic_coefficient for one in laws) < 0.002
        True
        """
        draw = np.random.default_rng(seed).uniform
        rows = ({name: draw(*ends) for name, ends in self.ranges.items()} for _ in range(count))
        return [self.law(**(row | values)) for row in rows]


TISSUES: Mapping[str, Tissue] = MappingProxyType(
    {
        "wet": Tissue(
            composition="level",
            meaning="The inside of a small bowel, pig, against steel, polycarbonate and silicone.",
            sources=("lyle2013",),
            ranges={"kinetic_coefficient": (0.0004, 0.018)},
        ),
        "directed": Tissue(
            composition="both_ways(level)",
            meaning="Dry friction that differs by direction, as under hooks or bristles.",
            sources=("fang2012",),
        ),
        "mucus": Tissue(
            composition="level + power",
            meaning="Dry friction and a film of mucus that thins as it is sheared.",
            sources=("woo2011",),
        ),
        "intestine": Tissue(
            composition="level + logarithmic + viscous",
            meaning="Friction under the squeeze of a bowel, which grows with the speed, and drag.",
            sources=("sledsonbowel2013", "woo2011", "guo2020"),
            ranges={"kinetic_coefficient": (0.007, 0.054)},
        ),
        "folds": Tissue(
            composition="(level + logarithmic) * ripple[position] + viscous",
            meaning="The same, with folds across the way that come back at equal distances.",
            sources=("guo2020",),
        ),
        "peristalsis": Tissue(
            composition="level + weight[pressure] + viscous",
            meaning="A bowel that contracts: dry friction that grows with the pressure, and drag.",
            sources=("woo2011",),
        ),
        "five elements": Tissue(
            composition="relaxing[2](level) + viscous",
            meaning="Tissue that the contact stretches, with two springs that relax, and drag.",
            sources=("kim2006",),
        ),
    }
)
"""Environments by name."""
