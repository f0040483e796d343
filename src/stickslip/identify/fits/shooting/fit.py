"""A fit to records in time, and what it says of records it has not seen."""

import math
import numbers
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray
from typing_extensions import TypeVar

from stickslip.data import (
    QUANTITIES,
    REPLACED,
    LawEstimates,
    Measurement,
    levels_at,
    outlier_sentence,
    refuse_lack,
    refuse_unused,
)
from stickslip.errors import ParameterError
from stickslip.friction import FrictionLaw, Laws, bound
from stickslip.identify.fits.contact_inputs import typical_inputs
from stickslip.identify.fits.levenberg_marquardt import OptimizeResult, ResidualJacobian
from stickslip.identify.fits.parameters import FreeParameter, FreeParameters, told
from stickslip.identify.fits.record_forces import inside
from stickslip.identify.fits.results import Estimate, Fit, ModelError, estimates_for
from stickslip.identify.fits.rig_uncertainties import uncertainties_of
from stickslip.identify.fits.settings import RESOLUTION, ROUNDS, SETTLED
from stickslip.identify.fits.shooting.estimates import Inference
from stickslip.identify.fits.shooting.multiple_shooting import Shooting
from stickslip.identify.fits.shooting.problems import HoldFinding, ShootingBuilder
from stickslip.identify.fits.shooting.start_values import MECHANISM, SENSOR
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, turned, vary
from stickslip.show.described import Described
from stickslip.show.display import Tabular, plots
from stickslip.show.formatting import count, joined, quantity

if TYPE_CHECKING:
    import pandas as pd

    from stickslip.show.display import Drawing, Target


Array = NDArray[np.float64]
AnyLaw_co = TypeVar("AnyLaw_co", bound=FrictionLaw | Laws, default=FrictionLaw, covariant=True)
"""What was fitted: a law, or the laws of several contacts."""


@dataclass(frozen=True, kw_only=True)
class Score(metaclass=Described):
    """How far predictions are off, each segment started from its own fitted state."""

    rms: float
    """Root mean square of measured less predicted."""
    quantity: str
    """Of what, as in `QUANTITIES`."""
    horizon: float
    """Length of the segments [s]."""
    blocks: tuple[float, ...]
    """Root mean square of each segment."""
    turning: bool = False
    """Whether what was predicted turns about an axis."""

    @classmethod
    def of(
        cls, residual: Array, segment: NDArray[np.intp], problem: Shooting, *, turning: bool
    ) -> "Score":
        """Return the error of rows of a problem.

        Parameters
        ----------
        residual : array (n,)
            Measured less predicted.
        segment : array of int (n,)
            Segment of each row.
        problem : Shooting
            Where they are from.
        turning : bool
            Whether what was predicted turns about an axis.

        Returns
        -------
        Score
            Root mean square of all rows, and of each segment that has some.
        """
        blocks = [residual[segment == k] for k in range(len(problem.spans))]
        return cls(
            rms=float(np.sqrt(residual @ residual / len(residual))),
            quantity=problem.quantity,
            horizon=float(np.median(problem.spans[:, 2] - problem.spans[:, 1])),
            blocks=tuple(math.sqrt(float(np.mean(block**2))) for block in blocks if len(block)),
            turning=turning,
        )

    @property
    def unit(self) -> str:
        """SI unit."""
        return turned(QUANTITIES[self.quantity].unit, self.turning)

    def __str__(self) -> str:
        """Return the error and what it is of, in one line."""
        return (
            f"{quantity(self.rms, self.unit)} ({self.quantity}, {len(self.blocks)} segments of"
            f" {quantity(self.horizon, 's')})"
        )


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Prediction(Tabular):
    """Predicted segments beside what was measured; rows stand in the order of time.

    What is local to a segment, such as the position and velocity that it starts from, is fitted:
    `predicted` holds its last correction to first order, as `residual` does.
    """

    quantity: str
    """Of what, as in `QUANTITIES`."""
    record: NDArray[np.intp]
    """Record of each row (n,)."""
    segment: NDArray[np.intp]
    """Segment of each row (n,)."""
    t: Array
    """Times (n,) [s]."""
    residual: Array
    """Measured less predicted (n,)."""
    predicted: Array
    """Predicted (n,), in the SI unit of the quantity."""
    measured: Array
    """Measured (n,), in the same unit."""

    def __repr__(self) -> str:
        segments = len({*zip(self.record.tolist(), self.segment.tolist(), strict=True)})
        return (
            f"<Prediction of {self.quantity}: {len(self.t)} rows in"
            f" {count(segments, 'segment')}; columns {', '.join(map(str, self.to_dataframe()))}>"
        )

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the columns as a pandas DataFrame."""
        import pandas as pd

        return pd.DataFrame(
            {
                "record": self.record,
                "segment": self.segment,
                "t": self.t,
                "measured": self.measured,
                "predicted": self.predicted,
                "residual": self.residual,
            }
        )

    def _over(self) -> str:
        return "t"

    def _column_units(self) -> Mapping[str, str]:
        return {"t": "s"}


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class RecordFit(Fit[AnyLaw_co]):
    """A fit to records in time: estimates in the order of the unknowns, residuals, restarts."""

    route: str
    """How it was fitted: ``"shooting"``."""
    measurement: Measurement
    """What was fitted."""
    problem: Shooting = field(repr=False)
    """The record as residuals."""
    build: ShootingBuilder = field(repr=False)
    """Makes the same problem of other records."""
    optimum: OptimizeResult
    """Least cost and where it is; of a free decay, those of the last and longest segments."""
    inference: Inference
    """Covariance, condition and effective sample size."""
    at_bounds: Mapping[str, str]
    """Which parameters ended at a bound, by path: ``"lower"`` or ``"upper"``."""
    sentences: tuple[str, ...]
    """What the record cannot tell, in words."""
    hold: HoldFinding | None = None
    """How the recorded force runs between its samples, as given or estimated from the record."""
    first: OptimizeResult | None = None
    """Of a free decay, the search from all starts, in segments as asked, before longer ones."""
    left_out: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    """Times [s] of samples far off those beside, which were replaced before the fit, by column."""

    @property
    def model_errors(self) -> tuple[ModelError, ...]:
        """What is wrong with the record and was left out of the fit; `select` looks for more."""
        return tuple(
            ModelError(
                kind="outliers",
                finding=outlier_sentence(column, times),
                consequence=REPLACED,
                effect=float(len(times)),
                interval=(math.nan, math.nan),
                share=0.0,
                moved=(),
            )
            for column, times in self.left_out.items()
        )

    @property
    def offset_estimate(self) -> Estimate | None:
        """The constant force beside friction, where it was fitted."""
        return next(
            (estimate for estimate in self.estimates if estimate.path in (MECHANISM, SENSOR)), None
        )

    @property
    def offset(self) -> float:
        """The constant force that stands beside friction [N], fitted or held."""
        if self.offset_estimate is not None:
            return self.offset_estimate.value
        return float(getattr(self.mechanism, "offset", 0.0))

    @property
    def rig_uncertainties(self) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        mechanism, records = self.mechanism, self.measurement.records()
        pairs = zip(records, uncertainties_of(mechanism, self.measurement), strict=True)
        return [
            (vary(mechanism, "mechanism", record.overrides), {**shared, **own})
            for record, (own, shared) in pairs
        ]

    def _plot(self, ax: "Target") -> "Drawing":
        draw = plots().plot_friction_map
        return cast("Drawing", draw(self, ax))

    @property
    def restarts(self) -> OptimizeResult:
        """The search that began from all starts."""
        return self.optimum if self.first is None else self.first

    def law_estimates(self) -> LawEstimates:
        records = self.measurement.records()
        weighed = any("load" in record.quantities() for record in records)
        weighed = weighed or any("mechanism.load" in record.overrides for record in records)
        return estimates_for(
            self.law,
            self.estimates,
            self.inference.correlation,
            levels="per load" if weighed else levels_at(self.mechanism),
            largest_speed=_largest(records),
        )

    def __str__(self) -> str:
        """Return the law, its estimates and how far off it is, in one line."""
        error = quantity(self.rms, self.measurement.unit(self.problem.quantity))
        findings = (model_error.finding.removesuffix(".") for model_error in self.model_errors)
        fitted = (
            f"{self.law.title} fitted to {self.problem.quantity}:"
            f" {', '.join(map(str, self.shown))}; residual {error}"
        )
        return ". ".join((fitted, *findings))

    def _notes(self) -> Sequence[str]:
        return (*self.assumptions, *map(str, self.model_errors), *self.sentences)

    @property
    def held(self) -> FreeParameters:
        """Friction that acts and was not fitted, with its values as start values.

        That is damping of a single coordinate, and parameters of the law that were given.
        """
        free = self.free_parameters.paths
        damping = {"mechanism.damping", "mechanism.joints.0.damping"}
        damping = damping if len(self.mechanism.coordinates) == 1 else set()
        items = (
            FreeParameter(path=path, quantity=quantity, start=value, low=value, high=value)
            for path, quantity, value in (
                *parameters(self.mechanism, "mechanism"), *parameters(self.law, "friction"),
            )
            if value and path not in free
            if path in damping or (path.startswith("friction.") and not quantity.structural)
        )  # fmt: skip
        return told(FreeParameters(tuple(items)), self.mechanism, self.measurement)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What the estimates rest on beside the record, in sentences.

        Friction that is held and acts, and how the force runs between samples.
        """
        shown = [
            f"{item.path} = {quantity(item.start, item.quantity.unit)}" for item in self.held.items
        ]
        held = f"Held, and acting beside what is fitted: {joined(shown)}." if shown else ""
        if any(
            path.endswith(".viscous_coefficient") for path in self.free_parameters.paths
        ) and any(item.path.endswith(".damping") for item in self.held.items):
            held += " Fitted viscous friction is what exceeds that damping: set it to 0 to fit all."
        between = self.hold.sentence if self.hold else ""
        return tuple(item for item in (held, between) if item)

    @property
    def typical_inputs(self) -> Mapping[str, float]:
        """Medians of the contact inputs of the law, at which curves of it are drawn."""
        if not isinstance(self.law, FrictionLaw):
            return {}
        return typical_inputs(self.law, self.mechanism, self.measurement)

    @property
    def typical_law(self) -> AnyLaw_co:
        """The law at these inputs."""
        law = self.law
        return bound(law, self.typical_inputs) if isinstance(law, FrictionLaw) else law

    @property
    def free_parameters(self) -> FreeParameters:
        """What was looked for."""
        return self.problem.free_parameters

    @property
    def values(self) -> Array:
        """Best values of the unknowns (p,)."""
        return self.optimum.best.values

    @property
    def rms(self) -> float:
        """Root mean square of the residuals, in the unit of the quantity compared."""
        return self.optimum.best.rms

    @property
    def residual(self) -> Array:
        """Measured less predicted (n,), what is local to segments taken out."""
        return self.optimum.best.residual

    @property
    def scale(self) -> Array:
        """Derivatives of the values by what the optimiser saw; 0 for sizes that ran to a bound."""
        return scale_of(self.free_parameters, self.optimum.best.values, self.at_bounds)

    def predict(
        self, measurement: Measurement | None = None, *, horizon: float | None = None
    ) -> Prediction:
        """Predict a record segment by segment, each from its own fitted initial state.

        Parameters
        ----------
        measurement : Measurement, optional
            What is predicted; what was fitted if not given.
        horizon : float, optional
            Length of the segments [s]; that of the fit if not given.

        Returns
        -------
        Prediction
            Measured and predicted values and their residuals, by record, segment and time.

        Examples
        --------
        >>> from stickslip import Axis, Coulomb, Measurement, fit
        >>> t = np.linspace(0.0, 0.5, 101)
        >>> slides = Measurement(time=t, position=0.5 * t - 0.25 * t**2, force=0.0 * t - 0.1)
        >>> found = fit(Axis(inertia=1.0), Coulomb, slides, route="shooting")
        >>> seen = found.predict()
        >>> bool(np.max(np.abs(seen.measured - seen.predicted)) < 1e-6)
        True
        """
        problem, seen = self._seen(measurement, horizon)
        measured, residual = problem.measured, seen.residual
        return Prediction(
            quantity=problem.quantity,
            record=problem.spans[seen.segment, 0].astype(int),
            segment=seen.segment,
            t=problem.times,
            residual=residual,
            predicted=measured - residual,
            measured=measured,
        )

    def score(
        self, measurement: Measurement | None = None, *, horizon: float | None = None
    ) -> Score:
        """Return the error of predictions, arguments as in `predict`.

        Parameters
        ----------
        measurement : Measurement, optional
            Records to predict; those that were fitted if not given.
        horizon : float, optional
            Length of the predicted segments [s]; that of the fit if not given.

        Returns
        -------
        Score
            Root mean square of all residuals and of each segment.
        """
        problem, seen = self._seen(measurement, horizon)
        turning = self.measurement.turning
        return Score.of(seen.residual, seen.segment, problem, turning=turning)

    def _seen(
        self, measurement: Measurement | None, horizon: float | None
    ) -> tuple[Shooting, ResidualJacobian]:
        if measurement is None and horizon is None:
            return self.problem, self.optimum.best
        if horizon is not None:
            check_horizon(horizon)
        if measurement is not None:
            refuse_unused(measurement, inside(self.mechanism, measurement))
            refuse_lack(self.measurement, measurement, compared=self.problem.quantity)
        problem = self.build(self.measurement if measurement is None else measurement, horizon)
        return problem, settled(problem, self.values)

    def to_dict(self) -> Mapping[str, Any]:
        result, restarts = self.optimum, self.restarts
        rows = len(restarts.best.residual)
        return {
            "law": self.law.name,
            "route": self.route,
            "hold": self.hold.to_dict() if self.hold else None,
            "held": [
                {"parameter": item.path, "unit": item.quantity.unit, "value": item.start}
                for item in self.held.items
            ],
            "quantity": self.problem.quantity,
            "residual_rms": self.rms,
            "estimates": [estimate.to_dict() for estimate in self.estimates],
            "correlation": self.inference.correlation.tolist(),
            "condition": self.inference.condition,
            "effective_samples": self.inference.effective,
            "at_bounds": dict(self.at_bounds),
            "restarts": [math.sqrt(cost / rows) for cost in restarts.costs],
            "restarts_agreeing": restarts.agreeing,
            "evaluations": result.evaluations,
            "cancelled": result.cancelled,
            "model_errors": [model_error.to_dict() for model_error in self.model_errors],
            "cannot_tell": list(self.sentences),
            "remarks": list(self.remarks),
        }


def _largest(records: Iterable[Measurement]) -> float | None:
    """Return the largest slip speed of several records, if one of them tells it."""
    return max((item for item in map(_largest_speed, records) if item is not None), default=None)


def _largest_speed(record: Measurement) -> float | None:
    """Return the largest slip speed of a record: as measured, or as positions change."""
    if record.velocity is not None:
        return float(np.max(np.abs(record.velocity)))
    if record.position is None or record.time is None:
        return None
    x, t = np.asarray(record.position), np.asarray(record.time)
    lag = max(len(x) // RESOLUTION, 1)
    return (
        float(np.max(np.abs((x[lag:] - x[:-lag]) / (t[lag:] - t[:-lag])))) if len(x) > 1 else None
    )


def check_horizon(horizon: float) -> None:
    """Refuse a length that no prediction has.

    Examples
    --------
    >>> check_horizon(4.0)
    """
    given: object = horizon  # a text with a unit is a likely mistake, whatever the types say
    known = isinstance(given, numbers.Real) and not isinstance(given, bool)
    if not (known and 0.0 < horizon < math.inf):
        raise ParameterError(
            "horizon must be a finite time above 0 s, a number of seconds such as 1.0, got"
            f" {horizon!r}."
        )


def settled(problem: Shooting, values: Array) -> ResidualJacobian:
    """Return residuals at values with the segments' initial states fitted.

    Where a segment begins at rest, each round takes three quarters off the error of its first
    state only: after two, one such segment could outweigh all others in a held-out score.
    """
    seen = problem.linearise(values)
    best = seen
    for _ in range(ROUNDS - 1):
        if not math.isfinite(seen.cost):
            break
        seen = problem.linearise(values, seen)
        before, best = best, _better(best, seen)
        if best.cost > (1.0 - SETTLED) * before.cost:
            break
    return best


def _better(one: ResidualJacobian, other: ResidualJacobian) -> ResidualJacobian:
    """Return by segment the residuals that are less: a long step of a first state may go astray."""
    residual = one.residual.copy()
    for k in np.unique(one.segment):
        rows = one.segment == k
        if not other.residual[rows] @ other.residual[rows] > residual[rows] @ residual[rows]:
            residual[rows] = other.residual[rows]
    return other.with_residual(residual)


def scale_of(free_parameters: FreeParameters, values: Array, at_bounds: Mapping[str, str]) -> Array:
    """Return the derivatives of values by coordinates, 0 for sizes that ran to a bound.

    A level or a slope that a bound holds, such as 0, is as unsure as any: were it taken for known,
    what trades off with it would seem better known than it is.
    """
    scale = free_parameters.slopes(free_parameters.coordinates(values))
    for i, item in enumerate(free_parameters.items):
        if item.path in at_bounds and item.log:
            scale[:, i] = 0.0
    return scale
