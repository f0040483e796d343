"""Contact inputs of measurements: columns, conditions, units, slices."""

import numpy as np
import pandas as pd
import pytest

from stickslip import Measurement, check, load_measurement
from stickslip.data import unit_of_input
from stickslip.data.differentiation import rows_of
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.units import converted, number_in

T = np.arange(0.0, 5.0, 0.01)


def file_of(tmp_path, **columns):
    table = {"time [s]": T, "position [m]": np.sin(T), "force [N]": np.cos(T), **columns}
    path = tmp_path / "run.csv"
    pd.DataFrame(table).to_csv(path, index=False)
    return path


def test_columns_of_contact_inputs_are_read_in_their_units(tmp_path):
    path = file_of(tmp_path, **{"temperature [K]": 293.15 + T, "pressure [bar]": 1.0 + 0.0 * T})
    record = load_measurement(path)
    np.testing.assert_allclose(record.inputs["temperature"], 20.0 + T, atol=1e-12)
    np.testing.assert_allclose(record.inputs["pressure"], 1e5)
    assert record.input_names() == ("temperature", "pressure")


def test_a_column_of_another_name_can_be_an_input(tmp_path):
    path = file_of(tmp_path, **{"T oil [°C]": 40.0 + T})
    record = load_measurement(path, columns={"temperature": "T oil"})
    np.testing.assert_allclose(record.inputs["temperature"], 40.0 + T)


def test_a_column_that_nobody_named_may_be_something_else(tmp_path):
    broken = np.where(T > 4.0, np.nan, 20.0)
    path = file_of(tmp_path, **{"motor [A]": T, "temperature [degC]": broken})
    record = load_measurement(path)
    assert not record.inputs
    assert set(record.unused) == {"motor", "temperature"}
    with pytest.raises(ParameterError, match="must be in N"):
        load_measurement(path, columns={"motor": "motor"})
    with pytest.raises(ParameterError, match="finite number"):
        load_measurement(path, columns={"temperature": "temperature"})


def test_gaps_of_a_named_input_are_dropped_if_asked(tmp_path):
    path = file_of(tmp_path, **{"T oil [°C]": np.where(T > 4.0, np.nan, 40.0 + T)})
    with pytest.raises(ParameterError, match='give repair="gaps"'):
        load_measurement(path, columns={"temperature": "T oil"})
    record = load_measurement(path, columns={"temperature": "T oil"}, repair="gaps")
    np.testing.assert_allclose(record.inputs["temperature"], 40.0 + record.time)
    assert record.time[-1] == 4.0


def test_complex_numbers_and_truth_values_are_no_quantities():
    for cells in (T + 1j, T > 2.0):
        with pytest.raises(ParameterError, match=r"must be a finite number, got [^.]*\.?[^.]*$"):
            load_measurement({"time": T, "position": cells})


def test_repairs_keep_inputs_beside_their_samples(tmp_path):
    order = np.r_[0:200, 250:300, 200:250, 300:500]
    table = pd.DataFrame({"time [s]": T, "position [m]": T, "temperature [degC]": 3.0 * T})
    path = tmp_path / "run.csv"
    table.iloc[order].to_csv(path, index=False)
    record = load_measurement(path, repair="sort")
    np.testing.assert_allclose(record.inputs["temperature"], 3.0 * record.time, atol=1e-12)


def test_a_table_is_read_again_as_it_was_written(tmp_path):
    first = load_measurement(file_of(tmp_path, **{"temperature [degC]": 20.0 + T}))
    again = load_measurement(first.to_dataframe())
    assert again.inputs["temperature"].tolist() == first.inputs["temperature"].tolist()


def test_a_check_says_that_laws_may_depend_on_a_recorded_input(tmp_path):
    record = load_measurement(file_of(tmp_path, **{"temperature [degC]": 20.0 + T, "foo": T}))
    sentences = [finding.sentence for finding in check(record).findings]
    assert any("Measured beside: temperature" in sentence for sentence in sentences)
    assert "Column 'foo' is not used." in sentences


def test_conditions_of_their_names_are_inputs_in_their_units():
    record = Measurement(
        velocity=[0.1, 0.2], friction=[1.0, 1.1], turning=True,
        conditions={"temperature [K]": 300.15, "gravity [N m]": 2.0, "operator": "x"},
    )  # fmt: skip
    assert record.contact_inputs() == {"temperature": 27.0, "gravity": 2.0}
    assert unit_of_input("gravity", turning=True) == "N m"


def test_rows_of_a_record_have_the_inputs_of_these_rows():
    record = Measurement(time=T, position=T, inputs={"temperature": 2.0 * T, "pressure": 5.0})
    part = rows_of(record, 10, 20)
    assert part.inputs["temperature"].tolist() == (2.0 * T[10:20]).tolist()
    assert part.inputs["pressure"] == 5.0


@pytest.mark.parametrize(
    ("inputs", "error", "words"),
    [
        ({"temprature": 1.0}, UnknownNameError, "Did you mean 'temperature'"),
        ({"temperature": [1.0, 2.0, 3.0]}, InputError, "has 3 values"),
        ({"temperature": [1.0, float("nan")]}, ParameterError, "must be finite"),
        ({"temperature": "30 mm"}, ParameterError, "must be in degC"),
        ({"position": [1.0, 2.0]}, InputError, r"position, which is a quantity of the record"),
        (5, InputError, "must be a mapping by name, got 5"),
    ],
)
def test_inputs_that_do_not_fit_are_refused(inputs, error, words):
    with pytest.raises(error, match=words):
        Measurement(time=[0.0, 1.0], position=[0.0, 0.0], force=[1.0, 2.0], inputs=inputs)


def test_temperatures_are_converted_with_their_zeros():
    assert number_in("300 K", "degC") == 26.85
    assert number_in("35 °C", "degC") == 35.0
    np.testing.assert_allclose(converted(np.array([32.0, 212.0]), "degF", "degC"), [0.0, 100.0])
    with pytest.raises(ParameterError, match="must be in degC"):
        converted(1.0, "mm", "degC")
