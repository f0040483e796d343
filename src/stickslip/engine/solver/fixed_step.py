"""A block diagram with a fixed step: what chatter, drift and false reversals come from.

Hard stops are those of an integrator with limits, whose state is reset. A coordinate that ends a
step beyond its stop is put onto it, and its rate is reversed, times the restitution; the others
change by the same impulse as in exact runs. The speed is that with which it passed the stop, by the
depth it has come to. An impact so slow that steps do not tell its rebounds apart is one without
restitution, which ends the bounces. What is at rest at its stop
is held while it is pressed, as by friction, and leaves as its press ends.
"""

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.formulation import PAINLEVE, Model, contact_model, formulate
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.contacts.assembly import prepare, put_motion, refresh
from stickslip.engine.kernels.contacts.decisions import strike_stops
from stickslip.engine.kernels.contacts.motion import law_flags, slip_rate, supply
from stickslip.engine.kernels.contacts.transitions import rubs, set_own_flags
from stickslip.engine.kernels.equations import ENERGY, LIMITS, LOADS, evaluate, turn_states
from stickslip.engine.kernels.mode_transitions import wall_coordinate, wall_side
from stickslip.engine.solver.backend import Equations
from stickslip.engine.solver.run import Solver, column_units
from stickslip.engine.solver.starts import gather, refuse_limits, within_stops
from stickslip.engine.trajectory import Certificate, Status, Trajectory
from stickslip.errors import InputError, ParameterError, SimulationError
from stickslip.friction import Coulomb, FrictionLaw, Laws, PrintedForm, bound
from stickslip.maths import Latches
from stickslip.mechanisms import Mechanism, has_one_slip, of_contact, stops_of
from stickslip.mechanisms.drives import Drive, Profile
from stickslip.quantities import Parametrised, Quantity
from stickslip.show.formatting import joined, number, quantity

# A mechanism and its friction as blocks of a diagram, evaluated literally.

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
            drives = {name: drive.shaped(linear, t) for (name, drive), linear in straight}
            q, q_dot = (dict(zip(names, part, strict=True)) for part in (y[:n], y[n : 2 * n]))
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
    found = []
    for name, guide in mechanism.guided().items():
        profile, place = drives[guide.drive], mechanism.coordinates.index(name)
        if isinstance(profile, Profile):
            position, speed = profile.at(0.0)
            ahead, faster = y0[place] - position, y0[n + place] - speed
            found.append(Lead(place, n + place, profile, ahead, faster))
    return tuple(found)


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
        w, whole = equations.w, equations.whole
        first, n = whole[layout.SLIPS], whole[layout.N_COORDINATES]
        slips = {n + whole[first + c] for c in range(whole[layout.N_CONTACTS])}
        # Switches, and so the geometry, are those of the state at which the run begins.
        w[whole[layout.Y] : whole[layout.Y] + whole[layout.N_STATES]] = y0
        set_own_flags(0, w, whole)
        prepare(0.0, w, whole)  # gives the change of coordinates, too
        walls = tuple(
            Wall(wall_coordinate(k, whole), wall_side(k, whole), *_numbers_of(k, w, whole))
            for k in range(whole[layout.N_WALLS])
        )
        held = tuple(sorted(slips | {n + wall.place for wall in walls}))
        return cls(model, equations, held, walls, leads_of(mechanism, y0), break_away)

    @property
    def coordinates(self) -> int:
        return int(self.equations.whole[layout.N_COORDINATES])

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
        w, whole = self.equations.w, self.equations.whole
        first = whole[layout.Y]
        w[first : first + whole[layout.N_STATES]] = y
        w[layout.TIME] = t

    def _turned(self, y: Sequence[float], back: int) -> list[float]:
        """Return a state in coordinates of the equations, or back in those of the mechanism."""
        w, whole = self.equations.w, self.equations.whole
        first, count = whole[layout.Y], whole[layout.N_STATES]
        w[first : first + count] = y
        turn_states(first, back, w, whole)
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
        w, whole = self.equations.w, self.equations.whole
        state: list[Any] = [t, held, dict(pushed or {})]
        # By identity and by what is held: within a step the same state is asked for with other
        # holds.
        if self.asked and self.asked[0] is y and self.asked[1:] == state:
            return w, whole
        self.equations.load_at(t)
        self._put(t, y)
        set_own_flags(0, w, whole)
        # Which contacts are open follows from the loads alone: steps locate no lift-off.
        if not whole[layout.CONSTANT_LOADS]:
            evaluate(LOADS, 0, whole[layout.FLAGS], t, w, whole[layout.Y], whole[layout.LOAD])
        for c in range(whole[layout.N_CONTACTS]):
            closed = whole[whole[layout.REACTS] + c] or w[whole[layout.LOAD] + c] > 0.0
            whole[whole[layout.OPEN] + c] = 0 if closed else 1
        n, modes = whole[layout.N_COORDINATES], whole[layout.MODES]
        kept = dict(zip(self.slips, held, strict=True))
        for i in range(n):
            rate, side = y[n + i], state[2].get(n + i, 0)
            whole[modes + i] = (
                layout.FORWARD if rate > 0.0 else layout.BACKWARD if rate < 0.0 else layout.FREE
            )
            if rate == 0.0 and side:
                # Bent bristles have a friction of their own at rest, beside which there is no level
                # to break.
                level = self.break_away == "static" and not self._bends(i)
                whole[modes + i] = side * (layout.PUSHED if level else layout.FORWARD)
            if kept.get(n + i):
                whole[modes + i] = layout.HELD_FAST
            elif not rubs(i, whole):
                whole[modes + i] = layout.FREE
        # After modes: laws whose switches depend on the slip see its sign.
        law_flags(t, w, whole, whole[layout.Y])
        refresh(t, w, whole, whole[layout.Y])
        limits = [name for name in self.model.limits if name != PAINLEVE]
        if limits:
            put_motion(w, whole, whole[layout.Y])
            evaluate(
                LIMITS,
                0,
                whole[layout.FLAGS],
                t,
                w,
                whole[layout.MOTION_POINT],
                whole[layout.VALUES],
            )
            check_within(dict(zip(limits, w[whole[layout.VALUES] :], strict=False)), t)
        self.asked[:] = [y, *state]
        return w, whole

    def holds(self, t: float, y: Sequence[float], held: Sequence[bool]) -> tuple[bool, ...]:
        if not any(held):
            return tuple(held)
        kept, _ = self._decided(t, y)
        return tuple(a and b for a, b in zip(kept, held, strict=True))

    def _decided(self, t: float, y: Sequence[float]) -> tuple[tuple[bool, ...], dict[int, int]]:
        """Return which coordinates at rest stay there, and where others are pushed."""
        whole = self.equations.whole
        n, rigid = whole[layout.N_COORDINATES], whole[layout.RIGID]
        kept = tuple(
            own or (y[slip] == 0.0 and bool(whole[rigid + slip - n]))
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
        whole = self.equations.whole
        return any(
            whole[whole[layout.SLIPS] + c] == i and whole[whole[layout.BRISTLES] + c] >= 0
            for c in range(whole[layout.N_CONTACTS])
        )

    def _weakest(
        self, t: float, y: Sequence[float], held: tuple[bool, ...], pushed: Mapping[int, int]
    ) -> tuple[int, int]:
        """Return the held slip that exceeds its level most and where it is pushed, 0 if none."""
        w, whole = self._at(t, y, held, pushed)
        n, found, excess = whole[layout.N_COORDINATES], (0, 0), 0.0
        for slip, slips in zip(self.slips, held, strict=True):
            needed = float(w[whole[layout.NEEDED] + slip - n])
            level = float(w[whole[layout.LEVELS] + 2 * (slip - n) + (0 if needed >= 0.0 else 1)])
            # What no closed contact holds must not stay held by a level of 0 either.
            if not slips or (abs(needed) <= level and self._may_hold(slip - n, y)):
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
        w, whole = self._at(t, y, held)
        pushes = {k: w[whole[layout.ACCELERATION] + self.walls[k].place] for k in hits}
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
            w[_row_of(k, whole) + 1] = 0.0 if ends else e * met / speed
        if hits:
            before = self._energy(t)
            strike_stops(whole[layout.FIRST_WALL] + hits[0], w, whole)
            y = [float(x) for x in w[whole[layout.Y] : whole[layout.Y] + whole[layout.N_STATES]]]
            self.asked.clear()
            self.losses.append(before - self._energy(t))
        stays = zip(self.slips, held, self.stopped(y), strict=True)
        kept = tuple(rests or (own and y[slip] == 0.0) for slip, own, rests in stays)
        return y, self.holds(t, y, kept)

    def _energy(self, t: float) -> float:
        """Return the mechanical energy of the state at hand."""
        w, whole = self.equations.w, self.equations.whole
        evaluate(ENERGY, 0, whole[layout.FLAGS], t, w, whole[layout.Y], whole[layout.VALUES])
        return float(w[whole[layout.VALUES]])

    def rates(self, t: float, y: Sequence[float], held: Sequence[bool]) -> list[float]:
        w, whole = self._moving(t, y, held)
        n, states = whole[layout.N_COORDINATES], whole[layout.N_STATES]
        first, bristles = whole[layout.ACCELERATION], whole[layout.BRISTLE_RATES]
        return [*y[n : 2 * n], *w[first : first + n], *w[bristles : bristles + states - 2 * n]]

    def sample(self, t: float, y: Sequence[float], held: Sequence[bool]) -> list[float]:
        w, whole = self._moving(t, y, held)
        count, friction, load = whole[layout.N_CONTACTS], whole[layout.FRICTION], whole[layout.LOAD]
        # What is open carries nothing, whatever its law would give.
        is_open = [bool(whole[whole[layout.OPEN] + c]) for c in range(count)]
        loads = [0.0 if is_open[c] else w[load + c] for c in range(count)]
        modes = []
        for c in range(count):
            sticks = whole[whole[layout.MODES] + whole[whole[layout.SLIPS] + c]] == layout.HELD_FAST
            v = 0.0 if sticks else slip_rate(c, w, whole, whole[layout.Y])
            modes.append(OPENED if is_open[c] else float((v > 0) - (v < 0)))
        forces = w[friction : friction + count]
        row = [float(x) for x in (*forces, *loads, *modes)]
        return [t, *self._turned(y, 1), *row]

    def lifts(self, row: Sequence[float]) -> bool:
        whole, count = self.equations.whole, self.equations.whole[layout.N_CONTACTS]
        loads = row[1 + whole[layout.N_STATES] + count :][:count]
        return any(whole[whole[layout.REACTS] + c] and load < 0.0 for c, load in enumerate(loads))

    def balance(
        self, t: float, y: Sequence[float], held: Sequence[bool], row: Sequence[float]
    ) -> tuple[float, ...]:
        w, whole = self._moving(t, y, held)
        values, at = whole[layout.VALUES], whole[layout.Y]
        energy = self._energy(t)
        supply(t, w, whole, at, values)
        supplied = float(w[values])
        taken = [
            float(w[whole[layout.FRICTION] + c] * slip_rate(c, w, whole, at))
            for c in range(whole[layout.N_CONTACTS])
        ]
        return energy, supplied, *taken


def _row_of(wall: int, whole: Sequence[int]) -> int:
    """Return where position and restitution of a stop stand."""
    return whole[layout.WALLS] + wall * whole[layout.WALL_COLUMNS]


def _numbers_of(wall: int, w: Sequence[Any], whole: Sequence[int]) -> tuple[float, float]:
    """Return position and restitution of a stop."""
    at = _row_of(wall, whole)
    return float(w[at]), float(w[at + 1])


# A block diagram with a fixed step: what chatter, drift and false reversals come from.

Method: TypeAlias = Literal["euler", "semi-implicit", "heun", "rk4"]
"""Integrators of a fixed step."""

NUDGE = 1e-9
"""Deflection over which the rate of a bristle is differentiated [m]; bristles deflect by more."""
MOST_STEPS = 1e7
"""Steps that a run may take: each keeps its state, and this many take some minutes."""

Tableau: TypeAlias = tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]

TABLEAUS: dict[str, Tableau] = {
    "euler": (((),), (1.0,)),
    "semi-implicit": (((),), (1.0,)),  # coordinates then move by the new rates
    "heun": (((), (1.0,)), (0.5, 0.5)),
    "rk4": (((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0)), (1 / 6, 1 / 3, 1 / 3, 1 / 6)),
}
"""Runge-Kutta coefficients: rows of stages, then weights."""


@dataclass(frozen=True, kw_only=True)
class FixedStep(Solver):
    """Evaluates the friction block literally at every stage of a fixed step.

    Nothing is located: a reversal is noticed one step late, and a law without the stick rule
    chatters about zero velocity. Its certificate says what that cost. A coordinate that
    a profile guides is where the profile says at every stage.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(
    ...     rig,
    ...     Coulomb(kinetic_coefficient=0.25),
    ...     t_end=1.0,
    ...     solver=FixedStep(dt=0.01, stick_rule=False),
    ... )
    >>> bool(run["v"].min() < 0)
    True
    """

    dt: Annotated[float, Quantity("dt", "s", above=0)]
    """Step."""
    method: Method = "euler"
    """Integrator: forward Euler, semi-implicit Euler, Heun, or Runge-Kutta of order 4.
    With semi-implicit Euler, coordinates move by the new rates, and bristles as if the speed
    stayed."""
    stick_rule: bool | None = None
    """Hold the body when its velocity changes sign within a step and break-away is not exceeded; if
    not given, with friction laws but not with equations as printed, which have no such rule. Heun
    and Runge-Kutta can change the sign between their stages but not between the ends of steps,
    which the rule does not see: the body then hovers at a small speed instead of resting."""
    break_away: BreakAway | None = None
    """Friction of a body at rest that the applied force exceeds: the break-away level (``static``),
    as (5) of the source paper and Karnopp (1985) have it, that of sliding (``kinetic``), or none,
    since sgn 0 = 0 (``zero``); if not given, static. Bristles, equations as printed and a soft
    constraint have their own, beside which none is taken."""
    zero_velocity_band: Annotated[float, Quantity("D_v", "m/s", low=0)] = 0.0
    """Hold it too when a step ends within this speed and break-away is not exceeded (Karnopp)."""
    soft: SoftConstraint | None = None
    """Hold it softly, as MuJoCo does, in place of both rules; of a law without memory."""
    viscous: Annotated[float, Quantity("D", "N s/m", low=0)] = 0.0
    """Part of the law's friction over velocity that steps take with the velocity at their end, as
    MuJoCo does with the damping of joints; of one contact."""

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.method not in TABLEAUS:
            raise ParameterError(
                f"FixedStep.method must be one of {', '.join(TABLEAUS)}, got {self.method!r}."
            )
        if self.break_away not in (None, *(known := get_args(BreakAway))):
            raise ParameterError(
                f"FixedStep.break_away must be one of {', '.join(known)}, got {self.break_away!r}."
            )

    def run(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws | PrintedForm,
        *,
        y0: Sequence[float],
        t_end: float,
        told: Sequence[str] = (),
    ) -> Trajectory:
        if self.stick_rule is None:
            rule = not isinstance(law, PrintedForm)
            return replace(self, stick_rule=rule).run(mechanism, law, y0=y0, t_end=t_end, told=told)
        y0 = within_stops(mechanism, y0)
        diagram = _diagram(self, mechanism, law, t_end, y0)
        if self.dt > t_end:
            raise ParameterError(
                f"FixedStep.dt (dt) must be at most t_end = {number(t_end, 6)} s, got"
                f" {number(self.dt, 6)}."
            )
        if t_end > MOST_STEPS * self.dt:
            raise ParameterError(
                f"FixedStep.dt (dt) must be at least {number(t_end / MOST_STEPS)} s for t_end ="
                f" {number(t_end, 6)} s, got {number(self.dt, 6)}: more than {number(MOST_STEPS)}"
                " steps."
            )
        times = self._times(t_end)
        y = diagram.begun(y0)
        rests = tuple(
            self.soft is None and ((self.stick_rule and y[slip] == 0) or self._within_band(y[slip]))
            for slip in diagram.slips
        )
        # What is pressed to a stop is held there from the start, whatever the speed band says.
        rests = tuple(a or b for a, b in zip(rests, diagram.stopped(y), strict=True))
        held = diagram.holds(0.0, y, rests)
        for slip, stuck in zip(diagram.slips, held, strict=True):
            y[slip] = 0.0 if stuck else y[slip]
        rows = [diagram.sample(0.0, y, held)]
        balances = [diagram.balance(0.0, y, held, rows[0])]
        status = Status.END_TIME
        for t, following in itertools.pairwise(times):
            try:
                y, held = self._step(diagram, t, following - t, y, held)
                # After the step: integrators of diagrams know impacts as resets, not as events.
                y, held = diagram.struck(following, following - t, y, held)
                diagram.turn(following, y)
                row = diagram.sample(following, y, held)
                # Large steps may diverge: a run ends with its last finite sample, not with an
                # exception.
                if not all(map(math.isfinite, row)):
                    status = Status.NOT_FINITE
                    break
                balance = diagram.balance(following, y, held, row)
            except (ArithmeticError, ValueError):
                status = Status.NOT_FINITE
                break
            rows.append(row)
            balances.append(balance)
            if diagram.lifts(row):
                status = Status.LIFT_OFF
                break
        # Between samples everything is joined by straight lines.
        samples = np.array(rows)
        names, contacts = diagram.columns, mechanism.contacts()
        return Trajectory(
            t=samples[:, 0],
            names=names,
            units=column_units(mechanism, names[2 * len(mechanism.coordinates) :]),
            events=(),
            status=status,
            certificate=_certificate(samples[:, 0], np.array(balances), diagram),
            span=(0.0, float(samples[-1, 0])),
            evaluate=_Lines(names, samples),
            only_contact=contacts[0].name if len(contacts) == 1 else "",
            step_times=samples[:, 0],
            states=tuple(name for name in names if name.partition(":")[0] not in OF_CONTACTS),
        )

    def _times(self, t_end: float) -> list[float]:
        """Return the ends of the steps; the last one is shorter if it must be."""
        # A step that is missing by rounding only is no further step.
        count = math.floor(t_end / self.dt * (1 + 1e-12))
        times = [i * self.dt for i in range(count + 1)]
        if t_end - times[-1] > 1e-9 * self.dt:
            return [*times, t_end]
        return [*times[:-1], t_end]

    def _within_band(self, velocity: float) -> bool:
        return self.zero_velocity_band > 0 and abs(velocity) <= self.zero_velocity_band

    def _step(
        self, diagram: BlockDiagram, t: float, dt: float, y: list[float], held: tuple[bool, ...]
    ) -> tuple[list[float], tuple[bool, ...]]:
        """Advance one step; by the rules for rest, stop what a contact holds."""
        tableau = TABLEAUS[self.method]
        kept = diagram.holds(t, y, held)
        new = _advanced(diagram, tableau, t, y, dt, kept)
        if self.method == "semi-implicit":
            n = diagram.coordinates
            # Coordinates move by the new rates, which makes the method symplectic for a free
            # oscillator.
            new[:n] = [x + dt * rate for x, rate in zip(y[:n], new[n : 2 * n], strict=True)]
            for i in range(2 * n, len(y)):  # exact for bristles that decay in proportion
                decay = dt * _slope(diagram, t, y, kept, i)
                new[i] = y[i] + (math.expm1(decay) / decay if decay else 1.0) * (new[i] - y[i])
            new = diagram.led(t + dt, new)
        # A soft constraint creeps: no rule for rest applies to it.
        if self.soft is not None:
            return new, kept
        # Karnopp's rule: a sign change, or a speed within the band, asks whether the contact holds.
        slips = list(zip(diagram.slips, kept, strict=True))
        turned = [
            not stuck and ((self.stick_rule and y[i] * new[i] < 0) or self._within_band(new[i]))
            for i, stuck in slips
        ]
        if not any(turned):
            return new, kept
        stopped = list(new)
        for (i, _), turns in zip(slips, turned, strict=True):
            stopped[i] = 0.0 if turns else new[i]
        caught = diagram.holds(
            t + dt, stopped, tuple(a or b for a, b in zip(kept, turned, strict=True))
        )
        after = tuple(a or b for a, b in zip(kept, caught, strict=True))
        # If nothing holds, the step stands as it is, past its reversal.
        if not any(turns and holds for turns, holds in zip(turned, caught, strict=True)):
            return new, kept
        for (i, _), turns, holds in zip(slips, turned, caught, strict=True):
            stopped[i] = new[i] if turns and not holds else stopped[i]
        return stopped, after


def _slope(
    diagram: BlockDiagram, t: float, y: Sequence[float], held: tuple[bool, ...], i: int
) -> float:
    """Return the rate of a bristle by its deflection [1/s]."""
    moved = [*y]
    moved[i] += NUDGE
    return (diagram.rates(t, moved, held)[i] - diagram.rates(t, y, held)[i]) / NUDGE


def _diagram(
    solver: FixedStep,
    mechanism: Mechanism,
    law: FrictionLaw | Laws | PrintedForm,
    t_end: float,
    y0: Sequence[float],
) -> BlockDiagram:
    """Return the diagram of a mechanism, whose equations are parts where contacts are several."""
    contacts, soft = mechanism.contacts(), solver.soft
    _refuse_break_away(solver, law)
    break_away = solver.break_away or "static"
    if not isinstance(law, Laws) and has_one_slip(mechanism) and not stops_of(mechanism):
        refuse_limits(mechanism, limits_of(mechanism))
        if soft is not None and (isinstance(law, PrintedForm) or law.states):
            raise InputError(
                f"FixedStep.soft holds a body by a law without memory, not by {law.name}: leave it"
                " out."
            )
        return Diagram.build(mechanism, law, t_end, y0, break_away, soft, solver.viscous, solver.dt)
    if soft is not None or solver.viscous:
        raise InputError(
            "FixedStep.soft and viscous take a mechanism with one contact that slips along a"
            f" coordinate and no hard stops, but {mechanism.name} has"
            f" {', '.join(contact.name for contact in contacts) or 'others'}: leave them out."
        )
    if isinstance(law, PrintedForm):
        names = ", ".join(contact.name for contact in contacts) or "hard stops"
        raise InputError(
            f"{law.name} is an equation as printed, for one contact that slips along a coordinate"
            f" without stops, but {type(mechanism).__name__} has {names}: give"
            f" {law.corrected.__name__}(...)."
        )
    limits = limits_of(mechanism)
    refuse_limits(mechanism, tuple(name for name in limits if name != PAINLEVE))
    return ContactDiagram.build(mechanism, law, t_end, y0, break_away)


def _refuse_break_away(solver: FixedStep, law: FrictionLaw | Laws | PrintedForm) -> None:
    """Refuse a friction out of rest where nothing asks for it."""
    if solver.break_away is None:
        return
    laws = [member for _, member in law.members] if isinstance(law, Laws) else [law]
    if solver.soft is not None:
        why = "a soft constraint has its own"
    elif isinstance(law, PrintedForm):
        why = f"{law.name}, an equation as printed, has its own"
    elif all(form.states for form in laws):
        names = joined([*dict.fromkeys(form.name for form in laws)])
        why = f"the bristles of {names} carry friction there"
    else:
        return
    raise InputError(
        f"FixedStep.break_away is friction in the first step out of rest, and {why}: leave it out,"
        f" got {solver.break_away!r}."
    )


def _advanced(
    diagram: BlockDiagram,
    tableau: Tableau,
    t: float,
    y: list[float],
    dt: float,
    held: tuple[bool, ...],
) -> list[float]:
    """Take one Runge-Kutta step."""
    stages, weights = tableau
    slopes: list[list[float]] = []
    for row in stages:
        # At the first stage a guided coordinate may have to be moved before anything is asked.
        if not row and not diagram.leads:  # the state itself, which the diagram knows by now
            slopes.append(diagram.rates(t, y, held))
            continue
        at = t + dt * sum(row)
        point = diagram.led(at, _moved(y, dt, row, slopes))
        slopes.append(diagram.rates(at, point, held))
    return diagram.led(t + dt, _moved(y, dt, weights, slopes))


def _moved(
    y: Sequence[float], dt: float, weights: Sequence[float], slopes: Sequence[Sequence[float]]
) -> list[float]:
    """Return a state moved along slopes, each with its weight; few of them without a loop."""
    # Written out for few stages: this runs at each stage of each step.
    match weights, slopes:
        case (a,), (first,):
            return [value + dt * (a * p) for value, p in zip(y, first, strict=True)]
        case (a, b), (first, second):
            return [
                value + dt * (a * p + b * q) for value, p, q in zip(y, first, second, strict=True)
            ]
    return [
        value + dt * sum(w * slope[i] for w, slope in zip(weights, slopes, strict=True))
        for i, value in enumerate(y)
    ]


OF_CONTACTS = ("friction", "normal_force", "mode")
"""Columns that are no states, with the name of a contact after a colon where there are several."""


@dataclass(frozen=True)
class _Lines:
    """Gives columns between samples, joined by straight lines; the mode stays."""

    names: tuple[str, ...]
    """Names of the columns."""
    rows: NDArray[np.float64]
    """Time and columns (n, 1 + columns)."""

    def __call__(self, t: NDArray[np.float64]) -> Mapping[str, NDArray[np.float64]]:
        rows = self.rows
        # The mode at a time is that of the sample before it: halves of modes mean nothing.
        latest = np.searchsorted(rows[:, 0], t, side="right") - 1
        return {
            name: rows[latest, i]
            if name.partition(":")[0] == "mode"
            else np.interp(t, rows[:, 0], rows[:, i])
            for i, name in enumerate(self.names, start=1)
        }


def _certificate(
    t: NDArray[np.float64], balances: NDArray[np.float64], diagram: BlockDiagram
) -> Certificate:
    """Say what the fixed step cost, by energies and powers: it is never certified."""
    energy = balances[:, 0]
    power = np.column_stack([balances[:, 1], balances[:, 2:].sum(axis=1)])
    # By the same straight lines that users get between samples.
    work = np.asarray(np.trapezoid(power, t, axis=0))
    own = np.asarray(np.trapezoid(balances[:, 2:], t, axis=0)).tolist()
    size = max(abs(energy[0]), abs(energy[-1]), *np.abs(work))
    mismatch = abs(energy[-1] - energy[0] - work[0] + work[1] + diagram.lost)
    return Certificate(
        energy_error=float(mismatch / size) if 0 < size < math.inf else float(mismatch),
        energy_start=float(energy[0]),
        energy_end=float(energy[-1]),
        work_supplied=float(work[0]),
        work_friction=float(work[1]),
        work_stops=diagram.lost,
        guard_violation=0.0,
        event_residual=0.0,
        stick_drift=0.0,
        steps=len(t) - 1,
        rejected=0,
        work=dict(zip(diagram.contacts, own, strict=False)),
        problems=("fixed step: events were not located and the error was not controlled",),
    )
