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
    held_out_text,
    in_sentence,
    longer,
    not_distinguished,
    to_predict,
)
from stickslip.identify.fits import far_above_dry
from stickslip.identify.kinds.features.features import StickSlipFeatures
from stickslip.identify.kinds.features.result import FeatureFit, as_good, room_of
from stickslip.identify.kinds.features.verdict import (
    PERCENT,
    FeatureCandidate,
    OtherSpeed,
    share_parts,
)
from stickslip.show.formatting import (
    joined,
    number,
    percent,
    quantity,
    ratio,
    signed_percent,
    with_unit,
)

BIASED = (
    "An offset of the force sensor adds to the level at rest and in motion alike: the force does"
    " not reverse."
)
MASS = "mechanism.mass"


def share_text(one: FeatureCandidate) -> str:
    """Return a held-out error with its standard error, such as ``6 ± 2 %``."""
    return with_unit(" ".join(share_parts(one)).strip(), PERCENT.unit)


def errors_text(errors: Mapping[str, float]) -> str:
    """Return relative errors in words.

    Examples
    --------
    >>> errors_text({"frequency": -0.032, "standard_deviation": 0.085})
    'frequency −3.2 % and standard deviation +8.5 %'
    """
    return joined([f"{name.replace('_', ' ')} {signed_percent(e)}" for name, e in errors.items()])


def outcomes(ordered: Sequence[FeatureCandidate]) -> list[FeatureCandidate]:
    """Add to each candidate, the best first, what became of it."""
    return [replace(one, outcome=_outcome(one, ordered[0])) for one in ordered]


def _outcome(one: FeatureCandidate, best: FeatureCandidate) -> str:
    if one.fit is None:
        return f"not fitted: {one.dropped}"
    if one.name == best.name:
        return "chosen" if not one.dropped else f"closest, not recommended: {one.dropped}"
    if one.dropped:
        return one.dropped
    if best.fit is not None and as_good(one.fit, best.fit):
        return f"{NOT_DISTINGUISHED}; {one.doubt}" if one.doubt else NOT_DISTINGUISHED
    return f"{ratio(one.score / best.score)} the error"


def feature_wording(
    ordered: Sequence[FeatureCandidate],
    control: FeatureCandidate | None,
    features: StickSlipFeatures,
    checks: Checks,
    speeds: Sequence[OtherSpeed],
) -> Wording:
    """Put a selection on features into words; the best candidate is the first."""
    best, fit = ordered[0], ordered[0].fit
    assert fit is not None
    equal = [one for one in ordered[1:] if one.fit and not one.dropped and as_good(one.fit, fit)]
    return Wording(
        verdict=_verdict(ordered, fit, equal),
        lede=_lede(ordered, fit, control),
        settles=_settles(best) if not best.dropped else _seen(features),
        cannot_tell=_cannot_tell(fit, equal, features),
        measure_next=_measure_next([best, *equal], features, checks, speeds),
        no_score=_no_score(ordered, equal),
    )


def _verdict(
    ordered: Sequence[FeatureCandidate], fit: FeatureFit, equal: Sequence[FeatureCandidate]
) -> str:
    best = ordered[0]
    name = friction_of(best.title)
    if best.dropped:
        least = all(best.score <= one.score for one in ordered)
        said = f"{name} fits best" if least else f"{name} fits as well as any"
        return f"No candidate reproduces the features of this record; {said}."
    mass = next((one for one in fit.estimates if one.path == MASS and one.bounded), None)
    if mass is not None:
        known = with_unit(mass.range, mass.quantity.unit) if best.alone else mass.plus_minus
        name += f" with an effective mass of {known}"
    if best.doubt:
        return to_predict(name, best.doubt)
    if equal:
        titles = [one.title for one in equal]
        return f"Use {name}; {not_distinguished(titles, 'these features')}."
    return f"Use {name}."


def _titles(candidates: Sequence[FeatureCandidate]) -> str:
    return joined([in_sentence(one.title) for one in candidates])


def _lede(
    ordered: Sequence[FeatureCandidate], fit: FeatureFit, control: FeatureCandidate | None
) -> str:
    best = ordered[0]
    text = (
        held_out_text(
            PERCENT,
            best.score,
            best.score_error,
            "second half of the record predicted from the first, root mean square of"
            f" {errors_text(fit.held_out_errors)}",
        )
        + f" The features themselves change by {percent(room_of(fit))} between the halves."
    )
    if control is not None and control.fit is not None:
        off = control.fit.held_out_errors.get("frequency", 0.0)
        text += (
            f" With the nominal mechanism: {share_text(control)} (frequency {signed_percent(off)})."
        )
    closer = [one for one in ordered[1:] if one.fit and one.dropped and one.score < best.score]
    if closer and not best.dropped:
        first = closer[0]
        text += f" {first.title}: {share_text(first)}, but {first.dropped}."
    return text


def _settles(best: FeatureCandidate) -> tuple[str, ...]:
    assert best.fit is not None
    pairs = [*zip(best.alone or best.fit.estimates, best.fit.estimates, strict=True)]
    known = [(one, whole) for one, whole in pairs if one.bounded]
    known.sort(key=lambda pair: (pair[0].high - pair[0].low) / max(abs(pair[0].value), 1e-300))
    lines = []
    for one, whole in known[:MOST]:
        symbol = f"${one.quantity.symbol}$"
        if not best.alone:
            lines.append(f"{symbol} = {one.plus_minus}.")
        elif whole.bounded:
            between = with_unit(whole.range.replace(" to ", " and "), one.quantity.unit)
            lines.append(
                f"{symbol} lies between {between}, whichever of these laws holds;"
                f" {one.plus_minus} if {in_sentence(best.title)} friction does."
            )
        else:
            lines.append(
                f"{symbol} = {one.plus_minus} if {in_sentence(best.title)} friction holds;"
                f" {whole.reason}."
            )
    return tuple(lines)


def _seen(features: StickSlipFeatures) -> tuple[str, ...]:
    """Return what the record settles although no law has its features: these themselves."""
    if features.slips > 1:
        return sentences_of(features.findings, "slips")
    return (
        f"The force oscillates at {quantity(features.frequency, 'Hz')} about a mean of"
        f" {number(features.mean)} of the load, with a standard deviation of"
        f" {number(features.standard_deviation)} of it.",
    )


def _cannot_tell(
    fit: FeatureFit, equal: Sequence[FeatureCandidate], features: StickSlipFeatures
) -> tuple[str, ...]:
    lines = [*far_above_dry(fit)]
    if equal:
        lines.append(
            f"Which law: {_titles(equal)} can reproduce the same frequency, mean and standard"
            " deviation. Three features determine three numbers."
        )
    lines += sentences_of(features.findings, "scatter", "drift")
    if any(one.path == MASS for one in fit.estimates):
        lines.append(
            "Why the effective mass differs: a spring stiffer than stated, or a rocking body, has"
            " the same effect."
        )
    elif features.too_fast:
        lines += sentences_of(features.findings, "frequency")
    lines += [BIASED, UNMEASURED]
    return tuple(lines[:MOST])


def _measure_next(
    alike: Sequence[FeatureCandidate],
    features: StickSlipFeatures,
    checks: Checks,
    speeds: Sequence[OtherSpeed],
) -> tuple[str, ...]:
    lines, fit = [], alike[0].fit
    assert fit is not None
    # laws must part there by more than drift, and by what matters
    least = max(2.0 * room_of(fit), THRESHOLDS.material)
    telling = [one for one in speeds if one.separation > least]
    if len(alike) > 1 and telling:
        lines.append(_speed_line(telling[0], alike))
    free = any(one.path == MASS for one in fit.estimates)
    if not free and features.too_fast:
        lines.append(
            "Fit the mass as well: vary=['friction.*', 'mechanism.mass'], or --vary"
            " 'friction.*,mass'. The nominal mass cannot oscillate as fast as measured."
        )
    if free:
        lines.append(
            "Weigh the moving parts and load the spring with a known weight: the effective mass"
            " implies that the mass or the stiffness is not as stated, or that the body is not"
            " rigid."
        )
    if features.drifts:
        lines.append("Repeat the pull after further passes, until the mean no longer drifts.")
    lines += [*corrections(checks, but=("drift",)), *longer(checks)]
    if not lines:
        lines.append("Repeat the pull at another speed and at another position on the track.")
    return tuple(lines[:MOST])


def _speed_line(told: OtherSpeed, alike: Sequence[FeatureCandidate]) -> str:
    said = "; ".join(f"{one.title} {_motion(told.predicted[one.name])}" for one in alike)
    return f"Pull at {quantity(told.speed, 'm/s')}, where the fitted laws differ: {said}."


def _motion(predicted: Mapping[str, float]) -> str:
    """Return a predicted limit cycle in words."""
    if not predicted["frequency"] > 0.0:
        return "predicts steady sliding"
    spread = predicted["standard_deviation"]
    return (
        f"predicts {quantity(predicted['frequency'], 'Hz')} and a standard deviation of"
        f" {number(spread)}"
    )


def _no_score(ordered: Sequence[FeatureCandidate], equal: Sequence[FeatureCandidate]) -> str:
    if len(ordered) < 2:
        return ONE_LAW
    if not equal:
        return ""
    return (
        f"No ranking of {_titles([ordered[0], *equal])}: their held-out errors do not differ"
        " significantly."
    )
