"""A number reads the same in a terminal, in JSON and on a page."""

import json
import math
import re
from html import unescape

from hypothesis import given
from hypothesis import strategies as st

from stickslip.cli.console import plain, show_table
from stickslip.identify import Estimate
from stickslip.identify.candidates import score_text
from stickslip.quantities import Quantity
from stickslip.show.documents import json_text
from stickslip.show.formatting import NO_BREAK_SPACE, PREFIXES, Scale, scale_of, unbroken, with_unit
from stickslip.show.report import Page, Paragraph, Section, Table
from stickslip.show.report.blocks import Fact, Facts, render
from stickslip.show.report.tables import Column, Number, Row

units = st.sampled_from([*PREFIXES, "1", "N s/m", "N s^2/m^2", "kg m^2", "m/s^2", "1/m"])
values = st.floats(1e-12, 1e9) | st.floats(-1e9, -1e-12)
errors = st.floats(1e-7, 10.0)


def page_of(*blocks):
    section = Section(id="a", nav="A", heading="A", blocks=blocks)
    return render(Page(title="Rig", subject="rig.toml", sections=(section,), footer="stickslip"))


def raised(match):
    return match[1].translate(str.maketrans("−0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def seen_on(html):
    """The text that a reader of a page sees, with ordinary spaces."""
    body = html.partition("<main")[2]
    text = re.sub(r"<sup>([^<]*)</sup>", raised, body)
    return " ".join(unescape(re.sub(r"<[^>]*>", "", text)).replace(NO_BREAK_SPACE, " ").split())


def printed(capsys, *cells):
    """What a terminal shows of the cells of a table."""
    capsys.readouterr()
    show_table("", [f"h{i}" for i in range(len(cells))], [cells])
    return " ".join(capsys.readouterr().out.split())


@given(value=values, error=errors, unit=units)
def test_a_value_with_its_error_reads_the_same_in_json_and_on_a_page(value, error, unit):
    half = abs(value) * error
    scale = scale_of([value], unit)
    told = scale.estimate(value, half)
    assert NO_BREAK_SPACE not in told
    assert json.loads(json_text({"text": told}))["text"] == told
    assert plain(told) == told
    parts = scale.estimate_text(value, half)
    head = "" if scale.unit == "1" else scale.unit
    number = Number(value=parts.value, doubt=parts.doubt, unit=told.removeprefix(" ".join(parts)))
    fact = Fact(value=parts.value, aside=told.removeprefix(parts.value).strip(), what="error")
    table = Table(columns=(Column(head=head or "value"),), rows=(Row(cells=(number,)),))
    for block in (Paragraph(text=f"It is {told}."), table, Facts(facts=(fact,))):
        assert told in seen_on(page_of(block))
    # no line of a page ends within it
    assert " " not in unbroken(told)


@given(value=values, error=errors, unit=units)
def test_a_fitted_parameter_reads_the_same_in_text_and_table(value, error, unit):
    half = abs(value) * error
    found = Estimate(
        path="friction.x",
        quantity=Quantity("x", unit),
        value=value,
        low=value - half,
        high=value + half,
        interval="95 %",
    )
    text, doubt = found.parts
    assert found.plus_minus.startswith(f"{text} {doubt}".strip())
    assert Scale(1.0, unit).estimate(value, found.half_width) == found.plus_minus


@given(scores=st.lists(st.floats(1e-9, 1e3), min_size=1), unit=units)
def test_a_score_in_a_column_is_the_score_in_the_sentence(scores, unit):
    scale = scale_of(scores, unit)
    assert with_unit(score_text(scale, scores[0]), scale.unit) == scale.error(scores[0])
    assert score_text(scale, math.inf) == "no score"


def test_the_terminal_leaves_numbers_as_they_are(capsys):
    told = Scale(1e3, "mN").estimate(0.0195, 0.00073)
    assert told == "19.5 ± 0.7 mN"
    assert printed(capsys, "dahl", told) == f"h0 h1 dahl {told}"
