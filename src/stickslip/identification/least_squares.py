"""Several travels: weighted least squares, errors from the stated uncertainty and the residuals."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError
from stickslip.identification.exact import room_for
from stickslip.identification.results import Estimate, TravelFit
from stickslip.identification.travel import TravelModel, Trial
from stickslip.quantities import Quantity, parameters

if TYPE_CHECKING:
    import lmfit

__all__ = ["fit_several"]

ROUNDING_VARIANCE = 1.0 / 3.0
"""Of a uniform distribution, over the square of its half width."""
LEAST_UNCERTAINTY = 1e-3
"""Share of the mean travel taken as standard error where none is stated."""


def fit_several(model: TravelModel, trials: Sequence[Trial]) -> TravelFit:
    """Fit the free parameters to all trials."""
    import lmfit

    measured = np.array([trial.travel for trial in trials])
    errors = _standard_errors(trials)
    known = {path: (quantity, value) for path, quantity, value in parameters(model.law, "friction")}
    unknowns = lmfit.Parameters()
    for i, path in enumerate(model.free):
        low, high = room_for(model.law, path.rpartition(".")[2])
        value = min(max(known[path][1] or 0.1, low * 1.001), high * 0.999)
        unknowns.add(f"u{i}", value=value, min=low, max=high)

    def residual(values: "lmfit.Parameters") -> NDArray[np.float64]:
        point = [values[f"u{i}"].value for i in range(len(model.free))]
        predicted = np.array([model.travel(trial, point) for trial in trials])
        weighted: NDArray[np.float64] = (measured - predicted) / errors
        return weighted

    result = lmfit.minimize(residual, unknowns, method="least_squares", scale_covar=False)
    if not result.success:
        raise ConvergenceError(f"the fit of {', '.join(model.free)} ended: {result.message}")
    best = [float(result.params[f"u{i}"].value) for i in range(len(model.free))]
    freedom = len(trials) - len(best)
    excess = max(1.0, float(np.sum(np.square(result.residual))) / freedom) if freedom else 1.0
    return TravelFit(
        law=model.with_values(best),
        mechanism=trials[0].mechanism,
        estimates=tuple(
            _estimate(path, known[path][0], result.params[f"u{i}"], excess, freedom)
            for i, path in enumerate(model.free)
        ),
        measured=tuple(measured.tolist()),
        predicted=tuple((measured - result.residual * errors).tolist()),
        runs=model.runs,
    )


def _standard_errors(trials: Sequence[Trial]) -> NDArray[np.float64]:
    """Return a standard error for each travel [m]."""
    rounded = math.sqrt(ROUNDING_VARIANCE)
    widths = np.array([t.half_width * (rounded if t.kind == "rounding" else 1.0) for t in trials])
    least = LEAST_UNCERTAINTY * float(np.mean([abs(trial.travel) for trial in trials]))
    return np.where(widths > 0, widths, least)


def _estimate(
    path: str, quantity: Quantity, found: "lmfit.Parameter", excess: float, freedom: int
) -> Estimate:
    """Return an estimate with a 95 % interval, widened where the residuals exceed their errors."""
    from scipy import stats

    value, error = float(found.value), found.stderr
    reason = ""
    if error is None or not math.isfinite(error) or error > 1e6 * abs(value) + 1e-300:
        spread, reason = math.inf, "the trials do not depend on it enough"
    else:
        quantile = stats.t.ppf(0.975, freedom) if excess > 1.0 else stats.norm.ppf(0.975)
        spread = float(quantile * error * math.sqrt(excess))
    return Estimate(
        path=path,
        quantity=quantity,
        value=value,
        low=max(value - spread, found.min) if math.isfinite(spread) else -math.inf,
        high=value + spread,
        interval="95 %",
        reason=reason,
    )
