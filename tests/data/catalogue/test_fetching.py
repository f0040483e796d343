"""Where tables come from: the user's folder, the cache, upstream; whole, checked, or not at all."""

import dataclasses
import os
import sys

import numpy as np
import pandas as pd
import pytest
from tests.upstream import (
    COMMIT,
    MATLAB,
    REPOSITORY,
    SPEEDS,
    TEXT,
    TIMES,
    matlab_file,
    matlab_record,
    sha256,
    text_record,
)

from stickslip.data.catalogue import CacheLocation, DataFile, cache_folder
from stickslip.errors import InputError, UnknownNameError


def kept():
    """Files in the cache."""
    return sorted(path.name for path in cache_folder().rglob("*") if path.is_file())


def complaint(record, file=None):
    with pytest.raises(InputError) as caught:
        record.path(file)
    return str(caught.value)


def own_folder(monkeypatch, tmp_path, content):
    """Name a folder of data that has the start of the slide."""
    path = tmp_path / "own" / "slide" / "start.parquet"
    path.parent.mkdir(parents=True)
    path.write_bytes(content)
    monkeypatch.setenv("STICKSLIP_DATA", str(tmp_path / "own"))
    return path


def test_a_text_is_downloaded_and_converted_to_the_columns_of_its_entry(upstream):
    table = pd.read_parquet(text_record().path("all"))
    assert list(table) == ["t_s", "friction_N"]
    np.testing.assert_array_equal(table["t_s"], [0.0, 0.1, 0.2, 0.3, 0.4, 0.5])
    # one product of the number as it is printed: no bit may differ
    assert list(table["friction_N"]) == [(100.1 + i) * 1e-6 for i in range(6)]
    assert upstream.asked == [f"/{REPOSITORY}/{COMMIT}/data/a%20slide.txt"]


def test_variables_of_a_matlab_file_become_columns_with_their_precision(upstream):
    table = pd.read_parquet(matlab_record().path())
    assert list(table) == ["t_s", "v", "v_mm_s"]
    np.testing.assert_array_equal(table["t_s"], TIMES)
    np.testing.assert_array_equal(table["v"], SPEEDS)
    assert table["v"].dtype == np.float32
    np.testing.assert_array_equal(table["v_mm_s"], [0.0, 1000.0, 1500.0, 1500.0, 500.0, 0.0])


def test_a_part_is_the_first_rows_of_the_whole(upstream):
    record = text_record()
    start, whole = pd.read_parquet(record.path("start")), pd.read_parquet(record.path("all"))
    assert len(start) == 4
    pd.testing.assert_frame_equal(start, whole.head(4))


def test_the_first_file_is_taken_where_none_is_named(upstream):
    assert text_record().path().name == "start.parquet"


def test_the_second_call_downloads_nothing(upstream):
    record = text_record()
    first = record.path("all")
    assert record.path("all") == first
    record.path("start")  # from the same upstream file
    assert len(upstream.asked) == 1


def test_a_table_is_found_again_without_a_network(upstream, monkeypatch):
    first = text_record().path()
    monkeypatch.setenv("STICKSLIP_DATA_URL", "http://127.0.0.1:9")
    assert text_record().path() == first


def test_only_a_download_is_reported(upstream):
    said = []
    record = text_record()
    record.path(report=said.append)
    record.path(report=said.append)
    assert len(said) == 1
    assert said[0].startswith("Downloading a slide.txt from http://127.0.0.1")


def test_another_commit_is_another_file(upstream):
    old = text_record()
    later = dataclasses.replace(old, commit="f" * 40)
    upstream.files[f"/{REPOSITORY}/{later.commit}/data/a%20slide.txt"] = TEXT.encode()
    assert old.path() != later.path()
    assert len(upstream.asked) == 2


def test_a_wrong_checksum_is_an_error_and_leaves_nothing_behind(upstream):
    record = text_record(known=b"what the catalogue knows")
    message = complaint(record)
    assert "differs from the file in the catalogue" in message
    assert sha256(TEXT.encode()) in message
    assert sha256(b"what the catalogue knows") in message
    assert kept() == []


def test_without_a_network_the_error_says_what_to_get_where_and_where_to_put_it(
    upstream, monkeypatch
):
    monkeypatch.setenv("STICKSLIP_DATA_URL", "http://127.0.0.1:9")  # nobody listens there
    record = text_record()
    message = complaint(record)
    assert "a slide.txt could not be downloaded" in message
    assert "no connection" in message
    assert f"https://github.com/{REPOSITORY}/raw/{COMMIT}/data/a%20slide.txt" in message
    assert str(record.folder()) in message
    assert kept() == []


def test_a_file_put_there_by_hand_is_converted_without_a_network(upstream, monkeypatch):
    monkeypatch.setenv("STICKSLIP_DATA_URL", "http://127.0.0.1:9")
    record = text_record()
    record.folder().mkdir(parents=True)
    (record.folder() / "a slide.txt").write_text(TEXT, encoding="utf-8", newline="")
    assert record.place("all") is CacheLocation.CACHED
    assert len(pd.read_parquet(record.path("all"))) == 6


def test_another_file_put_there_by_hand_is_not_believed(upstream):
    record = text_record()
    record.folder().mkdir(parents=True)
    (record.folder() / "a slide.txt").write_text("t\tF\n0\t1\n", encoding="utf-8")
    assert len(pd.read_parquet(record.path("all"))) == 6
    assert len(upstream.asked) == 1


def test_a_missing_upstream_file_is_named_with_the_answer_of_the_server(upstream):
    upstream.files.clear()
    assert "the server answered 404" in complaint(text_record())
    assert kept() == []


def test_a_download_that_breaks_off_leaves_nothing_behind(upstream):
    upstream.breaks_off = True
    assert "the connection was interrupted" in complaint(text_record())
    assert kept() == []
    upstream.breaks_off = False
    assert len(pd.read_parquet(text_record().path("all"))) == 6


def test_a_cancelled_download_leaves_nothing_behind(upstream, monkeypatch):
    def cancelled(path):
        raise KeyboardInterrupt

    monkeypatch.setattr(sys.modules["stickslip.data.catalogue.datasets"], "sha256_of", cancelled)
    with pytest.raises(KeyboardInterrupt):
        text_record().path()
    assert len(upstream.asked) == 1
    assert kept() == []


def test_a_conversion_that_fails_keeps_the_upstream_file_and_no_table(upstream, monkeypatch):
    def full(self, path, **settings):
        path.write_bytes(b"PAR1")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pd.DataFrame, "to_parquet", full)
    with pytest.raises(OSError, match="No space"):
        text_record().path()
    assert kept() == ["a slide.txt"]


def test_others_may_read_what_one_has_downloaded(upstream):
    path = text_record().path()
    assert path.stat().st_mode & 0o044 == 0o044 or os.name == "nt"


@pytest.mark.parametrize(
    ("content", "fragment"),
    [
        (b"t\tF\n0\tone\n", "could not convert string 'one'"),
        (b"t\n0\n", "'2' is missing; the file contains 1"),
    ],
)
def test_a_text_of_another_form_is_an_error_of_the_entry(upstream, content, fragment):
    upstream.offer("data/a%20slide.txt", content)
    message = complaint(text_record(content))
    assert fragment in message
    assert "the catalogue entry is wrong" in message
    assert kept() == ["a slide.txt"]


def test_a_matlab_file_without_a_variable_is_an_error_that_lists_the_others(upstream):
    content = matlab_file(t=TIMES, velocity=SPEEDS)
    upstream.offer("slide.mat", content)
    assert "'speed' is missing; the file contains t, velocity" in complaint(matlab_record(content))


def test_an_unexpected_number_of_rows_is_said(upstream):
    content = TEXT.encode() + b"0.6\t107\n"
    upstream.offer("data/a%20slide.txt", content)
    with pytest.warns(UserWarning, match="7 rows, but the catalogue lists 6"):
        text_record(content).path("all")


def test_the_folder_of_ones_own_comes_first(upstream, monkeypatch, tmp_path):
    own = own_folder(monkeypatch, tmp_path, b"a table")
    assert text_record().path() == own
    assert text_record().place() is CacheLocation.LOCAL
    assert upstream.asked == []


def test_what_is_not_in_the_folder_of_ones_own_is_downloaded(upstream, monkeypatch, tmp_path):
    own_folder(monkeypatch, tmp_path, b"a table")
    assert text_record().path("all").is_relative_to(cache_folder())


@pytest.mark.parametrize("content", [b"the known table", b"another table"])
def test_another_table_in_the_folder_of_ones_own_is_used_with_a_warning(
    upstream, monkeypatch, tmp_path, content
):
    own = own_folder(monkeypatch, tmp_path, content)
    start = DataFile(name="start", about="", sha256=sha256(b"the known table"))
    record = dataclasses.replace(text_record(), files={"start": start})
    if content == b"the known table":  # and warnings are errors
        assert record.path() == own
        return
    with pytest.warns(UserWarning, match=r"start\.parquet differs from the file in the catalogue"):
        assert record.path() == own


def test_places_follow_what_is_there(upstream):
    record = text_record()
    assert record.place() is CacheLocation.UPSTREAM
    record.path()
    assert record.place() is CacheLocation.CACHED


def test_a_file_that_cannot_be_downloaded_is_asked_of_the_user(upstream):
    reference = DataFile(name="reference", about="")
    record = dataclasses.replace(text_record(), files={"reference": reference})
    assert record.place() is CacheLocation.ELSEWHERE
    message = complaint(record)
    assert "STICKSLIP_DATA" in message
    assert REPOSITORY in message
    assert upstream.asked == []


def test_an_unknown_file_lists_the_nearest(upstream):
    with pytest.raises(UnknownNameError, match=r"file of slide 'strt'\. Did you mean 'start'\?"):
        text_record().path("strt")


def test_an_address_that_is_none_is_refused(upstream, monkeypatch):
    monkeypatch.setenv("STICKSLIP_DATA_URL", "/srv/mirror")
    assert "must begin with https:// or http://, got '/srv/mirror'" in complaint(text_record())


def test_a_cache_that_cannot_be_written_is_named(upstream, monkeypatch, tmp_path):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    message = complaint(text_record())
    assert str(tmp_path / "file") in message
    assert "cannot be written" in message


def test_a_measurement_is_the_table_in_si_with_its_gains(upstream):
    record = text_record().measurement("all")
    assert record.name == "slide all"
    assert record.quantities() == ("friction",)
    np.testing.assert_array_equal(record.friction, [-(100.1 + i) * 1e-6 for i in range(6)])


def test_a_load_that_no_column_has_is_a_number_of_the_measurement(upstream):
    record = dataclasses.replace(text_record(), load=2.0).measurement()
    assert record.load == 2.0


def test_what_is_no_matlab_file_is_refused(upstream):
    upstream.offer("slide.mat", MATLAB[:50])
    assert "cannot be read as mat" in complaint(matlab_record(MATLAB[:50]))
