"""``stickslip select``."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import typer

from stickslip.cli.console import (
    NONE,
    command_line,
    document,
    note,
    overrides,
    plain,
    refuse_overwriting,
    show_table,
    stdout,
)
from stickslip.cli.features import select_on_features
from stickslip.cli.inputs import Asked, Measured, measured, show_open
from stickslip.cli.progress import Watching
from stickslip.cli.select_records import select_on_records
from stickslip.cli.selected import deliver, laws_of
from stickslip.errors import InputError
from stickslip.experiments import Rig, load_rig
from stickslip.formatting import interval, quantity, significant
from stickslip.friction import FrictionLaw
from stickslip.paper import rig_report
from stickslip.selection import Candidate, TravelVerdict, select
from stickslip.selection.travels import PLAIN

__all__ = ["run"]

CRITERIA_FAILED = 4


def run(
    path: Path | None,
    asked: Asked,
    changes: Sequence[str],
    laws: str | None,
    output: Path,
    *,
    jobs: int | None,
    allow_import: bool,
    force: bool,
    as_json: bool,
    enforce: bool,
) -> None:
    """Select, write the report, print the verdict."""
    if not as_json:
        refuse_overwriting(output, output, force=force)
    rig = load_rig(path, overrides=overrides(changes), allow_import=allow_import)
    found = measured(rig, asked, given=path is not None)
    if found.travels:
        if jobs is not None:
            raise InputError("--jobs is for records; travels are fitted one after the other.")
        _travels(rig, found, laws, output, as_json=as_json, enforce=enforce)
        return
    if enforce:
        raise InputError("--enforce is for travels: the criteria of the paper judge these.")
    if found.features:
        select_on_features(rig, found, asked, laws, output, jobs=jobs or 1, as_json=as_json)
        return
    select_on_records(rig, found, asked, laws, output, jobs=jobs or 1, as_json=as_json)


def _travels(
    rig: Rig, found: Measured, laws: str | None, output: Path, *, as_json: bool, enforce: bool
) -> None:
    verdict = _selected(rig, found, laws_of(rig, laws))
    content = document("select", {"rig": rig.title, "digest": found.digest, **verdict.to_dict()})
    seen = replace(rig, digest=found.digest)
    deliver(
        verdict,
        content,
        None if as_json else output,
        page=lambda: rig_report(seen, verdict, command=command_line()),
        show=lambda: _show(verdict),
    )
    if enforce and not _criteria_hold(verdict.best):
        note("A criterion of the paper fails for the law that is named; the report says which.")
        raise typer.Exit(CRITERIA_FAILED)


def _selected(
    rig: Rig, found: Measured, laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | str] | None
) -> TravelVerdict:
    """Select with a bar for what is compiled and one for what is fitted."""
    names = [one if isinstance(one, str) else one.name for one in laws or PLAIN]
    with Watching(names, "Fitting") as watch:
        verdict = select(
            rig.mechanism,
            found.measurement,
            laws,
            unknown=found.unknown,
            assumed=rig.assumed,
            validate=found.validate,
            t_end=rig.t_end,
            watch=watch,
            compiling=watch.compiling,
        )
    assert isinstance(verdict, TravelVerdict)
    return verdict


def _criteria_hold(best: Candidate | None) -> bool:
    seen = best.criteria if best else None
    return bool(seen and seen.velocity_never_negative and seen.displacement_never_decreases)


def _show(verdict: TravelVerdict) -> None:
    """Print the verdict and the comparison."""
    words = verdict.words
    console = stdout()
    console.print(f"\n{plain(words.verdict)}", markup=False, style="bold")
    console.print(plain(words.lede), markup=False)
    if words.no_score:
        console.print(words.no_score, markup=False, style="dim")
    heads = ["law", "fitted", "range", "travel", "velocity never < 0"]
    heads += ["held-out error, mm"] if verdict.ranked else []
    console.print()
    show_table("", heads, [_row(c, ranked=verdict.ranked) for c in verdict.candidates])
    for one in verdict.candidates if verdict.ranked else ():
        if one.unscored:
            console.print(f"  {one.title}: {plain(one.unscored)}", markup=False)
    show_open(words)


def _row(candidate: Candidate, *, ranked: bool) -> list[str]:
    if candidate.fit is None or candidate.criteria is None:
        return [candidate.title, "no value fits", *[NONE] * (3 + ranked)]
    found = candidate.fit.estimates
    cells = [
        candidate.title,
        ", ".join(f"{e.quantity.symbol} = {significant(e.value, 3)}" for e in found),
        ", ".join(interval(e.low, e.high) for e in found),
        plain(quantity(candidate.criteria.travel, "m")),
        "yes" if candidate.criteria.velocity_never_negative else "no",
    ]
    score = NONE if candidate.score is None else significant(1e3 * candidate.score, 3)
    return cells + ([score] if ranked else [])
