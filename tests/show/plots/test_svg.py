"""Figures: inline SVG that follows the theme, plain files, and labels that keep apart."""

import re
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from stickslip.show.plots import svg, theme
from stickslip.show.plots.measurements import schematic


def cloud(figure: Figure, narrow: bool) -> None:
    axes = figure.add_subplot()
    points = np.random.default_rng(0).normal(size=(2, 3000))
    axes.plot(*points, "o", markersize=2.5, color=theme.DATA, alpha=0.6, markeredgewidth=0)
    axes.plot([-3, 3], [-3, 3], color=theme.C1)
    axes.plot([-3, 3], [0, 0], "--", color=theme.C2)
    axes.set_xlabel("velocity < mm/s, narrow" if narrow else "velocity < mm/s")
    theme.shade(axes, [(-0.5, 0.5)])
    theme.label_at(axes, 3, 3, 'Coulomb & "viscous" id="x" 1.23456', theme.C1)


def test_an_inline_figure_has_a_wide_and_a_narrow_variant_with_an_aria_label():
    text = svg.inline_svg(cloud, alt='Force "F" <N>', prefix="map")
    roots = list(ElementTree.fromstring(f"<p>{text}</p>"))
    assert [root.get("class") for root in roots] == ["fw", "fn"]
    assert {root.get("aria-label") for root in roots} == {'Force "F" <N>'}
    assert roots[0].get("viewBox") == "0 0 880 300"
    assert "mm/s, narrow" in text


def test_every_colour_of_the_palette_becomes_a_variable_of_the_page():
    text = svg.inline_svg(cloud, alt="Cloud", prefix="map")
    assert not re.search(r"#[0-9a-f]{6}", text)
    assert {"var(--c1)", "var(--c2)", "var(--data)", "var(--stick)", "var(--muted)"} <= set(
        re.findall(r"var\(--[a-z0-9-]+\)", text)
    )


def test_black_left_by_matplotlib_follows_the_theme_as_ink():
    def arrow(figure: Figure, narrow: bool) -> None:
        figure.add_subplot().plot([0, 1], color="black")

    assert "stroke:var(--ink)" in svg.inline_svg(arrow, alt="Line", prefix="a")


def test_a_small_sketch_is_drawn_once():
    text = svg.inline_svg(cloud, alt="Sketch", prefix="s", wide=(250, 120), narrow=None)
    assert text.count("<svg") == 1
    assert 'class="one"' in text


def test_a_figure_placed_by_hand_needs_no_layout():
    def sketch(figure: Figure, narrow: bool) -> None:
        figure.add_axes((0, 0, 1, 1)).plot([0, 1], [0, 1])

    assert "<path" in svg.inline_svg(sketch, alt="Sketch", prefix="s")


def test_the_text_of_a_label_is_never_rewritten():
    text = svg.inline_svg(cloud, alt="Cloud", prefix="map")
    assert 'Coulomb &amp; "viscous" id="x" 1.23456' in text


def test_three_thousand_points_cost_less_than_fifty_kilobytes():
    assert len(svg.inline_svg(cloud, alt="Cloud", prefix="map")) < 2 * 50_000


def test_merged_points_keep_their_size_colour_and_opacity():
    text = svg.inline_svg(cloud, alt="Cloud", prefix="map")
    assert "stroke:var(--data);stroke-width:2.5;stroke-linecap:round;stroke-opacity:0.6" in text


def test_markers_of_another_shape_are_left_as_they_are():
    def squares(figure: Figure, narrow: bool) -> None:
        figure.add_subplot().plot(np.arange(50), "s", color=theme.C3)

    assert svg.inline_svg(squares, alt="Squares", prefix="s").count("<use") >= 100


def test_two_figures_of_one_page_share_no_id_and_every_reference_is_defined():
    first, second = (svg.inline_svg(cloud, alt="Cloud", prefix=p) for p in ("a", "b"))
    ids = re.findall(r' id="([^"]+)"', (first + second).replace(' id="x"', ""))
    assert len(ids) == len(set(ids))
    assert set(re.findall(r"#([\w.-]+)", first + second)) == set(ids)


def test_inline_figures_name_no_network_address_style_sheet_or_script():
    text = svg.inline_svg(cloud, alt="Cloud", prefix="map")
    assert not re.search(r"http|<style|<script|<metadata|font-family|xmlns", text)


def test_the_same_drawing_gives_the_same_text():
    assert svg.inline_svg(cloud, alt="C", prefix="a") == svg.inline_svg(cloud, alt="C", prefix="a")


def test_the_readers_own_settings_change_nothing_and_are_kept():
    plain = svg.inline_svg(cloud, alt="C", prefix="a")
    with mpl.rc_context({"axes.grid": True, "lines.linewidth": 9, "svg.fonttype": "path"}):
        assert svg.inline_svg(cloud, alt="C", prefix="a") == plain
        assert mpl.rcParams["lines.linewidth"] == 9


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_a_saved_file_is_the_same_each_time(tmp_path, suffix):
    first, second = (svg.save(cloud, tmp_path / f"{n}.{suffix}").read_bytes() for n in "ab")
    assert first == second


def test_a_file_has_the_light_colours_on_paper():
    text = svg.standalone_svg(cloud, title="Cloud")
    assert {theme.C1, theme.C2, theme.DATA, theme.SURFACE} <= set(re.findall("#[0-9a-f]{6}", text))
    assert ElementTree.fromstring(text).get("aria-label") == "Cloud"


def test_an_unknown_file_type_is_refused_with_the_known_ones(tmp_path):
    with pytest.raises(ValueError, match=r"png, svg, pdf, got 'a\.gif'"):
        svg.save(cloud, tmp_path / "a.gif")


@pytest.mark.parametrize(
    ("alt", "prefix"), [(" ", "a"), ("A", ""), ("A", 'x" onload="'), ("A", "9")]
)
def test_a_figure_without_description_or_with_an_odd_prefix_is_refused(alt, prefix):
    with pytest.raises(ValueError, match=r"alt|prefix"):
        svg.inline_svg(cloud, alt=alt, prefix=prefix)


def test_no_two_colours_of_the_palette_are_equal():
    names = [
        "INK",
        "MUTED",
        "LINE",
        "DATA",
        "C1",
        "C2",
        "C3",
        "C4",
        "STICK",
        "SLIP_BACK",
        "SURFACE",
    ]
    assert len({getattr(theme, name) for name in names}) == len(names) == len(theme.VARIABLES)


def test_bands_that_touch_become_one():
    axes = Figure().add_subplot()
    theme.shade(axes, [(2, 3), (0, 1), (1, 1.5), (0.2, 0.4)])
    assert sorted(patch.get_x() for patch in axes.patches) == [0, 2]


def test_names_of_curves_that_end_close_together_do_not_overlap():
    figure = Figure(figsize=(5, 3), dpi=72, layout="constrained")
    axes = figure.add_subplot()
    axes.set(xlim=(0, 1), ylim=(0, 1))
    ends = [(0.50, "Dahl", theme.C1), (0.51, "LuGre", theme.C2), (0.505, "Stribeck", theme.C3)]
    theme.label_column(axes, 1, ends)
    figure.draw_without_rendering()
    boxes = sorted(text.get_window_extent().y0 for text in axes.texts)
    # Text boxes differ by fractions of a pixel with their ascenders.
    assert np.diff(boxes).min() > 11


positions = st.lists(st.floats(-1e3, 1e3), max_size=12)


@given(positions, st.floats(0, 100))
def test_spread_positions_keep_the_gap_and_the_order(wanted, gap):
    placed = theme.spread(wanted, gap)
    order = sorted(range(len(wanted)), key=lambda i: (wanted[i], i))
    steps = np.diff([placed[i] for i in order])
    # Sums of 12 terms of up to 2e3 carry rounding of about 1e-12.
    assert (steps >= gap - 1e-9).all()
    assert len(placed) == len(wanted)


@given(positions, st.floats(0, 100))
def test_spreading_does_not_move_the_mean_and_leaves_good_positions_alone(wanted, gap):
    placed = theme.spread(wanted, gap)
    if wanted:
        assert np.mean(placed) == pytest.approx(np.mean(wanted), abs=1e-9)
    if len(wanted) < 2 or np.diff(sorted(wanted)).min() > gap + 1e-9:
        assert placed == pytest.approx(wanted, abs=1e-9)


def symbols(figure: Figure, narrow: bool) -> None:
    axes = figure.add_subplot()
    static = theme.symbol_label("F_s")
    axes.set_title(f"1/e of {static} − {theme.symbol_label('mu_d')} is left")


def test_symbols_in_figures_have_subscripts_and_stay_text_in_the_order_of_reading():
    root = ElementTree.fromstring(svg.inline_svg(symbols, alt="a", prefix="p", narrow=None))
    (text,) = [t for t in root.iter("text") if t.findall("tspan")]
    pieces = text.findall("tspan")
    shown = "".join(piece.text for piece in pieces).replace("\N{NO-BREAK SPACE}", " ")
    assert shown == "1/e of Fs − μd is left"
    # the subscripts alone are below the line, and all return to it
    heights = np.cumsum([float(piece.get("dy", 0.0)) for piece in pieces])
    lowered = [piece.text for piece, height in zip(pieces, heights, strict=True) if height > 1.0]
    assert lowered == ["s", "d"]
    assert abs(heights[-1]) < 0.02  # of numbers with two decimals
    # no piece but the first has a place of its own, which would be that of another face
    assert [piece.get("x") for piece in pieces] == ["0", *[None] * (len(pieces) - 1)]


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("sigma_0", r"$\sigma_{\mathrm{0}}$"),
        ("F_c_max", r"$F_{\mathrm{c,max}}$"),
        ("Fn", r"$\mathit{Fn}$"),
        ("my level [N]", "my level [N]"),
        ("5 $", r"5 \$"),
    ],
)
def test_any_name_of_a_parameter_can_be_a_label(name, label):
    assert theme.symbol_label(name) == label
    figure = Figure()
    figure.add_subplot().set_title(theme.symbol_label(name))
    figure.draw_without_rendering()  # matplotlib raises on a formula that it cannot read


def test_the_schematics_have_the_subscripts_of_the_paper():
    for kind, names in (("cart", ["Ff"]), ("rig", ["μd, μs"])):
        root = ElementTree.fromstring(schematic(kind, alt="a", prefix="p"))
        texts = ["".join(text.itertext()) for text in root.iter("text")]
        assert [
            t.replace("\N{NO-BREAK SPACE}", " ") for t in texts if "d" in t or "f" in t
        ] == names
        assert not any("_" in text for text in texts)
