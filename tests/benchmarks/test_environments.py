"""The benchmark of environments steps the same carts in all engines."""

import importlib.util

import numpy as np
import pytest
from benchmarks import environments


def test_the_table_has_a_row_for_each_engine(monkeypatch):
    monkeypatch.setattr(environments, "SETTINGS", ())
    found = environments.run(count=4, steps=3, threads=1)
    assert [row[0] for row in found.rows] == ["stickslip, 1 thread"]
    assert all(len(row) == len(found.heads) for row in found.rows)


@pytest.mark.skipif(importlib.util.find_spec("mujoco") is None, reason="needs mujoco")
def test_carts_of_mujoco_are_the_same_carts(monkeypatch):
    monkeypatch.setattr(environments, "SHARE", 1.0)
    exact = environments.by_stickslip(3, 20, 1)
    other = environments.by_mujoco(3, 20, 1, "", True, *environments.STIFF)
    # what contacts creep and sink in a fifth of a second, a hundredth of the travel
    np.testing.assert_allclose(other.places, exact.places, atol=5e-5)
    assert np.abs(exact.places).max() > 3e-3
