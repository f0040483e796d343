"""Branches of periodic orbits over a parameter, by pseudo-arclength.

Unknown is u = (y / scale, p / range): the free states of an orbit (see `orbits`) and the parameter.
Along a branch F(u) = 0, where stability plays no part:

1. Predictor: a step ds along the tangent t, the null vector of [dF/dy, dF/dp]; by a polynomial
   through the last points and their tangents where the same happens in them. If something else
   happens in a run from there, bisection by such runs, without derivatives, tells up to where the
   same does, and the step ends in front of that.
2. Corrector: Newton's steps with the further equation t (u - u0) = ds; a derivative costs more
   than its run and is taken where it is used, else mended by Broyden's rule. The last step needs no
   run where the two before show what it leaves, or how the derivative changes from a point nearby.
   The step grows where few of them are needed, up to where the tangent turns by a given angle, is
   halved where they fail, and ends in front of a pole of the derivative. Scales follow the states.
3. Smooth events between two points, each located on the arc by false position; that of a torus by
   bisection.
     fold             the tangent's component along p changes its sign
     period doubling  det(M + 1) changes its sign: a multiplier passes -1
     branch point     det[dF/du; t] changes its sign: another branch of the same period crosses,
                      or this one begins there at a pitchfork and goes on as its mirror image
     torus            a complex pair of multipliers passes the unit circle
   Events at which what happens in a period changes:
     grazing          a stop or a switch is met more or less often
     sticking         begins, ends, or its intervals change in number
     reversal         the velocity changes its sign more or less often
   There the monodromy may jump, so that stability changes without a multiplier at the unit circle:
   the sentence of the event says it.
4. Across such a change the branch is stepped: the corrector starts right behind, in the plane
   across the null vector there, which also finds where a branch turns back (a non-smooth fold). At
   a grazing contact the saltation factor is infinite: the monodromy grows like the inverse of the
   arc from there. If nothing follows, the branch ends, and says why. So it does where it comes
   back to itself.
5. A doubled branch begins at a period doubling, along the eigenvector v of the multiplier -1: the
   corrector works on the map of twice the cycles with w (u - u0) = eps, w being v less its part
   along the old tangent, so that the old branch is no solution. It ends right
   before the doubling, where both halves of its orbits become alike.

Sources: Keller 1977 (pseudo-arclength); Seydel 2010, chapters 4 to 7 (test functions, doubling);
di Bernardo et al. 2008, chapters 6 to 8 (grazing, sliding).
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.solver import path_units
from stickslip.errors import InputError, SimulationError, UnknownNameError
from stickslip.show.display import OnAxes, Summary, Tabular
from stickslip.show.formatting import number, quantity
from stickslip.study.energy import energy_balance
from stickslip.study.sweep.attractors import period_of
from stickslip.study.sweep.orbits import (
    CYCLE,
    ORBIT_TIMES,
    Orbit,
    ReturnMap,
    Shot,
    Signature,
    map_of,
    placed,
    refuse_cut,
    refuse_late,
    solved,
)
from stickslip.study.sweep.parameter_grid import Array, counted, runs_of
from stickslip.study.tolerances import ROUNDING

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Branch", "BranchEvent", "continue_orbit"]

Event: TypeAlias = "BranchEvent"
MOST_POINTS = 2000
"""Points of a branch to either side."""
FIRST_STEP, LEAST_STEP, MOST_STEP = 4e-3, 1e-7, 0.02
"""Length of a step, over the size of the states and the range of the parameter."""
DIAGRAM_STEP = 4e-6
"""The same of the many branches of a diagram: length below which a step that fails is given up."""
GROWTH, EASY, FAST = 1.5, 3, 3.0
"""By how much a step grows, after how many of Newton's steps at most, and after none."""
MOST_NEWTON = 6
"""Newton's steps of one correction."""
TURN: Final = 0.9
"""Least cosine between tangents of neighbours."""
WORSE, AGAIN = 2.0, 0.1
"""Residual over the last one, and distance from the last start but one over that from the last, at
which Newton's steps are given up."""
FALLS = 0.5
"""Residual over the last one at which Newton's steps are given up in a walk."""
ON_CURVE = 0.5
"""Largest correction over the step: what comes from farther is another branch."""
TURNS_BACK: Final = "; the branch turns back there (non-smooth fold)"
MOST_SECTIONS, MOST_FALSE = 40, 12
"""Orbits by which an event is located to the least step, some of them by false position."""
SHORT, COARSE = 1e-3, 0.05
"""Length of a step from which its predictor may be off the branch, and share of it to which is
located then where something changes along it."""
CLEAN, RESTART = 1e-4, 4e-4
"""Distance over which a branch is stepped without a gap, and first step behind."""
WINDOW, CREPT, SLOWED, FLICKERS, BORDER = 40, 1e-4, 1e-2, 6, 1e-5
"""Points in which a walk comes that far at least, over the largest scales; how far if it runs along
a border; and steps in a row of which not all may change what happens; distance, over the range,
of a border that a curve runs along."""
POLE = 0.9
"""Share of the arc in front of a pole of the derivative after which a step ends."""
BEHIND: Final = (1e-3, 4e-3)
"""Distances behind a change at which other branches are looked for."""
STRAYED = 100.0
"""Distance of the halves of an orbit, over that of its run, from which they are distinct."""
HALVED, SHRUNK = 1e-3, 0.02
"""Distance, over the size of the states, of the halves of an orbit at which a branch ends in a
doubling, and size of a cycle, over the largest one, at which it ends in steady sliding: of smaller
cycles derivatives tell no fold."""
NEARBY = 1e-7
"""Residual, over the size of the states, below which the last step needs no run of its own."""
OUTGROWN = 2.0
"""Size of a state over its scale, or the reverse, from which the scales are taken anew."""
FAR = 2.0
"""Longest step, over the last one, into which a polynomial through points is continued."""
ORDER, AHEAD, APART = 3, 0.5, 0.2
"""Points that it goes through at most, least cosine between their tangents and the last, and how
far apart they are at least, over the last step: of points too near each other it shows errors."""
BEND = 0.8
"""Share of the angle of `TURN` by which the tangent is meant to turn in a step."""
BESIDE, ALIKE, SAME = 0.05, 1e-3, 1e-6
"""Distance, over the chord of two neighbours, within which a point may be between them, within
which it is, and the same over the sizes of the states."""
TRUSTED = 1e-5
"""Residual from which a step with a derivative of its own may be the last."""
SLOW = 0.1
"""Share of the residual left by a step from which its derivative is taken anew."""
INSIDE = 0.618
"""Place in a range at which drives must fit a given cycle, too."""
AT_CIRCLE = 0.02
"""Distance from the unit circle within which a multiplier has passed it and not jumped across."""
OVER: Final = (1e-6, 4e-6, 1e-4, 1e-3, 4e-3)
"""Steps by which what stops the corrector is stepped over."""
WINDOWS: Final = (
    (0.25, "motions of longer periods follow one another (period adding)"),
    (2.0 / 3.0, "longer periods with chaos between them"),
    (1.0, "chaos at once"),
    (math.inf, "that orbit is unstable, too"),
)
"""What follows behind a hard stop that is touched, for largest multipliers below these bounds."""
OFF: Final = (0.01, 0.003, 0.03, 0.001, 3e-4, 1e-4, 3e-5)
"""Distances from a period doubling at which the doubled branch is sought."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BranchEvent:
    """What changes along a branch, and where.

    Parameters
    ----------
    kind : str
        ``"fold"``, ``"period doubling"``, ``"branch point"``, ``"torus"``, ``"grazing"``,
        ``"sticking"``, or ``"reversal"``.
    value : float
        Value of the parameter.
    index : int
        Number of the point of the branch before it.
    sentence : str
        What changes, in words.
    orbit : Orbit
        The orbit there.
    """

    kind: str
    value: float
    index: int
    sentence: str
    orbit: Orbit


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Branch(OnAxes, Tabular):
    """A branch of periodic orbits, point by point along its arc."""

    path: str
    """Full path of the parameter."""
    unit: str
    """Its SI unit."""
    cycles: int
    """Cycles of the drives, or passes of the section, after which the orbits close."""
    states: tuple[str, ...]
    """Free states (k,), as in `Orbit.free`; ``cycle`` in the place of the state of a section."""
    units: Mapping[str, str]
    """SI units of all states."""
    values: Array
    """The parameter (n,)."""
    starts: Array
    """Free states at time 0 (n, k), the length of a cycle [s] among them if it is unknown."""
    periods: Array
    """Length of the orbits (n,) [s]."""
    multipliers: NDArray[np.complex128]
    """Floquet multipliers (n, k), the largest first."""
    advances: Mapping[str, Array]
    """Advance in a period (n,) of each coordinate on which nothing depends, or that is carried."""
    events: tuple[BranchEvent, ...]
    """What changes along the branch."""
    ends: tuple[str, str]
    """Why it ends at its first and at its last point."""
    runs: int
    """Runs over a period that it took."""
    map: ReturnMap
    """The map whose fixed points it has."""

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether the orbit of each point is stable (n,)."""
        return np.asarray(np.abs(self.multipliers).max(axis=1, initial=0.0) < 1.0)

    @property
    def stretches(self) -> list[tuple[int, int, float, float]]:
        """Where orbits are stable: points from and up to, and values at which it begins and ends.

        Where an event is known at which stability changes, that is there, else at the last point.
        """
        result = []
        for begin, end in runs_of(self.stable).tolist():
            before = [event.value for event in self.events if event.index == begin - 1]
            after = [event.value for event in self.events if event.index == end - 1]
            first = before[-1] if before else float(self.values[begin])
            result.append((begin, end, first, after[0] if after else float(self.values[end - 1])))
        return result

    def mean_velocity(self, coordinate: str | None = None) -> Array:
        """Return advance over period (n,) [m/s] or [rad/s] of a coordinate, 0 if it comes back.

        If none is given, of the first that advances from cycle to cycle, or else of the first.

        Raises
        ------
        InputError
            If the mechanism has no such coordinate.
        """
        known = (*self.advances, *self.map.mechanism.coordinates)
        name = known[0] if coordinate is None else coordinate
        if name not in known:
            raise UnknownNameError("coordinate", name, self.map.mechanism.coordinates)
        return self.advances.get(name, np.zeros_like(self.periods)) / self.periods

    def energies(self, coordinate: str | None = None) -> dict[str, Array]:
        """Return mean powers (n,) [W] and energy per travel [J/m], as `EnergyBalance.columns` does.

        Each point is run anew over its period.

        Parameters
        ----------
        coordinate : str, optional
            Coordinate of the travel; the one along which contacts slip if not given.
        """
        rows = []
        for y, value in zip(self.starts, self.values.tolist(), strict=True):
            mechanism, law = self.map.pair(value)
            start = self.map.begin(mechanism, y)
            length = self.map.duration(mechanism, value, y)
            run = self.map.solver.run(mechanism, law, y0=start, t_end=length)
            rows.append(energy_balance(mechanism, run, coordinate=coordinate).columns())
        return {name: np.array([row[name] for row in rows]) for name in rows[0]}

    def orbit(self, index: int) -> Orbit:
        """Return the orbit of a point, solved for more exactly than the walk did."""
        y, value = self.starts[index], float(self.values[index])
        with suppress(SimulationError, InputError):
            return self.map.orbit(solved(self.map, y, value))
        return self.map.orbit(self.map.shoot(y, value))

    def orbits_at(self, value: float) -> tuple[Orbit, ...]:
        """Return the orbits that the branch has at a value of the parameter."""
        shots = list[Shot]()
        for guess in self.crossings(value):
            with suppress(SimulationError, InputError):
                shots.append(solved(self.map, guess, value))
        return tuple(map(self.map.orbit, shots))

    def crossings(self, value: float) -> Array:
        """Return the free states (m, k) at which the polygon of points crosses a value."""
        low, high = self.values[:-1], self.values[1:]
        at = np.flatnonzero((np.minimum(low, high) <= value) & (value <= np.maximum(low, high)))
        span = np.where(high[at] == low[at], 1.0, high[at] - low[at])
        share = ((value - low[at]) / span)[:, None]
        return self.starts[at] + share * (self.starts[at + 1] - self.starts[at])

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each point."""
        import pandas as pd

        columns: dict[str, object] = {self.path: self.values, "cycles": self.cycles}
        columns |= {"period": self.periods, "stable": self.stable}
        columns["largest multiplier"] = np.abs(self.multipliers).max(axis=1, initial=0.0)
        columns |= {name: self.starts[:, i] for i, name in enumerate(self.states)}
        columns |= {f"advance {name}": values for name, values in self.advances.items()}
        return pd.DataFrame(columns)

    def _summary(self) -> Summary:
        low, high = float(self.values.min()), float(self.values.max())
        rows = [(e.kind, quantity(e.value, self.unit, 6), e.sentence) for e in self.events]
        return Summary(
            sentence=f"Period {self.cycles}, {len(self.values)} orbits from"
            f" {number(low, 4)} to {quantity(high, self.unit, 4)},"
            f" {int(self.stable.sum())} of them stable.",
            head=("event", self.path.rpartition(".")[2], "what changes") if rows else (),
            rows=rows,
            notes=tuple(dict.fromkeys(self.ends)),
        )


def continue_orbit(
    orbit: Orbit,
    path: str,
    between: tuple[float, float],
    *,
    doubled: bool = False,
    step: float = MOST_STEP,
    points: int = MOST_POINTS,
    period: float | None = None,
) -> Branch:
    """Follow a periodic orbit over a parameter, along stable and unstable orbits.

    Parameters
    ----------
    orbit : Orbit
        Where the branch begins; followed to both sides.
    path : str
        What varies, as in `ensemble`; the orbit has a value of it in `between`.
    between : pair of float
        Least and largest value.
    doubled : bool
        Whether to leave, at an orbit with a multiplier at -1 (the `BranchEvent.orbit` of a period
        doubling), for the branch on which it closes after twice the cycles.
    step : float
        Largest step, over the size of the states and the range of the parameter.
    points : int
        Largest number of points to either side.
    period : float, optional
        Length of a cycle [s]; that of the drives if not given.

    Returns
    -------
    Branch
        Its orbits, their stability, and what changes along it.

    Raises
    ------
    InputError
        If an argument cannot be used.
    SimulationError
        If there is no doubled branch, or the orbit has no derivative.

    References
    ----------
    R. Seydel, Practical Bifurcation and Stability Analysis, Springer 2010, chapters 4 to 7.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> from stickslip.study.sweep import periodic_orbit
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=2.0))
    >>> orbit = periodic_orbit(axis, Coulomb(kinetic_coefficient=0.5))
    >>> branch = continue_orbit(orbit, "frequency", (1.9, 2.4))
    >>> bool(branch.stable.all()), branch.ends
    (True, ('It reaches 1.9 Hz.', 'It reaches 2.4 Hz.'))
    """
    low, high = between_of("continue_orbit", between)
    counted("continue_orbit", "points", points, 1)
    check_step("continue_orbit", step, LEAST_STEP)
    if orbit.controlled is not None:
        raise InputError(
            "continue_orbit: branches under delayed feedback are those without it, but for their"
            " multipliers, which are not followed: find the orbit of a mechanism without it."
        )
    full, value, unit = placed("continue_orbit", orbit, path, (low, high))
    map_ = map_of(orbit, orbit.cycles * (2 if doubled else 1), period, full)
    map_ = within(map_, (low, high))
    y = map_.unknowns_of(orbit)
    curve = Curve(map_, low, high, unit, step, int(points), LEAST_STEP)
    return curve.branch(
        curve.doubled(map_, orbit, y, value) if doubled else curve.point(solved(map_, y, value))
    )


def check_step(owner: str, step: float, least: float) -> None:
    """Refuse a largest step that is none."""
    if not least < step <= 1.0:
        raise InputError(f"{owner}: step must be above {least:g} and at most 1, got {step!r}.")


def between_of(owner: str, between: Any) -> tuple[float, float]:
    try:
        pair = np.asarray(between, dtype=np.float64).ravel()
    except (TypeError, ValueError):
        pair = np.empty(0)
    if pair.size != 2 or not np.isfinite(pair).all() or not pair[0] < pair[1]:
        raise InputError(
            f"{owner}: between must be two finite numbers, the lower one first, got {between!r}."
        )
    return float(pair[0]), float(pair[1])


def within(map_: ReturnMap, between: tuple[float, float]) -> ReturnMap:
    """Return a map in a range, which is refused if the parameter cannot have values of it."""
    low, high = between
    for value in (low, high, low + INSIDE * (high - low)):
        mechanism, _ = map_.pair(value)
        if map_.section is None:
            map_.duration(mechanism, value)
        refuse_late(mechanism)
        if map_.period is not None:  # which may fit at both ends by chance
            refuse_cut(mechanism, map_.cycles * map_.period)
    return replace(map_, between=between)


@dataclass(frozen=True)
class Point:
    """An orbit on the branch; of what needs derivatives nothing is worked out before it is used."""

    shot: Shot
    along: Array | None
    """Direction in which the tangent goes on; up in p if none is given."""
    scale: Array
    """Sizes of the states and of the range."""

    @property
    def signature(self) -> Signature:
        """What happens in a period."""
        return self.shot.signature

    @cached_property
    def unknowns(self) -> Array:
        """Scaled states and parameter (k + 1,)."""
        return np.array([*self.shot.y.tolist(), self.shot.value]) / self.scale

    @cached_property
    def slopes(self) -> Array:
        """dF/du (k, k + 1)."""
        result: Array = self.shot.jacobian * self.scale / self.scale[:-1, None]
        return result

    @cached_property
    def tangent(self) -> Array:
        """Null vector of dF/du (k + 1,); its part along what is lost to sticking is exactly 0."""
        result = np.asarray(np.linalg.svd(self.slopes)[2][-1], dtype=np.float64)
        result[:-1][self.shot.lost] = 0.0
        up = float(result[-1] if self.along is None else result @ self.along)
        return result / (_length(result) if up >= 0.0 else -_length(result))

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers (k,)."""
        return np.linalg.eigvals(self.shot.monodromy).astype(np.complex128)

    @cached_property
    def crossing(self) -> float:
        """det[dF/du; t]."""
        return float(np.linalg.det(np.concatenate((self.slopes, self.tangent[None]))))

    def off(self, y: Array) -> float:
        """Return how far free states are from the orbit, at any of its cycles, over its size."""
        return float((np.abs(self.shot.strobes - y) / self.shot.scale).max(axis=1).min())

    @cached_property
    def half(self) -> Array:
        """States after half the period less those at the start (k,)."""
        result: Array = self.shot.half / self.scale[:-1]
        return result


@dataclass(frozen=True)
class _Predictor:
    """Where a branch goes on: a polynomial through its last points with their tangents.

    It is a function of the part along the last tangent, in Newton's form.
    """

    here: Point
    """The last point."""
    places: Array
    """Where its terms vanish: each point twice, the last one first (k,)."""
    terms: Array
    """Divided differences (k, unknowns)."""
    reach: float
    """Arc up to which it is used; farther on, the tangent is."""

    @classmethod
    def of(cls, points: Sequence[Point]) -> Self:
        """Take the last points in which the same happens."""
        here = points[-1]
        along, u0 = here.tangent, here.unknowns
        ends = [(0.0, u0, along)]
        for point in points[:-1][:-ORDER:-1]:
            if point.signature != here.signature or point.scale is not here.scale:
                break
            s = float(along @ (point.unknowns - u0))
            turned = float(along @ point.tangent)
            if turned < AHEAD or s >= ends[-1][0] + APART * ends[min(1, len(ends) - 1)][0]:
                break
            ends.append((s, point.unknowns, point.tangent / turned))
        places = np.repeat([s for s, _, _ in ends], 2)
        column = np.repeat([u for _, u, _ in ends], 2, axis=0)
        terms = np.empty((len(places) - 1, len(u0)))
        for k in range(1, len(places)):
            widths = places[k:] - places[:-k]
            if k == 1:
                widths[::2] = 1.0
            column = np.diff(column, axis=0) / widths[:, None]
            if k == 1:  # of a point twice, the difference is its slope
                column[::2] = [slope for _, _, slope in ends]
            terms[k - 1] = column[0]
        terms[:, along == 0.0] = 0.0  # what is lost to sticking stays exact
        reach = -FAR * ends[1][0] if len(ends) > 1 else 0.0
        return cls(here, places[:-1], terms, reach)

    def __call__(self, ds: float) -> Array:
        """Return the unknowns at an arc."""
        u0 = self.here.unknowns
        if ds > self.reach:
            return u0 + ds * self.here.tangent
        result: Array = u0 + np.cumprod(ds - self.places) @ self.terms
        return result


@dataclass(frozen=True)
class _Part:
    """A part of a step."""

    low: float
    """Arc at which it begins."""
    high: float
    """Arc at which it ends."""
    a: Point
    """The orbit at its beginning."""
    b: Point
    """The orbit at its end."""


@dataclass(frozen=True)
class _Step:
    """A step of a walk."""

    there: Point
    """Where it leads."""
    length: float
    """Its arc."""
    count: int
    """How many of Newton's steps it took."""
    free: float
    """Arc behind it in which something stops a step."""


class Curve:
    """One branch: scales, corrector, events."""

    def __init__(
        self,
        map_: ReturnMap,
        low: float,
        high: float,
        unit: str,
        step: float,
        most: int,
        least: float,
    ) -> None:
        self.map, self.low, self.high, self.unit = map_, low, high, unit
        self.box = [(-1, low, high, unit)]
        self.tests, self.hops, self.smooth = TESTS, False, False
        self.accept: Callable[[Point], object] = _nothing
        self.beside: Callable[[Point], str] = _nothing  # what else changes right there
        self.step, self.most, self.least = step, most, least
        self.searching, self.widest = False, np.zeros(1)
        self.behind = [ds for ds in OVER if ds >= least]
        self.scale = np.ones(1)
        self.runs = 0
        self.backward = False
        self.known = np.empty((0, 0)), np.empty(0, int)
        self.trails: list[Array] = []
        self.halved: list[Shot] = []
        self.largest = np.zeros(len(map_.free))
        self.beyond: list[Shot] = []

    # -- unknowns

    def point(self, shot: Shot, along: Array | None = None) -> Point:
        """Return a point with its tangent, which goes on in a direction; up in p if none is given.

        The first point sets the scales; they follow as in `fit`.
        """
        if self.scale.size == 1:
            self.scale = np.append(shot.scale, self.high - self.low)
            self.widest = self.scale
        return Point(shot, along, self.scale)

    def fit(self, *points: Point) -> tuple[Point, ...]:
        """Return points in the scales of the last one, which are taken where its states outgrow."""
        size = np.append(points[-1].shot.scale, self.high - self.low)
        ratio, old = size / self.scale, self.scale
        if ratio.max() <= OUTGROWN and ratio.min() >= 1.0 / OUTGROWN:
            return points
        self.scale = size
        self.widest = np.maximum(self.widest, size)
        return tuple(self.point(point.shot, point.tangent * old / size) for point in points)

    def unscaled(self, shot: Shot) -> Array:
        """Return free states and parameter of an orbit (k + 1,)."""
        return np.array([*shot.y.tolist(), shot.value])

    def shoot(self, u: Array, most: float = np.inf) -> Shot:
        """Run from scaled unknowns; a residual of more than a size is a `SimulationError`."""
        bound = most * self.scale[:-1] if most < np.inf else None
        return self.map.shoot(*self.start_of(u), bound)

    def start_of(self, u: Array) -> tuple[Array, float]:
        """Return free states and parameter of a run that is about to be made, which is counted."""
        self.runs += 1
        *y, value = (u * self.scale).tolist()
        return np.array(y), value

    def correct(
        self,
        u0: Array,
        normal: Array,
        distance: float,
        start: Array | None = None,
        reach: float = np.inf,
        known: tuple[Point, ...] = (),
        shot: Shot | None = None,
    ) -> tuple[Shot, int] | None:
        """Return the orbit with normal (u - u0) = distance near there, and the steps it took.

        None if there is none, or if it has no derivative. The run from the start may be known.
        """
        u = u0 + distance * normal / float(normal @ normal) if start is None else start
        try:
            result = self.newton(u0, normal, distance, u, reach, known, shot)
            return result and (result[0].sensed(), result[1])
        except (SimulationError, InputError, np.linalg.LinAlgError):
            return None

    def newton(
        self,
        u0: Array,
        normal: Array,
        distance: float,
        u: Array,
        reach: float,
        known: tuple[Point, ...],
        first: Shot | None,
    ) -> tuple[Shot, int] | None:
        """Return the orbit near a start, and how many steps that took.

        None if Newton's steps do not converge, or lead farther than within reach. While they leave
        little, Broyden's rule mends the derivative. In a walk, where a point is known, it is taken
        anew from a residual that is trusted on, as the next point needs it: how it differs from
        that of the known point tells what the step from there leaves.
        """
        trusted = TRUSTED if known else 0.0
        begun, before, last = u, np.inf, np.inf
        tried, matrix, lost, kind = [u], np.empty(0), np.empty(0, bool), None
        for count in range(MOST_NEWTON + 1):
            shot = first or self.shoot(u, WORSE * before)
            first = None
            # what is left is judged by the size of the states in this orbit, as by `solved`
            if shot.error <= self.map.tolerance:
                return shot, count
            if count == MOST_NEWTON:
                return None
            if trusted and shot.error > FALLS * last:
                return None
            residual = shot.residual / self.scale[:-1]
            lack = np.array([*residual.tolist(), float(normal @ (u - u0)) - distance])
            near = next((p for p in known if p.signature == shot.signature), None)
            point = None
            if shot.signature != kind or shot.error > SLOW * last or shot.error <= trusted:
                point = self.point(shot)
                known = (point, *known)
            if point is None:
                step = u - tried[-2]
                matrix = matrix + np.outer(lack, step) / float(step @ step)
            else:
                matrix, lost = np.concatenate((point.slopes, normal[None])), point.shot.lost
                kind = shot.signature
            u = u - np.linalg.solve(matrix, lack)
            y = np.where(lost, shot.y + shot.residual, u[:-1] * self.scale[:-1])
            u[:-1] = y / self.scale[:-1]
            if point is not None and near is not None and shot.error <= trusted:
                bend = _length((point.slopes - near.slopes).ravel())
                bend /= _length(point.unknowns - near.unknowns)
                left = 0.5 * bend * _length(u - tried[-1]) ** 2
                if left <= ROUNDING:
                    return self.map.nearby(shot, y, float(u[-1] * self.scale[-1])), count
            # the next step leaves no larger a share than the last, what its run would show is known
            follows = shot.error * shot.error / last if count else np.inf
            if shot.error <= NEARBY and follows <= self.map.tolerance:
                return self.map.nearby(shot, y, float(u[-1] * self.scale[-1])), count
            # on either side of a border Newton's step may lead to the other one, for ever
            if count and _length(u - tried[-2]) <= AGAIN * _length(u - tried[-1]):
                return None
            if _length(u - begun) > reach:
                return None
            tried.append(u)
            before, last = float(np.abs(residual).max(initial=0.0)), shot.error
        return None

    # -- the walk

    def both(self, first: Point) -> tuple[list[Point], list[Event], tuple[str, str]]:
        """Follow a branch to both sides of a point; return why it ends, too."""
        self.backward = True  # events are told in the order of the points
        turned = replace(first, along=-first.tangent)
        scale = self.scale  # that of the tangent; a walk goes on to others
        back, begun, before = self.walk(turned)
        self.backward, self.scale = False, scale
        ahead, ended, after = self.walk(first)
        points = [*back[:0:-1], *ahead]
        offset = len(back) - 1
        events = [replace(e, index=offset - 1 - e.index) for e in reversed(before)]
        events += [replace(e, index=offset + e.index) for e in after]
        return points, events, (begun, ended)

    def branch(self, first: Point) -> Branch:
        """Follow a branch to both sides of a point."""
        points, events, ends = self.both(first)
        shots = [point.shot for point in points]
        advances = [self.map.advances(shot) for shot in shots]
        return Branch(
            path=str(self.map.path),
            unit=self.unit,
            cycles=self.map.cycles,
            states=self.map.unknowns,
            units=units_of(self.map),
            values=np.array([shot.value for shot in shots]),
            starts=np.array([shot.y for shot in shots]),
            periods=np.array([shot.period for shot in shots]),
            multipliers=multipliers_of(points),
            advances={q: np.array([own[q] for own in advances]) for q in advances[0]},
            events=tuple(events),
            ends=ends,
            runs=self.runs,
            map=self.map,
        )  # fmt: skip

    def walk(self, first: Point) -> tuple[list[Point], str, list[Event]]:
        """Follow a branch in the direction of a point's tangent; return why it ends, and events."""
        (first,) = self.fit(first)
        self.accept(first)
        points, events, ds, held = [first], list[Event](), min(FIRST_STEP, self.step), False
        self.trails.append(self.unscaled(first.shot)[None])
        while len(points) <= self.most:
            here = points[-1]
            u0 = here.unknowns
            step = self.stepped(points, u0, ds)
            if isinstance(step, float):
                ds, held = step, True
                if ds > self.least:
                    continue
                there = self.over(here)
                if there is None:
                    kind, reason = self.reason(here)
                    if kind:
                        sentence = "the branch ends there"
                        events.append(self.event(kind, here, len(points) - 1, sentence))
                    return points, reason, events
                self.look_behind(here)
                gap = _length(there.unknowns - u0)
                ds = RESTART if gap < CLEAN else 0.1 * gap
            else:
                there = step.there
            if (vanishing := self.vanishing(here, there)) is not None:
                length = 0.0 if isinstance(step, float) else step.length
                return self.last(points, there, length, events, *vanishing)
            if here.signature != there.signature:
                events.append(self.turned(here, there, len(points) - 1))
            else:
                arc = float(here.tangent @ (there.unknowns - u0))
                events += self.between(here, there, u0, arc, len(points) - 1)
            if (end := self.limit(here, there)) is not None:
                return self.cut(points, there, end, events)
            points.append(there)
            self.accept(there)
            if ended := self.ended(first, points):
                return [*points[:-1], *self.before_known(here, there)], ended, events
            self.trails[-1] = np.append(self.trails[-1], self.unscaled(there.shot)[None], axis=0)
            if ended := self.stalled(points):
                return points, ended, [e for e in events if e.index < len(points) - 1]
            if not isinstance(step, float):
                growth = FAST if step.count == 0 else GROWTH if step.count <= EASY else 1.0
                ds = min(step.length * (1.0 if held else growth), self.step, step.free)
            short, held = self.short_of_pole(points), False
            ds = min(ds, self.straight(points), short if short < SHORT else ds)
            first, *points[-2:] = self.fit(first, *points[-2:])
        return points, f"It was followed for {self.most} points; give more to go on.", events

    def look_behind(self, here: Point) -> None:
        """Note orbits behind a change, perhaps of other branches, if a search asks for them."""
        for far in BEHIND if self.searching else ():
            result = self.correct(here.unknowns, here.tangent, far, reach=far)
            self.beyond += [] if result is None else [result[0]]

    def stalled(self, points: list[Point]) -> str:
        """Return why a walk goes on no more, where it comes no farther in many steps; else nothing.

        So it is where the body comes to rest, and its states become 0, where what happens changes
        with every step, or where a curve runs along a border of what happens, which is cut there.
        """
        last = [point.signature for point in points[-FLICKERS - 1 :]]
        if len(last) > FLICKERS and all(a != b for a, b in itertools.pairwise(last)):
            self.beyond.clear()
            why = "what happens in a period changes with every step"
        elif (
            len(points) >= WINDOW
            and self.crept < (SLOWED if self.smooth else CREPT)
            and (near := self.beside(points[-1]))
        ):
            if self.smooth:  # how far along it a walk comes depends on where its steps began
                while len(points) > 1 and self.beside(points[-2]):
                    points.pop()
            why = self.beside(points[-1]) or near
        elif len(points) >= WINDOW and self.crept < CREPT:
            why = "the steps become too short"
        else:
            return ""
        return f"It ends at {quantity(points[-1].shot.value, self.unit, 6)}: {why}."

    @property
    def crept(self) -> float:
        """Arc of the last steps of a walk, over the largest scales."""
        scale = np.maximum(self.widest, self.scale)
        chords = np.diff(self.trails[-1][-WINDOW:], axis=0) / scale
        return float(np.linalg.norm(chords, axis=1).sum())

    def stepped(self, points: list[Point], u0: Array, ds: float) -> _Step | float:
        """Return a step in which nothing changes of what happens, or how long one may be.

        What changes, and where, is seen by runs along the predictor, without derivatives.
        """
        here, free, ahead = points[-1], np.inf, _Predictor.of(points)
        shot = self.alike(here, ahead(ds))
        if shot is None and self.hops:
            # a border may run so near that the predictor is beyond it, and the curve is not
            result = self.correct(u0, here.tangent, ds, ahead(ds), ds)
            there = result and self.point(result[0], here.tangent)
            if result and there and self.is_next(here, there, u0, ds):
                return _Step(there, ds, result[1], free)
        if shot is None:
            ds, free = self.clear(here, ahead, ds)
            if ds == 0.0:
                return ds
        result = self.correct(u0, here.tangent, ds, ahead(ds), ds, (here,), shot)
        there = result and self.point(result[0], here.tangent)
        if not result or not there or not self.is_next(here, there, u0, ds):
            return min(0.5 * ds, self.short_of_pole(points))
        return _Step(there, ds, result[1], free)

    def alike(self, here: Point, start: Array) -> Shot | None:
        """Return the run from a start, if the same happens in it as at a point."""
        with suppress(SimulationError, InputError):
            shot = self.shoot(start)
            if shot.signature == here.signature:
                return shot
        return None

    def is_alike(self, here: Point, start: Array) -> bool:
        """Whether the same happens in the run from a start, of which nothing else is asked."""
        with suppress(SimulationError, InputError):
            return self.map.happens(*self.start_of(start)) == here.signature
        return False

    def clear(self, here: Point, ahead: _Predictor, ds: float) -> tuple[float, float]:
        """Return up to where on the predictor the same happens still, and the arc to where not.

        A long predictor is off the branch by more than a short arc.
        """
        low, high = 0.0, ds
        # a fold may lie in front of a change that is nearer than that: not over both at once
        while high - low > (self.least if ds <= SHORT or low == 0.0 else COARSE * ds):
            middle = 0.5 * (low + high)
            same = self.is_alike(here, ahead(middle))
            low, high = (middle, high) if same else (low, middle)
        return low, high - low

    def short_of_pole(self, points: list[Point]) -> float:
        """Return a step that ends in front of where the derivative grows without bound, if it does.

        Behind a grazing contact it grows like the inverse of the arc from there.
        """
        if len(points) < 2 or points[-2].signature != points[-1].signature:
            return np.inf
        before, here = points[-2:]
        ratio = _length(before.slopes.ravel()) / _length(here.slopes.ravel())
        length = _length(here.unknowns - before.unknowns)
        return POLE * length * ratio / (1.0 - ratio) if ratio < 1.0 else np.inf

    def ended(self, first: Point, points: list[Point]) -> str:
        """Return why a branch need not be followed beyond its last point; else nothing."""
        here, there = points[-2:]
        if self.closes_sooner(there):
            self.beyond.append(there.shot)
            what = "It ends at {}: orbits close after fewer cycles there."
        elif (known := self.met(there)) is not None:
            what = f"It meets branch {known} at {{}}."
        elif len(points) > 3 and self.closes(first, here, there):
            what = "It closes."
        elif self.returns(there):
            what = "It returns to itself at {}."
        else:
            return ""
        return what.format(quantity(there.shot.value, self.unit, 6))

    def returns(self, there: Point) -> bool:
        """Whether a point is on the branch already."""
        return any(self.chord(there, trail) is not None for trail in self.trails)

    def closes_sooner(self, there: Point) -> bool:
        """Whether an orbit is the same at an earlier cycle: it is one of a branch of fewer."""
        shot = there.shot
        for _ in range(2 if len(shot.strobes) > 1 else 0):
            off = np.abs(shot.strobes[1:] - shot.y) / shot.scale
            if shot.off.any():  # later cycles are those of the run, which is another by that
                if off.max(axis=1).min() > HALVED:
                    return False
                shot = self.map.shoot(shot.y, shot.value)
            else:
                return bool(off.max(axis=1).min() <= SAME)
        return False

    def met(self, there: Point) -> int | None:
        """Return the number of the branch that is known on which a point lies, if any."""
        trail, numbers = self.known
        # a point of the trail itself lies on both chords there, or by rounding on none
        at = self.chord(there, trail, SAME)
        return None if at is None else int(numbers[at])

    def is_next(self, here: Point, there: Point, u0: Array, ds: float) -> bool:
        """Whether a corrected point lies on the same branch, near enough."""
        off = there.unknowns - u0 - ds * here.tangent
        if _length(off) > ON_CURVE * ds or here.signature != there.signature:
            return False
        if ds < FIRST_STEP**2:
            return True
        signs = here.crossing, there.crossing
        if signs[0] * signs[1] < 0.0 and min(map(abs, signs)) > NEARBY:
            # a branch point is passed smoothly, near the mean of both tangents; a sharp fold not
            gap = off - 0.5 * ds * (there.tangent - here.tangent)
            if _length(gap) > max(0.1 * _length(off), ROUNDING):
                return False
        return float(there.tangent @ here.tangent) > TURN

    def extent(self, point: Point) -> float:
        """Return the size of a cycle of unknown length over the largest one on the branch."""
        map_, shot = self.map, point.shot
        times = np.linspace(0.0, shot.run.differentiate.t_end, ORBIT_TIMES)
        size = np.ptp(map_.seen(shot.mechanism, shot.run, times)[:, list(map_.free)], axis=0)
        self.largest = np.maximum(self.largest, size)
        return float((size[size > 0.0] / self.largest[size > 0.0]).max(initial=0.0))

    def vanishing(
        self, here: Point, there: Point
    ) -> tuple[Callable[[Point], float], float, list[Shot], str] | None:
        """Return what becomes 0 in a step or right behind it, if anything does.

        That is its size in an orbit, the least one that is followed, a list for the orbit there,
        and what it means.
        """
        if self.map.cycles % 2 == 0 and _halves_meet(here, there):
            along = here.half / _length(here.half)
            what = f"in a doubling of period {self.map.cycles // 2}"
            return lambda point: float(point.half @ along), HALVED, self.halved, what
        if self.map.section is not None and self.extent(there) < SHRUNK:
            return self.extent, SHRUNK, [], "as the cycle shrinks to steady sliding"
        return None

    def last(
        self,
        points: list[Point],
        there: Point,
        ds: float,
        events: list[Event],
        size: Callable[[Point], float],
        least: float,
        kept: list[Shot],
        what: str,
    ) -> tuple[list[Point], str, list[Event]]:
        """End a branch right before an orbit in which a size becomes 0.

        That is how far apart both halves are of one of twice the period, or how large a cycle is.
        Behind are the same orbits, begun elsewhere. The size is smooth along the arc, and the
        parameter nearly its square, so that what is left of the branch is too short for anything
        to happen in it. The step is 0 where that orbit was stepped over.
        """
        here = last = points[-1]
        u0 = here.unknowns
        if ds > 0.0 and size(here) > least:
            _, last = self.located(
                _Part(0.0, ds, here, there), u0, here.tangent,
                lambda p: size(p) - least, 0.5 * least,
            )  # fmt: skip
        if last is not here:
            arc = float(here.tangent @ (last.unknowns - u0))
            events += self.between(here, last, u0, arc, len(points) - 1)
            if (end := self.limit(here, last)) is not None:
                return self.cut(points, last, end, events)
            points.append(last)
        kept.append(last.shot)
        return points, f"It ends at {quantity(last.shot.value, self.unit, 4)} {what}.", events

    def limit(self, here: Point, there: Point) -> tuple[float, int, float, str] | None:
        """Return what end of a range a step leaves behind, from within or from it, if any.

        That is the share of the step, the place among the unknowns, the end and its unit.
        """
        a, b = self.unscaled(here.shot), self.unscaled(there.shot)
        left = [
            ((edge - a[i]) / (b[i] - a[i]), i, edge, unit)
            for i, low, high, unit in self.box
            for edge, side in ((low, 1.0), (high, -1.0))
            if side * b[i] < side * edge <= side * a[i]
        ]
        return min(left, default=None)

    def cut(
        self,
        points: list[Point],
        there: Point,
        end: tuple[float, int, float, str],
        events: list[Event],
    ) -> tuple[list[Point], str, list[Event]]:
        """End a branch right at the end of a range."""
        here, (share, i, edge, unit) = points[-1], end
        if share > 0.0:  # else the last point stands right there
            u0, chord = here.unknowns, there.unknowns - here.unknowns
            across = np.eye(len(u0))[i]
            result = self.correct(u0, across, edge / self.scale[i] - u0[i], u0 + share * chord)
            if result is not None:
                with suppress(SimulationError, InputError):
                    value = edge if i == -1 else result[0].value
                    shot = self.map.shoot(result[0].y, value).sensed()
                    points.append(self.point(shot, there.tangent))
        inside = [e for e in events if self.low <= e.value <= self.high]
        return points, f"It reaches {quantity(edge, unit, 6)}.", inside

    def closes(self, first: Point, here: Point, there: Point) -> bool:
        """Whether a step passes the first point: the branch is a closed curve."""
        a, b = here.unknowns, there.unknowns
        start, chord = first.unknowns, b - a
        share = float((start - a) @ chord) / float(chord @ chord)
        gap = _length(start - a - share * chord)
        along = float(first.tangent @ there.tangent) > TURN
        return along and 0.0 < share <= 1.0 and gap < BESIDE * _length(chord)

    def is_new(self, there: Point) -> bool:
        """Whether a point is on no branch that is known, nor on this one, nor of fewer cycles."""
        known = self.closes_sooner(there) or self.met(there) is not None
        return not (known or self.returns(there))

    def before_known(self, here: Point, there: Point) -> list[Point]:
        """Return the last point of a step that is on no branch yet, if there is one behind here."""
        u0, normal = here.unknowns, here.tangent
        part = _Part(0.0, float(normal @ (there.unknowns - u0)), here, there)
        _, last = self.located(
            part, u0, normal, lambda p: 1.0 if p is here or self.is_new(p) else -1.0
        )
        return [] if last is here else [last]

    def chord(self, there: Point, trail: Array, slack: float = 0.0) -> int | None:
        """Return between which of neighbours on a trail a point lies, in either direction, if any.

        Or beyond one of them by no more than a slack.

        Begun at any of its cycles: half a period later an orbit of two is the same. So it lies
        where a branch that was stepped over at grazing comes back on another way. What is near is
        solved for in the plane across the chord: another part of the branch differs there.
        """
        value = there.shot.value
        # by far the most chords lie at other values of the parameter
        ends = trail[:, -1:].ravel()
        a, b = ends[:-1], ends[1:]
        wide = BESIDE * MOST_STEP * (self.high - self.low)
        off = np.abs(value - 0.5 * (a + b))
        at = np.flatnonzero(off <= (0.5 + BESIDE) * np.abs(b - a) + wide)
        if not len(at):
            return None
        begins = trail[at] / self.scale
        chords = trail[at + 1] / self.scale - begins
        sizes = np.maximum(np.linalg.norm(chords, axis=1), LEAST_STEP**2)
        chords /= sizes[:, None]
        for start in there.shot.strobes:
            u = np.append(start, value) / self.scale
            along = ((u - begins) * chords).sum(axis=1)
            places = begins + along[:, None] * chords
            near = np.linalg.norm(u - places, axis=1) < BESIDE * sizes
            for i in np.flatnonzero(near & (along > -slack) & (along <= sizes + slack)):
                result = self.correct(u, chords[i], 0.0, places[i])
                point = result and self.point(result[0])
                if not point or _length(point.unknowns - u) > max(ALIKE * sizes[i], SAME):
                    continue
                # along another direction it crosses, but where a body rests in any of many places
                if abs(float(point.tangent @ chords[i])) > TURN or abs(point.crossing) < NEARBY:
                    return int(at[i])
        return None

    def amid(self, part: _Part, share: float) -> Array:
        """Return what is at a share of a part, by a cubic."""
        a, b = part.a.unknowns, part.b.unknowns
        h, rest = _length(b - a), 1.0 - share
        bends = (h * part.a.tangent - (b - a)) * rest - (h * part.b.tangent - (b - a)) * share
        result: Array = a + share * (b - a) + share * rest * bends
        return result

    def straight(self, points: list[Point]) -> float:
        """Return the step in which the tangent turns as far as it is meant to, as in the last."""
        before, here = points[-2:]
        if before.signature != here.signature:
            return self.step
        angle = float(np.arccos(np.clip(before.tangent @ here.tangent, -1.0, 1.0)))
        length = _length(here.unknowns - before.unknowns)
        return BEND * float(np.arccos(TURN)) / max(angle, LEAST_STEP) * length

    def over(self, here: Point) -> Point | None:
        """Return a point behind what stops the corrector, on whichever side the branch goes on.

        In the plane across the null vector behind it, which need not be near the tangent before.
        """
        result = next(filter(None, (self.across(here, ds) for ds in self.behind)), None)
        return result or next(filter(None, (self.through(here, arc) for arc in BEHIND)), None)

    def through(self, here: Point, arc: float) -> Point | None:
        """Return a point behind a hard stop that is touched, by the normal form of the map there.

        Right behind, the residual is that of an orbit without impact, and b v with the speed
        v = (k d)^(1/2) of the impact and its depth d along a direction e. The derivative grows by
        b e' dv/dd, of rank one, which tells b and e; a run tells k. To first order d = 0, and the
        branch goes on along du, F_u du = -b v, e' du = 0: the start has that, and the depth of v.
        """
        u0 = here.unknowns
        for ds in self.behind:
            with suppress(SimulationError, InputError, np.linalg.LinAlgError):
                far = self.point(self.shoot(u0 + ds * here.tangent))
                if far.signature == here.signature:
                    continue
                if not hits(here, far):
                    return None
                left, _, right = np.linalg.svd(far.slopes - here.slopes)
                b, e = left[:, 0], right[0] * np.sign(right[0] @ here.tangent)
                b = b * np.sign(b @ far.shot.residual)
                speed = _length(far.shot.residual / self.scale[:-1])
                du = np.linalg.solve(np.vstack([here.slopes, e]), np.append(-b, 0.0))
                depth = (arc / _length(du) / speed) ** 2 * ds * float(e @ here.tangent)
                along = du / _length(du)
                result = self.correct(u0, along, arc, u0 + arc * along + depth * e, MOST_STEP)
                point = result and self.point(result[0], along)
                return point if point and point.signature == far.signature else None
        return None

    def across(self, here: Point, ds: float) -> Point | None:
        """Return a point at which something else happens, from a start behind the last one.

        Or the same again: where an event passes the beginning of the cycle, it comes twice in a run
        that does not close, or not at all.
        """
        u0 = here.unknowns
        start = u0 + ds * here.tangent
        with suppress(SimulationError, InputError):
            guess = self.shoot(start)
            if guess.signature == here.signature:
                return None
            null = self.point(guess.sensed()).tangent
            alike = abs(float(null @ here.tangent)) > TURN
            for normal in (null,) if alike else (null, here.tangent):
                result = self.correct(u0, normal, float(normal @ (start - u0)), start, MOST_STEP)
                if result is None:
                    continue
                off = self.point(result[0]).unknowns - u0
                point = self.point(result[0], off)
                ahead = float(here.tangent @ off) >= 0.5 * ds
                if (point.signature != here.signature or ahead) and _length(off) < MOST_STEP:
                    return point
        return None

    def turned(self, here: Point, there: Point, index: int) -> Event:
        """Return the event across which the branch was stepped over."""
        kind, sentence = self.change(here, there)
        back = here.tangent[-1] * there.tangent[-1] < 0.0
        wide = _length(there.unknowns - here.unknowns) > CLEAN
        passed = "; passed by its square root" if hits(here, there) else "; stepped over"
        more = TURNS_BACK if back else passed if wide else ""
        more += self.survives(here, there) if hits(here, there) or touches(here, there) else ""
        return self.event(kind, here, index, sentence + more + self.jump(here, there))

    def survives(self, here: Point, there: Point | None) -> str:
        """Return what is stable behind a stop that is touched: by eigenvalues, and by a run.

        Of the map without impact. At a hard stop the largest one decides where all are real and
        positive (Nordmark 1997; Chin, Ott, Nusse and Grebogi 1994). At a soft one the map differs
        by the 3/2 power of the depth (di Bernardo et al. 2008, chapter 7), and linearly if its
        damper acts on the way in alone: then multipliers jump, and those behind tell.
        """
        if self.searching or self.hops or self.map.section is not None:
            return ""
        met = None if there is None or hits(here, there) else max(here, there, key=_meetings)
        count = _meetings if met else _impacts
        free = min(filter(None, (here, there)), key=count)
        values = free.multipliers
        largest = float(np.abs(values).max(initial=0.0))
        text = f"; largest multiplier without {'contact' if met else 'impact'} {number(largest, 2)}"
        if met:
            behind = float(np.abs(met.multipliers).max(initial=0.0))
            text += f", with it {number(behind, 2)}: {'' if behind < 1.0 else 'un'}stable behind"
        else:
            real = bool((np.abs(values.imag) < ROUNDING).all() and (values.real > -ROUNDING).all())
            rule = next(words for bound, words in WINDOWS if largest < bound)
            text += f": {rule if real else 'no rule for complex or negative ones'}"
        if met:
            value = met.shot.value
        else:  # to the side on which the orbit without impact is none any more
            ahead = float(free.tangent[-1]) * (1.0 if free is here else -1.0)
            value = free.shot.value + math.copysign(BEHIND[0] * (self.high - self.low), ahead)
        with suppress(SimulationError, InputError):
            y, states, settle, longest = free.shot.y, [], 300, 12
            for k in range(settle + 2 * longest):
                self.runs += 1
                y = y + self.map.shoot(y, value).residual
                states += [y] if k >= settle else []
            closes = period_of(np.array(states), free.shot.scale, SAME)
            turns = closes * self.map.cycles
            ends = f"closes after {turns} cycle{'s' * (turns > 1)}" if closes else "does not close"
            begun, ended = (met.off(x) if met else 0.0 for x in (free.shot.y, y))
            other = "ends in another motion, which " if ended > max(begun, SAME) else ""
            text += f"; a run behind {other}{ends}"
        return text

    def reason(self, here: Point) -> tuple[str, str]:
        """Return why a branch cannot be followed any farther: the kind of event, if any, in words.

        What happens in a run right behind the last point is what stops it.
        """
        u0 = here.unknowns
        at, lack = f"It ends at {quantity(here.shot.value, self.unit, 6)}", ""
        for ds in self.behind:
            try:
                ahead = self.shoot(u0 + ds * here.tangent).sensed()
            except (SimulationError, InputError) as error:
                lack = lack or f"behind, a run ends early or has no derivative: {error}"
                continue
            after = ahead.signature
            if after == here.signature:
                continue
            kind, sentence = change_of(here.signature, after)
            if kind != "grazing" or _impacts(ahead) == _impacts(here):
                return kind, f"{at}: {sentence}, and no orbit like it follows."
            large = float(np.abs(np.linalg.eigvals(ahead.monodromy)).max(initial=0.0))
            return kind, (
                f"{at} in grazing: {sentence}. The saltation factor of a grazing contact is"
                f" infinite: right behind, the largest multiplier is {number(large, 2)}"
                f"{self.survives(here, None)}."
            )
        lacks = "; ".join(filter(None, (self.beside(here), lack.rstrip("."))))
        return "", f"{at}: {lacks or 'the corrector does not converge'}."

    # -- events

    def event(self, kind: str, point: Point, index: int, sentence: str) -> Event:
        """Return an event, with the orbit there run again if it is only near a run."""
        shot = point.shot
        if shot.off.any():
            with suppress(SimulationError, InputError):  # beside a border the run may be another
                again = self.map.shoot(shot.y, shot.value).sensed()
                self.runs += 1
                if again.signature == point.signature:
                    shot = again
        return BranchEvent(
            kind=kind, value=shot.value, index=index, sentence=sentence, orbit=self.map.orbit(shot)
        )

    def jump(self, here: Point, there: Point) -> str:
        """Return what a change does to stability, in words."""
        pair = (there, here) if self.backward else (here, there)
        before, after = (bool(np.all(np.abs(p.multipliers) < 1.0)) for p in pair)
        if before == after:
            return ""
        return f"; {'unstable' if before else 'stable'} from there on"

    def change(self, here: Point, there: Point) -> tuple[str, str]:
        """Return the kind of a change of what happens, and the sentence in the order of points."""
        pair = (there, here) if self.backward else (here, there)
        return change_of(pair[0].signature, pair[1].signature)

    def between(self, here: Point, there: Point, u0: Array, ds: float, index: int) -> list[Event]:
        """Return the events in a step in which the same happens, each located."""
        result: list[tuple[float, Event]] = []
        step = _Part(0.0, ds, here, there)
        for kind, sentence, test in self.tests:
            ends = test(here), test(there)
            if ends[0] * ends[1] < 0.0:
                least = ROUNDING * max(map(abs, ends))
                s, point = self.located(step, u0, here.tangent, test, least)
                result.append((s, self.event(kind, point, index, sentence)))
        crossed = {event.kind for _, event in result}
        if {"fold", "branch point"} <= crossed:  # seen from the branch that begins there
            result = [pair for pair in result if pair[1].kind != "fold"]
        near_torus = self.torus(step, u0, here.tangent) if self.tests is TESTS else None
        if near_torus is not None:
            s, a = near_torus
            result.append((s, self.event("torus", a, index, "a complex pair passes the circle")))
        return [event for _, event in sorted(result, key=lambda pair: pair[0])]

    def torus(self, part: _Part, u0: Array, normal: Array) -> tuple[float, Point] | None:
        """Return where a complex pair of multipliers passes the unit circle, if it does."""
        before, after = _pair_outside(part.a), _pair_outside(part.b)
        if before is None or after is None or before == after:
            return None
        arc, near = self.located(
            part, u0, normal, lambda p: 1.0 if _pair_outside(p) == before else -1.0
        )
        off = min(abs(abs(x) - 1.0) for x in near.multipliers)
        return (arc, near) if off < AT_CIRCLE else None

    def located(
        self,
        part: _Part,
        u0: Array,
        normal: Array,
        test: Callable[[Point], float],
        least: float | None = None,
    ) -> tuple[float, Point]:
        """Return where a test function changes its sign: the arc, and the orbit right before.

        One that is smooth, and for which a least value counts as 0, by the rule of false position,
        whose kept end counts half (Illinois); any other by bisection.
        """
        low, high, a, b = part.low, part.high, part.a, part.b
        first, last, side = test(a), test(b), 0
        for count in range(MOST_SECTIONS):
            if high - low <= self.least:
                break
            share = 0.5 if least is None or count >= MOST_FALSE else first / (first - last)
            middle = low + share * (high - low)
            result = self.correct(u0, normal, middle, self.amid(_Part(low, high, a, b), share))
            result = result or self.correct(u0, normal, middle)
            if result is None:
                break
            point = self.point(result[0], normal)
            value = test(point)
            if least is not None and abs(value) <= least:
                return middle, point
            if value * first > 0.0:
                low, a, first, last = middle, point, value, last * (0.5 if side < 0 else 1.0)
                side = -1
            else:
                high, b, last, first = middle, point, value, first * (0.5 if side > 0 else 1.0)
                side = 1
        return low, a

    # -- doubled branches

    def doubled(self, map_: ReturnMap, orbit: Orbit, y: Array, value: float) -> Point:
        """Return a point of the branch of a map that leaves at a period doubling."""
        values, vectors = np.linalg.eig(orbit.monodromy)
        nearest = int(np.argmin(np.abs(values + 1.0)))
        if abs(values[nearest] + 1.0) > AT_CIRCLE:
            raise InputError(
                "continue_orbit: doubled=True needs an orbit with a multiplier at -1, such as the"
                " `orbit` of a period doubling among a branch's events; the nearest multiplier is"
                f" {number(float(values[nearest].real), 3)}."
            )
        base = replace(map_, cycles=orbit.cycles)
        shot = base.shoot(y, value)
        self.scale = np.append(shot.scale, self.high - self.low)
        old = self.point(shot).tangent
        v = vectors[:, nearest].real
        if base.section is not None:
            v = np.insert(v, base.slot, 0.0)
        v = np.append(v / shot.scale, 0.0)
        v -= float(v @ old) * old
        v /= _length(v)
        u0 = self.point(shot).unknowns
        for off in OFF:
            result = self.correct(u0, v, off, reach=10.0 * off)
            if result is None:
                continue
            try:
                half = base.shoot(result[0].y, result[0].value)
            except (SimulationError, InputError):
                continue
            if half.error > 100.0 * self.map.tolerance:
                return self.point(result[0])
        raise SimulationError(
            f"no branch of period {self.map.cycles} leaves at"
            f" {quantity(value, self.unit, 6)}: what is near there closes after {orbit.cycles}."
        )


def _nothing(_: Point) -> str:
    """Say nothing of a point."""
    return ""


def multipliers_of(points: Sequence[Point]) -> NDArray[np.complex128]:
    """Return the multipliers (n, m) of orbits, the largest of each first."""
    result = np.array([point.multipliers for point in points])
    order = np.argsort(-np.abs(result), axis=1, kind="stable")
    return np.take_along_axis(result, order, axis=1)


def units_of(map_: ReturnMap) -> dict[str, str]:
    """Return the SI units of all states."""
    known = path_units(map_.mechanism, map_.law)
    result = {name: known.get(f"initial.{name}", "1") for name in map_.states}
    return result | ({CYCLE: "s"} if map_.section else {})


def _halves_meet(here: Point, there: Point) -> bool:
    """Whether the two halves of an orbit become alike in a step, as they do in a doubling."""
    far = _length(here.half)
    missed = max(_length(point.shot.off[:-1] / point.scale[:-1]) for point in (here, there))
    if far <= max(NEARBY, STRAYED * missed):
        return False
    # one step may end right before the doubling, and the next one be too near to tell
    return float(here.half @ there.half) / far < min(HALVED, 0.5 * far)


def _impacts(point: Point | Shot) -> int:
    """Return how often hard stops are hit in a period."""
    return sum(n for _, what, n in point.signature if what.endswith("hits stop"))


def _meetings(point: Point) -> int:
    """Return how often soft stops are met in a period."""
    kinds = ((what, n) for _, what, n in point.signature)
    return sum(n for what, n in kinds if "meets" in what and what.endswith("soft stop"))


def hits(here: Point, there: Point) -> bool:
    """Whether a hard stop is hit more often in the one than in the other."""
    return _impacts(here) != _impacts(there)


def touches(here: Point, there: Point) -> bool:
    """Whether a soft stop is met more often in the one, where nothing else is different."""
    kinds = {what for _, what, _ in {*here.signature} ^ {*there.signature}}
    return _meetings(here) != _meetings(there) and all("soft stop" in x for x in kinds)


def _length(x: Array) -> float:
    return math.sqrt(x.dot(x))  # as np.linalg.norm, in a third of its time


TESTS: Final[tuple[tuple[str, str, Callable[[Point], float]], ...]] = (
    ("fold", "the branch turns back", lambda point: float(point.tangent[-1])),
    (
        "period doubling",
        "a multiplier passes -1",
        lambda p: float(np.prod(1.0 + p.multipliers).real),
    ),
    ("branch point", "another branch crosses", lambda point: point.crossing),
)
"""Smooth test functions, with what a change of their sign means."""


def _pair_outside(point: Point) -> bool | None:
    """Whether the largest complex pair lies outside the unit circle; None if all are real."""
    pairs = [abs(x) for x in point.multipliers if abs(x.imag) > 1e-9 * max(abs(x), 1e-9)]
    return max(pairs) > 1.0 if pairs else None


def change_of(before: Signature, after: Signature) -> tuple[str, str]:
    """Return the kind of a change of what happens in a period, and the sentence."""
    counts = [{(c, what): n for c, what, n in pair} for pair in (before, after)]
    keys = sorted({key for count in counts for key in count})
    parts, reversals, kind = list[str](), list[str](), "reversal"
    for key in keys:
        a, b = (count.get(key, 0) for count in counts)
        contact, what = key
        if a == b or what.startswith("mode "):
            continue
        where = f" at {contact}" if contact else ""
        if what == "stop":
            kind = "sticking" if kind == "reversal" else kind
            word = "begins" if a == 0 else "ends" if b == 0 else f"from {a} to {b} times a period"
            parts.insert(0, f"sticking{where} {word}")
        elif what == "reversal":
            reversals.append(f"reverses{where} without sticking from {a} to {b} times a period")
        elif what == "break-away":
            reversals.append(f"breaks away{where} from {a} to {b} times a period")
        else:
            kind = "grazing"
            parts.append(f'"{what}"{where} from {a} to {b} times a period')
    return kind, "; ".join(parts or reversals or ["what the contacts do all the time"])
