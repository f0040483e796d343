"""What slopes show of parameters, and what they do not: directions, whatever the units."""

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HOPELESS = 1e7
"""Condition beyond which a direction of the parameters is not seen at all."""
TAKES_PART = 0.01
"""Share of such a direction from which a parameter counts as part of it."""
UNSEEN = "the record does not depend on it"
TIED = "the record depends only on a combination of it and other parameters"


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Directions:
    """Slopes (n, p) as a product: orthonormal columns times what makes them of coordinates.

    Columns are scaled to one size first, so that units do not matter.
    """

    columns: Array
    """Orthonormal (n, r); of directions that are seen."""
    inverse: Array
    """Coordinates by orthonormal ones (p, r)."""
    size: Array
    """Norms of the slopes (p,); 1 where they are 0."""
    effective: NDArray[np.bool_]
    """Which slopes are not 0 (p,)."""
    cut: Array
    """Directions of scaled coordinates that are not seen (p, k), columns of norm 1."""
    condition: float
    """Largest over smallest singular value of the scaled slopes, those that are 0 left out."""

    @classmethod
    def of(cls, table: Array) -> "Directions":
        """Return the directions of slopes (n, p)."""
        # large and small numbers are squared in a norm
        largest = np.max(np.abs(table), axis=0, initial=0.0)
        effective = largest > 0.0
        size = np.where(effective, largest, 1.0)
        size = size * np.where(effective, np.linalg.norm(table / size, axis=0), 1.0)
        u, singular, v = np.linalg.svd((table / size)[:, effective], full_matrices=False)
        kept = singular > singular.max(initial=0.0) / HOPELESS
        inverse, cut = (np.zeros((len(size), int(k.sum()))) for k in (kept, ~kept))
        inverse[effective] = v[kept].T / singular[kept] / size[effective, None]
        cut[effective] = v[~kept].T
        condition = singular[0] / max(singular[-1], 1e-300) if len(singular) else 1.0
        return cls(
            columns=u[:, kept],
            inverse=inverse,
            size=size,
            effective=effective,
            cut=cut,
            condition=float(condition),
        )

    def reasons(self, scale: Array) -> list[str]:
        """Return for each value, by coordinates (p, p), why it is not known; empty if it is."""
        by_scaled = scale / self.size
        unseen = takes_part(by_scaled, np.eye(len(self.size))[:, ~self.effective])
        tied = takes_part(by_scaled, self.cut)
        # of a number whose slopes are 0 by a bound there is nothing to say
        held = ~np.any(scale != 0.0, axis=1)
        return [
            UNSEEN if none or own else TIED if both else ""
            for none, own, both in zip(held, unseen, tied, strict=True)
        ]


def takes_part(rows: Array, directions: Array) -> NDArray[np.bool_]:
    """Return which linear functions (m, p) change along any of the directions (p, k) of norm 1."""
    if not directions.shape[1]:
        return np.zeros(len(rows), dtype=bool)
    change = np.linalg.norm(rows @ directions, axis=1)
    return np.asarray(change > TAKES_PART * np.linalg.norm(rows, axis=1))
