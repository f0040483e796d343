"""Sections of the page of a selection on features of stick-slip."""

from functools import partial

from stickslip.report.core.documents import Origin, SectionMaker
from stickslip.report.features.appendix import (
    next_section,
    record_section,
    reproduce_section,
)
from stickslip.report.features.force import force_section
from stickslip.report.features.scores import parameters_section, scores_section
from stickslip.report.features.summary import opening_section
from stickslip.selection import FeatureVerdict

__all__ = ["feature_sections"]


def feature_sections(
    verdict: FeatureVerdict, origin: Origin, remark: str = ""
) -> tuple[SectionMaker, ...]:
    """Return what makes the sections of a page, in the order in which a reader decides.

    Parameters
    ----------
    verdict : FeatureVerdict
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
        partial(force_section, verdict),
        partial(scores_section, verdict),
        partial(parameters_section, verdict),
        partial(record_section, verdict),
        partial(next_section, verdict),
        partial(reproduce_section, verdict, origin),
    )
