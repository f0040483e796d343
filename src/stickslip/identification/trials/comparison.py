"""Whether trials of one rig share one law, and how it depends on their conditions."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.display import InPanels, Summary, summary_of_table
from stickslip.errors import ConvergenceError, InputError, SimulationError, StickslipError
from stickslip.experiments import Measurement
from stickslip.friction import FrictionLaw, law_type
from stickslip.identification.estimation.estimates import bounds_met, estimates_of
from stickslip.identification.estimation.jackknife import Displaced, infer, quantile_of
from stickslip.identification.estimation.levenberg_marquardt import improve
from stickslip.identification.estimation.problem import (
    FixedParameterProblem,
    ResidualJacobian,
    SubsetProblem,
)
from stickslip.identification.records.fit import RecordFit, scale_of
from stickslip.identification.records.fitting import fit_records
from stickslip.identification.records.route_choice import RouteName
from stickslip.identification.settings import RecordSettings
from stickslip.identification.trials.condition_lines import ConditionLine, line_over
from stickslip.identification.trials.estimates import TrialEstimates
from stickslip.identification.trials.homogeneity import Homogeneity, homogeneity, rows_of
from stickslip.identification.trials.wording import SURE, sentences_of
from stickslip.identification.validation import check_given
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary
from stickslip.solver import notice
from stickslip.tables import Tabular

if TYPE_CHECKING:
    import pandas as pd

Array: TypeAlias = NDArray[np.float64]

LAW = "friction."
"""How paths of a law begin; what is looked for beside it is the rig's, one number of all trials."""


@final
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
        return not self.test.p < SURE

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of the conditions, as they were given."""
        return tuple(dict.fromkeys(name for trial in self.trials for name in trial.conditions))

    @override
    def __str__(self) -> str:
        """Return the sentences, one a line."""
        return "\n".join(self.sentences)

    @override
    def __repr__(self) -> str:
        return f"<TrialComparison of {len(self.trials)} trials: {self.sentences[0]}>"

    @override
    def _summary(self) -> Summary:
        first, *others = self.sentences
        return summary_of_table(first, self.to_dataframe(), others)

    @override
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

    @override
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
        How records are fitted; chosen by `choose_route` if not given.
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
        If the measurement does not serve: it has one trial, or each is a single travel or the force
        of a spring.
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


NOT_ALONE = (
    "only trials that can be fitted individually are compared: records in time or measured"
    " friction, not travels or the force of a spring."
)
"""Why other measurements are refused."""


def _refuse(measurement: Measurement) -> None:
    if measurement.travelled or measurement.only_spring_force:
        raise InputError(NOT_ALONE)
    if len(measurement.records()) < 2:
        raise InputError("a comparison needs at least two trials, got one record.")


def fitted_alone(measurement: Measurement) -> bool:
    """Whether there are several trials of which each can be fitted alone.

    Examples
    --------
    >>> fitted_alone(Measurement(trials=(Measurement(travel=0.1), Measurement(travel=0.2))))
    False
    """
    return len(measurement.records()) > 1 and not measurement.travelled


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
    for number, record in enumerate(records):
        name = record.name or f"trial {number + 1}"
        rows = record_of[best.segment] == number
        if not rows.any():
            failed[name] = "none of its data were used"
            continue
        present.append(rows_of(best, rows))
        moved.append([one.of(rows) for one in joint.displaced])
        try:
            trials.append(_alone(joint, number, name, np.flatnonzero(record_of == number), own))
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
