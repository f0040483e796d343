"""The opening: the verdict, and the three numbers one would quote."""

from stickslip.formatting import percent, quantity, signed_percent, with_unit, within
from stickslip.kinds.travels.verdict import TravelCandidate, TravelVerdict, estimate_range, misfit
from stickslip.kinds.travels.wording import DOUBT_NAMES, open_ends
from stickslip.report import Fact, Section, opening
from stickslip.selection import score_text


def opening_section(verdict: TravelVerdict, kicker: str, remark: str = "") -> Section:
    """Return the section that a reader may stop after."""
    several = len(verdict.trials) > 1
    return opening(
        verdict.words,
        kicker,
        remark,
        facts=_facts(verdict),
        record="record" if several else "travel",
    )


def _facts(verdict: TravelVerdict) -> tuple[Fact, ...]:
    if verdict.best is None:
        return _facts_of_failure(verdict)
    facts = [_estimate(verdict.best), _as_given(verdict.best)]
    if verdict.best.score is not None:
        facts.append(_score(verdict, verdict.best))
    elif len(verdict.candidates) > 1:
        facts.append(_tie(verdict))
    return tuple(fact for fact in facts if fact is not None)[:3]


def _estimate(best: TravelCandidate) -> Fact | None:
    if best.fit is None or not best.fit.estimates:
        return None
    estimate = best.fit.estimates[0]
    value = within(estimate.value, estimate.low, estimate.high)
    what = f"${estimate.quantity.symbol}$ for {best.title}"
    names = {**DOUBT_NAMES, "stated interval": "interval stated with the measurement"}
    doubt = names.get(estimate.interval, f"{estimate.interval} interval")
    return Fact(
        value=with_unit(estimate.range if estimate.pieces else value, estimate.quantity.unit),
        aside=estimate_range(estimate) if estimate.bounded and not estimate.pieces else "",
        what=f"{what}; the range is the {doubt}"
        if estimate.bounded
        else f"{what} {open_ends(estimate)}",
    )


def _as_given(best: TravelCandidate) -> Fact | None:
    error = best.given.relative_error
    if error is None or best.fit is None or not best.fit.estimates or best.ordinary:
        return None  # nobody gave the values of an ordinary law
    estimate = best.fit.estimates[0]
    name = estimate.path.rpartition(".")[2]
    given = quantity(getattr(best.law, name), estimate.quantity.unit)
    return Fact(
        value=percent(abs(error)),
        aside="too far" if error > 0 else "too short",
        what=f"error of {best.title} as given, with ${estimate.quantity.symbol}$ = {given}",
    )


def _score(verdict: TravelVerdict, best: TravelCandidate) -> Fact:
    scale = verdict.score_scale
    value, doubt = score_text(scale, best.score, best.score_error)
    count = len(verdict.measurement.records())
    return Fact(
        value=value if doubt else with_unit(value, scale.unit),
        aside=with_unit(doubt, scale.unit),
        what=f"held-out error: each of {count} travels predicted from the others, root mean square"
        f"{', ± 1 standard error' if doubt else ''}",
    )


def _tie(verdict: TravelVerdict) -> Fact:
    free = max((len(c.fit.estimates) for c in verdict.explained if c.fit), default=1)
    number = "one number" if free == 1 else f"{free} numbers"
    count = len(verdict.explained)
    return Fact(
        value=f"{count} of {len(verdict.candidates)} models",
        what=f"{'reaches' if count == 1 else 'reach'} {_measured(verdict)} with {number} free",
    )


def _measured(verdict: TravelVerdict) -> str:
    return quantity(verdict.trials[0].travel, "m")


def _facts_of_failure(verdict: TravelVerdict) -> tuple[Fact, ...]:
    one = verdict.closest
    if one is not None and one.fit is not None:
        return (
            Fact(
                value=quantity(misfit(one), "m"),
                what=f"root mean square residual of {one.title}, the best of"
                f" {len(verdict.candidates)} models",
            ),
        )
    closest = min(verdict.candidates, key=lambda c: abs(c.given.relative_error or 0.0))
    error = closest.given.relative_error
    facts = [
        Fact(
            value=f"0 of {len(verdict.candidates)} models",
            what=f"reach {_measured(verdict)} with any value of the free parameter",
        ),
        Fact(
            value=quantity(closest.given.travel, "m"),
            aside="" if error is None else signed_percent(error),
            what=f"travel of the best model, {closest.title}, with the given values",
        ),
    ]
    return tuple(facts)
