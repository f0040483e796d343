"""A mechanism and its friction as blocks of a diagram, evaluated literally."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self, TypeAlias

from stickslip.engine.formulation import PAINLEVE, Model, contact_model, formulate
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.contacts.assembly import prepare, put_motion, refresh
from stickslip.engine.kernels.contacts.decisions import strike_stops
from stickslip.engine.kernels.contacts.motion import law_flags, slip_rate, supply
from stickslip.engine.kernels.contacts.transitions import rubs, set_own_flags
from stickslip.engine.kernels.equations import ENERGY, LIMITS, LOADS, evaluate, turn_states
from stickslip.engine.kernels.mode_transitions import wall_coordinate, wall_side
from stickslip.engine.solver.backend import Equations
from stickslip.engine.solver.starts import gather
from stickslip.errors import InputError, SimulationError
from stickslip.friction import Coulomb, FrictionLaw, Laws, PrintedForm, bound
from stickslip.maths import Latches
from stickslip.mechanisms import Mechanism, of_contact, stops_of
from stickslip.mechanisms.drives import Drive, Profile
from stickslip.quantities import Parametrised, Quantity
from stickslip.show.formatting import quantity

FRICTION_PLACE = -3
"""Place of the friction force in a sample of one contact."""
NORMAL = -2
"""Place of its normal force."""
BreakAway: TypeAlias = Literal["zero", "kinetic", "static"]
"""Friction of a body at rest that nothing holds, in its first step."""
CREEP = 1e-300
"""Speed at which friction is that of sliding, and no curve has fallen [m/s]."""
STAND_IN = Coulomb(kinetic_coefficient=0.0)
"""The law that a mechanism's own equations are formulated with."""


def limits_of(mechanism: Mechanism) -> tuple[str, ...]:
    """Return what ends runs of a mechanism."""
    return formulate(mechanism, STAND_IN).limits


def check_within(margins: Mapping[str, float], t: float) -> None:
    """Refuse to step on where a law has no meaning, as with a factor with which friction drives."""
    for name, margin in margins.items():
        if not margin >= 0.0:
            raise SimulationError(
                f"at t = {quantity(t, 's', 6)}, {name}, where fixed steps do not end a run: use"
                " EventDriven(), or a law whose factors stay above that."
            )


@dataclass(frozen=True, kw_only=True)
class SoftConstraint(Parametrised):
    """Dry friction as a soft constraint, as MuJoCo has it.

    Friction is d times what would hold the body and brake it at a rate b, up to its level: a held
    body creeps at (1 - d) / (d b) times force over inertia.
    """

    impedance: Annotated[float, Quantity("d", above=0, high=1)]
    """Share of a held force that friction takes."""
    damping: Annotated[float, Quantity("b", "1/s", above=0)]
    """Rate at which the velocity of a held body decays."""


class Lead(NamedTuple):
    """A guided coordinate whose profile is a block of the diagram: it gives place and rate."""

    place: int
    """Index of the coordinate in the state."""
    rate: int
    """Index of its rate."""
    profile: Profile
    """The motion that the coordinate is told."""
    ahead: float
    """What the run's start adds to the profile's place."""
    faster: float
    """What the run's start adds to the profile's rate."""


@dataclass
class _State:
    """The state that the equations stand at, and what follows from it whatever friction is."""

    t: float
    y: Sequence[float]
    flags: int
    open: list[float] | None = None
    """Accelerations, normal force, needed friction and power without friction."""
    closed: tuple[float, list[float]] | None = None
    """The same with the friction force that was last asked for, and this force."""
    law: FrictionLaw | None = None
    """The law, which sees the inputs of the contact."""


class BlockDiagram(ABC):
    """Evaluates forces and rates at a time and a state, as often as asked and nothing else."""

    slips: tuple[int, ...]
    """Index in the state of the rate of each coordinate along which a contact slips (m,)."""
    leads: tuple[Lead, ...]
    """Guided coordinates, which are set before rates are asked for."""

    @property
    @abstractmethod
    def coordinates(self) -> int:
        """Number of coordinates, which come first in the state; their rates follow."""

    @property
    @abstractmethod
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of samples: states, friction, loads, modes."""

    @property
    @abstractmethod
    def contacts(self) -> tuple[str, ...]:
        """Names of the contacts where there are several."""

    @abstractmethod
    def begun(self, y0: Sequence[float]) -> list[float]:
        """Return the state at which a run begins (n,), in coordinates of the equations."""

    @abstractmethod
    def holds(self, t: float, y: Sequence[float], held: Sequence[bool]) -> tuple[bool, ...]:
        """Whether contacts can hold their coordinates, by the rules of their laws."""

    @abstractmethod
    def rates(self, t: float, y: Sequence[float], held: Sequence[bool]) -> list[float]:
        """Return the time derivatives of the state."""

    @abstractmethod
    def sample(self, t: float, y: Sequence[float], held: Sequence[bool]) -> list[float]:
        """Return time and columns."""

    @abstractmethod
    def lifts(self, row: Sequence[float]) -> bool:
        """Whether a normal force that is a reaction has fallen below 0 in a sample."""

    @abstractmethod
    def balance(
        self, t: float, y: Sequence[float], held: Sequence[bool], row: Sequence[float]
    ) -> tuple[float, ...]:
        """Return the energy of a state and what changes it."""

    @property
    def lost(self) -> float:
        """Energy that impacts at hard stops have taken so far [J]."""
        return 0.0

    def stopped(self, y: Sequence[float]) -> tuple[bool, ...]:  # for those with stops
        """Whether each coordinate of `slips` is at rest at a hard stop."""
        return (False,) * len(self.slips)

    def struck(
        self,
        t: float,
        dt: float,
        y: list[float],
        held: tuple[bool, ...],
    ) -> tuple[list[float], tuple[bool, ...]]:
        """Return a state at the end of a step after the impacts in it, and what is held then."""
        return y, held

    def turn(self, t: float, y: Sequence[float]) -> None:  # noqa: B027  # few laws have any
        """Turn latched switches at the end of a step, within which they stay as they are."""

    def led(self, t: float, y: list[float]) -> list[float]:
        """Return a state whose guided coordinates are where their profiles say.

        Steps would add up what each misses of a phase that ends within it, and the guided
        coordinate would stray: in a block diagram its motion is a source.
        """
        # The run may begin beside the profile: its offset, and that of its rate, stay for all time.
        for place, rate, profile, ahead, faster in self.leads:
            position, speed = profile.at(t)
            y[place], y[rate] = position + ahead + faster * t, speed + faster
        return y


@dataclass(frozen=True)
class Diagram(BlockDiagram):
    """The diagram of one contact, whose law, or printed form, is a block of its own."""

    contacts: ClassVar[tuple[str, ...]] = ()

    equations: Equations
    """Equations of motion, with the force of the contact left open."""
    law: FrictionLaw | PrintedForm
    """Friction of the contact."""
    states: tuple[str, ...]
    """Names of the coordinates and their rates."""
    bristles: tuple[str, ...]
    """Names of the bristle states."""
    slips: tuple[int, ...]
    """Index of the slip velocity in the state (1,)."""
    leads: tuple[Lead, ...]
    """Guided coordinates, which are set before rates are asked for."""
    mechanism: Mechanism
    """What moves, which tells the law of its contact."""
    break_away: BreakAway
    """Friction of a body at rest that is not held."""
    soft: SoftConstraint | None = None
    """How softly friction holds, where no rule for rest does."""
    viscous: float = 0.0
    """Part of friction over velocity that a step takes with the velocity at its end [N s/m]."""
    step: float = 0.0
    """Such a step [s]."""
    asked: list[_State] = field(default_factory=list, compare=False, repr=False)
    """The last state: a step asks for several things at each."""
    latches: tuple[Latches, Latches] = field(
        default_factory=lambda: (Latches(), Latches()), compare=False, repr=False
    )
    """Latched switches of the friction force, and of the rates of the bristles."""

    @classmethod
    def build(
        cls,
        mechanism: Mechanism,
        law: FrictionLaw | PrintedForm,
        t_end: float,
        y0: Sequence[float],
        break_away: BreakAway,
        soft: SoftConstraint | None = None,
        viscous: float = 0.0,
        step: float = 0.0,
    ) -> Self:
        """Take the mechanism's own equations; any law serves to formulate them."""
        # The force of the contact is left open below, so that the law that equations are traced
        # with has no part in them.
        stand_in = STAND_IN
        model = formulate(mechanism, stand_in)
        if model.latched:
            raise InputError(
                f"{type(mechanism).__name__} has latched switches of its own, which fixed steps do"
                " not follow: use EventDriven."
            )
        equations = Equations(model, gather(mechanism, stand_in, model, t_end))
        bristles = law.states
        states = (*mechanism.coordinates, *mechanism.rates)
        slips, leads = (model.sizes.header[layout.SLIP],), leads_of(mechanism, y0)
        return cls(
            equations,
            law,
            states,
            bristles,
            slips,
            leads,
            mechanism,
            break_away,
            soft,
            viscous,
            step,
        )

    @property
    def coordinates(self) -> int:
        return self.equations.sizes.coordinates

    @property
    def columns(self) -> tuple[str, ...]:
        return (*self.states, *self.bristles, "friction", "normal_force", "mode")

    def begun(self, y0: Sequence[float]) -> list[float]:
        return list(y0)

    @property
    def slip(self) -> int:
        """Index of the slip velocity in the state."""
        return self.slips[0]

    def _at(self, t: float, y: Sequence[float]) -> _State:
        """Set the equations to a state, unless they stand there; lists are not written to after."""
        # By identity: a step makes a new list for each state, and asks for friction, rates and
        # samples at one.
        if self.asked and self.asked[0].y is y and self.asked[0].t == t:
            return self.asked[0]
        self.equations.load_at(t)
        self.asked[:] = [_State(t, y, self.equations.flags(t, y))]
        return self.asked[0]

    def _free(self, t: float, y: Sequence[float], friction: float) -> list[float]:
        """Return accelerations, normal force, needed friction and power for a friction force."""
        state = self._at(t, y)
        if state.closed is None or state.closed[0] != friction:
            state.closed = friction, self._evaluated(state, friction)
        return state.closed[1]

    def _evaluated(self, state: _State, friction: float) -> list[float]:
        return self.equations.here("diagram", 0, state.flags, state.t, [friction])

    def _open(self, t: float, y: Sequence[float]) -> tuple[float, float]:
        """Return normal force and needed friction of a contact without friction."""
        state = self._at(t, y)
        if state.open is None:
            state.open = self._evaluated(state, 0.0)
        *_, normal, needed, _ = state.open
        return normal, needed

    def _informed(self, t: float, y: Sequence[float]) -> FrictionLaw:
        """Return the law, which sees the inputs of the contact."""
        law = self.law
        assert isinstance(law, FrictionLaw)  # printed forms are asked otherwise
        if not law.inputs:
            return law
        # Bound once for each state: laws are frozen, and each binding is a new object.
        state = self._at(t, y)
        if state.law is None:
            n, names = self.coordinates, self.mechanism.coordinates
            straight = zip(self.drives.items(), self.equations.linear(t), strict=True)
            q, q_dot = (dict(zip(names, part, strict=True)) for part in (y[:n], y[n : 2 * n]))
            seen = {**q, **dict(zip(self.mechanism.rates, y[n : 2 * n], strict=True))}
            drives = {
                name: drive.shaped(linear, t) + drive.fed(seen)
                for (name, drive), linear in straight
            }
            (contact,) = self.mechanism.contacts()
            inputs = self.mechanism.contact_inputs(t, q, q_dot, drives)
            state.law = bound(law, of_contact(inputs, contact.name))
            check_within({name: float(limit) for name, limit in state.law.limits().items()}, t)
        return state.law

    @cached_property
    def drives(self) -> Mapping[str, Drive]:
        """The drives of the mechanism."""
        return self.mechanism.drives()

    def _split(self, y: Sequence[float]) -> tuple[float, tuple[float, ...]]:
        if not self.bristles:
            return y[self.slip], ()
        first = self.equations.sizes.states
        return y[self.slip], tuple(y[first : first + len(self.bristles)])

    def friction(self, t: float, y: Sequence[float], held: bool) -> tuple[float, float]:
        """Return friction and normal force; the normal force is that without friction."""
        normal, needed = self._open(t, y)
        if held:
            return needed, normal
        v, z = self._split(y)
        if isinstance(self.law, PrintedForm):
            return self.law.force(v, normal, z, needed), normal
        law = self._informed(t, y)
        if self.soft is not None:
            return self._softly(self.soft, law, t, y), normal
        if not z:  # only memories latch
            if v != 0.0 or self.break_away == "zero":
                return law.force(v, normal), normal
            return self._out_of_rest(law, normal, needed), normal
        with self.latches[0]:
            return law.force(v, normal, z), normal

    def _rests(self, t: float, y: Sequence[float], held: bool) -> bool:
        """Whether friction holds the body, by a rule or because it is at rest and not pushed on."""
        # These have a rule of their own for rest, or none at all.
        exempt = self.break_away == "zero" or self.soft is not None or bool(self.bristles)
        if held or exempt or isinstance(self.law, PrintedForm) or y[self.slip] != 0.0:
            return held
        return self._can_hold(t, y)

    def _out_of_rest(self, law: FrictionLaw, normal: float, needed: float) -> float:
        """Return the friction with which a body breaks away."""
        side = 1 if needed > 0.0 else -1
        if self.break_away == "static":
            return side * float(law.towards(side).break_away(normal))
        return float(law.force(side * CREEP, normal))

    def _softly(
        self, soft: SoftConstraint, law: FrictionLaw, t: float, y: Sequence[float]
    ) -> float:
        """Return the friction of a soft constraint, at most that of the law."""
        normal, needed = self._open(t, y)
        v, viscous = y[self.slip], self.viscous * y[self.slip]
        # MuJoCo's constraint: of the force that would hold the body and stop it at a rate, the
        # impedance is taken, at most the level.
        mobility = self._mobilities(t, y)[self.slip - self.coordinates]
        wanted = soft.impedance * (needed - viscous + soft.damping * v / mobility)
        side = 1 if wanted > 0.0 else -1
        most = law.towards(side).break_away(normal)
        if v * side > 0.0:
            most = abs(law.force(v, normal) - viscous)
        return float(side * min(abs(wanted), most) + viscous)

    def _mobilities(self, t: float, y: Sequence[float]) -> list[float]:
        """Return the accelerations that a unit of friction takes away (coordinates,)."""
        state, n = self._at(t, y), self.coordinates
        # Affine in the friction force: two evaluations give the slope.
        open_, loaded = self._evaluated(state, 0.0)[:n], self._evaluated(state, 1.0)[:n]
        return [a - b for a, b in zip(open_, loaded, strict=True)]

    def holds(self, t: float, y: Sequence[float], held: Sequence[bool]) -> tuple[bool, ...]:
        return (held[0] and self._can_hold(t, y),)

    def _can_hold(self, t: float, y: Sequence[float]) -> bool:
        normal, needed = self._open(t, y)
        if isinstance(self.law, PrintedForm):
            _, z = self._split(y)
            # Equations as printed may hold by returning what is needed.
            return self.law.force(0.0, normal, z, needed) == needed
        if not self.law.holds:
            return False
        level = self._informed(t, y).towards(1 if needed > 0.0 else -1).break_away(normal)
        return bool(abs(needed) <= level)

    def rates(self, t: float, y: Sequence[float], held: Sequence[bool]) -> list[float]:
        stuck = self._rests(t, y, held[0])
        friction, normal = self.friction(t, y, stuck)
        n = self.equations.sizes.coordinates
        *accelerations, _, _, _ = self._free(t, y, friction)
        v, z = self._split(y)
        if self.viscous and not stuck:
            # With the velocity at the end, a' = a - (D dt / m) a', which is solved for a'.
            lag, away = self.step * self.viscous, self._mobilities(t, y)
            ahead = lag * accelerations[self.slip - n] / (1.0 + lag * away[self.slip - n])
            accelerations = [a - ahead * x for a, x in zip(accelerations, away, strict=True)]
        if stuck:
            # Exactly: rounding of the balance would make the body creep.
            accelerations[self.slip - n] = 0.0
        moved: Sequence[float] = (0.0,) * len(z)
        if z and not stuck:
            law = self.law if isinstance(self.law, PrintedForm) else self._informed(t, y)
            with self.latches[1]:
                moved = law.rates(v, normal, z)
        return [*y[n : 2 * n], *accelerations, *moved]

    def turn(self, t: float, y: Sequence[float]) -> None:
        if not any(self.latches):
            return
        v, z = self._split(y)
        normal, _ = self._open(t, y)
        law = self._informed(t, y)
        # Within a step latches stay as they are, so that all stages see one law.
        for latches, equation in zip(self.latches, (law.force, law.rates), strict=True):
            with latches:
                equation(v, normal, z)
            latches.turn()

    def sample(self, t: float, y: Sequence[float], held: Sequence[bool]) -> list[float]:
        stuck = self._rests(t, y, held[0])
        friction, normal = self.friction(t, y, stuck)
        v = y[self.slip]
        return [t, *y, friction, normal, 0.0 if stuck else float((v > 0) - (v < 0))]

    def lifts(self, row: Sequence[float]) -> bool:
        return row[NORMAL] < 0.0

    def balance(
        self, t: float, y: Sequence[float], held: Sequence[bool], row: Sequence[float]
    ) -> tuple[float, ...]:
        friction = row[FRICTION_PLACE]
        (energy,) = self.equations.here("energy", 0, self._at(t, y).flags, t)
        # By the friction of the sample, so that powers are those of the columns.
        *_, supplied = self._free(t, y, friction)
        return float(energy), supplied, friction * y[self.slip]


def leads_of(mechanism: Mechanism, y0: Sequence[float]) -> tuple[Lead, ...]:
    """Return the guided coordinates that a profile tells of, from where the run begins."""
    drives, n = mechanism.drives(), len(mechanism.coordinates)
    result = []
    for name, guide in mechanism.guided().items():
        profile, place = drives[guide.drive], mechanism.coordinates.index(name)
        if isinstance(profile, Profile):
            position, speed = profile.at(0.0)
            ahead, faster = y0[place] - position, y0[n + place] - speed
            result.append(Lead(place, n + place, profile, ahead, faster))
    return tuple(result)


# A mechanism with several contacts as blocks of a diagram, from the parts of its equations.

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
        # Impacts are those of parts, also with a single contact.
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
        w, iw = equations.w, equations.iw
        first, n = iw[layout.SLIPS], iw[layout.N_COORDINATES]
        slips = {n + iw[first + c] for c in range(iw[layout.N_CONTACTS])}
        # Switches, and so the geometry, are those of the state at which the run begins.
        w[iw[layout.Y] : iw[layout.Y] + iw[layout.N_STATES]] = y0
        set_own_flags(0, w, iw)
        prepare(0.0, w, iw)  # gives the change of coordinates, too
        walls = tuple(
            Wall(wall_coordinate(k, iw), wall_side(k, iw), *_numbers_of(k, w, iw))
            for k in range(iw[layout.N_WALLS])
        )
        held = tuple(sorted(slips | {n + wall.place for wall in walls}))
        return cls(model, equations, held, walls, leads_of(mechanism, y0), break_away)

    @property
    def coordinates(self) -> int:
        return int(self.equations.iw[layout.N_COORDINATES])

    @property
    def columns(self) -> tuple[str, ...]:
        contacts = self.model.contacts
        kinds = ("friction", "normal_force", "mode")
        own = tuple(f"{kind}:{name}" for kind in kinds for name in contacts)
        return (*self.model.states, *(kinds if self.model.alone else own))

    @property
    def contacts(self) -> tuple[str, ...]:
        return () if self.model.alone else self.model.contacts

    def _put(self, t: float, y: Sequence[float]) -> None:
        w, iw = self.equations.w, self.equations.iw
        first = iw[layout.Y]
        w[first : first + iw[layout.N_STATES]] = y
        w[layout.TIME] = t

    def _turned(self, y: Sequence[float], back: int) -> list[float]:
        """Return a state in coordinates of the equations, or back in those of the mechanism."""
        w, iw = self.equations.w, self.equations.iw
        first, count = iw[layout.Y], iw[layout.N_STATES]
        w[first : first + count] = y
        turn_states(first, back, w, iw)
        self.asked.clear()
        return [float(x) for x in w[first : first + count]]

    def begun(self, y0: Sequence[float]) -> list[float]:
        return self._turned(y0, 0)

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
        w, iw = self.equations.w, self.equations.iw
        state: list[Any] = [t, held, dict(pushed or {})]
        # By identity and by what is held: within a step the same state is asked for with other
        # holds.
        if self.asked and self.asked[0] is y and self.asked[1:] == state:
            return w, iw
        self.equations.load_at(t)
        self._put(t, y)
        set_own_flags(0, w, iw)
        # Which contacts are open follows from the loads alone: steps locate no lift-off.
        if not iw[layout.CONSTANT_LOADS]:
            evaluate(LOADS, 0, iw[layout.FLAGS], t, w, iw[layout.Y], iw[layout.LOAD])
        for c in range(iw[layout.N_CONTACTS]):
            closed = iw[iw[layout.REACTS] + c] or w[iw[layout.LOAD] + c] > 0.0
            iw[iw[layout.OPEN] + c] = 0 if closed else 1
        n, modes = iw[layout.N_COORDINATES], iw[layout.MODES]
        kept = dict(zip(self.slips, held, strict=True))
        for i in range(n):
            rate, side = y[n + i], state[2].get(n + i, 0)
            iw[modes + i] = (
                layout.FORWARD if rate > 0.0 else layout.BACKWARD if rate < 0.0 else layout.FREE
            )
            if rate == 0.0 and side:
                # Bent bristles have a friction of their own at rest, beside which there is no level
                # to break.
                level = self.break_away == "static" and not self._bends(i)
                iw[modes + i] = side * (layout.PUSHED if level else layout.FORWARD)
            if kept.get(n + i):
                iw[modes + i] = layout.HELD_FAST
            elif not rubs(i, iw):
                iw[modes + i] = layout.FREE
        # After modes: laws whose switches depend on the slip see its sign.
        law_flags(t, w, iw, iw[layout.Y])
        refresh(t, w, iw, iw[layout.Y])
        limits = [name for name in self.model.limits if name != PAINLEVE]
        if limits:
            put_motion(w, iw, iw[layout.Y])
            evaluate(
                LIMITS,
                0,
                iw[layout.FLAGS],
                t,
                w,
                iw[layout.MOTION_POINT],
                iw[layout.VALUES],
            )
            check_within(dict(zip(limits, w[iw[layout.VALUES] :], strict=False)), t)
        self.asked[:] = [y, *state]
        return w, iw

    def holds(self, t: float, y: Sequence[float], held: Sequence[bool]) -> tuple[bool, ...]:
        if not any(held):
            return tuple(held)
        kept, _ = self._decided(t, y)
        return tuple(a and b for a, b in zip(kept, held, strict=True))

    def _decided(self, t: float, y: Sequence[float]) -> tuple[tuple[bool, ...], dict[int, int]]:
        """Return which coordinates at rest stay there, and where others are pushed."""
        iw = self.equations.iw
        n, rigid = iw[layout.N_COORDINATES], iw[layout.RIGID]
        kept = tuple(
            own or (y[slip] == 0.0 and bool(iw[rigid + slip - n]))
            for slip, own in zip(self.slips, self.stopped(y), strict=True)
        )
        pushed: dict[int, int] = {}
        # One after another: who lets go first changes what the others have to hold.
        while any(kept):
            slip, side = self._weakest(t, y, kept, pushed)
            if side == 0:
                break
            pushed[slip] = side
            kept = tuple(slips and slip != own for slips, own in zip(kept, self.slips, strict=True))
        return kept, pushed

    def _moving(
        self, t: float, y: Sequence[float], held: Sequence[bool]
    ) -> tuple[list[Any], list[int]]:
        """Work everything out at a state, with the friction of what breaks away there."""
        # What is at rest and not held breaks away, or is held after all, before its friction is
        # known.
        resting = (y[slip] == 0.0 and not flag for slip, flag in zip(self.slips, held, strict=True))
        if self.break_away == "zero" or not any(resting):
            return self._at(t, y, tuple(held))
        kept, pushed = self._decided(t, y)
        n = self.coordinates
        rests = (
            own or (slips and not self._bends(slip - n))
            for slip, slips, own in zip(self.slips, kept, held, strict=True)
        )
        return self._at(t, y, tuple(rests), pushed)

    def _bends(self, i: int) -> bool:
        """Whether bristles carry friction along a coordinate, whatever holds them at rest."""
        iw = self.equations.iw
        return any(
            iw[iw[layout.SLIPS] + c] == i and iw[iw[layout.BRISTLES] + c] >= 0
            for c in range(iw[layout.N_CONTACTS])
        )

    def _weakest(
        self, t: float, y: Sequence[float], held: tuple[bool, ...], pushed: Mapping[int, int]
    ) -> tuple[int, int]:
        """Return the held slip that exceeds its level most and where it is pushed, 0 if none."""
        w, iw = self._at(t, y, held, pushed)
        n, result, excess = iw[layout.N_COORDINATES], (0, 0), 0.0
        for slip, slips in zip(self.slips, held, strict=True):
            needed = float(w[iw[layout.NEEDED] + slip - n])
            level = float(w[iw[layout.LEVELS] + 2 * (slip - n) + (0 if needed >= 0.0 else 1)])
            # What no closed contact holds must not stay held by a level of 0 either.
            if not slips or (abs(needed) <= level and self._may_hold(slip - n, y)):
                continue
            beyond = abs(needed) / level if level > 0.0 else math.inf
            if beyond > excess:
                result, excess = (slip, 1 if needed > 0.0 else -1), beyond
        return result

    def _may_hold(self, i: int, y: Sequence[float]) -> bool:
        """Whether a closed contact, or a stop at which it is, can hold a coordinate."""
        at_stop = any(wall.place == i and wall.margin(y) == 0.0 for wall in self.walls)
        return at_stop or rubs(i, self.equations.iw)

    @property
    def lost(self) -> float:
        return sum(self.losses)

    def stopped(self, y: Sequence[float]) -> tuple[bool, ...]:
        n = self.coordinates
        at = {n + wall.place for wall in self.walls if wall.margin(y) == 0.0}
        return tuple(slip in at and y[slip] == 0.0 for slip in self.slips)

    def struck(
        self, t: float, dt: float, y: list[float], held: tuple[bool, ...]
    ) -> tuple[list[float], tuple[bool, ...]]:
        n, beyond = self.coordinates, [k for k, wall in enumerate(self.walls) if wall.margin(y) < 0]
        if not beyond:
            return y, held
        depths = {k: -self.walls[k].margin(y) for k in beyond}
        y = [*y]
        # Back onto the stop first: forces are those there, not those of the depth.
        for wall in (self.walls[k] for k in beyond):
            y[wall.place] = wall.position
        hits = [k for k in beyond if self.walls[k].side * y[n + self.walls[k].place] > 0.0]
        w, iw = self._at(t, y, held)
        pushes = {k: w[iw[layout.ACCELERATION] + self.walls[k].place] for k in hits}
        for k in hits:
            # The speed at the stop follows from that at the end of the step by the work of the
            # press over the depth.
            wall = self.walls[k]
            speed, push = wall.side * y[n + wall.place], wall.side * pushes[k]
            met = max(speed - push * min(dt, depths[k] / speed), 0.0)  # as it reached the stop
            e = wall.restitution
            # A bounce that steps cannot resolve would gain from the integrator what it loses by
            # impact.
            ends = (1.0 - e) * met <= GAINED * push * dt and e * met <= UNRESOLVED * push * dt
            # Restitution is told relative to the speed that kernels see, which is that at the end
            # of the step.
            w[_row_of(k, iw) + 1] = 0.0 if ends else e * met / speed
        if hits:
            before = self._energy(t)
            strike_stops(iw[layout.FIRST_WALL] + hits[0], w, iw)
            y = [float(x) for x in w[iw[layout.Y] : iw[layout.Y] + iw[layout.N_STATES]]]
            self.asked.clear()
            self.losses.append(before - self._energy(t))
        stays = zip(self.slips, held, self.stopped(y), strict=True)
        kept = tuple(rests or (own and y[slip] == 0.0) for slip, own, rests in stays)
        return y, self.holds(t, y, kept)

    def _energy(self, t: float) -> float:
        """Return the mechanical energy of the state at hand."""
        w, iw = self.equations.w, self.equations.iw
        evaluate(ENERGY, 0, iw[layout.FLAGS], t, w, iw[layout.Y], iw[layout.VALUES])
        return float(w[iw[layout.VALUES]])

    def rates(self, t: float, y: Sequence[float], held: Sequence[bool]) -> list[float]:
        w, iw = self._moving(t, y, held)
        n, states = iw[layout.N_COORDINATES], iw[layout.N_STATES]
        first, bristles = iw[layout.ACCELERATION], iw[layout.BRISTLE_RATES]
        return [*y[n : 2 * n], *w[first : first + n], *w[bristles : bristles + states - 2 * n]]

    def sample(self, t: float, y: Sequence[float], held: Sequence[bool]) -> list[float]:
        w, iw = self._moving(t, y, held)
        count, friction, load = iw[layout.N_CONTACTS], iw[layout.FRICTION], iw[layout.LOAD]
        # What is open carries nothing, whatever its law would give.
        is_open = [bool(iw[iw[layout.OPEN] + c]) for c in range(count)]
        loads = [0.0 if is_open[c] else w[load + c] for c in range(count)]
        modes = []
        for c in range(count):
            sticks = iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + c]] == layout.HELD_FAST
            v = 0.0 if sticks else slip_rate(c, w, iw, iw[layout.Y])
            modes.append(OPENED if is_open[c] else float((v > 0) - (v < 0)))
        forces = w[friction : friction + count]
        row = [float(x) for x in (*forces, *loads, *modes)]
        return [t, *self._turned(y, 1), *row]

    def lifts(self, row: Sequence[float]) -> bool:
        iw, count = self.equations.iw, self.equations.iw[layout.N_CONTACTS]
        loads = row[1 + iw[layout.N_STATES] + count :][:count]
        return any(iw[iw[layout.REACTS] + c] and load < 0.0 for c, load in enumerate(loads))

    def balance(
        self, t: float, y: Sequence[float], held: Sequence[bool], row: Sequence[float]
    ) -> tuple[float, ...]:
        w, iw = self._moving(t, y, held)
        values, at = iw[layout.VALUES], iw[layout.Y]
        energy = self._energy(t)
        supply(t, w, iw, at, values)
        supplied = float(w[values])
        taken = [
            float(w[iw[layout.FRICTION] + c] * slip_rate(c, w, iw, at))
            for c in range(iw[layout.N_CONTACTS])
        ]
        return energy, supplied, *taken


def _row_of(wall: int, iw: Sequence[int]) -> int:
    """Return where position and restitution of a stop stand."""
    return iw[layout.WALLS] + wall * iw[layout.WALL_COLUMNS]


def _numbers_of(wall: int, w: Sequence[Any], iw: Sequence[int]) -> tuple[float, float]:
    """Return position and restitution of a stop."""
    at = _row_of(wall, iw)
    return float(w[at]), float(w[at + 1])
