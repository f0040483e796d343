"""Records in time, and measured friction."""

import math
from dataclasses import fields, replace
from typing import Any

from stickslip.data import QUANTITIES, Measurement, command_of
from stickslip.errors import InputError
from stickslip.identify import (
    BandVerdict,
    importance,
    ladder_rows,
    select_record,
    select_table,
    verdict_sections,
)
from stickslip.identify.criteria import limits_of
from stickslip.identify.fits import (
    LAW,
    ROUTES,
    Laws,
    Parameters,
    RecordFit,
    RecordSettings,
    Score,
    compared,
    fit_records,
    goes_straight,
    names_of,
    route_of,
)
from stickslip.identify.kinds.kind import Comparison, FitSummary, Kind, Request, restarts_text
from stickslip.quantities import turned
from stickslip.show import formatting
from stickslip.show.formatting import joined, percent
from stickslip.show.report import Origin, SectionMaker

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
    compared: frozenset[str] = frozenset()
    """Names of the settings that laws are compared by."""

    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        return ["laws"]

    def resolved(self, request: Request) -> Request:
        """Return the request with the way to fit the records, and with its settings."""
        return request if request.law is None else replace(request, route=self._route(request))

    def _route(self, request: Request) -> str:
        """Return how records are fitted."""
        measurement, law = request.measurement, request.law
        chosen = Parameters.of(
            request.mechanism,
            None if law is None else self.owner(law),
            request.vary,
            request.fixed,
            measurement=measurement,
        )
        vary = [LAW, *chosen.unknown]
        return route_of(chosen.mechanism, measurement, vary=vary, asked=request.route)

    def why_unused(self, name: str, request: Request) -> str:
        selects, asked = request.law is None, request.route
        verb, other = ("select", "fit") if selects else ("fit", "select")
        unused = (
            f"applies to `{other}` of {self.measured}; it has no effect on `{verb}`: leave it out."
        )
        if name in self.settings & {"hold"} and not _holds(request):
            return (
                "applies to records of a force that drives the motion, and this has none: leave it"
                " out."
            )
        if name == "route" and asked and (asked == self.routes[0]) is not selects:
            return f"{asked!r} {unused}"
        if selects and name == "settings" and self.compared:
            usual, given = RecordSettings(), request.settings or RecordSettings()
            names = (one.name for one in fields(RecordSettings) if one.name not in self.compared)
            changed = [one for one in names if getattr(given, one) != getattr(usual, one)]
            return f"with {changed[0]} {unused}" if changed else ""
        if selects and name in ({"settings", "horizon"} | self.settings) - self.compared:
            return unused
        known = not selects and name in self.uses | self.settings
        return self._why_not_fitted(name, request) if known else ""

    def _why_not_fitted(self, name: str, request: Request) -> str:
        """Return why a setting has no effect on a fit."""
        route = request.route
        if route is None:  # not chosen yet
            return ""
        if name in OF_MEASURED and route != "force-map":
            return (
                "applies to measured friction (route force-map); here the route is"
                f" {route}: leave it out."
            )
        if name in WITHOUT_EFFECT[route]:
            return (
                "applies to simulated segments (route shooting); here the route is"
                f" {route}, which fits friction along the measured motion: leave it out."
            )
        return ""

    def residual_text(self, error: float, request: Request) -> str:
        compared_, measurement = "friction", request.measurement
        if self._route(request) == "shooting":
            compared_ = "position" if "position" in measurement.quantities() else "velocity"
        return error_text(error, quantity=compared_, turning=measurement.turning)

    def fit(self, request: Request) -> RecordFit:
        return fit_records(**request.arguments("law", "route", "settings"))

    def comparison(self, verdict: BandVerdict) -> Comparison:
        closest = verdict.closest
        assert closest.fit is not None
        values = sorted(closest.fit.estimates, key=importance)
        heads, rows = ladder_rows(verdict)
        return Comparison(
            heads=heads,
            rows=rows,
            checks=verdict.checks,
            fitted=(f"{closest.title}, if it holds", values) if values else None,
        )

    def summary(
        self, fit: RecordFit, validate: Measurement | None = None, horizon: float | None = None
    ) -> FitSummary:
        compared_ = fit.problem.quantity

        def text(error: float) -> str:
            return error_text(error, quantity=compared_, turning=fit.measurement.turning)

        second = None if validate is None else fit.score(validate, horizon=horizon)
        lines = [f"Residual of {compared_}: {text(fit.rms)} (route {fit.route})"]
        if second is not None:
            lines.append(f"On the second record: {text(second.rms)}, {_predicted(fit, second)}")
        lines += [f"{left_text(fit)}.", *restarts_lines(fit), *fit.remarks, *fit.assumptions]
        return FitSummary(
            lines=lines,
            findings=[f"Model error: {error}" for error in fit.model_errors],
            limits=limits_of(fit),
            open=("Limitations", fit.sentences),
            second=None if second is None else second.rms,
            trials=compared(fit),
        )

    def sections(
        self, verdict: BandVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        return verdict_sections(verdict, origin, remark)


class RecordKind(BandKind):
    """Simulated segments, measured friction along the motion, or friction by inverse dynamics."""

    routes = (BALANCE, *ROUTES)
    measured = "records of motion or friction"
    content = "records"
    uses = frozenset({"route", "validate", "horizon", "tolerance"})
    settings = frozenset(field.name for field in fields(RecordSettings))
    compared = frozenset({"hold"})

    def select(self, request: Request) -> BandVerdict:
        chosen = Parameters.of(
            request.mechanism, None, request.vary, request.fixed, measurement=request.measurement
        )
        return select_record(
            chosen.mechanism,
            request.measurement,
            laws=request.laws,
            vary=chosen.unknown,
            offset="mechanism.offset" not in chosen.held,
            hold=request.settings.hold if request.settings else None,
            validate=request.validate,
            tolerance=request.tolerance,
            route=BALANCE,
        )


def _holds(request: Request) -> bool:
    """Return whether anything is recorded that may hold between samples.

    Only a fit follows the goals of a loop, which `select` takes as they are.
    """
    records = request.measurement.records()
    if request.law is None:
        return any(not goes_straight(record, "zero") for record in records)
    return any(command_of(record) for record in records)


def error_text(value: float, quantity: str, *, turning: bool = False) -> str:
    """Return a score of one law alone with its unit; angles if what was measured turns.

    Examples
    --------
    >>> error_text(0.00024, "position"), error_text(1.234, "friction")
    ('0.24 mm', '1.23 N')
    """
    return formatting.quantity(value, turned(QUANTITIES[quantity].unit, turning))


def left_text(fit: RecordFit[Any]) -> str:
    """Return what a fit leaves of what a law is to explain, and who compares laws."""
    share = math.sqrt(fit.optimum.best.cost / max(fit.problem.variation, 1e-300))
    return (
        f"The fit leaves {percent(share)} of what varies; `stickslip select` compares laws and"
        " looks for what else acts"
    )


def restarts_lines(fit: RecordFit[Any]) -> list[str]:
    """Return how many starts of a search agree, if there were several."""
    starts = len(fit.restarts.costs)
    if starts == 1:
        return []
    text = restarts_text(fit.restarts.agreeing, starts)
    if fit.first is None:
        return [text]
    return [f"{text}, in short segments; longer segments were fitted from there"]


def _predicted(fit: RecordFit, second: Score) -> str:
    """Return how a second record was predicted: where friction is, bristles run through it."""
    if fit.problem.simulates:
        return f"in segments of {formatting.quantity(second.horizon, 's')}"
    return "along the measured motion"


# Tables of friction over the speed, judged by `stickslip.identify`.

FORCE_MAP = "force-map"
"""Route by which tables are fitted."""


class FrictionTableKind(BandKind):
    """Friction against velocity without time: no bristles, rows in any order."""

    routes = ("table", FORCE_MAP)
    uses = frozenset({"route", "validate", "tolerance"})
    measured = "tables of friction"
    content = "tables"
    settings = frozenset(field.name for field in fields(RecordSettings)) - WITHOUT_EFFECT[FORCE_MAP]

    def why_unused(self, name: str, request: Request) -> str:
        if name == "route" and request.route and not self.serves(request.measurement):
            own = f"{request.route!r} applies to {self.measured}"
            return f"{own}, not to this measurement: leave it out."
        return super().why_unused(name, request)

    def select(self, request: Request) -> BandVerdict:
        varied = {*names_of(request.vary or ())} - {LAW}
        for name, given in (("vary", varied), ("fixed", request.fixed)):
            if given:
                raise InputError(
                    f"{name} applies to `fit` of {self.measured}; it has no effect on `select`,"
                    f" got {joined(sorted(given))}: leave it out."
                )
        return select_table(
            request.mechanism,
            request.measurement,
            laws=request.laws,
            validate=request.validate,
            tolerance=request.tolerance,
            route=self.routes[0],
        )
