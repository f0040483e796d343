"""What readings are expected to leave of the width of the quantities of interest."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stickslip.identify.propose import propose, rehearsed, width_after, widths_of_another


@pytest.mark.slow
@given(seed=st.integers(0, 10_000), count=st.integers(1, 12), laws=st.integers(1, 3))
def test_rows_of_noise_alone_are_not_expected_to_reduce_anything(seed, count, laws):
    random = np.random.default_rng(seed)
    points = random.normal(size=(150, 2))
    widths = [
        width_after(points, [random.normal(size=(150, count)) for _ in range(laws)], [1.0] * laws)
        for _ in range(8)
    ]
    assert np.mean(widths) > 0.97
    assert max(widths) <= 1.0


def test_laws_that_are_hardly_probable_leave_less_to_be_told():
    random = np.random.default_rng(1)
    one, other = random.normal(size=(2, 400, 1))
    alike = width_after(one, [one, other + 2.0], [0.5, 0.5])
    # of 0 or 1 with .02, a linear update takes off much less than of .5
    assert alike < 0.8 < width_after(one, [one, other + 2.0], [0.98, 0.02])


def test_readings_that_tell_laws_apart_leave_one_and_others_do_not():
    random = np.random.default_rng(2)
    near, far = (x + random.normal(size=(200, 1)) for x in (0.0, 9.0))
    none = 9.0 * random.normal(size=(200, 1))

    def said(first, second, mass=0.0):
        laws = [(0.5, near, first), (0.5, far, second), (mass, none, none)]
        return rehearsed(laws, np.eye(1), (np.zeros(1),) * 2, 0.0, 100.0)

    (widths, alone), (same, never) = said(near, far), said(near, near)
    assert np.mean(alone) > 0.8
    assert not never.any()
    assert np.median(widths) < 0.25 < np.median(same)
    # what is no law leaves none alone, however likely
    assert np.mean(said(near, far, mass=1.0)[1]) < np.mean(alone) + 0.05


def test_noise_that_is_not_known_scatters_the_width():
    random = np.random.default_rng(3)
    level = random.normal(size=(300, 1))
    laws = [(1.0, level, level), (0.0, level, level)]
    known, doubtful = (
        rehearsed(laws, np.eye(1), (np.zeros(1),) * 2, x, 100.0)[0] for x in (0.0, 0.3)
    )
    assert np.ptp(np.log(known)) < 1e-9
    assert np.std(np.log(doubtful)) == pytest.approx(0.3, rel=0.15)


def test_a_band_without_width_has_no_readings_to_propose():
    proposal = propose(np.ones((50, 3)), np.ones((50, 2)), 0.1)
    assert proposal.widths == (1.0,)
    assert not proposal.places


def test_repeats_of_a_block_and_readings_of_a_run_leave_what_they_share():
    level = np.random.default_rng(0).normal(size=(600, 1))
    places = np.repeat(level, 3, axis=1)
    alone = propose(level, places, 0.5, taken=9, enough=0.0)
    block = propose(level, places, 0.5, taken=9, enough=0.0, shared=np.eye(3))
    run = propose(level, places, 0.5, taken=9, enough=0.0, shared=np.ones((3, 3)))
    # other places are other blocks, and are read before any is read again
    assert sorted(block.places[:3]) == [0, 1, 2]
    assert alone.shrinks < block.shrinks < run.shrinks
    assert run.shrinks == pytest.approx(np.sqrt(0.5), abs=0.02)


@given(
    shares=st.lists(st.floats(0.05, 1.0), min_size=3, max_size=3), known=st.floats(0.0, 0.1),
    runs=st.integers(1, 5),
)  # fmt: skip
def test_more_runs_are_never_expected_to_widen_what_another_one_shows(shares, known, runs):
    prior = [x / sum(shares) for x in shares]
    widths = widths_of_another((0.005, 0.02, 0.08), prior, known, runs)
    assert max(widths) <= 1.02
    assert widths[-1] < widths[0] + 0.01


def test_what_another_run_is_expected_to_show_is_what_drawn_runs_come_to():
    random, sizes, prior = np.random.default_rng(3), np.array([0.005, 0.02, 0.08]), [0.4, 0.5, 0.1]
    today = np.quantile(np.abs(random.choice(sizes, 40_000, p=prior) * random.normal(size=40_000)),
                        0.95)  # fmt: skip
    came = []
    for true in random.choice(sizes, 300, p=prior):
        square = np.sum((true * random.normal(size=4)) ** 2)  # level and slope of two more runs
        weights = prior * sizes**-4 * np.exp(-0.5 * square / sizes**2)
        chosen = random.choice(sizes, 2_000, p=weights / weights.sum())
        came.append(np.quantile(np.abs(chosen * random.normal(size=2_000)), 0.95))
    expected = widths_of_another(sizes.tolist(), prior, 0.0, 1)[1]
    assert expected == pytest.approx(np.mean(came) / today, abs=0.06)


def test_as_many_readings_as_are_asked_for_are_proposed_however_little_they_gain():
    level = np.random.default_rng(0).normal(size=(400, 1))
    few = propose(level, level, 10.0, taken=1, enough=0.0)
    assert few.places == (0,)
    assert 0.95 < few.shrinks < 1.0
    assert propose(level, level, 10.0, taken=1).places == ()


def test_a_law_without_probability_counts_for_nothing():
    level, other = np.random.default_rng(0).normal(size=(2, 400, 1))
    alone = width_after(level, [level + other], [1.0])
    assert width_after(level, [level + other, other], [1.0, 0.0]) == alone
