"""Sections of the page of a selection on records."""

from functools import partial

from stickslip.report.core.blocks import Paragraph
from stickslip.report.core.documents import Origin, Section, SectionMaker
from stickslip.report.core.markup import typeset
from stickslip.report.records.appendix import dropped_section, next_section, record_section
from stickslip.report.records.certificate import certificate_section
from stickslip.report.records.friction import map_section
from stickslip.report.records.loops import loops_section
from stickslip.report.records.parameters import parameters_section
from stickslip.report.records.reproduce import reproduce_section
from stickslip.report.records.residuals import residuals_section
from stickslip.report.records.scores import scores_section
from stickslip.report.records.summary import opening_section
from stickslip.report.records.texts import symbols_of
from stickslip.report.records.validation_record import second_section
from stickslip.selection import RecordVerdict

__all__ = ["record_sections"]


def record_sections(
    verdict: RecordVerdict, origin: Origin, remark: str = ""
) -> tuple[SectionMaker, ...]:
    """Return what makes the sections of a page, in the order in which a reader decides.

    Parameters
    ----------
    verdict : RecordVerdict
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
        partial(map_section, verdict),
        partial(loops_section, verdict),
        partial(scores_section, verdict),
        partial(second_section, verdict),
        partial(_trials_section, verdict),
        partial(parameters_section, verdict),
        partial(residuals_section, verdict),
        partial(dropped_section, verdict),
        partial(record_section, verdict),
        partial(certificate_section, verdict),
        partial(next_section, verdict),
        partial(reproduce_section, verdict, origin),
    )


def _trials_section(verdict: RecordVerdict) -> Section | None:
    """Return the section on the trials, None where there was nothing to compare."""
    found = verdict.trials
    if found is None:
        return None
    symbols = symbols_of(verdict.candidates)
    heading = "The trials share one law" if found.shared else "The trials do not share one law"
    return Section(
        id="trials",
        nav="Trials",
        heading=heading,
        blocks=tuple(Paragraph(text=typeset(line, symbols)) for line in found.sentences),
    )
