"""Measurements from files: records in time, tables of trials, and what may be wrong with them."""

import numpy as np
import pandas as pd
import pytest

from stickslip import SpringBlock, load_measurement, load_rig
from stickslip.data import guess_data
from stickslip.errors import InputError, ParameterError, UnknownNameError

SPRING = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)


@pytest.fixture
def write(tmp_path, monkeypatch):
    """Writes a file into an empty working folder and returns its name."""
    monkeypatch.chdir(tmp_path)

    def writer(text, name="data.csv"):
        data = text if isinstance(text, bytes) else text.encode()
        (tmp_path / name).write_bytes(data)
        return name

    return writer


# --- records in time


def test_a_record_is_read_by_the_names_of_its_columns(write):
    record = load_measurement(write("time,position,velocity,force,note\n0,0,0,1,a\n1,2,3,4,b\n"))
    assert record.kind == "series"
    assert record.quantities() == ("position", "velocity", "force")
    np.testing.assert_array_equal(record.position, [0.0, 2.0])
    assert (record.name, record.provenance) == ("data", "data.csv")


def test_columns_are_mapped_and_converted(write):
    file = write("t_s,q_meas_m,noise\n0,0,1\n1,35,2\n")
    record = load_measurement(
        file, columns={"time": "t_s", "position": "q_meas_m"}, units={"position": "mm"}
    )
    np.testing.assert_array_equal(record.position, [0.0, 0.035])


def test_a_unit_in_the_header_is_converted(write):
    record = load_measurement(write("time [ms],position [mm]\n0,0\n240,35\n"))
    np.testing.assert_array_equal(record.time, [0.0, 0.24])
    np.testing.assert_array_equal(record.position, [0.0, 0.035])


def test_a_header_with_a_unit_is_mapped_with_or_without_it(write):
    file = write("time,q [mm]\n0,0\n1,35\n")
    for column in ("q", "q [mm]"):
        record = load_measurement(file, columns={"position": column})
        np.testing.assert_array_equal(record.position, [0.0, 0.035])


def test_parquet_is_read_like_csv(write, tmp_path):
    frame = pd.DataFrame({"t_s": [0.0, 0.1, 0.2], "x": [0, 1, 2]}, index=[5, 6, 7])
    frame.to_parquet(tmp_path / "data.parquet")
    file = tmp_path / "data.parquet"
    record = load_measurement(file, columns={"time": "t_s", "position": "x"})
    np.testing.assert_array_equal(record.position, [0.0, 1.0, 2.0])


@pytest.mark.parametrize(
    "text",
    [
        "time;position\n0;0,5\n1;1,5\n",
        "time\tposition\n0\t0.5\n1\t1.5\n",
        "# exported\n\ntime,position\n0,0.5\n1,1.5\n\n",
        "\ufefftime,position\r\n0,0.5\r\n1,1.5\r\n",
        ",time,position\n0,0,0.5\n1,1,1.5\n",
        "time,position\n0,0.5\n\n1,1.5\n",
    ],
    ids=["decimal comma", "tabs", "comments", "mark and CRLF", "row names", "blank line"],
)
def test_common_dialects_of_csv_are_understood(write, text):
    record = load_measurement(write(text))
    np.testing.assert_array_equal(record.position, [0.5, 1.5])


def test_a_file_without_time_may_be_a_friction_map(write):
    record = load_measurement(write("velocity,friction\n0.1,2\n0.2,3\n"), uncertainty=None)
    assert record.kind == "friction-map"


def test_what_stands_in_no_file_is_given_with_it(write):
    record = load_measurement(
        write("time,position\n0,0\n1,1\n"),
        uncertainty=0.01,
        uncertainty_kind="interval",
        overrides={"mechanism.mass": 2.0},
        initial={"x": 0.1},
        offset={"position": 0.1},
        name="run",
    )
    assert (record.uncertainty, record.uncertainty_kind) == ({"position": 0.01}, "interval")
    assert (record.overrides, record.initial) == ({"mechanism.mass": 2.0}, {"x": 0.1})
    assert (record.offset, record.name) == ({"position": 0.1}, "run")


def test_the_axis_record_is_read_in_si(data_dir):
    record = load_measurement(
        data_dir / "emps" / "train.parquet",
        columns={"time": "t_s", "position": "q_meas_m", "force": "force_N"},
    )
    # Rows as its description counts them, at 1 kHz; the clock of the record is 16 ppm off.
    assert record.time.size == 24841
    assert np.median(np.diff(record.time)) == pytest.approx(1e-3, rel=1e-4)


# --- tables of trials


def test_each_row_is_a_trial_with_its_own_settings(write):
    text = (
        "name,travel [mm],uncertainty [mm],uncertainty_kind,mechanism.compression [mm],initial.v\n"
        "short,72,5,rounding,60,0\n"
        "long,450,,standard,150,0.1\n"
    )
    with pytest.raises(ParameterError, match=r"'uncertainty \[mm\]', line 3.*got nothing"):
        load_measurement(write(text))
    first, second = load_measurement(write(text.replace("450,,", "450,1,"))).records()
    assert (first.name, first.travel, first.uncertainty) == ("short", 0.072, {"travel": 0.005})
    assert (first.uncertainty_kind, second.uncertainty_kind) == ("rounding", "standard")
    assert second.overrides == {"mechanism.compression": 0.15}
    assert second.initial == {"v": 0.1}
    assert second.provenance == "data.csv, line 3"


def test_what_all_trials_have_in_common_is_given_once(write):
    trials = load_measurement(
        write("travel\n0.1\n0.2\n"), uncertainty=0.005, overrides={"mechanism.mass": 2.0}
    ).records()
    assert {trial.uncertainty["travel"] for trial in trials} == {0.005}
    assert {trial.overrides["mechanism.mass"] for trial in trials} == {2.0}


def test_one_row_is_one_record(write):
    assert load_measurement(write("travel\n0.1\n")).trials == ()


def test_a_mechanism_lets_plain_names_stand_for_paths(write):
    file = write("travel,compression [mm]\n0.072,60\n0.2,100\n")
    first, _ = load_measurement(file, mechanism=SPRING).records()
    assert first.overrides == {"mechanism.compression": 0.06}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("travel,compresion\n0.1,1\n", "column 'compresion': .*'mechanism.compression'"),
        ("travel,compression [kg]\n0.1,1\n", r"'compression \[kg\]' must be in m .*not in kg"),
        ("travel,mass\n0.1,-1\n", r"line 2: .*\(m\) must be above 0 kg"),
        ("travel,initial.y\n0.1,1\n", "state in column of data.csv: 'y'"),
    ],
)
def test_a_mechanism_checks_the_columns(write, text, message):
    with pytest.raises(InputError, match=message):
        load_measurement(write(text), mechanism=SPRING)


# --- files that cannot be used

BAD = {
    "empty": ("", InputError, "data.csv: is empty"),
    "blank": ("\n \n", InputError, "has no header"),
    "header only": ("time,position\n", InputError, "has no rows"),
    "no known column": (
        "a,b\n1,2\n",
        InputError,
        r"no column is named .* columns are 'a', 'b'.*columns=",
    ),
    "time alone": ("time,b\n1,2\n", InputError, "no column is named"),
    "hole": ("time,position\n0,0\n1,\n", ParameterError, "column 'position', line 3.*got nothing"),
    "text": ("time,position\n0,0\n1,far\n", ParameterError, "'position', line 3: .*got 'far'"),
    "infinite": ("time,position\n0,0\n1,inf\n", ParameterError, "line 3: must be a finite number"),
    "truth": ("time,position\n0,true\n1,false\n", ParameterError, "line 2: must be a finite"),
    "order": ("time,position\n1,0\n0,1\n", InputError, "data.csv: .*must increase strictly"),
    "one sample": ("time,position\n1,0\n", InputError, "data.csv: .*at least 2 times"),
    "double column": (
        "time,position,position\n0,1,2\n",
        InputError,
        "columns are named 'position'",
    ),
    "double with units": (
        "travel [m],travel [mm]\n0,1\n",
        InputError,
        "columns are named 'travel'",
    ),
    "unit": ("time,position [kg]\n0,1\n1,2\n", ParameterError, "must be in m .*not in kg"),
    "unknown unit": ("time,position [mn]\n0,1\n1,2\n", ParameterError, "unknown unit 'mn'"),
    "long row": ("time,position\n0,1\n1,2,3\n", InputError, "rows and header do not match"),
    "long rows": ("time,position\n0,1,1\n1,2,3\n", InputError, "rows and header do not match"),
    "short row": ("time,position\n0,1\n1\n", ParameterError, "line 3: .*got nothing"),
    "not text": (b"time,position\n0,\xff\n", InputError, "is not UTF-8 .byte 0xff in line 2"),
    "misspelt trial column": (
        "travel,uncertainity\n1,1\n",
        UnknownNameError,
        "'uncertainity'. Did you mean 'uncertainty'",
    ),
    "zero uncertainty": ("travel,uncertainty\n1,0\n", ParameterError, "line 2: .*above 0 m, got 0"),
    "kind": ("travel,uncertainty_kind\n1,guess\n", InputError, "line 2: .*must be one of rounding"),
    "same name": (
        "travel,name\n1,a\n2,a\n",
        InputError,
        "data.csv: Trials 1 and 2 have the same name",
    ),
}


@pytest.mark.parametrize(("text", "error", "message"), BAD.values(), ids=BAD)
def test_a_bad_file_gives_one_message_with_place(write, text, error, message):
    file = write(text)
    with pytest.raises(error, match=message) as caught:
        load_measurement(file)
    assert "data.csv" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert caught.value.__cause__ is None


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"columns": {"position": "y"}}, "column of data.csv: 'y'. Known: time, x"),
        ({"columns": {"position": "x"}, "units": {"positon": "mm"}}, "'positon'.*'position'"),
        ({"columns": {"position": "x"}, "units": {"position": "kg"}}, "must be in m"),
        ({"columns": {"position": "x"}, "uncertainty": 0}, "above 0 m"),
        ({"columns": {"position": "x"}, "offset": {"force": 1}}, "quantity in offset"),
    ],
)
def test_bad_settings_are_refused(write, settings, message):
    file = write("time,x\n0,0\n1,1\n")
    with pytest.raises(InputError, match=message):
        load_measurement(file, **settings)


def test_a_broken_parquet_file_is_refused(write):
    with pytest.raises(InputError, match=r"data\.parquet: is not a Parquet file"):
        load_measurement(write("time,position\n", "data.parquet"))


def test_dates_are_seconds_since_the_first(write, tmp_path):
    frame = pd.DataFrame({"time": pd.to_datetime(["2020-01-01", "2020-01-02"]), "position": [0, 1]})
    frame.to_parquet(tmp_path / "data.parquet")
    np.testing.assert_array_equal(load_measurement(tmp_path / "data.parquet").time, [0, 86_400])


def test_another_kind_of_file_is_refused_with_a_cure(write):
    with pytest.raises(
        InputError, match=r"must be a .csv.* got .xls. Save other spreadsheets as CSV"
    ):
        load_measurement(write("x", "data.xls"))


def test_a_missing_file_is_named(write):
    write("x")
    with pytest.raises(InputError, match=r"does not exist.*data\.csv"):
        load_measurement("dta.csv")


# --- keys of columns


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("positon", "unknown quantity in columns 'positon'. Did you mean 'position'?"),
        ("current", "current is not a quantity.*force with a gain.*newtons per ampere"),
        ("voltage", "voltage is not a quantity.*force with a gain.*newtons per volt"),
        ("mechanism.mass", "unknown quantity of a record in columns 'mechanism.mass'"),
        ("uncertainty", "unknown quantity of a record in columns 'uncertainty'"),
    ],
)
def test_a_key_of_columns_that_is_no_quantity_is_refused(tmp_path, key, message):
    file = tmp_path / "record.csv"
    file.write_text("time,q,force\n0,0,1\n1,2,1\n")
    with pytest.raises(InputError, match=message):
        load_measurement(file, columns={key: "q"})


def test_a_typo_in_the_columns_of_a_rig_file_is_refused(tmp_path):
    (tmp_path / "record.csv").write_text("time,q,force\n0,0,1\n1,2,1\n")
    rig = tmp_path / "rig.toml"
    rig.write_text(
        '[mechanism]\ntype = "axis"\ninertia = 5\n'
        '[data]\nfile = "record.csv"\ncolumns = { postion = "q" }\n'
    )
    with pytest.raises(InputError, match="Did you mean 'position'"):
        load_rig(rig)


# --- what is in no file


@pytest.mark.parametrize(
    ("given", "kind", "cure"),
    [
        (np.zeros(3), "ndarray", r"Measurement\(time=t"),
        ([np.zeros(3)], "list", r"Measurement\(time=t"),
        (3, "int", r"Measurement\(time=t"),
    ],
)
def test_what_names_no_file_is_refused_with_what_to_make_of_it(given, kind, cure):
    with pytest.raises(InputError, match=f"takes a file name.*got {kind}: .*{cure}"):
        load_measurement(given)


def test_files_may_come_from_anything_that_lists_them(write, tmp_path):
    for name in ("a.csv", "b.csv"):
        write("time,position\n0,0\n1,1\n", name)
    for files in (tmp_path.glob("*.csv"), {"a.csv": 1}.keys(), np.array(["a.csv", "b.csv"])):
        assert {record.name for record in load_measurement(files).records()} <= {"a", "b"}


# --- numbers and headers that cannot be read


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('time,position\n0,0.5\n1,"12,592.5"\n', r"line 3: .*thousands separator, here '12592.5'"),
        # three decimals after a comma are no thousands: the word is what cannot be read
        ("time;position\n0;1,592\n1;stuck\n", r"line 3: must be a finite number, got 'stuck'.$"),
    ],
    ids=["commas", "a word"],
)
def test_the_number_that_cannot_be_read_is_named_and_not_its_neighbours(write, text, words):
    with pytest.raises(ParameterError, match=words):
        load_measurement(write(text))


PLAIN = "time,position\n0,0.5\n1,1.5\n"


@pytest.mark.parametrize(
    ("text", "last"),
    [
        (f"Instrument: T-100\nDate: 2024-05-01\n\n{PLAIN}", 1.5),
        (f"Tribometer\n{PLAIN}", 1.5),
        (f"# by hand\nsample,steel,dry\n{PLAIN}", 1.5),
        ("time position\n0 0.5\n1 1.5\n", 1.5),
        ("time|position\n0|0.5\n1|1.5\n", 1.5),
        ("time;position\ns;mm\n0;500\n1;1500\n", 1.5),
        ("time;position\n0;0,5\n1;1.592,0\n", 1592.0),
        ("time;position\n0;0,5\n1;12 592\n", 12592.0),
    ],
)
def test_a_table_is_found_below_lines_and_between_marks_of_any_kind(write, text, last):
    np.testing.assert_array_equal(load_measurement(write(text)).position, [0.5, last])


ROWS = [(f"{0.01 * i:.2f}", str(i), f"{0.5 * i:.1f}") for i in range(60)]
HEADER = "time,position,force\n"
BELOW = "".join(",".join(row) + "\n" for row in ROWS)
STATES = "".join(",".join(("run", *row)) + "\n" for row in ROWS)
MARKED = [
    (f"{0.01 * i:.2f};{20 + 0.1 * i:.1f};{0.5 * i:.2f};", f"{i * 0.15:.2f}") for i in range(60)
]
MIXED = "".join(point + comma.replace(".", ",") + "\n" for point, comma in MARKED)
QUOTED = "".join(f'"1,{i:03}","1,{37 * i % 1000:03}"\n' for i in range(60))
BLANKS = "".join(f"{0.1 * i:.1f};{100 * i:,}.0\n".replace(",", "\xa0") for i in range(60))


@pytest.mark.parametrize(
    ("text", "repair", "last"),
    [
        (f"{HEADER}nan,nan,nan\n{BELOW}", None, (0.59, 59.0, 29.5)),
        (f"{HEADER}NA,NA,NA\n{BELOW}", None, (0.59, 59.0, 29.5)),
        (f"{HEADER},,n/a\n{BELOW}", None, (0.59, 59.0, 29.5)),
        (f"state,{HEADER}idle,nan,nan,nan\n{STATES}", "gaps", (0.59, 59.0, 29.5)),
        (f"state,{HEADER}idle,,,\n{STATES}", "gaps", (0.59, 59.0, 29.5)),
        (f"state,{HEADER}A,,,\n{STATES}", "gaps", (0.59, 59.0, 29.5)),
        ("# a, b, c\n" * 500 + HEADER + BELOW, None, (0.59, 59.0, 29.5)),
        (
            f"time,position,force,2\n{BELOW.replace(chr(10), ',7' + chr(10))}",
            None,
            (0.59, 59, 29.5),
        ),
        (
            f"time,position,force,10:00\n{BELOW.replace(chr(10), ',7' + chr(10))}",
            None,
            (0.59, 59, 29.5),
        ),
        (f"time;temp;position;force\n{MIXED}", None, (0.59, 29.5, 8.85)),
        (f"sample,steel,\n{HEADER}{BELOW}", None, (0.59, 59.0, 29.5)),
        (f"Rate,100,Hz\n{HEADER}s,mm,N\n{BELOW}", None, (0.59, 0.059, 29.5)),
        (f"time [s],position,force\ns,mm,N\n{BELOW}", None, (0.59, 0.059, 29.5)),
        (f"Rig 3\nDate,Time\n2024-01-01,10:00\n\n{HEADER}{BELOW}", None, (0.59, 59.0, 29.5)),
        (f"time;position\n{BLANKS}".encode("cp1252"), None, (5.9, 5900.0)),
    ],
)
def test_the_first_line_that_has_names_for_all_columns_is_the_header(write, text, repair, last):
    record = load_measurement(write(text), repair=repair)
    assert record.time.size == 60
    names = ("time", "position", "force")[: len(last)]
    np.testing.assert_allclose([getattr(record, name)[-1] for name in names], last)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (f"{HEADER}clock,slide,motor\n{BELOW}", "line 1, .* and line 2, 'clock,slide,motor', may"),
        (f"{HEADER}s,mm,N\nclock,slide,motor\n{BELOW}", "line 1, .* and line 3, 'clock,slide,"),
        (f"{HEADER}clock,slide,motor\ns,mm,N\n{BELOW}", "line 1, .* and line 2, 'clock,slide,"),
        (f"{HEADER}float64,float64,float64\n{BELOW}", "column 'time', line 2: .* got 'float64'"),
        (f"{HEADER}# s, m, N\n{BELOW}", "column 'time', line 2: .* got '# s'"),
        (f"{HEADER}s,mm,N\n,,raw\n{BELOW}", r"column 'time \[s\]', line 3: .* got nothing"),
        (
            f"time [ms],position,force\ns,mm,N\n{BELOW}",
            "header states ms of the column 'time', and",
        ),
        (
            f"{HEADER}{BELOW}\nvelocity,friction\n1,2\n",
            "line 63, 'velocity,friction', .* second header",
        ),
        (f"Rig\n{HEADER}0,1,2\n1,2,3\n2,3,4\n\na,b\n" + "1,2\n" * 20, "line 2, .* beside line 7"),
        (
            f"Rig,steel,dry\ntime,position,force,\n{BELOW}",
            "line 1, .* and line 2, 'time,position,f",
        ),
        (f"time,position\n{QUOTED}", "column 'time', line 2: .* got '1,000'"),
    ],
)
def test_a_text_with_two_headers_or_units_is_refused_with_their_lines(write, text, words):
    with pytest.raises(InputError, match=f"^data.csv: .*{words}"):
        load_measurement(write(text))


def test_quoted_commas_alone_are_decimal_and_said_to_be_assumed(write):
    guess = guess_data(write(f"time,position\n{QUOTED}"))
    assert guess.layout.decimal == ","
    words = "1,000 is read as 1.000: no number shows whether its comma is decimal or parts"
    assert any(doubt.startswith(words) for doubt in guess.doubts)


def test_a_row_that_is_too_long_is_told_in_plain_words(write):
    with pytest.raises(InputError, match=r"line 3, saw 4\). Every row needs 3 cells") as caught:
        load_measurement(write("time,position,note\n0,0.5,b\n1,1.5,a,b\n"))
    assert "C error" not in str(caught.value)


def test_friction_over_a_path_is_told_what_makes_a_record_of_it(write):
    file = write("position,friction\n0.0,1.0\n0.1,2.0\n")
    with pytest.raises(InputError, match="a column of times, the distance divided by the speed"):
        load_measurement(file)
