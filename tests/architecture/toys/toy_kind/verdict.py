"""What a selection on slides gives."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, final

from typing_extensions import override

from stickslip.identify.candidates import CrossValidated, CrossValidatedVerdict, score_text
from stickslip.identify.kinds import Column, data_row
from stickslip.show.formatting import Scale

from .fit import SlideFit

ROUTE = "slides"
MILLIMETRES = Scale(1e3, "mm")


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SlideCandidate(CrossValidated[SlideFit]):
    """A law on slides, judged at settings that its fit has not seen."""

    @property
    @override
    def is_simpler(self) -> Collection[str]:
        return ()  # a law with a part that came out as 0 is not looked at here

    @override
    def to_row(self) -> Mapping[str, Any]:
        return data_row(COLUMNS, self)


COLUMNS = (
    Column[SlideCandidate](
        key="law",
        title="law",
        page="model",
        numeric=False,
        value=lambda one: one.name,
        text=lambda one: one.title,
    ),
    Column[SlideCandidate](
        key="parameters",
        title="free",
        value=lambda one: one.parameters,
        text=lambda candidate: str(candidate.parameters) if candidate.fit else None,
    ),
    Column[SlideCandidate](
        key="score",
        title="held-out error",
        page="held-out error",
        unit="mm",
        value=lambda candidate: candidate.score,
        text=lambda candidate: (
            score_text(MILLIMETRES, candidate.score, candidate.score_error)
            if candidate.fit
            else None
        ),
        plotted=True,
    ),
    Column[SlideCandidate](
        key="outcome",
        page="outcome",
        numeric=False,
        value=lambda candidate: candidate.outcome,
        text=lambda candidate: candidate.outcome,
    ),
)


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class SlideVerdict(CrossValidatedVerdict[SlideCandidate]):
    """A verdict on slides."""

    route = ROUTE
    score_unit = "m"

    @override
    def _details(self) -> Mapping[str, Any]:
        return {"checks": self.checks.to_dict()}
