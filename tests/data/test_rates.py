"""Rows without times get those of a rate, which a line above them states, or who reads them."""

import numpy as np
import pytest

from stickslip import load_measurement, load_rig
from stickslip.data import guess_data, guessed_rig, read_data
from stickslip.errors import InputError, ParameterError

N = 40
X = 0.3 * np.sin(0.2 * np.arange(N))


def table(separator=",", decimal="."):
    """Return rows of an angle and a torque below their names."""
    rows = "".join(f"{x:.4f}{separator}{2.0 * x:.4f}\n" for x in X)
    return f"angle{separator}torque\n{rows.replace('.', decimal)}"


STATED = {
    "tabs": ("Rate [Hz]:\t50\tx-velocity [mm/s]:\t10\n" + table("\t"), "50 Hz", 0.02),
    "words": ("Sampling frequency: 2 kHz\n" + table("\t"), "2 kHz", 0.0005),
    "step": ("Rig 3\ndt = 0.5 ms\n" + table(), "0.5 ms", 0.0005),
    "cell": ("Rate,50 Hz,Gain,3\n" + table(), "50 Hz", 0.02),
    "German": ("# Abtastrate: 0,5 kHz\n# Bediener: X\n" + table(";", ","), "0.5 kHz", 0.002),
    "thousands": ("Sampling rate: 1,000 Hz\n" + table(), "1000 Hz", 0.001),
    "unit of the key": ("Abtastintervall [ms];0,5\n" + table(";", ","), "0.5 ms", 0.0005),
    "unit in a cell": ("Sample Interval,0.01,s\n" + table(), "0.01 s", 0.01),
    "samples": ("Sample rate: 2 kS/s\n" + table(), "2 kHz", 0.0005),
    "no unit": ("fs=1000\n" + table(), "1000 Hz", 0.001),
    "twice alike": ("Rate: 100 Hz\nSample period: 10 ms\n" + table(), "100 Hz", 0.01),
    "ends of lines": (f"Rate: 100 Hz\n{table()}".replace("\n", "\r"), "100 Hz", 0.01),
}


@pytest.mark.parametrize("name", STATED)
def test_rows_get_the_times_of_a_rate_that_a_line_above_them_states(tmp_path, name):
    text, rate, step = STATED[name]
    file = tmp_path / "log.txt"
    file.write_bytes(text.encode())
    guess = guess_data(file)
    assert guess.columns["time"] == rate
    assert "states: " in guess.reasons["time"]
    (tmp_path / "log.toml").write_text(guessed_rig(guess, "log.txt"))
    record = load_rig(tmp_path / "log.toml").measurement
    # a quotient or product of two floats
    np.testing.assert_allclose(record.time, step * np.arange(N), rtol=1e-14)
    np.testing.assert_allclose(record.position, X, atol=5.1e-5)  # four digits


@pytest.mark.parametrize(
    "line",
    [
        *("Baud rate: 115200", "Frequency: 5 Hz", "Scan rate: 50 mV/s", "Sample time: 12:30:05"),
        *("Rates: 5", "Number of samples: 100", "Sample step: 3 mm", "Sampling rate: 0 Hz"),
    ],
)
def test_other_numbers_above_a_header_are_no_rate_of_its_rows(tmp_path, line):
    file = tmp_path / "log.csv"
    file.write_text(f"{line}\n{table()}")
    with pytest.raises(InputError, match=r"no column seems to hold times; .* give the rate of"):
        guess_data(file)


def test_two_rates_are_named_and_neither_is_taken(tmp_path):
    file = tmp_path / "log.csv"
    file.write_text(f"Sampling rate: 100 Hz\nSample interval: 5 ms\n{table()}")
    with pytest.raises(InputError, match="above state several rates, 100 Hz and 5 ms; the columns"):
        guess_data(file)
    assert guess_data(file, columns={"time": "100 Hz"}).columns["time"] == "100 Hz"


def test_a_column_of_times_comes_before_a_stated_rate_and_a_counter_behind_it(tmp_path):
    file = tmp_path / "log.csv"
    rows = "".join(f"{i},{x:.4f}\n" for i, x in enumerate(X))
    for name, read in (("time", "time"), ("index", "100 Hz")):
        file.write_text(f"Sampling rate: 100 Hz\n{name},angle\n{rows}")
        guess = guess_data(file)
        assert guess.columns["time"] == read
    assert "'index'" in "".join(guess.doubts)  # is not read


def test_a_rate_or_a_step_stands_for_a_column_of_times(tmp_path):
    file = tmp_path / "log.csv"
    file.write_text(table())
    names = {"position": "angle", "force": "torque"}
    for rate, step in (("50 Hz", 0.02), ("0.5 ms", 0.0005)):
        for given in (file, {"angle": X, "torque": 2.0 * X}):
            record = load_measurement(given, columns={"time": rate, **names})
            np.testing.assert_allclose(record.time, step * np.arange(N), rtol=1e-14)
            assert not record.unused
    with pytest.raises(ParameterError, match=r"columns.time .* must be above 0 Hz, got '0 Hz'"):
        load_measurement(file, columns={"time": "0 Hz", **names})
    with pytest.raises(InputError, match=r'without times: .* as columns=\{"time": "50 Hz"\}'):
        load_measurement(file, columns=names)


@pytest.mark.parametrize("name", ["log", "run_0.5mm", "run.log"])
def test_a_log_without_an_ending_is_read_as_text(tmp_path, name):
    file = tmp_path / name
    file.write_text(f"Rate: 50 Hz\n{table()}")
    guess = guess_data(file)
    assert read_data([file], guess.reading).name == (name.removesuffix(".log"))
    file.write_bytes(bytes(range(256)) * 20)
    with pytest.raises(InputError, match="is a binary file"):
        guess_data(file)
