"""Sections of the page of a selection on records."""

from stickslip.report.core.blocks import Paragraph
from stickslip.report.core.documents import PageSections, Section
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


def trials_section(verdict: RecordVerdict) -> Section | None:
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


record_sections = PageSections[RecordVerdict](
    opening=opening_section,
    middle=(
        map_section,
        loops_section,
        scores_section,
        second_section,
        trials_section,
        parameters_section,
        residuals_section,
        dropped_section,
        record_section,
        certificate_section,
        next_section,
    ),
    reproduce=reproduce_section,
)
"""Makes the sections of a page, in the order in which a reader decides."""
