r"""Whether trials of one rig share one law, and how it depends on their conditions.

The law is fitted to all trials and to each alone; what is found beside it (a mass, an offset) is
that of all. The parameters :math:`y_k` of trial :math:`k`, with the covariance :math:`C_k` of their
draws, are

.. math:: y_k = m + \sum_c \beta_c z_{kc} + r_k + e_k , \qquad
          r_k \sim N(0, s^2 \mathrm{diag}(m^2)), \quad \beta_c \sim N(0, b_c^2 \mathrm{diag}(m^2)) ,

with conditions :math:`z` over their range (numbers) or one for each text. :math:`s` is what trials
differ by whatever their conditions, :math:`b_c` what a condition changes; both have a grid of sizes
with prior probabilities (those of runs and inputs of tables), and everything is Gaussian. The
trials *share* the law if every size is the least.
"""

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.special import logsumexp

from stickslip.data import Measurement, condition_name, condition_unit, faults
from stickslip.engine.solver import notice
from stickslip.errors import InputError, StickslipError
from stickslip.friction import FrictionLaw
from stickslip.identify import INPUT, INPUTS_PRIOR, RUNS, RUNS_PRIOR, LawFit, allotted
from stickslip.identify.candidates import MOST
from stickslip.identify.fits import Estimate, RecordSettings, uncertainties_of
from stickslip.identify.judgement import is_asserted
from stickslip.quantities import Quantity, vary
from stickslip.show.display import InPanels, Summary, Tabular, summary_of_table
from stickslip.show.formatting import (
    interval,
    joined,
    number,
    percent,
    significant,
    unit_text,
    with_unit,
    within,
)

if TYPE_CHECKING:
    import pandas as pd

Array: TypeAlias = NDArray[np.float64]
Effects: TypeAlias = Mapping[str, tuple[float, Array]]
"""By condition, the probability that it acts, and draws of what it changes."""
Refit: TypeAlias = Callable[..., Any]
"""Fits the law to another measurement, with arguments as `stickslip.fit` has them."""

TOGETHER = 0.95
"""Correlation from which two conditions are one number and a split of it."""
MOST_CONDITIONS = 4
"""Conditions that are compared at most: each doubles the sizes that are looked at."""
DRAWS = 4000
BROAD = 10.0
"""Deviation of the mean of all trials over its value."""
NOT_ALONE = (
    "only trials that can be fitted individually are compared: records in time or measured"
    " friction, not travels or the force of a spring."
)
"""Why other measurements are refused."""


@dataclass(frozen=True, kw_only=True)
class ConditionLine:
    """A parameter as a line over a condition."""

    path: str
    """Path of the parameter."""
    quantity: Quantity
    """Symbol and unit of the parameter."""
    condition: str
    """Name of the condition, with its unit in brackets if it has one."""
    ends: tuple[float, float]
    """Least and largest value of the condition."""
    values: tuple[float, float]
    """The parameter on the line at these."""
    slope: float
    """Change of the parameter by unit of the condition."""
    low: float
    """Lower end of the 95 % interval of the slope."""
    high: float
    """Upper end."""
    probability: float
    """Probability that the condition has an effect that is not negligible."""

    @property
    def clear(self) -> bool:
        """Whether the interval of the slope leaves 0 out, and the effect is asserted."""
        return is_asserted(self.probability) and (self.low > 0.0 or self.high < 0.0)


@dataclass(frozen=True, kw_only=True)
class TrialEstimates:
    """A law fitted to one of several trials."""

    name: str
    """Of the trial."""
    number: int
    """Its place among the records of the joint fit, from 0."""
    conditions: Mapping[str, float | str]
    """What was different in it."""
    law: FrictionLaw
    """The law with the parameters of this trial."""
    estimates: tuple[Estimate, ...]
    """Parameters of the law, in the order of the joint fit."""
    values: Array = field(repr=False)
    """Means of the draws of these (p,)."""
    covariance: Array = field(repr=False)
    """Their covariance (p, p)."""
    left: float
    """Root mean square of what the law leaves [N]."""


@dataclass(frozen=True, kw_only=True, repr=False)
class TrialComparison(InPanels, Tabular):
    """One law fitted to each of several trials, and whether they share it."""

    fit: LawFit
    """The joint fit."""
    trials: tuple[TrialEstimates, ...]
    """The law of each trial."""
    probability: float
    """Probability that the trials differ."""
    spread: tuple[float, float, float]
    """Standard deviation of the first parameter between trials over its value: median and 95 %
    interval."""
    lines: tuple[ConditionLine, ...]
    """Parameters as lines over numeric conditions."""
    sentences: tuple[str, ...] = ()
    """What can be said, in words; the first one says whether the trials share the law."""
    failed: Mapping[str, str] = field(default_factory=dict)
    """Why a trial could not be fitted, by its name."""

    @property
    def shared(self) -> bool:
        """Whether the trials share one law as far as they tell."""
        return not is_asserted(self.probability)

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of the conditions, as they were given."""
        return tuple(dict.fromkeys(name for trial in self.trials for name in trial.conditions))

    def __str__(self) -> str:
        """Return the sentences, one a line."""
        return "\n".join(self.sentences)

    def __repr__(self) -> str:
        return f"<TrialComparison of {len(self.trials)} trials: {self.sentences[0]}>"

    def _summary(self) -> Summary:
        first, *others = self.sentences
        return summary_of_table(first, self.to_dataframe(), others)

    def to_dataframe(self) -> "pd.DataFrame":
        """Return one row a trial: conditions, each parameter with its interval, what is left.

        Examples
        --------
        >>> from stickslip import Axis, Coulomb, compare_trials
        >>> v = np.linspace(-1.0, 1.0, 40)
        >>> cold, warm = (
        ...     Measurement(
        ...         velocity=v,
        ...         friction=level * np.sign(v) + 0.01 * np.cos(50.0 * v),
        ...         conditions={"temperature [degC]": temperature},
        ...         name=name,
        ...     )
        ...     for name, level, temperature in (("cold", 2.0, 20), ("warm", 2.5, 60))
        ... )
        >>> found = compare_trials(Axis(inertia=1.0), Coulomb, Measurement(trials=(cold, warm)))
        >>> found.to_dataframe()[["trial", "temperature [degC]", "F_c"]].round(2).values.tolist()
        [['cold', 20.0, 2.0], ['warm', 60.0, 2.5]]
        """
        import pandas as pd

        rows = []
        for trial in self.trials:
            row: dict[str, Any] = {"trial": trial.name}
            row |= {name: trial.conditions.get(name) for name in self.conditions}
            for estimate in trial.estimates:
                symbol = estimate.quantity.symbol
                row |= {
                    symbol: estimate.value,
                    f"{symbol} low": estimate.low,
                    f"{symbol} high": estimate.high,
                }
            rows.append({**row, "leaves": trial.left})
        return pd.DataFrame(rows)

    def _over(self) -> str:
        return "trial"

    def to_dict(self) -> Mapping[str, Any]:
        """Return the comparison as plain numbers and strings."""
        return {
            "law": self.fit.law.name,
            "share_one_law": self.shared,
            "probability": self.probability,
            "spread": list(self.spread),
            "trials": [
                {
                    "name": trial.name,
                    "conditions": dict(trial.conditions),
                    "estimates": [estimate.to_dict() for estimate in trial.estimates],
                    "leaves": trial.left,
                }
                for trial in self.trials
            ],
            "lines": [
                {
                    "parameter": line.path,
                    "condition": line.condition,
                    "from": list(line.ends),
                    "values": list(line.values),
                    "slope": line.slope,
                    "low": line.low,
                    "high": line.high,
                    "probability": line.probability,
                }
                for line in self.lines
            ],
            "failed": dict(self.failed),
            "sentences": list(self.sentences),
        }


def refuse_alone(measurement: Measurement) -> None:
    """Refuse trials that cannot be fitted alone, or fewer than two that move.

    Examples
    --------
    >>> refuse_alone(Measurement(travel=0.2))
    Traceback (most recent call last):
    stickslip.errors.InputError: only trials that can be fitted individually are compared: ...
    """
    if measurement.content in ("travels", "spring force"):
        raise InputError(NOT_ALONE)
    records = measurement.records()
    if len(records) < 2:
        raise InputError("a comparison needs at least two trials, got one record.")
    if sum(not rests(record) for record in records) < 2:
        raise InputError(
            "a comparison needs at least two trials with motion; a trial at rest throughout bounds"
            " friction at rest only."
        )


def compared(joint: LawFit, refit: Refit) -> TrialComparison | None:
    """Return the comparison of the trials of a fit; None where there is nothing to compare.

    A fit that stands is not lost because its trials cannot be compared.
    """
    records = joint.measurement.records()
    if len(records) < 2 or sum(not rests(record) for record in records) < 2:
        return None
    try:
        return comparison_of(joint, refit)
    except StickslipError as error:
        notice(f"The trials were not compared: {error}")
        return None


def comparison_of(
    joint: LawFit, refit: Refit, settings: RecordSettings | None = None
) -> TrialComparison:
    """Compare the trials of a fit: each is fitted alone, with what is beside the law as found."""
    own = [
        estimate
        for estimate in joint.estimates
        if estimate.path.startswith("friction.") and estimate.bounded
    ]
    if not own:
        raise InputError("trials cannot be compared by a law without fitted parameters.")
    trials, failed = [], dict[str, str]()
    for index, record in enumerate(joint.measurement.records()):
        if rests(record):
            continue
        name = record.name or f"trial {index + 1}"
        try:
            trials.append(_alone(joint, refit, index, name, own, settings))
        except StickslipError as error:
            failed[name] = str(error)
    if len(trials) < 2:
        raise InputError(
            f"fewer than two trials could be fitted alone: {joined([*failed.values()])}"
        )
    result, texts = _compared(joint, trials, failed)
    return replace(result, sentences=tuple(_sentences(result, texts)))


def _alone(
    joint: LawFit,
    refit: Refit,
    index: int,
    name: str,
    own: Sequence[Estimate],
    settings: RecordSettings | None,
) -> TrialEstimates:
    """Return the fit of the law to one trial."""
    record = joint.measurement.records()[index]
    # what all trials share makes no difference between them
    doubts, _ = uncertainties_of(joint.mechanism, joint.measurement)[index]
    mechanism = vary(joint.mechanism, "mechanism", record.overrides)
    looked = any(estimate.path == "mechanism.offset" for estimate in joint.estimates)
    timed = record.time is not None and "friction" not in record.quantities()
    alone = refit(
        mechanism=mechanism,
        law=joint.law,
        measurement=replace(record, overrides={}, parameter_uncertainties=doubts),
        vary=[item.path for item in own],
        fixed={"offset": getattr(mechanism, "offset", 0.0)} if looked and timed else None,
        settings=settings,
    )
    assert isinstance(alone, LawFit)
    assert alone.verdict is not None
    drawn, known = (
        alone.judgement.named_values,
        {estimate.path: estimate for estimate in alone.estimates},
    )
    lost = [item.path for item in own if item.path not in drawn or item.path not in known]
    if lost:
        raise InputError(f"it does not determine {lost[0].rpartition('.')[2]}.")
    values = np.array([drawn[item.path] for item in own])
    return TrialEstimates(
        name=name, number=index, conditions=record.conditions, law=alone.law,
        estimates=tuple(known[item.path] for item in own), values=values.mean(axis=1),
        covariance=np.atleast_2d(np.cov(values)), left=alone.verdict.closest.left,
    )  # fmt: skip


def _compared(
    joint: LawFit, trials: Sequence[TrialEstimates], failed: Mapping[str, str]
) -> tuple[TrialComparison, list[tuple[float, str]]]:
    """Return what the posterior over sizes of differences says of trials.

    Beside it are probability and words of what differs between texts of a condition.
    """
    y = np.concatenate([trial.values for trial in trials])
    count, width = len(trials), len(trials[0].values)
    weights = np.array([1.0 / np.diag(trial.covariance) for trial in trials])
    middle = np.sum(weights * y.reshape(count, width), axis=0) / weights.sum(axis=0)
    size = np.maximum(np.abs(middle), np.min(np.sqrt(1.0 / weights), axis=0))
    columns, noise = _columns(trials), block_diag(*(trial.covariance for trial in trials))
    shapes = np.full((count, 1), BROAD), *columns.values(), np.eye(count)
    parts = [np.kron(x, np.diag(size)) for x in shapes]
    left, logs, solved = y - np.tile(middle, count), list[float](), []
    shares = [zip(RUNS, RUNS_PRIOR, strict=True)]
    shares += [zip(INPUT, INPUTS_PRIOR, strict=True) for _ in columns]
    for node in itertools.product(*map(list, shares)):
        run, *sizes = (x for x, _ in node)
        factors = (1.0, *sizes, run)
        every = np.hstack([b * x for b, x in zip(factors, parts, strict=True)])
        inner = every.T @ np.linalg.solve(noise, every) + np.eye(every.shape[1])
        root = np.linalg.cholesky(inner)
        z = np.linalg.solve(root, every.T @ np.linalg.solve(noise, left))
        prior = sum(math.log(p) for _, p in node)
        logs.append(prior - float(np.sum(np.log(np.diag(root)))) + 0.5 * float(z @ z))
        solved.append((factors, every, root, z))
    weight = np.exp(np.array(logs) - logsumexp(logs))
    random, levels = np.random.default_rng(0), list[Array]()
    slopes: dict[str, list[Array]] = {name: [] for name in columns}
    ends = np.cumsum([x.shape[1] for x in parts])[:-1]
    for (factors, every, root, z), n in zip(solved, allotted(weight, DRAWS), strict=True):
        drawn = np.linalg.solve(root.T, z[:, None] + random.normal(size=(len(z), n)))
        levels.append((every @ drawn).T)
        each = zip(columns, factors[1:], np.split(drawn, ends)[1:], strict=False)
        for name, b, block in each:
            slopes[name].append((b * block).T)
    draws = np.vstack(levels)
    first = draws.reshape(len(draws), count, width)[:, :, 0]
    apart = np.std(first, axis=1, ddof=1) / size[0]
    low, median, high = np.quantile(apart, (0.025, 0.5, 0.975)).tolist()
    at = np.array([factors for factors, *_ in solved])
    told = {
        name: (float(weight[at[:, k] > INPUT[0]].sum()),
               np.vstack(slopes[name]) * np.tile(size, x.shape[1]))
        for k, (name, x) in enumerate(columns.items(), 1)
    }  # fmt: skip
    least = (at[:, 1:-1] == INPUT[0]).all(axis=1) & (at[:, -1] == RUNS[0])
    result = TrialComparison(
        fit=joint, trials=tuple(trials), probability=float(1.0 - weight[least].sum()),
        spread=(median, low, high), lines=tuple(_lines(trials, told, middle)), failed=failed,
    )  # fmt: skip
    return result, [*_texts(trials, told, middle)]


def _columns(trials: Sequence[TrialEstimates]) -> dict[str, Array]:
    """Return the columns (k, c) of conditions that differ: a number over its range, or texts."""
    result = dict[str, Array]()
    for name in _conditions(trials):
        values = [trial.conditions.get(name) for trial in trials]
        if any(x is None for x in values) or len({type(x) for x in values}) > 1:
            continue
        if len({*values}) < 2 or len(result) == MOST_CONDITIONS:
            continue
        if isinstance(values[0], str):
            words = [*dict.fromkeys(values)]
            x = np.array([[float(v == w) for w in words] for v in values])
        else:
            z = np.array(values, dtype=float)
            x = ((z - z.mean()) / np.ptp(z))[:, None]
        result[name] = x
    return result


def _conditions(trials: Sequence[TrialEstimates]) -> list[str]:
    return [*dict.fromkeys(name for trial in trials for name in trial.conditions)]


def _lines(
    trials: Sequence[TrialEstimates], effects: Effects, middle: Array
) -> Iterator[ConditionLine]:
    """Yield each parameter as a line over each numeric condition."""
    for name, (probability, drawn) in effects.items():
        values = [trial.conditions[name] for trial in trials]
        if isinstance(values[0], str):
            continue
        z = np.array(values, dtype=float)
        for k, estimate in enumerate(trials[0].estimates):
            own = drawn[:, k] / np.ptp(z)
            low, slope, high = np.quantile(own, (0.025, 0.5, 0.975)).tolist()
            first, last = float(z.min()), float(z.max())
            start, end = (float(middle[k] + slope * (x - z.mean())) for x in (first, last))
            yield ConditionLine(
                path=estimate.path, quantity=estimate.quantity, condition=name, ends=(first, last),
                values=(start, end), slope=slope, low=low, high=high, probability=probability,
            )  # fmt: skip


def _texts(
    trials: Sequence[TrialEstimates], effects: Effects, middle: Array
) -> Iterator[tuple[float, str]]:
    """Yield what differs between trials with different texts for a condition, if it is clear."""
    for name, (probability, drawn) in effects.items():
        values = [trial.conditions[name] for trial in trials]
        if not isinstance(values[0], str):
            continue
        words = [*dict.fromkeys(values)]
        width = len(trials[0].estimates)
        each = drawn.reshape(len(drawn), len(words), width)
        for k, estimate in enumerate(trials[0].estimates):
            ends = np.quantile(each[:, :, k] - each[:, :1, k], (0.025, 0.975), axis=0)[:, 1:]
            if not np.any((ends[0] > 0.0) | (ends[1] < 0.0)):
                continue
            means = middle[k] + np.median(each[:, :, k], axis=0)
            parts = [
                f"{with_unit(number(x), estimate.quantity.unit)} for {w!r}"
                for w, x in zip(words, means.tolist(), strict=True)
            ]
            yield (
                probability,
                f"{estimate.quantity.symbol} is {joined(parts)} ({condition_name(name)})",
            )


# What is said.


def _sentences(found: TrialComparison, texts: Sequence[tuple[float, str]]) -> Iterator[str]:
    """Yield what a comparison says; whether the trials share the law first."""
    trials = found.trials
    clear = sorted((item for item in found.lines if item.clear), key=_width)[:MOST]
    median, low, high = (percent(x) for x in found.spread)
    symbol = trials[0].estimates[0].quantity.symbol
    spread = f"between them {symbol} differs by {median} ({low} to {high}, standard deviation)"
    if is_asserted(found.probability):
        said = [_change(line) for line in clear]
        said = said or [text for p, text in texts if is_asserted(p)][:MOST]
        yield (
            f"The trials do not share one law (probability {percent(found.probability)}):"
            f" {joined(said or [*_range(trials)])}{'' if said else _cause(found.lines)}."
        )
        yield f"{spread[0].upper()}{spread[1:]}."
        yield (
            "One law for all trials is an average; its intervals do not apply to individual trials."
        )
        for line in clear:
            yield _slope(line)
    elif found.probability > 0.5:
        yield (
            f"The trials may differ (probability {percent(found.probability)}), which is not"
            f" enough to say so: {spread}."
        )
    else:
        yield f"The trials are consistent with one law: {spread}."
    yield from _troubles(trials)
    for name, reason in found.failed.items():
        yield f"{name} could not be compared: {reason.rstrip('.')}."


def _width(line: ConditionLine) -> float:
    return (line.high - line.low) / max(abs(line.slope), 1e-300)


def _change(line: ConditionLine) -> str:
    """Return how a parameter changes with a condition: "F_c rises from 2 N at 20 °C to ..."."""
    verb = "rises" if line.slope > 0.0 else "falls"
    first, last = (with_unit(significant(value), line.quantity.unit) for value in line.values)
    at, to = (_at(line.condition, value) for value in line.ends)
    return f"{line.quantity.symbol} {verb} from {first} at {at} to {last} at {to}"


def _at(condition: str, value: float) -> str:
    unit = condition_unit(condition)
    if unit:
        return with_unit(number(value), unit)
    return f"{condition_name(condition)} {number(value)}"


def _slope(line: ConditionLine) -> str:
    by = unit_text(condition_unit(line.condition)) or f"unit of {condition_name(line.condition)}"
    slope = with_unit(within(line.slope, line.low, line.high), line.quantity.unit)
    return (
        f"{line.quantity.symbol} changes by {slope} per {by} (95 % interval"
        f" {interval(line.low, line.high)})."
    )


def _range(trials: Sequence[TrialEstimates]) -> Iterator[str]:
    """Yield the range of the parameter that differs most between trials, over its errors."""
    best = (0.0, "")
    for k, estimate in enumerate(trials[0].estimates):
        least, most = (f(trials, key=lambda t: float(t.values[k])) for f in (min, max))
        errors = math.hypot(*(math.sqrt(t.covariance[k, k]) for t in (least, most)))
        apart = float(most.values[k] - least.values[k]) / max(errors, 1e-300)
        if apart > best[0]:
            low, high = (
                f"{with_unit(number(t.estimates[k].value), estimate.quantity.unit)} in {t.name}"
                for t in (least, most)
            )
            best = apart, f"{estimate.quantity.symbol} ranges from {low} to {high}"
    if best[1]:
        yield best[1]


def _cause(lines: Sequence[ConditionLine]) -> str:
    """Return which condition may be the cause, as the end of a sentence."""
    if not lines:
        return ""
    best = max(lines, key=lambda line: (line.probability, -_width(line)))
    name = condition_name(best.condition)
    if best.probability < 0.5:
        return ", which no condition explains"
    return (
        f", perhaps with the {name} (probability {percent(best.probability)}: more trials would"
        " tell)"
    )


def _troubles(trials: Sequence[TrialEstimates]) -> Iterator[str]:
    """Yield which conditions are the same in all trials, missing, or change together."""
    differing: dict[str, dict[str, float | str]] = {}
    for condition in _conditions(trials):
        name = condition_name(condition)
        have = {t.name: v for t in trials if (v := t.conditions.get(condition)) is not None}
        lack = [t.name for t in trials if t.name not in have]
        if lack:
            verb = "has" if len(lack) == 1 else "have"
            yield f"{joined(lack)} {verb} no {name}: its effect was not looked for."
        elif len({type(value) for value in have.values()}) > 1:
            yield f"{name} is a number in some trials and a text in others: give one kind."
        elif len({*have.values()}) == 1:
            (value,) = {*have.values()}
            said = _at(condition, value) if isinstance(value, float) else f"{name} {value!r}"
            yield f"All trials have {said}: its effect cannot be determined."
        else:
            differing[condition] = have
    for item, other in itertools.combinations(differing, 2):
        if _together(differing[item], differing[other]):
            yield (
                f"{condition_name(item)} and {condition_name(other)} vary together: their effects"
                " cannot be separated."
            )


def _together(one: Mapping[str, float | str], other: Mapping[str, float | str]) -> bool:
    """Whether two conditions of trials say nearly the same."""
    pairs = [(one[key], other[key]) for key in one]
    if any(isinstance(value, str) for pair in pairs for value in pair):
        levels = {len({*column}) for column in (pairs, *zip(*pairs, strict=True))}
        # that every trial has values of its own says nothing, unless there are two of them
        return len(levels) == 1 and (min(levels) < len(pairs) or len(pairs) == 2)
    return abs(float(np.corrcoef(np.array(pairs, dtype=float).T)[0, 1])) > TOGETHER


def rests(record: Measurement) -> bool:
    """Whether a record is one of a single body that rests throughout, as `check` says.

    Examples
    --------
    >>> t = np.arange(50.0)
    >>> [rests(Measurement(time=t, position=x, force=t)) for x in (0.0 * t, np.sin(t))]
    [True, False]
    """
    if record.time is None or record.joints:
        return False
    return any(fault.kind == "constant" for fault in faults(record))
