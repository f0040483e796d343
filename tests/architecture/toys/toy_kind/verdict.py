"""What a selection on slides gives."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

from typing_extensions import override

from stickslip.data import Checks
from stickslip.identify.candidates import Candidate, Verdict, score_text
from stickslip.identify.kinds import Column, data_row
from stickslip.show.formatting import Scale

from .fit import SlideFit

ROUTE = "slides"
MILLIMETRES = Scale(1e3, "mm")


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SlideCandidate(Candidate[SlideFit]):
    """A law on slides, judged by what it leaves and by the number of its parameters."""

    criterion: float = math.inf
    """Akaike's criterion; infinite without a fit."""

    @property
    @override
    def score(self) -> float | None:
        return self.fit.rms if self.fit else None

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
        title="leaves",
        page="leaves",
        unit="mm",
        value=lambda candidate: candidate.score,
        text=lambda candidate: score_text(MILLIMETRES, candidate.score) if candidate.fit else None,
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
class SlideVerdict(Verdict[SlideCandidate]):
    """A verdict on slides."""

    checks: Checks

    route = ROUTE
    score_unit = "m"

    @override
    def _details(self) -> Mapping[str, Any]:
        return {"checks": self.checks.to_dict()}
