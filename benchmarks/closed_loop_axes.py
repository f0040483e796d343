"""Axes under position control, for golden records and the study of the posterior.

An axis follows slow and fast moves under a sampled proportional-derivative controller with
feedforward of the acceleration. Recorded are the position by an encoder of 0.1 to 10 um and the
commanded force, which is held between samples. Each parameter of a law spans two decades. Truths
in turn: LuGre, Stribeck, elasto-plastic, GMS with four elements, levels and slopes by direction,
and Coulomb + viscous friction of a motor that drives half of the mass through backlash.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.machines import Machine
from benchmarks.rigs import SOLVER, Array, Random, Rig, between
from stickslip import (
    GMS,
    Axis,
    CoulombViscous,
    DirectionDependent,
    ElastoPlastic,
    FrictionLaw,
    LuGre,
    Measurement,
    Stribeck,
)
from stickslip.study.control import closed_loop

TRUTHS = ("lugre", "stribeck", "elasto-plastic", "gms", "direction-dependent", "backlash")
ENCODERS = (1e-7, 1e-5)
"""Smallest and largest step of an encoder [m] in the study."""
MOVED = 100.0
"""Steps of the encoder that a record covers at least."""
FAST = (1e4, 1.2e5)
"""Least and largest rate of a controller whose records are long [Hz]."""
LASTING = 8.0
"""Duration of these [s]."""
ROWS = 80_000
"""Rows of a record at most: of faster controllers every second or further sample is recorded."""


@dataclass(frozen=True, kw_only=True)
class ControlledAxis:
    """An axis, its friction, its controller and its sensor."""

    axis: Axis
    law: FrictionLaw
    speeds: tuple[float, float]
    """Slowest and fastest speed of the moves [m/s]."""
    bandwidth: float
    """Of the controller [rad/s]."""
    encoder: float
    """Step of the encoder [m]."""
    force_noise: float
    """Standard deviation of the recorded force [N]."""
    rate: float
    """Samples per second [Hz]."""
    duration: float
    """Of a record [s]."""
    gap: float = 0.0
    """Play [m] through which the motor drives half of the mass."""


def draw(
    random: Random, truth: str, encoders: tuple[float, float] = (1e-6, 1e-5)
) -> ControlledAxis:
    """Return a random axis; each parameter spans two decades."""
    inertia = between(random, 1.0, 100.0)
    level = between(random, 2.0, 200.0)
    fast = between(random, 0.05, 0.5)
    surplus = float(random.uniform(1.2, 1.8))
    v_s = between(random, 1e-3, 1e-1) * math.sqrt(fast / 0.15)
    viscous = level / fast * between(random, 0.03, 1.0)
    encoder = between(random, *encoders)
    gap = 0.0
    if truth == "stribeck":
        law: FrictionLaw = Stribeck(
            kinetic_coefficient=level,
            static_coefficient=level * surplus,
            stribeck_velocity=v_s,
            viscous_coefficient=viscous,
        )
    elif truth == "direction-dependent":
        levels, slopes = random.uniform(0.05, 0.3, 2) * random.choice((-1.0, 1.0), 2)
        law = DirectionDependent(
            forward_kinetic_coefficient=level * (1.0 + levels),
            backward_kinetic_coefficient=level * (1.0 - levels),
            forward_viscous_coefficient=viscous * (1.0 + slopes),
            backward_viscous_coefficient=viscous * (1.0 - slopes),
        )
    elif truth == "backlash":
        law = CoulombViscous(kinetic_coefficient=level, viscous_coefficient=viscous)
        gap = fast * between(random, 0.005, 0.05)
    else:
        # breaks away after 5 um to .5 mm
        stiffness = level / between(random, 5e-6, 5e-4)
        common = {
            "kinetic_coefficient": level,
            "static_coefficient": level * surplus,
            "stribeck_velocity": v_s,
            "bristle_stiffness": stiffness,
            "viscous_coefficient": viscous,
        }
        damping = between(random, 0.1, 1.0) * 2.0 * math.sqrt(stiffness * inertia)
        if truth == "lugre":
            law = LuGre(**common, bristle_damping=damping)
        elif truth == "elasto-plastic":
            share = float(random.uniform(0.3, 0.8))
            law = ElastoPlastic(**common, bristle_damping=damping, elastic_share=share)
        else:
            law = GMS(**common, attraction=level * between(random, 10.0, 1000.0))
    offset = level * float(random.uniform(-0.2, 0.2))
    return ControlledAxis(
        # a law with a level for each direction has no constant force beside them
        axis=Axis(inertia=inertia, offset=0.0 if truth == "direction-dependent" else offset),
        law=law,
        speeds=(0.2 * v_s, fast),
        bandwidth=between(random, 20.0, 60.0),
        encoder=encoder,
        force_noise=level * between(random, 1e-3, 1e-2),
        rate=1000.0,
        duration=20.0,
        gap=gap,
    )


def reference(rig: ControlledAxis, random: Random) -> tuple[Array, Array, Array, Array]:
    """Return times, positions, velocities and accelerations (n,) of moves at many speeds."""
    t = np.arange(0.0, rig.duration, 1.0 / rig.rate)
    corners, speeds, side = [0.0], [0.0], 1.0
    while corners[-1] < t[-1]:
        peak = side * between(random, *rig.speeds)
        rise, hold = random.uniform(0.1, 0.3), random.uniform(0.2, 0.8)
        for stretch, speed in ((rise, peak), (hold, peak), (rise, 0.0), (0.05, 0.0)):
            corners.append(corners[-1] + float(stretch))
            speeds.append(speed)
        side = -side
    v = np.interp(t, corners, speeds)
    x = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) / rig.rate)])
    return t, x, v, np.gradient(v, t)


@dataclass(frozen=True, eq=False)
class Motion:
    """An axis as it moved: what no sensor shows."""

    time: Array
    position: Array
    command: Array


def moved(rig: ControlledAxis, random: Random) -> Motion:
    """Return a motion of the axis under control."""
    if rig.gap:
        return _through_gap(rig, random)
    t, x, v, a = reference(rig, random)
    inertia, w = rig.axis.inertia, rig.bandwidth

    def controller(now: float, seen: Mapping[str, float]) -> float:
        k = min(round(now * rig.rate), len(t) - 1)
        error, slip = x[k] - seen["x"], v[k] - seen["v"]
        return float(inertia * (a[k] + w * w * error + 1.4 * w * slip))

    loop = closed_loop(
        rig.axis,
        rig.law,
        controller,
        period=1.0 / rig.rate,
        t_end=float(t[-1]),
        quantisation={"x": rig.encoder},
        solver=SOLVER,
    )
    states = loop.run.at(loop.t)
    return Motion(loop.t, np.asarray(states["x"]), loop.commands)


def _through_gap(rig: ControlledAxis, random: Random) -> Motion:
    """Return a motion of a motor that drives half of the mass through a gap."""
    machine = Machine(
        rig=Rig(
            axis=rig.axis,
            law=rig.law,
            speed=rig.speeds[1],
            rate=rig.rate,
            duration=rig.duration,
            noise=0.0,
            disturbance=0.0,
            correlation_time=1.0,
            ramps=True,
        ),
        closed=True,
        split=0.5,
        frequency=60.0,
        gap=rig.gap,
    )
    result = machine.run(random)
    if result is None:
        return _through_gap(rig, random)
    return Motion(
        np.asarray(result.time), np.asarray(result.position), np.asarray(result.values("force"))
    )


def record(rig: ControlledAxis, random: Random) -> Measurement:
    """Return a record of the axis under control."""
    return sensed(rig, moved(rig, random), random)


def sensed(rig: ControlledAxis, motion: Motion, random: Random) -> Measurement:
    """Return what sensors make of a motion."""
    force = motion.command + rig.force_noise * random.standard_normal(len(motion.command))
    position = rig.encoder * np.round(motion.position / rig.encoder)
    return Measurement(time=motion.time, position=position, force=force)


def fast_lugre(random: Random) -> tuple[ControlledAxis, Measurement]:
    """Return a random axis with LuGre friction under a fast controller that moves it, recorded."""
    while True:
        rig = replace(
            draw(random, "lugre", ENCODERS), rate=between(random, *FAST), duration=LASTING
        )
        motion = moved(rig, random)
        if np.ptp(motion.position) > MOVED * rig.encoder:
            every = math.ceil(len(motion.time) / ROWS)
            kept = (x[::every] for x in (motion.time, motion.position, motion.command))
            return rig, sensed(rig, Motion(*kept), random)
