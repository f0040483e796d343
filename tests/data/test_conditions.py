"""Conditions of trials from columns, one table, rig files; columns that nothing was read from."""

import numpy as np
import pytest

from stickslip import Axis, SpringBlock, check, load_measurement, load_rig
from stickslip.errors import InputError, UnknownNameError

ROWS = "{t},{v},{f},{temperature},{way}\n"
HEAD = "time,velocity,friction,temperature [degC],way\n"


def write(path, *, temperature="20", way="up", head=HEAD, rows=12, extra=""):
    lines = [
        ROWS.format(
            t=0.1 * i, v=0.1 * (-1) ** i, f=2.0 * (-1) ** i, temperature=temperature, way=way
        )
        for i in range(rows)
    ]
    path.write_text(head + "".join(lines) + extra)
    return path


@pytest.fixture
def files(tmp_path):
    return [
        write(tmp_path / "cold.csv"),
        write(tmp_path / "warm.csv", temperature="60", way="down"),
    ]


def test_a_column_with_one_value_in_each_file_is_a_condition(files):
    found = load_measurement(files, conditions=["temperature", "way"])
    assert [dict(record.conditions) for record in found.records()] == [
        {"temperature [degC]": 20.0, "way": "up"},
        {"temperature [degC]": 60.0, "way": "down"},
    ]
    assert not check(found).of("unused column")


def test_one_name_may_be_given_as_a_text(files):
    found = load_measurement(files, conditions="way")
    assert [record.conditions["way"] for record in found.records()] == ["up", "down"]


def test_a_column_that_differs_between_trials_and_is_not_used_is_named_as_a_warning(files):
    found = check(load_measurement(files))
    (finding,) = found.of("unused column")  # laws may depend on the temperature
    assert finding.severity == "warning"
    assert str(finding) == (
        "Column 'way' is not used but differs between the trials: what friction changes with it is"
        " part of the difference between runs."
    )


def test_other_columns_that_are_not_used_are_named_once(tmp_path):
    one = load_measurement(write(tmp_path / "cold.csv"))
    (finding,) = check(one).of("unused column")
    assert finding.severity == "info"
    assert str(finding) == "Column 'way' is not used."  # laws may depend on the temperature


def test_a_table_with_a_column_of_trials_is_split(tmp_path):
    head = "time,velocity,friction,trial,way\n"
    file = write(tmp_path / "all.csv", temperature="1", head=head)
    with file.open("a") as more:
        for i in range(12):
            more.write(ROWS.format(t=0.1 * i, v=0.1, f=2.5, temperature="2", way="down"))
    found = load_measurement(file, conditions="way")
    assert [record.name for record in found.records()] == ["trial 1", "trial 2"]
    assert [record.conditions["way"] for record in found.records()] == ["up", "down"]
    assert [len(record.time) for record in found.records()] == [12, 12]
    renamed = tmp_path / "runs.csv"
    renamed.write_text(file.read_text().replace("trial", "run", 1))
    again = load_measurement(renamed, columns={"trial": "run"})
    assert [record.name for record in again.records()] == ["trial 1", "trial 2"]


def test_mistakes_within_a_split_table_name_the_line_of_the_file(tmp_path):
    head = "time,velocity,friction,trial,way\n"
    file = write(tmp_path / "all.csv", temperature="1", head=head, rows=3)
    with file.open("a") as more:
        more.write("0,0.1,2,2,up\n1,x,2,2,up\n")
    with pytest.raises(InputError, match="line 6"):
        load_measurement(file)
    file.write_text(file.read_text().replace("1,x,2,2,up", "1,0.1,2,,up"))
    with pytest.raises(InputError, match="line 6: the trial of this row is missing"):
        load_measurement(file)


def test_a_condition_that_changes_within_a_trial_is_refused_and_a_noisy_one_is_averaged(tmp_path):
    file = write(
        tmp_path / "cold.csv", extra=ROWS.format(t=9, v=0.1, f=2, temperature=40, way="up")
    )
    file.write_text(file.read_text().replace("temperature [degC]", "humidity"))
    with pytest.raises(InputError, match="changes within the trial \\(from 20 to 40\\)"):
        load_measurement(file, conditions="humidity")
    file = write(
        tmp_path / "cold.csv", extra=ROWS.format(t=9, v=0.1, f=2, temperature=20.5, way="")
    )
    found = load_measurement(file, conditions=["temperature", "way"]).conditions
    assert found["temperature [degC]"] == pytest.approx(20.0 + 0.5 / 13)
    assert found["way"] == "up"  # an empty cell says nothing


def test_a_missing_value_is_left_out_and_an_unknown_column_refused(tmp_path):
    file = write(tmp_path / "cold.csv", temperature="")
    assert dict(load_measurement(file, conditions="temperature").conditions) == {}
    with pytest.raises(UnknownNameError, match="Did you mean"):
        load_measurement(file, conditions="temperatur")


def test_a_table_of_travels_has_conditions_that_check_says_are_not_used(tmp_path):
    file = tmp_path / "travels.csv"
    file.write_text("travel [mm],mechanism.compression [mm],oil\n72,60,dry\n200,100,\n")
    rig = SpringBlock(mass=1.0, stiffness=100.0)
    found = load_measurement(file, mechanism=rig, conditions="oil")
    assert [dict(record.conditions) for record in found.records()] == [{"oil": "dry"}, {}]
    (finding,) = check(found).of("conditions")
    assert "trial with a single value cannot be fitted separately" in str(finding)
    with pytest.raises(InputError, match='give conditions="oil"'):
        load_measurement(file, mechanism=rig)


def test_a_rig_file_names_columns_or_gives_values(files, tmp_path):
    head = '[mechanism]\ntype = "axis"\ninertia = 1\n'
    rig = tmp_path / "rig.toml"
    rig.write_text(
        head + '[data]\nfiles = ["cold.csv", "warm.csv"]\nconditions = ["temperature"]\n'
        'validate = "cold.csv"\n'
    )
    found = load_rig(rig)
    assert [record.conditions["temperature [degC]"] for record in found.measurement.records()] == [
        20,
        60,
    ]
    assert not found.validate.conditions
    rig.write_text(
        head + '[[trial]]\nfile = "cold.csv"\nconditions = { load = 3, side = "left" }\n'
        '[[trial]]\nfile = "warm.csv"\nconditions = { load = 5.5 }\n'
    )
    first, last = load_rig(rig).measurement.records()
    assert (dict(first.conditions), dict(last.conditions)) == (
        {"load": 3.0, "side": "left"},
        {"load": 5.5},
    )


def test_a_second_trial_changes_nothing_of_a_single_record(tmp_path):
    record = load_measurement(write(tmp_path / "cold.csv"), mechanism=Axis(inertia=1.0))
    np.testing.assert_allclose(record.time, 0.1 * np.arange(12))
    assert record.trials == ()
