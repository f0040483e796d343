"""What the uncertainties of law and rig make of a motion: an ensemble, and a band of its runs.

1. Parameters of the law are drawn with the covariance of their estimates, or taken from laws that
   were drawn; those of the mechanism from normal distributions, independent of the law and of
   each other. Draws that the mechanism refuses are drawn again.
2. Each draw is a run; states are kept at even times, at whole cycles of the drives, and at the
   times asked for. Runs that end early are left out, and counted with their reasons.
3. At each time the 2.5, 50 and 97.5 % quantiles of each state are the band; travels, mean
   velocities and travels by cycle are quantiles of those of the runs, not of the band.

Noise of sensors is not part of the band.
"""

import contextlib
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.data import LawEstimates
from stickslip.engine.simulation import GivenFriction, ensemble, event_driven_law
from stickslip.engine.solver import EventDriven, Samples
from stickslip.engine.trajectory import completed
from stickslip.errors import (
    InputError,
    ParameterError,
    SimulationError,
    UnknownNameError,
    check_size,
)
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import WHOLE, Mechanism, cycle_or_none, has_one_slip, slip_names
from stickslip.quantities import full_path, parameters, vary
from stickslip.show.display import OnAxes, Summary, Tabular
from stickslip.show.formatting import Scale, number, scale_of, within
from stickslip.study.sweep import design
from stickslip.study.sweep.parameter_grid import NOT_IN_BAND, early_ends
from stickslip.study.tolerances import PERCENT
from stickslip.units import per_second

if TYPE_CHECKING:
    import pandas as pd

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
