"""Blocks refuse what would make a report useless or wrong."""

import dataclasses
import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stickslip.show import report

OPENING = {"kicker": "One travel", "verdict": "Use Coulomb.", "lede": "It is enough."}
TEXT = report.Paragraph(text="Text.")


@pytest.mark.parametrize("cannot_tell", [(), ("",), (" ", "")])
def test_a_verdict_without_what_it_cannot_tell_is_refused(cannot_tell):
    with pytest.raises(ValueError, match="cannot_tell must not be empty"):
        report.Opening(**OPENING, cannot_tell=cannot_tell)


@pytest.mark.parametrize("name", ["settles", "cannot_tell", "measure_next"])
def test_a_list_of_the_opening_has_at_most_three_items(name):
    lists = {"cannot_tell": ("One thing.",), name: ("a", "b", "c", "d")}
    with pytest.raises(ValueError, match=f"{name}: at most 3 items, got 4"):
        report.Opening(**OPENING, **lists)


def test_blocks_cannot_be_changed():
    with pytest.raises(dataclasses.FrozenInstanceError):
        TEXT.text = "Other."


@pytest.mark.parametrize(
    "svg",
    [
        "<p>no drawing</p>",
        "<svg></svg>",
        '<svg aria-label="a"></svg><svg></svg>',
        '<svg aria-label="a"><script>x</script></svg>',
        '<svg aria-label="a" onload="x()"></svg>',
        '<svg aria-label="a"><use href="https://a.org/b.svg"/></svg>',
        '<svg aria-label="a"><use xlink:href="other.svg"/></svg>',
        '<svg aria-label="a"><image width="1"/></svg>',
    ],
)
def test_a_figure_needs_a_label_and_may_not_load_or_run_anything(svg):
    with pytest.raises(ValueError, match="figure"):
        report.Figure(svg=svg)


def test_a_page_needs_a_section_and_each_id_once():
    section = report.Section(id="a", nav="A", heading="A", blocks=(TEXT,))
    for sections in ((), (section, section)):
        with pytest.raises(ValueError, match="each id once"):
            report.Page(title="T", subject="S", footer="F", sections=sections)


@pytest.mark.parametrize("name", ["", "A", "a b", '"'])
def test_a_section_id_is_a_plain_word(name):
    with pytest.raises(ValueError, match="made of a-z"):
        report.Section(id=name, nav="A", heading="A", blocks=(TEXT,))


def test_a_link_that_is_not_to_the_web_is_refused():
    with pytest.raises(ValueError, match="must begin with https"):
        report.Reference(title="T", url="javascript:alert(1)")


def test_a_table_refuses_empty_cells_ragged_rows_no_rows_and_plots_without_axis():
    columns = (report.Column(head="model"), report.Column(head="travel"))
    plot = report.RowPlot(marks=(report.Mark(kind="dot", at=1),))
    bad = [
        ((), "no rows"),
        ((report.Row(cells=("a",)),), "2 columns but the row"),
        ((report.Row(cells=("a", " ")),), "say in words"),
        ((report.Row(cells=("a", report.Number(value=""))),), "say in words"),
        ((report.Row(cells=("a", plot)),), "have no axis"),
    ]
    for rows, message in bad:
        with pytest.raises(ValueError, match=message):
            report.Table(columns=columns, rows=rows)


@pytest.mark.parametrize(
    "fields",
    [
        {"low": 1.0, "high": 1.0},
        {"low": 0.0, "high": math.inf},
        {"low": 0.0, "high": 1.0, "ticks": (2.0,)},
        {"low": 0.0, "high": 1.0, "reference": math.nan},
        {"low": 0.0, "high": 1.0, "ticks": (0.5,), "labels": ("a", "b")},
    ],
)
def test_an_axis_that_cannot_be_drawn_is_refused(fields):
    with pytest.raises(ValueError, match="Axis"):
        report.Axis(**fields)


def test_a_bar_needs_an_end_and_a_dot_takes_none():
    with pytest.raises(ValueError, match="a bar needs `to`"):
        report.Mark(kind="bar", at=1.0)
    with pytest.raises(ValueError, match="a dot takes no `to`"):
        report.Mark(kind="dot", at=1.0, to=2.0)


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.floats(0, 1))
def test_positions_on_a_linear_axis_are_percent_of_its_length(low, width, share):
    axis = report.Axis(low=low, high=low + width)
    # Near 1e6 a width of 1e-3 keeps about 7 digits.
    assert axis.position(low + share * (axis.high - low)) == pytest.approx(100 * share, abs=1e-4)


def test_an_infinite_interval_is_clipped_and_gets_an_arrow_at_each_open_end():
    axis = report.Axis(low=0.1, high=10)
    bar = report.Mark(kind="bar", at=0.0, to=math.inf).shapes(axis)
    assert [shape.kind for shape in bar] == ["bar", "below", "above"]
    assert (bar[0].left, bar[0].right) == ("0%", "0%")
    assert [s.kind for s in report.Mark(kind="dot", at=11).shapes(axis)] == ["above"]
    assert [s.kind for s in report.Mark(kind="bar", at=-2, to=-1).shapes(axis)] == ["below"]
    assert report.Mark(kind="dot", at=math.nan).shapes(axis) == ()


def test_ticks_at_the_ends_do_not_stick_out_and_have_true_minus_signs():
    axis = report.Axis(low=-1, high=1, ticks=(-1, 0, 1))
    assert axis.placed_ticks() == (
        ("0%", "−1", "first"),
        ("50%", "0", "middle"),
        ("100%", "1", "last"),
    )


@pytest.mark.parametrize(
    ("ticks", "texts"),
    [
        ((3.998, 4.0, 4.002), ["3.998", "4", "4.002"]),
        ((13.8, 13.85, 13.9), ["13.8", "13.85", "13.9"]),
        ((2.398, 2.3995, 2.401), ["2.398", "2.3995", "2.401"]),
        ((0.01, 1.0, 100.0), ["0.01", "1", "100"]),
        ((0.0, 0.25, 0.5), ["0", "0.25", "0.5"]),
    ],
)
def test_numbers_of_ticks_stand_where_they_say(ticks, texts):
    axis = report.Axis(low=ticks[0], high=ticks[-1], ticks=ticks)
    assert [tick.text for tick in axis.placed_ticks()] == texts


def test_a_pure_number_in_a_table_has_no_unit():
    rows = tuple(
        report.Row(cells=(unit, report.Number(value="0.18", doubt="± 0.02", unit=unit)))
        for unit in ("1", "N s^2/m^2")
    )
    table = report.Table(columns=(report.Column(head="a"), report.Column(head="b")), rows=rows)
    section = report.Section(id="a", nav="A", heading="A", blocks=(table,))
    page = report.Page(title="Rig", subject="rig.toml", sections=(section,), footer="stickslip")
    said = re.findall(r'<span class="unit">(.*?)</span>', report.render(page))
    assert said == ["N s<sup>2</sup>/m<sup>2</sup>"]
