"""What a selection gives back."""

import html
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from statistics import median_high
from typing import TYPE_CHECKING, Any, final

from typing_extensions import override

from stickslip.display import OnAxes, Summary, summary_of_table
from stickslip.experiments import Measurement
from stickslip.formatting import EstimateText, Scale, number, scale_of
from stickslip.friction import FrictionLaw
from stickslip.identification import TravelFit
from stickslip.mechanisms import Mechanism
from stickslip.quantities import fields_of, parameters
from stickslip.selection.criteria import Criteria
from stickslip.selection.design.discriminating_settings import Proposal, Separation
from stickslip.trajectory import Trajectory

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "Candidate",
    "TravelVerdict",
    "Verdict",
    "Wording",
    "misfit",
    "plain",
    "score_scale",
    "score_text",
]


def score_scale(scores: Iterable[float | None], unit: str) -> Scale:
    """Return the multiple of a unit in which the scores of a verdict are shown, on all its media.

    The median chooses: neither a law that fails nor one that is exact hides the others.

    Examples
    --------
    >>> score_scale([1e-15, 0.0002, 0.0003, math.inf], "m")
    Scale(factor=1000.0, unit='mm')
    """
    known = [score for score in scores if score is not None and 0.0 < score < math.inf]
    return scale_of([median_high(known)] if known else [], unit)


def score_text(scale: Scale, score: float | None, error: float | None = None) -> EstimateText:
    """Return a score and its standard error, without the unit; nothing for what is not known.

    Examples
    --------
    >>> score_text(Scale(1e3, "mN"), 0.0195, 0.00073), score_text(Scale(1.0, "N"), math.inf)[0]
    (EstimateText(value='19.5', doubt='± 0.7'), 'no score')
    """
    if score is None or not math.isfinite(score):
        return EstimateText("no score", "")
    if error is None or not math.isfinite(error):
        return EstimateText(scale.number(score), "")
    return scale.estimate_text(score, error)


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """One law: as given, as fitted, and what it does with each."""

    name: str
    """Registry name."""
    law: FrictionLaw
    """The law as given."""
    given: Criteria
    """What the mechanism does with it; in the first trial where there are several."""
    fit: TravelFit | None
    """The fit; None if no value explains the measurement."""
    run: Trajectory | None
    """The fitted run; of the first trial where there are several."""
    criteria: Criteria | None
    """What the fitted run does; of the first trial too."""
    dropped: str
    """Why the law is out, empty if it is in."""
    score: float | None
    """Held-out error [m], root mean square over trials; None where no trial is left to judge."""
    score_error: float | None
    """Its standard error [m]."""
    held_out: tuple[float, ...] = ()
    """Held-out error of each trial [m]."""
    ordinary: bool = False
    """Whether the values of the law are ordinary start values that nobody gave."""
    influence: Mapping[str, float] = field(default_factory=dict)
    """How far each parameter taken as given moves the travel [m] when changed by half."""
    assumed: tuple[str, ...] = ()
    """Names of the parameters that were neither measured nor fitted."""
    invented: tuple[str, ...] = ()
    """Names of the parameters that the law cannot do without and that were neither measured, given
    nor fitted."""
    passed_over: str = ""
    """Why the law is not taken whatever its score; empty if it may be."""
    distinguished: bool = True
    """Whether the readings tell the law from the best one beyond their uncertainty."""

    @property
    def title(self) -> str:
        """Name of the law in running text."""
        return self.law.title

    @property
    def unscored(self) -> str:
        """Why there is no held-out error, in words; empty if there is one."""
        if self.score is not None:
            return ""
        if self.dropped:
            return self.dropped
        if self.invented:
            names = " and ".join(f"${fields_of(type(self.law))[n].symbol}$" for n in self.invented)
            verb = "was" if len(self.invented) == 1 else "were"
            return f"not judged: {names} {verb} assumed, not fitted"
        return "no held-out trials: all trials repeat one setting"

    @property
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
    def __repr__(self) -> str:
        return f"<Candidate {self}>"

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(str(self))}</p>"

    def to_row(self) -> Mapping[str, Any]:
        """Return the candidate as a row of `Verdict.to_dataframe`."""
        found = self.fit.estimates if self.fit else ()
        return {
            "law": self.name,
            "parameters": ", ".join(f"{e.quantity.symbol} = {number(e.value)}" for e in found),
            "range": ", ".join(estimate.range for estimate in found),
            "travel": self.criteria.travel if self.criteria else None,
            "score": self.score,
        }

    def to_dict(self) -> Mapping[str, Any]:
        """Return the candidate as plain numbers and strings."""
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
            "distinguished": self.distinguished,
            "influence_on_travel": dict(self.influence),
            "fit": self.fit.to_dict() if self.fit else None,
            "criteria_as_given": asdict(self.given),
            "criteria_fitted": asdict(self.criteria) if self.criteria else None,
        }


@dataclass(frozen=True, kw_only=True)
class Wording:
    """The verdict in words."""

    verdict: str
    """One sentence that says what to do."""
    lede: str
    """Two or three sentences why."""
    settles: tuple[str, ...]
    """What the measurement settles."""
    cannot_tell: tuple[str, ...]
    """What it cannot tell; never empty."""
    measure_next: tuple[str, ...]
    """What to measure next, with values."""
    no_score: str
    """Why there is no ranking; empty if there is one."""


@dataclass(frozen=True, kw_only=True)
class Verdict(OnAxes, ABC):
    """Which law to use, how the others compare, and what the data cannot tell."""

    mechanism: Mechanism
    """What was measured, as it was passed in; trials may have set it differently."""
    measurement: Measurement
    """The measurement."""
    words: Wording
    """The verdict in words."""

    @property
    @final
    def sentence(self) -> str:
        """What to do, in one or two plain sentences."""
        return plain(self.words.verdict)

    @abstractmethod
    def to_dataframe(self) -> "pd.DataFrame":
        """Return the candidates as a pandas DataFrame, a row each."""

    @abstractmethod
    def to_dict(self) -> Mapping[str, Any]:
        """Return the verdict as plain numbers and strings, ready for JSON."""

    @property
    @abstractmethod
    def score_unit(self) -> str:
        """SI unit of the scores; ``"1"`` for relative ones."""

    @final
    @override
    def _summary(self) -> Summary:
        return summary_of_table(self.sentence, self.to_dataframe())

    @final
    def _head(self) -> dict[str, Any]:
        """Return what all verdicts say, as plain texts."""
        return {
            "verdict": self.sentence,
            "why": plain(self.words.lede),
            "no_score": self.words.no_score,
            "settles": [plain(line) for line in self.words.settles],
            "cannot_tell": [plain(line) for line in self.words.cannot_tell],
            "measure_next": [plain(line) for line in self.words.measure_next],
            "mechanism": {
                "type": self.mechanism.name,
                **{path: value for path, _, value in parameters(self.mechanism, "mechanism")},
            },
        }


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class TravelVerdict(Verdict):
    """A verdict on travels."""

    candidates: tuple[Candidate, ...]
    """All laws tried, best first where there is a ranking."""
    best: Candidate | None
    """The law to use; None if none explains the measurement."""
    ranked: bool
    """Whether scores decided."""
    separations: tuple[Separation, ...]
    """Predictions for measurements not yet made, in the order of the setting."""
    proposal: Proposal | None
    """The settings to measure next; None where there is no law to name or no other to tell from."""
    t_end: float
    """Time after which a body counts as stopped [s]."""

    @property
    def explained(self) -> tuple[Candidate, ...]:
        """The candidates that reproduce the measurement."""
        return tuple(candidate for candidate in self.candidates if not candidate.dropped)

    @property
    def closest(self) -> Candidate | None:
        """The best law, or the one that would be taken if the readings did not contradict it."""
        return self.best or next((c for c in self.explained if c.fit is not None), None)

    @property
    @override
    def score_unit(self) -> str:
        return "m"

    @override
    def __repr__(self) -> str:
        count, trials = len(self.candidates), len(self.measurement.records())
        judged = "ranked by held-out error" if self.ranked else "not ranked"
        return (
            f"<Verdict: {self.sentence}\n"
            f" {len(self.explained)} of {count} laws explain {trials}"
            f" trial{'s' if trials > 1 else ''}; {judged}>"
        )

    @override
    def to_dataframe(self) -> "pd.DataFrame":
        """Return the candidates as a pandas DataFrame.

        Its columns are ``law``, ``parameters``, ``range``, ``travel`` [m] of the first trial as
        fitted, and ``score`` [m], which is empty where nothing is ranked.
        """
        import pandas as pd

        frame = pd.DataFrame([candidate.to_row() for candidate in self.candidates])
        return frame.astype({"travel": float, "score": float})

    @override
    def to_dict(self) -> Mapping[str, Any]:
        return {
            **self._head(),
            "best": self.best.name if self.best else None,
            "closest": self.closest.name if self.closest else None,
            "ranked": self.ranked,
            "candidates": [candidate.to_dict() for candidate in self.candidates],
            "proposal": self.proposal.to_dict() if self.proposal else None,
            "next_measurements": [separation.to_dict() for separation in self.separations],
        }


def misfit(candidate: Candidate) -> float:
    """Return the root mean square of the residuals of a fit [m].

    Parameters
    ----------
    candidate : Candidate
        A candidate with a fit.
    """
    residuals = candidate.fit.residuals if candidate.fit else ()
    return math.sqrt(sum(r * r for r in residuals) / max(len(residuals), 1))


def plain(text: str) -> str:
    """Return a text without the marks that reports typeset."""
    return text.replace("$", "")
