"""Figures of campaigns show what was found, and where the direction turns."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from stickslip import Capsule, Coulomb
from stickslip.engine import Status
from stickslip.errors import InputError
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import Sine
from stickslip.show.plots import draw_basins, draw_orbits, draw_velocity_map, standalone_svg
from stickslip.show.plots.sweep_maps import _motions
from stickslip.show.plots.theme import SLIP_BACK, house_style
from stickslip.study.sweep import Attractor, Basins, VelocityMap, orbit_diagram


def velocity_map(axes, velocity):
    velocity = np.asarray(velocity, dtype=float)
    return VelocityMap(
        axes={name: np.asarray(values, dtype=float) for name, values in axes.items()},
        units=dict.fromkeys(axes, "Hz"),
        unit="m/s",
        velocity=velocity,
        unsettled=np.zeros_like(velocity),
        closes=np.ones(velocity.shape, dtype=int),
        spread=np.full(velocity.shape, np.nan),
        chaotic=np.zeros(velocity.shape, dtype=bool),
        period=np.ones_like(velocity),
        status=np.full(velocity.shape, Status.END_TIME, dtype=object),
        certified=np.ones(velocity.shape, dtype=bool),
    )


def drawn(draw):
    with house_style():
        figure = Figure(figsize=(8, 4), dpi=72)
        draw(figure, False)
    return figure.axes


def test_a_curve_marks_its_reversal_and_shades_backward_motion():
    found = velocity_map({"mechanism.drive.frequency": [1, 2, 3, 4]}, [3.0, 1.0, -3.0, -1.0])
    (axes,) = drawn(draw_velocity_map(found))
    assert axes.get_xlabel() == "frequency, Hz"
    assert [text.get_text() for text in axes.texts] == ["2.25"]
    (band,) = (patch for patch in axes.patches if patch.get_facecolor()[:3] != (1, 1, 1))
    assert band.get_x() == pytest.approx(2.5)
    assert band.get_x() + band.get_width() == pytest.approx(4.0)
    assert SLIP_BACK in standalone_svg(draw_velocity_map(found))


@pytest.mark.parametrize("axes", [{"a": [1, 2, 3]}, {"a": [1, 2, 3], "b": [1, 2]}])
def test_where_runs_ended_early_it_is_hatched_with_the_reason(axes):
    shape = tuple(len(values) for values in axes.values())
    found = velocity_map(axes, np.ones(shape))
    found.velocity[0], found.status[0] = np.nan, Status.ZENO
    panel, *_ = drawn(draw_velocity_map(found))
    (legend,) = panel.get_legend().get_texts()
    assert legend.get_text() == "No value: Zeno behaviour"
    hatched = [patch for patch in panel.patches if patch.get_hatch()]
    assert len(hatched) == 1
    assert hatched[0].get_x() == (1.0 if len(shape) == 1 else 0.5)


def test_a_map_without_any_velocity_is_drawn_with_the_reason():
    found = velocity_map({"a": [1, 2]}, [np.nan, np.nan])
    found.status[:] = Status.LIFT_OFF
    panel, *_ = drawn(draw_velocity_map(found))
    assert "Lift-off" in panel.get_legend().get_texts()[0].get_text()


def test_a_map_has_its_colours_even_about_zero_and_units_of_small_velocities():
    found = velocity_map({"a": [1, 2], "b": [1, 2, 3]}, [[0.02, 0.01, -0.01], [0.01, 0.0, -0.01]])
    axes, bar = drawn(draw_velocity_map(found))
    assert axes.collections[0].get_clim() == pytest.approx((-20.0, 20.0))
    assert bar.get_ylabel() == "mean velocity, mm/s"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("b, Hz", "a, Hz")


def test_three_parameters_are_no_map():
    found = velocity_map({"a": [1], "b": [1], "c": [1]}, [[[1.0]]])
    with pytest.raises(InputError, match="fix all but two"):
        draw_velocity_map(found)


def test_basins_name_their_motions_and_leave_out_failed_starts():
    rest = Attractor(points=np.zeros((4, 2)), period=1, velocity=0.0, share=0.75)
    found = Basins(
        starts={"x": np.array([0.0, 1.0]), "v": np.array([0.0, 1.0])}, states=("x", "v"),
        index=np.array([[0, 0], [0, -1]]), attractors=(rest,), units={"x": "m", "v": "m/s"},
        status=np.array([[Status.END_TIME] * 2, [Status.END_TIME, Status.LIMIT]], dtype=object),
    )  # fmt: skip
    (axes,) = drawn(draw_basins(found))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("initial x, m", "initial v, m/s")
    first, reason = (text.get_text() for text in axes.get_legend().get_texts())
    assert first == "75 %, period 1"
    words = "No value: The mechanism reached one of its limits"
    assert reason.split() == words.split()
    assert np.ma.count_masked(axes.collections[0].get_array()) == 1


@pytest.fixture(scope="module")
def branches():
    """A capsule's branch over its fold, and the diagram around it."""
    drive = Torque(drive=Sine(amplitude=0.2, frequency=16.0))
    capsule = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, upper_stop=2e-3,
        restitution=0.6, drive=drive,
    )  # fmt: skip
    law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)
    return orbit_diagram(capsule, law, "frequency", (15.0, 18.0), values=4, cycles=1, settle=60)


def test_branches_are_solid_where_stable_and_dashed_where_not(branches):
    (axes,) = drawn(draw_orbits(branches))
    assert axes.get_ylabel() == "mean velocity of x, mm/s"
    assert axes.get_xlabel() == "frequency, Hz"
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert {"period 1", "unstable", "fold", "settled runs"} <= set(names)
    for style, kind in (("-", True), ("--", False)):
        shown = sum(
            np.isfinite(line.get_ydata()).sum()
            for line in axes.lines
            if line.get_linestyle() == style and len(line.get_xdata()) > 1
        )
        wanted = sum((branch.stable == kind).sum() for branch in branches.branches)
        assert wanted <= shown <= wanted + 4 * len(branches.branches)


def test_marks_of_events_do_not_cover_each_other(branches):
    marks = []
    for times in (1, 3):
        (axes,) = drawn(draw_orbits(replace(branches, branches=branches.branches * times)))
        marks.append([line for line in axes.lines if line.get_marker() in "oD^vs*"])
    assert len(marks[0]) == len(marks[1]) > 0


def test_a_state_at_the_start_of_a_cycle_is_drawn_on_request(branches):
    (axes,) = drawn(draw_orbits(branches.branches[0], "xi"))
    assert axes.get_ylabel() == "xi at the start of a cycle, mm"
    with pytest.raises(InputError, match="show must be one of x, xi, v, xi_dot, got 'y'"):
        draw_orbits(branches, "y")


@pytest.mark.parametrize("edge", [0, -1])
@pytest.mark.parametrize("along", [0, 1])
def test_numbers_of_stable_motions_lie_within_the_axes(edge, along):
    count = np.ones((20, 20), dtype=int)
    count[(edge, slice(None)) if along == 0 else (slice(None), edge)] = 2
    values = np.linspace(14.0, 18.0, 20)
    chart = SimpleNamespace(axes=(values, values), velocities={}, count=count)
    with house_style():
        figure = Figure(figsize=(4, 3), dpi=72)
        axes = figure.add_subplot()
        _motions(figure, axes, chart)
        figure.canvas.draw()
    box = axes.get_window_extent().padded(0.01)  # pixels, for rounding
    assert {text.get_text() for text in axes.texts} == {"1", "2"}
    for text in axes.texts:
        own = text.get_window_extent()
        assert box.x0 <= own.x0 < own.x1 <= box.x1
        assert box.y0 <= own.y0 < own.y1 <= box.y1
