"""A two-link arm with known laws, and records of it that need no run."""

from dataclasses import replace

import numpy as np

from stickslip import CoulombViscous, Measurement, RecordSettings, TwoLinkArm
from stickslip.engine.formulation import JointTorques

ARM = TwoLinkArm(
    upper_mass=0.5, upper_length=0.2, upper_centre=0.18, upper_inertia=0.025,
    lower_mass=0.6, lower_centre=0.22, lower_inertia=0.035, rotor_inertia=6e-5, gear_ratio=6.0,
)  # fmt: skip
GUESSED = replace(ARM, upper_centre=0.1, upper_inertia=0.05, lower_centre=0.15, lower_inertia=0.02)
LINEAR = ("upper_centre", "upper_inertia", "lower_centre", "lower_inertia")
JOINTS = ("shoulder", "elbow")
TRUTH = {
    "shoulder": CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=0.02),
    "elbow": CoulombViscous(kinetic_coefficient=0.1, viscous_coefficient=0.01),
}
QUICK = RecordSettings(hold="first")


def motion(seed, span=10.0, jitter=0.0):
    """Return times and motions of both joints: sums of sines, with their derivatives.

    Times have a jitter, over a step.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, span, 0.002)
    t += 0.002 * jitter * np.random.default_rng(seed + 2000).uniform(-1.0, 1.0, len(t))
    places, rates, accelerations = np.zeros((3, len(t), 2))
    for i in range(2):
        for w in rng.uniform(2.0, 12.0, 5):
            size, phase = rng.uniform(0.1, 0.3), rng.uniform(0.0, 2.0 * np.pi)
            places[:, i] += size * np.sin(w * t + phase)
            rates[:, i] += size * w * np.cos(w * t + phase)
            accelerations[:, i] -= size * w * w * np.sin(w * t + phase)
    return t, places, rates, accelerations


def record(seed, laws=TRUTH, *, noise=1e-4, torque=0.01, span=10.0, **given):
    """Return what would be measured of a motion: inverse dynamics, so that no run is needed."""
    t, q, v, a = motion(seed, span)
    forces, _ = JointTorques.of(ARM, []).along(ARM, t, q, v, a)
    for i, name in enumerate(JOINTS):
        if laws[name] is not None:
            forces[:, i] += laws[name].force(v[:, i], 1.0)
    rng = np.random.default_rng(seed + 1000)
    q, forces = q + rng.normal(0.0, noise, q.shape), forces + rng.normal(0.0, torque, q.shape)
    return Measurement(
        time=t,
        position=dict(zip(JOINTS, q.T, strict=True)),
        force=dict(zip(JOINTS, forces.T, strict=True)),
        **given,
    )


def parts(one):
    """Return times, positions and forces by joint."""
    return (
        np.asarray(one.time),
        {name: own.position for name, own in one.joints.items()},
        {name: own.force for name, own in one.joints.items()},
    )
