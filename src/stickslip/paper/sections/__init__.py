"""The audit as sections of a page: headings state what was found."""

from stickslip.paper.sections.cart import (
    break_away_section,
    cart_section,
    choice_section,
    rest_section,
)
from stickslip.paper.sections.claims import claim_section, trial_section, unpublished_section
from stickslip.paper.sections.equations import (
    assumption_section,
    equation_section,
    excitation_section,
    misprint_section,
)
from stickslip.paper.sections.table import (
    figure_section,
    phenomena_section,
    ranking_section,
    schematic_section,
    table_section,
)

__all__ = [
    "assumption_section",
    "break_away_section",
    "cart_section",
    "choice_section",
    "claim_section",
    "equation_section",
    "excitation_section",
    "figure_section",
    "misprint_section",
    "phenomena_section",
    "ranking_section",
    "rest_section",
    "schematic_section",
    "table_section",
    "trial_section",
    "unpublished_section",
]
