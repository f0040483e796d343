"""Sections of the page of a selection on travels."""

from functools import partial

from stickslip.report.core.documents import Origin, SectionMaker
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

__all__ = ["travel_sections"]


def travel_sections(
    verdict: TravelVerdict, origin: Origin, remark: str = ""
) -> tuple[SectionMaker, ...]:
    """Return what makes the sections of a page, in the order in which a reader decides.

    Parameters
    ----------
    verdict : TravelVerdict
        What `stickslip.select` gave; every number of the page is computed from it.
    origin : Origin
        Where it is from.
    remark : str
        A sentence of one's own, at the end of the lede.

    Returns
    -------
    tuple of callable
        One maker per section.
    """
    return (
        partial(opening_section, verdict, origin.data, remark),
        partial(models_section, verdict),
        partial(trials_section, verdict),
        partial(criteria_section, verdict),
        partial(run_section, verdict),
        partial(laws_section, verdict),
        partial(parameters_section, verdict),
        partial(fixed_steps_section, verdict),
        partial(next_section, verdict),
        partial(certificate_section, verdict),
        partial(reproduce_section, verdict, origin),
    )
