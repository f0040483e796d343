"""What readings are expected to leave of the width of the quantities of interest."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from stickslip.identify.propose import propose, width_after


@given(seed=st.integers(0, 10_000), count=st.integers(1, 12), laws=st.integers(1, 3))
def test_rows_of_noise_alone_are_not_expected_to_reduce_anything(seed, count, laws):
    random = np.random.default_rng(seed)
    points = random.normal(size=(150, 2))
    widths = [
        width_after(points, [random.normal(size=(150, count)) for _ in range(laws)])
        for _ in range(8)
    ]
    assert np.mean(widths) > 0.97
    assert max(widths) <= 1.0


def test_a_band_without_width_has_no_readings_to_propose():
    proposal = propose(np.ones((50, 3)), np.ones((50, 2)), 0.1)
    assert proposal.widths == (1.0,)
    assert not proposal.places
