"""Figures of records: loops, pieces of a second record, and maps of friction."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from stickslip.friction import Coulomb, CoulombViscous, Stribeck
from stickslip.show.plots.fits import Piece, draw_pieces
from stickslip.show.plots.laws import MapLaw, draw_friction_map
from stickslip.show.plots.theme import C1, C2, C3, C4, DATA, house_style

T = np.linspace(0.0, 1.0, 50)


def drawn(draw, *, narrow=False):
    with house_style():
        figure = Figure()
        draw(figure, narrow)
    return figure.axes


def series(axes):
    """Horizontal and vertical values of the lines of a panel with points, by colour."""
    lines = [line for line in axes.get_lines() if len(line.get_xdata()) > 2]
    return {line.get_color(): np.array(line.get_data()) for line in lines}


def test_pieces_show_predictions_over_the_data_and_errors_below_in_one_range():
    measured = 0.1 * np.sin(3.0 * T)
    off = {"Coulomb": measured + 0.002, "Dahl": measured - 0.001}
    pieces = [Piece("median error", T, measured, off), Piece("worst error", T, 2 * measured, off)]
    for narrow in (False, True):
        axes = drawn(draw_pieces(pieces, "position", "m", chosen="Dahl"), narrow=narrow)
        assert len(axes) == 4
        above, below = (axes[0], axes[1]) if narrow else (axes[0], axes[2])
        last = axes[3]
        assert set(series(above)) == {DATA, C1, C2}
        np.testing.assert_allclose(series(below)[C1][1], 1e-3, rtol=1e-9)  # m, measured less
        np.testing.assert_allclose(series(below)[C2][1], -2e-3, rtol=1e-9)
        assert below.get_ylim() == last.get_ylim()


def test_points_of_a_map_differ_by_colour_and_marker_where_speed_rises_and_falls():
    v = np.linspace(-1.0, 1.0, 90)
    turn = np.repeat([1.0, -1.0, 0.0], 30)
    laws = {"Coulomb": MapLaw(Coulomb(kinetic_coefficient=2.0), 0.0)}
    draw = draw_friction_map(v, 2.0 * np.sign(v), laws, 1.0, chosen="Coulomb", trend=turn)
    lines = drawn(draw)[0].get_lines()
    kinds = {line.get_color(): line.get_marker() for line in lines if line.get_marker() != "None"}
    assert kinds == {DATA: "o", C3: "o", C4: "^"}
    plain = drawn(draw_friction_map(v, 2.0 * np.sign(v), laws, 1.0, chosen="Coulomb"))[0]
    seen = [line for line in plain.get_lines() if line.get_marker() != "None"]
    assert {line.get_color() for line in seen if len(line.get_xdata())} == {DATA}


RISING = {
    "Coulomb + viscous": MapLaw(
        CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=10.0), 0.5
    ),
    "Coulomb": MapLaw(Coulomb(kinetic_coefficient=2.5), 0.5),
}


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_where_one_direction_was_measured_laws_are_drawn_in_that_alone(side):
    v = side * np.linspace(0.002, 0.1, 100)
    friction = 2.0 * np.sign(v) + 10.0 * v + 0.5
    draw = draw_friction_map(v, friction, RISING, 1.0, chosen="Coulomb + viscous")
    (axes, *_) = drawn(draw)
    for colour in (C1, C2):
        x, y = series(axes)[colour]
        assert (side * x >= 0.0).all()
        # at rest a law ends at what it holds, with its offset: 2 N, or 2.5 N, and 0.5 N
        at_rest = y[np.argmin(np.abs(x))]
        assert at_rest == pytest.approx(side * {C1: 2.0, C2: 2.5}[colour] + 0.5, abs=0.01)
    # nothing is shown beyond zero force but a margin of 6 % to either side
    low, high = axes.get_ylim()
    assert min(abs(low), abs(high)) < 0.06 * (high - low)


def test_no_name_stands_across_the_line_at_rest():
    v = np.linspace(0.002, 0.1, 100)
    friction = 2.5 + 10.0 * v
    axes = drawn(draw_friction_map(v, friction, RISING, 1.0, chosen="Coulomb + viscous"))[0]
    names = [text for text in axes.texts if text.get_text() in RISING]
    assert len(names) == 2
    for text in names:
        box = text.get_window_extent()
        ends = axes.transData.inverted().transform([(box.x0, box.y0), (box.x1, box.y1)])[:, 0]
        # how wide letters are is estimated when names are placed: one of them at most
        assert ends.min() > -0.01 * np.ptp(axes.get_xlim())


STRIBECK = Stribeck(
    kinetic_coefficient=0.3,
    static_coefficient=0.45,
    stribeck_velocity=0.02,
    viscous_coefficient=0.3,
)
READINGS = {
    "Stribeck": MapLaw(STRIBECK, 0.0),
    "Coulomb + viscous": MapLaw(
        CoulombViscous(kinetic_coefficient=0.32, viscous_coefficient=0.26), 0.0
    ),
}


@pytest.mark.parametrize("narrow", [False, True])
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("slowest", [0.01, 1e-4])
def test_names_keep_off_the_readings_of_a_table_and_off_its_axis(seed, narrow, slowest):
    rng = np.random.default_rng(seed)
    v = np.geomspace(slowest, 0.5, 16) if slowest < 1e-3 else np.linspace(slowest, 0.5, 40)
    friction = STRIBECK.steady(v, 1.0) + 0.02 * rng.standard_normal(len(v))
    draw = draw_friction_map(v, friction, READINGS, 1.0, chosen="Stribeck", low_speeds=False)
    (axes,) = drawn(draw, narrow=narrow)
    names = [text for text in axes.texts if text.get_text() in READINGS]
    assert len(names) == 2
    dots, frame = axes.transData.transform(np.column_stack([v, friction])), axes.get_window_extent()
    for text in names:
        box = text.get_window_extent()
        assert box.x0 > frame.x0
        inside = (dots > [box.x0, box.y0]) & (dots < [box.x1, box.y1])
        assert not inside.all(axis=1).any()


def test_readings_in_one_direction_over_powers_of_ten_have_a_logarithmic_axis():
    v = np.geomspace(1e-4, 0.5, 12)
    for speeds, scale in ((v, "log"), (-v, "linear"), (0.1 + v, "linear"), (v - 1e-4, "linear")):
        friction = np.sign(speeds) * STRIBECK.steady(np.abs(speeds), 1.0)
        (axes, *_) = drawn(draw_friction_map(speeds, friction, READINGS, 1.0, chosen="Stribeck"))
        assert axes.get_xscale() == scale
        low, high = axes.get_xlim()
        assert low < speeds.min()
        assert speeds.max() < high
        x, y = series(axes)[C1]
        moving = x != 0.0
        expected = np.sign(x) * STRIBECK.steady(np.abs(x), 1.0)
        np.testing.assert_allclose(y[moving], expected[moving], rtol=1e-9)


def test_a_direction_with_a_few_noisy_points_counts_as_not_measured():
    v = np.concatenate([np.linspace(0.002, 0.1, 400), [-1e-4, -2e-4]])
    draw = draw_friction_map(v, 2.0 + 10.0 * v, RISING, 1.0, chosen="Coulomb")
    assert all((series(drawn(draw)[0])[c][0] >= 0.0).all() for c in (C1, C2))


def test_the_chosen_law_is_the_one_that_is_called_chosen():
    v = np.linspace(-1.0, 1.0, 400)
    laws = {name: RISING[name] for name in ("Coulomb", "Coulomb + viscous")}
    for chosen in laws:
        axes = drawn(draw_friction_map(v, 2.0 * np.sign(v), laws, 1.0, chosen=chosen))[0]
        said = [text.get_text().replace("\n", " ") for text in axes.texts]
        assert [text for text in said if text.startswith("chosen: ")] == [f"chosen: {chosen}"]


@pytest.mark.parametrize("chosen", RISING)
def test_the_chosen_law_of_a_map_is_solid_and_the_other_is_dashed(chosen):
    v = np.linspace(-0.1, 0.1, 100)
    (axes, *_) = drawn(draw_friction_map(v, 20.0 * v, RISING, 1.0, chosen=chosen))
    styles = {line.get_color(): line.get_linestyle() for line in axes.get_lines()}
    assert (styles[C1], styles[C2]) == ("-", "--")
