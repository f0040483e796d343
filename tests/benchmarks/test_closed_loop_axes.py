"""Axes under control: what is recorded moves, and long records are thinned."""

import numpy as np
from benchmarks import closed_loop_axes
from benchmarks.closed_loop_axes import FAST, LASTING, MOVED, ROWS, Motion, draw, fast_lugre


def test_an_axis_is_drawn_again_where_its_record_does_not_move(monkeypatch):
    drawn, real = [], draw

    def noted(*given):
        drawn.append(real(*given))
        return drawn[-1]

    def motion(rig, random):
        time = np.arange(0.0, rig.duration, 1.0 / rig.rate)
        far = 2.0 * MOVED * rig.encoder * (len(drawn) > 1)
        return Motion(time, np.linspace(0.0, far, len(time)), np.zeros(len(time)))

    monkeypatch.setattr(closed_loop_axes, "draw", noted)
    monkeypatch.setattr(closed_loop_axes, "moved", motion)
    rig, measurement = fast_lugre(np.random.default_rng(1))
    assert len(drawn) == 2
    assert rig.encoder == drawn[1].encoder
    assert FAST[0] <= rig.rate <= FAST[1]
    assert np.ptp(measurement.position) > MOVED * rig.encoder
    assert ROWS / 2 < len(measurement.time) <= ROWS
    assert measurement.time[-1] > 0.99 * LASTING
