"""The verdict that a posterior gives: a law of the ladder, the band, and what stands beside.

1. **Which law**: the named one, by how much of friction it is off at most at 95 % of the places and
   where it is worst, laws that cannot be distinguished from it, and a shorter one that is as close.
2. **How well friction is known**, over all candidate laws; that of another specimen too.
3. **Its parameters**, if it holds and over all candidate laws.
4. **What stands beside it**, with its odds.
5. **What is not told.**
6. **What to measure next.**
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from stickslip.data import UNIT_LOAD, Checks, Measurement, levels_at, tells_load
from stickslip.identify.bands import Array, Foreseen, PredictionBand
from stickslip.identify.candidates import (
    MOST,
    NOT_RULED_OUT,
    UNMEASURED,
    Wording,
    friction_of,
    in_sentence,
    score_text,
)
from stickslip.identify.fits import (
    VARIES,
    as_informed,
    as_loaded,
    inputs_text,
    measured_loads,
    unvaried,
)
from stickslip.identify.judgement import NO_LAW, Finding, Judgement
from stickslip.identify.laws import TITLES
from stickslip.identify.problems.records import LOAD
from stickslip.identify.projection import MARGIN, Rung, names_of
from stickslip.identify.propose import Proposal
from stickslip.identify.verdict import (
    BandVerdict,
    LawCandidate,
    LawFit,
    at_usual_inputs,
    estimates_of,
    told_apart,
    unphysical_of,
)
from stickslip.identify.wording import (
    NO_FRICTION,
    RADIUS_SENTENCE,
    UNIT_LOAD_SENTENCE,
    Words,
    advice_sentence,
    band_sentence,
    lacking_sentences,
    load_sentence,
    nothing_further,
    of_load_text,
    outlier_sentence,
    parameter_sentence,
    relative,
    second_sentence,
    share_text,
    third_load_sentence,
    widths_text,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary
from stickslip.show.formatting import NO_VALUE, capital, count, joined, number, percent, quantity

DIFFERENT = 1.2
"""Half-width of the band of another specimen over that of those measured, from which both are
stated."""
LEAST = 1e-3
"""Probability below which no number is given."""
MOST_ODDS = 1e4
"""Odds above which no number is given."""


def title_of(judgement: Judgement, rung: Rung) -> str:
    """Return what a law is called; one that is none of `stickslip.friction` by its terms."""
    composed = judgement.problem.composition(rung.structure, rung.coefficients[None])
    if not rung.structure:
        title = NO_FRICTION
    elif composed.kind is not None:
        title = str(composed.kind.title)
    else:
        names = dict.fromkeys(name for name in names_of(rung.structure) if name != "offset")
        parts = [name for name in names if f"{name}_direction" not in names]
        title = capital(" + ".join(judgement.problem.title(name) for name in parts))
    hersey = " with a surplus over speed / load" * ("hersey" in rung.family)
    return title + hersey + of_load_text(composed)


def beside_of(judgement: Judgement, rung: Rung) -> str:
    """Return what stands beside a law, as the end of a phrase."""
    return f" with {TITLES['offset']}" if judgement.beside_of(rung) else ""


def phrase_of(judgement: Judgement, rung: Rung) -> str:
    """Return the friction of a law as one says it; terms that are no law as they are."""
    composed = judgement.problem.composition(rung.structure, rung.coefficients[None])
    title = title_of(judgement, rung)
    return friction_of(title) if composed.kind is not None else in_sentence(title)


def name_of(judgement: Judgement, rung: Rung) -> str:
    """Return the key of a law: as `--law` takes it, then what stands beside."""
    if not rung.structure:
        return "none"
    kind = judgement.problem.composition(rung.structure, rung.coefficients[None]).kind
    parts = [name for name in rung.family if name != "offset"]
    named = parts if kind is None else [kind.name]
    return " + ".join([*named, *judgement.beside_of(rung)])


def distance_text(judgement: Judgement, rung: Rung, words: Words) -> str:
    """Return by which share of friction a law differs from it, and where that is most."""
    said = share_text(rung.distance)
    if rung.worst > 1.5 * max(rung.distance, judgement.tolerance):
        at = quantity(abs(judgement.speed_of(rung)), words.speed_unit, 2)
        said += f" (worst {share_text(rung.worst)} at {at})"
    return said


def _fits(judgement: Judgement) -> bool:
    """Return whether the named law is within the tolerance, also where it differs most."""
    named, tolerance = judgement.named, judgement.tolerance
    return named.distance <= tolerance and named.worst <= 1.5 * tolerance


def law_sentence(judgement: Judgement, words: Words, wrong: Sequence[str] = ()) -> str:
    """Return which law to use, and how close it is, after what is `wrong` with the mechanism."""
    named = judgement.named
    phrase, beside = phrase_of(judgement, named), beside_of(judgement, named)
    nothing = not named.structure and not judgement.is_told
    if wrong and (nothing or judgement.is_told):
        law = "no friction stands above the noise" if nothing else f"use {phrase}{beside}"
        if not (nothing or _fits(judgement)):
            how = distance_text(judgement, named, words)
            law += f", which differs from the measured friction by {how}"
        return f"Check units, gains and signs first. {wrong[0]} If they are right, {law}."
    if nothing:
        return f"No friction stands above the noise of the {words.measured}."
    if not judgement.is_told:
        return (
            f"No law is recommended: the {words.measured} cannot distinguish friction from zero."
            f" Check units, gains and signs; {phrase}{beside} is the closest."
        )
    how, known = distance_text(judgement, named, words), f"{percent(judgement.known)} (95 %)"
    if not judgement.is_explained:
        none = "None of the laws compared" if judgement.problem.restricted else "No law"
        return (
            f"{none} describes friction to {percent(NO_LAW)}. Use the measured curve, which is"
            f" known to ± {known}; the closest law, {phrase}{beside}, differs from it by {how}."
        )
    near = named.distance <= max(MARGIN * judgement.tolerance, judgement.known)
    if _fits(judgement):
        said = f"Use {phrase}{beside}. Friction is known to ± {known}"
    elif near or named.excess <= MARGIN:
        said = (
            f"Use {phrase}{beside}. It differs from the measured friction by {how}, which is known"
            f" to ± {known}"
        )
    else:
        said = (
            f"{capital(phrase)}{beside} differs from the measured friction by {how}. Use the"
            f" measured curve where that matters; it is known to ± {known}"
        )
    others = [_other(judgement, item) for item in judgement.set[1:]]
    if others:
        more = others if len(others) < MOST else [others[0], f"{len(others) - 1} more"]
        these = "these" if words.measured.endswith("s") else "this"
        said += f"; {these} {words.measured} cannot rule out {joined(more)}"
    return f"{said}."


def _other(judgement: Judgement, rung: Rung) -> str:
    """Return a law that cannot be distinguished, with what stands beside it where that is other."""
    own, beside = beside_of(judgement, judgement.named), beside_of(judgement, rung)
    title = in_sentence(title_of(judgement, rung))
    if title == in_sentence(title_of(judgement, judgement.named)):  # a part more, or less
        for word, some, others in (
            ("with", rung.family, judgement.named.family),
            ("without", judgement.named.family, rung.family),
        ):
            parts = [judgement.problem.title(x) for x in some if x not in others]
            title += f" {word} {joined(parts)}" * bool(parts)
        return title
    return title + (beside or " alone") if beside != own else title


def simpler_sentence(judgement: Judgement) -> str:
    """Return a law of fewer parameters that is within the tolerance of the named one."""
    shorter = judgement.simpler
    if shorter is None or shorter.family in judgement.families:
        return ""
    title = capital(in_sentence(title_of(judgement, shorter))) + beside_of(judgement, shorter)
    apart = percent(judgement.apart(shorter))
    few = count(shorter.parameters, "parameter")
    return f"{title} differs by {apart} from the named law, and has {few}."


def finding_sentence(finding: Finding) -> str:
    """Return what stands beside the law, with its odds."""
    odds = finding.probability / max(1.0 - finding.probability, 1e-12)
    said = f"more than {number(MOST_ODDS)}" if odds > MOST_ODDS else number(odds, 2)
    what = "such a limit" if finding.term in ("clipping", "threshold") else "any such change"
    return f"{finding.sentence} Odds that there is {what}: {said} to 1."


def rest_sentence(velocities: Array, unit: str) -> str:
    """Return which readings are taken to be of a body at rest."""
    speeds, several = np.unique(velocities), len(velocities) > 1
    named = joined([quantity(v, unit, 2) for v in speeds[:MOST].tolist()])
    more = f" and {len(speeds) - MOST} more" if len(speeds) > MOST else ""
    return (
        f"The reading{'s' * several} at {named}{more} {'are' if several else 'is'} taken to be at"
        " rest, where friction is anything up to the break-away, and left out."
    )


def specimen_sentence(own: PredictionBand, other: PredictionBand, runs: int, unit: str) -> str:
    """Return how well friction of another specimen is known, where that is less; else nothing."""
    mine, new = (float(np.median(relative(item))) for item in (own, other))
    if new < DIFFERENT * mine:
        return ""
    return (
        f"That holds for each of the {runs} runs or specimens measured; friction of another one is"
        f" known to ± {widths_text([own, other], unit)[1]}."
    )


def probability_text(share: float) -> str:
    """Return the probability of a law, for tables."""
    return percent(share) if share >= LEAST else f"below {percent(LEAST)}"


def ladder_rows(verdict: BandVerdict) -> tuple[list[str], list[list[str]]]:
    """Return heads and rows of the ladder, the named law first: title and outcome at their ends."""
    scale, unit = verdict.scale, verdict.measurement.unit("velocity")
    first, *others = verdict.candidates
    rows = [
        [
            candidate.title,
            str(candidate.count),
            share_text(candidate.distance),
            f"{share_text(candidate.worst)} at {quantity(candidate.worst_at, unit, 2)}",
            score_text(scale, candidate.left),
            probability_text(candidate.share),
            candidate.outcome,
        ]
        for candidate in (first, *sorted(others, key=lambda candidate: candidate.count))
    ]
    rest = 1.0 - math.fsum(candidate.share for candidate in verdict.candidates)
    if rest >= LEAST:
        rows.append(["Laws not shown", *[NO_VALUE] * 4, probability_text(rest), ""])
    scatter = f"scatter, {scale.unit or verdict.score_unit}"
    return ["law", "parameters", "differs by", "worst", scatter, "probability", ""], rows


def untold_of_law(judgement: Judgement, fit: LawFit) -> Iterator[str]:
    """Yield what nothing tells of a law that is no sum of parts."""
    own = judgement.composition.own
    if own is None:
        return
    inputs = [
        {name: np.atleast_1d(x) for name, x in record.contact_inputs().items()}
        for record in fit.measurement.records()
    ]
    yield from unvaried(own.law, inputs)
    symbols = [f"${estimate.quantity.symbol}$" for estimate in fit.estimates if not estimate.known]
    if symbols:
        yield (
            f"{joined(symbols)} cannot be determined: other values explain the measurement as well."
        )


def candidate_of(
    judgement: Judgement,
    rung: Rung,
    mechanism: Mechanism,
    measurement: Measurement,
    largest_speed: float,
) -> LawCandidate:
    """Return a law of the ladder as a candidate of a verdict."""
    named = rung is judgement.named
    title = title_of(judgement, rung)
    composed, sliding, own = judgement.handed_over(rung)
    law = composed.through(sliding) if own is None else own
    result = {path: float(x[0]) for path, x in composed.rig.items()}
    values = {path: x for path, x in result.items() if path.startswith("mechanism.")}
    known = {path: q for path, q, _ in parameters(mechanism, "mechanism")}
    if not judgement.offset and "offset" in result and "mechanism.offset" in known:
        values["mechanism.offset"] = result["offset"]
    values = {path: x for path, x in values.items() if known[path].allows(x)}
    rig = vary(mechanism, "mechanism", values) if values else mechanism
    rig, loaded = as_loaded(rig, measurement)
    rig, of_inputs = as_informed(law, rig, measurement)
    intervals = judgement.intervals if named else ()
    turning = measurement.turning
    said = (*unphysical_of(composed, mechanism, intervals, turning=turning), loaded, *of_inputs)
    remarks = [remark for remark in said if remark]
    estimates = estimates_of(judgement, law, mechanism, measurement, any_law=False) if named else ()
    if of_load := {"load_exponent", "adhesion", "hersey"} & {*rung.family, *composed.rig}:
        remarks.append(load_sentence(composed.normal()))
    if (own is None or of_load) and "load" in rig.__dataclass_fields__:
        rig = vary(rig, "mechanism", {"load": composed.normal()})
    drives = bool(np.any(sliding.friction * sliding.velocity < 0.0))
    lacking = lacking_sentences(
        title,
        off=quantity(sliding.off(law, composed), measurement.unit("friction"), 2) if drives else "",
        table=own is None,
        at=inputs_text(composed.inputs, turning=measurement.turning),
        several="] * linear[" in str(law.composition),
        offset=judgement.offset and "offset" in composed.rig,
    )
    fit = LawFit(
        law=law,
        mechanism=rig,
        estimates=estimates,
        remarks=(*remarks, *lacking),
        lacking=lacking,
        judgement=judgement,
        measurement=measurement,
        structure=rung.structure,
        largest_speed=largest_speed,
        correlation=judgement.correlation if named else np.zeros((0, 0)),
    )
    alike = any(rung.family == item.family for item in judgement.set)
    return LawCandidate(
        name=name_of(judgement, rung),
        title=title + beside_of(judgement, rung),
        fit=fit,
        outcome="named" if named else NOT_RULED_OUT if alike else "",
        structure=rung.structure,
        share=rung.share,
        left=judgement.problem.scatter(rung),
        count=rung.parameters,
        distance=rung.distance,
        worst=rung.worst,
        worst_at=judgement.speed_of(rung),
    )


def readings_sentence(
    proposal: Proposal,
    places: Sequence[float],
    conditions: Mapping[str, Sequence[float]],
    measurement: Measurement,
    *,
    listed: bool = False,
) -> str:
    """Return which readings to make, at velocities and conditions (n,), and what they gain.

    Velocities, loads and inputs are in SI. Where a list of the readings does not follow the
    sentence (`listed`), it says what lists them.
    """
    texts = [quantity(v, measurement.unit("velocity"), 2) for v in places]
    for k, text in enumerate(texts if conditions else ()):
        values = {name: x[k] for name, x in conditions.items()}
        said = [quantity(values.pop(LOAD), "N", 2)] if LOAD in values else []
        said += [inputs_text(values, turning=measurement.turning)] if values else []
        texts[k] = f"{text} at {joined(said)}"
    texts = [text for _, text in sorted(zip(places, texts, strict=True))]
    return advice_sentence(proposal, texts, listed=listed) if texts else nothing_further(proposal)


def ladder_verdict(
    judgement: Judgement,
    mechanism: Mechanism,
    measurement: Measurement,
    words: Words,
    *,
    checks: Checks,
    proposal: Proposal,
    places: Sequence[float],
    conditions: Mapping[str, tuple[float, ...]] = MappingProxyType({}),
    advice: Sequence[str] = (),
    largest_speed: float,
    route: str,
    foreseer: Callable[[Measurement], Foreseen],
    second: Measurement | None = None,
    foreseen: Foreseen | None = None,
    remarks: Sequence[str] = (),
) -> BandVerdict:
    """Return the verdict of a judgement, in words."""
    if "offset" not in mechanism.__dataclass_fields__ and not judgement.problem.fitted:
        judgement = replace(judgement, offset=True)
    rows = judgement.problem.asked()
    band = judgement.band(rows)
    # laws that cannot be distinguished stand with those of the ladder
    shown = {item.family: item for item in (judgement.named, *judgement.set, *judgement.ladder)}
    candidates = tuple(
        candidate_of(judgement, item, mechanism, measurement, largest_speed)
        for item in shown.values()
    )
    titles = {name: judgement.problem.title(name) for item in shown for name in item}
    candidates = told_apart(candidates, titles)
    first = candidates[0]
    assert first.fit is not None
    every = estimates_of(judgement, first.fit.law, mechanism, measurement, any_law=True)
    phrase = phrase_of(judgement, judgement.named)
    both = zip(first.fit.estimates, every, strict=True)
    said = [
        parameter_sentence(own, other, phrase)
        for own, other in both
        if judgement.is_explained or not own.path.startswith("friction.")  # else it does not hold
    ]
    other = judgement.band(rows, new=True) if judgement.problem.runs > 1 else None
    lede = band_sentence(rows.velocity, band, words, offset="offset" in judgement.beside)
    if other is not None:
        more = specimen_sentence(band, other, judgement.problem.runs, words.force_unit)
        lede = " ".join(filter(None, (lede, more)))
    unphysical = unphysical_of(
        judgement.composition,
        mechanism,
        judgement.intervals,
        turning=measurement.turning,
        # where a law describes friction, an interval that holds possible values raises no doubt
        sure=judgement.named.distance < NO_LAW,
    )
    mistakes = [item.sentence for item in judgement.findings if item.asserted and item.is_mistake]
    wrong = [*unphysical, *mistakes]
    if wrong and lede:
        lede = f"If units, gains and signs are right: {in_sentence(lede)}"
    left = first.left / judgement.problem.size
    scatter = "scatter" if words.measured.endswith("s") else "scatters"
    settles = [
        f"The {words.measured} {scatter} about the law by"
        f" {quantity(first.left, words.force_unit, 2)} (root mean square)"
        + (f", {percent(left)} of friction." if left <= 1.0 else "."),
        *filter(None, (simpler_sentence(judgement),)),
        *said,
    ]
    doubts = [finding_sentence(finding) for finding in judgement.findings if finding.asserted]
    doubts += judgement.problem.untold()
    doubts += untold_of_law(judgement, first.fit)
    if far := judgement.outliers:
        doubts.append(outlier_sentence([*far], [*far.values()]))
    if foreseen is not None:
        doubts.append(second_sentence(foreseen))
    of_load = {"load_exponent", "adhesion"} & {item.path for item in every}
    if of_load or "hersey" in judgement.family:
        doubts.append(load_sentence(judgement.composition.normal()))
    if measurement.turning and (levels_at(mechanism) == "per load" or tells_load(measurement)):
        doubts.append(RADIUS_SENTENCE)
    doubts += [UNIT_LOAD_SENTENCE] * any(UNIT_LOAD in x.provenance for x in measurement.records())
    doubts += [*at_usual_inputs(first.fit), *first.fit.lacking, *remarks, UNMEASURED]
    said_next = []
    loads = np.unique(measured_loads(measurement))
    loads = loads[np.diff(loads, prepend=-math.inf) > VARIES * loads]
    if len(loads) == 2 and of_load:
        said_next.append(third_load_sentence(loads))
    if words.measured == "readings":
        said_next.append(readings_sentence(proposal, places, conditions, measurement))
    said_next += advice
    return BandVerdict(
        mechanism=first.fit.mechanism,
        measurement=measurement,
        words=Wording(
            verdict=law_sentence(judgement, words, wrong),
            lede=lede,
            settles=tuple(settles),
            cannot_tell=tuple(doubts),
            measure_next=tuple(said_next),
            no_score="",
        ),
        candidates=candidates,
        best=first if judgement.is_told else None,
        ranked=True,
        judgement=judgement,
        speeds=rows.velocity,
        friction=band,
        other_specimen=other,
        checks=checks,
        route_name=route,
        second=second,
        foreseen=foreseen,
        foreseer=foreseer,
        shrinks=proposal.shrinks,
        halves=proposal.halves,
        places=tuple(places),
        conditions={**conditions},
        intervals=every,
    )
