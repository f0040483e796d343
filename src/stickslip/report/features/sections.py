"""Sections of the page of a selection on features of stick-slip."""

from stickslip.report.core.documents import PageSections
from stickslip.report.features.appendix import (
    next_section,
    record_section,
    reproduce_section,
)
from stickslip.report.features.force import force_section
from stickslip.report.features.scores import parameters_section, scores_section
from stickslip.report.features.summary import opening_section
from stickslip.selection import FeatureVerdict

feature_sections = PageSections[FeatureVerdict](
    opening=opening_section,
    middle=(
        force_section,
        scores_section,
        parameters_section,
        record_section,
        next_section,
    ),
    reproduce=reproduce_section,
)
"""Makes the sections of a page, in the order in which a reader decides."""
