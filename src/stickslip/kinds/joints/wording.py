"""The verdict on records in words. Symbols stand between dollar signs, which reports typeset."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from stickslip.experiments import Checks
from stickslip.formatting import (
    Scale,
    capital,
    count,
    joined,
    lower_first,
    number,
    ratio,
)
from stickslip.identification import (
    OUTLIERS,
    ModelError,
    RecordFit,
    TrialComparison,
    difference,
    far_above_dry,
)
from stickslip.kinds.joints.joint_verdict import RecordCandidate, SecondRecord
from stickslip.kinds.joints.ladder import IDLE
from stickslip.selection import (
    NOT_DISTINGUISHED,
    REFERENCE,
    UNMEASURED,
    Wording,
    as_good,
    corrections,
    disturbing,
    friction_of,
    held_out_text,
    in_sentence,
    limit_of,
    longer,
    not_distinguished,
    on_second_record,
    score_scale,
    settled_estimates,
    to_predict,
)

MOST = 3
"""Items of a list at most."""
SEVERAL = 2.0
"""Error on a second record over the held-out one from which the second is what to expect."""


def _scale(candidates: Sequence[RecordCandidate], fit: RecordFit) -> Scale:
    """Return what scores are shown in, as `RecordVerdict.scale` does."""
    unit = fit.measurement.unit(fit.problem.quantity)
    return score_scale([c.score for c in candidates], unit)


def distinct(scale: Scale, among: Sequence[float], value: float) -> str:
    """Return a score; one of several with the digits that tell it from them, seven at most.

    Examples
    --------
    >>> [distinct(Scale(1e3, "mm"), (1.234e-3, 1.2341e-3), one) for one in (1.234e-3, 1.2341e-3)]
    ['1.2340 mm', '1.2341 mm']
    """
    others = [other for other in among if other != value] if value in among else []
    for digits in range(3, 8):
        text = scale.error(value, digits)
        if all(scale.error(other, digits) != text for other in others):
            return text
    return scale.error(value)


def outcomes(
    candidates: Sequence[RecordCandidate], best: RecordCandidate, *, recommended: bool = True
) -> list[RecordCandidate]:
    """Add to each candidate what became of it."""
    return [replace(c, outcome=_outcome(c, best, recommended=recommended)) for c in candidates]


def _outcome(c: RecordCandidate, best: RecordCandidate, *, recommended: bool) -> str:
    if c.name == best.name:
        if recommended:
            return "chosen"
        return f"fits best, not recommended{f': {c.dropped}' if c.dropped else ''}"
    if c.fit is None:
        return f"not fitted: {c.dropped}"
    if c.dropped:
        return first_of(c.dropped)
    more = c.parameters - best.parameters
    if as_good(c, best):
        if more > 0:
            return f"{count(more, 'more parameter')}, no significant improvement"
        return f"{'reference, ' if c.name == REFERENCE else ''}{NOT_DISTINGUISHED}"
    if c.name == REFERENCE:
        return "reference"
    if best.score <= 0.0:  # numbers that a law made, without noise
        return "non-zero error, while the chosen law fits exactly"
    return f"{ratio(c.score / best.score)} the error"


def equals_of(
    best: RecordCandidate, candidates: Sequence[RecordCandidate]
) -> list[RecordCandidate]:
    """Return the laws that held-out blocks do not tell from the one that is taken, the best first.

    Not those that are this law at their values, nor those with more parameters, an objection and
    neither a smaller error nor a smaller criterion of Akaike: with a part more that nothing asks
    for, any law predicts alike. What was not scored counts by that criterion alone.
    """
    found = [
        c
        for c in candidates
        if c.name != best.name and c.fit and best.name not in c.is_simpler
        if not c.fit.search_failure and not c.refuted
        if as_good(c, best) or c.dropped == IDLE
        if not c.dropped
        or c.score < best.score
        or c.parameters < best.parameters
        or c.aic < best.aic
    ]
    return sorted(found, key=lambda c: c.score)


def record_wording(
    candidates: Sequence[RecordCandidate],
    best: RecordCandidate,
    without: RecordCandidate | None,
    picks: Mapping[str, str],
    checks: Checks,
    *,
    scored: str,
    fault: str = "",
    on_second: SecondRecord | None = None,
    trials: TrialComparison | None = None,
    shown: Scale | None = None,
) -> Wording:
    """Put a selection on records into words."""
    assert best.fit is not None
    equal = equals_of(best, candidates)
    scale = shown or _scale(candidates, best.fit)
    alike = [c.title for c in equal]
    least = all(best.score <= c.score for c in candidates if c.validation and not c.dropped)
    verdict = _verdict(best, alike, candidates, fault, on_second, trials, scale, least=least)
    lede = _lede(candidates, best, alike, without, scored, on_second, scale, said=verdict)
    return Wording(
        verdict=verdict,
        lede=" ".join([lede + _trials_text(trials, verdict), *best.fit.assumptions]),
        settles=() if fault else _settles(best, equal),
        cannot_tell=_cannot_tell(best, candidates, picks),
        measure_next=_measure_next(checks, fault, on_second, found=disturbing(best.fit)),
        no_score="",
    )


def _verdict(
    best: RecordCandidate,
    alike: Sequence[str],
    candidates: Sequence[RecordCandidate],
    fault: str,
    on_second: SecondRecord | None,
    trials: TrialComparison | None,
    scale: Scale,
    *,
    least: bool,
) -> str:
    name = friction_of(best.title)
    if best.refuted:
        return f"{capital(best.refuted)}. Measure the value again, or leave it out."
    if fault:
        return f"No candidate explains this record: {fault}."
    if best.dropped:
        return f"No candidate passes all checks; {name} fits best."
    if on_second is not None and not on_second.holds:
        other = next(c for c in candidates if c.name == on_second.rival)
        own, rival = _second_errors(scale, on_second)
        return (
            f"{capital(name)} is chosen on the first record, but {friction_of(other.title)} has a"
            f" clearly smaller error on the second ({rival} against {own})."
        )
    found = f"{capital(name)} {'predicts best' if least else 'is chosen'}"
    if trials is not None and not trials.shared:
        outcome = trials.sentences[0]
        return f"{found}, but {lower_first(outcome)}"
    errors = best.fit.model_errors if best.fit is not None else ()
    errors = tuple(one for one in errors if one.moved != () or one.kind != OUTLIERS)
    if errors:
        first = errors[0]
        fails = "the model does not hold: " if first.share > 0.0 else ""
        return f"{found}, but {fails}{lower_first(first.finding)}"
    if best.fit is not None and best.fit.halves is not None:
        apart = difference([one.quantity for one in best.fit.estimates], best.fit.halves)
        if apart:
            return f"{found}, but the two halves of the record disagree: {apart}."
    if best.doubt:
        return to_predict(name, first_of(best.doubt))  # all of them stand beside the errors
    if alike:
        return f"Use {name}; {not_distinguished(alike, 'this record')}."
    return f"Use {name}."


def _trials_text(trials: TrialComparison | None, verdict: str) -> str:
    """Return whether trials share one law, less what the verdict says of it."""
    lines = () if trials is None else trials.sentences[: 1 if trials.shared else 2]
    return "".join(f" {line}" for line in lines if line[1:] not in verdict)


def first_of(objections: str) -> str:
    """Return the first of several objections, and how many more there are.

    Examples
    --------
    >>> first_of("c is 0"), first_of("a is 0; b is 0; c is 0")
    ('c is 0', 'a is 0, and 2 more objections')
    """
    first, *others = objections.split("; ")
    if not others:
        return first
    return f"{first}, and {count(len(others), 'more objection')}"


def _lede(
    candidates: Sequence[RecordCandidate],
    best: RecordCandidate,
    alike: Sequence[str],
    without: RecordCandidate | None,
    scored: str,
    on_second: SecondRecord | None,
    scale: Scale,
    *,
    said: str,
) -> str:
    """Return the errors, and what speaks against the choice beside what the verdict `said`."""
    assert best.fit is not None
    assert best.validation is not None
    fit = best.fit
    told = partial(
        distinct, scale, [c.score for c in candidates if c.name in {best.name, REFERENCE}]
    )
    text = held_out_text(scale, best.score, best.score_error, scored)
    if on_second is not None:
        text += f" {_second_text(candidates, on_second, scale)}"
    if best.doubt and best.doubt not in said:
        text += f" Not all of its parameters are identified: {best.doubt}."
    if alike and not_distinguished(alike, "this record") not in said:
        text += f" {capital(not_distinguished(alike, 'this record'))}."
    usual = next((c for c in candidates if c.name == REFERENCE), None)
    if usual is not None and usual.name != best.name and usual.fit:
        apart = not as_good(usual, best)
        shown = told(usual.score) if apart else scale.error(usual.score)
        text += (
            f" Coulomb + viscous friction, the usual choice: {shown} on the same blocks"
            f"{'' if apart else ', which is not significantly different'}."
        )
    elif without is not None and math.isfinite(without.score):
        text += f" Without friction: {told(without.score)}."
    for error in fit.model_errors:
        known = lower_first(error.finding) in said
        text += f" {error.consequence if known else error}"
    closer = [
        c
        for c in candidates
        if c.dropped and c.validation and best.name not in c.is_simpler and not as_good(best, c)
    ]
    if closer and not best.dropped:
        first = closer[0]
        text += f" {first.title}: {told(first.score)}, but {first_of(first.dropped)}."
    return text


def _second_text(
    candidates: Sequence[RecordCandidate], on_second: SecondRecord, scale: Scale
) -> str:
    """Return the error on the second record, and whether the choice holds there."""
    own, other = _second_errors(scale, on_second)
    text = on_second_record(own)
    if SEVERAL <= on_second.ratio < math.inf:
        text += (
            f", {number(on_second.ratio, 2)} times the held-out error; expect errors of this size"
            " on new data"
        )
    text += f"; the choice {on_second.finding} there"
    rival = next((c for c in candidates if c.name == on_second.rival), None)
    return text + (f" ({rival.title}: {other})." if rival else ".")


def _second_errors(scale: Scale, on_second: SecondRecord) -> tuple[str, str]:
    """Return the errors of the chosen law and of its closest rival on the second record."""
    pair = (on_second.error, on_second.rival_error)
    told = partial(distinct, scale, pair)
    own, other = (told(e) if math.isfinite(e) else "a simulation that fails" for e in pair)
    return own, other


def _settles(best: RecordCandidate, equal: Sequence[RecordCandidate]) -> tuple[str, ...]:
    assert best.fit is not None
    fit = best.fit
    return tuple(
        f"${e.quantity.symbol}$ = {e.plus_minus}.{limit_of(fit, e)}"
        for e in settled_estimates(fit, [c.fit for c in equal if c.fit])[:MOST]
    )


def _cannot_tell(
    best: RecordCandidate, candidates: Sequence[RecordCandidate], picks: Mapping[str, str]
) -> tuple[str, ...]:
    assert best.fit is not None
    others = _other_picks(best, candidates, picks)
    lines = [*far_above_dry(best.fit), *best.fit.sentences]
    lines = lines[: MOST - len(others)]  # that criteria disagree is not crowded out
    lines += [UNMEASURED] if len(lines) + len(others) < MOST else []
    return (*lines, *others)


def _other_picks(
    best: RecordCandidate, candidates: Sequence[RecordCandidate], picks: Mapping[str, str]
) -> tuple[str, ...]:
    """Return a sentence where other criteria would pick another law."""
    titles = {c.name: in_sentence(c.title) for c in candidates}
    against: dict[str, list[str]] = {}
    for criterion, name in picks.items():
        if name and name != best.name:
            against.setdefault(titles.get(name, name), []).append(criterion)
    said = [f"{joined(who)} would pick {title}" for title, who in against.items()]
    return (f"Criteria disagree: {'; '.join(said)}.",) if said else ()


def _measure_next(
    checks: Checks,
    fault: str,
    on_second: SecondRecord | None,
    *,
    found: Sequence[ModelError] = (),
) -> tuple[str, ...]:
    lines = list(corrections(checks, but=("drift",)))
    if fault:
        lines.append(
            "Before any further measurement, check the units, gains and signs of each column, the"
            " mass, and whether all trials are of one machine in one condition."
        )
    elif found:
        lines.append(
            "Before any further measurement, find the cause of what is said beside the law, correct"
            " it, and record again."
        )
    lines += longer(checks)
    lines += [f"{one.measure}." for one in checks.of("drift")[:1]]
    if on_second is not None and SEVERAL <= on_second.ratio < math.inf:
        lines.append(
            "Find what differs between the two records (load, temperature, lubrication, gains):"
            " the law fitted to the first does not transfer to the second."
        )
    if not lines and on_second is None:
        lines.append(
            "Record a second, different motion and give it for validation (--validate), to test"
            " the choice on data that no fit has used."
        )
    elif not lines:
        lines.append("Record at other speeds, loads or temperatures, where the law extrapolates.")
    return tuple(lines[:MOST])
