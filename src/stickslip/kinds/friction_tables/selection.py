"""Selection on friction tables: every law fitted, judged on speeds it has not seen, one named."""

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Final, final

import numpy as np
import scipy.stats
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError, InputError
from stickslip.experiments import Measurement, with_doubts, without_row
from stickslip.formatting import number, quantity
from stickslip.identification import (
    ModelError,
    Parameters,
    RecordFit,
    RecordSettings,
    RouteChoice,
    positions_of,
    refitted,
)
from stickslip.kinds.friction_tables.drift import drift_of, drifting_instead, reaching
from stickslip.kinds.friction_tables.shapes import Readings, other_shape, smooth_curve
from stickslip.kinds.kind import Request
from stickslip.kinds.records.admissibility import standard_uncertainty
from stickslip.kinds.records.ladder import climbed
from stickslip.kinds.records.selection import (
    ROUNDING,
    aim_of,
    candidate_of,
    judged_of,
    laws_for,
    until_stopped,
    verdict_on,
    with_contained,
    without_stated,
)
from stickslip.kinds.records.verdict import RecordCandidate, RecordVerdict
from stickslip.selection import APART, NEAR, apart, checked, errs_more

Array = NDArray[np.float64]

SUSPECT: Final = 4.0
"""Squared held-out error of a row over the mean of the others from which it is looked at."""
MOST: Final = 2
"""Such rows that are looked at, at most."""
ALONE: Final = 0.9
"""Share of the variance of a prediction that comes from the row itself, from which it decides a
parameter alone; what is held out is then predicted with a value that nothing else tells."""
LEAST: Final = 1e-300
"""Stands for 0 in ratios."""
CUTOFF: Final = 1e-10
"""Singular values over the largest one below which a parameter has no effect."""
CHANCE: Final = 5e-4
"""Chance that the errors of some row of a table are as far off the law of the others as one that is
none of the law's; Student's t of what the others leave, for errors alike and in proportion."""
SURELY: Final = 2.0
"""Standard errors by which the others have to be predicted better without it ..."""
SHARE: Final = 0.10
"""... and the share of their error that this takes off: the margins of a fault."""
SIZE: Final = 0.01
"""Share of an error up to which two laws predict the others alike: what a row that decides alone
leaves of them is the same to a few digits, and differs by rounding always one way."""
ROUTE: Final = "force-map"
"""Route of fits to friction that was measured."""


@final
@dataclass(frozen=True, kw_only=True)
class WithoutRow:
    """What a table says without one of its rows."""

    row: int
    """Which row, from 0."""
    distance: float
    """How far the row lies from the law that was fitted to the others [N]."""
    error: float
    """Root mean square held-out error of the others, and of what they predict of the row [N]."""
    wrong: bool
    """Whether no law has the row: it is far off, and spoils the prediction of the others."""
    otherwise: bool
    """Whether the law rests on the row: without it, a simpler one explains the others as well."""

    @classmethod
    def of(
        cls, row: int, whole: RecordCandidate, rest: RecordCandidate, measurement: Measurement
    ) -> "WithoutRow":
        """Compare the closest laws with a row and without it on the other rows."""
        assert whole.fit is not None
        assert rest.fit is not None
        with_it = np.delete(row_losses(whole.fit), row)
        without = row_losses(rest.fit)
        error = math.sqrt(float(np.mean(without)))
        distance = float(rest.fit.predict(measurement).residual[row])
        wider = math.sqrt(1.0 + _leverage(rest.fit, measurement, row))
        error *= wider
        friction = np.abs(np.asarray(measurement.friction, dtype=float))
        others = np.delete(friction, row)
        shares = without[others > 0.0] / others[others > 0.0] ** 2
        share = wider * math.sqrt(float(np.mean(shares))) if shares.size else 0.0
        times = min(
            abs(distance) / max(error, LEAST),
            abs(distance) / max(friction[row], LEAST) / max(share, LEAST),
        )
        freedom = max(len(without) - rest.parameters, 1)
        far = 2.0 * float(scipy.stats.t.sf(times, freedom)) * len(friction) < CHANCE
        return cls(
            row=row,
            distance=distance,
            error=error,
            wrong=far
            and (_is_between(measurement, row) or rest.parameters <= whole.parameters)
            and _worse(with_it, without, SURELY, SHARE),
            otherwise=rest.parameters < whole.parameters
            and not _worse(without, with_it, APART, SIZE),
        )

    def finding(self, measurement: Measurement) -> ModelError:
        """Return that a row was left out."""
        speed = float(np.asarray(measurement.velocity)[self.row])
        where = quantity(speed, measurement.unit("velocity"))
        unit = measurement.unit("friction")
        exact = self.error <= ROUNDING * float(np.max(np.abs(np.asarray(measurement.friction))))
        times = "" if exact else f" {number(abs(self.distance) / self.error, 2)} times their error,"
        return ModelError(
            kind="outlier",
            finding=(
                f"Row {self.row + 1} of the table, at {where},"
                f" is {quantity(abs(self.distance), unit)} off the law of the others,"
                f"{times} and is left out."
            ),
            consequence=(
                f"Repeat the reading of row {self.row + 1}: if it is right, friction has a shape"
                " there that no candidate has."
            ),
            effect=self.distance,
            interval=(math.nan, math.nan),
            share=0.0,
            moved=(),
        )


def _is_between(measurement: Measurement, row: int) -> bool:
    """Whether slower and faster rows of its direction surround a row: else laws extrapolate to it.

    A law that has no reason to have a part more without the last row would predict that row badly.
    """
    v = np.asarray(measurement.velocity, dtype=float)
    others = np.abs(np.delete(v, row)[np.sign(np.delete(v, row)) == np.sign(v[row])])
    return bool(np.any(others <= abs(v[row])) and np.any(others >= abs(v[row])))


def _leverage(fit: RecordFit, measurement: Measurement, row: int) -> float:
    """Return the variance of the prediction of a row over that of the readings of a fit."""
    own = fit.build(measurement, None).linearise(fit.values).slopes[row]
    slopes = fit.optimum.best.slopes
    size = np.maximum(np.linalg.norm(slopes, axis=0), LEAST)
    inverse = np.linalg.pinv((slopes / size).T @ (slopes / size), rcond=CUTOFF, hermitian=True)
    return float((own / size) @ inverse @ (own / size))


def suspects(closest: RecordCandidate, stated: float) -> list[int]:
    """Return the rows that a law predicts far worse than the others, or that it follows alone.

    None that is within its stated uncertainty [N], or within rounding.
    """
    if closest.fit is None or closest.fit.measurement.trials or closest.fit.optimum.cancelled:
        return []
    losses = row_losses(closest.fit)
    others = (losses.sum() - losses) / (len(losses) - 1)
    order = np.argsort(-losses).tolist()
    least = max(stated, ROUNDING * float(np.max(np.abs(closest.fit.problem.measured)))) ** 2
    found = [row for row in order[:MOST] if losses[row] > max(SUSPECT * others[row], least)]
    left = closest.fit.optimum.best
    slopes = left.slopes / np.maximum(np.linalg.norm(left.slopes, axis=0), LEAST)
    u, s, _ = np.linalg.svd(slopes, full_matrices=False)
    leverage = np.sum(u[:, s > CUTOFF * s[0]] ** 2, axis=1)
    if left.cost > len(losses) * least:
        alone = np.flatnonzero(leverage > ALONE)
        found += [row for row in alone[np.argsort(-leverage[alone])].tolist() if row not in found]
    return found[: 2 * MOST]


def row_losses(fit: RecordFit) -> Array:
    """Return squared errors of rows (n,), each predicted by a fit that has not seen its speed."""
    segment = fit.optimum.best.segment
    found = np.empty(len(segment))
    for number_, (first, last) in enumerate(positions_of(fit.problem).tolist()):
        seen = refitted(fit, first, last)
        values = fit.values if seen is None else seen.values
        own = fit.problem.linearise(values, only=[number_], slopes=False)
        found[segment == number_] = own.residual**2
    return found


def if_wrong(row: int, title: str) -> str:
    """Return a law, and of which row it is the law without.

    Examples
    --------
    >>> if_wrong(2, "Coulomb + viscous")
    'Coulomb + viscous if row 3 of the table is in error'
    """
    return f"{title} if row {row + 1} of the table is in error"


def _worse(losses: Array, others: Array, errors: float, share: float) -> bool:
    """Whether losses of rows are larger than others by a share, and by standard errors."""
    larger = math.sqrt(losses.mean()) > (1.0 + share) * math.sqrt(others.mean())
    return larger and apart(losses.tolist(), others.tolist()) > errors


def with_curve(candidate: RecordCandidate, *, uncertainty: float) -> RecordCandidate:
    """Return a candidate with the errors of a curve that is not excluded beside it, if one is not.

    That is a smooth curve which predicts the table better, or the best of other shapes if these are
    as far from the law as the table does not tell.
    """
    readings = Readings.of(candidate)
    if readings is None:
        return candidate
    smooth = smooth_curve(readings)
    if errs_more(
        candidate, replace(candidate, validation=smooth), errors=NEAR, uncertainty=uncertainty
    ):
        return replace(candidate, curve=smooth)
    other = other_shape(candidate, readings) if candidate.score > uncertainty else None
    return candidate if other is None else replace(candidate, curve=other)


def select_table(request: Request) -> RecordVerdict:
    """Select a law for friction at steady speeds."""
    measurement = request.measurement
    given = RouteChoice(route=ROUTE, settings=request.settings or RecordSettings())
    asked = _Selection(
        request=replace(request, progress=request.progress and until_stopped(request.progress)),
        parameters=Parameters.of(
            request.mechanism, None, request.vary, request.fixed, measurement=measurement
        ),
        horizon=aim_of(request.purpose or "simulate", request.horizon, measurement),
        route=request.route if isinstance(request.route, RouteChoice) else given,
    )
    verdict_of = asked.judged(measurement)
    verdict = verdict_of()
    if measurement.trials:
        return verdict
    errors: list[ModelError] = []
    possible: list[Measurement] = []
    if drift := drift_of(verdict.closest, verdict.candidates, measurement):
        possible = drift.possible(measurement)
        errors = [drift.finding(measurement.unit("friction"))]
        measurement = drift.drift.without(measurement)
        verdict_of = asked.judged(measurement, possible)
        verdict = verdict_of(errors)
    otherwise: dict[str, str] = {}
    stated = standard_uncertainty(measurement, "friction")
    for row in suspects(verdict.closest, stated):
        rest = without_row(measurement, row)
        with suppress(ConvergenceError, InputError):  # too few rows are left
            again = asked.judged(rest, [without_row(one, row) for one in possible])
            closest = again().closest
            seen = WithoutRow.of(row, verdict.closest, closest, measurement)
            if seen.wrong:
                return again([*errors, seen.finding(measurement)])
            if seen.otherwise:
                otherwise[closest.name] = if_wrong(row, closest.title)
    if not errors:
        otherwise |= drifting_instead(verdict.closest, verdict.candidates, measurement)
    otherwise = {name: said for name, said in otherwise.items() if name not in verdict.equals}
    return verdict_of(errors, otherwise) if otherwise else verdict


@final
@dataclass(frozen=True, kw_only=True)
class _Selection:
    """What `select` was asked, and what follows from it for every table."""

    request: Request
    parameters: Parameters[None]
    horizon: float
    route: RouteChoice

    def judged(
        self, measurement: Measurement, possible: Sequence[Measurement] = ()
    ) -> Callable[..., RecordVerdict]:
        """Fit the laws to a table and judge them; return what puts that into a verdict.

        Intervals reach what follows from other tables that are `possible`.
        """
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

        def told(c: RecordCandidate, errors: Sequence[ModelError]) -> RecordCandidate:
            if c.fit is None:
                return c
            return replace(c, fit=replace(reaching(c.fit, possible), known_errors=tuple(errors)))

        def verdict_of(
            errors: Sequence[ModelError] = (), otherwise: Mapping[str, str] | None = None
        ) -> RecordVerdict:
            def beside(closest: RecordCandidate, exact: float) -> RecordCandidate:
                found = with_curve(closest, uncertainty=exact)
                return replace(found, otherwise=otherwise or {})

            verdict = verdict_on(
                mechanism,
                measurement,
                [told(c, errors) for c in judged],
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
