"""A motor with its voltage, limits and loops against closed forms and SciPy."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import (
    Axis,
    BamM1,
    BamM4,
    Coulomb,
    CoulombViscous,
    Measurement,
    Pendulum,
    TwoMassAxis,
    fit,
    load_rig,
    simulate,
)
from stickslip.data import rig_toml
from stickslip.errors import InputError, ParameterError
from stickslip.mechanisms import (
    CurrentLoop,
    DCMotor,
    Link,
    PositionLoop,
    Robot,
    RobotJoint,
    SampledLoop,
    SerialArm,
    VelocityLoop,
)
from stickslip.mechanisms.drives import Sampled, Square
from stickslip.show.plots.animations import moments_of
from stickslip.study.control import PID, closed_loop

MOTOR = DCMotor(
    resistance=3.0,
    torque_constant=0.02,
    back_emf_constant=0.021,
    gear_ratio=20.0,
    rotor_inertia=5e-6,
)
LAW = BamM1(kinetic_coefficient=0.05, viscous_coefficient=0.01)
INERTIA = 0.004


def constant(value):
    return Sampled(times=[0.0], values=[value])


def test_a_step_of_voltage_gives_the_exponential_of_the_motors_time_constant():
    motor = replace(MOTOR, drive=constant(6.0))
    run = simulate(Axis(inertia=INERTIA, drive=motor, rotary=True), LAW, t_end=0.5)
    inertia = INERTIA + 400.0 * 5e-6
    damping = 0.01 + 400.0 * 0.02 * 0.021 / 3.0
    push = 20.0 * 0.02 * 6.0 / 3.0 - 0.05
    t = np.linspace(0.0, 0.5, 50)
    wanted = push / damping * (1.0 - np.exp(-damping * t / inertia))
    # closed form: rounding of some hundred steps
    np.testing.assert_allclose(run.at(t)["v"], wanted, rtol=1e-11, atol=1e-11)


def test_a_motor_whose_winding_is_shorted_brakes_and_one_with_an_open_winding_does_not():
    rig = Axis(inertia=INERTIA, drive=MOTOR, rotary=True)
    inertia = INERTIA + 400.0 * 5e-6
    still = CoulombViscous(kinetic_coefficient=0.0, viscous_coefficient=0.0)
    run = simulate(rig, still, t_end=0.1, y0={"v": 5.0})
    rate = 400.0 * 0.02 * 0.021 / 3.0 / inertia
    assert run.at(0.1)["v"] == pytest.approx(5.0 * math.exp(-0.1 * rate), rel=1e-12)
    opened = replace(rig, drive=replace(MOTOR, current_limit=0.0))
    run = simulate(opened, still, t_end=0.1, y0={"v": 5.0})
    assert run.at(0.1)["v"] == pytest.approx(5.0, rel=1e-12)


def test_a_motor_without_speed_holds_up_to_the_friction_and_breaks_away_at_the_closed_form():
    ramp = Sampled(times=[0.0, 1.0], values=[0.0, 1.0], hold="first")
    run = simulate(Axis(inertia=INERTIA, drive=replace(MOTOR, drive=ramp)), LAW, t_end=1.0)
    (first, *_) = run.events
    # n k_t u / R = 0.05 N m
    assert first.reason == "break-away"
    assert first.t == pytest.approx(0.05 * 3.0 / (20.0 * 0.02), rel=1e-12)


@pytest.mark.parametrize(
    "law",
    [
        LAW,
        BamM4(
            kinetic_coefficient=0.02,
            static_coefficient=0.03,
            transmitted_coefficient=0.12,
            transmitted_static_surplus=0.05,
            stribeck_velocity=0.3,
            fading_exponent=1.0,
            viscous_coefficient=0.004,
        ),
    ],
    ids=["M1", "M4"],
)
def test_a_position_loop_that_saturates_agrees_with_scipy_up_to_the_first_stop(law):
    motor = replace(
        MOTOR,
        supply=7.0,
        supply_resistance=0.4,
        current_limit=1.6,
        loop=PositionLoop(gain=40.0, rate_gain=0.3),
        drive=constant(1.2),
    )
    servo = Pendulum(mass=0.3, length=0.12, drive=motor)
    run = simulate(servo, law, t_end=3.0)
    reasons = [event.reason for event in run.events]
    assert {"voltage leaves its limit", "current leaves its limit"} <= set(reasons)
    end = next(e.t for e in run.events if e.reason in ("stop", "reversal"))
    arm, inertia = 0.3 * 9.81 * 0.12, 0.3 * 0.12**2 + 400.0 * 5e-6

    def slopes(_, y):
        asked = 40.0 * (1.2 - y[0]) - 0.3 * y[1]
        u = min(max(asked, -7.0), 7.0)
        i = (u - 0.021 * 20.0 * y[1]) / (3.0 + 0.4 * (u / 7.0) ** 2)
        motor = 20.0 * 0.02 * min(max(i, -1.6), 1.6)
        weight = -arm * math.sin(y[0])
        if isinstance(law, BamM1):
            friction = 0.05 + 0.01 * y[1]
        else:
            left = math.exp(-abs(y[1] / 0.3))
            friction = 0.02 + 0.01 * left + (0.12 + 0.05 * left) * abs(motor - weight)
            friction += 0.004 * y[1]
        return [y[1], (motor + weight - friction) / inertia]

    # it moves forward from the start, so that friction has one sign until then
    reference = solve_ivp(
        slopes, (1e-9, end), [0.0, 1e-12], method="DOP853", rtol=1e-10, atol=1e-12, max_step=1e-4
    )
    # the reference steps over corners of the limits: 1e-4 s times 1e-4 of the speed
    np.testing.assert_allclose(run.at(end)["theta"], reference.y[0, -1], rtol=1e-7)
    assert abs(reference.y[1, -1]) < 1e-4
    assert run.certificate.certified


def test_a_position_loop_rests_where_its_torque_and_the_weight_are_within_the_friction():
    motor = replace(MOTOR, supply=7.0, loop=PositionLoop(gain=40.0), drive=constant(0.8))
    servo = Pendulum(mass=0.3, length=0.12, drive=motor)
    run = simulate(servo, LAW, t_end=5.0)
    theta = float(run["theta"][-1])
    left = 20.0 * 0.02 / 3.0 * 40.0 * (0.8 - theta) - 0.3 * 9.81 * 0.12 * math.sin(theta)
    assert abs(left) <= 0.05
    assert run.events[-1].reason == "stop"


def test_a_velocity_loop_settles_at_the_speed_of_its_closed_form():
    motor = replace(MOTOR, loop=VelocityLoop(gain=2.0), drive=constant(3.0))
    run = simulate(Axis(inertia=INERTIA, drive=motor, rotary=True), LAW, t_end=3.0)
    push, brake = 20.0 * 0.02 / 3.0, 400.0 * 0.02 * 0.021 / 3.0
    wanted = (push * 2.0 * 3.0 - 0.05) / (push * 2.0 + brake + 0.01)
    assert run.at(3.0)["v"] == pytest.approx(wanted, rel=1e-11)


def test_a_sampled_loop_tends_to_the_continuous_one_as_its_period_falls():
    servo = Pendulum(mass=0.3, length=0.12, drive=replace(MOTOR, supply=7.0))
    pid = PID(proportional=40.0, derivative=0.3, reference=0.8, state="theta", rate="omega")
    held = replace(
        servo,
        drive=replace(
            servo.drive, loop=PositionLoop(gain=40.0, rate_gain=0.3), drive=constant(0.8)
        ),
    )
    exact = simulate(held, LAW, t_end=0.3)
    errors = []
    for period in (4e-3, 1e-3, 2.5e-4):
        loop = closed_loop(servo, LAW, pid, period=period, t_end=0.3, limit=7.0)
        errors.append(abs(loop.run.at(0.2)["theta"] - exact.at(0.2)["theta"]).item())
    # until 0.11 s both are at their limit; the hold is a delay of half a period: first order
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.3)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.3)


def test_the_transmitted_torque_has_that_of_the_motor():
    motor = replace(MOTOR, drive=constant(6.0))
    servo = Pendulum(mass=0.3, length=0.12, drive=motor)
    told = servo.contact_inputs(0.0, {"theta": 0.4}, {"theta": 2.0}, {"drive": 6.0})
    current = (6.0 - 0.021 * 20.0 * 2.0) / 3.0
    weight = -0.3 * 9.81 * 0.12 * math.sin(0.4)
    assert told["motor"] == pytest.approx(20.0 * 0.02 * current, rel=1e-13)
    assert told["transmitted"] == pytest.approx(20.0 * 0.02 * current - weight, rel=1e-13)


FILE = """
[mechanism]
type = "pendulum"
mass = 0.3
length = "12 cm"

[mechanism.drive]
type = "dc-motor"
resistance = { value = "3 ohm", vary = true }
torque_constant = "20 +- 1 mN m/A"
gear_ratio = 20.0
supply = "7 V"
loop = { type = "position", gain = "40 V/rad" }
drive = { type = "square", high = 0.5, low = -0.5, period = 2.0 }

[friction.bam-m1]
kinetic_coefficient = 0.05
viscous_coefficient = 0.01
"""


def test_a_rig_file_has_a_motor_with_unknown_and_uncertain_parameters(tmp_path):
    file = tmp_path / "servo.toml"
    file.write_text(FILE)
    rig = load_rig(file)
    assert rig.mechanism.drive == DCMotor(
        resistance=3.0,
        torque_constant=0.02,
        gear_ratio=20.0,
        supply=7.0,
        loop=PositionLoop(gain=40.0),
        drive=Square(high=0.5, low=-0.5, period=2.0),
    )
    assert rig.vary == ("mechanism.drive.resistance",)
    assert rig.parameter_uncertainties == {"mechanism.drive.torque_constant": 0.001}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"3 ohm"', '"3 V"', r"mechanism\.drive\.resistance.*ohm"),
        (
            '"position"',
            '"torque"',
            r"mechanism\.drive\.loop\.type.*position, sampled-position, velocity",
        ),
        ('"dc-motor"', '"dc-moter"', r"mechanism\.drive\.type.*Did you mean 'dc-motor'"),
        ("gear_ratio", "gear_ration", r"\[mechanism\.drive\].*Did you mean 'gear_ratio'"),
        ('torque_constant = "20 +- 1 mN m/A"', "", r"mechanism\.drive\.torque_constant.*missing"),
        ('supply = "7 V"', 'supply = "-7 V"', r"mechanism\.drive\.supply.*above 0 V"),
    ],
)
def test_a_rig_file_says_what_is_wrong_with_a_motor(tmp_path, old, new, said):
    file = tmp_path / "servo.toml"
    file.write_text(FILE.replace(old, new))
    with pytest.raises(InputError, match=said):
        load_rig(file)


@pytest.mark.parametrize("rubs", ["load", "motor"])
def test_a_motor_drives_its_side_of_a_shaft_that_gives(rubs):
    rig = TwoMassAxis(
        motor_inertia=INERTIA,
        load_inertia=0.01,
        stiffness=50.0,
        damping=0.05,
        rubs=rubs,
        rotary=True,
        drive=replace(MOTOR, drive=constant(6.0)),
    )
    law = CoulombViscous(kinetic_coefficient=0.05, viscous_coefficient=0.01)
    run = simulate(rig, law, t_end=20.0)
    # both turn at the speed of the rigid axis, after forty of its time constants of 0.2 s at least
    wanted = (20.0 * 0.02 * 6.0 / 3.0 - 0.05) / (0.01 + 400.0 * 0.02 * 0.021 / 3.0)
    last = run.at(20.0)
    np.testing.assert_allclose([last["v"], last["other_dot"]], wanted, rtol=1e-9)
    # a shaft at rest holds nothing of the motor, whose rotor takes most of the torque
    motor = "v" if rubs == "motor" else "other_dot"
    start = simulate(rig, law, t_end=1e-5).at(1e-5)[motor]
    torque = 20.0 * 0.02 * 6.0 / 3.0 - (0.05 if rubs == "motor" else 0.0)
    # back-EMF and damper take off 1e-4 of it by then
    assert start == pytest.approx(1e-5 * torque / (INERTIA + 400.0 * 5e-6), rel=1e-3)
    (moment,) = moments_of(run, rig, np.array([20.0]))
    assert moment["drive"] == pytest.approx(0.05 + 0.01 * wanted, rel=1e-9)


def test_a_rig_file_has_the_loop_of_firmware(tmp_path):
    file = tmp_path / "servo.toml"
    loop = """type = "sampled-position", gain = "40 V/rad", integral_gain = "3 V/rad/s",
    period = "4 ms", delay = "2 ms", duty_limit = 0.8, step = "8 mV" """
    old = next(line for line in FILE.splitlines() if line.startswith("loop"))
    text = FILE.replace(old, f"loop = {{ {' '.join(loop.split())} }}")
    file.write_text(text)
    rig = load_rig(file)
    assert rig.mechanism.drive.loop == SampledLoop(
        gain=40.0, integral_gain=3.0, period=4e-3, delay=2e-3, duty_limit=0.8, step=8e-3
    )
    again = tmp_path / "again.toml"
    again.write_text(rig_toml(rig.mechanism, LAW))
    assert load_rig(again).mechanism == rig.mechanism


def test_a_motor_stands_alone_in_a_list_of_drives(tmp_path):
    file = tmp_path / "servo.toml"
    text = FILE.replace("[mechanism.drive]", "[[mechanism.drive]]")
    pulse = '[[mechanism.drive]]\ntype = "pulse"\nlevel = 1.0\nduration = 1.0\n'
    file.write_text(text.replace("[friction.bam-m1]", pulse + "[friction.bam-m1]"))
    with pytest.raises(InputError, match="stands alone"):
        load_rig(file)


def test_a_droop_without_a_supply_is_refused():
    with pytest.raises(ParameterError, match="supply"):
        DCMotor(resistance=1.0, torque_constant=1.0, supply_resistance=0.1)


def test_commands_come_in_steps_within_the_limit():
    servo = Axis(inertia=INERTIA, drive=MOTOR, rotary=True)
    loop = closed_loop(
        servo, LAW, lambda t, _: 10.0 * t, period=0.01, t_end=0.2, limit=1.0, step=0.3
    )
    np.testing.assert_allclose(loop.commands[:6], [0.0, 0.0, 0.3, 0.3, 0.3, 0.6], atol=1e-12)
    assert loop.commands[-1] == 1.0
    assert loop.requested[-1] == pytest.approx(1.9)


def test_a_supply_that_droops_is_refused_beside_a_loop_that_sets_the_current():
    with pytest.raises(ParameterError, match="leave it out, or give another loop"):
        DCMotor(
            resistance=3.0, torque_constant=0.4, supply=12.0, supply_resistance=1.0,
            loop=CurrentLoop(),
        )  # fmt: skip


JOINT_MOTOR = DCMotor(
    resistance=2.0, torque_constant=0.05, gear_ratio=10.0, rotor_inertia=1e-5, supply=12.0
)
LINK = Link(mass=0.4, length=0.2, centre=0.15, inertia=0.4 * 0.15**2, damping=0.01)


def told(motor, value):
    return replace(motor, drive=Sampled(times=[0.0], values=[value]))


def as_robot(motor):
    joint = RobotJoint(
        joint="hinge", mass=0.4, centre_z=-0.15, axis=(0, 1, 0), damping=0.01, effort=motor
    )
    return Robot(joints=(joint,))


@pytest.mark.parametrize("make", [lambda m: SerialArm(links=(replace(LINK, torque=m),)), as_robot])
def test_a_motor_at_a_joint_moves_one_link_as_it_moves_a_pendulum(make):
    motor = replace(JOINT_MOTOR, loop=PositionLoop(gain=15.0), current_limit=3.0)
    motor = told(motor, 1.0)
    law = CoulombViscous(kinetic_coefficient=0.05, viscous_coefficient=0.02)
    pendulum = Pendulum(mass=0.4, length=0.15, damping=0.01, drive=motor)
    t = np.linspace(0.0, 1.5, 61)
    one, other = (simulate(rig, law, t_end=1.5) for rig in (pendulum, make(motor)))
    angle = "hinge" if "hinge" in other.units else "q1"
    np.testing.assert_allclose(one.at(t)["theta"], other.at(t)[angle], rtol=0.0, atol=1e-8)
    # both meet the limits of supply and current at the same times
    limits = [[e.t for e in run.events if "limit" in str(e.reason)] for run in (one, other)]
    assert len(limits[0]) >= 2
    np.testing.assert_allclose(*limits, atol=1e-8)


def test_a_joint_under_a_voltage_comes_to_its_steady_speed():
    arm = SerialArm(links=(replace(LINK, torque=told(JOINT_MOTOR, 6.0)), LINK), gravity=0.0)
    # the elbow is held by its friction, straight: nothing pulls at it at a constant speed
    laws = {
        "joint-1": Coulomb(kinetic_coefficient=0.3),
        "joint-2": Coulomb(kinetic_coefficient=50.0),
    }
    run = simulate(arm, laws, t_end=20.0)
    push, brake = 10.0 * 0.05 * 6.0 / 2.0, (10.0 * 0.05) ** 2 / 2.0
    assert run["q1_dot"][-1] == pytest.approx((push - 0.3) / (0.01 + brake), rel=1e-9)


def test_a_stalled_joint_holds_what_its_voltage_gives():
    lean, weight = 0.7, 0.4 * 9.81 * 0.15
    voltage = weight * np.sin(lean) * 2.0 / (10.0 * 0.05)
    arm = SerialArm(links=(replace(LINK, torque=told(JOINT_MOTOR, voltage)),))
    run = simulate(arm, Coulomb(kinetic_coefficient=0.0), t_end=5.0, y0={"q1": lean})
    np.testing.assert_allclose(run["q1"], lean, rtol=1e-9)


def test_what_motors_of_an_arm_give_is_stored_and_dissipated():
    motors = [told(JOINT_MOTOR, volts) for volts in (5.0, -3.0)]
    arm = SerialArm(links=tuple(replace(LINK, torque=one) for one in motors))
    law = CoulombViscous(kinetic_coefficient=0.05, viscous_coefficient=0.02)
    run = simulate(arm, law, t_end=1.0)
    t = np.linspace(0.0, 1.0, 20001)
    seen = run.at(t)
    work = lost = 0.0
    for i, (motor, volts) in enumerate(zip(motors, (5.0, -3.0), strict=True)):
        v = seen[f"q{i + 1}_dot"]
        work = work + motor.force(volts, 0.0, v) * v
        lost = lost + 0.03 * v * v + 0.05 * np.abs(v)
    q = {name: seen[name][-1] for name in arm.coordinates}
    rates = np.array([seen[name][-1] for name in arm.rates])
    kinetic = 0.5 * rates @ np.array(arm.mass_matrix(q), dtype=float) @ rates
    gained = arm.potential_energy(0.0, q) - arm.potential_energy(0.0, dict.fromkeys(q, 0.0))
    # the quadrature errs by 1e-6 of the work, at reversals
    given = float(np.trapezoid(work - lost, t))
    assert given == pytest.approx(float(kinetic + gained), rel=1e-5)


def test_a_rotor_of_a_link_is_given_once():
    with pytest.raises(ParameterError, match="leave those of the Link out"):
        replace(LINK, torque=JOINT_MOTOR, rotor_inertia=1e-5)


def test_fits_of_several_joints_refuse_motors():
    arm = SerialArm(links=(replace(LINK, torque=JOINT_MOTOR), LINK))
    t = np.arange(0.0, 4.0, 0.01)
    x = {name: np.sin(3.0 * t) for name in arm.coordinates}
    record = Measurement(time=t, position=x, force=x)
    with pytest.raises(InputError, match=r"links\.0\.torque.*take forces"):
        fit(arm, dict.fromkeys(("joint-1", "joint-2"), Coulomb), record)


def test_equations_of_a_sampling_loop_at_a_joint_are_refused():
    motor = replace(JOINT_MOTOR, loop=SampledLoop(gain=5.0, period=0.01))
    with pytest.raises(InputError, match="no equations between its samples"):
        simulate(
            SerialArm(links=(replace(LINK, torque=motor),)),
            Coulomb(kinetic_coefficient=0.1),
            t_end=0.1,
        )
