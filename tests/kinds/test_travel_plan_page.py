"""The sheet of a plan as a page."""

import re

import pytest

from stickslip import Coulomb, SpringBlock, plan
from stickslip.identify.kinds.travels.plan.page import plan_page
from stickslip.identify.kinds.travels.plan.tables import tables_of
from stickslip.show.report.blocks import render

BLOCK = SpringBlock(mass=0.82, stiffness=145.0, compression=0.08)


@pytest.fixture(scope="module")
def sheet():
    return plan(
        BLOCK, ["coulomb", "coulomb-viscous", "viscous"], parameter_uncertainties={"stiffness": 2.9}
    )


@pytest.fixture(scope="module")
def page(sheet):
    made = plan_page(
        sheet,
        title="Own block",
        subject="rig.toml",
        save_as="stickslip select rig.toml --data sheet.csv",
        reproduce=["stickslip plan rig.toml"],
        versions={"stickslip": "0.1.0"},
        digest="abc",
    )
    return render(made).replace("\N{NO-BREAK SPACE}", " ")


@pytest.mark.slow
def test_there_is_a_line_to_write_on_for_each_run(sheet, page):
    runs = len(sheet.runs())
    assert page.count('aria-label="travel, to fill in"') == runs
    assert len(re.findall(r">run \d+<", page)) == runs


def test_it_says_what_the_file_is_to_look_like(page):
    assert "name,mechanism.compression [mm],travel [mm]" in page
    assert "stickslip select rig.toml --data sheet.csv" in page


def test_it_says_how_well_the_rig_is_to_be_known(page):
    assert "2.9 N/m, too large" in page
    assert "Hang 1.18 kg on the spring" in page
    assert "2 % of the longest travel, until repeats" in page


def test_no_mark_of_the_markup_is_left(page):
    text = re.sub(r"<style>.*?</style>|<pre>.*?</pre>", "", page, flags=re.DOTALL)
    assert "$" not in text
    assert "**" not in text


def test_a_single_law_has_no_section_on_pairs():
    alone = plan(BLOCK, ["coulomb"])
    made = plan_page(alone, title="Own block", subject="", save_as="", versions={})
    assert [section.id for section in made.sections] == ["before", "settings", "values", "runs"]


def test_page_and_terminal_have_the_same_rows(sheet, page):
    """Both are made of `tables_of`; each of its cells stands in the page as it is."""
    text = re.sub(r"<[^>]*>", "\n", page)
    cells = {line.strip() for line in text.splitlines()}
    for table in tables_of(sheet):
        for row in table.rows:
            plain = [cell for cell in row.cells if "$" not in cell]
            assert cells.issuperset(plain), table.name


def test_a_parameter_has_an_interval_or_is_not_identified(sheet):
    (values,) = (table for table in tables_of(sheet) if table.name == "values")
    assert len(values.rows) == len(sheet.expectations)
    for row, expectation in zip(values.rows, sheet.expectations, strict=True):
        assert row.cells[-1] == (
            expectation.estimate.range if expectation.identified else "not identified"
        )
        assert row.muted == (not expectation.identified)


def test_no_law_told_apart_is_a_section_without_a_table():
    laws = {
        "plain": Coulomb(kinetic_coefficient=0.25),
        "static": Coulomb(kinetic_coefficient=0.25, static_coefficient=0.3),
    }
    alike = plan(BLOCK, laws)
    made = plan_page(alike, title="Own block", subject="", save_as="", versions={})
    (apart,) = (section for section in made.sections if section.id == "apart")
    assert apart.heading == "The runs distinguish 0 of 1 pair of laws"
    (lines,) = apart.blocks
    assert lines.items[0].key == "Not distinguishable by travels: both laws predict the same"
