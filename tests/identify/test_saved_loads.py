"""What is saved of a fit holds the load that was measured."""

import dataclasses

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Measurement,
    SpringBlock,
    fit,
    load_rig,
    simulate,
)
from stickslip.identify.fits.contact_inputs import as_loaded
from stickslip.mechanisms.drives import Pulse, Sampled

SPEED = np.concatenate([np.linspace(-0.1, -0.01, 40), np.linspace(0.01, 0.1, 40)])
LEVEL = 0.4
AXIS = Axis(inertia=1.0)


def table(load):
    """Return exact friction of a coefficient of 0.4 under a load."""
    load = np.broadcast_to(load, SPEED.shape)
    friction = LEVEL * load * np.sign(SPEED)  # equal readings are known to their last digit else
    return Measurement(velocity=SPEED, friction=friction, load=load, uncertainty={"friction": 1e-6})


def saved(found, folder):
    found.save(folder / "law.toml")
    return load_rig(folder / "law.toml")


def test_a_saved_law_slides_under_the_load_it_was_measured_with(tmp_path):
    rig = saved(fit(AXIS, Coulomb, table(5.0)), tmp_path)
    assert rig.mechanism.load == 5.0
    held = dataclasses.replace(rig.mechanism, drive=Pulse(level=1.5, duration=1.0))
    pushed = dataclasses.replace(rig.mechanism, drive=Pulse(level=2.5, duration=1.0))
    law = rig.laws["coulomb"]
    # 1.5 N are less than 0.4 times 5 N; 2.5 N are 0.5 N more, which give 1 kg 0.5 m/s in 1 s. It
    # goes 0.25 m, and as 2 N stop it, 0.5^2 / (2 x 2) m on
    assert simulate(held, law, t_end=3.0).at(3.0)["x"][0] == 0.0
    assert simulate(pushed, law, t_end=3.0).at(3.0)["x"][0] == pytest.approx(0.3125, rel=1e-4)


def test_a_load_that_hardly_varies_is_saved_as_its_mean(tmp_path):
    load = 5.0 + 0.1 * np.sin(np.arange(80))  # 4 % from end to end
    found = fit(AXIS, Coulomb, table(load))
    assert found.remarks == ()
    assert saved(found, tmp_path).mechanism.load == pytest.approx(load.mean(), rel=1e-12)


def test_a_load_that_varies_is_saved_as_its_median_and_the_file_says_so(tmp_path):
    load = np.linspace(4.0, 7.0, 80) ** 2
    found = fit(AXIS, Coulomb, table(load))
    assert saved(found, tmp_path).mechanism.load == pytest.approx(np.median(load), rel=1e-12)
    first = (tmp_path / "law.toml").read_text(encoding="utf-8").splitlines()[0]
    assert first == "# The load was measured and varies, 16 to 49 N: here it is the median."


@pytest.mark.slow
def test_several_trials_at_their_own_loads_are_saved_with_the_median(tmp_path):
    whole = Measurement(trials=(table(2.0), table(5.0), table(9.0)))
    found = fit(AXIS, Coulomb, whole)
    assert saved(found, tmp_path).mechanism.load == 5.0
    assert "2 to 9 N" in found.remarks[0]


def test_a_load_that_was_set_for_each_trial_is_saved_too(tmp_path):
    plain = Measurement(velocity=SPEED, friction=2.0 * np.sign(SPEED))
    pressed = dataclasses.replace(plain, overrides={"mechanism.load": 5.0})
    found = fit(AXIS, Coulomb, Measurement(trials=(pressed, pressed)))
    assert saved(found, tmp_path).mechanism.load == 5.0
    assert found.estimate("kinetic_coefficient").quantity.unit == "1"


def test_records_of_motion_are_saved_with_their_load_too(tmp_path):
    law = CoulombViscous(kinetic_coefficient=0.5, viscous_coefficient=3.0)
    t = np.arange(500) / 100
    force = 4.0 * np.sin(4.0 * t) + 3.0 * np.sin(1.7 * t)
    axis = Axis(inertia=1.0, load=4.0, drive=Sampled(times=t, values=force))
    x = simulate(axis, law, t_end=float(t[-1])).at(t)["x"]
    record = Measurement(time=t, position=x, force=force, load=4.0)
    found = fit(AXIS, CoulombViscous, record)
    assert saved(found, tmp_path).mechanism.load == 4.0


def test_a_load_that_follows_from_the_mechanism_is_left_and_a_difference_is_said():
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    weight = float(block.mass * block.gravity)
    same, silent = as_loaded(block, table(weight))
    other, said = as_loaded(block, table(5.0))
    assert same == other == block
    assert silent == ""
    assert said == (
        "The load was measured, 5 N; here it follows from the parameters of SpringBlock, 9.81 N."
    )


def test_without_a_measured_load_the_mechanism_is_saved_as_it_was_given(tmp_path):
    found = fit(
        Axis(inertia=1.0, load=3.0),
        Coulomb,
        Measurement(velocity=SPEED, friction=LEVEL * 3.0 * np.sign(SPEED)),
    )
    assert found.remarks == ()
    assert saved(found, tmp_path).mechanism.load == 3.0


def test_travels_at_several_settings_are_saved_with_the_first_and_the_file_says_so(tmp_path):
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    far = Measurement(travel=0.45, uncertainty=0.005, overrides={"mechanism.compression": 0.15})
    near = Measurement(travel=0.20, uncertainty=0.005)
    fitted, two = (
        fit(block, Coulomb, Measurement(trials=trials)) for trials in ((near,), (far, near))
    )
    assert not fitted.to_toml().startswith("#")
    assert two.to_toml().startswith("# The mechanism is that of the first of 2 settings.\n")
    two.save(tmp_path / "law.toml")
    assert load_rig(tmp_path / "law.toml").mechanism.compression == 0.15
