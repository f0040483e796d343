"""What must hold for every run, whatever was simulated: each check yields what is wrong."""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from tests.properties.fuzzing.cases import Case, level_of, run_case
from tests.properties.fuzzing.rigs import PendulumCart

import stickslip.mechanisms
from stickslip import EventDriven, Stribeck, TwoLinkArm
from stickslip.engine import Status, Trajectory
from stickslip.engine.kernels.state_layout import UNLOADED
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import MatrixMechanism
from stickslip.mechanisms.drives import Drive

ROUNDED = 1e-11
"""What a force or an energy may be off while a mode lasts, relative to its size in the run."""
LOCATED = 1e-9
"""What a guard may be where its event was located, also relative to its size."""
BALANCED = 3e-14
"""What a force may be off that is the rest of larger ones, relative to those."""
LEAST = 1e-280
"""Where squares are below the least number that has all its digits, nothing can be compared."""
PLAYED = 1e-12
"""The same of energies, where all that was moved in the run has gone again: states are played back
to the rounding of what they once were."""
CLOCK = 4
"""Roundings of the time within which an event may be located."""
UNNOTICED = 4e-12
"""Share of its least size that counts, at which what bristles carry need not have turned."""
LEAST_SHARES = (1e-3, 1e-6)
"""That size over the speed of all kinetic energy, and over what the largest force gives in all."""
BESIDE = 1e-8
"""Size, over that of what moves most in the same unit, of what a coarse run does not resolve."""
NODES = 0.5 * (1.0 + np.polynomial.legendre.leggauss(8)[0])
WEIGHTS = 0.5 * np.polynomial.legendre.leggauss(8)[1]
"""Points and weights of a quadrature between 0 and 1."""
APART = 1e-3
"""Angle over which slopes of energies are taken by differences [rad]."""
NEAR, LEAST_APART = 1e-5, 1e-9
"""Distance over which they are taken: over the place, and at least [m]."""
MOST_STEPS = 5
"""Steps over which momenta are compared with forces."""
NEWTON = 1e-5
"""What they may differ by, over the sizes of all impulses."""
ROUGH = 1e-3
"""The same where friction falls as a power below 1 of speed, which nodes in time do not resolve."""
STATES = 1e-7
"""The same over the largest momenta of the run, of which the tolerance is a part."""
FAINTEST = 1e-12
"""Share of the least speed that counts below which motions are rounding of those of others."""
FEW_STEPS = 300
"""Steps that are compared between the tiers."""
SENSITIVE = (PendulumCart, stickslip.mechanisms.PendulumCart, TwoLinkArm)
"""Mechanisms whose errors may grow beyond all bounds."""
Found = Iterator[str]


@dataclass(frozen=True)
class Evidence:
    """A case, its run as one of its contacts sees it, at the times at which it is looked at."""

    case: Case
    run: Trajectory
    solver: EventDriven
    at_contact: str = ""
    """Name of the contact, where there are several."""
    whole: "Evidence | None" = None
    """What this is a view of."""

    @cached_property
    def each(self) -> "tuple[Evidence, ...]":
        """The same as each contact that rubs sees it."""
        if not self.run.contacts:
            return (self,)
        names = self.run.contacts
        return tuple(
            replace(self, run=self.run.contact(name), at_contact=name, whole=self) for name in names
        )

    @cached_property
    def law(self) -> FrictionLaw:
        """Law of the contact."""
        laws = self.case.laws
        return laws[self.at_contact] if self.at_contact else next(iter(laws.values()))

    @cached_property
    def slips(self) -> dict[str, float]:
        """Slip velocity of the contact over the rate of each coordinate."""
        names = self.case.contact_names
        slip = self.case.mechanism.contacts()[names.index(self.at_contact or names[0])].slip
        factors = {slip: 1.0} if isinstance(slip, str) else slip
        return {name: float(factors.get(name, 0.0)) for name in self.case.mechanism.coordinates}

    @cached_property
    def drives(self) -> dict[str, Drive]:
        """The drives of the mechanism."""
        return dict(self.case.mechanism.drives())

    def column(self, name: str) -> str:
        """Return the name of a column of the contact, in the run as a whole."""
        return f"{name}:{self.at_contact}" if self.at_contact else name

    @property
    def has_own_drive(self) -> bool:
        """Whether one drive alone, along the slip of the only contact, changes what it holds."""
        alone = len(self.case.mechanism.coordinates) == 1 == len(self.case.contact_names)
        return alone and self.drives.keys() == {"drive"} and set(self.slips.values()) == {1.0}

    @cached_property
    def changes(self) -> list[float]:
        """Times at which a drive changes, all of them."""
        return [float(p.start) for d in self.drives.values() for p in d.pieces()]

    @cached_property
    def times(self) -> np.ndarray:
        """Evenly spaced times, step ends and middles, and both sides of all that happens."""
        if self.whole is not None:
            return self.whole.times
        first, last = self.run.span
        ends = self.run.t[:: max(1, len(self.run.t) // 100)]
        special = np.array([*(e.t for e in self.run.events[:100]), *self.changes[:200]])
        sides = [special, np.nextafter(special, -np.inf), np.nextafter(special, np.inf)]
        every = [np.linspace(first, last, 101), ends, 0.5 * (ends[1:] + ends[:-1]), *sides]
        times = np.unique(np.concatenate(every))
        return times[(times >= first) & (times <= last)]

    @cached_property
    def seen(self) -> Trajectory:
        """The run at those times."""
        return self.run.at(self.times)

    @cached_property
    def slip(self) -> np.ndarray:
        """Slip velocity."""
        rates = zip(self.case.mechanism.rates, self.slips.values(), strict=True)
        return np.asarray(sum(factor * self.seen[rate] for rate, factor in rates if factor))

    def within_the_clock(self, at: int) -> float:
        """Return by how much the slip velocity changes within some roundings of a time."""
        sides = self.times[at] + CLOCK * np.spacing(self.times[at]) * np.array([-1.0, 1.0])
        seen = self.run.at(np.clip(sides, *self.run.span))
        rates = zip(self.case.mechanism.rates, self.slips.values(), strict=True)
        slips = sum(factor * seen[rate] for rate, factor in rates if factor)
        return float(np.abs(slips - self.slip[at]).max())

    @cached_property
    def place(self) -> np.ndarray:
        """What has slipped."""
        slips = self.slips.items()
        return np.asarray(sum(factor * self.seen[name] for name, factor in slips if factor))

    def rounding_of(self, columns: Sequence[str]) -> float:
        """Return the rounding of a slip, or its rate, that is a sum of columns; 0 for one alone."""
        pairs = zip(columns, self.slips.values(), strict=True)
        parts = [float(np.abs(factor * self.seen[name]).max()) for name, factor in pairs if factor]
        return 32.0 * float(np.spacing(max(parts))) if len(parts) > 1 else 0.0

    @cached_property
    def slides(self) -> np.ndarray:
        """Where the contact neither holds nor is open."""
        return np.abs(self.mode) == 1

    @cached_property
    def mode(self) -> np.ndarray:
        """Contact mode."""
        return self.seen["mode"].astype(int)

    @cached_property
    def level(self) -> np.ndarray:
        """Break-away level."""
        pairs = zip(self.seen["normal_force"], self.seen["friction"], strict=True)
        law = self.law
        return np.array([level_of(law, load, 1 if force > 0 else -1) for load, force in pairs])

    @cached_property
    def speed(self) -> float:
        """Largest slip speed; beside what moves by rounding, that of what moves most."""
        fastest = max(float(np.abs(self.seen[rate]).max()) for rate in self.case.mechanism.rates)
        return max(float(np.abs(self.slip).max()), 1e-9 * fastest)

    @cached_property
    def unnoticed(self) -> float:
        """Speed at which a reversal on bristles is not noticed."""
        if not self.law.states:
            return 0.0
        mechanism = self.case.mechanism
        rest = dict.fromkeys((*self.seen_coordinates, *self.held), 0.0)
        places = {name: float(self.seen[name][0]) for name in self.seen_coordinates}
        norm = sum(factor**2 for factor in self.slips.values())
        along = {name: factor / norm for name, factor in self.slips.items()}
        mass = 2.0 * float(mechanism.kinetic_energy(rest | places, rest | along))
        kinetic = max(_energy(self.case, self.seen, i)[1] for i in range(len(self.times)))
        sizes = (LEAST_SHARES[0] * math.sqrt(2.0 * kinetic / mass), self.least_speed)
        return UNNOTICED * max(sizes)

    @property
    def seen_coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return tuple(self.case.mechanism.coordinates)

    @property
    def held(self) -> tuple[str, ...]:
        """Names of what does not move."""
        mechanism = self.case.mechanism
        normals = [name for contact in mechanism.contacts() for name in contact.normals]
        return (*normals, *mechanism.held())

    @cached_property
    def before_lift_off(self) -> np.ndarray:
        """Where the body is on the ground; a drive that jumps may have taken it off at the end."""
        ended = self.run.status in (Status.LIFT_OFF, Status.PAINLEVE)
        return (self.times < self.run.span[1]) | (not ended)

    @cached_property
    def force(self) -> float:
        """Largest friction force or level."""
        return float(max(np.abs(self.seen["friction"]).max(), np.abs(self.level).max()))

    @cached_property
    def least_speed(self) -> float:
        """Speed below which none counts: a small share of what the largest force gives in all."""
        if self.whole is not None:
            return self.whole.least_speed
        pull = max(law.force for law in self.each) / float(self.masses.diagonal().min())
        largest = max(pull, float(self.accelerations.max(initial=0.0)))
        return LEAST_SHARES[1] * largest * self.case.t_end

    @cached_property
    def masses(self) -> np.ndarray:
        """Mass matrix where the run begins, by the kinetic energy."""
        if self.whole is not None:
            return self.whole.masses
        names = self.seen_coordinates
        rest = dict.fromkeys((*names, *self.held), 0.0)
        places = rest | {name: float(self.seen[name][0]) for name in names}

        def twice_energy(*moving: str) -> float:
            rates = rest | {name: float(moving.count(name)) for name in moving}
            return 2.0 * float(self.case.mechanism.kinetic_energy(places, rates))

        own = np.array([twice_energy(name) for name in names])
        both = np.array([[twice_energy(i, j) for j in names] for i in names])
        return np.asarray(0.5 * (both - own[:, None] - own[None, :]))

    @cached_property
    def accelerations(self) -> np.ndarray:
        """Largest acceleration of each coordinate, by differences."""
        if self.whole is not None:
            return self.whole.accelerations
        steps = np.diff(self.times)
        far = steps > ROUNDED * self.times[1:]
        rates = self.case.mechanism.rates
        changes = [np.abs(np.diff(self.seen[rate]))[far] / steps[far] for rate in rates]
        return np.array([change.max(initial=0.0) for change in changes])

    @cached_property
    def balanced(self) -> float:
        """Largest of the forces of which the friction of the contact may be the rest."""
        forces = np.abs(self.masses) @ self.accelerations
        along = [
            force / abs(self.slips[name])
            for name, force in zip(self.seen_coordinates, forces, strict=True)
            if self.slips[name]
        ]
        return max(*along, *(law.force for law in (self.whole or self).each))

    def first(self, wrong: np.ndarray) -> str:
        """Say when something is wrong first, and how often."""
        at = int(np.argmax(wrong))
        states = ", ".join(f"{n} = {self.seen[n][at]:.3g}" for n in self.run.names)
        return f"at t = {self.times[at]!r} ({wrong.sum()} of {len(wrong)}): {states}"


def is_finite(e: Evidence) -> Found:
    """States and forces are numbers."""
    for name in e.run.names:
        if not np.isfinite(e.seen[name]).all() and e.run.status is not Status.NOT_FINITE:
            yield f"{name} {e.first(~np.isfinite(e.seen[name]))}"


def has_its_span(e: Evidence) -> Found:
    """A complete run covers the time asked for, and no step runs backward."""
    first, last = e.run.span
    if first != 0.0 or (e.run.status.complete and last != e.case.t_end):
        yield f"span {e.run.span}, asked {e.case.t_end!r}"
    if last > e.case.t_end:
        yield f"ends at {last!r}, after {e.case.t_end!r}"
    backward = ~(np.diff(e.run.t) >= 0)
    if backward.any():
        at = int(np.argmax(backward))
        yield f"step {at} runs from {e.run.t[at]!r} to {e.run.t[at + 1]!r}"


def has_a_chain_of_events(e: Evidence) -> Found:
    """Events come in order, each from the mode that the one before led to."""
    events = e.run.events
    for before, after in itertools.pairwise(events):
        if after.t < before.t:
            yield f"{after.reason} at {after.t!r} comes after {before.reason} at {before.t!r}"
        if after.from_mode != before.to_mode:
            yield f"{before} leads to another mode than {after} leaves"
    if events and not (e.run.span[0] <= events[0].t and events[-1].t <= e.run.span[1]):
        yield f"events outside the span {e.run.span}"
    if not math.isfinite(sum(event.margin + event.t for event in events)):
        yield "an event has a margin or time that is no number"


def has_the_modes_of_its_events(e: Evidence) -> Found:
    """Between events the mode is the one that the last event led to."""
    if not e.run.events:
        if len(set(e.mode)) > 1:
            yield f"the mode changes without an event, {e.first(e.mode != e.mode[0])}"
        return
    starts = np.array([event.t for event in e.run.events])
    modes = np.array([e.run.events[0].from_mode, *(event.to_mode for event in e.run.events)])
    expected = modes[np.searchsorted(starts, e.times, side="right")]
    near = np.abs(e.times[:, None] - starts[None, :]).min(axis=1) <= 1e-15 * np.abs(e.times)
    wrong = (e.mode != expected) & ~near
    if wrong.any():
        yield f"mode {e.mode[np.argmax(wrong)]}, by events {expected[np.argmax(wrong)]},"
        yield e.first(wrong)


def does_not_move_while_stuck(e: Evidence) -> Found:
    """A stuck body has no speed and keeps its place."""
    if e.run.certificate.stick_drift != 0:
        yield f"drift {e.run.certificate.stick_drift!r}"
    wrong = (e.mode == 0) & (np.abs(e.slip) > e.rounding_of(e.case.mechanism.rates))
    if wrong.any():
        yield f"moves while stuck, {e.first(wrong)}"
    stuck = (e.mode[1:] == 0) & (e.mode[:-1] == 0)
    spans = np.array([start for start, _ in e.run.stick_spans()])
    same = np.searchsorted(spans, e.times[1:], "right") == np.searchsorted(
        spans, e.times[:-1], "right"
    )
    allowed = e.rounding_of(e.seen_coordinates)
    wrong = np.append(False, stuck & same & (np.abs(np.diff(e.place)) > allowed))
    events = (e.whole or e).run.events
    for i in np.flatnonzero(wrong):  # it may have slipped in what the clock takes for no time
        apart = min((abs(event.t - e.times[i]) for event in events), default=math.inf)
        wrong[i] = apart > CLOCK * np.spacing(e.times[i])
    if wrong.any():
        yield f"is elsewhere while stuck, {e.first(wrong)}"


def holds_no_more_than_break_away(e: Evidence) -> Found:
    """While stuck, friction stays within the level, or is that of bristles that are held bent."""
    excess = np.abs(e.seen["friction"]) - e.level
    if e.law.states and not e.law.static_switch:
        for i in np.flatnonzero((e.mode == 0) & (excess > 0.0)):
            bent = abs(_by_law(e, i, 0.0, float(e.seen["normal_force"][i]), 1.0))
            excess[i] = min(excess[i], abs(abs(float(e.seen["friction"][i])) - bent))
    allowed = ROUNDED * e.force + BALANCED * e.balanced
    if e.law.states:  # bristles are as accurate as states are
        allowed += STATES * e.force
    wrong = (e.mode == 0) & (excess > allowed) & e.before_lift_off
    for i in np.flatnonzero(wrong):  # a time has the rounding of an event's
        apart = [abs(event.t - e.times[i]) for event in (e.whole or e).run.events]
        if min(apart, default=math.inf) <= CLOCK * np.spacing(e.times[i]):
            before = e.run.at([max(e.run.span[0], e.times[i] - CLOCK * np.spacing(e.times[i]))])
            force, load = (float(before[name][0]) for name in ("friction", "normal_force"))
            change = abs(excess[i] - abs(force) + level_of(e.law, load, 1 if force > 0 else -1))
            wrong[i] = excess[i] > allowed + LOCATED * e.force + change
    if wrong.any():
        yield f"held beyond its level by {excess[wrong].max() / e.force:.1e}, {e.first(wrong)}"


def takes_energy_while_sliding(e: Evidence) -> Found:
    """Friction of a law without bristles never drives."""
    if e.law.states:
        return
    wrong = e.seen["friction"] * e.slip < -LOCATED * e.speed * e.force - LEAST
    wrong &= e.slides & e.before_lift_off & (e.seen["normal_force"] > 0.0)
    for i in np.flatnonzero(wrong):
        wrong[i] = abs(e.slip[i]) > e.within_the_clock(i)
    if wrong.any():
        yield f"friction drives, {e.first(wrong)}"


def moves_as_its_mode_says(e: Evidence) -> Found:
    """Mode and velocity have one sign, where the rigid equations have one solution at all."""
    if e.case.may_jam:
        return
    least = LOCATED * e.speed + e.unnoticed + FAINTEST * e.least_speed + math.sqrt(LEAST)
    least += e.rounding_of(e.case.mechanism.rates)
    wrong = (e.mode * e.slip < -least) & e.slides
    for i in np.flatnonzero(wrong):
        wrong[i] = abs(e.slip[i]) > e.within_the_clock(i)
    if wrong.any():
        yield f"moves against its mode, {e.first(wrong)}"


def has_the_friction_of_its_law(e: Evidence) -> Found:
    """While sliding, friction is what the law says, evaluated as plain numbers."""
    loads, friction = e.seen["normal_force"], e.seen["friction"]
    wrong = np.zeros(len(friction), dtype=bool)
    for i in np.flatnonzero((e.mode * e.slip > 0) & e.slides):
        v, load = float(e.slip[i]), float(loads[i])
        rounded = ((1, 1), (1 - 1e-15, 1), (1 + 1e-15, 1), (1, 1 - 1e-15), (1, 1 + 1e-15))
        expected = [_by_law(e, i, v * f, load, share) for f, share in rounded]
        rounding = 10.0 * (max(expected) - min(expected))  # of a damping times a speed, say
        wrong[i] = abs(friction[i] - expected[0]) > ROUNDED * e.force + rounding
        if wrong[i]:
            blur = e.within_the_clock(i) + e.rounding_of(e.case.mechanism.rates)
            sides = v + 2.0 * blur * np.array([-1.0, 1.0])
            expected += [_by_law(e, i, float(side), load, 1) for side in sides]
            # a branch of the law lasts to where its end is located, up to the blur beyond a kink,
            # and rises on by no more than it does in as much before the kink
            beyond = max(expected) - min(expected)
            wrong[i] = not min(expected) - beyond <= friction[i] <= max(expected) + beyond
    if wrong.any():
        yield f"friction is not that of the law, {e.first(wrong)}"


def _by_law(e: Evidence, at: int, v: float, load: float, share: float) -> float:
    if not e.law.states:
        return e.law.force(v, load)
    names = [f"{z}:{e.at_contact}" if e.at_contact else z for z in e.law.states]
    return e.law.force(v, load, tuple(float(e.seen[name][at]) * share for name in names))


def presses_on_the_ground(e: Evidence) -> Found:
    """The normal force is positive before the end, and gone where the body lifts off."""
    load = e.seen["normal_force"]
    size = np.abs(load).max()
    wrong = (load < -ROUNDED * size) & e.before_lift_off & (e.mode != UNLOADED)
    for i in np.flatnonzero(wrong):  # a load that falls within the rounding of the time
        sides = e.times[i] + CLOCK * np.spacing(e.times[i]) * np.array([-1.0, 1.0])
        about = e.run.at(np.clip(sides, *e.run.span))["normal_force"]
        wrong[i] = load[i] < -ROUNDED * size - np.abs(about - load[i]).max()
    if wrong.any():
        yield f"pulls at the ground, {e.first(wrong)}"
    lifts_off = any(x.reason == "lift-off" for x in e.run.events) and not e.case.may_jam
    if lifts_off and load[-1] > 1e-6 * size:
        yield f"lifts off with {load[-1]!r} N"


def obeys_newtons_law(e: Evidence) -> Found:
    """Momenta change by the forces of the mechanism and by friction, evaluated as plain numbers."""
    mechanism, names = e.case.mechanism, e.seen_coordinates
    if any("energy" in problem for problem in e.run.certificate.problems):
        return  # which says as much
    pairs = list(zip(names, mechanism.rates, strict=True))
    fastest = {name: float(np.abs(e.seen[rate]).max()) for name, rate in pairs}
    unit = max(fastest.values()) or 1.0
    share = e.solver.tolerance_for(e.case.law)
    begins = 10.0 * share / STATES * e.least_speed
    for start, end in _steps(e):
        t = np.array([start, *(start + (end - start) * NODES), end])
        at = e.run.at(t)
        states = [
            _Motion(
                e,
                float(t[k]),
                {name: np.longdouble(at[name][k]) for name in names},
                {name: np.longdouble(at[rate][k]) for name, rate in pairs},
            )
            for k in range(len(t))
        ]
        rests = not any(any(state.v.values()) for state in states)
        for i, name in enumerate(names):
            if name in mechanism.guided():
                continue
            first, last = (float(states[k].momentum(name, unit)) for k in (0, -1))
            impulse, moved, rounded = 0.0, 0.0, 0.0
            for k, weight in enumerate(WEIGHTS, 1):
                rubbing = [
                    -contact.slips[name] * float(at[contact.column("friction")][k])
                    for contact in e.each
                ]
                own, rounding = states[k].forces(name, unit)
                parts = [*own, *rubbing]
                rounded += weight * (end - start) * rounding
                impulse += weight * (end - start) * sum(parts)
                moved += weight * (end - start) * sum(map(abs, parts))
            speeds = [max(fastest[n], begins) for n in names]
            carried = float(np.abs(e.masses[i]) @ speeds)
            pulled = (end - start) * float(np.abs(e.masses[i]) @ e.accelerations)
            allowed = ROUNDED * (pulled + moved) + rounded + math.sqrt(LEAST)
            if not rests:
                largest = max(law.force for law in e.each)  # whose bristles are as states are
                allowed += STATES * (carried + abs(first) + abs(last) + (end - start) * largest)
                allowed += (ROUGH if falls_at_once(e.case.laws.values()) else NEWTON) * moved
            if not abs(last - first - impulse) <= allowed:
                yield f"momentum along {name} changes by {last - first:.8g} from {start!r} s to"
                yield f"{end!r} s, by its forces {impulse:.8g} of {moved:.8g}"
                return


def falls_at_once(laws: Iterable[FrictionLaw]) -> bool:
    """Whether the friction of one of several laws falls infinitely steeply from rest."""
    return any(isinstance(law, Stribeck) and law.fading_exponent < 1.0 for law in laws)


@dataclass(frozen=True)
class _Motion:
    """A state whose energies are evaluated with more digits, so that differences have enough."""

    e: Evidence
    t: float
    q: dict[str, Any]
    v: dict[str, Any]

    def lagrangian(self, q: dict[str, Any], v: dict[str, Any]) -> Any:
        """Return kinetic less potential energy."""
        mechanism, rest = self.e.case.mechanism, dict.fromkeys(self.e.held, 0.0)
        potential = mechanism.potential_energy(self.t, rest | q)
        return mechanism.kinetic_energy(rest | q, rest | v) - potential

    def momentum(self, name: str, h: float) -> Any:
        """Return the slope along a rate, which enters as a square."""
        rest = dict.fromkeys(self.e.held, 0.0)
        up, down = (
            self.e.case.mechanism.kinetic_energy(
                rest | self.q, rest | self.v | {name: self.v[name] + s}
            )
            for s in (h, -h)
        )
        return (up - down) / (2.0 * h)

    def forces(self, name: str, h: float) -> tuple[tuple[float, ...], float]:
        """Return the slope along a coordinate, forces at rest and those of motion, and rounding.

        Where that is all of the force, the slope is how the momentum changes at constant rates.
        """
        mechanism = self.e.case.mechanism
        moves = isinstance(mechanism, MatrixMechanism)
        fastest = max((abs(float(rate)) for rate in self.v.values()), default=0.0)
        if moves:
            apart, way = APART / (fastest or 1.0), self.v
        else:
            unit = mechanism.units[self.e.seen_coordinates.index(name)]
            own = max(NEAR * abs(float(self.q[name])), LEAST_APART)
            apart, way = APART if unit == "rad" else own, {name: 1.0}

        def at(share: float) -> Any:
            step = share * apart
            q = {n: x + step * way.get(n, 0.0) for n, x in self.q.items()}
            return replace(self, q=q).momentum(name, h) if moves else self.lagrangian(q, self.v)

        near, far = at(1.0) - at(-1.0), at(2.0) - at(-2.0)
        slope = (8.0 * near - far) / (12.0 * apart)
        rest = dict.fromkeys(self.e.held, 0.0)
        drives = {key: float(drive.value(self.t)) for key, drive in self.e.drives.items()}
        places, rates = (rest | {n: float(x) for n, x in of.items()} for of in (self.q, self.v))
        still = mechanism.forces(self.t, places, dict.fromkeys(rates, 0.0), drives).get(name, 0.0)
        given = mechanism.forces(self.t, places, rates, drives).get(name, 0.0)
        fine = np.finfo(np.longdouble).eps
        rounding = np.finfo(float).eps * abs(at(0.0)) + fine * abs(at(2.0))
        bend = abs(at(1.0) + at(-1.0) - 2.0 * at(0.0)) / apart / apart
        rounding += np.finfo(float).eps * bend * abs(self.q[name]) * apart  # of a place
        if moves or unit == "rad":
            rounding += 10.0 * fine * bend  # of cosines of small angles
        elif abs(far - 2.0 * near) > LOCATED * abs(far):
            rounding += abs(far)  # a spring that comes loose in between
        rounding = float(rounding) / apart
        # damping by a sum of rates has the rounding of the fastest; so has a drive that of the time
        nearby = rates | {name: rates[name] + float(np.spacing(fastest))}
        sides = self.t + CLOCK * float(np.spacing(self.t)) * np.array([-1.0, 1.0])
        for speeds, t in ((nearby, self.t), *((rates, float(side)) for side in sides)):
            then = {key: float(drive.value(t)) for key, drive in self.e.drives.items()}
            rounding += abs(mechanism.forces(t, places, speeds, then).get(name, 0.0) - given)
        return (float(slope), float(still), float(given - still)), rounding


def _steps(e: Evidence) -> list[tuple[float, float]]:
    """Return a few steps of a run, spread over all, within which all is smooth."""
    t = e.run.t
    ends = [(float(a), float(b)) for a, b in itertools.pairwise(t) if b - a > ROUNDED * abs(b)]
    return ends[:: max(1, len(ends) // MOST_STEPS)]


def keeps_its_books(e: Evidence) -> Found:
    """Energies are those of the mechanism; the balance is within its limit or a problem."""
    trust = e.run.certificate
    works = (trust.energy_end, trust.energy_start, trust.work_supplied, trust.work_friction)
    moved = max(abs(work) for work in works)
    for t, noted in ((0.0, trust.energy_start), (e.run.span[1], trust.energy_end)):
        expected, size = _energy(e.case, e.run.at(t))
        before, _ = _energy(e.case, e.run.at(max(0.0, t - CLOCK * float(np.spacing(t)))))
        allowed = LOCATED * size + PLAYED * moved + abs(before - expected)
        allowed += _rounding_of_angles(e.case, e.run.at(t))
        if abs(noted - expected) > allowed and size > LEAST:
            yield f"energy {noted!r} at {t!r}, by the mechanism {expected!r}"
    mismatch = trust.energy_end - trust.energy_start - trust.work_supplied + trust.work_friction
    if len(trust.problems) > (not e.run.status.complete):
        return
    size = moved
    if not abs(mismatch) <= 1.1e-5 * (size + _to_and_fro(e)):
        yield f"certified with a mismatch of {mismatch!r} J of {size!r} J"
    taken = trust.work_friction
    if not e.case.has_bristles and not taken >= -ROUNDED * size:
        yield f"friction has put in {-taken!r} J of {size!r} J"
    for name, work in trust.work.items():
        if not e.case.laws[name].states and not work >= -ROUNDED * size:
            yield f"friction at {name} has put in {-work!r} J of {size!r} J"


def _to_and_fro(e: Evidence) -> float:
    """Return about how much energy bristles and drives have given and taken back."""
    power = np.sum([np.abs(one.seen["friction"] * one.slip) for one in e.each], axis=0)
    energies = [_energy(e.case, e.seen, i)[0] for i in range(len(e.times))]
    by_bristles = np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(e.times))
    return float(by_bristles + np.abs(np.diff(energies)).sum())


def _energy(case: Case, at: Trajectory, i: int = 0) -> tuple[float, float]:
    """Return the energy by the mechanism's own equations, and the size of its parts."""
    mechanism = case.mechanism
    normals = [name for contact in mechanism.contacts() for name in contact.normals]
    held = dict.fromkeys((*normals, *mechanism.held()), 0.0)
    q = {name: float(at[name][i]) for name in mechanism.coordinates} | held
    names = zip(mechanism.coordinates, mechanism.rates, strict=True)
    q_dot = {name: float(at[rate][i]) for name, rate in names} | held
    q_dot |= dict.fromkeys(mechanism.computed, 0.0)  # numbers of a controller
    kinetic = float(mechanism.kinetic_energy(q, q_dot))
    potential = float(mechanism.potential_energy(float(at.t[i]), q))
    return kinetic + potential, abs(kinetic) + abs(potential)


def _rounding_of_angles(case: Case, at: Trajectory) -> float:
    """Return the rounding of what turns with angles: sums of sines, of which little may be left.

    Third differences over half turns leave nothing of springs, and eight times the height of waves.
    """
    mechanism, total = case.mechanism, 0.0
    normals = [name for contact in mechanism.contacts() for name in contact.normals]
    q = dict.fromkeys((*normals, *mechanism.held()), 0.0)
    q |= {name: float(at[name][0]) for name in mechanism.coordinates}
    for name, unit in zip(mechanism.coordinates, mechanism.units, strict=True):
        if unit == "rad":
            turned = [q | {name: q[name] + half * math.pi} for half in range(4)]
            a, b, c, d = (float(mechanism.potential_energy(float(at.t[0]), one)) for one in turned)
            total += abs(d - a - 3.0 * (c - b))
    return float(np.finfo(float).eps) * total


def follows_its_drive_while_stuck(e: Evidence) -> Found:
    """While stuck, friction less a drive along the slip does not change."""
    if not e.has_own_drive:
        return
    drive = e.drives["drive"]
    aside = CLOCK * np.spacing(e.times)
    early, at, late = (
        np.array([drive.value(float(t)) for t in e.times + shift]) for shift in (-aside, 0.0, aside)
    )
    smooth = np.ones(len(e.times), dtype=bool)  # a jump says nothing of the rounding of times
    for change in e.changes:
        smooth &= np.abs(e.times - change) > 2.0 * aside
    rest = e.seen["friction"] - at
    size = e.force + float(np.abs(rest).max())
    for start, end in e.run.stick_spans():
        inside = (e.times >= start) & (e.times < end) & (e.mode == 0)
        if not inside.any():
            continue
        clock = float(np.abs(late - early)[inside & smooth].max(initial=0.0))
        if np.ptp(rest[inside]) > ROUNDED * size + clock:
            yield f"friction does not follow the drive, {e.first(inside)}"
            return


def rests_for_good(e: Evidence) -> Found:
    """What is said to rest for good is held against all that its drive still does."""
    if e.run.status is not Status.AT_REST:
        return
    if e.slides[-1]:
        yield f"rests in mode {e.mode[-1]}"
    if not e.has_own_drive:
        return
    drive, last = e.drives["drive"], e.run.span[1]
    begin = last if e.changes == [] else max(last, *e.changes)
    later = [last * (1 + 0.01 * i) for i in range(300)] + [begin * (1 + i) for i in range(10)]
    later += [t for t in e.changes if t > last]
    change = np.array([drive.value(t) for t in later]) - drive.value(last)
    needed, load = e.seen["friction"][-1] + change, float(e.seen["normal_force"][-1])
    for side in (1, -1):
        level, most = level_of(e.law, load, side), float((side * needed).max())
        if most > level + ROUNDED * e.force:
            yield f"at rest for good, but needs {most!r} N of {level!r} N later"


def says_how_it_ended(e: Evidence) -> Found:
    """The status agrees with what was recorded."""
    run, limit = e.run, e.solver.max_steps
    if (run.status is Status.LIFT_OFF) != any(x.reason == "lift-off" for x in run.events):
        yield f"{run.status.name} with {[x.reason for x in run.events][-3:]}"
    if run.certificate.steps > limit + 1:
        yield f"{run.certificate.steps} steps, allowed {limit:g}"
    numbers = (run.certificate.energy_error, run.certificate.guard_violation)
    if run.certificate.certified and not all(map(math.isfinite, numbers)):
        yield f"certified with {numbers}"


def goes_on(e: Evidence) -> Found:
    """Several contacts neither chatter at one instant nor leave no step short enough.

    Where friction falls infinitely steeply from rest, rounding may decide that a body stops again.
    So it may where the rounding of times changes speeds by a Stribeck velocity.
    """
    stuck = (Status.ZENO, Status.STEP_TOO_SMALL, Status.NOT_FINITE)
    laws = e.case.laws.values()
    if falls_at_once(laws):
        return
    tick = CLOCK * float(np.spacing(e.run.span[1]))
    least = min((getattr(law, "stribeck_velocity", math.inf) for law in laws), default=math.inf)
    if tick * e.accelerations.max(initial=0.0) > least:
        return
    if e.run.contacts and e.run.status in stuck and not e.case.may_jam:
        yield f"{e.run.ending} {[event.reason for event in e.run.events][-4:]}"


def agrees_with_a_coarser_run(e: Evidence) -> Found:
    """A certified run is met by one with coarser steps, coarsely, unless it may fall over."""
    if isinstance(e.case.mechanism, SENSITIVE):  # upside down: errors grow beyond all bounds
        return
    coarse = EventDriven(
        tolerance=1e-9, stiff_tolerance=1e-6, max_steps=e.solver.max_steps, tier=e.solver.tier
    )
    other = run_case(e.case, coarse)
    both = e.run.certificate.certified and other.certificate.certified
    if not (both and e.run.status.complete and other.status.complete):
        return
    times = np.linspace(*e.run.span, 41)
    a, b = e.run.at(times), other.at(times)
    units = e.case.mechanism.units
    sizes = [np.abs(a[n]).max() + np.abs(b[n]).max() for n in e.case.mechanism.coordinates]
    for name, size, unit in zip(e.case.mechanism.coordinates, sizes, units, strict=True):
        largest = max(s for s, u in zip(sizes, units, strict=True) if u == unit)
        error = np.abs(a[name] - b[name]).max()
        if error > 1e-2 * size + BESIDE * largest:
            yield f"{name} differs by {error / size:.1e} of its size from a coarser run"


def is_the_same_in_the_other_tier(e: Evidence) -> Found:
    """Compiled and plain runs are equal to the last bit; plain steps take long."""
    solver = replace(e.solver, max_steps=min(FEW_STEPS, e.solver.max_steps))
    runs = [run_case(e.case, replace(solver, tier=tier)) for tier in ("compiled", "python")]
    run, other = runs
    if (other.status, other.events) != (run.status, run.events):
        yield f"{run.status.name} and {len(run.events)} events compiled,"
        yield f"{other.status.name} and {len(other.events)} events in plain Python"
        return
    times = np.linspace(*run.span, 41)
    a, b = run.at(times), other.at(times)
    for name in run.names:
        if not np.array_equal(a[name], b[name], equal_nan=True):
            yield f"{name} differs by up to {np.nanmax(np.abs(a[name] - b[name])):.1e}"


def _by_name(*checks: Callable[[Evidence], Found]) -> dict[str, Callable[[Evidence], Found]]:
    return {check.__name__.replace("_", " "): check for check in checks}


OF_CONTACTS = _by_name(
    has_a_chain_of_events,
    has_the_modes_of_its_events,
    does_not_move_while_stuck,
    holds_no_more_than_break_away,
    takes_energy_while_sliding,
    moves_as_its_mode_says,
    has_the_friction_of_its_law,
    presses_on_the_ground,
    follows_its_drive_while_stuck,
    rests_for_good,
)
"""What each contact must do."""
CHECKS = OF_CONTACTS | _by_name(
    is_finite, has_its_span, obeys_newtons_law, keeps_its_books, says_how_it_ended, goes_on
)
"""The checks by what they ask for."""


def violations(evidence: Evidence, checks: Any = CHECKS) -> list[tuple[str, str]]:
    """Return the name of each violated check, with what it found."""
    found = []
    for name, check in checks.items():
        views = evidence.each if name in OF_CONTACTS else (evidence,)
        words = " ".join(
            f"{view.at_contact} {text}".lstrip() for view in views for text in check(view)
        )
        if words:
            found.append((name, words))
    return found
