"""A route as a contributor would write it: the steady speed of a slider under a steady force."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, final

import numpy as np
from typing_extensions import override

from stickslip.experiments import Measurement
from stickslip.experiments.estimates import LawEstimates
from stickslip.friction import Viscous
from stickslip.identification.results import Estimate, Fit, estimates_for
from stickslip.identification.validation import Laws
from stickslip.quantities import fields_of
from stickslip.report.core.blocks import Paragraph
from stickslip.report.core.documents import Origin, Section, SectionMaker
from stickslip.routes.route import (
    Comparison,
    FitRequest,
    FitSummary,
    Options,
    Route,
    SelectRequest,
)
from stickslip.selection.verdict import Candidate, Verdict, Wording

if TYPE_CHECKING:
    from stickslip.display import Drawing, Target

NAME = "toy"


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class ToyFit(Fit[Viscous]):
    """Viscous friction that explains a steady speed."""

    @override
    def law_estimates(self) -> LawEstimates:
        return estimates_for(self.law, self.estimates, [[1.0]], levels="forces", largest_speed=None)

    @override
    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.plots.core.axes import on_axes

        draw = lambda figure, _: figure.add_subplot().set_title("Toy.")  # noqa: E731
        return on_axes(draw, ax, (400, 300))

    @override
    def _notes(self) -> tuple[str, ...]:
        return ()

    @override
    def __str__(self) -> str:
        return f"{self.law.title}: {self.estimates[0]}"

    @override
    def to_dict(self) -> Mapping[str, Any]:
        return {"law": self.law.name, "estimates": [one.to_dict() for one in self.estimates]}


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
        return {"law": self.name, "parameters": self.parameters}

    @override
    def to_dict(self) -> Mapping[str, Any]:
        return {**self.to_row(), "fit": self.fit.to_dict() if self.fit else None}


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class ToyVerdict(Verdict[ToyCandidate]):
    """A verdict on a steady speed."""

    route = NAME
    score_unit = "m/s"

    @override
    def _details(self) -> Mapping[str, Any]:
        return {"toy": True}

    @override
    def _basis(self) -> str:
        return " to one speed"


def toy_section(verdict: ToyVerdict) -> Section:
    """Return what there is to say."""
    return Section(
        id="verdict", nav="Verdict", heading="Toy", blocks=(Paragraph(text=verdict.sentence),)
    )


@final
class ToyRoute(Route[ToyFit, ToyVerdict]):
    """Force over velocity."""

    names = (NAME,)
    measured = "steady speeds"
    uses = frozenset({"route"})

    @override
    def serves(self, measurement: Measurement) -> bool:
        return measurement.conditions.get("kind") == NAME

    @override
    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        return [Viscous.name]

    @override
    def residual_text(self, error: float, measurement: Measurement, options: Options) -> str:
        return f"{error} m/s"

    @override
    def fit(self, request: FitRequest, options: Options) -> ToyFit:
        force, speed = (request.measurement.values(name) for name in ("force", "velocity"))
        slope = float(np.mean(np.asarray(force) / np.asarray(speed)))
        estimate = Estimate(
            path="friction.viscous_coefficient",
            quantity=fields_of(Viscous)["viscous_coefficient"],
            value=slope,
            low=0.9 * slope,
            high=1.1 * slope,
            interval="95 %",
        )
        law = Viscous(viscous_coefficient=slope)
        return ToyFit(law=law, mechanism=request.mechanism, estimates=(estimate,))

    @override
    def select(self, request: SelectRequest, options: Options) -> ToyVerdict:
        fitted = self.fit(
            FitRequest(mechanism=request.mechanism, law=Viscous, measurement=request.measurement),
            options,
        )
        one = ToyCandidate(name=Viscous.name, title=Viscous.title, fit=fitted)
        words = Wording(
            verdict="Use viscous friction.",
            lede="",
            settles=(),
            cannot_tell=("All else.",),
            measure_next=(),
            no_score="",
        )
        return ToyVerdict(
            mechanism=request.mechanism,
            measurement=request.measurement,
            words=words,
            candidates=(one,),
            best=replace(one, outcome="chosen"),
            ranked=False,
        )

    @override
    def comparison(self, verdict: ToyVerdict) -> Comparison:
        return Comparison(heads=["law"], rows=[[one.title] for one in verdict.candidates])

    @override
    def summary(
        self, fit: ToyFit, validate: Measurement | None = None, horizon: float | None = None
    ) -> FitSummary:
        return FitSummary(lines=["Toy."])

    @override
    def sections(
        self, verdict: ToyVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        return (partial(toy_section, verdict),)
