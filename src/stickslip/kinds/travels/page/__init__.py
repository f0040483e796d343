"""What the page of a selection on travels shows, in the order in which a reader decides."""

from stickslip.kinds.travels.page.appendix import (
    certificate_section,
    next_section,
    parameters_section,
    reproduce_section,
)
from stickslip.kinds.travels.page.criteria import criteria_section
from stickslip.kinds.travels.page.models import models_section
from stickslip.kinds.travels.page.opening import opening_section
from stickslip.kinds.travels.page.runs import fixed_steps_section, laws_section, run_section
from stickslip.kinds.travels.page.trials import trials_section
from stickslip.kinds.travels.verdict import TravelVerdict
from stickslip.report import PageSections

sections = PageSections[TravelVerdict](
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
"""Makes the sections of a page."""
