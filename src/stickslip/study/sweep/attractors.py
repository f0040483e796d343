"""Settled motion: cycles of the drives, and basins of attraction.

1. A motion closes after m cycles of the drives if what m of them bring agrees; else it is of no
   period that was asked for.
2. Basins are a grid of starts, each with the motion in which its run ends.
"""

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.engine import simulation
from stickslip.engine.solver import EventDriven, Output, Samples
from stickslip.engine.trajectory import Ensemble, Trajectory
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import WHOLE, Mechanism, slip_among
from stickslip.show.described import Described
from stickslip.show.display import OnAxes, Summary, require_library
from stickslip.study.sweep.parameter_grid import (
    Array,
    Progress,
    axis_of,
    compiled,
    counted,
    cycles_of,
    early_ends,
    names_of,
    product,
    reasons_of,
    whole_run,
)
from stickslip.study.tolerances import ALIKE, MOST_STEPS, TRANSIENT

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


# Cycles of the drives: what each of them brings, and after how many a motion closes.

GRID = 2000
"""Evenly spaced times of a cycle at which extremes are sought, beside the solver's own."""


@dataclass(frozen=True, kw_only=True)
class DrivenCycle:
    """What the slipping body does in one cycle of the drives."""

    begin: float
    """When it begins [s]."""
    period: float
    """How long it lasts [s]."""
    travel: float
    """Last position less the first [m] or [rad]."""
    back_slip: float
    """All motion against the direction of the travel [m] or [rad]."""
    least_velocity: float
    """Lowest velocity [m/s] or [rad/s]."""
    least_normal_force: float
    """Lowest normal force of any contact [N]."""

    @property
    def advance(self) -> float:
        """Travel [m] or [rad], exactly 0 where it is rounding of the ways to and fro."""
        return self.travel if self.moves_on else 0.0

    @property
    def backward(self) -> float:
        """All motion in the negative direction [m] or [rad]."""
        return self.back_slip + max(-self.travel, 0.0)

    @property
    def mean_velocity(self) -> float:
        """Advance over duration [m/s] or [rad/s]."""
        return self.advance / self.period

    @property
    def moves_on(self) -> bool:
        """Whether the travel is more than rounding of the ways to and fro."""
        return abs(self.travel) > TRANSIENT * (abs(self.travel) + self.back_slip)

    def repeats(self, before: Self) -> bool:
        """Whether the travel is that of the cycle before, as once a motion has settled."""
        return abs(self.travel - before.travel) <= ALIKE * abs(self.travel)


def cycles_in(
    run: Trajectory, mechanism: Mechanism, period: float, coordinate: str | None = None
) -> tuple[DrivenCycle, ...]:
    """Return what a run does in each whole cycle from its start on, along one coordinate.

    Examples
    --------
    >>> import math
    >>> from stickslip import Coulomb, PendulumCart, simulate
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    >>> cart = PendulumCart(
    ...     cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    ... )
    >>> run = simulate(cart, Coulomb(kinetic_coefficient=0.2), t_end=2 * swing.period)
    >>> [round(one.travel, 7) for one in cycles_in(run, cart, swing.period)]
    [0.0248596, 0.0634659]
    """
    slip, rate = slip_among(mechanism, coordinate, "cycles_in")
    loads = [name for name in run.names if name.partition(":")[0] == "normal_force"]
    first, last = run.span
    count = math.floor((last - first) / period * (1.0 + WHOLE))
    result = []
    samples = max(min(GRID, MOST_STEPS // max(count, 1)), 2)
    for k in range(count):
        begin, end = first + k * period, min(first + (k + 1) * period, last)
        # the velocity changes its sign at the solver's own times, so that back-slip is exact
        own = run.t[(run.t > begin) & (run.t < end)]
        seen = run.at(np.union1d(np.linspace(begin, end, samples), own))
        x = seen[slip]
        travel = float(x[-1] - x[0])
        result.append(
            DrivenCycle(
                begin=begin,
                period=period,
                travel=travel,
                back_slip=float(np.maximum(-math.copysign(1.0, travel) * np.diff(x), 0.0).sum()),
                least_velocity=float(seen[rate].min()),
                least_normal_force=min(float(seen[name].min()) for name in loads),
            )
        )
    return tuple(result)


def period_of(samples: Array, scale: Array | float, tolerance: float = ALIKE) -> int:
    """Return after how many samples an orbit closes, 0 if it does not within half of them.

    Examples
    --------
    >>> period_of(np.array([1.0, 3.0, 1.0, 3.0, 1.0, 3.0]), 3.0)
    2
    >>> period_of(np.array([1.0, 3.0, 2.0, 5.0, 1.5, 0.2]), 3.0)
    0
    """
    points = np.reshape(samples, (len(samples), -1))
    if not np.isfinite(points).all():
        return 0
    limit = tolerance * np.broadcast_to(scale, points.shape[1:])
    for period in range(1, len(points) // 2 + 1):
        if (np.abs(points[period:] - points[:-period]) <= limit).all():
            return period
    return 0


# Basins of attraction: which motion each start ends in.


@dataclass(frozen=True, kw_only=True, eq=False)
class Attractor(metaclass=Described):
    """A settled motion, by its stroboscopic points."""

    points: Array
    """Its samples, once a cycle (keep, states), of the first start that led here."""
    period: int
    """After how many cycles it closes; 0 if it does not."""
    velocity: float
    """Mean velocity over the samples [m/s] or [rad/s]."""
    share: float
    """Share of all starts that end in it."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Basins(OnAxes):
    """Which motion each start ends in."""

    starts: Mapping[str, Array]
    """The two axes of the grid of starts, by state."""
    states: tuple[str, ...]
    """The states that tell motions apart: columns of `Attractor.points`."""
    index: NDArray[np.int64]
    """Number of the attractor for each start, -1 where a run ended early."""
    attractors: tuple[Attractor, ...]
    """The motions, the one with the largest basin first."""
    status: NDArray[np.object_]
    """How each run ended, a `Status` each."""
    units: Mapping[str, str]
    """SI unit of each axis of the grid."""

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each start: two states, attractor, status, and the reason if none."""
        import pandas as pd

        columns: dict[str, object] = dict(product(self.starts))
        columns |= {"attractor": self.index.ravel(), "status": names_of(self.status).ravel()}
        return pd.DataFrame(columns | {"reason": reasons_of(self.status)})

    def early_ends(self) -> tuple[str, ...]:
        """Return which starts lead to no attractor, and why: a sentence for each reason."""
        return early_ends(self.status, "No attractor there.", self.starts, self.units, "starts")

    def to_xarray(self) -> "xr.Dataset":
        """Return the number of the attractor and the status over the starts as an xarray Dataset.

        The starts have their units.

        Raises
        ------
        InputError
            If xarray is not installed.
        """
        require_library("xarray", "xarray", "use to_dataframe")
        import xarray as xr

        over = tuple(self.starts)
        columns = {"attractor": (over, self.index), "status": (over, names_of(self.status))}
        units = {name: {"units": unit} for name, unit in self.units.items()}
        return xr.Dataset(
            columns, {name: (name, x, units[name]) for name, x in self.starts.items()}
        )

    def _summary(self) -> Summary:
        rows = [
            (attractor.share, attractor.period or "not closed", attractor.velocity)
            for attractor in self.attractors
        ]
        lead = f"{np.sum(self.index >= 0)} of {self.index.size} starts lead to"
        return Summary(
            sentence=f"{lead} {len(rows)} attractor{'' if len(rows) == 1 else 's'}.",
            head=("share of starts", "period", "mean velocity") if rows else (),
            rows=rows,
            notes=self.early_ends(),
        )


def basins(
    mechanism: Mechanism,
    law: simulation.GivenFriction,
    starts: Mapping[str, ArrayLike],
    *,
    coordinate: str | None = None,
    states: Sequence[str] | None = None,
    keep: int = 24,
    settle: int = 200,
    tolerance: float = ALIKE,
    y0: Mapping[str, float] | None = None,
    period: float | None = None,
    solver: EventDriven | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Basins:
    """Return which settled motion each start of a grid ends in.

    Motions that close after some cycles are the same if they have the same points; those that do
    not close within ``keep // 2`` cycles are the same if the boxes around their points overlap.

    Parameters
    ----------
    mechanism : Mechanism
        What moves, with a periodic drive.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back; laws by contact where there are several.
    starts : mapping
        Initial values of two states, an array each.
    coordinate : str, optional
        Coordinate whose mean rate is told; that along which contacts slip if not given. It has to
        be named where they slip along several.
    states : sequence of str, optional
        What tells motions apart; the two states of the grid if not given. A place that drifts must
        not be among them.
    keep, settle : int
        Cycles that are sampled, and cycles before them.
    tolerance : float
        Share of the size of a state within which two points are the same.
    y0 : mapping, optional
        Initial values of the other states.
    period : float, optional
        Length of a cycle [s]; that of the drives if not given.
    solver : EventDriven, optional
        Tolerances, limits and tier, as in `ensemble`.
    executor : concurrent.futures.Executor, optional
        Where chunks of runs are executed, as in `ensemble`.
    progress : callable, optional
        Called with runs done and in all, as in `ensemble`.

    Returns
    -------
    Basins
        Attractors, and the number of one for each start.

    Raises
    ------
    InputError
        If an argument cannot be used, or the drives have no cycle.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> axis = Axis(
    ...     inertia=1.0, stiffness=100.0, damping=1.0, drive=Sine(amplitude=4.0, frequency=1.0)
    ... )
    >>> grid = {"x": np.linspace(-1.0, 1.0, 4), "v": np.linspace(-1.0, 1.0, 3)}
    >>> found = basins(axis, Coulomb(kinetic_coefficient=0.5), grid, settle=30)
    >>> found.index.shape, [attractor.period for attractor in found.attractors]
    ((4, 3), [1])
    """
    law = simulation.event_driven_law(mechanism, law)
    place, _ = slip_among(mechanism, coordinate, "basins")
    axes = _axes(mechanism, law, starts, keep, settle)
    if period is None:
        whole_run("basins", mechanism, keep + settle)
    names = tuple(starts) if states is None else tuple(states)
    columns = product(axes)
    cycle = float(cycles_of(mechanism, columns, period)[0])
    times = [cycle * (settle + i) for i in range(keep + 1)]
    runs = simulation.ensemble(
        mechanism,
        law,
        columns,
        t_end=times[-1],
        outputs=_outputs(place, names, times),
        y0=y0,
        solver=compiled(solver),
        executor=executor,
        progress=progress,
    )
    begun = {path.removeprefix("initial."): values for path, values in axes.items()}
    sizes = np.array([np.abs(begun.get(name, 0.0)).max() for name in names])
    points = np.stack([runs[f"samples {name}"][:, 1:] for name in names], axis=2)
    velocity = np.diff(runs["place"])[:, 0] / (keep * cycle)
    index, result = _sorted(*_clusters(runs, points, velocity, sizes, tolerance))
    shape = tuple(map(len, begun.values()))
    return Basins(
        starts=begun,
        states=names,
        index=index.reshape(shape),
        attractors=result,
        status=runs.status.reshape(shape),
        units={name: runs.units[f"initial.{name}"] for name in begun},
    )


def _axes(
    mechanism: Mechanism, law: FrictionLaw | Laws, starts: object, keep: int, settle: int
) -> dict[str, Array]:
    """Return the axes of the grid by full path, settings checked."""
    counted("basins", "keep", keep, 2)
    counted("basins", "settle", settle, 0)
    if not (isinstance(starts, Mapping) and len(starts) == 2):
        raise InputError(f"basins: starts must map two states to arrays, got {starts!r}.")
    return dict(axis_of(mechanism, law, f"initial.{name}", v) for name, v in starts.items())


def _outputs(place: str, names: Sequence[str], times: Sequence[float]) -> dict[str, Output]:
    result: dict[str, Output] = {f"samples {name}": Samples(name, times) for name in names}
    result["place"] = Samples(place, [times[0], times[-1]])
    return result


def _clusters(
    runs: Ensemble, points: Array, velocity: Array, sizes: Array, tolerance: float
) -> tuple[NDArray[np.int64], list[Attractor]]:
    """Return the number of the motion of each run, -1 for those that ended early."""
    index = np.full(len(runs), -1, dtype=np.int64)
    good = np.array([status.complete for status in runs.status])
    good &= np.isfinite(points).all(axis=(1, 2))
    result: list[Attractor] = []
    if not good.any():
        return index, result
    # what has come to rest has no size of its own: then that of the starts counts
    largest = np.maximum(np.abs(points[good]).max(axis=(0, 1)), sizes)
    scale = np.maximum(largest, np.finfo(float).tiny)
    for row in np.flatnonzero(good):
        orbit = points[row]
        closes = period_of(orbit, scale, tolerance)
        same = (
            i
            for i, attractor in enumerate(result)
            if _same(attractor, orbit, closes, tolerance * scale)
        )
        number = next(same, len(result))
        if number == len(result):
            result.append(
                Attractor(points=orbit, period=closes, velocity=float(velocity[row]), share=0.0)
            )
        index[row] = number
    return index, result


def _same(attractor: Attractor, orbit: Array, closes: int, limit: Array) -> bool:
    if attractor.period != closes:
        return False
    if closes == 0:
        above = orbit.min(axis=0) > attractor.points.max(axis=0)
        below = orbit.max(axis=0) < attractor.points.min(axis=0)
        return not np.any(np.logical_or(above, below))
    # the phase at which a run falls into the orbit does not matter
    gaps = np.abs(orbit[:closes, None, :] - attractor.points[None, :closes, :])
    met: NDArray[np.bool_] = np.all(gaps <= 2.0 * limit, axis=2)
    return bool(np.all(np.any(met, axis=0)) and np.all(np.any(met, axis=1)))


def _sorted(
    index: NDArray[np.int64], found: list[Attractor]
) -> tuple[NDArray[np.int64], tuple[Attractor, ...]]:
    """Return the motions by the size of their basins."""
    counts = np.array([np.sum(index == number) for number in range(len(found))], dtype=np.int64)
    order = np.argsort(-counts, kind="stable")
    ranks = np.append(np.argsort(order), -1)  # the last for runs that ended early
    attractors = tuple(replace(found[i], share=float(counts[i]) / index.size) for i in order)
    return ranks[index], attractors
