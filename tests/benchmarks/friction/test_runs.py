"""Runs: peers are judged as ours are, what is there is not run again, failures are said."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.friction.definition import ForceError
from benchmarks.friction.peers import PEERS, Found
from benchmarks.friction.runs import JOURNAL, _at, made_by, run
from tests.benchmarks.friction.conftest import TRUE

from stickslip import fit
from stickslip.errors import UnknownNameError

REGRESSIONS = ("scipy", "lmfit", "pysindy")


@pytest.mark.slow
def test_a_fit_with_its_own_values_is_judged_as_itself(other_package):
    fitted, judging = other_package.split()
    own = fit(
        other_package.mechanism,
        "coulomb-viscous",
        fitted,
        vary=list(other_package.vary),
    )
    values = {estimate.path: estimate.value for estimate in own.estimates}
    metric = other_package.metric
    assert metric.of(_at(own, Found(values, {}, "")), judging) == metric.of(own, judging)
    worse = values | {"friction.kinetic_coefficient": 3.6}
    assert (
        metric.of(_at(own, Found(worse, {}, "")), judging).value
        > 3.0 * metric.of(own, judging).value
    )


@pytest.mark.slow
@pytest.mark.parametrize("tool", [*REGRESSIONS, "mujoco"])
def test_a_peer_finds_the_true_values(other_package, tool):
    pytest.importorskip("lmfit" if tool == "scipy" else tool)
    _, (row,) = made_by("made-up", tool)
    assert not row.failed
    found = {estimate["path"]: estimate["value"] for estimate in row.estimates}
    for path, true in TRUE.items():
        # filters and guessed states cost the peers some per cent; a wrong term costs tens
        assert abs(found[path] / true - 1.0) < 0.08, path
    # the axis travels some 0.3 m
    assert row.error < 5e-3
    assert math.isfinite(row.seconds)


@pytest.mark.slow
def test_the_law_that_made_the_record_errs_least(other_package):
    _, rows = made_by("made-up", "stickslip")
    by_law = {row.law: row for row in rows}
    assert by_law["coulomb-viscous"].named
    assert by_law["coulomb-viscous"].error < 0.1 * by_law["viscous"].error
    found = {estimate["path"]: estimate for estimate in by_law["coulomb-viscous"].estimates}
    for path, true in TRUE.items():
        assert abs(found[path]["value"] / true - 1.0) < 1e-3


@pytest.mark.slow
def test_what_is_there_is_not_run_again(other_package, tmp_path):
    first = run(["made-up"], tmp_path, peers=["scipy"])
    assert (first.made, first.complete) == (2, True)
    again = run(["made-up"], tmp_path, peers=["scipy"])
    assert again.made == 0
    assert again.to_dataframe().equals(first.to_dataframe())
    # what a kill left of the last line is run again, and does not spoil the next one
    journal = tmp_path / JOURNAL
    journal.write_bytes(journal.read_bytes()[:-40])
    third = run(["made-up"], tmp_path, peers=["scipy"])
    assert third.made == 1
    assert run(["made-up"], tmp_path, peers=["scipy"]).made == 0
    rows = json.loads((tmp_path / "results.json").read_text())["rows"]
    assert [row["tool"] for row in rows] == ["stickslip", "stickslip", "scipy"]


@pytest.mark.slow
def test_progress_that_says_no_ends_after_what_is_in_work(other_package, tmp_path):
    found = run(["made-up"], tmp_path, peers=["scipy"], progress=lambda done, of: done < 1)
    assert (found.made, found.complete) == (1, False)
    assert run(["made-up"], tmp_path, peers=["scipy"]).made == 1


def test_a_peer_that_cannot_be_given_a_task_says_why(other_package, monkeypatch):
    monkeypatch.setitem(other_package.__dict__, "left_out", {"mujoco": "it has no such joint"})
    _, (row,) = made_by("made-up", "mujoco")
    assert row.failed == "left out: it has no such joint"
    assert math.isnan(row.error)


def test_a_law_that_cannot_be_fitted_leaves_the_others(other_package, monkeypatch):
    monkeypatch.setitem(other_package.__dict__, "selects", False)
    monkeypatch.setitem(other_package.__dict__, "laws", ("rate-and-state", "viscous"))
    _, rows = made_by("made-up", "stickslip")
    assert [bool(row.failed) for row in rows] == [True, False]


def test_an_unknown_peer_is_refused(tmp_path):
    with pytest.raises(UnknownNameError, match="peer of the benchmark 'spicy'"):
        run(["rock"], tmp_path, peers=["spicy"])


def test_the_force_error_is_the_residual_over_the_spread(other_package):
    fitted, judging = other_package.split()
    own = fit(
        other_package.mechanism,
        "coulomb-viscous",
        fitted,
        vary=list(other_package.vary),
        route="balance",
    )
    seen = own.predict(judging)
    error = ForceError().of(own, judging)
    assert error.value == pytest.approx(seen.error / float(np.std(seen.measured)), rel=0.05)


def test_every_peer_has_a_form_that_our_laws_have(other_package):
    from stickslip.friction import law_type

    assert [law_type(peer.law).name for peer in PEERS.values()]
    assert replace(PEERS["scipy"], name="x").law == "coulomb-viscous"
