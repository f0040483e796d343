"""Every sentence of a verdict, in one place: the law, the band, and what narrows it.

There are eleven kinds: which law; how well friction is known; each parameter; laws that are not
told apart; a cause beside the law, with the share it explains; a feature that what is left follows;
readings far from the others; what the order of the readings hides; what a second measurement says;
what other measurements would differ by; what to measure next.
"""

import itertools
import math
from collections.abc import Sequence, Set
from dataclasses import dataclass

import numpy as np

from stickslip.friction import law as law_class
from stickslip.identify.bands import PredictionBand
from stickslip.identify.candidates import MOST, friction_of, in_sentence
from stickslip.identify.explorer import Pattern
from stickslip.identify.fits import Estimate
from stickslip.identify.judge import Cause, Judgement
from stickslip.identify.laws import RATIOS, TITLES, Composition
from stickslip.identify.posterior import family_of
from stickslip.identify.problem import ALIKE, Array, Structure
from stickslip.identify.propose import Proposal
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.show.formatting import (
    at_worst,
    capital,
    interval,
    joined,
    number,
    percent,
    quantity,
    span,
    with_unit,
    within,
)

BESIDE = ("rig", "run", "fault")
"""Roles of terms beside a law."""


@dataclass(frozen=True, kw_only=True)
class Words:
    """How a kind of measurement calls things."""

    measured: str
    """What was measured, such as ``"readings"``."""
    held_out: str
    """What is predicted from the others, such as ``"speeds"``."""
    response: str
    """What is predicted of these: ``"friction"``, or the ``"force"`` of a balance."""
    force_unit: str
    speed_unit: str


NO_FRICTION = "No friction"
"""Title of what holds no term of a law."""


def title_of(judgement: Judgement, structure: Structure) -> str:
    """Return what the law of a structure is called.

    A structure that is no law of `stickslip.friction` is called by its terms.
    """
    fit = judgement.ensemble.fit(structure)
    composed = judgement.problem.composition(structure, fit.coefficients[None])
    terms = judgement.problem.terms
    parts = [terms[name].title for name in family_of(structure) if terms[name].role == "law"]
    # a law without parts is written as a level of 0, and has none
    title = capital(" + ".join(parts)) or NO_FRICTION
    if composed.text and parts:
        title = str(law_class(composed.text).title)
    return title + of_load_text(composed)


def of_load_text(composed: Composition) -> str:
    """Return how friction depends on the load, as the end of a title; nothing if in proportion.

    Examples
    --------
    >>> rig = {"load_exponent": np.array([0.5]), "adhesion": np.array([2.0])}
    >>> of_load_text(Composition(text="", values={}, rig=rig))
    ' with the load to the power 0.5 with a level that no load changes'
    """
    exponent = composed.rig.get("load_exponent")
    said = ""
    if exponent is not None and abs(float(exponent[0]) - 1.0) > 1e-9:
        said = f" with the load to the power {number(float(exponent[0]), 2)}"
    return said + (f" with a {TITLES['adhesion']}" if "adhesion" in composed.rig else "")


def phrase_of(judgement: Judgement, structure: Structure) -> str:
    """Return the friction of a structure as one says it; terms that are no law as they are."""
    title = title_of(judgement, structure)
    fit = judgement.ensemble.fit(structure)
    composed = judgement.problem.composition(structure, fit.coefficients[None])
    return friction_of(title) if composed.text and title != NO_FRICTION else in_sentence(title)


def beside_of(
    judgement: Judgement, structure: Structure, *, doubted: Set[str] = frozenset()
) -> str:
    """Return what a structure holds beside its law, as the end of a phrase.

    Terms that are doubted are said to be what something may be.
    """
    problem = judgement.problem
    beside = [
        f"what may be {problem.terms[name].title}" if name in doubted else problem.terms[name].title
        for name in family_of(structure)
        if problem.terms[name].role in BESIDE and name not in problem.always
    ]
    return f" with {joined(beside)}" if beside else ""


def law_sentence(judgement: Judgement, words: Words) -> str:
    """Return which law to use."""
    comparison = judgement.comparison
    doubted = {one.term for one in judgement.causes if not one.asserted}
    named, own = comparison.named, beside_of(judgement, comparison.named, doubted=doubted)
    phrase = phrase_of(judgement, named)
    others = _others(judgement, title_of(judgement, named), beside_of(judgement, named))
    if not judgement.is_explained:
        none = none_text(restricted=bool(judgement.problem.only))
        return (
            f"{none} explains the {words.measured}: a curve over the speed predicts held-out"
            f" {words.held_out} better. {capital(phrase)}{own} is the closest."
        )
    if not comparison.named:
        return no_friction_sentence(words)
    said = f"Use {phrase}{own}"
    if not others:
        return f"{said}."
    more = others if len(others) < MOST else [others[0], f"{len(others) - 1} more"]
    these = (
        f"these {words.measured} do"
        if words.measured.endswith("s")
        else (f"this {words.measured} does")
    )
    return f"{said}; {these} not tell it from {joined(more)}."


def _others(judgement: Judgement, title: str, own: str) -> list[str]:
    """Return laws that are not told apart, with what stands beside them where that is other."""
    found = dict[str, None]()
    for one in judgement.comparison.set[1:]:
        beside = beside_of(judgement, one)
        other = in_sentence(title_of(judgement, one))
        if beside != own or other == in_sentence(title):
            other += beside or " alone"
        found[other] = None
    return [*found]


def tells_friction(judgement: Judgement, band: PredictionBand) -> bool:
    """Return whether friction is told from zero: by its band, or by far by that of the named law.

    The band tells it at most places, or at most of those where friction is large: what grows with
    the speed is next to zero at low ones.
    """
    if not judgement.named:
        return judgement.is_noise
    share, size = relative(band), np.abs(band.median)
    large = size >= 0.5 * size.max()
    told = min(np.median(share), np.median(share[large])) <= 1.0
    told = told or np.min(relative(judgement.named_band)) <= 1.0 / THRESHOLDS.told
    return bool(told and np.median(size) > 0.0)


def relative(band: PredictionBand) -> Array:
    """Return half the width of a band over its median (n,), which counts as a tenth at least."""
    size = np.abs(band.median)
    least = 0.1 * float(np.median(size)) + 1e-300
    return np.asarray(0.5 * (band.high - band.low) / np.maximum(size, least))


def untold_sentence(judgement: Judgement, words: Words) -> str:
    """Return that no law can be recommended, as friction may be zero."""
    beside = beside_of(judgement, judgement.named)
    return from_zero_sentence(phrase_of(judgement, judgement.named) + beside, words)


def from_zero_sentence(closest: str, words: Words) -> str:
    """Return that friction may be zero, and which law is closest."""
    these = "do" if words.measured.endswith("s") else "does"
    return (
        f"No law is recommended: the {words.measured} {these} not tell friction from zero. Check"
        f" units, gains and signs; {closest} is the closest."
    )


def no_friction_sentence(words: Words) -> str:
    """Return that there is no friction to be seen."""
    return f"No friction stands above the noise of the {words.measured}."


def none_text(*, restricted: bool) -> str:
    """Return that no law does something, or none of those that were compared."""
    return "None of the laws compared" if restricted else "No law"


def range_of(speeds: Array, unit: str) -> str:
    """Return over which velocities (n,) something is stated, each direction as it was moved in.

    Examples
    --------
    >>> range_of(np.array([-1.0, -0.5, 0.5, 1.0]), "m/s"), range_of(np.array([0.5, 1.0]), "m/s")
    ('from 0.5 to 1 m/s in both directions', 'from 0.5 to 1 m/s')
    >>> range_of(np.array([-0.02, -0.01, 0.5, 1.0]), "m/s")
    'from −20 to −10 mm/s and from 0.5 to 1 m/s'
    """
    sides = [side for side in (speeds[speeds < 0.0], speeds[speeds > 0.0]) if len(side)]
    ends = [(float(side.min()), float(side.max())) for side in sides]
    if len(ends) == 2:
        (high, low), other = (-ends[0][0], -ends[0][1]), ends[1]
        if max(abs(math.log(low / other[0])), abs(math.log(high / other[1]))) <= ALIKE:
            both = span(max(low, other[0]), min(high, other[1]), unit)
            return f"from {both} in both directions"
    return joined([f"from {span(low, high, unit)}" for low, high in ends])


def band_sentence(
    speeds: Array, band: PredictionBand, words: Words, *, offset: bool = False
) -> str:
    """Return how well friction is known over the speeds, whichever law holds.

    The band holds a constant offset where there may be one.
    """
    what = "friction with the constant offset" if offset else "friction"
    share = relative(band)
    middle, worst = float(np.median(share)), int(np.argmax(share))
    over = capital(range_of(speeds, words.speed_unit))
    if middle > 1.0:
        farthest = max(float(np.max(np.abs(band.low))), float(np.max(np.abs(band.high))))
        reach = quantity(farthest, words.force_unit, 2)
        return f"{over}, {what} is within ± {reach} of zero (95 % band, whichever law holds)."
    said = f"{over}, {what} is known to ± {percent(middle)}"
    if share[worst] > 1.5 * middle:
        at = quantity(float(speeds[worst]), words.speed_unit, 2)
        said += at_worst(percent(float(share[worst])), at)
    return f"{said} (95 % band, whichever law holds)."


def error_sentence(judgement: Judgement, words: Words) -> str:
    """Return how well the named law predicts what is held out."""
    error = judgement.held_out_error(judgement.named)
    size = float(np.sqrt(np.mean(judgement.problem.response**2)))
    share = f", {percent(error / size)} of the {words.response}" if size > 0.0 else ""
    return (
        f"The law predicts held-out {words.held_out} to"
        f" {quantity(error, words.force_unit, 2)}{share} (root mean square)."
    )


def parameter_sentence(estimate: Estimate, other: Estimate, phrase: str) -> str:
    """Return an interval under the named law, and whichever law of the set has the parameter."""
    unit = estimate.quantity.unit
    value = with_unit(within(estimate.value, estimate.low, estimate.high), unit)
    own = interval(estimate.low, estimate.high)
    said = f"${estimate.quantity.symbol}$ = {value}: {own} if {phrase} holds"
    if (other.low, other.high) != (estimate.low, estimate.high):
        said += f", {interval(other.low, other.high)} over all laws that have it"
    return f"{said}."


def cause_sentence(cause: Cause, size: Estimate | None, words: Words, *, told: bool = True) -> str:
    """Return a property of the rig or a fault, with the share that it explains.

    Where friction is not told from zero beside it, it may be something else.
    """
    what = capital(cause.title) + (f": {_sized(cause, size)}" if size else "")
    if size is not None and cause.term in RATIOS:
        if size.low <= 1.0 <= size.high:
            return f"{what}, consistent with what is given."
    elif size is not None and size.low <= 0.0 <= size.high:
        return f"{what}, consistent with zero."
    if cause.left > THRESHOLDS.explained:
        return f"{what}; it explains little of what is measured, most stays unexplained."
    if cause.share <= 0.01:
        return f"{what}; without it, held-out {words.held_out} are predicted as well."
    share = percent(min(cause.share, 0.999))
    said = f"{what}: it takes {share} off the squared error of held-out {words.held_out}"
    if not told:
        return f"{said}, but friction is not told from zero beside it: it may be something else."
    if not cause.asserted:
        return f"{said}, and most of what noise does not explain is left: it may be something else."
    if not cause.needed:
        return f"{said}; a law without it is not told apart."
    return (
        f"{said}, which leaves {percent(math.sqrt(max(cause.left, 0.0)))} of what the"
        f" {words.response} varies by."
    )


def _sized(cause: Cause, size: Estimate) -> str:
    """Return an estimate with its interval, where there is one: some shapes are of a grid."""
    if cause.term in RATIOS:
        value = within(size.value, size.low, size.high)
        return RATIOS[cause.term].format(f"{value} ({size.range})")
    if size.low < size.high:
        return str(size).replace(size.quantity.symbol, f"${size.quantity.symbol}$", 1)
    return f"${size.quantity.symbol}$ = {with_unit(number(size.value, 2), size.quantity.unit)}"


def pattern_sentence(pattern: Pattern, words: Words) -> str:
    """Return which feature what the law leaves follows; a feature is no cause."""
    share = percent(pattern.share)
    if pattern.scatter:
        return (
            f"The scatter about the law follows the {pattern.feature}, which explains {share} of"
            f" its logarithm in held-out {words.held_out}."
        )
    return (
        f"What the law leaves follows the {pattern.feature}: {share} of the squared error of"
        f" held-out {words.held_out}, {percent(pattern.of_force)} of the"
        f" {words.response}."
    )


def group_sentence(titles: Sequence[str], words: Words) -> str:
    """Return that a design does not tell terms apart."""
    named = [in_sentence(one) for one in titles[:MOST]]
    kind = words.measured.removesuffix("s")
    return f"{capital(' or '.join(named))}: not separable by this design of the {kind}."


def presliding_sentence(length: str) -> str:
    """Return up to which length (with its unit) the record tells no bristle from none."""
    return (
        f"Presliding over up to {length} does not show in this record: friction may give way like a"
        " spring over as much at each turn."
    )


def outlier_sentence(rows: Sequence[int], far: Sequence[float]) -> str:
    """Return which readings are far from the others."""
    named = joined([str(row + 1) for row in itertools.islice(rows, MOST)])
    more = f" and {len(rows) - MOST} more" if len(rows) > MOST else ""
    lies, weighs = ("lies", "weighs") if len(rows) == 1 else ("lie", "weigh")
    reading = "Reading" if len(rows) == 1 else "Readings"
    return (
        f"{reading} {named}{more} {lies} {number(max(far), 2)} standard deviations from the others,"
        f" and {weighs} accordingly less: check {'it' if len(rows) == 1 else 'them'}."
    )


ORDERED = (
    "The speeds were measured in their order: a drift, such as warming or wear, would pass for an"
    " effect of the speed. Measure them in random order, or some again at the end."
)


OTHERS = (
    "One record says nothing of how much others of the same machine differ: the band allows for as"
    " much as single stretches of it do. A second record (--validate) measures it."
)


SCALED = (
    "A free motion tells friction over inertia only: friction is as uncertain as the mass or"
    " inertia that was given, 1 % of which is 1 % of friction."
)


DIFFER = (
    "The records differ by more than stretches of one do: the law is an average of them, and the"
    " band allows for it."
)


def widened_sentence(times: float) -> str:
    """Return what a second record that differs makes of the band."""
    return (
        "The second record differs by more than stretches of the first do: the band is"
        f" {number(times, 2)} times as wide as the first record alone would make it."
    )


UNDAMPED = (
    "The force balance does not tell the damping of bristles, which is 0 here: use `fit` of LuGre"
    " for it."
)


def advice_sentence(proposal: Proposal, places: Sequence[str]) -> str:
    """Return what to measure next, at places in the order of the speeds, and what it gains."""
    counts: dict[str, int] = {}
    for place in places:
        counts[place] = counts.get(place, 0) + 1
    expected = f"the band is then expected to be {percent(proposal.shrinks)} as wide"
    if len(counts) <= MOST:
        named = [place if n == 1 else f"{place} ({n} readings)" for place, n in counts.items()]
        return f"Measure at {joined(named)}: {expected}."
    most = sorted(counts, key=lambda place: -counts[place])[:MOST]
    named = [f"{place} ({counts[place]})" for place in counts if place in most]
    first, *_, last = counts
    said = f"Take {len(places)} readings at {len(counts)} velocities from {first} to {last}"
    if len(places) > len(counts):
        said += f", the most at {joined(named)}"
    return f"{said} (all are in verdict.json): {expected}."


def third_load_sentence(loads: Array) -> str:
    """Return which load to measure at where two (2,) [N] leave open how friction depends on it."""
    between = quantity(float(np.sqrt(loads[0] * loads[1])), "N", 2)
    return (
        f"Measure at a third load, such as {between} or beyond both: two do not tell a power of the"
        " load from a part of friction that no load changes."
    )


def usual_sentence(estimate: Estimate, level: float, half: float, at: str) -> str:
    """Return what a parameter is at the usual values of inputs, within half, and not at 0."""
    value = with_unit(within(level, level - half, level + half), estimate.quantity.unit)
    own = interval(level - half, level + half)
    symbol = estimate.quantity.symbol
    return f"The law states ${symbol}$ for inputs of 0; at {at}, the median, it is {value} ({own})."


def load_sentence(load: float) -> str:
    """Return at which load [N] a law stands where friction is not in proportion to it."""
    return (
        f"Friction is not in proportion to the load: levels are those at {quantity(load, 'N')}, and"
        " what is simulated with this law holds there."
    )


def lacking_sentences(
    title: str,
    lacks: Sequence[str],
    *,
    table: bool,
    off: str,
    offset: bool,
    at: str,
    several: bool,
) -> tuple[str, ...]:
    """Return what a law that is handed over has otherwise than a title says, or not at all.

    It may be a `table`, be `off` by a force where friction would drive, or hold the `offset`. `at`
    are the means of inputs, of which there may be `several`.
    """
    there = f" at {at}" if at else ""
    driven = f", from which it is off by up to {off} where friction would drive" if off else ""
    each = (
        f"No law of stickslip.friction can carry {in_sentence(title)}: what is handed over is a"
        f" table of its levels{there} in both directions, constant beyond them{driven}." * table,
        f"What changes with several inputs is a product in the law, not a sum: both are the same"
        f"{there}." * several,
        f"The law slides as the record says, but lacks {joined([*map(in_sentence, lacks)])}, which"
        " no law of stickslip.friction has." * (bool(lacks) and not table),
        "The mechanism has no constant force: the offset is in the levels of the law, which differ"
        " by direction. If it is the zero of the sensor, subtract it from the readings." * offset,
    )
    return tuple(filter(None, each))


def start_sentence(places: Sequence[str]) -> str:
    """Return where records without positions are taken to begin."""
    named = joined(
        [*places[:MOST], *([f"{len(places) - MOST} more"] if len(places) > MOST else [])]
    )
    return (
        f"No position was recorded, and forces of the mechanism depend on it: the motion is taken"
        f" to begin at {named}, where these explain most of it. A bias of the velocity would pass"
        " for friction: record the position."
    )


def hold_sentence(*, held: bool, doubt: float) -> str:
    """Return how a force is taken to run between samples, and how sure that is.

    The doubt is the standard deviation of when it acts, over half a sample.
    """
    how = "keep its value until the next sample" if held else "go straight from sample to sample"
    return (
        f"The force is taken to {how}, which does not show clearly: when it acts counts as"
        f" uncertain by {number(0.5 * doubt, 2)} samples (standard deviation). If it is known, give"
        " `hold`."
    )


def second_sentence(share: float, count: int) -> str:
    """Return how many readings of a second measurement lie in the band of readings."""
    said = f"{percent(share)} of the {count:,} readings of the second measurement lie in the band"
    if share >= THRESHOLDS.second:
        return f"{said}, as expected."
    return f"{said} in which 95 % should: it differs by more than this measurement shows."
