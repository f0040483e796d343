"""A verdict as files: a page, a JSON document, the law as a rig, and laws drawn beside it."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import astuple, fields
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, law_type, laws
from stickslip.identify import BandVerdict, CurvePoint, MeasuredCurve, MeasuredCurves
from stickslip.identify.candidates import Verdict
from stickslip.identify.kinds.registry import kind_of_route
from stickslip.identify.kinds.travels import TravelVerdict
from stickslip.show.documents import document, json_text, sha256_of, write_folder
from stickslip.show.report import (
    Origin,
    Page,
    Section,
    SectionMaker,
    colophon,
    made_sections,
    render,
)

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
    before = [other for other in others if other.func.__name__ not in LAST]
    after = [other for other in others if other.func.__name__ in LAST]
    return Page(
        title=f"Friction model selection: {origin.title}",
        subject=origin.file or origin.title,
        sections=made_sections(first, *lead, *before, *extra, *after),
        footer=colophon(origin.versions),
    )


PAGE, DOCUMENT, LAW_FILE, DRAWS_FILE = "index.html", "verdict.json", "law.toml", "draws.json"
VERDICT_FILES = (PAGE, DOCUMENT, LAW_FILE, DRAWS_FILE)
"""What is written into a folder."""
DRAWS = 100
"""Laws that are drawn for ensembles of runs: the most that a command takes."""


def write_report(
    verdict: Verdict,
    folder: str | Path,
    *,
    title: str = "",
    subject: str = "",
    digest: str = "",
    commands: Sequence[str] = (),
    overwrite: bool = False,
) -> Path:
    """Write what ``stickslip select`` writes of a verdict into a folder.

    These are ``index.html``, the report as one page that needs nothing else; ``verdict.json``, all
    that the verdict says as numbers and texts; and ``law.toml``, mechanism and law with their
    fitted values, which `load_rig` reads and ``stickslip simulate`` takes; and of a verdict with a
    band ``draws.json``, 100 laws drawn over it, which ``stickslip sweep --ensemble`` takes.
    There is no ``law.toml`` without a law to name, nor of laws that are not simulated. The
    command's page of the bundled rig also audits the source paper.

    Parameters
    ----------
    verdict : Verdict
        What `select` gave.
    folder : str or Path
        Made if it is not there.
    title : str
        What was measured, for the title of the page; the kind of mechanism if not given.
    subject : str
        The data in one line; if not given what the measurement says of where it is from.
    digest : str
        Hash of the inputs, to be shown.
    commands : sequence of str
        Commands that give this report again, to be shown.
    overwrite : bool
        Whether files of an earlier report in the folder may be replaced, if they are as they were
        written.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    InputError
        If a report is already there, a file in the way was not written here or was changed, or
        the folder cannot be written to.

    Examples
    --------
    >>> import tempfile
    >>> from stickslip import Coulomb, Measurement, SpringBlock, load_rig, select
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> verdict = select(rig, [Coulomb], reading, t_end=1.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     page = write_report(verdict, folder, title="Block")
    ...     law = load_rig(page.with_name("law.toml")).laws["coulomb"]
    ...     sorted(file.name for file in page.parent.glob("[!.]*"))
    ['draws.json', 'index.html', 'law.toml', 'verdict.json']
    >>> f"{law.kinetic_coefficient:.3f}"
    '0.255'
    """
    if not isinstance(verdict, Verdict):
        raise InputError(f"a report is of a verdict of `select`, got {type(verdict).__name__}.")
    folder = Path(folder)
    title = title or verdict.mechanism.title
    origin = Origin(
        title=title,
        data=subject or verdict.measurement.provenance or verdict.mechanism.title,
        digest=digest,
        commands=tuple(commands),
    )
    there = [name for name in VERDICT_FILES if (folder / name).exists()]
    if there and not overwrite:
        raise InputError(
            f"{folder / there[0]} already exists: give overwrite=True to replace it, or another"
            " folder."
        )
    content = document("select", {"rig": title, "digest": digest, **verdict.to_dict()})
    write_verdict(folder, verdict, content, page=render(verdict_page(verdict, origin)))
    return folder / PAGE


def write_verdict(
    folder: Path,
    verdict: Verdict,
    content: Mapping[str, Any],
    *,
    page: str | None = None,
) -> None:
    """Write a verdict as its page, document, law and draws, over those of an earlier one.

    All appear at once. What this verdict does not have is removed of an earlier one: a page that
    could not be drawn, a law where none is named. Files that were not written here stay.

    Examples
    --------
    >>> import tempfile
    >>> from stickslip import Coulomb, Measurement, SpringBlock, select
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> verdict = select(rig, [Coulomb], reading, t_end=1.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_verdict(Path(folder), verdict, {})
    ...     sorted(file.name for file in Path(folder).glob("[!.]*"))
    ['draws.json', 'law.toml', 'verdict.json']
    """
    files: dict[str, str | bytes] = {} if page is None else {PAGE: page}
    files[DOCUMENT] = json_text(content)
    saved = kind_of_route(verdict.route).simulated
    if saved and verdict.best is not None and verdict.best.fit is not None:
        law = verdict.best.fit.to_toml()
        files[LAW_FILE] = law
        if (draws := _draws(verdict, law)) is not None:
            files[DRAWS_FILE] = json_text(document("draws", draws))
    write_folder(folder, files, stale=VERDICT_FILES)


def _draws(verdict: Verdict, law: str) -> dict[str, Any] | None:
    """Return laws that are not excluded, for runs elsewhere; None of joints, or of own classes."""
    if not isinstance(verdict, BandVerdict | TravelVerdict):
        return None
    drawn = verdict.sample(DRAWS)
    known = laws()
    if any(
        not isinstance(item, MeasuredCurve | MeasuredCurves)
        and item.composition is None
        and item.name not in known
        for item in drawn
    ):
        return None  # of a class of somebody, which no file names
    rows = [_row(item) for item in drawn]
    error = None
    if isinstance(verdict, TravelVerdict) and all(t.cycles is not None for t in verdict.trials):
        error = verdict.prediction_error
        error = error if np.isfinite(error) else None
    return {"law_file": sha256(law.encode()).hexdigest(), "velocity_error": error, "laws": rows}


def _row(law: FrictionLaw) -> dict[str, Any]:
    if isinstance(law, MeasuredCurve | MeasuredCurves):
        both = [law] if isinstance(law, MeasuredCurve) else [law.forward, law.backward]
        return {"law": law.name, "points": [[astuple(x) for x in item.points] for item in both]}
    name = law.name if law.name in laws() else str(law.composition)
    return {"law": name} | {field.name: getattr(law, field.name) for field in fields(law)}


def _law(row: dict[str, Any]) -> FrictionLaw:
    name, values = row["law"], {key: value for key, value in row.items() if key != "law"}
    if name in (MeasuredCurve.name, MeasuredCurves.name):
        keys = [field.name for field in fields(CurvePoint)]
        ahead, *back = (
            MeasuredCurve(points=tuple(CurvePoint(**dict(zip(keys, x, strict=True))) for x in item))
            for item in values["points"]
        )
        return MeasuredCurves(forward=ahead, backward=back[0]) if back else ahead
    result: FrictionLaw = law_type(name)(**values)
    return result


def drawn_laws(law_file: str | Path) -> tuple[list[FrictionLaw], float] | None:
    """Return the laws that were drawn beside a law file, and the error of mean velocities [m/s].

    The file is the ``law.toml`` that a selection wrote; None where no laws were drawn beside it, or
    for another one. By the error predictions of mean velocities are off beside what the laws tell.

    Examples
    --------
    >>> import tempfile
    >>> from stickslip import Axis, Coulomb, Measurement, select
    >>> v = np.linspace(0.1, 1.0, 10)
    >>> noise = 0.01 * np.random.default_rng(1).normal(size=10)
    >>> verdict = select(Axis(inertia=1.0), [Coulomb], Measurement(velocity=v, friction=2 + noise))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_verdict(Path(folder), verdict, {})
    ...     drawn, error = drawn_laws(Path(folder) / "law.toml")
    >>> len(drawn), drawn[0] == verdict.sample(1)[0], error
    (100, True, 0.0)
    """
    file = Path(law_file).with_name(DRAWS_FILE)
    if not file.is_file():
        return None
    result = json.loads(file.read_text(encoding="utf-8"))
    if result["law_file"] != sha256_of(Path(law_file)):
        return None
    return [_law(row) for row in result["laws"]], result["velocity_error"] or 0.0
