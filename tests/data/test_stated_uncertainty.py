"""Uncertainties that a table of friction states for each reading: given, read, found, checked."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Measurement, check, load_measurement, load_rig
from stickslip.data import guess_data, guessed_rig, read_data, refuse_unused
from stickslip.data.differentiation import rows_of
from stickslip.errors import InputError, ParameterError, UnknownNameError

V = np.array([0.01, 0.02, 0.05, 0.1, 0.2, 0.4, -0.05, -0.1])
F = np.array([3.51, 3.4, 3.2, 3.0, 2.9, 3.1, -3.3, -3.0])
U = np.array([0.1, 0.12, 0.1, 0.08, 0.1, 0.2, 0.1, 0.15])
TABLE = Measurement(velocity=V, friction=F, uncertainty={"friction": U})


def text(header, *columns, separator=",", decimal="."):
    """Return a table as text."""
    rows = (
        separator.join(map(str, row)).replace(".", decimal) for row in zip(*columns, strict=True)
    )
    return "\n".join([header, *rows, ""])


@pytest.fixture
def write(tmp_path):
    def written(content, name="table.csv", encoding="utf-8"):
        path = tmp_path / name
        path.write_bytes(content.encode(encoding))
        return path

    return written


def found_in(path):
    """Return what a file says of the uncertainty of friction, read as `init` reads it."""
    guess = guess_data(path)
    return guess, read_data([path], guess.reading).uncertainty.get("friction")


# In measurements.


def test_an_uncertainty_for_each_reading_is_kept_read_only_and_apart_from_what_was_given():
    given = U.copy()
    record = Measurement(velocity=V, friction=F, uncertainty={"friction": given})
    given[0] = 9.0
    kept = record.uncertainty["friction"]
    np.testing.assert_array_equal(kept, U)
    with pytest.raises(ValueError, match="read-only"):
        kept[0] = 1.0
    assert "uncertainty 0.08 to 0.2 N (standard)" in str(record)


@pytest.mark.parametrize(
    "made",
    [
        pickle.loads(pickle.dumps(TABLE)),
        copy.deepcopy(TABLE),
        replace(TABLE, name="other"),
        Measurement(trials=(TABLE, TABLE)).records()[1],
        load_measurement(TABLE.to_dataframe()),
        load_measurement(Measurement(trials=(TABLE, TABLE)).to_dataframe().head(len(V))),
    ],
)
def test_what_makes_a_measurement_of_another_carries_its_uncertainties(made):
    np.testing.assert_array_equal(made.uncertainty["friction"], U)


def test_rows_of_a_record_have_their_uncertainties_and_a_number_stays_one():
    record = Measurement(
        time=np.arange(8.0), position=V, force=F, uncertainty={"force": U, "position": 1e-3}
    )
    part = rows_of(record, 2, 5)
    np.testing.assert_array_equal(part.uncertainty["force"], U[2:5])
    assert part.uncertainty["position"] == 1e-3


def test_repeated_travels_have_an_uncertainty_each_and_their_root_mean_square_sums_it_up():
    record = Measurement(travel=[0.2, 0.3], uncertainty=[3e-3, 4e-3])
    assert record.usual_uncertainty("travel") == pytest.approx(np.sqrt(12.5) * 1e-3, rel=1e-12)
    back = load_measurement(record.to_dataframe()).records()
    assert [trial.uncertainty["travel"] for trial in back] == [3e-3, 4e-3]
    assert Measurement(travel=0.2).usual_uncertainty("travel") == 0.0
    assert Measurement(travel=0.2, uncertainty="5 mm").usual_uncertainty("travel") == 0.005


WRONG = {
    "too few": (U[:3], r"uncertainty.friction \(u_F\) \[N\] .* 8 from 0, .*got 3 numbers"),
    "negative": (-U, "got -0.1 at index 0: correct or leave it out"),
    "not finite": (np.where(U > 0.19, np.nan, U), "must be finite, got nan at index 5"),
    "words": (["a"] * 8, "must be real numbers"),
    "zero for all": (0.0, "must be above 0"),
}


@pytest.mark.parametrize(("doubt", "message"), WRONG.values(), ids=WRONG)
def test_what_is_no_uncertainty_is_refused_with_range_and_cure(doubt, message):
    with pytest.raises(ParameterError, match=message):
        Measurement(velocity=V, friction=F, uncertainty={"friction": doubt})


def test_an_array_beside_trials_is_refused_as_a_number_is():
    with pytest.raises(InputError, match="uncertainty is given beside trials"):
        Measurement(trials=(TABLE,), uncertainty=U)


def test_rows_of_tables_may_be_weighted_while_records_in_time_refuse_what_they_do_not_use():
    refuse_unused(TABLE)
    with pytest.raises(InputError, match=r"uncertainty \(friction\) .* has no effect"):
        refuse_unused(replace(TABLE, time=np.arange(8.0)))


# In files: units, gains and coefficients.

READ = {
    "the unit of the readings": ({"units": {"friction": "mN"}}, 1e-3 * U),
    "its own unit": ({"units": {"friction_uncertainty": "mN"}}, 1e-3 * U),
    "a gain is a sign": ({"gain": {"friction": -1}}, U),
    "a gain of both": ({"units": {"friction": "V"}, "gain": {"friction": "-10 N/V"}}, 10 * U),
    "a gain of the readings alone": (
        {"units": {"friction": "V", "friction_uncertainty": "N"}, "gain": {"friction": 10}},
        U,
    ),
    "a coefficient": ({"units": {"friction": "1"}, "mechanism": Axis(inertia=1, load=20)}, 20 * U),
    "shares": ({"units": {"friction_uncertainty": "%"}}, U / 100 * np.abs(F)),
    "shares of a coefficient": (
        {
            "units": {"friction": "1", "friction_uncertainty": "%"},
            "mechanism": Axis(inertia=1, load=20),
        },
        U / 100 * 20 * np.abs(F),
    ),
    "a torque": ({"units": {"friction": "N cm"}}, 1e-2 * U),
}


@pytest.mark.parametrize(("how", "expected"), READ.values(), ids=READ)
def test_uncertainties_become_si_as_the_readings_do(how, expected):
    columns = {"velocity": "v", "friction": "F", "friction_uncertainty": "sd"}
    record = load_measurement({"v": V, "F": F, "sd": U}, columns=columns, **how)
    np.testing.assert_allclose(record.uncertainty["friction"], expected, rtol=1e-14)


@pytest.mark.parametrize(
    ("given", "units", "expected"),
    [
        ("0.1 N", {}, 0.1),
        ("100 mN", {"friction": "kN"}, 0.1),
        ("0.1", {"friction": "kN"}, 100.0),
        (0.1, {"friction": "kN"}, 100.0),
        ("2 %", {}, 0.02 * np.abs(F)),
    ],
)
def test_a_number_in_place_of_a_column_is_that_of_each_reading(given, units, expected):
    columns = {"velocity": "v", "friction": "F", "friction_uncertainty": given}
    record = load_measurement({"v": V, "F": F}, columns=columns, units=units)
    found = record.uncertainty["friction"]
    np.testing.assert_allclose(found, np.broadcast_to(expected, 8), rtol=1e-14)


def test_uncertainties_stay_with_their_rows_where_these_are_dropped_or_brought_into_order():
    rows = {"v": V, "F": np.where(V == 0.1, np.nan, F), "sd": U, "time": [3, 1, 2, 5, 4, 8, 7, 6]}
    columns = {"velocity": "v", "friction": "F", "friction_uncertainty": "sd", "time": ""}
    record = load_measurement(rows, columns=columns, repair="gaps")
    order = [1, 2, 0, 4, 7, 6, 5]
    np.testing.assert_array_equal(record.friction, F[order])
    np.testing.assert_array_equal(record.uncertainty["friction"], U[order])


NAMED = {"velocity": "v", "friction": "F", "friction_uncertainty": "sd"}
REFUSED = {
    "negative": ({**NAMED, "friction_uncertainty": "v"}, {}, ParameterError, "got -0.05 at index"),
    "of nothing": ({"time": "t", "position": "v", "friction_uncertainty": "sd"}, {}, None, "frict"),
    "an array": (NAMED, {"uncertainty": {"friction": U}}, InputError, "as columns={"),
    "its own gain": (NAMED, {"gain": {"friction_uncertainty": 2}}, None, "quantity in gain"),
    "no such column": ({**NAMED, "friction_uncertainty": "u"}, {}, None, "unknown column"),
    "another unit": (NAMED, {"units": {"friction_uncertainty": "mm"}}, ParameterError, "'sd' .*mm"),
}


@pytest.mark.parametrize(("columns", "how", "error", "message"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_read_as_uncertainties_is_refused(columns, how, error, message):
    table = {"v": V, "F": F, "sd": U, "t": np.arange(8.0)}
    with pytest.raises(error or UnknownNameError, match=message):
        load_measurement(table, columns=columns, **how)


def test_a_rig_file_names_the_column_and_its_unit(write):
    write(text("v,F,sd", V, F, 1e3 * U))
    rig = write(
        "[mechanism]\ntype = 'axis'\ninertia = 1\n[data]\nfile = 'table.csv'\n"
        "columns = { velocity = 'v', friction = 'F', friction_uncertainty = 'sd' }\n"
        "units = { friction_uncertainty = 'mN' }\n[friction]\n",
        "rig.toml",
    )
    np.testing.assert_allclose(load_rig(rig).measurement.uncertainty["friction"], U, rtol=1e-14)
    rig.write_text(rig.read_text().replace("'sd'", "0.1").split("units")[0] + "[friction]\n")
    np.testing.assert_array_equal(load_rig(rig).measurement.uncertainty["friction"], 0.1)


# In files that nobody described.

HEADERS = [
    *("sd", "std", "sigma", "error", "err", "+-", "±", "uncertainty", "u(F)", "u_F", "F error"),
    *("friction_sd", "Unsicherheit", "sd (N)", "sd [N]", "sd_N", "± (N)", "F ± (N)", "+/- [N]"),
    *("Fehler", "Messunsicherheit (N)", "Standardabweichung", "standard deviation", "std. dev."),
    *("SE", "SEM", "stderr", "σ_F", "sigma_F (N)", "u(F) (N)", "Kraftfehler (N)", "sdF"),
]
HALF_WIDTHS = [
    *("ci95 (N)", "F_ci95", "95 % CI", "95 %", "95 % (N)", "error (95 %)", "error [95 %]"),
    *("U95 (N)", "95% confidence [N]"),
]
NONE = [
    *("CI (N)", "ci90 (N)", "ci95 low (N)", "v error", "velocity_sd", "position error"),
    *("tracking error", "M err", "x err", "load sd", "sd (mm/s)", "u (V)", "n", "error code"),
]


@pytest.mark.parametrize("header", [*HEADERS, *HALF_WIDTHS])
def test_the_column_of_uncertainties_beside_a_friction_is_known_by_its_name(write, header):
    path = write(text(f"v (m/s),F (N),{header}", V, F, U))
    guess, found = found_in(path)
    half = header in HALF_WIDTHS
    np.testing.assert_allclose(found, U / 1.96 if half else U, rtol=1e-14)
    assert (guess.columns["velocity"], guess.columns["friction"]) == ("v (m/s)", "F (N)")
    assert ("divided by 1.96" in guessed_rig(guess, file=path.name)) is half
    assert "friction_uncertainty  column" in guessed_rig(guess, file=path.name)


@pytest.mark.parametrize("header", NONE)
def test_a_column_that_is_no_uncertainty_of_friction_is_taken_for_none(write, header):
    guess, found = found_in(write(text(f"v (m/s),F (N),{header}", V, F, U)))
    assert found is None
    assert set(guess.columns) == {"velocity", "friction"}


TABLES = {
    "before the readings, with a unit": ("v (m/s),sd (N),F (N)", (V, U, F), U),
    "before the readings, by name": ("F_sd,F,v", (U, F, V), U),
    "of the velocity, perhaps": ("v,sd,F", (V, U, F), None),
    "of both": ("v (m/s),v_sd (m/s),F (N),F_sd (N)", (V, U / 100, F, U), U),
    "in another unit": ("v (m/s),F (N),sd (mN)", (V, F, 1e3 * U), U),
    "in per cent": ("v (m/s),F (N),error (%)", (V, F, U), U / 100 * np.abs(F)),
    "of a coefficient": ("v,mu,mu_err,load (N)", (V, F / 10, U / 10, 0 * V + 20), 2 * U),
    "signed": ("v,F,error", (V, F, U - 0.12), None),
    "codes": ("v,F,error", (V, F, 0 * U), None),
    "words": ("v,F,error", (V, F, ["ok"] * 8), None),
    "nothing": ("v,F,error", (V, F, [""] * 8), None),
    "the friction's own": ("v,F,sd,F error", (V, F, 9 * U, U), U),
    "beside a force": ("v (m/s),friction (N),u(F) (N)", (V, F, U), U),
}


@pytest.mark.parametrize(("header", "columns", "expected"), TABLES.values(), ids=TABLES)
def test_which_column_states_the_uncertainty_of_friction(write, header, columns, expected):
    _, found = found_in(write(text(header, *columns)))
    if expected is None:
        assert found is None
    else:
        np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("given", ["n", "0.1 N"])
def test_what_states_the_uncertainty_may_be_given(write, given):
    path = write(text("v,F,sd,n", V, F, U, 0 * U + 0.1))
    guess = guess_data(path, columns={"friction_uncertainty": given})
    assert guess.columns["friction_uncertainty"] == given
    found = read_data([path], guess.reading).uncertainty["friction"]
    np.testing.assert_array_equal(found, 0.1)


def test_another_column_of_uncertainties_is_named_as_a_doubt(write):
    guess, _ = found_in(write(text("v,F,sd,error", V, F, U, U)))
    assert guess.columns["friction_uncertainty"] == "sd"
    assert any("'error' may be the friction_uncertainty as well" in said for said in guess.doubts)


def test_errors_in_a_record_in_time_are_no_uncertainties(write):
    t = np.arange(0.0, 4.0, 0.01)
    columns = (t, np.sin(t), np.cos(t), 0 * t + 0.1, 0.01 * (1 + np.cos(t)), 0 * t + 0.1)
    header = "t (s),x (mm),F (N),position error,tracking error (mm),sd"
    guess = guess_data(write(text(header, *columns)))
    assert dict(guess.columns) == {"time": "t (s)", "position": "x (mm)", "force": "F (N)"}


@pytest.mark.parametrize(("separator", "decimal"), [(",", "."), (";", ","), ("\t", ",")])
@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        ("{} ± {}", U),
        ("{} +- {}", U),
        ("{}+/-{}", U),
        ("{}(10)", np.where(np.isin(F, [3.51]), 0.1, 1.0)),
    ],
)
def test_cells_may_hold_value_and_uncertainty(write, cell, expected, separator, decimal):
    cells = [cell.format(f, u) for f, u in zip(F, U, strict=True)]
    content = text(f"v (m/s){separator}F [N]", V, cells, separator=separator, decimal=decimal)
    path = write(content, encoding="cp1252" if decimal == "," else "utf-8")
    guess, found = found_in(path)
    np.testing.assert_allclose(found, expected, rtol=1e-14)
    np.testing.assert_array_equal(read_data([path], guess.reading).friction, F)
    by_name = load_measurement(
        path, columns={"velocity": "v (m/s)", "friction": "F"}, layout=guess.layout
    )
    np.testing.assert_allclose(by_name.uncertainty["friction"], expected, rtol=1e-14)


# What `check` says.

CHECKED = {
    "stated": (U, "info", "stated: 0.1 N in the median, from 0.08 N to 0.2 N."),
    "one number": (0.1, "info", "stated: 0.1 N."),
    "zeros": (U * (V > 0), "warning", "it is 0 in 2 of 8 rows: correct or leave out the column."),
    "larger": (U * 28, "warning", "it is above the reading in 2 of 8 rows: correct or"),
}


@pytest.mark.parametrize(("doubt", "severity", "said"), CHECKED.values(), ids=CHECKED)
def test_check_says_what_is_stated_and_what_is_doubtful_of_it(doubt, severity, said):
    record = Measurement(velocity=V, friction=F, uncertainty={"friction": doubt})
    (finding,) = check(record).of("uncertainty")
    assert said in str(finding)
    assert finding.severity == severity


def test_check_is_silent_of_uncertainties_that_are_not_stated():
    assert not check(replace(TABLE, uncertainty={})).of("uncertainty")
