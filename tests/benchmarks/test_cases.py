"""The benchmarks compare like with like; their times are nobody's business here."""

import pytest
from benchmarks import belt, decay, lugre


@pytest.mark.parametrize("case", [decay, belt, lugre])
def test_every_solver_of_a_benchmark_stays_below_the_stated_error(case):
    result = case.run(repeats=1)
    assert result.entries[0].solver == "stickslip, plain Python"
    for entry in result.entries:
        assert entry.error <= result.error
        assert len(entry.times) == 1
