"""What a fit gives back."""

import html
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import TypeVar, override

from stickslip.digits import NO_BREAK_SPACE, interval, significant, within
from stickslip.experiments.estimates import HARD, LawEstimates, Levels, levels_at, spread_of
from stickslip.experiments.writing import rig_toml
from stickslip.friction import FrictionLaw
from stickslip.identification.propagation import agreeing_scale, covariance_of
from stickslip.identification.travel import Trial
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, full_path, parameters
from stickslip.simulation import simulate

__all__ = ["Estimate", "Fit", "Law_co", "TravelFit", "estimates_for", "variance_of"]

Array: TypeAlias = NDArray[np.float64]
Law_co = TypeVar("Law_co", bound=FrictionLaw, default=FrictionLaw, covariant=True)
"""What type of law was fitted, as far as a type checker can know."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """One fitted parameter with its doubt."""

    path: str
    """Parameter path, such as ``"friction.kinetic_coefficient"``."""
    quantity: Quantity
    """Symbol and unit."""
    value: float
    """Best value."""
    low: float
    """Lower end of the interval; minus infinity where the data do not bound it."""
    high: float
    """Upper end; infinity where the data do not bound it."""
    interval: str
    """What the interval is: ``"rounding range"``, ``"stated interval"`` or ``"95 %"``."""
    reason: str = ""
    """Why an end is infinite, in words."""
    sources: Mapping[str, float] = field(default_factory=dict)
    """Standard errors by where they come from: ``"readings"``, and parameters of the mechanism by
    path; empty where no uncertainty of the mechanism was stated."""

    @property
    def bounded(self) -> bool:
        """Whether the data bound the parameter on both sides."""
        return math.isfinite(self.low) and math.isfinite(self.high)

    @property
    def range(self) -> str:
        """The interval in words."""
        if self.bounded:
            return _spaced(interval(self.low, self.high))
        if math.isfinite(self.low):
            return f"{_spaced(significant(self.low, 3))} or more"
        if math.isfinite(self.high):
            return f"{_spaced(significant(self.high, 3))} or less"
        return "not bounded"

    @override
    def __str__(self) -> str:
        """Return symbol, value and interval, such as ``mu_k = 0.255 (0.249 to 0.261)``."""
        unit = "" if self.quantity.unit == "1" else f" {self.quantity.unit}"
        value = _spaced(within(self.value, self.low, self.high))
        return f"{self.quantity.symbol} = {value}{unit} ({self.range})"

    @override
    def __repr__(self) -> str:
        return f"<Estimate {self}, {self.interval}>"

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(str(self))}, {html.escape(self.interval)}</p>"

    def to_dict(self) -> Mapping[str, Any]:
        """Return the estimate as plain numbers and strings; None where an end is infinite."""
        return {
            "parameter": self.path,
            "symbol": self.quantity.symbol,
            "unit": self.quantity.unit,
            "value": self.value,
            "low": self.low if math.isfinite(self.low) else None,
            "high": self.high if math.isfinite(self.high) else None,
            "interval": self.interval,
            "reason": self.reason,
            **({"standard_error_from": dict(self.sources)} if self.sources else {}),
        }


def _spaced(text: str) -> str:
    """Return a number with ordinary spaces, as a terminal and a search want them."""
    return text.replace(NO_BREAK_SPACE, " ")


@dataclass(frozen=True, kw_only=True)
class Fit(ABC, Generic[Law_co]):
    """A law whose free parameters make a mechanism behave as measured."""

    law: Law_co
    """The law with its fitted parameters."""
    mechanism: Mechanism
    """The mechanism: as measured first, with what was fitted of it."""
    estimates: tuple[Estimate, ...]
    """The free parameters."""
    remarks: tuple[str, ...] = ()
    """What is to be known of the mechanism as it is saved, in sentences."""

    @final
    def to_law(self) -> Law_co:
        """Return the fitted law."""
        return self.law

    @final
    def estimate(self, name: str) -> Estimate:
        """Return the estimate of a parameter, by its path or its last name."""
        known = {estimate.path: estimate for estimate in self.estimates}
        return known[full_path(name, list(known))]

    @final
    def to_toml(self) -> str:
        """Return mechanism, law and estimates as the text of a rig file, which `load_rig` reads."""
        title = f"{self.law.title}, fitted"
        text = rig_toml(self.mechanism, self.law, title=title, estimates=self.law_estimates())
        return "".join(f"# {remark}\n" for remark in self.remarks) + text

    @final
    def save(self, path: str | Path) -> None:
        """Write `to_toml` to a file that ``stickslip simulate`` takes."""
        Path(path).write_text(self.to_toml(), encoding="utf-8")

    @abstractmethod
    def law_estimates(self) -> LawEstimates:
        """Return how well the law is known: intervals, covariance, and what was not fitted."""

    @override
    def __repr__(self) -> str:
        return f"<Fit: {self}>"

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(str(self))}</p>"

    @abstractmethod
    def to_dict(self) -> Mapping[str, Any]:
        """Return the fit as plain numbers and strings."""


FRICTION = "friction."


def estimates_for(
    law: FrictionLaw,
    estimates: Sequence[Estimate],
    correlation: ArrayLike,
    *,
    levels: Levels,
    largest_speed: float | None,
) -> LawEstimates:
    """Return what estimates say of a law; those of the mechanism are left out.

    Parameters
    ----------
    law : FrictionLaw
        With its fitted values.
    estimates : sequence of Estimate
        What was fitted.
    correlation : array_like (p, p)
        Of the estimates, in their order.
    levels : {"per load", "forces", "torques"}
        What the levels are.
    largest_speed : float or None
        Largest slip speed in what was fitted, if it is known.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> level = Estimate(
    ...     path="friction.kinetic_coefficient",
    ...     quantity=Quantity("mu_k"),
    ...     value=0.25,
    ...     low=0.24,
    ...     high=0.26,
    ...     interval="95 %",
    ... )
    >>> law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.3)
    >>> found = estimates_for(law, [level], [[1.0]], levels="per load", largest_speed=None)
    >>> found.intervals, found.not_fitted
    ({'kinetic_coefficient': (0.24, 0.26)}, ('static_coefficient',))
    """
    own = {e.path: e for e in estimates if e.path.startswith(FRICTION)}
    bounded = [i for i, e in enumerate(estimates) if e.path in own and e.bounded]
    names = {i: estimates[i].path.removeprefix(FRICTION) for i in bounded}
    kinds = [e.interval for e in own.values() if e.interval in HARD]
    kind = kinds[0] if kinds else "95 %"
    spreads = np.array([spread_of(e.value, e.low, e.high, kind) for e in own.values() if e.bounded])
    table = np.asarray(correlation)[np.ix_(bounded, bounded)] * np.outer(spreads, spreads)
    table = 0.5 * (table + table.T)
    paths = [path for path, _, _ in parameters(law, "friction")]
    return LawEstimates(
        law=law.name,
        intervals={name: _around(estimates[i]) for i, name in names.items()},
        interval=kind,
        covariance_of=tuple(names.values()),
        covariance=tuple(map(tuple, table.tolist())),
        not_identified={
            path.removeprefix(FRICTION): e.reason or "the data do not bound it"
            for path, e in own.items()
            if not e.bounded and path in paths
        },
        not_fitted=tuple(path.removeprefix(FRICTION) for path in paths if path not in own),
        levels=levels,
        largest_speed=largest_speed,
    )


def _around(one: Estimate) -> tuple[float, float]:
    """Return an interval that has its value inside: an end may be a rounding error off."""
    return float(min(one.low, one.value)), float(max(one.high, one.value))


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
    slip = mechanism.contacts()[0].slip
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
    """Further values of a single free parameter that give the same travel."""
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
    condition: float = 1.0
    """Condition number of the Jacobian with scaled columns."""
    correlation: tuple[tuple[float, ...], ...] = ((1.0,),)
    """Of the estimates (p, p); 0 with what the travels do not tell."""
    trials: tuple[Trial, ...] = ()
    """What was fitted."""

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
        worst = 1e3 * max(abs(residual) for residual in self.residuals)
        return (
            f"{self.law.title} fitted to {count} travel{'s' if count > 1 else ''}:"
            f" {', '.join(map(str, self.estimates))}; largest residual {worst:.2g} mm"
        )

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

    def deviance(self, scale: float) -> float:
        """Return minus twice the largest log-likelihood of several travels, less a constant.

        It is chi-square plus the logarithm of the determinant of the covariance, over that of
        uncorrelated micrometres, which is the same for all laws where the mechanism is known.

        Parameters
        ----------
        scale : float
            Variance of the readings over that of their standard errors. With another one than that
            of the fit readings weigh otherwise: what was fitted follows to first order.
        """
        root = np.linalg.cholesky(self.travel_covariance(scale))
        left = np.linalg.solve(root, np.array(self.residuals))
        slopes = np.linalg.solve(root, np.array(self.slopes))
        left = left - slopes @ np.linalg.lstsq(slopes, left, rcond=None)[0]
        return float(left @ left + 2.0 * np.sum(np.log(1e6 * np.diag(root))))

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
