"""The records themselves, where they are: as described, converted bit for bit, physically right."""

import dataclasses
import json

import numpy as np
import pandas as pd
import pytest
from tests.upstream import matlab_file, sha256

from stickslip.data import catalogue
from stickslip.data.catalogue import CacheLocation

RECORDS = [catalogue.dataset(name) for name in catalogue.names()]
TABLES = [
    (record.name, file.name) for record in RECORDS for file in record.files.values() if file.sha256
]


@pytest.fixture(autouse=True)
def real(data_dir, monkeypatch, tmp_path):
    """The folder of records is there; nothing else can be had."""
    monkeypatch.setenv("STICKSLIP_DATA_URL", "http://127.0.0.1:9")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def offered(monkeypatch, record, file, content):
    """Return a record whose upstream file was put into the cache by hand."""
    monkeypatch.delenv("STICKSLIP_DATA")
    known = dataclasses.replace(record.file(file), source_sha256=sha256(content))
    record.folder().mkdir(parents=True)
    (record.folder() / known.source.rpartition("/")[2]).write_bytes(content)
    return dataclasses.replace(record, files={file: known})


@pytest.mark.parametrize(("name", "file"), TABLES)
def test_a_table_is_the_known_one_with_the_columns_of_its_entry(name, file):
    record = catalogue.dataset(name)
    assert record.place(file) is CacheLocation.LOCAL
    table = pd.read_parquet(record.path(file))  # another checksum would warn, which is an error
    assert list(table) == [column.name for column in record.columns]
    assert len(table) == record.file(file).rows


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.name)
def test_an_entry_agrees_with_the_description_beside_the_record(record, data_dir):
    about = json.loads((data_dir / record.name / "dataset.json").read_text("utf-8"))
    assert record.kind == about["kind"]
    tables = {file.file_name: file.sha256 for file in record.files.values() if file.sha256}
    described = about.get("files", {})
    assert set(tables) == set(described)
    stated = {name: table["sha256"] for name, table in described.items() if "sha256" in table}
    assert stated in ({}, tables)
    upstream = about.get("upstream", {"repository": record.repository, "commit": "", "files": {}})
    assert record.repository == upstream["repository"]
    sources = {file.source: file.source_sha256 for file in record.files.values() if file.source}
    if sources:  # else the catalogue cannot fetch it
        assert record.commit == upstream["commit"]
        assert sources == upstream["files"]


def test_the_text_of_the_tribometer_converts_to_the_known_table_bit_for_bit(monkeypatch, tmp_path):
    record = catalogue.dataset("reciprocating_tribometer")
    known = pd.read_parquet(record.path("train"))
    # The numbers upstream: micronewtons and millimetres, of which the table is a multiple.
    lines = [
        f"{t:g}\t{1e6 * normal:.1f}\t{1e3 * x:.4f}\t{1e6 * friction:.1f}"
        for t, normal, x, friction in known.itertuples(index=False)
    ]
    text = "\n".join(
        ["Time [s]\tNormal [uN]\tPosition [mm]\tFriction [uN]", *lines, "200\t0\t0\t0"]
    )
    again = offered(monkeypatch, record, "train", text.encode())
    pd.testing.assert_frame_equal(pd.read_parquet(again.path()), known, check_exact=True)


def test_the_variables_of_the_axis_convert_to_the_known_table_bit_for_bit(monkeypatch):
    record = catalogue.dataset("emps")
    known = pd.read_parquet(record.path())
    columns = {"t": "t_s", "qg": "q_ref_m", "qm": "q_meas_m", "vir": "ctrl_V"}
    content = matlab_file(**{key: known[name].to_numpy() for key, name in columns.items()})
    again = offered(monkeypatch, record, "train", content)
    pd.testing.assert_frame_equal(pd.read_parquet(again.path()), known, check_exact=True)


def test_the_volts_of_the_axis_become_the_force_of_its_drive():
    record = catalogue.dataset("emps")
    measurement = record.measurement()
    assert set(measurement.quantities()) == {"position", "reference", "force"}
    force = pd.read_parquet(record.path())["force_N"]
    np.testing.assert_array_equal(measurement.force, force)  # the same product


def test_friction_of_the_tribometer_dissipates_under_its_load():
    record = catalogue.dataset("reciprocating_tribometer").measurement()
    loaded = record.time > 9.6  # as the notes say
    x, friction = record.position[loaded], record.friction[loaded]
    work = np.sum((friction[1:] + friction[:-1]) / 2 * np.diff(x))
    # At most the largest friction over the whole way, and most of it: loops are nearly rectangles.
    most = np.max(np.abs(friction)) * np.sum(np.abs(np.diff(x)))
    assert 0.3 * most < work < most
    assert np.mean(record.load[loaded]) == pytest.approx(5.0, rel=1e-3)  # stated as 5 N
    assert np.ptp(x) == pytest.approx(0.23e-3, abs=0.005e-3)  # stated with two digits


def test_the_spring_of_the_slider_is_drawn_at_its_stiffness_and_speed():
    record = catalogue.dataset("spring_pulled_slider")
    known = record.file("k168_v42").known
    measurement = record.measurement("k168_v42")
    time, force = measurement.time, measurement.spring_force
    slope = (force[400:] - force[:-400]) / (time[400:] - time[:-400])  # over 0.2 s; it sticks 1.5 s
    expected = known["stiffness_N_per_m"] * known["speed_m_per_s"]
    assert np.median(slope) == pytest.approx(expected, rel=0.09)  # published: within 4 to 9 %


def test_the_rock_is_driven_at_the_two_speeds_of_its_title():
    record = catalogue.dataset("rock_velocity_step")
    measurement = record.measurement()
    assert measurement.load == 1.0
    time, pull = measurement.time - measurement.time[0], measurement.pull
    for part, key in (
        (time < 400.0, "speed_before_m_per_s"),
        (time > time[-1] - 300.0, "speed_after_m_per_s"),
    ):
        speed = np.polyfit(time[part], pull[part], 1)[0]
        assert speed == pytest.approx(record.known[key], rel=0.025)  # stated with one digit or two
