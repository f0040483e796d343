"""Measurements from tables in memory, MDF files, our own exports, and currents of motors."""

from datetime import datetime

import numpy as np
import pandas as pd
import pytest

from stickslip import Axis, Coulomb, load_measurement, load_rig, simulate
from stickslip.data import guess_data
from stickslip.errors import InputError, ParameterError
from stickslip.mechanisms.drives import Sine

T = np.arange(200) / 100
X = 0.02 * np.sin(3.0 * T)
F = 4.0 * np.cos(3.0 * T)


# --- tables in memory


def test_units_come_from_headers_or_from_a_mapping():
    by_header = pd.DataFrame({"time": T, "position [mm]": 1e3 * X, "force [kN]": 1e-3 * F})
    by_mapping = {"t": T, "q": 1e3 * X, "u": 1e-3 * F}
    columns = {"time": "t", "position": "q", "force": "u"}
    one = load_measurement(by_header)
    other = load_measurement(by_mapping, columns=columns, units={"position": "mm", "force": "kN"})
    for record in (one, other):
        np.testing.assert_allclose(record.position, X, rtol=1e-14)
        np.testing.assert_allclose(record.force, F, rtol=1e-14)
    assert (one.name, one.provenance) == ("table", "table")


@pytest.mark.parametrize(
    "index",
    [
        pd.Index(T, name="t"),
        pd.to_timedelta(T, unit="s"),
        pd.Timestamp("2024-03-01 23:59:59") + pd.to_timedelta(T, unit="s"),
    ],
    ids=["numbers", "durations", "dates"],
)
def test_times_may_be_the_index(index):
    table = pd.DataFrame({"position": X, "force": F}, index=index)
    columns = {"time": "t"} if index.name else None
    np.testing.assert_allclose(load_measurement(table, columns=columns).time, T, atol=1e-9)
    assert list(table.columns) == ["position", "force"]  # the caller's is not changed


def test_a_table_of_a_robot_log_is_read_by_the_names_of_its_topics():
    # as bagpy and rosbags write joint states
    table = pd.DataFrame(
        {
            "Time": 1.7e9 + T,
            "header.frame_id": "base",
            "position[0]": X,
            "position[1]": 2 * X,
            "effort[0]": F,
            "effort[1]": 3 * F,
        }
    )
    columns = {
        "time": "Time",
        "position.shoulder": "position[0]",
        "position.elbow": "position[1]",
        "force.shoulder": "effort[0]",
        "force.elbow": "effort[1]",
    }
    units = {f"position.{name}": "rad" for name in ("shoulder", "elbow")}
    record = load_measurement(table, columns=columns, units=units)
    np.testing.assert_array_equal(record.joints["elbow"].position, 2 * X)
    np.testing.assert_array_equal(record.joints["shoulder"].force, F)
    assert record.turning


def test_several_tables_are_trials():
    tables = [pd.DataFrame({"time": T, "position": k * X}) for k in (1, 2)]
    trials = load_measurement(tables).trials
    assert [trial.name for trial in trials] == ["table 1", "table 2"]


def test_rows_of_a_table_in_memory_are_counted_from_one():
    table = pd.DataFrame({"time": T, "position": X}, index=range(50, 250))
    table.iloc[3, 1] = np.nan
    with pytest.raises(ParameterError, match=r"table: column 'position', row 4: .*got nothing"):
        load_measurement(table)
    assert load_measurement(table, repair="gaps").time.size == 199


def test_columns_of_different_lengths_make_no_table():
    with pytest.raises(InputError, match="the columns do not make a table"):
        load_measurement({"time": T, "position": X[:9]})


# --- MDF


@pytest.fixture(scope="module")
def mdf(tmp_path_factory):
    asammdf = pytest.importorskip("asammdf")
    path = tmp_path_factory.mktemp("mdf") / "log.mf4"
    with asammdf.MDF(version="4.10") as file:
        slow = asammdf.Signal(np.arange(9.0), np.arange(9.0), name="temperature", unit="°C")
        fast = [
            asammdf.Signal(1e3 * X, T, name="position", unit="mm"),
            asammdf.Signal(100.0 * F, T, name="Kraft", unit="cN"),
        ]
        file.start_time = datetime(2024, 3, 1)
        file.append([slow])
        file.append(fast)
        file.save(path)
    return path


def test_channels_of_an_mdf_file_are_columns_with_their_units(mdf):
    record = load_measurement(mdf, columns={"force": "Kraft"})
    np.testing.assert_allclose(record.time, T, atol=1e-12)
    np.testing.assert_allclose(record.position, X, atol=1e-12)
    np.testing.assert_allclose(record.force, F, atol=1e-12)


def test_channels_of_other_groups_of_an_mdf_file_are_said_not_to_be_read(mdf):
    assert "Not read, as it has other times: 'temperature'." in guess_data(mdf).doubts


def test_what_is_no_mdf_file_is_refused_in_one_line(tmp_path):
    (tmp_path / "log.mf4").write_bytes(b"no such thing" * 100)
    with pytest.raises(InputError, match=r"is not an MDF file, or is damaged") as caught:
        load_measurement(tmp_path / "log.mf4")
    assert "\n" not in str(caught.value)


# --- our own exports


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_an_exported_run_is_read_back(tmp_path, ending):
    from stickslip.cli import main

    rig = tmp_path / "rig.toml"
    rig.write_text(
        '[mechanism]\ntype = "axis"\ninertia = "2 kg"\n'
        'drive = { type = "sine", amplitude = "8 N", frequency = "1 Hz" }\n'
        "[friction.coulomb]\nkinetic_coefficient = 3.0\n"
    )
    file = tmp_path / f"run.{ending}"
    with pytest.raises(SystemExit) as done:
        main(["simulate", str(rig), "--t-end", "2", "-o", str(file), "--samples", "201"])
    assert done.value.code == 0
    names = {"time": "t", "position": "x", "velocity": "v", "friction": "friction"}
    record = load_measurement(file, columns=names)
    guess = guess_data(file)
    assert set(names) <= set(guess.columns)
    again = load_measurement(file, columns={name: guess.columns[name] for name in names})
    np.testing.assert_array_equal(again.position, record.position)
    assert not guess.doubts or ending == "parquet"  # whose columns have no units
    law = Coulomb(kinetic_coefficient=3.0)
    run = simulate(Axis(inertia=2.0, drive=Sine(amplitude=8.0, frequency=1.0)), law, t_end=2.0)
    at = run.at(record.time)
    # text has 17 digits
    np.testing.assert_allclose(record.position, at["x"], rtol=1e-14, atol=1e-15)
    np.testing.assert_allclose(record.velocity, at["v"], rtol=1e-12, atol=1e-14)


# --- currents


RIG = """
[mechanism]
type = "axis"
inertia = "0.02 kg m^2"

[data]
file = "run.csv"
motor_constant = {constant}
columns = {{ time = "t", position = "phi", current = "I" }}
units = {{ position = "deg", current = "mA" }}
"""


@pytest.mark.parametrize("constant", ['"0.12 N m/A"', '"12 Ncm/A"', "0.12", '"0.12Nm/A"'])
def test_a_current_is_a_torque_by_the_constant_of_its_motor(tmp_path, constant):
    pd.DataFrame({"t": T, "phi": np.degrees(X), "I": 1e3 * F / 0.12}).to_csv(
        tmp_path / "run.csv", index=False
    )
    (tmp_path / "rig.toml").write_text(RIG.format(constant=constant))
    record = load_rig(tmp_path / "rig.toml").measurement
    assert (record.quantities(), record.turning) == (("position", "force"), True)
    np.testing.assert_allclose(record.force, F, rtol=1e-12)


def test_a_motor_constant_with_its_unit_says_whether_the_axis_turns():
    table = {"time": T, "position": X, "current": F}
    assert load_measurement(table, motor_constant="2 N m/A").turning
    assert not load_measurement(table, motor_constant="2 N/A").turning


def test_a_gain_turns_the_sign_of_a_current():
    table = {"time": T, "position": X, "current [A]": F}
    record = load_measurement(table, motor_constant=2.0, gain={"current": -1})
    np.testing.assert_allclose(record.force, -2.0 * F)


def test_each_joint_has_a_motor_constant_of_its_own():
    table = {"time": T, **{f"{q}.{j}": F for q in ("position", "current") for j in "ab"}}
    record = load_measurement(table, motor_constant={"a": "1 N m/A", "b": "3 N m/A"})
    np.testing.assert_allclose(record.joints["b"].force, 3.0 * record.joints["a"].force)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"motor_constant": "2 V/A"}, r"motor_constant \(K_m\) of current .*N/A or N m/A.*'2 V/A'"),
        ({"motor_constant": 0}, r"must be a number other than 0"),
        ({"motor_constant": "0 N/A"}, r"must be a number other than 0"),
        ({"columns": {"current": "I"}}, r'or give motor_constant="0.12 N m/A"'),
        ({"motor_constant": 2.0, "columns": {"force": "I"}}, "belongs to a current, and there is"),
        ({"motor_constant": 2.0, "columns": {"current": "I", "force": "u"}}, "both give the force"),
        (
            {"motor_constant": 2.0, "columns": {"current": "I"}, "units": {"current": "mm"}},
            "must be in A or a unit of that kind, not in mm",
        ),
        (
            {"columns": {"force": "I"}, "units": {"force": "counts"}, "gain": {"force": "2 V/mm"}},
            "is not in N",
        ),
    ],
)
def test_a_wrong_motor_constant_is_refused_with_a_cure(more, message):
    table = {"time": T, "position": X, "I": F, "u": F}
    with pytest.raises(InputError, match=message):
        load_measurement(table, **more)


@pytest.mark.parametrize(
    ("position", "constant", "message"),
    [
        ("position [mm]", "0.12 N m/A", "not in N: .* takes N/A. With a screw, give .* its lead"),
        ("position [deg]", "12 N/A", "not in N m: .* takes N m/A. Give .* times the radius"),
    ],
)
def test_a_motor_constant_of_the_other_kind_of_axis_is_named_with_its_cure(
    position, constant, message
):
    table = {"time [s]": T, position: X, "current [A]": F}
    with pytest.raises(InputError, match=f'motor_constant="{constant}" .*{message}') as error:
        load_measurement(table, motor_constant=constant)
    assert "gain" not in str(error.value)


def test_init_names_the_option_of_a_motor_constant(tmp_path, capsys):
    from stickslip.cli import main

    pd.DataFrame({"t_s": T, "x_mm": 1e3 * X, "I_A": F}).to_csv(tmp_path / "log.csv", index=False)
    with pytest.raises(SystemExit) as done:
        main(["init", str(tmp_path / "log.csv"), "--motor-constant", "0.12 N m/A"])
    assert done.value.code == 2
    assert '--motor-constant "0.12 N m/A" times a current' in capsys.readouterr().err
