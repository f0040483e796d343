"""The page of a selection, by whatever laws were compared."""

from collections.abc import Sequence

from stickslip.kinds.registry import kind_of_route
from stickslip.report import Origin, Page, Section, SectionMaker, colophon, made_sections
from stickslip.selection import Verdict

LAST = ("next_section", "certificate_section", "reproduce_section")
"""What stays at the end, after sections of one's own."""


def verdict_page(
    verdict: Verdict,
    origin: Origin,
    *,
    remark: str = "",
    lead: Sequence[Section | SectionMaker] = (),
    extra: Sequence[Section | SectionMaker] = (),
) -> Page:
    """Return the page of a selection, section by section.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, select
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> verdict = select(rig, [Coulomb], reading, t_end=1.0)
    >>> page = verdict_page(verdict, Origin(title="Block", data="one travel"))
    >>> page.title, page.sections[0].id, page.sections[-1].id
    ('Friction model selection: Block', 'verdict', 'reproduce')
    """
    first, *others = kind_of_route(verdict.route).sections(verdict, origin, remark)
    before = [one for one in others if one.func.__name__ not in LAST]
    after = [one for one in others if one.func.__name__ in LAST]
    return Page(
        title=f"Friction model selection: {origin.title}",
        subject=origin.file or origin.title,
        sections=made_sections(first, *lead, *before, *extra, *after),
        footer=colophon(origin.versions),
    )
