"""The report of a run as a page."""

from functools import partial

from stickslip.report.core.documents import Page, made_sections
from stickslip.report.core.page import render
from stickslip.report.core.versions import colophon
from stickslip.report.runs.appendix import certificate_section, law_section, reproduce_section
from stickslip.report.runs.motion import (
    animation_section,
    criteria_section,
    cycles_section,
    events_section,
    motion_section,
)
from stickslip.report.runs.subject import RunReport
from stickslip.report.runs.summary import opening_section
from stickslip.report.runs.validation import validation_section

SECTIONS = (
    opening_section,
    motion_section,
    validation_section,
    cycles_section,
    animation_section,
    events_section,
    criteria_section,
    law_section,
    certificate_section,
    reproduce_section,
)


def run_page(about: RunReport) -> str:
    """Return the report of a run as one HTML file.

    A section that cannot be made is a line on the page that says why.

    Examples
    --------
    >>> from stickslip import Coulomb, Rig, SpringBlock, simulate
    >>> rig = Rig(title="Block", mechanism=SpringBlock(mass=1.0, stiffness=100.0, compression=0.1))
    >>> law = Coulomb(kinetic_coefficient=0.25)
    >>> run = simulate(rig.mechanism, law, t_end=1.0)
    >>> page = run_page(RunReport(rig=rig, law=law, run=run))
    >>> "The block comes to rest" in page, "could not be made" in page
    (True, False)
    """
    sections = made_sections(*(partial(make, about) for make in SECTIONS))
    return render(
        Page(
            title=f"{about.rig.heading}: {about.law.title} friction",
            subject=about.rig.path or about.rig.heading,
            sections=sections,
            footer=colophon(about.versions),
            kicker="simulation report",
        )
    )
