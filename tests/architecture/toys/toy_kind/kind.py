"""Steady speeds: the kind that joins fit, selection and page."""

from dataclasses import replace
from typing import final

import numpy as np
from typing_extensions import override

from stickslip.experiments import Measurement
from stickslip.friction import Viscous
from stickslip.identification import Estimate, Laws
from stickslip.kinds import Kind, Request
from stickslip.quantities import fields_of
from stickslip.selection import Wording

from .fit import ToyFit
from .verdict import COLUMNS, NAME, ToyCandidate, ToyVerdict


@final
class ToyKind(Kind[ToyFit, ToyVerdict]):
    """Force over velocity."""

    routes = (NAME,)
    measured = "steady speeds"
    uses = frozenset({"route"})
    columns = COLUMNS

    @override
    def serves(self, measurement: Measurement) -> bool:
        return measurement.conditions.get("kind") == NAME

    @override
    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        return [Viscous.name]

    @override
    def residual_text(self, error: float, request: Request) -> str:
        return f"{error} m/s"

    @override
    def fit(self, request: Request) -> ToyFit:
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
    def select(self, request: Request) -> ToyVerdict:
        fitted = self.fit(replace(request, law=Viscous))
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
