"""Optimisation of a mechanism that repeats a drive: any parameters, one objective or two.

Each candidate is run from rest until its cycles repeat, and judged by its steady cycle.
Parameters lie between two ends each; where both are above 0 their logarithms are searched, so
that a stiffness may range over decades.

- One objective: covariance matrix adaptation by `cma`, first about the motions that are known, the
  best of them first, then from random points, as often as the evaluations allow. A candidate within
  all limits is always better than one beyond any; of those beyond, the one that exceeds less.
- Two objectives: the non-dominated sorting genetic algorithm NSGA-II by `pymoo`, with the same
  order of candidates beyond limits; the result is the front of all candidates that were tried.

The steady cycle of a mechanism that repeats a drive:

1. The run goes from rest over 3 cycles of the drives, then 6, 12, ... 96, until travel and velocity
   of the last cycle are those of the cycle before.
2. Where they never are, as in motions of two periods or in chaos, the later half of the cycles
   counts, each number as a mean over them or as their extreme.
3. Work is that of what drives the mechanism (`study.energy`); only positive power counts, since no
   motor gets it back.

The force of a drive in a coordinate is the generalised force with the drives less that without
them; of a prescribed motion, it is the effort of the guide.

With scenarios, several laws or values of uncertain parameters, each objective is a quantile over
them, and the limits hold in each.

Sources: N. Hansen, The CMA Evolution Strategy: A Tutorial, arXiv:1604.00772; K. Deb, A. Pratap,
S. Agarwal, T. Meyarivan, IEEE Trans. Evol. Comput. 6 (2002) 182-197; order beyond limits: K. Deb,
Comput. Methods Appl. Mech. Eng. 186 (2000) 311-338.
"""

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import rig_toml
from stickslip.engine.executors import check_executor
from stickslip.engine.simulation import event_driven_law, simulate
from stickslip.engine.solver import EventDriven
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import (
    ConvergenceError,
    InputError,
    ParameterError,
    UnknownNameError,
    not_whole,
)
from stickslip.friction import Friction, FrictionLaw, Laws
from stickslip.mechanisms import Mechanism, cycle_of, slip_among, static_normal_forces
from stickslip.quantities import Quantity, all_paths, full_path, named, replaced, vary
from stickslip.show.described import Described
from stickslip.show.display import OnAxes, Summary, Tabular, require_library
from stickslip.show.formatting import number, percent, quantity
from stickslip.study.energy import efforts_of, energy_balance, values_of
from stickslip.study.tolerances import FEWEST_CYCLES, ROUNDING, TRANSIENT
from stickslip.units import per_second

# The steady cycle.


Array = NDArray[np.float64]

MOST_CYCLES = 96
"""Cycles after which it is taken as it is."""
CYCLE_TIMES = 257
"""Evenly spaced times of a cycle."""
ZOOM = 17
"""Times between the neighbours of an extreme sample."""
ACCELERATION, SHARE, FORCE = "acceleration", "share:", "force:"
"""Extremes beside those of the columns of a run: names, and beginnings of names."""


@dataclass(frozen=True, kw_only=True)
class Cycle(metaclass=Described):
    """A steady cycle, in SI units.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    >>> cycle = measure(capsule, Coulomb(kinetic_coefficient=0.2))
    >>> round(cycle.travel, 7), cycle.repeats
    (0.0064304, True)
    """

    run: Trajectory | None = field(default=None, repr=False)
    """All cycles from rest on; None of candidates, whose runs would fill the memory."""
    begin: float
    """When the cycles that count begin [s]."""
    period: float
    """Duration of a cycle [s]."""
    lasted: float = 1.0
    """Share of the requested duration that the run lasted: below 1 where it ended early."""
    repeats: bool
    """Whether travel and velocity of a cycle are those of the cycle before."""
    travel: float
    """Travel in a cycle [m] or [rad]."""
    back_slip: float
    """All motion in the negative direction in a cycle [m] or [rad]."""
    work: float
    """Positive work of the drives in a cycle [J]; NaN where no drive exerts a force."""
    peak_force: float
    """Largest force [N] or torque [N m] of a drive; NaN where no drive exerts a force."""
    load_share: float
    """Least normal force over that at rest, of all contacts; 1 where none bears any at rest."""
    largest: Mapping[str, float]
    """Largest absolute value of each column of the run, and acceleration of prescribed motions."""
    ended: str = ""
    """When and why the run ended early, in words."""

    @property
    def speed(self) -> float:
        """Mean speed [m/s] or [rad/s]."""
        return self.travel / self.period

    @property
    def unsettled(self) -> float:
        """1 where cycles do not repeat, as in chaos, 0 where they do."""
        return 0.0 if self.repeats else 1.0

    @property
    def energy(self) -> float:
        """Positive work of the drives over the travel [J/m]; infinite without travel."""
        return self.work / self.travel if self.travel > 0.0 else math.inf


def measure(
    mechanism: Mechanism, law: FrictionLaw | Laws, *, coordinate: str | None = None
) -> Cycle:
    """Run cycles until they repeat, and measure the last one.

    Parameters
    ----------
    mechanism : Mechanism
        Its drives repeat themselves.
    law : FrictionLaw or Laws
        Law of friction, or laws by contact.
    coordinate : str, optional
        Coordinate of the travel; the one along which contacts slip if not given.

    Returns
    -------
    Cycle
        `repeats` is False where 96 cycles were not enough, and where the run ended early.

    Raises
    ------
    InputError
        If the drives have no common cycle, or the mechanism slips along several coordinates.

    Examples
    --------
    >>> import math
    >>> from stickslip import Coulomb, PendulumCart
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    >>> cart = PendulumCart(
    ...     cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    ... )
    >>> cycle = measure(cart, Coulomb(kinetic_coefficient=0.2))
    >>> round(cycle.travel, 7), round(1e3 * cycle.back_slip, 2)
    (0.0634659, 0.31)
    """
    coordinate = coordinate or travelling(mechanism)
    slip, rate = slip_among(mechanism, coordinate, "measure")
    period, count = cycle_of(mechanism), FEWEST_CYCLES
    solver = EventDriven(tier="compiled")
    while True:
        run = simulate(mechanism, law, t_end=count * period, solver=solver, throw=False)
        if not run.status.complete:
            return _cut_short(run, period, run.span[1] / (count * period))
        repeats = _repeats(run, slip, rate, count, period)
        if repeats or 2 * count > MOST_CYCLES:
            return _measured(mechanism, run, slip, count, 1 if repeats else count // 2, repeats)
        count *= 2


def travelling(mechanism: Mechanism) -> str | None:
    """Return the only coordinate along which the body slips, beside those that are prescribed.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> travelling(Pendulum(mass=1.0, length=0.5))
    'theta'
    """
    guided = mechanism.guided()
    slips = {name for contact in mechanism.contacts() for name in contact.slips}
    free = [name for name in mechanism.coordinates if name in slips and name not in guided]
    if slips and not free:
        raise InputError(
            f"the motion prescribes {', '.join(sorted(slips))}, the slip itself: its travel is"
            " given already."
        )
    return free[0] if len(free) == 1 else None


def _repeats(run: Trajectory, slip: str, rate: str, count: int, period: float) -> bool:
    """Whether the last cycle is like the one before it."""
    last = run.at(np.linspace((count - 1) * period, count * period, 33))
    before = run.at([(count - 2) * period])
    x, v = last[slip], last[rate]
    more = (x[-1] - x[0]) - (x[0] - before[slip][0])
    return bool(
        abs(more) <= TRANSIENT * np.ptp(x) and abs(v[-1] - v[0]) <= TRANSIENT * np.abs(v).max()
    )


def _cut_short(run: Trajectory, period: float, lasted: float) -> Cycle:
    """Return a cycle of which nothing is known but when it ended."""
    unknown = dict.fromkeys(("travel", "back_slip", "work", "peak_force", "load_share"), math.nan)
    ended = f"its run stopped at {run.span[1]:.4g} s: {run.ending}"
    return Cycle(
        run=run, begin=0.0, period=period, lasted=lasted, ended=ended, repeats=False, largest={},
        **unknown,
    )  # fmt: skip


def _measured(
    mechanism: Mechanism, run: Trajectory, slip: str, count: int, kept: int, repeats: bool
) -> Cycle:
    """Measure the last cycles of a run."""
    end = run.span[1]
    period = end / count
    begin = end - kept * period
    nodes = _nodes(mechanism, run, begin, end, kept)
    seen = run.at(nodes)
    largest = _extremes(mechanism, run, nodes, _sizes(mechanism, seen))
    x = seen[slip]
    shares = [-value for name, value in largest.items() if name.startswith(SHARE)]
    forces = [value for name, value in largest.items() if name.startswith(FORCE)]
    work = math.nan
    if forces:
        work = energy_balance(mechanism, run, coordinate=slip, since=begin).positive[-1]
    return Cycle(
        run=run,
        begin=begin,
        period=period,
        repeats=repeats,
        travel=float(x[-1] - x[0]) / kept,
        back_slip=float(np.maximum(-np.diff(x), 0.0).sum()) / kept,
        work=work / kept,
        peak_force=max(forces, default=math.nan),
        load_share=min(shares, default=1.0),
        largest={
            name: value
            for name, value in largest.items()
            if name in run.names or name == ACCELERATION
        },
    )


def _sizes(mechanism: Mechanism, seen: Trajectory) -> dict[str, Array]:
    """Return what must not grow too large: columns, lost load, forces, given accelerations."""
    result = {name: np.abs(seen[name]) for name in seen.names}
    result |= {SHARE + name: -share for name, share in _load_shares(mechanism, seen).items()}
    result |= {FORCE + name: np.abs(effort) for name, effort in efforts_of(mechanism, seen).items()}
    drives = mechanism.drives()
    given = [values_of(drives[guide.drive], seen.t) for guide in mechanism.guided().values()]
    return result | ({ACCELERATION: np.max(np.abs(given), axis=0)} if given else {})


def _nodes(mechanism: Mechanism, run: Trajectory, begin: float, end: float, cycles: int) -> Array:
    """Return even times, and those at which something jumps, also just before."""
    jumps = [event.t for event in run.events]
    for drive in mechanism.drives().values():
        jumps += [float(piece.start) for piece in drive.pieces(end)]
    inside = np.array([t for t in jumps if begin < t < end])
    even = np.linspace(begin, end, cycles * (CYCLE_TIMES - 1) + 1)
    return np.unique(np.concatenate([even, inside, np.nextafter(inside, -np.inf)]))


def _load_shares(mechanism: Mechanism, seen: Trajectory) -> dict[str, Array]:
    """Return normal forces over those at rest, by contact that bears any."""
    result = {}
    for contact, force in static_normal_forces(mechanism).items():
        if force == 0.0:  # bears nothing at rest
            continue
        for column in ("normal_force", f"normal_force:{contact}"):
            if column in seen.names:
                result[column] = seen[column] / force
    return result


def _extremes(
    mechanism: Mechanism, run: Trajectory, nodes: Array, columns: Mapping[str, Array]
) -> dict[str, float]:
    """Return the largest value of each column, also between the neighbours of its sample."""
    best = {name: int(np.argmax(column)) for name, column in columns.items()}
    pairs = [(nodes[max(i - 1, 0)], nodes[min(i + 1, len(nodes) - 1)]) for i in best.values()]
    times = np.concatenate([np.linspace(*pair, ZOOM) for pair in pairs])
    near = run.at(times)
    finer = _sizes(mechanism, near)
    return {
        name: max(float(column[best[name]]), float(finer[name][k * ZOOM : (k + 1) * ZOOM].max()))
        for k, (name, column) in enumerate(columns.items())
        if name in finer
    }


if TYPE_CHECKING:
    import pandas as pd

Scenario: TypeAlias = Friction | Mapping[str, float]
"""Another law, or other values of parameters by path."""
Progress: TypeAlias = Callable[[int, int, float], object]
"""Called with candidates tried, their total, and the best of the first objective or NaN."""

WIDTH = 0.25
"""Standard deviation of the first candidates, over the range of a parameter."""
ENDED = 10.0
"""Violation of a run that ended early, at its end; twice that at its beginning."""
POPULATION = 40
"""Candidates in a generation of two objectives."""
SHOWN_CYCLES = 5
"""Cycles of the run in the rig file."""
GIVEN_LAW = "the given law"
"""What objectives are taken over without scenarios."""
QUANTILE = Quantity("quantile", low=0, high=1)


@dataclass(frozen=True, kw_only=True)
class Goal(metaclass=Described):
    """An objective."""

    name: str
    """Its name as an argument."""
    title: str
    """Its name in reports."""
    sign: float
    """1 where it is to be large, -1 where it is to be small."""
    value: Callable[[Cycle], float] = field(repr=False)
    """Its value of a steady cycle [SI]."""


GoalName: TypeAlias = Literal["speed", "energy", "peak_force"]
GOALS: Mapping[str, Goal] = {
    goal.name: goal
    for goal in (
        Goal(name="speed", title="mean speed", sign=1.0, value=lambda cycle: cycle.speed),
        Goal(name="energy", title="energy per travel", sign=-1.0, value=lambda cycle: cycle.energy),
        Goal(
            name="peak_force", title="peak force", sign=-1.0, value=lambda cycle: cycle.peak_force
        ),
    )
}
"""The objectives by name."""
OF_CYCLES = ("load_share", "back_slip", "energy", "peak_force", "unsettled")
"""What can be limited beside coordinates, rates, efforts and accelerations."""


def units_of(mechanism: Mechanism, slip: str) -> dict[str, str]:
    """Return the SI units of objectives and limits for a travel along a coordinate, by name.

    Examples
    --------
    >>> from stickslip import Capsule
    >>> units = units_of(Capsule(capsule_mass=0.8, inner_mass=0.2), "x")
    >>> units["energy"], units["xi_dot"], units["peak_force"]
    ('J/m', 'm/s', 'N')
    """
    columns = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    length = columns[slip]
    guided = mechanism.guided()
    driven = [*guided] or [name for name in columns if name != slip] or [slip]
    efforts = {guide.effort: guide.unit for guide in guided.values()}
    force = "N m" if columns[driven[0]] == "rad" else "N"
    result = {"speed": f"{length}/s", "energy": f"J/{length}", "back_slip": length}
    result |= {"load_share": "1", "peak_force": force, "unsettled": "1"}
    if guided:
        result[ACCELERATION] = f"{columns[driven[0]]}/s^2"
    rates = dict(zip(mechanism.rates, map(per_second, mechanism.units), strict=True))
    return result | columns | rates | efforts


@dataclass(frozen=True, kw_only=True)
class Margin(metaclass=Described):
    """The distance of a motion from a limit.

    Examples
    --------
    >>> Margin(name="xi_dot", allowed=0.8, reached=0.7, unit="m/s").kept
    True
    """

    name: str
    """Which limit."""
    allowed: float
    """The limit [SI]."""
    reached: float
    """The extreme over the cycle, in the worst scenario [SI]."""
    unit: str
    """SI unit of both."""

    @property
    def excess(self) -> float:
        """How far the limit is exceeded, over the limit itself; 0 if it is kept."""
        beyond = self.reached - self.allowed
        if self.name == "load_share":  # a least value
            beyond = -beyond
        share = beyond / abs(self.allowed) if self.allowed else beyond
        return 0.0 if share <= ROUNDING else share

    @property
    def kept(self) -> bool:
        """Whether the limit is kept."""
        return self.excess == 0.0


@dataclass(frozen=True, kw_only=True)
class Motion(metaclass=Described):
    """A candidate: values of the parameters, and what its steady cycle is like."""

    parameters: Mapping[str, float]
    """Values by full path [SI]."""
    goals: Mapping[str, float]
    """Objectives by name, over all scenarios [SI]; NaN where a run ended early."""
    margins: tuple[Margin, ...]
    """The limits; empty where a run ended early."""
    cycles: tuple[Cycle, ...]
    """The steady cycle of each scenario."""

    @property
    def violation(self) -> float:
        """How far limits are exceeded, as a sum of shares; 0 if all are kept."""
        ended = [ENDED * (2.0 - cycle.lasted) for cycle in self.cycles if cycle.lasted < 1.0]
        unknown = [] if ended else [ENDED for v in self.goals.values() if not math.isfinite(v)]
        return sum(ended) + sum(unknown) + sum(margin.excess for margin in self.margins)

    @property
    def feasible(self) -> bool:
        """Whether all scenarios keep all limits and have all objectives."""
        return self.violation == 0.0

    @property
    def reason(self) -> str:
        """Why it is not feasible, in words; empty if it is."""
        if ended := [cycle.ended for cycle in self.cycles if cycle.ended]:
            return ended[0]
        if exceeded := [margin.name for margin in self.margins if not margin.kept]:
            return f"exceeds {', '.join(exceeded)}"
        return "" if self.feasible else "does not travel forward"


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Optimum(OnAxes, Tabular):
    """The best motion, or the front of motions of which none is better in both objectives."""

    mechanism: Mechanism
    """With the parameters of the first motion."""
    law: FrictionLaw | Laws
    """The law, with the parameters of the first motion."""
    goals: tuple[Goal, ...]
    """One objective or two."""
    units: Mapping[str, str]
    """SI unit of each objective."""
    coordinate: str
    """Coordinate of the travel."""
    limits: Mapping[str, float]
    """The limits that hold [SI]."""
    scenarios: str
    """What the objectives are taken over, in words."""
    motions: tuple[Motion, ...]
    """The best motion; with two objectives the front, the best in the first of them at the head."""
    start: Motion
    """The motion of the mechanism as given."""
    run: Trajectory
    """Certified run of the first motion with its law, from rest on."""
    evaluations: int
    """Candidates that were tried, each in every scenario."""
    seed: int
    """Seed of the random numbers."""
    cancelled: bool
    """Whether the search was stopped early."""

    @property
    def best(self) -> Motion:
        """The first motion."""
        return self.motions[0]

    @property
    def travel(self) -> tuple[str, str]:
        """Names of the coordinate of the travel and of its rate."""
        return slip_among(self.mechanism, self.coordinate, "optimise")

    @property
    def value(self) -> float:
        """Its first objective [SI]."""
        return self.best.goals[self.goals[0].name]

    def to_dict(self) -> dict[str, Any]:
        """Return numbers and texts, for JSON."""
        names = ("limits", "scenarios", "evaluations", "seed", "cancelled")
        return {name: getattr(self, name) for name in names} | {
            "goals": dict(self.units),
            "motions": [_content(motion) for motion in self.motions],
            "start": _content(self.start),
            "certified": self.run.certificate.certified,
        }

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each motion: objectives, then parameters [SI]."""
        import pandas as pd

        return pd.DataFrame([{**motion.goals, **motion.parameters} for motion in self.motions])

    def _column_units(self) -> Mapping[str, str]:
        return self.units

    def to_toml(self) -> str:
        """Return a rig file with the first motion, which `load_rig` and the command line read."""
        titles = " and ".join(goal.title for goal in self.goals)
        t_end = SHOWN_CYCLES * self.best.cycles[0].period
        return rig_toml(self.mechanism, self.law, title=f"Best {titles}", t_end=t_end)

    def _summary(self) -> Summary:
        several = range(1, len(self.motions) + 1) if len(self.motions) > 1 else [""]
        names = [*(f"best {place}".strip() for place in several), "as given"]
        motions = zip(names, (*self.motions, self.start), strict=True)
        rows = [
            [name, *motion.goals.values(), *motion.parameters.values(), motion.reason]
            for name, motion in motions
        ]
        rows = [[number(x, 5) if isinstance(x, float) else x for x in row] for row in rows]
        goals = [f"{goal.title}, {self.units[goal.name]}" for goal in self.goals]
        limits = []
        for limit in self.best.margins:
            ends = (quantity(value, limit.unit, 5) for value in (limit.reached, limit.allowed))
            limits.append(f"Limit of {limit.name}: {' of '.join(ends)}.")
        certified = "certified" if self.run.certificate.certified else "not certified"
        return Summary(
            sentence="" if self.scenarios == GIVEN_LAW else f"Objectives: {self.scenarios}",
            head=("", *goals, *self.best.parameters, ""),
            rows=rows,
            notes=(
                *limits,
                f"{self.evaluations} motions evaluated, seed {self.seed}; the run of the first is"
                f" {certified}.",
            ),
        )


def _content(motion: Motion) -> dict[str, Any]:
    names = ("period", "travel", "work", "peak_force", "load_share", "back_slip", "repeats")
    cycle = motion.cycles[0]
    return {
        "parameters": dict(motion.parameters),
        "values": dict(motion.goals),
        "feasible": motion.feasible,
        "reason": motion.reason,
        "margins": [dataclasses.asdict(margin) for margin in motion.margins],
        "cycle": {name: getattr(cycle, name) for name in names},
    }


@dataclass(frozen=True, kw_only=True)
class OptimisationProblem:
    """A mechanism with a law, parameters between their ends, objectives and limits."""

    mechanism: Mechanism
    law: FrictionLaw | Laws
    slip: str
    """Coordinate of the travel."""
    ends: Mapping[str, tuple[float, float]]
    """Lowest and highest value by full path."""
    goals: tuple[Goal, ...]
    limits: Mapping[str, float]
    scenarios: tuple[FrictionLaw | Laws | Mapping[str, float], ...]
    quantile: float | Literal["mean"]

    def values(self, point: Array) -> dict[str, float]:
        """Return the parameters at a point of the unit cube (n,)."""
        result = {}
        for (path, (low, high)), u in zip(self.ends.items(), np.clip(point, 0.0, 1.0), strict=True):
            value = low * (high / low) ** u if low > 0.0 else low + (high - low) * u
            result[path] = min(max(float(value), low), high)
        return result

    def place(self, values: Mapping[str, float]) -> Array:
        """Return the point (n,) of values by full path, moved into the unit cube."""
        point = []
        for (low, high), value in ((ends, values[path]) for path, ends in self.ends.items()):
            inside = min(max(value, low), high)
            share = (inside - low) / (high - low)
            point.append(math.log(inside / low) / math.log(high / low) if low > 0.0 else share)
        return np.array(point)

    def present(self) -> list[float]:
        """Return the values of the parameters in the mechanism and the law as given."""
        return [
            float(value_at(self.mechanism if path.startswith("mechanism.") else self.law, path))
            for path in self.ends
        ]

    def pairs(self, values: Mapping[str, float]) -> Iterator[tuple[Mechanism, FrictionLaw | Laws]]:
        """Yield mechanism and law in each scenario."""
        for scenario in self.scenarios:
            others = scenario if isinstance(scenario, Mapping) else {}
            law = self.law if isinstance(scenario, Mapping) else scenario
            yield with_values(self.mechanism, law, {**values, **others})

    def judge(self, point: Array) -> Motion:
        """Run a candidate in all scenarios."""
        return self.judged(self.values(point))

    def judged(self, values: Mapping[str, float]) -> Motion:
        """Run given values in all scenarios."""
        measured = (measure(*pair, coordinate=self.slip) for pair in self.pairs(values))
        cycles = tuple(dataclasses.replace(cycle, run=None) for cycle in measured)
        ended = any(cycle.lasted < 1.0 for cycle in cycles)
        goals = {
            goal.name: math.nan if ended else self._over_scenarios(goal, cycles)
            for goal in self.goals
        }
        margins = () if ended else tuple(self._margins(cycles))
        return Motion(parameters=dict(values), goals=goals, margins=margins, cycles=cycles)

    def _over_scenarios(self, goal: Goal, cycles: Sequence[Cycle]) -> float:
        result = np.array([goal.value(cycle) for cycle in cycles])
        if not np.isfinite(result).all():
            return float(result[~np.isfinite(result)][0])
        if self.quantile == "mean":
            return float(result.mean())
        share = self.quantile if goal.sign > 0.0 else 1.0 - self.quantile
        return float(np.quantile(result, share))

    def _margins(self, cycles: Sequence[Cycle]) -> Iterator[Margin]:
        for name, allowed in self.limits.items():
            reached = [
                getattr(cycle, name) if name in OF_CYCLES else cycle.largest[name]
                for cycle in cycles
            ]
            worst = min(reached) if name == "load_share" else max(reached)
            unit = units_of(self.mechanism, self.slip)[name]
            yield Margin(name=name, allowed=allowed, reached=worst, unit=unit)


def value_at(root: object, path: str) -> Any:
    """Return what stands at a full path.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> value_at(Coulomb(kinetic_coefficient=0.2), "friction.kinetic_coefficient")
    0.2
    """
    for name in path.split(".")[1:]:
        root = root[int(name)] if isinstance(root, tuple) else getattr(root, name)
    return root


def with_values(
    mechanism: Mechanism, law: FrictionLaw | Laws, values: Mapping[str, float]
) -> tuple[Mechanism, FrictionLaw | Laws]:
    """Return mechanism and law with other values by full path, those in lists included."""
    for path, value in values.items():
        if path.startswith("friction."):
            law = vary(law, "friction", {path: value})
        elif path in all_paths(mechanism, "mechanism"):
            mechanism = vary(mechanism, "mechanism", {path: value})
        else:  # a number in a list, such as a position of a spline
            mechanism = replaced(mechanism, "mechanism", path, value)
    return mechanism, law


def optimise(
    mechanism: Mechanism,
    law: Friction,
    parameters: Mapping[str, tuple[float, float]],
    *,
    goals: GoalName | Sequence[GoalName] = "speed",
    limits: Mapping[str, float] | None = None,
    scenarios: Sequence[Scenario] | None = None,
    quantile: float | Literal["mean"] = 0.05,
    coordinate: str | None = None,
    starts: Sequence[Mapping[str, float]] = (),
    evaluations: int = 800,
    seed: int = 0,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Optimum:
    """Find the parameters with which a mechanism moves best in its steady cycle.

    Parameters
    ----------
    mechanism : Mechanism
        Its drives repeat themselves: a prescribed motion, a force such as `Sine` or `Square`.
    law : FrictionLaw or mapping of str to FrictionLaw
        Law of friction, or laws by contact.
    parameters : mapping
        Lowest and highest value [SI] of what may change, by path:
        ``{"drive.profile.fast": (5.0, 200.0), "upper_soft_stop.place": (1e-4, 3e-3)}``. Numbers in
        a list have their place at the end: ``"drive.profile.positions.3"``.
    goals : str or sequence of one or two str
        ``"speed"`` (mean, to be large), ``"energy"`` (positive work of the drives over the travel,
        to be small) or ``"peak_force"`` (of the drives, to be small).
    limits : mapping, optional
        Largest absolute values [SI] of coordinates, rates and efforts of prescribed motions by
        name, such as ``{"xi": 0.01, "xi_dot": 0.8, "force": 8.0}``, of ``"acceleration"`` (of a
        prescribed motion), ``"back_slip"`` [m per cycle], ``"energy"`` [J/m], ``"peak_force"``
        [N]; the least ``"load_share"``, the normal force over that at rest; and
        ``"unsettled"``, which is 0 where only motions count that repeat themselves, not chaos.
    scenarios : sequence of FrictionLaw or mapping, optional
        Laws in place of `law`, such as those that ``verdict.sample`` draws, or values of uncertain
        parameters by path. Limits hold in each of them.
    quantile : float or "mean"
        Quantile of each objective over the scenarios, counted from the worst; 0 is the worst case.
    coordinate : str, optional
        Coordinate of the travel; the one along which contacts slip if not given.
    starts : sequence of mapping
        Values of parameters by path of motions that are known to be good, such as
        ``motion.parameters`` of another `Optimum`; what is left out is as given. With one
        objective a search begins at the best of them, and others where one has converged; with two
        the first generation has all.
    evaluations : int
        Candidates to try, rounded up to whole generations.
    seed : int
        Seed of the random numbers: the same seed gives the same result.
    executor : concurrent.futures.Executor, optional
        Where the candidates of a generation are run; here if not given. The result does not depend
        on it.
    progress : callable, optional
        Called after each generation with the candidates tried, their total, and the best value of
        the first objective, NaN without one. If it returns False, the best so far is the result.

    Returns
    -------
    Optimum
        The best motion, or with two objectives the front; never worse than the mechanism as given,
        if that keeps the limits.

    Raises
    ------
    InputError
        If an argument cannot be used; with two objectives, if pymoo is not installed.
    ParameterError
        If a number is outside its range.
    ConvergenceError
        If no candidate keeps the limits.

    Examples
    --------
    A force with a duty cycle drives an inner mass against a spring:

    >>> from stickslip import Capsule, Coulomb
    >>> from stickslip.mechanisms import Torque
    >>> from stickslip.mechanisms.drives import Square
    >>> push = Torque(drive=Square(high=1.0, low=-1.0, period=0.1, duty=0.5))
    >>> capsule = Capsule(capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, drive=push)
    >>> best = optimise(
    ...     capsule,
    ...     Coulomb(kinetic_coefficient=0.2),
    ...     {"drive.drive.duty": (0.1, 0.9), "drive.drive.period": (0.05, 0.3)},
    ...     limits={"xi": 0.05},
    ...     evaluations=40,
    ... )
    >>> best.best.feasible, best.value > best.start.goals["speed"]
    (True, True)
    """
    law = event_driven_law(mechanism, law)
    check_executor(executor)
    for name, value, least in (("evaluations", evaluations, 1), ("seed", seed, 0)):
        if type(value) is not int or value < least:
            raise ParameterError(not_whole(name, least, value))
    if progress is not None and not callable(progress):
        raise InputError(f"progress must be callable (tried, total, best), got {progress!r}.")
    slip, _ = slip_among(mechanism, coordinate or travelling(mechanism), "optimise")
    problem = OptimisationProblem(
        mechanism=mechanism,
        law=law,
        slip=slip,
        ends=_ends(mechanism, law, parameters),
        goals=_goals(goals),
        limits=_limits(units_of(mechanism, slip), limits or {}),
        scenarios=_scenarios(mechanism, law, scenarios),
        quantile=quantile
        if quantile == "mean"
        else QUANTILE.check("optimise", "quantile", quantile),
    )
    started = dict(zip(problem.ends, problem.present(), strict=True))
    start = problem.judged(started)
    _check_goals(problem, start)
    known = [start, *map(problem.judged, _known_values(problem, starts))]
    search = _front if len(problem.goals) > 1 else _single
    tried, cancelled = search(problem, known, evaluations, seed, executor, progress)
    motions = _best([*known, *tried], problem.goals)
    if not motions:
        raise ConvergenceError(
            f"no motion keeps the limits among the {len(tried)} candidates tried (the mechanism as"
            f" given: {start.reason}): widen limits or ranges, or increase evaluations."
        )
    best, result = with_values(mechanism, law, motions[0].parameters)
    run = measure(best, result, coordinate=slip).run
    assert run is not None
    return Optimum(
        mechanism=best,
        law=result,
        goals=problem.goals,
        units={goal.name: units_of(mechanism, slip)[goal.name] for goal in problem.goals},
        coordinate=slip,
        limits=problem.limits,
        scenarios=_words(problem),
        motions=motions,
        start=start,
        run=run,
        evaluations=len(known) + len(tried),
        seed=seed,
        cancelled=cancelled,
    )


def _ends(
    mechanism: Mechanism, law: FrictionLaw | Laws, given: Mapping[str, tuple[float, float]]
) -> dict[str, tuple[float, float]]:
    """Return the ends by full path, checked against the ranges of the parameters."""
    if not isinstance(given, Mapping) or not given:  # type: ignore[redundant-expr]  # by users
        raise InputError(f"parameters must map paths to (low, high), at least one, got {given!r}.")
    known = known_paths(mechanism, law)
    result = {}
    for name, pair in given.items():
        path = full_path(name, known)
        try:
            low, high = (float(end) for end in pair)
        except (TypeError, ValueError):
            raise InputError(f"parameters[{name!r}] must be (low, high), got {pair!r}.") from None
        if not -math.inf < low < high < math.inf:
            raise InputError(f"parameters[{name!r}] must increase, got {low:g} to {high:g}.")
        for end in (low, high):
            known[path].check("optimise", path, end)
        if value_at(mechanism if path.startswith("mechanism.") else law, path) is None:
            raise InputError(
                f"{path} has no value yet: give it one in the mechanism to begin with."
            )
        result[path] = (low, high)
    return result


def known_paths(mechanism: Mechanism, law: FrictionLaw | Laws) -> dict[str, Quantity]:
    """Return all parameters by full path, numbers in lists of a motion profile included.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> list(known_paths(Axis(inertia=1.0), Coulomb(kinetic_coefficient=0.2)))[0]
    'mechanism.inertia'
    """
    result = all_paths(mechanism, "mechanism") | all_paths(law, "friction")
    if "rad" not in mechanism.units:  # profiles and motors of what moves along a line
        for path, quantity in result.items():
            if quantity.or_unit and ("rad" in quantity.unit or "N m" in quantity.unit):
                result[path] = dataclasses.replace(quantity, unit=quantity.or_unit, or_unit="")
    for path in [*result]:
        owner, _, _ = path.rpartition(".")
        if owner == "mechanism" or not owner.startswith("mechanism."):
            continue
        for name, value in vars(value_at(mechanism, owner)).items():
            if isinstance(value, tuple) and all(isinstance(item, float | int) for item in value):
                result |= {f"{owner}.{name}.{k}": Quantity(name) for k in range(len(value))}
    return result


def _goals(given: GoalName | Sequence[GoalName]) -> tuple[Goal, ...]:
    names = (given,) if isinstance(given, str) else tuple(given)
    if not 1 <= len(names) <= 2 or len(set(names)) < len(names):
        raise InputError(f"goals must be one or two of {', '.join(GOALS)}, got {given!r}.")
    if len(names) > 1:
        require_library("pymoo", "optimise", "give one goal, and limits for the other")
    return tuple(named(GOALS, name, "goal") for name in names)


def _scenarios(
    mechanism: Mechanism, law: FrictionLaw | Laws, given: Sequence[Scenario] | None
) -> tuple[FrictionLaw | Laws | Mapping[str, float], ...]:
    """Return the scenarios, paths of parameters in full; mappings of contacts are laws."""
    if given is None:
        return ({},)
    if isinstance(given, Mapping | str) or not len(given):
        raise InputError(
            f"scenarios must be friction laws or values by path, at least one, got {given!r}."
        )
    known = known_paths(mechanism, law)

    def checked(scenario: Any) -> FrictionLaw | Laws | Mapping[str, float]:
        values = scenario.values() if isinstance(scenario, Mapping) else [None]
        if all(isinstance(value, float | int) for value in values):
            return {full_path(path, known): float(value) for path, value in scenario.items()}
        return event_driven_law(mechanism, scenario)

    return tuple(map(checked, given))


def _words(problem: OptimisationProblem) -> str:
    if problem.scenarios == ({},):
        return GIVEN_LAW
    share = problem.quantile
    which = "mean" if share == "mean" else f"{percent(share)} quantile" if share else "worst"
    return f"the {which} of {len(problem.scenarios)} scenarios"


def _limits(units: Mapping[str, str], given: Mapping[str, float]) -> dict[str, float]:
    """Return the limits, checked."""
    known = [name for name in units if name != "speed"]
    for name, value in given.items():
        if name not in known:
            raise UnknownNameError("limit", name, known)
        Quantity(name, units[name], low=0).check("optimise", f"limits[{name!r}]", value)
    return {name: float(value) for name, value in given.items()}


def _check_goals(problem: OptimisationProblem, start: Motion) -> None:
    """Refuse objectives that the drives of the mechanism do not have."""
    needs = {"energy", "peak_force"} & ({goal.name for goal in problem.goals} | {*problem.limits})
    if needs and any(c.lasted == 1.0 and math.isnan(c.peak_force) for c in start.cycles):
        raise InputError(
            f"{' and '.join(sorted(needs))}: the drives of {type(problem.mechanism).__name__} exert"
            " no force of their own that could be measured; use 'speed', or drive it by a force"
            " or a prescribed motion."
        )


def _evaluated(
    problem: OptimisationProblem, points: Sequence[Array], executor: Executor | None
) -> list[Motion]:
    run = map if executor is None else executor.map
    return list(run(partial(OptimisationProblem.judge, problem), points))


def _told(
    progress: Progress | None, tried: Sequence[Motion], total: int, goals: tuple[Goal, ...]
) -> bool:
    """Report; return whether the search goes on."""
    if progress is None:
        return True
    best = _best(tried, goals[:1])
    value = best[0].goals[goals[0].name] if best else math.nan
    return progress(len(tried), total, value) is not False


def _known_values(
    problem: OptimisationProblem, starts: Sequence[Mapping[str, float]]
) -> list[dict[str, float]]:
    """Return the values of known motions by full path, moved between the ends."""
    given = dict(zip(problem.ends, problem.present(), strict=True))
    known, result = known_paths(problem.mechanism, problem.law), []
    for start in starts:
        if not isinstance(start, Mapping):  # by users
            raise InputError(f"starts must be values by path, got {start!r}.")
        own = {full_path(path, known): float(value) for path, value in start.items()}
        for path in own:
            if path not in problem.ends:
                raise UnknownNameError("parameter of starts", path, problem.ends)
        values = given | own
        ends = problem.ends.items()
        result.append({path: min(max(values[path], low), high) for path, (low, high) in ends})
    return result


def _single(
    problem: OptimisationProblem,
    known: Sequence[Motion],
    evaluations: int,
    seed: int,
    executor: Executor | None,
    progress: Progress | None,
) -> tuple[list[Motion], bool]:
    """Return what covariance matrix adaptation tried, and whether it was stopped."""
    import cma

    random = np.random.default_rng(seed)
    options = {
        "bounds": [0.0, 1.0],
        "randn": lambda *shape: random.standard_normal(shape),
        "seed": np.nan,  # leaves the global state of NumPy alone
        "verbose": -9,
    }
    begin = sorted(known, key=lambda motion: (motion.violation, _cost(motion, problem)))
    places = [problem.place(motion.parameters) for motion in begin]
    tried: list[Motion] = []
    while len(tried) < evaluations:
        # from the motions that are known, and then from anywhere
        near = bool(places) and len(known) > 1
        place = places.pop(0) if places else random.uniform(size=len(problem.ends))
        options["maxfevals"] = evaluations - len(tried)
        strategy = cma.CMAEvolutionStrategy(place, 0.5 * WIDTH if near else WIDTH, options)
        while not strategy.stop():
            points = [np.asarray(point, dtype=np.float64) for point in strategy.ask()]
            motions = _evaluated(problem, points, executor)
            tried += motions
            # beyond limits is worse than anything within
            worst = max((_cost(m, problem) for m in tried if m.feasible), default=0.0)
            costs = [_cost(m, problem) + (worst + m.violation) * (not m.feasible) for m in motions]
            strategy.tell(points, costs)
            if not _told(progress, tried, evaluations, problem.goals):
                return tried, True
    return tried, False


def _front(
    problem: OptimisationProblem,
    known: Sequence[Motion],
    evaluations: int,
    seed: int,
    executor: Executor | None,
    progress: Progress | None,
) -> tuple[list[Motion], bool]:
    """Return what NSGA-II tried, and whether it was stopped."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.evaluator import Evaluator
    from pymoo.core.problem import Problem as Searched
    from pymoo.problems.static import StaticProblem

    size = len(problem.ends)
    searched = Searched(n_var=size, n_obj=2, n_ieq_constr=1, xl=np.zeros(size), xu=np.ones(size))
    first = np.random.default_rng(seed).uniform(size=(min(POPULATION, evaluations), size))
    for k, motion in enumerate(known[: len(first)]):
        first[k] = problem.place(motion.parameters)
    algorithm = NSGA2(pop_size=len(first), sampling=first)
    algorithm.setup(searched, seed=seed, verbose=False)
    tried: list[Motion] = []
    while len(tried) < evaluations:
        candidates = algorithm.ask()
        motions = _evaluated(problem, list(candidates.get("X")), executor)
        tried += motions
        costs = np.array([_costs(motion, problem.goals) for motion in motions])
        violations = np.array([[motion.violation] for motion in motions])
        judged = StaticProblem(searched, F=costs, G=violations)
        Evaluator().eval(judged, candidates)
        algorithm.tell(infills=candidates)
        if not _told(progress, tried, evaluations, problem.goals):
            return tried, True
    return tried, False


def _costs(motion: Motion, goals: tuple[Goal, ...]) -> list[float]:
    """Return objectives, all to be small; 0 for motions beyond limits, which do not count."""
    return [-goal.sign * motion.goals[goal.name] if motion.feasible else 0.0 for goal in goals]


def _cost(motion: Motion, problem: OptimisationProblem) -> float:
    return _costs(motion, problem.goals)[0]


def _best(motions: Sequence[Motion], goals: tuple[Goal, ...]) -> tuple[Motion, ...]:
    """Return the feasible motions that no other exceeds in all objectives, ordered by the first."""
    feasible = [motion for motion in motions if motion.feasible]
    ranked = sorted(feasible, key=lambda motion: _costs(motion, goals))
    front: list[Motion] = []
    for motion in ranked:
        if not front or (len(goals) > 1 and _costs(motion, goals)[1] < _costs(front[-1], goals)[1]):
            front.append(motion)
    return tuple(front)
