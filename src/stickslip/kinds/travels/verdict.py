"""What a selection on travels gives back."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, Final, cast, final

from typing_extensions import override

from stickslip.display import plots
from stickslip.errors import InputError
from stickslip.formatting import Scale, count, joined, number, scale_of, with_unit, within
from stickslip.friction import FrictionLaw
from stickslip.identification import Estimate, Trial, quantities_read, trials_of
from stickslip.kinds.columns import Column, Columns, data_row
from stickslip.kinds.travels.result import TravelFit
from stickslip.kinds.travels.separations import Proposal, Separation
from stickslip.quantities import fields_of, parameters
from stickslip.selection import Candidate, Criteria, Verdict, plain, score_scale, score_text
from stickslip.trajectory import Trajectory

if TYPE_CHECKING:
    from stickslip.display import Drawing, Target
    from stickslip.plots import Draw


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class TravelCandidate(Candidate[TravelFit]):
    """One law on travels: as given, as fitted, and what it does with each."""

    law: FrictionLaw
    """The law as given."""
    given: Criteria
    """What the mechanism does with it; in the first trial where there are several."""
    run: Trajectory | None
    """The fitted run; of the first trial where there are several."""
    criteria: Criteria | None
    """What the fitted run does; of the first trial too."""
    score: float | None = None
    """Held-out error [m], root mean square over trials; None where no trial is left to judge."""
    score_error: float | None = None
    """Its standard error [m]."""
    held_out: tuple[float, ...] = ()
    """Held-out error of each trial [m]."""
    ordinary: bool = False
    """Whether the values of the law are ordinary start values that nobody gave."""
    influence: Mapping[str, float] = field(default_factory=dict)
    """How far each parameter taken as given moves the travel [m] when changed by half."""
    assumed: tuple[str, ...] = ()
    """Names of the parameters that were neither measured nor fitted."""
    refuted: str = ""
    """Which value that was given the readings contradict, as a sentence; empty if they do not."""
    marked: tuple[str, ...] = ()
    """Names of the parameters whose values were given as assumed."""
    invented: tuple[str, ...] = ()
    """Names of the parameters that the law cannot do without and that were neither measured, given
    nor fitted."""
    beside: bool = False
    """Whether nobody asked for the law: it is tried because it may change what is stated."""
    alone: tuple[Estimate, ...] = ()
    """Estimates with the intervals that they have if this law holds, of the law that is named;
    those of its fit hold whichever law holds that the readings do not rule out."""
    drifts: str = ""
    """The law with the drift beside which it was fitted, in words; empty where none was."""
    otherwise: Mapping[str, str] = field(default_factory=dict)
    """Laws that explain the readings as well as this one if friction drifts from trial to trial, in
    words, by name."""
    passed_over: str = ""
    """Why the law is not taken whatever its score; empty if it may be."""
    distinguished: bool = True
    """Whether the readings tell the law from the best one beyond their uncertainty."""

    @property
    def ran(self) -> bool:
        """Whether there is a run of the law with fitted values."""
        return self.fit is not None and self.criteria is not None

    @property
    def unscored(self) -> str:
        """Why there is no held-out error, in words; empty if there is one."""
        if self.score is not None:
            return ""
        if self.dropped:
            return self.dropped
        if self.invented:
            names = joined([f"${fields_of(type(self.law))[n].symbol}$" for n in self.invented])
            verb = "was" if len(self.invented) == 1 else "were"
            return f"not scored: {names} {verb} assumed, not fitted"
        if self.fit and self.fit.settings > 1:
            return "not scored: the readings rule it out"
        return "no held-out trials: all trials repeat one setting"

    @property
    def guessed(self) -> tuple[str, ...]:
        """Names of what was not fitted and nobody measured: invented, or given as assumed."""
        return self.invented or tuple(name for name in self.marked if name in self.assumed)

    @property
    @override
    def parameters(self) -> int:
        """Number of parameters that were fitted or invented."""
        return (len(self.fit.estimates) if self.fit else 0) + len(self.invented)

    @override
    def __str__(self) -> str:
        """Return the law, what was fitted and how well it predicts, in one line."""
        if self.dropped or self.fit is None:
            return f"{self.title}: dropped, {self.dropped}"
        score = "" if self.score is None else f"; held-out error {number(1e3 * self.score, 2)} mm"
        return f"{self.title}: {', '.join(map(str, self.fit.estimates))}{score}"

    @override
    def to_row(self) -> Mapping[str, Any]:
        return data_row(columns_of(None), self)

    @override
    def to_dict(self) -> Mapping[str, Any]:
        law = self.fit.law if self.fit else self.law
        return {
            "law": self.name,
            "dropped": self.dropped,
            "passed_over": plain(self.passed_over),
            "score": self.score,
            "score_error": self.score_error,
            "held_out": list(self.held_out),
            "parameters": {path: value for path, _, value in parameters(law, "friction")},
            "taken_as_given": list(self.assumed),
            "invented": list(self.invented),
            "beside": self.beside,
            "alone": [estimate.to_dict() for estimate in self.alone],
            "distinguished": self.distinguished,
            "otherwise": dict(self.otherwise),
            "influence_on_travel": dict(self.influence),
            "fit": self.fit.to_dict() if self.fit else None,
            "criteria_as_given": asdict(self.given),
            "criteria_fitted": asdict(self.criteria) if self.criteria else None,
        }


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class TravelVerdict(Verdict[TravelCandidate]):
    """A verdict on travels."""

    separations: tuple[Separation, ...]
    """Predictions for measurements not yet made, in the order of the setting."""
    proposal: Proposal | None
    """The settings to measure next; None where there is no law to name or no other to tell from."""
    t_end: float
    """Time after which a body counts as stopped [s]."""

    @property
    def explained(self) -> tuple[TravelCandidate, ...]:
        """The candidates that reproduce the measurement."""
        return tuple(candidate for candidate in self.candidates if not candidate.dropped)

    @property
    @override
    def closest(self) -> TravelCandidate | None:
        """The best law, or the one that would be taken if the readings did not contradict it."""
        return self.best or next((c for c in self.explained if c.fit is not None), None)

    @property
    def trials(self) -> tuple[Trial, ...]:
        """What was measured, trial by trial, whatever quantity was read."""
        return trials_of(self.mechanism, self.measurement, self.t_end)

    @property
    def measured_band(self) -> tuple[float, float] | None:
        """The range of the first measured travel [m]; None if it has no stated uncertainty."""
        first = self.trials[0]
        half = first.half_width
        return (first.travel - half, first.travel + half) if half else None

    @property
    def score_scale(self) -> Scale:
        """What held-out errors [m] are shown in."""
        return score_scale([c.score for c in self.candidates], "m")

    @property
    @override
    def route(self) -> str:
        return "travel"

    @property
    @override
    def score_unit(self) -> str:
        return "m"

    @override
    def _plot(self, ax: "Target") -> "Drawing":
        """Draw what laws predict at other settings where nothing is ranked."""
        if self.scored:
            return cast("Drawing", plots().plot_scores(self, ax))
        return plot_separation(self, ax)

    @override
    def _basis(self) -> str:
        trials = count(len(self.measurement.records()), "trial")
        judged = "ranked by held-out error" if self.ranked else "not ranked"
        return f", {len(self.explained)} explain {trials}; {judged}"

    @override
    def _details(self) -> Mapping[str, Any]:
        return {
            "proposal": self.proposal.to_dict() if self.proposal else None,
            "next_measurements": [separation.to_dict() for separation in self.separations],
        }


def estimate_text(estimate: Estimate) -> str:
    """Return symbol and value of an estimate, such as ``"$mu_k$ = 0.255"``."""
    value = within(estimate.value, estimate.low, estimate.high)
    return f"${estimate.quantity.symbol}$ = {with_unit(value, estimate.quantity.unit)}"


def estimate_range(estimate: Estimate) -> str:
    """Return the interval of an estimate, or why it has no end."""
    text = estimate.range
    return f"{text}: {estimate.reason}" if estimate.reason and not estimate.bounded else text


def _estimates(one: TravelCandidate) -> Sequence[Estimate]:
    return one.fit.estimates if one.fit else ()


def _ranges(one: TravelCandidate) -> str:
    return ", ".join(estimate.range for estimate in _estimates(one))


def _of_run(text: Callable[[Criteria], str]) -> Callable[[TravelCandidate], str | None]:
    return lambda one: None if one.criteria is None else text(one.criteria)


MM: Final = Scale(1e3, "mm")
"""What a terminal shows held-out errors in."""


def columns_of(verdict: TravelVerdict | None) -> Columns[TravelCandidate]:
    """Return what tables say of each law; of no verdict, only values, which need none.

    A terminal has travels in one unit, and as they were read; a page has the scores first.
    """
    ranked, best, errors, scale = False, None, MM, MM
    trials: tuple[Trial, ...] = ()
    if verdict is not None:
        ranked, best, trials = verdict.ranked, verdict.best, verdict.trials
        runs = [c.criteria.travel for c in verdict.candidates if c.criteria]
        errors, scale = verdict.score_scale, scale_of(runs, "m")
    return (
        Column(
            key="law", title="law", page="model", numeric=False,
            value=lambda one: one.name, text=lambda one: one.title,
        ),
        Column(
            page=f"held-out error\n{errors.unit}" if ranked else "", plotted=True,
            text=lambda one: score_text(errors, one.score, one.score_error),
        ),
        Column(
            key="parameters", title="fitted", page="fitted", numeric=True,
            value=lambda one: ", ".join(
                f"{e.quantity.symbol} = {number(e.value)}" for e in _estimates(one)
            ),
            text=lambda one: ", ".join(map(estimate_text, _estimates(one)))
            if one.ran else "no value fits",
        ),
        Column(
            key="range", title="range", page="" if ranked else "range", phone="label",
            label="range", value=_ranges, text=lambda one: _ranges(one) if one.ran else None,
        ),
        Column(page="not fitted", numeric=False, phone="label", label="not fitted:"),
        Column(
            key="travel", title="travel", page="" if ranked else "travel\nm", phone="hide",
            value=lambda one: one.criteria.travel if one.criteria else math.nan,
            text=_of_run(lambda seen: scale.error(seen.travel)),
        ),
        Column(
            title=quantities_read(trials),
            text=_of_run(lambda seen: trials[0].as_read(seen.travel)),
        ),
        Column(
            title="velocity never < 0",
            text=_of_run(lambda seen: "yes" if seen.velocity_never_negative else "no"),
        ),
        Column(
            key="score", title="held-out error, mm" if ranked else "",
            value=lambda one: math.nan if one.score is None else one.score,
            text=lambda one: None if one.score is None
            else score_text(MM, one.score, one.score_error),
        ),
        Column(
            page=f"largest difference\nfrom {best.title}, mm" if best and not ranked else "",
            phone="label", label="differs by up to, mm",
        ),
    )  # fmt: skip


def misfit(candidate: TravelCandidate) -> float:
    """Return the root mean square of the residuals of a fit [m]."""
    residuals = candidate.fit.residuals if candidate.fit else ()
    return math.sqrt(sum(r * r for r in residuals) / max(len(residuals), 1))


def draw_proposal(verdict: TravelVerdict) -> "Draw":
    """Return a drawing of what the laws of a verdict predict, and where to measure next."""
    from stickslip.kinds.travels.figures import draw_separation

    proposal = verdict.proposal
    if proposal is None or not verdict.separations:
        raise InputError(
            "the verdict proposes no measurement, so there are no predictions to draw: no law was"
            " chosen, or no other law to distinguish it from."
        )
    rows = verdict.separations
    measured = []
    for trial in verdict.trials:
        settings = {path: value for path, _, value in parameters(trial.mechanism, "mechanism")}
        if settings.get(rows[0].path) is not None:
            measured.append((float(settings[rows[0].path]), trial.travel))
    names = (proposal.best, *proposal.rivals)
    return draw_separation(
        [row.value for row in rows],
        {name: [row.predicted[name] for row in rows] for name in names},
        proposal.best,
        measured,
        what=rows[0].path.rpartition(".")[2].replace("_", " "),
        unit=rows[0].unit,
        proposed=[row.value for row in proposal.settings],
        titles={candidate.name: candidate.title for candidate in verdict.candidates},
    )


def plot_separation(verdict: TravelVerdict, ax: "Target" = None) -> "Drawing":
    """Plot the travel that each law of a verdict predicts against the setting of the rig.

    Parameters
    ----------
    verdict : TravelVerdict
        A selection by travels, with a proposal.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.

    Returns
    -------
    matplotlib.axes.Axes
        The panel, with what was measured and a band at each setting to measure next.

    Raises
    ------
    InputError
        If the verdict proposes no measurement.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from stickslip import Coulomb, Measurement, SpringBlock, select
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> laws = [Coulomb(kinetic_coefficient=0.25), "viscous"]
    >>> verdict = select(rig, laws, Measurement(travel=0.20, uncertainty=0.005))
    >>> plot_separation(verdict, Figure()).get_ylabel()
    'travel, m'
    """
    from stickslip.kinds.travels.figures import SEPARATION_SIZES
    from stickslip.plots import check_type, on_axes

    check_type("verdict", verdict, TravelVerdict)
    return on_axes(draw_proposal(verdict), ax, SEPARATION_SIZES["wide"])
