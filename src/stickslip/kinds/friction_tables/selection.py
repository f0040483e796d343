"""Selection on friction tables: every law fitted, judged on speeds it has not seen, one named."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Final, final

from stickslip.errors import ConvergenceError, InputError
from stickslip.experiments import Measurement, with_doubts, without_row
from stickslip.identification import ModelError, Parameters, RecordSettings, RouteChoice
from stickslip.kinds.friction_tables.curve import with_curve
from stickslip.kinds.friction_tables.single_rows import WithoutRow, if_wrong, suspects
from stickslip.kinds.kind import Request
from stickslip.kinds.records.admissibility import (
    standard_uncertainty,
)
from stickslip.kinds.records.ladder import (
    climbed,
)
from stickslip.kinds.records.selection import (
    aim_of,
    candidate_of,
    judged_of,
    laws_for,
    until_stopped,
    verdict_on,
    with_contained,
    without_stated,
)
from stickslip.kinds.records.verdict import (
    RecordCandidate,
    RecordVerdict,
)
from stickslip.selection import (
    checked,
)

ROUTE: Final = "force-map"
"""Route of fits to friction that was measured."""


def select_table(request: Request) -> RecordVerdict:
    """Select a law for friction at steady speeds."""
    measurement = request.measurement
    given = RouteChoice(route=ROUTE, settings=request.settings or RecordSettings())
    asked = _Selection(
        request=replace(request, progress=request.progress and until_stopped(request.progress)),
        parameters=Parameters.of(
            request.mechanism, None, request.vary, request.fixed, measurement=measurement
        ),
        horizon=aim_of(request.purpose or "simulate", request.horizon),
        route=request.route if isinstance(request.route, RouteChoice) else given,
    )
    verdict_of = asked.judged(measurement)
    verdict = verdict_of()
    otherwise: dict[str, str] = {}
    stated = standard_uncertainty(measurement, "friction")
    for row in suspects(verdict.closest, stated):
        rest = without_row(measurement, row)
        with suppress(ConvergenceError, InputError):  # too few rows are left
            again = asked.judged(rest)
            closest = again().closest
            seen = WithoutRow.of(row, verdict.closest, closest, measurement)
            if seen.wrong:
                return again(error=seen.finding(measurement))
            if seen.otherwise and closest.name not in verdict.equals:
                otherwise[closest.name] = if_wrong(row, closest.title)
    return verdict_of(otherwise=otherwise) if otherwise else verdict


@final
@dataclass(frozen=True, kw_only=True)
class _Selection:
    """What `select` was asked, and what follows from it for every table."""

    request: Request
    parameters: Parameters[None]
    horizon: float
    route: RouteChoice

    def judged(self, measurement: Measurement) -> Callable[..., RecordVerdict]:
        """Fit the laws to a table and judge them; return what puts that into a verdict."""
        mechanism, asked = self.parameters.mechanism, self.request
        checks = checked(mechanism, measurement, asked.validate)
        fitted = partial(
            candidate_of,
            parameters=self.parameters,
            measurement=without_stated(measurement, ROUTE),
            route=self.route,
            starts={},
        )
        stated = standard_uncertainty(measurement, "friction")
        found = climbed(
            laws_for(asked.laws, measurement),
            fitted,
            asked.progress,
            asked.executor,
            seen=with_contained,
            at_noise=lambda one: one.residual <= stated,
            usual=asked.laws is None,
        )
        with with_doubts(measurement, mechanism, of=ConvergenceError):
            plan, judged, _ = judged_of(
                fitted,
                found,
                self.horizon,
                validate=asked.validate,
                progress=asked.progress,
                executor=asked.executor,
            )

        def told(c: RecordCandidate, error: ModelError | None) -> RecordCandidate:
            errors = () if error is None else (error,)
            return c if c.fit is None else replace(c, fit=replace(c.fit, known_errors=errors))

        def verdict_of(
            error: ModelError | None = None, otherwise: Mapping[str, str] | None = None
        ) -> RecordVerdict:
            def beside(closest: RecordCandidate, exact: float) -> RecordCandidate:
                found = with_curve(closest, uncertainty=exact)
                return replace(found, otherwise=otherwise or {})

            verdict = verdict_on(
                mechanism,
                measurement,
                [told(c, error) for c in judged],
                None,
                plan,
                asked.purpose or "simulate",
                checks,
                asked.validate,
                beside=beside,
            )
            return replace(
                verdict,
                settings=self.route.settings,
                usual=asked.laws is None,
                untried=found.untried,
                why_untried=found.why,
            )

        return verdict_of
