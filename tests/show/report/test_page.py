"""A page is one well-formed file that loads nothing and says everything it was given."""

import dataclasses
import math
import re
from html.parser import HTMLParser

import pytest

from stickslip.errors import InputError
from stickslip.show import report
from stickslip.show.plots import C1, VARIABLES, inline_svg
from stickslip.show.report.blocks import render, write

VOID = {"meta", "br", "link", "img", "hr", "input"}
LONG_NAME = "GeneralisedMaxwellSlipWithFortyElements1"
EVIL = "<script>alert(1)</script> & \"quoted\" 'text'"


class Checker(HTMLParser):
    """Fails on tags that are not closed in order, and collects what tests ask for."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        assert len({key for key, _ in attrs}) == len(attrs), f"repeated attribute in {tag}"
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)


def line(figure, narrow):
    figure.add_subplot().plot([0, 1], [0, 1], color=C1)


def score_table(count: int = 25) -> report.Table:
    axis = report.Axis(low=0.1, high=20, ticks=(0.2, 1, 5), caption="error, mm")
    columns = (
        report.Column(head="model"),
        report.Column(head="free\nparameters", numeric=True, phone="hide"),
        report.Column(head="error\nmm", numeric=True, phone="label"),
        report.Column(head="", axis=axis),
        report.Column(head="outcome"),
    )
    rows = tuple(
        report.Row(
            cells=(
                report.Name(text=LONG_NAME if i == 3 else f"Model {i}", aside="control" * (i == 1)),
                str(i),
                report.Number(value="0.24", doubt="± 0.04", unit="mm"),
                report.RowPlot(
                    marks=(
                        report.Mark(kind="bar", at=0.2, to=math.inf if i == 2 else 0.3),
                        report.Mark(kind="dot", at=0.24),
                    )
                ),
                "**chosen**" if i == 0 else "no gain",
            ),
            chosen=i == 0,
            muted=i > 2,
        )
        for i in range(count)
    )
    return report.Table(columns=columns, rows=rows, caption="Dot: error.")


def everything(extra: str = "") -> report.Page:
    figure = report.Figure(
        svg=inline_svg(line, alt="A line", prefix="line"), caption=f"**L.** {extra}"
    )
    sketch = inline_svg(line, alt="A sketch", prefix="sketch", wide=(250, 84), narrow=None)
    own = report.Axis(low=0, high=0.5, ticks=(0, 0.5), reference=0.2)
    ring = report.RowPlot(
        axis=own, lanes=2, alt="Travel", marks=(report.Mark(kind="ring", at=0.3, colour="muted"),)
    )
    opening = report.Opening(
        kicker=f"One travel {extra}",
        verdict="Use Coulomb with $mu_d$ = 0.255.",
        lede=f"It is enough. {extra}",
        facts=(report.Fact(value="0.255", aside="0.249 to 0.261", what=f"$mu_d$ {extra}"),),
        settles=("Mean friction.",),
        cannot_tell=(f"$mu_s$. {extra}",),
        measure_next=("Pull slowly.",),
    )
    blocks = (
        report.Paragraph(text=extra or "Text."),
        figure,
        report.Gallery(panels=(report.Panel(svg=sketch, title="A.", text=extra, colour="c1"),)),
        report.Facts(facts=(report.Fact(value="3 × 10⁻¹⁵", what="mismatch"),)),
        score_table(),
        report.Table(
            columns=(report.Column(head=f"h {extra}"), report.Column(head="travel, m")),
            rows=(report.Row(cells=(f"r {extra}", ring)),),
        ),
        report.Table(
            columns=(report.Column(head="run"), report.Column(head="travel, mm")),
            rows=(report.Row(cells=("run 1", f"travel {extra}")),),
        ),
        report.Caption(text=f"Caption {extra}"),
        report.Columns(
            left=(report.Subheading(text="What moves together"),),
            right=(
                report.KeyValues(
                    items=tuple(
                        report.KeyValue(key=mark, value=f"v {extra}", mark=mark)
                        for mark in ("none", "ok", "warn", "bad")
                    )
                ),
            ),
        ),
        report.Note(title="Careful.", text=extra or "Short record."),
        report.Math(
            latex=r"F = \mu_d N \quad {} + c v, \quad s = \begin{cases} 1 & a \\ 0 & b \end{cases}",
            tag="(5)",
        ),
        report.Code(text=f"$ stickslip select {extra}"),
        report.References(
            items=(
                report.Reference(title=f"T {extra}", url='https://doi.org/10.1/"x'),
                report.Reference(authors="P. R. Dahl", title="T", where="1968", note="law"),
            )
        ),
    )
    return report.Page(
        title=f"Rig {extra}",
        subject=f"rig.toml {extra}",
        footer=f"stickslip 0.1.0 {extra}",
        sections=(
            report.Section(id="verdict", nav="Verdict", heading="", blocks=(opening,)),
            report.Section(id="rest", nav=f"Rest {extra}", heading=f"Rest {extra}", blocks=blocks),
        ),
    )


@pytest.fixture(scope="module")
def text() -> str:
    return render(everything())


def test_every_tag_is_closed_in_order_and_every_id_is_unique(text):
    ids = [attrs["id"] for _, attrs in Checker(text).tags if "id" in attrs]
    assert len(ids) == len(set(ids)) > 2


def test_the_page_carries_no_script_and_loads_nothing(text):
    checker = Checker(text)
    assert not {"script", "link", "img", "iframe", "object", "base"} & {t for t, _ in checker.tags}
    assert not re.search(r"@import|url\((?!#)|@font-face", text)
    for tag, attrs in checker.tags:
        assert not any(key.startswith("on") or key in {"src", "srcset", "srcdoc"} for key in attrs)
        assert tag == "a" or (attrs.get("href") or "#").startswith("#")
    assert set(re.findall(r"https?://[^\"]*", text)) == {"https://doi.org/10.1/&#34;x"}


def test_hostile_text_is_escaped_wherever_it_stands():
    text = render(everything(EVIL))
    checker = Checker(text)
    assert "script" not in {tag for tag, _ in checker.tags}
    assert "".join(checker.texts).count(EVIL) > 15


def test_every_drawing_is_labelled_and_every_section_is_in_the_contents(text):
    tags = Checker(text).tags
    drawings = [attrs for tag, attrs in tags if tag == "svg"]
    assert drawings
    assert all(attrs["aria-label"] and attrs["role"] == "img" for attrs in drawings)
    sections = [attrs["id"] for tag, attrs in tags if tag == "section"]
    links = [attrs["href"] for tag, attrs in tags if tag == "a" and attrs["href"].startswith("#")]
    assert links == [f"#{name}" for name in sections]
    assert dict(tags)["html"] == {"lang": "en"}


def test_the_page_has_one_main_heading_with_or_without_a_verdict():
    plain = report.Section(id="a", nav="A", heading="A", blocks=(report.Paragraph(text="A."),))
    page = report.Page(title="Only **text**", subject="s", footer="f", sections=(plain,))
    for each in (everything(), page):
        assert sum(tag == "h1" for tag, _ in Checker(render(each)).tags) == 1
    assert "<title>Only text</title>" in render(page)


def test_what_the_record_cannot_tell_is_never_hidden(text):
    assert "What it cannot tell" in text
    assert "<details" not in text


def test_the_same_page_gives_the_same_file():
    assert render(everything()) == render(everything())


def test_a_page_with_figures_is_smaller_than_six_hundred_kilobytes(text):
    assert len(text.encode()) < 600_000


def test_twenty_five_rows_may_break_over_printed_pages_and_short_tables_may_not(text):
    assert text.count('<tr class="muted">') == 22
    assert re.findall(r'<table class="(rows[^"]*)"', text) == ["rows long", "rows", "rows"]


def test_a_name_of_forty_characters_may_be_broken(text):
    assert len(LONG_NAME) == 40
    assert LONG_NAME in text
    assert re.search(r"tbody th \{[^}]*overflow-wrap: anywhere", text)


def test_marks_stand_at_their_percentage_and_an_infinite_interval_ends_in_an_arrow(text):
    at = f"{round(100 * (0.24 - 0.1) / (20 - 0.1), 2)}%"
    assert f'<span class="dot k-c1" style="left:{at}' in text
    assert text.count('class="above k-c1"') == 1
    assert '<i class="reference" style="left:40%">' in text


def test_on_a_phone_cells_are_labelled_or_hidden_and_the_axis_stands_above(text):
    assert 'data-label="error, mm"' in text
    assert '<td class="n hide">' in text
    assert text.count('class="phone-axis"') == 1


def test_contents_are_reachable_on_a_phone_and_left_out_in_print_only(text):
    style = text[text.index("<style>") : text.index("</style>")]
    screen = style[: style.index("@media print {\n  @page")]
    assert not re.search(r"nav \{[^}]*display: none", screen)
    assert "nav { position: sticky" in screen[screen.index("max-width: 1020px") :]


def test_a_collapsed_section_shows_its_heading_and_opens_without_a_script():
    blocks = (report.Paragraph(text="Inside."),)
    closed = report.Section(id="a", nav="A", heading="Finding", blocks=blocks, collapsed=True)
    page = report.render(report.Page(title="P", subject="", sections=(closed,), footer=""))
    assert "<details><summary><h2>Finding</h2></summary>" in page
    assert page.index("<p>Inside.</p>") < page.index("</details>")
    with pytest.raises(InputError, match="needs a heading to open it by"):
        dataclasses.replace(closed, heading="")


def test_letters_of_equations_need_no_font_for_mathematics(text):
    """Browsers put single letters into an alphabet that other fonts lack, unless told not to."""
    assert re.search(r"\.math mi \{ text-transform: none; font-style: italic \}", text)


def test_no_number_is_shown_as_nan_or_infinity(text):
    words = " ".join(Checker(re.sub(r"<style>.*?</style>", "", text, flags=re.DOTALL)).texts)
    assert not re.search(r"\b(nan|NaN|inf|Infinity|None)\b", words)


def test_two_figures_with_the_same_prefix_are_refused():
    figure = report.Figure(svg=inline_svg(line, alt="A line", prefix="line"))
    section = report.Section(id="a", nav="A", heading="A", blocks=(figure, figure))
    page = report.Page(title="T", subject="S", footer="F", sections=(section,))
    with pytest.raises(ValueError, match="prefix of its own"):
        render(page)


def test_the_style_sheet_uses_every_class_and_variable_it_defines_and_no_other(text):
    style = re.search(r"<style>(.*?)</style>", text, re.DOTALL)[1]
    body = text.replace(style, "")
    used = {name for names in re.findall(r'class="([^"]*)"', body) for name in names.split()}
    defined = set(
        re.findall(r"\.([a-z][\w-]*)(?=[^{}]*\{)", re.sub(r"/\*.*?\*/", "", style, flags=re.DOTALL))
    )
    # Kinds of marks, notes and colours that this page happens not to have.
    optional = {"info", "link", "triangle", "below", "k-c2", "k-c3", "k-c4", "k-data", "k-ink"}
    assert defined - used <= optional
    variables = set(re.findall(r"(--[a-z0-9-]+):", style))
    assert set(re.findall(r"var\((--[a-z0-9-]+)", style)) <= variables
    assert variables <= set(re.findall(r"var\((--[a-z0-9-]+)", text)) | {
        f"--{name}" for name in VARIABLES.values()
    }


def test_the_page_and_the_figures_have_the_same_light_colours(text):
    light = re.search(r":root \{(.*?)\}", text, re.DOTALL)[1]
    page = dict(re.findall(r"--([a-z0-9-]+): (#[0-9a-f]{6})", light))
    assert {name: page[name] for name in VARIABLES.values()} == {n: c for c, n in VARIABLES.items()}


def test_a_file_is_replaced_whole_and_leaves_no_draft(tmp_path):
    path = tmp_path / "report.html"
    path.write_text("old")
    assert write(everything(), str(path)) == path
    assert path.read_text(encoding="utf-8").endswith("</html>\n")
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.html"]


def test_a_page_that_cannot_be_rendered_leaves_the_old_file(tmp_path):
    path = tmp_path / "report.html"
    path.write_text("old")
    bad = report.Section(id="a", nav="A", heading="A", blocks=(report.Math(latex="x_1_2"),))
    with pytest.raises(ValueError, match="cannot read"):
        write(report.Page(title="T", subject="S", footer="F", sections=(bad,)), path)
    assert path.read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 1
