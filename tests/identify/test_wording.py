"""Sentences of a verdict: what a reader has to tell apart is told apart."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip import Axis, Measurement, select
from stickslip.identify.ensemble import PredictionBand
from stickslip.identify.explorer import Pattern
from stickslip.identify.fits import Estimate
from stickslip.identify.judge import Cause
from stickslip.identify.laws import TITLES, Composition
from stickslip.identify.page import laws_section, remarks_section, verdict_sections
from stickslip.identify.propose import Proposal
from stickslip.identify.wording import (
    Words,
    advice_sentence,
    band_sentence,
    cause_sentence,
    pattern_sentence,
    phrase_of,
    tells_friction,
)
from stickslip.quantities import Quantity
from stickslip.show.report import MOST, Origin

WORDS = Words(
    measured="record", held_out="stretches", response="force", force_unit="N", speed_unit="m/s"
)


@pytest.fixture(scope="module")
def verdict():
    v = np.geomspace(0.05, 1.0, 14)
    noise = 0.02 * np.random.default_rng(2).normal(size=14)
    return select(Axis(inertia=1.0), None, Measurement(velocity=v, friction=2.0 + v + noise))


SPEEDS = np.geomspace(0.01, 1.0, 9)


def banded(low, median, high):
    return PredictionBand(low=low, median=median, high=high)


def judged(named_band):
    return SimpleNamespace(named=(("level", ()),), named_band=named_band)


def test_a_band_that_holds_zero_is_said_to_reach_as_far_as_its_farther_end():
    band = banded(np.full(9, -0.1), np.linspace(0.02, 0.1, 9), np.linspace(0.1, 0.6, 9))
    assert "friction is within ± 0.6 N of zero" in band_sentence(SPEEDS, band, WORDS)
    other = banded(-band.high, -band.median, -band.low)
    assert "friction is within ± 0.6 N of zero" in band_sentence(SPEEDS, other, WORDS)


def test_what_grows_with_the_speed_is_told_from_zero_where_it_is_large():
    # 0.25 +- 0.05 N s/m, and 0.05 N of which nobody knows the sign
    band = banded(0.2 * SPEEDS - 0.05, 0.25 * SPEEDS, 0.3 * SPEEDS + 0.05)
    assert np.median((band.high - band.low) / 2.0 / band.median) > 1.0
    assert tells_friction(judged(band), band)
    wide = banded(-0.3 * SPEEDS, 0.25 * SPEEDS, 0.8 * SPEEDS)
    assert not tells_friction(judged(wide), wide)


def test_parameters_that_exclude_zero_by_far_tell_friction_whatever_the_curve_as_measured_says():
    level = np.ones(9)
    band = banded(-level, level, 3.0 * level)
    assert not tells_friction(judged(banded(0.9 * level, level, 1.1 * level)), band)  # by 10
    assert tells_friction(judged(banded(0.97 * level, level, 1.03 * level)), band)  # by 33


def test_a_band_of_nothing_tells_no_friction():
    nothing = banded(*np.zeros((3, 9)))
    assert not tells_friction(judged(nothing), nothing)


def test_few_places_are_listed_and_many_are_counted():
    proposal = Proposal(places=(0, 0, 1), shrinks=0.5)
    few = advice_sentence(proposal, ["1 m/s", "1 m/s", "2 m/s"])
    assert few.startswith("Measure at 1 m/s (2 readings) and 2 m/s: ")
    many = [f"{k} m/s" for k in range(1, 10) for _ in range(1 + (k == 4))]
    said = advice_sentence(Proposal(places=tuple(range(10)), shrinks=0.5), many)
    assert said.startswith("Take 10 readings at 9 velocities from 1 m/s to 9 m/s")
    assert "4 m/s (2)" in said


@pytest.mark.parametrize(
    ("scatter", "said"),
    [(False, "follows the place: 25 % of the squared error"), (True, "The scatter about the law")],
)
def test_a_pattern_is_said_with_its_feature_and_share(scatter, said):
    pattern = Pattern(
        feature="place", scatter=scatter, share=0.25, of_force=0.02, p=0.01, material=True
    )
    sentence = pattern_sentence(pattern, WORDS)
    assert said in sentence
    assert "25 %" in sentence
    assert ("2 % of the force" in sentence) != scatter


def test_laws_that_are_not_told_apart_have_other_names(verdict):
    assert len(verdict.set) > 1
    others = verdict.sentence.partition("tell it from ")[2]
    assert others
    assert verdict.closest.title.lower() not in {text.strip(". ") for text in others.split(",")}


def test_the_page_says_nothing_twice(verdict):
    origin = Origin(title="Axis", data="a table", file="axis.toml")
    sections = [make() for make in verdict_sections(verdict, origin, "")]
    text = [str(section.blocks) for section in sections if section is not None]
    for line in verdict.words.cannot_tell + verdict.words.measure_next:
        assert sum(line.replace("$", "") in part.replace("$", "") for part in text) == 1
    long = SimpleNamespace(words=SimpleNamespace(cannot_tell=("a",) * MOST + ("b",)))
    assert [item.value for item in remarks_section(long).blocks[0].items] == ["b"]


def test_the_table_of_laws_is_a_ladder(verdict):
    (table,) = laws_section(verdict).blocks
    assert len(table.rows) == len(verdict.candidates)
    counts = [int(row.cells[1]) for row in table.rows]
    assert counts == sorted(counts)
    steps = verdict.ladder
    assert [one.count for one in steps] == sorted(one.count for one in steps)
    assert all(0.0 <= one.distance <= one.worst for one in steps)
    assert sum(one.share for one in steps) <= 1.0 + 1e-9


@pytest.mark.parametrize(
    ("text", "phrase"),
    [("", "level + level that differs by direction"), ("level + viscous", "Coulomb + viscous")],
)
def test_terms_that_are_no_law_are_said_as_they_are(text, phrase):
    def term(name):
        return SimpleNamespace(title=TITLES[name], role="law")

    judgement = SimpleNamespace(
        ensemble=SimpleNamespace(fit=lambda _: SimpleNamespace(coefficients=np.ones(2))),
        problem=SimpleNamespace(
            composition=lambda *_: Composition(text=text, values={}),
            terms={name: term(name) for name in ("level", "level_direction")},
        ),
    )
    found = phrase_of(judgement, (("level", ()), ("level_direction", ())))
    assert found == (f"{phrase} friction" if text else phrase)


def test_a_size_without_an_interval_has_none():
    delay = Quantity("t_d", "s")
    cause = Cause(
        term="delay", title="delay of the force", share=0.4, left=0.01, explained=0.9, needed=True
    )
    estimate = Estimate(
        path="delay", quantity=delay, value=-0.00436, low=-0.00436, high=-0.00436, interval="95 %"
    )
    assert cause_sentence(cause, estimate, WORDS).startswith(
        "Delay of the force: $t_d$ = −0.0044 s: it takes 40 % off"
    )
    known = replace(estimate, low=-0.005, high=-0.004)
    doubted = cause_sentence(replace(cause, explained=0.4), known, WORDS)
    assert doubted.endswith("it may be something else.")
    assert "not told apart" in cause_sentence(replace(cause, needed=False), known, WORDS)
    assert "−0.0050 to −0.0040" in cause_sentence(cause, known, WORDS)
