"""The page: sections in the order in which a reader decides."""

from collections.abc import Mapping, Sequence
from functools import partial

from stickslip.report.core.documents import (
    Page,
    Section,
    SectionMaker,
    made_sections,
    selection_document,
)
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

__all__ = ["selection_page"]


def selection_page(
    verdict: TravelVerdict,
    *,
    subject: str,
    kicker: str,
    versions: Mapping[str, str],
    digest: str,
    remark: str = "",
    lead: Sequence[Section | SectionMaker] = (),
    extra: Sequence[Section | SectionMaker] = (),
    reproduce: Sequence[str] = (),
) -> Page:
    """Return the report of a selection.

    Parameters
    ----------
    verdict : TravelVerdict
        What `stickslip.select` gave; every number of the page is computed from it.
    subject : str
        The data, at the right of the top line.
    kicker : str
        The data in one line, above the verdict.
    versions : mapping of str to str
        Versions by name of the software; that of ``"stickslip"`` stands in the footer.
    digest : str
        Hash of the inputs.
    remark : str
        A sentence of one's own, at the end of the lede.
    lead, extra : sequence of Section or partial
        Sections of one's own, or functions that make them: after the verdict, and before what to
        measure next.
    reproduce : sequence of str
        Commands that give this report again.

    Returns
    -------
    Page
        The page; a section without content is left out, one that fails becomes one line.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, select
    >>> from stickslip.experiments import Measurement
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> verdict = select(rig, [Coulomb], reading, t_end=1.0)
    >>> page = selection_page(verdict, subject="rig", kicker="One travel", versions={}, digest="")
    >>> page.sections[0].id
    'verdict'
    """
    sections = made_sections(
        partial(opening_section, verdict, kicker, remark),
        *lead,
        partial(models_section, verdict),
        partial(trials_section, verdict),
        partial(criteria_section, verdict),
        partial(run_section, verdict),
        partial(laws_section, verdict),
        partial(parameters_section, verdict),
        partial(fixed_steps_section, verdict),
        *extra,
        partial(next_section, verdict),
        partial(certificate_section, verdict),
        partial(reproduce_section, verdict, reproduce, versions, digest),
    )
    return selection_document(sections, title=subject, subject=subject, versions=versions)
