"""The overview of a record shows what was measured and nothing that was not."""

from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure

from stickslip import Measurement
from stickslip.show.plots import draw_overview, overview_size, standalone_svg
from stickslip.show.plots.measurements import _envelope

TIME = np.arange(3000) / 1000
POSITION = 0.05 * np.sin(2 * np.pi * TIME)
FRICTION = 2 * np.sign(np.cos(2 * np.pi * TIME))


def drawn(**parts):
    figure = Figure()
    draw_overview(Measurement(**parts))(figure, False)
    return figure


def labels(**parts):
    return [axes.get_ylabel() for axes in drawn(**parts).axes]


def test_each_signal_has_a_panel_and_units_without_leading_zeros():
    seen = labels(time=TIME, position=POSITION, friction=FRICTION, load=2 + 0 * TIME)
    assert seen == ["position, mm", "friction, N", "load, N", "samples, %", "friction, N"]


def test_without_motion_there_are_only_signals():
    assert labels(time=TIME, spring_force=1 + FRICTION) == ["spring force, N"]


def test_a_friction_map_has_no_time():
    speeds = np.linspace(-0.3, 0.3, 21)
    assert labels(velocity=speeds, friction=np.sign(speeds)) == ["samples, %", "friction, N"]


def test_the_histogram_counts_every_sample_that_it_shows():
    figure = drawn(time=TIME, velocity=np.cos(TIME))
    histogram = figure.axes[1].patches[0]
    # one in a thousand is left out at most, and the range is wider than that
    assert np.sum(histogram.get_data().values) == pytest.approx(100.0, abs=0.1)


def test_a_long_signal_keeps_its_extremes_in_their_order():
    rng = np.random.default_rng(0)
    time, values = np.arange(100_003) / 1000, rng.normal(size=100_003)
    seen_time, seen = _envelope(time, values)
    assert (seen.min(), seen.max()) == (values.min(), values.max())
    assert np.all(np.diff(seen_time) >= 0)
    assert seen_time[-1] == time[-1]
    assert seen.size < 3000


def test_a_gap_is_shaded():
    kept = np.concatenate([np.arange(1000), np.arange(1400, 3000)])
    parts = {"time": TIME[kept], "position": POSITION[kept]}
    assert len(drawn(**parts).axes[0].patches) == 1
    assert len(drawn(time=TIME, position=POSITION).axes[0].patches) == 0


def test_the_file_is_small_and_the_same_each_time():
    record = Measurement(time=TIME, position=POSITION, friction=FRICTION)
    once, again = (
        standalone_svg(draw_overview(record), size=overview_size(record)) for _ in range(2)
    )
    assert once == again
    assert len(once) < 200_000
    ElementTree.fromstring(once)
