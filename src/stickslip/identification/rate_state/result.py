"""What a rate-and-state fit gives back, and what it says about itself."""

import html
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.formatting import estimate, fixed, joined, number, quantities, quantity, signed
from stickslip.identification.estimation.levenberg_marquardt import OptimizeResult
from stickslip.identification.estimation.problem import ResidualJacobian
from stickslip.identification.estimation.sandwich import sandwich
from stickslip.identification.rate_state.law import (
    RateState,
    SliderHistory,
    simulate_velocity_steps,
)
from stickslip.identification.rate_state.problem import BLOCKS, Slider
from stickslip.identification.results import Estimate
from stickslip.quantities import Quantity

__all__ = ["Profile", "RateStateFit", "Window", "free_of", "quantile", "rate_error", "result_of"]

Array: TypeAlias = NDArray[np.float64]

RATE = "friction.direct_effect - friction.evolution_effect"
SAME = 0.05
"""a - b is one number for all windows if it differs by less than this share."""
TOLD = 0.3
"""a and b are told apart where the half widths of both intervals are below this share."""


@final
@dataclass(frozen=True, kw_only=True)
class Window:
    """What a - b comes out as when less of the record is used."""

    after: float
    """Way of the load point after the last step [m]."""
    rate: float
    """a - b."""
    error: float
    """Standard error of a - b."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Profile:
    """Fits with other evolution effects held that the record allows as well as the best."""

    ends: tuple[ResidualJacobian, ...] = ()
    unbounded: bool = False
    """Whether the largest evolution effect tried is still allowed."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class RateStateFit:
    """Rate-and-state friction fitted to velocity steps; made by `fit_rate_state`."""

    law: RateState
    """The fitted law; its reference velocity is the first speed of the load point."""
    stiffness: float
    """Stiffness of spring and machine over the load, d mu / d x [1/m]."""
    drift: float
    """Steady change of the coefficient with the way of the load point [1/m]; 0 without one."""
    estimates: tuple[Estimate, ...]
    """Parameters of the law, stiffness, drift if any, and a - b last."""
    rmse: float
    """Root mean square of measured less fitted coefficient, over all samples used."""
    correlation: float
    """Correlation of the estimates of a and b."""
    separable: bool
    """Whether the record tells a and b apart."""
    windows: tuple[Window, ...]
    """a - b by how much of the record after the last step is used, all of it last."""
    starts_agreeing: int
    """How many starts came to the least cost."""
    sentences: tuple[str, ...]
    """What can be said, in words."""
    time: Array
    """Times of the samples used (n,) [s], from their first on."""
    measured: Array
    """Measured coefficients (n,)."""
    fitted: Array
    """Fitted coefficients (n,), drift included."""
    load_point: Mapping[str, Array]
    """Times [s] and positions [m] between which the load point moves steadily."""

    @property
    def rate(self) -> Estimate:
        """The estimate of a - b."""
        return self.estimates[-1]

    def history(self) -> SliderHistory:
        """Return coefficient, slip speed and state of the fitted slider, without drift."""
        return simulate_velocity_steps(
            self.law,
            stiffness=self.stiffness,
            time=self.load_point["time"],
            pull=self.load_point["position"],
            at=self.time,
        )

    @override
    def __str__(self) -> str:
        """Return law, estimates and error, then the sentences."""
        numbers = "; ".join(str(estimate) for estimate in self.estimates)
        head = (
            f"rate and state ({self.law.evolution}) fitted to {len(self.time)} samples:"
            f" {numbers}; rms error {number(self.rmse, 2)}"
        )
        return "\n".join([head, *self.sentences])

    @override
    def __repr__(self) -> str:
        return f"<RateStateFit: {self.rate}, rms error {number(self.rmse, 2)}>"

    def _repr_html_(self) -> str:
        return "".join(f"<p>{html.escape(line)}</p>" for line in str(self).splitlines())

    def to_dict(self) -> dict[str, Any]:
        """Return the fit as plain numbers and strings."""
        return {
            "law": "rate-and-state",
            "evolution": self.law.evolution,
            "reference_velocity": self.law.reference_velocity,
            "estimates": [estimate.to_dict() for estimate in self.estimates],
            "rmse": self.rmse,
            "correlation_a_b": self.correlation,
            "separable": self.separable,
            "windows": [
                {"after": window.after, "a_minus_b": window.rate} for window in self.windows
            ],
            "samples": len(self.time),
            "sentences": list(self.sentences),
        }


def quantile() -> float:
    """Return the factor of standard errors for 95 %, with as few degrees as there are stretches."""
    from scipy.stats import t

    return float(t.ppf(0.975, BLOCKS - 1))


def free_of(slider: Slider, values: Array) -> NDArray[np.bool_]:
    """Return which unknowns stand at no bound (p,); without b there is no D_c either."""
    low, high = slider.unknowns.limits()
    at = slider.unknowns.coordinates(values)
    free = (at > low) & (at < high)
    if abs(values[1]) < 1e-3 * values[0]:
        free[1:3] = False
    return np.asarray(free)


def result_of(
    slider: Slider, found: OptimizeResult, *, profile: Profile, windows: tuple[Window, ...]
) -> RateStateFit:
    """Return what was found, with intervals and words."""
    values = found.best.values
    fitted = slider.predict(values, slider.record.time)
    assert fitted is not None
    measured = slider.record.coefficient
    covariance = sandwich(found.best, free_of(slider, values))
    correlation = _correlation(found.best, profile)
    estimates = _estimates(slider, values, covariance, profile)
    separable = all(e.bounded and e.high - e.low < 2.0 * TOLD * abs(e.value) for e in estimates[:2])
    return RateStateFit(
        law=slider.law(values),
        stiffness=float(values[3]),
        drift=float(values[5]) if len(values) > 5 else 0.0,
        estimates=estimates,
        rmse=float(np.sqrt(np.mean((measured - fitted) ** 2))),
        correlation=correlation,
        separable=separable,
        windows=windows,
        starts_agreeing=found.agreeing,
        sentences=_sentences(slider, found, estimates, correlation, windows, separable=separable),
        time=slider.record.time,
        measured=measured,
        fitted=fitted,
        load_point={"time": slider.record.path.time, "position": slider.record.path.position},
    )


def _correlation(best: ResidualJacobian, profile: Profile) -> float:
    """Return the correlation of a and b; near b = 0 that at the next b the record allows.

    It is that of independent residuals, which stays defined where a and b cannot be told apart.
    """
    if abs(best.values[1]) < 1e-3 * best.values[0] and profile.ends:
        best = profile.ends[0]
    others = np.delete(best.slopes, [0, 1], axis=1)
    others = others / np.maximum(np.linalg.norm(others, axis=0), 1e-300)
    both = best.slopes[:, :2]
    left = both - others @ np.linalg.lstsq(others, both, rcond=None)[0]
    size = math.prod(map(float, np.linalg.norm(left, axis=0)))
    return float(np.clip(-(left[:, 0] @ left[:, 1]) / size, -1.0, 1.0)) if size > 0.0 else 0.0


def _estimates(
    slider: Slider, values: Array, covariance: Array, profile: Profile
) -> tuple[Estimate, ...]:
    """Return all unknowns and a - b, each with its standard error widened by the profile."""
    wide = quantile()
    errors = np.sqrt(np.diag(covariance))
    others = np.array([end.values for end in profile.ends]).reshape(-1, len(values))
    found = []
    for i, item in enumerate(slider.unknowns.items):
        reason = ""
        low, high = _hull(values[i], wide * errors[i], others[:, i])
        if i < 2 and profile.unbounded:
            high, reason = math.inf, "larger a and b of the same difference fit as well"
        if i < 2 and not np.isfinite(low):
            low = values[i]
        low, high = max(low, item.low), min(high, item.high) if i > 1 else high
        if item.low == item.high:
            low, high, reason = values[i], values[i], "given"
        found.append([item.path, item.quantity, values[i], low, high, reason])
    if found[1][3] <= 0.0 <= found[1][4]:
        found[2][3:] = [-math.inf, math.inf, "b may be 0, and then D_c has no effect"]
    rates = others[:, 0] - others[:, 1]
    low, high = _hull(values[0] - values[1], wide * rate_error(covariance), rates)
    found.append([RATE, Quantity("a - b"), values[0] - values[1], low, high, ""])
    return tuple(
        Estimate(
            path=path,
            quantity=quantity,
            value=float(value),
            low=float(low),
            high=float(high),
            interval="known" if reason == "given" else "95 %",
            reason=reason,
        )
        for path, quantity, value, low, high, reason in found
    )


def rate_error(covariance: Array) -> float:
    """Return the standard error of a - b."""
    variance = covariance[0, 0]
    if np.isfinite(covariance[1, 1]):
        variance += covariance[1, 1] - 2.0 * covariance[0, 1]
    return math.sqrt(max(float(variance), 0.0))


def _hull(value: float, half_width: float, others: Array) -> tuple[float, float]:
    """Return the interval of a standard error together with values that fit as well."""
    low, high = value - half_width, value + half_width
    if len(others):
        low, high = min(low, float(others.min())), max(high, float(others.max()))
    return low, high


def _sentences(
    slider: Slider,
    found: OptimizeResult,
    estimates: Sequence[Estimate],
    correlation: float,
    windows: Sequence[Window],
    *,
    separable: bool,
) -> tuple[str, ...]:
    speeds = joined(quantities(slider.record.path.speeds.tolist(), "m/s"))
    said = [f"The load point moves at {speeds}.", _about_rate(estimates[-1])]
    if separable:
        said.append(
            f"a and b are told apart (correlation {fixed(correlation, 2)}): friction changes at"
            " once, and"
            f" settles over {quantity(found.best.values[2], 'm')}."
        )
    else:
        said.append(
            f"a and b are not separable on this record (correlation {fixed(correlation, 2)}):"
            " only a - b"
            " is known."
        )
    if estimates[2].reason:
        said.append(f"D_c is not bounded: {estimates[2].reason}.")
    if len(found.best.values) > 5:
        drift = found.best.values[5] * 1e-3
        said.append(
            f"Friction drifts by {signed(drift, 2)} per mm of the load point beside the law; a -"
            " b and a"
            " drift trade against each other."
        )
    said += _about_windows(windows)
    if found.agreeing == 1 and len(found.costs) > 1:
        said.append(f"Only one of {len(found.costs)} starts came to the least cost.")
    if found.cancelled:
        said.append("The search was stopped before its end.")
    return tuple(said)


def _about_rate(rate: Estimate) -> str:
    sign = "either sign of a - b is possible"
    if rate.low > 0.0:
        sign = "friction grows with speed, and steady sliding is stable"
    elif rate.high < 0.0:
        sign = "friction falls with speed, and soft springs make it slide by fits and starts"
    return f"{rate}, {rate.interval}: {sign}."


def _about_windows(windows: Sequence[Window]) -> list[str]:
    if not windows:
        return []
    last = windows[-1]
    apart = [
        abs(w.rate - last.rate)
        > max(quantile() * math.hypot(w.error, last.error), SAME * abs(last.rate))
        for w in windows[:-1]
    ]
    if not any(apart):
        return []
    told = ", ".join(f"{estimate(w.rate, w.error)} with {quantity(w.after, 'm')}" for w in windows)
    return [
        f"a - b depends on how much is used after the last step: {told}. The law does not describe"
        " the whole record; the interval holds for the part used."
    ]
