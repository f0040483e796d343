"""The entries: complete, consistent in themselves, and lighter than what they lead to."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from tests.support import for_all

from stickslip.data import QUANTITIES, catalogue
from stickslip.errors import InputError, UnknownNameError

RECORDS = [catalogue.dataset(name) for name in catalogue.names()]
MEASURED = [record for record in RECORDS if record.kind == "measured"]
FETCHED = [record for record in MEASURED if record.commit]
SHA256 = re.compile(r"[0-9a-f]{64}")


def test_names_are_in_order_and_hold_measured_and_simulated_records():
    assert list(catalogue.names()) == sorted(catalogue.names())
    assert {record.kind for record in RECORDS} == {"measured", "reference simulation"}
    assert [record.name for record in MEASURED] == [
        "bam_xl330",
        "emps",
        "reciprocating_tribometer",
        "rock_velocity_step",
        "schunk_arm",
        "simple_pendulum_drive",
        "spring_pulled_slider",
        "staubli_tx40",
        "two_link_arm",
    ]


@for_all(RECORDS)
def test_a_record_says_whose_it_is_and_under_which_licence(record):
    assert record.title
    assert record.citation
    assert record.licence
    assert re.fullmatch(r"[\w.-]+/[\w.-]+", record.repository)
    assert record.files
    assert record.columns


def test_all_measured_records_but_those_of_robots_and_servos_can_be_fetched():
    held = [one.name for one in MEASURED if one not in FETCHED]
    assert held == [
        "bam_xl330",
        "schunk_arm",
        "simple_pendulum_drive",
        "staubli_tx40",
        "two_link_arm",
    ]


@for_all(FETCHED)
def test_a_measured_record_can_be_fetched_and_converted(record):
    assert re.fullmatch(r"[0-9a-f]{40}", record.commit)
    assert record.format in {"mat", "tsv"}
    assert all(column.source for column in record.columns)
    assert all(SHA256.fullmatch(file.source_sha256) for file in record.files.values())


@for_all(MEASURED)
def test_columns_are_quantities_of_a_measurement_each_once(record):
    quantities = [column.quantity for column in record.columns if column.quantity]
    assert {name.partition(".")[0] for name in quantities} <= {"time", *QUANTITIES}
    assert "time" in quantities
    assert len(quantities) == len(set(quantities)) >= 2


@for_all(file for record in RECORDS for file in record.files.values())
def test_a_part_says_how_many_rows_it_has(file):
    assert file.about
    assert file.rows is not None or not file.part
    assert not file.sha256 or SHA256.fullmatch(file.sha256)


def test_a_record_without_a_licence_is_said_to_be_one():
    unlicensed = [one.name for one in RECORDS if one.licence.startswith("none stated: read, never")]
    assert unlicensed == [
        "emps",
        "modelica_brake",
        "modelica_coupled_clutches",
        "modelica_friction",
    ]


def test_the_package_holds_entries_and_no_records():
    folder = Path(catalogue.__path__[0])
    assert {path.suffix for path in folder.rglob("*") if path.is_file()} <= {
        ".py",
        ".pyc",
        ".pyi",
        ".toml",
    }


def test_an_unknown_record_lists_the_nearest():
    with pytest.raises(UnknownNameError, match=r"'emsp'\. Did you mean 'emps'\?"):
        catalogue.dataset("emsp")


def test_a_reference_simulation_is_no_measurement():
    with pytest.raises(InputError, match="modelica_brake is a reference simulation"):
        catalogue.dataset("modelica_brake").measurement()


def test_reading_the_catalogue_loads_no_library_of_data_or_networks():
    code = (
        "from stickslip.data import catalogue; import sys;"
        "[catalogue.dataset(name).place() for name in catalogue.names()]; print(*sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert {"pandas", "pooch", "pyarrow", "requests", "scipy"}.isdisjoint(run.stdout.split())
