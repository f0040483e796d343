"""Settled motion: cycles of the drives, bifurcation diagrams, and basins of attraction.

1. A motion closes after m cycles of the drives if what m of them bring agrees; else it is of no
   period that was asked for.
2. A bifurcation diagram has samples of the settled motion, one a cycle, while a parameter changes:
   each value begins where the one before ended.
3. Basins are a grid of starts, each with the motion in which its run ends.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.engine import simulation
from stickslip.engine.executors import Inline, check_executor, spread
from stickslip.engine.formulation import formulate
from stickslip.engine.solver import EventDriven, EventTimes, Final, Output, Samples, column_units
from stickslip.engine.trajectory import Ensemble, Event, Status, Trajectory
from stickslip.errors import InputError, UnknownNameError, check_size
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import WHOLE, BlockChain, Mechanism, TowedBlock, cycle_of, slip_among
from stickslip.quantities import Quantity
from stickslip.quantities import vary as varied
from stickslip.show.described import Described
from stickslip.show.display import OnAxes, Summary, require_library
from stickslip.show.formatting import number
from stickslip.study.sweep.parameter_grid import (
    Array,
    Progress,
    Tally,
    axis_of,
    check_path,
    compiled,
    counted,
    cycles_of,
    early_ends,
    names_of,
    product,
    reasons_of,
    states_of,
    unit_of,
    whole_run,
)

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


# Cycles of the drives: what each of them brings, and after how many a motion closes.

CLOSED = 1e-3
"""Share of the size of a state within which samples count as the same point."""
GRID = 2000
"""Evenly spaced times of a cycle at which extremes are sought, beside the solver's own."""
STEADY = 1e-3
"""Share of the travel within which cycles count as the same."""
STILL = 1e-6
"""Share of the ways to and fro below which a travel is rounding, or what is left of a transient."""
MOST_TIMES = 100_000
"""Times of all cycles together: of very many cycles each has fewer."""


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
        """Travel over duration [m/s] or [rad/s]."""
        return self.travel / self.period

    @property
    def moves_on(self) -> bool:
        """Whether the travel is more than rounding of the ways to and fro."""
        return abs(self.travel) > STILL * (abs(self.travel) + self.back_slip)

    def repeats(self, before: Self) -> bool:
        """Whether the travel is that of the cycle before, as once a motion has settled."""
        return abs(self.travel - before.travel) <= STEADY * abs(self.travel)


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
    found = []
    samples = max(min(GRID, MOST_TIMES // max(count, 1)), 2)
    for k in range(count):
        begin, end = first + k * period, min(first + (k + 1) * period, last)
        # the velocity changes its sign at the solver's own times, so that back-slip is exact
        own = run.t[(run.t > begin) & (run.t < end)]
        seen = run.at(np.union1d(np.linspace(begin, end, samples), own))
        x = seen[slip]
        travel = float(x[-1] - x[0])
        found.append(
            DrivenCycle(
                begin=begin,
                period=period,
                travel=travel,
                back_slip=float(np.maximum(-math.copysign(1.0, travel) * np.diff(x), 0.0).sum()),
                least_velocity=float(seen[rate].min()),
                least_normal_force=min(float(seen[name].min()) for name in loads),
            )
        )
    return tuple(found)


def period_of(samples: Array, scale: Array | float, tolerance: float = CLOSED) -> int:
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


# Bifurcation diagrams: samples of the settled motion while a parameter changes.

END = Quantity("T", "s", above=0)
Starts = tuple[Mapping[str, float], ...]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Bifurcation(OnAxes):
    """Samples of a state over the values of a parameter, for each start."""

    path: str
    """Full path of the parameter."""
    path_unit: str
    """Its SI unit."""
    values: Array
    """Its values (n,), in the order of the runs."""
    state: str
    """What is sampled."""
    unit: str
    """SI unit of the state."""
    sample: str
    """``"period"``, or the event at which it is sampled."""
    samples: Array
    """Samples (n, starts, keep); NaN where there are fewer, as `early_ends` says."""
    period: NDArray[np.int64]
    """After how many samples the orbit closes (n, starts), 0 if it does not."""
    status: NDArray[np.object_]
    """How each run ended, a `Status` each (n, starts)."""

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each sample, with the reason where there is none."""
        import pandas as pd

        n, starts, keep = self.samples.shape
        columns = {
            self.path: np.repeat(self.values, starts * keep),
            "start": np.tile(np.repeat(np.arange(starts), keep), n),
            self.state: self.samples.ravel(),
            "period": np.repeat(self.period.ravel(), keep),
            "status": np.repeat(names_of(self.status).ravel(), keep),
            "reason": np.repeat(self._reasons(), keep),
        }
        return pd.DataFrame(columns)

    def to_xarray(self) -> "xr.Dataset":
        """Return the samples as an xarray Dataset over parameter, start and sample, with units.

        Raises
        ------
        InputError
            If xarray is not installed.
        """
        require_library("xarray", "xarray", "use to_dataframe")
        import xarray as xr

        over = (self.path, "start")
        columns = {
            self.state: ((*over, "sample"), self.samples, {"units": self.unit}),
            "period": (over, self.period),
            "status": (over, names_of(self.status)),
        }
        values = {self.path: (self.path, self.values, {"units": self.path_unit})}
        return xr.Dataset(columns, values)

    def early_ends(self) -> tuple[str, ...]:
        """Return where samples are missing, and why: a sentence for each reason."""
        axes, units = {self.path: self.values}, {self.path: self.path_unit}
        lacks = "No samples there." if self.sample == "period" else "No samples after that."
        ended = early_ends(self.status, lacks, axes, units, noun="runs")
        few = int(self._few().sum())
        if not few:
            return ended
        return *ended, f"At {few} of {self.status.size} runs {self._rarely}."

    @property
    def _rarely(self) -> str:
        return f'the event "{self.sample}" came fewer than {self.samples.shape[2]} times'

    def _few(self) -> NDArray[np.bool_]:
        """Return which runs were completed, and lack samples (n, starts)."""
        complete = np.array(
            [[ending.complete for ending in row] for row in self.status], dtype=np.bool_
        )
        found: NDArray[np.bool_] = complete & ~np.isfinite(self.samples).all(axis=2)
        return found

    def _reasons(self) -> list[str]:
        few = self._few().ravel()
        return [
            self._rarely if lacks else reason
            for lacks, reason in zip(few, reasons_of(self.status), strict=True)
        ]

    def _summary(self) -> Summary:
        closed = int((self.period > 0).sum())
        low, high = float(self.values.min()), float(self.values.max())
        rows = (
            (
                self.path,
                f"{number(low, 4)} to {number(high, 4)} {self.path_unit},"
                f" {len(self.values)} values",
            ),
            ("starts", self.samples.shape[1]),
            ("largest period", int(self.period.max(initial=0))),
        )
        return Summary(
            sentence=f"{closed} of {self.period.size} orbits close.",
            rows=rows,
            notes=self.early_ends(),
        )


def bifurcation(
    mechanism: Mechanism,
    law: simulation.GivenFriction,
    path: str,
    values: ArrayLike,
    *,
    state: str,
    sample: str = "period",
    contact: str | None = None,
    keep: int = 50,
    settle: int = 200,
    t_end: float | None = None,
    follow: bool = True,
    starts: Sequence[Mapping[str, float]] = ({},),
    period: float | None = None,
    solver: EventDriven | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Bifurcation:
    """Sample the settled motion for each value of a parameter.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw or mapping of str to FrictionLaw
        What holds it back, as in `simulate`.
    path : str
        What varies, as in `ensemble`; with laws by contact, ``friction.elbow.static_coefficient``
        and its like.
    values : array_like (n,)
        Its values, in the order in which the motion is followed.
    state : str
        What is sampled: a state, or at events any column of runs.
    sample : str
        ``"period"``: once a cycle of the drives. Or the `reason` of events, such as ``"stop"``.
    contact : str, optional
        At which of several contacts these events are; at any of them if not given.
    keep : int
        Samples kept of each run: the last ones.
    settle : int
        Cycles before them; used with ``"period"``.
    t_end : float, optional
        Length of a run [s]; needed for events, rounded up to whole cycles where there is a drive.
    follow : bool
        Whether each run starts where that of the value before ended, so that the motion is followed
        to where it loses its stability; if not, all runs start as `starts` says. A prescribed
        coordinate and its rate do so in every run.
    starts : sequence of mapping
        Initial states by name, one mapping for each motion to be followed. What is not given is 0,
        or where the mechanism with the value of the run begins.
    period : float, optional
        Length of a cycle [s]; that of the drives if not given.
    solver : EventDriven, optional
        Compiled if not given.
    executor : concurrent.futures.Executor, optional
        Where runs are made, all of them at the same time without `follow`; here if not given.
    progress : callable, optional
        Called with the number of runs done and of all; if it returns False, no more begin.

    Returns
    -------
    Bifurcation
        Samples, the period of each orbit in samples, and how each run ended. A followed motion
        whose run ended early starts again as `starts` says.

    Raises
    ------
    InputError
        If an argument cannot be used, or the drives have no cycle.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=1.0))
    >>> found = bifurcation(
    ...     axis, Coulomb(kinetic_coefficient=0.5), "frequency", [1.0, 1.2], state="x", keep=6
    ... )
    >>> found.period[:, 0]
    array([1, 1])
    """
    found = simulation.event_driven_law(mechanism, law)
    check_executor(executor)
    counted("bifurcation", "keep", keep, 2)
    counted("bifurcation", "settle", settle, 0)
    check_path("bifurcation", path)
    mechanism, found = simulation.beginning_pair(mechanism, found, {path: values})
    full, array = axis_of(mechanism, found, path, values)
    if full.startswith("initial."):
        raise InputError(f"bifurcation: {full} is not a parameter; give `starts`, or use basins.")
    begun = tuple(dict(start) for start in starts)
    if not begun:
        raise InputError("bifurcation: starts must contain at least one mapping, got none.")
    check_size(
        "bifurcation", len(array) * len(begun) * keep, "give fewer values, or a smaller keep"
    )
    shared = _Shared(mechanism, found, full, state, keep, compiled(solver))
    method = _method(shared, sample, contact, settle, t_end, period)
    tally = Tally(len(array) * len(begun), progress)
    samples = np.full((len(array), len(begun), keep), np.nan)
    status = np.full(samples.shape[:2], Status.CANCELLED, dtype=object)

    def keep_row(seen: tuple[int, Found]) -> bool:
        row, (samples[row], status[row], _) = seen[0], seen[1]
        tally.tell(tally.done + len(begun))
        return tally.going

    if not follow:
        tasks = ((method, row, float(value), begun) for row, value in enumerate(array))
        spread(_row, tasks, keep_row, executor or Inline())
        return _judged(shared, array, sample, samples, status)
    now: Starts = begun
    for row, value in enumerate(array):
        seen = _row(method, row, float(value), now)
        ends = zip(begun, seen[1][2], strict=True)
        now = tuple(shared.next_start(first, end) for first, end in ends)
        if not keep_row(seen):
            break
    return _judged(shared, array, sample, samples, status)


def _method(
    shared: "_Shared",
    sample: str,
    contact: str | None,
    settle: int,
    t_end: float | None,
    period: float | None,
) -> "_Method":
    if sample == "period":
        if contact is not None:
            raise InputError(
                f"bifurcation: contact={contact!r} applies to sampling at events, not to"
                ' sample="period": leave it out.'
            )
        if t_end is not None:
            raise InputError(
                "bifurcation: t_end applies to sampling at events; for"
                ' sample="period" give settle and keep.'
            )
        if period is None:
            whole_run("bifurcation", shared.mechanism, settle + shared.keep)
        return _Strobe(shared, settle, period)
    if t_end is None:
        raise InputError(f"bifurcation: sampling at {sample!r} needs t_end [s], got none.")
    last = END.check("bifurcation", "t_end", t_end)
    events = EventTimes(sample, contact=contact)
    events.columns(formulate(shared.mechanism, shared.law), last)  # both are known
    return _AtEvents(shared, events, last, period)


def _judged(
    shared: "_Shared",
    values: Array,
    sample: str,
    samples: Array,
    status: NDArray[np.object_],
) -> Bifurcation:
    """Return the samples with the period of each orbit."""
    mechanism, state = shared.mechanism, shared.state
    known = samples[np.isfinite(samples)]
    scale = float(np.abs(known).max()) if known.size else 0.0
    periods = np.array([[period_of(orbit, scale) for orbit in row] for row in samples], np.int64)
    rates = {r: f"{u}/s" for r, u in zip(mechanism.rates, mechanism.units, strict=True)}
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True)) | rates
    units |= column_units(mechanism, _columns(mechanism))
    return Bifurcation(
        path=shared.path,
        path_unit=unit_of(mechanism, shared.law, shared.path),
        values=values,
        state=state,
        unit=units.get(state, "1"),
        sample=sample,
        samples=samples,
        period=periods,
        status=status,
    )


def _columns(mechanism: Mechanism) -> list[str]:
    """Return the columns of friction and load that runs have, of one contact and of several."""
    ends = ["", *(f":{contact.name}" for contact in mechanism.contacts())]
    return [f"{kind}{end}" for kind in ("friction", "normal_force") for end in ends]


@dataclass(frozen=True)
class _Shared:
    """What all runs have in common."""

    mechanism: Mechanism
    law: FrictionLaw | Laws
    path: str
    state: str
    keep: int
    solver: EventDriven

    def at(self, value: float) -> tuple[Mechanism, FrictionLaw | Laws]:
        """Return mechanism and law with a value of what varies."""
        change = {self.path: value}
        if self.path.startswith("friction."):
            return self.mechanism, varied(self.law, "friction", change)
        return varied(self.mechanism, "mechanism", change), self.law

    def next_start(
        self, first: Mapping[str, float], end: Mapping[str, float] | None
    ) -> Mapping[str, float]:
        """Return where a followed motion goes on; what a drive prescribes begins as ever.

        The end of a prescribed coordinate belongs to the value before: with it the next run would
        go through another motion than its profile.
        """
        if end is None:
            return first
        mechanism = self.mechanism
        rates = dict(zip(mechanism.coordinates, mechanism.rates, strict=True))
        own = {name for q in mechanism.guided() for name in (q, rates[q])}
        free = {name: x for name, x in end.items() if name not in own}
        return free | {name: x for name, x in first.items() if name in own}

    def carried(self, mechanism: Mechanism, end: Mapping[str, float], t: float) -> dict[str, float]:
        """Return the start, at time 0, of a run that goes on from a state at a time."""
        moved = dict(end)
        if isinstance(mechanism, TowedBlock):
            # its spring is pulled from x = 0 again
            moved["x"] -= mechanism.speed * t
        elif isinstance(mechanism, BlockChain) and mechanism.speed is not None:
            # places on the belt: the springs are stretched by how far it went
            moved |= {x: end[x] + mechanism.speed * t for x in mechanism.coordinates}
        return moved


Found = tuple[Array, NDArray[np.object_], Sequence[Mapping[str, float] | None]]


class _Method(ABC):
    """How one value is run and sampled."""

    @abstractmethod
    def run(self, value: float, starts: Starts) -> Found:
        """Return samples, status, and where the runs from several starts ended."""


def _row(method: _Method, row: int, value: float, starts: Starts) -> tuple[int, Found]:
    """Return the place of a value, and what came of it."""
    return row, method.run(value, starts)


class _Strobe(_Method):
    """Samples once a cycle."""

    def __init__(self, shared: _Shared, settle: int, period: float | None) -> None:
        self.shared, self.settle, self.period = shared, settle, period

    def run(self, value: float, starts: Starts) -> Found:
        shared = self.shared
        names = states_of(shared.mechanism, shared.law)
        row = {shared.path: np.array([value])}
        cycle = float(cycles_of(shared.mechanism, row, self.period)[0])
        last = (self.settle + shared.keep) * cycle
        times = [cycle * (self.settle + 1 + i) for i in range(shared.keep - 1)] + [last]
        outputs: dict[str, Output] = {f"end {name}": Final(name) for name in names}
        outputs["samples"] = Samples(shared.state, times)
        usual = {**dict.fromkeys(names, 0.0), **shared.at(value)[0].start()}
        columns = {
            f"initial.{name}": np.array([start.get(name, usual[name]) for start in starts], float)
            for name in names
        }
        runs = simulation.ensemble(
            shared.mechanism,
            shared.law,
            {shared.path: np.full(len(starts), value), **columns},
            t_end=last,
            outputs=outputs,
            solver=shared.solver,
        )
        return runs["samples"], runs.status, [
            {name: float(runs[f"end {name}"][i]) for name in names} if status.complete else None
            for i, status in enumerate(runs.status)
        ]  # fmt: skip


class _AtEvents(_Method):
    """Samples at events of one kind."""

    def __init__(
        self, shared: _Shared, events: EventTimes, t_end: float, period: float | None
    ) -> None:
        self.shared, self.events, self.t_end, self.period = shared, events, t_end, period

    def run(self, value: float, starts: Starts) -> Found:
        shared = self.shared
        mechanism, law = shared.at(value)
        last = self._whole(mechanism)
        samples = np.full((len(starts), shared.keep), np.nan)
        status, ends = np.empty(len(starts), dtype=object), []
        for i, start in enumerate(starts):
            run = simulation.simulate(
                mechanism, law, t_end=last, y0=start, solver=shared.solver, throw=False
            )
            if shared.state not in run.names:
                raise UnknownNameError("column", shared.state, run.names)
            times = [event.t for event in run.events if self._is_meant(event)][-shared.keep :]
            if times:
                samples[i, shared.keep - len(times) :] = run.at(times)[shared.state]
            status[i] = run.status
            end = run.at(run.span[1])
            at_end = {name: float(end[name][0]) for name in run.states}
            whole = run.status is Status.END_TIME
            ends.append(shared.carried(mechanism, at_end, last) if whole else None)
        return samples, status, ends

    def _is_meant(self, event: Event) -> bool:
        wanted = self.events
        return event.reason == wanted.reason and wanted.contact in (None, event.contact)

    def _whole(self, mechanism: Mechanism) -> float:
        """Return the length of a run, whole cycles so that the next begins at the same phase."""
        if self.period is None and not mechanism.drives():
            return self.t_end
        cycle = cycle_of(mechanism) if self.period is None else self.period
        return float(np.ceil(self.t_end / cycle * (1.0 - 1e-12)) * cycle)


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
        count = len(rows)
        lead = int(np.sum(self.index >= 0))
        return Summary(
            sentence=f"{lead} of {self.index.size} starts lead to {count}"
            f" attractor{'' if count == 1 else 's'}.",
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
    tolerance: float = CLOSED,
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
    samples = _samples(runs, names, keep * cycle)
    index, found = _sorted(*_clusters(runs, *samples, sizes, tolerance))
    shape = tuple(map(len, begun.values()))
    return Basins(
        starts=begun,
        states=names,
        index=index.reshape(shape),
        attractors=found,
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
    found: dict[str, Output] = {f"samples {name}": Samples(name, times) for name in names}
    found["place"] = Samples(place, [times[0], times[-1]])
    return found


def _samples(runs: Ensemble, names: Sequence[str], duration: float) -> tuple[Array, Array]:
    """Return samples (n, keep, states) and the mean slip velocity over them (n,)."""
    points = np.stack([runs[f"samples {name}"][:, 1:] for name in names], axis=2)
    place = runs["place"]
    return points, (place[:, 1] - place[:, 0]) / duration


def _clusters(
    runs: Ensemble, points: Array, velocity: Array, sizes: Array, tolerance: float
) -> tuple[NDArray[np.int64], list[Attractor]]:
    """Return the number of the motion of each run, -1 for those that ended early."""
    index = np.full(len(runs), -1, dtype=np.int64)
    good = np.array([status.complete for status in runs.status])
    good &= np.isfinite(points).all(axis=(1, 2))
    found: list[Attractor] = []
    if not good.any():
        return index, found
    # what has come to rest has no size of its own: then that of the starts counts
    largest = np.maximum(np.abs(points[good]).max(axis=(0, 1)), sizes)
    scale = np.maximum(largest, np.finfo(float).tiny)
    for row in np.flatnonzero(good):
        orbit = points[row]
        closes = period_of(orbit, scale, tolerance)
        same = (
            i
            for i, attractor in enumerate(found)
            if _same(attractor, orbit, closes, tolerance * scale)
        )
        number = next(same, len(found))
        if number == len(found):
            found.append(
                Attractor(points=orbit, period=closes, velocity=float(velocity[row]), share=0.0)
            )
        index[row] = number
    return index, found


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
    attractors = tuple(
        Attractor(
            points=found[i].points,
            period=found[i].period,
            velocity=found[i].velocity,
            share=float(counts[i]) / index.size,
        )
        for i in order
    )
    return ranks[index], attractors
