"""Periodic orbits of driven and of self-excited mechanisms, by shooting.

The drives repeat after a cycle T. An orbit closes after m cycles, but for how far the mechanism
has advanced: a coordinate on which nothing depends (the place of a capsule on even ground) is left
out of the unknowns, so that the problem is solved in the quotient by its translations:

1. Unknowns y: coordinates, rates and bristles at time 0, without coordinates on which nothing
   depends and without what a drive prescribes.
2. Residual F(y) = Phi(y, m T) - y, by one run of the event-driven solver.
3. Monodromy M = dPhi/dy, from the sensitivities of that run. They are exact: at each event the
   saltation matrix, of impacts, sticking and breaking away, is taken into account. A body that
   sticks loses directions, whose multipliers are 0.
4. Newton: (M - 1) dy = -F, by least squares where a body that rests throughout leaves a continuum
   of orbits; a step is halved until the residual falls.
5. Floquet multipliers are the eigenvalues of M; the orbit is stable if all lie inside the unit
   circle. A run that only touches a stop or a switch has an infinite saltation factor: there is no
   monodromy then, and the search says so.

With respect to a parameter p, dF/dp = dPhi/dp + Phi'(m T) m dT/dp, as the cycle may depend on p.

Without drives in time T is unknown, and each point of a cycle may be its first. A section is the
phase condition (`sections`): the state y_k begins at a level, and T takes its place among the
unknowns, dF/dT = m f with the velocity f of all states at the end. What a belt carries along is
seen from what stands still: c m T is taken off the end, and c off f. Multipliers are those of the
return to the section, along f: M - f M_k / f_k without row and column k, whence 1 is not among
them.

Sources: Aprille and Trick 1972 (shooting); Seydel 2010, chapters 6 and 7 (phase conditions);
Leine and Nijmeijer 2004, chapters 4, 7 and 8 (saltation matrices, shooting with friction); Nordmark
1991 (grazing).
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.simulation import GivenFriction, event_driven_law, initial_state
from stickslip.engine.solver import BareRun, EventDriven, Form
from stickslip.engine.trajectory import Event, Trajectory
from stickslip.errors import InputError, SimulationError
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism, cycle_of, redriven, stops_of
from stickslip.mechanisms.drives import is_delayed, parts_of, without_delays
from stickslip.quantities import parameters, replaced, vary
from stickslip.show.described import Described
from stickslip.show.formatting import number, quantity
from stickslip.study.energy import EnergyBalance, energy_balance
from stickslip.study.sweep.delayed_orbits import Undelayed, delayed_multipliers
from stickslip.study.sweep.parameter_grid import (
    PERIOD,
    Array,
    axis_of,
    check_path,
    compiled,
    counted,
    states_of,
    unit_of,
    whole_run,
)
from stickslip.study.sweep.sections import STEADY, Section, given_section, passes_of, speeds_of
from stickslip.study.tolerances import ROUNDING

__all__ = ["Orbit", "periodic_orbit"]

T = TypeVar("T", Mechanism, FrictionLaw | Laws)
Signature: TypeAlias = tuple[tuple[str, str, int], ...]
"""How often each contact does what in an orbit: contact, what, count."""

CLOSED = 1e-10
"""Largest residual of an orbit, over the size of each state; a hundred tolerances with bristles."""
CUT = 1e-6
"""Part of a period of a drive by which the length of an orbit may be off: the digits given."""
NEAR = 1e-3
"""Residual, over the size of the states, below which full steps are taken."""
MOST_STEPS, MOST_HALVINGS = 30, 8
"""Newton steps, and halvings of one."""
LOST = 1e-13
"""Derivative, over the size of the states, that is rounding."""
END_STEP = 1e-5
"""Share of an orbit within which the velocity of the states at its end is taken."""
ECHO = 1e-4
"""Share of an orbit at its start in which what happens at its end, too, is the same."""
PERIOD_STEP = 1e-4
"""Share of a parameter by which it is changed for the derivative of the cycle."""
POWERS = 5
"""Values of a parameter at which it is seen how the cycle goes with it."""
ORBIT_TIMES = 33
"""Times of an orbit at which the size of its states is looked at."""
CYCLE = "cycle"
"""What the length of a cycle is called where it is unknown."""
REPEATED = 1e-6
"""How much of its size a cycle may be off after its second turn, over what one multiplier makes of
what the first one left."""
TRIAL_SHARE, TRIAL_RATE = 0.01, 1.0
"""Share of a cycle, and rate [m/s] or [rad/s] from which contacts slip, of the run that shows on
which coordinates nothing depends."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Orbit(metaclass=Described):
    """A periodic orbit with its stability."""

    mechanism: Mechanism
    """What moves."""
    law: FrictionLaw | Laws
    """What holds it back."""
    cycles: int
    """Cycles of the drives, or passes of the section, after which it closes."""
    period: float
    """How long that is [s]."""
    start: Mapping[str, float]
    """All states at time 0."""
    free: tuple[str, ...]
    """States whose start is solved for (n,); of the others nothing depends, or drives tell, or a
    section does."""
    advance: Mapping[str, float]
    """How far each coordinate on which nothing depends has come after the period [m] or [rad], and
    each that is carried along."""
    monodromy: Array
    """Derivatives (n, n) of the free states after the period with respect to their start; with a
    section, where it is passed again."""
    residual: float
    """Largest distance of the end from the start, over the size of the state in the orbit."""
    events: tuple[Event, ...]
    """What happens in the period."""
    modes: Mapping[str, int]
    """Mode at the start, by contact, as `Event.from_mode`."""
    solver: EventDriven
    """What it was run with."""
    section: Section | None = None
    """Where it begins if nothing drives it in time."""
    controlled: Mechanism | None = None
    """The mechanism with its delayed feedback, which vanishes on the orbit; None without one."""

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers (n,), the largest first; 0 along directions lost to sticking.

        Under delayed feedback there are infinitely many: those of a size above 1/2.
        """
        if self.controlled is not None:
            run = self.solver.bare(
                self.mechanism, self.law, y0=list(self.start.values()), t_end=self.period
            )
            times = tuple(event.t for event in self.events)
            orbit = Undelayed(
                run.playback,
                tuple(self.start),
                self.period,
                self.advance,
                times,
                self._monodromy_of,
            )
            return delayed_multipliers(orbit, self.controlled)
        result = np.linalg.eigvals(self.monodromy).astype(np.complex128)
        return result[np.argsort(-np.abs(result), kind="stable")]

    @property
    def stable(self) -> bool:
        """Whether all multipliers lie inside the unit circle.

        A body that rests throughout, in one of many places, has a multiplier 1: it stays near, but
        does not come back.
        """
        return bool(np.all(np.abs(self.multipliers) < 1.0))

    @property
    def mean_velocity(self) -> Mapping[str, float]:
        """Advance over period [m/s] or [rad/s] of each coordinate: 0 of those that come back."""
        names = self.mechanism.coordinates
        return {name: self.advance.get(name, 0.0) / self.period for name in names}

    @property
    def sticking(self) -> Mapping[str, float]:
        """Share of the period for which each contact sticks."""
        return {
            contact: _stuck(self.events, contact, mode, self.period) / self.period
            for contact, mode in self.modes.items()
        }

    def _monodromy_of(self, mechanism: Mechanism) -> Array:
        """Return the monodromy for a mechanism that has the same orbit."""
        states = tuple(self.start)
        map_ = ReturnMap(
            mechanism=mechanism,
            law=self.law,
            cycles=self.cycles,
            period=self.period / self.cycles,
            solver=self.solver,
            states=states,
            free=tuple(states.index(name) for name in self.free),
            moving=(),
        )
        return map_.shoot(np.array([self.start[name] for name in self.free])).monodromy

    def run(self, cycles: int | None = None) -> Trajectory:
        """Return the motion over one period, or over a number of cycles of the drives."""
        length = self.period if cycles is None else self.period * cycles / self.cycles
        start = [self.start[name] for name in states_of(self.mechanism, self.law)]
        return self.solver.run(self.mechanism, self.law, y0=start, t_end=length)

    def energy(self, coordinate: str | None = None) -> EnergyBalance:
        """Return the energy balance of one period.

        Parameters
        ----------
        coordinate : str, optional
            Coordinate of the travel; the one along which contacts slip if not given.
        """
        return energy_balance(self.mechanism, self.run(), coordinate=coordinate)


def periodic_orbit(
    mechanism: Mechanism,
    law: GivenFriction,
    *,
    cycles: int = 1,
    start: Mapping[str, float] | None = None,
    settle: int = 100,
    period: float | None = None,
    section: Mapping[str, float] | None = None,
    solver: EventDriven | None = None,
) -> Orbit:
    """Find a periodic orbit, stable or not, by shooting.

    Without drives in time, as of a block on a belt, the period is solved for too. With delayed
    feedback the orbit is that without it, as the feedback vanishes; its multipliers change.

    Parameters
    ----------
    mechanism : Mechanism
        What moves, with a periodic drive or none.
    law : FrictionLaw, type or str, or mapping of str to these
        What holds it back, as in `simulate`.
    cycles : int
        Cycles of the drives after which the orbit closes; without drives, passes of the section.
    start : mapping, optional
        States near the orbit at time 0; where the mechanism begins if not given.
    settle : int
        Cycles that are run before shooting begins, so that a stable orbit is found from any start
        that leads to it; 0 to find unstable ones from a start that is near.
    period : float, optional
        Length of a cycle [s]; that of the drives if not given, or else solved for.
    section : mapping, optional
        A state and the level that it passes upwards where a cycle of unknown period begins, such
        as ``{"v": 0.01}``; places are those seen by what does not move along. If not given, the
        rate of what is carried along passes the speed of that, or else the first state that comes
        back passes the middle of its range.
    solver : EventDriven, optional
        Compiled if not given.

    Returns
    -------
    Orbit
        Start, multipliers, events, advance.

    Raises
    ------
    InputError
        If an argument cannot be used, or the drives have no cycle.
    SimulationError
        If a run ends early, has no derivative (a grazing contact), or the search does not converge.

    References
    ----------
    R. I. Leine and H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems,
    Springer 2004, chapters 7 and 8.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=2.0))
    >>> orbit = periodic_orbit(axis, Coulomb(kinetic_coefficient=0.5))
    >>> orbit.stable, orbit.cycles, [event.reason for event in orbit.events]
    (True, 1, ['reversal', 'reversal'])

    A block on a belt sticks and slips by itself:

    >>> from stickslip import TowedBlock
    >>> block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    >>> orbit = periodic_orbit(block, Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5))
    >>> round(orbit.period, 5), round(orbit.sticking[""], 5), orbit.stable
    (7.61126, 0.65692, True)
    """
    if any(map(is_delayed, mechanism.drives().values())):
        free = redriven(mechanism, without_delays)
        if period is None and is_excited(free):
            raise InputError(
                "periodic_orbit: multipliers under delayed feedback are known of driven orbits"
                " alone: a self-excited cycle shifts its phase under it. Leave the feedback out."
            )
        orbit = periodic_orbit(
            free, law, cycles=cycles, start=start, settle=settle, period=period, section=section,
            solver=solver,
        )  # fmt: skip
        found_orbit = replace(orbit, controlled=mechanism)
        _ = found_orbit.multipliers  # a delay with which they are not known is refused
        return found_orbit
    result = event_driven_law(mechanism, law)
    counted("periodic_orbit", "cycles", cycles, 1)
    counted("periodic_orbit", "settle", settle, 0)
    begin = initial_state("periodic_orbit", mechanism, result, dict(start or {}))
    if period is None and is_excited(mechanism):
        return _excited(mechanism, result, int(cycles), begin, settle, section, compiled(solver))
    if section is not None:
        raise InputError(
            "periodic_orbit: section is for cycles of unknown period, but"
            f" {'the period is given' if period else 'drives tell it'}: leave section out."
        )
    if period is None:
        whole_run("periodic_orbit", mechanism, cycles + settle)
    else:
        PERIOD.check("periodic_orbit", "period", period)
        refuse_cut(mechanism, cycles * period)
    map_ = return_map(mechanism, result, int(cycles), period, compiled(solver))
    return map_.orbit(solved(map_, map_.settled("periodic_orbit", begin, settle)))


def is_excited(mechanism: Mechanism) -> bool:
    """Whether no drive of a mechanism depends on time, so that cycles have a length of their own.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms.drives import Sine
    >>> driven = Axis(inertia=1.0, drive=Sine(amplitude=1.0, frequency=2.0))
    >>> is_excited(Axis(inertia=1.0)), is_excited(driven)
    (True, False)
    """
    return all(part.steady for drive in mechanism.drives().values() for part in parts_of(drive))


def _excited(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    cycles: int,
    begin: Sequence[float],
    settle: int,
    given: Mapping[str, float] | None,
    solver: EventDriven,
) -> Orbit:
    """Return the cycle to which a run settles that nothing drives in time."""
    states = states_of(mechanism, law)
    section, least = given_section(states, given), settle + cycles + 1
    result = passes_of(mechanism, law, states, begin, solver, least, section)
    if result.lack:
        raise SimulationError(f"periodic_orbit, {result.lack}")
    length = float(result.times[-1] - result.times[-1 - cycles]) / cycles
    map_ = return_map(mechanism, law, cycles, None, solver, section=result.section, cycle=length)
    y = result.starts[-1 - cycles, map_.free]
    y[map_.slot] = length
    shot = solved(map_, y)
    # where time is in the equations, an end may be a start once, but not again
    twice = replace(map_, cycles=2 * cycles).shoot(shot.y)
    grown = 1.0 + float(np.abs(np.linalg.eigvals(shot.monodromy)).max(initial=0.0))
    if twice.error > REPEATED * grown:
        raise SimulationError(
            f"periodic_orbit: there is no cycle. The motion closes after {number(shot.period, 4)}"
            f" s, but not a second time: the equations of {type(mechanism).__name__} depend on time"
            " beside its drives. Let `carried` of the mechanism return what moves along steadily."
        )
    return map_.orbit(shot)


@dataclass(frozen=True)
class Derivatives:
    """Derivatives of the states at the end of a run, which cost more than the run."""

    map: "ReturnMap"
    """Whose run it was."""
    mechanism: Mechanism
    """What moved."""
    value: float
    """The parameter."""
    run: BareRun
    """The run."""
    period: float
    """Its length [s]."""
    rate: Array
    """Velocity of all states that are kept, at the end, less that at which they are carried."""

    @cached_property
    def raw(self) -> Array:
        """With respect to starts and p (free states and coordinates that advance, n + 1).

        What has none is no finite number.
        """
        map_, n = self.map, len(self.map.free)
        taken = self.at(self.run.differentiate.t_end)[map_.kept]
        result = np.zeros((len(taken), max(n + 1, taken.shape[1])))
        result[:, : taken.shape[1]] = taken
        return result

    @cached_property
    def all(self) -> Array:
        """The same; a run that lacks one is a `SimulationError`."""
        map_, n, result = self.map, len(self.map.free), self.raw
        if not math.isfinite(result.sum()):
            raise SimulationError(
                "there is no derivative: a contact, a stop or a switch is only touched (grazing),"
                " or two events coincide."
            )
        if map_.path is not None:
            result = result.copy()
            for column, path in enumerate(map_.paths[n:], n):
                carried, level = map_.drift(self.mechanism, path)
                result[:, column] -= self.period * carried
                if map_.section is not None:
                    result[:, column] += result[:, map_.slot] * level
                elif stretch := map_.stretch(self.mechanism, self.value, path):
                    result[:, column] += self.rate * stretch
        return result

    @cached_property
    def levels(self) -> Array:
        """How the level of the section changes with each start and p (n + 1)."""
        map_, n = self.map, len(self.map.free)
        result = np.zeros(self.all.shape[1])
        for column, path in enumerate(map_.paths[n:], n):
            result[column] = map_.drift(self.mechanism, path)[1]
        return result

    @cached_property
    def returned(self) -> Array:
        """The same of what is kept where the section is passed again, and not after the period."""
        map_ = self.map
        if map_.section is None:
            return self.all
        late = (self.all[map_.slot] - self.levels) / self.rate[map_.slot]
        result = self.all - np.outer(self.rate, late)
        result[:, map_.slot] = 0.0
        return result

    @cached_property
    def by_unknowns(self) -> Array:
        """Of F + y with respect to y and p, among which the length of a cycle may be (n + 1)."""
        map_ = self.map
        if map_.section is None:
            return self.all
        slot, result = map_.slot, self.all.copy()
        # the start is at the level, and it ends too late by what it is off over its velocity
        result[slot] = (result[slot] - self.levels) / self.rate[slot]
        result[:, slot] = map_.cycles * self.rate
        result[slot, slot] = map_.cycles + 1.0
        return result

    def at(self, time: float) -> Array:
        """Return those of all states at a time (states, paths), which may not be finite."""
        map_ = self.map
        # States that the mechanism begins with change with its parameters.
        told = tuple(name for name in self.mechanism.start() if name not in map_.names)
        sense = replace(self.run.differentiate, told=told) if told else self.run.differentiate
        return np.asarray(sense(np.array([time]), map_.paths)[0])

    @property
    def monodromy(self) -> Array:
        """M (n, n); with a section, of the return to it (n - 1, n - 1)."""
        n, map_ = len(self.map.free), self.map
        return map_.of_states(map_.of_states(self.returned[:n, :n]).T).T


@dataclass(frozen=True, kw_only=True)
class Shot:
    """One run over the period of an orbit that is sought."""

    y: Array
    """Free states at the start, in the place of one perhaps the length of a cycle (n,)."""
    value: float
    """The parameter; NaN if none varies."""
    mechanism: Mechanism
    """What moved."""
    law: FrictionLaw | Laws
    """What held it back."""
    period: float
    """Length of the run [s]."""
    residual: Array
    """F (n,); in the place of the length of a cycle how much too late it ends."""
    scale: Array
    """Size of each unknown in the run (n,)."""
    error: float
    """Largest residual over the size of its state."""
    came: Array
    """How far each coordinate on which nothing depends has come in the run."""
    off: Array
    """What y and p are beyond those of the run (n + 1,)."""
    half: Array
    """Free states after half the period less those at the start (n,)."""
    derivatives: Derivatives
    """Derivatives of the run, taken when they are asked for."""
    run: BareRun
    """The run."""

    @cached_property
    def strobes(self) -> Array:
        """Free states once a cycle, those at the start first (m, n)."""
        map_ = self.derivatives.map
        times: Array = np.arange(1.0, map_.cycles) * (self.period / map_.cycles)
        if not len(times):
            return self.y[None]
        later = (self.run.at(times) - times[:, None] * map_.speeds(self.mechanism))[:, map_.free]
        if map_.section is not None:
            later[:, map_.slot] = self.y[map_.slot]
        return np.vstack([self.y, *(np.append(item, self.y[len(item) :]) for item in later)])

    @property
    def monodromy(self) -> Array:
        """M (n, n); with a section, of the return to it (n - 1, n - 1)."""
        return self.derivatives.monodromy

    @property
    def slope(self) -> Array:
        """dF/dp (n,); 0 if no parameter varies."""
        return self.jacobian[:, len(self.y)]

    @property
    def rise(self) -> Array:
        """Derivatives of the advance with respect to y and p (coordinates, n + 1)."""
        return self.derivatives.by_unknowns[len(self.y) :]

    def sensed(self) -> "Shot":
        """Return the shot if it has derivatives, without which it is a `SimulationError`."""
        _ = self.derivatives.all
        return self

    @cached_property
    def signature(self) -> Signature:
        """How often each contact does what, and the mode of those that do nothing."""
        return self.derivatives.map.signature(self.mechanism, self.run)

    @cached_property
    def advance(self) -> Array:
        """How far each coordinate on which nothing depends comes."""
        return self.came + self.rise @ self.off if self.off.any() else self.came

    @cached_property
    def lost(self) -> NDArray[np.bool_]:
        """Whether each free state ends where it does whatever came before, as what sticks (n,)."""
        # How the end changes as each start changes by its size.
        value = abs(self.value) if math.isfinite(self.value) else 0.0
        end = np.abs(self.derivatives.by_unknowns[: len(self.y)])
        sizes = np.array([*self.scale.tolist(), value])
        result = np.asarray(end[:, : len(sizes)] @ sizes <= LOST * self.scale)
        if self.derivatives.map.section is not None:
            result[self.derivatives.map.slot] = False
        return result

    def moved(self, y: Array) -> Array:
        """Return a start, with what is lost exactly where it ends."""
        return np.where(self.lost, self.y + self.residual, y)

    @cached_property
    def jacobian(self) -> Array:
        """(n, n + 1): dF/dy and dF/dp."""
        result = self.derivatives.by_unknowns[: len(self.y)].copy()
        result.flat[:: result.shape[1] + 1] -= 1.0
        return result


@dataclass(frozen=True, kw_only=True)
class ReturnMap:
    """The states after m cycles, as a function of those at time 0 and of a parameter."""

    mechanism: Mechanism
    """What moves."""
    law: FrictionLaw | Laws
    """What holds it back."""
    cycles: int
    """m."""
    period: float | None
    """Length of a cycle [s]; that of the drives if None."""
    solver: EventDriven
    """Runs it."""
    states: tuple[str, ...]
    """All states."""
    free: tuple[int, ...]
    """Indices of those that are solved for."""
    moving: tuple[int, ...]
    """Indices of the coordinates on which nothing depends."""
    section: Section | None = None
    """Where cycles begin whose length is unknown."""
    path: str | None = None
    """Full path of the parameter."""
    between: tuple[float, float] | None = None
    """Values of it that were checked, as all between them are: what is asked of it are bounds."""
    beside: tuple[str, ...] = ()
    """Full paths of further parameters with derivatives."""

    @property
    def tolerance(self) -> float:
        """Largest residual of an orbit, over the size of each state."""
        return max(CLOSED, 100.0 * self.solver.tolerance_for(self.law))

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the states that are solved for."""
        return tuple(self.states[i] for i in self.free)

    @cached_property
    def kept(self) -> NDArray[np.intp]:
        """Indices of the states that are solved for, then of those on which nothing depends."""
        return np.array([*self.free, *self.moving], dtype=np.intp)

    @cached_property
    def slot(self) -> int:
        """Place among the unknowns of the length of a cycle, where the section's state would be."""
        return self.names.index(self.section.state) if self.section else -1

    @cached_property
    def unknowns(self) -> tuple[str, ...]:
        """Names of what is solved for."""
        if self.section is None:
            return self.names
        return tuple(CYCLE if k == self.slot else name for k, name in enumerate(self.names))

    def of_states(self, unknowns: Array) -> Array:
        """Return what holds for each unknown without the length of a cycle."""
        return unknowns if self.section is None else np.delete(unknowns, self.slot, axis=0)

    def unknowns_of(self, orbit: Orbit) -> Array:
        """Return what an orbit has of what is solved for."""
        known = {**orbit.start, CYCLE: orbit.period / orbit.cycles}
        return np.array([known[name] for name in self.unknowns])

    def speeds(self, mechanism: Mechanism) -> Array:
        """Return how fast each state is carried along."""
        return speeds_of(mechanism, self.states)

    def drift(self, mechanism: Mechanism, path: str) -> tuple[Array, float]:
        """Return how the speeds of what is kept change with a parameter, and the level."""
        if not mechanism.carried() or not path.startswith("mechanism."):
            return np.zeros(len(self.kept)), 0.0
        value = value_of(mechanism, self.law, path)
        h = PERIOD_STEP * (abs(value) or 1.0)
        above, below = (replaced(mechanism, "mechanism", path, value + s) for s in (h, -h))
        result = (self.speeds(above) - self.speeds(below))[self.kept] / (2.0 * h)
        if self.section is None:
            return result, 0.0
        return result, (self.section.at(above) - self.section.at(below)) / (2.0 * h)

    @cached_property
    def paths(self) -> list[str]:
        """Paths of derivatives: starts of the free states, and the parameter."""
        return [
            *map("initial.{}".format, self.names),
            *([self.path] if self.path else []),
            *self.beside,
        ]

    @cached_property
    def power(self) -> int | None:
        """With which power of the parameter the cycle goes: 0, -1 or 1; None with none of them."""
        if self.period is not None or str(self.path).startswith("friction."):
            return 0
        if self.between is None:
            return None
        values = np.linspace(*self.between, POWERS)
        cycles = np.array([cycle_of(self.pair(float(value))[0]) for value in values])
        for power in (0, -1, 1) if self.between[0] > 0.0 else (0,):
            if np.ptp(cycles / values**power) <= POWERS * _EPSILON * cycles.max():
                return power
        return None

    @cached_property
    def signatures(self) -> dict[bytes, Signature]:
        """Those of runs so far, by what happened in them."""
        return {}

    @cached_property
    def form(self) -> Form | None:
        """The equations of all runs; None if some values of the parameter shape them."""
        for root, prefix in ((self.mechanism, "mechanism"), (self.law, "friction")):
            for path, varied, _ in parameters(root, prefix):
                if path == self.path and not varied.structural:
                    return Form.of(self.mechanism, self.law)
        return None if self.path else Form.of(self.mechanism, self.law)

    def signature(self, mechanism: Mechanism, run: BareRun) -> Signature:
        """Return how often each contact does what, and the mode of those that do nothing.

        It does not depend on where in the cycle an orbit is cut: what happens at both ends of the
        run counts once, and a change of mode from the end to the start counts, too.
        """
        length, what_came = run.differentiate.t_end, run.happened()
        # the time of the first event, or 0 of a run without any
        early = run.differentiate.record.events[0] <= ECHO * length
        if not early and what_came in self.signatures:
            return self.signatures[what_came]
        events = run.events()
        late = {(e.contact, e.reason) for e in events if e.t >= (1.0 - ECHO) * length}
        ends = {e.contact: e.to_mode for e in events if e.from_mode != e.to_mode}

        def again(event: Event) -> bool:
            changes = event.from_mode != event.to_mode == ends.get(event.contact)
            return event.t <= ECHO * length and (changes or (event.contact, event.reason) in late)

        kept = [event for event in events if not again(event)]
        counts = Counter((event.contact, event.reason) for event in kept)
        changes = dict[str, list[Event]]()
        for event in kept:
            if event.from_mode != event.to_mode:
                changes.setdefault(event.contact, []).append(event)
        for name, own in changes.items():
            first, last = own[0].from_mode, own[-1].to_mode
            if first != last:  # what leads from the end to the start
                what = "reversal" if first and last else "break-away" if first else "stop"
                counts[name, what] += 1
        idle = [c.name for c in mechanism.contacts() if c.name not in changes]
        if idle:
            modes = first_modes(mechanism, run, kept)
            counts.update({(name, f"mode {modes[name]}"): 1 for name in idle})
        result = tuple(sorted((*key, count) for key, count in counts.items()))
        if not idle and not early:
            self.signatures[what_came] = result
        return result

    def form_at(self, value: float) -> Form | None:
        """Return the equations with a value of the parameter, if they are known."""
        return self.form if self.form is None else self.form.at(str(self.path), value)

    def pair(self, value: float) -> tuple[Mechanism, FrictionLaw | Laws]:
        """Return mechanism and law with a value of the parameter."""
        if self.path is None:
            return self.mechanism, self.law
        if self.path.startswith("friction."):
            return self.mechanism, self._varied(self.law, "friction", value)
        return self._varied(self.mechanism, "mechanism", value), self.law

    def _varied(self, root: T, prefix: str, value: float) -> T:
        path = str(self.path)
        if self.between is not None and self.between[0] <= value <= self.between[1]:
            result: T = replaced(root, prefix, path, value)
            return result
        return vary(root, prefix, {path: value})

    def duration(self, mechanism: Mechanism, value: float, y: Array | None = None) -> float:
        """Return m T [s] at a value of the parameter; T is among the unknowns with a section."""
        if self.section is not None and y is not None:
            return self.cycles * float(y[self.slot])
        if self.period is not None:
            return self.cycles * self.period
        if self.power is None:
            return self.cycles * cycle_of(mechanism)
        return self.cycles * self.cycle * value**self.power

    @cached_property
    def cycle(self) -> float:
        """The cycle over that power of the parameter."""
        if not self.power or self.between is None:
            return cycle_of(self.mechanism)
        value = self.between[1]
        return float(cycle_of(self.pair(value)[0]) / value**self.power)

    def begin(self, mechanism: Mechanism, y: Array) -> list[float]:
        """Return the start of all states from that of the free ones."""
        given: list[float] = y.tolist()
        if not all(map(math.isfinite, given)):
            raise SimulationError("a step has left all finite states.")
        # a rate of rounding's size in place of 0 would let what sticks slip for an instant
        least = _EPSILON * max(map(abs, given), default=0.0)
        begin = mechanism.start()
        start = [float(begin.get(name, 0.0)) for name in self.states]
        for i, x in zip(self.free, given, strict=True):
            start[i] = 0.0 if abs(x) <= least else x
        if self.section is not None:
            start[self.free[self.slot]] = self.section.at(mechanism)
        return start

    def run(
        self, y: Array, value: float
    ) -> tuple[Mechanism, FrictionLaw | Laws, list[float], BareRun]:
        """Return mechanism and law, the start of all states, and the run over the period from it.

        A run that ends early is a `SimulationError`.
        """
        mechanism, law = self.pair(value)
        start = self.begin(mechanism, y)
        period = self.duration(mechanism, value, y)
        if not period > 0.0:
            raise SimulationError("a step has led to no length of a cycle.")
        run = self.solver.bare(mechanism, law, y0=start, t_end=period, form=self.form_at(value))
        if not run.status.complete:
            raise SimulationError(run.status.value)
        return mechanism, law, start, run

    def seen(self, mechanism: Mechanism, run: BareRun, times: Array) -> Array:
        """Return the states of a run at times (n,), less what they are carried along."""
        states: Array = run.at(times)
        return states - times[:, None] * self.speeds(mechanism) if mechanism.carried() else states

    def settled(self, owner: str, begin: Sequence[float], cycles: int) -> Array:
        """Return the free states after a number of cycles from all states."""
        if cycles:
            end = np.array([cycles * self.duration(self.mechanism, np.nan) / self.cycles])
            run = self.solver.bare(self.mechanism, self.law, y0=begin, t_end=float(end[0]))
            if not run.status.complete:
                raise SimulationError(f"{owner}, settling: {run.status.value}")
            begin = self.seen(self.mechanism, run, end)[0].tolist()
        return np.array(begin)[list(self.free)]

    def happens(self, y: Array, value: float) -> Signature:
        """Return what happens in the period from free states."""
        mechanism, _, _, run = self.run(y, value)
        return self.signature(mechanism, run)

    def shoot(self, y: Array, value: float = np.nan, most: Array | None = None) -> Shot:
        """Run over the period from free states; derivatives are taken when they are asked for.

        A run that ends early is a `SimulationError`, as is one that leaves a residual of more than
        is told.
        """
        mechanism, law, start, run = self.run(y, value)
        period = run.differentiate.t_end
        times, n, begun = period * _SHARES, len(self.free), np.array([start[i] for i in self.free])
        states = self.seen(mechanism, run, times)[:, self.kept]
        ends = states[ORBIT_TIMES - 1 :]  # right before the end, too
        residual, half = ends[0, :n] - begun, states[ORBIT_TIMES // 2, :n] - begun
        size = np.abs(states[:, :n]).max(axis=0)
        if not size.all():
            size[size == 0.0] = max(size.max(initial=0.0), _TINY)
        # One-sided differences of second order: behind the end there is no run.
        rate = _BACKWARD @ ends / period
        if self.section is not None:
            if (np.ptp(states[:, :n], axis=0) <= STEADY * size).all():
                raise SimulationError("the cycle has shrunk to steady sliding.")
            if not rate[self.slot] * period > LOST * size[self.slot]:
                raise SimulationError(
                    f"{self.section.state} does not pass the level at which cycles begin upwards:"
                    " give another section."
                )
            residual[self.slot] /= rate[self.slot]
            begun[self.slot] = size[self.slot] = y[self.slot]
            half[self.slot] = 0.0
        y = begun
        if most is not None and (np.abs(residual) > most).any():
            raise SimulationError("a step has led farther from an orbit.")
        return Shot(
            y=y,
            value=value,
            mechanism=mechanism,
            law=law,
            period=period,
            residual=residual,
            scale=size,
            error=float((np.abs(residual) / size).max(initial=0.0)),
            came=ends[0, n:] - [start[i] for i in self.moving],
            off=np.zeros(n + 1),
            half=half,
            derivatives=Derivatives(self, mechanism, value, run, period, rate),
            run=run,
        )

    def nearby(self, shot: Shot, y: Array, value: float) -> Shot:
        """Return what closes so near a shot that derivatives and events are those of its run."""
        mechanism, law = self.pair(value)
        return replace(
            shot,
            y=y,
            value=value,
            mechanism=mechanism,
            law=law,
            period=self.duration(mechanism, value, y),
            residual=np.zeros_like(shot.residual),
            error=0.0,
            off=np.append(y - shot.y, value - shot.value),
        )

    def stretch(self, mechanism: Mechanism, value: float, path: str) -> float:
        """Return how the period changes with a parameter, m dT/dp."""
        if path != self.path:
            if self.period is not None or not path.startswith("mechanism."):
                return 0.0
            value = value_of(mechanism, self.law, path)
        elif self.power is not None:
            return self.power * self.duration(mechanism, value) / value if self.power else 0.0
        h = PERIOD_STEP * (abs(value) or 1.0)
        near = (replaced(mechanism, "mechanism", path, value + s) for s in (h, -h))
        above, below = map(cycle_of, near)
        return self.cycles * (above - below) / (2.0 * h)

    def orbit(self, shot: Shot) -> Orbit:
        """Return the orbit that a shot has closed."""
        begin = dict(zip(self.names, shot.y.tolist(), strict=True))
        if self.section is not None:
            begin[self.section.state] = self.section.at(shot.mechanism)
        start = initial_state("orbit", shot.mechanism, shot.law, begin)
        events = shot.run.events()
        return Orbit(
            mechanism=shot.mechanism,
            law=shot.law,
            cycles=self.cycles,
            period=shot.period,
            start=dict(zip(self.states, start, strict=True)),
            free=tuple(name for name in self.unknowns if name != CYCLE),
            advance=self.advances(shot),
            monodromy=shot.monodromy,
            residual=shot.error,
            events=events,
            modes=first_modes(shot.mechanism, shot.run, events),
            solver=self.solver,
            section=self.section,
        )

    def advances(self, shot: Shot) -> dict[str, float]:
        """Return how far each coordinate comes on which nothing depends, or that is carried."""
        moving = [self.states[i] for i in self.moving]
        carried = {q: float(v) * shot.period for q, v in shot.mechanism.carried().items()}
        return carried | dict(zip(moving, shot.advance.tolist(), strict=True))


_EPSILON, _TINY = float(np.finfo(float).eps), float(np.finfo(float).tiny)
_BACKWARD = np.array([1.5, -2.0, 0.5]) / END_STEP
_SHARES = np.append(np.linspace(0.0, 1.0, ORBIT_TIMES), 1.0 - END_STEP * np.array([1.0, 2.0]))


def value_of(mechanism: Mechanism, law: FrictionLaw | Laws, path: str) -> float:
    """Return the value of the parameter at a full path."""
    prefix = path.partition(".")[0]
    known = parameters(law if prefix == "friction" else mechanism, prefix)
    return next(float(value) for full, _, value in known if full == path)


def placed(
    owner: str, orbit: Orbit, path: str, between: tuple[float, float]
) -> tuple[str, float, str]:
    """Return the full path, value and unit of a parameter that an orbit has within a range."""
    mechanism, law, (low, high) = orbit.mechanism, orbit.law, between
    check_path(owner, path)
    full, _ = axis_of(mechanism, law, path, [low, high])
    check_path(owner, full)
    value, unit = value_of(mechanism, law, full), unit_of(mechanism, law, full)
    if not low <= value <= high:
        raise InputError(
            f"{owner}: {full} of the orbit is {quantity(value, unit, 6)}, outside of"
            f" {number(low, 6)} to {quantity(high, unit, 6)}: give a range around it, or begin with"
            " an orbit inside."
        )
    return full, value, unit


def map_of(orbit: Orbit, cycles: int, period: float | None, path: str) -> ReturnMap:
    """Return the map of an orbit over a parameter, with the states that are solved for in it."""
    section, cycle = orbit.section, orbit.period / orbit.cycles if orbit.section else None
    result = return_map(
        orbit.mechanism, orbit.law, cycles, period, orbit.solver, path, section, cycle
    )
    if set(result.unknowns) - {CYCLE} == set(orbit.free):
        return result
    free, states = (*orbit.free, *((section.state,) if section else ())), result.states
    return replace(
        result,
        free=tuple(i for i, name in enumerate(states) if name in free),
        moving=tuple(states.index(q) for q in orbit.advance if q not in free),
    )


def refuse_cut(mechanism: Mechanism, period: float) -> None:
    """Refuse the length of an orbit after which a drive does not repeat itself."""
    for name, drive in mechanism.drives().items():
        for own in filter(None, (part.repeats() for part in parts_of(drive))):
            ratio = period / own
            if not abs(ratio - round(ratio)) <= CUT * ratio:
                raise InputError(
                    f"{type(mechanism).__name__}: the drive {name!r} repeats itself after"
                    f" {number(own, 8)} s, and an orbit of {number(period, 8)} s holds"
                    f" {number(ratio, 8)} of that: no orbit closes then. Give a period after"
                    " which all drives repeat themselves."
                )


def refuse_late(mechanism: Mechanism) -> None:
    """Refuse drives that are 0 at first: their first cycle is another than those that follow."""
    for name, drive in mechanism.drives().items():
        for part in parts_of(drive):
            own, pieces = part.repeats(), part.pieces()
            if own and pieces and float(pieces[0].start) > CUT * own:
                raise InputError(
                    f"{type(mechanism).__name__}: the drive {name!r} begins at"
                    f" {number(float(pieces[0].start), 4)} s, so that its first cycle is another"
                    " than those that follow. Let it begin a whole number of periods earlier, at"
                    " time 0 or before."
                )


def return_map(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    cycles: int,
    period: float | None,
    solver: EventDriven,
    path: str | None = None,
    section: Section | None = None,
    cycle: float | None = None,
) -> ReturnMap:
    """Return the map whose fixed points are sought, with its free states.

    With a section the length of a cycle is unknown, of which only the size is given.
    """
    refuse_late(mechanism)
    states = states_of(mechanism, law)
    prescribed = {
        name
        for q, rate in zip(mechanism.coordinates, mechanism.rates, strict=True)
        if q in mechanism.guided()
        for name in (q, rate)
    }
    cycle = cycle or (cycle_of(mechanism) if period is None else period)
    moving = _translations(mechanism, law, states, prescribed, cycle, solver)
    known = prescribed | set(moving)
    return ReturnMap(
        mechanism=mechanism,
        law=law,
        cycles=cycles,
        period=period,
        solver=solver,
        states=states,
        free=tuple(i for i, name in enumerate(states) if name not in known),
        moving=tuple(states.index(name) for name in moving),
        section=section,
        path=path,
    )


def _translations(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    states: tuple[str, ...],
    prescribed: set[str],
    cycle: float,
    solver: EventDriven,
) -> tuple[str, ...]:
    """Return the coordinates on which nothing depends.

    Along such a coordinate the derivative of all states is that of a translation, in any motion:
    one is run in which all contacts slip, as what is stuck hides what its place does.
    """
    stopped = {stop.coordinate for stop in stops_of(mechanism)}
    free = [q for q in mechanism.coordinates if q not in prescribed and q not in stopped]
    rates = {r: TRIAL_RATE for r in mechanism.rates if r not in prescribed}
    start = initial_state("orbit", mechanism, law, {**mechanism.start(), **rates})
    run = solver.bare(mechanism, law, y0=start, t_end=TRIAL_SHARE * cycle)
    if not free or not run.status.complete:
        return ()
    result = run.differentiate(
        np.array([TRIAL_SHARE * cycle]), [f"initial.{name}" for name in free]
    )[0]
    exact = np.array([[float(name == q) for q in free] for name in states])
    return tuple(
        q
        for q, gap in zip(free, np.abs(result - exact).max(axis=0), strict=True)
        if gap <= ROUNDING
    )


def solved(map_: ReturnMap, y: Array, value: float = np.nan) -> Shot:
    """Return the shot that closes, by Newton's steps at a fixed value of the parameter.

    Steps that do not converge, and runs as `ReturnMap.shoot` refuses, are a `SimulationError`.
    """
    shot = map_.shoot(y, value).sensed()
    for _ in range(MOST_STEPS):
        if shot.error <= map_.tolerance:
            return shot
        # Scaled by the sizes of states, by which least squares choose within a continuum.
        matrix = shot.jacobian[:, : len(shot.y)] * shot.scale / shot.scale[:, None]
        step = -np.linalg.lstsq(matrix, shot.residual / shot.scale, rcond=1e-12)[0] * shot.scale
        better = _halved(map_, shot, step)
        if better is None:
            break
        shot = better
    if shot.error <= map_.tolerance:
        return shot
    raise SimulationError(
        f"the search for a periodic orbit of {map_.cycles} cycle{'s' * (map_.cycles != 1)} does not"
        f" converge: after {number(shot.period, 4)} s the motion is {number(shot.error, 2)} of its"
        " size from its start. Settle longer, start nearer, or give another number of cycles."
    )


def _halved(map_: ReturnMap, shot: Shot, step: Array) -> Shot | None:
    """Return the shot after a step, halved until it closes better; None if it never does.

    Near the orbit the first step may close worse: the derivative jumps where a phase of sticking
    begins, and only the second one is right.
    """
    for half in range(MOST_HALVINGS):
        try:
            other = map_.shoot(shot.moved(shot.y + 0.5**half * step), shot.value).sensed()
        except (SimulationError, InputError):
            continue  # a shorter step may not leave where runs are made
        # by the size of the states before: in a run that has left them any residual is small
        error = float((np.abs(other.residual) / shot.scale).max(initial=0.0))
        if error < shot.error or (half == 0 and error < NEAR):
            return other
    return None


def first_modes(mechanism: Mechanism, run: BareRun, events: Sequence[Event]) -> dict[str, int]:
    """Return the mode of each contact at the start of a run."""
    names = [contact.name for contact in mechanism.contacts()]
    modes: dict[str, int] = {}
    for event in events:
        if event.from_mode != event.to_mode:
            modes.setdefault(event.contact, event.from_mode)
    if not set(names) <= modes.keys():
        columns = run.playback(np.array([0.5 * run.differentiate.t_end]))
        for name in names:
            column = columns["mode"] if "mode" in columns else columns[f"mode:{name}"]
            modes.setdefault(name, int(column[0]))
    return {name: modes[name] for name in names}


def _stuck(events: Sequence[Event], contact: str, mode: int, period: float) -> float:
    """Return how long a contact sticks [s]."""
    total, since = 0.0, 0.0
    for event in events:
        if event.contact == contact and event.from_mode != event.to_mode:
            total += (event.t - since) * (mode == 0)
            since, mode = event.t, event.to_mode
    return total + (period - since) * (mode == 0)
