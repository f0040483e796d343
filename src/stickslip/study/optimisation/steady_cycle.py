"""The steady cycle of a mechanism that repeats a drive: what it brings and what it takes.

1. The run goes from rest over 3 cycles of the drives, then 6, 12, ... 96, until travel and velocity
   of the last cycle are those of the cycle before.
2. Where they never are, as in motions of two periods or in chaos, the later half of the cycles
   counts, each number as a mean over them or as their extreme.
3. Work is that of what drives the mechanism, by two Gauss points in each cell between samples,
   events and steps of the drives; only positive power counts, since no motor gets it back.

The force of a drive in a coordinate is the generalised force with the drives less that without
them; of a prescribed motion, it is the effort of the guide.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.simulation import simulate
from stickslip.engine.solver import EventDriven
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import DCMotor, Mechanism, cycle_of, slip_among, static_normal_forces
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import Parametrised
from stickslip.show.described import Described
from stickslip.study.tolerances import FEWEST_CYCLES, TRANSIENT

Array = NDArray[np.float64]

MOST_CYCLES = 96
"""Cycles after which it is taken as it is."""
CYCLE_TIMES = 257
"""Evenly spaced times of a cycle."""
ZOOM = 17
"""Times between the neighbours of an extreme sample."""
GAUSS = 0.5 / math.sqrt(3.0)
"""Distance of the two Gauss points from the middle of a cell, over its width."""
ACCELERATION, SHARE, FORCE = "acceleration", "share:", "force:"
"""Extremes beside those of the columns of a run: names, and beginnings of names."""
GROUND = "ground"
"""Drive that moves the ground and not the mechanism."""


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
    return Cycle(
        run=run,
        begin=begin,
        period=period,
        repeats=repeats,
        travel=float(x[-1] - x[0]) / kept,
        back_slip=float(np.maximum(-np.diff(x), 0.0).sum()) / kept,
        work=_positive_work(mechanism, run, nodes) / kept if forces else math.nan,
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
    found = {name: np.abs(seen[name]) for name in seen.names}
    found |= {SHARE + name: -share for name, share in _load_shares(mechanism, seen).items()}
    found |= {FORCE + name: np.abs(effort) for name, effort in _efforts(mechanism, seen).items()}
    drives = mechanism.drives()
    given = [values_of(drives[guide.drive], seen.t) for guide in mechanism.guided().values()]
    return found | ({ACCELERATION: np.max(np.abs(given), axis=0)} if given else {})


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
    found = {}
    for contact, force in static_normal_forces(mechanism).items():
        if force == 0.0:  # bears nothing at rest
            continue
        for column in ("normal_force", f"normal_force:{contact}"):
            if column in seen.names:
                found[column] = seen[column] / force
    return found


def _efforts(mechanism: Mechanism, seen: Trajectory) -> dict[str, Array]:
    """Return what drives exert along each coordinate: forces, and efforts of prescribed motions."""
    guided = mechanism.guided()
    found = {name: seen[guide.effort] for name, guide in guided.items() if guide.effort}
    drives = {
        name: values_of(drive, seen.t)
        for name, drive in mechanism.drives().items()
        if name not in {guide.drive for guide in guided.values()}
    }
    if not drives or _has_electric_motor(mechanism):
        return found
    q = {name: seen[name] for name in mechanism.coordinates}
    q_dot = {
        name: seen[rate] for name, rate in zip(mechanism.coordinates, mechanism.rates, strict=True)
    }
    idle = {name: 0.0 * x if name != GROUND else x for name, x in drives.items()}
    driven, still = (mechanism.forces(seen.t, q, q_dot, given) for given in (drives, idle))
    for name, force in driven.items():
        if name not in q:  # what presses a body, and moves nothing
            continue
        effort = np.broadcast_to(force - still.get(name, 0.0), seen.t.shape)
        if name not in guided and np.any(effort != 0.0):
            found[name] = effort
    return found


def _has_electric_motor(part: object) -> bool:
    """Whether a drive is a voltage or a current, whose force depends on the motion too."""
    if isinstance(part, DCMotor):
        return True
    inner = part if isinstance(part, tuple) else ()
    if isinstance(part, Parametrised):
        inner = tuple(vars(part).values())
    return any(map(_has_electric_motor, inner))


def values_of(drive: Drive, times: Array) -> Array:
    """Return the values of a drive at times (n,).

    Examples
    --------
    >>> from stickslip.mechanisms.drives import Pulse
    >>> values_of(Pulse(level=10.0, duration=0.1), np.array([0.05, 0.1])).tolist()
    [10.0, 0.0]
    """
    pieces = drive.pieces(float(times.max()))
    starts = np.array([float(piece.start) for piece in pieces])
    here = np.searchsorted(starts, times, side="right") - 1
    table = np.array([(p.value, p.slope, p.start) for p in pieces] or [(0.0, 0.0, 0.0)])
    value, slope, start = table[np.maximum(here, 0)].T
    linear = np.where(here >= 0, value + slope * (times - start), 0.0)
    return np.asarray(drive.shaped(linear, times), dtype=np.float64)


def _positive_work(mechanism: Mechanism, run: Trajectory, nodes: Array) -> float:
    """Return the work of the drives where they drive, by two Gauss points a cell."""
    widths = np.diff(nodes)
    middles = nodes[:-1] + 0.5 * widths
    rates = dict(zip(mechanism.coordinates, mechanism.rates, strict=True))
    power = np.zeros_like(widths)
    for side in (-GAUSS, GAUSS):
        seen = run.at(middles + side * widths)
        for name, effort in _efforts(mechanism, seen).items():
            power = power + np.maximum(effort * seen[rates[name]], 0.0)
    return float((0.5 * widths * power).sum())


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
