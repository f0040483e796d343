"""What a selection on travels gives back."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Checks, Measurement
from stickslip.friction import FrictionLaw
from stickslip.identify import PredictionBand, TravelJudgement, band_of
from stickslip.identify.candidates import Candidate, Verdict, score_scale, score_text
from stickslip.identify.criteria import Criteria
from stickslip.identify.fits import Estimate, Trial, durations, quantities_read
from stickslip.identify.kinds.kind import Column, Columns, data_row
from stickslip.identify.kinds.travels.fit import TravelFit, words_of
from stickslip.quantities import parameters
from stickslip.show.formatting import (
    Scale,
    count,
    interval,
    number,
    percent,
    scale_of,
    with_unit,
    within,
)

Array: TypeAlias = NDArray[np.float64]

if TYPE_CHECKING:
    import pandas as pd

    from stickslip.identify import BandDrawing
    from stickslip.show.display import Drawing, Target

MM: Final = Scale(1e3, "mm")
"""What a terminal shows held-out errors in."""


@dataclass(frozen=True, kw_only=True, repr=False)
class TravelCandidate(Candidate[TravelFit]):
    """One law on travels: as given, as fitted, and its share of the band."""

    law: FrictionLaw
    """The law as given."""
    given: Criteria
    """What the mechanism does with it; in the first trial where there are several."""
    criteria: Criteria | None
    """What the fitted run does; of the first trial too."""
    held_out: float | None = None
    """Root mean square of the held-out errors [m]; None where all trials repeat one setting."""
    share: float = 0.0
    """Share of the band."""
    evidence: float = -math.inf
    """Evidence less that of the named law."""

    @property
    def score(self) -> float | None:
        return self.held_out

    @property
    def count(self) -> int:
        """Number of coefficients that were fitted."""
        return self.parameters

    def to_row(self) -> Mapping[str, Any]:
        return data_row(columns_of(None), self)

    def to_dict(self) -> Mapping[str, Any]:
        law = self.fit.law if self.fit else self.law
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.count,
            "held_out_error": self.held_out,
            "share": self.share,
            "evidence": self.evidence if math.isfinite(self.evidence) else None,
            "outcome": self.outcome,
            "dropped": self.dropped,
            "values": {path: value for path, _, value in parameters(law, "friction")},
            "fit": self.fit.to_dict() if self.fit else None,
            "criteria_as_given": asdict(self.given),
            "criteria_fitted": asdict(self.criteria) if self.criteria else None,
        }


@dataclass(frozen=True, kw_only=True, repr=False)
class TravelVerdict(Verdict[TravelCandidate]):
    """Which law to use, and what the travel is at a setting over all candidate laws."""

    judgement: TravelJudgement
    """What the verdict is read from."""
    settings: Array
    """Settings (m,) over which the verdict states the band [SI]; empty without any."""
    travel: PredictionBand | None
    """Band of the travel there [m]."""
    checks: Checks
    """What is doubtful about the readings."""
    intervals: tuple[Estimate, ...]
    """Parameters of the named law with their intervals over the laws that have them."""
    places: tuple[float, ...] = ()
    """Settings of readings that are proposed [SI], one a reading."""
    shrinks: float = 1.0
    """Expected width of the band after them, over the present one."""
    t_end: float
    """Time after which a body counts as stopped [s]."""

    @property
    def trials(self) -> Sequence[Trial]:
        """What was measured, trial by trial, whatever quantity was read."""
        return self.judgement.trials

    @property
    def closest(self) -> TravelCandidate:
        return self.candidates[0]

    @property
    def law(self) -> FrictionLaw:
        """The named law."""
        assert self.closest.fit is not None
        return self.closest.fit.law

    @property
    def set(self) -> tuple[tuple[str, ...], ...]:
        """Laws that cannot be distinguished, the named one first."""
        return tuple((name,) for name in self.judgement.set)

    @property
    def curve_share(self) -> float:
        """Share of the curve as measured, which is no law, in the band."""
        return self.judgement.shares.get("", 0.0)

    @property
    def laws_drawn(self) -> Mapping[str, int]:
        """How many different laws the band holds, by name; the measured curve is none."""
        return {
            one.law.name: len(np.unique(one.unknowns, axis=0))
            for one in self.judgement.draws
            if one.smooth is None
        }

    @property
    def explained(self) -> bool:
        """Whether a law predicts as well as the measured curve."""
        return self.judgement.explained

    @property
    def route(self) -> str:
        return "travel"

    @property
    def score_unit(self) -> str:
        return "m"

    @property
    def scale(self) -> Scale:
        """Multiple of the unit in which held-out errors are shown."""
        return score_scale([one.held_out for one in self.candidates], "m")

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
        ends = (0.5 - 0.5 * level, 0.5, 0.5 + 0.5 * level)
        low, median, high = np.quantile(travels, ends, axis=0)
        return PredictionBand(low=low, median=median, high=high)

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

        Of runs that end with a cycle of the drive it is the mean velocity, else the travel.

        Returns
        -------
        DataFrame
            By the name of the trial: what was set, if one parameter was; what was measured, its
            standard error, what is predicted, and the held-out error, all in SI units.
        """
        import pandas as pd

        judgement, last = self.judgement, durations(self.trials, self.t_end)
        best = judgement.best_of(judgement.named)
        names = [
            record.name or f"trial {i}" for i, record in enumerate(records_of(self.measurement), 1)
        ]
        set_ = {} if judgement.knob is None else {
            judgement.knob[0].rpartition(".")[2]: judgement.settings
        }  # fmt: skip
        measured = judgement.measured
        columns = {
            "measured": measured,
            "error": judgement.errors,
            "predicted": judgement.predicted(judgement.named),
            "held_out_error": best.held_out,
        }
        scaled = {name: x / last for name, x in columns.items()}
        return pd.DataFrame({**set_, **scaled}, index=names)

    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.identify import plot_band  # loads matplotlib

        return plot_band(self.drawing(), ax)

    def drawing(self) -> "BandDrawing":
        """Return what the figure of the verdict shows: travels or mean velocities over the setting.

        Runs that end with a cycle of their drive last differently, and so their mean is shown.
        """
        from stickslip.identify import BandDrawing  # loads matplotlib

        judgement = self.judgement
        assert judgement.knob is not None
        assert self.travel is not None
        path = judgement.knob[0]
        unit = {p: q.unit for p, q, _ in parameters(self.mechanism, "mechanism")}[path]
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
            units=(unit, read),
            names=(words_of(path), what),
        )

    def _basis(self) -> str:
        trials = count(len(self.measurement.records()), "trial")
        return f"; {trials}, {'ranked' if self.ranked else 'not ranked'} by held-out error"

    def _details(self) -> Mapping[str, Any]:
        judgement, fit = self.judgement, self.closest.fit
        assert fit is not None
        path = judgement.knob[0] if judgement.knob else ""
        units = {p: q.unit for p, q, _ in parameters(self.mechanism, "mechanism")}
        band = self.travel
        pairs = zip(fit.estimates, self.intervals, strict=True)
        return {
            "explained": self.explained,
            "set": [list(one) for one in self.set],
            "curve_share": self.curve_share,
            "units": {"setting": units.get(path, ""), "travel": "m"},
            "band": None if band is None else {
                "parameter": path,
                "setting": self.settings.tolist(),
                "low": band.low.tolist(),
                "median": band.median.tolist(),
                "high": band.high.tolist(),
                "level": 0.95,
            },
            "parameters": [
                {
                    "parameter": one.path, "value": one.value, "low": one.low, "high": one.high,
                    "low_any": every.low, "high_any": every.high,
                }
                for one, every in pairs
            ],
            "findings": [],
            "other_specimen": None,
            "tolerance": None,
            "odds_of_friction": None,
            "outliers": {},
            "measure_at": {"setting": list(self.places), "band_shrinks_to": self.shrinks},
            "inside_second": None,
            "error_second": None,
        }  # fmt: skip


def what_of(trials: Sequence[Trial]) -> tuple[str, str]:
    """Return what travels of trials are shown as, and its unit.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> what_of([Trial(mechanism=SpringBlock(mass=1.0), initial={}, travel=0.2, half_width=0.0)])
    ('travel', 'm')
    """
    cyclic = any(trial.cycles is not None for trial in trials)
    return ("mean velocity", "m/s") if cyclic else ("travel", "m")


def records_of(measurement: Measurement) -> list[Measurement]:
    """Return the record of each trial: some hold several readings."""
    return [
        record
        for record in measurement.records()
        for _ in np.atleast_1d(record.values(record.travelled))
    ]


def estimate_text(estimate: Estimate) -> str:
    """Return symbol and value of an estimate, such as ``"$mu_k$ = 0.255"``."""
    value = within(estimate.value, estimate.low, estimate.high)
    return f"${estimate.quantity.symbol}$ = {with_unit(value, estimate.quantity.unit)}"


def _fitted(one: TravelCandidate) -> str | None:
    return ", ".join(map(estimate_text, one.fit.estimates)) if one.fit else None


def _ranges(one: TravelCandidate) -> str:
    return ", ".join(interval(e.low, e.high) for e in one.fit.estimates) if one.fit else ""


def columns_of(verdict: TravelVerdict | None) -> Columns[TravelCandidate]:
    """Return what tables say of each law; of no verdict, only values, which need none."""
    ranked, errors, scale, read = False, MM, MM, ""
    trials: Sequence[Trial] = ()
    if verdict is not None:
        ranked, errors, trials = verdict.ranked, verdict.scale, verdict.trials
        scale = scale_of([c.criteria.travel for c in verdict.candidates if c.criteria], "m")
        read = quantities_read(trials)

    def travel(one: TravelCandidate) -> float:
        return one.criteria.travel if one.criteria else math.nan

    return (
        Column(
            key="law", title="law", page="model", numeric=False,
            value=lambda one: one.name, text=lambda one: one.title,
        ),
        Column(
            key="parameters", title="fitted", page="fitted", numeric=False,
            value=lambda one: ", ".join(
                f"{e.quantity.symbol} = {number(e.value)}"
                for e in (one.fit.estimates if one.fit else ())
            ),
            text=lambda one: _fitted(one) or None, why_empty="no value fits",
        ),
        Column(
            key="range", title="95 % if it holds", page="95 %,\nif it holds", numeric=False,
            phone="label", value=_ranges, text=lambda one: _ranges(one) or None,
        ),
        Column(
            key="travel", title="travel", page="travel\nm" if not ranked else "", phone="hide",
            value=travel, text=lambda one: scale.error(travel(one)) if one.criteria else None,
        ),
        Column(
            title=read,
            text=lambda one: trials[0].as_read(travel(one)) if one.criteria else None,
        ),
        Column(
            title="velocity never < 0", page="velocity\nnever < 0", phone="label",
            text=lambda one: None if one.criteria is None
            else "yes" if one.criteria.velocity_never_negative else "no",
        ),
        Column(
            key="score", title="held-out error, mm" if ranked else "",
            page=f"held-out error\n{errors.unit}" if ranked else "", plotted=True,
            value=lambda one: math.nan if one.score is None else one.score,
            text=lambda one: None if one.score is None else score_text(errors, one.score),
        ),
        Column(
            key="share", title="share", page="share of the band", phone="label",
            value=lambda one: one.share,
            text=lambda one: percent(one.share) if one.share >= 0.005 else None,
        ),
        Column(key="outcome", title="", page="", value=lambda one: one.outcome or one.dropped),
    )  # fmt: skip
