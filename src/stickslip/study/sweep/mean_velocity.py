"""Mean velocity over grids of parameters.

A motion under drives that repeat themselves has a mean velocity over whole cycles,

    V = (x(t_end) - x(t_end - n T)) / (n T).

1. The axes are multiplied out; each row has the period T of its own drives.
2. Rows whose periods are alike share an ensemble, and so an end, `settle` + n cycles of the longest
   one; each has the mean of the rate over its own last n periods.
3. The mean over the last n / 2 of them tells how settled the motion is: 0 in a steady one.
4. A motion closes if what n / 2 cycles at most bring comes again, in all coordinates and rates. The
   mean of one that does not may depend on its start: it is run again from a start `ROUNDING` of its
   size away. It is chaotic if both means are farther apart than a thousand times that. Else its
   largest Lyapunov exponent, from where it ended, tells: chaos has one above 0 by three standard
   errors. That neighbours came together tells nothing: a body that rests for once forgets them.
5. A run that ends early has no mean, and the map says why.

A band over many laws has the velocities of each, and errors of predictions beside them: quantiles
of Student's t with four degrees of freedom, times a scale, are added to each law's velocity, and
ends of the band are quantiles of all of that at each value.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtrit

from stickslip.engine.simulation import (
    GivenFriction,
    beginning_pair,
    ensemble,
    event_driven_law,
)
from stickslip.engine.solver import EventDriven, Mean, Samples
from stickslip.engine.trajectory import Status
from stickslip.errors import InputError, SimulationError
from stickslip.mechanisms import WHOLE, Mechanism, slip_among
from stickslip.show.display import OnAxes, Summary, Tabular, require_library
from stickslip.show.formatting import number, percent, quantity, span
from stickslip.study.energy import columns_of, units_of_columns
from stickslip.study.sweep import parameter_grid as grid
from stickslip.study.sweep.lyapunov import closing, have_left, is_chaotic, starts_nearby
from stickslip.study.sweep.parameter_grid import Array, Progress, early_ends
from stickslip.study.sweep.sections import speeds_of
from stickslip.study.tolerances import ALIKE, ROUNDING

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

FREEDOM, ERRORS = 4.0, 400
"""Degrees of freedom of errors of predictions, and quantiles that stand for them."""
TOGETHER = 1.25
"""Runs whose periods differ by less share an ensemble, and so an end: a quarter of it is lost."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class VelocityMap(OnAxes):
    """Mean velocities over a grid; arrays have one dimension for each of the `axes`."""

    axes: Mapping[str, Array]
    """What varies, an array for each full path."""
    units: Mapping[str, str]
    """SI unit of each path."""
    unit: str
    """SI unit of the velocity."""
    velocity: Array
    """Mean velocity over whole cycles; NaN where a run ended early, as `early_ends` says."""
    unsettled: Array
    """How far the second half of these cycles differs from all of them: 0 in a steady motion."""
    closes: NDArray[np.int64]
    """After how many cycles each motion closes; 0 if it does not within half of those sampled, or
    ended early."""
    spread: Array
    """Difference of the means of a motion that does not close from two starts 1e-9 of its size
    apart; NaN of others."""
    chaotic: NDArray[np.bool_]
    """Whether each motion is chaotic."""
    period: Array
    """Length of a cycle [s]."""
    status: NDArray[np.object_]
    """How each run ended, a `Status` each."""
    certified: NDArray[np.bool_]
    """Whether each run passed every check of its certificate."""
    coordinate: str = ""
    """The coordinate whose mean rate it is, if one was named."""
    energies: Mapping[str, Array] = field(default_factory=dict)
    """Mean powers [W] and energy per travel by `EnergyBalance.columns`, if asked for."""

    def reversals(self) -> Array:
        """Return where the velocity changes its sign along the only axis, by straight lines.

        Where the body does not move on, its velocity has no sign: between motion one way and the
        other with such points in between, their middle counts.
        """
        if len(self.axes) != 1:
            raise InputError(
                f"reversals are defined along one axis, but this map has {len(self.axes)}."
            )
        (values,) = self.axes.values()
        moving = self.moves()
        x, v, rows = values[moving], self.velocity[moving], np.flatnonzero(moving)
        turns = np.flatnonzero(v[1:] * v[:-1] < 0.0)
        apart = rows[turns + 1] - rows[turns] > 1
        share = np.where(apart, 0.5, v[turns] / (v[turns] - v[turns + 1]))
        result: Array = x[turns] + share * (x[turns + 1] - x[turns])
        return result

    def early_ends(self) -> tuple[str, ...]:
        """Return where there is no velocity, and why: a sentence for each reason."""
        return early_ends(self.status, "No mean velocity there.", self.axes, self.units)

    def open_motions(self) -> tuple[str, ...]:
        """Return where motions do not close, and how far their means are known: sentences."""
        complete = np.isfinite(self.velocity)
        kinds = {
            "is chaotic": self.chaotic,
            "does not close, and is not chaotic: it is quasi-periodic, of a longer period, or has"
            " not settled": complete & (self.closes == 0) & ~self.chaotic,
        }
        sentences = []
        for what, here in kinds.items():
            if here.any():
                where = grid.where_of(here, self.axes, self.units)
                apart = quantity(float(np.nan_to_num(self.spread[here]).max()), self.unit, 2)
                sentences.append(
                    f"At {int(here.sum())} of {here.size} points{where} the motion {what}. Means"
                    f" from starts 1e-9 of its size apart differ by up to {apart} there."
                )
        return tuple(sentences)

    def moves(self) -> NDArray[np.bool_]:
        """Return where the body moves on: its velocity is not small, and larger than its doubt."""
        least = ALIKE * float(np.nanmax(np.abs(self.velocity), initial=0.0))
        doubt = np.fmax(np.maximum(least, 2.0 * self.unsettled), self.spread)
        with np.errstate(invalid="ignore"):
            return np.asarray(np.abs(self.velocity) > doubt)

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each point of the grid, with the reason where it has no velocity."""
        import pandas as pd

        columns: dict[str, object] = dict(grid.product(self.axes))
        for name in ("period", "velocity", "unsettled", "closes", "spread", "chaotic"):
            columns[name] = getattr(self, name).ravel()
        columns |= {name: values.ravel() for name, values in self.energies.items()}
        columns["status"] = grid.names_of(self.status).ravel()
        columns["reason"] = grid.reasons_of(self.status)
        return pd.DataFrame(columns | {"certified": self.certified.ravel()})

    def to_xarray(self) -> "xr.Dataset":
        """Return the map as an xarray Dataset over its parameters, with units.

        Raises
        ------
        InputError
            If xarray is not installed.
        """
        require_library("xarray", "xarray", "use to_dataframe")
        import xarray as xr

        over = tuple(self.axes)
        columns: dict[str, Any] = {"period": (over, self.period, {"units": "s"})}
        for name in ("velocity", "unsettled", "spread"):
            columns[name] = over, getattr(self, name), {"units": self.unit}
        columns |= {name: (over, getattr(self, name)) for name in ("closes", "chaotic")}
        columns["status"] = over, grid.names_of(self.status)
        columns["certified"] = over, self.certified
        units = units_of_columns(self.energies, self.unit.removesuffix("/s"))
        columns |= {n: (over, self.energies[n], {"units": unit}) for n, unit in units.items()}
        axes = {name: (name, at, {"units": self.units[name]}) for name, at in self.axes.items()}
        return xr.Dataset(columns, axes)

    def _summary(self) -> Summary:
        known = np.isfinite(self.velocity)
        rows, picks = [], (("largest", np.nanargmax), ("least", np.nanargmin))
        for word, pick in picks if known.any() else ():
            place = np.unravel_index(pick(self.velocity), self.velocity.shape)
            at = [
                f"{number(values[i], 6)} {self.units[name]}"
                for i, (name, values) in zip(place, self.axes.items(), strict=True)
            ]
            rows.append((word, number(self.velocity[place] + 0.0, 6), *at))
        over = [
            f"{path} {span(float(x.min()), float(x.max()), self.units[path], 4)}, {len(x)} values"
            for path, x in self.axes.items()
        ]
        turns = self.reversals().tolist() if len(self.axes) == 1 else []
        unit = self.units[next(iter(self.axes))]
        changes = "The mean velocity changes sign at about"
        return Summary(
            sentence=f"{known.sum()} of {known.size} runs have a velocity; {'; '.join(over)}.",
            head=(" ".join(["mean velocity", self.coordinate]).strip(), self.unit, *self.axes),
            rows=rows,
            notes=(
                *(f"{changes} {quantity(x, unit, 3)}." for x in turns),
                *self.open_motions(),
                *self.early_ends(),
            ),
        )


def average_velocity(
    mechanism: Mechanism,
    law: GivenFriction,
    parameters: Mapping[str, ArrayLike],
    *,
    coordinate: str | None = None,
    cycles: int = 20,
    settle: int = 100,
    period: float | None = None,
    energy: bool = False,
    y0: Mapping[str, float] | Sequence[float] | None = None,
    solver: EventDriven | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> VelocityMap:
    """Return the mean velocity of a driven mechanism over a grid of parameters.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back; laws by contact where there are several.
    parameters : mapping
        The axes of the grid, an array for each path as in `ensemble`, such as
        ``"mechanism.drive.drive.frequency"``; all their combinations are run.
    coordinate : str, optional
        Coordinate whose mean rate is taken; that along which contacts slip if not given. It has to
        be named where they slip along several.
    cycles : int
        Whole cycles of the drive over which the mean is taken; even, so that they can be halved.
    settle : int
        Cycles before them, at least.
    period : float, optional
        Length of a cycle [s] in all runs; that of each run's drives if not given.
    energy : bool
        Whether mean powers of drives, friction, dampers and stops are kept over these cycles, and
        the energy per travel; each point is run once more for that.
    y0 : mapping or sequence, optional
        Initial states, as in `simulate`.
    solver : EventDriven, optional
        Tolerances, limits and tier, as in `ensemble`.
    executor : concurrent.futures.Executor, optional
        Where chunks of runs are executed, as in `ensemble`.
    progress : callable, optional
        Called with the number of runs done and of all; if it returns False, no more begin.

    Returns
    -------
    VelocityMap
        Velocities, how settled they are, and how each run ended.

    Raises
    ------
    InputError
        If an argument cannot be used, or the drives have no cycle.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    >>> friction = {"kinetic_coefficient": [0.2, 0.3]}
    >>> found = average_velocity(capsule, Coulomb(kinetic_coefficient=0.2), friction, settle=2)
    >>> found.velocity.round(6)
    array([0.046037, 0.032335])
    """
    law = event_driven_law(mechanism, law)
    slip, rate = slip_among(mechanism, coordinate, "average_velocity")
    _check(parameters, cycles, settle)
    if energy:
        columns_of(mechanism)  # refuses what has no balance, before anything runs
    mechanism, law = beginning_pair(mechanism, law, parameters)
    if period is None:
        # Cycles of a period that was given need not be those of the drives.
        grid.whole_run("average_velocity", mechanism, settle + cycles)
    axes = dict(grid.axis_of(mechanism, law, path, values) for path, values in parameters.items())
    columns = grid.product(axes)
    periods = grid.cycles_of(mechanism, columns, period)
    tally = grid.Tally(len(periods), progress)
    nothing = np.full(len(periods), np.nan)
    table: dict[str, Any] = {"velocity": nothing, "unsettled": nothing.copy(), "period": periods}
    table |= {"spread": nothing.copy(), "closes": np.zeros(len(periods), dtype=np.int64)}
    table |= {name: np.zeros(len(periods), dtype=np.bool_) for name in ("chaotic", "certified")}
    table["status"] = np.full(len(periods), Status.CANCELLED, dtype=object)
    solver, names = grid.compiled(solver), (*mechanism.coordinates, *mechanism.rates)
    # an ensemble has one end: rows of short periods would run on for those of long ones
    for rows in grid.near(periods, TOGETHER):
        if not tally.going:
            break
        own = {path: values[rows] for path, values in columns.items()}
        t_end = float((settle + cycles) * periods[rows].max())
        strobes = _strobes(t_end, periods[rows], cycles)
        runs = ensemble(
            mechanism,
            law,
            own,
            t_end=t_end,
            outputs={
                "all": Mean(rate, last=cycles * periods[rows]),
                # the late half tells whether the mean still drifts
                "late": Mean(rate, last=cycles // 2 * periods[rows]),
                **{name: Samples(name, strobes) for name in names},
            },
            y0=y0,
            solver=solver,
            executor=executor,
            progress=tally.part(),
        )
        # a run that ended early would have the mean of what it had by then
        whole = np.array([status.complete for status in runs.status])
        velocity = table["velocity"][rows] = np.where(whole, runs["all"], np.nan)
        # half of what the mean changes between both halves
        table["unsettled"][rows] = np.abs(runs["late"] - velocity)
        table["status"][rows], table["certified"][rows] = runs.status, runs.certified
        samples = np.stack([runs[name] for name in names], axis=2)
        closes, sizes = closing(samples, periods[rows])
        table["closes"][rows] = np.where(np.isfinite(velocity), closes, 0)
        left = np.flatnonzero(np.isfinite(velocity) & (closes == 0))
        if not len(left):
            continue
        some = {path: values[left] for path, values in own.items()}
        near = ensemble(
            mechanism,
            law,
            starts_nearby(mechanism, law, y0, some, ROUNDING * sizes[left]),
            t_end=t_end,
            outputs={"all": Mean(rate, last=cycles * periods[rows][left])},
            y0=y0,
            solver=solver,
            executor=executor,
        )
        spread = np.abs(near["all"] - runs["all"][left])
        apart = ROUNDING * sizes[left, len(mechanism.coordinates) + mechanism.rates.index(rate)]
        table["spread"][rows[left]] = spread
        apart_by_now = have_left(spread / apart)
        table["chaotic"][rows[left]] = apart_by_now
        for k in left[~apart_by_now].tolist():
            at = {path: float(values[k]) for path, values in own.items()}
            pair = grid.pair_of(mechanism, law, at)
            moved = strobes[k, -1] * speeds_of(pair[0], names)
            end = dict(zip(names, (samples[k, -1] - moved).tolist(), strict=True))
            with suppress(SimulationError, InputError):  # one that ends, or has no derivative
                table["chaotic"][rows[k]] = is_chaotic(*pair, end, period, solver)
    units = {path: grid.unit_of(mechanism, law, path) for path in axes}
    shape = tuple(map(len, axes.values()))
    unit = mechanism.units[mechanism.coordinates.index(slip)] + "/s"
    powers: dict[str, Array] = {}
    if energy:
        spans = np.outer(periods, [settle, settle + cycles])
        spans[~np.isfinite(table["velocity"])] = np.nan
        powers = grid.energies_of(mechanism, law, columns, spans, y0, solver, slip)
    return VelocityMap(
        axes=axes,
        units=units,
        unit=unit,
        coordinate=coordinate or "",
        energies={name: column.reshape(shape) for name, column in powers.items()},
        **{name: column.reshape(shape) for name, column in table.items()},
    )


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class VelocityBand(OnAxes, Tabular):
    """Mean velocities over one parameter with many laws, and the band in which they lie."""

    path: str
    """What varies, as a full path."""
    values: Array
    """Its values (n,)."""
    unit: str
    """Its SI unit."""
    velocities: Array
    """Mean velocities (m, n) of m laws [m/s] or [rad/s]; NaN where a run ended early."""
    velocity_unit: str
    """Their SI unit."""
    level: float
    """Probability of the band, point by point."""
    error: float = 0.0
    """By how much predictions are off beside what the laws tell [m/s] or [rad/s]."""
    status: NDArray[np.object_]
    """How each run ended, a `Status` each (m, n)."""

    def early_ends(self) -> tuple[str, ...]:
        """Return where laws have no velocity, and why: a sentence for each reason."""
        axes, units = {self.path: self.values}, {self.path: self.unit}
        noun = f"runs with {len(self.velocities)} laws"
        return early_ends(self.status.T, grid.NOT_IN_BAND, axes, units, noun)

    @property
    def low(self) -> Array:
        """Lower end of the band (n,)."""
        return self._quantile(0.5 - 0.5 * self.level)

    @property
    def median(self) -> Array:
        """Median (n,)."""
        return self._quantile(0.5)

    @property
    def high(self) -> Array:
        """Upper end of the band (n,)."""
        return self._quantile(0.5 + 0.5 * self.level)

    def _quantile(self, share: float) -> Array:
        # Quantiles of the error at even probabilities, with every law.
        # quantiles instead of draws: a band has the same ends each time
        off = self.error * stdtrit(FREEDOM, (np.arange(ERRORS) + 0.5) / ERRORS)
        every = (self.velocities[:, None] + off[:, None]).reshape(-1, len(self.values))
        result = np.full(len(self.values), np.nan)
        known = np.isfinite(every).any(axis=0)
        result[known] = np.nanquantile(every[:, known], share, axis=0)
        return result

    @property
    def fastest(self) -> float:
        """Value with which the body is fastest, either way, with the largest median."""
        return float(self.values[self._fastest])

    @property
    def _fastest(self) -> int:
        size = np.abs(self.median)
        if not np.isfinite(size).any():
            raise InputError(f"no law has a velocity anywhere. {' '.join(self.early_ends())}")
        return int(np.nanargmax(size))

    def _over(self) -> str:
        return self.path

    def _column_units(self) -> Mapping[str, str]:
        ends = dict.fromkeys(("low", "median", "high"), self.velocity_unit)
        return {self.path: self.unit} | ends

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each value: the band, and how many laws have a velocity there."""
        import pandas as pd

        columns = {"low": self.low, "median": self.median, "high": self.high}
        columns["laws"] = np.isfinite(self.velocities).sum(axis=0)
        return pd.DataFrame({self.path: self.values, **columns})

    def _summary(self) -> Summary:
        over = span(float(self.values.min()), float(self.values.max()), self.unit, 4)
        rows = [(self.path, f"{over}, {len(self.values)} values")]
        if np.isfinite(self.velocities).any():
            at = self._fastest
            ends = span(float(self.low[at]), float(self.high[at]), self.velocity_unit, 4)
            rows.append(("fastest", f"{ends} at {quantity(self.fastest, self.unit, 4)}"))
        return Summary(
            sentence=f"{percent(self.level)} band over {len(self.velocities)} laws.",
            rows=rows,
            notes=self.early_ends(),
        )


def velocity_band(
    mechanism: Mechanism,
    laws: Sequence[GivenFriction],
    parameters: Mapping[str, ArrayLike],
    *,
    level: float = 0.95,
    error: float = 0.0,
    cycles: int = 20,
    settle: int = 100,
    y0: Mapping[str, float] | Sequence[float] | None = None,
    solver: EventDriven | None = None,
    progress: Progress | None = None,
) -> VelocityBand:
    """Return the band of the mean velocity over one parameter, for some candidate laws.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    laws : sequence of FrictionLaw
        Laws, such as those that `sample` of a verdict draws.
    parameters : mapping
        Path of one parameter -> its values (n,), as in `average_velocity`.
    level : float
        Probability of the band at each value.
    error : float
        By how much predictions at values that were not measured are off beside what the laws tell
        [m/s] or [rad/s], as `TravelVerdict.prediction_error` says: the scale of Student's t with
        four degrees of freedom.
    cycles, settle : int
        Whole cycles over which the mean is taken, and those before, as in `average_velocity`.
    y0 : mapping or sequence, optional
        Initial states, as in `simulate`.
    solver : EventDriven, optional
        Tolerances, limits and tier, as in `ensemble`.
    progress : callable, optional
        Called with the number of laws done and of all; if it returns False, no more begin.

    Returns
    -------
    VelocityBand
        Velocities by law, and their band.

    Raises
    ------
    InputError
        If there is no law, or more than one parameter.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    >>> laws = [Coulomb(kinetic_coefficient=mu) for mu in (0.19, 0.2, 0.21)]
    >>> masses = {"mechanism.inner_mass": [0.1, 0.2]}
    >>> band = velocity_band(capsule, laws, masses, settle=2, cycles=2)
    >>> band.median.round(4), band.fastest
    (array([0.0147, 0.0444]), 0.2)
    """
    if not laws or len(parameters) != 1:
        raise InputError(
            f"velocity_band takes laws and one parameter, got {len(laws)} laws and"
            f" {len(parameters)} parameters."
        )
    tally, maps = grid.Tally(len(laws), progress), list[VelocityMap]()
    for law in laws:
        if not tally.going:
            break
        maps.append(
            average_velocity(
                mechanism, law, parameters, cycles=cycles, settle=settle, y0=y0, solver=solver
            )
        )
        tally.tell(len(maps))
    ((path, values),) = maps[0].axes.items()
    return VelocityBand(
        path=path,
        values=values,
        unit=maps[0].units[path],
        velocities=np.array([velocity_map.velocity for velocity_map in maps]),
        velocity_unit=maps[0].unit,
        level=level,
        error=error,
        status=np.array([velocity_map.status for velocity_map in maps]),
    )


def _strobes(t_end: float, periods: Array, cycles: int) -> Array:
    """Return the last times (n, cycles + 1) of runs that are multiples of their periods."""
    last = np.floor(t_end / periods * (1.0 + WHOLE))
    times = (last[:, None] - np.arange(cycles, -1.0, -1.0)) * periods[:, None]
    return np.asarray(np.clip(times, 0.0, t_end))


def _check(parameters: object, cycles: int, settle: int) -> None:
    grid.counted("average_velocity", "settle", settle, 0)
    if grid.counted("average_velocity", "cycles", cycles, 2) % 2:
        raise InputError(f"average_velocity: cycles must be even, got {cycles}.")
    if not isinstance(parameters, Mapping) or not parameters:
        raise InputError(f"parameters must map at least one path to numbers, got {parameters!r}.")
