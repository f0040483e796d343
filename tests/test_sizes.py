"""What is small to write and large to hold is refused before memory is taken for it."""

import math
import struct
import zlib
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from stickslip import (
    Axis,
    BlockChain,
    Coulomb,
    LuGre,
    SpringBlock,
    check,
    ensemble,
    load_measurement,
    simulate,
)
from stickslip.cli import main
from stickslip.data import LawEstimates, Measurement
from stickslip.engine.solver import EventDriven, IncrementalEnsemble
from stickslip.errors import InputError, ParameterError, check_size
from stickslip.mechanisms.drives import Sine
from stickslip.study.sweep import average_velocity, band_of

MANY = 10**9
TIME = np.arange(200) / 100
BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)
COLUMNS = {"columns": {"time": "t", "position": "q"}}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def of_hdf5(fill):
    """Write a MATLAB file of version 7.3."""
    with h5py.File("data.mat", "w") as file:
        file["t"], file["q"] = TIME, np.sin(TIME)
        fill(file)


def linked(file, link):
    group = file.create_group("s")
    for i in range(60):  # which five levels deep are 8e8 groups
        group[f"l{i}"] = link(group)


@pytest.mark.parametrize("kind", ["hard", "soft"])
def test_a_group_that_contains_itself_is_entered_once(kind):
    of_hdf5(lambda file: linked(file, lambda s: s if kind == "hard" else h5py.SoftLink("/s")))
    np.testing.assert_array_equal(load_measurement("data.mat", **COLUMNS).time, TIME)


@pytest.mark.parametrize("count", [1, 300])
def test_vectors_that_take_no_place_in_a_file_are_refused(count):
    size = 3 * MANY // count

    def fill(file):
        for i in range(count):
            file.create_dataset(f"x{i}", shape=(size,), chunks=(10**6,), dtype="f8")

    of_hdf5(fill)
    with pytest.raises(InputError, match=r"data\.mat: 3e\+09 numbers exceed the limit of 1e\+08"):
        load_measurement("data.mat", **COLUMNS)


def test_a_matrix_that_is_no_column_is_not_read_at_all():
    of_hdf5(lambda f: f.create_dataset("K", shape=(MANY, 2), chunks=(1000, 2), dtype="f8"))
    assert load_measurement("data.mat", **COLUMNS).time.size == 200


def test_links_to_other_files_are_not_followed():
    with h5py.File("other.mat", "w") as file:
        file["t"], file["q"] = TIME, np.sin(TIME)
    with h5py.File("data.mat", "w") as file:
        file["t"], file["q"] = (h5py.ExternalLink("other.mat", name) for name in "tq")
    with pytest.raises(InputError, match=r"contents: q \(link to other\.mat\) and t \(link"):
        load_measurement("data.mat", **COLUMNS)


@pytest.mark.parametrize("kind", ["virtual", "external"])
def test_values_that_lie_in_another_file_are_not_read(kind):
    Path("raw").write_bytes(TIME.tobytes())

    def fill(file):
        del file["q"]
        if kind == "external":
            file.create_dataset("q", (200,), "f8", external=[("raw", 0, 1600)])
        else:
            layout = h5py.VirtualLayout((200,), "f8")
            layout[:] = h5py.VirtualSource("other.mat", "t", (200,))
            file.create_virtual_dataset("q", layout)

    of_hdf5(fill)
    with pytest.raises(InputError, match="the values of q are in another file"):
        load_measurement("data.mat", **COLUMNS)


def element(kind, body, size=None):
    size = len(body) if size is None else size
    return struct.pack("<II", kind, size) + body + b"\0" * (-len(body) % 8)


def compressed(says, holds):
    """Return a MATLAB file of version 7 with one compressed vector of bytes."""
    head = element(6, struct.pack("<II", 9, 0)) + element(5, struct.pack("<ii", says, 1))
    head += element(1, b"q") + struct.pack("<II", 2, says)
    packer = zlib.compressobj(9)
    start = struct.pack("<II", 14, len(head) + says + -says % 8) + head
    block = bytes(10**6)
    data = packer.compress(start) + b"".join(packer.compress(block) for _ in range(holds))
    data += packer.flush()
    begin = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    return begin + struct.pack("<II", 15, len(data)) + data


@pytest.mark.parametrize(
    ("says", "holds", "message"),
    [
        (3 * MANY // 2, 1, r"1\.5e\+09 expanded bytes exceed the limit of 8e\+08"),
        (10**6, 90, "a compressed variable is larger than it says"),
    ],
)
def test_a_compressed_variable_that_grows_is_refused(says, holds, message):
    Path("data.mat").write_bytes(compressed(says, holds))
    with pytest.raises(InputError, match=message):
        load_measurement("data.mat", **COLUMNS)


def test_small_bytes_that_become_many_numbers_are_counted():
    file = compressed(6 * 10**7, 60)
    Path("data.mat").write_bytes(file + file[128:])
    with pytest.raises(InputError, match=r"1\.2e\+08 numbers exceed"):
        load_measurement("data.mat", **COLUMNS)


def test_rows_of_a_parquet_file_are_counted_in_its_footer():
    part = pa.table({"t": np.zeros(10**7), "q": np.zeros(10**7)})
    with pq.ParquetWriter("data.parquet", part.schema, compression="zstd") as file:
        for _ in range(6):
            file.write_table(part)
    assert Path("data.parquet").stat().st_size < 10**6
    with pytest.raises(InputError, match=r"data\.parquet: 1\.2e\+08 numbers exceed the limit"):
        load_measurement("data.parquet", **COLUMNS)


def test_a_text_that_a_parquet_file_repeats_is_held_once():
    repeated = pa.DictionaryArray.from_arrays(np.zeros(5000, dtype="i4"), ["x" * 10**6])
    column = pa.chunked_array([repeated])
    pq.write_table(
        pa.table({"t": np.arange(5000.0), "q": np.zeros(5000), "n": column}), "d.parquet"
    )
    found = load_measurement("d.parquet", **COLUMNS)
    assert found.time.size == 5000


def test_texts_of_a_parquet_file_are_read_as_before():
    table = pd.DataFrame({"t": TIME, "q": np.sin(TIME), "note": ["a", None] * 100})
    table.to_parquet("data.parquet")
    assert load_measurement("data.parquet", **COLUMNS).time.size == 200


@pytest.fixture
def logged():
    """Return an MDF file with one compressed block, and where its sizes stand."""
    asammdf = pytest.importorskip("asammdf")
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(np.sin(TIME), TIME, name="q")])
        file.save("whole.mf4", overwrite=True, compression=1)
    with asammdf.MDF("whole.mf4") as file:
        group = file.groups[0].channel_group.address
    data = bytearray(Path("whole.mf4").read_bytes())
    return data, data.find(b"##DZ") + 32, data.find(struct.pack("<Q", len(TIME)), group)


@pytest.mark.parametrize(
    ("which", "says", "message"),
    [
        (1, 3 * MANY, r"3e\+09 expanded bytes exceed the limit"),
        (1, 1600, "a compressed block is larger than it says"),
        (2, MANY, r"2e\+09 numbers exceed the limit of 1e\+08"),
    ],
)
def test_what_a_logger_compressed_or_counted_beyond_measure_is_refused(
    logged, which, says, message
):
    data = logged[0]
    struct.pack_into("<Q", data, logged[which], says)
    Path("data.mf4").write_bytes(data)
    with pytest.raises(InputError, match=message):
        load_measurement("data.mf4")


def test_a_header_of_many_names_above_short_rows_is_refused():
    names = ",".join(f"a{i}" for i in range(2000))
    Path("data.csv").write_text(f"{names}\n" + "1,2\n" * 60_000)
    with pytest.raises(InputError, match=r"data\.csv: 1\.2e\+08 numbers exceed the limit"):
        load_measurement("data.csv", columns={"time": "a0", "position": "a1"})


def test_a_file_that_is_larger_than_any_table_is_not_opened():
    with Path("data.csv").open("wb") as file:
        file.truncate(200 * MANY)  # which takes no place where files may have holes
    with pytest.raises(InputError, match=r"data\.csv: 2e\+11 bytes exceed the limit of 1\.6e\+09"):
        load_measurement("data.csv", **COLUMNS)


def test_a_record_whose_times_leap_is_told_so():
    time = np.append(TIME, 1e9)
    pulled = Measurement(time=time, position=np.append(np.sin(TIME), 0.0), name="leap")
    assert check(pulled).findings  # and no memory error


SINE = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=1e6))
KNOWN = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.24, 0.26)})
WIDE = np.broadcast_to(0.25, MANY)


@pytest.mark.parametrize(
    "call",
    [
        lambda: ensemble(BLOCK, LAW, {"kinetic_coefficient": WIDE}, t_end=1.0),
        lambda: band_of(BLOCK, LAW, KNOWN, t_end=1.0, count=MANY),
        lambda: band_of(SINE, LAW, KNOWN, t_end=1e6, count=2),
        lambda: KNOWN.draw(LAW, MANY),
        lambda: simulate(BLOCK, LAW, t_end=1.0).sampled(10**12),
        lambda: simulate(BLOCK, LAW, t_end=1.0).at(WIDE),
        lambda: average_velocity(
            SINE, LAW, {"inertia": np.arange(1.0, 1e5), "stiffness": np.arange(1.0, 1e5)}
        ),
        lambda: IncrementalEnsemble(BLOCK, LAW, count=MANY, solver=EventDriven()),
    ],
)
def test_more_numbers_than_are_held_at_once_are_refused_at_once(call):
    with pytest.raises(InputError, match=r"exceed the limit of 1e\+08"):
        call()


@pytest.mark.parametrize("blocks", [MANY, 1e9, 1001])
def test_a_chain_of_very_many_blocks_is_refused(blocks):
    with pytest.raises(ParameterError, match="at most 1000, got"):
        BlockChain(blocks=blocks, mass=1.0, coupling=4.0, stiffness=1.0)


RIG = """
[mechanism]
type = "spring-block"
mass = "1 kg"
stiffness = "100 N/m"
compression = "100 mm"
[run]
t_end = "1 s"
[friction]
kinetic_coefficient = 0.25
"""


@pytest.mark.parametrize(
    "arguments",
    [
        ("simulate", "rig.toml", "-o", "run.csv", "--samples", "1000000000000"),
        ("sweep", "rig.toml", "--vary", "mechanism.mass=1:2:1000000000000"),
    ],
)
def test_the_command_line_says_so_in_one_message(arguments, capsys):
    Path("rig.toml").write_text(RIG)
    try:
        code = main([*arguments])
    except SystemExit as leaving:
        code = leaving.code
    seen = capsys.readouterr()
    assert code == 2
    assert "exceed the limit of 1e+08" in " ".join(seen.err.split())
    assert "Traceback" not in seen.err


@pytest.mark.parametrize("count", [math.nan, math.inf, 1e8 + 1])
def test_what_is_no_number_of_numbers_is_too_many(count):
    check_size("table", 1e8, "split it")
    with pytest.raises(InputError, match=r"table: .* exceed the limit of 1e"):
        check_size("table", count, "split it")


@pytest.mark.parametrize(
    ("field", "value"),
    [("bristle_stiffness", 1e300), ("bristle_stiffness", 1e120), ("stribeck_velocity", 1e-300)],
)
def test_a_parameter_whose_square_is_no_number_is_refused(field, value):
    # a bristle of 1e120 was run from one equilibrium into another that does not exist
    given = {
        "kinetic_coefficient": 0.25,
        "static_coefficient": 0.35,
        "stribeck_velocity": 1e-3,
        "bristle_stiffness": 1e5,
        "bristle_damping": 1.0,
    }
    with pytest.raises(ParameterError, match=r"between 1e-100 and 1e\+100, got 1e"):
        LuGre(**{**given, field: value})
