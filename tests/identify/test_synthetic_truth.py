"""Random rigs whose friction is known: intervals hold the truth, selection regrets little."""

import functools
import json
import math

import numpy as np
import pytest
from benchmarks import rigs, synthetic_truth
from benchmarks.synthetic_truth import KINDS, coverage, fitted, run, summary

FAST_TRUTHS = ("coulomb-viscous", "direction-dependent")
"""Two fits of which compile in seconds."""


@functools.cache
def made(number, truth, seed):
    """Return a random rig and its record."""
    random = np.random.default_rng([seed, number])
    rig = rigs.draw(random, truth)
    measurement, _ = rigs.record(rig, random)
    return rig, measurement


def judged(count, truths, seed):
    """Return intervals of fits of the true law to records of random rigs."""
    found = []
    for number in range(count):
        rig, measurement = made(number, truths[number % len(truths)], seed)
        found += coverage(fitted(rig, measurement), rig)
    return found


RECORDS, LOWEST = 12, 0.8
"""Five estimates of a record go together: 12 records know 90 % to 9."""


@pytest.fixture(scope="module")
def intervals():
    return judged(RECORDS, FAST_TRUTHS, 3)


@pytest.mark.slow
def test_nominal_intervals_cover_the_truth(intervals):
    bounded = [entry for entry in intervals if entry["bounded"]]
    assert len(bounded) >= 4 * RECORDS
    hits = sum(one["truth"] for one in bounded)
    assert hits / len(bounded) >= LOWEST


@pytest.mark.slow
def test_estimates_are_known_to_a_few_percent(intervals):
    relative = [
        interval["relative"]
        for interval in intervals
        if interval["bounded"] and "offset" not in interval["path"]
    ]
    # intervals that hold everything would cover too
    assert np.median(relative) < 0.1


@pytest.mark.parametrize("truth", rigs.TRUTHS)
def test_a_random_rig_reverses_and_is_disturbed_as_asked(truth):
    random = np.random.default_rng(11)
    rig = rigs.draw(random, truth)
    measurement, wandering = rigs.record(rig, random)
    v = np.gradient(measurement.position, measurement.time)
    moving = np.sign(v[np.abs(v) > 0.05 * rig.speed])
    assert np.count_nonzero(np.diff(moving)) >= rigs.REVERSALS
    # some 40 correlation times at least know a standard deviation to a quarter
    share = np.std(wandering) / np.std(measurement.force)
    assert share == pytest.approx(rig.disturbance, rel=0.5)
    lag = round(rig.correlation_time * rig.rate)
    correlated = np.mean(wandering[lag:] * wandering[:-lag]) / np.mean(wandering**2)
    assert correlated == pytest.approx(math.exp(-1.0), abs=0.35)


def test_a_killed_run_goes_on_where_it_was(tmp_path, monkeypatch):
    class Here:
        """Runs at once, in this process."""

        def __init__(self, jobs):
            pass

        def __enter__(self):
            return self

        def __exit__(self, *error):
            return False

        def submit(self, run, *given, **options):
            from concurrent.futures import Future

            task = Future()
            task.set_result(run(*given, **options))
            return task

    called = []

    def quick(seed, number, *, candidates, route, variant):
        called.append(number)
        row = {"seed": seed, "rig": number, "truth": "dahl", "failed": "no", "seconds": 0.0}
        return {**row, "route": route, "variant": variant}

    monkeypatch.setattr(synthetic_truth, "ProcessPoolExecutor", Here)
    monkeypatch.setattr(synthetic_truth, "judge", quick)
    path = tmp_path / "results.jsonl"
    row = {"seed": 1, "rig": 1, "truth": "dahl", "failed": "no", "seconds": 0.0}
    path.write_text(json.dumps(row) + '\n{"seed": 1, "rig": 2, "tru', encoding="utf-8")
    lines = list(run(path, rigs=4, seed=1, jobs=1, candidates=()))
    assert sorted(called) == [0, 2, 3]
    assert len(lines) == 3
    assert {row["rig"] for row in synthetic_truth.judged(path, 1)} == {0, 1, 2, 3}
    assert synthetic_truth.judged(path, 2) == []

    # another route in the same file is judged by itself; rows without one are of the first
    called.clear()
    assert synthetic_truth.judged(path, 1, "other") == []
    list(run(path, rigs=2, seed=1, jobs=1, candidates=(), route="other"))
    assert called == [0, 1]
    assert len(synthetic_truth.judged(path, 1)) == 4

    # and so are clean axes
    assert synthetic_truth.judged(path, 1, variant="clean") == []
    list(run(path, rigs=1, seed=1, jobs=1, candidates=(), variant="clean"))
    assert len(synthetic_truth.judged(path, 1, variant="clean")) == 1
    assert len(synthetic_truth.judged(path, 1)) == 4


def test_the_summary_counts_coverage():
    one = {"path": "friction.level", "bounded": True} | dict.fromkeys(KINDS, True)
    other = {**one, "truth": False}
    row = {"rig": 0, "truth": "dahl", "intervals": [one, other]}
    text = "\n".join(summary([row, {"rig": 1, "truth": "dahl", "failed": "why"}]))
    assert "1 rigs (1 failed); 2 of 2" in text
    assert "50.0 +- 35.4 % of 2" in text
    assert "rig 1 failed: why" in text


@pytest.mark.slow
def test_intervals_cover_for_every_smooth_law():
    truths = ("coulomb-viscous", "direction-dependent", "power-viscous", "quadratic-drag")
    bounded = [entry for entry in judged(20, truths, 5) if entry["bounded"]]
    hits = sum(entry["truth"] for entry in bounded)
    # target 90 to 99 %; 20 records know it to some 4 %
    assert hits / len(bounded) >= 0.85
