"""What the doubt of a law makes of a motion: an ensemble over its estimates, a band, not a line."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import override

from stickslip.display import OnAxes, Summary
from stickslip.errors import InputError, SimulationError
from stickslip.experiments import LawEstimates
from stickslip.formatting import number
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import WHOLE, Mechanism, cycle_or_none, slip_names
from stickslip.simulation import ensemble, own_law
from stickslip.solver import EventDriven, Samples
from stickslip.trajectory import completed

__all__ = ["Band", "Spread", "band_of"]

Array: TypeAlias = NDArray[np.float64]

QUANTILES = (0.025, 0.5, 0.975)
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


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Band(OnAxes):
    """Runs of one mechanism with draws of a law's parameters."""

    draws: Mapping[str, Array]
    """Parameters (n,) of the runs that lasted to their end, by full path."""
    count: int
    """Runs that were made."""
    ended_early: int
    """Runs that did not last, which the band leaves out."""
    seed: int
    """Of the draws."""
    t: Array
    """Times (m,) [s]."""
    states: Mapping[str, Array]
    """Lower end, median and upper end (3, m) of the slip coordinate and its rate, by name."""
    units: Mapping[str, str]
    """SI unit of each of them."""
    travel: Spread
    """Last position less the first [m] or [rad]."""
    mean_velocity: Spread
    """Over all whole cycles, or without any over the run [m/s] or [rad/s]."""
    period: float | None
    """Length of a cycle of the drives [s], if there is one."""
    cycles: tuple[Spread, ...]
    """Travel of each whole cycle [m] or [rad]."""

    def at(self, name: str, t: ArrayLike) -> Array:
        """Return lower end, median and upper end (3, n) of a state at some of the times `t`.

        Parameters
        ----------
        name : str
            Name of the state.
        t : array_like (n,)
            Times [s]; the next of the band's own times is taken, the last one beyond them.

        Returns
        -------
        array (3, n)
            Lower end, median and upper end, in the state's unit.
        """
        places = np.searchsorted(self.t, np.asarray(t, dtype=np.float64))
        found: Array = self.states[name][:, np.minimum(places, len(self.t) - 1)]
        return found

    @override
    def _summary(self) -> Summary:
        unit = next(iter(self.units.values()))
        rows = [
            (name, *(number(value, 4) for value in spread), shown)
            for name, spread, shown in (
                ("travel", self.travel, unit),
                ("mean velocity", self.mean_velocity, f"{unit}/s"),
            )
        ]
        lasted = self.count - self.ended_early
        return Summary(
            sentence=completed(lasted, self.count),
            head=("", "2.5 %", "median", "97.5 %", "unit"),
            rows=rows,
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers, ready for JSON."""
        return {
            "runs": self.count,
            "ended_early": self.ended_early,
            "seed": self.seed,
            "parameters": {path: _spread(values)._asdict() for path, values in self.draws.items()},
            "travel": self.travel._asdict(),
            "mean_velocity": self.mean_velocity._asdict(),
            "travel_by_cycle": [one._asdict() for one in self.cycles],
        }


def band_of(
    mechanism: Mechanism,
    law: FrictionLaw,
    estimates: LawEstimates,
    *,
    t_end: float,
    count: int = 200,
    seed: int = 0,
    times: ArrayLike = (),
    y0: Mapping[str, float] | Sequence[float] | None = None,
    solver: EventDriven | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Band:
    """Run a mechanism with draws of a law's parameters.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw
        What holds it back, with its best values.
    estimates : LawEstimates
        How well these are known; parameters without an interval keep their values.
    t_end : float
        Last time of every run [s].
    count : int
        Number of runs, at least 2. The ends of the band are then the 2.5 % and 97.5 % quantiles of
        that many: of 100 runs they lie near the second and the last but one.
    seed : int
        Of the draws.
    times : array_like (n,), optional
        Times [s] at which the band is wanted; 601 even ones are added.
    y0 : mapping or sequence, optional
        Initial states, as in `ensemble`.
    solver : EventDriven, optional
        Tolerances, limits and tier, as in `ensemble`.
    progress : callable, optional
        Called with runs done and in all, as in `ensemble`.

    Returns
    -------
    Band
        Median and ends of 95 % of position and velocity, travel, travel per cycle, mean velocity.

    Raises
    ------
    InputError
        If an argument cannot be used, or no parameter has an interval.
    SimulationError
        If no run lasts to its end.

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
    law = own_law(mechanism, law)
    draws = estimates.draw(law, count, seed=seed)
    slip, rate = slip_names(mechanism)
    unit = mechanism.units[mechanism.coordinates.index(slip)]
    period = cycle_or_none(mechanism)
    # with a margin for rounding: the last cycle may end a hair after t_end
    whole = 0 if period is None else int(np.floor(t_end / period * (1.0 + WHOLE)))
    marks = np.minimum(np.arange(whole + 1) * (period or 0.0), t_end)
    asked = np.asarray(times, dtype=np.float64).ravel()
    grid = np.unique(np.concatenate([np.linspace(0.0, t_end, POINTS), marks, asked]))
    runs = ensemble(
        mechanism,
        law,
        draws,
        t_end=t_end,
        outputs={name: Samples(name, grid.tolist()) for name in (slip, rate)},
        y0=y0,
        solver=solver,
        progress=progress,
    )
    kept = np.array([status.complete for status in runs.status])
    if not kept.any():
        raise SimulationError(
            f"none of {count} runs with samples of {', '.join(draws)} reached {number(t_end, 6)}"
            f" s: {runs.status[0].value}"
        )
    x, v = runs[slip][kept], runs[rate][kept]
    at = x[:, np.searchsorted(grid, marks)]
    travel = x[:, -1] - x[:, 0]
    mean = travel / t_end if whole == 0 else (at[:, -1] - at[:, 0]) / float(marks[-1])
    return Band(
        draws={path: values[kept] for path, values in draws.items()},
        count=count,
        ended_early=int((~kept).sum()),
        seed=seed,
        t=grid,
        states={
            slip: np.quantile(x, QUANTILES, axis=0),
            rate: np.quantile(v, QUANTILES, axis=0),
        },
        units=dict(zip((slip, rate), (unit, f"{unit}/s"), strict=True)),
        travel=_spread(travel),
        mean_velocity=_spread(mean),
        period=period,
        cycles=tuple(_spread(column) for column in np.diff(at, axis=1).T),
    )


def _spread(values: Array) -> Spread:
    return Spread(*(float(one) for one in np.quantile(values, QUANTILES)))
