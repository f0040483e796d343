"""Sentences of a verdict: what a reader has to tell apart is distinguished."""

from types import SimpleNamespace

import numpy as np
import pytest

from stickslip import Axis, Measurement, select
from stickslip.identify.bands import PredictionBand
from stickslip.identify.page import laws_section, remarks_section, verdict_sections
from stickslip.identify.propose import Proposal
from stickslip.identify.wording import Words, advice_sentence, band_sentence
from stickslip.show.report import MOST, Origin

WORDS = Words(measured="record", force_unit="N", speed_unit="m/s")


@pytest.fixture(scope="module")
def verdict():
    v = np.geomspace(0.05, 1.0, 14)
    noise = 0.02 * np.random.default_rng(2).normal(size=14)
    return select(Axis(inertia=1.0), None, Measurement(velocity=v, friction=2.0 + v + noise))


SPEEDS = np.geomspace(0.01, 1.0, 9)


def banded(low, median, high):
    return PredictionBand(low=low, median=median, high=high)


def test_a_band_that_holds_zero_is_said_to_reach_as_far_as_its_farther_end():
    band = banded(np.full(9, -0.1), np.linspace(0.02, 0.1, 9), np.linspace(0.1, 0.6, 9))
    assert "friction is within ± 0.6 N of zero" in band_sentence(SPEEDS, band, WORDS)
    other = banded(-band.high, -band.median, -band.low)
    assert "friction is within ± 0.6 N of zero" in band_sentence(SPEEDS, other, WORDS)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_wide_band_that_excludes_zero_is_stated_by_its_ends(way):
    low, high = np.full(9, 0.02), np.linspace(0.1, 0.6, 9)
    ends = [way * low, way * high]
    band = banded(np.minimum(*ends), way * np.full(9, 0.03), np.maximum(*ends))
    assert "friction is 0.02 to 0.6 N (95 %" in band_sentence(way * SPEEDS, band, WORDS)
    assert "of zero" in band_sentence(-way * SPEEDS, band, WORDS)  # it would drive the motion


def test_few_places_are_listed_and_many_are_counted():
    proposal = Proposal(places=(0, 0, 1), shrinks=0.5)
    few = advice_sentence(proposal, ["1 m/s", "1 m/s", "2 m/s"])
    assert few.startswith("Measure at 1 m/s (2 readings) and 2 m/s: ")
    many = [f"{k} m/s" for k in range(1, 10) for _ in range(1 + (k == 4))]
    said = advice_sentence(Proposal(places=tuple(range(10)), shrinks=0.5), many)
    assert said.startswith("Take 10 readings at 9 velocities from 1 m/s to 9 m/s")
    assert "4 m/s (2)" in said
    assert "halve" not in said
    more = advice_sentence(Proposal(places=(0,), shrinks=0.7, halves=12), ["1 m/s"])
    assert more.endswith("70 % of its width; about 12 such readings would halve it.")
    some = advice_sentence(Proposal(places=(0,), shrinks=0.7, least=0.42), ["1 m/s"])
    assert some.endswith("70 % of its width.")
    never = advice_sentence(Proposal(places=(0,), shrinks=0.7, least=0.6), ["1 m/s"])
    assert never.endswith("even 300 such readings would not halve it.")


def test_laws_that_are_not_told_apart_have_other_names(verdict):
    assert len(verdict.set) > 1
    others = verdict.sentence.partition("cannot rule out ")[2]
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
    first, *others = table.rows[: len(verdict.candidates)]
    assert [row.chosen for row in table.rows] == [True] + [False] * (len(table.rows) - 1)
    assert first.cells[0].text == verdict.closest.title
    counts = [int(row.cells[1]) for row in others]
    assert counts == sorted(counts)
    shares = [row.cells[-1] for row in table.rows if not row.cells[-1].startswith("below")]
    whole = sum(float(text.removesuffix(" %")) for text in shares)
    assert whole == pytest.approx(100.0, abs=0.5 * len(table.rows))  # each rounded to two digits
    steps = verdict.ladder
    assert [one.count for one in steps] == sorted(one.count for one in steps)
    assert all(0.0 <= one.distance <= one.worst for one in steps)
    assert sum(one.share for one in steps) <= 1.0 + 1e-9
