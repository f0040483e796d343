"""What ``stickslip select`` prints of a verdict: the laws beside each other, and what is open."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

from stickslip.cli.console import NONE, plain, show_table, stdout
from stickslip.cli.inputs import show_estimates, show_open, show_warnings
from stickslip.cli.trials import show_trials
from stickslip.experiments import Checks
from stickslip.formatting import interval, percent, quantity, signed_percent, significant
from stickslip.identification import Estimate, TrialComparison
from stickslip.identification.features.features import COMPARED
from stickslip.identification.travels.model import Trial, quantities_read, trials_of
from stickslip.selection import (
    Candidate,
    FeatureCandidate,
    FeatureVerdict,
    RecordCandidate,
    RecordVerdict,
    TravelVerdict,
)
from stickslip.selection.feature_wording import share_parts
from stickslip.selection.verdict import score_text

__all__ = ["AnyVerdict", "show_verdict"]

AnyVerdict: TypeAlias = TravelVerdict | RecordVerdict | FeatureVerdict
SHORT = {"standard_deviation": "deviation"}
"""Heads of columns, which are to fit on a terminal of 80 characters."""


class Comparison(NamedTuple):
    """The laws beside each other, and what stands above and below."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    notes: Sequence[str] = ()
    """Lines below: what became of each law, and why a cell is empty."""
    checks: Checks | None = None
    """What is doubtful about the record."""
    fitted: tuple[str, Sequence[Estimate]] | None = None
    """The law that is named or closest, with its parameters, where the table does not have them."""
    trials: TrialComparison | None = None
    """Whether several trials share one law."""


def show_verdict(verdict: AnyVerdict) -> None:
    """Print the verdict, the comparison, the parameters of the law that is named, what is open."""
    words, console = verdict.words, stdout()
    table = COMPARISONS[type(verdict)](verdict)
    if table.checks:
        show_warnings(table.checks)
    console.print(f"\n{plain(words.verdict)}", markup=False, style="bold")
    console.print(plain(words.lede), markup=False)
    if words.no_score:
        console.print(words.no_score, markup=False, style="dim")
    console.print()
    show_table("", table.heads, table.rows, whole=table.heads if table.fitted else ())
    if table.notes:
        console.print()
    for line in table.notes:
        console.print(f"  {plain(line)}", markup=False)
    if table.fitted:
        title, estimates = table.fitted
        console.print(f"\n{title}", markup=False, style="bold")
        show_estimates(estimates)
    show_trials(table.trials)
    show_open(words)


def _of_travels(verdict: TravelVerdict) -> Comparison:
    trials = trials_of(verdict.mechanism, verdict.measurement, verdict.t_end)
    read = quantities_read(trials)
    heads = ["law", "fitted", "range", "travel", *([read] if read else []), "velocity never < 0"]
    heads += ["held-out error, mm"] if verdict.ranked else []
    everyone = verdict.candidates
    notes = [f"{c.title}: {c.unscored}" for c in everyone if verdict.ranked and c.unscored]
    first = trials[0] if read else None
    rows = [_travel_row(c, first, ranked=verdict.ranked) for c in everyone]
    return Comparison(heads, rows, notes)


def _travel_row(candidate: Candidate, first: Trial | None, *, ranked: bool) -> list[str]:
    """Return a row; with the first trial, where other quantities than travels were read."""
    if candidate.fit is None or candidate.criteria is None:
        rest = 3 + (first is not None) + ranked
        return [candidate.title, "no value fits", *[NONE] * rest]
    found = candidate.fit.estimates
    cells = [
        candidate.title,
        ", ".join(f"{e.quantity.symbol} = {significant(e.value, 3)}" for e in found),
        ", ".join(interval(e.low, e.high) for e in found),
        plain(quantity(candidate.criteria.travel, "m")),
        *([] if first is None else [plain(first.as_read(candidate.criteria.travel))]),
        "yes" if candidate.criteria.velocity_never_negative else "no",
    ]
    score = NONE if candidate.score is None else significant(1e3 * candidate.score, 3)
    return cells + ([score] if ranked else [])


def _of_records(verdict: RecordVerdict) -> Comparison:
    second = any(candidate.second for candidate in verdict.candidates)
    unit = verdict.scale.unit
    heads = ["law", "free", f"held-out error, {unit}", f"last third, {unit}"]
    heads += [f"second record, {unit}"] if second else []
    notes = [f"{one.name}: {one.outcome}" for one in verdict.candidates]
    closest = verdict.closest
    title = closest.title + ("" if verdict.best else ", closest but not recommended")
    return Comparison(
        heads=heads,
        rows=[_record_row(c, verdict, second=second) for c in verdict.candidates],
        notes=[*notes, *verdict.missing],
        checks=verdict.checks,
        fitted=(title, closest.fit.estimates) if closest.fit else None,
        trials=verdict.trials,
    )


def _record_row(candidate: RecordCandidate, verdict: RecordVerdict, *, second: bool) -> list[str]:
    scale = verdict.scale

    def shown(value: float | None) -> str:
        return NONE if value is None or not math.isfinite(value) else scale.number(value)

    seen = candidate.validation
    score = " ".join(score_text(scale, candidate.score, candidate.score_error)).strip()
    cells = [
        candidate.name,
        str(candidate.parameters) if candidate.fit else NONE,
        score if candidate.fit else NONE,
        shown(seen.extrapolation if seen else None),
    ]
    return cells + ([shown(candidate.second.rms if candidate.second else None)] if second else [])


def _of_features(verdict: FeatureVerdict) -> Comparison:
    second = any(one.second for one in verdict.candidates)
    heads = ["law", "free", "held-out, %", *(SHORT.get(name, name) for name in COMPARED)]
    heads += ["second"] if second else []
    rows = [_feature_row(one, one.name, second=second) for one in verdict.candidates]
    if verdict.control:
        name = f"{verdict.control.name}, nominal"
        rows.append(_feature_row(verdict.control, name, second=second))
    best = verdict.best
    return Comparison(
        heads=heads,
        rows=rows,
        notes=[f"{one.name}: {one.outcome}" for one in verdict.candidates],
        checks=verdict.checks,
        fitted=(best.title, best.fit.estimates) if best and best.fit else None,
    )


def _feature_row(one: FeatureCandidate, name: str, *, second: bool) -> list[str]:
    def shown(value: float | None) -> str:
        return NONE if value is None or not math.isfinite(value) else signed_percent(value)

    cells = [
        name,
        str(one.parameters) if one.fit else NONE,
        " ".join(share_parts(one)).strip() if one.fit else NONE,
        *(shown(one.errors.get(feature)) for feature in COMPARED),
    ]
    size = math.sqrt(sum(e**2 for e in one.second.values()) / max(len(one.second), 1))
    return cells + ([percent(size) if one.second else NONE] if second else [])


COMPARISONS: Mapping[type, Callable[[Any], Comparison]] = {
    TravelVerdict: _of_travels,
    RecordVerdict: _of_records,
    FeatureVerdict: _of_features,
}
