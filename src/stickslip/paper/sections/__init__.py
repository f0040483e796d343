"""The audit as sections of a page: headings state what was found."""

from stickslip.paper.sections.assumptions import assumption_section
from stickslip.paper.sections.cart import cart_section, choice_section
from stickslip.paper.sections.claims import claim_section
from stickslip.paper.sections.equations import equation_section, misprint_section
from stickslip.paper.sections.excitation import excitation_section
from stickslip.paper.sections.figures import figure_section, phenomena_section, schematic_section
from stickslip.paper.sections.rest import break_away_section, rest_section
from stickslip.paper.sections.table import ranking_section, table_section
from stickslip.paper.sections.unpublished import trial_section, unpublished_section

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
