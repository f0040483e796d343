"""The verdict in words: what the travels settle, what they cannot tell, what to measure next.

Symbols stand between dollar signs, which reports typeset.
"""

import math
from collections.abc import Collection, Mapping, Sequence

from stickslip.experiments import Finding, with_order
from stickslip.formatting import Scale, capital, count, joined, lower_first, number, quantity
from stickslip.identification import LEAST_ERROR, Estimate, Trial, far_above_dry
from stickslip.kinds.travels.admissibility import doubts
from stickslip.kinds.travels.candidates import turns_back
from stickslip.kinds.travels.contradictions import Contradiction
from stickslip.kinds.travels.separations import Proposal
from stickslip.kinds.travels.verdict import TravelCandidate, estimate_text, misfit
from stickslip.quantities import fields_of
from stickslip.selection import UNMEASURED, Wording, held_out_text, limit_of, not_distinguished

ADVICE = {
    "static_coefficient": (
        "Pull slowly until the block moves: the force at break-away is $mu_s$ times the load."
    ),
    "bristle_stiffness": (
        "Record a presliding loop: apply an alternating force below break-away; the slope of force"
        " against displacement gives $sigma_0$."
    ),
    "bristle_damping": "Record presliding loops at two rates, which give $sigma_1$.",
    "stribeck_velocity": (
        "Record the velocity over the last centimetre (240 frames per second or more): the rise of"
        " friction before the stop gives $v_s$."
    ),
    "viscous_coefficient": "Record the velocity of one run: its curvature gives $sigma_2$.",
    "viscous_exponent": (
        "Record the velocity of one run: how its decay changes with the speed gives $p$."
    ),
}
"""Which measurement pays for a parameter that a travel does not fix, the most telling first."""


CURE = (
    "No friction law explains the readings with such a value: measure it again, or leave it out, so"
    " that it is fitted where the trials allow."
)

MANY = 6
"""Other values of a parameter that are told one by one, at most."""

DOUBT_NAMES = {
    "rounding range": "rounding of the measurement",
    "stated interval": "stated interval",
}
"""What a given value lies inside or outside of, where it is not an interval of so many per cent."""


def wording(
    trials: Sequence[Trial],
    candidates: Sequence[TravelCandidate],
    best: TravelCandidate | None,
    proposal: Proposal | None,
    against: Contradiction | None,
    *,
    ranked: bool,
    found: Sequence[Finding] = (),
) -> Wording:
    """Put a selection into words, with what was found of the order of the settings."""
    explained = [c for c in candidates if not c.dropped]
    unsettled = _unsettled(explained, best) if ranked else {}
    if against is not None:
        verdict = "No candidate explains these readings."
        lede = against.reason
    elif best is None:
        verdict, lede = _nothing_fits(candidates)
    elif ranked:
        verdict, lede = _ranked(trials, explained, best)
    else:
        verdict, lede = _tie(trials, explained, candidates, best)
    return Wording(
        verdict=verdict,
        lede=lede if best is None and against is None else lede + _unjudged(candidates),
        settles=_settles(trials, explained, best),
        cannot_tell=_cannot_tell(
            explained, best, unsettled, max(t.half_width for t in trials), ranked=ranked
        ),
        measure_next=(
            tuple(f"Check: {lower_first(line)}" for line in against.check[:3])
            if against
            else with_order(_measure_next(explained, best, proposal), found, 3)
        ),
        no_score="" if against else _no_score(trials, ranked=ranked),
    )


def undecided(
    trials: Sequence[Trial],
    candidates: Sequence[TravelCandidate],
    closest: TravelCandidate | None,
    explaining: Sequence[TravelCandidate],
) -> Wording:
    """Say that only laws with values that the readings do not determine explain them."""
    simplest = min(explaining, key=lambda c: c.parameters)
    settings = len({trial.setting for trial in trials})
    names = {name for c in explaining for name in c.invented}
    titles = joined([c.title for c in explaining])
    explain = "explains" if len(explaining) == 1 else "explain"
    asked = [c for c in explaining if not c.beside]
    lede = f"{titles} friction {explain} them"
    if asked:
        lede += (
            f", with values of {_symbols(asked, {n for c in asked for n in c.invented})} that"
            f" {count(settings, 'setting')} cannot determine"
        )
    lede += "." if asked else f", and {'is' if len(explaining) == 1 else 'are'} no candidate."
    if closest is not None:
        lede += f" {_with_estimates(closest, doubts(closest))} does not: {_left(closest)}."
    return Wording(
        verdict="These readings cannot tell which friction law holds.",
        lede=lede + _unjudged(candidates),
        settles=(),
        cannot_tell=tuple(_given_lines(candidates, max(t.half_width for t in trials)))[:3]
        or (UNMEASURED,),
        measure_next=(
            f"Measure at {simplest.parameters + 1} settings or more: {simplest.title} friction has"
            f" {count(simplest.parameters, 'parameter')} to fit."
            if settings <= simplest.parameters
            else f"Compare with {simplest.title} friction as a candidate: the"
            f" {count(settings, 'setting')} pay for its {simplest.parameters} parameters.",
            *(advice for name, advice in ADVICE.items() if name in names),
        )[:3],
        no_score="",
    )


def _left(candidate: TravelCandidate) -> str:
    """Return what a law leaves of the readings, in words."""
    left = quantity(misfit(candidate), "m", 2)
    return f"it leaves {left} (root mean square)"


def _with_estimates(candidate: TravelCandidate, without: Collection[str] = ()) -> str:
    found = candidate.fit.estimates if candidate.fit else ()
    said = [estimate_text(e) for e in found if e.path.rpartition(".")[2] not in without]
    return f"{candidate.title} friction" + (f" with {joined(said)}" if said else "")


def _nothing_fits(candidates: Sequence[TravelCandidate]) -> tuple[str, str]:
    errors = {c.title: c.given.relative_error for c in candidates}
    known = {title: abs(error) for title, error in errors.items() if error is not None}
    if not known:
        return (
            "No candidate explains the measurement.",
            f"{candidates[0].title}: {_why(candidates[0])}",
        )
    refuted = dict.fromkeys(c.refuted for c in candidates if c.refuted)
    if refuted:
        first, *more = refuted
        others = [f"{c.title}: {_why(c)}" for c in candidates if not c.refuted]
        text = " ".join([*(f"{one}." for one in more), *others, CURE])
        return f"{first}.", text
    closest = min(candidates, key=lambda c: known.get(c.title, float("inf")))
    return (
        f"No candidate explains the measurement; the closest is {closest.title}.",
        f"With its start values its travel is off by {number(100.0 * known[closest.title], 2)} %."
        f" {_why(closest)} Check the mass, stiffness and compression of the rig, and whether the"
        " body leaves the spring.",
    )


def _unjudged(candidates: Sequence[TravelCandidate]) -> str:
    """Return which laws are out for values that nobody measured, and so are not ruled out."""
    said = ""
    for c in candidates:
        if not c.dropped or c.refuted or not c.guessed:
            continue
        known = fields_of(type(c.law))
        symbols = joined([f"${known[name].symbol}$" for name in c.guessed])
        reason = c.dropped.rstrip(".")
        if not reason.startswith(c.title):
            reason = lower_first(reason)
        said += (
            f" With {symbols} assumed, {reason}. {c.title} friction was not compared, and other"
            " values may explain the readings."
        )
    return said


def _why(candidate: TravelCandidate) -> str:
    """Return why a candidate is out, as a sentence."""
    return capital(candidate.dropped.rstrip(".")) + "."


def _tie(
    trials: Sequence[Trial],
    explained: Sequence[TravelCandidate],
    candidates: Sequence[TravelCandidate],
    best: TravelCandidate,
) -> tuple[str, str]:
    others = len(explained) - 1
    if len(candidates) == 1:
        rest = "No other model was tried."
    elif others == len(candidates) - 1:
        rest = "So does every other model."
    elif others:
        verb = "does" if others == 1 else "do"
        rest = f"So {verb} {others} of the {len(candidates) - 1} other models."
    else:
        rest = "No other model does."
    force = _mean_force(trials[0], best)
    what = "" if force is None else f", the mean friction force of {quantity(force, 'N')}"
    found = best.fit.estimates if best.fit else ()
    several = [f"${e.quantity.symbol}$" for e in found if e.pieces]
    name = _with_estimates(best, [e.path.rpartition(".")[2] for e in found if e.pieces])
    name += f" with any of several values of {joined(several)}" if several else ""
    first = f"{name} explains the measurement. {rest}"
    lede = f"One travel determines one number{what}"
    if not others:
        return first, f"{lede}."
    return (
        first,
        f"{lede}; it cannot distinguish friction models. {best.title} is named because it needs"
        " the fewest assumptions, not because it fits better.",
    )


def _ranked(
    trials: Sequence[Trial],
    explained: Sequence[TravelCandidate],
    best: TravelCandidate,
) -> tuple[str, str]:
    equals = [c.title for c in explained if c is not best and not c.distinguished]
    equals += best.otherwise.values()
    doubt = f"; {not_distinguished(equals, 'these readings', most=6)}" if equals else ""
    scored = f"each of the {len({t.setting for t in trials})} settings predicted from the others"
    held_out = held_out_text(
        Scale(1e3, "mm"), best.score, best.score_error, f"{scored}, root mean square"
    )
    factor, freedom = best.fit.variance if best.fit else (1.0, math.inf)
    if best.fit and best.fit.stated and math.isfinite(freedom):
        times = number(math.sqrt(factor), 2)
        doubt = f", whose residuals are {times} times the stated uncertainty{doubt}"
    return (
        f"Use {_with_estimates(best, doubts(best))}{doubt}.",
        f"{held_out}{_fit_quality(best)}{_remarks(explained, best)}",
    )


def _fit_quality(best: TravelCandidate) -> str:
    """Say how residuals compare with the uncertainty of the readings."""
    if best.fit is None:
        return ""
    _, freedom = best.fit.variance
    if not best.fit.stated:
        return (
            " No measurement uncertainty was stated; it is estimated from the residuals, with"
            f" {count(round(freedom), 'degree')} of freedom."
        )
    if math.isfinite(freedom):
        return (
            " Readings may be less certain than stated, for which the intervals are widened; or the"
            " law or the mechanism is another, for which they are not."
        )
    return ""


def _remarks(explained: Sequence[TravelCandidate], best: TravelCandidate) -> str:
    """Say of the closest law that is passed over why it is."""
    said = ""
    travels = best.fit.measured if best.fit else ()
    seen = LEAST_ERROR * max(map(abs, travels), default=0.0)
    closer = [c for c in explained if c.passed_over and misfit(c) < misfit(best) - seen]
    if closer:
        one = min(closer, key=lambda c: (bool(c.invented), misfit(c)))
        said += f" {one.title} fits these readings more closely, but {one.passed_over}."
    return said


def _unsettled(
    explained: Sequence[TravelCandidate], best: TravelCandidate | None
) -> dict[str, str]:
    """Return by symbol what is in doubt of a fitted parameter, that of the best law first."""
    found: dict[str, str] = {}
    for c in sorted(explained, key=lambda c: c is not best):
        for name, doubt in doubts(c).items():
            whose = "" if c is best else f" of {c.title}"
            found.setdefault(fields_of(type(c.law))[name].symbol, f"{whose}: {doubt}")
    return found


def _mean_force(trial: Trial, candidate: TravelCandidate) -> float | None:
    """Return work taken by friction over the travel [N]; None where the body turned back."""
    seen, run = candidate.criteria, candidate.run
    if seen is None or run is None or not seen.travel:
        return None
    back = turns_back(run, trial.mechanism)
    return None if back else abs(seen.work_friction / seen.travel)


def _settles(
    trials: Sequence[Trial],
    explained: Sequence[TravelCandidate],
    best: TravelCandidate | None,
) -> tuple[str, ...]:
    if best is None or best.fit is None or best.criteria is None:
        return ()
    seen = best.criteria
    lines = []
    if len(trials) == 1:
        work, travel = seen.work_friction, abs(seen.travel)
        if (force := _mean_force(trials[0], best)) is not None:
            lines.append(
                f"Mean friction over the travel: {quantity(work, 'J')} / {quantity(travel, 'm')}"
                f" = {quantity(force, 'N')}."
            )
    open_ = doubts(best) if len(trials) > 1 else {}
    settled = [e for e in best.fit.estimates if e.path.rpartition(".")[2] not in open_]
    ties = [c for c in explained if c is not best and not c.distinguished]
    lines += [_range_line(one, best, ties) + limit_of(best.fit, one) for one in settled]
    return tuple(lines[:3])


def _range_line(estimate: Estimate, best: TravelCandidate, ties: Sequence[TravelCandidate]) -> str:
    """Return an interval as a sentence, with the law for which it holds if that is but one."""
    name = estimate.path.rpartition(".")[2]
    given = getattr(best.law, name)
    symbol = f"${estimate.quantity.symbol}$"
    if not estimate.bounded:
        return f"{symbol} {open_ends(estimate)}."
    lies = f"{symbol} {_between(estimate)}"
    alone = [own for own in best.alone if own.path == estimate.path and own.bounded]
    shapes = [fields_of(type(c.law))[one] for c in ties for one in c.invented]
    if best.score is None:
        lies = f"if {best.title} friction holds, {lies}"
    elif estimate.quantity.scale == "slope" and any(one.scale == "none" for one in shapes):
        lies = f"if viscous friction is proportional to the speed, {lies}"
    elif alone:
        lies = f"{lies} whichever of these laws holds; if {best.title} friction does, it"
        lies += f" {_between(alone[0])}"
    if best.ordinary:
        return f"{capital(lies)}."
    parts = estimate.pieces or ((estimate.low, estimate.high),)
    inside = any(low <= given <= high for low, high in parts)
    doubt = DOUBT_NAMES.get(estimate.interval, f"{estimate.interval} interval")
    place = "inside" if inside else "outside"
    return f"{capital(lies)}; the given {number(given)} is {place} the {doubt}."


def open_ends(estimate: Estimate) -> str:
    """Return that an estimate has no interval or half of one, and why."""
    sided = math.isfinite(estimate.low) or math.isfinite(estimate.high)
    return f"{'is bounded on one side only' if sided else 'has no interval'}: {estimate.reason}"


def _between(estimate: Estimate) -> str:
    if estimate.pieces:
        return f"lies in {estimate.range}"
    return f"lies between {estimate.range.replace(' to ', ' and ')}"


def _cannot_tell(
    explained: Sequence[TravelCandidate],
    best: TravelCandidate | None,
    unsettled: Mapping[str, str],
    reading: float,
    *,
    ranked: bool,
) -> tuple[str, ...]:
    lines = [f"${symbol}${doubt}." for symbol, doubt in unsettled.items()]
    if not ranked:
        lines.append("Which friction model is right: no data are left for validation.")
    others = [value for c in explained if c is best and c.fit for value in c.fit.others]
    if others:
        said = joined([number(value) for value in sorted(others)])
        if len(others) > MANY:
            least, most = number(min(others)), number(max(others))
            said = f"{len(others)} others from {least} to {most}"
        verb = "gives" if len(others) == 1 else "give"
        lines.insert(0, f"Which value: {said} {verb} the same travel.")
    lines += _given_lines(explained, reading)
    lines[:0] = far_above_dry(best.fit) if best is not None and best.fit else ()
    return tuple(lines[:3]) or (UNMEASURED,)


def _given_lines(explained: Sequence[TravelCandidate], reading: float) -> list[str]:
    """Say which parameters taken as given the travel depends on, and on which it does not."""
    moved: dict[str, float] = {}
    for c in explained:
        for name, change in c.influence.items():
            moved[name] = max(moved.get(name, 0.0), change)
    idle = _symbols(explained, {name for name, change in moved.items() if change <= reading})
    busy = _symbols(explained, {name for name, change in moved.items() if change > reading})
    lines = []
    if idle:
        lines.append(f"{idle}: a change of 50 % changes the travel by less than its uncertainty.")
    if busy:
        widest = 1e3 * max(moved.values())
        lines.append(
            f"{busy}: not fitted. An increase of 50 % changes the travel by up to {number(widest)}"
            " mm, which the fitted level compensates."
        )
    return lines


def _symbols(explained: Sequence[TravelCandidate], names: set[str]) -> str:
    found = {
        name: fields_of(type(c.law))[name].symbol
        for c in explained
        for name in fields_of(type(c.law))
        if name in names and name != "kinetic_coefficient"
    }
    return ", ".join(f"${symbol}$" for symbol in dict.fromkeys(found.values()))


def _measure_next(
    explained: Sequence[TravelCandidate], best: TravelCandidate | None, proposal: Proposal | None
) -> list[str]:
    lines = [] if proposal is None else [proposal.line({c.name: c.title for c in explained})]
    assumed = {name for c in explained for name in c.assumed}
    if best is not None and best.score is None:
        lines += [advice for name, advice in ADVICE.items() if name in assumed]
    elif proposal is not None and not proposal.settings:
        rivals = [c for c in explained if c.name in proposal.rivals]
        wanted = {name for c in rivals for name in c.invented}
        lines += [advice for name, advice in ADVICE.items() if name in wanted]
    return lines


def _no_score(trials: Sequence[Trial], *, ranked: bool) -> str:
    if ranked:
        return ""
    if len(trials) == 1:
        return "No held-out error and no ranking: one number was measured and one was fitted."
    return (
        "No held-out error and no ranking: all trials repeat one setting, so none can be predicted"
        " from another."
    )
