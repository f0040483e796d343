"""Files as programs and people write them are recognised, and read as they were meant."""

import contextlib
from datetime import datetime, timedelta

import numpy as np
import pytest

from stickslip import Axis, check, load_measurement, load_rig
from stickslip.errors import InputError, StickslipError
from stickslip.experiments import Layout, guess_data, guessed_rig

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
    (tmp_path / "achse.toml").write_text(guessed_rig(guess, "achse.csv"), encoding="utf-8")
    record = load_rig(tmp_path / "achse.toml").measurement
    assert record.turning
    np.testing.assert_allclose(record.position, X, atol=1e-8)
    np.testing.assert_allclose(record.velocity, 6 * np.cos(2 * T), atol=1e-6)
    scale = 0.1 if "current" in driven else 1.0  # 1 N m/A of mA, cN m
    np.testing.assert_allclose(record.force, scale * F, atol=1e-7)
    assert any("motor constant" in doubt for doubt in guess.doubts) == ("current" in driven)


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


def test_what_has_no_unit_is_doubted(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("t,x,F\n" + ENGLISH)
    doubts = guess_data(file).doubts
    assert [doubt.split("'")[1] for doubt in doubts] == ["t", "x", "F"]
    assert "m is assumed for the position" in doubts[1]
    assert not guess_data(file, units={"time": "ms", "position": "mm", "force": "N"}).doubts


def test_counts_ask_for_a_resolution(tmp_path):
    file = tmp_path / "a.csv"
    counts = rows((T, np.round(1e6 * X), F), write=lambda v: german(v, 2))
    file.write_text(f"Zeit;Position;Kraft\ns;Inkremente;N\n{counts}")
    guess = guess_data(file)
    assert any("counts per unit" in doubt for doubt in guess.doubts)
    text = guessed_rig(guess, "a.csv").replace("0.001 mm/count", "1000 counts/mm")
    (tmp_path / "a.toml").write_text(text)
    np.testing.assert_allclose(load_rig(tmp_path / "a.toml").measurement.position, X, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a;b\n" + "1;2\n3;1\n" * 20, "no column seems to hold times; the columns are 'a', 'b'"),
        ("t;b\n" + rows((T, X)), "no column seems to hold a position or a velocity"),
        ("travel [mm],uncertainty [mm]\n72,1\n200,2\n", "is a table of travels"),
        ("1,2\n3,4\n5,6\n", "its first line holds numbers, not names"),
        (rows((T, X, F)), "its first line holds numbers, not names"),
        ("only words\nand more\n", "is not a table"),
        ("", "is empty"),
    ],
)
def test_what_is_no_record_is_refused_in_one_line(tmp_path, text, message):
    file = tmp_path / "a.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        guess_data(file)
    assert "\n" not in str(caught.value)


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


def test_given_columns_are_not_guessed(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("Zeit;Kanal1;Kanal2\n" + rows((T, X, F)))
    guess = guess_data(file, columns={"position": "Kanal1", "force": "Kanal2"})
    assert guess.columns == {"time": "Zeit", "position": "Kanal1", "force": "Kanal2"}


def test_the_rig_file_of_any_names_is_valid(tmp_path):
    name = 'Weg "links" \\ [mm]'
    file = tmp_path / "a b.csv"
    file.write_text(f"Zeit [s]\t{name}\tKraft [N]\n".replace('"', "'") + rows(MM, "\t"))
    guess = guess_data(file)
    (tmp_path / "a.toml").write_text(guessed_rig(guess, "a b.csv"))
    np.testing.assert_allclose(load_rig(tmp_path / "a.toml").measurement.position, X, atol=6e-7)


SHORT = slice(0, 30)
ODD = {
    "a preface of a program": (
        "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\nX_Value\tWeg\tKraft\n",
        (T, X, F), "\t", {"time": "X_Value", "position": "Weg", "force": "Kraft"},
    ),
    "a track beside an angle": (
        "time_ms;pos_um;torque_Nm;angle_deg\n",
        (T, X, F, X), ";", {"time": "time_ms", "position": "angle_deg", "force": "torque_Nm"},
    ),
    "two of a kind": (
        "Zeit;Position1;Position2;Kraft\ns;mm;mm;N\n",
        (T, X, X, F), ";", {"time": "Zeit", "position": "Position1", "force": "Kraft"},
    ),
    "a slash in a unit": (
        "t;I_A;F_N;v_m/s\n",
        (T, F, F, X), ";", {"time": "t", "velocity": "v_m/s", "force": "F_N"},
    ),
    "capitals": (
        "ZEIT;WEG;KRAFT\nS;MM;N\n",
        (T, X, F), ";", {"time": "ZEIT", "position": "WEG", "force": "KRAFT"},
    ),
    "a counter": (
        "Index;Zeit;Weg;Kraft\n;s;mm;N\n",
        (100 * T, T, X, F), ";", {"time": "Zeit", "position": "Weg", "force": "Kraft"},
    ),
}  # fmt: skip


@pytest.mark.parametrize(("head", "columns", "mark", "found"), ODD.values(), ids=ODD)
def test_odd_headers_are_understood(tmp_path, head, columns, mark, found):
    file = tmp_path / "a.csv"
    file.write_text(head + rows([one[SHORT] for one in columns], mark))
    guess = guess_data(file)
    assert guess.columns == found
    assert guess.turning == ("deg" in head)
    assert any("as well as 'Position1'" in one for one in guess.doubts) == ("Position2" in head)


def test_a_word_among_the_numbers_is_named(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("Zeit;Weg;Kraft\ns;mm;N\n" + rows((T, X, F)) + "Ende der Messung;;\n")
    with pytest.raises(InputError, match=rf"line {N + 3}: must be a finite.*'Ende der Messung'"):
        guess_data(file)


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
