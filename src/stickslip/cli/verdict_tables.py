"""What ``stickslip select`` prints of a verdict: the laws beside each other, and what is open."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from stickslip.cli.console import NONE, plain, show_table, stdout
from stickslip.cli.inputs import show_estimates, show_open, show_warnings
from stickslip.cli.trials import show_trials
from stickslip.identification.features.features import COMPARED
from stickslip.report.numbers import interval, length, significant
from stickslip.selection import (
    Candidate,
    FeatureCandidate,
    FeatureVerdict,
    RecordCandidate,
    RecordVerdict,
    TravelVerdict,
)
from stickslip.selection.feature_wording import share, signed_share
from stickslip.selection.record_wording import error_text

__all__ = ["AnyVerdict", "show_verdict"]

AnyVerdict = TravelVerdict | RecordVerdict | FeatureVerdict
SHORT = {"standard_deviation": "deviation"}
"""Heads of columns, which are to fit on a terminal of 80 characters."""


class Comparison(NamedTuple):
    """The laws beside each other."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    notes: Sequence[str]
    """Lines below: what became of each law, and why a cell is empty."""


def show_verdict(verdict: AnyVerdict) -> None:
    """Print the verdict, the comparison, the parameters of the law that is named, what is open."""
    words, console = verdict.words, stdout()
    if not isinstance(verdict, TravelVerdict):
        show_warnings(verdict.checks)
    console.print(f"\n{plain(words.verdict)}", markup=False, style="bold")
    console.print(plain(words.lede), markup=False)
    if words.no_score:
        console.print(words.no_score, markup=False, style="dim")
    table = _comparison(verdict)
    console.print()
    whole = () if isinstance(verdict, TravelVerdict) else table.heads
    show_table("", table.heads, table.rows, whole=whole)
    if table.notes and not isinstance(verdict, TravelVerdict):
        console.print()
    for line in table.notes:
        console.print(f"  {plain(line)}", markup=False)
    if not isinstance(verdict, TravelVerdict) and verdict.closest and verdict.closest.fit:
        title = verdict.closest.title + ("" if verdict.best else ", closest but not recommended")
        console.print(f"\n{title}", markup=False, style="bold")
        show_estimates(verdict.closest.fit.estimates)
    if isinstance(verdict, RecordVerdict):
        show_trials(verdict.trials)
    show_open(words)


def _comparison(verdict: AnyVerdict) -> Comparison:
    if isinstance(verdict, TravelVerdict):
        return _of_travels(verdict)
    return _of_records(verdict) if isinstance(verdict, RecordVerdict) else _of_features(verdict)


def _of_travels(verdict: TravelVerdict) -> Comparison:
    heads = ["law", "fitted", "range", "travel", "velocity never < 0"]
    heads += ["held-out error, mm"] if verdict.ranked else []
    everyone = verdict.candidates
    notes = [f"{c.title}: {c.unscored}" for c in everyone if verdict.ranked and c.unscored]
    return Comparison(heads, [_travel_row(c, ranked=verdict.ranked) for c in everyone], notes)


def _travel_row(candidate: Candidate, *, ranked: bool) -> list[str]:
    if candidate.fit is None or candidate.criteria is None:
        return [candidate.title, "no value fits", *[NONE] * (3 + ranked)]
    found = candidate.fit.estimates
    cells = [
        candidate.title,
        ", ".join(f"{e.quantity.symbol} = {significant(e.value, 3)}" for e in found),
        ", ".join(interval(e.low, e.high) for e in found),
        plain(length(candidate.criteria.travel)),
        "yes" if candidate.criteria.velocity_never_negative else "no",
    ]
    score = NONE if candidate.score is None else significant(1e3 * candidate.score, 3)
    return cells + ([score] if ranked else [])


def _of_records(verdict: RecordVerdict) -> Comparison:
    second = any(candidate.second for candidate in verdict.candidates)
    heads = ["law", "free", "held-out error", "±", "last third"]
    heads += ["second record"] if second else []
    rows = [_record_row(c, verdict, second=second) for c in verdict.candidates]
    notes = [f"{one.name}: {one.outcome}" for one in verdict.candidates]
    return Comparison(heads, rows, [*notes, *verdict.missing])


def _record_row(candidate: RecordCandidate, verdict: RecordVerdict, *, second: bool) -> list[str]:
    def told(value: float | None) -> str:
        known = value is not None and math.isfinite(value)
        turning = verdict.measurement.turning
        return error_text(float(value or 0.0), verdict.quantity, turning=turning) if known else NONE

    seen = candidate.validation
    cells = [
        candidate.name,
        str(candidate.parameters) if candidate.fit else NONE,
        told(candidate.score),
        told(seen.error if seen else None),
        told(seen.extrapolation if seen else None),
    ]
    return cells + ([told(candidate.second.rms if candidate.second else None)] if second else [])


def _of_features(verdict: FeatureVerdict) -> Comparison:
    second = any(one.second for one in verdict.candidates)
    heads = ["law", "free", "held-out", "±", *(SHORT.get(name, name) for name in COMPARED)]
    heads += ["second"] if second else []
    rows = [_feature_row(one, one.name, second=second) for one in verdict.candidates]
    if verdict.control:
        name = f"{verdict.control.name}, nominal"
        rows.append(_feature_row(verdict.control, name, second=second))
    return Comparison(heads, rows, [f"{one.name}: {one.outcome}" for one in verdict.candidates])


def _feature_row(one: FeatureCandidate, name: str, *, second: bool) -> list[str]:
    def told(value: float | None) -> str:
        return NONE if value is None or not math.isfinite(value) else signed_share(value)

    cells = [
        name,
        str(one.parameters) if one.fit else NONE,
        share(one.score) if one.fit else NONE,
        share(one.score_error) if math.isfinite(one.score_error) else NONE,
        *(told(one.errors.get(feature)) for feature in COMPARED),
    ]
    size = math.sqrt(sum(e**2 for e in one.second.values()) / max(len(one.second), 1))
    return cells + ([share(size) if one.second else NONE] if second else [])
