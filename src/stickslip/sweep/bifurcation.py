"""Bifurcation diagrams: samples of the settled motion while a parameter changes."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import override

from stickslip.display import OnAxes, Summary, require_library
from stickslip.errors import InputError, UnknownNameError, check_size
from stickslip.executors import Inline, check_executor, spread
from stickslip.formatting import number
from stickslip.formulation import formulate
from stickslip.friction import FrictionLaw, Laws, PrintedForm
from stickslip.mechanisms import BlockChain, Mechanism, TowedBlock, cycle_of
from stickslip.quantities import Quantity
from stickslip.quantities import vary as varied
from stickslip.simulation import GivenFriction, beginning_pair, check_pair, ensemble, simulate
from stickslip.solver import EventDriven, EventTimes, Final, Output, Samples, column_units
from stickslip.sweep.cycles import period_of
from stickslip.sweep.parameter_grid import (
    Array,
    Progress,
    Tally,
    axis_of,
    compiled,
    counted,
    cycles_of,
    early_ends,
    names_of,
    reasons_of,
    states_of,
    unit_of,
    whole_run,
)
from stickslip.trajectory import Event, Status

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = ["Bifurcation", "bifurcation"]

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
        complete = np.array([[one.complete for one in row] for row in self.status], dtype=np.bool_)
        found: NDArray[np.bool_] = complete & ~np.isfinite(self.samples).all(axis=2)
        return found

    def _reasons(self) -> list[str]:
        few = self._few().ravel()
        return [
            self._rarely if lacks else reason
            for lacks, reason in zip(few, reasons_of(self.status), strict=True)
        ]

    @override
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
    law: GivenFriction,
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
    >>> from stickslip.drives import Sine
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=1.0))
    >>> found = bifurcation(
    ...     axis, Coulomb(kinetic_coefficient=0.5), "frequency", [1.0, 1.2], state="x", keep=6
    ... )
    >>> found.period[:, 0]
    array([1, 1])
    """
    found = check_pair(mechanism, law)
    if isinstance(found, PrintedForm):
        raise InputError(f"bifurcation runs with EventDriven only, which cannot solve {law!r}.")
    check_executor(executor)
    counted("bifurcation", "keep", keep, 2)
    counted("bifurcation", "settle", settle, 0)
    mechanism, found = beginning_pair(mechanism, found, {path: values})
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
    ends = ["", *(f":{one.name}" for one in mechanism.contacts())]
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
        one = self.mechanism
        rates = dict(zip(one.coordinates, one.rates, strict=True))
        own = {name for q in one.guided() for name in (q, rates[q])}
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


@final
class _Strobe(_Method):
    """Samples once a cycle."""

    def __init__(self, shared: _Shared, settle: int, period: float | None) -> None:
        self.shared, self.settle, self.period = shared, settle, period

    @override
    def run(self, value: float, starts: Starts) -> Found:
        one = self.shared
        names = states_of(one.mechanism, one.law)
        row = {one.path: np.array([value])}
        cycle = float(cycles_of(one.mechanism, row, self.period)[0])
        last = (self.settle + one.keep) * cycle
        times = [cycle * (self.settle + 1 + i) for i in range(one.keep - 1)] + [last]
        outputs: dict[str, Output] = {f"end {name}": Final(name) for name in names}
        outputs["samples"] = Samples(one.state, times)
        told = {**dict.fromkeys(names, 0.0), **one.at(value)[0].start()}
        columns = {
            f"initial.{name}": np.array([start.get(name, told[name]) for start in starts], float)
            for name in names
        }
        runs = ensemble(
            one.mechanism,
            one.law,
            {one.path: np.full(len(starts), value), **columns},
            t_end=last,
            outputs=outputs,
            solver=one.solver,
        )
        return runs["samples"], runs.status, [
            {name: float(runs[f"end {name}"][i]) for name in names} if status.complete else None
            for i, status in enumerate(runs.status)
        ]  # fmt: skip


@final
class _AtEvents(_Method):
    """Samples at events of one kind."""

    def __init__(
        self, shared: _Shared, events: EventTimes, t_end: float, period: float | None
    ) -> None:
        self.shared, self.events, self.t_end, self.period = shared, events, t_end, period

    @override
    def run(self, value: float, starts: Starts) -> Found:
        one = self.shared
        mechanism, law = one.at(value)
        last = self._whole(mechanism)
        samples = np.full((len(starts), one.keep), np.nan)
        status, ends = np.empty(len(starts), dtype=object), []
        for i, start in enumerate(starts):
            run = simulate(mechanism, law, t_end=last, y0=start, solver=one.solver, throw=False)
            if one.state not in run.names:
                raise UnknownNameError("column", one.state, run.names)
            times = [event.t for event in run.events if self._is_meant(event)][-one.keep :]
            if times:
                samples[i, one.keep - len(times) :] = run.at(times)[one.state]
            status[i] = run.status
            end = run.at(run.span[1])
            at_end = {name: float(end[name][0]) for name in run.states}
            whole = run.status is Status.END_TIME
            ends.append(one.carried(mechanism, at_end, last) if whole else None)
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
