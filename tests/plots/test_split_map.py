"""The friction map of a joint by thirds of load and temperature."""

import numpy as np
from matplotlib.figure import Figure

from stickslip.plots import MapSplit, draw_split_map


def test_lines_of_thirds_lie_apart_where_friction_depends_on_the_load_only():
    random = np.random.default_rng(1)
    v = random.uniform(-1.0, 1.0, 6000)
    load, temperature = random.uniform(0.0, 3.0, v.size), random.uniform(20.0, 40.0, v.size)
    friction = (1.0 + 0.5 * load) * np.sign(v)
    splits = [MapSplit("by load", load, "N m"), MapSplit("by temperature", temperature, "°C")]
    figure = Figure()
    draw_split_map(v, friction, splits, shown=np.arange(600), units=("rad/s", "N m"))(figure, True)
    ends = []
    for axes in figure.axes:
        lines = [one for one in axes.lines if one.get_linewidth() == 2.0]
        ends.append([float(one.get_ydata()[-1]) for one in lines])
    # medians of thirds of a uniform load are a third of its range apart, less those of a sample
    np.testing.assert_allclose(ends[0], [1.25, 1.75, 2.25], atol=0.1)
    np.testing.assert_allclose(ends[1], [1.75] * 3, atol=0.25)
    names = [one.get_text() for one in figure.axes[0].get_legend().get_texts()]
    assert names == ["below 1 N m", "1 to 2 N m", "above 2 N m"]
