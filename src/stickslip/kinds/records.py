"""Records in time, and measured friction."""

from dataclasses import fields, replace
from typing import final

from typing_extensions import override

from stickslip import formatting
from stickslip.experiments import QUANTITIES, Measurement, faults
from stickslip.formatting import NO_VALUE, percent
from stickslip.identification import (
    AGREE,
    LAW,
    ROUTES,
    Laws,
    Parameters,
    RecordFit,
    RecordSettings,
    RouteChoice,
    Score,
    asked_for,
    choose_route,
    compared,
    fit_records,
    record_route_name,
)
from stickslip.identify import BandVerdict, select_record, verdict_sections
from stickslip.kinds.kind import Comparison, FitSummary, Kind, Request
from stickslip.quantities import turned
from stickslip.report import Origin, SectionMaker
from stickslip.selection import limits_of, score_text

WITHOUT_EFFECT = {
    "shooting": frozenset[str](),
    "inverse-dynamics": frozenset({"segment", "resolution"}),
    "force-map": frozenset({"segment", "resolution", "hold"}),
}
"""Settings that a way to fit records has no use for."""
OF_MEASURED = frozenset({"friction_delay", "friction_lag"})
"""Settings that are of measured friction alone."""


BALANCE = "balance"
"""Route by which laws of records are compared."""


class BandKind(Kind[RecordFit, BandVerdict]):
    """Laws are compared by `stickslip.identify`; fits are those of records.

    The first of its routes is that of `select`, the others are those of `fit`.
    """

    uses = frozenset({"route", "validate"})

    @override
    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        return ["laws"]

    @override
    def resolved(self, request: Request) -> Request:
        """Return the request with the way to fit the records, and with its settings."""
        settings = request.settings or RecordSettings()
        if request.law is None or isinstance(request.route, RouteChoice):
            return request
        measurement, asked = request.measurement, request.route
        # what is faulty is refused where it is fitted
        found = faults(measurement, mechanism=request.mechanism, vary=request.vary or ())
        if asked is not None or found:
            choice = RouteChoice(route=record_route_name(measurement, asked), settings=settings)
            return replace(request, route=choice)
        chosen = Parameters.of(
            request.mechanism, request.law, request.vary, request.fixed, measurement=measurement
        )
        vary = [LAW, *chosen.unknown]
        choice = choose_route(chosen.mechanism, measurement, vary=vary, settings=settings)
        return replace(request, route=choice)

    @override
    def why_unused(self, name: str, request: Request) -> str:
        selects, asked = request.law is None, asked_for(request.route)
        verb, other = ("select", "fit") if selects else ("fit", "select")
        unused = (
            f"applies to `{other}` of {self.measured}; it has no effect on `{verb}`: leave it out."
        )
        if name == "route" and asked and (asked == self.routes[0]) is not selects:
            return f"{asked!r} {unused}"
        if selects and name in {"settings", "horizon"} | self.settings:
            return unused
        known = not selects and name in self.uses | self.settings
        return self._why_not_fitted(name, request) if known else ""

    def _why_not_fitted(self, name: str, request: Request) -> str:
        """Return why a setting has no effect on a fit."""
        choice, settings = request.route, request.settings
        if not isinstance(choice, RouteChoice):
            return ""
        if name == "settings" and settings is not None:
            own = choice.settings
            if any(getattr(settings, one) != getattr(own, one) for one in settings.changed):
                return "has no effect beside a `RouteChoice`: give settings to `choose_route`."
        why = f", because {choice.reason}" if choice.reason else ""
        if name in OF_MEASURED and choice.route != "force-map":
            return (
                "applies to measured friction (route force-map); here the route is"
                f" {choice.route}{why}: leave it out."
            )
        if name in WITHOUT_EFFECT[choice.route]:
            return (
                "applies to simulated segments (route shooting); here the route is"
                f" {choice.route}, which fits friction along the measured motion{why}: leave it"
                " out."
            )
        return ""

    @override
    def residual_text(self, error: float, request: Request) -> str:
        compared_, measurement = "friction", request.measurement
        if record_route_name(measurement, asked_for(request.route)) == "shooting":
            compared_ = "position" if "position" in measurement.quantities() else "velocity"
        return error_text(error, quantity=compared_, turning=measurement.turning)

    @override
    def fit(self, request: Request) -> RecordFit:
        return fit_records(**request.arguments("law", "route", "settings"))

    @override
    def comparison(self, verdict: BandVerdict) -> Comparison:
        scale, closest = verdict.scale, verdict.closest
        rows = [
            [
                one.title,
                str(one.count),
                score_text(scale, one.held_out).value,
                percent(one.share) if one.share >= 0.005 else NO_VALUE,
                one.outcome,
            ]
            for one in verdict.candidates
        ]
        assert closest.fit is not None
        return Comparison(
            heads=[
                "law", "parameters", f"held-out error, {scale.unit or verdict.score_unit}",
                "share", "",
            ],
            rows=rows,
            checks=verdict.checks,
            fitted=(closest.title, closest.fit.estimates),
        )  # fmt: skip

    @override
    def summary(
        self, fit: RecordFit, validate: Measurement | None = None, horizon: float | None = None
    ) -> FitSummary:
        compared_ = fit.problem.quantity

        def text(error: float) -> str:
            return error_text(error, quantity=compared_, turning=fit.measurement.turning)

        second = None if validate is None else fit.score(validate, horizon=horizon)
        lines = [f"Residual of {compared_}: {text(fit.rms)}"]
        if second is not None:
            lines.append(f"On the second record: {text(second.rms)}, {_predicted(fit, second)}")
        lines.append(f"Restarts: {restarts_text(fit)}")
        lines += [line for line in (*fit.remarks, *fit.assumptions, route_text(fit)) if line]
        return FitSummary(
            lines=lines,
            findings=[f"Model error: {error}" for error in fit.model_errors],
            limits=limits_of(fit),
            open=("Limitations", fit.sentences),
            second=None if second is None else second.rms,
            trials=compared(fit),
        )

    @override
    def sections(
        self, verdict: BandVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        return verdict_sections(verdict, origin, remark)


@final
class RecordKind(BandKind):
    """Simulated segments, measured friction along the motion, or friction by inverse dynamics."""

    routes = (BALANCE, *ROUTES)
    measured = "records of motion or friction"
    uses = frozenset({"route", "validate", "horizon"})
    settings = frozenset(field.name for field in fields(RecordSettings))

    @override
    def serves(self, measurement: Measurement) -> bool:
        return not measurement.travelled

    @override
    def select(self, request: Request) -> BandVerdict:
        chosen = Parameters.of(
            request.mechanism, None, request.vary, request.fixed, measurement=request.measurement
        )
        return select_record(
            chosen.mechanism,
            request.measurement,
            laws=request.laws,
            vary=chosen.unknown,
            held="mechanism.offset" in chosen.held,
            validate=request.validate,
            route=BALANCE,
        )


def error_text(value: float, quantity: str, *, turning: bool = False) -> str:
    """Return a score of one law alone with its unit; angles if what was measured turns.

    Examples
    --------
    >>> error_text(0.00024, "position"), error_text(1.234, "friction")
    ('0.24 mm', '1.23 N')
    """
    return formatting.quantity(value, turned(QUANTITIES[quantity].unit, turning))


def route_text(fit: RecordFit) -> str:
    """Return how a record was fitted where that is unusual, and why; empty where it is not."""
    way = "shorter simulated segments" if fit.problem.simulates else "inverse dynamics"
    return f"Fitted by {way}, because {fit.route_reason}." if fit.route_reason else ""


def restarts_text(fit: RecordFit) -> str:
    """Return how many starts of the search agree; of a free decay, in which segments."""
    starts = len(fit.restarts.costs)
    if starts == 1:
        return "none, a single start"
    text = (
        f"{fit.restarts.agreeing} of {starts} starts reached the smallest residual within"
        f" {percent(AGREE)}"
    )
    if fit.first is None:
        return text
    return f"{text}, in short segments; longer segments were fitted from there"


def _predicted(fit: RecordFit, second: Score) -> str:
    """Return how a second record was predicted: where friction is, bristles run through it."""
    if fit.problem.simulates:
        return f"in segments of {formatting.quantity(second.horizon, 's')}"
    return "along the measured motion"
