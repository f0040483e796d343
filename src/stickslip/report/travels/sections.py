"""Sections of the page of a selection on travels."""

from stickslip.report.core.documents import PageSections
from stickslip.report.travels.appendix import (
    certificate_section,
    next_section,
    parameters_section,
    reproduce_section,
)
from stickslip.report.travels.criteria import criteria_section
from stickslip.report.travels.models import models_section
from stickslip.report.travels.runs import fixed_steps_section, laws_section, run_section
from stickslip.report.travels.summary import opening_section
from stickslip.report.travels.trials import trials_section
from stickslip.selection import TravelVerdict

travel_sections = PageSections[TravelVerdict](
    opening=opening_section,
    middle=(
        models_section,
        trials_section,
        criteria_section,
        run_section,
        laws_section,
        parameters_section,
        fixed_steps_section,
        next_section,
        certificate_section,
    ),
    reproduce=reproduce_section,
)
"""Makes the sections of a page, in the order in which a reader decides."""
