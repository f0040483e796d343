"""Candidates and verdicts of all kinds: which laws are compared, and what a selection gives."""

import html
import math
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median_high
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, cast, final

from typing_extensions import TypeVar

from stickslip.data import Checks, Measurement
from stickslip.errors import InputError
from stickslip.friction import CandidateSpec, FrictionLaw, specification, usual_specifications
from stickslip.identify.fits import AnyLaw_co, Estimate, Fit
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters
from stickslip.show.described import Described
from stickslip.show.display import OnAxes, Summary, Tabular, plots, summary_of_table
from stickslip.show.formatting import Scale, count, joined, scale_of, significant

if TYPE_CHECKING:
    import pandas as pd

    from stickslip.show.display import Drawing, Target

Fit_co = TypeVar("Fit_co", bound=Fit[Any], default=Fit[Any], covariant=True)
MOST = 3
"""Laws, terms, readings and places that a sentence names at most."""
NAMES = (
    *("Ambrósio", "BAM", "Bengisu", "Bliman", "Bouc", "Brown", "Coulomb", "Dahl", "GMS", "Haessig"),
    *("Hess", "LuGre", "Makkar", "Maxwell", "Popp", "Simscape", "Stribeck", "Threlfall", "Tustin"),
)
"""How titles begin that are names."""
NOT_RULED_OUT = "not ruled out"
"""Outcome of a candidate with odds of less than 100 to 1 against it."""
ONE_LAW = "No ranking: one law was tried."
"""Where the candidates would be ranked."""
UNMEASURED = "Friction at speeds, loads and temperatures outside those measured is not known."
"""What no verdict can tell."""
Watch: TypeAlias = Callable[[str, float], object]
"""Called with a candidate and the least residual so far; False ends the search."""


def specifications(
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
) -> tuple[CandidateSpec, ...]:
    """Return the candidates: those given, or all that records may be compared with by default.

    A name stands for the candidate of that name, or for a law with all it can fit.

    Examples
    --------
    >>> [one.name for one in specifications(None)][:3]
    ['viscous', 'coulomb', 'coulomb-viscous']
    >>> [one.title for one in specifications(["coulomb", "dahl-exponent"])]
    ['Coulomb', 'Dahl with exponent']
    """
    if laws is None:
        return usual_specifications()
    if isinstance(laws, Mapping):
        result = [CandidateSpec.of(name, law) for name, law in laws.items()]
    else:
        result = [
            specification(law) if isinstance(law, str) else CandidateSpec.of(law.name, law)
            for law in laws
        ]
    check_any(result)
    check_apart([item.name for item in result])
    return tuple(result)


def check_any(laws: Collection[object]) -> None:
    """Refuse to compare no laws at all."""
    if not laws:
        raise InputError("no friction law was given: name at least one in `laws`.")


def check_apart(names: Sequence[str]) -> None:
    """Refuse candidates of one name, of which results would tell only one.

    Examples
    --------
    >>> check_apart(["coulomb", "viscous"])
    """
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise InputError(
            f"two of `laws` are called {twice[0]!r}: give a mapping with a name for each, such as"
            f' {{"{twice[0]}-a": ..., "{twice[0]}-b": ...}}.'
        )


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


def score_text(scale: Scale, score: float | None) -> str:
    """Return a score without the unit.

    Examples
    --------
    >>> score_text(Scale(1e3, "mN"), 0.0195), score_text(Scale(1.0, "N"), math.inf)
    ('19.5', 'no score')
    """
    if score is None or not math.isfinite(score):
        return "no score"
    return significant(scale.factor * score)


@dataclass(frozen=True, kw_only=True)
class Candidate(Generic[Fit_co], metaclass=Described):
    """One law of a selection: its fit, its held-out error, and whether it may be taken."""

    name: str
    """Key of the candidate."""
    title: str
    """Name in running text."""
    fit: Fit_co | None
    """The fit; None if there is none."""
    dropped: str = ""
    """Why it may not be taken, in words; empty if it may."""
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

    def to_row(self) -> Mapping[str, Any]:
        """Return the candidate as a row of `Verdict.to_dataframe`."""
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.parameters,
            "outcome": self.outcome,
        }

    def to_dict(self) -> Mapping[str, Any]:
        """Return the candidate as plain numbers and strings."""
        return {**self.to_row(), "fit": self.fit.to_dict() if self.fit else None}

    def __str__(self) -> str:
        """Return the law and what became of it."""
        became = f"dropped, {self.dropped}" if self.dropped else self.outcome
        return f"{self.title}: {plain(became)}"

    @final
    def __repr__(self) -> str:
        return f"<Candidate {self}>"

    @final
    def _repr_html_(self) -> str:
        return f"<p>{html.escape(str(self))}</p>"


Candidate_co = TypeVar("Candidate_co", bound=Candidate, default=Candidate, covariant=True)


@dataclass(frozen=True, kw_only=True, repr=False)
class JudgedFit(Fit[AnyLaw_co]):
    """A fit by a posterior: the selection in which no other law is compared."""

    measurement: Measurement
    """What was fitted."""
    verdict: "Verdict | None" = None
    """What is said of the fit: the verdict of a selection with this law alone; None in one."""

    @property
    def route(self) -> str:
        """How it was fitted."""
        return "" if self.verdict is None else self.verdict.route

    @property
    def sentences(self) -> tuple[str, ...]:
        return () if self.verdict is None else self.verdict.words.cannot_tell

    def to_dict(self) -> Mapping[str, Any]:
        if self.verdict is None:
            return super().to_dict()
        words = self.verdict.words
        return {
            **super().to_dict(),
            "route": self.verdict.route,
            "verdict": words.verdict,
            "leaves": self.verdict.closest.score,
            "settles": list(words.settles),
            "cannot_tell": list(words.cannot_tell),
            "measure_next": list(words.measure_next),
            "remarks": list(self.remarks),
        }

    def __str__(self) -> str:
        return f"{self.law.title}: {', '.join(map(str, self.estimates))}"


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
    """What was measured, as it was passed in; trials may have set it differently.

    Of a `BandVerdict` with what was found of it, such as a constant offset.
    """
    measurement: Measurement
    """The measurement."""
    words: Wording
    """The verdict in words."""
    candidates: tuple[Candidate_co, ...]
    """All laws tried, in the order of their rank where there is one."""
    best: Candidate_co | None
    """The law to use; None if the verdict names none."""
    ranked: bool
    """Whether no other law may hold instead of the one that is named."""
    checks: Checks
    """What is doubtful about the measurement."""
    intervals: tuple[Estimate, ...] = ()
    """Parameters of the closest law with their intervals over laws that have them."""

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
    def closest(self) -> Candidate_co:
        """The law that is named, or what comes closest to the measurement where none is."""
        return self.candidates[0]

    @property
    def stated(self) -> Sequence[tuple[Estimate, Estimate]]:
        """Parameters of the closest law: if it holds, and over laws that have them."""
        fit = self.closest.fit
        return [] if fit is None else [*zip(fit.estimates, self.intervals, strict=True)]

    @property
    @final
    def scored(self) -> tuple[Candidate_co, ...]:
        """The candidates that have a held-out error."""
        return tuple(
            candidate
            for candidate in self.candidates
            if candidate.score is not None and math.isfinite(candidate.score)
        )

    def _plot(self, ax: "Target") -> "Drawing":
        """Draw the held-out errors; a route replaces it that has another plot."""
        return cast("Drawing", plots().plot_scores(self, ax))

    @final
    def to_dataframe(self) -> "pd.DataFrame":
        """Return the candidates as a pandas DataFrame, a row each."""
        import pandas as pd

        return pd.DataFrame([candidate.to_row() for candidate in self.candidates])

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
            "closest": self.closest.name,
            "ranked": self.ranked,
            "route": self.route,
            "candidates": [candidate.to_dict() for candidate in self.candidates],
            **self._details(),
        }

    def _details(self) -> Mapping[str, Any]:
        """Return what only verdicts of this route say, as plain numbers and strings."""
        return {}

    @final
    def _summary(self) -> Summary:
        return summary_of_table(self.sentence, self.to_dataframe(), self._notes())

    def _notes(self) -> Sequence[str]:
        """Return what a notebook and a terminal say below the candidates."""
        return ()

    @final
    def __repr__(self) -> str:
        fitted = sum(candidate.fit is not None for candidate in self.candidates)
        every = count(len(self.candidates), "candidate")
        return f"<Verdict: {self.sentence}\n {fitted} of {every} fitted>"


def plain(text: str) -> str:
    """Return a text without the marks that reports typeset."""
    return text.replace("$", "")


def corrections(checks: Checks) -> tuple[str, ...]:
    """Return what to correct in a record before anything else is measured, or what to measure.

    Examples
    --------
    >>> from stickslip.data import Finding
    >>> gap = Finding(kind="gap", sentence="Gap of 0.3 s after 12.5 s.", severity="warning")
    >>> corrections(Checks(findings=(gap,)))
    ('First correct the record: Gap of 0.3 s after 12.5 s.',)
    >>> short = Finding(
    ...     kind="length",
    ...     sentence="The record has only 15 samples.",
    ...     severity="warning",
    ...     measure="Record more samples",
    ... )
    >>> corrections(Checks(findings=(short,)))
    ('Record more samples: The record has only 15 samples.',)
    """
    warned = [finding for finding in checks.findings if finding.severity == "warning"]
    warned.sort(key=lambda item: bool(item.measure))  # what can be corrected comes first
    return tuple(
        f"{item.measure or 'First correct the record'}: {item.sentence}" for item in warned[:1]
    )


def in_sentence(title: str) -> str:
    """Return a title as it stands within a sentence; names keep their capital.

    Examples
    --------
    >>> in_sentence("Direction-dependent"), in_sentence("Coulomb + viscous")
    ('direction-dependent', 'Coulomb + viscous')
    """
    return title if title.startswith(NAMES) else title[:1].lower() + title[1:]


def friction_of(title: str) -> str:
    """Return the friction of a law as one says it within a sentence.

    Examples
    --------
    >>> friction_of("Direction-dependent"), friction_of("Dahl with exponent")
    ('direction-dependent friction', 'Dahl friction with exponent')
    >>> friction_of("Stribeck by direction")
    'Stribeck friction by direction'
    >>> friction_of("Coulomb by position + viscous with a drag")
    'Coulomb friction by position + viscous with a drag'
    """
    joints = [item for item in (" by ", " with ") if item in title]
    joint = min(joints, key=title.index, default=" with ")
    kind, joint, more = in_sentence(title).partition(joint)
    noun = "" if kind.endswith("friction") else " friction"
    return f"{kind}{noun}{joint}{more}"


def cannot_rule_out(titles: Sequence[str], source: str) -> str:
    """Return the clause that other laws may hold.

    Examples
    --------
    >>> cannot_rule_out(["Stribeck", "Viscous"], "this record")
    'this record cannot rule out Stribeck and viscous'
    >>> cannot_rule_out(["Dahl", "LuGre", "Stribeck", "Viscous"], "these readings")
    'these readings cannot rule out Dahl, LuGre and 2 more'
    """
    names = [in_sentence(title) for title in titles]
    if len(names) > MOST:
        names = [*names[: MOST - 1], f"{len(names) - MOST + 1} more"]
    return f"{source} cannot rule out {joined(names)}"
