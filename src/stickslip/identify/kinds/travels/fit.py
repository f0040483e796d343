"""Fits a law to travels: distances to rest, or per cycle of a drive."""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.data import LawEstimates, Measurement, Rig, levels_at, refuse_faults
from stickslip.engine.simulation import simulate
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify import INSENSITIVE, THRESHOLDS, TravelJudgement, fitted_travels
from stickslip.identify.fits import (
    LAW,
    Estimate,
    Fit,
    Law_co,
    Parameters,
    Trial,
    estimates_for,
    is_rig,
    starting_law,
    trials_of,
    with_known,
)
from stickslip.mechanisms import Mechanism, slip_of
from stickslip.quantities import Quantity, parameters
from stickslip.show.formatting import count, joined, number, quantity

if TYPE_CHECKING:
    from stickslip.show.display import Drawing, Target

T_END = Rig.t_end
"""Time after which a body counts as stopped [s]."""
SAMPLES = 2001
WIDER = "the trials tell no more than that it is of this size"
"""Why an estimate is open whose interval is wider than the value."""


def unit_of(unit: str) -> tuple[str, float]:
    """Return the unit that settings are read in, and its numbers over those in SI.

    Examples
    --------
    >>> unit_of("m"), unit_of("N"), unit_of("rad")[0]
    (('mm', 1000.0), ('N', 1.0), '°')
    """
    return {"m": ("mm", 1e3), "rad": ("°", math.degrees(1.0))}.get(unit, (unit, 1.0))


def rounded_setting(value: float, unit: str) -> float:
    """Return a setting [SI] with three digits in the unit that it is read in.

    Examples
    --------
    >>> rounded_setting(0.0123456, "m"), math.degrees(rounded_setting(0.314, "rad"))
    (0.0123, 18.0)
    """
    _, factor = unit_of(unit)
    return float(f"{factor * value:.3g}") / factor


def words_of(path: str) -> str:
    """Return what a parameter of the mechanism is called.

    Examples
    --------
    >>> words_of("mechanism.compression"), words_of("mechanism.drive.drive.frequency")
    ('compression', 'drive frequency')
    """
    words = path.removeprefix("mechanism.").replace(".", " ").replace("_", " ").split()
    return " ".join(dict.fromkeys(words))  # a drive of a motor is its drive


def setting_text(value: float, unit: str) -> str:
    """Return a setting [SI] with its unit, lengths in millimetres and angles in degrees.

    Examples
    --------
    >>> setting_text(0.1, "m"), setting_text(math.radians(5.0), "rad")
    ('100 mm', '5°')
    """
    shown, factor = unit_of(unit)
    return f"{number(factor * value, 6)} {shown}".replace(" °", "°")


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
    mu_k = 0.255 (0.243 to 0.271)
    """

    measured: tuple[float, ...]
    """Travels [m], one a trial."""
    predicted: tuple[float, ...]
    """Travels of the fitted law [m]."""
    runs: int
    """Simulations spent."""
    standard_errors: tuple[float, ...]
    """Standard errors of the travels [m]: as stated, or as the travels show about the law."""
    stated: bool = True
    """Whether an uncertainty of the travels was stated."""
    misfit: bool = False
    """Whether the travels are far from the law, for what was stated."""
    correlation: tuple[tuple[float, ...], ...] = ((1.0,),)
    """Of the estimates (p, p); 0 with what the travels do not tell."""
    trials: tuple[Trial, ...] = ()
    """What was fitted."""

    @property
    def rig_uncertainties(self) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        return [(one.mechanism, {**one.shared, **one.doubts}) for one in self.trials]

    @property
    def settings(self) -> int:
        return len({trial.mechanism for trial in self.trials})

    @property
    def readings(self) -> str:
        return "the readings" if len(self.trials) > 1 else "the reading"

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.show.plots import INTERVAL_SIZE, Interval, draw_intervals, on_axes

        pairs = enumerate(zip(self.residuals, self.standard_errors, strict=True), 1)
        rows = [Interval(f"trial {i}", 1e3 * value, 1e3 * error) for i, (value, error) in pairs]
        draw = draw_intervals(rows, "measured minus predicted travel", "mm")
        return on_axes(draw, ax, INTERVAL_SIZE)

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

    def __str__(self) -> str:
        """Return the law, its estimates and how far off it is, in one line."""
        worst = max(abs(residual) for residual in self.residuals)
        return (
            f"{self.law.title} fitted to {count(len(self.measured), 'travel')}:"
            f" {', '.join(map(str, self.estimates))}; largest residual {quantity(worst, 'm', 2)}"
        )

    def _notes(self) -> Sequence[str]:
        return (*self.remarks, *self.told_apart)

    @property
    def told_apart(self) -> tuple[str, ...]:
        """What the travels cannot tell: parameters without an interval, and a law far off."""
        said = [
            f"{e.quantity.symbol} is not identified: {e.reason}."
            for e in self.estimates
            if e.reason and is_rig(e.path)
        ]
        if self.misfit:
            said.append(
                f"The readings differ from this fit by {quantity(self.scatter, 'm', 2)}, more than"
                " their stated uncertainty: the law or the mechanism is not that of the trials."
            )
        return tuple(said)

    @property
    def scatter(self) -> float:
        """Root mean square of the residuals [m]."""
        return math.sqrt(sum(one**2 for one in self.residuals) / len(self.residuals))

    @property
    def residuals(self) -> tuple[float, ...]:
        """Measured less predicted travel [m], one a trial."""
        return tuple(m - p for m, p in zip(self.measured, self.predicted, strict=True))

    @property
    def freedom(self) -> int:
        """Number of readings less number of fitted parameters."""
        return len(self.measured) - len(self.estimates)

    @property
    def standardised(self) -> tuple[float, ...]:
        """Residuals over the standard errors of the travels, one a trial."""
        return tuple(r / e for r, e in zip(self.residuals, self.standard_errors, strict=True))

    @property
    def chi_square(self) -> float:
        """Sum of the squares of `standardised`."""
        return sum(one**2 for one in self.standardised)

    def to_dict(self) -> Mapping[str, Any]:
        return {
            "law": self.law.name,
            "estimates": [estimate.to_dict() for estimate in self.estimates],
            "measured_travel": list(self.measured),
            "predicted_travel": list(self.predicted),
            "chi_square": self.chi_square if self.stated else None,
            "degrees_of_freedom": self.freedom,
            "runs": self.runs,
        }


def _largest_speed(trial: Trial, law: FrictionLaw) -> float:
    """Return the largest slip speed of a run that a travel was measured of [m/s]."""
    mechanism = trial.mechanism
    slip = slip_of(mechanism)
    run = simulate(mechanism, law, t_end=T_END, y0=trial.start(law), throw=False)
    seen = run.at(np.union1d(np.linspace(*run.span, SAMPLES), run.t))
    return float(np.abs(seen[mechanism.rates[mechanism.coordinates.index(slip)]]).max())


def fit_travels(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    t_end: float = 10.0,
    progress: Callable[[float], object] | None = None,
) -> TravelFit:
    """Fit a law to travels by runs to rest; arguments and errors as in `stickslip.fit`.

    The fit is that of `select` with this law alone. Parameters that travels hardly tell are tried
    on a grid of plausible values, and intervals hold all that explain the travels.

    Examples
    --------
    >>> from stickslip import SpringBlock, Viscous
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> found = fit_travels(rig, Viscous, Measurement(travel=0.20, uncertainty=0.005))
    >>> print(f"{found.law.viscous_coefficient:.2f}")
    5.73
    """
    chosen = Parameters.of(mechanism, law, vary, fixed, measurement=measurement)
    given = chosen.law
    start = with_known(starting_law(given), chosen.known) if isinstance(given, type) else given
    trials = trials_of(chosen.mechanism, measurement, t_end)
    refuse_faults(measurement, mechanism)
    check_rig(trials, chosen.unknown)
    named: list[str] | None = None
    if chosen.free is not None:
        named = [path.removeprefix("friction.") for path in chosen.free if path != LAW]
        asked = [*named, *chosen.unknown]
        if len(asked) > len(trials):
            raise InputError(
                f"{count(len(trials), 'travel')} cannot determine {len(asked)} parameters: vary"
                f" fewer of {', '.join(asked)}, or measure more trials."
            )
        if LAW in chosen.free:
            named += [name for name in start.fit_order if name not in (*named, *chosen.known)]
    judgement = fitted_travels(
        chosen.mechanism,
        trials,
        start,
        named=named,
        rig=chosen.unknown,
        known=chosen.known,
        given=not isinstance(given, type),
        t_end=t_end,
        watch=progress,
    )
    paths = (f"friction.{name}" for name in named or ())
    return travel_fit(judgement, start.name, {*paths, *chosen.unknown})


def check_rig(trials: Sequence[Trial], rig: Sequence[str]) -> None:
    """Refuse parameters of the mechanism that travels cannot tell, or that a trial has set."""
    if not rig:
        return
    settings = len({trial.setting for trial in trials})
    if settings <= len(rig) + 1:
        needed = f"{joined(list(rig))} and a level of friction"
        raise InputError(
            f"travels of {count(settings, 'setting')} cannot determine {needed}: that takes at"
            f" least {len(rig) + 2} different settings. Measure more, or vary fewer."
        )
    rigs = [
        {path: (one, value) for path, one, value in parameters(trial.mechanism, "mechanism")}
        for trial in trials
    ]
    for path in rig:
        if path not in rigs[0]:
            raise InputError(
                f"{path} has no value from which a search could begin: give it one in the rig file."
            )
        one, value = rigs[0][path]
        if value == 0.0 and (one.low == 0.0 or one.above is not None):
            raise InputError(
                f"{path} ({one.symbol}) is 0 {one.unit}, from which no search can begin:"
                " give a value of the right order of magnitude."
            )
        values = {known[path][1] for known in rigs}
        if len(values) > 1:
            raise InputError(
                f"trials set {path} themselves, from {number(min(values))} to"
                f" {number(max(values))} {one.unit}: it cannot be fitted as one value for all"
                " of them. Leave these values out, or do not vary it."
            )
        if any(path in trial.doubts or path in trial.shared for trial in trials):
            raise InputError(
                f"{path} is fitted, and an uncertainty was stated for it: leave one of both out."
            )


def travel_fit(judgement: TravelJudgement, name: str, named: Collection[str] = ()) -> TravelFit:
    """Return a law as a fit: its coefficients with their 95 % intervals if it holds.

    Coefficients that the travels hardly depend on are left out, but for the first and those that
    are `named`, which have no interval then.
    """
    law = judgement.law_of(name)
    unknowns = judgement.unknowns_of(name)
    values, paths = law.values(unknowns[None])[0], law.model.free
    draws, limits = judgement.values(name), _limits(law.quantities)
    untold, zero = judgement.untold(name), judgement.around_zero(name)
    tail, sources = 0.5 * (1.0 - THRESHOLDS.interval), judgement.sources(name)
    alone = ""
    if not judgement.stated and len(judgement.trials) == 1:
        alone = "no uncertainty of the reading was stated"
    estimates = []
    for i, (path, one) in enumerate(zip(paths, law.quantities, strict=True)):
        asked, coefficient = path in named, i < law.count
        if not asked and i > 0 and (path in untold or not coefficient):
            continue
        value = float(values[i])
        low, high = np.quantile(draws[path], (tail, 1.0 - tail)).tolist()
        low = 0.0 if path in zero and not is_rig(path) else low
        reason = INSENSITIVE if path in untold else alone
        if is_rig(path) and high - low > abs(value):
            reason = reason or WIDER
        estimates.append(
            Estimate(
                path=path,
                quantity=one,
                value=value,
                low=-np.inf if reason else min(max(low, limits[i]), value),
                high=np.inf if reason else max(high, value),
                interval="95 %",
                reason=reason,
                sources=sources[i] if sources and not reason and i < len(sources) else {},
            )
        )
    table = np.array([draws[one.path] for one in estimates])
    spread = np.where(table.std(axis=1) > 0.0, table.std(axis=1), 1.0)
    scaled = (table - table.mean(axis=1, keepdims=True)) / spread[:, None]
    correlation = np.clip(scaled @ scaled.T / table.shape[1], -1.0, 1.0)
    np.fill_diagonal(correlation, 1.0)
    trials = tuple(law.model.set_up(trial, values.tolist()) for trial in judgement.trials)
    return TravelFit(
        law=law.with_unknowns(unknowns),
        mechanism=trials[0].mechanism,
        estimates=tuple(estimates),
        measured=tuple(judgement.measured.tolist()),
        predicted=tuple(judgement.predicted(name).tolist()),
        runs=law.model.runs,
        standard_errors=tuple(judgement.errors.tolist()),
        stated=judgement.stated,
        misfit=judgement.misfit,
        correlation=tuple(map(tuple, correlation.tolist())),
        trials=trials,
    )


def _limits(quantities: Sequence[Quantity]) -> list[float]:
    """Return the least values that estimates have."""
    return [max(one.low, -np.inf if one.above is None else one.above) for one in quantities]
