"""What a fit to features gives back, and what it says about itself."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.data import Finding, LawEstimates, Measurement, levels_at, sentences_of
from stickslip.engine.simulation import simulate
from stickslip.errors import ConvergenceError
from stickslip.identify import THRESHOLDS
from stickslip.identify.bands import ENDS, Array, correlation_of
from stickslip.identify.fits import Estimate, Fit, Law_co, estimates_for
from stickslip.identify.problems.limit_cycles import SETTLING
from stickslip.identify.problems.slip_features import (
    COMPARED,
    FEATURES,
    StickSlipFeatures,
    features_of,
)
from stickslip.identify.problems.stick_slip import MASS, SHARES, SPREADS, StickSlip
from stickslip.identify.problems.travels import UNTOLD
from stickslip.identify.simulated import FamilyPosterior, SimulatedPosterior
from stickslip.mechanisms import TowedBlock
from stickslip.quantities import parameters
from stickslip.quantities import vary as with_values
from stickslip.show.formatting import joined, percent, signed_percent

if TYPE_CHECKING:
    from stickslip.show.display import Drawing, Target

ALIKE = "other values give the same features"


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class FeatureFit(Fit[Law_co]):
    """A law on a towed block whose limit cycle has the features of records.

    The mechanism has the mass and the stiffness at which the posterior is largest; its load stays
    the nominal one.
    """

    mechanism: TowedBlock
    """The towed block with fitted parameters."""
    measurement: Measurement
    """The records."""
    name: str
    """Name of the law among those that were compared."""
    predicted: Mapping[str, float]
    """Frequency, mean and standard deviation of the limit cycle in the first record."""
    errors: Mapping[str, float]
    """Relative errors of these, root mean square over the records with the sign of the mean."""
    problem: StickSlip = field(repr=False)
    """The records as rows, and the priors."""
    posterior: SimulatedPosterior = field(repr=False)
    """The posterior that all is read from."""

    @property
    def family(self) -> FamilyPosterior:
        """What the posterior says of this law."""
        return self.posterior.families[self.name]

    @property
    def observed(self) -> StickSlipFeatures:
        """Features of the first record."""
        return self.problem.first.features

    @cached_property
    def draws(self) -> Mapping[str, Array]:
        """Draws (k,) of what was looked for, SI, by path."""
        return self.problem.values(self.name, self.family.points)

    @property
    def rms(self) -> float:
        """Root mean square of the relative errors."""
        return float(np.sqrt(np.mean(np.square([*self.errors.values()]))))

    @property
    def missed(self) -> tuple[str, ...]:
        """Names of features that the limit cycle is off by more than laws of friction are."""
        sizes = dict(zip(COMPARED, SHARES.tolist(), strict=True))
        return tuple(name for name, error in self.errors.items()
                     if not abs(error) <= THRESHOLDS.material * sizes[name])  # fmt: skip

    def law_estimates(self) -> LawEstimates:
        table = correlation_of(np.array([self.draws[one.path] for one in self.estimates]))
        np.fill_diagonal(table, 1.0)
        return estimates_for(
            self.law,
            self.estimates,
            table,
            levels=levels_at(self.mechanism),
            largest_speed=None,
        )

    def judged(self, measurement: Measurement) -> dict[str, float]:
        """Return the relative errors of the compared features on another record of this block.

        Parameters
        ----------
        measurement : Measurement
            One record with ``time`` and ``spring_force`` [N], and the settings that it overrides.
        """
        block = replace(self.problem.block, load=self.mechanism.steady_load)
        if measurement.overrides:
            block = with_values(block, "mechanism", measurement.overrides)
        observed = features_of(measurement, mechanism=block).compared
        mode = self.problem.cycles(self.name, self.family.mode[None], [block])[0, 0]
        return dict(zip(COMPARED, (mode / observed - 1.0).tolist(), strict=True))

    def foreseen(self, blocks: Sequence[TowedBlock], count: int) -> Array:
        """Return draws of the features (k, b, 3) of another run at settings; NaN of failed runs.

        Parameters
        ----------
        blocks : sequence of TowedBlock
            The block as it is set.
        count : int
            Draws.

        Returns
        -------
        array (k, b, 3)
            Frequency [Hz], mean and standard deviation of the force over the load.
        """
        which = np.linspace(0, len(self.family.points) - 1, count).astype(np.intp)
        return self.problem.foreseen(self.name, self.family, blocks, which)

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

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What can be said: of the record, of what is not told, of features that are missed."""
        said = [*self.observed.findings]
        open_ = [one.quantity.symbol for one in self.estimates if one.reason]
        if open_:
            which = joined(open_)
            sentence = f"Frequency, mean and standard deviation do not identify {which}: {ALIKE}."
            said.append(Finding(kind="open", sentence=sentence))
        stated = [path.rpartition(".")[2] for path in self.problem.doubts
                  if _is_prior(self, path)]  # fmt: skip
        if stated:
            sentence = f"The features tell no more of the {joined(stated)} than was stated."
            said.append(Finding(kind="machine", sentence=sentence))
        if self.missed:
            off = [f"{name.replace('_', ' ')} by {signed_percent(self.errors[name])}"
                   for name in self.missed]  # fmt: skip
            sentence = f"The best limit cycle misses the observed {joined(off)}."
            said.append(Finding(kind="missed", sentence=sentence))
        if self.observed.regime == "stick-slip":
            sentence = (
                "A limit cycle repeats exactly: the scatter of an irregular record increases its"
                " standard deviation and appears as larger slips."
            )
            said.append(Finding(kind="cycle", sentence=sentence))
        if self.observed.too_fast and self.problem.doubts.get(MASS, 0.0) < 1.0:
            sentence = (
                "The mass is known nearly to its nominal value; vary=['friction.*',"
                " 'mechanism.mass'] fits it too."
            )
            said.append(Finding(kind="mass", sentence=sentence))
        return tuple(said)

    @property
    def sentences(self) -> tuple[str, ...]:
        """The findings in words."""
        return sentences_of(self.findings)

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.show.plots import INTERVAL_SIZE, Interval, draw_intervals, on_axes

        rows = [Interval(name.replace("_", " "), error) for name, error in self.errors.items()]
        return on_axes(draw_intervals(rows, "relative error, fitted", "1"), ax, INTERVAL_SIZE)

    def __str__(self) -> str:
        """Return law, estimates and errors, then the sentences."""
        numbers = ", ".join(map(str, self.estimates))
        errors = ", ".join(
            f"{name.replace('_', ' ')} {signed_percent(error)}"
            for name, error in self.errors.items()
        )
        head = f"{self.law.title} fitted to features: {numbers}; errors: {errors}"
        return "\n".join([head, *self.sentences])

    def __repr__(self) -> str:
        return f"<FeatureFit: {self.law.title}, rms error {percent(self.rms)}>"

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
            "effective_draws": self.family.effective,
            "cancelled": self.cancelled,
            "sentences": list(self.sentences),
        }


def result_of(
    name: str, measurement: Measurement, problem: StickSlip, posterior: SimulatedPosterior
) -> FeatureFit[Any]:
    """Return what the posterior says of one law, with intervals and words."""
    family = posterior.families[name]
    if not math.isfinite(family.rms):
        raise ConvergenceError(
            f"no run of {problem.laws[name].law.title} has a limit cycle: check the mass, stiffness"
            " and speed of the block."
        )
    values = {path: float(x[0]) for path, x in problem.values(name, family.mode[None]).items()}
    own = {path: x for path, x in values.items() if path.startswith("mechanism.")}
    others = {path: x for path, x in values.items() if path not in own}
    blocks = [one.block for one in problem.settings]
    mode = problem.cycles(name, family.mode[None], blocks)[0]
    off = np.array([
        one.rows(features[None])[0] - one.centre
        for one, features in zip(problem.settings, mode, strict=True) if not one.slides
    ])  # fmt: skip
    errors = np.sqrt(np.mean(np.expm1(off) ** 2, axis=0)) * np.sign(off.sum(axis=0) + 1e-300)
    block = replace(problem.block, load=problem.block.steady_load)
    fit = FeatureFit(
        law=with_values(problem.laws[name].law, "friction", others),
        mechanism=with_values(block, "mechanism", own),
        estimates=(),
        cancelled=posterior.cancelled,
        measurement=measurement,
        name=name,
        predicted=dict(
            zip(COMPARED, mode[problem.settings.index(problem.first)].tolist(), strict=True)
        ),
        errors=dict(zip(COMPARED, errors.tolist(), strict=True)),
        problem=problem,
        posterior=posterior,
    )
    return replace(fit, estimates=tuple(_estimates(fit, values)))


def _estimates(fit: FeatureFit, values: Mapping[str, float]) -> list[Estimate]:
    """Return what was looked for: the mode, and the quantiles of draws."""
    problem, found = fit.problem, []
    quantities = {path: one for path, one, _ in parameters(problem.block, "mechanism")}
    quantities |= problem.laws[fit.name].quantities
    for path in problem.paths(fit.name):
        low, high = np.quantile(fit.draws[path], ENDS)
        one = Estimate(
            path=path,
            quantity=quantities[path],
            value=values[path],
            low=min(float(low), values[path]),
            high=max(float(high), values[path]),
            interval="95 %",
        )
        if path not in problem.doubts and _is_prior(fit, path):
            one = replace(one, low=-math.inf, high=math.inf, reason=ALIKE)
        found.append(one)
    return found


def _is_prior(fit: FeatureFit, path: str) -> bool:
    """Whether draws are as wide as the prior; of a level above another, as that of levels."""
    unknowns, laws = fit.family.unknowns, fit.problem.laws
    at = unknowns.names.index(path)
    if path not in fit.problem.doubts and laws[fit.name].kind(path) == "surplus":
        return float(np.std(np.log(fit.draws[path]))) > UNTOLD * SPREADS["level"]
    return float(np.std(fit.family.points[:, at])) > UNTOLD * float(unknowns.deviation[at])


def pooled(fits: Sequence[FeatureFit], path: str) -> tuple[float, float]:
    """Return between which values a parameter lies, whichever of the laws holds that have it."""
    ends = [np.quantile(one.draws[path], ENDS) for one in fits if path in one.draws]
    return min(float(low) for low, _ in ends), max(float(high) for _, high in ends)
