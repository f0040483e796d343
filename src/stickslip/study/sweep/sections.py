"""Sections at which cycles of unknown period begin, and cycles between them in settled runs.

Nothing tells where a self-excited cycle begins. It is cut where a state passes a level upwards:

1. Where a belt carries a coordinate along, its rate passes the speed of the belt: the coordinate
   turns back as seen by what stands still, which it does once in each phase of slip.
2. Elsewhere the first coordinate, or else rate, that comes back passes the middle of its range.

Runs are made four times as long until the section was passed often enough. Of their dense output
signs are looked at between all steps, and changes of sign are bisected.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.solver import BareRun, EventDriven
from stickslip.engine.trajectory import Status
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity
from stickslip.show.described import Described
from stickslip.show.formatting import number

Array = NDArray[np.float64]

FIRST_LENGTH, LONGER = 1e-3, 4.0
"""Length of the first run [s], and by how much the next one is longer."""
FEWEST_STEPS, LONGEST = 5000, 1e9
"""Steps, or length [s], of a run in which a section is passed at most once: it comes to rest, or
slides on."""
BETWEEN, BISECTIONS = 8, 60
"""Parts of a step at whose ends signs are looked at, and bisections of a change of sign."""
STEADY = 1e-6
"""Range of all states in a cycle, over their size, of a motion that is steady sliding."""


@dataclass(frozen=True)
class Section(metaclass=Described):
    """Where cycles of unknown period begin: a state passes a level upwards."""

    state: str
    """The state."""
    level: float | None
    """The level; with None it is a rate that passes the speed at which it is carried."""

    def at(self, mechanism: Mechanism) -> float:
        """Return the level for a mechanism."""
        if self.level is not None:
            return self.level
        coordinate = mechanism.coordinates[mechanism.rates.index(self.state)]
        return float(mechanism.carried().get(coordinate, 0.0))


def speeds_of(mechanism: Mechanism, states: Sequence[str]) -> Array:
    """Return how fast each state is carried along (n,).

    Examples
    --------
    >>> from stickslip import TowedBlock
    >>> speeds_of(TowedBlock(mass=1.0, stiffness=2.0, speed=0.1), ("x", "v"))
    array([0.1, 0. ])
    """
    carried = mechanism.carried()
    return np.array([float(carried.get(name, 0.0)) for name in states])


@dataclass(frozen=True)
class Passes:
    """Where a settled run passed its section last."""

    section: Section | None
    """The section; None if there is none."""
    times: Array
    """When it passed (n,) [s]."""
    starts: Array
    """All states then (n, states), as if each were at time 0."""
    status: Status
    """How the run ended."""
    lack: str
    """Why there is no cycle; empty if there is one."""


def passes_of(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    states: Sequence[str],
    begin: Sequence[float],
    solver: EventDriven,
    least: int,
    section: Section | None = None,
) -> Passes:
    """Return how a run passes its section, at least a number of times if there is a cycle."""
    speeds, length = speeds_of(mechanism, states), FIRST_LENGTH
    while True:
        run = solver.bare(mechanism, law, y0=begin, t_end=length)
        if not run.status.complete:
            none = np.empty((0, len(states)))
            rests = run.status is Status.ZENO and comes_to_rest(mechanism, run)
            lack = "there is no cycle: the motion comes to rest." if rests else ""
            lack = lack or f"settling: {run.status.value}"
            return Passes(section, none[:, 0], none, run.status, lack)
        steps = run.playback.times()
        inner = (steps[:-1, None] + np.diff(steps)[:, None] * np.arange(BETWEEN) / BETWEEN).ravel()
        times = np.append(inner, steps[-1])
        seen = run.at(times) - times[:, None] * speeds
        here = section or _chosen(mechanism, states, seen[times >= 0.5 * length])
        result = np.empty(0) if here is None else _passes(mechanism, states, run, here, times, seen)
        if len(result) >= least or (
            (len(steps) > FEWEST_STEPS or length > LONGEST) and len(result) < 2
        ):
            break
        length *= LONGER
    starts, lack = run.at(result) - result[:, None] * speeds, ""
    if len(result) < max(least, 2):
        what = "nothing moves to and fro"
        if here is not None:
            level = number(here.at(mechanism), 4)
            what = f"{here.state} passes {level} upwards at most once"
        lack = (
            f"there is no cycle: in {number(length, 3)} s {what}. It comes to rest, or slides"
            " steadily; begin elsewhere, or give the section that it passes."
        )
    else:
        lap = seen[(times >= result[-2]) & (times <= result[-1])]
        if (np.ptp(lap, axis=0) <= STEADY * np.abs(lap).max(axis=0)).all():
            lack = "there is no cycle: the motion becomes steady sliding."
    return Passes(here, result, starts, run.status, lack)


def comes_to_rest(mechanism: Mechanism, run: BareRun) -> bool:
    """Whether all that moves stays where it is in the last tenth of a run, as places and rates.

    At rest rounding decides which way a body without static friction begins to slip, so that events
    may accumulate there. Numbers of a controller may go on.

    Examples
    --------
    >>> from stickslip import Axis, Viscous
    >>> axis, solver = Axis(inertia=1.0, stiffness=100.0), EventDriven()
    >>> y0 = [0.1, 0.0]
    >>> run = solver.bare(axis, Viscous(viscous_coefficient=20.0), y0=y0, t_end=5.0)
    >>> comes_to_rest(axis, run)
    True
    """
    times = run.playback.times()
    seen = run.at(times)
    pairs = zip(mechanism.coordinates, mechanism.rates, strict=True)
    known = [run.states.index(x) for q, v in pairs if q not in mechanism.computed for x in (q, v)]
    range_, late = np.ptp(seen[:, known], axis=0), seen[times >= 0.9 * times[-1]][:, known]
    return bool(range_.any() and (np.ptp(late, axis=0) <= STEADY * range_).all())


def given_section(states: Sequence[str], given: Mapping[str, float] | None) -> Section | None:
    """Return a section that is given by a state and its level.

    Examples
    --------
    >>> given_section(("x", "v"), {"v": 0.1})
    Section(state='v', level=0.1)
    """
    if given is None:
        return None
    if len(given) != 1:
        raise InputError(
            f"section must name one state and its level, such as {{'v': 0.01}}, got {given!r}."
        )
    ((state, level),) = given.items()
    if state not in states:
        raise UnknownNameError("state", state, states)
    return Section(state, Quantity(state).check("periodic_orbit", "section", level))


def _chosen(mechanism: Mechanism, states: Sequence[str], tail: Array) -> Section | None:
    """Return the section that a settled run passes; None if there is none yet."""
    carried = mechanism.carried()
    for name, rate in zip(mechanism.coordinates, mechanism.rates, strict=True):
        if carried.get(name, 0.0) != 0.0:
            return Section(rate, None)
    for k, state in enumerate(states):
        level = 0.5 * float(tail[:, k].min() + tail[:, k].max())
        above = tail[:, k] > level
        if np.count_nonzero(above[1:] & ~above[:-1]) > 1:
            return Section(state, level)
    return None


def _passes(
    mechanism: Mechanism,
    states: Sequence[str],
    run: BareRun,
    section: Section,
    times: Array,
    seen: Array,
) -> Array:
    """Return when a run passes a section upwards."""
    at, level = states.index(section.state), section.at(mechanism)
    speed = speeds_of(mechanism, states)[at]
    below = seen[:, at] < level
    (index,) = np.nonzero(below[:-1] & ~below[1:])
    low, high = times[index], times[index + 1]
    for _ in range(BISECTIONS if len(index) else 0):
        middle = 0.5 * (low + high)
        under = run.at(middle)[:, at] - middle * speed < level
        low, high = np.where(under, middle, low), np.where(under, high, middle)
    return np.asarray(high)
