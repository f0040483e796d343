"""Selection on friction tables: every law fitted, judged on speeds it has not seen, one named."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Final, final

from stickslip.errors import ConvergenceError, InputError
from stickslip.experiments import Measurement, with_doubts, without_row
from stickslip.friction import FrictionLaw
from stickslip.identification import ModelError, Parameters, RecordSettings, RouteChoice
from stickslip.kinds.friction_tables.curve import with_curve
from stickslip.kinds.friction_tables.single_rows import WithoutRow, if_wrong, suspects
from stickslip.mechanisms import Mechanism
from stickslip.selection import (
    PurposeName,
    RecordCandidate,
    RecordVerdict,
    Watch,
    aim_of,
    candidate_of,
    checked,
    climbed,
    judged_of,
    laws_for,
    standard_uncertainty,
    until_stopped,
    verdict_on,
    with_contained,
    without_stated,
)

ROUTE: Final = "force-map"
"""Route of fits to friction that was measured."""
Laws = Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None


def select_table(
    mechanism: Mechanism,
    laws: Laws,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    purpose: PurposeName = "simulate",
    horizon: float | None = None,
    route: str | RouteChoice | None = None,
    validate: Measurement | None = None,
    settings: RecordSettings | None = None,
    progress: Watch | None = None,
    executor: Executor | None = None,
) -> RecordVerdict:
    """Select a law for friction at steady speeds; arguments as in `select`."""
    given = RouteChoice(route=ROUTE, settings=settings or RecordSettings())
    asked = _Asked(
        parameters=Parameters.of(mechanism, None, vary, fixed, measurement=measurement),
        laws=laws,
        purpose=purpose,
        horizon=aim_of(purpose, horizon),
        route=route if isinstance(route, RouteChoice) else given,
        validate=validate,
        watch=progress and until_stopped(progress),
        executor=executor,
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
class _Asked:
    """What `select` was asked."""

    parameters: Parameters[None]
    laws: Laws
    purpose: PurposeName
    horizon: float
    route: RouteChoice
    validate: Measurement | None
    watch: Watch | None
    executor: Executor | None

    def judged(self, measurement: Measurement) -> Callable[..., RecordVerdict]:
        """Fit the laws to a table and judge them; return what puts that into a verdict."""
        mechanism = self.parameters.mechanism
        checks = checked(mechanism, measurement, self.validate)
        fitted = partial(
            candidate_of,
            parameters=self.parameters,
            measurement=without_stated(measurement, ROUTE),
            route=self.route,
            starts={},
        )
        stated = standard_uncertainty(measurement, "friction")
        found = climbed(
            laws_for(self.laws, measurement),
            fitted,
            self.watch,
            self.executor,
            seen=with_contained,
            at_noise=lambda one: one.residual <= stated,
            usual=self.laws is None,
        )
        with with_doubts(measurement, mechanism, of=ConvergenceError):
            plan, judged, _ = judged_of(
                fitted,
                found,
                self.horizon,
                validate=self.validate,
                progress=self.watch,
                executor=self.executor,
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
                self.purpose,
                checks,
                self.validate,
                beside=beside,
            )
            return replace(
                verdict,
                settings=self.route.settings,
                usual=self.laws is None,
                untried=found.untried,
                why_untried=found.why,
            )

        return verdict_of
