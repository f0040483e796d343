"""What a selection gives back, whatever was measured."""

import html
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from statistics import median_high
from typing import TYPE_CHECKING, Any, Generic, cast, final

from typing_extensions import TypeVar, override

from stickslip.described import Described
from stickslip.display import OnAxes, Summary, plots, summary_of_table
from stickslip.experiments import Measurement
from stickslip.formatting import EstimateText, Scale, count, scale_of, significant
from stickslip.identification import Fit, FittedLaw
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters
from stickslip.tables import Tabular

if TYPE_CHECKING:
    import pandas as pd

    from stickslip.display import Drawing, Target

Fit_co = TypeVar("Fit_co", bound=Fit[Any], default=Fit[Any], covariant=True)


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
        return EstimateText(significant(scale.factor * score), "")
    return scale.estimate_text(score, error)


@dataclass(frozen=True, kw_only=True)
class Candidate(ABC, Generic[Fit_co], metaclass=Described):
    """One law of a selection: its fit, its held-out error, and whether it may be taken."""

    name: str
    """Key of the candidate."""
    title: str
    """Name in running text."""
    fit: Fit_co | None
    """The fit; None if there is none."""
    dropped: str = ""
    """Why it may not be taken, in words; empty if it may."""
    doubt: str = ""
    """What speaks against it although it is taken, since nothing else predicts as well."""
    outcome: str = ""
    """What became of it, for tables."""

    @property
    def parameters(self) -> int:
        """Number of parameters that were fitted."""
        return len(self.fit.estimates) if self.fit else 0

    @property
    def score(self) -> float | None:
        """Held-out error, in the unit of the verdict's scores; None or infinite without one."""
        return None

    @property
    def score_error(self) -> float | None:
        """Its standard error; None, infinite or not a number if there is none."""
        return None

    @property
    def fitted_law(self) -> FittedLaw | None:
        """The fit as searches of richer laws begin from it, if they can."""
        return None

    @abstractmethod
    def to_row(self) -> Mapping[str, Any]:
        """Return the candidate as a row of `Verdict.to_dataframe`."""

    def to_dict(self) -> Mapping[str, Any]:
        """Return the candidate as plain numbers and strings."""
        return {**self.to_row(), "fit": self.fit.to_dict() if self.fit else None}

    @override
    def __str__(self) -> str:
        """Return the law and what became of it."""
        became = f"dropped, {self.dropped}" if self.dropped else self.outcome
        return f"{self.title}: {plain(became)}"

    @final
    @override
    def __repr__(self) -> str:
        return f"<Candidate {self}>"

    @final
    def _repr_html_(self) -> str:
        return f"<p>{html.escape(str(self))}</p>"


Candidate_co = TypeVar("Candidate_co", bound=Candidate, default=Candidate, covariant=True)


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
class Verdict(OnAxes, Tabular, ABC, Generic[Candidate_co]):
    """Which law to use, how the others compare, and what the data cannot tell."""

    mechanism: Mechanism
    """What was measured, as it was passed in; trials may have set it differently."""
    measurement: Measurement
    """The measurement."""
    words: Wording
    """The verdict in words."""
    candidates: tuple[Candidate_co, ...]
    """All laws tried, in the order of their rank where there is one."""
    best: Candidate_co | None
    """The law to use; None if the verdict names none."""
    ranked: bool
    """Whether held-out errors decided."""

    @property
    @final
    def sentence(self) -> str:
        """What to do, in one or two plain sentences."""
        return plain(self.words.verdict)

    @property
    @abstractmethod
    def route(self) -> str:
        """How the measurement was fitted: a name of its route."""

    @property
    @abstractmethod
    def score_unit(self) -> str:
        """SI unit of the scores; ``"1"`` for relative ones, empty for those of a coefficient."""

    @property
    def closest(self) -> Candidate_co | None:
        """The best law, or what comes closest to the measurement where none is named."""
        return self.best

    @property
    @final
    def scored(self) -> tuple[Candidate_co, ...]:
        """The candidates that have a held-out error."""
        return tuple(
            one for one in self.candidates if one.score is not None and math.isfinite(one.score)
        )

    @override
    def _plot(self, ax: "Target") -> "Drawing":
        """Draw the held-out errors; a route replaces it that has another plot."""
        return cast("Drawing", plots().plot_scores(self, ax))

    @final
    @override
    def to_dataframe(self) -> "pd.DataFrame":
        """Return the candidates as a pandas DataFrame, a row each."""
        import pandas as pd

        return pd.DataFrame([candidate.to_row() for candidate in self.candidates])

    @override
    def _over(self) -> str:
        return "law"

    @final
    def to_dict(self) -> Mapping[str, Any]:
        """Return the verdict as plain numbers and strings, ready for JSON."""
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
            "best": self.best.name if self.best else None,
            "closest": self.closest.name if self.closest else None,
            "ranked": self.ranked,
            "route": self.route,
            "candidates": [candidate.to_dict() for candidate in self.candidates],
            **self._details(),
        }

    def _details(self) -> Mapping[str, Any]:
        """Return what only verdicts of this route say, as plain numbers and strings."""
        return {}

    def _basis(self) -> str:
        """Return on what the verdict rests, after the number of candidates that were fitted."""
        return ""

    @final
    @override
    def _summary(self) -> Summary:
        return summary_of_table(self.sentence, self.to_dataframe())

    @final
    @override
    def __repr__(self) -> str:
        fitted = sum(candidate.fit is not None for candidate in self.candidates)
        return (
            f"<Verdict: {self.sentence}\n {fitted} of {count(len(self.candidates), 'candidate')}"
            f" fitted{self._basis()}>"
        )


def plain(text: str) -> str:
    """Return a text without the marks that reports typeset."""
    return text.replace("$", "")
