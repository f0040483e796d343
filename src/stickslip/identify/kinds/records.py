"""Records in time, and measured friction."""

import math
from contextlib import suppress
from dataclasses import fields, replace
from functools import partial
from typing import Any, cast

from stickslip.data import QUANTITIES, Measurement, command_of, refuse_unused
from stickslip.errors import ConvergenceError, InputError
from stickslip.friction import LuGre
from stickslip.identify import (
    BandVerdict,
    Fit,
    LawFit,
    NotToldError,
    fitted_law,
    importance,
    ladder_rows,
    select_record,
    select_table,
    verdict_sections,
)
from stickslip.identify.candidates import in_sentence
from stickslip.identify.criteria import limits_of
from stickslip.identify.fits import (
    AGREE,
    LAW,
    Laws,
    Parameters,
    RecordFit,
    RecordSettings,
    check_inputs,
    drives_itself,
    fit_records,
    goes_straight,
    inside,
    load_of,
    names_of,
    refuse_overrides,
    route_of,
)
from stickslip.identify.kinds.kind import Comparison, FitSummary, Kind, Request
from stickslip.identify.kinds.trials import compared
from stickslip.identify.problems.record_checks import refuse_wrong_signs
from stickslip.identify.problems.record_signals import Record, records_of
from stickslip.identify.problems.records import RecordProblem
from stickslip.mechanisms import motor_of
from stickslip.quantities import turned
from stickslip.show import formatting
from stickslip.show.formatting import joined, percent
from stickslip.show.report import Origin, SectionMaker

BALANCE, TABLE, SHOOTING = "balance", "table", "shooting"
"""Routes: by the posterior of a force balance, or of a table, and by simulated segments."""
OF_BALANCE = frozenset({"hold"})
"""Settings of a balance."""


class BandKind(Kind[Fit[Any], BandVerdict]):
    """Laws are compared, and one is fitted, by the posterior of `stickslip.identify`."""

    uses = frozenset({"route", "validate", "tolerance"})
    known: frozenset[str] = frozenset()
    """Names of the settings that the posterior takes."""

    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        return ["laws"]

    def fit(self, request: Request) -> Fit[Any]:
        return self._fit(request)

    def _fit(self, request: Request) -> LawFit:
        """Return the fit of one law by the posterior."""
        law: Any = self.owner(request.law)
        chosen = request.parameters(law)
        check_inputs(chosen.law, chosen.mechanism, request.measurement)
        refuse_unused(request.measurement, inside(chosen.mechanism, request.measurement))
        return fitted_law(
            partial(self._select, request, chosen),
            chosen.law,
            free=chosen.free,
            known=chosen.known,
            load=load_of(chosen.mechanism),
            unknown=chosen.unknown,
        )

    def _select(self, request: Request, chosen: Parameters[Any], laws: Any) -> BandVerdict:
        """Return the verdict on some laws, for what is known and looked for of a mechanism."""
        raise NotImplementedError

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
        self, fit: Fit[Any], validate: Measurement | None = None, horizon: float | None = None
    ) -> FitSummary:
        assert isinstance(fit, LawFit)
        assert fit.verdict is not None
        words, second = fit.verdict.words, None
        lines = [words.verdict, words.lede, *words.settles[:1]]
        if validate is not None:
            other = fit.predict(validate)
            lines.append(f"On the second record {in_sentence(str(other))}.")
            second = other.error
        return FitSummary(
            lines=[*lines, *fit.remarks],
            open=("Limitations", fit.sentences),
            second=second,
            trials=compared(fit, lambda **given: self._fit(Request(**given))),
        )

    def sections(
        self, verdict: BandVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        return verdict_sections(verdict, origin, remark)


class RecordKind(BandKind):
    """Records in time: by the force balance along the motion, or by simulated segments."""

    routes = (BALANCE, SHOOTING)
    measured = "records of motion or friction"
    content = "records"
    uses = frozenset({"route", "validate", "horizon", "tolerance"})
    settings = frozenset(field.name for field in fields(RecordSettings))
    known = OF_BALANCE

    def _route(self, request: Request) -> str:
        """Return how records are fitted."""
        law: Any = None if request.law is None else self.owner(request.law)
        return route_of(request.mechanism, request.measurement, law, asked=request.route)

    def why_unused(self, name: str, request: Request) -> str:
        route = None if request.law is None else self._route(request)
        if name in OF_BALANCE and not _holds(request, balanced=route == BALANCE):
            return (
                "applies to records of a force that drives the motion, and this has none: leave it"
                " out."
            )
        if request.law is None:
            unused = (
                f"applies to `fit` of {self.measured}; it has no effect on `select`: leave it out."
            )
            if name == "route" and request.route == SHOOTING:
                return f"{SHOOTING!r} {unused}"
            if name == "settings":
                usual, given = RecordSettings(), request.settings or RecordSettings()
                names = (x.name for x in fields(RecordSettings) if x.name not in self.known)
                changed = [x for x in names if getattr(given, x) != getattr(usual, x)]
                return f"with {changed[0]} {unused}" if changed else ""
            if name in (self.settings | {"horizon"}) - self.known:
                return unused
            return ""
        if route == BALANCE and name in (self.settings | {"horizon"}) - self.known:
            shooting = _voltage_hides(request, self.owner(request.law))
            return (
                "applies to simulated segments (route shooting); here the route is balance: leave"
                f" it out{', or give route shooting' * shooting}."
            )
        if name == "tolerance" and route == SHOOTING:
            return "applies to the route balance; here the route is shooting: leave it out."
        return ""

    def residual_text(self, error: float, request: Request) -> str:
        measurement = request.measurement
        quantity = "position" if "position" in measurement.quantities() else "velocity"
        return error_text(error, quantity=quantity, turning=measurement.turning)

    def fit(self, request: Request) -> Fit[Any]:
        if self._route(request) != SHOOTING:
            try:
                return self._fit(request)
            except NotToldError:  # which runs under what was recorded may tell
                if request.route is not None or "friction" in request.measurement.quantities():
                    raise
        self._refuse_signs(request)
        begin, late = self._begun(request)
        given = request.arguments("law", "progress", "settings")
        if _voltage_hides(request, self.owner(request.law)):
            # constants of a motor trade with friction of its gear: another end may fit as well
            settings = request.settings or RecordSettings()
            given["settings"] = replace(settings, starts=max(settings.starts, 2))
        return fit_records(begin=begin, late=late, **given)

    def _refuse_signs(self, request: Request) -> None:
        """Refuse records whose force has another sign, as `select` does."""
        if drives_itself(request.mechanism, request.measurement):
            return
        records, law = list[Record](), cast("Any", self.owner(request.law))
        with suppress(InputError):  # what no balance takes, runs may
            chosen = request.parameters(law)
            records = records_of(chosen.mechanism, request.measurement, unknown=chosen.unknown)
        if records:
            refuse_wrong_signs(records)

    def _begun(self, request: Request) -> tuple[dict[str, float], tuple[float, float] | None]:
        """Return values that a balance has of what simulated segments look for, by path.

        Those of a law with other states are of LuGre friction, whose parameters they share. And by
        how many samples the force acts late, with the half width of its interval.
        """
        if motor_of(request.mechanism) is not None:  # no balance tells what a voltage hides
            return {}, None
        plain = replace(request, settings=None, tolerance=None)
        if request.vary is not None:  # all of the law, and what is of the mechanism
            of_rig = (x for x in names_of(request.vary) if x.startswith("mechanism."))
            plain = replace(plain, vary=[LAW, *of_rig])
        for law in (request.law, LuGre):
            with suppress(InputError, ConvergenceError):
                fit = self._fit(replace(plain, law=law))
                values = {
                    estimate.path: estimate.value for estimate in fit.estimates if estimate.bounded
                }
                judgement = fit.judgement
                if isinstance(judgement.problem, RecordProblem):
                    return values, judgement.problem.lateness(judgement.draws)
                return values, None
        return {}, None

    def select(self, request: Request) -> BandVerdict:
        return self._select(request, request.parameters(None), request.laws)

    def _select(self, request: Request, chosen: Parameters[Any], laws: Any) -> BandVerdict:
        refuse_overrides(request.measurement, chosen.unknown)
        return select_record(
            chosen.mechanism,
            request.measurement,
            laws=laws,
            vary=chosen.unknown,
            offset="mechanism.offset" not in chosen.held,
            hold=request.settings.hold if request.settings else None,
            validate=request.validate,
            tolerance=request.tolerance,
        )

    def summary(
        self, fit: Fit[Any], validate: Measurement | None = None, horizon: float | None = None
    ) -> FitSummary:
        if not isinstance(fit, RecordFit):
            return super().summary(fit, validate, horizon)
        compared_ = fit.problem.quantity

        def text(error: float) -> str:
            return error_text(error, quantity=compared_, turning=fit.measurement.turning)

        second = None if validate is None else fit.score(validate, horizon=horizon)
        lines = [f"Residual of {compared_}: {text(fit.rms)} (route {fit.route})"]
        if second is not None:
            in_segments = f"in segments of {formatting.quantity(second.horizon, 's')}"
            lines.append(f"On the second record: {text(second.rms)}, {in_segments}")
        left = math.sqrt(fit.optimum.best.cost / max(fit.problem.variation, 1e-300))
        lines += [
            f"The fit leaves {percent(left)} of what varies; `stickslip select` compares laws and"
            " looks for what else acts.",
            *restarts_lines(fit), *fit.remarks, *fit.assumptions,
        ]  # fmt: skip
        return FitSummary(
            lines=lines,
            findings=[f"Model error: {error}" for error in fit.model_errors],
            limits=limits_of(fit),
            open=("Limitations", fit.sentences),
            second=None if second is None else second.rms,
        )


def _voltage_hides(request: Request, law: Any) -> bool:
    """Return whether constants of a motor are looked for that a voltage alone drives.

    Runs then know friction of the gear several times better than a balance does.
    """
    if motor_of(request.mechanism) is None:
        return False
    unknown = request.parameters(law).unknown
    looked = any(path.startswith("mechanism.drive.") for path in unknown)
    return looked and all(command_of(x) == "voltage" for x in request.measurement.records())


def _holds(request: Request, *, balanced: bool) -> bool:
    """Return whether anything is recorded that may hold between samples.

    Only a fit by segments follows the goals of a loop, which a balance takes as they are.
    """
    records = request.measurement.records()
    if request.law is None or balanced:
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


def restarts_lines(fit: RecordFit[Any]) -> list[str]:
    """Return how many starts of a search agree, if there were several."""
    starts = len(fit.restarts.costs)
    if starts == 1:
        return []
    longer = ", in short segments; longer segments were fitted from there"
    return [
        f"Restarts: {fit.restarts.agreeing} of {starts} starts reached the smallest residual within"
        f" {percent(AGREE)}{longer * (fit.first is not None)}"
    ]


# Tables of friction over the speed.


class FrictionTableKind(BandKind):
    """Friction against velocity without time: no bristles, rows in any order."""

    routes = (TABLE,)
    measured = "tables of friction"
    content = "tables"

    def why_unused(self, name: str, request: Request) -> str:
        if name == "route" and request.route and not self.serves(request.measurement):
            own = f"{request.route!r} applies to {self.measured}"
            return f"{own}, not to this measurement: leave it out."
        return ""

    def select(self, request: Request) -> BandVerdict:
        varied = {*names_of(request.vary or ())} - {LAW}
        for name, given in (("vary", varied), ("fixed", request.fixed)):
            if given:
                raise InputError(
                    f"{name} applies to `fit` of {self.measured}; it has no effect on `select`,"
                    f" got {joined(sorted(given))}: leave it out."
                )
        chosen = Parameters.of(request.mechanism, None, measurement=request.measurement)
        return self._select(request, chosen, request.laws)

    def _select(self, request: Request, chosen: Parameters[Any], laws: Any) -> BandVerdict:
        if chosen.unknown:
            raise InputError(
                f"vary: a table of friction tells nothing of {chosen.unknown[0]}: leave it out."
            )
        return select_table(
            chosen.mechanism,
            request.measurement,
            laws=laws,
            validate=request.validate,
            tolerance=request.tolerance,
        )
