"""Axes under control: what is compared moves."""

from types import SimpleNamespace

import numpy as np
from benchmarks import closed_loop_axes
from benchmarks.closed_loop_axes import MOVED, moving


def test_an_axis_is_drawn_again_where_record_or_fresh_motion_does_not_move(monkeypatch):
    rigs = iter([SimpleNamespace(number=n, encoder=1e-6) for n in range(3)])
    still, far = np.zeros(10), np.linspace(0.0, 2.0 * MOVED * 1e-6, 10)
    recorded, fresh = {0: still, 1: far, 2: far}, {1: still, 2: far}

    def motion(of):
        return lambda rig, random: SimpleNamespace(position=of[rig.number])

    monkeypatch.setattr(closed_loop_axes, "draw", lambda *given: next(rigs))
    monkeypatch.setattr(closed_loop_axes, "record", motion(recorded))
    monkeypatch.setattr(closed_loop_axes, "moved", motion(fresh))
    rig, measurement, again = moving(np.random.default_rng(1), "lugre")
    assert rig.number == 2
    assert measurement.position is again.position is far
