"""Rate-and-state friction: closed forms, an independent integration, recovery, a rock."""

import json
import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import Coulomb, Measurement, TowedBlock, load_measurement, select
from stickslip.errors import InputError, ParameterError, SimulationError
from stickslip.friction import RATE_STATE_FORMS, RateState
from stickslip.identify.fits.levenberg_marquardt import step_of
from stickslip.identify.kinds import fit_rate_state, simulate_velocity_steps
from stickslip.identify.problems import rate_state_slider as slider
from stickslip.identify.problems.velocity_step_paths import path_of
from stickslip.identify.problems.velocity_steps import SteppedLaw, VelocitySteps, record_of
from stickslip.identify.simulated import ENOUGH
from stickslip.mechanisms.drives import Sine

KNOTS = np.array([0.0, 20.0, 60.0, 100.0, 120.0])
PULL = 1e-6 * np.array([0.0, 20.0, 420.0, 460.0, 660.0])
STIFFNESS = 2e3
MACHINE = TowedBlock(mass=1e-3, stiffness=500.0, speed=1e-6, load=1.0)
"""Whose stiffness is to be found."""
FREE = ("friction.*", "mechanism.stiffness")


def fitted(measurement, law="rate-and-state", **options):
    return fit_rate_state(MACHINE, law, measurement, vary=FREE, **options)


CONSTANT = {"evolution_effect": 0.0, "critical_distance": None, "evolution": "none"}
FORMS = {"ageing": "rate-and-state", "slip": "rate-and-state-slip"}


def law(**changes):
    numbers = {
        "reference_coefficient": 0.6,
        "direct_effect": 0.010,
        "evolution_effect": 0.014,
        "critical_distance": 1e-5,
        "reference_velocity": 1e-6,
    }
    return RateState(**{**numbers, **changes})


def record(truth, *, noise, seed=0, drift=0.0, memory=0.0, knots=KNOTS, places=PULL):
    """Return a record of two steps up and one down between 1 and 10 um/s.

    Noise is white, or autocorrelated with a memory [s].
    """
    t = np.arange(0.0, knots[-1], 0.1)
    run = simulate_velocity_steps(truth, stiffness=STIFFNESS, time=knots, pull=places, at=t)
    pull = np.interp(t, knots, places)
    scatter = np.random.default_rng(seed).normal(0.0, noise, len(t))
    rho = math.exp(-0.1 / memory) if memory else 0.0
    for i in range(1, len(t)):
        scatter[i] = rho * scatter[i - 1] + math.sqrt(1.0 - rho**2) * scatter[i]
    friction = run.coefficient + drift * pull + scatter
    return Measurement(time=t, pull=pull, friction=friction, load=1.0)


@pytest.mark.parametrize("evolution", ["ageing", "slip"])
def test_long_after_a_step_only_the_difference_of_a_and_b_is_left(evolution):
    truth = law(evolution_effect=0.004, evolution=evolution)
    run = simulate_velocity_steps(
        truth, stiffness=1e3, time=[0.0, 10.0, 300.0], pull=[0.0, 1e-5, 2.91e-3]
    )
    # 290 critical distances later the transient is below rounding; LSODA holds 1e-11
    assert run.coefficient[-1] == pytest.approx(0.6 + 0.006 * math.log(10.0), abs=1e-9)
    assert run.velocity[-1] == pytest.approx(1e-5, rel=1e-8)


def test_while_the_speed_stays_nothing_changes():
    run = simulate_velocity_steps(law(), stiffness=1e3, time=[0.0, 50.0], pull=[0.0, 1e-4])
    np.testing.assert_allclose(run.coefficient, 0.6 - 0.004 * math.log(2.0), rtol=1e-15)


def test_a_history_is_a_table_with_units():
    run = simulate_velocity_steps(law(), stiffness=1e3, time=[0.0, 50.0], pull=[0.0, 1e-4])
    table, data = run.to_dataframe(), run.to_xarray()
    assert [*table.columns] == ["time", "coefficient", "velocity", "state"]
    np.testing.assert_array_equal(table["velocity"], run.velocity)
    assert {name: data[name].units for name in data} == {
        "coefficient": "1", "velocity": "m/s", "state": "s",
    }  # fmt: skip


def test_a_stiff_spring_shows_the_direct_effect_at_once():
    run = simulate_velocity_steps(
        law(critical_distance=1.0), stiffness=1e9, time=[0.0, 10.0, 11.0], pull=[0, 1e-5, 2e-4]
    )
    # the state changes by 1.9e-4 m / 1 m in a second, which b ln carries below 3e-6
    assert run.coefficient[-1] == pytest.approx(0.6 + 0.010 * math.log(190.0), abs=3e-6)


@pytest.mark.parametrize(("name", "evolution"), [("aging law", "ageing"), ("slip law", "slip")])
def test_a_step_agrees_with_an_independent_integration(data_dir, name, evolution):
    text = (data_dir / "rate_and_state_reference" / "truth.json").read_text(encoding="utf-8")
    truth = json.loads(text)[name]
    given = truth["parameters"]
    run = simulate_velocity_steps(
        RateState(
            reference_coefficient=given["mu0"],
            direct_effect=given["a"],
            evolution_effect=given["b"],
            critical_distance=1e-6 * given["Dc_um"],
            reference_velocity=1e-6 * given["v_ref_um_s"],
            evolution=evolution,
        ),
        stiffness=1e6 * given["k_per_um"],
        time=[0.0, 10.0, 40.0],
        pull=[0.0, 10e-6, 310e-6],
        at=truth["t_s"],
    )
    # eight digits are printed: half a unit of the last, and a fifth of that for integration
    np.testing.assert_allclose(run.coefficient, truth["mu"], rtol=0.0, atol=6e-9)
    np.testing.assert_allclose(run.state, truth["theta_s"], rtol=0.0, atol=6e-9)


ONE = {"direct_effect": 0.01, "evolution_effect": 0.005, "critical_distance": 1e-5}
TWO = {
    "direct_effect": 0.012, "evolution_effect": 0.0185, "critical_distance": 5e-6,
    "second_evolution_effect": 0.0088, "second_critical_distance": 5e-5,
}  # fmt: skip
PUBLISHED = {
    "prz": (
        {"evolution": "prz", **ONE}, 1e3,
        [0.60839207, 0.61456074, 0.61610039, 0.61386731], [18.43306111, 11.27594869],
    ),
    "two states, ageing": (
        TWO, 3e3, [0.61777816, 0.56719338, 0.57926411, 0.58134415], [2.80081321, 0.26257732],
    ),
    "two states, slip": (
        {"evolution": "slip", **TWO}, 8e3,
        [0.57317487, 0.57620828, 0.57423257, 0.57241419], [0.34503501, 0.48718318],
    ),
    "two states, prz": (
        {
            "evolution": "prz", "direct_effect": 0.02, "evolution_effect": 0.01,
            "critical_distance": 5e-6, "second_evolution_effect": 0.005,
            "second_critical_distance": 3e-6,
        },
        3e3, [0.62332749, 0.61662392, 0.60925037, 0.61102238], [6.84431098, 0.72378553],
    ),
}  # fmt: skip
"""Parameters, stiffness [1/m], and coefficients and first state from 11 s on in the tests of
rsfmodel (MIT licence), for a step from 1 to 10 um/s at 10 s."""


@pytest.mark.parametrize("regularised", [False, True])
@pytest.mark.parametrize("name", PUBLISHED)
def test_other_laws_of_evolution_have_the_published_digits(name, regularised):
    numbers, k, coefficient, state = PUBLISHED[name]
    run = simulate_velocity_steps(
        law(**numbers, regularised=regularised),
        stiffness=k, time=[0.0, 10.0, 40.0], pull=[0.0, 1e-5, 3.1e-4], at=11.0 + np.arange(4),
    )  # fmt: skip
    np.testing.assert_allclose(run.coefficient, coefficient, rtol=0.0, atol=6e-9)
    np.testing.assert_allclose(run.state[:2], state, rtol=0.0, atol=6e-9)


NAGATA = {
    "evolution": "nagata", "direct_effect": 0.03, "evolution_effect": 0.034, "stress_effect": 2.0,
}  # fmt: skip


@pytest.mark.parametrize("more", [{}, {"second_evolution_effect": 0.006,
                                       "second_critical_distance": 4e-5}])  # fmt: skip
def test_the_law_of_nagata_is_that_of_an_integration_of_coefficient_and_state(more):
    truth, k = law(**NAGATA, **more), 2e3
    effects = np.array([b for b, _ in truth.states])
    distances = np.array([state for _, state in truth.states])
    V_0 = truth.reference_velocity

    def rates(_, y):
        mu, theta = y[0], y[1:]
        evolved = effects @ np.log(V_0 * theta / distances)
        V = V_0 * math.exp((mu - 0.6 - evolved) / truth.direct_effect)
        mu_dot = k * (1e-5 - V)
        loaded = truth.stress_effect / effects.sum() * theta * mu_dot
        return [mu_dot, *(1.0 - V * theta / distances - loaded)]

    at = np.linspace(0.0, 30.0, 61)
    other = solve_ivp(
        rates, (0.0, 30.0), [0.6, *distances / V_0], "Radau", at, rtol=1e-10, atol=1e-12
    )
    run = simulate_velocity_steps(
        truth, stiffness=k, time=[0.0, 10.0, 40.0], pull=[0.0, 1e-5, 3.1e-4], at=at + 10.0
    )
    np.testing.assert_allclose(run.coefficient, other.y[0], rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(run.state, other.y[1], rtol=1e-6)


def test_stress_takes_a_share_of_the_direct_effect_at_once():
    numbers = {**NAGATA, "critical_distance": 1.0}
    run = simulate_velocity_steps(
        law(**numbers), stiffness=1e9, time=[0.0, 10.0, 11.0], pull=[0.0, 1e-5, 2e-4]
    )
    # a / (1 + c) = 0.01; the state evolves by 1.9e-4 m / 1 m, which b carries below 7e-6
    assert run.coefficient[-1] == pytest.approx(0.6 + 0.010 * math.log(190.0), abs=7e-6)


@pytest.mark.parametrize("stress", [0.0, 2.0])
@pytest.mark.parametrize("effect", [-0.003, 0.004])
def test_below_the_critical_stiffness_small_deviations_grow(effect, stress):
    truth = law(
        evolution="nagata", stress_effect=stress,
        second_evolution_effect=effect, second_critical_distance=4e-5,
    )  # fmt: skip
    rates = slider.rates_of

    def growth(k):
        y = 1e-6 * np.eye(3)
        columns = [
            np.subtract(rates(truth, k)(up, 0.0, 1e-6), rates(truth, k)(-up, 0.0, 1e-6)) for up in y
        ]
        return np.linalg.eigvals(np.array(columns).T / 2e-6).real.max()

    # the eigenvalue crosses 0 at about 1e-4 / s per per mille of stiffness; differences have 1e-9
    assert growth(0.999 * truth.critical_stiffness) > 1e-6
    assert growth(1.001 * truth.critical_stiffness) < -1e-6


def test_two_states_that_evolve_alike_are_one():
    both = law(second_evolution_effect=0.005, second_critical_distance=1e-5, evolution_effect=0.009)
    assert both.critical_stiffness == pytest.approx(law().critical_stiffness, rel=1e-12)
    path = {"stiffness": 2e3, "time": KNOTS, "pull": PULL, "at": np.linspace(0.0, 120.0, 40)}
    one, two = (simulate_velocity_steps(x, **path) for x in (law(), both))
    np.testing.assert_allclose(two.coefficient, one.coefficient, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(two.second_state, one.state, rtol=1e-7)
    assert [*two.to_dataframe()] == ["time", "coefficient", "velocity", "state", "second_state"]


@pytest.mark.parametrize("evolution", ["ageing", "slip", "prz", "nagata"])
def test_the_regularised_form_rests_and_reverses(evolution):
    truth = law(evolution=evolution, regularised=True)
    run = simulate_velocity_steps(
        truth, stiffness=2e4, time=[0.0, 20.0, 60.0, 200.0],
        pull=1e-6 * np.array([0.0, 20.0, -20.0, -1420.0]), at=[20.0, 50.0, 200.0],
    )  # fmt: skip
    # pulled back by 30 um, the spring is nearly slack: mu / k, less what slipped before it let go
    assert abs(run.coefficient[1]) < 0.02
    assert abs(run.velocity[1]) < 1e-20
    # backwards at 10 um/s, as forwards
    assert run.velocity[-1] == pytest.approx(-1e-5, rel=1e-6)
    assert run.coefficient[-1] == pytest.approx(float(truth.steady(-1e-5)), abs=1e-8)
    assert float(truth.steady(-1e-5)) == pytest.approx(-(0.6 - 0.004 * math.log(10.0)), rel=1e-12)
    with pytest.raises(InputError, match="regularised=True follows it backwards"):
        simulate_velocity_steps(
            replace(truth, regularised=False), stiffness=2e4, time=[0, 20, 60], pull=[0, 2e-5, 0]
        )


def test_the_regularised_form_without_a_state_has_a_closed_form_at_rest():
    truth = law(**CONSTANT, regularised=True)
    # a slow arcsinh: at a speed far below V_0 exp(-mu_0 / a), friction is a V exp(mu_0 / a) / 2 V_0
    slow = 1e-36
    assert float(truth.steady(slow)) == pytest.approx(
        0.010 * slow / 2e-6 * math.exp(60.0), rel=1e-9
    )
    np.testing.assert_array_equal(truth.steady([0.0]), [0.0])
    # and at large ratios nothing overflows
    stiff = law(**CONSTANT, direct_effect=1e-4, regularised=True)
    assert float(stiff.steady(1e-6)) == pytest.approx(0.6, rel=1e-12)
    run = simulate_velocity_steps(
        truth, stiffness=1e3, time=[0.0, 10.0, 300.0], pull=[0.0, 1e-5, -2.89e-3]
    )
    assert run.coefficient[-1] == pytest.approx(-(0.6 + 0.010 * math.log(10.0)), abs=1e-9)


OTHERS = {
    "rate-and-state-prz": {"evolution": "prz"},
    "rate-and-state-nagata": NAGATA,
    "rate-and-two-states": {"second_evolution_effect": 0.006, "second_critical_distance": 6e-5},
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["rate-and-state-prz", "rate-and-state-nagata", "rate-and-two-states"],
)
def test_other_forms_are_recovered_from_their_own_data(name):
    truth = law(**OTHERS[name])
    found = fitted(record(truth, noise=3e-4), name, drift="none", starts=1)
    assert found.law.name == name
    assert found.rms == pytest.approx(3e-4, rel=0.1)
    # intervals are 1 to 2 % of the values here
    for estimate in found.estimates:
        if estimate.path.startswith("friction."):
            assert estimate.value == pytest.approx(getattr(truth, estimate.path[9:]), rel=0.05)
    assert found.derived[0].value == pytest.approx(truth.rate, abs=1e-4)


def test_forms_contain_those_with_fewer_parameters_of_the_same_evolution():
    forms = RATE_STATE_FORMS

    def within(name):
        return [other for other in forms if forms[name].contains(forms[other])]

    simple = ["constant-coefficient", "logarithmic"]
    assert within("rate-and-state-slip") == simple
    assert within("rate-and-state-nagata") == [*simple, "rate-and-state"]
    assert within("rate-and-two-states-prz") == [*simple, "rate-and-state-prz"]
    assert within("rate-and-two-states-nagata") == [
        *simple, "rate-and-state", "rate-and-state-nagata", "rate-and-two-states",
    ]  # fmt: skip


def test_a_spring_softer_than_the_critical_one_is_refused_in_words():
    soft = 0.5 * law(direct_effect=0.001).critical_stiffness
    with pytest.raises(SimulationError, match="runs away"):
        simulate_velocity_steps(
            law(direct_effect=0.001), stiffness=soft, time=[0, 10, 500], pull=[0, 1e-5, 4.91e-3]
        )


def test_a_speed_that_cannot_be_followed_is_answered_by_the_cures_that_help():
    hold = {"time": [0, 10, 1000, 1100], "pull": [0, 1e-5, 1e-5, 1.1e-4]}
    small = law(direct_effect=1e-6, evolution_effect=0.005, critical_distance=1e-5)
    with pytest.raises(
        SimulationError, match=r"direct effect \(a\) of 1 × 10⁻⁶ .* Give a larger a;"
    ):
        simulate_velocity_steps(small, stiffness=1e3, **hold)
    simulate_velocity_steps(replace(small, direct_effect=1e-3), stiffness=1e3, **hold)
    jump = {"time": [0, 10, 11], "pull": [0, 1e-5, 1.01e-3]}
    usual = replace(small, direct_effect=1e-3)
    with pytest.raises(SimulationError, match=r"a larger k \(it must be above 400 1/m\)"):
        simulate_velocity_steps(usual, stiffness=400.4, **jump)
    simulate_velocity_steps(usual, stiffness=420.0, **jump)


def test_only_known_evolutions_are_taken():
    with pytest.raises(ParameterError, match="'ageing', 'slip', 'prz' or 'nagata'"):
        law(evolution="aging")


@pytest.mark.parametrize(
    ("time", "pull", "message"),
    [
        ([0.0, 0.0], [0.0, 1.0], "increase strictly"),
        ([0.0, 1.0, 2.0], [0.0, 1.0, 0.5], "never back"),
        ([0.0, 1.0], [0.0, 0.0], "forwards at first"),
        ([0.0], [0.0], "at least 2"),
    ],
)
def test_a_pull_that_cannot_be_used_is_refused(time, pull, message):
    with pytest.raises(InputError, match=message):
        simulate_velocity_steps(law(), stiffness=1e3, time=time, pull=pull)


def test_changes_of_speed_are_found_within_the_scatter_of_the_pull():
    t = np.arange(0.0, 120.0, 0.1)
    scatter = np.random.default_rng(0).normal(0.0, 2e-7, len(t))
    path = path_of(t, np.interp(t, KNOTS, PULL) + scatter)
    # a bend by 9 um/s is placed to about 0.2 um / 9 um/s, some samples together do better
    np.testing.assert_allclose(path.steps, KNOTS[1:-1], atol=0.03)
    np.testing.assert_allclose(path.speeds, 1e-6 * np.array([1, 10, 1, 10]), rtol=0.01)


def test_a_load_point_that_stands_has_one_speed_of_nothing():
    t = np.arange(0.0, 119.95, 0.1)
    pull = 1e-6 * np.interp(t, [0.0, 20.0, 60.0, 80.0, 120.0], [0.0, 200.0, 200.0, 400.0, 800.0])
    path = path_of(t, pull)
    # pieces of some milliseconds stood about the step at 60 s before
    np.testing.assert_allclose(path.steps, [20.0, 60.0], atol=0.02)
    assert abs(path.speeds[1]) < 1e-4 * path.speeds[0]


@pytest.mark.slow
def test_slide_hold_slide_is_fitted():
    path = {"knots": np.array([0.0, 20.0, 60.0, 80.0, 120.0])}
    path["places"] = 1e-6 * np.array([0.0, 20.0, 20.0, 40.0, 440.0])
    found = fitted(record(law(), noise=3e-4, **path), drift="none", starts=1)
    assert found.law.direct_effect == pytest.approx(0.010, rel=0.05)
    assert found.law.evolution_effect == pytest.approx(0.014, rel=0.05)


def test_a_steady_pull_has_no_change_of_speed():
    t = np.arange(0.0, 120.0, 0.1)
    scatter = np.random.default_rng(0).normal(0.0, 2e-7, len(t))
    assert len(path_of(t, 1e-6 * t + scatter).steps) == 0


@pytest.mark.parametrize("evolution", ["ageing", pytest.param("slip", marks=pytest.mark.slow)])
def test_parameters_are_recovered_where_friction_overshoots(evolution):
    found = fitted(record(law(evolution=evolution), noise=3e-4), FORMS[evolution], drift="none")
    # intervals are some per cent wide; means over short stretches bias by less than 2 %
    assert found.law.direct_effect == pytest.approx(0.010, rel=0.03)
    assert found.law.evolution_effect == pytest.approx(0.014, rel=0.03)
    assert found.law.critical_distance == pytest.approx(1e-5, rel=0.03)
    assert found.details["stiffness_over_load"] == pytest.approx(STIFFNESS, rel=0.03)
    assert found.derived[0].value == pytest.approx(-0.004, abs=5e-5)
    assert found.details["separable"]
    assert found.rms == pytest.approx(3e-4, rel=0.1)  # 1,200 samples know it to 2 %


@pytest.mark.slow
def test_a_drift_is_found_where_there_is_one_and_left_out_where_there_is_none():
    drifting = fitted(record(law(), noise=3e-4, drift=5.0))
    assert drifting.details["drift"] == pytest.approx(5.0, rel=0.1)
    assert "drifts" in drifting.verdict.words.lede
    assert fitted(record(law(), noise=3e-4)).details["drift"] == 0.0


def test_a_record_without_a_step_is_refused():
    t = np.arange(0.0, 60.0, 0.1)
    steady = Measurement(time=t, pull=1e-6 * t, friction=0.6 + 0.0 * t, load=1.0)
    with pytest.raises(InputError, match="needs a step"):
        fitted(steady)


def test_a_record_without_a_load_point_is_refused():
    t = np.arange(0.0, 60.0, 0.1)
    with pytest.raises(InputError, match="pull is missing"):
        fitted(Measurement(time=t, friction=0.6 + 0.0 * t))


def test_a_stopped_search_says_so():
    made = record(law(**CONSTANT), noise=3e-4)
    found = fitted(made, "logarithmic", drift="none", progress=lambda _: False)
    assert any("stopped before its end" in line for line in found.sentences)


def test_a_step_that_meets_a_bound_is_made_again_for_the_others():
    # two nearly equal columns: without the bound one goes far up and the other far down
    table = np.array([[1.0, -1.0], [1.0, -1.001], [1.0, -0.999]])
    residual = np.array([-1.0, -1.0, -1.1])
    at, low, high = np.zeros(2), np.array([-np.inf, 0.0]), np.full(2, np.inf)
    step, promised = step_of(table, residual, at, low, high, 1e-12)
    best = table[:, 0] @ residual / 3.0
    # with the second held at its bound, the first has the closed form of a mean
    np.testing.assert_allclose(step, [best, 0.0], atol=1e-9)
    assert promised == pytest.approx(3.0 * best**2)


@pytest.fixture(scope="module")
def rock(data_dir):
    return load_measurement(
        data_dir / "rock_velocity_step" / "sepiolite.parquet",
        columns={"time": "t_s", "pull": "disp_um", "friction": "mu"},
        gain={"pull": 1e-6},
    )


@pytest.mark.slow
def test_of_the_rock_only_the_difference_of_a_and_b_is_known(rock):
    found = fitted(rock, after=120e-6, drift="none")  # as the published fit is made
    # published fit: 0.0157, b about 0
    assert found.derived[0].value == pytest.approx(0.0157, abs=0.001)
    assert found.rms <= 0.00113  # published: 1.1e-3
    drifting = fitted(rock, after=120e-6)  # a drift takes a part of one step
    assert drifting.derived[0].low < 0.0157 < drifting.derived[0].high
    for one in (found, drifting):
        assert not one.details["separable"]
        assert any("larger and smaller ones" in line for line in one.sentences)


@pytest.mark.slow
def test_the_whole_rock_record_has_the_difference_of_its_levels_where_nothing_drifts(rock):
    found = fitted(rock, drift="none")
    t, mu = rock.time - rock.time[0], rock.friction
    levels = mu[t > 1234.6].mean() - mu[t < 1234.6].mean()
    # the mean after the step holds the rise too, and friction wanders by 3 % of the step there
    assert found.derived[0].value == pytest.approx(levels / math.log(10.0), rel=0.03)
    # what friction does along the way is told from what it does with speed, with less certainty
    drifting = fitted(rock)
    assert drifting.details["drifts"]
    assert drifting.derived[0].low < 0.0157 + 0.001  # as published of the first 120 um
    # 1.4 to 2.2 times as wide by the seed of the draws
    assert drifting.derived[0].half_width > 1.2 * found.derived[0].half_width


@pytest.mark.parametrize("evolution", [pytest.param("ageing", marks=pytest.mark.slow), "slip"])
def test_a_machine_a_third_too_stiff_as_given_costs_no_truth(evolution):
    made = record(law(evolution=evolution), noise=3e-4, seed=11)
    machine = TowedBlock(mass=1e-3, stiffness=1.35 * STIFFNESS, speed=1e-6, load=1.0)
    found = fit_rate_state(machine, FORMS[evolution], made)
    truth = {"a": 0.010, "b": 0.014, "D_c": 1e-5, "k": STIFFNESS}
    for estimate in found.estimates:
        if estimate.quantity.symbol in truth:
            assert estimate.low < truth[estimate.quantity.symbol] < estimate.high
            assert estimate.half_width < 0.05 * estimate.value
    # as certain, it is false: the stiffness is out by ten times its standard error
    sure = fit_rate_state(machine, FORMS[evolution], made, fixed={"stiffness": machine.stiffness})
    assert sure.rms > 1.2 * found.rms


def test_a_stated_uncertainty_of_the_stiffness_is_its_prior():
    made = record(law(**CONSTANT, direct_effect=1e-5), noise=3e-3)
    stated = replace(made, parameter_uncertainties={"mechanism.stiffness": 100.0})
    machine = TowedBlock(mass=1e-3, stiffness=2e3, speed=1e-6, load=1.0)
    # friction that hardly depends on speed says nothing of the machine
    k = fit_rate_state(machine, "logarithmic", stated).estimate("stiffness")
    assert k.half_width == pytest.approx(1.96 * 100.0, rel=0.15)  # of 400 draws
    usual = fit_rate_state(machine, "logarithmic", made)
    assert usual.estimate("stiffness").half_width == pytest.approx(1.96 * 600.0, rel=0.2)
    assert any("The stiffness of the machine" in line for line in usual.sentences)


@pytest.mark.slow
def test_a_fit_is_plain_numbers_and_runs_as_the_slider_does():
    found = fitted(record(law(), noise=3e-4), drift="none")
    assert json.loads(json.dumps(found.to_dict()))["separable"] is True
    assert "<p>" in found._repr_html_()
    # steps of the fit err by a hundredth of the noise
    path, problem = found.problem.record.path, found.problem
    run = simulate_velocity_steps(
        found.law, stiffness=found.details["stiffness_over_load"], time=path.time,
        pull=path.position, at=problem.times,
    )  # fmt: skip
    fitted_ = problem.at({found.name: found.family.mode[None]}, problem.times)[found.name][:, 0]
    level = found.law.reference_coefficient
    np.testing.assert_allclose(run.coefficient, level + fitted_, rtol=0.0, atol=5e-6)


def test_without_evolution_the_closed_form_is_that_of_a_minute_evolution_effect():
    at = np.linspace(0.0, 100.0, 400)
    knots, pull = [0.0, 20.0, 60.0, 80.0, 100.0], 1e-6 * np.array([0.0, 20.0, 420.0, 420.0, 440.0])
    plain = law(**CONSTANT)
    run = simulate_velocity_steps(plain, stiffness=500.0, time=knots, pull=pull, at=at)
    # with b = 0 the state has no effect, and LSODA integrates the same equation to 1e-11
    same = simulate_velocity_steps(
        law(evolution_effect=0.0), stiffness=500.0, time=knots, pull=pull, at=at
    )
    np.testing.assert_allclose(run.coefficient, same.coefficient, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(run.velocity, same.velocity, rtol=1e-7)


def test_friction_that_falls_with_speed_follows_the_load_point_at_once():
    plain = law(direct_effect=-0.004, **CONSTANT)
    run = simulate_velocity_steps(
        plain, stiffness=1e3, time=[0.0, 10.0, 20.0], pull=[0, 1e-5, 1.1e-4]
    )
    np.testing.assert_allclose(
        run.coefficient, [0.6, 0.6, 0.6 - 0.004 * math.log(10.0)], rtol=1e-12
    )
    assert plain.critical_stiffness == math.inf


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"evolution": "none"}, "neither evolution_effect"),
        ({"critical_distance": None}, "must be above 0 m, got none"),
        ({"direct_effect": -0.01}, "either sign"),
        ({"stress_effect": 1.0}, "a parameter of evolution='nagata'"),
        ({**NAGATA, "evolution_effect": 0.0}, "which it divides"),
        ({"second_evolution_effect": 0.01}, "D_2"),
        ({**CONSTANT, "second_critical_distance": 1e-5}, "leave it out"),
        ({**CONSTANT, "direct_effect": -0.01, "regularised": True}, "not regularised"),
    ],
)
def test_parameters_must_be_those_of_the_evolution(changes, message):
    with pytest.raises(ParameterError, match=message):
        law(**changes)


def test_each_form_is_named_by_its_values():
    assert law().name == "rate-and-state"
    assert law(evolution="slip").name == "rate-and-state-slip"
    assert law(**CONSTANT).name == "logarithmic"
    assert law(direct_effect=0.0, **CONSTANT).name == "constant-coefficient"
    assert all(form.fit_order for form in RATE_STATE_FORMS.values())


@pytest.mark.parametrize(
    ("machine", "form", "options", "message"),
    [
        (MACHINE, Coulomb, {}, "slip speed was not measured"),
        (MACHINE, "rate-and-stat", {}, "Did you mean"),
        (MACHINE, "logarithmic", {"vary": "evolution_effect"}, "has no evolution_effect"),
        (MACHINE, "rate-and-state", {"vary": ["friction.*", "mass"]}, "cannot vary mechanism.mass"),
        (MACHINE, "rate-and-state", {"vary": "friction.reference_velocity"}, "convention"),
        (MACHINE, "rate-and-state", {"vary": "direct_effect"}, "neither varied nor fixed"),
        (TowedBlock(mass=1.0, stiffness=1.0, speed=1.0, damping=0.1), RateState, {}, "damping"),
        (
            TowedBlock(
                mass=1.0,
                stiffness=1.0,
                speed=1.0,
                load=1.0,
                modulation=Sine(amplitude=0.1, frequency=1.0),
            ),
            RateState,
            {},
            "modulation",
        ),
    ],
)
def test_what_cannot_be_fitted_is_refused_in_words(machine, form, options, message):
    with pytest.raises(InputError, match=message):
        fit_rate_state(machine, form, record(law(), noise=3e-4), **options)


def test_what_is_fixed_is_held_and_the_rest_is_found():
    truth = record(law(), noise=3e-4)
    found = fit_rate_state(
        MACHINE,
        RateState,
        truth,
        fixed={"critical_distance": 1e-5, "stiffness": STIFFNESS, "reference_velocity": 1e-5},
        drift="none",
    )
    assert found.law.critical_distance == 1e-5
    assert found.mechanism.stiffness == STIFFNESS
    assert [e.quantity.symbol for e in found.estimates] == ["a", "b", "mu_0"]
    # at ten times the speed, the level is that of the steady law there
    assert found.law.reference_coefficient == pytest.approx(0.6 - 0.004 * math.log(10.0), abs=2e-4)
    held = fit_rate_state(
        MACHINE, law(), truth, vary=["reference_coefficient"], fixed={"stiffness": 2e3}
    )
    assert held.law.direct_effect == 0.010
    assert [e.quantity.symbol for e in held.estimates] == ["mu_0"]


@pytest.mark.slow
def test_forces_at_a_load_give_the_coefficients_and_a_stiffness_in_newtons_per_metre():
    one = record(law(), noise=3e-4)
    ten = Measurement(time=one.time, pull=one.pull, friction=10.0 * one.friction)
    machine = TowedBlock(mass=1e-3, stiffness=5e3, speed=1e-6, load=10.0)
    found = fit_rate_state(machine, RateState, ten, vary=FREE, drift="none", starts=1)
    assert found.mechanism.stiffness == pytest.approx(10.0 * STIFFNESS, rel=0.05)
    assert found.details["stiffness_over_load"] == pytest.approx(STIFFNESS, rel=0.05)
    assert found.estimate("stiffness").value == pytest.approx(found.mechanism.stiffness)


@pytest.mark.slow
def test_a_fit_says_whether_the_mass_could_matter():
    truth = record(law(), noise=3e-4)
    light = fitted(truth, drift="none")
    assert not any("the mass" in line for line in light.sentences)
    heavy = TowedBlock(mass=1e3, stiffness=2e3, speed=1e-6, load=1.0)
    # sqrt(1000 kg / 2000 N/m) = 0.7 s beside 10 um / (10 um/s) = 1 s
    found = fit_rate_state(heavy, RateState, truth, drift="none")
    assert any("The effect of the mass" in line for line in found.sentences)


def test_a_rate_and_state_fit_is_no_rig_file(tmp_path):
    found = fitted(record(law(), noise=3e-4), "logarithmic", drift="none")
    with pytest.raises(InputError, match="no law of a rig file"):
        found.save(tmp_path / "law.toml")
    assert not list(tmp_path.iterdir())
    assert list(found.to_dataframe()["symbol"]) == ["a", "k", "mu_0"]
    assert found.law_estimates().law == "logarithmic"


def test_records_of_a_load_point_are_served_unless_the_slider_itself_was_measured():
    one = record(law(), noise=3e-4)
    assert one.content == "velocity steps"
    values = {"time": one.time, "pull": one.pull, "friction": one.friction}
    measured = Measurement(**values, velocity=np.gradient(one.pull, one.time))
    assert measured.content == "records"
    assert Measurement(time=one.time, friction=one.friction).content == measured.content


SINGLE = {"knots": KNOTS[:3], "places": PULL[:3]}


@pytest.mark.slow
@pytest.mark.parametrize("steps", [{}, SINGLE], ids=["three-steps", "one-step"])
def test_intervals_hold_the_truth_where_noise_is_autocorrelated(steps):
    # 30 records: of 95 % intervals 27 or more hold with a chance of 0.94
    truth = {"a": 0.010, "b": 0.014, "D_c": 1e-5, "a - b": -0.004}
    held = dict.fromkeys(truth, 0)
    for seed in range(30):
        made = record(law(), noise=5e-4, seed=seed, memory=0.3, **steps)
        found = fitted(made, drift="none", starts=1)
        for estimate in (*found.estimates, *found.derived):
            if estimate.quantity.symbol in truth:
                held[estimate.quantity.symbol] += (
                    estimate.low <= truth[estimate.quantity.symbol] <= estimate.high
                )
    assert min(held.values()) >= 27, held


@pytest.mark.parametrize("held", [{}, {"direct_effect": 0.012}], ids=["free", "a held"])
def test_what_a_step_shows_under_stress_gives_the_parameters_back(held):
    form = RATE_STATE_FORMS["rate-and-state-nagata"]
    steps = VelocitySteps(
        record_of(record(law(), noise=5e-4)), {"law": SteppedLaw(form=form, held=held)},
        block=MACHINE, doubt=0.1, reference=1e-6,
    )  # fmt: skip
    values = {"direct_effect": 0.012, "evolution_effect": 0.02, "critical_distance": 1e-5,
              "stress_effect": 2.0, "stiffness": 2000.0}  # fmt: skip
    back = steps.values("law", steps._point("law", values)[None])
    assert {name: x[0] for name, x in back.items()} == pytest.approx(values)


def test_effects_that_stress_leaves_open_are_drawn_in_all_their_width():
    # c hardly shows beside a / (1 + c), a - b and (1 + c) D_c: in a, b and D_c that is a bent ridge
    truth = law(evolution="nagata", evolution_effect=0.0074, stress_effect=1.6)
    machine = replace(MACHINE, stiffness=1600.0)
    found = fit_rate_state(machine, "rate-and-state-nagata", record(truth, noise=5e-4))
    assert found.family.effective > ENOUGH
    intervals = {item.path: (item.low, item.high) for item in found.estimates}
    low, high = intervals["friction.stress_effect"]
    assert low < 1.0  # c of the prior is .3 to 5
    assert high > 3.0
    low, high = intervals["friction.direct_effect"]
    assert low < 0.0075
    assert high > 0.02


def jerked(pieces):
    """Return times and pulls [m] at the ends of pieces of (speed [um/s], duration [s])."""
    speeds, lengths = np.array(pieces).T
    times = np.concatenate([[0.0], np.cumsum(lengths)])
    return times, 1e-6 * np.concatenate([[0.0], np.cumsum(speeds * lengths)])


@pytest.mark.parametrize(
    ("pieces", "steps", "speeds"),
    [
        # overshoot at each step; jerks within pieces of one speed; a standstill between
        ([(1, 40), (30, 0.5), (10, 30), (3, 0.5), (1, 40)], (40.0, 70.5), (1, 10, 1)),
        ([(1, 20), (4, 0.3), (1, 20), (10, 15), (40, 0.3), (10, 15)], (40.3,), (1, 10)),
        ([(1, 40), (10, 15), (0, 0.4), (10, 15)], (40.0,), (1, 10)),
        # a fast piece is short, and goes as far as the others
        ([(1, 100), (50, 2), (1, 100)], (100.0, 102.0), (1, 50, 1)),
    ],
)
def test_a_jerk_of_the_load_point_is_part_of_its_path_and_no_step(pieces, steps, speeds):
    knots, places = jerked(pieces)
    t = np.linspace(0.0, knots[-1], 3000)
    path = path_of(t, np.interp(t, knots, places))
    assert path.steps == pytest.approx(steps, abs=0.1)
    assert 1e6 * path.lasting == pytest.approx(speeds, rel=1e-2)
    # the jerk itself is kept: what it moves the slider by is predicted
    left = np.interp(t, path.time, path.position) - np.interp(t, knots, places)
    assert np.abs(left).max() < 1e-3 * places[-1]


def test_means_over_stretches_follow_friction_in_a_fast_piece_that_is_sampled_faster():
    # pieces of 400 samples: of the fast one, a third lies within one sample of a slow one
    knots, places = jerked([(1, 400), (10, 40), (1, 400), (300, 4 / 3), (1, 400)])
    t = np.concatenate([np.linspace(a, b, 400, endpoint=False) for a, b in pairwise(knots)])
    truth = law(**CONSTANT)
    run = simulate_velocity_steps(truth, stiffness=STIFFNESS, time=knots, pull=places, at=t)
    pull = np.interp(t, knots, places)
    made = record_of(Measurement(time=t, pull=pull, friction=run.coefficient, load=1.0))
    times, means, count = made.stretches()
    assert len(times) < count.sum() == len(t)
    near = np.insert(t, 9, t[8] + 1e-12)  # two samples at nearly one time change little
    friction, pull_near = np.interp(near, t, run.coefficient), np.interp(near, knots, places)
    twice = Measurement(time=near, pull=pull_near, friction=friction, load=1.0)
    assert abs(len(record_of(twice).stretches()[0]) - len(times)) <= 2
    there = np.interp(times, t, run.coefficient)
    # 0.1 % of the step of 0.06 at most
    assert np.abs(means - there).max() < 6e-5
    friction = run.coefficient + np.random.default_rng(5).normal(0.0, 3e-4, len(t))
    noisy = Measurement(time=t, pull=pull, friction=friction, load=1.0)
    estimates = {item.path: item for item in fitted(noisy, "logarithmic").estimates}
    direct, stiffness = estimates["friction.direct_effect"], estimates["mechanism.stiffness"]
    assert direct.low <= 0.010 <= direct.high
    assert stiffness.low <= STIFFNESS <= stiffness.high


@pytest.mark.slow
def test_steps_with_jerks_are_explained():
    knots, places = jerked([(1, 40), (30, 0.5), (10, 20), (3, 0.5), (1, 40)])
    t = np.linspace(0.0, knots[-1], 600)
    run = simulate_velocity_steps(law(), stiffness=STIFFNESS, time=knots, pull=places, at=t)
    noise = np.random.default_rng(3).normal(0.0, 5e-4, len(t))
    record = Measurement(
        time=t, pull=np.interp(t, knots, places), friction=run.coefficient + noise, load=1.0
    )
    verdict = select(MACHINE, ["constant-coefficient", "rate-and-state"], record, vary=FREE)
    assert verdict.best is not None
    assert verdict.best.name == "rate-and-state"
    assert verdict.best.score < 1e-3  # the noise, twice
