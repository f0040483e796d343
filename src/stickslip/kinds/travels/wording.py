"""The verdict on travels in words: the law, the band over the setting, and what narrows it.

Symbols stand between dollar signs, which reports typeset.
"""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.experiments import Finding, with_order
from stickslip.formatting import capital, count, joined, percent, quantity
from stickslip.identification import Estimate, durations
from stickslip.identify import PredictionBand, TravelJudgement, parameter_sentence
from stickslip.kinds.travels.settings import words_of
from stickslip.kinds.travels.verdict import TravelCandidate, estimate_text
from stickslip.quantities import fields_of, parameters
from stickslip.selection import Wording, friction_of, in_sentence, limits_of, not_distinguished

Array: TypeAlias = NDArray[np.float64]

UNKNOWN = "Travels beyond the settings of the band, and friction at other loads, are not known."


def wording(
    judgement: TravelJudgement,
    candidates: Sequence[TravelCandidate],
    every: Sequence[Estimate],
    settings: Array,
    band: PredictionBand | None,
    places: Sequence[float],
    findings: Sequence[Finding],
) -> Wording:
    """Put a judgement into words."""
    named = candidates[0]
    assert named.fit is not None
    ranked = len(np.unique(judgement.blocks)) > 1
    others = [c for c in candidates[1:] if c.name in judgement.set]
    phrase = friction_of(named.title)
    settles = []
    if ranked:
        error = judgement.held_out(judgement.named)
        share = error / float(np.sqrt(np.mean(judgement.measured**2)))
        settles.append(
            f"The law predicts held-out settings to {quantity(error, 'm', 2)}, {percent(share)} of"
            " the travel (root mean square)."
        )
    settles += [
        parameter_sentence(one, other, phrase)
        for one, other in zip(named.fit.estimates, every, strict=True)
    ]
    return Wording(
        verdict=_verdict(judgement, named, others, ranked=ranked),
        lede=_lede(judgement, settings, band),
        settles=(*settles, *limits_of(named.fit)),
        cannot_tell=(*_open(judgement, candidates, others), UNKNOWN),
        measure_next=with_order(_next(judgement, settings, band, places), findings, 3),
        no_score="" if ranked else _no_score(judgement),
    )


def _verdict(
    judgement: TravelJudgement,
    named: TravelCandidate,
    others: Sequence[TravelCandidate],
    *,
    ranked: bool,
) -> str:
    """Return which law to use."""
    assert named.fit is not None
    phrase = friction_of(named.title)
    if judgement.misfit:
        found, stated = (float(np.median(x)) for x in (judgement.errors, judgement.least_errors))
        return (
            f"No law explains the travels: they are {quantity(found, 'm', 2)} from every law, and"
            f" {quantity(stated, 'm', 2)} is stated. {capital(phrase)} is the closest: check the"
            " rig, units, and values that were given."
        )
    if not judgement.explained:
        return (
            "No law explains the travels: a curve over the setting predicts held-out ones better."
            f" {capital(phrase)} is the closest."
        )
    if ranked:
        use = f"Use {phrase}"
        if not others:
            return f"{use}."
        titles = [one.title for one in others]
        return f"{use}; {not_distinguished(titles, 'these travels')}."
    values = joined([estimate_text(one) for one in named.fit.estimates])
    said = f"{capital(phrase)} with {values} explains the measurement."
    rest = sum(1 for name in judgement.evidence if name != judgement.named)
    if rest and len(others) == rest:
        said += " So does every other model."
    elif others:
        said += f" So {'do' if len(others) > 1 else 'does'} {joined([c.title for c in others])}."
    return said


def _setting(judgement: TravelJudgement, value: float) -> str:
    """Return a setting with its unit."""
    assert judgement.knob is not None
    units = {p: q.unit for p, q, _ in parameters(judgement.mechanism, "mechanism")}
    return quantity(value, units[judgement.knob[0]], 3, degrees=True)


def _lede(judgement: TravelJudgement, settings: Array, band: PredictionBand | None) -> str:
    """Return how well the travel is known, at the settings and beyond them."""
    if band is None or judgement.knob is None:
        return (
            "The trials differ in more than one parameter of the mechanism, so there is no band"
            " over a setting."
        )
    low, high = float(judgement.settings.min()), float(judgement.settings.max())
    within = (settings >= min(low, high)) & (settings <= max(low, high))
    last_for = durations(judgement.at(settings), judgement.t_end)
    cyclic = any(trial.cycles is not None for trial in judgement.trials)
    what, unit = ("mean velocity", "m/s") if cyclic else ("travel", "m")
    below, above = band.low / last_for, band.high / last_for
    half = 0.5 * (above - below)
    known = quantity(float(np.median(half[within])), unit, 2)
    word = words_of(judgement.knob[0])
    ends = _setting(judgement, low)
    span = f"With a {word} of {ends}" if low == high else (
        f"With a {word} from {ends} to {_setting(judgement, high)}")  # fmt: skip
    last = int(np.argmax(np.abs(settings)))
    return (
        f"{span}, the {what} is known to ± {known}; with {_setting(judgement, settings[last])} it"
        f" is {quantity(float(below[last]), unit, 2)} to"
        f" {quantity(float(above[last]), unit, 2)} (95 % band, whichever law holds)."
    )


def _open(
    judgement: TravelJudgement,
    candidates: Sequence[TravelCandidate],
    others: Sequence[TravelCandidate],
) -> list[str]:
    """Return what the travels do not tell."""
    said = []
    if others:
        titles = joined([in_sentence(c.title) for c in candidates if c in (candidates[0], *others)])
        said.append(f"Which of {titles} friction holds: the evidence differs by less than 100 : 1.")
    error = float(np.median(judgement.errors))
    if judgement.assumed and len(judgement.trials) > 1:
        stated = float(np.median(judgement.readings))
        beside = f", more than the {quantity(stated, 'm', 2)} stated" if judgement.stated else ""
        said.append(f"The travels scatter by {quantity(error, 'm', 2)} about every law{beside}.")
    named = candidates[0]
    assert named.fit is not None
    paths = {one.path for one in named.fit.estimates}
    known = fields_of(type(named.fit.law))
    symbols = [
        f"${known[name].symbol}$"
        for name in judgement.law_of(named.name).names
        if f"friction.{name}" not in paths
    ]
    if symbols:
        said.append(f"{joined(symbols)}: the trials hardly depend on it; the band allows for it.")
    said += [f"{c.title}: {c.dropped}" for c in candidates if c.dropped]
    return said


def _next(
    judgement: TravelJudgement,
    settings: Array,
    band: PredictionBand | None,
    places: Sequence[float],
) -> list[str]:
    """Return where another travel narrows the band most."""
    if band is None or judgement.knob is None or not places:
        return ["Measure the same rig at other settings of one parameter, such as a compression."]
    symbol = {p: q.symbol for p, q, _ in parameters(judgement.mechanism, "mechanism")}
    texts = [_setting(judgement, x) for x in places]
    ranges = []
    for place in places:
        at = int(np.argmin(np.abs(settings - place)))
        ends = (quantity(float(x[at]), "m", 2) for x in (band.low, band.high))
        ranges.append(" to ".join(ends))
    return [
        f"Set ${symbol[judgement.knob[0]]}$ to {joined(texts)}, three runs each: the laws allow"
        f" {joined(ranges)} there, and the widest place narrows the band most."
    ]


def _no_score(judgement: TravelJudgement) -> str:
    """Return why nothing is ranked."""
    if len(judgement.trials) == 1:
        return "No held-out error and no ranking: one number was measured and one was fitted."
    return (
        f"No held-out error and no ranking: all {count(len(judgement.trials), 'trial')} repeat one"
        " setting, so none can be predicted from another."
    )
