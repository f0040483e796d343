"""Sections of the page of a selection on records."""

from stickslip.report.core.documents import PageSections
from stickslip.report.records.appendix import dropped_section, next_section, record_section
from stickslip.report.records.certificate import certificate_section
from stickslip.report.records.friction import map_section
from stickslip.report.records.loops import loops_section
from stickslip.report.records.parameters import parameters_section
from stickslip.report.records.reproduce import reproduce_section
from stickslip.report.records.residuals import residuals_section
from stickslip.report.records.scores import scores_section
from stickslip.report.records.summary import opening_section
from stickslip.report.records.trials import trials_section
from stickslip.report.records.validation_record import second_section
from stickslip.selection import RecordVerdict

__all__ = ["record_sections"]


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
