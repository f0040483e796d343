"""Figures of several runs: panels in part, differences, and levels."""

import math

import numpy as np
import pytest
from matplotlib.figure import Figure

from stickslip import Coulomb, SpringBlock, simulate
from stickslip.errors import InputError
from stickslip.show.plots import MotionView, draw_motion

BLOCK = SpringBlock(mass=1.0)


@pytest.fixture(scope="module")
def runs():
    """Return two coasts from 1 m/s: v = 1 - mu g t until rest."""
    return {
        f"mu {mu}": simulate(BLOCK, Coulomb(kinetic_coefficient=mu), t_end=2.0, y0={"v": 1.0})
        for mu in (0.2, 0.1)
    }


def panels(draw, narrow=False):
    figure = Figure(layout="constrained")
    draw(figure, narrow)
    return figure.axes


def test_differences_are_those_from_the_chosen_run(runs):
    view = MotionView(column="v", title="difference", span=(0.1, 0.4), difference=True)
    (axes,) = panels(draw_motion(runs, views=[view], chosen="mu 0.2"))
    (curve,) = [line for line in axes.lines if len(line.get_xdata()) > 2]
    t, y = curve.get_data()
    assert (t.min(), t.max()) == pytest.approx((0.1, 0.4), abs=1e-3)  # as close as samples lie
    # both slide: v differs by 0.1 g t, to the accuracy of exact coasts
    np.testing.assert_allclose(y, 0.1 * 9.81 * t, rtol=1e-9)


def test_a_span_shows_that_part_alone(runs):
    views = [
        MotionView(column="x", title="displacement", span=(0.0, 2.0)),
        MotionView(column="v", title="velocity", span=(0.3, 0.5)),
    ]
    whole, part = panels(draw_motion(runs, views=views))
    assert whole.get_xlim()[1] == pytest.approx(2.0)
    assert part.get_xlim() == pytest.approx((0.3, 0.5), abs=1e-3)


@pytest.mark.parametrize("span", [(0.5, 0.5), (0.6, 0.5), (2.0, 3.0), (math.nan, 1.0)])
def test_a_span_that_shows_nothing_is_refused(runs, span):
    with pytest.raises(InputError, match="must begin before it ends"):
        draw_motion(runs, views=[MotionView(column="v", title="velocity", span=span)])
