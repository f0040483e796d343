r"""Damped Gauss-Newton descents from several starts at once, as runs are cheaper together.

A descent raises the logarithm of a posterior, with the gradient :math:`g` and the curvature
:math:`H` (minus the second derivative) over the scales of the unknowns:

1. the step is :math:`(H + \lambda\,\mathrm{diag}\,H)^{-1} g` of the unknowns that no bound holds,
   and no longer than `reach` scales, beyond which the quadratic does not hold;
2. a step that gains is kept, and :math:`\lambda` falls; else it grows;
3. a descent ends where a step gains no more than is `settled`, or :math:`\lambda` is beyond
   `MOST`.

Source: J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and theory", in: Numerical
Analysis, Lecture Notes in Mathematics 630 (1978) 105-116.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.bands import Array

FIRST, EASED, STIFFENED, MOST = 1e-2, 0.2, 10.0, 1e7
"""Damping of a first step, its factors after a step that is kept and one that is not, and the
damping at which a descent ends."""


@dataclass(eq=False)
class Descents:
    """Descents from several starts at once."""

    at: Array
    """Where they are (m, p)."""
    scale: Array
    """Scales of the unknowns (m, p), in which steps, gradients and curvatures are counted."""
    settled: float
    """Gain of a step, in the logarithm of the posterior, up to which a descent ends."""
    low: Array | float = -np.inf
    """Least values of the unknowns (p,) and ..."""
    high: Array | float = np.inf
    """... largest ones."""
    reach: float = 2.0
    """Longest step of an unknown over its scale."""
    value: Array = field(init=False)
    """Logarithm of the posterior there (m,), up to a constant."""
    gradient: Array = field(init=False)
    """Gradients (m, p) and ..."""
    curvature: Array = field(init=False)
    """... minus second derivatives (m, p, p) by Gauss and Newton."""
    damping: Array = field(init=False)
    live: NDArray[np.bool_] = field(init=False)
    """Which of them go on (m,)."""

    def __post_init__(self) -> None:
        m, p = self.at.shape
        self.value, self.damping = np.full(m, -np.inf), np.full(m, FIRST)
        self.gradient, self.live = np.zeros((m, p)), np.ones(m, dtype=bool)
        self.curvature = np.broadcast_to(np.eye(p), (m, p, p)).copy()

    def proposed(self) -> Array:
        """Return the points of the next step (m, p)."""
        p, g = self.at.shape[1], self.gradient
        held = (self.at <= self.low) & (g < 0.0) | (self.at >= self.high) & (g > 0.0)
        h = np.where(held[:, :, None] | held[:, None, :], 0.0, self.curvature)
        diagonal = np.einsum("kii->ki", h)
        # what hardly matters is held back by what matters: else it would leap
        least = 1e-9 * np.max(diagonal, axis=1, keepdims=True)
        added = self.damping[:, None] * diagonal + least + (diagonal <= 0.0)
        lifted, right = h + added[:, :, None] * np.eye(p), np.where(held, 0.0, g)
        step = np.linalg.solve(lifted, right[:, :, None])[:, :, 0]
        longest = np.maximum(np.abs(step).max(axis=1, keepdims=True), 1e-300)
        step *= np.minimum(1.0, self.reach / longest)
        return np.asarray(np.clip(self.at + step * self.scale, self.low, self.high))

    def accept(self, points: Array, value: Array, *, first: bool = False) -> NDArray[np.intp]:
        """Move to those points (k, p) of live descents that gain; return which these are."""
        (which,) = np.nonzero(self.live)
        gain = np.where(np.isfinite(value), value, -np.inf) - np.maximum(self.value[which], -1e300)
        better = np.isfinite(value) & (first | (gain > 0.0))
        kept, others = which[better], which[~better]
        self.at[kept], self.value[kept] = points[better], value[better]
        self.damping[kept] *= EASED
        self.live[kept] = first | (gain[better] > self.settled)
        self.damping[others] = np.maximum(self.damping[others], 1e-3) * STIFFENED
        self.live[others] = (self.damping[others] < MOST) & (not first)
        return np.flatnonzero(better)
