"""Several trials: whether they share the law."""

from stickslip.report.core.blocks import Paragraph
from stickslip.report.core.documents import Section
from stickslip.report.records.texts import symbols_of, typeset
from stickslip.selection import RecordVerdict

__all__ = ["trials_section"]


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
