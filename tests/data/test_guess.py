"""Files as programs and people write them are recognised, and read as they were meant."""

import contextlib
import re
from datetime import datetime, timedelta

import numpy as np
import pytest

from stickslip import Axis, check, load_measurement, load_rig
from stickslip.data import Layout, guess_data, guessed_rig, read_data
from stickslip.data.readers import guess as guessing
from stickslip.data.readers.table_reader import read_frame as frame
from stickslip.errors import InputError, ParameterError, StickslipError

N = 1200
LONG = 300_000
T = np.arange(N) / 100
X = 3.0 * np.sin(2.0 * T)  # [m]: thousands of mm
F = 40.0 * np.cos(2.0 * T) + 5.0 * np.sign(np.cos(2.0 * T))


def german(value, digits=4, thousands=""):
    """Return a number as a German programme prints it."""
    text = f"{value:,.{digits}f}"
    return text.replace(",", "\0").replace(".", ",").replace("\0", thousands)


def rows(columns, separator=";", write=german, end="\n", trailing=""):
    """Return rows of a table."""
    return (
        end.join(separator.join(map(write, row)) + trailing for row in zip(*columns, strict=True))
        + end
    )


def points(value):
    return f"{value:.4f}"


def stamps(pattern, mark=","):
    """Return time stamps over midnight, to the millisecond."""
    begin = datetime(2024, 3, 1, 23, 59, 55)
    found = [(begin + timedelta(seconds=float(t))).strftime(pattern)[:-3] for t in T]
    return [mark.join(stamp.rsplit(".", 1)) for stamp in found]


PREFACE = "Prüfstand 3;Bediener: Müller\nDatum;01.03.2024\nAbtastrate;100;Hz\n\n"
BODY = rows((T, 1e3 * X, F))
ENGLISH = rows((T, X, F), ",", lambda value: f"{value:.6f}")
MM = (T, 1e3 * X, F)

FILES = {
    "units in a row": (f"Zeit;Weg;Kraft\ns;mm;N\n{BODY}", "cp1252"),
    "units in brackets in a row": (f"Zeit;Weg;Kraft\n[s];[mm];[N]\n{BODY}", "cp1252"),
    "preface": (f"{PREFACE}Zeit;Weg;Kraft\ns;mm;N\n{BODY}", "cp1252"),
    "comments": (f"# {PREFACE[:12]}\n# zwei\nZeit [s];Weg [mm];Kraft [N]\n{BODY}", "utf-8"),
    "parentheses": (f"Zeit (s);Weg (mm);Kraft (N)\n{BODY}", "utf-8-sig"),
    "slashes": (f"t / s;Weg / mm;Kraft / N\n{BODY}", "utf-8"),
    "words": (f"Zeit in s;Weg in mm;Kraft in N\n{BODY}", "utf-16"),
    "underscores": (f"t_s;pos_mm;force_N\n{BODY}", "utf-16-le"),
    "windows": (f"Zeit;Weg;Kraft\ns;mm;N\n{BODY}".replace("\n", "\r\n"), "cp1252"),
    "tabs": ("Zeit\tWeg\tKraft\ns\tmm\tN\n" + rows(MM, "\t"), "cp1252"),
    "trailing": ("Zeit;Weg;Kraft;\ns;mm;N;\n" + rows(MM, trailing=";"), "cp1252"),
    "trailing in rows": ("Zeit;Weg;Kraft\ns;mm;N\n" + rows(MM, trailing=";"), "cp1252"),
    "thousands": (
        "Zeit;Weg;Kraft\ns;mm;N\n" + rows(MM, write=lambda v: german(v, thousands=".")),
        "cp1252",
    ),
    "thin thousands": (
        "Zeit;Weg;Kraft\ns;mm;N\n" + rows(MM, write=lambda v: german(v, thousands="\u00a0")),
        "utf-8",
    ),
    "blanks": (
        "Prüfstand 3, Müller\n Zeit   Weg  Kraft\n s mm N\n" + rows(MM, "   ", trailing=" "),
        "cp1252",
    ),
    "blanks below a comment": ("# t/s x/mm F/N\n" + rows(MM, " \t", points), "utf-8"),
    "quotes": ("Zeit,Weg,Kraft\ns,mm,N\n" + rows(MM, ",", lambda v: f'"{german(v)}"'), "utf-8"),
    "all quoted": (
        '"Zeit";"Weg";"Kraft"\n"s";"mm";"N"\n' + rows(MM, ";", lambda v: f'"{german(v)}"'),
        "cp1252",
    ),
    "english": (f"Time,Position,Force\n{ENGLISH}", "utf-8"),
    "english thousands": (
        "time;position;force\ns;mm;N\n" + rows(MM, ";", lambda v: f"{v:,.4f}"),
        "utf-8",
    ),
    "points and commas": (
        "Zeit;Weg;Kraft\ns;mm;N\n"
        + "".join(
            f"{points(t)};{german(1e3 * x)};{points(f)}\n" for t, x, f in zip(T, X, F, strict=True)
        ),
        "utf-8",
    ),
    "other columns": (
        "Zähler;Zeit;Sollweg;Weg;Schleppfehler;Kraft;Temperatur;Bemerkung\n;s;mm;mm;mm;N;°C;\n"
        + "".join(
            f"{i};{german(t)};{german(1e3 * x + 1)};{german(1e3 * x)};{german(1)};{german(f)};"
            f"{german(21.5)};{'Start' if i == 0 else ''}\n"
            for i, (t, x, f) in enumerate(zip(T, X, F, strict=True))
        ),
        "cp1252",
    ),
    "dates": (
        "Zeitstempel;Weg;Kraft\n;mm;N\n"
        + "".join(
            f"{stamp};{german(1e3 * x)};{german(f)}\n"
            for stamp, x, f in zip(stamps("%d.%m.%Y %H:%M:%S.%f"), X, F, strict=True)
        ),
        "cp1252",
    ),
    "iso": (
        "timestamp,position,force\n"
        + "".join(
            f"{stamp},{x:.6f},{f:.4f}\n"
            for stamp, x, f in zip(stamps("%Y-%m-%dT%H:%M:%S.%f", "."), X, F, strict=True)
        ),
        "utf-8",
    ),
    "times of day over midnight": (
        "Datum;Uhrzeit;Weg;Kraft\n;;mm;N\n"
        + "".join(
            f"01.03.2024;{stamp};{german(1e3 * x)};{german(f)}\n"
            for stamp, x, f in zip(stamps("%H:%M:%S.%f"), X, F, strict=True)
        ),
        "cp1252",
    ),
}


@pytest.mark.parametrize(("text", "encoding"), FILES.values(), ids=FILES)
def test_a_record_in_any_dress_is_read_as_it_was_meant(tmp_path, text, encoding):
    file = tmp_path / "messung.csv"
    file.write_bytes(text.encode(encoding))
    guess = guess_data(file)
    record = load_measurement(
        file, columns=guess.columns, units=guess.units, layout=guess.layout, repair=guess.repair
    )
    assert {"time", "position", "force"} <= set(guess.columns)
    # half of the last digit that is printed
    np.testing.assert_allclose(record.time - record.time[0], T, atol=5e-4)
    np.testing.assert_allclose(record.position, X, atol=6e-7)
    np.testing.assert_allclose(record.force, F, atol=6e-5)
    assert not record.turning
    (tmp_path / "messung.toml").write_text(guessed_rig(guess, "messung.csv"), encoding="utf-8")
    rig = load_rig(tmp_path / "messung.toml")
    np.testing.assert_array_equal(rig.measurement.force, record.force)
    assert rig.vary == ("mechanism.inertia",)
    assert check(rig.measurement, mechanism=rig.mechanism).worst != "error"


HEAD = """LabVIEW Measurement\t
Writer_Version\t2
Separator\tTab
Decimal_Separator\t{mark}
X_Columns\tOne
Date\t2024/03/01
Time\t10:00:00.5
***End_of_Header***\t
\t
Channels\t2\t\t
Samples\t{n}\t{n}\t
Y_Unit_Label\t{place}\t{push}\t
X_Dimension\tTime\tTime\t
X0\t0.0\t0.0\t
Delta_X\t0.01\t0.01\t
***End_of_Header***\t\t\t
X_Value\tWeg\tKraft\tComment
"""


@pytest.mark.parametrize(
    ("mark", "place", "push", "scales"),
    [
        (",", "mm", "kN", (1e3, 1e-3)),
        (".", "Meters", "Newton", (1.0, 1.0)),
        (".", "", "in N", (1.0, 1.0)),
        (".", "mm", "", (1e3, 1.0)),
    ],
)
def test_labels_of_labview_are_the_units_of_its_columns(tmp_path, mark, place, push, scales):
    columns = [T, scales[0] * X, scales[1] * F]
    body = rows(columns, "\t", lambda v: f"{v:.9f}".replace(".", mark))
    file = tmp_path / "lauf.lvm"
    file.write_text(HEAD.format(mark=mark, n=len(T), place=place, push=push) + body)
    guess = guess_data(file)
    assert guess.columns == {"time": "X_Value", "position": "Weg", "force": "Kraft"}
    assert not any("X_Value" in doubt for doubt in guess.doubts)
    (tmp_path / "lauf.toml").write_text(guessed_rig(guess, "lauf.lvm"), encoding="utf-8")
    record = load_rig(tmp_path / "lauf.toml").measurement
    np.testing.assert_allclose(record.time - record.time[0], T, atol=1e-9)
    # half of the last digit that is printed, in the unit of the file
    np.testing.assert_allclose(record.position, X, atol=6e-10)
    np.testing.assert_allclose(record.force, F, atol=6e-7)


def test_a_wanted_position_is_a_reference_and_other_columns_are_left_alone(tmp_path):
    file = tmp_path / "messung.csv"
    file.write_bytes(FILES["other columns"][0].encode("cp1252"))
    guess = guess_data(file)
    assert guess.columns == {
        "time": "Zeit", "position": "Weg", "force": "Kraft", "reference": "Sollweg",
    }  # fmt: skip
    assert guess.layout == Layout(encoding="cp1252", separator=";", decimal=",", units_row=True)


TURNING = {
    "torque": ("Winkel;Drehzahl;Moment", "°;1/min;Ncm", {"force": "Moment"}),
    "both": ("Winkel;Drehzahl;Drehmoment;Strom", "deg;U/min;Ncm;A", {"force": "Drehmoment"}),
    "current": ("Motorwinkel;Istdrehzahl;Motorstrom", "Grad;min^-1;mA", {"current": "Motorstrom"}),
}


@pytest.mark.parametrize(("names", "units", "driven"), TURNING.values(), ids=TURNING)
def test_an_axis_that_turns_is_known_by_its_units(tmp_path, names, units, driven):
    angle, speed, torque = np.degrees(X), 60 / (2 * np.pi) * 6 * np.cos(2 * T), 100 * F
    columns = [T, angle, speed, torque, torque][: 2 + names.count(";")]
    file = tmp_path / "achse.csv"
    text = f"Zeit;{names}\ns;{units}\n{rows(columns, write=lambda v: german(v, 6))}"
    file.write_text(text, encoding="cp1252")
    guess = guess_data(file)
    assert guess.turning
    assert driven.items() <= guess.columns.items()
    known = guessed_rig(guess, "achse.csv").replace("? N m/A", "1 N m/A")
    (tmp_path / "achse.toml").write_text(known, encoding="utf-8")
    record = load_rig(tmp_path / "achse.toml").measurement
    assert record.turning
    np.testing.assert_allclose(record.position, X, atol=1e-8)
    np.testing.assert_allclose(record.velocity, 6 * np.cos(2 * T), atol=1e-6)
    scale = 0.1 if "current" in driven else 1.0  # 1 N m/A of mA, cN m
    np.testing.assert_allclose(record.force, scale * F, atol=1e-7)
    assert any("motor constant" in doubt for doubt in guess.doubts) == ("current" in driven)


@pytest.mark.parametrize("axis", "xyz")
def test_of_the_axes_of_a_sensor_that_which_moves_most_is_read(tmp_path, axis):
    rate = np.gradient(X, T)
    columns = [rate if name == axis else 0.01 * np.cos(9.0 * T) for name in "xyz"]
    names = ",".join(f"Gyroscope {name} (rad/s)" for name in "xyz")
    path = tmp_path / "swing.csv"
    path.write_text(f"Time (s),{names}\n{rows((T, *columns), ',', points)}", "utf-8")
    guess = guess_data(path)
    assert guess.columns["velocity"] == f"Gyroscope {axis} (rad/s)"
    assert any("which moves most" in doubt for doubt in guess.doubts)


def test_friction_at_velocities_without_times_is_a_force_map(tmp_path):
    file = tmp_path / "map.csv"
    speed = np.linspace(-1, 1, 50)
    file.write_text("Geschwindigkeit;Reibkraft\nmm/s;N\n" + rows((1e3 * speed, 3 * speed)))
    guess = guess_data(file)
    assert guess.columns == {"velocity": "Geschwindigkeit", "friction": "Reibkraft"}
    text = guessed_rig(guess, "map.csv")
    (tmp_path / "map.toml").write_text(text)
    rig = load_rig(tmp_path / "map.toml")
    assert rig.measurement.kind == "friction-map"
    assert (rig.vary, type(rig.mechanism)) == ((), Axis)


def test_gaps_and_disorder_are_found_and_repaired(tmp_path):
    lines = BODY.splitlines()
    lines[10], lines[11] = lines[11], lines[10]
    lines[20] = "0,2000;;1,0"
    file = tmp_path / "messung.csv"
    file.write_text("Zeit;Weg;Kraft\ns;mm;N\n" + "\n".join(lines) + "\n")
    guess = guess_data(file)
    assert guess.repair == ("gaps", "sort")
    record = load_measurement(
        file, columns=guess.columns, units=guess.units, layout=guess.layout, repair=guess.repair
    )
    assert record.time.size == N - 1


def test_a_record_whose_last_row_stands_first_is_sorted_and_doubted(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text(
        "time [s],position [m],force [N]\n" + rows((T[::-1], X[::-1], F[::-1]), ",", points)
    )
    guess = guess_data(file)
    assert guess.repair == ("sort",)
    assert any("counts down" in doubt for doubt in guess.doubts)
    np.testing.assert_allclose(read_data([file], guess.reading).position, X, atol=1e-4)


def test_records_below_each_other_are_not_mixed(tmp_path):
    file = tmp_path / "a.csv"
    both = rows((T, X, F), ",", points) + rows((T, 1.1 * X, F), ",", points)
    file.write_text("time [s],position [m],force [N]\n" + both)
    said = rf"times begin again at line {N + 2}: it seems to hold 2 records below each other"
    with pytest.raises(InputError, match=said):
        guess_data(file)
    marked = [f"{line},{k // N}" for k, line in enumerate(both.splitlines())]
    file.write_text("time [s],position [m],force [N],trial\n" + "\n".join(marked))
    assert guess_data(file).columns.keys() == {"time", "position", "force"}


def test_counts_ask_for_a_resolution(tmp_path):
    file = tmp_path / "a.csv"
    counts = rows((T, np.round(1e6 * X), F), write=lambda v: german(v, 2))
    file.write_text(f"Zeit;Position;Kraft\ns;Inkremente;N\n{counts}")
    guess = guess_data(file)
    assert any("counts per unit" in doubt for doubt in guess.doubts)
    text = guessed_rig(guess, "a.csv").replace("0.001 mm/count", "1000 counts/mm")
    (tmp_path / "a.toml").write_text(text)
    np.testing.assert_allclose(load_rig(tmp_path / "a.toml").measurement.position, X, atol=1e-6)


@pytest.mark.parametrize(("mark", "word"), [(" ", "blanks"), ("\t", "tabs"), ("|", "bars")])
@pytest.mark.parametrize("above", ["", "# rig 3\n", "Rig 3\nMotor A\n"])
def test_rows_without_names_are_told_apart_from_a_single_column(tmp_path, mark, word, above):
    file = tmp_path / "log.txt"
    file.write_text(above + rows((T, X, F, F), mark, lambda value: f"{value:8.3f}"))
    with pytest.raises(InputError, match=f"names of the 4 columns, separated by {word}") as caught:
        guess_data(file)
    first = "line 3, and no line above" if above.startswith("Rig") else "holds numbers, not names"
    assert first in str(caught.value)
    assert "stickslip init" not in str(caught.value)  # which says this


TURNED = (0.3 * np.sin(2.0 * T), 0.6 * np.cos(2.0 * T), np.sign(np.cos(2.0 * T)))


@pytest.mark.parametrize(
    ("names", "factors", "found"),
    [
        (("t", "armAng", "armAngVel"), (1e3, 1.0, 1.0), {"time": "ms"}),
        (("t", "armAng", "armAngVel"), (1e6, 1.0, 1.0), {"time": "us"}),
        (("t", "theta", "dtheta"), (1.0, 180.0 / np.pi, 1.0), {"position": "deg"}),
        (("t", "ang", "n"), (1.0, 1.0, 30.0 / np.pi), {"velocity": "rpm"}),
        (
            *(("t", "theta", "theta_dot"), (1e3, 180.0 / np.pi, 1.0)),
            {"time": "ms", "position": "deg"},
        ),
        (("t", "x", "xdot"), (1.0, 1e3, 1.0), {"position": "mm"}),
        (("t", "theta", "omega"), (1.0, 1.0, 1.0), {}),
        # m beside mm/s, or a tenth of a second in ms: nobody knows
        (("t", "x", "xdot"), (1.0, 1.0, 1e3), {}),
    ],
)
def test_units_are_those_in_which_the_velocity_is_the_derivative(tmp_path, names, factors, found):
    file = tmp_path / "a.csv"
    columns = [f * c for f, c in zip(factors, (T, *TURNED[:2]), strict=True)]
    body = rows((*columns, TURNED[2]), ",", lambda value: f"{value:.6f}")
    file.write_text(f"{','.join(names)},u\n{body}")
    guess = guess_data(file)
    assert guess.columns == dict(zip(("time", "position", "velocity"), names, strict=True))
    assert guess.units == found
    assert guess.turning is (names[1] != "x")
    assert "'u' may drive the axis" in guess.doubts[-1]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"separator": ":"}, "layout.separator must be one of"),
        ({"decimal": ";"}, "layout.decimal must be one of"),
        ({"thousands": ".", "decimal": "."}, "layout.thousands must be one character other"),
        ({"preface": -1}, "layout.preface must be a number of lines"),
        ({"encoding": "klingon"}, "layout.encoding must be a code page"),
    ],
)
def test_a_wrong_layout_says_what_it_may_be(changes, message):
    with pytest.raises(InputError, match=message):
        Layout(**changes)


def test_a_column_that_is_named_but_not_there_is_refused_with_the_names_there_are(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("t (s),a (mm),a (um),F (N)\n" + rows((T, X, X, F), ",", points))
    with pytest.raises(InputError, match=r"unknown column .*'a'.*a \(mm\), a \(um\)"):
        guess_data(file, columns={"position": "a"})  # which of two is not known


INSTRUMENT_UNITS = {
    "x [mm (Position)]": 1e-3, "x (um)": 1e-6, "x (Millimeters)": 1e-3, "dx (mm/sec)": 1e-3,
    "omega (1/min)": np.pi / 30, "n [rpm]": np.pi / 30, "torque (N-m)": 1.0, "torque (mN.m)": 1e-3,
    "F (Newtons)": 1.0,
}  # fmt: skip


@pytest.mark.parametrize(("header", "scale"), INSTRUMENT_UNITS.items())
def test_units_are_read_as_instruments_write_them(tmp_path, header, scale):
    quantity = {"x": "position", "t": "force", "F": "force"}.get(header[0], "velocity")
    file = tmp_path / "a.csv"
    other = "phi (rad)" if header[0] in "ont" else "pos (m)" * (quantity != "position") or "F (N)"
    file.write_text(f"Time (Seconds),{header},{other}\n" + rows((T, X, F), ",", points))
    name = header.partition(" [")[0]
    guess = guess_data(file, columns={quantity: name})
    record = read_data([file], guess.reading)
    assert record.values(quantity) == pytest.approx(scale * X, abs=1e-4 * scale)
    assert record.time == pytest.approx(T)


def test_the_rig_file_of_any_names_is_valid(tmp_path):
    name = 'Weg "links" \\ [mm]'
    file = tmp_path / "a b.csv"
    file.write_text(f"Zeit [s]\t{name}\tKraft [N]\n".replace('"', "'") + rows(MM, "\t"))
    guess = guess_data(file)
    (tmp_path / "a.toml").write_text(guessed_rig(guess, "a b.csv"))
    np.testing.assert_allclose(load_rig(tmp_path / "a.toml").measurement.position, X, atol=6e-7)


@pytest.mark.parametrize(
    "cell",
    ["1" * LONG, "(" * LONG, " " * LONG + "x", "a" + " " * LONG + "(m", "1 " * LONG],
    ids=["digits", "brackets", "blanks", "nearly a unit", "words"],
)
def test_a_very_long_cell_ends_in_a_message_or_a_table(tmp_path, cell):
    file = tmp_path / "data.csv"
    file.write_text(f"time,position\n{cell},1\n2,3\n")
    for read in (guess_data, load_measurement):
        with contextlib.suppress(StickslipError):
            read(file)


TURNS = (0.5 * np.sin(2.0 * T), np.cos(2.0 * T), F)  # [rad], [rad/s], [N m]
EPOCH = 1_709_293_800
SCOPE_HEAD = """Name{0}Scope Project{0}
File{0}D:\\scope\\axis.csv{0}
Starttime of export{0}133238090039920000{0}Montag, 20. März 2023{0}19:03:23.992
Endtime of export{0}133238090060450000{0}Montag, 20. März 2023{0}19:03:26.045

Name{0}Axis.ActPos{0}Name{0}Axis.ActForce
SymbolComment{0}{0}SymbolComment{0}
Data-Type{0}REAL64{0}Data-Type{0}REAL64
SampleTime[ms]{0}10{0}SampleTime[ms]{0}10
Unit{0}(mm){0}Unit{0}(N)

"""


def scope(separator, clock, write):
    """Return an export of TwinCAT Scope, with a column of times or samples for each channel."""
    columns = [clock, 1e3 * X, clock, F]
    return SCOPE_HEAD.format(separator) + rows(columns, separator, write)


LOGGERS = {
    "TwinCAT Scope, times": scope("\t", 10.0 * np.arange(N), german),
    "TwinCAT Scope, samples": scope(";", np.arange(N), lambda value: f"{value:.4f}"),
    "TwinCAT Scope, commas": scope(",", 10.0 * np.arange(N), points),
    "ROS bag": "header.seq,header.stamp.secs,header.stamp.nsecs,name,position,effort\n"
    + "".join(
        f"{i},{EPOCH + i // 100},{i % 100 * 10_000_000},slide,{x:.7f},{f:.4f}\n"
        for i, (x, f) in enumerate(zip(X, F, strict=True))
    ),
    "ROS 2 bag": "header_stamp_sec,header_stamp_nanosec,position,effort\n"
    + "".join(
        f"{EPOCH + i // 100},{i % 100 * 10_000_000},{x:.7f},{f:.4f}\n"
        for i, (x, f) in enumerate(zip(X, F, strict=True))
    ),
    **{
        f"epoch in {part}": "timestamp;x;force\n"
        + "".join(
            f"{(100 * EPOCH + i) * 10**power};{x:.7f};{f:.4f}\n"
            for i, (x, f) in enumerate(zip(X, F, strict=True))
        )
        for part, power in (("ms", 1), ("us", 4), ("ns", 7))
    },
}


@pytest.mark.parametrize("text", LOGGERS.values(), ids=LOGGERS)
def test_what_loggers_write_is_read_as_it_was_meant(tmp_path, text):
    file = tmp_path / "log.csv"
    file.write_text(text, encoding="utf-8")
    guess = guess_data(file)
    record = load_measurement(
        file, columns=guess.columns, units=guess.units, layout=guess.layout, repair=guess.repair
    )
    assert not guess.repair
    # floats of nanoseconds since 1970 are 2.6e-7 s apart; else half of the last digit is printed
    np.testing.assert_allclose(record.time - record.time[0], T, atol=5e-7)
    np.testing.assert_allclose(record.position, X, atol=6e-8)
    np.testing.assert_allclose(record.force, F, atol=6e-5)
    (tmp_path / "log.toml").write_text(guessed_rig(guess, "log.csv"), encoding="utf-8")
    np.testing.assert_array_equal(load_rig(tmp_path / "log.toml").measurement.time, record.time)


def test_unsigned_seconds_of_a_stamp_may_go_back(tmp_path):
    seconds = np.array([EPOCH + 1, EPOCH, EPOCH + 2], dtype=np.uint32)
    nanoseconds = np.array([0, 500_000_000, 0], dtype=np.uint32)
    record = load_measurement(
        {"stamp.secs": seconds, "stamp.nsecs": nanoseconds, "position": X[:3], "force": F[:3]},
        columns={"time": "stamp"},
        repair="sort",
    )
    np.testing.assert_array_equal(record.time - record.time[0], [0.0, 0.5, 1.5])


def test_channels_with_other_times_are_merged(tmp_path):
    file = tmp_path / "scope.csv"
    lines = scope(";", 10.0 * np.arange(N), points).splitlines()
    for i in range(len(lines) - N // 2, len(lines)):  # a channel of half the rate ends early
        lines[i] = ";".join([*lines[i].split(";")[:2], "", ""])
    for i in range(N // 2):
        row = len(lines) - N + i
        lines[row] = ";".join([*lines[row].split(";")[:2], f"{20 * i}", f"{F[2 * i]:.4f}"])
    file.write_text("\n".join(lines), encoding="utf-8")
    guess = guess_data(file)
    assert guess.repair == ("gaps",)
    record = load_measurement(file, columns=guess.columns, repair=guess.repair)
    np.testing.assert_allclose(record.time, T[::2], atol=1e-12)
    np.testing.assert_allclose(record.force, F[::2], atol=6e-5)


def test_columns_that_are_named_by_their_unit_are_known(tmp_path):
    file = tmp_path / "drive.csv"
    text = "t;counts;rpm;I [A]\n"
    angle, rate, torque = TURNS
    text += rows((T, angle * 4096 / (2.0 * np.pi), rate * 30.0 / np.pi, torque), write=points)
    file.write_text(text, encoding="utf-8")
    guess = guess_data(file)
    assert dict(guess.columns) == {
        "time": "t",
        "position": "counts",
        "velocity": "rpm",
        "current": "I",
    }
    record = load_measurement(
        file,
        columns=guess.columns,
        units=guess.units,
        gain={"position": "4096 counts/rev"},
        motor_constant="1 N m/A",
    )
    np.testing.assert_allclose(record.position, angle, atol=1e-6)
    np.testing.assert_allclose(record.velocity, rate, atol=1e-5)


def test_cells_that_are_not_finite_are_gaps(tmp_path):
    file = tmp_path / "log.csv"
    body = [f"{t:.2f},{x:.6f},{f:.4f}" for t, x, f in zip(T, X, F, strict=True)]
    body[7] = "0.07,inf,1.0"
    file.write_text("time,position,force\n" + "\n".join(body), encoding="utf-8")
    guess = guess_data(file)
    assert guess.repair == ("gaps",)
    record = load_measurement(file, columns=guess.columns, repair=guess.repair)
    assert record.time.size == N - 1


def table(path, **columns):
    """Write columns by their headers, X for a motion, F for a force and numbers for the rest."""
    known = {"t": T, "x": X, "F": F, "n": 50.0 + 0.01 * np.arange(N), "c": X + 1e-3}
    cells = [known[kind] for kind in columns.values()]
    heads = [name.replace("__", " [") + "]" * ("__" in name) for name in columns]
    path.write_text(f"{';'.join(heads)}\n" + rows(cells, ";", points))
    return path


def test_a_channel_in_volts_asks_for_the_sensitivity_of_its_sensor(tmp_path):
    file = table(tmp_path / "daq.csv", **{"time__s": "t", "Kraft__V": "F", "Weg__V": "x"})
    guess = guess_data(file)
    assert guess.gain == {"position": "1 mm/V", "force": "1 N/V"}
    assert (
        sum(
            "give the sensitivity of the sensor as its gain" in sentence
            for sentence in guess.doubts
        )
        == 2
    )
    known = guess_data(file, gain={"position": "5 mm/V", "force": "200 N/V"})
    assert not any("sensitivity" in doubt for doubt in known.doubts)
    record = load_measurement(file, columns=known.columns, gain=known.gain)
    assert record.position == pytest.approx(5e-3 * X, abs=1e-6)
    assert record.force == pytest.approx(200.0 * F, abs=0.1)


def test_only_assumed_gains_are_marked_as_assumed(tmp_path):
    file = table(tmp_path / "daq.csv", **{"time__s": "t", "Kraft__V": "F", "Weg__V": "x"})
    known: dict[str, str] = {}
    marks = []
    for name, gain in (("", ""), ("position", "5 mm/V"), ("force", "200 N/V")):
        known |= {name: gain} if name else {}
        text = guessed_rig(guess_data(file, gain=known), file.name)
        (line,) = [one for one in text.splitlines() if one.startswith("gain = ")]
        marks.append(line.partition("  # ")[2].partition(":")[0])
    assert marks == ["assumed", "force assumed", ""]
    pressed = {"time__s": "t", "x__mm": "x", "Fx__N": "F", "Fz__N": "n"}
    file = table(tmp_path / "pressed.csv", **pressed)
    file.write_text(re.sub(r";(\d[^;]*)$", r";-\1", file.read_text(), flags=re.M))
    text = guessed_rig(guess_data(file), file.name)
    assert "gain = { load = -1" in text
    assert "replace it by the sensitivity" not in text


@pytest.mark.parametrize("names", [("q{}", "qd{}", "tau{}"), ("position[{}]", "effort[{}]")])
@pytest.mark.parametrize("own", [None, 2])
def test_a_joint_goes_with_its_own_torque(tmp_path, names, own):
    order = [name.format(joint) for name in names for joint in (1, 2)][::-1]
    kinds = {name: "F" if name[0] in "te" else "x" for name in order}
    file = table(tmp_path / "arm.csv", time="t", **kinds)
    joint = own or 2  # the first in the file
    given = {} if own is None else {"position": names[0].format(own)}
    guess = guess_data(file, columns=given)
    assert guess.columns["position"] == names[0].format(joint)
    assert guess.columns["force"] == names[-1].format(joint)
    assert any("The file has 2 joints" in doubt for doubt in guess.doubts)


def test_columns_that_the_reader_knows_by_their_quantity_are_called_as_in_the_file(tmp_path):
    names = {"t__ms": "t", "position__rad": "x", "torque__N m": "n"}
    file = table(tmp_path / "log.csv", **names)
    found = guess_data(file)
    assert found.columns == {"time": "t", "position": "position", "force": "torque"}
    read = load_measurement(file, columns=found.columns, units=found.units, layout=found.layout)
    assert read.turning
    np.testing.assert_allclose(read.time, 1e-3 * T)


def test_a_column_without_any_cell_is_none_of_the_quantities(tmp_path):
    file = tmp_path / "log.csv"
    body = "".join(f"{t:.2f};;{x:.4f};{f:.4f}\n" for t, x, f in zip(T, X, F, strict=True))
    file.write_text(f"time;velocity;position;force\n{body}")
    found = guess_data(file)
    assert "velocity" not in found.columns
    assert not found.repair
    read = read_data([file], found.reading)
    assert read.quantities() == ("position", "force")
    assert "velocity" in read.unused


def test_a_mark_that_may_be_either_is_doubted(tmp_path):
    file = tmp_path / "log.csv"
    body = "".join(f"{t:.2f};{german(5.0 + x, 3)};1.5\n" for t, x in zip(T, X, strict=True))
    file.write_text(f"time;position;force\n{body}")
    assert guess_data(file).doubts[0].startswith("5,000 is read as 5000")
    body = "".join(f"{t:.2f};{5e3 + x:,.3f};1.5\n" for t, x in zip(T, X, strict=True))
    file.write_text(f"time;position;force\n{body}")
    assert "is read as" not in guess_data(file).doubts[0]


def test_trials_and_temperatures_are_offered_and_a_temperature_is_the_mean_of_its_trial(tmp_path):
    count = N // 3
    heat = np.repeat([20.0, 30.0, 40.0], count) + np.tile(np.linspace(-4.0, 4.0, count), 3)
    cells = [np.repeat([1.0, 2.0, 3.0], count), np.tile(T[:count], 3), X, F, heat]
    file = tmp_path / "runs.csv"
    head = "Versuch;Zeit [s];Weg [m];Kraft [N];Temperatur [°C]\n"
    file.write_text(head + rows(cells, ";", points), encoding="utf-8")
    guess = guess_data(file)
    assert guess.columns["trial"] == "Versuch"
    assert guess.conditions == ("Temperatur",)
    assert guess.columns["temperature"] == "Temperatur"
    assert guess.repair == ()
    rig = tmp_path / "rig.toml"
    rig.write_text(guessed_rig(guess, "runs.csv"), encoding="utf-8")
    trials = load_rig(rig).measurement.trials
    means = [trial.conditions["temperature [°C]"] for trial in trials]
    assert means == pytest.approx([20.0, 30.0, 40.0])
    assert np.ptp(trials[0].contact_inputs()["temperature"]) == pytest.approx(8.0)


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("Temperatur [°C]", None),
        ("Temperatur [C]", "degC"),
        ("Öltemperatur_C", "degC"),
        ("T_oil [degC]", None),  # by its unit alone
        ("theta °C", "°C"),
    ],
)
def test_a_temperature_that_changes_within_the_record_is_an_input_of_the_contact(
    tmp_path, header, unit
):
    heat = np.linspace(20.0, 35.0, N)
    file = tmp_path / "warm.csv"
    text = f"Zeit [s];Weg [m];Kraft [N];{header}\n" + rows([T, X, F, heat], ";", points)
    file.write_text(text, encoding="utf-8")
    guess = guess_data(file)
    assert guess.conditions == ()
    assert header.startswith(guess.columns["temperature"])
    assert guess.units.get("temperature") == unit
    rig = tmp_path / "rig.toml"
    rig.write_text(guessed_rig(guess, "warm.csv"), encoding="utf-8")
    found = load_rig(rig).measurement.contact_inputs()["temperature"]
    assert found == pytest.approx(heat, abs=1e-4)  # as the file has it


def test_a_temperature_that_is_constant_or_has_holes_is_a_condition(tmp_path):
    for name, heat in {
        "constant": np.full(N, 20.0),
        "holes": np.where(np.arange(N) % 10, np.nan, 20.0 + T),
    }.items():
        file = tmp_path / f"{name}.csv"
        body = rows([T, X, F, heat], ";", points).replace("nan", "")
        file.write_text(f"Zeit [s];Weg [m];Kraft [N];Temperatur [°C]\n{body}", encoding="utf-8")
        guess = guess_data(file)
        assert guess.conditions == ("Temperatur",), name
        assert "temperature" not in guess.columns, name


def test_a_humidity_that_changes_is_left_out_as_no_condition_of_a_trial(tmp_path):
    file = tmp_path / "damp.csv"
    body = rows([T, X, F, np.linspace(30.0, 60.0, N)], ";", points)
    file.write_text(f"Zeit [s];Weg [m];Kraft [N];Luftfeuchte [%]\n{body}", encoding="utf-8")
    guess = guess_data(file)
    assert guess.conditions == ()
    assert load_measurement(file, columns=guess.columns, layout=guess.layout).time.size == N


def test_a_long_file_without_a_record_is_refused_by_its_top(tmp_path, monkeypatch):
    file = tmp_path / "long.csv"
    line = "0.001;1.5;2.5\n"
    file.write_text("a;b;c\n" + line * (guessing.LARGEST_TEXT // len(line) + 1))
    seen = []
    monkeypatch.setattr(
        guessing, "read_frame", lambda path, **how: seen.append(path) or frame(path, **how)
    )
    with pytest.raises(InputError, match=r"long\.csv: no column seems to hold"):
        guess_data(file)
    assert len(seen) == 1
    assert seen[0] != file


@pytest.mark.parametrize(
    ("header", "quantity", "unit"),
    [
        ("pressure (bar)", "pressure", "bar"),
        ("Öldruck [MPa]", "pressure", "MPa"),
        ("transmitted (N)", "transmitted", "N"),
        ("gravity force (N)", "gravity", "N"),
        ("external force (kN)", "external", "kN"),
        ("motor force (N)", "motor", "N"),
    ],
)
def test_what_friction_may_depend_on_is_named_and_kept(tmp_path, header, quantity, unit):
    file, beside = tmp_path / "a.csv", 1.0 + np.abs(np.sin(T))
    cells = rows((T, X, F, F, beside), ",", points)
    file.write_text(f"time (s),position (m),force (N),friction force (N),{header}\n" + cells)
    guess = guess_data(file, columns={"force": "force (N)"})
    assert guess.reasons[quantity] == f"column {guess.columns[quantity]!r} in {unit}, by its name"
    record = read_data([file], guess.reading)
    size = {"bar": 1e5, "MPa": 1e6, "kN": 1e3, "N": 1.0}[unit]
    np.testing.assert_allclose(record.inputs[quantity], size * beside, atol=1e-4 * size)


@pytest.mark.parametrize("names", [["slow up", "slow down", "fast", "last"], ["4", "7", "9", "1"]])
def test_a_column_that_changes_where_times_begin_again_names_the_trials(tmp_path, names):
    lengths = (400, 500, 150, 150)
    when = np.concatenate([T[:n] for n in lengths])
    labels = np.repeat(names, lengths)
    lines = rows((when, X, F), ",", points).splitlines()
    table = "\n".join(f"{line},{label}" for line, label in zip(lines, labels, strict=True))
    file = tmp_path / "a.csv"
    file.write_text(f"time (s),position (m),force (N),what\n{table}\n")
    guess = guess_data(file)
    assert guess.columns["trial"] == "what"
    assert guess.reasons["trial"] == "column 'what', which changes where times begin again"
    assert len(read_data([file], guess.reading).trials) == 4
    file.write_text("time (s),position (m),force (N)\n" + "\n".join(lines) + "\n")
    with pytest.raises(InputError, match="it seems to hold 4 records below each other"):
        guess_data(file)


def test_a_motor_constant_that_is_given_is_not_doubted(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("time (s),angle,current (A),torque (N m)\n" + rows((T, X, F, F), ",", points))
    guess = guess_data(file, motor_constant="0.12 N m/A")
    assert "force" not in guess.columns
    assert guess.turning
    assert not any("motor constant" in doubt for doubt in guess.doubts)
    text = guessed_rig(guess, file)
    assert 'motor_constant = "0.12 N m/A"' in text
    assert "same factor" not in text
    record = read_data([file], guess.reading)
    np.testing.assert_allclose(record.force, 0.12 * F, atol=1e-4)
    file.write_text("time (s),angle,torque (N m)\n" + ENGLISH)
    with pytest.raises(InputError, match="belongs to a current, and no column seems to hold one"):
        guess_data(file, motor_constant="0.12 N m/A")


def test_a_motor_constant_that_is_not_in_the_file_is_left_open(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("time (s),position (m),current (A)\n" + ENGLISH)
    guess = guess_data(file)
    assert guess.reasons["motor constant"] == "not in the file"
    text = guessed_rig(guess, file, inertia=3.0)
    assert 'motor_constant = "? N/A"' in text
    assert "multiply it by the constant below" in text
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(ParameterError, match=r"data.motor_constant = '\? N/A'"):
        load_rig(tmp_path / "a.toml")
    stated = guessed_rig(guess_data(file, motor_constant="1 N/A"), file)
    assert 'motor_constant = "1 N/A"' in stated


@pytest.mark.parametrize(("head", "none"), [("Step Time (s)", {}), ("time [s]", {"time": ""})])
def test_steady_readings_with_times_are_a_table_over_the_speed(tmp_path, head, none):
    file = tmp_path / "a.csv"
    speeds = np.random.default_rng(0).permutation(np.linspace(0.2, 5.0, 40))
    table = rows((6.0 * np.arange(40), speeds, 80.0 + speeds), ",", points)
    file.write_text(f"{head},velocity (mm/s),friction (N)\n{table}")
    guess = guess_data(file)
    assert guess.columns == {"velocity": "velocity (mm/s)", "friction": "friction (N)", **none}
    assert any("steady readings of friction" in doubt for doubt in guess.doubts)
    rig = tmp_path / "rig.toml"
    rig.write_text(guessed_rig(guess, "a.csv"))
    measured = load_rig(rig).measurement
    assert measured.kind == "friction-map"
    np.testing.assert_allclose(measured.velocity, 1e-3 * speeds, atol=1e-7)
    column = head.partition(" [")[0]
    given = guess_data(file, columns={"time": column}, units={"time": "s"})
    assert read_data([file], given.reading).kind == "series"


def test_the_inertia_of_a_body_that_slows_down_is_left_open(tmp_path):
    file, t = tmp_path / "a.csv", np.linspace(0.0, 5.0, 200)
    speed = np.maximum(20.0 - 4.0 * t, 0.0)
    file.write_text("time_s,omega_rad_s\n" + rows((t, speed), ",", points))
    text = guessed_rig(guess_data(file), "a.csv")
    assert 'inertia = "? kg m^2"' in text
    assert "friction is in proportion to it" in text


@pytest.mark.parametrize(
    ("header", "scale", "geared"),
    [
        ("scale position (mm)", 1.0, False),
        ("load position (um)", 1e3, False),
        ("Weg Spindel (mm)", 5.0, True),
    ],
)
def test_two_positions_of_one_axis_are_both_named_with_their_lost_motion(
    tmp_path, header, scale, geared
):
    file = tmp_path / "a.csv"
    other = scale * (X - 0.06 * np.sign(np.cos(2.0 * T)))
    table = rows((T, X, other, F), ",", points)
    file.write_text(f"time (s),motor position (mm),{header},force (N)\n{table}")
    guess = guess_data(file)
    assert guess.columns["position"] == "motor position (mm)"
    (said,) = [doubt for doubt in guess.doubts if "positions of this axis" in doubt]
    assert f"{header!r}" in said
    assert ("times as far" in said) == geared
    assert "They differ by up to 0.12" in said  # a ratio is found with some of it in it


def test_no_mass_is_fitted_where_friction_was_measured(tmp_path):
    file = tmp_path / "a.csv"
    table = rows((T, X, F, np.sign(np.cos(2.0 * T))), ",", points)
    file.write_text(f"time (s),position (m),force (N),friction (N)\n{table}")
    text = guessed_rig(guess_data(file), file)
    assert "vary" not in text
    (tmp_path / "rig.toml").write_text(text)
    assert load_rig(tmp_path / "rig.toml").vary == ()


@pytest.mark.parametrize("name", ["specimen", "Prüfling Nr.", "sample_id", "Day", "run_no"])
def test_specimens_of_a_table_are_trials_wherever_their_rows_are(tmp_path, name):
    order = np.random.default_rng(3).permutation(60)
    which, speeds = np.repeat([1.0, 2.0, 7.0], 20)[order], np.tile(np.linspace(1, 40, 20), 3)[order]
    table = rows((which, speeds, 4.0 + 0.1 * speeds + which), ",", points)
    file = tmp_path / "a.csv"
    file.write_text(f"{name},velocity (mm/s),friction (N)\n{table}")
    guess = guess_data(file)
    assert guess.columns["trial"] == name
    assert [len(trial.friction) for trial in read_data([file], guess.reading).trials] == [20] * 3


def test_a_counter_of_samples_that_begins_again_names_no_trials(tmp_path):
    counter = np.arange(T.size) % 32
    file = tmp_path / "a.csv"
    table = rows((T, X, F, counter), ",", points)
    file.write_text(f"time (s),position (m),force (N),sample\n{table}")
    assert "trial" not in guess_data(file).columns


def test_steady_readings_keep_their_trials(tmp_path):
    file = tmp_path / "a.csv"
    speeds = np.tile(np.random.default_rng(0).permutation(np.linspace(0.2, 5.0, 25)), 2)
    step = np.repeat([3.0, 8.0], 25)
    table = rows((step, np.tile(6.0 * np.arange(25), 2), speeds, step + speeds), ",", points)
    file.write_text(f"stage,time (s),velocity (mm/s),friction (N)\n{table}")
    measured = read_data([file], guess_data(file).reading)
    assert [trial.kind for trial in measured.trials] == ["friction-map"] * 2


@pytest.mark.parametrize("name", ["A1", "T1", "S1", "V1", "F1", "m1", "Pa", "ch2"])
@pytest.mark.parametrize("quantity", ["position", "velocity", "force"])
def test_a_column_that_is_named_is_in_no_unit_of_its_name(tmp_path, name, quantity):
    path = table(tmp_path / "a.csv", **{"t (s)": "t", "v (m/s)": "x", "x (m)": "x", name: "F"})
    guess = guess_data(path, columns={quantity: name, "time": "t (s)"})
    assert read_data([path], guess.reading).time.size == N
    assert quantity not in guess.units


def test_a_unit_of_another_kind_is_refused_with_its_column(tmp_path):
    path = table(tmp_path / "a.csv", **{"t (kg)": "t", "x (m)": "x", "F (N)": "F"})
    with pytest.raises(
        InputError, match=r"a\.csv: the column 't \(kg\)' is in kg, .*--unit time=s"
    ):
        guess_data(path, columns={"time": "t (kg)"})


@pytest.mark.parametrize("heads", [("x (mm)", "y (mm)"), ("x [mm]", "y [mm]")])
def test_a_pair_of_coordinates_has_the_unit_of_its_headers_and_is_named(tmp_path, heads):
    path = table(tmp_path / "a.csv", **{"t (s)": "t", heads[0]: "x", heads[1]: "F"})
    columns = {"time": "t (s)", "position": heads}
    assert load_measurement(path, columns=columns).position.size == N
    said = guess_data(path, columns=columns).reasons["position"]
    assert all(f"'{head[0]}" in said for head in heads)
    assert "in mm" in said


def test_a_unit_that_is_given_says_whether_the_axis_turns(tmp_path):
    path = table(tmp_path / "a.csv", t="t", x="x", current="F")
    guess = guess_data(path, units={"position": "deg"})
    assert guess.turning
    assert guess.motor_constant == "1 N m/A"
    assert read_data([path], guess.reading).position[1] == pytest.approx(np.radians(X[1]), abs=1e-5)


@pytest.mark.parametrize(
    ("driving", "options", "scale"),
    [
        ("torque (N m)", {}, 1.0),
        ("current (A)", {"motor_constant": "0.12 N m/A"}, 0.12),
        ("current", {}, 1.0),
    ],
)
@pytest.mark.parametrize("timed", [True, False])
def test_steady_readings_of_what_drives_are_readings_of_friction(
    tmp_path, driving, options, scale, timed
):
    path = tmp_path / "a.csv"
    v = np.random.default_rng(1).uniform(-3.0, 3.0, 50)
    f = 0.5 * np.sign(v) + 0.1 * v
    if timed:
        head, columns = f"time (s),velocity (rad/s),{driving}", (5.0 * np.arange(50), v, f)
    else:
        head, columns = f"velocity (rad/s),{driving}", (v, f)
    path.write_text(f"{head}\n" + rows(columns, ",", points))
    guess = guess_data(path, **options)
    assert set(guess.columns) == {"velocity", "friction"}
    assert guess.turning
    assert read_data([path], guess.reading).friction == pytest.approx(scale * f, abs=1e-3)
    left = any("question mark for the motor constant" in doubt for doubt in guess.doubts)
    assert left == (driving == "current")
    assert ('gain = { friction = "? N m/A" }' in guessed_rig(guess, path)) == left


def test_samples_of_a_motion_without_times_are_no_steady_readings(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("velocity (rad/s),current (A)\n" + rows((X, F), ",", points))
    with pytest.raises(InputError, match="no column seems to hold times"):
        guess_data(path)


HEADED = ("time [s]", "position [m]", "force [N]")
JUMBLED = np.random.default_rng(1).permutation(N)
MARKED = [(f"{t:.2f}", german(x), points(f)) for t, x, f in zip(T, X, F, strict=True)]
SCOPE = scope(";", 10.0 * np.arange(N), points)


def spoilt(column):
    """Return a table with a fault of a spreadsheet in its 19th line."""
    lines = [line.split(",") for line in ENGLISH.splitlines()]
    lines[17][column] = "#DIV/0!"
    return "\n".join(map(",".join, [HEADED, *lines]))


REFUSED = [
    ("a;b\n" + "1;2\n3;1\n" * 20, "no column seems to hold times; the columns are 'a', 'b'"),
    ("t;b\n" + rows((T, X)), "no column seems to hold a position or a velocity"),
    ("travel [mm],uncertainty [mm]\n72,1\n200,2\n", "is a table of travels"),
    ("1,2\n3,4\n5,6\n", "its first line holds numbers, not names"),
    (rows((T, X, F)), "its first line holds numbers, not names"),
    ("only words\nand more\n", "is not a table"),
    ("", r"log.csv: is empty\.$"),
    ("time [s],position [m]\n" + rows((T[JUMBLED], X[JUMBLED]), ",", points),
     r"the column 'time' holds no times .* Sort the rows"),
    ("time [s],position [m],force [N]\n0,0,1\n",
     "has one row of numbers: a record in time has at least 2"),
    *(
        (spoilt(k), rf"'{re.escape(name)}', line 19: must be a finite number, got '#DIV/0!'")
        for k, name in enumerate(HEADED)
    ),
    ("Zeit;Weg;Kraft\ns;mm;N\n" + rows((T, X, F)) + "Ende der Messung;;\n",
     rf"line {N + 3}: must be a finite.*'Ende der Messung'"),
    (SCOPE.replace("Name;Axis", "Kanal;Axis"), "has no names of channels"),
    (SCOPE.replace("\n10.0000;", "\nzehn;"), "'zehn' is not a time"),
    ("time,position,force\n" + "\n".join(f'{t},"{x}",{f}' for t, x, f in MARKED),
     r"line 2: .*got '0,0000'"),
    ("\n".join(map(",".join, [("time", "position", "force"), *MARKED])),
     r"rows have 4 cells.*decimal commas must be in quotes"),
    ("Time (s),Position (mm, relative),Force (N)\n" + rows((T, X, F), ",", points),
     r"'Position \(mm,relative\)' of a column holds a mark"),
    ("time,position,force\n" + "".join(f"{t:.2f},0x{k:04x},1.5\n" for k, t in enumerate(T)),
     r"line 2: must be a finite number, got '0x0000'"),
    ("time,position\n" + "".join(f"12:00:{int(t):02d},{t:.4f}\n" for t in T),
     "one time stamp for several rows"),
    ("time [mm],position\n" + rows((T, X), ",", points), "is in mm, which is no unit of time"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), REFUSED, ids=[said[:40] for _, said in REFUSED])
def test_what_is_no_record_is_refused_in_one_line(tmp_path, text, message):
    file = tmp_path / "log.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message) as caught:
        guess_data(file)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("unit", "size"), [("[-]", 1.0), ("[%]", 0.01)])
def test_a_coefficient_without_a_load_is_friction_over_the_load(tmp_path, unit, size):
    path = tmp_path / "tribometer.csv"
    path.write_text(f"speed [mm/s],mu {unit}\n1,0.31\n10,0.29\n100,0.26\n")
    guess = guess_data(path)
    assert any("is a coefficient, and no load is known" in doubt for doubt in guess.doubts)
    record = read_data([path], guess.reading)
    assert record.friction.tolist() == pytest.approx([size * x for x in (0.31, 0.29, 0.26)])
    assert record.load.tolist() == [1.0, 1.0, 1.0]
    loaded = read_data([path], guess.reading, mechanism=Axis(inertia=1.0, load=50.0))
    assert loaded.friction.tolist() == pytest.approx([50.0 * size * x for x in (0.31, 0.29, 0.26)])


KINDS = {
    "t": T, "x": X, "F": F, "n": 50.0 + 0.01 * np.arange(N), "c": X + 1e-3, "k": np.arange(N),
    "M": 1e3 * T, "U": 1e6 * X, "E": 1e3 * EPOCH + 1e3 * T, "p": TURNED[0] + 0.01,
    "q": TURNED[0], "r": TURNED[1], "y": np.cos(3.0 * T),
    "o": np.where(np.arange(N) % 2, 2.0, np.nan),
    "i": np.cos(2.0 * T), "j": np.sin(40.0 * T), "C": np.round(900.0 * np.sin(2.0 * T)),
    # few readings: speeds with a temperature that rises, and a slow motion
    "S": np.tile(np.linspace(0.05, 0.5, 6), 4), "W": np.linspace(20.0, 60.0, 24),
    "R": 4.0 + np.tile(np.linspace(0.05, 0.5, 6), 4), "b": T[:25], "v": 5.0 + T[:25] / 10.0,
    "f": 2.0 + T[:25],
}  # fmt: skip
"""Columns by a letter."""
MOTOR = "time;motor.position [rad];motor.velocity [rad/s];motor."
MOVES = {"position": "motor.position", "velocity": "motor.velocity"}
GUESSED = [
    # heads of columns, their kinds, what is guessed of them (all, unless one is none), and more
    ("Zeit;Kanal1;Kanal2", "txF", {"time": "Zeit", "position": "Kanal1", "force": "Kanal2"},
     {"given": {"columns": {"position": "Kanal1", "force": "Kanal2"}}}),
    *(("t (s),v (mm/s),F (kN)", "txF", {"velocity": "v (mm/s)", "position": None},
       {"given": {"columns": {"velocity": name}}, "units": {"velocity": "mm/s"},
        "silent": "no unit"}) for name in ("v (mm/s)", "V", "v")),
    ("t,x", "MU", {"position": "x", "force": None},
     {"doubts": ["with 10 s between samples: if it counts ms, give --unit time=ms",
                 "if it is in mm or um, give its unit, as --unit position=mm"]}),
    ("t;n", "tC", {"time": "t", "velocity": "n"},
     {"doubts": ["m/s: if it is in mm/s or rpm, give its unit, as --unit velocity=mm/s"]}),
    ("epoch;x;force", "ExF", {"time": "epoch", "position": "x", "force": "force"},
     {"reasons": {"time": "column 'epoch' in ms, as its numbers count from 1970;"}}),
    ("[ms] time;(mm) pos;[N] force", "txF", {"velocity": None},
     {"units": {"time": "ms", "position": "mm", "force": "N"}}),
    ("time (s);pos (mm, raw);force [N] filtered", "txF", {"velocity": None},
     {"units": {"time": "s", "position": "mm", "force": "N"}}),
    ("time;theta;tau", "txc", {"time": "time", "position": "theta", "force": "tau"},
     {"turning": True}),
    (f"{MOTOR}torque [N m]", "txcn", {**MOVES, "force": "motor.torque", "current": None}, {}),
    (f"{MOTOR}current [A]", "txcn", {**MOVES, "current": "motor.current", "force": None}, {}),
    ("time;position.elbow [rad];motor.elbow [N m];effort [N m]", "txnc",
     {"time": "time", "position": "position.elbow", "force": "effort"}, {}),
    ("time.a;position.a;force.a", "txn", {"velocity": None}, {"units": {"time": None}}),
    ("time.a;position.a;force.a;time.b;position.b;force.b", "txntxn",
     {"time": "time.b", "velocity": None}, {"given": {"columns": {"position": "position.b"}}}),
    ("time;x1;y1;x2;y2;F", "txxccF", {"velocity": None}, {"silent": "joints"}),
    ("time (s),x (mm),y position (mm),target position (mm),force (N)", "txypF",
     {"velocity": None}, {"silent": "positions of this axis"}),
    ("t (s);position (mm);motor angle x (mm)", "txx", {"velocity": None},
     {"doubts": [r"they are equal\."], "silent": "differ by"}),
    ("t (s);Rolling Speed (mm/s);Friction (N)", "txF", {"position": None},
     {"doubts": ["is read as the sliding velocity"]}),
    # readings at any time are no times, nor do some samples of a slow motion make steady readings
    ("speed_m_s,temperature_C,friction_N", "SWR",
     {"temperature": "temperature_C", "time": None}, {}),
    ("time (s),velocity (mm/s),friction (N)", "bvf", {"time": "time (s)", "position": None}, {}),
    *((f"t;x [mm];{name}", "txF", {"velocity": None},
       {"doubts": [f"{name.partition(' ')[0]}.*may drive the axis"]})
      for name in ("Motormoment [Nm]", "u [V]")),
    ("time [s],position [m],ch3", "txF", {"force": None},
     {"doubts": ["not read: 'ch3'. If one of them drives"]}),
    ("time [s],position [m]", "tx", {"force": None},
     {"doubts": ["^The file has no force: the body is assumed"]}),
    ("t,a_cmd,index,a,armVel", "tpkqr", {"position": "a", "force": None},
     {"reasons": {"position": "as its derivative is 'armVel'"}}),
    ("t,x,F", "txF", {"time": "t", "position": "x", "force": "F"},
     {"doubts": ["'t'", "'x'.*m is assumed for the position", "'F'"]}),
    ("t,x,F", "txF", {"time": "t", "position": "x", "force": "F"},
     {"given": {"units": {"time": "ms", "position": "mm", "force": "N"}}, "silent": ""}),
    ("LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\nX_Value\tWeg\tKraft", "txF",
     {"time": "X_Value", "position": "Weg", "force": "Kraft"}, {"turning": False}),
    ("time_ms;pos_um;torque_Nm;angle_deg", "txFx",
     {"time": "time_ms", "position": "angle_deg", "force": "torque_Nm"}, {"turning": True}),
    ("Zeit;Position1;Position2;Kraft\ns;mm;mm;N", "txxF",
     {"time": "Zeit", "position": "Position1", "force": "Kraft"},
     {"doubts": ["as well as 'Position1'"]}),
    ("t;I_A;F_N;v_m/s", "tFFx", {"time": "t", "velocity": "v_m/s", "force": "F_N"}, {}),
    ("ZEIT;WEG;KRAFT\nS;MM;N", "txF", {"time": "ZEIT", "position": "WEG", "force": "KRAFT"}, {}),
    ("Index;Zeit;Weg;Kraft\n;s;mm;N", "ktxF",
     {"time": "Zeit", "position": "Weg", "force": "Kraft"}, {"silent": "as well as"}),
    # a normal force drives nothing, and volts are no velocity
    ("time;Normal force [N];pos [m]", "tnx",
     {"time": "time", "position": "pos", "load": "Normal force"}, {}),
    ("time;Fx [N];Fz [N];x [m]", "tFnx",
     {"time": "time", "position": "x", "force": "Fx", "load": "Fz"}, {}),
    ("t;u [V];v [V];x [m]", "tFFx", {"time": "t", "position": "x"}, {}),
    ("t;V;x [m]", "tFx", {"time": "t", "position": "x"}, {}),
    ("x [mm];motor_V;t", "xFt", {"position": "x", "velocity": None}, {}),
    ("time [s];position [m];speed setpoint [m/s]", "txc", {"velocity": None}, {}),
    # what was measured comes before what was commanded, and errors are no motion
    ("t;tau_cmd;tau_meas;q", "tcFx", {"time": "t", "position": "q", "force": "tau_meas"}, {}),
    ("t;tau_cmd;q", "tcx", {"time": "t", "position": "q", "force": "tau_cmd"}, {}),
    ("t;load torque;motor torque;q", "tnFx",
     {"time": "t", "position": "q", "force": "motor torque"}, {}),
    ("t;following error [mm];Lage [mm];Kraft", "tcxF",
     {"time": "t", "position": "Lage", "force": "Kraft"}, {}),
    ("time;acc_x;force_x;pos_x", "tcFx",
     {"time": "time", "position": "pos_x", "force": "force_x"}, {}),
    ("time;Load cell [V];LVDT [V]", "tFx",
     {"time": "time", "position": "LVDT", "force": "Load cell"}, {}),
    ("t;joint.0.pos-fb;joint.0.pos-cmd;joint.0.torque", "txcF",
     {"time": "t", "position": "joint.0.pos-fb", "force": "joint.0.torque",
      "reference": "joint.0.pos-cmd"}, {}),
    ("time;position.desired [rad];position.actual [rad]", "tcx",
     {"time": "time", "position": "position.actual", "reference": "position.desired"},
     {"silent": "joint"}),
    ("time (s);angle (rad);friction torque (N m)", "txF",
     {"friction": "friction torque (N m)", "force": None}, {"silent": "joint"}),
    ("time (s);x (m);F (N);pressure_set (bar)", "txFc", {"pressure": None}, {}),
    *((f"t (s);{error};v (mm/s);F (N)", "txxF", {"position": None}, {}) for error in (
        "position error (mm)", "Schleppfehler [mm]", "motor power (mm)", "poserr (mm)",
        "followingerror (mm)", "Leistung (mm)", "Regelabweichung (mm)", "position diff (mm)")),
    *((f"t (s);{rolling};{sliding};Friction (N)", "txxF",
       {"velocity": sliding, "position": None}, {})
      for rolling in ("Rolling Speed (mm/s)", "Rollgeschwindigkeit (mm/s)")
      for sliding in ("Sliding Speed (mm/s)", "Gleitgeschwindigkeit (mm/s)")),
    # words bar the quantities that they exclude, and no others
    *((f"t (s);x (mm);{header}", "txF", {quantity: header, "velocity": None}, {})
      for header, quantity in {
          "rolling friction (N)": "friction", "Rollreibung (N)": "friction",
          "Friction force amplitude (N)": "friction", "rolling resistance force (N)": "force",
          "power drive force (N)": "force", "wear track load (N)": "load",
          "differential pressure (bar)": "pressure"}.items()),
    ("t (s);index finger angle (rad)", "tF",
     {"position": "index finger angle (rad)", "velocity": None}, {}),
    ("t (s);power drive position (mm)", "tF",
     {"position": "power drive position (mm)", "velocity": None}, {}),
    ("t (s);Rolling Speed (mm/s)", "tF",
     {"velocity": "Rolling Speed (mm/s)", "position": None}, {}),
    # phase currents and counts of a motor turn about an axis
    *((header, "tijC"[: header.count(",") + 1], None, {"turning": turns}) for header, turns in (
        ("time (s),Ia (A),Ib (A),encoder (counts)", True),
        ("time (s),phase A current (A),phase B current (A),position (counts)", True),
        ("t [s],iq [A],id [A],velocity", True),
        ("time (s),current (A),other,position (counts)", True),
        ("time (s),current (A),other,linear encoder (counts)", False),
        ("time (s),force (N),other,position (counts)", False))),
    ("time (s),x (m),F (N),pressure (bar)", "txFo", {"pressure": None},
     {"doubts": [r"'pressure \(bar\)' seems to be the pressure"]}),
]  # fmt: skip


@pytest.mark.parametrize(("heads", "kinds", "found", "more"), GUESSED)
def test_columns_are_guessed_by_names_units_and_values(tmp_path, heads, kinds, found, more):
    mark = next(mark for mark in "\t;," if mark in heads)
    body = rows([KINDS[kind] for kind in kinds], mark, points).replace("nan", "")
    file = tmp_path / "a.csv"
    file.write_text(f"{heads}\n{body}", encoding="utf-8")
    guess = guess_data(file, **more.get("given", {}))
    if found is not None and None not in found.values():
        assert guess.columns == found
    for quantity, column in (found or {}).items():
        assert guess.columns.get(quantity) == column
    for quantity, unit in more.get("units", {}).items():
        assert guess.units.get(quantity) == unit
    for quantity, reason in more.get("reasons", {}).items():
        assert reason in guess.reasons[quantity]
    assert guess.turning == more.get("turning", guess.turning)
    for said in more.get("doubts", ()):
        assert any(re.search(said, doubt) for doubt in guess.doubts)
    if "silent" in more:
        assert not any(more["silent"] in doubt for doubt in guess.doubts)


ODD = "\n".join(f"{t:.2f};{x:.6f};{2 * y:.6f}" for t, x, y in zip(T, X, F / 40, strict=True))


@pytest.mark.parametrize("odd", ["rad.s", "LSB"])
@pytest.mark.parametrize(
    "head", ["Zeit;Winkel;Moment\ns;rad;{}", "Zeit [s];Winkel [rad];Moment [{}]"]
)
@pytest.mark.parametrize("preface", ["", "2026-03-02 10:11:12.5\n", "Halle;Achse;Bediener\n"])
def test_what_is_no_unit_is_named_and_leaves_the_names_of_the_columns(tmp_path, odd, head, preface):
    path = tmp_path / "a.csv"
    path.write_text(f"{preface}{head.format(odd)}\n{ODD}\n")
    guess = guess_data(path)
    assert guess.columns == {"time": "Zeit", "position": "Winkel", "force": "Moment"}
    assert guess.doubts == (
        f"{odd!r} is no unit: give it, as --unit force=Nm; N m is assumed for the force.",
    )
    record = load_measurement(
        path, columns=guess.columns, units=guess.units, layout=guess.layout, repair=guess.repair
    )
    np.testing.assert_allclose(record.force, F / 20, atol=1e-6)
    guess = guess_data(path, units={"force": "mNm"})
    assert not guess.doubts


def test_names_of_one_letter_that_are_units_too_are_names(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(f"Rig;Operator;Comment\nt;x;F\n{ODD}\n")
    assert guess_data(path).columns == {"time": "t", "position": "x", "force": "F"}


@pytest.mark.parametrize("header", ["velocity measured [Hz]", "Drehzahl (Hz)", "speed_Hz"])
def test_hertz_of_a_rotation_are_revolutions_a_second(tmp_path, header):
    path = tmp_path / "a.csv"
    path.write_text(f"t [s];{header};torque [N m]\n{ODD}\n")
    guess = guess_data(path)
    assert guess.turning
    record = load_measurement(path, columns=guess.columns, units=guess.units)
    np.testing.assert_allclose(record.velocity, 2 * np.pi * X, atol=1e-5)


def test_a_frequency_is_no_velocity_by_its_unit(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(f"t [s];angle [rad];f0 [Hz]\n{ODD}\n")
    assert "velocity" not in guess_data(path).columns


@pytest.mark.parametrize(("size", "doubted"), [(42.0, True), (6.0, False)])
def test_an_angle_of_more_than_a_turn_without_a_unit_may_be_in_degrees(tmp_path, size, doubted):
    path = tmp_path / "a.csv"
    text = "".join(f"{t:.2f};{size / 6 * x:.6f};{f:.6f}\n" for t, x, f in zip(T, X, F, strict=True))
    path.write_text(f"t [s];Winkel;Moment [N m]\n{text}")
    said = [doubt for doubt in guess_data(path).doubts if "Winkel" in doubt]
    assert len(said) == 1
    assert ("--unit position=deg" in said[0]) is doubted


def topics(path, names="__time,/joint/position,/joint/velocity,/cmd/torque", every=3):
    """Write rows of two topics, each with times of its own; return the torques that then act."""
    moved = [(t, f"{x:.6f},{6 * x:.6f},") for t, x in zip(T, X, strict=True)]
    told = [(t + 0.0013, f",,{f:.6f}") for t, f in zip(T[::every], F[::every], strict=True)]
    cells = "".join(f"{t:.4f},{row}\n" for t, row in sorted(moved + told))
    path.write_text(f"{names}\n{cells}")
    return F[::every][np.maximum(np.arange(N) - 1, 0) // every]


def test_a_command_in_rows_of_its_own_holds_until_the_next(tmp_path):
    path = tmp_path / "log.csv"
    acting = topics(path)
    guess = guess_data(path)
    assert guess.repair == ("hold", "gaps")
    assert any("'/cmd/torque' are others than those of the motion" in x for x in guess.doubts)
    record = load_measurement(path, columns=guess.columns, repair=guess.repair)
    np.testing.assert_allclose(record.time, T[1:], atol=1e-9)  # before the first nothing is known
    np.testing.assert_allclose(record.force, acting[1:], atol=1e-6)
    np.testing.assert_allclose(record.position, X[1:], atol=1e-6)
    assert 'repair = ["hold", "gaps"]' in guessed_rig(guess, tmp_path / "rig.toml")


def test_a_force_measured_in_some_of_the_rows_is_not_held(tmp_path):
    path = tmp_path / "log.csv"
    cells = [f"{f:.6f}" if k % 5 == 0 else "" for k, f in enumerate(F)]
    body = "".join(f"{t:.2f},{x:.6f},{f}\n" for t, x, f in zip(T, X, cells, strict=True))
    path.write_text(f"time [s],position [m],force [N]\n{body}")
    guess = guess_data(path)
    assert guess.repair == ("gaps",)
    assert any("Only 240 rows of 1,200" in doubt for doubt in guess.doubts)


@pytest.mark.parametrize(
    "header",
    ["Zeit [s] Winkel [rad] Moment [N m]", "Zeit (s) Winkel(rad) Moment [N m]", "t Winkel [rad] M"],
)
def test_a_blank_before_a_bracket_parts_no_names(tmp_path, header):
    path = tmp_path / "a.txt"
    path.write_text(f"Prüfstand 3\n{header}\n{ODD.replace(';', ' ')}\n")
    guess = guess_data(path)
    record = load_measurement(
        path, columns=guess.columns, units=guess.units, layout=guess.layout, repair=guess.repair
    )
    np.testing.assert_allclose(record.position, X, atol=1e-6)
    np.testing.assert_allclose(record.force, F / 20, atol=1e-6)


@pytest.mark.parametrize(
    ("resting", "joint", "said"), [(1e-4, "2", ", the first that moves"), (0.5, "1", "")]
)
def test_a_joint_that_rests_while_another_moves_is_not_offered(tmp_path, resting, joint, said):
    path = tmp_path / "a.csv"
    noise = resting * np.random.default_rng(3).normal(size=N)
    body = rows((T, noise, X, 0 * T + 0.1, F), ",", lambda value: f"{value:.6f}")
    path.write_text(f"time,q1,q2,tau1,tau2\n{body}")
    guess = guess_data(path)
    assert guess.columns["position"] == f"q{joint}"
    assert guess.columns["force"] == f"tau{joint}"
    assert any(f"of joint {joint} alone{said}. For another" in doubt for doubt in guess.doubts)
    assert guess_data(path, columns={"position": "q1"}).columns["force"] == "tau1"
