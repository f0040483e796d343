"""Branches of periodic orbits over a range of a parameter, begun from settled runs.

1. At evenly spaced values runs settle from where the mechanism begins, between them others from
   random states of twice the size of motions so far.
2. A settled run that closes after at most the cycles asked for is solved for (`orbits`); if it lies
   on no branch yet, its branch is followed to both sides (`continuation`) until it meets another.
3. At period doublings doubled branches begin.
   Where a branch of twice the period ends in one, that of half the period is followed, too; so is
   what a step met behind a gap.
4. Right behind each loss of stability a run settles from there, as in a sweep: what takes over is
   often not connected. Beside each end of a branch within the range runs settle from random states;
   so they do where no orbit is known that is stable, until it is or places are near each other:
   there something else is, be it of a longer period or of none. What nothing drives in time may
   slide steadily there.
"""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from time import process_time
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.engine.simulation import (
    GivenFriction,
    beginning_pair,
    event_driven_law,
    initial_state,
)
from stickslip.engine.solver import EventDriven
from stickslip.errors import InputError, SimulationError
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism, stops_of
from stickslip.show.display import MOST_ROWS, OnAxes, Summary, Tabular
from stickslip.show.formatting import joined, number, percent, quantity, span
from stickslip.study.sweep.attractors import period_of
from stickslip.study.sweep.lyapunov import diverges, have_left
from stickslip.study.sweep.orbits import ReturnMap, Shot, is_excited, return_map, solved
from stickslip.study.sweep.parameter_grid import (
    PERIOD,
    Array,
    Progress,
    Tally,
    axis_of,
    check_path,
    compiled,
    counted,
    early_ends,
    pair_of,
    runs_of,
    states_of,
    unit_of,
    where_of,
    whole_run,
)
from stickslip.study.sweep.sections import given_section, passes_of
from stickslip.study.tolerances import ALIKE, ROUNDING

if TYPE_CHECKING:
    import pandas as pd

from stickslip.study.sweep.continuation import (
    DIAGRAM_STEP,
    MOST_POINTS,
    MOST_STEP,
    Branch,
    BranchEvent,
    Curve,
    Point,
    between_of,
    check_step,
    units_of,
    within,
)
from stickslip.units import per_second

__all__ = ["OrbitDiagram", "orbit_diagram"]

BEHIND: Final = (-8e-3, -2e-3, 2e-3, 8e-3)
"""Places beside the end of a branch, over the range, where further runs settle."""
RIGHT_BEHIND = 3e-5
"""Distance, over the range, behind a loss of stability at which a run settles from there."""
BESIDE = 1e-3
"""Distance, over the range, within which no second place beside an end is looked at."""
FINER, FEW = 32, 2
"""Places between two values at which runs settle, at most, where no stable orbit is known, and how
many of them there as beside an end."""
MOST_BEYOND, DEEPEST = 32, 4
"""Orbits behind changes of a branch that are followed, and branches that lead on to others."""
STRETCH = 64
"""Cycles of a settled run that are recorded at a time."""
EARLY, SOONER = 4, 100.0
"""Part of the cycles after which, and twice that, a run may have settled, if it closes so much
better."""
SAME = 2e-3
"""Distance, over the size of the states, within which points are of the same orbit: what is left
of a transient, of which `ALIKE` is allowed."""
SETTLED = 1e-7
"""The same of points of an orbit that was solved for."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class OrbitDiagram(OnAxes, Tabular):
    """Branches of periodic orbits over a parameter, with settled motions behind."""

    path: str
    """Full path of the parameter."""
    unit: str
    """Its SI unit."""
    between: tuple[float, float]
    """Its range."""
    states: tuple[str, ...]
    """Free states (k,), as in `Branch.states`."""
    units: Mapping[str, str]
    """SI units of all states."""
    branches: tuple[Branch, ...]
    """Their branches."""
    values: Array
    """The parameter of each settled run (m,)."""
    samples: Array
    """Free states (m, keep, k) of settled runs, once a cycle; NaN where a run ended early."""
    velocities: Mapping[str, Array]
    """Mean velocity (m,) over these cycles, of each coordinate on which nothing depends."""
    settled: NDArray[np.int64]
    """After how many cycles each settled run closes (m,), 0 if it does not."""
    spreads: Mapping[str, Array]
    """By how much `velocities` of runs that do not close (m,) differ from those of runs 1e-9 of
    their size apart at about half of the cycles; NaN of others."""
    chaotic: NDArray[np.bool_]
    """Whether each settled run is chaotic (m,), as in `average_velocity`."""
    status: NDArray[np.object_]
    """How each run ended, a `Status` each (m,)."""
    brute_cycles: int
    """Cycles of the drives in the settled runs."""
    branch_cycles: int
    """Cycles of the drives in the runs that the branches took."""
    brute_seconds: float
    """Processor time of the settled runs [s]."""
    branch_seconds: float
    """Processor time of the branches [s]."""
    map: ReturnMap
    """The map of period one whose runs settle."""

    @property
    def events(self) -> tuple[tuple[int, BranchEvent], ...]:
        """What changes along the branches: number of the branch, and event."""
        return tuple(
            (i, event) for i, branch in enumerate(self.branches) for event in branch.events
        )

    def early_ends(self) -> tuple[str, ...]:
        """Return where settled runs ended early, and why: a sentence for each reason."""
        axis, units = {self.path: self.values}, {self.path: self.unit}
        return early_ends(self.status, "No settled motion there.", axis, units, noun="runs")

    def to_dataframe(self, *, energy: bool = False) -> "pd.DataFrame":
        """Return a row for each point of each branch.

        Parameters
        ----------
        energy : bool
            Whether each point is run anew for columns of mean powers [W] and of the energy per
            travel, as `Branch.energies` gives them.
        """
        import pandas as pd

        frames = [
            branch.to_dataframe().assign(branch=i, **{
                f"mean velocity {name}": branch.mean_velocity(name) for name in branch.advances
            }, **(branch.energies(next(iter(branch.advances), None)) if energy else {}))
            for i, branch in enumerate(self.branches)
        ]  # fmt: skip
        return pd.concat(frames, ignore_index=True) if frames else pd.DataFrame()

    def _summary(self) -> Summary:
        units = [per_second(self.units[name]) for name in self.velocities]
        still = {n: SETTLED * np.nanmax(abs(v), initial=0.0) for n, v in self.velocities.items()}
        stretches = list[tuple[float, float, tuple[object, ...]]]()
        for i, branch in enumerate(self.branches):
            ways = {name: branch.mean_velocity(name) for name in self.velocities}
            for begin, end, *ends in branch.stretches:
                at = [*branch.values[begin:end].tolist(), *ends]
                kept = [np.where(abs(ways[n]) > still[n], ways[n], 0.0)[begin:end] for n in ways]
                shown = [span(way.min(), way.max(), u) for way, u in zip(kept, units, strict=True)]
                stretches.append((min(at), max(at), (branch.cycles, *shown, i)))
        widest = sorted(stretches, key=lambda stretch: stretch[0] - stretch[1])[:MOST_ROWS]
        spans = np.array([stretch[:2] for stretch in stretches]).reshape(-1, 2)
        edges, whole = np.unique(spans), self.between[1] - self.between[0]
        middles = 0.5 * (edges[1:] + edges[:-1])[:, None]
        beside = ((spans[:, 0] < middles) & (middles < spans[:, 1])).sum(axis=1)
        known, several = (edges[runs_of(beside > others)] for others in (0, 1))
        several = several[np.argsort(-np.ptp(several, axis=1))]
        shares = [percent(np.ptp(parts, axis=1).sum() / whole) for parts in (known, several)]
        sentence = f"Stable orbits are known over {shares[0]} of the range"
        if len(several):
            places = joined([span(low, high, self.unit, 4) for low, high in several[:3]])
            sentence += f", several side by side over {shares[1]}, most widely from {places}"
        which = f"The widest of {len(stretches)} stable stretches on {len(self.branches)} branches."
        moving = [f"mean velocity {name}" for name in self.velocities]
        head = (f"stable {self.path.rpartition('.')[2]}", "period", *moving, "branch")
        return Summary(
            sentence=f"{sentence}.",
            head=head if stretches else (),
            rows=[(span(low, high, self.unit, 4), *row) for low, high, row in sorted(widest)],
            notes=(*([which] if len(stretches) > MOST_ROWS else []), *self.costs()),
        )

    def costs(self) -> tuple[str, ...]:
        """Return what branches and settled runs took, and where runs ended early: sentences."""
        closed = int((self.settled > 0).sum())
        return (
            f"The branches took {self.branch_cycles} cycles and {number(self.branch_seconds, 2)} s"
            f" of processor time; the {len(self.values)} settled runs behind them, of which"
            f" {closed} close, {self.brute_cycles} cycles and {number(self.brute_seconds, 2)} s.",
            *self.open_motions(),
            *self.early_ends(),
        )

    def open_motions(self) -> tuple[str, ...]:
        """Return where settled runs are chaotic, and how far their means are known: sentences."""
        if not self.chaotic.any():
            return ()
        where = where_of(self.chaotic, {self.path: self.values}, {self.path: self.unit})
        means = []
        for name, spread in self.spreads.items():
            most = float(np.nan_to_num(spread[self.chaotic]).max())
            apart = quantity(most, per_second(self.units[name]), 2)
            means.append(
                f" Their mean velocity {name} differs by up to {apart} between starts 1e-9 of its"
                " size apart."
            )
        count = int(self.chaotic.sum())
        return (f"{count} of {len(self.values)} settled runs are chaotic{where}.{''.join(means)}",)


def orbit_diagram(
    mechanism: Mechanism,
    law: GivenFriction,
    path: str,
    between: tuple[float, float],
    *,
    cycles: int = 4,
    values: int | ArrayLike = 61,
    starts: int = 6,
    settle: int = 200,
    step: float = MOST_STEP,
    seed: int = 0,
    y0: Mapping[str, float] | None = None,
    period: float | None = None,
    section: Mapping[str, float] | None = None,
    solver: EventDriven | None = None,
    progress: Progress | None = None,
) -> OrbitDiagram:
    """Find branches of periodic orbits over a range of a parameter.

    Settled runs from several starts show where stable orbits are; each that lies on no branch yet
    begins a new one, which is followed to both sides, and at its period doublings doubled branches
    begin. Where a branch ends within the range, further runs settle beside its end. Orbits that are
    unstable and connected to no stable one are not found.

    Parameters
    ----------
    mechanism : Mechanism
        What moves, with a periodic drive or none.
    law : FrictionLaw, type or str, or mapping of str to these
        What holds it back, as in `simulate`.
    path : str
        What varies, as in `ensemble`.
    between : pair of float
        Least and largest value.
    cycles : int
        Largest period that is sought, in cycles of the drives.
    values : int or array_like (n,)
        Values with settled runs in this range, or their number if they are evenly spaced.
    starts : int
        Runs for each of them: the first from where the mechanism begins, others from random states
        at values between it and the next.
    settle : int
        Cycles before a run counts as settled; one that closes well after a quarter or half of them
        has settled.
    step : float
        Largest step along a branch, as in `continue_orbit`.
    seed : int
        Of the random states.
    y0 : mapping, optional
        States from which the first run at each value begins, as in `simulate`.
    period : float, optional
        Length of a cycle [s]; that of the drives if not given, or else sought.
    section : mapping, optional
        Where cycles of unknown length begin, as in `periodic_orbit`; else it has no effect.
    solver : EventDriven, optional
        Compiled if not given.
    progress : callable, optional
        Called with the number of values done and of all; if it returns False, no more begin.

    Returns
    -------
    OrbitDiagram
        Branches, their events, and the settled motions.

    Raises
    ------
    InputError
        If an argument cannot be used, or the drives have no cycle.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=2.0))
    >>> law = Coulomb(kinetic_coefficient=0.5)
    >>> found = orbit_diagram(axis, law, "frequency", (1.9, 2.4), values=3, cycles=2, settle=50)
    >>> [(branch.cycles, bool(branch.stable.all())) for branch in found.branches]
    [(1, True)]
    """
    owner = "orbit_diagram"
    check_path(owner, path)
    low, high = between_of(owner, between)
    check_step(owner, step, DIAGRAM_STEP)
    laws = event_driven_law(mechanism, law)
    for name, count, least in (("cycles", cycles, 1), ("starts", starts, 1), ("settle", settle, 0)):
        counted(owner, name, count, least)
    if np.ndim(values) == 0:
        values = np.linspace(low, high, counted(owner, "values", values, 2))
    mechanism, laws = beginning_pair(mechanism, laws, {path: [low, high]})
    full, grid = axis_of(mechanism, laws, path, values)
    grid = np.unique(grid)
    check_path(owner, full)
    if not low <= grid[0] <= grid[-1] <= high:
        unit = unit_of(mechanism, laws, full)
        raise InputError(
            f"{owner}: values of {full} must lie in {span(low, high, unit, 6)}, the range given by"
            f" between, got {span(float(grid[0]), float(grid[-1]), unit, 6)}."
        )
    if period is None:
        whole_run(owner, mechanism, settle + 2 * cycles)
    else:
        PERIOD.check(owner, "period", period)
    first = within(
        _excited_map(mechanism, laws, grid, full, y0, section, settle, compiled(solver))
        if period is None and is_excited(mechanism)
        else return_map(mechanism, laws, 1, period, compiled(solver), full),
        (low, high),
    )
    search = Search(
        first,
        (low, high),
        int(cycles),
        int(settle),
        step,
        np.random.default_rng(seed),
        dict(y0 or {}),
        (high - low) / (max(len(grid), 2) - 1) / FINER,
    )
    tally = Tally(len(grid), progress)
    shares, widths = np.arange(1, int(starts)) / int(starts), np.diff(grid, append=high)
    for done, (value, width) in enumerate(zip(grid.tolist(), widths.tolist(), strict=True), 1):
        search.settle_at(value, search.starts(value, 1, from_beginning=True))
        for other in (value + shares * width).tolist() if width > 0.0 else ():
            search.settle_at(other, search.starts(other, 1))
        tally.tell(done)
        if not tally.going:
            break
    for _ in range(len(grid) * int(starts)):  # as many again at most: chaos has no last branch
        if not tally.going or (result := search.place()) is None:
            break
        search.settle_at(*result)
        tally.tell(len(grid))
    return search.diagram()


def _excited_map(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    values: Array,
    path: str,
    y0: Mapping[str, float] | None,
    given: Mapping[str, float] | None,
    settle: int,
    solver: EventDriven,
) -> ReturnMap:
    """Return the map of cycles that nothing drives in time, at the first value with any."""
    states, lack = states_of(mechanism, law), ""
    section = given_section(states, given)
    for value in values.tolist():
        pair = pair_of(mechanism, law, {path: value})
        begin = initial_state("orbit_diagram", *pair, dict(y0 or {}))
        result = passes_of(*pair, states, begin, solver, settle + 2, section)
        if not result.lack:
            cycle = float(result.times[-1] - result.times[-2])
            return return_map(mechanism, law, 1, None, solver, path, result.section, cycle)
        lack = lack or result.lack
    raise SimulationError(f"orbit_diagram, at the first of all values: {lack}")


class Search:
    """Settled runs, and the branches that they lead to."""

    def __init__(
        self,
        first: ReturnMap,
        between: tuple[float, float],
        cycles: int,
        settle: int,
        step: float,
        random: np.random.Generator,
        y0: Mapping[str, float],
        finest: float,
    ) -> None:
        self.finest = finest
        self.map, self.between, self.cycles, self.settle = first, between, cycles, settle
        self.step, self.random, self.y0 = step, random, y0
        self.unit = unit_of(first.mechanism, first.law, str(first.path))
        self.branches: list[Branch] = []
        self.values: list[float] = []
        self.samples: list[Array] = []
        self.velocities: list[Array] = []
        self.closed: list[int] = []
        self.spreads: list[Array] = []
        self.chaotic: list[bool] = []
        self.status: list[object] = []
        self.sizes = np.zeros(len(first.free))
        self.seconds = {"brute": 0.0, "branches": 0.0}
        self.brute_cycles = 0
        self.looked = np.empty(0)
        self.stable: list[Array] = []
        self.depth = 0
        self.lost: list[tuple[float, Mapping[str, Array]]] = []

    def settle_at(self, value: float, columns: Mapping[str, Array]) -> None:
        """Run from several states at a value, and follow each orbit that is new."""
        begun = process_time()
        first = len(self.values)
        self.run(value, columns)
        self.seconds["brute"] += process_time() - begun
        begun = process_time()
        for i, points in enumerate(self.samples[first:], first):
            closed = self.closed[i]
            if closed and not self.is_near(closed, value, points[:closed]):
                # it fails at a grazing contact, say: settled runs at other values lead there
                try:
                    y = points[-1].copy()
                    if self.map.section is not None:  # the mean of their lengths
                        y[self.map.slot] = points[-closed:, self.map.slot].mean()
                    self.follow(solved(replace(self.map, cycles=closed), y, value))
                except (SimulationError, InputError):
                    if self.map.section is not None:  # what dies away towards steady sliding
                        self.closed[i] = 0
        self.seconds["branches"] += process_time() - begun

    def place(self) -> tuple[float, Mapping[str, Array]] | None:
        """Return a value at which something unknown may be stable, and starts of runs there.

        Behind where stability is lost, beside an end of a branch within the range, then where no
        orbit is known that is stable. As something attracts there, few runs find it.
        """
        low, high = self.between
        span = high - low
        while self.lost:
            beyond, columns = self.lost.pop()
            unknown = any(begin < beyond < end for begin, end in self.gaps())
            if unknown and self.is_new(beyond, RIGHT_BEHIND * span):
                return beyond, columns
        for branch in self.branches:
            for end in (float(branch.values[0]), float(branch.values[-1])):
                for off in BEHIND if low < end < high else ():
                    beside = end + off * span
                    if low < beside < high and self.is_new(beside, BESIDE * span):
                        return beside, self.starts(beside, FEW)
        # where nothing drives it, steady sliding may be all there is
        for begin, end in self.gaps() if self.map.section is None else ():
            inside = self.looked[(begin < self.looked) & (self.looked < end)]
            known = [begin, *np.sort(inside).tolist(), end]
            widths = np.diff(known)
            at = int(np.argmax(widths))
            if widths[at] > 2.0 * self.finest:
                middle = 0.5 * (known[at] + known[at + 1])
                self.looked = np.append(self.looked, middle)
                return middle, self.starts(middle, FEW)
        return None

    def losses(self, branch: Branch) -> list[tuple[float, Mapping[str, Array]]]:
        """Return values right behind where a branch loses its stability, and its states there.

        Behind is where the stable part would go on.
        """
        low, high = self.between
        result: list[tuple[float, Mapping[str, Array]]] = []
        values = branch.values
        for begin, end, *ends in branch.stretches:
            inside = values[min(begin + 1, end - 1)], values[max(end - 2, begin)]
            for i, before, edge in zip((begin, end - 1), inside, ends, strict=True):
                columns = {
                    f"initial.{name}": branch.starts[i : i + 1, k]
                    for k, name in enumerate(branch.states)
                }
                beyond = edge + float(np.sign(edge - before)) * RIGHT_BEHIND * (high - low)
                if beyond != edge and low < beyond < high:
                    result.append((beyond, columns))
        return result

    def is_new(self, value: float, reach: float) -> bool:
        """Whether nobody has looked within reach of a value, which is noted then."""
        if (np.abs(self.looked - value) <= reach).any():
            return False
        self.looked = np.append(self.looked, value)
        return True

    def gaps(self) -> list[tuple[float, float]]:
        """Return the parts of the range in which no stable orbit is known, from below."""
        low, high = self.between
        for branch in self.branches[len(self.stable) :]:
            for begin, end, *ends in branch.stretches:
                at = [*branch.values[begin:end].tolist(), *ends]
                self.stable.append(np.array([[min(at), max(at)]]))
        parts = np.concatenate([np.full((1, 2), high), *self.stable])
        begins, until = parts[np.argsort(parts[:, 0], kind="stable")].T
        reached = np.maximum.accumulate(np.append(low, until[:-1]))
        at = begins > reached
        return list(zip(reached[at].tolist(), begins[at].tolist(), strict=True))

    def run(self, value: float, columns: Mapping[str, Array]) -> None:
        """Keep the samples of settled runs at a value.

        Runs that close sooner by far are not run on.
        """
        keep, early = 2 * self.cycles, self.settle // EARLY
        rows, count = np.arange(len(next(iter(columns.values())))), 0
        samples = np.full((len(rows), keep, len(self.map.free)), np.nan)
        ways = np.full((len(rows), len(self.map.moving)), np.nan)
        closed, status = np.zeros(len(rows), dtype=int), np.empty(len(rows), dtype=object)
        # Runs that close clearly after a quarter or half of the cycles need not go on.
        for share in (1, 2, EARLY):
            tolerance = ALIKE if share == EARLY else ALIKE / SOONER
            settle = max((self.settle if share == EARLY else share * early) - count, 0)
            count += settle + keep
            begun = columns
            points, ways[rows], status[rows] = self.sampled(value, begun, settle)
            samples[rows] = points
            self.brute_cycles += len(rows) * (settle + keep)
            whole = np.isfinite(points).all(axis=(1, 2))
            # of settled motions so far, and of these samples: a single run may rest
            scale = np.maximum(self.sizes, np.abs(points[whole]).max(axis=(0, 1), initial=0.0))
            scale = np.where(scale > 0.0, scale, np.finfo(float).tiny)
            closed[rows] = [period_of(point, scale, tolerance) for point in points]
            # of settled motions: starts twice as large as transients would grow for ever
            settled = points[closed[rows] > 0]
            self.sizes = np.maximum(self.sizes, np.abs(settled).max(axis=(0, 1), initial=0.0))
            going = whole & (closed[rows] == 0)
            rows, ends = rows[going], points[going, -1]
            if not len(rows):
                break
            columns = {f"initial.{n}": ends[:, k] for k, n in enumerate(self.map.names)}
        spreads, chaotic = np.full_like(ways, np.nan), np.zeros(len(samples), dtype=bool)
        if len(rows):
            scale = np.maximum(self.sizes, np.abs(samples[rows]).max(axis=(0, 1)))
            stopped = {f"initial.{stop.coordinate}" for stop in stops_of(self.map.mechanism)}
            near = {
                path: column[going] + ROUNDING * size * (path not in stopped)
                for (path, column), size in zip(begun.items(), scale, strict=True)
            }
            points, others, _ = self.sampled(value, near, settle)
            self.brute_cycles += len(rows) * (settle + keep)
            spreads[rows] = np.abs(others - ways[rows])
            size = np.where(scale > 0.0, scale, np.finfo(float).tiny)
            gaps = (np.abs(points - samples[rows]) / size).max(axis=(1, 2)) / ROUNDING
            chaotic[rows] = have_left(gaps)
            # exponents are those of cycles of a known length
            for row in rows[~chaotic[rows]].tolist() if self.map.section is None else ():
                with suppress(SimulationError, InputError):
                    chaotic[row] = diverges(self.map, samples[row, -1], value=value)
        self.spreads += list(spreads)
        self.chaotic += chaotic.tolist()
        self.values += [value] * len(samples)
        self.samples += list(samples)
        self.closed += closed.tolist()
        self.status += list(status)
        self.velocities += list(ways)

    def sampled(
        self, value: float, columns: Mapping[str, Array], settle: int
    ) -> tuple[Array, Array, NDArray[np.object_]]:
        """Return free states once a cycle after some, mean velocities, and how each run ended."""
        mechanism, law = self.map.pair(value)
        if self.map.section is not None:
            return self.passed(mechanism, law, columns, settle)
        cycle, keep, kept = self.map.duration(mechanism, value), 2 * self.cycles, self.map.kept
        begin = initial_state("orbit_diagram", mechanism, law, self.y0)
        form = self.map.form_at(value)
        count, free = len(next(iter(columns.values()))), len(self.map.free)
        points = np.full((count, keep, free), np.nan)
        velocities = np.full((count, len(kept) - free), np.nan)
        status = np.empty(count, dtype=object)
        for row in range(count):
            start = list(begin)
            for i, name in zip(self.map.free, self.map.names, strict=True):
                start[i] = float(columns[f"initial.{name}"][row])
            left = settle + keep
            while True:  # by stretches, whose records are not kept
                cycles = left if left <= STRETCH + keep else STRETCH
                run = self.map.solver.bare(
                    mechanism, law, y0=start, t_end=cycles * cycle, form=form
                )
                status[row] = run.status
                left -= cycles
                if not run.status.complete or not left:
                    break
                start = self.map.seen(mechanism, run, np.array([cycles * cycle]))[0].tolist()
            if run.status.complete:
                times = [cycle * i for i in range(cycles - keep, cycles + 1)]
                states = self.map.seen(mechanism, run, np.array(times))[:, kept]
                points[row] = states[1:, :free]
                velocities[row] = (states[-1, free:] - states[0, free:]) / (keep * cycle)
        return points, velocities, status

    def passed(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws,
        columns: Mapping[str, Array],
        settle: int,
    ) -> tuple[Array, Array, NDArray[np.object_]]:
        """Return what `sampled` does, where a section is passed, with the lengths between."""
        map_, keep = self.map, 2 * self.cycles
        assert map_.section is not None
        begin = initial_state("orbit_diagram", mechanism, law, self.y0)
        count = len(next(iter(columns.values())))
        points = np.full((count, keep, len(map_.free)), np.nan)
        velocities = np.full((count, len(map_.moving)), np.nan)
        status = np.empty(count, dtype=object)
        for row in range(count):
            start = list(begin)
            for i, name in zip(map_.free, map_.names, strict=True):
                known = name != map_.section.state and f"initial.{name}" in columns
                start[i] = float(columns[f"initial.{name}"][row]) if known else start[i]
            result = passes_of(
                mechanism, law, map_.states, start, map_.solver, settle + keep + 1, map_.section
            )
            status[row] = result.status
            if not result.lack:
                points[row] = result.starts[-1 - keep : -1, map_.free]
                points[row, :, map_.slot] = np.diff(result.times[-1 - keep :])
                came = result.starts[-1, map_.moving] - result.starts[-1 - keep, map_.moving]
                velocities[row] = came / (result.times[-1] - result.times[-1 - keep])
        return points, velocities, status

    def starts(self, value: float, count: int, *, from_beginning: bool = False) -> dict[str, Array]:
        """Return initial states of runs of the size of settled motions, the first as given.

        Within hard stops, at which a place beyond is put.
        """
        mechanism, law = self.map.pair(value)
        begin = initial_state("orbit_diagram", mechanism, law, self.y0)
        stops = stops_of(mechanism)
        result = {}
        sizes = np.where(self.sizes > 0.0, self.sizes, 1.0)
        for k, i in enumerate(self.map.free):
            name = self.map.states[i]
            column = begin[i] + 2.0 * sizes[k] * self.random.uniform(-1.0, 1.0, count)
            for stop in (wall for wall in stops if wall.coordinate == name):
                place = float(stop.position)
                bound = np.minimum if stop.side == "upper" else np.maximum
                column = bound(column, place)
            if from_beginning:
                column[0] = begin[i]
            result[f"initial.{name}"] = column
        return result

    def is_near(self, closed: int, value: float, points: Array) -> bool:
        """Whether a settled motion, by its points once a cycle, lies on a branch that is known."""
        scale = np.where(self.sizes > 0.0, self.sizes, 1.0)
        near = (b.crossings(value)[:, None] for b in self.branches if b.cycles == closed)
        return any((np.abs((x - points) / scale).max(axis=2) <= SAME).any() for x in near)

    def curve(self, cycles: int) -> Curve:
        """Return a branch that is about to be followed, and knows all others of its period."""
        map_ = replace(self.map, cycles=cycles)
        curve = Curve(map_, *self.between, self.unit, self.step, MOST_POINTS, DIAGRAM_STEP)
        curve.searching = True
        trails, numbers = [np.empty((0, len(map_.free) + 1))], [np.empty(0, dtype=int)]
        for i, branch in enumerate(self.branches):
            if branch.cycles == cycles:
                trail = np.column_stack([branch.starts, branch.values])
                trails += [trail, np.full_like(trail[:1], np.nan)]  # neighbours of one branch only
                numbers.append(np.full(len(trail) + 1, i))
        curve.known = np.concatenate(trails), np.concatenate(numbers)
        return curve

    def follow(self, shot: Shot) -> None:
        """Follow the branch of an orbit, after the least cycles in which it closes.

        A run that comes to rest from either side in turn seems to close after twice as many.
        """
        cycles = len(shot.strobes)
        # Distance from the start after each cycle: the first that closes is the period.
        off = np.abs(shot.strobes - shot.y) / shot.scale
        least = next(
            (m for m in range(1, cycles) if cycles % m == 0 and off[m].max() <= SETTLED), cycles
        )
        if least < cycles:
            shot = solved(replace(self.map, cycles=least), shot.y, shot.value)
        curve = self.curve(least)
        self.followed(curve, curve.point(shot))

    def followed(self, curve: Curve, first: Point) -> None:
        """Follow a branch from an orbit that is on none yet, and those that it leads to."""
        if curve.met(first) is not None:
            return
        branch = curve.branch(first)
        self.branches.append(branch)
        self.lost += self.losses(branch)
        for event in branch.events:
            if event.kind == "period doubling" and 2 * branch.cycles <= self.cycles:
                y = self.map.unknowns_of(event.orbit)
                # nothing leaves where a multiplier jumps across -1
                with suppress(SimulationError, InputError):
                    doubled = self.curve(2 * branch.cycles)
                    self.followed(doubled, doubled.doubled(self.map, event.orbit, y, event.value))
        for shot in curve.halved:
            half = replace(self.map, cycles=branch.cycles // 2)
            with suppress(SimulationError, InputError):
                self.follow(solved(half, shot.y, shot.value))
        if self.depth >= DEEPEST:
            return
        self.depth += 1
        for shot in curve.beyond[:MOST_BEYOND]:
            with suppress(SimulationError, InputError):
                self.follow(solved(branch.map, shot.y, shot.value))
        self.depth -= 1

    def diagram(self) -> OrbitDiagram:
        """Return what was found."""
        velocities = np.array(self.velocities).reshape(len(self.values), -1)
        return OrbitDiagram(
            path=str(self.map.path),
            between=self.between,
            unit=self.unit,
            states=self.map.unknowns,
            units=units_of(self.map),
            branches=tuple(self.branches),
            values=np.array(self.values),
            samples=np.array(self.samples),
            velocities={
                self.map.states[i]: velocities[:, k] for k, i in enumerate(self.map.moving)
            },
            settled=np.array(self.closed, dtype=np.int64),
            spreads={
                self.map.states[i]: np.reshape(self.spreads, velocities.shape)[:, k]
                for k, i in enumerate(self.map.moving)
            },
            chaotic=np.array(self.chaotic, dtype=np.bool_),
            status=np.array(self.status, dtype=object),
            brute_cycles=self.brute_cycles,
            branch_cycles=sum(branch.runs * branch.cycles for branch in self.branches),
            brute_seconds=self.seconds["brute"],
            branch_seconds=self.seconds["branches"],
            map=self.map,
        )  # fmt: skip
