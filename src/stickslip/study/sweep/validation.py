"""A law on a mechanism against what was measured there: residuals, and whether they are expected.

The law is not fitted to the measurement: it comes from elsewhere, with its uncertainty.

1. The motion is predicted with the best values. Of positions the mean of the first residuals is
   taken off, as their origin is arbitrary; nothing else is fitted.
2. Motions with draws of the uncertain parameters (`bands.draws_of`) have a variance s^2 at each
   sample. With noise of the sensor, as stated or as estimated from the residuals, each of them is a
   measurement that could have been made.
3. The size of residuals r is the root mean square of r / sqrt(s^2 + noise^2), of the measurement
   and of each simulated one; of travels, the sum of squares with errors of reading for noise. The
   share of simulated ones that are as large is a p-value (a parametric bootstrap).
4. The measurement agrees if the share is at least 5 %, and does not below 1 %; between, it is said
   not to be clear. Without draws nothing is decided.
5. The shift of the times with which a record would fit best is told beside it: a trigger that is
   late looks like other friction.
"""

import contextlib
import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.data import QUANTITIES, LawEstimates, Measurement, noise_of, spread_of, step_of
from stickslip.data import unit_on as unit_of_law
from stickslip.engine.simulation import GivenFriction, ensemble, event_driven_law, simulate
from stickslip.engine.solver import EventDriven, Samples
from stickslip.engine.trajectory import Ensemble, Trajectory, completed
from stickslip.errors import (
    InputError,
    ParameterError,
    SimulationError,
    UnknownNameError,
    check_size,
)
from stickslip.friction import FrictionLaw, Laws
from stickslip.identify import LawFit, fits
from stickslip.identify.fits import Estimate, Fit
from stickslip.maths import NORMAL_95
from stickslip.mechanisms import (
    WHOLE,
    Mechanism,
    cycle_or_none,
    has_one_slip,
    slip_names,
    slips_by_angle,
)
from stickslip.mechanisms.drives import SampledSwing
from stickslip.quantities import full_path, parameters, turned, vary
from stickslip.show.described import Described
from stickslip.show.display import InPanels, OnAxes, Summary, Tabular
from stickslip.show.documents import json_value
from stickslip.show.formatting import (
    Scale,
    interval,
    joined,
    number,
    parameter_words,
    percent,
    quantity,
    scale_of,
    within,
)
from stickslip.study.sweep import design
from stickslip.study.sweep.parameter_grid import NOT_IN_BAND, early_ends
from stickslip.study.tolerances import FINE, PERCENT
from stickslip.units import per_second

if TYPE_CHECKING:
    import pandas as pd


# What the uncertainties of law and rig make of a motion: an ensemble, and a band of its runs.
#
# 1. Parameters of the law are drawn with the covariance of their estimates, or taken from laws that
#    were drawn; those of the mechanism from normal distributions, independent of the law and of
#    each other. Draws that the mechanism refuses are drawn again.
# 2. Each draw is a run; states are kept at even times, at whole cycles of the drives, and at the
#    times asked for. Runs that end early are left out, and counted with their reasons.
# 3. At each time the 2.5, 50 and 97.5 % quantiles of each state are the band; travels, mean
#    velocities and travels by cycle are quantiles of those of the runs, not of the band.
#
# Noise of sensors is not part of the band.

Array: TypeAlias = NDArray[np.float64]
T = TypeVar("T")

QUANTILES = (0.025, 0.5, 0.975)
ENDS = ("low", "median", "high")
"""What they are called."""
POINTS = 601
"""Evenly spaced times of a band, beside those asked for."""


class Spread(NamedTuple):
    """Median of the runs, and the ends between which 95 % of them lie."""

    low: float
    """Quantile 2.5 % of the runs."""
    median: float
    """Half of the runs lie below."""
    high: float
    """Quantile 97.5 % of the runs."""

    def cells(self, unit: str) -> tuple[str, str, str]:
        """Return median, both ends and their unit as texts."""
        scale = scale_of(self, unit)
        low, median, high = (scale.factor * value for value in self)
        return within(median, low, high), Scale(scale.factor, "").interval(*self[::2]), scale.unit


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Band(OnAxes, Tabular):
    """Runs of one mechanism with draws of uncertain parameters of its law, and of its own."""

    draws: Mapping[str, Array]
    """Parameters (n,) of the runs that lasted to their end, by full path."""
    count: int
    """Runs that were made."""
    ended_early: int
    """Runs that did not last, which the band leaves out."""
    reasons: tuple[str, ...] = ()
    """Why they did not: a sentence for each reason."""
    seed: int
    """Of the draws."""
    t: Array
    """Times (m,) [s]."""
    states: Mapping[str, Array]
    """Lower end, median and upper end (3, m) of the coordinate that slips and its rate, by name; of
    all coordinates and rates where there are several contacts."""
    units: Mapping[str, str]
    """SI unit of each of them."""
    period: float | None
    """Length of a cycle of the drives [s], if there is one."""
    travels: Mapping[str, Spread]
    """By coordinate, last position less the first [m] or [rad]."""
    mean_velocities: Mapping[str, Spread]
    """By coordinate, over all whole cycles, or without any over the run [m/s] or [rad/s]."""
    travels_by_cycle: Mapping[str, tuple[Spread, ...]]
    """By coordinate, the travel of each whole cycle [m] or [rad]."""
    correlated: tuple[str, str, float] | None
    """Paths of the two estimates with the largest correlation, and this; None without any."""
    travels_by_run: Mapping[str, Array]
    """By coordinate, the travel of each run that lasted (n,) [m] or [rad]."""

    @property
    def travel(self) -> Spread:
        """`travels` of the only coordinate."""
        return _only("travels", self.travels)

    @property
    def mean_velocity(self) -> Spread:
        """`mean_velocities` of the only coordinate."""
        return _only("mean_velocities", self.mean_velocities)

    @property
    def cycles(self) -> tuple[Spread, ...]:
        """`travels_by_cycle` of the only coordinate."""
        return _only("travels_by_cycle", self.travels_by_cycle)

    def shares(self, coordinate: str | None = None) -> design.SensitivityIndices:
        """Return which share of the variance of a travel each uncertain parameter explains alone.

        Sobol indices of first order, from the draws of the band by RBD-FAST. What is left to 1 is
        what parameters do together. Correlated parameters have none.

        Examples
        --------
        >>> from stickslip import Coulomb, SpringBlock
        >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
        >>> band = band_of(
        ...     rig,
        ...     Coulomb(kinetic_coefficient=0.25),
        ...     None,
        ...     t_end=1.0,
        ...     parameter_uncertainties={"compression": 0.002, "mass": 0.02},
        ...     count=1000,
        ... )
        >>> shares = band.shares()  # k x0^2 / (2 mu m g): 4 % and 2 % of the travel
        >>> [round(share, 1) for share in shares.indices["first"].tolist()]
        [0.8, 0.2]
        """
        names = dict(zip(self.travels, self.travels, strict=True))
        name = _only("shares", names) if coordinate is None else coordinate
        if name not in names:
            raise UnknownNameError("coordinate of the band", name, names)
        if self.ended_early:
            raise InputError(
                f"{' '.join(self.reasons)} The runs that lasted do not tell what spreads all of"
                " them."
            )
        if self.correlated is not None:
            design.refuse_correlated(*self.correlated, design.NEARLY_INDEPENDENT)
        values = self.travels_by_run[name]
        return design.first_order_of(
            self.draws, f"travel of {name}", self.units[name], values, self.seed
        )

    def at(self, name: str, t: ArrayLike) -> Array:
        """Return lower end, median and upper end (3, n) of a state at some of the times `t`."""
        places = np.searchsorted(self.t, np.asarray(t, dtype=np.float64))
        result: Array = self.states[name][:, np.minimum(places, len(self.t) - 1)]
        return result

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the band as a pandas DataFrame: ``x_low``, ``x_median``, ``x_high`` over ``t``."""
        import pandas as pd

        columns = {
            f"{name}_{end}": row
            for name, rows in self.states.items()
            for end, row in zip(ENDS, rows, strict=True)
        }
        return pd.DataFrame({"t": self.t, **columns})

    def _over(self) -> str:
        return "t"

    def _column_units(self) -> Mapping[str, str]:
        return {"t": "s"} | {
            f"{name}_{end}": self.units[name] for name in self.states for end in ENDS
        }

    def _summary(self) -> Summary:
        several = len(self.travels) > 1
        rows = []
        for name, travel in self.travels.items():
            of, unit = f" of {name}" if several else "", self.units[name]
            cycles = [*enumerate(self.travels_by_cycle[name], 1)]
            shown = cycles[:1] + cycles[1:][-1:]
            rows.append((f"travel{of}", *travel.cells(unit)))
            rows += [(f"cycle {place}{of}", *spread.cells(unit)) for place, spread in shown]
            mean = self.mean_velocities[name].cells(f"{unit}/s")
            rows.append((f"mean velocity{of}", *mean))
        return Summary(
            sentence=completed(self.count - self.ended_early, self.count),
            head=("", "median", "95 % of the runs", "unit"),
            rows=rows,
            notes=self.reasons,
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers, ready for JSON; by coordinate where there are several."""
        result: dict[str, Mapping[str, Any]] = {
            "travel": {name: spread._asdict() for name, spread in self.travels.items()},
            "mean_velocity": {name: mean._asdict() for name, mean in self.mean_velocities.items()},
            "travel_by_cycle": {
                name: [spread._asdict() for spread in spreads]
                for name, spreads in self.travels_by_cycle.items()
            },
        }
        alone = len(self.travels) == 1
        return {
            "runs": self.count,
            "ended_early": self.ended_early,
            "reasons": list(self.reasons),
            "seed": self.seed,
            "parameters": {path: _spread(values)._asdict() for path, values in self.draws.items()},
            **{name: _only(name, of) if alone else of for name, of in result.items()},
        }


def band_of(
    mechanism: Mechanism,
    law: GivenFriction,
    estimates: LawEstimates | None,
    *,
    t_end: float,
    parameter_uncertainties: Mapping[str, float] | None = None,
    count: int = 200,
    seed: int = 0,
    times: ArrayLike = (),
    y0: Mapping[str, float] | Sequence[float] | None = None,
    solver: EventDriven | None = None,
    executor: Executor | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Band:
    """Run a mechanism with draws of uncertain parameters of its law, and of its own.

    Parameters of the law are drawn with the covariance of their estimates. Those of the mechanism
    are drawn from normal distributions, independent of the law and of each other. Noise of sensors
    is not part of the band.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> known = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.24, 0.26)})
    >>> band = band_of(rig, Coulomb(kinetic_coefficient=0.25), known, t_end=1.0, count=400)
    >>> [round(travel, 2) for travel in band.travel]  # k x0^2 / (2 mu m g) at .26, .25 and .24
    [0.2, 0.2, 0.21]
    """
    if count < 2:
        raise InputError(f"band_of: count must be at least 2, got {count}.")
    law = event_driven_law(mechanism, law)
    period = cycle_or_none(mechanism)
    # with a margin for rounding: the last cycle may end a hair after t_end
    whole = 0 if period is None else int(np.floor(t_end / period * (1.0 + WHOLE)))
    wanted = np.asarray(times, dtype=np.float64).ravel()
    kept_times = POINTS + whole + wanted.size
    check_size(
        "ensemble at all times", float(count) * kept_times, "give a smaller count, or fewer times"
    )
    draws = draws_of(mechanism, law, estimates, parameter_uncertainties or {}, count, seed)
    pairs = dict(zip(mechanism.coordinates, mechanism.rates, strict=True))
    if has_one_slip(mechanism):
        pairs = dict([slip_names(mechanism)])
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    units = {slip: units[slip] for slip in pairs} | {
        rate: per_second(units[slip]) for slip, rate in pairs.items()
    }
    # Ends of whole cycles, which rounding must not put behind the end of the run.
    marks = np.minimum(np.arange(whole + 1) * (period or 0.0), t_end)
    grid = np.unique(np.concatenate([np.linspace(0.0, t_end, POINTS), marks, wanted]))
    runs = ensemble(
        mechanism,
        law,
        draws,
        t_end=t_end,
        outputs={name: Samples(name, grid.tolist()) for name in units},
        y0=y0,
        solver=solver,
        executor=executor,
        progress=progress,
    )
    kept = np.array([status.complete for status in runs.status])
    reasons = left_out(runs.status)
    if not kept.any():
        raise SimulationError(
            f"none of {count} runs with samples of {', '.join(draws)} reached {number(t_end, 6)}"
            f" s. {' '.join(early_ends(runs.status, '', noun='draws'))}"
        )
    travels, means, cycles = {}, {}, {}
    for name in pairs:
        x = runs[name][kept]
        at = x[:, np.searchsorted(grid, marks)]
        travels[name] = travel = x[:, -1] - x[:, 0]
        mean = travel / t_end if whole == 0 else (at[:, -1] - at[:, 0]) / float(marks[-1])
        means[name] = _spread(mean)
        cycles[name] = tuple(_spread(column) for column in np.diff(at, axis=1).T)
    return Band(
        draws={path: values[kept] for path, values in draws.items()},
        count=count,
        ended_early=int((~kept).sum()),
        reasons=reasons,
        seed=seed,
        t=grid,
        states={name: np.quantile(runs[name][kept], QUANTILES, axis=0) for name in units},
        units=units,
        period=period,
        travels={name: _spread(values) for name, values in travels.items()},
        mean_velocities=means,
        travels_by_cycle=cycles,
        correlated=None if estimates is None else _most_correlated(estimates),
        travels_by_run=travels,
    )


def left_out(status: NDArray[np.object_]) -> tuple[str, ...]:
    """Return why runs with draws ended early, which a band leaves out: a sentence a reason."""
    return early_ends(status, NOT_IN_BAND, noun="draws")


def draws_of(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    estimates: LawEstimates | None,
    uncertainties: Mapping[str, float],
    count: int,
    seed: int,
) -> dict[str, Array]:
    """Return values (count,) of all uncertain parameters, of law and mechanism, by path."""
    draws: dict[str, Array] = {}
    if estimates is not None and (estimates.drawn or not uncertainties):
        draws |= estimates.draw(law, count, seed=seed)
    if not uncertainties:
        if not draws:
            raise InputError("no parameter of the law or of the mechanism has an uncertainty.")
        return draws
    declared = [*parameters(mechanism, "mechanism")]
    values = {path: value for path, _, value in declared}
    known = {path: quantity for path, quantity, _ in declared}
    spreads = {full_path(name, known): uncertainty for name, uncertainty in uncertainties.items()}
    random = np.random.default_rng([seed, 1])  # independent of the draws of the law
    # drawn again where a mechanism refuses them: to cut them off at a bound would heap them there
    kept: list[dict[str, float]] = []
    tried = 0
    while len(kept) < count:
        draw = {
            path: float(random.normal(values[path], spread)) for path, spread in spreads.items()
        }
        tried += 1
        with contextlib.suppress(ParameterError):
            vary(mechanism, "mechanism", draw)
            kept.append(draw)
        if tried > count and len(kept) < PERCENT * tried:
            raise InputError(
                f"nearly all samples of {', '.join(spreads)} are invalid for"
                f" {type(mechanism).__name__}: state smaller uncertainties."
            )
    return draws | {path: np.array([entry[path] for entry in kept]) for path in spreads}


def _most_correlated(estimates: LawEstimates) -> tuple[str, str, float] | None:
    """Return the two estimates with the largest correlation, and this; None without any."""
    names, table = estimates.covariance_of, np.array(estimates.covariance)
    if len(names) < 2:
        return None
    spread = np.sqrt(np.diag(table))
    scale = np.where(spread > 0.0, spread, 1.0)
    # Without the diagonal; what has no spread has no correlation.
    matrix = table / np.outer(scale, scale) - np.diag((spread > 0.0).astype(float))
    row, other = np.unravel_index(int(np.argmax(np.abs(matrix))), matrix.shape)
    return f"friction.{names[row]}", f"friction.{names[other]}", float(matrix[row, other])


def _only(what: str, table: Mapping[str, T]) -> T:
    """Return what there is of the only coordinate."""
    if len(table) != 1:
        raise InputError(
            f"this band has several coordinates, {', '.join(table)}: take those of one from"
            f" Band.{what}."
        )
    return next(iter(table.values()))


def _spread(values: Array) -> Spread:
    return Spread(*(float(value) for value in np.quantile(values, QUANTILES)))


# A law on a mechanism against what was measured there: residuals, and whether they are expected.


EXPECTED, REFUTED = 0.05, 0.01
"""Share of simulated measurements with as large a residual, from which on it is expected, and below
which the prediction is refuted; between them nothing is said."""
LEAST_ORIGIN = 10
"""Fewest samples whose mean sets the origin of a position; else a hundredth of the record."""
NOISY = 1.5
"""Residual over noise from which on it is more than noise."""
RECORDED = "recorded_swing"
"""What a recorded motion, whose error is in no band, is called among what is held."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ValidatedRecord(metaclass=Described):
    """A record in time beside the motion that was predicted without it."""

    name: str
    """Name of the record; empty if it has none."""
    quantity: str
    """What is compared, ``"position"`` or ``"velocity"``."""
    unit: str
    """SI unit of it."""
    t: Array
    """Times (n,) of the samples [s]."""
    measured: Array
    """Measured (n,); positions count from where the prediction begins, see `origin`."""
    predicted: Array
    """Predicted with the best values (n,)."""
    origin: float
    """What was taken off measured positions: their mean distance from the prediction in the first
    hundredth of the record, since the zero of a camera or an encoder says nothing of friction."""
    noise: float
    """Standard deviation of the sensor's noise."""
    noise_stated: bool
    """Whether that was stated; else it was estimated from differences of the residual."""
    band: Array | None
    """Ends (2, n) between which 95 % of the predictions lie at each time, with the uncertain
    parameters drawn, and without noise; None if nothing was drawn."""
    wide: Array | None
    """The same (2, n) with the noise of the sensor."""
    as_large: float | None
    """Share of simulated records, with parameters and noise drawn, whose residual is at least as
    large: the root mean square of it over the standard deviation of band and noise at each time."""
    shift: float
    """Shift of the record's times [s] with which its residual is least."""
    shifted_rms: float
    """Root mean square of that residual."""

    @property
    def residual(self) -> Array:
        """Measured less predicted (n,)."""
        return self.measured - self.predicted

    @property
    def rms(self) -> float:
        """Root mean square of the residual."""
        return _rms(self.residual)

    @property
    def largest(self) -> tuple[float, float]:
        """Largest size of the residual, and its time [s]."""
        at = int(np.argmax(np.abs(self.residual)))
        return float(abs(self.residual[at])), float(self.t[at])

    @property
    def inside(self) -> float | None:
        """Share of the samples in the band; None without one."""
        return _share(self.measured, self.band)

    @property
    def inside_with_noise(self) -> float | None:
        """Share of the samples in the band with noise; None without one."""
        return _share(self.measured, self.wide)

    @property
    def agrees(self) -> bool | None:
        """Whether the residual is expected of parameters and noise; None if that is not clear."""
        return _judged(self.as_large)

    @property
    def late(self) -> bool:
        """Whether a shift of the times would explain at least half of the residual."""
        return self.rms > NOISY * self.noise and self.shifted_rms < 0.5 * self.rms

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers, ready for JSON; not the samples."""
        names = ("name", "quantity", "unit", "origin", "noise", "noise_stated", "agrees")
        size, at = self.largest
        return {
            **{name: getattr(self, name) for name in names},
            "samples": len(self.t),
            "residual_rms": self.rms,
            "largest_residual": size,
            "largest_residual_at": at,
            "share_in_band": self.inside,
            "share_in_band_with_noise": self.inside_with_noise,
            "share_with_as_large_residual": self.as_large,
            "time_shift": self.shift,
            "residual_rms_with_time_shift": self.shifted_rms,
        }

    def sentences(self) -> tuple[str, ...]:
        """Return residual, noise and share in the band as sentences."""
        size, at = self.largest
        scale = scale_of([self.rms, size], self.unit)
        texts = [
            f"Residual of the {self.quantity} (measured less predicted): root mean square"
            f" {scale.quantity(self.rms)}, largest {scale.quantity(size)} at {quantity(at, 's')}.",
            f"Noise of the sensor: {quantity(self.noise, self.unit)},"
            f" {'as stated' if self.noise_stated else 'estimated from differences of samples'}.",
        ]
        if abs(self.origin) > NORMAL_95 * self.noise:
            texts.append(
                f"Origin of the {self.quantity}: {quantity(self.origin, self.unit)} were taken off,"
                " the mean distance from the prediction at the beginning of the record."
            )
        if self.band is not None and self.inside is not None:
            half = 0.5 * float(np.max(self.band[1] - self.band[0]))
            texts.append(
                f"95 % band of the prediction: up to {quantity(half, self.unit)} to either side;"
                f" {percent(self.inside)} of the samples lie in it, and"
                f" {percent(self.inside_with_noise or 0.0)} in the band with noise."
            )
        if self.late:
            texts.append(
                f"With its times shifted by {quantity(self.shift, 's')}, the record would differ by"
                f" {quantity(self.shifted_rms, self.unit)} only: check that its time 0 is when the"
                " drive begins."
            )
        return tuple(texts)


@dataclass(frozen=True, kw_only=True)
class ValidatedTravel(metaclass=Described):
    """A travel, mean velocity or travel per cycle beside the prediction."""

    name: str
    """Name of the trial, or its number."""
    quantity: str
    """What was read: ``"travel"``, ``"mean_velocity"`` or ``"travel_per_cycle"``."""
    unit: str
    """SI unit of it."""
    measured: float
    """What was read."""
    uncertainty: float
    """Standard error of the reading; where none was stated, that of its last digit."""
    predicted: float
    """The same of the run with the best values."""
    low: float | None
    """Lower end of the 95 % band of predictions, without the error of reading."""
    high: float | None
    """Upper end."""

    @property
    def residual(self) -> float:
        """Measured less predicted."""
        return self.measured - self.predicted

    def cells(self) -> tuple[str, str, str, str]:
        """Return reading, prediction, its band and whether the reading meets it, as texts."""
        known = [self.measured, self.predicted]
        scale, band = scale_of(known, self.unit), "—"
        if self.low is not None and self.high is not None:
            band = scale.interval(self.low, self.high)
        answer = {True: "yes", False: "no", None: "—"}[self.inside]
        return (*(scale.quantity(x, 4) for x in known), band, answer)  # type: ignore[return-value]

    @property
    def inside(self) -> bool | None:
        """Whether the reading, give or take 1.96 standard errors, meets the band."""
        if self.low is None or self.high is None:
            return None
        room = NORMAL_95 * self.uncertainty
        return self.low - room <= self.measured <= self.high + room

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers, ready for JSON."""
        result = {"residual": self.residual, "relative_error": self.relative_error}
        return {**vars(self), **result, "inside": self.inside}

    @property
    def relative_error(self) -> float | None:
        """Predicted less measured, over measured; None of a reading of 0."""
        return -self.residual / self.measured if self.measured else None


@dataclass(frozen=True, kw_only=True, eq=False)
class Validation(InPanels):
    """What was measured beside what a law from elsewhere predicts of it."""

    records: tuple[ValidatedRecord, ...] = ()
    """Records in time."""
    travels: tuple[ValidatedTravel, ...] = ()
    """Travels, mean velocities or travels per cycle."""
    stated: bool = True
    """Whether uncertainties of the travels were stated."""
    travels_as_large: float | None = None
    """Share of simulated sets of readings, with parameters and errors of reading drawn, whose sum
    of squared standardised residuals is at least that of the readings."""
    drawn: tuple[str, ...] = ()
    """Parameters that were drawn, by path."""
    kept: tuple[str, ...] = ()
    """Parameters of the law that the band leaves out: given, assumed or not identified; and
    ``"recorded_swing"`` where a recorded motion drives."""
    count: int = 0
    """Number of draws."""
    seed: int = 0
    """Of the draws."""
    reasons: tuple[str, ...] = ()
    """Why runs with draws ended early, if some did: a sentence for each reason."""

    @property
    def agrees(self) -> bool | None:
        """Whether all that was measured is expected of the law; None if that cannot be told."""
        seen = [record.agrees for record in self.records]
        if self.travels:
            seen.append(_judged(self.travels_as_large if self.stated else None))
        return False if False in seen else None if None in seen or not seen else True

    @property
    def verdict(self) -> str:
        """Whether the measurement agrees with the prediction, as a sentence."""
        what = "reading" if len(self.travels) == 1 else "set of readings"
        if self.records:
            what = "record" if len(self.records) == 1 else "set of records"
        if self.records and self.travels:
            what = "measurement"
        lacks = ""
        if not self.drawn:
            lacks = "no parameter of the law or of the mechanism has an uncertainty"
        elif self.agrees is None and self.travels and not self.stated:
            lacks = "no uncertainty of the readings was stated"
        if lacks:
            return f"Whether the {what} agrees with the prediction cannot be told: {lacks}."
        if self.agrees is None:
            return (
                f"Whether the {what} agrees with the prediction is not clear: its residuals are"
                f" rather large for the uncertain parameters and {self._errors}, but may be chance"
                f" ({self._odds})."
            )
        if self.agrees:
            return (
                f"The {what} agrees with the prediction: such residuals are expected from the"
                f" uncertain parameters and {self._errors} ({self._odds})."
            )
        left = f", parameters that the band leaves out ({self._kept})" if self.kept else ""
        times = ", times of the record" if self.records else ""
        return (
            f"The {what} does not agree with the prediction: its residuals are larger than the"
            f" uncertain parameters and {self._errors} explain ({self._odds}). Possible causes:"
            " other friction than where the law was fitted, the form of the law, values of the"
            f" mechanism{times}{left}."
        )

    @property
    def _errors(self) -> str:
        return "the noise" if self.records else "errors of reading"

    @property
    def _kept(self) -> str:
        return joined([parameter_words(name) for name in self.kept])

    @property
    def _odds(self) -> str:
        shares = [record.as_large for record in self.records if record.as_large is not None]
        if self.travels and self.travels_as_large is not None:
            shares.append(self.travels_as_large)
        least = min(shares)
        if least == 0.0:
            return f"none of {self.count} simulated measurements has as large ones"
        return f"{percent(least)} of {self.count} simulated measurements have as large ones"

    def sentences(self) -> tuple[str, ...]:
        """Return the verdict, and what it rests on, as sentences."""
        texts = [self.verdict]
        for record in self.records:
            label = f"{record.name}: " if record.name and len(self.records) > 1 else ""
            texts += [f"{label}{text}" for text in record.sentences()]
        if self.travels and not self.stated:
            texts.append(
                "No uncertainty of the readings was stated: half of their last digit was taken."
            )
        if self.drawn:
            names = joined([parameter_words(path) for path in self.drawn])
            left = f" Held at their values: {self._kept}." if self.kept else ""
            no = "measurement noise" if self.records else "error of reading"
            texts.append(
                f"The band includes the uncertainty of {names} ({self.count} draws, seed"
                f" {self.seed}) and no {no}.{left}"
            )
        return (*texts, *self.reasons)

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers, ready for JSON."""
        names = ("agrees", "verdict", "records", "travels", "drawn", "kept", "seed", "reasons")
        result = {name: getattr(self, name) for name in names} | {
            "uncertainty_of_travels_stated": self.stated if self.travels else None,
            "share_with_as_large_residuals_of_travels": self.travels_as_large,
            "draws": self.count,
        }
        return dict(json_value(result))

    def _summary(self) -> Summary:
        first, *rest = self.sentences()
        rows = [
            (travel.name, travel.quantity.replace("_", " "), *travel.cells())
            for travel in self.travels
        ]
        columns = ("trial", "quantity", "measured", "predicted", "95 % band", "meets it")
        head = columns if rows else ()
        return Summary(sentence=first, head=head, rows=rows, notes=rest)


def validate(
    mechanism: Mechanism,
    law: FrictionLaw,
    measurement: Measurement,
    estimates: LawEstimates | None = None,
    *,
    t_end: float = 10.0,
    count: int = 200,
    seed: int = 0,
    executor: Executor | None = None,
) -> Validation:
    """Compare what was measured on a mechanism with what a law from elsewhere predicts of it.

    Nothing is fitted but the origin of measured positions. Parameters of the law are drawn from
    their estimates, and those of the mechanism from `Measurement.parameter_uncertainties`; with
    each draw, and with noise of the sensor, a measurement is simulated. The measurement agrees with
    the prediction if at least 5 % of these have as large residuals, and does not if less than 1 %
    have.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured, with a drive of its own, which begins at time 0.
    law : FrictionLaw
        The law with its best values, such as that of `carried`. If it was fitted to this very
        measurement, agreement says nothing.
    measurement : Measurement
        Records of the position or velocity of the body that slips; or travels, mean velocities or
        travels per cycle.
    estimates : LawEstimates, optional
        How well the law is known.
    t_end : float
        Time at which runs of travels end [s].
    count : int
        Number of draws.
    seed : int
        Of the draws.
    executor : concurrent.futures.Executor, optional
        Where runs with draws are made, with the same result; threads for all cores if not given.

    Returns
    -------
    Validation
        Residuals, bands, and whether the measurement agrees with the prediction.

    Raises
    ------
    InputError
        If the measurement is not of a motion that the mechanism makes by itself.
    SimulationError
        If a run with the best values ends early.
    ConvergenceError
        If a body whose travel to rest was measured still moves at `t_end`.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> law = Coulomb(kinetic_coefficient=0.25)
    >>> known = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.24, 0.26)})
    >>> seen = validate(rig, law, Measurement(travel=0.20, uncertainty=0.001), known)
    >>> (one,) = seen.travels
    >>> round(one.predicted, 4), round(one.low, 2), round(one.high, 2), seen.agrees
    (0.2039, 0.2, 0.21, True)
    """
    used = event_driven_law(mechanism, law)
    if not isinstance(used, FrictionLaw):
        raise InputError(
            f"predictions are compared for mechanisms with one contact, but {mechanism.name} has"
            f" {len(mechanism.contacts())}."
        )
    if count < 2:
        raise InputError(f"validate: count must be at least 2, got {count}.")
    uncertain = _Uncertain(used, estimates, count, seed, executor)
    if any(isinstance(drive, SampledSwing) for drive in mechanism.drives().values()):
        uncertain.kept += (RECORDED,)
    records = measurement.records()
    if any(record.time is not None for record in records):
        doubts = fits.uncertainties_of(mechanism, measurement)
        seen = tuple(
            _record(mechanism, record, uncertain, doubts[index], index)
            for index, record in enumerate(records)
        )
        return Validation(records=seen, **uncertain.summary())
    if not measurement.travelled:
        raise InputError(
            "predictions are compared with positions or velocities in time, or with travels, and"
            f" the measurement has only {joined(measurement.quantities())}."
        )
    return _travels(mechanism, used, measurement, t_end, uncertain)


class _Uncertain:
    """What is drawn, the same in all records and trials where these share it."""

    def __init__(
        self,
        law: FrictionLaw,
        known: LawEstimates | None,
        count: int,
        seed: int,
        executor: Executor | None,
    ) -> None:
        self.law, self.count, self.seed, self.executor = law, count, seed, executor
        self.known = known if known is not None and known.drawn else None
        self.kept: tuple[str, ...] = () if known is None else known.kept
        self.paths: dict[str, None] = {}
        self.reasons: dict[str, None] = {}
        self.random = np.random.default_rng([seed, 2])  # of the noise

    def draws(
        self,
        mechanism: Mechanism,
        separate: Mapping[str, float],
        shared: Mapping[str, float],
        index: int,
    ) -> dict[str, Array]:
        """Return draws for a record or trial of an index; what it does not share is its own."""
        result: dict[str, Array] = {}
        if self.known is not None or shared:
            result |= draws_of(mechanism, self.law, self.known, shared, self.count, self.seed)
        if separate:
            seed = int(np.random.SeedSequence([self.seed, index]).generate_state(1)[0])
            result |= draws_of(mechanism, self.law, None, separate, self.count, seed)
        self.paths |= dict.fromkeys(result)
        return result

    def lasted(self, runs: Ensemble) -> NDArray[np.bool_]:
        """Return which runs with draws lasted (n,), and note why others did not.

        Raises
        ------
        SimulationError
            If none lasted: there is no prediction then.
        """
        self.reasons |= dict.fromkeys(left_out(runs.status))
        complete = np.array([status.complete for status in runs.status], dtype=np.bool_)
        if not complete.any():
            raise SimulationError(" ".join(early_ends(runs.status, "", noun="draws")))
        return complete

    def summary(self) -> dict[str, Any]:
        """Return what a `Validation` says of the draws."""
        drawn = tuple(self.paths)
        return {
            "drawn": drawn,
            "kept": self.kept,
            "count": self.count if drawn else 0,
            "seed": self.seed,
            "reasons": tuple(self.reasons),
        }


def _record(
    mechanism: Mechanism,
    record: Measurement,
    uncertain: _Uncertain,
    doubts: tuple[Mapping[str, float], Mapping[str, float]],
    index: int,
) -> ValidatedRecord:
    """Compare a record in time with the run that begins at time 0."""
    name = record.name or f"record {index + 1}"
    compared = _compared(mechanism, record, name)
    mechanism = vary(mechanism, "mechanism", record.overrides)
    slip, rate = slip_names(mechanism)
    column = slip if compared == "position" else rate
    t = np.asarray(record.time, dtype=np.float64)
    values = np.asarray(record.values(compared), dtype=np.float64)
    bristles = record.initial.keys() - {*mechanism.coordinates, *mechanism.rates}
    start = {state: value for state, value in record.initial.items() if state not in bristles}
    run = simulate(mechanism, uncertain.law, t_end=float(t[-1]), y0=start)
    if not mechanism.drives() and not np.ptp(run[slip]):
        raise InputError(
            f"{name}: nothing moves in the prediction, since {type(mechanism).__name__} has no"
            " drive and begins at rest: give the initial states of the record."
        )
    predicted = run.at(t)[column]
    rows = max(min(len(t), LEAST_ORIGIN), math.ceil(PERCENT * len(t)))
    of_position = float(compared == "position")

    def origin(residual: Array) -> Array:
        """Return what is taken off a residual (n,), or off rows of them (k, n)."""
        first: Array = residual[..., :rows].mean(axis=-1, keepdims=True)
        return of_position * first

    read = values - predicted
    zero = float(origin(read)[0])
    stated = record.usual_uncertainty(compared)
    # Half widths of rounding, or of a 95 % interval, are no standard deviations yet.
    kinds = {"rounding": math.sqrt(3.0), "interval": NORMAL_95}
    noise = (
        noise_of(read, step_of(values))
        if not stated
        else stated / kinds.get(record.uncertainty_kind, 1.0)
    )
    shift, shifted = _shifted(run, column, t, values, origin, cycle_or_none(mechanism))
    band = wide = as_large = None
    draws = uncertain.draws(mechanism, *doubts, index)
    if draws:
        seen = ensemble(
            mechanism,
            uncertain.law,
            draws,
            t_end=float(t[-1]),
            outputs={"seen": Samples(column, t.tolist())},
            y0=start,
            executor=uncertain.executor,
        )
        others = seen["seen"][uncertain.lasted(seen)] - predicted
        # what was measured has its origin taken off, and so must what could have been
        others -= origin(others)
        with_noise = others + uncertain.random.normal(0.0, noise, others.shape)
        with_noise -= origin(with_noise)
        band = predicted + np.quantile(others, QUANTILES[::2], axis=0)
        wide = predicted + np.quantile(with_noise, QUANTILES[::2], axis=0)
        step = step_of(values)
        noises = (  # that of each as it would have been estimated
            np.full(len(others), noise)
            if stated
            else np.array([noise_of(row, step) for row in with_noise])
        )
        # where all draws agree, as at the start, nothing but this keeps rounding from counting
        variance = np.var(others, axis=0) + (1e-9 * float(np.ptp(values))) ** 2
        size = _rms((read - zero) / np.sqrt(variance + noise**2))
        sizes = np.sqrt(np.mean(with_noise**2 / (variance + noises[:, None] ** 2), axis=1))
        as_large = float(np.mean(sizes >= size))
    return ValidatedRecord(
        name=record.name,
        quantity=compared,
        unit=run.units[column],
        t=t,
        measured=values - zero,
        predicted=predicted,
        origin=zero,
        noise=noise,
        noise_stated=stated > 0.0,
        band=band,
        wide=wide,
        as_large=as_large,
        shift=shift,
        shifted_rms=shifted,
    )


def _compared(mechanism: Mechanism, record: Measurement, name: str) -> str:
    """Return what of a record is compared, or refuse a record of another kind of motion."""
    known = record.quantities()
    if record.joints:
        raise InputError(f"{name}: predictions are not compared with records of several joints.")
    by_hand = [key for key in ("force", "reference", "pull", "spring_force") if key in known]
    if by_hand:
        raise InputError(
            f"{name} is driven by what was recorded ({joined(by_hand)}), which a run of"
            f" {type(mechanism).__name__} from its start does not see: `fit` with `validate`"
            " predicts such records."
        )
    compared = next((key for key in ("position", "velocity") if key in known), None)
    if compared is None or record.time is None:
        raise InputError(
            f"{name}: predictions are compared with position or velocity in time, and the"
            f" record has only {joined(known)}."
        )
    first = float(np.asarray(record.time)[0])
    if first < 0.0:
        raise InputError(
            f"{name} begins at {number(first)} s, but the prediction begins at 0 s: shift the times"
            " of the record."
        )
    return compared


def _shifted(
    run: Trajectory,
    column: str,
    t: Array,
    values: Array,
    origin: Callable[[Array], Array],
    period: float | None,
) -> tuple[float, float]:
    """Return the shift of a record's times with the least residual, and that residual.

    Beyond the ends of the run the prediction keeps its first or last value.
    """
    from scipy.optimize import minimize_scalar

    grid = np.union1d(np.linspace(*run.span, FINE), run.t)
    known = run.at(grid)[column]

    def size(shift: float) -> float:
        residual = values - np.interp(t + shift, grid, known)
        return _rms(residual - origin(residual))

    # A tenth of the record, and half a cycle of the drives.
    most = 0.1 * float(t[-1] - t[0])
    most = most if period is None else min(most, 0.5 * period)
    # residuals over shifts have many minima where a motion repeats itself: the lowest is sought
    # first, and refined then
    tried = np.linspace(-most, most, 81)
    best = int(np.argmin([size(shift) for shift in tried]))
    near = (float(tried[max(best - 1, 0)]), float(tried[min(best + 1, 80)]))
    result = minimize_scalar(size, bounds=near, method="bounded")
    return float(result.x), float(result.fun)


def _travels(
    mechanism: Mechanism,
    law: FrictionLaw,
    measurement: Measurement,
    t_end: float,
    uncertain: _Uncertain,
) -> Validation:
    """Compare readings of how far a body came."""
    trials = fits.trials_of(mechanism, measurement, t_end)
    labels = [
        record.name or str(index)
        for index, record in enumerate(measurement.records(), 1)
        for _ in np.atleast_1d(record.values(record.travelled))
    ]
    errors, stated = fits.standard_errors(trials)
    model = fits.TravelModel(law, (), t_end)
    model.check_rest(trials, (), errors)
    predicted = model.travels(trials, ())
    drawn: dict[Hashable, Array] = {}
    for index, trial in enumerate(trials):
        if trial.run not in drawn:
            drawn[trial.run] = _drawn_travels(trial, law, t_end, uncertain, index)
    others = np.array([drawn[trial.run] for trial in trials])  # (trials, draws)
    ends: list[tuple[float | None, float | None]] = [(None, None)] * len(trials)
    as_large = None
    if others.size:
        # the same draw in all trials: they share the law, and so their errors
        others = others[:, np.all(np.isfinite(others), axis=0)]
        if not others.size:
            raise SimulationError(f"no draw lasted in all trials. {' '.join(uncertain.reasons)}")
        scales = [trial.scale for trial in trials]
        low, high = (np.quantile(others, QUANTILES[::2], axis=1) / scales).tolist()
        ends = list(zip(low, high, strict=True))
        spread = np.sqrt(np.var(others, axis=1) + errors**2)
        with_errors = others + uncertain.random.normal(size=others.shape) * errors[:, None]
        simulated = np.sum(((with_errors - predicted[:, None]) / spread[:, None]) ** 2, axis=0)
        seen = np.array([trial.travel for trial in trials])
        as_large = float(np.mean(simulated >= np.sum(((seen - predicted) / spread) ** 2)))
    turning = slips_by_angle(mechanism)
    return Validation(
        travels=tuple(
            ValidatedTravel(
                name=label,
                quantity=trial.quantity,
                unit=turned(QUANTITIES[trial.quantity].unit, turning),
                measured=trial.travel / trial.scale,
                uncertainty=float(error) / trial.scale,
                predicted=float(value) / trial.scale,
                low=low,
                high=high,
            )
            for label, trial, error, value, (low, high) in zip(
                labels, trials, errors, predicted, ends, strict=True
            )
        ),
        stated=stated,
        travels_as_large=as_large,
        **uncertain.summary(),
    )


def _drawn_travels(
    trial: fits.Trial, law: FrictionLaw, t_end: float, uncertain: _Uncertain, index: int
) -> Array:
    """Return the travel of a trial with each draw (n,), NaN where its run ended early."""
    draws = uncertain.draws(trial.mechanism, trial.doubts, trial.shared, index)
    if not draws:
        return np.empty(0)
    slip, _ = slip_names(trial.mechanism)
    end = trial.until(t_end)
    runs = ensemble(
        trial.mechanism,
        law,
        draws,
        t_end=end,
        outputs={"x": Samples(slip, [0.0, end])},
        y0=trial.start(law),
        executor=uncertain.executor,
    )
    travel = runs["x"][:, 1] - runs["x"][:, 0]
    return np.where(uncertain.lasted(runs), travel, np.nan)


def _judged(share: float | None) -> bool | None:
    """Return whether residuals are expected, of the share of simulated ones that are as large."""
    if share is None or REFUTED <= share < EXPECTED:
        return None
    return share >= EXPECTED


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _share(values: Array, band: Array | None) -> float | None:
    """Return the share of values in a band (2, n), its ends give or take rounding."""
    if band is None:
        return None
    room = 1e-9 * float(np.ptp(values))
    return float(np.mean((values >= band[0] - room) & (values <= band[1] + room)))


# A law from elsewhere, fitted to a measurement too: its parameters beside those carried.


@dataclass(frozen=True, kw_only=True)
class ParameterAgreement(metaclass=Described):
    """A parameter as it was carried here, and as a fit to the measurement finds it."""

    path: str
    """Path of the parameter, such as ``"friction.kinetic_coefficient"``."""
    symbol: str
    """Its symbol."""
    unit: str
    """Its SI unit on the mechanism."""
    carried: float
    """Value of the law from elsewhere."""
    low: float | None
    """Lower end of the interval of that; None if it has none."""
    high: float | None
    """Upper end."""
    refitted: Estimate
    """The same from the measurement."""
    standard_error: float | None
    """Of the difference; None where one of both has no interval."""

    @property
    def difference(self) -> float:
        """Refitted less carried."""
        return self.refitted.value - self.carried

    @property
    def agrees(self) -> bool | None:
        """Whether the difference is within 1.96 of its standard errors; None if that is unknown."""
        if self.standard_error is None:
            return None
        return abs(self.difference) <= NORMAL_95 * self.standard_error

    def __str__(self) -> str:
        """Return both values and whether they agree, in one line."""
        here, value, ends = self.refitted, number(self.carried, 4), ", no interval"
        unit = "" if self.unit == "1" else f" {self.unit}"
        if self.low is not None and self.high is not None:
            value = within(self.carried, self.low, self.high)
            ends = f" ({interval(self.low, self.high)})"
        new = within(here.value, here.low, here.high) if here.bounded else number(here.value)
        both = (
            f"{self.symbol}: carried {value}{unit}{ends}, refitted {new}{unit}"
            f" ({here.range if here.bounded else 'not bounded'})"
        )
        if self.agrees is None:
            reason = f" ({here.reason})" if here.reason else ""
            why = (
                f"this measurement does not determine it{reason}"
                if not here.bounded
                else "the carried value has no interval"
            )
            return f"{both}: cannot be compared, {why}"
        share = abs(self.difference) / self.standard_error if self.standard_error else math.inf
        apart = f"{number(abs(self.difference), 2)}{unit}, {number(share, 2)} standard errors"
        return f"{both}: {'agree' if self.agrees else 'do not agree'} (difference {apart})"

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers, ready for JSON."""
        return {
            "parameter": self.path,
            "symbol": self.symbol,
            "unit": self.unit,
            "carried": {"value": self.carried, "low": self.low, "high": self.high},
            "refitted": dict(self.refitted.to_dict()),
            "difference": self.difference,
            "standard_error_of_difference": self.standard_error,
            "agrees": self.agrees,
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Refit(metaclass=Described):
    """A law from elsewhere that was fitted to a measurement, too."""

    fit: Fit
    """The fit to the measurement."""
    parameters: tuple[ParameterAgreement, ...]
    """Its parameters beside those that were carried."""

    @property
    def explains(self) -> bool | None:
        """Whether a law of the type describes the record; None if nothing was told of that."""
        verdict = self.fit.verdict if isinstance(self.fit, LawFit) else None
        return None if verdict is None or not self.fit.estimates else verdict.explained

    def sentences(self, seen: Validation | None) -> tuple[str, ...]:
        """Return each parameter beside what was carried, and what limits the comparison.

        Parameters
        ----------
        seen : Validation, optional
            The measurement beside the prediction, which knows the noise.

        Returns
        -------
        tuple of str
            Sentences.
        """
        texts = [f"{parameter}." for parameter in self.parameters]
        if self.explains is False:
            texts.append(
                "The refitted law does not describe the record either, so that its values and"
                " intervals may be biased."
            )
        if seen is not None and any(record.late for record in seen.records):
            texts.append(
                "The times of the record may be shifted (see above), which biases the refitted"
                " values."
            )
        return tuple(texts)

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers, ready for JSON."""
        return dict(json_value({"parameters": self.parameters, "fit": self.fit}))


def compare_estimates(
    law: FrictionLaw, estimates: LawEstimates | None, fit: Fit
) -> tuple[ParameterAgreement, ...]:
    """Compare the parameters of a law from elsewhere with those of a fit to a measurement.

    Parameters
    ----------
    law : FrictionLaw
        The law with its values.
    estimates : LawEstimates or None
        How well these are known.
    fit : Fit
        A fit of the same kind of law.

    Returns
    -------
    tuple of ParameterAgreement
        One for each parameter of the law that was fitted. Two values agree if their difference is
        within 1.96 of its standard errors, those of both intervals taken together as independent.

    Raises
    ------
    InputError
        If the laws are of different kinds.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, fit
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> law = Coulomb(kinetic_coefficient=0.30)
    >>> known = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.29, 0.31)})
    >>> here = fit(rig, Coulomb, Measurement(travel=0.20, uncertainty=0.001))
    >>> print(*compare_estimates(law, known, here))
    mu_k: carried 0.300 (0.290 to 0.310), refitted 0.255 (0.250 to 0.262): do not agree (differ...
    """
    if not isinstance(fit.law, type(law)):
        raise InputError(
            f"compare_estimates takes a fit of {law.name}, got one of {fit.law.name}: fit that law."
        )
    values = {path: value for path, _, value in parameters(law, "friction")}
    result = []
    for estimate in fit.estimates:
        if estimate.path not in values:
            continue
        name = estimate.path.removeprefix("friction.")
        known = {} if estimates is None else estimates.intervals
        low, high = known.get(name, (None, None))
        error = None
        if estimates is not None and low is not None and high is not None and estimate.bounded:
            error = math.hypot(
                spread_of(values[estimate.path], low, high, estimates.interval),
                spread_of(estimate.value, estimate.low, estimate.high, estimate.interval),
            )
        result.append(
            ParameterAgreement(
                path=estimate.path,
                symbol=estimate.quantity.symbol,
                unit=unit_of_law(fit.mechanism, estimate.quantity),
                carried=values[estimate.path],
                low=low,
                high=high,
                refitted=estimate,
                standard_error=error,
            )
        )
    return tuple(result)
