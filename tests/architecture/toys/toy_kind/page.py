"""The page of a selection on a steady speed."""

from stickslip.report import Paragraph, Section

from .verdict import ToyVerdict


def toy_section(verdict: ToyVerdict) -> Section:
    """Return what there is to say."""
    return Section(
        id="verdict", nav="Verdict", heading="Toy", blocks=(Paragraph(text=verdict.sentence),)
    )
