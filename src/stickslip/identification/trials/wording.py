"""What a comparison of trials says, in sentences."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np
import scipy

from stickslip.experiments import condition_name, condition_unit
from stickslip.formatting import interval, joined, number, significant, unit_text, with_unit, within
from stickslip.identification.trials.condition_lines import ConditionLine
from stickslip.identification.trials.estimates import TrialEstimates
from stickslip.identification.trials.homogeneity import Homogeneity

SURE = 0.05
"""Significance of the test."""
MOST = 3
"""Parameters that a sentence names at most."""
LEAST_P = 1e-3
"""Below this, a probability is given as less than this."""
TOGETHER = 0.95
"""Correlation of two conditions from which their effects cannot be told from each other."""


def sentences_of(
    trials: Sequence[TrialEstimates],
    test: Homogeneity,
    lines: Sequence[ConditionLine],
    failed: Mapping[str, str],
) -> Iterator[str]:
    """Yield what a comparison says; the outcome of the test first."""
    clear = _clear(lines)
    yield _outcome(trials, test, clear)
    if test.p < SURE:
        yield (
            "One law for all trials is an average; its intervals do not apply to individual trials."
        )
    for line in clear:
        yield _slope(line, confirmed=test.p < SURE)
    yield from _troubles(trials)
    yield from _untold(trials)
    for name, reason in failed.items():
        yield f"{name} could not be compared: {reason.rstrip('.')}."


def _clear(lines: Sequence[ConditionLine]) -> list[ConditionLine]:
    """Return by parameter the line whose slope is clearest, if it is clear."""
    best: dict[str, ConditionLine] = {}
    for line in lines:
        known = best.get(line.path)
        if line.clear and (known is None or _clarity(line) > _clarity(known)):
            best[line.path] = line
    return sorted(best.values(), key=_clarity, reverse=True)[:MOST]


def _clarity(line: ConditionLine) -> float:
    return abs(line.slope) / (line.high - line.low)


def _outcome(
    trials: Sequence[TrialEstimates], test: Homogeneity, clear: Sequence[ConditionLine]
) -> str:
    if math.isnan(test.p):
        return (
            "Whether the trials share one law cannot be tested: the trials do not identify its"
            " parameters individually."
        )
    p = f"p < {number(LEAST_P)}" if test.p < LEAST_P else f"p = {number(test.p, 2)}"
    if not test.p < SURE:
        return f"The trials are consistent with one law ({p})."
    said = [_change(line) for line in clear] or _groups(trials) or _range(trials)
    reason = f": {joined(said)}" if said else ""
    return f"The trials do not share one law ({p}){reason}."


def _change(line: ConditionLine) -> str:
    """Return how a parameter changes with a condition: "mu_k rises from 2 N at 20 °C to ..."."""
    verb = "rises" if line.slope > 0.0 else "falls"
    first, last = (with_unit(significant(value), line.quantity.unit) for value in line.values)
    at, to = (_at(line.condition, value) for value in line.ends)
    return f"{line.quantity.symbol} {verb} from {first} at {at} to {last} at {to}"


def _at(condition: str, value: float) -> str:
    unit = condition_unit(condition)
    if unit:
        return with_unit(number(value), unit)
    return f"{condition_name(condition)} {number(value)}"


def _slope(line: ConditionLine, *, confirmed: bool) -> str:
    by = unit_text(condition_unit(line.condition)) or f"unit of {condition_name(line.condition)}"
    slope = with_unit(within(line.slope, line.low, line.high), line.quantity.unit)
    text = (
        f"{line.quantity.symbol} changes by {slope} per {by} (95 % interval"
        f" {interval(line.low, line.high)})"
    )
    if line.scatter < SURE:
        text += ", including scatter about the line beyond the intervals of the trials"
    if not confirmed:
        text += "; the test of all parameters together does not confirm it"
    return f"{text}."


def _groups(trials: Sequence[TrialEstimates]) -> list[str]:
    """Return what differs between trials with different texts for a condition, if it is clear."""
    found: list[tuple[float, str]] = []
    for condition in dict.fromkeys(name for trial in trials for name in trial.conditions):
        words = dict.fromkeys(
            w for t in trials if isinstance(w := t.conditions.get(condition), str)
        )
        if len(words) < 2:
            continue
        for i, one in enumerate(trials[0].estimates):
            means = {
                w: mean
                for w in words
                if (mean := _mean([t for t in trials if t.conditions.get(condition) == w], i))
            }
            p = _differs(list(means.values()))
            if p < SURE:
                quantity = one.quantity
                parts = [
                    f"{with_unit(number(m[0]), quantity.unit)} for {w!r}" for w, m in means.items()
                ]
                name = condition_name(condition)
                found.append((p, f"{quantity.symbol} is {joined(parts)} ({name})"))
    return [text for _, text in sorted(found)[:MOST]]


def _mean(trials: Sequence[TrialEstimates], i: int) -> tuple[float, float, float] | None:
    """Return the weighted mean of an estimate, its standard error and degrees of freedom.

    Where trials scatter by more than their errors, the scatter counts.
    """
    usable = [t for t in trials if 0.0 < t.errors[i] < math.inf]
    if not usable:
        return None
    values = np.array([t.estimates[i].value for t in usable])
    weights = np.array([t.errors[i] for t in usable]) ** -2.0
    mean = float(np.average(values, weights=weights))
    error, freedom = float(weights.sum() ** -0.5), float(sum(t.freedom[i] for t in usable))
    if len(usable) > 1:
        misfit = float(np.sum(weights * (values - mean) ** 2)) / (len(usable) - 1)
        if scipy.stats.f.sf(misfit, len(usable) - 1, freedom) < SURE:
            error, freedom = error * math.sqrt(misfit), len(usable) - 1.0
    return mean, error, freedom


def _differs(means: Sequence[tuple[float, float, float]]) -> float:
    """Return the probability of so large differences of means that are one (Welch 1951)."""
    if len(means) < 2:
        return 1.0
    values, errors, freedom = (np.array(column) for column in zip(*means, strict=True))
    weights, count = errors**-2.0, len(values)
    mean = np.average(values, weights=weights)
    unsure = float(np.sum((1.0 - weights / weights.sum()) ** 2 / freedom))
    between = float(np.sum(weights * (values - mean) ** 2)) / (count - 1)
    statistic = between / (1.0 + 2.0 * (count - 2) / (count**2 - 1) * unsure)
    return float(scipy.stats.f.sf(statistic, count - 1, (count**2 - 1) / (3.0 * unsure)))


def _range(trials: Sequence[TrialEstimates]) -> list[str]:
    """Return the range of the parameter that differs most between trials, over its errors."""
    best: tuple[float, str] = (0.0, "")
    for i, one in enumerate(trials[0].estimates if trials else ()):
        usable = [t for t in trials if 0.0 < t.errors[i] < math.inf]
        if len(usable) < 2:
            continue
        least, most = (f(usable, key=lambda t: t.estimates[i].value) for f in (min, max))
        low, high = least.estimates[i].value, most.estimates[i].value
        apart = (high - low) / math.hypot(least.errors[i], most.errors[i])
        if apart > best[0]:
            text = (
                f"{one.quantity.symbol} ranges from {with_unit(number(low), one.quantity.unit)} in"
                f" {least.name} to {with_unit(number(high), one.quantity.unit)} in {most.name}"
            )
            best = (apart, text)
    named = any(trial.conditions for trial in trials)
    return [best[1] + (", which no condition explains" if named else "")] if best[1] else []


def _troubles(trials: Sequence[TrialEstimates]) -> Iterator[str]:
    """Yield which conditions are the same in all trials, missing, or change together."""
    differing: dict[str, dict[str, float | str]] = {}
    for condition in dict.fromkeys(name for trial in trials for name in trial.conditions):
        name = condition_name(condition)
        have = {t.name: v for t in trials if (v := t.conditions.get(condition)) is not None}
        lack = [t.name for t in trials if t.name not in have]
        if lack:
            verb, was = ("has", "was") if len(lack) == 1 else ("have", "were")
            yield f"{joined(lack)} {verb} no {name} and {was} not used for its effect."
        if len({type(value) for value in have.values()}) > 1:
            yield f"{name} is a number in some trials and a text in others: give one kind."
        elif len(set(have.values())) == 1:
            (value,) = set(have.values())
            said = _at(condition, value) if isinstance(value, float) else f"{name} {value!r}"
            yield f"All trials have {said}: its effect cannot be determined."
        else:
            differing[condition] = have
    for one, other in combinations(differing, 2):
        if _together(differing[one], differing[other]):
            yield (
                f"{condition_name(one)} and {condition_name(other)} vary together: their effects"
                " cannot be separated."
            )


def _together(one: Mapping[str, float | str], other: Mapping[str, float | str]) -> bool:
    """Whether two conditions of trials say nearly the same."""
    both = sorted(one.keys() & other.keys())
    pairs = [(one[key], other[key]) for key in both]
    if len({first for first, _ in pairs}) < 2 or len({last for _, last in pairs}) < 2:
        return False
    if any(isinstance(value, str) for pair in pairs for value in pair):
        levels = {len(set(column)) for column in (pairs, *zip(*pairs, strict=True))}
        # that every trial has values of its own says nothing, unless there are two of them
        return len(levels) == 1 and (min(levels) < len(pairs) or len(pairs) == 2)
    return abs(float(np.corrcoef(np.array(pairs, dtype=float).T)[0, 1])) > TOGETHER


def _untold(trials: Sequence[TrialEstimates]) -> Iterator[str]:
    """Yield what single trials do not tell."""
    for i, one in enumerate(trials[0].estimates if trials else ()):
        names = [t.name for t in trials if not t.errors[i] < math.inf]
        if len(names) == len(trials):
            yield f"{one.quantity.symbol} is not identified by any trial alone."
        elif names:
            yield f"{one.quantity.symbol} is not identified by {joined(names)} alone."
