"""The benchmarks compare like with like; their times are nobody's business here."""

import importlib.util

import numpy as np
import pytest
from benchmarks import belt, decay, engines, lugre, measuring, sampled, tables
from benchmarks.block import by_scipy
from benchmarks.block.problem import LIGHT, TRAVEL
from benchmarks.measuring import Missing

PYTHON = ("python",)
HAND = ("decay", "belt")


@pytest.fixture(scope="module")
def results():
    with pytest.MonkeyPatch.context() as patch:
        # the others take seconds, and each has the decay
        patch.setattr(measuring, "METHODS", ("DOP853",))
        slow = belt.run(repeats=1, tiers=PYTHON)
    return {
        "decay": decay.run(repeats=1, tiers=PYTHON),
        "belt": slow,
        "lugre": lugre.run(repeats=1, tiers=PYTHON),
        "sampled": sampled.run(repeats=1, tiers=PYTHON, samples=600),
    }


@pytest.fixture(scope="module")
def holding():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(by_scipy, "MOST", 20_000)
        return engines.run(repeats=1, tiers=PYTHON, seconds=0.1)


@pytest.mark.parametrize("case", ["decay", "belt", "lugre", "sampled"])
def test_every_solver_of_a_benchmark_stays_below_the_stated_error(results, case):
    result = results[case]
    assert result.entries[0].solver == "stickslip, plain Python"
    for entry in result.entries:
        if not isinstance(entry, Missing):
            assert entry.error <= result.error
            assert len(entry.times) == 1


@pytest.mark.slow
def test_the_compiled_tier_is_an_entry_of_its_own():
    entry, *_ = decay.run(repeats=1).entries
    assert entry.solver == "stickslip, compiled"


def test_the_belt_has_the_stated_number_of_changes():
    assert len(belt.exact()) == 275


def test_the_sampled_force_makes_the_axis_stop_and_start_some_25_times():
    motion = sampled.by_hand(sampled.closed_slip, sampled.forces(sampled.SAMPLES))
    assert len(motion.changes) == 26
    assert motion.slipping == 17731


def test_the_closed_form_and_the_matrix_exponential_move_the_axis_alike():
    u = sampled.forces(4000)
    ours, known = (
        sampled.by_hand(slip, u) for slip in (sampled.closed_slip, sampled.reference_slip())
    )
    # rounding: 1e-16 a step over 4000 steps
    np.testing.assert_allclose(ours.changes, known.changes, rtol=1e-12)
    np.testing.assert_allclose(ours.places, known.places, rtol=0, atol=1e-12)


def test_a_library_that_is_not_there_is_named_with_where_to_get_it(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    entry = measuring.if_installed("heyoka", "heyoka, by hand", lambda: None)
    assert entry == Missing(solver="heyoka, by hand", reason="`pip install heyoka`")
    (row,) = engines.found("Drake", "drake", "pydrake", "`pip install drake`")
    assert "| Drake" in "\n".join(tables.in_engines(engines.Holding(entries=(HELD, row))))


HELD = engines.Held(
    solver="stickslip", levels="mu_k, mu_s", travel_error=0.0, creep=0.0, slide=0.0,
    first=1.0, run=lambda: None, times=(1.0,),
)  # fmt: skip


def entries_of(holding, engine):
    return [
        entry
        for entry in holding.entries
        if entry.solver.startswith(engine) and not isinstance(entry, Missing)
    ]


@pytest.mark.parametrize("exact", ["stickslip", "SciPy DOP853"])
def test_engines_with_events_stop_at_the_closed_form_and_do_not_creep(holding, exact):
    (entry,) = entries_of(holding, exact)
    # a parabola, which the steps follow up to rounding
    assert abs(entry.travel_error) < 1e-12
    assert entry.creep == entry.slide == 0.0


def test_smooth_laws_creep_as_fast_as_their_formula_says(holding):
    (entry,) = entries_of(holding, "SciPy LSODA, tanh, 1 mm/s")
    speed = 1e-3 * np.arctanh(LIGHT / 2.4525)
    # the block is up to speed within a millisecond of the 0.1 s
    assert entry.creep == pytest.approx(speed * 0.1, rel=1e-2)


@pytest.mark.parametrize(("library", "engine"), [("mujoco", "MuJoCo"), ("pydrake", "Drake")])
def test_engines_with_soft_contacts_come_near_the_travel(holding, library, engine):
    pytest.importorskip(library)
    found = entries_of(holding, engine)
    assert found
    for entry in found:
        # soft contacts slip by some thousandths of the travel, and 1 or 2 mm/s while held
        assert abs(entry.travel_error) < 2e-3
        assert abs(entry.creep) < 2e-3 * TRAVEL


@pytest.mark.parametrize("case", HAND)
def test_heyoka_reaches_the_same_error_with_events_by_hand(results, case):
    pytest.importorskip("heyoka")
    names = [entry.solver for entry in results[case].entries if not isinstance(entry, Missing)]
    assert "heyoka, modes and events by hand" in names


def test_a_row_without_numbers_says_why(holding):
    lines = tables.in_engines(holding)
    assert any("SciPy RK45, sign(v)" in line and "gave up" in line for line in lines)
    assert any("Siconos" in line and "not on PyPI" in line for line in lines)
