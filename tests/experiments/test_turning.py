"""Records of axes that turn: angles, their rates and torques."""

import math

import numpy as np
import pytest

from stickslip import Axis, CoulombViscous, Measurement, check, fit, load_measurement
from stickslip.errors import InputError
from stickslip.selection.record_wording import error_text


@pytest.fixture
def read(tmp_path):
    """Write a table and read it."""

    def reader(header, rows, **how):
        path = tmp_path / "record.csv"
        path.write_text("\n".join([header, *(",".join(map(str, row)) for row in rows)]))
        return load_measurement(path, **how)

    return reader


ROWS = [(0, 0, 1), (1, 90, 2), (2, 180, 3)]


def test_angles_and_torques_are_read_in_their_units(read):
    record = read("time [s],position [deg],force [mN m]", ROWS)
    assert record.values("position") == pytest.approx([0.0, math.pi / 2, math.pi], rel=1e-15)
    assert record.values("force").tolist() == [0.001, 0.002, 0.003]
    assert record.turning
    assert [record.unit(name) for name in ("position", "force")] == ["rad", "N m"]


def test_rates_may_be_in_turns_a_minute(read):
    record = read("time,velocity,force", ROWS, units={"velocity": "rpm"})
    assert record.values("velocity")[2] == pytest.approx(6.0 * math.pi, rel=1e-12)
    assert record.turning


def test_an_offset_of_a_straight_record_leaves_it_straight(read):
    record = read("time [s],position [mm],force [N]", ROWS)
    assert not record.turning
    assert record.unit("position") == "m"


def test_what_has_no_unit_goes_with_either_kind(read):
    assert read("time,position [deg],force", ROWS).turning
    assert not read("time,position,force [N]", ROWS).turning


@pytest.mark.parametrize(
    "header", ["time,position [deg],force [N]", "time,position [mm],force [N m]"]
)
def test_angles_do_not_go_with_forces_nor_lengths_with_torques(read, header):
    with pytest.raises(InputError, match=r"record\.csv: .* a rotary axis, but .* linear"):
        read(header, ROWS)


def test_frequencies_are_no_rates(read):
    with pytest.raises(InputError, match="not in Hz"):
        read("time,velocity [Hz],force [N m]", ROWS)


def test_trials_turn_if_one_of_them_does():
    time = np.arange(3.0)
    trials = tuple(Measurement(time=time, position=time, turning=t) for t in (False, True))
    assert Measurement(trials=trials).turning


def test_checks_and_scores_speak_of_angles():
    time = np.arange(2000) / 1000
    position = 0.05 * np.sin(2 * np.pi * time)
    found = check(Measurement(time=time, position=position, turning=True))
    said = " ".join(found.sentences)
    assert "rad/s" in said
    assert "m/s" not in said.replace("rad/s", "")
    assert error_text(0.00024, "position", turning=True) == "0.24 mrad"


def test_a_joint_that_turned_a_hundred_times_is_no_doubtful_position():
    time = np.arange(2000) / 1000
    turned, straight = (
        check(Measurement(time=time, position=628.0 * np.sin(time), turning=turns))
        for turns in (True, False)
    )
    assert not turned.of("units")
    assert straight.of("units")


def test_estimates_are_in_the_units_of_what_turns():
    velocity = np.linspace(-1.0, 1.0, 100)
    friction = 2.0 * np.sign(velocity) + 3.0 * velocity
    table = Measurement(velocity=velocity, friction=friction, turning=True)
    result = fit(Axis(inertia=1.0), CoulombViscous, table)
    slope = result.estimate("viscous_coefficient")
    assert slope.quantity.unit == "N m s/rad"
    assert slope.value == pytest.approx(3.0, rel=1e-6)  # the data are exact
    assert result.score().unit == "N m"
