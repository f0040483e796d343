"""Records in time, and measured friction."""

import math
from dataclasses import fields, replace
from typing import Any

from typing_extensions import override

from stickslip.experiments import Measurement, faults
from stickslip.formatting import NO_VALUE, quantity
from stickslip.identification import (
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
from stickslip.kinds.kind import Comparison, FitSummary, Kind, Request
from stickslip.kinds.records.selection import select_records, way_for
from stickslip.kinds.records.verdict import RecordCandidate, RecordVerdict
from stickslip.kinds.records.wording import error_text, restarts_text, route_text
from stickslip.report import Origin, SectionMaker
from stickslip.selection import CrossValidatedVerdict, limits_of, score_text, specifications

WITHOUT_EFFECT = {
    "shooting": frozenset[str](),
    "inverse-dynamics": frozenset({"segment", "resolution"}),
    "force-map": frozenset({"segment", "resolution", "hold"}),
}
"""Settings that a way to fit records has no use for."""
OF_MEASURED = frozenset({"friction_delay", "friction_lag"})
"""Settings that are of measured friction alone."""


class RecordKind(Kind[RecordFit, RecordVerdict]):
    """Simulated segments, measured friction along the motion, or friction by inverse dynamics."""

    routes = ROUTES
    measured = "records of motion or friction"
    climbs = True
    uses = frozenset({"route", "purpose", "horizon", "validate", "executor"})
    settings = frozenset(field.name for field in fields(RecordSettings))

    @override
    def serves(self, measurement: Measurement) -> bool:
        return not measurement.travelled

    @override
    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        return [one.name for one in specifications(laws)]

    @override
    def resolved(self, request: Request) -> Request:
        """Return the request with the way to fit the records, and with its settings."""
        settings = request.settings or RecordSettings()
        if isinstance(request.route, RouteChoice):
            return request
        measurement = request.measurement
        asked = request.route or way_for(request.purpose, measurement)
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
    def select(self, request: Request) -> RecordVerdict:
        return select_records(
            purpose=request.purpose or "simulate",
            **request.arguments("laws", "horizon", "route", "validate", "settings", "executor"),
        )

    @override
    def comparison(self, verdict: RecordVerdict) -> Comparison:
        second = any(candidate.second for candidate in verdict.candidates)
        unit = verdict.scale.unit
        heads = ["law", "free", f"held-out error, {unit}", f"last third, {unit}"]
        heads += [f"second record, {unit}"] if second else []
        notes = [f"{one.title}: {one.outcome}" for one in verdict.candidates]
        closest = verdict.closest
        title = title_of(verdict)
        return Comparison(
            heads=heads,
            rows=[_row(c, verdict, second=second) for c in verdict.candidates],
            notes=[*notes, *verdict.missing, *(closest.fit.remarks if closest.fit else ())],
            checks=verdict.checks,
            fitted=(title, closest.fit.estimates) if closest.fit else None,
            trials=verdict.trials,
        )

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
        self, verdict: RecordVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        from stickslip.kinds.records.page.sections import (
            record_sections,  # figures are loaded where a page is made
        )

        return record_sections(verdict, origin, remark)


def title_of(verdict: CrossValidatedVerdict[Any]) -> str:
    """Return the closest law as the title of its parameters, and whether it is recommended."""
    title: str = verdict.closest.title
    return title if verdict.best else f"{title}, fits best but not recommended"


def _row(candidate: RecordCandidate, verdict: RecordVerdict, *, second: bool) -> list[str]:
    scale = verdict.scale

    def shown(value: float | None) -> str:
        known = value is not None and math.isfinite(value)
        return score_text(scale, value).value if known else NO_VALUE

    seen = candidate.validation
    score = " ".join(score_text(scale, candidate.score, candidate.score_error)).strip()
    cells = [
        candidate.title,
        str(candidate.parameters) if candidate.fit else NO_VALUE,
        score if candidate.fit else NO_VALUE,
        shown(seen.extrapolation if seen else None),
    ]
    return cells + ([shown(candidate.second.rms if candidate.second else None)] if second else [])


def _predicted(fit: RecordFit, second: Score) -> str:
    """Return how a second record was predicted: where friction is, bristles run through it."""
    if fit.problem.simulates:
        return f"in segments of {quantity(second.horizon, 's')}"
    return "along the measured motion"
