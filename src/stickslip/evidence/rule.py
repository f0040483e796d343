"""When a term stays: one rule for laws, nuisances and faults."""

import math
from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.stats
from numpy.typing import NDArray

from stickslip.evidence.balance import Balance
from stickslip.evidence.fits import Fit, design, spread
from stickslip.evidence.structure import DRIVEN, SHOWN_LATE, Structure
from stickslip.evidence.terms import TERMS, Term

Array = NDArray[np.float64]
Margins = tuple[float, float, float]

HALF_BLOCKS = 8
"""Blocks of time in each half that its standard errors come from."""
JOINT = 3.0
"""Joint standard errors within which the coefficients of two halves agree."""
ALIKE = 0.5
"""Share of their mean within which they agree as well: each then explains three quarters of the
power of the term in the other half."""
NOISY = 1.25
"""Least effect of what shares an inertia out, over that of the acceleration's noise, whose size is
known within a tenth."""
SEEN = 0.006
"""Least effect of a late channel away from rests, over the friction. Measured: 0.009 and 0.010
where there is one, 0.003 where the force falls at stops."""
SHIFTED = (*SHOWN_LATE, "second")
"""Kinds whose coefficients halves are not asked for: they have none, or their memory has it."""


@final
@dataclass(frozen=True)
class Rule:
    """When a term stays in a structure.

    A term has to lower the held-out error by a number of its standard errors over blocks, by a
    share of itself, and by a share of the friction; and to repeat in both halves.
    """

    errors: float = 1.0
    """Paired standard errors over blocks that the drop has to exceed."""
    size: float = 0.02
    """Share of the held-out error that the drop has to exceed."""
    floor: float = 0.005
    """Share of the friction that the root of the drop of the mean square has to exceed."""
    halves: bool = True
    """Whether a term has to repeat in both halves."""
    ties: bool = True
    """Whether the most usual is named of what is not told apart."""
    fault: Margins | None = (2.0, 0.10, 0.01)
    """The three margins of a term that accuses the rig or the measurement, and of a wave."""

    def better(self, new: Fit, old: Fit, scale: float, noise: float = 0.0) -> bool:
        """Return whether a fit is better than another, at a scale [N] of the friction.

        The standard errors may hold for the drop or for its logarithm: an effect in few blocks,
        such as saturation, is no chance. What shares an inertia out may lower the error by as much
        as the noise [N] of the acceleration costs, which a resonance takes for less inertia.
        """
        errors, size, floor = self.margins(new.structure, old.structure)
        least = floor * scale
        if any(
            one.kind in DRIVEN and not old.structure.has(one.kind) for one in new.structure.terms
        ):
            least = max(least, NOISY * noise)
        drop = old.folds - new.folds
        tiny = 1e-12 * max(old.mse, 1e-300)
        ratio = np.log((old.folds + tiny) / (new.folds + tiny))
        sure = any(_surely(x, errors) for x in (drop, ratio))
        smaller = new.rms < (1.0 - size) * old.rms
        return sure and smaller and float(drop.mean()) > least**2

    def margins(self, new: Structure, old: Structure) -> Margins:
        """Return the margins that one structure has to earn over another."""
        further = [TERMS[term.kind] for term in new.terms if not old.has(term.kind)]
        if self.fault is not None and any(one.fault or one.wave for one in further):
            return self.fault
        return self.errors, self.size, self.floor


def _surely(drops: Array, errors: float) -> bool:
    """Return whether the mean of paired drops (b,) exceeds so many of its standard errors."""
    return bool(drops.mean() > errors * drops.std(ddof=1) / math.sqrt(len(drops)))


def seen_late(balance: Balance, new: Fit, old: Fit, scale: float) -> bool:
    """Return whether a force that is shown late lowers the error away from rests as well.

    Beside them the filter mixes rows with a force that no law says, as a late channel would.
    """
    before = {one.kind for one in old.structure.terms}
    if not {one.kind for one in new.structure.terms} & {*SHOWN_LATE} - before:
        return True
    rows = balance.use & balance.clear
    drop = old.residual[rows] ** 2 - new.residual[rows] ** 2
    return bool(drop.size and drop.mean() > (SEEN * scale) ** 2)


def repeats(balance: Balance, found: Fit, term: Term) -> bool:
    """Return whether a term has the same sign and a compatible size in both halves.

    A half whose 95 % interval is wider than the term's size bears no witness.
    """
    if term.kind in SHIFTED:
        return True
    own = [i for i, one in enumerate(found.owner) if one == term]
    size = float(np.linalg.norm(found.coef[own]))
    wide = float(scipy.stats.t.ppf(0.975, HALF_BLOCKS - 1))
    able = []
    made = design(balance, found.structure)
    for half in (0, 1):
        values, errors = spread(made, balance.half == half, HALF_BLOCKS)
        if wide * float(np.linalg.norm(errors[own])) < size:
            able.append((values[own], errors[own]))
    if len(able) < 2:
        return len(able) == 1
    (a, error_a), (b, error_b) = able
    apart = float(np.linalg.norm(a - b))
    error = math.hypot(float(np.linalg.norm(error_a)), float(np.linalg.norm(error_b)))
    close = apart < max(JOINT * error, ALIKE * float(np.linalg.norm(a + b)) / 2.0)
    return close and float(a @ b) > 0.0
