"""What a plan of travels says, section by section."""

import pytest

from stickslip import Coulomb, SpringBlock, plan
from stickslip.identify.kinds.plan_sheet import plan_sections
from stickslip.show.report import Table

BLOCK = SpringBlock(mass=0.82, stiffness=145.0, compression=0.08)


@pytest.fixture(scope="module")
def sheet():
    return plan(
        BLOCK, ["coulomb", "coulomb-viscous", "viscous"], parameter_uncertainties={"stiffness": 2.9}
    )


def test_it_says_how_well_the_rig_is_to_be_known(sheet):
    first, before, *_ = plan_sections(sheet)
    assert any("2 % of the longest travel, until repeats" in x.text for x in first.blocks)
    (table,) = before.blocks
    assert "2.9 N/m, too large" in [row.cells[-1] for row in table.rows]


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
