"""What a selection on travels gives back."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, cast, final

from typing_extensions import override

from stickslip.display import plots
from stickslip.errors import InputError
from stickslip.formatting import count, joined, number
from stickslip.friction import FrictionLaw
from stickslip.identification import Estimate, trials_of
from stickslip.kinds.travels.result import TravelFit
from stickslip.kinds.travels.separations import Proposal, Separation
from stickslip.quantities import fields_of, parameters
from stickslip.selection import Candidate, Criteria, Verdict, plain
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
    passed_over: str = ""
    """Why the law is not taken whatever its score; empty if it may be."""
    distinguished: bool = True
    """Whether the readings tell the law from the best one beyond their uncertainty."""

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
        found = self.fit.estimates if self.fit else ()
        return {
            "law": self.name,
            "parameters": ", ".join(f"{e.quantity.symbol} = {number(e.value)}" for e in found),
            "range": ", ".join(estimate.range for estimate in found),
            "travel": self.criteria.travel if self.criteria else math.nan,
            "score": math.nan if self.score is None else self.score,
        }

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
    for trial in trials_of(verdict.mechanism, verdict.measurement, verdict.t_end):
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
