"""Files that are not plain tables: MATLAB, several at once, disordered, or no tables at all."""

import io
import math
import struct
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from stickslip import check, load_measurement
from stickslip.data import guess_data
from stickslip.data.readers.binary import check_structure
from stickslip.data.readers.csv_reader import read_text
from stickslip.errors import InputError, ParameterError, UnknownNameError

TIME = np.arange(100) / 100
POSITION = np.sin(TIME)


@pytest.fixture
def write(tmp_path, monkeypatch):
    """Writes a file into an empty working folder and returns its name."""
    monkeypatch.chdir(tmp_path)

    def writer(text, name="data.csv"):
        data = text if isinstance(text, bytes) else text.encode()
        (tmp_path / name).write_bytes(data)
        return name

    return writer


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def put(group, name, value):
    """Add a value as MATLAB 7.3 does; the fields of struct arrays refer to values elsewhere."""
    if isinstance(value, dict):
        own = group.create_group(name)
        for field, one in value.items():
            put(own, field, one)
        kind = "struct"
    elif getattr(value, "dtype", None) is not None and value.dtype.names:
        own, store = group.create_group(name), group.file.require_group("#refs#")
        for field in value.dtype.names:
            found = np.empty((value.size, 1), dtype=h5py.ref_dtype)
            for i, one in enumerate(value[field].ravel()):
                found[i, 0] = put(store, f"{len(store)}", one).ref
            own[field] = found
        kind = "struct"
    elif isinstance(value, str):
        codes = [[ord(one)] for one in value] or [0, 0]
        own = group.create_dataset(name, data=np.array(codes, dtype=np.uint16))
        if not value:
            own.attrs["MATLAB_empty"] = np.uint8(1)
        kind = "char"
    else:
        own, kind = group.create_dataset(name, data=np.asarray(value, dtype=float).T), "double"
    own.attrs["MATLAB_class"] = np.bytes_(kind)
    return own


def newer(path, content):
    """Write a file as MATLAB 7.3 does: HDF5 behind a block of text, arrays transposed."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in content.items():
            put(file, name, value)
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


# --- MATLAB


@pytest.mark.parametrize("compressed", [False, True], ids=["v6", "v7"])
def test_vectors_of_a_matlab_file_are_columns(folder, compressed):
    content = {"time": TIME[:, None], "position": POSITION[None, :], "gain": 35.0}
    savemat("data.mat", content, do_compression=compressed)
    record = load_measurement("data.mat")
    np.testing.assert_array_equal(record.time, TIME)
    np.testing.assert_array_equal(record.position, POSITION)
    assert (record.name, record.provenance) == ("data", "data.mat")


def test_vectors_of_a_new_matlab_file_are_columns(folder):
    newer(folder / "data.mat", {"t": TIME[:, None], "q": POSITION[:, None], "K": np.eye(3)})
    record = load_measurement("data.mat", columns={"time": "t", "position": "q"})
    np.testing.assert_array_equal(record.time, TIME)
    np.testing.assert_array_equal(record.position, POSITION)


def test_whole_numbers_are_numbers(folder):
    savemat("data.mat", {"time": np.arange(5, dtype=np.uint16), "position": np.arange(5, 10)})
    np.testing.assert_array_equal(load_measurement("data.mat").position, [5, 6, 7, 8, 9])


@pytest.mark.parametrize("version", ["older", "newer"])
def test_a_field_of_a_struct_is_named_with_it(folder, version):
    if version == "older":
        savemat("data.mat", {"rig": {"t": TIME, "inner": {"q": POSITION}, "note": "a text"}})
    else:
        newer(folder / "data.mat", {"rig/t": TIME, "rig/inner/q": POSITION})
    columns = {"time": "rig.t", "position": "rig.inner.q"}
    record = load_measurement("data.mat", columns=columns)
    np.testing.assert_array_equal(record.position, POSITION)


def test_vectors_of_another_length_are_left_alone(folder):
    savemat("data.mat", {"t": TIME, "q": POSITION, "a": TIME[:9], "b": TIME[:9], "c": TIME[:9]})
    record = load_measurement("data.mat", columns={"time": "t", "position": "q"})
    assert record.time.size == 100
    with pytest.raises(UnknownNameError, match=r"column of data.mat: 't'"):
        load_measurement("data.mat", columns={"time": "t", "position": "a", "velocity": "b"})


@pytest.mark.parametrize("version", ["older", "newer"])
def test_the_struct_with_the_motion_is_read_and_what_is_not_is_said(folder, version):
    times = TIME[::4]
    content = {
        "pid": {"jointEr": {"time": times, "position": times, "speed": times}},
        "pid_out": {"time": times, "effort": times},
        "motor": {"state": {"time": TIME, "position": POSITION, "effort": TIME}},
        "gains": np.ones(3),
    }
    if version == "older":
        savemat("log.mat", content)
    else:
        newer(folder / "log.mat", dict(flat(content)))
    guess = guess_data("log.mat")
    assert guess.columns["position"] == "motor.state.position"
    assert guess.columns["force"] == "motor.state.effort"
    (said,) = [doubt for doubt in guess.doubts if doubt.startswith("Not read")]
    assert "'pid.jointEr.position'" in said
    assert "gains" not in said


def flat(content, above=""):
    """Yield the paths and values of dictionaries in dictionaries."""
    for name, value in content.items():
        if isinstance(value, dict):
            yield from flat(value, f"{above}{name}/")
        else:
            yield f"{above}{name}", value


@pytest.mark.parametrize("name", ["pid.jointEr.position", "posErr", "pos_err", "PositionError"])
def test_an_error_of_a_controller_is_no_position(folder, name):
    rows = "".join(f"{t},{x},{t}\n" for t, x in zip(TIME, POSITION, strict=True))
    (folder / "a.csv").write_text(f"time,{name},velocity\n{rows}")
    assert set(guess_data("a.csv").columns) == {"time", "velocity"}


def test_a_matlab_file_without_vectors_lists_what_it_has(folder):
    savemat("data.mat", {"K": np.eye(3), "mass": 95.0, "note": "a text"})
    with pytest.raises(InputError) as caught:
        load_measurement("data.mat")
    text = str(caught.value)
    assert "data.mat: contains no numeric vector; contents: K (3 × 3 float64), mass (1 × 1" in text
    assert "note (1 text)" in text


def test_a_new_matlab_file_without_vectors_lists_what_it_has(folder):
    newer(folder / "data.mat", {"K": np.eye(3)})
    with pytest.raises(InputError, match=r"contents: K \(3 × 3 double\)"):
        load_measurement("data.mat")


@pytest.mark.parametrize("start", [b"", b"MATLAB 5.0 MAT-file", b"\x89HDF\r\n\x1a\n"])
def test_what_is_no_matlab_file_is_refused(write, start):
    noise = np.random.default_rng(0).bytes(5000)
    with pytest.raises(InputError, match=r"data\.mat: is not a MATLAB file, or is damaged") as seen:
        load_measurement(write(start + noise, "data.mat"))
    assert "\n" not in str(seen.value)


def test_a_mat_file_cut_short_is_refused(folder):
    savemat("whole.mat", {"time": TIME, "position": POSITION})
    (folder / "data.mat").write_bytes((folder / "whole.mat").read_bytes()[:500])
    with pytest.raises(InputError, match=r"is not a MATLAB file, or is damaged"):
        load_measurement("data.mat")


def test_a_mat_file_whose_bytes_have_shifted_is_refused(folder):
    content = {"rig": {"time": TIME[:9], "q": POSITION[:9]}, "time": TIME, "position": POSITION}
    savemat("whole.mat", content)
    whole = (folder / "whole.mat").read_bytes()
    rng = np.random.default_rng(0)
    for _ in range(300):
        place = int(rng.integers(128, len(whole)))
        again = whole[:place] + whole[place : place + 20] + whole[place:]
        (folder / "data.mat").write_bytes(again)
        # whatever is inserted moves the end of a variable away from where its size says
        with pytest.raises(InputError, match=r"data\.mat: "):
            load_measurement("data.mat")


TAG = struct.pack("<II", 1, 0) + struct.pack("<HH", 16, 4)
"""An empty name, and the tag of a text of four bytes behind it."""


@pytest.mark.parametrize(
    ("whole", "damaged", "reason"),
    [
        # complex numbers without an imaginary part; 6 is the class of doubles
        (struct.pack("<II", 6, 0), struct.pack("<II", 6 + 0x800, 0), "no values"),
        # a name that takes the place of the text
        (TAG, struct.pack("<II", 1, 1) + struct.pack("<HH", 16, 4), "no characters"),
        # a type of text that there is not
        (TAG, struct.pack("<II", 1, 0) + struct.pack("<HH", 89, 4), "no characters"),
    ],
)
def test_a_mat_file_with_which_scipy_ends_the_process_is_refused(whole, damaged, reason):
    file = io.BytesIO()
    savemat(file, {"s": {"time": TIME, "note": "text"}})
    check_structure(file.getvalue())
    assert whole in file.getvalue()
    with pytest.raises(ValueError, match=reason):
        check_structure(file.getvalue().replace(whole, damaged))


@pytest.mark.parametrize("order", ["<", ">"])
def test_cells_texts_and_empty_fields_are_left_alone(folder, order):
    cells = np.array([np.eye(2), "a text", TIME], dtype=object)
    content = {"time": TIME.astype(f"{order}f8"), "position": POSITION, "c": cells}
    savemat("data.mat", {**content, "s": {"a": [], "b": "", "c": 1 + 2j}, "flag": True})
    np.testing.assert_array_equal(load_measurement("data.mat").time, TIME)


# --- several files


def test_several_files_are_trials_called_like_them(write):
    files = [write("time,position\n0,0\n1,1\n", name) for name in ("run 1.csv", "run 2.csv")]
    whole = load_measurement(files, name="both", uncertainty=0.1)
    assert [record.name for record in whole.records()] == ["run 1", "run 2"]
    assert [record.provenance for record in whole.records()] == files
    assert (whole.name, whole.kind) == ("both", "series")
    assert len(load_measurement(files[:1]).trials) == 1


def test_files_of_one_name_are_told_apart_by_their_folders(folder):
    for name in "ab":
        (folder / name).mkdir()
        (folder / name / "run.csv").write_text("time,position\n0,0\n1,1\n")
    whole = load_measurement(["a/run.csv", "b/run.csv"])
    assert [record.name for record in whole.records()] == ["a/run.csv", "b/run.csv"]


def test_rows_of_several_tables_are_trials_of_one_measurement(write):
    files = [write(f"travel\n0.{i}\n0.{i}5\n", f"{i}.csv") for i in (1, 2)]
    assert [r.travel for r in load_measurement(files).records()] == [0.1, 0.15, 0.2, 0.25]


def test_no_files_and_mixed_files_are_refused(write):
    with pytest.raises(InputError, match=r"at least one file"):
        load_measurement([])
    files = [write("travel\n0.1\n", "a.csv"), write("time,position\n0,0\n1,1\n", "b.csv")]
    with pytest.raises(InputError, match=r"of one kind"):
        load_measurement(files)


# --- repair

DISORDERED = "time,position\n0,0\n2,4\n1,1\n1,1\n3,8\n3,10\n"


def test_nothing_is_repaired_unasked_and_the_cure_is_named(write):
    with pytest.raises(InputError, match=r'must increase strictly.*repair="sort"'):
        load_measurement(write(DISORDERED))
    with pytest.raises(ParameterError, match=r'line 3: .*got nothing.*repair="gaps"'):
        load_measurement(write("time,position\n0,0\n1,\n2,4\n"))


def test_samples_are_sorted_and_doubles_resolved_and_counted(write):
    record = load_measurement(write(DISORDERED), repair="sort")
    np.testing.assert_array_equal(record.time, [0, 1, 2, 3])
    np.testing.assert_array_equal(record.position, [0, 1, 4, 9])
    assert record.provenance == (
        "data.csv; sorted by time (2 samples out of order); dropped 1 exact duplicate;"
        " averaged the values at 1 duplicate time"
    )


@pytest.mark.parametrize("apart", [1e-12, 1e-9, 9e-7])
@pytest.mark.parametrize("share", [0.01, 1.0])
def test_no_steps_that_are_nearly_zero_are_left_by_a_repair(write, apart, share):
    rng = np.random.default_rng(1)
    time = np.arange(400) * 1e-3
    again = time[rng.random(400) < share]
    times = rng.permutation(np.concatenate([time, again + apart]))
    rows = "\n".join(f"{t!r},{math.sin(t)!r}" for t in map(float, times))
    record = load_measurement(write(f"time,position\n{rows}\n"), repair="sort")
    assert record.time.size == 400
    assert np.diff(record.time).min() > 0.99e-3  # of 1 ms; an average moves it by half of `apart`
    np.testing.assert_allclose(record.position, np.sin(time), atol=1e-6)
    assert "at nearly the same time (at most" in record.provenance


@pytest.mark.parametrize(
    "time",
    [
        np.arange(300) * 1e-3 + np.random.default_rng(2).uniform(-4e-4, 4e-4, 300),
        np.concatenate([np.arange(300) * 1e-3, 1e4 + np.arange(300) * 1e-3]),
        np.concatenate([burst + np.arange(100) * 1e-6 for burst in (0.0, 0.1, 0.2)]),
    ],
    ids=["jitter", "a long gap", "bursts"],
)
def test_close_samples_of_a_sound_time_base_stay(write, time):
    rows = "\n".join(f"{t!r},{t!r}" for t in map(float, time))
    record = load_measurement(write(f"time,position\n{rows}\n"), repair="sort")
    np.testing.assert_array_equal(record.time, time)


def test_samples_that_are_not_finite_are_dropped_and_counted(write):
    file = write("time,position,force\n0,0,1\n1,,1\n2,4,inf\n,5,1\n4,6,1\n")
    record = load_measurement(file, repair="gaps")
    np.testing.assert_array_equal(record.time, [0, 4])
    assert record.provenance == "data.csv; dropped 3 non-finite samples"


def test_repairs_go_together_in_any_order(write):
    file = write(DISORDERED + "nan,5\n")
    for steps in (["sort", "gaps"], ["gaps", "sort"]):
        assert load_measurement(file, repair=steps).time.size == 4


def test_a_sound_record_is_not_changed_by_repair(write):
    rng = np.random.default_rng(0)
    rows = "\n".join(f"{t!r},{x!r}" for t, x in enumerate(map(float, rng.normal(size=500))))
    file = write(f"time,position\n{rows}\n")
    plain, repaired = load_measurement(file), load_measurement(file, repair=["sort", "gaps"])
    np.testing.assert_array_equal(plain.position, repaired.position)
    assert repaired.provenance == "data.csv"


def test_a_word_is_no_gap(write):
    with pytest.raises(ParameterError, match=r"line 3: must be a finite number, got 'far'"):
        load_measurement(write("time,position\n0,0\n1,far\n2,4\n"), repair="gaps")


@pytest.mark.parametrize(
    ("text", "repair", "message"),
    [
        ("time,position\n0,\n1,nan\n", "gaps", "data.csv: no sample is finite in all columns"),
        ("time,position\n0,1\n0,1\n", "sort", "at least 2 times"),
        ("time,position\n0,1\n,2\n", "sort", 'line 3: .*got nothing.*repair="gaps"'),
        ("velocity,friction\n1,1\n2,2\n", "sort", 'repair="sort" needs a column of times'),
        ("travel\n1\n2\n", "sort", "repair applies to time records"),
        ("time,position\n0,0\n1,1\n", "srt", "unknown repair 'srt'. Did you mean 'sort'"),
    ],
)
def test_what_no_repair_cures_stays_an_error(write, text, repair, message):
    with pytest.raises(InputError, match=message):
        load_measurement(write(text), repair=repair)


def test_a_repaired_record_still_tells_of_its_gap(write):
    rows = [
        f"{t / 100},{np.sin(t / 10)}" if not 50 <= t < 80 else f"{t / 100}," for t in range(200)
    ]
    record = load_measurement(write("time,position\n" + "\n".join(rows) + "\n"), repair="gaps")
    (gap,) = check(record).of("gap")
    assert gap.numbers["samples"] == 30


# --- no tables

NOISE = np.random.default_rng(1).bytes(5_000_000)
PROSE = "It was a bright, cold day in April, and the clocks were striking.\n"

NO_TABLES = {
    "binary": (NOISE, "is a binary file, not a text table"),
    "zeros": (b"\x00" * 1000, "is a binary file"),
    "prose": (PROSE * 300_000, "is not a table: its first 399 rows contain no number"),
    "one line": ("word " * 4_000_000, "is not a table: its first line has .* characters or more"),
    "one line of cells": ("a," * 10_000_000, "is not a table: its first line has"),
    "names": ("1.5,2.5\n" * 10, "its first line holds numbers, not names"),
    "a cell of megabytes": ("time,position\n" + "1" * 5_000_000 + ",1\n", "column 'time'"),
    "web page": ("<!DOCTYPE html>\n<html><body>Not found</body></html>\n", "is not a table"),
}


@pytest.mark.parametrize(("text", "message"), NO_TABLES.values(), ids=NO_TABLES)
def test_what_is_no_table_gives_one_short_message(write, text, message):
    with pytest.raises(InputError, match=message) as caught:
        load_measurement(write(text))
    assert str(caught.value).startswith("data.csv: ")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400


def test_a_single_column_of_numbers_is_a_table(write):
    assert load_measurement(write("travel [mm]\n72\n200\n")).records()[1].travel == 0.2


def test_a_table_with_words_beside_its_numbers_is_read(write):
    file = write("note,time,position\nfirst run,0,0\nstill on,1,1\n")
    assert load_measurement(file).time.size == 2


def struct_array(rows):
    """Return a MATLAB struct array of rows with the same fields."""
    found = np.empty((1, len(rows)), dtype=[(name, object) for name in rows[0]])
    for i, row in enumerate(rows):
        for name, value in row.items():
            found[0, i][name] = value
    return found


EITHER = pytest.mark.parametrize(
    "save", [savemat, lambda name, content: newer(Path(name), content)], ids=["v5", "v7.3"]
)


@EITHER
def test_channels_of_dspace_have_their_own_names_and_units(folder, save):
    force = 3.0 * POSITION
    x = struct_array([{"Name": "", "Type": "", "Data": TIME[None, :], "Unit": ""}])
    y = struct_array(
        [
            {"Name": '"Model Root"/"Encoder"/"angle"', "Data": POSITION[None, :], "Unit": "deg"},
            {"Name": "torque", "Data": force[None, :], "Unit": "Nm"},
        ]
    )
    save("data.mat", {"exp_001": {"X": x, "Y": y, "RTProgram": "rig"}})
    record = load_measurement("data.mat", columns={"position": "angle", "force": "torque"})
    np.testing.assert_array_equal(record.time, TIME)
    np.testing.assert_allclose(record.position, np.deg2rad(POSITION), rtol=1e-12)
    np.testing.assert_allclose(record.force, force, rtol=1e-12)


@EITHER
@pytest.mark.parametrize("count", [1, 2])
def test_signals_of_simulink_are_known_by_their_labels(folder, count, save):
    signals = [
        {"values": POSITION[:, None], "dimensions": 1.0, "label": "angle"},
        {"values": np.column_stack([POSITION, -POSITION]), "dimensions": 2.0, "label": "mux"},
    ]
    content = {"time": TIME[:, None], "signals": struct_array(signals[:count]), "blockName": "m"}
    save("data.mat", {"out": content})
    columns = {"time": "out.time", "position": "mux 2" if count == 2 else "angle"}
    record = load_measurement("data.mat", columns=columns)
    np.testing.assert_array_equal(record.position, (-1.0) ** (count - 1) * POSITION)


@EITHER
def test_a_matrix_of_signals_is_read_by_its_rows(folder, save):
    t = np.arange(0.0, 2.0, 0.01)
    save("data.mat", {"data": np.vstack([t, np.sin(t)])})
    record = load_measurement("data.mat", columns={"time": "data 1", "position": "data 2"})
    np.testing.assert_array_equal(record.position, np.sin(t))


@EITHER
@pytest.mark.parametrize("turned", [False, True])
def test_a_matrix_of_signals_is_read_beside_a_vector_of_their_times(folder, save, turned):
    out = np.column_stack([POSITION, 2 * POSITION])
    save("data.mat", {"time": TIME[:, None], "out": out.T if turned else out, "K": np.eye(3)})
    record = load_measurement("data.mat", columns={"position": "out 2"})
    np.testing.assert_array_equal(record.position, 2 * POSITION)
    with pytest.raises(InputError, match=r"the columns are 'time', 'out 1', 'out 2'\. Name it"):
        guess_data("data.mat")


# What a file holds and a table has not.

ROWS = [f"{t:.3f},{x:.6f}" for t, x in zip(TIME, POSITION, strict=True)]


@pytest.mark.parametrize(
    ("rows", "end", "size", "said"),
    [
        (ROWS, "", 100, ""),
        ([*ROWS[:-1], "0.990,0.8"], "\n", 100, ""),
        ([*ROWS[:-1], "0.990,0.8"], "", 99, "ends within a number, '0.8', which has fewer digits"),
        ([f"{x:.3e}" for x in POSITION[:-1]] + ["8.360e-0"], "", 99, "ends within a number"),
        ([*map(repr, POSITION.tolist())], "", 100, ""),
        ([f"{row}," for row in ROWS], "\n", 100, ""),
        ([f"{row}," + "7" * (k == 60) for k, row in enumerate(ROWS)], "\n", 100, "1 row has more"),
    ],
)
def test_what_a_text_holds_beyond_its_table_is_said(write, rows, end, size, said):
    head = "time,position" if "," in rows[0] else "position"
    if head == "position":
        rows = [f"{t},{row}" for t, row in zip(TIME, rows, strict=True)]
    read = load_measurement(write("time,position\n" + "\n".join(rows) + end))
    assert read.time.size == size
    assert [said in one for one in read.lost] == [True] * bool(said)
    assert [finding.severity for finding in check(read).of("lost")] == ["warning"] * bool(said)


SCOPE = (
    "Name;P\nStarttime of export;13\n\n"
    "Name;Pos;Name;Torque\nSampleTime[ms];2;;2\nUnit;mm;Unit;N\n\n"
)
FRANKA = "time, success_rate, state.q[0]\n"
STEPS = "Step No. 1\nFx,T\ng,sec\n\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"{SCOPE}0;0,5;0;1;7\n2;0,75;2;1,5;\n", "1 row has more cells than the header has names"),
        (f"{SCOPE}0;0,5;0;1;\n2;0,75;2;1,5;\n", ""),
        (f"{SCOPE}0;0,5;0;1\n;0,75;2;1,5\n", "1 row of 'Pos' without a time"),
        (f"{SCOPE}0;0,5;0;1\n;;2;1,5\n", ""),
        (f"{FRANKA}7,1,0.5,9\n8,1,0.6,9\n", "2 rows have more cells than the header has names"),
        (f"{FRANKA}7,1,0.5,\n8,1,0.6,\n", ""),
        (f"{STEPS}1,0\n2,1\noverload\n3,2\n4,3\n", "2 rows below no names of columns"),
        (f"{STEPS}1,0\n2,1\n", ""),
    ],
)
def test_what_a_log_of_an_instrument_holds_beyond_its_table_is_said(write, text, said):
    table = read_text(Path(write(text)))
    assert len(table.data) == 2
    assert [said in one for one in table.lost] == [True] * bool(said)


def test_samples_that_a_header_of_labview_announces_are_missed(write):
    head = (
        "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\n***End_of_Header***\t\n\n"
        "Channels\t1\nSamples\t400\nY_Unit_Label\tmm\n***End_of_Header***\t\nX_Value\tWeg\n"
    )
    rows = "".join(f"{t}\t{x}\n" for t, x in zip(TIME, POSITION, strict=True))
    found = guess_data(write(head + rows, "a.lvm"))
    (said,) = [doubt for doubt in found.doubts if "states 400 samples" in doubt]
    read = load_measurement("a.lvm", columns=found.columns, units=found.units)
    assert read.lost == (said,)
    assert [finding.severity for finding in check(read).of("lost")] == ["warning"]


def test_a_table_has_no_more_columns_than_can_be_looked_at(write):
    names = ",".join(f"x{k}" for k in range(14_000))
    rows = "\n".join([",".join(["1"] * 14_000)] * 3)
    write(f"{names}\n{rows}\n")
    for read in (load_measurement, guess_data):
        with pytest.raises(InputError, match=r"1\.4e\+04 columns exceed the limit of 4096"):
            read("data.csv")


def test_a_footer_of_parquet_that_contradicts_itself_is_refused(write):
    import pyarrow as pa
    import pyarrow.parquet as pq

    out = io.BytesIO()
    pq.write_table(pa.table({"time": np.arange(200) / 100, "position": np.ones(200)}), out)
    data, rows = out.getvalue(), b"\x90\x03"  # 200, as the footer writes it
    length = struct.unpack("<I", data[-8:-4])[0]
    place = data.index(rows, len(data) - 8 - length)
    wrong = write(data[:place] + b"\x90\x00" + data[place + 2 :], "a.parquet")
    with pytest.raises(InputError, match="its footer announces"):
        load_measurement(wrong)


@pytest.mark.parametrize("newer", [False, True], ids=["level 5", "HDF5"])
def test_cells_of_matrices_are_trials_with_their_columns(tmp_path, newer):
    times = [0.01 * np.arange(n) for n in (300, 250)]
    parts = [np.stack([t, 0.1 * np.sin(t)], axis=1) for t in times]
    path = tmp_path / "cells.mat"
    if newer:
        h5py = pytest.importorskip("h5py")
        with h5py.File(path, "w") as file:
            cells = file.create_dataset("run", (2, 1), dtype=h5py.ref_dtype)
            cells.attrs["MATLAB_class"] = np.bytes_("cell")
            for i, part in enumerate(parts):
                kept = file.create_dataset(f"#refs#/{i}", data=part.T)
                kept.attrs["MATLAB_class"] = np.bytes_("double")
                cells[i, 0] = kept.ref
    else:
        cell = np.empty((1, 2), dtype=object)
        cell[0, :] = parts
        savemat(path, {"run": cell, "rate": 100.0})
    read = load_measurement(path, columns={"time": "run 1", "position": "run 2"})
    assert [trial.time.size for trial in read.trials] == [300, 250]
    for trial, part in zip(read.trials, parts, strict=True):
        np.testing.assert_array_equal(trial.position, part[:, 1])
