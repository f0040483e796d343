"""What the uncertainties of a mechanism's parameters make of travels, to first order."""

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.identification import READINGS, TravelModel, Trial, span_of
from stickslip.quantities import vary

Array: TypeAlias = NDArray[np.float64]


@final
@dataclass(frozen=True, kw_only=True)
class Propagated:
    """Standard errors of travels [m] from those of the mechanism's parameters, by path.

    What was set anew for each trial adds to the variance of that trial alone; what all trials share
    moves all of them together, so that its entries have a sign.
    """

    own: Mapping[str, Array]
    """Standard errors of what was set anew for each trial (n,) [m], by path."""
    shared: Mapping[str, Array]
    """Those of what all trials share (n,) [m], with signs."""

    def scaled(self, factor: float) -> "Propagated":
        """Return all of it times a factor."""
        return Propagated(
            own={path: factor * part for path, part in self.own.items()},
            shared={path: factor * part for path, part in self.shared.items()},
        )

    def scatter(self, errors: Array) -> Array:
        """Return standard errors (n,) of what differs from trial to trial, readings included."""
        return np.sqrt(errors**2 + sum(part**2 for part in self.own.values()))

    def sources(self, errors: Array, gain: Array) -> list[dict[str, float]]:
        """Return the standard errors of parameters by where they come from."""
        open_ = np.any(~np.isfinite(gain), axis=1, keepdims=True)
        gain = np.where(open_, 0.0, gain)
        parts = {READINGS: np.linalg.norm(gain * errors, axis=1)}
        for path, part in self.own.items():
            parts[path] = np.linalg.norm(gain * part, axis=1)
        for path, part in self.shared.items():
            parts[path] = np.hypot(parts.get(path, 0.0), np.abs(gain @ part))
        return [
            {path: math.inf if open_[i, 0] else float(part[i]) for path, part in parts.items()}
            for i in range(len(gain))
        ]


def covariance_of(scatter: Array, shared: Mapping[str, Array]) -> Array:
    """Return the covariance of travels (n, n) [m^2].

    That is the covariance which a nuisance parameter with a Gaussian prior leaves once it is
    integrated out, so that estimates are those of least squares with a row for each.

    Examples
    --------
    >>> covariance_of(np.array([1.0, 1.0]), {"mechanism.mass": np.array([1.0, 2.0])}).tolist()
    [[2.0, 2.0], [2.0, 5.0]]
    """
    parts = (np.outer(part, part) for part in shared.values())
    return np.asarray(sum(parts, np.diag(np.square(scatter))))


def agreeing_scale(
    left: Array, errors: Array, freedom: int, covariance: Callable[[float], Array]
) -> float:
    """Return the variance of readings with which residuals agree, over that stated; at least 1.

    It scales the readings alone: what trials share or set does not follow from residuals.

    Examples
    --------
    >>> left, errors = np.array([3.0, -1.0, 2.0]), np.ones(3)
    >>> f"{agreeing_scale(left, errors, 2, lambda scale: scale * np.eye(3)):.3f}"
    '7.000'
    """
    from scipy.optimize import brentq

    def excess(logarithm: float) -> float:
        return float(left @ np.linalg.solve(covariance(math.exp(logarithm)), left)) - freedom

    most = math.log(max(float(np.sum((left / errors) ** 2)) / freedom, 1.0)) + 1.0
    return math.exp(float(brentq(excess, 0.0, most))) if excess(0.0) > 0.0 else 1.0


def propagated(model: TravelModel, trials: Sequence[Trial], values: Sequence[float]) -> Propagated:
    """Return what the uncertainties of the mechanism make of each travel.

    The slopes are those of the law at `values`, not of what was measured: a covariance that follows
    the readings' own noise biases estimates (Peelle's puzzle).
    """
    slopes: dict[tuple[Hashable, str], float] = {}

    def errors(path: str, doubts: Sequence[Mapping[str, float]]) -> Array:
        found = []
        for trial, doubt in zip(trials, doubts, strict=True):
            key = trial.run, path
            if path in doubt and key not in slopes:
                slopes[key] = _slope(model, trial, values, path, doubt[path])
            found.append(slopes[key] * doubt[path] if path in doubt else 0.0)
        return np.array(found)

    own, shared = [trial.doubts for trial in trials], [trial.shared for trial in trials]
    return Propagated(
        own={path: errors(path, own) for path in dict.fromkeys(p for one in own for p in one)},
        shared={
            path: errors(path, shared) for path in dict.fromkeys(p for one in shared for p in one)
        },
    )


def _slope(
    model: TravelModel, trial: Trial, values: Sequence[float], path: str, doubt: float
) -> float:
    """Return the derivative of the travel by a parameter of the mechanism, inside its range."""
    ends = span_of(trial.mechanism, path, doubt)
    low, high = (
        model.travel(trial.with_mechanism(vary(trial.mechanism, "mechanism", {path: end})), values)
        for end in ends
    )
    return (high - low) / (ends[1] - ends[0])
