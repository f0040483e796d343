"""Made-up records of an axis under control whose friction, faults and noise are known.

An inertia with friction, an encoder with steps and noise, and a recorded command with noise. The
controller is sampled; the motion is a sum of sines, then moves with dwells, slow ones among them.
"""

import math
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stickslip import Measurement

Array = NDArray[np.float64]

RATE = 1000
"""Samples of the controller and of the record [1/s]."""
STEPS = 10
"""Steps of the simulation in each of them."""
SECONDS = 24.0
ROOM = 20.0


@dataclass(frozen=True, kw_only=True)
class Plant:
    """An axis: torques in N m, angles in rad."""

    inertia: float = 0.02
    forward: float = 1.0
    """Level of friction forwards."""
    backward: float = 1.0
    step_forward: float = 0.0
    """Stribeck step forwards."""
    step_backward: float = 0.0
    stribeck_velocity: float = 0.1
    stribeck_exponent: float = 1.0
    viscous: float = 0.0
    viscous_backward: float | None = None
    exponent: float = 1.0
    """Exponent of viscous friction."""
    offset: float = 0.0
    by_load: float = 0.0
    """Level for each unit of load."""
    by_temperature: float = 0.0
    """Change of the level, relative, for each degree."""
    ripple: float = 0.0
    level_ripple: float = 0.0
    """Ripple of the level, relative."""
    wave: float = 6.0
    """Wave number of ripples."""
    length: float = 0.0
    """Length of the bristle; 0 for a friction without memory."""
    bristle_exponent: float = 1.0
    lugre: bool = False
    second: float = 0.0
    """Level of a second memory."""
    second_length: float = 0.0
    spring: float = 0.0
    hose: float = 0.0
    """Stiffness of a hose whose force relaxes."""
    relaxation: float = 1.0
    """Time [s] in which it does."""
    lag: float = 0.0
    """Time [s] by which the Stribeck step follows the speed."""
    growth: float = 0.0
    """Growth of the static level at rest, relative, by time over 50 ms, logarithmic."""
    lorentz: float = 0.0
    """Not 0: the Stribeck step fades as 1 / (1 + u^2)."""
    load_exponent: float = 1.0
    """Exponent of the load."""
    dead: float = 0.0
    """Command that the amplifier does not deliver, either way."""
    drift: float = 0.0
    """Change of the level over the record, relative."""
    limit: float = math.inf
    """Torque that the amplifier delivers."""
    delay: float = 0.0
    """Delay [s] of the recorded command."""
    gap: float = 0.0
    """Gap to a load of half of the inertia."""
    coupling: float = 0.0
    """Resonance [Hz] of a flexible coupling to it."""
    encoder: float = 1e-4
    noise: float = 3e-5
    """Noise of the encoder."""
    force_noise: float = 0.03
    calm: float = 1.0
    """Size of the motion."""


@dataclass(frozen=True)
class Truth:
    """A record's name, what a right answer holds, and the axis."""

    name: str
    kinds: str
    plant: Plant
    fault: str = ""
    """The fault that is built in, if any."""


def _truth(name: str, kinds: str, fault: str = "", **plant: float) -> Truth:
    return Truth(name, kinds, Plant(**plant), fault)  # type: ignore[arg-type]


TRUTHS = (
    _truth("cv1", "level viscous", viscous=0.3),
    _truth("cv2", "level viscous", forward=0.6, backward=0.6, viscous=0.15, encoder=3e-4),
    _truth("cv3", "level viscous", viscous=0.6, force_noise=0.08),
    _truth("c1", "level"),
    _truth("c2", "level offset", offset=0.15),
    _truth("dd1", "level offset viscous", forward=1.1, backward=0.85, viscous=0.3),
    _truth(
        "dd2", "level offset viscous viscous_dir",
        forward=1.1, backward=0.9, viscous=0.25, viscous_backward=0.4,
    ),
    _truth("dd3", "level viscous viscous_dir", viscous=0.3, viscous_backward=0.18),
    _truth("pv1", "level power", viscous=0.6, exponent=0.5),
    _truth("pv2", "level power", forward=0.5, backward=0.5, viscous=0.8, exponent=0.6),
    _truth("pv3", "level power", viscous=0.5, exponent=0.7),
    _truth(
        "st1", "level stribeck viscous", forward=0.8, backward=0.8,
        step_forward=0.5, step_backward=0.5, stribeck_velocity=0.05, viscous=0.3,
    ),
    _truth(
        "st2", "level stribeck viscous", forward=0.8, backward=0.8,
        step_forward=0.4, step_backward=0.4, stribeck_velocity=0.3, viscous=0.3,
    ),
    _truth(
        "ds1", "level stribeck stribeck_dir power", forward=0.8, backward=0.8,
        step_forward=0.6, step_backward=0.3, viscous=0.5, exponent=0.5,
    ),
    _truth("da1", "level memory viscous", length=3e-3, viscous=0.3),
    _truth("da2", "level memory viscous", length=1.5e-2, viscous=0.3),
    _truth("da3", "level memory load", length=5e-3, forward=0.3, backward=0.3, by_load=0.5),
    _truth(
        "da4", "level memory power",
        length=8e-3, bristle_exponent=2.0, viscous=0.5, exponent=0.6,
    ),
    _truth(
        "lg1", "level memory stribeck viscous", length=2e-3, forward=0.8, backward=0.8,
        step_forward=0.4, step_backward=0.4, viscous=0.3, lugre=True,
    ),
    _truth(
        "lg2", "level memory stribeck viscous", length=8e-3, forward=0.8, backward=0.8,
        step_forward=0.5, step_backward=0.5, stribeck_velocity=0.3, viscous=0.2, lugre=True,
    ),
    _truth("ri1", "level ripple", ripple=0.15, wave=12.0),
    _truth("ri2", "level level_ripple viscous", level_ripple=0.2, wave=8.0, viscous=0.3),
    _truth(
        "lo1", "level load viscous", forward=0.3, backward=0.3, by_load=0.5, viscous=0.3
    ),
    _truth("te1", "level temperature viscous", by_temperature=-0.02, viscous=0.4),
)  # fmt: skip
"""The 24 structures that the engine was made with."""

FAULTS = (
    _truth("f_delay1", "level viscous", "delay", viscous=0.3, delay=0.004),
    _truth(
        "f_delay2", "level stribeck viscous", "delay",
        viscous=0.3, delay=0.012, step_forward=0.3, step_backward=0.3,
    ),
    _truth("f_sat1", "level viscous", "saturation", viscous=0.15, limit=1.9),
    _truth(
        "f_sat2", "level stribeck viscous", "saturation",
        viscous=0.1, limit=1.8, step_forward=0.2, step_backward=0.2,
    ),
    _truth("f_gap1", "level viscous", "backlash", viscous=0.3, gap=0.02),
    _truth("f_gap2", "level viscous", "backlash", viscous=0.3, gap=0.05),
    _truth("f_spr1", "level viscous", "spring", viscous=0.3, spring=0.2),
    _truth("f_spr2", "level viscous", "spring", viscous=0.3, spring=0.5),
    _truth("f_dri1", "level viscous", "drift", viscous=0.3, drift=0.3),
    _truth("f_dri2", "level viscous", "drift", viscous=0.3, drift=-0.25),
    _truth("f_flex1", "level viscous", "flexible", viscous=0.3, coupling=12.0),
    _truth("f_flex2", "level viscous", "flexible", viscous=0.3, coupling=25.0),
)  # fmt: skip
"""The 12 rigs with a fault."""

FURTHER = (
    _truth(
        "two1", "level memory second viscous",
        length=2e-3, second=0.6, second_length=3e-2, forward=0.7, backward=0.7, viscous=0.2,
    ),
    _truth("tp1", "level temperature power", by_temperature=-0.02, viscous=0.5, exponent=0.5),
    _truth(
        "ddd1", "level level_dir memory viscous",
        length=6e-3, forward=1.1, backward=0.8, viscous=0.3,
    ),
    _truth(
        "rs1", "level level_ripple stribeck viscous", forward=0.8, backward=0.8,
        step_forward=0.5, step_backward=0.5, level_ripple=0.2, wave=10.0, viscous=0.3,
    ),
    _truth("dr1", "level quadratic", viscous=0.3, exponent=2.0),
    _truth("ep1", "level memory viscous", length=6e-3, bristle_exponent=0.0, viscous=0.3),
    _truth("coarse", "level viscous", viscous=0.3, encoder=2e-3, noise=3e-4),
    _truth("quiet", "level viscous", viscous=0.3, calm=0.15),
)  # fmt: skip
"""Eight more, which the engine was not made with."""

ALL = (*TRUTHS, *FAULTS, *FURTHER)


@dataclass(frozen=True, kw_only=True, eq=False)
class AxisRecord:
    """A record of an axis, with what is true of it."""

    t: Array
    q: Array
    force: Array
    true_position: Array
    """Positions (n,) [rad] without steps and noise of the encoder."""
    friction: Array
    """True friction (n,) [N m], means over samples."""
    covariates: dict[str, Array] = field(default_factory=dict)

    @property
    def measured(self) -> Measurement:
        """The record as a user has it."""
        known = dict(self.covariates)
        load = known.pop("load", 1.0)
        return Measurement(
            time=self.t, position=self.q, force=self.force, load=load, inputs=known, turning=True
        )


def record(
    truth: Truth, seed: int, seconds: float = SECONDS, speeds: Sequence[float] = ()
) -> AxisRecord:
    """Return a record of an axis; its motion and noise depend on its name and the seed only.

    With `speeds` it moves steadily at each of them in turn, for a twentieth of the time.
    """
    plant = truth.plant
    random = np.random.default_rng([seed, zlib.crc32(truth.name.encode())])
    if speeds:
        wanted = _stretches(speeds, seconds / 20.0)
        t = np.arange(len(wanted)) / RATE
        seconds = len(wanted) / RATE
    else:
        t = np.arange(round(seconds * RATE)) / RATE
        wanted = _reference(random, t, plant.calm)
    load = 1.2 + 0.8 * np.sin(
        2.0 * np.pi * random.uniform(0.15, 0.4) * t + random.uniform(0.0, 6.0)
    )
    temperature = ROOM + 15.0 * (1.0 - np.exp(-t / (0.4 * seconds)))
    level = 1.0 + plant.drift * t / seconds + plant.by_temperature * (temperature - ROOM)
    dither = plant.noise * random.normal(size=len(t))
    noise = plant.force_noise * random.normal(size=len(t))
    q, x, command, friction = _simulated(
        plant, wanted, level, plant.by_load * load**plant.load_exponent, dither
    )
    force = command + noise
    if plant.delay:
        force = np.interp(t - plant.delay, t, force)
    covariates = {}
    if plant.by_load:
        covariates["load"] = load
    if plant.by_temperature:
        covariates["temperature"] = temperature
    return AxisRecord(
        t=t, q=q, force=force, true_position=x, friction=friction, covariates=covariates
    )


def _stretches(speeds: Sequence[float], lasting: float) -> Array:
    """Return a motion (n,) that is steady at each speed in turn and goes back between them."""
    ramp, rest = np.linspace(0.0, 1.0, round(0.1 * RATE)), np.zeros(round(0.1 * RATE))
    hold = np.ones(round(lasting * RATE))
    shape = np.concatenate([rest, ramp, hold, ramp[::-1], rest])
    u = np.linspace(0.0, 1.0, len(shape))
    back = 30.0 * u**2 * (1.0 - u) ** 2
    back *= np.sum(shape) / np.sum(back)
    return np.cumsum(np.concatenate([v * x for v in speeds for x in (shape, -back)])) / RATE


def _reference(random: np.random.Generator, t: Array, calm: float) -> Array:
    """Return a motion (n,): a sum of sines, then moves of all speeds with dwells."""
    end = float(t[-1])
    turn = 0.4 * end
    result = np.zeros_like(t)
    for f in random.uniform(0.12, 1.4, 4):
        size = calm * random.uniform(0.15, 0.5) / max(f, 0.4)
        result += size * np.sin(2.0 * np.pi * f * t + random.uniform(0.0, 2.0 * np.pi))
    result /= 1.0 + np.exp((t - turn) / 0.08)
    result -= result[-1]
    at, begun = 0.0, turn
    while begun < end - 1.5:
        target = calm * random.uniform(-1.2, 1.2)
        speed = calm * math.exp(random.uniform(math.log(0.08), math.log(2.5)))
        lasting = min(max(abs(target - at) / speed, 0.25), 4.0)
        goal = at + math.copysign(min(abs(target - at), speed * lasting), target - at)
        u = np.clip((t - begun) / lasting, 0.0, 1.0)
        result += (goal - at) * u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
        at = goal
        begun += lasting + random.uniform(0.15, 0.6)
    return result


def _simulated(
    plant: Plant, wanted: Array, level: Array, loaded: Array, dither: Array
) -> tuple[Array, Array, Array, Array]:
    """Return encoder readings, positions, commands and mean friction (n,) of the axis."""
    h, tick = 1.0 / RATE / STEPS, 1.0 / RATE
    two = plant.gap > 0.0 or plant.coupling > 0.0
    j = plant.inertia
    motor = 0.5 * j if two else j
    omega = 2.0 * math.pi * (4.0 if plant.coupling else 8.0)
    gain, damping, integral = j * omega**2, 1.4 * omega * j, j * omega**3 / 8.0
    speed = np.gradient(wanted, tick)
    acceleration = np.gradient(speed, tick)
    friction = _friction(plant, motor, h)
    link = _link(plant, h)
    x, v, reading, filtered, summed = float(wanted[0]), 0.0, float(wanted[0]), 0.0, 0.0
    readings, positions, commands, frictions = [], [], [], []
    rows = zip(
        wanted.tolist(), speed.tolist(), acceleration.tolist(), level.tolist(), loaded.tolist(),
        dither.tolist(), strict=True,
    )  # fmt: skip
    for r, dr, ddr, times, added, chatter in rows:
        q = round((x + chatter) / plant.encoder) * plant.encoder
        filtered += 0.25 * ((q - reading) * RATE - filtered)
        reading = q
        positions.append(x)
        summed = min(max(summed + integral * (r - q) * tick, -1.5), 1.5)
        command = gain * (r - q) + damping * (dr - filtered) + summed + j * ddr
        driven = min(max(command, -plant.limit), plant.limit)
        if plant.dead:
            driven = math.copysign(max(abs(driven) - plant.dead, 0.0), driven)
        total = 0.0
        for _ in range(STEPS):
            pushed = driven - plant.spring * x
            if two:
                pushed += link(x, v)
            new, acted = friction(x, v, pushed, times, added)
            total += acted
            v = new
            x += h * v
        readings.append(q)
        commands.append(command)
        frictions.append(total / STEPS)
    result = (np.array(item) for item in (readings, positions, commands, frictions))
    return tuple(result)  # type: ignore[return-value]


def _link(plant: Plant, h: float) -> Callable[[float, float], float]:
    """Return the torque of a load behind a gap or a flexible coupling, which moves with it."""
    inertia, half = 0.5 * plant.inertia, 0.5 * plant.gap
    stiffness = 400.0
    if plant.coupling:
        stiffness = (2.0 * math.pi * plant.coupling) ** 2 * 0.5 * inertia
    at: list[float] = []

    def acting(x: float, v: float) -> float:
        if not at:
            at.extend((x, 0.0))
        apart = at[0] - x
        over = math.copysign(max(abs(apart) - half, 0.0), apart)
        torque = stiffness * over + 0.05 * (at[1] - v) if over else 0.0
        at[1] -= h / inertia * torque
        at[0] += h * at[1]
        return torque

    return acting


def _friction(
    plant: Plant, inertia: float, h: float
) -> Callable[[float, float, float, float, float], tuple[float, float]]:
    """Return the step of the velocity under a torque, with the friction that acts in it.

    Without memory friction is set-valued: it stops what it can within the step.
    """
    forward, backward, p = plant.forward, plant.backward, plant
    back = p.viscous if p.viscous_backward is None else p.viscous_backward
    states = [0.0, 0.0]
    hose, lagging, resting = 0.0, 0.0, 0.0

    def step(x: float, v: float, pushed: float, times: float, added: float) -> tuple[float, float]:
        nonlocal hose, lagging, resting
        size = abs(v)
        beside = p.offset
        if p.hose:
            hose += h * (v - hose / p.relaxation)
            beside += p.hose * hose
        if v:
            viscous = p.viscous if v > 0.0 else back
            beside += math.copysign(viscous * size**p.exponent, v)
        if p.ripple:
            beside += p.ripple * math.sin(p.wave * x)
        if p.level_ripple:
            times *= 1.0 + p.level_ripple * math.sin(p.wave * x)
        decay = 0.0
        if p.step_forward or p.step_backward:
            lagging = lagging + h / p.lag * (size - lagging) if p.lag else size
            decay = _faded(p, lagging)
        up = times * (forward + p.step_forward * decay + added)
        down = times * (backward + p.step_backward * decay + added)
        if not p.length:
            free = v + h / inertia * (pushed - beside)
            most = h / inertia * (up if free > 0.0 else down)
            resting = 0.0 if v else resting + h
            most *= 1.0 + p.growth * math.log1p(resting / 0.05)
            new = math.copysign(max(abs(free) - most, 0.0), free)
            return new, beside + (free - new) * inertia / h
        acting = _lugre(states, v, h, p, inertia, up if v > 0.0 else down) if p.lugre else 0.0
        if not p.lugre:
            states[0] = _dahl(states[0], h * v / p.length, p.bristle_exponent)
            acting = (up if states[0] > 0.0 else down) * states[0]
            if p.second:
                states[1] = _dahl(states[1], h * v / p.second_length, 1.0)
                acting += p.second * times * states[1]
        return v + h / inertia * (pushed - beside - acting), beside + acting

    return step


def _faded(p: Plant, speed: float) -> float:
    """Return what is left of the Stribeck step at a speed, from 1 at rest."""
    u = speed / p.stribeck_velocity
    return 1.0 / (1.0 + u * u) if p.lorentz else math.exp(-(u**p.stribeck_exponent))


def _dahl(state: float, way: float, n: float) -> float:
    """Return the state of a bristle after a way over its length, by an exact step."""
    if not way:
        return state
    left = 1.0 - math.copysign(1.0, way) * state
    if n == 0.0:
        left = max(left - abs(way), 0.0)
    elif n == 1.0:
        left *= math.exp(-abs(way))
    else:
        power = max(left, 1e-12) ** (1.0 - n) - (1.0 - n) * abs(way)
        left = power ** (1.0 / (1.0 - n)) if power > 0.0 else 0.0
    return math.copysign(1.0, way) * (1.0 - left)


def _lugre(
    states: list[float], v: float, h: float, p: Plant, inertia: float, level: float
) -> float:
    """Return the torque of a LuGre bristle after a step, with damping that fades with speed."""
    rate = v / p.length - abs(v) / p.length * states[0] * p.forward / level
    states[0] += h * rate
    damping = 0.3 * math.sqrt(p.forward / p.length * inertia) * p.length * math.exp(-abs(v) / 0.05)
    return p.forward * states[0] + damping * rate
