"""The study of bands ends with the table of its numbers, and goes on where it was."""

import json

import numpy as np
import pytest
from benchmarks import bands
from benchmarks.band_truths import decays


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["tables", "decays"])
def test_a_study_of_two_rigs_prints_its_table_and_judges_none_twice(kind, tmp_path, capsys):
    path = tmp_path / "bands.jsonl"
    asked = ["--seed", "3", "--count", "2", "--kinds", kind, "-o", str(path)]
    bands.main(asked)
    table = capsys.readouterr().out
    rows = [json.loads(text) for text in path.read_text().splitlines()]
    assert [row["inside"] for row in rows] == [True, False]
    assert all(0.0 <= row["point"] <= 1.0 for row in rows)
    for what in ("pointwise coverage", "false statements", "processor time", "code lines"):
        assert what in table
    bands.main(asked)
    assert capsys.readouterr().out == table
    assert len(path.read_text().splitlines()) == 2


def test_a_line_that_was_not_ended_is_judged_again(tmp_path):
    path = tmp_path / "bands.jsonl"
    path.write_text('{"kind": "tables", "seed"')
    assert bands.known(path) == []


def test_a_band_that_misses_the_truth_by_three_noises_is_a_false_statement():
    row = {"intervals": [], "accused": ["delay"], "set": 1, "gain": 0.0, "right": False,
           "equal": False, "error": 1.4, "named": "level", "out": 3.0, "doubts": []}  # fmt: skip
    assert len(list(bands._false(None, row))) == 3


@pytest.mark.slow
def test_intervals_of_a_wrong_law_are_of_that_law_laid_through_the_true_curve():
    rig = bands.tables.drawn(4, 730519).with_(more=None)
    row = bands.rated(rig, 0)
    assert row["named"] == "level+stribeck"  # without the viscous part that is there
    level = row["intervals"][0]
    verdict = bands.judged(rig)
    (interval,) = (x for x in verdict.parameters if x.path == level["path"])
    assert interval.high_any > rig.parameters["kinetic_coefficient"]
    assert interval.low > rig.parameters["kinetic_coefficient"]
    assert level["law"]


def test_a_table_that_does_not_tell_friction_from_zero_names_no_law():
    row = bands.rated(bands.tables.drawn(44, 730519).with_(more=None), 0)
    assert row["named"] == ""
    assert row["right"]


@pytest.mark.parametrize("kind", bands.KINDS)
@pytest.mark.parametrize("number", range(8))
def test_rigs_depend_on_seed_and_number_alone_and_know_their_friction(kind, number):
    one, again = (bands.KINDS[kind](number, 5) for _ in range(2))
    if kind != "travels":  # whose truths are mostly in the vocabulary
        assert one.inside == (number % 2 == 0)
    assert one.measurement.quantities() == again.measurement.quantities()
    for name in one.measurement.records()[0].quantities():
        first, second = (getattr(of.measurement.records()[0], name) for of in (one, again))
        np.testing.assert_array_equal(first, second)
    for curve in one.curves:
        assert np.isfinite(curve(one.asked)).all()
        assert np.isfinite(curve(one.beyond)).all()


def test_a_swing_under_dry_friction_alone_loses_the_same_angle_each_time():
    # k q = a linear spring: each half swing loses 2 level / k
    body = decays.Body(inertia=1.0, pull=lambda q: -q, level=0.05, friction=lambda v: 0.05)
    at = np.arange(6.0) * np.pi
    q, v = decays.moved(body, 1.0, 0.0, at, 1e-3)
    np.testing.assert_allclose(np.abs(q), 1.0 - 0.1 * np.arange(6.0), atol=1e-9)
    assert np.max(np.abs(v)) < 1e-9


@pytest.mark.parametrize("number", [4, 10, 22])
def test_the_true_structure_of_a_decay_is_fitted_near_its_friction(number):
    rig = decays.drawn(number, 8801)
    error = (rig.fitted(rig.asked) - rig.curves[0](rig.asked)) / rig.noise(rig.asked)
    assert 0.0 < np.sqrt(np.mean(error**2)) < 1.0


@pytest.mark.slow
def test_a_wheel_that_does_not_stop_is_asked_at_speeds_that_it_had():
    slow = 0
    for number in range(20):
        rig = decays.drawn(number, 711)
        v = rig.measurement.velocity
        if v is not None:
            slow += rig.asked.velocity.min() < 0.9 * np.mean(v[-5:])
    assert slow == 0
