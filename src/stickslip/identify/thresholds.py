"""Every threshold of the judge, each with the study that set it."""

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Thresholds:
    """Numbers that decide; studies are in ``benchmarks/bands.py`` and decisions 0140 and 0141."""

    freedom: float = 4.0
    """Degrees of freedom of Student's t in the score: no single block decides (study: shares)."""
    beam: int = 3
    """Structures that each round of the search goes on from (5 finds the same laws)."""
    depth: int = 7
    """Rounds of the search, and so terms of a structure, at most."""
    families: int = 6
    """Families whose shapes are refined between the points of the grid, and that are shown."""
    refinements: int = 5
    """Halvings of the grid around the best shape of a family, or of a memory."""
    told: float = 20.0
    """Half-widths by which friction of the named law is away from zero where the band is not."""
    outlier: float = 3.0
    """Standard deviations beyond which a row loses weight, and a refined law is another."""
    outlying: float = 6.0
    """Standard deviations from which a row is said to be far from the others."""
    weighings: int = 6
    """Searches by weights that follow from the residuals of the best structure before ..."""
    weighed: float = 0.05
    """... until no weight changes by more than this share."""
    curve_share: float = 0.1
    """Least share of the measured curve in the ensemble (study: widths) ..."""
    free_curve_share: float = 0.2
    """... and of free motions, whose work tells friction at low speeds least (study: decays)."""
    draws: int = 400
    """Dirichlet draws of the Bayesian bootstrap of blocks."""
    ensemble: int = 800
    """Draws of laws from which bands are read."""
    rarer: float = 1.075
    """Power of the part outside a band at which quantiles are taken: of 5 % it makes 4 %, which
    covers what shares leave out."""
    interval: float = 0.98
    """Quantiles between which an interval of a parameter that is stated as 95 % lies."""
    price: float = 2.0
    """Evidence that a parameter has to save where the search goes on from a structure, or where
    rows are dense; and that a sum of terms costs which the field does not use (study: names)."""
    unusual: float = 0.25
    """Evidence that each place in the order of terms from usual to unusual costs (study: names)."""
    all_along: float = 1.3
    """Widening of bands that hold all along: a feature between two speeds is in no draw."""
    growth: float = 3.0
    """Evidence that noise which grows by a power costs beside one that does not (0155: 3 and 2)."""
    odds: float = 100.0
    """Odds against a family up to which it is not told apart from the named one."""
    material: float = 0.06
    """Share of the held-out error of a record that a parameter must save (study: records)."""
    explained: float = 0.5
    """Part of what noise does not explain that a cause must, to be asserted (study: records), and
    of what a plain balance leaves that a second memory, or another sign, must."""
    same_span: float = 0.01
    """Part of a column outside a span from which a design tells them apart."""
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
    differ_chance: float = 0.02
    """Part of the deals of stretches to records up to which records are said to differ."""
    second: float = 0.85
    """Share of readings of a second measurement in the 95 % band below which it differs."""
    pattern_chance: float = 0.05
    """Part of the rehearsals up to which what is left is said to follow a feature ..."""
    pattern: float = 0.01
    """... if that is this share of the force at least, ..."""
    pattern_of_scatter: float = 0.15
    """... or the scatter follows it by this share (study: what is left)."""
    rounding: float = 1e-6
    """Share by which numbers differ that say the same: scores, balances, an inertia."""
    negligible: float = 1e-3
    """Share of a number below which another beside it is none: an evolution effect of rate and
    state beside the direct one, a difference of planned travels."""
    fewest: int = 3
    """Runs, or cycles of stick-slip, that show a scatter or a rate, at least."""
    least_variance: float = 0.3
    """Residual variance over that of the weights below which few rows are not believed."""


THRESHOLDS = Thresholds()
