"""What a rate-and-state fit gives back, and what it says about itself."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Finding, LawEstimates, Measurement, sentences_of
from stickslip.errors import InputError
from stickslip.friction import RateState
from stickslip.identify import THRESHOLDS
from stickslip.identify.fits import (
    BLOCKS,
    Estimate,
    Fit,
    Inference,
    OptimizeResult,
    ResidualJacobian,
    effective_size,
    estimates_for,
    infer,
)
from stickslip.identify.kinds.velocity_steps.problem import (
    DIRECT,
    EVOLVED,
    PATHS,
    SECOND,
    STRESS,
    Slider,
    record_of,
)
from stickslip.identify.kinds.velocity_steps.slider import SliderHistory, simulate_velocity_steps
from stickslip.mechanisms import TowedBlock
from stickslip.quantities import Quantity
from stickslip.show.formatting import estimate as estimated
from stickslip.show.formatting import fixed, joined, number, quantities, quantity, ratio, signed

if TYPE_CHECKING:
    from stickslip.show.display import Drawing, Target

Array: TypeAlias = NDArray[np.float64]

VELOCITY_STEPS = "rate-state"
TOLD = 0.3
"""a and b are told apart where the half widths of both intervals are below this share."""
HELD = "given"
"""Reason of what was not looked for."""
ROOM = 3.0
"""Effective number of rows of a block where there are more blocks than usual.

The variance of a block's sum is a sixth short then, as neighbouring blocks go together; intervals
held in 28 to 30 of 30 records (decision 0032).
"""
MOST_BLOCKS = 100
REMEMBERED = 0.25
"""Effective over actual sample size of the residuals below which they are no noise of samples."""
SETTLED = 8.0
"""Way over which friction settles after a step, in critical distances: a change by e^-8 is left."""


@dataclass(frozen=True, kw_only=True)
class Window:
    """What a - b comes out as when less of the record is used."""

    after: float
    """Way of the load point after the last step [m]."""
    rate: float
    """a - b."""
    half_width: float
    """Half the width of its 95 % interval; infinite where that cannot be said.

    Of less than all, it is that of independent residuals times what dependence makes of that of the
    whole: blocks of what is left would be too short.
    """


@dataclass(frozen=True, kw_only=True, eq=False)
class Profile:
    """Fits with other evolution effects held that the record allows as well as the best."""

    ends: tuple[ResidualJacobian, ...] = ()
    """Residuals and slopes of those fits."""
    unbounded: bool = False
    """Whether the largest evolution effect tried is still allowed."""


NO_PROFILE = Profile()


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class RateStateFit(Fit[RateState]):
    """Rate-and-state friction fitted to velocity steps; made by `fit_rate_state`.

    `law` has the reference velocity that it was given, or the first speed of the load point;
    `mechanism` the fitted stiffness. `RateState` is no law of a rig file, so `to_toml` and `save`
    refuse it; `to_dict` and `history` have its numbers.
    """

    mechanism: TowedBlock
    """The machine, with the fitted stiffness and the mean load."""
    measurement: Measurement
    """The whole record."""
    drift: float
    """Steady change of the coefficient with the way of the load point [1/m]; 0 without one."""
    rate: Estimate
    """a - b, less b_2 of a second state: how friction changes with speed in the long run."""
    rmse: float
    """Root mean square of measured less fitted coefficient, over all samples used."""
    correlation: float
    """Correlation of the estimates of a and b; 0 where not both were fitted."""
    separable: bool
    """Whether the record tells a and b apart."""
    windows: tuple[Window, ...]
    """a - b by how much of the record after the last step is used, all of it last."""
    findings: tuple[Finding, ...]
    """What can be said: of speeds, ``"rate"``, ``"separation"``, ``"distance"``, ``"drift"``..."""
    time: Array
    """Times of the samples used (n,) [s], from their first on."""
    measured: Array
    """Measured coefficients (n,)."""
    fitted: Array
    """Fitted coefficients (n,), drift included."""
    load_point: Mapping[str, Array]
    """Times [s] and positions [m] between which the load point moves steadily."""
    problem: Slider
    """The record as residuals."""
    optimum: OptimizeResult
    """The least cost found, and what each start came to."""
    inference: Inference
    """Covariance of the fitted values, those that were held included."""

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.identify.kinds.velocity_steps.figures import draw_coefficient
        from stickslip.show.plots import MAP_SIZES, on_axes

        draw = draw_coefficient(self.time, self.measured, self.fitted, self.law.title)
        return on_axes(draw, ax, MAP_SIZES["wide"])

    @property
    def best(self) -> ResidualJacobian:
        """Residuals and slopes at the fitted values."""
        return self.optimum.best

    @property
    def starts_agreeing(self) -> int:
        """How many starts came to the least cost."""
        return self.optimum.agreeing

    @property
    def stiffness(self) -> float:
        """Stiffness of spring and machine over the load, d mu / d x [1/m]."""
        return float(self.best.values[3])

    @property
    def rms(self) -> float:
        """Root mean square of the residuals, means over short stretches of long records."""
        return self.best.rms

    @property
    def rate_symbols(self) -> tuple[str, ...]:
        """Symbols of what the rate is the difference of: a and b, and b_2 of a second state."""
        return tuple(self.rate.quantity.symbol.split(" - "))

    @property
    def over_scatter(self) -> float:
        """Residuals over what the scatter of neighbouring samples would leave; 0 without any."""
        scatter = float(np.std(np.diff(self.measured)) / math.sqrt(2.0))
        return self.rmse / scatter if scatter > 0.0 else 0.0

    @property
    def misses(self) -> bool:
        """Whether what the fit leaves is not noise alone, as far as neighbouring samples tell.

        The law misses something then, or the noise remembers more than a few samples.
        """
        remembered = self.inference.effective < REMEMBERED * len(self.best.residual)
        return remembered or self.over_scatter > THRESHOLDS.misfit

    def history(self) -> SliderHistory:
        """Return coefficient, slip speed and state of the fitted slider, without drift."""
        return simulate_velocity_steps(
            self.law,
            stiffness=self.stiffness,
            time=self.load_point["time"],
            pull=self.load_point["position"],
            at=self.time,
        )

    def judged(self, measurement: Measurement, *, since: float = -math.inf) -> float:
        """Return the root mean square error of the coefficient in another record of this machine.

        Parameters
        ----------
        measurement : Measurement
            One record with ``time``, ``pull`` and ``friction``.
        since : float
            Time [s] from which samples are compared; all are run through.

        Returns
        -------
        float
            Error of the coefficient, drift included; infinite if the slider runs away.

        Raises
        ------
        InputError
            If there are no samples from that time on.
        """
        record = record_of(measurement, self.problem.record.load)
        other = Slider.of(
            record,
            self.problem.form,
            self.problem.free_parameters,
            self.law.reference_velocity,
            regularised=self.law.regularised,
        )
        seen, late = (
            other.linearise(self.best.values, slopes=False),
            other.times + record.begins >= since,
        )
        if not late.any():
            raise InputError(f"there are no samples from {quantity(since, 's')} on.")
        weight = other.weight[late]
        return float(np.sqrt(np.sum(seen.residual[late] ** 2) / np.sum(weight**2)))

    def law_estimates(self) -> LawEstimates:
        own = [
            i for i, item in enumerate(self.problem.free_parameters.items) if item.low < item.high
        ]
        return estimates_for(
            self.law,
            self.estimates,
            self.inference.correlation[np.ix_(own, own)],
            levels="per load",
            largest_speed=float(self.problem.record.path.lasting.max()),
        )

    @property
    def sentences(self) -> tuple[str, ...]:
        """The findings in words."""
        return sentences_of(self.findings)

    def __str__(self) -> str:
        """Return law, estimates and error, then the sentences."""
        numbers = "; ".join(str(estimate) for estimate in (*self.estimates, self.rate))
        head = (
            f"{self.law.title} fitted to {len(self.time):,} samples: {numbers}; rms error"
            f" {number(self.rmse, 2)}"
        )
        return "\n".join([head, *self.sentences])

    def __repr__(self) -> str:
        return f"<RateStateFit: {self.law.title}, {self.rate}, rms error {number(self.rmse, 2)}>"

    def _notes(self) -> Sequence[str]:
        return self.sentences

    def to_dict(self) -> Mapping[str, Any]:
        return {
            "law": self.law.name,
            "route": VELOCITY_STEPS,
            "evolution": self.law.evolution,
            "reference_velocity": self.law.reference_velocity,
            "estimates": [estimate.to_dict() for estimate in self.estimates],
            "a_minus_b": self.rate.to_dict(),
            "stiffness_over_load": self.stiffness,
            "drift": self.drift,
            "rmse": self.rmse,
            "correlation_a_b": self.correlation,
            "separable": self.separable,
            "windows": [
                {"after": window.after, "a_minus_b": window.rate} for window in self.windows
            ],
            "samples": len(self.time),
            "cancelled": self.cancelled,
            "sentences": list(self.sentences),
        }


def free_of(slider: Slider, values: Array) -> NDArray[np.bool_]:
    """Return which unknowns are at no bound (p,); a state without effect has no distance."""
    low, high = slider.free_parameters.limits()
    at = slider.free_parameters.coordinates(values)
    free = (at > low) & (at < high)
    for effect in (EVOLVED, SECOND):
        if abs(values[effect]) < THRESHOLDS.negligible * abs(values[DIRECT]):
            free[[effect, effect + 1]] = False
    return np.asarray(free)


def bounds_met(fit: RateStateFit) -> tuple[str, ...]:
    """Return the symbols of what ended at a bound of the search; 0 is a limit of effects."""
    low, high = fit.problem.free_parameters.limits()
    at = fit.problem.free_parameters.coordinates(fit.best.values)
    met = (low < high) & ((at <= low) | (at >= high))
    for effect in (EVOLVED, STRESS, SECOND):
        met[effect] = met[effect] and at[effect] >= high[effect]
    items = zip(fit.problem.free_parameters.items, met, strict=True)
    return tuple(item.quantity.symbol for item, one in items if one)


def inference_of(slider: Slider, best: ResidualJacobian) -> Inference:
    """Return covariances of the values (p,), from leaving out blocks of the record."""
    scale = slider.free_parameters.slopes(slider.free_parameters.coordinates(best.values))
    scale[:, ~free_of(slider, best.values)] = 0.0
    return infer(best, scale, blocks=blocks_of(best))


def rate_of(
    slider: Slider, best: ResidualJacobian, inference: Inference | None = None
) -> tuple[float, float, float]:
    """Return a - b - b_2, half its 95 % interval, and its error of independent residuals."""
    rate = slider.law(best.values).rate
    row = np.zeros(len(best.values))
    row[[DIRECT, EVOLVED, SECOND]] = 1.0, -1.0, -1.0
    row[~free_of(slider, best.values)] = 0.0
    found = inference_of(slider, best) if inference is None else inference
    if not row.any():
        return rate, 0.0, 0.0
    kept = row != 0.0
    naive = float(row[kept] @ found.naive[np.ix_(kept, kept)] @ row[kept])
    return rate, found.half_width(row), math.sqrt(max(naive, 0.0))


def result_of(
    block: TowedBlock,
    measurement: Measurement,
    slider: Slider,
    optimum: OptimizeResult,
    *,
    profile: Profile = NO_PROFILE,
    windows: tuple[Window, ...] = (),
) -> RateStateFit:
    """Return what was found, with intervals and words."""
    values, record = optimum.best.values, slider.record
    fitted = slider.predict(values, record.time)
    assert fitted is not None
    inference = inference_of(slider, optimum.best)
    everyone = _estimates(slider, optimum.best, inference, profile)
    a, b = everyone[:2]
    both = HELD not in (a.reason, b.reason)
    separable = both and all(e.bounded and e.half_width < TOLD * abs(e.value) for e in (a, b))
    fit = RateStateFit(
        law=slider.law(values),
        mechanism=replace(block, load=record.load, stiffness=float(values[3]) * record.load),
        measurement=measurement,
        estimates=tuple(e for e in everyone if e.reason != HELD),
        cancelled=optimum.cancelled,
        drift=float(values[len(PATHS)]) if len(values) > len(PATHS) else 0.0,
        rate=_rate(slider, optimum.best, inference, profile),
        rmse=float(np.sqrt(np.mean((record.coefficient - fitted) ** 2))),
        correlation=_correlation(slider, optimum.best, profile) if both else 0.0,
        separable=separable,
        windows=windows,
        findings=(),
        time=record.time,
        measured=record.coefficient,
        fitted=fitted,
        load_point={"time": record.path.time, "position": record.path.position},
        problem=slider,
        optimum=optimum,
        inference=inference,
    )
    return replace(fit, findings=_findings(fit, optimum), remarks=_remarks(fit))


def blocks_of(best: ResidualJacobian) -> int:
    """Return how many blocks of a record are left out in turn: at least the usual number.

    A step is over soon, and what one block alone shows has no interval. There are more blocks where
    each still holds several times the correlated rows.
    """
    return int(np.clip(effective_size(best) / ROOM, BLOCKS, MOST_BLOCKS))


def _correlation(slider: Slider, best: ResidualJacobian, profile: Profile) -> float:
    """Return the correlation of a and b; near b = 0 that at the next b the record allows.

    It is that of independent residuals, which stays defined where a and b cannot be told apart.
    """
    if abs(best.values[1]) < THRESHOLDS.negligible * abs(best.values[0]) and profile.ends:
        best = slider.linearise(profile.ends[0].values)
    others = np.delete(best.slopes, [0, 1], axis=1)
    others = others / np.maximum(np.linalg.norm(others, axis=0), 1e-300)
    both = best.slopes[:, :2]
    left = both - others @ np.linalg.lstsq(others, both, rcond=None)[0]
    size = math.prod(map(float, np.linalg.norm(left, axis=0)))
    return float(np.clip(-(left[:, 0] @ left[:, 1]) / size, -1.0, 1.0)) if size > 0.0 else 0.0


def _estimates(
    slider: Slider, best: ResidualJacobian, inference: Inference, profile: Profile
) -> list[Estimate]:
    """Return all unknowns, those that are held too, each interval widened by the profile."""
    values, load = best.values, slider.record.load
    others = np.array([end.values for end in profile.ends]).reshape(-1, len(values))
    found: list[Estimate] = []
    for i, item in enumerate(slider.free_parameters.items):
        unit = load if item.path == PATHS[3] else 1.0
        quantity = Quantity("k", "N/m", above=0) if item.path == PATHS[3] else item.quantity
        known = item.low == item.high
        low, high = _hull(values[i], 0.0 if known else _width(inference, i), others[:, i])
        reason = HELD if known else inference.reasons[i] if not math.isfinite(low + high) else ""
        if i < 2 and profile.unbounded:
            high, reason = math.inf, "larger a and b of the same difference fit as well"
        if i < 2 and profile.ends and not math.isfinite(low):
            low = values[i]
        low = max(low, item.low)
        high = high if i in (DIRECT, EVOLVED, SECOND) else min(high, item.high)
        found.append(
            Estimate(
                path=item.path,
                quantity=quantity,
                value=float(values[i]) * unit,
                low=float(low) * unit,
                high=float(high) * unit,
                interval="known" if known else "95 %",
                reason=reason,
            )
        )
    for i in (EVOLVED, SECOND):
        b, D = found[i : i + 2]
        if HELD not in (b.reason, D.reason) and b.low <= 0.0 <= b.high:
            symbols = b.quantity.symbol, D.quantity.symbol
            why = "{} may be 0, and then {} has no effect".format(*symbols)
            found[i + 1] = replace(D, low=-math.inf, high=math.inf, reason=why)
    return found


def _width(inference: Inference, index: int) -> float:
    """Return half the width of the 95 % interval of a value; infinite where none can be said."""
    return inference.half_width(np.eye(len(inference.reasons))[index])


def _rate(
    slider: Slider, best: ResidualJacobian, inference: Inference, profile: Profile
) -> Estimate:
    """Return the estimate of a - b, less b_2 of a second state."""
    rate, width, _ = rate_of(slider, best, inference)
    others = np.array([slider.law(end.values).rate for end in profile.ends])
    low, high = _hull(rate, width, others)
    known = slider.free_parameters.items[0].low == slider.free_parameters.items[0].high
    return Estimate(
        path=" - ".join(PATHS[i] for i in (DIRECT, EVOLVED, SECOND)[: 2 + slider.form.second]),
        quantity=Quantity("a - b - b_2" if slider.form.second else "a - b"),
        value=rate,
        low=low,
        high=high,
        interval="known" if known else "95 %",
        reason=HELD if known else "" if math.isfinite(width) else "the record does not tell it",
    )


def _hull(value: float, half_width: float, others: Array) -> tuple[float, float]:
    """Return the interval of a standard error together with values that fit as well."""
    low, high = value - half_width, value + half_width
    if len(others):
        low, high = min(low, float(others.min())), max(high, float(others.max()))
    return float(low), float(high)


def _findings(fit: RateStateFit, found: OptimizeResult) -> tuple[Finding, ...]:
    path, rate = fit.problem.record.path, " − ".join(fit.rate_symbols)
    fitted = {e.path: e for e in fit.estimates}
    said = [
        ("speeds", f"The load point moves at {joined(quantities(path.lasting.tolist(), 'm/s'))}.")
    ]
    if fit.rate.reason != HELD:
        said.append(("rate", _about_rate(fit.rate, rate)))
    if PATHS[0] in fitted and PATHS[1] in fitted:
        said.append(("separation", _about_separation(fit, rate)))
    said += [
        ("distance", f"{fitted[path].quantity.symbol} is not bounded: {fitted[path].reason}.")
        for path in (PATHS[EVOLVED + 1], *PATHS[STRESS:])
        if path in fitted and fitted[path].reason
    ]
    if fit.drift:
        text = (
            f"Friction drifts by {signed(1e-3 * fit.drift, 2)} per mm of the load point beside the"
            f" law; {rate} and a drift trade against each other."
        )
        said.append(("drift", text))
    said += [("length", line) for line in _about_windows(fit.windows, rate)]
    if found.agreeing == 1 and len(found.costs) > 1:
        said.append(("search", f"Only one of {len(found.costs)} starts came to the least cost."))
    if found.cancelled:
        said.append(("search", "The search was stopped before its end."))
    return tuple(Finding(kind=kind, sentence=sentence) for kind, sentence in said)


def _about_separation(fit: RateStateFit, rate: str) -> str:
    correlation = fixed(fit.correlation, 2)
    if fit.separable and fit.law.states:
        distances = joined([quantity(distance, "m") for _, distance in fit.law.states])
        return (
            f"a and b are told apart (correlation {correlation}): friction changes at once, and"
            f" settles over {distances}."
        )
    return (
        f"a and b are not separable on this record (correlation {correlation}): only {rate} is"
        " known."
    )


def _about_rate(rate: Estimate, symbols: str) -> str:
    sign = f"either sign of {symbols} is possible"
    if rate.low > 0.0:
        sign = "friction grows with speed, and steady sliding is stable"
    elif rate.high < 0.0:
        sign = "friction falls with speed, and stick-slip is possible on soft springs"
    return f"{rate}, {rate.interval}: {sign}."


def _about_windows(windows: Sequence[Window], rate: str) -> list[str]:
    if not windows:
        return []
    last = windows[-1]
    apart = []
    for w in windows[:-1]:
        # the whole has the part in it: of their difference, variances subtract (Hausman)
        width = math.sqrt(max(w.half_width**2 - last.half_width**2, 0.0))
        apart.append(abs(w.rate - last.rate) > max(width, THRESHOLDS.material * abs(last.rate)))
    if not any(apart):
        return []
    told = ", ".join(
        f"{estimated(w.rate, w.half_width)} with {quantity(w.after, 'm')}" for w in windows
    )
    return [
        f"{rate} depends on the length of record used after the last step: {told}. The law does"
        " not describe the whole record; the interval holds for the part used."
    ]


def _remarks(fit: RateStateFit) -> tuple[str, ...]:
    """Return what the fit leaves out of the mechanism."""
    law, block = fit.law, fit.mechanism
    fastest = float(fit.problem.record.path.lasting.max())
    swing = math.sqrt(block.mass / block.stiffness)
    # without a state, friction follows the load point over the way a/k
    way = abs(law.direct_effect) / fit.stiffness
    spent = [
        distance for b, distance in law.states if b > THRESHOLDS.negligible * law.direct_effect
    ]
    if spent:
        way = min(spent)
    if not way > 0.0:
        return ()
    told = (
        f"sqrt(m/k) = {quantity(swing, 's', 2)} is {ratio(swing * fastest / way)} the"
        f" {quantity(way / fastest, 's', 2)} that the slider takes for"
        f" {quantity(way, 'm', 2)} at the highest speed"
    )
    # a period of the block
    matters = "could" if 2.0 * math.pi * swing * fastest > way else "does not"
    return (f"The fit neglects the mass, which {matters} matter: {told}.",)
