"""The sheet of a plan as a page."""

import re

import pytest

from stickslip import Coulomb, SpringBlock, plan
from stickslip.identify.kinds.plan_sheet import plan_page, plan_sections
from stickslip.show.report import Origin, Table, render

BLOCK = SpringBlock(mass=0.82, stiffness=145.0, compression=0.08)


@pytest.fixture(scope="module")
def sheet():
    return plan(
        BLOCK, ["coulomb", "coulomb-viscous", "viscous"], parameter_uncertainties={"stiffness": 2.9}
    )


@pytest.fixture(scope="module")
def page(sheet):
    origin = Origin(
        title="Own block", data="rig.toml", digest="abc", commands=("stickslip plan rig.toml",)
    )
    made = plan_page(sheet, origin, save_as="stickslip select rig.toml --data sheet.csv")
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
    assert [section.id for section in plan_sections(alone)] == [
        "plan", "before", "settings", "values",
    ]  # fmt: skip


def test_a_parameter_has_an_interval_or_is_not_identified(sheet):
    (values,) = (section for section in plan_sections(sheet) if section.id == "values")
    (table,) = (block for block in values.blocks if isinstance(block, Table))
    every = [one for own in sheet.expectations.values() for one in own]
    for row, estimate in zip(table.rows, every, strict=True):
        assert row.cells[-1] == (estimate.range if estimate.bounded else "not identified")
        assert row.muted == (not estimate.bounded)


def test_no_law_told_apart_is_a_section_without_a_table():
    laws = {
        "plain": Coulomb(kinetic_coefficient=0.25),
        "static": Coulomb(kinetic_coefficient=0.25, static_coefficient=0.3),
    }
    alike = plan(BLOCK, laws)
    (apart,) = (section for section in plan_sections(alike) if section.id == "apart")
    assert apart.heading == "The runs distinguish 0 of 1 pair of laws"
    (lines,) = apart.blocks
    assert lines.items[0].key == "Not distinguished by 10 runs at each setting"
