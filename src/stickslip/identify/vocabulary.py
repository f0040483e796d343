"""Terms of friction laws over the speed, and the families that the judge compares.

A term is a function of the speed :math:`u = |v|` with a shape; *dry* ones grow with the load, the
others flow. A family is a set of terms, with its place from usual to unusual: each place costs
`PLACE` of the logarithm of its prior, for families that the field uses are right more often.
"""

import itertools
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.posterior import Family
from stickslip.maths import Scalar, arctan, exp, log, power, tanh

Shape = tuple[float, ...]

PLACE = 0.6
"""Logarithm of the prior that each place from usual to unusual costs (50 + 50 tables: names right
.80 inside; .78 without)."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """A part of friction as a function of the speed."""

    curve: Callable[[Scalar, Sequence[Scalar]], Scalar]
    """Friction over the coefficient at speeds (n,), for a shape; both may be symbols of a run."""
    dry: bool = False
    """Whether it grows with the load."""
    shapes: tuple[str, ...] = ()
    """What the entries of the shape are, such as ``"speed"``, ``"exponent"`` or ``"fading"``."""
    signed: bool = False
    """Whether its coefficient may be below 0."""


PARTS: Mapping[str, Part] = {
    "level": Part(curve=lambda u, _: 1.0 + 0.0 * u, dry=True),
    "viscous": Part(curve=lambda u, _: u),
    "drag": Part(curve=lambda u, _: u * u),
    "stribeck": Part(
        curve=lambda u, s: exp(-power(u / s[0], s[1])), dry=True, shapes=("speed", "fading")
    ),
    "power": Part(curve=lambda u, s: power(u, s[0]), shapes=("exponent",)),
    "tanh": Part(curve=lambda u, s: tanh(u / s[0]), dry=True, shapes=("speed",)),
    "saturating": Part(curve=lambda u, s: s[0] * arctan(u / s[0]), shapes=("speed",)),
    "logarithmic": Part(
        curve=lambda u, s: log(1.0 + u / s[0]), dry=True, shapes=("reference",), signed=True
    ),
}
"""Parts of laws by name."""
GEAR = "gear"
"""Term of a level that grows with the size of what a gear transmits, whatever the load is."""
SIGNED = frozenset(name for name, part in PARTS.items() if part.signed)
DRY = frozenset(name for name, part in PARTS.items() if part.dry)

FAMILIES: Mapping[str, int] = {
    "": 2, "level": 0, "level viscous": 0, "viscous": 0, "drag level": 1, "drag level viscous": 2,
    "drag": 3, "drag viscous": 3, "level stribeck": 1, "level stribeck viscous": 1,
    "level power": 2, "power": 2, "level power stribeck": 4, "tanh": 4, "tanh viscous": 3,
    "level logarithmic": 4, "level saturating": 3, "saturating": 4,
}  # fmt: skip
"""Families by their terms, with their place from usual to unusual. Those of three places more
named nothing better (50 + 50 tables)."""

FLOW_DIRECTIONS = ("viscous_direction", "power_direction")
"""Terms by which flows differ by direction."""
FALLS = ((1.0, 0.4), (2.0, 0.5), (0.5, 0.1))
"""Exponents by which a static surplus fades, with their priors: Tustin's, the usual one, and a
slower one."""
EXPONENTS = (0.05, 0.1, 0.2, 0.33, 0.5, 0.65, 0.8, 1.25, 1.5, 1.75)
"""Powers of the speed; 1 is viscous and 2 is drag. The first two are levels, nearly, and do not
stand beside one; nor does the third beside one that fades."""
NARROW = {"stribeck": (0.7, 0.9), "tanh": (0.5, 0.7), "saturating": (0.7, 1.0)}
"""Range of the speed of a shape, over the slowest and the fastest measured speed: beyond it the
part is a level, or viscous."""
REFERENCES = (0.1, 1.0, 10.0)
"""Reference speeds of a logarithm over the slowest measured speed."""
STEP = 0.05
"""Step of exponents a third of a step aside."""


@dataclass(frozen=True, kw_only=True)
class Grid:
    """Shapes of parts for measured speeds."""

    slowest: float
    fastest: float
    fine: float = 3.0
    """Shapes to an e-fold of the speed."""

    @property
    def count(self) -> int:
        """Number of speeds of a shape."""
        return max(4, math.ceil(self.fine * math.log(self.fastest / self.slowest)))

    def shapes(self, name: str, beside: Family = ()) -> list[tuple[Shape, float]]:
        """Return the shapes of a part of a family with their prior probabilities.

        Examples
        --------
        >>> Grid(slowest=0.1, fastest=1.0).shapes("level")
        [((), 1.0)]
        """
        if name in NARROW:
            low, high = NARROW[name]
            speeds = np.geomspace(low * self.slowest, high * self.fastest, self.count).tolist()
            falls = FALLS if name == "stribeck" else ((None, 1.0),)
            return [
                ((v,) if n is None else (v, n), p / len(speeds)) for v in speeds for n, p in falls
            ]
        if name == "power":
            powers = EXPONENTS[2 * ("level" in beside) + ("stribeck" in beside) :]
            return [((p,), 1.0 / len(powers)) for p in powers]
        if name == "logarithmic":
            return [((x * self.slowest,), 1.0 / len(REFERENCES)) for x in REFERENCES]
        return [((), 1.0)]

    def families(self, names: Sequence[Family]) -> Iterator[tuple[Family, list[Shape], float]]:
        """Yield families with the shape of each term, and the logarithm of their prior.

        A level by what a gear transmits costs one place from usual to unusual more.
        """
        for family in names:
            rest = " ".join(name for name in family if name != GEAR)
            place = FAMILIES.get(rest, max(FAMILIES.values())) + (GEAR in family)
            for some in itertools.product(*(self.shapes(item, family) for item in family)):
                prior = math.fsum(math.log(p) for _, p in some) - PLACE * place
                yield family, [shape for shape, _ in some], prior

    def finer(
        self, family: Family, shapes: Sequence[Shape], part: float = 1.0 / 3.0
    ) -> Iterator[list[Shape]]:
        """Yield the shapes of a structure and those a part of a step aside."""
        ratio = (self.fastest / self.slowest) ** (part / max(self.count - 1, 1))
        moves: list[list[Shape]] = []
        for name, shape in zip(family, shapes, strict=True):
            if name in NARROW:
                moves.append([(shape[0] * ratio**k, *shape[1:]) for k in (-1, 0, 1)])
            elif name == "power":
                step = 3.0 * part * STEP
                powers = [shape[0] + step * k for k in (-1, 0, 1)]
                least = min(item[0] for item, _ in self.shapes(name, family))
                # Less than the least is the level, and 0 is no power.
                moves.append([(p, *shape[1:]) for p in powers if p > 0.9 * least])
            else:
                moves.append([shape])
        yield from (list(item) for item in itertools.product(*moves))


def flow_direction(family: Collection[str]) -> str:
    """Return the term by which the flow of a family differs by direction.

    Examples
    --------
    >>> flow_direction(("level", "power")), flow_direction(("level", "viscous"))
    ('power_direction', 'viscous_direction')
    """
    return "power_direction" if "power" in family else "viscous_direction"


def parameters_of(family: Family) -> int:
    """Return the number of parameters of a family: coefficients and shapes that are estimated.

    Examples
    --------
    >>> parameters_of(("level", "stribeck", "viscous"))
    4
    """
    return sum(
        1 + sum(kind in ("speed", "exponent") for kind in PARTS[name].shapes)
        for name in family
        if name in PARTS
    )


def levels_at(structure: Sequence[tuple[str, Shape]], fastest: float) -> NDArray[np.float64]:
    """Return the sums of coefficients (k, d) that are levels at the fastest speed, if any may fall.

    At rest a level is a coefficient.

    Examples
    --------
    >>> levels_at([("level", ())], 1.0).shape
    (0, 1)
    >>> levels_at([("level", ()), ("logarithmic", (1.0,))], 1.0).round(3).tolist()
    [[1.0, 0.693]]
    """
    levels = [
        float(PARTS[name].curve(fastest, shape)) if name in DRY else 0.0
        for name, shape in structure
    ]
    falls = any(name in SIGNED for name, _ in structure)
    return np.array([levels] if falls else np.zeros((0, len(levels))))
