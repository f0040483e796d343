"""Columns in SI: units and gains together, and coefficients that the load makes forces of."""

from pathlib import Path

import numpy as np
import pytest

from stickslip import Axis, SpringBlock, TowedBlock, check, load_measurement, load_rig
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.mechanisms import load_stated

NEWTONS = [-1.0, 2.0, 3.5]


@pytest.fixture
def read(tmp_path, monkeypatch):
    """Write three samples of a quantity at three times, and read them."""
    monkeypatch.chdir(tmp_path)

    def reader(header, values, more=(), **how):
        heads = ["time", header, *[head for head, _ in more]]
        rows = zip(range(3), values, *[column for _, column in more], strict=True)
        lines = [",".join(heads), *(",".join(map(str, row)) for row in rows)]
        (tmp_path / "data.csv").write_text("\n".join(lines))
        return load_measurement("data.csv", **how)

    return reader


# --- gains beside units


@pytest.mark.parametrize(
    ("header", "units"),
    [("friction [mN]", {}), ("friction", {"friction": "mN"}), ("friction [N]", {"friction": "mN"})],
)
def test_a_gain_of_minus_one_turns_the_sign_and_leaves_the_unit(read, header, units):
    record = read(header, [-1000, 2000, 3500], units=units, gain={"friction": -1})
    # 1/1000 of whole thousands and halves is exact
    assert record.friction.tolist() == [1.0, -2.0, -3.5]


@pytest.mark.parametrize(
    ("name", "unit", "gain", "first"),
    [
        ("position", "mm", -1, 0.001), ("velocity", "mm/s", 2, -0.002), ("time", "ms", 2, None),
        ("load", "kN", 0.5, -500.0), ("spring_force", "µN", -1, 1e-6),
    ],
)  # fmt: skip
def test_a_gain_multiplies_what_the_unit_has_made_si_of(read, name, unit, gain, first):
    if name == "time":
        record = read("force", NEWTONS, units={name: unit}, gain={name: gain})
        assert record.time.tolist() == [0.0, 0.002, 0.004]
        return
    record = read(name, [-1, 2, 3], units={name: unit}, gain={name: gain})
    assert getattr(record, name)[0] == pytest.approx(first, rel=1e-15)


@pytest.mark.parametrize("header", ["force", "force [V]", "force [mA]", "force [counts]"])
def test_a_gain_makes_si_of_what_has_another_unit_or_none(read, header):
    assert read(header, NEWTONS, gain={"force": 35.15}).force.tolist() == [
        35.15 * value for value in NEWTONS
    ]


def test_a_unit_of_a_gain_says_that_an_axis_turns_only_where_no_other_does(read):
    alone = read("force [mN m]", NEWTONS, gain={"force": -1})
    assert (alone.turning, alone.force.tolist()) == (True, [0.001, -0.002, -0.0035])
    # newtons per newton metre, of a pinion: the position says that the axis is straight
    way = [("position [mm]", [0, 1, 2])]
    straight = read("force [N m]", NEWTONS, way, gain={"force": 20})
    assert (straight.turning, straight.force.tolist()) == (False, [-20.0, 40.0, 70.0])


def test_axes_that_turn_and_are_straight_by_two_gains_are_refused(read):
    way = [("position [deg]", [0, 1, 2])]
    with pytest.raises(InputError, match="combine angles with torques"):
        read("force [N]", NEWTONS, way, gain={"force": -1, "position": -1})


@pytest.mark.parametrize(
    ("gain", "cure"), [(0.001, "leave the gain out"), (-0.001, "give the gain as -1")]
)
def test_a_gain_that_repeats_the_factor_of_the_unit_is_refused(read, gain, cure):
    with pytest.raises(InputError, match=f"data.csv: column 'force .mN.' is in mN.*{cure}"):
        read("force [mN]", NEWTONS, gain={"force": gain})


@pytest.mark.parametrize(("header", "gain"), [("position [deg]", 0.01745), ("force [lbf]", 4.448)])
def test_a_rounded_factor_of_the_unit_is_refused_too(read, header, gain):
    with pytest.raises(InputError, match="a second time: leave the gain out"):
        read(header, NEWTONS, gain={header.split()[0]: gain})


@pytest.mark.parametrize("gain", [0, 0.0, -0.0, np.nan, np.inf])
def test_a_gain_that_leaves_nothing_is_refused(read, gain):
    with pytest.raises(ParameterError, match=r"data\.csv: gain\.force"):
        read("force", NEWTONS, gain={"force": gain})


def test_a_gain_of_what_was_not_read_is_refused(read):
    with pytest.raises(UnknownNameError, match="quantity in gain 'load'"):
        read("force", NEWTONS, gain={"load": 2.0})


def test_a_gain_of_a_table_of_trials_is_refused(tmp_path):
    (tmp_path / "travels.csv").write_text("travel\n0.2\n0.3\n")
    with pytest.raises(InputError, match="gain applies to time records"):
        load_measurement(tmp_path / "travels.csv", gain={"travel": 2.0})


def test_the_cure_that_check_names_cures(read):
    t = np.arange(3000) / 1000
    speed = 0.3 * np.cos(2 * np.pi * t)
    lines = [f"{a},{b},{c}" for a, b, c in zip(t, speed, -2000 * np.sign(speed), strict=True)]
    Path("long.csv").write_text("\n".join(["time,velocity,friction [mN]", *lines]))
    (wrong,) = check(load_measurement("long.csv")).of("friction sign")
    assert "set its gain to −1" in wrong.sentence
    mended = load_measurement("long.csv", gain={"friction": -1})
    assert check(mended).of("friction sign")[0].severity == "info"
    assert np.abs(mended.friction).max() == 2.0


# --- coefficients


@pytest.mark.parametrize("unit", ["1", "-", "\N{MINUS SIGN}"])
def test_a_coefficient_becomes_a_force_by_the_load_of_each_sample(read, unit):
    load = [("load [N]", [50, 40, 20])]
    record = read(f"friction [{unit}]", [-0.5, 0.25, 0.5], load)
    assert record.friction.tolist() == [-25.0, 10.0, 10.0]


def test_a_coefficient_in_percent_is_a_hundredth(read):
    load = [("load", [50, 50, 50])]
    assert read("spring_force [%]", [-50, 25, 50], load).spring_force.tolist() == [-25, 12.5, 25]
    by_gain = read("spring_force [%]", [-50, 25, 50], gain={"spring_force": 50})
    assert by_gain.spring_force.tolist() == [-25, 12.5, 25]


def test_the_offset_of_the_load_s_sensor_is_no_load(read):
    record = read("friction [1]", [0.5, 0.5, 0.5], [("load", [50, 40, 30])], offset={"load": 10.0})
    assert record.friction.tolist() == [20.0, 15.0, 10.0]


def test_a_coefficient_takes_the_load_that_the_mechanism_states(read):
    record = read("friction [1]", [-0.5, 0.25, 0.5], mechanism=Axis(inertia=1.0, load=50.0))
    assert record.friction.tolist() == [-25.0, 12.5, 25.0]
    heavier = {"mechanism": Axis(inertia=1.0, load=50.0), "overrides": {"mechanism.load": 8.0}}
    assert read("friction [1]", [-0.5, 0.25, 0.5], **heavier).friction.tolist() == [-4, 2, 4]


def test_a_coefficient_without_a_load_is_that_of_a_unit_load(read):
    for mechanism in (None, Axis(inertia=1.0)):
        record = read("friction [1]", NEWTONS, mechanism=mechanism)
        assert record.friction.tolist() == NEWTONS
        assert record.load.tolist() == [1.0] * len(NEWTONS)
    turned = read("friction [1]", NEWTONS, gain={"friction": -1})  # a sign is no load
    assert turned.friction.tolist() == [-x for x in NEWTONS]
    with pytest.raises(ParameterError, match=r"give the load as a column.*as the gain"):
        read("spring_force [1]", NEWTONS, [("friction [1]", NEWTONS)])
    assert read("friction [1]", NEWTONS, gain={"friction": 50}).friction.tolist() == [-50, 100, 175]


def test_a_coefficient_about_an_axis_needs_a_radius(read):
    turning = [("position [rad]", [0.0, 0.1, 0.2]), ("load [N]", [50, 50, 50])]
    with pytest.raises(ParameterError, match=r"a torque in N m: give as its gain the load times"):
        read("friction [1]", [0.1, 0.1, 0.1], turning)
    record = read("friction [1]", [0.1, 0.1, 0.1], turning, gain={"friction": 2.5})
    assert record.friction.tolist() == [0.25, 0.25, 0.25]


def test_a_gain_of_minus_one_turns_the_sign_of_a_coefficient_that_has_a_load(read):
    load = [("load", [50, 50, 50])]
    record = read("friction [1]", [-0.5, 0.25, 0.5], load, gain={"friction": -1})
    assert record.friction.tolist() == [25.0, -12.5, -25.0]
    # any other gain is the load itself
    stated = read("friction [1]", [-0.5, 0.25, 0.5], load, gain={"friction": 50})
    assert stated.friction.tolist() == [-25.0, 12.5, 25.0]


def test_the_load_of_a_block_is_its_weight_unless_it_is_given():
    block = TowedBlock(mass=2.0, stiffness=100.0, speed=0.1, gravity=10.0)
    assert load_stated(block, {}) == 20.0
    assert load_stated(block, {"mechanism.mass": 3.0, "mechanism.speed": 0.2}) == 30.0
    assert load_stated(Axis(inertia=1.0), {"mechanism.load": 1.0}) == 1.0
    # what presses this one is an unknown of its equations
    assert load_stated(SpringBlock(mass=1.0, stiffness=1.0, compression=0.1), {}) is None


def test_a_rig_gives_coefficients_its_load(tmp_path):
    (tmp_path / "map.csv").write_text("velocity,mu\n-0.1,-0.15\n0.1,0.15\n0.2,0.15\n")
    (tmp_path / "rig.toml").write_text(
        '[mechanism]\ntype = "axis"\ninertia = "1 kg"\nload = "50 N"\n[data]\nfile = "map.csv"\n'
        'columns = { friction = "mu" }\nunits = { friction = "1" }\n'
    )
    friction = load_rig(tmp_path / "rig.toml").measurement.friction
    np.testing.assert_allclose(friction, [-7.5, 7.5, 7.5], rtol=1e-15)


# --- numbers that may be coefficients


@pytest.mark.parametrize(
    ("size", "load", "asked"),
    [(0.15, 50.0, True), (1.5, 50.0, True), (7.5, 50.0, False), (0.15, 5.0, False)],
)
def test_friction_that_is_a_small_share_of_its_load_is_questioned(read, size, load, asked):
    record = read("friction", [-size, size, size], [("load", [load] * 3), ("velocity", [-1, 1, 2])])
    found = [finding for finding in check(record).of("units") if "coefficients" in finding.sentence]
    assert bool(found) == asked
    assert [finding.severity for finding in found] == ["warning"] * asked


def test_a_load_of_the_mechanism_is_asked_too(read):
    record = read("friction", [-0.15, 0.15, 0.15], [("velocity", [-1, 1, 2])])
    loaded = check(record, mechanism=Axis(inertia=1.0, load=50.0))
    assert "0.3 % of it" in loaded.of("units")[0].sentence
    assert not check(record, mechanism=Axis(inertia=1.0)).of("units")
