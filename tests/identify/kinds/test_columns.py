"""Columns of tables of candidates: one list, read by DataFrames, terminals and pages."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import pytest

from stickslip.identify.kinds import Column, data_row, page_table, terminal_table
from stickslip.identify.kinds.features import FeatureKind
from stickslip.identify.kinds.simulated import SimulatedCandidate, SimulatedKind
from stickslip.identify.kinds.velocity_steps import VelocityStepKind
from stickslip.show.formatting import EstimateText
from stickslip.show.report import Number


@dataclass
class One:
    """What a column asks of a candidate here."""

    name: str
    size: float
    second: float | None = None
    dropped: str = ""


COLUMNS = (
    Column(key="law", title="law", page="model", value=lambda one: one.name,
           text=lambda one: one.name, numeric=False),
    Column(key="score", title="error", page="error", unit="mm", why_empty="no score",
           value=lambda one: one.size,
           text=lambda one: EstimateText(f"{1e3 * one.size:.1f}", "± 0.1") if one.size else None),
    Column(title="second", page="second\nrecord", optional=True, value=lambda one: one.second,
           text=lambda one: "none" if one.second is None else str(one.second)),
    Column(key="loss", value=lambda one: one.size**2),
)  # fmt: skip
ROWS = [One("dahl", 1e-3), One("stribeck", 4e-3), One("lugre", 0.0, dropped="not fitted")]


def page(rows):
    return page_table(COLUMNS, rows, chosen=ROWS[0], caption="")


def test_each_medium_has_the_columns_that_have_a_name_for_it():
    assert list(data_row(COLUMNS, ROWS[0])) == ["law", "score", "loss"]
    assert terminal_table(COLUMNS, ROWS)[0] == ["law", "error"]
    assert [column.head for column in page(ROWS).columns] == ["model", "error\nmm"]


def test_a_terminal_says_the_unit_in_the_cell_and_a_page_in_the_heading():
    assert terminal_table(COLUMNS, ROWS)[1] == [
        ["dahl", "1.0 ± 0.1 mm"],
        ["stribeck", "4.0 ± 0.1 mm"],
        ["lugre", "—"],
    ]
    first, _, second = page(ROWS).rows
    assert first.cells[1] == Number(value="1.0", doubt="± 0.1")
    assert second.cells[1] == "no score"
    assert (first.chosen, first.muted, second.chosen, second.muted) == (True, False, False, True)


def test_a_column_that_is_optional_is_there_if_any_candidate_has_a_value():
    rows = [*ROWS, One("viscous", 1e-3, second=0.5)]
    heads, cells = terminal_table(COLUMNS, rows)
    assert heads[-1] == "second"
    assert [row[-1] for row in cells] == ["none", "none", "none", "0.5"]
    assert page(rows).columns[-1].head == "second\nrecord"


def candidate(kind, **values):
    return SimulatedCandidate(kind=kind, name="coulomb", title="Coulomb", fit=None, **values)


def test_a_law_without_a_fit_has_all_columns_of_a_dataframe():
    row = candidate(VelocityStepKind(), dropped="the slider runs away").to_row()
    assert list(row) == ["law", "parameters", "leaves", "probability", "a_minus_b", "outcome"]
    assert row["leaves"] is row["a_minus_b"] is None


def test_a_terminal_shows_the_probability_of_a_law_and_its_second_record():
    kind = VelocityStepKind()
    one = candidate(kind, second={"coefficient": 2e-3})
    heads, ((_, *cells),) = terminal_table(kind.all_columns, [one])
    assert heads == ["law", "parameters", "leaves", "probability", "a − b", "second record"]
    assert cells == ["—", "no score", "—", "—", "0.00200"]


def test_a_law_on_features_shows_its_probability_and_what_it_misses():
    errors = {"frequency": -0.03, "mean": 0.04, "standard_deviation": 0.0}
    fit = SimpleNamespace(estimates=(1, 2), rms=0.05, details={"errors": errors})
    kind = FeatureKind()
    one = replace(candidate(kind, probability=0.9, second={"mean": 0.08}), fit=fit)
    heads, (row,) = terminal_table(kind.all_columns, [one])
    assert heads[4:] == ["frequency", "mean", "deviation", "second record"]
    assert row == ["Coulomb", "2", "0.0500", "90 %", "−3 %", "+4 %", "0 %", "0.0800"]


@pytest.mark.parametrize("kind", [FeatureKind(), VelocityStepKind()])
def test_keys_and_headings_of_a_kind_stand_once(kind):
    columns = kind.all_columns
    for names in ([column.key for column in columns], [column.title for column in columns],
                  [column.page for column in columns]):  # fmt: skip
        given = [name for name in names if name]
        assert len(set(given)) == len(given)


def test_a_kind_that_defines_no_problem_says_what_is_missing():
    with pytest.raises(NotImplementedError, match="VelocityStepKind defines neither problem nor"):
        SimulatedKind.problem(VelocityStepKind(), None, {}, None)
