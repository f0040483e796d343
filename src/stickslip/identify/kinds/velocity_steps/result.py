"""What a rate-and-state fit gives back, and what it says about itself."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.data import Finding, LawEstimates, Measurement, sentences_of
from stickslip.errors import ConvergenceError, InputError
from stickslip.friction import RateState
from stickslip.identify import THRESHOLDS
from stickslip.identify.bands import ENDS, Array, PredictionBand
from stickslip.identify.fits import Estimate, Fit, estimates_for
from stickslip.identify.judgement import ASSERTED
from stickslip.identify.kinds.velocity_steps.slider import SliderHistory, simulate_velocity_steps
from stickslip.identify.problems.travels import UNTOLD
from stickslip.identify.problems.velocity_steps import (
    DIRECT,
    DISTANCE,
    EVOLVED,
    FURTHER,
    LEVEL,
    SECOND,
    STIFFNESS,
    STRESS,
    VelocitySteps,
    record_of,
)
from stickslip.identify.simulated import WHITE, FamilyPosterior, SimulatedPosterior
from stickslip.mechanisms import TowedBlock
from stickslip.quantities import Quantity, fields_of
from stickslip.show.formatting import fixed, joined, number, quantities, quantity, ratio

if TYPE_CHECKING:
    from stickslip.show.display import Drawing, Target

VELOCITY_STEPS = "rate-state"
ORDER = (DIRECT, EVOLVED, DISTANCE, STIFFNESS, LEVEL, STRESS, SECOND, FURTHER)
"""Parameters in the order in which they are told."""
TOLD = 0.3
"""a and b are told apart where the half widths of both intervals are below this share."""
SETTLED = 8.0
"""Way over which friction settles after a step, in critical distances: a change by e^-8 is left."""


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
    name: str
    """Name of the law among those that were compared."""
    problem: VelocitySteps = field(repr=False)
    """The record as rows, and its priors."""
    posterior: SimulatedPosterior = field(repr=False)
    """The posterior that all is read from."""

    @property
    def family(self) -> FamilyPosterior:
        """What the posterior says of this law."""
        return self.posterior.families[self.name]

    @cached_property
    def draws(self) -> Mapping[str, Array]:
        """Draws (k,) of the parameters, SI, by name; the stiffness is over the load."""
        found = self.problem.values(self.name, self.family.points)
        return {**found, LEVEL: self.family.coefficients[:, 0]}

    @cached_property
    def rate(self) -> Estimate:
        """A - b, less b_2 of a second state: how friction changes with speed in the long run."""
        names = [name for name in (DIRECT, EVOLVED, SECOND) if name in self.draws]
        known = not {*names} & {*self.family.unknowns.names}
        draws = _rate(self.draws)
        low, high = np.quantile(draws, ENDS)
        value = self.law.rate
        return Estimate(
            path=" - ".join(f"friction.{name}" for name in names) or f"friction.{DIRECT}",
            quantity=Quantity(" - ".join(self.rate_symbols)),
            value=value,
            low=min(float(low), value),
            high=max(float(high), value),
            interval="known" if known else "95 %",
            reason="given" if known else "",
        )

    @property
    def rate_symbols(self) -> tuple[str, ...]:
        """Symbols of what the rate is the difference of: a and b, and b_2 of a second state."""
        return ("a", "b", "b_2")[: max(2, 1 + len(self.law.states))]

    @property
    def time(self) -> Array:
        """Times of the samples used (n,) [s], from their first on."""
        return self.problem.record.time

    @property
    def measured(self) -> Array:
        """Measured coefficients (n,)."""
        return self.problem.record.coefficient

    @cached_property
    def fitted(self) -> Array:
        """Fitted coefficients (n,), with what changes along the way."""
        mode = {self.name: self.family.mode[None]}
        alone = self.problem.at(mode, self.time)[self.name][:, 0]
        return np.asarray(alone + self.problem.along(self.time) @ self.family.usual)

    @property
    def band(self) -> PredictionBand:
        """Band (n,) of the coefficient at the rows, times `VelocitySteps.times`, without noise."""
        low, middle, high = self.family.band
        return PredictionBand(low=low, median=middle, high=high)

    @cached_property
    def rmse(self) -> float:
        """Root mean square of measured less fitted coefficient, over all samples used."""
        return float(np.sqrt(np.mean((self.measured - self.fitted) ** 2)))

    @property
    def rms(self) -> float:
        """Root mean square of the residuals, means over short stretches of long records."""
        return self.family.rms

    @cached_property
    def correlation(self) -> float:
        """Correlation of the draws of a and b; 0 where not both were looked for."""
        if not {DIRECT, EVOLVED} <= {*self.family.unknowns.names}:
            return 0.0
        return float(np.corrcoef(self.draws[DIRECT], self.draws[EVOLVED])[0, 1])

    @property
    def separable(self) -> bool:
        """Whether the record tells a and b apart."""
        found = {e.path.rpartition(".")[2]: e for e in self.estimates}
        both = [found[name] for name in (DIRECT, EVOLVED) if name in found]
        return len(both) == 2 and all(e.half_width < TOLD * abs(e.value) for e in both)

    @cached_property
    def way(self) -> Estimate:
        """Change of the coefficient from the beginning to the end of the way, beside the law."""
        ends = self.problem.along(np.array([0.0, self.problem.record.path.time[-1]]))
        first, last = ends[:, 1:] @ self.family.coefficients[:, 1:].T
        low, middle, high = np.quantile(last - first, (ENDS[0], 0.5, ENDS[1]))
        return Estimate(
            path="drift", quantity=Quantity("eta"), value=float(middle), low=float(low),
            high=float(high), interval="95 %",
        )  # fmt: skip

    @property
    def drifts(self) -> bool:
        """Whether friction is told to change along the way beside the law."""
        if self.problem.trending.all():  # a drift that was asked for
            return not self.way.low <= 0.0 <= self.way.high
        share = float(self.problem.trending[self.family.sets].mean())
        return len(self.problem.trending) > 1 and share >= ASSERTED / (1.0 + ASSERTED)

    @property
    def drift(self) -> float:
        """Mean change of the coefficient with the way of the load point [1/m]; 0 if not told."""
        return self.way.value / float(self.problem.record.path.position[-1]) if self.drifts else 0.0

    @property
    def load_point(self) -> Mapping[str, Array]:
        """Times [s] and positions [m] between which the load point moves steadily."""
        path = self.problem.record.path
        return {"time": path.time, "position": path.position}

    @property
    def stiffness(self) -> float:
        """Stiffness of spring and machine over the load, d mu / d x [1/m]."""
        return self.mechanism.stiffness / self.problem.record.load

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
        return self.posterior.kappa < WHITE / 3.0 or self.over_scatter > THRESHOLDS.misfit

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
            Error of the coefficient; infinite if the slider runs away. What changed along the way
            of the record fitted is of that record.

        Raises
        ------
        InputError
            If there are no samples from that time on.
        """
        record = record_of(measurement, self.problem.record.load)
        other = self.problem.on(record)
        late = record.time + record.begins >= since
        if not late.any():
            raise InputError(f"there are no samples from {quantity(since, 's')} on.")
        seen = other.at({self.name: self.family.mode[None]}, record.time)[self.name][:, 0]
        left = record.coefficient - seen - self.family.usual[0]
        error = float(np.sqrt(np.mean(left[late] ** 2)))
        return error if math.isfinite(error) else math.inf

    def law_estimates(self) -> LawEstimates:
        names = [e.path.rpartition(".")[2] for e in self.estimates]
        table = np.eye(len(names))
        if len(names) > 1 and len(self.family.points) > 1:
            with np.errstate(invalid="ignore"):
                found = np.corrcoef([self.draws[name] for name in names])
            table = np.where(np.isfinite(found), found, np.eye(len(names)))
        return estimates_for(
            self.law,
            self.estimates,
            table,
            levels="per load",
            largest_speed=float(self.problem.record.path.lasting.max()),
        )

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What can be said, such as ``"rate"``, ``"separation"``, ``"distance"``, ``"drift"``."""
        return _findings(self)

    @property
    def sentences(self) -> tuple[str, ...]:
        """The findings in words."""
        return sentences_of(self.findings)

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.show.plots import C1, DATA, MAP_SIZES, on_axes, sampled

        shown = sampled(len(self.time))

        def draw(figure: Any, narrow: bool) -> None:  # noqa: ARG001
            axes = figure.subplots()
            axes.plot(
                self.time[shown], self.measured[shown], "o", color=DATA, markersize=2.2, alpha=0.6,
                markeredgewidth=0, label="measured",
            )  # fmt: skip
            axes.plot(self.time, self.fitted, color=C1, label=self.law.title)
            axes.set_xlabel("time, s")
            axes.set_ylabel("coefficient of friction")
            axes.legend()

        return on_axes(draw, ax, MAP_SIZES["wide"])

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
            "effective_draws": self.family.effective,
            "samples": len(self.time),
            "cancelled": self.cancelled,
            "sentences": list(self.sentences),
        }


def _rate(draws: Mapping[str, Array]) -> Array:
    """Return a - b - b_2 (k,) of draws."""
    zero = np.zeros_like(draws[LEVEL])
    return np.asarray(draws.get(DIRECT, zero) - draws.get(EVOLVED, zero) - draws.get(SECOND, zero))


def result_of(
    name: str,
    block: TowedBlock,
    measurement: Measurement,
    problem: VelocitySteps,
    posterior: SimulatedPosterior,
) -> RateStateFit:
    """Return what the posterior says of one law, with intervals and words."""
    family = posterior.families[name]
    if not math.isfinite(family.rms):
        raise ConvergenceError(
            f"{problem.laws[name].form.title.lower()}: the slider runs away from every start. Check"
            " the stiffness of the machine and the units of pull and friction."
        )
    values = {key: float(x[0]) for key, x in problem.values(name, family.mode[None]).items()}
    level = problem.laws[name].held.get(LEVEL, float(family.usual[0]))
    load = problem.record.load
    fit = RateStateFit(
        law=problem.law(name, values, level),
        mechanism=replace(block, load=load, stiffness=values[STIFFNESS] * load),
        estimates=(),
        cancelled=posterior.cancelled,
        measurement=measurement,
        name=name,
        problem=problem,
        posterior=posterior,
    )
    return replace(
        fit,
        estimates=tuple(_estimates(fit, {**values, LEVEL: level})),
        remarks=_remarks(fit),
    )


def _estimates(fit: RateStateFit, values: Mapping[str, float]) -> list[Estimate]:
    """Return what was looked for: the mode, and the quantiles of draws."""
    free = [name for name in ORDER if name in fit.family.unknowns.names]
    if fit.problem.level is None:
        free = [name for name in ORDER if name in (*free, LEVEL)]
    declared, found = fields_of(RateState), []
    for name in free:
        of_machine = name == STIFFNESS
        unit = fit.problem.record.load if of_machine else 1.0
        low, high = np.quantile(fit.draws[name], ENDS)
        found.append(
            Estimate(
                path=f"mechanism.{name}" if of_machine else f"friction.{name}",
                quantity=Quantity("k", "N/m", above=0) if of_machine else declared[name],
                value=values[name] * unit,
                low=min(float(low), values[name]) * unit,
                high=max(float(high), values[name]) * unit,
                interval="95 %",
            )
        )
    by_path = {e.path: k for k, e in enumerate(found)}
    for effect, distance in ((EVOLVED, DISTANCE), (SECOND, FURTHER)):
        at = by_path.get(f"friction.{distance}")
        if at is None:
            continue
        spent = float(np.quantile(np.abs(fit.draws[effect]), ENDS[0]))
        if _is_prior(fit, distance) or spent < THRESHOLDS.material * abs(fit.law.direct_effect):
            symbols = declared[effect].symbol, declared[distance].symbol
            why = "{} may be 0, and then {} has no effect".format(*symbols)
            own = by_path.get(f"friction.{effect}")
            if own is not None:  # draws end above 0, where a law has no state
                found[own] = replace(found[own], low=min(found[own].low, 0.0))
            found[at] = replace(found[at], low=-math.inf, high=math.inf, reason=why)
    return found


def _is_prior(fit: RateStateFit, name: str) -> bool:
    """Whether draws of a coordinate are as wide as its prior."""
    at = fit.family.unknowns.names.index(name)
    spread = float(np.std(fit.family.points[:, at]))
    return spread > UNTOLD * float(fit.family.unknowns.deviation[at])


def _findings(fit: RateStateFit) -> tuple[Finding, ...]:
    path, rate = fit.problem.record.path, " − ".join(fit.rate_symbols)
    found = {e.path.rpartition(".")[2]: e for e in fit.estimates}
    said = [
        ("speeds", f"The load point moves at {joined(quantities(path.lasting.tolist(), 'm/s'))}.")
    ]
    if fit.rate.interval != "known":
        said.append(("rate", _about_rate(fit.rate, rate)))
    if {DIRECT, EVOLVED} <= found.keys():
        said.append(("separation", _about_separation(fit, rate)))
    said += [
        ("distance", f"{e.quantity.symbol} is not bounded: {e.reason}.")
        for e in found.values() if e.reason
    ]  # fmt: skip
    if STIFFNESS in found and _is_prior(fit, STIFFNESS):
        said.append(("stiffness", "The record does not tell the stiffness of the machine: its"
                     " interval is that of what was stated."))  # fmt: skip
    if fit.drifts:
        said.append(("drift", _about_drift(fit)))
    if fit.cancelled:
        said.append(("search", "The search was stopped before its end."))
    return tuple(Finding(kind=kind, sentence=sentence) for kind, sentence in said)


def _about_drift(fit: RateStateFit) -> str:
    ends = fit.problem.along(np.array([0.0, fit.problem.record.path.time[-1]]))
    first, last = ends @ fit.family.usual + (fit.problem.level or 0.0)
    curve = fit.problem.along(fit.problem.times) @ fit.family.usual
    change = float(np.ptp(curve))
    return (
        f"Friction drifts beside the law, whatever the speed: from {number(first, 4)} at its"
        f" beginning to {number(last, 4)} at its end, by {number(change, 2)} in all."
    )


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
