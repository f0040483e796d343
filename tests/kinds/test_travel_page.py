"""The report of a selection holds for a tie, one law, a ranking, and where nothing fits."""

import contextlib
import dataclasses
import re
from functools import partial
from html.parser import HTMLParser

import numpy as np
import pytest
from tests.support import sketched

from stickslip import (
    Coulomb,
    CoulombViscous,
    Dahl,
    LuGre,
    SpringBlock,
    Stribeck,
    Viscous,
    select,
    simulate,
)
from stickslip.errors import SimulationError
from stickslip.experiments import Measurement
from stickslip.formatting import quantity
from stickslip.kinds.report import verdict_page
from stickslip.kinds.travels.page.runs import steps_heading
from stickslip.report import Paragraph, Section
from stickslip.report.core import documents, markup
from stickslip.report.core.documents import Origin
from stickslip.report.core.page import render
from stickslip.selection import compare_fixed_steps

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
READING = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
SIX = (
    Coulomb,
    Viscous(viscous_coefficient=5.0),
    CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.5),
    Stribeck,
    Dahl,
    LuGre(
        kinetic_coefficient=0.25,
        static_coefficient=0.35,
        stribeck_velocity=0.05,
        bristle_stiffness=1000.0,
        bristle_damping=1.0,
        static_switch=True,
    ),
)
VOID = {"meta", "br", "hr"}


class Reader(HTMLParser):
    """Fails on tags that are not closed in order; collects headings, labels and text."""

    def __init__(self, html):
        super().__init__(convert_charrefs=True)
        self.open, self.texts, self.headings, self.labels = [], [], {}, []
        self.section = ""
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        if tag == "section":
            self.section = attrs["id"]
        if tag == "svg":
            self.labels.append(attrs["aria-label"])
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "style" in self.open:
            return
        data = data.replace("\N{NO-BREAK SPACE}", " ")
        self.texts.append(data)
        if "h1" in self.open or "h2" in self.open:
            self.headings[self.section] = self.headings.get(self.section, "") + data

    @property
    def text(self):
        return re.sub(r"\s+", " ", "".join(self.texts))


def page_of(verdict, *, whole=False, **more):
    """Return a page; a `whole` one has its figures for narrow screens too."""
    origin = Origin(
        title="Spring and block",
        data="Three travels",
        file="rig.toml",
        versions={"stickslip": "0.1.0", "Python": "3.11"},
        digest="sha256:0123abcd",
        commands=("stickslip select rig.toml",),
    )
    with contextlib.nullcontext() if whole else sketched():
        return verdict_page(verdict, origin, **more)


def read(page):
    html = render(page)
    reader = Reader(html)
    shown = re.sub(r"<style.*?</style>", "", html, flags=re.DOTALL)
    assert not re.search(r"\b(?:nan|inf|None)\b", shown)
    return reader


def three_trials():
    true = CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=0.8)
    trials = []
    for compression in (0.06, 0.10, 0.15):
        rig = dataclasses.replace(RIG, compression=compression)
        run = simulate(rig, true, t_end=4.0)
        travel = float(run.at([4.0])["x"][0])
        trials.append(
            Measurement(
                travel=round(travel, 3),
                uncertainty=0.0005,
                uncertainty_kind="rounding",
                overrides={"mechanism.compression": compression},
            )
        )
    return Measurement(trials=tuple(trials))


@pytest.fixture(scope="module")
def tie():
    return select(RIG, SIX, READING, t_end=1.5)


@pytest.fixture(scope="module")
def tie_page(tie):
    return read(page_of(tie, whole=True))


@pytest.fixture(scope="module")
def alone():
    return select(RIG, [Coulomb], READING, t_end=1.5)


@pytest.fixture(scope="module")
def alone_page(alone):
    return page_of(alone)


@pytest.fixture(scope="module")
def ranked():
    return select(RIG, [Coulomb, Viscous, CoulombViscous], three_trials(), t_end=4.0)


@pytest.fixture(scope="module")
def failed():
    return select(
        RIG,
        [Coulomb, CoulombViscous],
        Measurement(travel=5.0, uncertainty=0.05, uncertainty_kind="rounding"),
        t_end=1.5,
    )


@pytest.mark.slow
def test_a_tie_opens_with_the_estimate_its_error_as_given_and_how_many_models_fit(tie_page):
    assert "0.255 0.249 to 0.261" in tie_page.text
    assert "1.9 %" in tie_page.text
    assert "6 of 6 models" in tie_page.text


def test_the_sections_of_a_tie_stand_in_the_order_of_a_decision(tie_page):
    assert list(tie_page.headings) == [
        "verdict",
        "models",
        "criteria",
        "run",
        "laws",
        "parameters",
        "steps",
        "next",
        "certificate",
        "reproduce",
    ]


def test_headings_state_what_was_computed(tie_page):
    headings = tie_page.headings
    assert re.match(
        r"Fitted to 0\.2 m, four of the five other models stay within \d mm of Coulomb",
        headings["models"],
    )
    assert "stops after 0.474 s" in headings["run"]
    assert "would distinguish Viscous" in headings["next"]
    assert headings["parameters"] == "Fitted: μk = 0.255"


def test_the_spring_back_of_bristles_is_called_physics_and_names_its_laws(tie_page):
    assert tie_page.headings["criteria"].startswith("The block springs back with Dahl")
    assert "rejects correct models" in tie_page.text
    assert "held at its first stop" in tie_page.text  # LuGre has its switch


def test_why_there_is_no_score_is_said_in_words(tie, tie_page):
    assert tie.words.no_score in tie_page.text


def test_every_model_has_its_row_with_what_it_assumes(tie, tie_page):
    for candidate in tie.candidates:
        assert candidate.title in tie_page.text
    assert "σ0 1,000 1/m" in tie_page.text


def test_every_figure_says_what_it_shows(tie_page):
    assert len(tie_page.labels) >= 12
    assert all(len(label) > 10 for label in tie_page.labels)


def test_the_certificate_counts_the_runs_that_passed(tie_page):
    assert "6 of 6 certified" in tie_page.text
    assert "exactly 0" in tie_page.text


def test_what_is_needed_to_reproduce_and_to_cite_is_there(tie_page):
    for part in ("$ stickslip select rig.toml", "sha256:0123abcd", "P. R. Dahl", "LuGre"):
        assert part in tie_page.text


@pytest.mark.parametrize("whole", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_the_page_is_the_same_each_time(alone, whole):
    assert render(page_of(alone, whole=whole)) == render(page_of(alone, whole=whole))


def test_one_law_alone_is_not_compared(alone_page):
    reader = read(alone_page)
    assert reader.headings["models"] == "Coulomb, fitted to 0.2 m"
    assert "next" not in reader.headings
    assert "of 1 models" not in reader.text


@pytest.mark.slow
def test_a_ranking_shows_scores_and_each_trial(ranked):
    assert ranked.best.name == "coulomb-viscous"
    reader = read(page_of(ranked))
    assert re.match(r"Coulomb \+ viscous friction: held-out error", reader.headings["models"])
    assert "trials" in reader.headings
    assert "held-out error" in reader.text
    assert "x0 = 0.15 m" in reader.text
    assert "3 travels at 3 settings" in reader.text


def test_where_nothing_fits_each_law_says_why_it_was_dropped(failed):
    assert failed.best is None
    reader = read(page_of(failed))
    assert "No candidate explains the measurement" in reader.text
    assert reader.headings["models"] == "No model reaches the measured travel"
    assert reader.text.count("dropped: no value of") == 2
    assert "run" not in reader.headings


def test_fixed_steps_are_reported_with_how_often_they_reverse_the_body(alone, alone_page):
    reader = read(alone_page)
    found = re.fullmatch(
        r"With a fixed step of (1|2|5|10) ms without a stick rule, the velocity reverses"
        r" (\d+) times",
        reader.headings["steps"],
    )
    dt = 1e-3 * float(found[1])
    stop = alone.best.criteria.stop_time
    rows = compare_fixed_steps(RIG, alone.best.fit.law, t_end=2.0 * stop, steps=(dt,))
    assert int(found[2]) == max(row.reversals for row in rows)
    assert "Velocity of the exact run and with fixed steps" in reader.labels


def test_only_reversals_beyond_those_of_the_exact_run_are_counted(alone):
    law = alone.best.fit.law
    exact, held, chattering = compare_fixed_steps(RIG, law, t_end=1.0, steps=(0.01,))
    assert (exact.reversals, held.reversals) == (0, 0)
    turning = [
        dataclasses.replace(row, reversals=row.reversals + 2) for row in (exact, held, chattering)
    ]
    assert steps_heading(turning).endswith(
        f"the velocity reverses {chattering.reversals} times more than the exact run"
    )
    assert steps_heading(turning[:2]) == "Fixed steps and the exact run"


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [1e4, 1e5])
def test_a_step_that_bristles_do_not_allow_is_said_and_costs_nothing(stiffness):
    law = Dahl.from_forces(load=9.81, kinetic_force=2.5, bristle_stiffness=stiffness)
    reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    verdict = select(RIG, {"dahl": law}, reading, t_end=1.0)
    reader = read(page_of(verdict))
    run = verdict.best.run
    # 2 g / (sigma_0 v) at the largest speed, with the fitted level
    level = verdict.best.fit.law.kinetic_coefficient * 9.81
    limit = 2.0 * level / (stiffness * float(run.at(np.linspace(0.0, 1.0, 4001))["v"].max()))
    said = quantity(limit, "s", 2)
    assert f"need steps below {said}" in reader.text
    assert "too large for this law" in reader.headings["steps"]
    if stiffness == 1e5:
        assert "diverges within" in reader.text


def failing_section(_verdict):
    raise SimulationError("a comparison that cannot be made")


def test_a_section_that_fails_becomes_one_line(alone, monkeypatch):
    monkeypatch.setattr(documents, "CAUGHT", (Exception,))
    reader = read(page_of(alone, extra=[partial(failing_section, alone)]))
    assert reader.headings["failing"] == "Failing"
    assert "SimulationError: a comparison that cannot be made." in reader.text
    assert reader.headings["models"]


def test_a_spring_that_stays_attached_is_not_called_elastic_deflection():
    rig = dataclasses.replace(RIG, attached=True)
    reading = Measurement(travel=0.1, uncertainty=0.005, uncertainty_kind="rounding")
    reader = read(page_of(select(rig, [Coulomb, Dahl], reading, t_end=1.5)))
    assert "This is physical" not in reader.text
    assert "The mechanism pulls the block back" in reader.text


def test_a_law_alone_is_compared_with_a_contact_that_does_not_deflect():
    rig = dataclasses.replace(RIG, attached=True)
    reading = Measurement(travel=0.1, uncertainty=0.005, uncertainty_kind="rounding")
    reader = read(page_of(select(rig, [Dahl], reading, t_end=1.5)))
    assert "This is physical" not in reader.text
    assert "The mechanism pulls the block back" in reader.text


def test_fitted_rows_that_agree_in_every_column_are_one_sentence():
    reader = read(page_of(select(RIG, [Coulomb, CoulombViscous], READING, t_end=1.5)))
    assert "The two models agree in every column" in reader.text
    assert "travel 0.200 m, lowest velocity 0 mm/s, largest back-slip 0 mm" in reader.text


def test_sections_of_ones_own_stand_after_the_verdict_and_before_what_to_measure(tie):
    lead, extra = (
        Section(id=name, nav=name, heading=name, blocks=(Paragraph(text=name),))
        for name in ("lead", "extra")
    )
    ids = [part.id for part in page_of(tie, lead=(lead,), extra=(extra,)).sections]
    assert ids[1] == "lead"
    assert ids[ids.index("next") - 1] == "extra"


def test_an_interval_without_an_end_is_a_sentence():
    reading = Measurement(travel=0.20)
    reader = read(page_of(select(RIG, [Coulomb], reading, t_end=1.5)))
    assert "no uncertainty of the reading was stated" in reader.text
    assert "no uncertainty stated" in reader.text


def test_the_title_is_plain_text(alone_page):
    assert markup.plain(alone_page.title) == "Friction model selection: Spring and block"


def test_the_heading_of_fixed_steps_is_of_the_step_that_the_panels_show(alone):
    law = alone.best.fit.law
    rows = compare_fixed_steps(RIG, law, t_end=1.0, steps=(0.01, 0.001))
    assert max(rows, key=lambda row: row.reversals).dt == 0.001
    assert steps_heading(rows).startswith("With a fixed step of 10 ms without a stick rule")
