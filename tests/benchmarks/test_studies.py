"""The campaign of all studies: rows by seed and number, one table, and going on."""

import json

import pytest
from benchmarks import studies
from benchmarks.studies import STUDIES, Outcome, Study


@pytest.mark.parametrize("part", [0.01, 0.1, 0.37, 1.0])
def test_a_part_of_a_study_is_spread_over_it(part):
    for study in STUDIES.values():
        found = studies.numbers(study.count, part)
        assert len(found) == max(1, round(part * study.count))
        assert found == sorted(set(found))
        assert 0 <= found[0] <= found[-1] < study.count


def judge(seed, number):
    """Return a made-up row; one rig fails."""
    if number == 3:
        raise ValueError("no motion")
    return {"right": number != 1, "false": number == 1, "seconds": float(seed + number)}


@pytest.fixture
def plain(monkeypatch):
    study = Study(
        count=5, judge=judge, outcome=lambda row: Outcome(row["right"], row["false"], 1, 2, 0.5)
    )
    monkeypatch.setattr(studies, "STUDIES", {"plain": study})


def test_a_campaign_goes_on_where_it_was_cut_off(plain, tmp_path, capsys):
    whole = studies.run(tmp_path / "whole", 7, 1.0, ["plain"], 1, None)
    row = whole.iloc[0]
    assert (row["rigs"], row["refused"], row["right or equal"]) == (5, 1, 3)
    assert (row["false certainties"], row["intervals"], row["coverage, %"]) == (1, 8, 50.0)
    assert row["processor time, median s"] == 8.5  # of 7, 8, 9 and 11
    lines = (tmp_path / "whole/rows.jsonl").read_text().splitlines(keepends=True)
    (tmp_path / "own").mkdir()
    (tmp_path / "own/rows.jsonl").write_text("".join(lines[:2]) + lines[2][:10])
    capsys.readouterr()
    again = studies.run(tmp_path / "own", 7, 1.0, ["plain"], 1, None)
    assert capsys.readouterr().out.count("of 5: plain") == 3
    assert again.equals(whole)
    kept = {json.loads(line)["campaign"][1] for line in lines}
    assert kept == set(range(5))
    assert (tmp_path / "own/studies.csv").read_text() == (
        tmp_path / "whole/studies.csv"
    ).read_text()


@pytest.mark.slow
def test_each_study_judges_a_rig():
    row = studies.judged("velocity steps", 5, 0)
    assert "refused" not in row
    assert isinstance(STUDIES["velocity steps"].outcome(row), Outcome)
