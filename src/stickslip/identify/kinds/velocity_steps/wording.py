"""The verdict on velocity steps in words. Symbols stand between dollar signs."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stickslip.data import Checks, sentences_of
from stickslip.friction import RATE_STATE_FORMS, RateStateForm
from stickslip.identify import THRESHOLDS
from stickslip.identify.candidates import MOST, ONE_LAW, Wording, corrections
from stickslip.identify.judgement import RIVAL
from stickslip.identify.kinds.kind import probable_text
from stickslip.identify.kinds.velocity_steps.result import RateStateFit
from stickslip.identify.kinds.velocity_steps.verdict import RateStateCandidate
from stickslip.identify.ladder import probability_text
from stickslip.identify.problems.velocity_step_paths import SHORTEST
from stickslip.show.formatting import capital, joined, number, quantity, ratio, significant, span

OWN = ("a", "b", "D_c", "b_2", "D_2", "c")
"""Symbols of what a law adds to its level, in the order in which they are told."""


def outcomes(
    ordered: Sequence[RateStateCandidate],
    rival: RateStateCandidate | None,
    *,
    recommended: bool,
) -> list[RateStateCandidate]:
    """Add to each candidate, the most probable first, what became of it."""
    closest = ordered[0]
    found = []
    for one in ordered:
        if one is closest:
            said = "chosen" if recommended else "closest, but not recommended"
        elif one.fit is None:
            said = f"not fitted: {one.dropped}"
        elif one is rival or one.share * RIVAL > closest.share:
            contains = RATE_STATE_FORMS[one.fit.law.name].contains(_form(closest))
            said = (
                "may hold beside the chosen law, which it contains"
                if contains
                else ("not told apart from the chosen law")
            )
        else:
            said = f"{probability_text(one.share)} probable"
        found.append(replace(one, outcome=said))
    return found


def _form(one: RateStateCandidate) -> RateStateForm:
    assert one.fit is not None
    return one.fit.problem.laws[one.name].form


def rate_state_wording(
    ordered: Sequence[RateStateCandidate],
    rival: RateStateCandidate | None,
    checks: Checks,
    *,
    fault: str,
) -> Wording:
    """Put a selection on velocity steps into words."""
    fit = ordered[0].fit
    assert fit is not None
    return Wording(
        verdict=_verdict(fit, rival, fault),
        lede=_lede(ordered, fit, fault),
        settles=_settles(fit),
        cannot_tell=_cannot_tell(ordered, fit, rival),
        measure_next=(*_untried(ordered, fit), *_measure_next(fit, rival, checks))[:MOST],
        no_score=_no_score(ordered, rival),
    )


def _untried(ordered: Sequence[RateStateCandidate], fit: RateStateFit) -> tuple[str, ...]:
    """Return which forms are to be compared first, where the closest law leaves more than noise."""
    tried = {one.fit.problem.laws[one.name].form.title for one in ordered if one.fit is not None}
    rest = [name for name, form in RATE_STATE_FORMS.items() if form.title not in tried]
    if not rest or not fit.misses:
        return ()
    return (f"First compare the forms that were not tried, {joined(rest)}, by naming them.",)


def _verdict(fit: RateStateFit, rival: RateStateCandidate | None, fault: str) -> str:
    name = RATE_STATE_FORMS[fit.law.name].words
    if fault:
        return f"No candidate explains this record; the closest is {name}."
    told = f"Use {name}"
    if fit.over_scatter > THRESHOLDS.misfit:
        told = (
            f"{capital(name)} is closest, but its residuals are {ratio(fit.over_scatter)} the"
            " scatter of neighbouring samples"
        )
    elif fit.misses:
        told = (
            f"{capital(name)} is closest, but its residuals are not noise of single samples"
            f" (effective sample size {_effective(fit)})"
        )
    elif fit.law.name == "constant-coefficient":
        told += ": no effect of speed is established"
        level = [e for e in fit.estimates if e.quantity.symbol == "mu_0"]
        if fit.drifts:
            told += ", and the coefficient changes along the way"
        elif level:
            told += f", and $mu_0$ = {level[0].plus_minus}"
    if rival is not None:
        told += f"; this record does not distinguish it from {_law(rival)}"
    if fit.law.evolution != "none" and not fit.separable:
        which = "the difference of $a$ and $b$" if len(fit.rate_symbols) == 2 else _rate(fit)
        return f"{told}. Only {which} is identified."
    return f"{told}."


def _lede(ordered: Sequence[RateStateCandidate], fit: RateStateFit, fault: str) -> str:
    text = f"It leaves {number(fit.rms, 2)} of the coefficient of friction, root mean square"
    text = probable_text(ordered[0].share, len(ordered)) + text
    text += f": {fault}." if fault else "."
    if fit.rate.interval != "known":
        text += f" {_about_rate(fit)}"
    drift = sentences_of(fit.findings, "drift")
    if drift:
        text += f" {drift[0]}"
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
    if fit.rate.interval != "known":
        lines.append(f"{_rate(fit)} = {fit.rate.plus_minus}.")
    known = [e for e in fit.estimates if e.bounded]
    if fit.separable:
        told = {e.quantity.symbol: e.plus_minus for e in known}
        symbols = [f"${symbol}$ = {told[symbol]}" for symbol in OWN if symbol in told]
        lines.append(f"{joined(symbols)}.")
    level = [e for e in known if e.quantity.symbol == "mu_0"]
    midway = ", midway along the record" if fit.drifts else ""
    lines += [
        f"$mu_0$ = {e.plus_minus} at {quantity(fit.law.reference_velocity, 'm/s')}{midway}."
        for e in level
    ]
    return tuple(lines[:MOST])


def _cannot_tell(
    ordered: Sequence[RateStateCandidate], fit: RateStateFit, rival: RateStateCandidate | None
) -> tuple[str, ...]:
    lines = []
    if rival is not None:
        lines.append(f"Which law: {_law(rival)} is {probability_text(rival.share)} probable.")
    lines += fit.family.few_draws
    if fit.law.evolution != "none" and not fit.separable:
        lines.append("$a$ and $b$: larger and smaller ones of the same difference fit as well.")
    lines += [f"${e.quantity.symbol}$: {e.reason}." for e in fit.estimates if e.reason]
    lines += sentences_of(fit.findings, "stiffness")
    near = [one for one in ordered[1:] if one.share * RIVAL > ordered[0].share]
    richer = [one for one in near if rival is None or one.name != rival.name]
    if richer:
        share = probability_text(richer[0].share)
        lines.append(f"Whether there is more: {_law(richer[0])} is {share} probable.")
    if len(fit.problem.record.path.steps) == 1:
        lines.append("How well the law predicts another step: there is only one.")
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
    return tuple(lines[: MOST + 1])


def _effective(fit: RateStateFit) -> str:
    rows = len(fit.problem.measured)
    return f"{significant(fit.posterior.kappa * rows, 2)} of {rows:,}"


def _measure_next(
    fit: RateStateFit, rival: RateStateCandidate | None, checks: Checks
) -> tuple[str, ...]:
    lines, law = [], fit.law
    path = fit.problem.record.path
    if rival is not None or len(path.steps) == 1:
        speeds = joined([quantity(float(x), "m/s") for x in path.lasting])
        lines.append(f"More steps, up and down, between {speeds} and to other speeds.")
    if law.critical_distance is not None and not fit.separable:
        way = law.direct_effect / fit.stiffness
        lines.append(
            f"The same steps on a stiffer machine: this one gives way by a/k = {quantity(way, 'm')}"
            " before the slider follows, which hides how friction settles over less than that."
        )
    fastest, interval = float(path.lasting.max()), float(np.median(np.diff(fit.time)))
    shortest = min((distance for _, distance in law.states), default=0.0)
    if law.states and interval * fastest * SHORTEST > shortest:
        wanted = shortest / fastest / SHORTEST
        name = "D_c" if shortest == law.critical_distance else "D_2"
        lines.append(
            f"Samples every {quantity(wanted, 's', 2)} or less after a step to"
            f" {quantity(fastest, 'm/s')}: {name} is slid in {quantity(SHORTEST * wanted, 's', 2)}."
        )
    if fit.drifts:
        lines.append("A longer way before the first step, until friction no longer drifts.")
    lines += corrections(checks, but=("drift",))  # velocity steps bring drifts with them
    if not lines:
        lines.append("Steps to speeds beyond these, and at another load.")
    return tuple(lines[:MOST])


def _no_score(ordered: Sequence[RateStateCandidate], rival: RateStateCandidate | None) -> str:
    if len(ordered) == 1:
        return ONE_LAW
    if rival is None:
        return ""
    return f"No ranking of {_law(ordered[0])} and {_law(rival)}: both may hold."


def _law(one: RateStateCandidate) -> str:
    return one.title if one.law is None else RATE_STATE_FORMS[one.law.name].words
