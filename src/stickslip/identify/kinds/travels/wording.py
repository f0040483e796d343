"""The verdict on travels in words: the law, the band over the setting, and what narrows it.

Symbols stand between dollar signs, which reports typeset.
"""

from collections import Counter
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Finding, with_order
from stickslip.identify import THRESHOLDS, PredictionBand, TravelJudgement, parameter_sentence
from stickslip.identify.candidates import Wording, friction_of, in_sentence, not_distinguished
from stickslip.identify.criteria import limits_of
from stickslip.identify.fits import Estimate, durations
from stickslip.identify.kinds.travels.fit import words_of
from stickslip.identify.kinds.travels.verdict import TravelCandidate, estimate_text, what_of
from stickslip.quantities import fields_of, parameters
from stickslip.show.formatting import at_worst, capital, count, joined, percent, quantity, scale_of

Array: TypeAlias = NDArray[np.float64]

UNKNOWN = "Travels beyond the settings of the band, and friction at other loads, are not known."


def wording(
    judgement: TravelJudgement,
    candidates: Sequence[TravelCandidate],
    every: Sequence[Estimate],
    settings: Array,
    band: PredictionBand | None,
    advised: tuple[Sequence[float], float],
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
        lasts = durations(judgement.trials, judgement.t_end)
        what, unit = what_of(judgement.trials)
        off = judgement.best_of(judgement.named).held_out / lasts
        sizes = [float(np.sqrt(np.mean(x**2))) for x in (off, judgement.measured / lasts)]
        settles.append(
            f"The law predicts held-out settings to {quantity(sizes[0], unit, 2)},"
            f" {percent(sizes[0] / sizes[1])} of the {what} (root mean square)"
            f"{_worst(judgement, off, unit)}."
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
        measure_next=with_order(_next(judgement, band, advised), findings, 3),
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


def _worst(judgement: TravelJudgement, off: Array, unit: str) -> str:
    """Return where the largest held-out error is, if it makes most of their squares."""
    at, sizes = int(np.argmax(np.abs(off))), np.abs(off)
    if (
        judgement.knob is None
        or sizes[at] ** 2 < 0.5 * float(np.sum(sizes**2))
        or len(off) <= THRESHOLDS.fewest
    ):
        return ""
    place = _setting(judgement, float(judgement.settings[at]))
    return f", worst at {place}, by {quantity(float(sizes[at]), unit, 2)}"


def _lede(judgement: TravelJudgement, settings: Array, band: PredictionBand | None) -> str:
    """Return how well the travel is known, at the settings and beyond them."""
    if band is None or judgement.knob is None:
        alike = len(np.unique(judgement.blocks)) == 1
        how = "do not differ in a" if alike else "differ in more than one"
        return f"The trials {how} parameter of the mechanism, so there is no band over a setting."
    low, high = float(judgement.settings.min()), float(judgement.settings.max())
    inside = np.flatnonzero((settings >= min(low, high)) & (settings <= max(low, high)))
    lasts, (what, unit) = (
        durations(judgement.at(settings), judgement.t_end),
        what_of(judgement.trials),
    )
    ends = np.array([band.low, band.high]) / lasts
    half = 0.5 * (ends[1] - ends[0])
    typical, widest = float(np.median(half[inside])), int(inside[np.argmax(half[inside])])
    word, first = words_of(judgement.knob[0]), _setting(judgement, low)
    span = f"With a {word} of {first}" if low == high else (
        f"With a {word} from {first} to {_setting(judgement, high)}")  # fmt: skip
    said = f"{span}, the {what} is known to ± {quantity(typical, unit, 2)}"
    if half[widest] > 1.5 * typical:
        place = _setting(judgement, float(settings[widest]))
        said += at_worst(quantity(float(half[widest]), unit, 2), place)

    def range_at(k: int) -> str:
        pair = ends[:, k].tolist()
        return scale_of(pair, unit).interval(*pair)

    sizes = np.abs(band.median / lasts)
    if unit == "m/s":
        best = int(inside[np.argmax(sizes[inside])])
        said += f"; it is largest at {_setting(judgement, float(settings[best]))}, {range_at(best)}"
    last = int(np.argmax(np.abs(settings)))
    rests = float(np.max(np.abs(ends[:, last]))) < THRESHOLDS.negligible * float(np.max(sizes))
    far = "the body stays where it is" if rests else f"it is {range_at(last)}"
    place = _setting(judgement, float(settings[last]))
    return f"{said}; with {place} {far} (95 % band over all candidate laws)."


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
        most = max(candidates, key=lambda one: one.share)
        if most.share > candidates[0].share:
            said[-1] += (
                f" {most.title} predicts held-out settings best, and so is {percent(most.share)} of"
                f" the band; {in_sentence(candidates[0].title)} is named, as it fits with fewer or"
                " more usual parts."
            )
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
    band: PredictionBand | None,
    advised: tuple[Sequence[float], float],
) -> list[str]:
    """Return where readings narrow the band most."""
    places, shrinks = advised
    if band is None or judgement.knob is None:
        such = "compression" if judgement.knob is None else words_of(judgement.knob[0])
        return [f"Measure the same rig at other settings of one parameter, such as a {such}."]
    what = what_of(judgement.trials)[0]
    if not places:
        return [f"Further readings of the {what} hardly narrow its band."]
    known = {p: q.symbol for p, q, _ in parameters(judgement.mechanism, "mechanism")}
    parts = [_setting(judgement, x) + f" ({n} runs)" * (n > 1) for x, n in Counter(places).items()]
    many = count(len(places), "reading there is", "readings there are")
    return [
        f"Set ${known[judgement.knob[0]]}$ to {joined(parts)}: {many} expected to narrow the band"
        f" of the {what} to {percent(shrinks)} of its width."
    ]


def _no_score(judgement: TravelJudgement) -> str:
    """Return why nothing is ranked."""
    if len(judgement.trials) == 1:
        return "No held-out error and no ranking: one number was measured and one was fitted."
    return (
        f"No held-out error and no ranking: all {count(len(judgement.trials), 'trial')} repeat one"
        " setting, so none can be predicted from another."
    )
