"""Readings that no law explains: said so, with the reason and what to check."""

import math
from collections.abc import Collection, Hashable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from stickslip.formatting import in_words, joined, number, quantity, scale_of
from stickslip.friction import FrictionLaw
from stickslip.identification import Trial
from stickslip.kinds.travels.verdict import TravelCandidate, misfit
from stickslip.mechanisms import SpringBlock
from stickslip.quantities import fields_of, parameters
from stickslip.selection import given_level, given_text, level_text
from stickslip.simulation import simulate

MANY = 5.0
"""Root mean square of standardised residuals beyond which a law does not explain the readings. An
uncertainty that was stated three times too small is common, and only widens intervals."""
WORST = 10.0
"""A single standardised residual beyond which the same holds, however many others are small."""
SHARE = 0.15
"""The same as a share of the travels where no uncertainty was stated: repeats of dry friction
scatter by up to a tenth."""
LEVEL_AND_ANOTHER = 2
"""Parameters that a law has with one assumed value beside a level; settings must outnumber them."""
FACTORS = {
    10.0: ("centimetres entered as millimetres, or the reverse"),
    1000.0: "metres entered as millimetres, or the reverse",
}
"""Ratios of a reading to its prediction that a wrong unit gives."""
ALONE = 3.0
"""A unit is asked about where the reading is missed by so many times what others are."""
NEAR_FACTOR = 0.2
"""Share within which such a ratio is met."""
MOVED = 3.0
"""Travel over its uncertainty from which a body moved beyond doubt."""
SAMPLES = 501
"""Times of a run at which the friction that a drive calls for is looked at."""


@dataclass(frozen=True, kw_only=True)
class Contradiction:
    """Why no law is named."""

    reason: str
    """What is wrong, as a sentence."""
    check: tuple[str, ...]
    """What to check, in sentences."""


def closest_of(candidates: Sequence[TravelCandidate]) -> TravelCandidate | None:
    """Return the fitted law that leaves least; one with invented values if there is no other."""
    fitted = [c for c in candidates if c.fit is not None and not c.dropped]
    return min([c for c in fitted if not c.invented] or fitted, key=misfit, default=None)


def contradiction(
    trials: Sequence[Trial], closest: TravelCandidate, candidates: Sequence[TravelCandidate] = ()
) -> Contradiction | None:
    """Return why several readings are explained by no law, None if the closest explains them."""
    if closest.fit is None or len(trials) < 2:
        return None
    errors, stated = np.array(closest.fit.standard_errors), closest.fit.stated
    repeats = _repeats(trials, errors, _usual(candidates, trials), stated=stated)
    if repeats is not None:
        return repeats
    residuals, freedom = closest.fit.residuals, closest.fit.freedom
    if freedom <= 0:
        return None
    size = math.sqrt(sum(t.travel**2 for t in trials) / len(trials))
    left = math.sqrt(sum(r * r for r in residuals) / freedom)
    standardised = closest.fit.standardised
    many = math.sqrt(sum(s * s for s in standardised) / freedom) > MANY
    if stated and not many and max(map(abs, standardised)) <= WORST:
        return None
    if not stated and left <= SHARE * size:
        return None
    closest = closest_of(candidates) or closest
    rms = quantity(misfit(closest), "m", 2)
    times = number(misfit(closest) / math.sqrt(float((errors**2).mean())), 2)
    compared = (
        f"{times} times their standard error" if stated else f"travels of {quantity(size, 'm')}"
    )
    against = compared if stated else f"for {compared}"
    reason = (
        f"{closest.title} friction fits best, with a residual of {rms} (root mean square),"
        f" {against}."
    )
    return Contradiction(
        reason=reason, check=(*_found(trials, closest), _usual(candidates, trials))
    )


def _repeats(
    trials: Sequence[Trial], errors: NDArray[np.float64], usual: str, *, stated: bool
) -> Contradiction | None:
    """Return the repeats of one setting that contradict each other most, None if none do."""
    groups: dict[Hashable, list[int]] = {}
    for i, trial in enumerate(trials):
        groups.setdefault(trial.run, []).append(i)
    worst: tuple[float, int, int] | None = None
    for group in groups.values():
        for i, j in combinations(group, 2):
            one, other = trials[i].travel, trials[j].travel
            if one == other:  # readings of 0 have no doubt that is a share of them
                continue
            doubt = (
                WORST * math.hypot(errors[i], errors[j])
                if stated
                else 2.0 * SHARE * max(abs(one), abs(other))
            )
            ratio = abs(one - other) / doubt
            if ratio > max(1.0, worst[0] if worst else 0.0):
                worst = ratio, i, j
    if worst is None:
        return None
    _, i, j = worst
    one, other = sorted((trials[i].travel, trials[j].travel))
    where = setting_of(trials, trials[i])
    known = (
        f"; the standard error of a reading is {quantity(float(errors[i]), 'm')}" if stated else ""
    )
    return Contradiction(
        reason=f"Repeats of one setting{where} disagree: {quantity(one, 'm')} and"
        f" {quantity(other, 'm')}{known}.",
        check=(
            f"Which of the readings {quantity(one, 'm')} and {quantity(other, 'm')} is wrong:"
            " repeat them.",
            usual,
        ),
    )


def _found(trials: Sequence[Trial], closest: TravelCandidate) -> tuple[str, ...]:
    """Return what is suspicious about single readings, the most telling first."""
    assert closest.fit is not None
    predicted = closest.fit.predicted
    held = [t.travel - e for t, e in zip(trials, closest.held_out, strict=False)]
    found = []
    missed = np.abs(closest.held_out)
    for i, (trial, others) in enumerate(zip(trials, held, strict=False)):
        ratio = abs(trial.travel / others) if others else 0.0
        if len(trials) > 2 and missed[i] < ALONE * np.median(np.delete(missed, i)):
            continue  # readings near 0, among many that the law misses, meet any ratio
        for factor, units in FACTORS.items():
            for about in (factor, 1.0 / factor):
                if abs(ratio / about - 1.0) < NEAR_FACTOR:
                    found.append(
                        f"The unit of {trial.as_read(trial.travel)}{setting_of(trials, trial)}:"
                        f" the other readings predict {trial.as_read(others)} ({units}?)."
                    )
    for i, j in combinations(range(len(trials)), 2):
        measured, expected = trials[i].travel - trials[j].travel, predicted[i] - predicted[j]
        size = SHARE * max(abs(trials[i].travel), abs(trials[j].travel))
        if measured * expected < 0.0 and min(abs(measured), abs(expected)) > size:
            first, second = (
                f"{trials[k].as_read(trials[k].travel)}{setting_of(trials, trials[k])}"
                for k in (i, j)
            )
            found.append(
                f"Whether {first} and {second} are swapped: {closest.title} friction predicts the"
                " opposite order."
            )
    at = max(range(len(trials)), key=lambda i: abs(trials[i].travel - predicted[i]))
    worst = trials[at]
    found.append(
        f"The reading {worst.as_read(worst.travel)}{setting_of(trials, worst)},"
        f" from which {closest.title} friction differs by"
        f" {worst.as_read(abs(worst.travel - predicted[at]))}."
    )
    return tuple(found[:2])


def _usual(candidates: Sequence[TravelCandidate], trials: Sequence[Trial]) -> str:
    """Return what else may be wrong: the rig, and the parameters that travels do not fit."""
    text = (
        "The rig: its mass, stiffness and the unit of its settings, and whether the body"
        " leaves the spring."
        if isinstance(trials[0].mechanism, SpringBlock)
        else "The rig: the values of its parameters, its drive, and how it was set."
    )
    held = [
        (f"${quantity.symbol}$", name in c.marked)
        for c in candidates
        for name, quantity in fields_of(type(c.law)).items()
        if not c.beside and name in c.assumed and not quantity.structural and getattr(c.law, name)
    ]
    if not held:
        return text
    given = {symbol for symbol, marked in held if not marked}
    guessed = dict.fromkeys(symbol for symbol, _ in held if symbol not in given)
    names = joined([*dict.fromkeys(symbol for symbol, _ in held)])
    text += f" The values that were not fitted: {names}."
    if given:
        text += (
            f" {'Another' if guessed else 'A'} value marked assumed = true in the rig file (Python:"
            " assumed) is fitted if there are more settings than fitted parameters."
        )
    if guessed:
        known = f"{joined(list(guessed))}, marked as assumed,"
        text += (
            f" Fitting {known} does not explain the readings either."
            if len({trial.setting for trial in trials}) > LEVEL_AND_ANOTHER
            else f" To fit {known} takes more than {in_words(LEVEL_AND_ANOTHER)} settings."
        )
    return text


def setting_of(trials: Sequence[Trial], trial: Trial) -> str:
    """Return how the rig was set in a trial, where trials differ, such as ``" at x_0 = 60 mm"``."""
    tables = [{p: (q, v) for p, q, v in parameters(t.mechanism, "mechanism")} for t in trials]
    own = {p: (q, v) for p, q, v in parameters(trial.mechanism, "mechanism")}
    varied = [p for p in own if len({t[p][1] if p in t else None for t in tables}) > 1]
    parts = []
    for path in varied:
        field, value = own[path]
        scale = scale_of([table[path][1] or 0.0 for table in tables if path in table], field.unit)
        parts.append(f"${field.symbol}$ = {scale.quantity(value, 4)}")
    return f" at {', '.join(parts)}" if parts else ""


def refuted_by_travels(
    law: FrictionLaw, held: Collection[str], trials: Sequence[Trial], *, t_end: float
) -> str:
    """Return that a body moved which a given break-away level would have held at rest.

    Such a body stays where it is for the whole run, and the friction that holds it there is known
    from the balance of forces.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock
    >>> from stickslip.identification import trials_of
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.06)
    >>> law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.9)
    >>> trials = trials_of(rig, Measurement(travel=0.12, uncertainty=1e-3), 10.0)
    >>> refuted_by_travels(law, ["static_coefficient"], trials, t_end=10.0)
    'The given $mu_s$ = 0.9 contradicts the readings: the body moved, though friction ...'
    """
    name = given_level(law, held)
    if not name or law.states:  # bristles move before they break away
        return ""
    least, where = math.inf, ""
    for trial in trials:
        if abs(trial.travel) <= MOVED * trial.half_width:
            continue
        end = trial.until(t_end)
        run = simulate(trial.mechanism, law, t_end=end, y0=trial.start(law), throw=False)
        if not run.status.complete or any(np.any(run[rate]) for rate in trial.mechanism.rates):
            continue
        seen = run.at(np.union1d(np.linspace(*run.span, SAMPLES), run.t))
        friction, load = np.abs(seen["friction"]), seen["normal_force"]
        at = int(np.argmax(friction / load))
        if friction[at] / load[at] < least:
            least = float(friction[at] / load[at])
            known = level_text(trial.mechanism, float(friction[at]), float(load[at]))
            where = f"{setting_of(trials, trial)}, though friction at rest was at most {known}"
    if not where:
        return ""
    return f"The {given_text(law, name)} contradicts the readings: the body moved{where}"
