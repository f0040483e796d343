"""Whether trials of one rig share one law, and how it depends on their conditions."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from stickslip.data import Measurement, condition_name, condition_unit, faults
from stickslip.engine.solver import notice
from stickslip.errors import ConvergenceError, InputError, SimulationError, StickslipError
from stickslip.friction import FrictionLaw, law_type
from stickslip.identify.fits.estimation.estimates import TOGETHER, bounds_met, estimates_of
from stickslip.identify.fits.estimation.jackknife import (
    BLOCKS,
    Displaced,
    block_sums,
    infer,
    quantile_of,
)
from stickslip.identify.fits.estimation.levenberg_marquardt import improve
from stickslip.identify.fits.estimation.problem import (
    FixedParameterProblem,
    ResidualJacobian,
    SubsetProblem,
)
from stickslip.identify.fits.records.fit import RecordFit, scale_of
from stickslip.identify.fits.records.fitting import RouteName, fit_records
from stickslip.identify.fits.results import Estimate
from stickslip.identify.fits.settings import CHANCE, NEGLIGIBLE, RecordSettings
from stickslip.identify.fits.validation import check_given
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, vary
from stickslip.show.display import InPanels, Summary, Tabular, summary_of_table
from stickslip.show.formatting import (
    interval,
    joined,
    number,
    significant,
    unit_text,
    with_unit,
    within,
)

if TYPE_CHECKING:
    import pandas as pd


Array: TypeAlias = NDArray[np.float64]

MOST = 3
"""Parameters that a sentence names at most."""
LEAST_P = 1e-3
"""Below this, a probability is given as less than this."""
LAW = "friction."
"""How paths of a law begin; what is looked for beside it is the rig's, one number of all trials."""
NOT_ALONE = (
    "only trials that can be fitted individually are compared: records in time or measured"
    " friction, not travels or the force of a spring."
)
"""Why other measurements are refused."""


@dataclass(frozen=True, kw_only=True)
class ConditionLine:
    """A parameter as a line over a condition, by weighted least squares."""

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
    """Lower end of the 95 % interval of the slope; minus infinity if it is not bounded."""
    high: float
    """Upper end."""
    freedom: float
    """Degrees of freedom of that interval."""
    scatter: float
    """Probability of so large a scatter about the line if a line is right; NaN of two values."""

    @property
    def clear(self) -> bool:
        """Whether the interval of the slope leaves 0 out."""
        return self.low > 0.0 or self.high < 0.0


def line_over(
    condition: Array, values: Array, errors: Array, freedom: Array
) -> tuple[Array, float, float, float]:
    """Return a line through values with errors: its intercept and slope, and what is to be known.

    Where values scatter about the line by more than their errors tell, the scatter counts, with
    the degrees of freedom that it has.

    Examples
    --------
    >>> z = np.array([20.0, 40.0, 60.0])
    >>> line, error, *_ = line_over(z, 0.1 + 0.001 * z, np.full(3, 0.002), np.full(3, 7.0))
    >>> line.round(6).tolist(), round(error, 6)
    ([0.1, 0.001], 7.1e-05)
    """
    weights = 1.0 / errors**2
    center = float(np.average(condition, weights=weights))
    table = np.column_stack([np.ones_like(condition), condition - center])
    normal = table.T @ (weights[:, None] * table)
    level, slope = np.linalg.solve(normal, table.T @ (weights * values))
    error = math.sqrt(1.0 / normal[1, 1])
    # Welch and Satterthwaite: the slope is a sum over trials, of which each adds its own variance
    shares = (weights * (condition - center) / normal[1, 1]) ** 2 * errors**2
    own = float(shares.sum() ** 2 / np.sum(shares**2 / freedom))
    rest = len(values) - 2
    scatter = math.nan
    if rest > 0:
        misfit = float(np.sum(weights * (values - table @ [level, slope]) ** 2)) / rest
        total = float(np.sum(freedom))
        scatter = float(scipy.stats.f.sf(misfit, rest, total))
        if scatter < CHANCE:
            error, own = error * math.sqrt(misfit), float(rest)
    return np.array([level - slope * center, slope]), error, own, scatter


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
    errors: tuple[float, ...]
    """Standard errors of these; infinite where the trial alone does not tell."""
    freedom: tuple[float, ...]
    """Degrees of freedom of these."""
    rms: float
    """Root mean square of the residuals."""


@dataclass(frozen=True, kw_only=True)
class Homogeneity:
    """The test that trials share one law."""

    p: float
    """Probability of so large a difference if they do; not a number where it cannot be tested."""
    statistic: float
    """F statistic."""
    freedom: tuple[float, float]
    """Degrees of freedom of the F distribution."""


def rows_of(jacobian: ResidualJacobian, rows: NDArray[np.bool_]) -> ResidualJacobian:
    """Return some rows of linearised residuals.

    Examples
    --------
    >>> seen = ResidualJacobian(
    ...     values=np.zeros(1),
    ...     residual=np.arange(3.0),
    ...     slopes=np.ones((3, 1)),
    ...     segment=np.array([0, 0, 1]),
    ... )
    >>> rows_of(seen, seen.segment == 0).residual.tolist()
    [0.0, 1.0]
    """
    return ResidualJacobian(
        values=jacobian.values,
        residual=jacobian.residual[rows],
        slopes=jacobian.slopes[rows],
        segment=jacobian.segment[rows],
    )


def homogeneity(
    trials: Sequence[ResidualJacobian],
    scale: Array,
    separate: Sequence[int],
    displaced: Sequence[Sequence[Displaced]] = (),
) -> Homogeneity:
    """Test whether trials share the values of some unknowns.

    Examples
    --------
    >>> draw = np.random.default_rng(0)
    >>> def trial(level):
    ...     return ResidualJacobian(
    ...         values=np.zeros(1),
    ...         residual=level + draw.normal(size=200),
    ...         slopes=np.ones((200, 1)),
    ...         segment=np.zeros(200, dtype=int),
    ...     )
    >>> same = homogeneity([trial(0.0), trial(0.0)], np.eye(1), [0])
    >>> other = homogeneity([trial(-0.5), trial(0.5)], np.eye(1), [0])
    >>> same.p > 0.05, other.p < 0.001
    (True, True)
    """
    width = len(scale)
    shared = [i for i in range(width) if i not in separate]
    places = _places(len(trials), separate, shared)
    size = len(trials) * len(separate) + len(shared)
    normal, score = np.zeros((size, size)), np.zeros(size)
    gathered = np.zeros((size, width))
    scatters, freedoms = [], []
    for one, place in zip(trials, places, strict=True):
        blocks = max(2, min(BLOCKS, len(one.residual) // 4))
        squares, slopes = block_sums(one, one.slopes @ scale, blocks=blocks)
        normal[np.ix_(place, place)] += squares.sum(axis=0)
        score[place] += slopes.sum(axis=0)
        gathered[place, np.arange(width)] = 1.0
        apart = slopes - slopes.mean(axis=0)
        whole = np.zeros((size, size))
        between = _between_blocks(one, scale, blocks) * blocks / (blocks - 1.0)
        whole[np.ix_(place, place)] = between * (apart.T @ apart)
        scatters.append(whole)
        freedoms.append(blocks - 1.0)
    for several in zip(*displaced, strict=True):
        pull = np.zeros(size)
        for one, place, moved in zip(trials, places, several, strict=True):
            pull[place] += (one.slopes @ scale).T @ moved.rows
        scatters.append(np.outer(pull, pull))
        freedoms.append(math.inf)
    form = _inverse(normal) - gathered @ _inverse(gathered.T @ normal @ gathered) @ gathered.T
    return _matched(float(score @ form @ score), form, scatters, freedoms)


def _between_blocks(one: ResidualJacobian, scale: Array, blocks: int) -> float:
    """Return by how much a whole trial varies more than its blocks, added as independent, say.

    Residuals on both sides of the edge between two blocks are correlated as well. Without this,
    blocks five times as long as residuals remember reject 10 % instead of 5 %.
    """
    table = one.slopes @ scale
    roots = np.linalg.eigh(_inverse(table.T @ table))
    rows = one.residual[:, None] * (table @ (roots[1] * np.sqrt(np.maximum(roots[0], 0.0))))
    n = len(rows)
    spectrum = np.abs(np.fft.rfft(rows, 2 * n, axis=0)) ** 2
    shared = np.fft.irfft(spectrum.sum(axis=1))[:n]
    if not shared[0] > 0.0:
        return 1.0
    below = np.flatnonzero(shared <= 0.0)
    shared = shared[: int(below[0]) if below.size else n] / shared[0]
    lag = np.arange(1, len(shared))
    by_trial, by_block = (
        1.0 + 2.0 * float(np.sum(np.maximum(1.0 - lag / length, 0.0) * shared[1:]))
        for length in (n, n / blocks)
    )
    return by_trial / by_block


def _places(trials: int, own: Sequence[int], shared: Sequence[int]) -> list[NDArray[np.intp]]:
    """Return where the unknowns of each trial (p,) stand among those of all with own values."""
    found = []
    for k in range(trials):
        place = np.zeros(len(own) + len(shared), dtype=np.intp)
        place[list(own)] = k * len(own) + np.arange(len(own))
        place[list(shared)] = trials * len(own) + np.arange(len(shared))
        found.append(place)
    return found


def _inverse(matrix: Array) -> Array:
    """Return the inverse of a normal matrix on the directions that are seen, columns scaled."""
    size = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    size = np.where(size > 0.0, size, 1.0)
    inverse = np.linalg.pinv(matrix / np.outer(size, size), rcond=NEGLIGIBLE, hermitian=True)
    return np.asarray(inverse / np.outer(size, size))


def _matched(
    statistic: float, form: Array, scatters: Sequence[Array], freedoms: Sequence[float]
) -> Homogeneity:
    """Return the F that has the mean and the variance of a quadratic form of block gradients."""
    parts = [form @ scatter for scatter in scatters]
    means = np.array([float(np.trace(part)) for part in parts])
    mean = float(means.sum())
    if not mean > 0.0 or not math.isfinite(statistic):
        return Homogeneity(p=math.nan, statistic=math.nan, freedom=(math.nan, math.nan))
    whole = sum(parts)
    assert isinstance(whole, np.ndarray)
    squares = float(np.sum(whole * whole.T))
    unsure = 0.0
    for part, own, f in zip(parts, means, freedoms, strict=True):
        raw = float(np.sum(part * part.T))
        # a scatter of f degrees overrates its square (Bai & Saranadasa 1996)
        known = (1.0 - 1.0 / f) * (1.0 + 2.0 / f)
        right = max((raw - own * own / f) / known, 0.0) if f > 1.0 else 0.0
        squares += max(right, own * own / len(form)) - raw
        unsure += max(right, own * own / len(form)) / f
    above = min(max(mean * mean / max(squares, 1e-300), 1.0), float(len(form)))
    below = mean * mean / max(unsure, 1e-300)
    found = statistic / mean
    return Homogeneity(
        p=float(scipy.stats.f.sf(found, above, below)), statistic=found, freedom=(above, below)
    )


def sentences_of(
    trials: Sequence[TrialEstimates],
    test: Homogeneity,
    lines: Sequence[ConditionLine],
    failed: Mapping[str, str],
) -> Iterator[str]:
    """Yield what a comparison says; the outcome of the test first."""
    clear = _clear(lines)
    yield _outcome(trials, test, clear)
    if test.p < CHANCE:
        yield (
            "One law for all trials is an average; its intervals do not apply to individual trials."
        )
    for line in clear:
        yield _slope(line, confirmed=test.p < CHANCE)
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
    if not test.p < CHANCE:
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
    if line.scatter < CHANCE:
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
            if p < CHANCE:
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
        if scipy.stats.f.sf(misfit, len(usable) - 1, freedom) < CHANCE:
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


@dataclass(frozen=True, kw_only=True, repr=False)
class TrialComparison(InPanels, Tabular):
    """One law fitted to each of several trials, and whether they share it."""

    fit: RecordFit
    """The joint fit."""
    trials: tuple[TrialEstimates, ...]
    """The law of each trial."""
    test: Homogeneity
    """The test that they share one."""
    lines: tuple[ConditionLine, ...]
    """Parameters as lines over numeric conditions."""
    sentences: tuple[str, ...]
    """What can be said, in words; the first one is the outcome of the test."""
    failed: Mapping[str, str] = field(default_factory=dict)
    """Why a trial could not be fitted, by its name."""

    @property
    def shared(self) -> bool:
        """Whether the trials share one law as far as they tell."""
        return not self.test.p < CHANCE

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
        """Return one row a trial: conditions, each parameter with its interval, residual.

        Examples
        --------
        >>> import numpy as np
        >>> from stickslip import Axis, Coulomb
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
        >>> found.to_dataframe()[["trial", "temperature [degC]", "mu_k"]].round(2).values.tolist()
        [['cold', 20.0, 2.0], ['warm', 60.0, 2.5]]
        """
        import pandas as pd

        rows = []
        for trial in self.trials:
            row: dict[str, Any] = {"trial": trial.name}
            row |= {name: trial.conditions.get(name) for name in self.conditions}
            for one in trial.estimates:
                symbol = one.quantity.symbol
                row |= {symbol: one.value, f"{symbol} low": one.low, f"{symbol} high": one.high}
            rows.append({**row, "residual": trial.rms})
        return pd.DataFrame(rows)

    def _over(self) -> str:
        return "trial"

    def to_dict(self) -> Mapping[str, Any]:
        """Return the comparison as plain numbers and strings."""
        return {
            "law": self.fit.law.name,
            "share_one_law": self.shared,
            "p": _plain(self.test.p),
            "statistic": _plain(self.test.statistic),
            "degrees_of_freedom": [_plain(value) for value in self.test.freedom],
            "trials": [
                {
                    "name": trial.name,
                    "conditions": dict(trial.conditions),
                    "estimates": [one.to_dict() for one in trial.estimates],
                    "residual_rms": trial.rms,
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
                    "low": _plain(line.low),
                    "high": _plain(line.high),
                    "scatter_p": _plain(line.scatter),
                }
                for line in self.lines
            ],
            "failed": dict(self.failed),
            "sentences": list(self.sentences),
        }


def _plain(value: float) -> float | None:
    return value if math.isfinite(value) else None


def compare_trials(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw] | str,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    route: RouteName | None = None,
    settings: RecordSettings | None = None,
    progress: Callable[[float], object] | None = None,
) -> TrialComparison:
    """Fit one law to all trials and to each alone, and test whether they share it.

    The trials are records in time or measured friction. What is looked for beside the law, such as
    a mass or the offset of a sensor, is one number of all trials. `Measurement.conditions` of the
    trials say what was different; each parameter is a line over each numeric condition.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured; trials may override its parameters.
    law : FrictionLaw, type or str
        An instance, whose values are the start; or a type or a name.
    measurement : Measurement
        Trials with records in time or measured friction, at least two.
    vary : str or sequence of str, optional
        Parameters to fit, as for `fit`.
    fixed : mapping of str to float, optional
        Values of parameters that are held [SI], of law and mechanism.
    route : {"shooting", "force-map", "inverse-dynamics", "features"}, optional
        How records are fitted; by what was measured if not given.
    settings : RecordSettings, optional
        Segments, starts and seed.
    progress : callable, optional
        Called with the least root mean square so far; False ends a search with the best so far.

    Returns
    -------
    TrialComparison
        Estimates by trial, the test, lines over conditions, and sentences.

    Raises
    ------
    InputError
        If the measurement does not serve: it has one trial, fewer than two of them move, or each is
        a single travel or the force of a spring.
    ConvergenceError
        If no law fits.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Axis, CoulombViscous
    >>> draw, v = np.random.default_rng(0), np.linspace(-1.0, 1.0, 60)
    >>> trials = [
    ...     Measurement(
    ...         velocity=v,
    ...         friction=(2.0 + 0.01 * t) * np.sign(v) + 0.5 * v + 0.05 * draw.normal(size=60),
    ...         conditions={"temperature [degC]": t},
    ...     )
    ...     for t in (20.0, 40.0, 60.0)
    ... ]
    >>> found = compare_trials(Axis(inertia=1.0), CoulombViscous, Measurement(trials=tuple(trials)))
    >>> found.shared, [line.path for line in found.lines if line.clear]
    (False, ['friction.kinetic_coefficient'])
    """
    check_given("compare_trials", mechanism, measurement)
    _refuse(measurement)
    kind = law_type(law) if isinstance(law, str) else law
    joint = fit_records(
        mechanism,
        kind,
        measurement,
        vary=vary,
        fixed=fixed,
        route=route,
        settings=settings,
        progress=progress,
    )
    return comparison_of(joint)


def _refuse(measurement: Measurement) -> None:
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


def fitted_alone(measurement: Measurement) -> bool:
    """Whether there are several trials with motion, of which each can be fitted alone.

    Examples
    --------
    >>> fitted_alone(Measurement(trials=(Measurement(travel=0.1), Measurement(travel=0.2))))
    False
    """
    records = measurement.records()
    if len(records) < 2 or measurement.travelled:
        return False
    return sum(not rests(record) for record in records) > 1


def compared(joint: RecordFit) -> TrialComparison | None:
    """Return the comparison of the trials of a fit; None where there is nothing to compare.

    A fit that stands is not lost because its trials cannot be compared.
    """
    if not fitted_alone(joint.measurement):
        return None
    try:
        return comparison_of(joint)
    except StickslipError as error:
        notice(f"The trials were not compared: {error}")
        return None


def comparison_of(joint: RecordFit) -> TrialComparison:
    """Compare the trials of a fit: each is fitted alone from the joint optimum."""
    _refuse(joint.measurement)
    own = [i for i, path in enumerate(joint.free_parameters.paths) if path.startswith(LAW)]
    if not own:
        raise InputError("trials cannot be compared by a law without fitted parameters.")
    best, spans = joint.optimum.best, joint.problem.spans
    record_of = spans[:, 0].astype(int)
    records = joint.measurement.records()
    trials, failed = [], {}
    present: list[ResidualJacobian] = []
    moved: list[list[Displaced]] = []
    for index, record in enumerate(records):
        name = record.name or f"trial {index + 1}"
        if rests(record):  # no row of it slips
            continue
        rows = record_of[best.segment] == index
        if not rows.any():
            failed[name] = "none of its data were used"
            continue
        present.append(rows_of(best, rows))
        moved.append([one.of(rows) for one in joint.displaced])
        try:
            trials.append(_alone(joint, index, name, np.flatnonzero(record_of == index), own))
        except (ConvergenceError, InputError, SimulationError) as error:
            failed[name] = str(error)
    test = homogeneity(present, joint.scale, own, moved)
    lines = _lines(trials)
    return TrialComparison(
        fit=joint,
        trials=tuple(trials),
        test=test,
        lines=lines,
        sentences=tuple(sentences_of(trials, test, lines, failed)),
        failed=failed,
    )


def _alone(
    joint: RecordFit, number: int, name: str, segments: NDArray[np.intp], own: Sequence[int]
) -> TrialEstimates:
    """Fit the law to one trial, from the joint optimum; all else is kept."""
    problem: SubsetProblem | FixedParameterProblem = SubsetProblem(
        joint.problem, segments.tolist(), joint.optimum.best
    )
    for i in reversed(range(len(joint.free_parameters))):
        if i not in own:
            # a part of a problem answers to what is asked of all of it here
            problem = FixedParameterProblem(problem, i, float(joint.values[i]))  # type: ignore[arg-type]
    end, _ = improve(problem, joint.values[list(own)])
    free_parameters = problem.free_parameters
    bounds = bounds_met(free_parameters, end.values)
    rows = np.isin(joint.optimum.best.segment, segments)
    moved = [one.of(rows) for one in joint.displaced]
    inference = infer(end, scale_of(free_parameters, end.values, bounds), displaced=moved)
    alone = {one.path for one in moved if not one.shared}
    # what all trials share moves them together, which no difference between them shows
    apart = replace(
        inference, held={path: by for path, by in inference.held.items() if path in alone}
    )
    known = {one.path: one for one in joint.estimates}
    told = replace(
        free_parameters,
        items=tuple(
            replace(item, quantity=known[item.path].quantity) for item in free_parameters.items
        ),
    )
    estimates = estimates_of(told, end, inference, bounds)
    errors = [
        # what all trials together leave open is told by none of them
        float(error) if one.bounded and known[one.path].bounded and error > 0.0 else math.inf
        for error, one in zip(apart.errors, estimates, strict=True)
    ]
    return TrialEstimates(
        name=name,
        number=number,
        conditions=joint.measurement.records()[number].conditions,
        law=vary(
            joint.law,
            "friction",
            dict(zip(free_parameters.paths, end.values.tolist(), strict=True)),
        ),
        estimates=estimates,
        errors=tuple(errors),
        freedom=tuple(map(float, inference.freedom)),
        rms=end.rms,
    )


def _lines(trials: Sequence[TrialEstimates]) -> tuple[ConditionLine, ...]:
    """Return each parameter as a line over each numeric condition that differs between trials."""
    found = []
    for condition in dict.fromkeys(name for trial in trials for name in trial.conditions):
        with_it = [t for t in trials if isinstance(t.conditions.get(condition), float)]
        for i in range(len(trials[0].estimates)):
            usable = [t for t in with_it if 0.0 < t.errors[i] < math.inf]
            z = np.array([t.conditions[condition] for t in usable], dtype=float)
            if len(usable) < 2 or not np.ptp(z) > 0.0:
                continue
            line, error, freedom, scatter = line_over(
                z,
                np.array([t.estimates[i].value for t in usable]),
                np.array([t.errors[i] for t in usable]),
                np.array([t.freedom[i] for t in usable]),
            )
            width = float(quantile_of(np.array(freedom))) * error
            ends = (float(z.min()), float(z.max()))
            found.append(
                ConditionLine(
                    path=trials[0].estimates[i].path,
                    quantity=trials[0].estimates[i].quantity,
                    condition=condition,
                    ends=ends,
                    values=(float(line[0] + line[1] * ends[0]), float(line[0] + line[1] * ends[1])),
                    slope=float(line[1]),
                    low=float(line[1]) - width,
                    high=float(line[1]) + width,
                    freedom=freedom,
                    scatter=scatter,
                )
            )
    return tuple(found)


# Trials at rest throughout: no row of them slips, so that a fit of sliding friction has none.


def rests(record: Measurement) -> bool:
    """Whether a record is one of a single body that rests throughout, as `check` says.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(50.0)
    >>> [rests(Measurement(time=t, position=x, force=t)) for x in (0.0 * t, np.sin(t))]
    [True, False]
    """
    if record.time is None or record.joints:
        return False
    return any(one.kind == "constant" for one in faults(record))
