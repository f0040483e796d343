"""Friction that grows with the torque of a gear, in records of one coordinate."""

import numpy as np

from stickslip import Axis, BamM3, Measurement, Pendulum, fit, select
from stickslip.friction import law
from stickslip.identify.problems.record_rows import MIDDLE
from stickslip.mechanisms import DCMotor

T = np.arange(0.0, 16.0, 4e-3)
SIZES, RATES, PHASES = (0.5, 0.3, 0.2), (1.7, 3.9, 6.1), (0.3, 2.0, 4.4)
MOTOR = DCMotor(resistance=4.0, torque_constant=0.4, rotor_inertia=2e-3)
SHARE = 0.15


def motion():
    """Return positions, velocities and accelerations (n,)."""
    parts = list(zip(SIZES, RATES, PHASES, strict=True))
    q = sum(a * np.sin(w * T + p) for a, w, p in parts)
    v = sum(a * w * np.cos(w * T + p) for a, w, p in parts)
    return q, v, -sum(a * w**2 * np.sin(w * T + p) for a, w, p in parts)


def friction(level, taken, external, *, viscous=0.02, share=SHARE):
    """Return friction (n,) of a gear: of the torque that it transmits, friction is a part."""
    _, v, _ = motion()
    found = np.zeros_like(v)
    for _ in range(100):
        loads = {
            "transmitted": np.abs(taken + found - external),
            "motor": np.abs(taken + found),
            "squared": 0.4 * (taken + found - external) ** 2,
            "none": 0.0,
        }
        found = np.sign(v) * (0.05 + share * loads[level]) + viscous * v
    return found


def noisy(values, size, seed=0):
    return values + size * np.random.default_rng(seed).standard_normal(len(values))


def swung(level, *, seed=0):
    """Return a pendulum and its record under a torque."""
    rig = Pendulum(mass=0.6, length=0.15, inertia=4e-3)
    q, _, a = motion()
    weight = 0.6 * 9.81 * 0.15 * np.sin(q)
    taken = weight + (0.6 * 0.15**2 + 4e-3) * a
    force = taken + friction(level, taken, -weight)
    record = Measurement(
        time=T, position=noisy(q, 1e-4, seed), force=noisy(force, 2e-3, seed + 1), turning=True
    )
    return rig, record


def test_the_share_of_the_torque_that_a_gear_loses_is_found_by_a_fit():
    rig, record = swung("transmitted")
    found = fit(rig, law("level + weight[transmitted] + viscous"), record)
    share = found.estimate("transmitted_coefficient")
    assert share.low <= SHARE <= share.high
    assert share.high - share.low < 0.5 * SHARE


def test_points_beside_a_band_are_at_what_the_gear_transmits_usually_under_any_load():
    t = np.arange(0.0, 40.0, 0.01)
    v = 0.5 * np.cos(1.3 * t) + 0.4 * np.cos(2.9 * t)
    x = 0.5 * np.sin(1.3 * t) / 1.3 + 0.4 * np.sin(2.9 * t) / 2.9
    load, through = 2.0 + np.sin(0.41 * t), 4.0 + 3.0 * np.sin(0.67 * t)
    noise = 0.01 * np.random.default_rng(1).normal(size=len(t))
    friction = (0.1 * load + 0.2 * through + 0.05 * np.abs(v)) * np.sign(v) + noise
    record = Measurement(
        time=t, position=x, velocity=v, friction=friction, load=load,
        inputs={"transmitted": through},
    )  # fmt: skip
    judgement = select(Axis(inertia=1.0), [BamM3], record).judgement
    points, model = judgement.measured(), judgement.problem.model
    rows = model.balance.rows(MIDDLE)
    at = [int(np.flatnonzero(rows.velocity == u)[0]) for u in points.velocity]
    pressed = rows.seen([piece.record.load for piece in model.balance.pieces])[at]
    usual = 0.1 * pressed + 0.2 * np.median(through) + 0.05 * np.abs(points.velocity)
    assert np.std(np.abs(points.friction) - usual) < 0.01
