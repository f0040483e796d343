"""Tests of sliding: steady friction, and the energy that it takes in a cycle.

Passivity is searched for, not proved: cycles of motion at piecewise constant velocity are drawn,
the states of the law are followed through each by the method of Runge and Kutta, and the search
goes on around those in which friction takes the least energy.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from stickslip.errors import InputError, SimulationError
from stickslip.friction import FrictionLaw
from stickslip.maths import Latches
from stickslip.show.formatting import quantity
from stickslip.study.characterization.bench import Array, Bench, Characteristic, presliding_length

# Friction after long sliding at each velocity, and what the contact holds at rest.

DECADES = 2
"""Speeds are looked at so many decades below and above the one at which friction changes."""
SEEN = 2.0
"""Friction over the highest level, up to which they are looked at one decade farther."""
SAMPLES = 201
"""Speeds on each side."""
FALL = 0.01
"""Share of the force by which it has to fall for a drive to stick and slip."""
ROUNDING = 1e-9
"""Share of the force by which it has to fall, or to rise, to depend on speed."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SteadyCurve(Characteristic):
    """The steady curve of a law."""

    test: ClassVar[str] = "steady"
    title: ClassVar[str] = "Steady sliding"
    columns: ClassVar[Mapping[str, str]] = {"velocity": "m/s", "force": "N"}
    over: ClassVar[str] = "velocity"

    velocity: Array
    """Slip velocity (n,) [m/s], from backwards to forwards; 0 is left out."""
    force: Array
    """Friction force (n,) [N]."""
    break_away: tuple[float, float]
    """Largest force at rest, backwards and forwards [N]."""
    holds: bool
    """Whether the body stays at rest under any smaller force."""

    @property
    def sentence(self) -> str:
        ahead, back = (self._side(side) for side in (1, -1))
        same = ahead == back
        return ahead if same else f"Forwards: {_lower(ahead)} Backwards: {_lower(back)}"

    def _side(self, side: int) -> str:
        """Return what one direction of slip says."""
        chosen = self.velocity * side > 0.0
        speed, force = np.abs(self.velocity[chosen]), np.abs(self.force[chosen])
        order = np.argsort(speed)
        speed, force = speed[order], force[order]
        rest = self.break_away[(side + 1) // 2]
        if rest <= 0.0:
            top = int(np.argmax(force >= 0.9 * force.max()))
            return (
                f"At rest it holds nothing: friction grows from 0 to {quantity(force[top], 'N')} at"
                f" {quantity(speed[top], 'm/s')}, so that a body never sticks."
            )
        low = int(np.argmin(force))
        start = max(rest, float(force[0]))
        if force[low] < (1.0 - FALL) * start:
            falls = force[0] >= (1.0 + FALL) * force[low]
            where = f" at {quantity(speed[low], 'm/s')}" if falls else ""
            what = "A drive that is soft can stick and slip"
            rises = " and rises beyond" if force[-1] > (1.0 + FALL) * force[low] else ""
            return (
                f"Break-away takes {quantity(start, 'N')}, sliding {quantity(force[low], 'N')}"
                f"{where}{rises}. {what}{' below this speed' if falls and rises else ''}."
            )
        begins = f"Break-away and slow sliding take {quantity(rest, 'N')}; friction"
        steps = np.diff(force) / force.max()
        if (steps < -ROUNDING).any():
            most = quantity(speed[-1], "m/s")
            return f"{begins} falls by no more than 1 % at speeds up to {most}."
        how = "grows with" if force[-1] > (1.0 + ROUNDING) * force[0] else "does not depend on"
        return f"{begins} {how} speed, so that steady sliding is stable."


def steady_curve(bench: Bench) -> SteadyCurve:
    """Return the steady curve of a law.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> print(steady_curve(Bench(law=law)).sentence)
    Break-away takes 1.5 N, sliding 1 N. A drive that is soft can stick and slip.
    """
    law, load = bench.curve, bench.load
    reach = 10.0**DECADES
    farther = np.abs(law.steady(bench.speed * 10.0 * reach * np.array([-1.0, 1.0]), load))
    slow = np.max(farther) <= SEEN * bench.levels[1]  # viscous friction is hardly seen before
    speeds = bench.speed * np.geomspace(1.0 / reach, 10.0 * reach if slow else reach, SAMPLES)
    velocity = np.concatenate([-speeds[::-1], speeds])
    force = np.asarray(law.steady(velocity, load), dtype=np.float64) + np.zeros_like(velocity)
    back, ahead = (float(law.towards(side).break_away(load)) for side in (-1, 1))
    least, most = (quantity(speed, "m/s") for speed in speeds[[0, -1]])
    return SteadyCurve(
        velocity=velocity,
        force=force,
        break_away=(back, ahead),
        holds=law.holds,
        conditions=f"{least} to {most} both ways, normal force {quantity(load, 'N')}.",
    )


def _lower(text: str) -> str:
    return text[0].lower() + text[1:]


# Whether friction can return more work than it takes, and the motion in which it does.

TRIED, KEPT, ROUNDS = 120, 8, 4
"""Motions that the search begins with, those it goes on from, and how often it does."""
AROUND, SPREAD = 6, 0.5
"""Motions around each, and how far their speeds and ways scatter in the first round [ln 1]."""
PIECES = 3
"""Pieces of constant velocity of a motion."""
CYCLE_SPEEDS = (1e-2, 1e2)
"""Speeds of a motion over the one at which friction changes."""
WAYS = (0.05, 4.0)
"""Ways at one velocity over the presliding length."""
ENERGY_CYCLES = 6
"""Cycles until a motion repeats itself."""
SEARCHED = 3
"""The same in the search."""
LENGTH_STEPS = 32
"""Steps of Runge-Kutta for each presliding length."""
FEWEST_STEPS = 64
"""Steps of each piece at least."""
CHECKED, FINER, AGREED = 10, 4, 1e-3
"""Motions that are looked at with shorter steps, how much shorter these are, and how far their
energies may differ, over break-away times presliding length."""
SMALL = 1e-6
"""Energy of a cycle over break-away times presliding length that counts as none."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Passivity(Characteristic):
    """The least energy that a search found a cycle of motion to take."""

    test: ClassVar[str] = "passivity"
    title: ClassVar[str] = "Passivity"
    columns: ClassVar[Mapping[str, str]] = {"velocity": "m/s", "duration": "s"}

    worst: float
    """Energy that friction takes in the worst cycle [J]; negative if it returns some."""
    velocity: Array
    """Velocities of that cycle (n,) [m/s]."""
    duration: Array
    """How long each lasts (n,) [s]."""
    cycles: int
    """Number of motions tried; 0 where none is needed."""
    scale: float
    """Break-away times presliding length [J]."""

    @property
    def passive(self) -> bool:
        """Whether no motion was found that gains energy from friction."""
        return self.worst >= -SMALL * self.scale

    @property
    def sentence(self) -> str:
        if not self.passive:
            motion = ", ".join(
                f"{quantity(v, 'm/s')} for {quantity(t, 's')}"
                for v, t in zip(self.velocity, self.duration, strict=True)
            )
            return (
                f"It is not passive: friction returns {quantity(-self.worst, 'J')} in each cycle of"
                f" {motion}; a proof of stability that takes friction as passive does not hold."
            )
        if not self.cycles:
            return "It is passive at all speeds tried: friction acts against the velocity."
        return (
            f"No cycle of {self.cycles} that were tried gains energy from friction; this is no"
            " proof that none does."
        )


def cycle_energy(
    law: FrictionLaw,
    velocity: Sequence[float] | Array,
    duration: Sequence[float] | Array,
    *,
    load: float = 1.0,
    cycles: int = ENERGY_CYCLES,
    finer: int = 1,
) -> Array:
    """Return the energy that friction takes in a cycle of motion at piecewise constant velocity.

    The states are followed by the equations of the law at these velocities, which no body of finite
    mass can take on; the energy is that of the last cycle.

    Parameters
    ----------
    law : FrictionLaw
        The law; its states begin at 0.
    velocity : sequence of float or array (n,) or (n, m)
        Velocity of each piece, of one motion or of several [m/s].
    duration : sequence of float or array (n,) or (n, m)
        How long each piece lasts [s].
    load : float
        Normal force [N].
    cycles : int
        How often the motion is repeated.
    finer : int
        How many times shorter the steps are than usual.

    Returns
    -------
    array (m,)
        Energy [J]; negative if friction returns more than it takes.

    Raises
    ------
    InputError
        If velocities and durations do not belong together.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> float(cycle_energy(Coulomb(kinetic_coefficient=0.5), [0.1, -0.1], [1.0, 1.0])[0])
    0.1
    """
    v, t = (np.atleast_2d(np.asarray(item, dtype=np.float64).T).T for item in (velocity, duration))
    if v.shape != t.shape or not (t > 0.0).all():
        raise InputError(
            f"a cycle needs as many durations above 0 s as velocities, got {v.shape[0]} velocities"
            f" and {t.shape[0]} durations."
        )
    # Without states friction follows from the velocity: no steps are needed.
    if not law.states:
        force = np.array([law.steady(item, load) for item in v]) + np.zeros_like(v)
        return np.asarray((force * v * t).sum(axis=0))
    length = presliding_length(law, load)
    z = tuple(np.zeros(v.shape[1]) for _ in law.states)
    flags = Latches(off=True)
    for _ in range(cycles):
        energy = np.zeros(v.shape[1])
        for speed, lasts in zip(v, t, strict=True):
            way = float(np.abs(speed * lasts).max()) / length
            # So many steps for each presliding length, over which states relax.
            count = finer * max(FEWEST_STEPS, int(np.ceil(LENGTH_STEPS * way)))
            z, work = _moved(law, load, speed, lasts / count, count, z, flags)
            energy = energy + work
    return energy


def _moved(
    law: FrictionLaw,
    load: float,
    v: Array,
    h: Array,
    count: int,
    z: tuple[Array, ...],
    flags: Latches,
) -> tuple[tuple[Array, ...], Array]:
    """Return the states after some steps at constant velocities, and the work of friction."""

    def rates(at: tuple[Array, ...]) -> tuple[Array, ...]:
        with flags:
            return tuple(np.asarray(rate) + np.zeros_like(v) for rate in law.rates(v, load, at))

    def power(at: tuple[Array, ...]) -> Array:
        with flags:
            return np.asarray(law.force(v, load, at)) * v

    def after(step: Array, by: tuple[Array, ...]) -> tuple[Array, ...]:
        return tuple(array + step * rate for array, rate in zip(z, by, strict=True))

    work = np.zeros_like(v)
    before, k1 = power(z), rates(z)
    for _ in range(count):
        k2 = rates(after(0.5 * h, k1))
        k3 = rates(after(0.5 * h, k2))
        k4 = rates(after(h, k3))
        start, first = z, k1
        z = tuple(
            array + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
            for array, a, b, c, d in zip(z, k1, k2, k3, k4, strict=True)
        )
        k1 = rates(z)
        half = tuple(  # of the cubic through both ends
            0.5 * (a + b) + h / 8.0 * (c - d)
            for a, b, c, d in zip(start, z, first, k1, strict=True)
        )
        now = power(z)
        # Simpson's rule, with the state half-way.
        work = work + h / 6.0 * (before + 4.0 * power(half) + now)
        before = now
        # Latches turn between steps only; rates are those of their new sides then.
        if flags:
            rates(z)
            flags.turn()
            before, k1 = power(z), rates(z)
    return z, work


def passivity(bench: Bench, *, tried: int = TRIED, seed: int = 0) -> Passivity:
    """Search for a cycle of motion in which friction returns more work than it takes.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> print(passivity(Bench(law=Coulomb(kinetic_coefficient=0.5))).sentence)
    It is passive at all speeds tried: friction acts against the velocity.
    """
    law, load = bench.curve, bench.load
    conditions = f"Normal force {quantity(load, 'N')}; velocities that jump and stay constant"
    scale = bench.levels[1] * bench.reach
    if not law.states:
        speeds = bench.speed * np.geomspace(1e-4, 1e4, 401)
        speeds = np.concatenate([-speeds, speeds])
        power = (np.asarray(law.steady(speeds, load)) + np.zeros_like(speeds)) * speeds
        gaining = speeds[[int(np.argmin(power))]] if power.min() < 0.0 else speeds[:0]
        duration = bench.reach / np.abs(gaining)
        return Passivity(
            worst=float(sum(power.min() * duration)),
            velocity=gaining,
            duration=duration,
            cycles=0,
            scale=scale,
            conditions=(
                f"Normal force {quantity(load, 'N')}; steady curve up to"
                f" {quantity(speeds[-1], 'm/s')}."
            ),
        )

    def searched(speed: Array, way: Array) -> Array:
        with np.errstate(all="ignore"):  # of motions that are too fast for the steps
            found = cycle_energy(law, speed, way / np.abs(speed), load=load, cycles=SEARCHED)
        return np.where(np.isfinite(found), found, np.inf)

    random = np.random.default_rng(seed)
    way, speed = (
        size * np.exp(random.uniform(np.log(low), np.log(high), size=(PIECES, tried)))
        for size, (low, high) in ((bench.reach, WAYS), (bench.speed, CYCLE_SPEEDS))
    )
    # The first half goes one way; in the rest each piece goes either way.
    speed[:, tried // 2 :] *= random.choice([-1.0, 1.0], size=(PIECES, tried - tried // 2))
    # slow, then too fast for the states to follow
    speed[:, 0] = bench.speed * np.array([0.1, 100.0, 100.0])
    way[:, 0] = bench.reach * np.array([1.7, 1.2, 0.1])
    energy = searched(speed, way)
    count = tried
    for n in range(ROUNDS):
        best = np.argsort(energy)[:KEPT]
        speed, way, energy = speed[:, best], way[:, best], energy[best]
        spread = SPREAD / (n + 1)
        near = [
            np.repeat(array, AROUND, axis=1)
            * np.exp(random.normal(scale=spread, size=(PIECES, KEPT * AROUND)))
            for array in (speed, way)
        ]
        fastest = CYCLE_SPEEDS[1] * bench.speed
        near = [np.clip(near[0], -fastest, fastest), np.minimum(near[1], WAYS[1] * bench.reach)]
        count += KEPT * AROUND
        energy = np.append(energy, searched(*near))
        speed, way = (np.append(a, b, axis=1) for a, b in zip((speed, way), near, strict=True))
    lasts = way / np.abs(speed)
    # An energy that differs with the steps is an artefact: the next motion is looked at.
    for i in np.argsort(energy)[:CHECKED]:
        with np.errstate(all="ignore"):
            worst, finer = (
                float(cycle_energy(law, speed[:, i], lasts[:, i], load=load, finer=n)[0])
                for n in (1, FINER)
            )
        if abs(worst - finer) <= AGREED * (scale + abs(finer)):
            break
    else:
        raise SimulationError(
            "The equations change too fast for the search: its energies differ with the steps."
        )
    return Passivity(
        worst=worst,
        velocity=speed[:, i],
        duration=lasts[:, i],
        cycles=count,
        scale=scale,
        conditions=f"{conditions}; energy of the last of {ENERGY_CYCLES} cycles.",
    )
