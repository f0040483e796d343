"""Thresholds of the kinds that are judged by shares of laws, each with the study that set it."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Thresholds:
    """Numbers that decide; studies are in ``benchmarks/bands.py``."""

    freedom: float = 4.0
    """Degrees of freedom of Student's t in the score: no single block decides (study: shares)."""
    refinements: int = 5
    """Halvings of the grid around the best shape of a family, or of a memory."""
    outlier: float = 3.0
    """Standard deviations beyond which a row loses weight, and a refined law is another."""
    outlying: float = 6.0
    """Standard deviations from which a row is said to be far from the others."""
    curve_share: float = 0.1
    """Least share of the measured curve in the ensemble (study: widths) ..."""
    draws: int = 400
    """Dirichlet draws of the Bayesian bootstrap of blocks."""
    rarer: float = 1.075
    """Power of the part outside a band at which quantiles are taken: of 5 % it makes 4 %, which
    covers what shares leave out."""
    interval: float = 0.98
    """Quantiles between which an interval of a parameter that is stated as 95 % lies."""
    unusual: float = 0.25
    """Evidence that each place in the order of terms from usual to unusual costs (study: names)."""
    all_along: float = 1.3
    """Widening of bands that hold all along: a feature between two speeds is in no draw."""
    material: float = 0.06
    """Share of the held-out error of a record that a parameter must save (study: records)."""
    explained: float = 0.5
    """Part of what noise does not explain that a cause must, to be asserted (study: records), and
    of what a plain balance leaves that a second memory, or another sign, must."""
    no_law: float = 0.9
    """Share of the measured curve, before its least share, from which no law explains ..."""
    errors: float = 2.0
    """... and paired standard errors by which it predicts better (of 160 tables: none that has a
    law, 5 % of those with a dip that no law has), or by which a force goes straight between
    samples."""
    no_law_ratio: float = 1.2
    """... and share by which its held-out error is smaller: on a record all is significant."""
    misfit: float = 5.0
    """Errors that travels show about every law, over those stated, from which no law explains."""
    pattern_chance: float = 0.05
    """Part of the rehearsals up to which what is left is said to follow a feature ..."""
    pattern: float = 0.01
    """... if that is this share of the force at least, ..."""
    rounding: float = 1e-6
    """Share by which numbers differ that say the same: scores, balances, an inertia."""
    negligible: float = 1e-3
    """Share of a number below which another beside it is none: an evolution effect of rate and
    state beside the direct one, a difference of planned travels."""
    fewest: int = 3
    """Runs, or cycles of stick-slip, that show a scatter or a rate, at least."""


THRESHOLDS = Thresholds()
