"""The report of a selection on records holds for a simulated axis, and for a table of friction."""

import ast
import contextlib
import dataclasses
import math
import re
from html import unescape

import numpy as np
import pytest
from tests.support import sketched, wide_only

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Measurement,
    Stribeck,
    Viscous,
    fit,
    formatting,
    select,
    simulate,
)
from stickslip.drives import Sine
from stickslip.formatting import Scale
from stickslip.friction import DirectionDependent
from stickslip.identification.estimation.levenberg_marquardt import AGREE
from stickslip.identification.records.fitting import fit_record
from stickslip.identification.results import ModelError
from stickslip.identification.settings import RecordSettings
from stickslip.kinds.joints.sections.certificate import certificate_section
from stickslip.kinds.joints.sections.friction import course
from stickslip.kinds.joints.sections.parameters import _narrow
from stickslip.kinds.joints.sections.reproduce import python_lines
from stickslip.kinds.joints.sections.residuals import _panels, residuals_section
from stickslip.kinds.joints.sections.sections import turns_of
from stickslip.kinds.joints.sections.summary import law_lines, level_at, levels_at_speed
from stickslip.kinds.joints.sections.texts import rival_of
from stickslip.kinds.joints.wording import in_sentence
from stickslip.kinds.report import verdict_page
from stickslip.plots import characteristic
from stickslip.plots.core.helpers import thinned
from stickslip.plots.selection.fit_data import block_edges, panel_of, rows_of, sampled
from stickslip.report import Paragraph, Section, law_references, render
from stickslip.report.core.documents import Origin
from stickslip.report.core.markup import equation_parts, typeset
from stickslip.selection.candidates import specifications

TRUE = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=5.0)
DRIVE = Sine(amplitude=6.0, frequency=0.5) + Sine(amplitude=3.0, frequency=1.3)
VOICES = [Viscous, Coulomb, CoulombViscous]
TWICE = RecordSettings(starts=2)


def recorded():
    """A record of 8 s of an axis whose law is known, with noise of 10 µm on its position."""
    t = np.arange(0.0, 8.0, 0.01)
    run = simulate(Axis(inertia=2.0, drive=DRIVE), TRUE, t_end=8.0)
    noise = 1e-5 * np.random.default_rng(0).normal(size=len(t))
    force = np.array([DRIVE.value(float(at)) for at in t])
    return Measurement(
        time=t, position=run.at(t)["x"] + noise, force=force, provenance="simulated <axis>"
    )


TIME = np.linspace(0.0, 12.0, 240, endpoint=False)
SPEED = 0.2 * np.sin(2.0 * math.pi / 3.0 * TIME + 0.3)


CURVE = 2.0 * np.sign(SPEED) + 5.0 * SPEED


def rubbed(friction=CURVE, noise=0.05, seed=1):
    """A record in time of friction at speeds in both directions, without positions."""
    scatter = noise * np.random.default_rng(seed).normal(size=SPEED.size)
    return Measurement(time=TIME, velocity=SPEED, friction=friction + scatter)


def page_of(verdict, **more):
    settings = {
        "title": "An axis",
        "data": "One record of 8 s",
        "commands": ("stickslip select rig.toml --data record.csv",),
        "versions": {"stickslip": "0.1.0"},
        "digest": "sha256:0123abcd",
    }
    return render(verdict_page(verdict, Origin(**(settings | more))))


def text_of(html):
    """What a reader sees: without style, drawings and tags, spaces made plain."""
    html = re.sub(r"<style.*?</style>|<svg.*?</svg>", " ", html, flags=re.DOTALL)
    html = re.sub(r"</?(?:i|sub|sup|b|span)\b[^>]*>", "", html)
    text = re.sub(r"<[^>]*>", " ", html).replace("\N{NO-BREAK SPACE}", " ")
    return re.sub(r"\s+", " ", text.replace("&lt;", "<").replace("&gt;", ">"))


def plain(text):
    return text.replace("\N{NO-BREAK SPACE}", " ")


@pytest.fixture(autouse=True)
def other_pages_have_empty_figures(request):
    """Draw what a fixture of the module makes, which has all sections."""
    with contextlib.nullcontext() if "html" in request.fixturenames else sketched():
        yield


@pytest.fixture(scope="module")
def verdict():
    return select(
        Axis(inertia=2.0),
        VOICES,
        recorded(),
        vary=["friction.*", "mechanism.inertia"],
        settings=TWICE,
    )


@pytest.fixture(scope="module")
def html(verdict):
    return page_of(verdict)


@pytest.fixture(scope="module")
def rubbed_verdict():
    return select(Axis(inertia=1.0), VOICES, rubbed())


@pytest.fixture(scope="module")
def rubbed_html(rubbed_verdict):
    return page_of(rubbed_verdict)


def sections(html):
    return re.findall(r'<section[^>]* id="([a-z-]+)"', html)


@pytest.mark.slow
def test_a_record_has_all_sections_in_the_order_of_a_decision(verdict, html):
    expected = ["verdict", "map", "scores", "parameters", "residuals", "dropped", "record"]
    expected += ["certificate", "next", "reproduce"]
    everyone = [*verdict.candidates, verdict.control]
    absent = set()
    if not any(c.dropped for c in everyone):
        absent.add("dropped")
    if not verdict.experiments:
        absent.add("next")
    assert sections(html) == [name for name in expected if name not in absent]


def test_the_page_says_the_verdict_and_the_law_with_its_numbers(verdict, html):
    text = text_of(html)
    assert verdict.best.name == "coulomb-viscous"
    assert verdict.sentence in unescape(text)  # quotes are escaped
    level = verdict.best.fit.estimate("kinetic_coefficient")
    viscous = verdict.best.fit.estimate("viscous_coefficient")
    shown = [formatting.estimate_text(e.value, e.half_width).value for e in (level, viscous)]
    assert f"{shown[0]} N + {shown[1]} N s/m × |v|" in text


def test_every_score_on_the_page_is_that_of_its_candidate(verdict, html):
    text, scale = text_of(html), verdict.scale
    for candidate in [*verdict.candidates, verdict.control]:
        value, doubt = scale.estimate_text(candidate.score, candidate.score_error)
        assert plain(f"{value} {doubt}") in text
        assert scale.number(candidate.validation.extrapolation) in text


def test_every_estimate_on_the_page_ends_where_its_interval_does(verdict, html):
    text = text_of(html)
    for estimate in verdict.best.fit.estimates:
        parts = formatting.estimate_text(estimate.value, estimate.half_width)
        assert plain(f"{parts.value} {parts.doubt}") in text


def test_checks_and_search_stand_on_the_page(verdict, html):
    text, found = text_of(html), verdict.best.fit.optimum
    for sentence in verdict.checks.sentences:
        assert plain(sentence) in text
    assert f"{found.agreeing} of {len(found.costs)} starts" in text
    assert f"within {AGREE:.0%}".replace("%", " %") in text
    assert f"{found.evaluations:,} predictions" in text


def test_the_fitted_law_can_be_copied_as_a_rig_file(verdict, html):
    text = html.replace("&#34;", '"').replace("&lt;", "<").replace("&gt;", ">")
    assert verdict.best.fit.to_toml().strip() in text


def test_next_measurements_carry_the_predictions_of_each_law(verdict, html):
    text = text_of(html)
    for one in verdict.experiments:
        assert plain(one.what) in text
        assert plain(formatting.number(one.separation, 2)) in text


def test_the_page_is_complete_small_and_runs_nothing(html):
    assert "<script" not in html
    assert not re.search(r"(?:src|href)=\"(?!#)", html.replace('href="https://', ""))
    assert not re.search(r"url\((?!#)", html)
    assert len(html.encode()) < 600_000


def test_nothing_on_the_page_is_not_a_number(html):
    shown = re.sub(r"<style.*?</style>", "", html, flags=re.DOTALL)
    assert not re.search(r"\b(?:nan|inf|None)\b", shown)


def test_every_figure_is_drawn_for_both_widths_and_says_what_it_shows(html):
    drawings = re.findall(r"<svg\b[^>]*>", html)
    assert sum('class="fw"' in one for one in drawings) == 4
    assert sum('class="fn"' in one for one in drawings) == 4
    assert all(re.search(r'aria-label="\S', one) for one in drawings)


def test_titles_and_data_are_escaped(verdict):
    html = page_of(verdict, title="<script>alert(1)</script>", data="a < b & c", file="<b>x")
    assert "<script" not in html
    assert "&lt;script&gt;alert(1)" in html
    assert "a &lt; b &amp; c" in html
    assert "simulated &lt;axis&gt;" in html


@pytest.mark.slow  # figures are the same each time in `tests/plots`, and a page in `test_page.py`
def test_the_same_verdict_gives_the_same_page(verdict, html):
    assert page_of(verdict) == html


def test_a_section_without_content_is_left_out(verdict):
    bare = dataclasses.replace(
        verdict,
        experiments=(),
        candidates=tuple(dataclasses.replace(c, dropped="") for c in verdict.candidates),
        control=None,
    )
    assert {"dropped", "next"}.isdisjoint(sections(page_of(bare)))


def test_a_dropped_law_keeps_its_score_and_gets_its_rule(verdict):
    name = next(c.name for c in verdict.candidates if c.name != verdict.best.name)
    changed = tuple(
        dataclasses.replace(c, dropped="the interval of mu_k includes 0") if c.name == name else c
        for c in verdict.candidates
    )
    html = page_of(dataclasses.replace(verdict, candidates=changed))
    dropped = html[html.index('id="dropped"') : html.index('id="record"')]
    one = next(c for c in changed if c.name == name)
    text = text_of(f"<{dropped}")
    assert "includes 0" in text
    value, _ = verdict.scale.estimate_text(one.score, one.score_error)
    assert plain(value) in text


def test_own_sections_stand_before_what_to_measure_next(verdict):
    own = Section(id="own", nav="Own", heading="Own", blocks=(Paragraph(text="Own words."),))
    page = verdict_page(verdict, Origin(title="x", data="y"), extra=(own,))
    ids = [section.id for section in page.sections]
    assert ids[ids.index("own") + 1 :] == ["certificate", "next", "reproduce"]


def test_the_chosen_law_is_compared_with_the_usual_one_or_the_next_best(verdict):
    assert verdict.reference.name == verdict.best.name
    others = [c for c in verdict.candidates if c.name != verdict.best.name and not c.dropped]
    if others:
        assert rival_of(verdict).score == min(c.score for c in others)


@pytest.mark.slow
def test_laws_that_differ_by_direction_have_a_line_each():
    friction = np.where(SPEED > 0, 2.0 + 4.0 * SPEED, -3.0 + 9.0 * SPEED)
    verdict = select(
        Axis(inertia=1.0), [Viscous, DirectionDependent], rubbed(friction, noise=0.02, seed=2)
    )
    text = text_of(page_of(verdict))
    assert "Friction grows faster in reverse than forward" in text
    law = verdict.best.law
    more = law.backward_viscous_coefficient / law.forward_viscous_coefficient - 1.0
    assert plain(formatting.signed_percent(more)) in text


def test_blocks_tile_the_record(verdict):
    edges = block_edges(verdict.closest.fit, verdict.plan.folds)
    assert len(edges) == verdict.plan.folds + 1
    # the record is 8 s long, and its segments may end a step of 0.01 s early
    assert edges[-1] - edges[0] == pytest.approx(8.0, abs=0.05)


def test_means_of_bins_are_those_of_their_residuals():
    x = np.repeat([0.0, 1.0], 50)
    residual = np.concatenate([np.full(50, 2.0), np.tile([-1.0, 1.0], 25)])
    panel = panel_of("x", x, residual, 25.0, sampled(100))
    assert panel.mean.tolist() == [2.0, 0.0]
    # 50 rows count as 12.5 independent ones; the spread is 1 in the second bin
    assert panel.doubt.tolist() == pytest.approx([0.0, 2.0 / math.sqrt(12.5)])


def test_a_thinned_line_keeps_its_extremes():
    t = np.linspace(0.0, 1.0, 5000)
    y = np.sin(300.0 * t)
    y[1234] = 5.0
    short_t, short = thinned(t, y, 100)
    assert len(short) <= 100
    assert short.max() == 5.0
    assert short.min() == y.min()
    assert np.all(np.diff(short_t) >= 0.0)


def test_units_and_words_are_not_taken_for_symbols():
    assert typeset("5 N m and mu_k", ["N", "m", "mu_k"]) == "5 N m and $mu_k$"
    assert typeset("$mu_k$ is known", ["mu_k"]) == "$mu_k$ is known"


def test_an_interval_without_an_end_is_said_in_words(verdict):
    best = verdict.best
    first, *others = best.fit.estimates
    open_ended = dataclasses.replace(
        first, low=-math.inf, high=math.inf, reason="the record does not depend on it"
    )
    fit = dataclasses.replace(best.fit, estimates=(open_ended, *others))
    changed = dataclasses.replace(verdict, best=dataclasses.replace(best, fit=fit))
    html = page_of(changed)
    text = text_of(html)
    assert "is not identified" in text
    assert "the record does not depend on it" in text
    assert not re.search(
        r"\b(?:nan|inf)\b", re.sub(r"<style.*?</style>", "", html, flags=re.DOTALL)
    )


@pytest.fixture(scope="module")
def judged():
    """A verdict on friction along a motion, with a second record."""
    second = dataclasses.replace(short_friction(9), name="run 2", provenance="simulated again")
    return select(Axis(inertia=2.0), [Viscous, CoulombViscous], short_friction(8), validate=second)


def test_a_second_record_has_a_column_of_its_own(judged):
    text = text_of(page_of(judged))
    assert "second record" in text
    for candidate in judged.candidates:
        assert judged.scale.number(candidate.second.rms) in text


def test_a_second_record_is_shown_named_and_compared_with_held_out_blocks(judged):
    html = page_of(judged)
    text, scale = text_of(html), judged.scale
    assert sections(html).index("second") == sections(html).index("scores") + 1
    assert "The second record (run 2, simulated again) was not used for any fit." in text
    best = judged.best
    times = plain(formatting.ratio(best.second.rms / best.score))
    assert f"has an error of {scale.quantity(best.second.rms)} there, and" in text
    assert f"held-out blocks of the first: {times} that." in text
    assert "Predicted and measured on the second record" in text
    assert "The choice holds: no law has a significantly smaller error there." in text


def test_a_second_record_that_turns_the_order_round_says_so(judged):
    best, other = judged.best, rival_of(judged)
    swapped = {best.name: other.second, other.name: best.second}
    candidates = tuple(dataclasses.replace(c, second=swapped[c.name]) for c in judged.candidates)
    found = {c.name: c for c in candidates}
    changed = dataclasses.replace(
        judged,
        candidates=candidates,
        best=found[best.name],
        reference=found[judged.reference.name],
        on_second=dataclasses.replace(judged.on_second, holds=False),
    )
    text = text_of(page_of(changed))
    assert "The choice does not hold: another law has a significantly smaller error there." in text
    assert "larger than the held-out error" in text


def test_without_a_second_record_there_is_no_section_on_one(html):
    assert "second" not in sections(html)


def test_other_criteria_that_disagree_are_named(verdict):
    other = next(c for c in verdict.candidates if c.name != verdict.best.name)
    text = text_of(page_of(dataclasses.replace(verdict, picks=verdict.picks | {"BIC": other.name})))
    assert f"BIC would pick {in_sentence(other.title)}" in text


def short_friction(seed):
    """A record of 80 samples of friction and position: too short for filters."""
    t = np.linspace(0.0, 4.0, 80)
    v = 0.1 * np.cos(3.0 * t)
    noise = 0.02 * np.random.default_rng(seed).normal(size=len(t))
    return Measurement(
        time=t, position=np.sin(3.0 * t) / 30.0, friction=2.0 * np.sign(v) + 5.0 * v + noise
    )


def test_a_short_record_of_friction_has_a_page_with_its_time():
    verdict = select(Axis(inertia=2.0), [Viscous, Coulomb], short_friction(3))
    html = page_of(verdict)
    assert {"verdict", "map", "scores", "residuals", "record"} <= set(sections(html))
    text = text_of(html)
    assert "The record." in text
    assert "Prediction errors." in text


def test_records_of_several_trials_lie_end_to_end():
    both = Measurement(trials=(short_friction(4), short_friction(5)))
    verdict = select(Axis(inertia=2.0), [Coulomb, CoulombViscous], both)
    edges = block_edges(verdict.closest.fit, verdict.plan.folds)
    # two records of 4 s, each from its first to its last sample
    assert edges[-1] - edges[0] == pytest.approx(8.0, abs=1e-9)
    assert "The first of 2 records." in text_of(page_of(verdict))


def test_a_doubt_is_never_shown_as_nothing():
    newtons = Scale(1.0, "N")
    assert newtons.estimate(0.113, 0.0031) == "0.113 ± 0.003 N"
    assert newtons.estimate(1.96, 0.006) == "1.960 ± 0.006 N"


def looped(seed=0):
    """A contact that gives way like a spring before it slips: what a Dahl law describes."""
    t = np.linspace(0.0, 6.0, 360)
    x = 1e-4 * np.sin(2.0 * np.pi * 0.5 * t)
    force, level, stiffness = [0.0], 2.0, 4e4
    for step in np.diff(x):  # elastic, and perfectly plastic beyond the level
        force.append(float(np.clip(force[-1] + stiffness * step, -level, level)))
    noise = 0.02 * np.random.default_rng(seed).normal(size=len(t))
    return Measurement(time=t, position=x, friction=np.array(force) + noise)


@pytest.fixture(scope="module")
def loops():
    laws = ["coulomb-viscous", "dahl"]
    return select(Axis(inertia=1.0), laws, looped(), settings=RecordSettings(starts=1))


@pytest.fixture(scope="module")
def loops_html(loops):
    return page_of(loops)


@pytest.mark.slow
def test_friction_with_memory_is_drawn_against_displacement(loops, loops_html):
    assert sections(loops_html)[1:3] == ["map", "loops"]
    text = text_of(loops_html)
    assert "measured friction against displacement" in text
    best = loops.closest
    left = formatting.percent(best.fit.rms / float(np.std(best.fit.problem.measured)))
    assert f"{plain(left)} for Dahl" in text


@pytest.mark.slow
def test_no_headline_claims_a_curve_that_the_points_refute(loops, loops_html):
    assert loops.closest.name == "dahl"
    text = text_of(loops_html)
    assert "at all speeds" not in text
    assert "The measured friction is not a function of velocity" in text


def test_a_headline_on_the_friction_map_says_of_which_law_it_is(rubbed_verdict, rubbed_html):
    assert rubbed_verdict.best.name == "coulomb-viscous"
    assert "In the Coulomb + viscous law, friction grows from" in text_of(rubbed_html)


@pytest.mark.slow
def test_an_axis_that_turns_has_angles_and_torques_in_words_and_figures():
    turned = dataclasses.replace(looped(), turning=True)
    with wide_only():
        html = page_of(select(Axis(inertia=1.0), [CoulombViscous, Viscous], turned))
    labels = set(
        re.findall(r"(velocity|displacement|position|friction|residual), ([^<]*)</text>", html)
    )
    assert labels == {
        ("velocity", "mrad/s"),
        ("displacement", "µrad"),
        ("position", "µrad"),
        ("friction", "N m"),
        ("residual", "N m"),
    }
    text = text_of(html)
    assert "N m" in text
    assert not re.search(r"\bN (?!m)|\bmm|[^a]d?m/s", text)


def test_a_record_without_positions_has_no_loops(rubbed_html):
    assert "loops" not in sections(rubbed_html)


def test_turns_are_those_of_the_motion_and_not_of_its_noise():
    t = np.linspace(0.0, 4.0, 4001)
    noise = 0.02 * np.random.default_rng(0).normal(size=len(t))
    turns = turns_of(np.sin(2.0 * np.pi * t) + noise)
    # the noise may move a turn by as long as the cosine needs to fall by four deviations
    assert t[turns] == pytest.approx([0.25 + 0.5 * k for k in range(8)], abs=0.07)


def test_points_say_whether_the_motion_speeds_up_or_slows_down(loops_html):
    assert "speeding up" in loops_html


def test_the_caption_of_the_scores_states_the_rule(html):
    text = text_of(html)
    assert "within 1.1 standard errors of those of the law with the lowest error" in text
    assert "the one with the fewest parameters is named" in text
    assert "Laws within 2.5 standard errors are not told apart" in text
    assert "the fewest parameters" in text


@pytest.mark.parametrize(
    ("costs", "said"),
    [
        ((1.0, 1.0, 1.0, 1.05), "3 of 4 starts reached the smallest residual within 1 %; the worst"
                                " ended 2.5 % higher"),
        ((1.0, 1.0, 1.0, 9.0), "3 of 4 starts reached the smallest residual within 1 %; the worst"
                               " ended at 3.0 × that residual"),
        ((1.0, 1.0, 1.0, math.inf), "one could not be simulated"),
        ((1.0, 1.0, 1.0, 1.0), "4 of 4 starts reached the smallest residual within 1 %"),
    ],
)  # fmt: skip
def test_starts_that_disagree_are_said_in_numbers_of_the_search(verdict, costs, said):
    fit = verdict.best.fit
    found = dataclasses.replace(fit.optimum, costs=costs)
    best = dataclasses.replace(verdict.best, fit=dataclasses.replace(fit, optimum=found))
    section = certificate_section(dataclasses.replace(verdict, best=best))
    (text,) = [item.value for item in section.blocks[0].items if item.key == "Restarts"]
    assert said in plain(text)


def test_simulated_segments_show_their_certificates(html, rubbed_html):
    text = text_of(html)
    assert "segments certified with the fitted law" in text
    assert "Energy balance" in text
    assert "Energy balance" not in text_of(rubbed_html)


def test_what_went_to_0_is_not_said_to_have_been_given(loops):
    fit = loops.closest.fit
    estimates = tuple(e for e in fit.estimates if not e.path.endswith("viscous_coefficient"))
    fit = dataclasses.replace(fit, estimates=estimates)
    given = {line.label: line.formula for line in law_lines(fit)}
    gone = dataclasses.replace(loops.closest, left_out=("friction.viscous_coefficient",))
    left_out = {line.label: line.formula for line in law_lines(fit, gone)}
    assert "taken as given" in given["viscous coefficient"]
    assert left_out["viscous coefficient"] == "$sigma_2$ = 0, estimated as 0 and left out"


def test_a_value_that_nobody_gave_says_where_it_comes_from(loops):
    law = dataclasses.replace(loops.closest.fit.law, yield_exponent=2.0)
    fit = dataclasses.replace(loops.closest.fit, law=law, estimates=())
    plain_law = dataclasses.replace(fit, law=dataclasses.replace(law, yield_exponent=1.0))
    balanced = dataclasses.replace(loops.closest, from_balance=("friction.yield_exponent",))

    def said(fit, of=None):
        return {line.label: line.formula for line in law_lines(fit, of)}["yield exponent"]

    assert said(fit) == "$n$ = 2, taken as given"
    assert said(fit, balanced) == "$n$ = 2, found by the force balance and held in the fit"
    assert said(plain_law) == "$n$ = 1, as usual"


@pytest.mark.slow
def test_the_lines_of_python_make_the_selection_again(rubbed_verdict):
    lines = python_lines(rubbed_verdict)
    assert "RecordSettings(seed=0)" in lines
    names = {"record": rubbed()}
    exec(re.sub(r"^(?:>>>|\.\.\.) ?", "", lines, flags=re.MULTILINE), names)
    again = names["verdict"]
    assert again.sentence == rubbed_verdict.sentence
    assert [c.score for c in again.candidates] == [c.score for c in rubbed_verdict.candidates]


def test_many_laws_are_wrapped_and_the_usual_ones_are_not_named(rubbed_verdict):
    names = [one.name for one in specifications(None)]

    def lines(kept, **more):
        like = [dataclasses.replace(rubbed_verdict.candidates[0], name=name) for name in kept]
        return python_lines(dataclasses.replace(rubbed_verdict, candidates=tuple(like), **more))

    assert "coulomb" not in lines(names, usual=True)
    many = lines(names[1:])
    assert all(f'"{name}"' in many for name in names[1:])  # compositions stay whole
    short = [name for name in names[1:] if " " not in name]
    assert max(map(len, lines(short).split("\n"))) <= 76


def test_a_mechanism_that_is_not_all_numbers_comes_from_its_rig_file(verdict):
    driven = dataclasses.replace(verdict, mechanism=Axis(inertia=2.0, drive=DRIVE))
    assert 'load_rig("rig.toml").mechanism' in python_lines(driven)
    for name in ("arm 2.toml", 'C:\\my "arm"\'s.toml', "a\n\udcff\u202e.toml"):
        said = re.search(r"load_rig\((.*)\).mechanism", python_lines(driven, name))
        assert ast.literal_eval(said[1]) == name
        assert said[1].isprintable()
    assert "Axis(inertia=2.0)," in python_lines(verdict)


def test_seed_and_checksums_of_the_data_stand_on_the_page(verdict):
    text = text_of(page_of(verdict, files={"record.csv": "0123" * 16}))
    assert "SHA-256 of record.csv" in text
    assert "0123" * 16 in text
    assert "Seed 0, for the starts after the first of each law" in text


def test_no_number_of_a_page_is_written_with_an_e(html, loops_html):
    for page in (html, loops_html):
        shown = re.sub(r"<style.*?</style>|<svg.*?</svg>|<pre.*?</pre>", "", page, flags=re.DOTALL)
        assert not re.search(r"\de[+-]\d", shown)


def test_a_level_without_a_load_is_in_newtons_on_the_page(rubbed_verdict, rubbed_html):
    level = rubbed_verdict.best.fit.estimate("kinetic_coefficient")
    parts = formatting.estimate_text(level.value, level.half_width)
    said = plain(f"{parts.value} {parts.doubt}")
    assert f"{said} N Kinetic coefficient μk" in text_of(rubbed_html)


def test_a_long_equation_may_go_on_in_a_new_line_but_not_within_its_groups():
    whole, directions = equation_parts(Coulomb.formula), DirectionDependent.formula
    assert len(whole) == 2
    assert whole[0].startswith("F = ")
    assert equation_parts(directions) == (directions,)
    grouped = equation_parts(r"\text{a \quad b}, \quad c")
    assert grouped == (r"\text{a \quad b},", "c")


@pytest.mark.slow
def test_how_large_a_hidden_step_may_be_is_said():
    found = select(Axis(inertia=1.0), ["coulomb-viscous", "stribeck"], rubbed(seed=5))
    text = text_of(page_of(found))
    assert "of Stribeck values up to about" in text
    assert "are compatible with this record (95 %, profile likelihood)" in text


def test_friction_at_a_speed_is_told_where_its_parameters_trade_off():
    v = np.linspace(0.15, 0.21, 80)
    noise = 0.05 * np.random.default_rng(1).normal(size=len(v))
    record = Measurement(velocity=v, friction=2.0 + 5.0 * v + noise)
    found = fit(Axis(inertia=1.0), CoulombViscous, record)
    level, slope = found.values
    # a level and a slope: the variance of their sum at a speed, from both and their covariance
    first, second = found.inference.half_widths
    together = found.inference.correlation[0, 1]
    for speed in (0.15, 0.18):
        value, half = level_at(found, speed)
        assert value == pytest.approx(level + slope * speed)
        parts = first**2 + (speed * second) ** 2 + 2.0 * together * first * speed * second
        # the difference of both is a hundredth of either, and slopes are differences
        assert half == pytest.approx(math.sqrt(parts), rel=1e-6)
    (line,) = levels_at_speed(found)
    value, half = level_at(found, 0.18)  # the median of the speeds
    assert line.startswith("Friction at ")
    assert plain(formatting.estimate(value, half)) in plain(line)


def test_parameters_that_stand_for_themselves_need_no_speed():
    found = fit(Axis(inertia=1.0), CoulombViscous, rubbed())
    variances = np.diag(np.diag(found.inference.covariance))
    alone = dataclasses.replace(found.inference, covariance=variances)
    assert levels_at_speed(dataclasses.replace(found, inference=alone)) == ()


def test_friction_at_a_speed_is_told_only_in_a_direction_that_leaves_it_open():
    v = np.concatenate([np.linspace(-0.2, -0.15, 80), np.linspace(0.001, 0.2, 80)])
    noise = 0.05 * np.random.default_rng(1).normal(size=len(v))
    record = Measurement(velocity=v, friction=2.0 * np.sign(v) + 5.0 * v + noise)
    found = fit(Axis(inertia=1.0), DirectionDependent, record)
    covariance = np.diag(np.diag(found.inference.covariance))
    back = [i for i, path in enumerate(found.free_parameters.paths) if "backward" in path]
    covariance[back, back[::-1]] = -0.99 * np.prod(found.inference.errors[back])
    held = dataclasses.replace(found.inference, covariance=covariance)
    (line,) = levels_at_speed(dataclasses.replace(found, inference=held))
    assert line.startswith("Friction in reverse at ")


@pytest.mark.slow
def test_no_trend_is_not_all_that_is_said_of_residuals_far_above_the_sensors_noise(verdict):
    joined = RecordSettings(starts=1, hold="first")  # the force was sampled, and not held
    fit = fit_record(
        Axis(inertia=2.0), CoulombViscous, recorded(), unknown=["inertia"], settings=joined
    )
    assert fit.model_errors == ()
    quiet, _ = residual_heading(verdict, fit)
    assert quiet.startswith("No test finds a dependence")
    best = fit.optimum.best.with_residual(100.0 * fit.residual)
    loud = dataclasses.replace(fit, optimum=dataclasses.replace(fit.optimum, best=best))
    heading, caption = residual_heading(verdict, loud)
    assert re.match(r"Residuals \d+ times the sensor noise", heading)
    assert "because of an unmeasured disturbance or a model error" in caption


def test_the_residuals_section_says_which_error_of_the_model_the_tests_show(verdict):
    late = ModelError(
        kind="delay", finding="It is late.", consequence="Much.", effect=1.0, interval=(0.5, 2.0),
        share=0.9,
    )  # fmt: skip
    wrong = dataclasses.replace(verdict.best.fit, known_errors=(late,))
    heading, caption = residual_heading(verdict, wrong)
    assert heading == "Model error: the residuals show an effect of delay"
    assert "It is late. Much." in caption
    unknown = dataclasses.replace(
        wrong, known_errors=(dataclasses.replace(late, kind="unexplained"),)
    )
    assert residual_heading(verdict, unknown)[0] == "The residuals show an error of the model"


def residual_heading(verdict, fit):
    """Heading and caption of the section on residuals, if the best law had this fit."""
    best = dataclasses.replace(verdict.best, fit=fit)
    section = residuals_section(dataclasses.replace(verdict, best=best))
    return section.heading, section.blocks[0].caption


def test_residuals_that_follow_speed_have_a_trend(verdict):
    fit = verdict.best.fit
    rows = rows_of(fit)
    sped = fit.residual + 2.0 * np.std(fit.residual) * np.sign(rows.velocity)
    best = fit.optimum.best.with_residual(sped)
    moved = dataclasses.replace(fit, optimum=dataclasses.replace(fit.optimum, best=best))
    assert "velocity" in _panels(moved, 1e3)[1]
    assert _panels(fit, 1e3)[1] == []


def test_the_heading_of_the_map_says_the_minimum_of_a_curve_that_rises_again():
    law = Stribeck(
        kinetic_coefficient=3.0,
        static_coefficient=9.6,
        stribeck_velocity=0.02,
        viscous_coefficient=16.0,
        fading_exponent=1.0,
    )
    v, force = characteristic(law, 1.0, 0.295)
    words = course(v[v > 0.0], force[v > 0.0], "m/s", "N")
    speeds = np.linspace(0.0, 0.295, 100_001)
    least = float(np.min(law.sliding(speeds, 1.0)))
    slowest = float(speeds[np.argmin(law.sliding(speeds, 1.0))])
    # 2 digits are told, and the curve has points 2 mm/s apart
    told = re.fullmatch(
        r"falls from 9.6 N near rest to ([\d.]+) N at ([\d.]+) mm/s"
        r" and grows to 7.7 N at 0.295 m/s",
        words,
    )
    assert told, words
    assert float(told[1]) == pytest.approx(least, abs=0.05)
    assert float(told[2]) == pytest.approx(1e3 * slowest, abs=2.0)


def test_a_law_of_several_contacts_stands_once_behind_its_source():
    axis, other = (
        Stribeck(kinetic_coefficient=k, static_coefficient=2 * k, stribeck_velocity=0.1)
        for k in (1.0, 2.0)
    )
    notes = [one.note for one in law_references([axis, other], {})]
    assert notes
    assert all(note == axis.title for note in notes)


def test_the_column_of_naive_intervals_says_which_way_they_are_off(verdict):
    found = verdict.best.fit
    for size, way in ((1e-6, "too narrow"), (1e6, "too wide")):
        inference = dataclasses.replace(found.inference, naive=size * found.inference.naive)
        assert _narrow(dataclasses.replace(found, inference=inference), 0).endswith(way)
