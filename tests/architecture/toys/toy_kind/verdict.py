"""What a selection on a steady speed gives."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

from typing_extensions import override

from stickslip.kinds import Column, data_row
from stickslip.selection import Candidate, Verdict

from .fit import ToyFit

NAME = "toy"


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class ToyCandidate(Candidate[ToyFit]):
    """The only law that a steady speed can tell."""

    @property
    @override
    def score(self) -> float:
        return 0.01

    @override
    def to_row(self) -> Mapping[str, Any]:
        return data_row(COLUMNS, self)


COLUMNS = (
    Column[ToyCandidate](
        key="law",
        title="law",
        page="model",
        value=lambda one: one.name,
        text=lambda one: one.title,
    ),
    Column[ToyCandidate](key="parameters", value=lambda one: one.parameters),
)


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class ToyVerdict(Verdict[ToyCandidate]):
    """A verdict on a steady speed."""

    route = NAME
    score_unit = "m/s"

    @override
    def _details(self) -> Mapping[str, Any]:
        return {"toy": True}
