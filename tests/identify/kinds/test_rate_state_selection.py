"""Selections on velocity steps: made-up records of known laws, a rock, and what is said of each."""

import functools
import json
import math

import numpy as np
import pytest
from tests.support import sketched

from stickslip import Coulomb, Measurement, RecordSettings, TowedBlock, load_measurement, select
from stickslip.errors import InputError
from stickslip.friction import RateState
from stickslip.identify.kinds import SimulatedVerdict, fit_rate_state, simulate_velocity_steps
from stickslip.identify.kinds.registry import kind_of_route
from stickslip.identify.kinds.velocity_steps import stepped_speeds
from stickslip.identify.problems.velocity_step_paths import Path
from stickslip.identify.propose import WORTH
from stickslip.show.report.blocks import Origin, Page, made_sections, render

MACHINE = TowedBlock(mass=1e-3, stiffness=2e3, speed=1e-6, load=1.0)
THREE = ([0.0, 20.0, 60.0, 100.0, 120.0], [0.0, 20.0, 420.0, 460.0, 660.0])
ONE = ([0.0, 20.0, 60.0], [0.0, 20.0, 420.0])
"""Times [s] and positions [um] between which the load point moves steadily."""
PLAIN = {"evolution_effect": 0.0, "critical_distance": None, "evolution": "none"}
TRUTHS = {
    "rate-and-state": {},
    "rate-and-state-slip": {"evolution": "slip"},
    "logarithmic": PLAIN,
    "constant-coefficient": {**PLAIN, "direct_effect": 0.0},
}
LONG = ("rate-and-state", "rate-and-state-slip", "constant-coefficient")
"""Beside the others: those that evolve, whose searches take long, and a special case."""
EVOLVING = ("rate-and-state", "constant-coefficient", "logarithmic", "rate-and-state")
"""A truth, and laws without the form of its evolution that takes longest."""
SETTINGS = RecordSettings(starts=1)


def law(**changes):
    numbers = {
        "reference_coefficient": 0.6,
        "direct_effect": 0.010,
        "evolution_effect": 0.014,
        "critical_distance": 1e-5,
        "reference_velocity": 1e-6,
    }
    return RateState(**{**numbers, **changes})


def pulled(truth, path=THREE, *, seed=0, noise=5e-4, memory=0.3, stiffness=2e3, drift=0.0):
    """Return a record at 5 Hz with autocorrelated noise."""
    knots, places = np.array(path[0]), 1e-6 * np.array(path[1])
    t = np.arange(0.0, knots[-1], 0.2)
    run = simulate_velocity_steps(truth, stiffness=stiffness, time=knots, pull=places, at=t)
    scatter = np.random.default_rng(seed).normal(0.0, noise, len(t))
    rho = math.exp(-0.2 / memory)
    for i in range(1, len(t)):
        scatter[i] = rho * scatter[i - 1] + math.sqrt(1.0 - rho**2) * scatter[i]
    pull = np.interp(t, knots, places)
    friction = run.coefficient + scatter + drift * pull
    return Measurement(time=t, pull=pull, friction=friction, load=1.0)


each_truth = pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n in LONG)) for n in TRUTHS]
)


@pytest.fixture(scope="module")
def verdicts():
    """Return a function from the name of a law to the verdict on its record, made once."""

    @functools.cache
    def verdict_on(name, *among):
        record = pulled(law(**TRUTHS[name]))
        return select(MACHINE, among or None, record, settings=SETTINGS)

    return verdict_on


@pytest.mark.slow
@each_truth
def test_three_steps_name_the_law_that_made_them(verdicts, name):
    named(verdicts(name), name)


@pytest.mark.slow
def test_three_steps_name_a_law_that_evolves(verdicts):
    named(verdicts(*EVOLVING), "rate-and-state")


def named(verdict, name):
    assert verdict.best.name == name
    # the law leaves the noise: 600 rows of 3 per correlation time know it to some 5 %
    assert verdict.best.score == pytest.approx(5e-4, rel=0.15)
    assert verdict.best.share > 0.5
    assert sum(one.share for one in verdict.candidates) == pytest.approx(1.0)
    assert verdict.words.cannot_tell


@pytest.mark.slow
def test_the_wrong_form_of_evolution_leaves_far_more_than_the_noise():
    # a step down tells the two apart: the state of the slip law evolves with slip alone
    record = pulled(law(), ([0.0, 5.0, 10.0, 50.0], [0.0, 5.0, 55.0, 95.0]))
    fit = fit_rate_state(
        MACHINE, law(evolution="slip"), record,
        vary="critical_distance", drift="none", starts=1,
    )  # fmt: skip
    assert fit.rms > 5.0 * 5e-4


OTHERS = {
    "rate-and-state-prz": {"evolution": "prz"},
    "rate-and-state-nagata": {
        "evolution": "nagata", "direct_effect": 0.03, "evolution_effect": 0.034,
        "stress_effect": 2.0,
    },
    "rate-and-two-states-slip": {
        "evolution": "slip", "second_evolution_effect": 0.006, "second_critical_distance": 6e-5,
    },
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "rival"),
    [
        pytest.param("rate-and-state-prz", "rate-and-state-slip", marks=pytest.mark.slow),
        ("rate-and-state-nagata", "rate-and-state"),
        pytest.param("rate-and-two-states-slip", "rate-and-state-slip", marks=pytest.mark.slow),
    ],
)
def test_three_steps_name_forms_that_are_tried_by_name(name, rival):
    record = pulled(law(**OTHERS[name]))
    verdict = select(MACHINE, [rival, name], record, settings=SETTINGS)
    named(verdict, name)
    assert verdict.ranked


@pytest.mark.parametrize(
    ("name", "seed"),
    [("logarithmic", 1), pytest.param("constant-coefficient", 2, marks=pytest.mark.slow)],
)
def test_no_parameters_are_invented_where_nothing_evolves(name, seed):
    verdict = select(MACHINE, None, pulled(law(**TRUTHS[name]), seed=seed))
    assert verdict.best.name == name
    symbols = {e.quantity.symbol for e in verdict.best.fit.estimates}
    assert not symbols & {"b", "D_c", "b_2", "c"}


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_no_second_state_is_invented_where_the_machine_is_stiffer_than_told(seed):
    truth = law(evolution=("ageing", "slip")[seed % 2])
    machine = TowedBlock(mass=1e-3, stiffness=2.8e3, speed=1e-6, load=1.0)
    verdict = select(machine, None, pulled(truth, seed=30 + seed))
    assert verdict.best.name == truth.name
    values = {"a": 0.010, "b": 0.014, "D_c": 1e-5, "k": 2e3}
    for estimate in verdict.best.fit.estimates:
        if estimate.quantity.symbol in values:  # four of a record, so that one is out at times
            middle = 0.5 * (estimate.low + estimate.high)
            assert abs(values[estimate.quantity.symbol] - middle) < 1.6 * estimate.half_width


@pytest.mark.slow
@pytest.mark.parametrize("name", TRUTHS)
@pytest.mark.parametrize("seed", [1, 2])
def test_one_step_names_the_law_or_says_that_it_cannot_tell(name, seed):
    record = pulled(law(**TRUTHS[name]), ONE, seed=seed)
    verdict = select(MACHINE, None, record, settings=SETTINGS)
    assert name in (verdict.closest.name, *verdict.rivals)
    assert any("only one" in line for line in verdict.words.cannot_tell)
    widths = [item.expected_width for item in verdict.advised]
    assert widths == sorted(widths)
    assert all(0.0 < width < WORTH for width in widths)
    text = " ".join(verdict.words.measure_next)
    assert ("is expected to fall to" in text) != ("not expected to determine" in text)


@pytest.mark.parametrize("first", [0.0, 1e-6])
def test_a_pull_that_holds_has_its_first_moving_speed_and_no_step_again(first):
    speeds = np.array([1e-6, 0.0, 1.000001e-6] if first else [0.0, 1e-6, 0.0])
    path = Path(time=np.arange(4.0), position=np.concatenate([[0.0], np.cumsum(speeds)]))
    begun, again = stepped_speeds(path)
    assert begun == again == pytest.approx(1e-6)


@pytest.mark.slow
def test_a_step_again_is_expected_to_tell_less_than_one_to_another_speed(verdicts):
    verdict = verdicts("rate-and-state")
    left = {(x.name, x.value): x.expected_width for x in verdict.advised}
    _, again = stepped_speeds(verdict.closest.fit.problem.record.path)
    assert 0.5 < left["speed", again] < 1.0  # as much again leaves 1/sqrt(2) or so
    assert verdict.advised[0].expected_width < left["speed", again]


@pytest.mark.slow
def test_a_curved_trend_is_no_constant_coefficient():
    record = pulled(law(**TRUTHS["constant-coefficient"]))
    way = record.pull / record.pull[-1]
    worn = Measurement(
        time=record.time, pull=record.pull, load=1.0,
        friction=record.friction + 0.02 * np.exp(-way / 0.2) - 0.01 * way,
    )  # fmt: skip
    verdict = select(MACHINE, ["constant-coefficient", "logarithmic", "rate-and-state"], worn)
    assert verdict.best.name == "constant-coefficient"
    assert "No effect of speed is established." in verdict.words.lede
    # .0173 up at its beginning, .0097 down at its end beside the mean
    line = verdict.words.lede.partition("drifts")[2]
    first, last = (float(x) for x in (line.split("from ")[1].split(" ")[0],
                                      line.split(" to ")[1].split(" ")[0]))  # fmt: skip
    assert first - last == pytest.approx(0.02 * (1.0 - math.exp(-5.0)) + 0.01, abs=1e-3)


def test_a_drift_is_told_beside_friction_that_depends_on_speed():
    record = pulled(law(**PLAIN), drift=20.0, noise=2e-4)
    verdict = select(MACHINE, ["logarithmic", "constant-coefficient"], record)
    assert verdict.best.name == "logarithmic"
    assert verdict.best.fit.details["drift"] == pytest.approx(20.0, rel=0.1)
    assert "drifts" in verdict.words.lede


def test_a_selection_of_one_law_is_its_fit(verdicts):
    record = pulled(law(**PLAIN))
    fit = fit_rate_state(MACHINE, "logarithmic", record)
    (alone,) = select(MACHINE, "logarithmic", record).candidates
    assert alone.share == 1.0
    assert [e.to_dict() for e in alone.fit.estimates] == [e.to_dict() for e in fit.estimates]


@pytest.mark.slow
def test_a_stopped_selection_goes_on_with_the_best_so_far():
    told = []
    verdict = select(
        MACHINE, ["constant-coefficient", "logarithmic"], pulled(law(**PLAIN)),
        progress=lambda name, rms: told.append((name, rms)), settings=SETTINGS,
    )  # fmt: skip
    assert verdict.best.name == "logarithmic"
    assert told[-1][1] == pytest.approx(5e-4, rel=0.15)
    stopped = select(
        MACHINE, "rate-and-state", pulled(law()), progress=lambda *_: False, settings=SETTINGS
    )
    assert stopped.closest.fit.cancelled


@pytest.mark.slow
def test_a_law_that_leaves_more_than_noise_sends_to_the_forms_that_were_not_tried():
    two = law(second_evolution_effect=0.006, second_critical_distance=1e-4)
    laws = ["rate-and-state", "logarithmic"]
    verdict = select(MACHINE, laws, pulled(two, memory=1e-9), settings=SETTINGS)
    assert verdict.sentence.startswith("Rate-and-state friction with the ageing law is closest,")
    assert "rate-and-two-states" in verdict.words.measure_next[0]
    every = select(MACHINE, None, pulled(two, memory=1e-9), settings=SETTINGS)
    assert every.best.name == "rate-and-two-states"
    assert every.sentence.startswith("Use rate-and-state friction with two states")


def test_the_rock_leaves_more_than_noise_to_every_law_and_tells_the_difference_alone(rock):
    assert "not noise of single samples" in rock.sentence
    assert "Only this difference is identified." in rock.words.lede
    logarithmic = next(one for one in rock.candidates if one.name == "logarithmic")
    # published: a = 0.0157 and b about 0 on the first 0.12 mm after the step
    assert logarithmic.fit.derived[0].low < 0.0157 < logarithmic.fit.derived[0].high
    assert any("only one" in line for line in rock.words.cannot_tell)


def test_a_second_record_is_predicted_and_not_fitted(verdicts):
    up = ([0.0, 10.0, 50.0, 70.0], [0.0, 30.0, 150.0, 550.0])
    second = pulled(law(), up, seed=5)
    assert verdicts(*EVOLVING).best.fit.judged(second)["coefficient"] == pytest.approx(
        5e-4, rel=0.2
    )
    verdict = select(
        MACHINE, ["constant-coefficient"], pulled(law()), validate=second, settings=SETTINGS
    )
    known = next(c for c in verdicts(*EVOLVING).candidates if c.name == "constant-coefficient")
    # what the best of others leaves says how much counts as a trend, and so a little of the level
    level = verdict.closest.fit.law.reference_coefficient
    assert level == pytest.approx(known.fit.law.reference_coefficient, abs=1e-4)
    # of steps that change friction by 0.01 and overshoot
    assert verdict.closest.second["coefficient"] > 3e-3
    assert kind_of_route(verdict.route).comparison(verdict).heads[-1] == "second record"


@pytest.mark.slow
@each_truth
def test_a_verdict_is_plain_numbers_and_a_table(verdicts, name):
    verdict = verdicts(name)
    assert isinstance(verdict, SimulatedVerdict)
    told = json.loads(json.dumps(verdict.to_dict(), allow_nan=False))
    assert told["route"] == "rate-state"
    assert told["best"] == verdict.best.name
    table = kind_of_route(verdict.route).comparison(verdict)
    assert all(len(row) == len(table.heads) for row in table.rows)
    assert len(table.notes) == len(table.rows) == len(verdict.to_dataframe())


@pytest.mark.slow
def test_stick_slip_under_a_load_point_is_explained_by_no_law():
    t = np.arange(0.0, 120.0, 0.1)
    pull = 1e-6 * np.interp(t, *THREE)
    saw = 0.6 + 0.2 * (np.mod(pull, 1.7e-5) / 1.7e-5 - 0.5)
    record = Measurement(time=t, pull=pull, friction=saw, load=1.0)
    verdict = select(MACHINE, None, record, settings=SETTINGS)
    assert verdict.best is None or verdict.best.name == "constant-coefficient"


def test_candidates_are_checked():
    laws_of = kind_of_route("rate-state").laws
    assert [*laws_of(["logarithmic"])] == ["logarithmic"]
    assert [*laws_of([RateState])] == ["rate-and-state"]
    assert [*laws_of({"mine": law()})] == ["mine"]
    with pytest.raises(InputError, match="slip speed was not measured"):
        laws_of([Coulomb])
    with pytest.raises(InputError, match="no friction law was given"):
        laws_of([])
    with pytest.raises(InputError, match="two of `laws`"):
        laws_of([RateState, "rate-and-state"])


@pytest.fixture(scope="module")
def rock(data_dir):
    record = load_measurement(
        data_dir / "rock_velocity_step" / "sepiolite.parquet",
        columns={"time": "t_s", "pull": "disp_um", "friction": "mu"},
        gain={"pull": 1e-6},
    )
    machine = TowedBlock(mass=1e-3, stiffness=1e3, speed=2e-7, load=1.0)
    return select(machine, None, record, vary=["friction.*", "mechanism.stiffness"])


def test_pages_have_every_section(verdicts, rock):
    for verdict in (verdicts(*EVOLVING), verdicts("logarithmic"), rock):
        origin = Origin(title="Gouge", data="velocity steps", commands=("stickslip select",))
        with sketched():  # a page of its route is drawn whole in `test_velocity_steps`
            kind = kind_of_route(verdict.route)
            made = made_sections(*kind.sections(verdict, origin, "Measured in Pisa."))
        ids = [one.id for one in made]
        assert ids[:4] == ["verdict", "runs", "models", "parameters"]
        assert ids[-1] == "reproduce"
        page = render(Page(title="Gouge", subject="gouge", sections=made, footer="stickslip"))
        assert "Measured in Pisa." in page
        assert "NaN" not in page
        assert ">nan" not in page


def test_fits_and_verdicts_draw_themselves_and_show_in_notebooks(verdicts):
    verdict = verdicts("logarithmic")
    assert verdict.plot().get_xlabel()
    axes = verdict.best.fit.plot()
    assert axes.get_ylabel() == "coefficient"
    np.testing.assert_array_equal(axes.lines[1].get_ydata(), verdict.best.fit.family.band[1])
    for one in (verdict, verdict.best.fit):
        assert "<table" in one._repr_html_()
