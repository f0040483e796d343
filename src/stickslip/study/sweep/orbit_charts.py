"""Charts of periodic orbits over two parameters: stable motions of each cell, curves of events.

1. Over the first parameter diagrams are made at a few values of the second (`orbit_diagrams`).
2. From their stable orbits neighbouring cells of a grid are reached by Newton's steps from the
   tangent (M - 1) dy = -dPhi/dp dp, from these their neighbours, and so on, as far as orbits stay
   stable: a motion of a cell is known where its sheet of stable orbits is.
3. Where a cell has none, a run settles from the motions beside it and from rest, and sheets that it
   leads to are followed in the same way.
4. Each event of the branches is followed over both parameters (`event_curves`), but for those that
   lie on a curve that is known.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from time import process_time
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.simulation import GivenFriction, event_driven_law
from stickslip.engine.solver import EventDriven
from stickslip.errors import InputError, SimulationError
from stickslip.mechanisms import Mechanism
from stickslip.show.display import OnAxes, Summary, Tabular
from stickslip.show.formatting import number, percent, quantity
from stickslip.study.sweep.continuation import (
    MOST_STEP,
    BranchEvent,
    between_of,
    check_step,
    units_of,
)
from stickslip.study.sweep.event_curves import KINDS, EventCurve, continue_event
from stickslip.study.sweep.orbit_diagrams import SAME, OrbitDiagram, Search, orbit_diagram
from stickslip.study.sweep.orbits import Shot, is_excited, solved, value_of
from stickslip.study.sweep.parameter_grid import (
    Array,
    Progress,
    Tally,
    axis_of,
    check_path,
    compiled,
    counted,
    pair_of,
    unit_of,
)
from stickslip.study.tolerances import ROUNDING

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["OrbitChart", "orbit_chart"]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class OrbitChart(OnAxes, Tabular):
    """Stable periodic motions over two parameters, and the curves at which they change."""

    paths: tuple[str, str]
    """Full paths of the parameters."""
    parameter_units: tuple[str, str]
    """Their SI units."""
    axes: tuple[Array, Array]
    """Their values (n,), (m,)."""
    count: NDArray[np.int64]
    """Number of stable periodic motions known (n, m)."""
    velocities: Mapping[str, Array]
    """Mean velocity [m/s] or [rad/s] of the fastest of them (n, m), of each coordinate on which
    nothing depends; NaN where none is known."""
    motions: Mapping[tuple[int, int], tuple[tuple[int, Array], ...]]
    """Cycles and free states at time 0 of the motions of each cell."""
    curves: tuple[EventCurve, ...]
    """Curves of events."""
    states: tuple[str, ...]
    """Free states."""
    units: Mapping[str, str]
    """SI units of all states."""
    seconds: float
    """Processor time that it took [s]."""
    lost: tuple[str, ...]
    """Why events have no curve: sentences."""

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each point of each curve."""
        import pandas as pd

        frames = [curve.to_dataframe().assign(curve=i) for i, curve in enumerate(self.curves)]
        names = [*self.paths, "event", "cycles", *self.states, "curve"]
        return pd.concat(frames, ignore_index=True) if frames else pd.DataFrame(columns=names)

    def _summary(self) -> Summary:
        share = [(n, float((self.count == n).mean())) for n in np.unique(self.count).tolist()]
        parts = ", ".join(f"{n} over {percent(part)}" for n, part in share)
        rows = [
            (p.kind, *map(quantity, p.values, self.parameter_units, (5, 5)), i)
            for i, curve in enumerate(self.curves)
            for p in curve.points
        ]
        names = [path.rpartition(".")[2] for path in self.paths]
        kinds = [curve.kind for curve in self.curves]
        counted_ = ", ".join(f"{kinds.count(kind)} of {kind}" for kind in dict.fromkeys(kinds))
        return Summary(
            sentence=f"Number of stable periodic motions: {parts} of {self.count.size} cells."
            f" Curves: {counted_ or 'none'}.",
            head=("point", *names, "curve") if rows else (),
            rows=rows,
            notes=(f"It took {number(self.seconds, 2)} s of processor time.", *self.lost),
        )


def orbit_chart(
    mechanism: Mechanism,
    law: GivenFriction,
    ranges: Mapping[str, tuple[float, float]],
    *,
    cycles: int = 2,
    values: tuple[int, int] = (40, 40),
    lines: int = 3,
    runs: int = 13,
    settle: int = 100,
    step: float = MOST_STEP,
    seed: int = 0,
    y0: Mapping[str, float] | None = None,
    solver: EventDriven | None = None,
    progress: Progress | None = None,
) -> OrbitChart:
    """Find stable periodic motions over two parameters, and the curves at which they change.

    Parameters
    ----------
    mechanism : Mechanism
        What moves, with a periodic drive.
    law : FrictionLaw, type or str, or mapping of str to these
        What holds it back, as in `simulate`.
    ranges : mapping of str to pair of float
        Range of each of two parameters, as in `ensemble`.
    cycles : int
        Largest period that is sought, in cycles of the drives.
    values : pair of int
        Cells of the grid along both.
    lines : int
        Values of the second parameter at which branches are followed over the first.
    runs : int
        Values of the first at which runs settle on each of these lines.
    settle : int
        Cycles before a run counts as settled.
    step : float
        Largest step along branches and curves, as in `continue_orbit`.
    seed : int
        Of random states.
    y0 : mapping, optional
        States from which the first runs begin, as in `simulate`.
    solver : EventDriven, optional
        Compiled if not given.
    progress : callable, optional
        Called with the number of lines done and of all; if it returns False, no more begin.

    Returns
    -------
    OrbitChart
        Number and velocity of the motions of each cell, and curves with their points of
        codimension two.

    Raises
    ------
    InputError
        If an argument cannot be used, or the drives have no cycle.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=2.0))
    >>> ranges = {"frequency": (1.9, 2.4), "amplitude": (3.0, 4.0)}
    >>> law = Coulomb(kinetic_coefficient=0.5)
    >>> found = orbit_chart(axis, law, ranges, values=(3, 3), cycles=1, lines=1, runs=2, settle=50)
    >>> found.count.tolist()
    [[1, 1, 1], [1, 1, 1], [1, 1, 1]]
    """
    owner, begun = "orbit_chart", process_time()
    laws = event_driven_law(mechanism, law)
    if len(ranges) != 2:
        raise InputError(f"{owner}: ranges must map two parameters to pairs, got {ranges!r}.")
    if is_excited(mechanism):
        raise InputError(
            f"{owner}: {type(mechanism).__name__} has no drive that repeats itself: draw diagrams"
            " over one parameter (orbit_diagram) for motions with a period of their own."
        )
    check_step(owner, step, 0.0)
    for name, count in (("lines", lines), ("runs", runs), ("values", min(values))):
        counted(owner, name, count, 1)
    box, full, units = list[tuple[float, float]](), list[str](), list[str]()
    for path, pair in ranges.items():
        check_path(owner, path)
        box.append(between_of(owner, pair))
        full.append(axis_of(mechanism, laws, path, box[-1])[0])
        check_path(owner, full[-1])
        units.append(unit_of(mechanism, laws, full[-1]))
    axes = np.linspace(*box[0], values[0]), np.linspace(*box[1], values[1])
    tally, tool = Tally(int(lines), progress), compiled(solver)
    diagrams, rows = list[OrbitDiagram](), list[int]()
    for k in range(int(lines)):
        j = (2 * k + 1) * len(axes[1]) // (2 * int(lines))
        rig = pair_of(mechanism, laws, {full[1]: float(axes[1][j])})
        settings: dict[str, Any] = {"cycles": cycles, "values": max(int(runs), 2), "starts": 2}
        settings |= {"settle": settle, "step": step, "seed": seed, "y0": y0, "solver": tool}
        diagrams.append(orbit_diagram(*rig, full[0], box[0], **settings))
        rows.append(j)
        tally.tell(k + 1)
        if not tally.going:
            break
    sheets = _Sheets(diagrams, axes, full[1], settle, int(cycles), dict(y0 or {}), seed)
    for diagram, j in zip(diagrams, rows, strict=True):
        sheets.take(diagram, j)
    sheets.fill()
    curves, lost = _curves(diagrams, (full[0], full[1]), box, step)
    return sheets.chart(full, units, curves, lost, begun)


class _Sheets:
    """Stable motions of the cells of a grid."""

    def __init__(
        self,
        diagrams: Sequence[OrbitDiagram],
        axes: tuple[Array, Array],
        second: str,
        settle: int,
        cycles: int,
        y0: Mapping[str, float],
        seed: int,
    ) -> None:
        self.diagrams, self.axes, self.second = diagrams, axes, second
        first = diagrams[0].map
        low, high = diagrams[0].between
        random = np.random.default_rng(seed)
        self.searches = []
        for value in axes[1].tolist():
            mechanism, law = pair_of(first.mechanism, first.law, {second: value})
            map_ = replace(first, mechanism=mechanism, law=law)
            self.searches.append(
                Search(map_, (low, high), cycles, settle, MOST_STEP, random, y0, high - low)
            )
        self.cells: dict[tuple[int, int], list[Shot]] = {}
        self.going: deque[tuple[int, int, Shot]] = deque()

    def take(self, diagram: OrbitDiagram, j: int) -> None:
        """Take the stable orbits of a diagram in its row, and follow their sheets."""
        for branch in diagram.branches:
            for begin, end, *_ in branch.stretches:
                inside = branch.values[begin:end]
                for i in np.flatnonzero(
                    (inside.min() <= self.axes[0]) & (self.axes[0] <= inside.max())
                ).tolist():
                    k = begin + int(np.argmin(np.abs(inside - self.axes[0][i])))
                    self.solve(i, j, branch.cycles, branch.starts[k])
        self.spread()

    def solve(self, i: int, j: int, cycles: int, y: Array) -> None:
        """Note the orbit near a start in a cell, if it is stable and new."""
        with suppress(SimulationError, InputError):
            shot = solved(replace(self.searches[j].map, cycles=cycles), y, float(self.axes[0][i]))
            known = self.cells.setdefault((i, j), [])
            if np.abs(np.linalg.eigvals(shot.monodromy)).max(initial=0.0) < 1.0 and not any(
                (np.abs(other.strobes - shot.y) / shot.scale).max(axis=1).min() < SAME
                for other in known
            ):
                known.append(shot)
                self.going.append((i, j, shot))

    def spread(self) -> None:
        """Follow sheets from cell to cell."""
        (n, m), widths = (
            map(len, self.axes),
            [float(np.ptp(x)) / max(len(x) - 1, 1) for x in self.axes],
        )
        while self.going:
            i, j, shot = self.going.popleft()
            cycles = len(shot.strobes)
            matrix = shot.monodromy - np.eye(len(shot.y))
            along = -np.linalg.lstsq(matrix, shot.slope, rcond=1e-12)[0]
            for a in (i - 1, i + 1):
                if 0 <= a < n:
                    self.solve(a, j, cycles, shot.y + (a - i) * widths[0] * along)
            for b in (j - 1, j + 1):
                if 0 <= b < m:
                    # the other way by what changed over two rows, if the orbit is known there
                    self.solve(i, b, cycles, shot.y + self.change(i, 2 * j - b, shot))

    def change(self, i: int, j: int, shot: Shot) -> Array:
        """Return how an orbit differs from that of its sheet in another row, if it is known."""
        for other in self.cells.get((i, j), []):
            off = shot.y - other.y
            if len(other.strobes) == len(shot.strobes) and other.signature == shot.signature:
                return off
        return np.zeros_like(shot.y)

    def fill(self) -> None:
        """Let runs settle in cells of which nothing is known, from beside them and from rest."""
        for i, j in np.ndindex(*map(len, self.axes)):
            if self.cells.get((i, j)):
                continue
            search, value = self.searches[j], float(self.axes[0][i])
            near = [
                shot.y
                for cell in ((i - 1, j), (i, j - 1), (i + 1, j), (i, j + 1))
                for shot in self.cells.get(cell, [])
            ]
            starts = search.starts(value, 1, from_beginning=True)
            for k, column in enumerate(starts.values()):
                starts[list(starts)[k]] = np.array([*column, *(y[k] for y in near[:1])])
            first = len(search.closed)
            search.run(value, starts)
            for closed, points in zip(search.closed[first:], search.samples[first:], strict=True):
                if closed:
                    self.solve(i, j, closed, points[-1])
            self.spread()

    def chart(
        self,
        full: list[str],
        units: list[str],
        curves: list[EventCurve],
        lost: list[str],
        begun: float,
    ) -> OrbitChart:
        """Return what is known."""
        shape = len(self.axes[0]), len(self.axes[1])
        count, map_ = np.zeros(shape, dtype=np.int64), self.searches[0].map
        velocities = {map_.states[i]: np.full(shape, np.nan) for i in map_.moving}
        for cell, shots in self.cells.items():
            count[cell] = len(shots)
            speeds = np.array([shot.advance / shot.period for shot in shots])
            for k, name in enumerate(velocities) if shots else ():
                velocities[name][cell] = speeds[np.argmax(np.abs(speeds[:, k])), k]
        return OrbitChart(
            paths=(full[0], full[1]),
            parameter_units=(units[0], units[1]),
            axes=self.axes,
            count=count,
            velocities=velocities,
            motions={
                cell: tuple((len(shot.strobes), shot.y) for shot in shots)
                for cell, shots in self.cells.items()
            },
            curves=tuple(curves),
            states=map_.names,
            units=units_of(map_),
            seconds=process_time() - begun,
            lost=tuple(dict.fromkeys(lost)),
        )


def _curves(
    diagrams: Sequence[OrbitDiagram],
    paths: tuple[str, str],
    box: Sequence[tuple[float, float]],
    step: float,
    most: int = 400,
) -> tuple[list[EventCurve], list[str]]:
    """Follow the events of branches, each curve once; return why some have none, too."""
    curves, lost = list[EventCurve](), list[str]()
    width = box[0][1] - box[0][0]
    for diagram in diagrams:
        wide = [b for b in diagram.branches if np.ptp(b.values) > SAME * width]
        for event in (event for branch in wide for event in branch.events):
            if event.kind not in KINDS or any(_has(curve, event, box) for curve in curves):
                continue
            try:
                curve = continue_event(event, paths, box, step=step, points=most)
                middle = len(curve.values) // 2  # an event is located beside its curve
                place = curve.values[middle], curve.starts[middle : middle + 1]
                same = (c for c in curves if (c.kind, c.cycles) == (curve.kind, curve.cycles))
                if not any(_lies_on(other, *place, box) for other in same):
                    curves.append(curve)
            except (SimulationError, InputError) as error:
                at = quantity(event.value, diagram.unit, 5)
                lost.append(f"The {event.kind} at {at} has no curve: {error}")
    return curves, lost


def _has(curve: EventCurve, event: BranchEvent, box: Sequence[tuple[float, float]]) -> bool:
    """Whether an event lies on a curve: by the parameters and the states at its points."""
    if (curve.kind, curve.cycles) != (event.kind, event.orbit.cycles):
        return False
    orbit = event.orbit
    other = value_of(orbit.mechanism, orbit.law, curve.paths[1])
    states = orbit.run().at(np.arange(orbit.cycles) * (orbit.period / orbit.cycles))
    # an orbit of two cycles is the same a cycle later
    starts = np.column_stack([states[name] for name in curve.states])
    return _lies_on(curve, np.array([event.value, other]), starts, box)


def _lies_on(
    curve: EventCurve, values: Array, starts: Array, box: Sequence[tuple[float, float]]
) -> bool:
    """Whether parameters with any of some starts lie on a curve."""
    sizes = np.abs(curve.starts).max(axis=0)
    sizes[sizes <= ROUNDING * sizes.max()] = 1.0  # what is lost to sticking
    widths = np.array([high - low for low, high in box])
    points = np.column_stack([curve.values / widths, curve.starts / sizes])
    chords = np.diff(points, axis=0)
    squares = np.maximum((chords**2).sum(axis=1), 1e-30)
    for start in starts:
        u = np.concatenate([values / widths, start / sizes])
        along = np.clip(((u - points[:-1]) * chords).sum(axis=1) / squares, 0.0, 1.0)
        if (np.linalg.norm(u - points[:-1] - along[:, None] * chords, axis=1) < SAME).any():
            return True
    return False
