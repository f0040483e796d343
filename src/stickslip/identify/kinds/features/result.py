"""What a fit to features gives back, and what it says about itself."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import LawEstimates, Measurement, levels_at
from stickslip.engine.simulation import simulate
from stickslip.identify import THRESHOLDS
from stickslip.identify.fits import (
    BLOCKS,
    Estimate,
    Fit,
    FreeParameters,
    Law_co,
    ResidualJacobian,
    estimates_for,
    quantile_of,
)
from stickslip.identify.kinds.features.features import (
    COMPARED,
    FEATURES,
    StickSlipFeatures,
    features_of,
    findings_of,
)
from stickslip.identify.kinds.features.problem import NUDGE, SETTLING
from stickslip.mechanisms import TowedBlock
from stickslip.show.formatting import joined, number, percent, signed_percent

if TYPE_CHECKING:
    from stickslip.show.display import Drawing, Target

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class FeatureFit(Fit[Law_co]):
    """A law on a towed block whose limit cycle has the features of a record.

    The mechanism has the fitted mass; its load stays the nominal one.
    """

    mechanism: TowedBlock
    """The towed block with fitted parameters."""
    measurement: Measurement
    """The whole record."""
    observed: StickSlipFeatures
    """Features of the part of the record that was fitted."""
    predicted: Mapping[str, float]
    """Compared features of the fitted limit cycle."""
    errors: Mapping[str, float]
    """Relative errors of these on the part that was fitted."""
    held_out: StickSlipFeatures | None
    """Features of the part that the fit did not see."""
    held_out_errors: Mapping[str, float]
    """Relative errors on that part; empty without one."""
    runs: int
    """Runs simulated."""
    sentences: tuple[str, ...]
    """What can be said, in words."""
    correlation: Array
    """Of the estimates (p, p), along what the features tell."""
    alone: tuple[Estimate, ...] = ()
    """Estimates that hold if this law does, where `estimates` hold whichever law does of those that
    the features do not tell from it; empty elsewhere."""

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.show.plots import INTERVAL_SIZE, Interval, draw_intervals, on_axes

        kind = "held-out" if self.held_out_errors else "fitted"
        errors = self.held_out_errors or self.errors
        rows = [Interval(name.replace("_", " "), error) for name, error in errors.items()]
        return on_axes(draw_intervals(rows, f"relative error, {kind}", "1"), ax, INTERVAL_SIZE)

    def law_estimates(self) -> LawEstimates:
        return estimates_for(
            self.law,
            self.estimates,
            self.correlation,
            levels=levels_at(self.mechanism),
            largest_speed=None,
            alone=self.alone,
        )

    @property
    def rms(self) -> float:
        """Root mean square of the relative errors on the part that was fitted."""
        return float(np.sqrt(np.mean([error**2 for error in self.errors.values()])))

    @property
    def score(self) -> float:
        """Root mean square of the held-out errors; of the errors themselves without any."""
        if not self.held_out_errors:
            return self.rms
        return float(np.sqrt(np.mean([error**2 for error in self.held_out_errors.values()])))

    def judged(self, measurement: Measurement) -> dict[str, float]:
        """Return the relative errors of the compared features on another record of this block.

        Parameters
        ----------
        measurement : Measurement
            One record with ``time`` and ``spring_force`` [N].
        """
        predicted = np.array([self.predicted[name] for name in COMPARED])
        return errors_of(predicted, features_of(measurement, mechanism=self.mechanism))

    def limit_cycle(self, t: Array) -> Array:
        """Return the force of the spring in the fitted limit cycle (n,) [N].

        Parameters
        ----------
        t : array (n,)
            Times [s] from 0 on, at which the motion has settled.
        """
        settled = SETTLING / self.observed.frequency
        times = settled + np.asarray(t, dtype=float)
        block, level = self.mechanism, self.observed.mean * self.mechanism.steady_load
        start = {"x": -level / block.stiffness}
        run = simulate(block, self.law, t_end=float(times.max()), y0=start).at(times)
        force = block.stiffness * (block.speed * times - np.asarray(run["x"]))
        return np.asarray(force + block.damping * (block.speed - np.asarray(run["v"])))

    def __str__(self) -> str:
        """Return law, estimates and errors, then the sentences."""
        numbers = ", ".join(map(str, self.estimates))
        where = "held-out" if self.held_out_errors else "fitted"
        errors = ", ".join(
            f"{name.replace('_', ' ')} {signed_percent(error)}"
            for name, error in (self.held_out_errors or self.errors).items()
        )
        head = f"{self.law.title} fitted to features: {numbers}; {where} errors: {errors}"
        return "\n".join([head, *self.sentences])

    def __repr__(self) -> str:
        return f"<FeatureFit: {self.law.title}, rms error {percent(self.score)}>"

    def _notes(self) -> Sequence[str]:
        return self.sentences

    def to_dict(self) -> Mapping[str, Any]:
        return {
            "law": self.law.name,
            "route": FEATURES,
            "estimates": [estimate.to_dict() for estimate in self.estimates],
            "observed": self.observed.to_dict(),
            "predicted": dict(self.predicted),
            "errors": dict(self.errors),
            "held_out": None if self.held_out is None else self.held_out.to_dict(),
            "held_out_errors": dict(self.held_out_errors),
            "runs": self.runs,
            "cancelled": self.cancelled,
            "sentences": list(self.sentences),
        }


def half_width(error: float) -> float:
    """Return that of the 95 % interval of a standard error from a bootstrap of blocks.

    Examples
    --------
    >>> round(half_width(1.0), 2)
    2.36
    """
    return float(quantile_of(np.array(BLOCKS - 1))) * error


def errors_of(predicted: Array, observed: StickSlipFeatures) -> dict[str, float]:
    """Return the relative errors of predicted features (3,) by name."""
    return dict(zip(COMPARED, map(float, predicted / observed.compared - 1.0), strict=True))


def estimates_of(
    free_parameters: FreeParameters, best: ResidualJacobian, covariance: Array
) -> tuple[tuple[Estimate, ...], Array]:
    """Return what was looked for and which of it no feature tells; its correlation (p, p)."""
    at = free_parameters.coordinates(best.values)
    # what other starts came to with the same features
    alike = np.atleast_2d(best.values if best.memory is None else np.asarray(best.memory))
    low, high = free_parameters.limits()
    to_values = free_parameters.slopes(at)
    table = best.slopes @ to_values
    _, singular, right = np.linalg.svd(table)
    # slopes are known to about the step of their difference quotients
    rank = int(np.sum(singular > NUDGE * singular[0])) if len(singular) else 0
    inverse = to_values @ np.linalg.pinv(table, rcond=NUDGE)
    spread = inverse @ covariance @ inverse.T
    errors = np.sqrt(np.diag(spread))
    sizes = np.where(errors > 0.0, errors, 1.0)
    correlation = spread / np.outer(sizes, sizes)
    np.fill_diagonal(correlation, 1.0)
    # by the share of each coordinate, squared, in changes that leave every feature as it is
    loose = np.sum(right[rank:] ** 2, axis=0) > NUDGE
    found, edge = [], THRESHOLDS.rounding
    for i, (item, value) in enumerate(zip(free_parameters.items, best.values, strict=True)):
        tied = item.above in free_parameters.paths and bool(
            loose[free_parameters.paths.index(item.above)]
        )
        reason = "other values give the same features" if loose[i] or tied else ""
        if not low[i] + edge < at[i] < high[i] - edge and not reason:
            reason = "it reached the end of the search range"
        width = math.inf if reason else half_width(float(errors[i]))
        least = -math.inf if reason else 0.0  # all that is looked for is a size
        found.append(
            Estimate(
                path=item.path,
                quantity=item.quantity,
                value=float(value),
                low=max(float(alike[:, i].min()) - width, least),
                high=float(alike[:, i].max()) + width,
                interval="95 %",
                reason=reason,
            )
        )
    return tuple(found), correlation


def sentences_of(
    estimates: Sequence[Estimate],
    observed: StickSlipFeatures,
    held: StickSlipFeatures | None,
    errors: Mapping[str, float],
) -> tuple[str, ...]:
    """Return what can be said of a fit, in words."""
    part = "fitted part of the record" if held else "record"
    said = [str(one) for one in findings_of(observed, part)]
    if held is not None and _has_drifted(observed, held):
        said.append(
            f"The record drifts: the mean F/N is {number(observed.mean)} in the fitted part and"
            f" {number(held.mean)} in the held-out part; no fixed parameters reproduce both."
        )
    reasons = {e.reason for e in estimates if e.reason}
    for reason in sorted(reasons):
        symbols = ", ".join(e.quantity.symbol for e in estimates if e.reason == reason)
        said.append(f"Frequency, mean and standard deviation do not identify {symbols}: {reason}.")
    missed = [
        f"{name.replace('_', ' ')} by {signed_percent(error)}"
        for name, error in errors.items()
        if is_missed(error)
    ]
    if missed:
        said.append(f"The best limit cycle misses the observed {joined(missed)}.")
    if observed.regime == "stick-slip":
        said.append(
            "A limit cycle repeats exactly: the scatter of an irregular record increases its"
            " standard deviation and appears as larger slips."
        )
    return tuple(said)


def is_missed(error: float) -> bool:
    """Whether a law does not have a feature that it was fitted to, by its relative error.

    Examples
    --------
    >>> is_missed(-0.02), is_missed(0.1), is_missed(float("nan"))
    (False, True, True)
    """
    return not abs(error) <= THRESHOLDS.material


def _has_drifted(observed: StickSlipFeatures, held: StickSlipFeatures) -> bool:
    """Whether the mean changes from part to part by more than its interval, and by what matters."""
    doubt = math.sqrt(observed.covariance[1, 1] + held.covariance[1, 1])
    return abs(held.mean / observed.mean - 1.0) > max(half_width(doubt), THRESHOLDS.material)


def room_of(fit: FeatureFit) -> float:
    """Return the root mean square change of the features from the fitted part to the other.

    It is 0 where nothing was held out.
    """
    if fit.held_out is None:
        return 0.0
    change = np.log(fit.held_out.compared / fit.observed.compared)
    return float(np.sqrt(np.mean(change**2)))


def error_of_score(fit: FeatureFit) -> float:
    """Return the standard error of a held-out score; not a number where nothing was held out.

    Features of both parts are in doubt: those of one are predicted, those of the other judge.
    """
    return _doubt(fit, _slope(fit.held_out_errors))


def paired(other: FeatureFit, best: FeatureFit) -> tuple[float, float]:
    """Return by how much another score is larger, and the standard error of this difference.

    Both are judged by the same features, so what is in doubt of these cancels as far as the laws
    err alike.
    """
    slope = _slope(other.held_out_errors) - _slope(best.held_out_errors)
    return other.score - best.score, _doubt(best, slope)


def as_good(other: FeatureFit, best: FeatureFit) -> bool:
    """Whether a record does not tell another law from the best.

    The difference must exceed one paired standard error, and half of what the features change by
    themselves: a law that misses the fitted part may come nearer to the other by chance.
    """
    if best.held_out is None:
        return other.rms <= best.rms + THRESHOLDS.pattern
    difference, error = paired(other, best)
    room = THRESHOLDS.explained * room_of(best) + THRESHOLDS.pattern
    return difference <= max(error, room)


def _slope(errors: Mapping[str, float]) -> Array:
    """Return the derivative of a score by the logarithms of the features (3,)."""
    left = np.array([errors.get(name, math.nan) for name in COMPARED])
    size = float(np.sqrt(left @ left))
    if size == 0.0:
        return np.full(len(COMPARED), 1.0 / len(COMPARED))
    return np.asarray(left / (size * math.sqrt(len(COMPARED))))


def _doubt(fit: FeatureFit, slope: Array) -> float:
    if fit.held_out is None:
        return math.nan
    covariance = fit.observed.covariance + fit.held_out.covariance
    return math.sqrt(max(float(slope @ covariance @ slope), 0.0))
