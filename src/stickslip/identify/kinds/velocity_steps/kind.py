"""Velocity steps of a load point, fitted by rate-and-state friction."""

from dataclasses import replace

from stickslip.data import Measurement
from stickslip.friction import RateState
from stickslip.identify.candidates import on_second_record
from stickslip.identify.fits import RecordSettings
from stickslip.identify.kinds.kind import Comparison, FitSummary, Kind, Request
from stickslip.identify.kinds.velocity_steps.fit import STARTS, fit_rate_state
from stickslip.identify.kinds.velocity_steps.result import VELOCITY_STEPS, RateStateFit
from stickslip.identify.kinds.velocity_steps.selection import (
    RateStateLaws,
    rate_state_laws,
    select_rate_state,
)
from stickslip.identify.kinds.velocity_steps.verdict import COLUMNS, RateStateVerdict
from stickslip.show.formatting import number
from stickslip.show.report import Origin, SectionMaker


class VelocityStepKind(Kind[RateStateFit, RateStateVerdict]):
    """A slider without inertia behind a spring, fitted to the coefficient of friction."""

    routes = (VELOCITY_STEPS,)
    measured = "velocity steps"
    content = "velocity steps"
    uses = frozenset({"route", "validate"})
    settings = frozenset({"starts", "seed"})
    fits = RateState
    usual_law = "rate-and-state"
    simulated = False
    columns = COLUMNS

    def candidates(self, laws: RateStateLaws | None, measurement: Measurement) -> list[str]:
        return [*rate_state_laws(laws)]

    def residual_text(self, error: float, request: Request) -> str:
        return f"coefficient off by {number(error, 2)}"

    def fit(self, request: Request) -> RateStateFit:
        settings = request.settings or RecordSettings(starts=STARTS)
        return fit_rate_state(
            starts=settings.starts, seed=settings.seed, **request.arguments("law")
        )

    def select(self, request: Request) -> RateStateVerdict:
        return select_rate_state(**request.arguments("laws", "validate", "settings"))

    def comparison(self, verdict: RateStateVerdict) -> Comparison:
        usual, closest = super().comparison(verdict), verdict.closest
        if closest.fit is None:
            return usual
        title = closest.title + ("" if verdict.best else ", closest but not recommended")
        fitted = title, (*closest.fit.estimates, closest.fit.rate)
        return replace(usual, checks=verdict.checks, fitted=fitted)

    def summary(
        self,
        fit: RateStateFit,
        validate: Measurement | None = None,
        horizon: float | None = None,
    ) -> FitSummary:
        second = None if validate is None else fit.judged(validate)
        lines = [f"Residual of the coefficient of friction: {number(fit.rmse, 2)}"]
        if second is not None:
            lines.append(on_second_record(number(second, 2)))
        return FitSummary(
            lines=[*lines, *fit.remarks],
            open=("Remarks", fit.sentences),
            second=second,
        )

    def sections(
        self, verdict: RateStateVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        from stickslip.identify.kinds.velocity_steps.page import (
            sections,  # figures are loaded where a page is made
        )

        return sections(verdict, origin, remark)
