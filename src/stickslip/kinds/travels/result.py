"""A fit to travels."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.experiments import LawEstimates, levels_at
from stickslip.formatting import joined, quantity, ratio
from stickslip.friction import FrictionLaw
from stickslip.identification import Fit, Law_co, Trial, estimates_for, is_rig
from stickslip.identify import agreeing_scale, covariance_of
from stickslip.mechanisms import Mechanism, slip_of
from stickslip.simulation import simulate

if TYPE_CHECKING:
    from stickslip.display import Drawing, Target

Array: TypeAlias = NDArray[np.float64]

POOR = 2.0
"""Residuals over their stated standard errors from which a fit with a mechanism is doubted."""
SIGNIFICANT = 0.99
"""Quantile of chi-square above which residuals contradict the stated uncertainty."""


def variance_of(chi_square: float, freedom: int, *, stated: bool) -> tuple[float, float]:
    """Return the variance of standardised residuals and its degrees of freedom.

    Examples
    --------
    >>> variance_of(3.0, 2, stated=True), variance_of(30.0, 2, stated=True)
    ((1.0, inf), (15.0, 2.0))
    >>> variance_of(3.0, 2, stated=False)
    (1.5, 2.0)
    """
    from scipy.stats import chi2

    if stated and (freedom <= 0 or chi_square <= chi2.ppf(SIGNIFICANT, freedom)):
        return 1.0, math.inf
    return max(1.0, chi_square / freedom) if freedom > 0 else 1.0, float(max(freedom, 0))


LONG = 10.0
"""Time in which a body that comes to rest has had its largest speed [s]."""
SAMPLES = 2001


def _largest_speed(trial: Trial, law: FrictionLaw) -> float:
    """Return the largest slip speed of a run that a travel was measured of [m/s]."""
    mechanism = trial.mechanism
    slip = slip_of(mechanism)
    run = simulate(mechanism, law, t_end=LONG, y0=trial.start(law), throw=False)
    seen = run.at(np.union1d(np.linspace(*run.span, SAMPLES), run.t))
    return float(np.abs(seen[mechanism.rates[mechanism.coordinates.index(slip)]]).max())


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class TravelFit(Fit[Law_co]):
    """A fit to travels.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, fit
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> result = fit(rig, Coulomb, reading)
    >>> print(result.estimates[0])
    mu_k = 0.255 (0.249 to 0.261)
    """

    measured: tuple[float, ...]
    """Travels [m], one a trial."""
    predicted: tuple[float, ...]
    """Travels of the fitted law [m]."""
    runs: int
    """Simulations spent."""
    others: tuple[float, ...] = ()
    """Further values of a single free parameter that explain the travels as well."""
    standard_errors: tuple[float, ...] = ()
    """Standard errors of several travels [m]: as stated, or else lower bounds; with those of what
    was set for each trial by hand."""
    reading_errors: tuple[float, ...] = ()
    """Those of the readings alone [m]."""
    slopes: tuple[tuple[float, ...], ...] = ()
    """Derivatives of several travels (n, p) by what was fitted; 0 by what a bound holds."""
    shared: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    """How far the standard uncertainty of a parameter that trials share moves each travel [m], by
    path."""
    stated: bool = True
    """Whether an uncertainty of the travels was stated."""
    rivals: tuple[tuple[float, ...], ...] = ()
    """Other values of what was fitted, with parameters of the mechanism, that fit as well."""
    condition: float = 1.0
    """Condition number of the Jacobian with scaled columns."""
    correlation: tuple[tuple[float, ...], ...] = ((1.0,),)
    """Of the estimates (p, p); 0 with what the travels do not tell."""
    trials: tuple[Trial, ...] = ()
    """What was fitted."""

    @property
    @override
    def rig_uncertainties(self) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        return [(one.mechanism, {**one.shared, **one.doubts}) for one in self.trials]

    @property
    @override
    def settings(self) -> int:
        return len({trial.mechanism for trial in self.trials})

    @property
    @override
    def readings(self) -> str:
        return "the readings" if len(self.trials) > 1 else "the reading"

    @override
    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.plots import INTERVAL_SIZE, Interval, draw_intervals, on_axes

        errors = self.standard_errors or (math.nan,) * len(self.residuals)
        pairs = enumerate(zip(self.residuals, errors, strict=True), 1)
        rows = [Interval(f"trial {i}", 1e3 * value, 1e3 * error) for i, (value, error) in pairs]
        draw = draw_intervals(rows, "measured minus predicted travel", "mm")
        return on_axes(draw, ax, INTERVAL_SIZE)

    @override
    def law_estimates(self) -> LawEstimates:
        settings = {trial.setting: trial for trial in self.trials}.values()
        speeds = [_largest_speed(trial, self.law) for trial in settings]
        return estimates_for(
            self.law,
            self.estimates,
            self.correlation,
            levels=levels_at(self.mechanism),
            largest_speed=max(speeds, default=None),
        )

    @override
    def __str__(self) -> str:
        """Return the law, its estimates and how far off it is, in one line."""
        count = len(self.measured)
        worst = max(abs(residual) for residual in self.residuals)
        return (
            f"{self.law.title} fitted to {count} travel{'s' if count > 1 else ''}:"
            f" {', '.join(map(str, self.estimates))}; largest residual {quantity(worst, 'm', 2)}"
        )

    @override
    def _notes(self) -> Sequence[str]:
        return (*self.remarks, *self.told_apart)

    @property
    def told_apart(self) -> tuple[str, ...]:
        """What the travels cannot tell: other values, and parameters of the mechanism."""
        if self.others:
            one = self.estimates[0].quantity
            shown = joined([quantity(value, one.unit, 3) for value in self.others])
            what = "the travels" if len(self.measured) > 1 else "the travel"
            return (f"Other values of {one.symbol} explain {what} as well: {shown}.",)
        rig = any(is_rig(e.path) for e in self.estimates)
        said = [
            f"{e.quantity.symbol} is not identified: {e.reason}."
            for e in self.estimates
            if e.reason and rig
        ]
        scatter = math.sqrt(self.variance[0])
        if self.stated and scatter > POOR:
            said.append(
                f"The readings differ from this fit by {ratio(scatter)} their stated uncertainty:"
                " the law or the mechanism is not that of the trials, or the search ended in a"
                " local minimum. Try other start values."
            )
        for values in self.rivals[: 1 if rig else 0]:
            shown = joined(
                [
                    f"{e.quantity.symbol} = {quantity(v, e.quantity.unit, 3)}"
                    for e, v in zip(self.estimates, values, strict=True)
                ]
            )
            said.append(
                f"Other values fit as well: {shown}. Intervals reach over both. Measure more"
                " settings."
            )
        return tuple(said)

    @property
    def residuals(self) -> tuple[float, ...]:
        """Measured less predicted travel [m], one a trial."""
        return tuple(m - p for m, p in zip(self.measured, self.predicted, strict=True))

    @property
    def freedom(self) -> int:
        """Number of readings less number of fitted parameters."""
        return len(self.measured) - len(self.estimates)

    def travel_covariance(self, scale: float = 1.0) -> Array:
        """Return the covariance of several travels (n, n) [m^2], with what trials share.

        Parameters
        ----------
        scale : float
            Variance of the readings over that of their standard errors.
        """
        readings = np.square(self.reading_errors)
        scatter = np.sqrt(np.square(self.standard_errors) + (scale - 1.0) * readings)
        return covariance_of(scatter, {path: np.array(p) for path, p in self.shared.items()})

    @property
    def standardised(self) -> tuple[float, ...]:
        """Residuals over the standard deviations of several travels, one a trial."""
        spread = np.sqrt(np.diag(self.travel_covariance())).tolist()
        return tuple(r / e for r, e in zip(self.residuals, spread, strict=True))

    @property
    def chi_square(self) -> float:
        """Residuals squared over their covariance.

        Where trials share no uncertainty, it is the sum of squares of `standardised`.
        """
        if not self.standard_errors:
            return 0.0
        residuals = np.array(self.residuals)
        return float(residuals @ np.linalg.solve(self.travel_covariance(), residuals))

    @property
    def variance(self) -> tuple[float, float]:
        """Variance of a reading over the square of its standard error, and degrees of freedom.

        It is 1 and known, with infinitely many degrees of freedom, where uncertainties were stated
        and chi-square does not exceed the 99 % quantile of its distribution. Else it is estimated
        from the residuals, beside what trials share or set, which has no scale.
        """
        whole = variance_of(self.chi_square, self.freedom, stated=self.stated)
        if not 0.0 < whole[1] < math.inf or (
            not self.shared and self.standard_errors == self.reading_errors
        ):
            return whole
        residuals, errors = np.array(self.residuals), np.array(self.reading_errors)
        return (
            agreeing_scale(residuals, errors, self.freedom, self.travel_covariance),
            whole[1],
        )

    @override
    def to_dict(self) -> Mapping[str, Any]:
        return {
            "law": self.law.name,
            "estimates": [estimate.to_dict() for estimate in self.estimates],
            "measured_travel": list(self.measured),
            "predicted_travel": list(self.predicted),
            "chi_square": self.chi_square if self.standard_errors and self.stated else None,
            "degrees_of_freedom": self.freedom,
            "runs": self.runs,
            "other_values": list(self.others),
        }
