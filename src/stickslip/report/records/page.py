"""The page: sections in the order in which a reader decides."""

from collections.abc import Mapping, Sequence
from functools import partial

from stickslip.report.core.documents import Page, Section, made_sections, selection_document
from stickslip.report.core.page import render
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

__all__ = ["record_document", "record_page"]


def record_document(
    verdict: RecordVerdict,
    *,
    title: str,
    kicker: str,
    commands: Sequence[str] = (),
    versions: Mapping[str, str],
    digest: str = "",
    files: Mapping[str, str] | None = None,
    subject: str = "",
    remark: str = "",
    extra: Sequence[Section] = (),
) -> Page:
    """Return the report of a selection on records, section by section.

    Parameters
    ----------
    verdict : RecordVerdict
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
    files : mapping of str to str, optional
        SHA-256 of each file of data by its name.
    subject : str
        The data, at the right of the top line; the title if not given.
    remark : str
        A sentence of one's own, at the end of the lede.
    extra : sequence of Section
        Sections of one's own, before how to reproduce the report.

    Returns
    -------
    Page
        The page; a section without content is left out.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Axis, Coulomb, Measurement, select
    >>> v = np.linspace(-1.0, 1.0, 80)
    >>> table = Measurement(velocity=v, friction=2.0 * np.sign(v) + 0.01 * np.cos(40.0 * v))
    >>> verdict = select(Axis(inertia=1.0), [Coulomb], table)
    >>> page = record_document(verdict, title="Table", kicker="80 points", versions={})
    >>> [section.id for section in page.sections][:3]
    ['verdict', 'map', 'scores']
    """
    sections = made_sections(
        partial(opening_section, verdict, kicker, remark),
        partial(map_section, verdict),
        partial(loops_section, verdict),
        partial(scores_section, verdict),
        partial(second_section, verdict),
        partial(trials_section, verdict),
        partial(parameters_section, verdict),
        partial(residuals_section, verdict),
        partial(dropped_section, verdict),
        partial(record_section, verdict),
        partial(certificate_section, verdict),
        partial(next_section, verdict),
        *extra,
        partial(reproduce_section, verdict, commands, versions, digest, files or {}),
    )
    return selection_document(sections, title=title, subject=subject, versions=versions)


def record_page(
    verdict: RecordVerdict,
    *,
    title: str,
    kicker: str,
    commands: Sequence[str] = (),
    versions: Mapping[str, str],
    digest: str = "",
    files: Mapping[str, str] | None = None,
    subject: str = "",
    remark: str = "",
    extra: Sequence[Section] = (),
) -> str:
    """Return the report of a selection on records as one HTML file.

    Arguments as in `record_document`, which gives the sections to write or extend.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Axis, Coulomb, Measurement, select
    >>> v = np.linspace(-1.0, 1.0, 80)
    >>> table = Measurement(velocity=v, friction=2.0 * np.sign(v) + 0.01 * np.cos(40.0 * v))
    >>> verdict = select(Axis(inertia=1.0), [Coulomb], table)
    >>> record_page(verdict, title="Table", kicker="80 points", versions={})[:15]
    '<!doctype html>'
    """
    return render(
        record_document(
            verdict,
            title=title,
            kicker=kicker,
            commands=commands,
            versions=versions,
            digest=digest,
            files=files,
            subject=subject,
            remark=remark,
            extra=extra,
        )
    )
