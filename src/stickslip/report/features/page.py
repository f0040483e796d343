"""The page: sections in the order in which a reader decides."""

from collections.abc import Mapping, Sequence
from functools import partial

from stickslip.report.core.documents import Page, Section, made_sections, selection_document
from stickslip.report.core.page import render
from stickslip.report.features.appendix import next_section, record_section, reproduce_section
from stickslip.report.features.force import force_section
from stickslip.report.features.scores import parameters_section, scores_section
from stickslip.report.features.summary import opening_section
from stickslip.selection import FeatureVerdict

__all__ = ["feature_document", "feature_page"]


def feature_document(
    verdict: FeatureVerdict,
    *,
    title: str,
    kicker: str,
    commands: Sequence[str] = (),
    versions: Mapping[str, str],
    digest: str = "",
    subject: str = "",
    extra: Sequence[Section] = (),
) -> Page:
    """Return the report of a selection on features of stick-slip, section by section.

    Parameters
    ----------
    verdict : FeatureVerdict
        What `stickslip.select` gave; every number of the page is computed from it.
    title : str
        What was measured, for the title of the page.
    kicker : str
        The data in one line, above the verdict.
    commands : sequence of str
        Commands that give this report again.
    versions : mapping of str to str
        Versions by name of the software; that of ``"stickslip"`` stands in the footer.
    digest : str
        Hash of the inputs.
    subject : str
        The data, at the right of the top line; the title if not given.
    extra : sequence of Section
        Sections of one's own, before how to reproduce the report.

    Returns
    -------
    Page
        The page; a section without content is left out.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Coulomb, Measurement, TowedBlock, select, simulate
    >>> block = TowedBlock(mass=0.03, stiffness=1000.0, speed=4e-3)
    >>> truth = Coulomb(kinetic_coefficient=0.28, static_coefficient=0.32)
    >>> t = np.linspace(0.5, 4.5, 8001)
    >>> run = simulate(block, truth, t_end=4.5).at(t)
    >>> record = Measurement(time=t, spring_force=1000.0 * (4e-3 * t - run["x"]))
    >>> verdict = select(block, [Coulomb], record)
    >>> page = feature_document(verdict, title="Slider", kicker="made up", versions={})
    >>> [section.id for section in page.sections][:3]
    ['verdict', 'force', 'scores']
    """
    sections = made_sections(
        partial(opening_section, verdict, kicker),
        partial(force_section, verdict),
        partial(scores_section, verdict),
        partial(parameters_section, verdict),
        partial(record_section, verdict),
        partial(next_section, verdict),
        *extra,
        partial(reproduce_section, verdict, commands, versions, digest),
    )
    return selection_document(sections, title=title, subject=subject, versions=versions)


def feature_page(
    verdict: FeatureVerdict,
    *,
    title: str,
    kicker: str,
    commands: Sequence[str] = (),
    versions: Mapping[str, str],
    digest: str = "",
    subject: str = "",
    extra: Sequence[Section] = (),
) -> str:
    """Return the report of a selection on features of stick-slip as one HTML file.

    Arguments as in `feature_document`, which gives the sections to write or extend.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Coulomb, Measurement, TowedBlock, select, simulate
    >>> block = TowedBlock(mass=0.03, stiffness=1000.0, speed=4e-3)
    >>> truth = Coulomb(kinetic_coefficient=0.28, static_coefficient=0.32)
    >>> t = np.linspace(0.5, 4.5, 8001)
    >>> run = simulate(block, truth, t_end=4.5).at(t)
    >>> record = Measurement(time=t, spring_force=1000.0 * (4e-3 * t - run["x"]))
    >>> verdict = select(block, [Coulomb], record)
    >>> feature_page(verdict, title="Slider", kicker="made up", versions={})[:15]
    '<!doctype html>'
    """
    return render(
        feature_document(
            verdict,
            title=title,
            kicker=kicker,
            commands=commands,
            versions=versions,
            digest=digest,
            subject=subject,
            extra=extra,
        )
    )
