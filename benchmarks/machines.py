"""Made-up servo axes with one thing wrong, stepped in time: what no catalogue mechanism can do.

Time stepping with implicit friction (Moreau 1988): a step of velocity, from which friction takes
what it can. `tests/benchmarks/test_faults.py` compares a machine without a fault with the engine.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from benchmarks.rigs import Array, Random, Rig, autocorrelated, pushing, ramped, waving
from stickslip import Measurement

Wave = Callable[[float, float, float], float]
"""A number that depends on position [m], time over that of the record, and velocity [m/s]."""

FINE = 8
"""Steps between two samples."""
BANDWIDTH = 25.0
"""Of the position loop [rad/s]: fast for the motion, slow for the delays that are built in."""
DAMPING = 0.7
QUIET = 250.0
"""Corner of the filter of the controller's velocity [rad/s]."""


def _same(_x: float, _t: float, _v: float) -> float:
    return 1.0


def _none(_x: float, _t: float, _v: float) -> float:
    return 0.0


@dataclass(frozen=True, kw_only=True)
class Machine:
    """A rig that is stepped in time, with what may be wrong with it, its amplifier and sensors."""

    rig: Rig
    closed: bool = False
    """Whether a controller of position makes the force, which is recorded; else it is planned."""
    level: Wave = field(default=_same)
    """Friction level over that of the law."""
    viscous: Wave = field(default=_same)
    """Viscous coefficient over that of the law."""
    extra: Wave = field(default=_none)
    """Force [N] against the drive."""
    split: float = 0.0
    """Share of the mass behind a joint that gives; 0 without one."""
    frequency: float = 0.0
    """Natural frequency of the joint [Hz]."""
    gap: float = 0.0
    """Play in the joint [m]."""
    force_delay: float = 0.0
    """By how much the force acts later than recorded [s]."""
    force_lag: float = 0.0
    """Time constant of the amplifier [s]."""
    force_limit: float = math.inf
    """What the amplifier can give, over the largest force that is asked for."""
    position_delay: float = 0.0
    """By how much the position is recorded later than it was [s]."""
    position_lag: float = 0.0
    """Time constant of the position's filter [s]."""

    def run(self, random: Random) -> Measurement | None:
        """Return a record, or None if the machine hardly reverses."""
        rig = self.rig
        t = np.arange(0.0, rig.duration, 1.0 / rig.rate)
        if self.closed:
            speed = (ramped if rig.ramps else waving)(rig, t, random)
            asked = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) / rig.rate)])
        else:
            speed, asked = np.zeros(0), pushing(rig, t, random)
        scale = float(np.std(pushing(rig, t, random)))
        disturbed = rig.disturbance * scale * autocorrelated(rig, len(t), random)
        noise = rig.noise * random.standard_normal(len(t))
        x, v, force = self._stepped(asked, speed, disturbed, noise, 3.0 * scale)
        moving = np.sign(v[np.abs(v) > 0.02 * rig.speed])
        if np.count_nonzero(np.diff(moving)) < 6:
            return None
        return Measurement(time=t, position=self._sensed(t, x) + noise, force=force)

    def _sensed(self, t: Array, x: Array) -> Array:
        """Return the position that is recorded (n,)."""
        late = np.interp(t - self.position_delay, t, x)
        if self.position_lag:
            pole = math.exp(-1.0 / (self.rig.rate * self.position_lag))
            late = _lagged(late, pole)
        return late

    def _stepped(
        self, asked: Array, speed: Array, disturbed: Array, noise: Array, largest: float
    ) -> tuple[Array, Array, Array]:
        """Return position, velocity and recorded force at the samples."""
        rig, n = self.rig, len(asked)
        law, axis = rig.law, rig.axis
        level, viscous = float(law.kinetic_coefficient), float(law.viscous_coefficient)  # type: ignore[attr-defined]
        dt = 1.0 / (FINE * rig.rate)
        near, far = axis.inertia * (1.0 - self.split), axis.inertia * self.split
        stiffness = (2.0 * math.pi * self.frequency) ** 2 * near * far / axis.inertia
        damping = 0.04 * math.sqrt(stiffness * max(near * far / axis.inertia, 0.0))
        late, pole = round(self.force_delay / dt), math.exp(-dt / max(self.force_lag, 1e-9))
        most = self.force_limit * (largest if self.closed else float(np.max(np.abs(asked))))
        kp = axis.inertia * BANDWIDTH**2
        kd, filtered, rate = 2.0 * DAMPING * axis.inertia * BANDWIDTH, 0.0, 0.0
        x = v = y = w = acted = 0.0
        positions, velocities, forces = np.zeros(n), np.zeros(n), np.zeros(n)
        given: list[float] = []
        memory = math.exp(-QUIET / rig.rate)
        for k in range(n):
            positions[k], velocities[k] = x, v
            if self.closed:
                seen = x + float(noise[k])
                rate = memory * rate + (1.0 - memory) * (seen - filtered) * rig.rate if k else 0.0
                filtered = seen
                command = (
                    kp * (asked[k] - seen) + kd * (speed[k] - rate) + level * np.sign(speed[k])
                )
            else:
                command = asked[k]
            forces[k] = command
            limited = min(max(float(command), -most), most)
            here = float(disturbed[k]) - axis.offset
            for step in range(FINE):
                given.append(limited)
                delayed = given[-1 - late] if len(given) > late else 0.0
                acted = pole * acted + (1.0 - pole) * delayed
                when = (k + step / FINE) / n
                pushed = acted + here - self.extra(x, when, v)
                c = viscous * self.viscous(x, when, v)
                joint = 0.0
                if far:
                    stretch = x - y
                    slack = math.copysign(max(abs(stretch) - 0.5 * self.gap, 0.0), stretch)
                    joint = stiffness * slack + (damping * (v - w) if slack else 0.0)
                before = v
                # half of what is viscous is taken at the end of the step: second order
                free = (near * v + dt * (pushed - joint - 0.5 * c * v)) / (near + 0.5 * dt * c)
                v = _held(free, dt * level * self.level(x, when, v) / (near + 0.5 * dt * c))
                x += 0.5 * dt * (before + v)
                if far:
                    before, w = w, w + dt * joint / far
                    y += 0.5 * dt * (before + w)
        return positions, velocities, forces


def _held(free: float, most: float) -> float:
    """Return a velocity from which friction took what it can, at most to 0."""
    return math.copysign(max(abs(free) - most, 0.0), free)


def _lagged(values: Array, pole: float) -> Array:
    """Return samples through a filter of first order."""
    from scipy.signal import lfilter

    start = np.array([pole * values[0]])
    return np.asarray(lfilter([1.0 - pole], [1.0, -pole], values, zi=start)[0])
