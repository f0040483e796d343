"""Travels: distances to rest, or per cycle of a drive.

`stickslip.identify.problems.travels` judges them: every law in every shape is fitted to them by
runs, weighed by its evidence, and drawn. Fit, verdict, words and page are those of simulated kinds.
Beside the probability of a law, which names it, stands its share of the *band*: the quantiles of
travels over the setting, for which laws count by how well they predict held-out settings.
"""

import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.special import ndtri, softmax

from stickslip.data import Measurement, Rig, is_filmed, travels_of_films
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, law_type
from stickslip.identify import (
    INSENSITIVE,
    THRESHOLDS,
    USUAL_LAWS,
    PredictionBand,
    TravelJudgement,
    band_of,
    judged_travels,
    sections_of,
)
from stickslip.identify.bands import Array, quantile_band
from stickslip.identify.candidates import check_any, check_apart, friction_of, in_sentence, plain
from stickslip.identify.criteria import Criteria, criteria_of, limits_of
from stickslip.identify.fits import (
    LAW,
    AnyLaw,
    AnyLaw_co,
    Estimate,
    Parameters,
    Trial,
    durations,
    is_rig,
    quantities_read,
    starting_law,
    trials_of,
    under_cycles,
    with_known,
)
from stickslip.identify.kinds.kind import Column, Columns, Comparison, FitSummary, Law, Request
from stickslip.identify.kinds.simulated import (
    COLUMNS,
    LAST,
    SimulatedCandidate,
    SimulatedFit,
    SimulatedKind,
    SimulatedVerdict,
    Weighed,
    laws_section,
)
from stickslip.identify.page import band_section
from stickslip.identify.problems.travel_laws import top_speed
from stickslip.identify.projection import TOLERANCE
from stickslip.identify.propose import MOST, propose, within_band
from stickslip.identify.simulated import FamilyDraws, Readable
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, all_paths, fields_of, parameters
from stickslip.show.formatting import (
    at_worst,
    capital,
    count,
    interval,
    joined,
    number,
    percent,
    quantity,
    scale_of,
    with_unit,
    within,
)
from stickslip.show.report import Column as PageColumn
from stickslip.show.report import Name, Origin, Row, Section, SectionMaker, Table

if TYPE_CHECKING:
    import pandas as pd

    from stickslip.identify import BandDrawing
    from stickslip.show.display import Drawing, Target

T_END: Final = Rig.t_end
"""Time after which a body counts as stopped [s]."""
WIDER = "the trials determine its order of magnitude alone"
"""Why an estimate is open whose interval is wider than the value."""
BEYOND = (0.75, 1.5)
"""Least and largest settings of the band over those measured."""
ALONE = (0.4, 1.5)
"""The same where there is but one."""
RIG_DOUBT = 0.015
"""Prior deviation of forces over themselves, by a stiffness, mass or inertia whose uncertainty
nobody stated."""
PLACES = (17, 41)
"""Settings of the band within those measured, and of bodies that carry their drive, which have
resonances: half a second, and three (docs: explanation/travels)."""


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


def started(laws: Mapping[str, Any]) -> tuple[dict[str, FrictionLaw], set[str]]:
    """Return laws with values by name, and the names of those without given values."""
    ordinary = {name for name, law in laws.items() if isinstance(law, type)}
    return {n: starting_law(law) if n in ordinary else law for n, law in laws.items()}, ordinary


def what_of(trials: Sequence[Trial]) -> tuple[str, str]:
    """Return what travels of trials are shown as, and its unit.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> what_of([Trial(mechanism=SpringBlock(mass=1.0), initial={}, travel=0.2, half_width=0.0)])
    ('travel', 'm')
    """
    averaged = all(trial.averaged for trial in trials)
    return ("mean velocity", "m/s") if averaged else ("travel", "m")


class JudgedTravels(Readable):
    """A judgement of travels as the posterior of its laws, with its band and advice."""

    ends = (0.5 - 0.5 * THRESHOLDS.interval, 0.5 + 0.5 * THRESHOLDS.interval)
    cancelled = False

    def __init__(
        self, judgement: TravelJudgement, named: Collection[str] = (), *, alone: bool = False
    ) -> None:
        self.judgement, self.trials = judgement, judgement.trials
        self.named, self.alone = frozenset(named), alone
        self.repeated = len(np.unique(judgement.blocks)) == 1
        chances = softmax([*judgement.evidence.values()]).tolist()
        self.shares = dict(zip(judgement.evidence, chances, strict=True))

    @cached_property
    def families(self) -> Mapping[str, FamilyDraws]:
        """Draws of each law by name, those with the most evidence first."""
        nothing = np.zeros((0, 0))
        failed = FamilyDraws(
            mode=nothing, effective=0.0, points=nothing, coefficients=nothing, usual=nothing,
            rms=math.inf,
        )  # fmt: skip
        results = {name: self.family(name) for name in self.judgement.evidence}
        return results | dict.fromkeys(self.judgement.dropped, failed)

    def family(self, name: str) -> FamilyDraws:
        """Return the draws of a law."""
        judgement = self.judgement
        drawn, left = judgement.draws_of(name), judgement.measured - judgement.predicted(name)
        return FamilyDraws(
            mode=judgement.unknowns_of(name), effective=judgement.effective(name),
            points=drawn.unknowns, coefficients=drawn.nuisances,
            usual=np.zeros(drawn.nuisances.shape[1]), rms=float(np.sqrt(np.mean(left**2))),
        )  # fmt: skip

    # what fits read
    def failed(self, name: str) -> str:
        return self.judgement.dropped[name][1]

    def given(self, name: str) -> FrictionLaw:
        """Return a law with the values that were given."""
        dropped = self.judgement.dropped
        return dropped[name][0] if name in dropped else self.judgement.law_of(name).law

    def title(self, family: str) -> str:
        return self.given(family).title

    def sought(self, family: str) -> Sequence[str]:
        return self.judgement.law_of(family).model.free

    def quantities(self, family: str) -> Mapping[str, Quantity]:
        law = self.judgement.law_of(family)
        return dict(zip(law.model.free, law.quantities, strict=True))

    def read(self, family: str, points: Array, coefficients: Array) -> Mapping[str, Array]:
        law = self.judgement.law_of(family)
        return dict(zip(law.model.free, law.values(points).T, strict=True))

    def result(self, family: str, values: Mapping[str, float]) -> tuple[FrictionLaw, Mechanism]:
        model, numbers = self.judgement.law_of(family).model, [*values.values()]
        return model.with_values(numbers), model.set_up(self.trials[0], numbers).mechanism

    def leaves(self, family: FamilyDraws, name: str) -> float:
        return self.judgement.held_out(name) if not self.repeated else family.rms

    def told(
        self, family: FamilyDraws, name: str, estimates: Sequence[Estimate]
    ) -> Sequence[Estimate]:
        """Return the estimates of what travels tell, of the first, and of those that are named.

        Coefficients that the travels hardly depend on, and shapes, are left out otherwise.
        """
        judgement = self.judgement
        untold, zero = judgement.untold(name), judgement.around_zero(name)
        sources, coefficients = judgement.sources(name), judgement.law_of(name).count
        alone = ""
        if not judgement.stated and len(self.trials) == 1:
            alone = "no uncertainty of the reading was stated"
        results = []
        for i, estimate in enumerate(estimates):
            named, asked = estimate.path in self.named, estimate.quantity
            if not named and i > 0 and (estimate.path in untold or i >= coefficients):
                continue
            low = 0.0 if estimate.path in zero and not is_rig(estimate.path) else estimate.low
            limit = max(asked.low, -np.inf if asked.above is None else asked.above)
            low = min(max(low, limit), estimate.value)
            reason = INSENSITIVE if estimate.path in untold else alone
            if is_rig(estimate.path) and estimate.high - estimate.low > abs(estimate.value):
                reason = reason or WIDER
            results.append(
                replace(
                    estimate,
                    low=-np.inf if reason else low,
                    high=np.inf if reason else estimate.high,
                    reason=reason,
                    sources=sources[i] if sources and not reason and i < len(sources) else {},
                )
            )
        return results

    # the band, and what narrows it
    @cached_property
    def settings(self) -> Array:
        """Settings (m,) over which the band is stated: those measured, between and beyond."""
        judgement = self.judgement
        if judgement.knob is None:
            return np.zeros(0)
        known, places = judgement.settings, PLACES[under_cycles(self.trials)]
        low, high = float(known.min()), float(known.max())
        if low == high:
            return np.union1d(low * np.linspace(*ALONE, places), known)
        ends = sorted((BEYOND[0] * min(low, high, key=abs), BEYOND[1] * max(low, high, key=abs)))
        inner = np.linspace(low, high, places)
        beyond = [np.linspace(*pair, places // 4) for pair in ((ends[0], low), (high, ends[1]))]
        return np.unique(np.concatenate([known, inner, *beyond]))

    @cached_property
    def band(self) -> PredictionBand | None:
        """Band of the travel at the settings [m]; None without any."""
        settings = self.settings
        return band_of(self.judgement.travels(settings)) if len(settings) else None

    @cached_property
    def advice(self) -> tuple[tuple[float, ...], float]:
        """Settings at which readings narrow the band most, and to which share.

        It is that within the settings measured, where these differ. One setting stands for several
        readings; in all, they are no more than were made. No reading takes off what laws leave at
        settings that were not measured.
        """
        judgement, settings = self.judgement, self.settings
        if judgement.knob is None or not len(settings):
            return (), 1.0
        known = judgement.settings if self.varied else settings
        inside = (settings >= known.min()) & (settings <= known.max())
        travels = within_band(judgement.drawn_travels(settings)[:, inside])
        read = within_band(judgement.drawn_readings(settings))
        lasts = durations(judgement.at(settings), judgement.t_end)[inside]
        results = propose(
            travels, read, judgement.noise(settings), taken=min(MOST, len(self.trials)),
            rest=(judgement.discrepancy * lasts) ** 2,
        )  # fmt: skip
        places = sorted(rounded_setting(float(settings[k]), self.unit) for k in results.places)
        return tuple(places), results.shrinks

    @property
    def varied(self) -> bool:
        """Whether settings that were measured differ."""
        return bool(np.ptp(self.judgement.settings))

    @property
    def knob(self) -> str:
        """Path of what is set to get other travels; empty where there is none."""
        return self.judgement.knob[0] if self.judgement.knob else ""

    @property
    def unit(self) -> str:
        """Unit of what is set [SI]; empty where there is none."""
        return all_paths(self.judgement.mechanism, "mechanism")[self.knob].unit if self.knob else ""

    def setting(self, value: float) -> str:
        """Return a setting with its unit."""
        return quantity(value, self.unit, 3, degrees=True)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class TravelFit(SimulatedFit[AnyLaw_co]):
    """A fit to travels.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, fit
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> result = fit(rig, Coulomb, reading)
    >>> print(result.estimates[0])
    mu_k = 0.255 (0.243 to 0.276)
    """

    @property
    def judgement(self) -> TravelJudgement:
        """What the fit is read from."""
        result: TravelJudgement = self.problem.judgement
        return result

    @cached_property
    def trials(self) -> tuple[Trial, ...]:
        """What was fitted."""
        model = self.judgement.law_of(self.name).model
        values = self.problem.read(self.name, self.family.mode[None], self.family.usual[None])
        numbers = [float(x[0]) for x in values.values()]
        return tuple(model.set_up(trial, numbers) for trial in self.judgement.trials)

    @property
    def measured(self) -> tuple[float, ...]:
        """Travels [m], one a trial."""
        return tuple(self.judgement.measured.tolist())

    @property
    def predicted(self) -> tuple[float, ...]:
        """Travels of the fitted law [m]."""
        return tuple(self.judgement.predicted(self.name).tolist())

    @property
    def runs(self) -> int:
        """Simulations spent."""
        return self.judgement.law_of(self.name).model.runs

    @property
    def standard_errors(self) -> tuple[float, ...]:
        """Standard errors of the travels [m]: as stated, or as the travels show about the law."""
        return tuple(self.judgement.errors.tolist())

    @property
    def residuals(self) -> tuple[float, ...]:
        """Measured less predicted travel [m], one a trial."""
        return tuple(m - p for m, p in zip(self.measured, self.predicted, strict=True))

    @property
    def chi_square(self) -> float:
        """Sum of the squares of the residuals over the standard errors of the travels."""
        pairs = zip(self.residuals, self.standard_errors, strict=True)
        return sum((residual / error) ** 2 for residual, error in pairs)

    @property
    def rig_uncertainties(self) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        return [(trial.mechanism, {**trial.shared, **trial.doubts}) for trial in self.trials]

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


def _seen(trial: Trial, law: FrictionLaw, t_end: float) -> Criteria:
    """Return what a run does in the terms of the paper."""
    return criteria_of(trial.simulated(law, t_end), trial.mechanism, trial.travel)


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class TravelCandidate(SimulatedCandidate):
    """A law on travels: as given, as fitted, and its share of the band."""

    problem: JudgedTravels = field(repr=False)
    """What it was fitted to."""

    @cached_property
    def given(self) -> Criteria:
        """What the mechanism does with the law as given; in the first trial of several."""
        problem = self.problem
        return _seen(problem.trials[0], problem.given(self.name), problem.judgement.t_end)

    @cached_property
    def criteria(self) -> Criteria | None:
        """What the fitted run does; of the first trial too."""
        law, problem = self.law, self.problem
        return _seen(problem.trials[0], law, problem.judgement.t_end) if law else None

    @property
    def held_out(self) -> float | None:
        """Root mean square of the held-out errors [m]; None where all trials repeat a setting."""
        return self.fit.rms if self.fit and not self.problem.repeated else None

    @property
    def score(self) -> float | None:
        return self.held_out

    @property
    def share(self) -> float:
        return self.problem.judgement.shares.get(self.name, 0.0)

    @property
    def evidence(self) -> float:
        """Logarithm of the odds against the law that is named."""
        known = self.problem.judgement.evidence
        return known[self.name] - max(known.values()) if self.name in known else -math.inf

    def to_dict(self) -> Mapping[str, Any]:
        law = self.fit.law if self.fit else self.problem.given(self.name)
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.parameters,
            "held_out_error": self.held_out,
            "share": self.share,
            "probability": self.probability,
            "evidence": self.evidence if self.fit else None,
            "outcome": plain(self.outcome),
            "dropped": self.dropped,
            "values": {path: value for path, _, value in parameters(law, "friction")},
            "fit": self.fit.to_dict() if self.fit else None,
            "criteria_as_given": asdict(self.given),
            "criteria_fitted": asdict(self.criteria) if self.criteria else None,
        }


@dataclass(frozen=True, kw_only=True, repr=False)
class TravelVerdict(SimulatedVerdict):
    """Which law to use, and what the travel is at a setting over all candidate laws."""

    if TYPE_CHECKING:
        best: TravelCandidate | None

    @property
    def problem(self) -> JudgedTravels:
        """The travels as they are judged."""
        assert self.closest.fit is not None
        result: JudgedTravels = self.closest.fit.problem
        return result

    @property
    def judgement(self) -> TravelJudgement:
        """What the verdict is read from."""
        return self.problem.judgement

    @property
    def trials(self) -> Sequence[Trial]:
        """What was measured, trial by trial, whatever quantity was read."""
        return self.problem.trials

    @property
    def t_end(self) -> float:
        """Time after which a body counts as stopped [s]."""
        return self.judgement.t_end

    @property
    def law(self) -> FrictionLaw:
        """The named law."""
        law: FrictionLaw = self.closest.law
        return law

    @property
    def settings(self) -> Array:
        """Settings (m,) over which the verdict states the band [SI]; empty without any."""
        return self.problem.settings

    @property
    def travel(self) -> PredictionBand | None:
        """Band of the travel there [m]."""
        return self.problem.band

    @property
    def places(self) -> tuple[float, ...]:
        """Settings of readings that are proposed [SI], one a reading."""
        return self.problem.advice[0]

    @property
    def shrinks(self) -> float:
        """Expected width of the band after them, over the present one."""
        return self.problem.advice[1]

    @property
    def set(self) -> tuple[tuple[str, ...], ...]:
        """Laws that cannot be distinguished, the named one first."""
        return tuple((name,) for name in self.near)

    @property
    def curve_share(self) -> float:
        """Share of the curve as measured, which is no law, in the band."""
        return self.judgement.shares.get("", 0.0)

    @property
    def laws_drawn(self) -> Mapping[str, int]:
        """How many different laws the band holds, by name; the measured curve is none."""
        return {
            draw.law.name: len(np.unique(draw.unknowns, axis=0))
            for draw in self.judgement.draws
            if draw.smooth is None
        }

    @property
    def explained(self) -> bool:
        """Whether a law predicts as well as the measured curve."""
        return self.judgement.explained

    @property
    def score_unit(self) -> str:
        return "m"

    def band(
        self, settings: Array | Sequence[float] | float, *, level: float = 0.95,
        all_along: bool = False,
    ) -> PredictionBand:  # fmt: skip
        """Return what the travel is at settings, over all candidate laws.

        Parameters
        ----------
        settings : array_like (n,)
            Values of what the trials set, such as a compression [m].
        level : float
            Probability with which the travel at each setting lies in the band.
        all_along : bool
            Whether that is the probability that it lies in the band at all of them together.

        Returns
        -------
        PredictionBand
            Limits and median (n,) [m].

        Raises
        ------
        InputError
            If trials differ in more than one parameter, and none is usually set.

        Examples
        --------
        >>> from stickslip import Coulomb, Measurement, SpringBlock, Viscous, select
        >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
        >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
        >>> band = select(rig, [Coulomb, Viscous], reading).band([0.15])
        >>> bool(band.low[0] < 0.30 < 0.45 < band.high[0])
        True
        """
        at = np.atleast_1d(np.asarray(settings, dtype=float))
        return band_of(self.judgement.travels(at), level, all_along=all_along)

    def readings(
        self, settings: Array | Sequence[float] | float, *, level: float = 0.95
    ) -> PredictionBand:
        """Return the band of new readings: the travel and the error of a reading.

        Parameters
        ----------
        settings : array_like (n,)
            Values of what the trials set [SI].
        level : float
            Probability with which a reading at each setting lies in the band.

        Returns
        -------
        PredictionBand
            Limits and median (n,) [m].
        """
        at = np.atleast_1d(np.asarray(settings, dtype=float))
        travels = self.judgement.travels(at)
        random = np.random.default_rng(self.judgement.seed + 3)
        travels = travels + self.judgement.noise(at) * random.normal(size=travels.shape)
        return quantile_band(travels, level)

    def sample(self, count: int = 20, *, seed: int = 0) -> list[FrictionLaw]:
        """Return laws drawn over the set with their covariances, for ensembles of runs.

        Parameters
        ----------
        count : int
            Number of laws.
        seed : int
            Seed of the draws.

        Returns
        -------
        list of FrictionLaw
            Laws of `stickslip.friction`, by their shares.

        Examples
        --------
        >>> from stickslip import Coulomb, Measurement, SpringBlock, Viscous, select
        >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
        >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
        >>> len(select(rig, [Coulomb, Viscous], reading).sample(5))
        5
        """
        again = self.judgement if not seed else replace(self.judgement, seed=seed)
        laws = [law for draws in again.draws for law in again.laws_of(draws)]
        order = np.random.default_rng(seed).permutation(len(laws))
        return [laws[k] for k in np.resize(order, count)]

    @property
    def prediction_error(self) -> float:
        """By how much mean velocities are off beside what the laws tell [m/s]; 0 of runs to rest.

        It is the scale of Student's t with four degrees of freedom that held-out errors of the
        named law ask for beside those of the readings and of its coefficients; repeats of a setting
        count once, and few settings leave it uncertain and so larger. `band` has it; bands of runs
        with laws that `sample` draws need it beside them.
        """
        return self.judgement.discrepancy

    def compared(self) -> "pd.DataFrame":
        """Return what was measured in each trial, and what the named law predicts.

        It is the mean velocity where that was read or runs end with a cycle of the drive, else the
        travel.

        Returns
        -------
        DataFrame
            By the name of the trial: what was set, if one parameter was; what was measured, its
            standard error, what is predicted, and the held-out error, all in SI units.
        """
        import pandas as pd

        judgement, last = self.judgement, durations(self.trials, self.t_end)
        records = [
            record
            for record in self.measurement.records()
            for _ in np.atleast_1d(record.values(record.travelled))  # some hold several readings
        ]
        names = [record.name or f"trial {i}" for i, record in enumerate(records, 1)]
        set_ = {self.problem.knob.rpartition(".")[2]: judgement.settings}
        columns = {
            "measured": judgement.measured,
            "error": judgement.errors,
            "predicted": judgement.predicted(self.closest.name),
            "held_out_error": judgement.best_of(self.closest.name).held_out,
        }
        scaled = {name: x / last for name, x in columns.items()}
        return pd.DataFrame((set_ if judgement.knob else {}) | scaled, index=names)

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.identify import plot_band  # loads matplotlib

        return plot_band(self.drawing(), ax)

    def drawing(self) -> "BandDrawing":
        """Return what the figure of the verdict shows: travels or mean velocities over the setting.

        Runs that end with a cycle of their drive last differently, and so their mean is shown.
        """
        from stickslip.identify import BandDrawing  # loads matplotlib

        judgement = self.judgement
        assert self.travel is not None
        what, read = what_of(self.trials)
        last = durations(judgement.at(self.settings), self.t_end)
        ends = (self.travel.low, self.travel.median, self.travel.high)
        low, median, high = (x / last for x in ends)
        return BandDrawing(
            velocity=judgement.settings,
            friction=judgement.measured / durations(self.trials, self.t_end),
            load=np.ones(len(judgement.measured)),
            weights=np.ones(len(judgement.measured)),
            speeds=self.settings,
            band=PredictionBand(low=low, median=median, high=high),
            law=judgement.named_travels(self.settings) / last,
            title=self.closest.title,
            places=self.places,
            units=(self.problem.unit, read),
            names=(words_of(self.problem.knob), what),
        )

    def _details(self) -> Mapping[str, Any]:
        band = self.travel
        named = {"parameter", "value", "low", "high", "low_any", "high_any"}
        rows = super()._details()["parameters"]
        return {
            "explained": self.explained,
            "set": [list(item) for item in self.set],
            "curve_share": self.curve_share,
            "units": {"setting": self.problem.unit, "travel": "m"},
            "band": None if band is None else {
                "parameter": self.problem.knob,
                "setting": self.settings.tolist(),
                "low": band.low.tolist(),
                "median": band.median.tolist(),
                "high": band.high.tolist(),
                "level": 0.95,
            },
            "parameters": [{k: x for k, x in row.items() if k in named} for row in rows],
            "findings": [],
            "other_specimen": None,
            "tolerance": None,
            "odds_of_friction": None,
            "outliers": {},
            "measure_at": {"setting": list(self.places), "band_shrinks_to": self.shrinks},
            "certificate": None,
            "inside_second": None,
            "error_second": None,
        }  # fmt: skip


def _estimates(one: Any) -> Sequence[Estimate]:
    return one.fit.estimates if one.fit else ()


def _fitted(one: Any) -> str | None:
    parts = [
        f"${e.quantity.symbol}$ = {with_unit(within(e.value, e.low, e.high), e.quantity.unit)}"
        for e in _estimates(one)
    ]
    return ", ".join(parts) or None


def _ranges(one: Any) -> str:
    return ", ".join(interval(e.low, e.high) for e in _estimates(one))


def _travel(one: Any) -> float:
    return one.criteria.travel if one.criteria else math.nan


def _as_read(one: Any) -> str | None:
    trial = one.problem.trials[0]
    plainly = not one.criteria or not quantities_read(one.problem.trials)
    return None if plainly else trial.as_read(_travel(one))


TRAVEL_COLUMNS: Final[Columns[Any]] = (
    COLUMNS[0],
    Column(
        key="parameters", title="fitted", page="fitted", numeric=False, why_empty="no value fits",
        value=lambda item: ", ".join(
            f"{e.quantity.symbol} = {number(e.value)}" for e in _estimates(item)
        ),
        text=_fitted,
    ),
    Column(
        key="range", title="95 % if it holds", page="95 %\nif it holds", numeric=False,
        phone="label", label="95 % if it holds", value=_ranges,
        text=lambda item: _ranges(item) or None,
    ),
    Column(
        key="travel", title="travel", page="travel", phone="hide", value=_travel,
        text=lambda item: quantity(_travel(item), "m", 3) if item.criteria else None,
    ),
    Column(title="as read", optional=True, value=_as_read, text=_as_read),
    Column(
        title="velocity never < 0", page="velocity\nnever < 0", phone="label",
        label="velocity never < 0",
        text=lambda item: item.criteria and ("no", "yes")[item.criteria.velocity_never_negative],
    ),
    Column(
        key="score", title="held-out error", page="held-out error", phone="label", optional=True,
        value=lambda item: item.score,
        text=lambda item: None if item.score is None else quantity(item.score, "m", 3),
    ),
    COLUMNS[3],
    Column(
        key="share", title="share of the band", page="share of\nthe band", phone="label",
        label="share of the band",
        value=lambda item: item.share,
        text=lambda item: percent(item.share) if item.share >= 0.005 else None,
    ),
    LAST[1],
)  # fmt: skip
"""What tables say of each law."""


class TravelKind(SimulatedKind):
    """Runs to rest, fitted to distances."""

    routes = ("travel",)
    measured = "travels"
    content = "travels"
    these = "these travels"
    uses = frozenset({"assumed", "t_end"})
    has_criteria = True
    counts_runs = True
    fit_class = TravelFit
    verdict_class = TravelVerdict

    @property
    def all_columns(self) -> Columns[Any]:
        return TRAVEL_COLUMNS

    def reads(self, measurement: Measurement) -> bool:
        return is_filmed(measurement)

    def why_unused(self, name: str, request: Request) -> str:
        if name == "validate":
            return "requires a second record, and travels have none: give more trials instead."
        return ""

    def candidates(self, laws: Any, measurement: Measurement) -> list[str]:
        return [law if isinstance(law, str) else law.name for law in laws or USUAL_LAWS]

    def owner(self, law: Law) -> AnyLaw:
        return law_type(law) if isinstance(law, str) else law

    def law_and_parameters(
        self, law: Law, vary: str | Sequence[str] | None, fixed: Collection[str] = ()
    ) -> tuple[Law, str | Sequence[str] | None]:
        return self.owner(law), vary

    # what is measured
    def laws(self, laws: Any) -> Mapping[str, Any]:
        """Return laws by name, those without values as types; none for the usual ones."""
        if laws is None or (isinstance(laws, Mapping) and not laws):
            return {}
        if isinstance(laws, Mapping):
            return dict(laws)
        kinds = [law_type(law) if isinstance(law, str) else law for law in laws]
        check_any(kinds)
        check_apart([kind.name for kind in kinds])
        return {kind.name: kind for kind in kinds}

    def fit(self, request: Request) -> Any:
        return super().fit(_read(request))

    def select(self, request: Request) -> Any:
        read = _read(request)
        varied = Parameters.of(
            read.mechanism, None, read.vary, read.fixed, measurement=read.measurement
        )
        if varied.unknown:
            raise InputError(
                "laws are compared by travels with the mechanism as it is given, and vary names"
                f" {joined(list(varied.unknown))}: fit these first with one law (fit takes the"
                " same vary), give the mechanism the values found and state their uncertainties,"
                " and compare laws then."
            )
        return super().select(replace(read, mechanism=varied.mechanism, vary=None, fixed=None))

    def weighed(
        self, request: Request, laws: Mapping[str, Any], vary: str | Sequence[str] | None
    ) -> tuple[Readable, Weighed]:
        law = request.law and next(iter(laws.values()))
        chosen = Parameters.of(
            request.mechanism, law, request.vary, request.fixed, measurement=request.measurement
        )
        t_end = request.t_end or T_END
        trials = trials_of(chosen.mechanism, request.measurement, t_end)
        check_rig(trials, chosen.unknown)
        values, ordinary = started(laws)
        values = {name: with_known(x, chosen.known) for name, x in values.items()}
        named: list[str] | None = None
        if chosen.free is not None and request.law is not None:
            named = [path.removeprefix("friction.") for path in chosen.free if path != LAW]
            sought = [*named, *chosen.unknown]
            if len(sought) > len(trials):
                raise InputError(
                    f"{count(len(trials), 'travel')} cannot determine {len(sought)} parameters:"
                    f" vary fewer of {', '.join(sought)}, or measure more trials."
                )
            if LAW in chosen.free:
                (start,) = values.values()
                named += [name for name in start.fit_order if name not in (*named, *chosen.known)]
        judgement = judged_travels(
            chosen.mechanism, trials, values or None, ordinary=ordinary, assumed=request.assumed,
            named=named, rig=chosen.unknown, known=chosen.known, strict=request.law is not None,
            t_end=t_end, watch=request.progress,
        )  # fmt: skip
        paths = (f"friction.{name}" for name in named or ())
        alone = request.law is not None
        result = JudgedTravels(judgement, {*paths, *chosen.unknown}, alone=alone)
        return result, result

    def bare(self, problem: Any, name: str) -> TravelCandidate:
        return TravelCandidate(
            kind=self, name=name, title=problem.title(name), fit=None, problem=problem
        )

    def over_all(self, fits: Sequence[Any], one: Estimate) -> Estimate:
        """Return the interval of a parameter over all laws of the band that have it.

        No law is that of the ground to less than `TOLERANCE`, nor a rig as it is given to less than
        `RIG_DOUBT` where nobody stated how well it is known: what either makes of forces is beside
        what the readings leave, by the root of the sum of squares.
        """
        problem: JudgedTravels = fits[0].problem
        judgement = problem.judgement
        if not judgement.explained:  # it is a parameter of a law that does not hold
            return replace(one, low=-math.inf, high=math.inf, reason="no law holds")
        if problem.alone:
            return one
        parts = []
        for name, share in judgement.shares.items():
            many = round(THRESHOLDS.draws * share)
            if name and many and name in judgement.named_draws:
                values = judgement.values(name).get(one.path)
                if values is not None:
                    parts.append(np.resize(values, many))
        if not parts or not one.bounded:
            return one
        low, high = np.quantile(np.concatenate(parts), problem.ends).tolist()
        low, high = min(one.low, max(low, 0.0)), max(one.high, high)
        if one.quantity.scale.startswith(("level", "slope", "drag")):
            stated = any(trial.doubts or trial.shared for trial in problem.trials)
            doubt = 0.0 if stated else RIG_DOUBT
            beside = math.hypot(TOLERANCE, doubt) * abs(one.value) * float(ndtri(problem.ends[1]))
            low = max(one.value - math.hypot(one.value - low, beside), 0.0)
            high = one.value + math.hypot(high - one.value, beside)
        return replace(one, low=low, high=high)

    def errors(self, fit: Any, measurement: Measurement) -> Mapping[str, float]:
        judgement = fit.problem.judgement
        trials = trials_of(fit.mechanism, measurement, judgement.t_end)
        travels = judgement.law_of(fit.name).table(trials, fit.family.mode[None])[0]
        left = np.array([trial.travel for trial in trials]) - travels
        return {"travel": float(np.sqrt(np.mean(left**2)))}

    def foreseen(self, fit: Any, setting: Any) -> Array:
        raise InputError("travels at other settings are not read from a mechanism: use `band`.")

    def largest_speed(self, fit: Any) -> float | None:
        settings = {trial.setting: trial for trial in fit.trials}.values()
        t_end = fit.judgement.t_end
        return max((top_speed(x, x.simulated(fit.law, t_end)) for x in settings), default=None)

    # texts
    def called(self, fit: Any) -> str:
        return friction_of(fit.law.title)

    def fault(self, fit: Any) -> str:
        judgement: TravelJudgement = fit.problem.judgement
        left, stated = (float(np.median(x)) for x in (judgement.errors, judgement.least_errors))
        is_far = judgement.misfit
        if judgement.stated and not judgement.explained:
            left = max(left, fit.family.rms)  # of the law that is closest, not what a curve leaves
            is_far = left > THRESHOLDS.misfit * stated
        if is_far:
            return (
                f"is {quantity(left, 'm', 2)} from them, where {quantity(stated, 'm', 2)} is"
                " stated: check the rig, units, and values that were given"
            )
        if not judgement.explained:
            return "predicts held-out settings worse than a curve over the setting"
        return ""

    def about(self, fit: Any) -> str:
        problem: JudgedTravels = fit.problem
        return super().about(fit) if problem.alone else _band_text(problem)

    def left(self, fit: Any) -> str:
        return quantity(fit.family.rms, "m", 2)

    def settled(self, fit: Any) -> Iterator[str]:
        problem: JudgedTravels = fit.problem
        judgement, trials = problem.judgement, problem.trials
        if not problem.repeated:
            lasts, (what, unit) = durations(trials, judgement.t_end), what_of(trials)
            off = judgement.best_of(fit.name).held_out / lasts
            sizes = [float(np.sqrt(np.mean(x**2))) for x in (off, judgement.measured / lasts)]
            worst, squares = int(np.argmax(np.abs(off))), off**2
            at = ""
            several = len(off) > THRESHOLDS.fewest
            if problem.knob and several and squares[worst] >= 0.5 * squares.sum():
                place = problem.setting(float(judgement.settings[worst]))
                at = f", worst at {place}, by {quantity(float(abs(off[worst])), unit, 2)}"
            yield (
                f"The law predicts held-out settings to {quantity(sizes[0], unit, 2)},"
                f" {percent(sizes[0] / sizes[1])} of the {what} (root mean square){at}."
            )
        yield from limits_of(fit)

    def untold(self, fit: Any) -> Iterator[str]:
        judgement: TravelJudgement = fit.problem.judgement
        if judgement.assumed and len(judgement.trials) > 1:
            stated = float(np.median(judgement.readings))
            more = f", more than the {quantity(stated, 'm', 2)} stated" * judgement.stated
            error = quantity(float(np.median(judgement.errors)), "m", 2)
            yield f"The travels scatter by {error} about every law{more}."
        shares = judgement.shares
        most = max(shares, key=shares.__getitem__)
        is_near = most in judgement.set and not fit.problem.repeated
        if is_near and shares[most] - shares[fit.name] > THRESHOLDS.material:
            title = in_sentence(fit.problem.title(most))
            yield (
                f"Which law holds elsewhere: {title} predicts held-out settings best, and so has"
                f" {percent(shares[most])} of the band;"
                f" {in_sentence(fit.law.title)} is named, as it has fewer or more common parts."
            )
        known, paths = fields_of(type(fit.law)), {estimate.path for estimate in fit.estimates}
        symbols = [
            f"${known[name].symbol}$"
            for name in judgement.law_of(fit.name).names
            if f"friction.{name}" not in paths and name in known
        ]
        if symbols:
            yield f"{joined(symbols)}: the trials hardly depend on it; the band allows for it."

    def advice(self, fit: Any, others: Sequence[Any], advised: Sequence[Any]) -> Iterable[str]:
        problem: JudgedTravels = fit.problem
        if problem.alone:
            return
        what = what_of(problem.trials)[0]
        if problem.band is None:
            such = words_of(problem.knob) or "compression"
            yield f"Measure the same rig at other settings of one parameter, such as a {such}."
            return
        places, shrinks = problem.advice
        if not places:
            yield f"Further readings of the {what} hardly narrow its band."
            return
        symbol = all_paths(problem.judgement.mechanism, "mechanism")[problem.knob].symbol
        parts = [problem.setting(x) + f" ({n} runs)" * (n > 1) for x, n in Counter(places).items()]
        many = count(len(places), "reading there is", "readings there are")
        within_these = " within the settings measured" * problem.varied
        yield (
            f"Set ${symbol}$ to {joined(parts)}: {many} expected to narrow the band"
            f" of the {what}{within_these} to {percent(shrinks)} of its width."
        )

    # numbers and figures
    def details(self, fit: Any) -> Mapping[str, Any]:
        return {
            "measured_travel": list(fit.measured),
            "predicted_travel": list(fit.predicted),
            "chi_square": fit.chi_square if fit.judgement.stated else None,
            "degrees_of_freedom": len(fit.measured) - len(fit.estimates),
            "runs": fit.runs,
        }

    def comparison(self, verdict: Any) -> Comparison:
        laws = super().comparison(verdict)
        if not all(trial.averaged for trial in verdict.trials):
            return laws
        return replace(laws, notes=[*laws.notes, *_trial_lines(verdict)])

    def summary(self, fit: Any, validate: Measurement | None = None) -> FitSummary:
        rows, read = [], quantities_read(fit.trials)
        for trial, *pair in zip(fit.trials, fit.measured, fit.predicted, strict=True):
            rows.append([quantity(travel, "m") for travel in pair])
            rows[-1] += [trial.as_read(travel) for travel in pair] if read else []
        heads = ["measured travel", "predicted"]
        heads += [f"measured {read}", "predicted"] if read else []
        return replace(super().summary(fit), heads=heads, rows=rows, limits=limits_of(fit))

    def sections(self, verdict: Any, origin: Origin, remark: str) -> tuple[SectionMaker, ...]:
        middle = (travels_section, laws_section, trials_section)
        return sections_of(verdict, origin, remark, *(partial(item, verdict) for item in middle))


def _read(request: Request) -> Request:
    """Return the request with travels, read off films where it has these, and when runs end."""
    if not is_filmed(request.measurement):
        return replace(request, t_end=T_END if request.t_end is None else request.t_end)
    read, t_end = travels_of_films(request.mechanism, request.measurement, request.t_end)
    return replace(request, measurement=read, t_end=t_end)


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
        {path: (item, value) for path, item, value in parameters(trial.mechanism, "mechanism")}
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


def _band_text(problem: JudgedTravels) -> str:
    """Return how well the travel is known, at the settings and beyond them."""
    judgement, settings, band = problem.judgement, problem.settings, problem.band
    if band is None:
        how = "do not differ in a" if problem.repeated else "differ in more than one"
        return f"The trials {how} parameter of the mechanism, so there is no band over a setting."
    low, high = float(judgement.settings.min()), float(judgement.settings.max())
    inside = np.flatnonzero((settings >= low) & (settings <= high))
    lasts = durations(judgement.at(settings), judgement.t_end)
    what, unit = what_of(problem.trials)
    ends = np.array([band.low, band.high]) / lasts
    half = 0.5 * (ends[1] - ends[0])
    typical, widest = float(np.median(half[inside])), int(inside[np.argmax(half[inside])])
    word, first = words_of(problem.knob), problem.setting(low)
    span = f"of {first}" if low == high else f"from {first} to {problem.setting(high)}"
    said = f"With a {word} {span}, the {what} is known to ± {quantity(typical, unit, 2)}"
    if half[widest] > 1.5 * typical:
        place = problem.setting(float(settings[widest]))
        said += at_worst(quantity(float(half[widest]), unit, 2), place)

    def range_at(k: int) -> str:
        pair = ends[:, k].tolist()
        return scale_of(pair, unit).interval(*pair)

    sizes = np.abs(band.median / lasts)
    if unit == "m/s":
        best = int(inside[np.argmax(sizes[inside])])
        at = problem.setting(float(settings[best]))
        said += f"; it is largest at {at}, {range_at(best)}"
    last = int(np.argmax(np.abs(settings)))
    rests = float(np.max(np.abs(ends[:, last]))) < THRESHOLDS.negligible * float(np.max(sizes))
    far = "the body stays where it is" if rests else f"it is {range_at(last)}"
    place = problem.setting(float(settings[last]))
    return f"{said}; with {place} {far} (95 % band over all candidate laws)."


def _trial_rows(verdict: TravelVerdict) -> list[list[str]]:
    """Return the trials with what was measured and predicted, and the held-out error."""
    table, (_, unit) = verdict.compared(), what_of(verdict.trials)
    names = ["measured", "predicted"] + ["held_out_error"] * (not verdict.problem.repeated)
    numbers = table[names].to_numpy(dtype=float)
    scale = scale_of(numbers, unit)
    return [
        [str(name), *map(scale.quantity, row)]
        for name, row in zip(table.index, numbers.tolist(), strict=True)
    ]


def _trial_lines(verdict: TravelVerdict) -> list[str]:
    """Return lines of a terminal with the mean velocity of each trial, measured and predicted."""
    rows = [["mean velocity of", "measured", "predicted"], *_trial_rows(verdict)]
    wide = [max(len(row[k]) for row in rows) for k in range(3)]
    return ["   ".join(cell.rjust(w) for cell, w in zip(row, wide, strict=False)) for row in rows]


def travels_section(verdict: TravelVerdict) -> Section | None:
    """Return the figure of the readings, the band and the law; None without a band."""
    if verdict.travel is None:
        return None
    drawing = verdict.drawing()
    word, what = drawing.names
    heading, alt = f"{capital(what)} over the {word}", f"{capital(what)} against {word}"
    laws = count(sum(verdict.laws_drawn.values()), "law")
    beside = f" and the curve as measured ({percent(verdict.curve_share)})"
    text = (
        f"**{heading}.** Points: readings. Line: {verdict.closest.title}."
        f" Band: where the {what} lies with 95 % at each setting, by draws of {laws}"
        f"{beside if verdict.curve_share else ''}."
    )
    if error := verdict.prediction_error:
        text += f" It includes the error at settings held out, {quantity(error, 'm/s', 2)}."
    if verdict.places:
        text += " Dotted: where another reading narrows the band most."
    return band_section(drawing, alt, heading, text)


def trials_section(verdict: TravelVerdict) -> Section | None:
    """Return each trial with what the named law predicts; None of one trial."""
    if len(verdict.trials) < 2:
        return None
    cells = _trial_rows(verdict)
    rows = tuple(Row(cells=(Name(text=name), *values)) for name, *values in cells)
    heads = ("measured", verdict.closest.title, "held-out error")[: len(cells[0]) - 1]
    others = (PageColumn(head=head, numeric=True, phone="label") for head in heads)
    columns = (PageColumn(head="trial"), *others)
    caption = "Held-out errors are those of a setting that the law was not fitted to."
    table = Table(columns=columns, rows=rows, caption="" if verdict.problem.repeated else caption)
    return Section(id="trials", nav="Trials", heading="Each trial", blocks=(table,))
