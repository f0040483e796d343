"""The verdict on velocity steps in words. Symbols stand between dollar signs."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stickslip.data import Checks, sentences_of
from stickslip.friction import RATE_STATE_FORMS
from stickslip.identify import THRESHOLDS
from stickslip.identify.candidates import (
    LEFT_OUT,
    MOST,
    ONE_LAW,
    Wording,
    corrections,
    outcome_beside,
    score_text,
)
from stickslip.identify.kinds.velocity_steps.load_point import SHORTEST
from stickslip.identify.kinds.velocity_steps.result import RateStateFit
from stickslip.identify.kinds.velocity_steps.verdict import OtherStep, RateStateCandidate
from stickslip.show.formatting import Scale, capital, joined, quantity, ratio, significant, span

PLAIN = Scale(1.0, "")
DISTANCES = ("friction.critical_distance", "friction.second_critical_distance")
OWN = ("a", "b", "D_c", "b_2", "D_2", "c")
"""Symbols of what a law adds to its level, in the order in which they are told."""


def score_of(one: RateStateCandidate) -> str:
    """Return a held-out error with its standard error, such as ``0.00050 ± 0.00002``."""
    return " ".join(score_text(PLAIN, one.score, one.score_error)).strip()


def outcomes(
    ordered: Sequence[RateStateCandidate],
    rival: RateStateCandidate | None,
    *,
    recommended: bool,
) -> list[RateStateCandidate]:
    """Add to each candidate, the closest first, what became of it."""
    return [
        replace(
            one,
            outcome=outcome_beside(
                one,
                ordered[0],
                tied=rival is not None and one.name == rival.name,
                recommended=recommended,
            ),
        )
        for one in ordered
    ]


def rate_state_wording(
    ordered: Sequence[RateStateCandidate],
    rival: RateStateCandidate | None,
    steps: Sequence[OtherStep],
    checks: Checks,
    *,
    fault: str,
    by_steps: bool,
) -> Wording:
    """Put a selection on velocity steps into words."""
    fit = ordered[0].fit
    assert fit is not None
    return Wording(
        verdict=_verdict(ordered, fit, rival, fault),
        lede=_lede(ordered, fit, fault, by_steps=by_steps),
        settles=_settles(fit),
        cannot_tell=_cannot_tell(fit, rival, by_steps=by_steps),
        measure_next=(
            *_untried(ordered, fit),
            *_measure_next(fit, rival, steps, checks, by_steps=by_steps),
        )[:MOST],
        no_score=_no_score(ordered, rival),
    )


def _unfitted(
    ordered: Sequence[RateStateCandidate], fit: RateStateFit
) -> tuple[list[str], list[str]]:
    """Return which further forms were not tried, and whose fit failed.

    These have two states or another evolution. Where a fit leaves noise alone, none is named.
    """
    forms = [name for name, form in RATE_STATE_FORMS.items() if form.evolution != "none"]
    fitted = {one.law.name for one in ordered if one.law is not None}
    failed = {one.name for one in ordered if one.law is None and one.dropped != LEFT_OUT}
    if not fit.misses:
        return [], []
    rest = [name for name in forms if name not in fitted]
    return [one for one in rest if one not in failed], [one for one in rest if one in failed]


def _untried(ordered: Sequence[RateStateCandidate], fit: RateStateFit) -> tuple[str, ...]:
    """Return which further forms are to be compared first, where the closest law misses something.

    A form whose fit failed was tried: it needs other start values.
    """
    left, failed = _unfitted(ordered, fit)
    said = []
    if left:
        said.append(
            f"first compare the forms that were not tried, {joined(left)}, by naming them as laws"
        )
    if failed:
        fits = "fits" if len(failed) > 1 else "fit"
        said.append(f"give start values of {joined(failed)}, whose {fits} failed")
    return (f"Nothing yet: {'; '.join(said)}.",) if said else ()


def _verdict(
    ordered: Sequence[RateStateCandidate],
    fit: RateStateFit,
    rival: RateStateCandidate | None,
    fault: str,
) -> str:
    closest = ordered[0]
    name = RATE_STATE_FORMS[fit.law.name].words
    if fault:
        return f"No candidate explains this record; the closest is {name}."
    told = f"Use {name}"
    tie = "" if rival is None else f"; this record does not distinguish it from {_law(rival)}"
    if closest.dropped:
        told = (
            f"{capital(name)} predicts best, but not all of its parameters are identified:"
            f" {closest.dropped}"
        )
    elif fit.over_scatter > THRESHOLDS.misfit:
        told = (
            f"{capital(name)} predicts best, but its residuals are {ratio(fit.over_scatter)} the"
            " scatter of neighbouring samples"
        )
    elif fit.misses:
        told = (
            f"{capital(name)} predicts best, but its residuals are not noise of single samples"
            f" (effective sample size {_effective(fit)})"
        )
        left, failed = _unfitted(ordered, fit)
        if left or failed:
            which = "was not tried" if left else "could not be fitted"
            told += f": a form that {which} may hold"
        told += tie
    elif fit.law.name == "constant-coefficient":
        told += f": no effect of speed is established, and $mu_0$ = {fit.estimates[0].plus_minus}"
    else:
        told += tie
    if fit.law.evolution != "none" and not fit.separable:
        which = "the difference of $a$ and $b$" if len(fit.rate_symbols) < 3 else _rate(fit)
        return f"{told}. Only {which} is identified."
    return f"{told}."


def _lede(
    ordered: Sequence[RateStateCandidate], fit: RateStateFit, fault: str, *, by_steps: bool
) -> str:
    closest = ordered[0]
    where = "velocity steps" if by_steps else "parts of the record"
    text = (
        f"Held-out error: {score_of(closest)} (coefficient of friction on held-out {where}, root"
        " mean square)."
    )
    if fault:
        text += f" {capital(fault)}."
    if fit.rate.interval != "known":
        text += f" {_about_rate(fit)}"
    constant = next((one for one in ordered[1:] if one.law is not None and one.law.name
                     == "constant-coefficient" and one.validation), None)  # fmt: skip
    if constant is not None:
        text += f" Constant coefficient: {score_of(constant)}."
    return text


def _about_rate(fit: RateStateFit) -> str:
    rate = fit.rate
    told = f"{_rate(fit)} = {rate.plus_minus}"
    if rate.low > 0.0:
        return f"{told}: friction grows with speed, and steady sliding is stable."
    if rate.high < 0.0:
        least = fit.law.critical_stiffness * fit.problem.record.load
        if fit.separable:
            return (
                f"{told}: friction falls with speed, and steady sliding is unstable on springs"
                f" softer than {quantity(least, 'N/m', 2)}"
                f" (this one: {quantity(fit.mechanism.stiffness, 'N/m', 2)})."
            )
        return f"{told}: friction falls with speed."
    return f"{told}: either sign is possible."


def _rate(fit: RateStateFit) -> str:
    return " − ".join(f"${symbol}$" for symbol in fit.rate_symbols)


def _settles(fit: RateStateFit) -> tuple[str, ...]:
    lines = []
    if fit.rate.interval != "known" and fit.rate.bounded:
        lines.append(f"{_rate(fit)} = {fit.rate.plus_minus}.")
    known = [e for e in fit.estimates if e.bounded and e.path.startswith("friction.")]
    if fit.separable:
        told = {e.quantity.symbol: e.plus_minus for e in known}
        symbols = [f"${symbol}$ = {told[symbol]}" for symbol in OWN if symbol in told]
        lines.append(f"{joined(symbols)}.")
    level = [e for e in known if e.quantity.symbol == "mu_0"]
    lines += [
        f"$mu_0$ = {e.plus_minus} at {quantity(fit.law.reference_velocity, 'm/s')}." for e in level
    ]
    return tuple(lines[:MOST])


def _cannot_tell(
    fit: RateStateFit, rival: RateStateCandidate | None, *, by_steps: bool
) -> tuple[str, ...]:
    lines = []
    if rival is not None:
        lines.append(f"Which law: {_law(rival)} predicts this record as well.")
    if not by_steps:
        lines.append(
            "How well the law predicts another step: there is only one, and it was fitted."
        )
    if fit.law.evolution != "none" and not fit.separable:
        lines.append("$a$ and $b$: larger and smaller ones of the same difference fit as well.")
    lines += [
        f"${e.quantity.symbol}$: {e.reason}."
        for e in fit.estimates
        if e.path in DISTANCES and e.reason
    ]
    lines += sentences_of(fit.findings, "length")
    lines += sentences_of(fit.findings, "drift")
    if fit.misses:
        lines.append(
            "What else acts: the residuals are autocorrelated, with an effective sample size of"
            f" {_effective(fit)}."
        )
    speeds = fit.problem.record.path.lasting
    lines.append(
        "How friction behaves at speeds outside"
        f" {span(float(speeds[speeds > 0].min()), float(speeds.max()), 'm/s')}."
    )
    return tuple(lines[:MOST])


def _effective(fit: RateStateFit) -> str:
    return f"{significant(fit.inference.effective, 2)} of {len(fit.best.residual):,}"


def _measure_next(
    fit: RateStateFit,
    rival: RateStateCandidate | None,
    steps: Sequence[OtherStep],
    checks: Checks,
    *,
    by_steps: bool,
) -> tuple[str, ...]:
    lines, law = [], fit.law
    telling = [one for one in steps if one.separation > THRESHOLDS.outlier * fit.rms]
    if rival is not None and telling:
        one = telling[0]
        lines.append(
            f"A step from {quantity(one.before, 'm/s')} to {quantity(one.after, 'm/s')}: the two"
            f" laws part there by {significant(one.separation, 2)} of the coefficient, which is"
            f" {ratio(one.separation / fit.rms)} the residual."
        )
    if not by_steps:
        speeds = joined([quantity(float(x), "m/s") for x in fit.problem.record.path.lasting])
        lines.append(
            f"More steps, up and down, between {speeds} and to other speeds: each can then be"
            " predicted from the others."
        )
    fastest = float(fit.problem.record.path.lasting.max())
    interval = float(np.median(np.diff(fit.time)))
    if law.critical_distance is not None and not fit.separable:
        way = law.direct_effect / fit.stiffness
        lines.append(
            f"The same steps on a stiffer machine: this one gives way by a/k = {quantity(way, 'm')}"
            " before the slider follows, which hides how friction settles over less than that."
        )
    shortest = min((distance for _, distance in law.states), default=0.0)
    if law.states and interval * fastest * SHORTEST > shortest:
        wanted = shortest / fastest / SHORTEST
        name = "D_c" if shortest == law.critical_distance else "D_2"
        lines.append(
            f"Samples every {quantity(wanted, 's', 2)} or less after a step to"
            f" {quantity(fastest, 'm/s')}: {name} is slid in {quantity(SHORTEST * wanted, 's', 2)}."
        )
    if fit.drift:
        lines.append("A longer way before the first step, until friction no longer drifts.")
    lines += corrections(checks, but=("drift",))  # velocity steps bring drifts with them
    if not lines:
        lines.append("Steps to speeds beyond these, and at another load.")
    return tuple(lines[:MOST])


def _no_score(ordered: Sequence[RateStateCandidate], rival: RateStateCandidate | None) -> str:
    if len(ordered) < 2:
        return ONE_LAW
    if rival is None:
        return ""
    return (
        f"No ranking of {_law(ordered[0])} and {_law(rival)}: their held-out errors do not differ"
        " beyond doubt."
    )


def _law(one: RateStateCandidate) -> str:
    return one.title if one.law is None else RATE_STATE_FORMS[one.law.name].words
