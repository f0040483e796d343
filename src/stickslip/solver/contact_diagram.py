"""A mechanism with several contacts as blocks of a diagram, from the parts of its equations."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Self, final

from typing_extensions import override

from stickslip.errors import InputError
from stickslip.formulation import PAINLEVE, Model, contact_model, formulate
from stickslip.friction import FrictionLaw, Laws
from stickslip.kernels.contacts.assembly import prepare, put_motion, refresh
from stickslip.kernels.contacts.decisions import strike_stops
from stickslip.kernels.contacts.motion import law_flags, slip_rate, supply
from stickslip.kernels.contacts.transitions import rubs, set_own_flags
from stickslip.kernels.equations import ENERGY, LIMITS, LOADS, evaluate, turn_states
from stickslip.kernels.mode_transitions import wall_coordinate, wall_side
from stickslip.kernels.state_layout import (
    ACCELERATION,
    BACKWARD,
    BRISTLE_RATES,
    BRISTLES,
    CONSTANT_LOADS,
    FIRST_WALL,
    FLAGS,
    FORWARD,
    FREE,
    FRICTION,
    HELD_FAST,
    LEVELS,
    LOAD,
    MODES,
    MOTION_POINT,
    N_CONTACTS,
    N_COORDINATES,
    N_STATES,
    N_SWITCHES,
    N_WALLS,
    NEEDED,
    OPEN,
    PUSHED,
    REACTS,
    RIGID,
    SLIPS,
    TIME,
    VALUES,
    WALL_COLUMNS,
    WALLS,
    Y,
)
from stickslip.mechanisms import Mechanism, stops_of
from stickslip.solver.block_diagram import BlockDiagram, BreakAway, Lead, check_within, leads_of
from stickslip.solver.drive_schedule import gather
from stickslip.solver.evaluator import Equations

GAINED = 2.0
"""Most speed, over that which the press gives in a step, that a hop gains in forward Euler steps:
bounces that lose no more would never end."""
UNRESOLVED = 5.0
"""Speed after an impact, over the same, up to which its rebound may be left out."""
OPENED = 3.0
"""Mode of a contact without load, as columns have it."""


class Wall(NamedTuple):
    """A hard stop of a coordinate."""

    place: int
    """Index of the coordinate in the state."""
    side: int
    """1 above, -1 below."""
    position: float
    """Where it is."""
    restitution: float
    """Speed after an impact over the speed before."""

    def margin(self, y: Sequence[float]) -> float:
        """Return the distance from the stop."""
        return self.side * (self.position - y[self.place])


@final
@dataclass(frozen=True)
class ContactDiagram(BlockDiagram):
    """Evaluates forces and rates of a mechanism with several contacts, and nothing else.

    States are those of the equations, in which every independent slip is a coordinate. While
    contacts along a coordinate are held, its acceleration is 0 and the friction there is what that
    takes. Loads that are reactions are worked out together with friction.
    """

    model: Model
    """Parts of the equations."""
    equations: Equations
    """Their numbers."""
    slips: tuple[int, ...]
    """Index in the state of the rate of each coordinate that a contact or a stop may hold."""
    walls: tuple[Wall, ...]
    """Hard stops."""
    leads: tuple[Lead, ...]
    """Guided coordinates, which are set before rates are asked for."""
    break_away: BreakAway
    """Friction of a body at rest that is not held."""
    asked: list[Any] = field(default_factory=list, compare=False, repr=False)
    """State, time, held and pushed coordinates at which everything was last worked out."""
    losses: list[float] = field(default_factory=list, compare=False, repr=False)
    """Energies that impacts have taken [J]."""

    @classmethod
    def build(
        cls,
        mechanism: Mechanism,
        law: FrictionLaw | Laws,
        t_end: float,
        y0: Sequence[float],
        break_away: BreakAway,
    ) -> Self:
        """Derive the parts of the equations."""
        stops = bool(stops_of(mechanism))
        model = contact_model(mechanism, law) if stops else formulate(mechanism, law)
        if model.closing:
            raise InputError(
                f"{type(mechanism).__name__}: the slips of {', '.join(model.closing)} follow from"
                " those of others, with which block diagrams and fixed steps do not decide who"
                " holds: use EventDriven, or give them no law (None)."
            )
        if model.latched:
            raise InputError(
                f"{model.title} has latched switches, which fixed steps follow with one contact"
                " alone: use EventDriven."
            )
        equations = Equations(model, gather(mechanism, law, model, t_end))
        w, whole = equations.w, equations.whole
        first, n = whole[SLIPS], whole[N_COORDINATES]
        slips = {n + whole[first + c] for c in range(whole[N_CONTACTS])}
        w[whole[Y] : whole[Y] + whole[N_STATES]] = y0
        for _ in range(whole[N_SWITCHES]):
            set_own_flags(0, w, whole)
        prepare(0.0, w, whole)  # gives the change of coordinates, too
        walls = tuple(
            Wall(wall_coordinate(k, whole), wall_side(k, whole), *_numbers_of(k, w, whole))
            for k in range(whole[N_WALLS])
        )
        held = tuple(sorted(slips | {n + wall.place for wall in walls}))
        return cls(model, equations, held, walls, leads_of(mechanism, y0), break_away)

    @property
    @override
    def coordinates(self) -> int:
        return int(self.equations.whole[N_COORDINATES])

    @property
    @override
    def columns(self) -> tuple[str, ...]:
        contacts = self.model.contacts
        kinds = ("friction", "normal_force", "mode")
        own = tuple(f"{kind}:{name}" for kind in kinds for name in contacts)
        return (*self.model.states, *(kinds if self.model.alone else own))

    @property
    @override
    def contacts(self) -> tuple[str, ...]:
        return () if self.model.alone else self.model.contacts

    def _put(self, t: float, y: Sequence[float]) -> None:
        w, whole = self.equations.w, self.equations.whole
        first = whole[Y]
        w[first : first + whole[N_STATES]] = y
        w[TIME] = t

    def _turned(self, y: Sequence[float], back: int) -> list[float]:
        """Return a state in coordinates of the equations, or back in those of the mechanism."""
        w, whole = self.equations.w, self.equations.whole
        first, count = whole[Y], whole[N_STATES]
        w[first : first + count] = y
        turn_states(first, back, w, whole)
        self.asked.clear()
        return [float(x) for x in w[first : first + count]]

    @override
    def begun(self, y0: Sequence[float]) -> list[float]:
        return self._turned(y0, 0)

    @override
    def led(self, t: float, y: list[float]) -> list[float]:
        if not self.leads:
            return y
        return self._turned(super().led(t, self._turned(y, 1)), 0)

    def _at(
        self,
        t: float,
        y: Sequence[float],
        held: tuple[bool, ...],
        pushed: Mapping[int, int] | None = None,
    ) -> tuple[list[Any], list[int]]:
        """Work everything out at a state, with some coordinates held; return where it stands.

        Of coordinates at rest that are not held, `pushed` has the directions.
        """
        w, whole = self.equations.w, self.equations.whole
        asked: list[Any] = [t, held, dict(pushed or {})]
        if self.asked and self.asked[0] is y and self.asked[1:] == asked:
            return w, whole
        self.equations.load_at(t)
        self._put(t, y)
        set_own_flags(0, w, whole)
        if not whole[CONSTANT_LOADS]:
            evaluate(LOADS, 0, whole[FLAGS], t, w, whole[Y], whole[LOAD])
        for c in range(whole[N_CONTACTS]):
            closed = whole[whole[REACTS] + c] or w[whole[LOAD] + c] > 0.0
            whole[whole[OPEN] + c] = 0 if closed else 1
        n, modes = whole[N_COORDINATES], whole[MODES]
        kept = dict(zip(self.slips, held, strict=True))
        for i in range(n):
            rate, side = y[n + i], asked[2].get(n + i, 0)
            whole[modes + i] = FORWARD if rate > 0.0 else BACKWARD if rate < 0.0 else FREE
            if rate == 0.0 and side:
                level = self.break_away == "static" and not self._bends(i)
                whole[modes + i] = side * (PUSHED if level else FORWARD)
            if kept.get(n + i):
                whole[modes + i] = HELD_FAST
            elif not rubs(i, whole):
                whole[modes + i] = FREE
        law_flags(t, w, whole, whole[Y])
        refresh(t, w, whole, whole[Y])
        limits = [name for name in self.model.limits if name != PAINLEVE]
        if limits:
            put_motion(w, whole, whole[Y])
            evaluate(LIMITS, 0, whole[FLAGS], t, w, whole[MOTION_POINT], whole[VALUES])
            check_within(dict(zip(limits, w[whole[VALUES] :], strict=False)), t)
        self.asked[:] = [y, *asked]
        return w, whole

    @override
    def holds(self, t: float, y: Sequence[float], held: Sequence[bool]) -> tuple[bool, ...]:
        if not any(held):
            return tuple(held)
        kept, _ = self._decided(t, y)
        return tuple(a and b for a, b in zip(kept, held, strict=True))

    def _decided(self, t: float, y: Sequence[float]) -> tuple[tuple[bool, ...], dict[int, int]]:
        """Return which coordinates at rest stay there, and where others are pushed."""
        whole = self.equations.whole
        n, rigid = whole[N_COORDINATES], whole[RIGID]
        kept = tuple(
            own or (y[slip] == 0.0 and bool(whole[rigid + slip - n]))
            for slip, own in zip(self.slips, self.stopped(y), strict=True)
        )
        pushed: dict[int, int] = {}
        while any(kept):
            slip, side = self._weakest(t, y, kept, pushed)
            if side == 0:
                break
            pushed[slip] = side
            kept = tuple(one and slip != own for one, own in zip(kept, self.slips, strict=True))
        return kept, pushed

    def _moving(
        self, t: float, y: Sequence[float], held: Sequence[bool]
    ) -> tuple[list[Any], list[int]]:
        """Work everything out at a state, with the friction of what breaks away there."""
        resting = (y[slip] == 0.0 and not one for slip, one in zip(self.slips, held, strict=True))
        if self.break_away == "zero" or not any(resting):
            return self._at(t, y, tuple(held))
        kept, pushed = self._decided(t, y)
        n = self.coordinates
        rests = (
            own or (one and not self._bends(slip - n))
            for slip, one, own in zip(self.slips, kept, held, strict=True)
        )
        return self._at(t, y, tuple(rests), pushed)

    def _bends(self, i: int) -> bool:
        """Whether bristles carry friction along a coordinate, whatever holds them at rest."""
        whole = self.equations.whole
        return any(
            whole[whole[SLIPS] + c] == i and whole[whole[BRISTLES] + c] >= 0
            for c in range(whole[N_CONTACTS])
        )

    def _weakest(
        self, t: float, y: Sequence[float], held: tuple[bool, ...], pushed: Mapping[int, int]
    ) -> tuple[int, int]:
        """Return the held slip that exceeds its level most and where it is pushed, 0 if none."""
        w, whole = self._at(t, y, held, pushed)
        n, found, excess = whole[N_COORDINATES], (0, 0), 0.0
        for slip, one in zip(self.slips, held, strict=True):
            needed = float(w[whole[NEEDED] + slip - n])
            level = float(w[whole[LEVELS] + 2 * (slip - n) + (0 if needed >= 0.0 else 1)])
            if not one or (abs(needed) <= level and self._may_hold(slip - n, y)):
                continue
            beyond = abs(needed) / level if level > 0.0 else math.inf
            if beyond > excess:
                found, excess = (slip, 1 if needed > 0.0 else -1), beyond
        return found

    def _may_hold(self, i: int, y: Sequence[float]) -> bool:
        """Whether a closed contact, or a stop at which it is, can hold a coordinate."""
        at_stop = any(wall.place == i and wall.margin(y) == 0.0 for wall in self.walls)
        return at_stop or rubs(i, self.equations.whole)

    @property
    @override
    def lost(self) -> float:
        return sum(self.losses)

    @override
    def stopped(self, y: Sequence[float]) -> tuple[bool, ...]:
        n = self.coordinates
        at = {n + wall.place for wall in self.walls if wall.margin(y) == 0.0}
        return tuple(slip in at and y[slip] == 0.0 for slip in self.slips)

    @override
    def struck(
        self, t: float, dt: float, y: list[float], held: tuple[bool, ...]
    ) -> tuple[list[float], tuple[bool, ...]]:
        n, beyond = self.coordinates, [k for k, wall in enumerate(self.walls) if wall.margin(y) < 0]
        if not beyond:
            return y, held
        depths = {k: -self.walls[k].margin(y) for k in beyond}
        y = [*y]
        for wall in (self.walls[k] for k in beyond):
            y[wall.place] = wall.position
        hits = [k for k in beyond if self.walls[k].side * y[n + self.walls[k].place] > 0.0]
        w, whole = self._at(t, y, held)
        pushes = {k: w[whole[ACCELERATION] + self.walls[k].place] for k in hits}
        for k in hits:
            wall = self.walls[k]
            speed, push = wall.side * y[n + wall.place], wall.side * pushes[k]
            met = max(speed - push * min(dt, depths[k] / speed), 0.0)  # as it reached the stop
            e = wall.restitution
            ends = (1.0 - e) * met <= GAINED * push * dt and e * met <= UNRESOLVED * push * dt
            w[_row_of(k, whole) + 1] = 0.0 if ends else e * met / speed
        if hits:
            before = self._energy(t)
            strike_stops(whole[FIRST_WALL] + hits[0], w, whole)
            y = [float(x) for x in w[whole[Y] : whole[Y] + whole[N_STATES]]]
            self.asked.clear()
            self.losses.append(before - self._energy(t))
        stays = zip(self.slips, held, self.stopped(y), strict=True)
        kept = tuple(rests or (own and y[slip] == 0.0) for slip, own, rests in stays)
        return y, self.holds(t, y, kept)

    def _energy(self, t: float) -> float:
        """Return the mechanical energy of the state at hand."""
        w, whole = self.equations.w, self.equations.whole
        evaluate(ENERGY, 0, whole[FLAGS], t, w, whole[Y], whole[VALUES])
        return float(w[whole[VALUES]])

    @override
    def rates(self, t: float, y: Sequence[float], held: Sequence[bool]) -> list[float]:
        w, whole = self._moving(t, y, held)
        n, states = whole[N_COORDINATES], whole[N_STATES]
        first, bristles = whole[ACCELERATION], whole[BRISTLE_RATES]
        return [*y[n : 2 * n], *w[first : first + n], *w[bristles : bristles + states - 2 * n]]

    @override
    def sample(self, t: float, y: Sequence[float], held: Sequence[bool]) -> list[float]:
        w, whole = self._moving(t, y, held)
        count, friction, load = whole[N_CONTACTS], whole[FRICTION], whole[LOAD]
        is_open = [bool(whole[whole[OPEN] + c]) for c in range(count)]
        loads = [0.0 if is_open[c] else w[load + c] for c in range(count)]
        modes = []
        for c in range(count):
            sticks = whole[whole[MODES] + whole[whole[SLIPS] + c]] == HELD_FAST
            v = 0.0 if sticks else slip_rate(c, w, whole, whole[Y])
            modes.append(OPENED if is_open[c] else float((v > 0) - (v < 0)))
        forces = w[friction : friction + count]
        row = [float(x) for x in (*forces, *loads, *modes)]
        return [t, *self._turned(y, 1), *row]

    @override
    def lifts(self, row: Sequence[float]) -> bool:
        whole, count = self.equations.whole, self.equations.whole[N_CONTACTS]
        loads = row[1 + whole[N_STATES] + count :][:count]
        return any(whole[whole[REACTS] + c] and load < 0.0 for c, load in enumerate(loads))

    @override
    def balance(
        self, t: float, y: Sequence[float], held: Sequence[bool], row: Sequence[float]
    ) -> tuple[float, ...]:
        w, whole = self._moving(t, y, held)
        values, at = whole[VALUES], whole[Y]
        energy = self._energy(t)
        supply(t, w, whole, at, values)
        supplied = float(w[values])
        taken = [
            float(w[whole[FRICTION] + c] * slip_rate(c, w, whole, at))
            for c in range(whole[N_CONTACTS])
        ]
        return energy, supplied, *taken


def _row_of(wall: int, whole: Sequence[int]) -> int:
    """Return where position and restitution of a stop stand."""
    return whole[WALLS] + wall * whole[WALL_COLUMNS]


def _numbers_of(wall: int, w: Sequence[Any], whole: Sequence[int]) -> tuple[float, float]:
    """Return position and restitution of a stop."""
    at = _row_of(wall, whole)
    return float(w[at]), float(w[at + 1])
