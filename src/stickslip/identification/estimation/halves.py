"""The two halves of a record: whether one law with the same parameters holds in both."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
import scipy
from numpy.typing import NDArray

from stickslip.formatting import number, with_unit, within
from stickslip.identification.estimation.jackknife import BLOCKS, Inference, effective_size
from stickslip.identification.estimation.parameters import FreeParameters
from stickslip.identification.estimation.problem import ResidualJacobian
from stickslip.quantities import Quantity

Array = NDArray[np.float64]

CHANCE = 0.01
"""Chance with which the halves of a record contradict each other where the law does hold."""
LONG = 5.0
"""Independent residuals in a block from which neighbouring blocks are as good as independent."""


def blocks_of_half(seen: ResidualJacobian) -> int:
    """Return the blocks of a half record: half of those of a whole, or as many if they are long.

    With four, the standard error has three degrees of freedom at most, and hardly anything
    contradicts anything.
    """
    return BLOCKS if effective_size(seen) >= LONG * BLOCKS else BLOCKS // 2


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Halves:
    """Estimates from either half of a record, with their own standard errors."""

    values: tuple[Array, Array]
    """Of the first and of the second half (p,)."""
    errors: Array
    """Standard errors of their difference (p,)."""
    freedom: Array
    """Degrees of freedom of these (p,)."""
    several: bool = False
    """Whether they are the first and the last of several trials."""

    @classmethod
    def of(
        cls,
        values: tuple[Array, Array],
        known: tuple[Inference, Inference],
        *,
        several: bool = False,
    ) -> "Halves":
        """Return estimates of two halves, with Welch's degrees of freedom for their difference.

        Uncertainties of the mechanism move both halves: only by how much they do so unalike counts.
        """
        variances = np.array([np.maximum(np.diag(one.covariance), 0.0) for one in known])
        freedoms = np.array([one.freedom for one in known])
        whole = variances.sum(axis=0)
        for path, moved in known[0].held.items():
            whole = whole + np.sum((moved - known[1].held[path]) ** 2, axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            welch = whole**2 / np.sum(variances**2 / freedoms, axis=0)
        return cls(
            values=values,
            errors=np.sqrt(whole),
            freedom=np.where(np.isfinite(welch), np.maximum(welch, 1.0), 1.0),
            several=several,
        )

    @property
    def distance(self) -> Array:
        """Difference in standard errors (p,); 0 where a half does not tell."""
        known = np.isfinite(self.errors) & (self.errors > 0.0)
        difference = self.values[0] - self.values[1]
        return np.where(known, difference / np.where(known, self.errors, 1.0), 0.0)

    @property
    def chances(self) -> Array:
        """Chance of a difference as large where the law holds (p,), of each parameter alone."""
        return np.asarray(2.0 * scipy.stats.t.sf(np.abs(self.distance), self.freedom))

    @property
    def contradicting(self) -> Sequence[int]:
        """Which parameters contradict each other, the least likely first (Bonferroni)."""
        chances = self.chances
        order = np.argsort(chances, kind="stable").tolist()
        return [i for i in order if chances[i] * len(chances) < CHANCE]


def widened(inference: Inference, values: Array, halves: Halves) -> Inference:
    """Return the inference of estimates (p,), widened to cover contradicting halves.

    A law that does not hold over the whole record has no one value there.

    Examples
    --------
    >>> own = Inference(
    ...     covariance=np.eye(1),
    ...     naive=np.eye(1),
    ...     freedom=np.array([7.0]),
    ...     condition=1.0,
    ...     effective=100.0,
    ... )
    >>> apart = Halves(
    ...     values=(np.array([30.0]), np.array([-40.0])),
    ...     errors=np.array([2.0]),
    ...     freedom=np.array([6.0]),
    ... )
    >>> float(widened(own, np.zeros(1), apart).half_widths[0].round(2))
    50.06
    """
    if not halves.contradicting:
        return inference
    known = np.isfinite(halves.errors)
    return inference.including(*(np.where(known, one - values, 0.0) for one in halves.values))


def contradiction(free_parameters: FreeParameters, halves: Halves) -> tuple[str, ...]:
    """Return a sentence on the parameter in which the halves contradict each other most."""
    apart = difference([item.quantity for item in free_parameters.items], halves)
    if not apart:
        return ()
    parts = "first and second half of the trials" if halves.several else "two halves of the record"
    whole = "all trials" if halves.several else "the whole record"
    return (
        f"The {parts} give {apart}: the law does not hold over {whole}; the intervals were widened"
        " to include both values.",
    )


def difference(quantities: Sequence[Quantity], halves: Halves | None) -> str:
    """Return the two values of what halves contradict each other in most; empty if in nothing."""
    if halves is None or not halves.contradicting:
        return ""
    worst = halves.contradicting[0]
    own = quantities[worst]
    ends = sorted(float(values[worst]) for values in halves.values)
    first, second = (within(float(values[worst]), *ends) for values in halves.values)
    return (
        f"{own.symbol} = {first} and {with_unit(second, own.unit)}, a difference of"
        f" {number(abs(float(halves.distance[worst])), 2)} standard errors"
    )
