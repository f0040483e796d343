"""``stickslip select`` on the force of a spring that pulls a block: by features."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from stickslip.cli.console import (
    NONE,
    command_line,
    document,
    plain,
    show_table,
    stdout,
)
from stickslip.cli.inputs import (
    Asked,
    Measured,
    residuals,
    show_estimates,
    show_open,
    show_warnings,
)
from stickslip.cli.interrupts import Interrupts
from stickslip.cli.process_pool import workers
from stickslip.cli.progress import Searching
from stickslip.cli.selected import deliver, laws_of
from stickslip.experiments import Rig
from stickslip.formatting import percent, signed_percent
from stickslip.friction import FrictionLaw
from stickslip.identification.features.features import COMPARED
from stickslip.report.core.versions import versions
from stickslip.report.features import feature_page
from stickslip.selection import FeatureCandidate, FeatureVerdict, select
from stickslip.selection.feature_wording import share_parts
from stickslip.selection.features import feature_laws

__all__ = ["select_on_features"]

SHORT = {"standard_deviation": "deviation"}
"""Heads of columns, which are to fit on a terminal of 80 characters."""


def select_on_features(
    rig: Rig,
    found: Measured,
    asked: Asked,
    laws: str | None,
    output: Path,
    *,
    jobs: int,
    as_json: bool,
) -> None:
    """Select, write what was found into a folder, print the verdict."""
    verdict = _selected(rig, found, asked, laws_of(rig, laws), jobs)
    content = document("select", {"rig": rig.title, "digest": found.digest, **verdict.to_dict()})
    ended = [c.name for c in verdict.candidates if c.fit and c.fit.cancelled]
    deliver(
        verdict,
        content,
        None if as_json else output,
        page=lambda: _page(verdict, rig, found),
        show=lambda: _show(verdict),
        ended=ended,
    )


def _selected(
    rig: Rig,
    found: Measured,
    asked: Asked,
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | str] | None,
    jobs: int,
) -> FeatureVerdict:
    """Select with a bar; Ctrl-C once ends the search with what there is."""
    names = [one.name for one in feature_laws(laws)]
    with (
        Interrupts() as interrupts,
        Searching(names, residuals(found), interrupts) as watch,
        workers(min(jobs, len(names))) as executor,
    ):
        verdict = select(
            rig.mechanism,
            found.measurement,
            laws,
            unknown=found.unknown,
            route=asked.how.route,
            validate=found.validate,
            settings=asked.how.settings(rig),
            watch=watch,
            executor=executor,
        )
    assert isinstance(verdict, FeatureVerdict)
    return verdict


def _page(verdict: FeatureVerdict, rig: Rig, found: Measured) -> str:
    return feature_page(
        verdict,
        title=rig.title or "Friction model selection",
        kicker=rig.subject,
        subject=Path(rig.path).name,
        digest=found.digest,
        commands=[command_line()],
        versions=versions(),
    )


def _show(verdict: FeatureVerdict) -> None:
    """Print the verdict, the scores, and the parameters of the law that is named."""
    words, console = verdict.words, stdout()
    show_warnings(verdict.checks)
    console.print(f"\n{plain(words.verdict)}", markup=False, style="bold")
    console.print(plain(words.lede), markup=False)
    if words.no_score:
        console.print(words.no_score, markup=False, style="dim")
    console.print()
    second = any(one.second for one in verdict.candidates)
    heads = ["law", "free", "held-out, %", *(SHORT.get(name, name) for name in COMPARED)]
    heads += ["second"] if second else []
    everyone = [*verdict.candidates, *([verdict.control] if verdict.control else [])]
    rows = [_row(one, second=second, nominal=one is verdict.control) for one in everyone]
    show_table("", heads, rows, whole=heads)
    console.print()
    for one in verdict.candidates:
        console.print(f"  {one.name}: {plain(one.outcome)}", markup=False)
    if verdict.best and verdict.best.fit:
        console.print(f"\n{verdict.best.title}", markup=False, style="bold")
        show_estimates(verdict.best.fit.estimates)
    show_open(words)


def _row(one: FeatureCandidate, *, second: bool, nominal: bool) -> list[str]:
    def told(value: float | None) -> str:
        return NONE if value is None or not math.isfinite(value) else signed_percent(value)

    cells = [
        f"{one.name}, nominal" if nominal else one.name,
        str(one.parameters) if one.fit else NONE,
        " ".join(share_parts(one)).strip() if one.fit else NONE,
        *(told(one.errors.get(name)) for name in COMPARED),
    ]
    size = math.sqrt(sum(e**2 for e in one.second.values()) / max(len(one.second), 1))
    return cells + ([percent(size) if one.second else NONE] if second else [])
