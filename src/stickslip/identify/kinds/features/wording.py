"""The verdict on features in words. Symbols stand between dollar signs, which reports typeset."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from stickslip.data import Checks, sentences_of
from stickslip.identify import THRESHOLDS
from stickslip.identify.candidates import (
    MOST,
    NOT_DISTINGUISHED,
    ONE_LAW,
    UNMEASURED,
    Wording,
    corrections,
    friction_of,
    in_sentence,
    longer,
    not_distinguished,
)
from stickslip.identify.fits import Estimate
from stickslip.identify.kinds.features.result import FeatureFit, pooled
from stickslip.identify.kinds.features.verdict import FeatureCandidate, OtherSetting
from stickslip.identify.kinds.kind import probable_text
from stickslip.identify.ladder import probability_text
from stickslip.identify.problems.stick_slip import MASS
from stickslip.identify.problems.velocity_steps import UNKNOWN
from stickslip.show.formatting import (
    joined,
    number,
    percent,
    quantity,
    signed_percent,
    significant,
    with_unit,
)

BIASED = (
    "An offset of the force sensor adds to the level at rest and in motion alike: the force does"
    " not reverse."
)
UNITS = {"speed": "m/s", "stiffness": "N/m", "load": "N"}


def outcomes(
    ordered: Sequence[FeatureCandidate], rivals: Sequence[FeatureCandidate]
) -> list[FeatureCandidate]:
    """Add to each candidate, the most probable first, what became of it."""
    found = []
    for one in ordered:
        if one.fit is None:
            said = f"not fitted: {one.dropped}"
        elif one is ordered[0]:
            off = joined([f"{name.replace('_', ' ')} by {signed_percent(one.fit.errors[name])}"
                          for name in one.fit.missed])  # fmt: skip
            said = f"closest, not recommended: it misses {off}" if off else "chosen"
        elif one in rivals:
            said = NOT_DISTINGUISHED
        else:
            said = f"{probability_text(one.share)} probable"
        found.append(replace(one, outcome=said))
    return found


def feature_wording(
    ordered: Sequence[FeatureCandidate],
    rivals: Sequence[FeatureCandidate],
    checks: Checks,
    others: Sequence[OtherSetting],
) -> Wording:
    """Put a selection on features into words; the most probable candidate is the first."""
    fit = ordered[0].fit
    assert fit is not None
    near = [fit, *(one.fit for one in rivals if one.fit)]
    return Wording(
        verdict=_verdict(ordered[0], fit, rivals),
        lede=_lede(ordered, fit),
        settles=_settles(near) if not fit.missed else _seen(fit),
        cannot_tell=_cannot_tell(fit, rivals),
        measure_next=_measure_next(fit, rivals, checks, others),
        no_score=_no_score(ordered, rivals),
    )


def _verdict(best: FeatureCandidate, fit: FeatureFit, rivals: Sequence[FeatureCandidate]) -> str:
    name = friction_of(best.title)
    if fit.missed:
        return f"No candidate reproduces the features of this record; {name} is closest."
    mass = next(one for one in (*fit.estimates, None) if one is None or one.path == MASS)
    if mass is not None and fit.problem.doubts[MASS] >= UNKNOWN:
        name += f" with an effective mass of {mass.plus_minus}"
    if not rivals:
        return f"Use {name}."
    titles = [one.title for one in rivals]
    return f"Use {name}; {not_distinguished(titles, 'these features')}."


def _titles(candidates: Sequence[FeatureCandidate]) -> str:
    return joined([in_sentence(one.title) for one in candidates])


def errors_text(errors: Mapping[str, float]) -> str:
    """Return relative errors in words.

    Examples
    --------
    >>> errors_text({"frequency": -0.032, "standard_deviation": 0.085})
    'frequency −3.2 % and standard deviation +8.5 %'
    """
    return joined([f"{name.replace('_', ' ')} {signed_percent(e)}" for name, e in errors.items()])


def _lede(ordered: Sequence[FeatureCandidate], fit: FeatureFit) -> str:
    text = f"Its limit cycle is off by {errors_text(fit.errors)}."
    if fit.rms < THRESHOLDS.negligible:
        text = (
            f"Its limit cycle has frequency, mean and scatter to {percent(THRESHOLDS.negligible)}."
        )
    fitted = sum(one.fit is not None for one in ordered)
    text = probable_text(ordered[0].share, fitted) + text
    records = len(fit.problem.settings)
    if records > 1:
        text += f" {records} records tell it."
    return text


def _settles(near: Sequence[FeatureFit]) -> tuple[str, ...]:
    """Return what holds whichever of the laws does that are not told apart."""
    fit, lines = near[0], []
    known = [one for one in fit.estimates if one.bounded and one.path.startswith("friction.")]
    known.sort(key=lambda one: (one.high - one.low) / max(abs(one.value), 1e-300))
    for one in known[:MOST]:
        symbol = f"${one.quantity.symbol}$"
        if len(near) == 1:
            lines.append(f"{symbol} = {one.plus_minus}.")
        else:
            lines.append(
                f"{symbol} lies between {_between(near, one)}, whichever of these laws holds;"
                f" {one.plus_minus} if {in_sentence(fit.law.title)} friction does."
            )
    return tuple(lines)


def _between(near: Sequence[FeatureFit], one: Estimate) -> str:
    low, high = pooled(near, one.path)
    whole = replace(one, low=min(low, one.low), high=max(high, one.high))
    return with_unit(whole.range.replace(" to ", " and "), one.quantity.unit)


def _seen(fit: FeatureFit) -> tuple[str, ...]:
    """Return what the record settles although no law has its features: these themselves."""
    features = fit.observed
    if features.slips > 1:
        return sentences_of(features.findings, "slips")
    return (
        f"The force oscillates at {quantity(features.frequency, 'Hz')} about a mean of"
        f" {number(features.mean)} of the load, with a standard deviation of"
        f" {number(features.standard_deviation)} of it.",
    )


def _cannot_tell(fit: FeatureFit, rivals: Sequence[FeatureCandidate]) -> tuple[str, ...]:
    lines = []
    if rivals:
        shares = joined([
            f"{in_sentence(one.title)} is {probability_text(one.share)} probable" for one in rivals
        ])  # fmt: skip
        lines.append(f"Which law: {shares}.")
    lines += fit.family.few_draws
    lines += [f"${one.quantity.symbol}$: {one.reason}." for one in fit.estimates if one.reason]
    lines += sentences_of(fit.findings, "scatter", "drift", "machine")
    if fit.problem.doubts.get(MASS, 0.0) >= UNKNOWN:
        lines.append(
            "Why the effective mass differs: a spring stiffer than stated, or a rocking body, has"
            " the same effect."
        )
    elif fit.observed.too_fast:
        lines += sentences_of(fit.findings, "frequency")
    if len(fit.problem.settings) == 1:
        lines.append("How much friction differs from run to run: there is one record.")
    lines += [BIASED, UNMEASURED]
    return tuple(lines[: MOST + 1])


def _measure_next(
    fit: FeatureFit,
    rivals: Sequence[FeatureCandidate],
    checks: Checks,
    others: Sequence[OtherSetting],
) -> tuple[str, ...]:
    lines, doubts = [], fit.problem.doubts
    if not doubts.get(MASS, 0.0) >= UNKNOWN and fit.observed.too_fast:
        lines.append(
            "Fit the mass as well: vary=['friction.*', 'mechanism.mass'], or --vary"
            " 'friction.*,mass'. The nominal mass cannot oscillate as fast as measured."
        )
    if others:
        lines.append(setting_line(others[0], fit, rivals))
    if doubts.get(MASS, 0.0) >= UNKNOWN:
        lines.append(
            "Weigh the moving parts and load the spring with a known weight: the effective mass"
            " implies that the mass or the stiffness is not as stated, or that the body is not"
            " rigid."
        )
    if fit.observed.drifts:
        lines.append("Repeat the pull after further passes, until the mean no longer drifts.")
    lines += [*corrections(checks, but=("drift",)), *longer(checks)]
    return tuple(lines[:MOST])


def setting_line(one: OtherSetting, fit: FeatureFit, rivals: Sequence[FeatureCandidate]) -> str:
    """Return the advice to make another record."""
    where = f"a {one.name} of {quantity(one.value, UNITS[one.name])}"
    verb = "Pull again at" if one.name == "speed" else "Pull again with"
    titles = {fit.name: fit.law.title, **{each.name: each.title for each in rivals}}
    said = "; ".join(f"{titles[name]} {_motion(row)}" for name, row in one.predicted.items())
    asked = "which law holds" if rivals else "its parameters"
    return (
        f"{verb} {where}, and give both records as trials: of what is not known of {asked},"
        f" {significant(100.0 * one.left, 2)} % is expected to be left. {said}."
    )


def _motion(predicted: Mapping[str, float]) -> str:
    """Return a predicted limit cycle in words."""
    if not predicted["frequency"] > 0.0:
        return "predicts steady sliding"
    spread = predicted["standard_deviation"]
    return (
        f"predicts {quantity(predicted['frequency'], 'Hz')} and a standard deviation of"
        f" {number(spread)}"
    )


def _no_score(ordered: Sequence[FeatureCandidate], rivals: Sequence[FeatureCandidate]) -> str:
    if len(ordered) < 2:
        return ONE_LAW
    if not rivals:
        return ""
    return f"No ranking of {_titles([ordered[0], *rivals])}: each may hold."
