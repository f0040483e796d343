"""Figures of several runs: panels in part, differences, and levels."""

import math

import numpy as np
import pytest
from matplotlib.figure import Figure

from stickslip import Coulomb, SpringBlock, simulate
from stickslip.errors import InputError
from stickslip.show.plots import MotionView, draw_motion, standalone_svg

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


@pytest.mark.parametrize("narrow", [True, False])
def test_levels_are_lines_of_the_first_panel_with_their_names(runs, narrow):
    first, second = panels(draw_motion(runs, levels={"measured, 0.30 m": 0.3}), narrow)
    flat = [line.get_ydata() for line in first.lines if set(line.get_ydata()) == {0.3}]
    assert len(flat) == 1
    assert "measured, 0.30 m" in [text.get_text() for text in first.texts]
    assert not any(0.3 in line.get_ydata() for line in second.lines if len(line.get_ydata()) == 2)


def test_a_level_has_the_unit_of_its_panel():
    """Runs of some millimetres are drawn in mm, and so is the level."""
    run = simulate(BLOCK, Coulomb(kinetic_coefficient=0.5), t_end=1.0, y0={"v": 0.1})
    (axes, _) = panels(draw_motion({"run": run}, levels={"published": 2e-3}))
    assert axes.get_ylabel() == "displacement, mm"
    assert any(list(line.get_ydata()) == pytest.approx([2.0, 2.0]) for line in axes.lines)
    top = max(line.get_ydata().max() for line in axes.lines if len(line.get_ydata()) > 2)
    assert top == pytest.approx(1e3 * 0.1**2 / (2 * 0.5 * 9.81))  # v^2 / (2 mu g)


@pytest.mark.parametrize("span", [(0.5, 0.5), (0.6, 0.5), (2.0, 3.0), (math.nan, 1.0)])
def test_a_span_that_shows_nothing_is_refused(runs, span):
    with pytest.raises(InputError, match="must begin before it ends"):
        draw_motion(runs, views=[MotionView(column="v", title="velocity", span=span)])


def test_one_run_has_no_differences_and_is_drawn_all_the_same(runs):
    views = [MotionView(column="x", title="displacement"), MotionView(column="v", title="velocity")]
    only = {"alone": runs["mu 0.2"]}
    assert standalone_svg(draw_motion(only, views=views)).startswith("<")
