"""Friction that grows with the torque of a gear, in records of one coordinate."""

import numpy as np
import pytest
from benchmarks import closed_loop_axes

from stickslip import Axis, BamM3, Measurement, Pendulum, fit
from stickslip.evidence import GEARS
from stickslip.friction import law
from stickslip.identification.settings import PROMPT
from stickslip.identification.terms.dense_series import dense_series
from stickslip.identification.terms.findings import asked_of
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


@pytest.mark.slow
@pytest.mark.parametrize(
    ("level", "name"),
    [
        ("transmitted", "bam-m3"),
        ("motor", "level + weight[motor] + viscous"),
        ("squared", "level + weight2[transmitted] + viscous"),
        ("none", "coulomb-viscous"),
    ],
)
def test_a_pendulum_tells_what_of_its_gear_friction_grows_with(level, name):
    found = asked_of(*swung(level), "first", (), PROMPT)
    assert found.best.name == name
    assert not found.explanation.faults


@pytest.mark.slow
def test_a_share_of_the_torque_is_that_of_the_gear():
    rig, record = swung("transmitted")
    law = asked_of(rig, record, "first", (), PROMPT).best.specification.law
    # a twentieth: noise of the motion smears friction at the 26 reversals of the record
    assert law.transmitted_coefficient == pytest.approx(SHARE, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("unknown", [(), ("mechanism.inertia",)])
def test_a_constant_weight_loads_a_gear_twice(unknown):
    q, _, a = motion()
    taken = 5e-3 * a + 0.1
    record = Measurement(
        time=T,
        position=noisy(q, 1e-4),
        force=noisy(taken + friction("transmitted", taken, -0.1), 2e-3, 1),
        turning=True,
    )
    found = asked_of(Axis(inertia=5e-3, rotary=True), record, "first", unknown, PROMPT)
    assert found.best.name == "bam-m3"
    assert found.best.constant == pytest.approx(0.1, rel=0.1)


def test_back_emf_is_a_part_of_what_the_motor_pulls_with():
    rig, record = swung("transmitted")
    q, v, a = motion()
    taken = 0.6 * 9.81 * 0.15 * np.sin(q) + (0.6 * 0.15**2 + 4e-3) * a
    force = taken + friction("transmitted", taken, -0.6 * 9.81 * 0.15 * np.sin(q))
    driven = Measurement(
        time=T, position=record.position, voltage=(4.0 * force / 0.4 + 0.4 * v), turning=True
    )
    own = Pendulum(mass=0.6, length=0.15, inertia=2e-3, drive=MOTOR)
    (by_torque,) = dense_series(rig, record, "first", ())
    (by_voltage,) = dense_series(own, driven, "first", ())
    # apart from the noise of the torque, which only the first has
    left = by_voltage.covariates["transmitted"] - by_torque.covariates["transmitted"]
    assert np.sqrt(np.mean(left**2)) < 5e-3
    assert asked_of(own, driven, "first", (), PROMPT).best.name == "bam-m3"


def test_no_load_is_told_where_the_weight_is_looked_for():
    rig, record = swung("transmitted")
    (one,) = dense_series(rig, record, "first", ("mechanism.mass",))
    assert not one.covariates


@pytest.mark.slow
def test_torques_on_both_sides_of_a_gear_load_measured_friction():
    q, v, a = motion()
    rig = Axis(inertia=0.05, rotary=True)
    beside = 0.5 * np.sin(0.7 * T + 1.0) + 0.2 * np.cos(2.3 * T)
    taken = rig.inertia * a - beside
    rubbed = friction("transmitted", taken, beside)
    record = Measurement(
        time=T,
        position=q,
        velocity=v,
        friction=noisy(rubbed, 2e-3, 2),
        turning=True,
        inputs={"motor": noisy(taken + rubbed, 2e-3, 3), "external": beside},
    )
    (series,) = dense_series(rig, record, "first", ())
    left = series.covariates["transmitted"] - (taken + rubbed - beside)
    assert np.sqrt(np.mean(left**2)) < 0.05  # what inertia takes would be 0.3
    assert asked_of(rig, record, "first", (), PROMPT).best.name == "bam-m3"
    found = {one.path: one for one in fit(rig, BamM3, record).estimates}
    one = found["friction.transmitted_coefficient"]
    assert one.low < SHARE < one.high


def rubbed(inertia=0.2, friction=10.0):
    """Return a record whose force is hardly more than friction, and that force and speed (n,)."""
    q, v, a = motion()
    force = inertia * a + friction * np.sign(v)
    record = Measurement(time=T, position=noisy(q, 1e-6), force=noisy(force, 0.05))
    return record, force, v


def test_a_gear_that_takes_all_of_the_force_does_not_explain_it():
    record, _, _ = rubbed()
    free = ["friction.*", "mechanism.inertia"]
    gear, coulomb = (
        fit(Axis(inertia=0.2), one, record, vary=free, route="inverse-dynamics")
        for one in ("gear", "coulomb")
    )
    # along the measured force a share of all of it leaves nothing of what has no inertia
    assert coulomb.rms < 0.1
    assert gear.rms > 0.5


def test_what_a_gear_leaves_is_an_error_of_the_force_that_the_motion_takes():
    record, force, v = rubbed()
    gear = law("level + weight[motor]")
    found = fit(Axis(inertia=0.2), gear, record, vary=["friction.*"], route="inverse-dynamics")
    problem = found.problem
    values = {
        "friction.kinetic_coefficient": 5.0,
        "friction.motor_coefficient": 0.4,
        "mechanism.offset": 0.0,
    }
    left = problem.linearise(np.array([values[one] for one in problem.free_parameters.paths]))
    taken = force - 10.0 * np.sign(v)
    predicted = (taken + 5.0 * np.sign(v)) / (1.0 - 0.4)  # its motor drives throughout
    seen = np.interp(problem.times, T, force - predicted)
    fast = np.abs(np.interp(problem.times, T, v)) > 1.0  # the filter smears reversals
    np.testing.assert_allclose(left.residual[fast], seen[fast], atol=0.1)  # noise: 0.05


@pytest.mark.slow
def test_impacts_in_a_gap_are_no_load_of_a_gear():
    """A level that grows with the torque leaves 6 % of its friction, far more than noise."""
    rig, record, _ = closed_loop_axes.moving(np.random.default_rng([8841, 17]), "backlash")
    given = Axis(inertia=1.5 * rig.axis.inertia)
    asked = asked_of(given, record, "zero", ["mechanism.inertia"], PROMPT)
    assert not any(one.kind in GEARS for one in asked.explanation.best.structure.terms)
    (fault,) = asked.explanation.faults
    assert "backlash" in fault.kinds
