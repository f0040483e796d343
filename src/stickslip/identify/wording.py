"""Sentences of a verdict that the ladder, laws and joints share."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.identify.bands import ALIKE, Foreseen, PredictionBand
from stickslip.identify.candidates import MOST, in_sentence
from stickslip.identify.fits import Estimate
from stickslip.identify.laws import TITLES, Composition
from stickslip.identify.posterior import Array
from stickslip.identify.propose import COUNTED, WORTH, Proposal
from stickslip.quantities import Quantity
from stickslip.show.formatting import (
    at_worst,
    capital,
    in_words,
    interval,
    joined,
    number,
    percent,
    quantity,
    span,
    with_unit,
    within,
)


@dataclass(frozen=True, kw_only=True)
class Words:
    """How a kind of measurement calls things."""

    measured: str
    """What was measured, such as ``"readings"``."""
    force_unit: str
    speed_unit: str


NO_FRICTION = "No friction"
"""Title of what holds no term of a law."""


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


def relative(band: PredictionBand) -> Array:
    """Return half the width of a band over its median (n,), which counts as a tenth at least."""
    size = np.abs(band.median)
    least = 0.1 * float(np.median(size)) + 1e-300
    return np.asarray(0.5 * (band.high - band.low) / np.maximum(size, least))


def share_text(share: float) -> str:
    """Return by which share of friction a law is off.

    Examples
    --------
    >>> share_text(0.5), share_text(3.0)
    ('50 %', 'over 100 %')
    """
    return percent(share) if share <= 1.0 else "over 100 %"


def widths_text(bands: Sequence[PredictionBand], unit: str) -> list[str]:
    """Return half the width of bands: a share of friction, or a force if one is above 100 %."""
    shares = [float(np.median(relative(item))) for item in bands]
    if max(shares) <= 1.0:
        return [percent(share) for share in shares]
    return [quantity(float(np.median(0.5 * (x.high - x.low))), unit, 2) for x in bands]


def range_of(speeds: Array, unit: str) -> str:
    """Return over which velocities (n,) something is stated, each direction as it was moved in.

    Examples
    --------
    >>> range_of(np.array([-1.0, -0.5, 0.5, 1.0]), "m/s"), range_of(np.array([0.5, 1.0]), "m/s")
    ('from 0.5 to 1 m/s in both directions', 'from 0.5 to 1 m/s')
    >>> range_of(np.array([-0.02, -0.01, 0.5, 1.0]), "m/s")
    'from −20 to −10 mm/s and from 0.5 to 1 m/s'
    >>> range_of(np.array([0.5, 0.5]), "m/s")
    'at 0.5 m/s'
    """
    sides = [side for side in (speeds[speeds < 0.0], speeds[speeds > 0.0]) if len(side)]
    ends = [(float(side.min()), float(side.max())) for side in sides]
    if len(ends) == 2:
        (high, low), other = (-ends[0][0], -ends[0][1]), ends[1]
        if max(abs(math.log(low / other[0])), abs(math.log(high / other[1]))) <= ALIKE:
            both = span(max(low, other[0]), min(high, other[1]), unit)
            return f"{_over(both)} in both directions"
    return joined([_over(span(low, high, unit)) for low, high in ends])


def _over(ends: str) -> str:
    """Return a span with its preposition."""
    return f"{'from' if ' to ' in ends else 'at'} {ends}"


def band_sentence(
    speeds: Array, band: PredictionBand, words: Words, *, offset: bool = False
) -> str:
    """Return how well friction is known over the speeds, for all candidate laws.

    The band holds a constant offset where there may be one.
    """
    what = "friction with the constant offset" if offset else "friction"
    share = relative(band)
    middle, worst = float(np.median(share)), int(np.argmax(share))
    over = capital(range_of(speeds, words.speed_unit))
    if middle > 1.0:
        ends = np.abs([band.low, band.high])
        reach = span(float(ends.min()), float(ends.max()), words.force_unit, 2)
        if not band.brakes(speeds):
            farthest = quantity(float(ends.max()), words.force_unit, 2)
            reach = f"within ± {farthest} of zero"
        return f"{over}, {what} is {reach} (95 % band over all candidate laws)."
    said = f"{over}, {what} is known to ± {percent(middle)}"
    if share[worst] > 1.5 * middle:
        at = quantity(float(speeds[worst]), words.speed_unit, 2)
        said += at_worst(share_text(float(share[worst])), at)
    return f"{said} (95 % band over all candidate laws)."


def parameter_sentence(estimate: Estimate, other: Estimate, phrase: str) -> str:
    """Return an interval over all laws that have the parameter, and that under the named law."""
    unit = estimate.quantity.unit
    value = with_unit(within(other.value, other.low, other.high), unit)
    said = f"${estimate.quantity.symbol}$ = {value} (95 %: {interval(other.low, other.high)}"
    if (other.low, other.high) != (estimate.low, estimate.high):
        said += f" over all laws that have it, {interval(estimate.low, estimate.high)} if {phrase}"
        said += " holds"
    return f"{said})."


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
    "The {0}s were measured in their order: a drift, such as warming or wear, would pass for an"
    " effect of the {0}. Measure them in random order, or some again at the end."
)


SCALED = (
    "A free motion determines only the ratio of friction to inertia: an error of 1 % in the given"
    " mass or inertia is an error of 1 % in friction."
)


NO_READINGS = (
    "Further readings of these runs are not expected to narrow the band by a twentieth: measure"
    " another run or specimen, as a further trial."
)


DRIFTING = (
    "Friction drifts, and further readings are expected to widen the band to {} of today's while it"
    " does: remove the cause, or begin where friction is steady."
)


def nothing_further(proposal: Proposal) -> str:
    """Return why no readings are proposed."""
    wider = proposal.shrinks * WORTH > 1.0
    return DRIFTING.format(percent(proposal.shrinks)) if wider else NO_READINGS


BOTH_WAYS = (
    "Friction of this free motion is the mean of both directions: a level that differs by direction"
    " cannot be distinguished from the zero of the position."
)
"""What is said of a free motion to and fro."""
GAIN = (
    "The recorded force is {} times that which acts, as inertia and forces of the mechanism show,"
    " if both are as given: friction is by the force divided by that."
)
"""What is said first where two known forces have one factor."""
NO_RECORDS = (
    "Further records are not expected to narrow the band of another run by a twentieth: these runs"
    " already show by how much runs differ."
)


def advice_sentence(proposal: Proposal, places: Sequence[str], *, listed: bool = False) -> str:
    """Return what to measure next, at places in the order of the speeds, and what it gains.

    It says what lists many readings, if no list follows.
    """
    counts: dict[str, int] = {}
    for place in places:
        counts[place] = counts.get(place, 0) + 1
    expected = f"the band is expected to narrow to {percent(proposal.shrinks)} of its width"
    if (proposal.halves or 0) > len(places):
        expected += f"; about {proposal.halves} such readings would halve it"
    elif proposal.halves is None and proposal.least > 0.5:
        expected += f"; even {COUNTED} such readings would not halve it"
    if len(counts) <= MOST:
        named = [p if n == 1 else f"{p} ({n} readings)" for p, n in counts.items()]
        return f"Measure at {joined(named)}: {expected}."
    most = sorted(counts, key=lambda place: -counts[place])[:MOST]
    named = [f"{place} ({counts[place]})" for place in counts if place in most]
    first, *_, last = counts
    what = "settings" if " at " in first else "velocities"
    said = f"Take {len(places)} readings at {len(counts)} {what} from {first} to {last}"
    if len(places) > len(counts):
        said += f", the most at {joined(named)}"
    return f"{said}{'' if listed else ' (`stickslip plan` lists them)'}: {expected}."


def motions_sentence(shrinks: Sequence[float], share: float) -> str:
    """Return what further free motions take off the band, by its width after one, two ... .

    They begin at a share of the start of the first.
    """
    start = f" from {percent(share)} of its start" if share < 1.0 else ""
    return (
        f"Record another such motion{start} as a further trial: the band is expected to narrow to"
        f" {_halving(shrinks)}"
    )


def _halving(shrinks: Sequence[float]) -> str:
    """Return how wide a band is after one more, and how many halve it, as the end of a sentence."""
    enough = next((k for k, x in enumerate(shrinks, 1) if x <= 0.5), None)
    said = f"{percent(shrinks[0])} of its width"
    if enough == 1:
        return f"{said}."
    many = f"even {in_words(len(shrinks))}" if enough is None else in_words(enough)
    return f"{said}; {many} such records would{' not' if enough is None else ''} halve it."


def again_sentence(
    own: PredictionBand, other: PredictionBand, shrinks: Sequence[float], runs: int, unit: str
) -> str:
    """Return what another record would tell, by the bands of those made and of another run.

    `shrinks` are expected widths of the last after one, two ... more, over today's, if known.
    """
    mine, new = widths_text([own, other], unit)
    what = "this record" if runs < 2 else f"these {runs} runs"
    result = (
        f"Make another record, on another day, as a further trial or with --validate. Friction in"
        f" {what} is known to ± {mine}; in another run, which may differ as runs usually do, to"
        f" ± {new}."
    )
    if not shrinks:
        return result
    return f"{result} With one more, the latter band is expected to narrow to {_halving(shrinks)}"


def third_load_sentence(loads: Array) -> str:
    """Return which load to measure at where two (2,) [N] leave open how friction depends on it."""
    between = quantity(float(np.sqrt(loads[0] * loads[1])), "N", 2)
    return (
        f"Measure at a third load, such as {between} or beyond both: two loads cannot distinguish a"
        " power of the load from a part of friction that does not depend on it."
    )


def usual_sentence(estimate: Estimate, level: float, low: float, high: float, at: str) -> str:
    """Return what a parameter is at the usual values of inputs, and not at 0, and its interval."""
    low, high = min(low, level), max(high, level)
    value = with_unit(within(level, low, high), estimate.quantity.unit)
    own = interval(low, high)
    symbol = estimate.quantity.symbol
    return f"The law states ${symbol}$ for inputs of 0; at {at}, the median, it is {value} ({own})."


RADIUS_SENTENCE = (
    "Friction is a torque and the load a force: their ratio, in m, is the coefficient of friction"
    " times the radius at which it acts, and these data cannot separate the two."
)
"""What levels of a torque over a load are."""
UNIT_LOAD_SENTENCE = (
    "No load is known: coefficients are taken as forces at 1 N, the load of the mechanism. At"
    " another load set mechanism.load, and multiply viscous and other flow parts by it."
)
"""At which load coefficients stand that were given without one."""


def load_sentence(load: float) -> str:
    """Return at which load [N] a law stands where friction is not in proportion to it."""
    return (
        f"Friction is not in proportion to the load: levels are those at {quantity(load, 'N')}, and"
        " what is simulated with this law holds there."
    )


def lacking_sentences(
    title: str, *, table: bool, off: str, offset: bool, at: str, several: bool
) -> tuple[str, ...]:
    """Return what a law that is handed over has otherwise than a title says, or not at all.

    It may be a `table`, be `off` by a force where friction would drive, or hold the `offset`. `at`
    are the means of inputs, of which there may be `several`.
    """
    there = f" at {at}" if at else ""
    driven = f"; it is off by up to {off} where friction would drive the motion" if off else ""
    each = (
        f"stickslip.friction has no law of the form {in_sentence(title)}: the law that is written"
        f" is a table of its friction{there} in both directions, constant beyond its last"
        f" velocities{driven}." * table,
        f"The law that is written multiplies the effects of several inputs, where the fit adds"
        f" them: the two agree{there}." * several,
        "The constant force beyond that of the mechanism is in the levels of the law, which differ"
        " by direction. If it is the zero of the sensor, subtract it from the readings." * offset,
    )
    return tuple(filter(None, each))


def unphysical_sentence(known: Quantity, value: float, *, impossible: bool) -> str:
    """Return that a parameter of the mechanism came out where it cannot be, surely or not."""
    shown = f"${known.symbol}$ = {with_unit(number(value, 3), known.unit)}"
    return (
        f"The balance gives {shown}, which cannot be: something else acts along the motion. The"
        " mechanism keeps the value given."
        if impossible
        else f"The balance gives {shown}, with an interval that holds possible values: the motion"
        " does not show it, and the mechanism keeps the value given."
    )


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


def second_sentence(foreseen: Foreseen) -> str:
    """Return how many readings of a second measurement lie in the band, and their error."""
    count = f"{len(foreseen.measured):,} readings of the second measurement"
    said = f"{percent(foreseen.inside)} of the {count} lie in the band"
    if not foreseen.differs:
        said += ", as expected"
    else:
        said += " in which 95 % should: it differs by more than this measurement shows"
    error = f"They are {quantity(foreseen.error, foreseen.unit, 2)} off its middle"
    if math.isfinite(foreseen.usual_error):
        usual = quantity(foreseen.usual_error, foreseen.unit, 2)
        error += f" (root mean square; {usual} with Coulomb + viscous friction by least squares)"
    else:
        error += " (root mean square)"
    return f"{said}. {error}."
