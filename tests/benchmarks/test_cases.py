"""The benchmarks compare like with like; their times are nobody's business here."""

import functools
import importlib.util

import numpy as np
import pytest
from benchmarks import (
    belt,
    decay,
    engines,
    ensembles,
    lugre,
    measuring,
    peers,
    sampled,
    sensitivities,
    tables,
    variations,
)
from benchmarks.block import by_scipy
from benchmarks.block.problem import LIGHT, TRAVEL
from benchmarks.kernel import Kernel
from benchmarks.measuring import KERNEL, Entry, Missing
from benchmarks.several import by_scipy as several_by_scipy
from benchmarks.several import by_stickslip as several_by_stickslip
from benchmarks.several.problem import CASES
from tests.support import quick

PYTHON = ("python",)
HAND = ("decay", "belt")


def of_belt():
    with pytest.MonkeyPatch.context() as patch:
        # the others take seconds, and each has the decay
        patch.setattr(measuring, "METHODS", ("DOP853",))
        return belt.run(repeats=1, tiers=PYTHON)


def of_lugre():
    with pytest.MonkeyPatch.context() as patch:
        # the plain tier takes a minute to get below 1e-8
        patch.setattr(lugre, "ERROR", 1e-5)
        return lugre.run(repeats=1, tiers=PYTHON)


RESULTS = {
    "decay": lambda: decay.run(repeats=1, tiers=PYTHON),
    "belt": of_belt,
    "lugre": of_lugre,
    "sampled": lambda: sampled.run(repeats=1, tiers=PYTHON, samples=600),
}


@pytest.fixture(scope="module")
def results():
    """Return a function from the name of a case to its result, made once."""
    return functools.cache(lambda case: RESULTS[case]())


@pytest.fixture(scope="module")
def holding():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(by_scipy, "MOST", 20_000)
        return engines.run(repeats=1, tiers=PYTHON, seconds=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("case", quick(RESULTS, "decay", "sampled"))
def test_every_solver_of_a_benchmark_stays_below_the_stated_error(results, case):
    result = results(case)
    assert result.entries[0].solver == measuring.TIERS["python"]
    for entry in result.entries:
        if not isinstance(entry, Missing):
            assert entry.error <= result.error
            assert len(entry.times) == 1


def test_a_tier_that_nobody_asked_for_is_not_compiled(monkeypatch):
    def never(*_):
        pytest.fail("the kernel was compiled")

    monkeypatch.setattr(measuring, "Kernel", never)
    sampled.run(repeats=1, tiers=PYTHON, samples=600)


@pytest.mark.slow
def test_the_kernel_alone_is_an_entry_of_its_own_and_what_targets_are_about():
    result = decay.run(repeats=1)
    first, second, *_ = result.entries
    assert (first.solver, second.solver) == (KERNEL, measuring.TIERS["compiled"])
    assert [target.goal for target in result.targets] == ["<= 12 us", ">= 200 x SciPy DOP853"]


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
    monkeypatch.setattr(peers, "LIBRARIES", (("Drake", "drake", "pydrake", "`pip install drake`"),))
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: name.startswith("b") or None)
    (row,) = peers.found("block")
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


@pytest.mark.parametrize("case", quick(HAND, "decay"))
def test_heyoka_reaches_the_same_error_with_events_by_hand(results, case):
    pytest.importorskip("heyoka")
    names = [entry.solver for entry in results(case).entries if not isinstance(entry, Missing)]
    assert "heyoka, modes and events by hand" in names


def test_the_kernel_alone_makes_the_run_of_a_whole_call_again_and_again():
    kernel = Kernel(decay.RIG, decay.LAW, decay.T_END, compiled=False)
    for _ in range(2):
        found = decay.of_kernel(kernel.run(1e-9))
        # closed form, up to rounding
        assert measuring.largest_error(found, decay.exact()) < 1e-13
    places, _ = kernel.states([0.0, decay.T_END])
    assert places[1] == kernel.final()[0]


def test_a_kernel_takes_other_numbers_for_its_next_run():
    kernel = Kernel(decay.RIG, decay.LAW, decay.T_END, compiled=False)
    kernel.change("mechanism.stiffness", 4 * decay.K)
    # twice the frequency
    assert kernel.run(1e-9).changes()[0] == pytest.approx(decay.exact()[0] / 2, rel=1e-13)


def test_an_ensemble_finds_the_closed_form_of_each_run_and_scipy_makes_the_first(monkeypatch):
    monkeypatch.setattr(ensembles, "PART", 1)
    found = ensembles.run(repeats=1, tiers=PYTHON, rows=2, many=0)
    assert len(found.rows) == 6
    assert {target.goal for target in found.targets} == {
        ">= 600 x SciPy DOP853", ">= 5,000 x SciPy DOP853",
    }  # fmt: skip


def test_the_closed_form_of_the_ensemble_is_that_of_the_single_run():
    varied = {path: np.array([value]) for path, value in zip(
        ensembles.RANGES, (decay.K, decay.X_0, decay.MU), strict=True
    )}  # fmt: skip
    stop, place = ensembles.exact(varied)
    *_, last, rest = decay.exact()
    # rounding
    assert (stop[0], place[0]) == pytest.approx((last, rest), rel=1e-14)


@pytest.mark.parametrize("case", sensitivities.CASES[:2], ids=lambda case: case.modes)
def test_sensitivities_agree_with_their_reference(case):
    row, _, error = sensitivities.measured(case, repeats=1, compiled=False)
    assert row[0] == case.title
    assert error <= case.error


def test_references_of_sensitivities_are_the_differences_of_closed_forms():
    numbers = [decay.M, decay.K, decay.X_0, decay.G, decay.MU]
    known = variations.swinging(1.1)
    for i, number in enumerate(numbers):
        ends = []
        for side in (1, -1):
            own = [complex(n) for n in numbers]
            own[i] += side * 1e-6 * number
            ends.append(np.real(variations.swing(1.1, *own)))
        # central differences of width 1e-6: rounding of 1e-16 over it
        np.testing.assert_allclose(
            (ends[0] - ends[1]) / (2e-6 * number), known[:, i], rtol=1e-8, atol=1e-9
        )


def entry(solver, seconds):
    return Entry(
        solver=solver, tolerance=1e-9, error=0.0, first=1.0, run=lambda: None, times=(seconds,)
    )


def test_a_target_is_met_by_the_kernel_and_says_why_if_not():
    entries = [entry(KERNEL, 1e-5), entry("SciPy DOP853, events by hand", 1e-3)]
    (slow,) = measuring.faster("decay", 200.0, entries, "SciPy DOP853", "too many steps")
    (short,) = measuring.within("decay", 12.0, entries, "us", "too many steps")
    assert (slow.met, short.met) == (False, True)
    *_, first, second, _ = tables.targets([slow, short])
    assert "100 x" in first
    assert "too many steps" in first
    assert "10 us" in second
    assert "too many steps" not in second


@pytest.mark.parametrize("name", ["chain", "arm", "clutches"])
def test_mechanisms_with_several_contacts_end_where_their_references_do(name):
    case = CASES[name]()
    (peer,) = several_by_scipy.engines(name, case, (1e-9,))
    # SciPy's tolerance at each step, grown by the events; the kernels are ten times closer
    assert case.error(peer.build()()) < 1e-8
    kernel = several_by_stickslip.kernel_of(case, compiled=False).run(1e-9)
    places = np.array(kernel.final()[: len(case.mechanism.coordinates)])
    if name == "clutches":
        places = np.cumsum(places)
    assert case.error(places) < 1e-9
