"""Runs of a mechanism with a law by Taylor series, with the modes driven by hand.

Steps are Taylor series to rounding, and events are roots of the series of their guards. The normal
force must stay above zero: there is no lift-off here.
"""

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import heyoka as hy
import numpy as np
from numpy.typing import NDArray
from tests.reference.heyoka_equations import Equations, equations

from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import parameters

STOP, BREAK_FORWARD, BREAK_BACKWARD, SWITCH = range(4)
"""Index of each guard among the events of the integrator; switch j has index SWITCH + j."""

NUDGE = 1e-20
"""Speed [m/s] with which a body that was held starts to slip, far below rounding.

Where force and level balance, rounding decides the sign of the first acceleration, and so whether a
body that breaks away seems to stop at once.
"""

FIRST = 1e-9
"""Length [s] of the first step after an event.

Of a guard that begins at zero heyoka can overlook the other roots in the same step.
"""

EVENT_LIMIT = 1000
"""Events after which a run is given up."""

CONFIRMED = 1e-13
"""Largest error of a step by its defect, over the sizes of the states."""
CHECKED = (0.25, 0.5, 0.75, 1.0)
"""Fractions of a step at which its series is checked against the equations."""
STANDING = 1e-12
"""Share of the largest margin of a switch so far below which it stands on its threshold."""
GROWTH = 4.0
"""Length of a step over the one before, at most: of what had to be halved most will be again."""
COMMON = (hy.taylor_outcome.success, hy.taylor_outcome.time_limit)
"""Outcomes of a step that ends with no event."""
SHORTEST = 1e-9
"""Length [s] of a step that is not halved.

It is a share of 1e-9 of what moves a state by its size, and a bend bends the rates within it as
little; from rest a broken power of the speed has a large defect over a speed that is nothing yet.
"""

COMPILED: dict[tuple[Any, ...], tuple[Any, Any]] = {}
"""Integrators and functions by their equations (whose text heyoka cuts after 1000 characters)."""


@dataclass(frozen=True)
class Happening:
    """An event: when, mode before, mode after, and what happened in words."""

    t: float
    from_mode: int
    to_mode: int
    reason: str
    slope: float = math.inf
    """At a stop or a reversal the acceleration [m/s^2] with which it was reached."""


@dataclass
class Path:
    """What a run gives: states, friction, normal force and mode at the times asked for; events."""

    rows: list[NDArray[np.float64]] = field(default_factory=list)
    events: list[Happening] = field(default_factory=list)


def _machines(model: Equations) -> tuple[Any, Any]:
    """Return the integrator, and the function that looks at a state.

    The function gives friction, normal force, both break-away levels, acceleration, margins, rates.
    """
    stuck, direction = (hy.par[model.numbers[name]] for name in ("stuck", "direction"))
    velocity, acceleration = model.rates[model.slip]
    ahead, back = model.levels
    guards = [
        direction * velocity + stuck,
        stuck * (ahead - model.friction) + (1.0 - stuck),
        stuck * (back + model.friction) + (1.0 - stuck),
        *[hy.par[model.numbers[switch.side]] * switch.margin for switch in model.switches],
    ]
    margins = [switch.margin for switch in model.switches]
    rates = [rate for _, rate in model.rates]
    outputs = [model.friction, model.normal, ahead, back, acceleration, *margins, *rates]
    key = tuple(model.rates), tuple(guards), tuple(outputs)
    if key not in COMPILED:
        falling = hy.event_direction.negative
        integrator = hy.taylor_adaptive(
            model.rates,
            [0.0] * len(model.rates),
            t_events=[hy.t_event(guard, direction=falling) for guard in guards],
            opt_level=0,  # optimising takes longer than all runs
        )
        look = hy.cfunc(outputs, vars=[state for state, _ in model.rates], opt_level=0)
        COMPILED[key] = integrator, look
    return COMPILED[key]


class Oracle:
    """A mechanism with a law, ready to be run."""

    def __init__(self, mechanism: Mechanism, law: FrictionLaw) -> None:
        self.model = equations(mechanism, law)
        self.integrator, self.look = _machines(self.model)
        self.drives = mechanism.drives()
        self.bristles = law.states
        self.can_stick = not law.states or law.static_switch
        self.numbers = dict.fromkeys(self.model.numbers, 0.0)  # in the order of their indices
        for root, prefix in ((mechanism, "mechanism"), (law, "friction")):
            self.numbers |= {path: value for path, _, value in parameters(root, prefix)}
        self.mode = 0
        self.sizes = np.zeros(len(self.model.rates))
        self.reached = np.zeros(len(self.model.switches))
        self.path = Path()

    def run(self, y0: Sequence[float], times: Iterable[float], t_end: float) -> Path:
        """Run from time 0 to `t_end`, and look at times in between."""
        ta = self.integrator
        ta.time, ta.state[:] = 0.0, y0
        self.path, self.sizes = Path(), np.abs(ta.state)
        self.reached = np.zeros(len(self.model.switches))
        self.numbers |= {switch.side: 0.0 for switch in self.model.switches}
        self._enter(int(np.sign(ta.state[self.model.slip])))
        starts = {piece.start for drive in self.drives.values() for piece in drive.pieces()}
        edges = sorted({0.0, t_end} | {start for start in starts if 0.0 < start < t_end})
        wanted = sorted(times)
        for begin, end in itertools.pairwise(edges):
            ta.time = begin
            for name, drive in self.drives.items():
                self._load_piece(name, drive, begin)
            self._judge()
            self._follow([t for t in wanted if begin < t <= end], end)
        return self.path

    def _follow(self, times: list[float], end: float) -> None:
        """Go from event to event up to `end`."""
        ta, longest = self.integrator, FIRST
        while ta.time < end:
            guard, length = self._step(longest, end, times)
            longest = GROWTH * length
            if guard is not None:
                assert len(self.path.events) < EVENT_LIMIT
                self._happen(guard)
                longest = FIRST

    def _step(self, longest: float, end: float, times: list[float]) -> tuple[int | None, float]:
        """Take one step that the equations confirm; return the guard that ended it, and its length.

        Times that it passed are looked at, and taken out of those still to come.
        """
        ta = self.integrator
        begin, start = ta.time, ta.state.copy()
        self.sizes = np.maximum(self.sizes, np.abs(start))
        while True:
            ta.reset_cooldowns()
            last = longest >= end - begin
            outcome, length = ta.step(min(longest, end - begin), write_tc=True)
            assert outcome in COMMON or -int(outcome) - 1 in range(len(ta.t_events)), outcome
            if length <= SHORTEST or self._defect(begin, length) <= CONFIRMED:
                break
            ta.time, ta.state[:], longest = begin, start, 0.5 * length
        if outcome == hy.taylor_outcome.time_limit and last:
            ta.time = end  # whatever the sum of both rounds to
        while times and times[0] <= ta.time:
            self._note(ta.update_d_output(times[0]), times.pop(0))
        return None if outcome in COMMON else -int(outcome) - 1, length

    def _defect(self, begin: float, length: float) -> float:
        """Return the largest error of the last step, over the sizes of the states, by its defect.

        That is the difference of the equations and the slope of the series, times the length.
        """
        series = self.integrator.tc
        powers, worst = np.arange(series.shape[1]), 0.0
        for h in [share * length for share in CHECKED]:
            state = series @ h**powers
            slopes = series[:, 1:] @ (powers[1:] * h ** powers[:-1])
            rates = self._look(state, begin + h)[-len(state) :]
            size = np.maximum(self.sizes, np.abs(state)) + np.finfo(float).tiny
            worst = max(worst, float((np.abs(rates - slopes) * length / size).max()))
        return worst

    def _note(self, state: Any, t: float) -> None:
        """Note a state down."""
        friction, normal, *_ = self._look(state, t)
        self.path.rows.append(np.array([*state, friction, normal, self.mode]))

    def _load_piece(self, name: str, drive: Drive, t: float) -> None:
        """Put in the piece of a drive that holds from a time on."""
        start, value, slope = 0.0, 0.0, 0.0
        for piece in drive.pieces():
            if piece.start <= t:
                start, value, slope = piece
        self.numbers |= {
            f"{name} value": value,
            f"{name} slope": slope,
            f"{name} start": start if slope else 0.0,  # which may be minus infinity
        }

    def _enter(self, mode: int) -> None:
        """Take up a mode."""
        ta, slip = self.integrator, self.model.slip
        self.mode = mode
        self.numbers |= {"stuck": float(mode == 0), "direction": float(mode or 1)}
        ta.pars[:] = self._vector(len(ta.pars))
        if self.can_stick and mode * ta.state[slip] <= 0.0:
            ta.state[slip] = mode * NUDGE

    def _vector(self, count: int) -> list[float]:
        """Return the numbers in order, as many as a compiled function knows of."""
        return list(self.numbers.values())[:count]

    def _look(self, state: Any, t: float) -> Any:
        """Return friction, normal force, break-away levels, acceleration, margins and rates."""
        time = {"time": t} if self.look.is_time_dependent else {}
        return self.look(state, pars=self._vector(self.look.nparams), **time)

    def _judge(self) -> None:
        """Set switches and mode as the state asks for at the start of a piece."""
        ta, before = self.integrator, self.mode
        self._turn_switches()
        if ta.state[self.model.slip] == 0.0:
            self._leave_rest()
        else:
            self._enter(before)
        if ta.time > 0.0 and before == 0 != self.mode:
            self.path.events.append(Happening(ta.time, before, self.mode, "break-away"))

    def _turn_switches(self) -> None:
        """Set switches as their margins ask for, which may have jumped.

        One that stands on its threshold is turned only if it moves away to the other side: two may
        reach their thresholds at once, and rounding must not turn any.
        """
        ta = self.integrator
        for _ in self.model.switches:  # as often as they can stand in each other
            margins, rates = self._margins(ta.state, ta.time)
            after, _ = self._margins(ta.state + FIRST * rates, ta.time + FIRST)
            self.reached = np.maximum(self.reached, np.abs(margins))
            stands = np.abs(margins) <= STANDING * self.reached
            for switch, value in zip(
                self.model.switches, np.where(stands, after - margins, margins), strict=True
            ):
                if value != 0.0 or self.numbers[switch.side] == 0.0:
                    self.numbers[switch.side] = 1.0 if value > 0.0 else -1.0
        self._enter(self.mode)

    def _margins(self, state: Any, t: float) -> tuple[Any, Any]:
        """Return the margins of the switches and the rates of the states."""
        looked = self._look(state, t)
        return looked[5 : -len(state)], looked[-len(state) :]

    def _leave_rest(self) -> None:
        """Take up the mode of a body at rest."""
        ta = self.integrator
        ta.state[self.model.slip] = 0.0
        self._enter(0)
        needed, _, ahead, back, *_ = self._look(ta.state, ta.time)
        if self.can_stick and -back <= needed <= ahead:
            return
        self._enter(self._heading() if self.bristles else int(np.sign(needed)))

    def _heading(self) -> int:
        """Return the direction in which a body that nothing holds starts from rest.

        That is where it goes within the first step: forces that balance leave their rounding.
        """
        ta = self.integrator
        self._enter(1)
        t, state = ta.time, ta.state.copy()
        state[self.model.slip] = ta.state[self.model.slip] = 0.0
        ta.step(FIRST, write_tc=True)
        series = ta.tc[self.model.slip]
        ta.time, ta.state[:] = t, state
        return -1 if series @ FIRST ** np.arange(len(series)) < 0.0 else 1

    def _happen(self, guard: int) -> None:
        """Make the transition that a guard asks for, and note it down."""
        ta, before, slope = self.integrator, self.mode, math.inf
        if guard == STOP:
            slope = float(self._look(ta.state, ta.time)[4])
            if self.can_stick:
                self._leave_rest()
            else:
                self._enter(-self.mode)
            self._turn_switches()
            reason = "stop" if self.mode == 0 else "reversal"
        elif guard < SWITCH:
            forward = 1 if guard == BREAK_FORWARD else -1
            self._enter(self._heading() if self.bristles else forward)
            self._turn_switches()
            reason = "break-away"
        else:
            switch = self.model.switches[guard - SWITCH]
            self.numbers[switch.side] *= -1.0
            self._enter(self.mode)
            self._turn_switches()
            if switch.events is None:
                return
            reason = switch.events[0 if self.numbers[switch.side] > 0 else 1]
        self.path.events.append(Happening(ta.time, before, self.mode, reason, abs(slope)))
