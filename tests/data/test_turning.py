"""Records of axes that turn: angles, their rates and torques."""

import math

import numpy as np
import pytest

from stickslip import (
    Axis,
    CoulombViscous,
    Measurement,
    Pendulum,
    TwoMassAxis,
    check,
    fit,
    load_measurement,
    load_rig,
    simulate,
)
from stickslip.cli import main
from stickslip.data import read_data
from stickslip.errors import InputError, ParameterError


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


def test_a_torque_and_an_angle_are_the_force_and_the_position_of_a_record_in_time(read):
    record = read("time [s],angle [deg],torque [mN m]", ROWS)
    assert record.values("position")[2] == pytest.approx(math.pi, rel=1e-15)
    assert record.values("force").tolist() == [0.001, 0.002, 0.003]
    assert record.turning
    assert record.unused == {}
    # a force that is called so comes first, and a table of trials has no such quantity
    both = read("time [s],position [deg],force [N m],torque [mN m]", ROWS)
    assert both.values("force").tolist() == [1.0, 2.0, 3.0]
    assert list(both.unused) == ["torque"]


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


def test_a_rate_in_hertz_is_in_turns_a_second_and_no_velocity_along_a_line(read):
    turns = read("time,velocity [Hz],force [N m]", ROWS)
    plain = read("time,velocity [rad/s],force [N m]", ROWS)
    expected = 2.0 * math.pi * np.asarray(plain.values("velocity"))
    np.testing.assert_allclose(turns.values("velocity"), expected, rtol=1e-12)
    with pytest.raises(InputError, match="linear"):
        read("time,velocity [Hz],force [N]", ROWS)


def test_trials_turn_if_one_of_them_does():
    time = np.arange(3.0)
    trials = tuple(Measurement(time=time, position=time, turning=t) for t in (False, True))
    assert Measurement(trials=trials).turning


def test_checks_speak_of_angles():
    time = np.arange(2000) / 1000
    position = 0.05 * np.sin(2 * np.pi * time)
    found = check(Measurement(time=time, position=position, turning=True))
    said = " ".join(found.sentences)
    assert "rad/s" in said
    assert "m/s" not in said.replace("rad/s", "")


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
    assert slope.value == pytest.approx(3.0, rel=0.01)
    assert result.verdict.score_unit == "N m"


AXIS = '[mechanism]\ntype = "axis"\n'
LAW = "[friction.coulomb-viscous]\nkinetic_coefficient = 0.4\nviscous_coefficient = 0.05\n"


def rig_of(tmp_path, mechanism, more=""):
    path = tmp_path / "rig.toml"
    path.write_text(AXIS + mechanism + more)
    return load_rig(path)


@pytest.mark.parametrize(
    ("mechanism", "rotary"),
    [
        ("inertia = 0.02\n", False),
        ("inertia = 0.02\nrotary = true\n", True),
        ('inertia = "200 kg cm^2"\n', True),
        ('inertia = "3 kg"\n', False),
        ('inertia = 0.02\nlower_stop = "-30 deg"\n', True),
        ('inertia = 0.02\n[[mechanism.drive]]\ntype = "sine"\namplitude = "40 mN m"\n'
         "frequency = 2.0\n", True),
        ('inertia = 0.02\n[mechanism.drive]\ntype = "sine"\namplitude = "40 N"\n'
         "frequency = 2.0\n", False),
    ],
)  # fmt: skip
def test_an_axis_is_rotary_by_the_units_of_its_values(tmp_path, mechanism, rotary):
    rig = rig_of(tmp_path, mechanism, LAW)
    assert rig.mechanism.rotary is rotary
    assert rig.mechanism.units == (("rad",) if rotary else ("m",))
    run = simulate(rig.mechanism, rig.laws["coulomb-viscous"], t_end=0.1)
    assert run.units["v"] == ("rad/s" if rotary else "m/s")


def test_an_axis_is_rotary_by_its_record_and_says_so_in_the_file_of_its_law(tmp_path, read):
    read("time [s],position [deg],force [N m]", [(0.1 * i, i * i, 1 + i % 2) for i in range(9)])
    data = '[data]\nfile = "record.csv"\n'
    assert rig_of(tmp_path, "inertia = 0.02\n", data).mechanism.rotary
    with pytest.raises(InputError, match=r"position is in deg.* but the mechanism is linear"):
        rig_of(tmp_path, 'inertia = "2 kg"\n', data)
    rig = rig_of(tmp_path, 'inertia = "2 kg"\n', "")
    with pytest.raises(InputError, match=r"position is in deg.* but the mechanism is linear"):
        read_data([tmp_path / "record.csv"], rig.reading, mechanism=rig.mechanism)
    read("time [s],position [mm],force [N]", ROWS)
    with pytest.raises(InputError, match=r"position is in mm.* but the mechanism is rotary"):
        rig_of(tmp_path, 'inertia = "2 kg m^2"\n', data)
    read("time,position,force", ROWS)
    assert rig_of(tmp_path, 'inertia = "2 kg m^2"\n', data).measurement.turning


@pytest.mark.parametrize(
    "mechanism",
    [
        'inertia = "0.02 kg m^2"\nstiffness = "3 N/m"\n',
        'inertia = "0.02 kg m^2"\nrotary = false\n',
        'inertia = "2 kg"\nrotary = true\n',
        'inertia = "2 kg"\n[mechanism.drive]\ntype = "sine"\namplitude = "4 N m"\n'
        "frequency = 2.0\n",
    ],
)
def test_units_of_both_kinds_of_motion_are_refused_with_both_values(tmp_path, mechanism):
    with pytest.raises(ParameterError, match=r"rig\.toml: .* of a rotary axis, but .* linear one"):
        rig_of(tmp_path, mechanism)


def test_a_fit_to_angles_saves_a_rotary_axis_with_torques(tmp_path):
    v = np.linspace(-3.0, 3.0, 60)
    truth = CoulombViscous(kinetic_coefficient=0.4, viscous_coefficient=0.05)
    table = Measurement(velocity=v, friction=[truth.force(speed, 1.0) for speed in v], turning=True)
    found = fit(TwoMassAxis(motor_inertia=0.1, load_inertia=0.1, stiffness=10.0), truth, table)
    found.save(tmp_path / "law.toml")
    law = load_rig(tmp_path / "law.toml")
    assert law.mechanism.rotary
    assert law.estimates.levels == "torques"
    with pytest.raises(ParameterError, match=r"Axis\.rotary must be True or False, got 'yes'"):
        Axis(inertia=1.0, rotary="yes")


def test_what_can_only_turn_has_angles_and_torques_whatever_its_numbers_say():
    clock, t = Pendulum(mass=0.2, length=0.5), np.arange(0.0, 10.0, 0.02)
    law = CoulombViscous(kinetic_coefficient=0.004, viscous_coefficient=0.002)
    swing = simulate(clock, law, t_end=float(t[-1]), y0={"theta": 0.6}).at(t)["theta"]
    plain = Measurement(time=t, position=swing)
    for record in (plain, Measurement(trials=(plain, plain))):
        found = fit(clock, CoulombViscous, record)
        assert found.estimates[0].quantity.unit == "N m"
        assert found.measurement.unit("position") == "rad"
    assert "rad/s" in str(check(plain, mechanism=clock))
    assert "rad/s" not in str(check(plain))


LAW = "[friction.coulomb-viscous]\nkinetic_coefficient = 0.3\nviscous_coefficient = 0.1\n"
RUN = "[run]\nt_end = 3\n"
RUNS = {
    "axis": 'inertia = 2.0\ndrive = { type = "sine", amplitude = 10, frequency = 1 }\n',
    "pendulum": "mass = 1\nlength = 0.5\n",
}


@pytest.mark.parametrize("kind", RUNS)
def test_a_file_that_a_run_wrote_is_a_record_of_its_law(tmp_path, kind):
    rig, path = tmp_path / "rig.toml", tmp_path / "run.csv"
    start = "[run.initial]\ntheta = 1\n" if kind == "pendulum" else ""
    rig.write_text(f'[mechanism]\ntype = "{kind}"\n{RUNS[kind]}{RUN}{start}{LAW}')
    with pytest.raises(SystemExit) as leaving:
        main(["simulate", str(rig), "-o", str(path)])
    assert not leaving.value.code
    record = load_measurement(path)
    assert {"position", "velocity", "friction"} <= {*record.quantities()}
    found = fit(load_rig(rig).mechanism, "coulomb-viscous", record)
    wanted = {"kinetic_coefficient": 0.3, "viscous_coefficient": 0.1}
    got = {e.path.rpartition(".")[2]: e.value for e in found.estimates}
    # the friction of the run is exact; a reading counts as having some noise all the same
    assert {name: got[name] for name in wanted} == pytest.approx(wanted, rel=0.01)


@pytest.mark.parametrize(
    ("header", "known"),
    [
        ("time,speed,torque", {"velocity", "force"}),
        ("speed,friction", {"velocity", "friction"}),
        # a speed has no sign: beside positions it is no velocity
        ("time,position,speed,force", {"position", "force"}),
        ("time,speed,velocity,force", {"velocity", "force"}),
    ],
)
def test_a_speed_is_a_velocity_where_nothing_else_tells_the_motion(tmp_path, header, known):
    file = tmp_path / "log.csv"
    rows = np.arange(1.0, 41.0)[:, None] * np.ones(header.count(",") + 1)
    np.savetxt(file, rows, delimiter=",", header=header, comments="")
    record = load_measurement(file)
    assert {*record.quantities()} == known
    if "velocity" not in header and header != "speed,friction":
        apart = load_measurement(file, columns={"velocity": ""})
        assert {*apart.quantities()} == known - {"velocity"}
