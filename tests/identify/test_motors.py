"""Records of a motor's voltage, current or goal: its constants and the friction of its gear."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import (
    BamM1,
    BamM3,
    Measurement,
    Pendulum,
    RecordSettings,
    fit,
    load_measurement,
    load_rig,
    simulate,
)
from stickslip.data import loop_samples, with_voltage
from stickslip.engine.solver import EventDriven
from stickslip.errors import InputError
from stickslip.identify.fits.shooting.sampled_loops import LoopInSegment, run_through
from stickslip.mechanisms import DCMotor, PositionLoop, SampledLoop
from stickslip.mechanisms.drives import Sampled
from stickslip.study.control import PID, closed_loop

GAIN, SUPPLY = 25.0, 7.4
M1 = BamM1(kinetic_coefficient=0.05, viscous_coefficient=0.02)
M3 = BamM3(kinetic_coefficient=0.02, transmitted_coefficient=0.2, viscous_coefficient=0.02)
TRUE = DCMotor(
    resistance=3.2,
    torque_constant=0.35,
    rotor_inertia=2e-3,
    supply=SUPPLY,
    loop=PositionLoop(gain=GAIN),
)
SERVO = Pendulum(mass=0.49, length=0.1, drive=TRUE)
GUESS = replace(SERVO, drive=replace(TRUE, resistance=4.0, torque_constant=0.3))
R, K = "mechanism.drive.resistance", "mechanism.drive.torque_constant"
SETTINGS = RecordSettings(hold="first")


def recorded(law, *, lasting=10.0, noise=2e-4, seed=0, step=0.005):
    """Return angle, voltage, current and goal of a servo, at 200 Hz if no other step is given."""
    t = np.arange(0.0, lasting, step)
    goal = 0.9 * np.sin(2.0 * np.pi * 0.45 * t) + 0.5 * np.sin(2.0 * np.pi * 1.3 * t + 1.0)
    drive = Sampled(times=t, values=goal, hold="first")
    run = simulate(replace(SERVO, drive=replace(TRUE, drive=drive)), law, t_end=lasting).at(t)
    voltage = np.clip(GAIN * (goal - run["theta"]), -SUPPLY, SUPPLY)
    current = (voltage - 0.35 * run["omega"]) / 3.2
    seen = run["theta"] + noise * np.random.default_rng(seed).standard_normal(t.size)
    return Measurement(
        time=t, position=seen, voltage=voltage, current=current, reference=goal, turning=True
    )


@pytest.fixture(scope="module")
def gear():
    return recorded(M3)


@pytest.fixture(scope="module")
def plain():
    return recorded(M1)


def by(found):
    return {estimate.path: estimate for estimate in found.estimates}


@pytest.mark.slow
def test_a_recorded_voltage_tells_motor_and_gear_where_friction_grows_with_the_torque(gear):
    record = replace(gear, current=None)
    found = by(fit(GUESS, BamM3, record, vary=["friction.*", R, K], settings=SETTINGS))
    true = {
        R: 3.2,
        K: 0.35,
        "friction.transmitted_coefficient": 0.2,
        "friction.viscous_coefficient": 0.02,
        "friction.kinetic_coefficient": 0.02,
    }
    for path, value in true.items():
        estimate = found[path]
        assert estimate.bounded
        # straight lines between samples cut the corners of the voltage at 5 ms
        assert estimate.value == pytest.approx(value, rel=0.06)


@pytest.mark.slow
def test_what_one_voltage_cannot_separate_is_named_and_known_widely():
    record = replace(recorded(M1, step=0.002), current=None)  # straight between samples to 1e-4
    found = fit(GUESS, BamM1, record, vary=["friction.*", R, K], route="balance", settings=SETTINGS)
    known = by(found)
    for path, value in {R: 3.2, K: 0.35, "friction.viscous_coefficient": 0.02}.items():
        assert known[path].low < 0.8 * value < 1.3 * value < known[path].high
    assert known["friction.kinetic_coefficient"].low == pytest.approx(0.05, rel=0.03)
    assert "resistance and torque constant together cannot be distinguished from viscous" in str(
        found.sentences
    )
    # what it does tell: torque per voltage, and the whole damping
    motor = found.mechanism.drive
    push = motor.torque_constant / motor.resistance
    assert push == pytest.approx(0.35 / 3.2, rel=0.001)
    damping = found.law.viscous_coefficient + push * motor.torque_constant
    assert damping == pytest.approx(0.02 + 0.35**2 / 3.2, rel=0.01)


@pytest.mark.slow
def test_with_one_of_them_known_the_others_are_found(plain):
    record = replace(plain, current=None)
    found = by(
        fit(
            replace(GUESS, drive=replace(GUESS.drive, resistance=3.2)),
            BamM1,
            record,
            vary=["friction.*", K],
            route="balance",
            settings=SETTINGS,
        )
    )
    assert found[K].value == pytest.approx(0.35, rel=2e-3)
    assert found["friction.viscous_coefficient"].value == pytest.approx(0.02, rel=0.02)


def dropped(angle, seed):
    """Return a swing with an open winding, from an angle."""
    t = np.arange(0.0, 3.0, 0.005)
    still = replace(SERVO, drive=replace(TRUE, loop=None, supply=None, current_limit=0.0))
    run = simulate(still, M1, t_end=3.0, y0={"theta": angle}).at(t)
    return Measurement(
        time=t,
        position=run["theta"] + 2e-4 * np.random.default_rng(seed).standard_normal(t.size),
        voltage=0.0 * t,
        turning=True,
        overrides={"mechanism.drive.current_limit": 0.0},
    )


@pytest.mark.slow
def test_swings_with_an_open_winding_separate_them(plain):
    drops = [dropped(angle, seed) for seed, angle in enumerate((1.2, -1.0, 0.8, -1.3))]
    both = Measurement(trials=(replace(plain, current=None, reference=None), *drops))
    start = replace(GUESS, drive=replace(GUESS.drive, loop=None, current_limit=100.0))
    found = by(
        fit(start, BamM1, both, vary=["friction.*", R, K], route="balance", settings=SETTINGS)
    )
    assert found[R].bounded
    assert found[K].bounded
    assert found[K].value == pytest.approx(0.35, rel=0.02)
    assert found[R].value == pytest.approx(3.2, rel=0.02)


def test_a_recorded_current_tells_the_torque_constant_whatever_the_resistance(gear):
    found = by(fit(GUESS, BamM3, gear, vary=["friction.*", K], route="balance", settings=SETTINGS))
    assert found[K].value == pytest.approx(0.35, rel=5e-3)
    assert found["friction.transmitted_coefficient"].value == pytest.approx(0.2, rel=0.02)


@pytest.mark.parametrize("voltage", [True, False])
@pytest.mark.parametrize("law", [BamM1, BamM3])
def test_a_recorded_current_is_the_torque_whatever_the_resistance(request, law, voltage):
    """Nothing else than rounding changes with it: .7 N m of torque change by 3e-16 N m."""
    record = request.getfixturevalue("plain" if law is BamM1 else "gear")
    record = record if voltage else replace(record, voltage=None)
    with pytest.raises(InputError, match=r"nothing in these records changes with drive.resistance"):
        fit(GUESS, law, record, vary=["friction.*", R, K], settings=SETTINGS)


def test_what_drives_a_record_must_fit_the_mechanism(gear):
    record = replace(gear, current=None)
    bare = replace(SERVO, drive=None)
    with pytest.raises(InputError, match=r"voltage of a motor needs that motor"):
        fit(bare, BamM1, record)
    with pytest.raises(InputError, match=r"one of a position loop"):
        fit(replace(SERVO, drive=replace(TRUE, loop=None)), BamM1, replace(record, voltage=None))
    pushed = replace(record, voltage=None, reference=None, force=record.voltage)
    with pytest.raises(InputError, match=r"has a force, and Pendulum a motor"):
        fit(SERVO, BamM1, pushed)


def test_a_file_with_a_voltage_is_read_where_the_rig_has_a_motor(tmp_path):
    (tmp_path / "log.csv").write_text(
        "time [s],position [deg],pwm\n" + "".join(f"{0.1 * k},{k},{100 * k}\n" for k in range(5))
    )
    file = tmp_path / "servo.toml"
    file.write_text(
        """
[mechanism]
type = "pendulum"
mass = 0.49
length = 0.1
drive = { type = "dc-motor", resistance = 3.0, torque_constant = 0.4 }
[data]
file = "log.csv"
columns = { voltage = "pwm" }
gain = { voltage = 0.01 }
"""
    )
    record = load_rig(file).measurement
    assert record.quantities() == ("position", "voltage")
    np.testing.assert_allclose(record.values("voltage"), np.arange(5.0), rtol=1e-12)
    with pytest.raises(InputError, match=r"voltage is not a quantity.*force with a gain"):
        load_measurement(tmp_path / "log.csv", columns={"voltage": "pwm"})


LOOP = SampledLoop(
    gain=25.0,
    integral_gain=40.0,
    rate_gain=0.3,
    period=5e-3,
    delay=2e-3,
    duty_limit=0.9,
    step=SUPPLY / 885,
    encoder_step=2.0 * np.pi / 4096,
)
FIRMWARE = replace(SERVO, drive=replace(TRUE, loop=LOOP))


def goal_at(t):
    return 0.9 * np.sin(2.0 * np.pi * 0.45 * t) + 0.5 * np.sin(2.0 * np.pi * 1.3 * t + 1.0)


@pytest.fixture(scope="module")
def sampled():
    """Return a run of the firmware's loop by a controller, and its record without a voltage."""
    pid = PID(
        proportional=25.0,
        integral=40.0,
        derivative=0.3,
        reference=goal_at,
        state="theta",
        rate=None,
        limit=0.9 * SUPPLY,
    )
    run = closed_loop(
        replace(SERVO, drive=replace(TRUE, loop=None)),
        M3,
        pid,
        period=5e-3,
        delay=2e-3,
        t_end=1.5,
        limit=0.9 * SUPPLY,
        step=SUPPLY / 885,
        quantisation={"theta": 2.0 * np.pi / 4096},
        y0={"theta": 0.3},
    )
    seen = run.measured["theta"]
    record = Measurement(time=run.t, position=seen, reference=goal_at(run.t), turning=True)
    return run, record


def test_the_voltage_of_a_loop_follows_from_the_recorded_goal_and_position(sampled):
    run, record = sampled
    assert np.abs(run.commands).max() == pytest.approx(0.9 * SUPPLY, rel=1e-3)
    told = with_voltage(FIRMWARE, record).values("voltage")
    # at a sample the command of the one before acts still, 2 ms long
    np.testing.assert_allclose(told, [0.0, *run.commands[:-1]], rtol=1e-12)


@pytest.mark.parametrize("cut", [0.0, 0.4])
def test_a_run_through_a_sampled_loop_is_that_of_the_controller(sampled, cut):
    run, record = sampled
    segment = LoopInSegment(samples=loop_samples(FIRMWARE, record, "zero"), start=cut)
    start = run.run.at(cut)
    again, _ = run_through(
        EventDriven(),
        FIRMWARE,
        M3,
        segment,
        y0=[start["theta"].item(), start["omega"].item()],
        t_end=1.0,
    )
    times = np.linspace(0.0, 1.0, 101)
    # the same commands to the bit; states at the cut come from a step's polynomial
    wanted = run.run.at(cut + times)["theta"]
    np.testing.assert_allclose(again.at(times)[:, 0], wanted, rtol=0.0, atol=1e-9)


@pytest.mark.slow
def test_a_goal_is_fitted_through_a_sampled_loop(sampled):
    _, record = sampled
    guess = replace(FIRMWARE, drive=replace(FIRMWARE.drive, torque_constant=0.3))
    found = fit(
        guess,
        BamM3,
        record,
        vary=["friction.*", K],
    )
    for path, true in {
        K: 0.35,
        "friction.kinetic_coefficient": M3.kinetic_coefficient,
        "friction.transmitted_coefficient": M3.transmitted_coefficient,
        "friction.viscous_coefficient": M3.viscous_coefficient,
    }.items():
        own = by(found)[path]
        assert own.low <= true <= own.high
        assert own.value == pytest.approx(true, rel=0.05)
    assert by(found)[K].high - by(found)[K].low < 0.1 * 0.35
    # what is left of the runs is less than a step of the encoder
    assert found.judgement.problem.following.seen.rms < 2.0 * np.pi / 4096


def test_equations_of_a_loop_that_samples_are_refused():
    with pytest.raises(InputError, match=r"no equations between its samples.*closed_loop"):
        simulate(FIRMWARE, M3, t_end=0.1)
