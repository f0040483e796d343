"""What a fit looks for: parameters with bounds, and how the optimiser sees them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stickslip.quantities import Quantity

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class FreeParameter:
    """One parameter that a fit looks for.

    The optimiser sees its logarithm if `log`, the surplus over another parameter if `above`, else
    the value itself.
    """

    path: str
    """Parameter path."""
    quantity: Quantity
    """Symbol and unit."""
    start: float
    """Start value."""
    low: float = -math.inf
    """Least value looked at; with `above`, least surplus."""
    high: float = math.inf
    """Largest value looked at; with `above`, largest surplus."""
    log: bool = False
    """Whether its order of magnitude is what is looked for."""
    above: str = ""
    """Path of the parameter that it does not fall below, such as the kinetic level."""
    guessed: bool = False
    """Whether bounds that are no limits of the quantity follow from a guess of its size alone."""

    def widened(self, side: str, factor: float) -> "FreeParameter":
        """Return the unknown with a guessed bound farther out by a factor; itself at a limit.

        Examples
        --------
        >>> from stickslip.quantities import Quantity
        >>> level = FreeParameter(
        ...     path="friction.kinetic_coefficient",
        ...     quantity=Quantity("mu_k", low=0),
        ...     start=0.1,
        ...     low=0.0,
        ...     high=2.0,
        ...     guessed=True,
        ... )
        >>> level.widened("upper", 10.0).high, level.widened("lower", 10.0) is level
        (20.0, True)
        """
        if not self.guessed:
            return self
        if side == "upper":
            return replace(self, high=min(self.high * factor, self.quantity.high))
        if self.log:
            return replace(self, low=self.low / factor)
        return (
            self
            if self.low >= 0.0
            else replace(self, low=max(self.low * factor, self.quantity.low))
        )

    def limits(self) -> tuple[float, float]:
        """Return the bounds as the optimiser sees them."""
        if not self.log:
            return self.low, self.high
        return (math.log(self.low) if self.low > 0.0 else -math.inf), (
            math.log(self.high) if self.high > 0.0 else math.inf
        )


@dataclass(frozen=True)
class FreeParameters:
    """The unknowns of a fit in order, and the way between values and coordinates.

    Examples
    --------
    >>> from stickslip.quantities import Quantity
    >>> both = FreeParameters(
    ...     (
    ...         FreeParameter(
    ...             path="friction.kinetic_coefficient", quantity=Quantity("mu_k"), start=2.0
    ...         ),
    ...         FreeParameter(
    ...             path="friction.static_coefficient",
    ...             quantity=Quantity("mu_s"),
    ...             start=2.5,
    ...             above="friction.kinetic_coefficient",
    ...         ),
    ...     )
    ... )
    >>> both.coordinates(both.start)
    array([2. , 0.5])
    """

    items: tuple[FreeParameter, ...]
    """The free parameters, in the order of all arrays (p,)."""
    known: Mapping[str, float] | None = None
    """Values of parameters that are not looked for, as far as an unknown stands above one."""

    def __len__(self) -> int:
        return len(self.items)

    @property
    def paths(self) -> tuple[str, ...]:
        """Paths in order."""
        return tuple(item.path for item in self.items)

    @property
    def start(self) -> Array:
        """Start values (p,)."""
        return np.array([item.start for item in self.items])

    def starting_at(self, values: Sequence[float] | Array) -> "FreeParameters":
        """Return the same unknowns with other start values (p,)."""
        items = (replace(item, start=float(v)) for item, v in zip(self.items, values, strict=True))
        return replace(self, items=tuple(items))

    def widened(self, sides: Mapping[str, str], factor: float) -> "FreeParameters":
        """Return the unknowns with guessed bounds farther out where one was met, by path."""
        items = (
            item.widened(sides[item.path], factor) if item.path in sides else item
            for item in self.items
        )
        return replace(self, items=tuple(items))

    def limits(self) -> tuple[Array, Array]:
        """Return the bounds of the coordinates (p,), (p,)."""
        pairs = np.array([item.limits() for item in self.items]).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]

    def coordinates(self, values: Array) -> Array:
        """Return what the optimiser sees (p,), inside the bounds."""
        seen = np.empty(len(self))
        for i, item in enumerate(self.items):
            value = values[i] - self._base(item, values)
            seen[i] = math.log(max(value, 1e-300)) if item.log else value
        low, high = self.limits()
        return np.clip(seen, low, high)

    def values(self, coordinates: Array) -> Array:
        """Return parameter values (p,) for coordinates."""
        found = np.array(
            [
                math.exp(min(c, 700.0)) if item.log else c
                for item, c in zip(self.items, coordinates, strict=True)
            ]
        )
        for i, item in enumerate(self.items):
            found[i] += self._base(item, found)
        return found

    def slopes(self, coordinates: Array) -> Array:
        """Return the derivatives of the values by the coordinates (p, p)."""
        table = np.zeros((len(self), len(self)))
        for i, item in enumerate(self.items):
            table[i, i] = math.exp(min(coordinates[i], 700.0)) if item.log else 1.0
        for i, item in enumerate(self.items):
            if item.above in self.paths:
                table[i] += table[self.paths.index(item.above)]
        return table

    def _base(self, item: FreeParameter, values: Array) -> float:
        """Return the value that an unknown stands above; 0 if on none."""
        if not item.above:
            return 0.0
        if item.above in self.paths:
            return float(values[self.paths.index(item.above)])
        return (self.known or {})[item.above]
