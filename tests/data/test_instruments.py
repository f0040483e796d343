"""Files of instruments are read as their programs write them: every channel, with its unit."""

from datetime import datetime, timedelta

import numpy as np
import pytest

from stickslip import Measurement, check, load_measurement
from stickslip.data import Layout, guess_data, read_data
from stickslip.data.readers.table_reader import read_frame
from stickslip.errors import InputError

N = 60
T = np.arange(N) / 100
X = 0.03 * np.sin(7.0 * T)
F = 4.0 * np.cos(7.0 * T)


def read(path):
    """Return what a file seems to hold, and its measurement."""
    guess = guess_data(path)
    return guess, read_data([path], guess.reading)


# --- TwinCAT Scope


def scope(groups, separator="\t", decimal=".", ended=" ", end=""):
    """Return an export of groups of channels: names, units, times [ms] and columns of values."""
    lines = ["Name|axis", "File|axis.csv", '"Starttime of export"|1329|"Montag, 2. Mai"|15:56:24']
    lines += ['"Endtime of export"|1330|"Montag, 2. Mai"|15:56:25', "", ""]
    keys = {
        "Name": lambda channel: channel[0],
        "SymbolComment": lambda _: "",
        "Data-Type": lambda _: "REAL64",
        "SymbolName": lambda channel: f"MAIN.{channel[0].replace(' ', '_')}",
        "Unit": lambda channel: channel[1],
    }
    for key, cell in keys.items():
        lines.append("|".join(c for _, own in groups for c in (key, *map(cell, own))))
    lines.append("")
    for row in range(max(len(times) for times, _ in groups)):
        cells = []
        for times, own in groups:
            there = row < len(times)
            cells += [f"{times[row]:.6g}" if there else ended]
            cells += [f"{values[row]:.6f}" if there else ended for _, _, values in own]
        while cells and not cells[-1].strip() and not ended:
            cells.pop()
        lines.append("|".join(cells).replace(".", decimal))
    return "\n".join([*lines, end]).replace("|", separator)


POS, FORCE = ("ActPos", "mm (Position)", 1e3 * X), ("ActForce", "N (Force)", F)
TEST = ("test space", "(None)", T)
SCOPES = {
    "double times": {"groups": [(1e3 * T, [POS]), (1e3 * T, [FORCE])]},
    "one time": {"groups": [(1e3 * T, [POS, FORCE])]},
    "mixed groups": {"groups": [(1e3 * T, [TEST]), (1e3 * T, [POS, FORCE, TEST])]},
    "decimal comma": {"groups": [(1e3 * T, [POS, FORCE, TEST])], "decimal": ","},
    "end": {"groups": [(1e3 * T, [POS, FORCE])], "end": "EOF\n"},
    "commas": {"groups": [(1e3 * T, [POS, FORCE])], "separator": ",", "end": "EOF"},
    "colons": {"groups": [(1e3 * T, [POS, FORCE])], "separator": ":"},
    "blanks": {"groups": [(1e3 * T, [POS, FORCE])], "separator": " "},
    "blanks in names": {"groups": [(1e3 * T, [POS, TEST, FORCE])], "separator": " "},
    "semicolons": {"groups": [(1e3 * T, [POS]), (1e3 * T, [FORCE])], "separator": ";", "end": "\n"},
}


@pytest.mark.parametrize("layout", SCOPES.values(), ids=SCOPES)
def test_every_channel_of_a_scope_is_read_with_its_unit(tmp_path, layout):
    path = tmp_path / "scope.csv"
    path.write_text(scope(**layout))
    guess, record = read(path)
    assert record.time == pytest.approx(T)
    assert record.position == pytest.approx(X, abs=1e-8)
    assert record.force == pytest.approx(F, abs=1e-5)
    assert not any("no force" in doubt or "no unit" in doubt for doubt in guess.doubts)


@pytest.mark.parametrize("ended", [" ", ""], ids=["cells of one blank", "shorter rows"])
def test_a_slower_channel_of_a_scope_may_have_ended(tmp_path, ended):
    path = tmp_path / "scope.csv"
    slow = [("Temp", "°C", np.full(N // 5, 21.0))]
    path.write_text(scope([(1e3 * T, [POS, FORCE]), (1e3 * T[::5], slow)], ended=ended))
    guess, record = read(path)
    assert record.position == pytest.approx(X, abs=1e-8)
    assert set(guess.columns) == {"time", "position", "force"}


def test_channels_of_a_scope_with_one_name_are_told_apart_by_their_symbols(tmp_path):
    path = tmp_path / "scope.csv"
    text = scope([(1e3 * T, [POS, ("ActPos", "mm (Position)", 2e3 * X), FORCE])])
    path.write_text(text.replace("MAIN.ActPos", "MAIN.Axis1.Pos", 1))
    guess = guess_data(path)
    assert guess.columns["position"] in {"MAIN.Axis1.Pos", "MAIN.ActPos"}


# --- traces of CODESYS


def trace(channels, flags=16):
    """Return a trace: names of variables, their times in units of a clock, and values."""
    lines = ["[key]; [value]", "Version; 0x03050000", f"Flags; {flags}"]
    for k, (name, times, values) in enumerate(channels):
        lines += [f"{k}.Variable; {name}", f"{k}.Class; 14", f"{k}.Data; "]
        lines += [f"; {t:.0f}; {x:.9g}" for t, x in zip(times, values, strict=True)]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(("flags", "per"), [(16, 1e3), (20, 1e3), (32, 1e6)])
def test_each_variable_of_a_trace_is_a_column_by_the_clock_of_its_flags(tmp_path, flags, per):
    path = tmp_path / "axis.trace.csv"
    channels = [("Axis.fActPosition", X), ("Axis.fActForce", F)]
    path.write_text(trace([(name, per * T + 2, x) for name, x in channels], flags))
    guess, record = read(path)
    assert guess.columns["position"] == "Axis.fActPosition"
    assert record.time - record.time[0] == pytest.approx(T - T[0], abs=1e-9)
    assert record.position == pytest.approx(X, abs=1e-8)
    assert record.force == pytest.approx(F, rel=1e-7)


def test_a_trace_that_does_not_say_in_what_it_counts_asks_for_the_unit_of_time(tmp_path):
    path = tmp_path / "axis.trace.csv"
    path.write_text(trace([("A.fPos", 1e3 * T, X), ("A.fForce", 1e3 * T, F)], flags=0))
    doubts = "\n".join(guess_data(path).doubts)
    assert "has no unit: s is assumed for the time" in doubts
    assert "--unit time=ms" in doubts


def test_slower_and_empty_variables_of_a_trace_are_told(tmp_path):
    path = tmp_path / "axis.trace.csv"
    path.write_text(
        trace([("A.fPos", 1e3 * T, X), ("A.fForce", 1e3 * T[::2], F[::2]), ("A.bOn", [], [])])
    )
    guess, record = read(path)
    assert "Without rows, and not read: 'A.bOn'." in guess.doubts
    assert record.force == pytest.approx(F[::2], rel=1e-7)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[key]; [value]\n0.Variable; x\n0.Data; \n", "has no rows below the variables of a tr"),
        ("0.Variable; x\n0.Data; \n; zehn; 1\n; 2; 1\n", "'zehn' is not a time of .*'x'"),
    ],
)
def test_a_damaged_trace_is_refused_in_one_line(tmp_path, text, message):
    path = tmp_path / "axis.trace.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        guess_data(path)


# --- LabVIEW


def lvm(columns="One", segments=((0, N),), restart=False, unit="mm", decimal=".", spaced=False):
    """Return a measurement file: which rows each segment has, and which columns of times."""
    mark = "\t\t" if spaced else "\t"
    lines = ["LabVIEW Measurement\t", "Writer_Version\t2", "Separator\tTab", "Multi_Headings\tYes"]
    lines += [
        f"Decimal_Separator\t{decimal}",
        f"X_Columns\t{columns}",
        "***End_of_Header***\t",
        "\t",
    ]
    for begin, end in segments:
        first = 0.0 if restart else T[begin]
        lines += ["Channels\t2", f"Samples\t{end - begin}{mark}{end - begin}\t"]
        lines += [f"Y_Unit_Label\t{unit}{mark}N\t", f"X_Dimension\tTime{mark}Time\t"]
        lines += [f"X0\t{first:.6f}{mark}{first:.6f}\t", f"Delta_X\t0.01{mark}0.01\t"]
        lines += ["***End_of_Header***\t\t"]
        again = "X_Value\t" if columns == "Multi" else ""
        lines += [f"X_Value\tPosition\t{again}Force\tComment"]
        for row in range(begin, end):
            time = "" if columns == "No" else f"{T[row] - T[begin] + first:.4f}"
            again = f"{time}\t" if columns == "Multi" else ""
            lines += [f"{time}\t{1e3 * X[row]:.6f}\t{again}{F[row]:.6f}"]
        lines += [""]
    lines.insert(-3, "***Start_Special***\n1\t2\n***End_Special***")
    return "\n".join(lines).replace(".", decimal).replace("***End,", "***End.")


LVMS = {
    "one column of times": {},
    "no column of times": {"columns": "No"},
    "times of each channel": {"columns": "Multi"},
    "tags beside their channels": {"columns": "Multi", "spaced": True},
    "two segments": {"segments": ((0, 20), (20, N))},
    "two segments without times": {"columns": "No", "segments": ((0, 20), (20, N))},
    "decimal comma": {"columns": "No", "decimal": ","},
    "a unit with its quantity": {"unit": "mm (Length)"},
}


@pytest.mark.parametrize("layout", LVMS.values(), ids=LVMS)
def test_each_layout_of_labview_is_read(tmp_path, layout):
    path = tmp_path / "a.lvm"
    path.write_text(lvm(**layout))
    guess, record = read(path)
    assert record.time == pytest.approx(T)
    assert record.position == pytest.approx(X, abs=1e-8)
    assert record.force == pytest.approx(F, abs=1e-5)
    assert guess.doubts == ()


def test_segments_of_labview_whose_times_begin_again_are_trials(tmp_path):
    path = tmp_path / "a.lvm"
    path.write_text(lvm("No", segments=((0, 20), (20, N)), restart=True))
    guess, record = read(path)
    assert [trial.time.size for trial in record.trials] == [20, N - 20]
    assert any("2 trials" in doubt for doubt in guess.doubts)


@pytest.mark.parametrize("apart", [False, True])
def test_rows_that_labview_s_times_were_merged_to_are_no_lines_of_its_file(tmp_path, apart):
    path = tmp_path / "a.lvm"
    text = lvm("Multi")
    if apart:  # the last time of the force
        head, _, tail = text.rpartition(f"\t{T[-1]:.4f}\t")
        text = f"{head}\t{T[-1] + 0.002:.4f}\t{tail}"
    path.write_text(text)
    assert (read_frame(path, columns={}, units={}).first_row == 1) == apart


def test_rows_that_a_header_of_labview_promises_are_missed(tmp_path):
    path = tmp_path / "a.lvm"
    path.write_text(lvm().replace(f"Samples\t{N}\t", "Samples\t400\t"))
    assert any(
        f"400 samples, and there are {N} rows" in sentence for sentence in guess_data(path).doubts
    )


@pytest.mark.parametrize("columns", ["One", "Multi"])
def test_a_word_among_the_times_of_labview_is_named(tmp_path, columns):
    path = tmp_path / "a.lvm"
    path.write_text(lvm(columns).replace("\n0.1000\t", "\nzehn\t"))
    with pytest.raises(InputError, match="'zehn'"):
        guess_data(path)


def test_a_text_that_its_own_reader_knows_has_no_layout(tmp_path):
    path = tmp_path / "a.lvm"
    path.write_text(lvm())
    with pytest.raises(InputError, match="measurement file of LabVIEW, which is read without"):
        load_measurement(path, layout=Layout(separator="\t", preface=14))


# --- TDMS and workbooks


def tdms(path, groups):
    """Write groups of channels: name, values, unit, and the first time and step of a waveform."""
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(path) as file:
        for group, channels in groups.items():
            made = []
            for name, values, unit, *wave in channels:
                stated = {"unit_string": unit}
                if wave:
                    stated |= {"wf_start_offset": wave[0], "wf_increment": wave[1]}
                made.append(nptdms.ChannelObject(group, name, values, properties=stated))
            file.write_segment(made)
    return path


MM, NEWTON = ("Position", 1e3 * X, "mm"), ("Force", F, "N")
WAVES = [(*MM, 0.0, 0.01), (*NEWTON, 0.0, 0.01)]
TDMS = {
    "waveforms": {"a": WAVES},
    "a channel of times": {"a": [("Time", T, "s"), MM, NEWTON]},
    "a unit with its quantity": {"a": [("Time", T, "s"), ("Position", X, "m (Length)"), NEWTON]},
    "settings in a group": {"a": WAVES, "setup": [("gain", np.ones(3), "")]},
}


@pytest.mark.parametrize("groups", TDMS.values(), ids=TDMS)
def test_channels_of_a_tdms_file_are_read_with_their_times_and_units(tmp_path, groups):
    guess, record = read(tdms(tmp_path / "a.tdms", groups))
    assert record.time == pytest.approx(T)
    assert record.position == pytest.approx(X)
    assert record.force == pytest.approx(F)
    assert any("'setup'" in doubt for doubt in guess.doubts) == ("setup" in groups)


def test_groups_of_a_tdms_file_with_the_same_channels_are_trials(tmp_path):
    _, record = read(tdms(tmp_path / "a.tdms", {"one": WAVES, "two": WAVES}))
    assert [trial.name for trial in record.trials] == ["trial one", "trial two"]


def test_a_channel_of_another_length_is_said_not_to_be_read(tmp_path):
    channels = [("Time", T, "s"), MM, NEWTON, ("Temp", np.ones(5), "degC")]
    guess = guess_data(tdms(tmp_path / "a.tdms", {"a": channels}))
    assert any("Not read" in doubt and "'Temp [degC]'" in doubt for doubt in guess.doubts)


def test_a_tdms_file_that_was_cut_says_so(tmp_path, capfd):
    path = tdms(tmp_path / "a.tdms", {"a": WAVES})
    path.write_bytes(path.read_bytes()[:-160])
    assert any(
        "segment of the file is incomplete" in sentence for sentence in guess_data(path).doubts
    )
    assert capfd.readouterr() == ("", "")  # the package prints that itself


@pytest.mark.parametrize(("ending", "kind"), [(".tdms", "TDMS file"), (".xlsx", "workbook")])
def test_what_is_no_such_file_is_refused_in_one_line(tmp_path, ending, kind):
    path = tmp_path / f"a{ending}"
    path.write_bytes(b"\0\0nothing of that kind" * 9)
    with pytest.raises(InputError, match=f"is not a {kind}, or is damaged") as error:
        guess_data(path)
    assert "\n" not in str(error.value)


def workbook(path, sheets):
    """Write sheets of rows of cells."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


ROWS = [*zip(T.tolist(), (1e3 * X).tolist(), F.tolist(), strict=True)]
BOOKS = {
    "units in the header": [["Zeit [s]", "Weg [mm]", "Kraft [N]"], *ROWS],
    "units in a row": [["Zeit", "Weg", "Kraft"], ["s", "mm", "N"], *ROWS],
    "lines above": [["Prüfstand 3"], [], ["t (s)", "x (mm)", "F (N)"], *ROWS],
    "a blank column": [[None, "t (s)", "x (mm)", "F (N)"], *([None, *row] for row in ROWS)],
    "times of day": [
        ["time", "x (mm)", "F (N)"],
        *((datetime(2024, 3, 1) + timedelta(seconds=t), x, f) for t, x, f in ROWS),
    ],
}  # fmt: skip


@pytest.mark.parametrize("rows", BOOKS.values(), ids=BOOKS)
def test_a_sheet_is_read_as_if_it_had_been_saved_as_text(tmp_path, rows):
    path = workbook(tmp_path / "a.xlsx", {"Info": [["Messung vom 3. Mai"]], "Daten": rows})
    guess, record = read(path)
    assert record.time - record.time[0] == pytest.approx(T, abs=1e-6)
    assert record.position == pytest.approx(X)
    assert record.force == pytest.approx(F)
    assert guess.doubts[0] == "The sheet 'Daten' is read; 'Info' is not."


@pytest.mark.parametrize("units", [True, False])
def test_names_that_stand_twice_in_a_sheet_are_numbered(tmp_path, units):
    names = ["time", "Weg", "Kraft", "Kraft"]
    head = [[f"{n} [{u}]" for n, u in zip(names, ("s", "mm", "N", "N"), strict=True)]]
    head = [names, ["s", "mm", "N", "N"]] if units else head
    path = workbook(tmp_path / "a.xlsx", {"Daten": [*head, *([*row, -row[2]] for row in ROWS)]})
    guess, record = read(path)
    assert record.force == pytest.approx(F)
    assert guess.doubts[0] == "Names that stand twice are numbered: 'Kraft (2)'."
    other = load_measurement(path, columns={**guess.columns, "force": "Kraft (2)"})
    assert other.force == pytest.approx(-F)


def test_a_workbook_without_a_table_names_its_sheets(tmp_path):
    path = workbook(tmp_path / "a.xlsx", {"Info": [["Messung"]], "Mehr": [[1, 2]]})
    with pytest.raises(InputError, match=r"no sheet has a row of names.*'Info' and 'Mehr'"):
        guess_data(path)


def test_a_cell_far_away_is_no_reason_to_take_memory(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.cell(row=200_000, column=16_384, value=1)
    book.save(tmp_path / "a.xlsx")
    with pytest.raises(InputError, match=r"no sheet has|cells exceed the limit"):
        guess_data(tmp_path / "a.xlsx")


# --- tribometers

V = 8.0 * np.cos(9.0 * T + 0.1)  # [mm/s]
MU = 0.4 + 0.01 * np.sin(5.0 * T)


def steps(n=2, end="\n"):
    """Return steps of a universal tribometer, friction as its size and with its sign."""
    lines = ["Created by Viewer ver.2", f"Total number of steps = {n}", "", "Run # 1"]
    for step in range(1, n + 1):
        lines += [f"Step No. {step}", "", "Radius       = 4.0", "Data Count   = 60", ""]
        lines += ["Fx,Fz,Z,X,V1,T,Ff,COF", "g,g,mm,mm,mm/sec,sec,g,", ""]
        force = 200.0 * MU * np.sign(V)
        cells = (force, -200 + 0 * T, -0.6 + 0 * T, 4 + 0 * T, V, T, abs(force), MU)
        lines += [",".join(f"{cell:.5f}" for cell in row) for row in zip(*cells, strict=True)]
        lines += ["", ""]
    return end.join(lines)


def traction(n=2, mark="."):
    """Return steps as a traction machine writes them: names twice, columns without one."""
    lines = ["MTM Test Data File", f"Number of steps in profile:\t{n}", ""]
    for step in range(1, n + 1):
        lines += [f"Step {step} started at 06/05/2024 19:5{step}:00", "Step type\tTraction"]
        lines += ["SRR (%)\tTraction Coeff (-)\t\tStep Time (s)\tBall Load (N)\tWear (um)\t"]
        lines[-1] += "Rolling Speed (mm/s)\tSliding Speed (mm/s)\tSRR (%)\tTraction Force (N)"
        for t, v, mu in zip(T, abs(V), MU, strict=True):
            row = (v / 0.25, mu, None, t, 20.0, 300 + t, 25.0, v, v / 0.25, 20 * mu)
            lines += ["\t".join("" if one is None else f"{one:.5f}" for one in row)]
        lines += [""]
    return "\n".join(lines).replace(".", mark)


def rotary(n=2):
    """Return a table of a rotary module below its recipe, and what it writes below the table."""
    lines = ["Recipe, Sample, Type, Radius", "demo.Rx,,Rotary,9,"]
    lines += ["Step, Timestamp, RecipeStep, DAQ.Fz (N),DAQ.Fx (N),DAQ.COF (),"]
    lines[-1] += "Rotary.Velocity (rpm),XYZ.X Position (mm),XYZ.Z Position (mm),"
    for step in range(4, 4 + n):
        for t, v, mu in zip(T, V, MU, strict=True):
            speed, force = v / (9 * 2 * np.pi / 60), 9 * mu * np.sign(v)
            row = (step, t, step, 9.0, force, mu, speed, 0, -115.38)
            lines += [",".join(f"{one:.6g}" for one in row) + ","]
    return "\n".join([*lines, "", "TotalTime", "00:01:20.0000000"])


TRIBOMETERS = {
    "universal": (steps(), ["trial 1", "trial 2"], 0.2 * 9.80665, np.sign(V)),
    "universal under Windows": (
        steps(end="\r\n"),
        ["trial 1", "trial 2"],
        0.2 * 9.80665,
        np.sign(V),
    ),
    "traction": (traction(), ["trial 1", "trial 2"], 20.0, 1.0),
    "traction, decimal comma": (traction(mark=","), ["trial 1", "trial 2"], 20.0, 1.0),
    "rotary": (rotary(), ["trial 4", "trial 5"], 9.0, np.sign(V)),
}


@pytest.mark.parametrize(("text", "trials", "load", "way"), TRIBOMETERS.values(), ids=TRIBOMETERS)
def test_steps_of_a_tribometer_are_trials_with_friction_load_and_speed(
    tmp_path, text, trials, load, way
):
    path = tmp_path / "a.txt"
    path.write_bytes(text.encode())
    guess, record = read(path)
    assert [trial.name for trial in record.trials] == trials
    assert {"time", "velocity", "friction", "load", "trial"} >= set(guess.columns) - {"trial"}
    for trial in record.trials:
        assert trial.velocity == pytest.approx(way * abs(V) / 1000, rel=1e-4)
        assert trial.load == pytest.approx(np.full(N, load))
        assert trial.friction == pytest.approx(way * load * MU, rel=1e-4)
        assert trial.time == pytest.approx(T, abs=1e-5)
    assert any(doubt.startswith("Each of the 2 steps is a trial") for doubt in guess.doubts)


@pytest.mark.parametrize("measured", ["friction", "force"])
def test_a_sliding_distance_of_hundreds_of_metres_is_normal_where_friction_is_measured(measured):
    record = Measurement(time=100 * T, position=1000 * T, **{measured: F})
    assert any("in metres" in finding.sentence for finding in check(record).findings) == (
        measured == "force"
    )


def test_a_single_step_of_a_tribometer_is_one_record(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(steps(1))
    _, record = read(path)
    assert record.friction.size == N


def test_a_coefficient_of_friction_without_a_unit_is_over_the_load(tmp_path):
    path = tmp_path / "a.csv"
    rows = "".join(f"{t:.2f},{abs(v)},{mu:.5f},20\n" for t, v, mu in zip(T, V, MU, strict=True))
    path.write_text("t (s),v (mm/s),COF,Fn (N)\n" + rows)
    _, record = read(path)
    assert record.friction == pytest.approx(20.0 * MU, rel=1e-4)


@pytest.mark.parametrize("gain", ["20 N", 20.0])
def test_the_gain_of_a_coefficient_is_the_load(tmp_path, gain):
    path = tmp_path / "a.csv"
    path.write_text("v (mm/s),mu\n" + "".join(f"{v},{m}\n" for v, m in zip(T, MU, strict=True)))
    guess = guess_data(path, gain={"friction": gain})
    assert read_data([path], guess.reading).friction == pytest.approx(20.0 * MU)


def test_a_force_beside_the_load_of_a_sensor_is_friction_where_the_speed_is_known(tmp_path):
    path = tmp_path / "a.csv"
    rows = "".join(f"{t:.2f},{v},{mu * 20:.4f},20\n" for t, v, mu in zip(T, V, MU, strict=True))
    path.write_text("t (s),v (mm/s),Fx (N),Fz (N)\n" + rows)
    guess = guess_data(path)
    assert set(guess.columns) == {"time", "velocity", "friction", "load"}
    assert any("If it drives the body, name it as --columns force=" in d for d in guess.doubts)
    assert "force" in guess_data(path, columns={"force": "Fx (N)"}).columns


def test_a_speed_of_rotation_beside_forces_asks_for_the_radius_of_the_contact(tmp_path):
    path = tmp_path / "a.csv"
    rows = "".join(f"{t:.2f},{v},{mu:.4f},20\n" for t, v, mu in zip(T, V, MU, strict=True))
    path.write_text("t (s),n (rpm),Fx (N),Fz (N)\n" + rows)
    with pytest.raises(
        InputError, match="'n \\(rpm\\)' is a speed of rotation, and forces are in N"
    ):
        guess_data(path)
    gain = {"velocity": "9 mm/rad"}
    guess = guess_data(path, columns={"velocity": "n (rpm)"}, gain=gain)
    record = read_data([path], guess.reading)
    assert record.velocity == pytest.approx(V * 2 * np.pi / 60 * 9e-3, rel=1e-4)


@pytest.mark.parametrize("name", ["Wear (um)", "Amplitude (um)", "Table height (mm)", "Depth (um)"])
def test_wear_and_heights_are_no_position(tmp_path, name):
    path = tmp_path / "a.csv"
    rows = "".join(f"{t:.2f},{x:.5f},{v},{f:.4f}\n" for t, x, v, f in zip(T, X, V, F, strict=True))
    path.write_text(f"t (s),{name},v (mm/s),friction (N)\n{rows}")
    assert set(guess_data(path).columns) == {"time", "velocity", "friction"}


HEAD = "Step No. {}\nDuration = 1 sec\nFx,Fz,V1,T\n{},mm/sec,sec\n\n"


def test_steps_of_a_tribometer_with_other_units_are_in_those_of_the_first(tmp_path):
    path = tmp_path / "a.csv"
    cells = "".join(f"{f:.4f},-200,5,{t:.2f}\n" for f, t in zip(1e3 + F, T, strict=True))
    newton = 9.80665e-3
    other = "".join(
        f"{newton * f:.6f},{-200 * newton:.6f},5,{t:.2f}\n" for f, t in zip(1e3 + F, T, strict=True)
    )
    text = f"{HEAD.format(1, 'g,g')}{cells}\n{HEAD.format(2, 'N,N')}{other}\n"
    path.write_text(f"{text}{HEAD.format(3, 's,s')}{cells}")
    guess = guess_data(path)
    first, second = (trial.friction for trial in read_data([path], guess.reading).trials)
    assert second == pytest.approx(first, rel=1e-5)
    assert "Steps with other columns, or units of another kind: 3." in guess.doubts


@pytest.mark.parametrize("rows", ["", "1,-200,5,0\n"], ids=["empty", "one row"])
def test_steps_of_a_tribometer_without_rows_are_named(tmp_path, rows):
    path = tmp_path / "a.csv"
    cells = "".join(f"{f:.4f},-200,5,{t:.2f}\n" for f, t in zip(F, T, strict=True))
    steps = [f"{HEAD.format(i, 'g,g')}{rows if i == 2 else cells}\n" for i in (1, 2, 3)]
    path.write_text("".join(steps))
    assert "Step 2 has no table of 2 rows or more and is left out." in guess_data(path).doubts


def test_the_sliding_speed_of_a_traction_machine_follows_from_its_slide_roll_ratio(tmp_path):
    path = tmp_path / "a.txt"
    head = "Step Time (s)\tSRR (%)\tRolling Speed (mm/s)\tTraction Force (N)\n"
    rows = "".join(f"{6 * i}\t{r}\t1000\t{1 + r / 50}\n" for i, r in enumerate(range(1, 60)))
    path.write_text(f"Machine\nStep 1 started at 10:00\n{head}{rows}")
    guess, record = read(path)
    assert record.velocity[:2] == pytest.approx([0.01, 0.02])
    assert any("The sliding speed is 'SRR (%)' times" in doubt for doubt in guess.doubts)


# --- registers of servos, motion capture, serial monitors


def registers(family="Dynamixel", ids=(1,)):
    """Return a log of a servo's registers, as they were read."""
    counts = np.round(2048 + 900 * np.sin(2.0 * T)).astype(int)
    speed = 2.0 * 900 * np.cos(2.0 * T) / (4096 * 0.229 / 60 if family == "Dynamixel" else 1.0)
    names = {
        "Dynamixel": "Present_Input_Voltage,Present_PWM",
        "Feetech": "Present_Voltage,Present_Load",
    }
    lines = [
        f"timestamp,id,Goal_Position,Present_Position,Present_Velocity,{names[family]},Present_Current"
    ]
    for i, (t, q, v) in enumerate(zip(T, counts, np.round(speed).astype(int), strict=True)):
        lines += [
            f"{1.7e9 + t:.2f},{ids[i % len(ids)]},{q + 9},{q},{v},120,{240 - i},{187 - 2 * i}"
        ]
    return "\n".join(lines)


@pytest.mark.parametrize("family", ["Dynamixel", "Feetech"])
def test_registers_of_a_servo_are_counts_of_an_axis_that_turns(tmp_path, family):
    path = tmp_path / "a.csv"
    path.write_text(registers(family))
    guess, record = read(path)
    assert guess.turning
    assert record.position[:2] * 2048 / np.pi == pytest.approx([2048, 2066], abs=1)
    rate = 2 * np.pi / 4096 * 1800
    assert record.velocity[0] == pytest.approx(rate, rel=0.01)
    assert record.reference is not None
    assert record.force[0] == pytest.approx(0.187 * (1.0 if family == "Dynamixel" else 6.5))
    assert record.load is None
    assert not any("count" in doubt and "has no unit" in doubt for doubt in guess.doubts)


@pytest.mark.parametrize(
    "names",
    [
        "axis0.pos_estimate,axis0.vel_estimate,torque_estimate,error",
        "position,velocity,torque,q_current,fault",
    ],
)
def test_motor_drives_report_turns(tmp_path, names):
    path = tmp_path / "a.csv"
    rows = [f"{t:.2f},{x:.6f},{v:.6f},{0.3 * v:.5f},0,0" for t, x, v in zip(T, X, V, strict=True)]
    width = names.count(",") + 2
    path.write_text(
        "\n".join([f"time,{names}", *(",".join(row.split(",")[:width]) for row in rows)])
    )
    guess, record = read(path)
    assert guess.turning
    assert record.position == pytest.approx(2 * np.pi * X, abs=1e-5)
    assert record.velocity == pytest.approx(2 * np.pi * V, abs=1e-5)
    assert any("turns" in doubt and "--unit position=" in doubt for doubt in guess.doubts)


def test_estimates_of_a_cart_are_no_motor_drive(tmp_path):
    path = tmp_path / "a.csv"
    rows = "".join(f"{t:.2f},{x:.6f},{v:.6f},1\n" for t, x, v in zip(T, X, V, strict=True))
    path.write_text("time,cart_pos_estimate [m],cart_vel_estimate [m/s],force [N]\n" + rows)
    guess, record = read(path)
    assert not guess.turning
    assert record.position == pytest.approx(X, abs=1e-5)


def test_a_dynamixel_that_reports_its_load_is_no_feetech(tmp_path):
    path = tmp_path / "a.csv"
    names = "Present_Input_Voltage,Present_PWM"
    path.write_text(registers("Dynamixel").replace(names, "Present_Load,Present_PWM"))
    guess, record = read(path)
    assert record.velocity[0] == pytest.approx(2 * np.pi / 4096 * 1800, rel=0.01)
    assert not any("SCS" in doubt for doubt in guess.doubts)


def test_a_servo_that_logs_no_duty_is_a_dynamixel_with_doubt(tmp_path):
    path = tmp_path / "a.csv"
    names = "Present_Input_Voltage,Present_PWM"
    path.write_text(registers("Dynamixel").replace(names, "Label,Part"))
    guess, record = read(path)
    assert guess.turning
    assert record.position[0] == pytest.approx(np.pi, abs=1e-2)
    assert any("a Feetech has 0.0146 rpm" in doubt for doubt in guess.doubts)


def test_registers_whose_unit_is_given_are_no_counts(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(registers())
    guess = guess_data(path, units={"position": "mdeg", "reference": "mdeg"})
    assert "position" not in guess.gain
    assert guess.units["position"] == "mdeg"


def test_registers_that_were_converted_are_no_counts(tmp_path):
    path = tmp_path / "a.csv"
    rows = "".join(f"{t:.2f},{x:.5f},0.5,120\n" for t, x in zip(T, X, strict=True))
    path.write_text("t (s),Present_Position [rad],Present_Velocity,Present_PWM\n" + rows)
    assert guess_data(path).gain == {}


def degrees(step):
    """Return a log of a servo whose angles are multiples of a step [deg]."""
    counts = np.round(2048 + 900 * np.sin(2.0 * T))
    rows = [
        f"{t:.2f},{q * step + 0.013},{q * step:.9f},120\n" for t, q in zip(T, counts, strict=True)
    ]
    return "t (s),Goal_Position,Present_Position,Present_PWM\n" + "".join(rows)


def test_positions_of_a_servo_in_steps_of_its_counts_are_degrees(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(degrees(360 / 4096))
    guess, record = read(path)
    assert guess.turning
    assert record.position[0] == pytest.approx(np.pi)
    assert record.reference[0] == pytest.approx(np.pi, abs=1e-3)


def test_positions_of_a_servo_that_may_be_degrees_ask_for_their_unit(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(degrees(0.0517))
    with pytest.raises(
        InputError, match=r"neither counts nor angles in rad: .*--unit position=deg"
    ):
        guess_data(path)
    guess = guess_data(path, units={"position": "deg"})
    assert guess.turning
    assert guess.units["reference"] == "deg"


@pytest.mark.parametrize(
    ("family", "bits"), [("Dynamixel", 32), ("Dynamixel", 16), ("Feetech", 16)]
)
def test_registers_without_their_sign_are_read_with_it(tmp_path, family, bits):
    path = tmp_path / "a.csv"
    counts = np.round(900 * np.sin(2.0 * T + 0.3)).astype(int)
    counts = np.r_[counts, -counts]
    raw = np.where(counts < 0, 2**15 - counts if family == "Feetech" else 2**bits + counts, counts)
    other = "Present_Load" if family == "Feetech" else "Present_PWM"
    rows = "".join(f"{i / 100:.2f},{q},{q},7\n" for i, q in enumerate(raw))
    path.write_text(f"t (s),Present_Position,Present_Current,{other}\n{rows}")
    guess, record = read(path)
    assert record.position * 2048 / np.pi == pytest.approx(counts)
    assert np.sign(record.force) == pytest.approx(np.sign(counts))
    said = [sentence for sentence in guess.doubts if "without their sign" in sentence]
    assert len(said) == 1
    assert "Present_Position and Present_Current" in said[0].replace("'", "")


def test_rows_of_several_servos_in_turn_are_refused(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(registers(ids=(1, 2)))
    with pytest.raises(InputError, match="rows of 2 servos in turn, by its column 'id'"):
        guess_data(path)


def capture(length="Meters", bodies=("block",)):
    """Return rigid bodies as Motive exports them; the last one moves along Z."""
    lines = [
        f"Format Version,1.23,Take Name,Take 1,Length Units,{length},Coordinate Space,Global",
        "",
    ]
    own = [(body, kind, axis) for body in bodies for kind, axis in CAPTURED]
    lines += ["," + ",".join(["Type", *["Rigid Body"] * len(own)])]
    lines += ["," + ",".join(["Name", *(body for body, _, _ in own)])]
    lines += ["," + ",".join(["ID", *["1000"] * len(own)])]
    lines += [",," + ",".join(kind for _, kind, _ in own)]
    lines += ["Frame,Time (Seconds)," + ",".join(axis for _, _, axis in own)]
    for i, (t, x) in enumerate(zip(T, X, strict=True)):
        cells = [0, 0, 0, 1, 0.1, 0.2, 0.3, 1e-4] * len(bodies)
        cells[-2] += x
        hidden = i == 5  # behind something
        lines += [f"{i},{t:.4f}," + ",".join("" if hidden else f"{c:.6f}" for c in cells)]
    return "\n".join(lines)


CAPTURED = [*(("Rotation", axis) for axis in "XYZW"), *(("Position", axis) for axis in "XYZ")]
CAPTURED += [("Mean Marker Error", "")]


@pytest.mark.parametrize(("length", "scale"), [("Meters", 1.0), ("Millimeters", 1e-3)])
@pytest.mark.parametrize("bodies", [("block",), ("frame", "block")])
def test_the_way_along_which_a_body_of_motion_capture_moves_is_its_position(
    tmp_path, length, scale, bodies
):
    path = tmp_path / "a.csv"
    path.write_text(capture(length, bodies))
    guess, record = read(path)
    assert guess.columns["position"] == "block/Position/Z"
    assert not any("may be the position as well" in doubt for doubt in guess.doubts)
    kept = np.arange(N) != 5
    assert record.time == pytest.approx(T[kept])
    assert record.position == pytest.approx(scale * (0.3 + X[kept]), abs=1e-6)


SERIALS = {
    "numbers": "{x:.3f}\t{f:.3f}",
    "labels": "pos:{x:.3f},force:{f:.3f}",
    "blanks": "{x:.3f} {f:.3f}",
    "semicolons": "{x:.3f};{f:.3f}",
}


@pytest.mark.parametrize("style", SERIALS)
def test_what_a_serial_monitor_shows_is_numbers_at_its_time_stamps(tmp_path, style):
    path = tmp_path / "a.txt"
    lines = ["23:59:59.700 -> Ready"]
    for t, x, f in zip(T, 1e3 * X, F, strict=True):
        clock = (datetime(2024, 3, 1, 23, 59, 59, 800_000) + timedelta(seconds=t)).time()
        lines += [f"{clock.isoformat('milliseconds')} -> {SERIALS[style].format(x=x, f=f)}"]
    path.write_text("\n".join(lines))
    names = ("pos", "force") if style == "labels" else ("column 1", "column 2")
    if style != "labels":
        with pytest.raises(InputError, match=r"'time', 'column 1', 'column 2'\. Name it"):
            guess_data(path)
    guess = guess_data(path, columns=dict(zip(("position", "force"), names, strict=True)))
    record = load_measurement(path, columns=guess.columns, units={"position": "mm"})
    assert record.time == pytest.approx(T)
    assert record.position == pytest.approx(X, abs=1e-6)
    assert record.force == pytest.approx(F, abs=1e-3)
