"""Environments of Gymnasium: their steps are those of the exact engine."""

import dataclasses
import itertools
import json
import math
import pickle
import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from tests.support import module_at

from stickslip import Axis, Coulomb, EventDriven, LuGre, Measurement, Stribeck, select, simulate
from stickslip.engine import Status
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.exports import (
    CAPSULE,
    CART,
    MotorEnvironment,
    MotorVectorEnvironment,
    register_environments,
)
from stickslip.friction import TISSUES
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import ThreePhase

register_environments()
FILES = Path(__file__).parents[2] / "docs" / "howto" / "files"
HARD = dataclasses.replace(CART, position_limit=6.0, rate_limit=200.0)
"""A pendulum that may swing fast enough to lift the cart off."""


def actions(steps, count=1, share=0.3, seed=0):
    return np.random.default_rng(seed).uniform(-share, share, (steps, count, 1))


def played(env, told, **given):
    seen, _ = env.reset(**given)
    rows = [(seen, 0.0, False, False)]
    for action in told:
        *row, _ = env.step(action)
        rows.append(tuple(row))
    return rows


def begun(state):
    return MotorEnvironment().reset(options={"state": state})


def alike(a, b):
    return all(
        np.array_equal(x, y) for x, y in zip(itertools.chain(*a), itertools.chain(*b), strict=True)
    )


@pytest.mark.parametrize("name", ["stickslip/Cart-v0", "stickslip/Capsule-v0"])
def test_gymnasium_finds_nothing_to_complain_about(name):
    check_env(gymnasium.make(name).unwrapped, skip_render_check=True)


def test_a_name_with_its_module_is_found_in_a_process_of_its_own():
    name = "stickslip.exports.gym:stickslip/Capsule-v0"
    told = f"import gymnasium; print(gymnasium.make({name!r}).unwrapped.task.effort_limit)"
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", told], check=True, capture_output=True, text=True
    )
    assert run.stdout.strip() == "8.0"
    register_environments()  # again, without a warning


@pytest.mark.parametrize("task", [CART, CAPSULE], ids=["cart", "capsule"])
def test_an_episode_is_the_run_of_the_engine(task):
    env = MotorEnvironment(task)
    env.reset(seed=3)
    for action in actions(40)[:, 0]:
        seen, *_, info = env.step(action)
    run = env.trajectory()
    assert run.certificate.certified
    end = run.at([run.span[1]])
    # both hold 1e-9 of the largest value of each step
    np.testing.assert_allclose(info["state"], [end[name][0] for name in run.states], atol=1e-7)
    last = np.array([end[name][0] for name in task.observation_names])
    bounds = env.observation_space.high
    np.testing.assert_allclose(seen, np.clip(last, -bounds, bounds), atol=1e-7)
    assert env.reset()[1]["travel"] == 0.0


def test_the_reward_is_travel_less_weighted_work():
    env = MotorEnvironment(CART)
    _, first = env.reset(seed=1)
    _, reward, _, _, then = env.step(np.array([0.6]))
    turned = then["state"][1] - first["state"][1]
    work = 0.6 * CART.effort_limit * turned  # a constant torque over an angle
    assert work > 0.0
    assert reward == pytest.approx(then["state"][0] - CART.work_weight * work, rel=1e-12)
    assert then["work"] == pytest.approx(work, rel=1e-12)
    _, _, _, _, later = env.step(np.array([-0.2]))  # it brakes
    assert later["state"][1] > then["state"][1]
    assert later["work"] == then["work"]  # what is given back is lost


def test_many_that_step_together_do_what_each_does_alone():
    told = actions(60, 40)
    task = dataclasses.replace(CART, duration=0.25)
    envs = MotorVectorEnvironment(40, task, threads=2)
    together = played(envs, told, seed=7)
    for row in (0, 39):
        env = MotorEnvironment(task)
        seen, _ = env.reset(seed=7 + row)
        over = False
        for k, action in enumerate(told, start=1):
            if over:  # it begins anew, and its action is ignored
                (seen, _), reward, over, ended = env.reset(), 0.0, False, (False, False)
            else:
                seen, reward, *ended, _ = env.step(action[row])
                over = any(ended)
            np.testing.assert_array_equal(together[k][0][row], seen)
            assert together[k][1][row] == reward
            assert (together[k][2][row], together[k][3][row]) == tuple(ended)


def test_they_are_the_same_whatever_the_number_of_threads():
    told = actions(20, 64, share=1.0)
    one, two = (played(MotorVectorEnvironment(64, threads=n), told, seed=0) for n in (1, 2))
    assert alike(one, two)


def test_seeds_tell_episodes_apart():
    env, told = MotorEnvironment(), actions(3)[:, 0]
    assert alike(played(env, told, seed=1), played(env, told, seed=1))
    assert not alike(played(env, told, seed=1), played(env, told, seed=2))
    starts = {float(env.reset()[0][1]) for _ in range(5)}
    assert len(starts) == 5


def test_a_reset_in_mid_episode_leaves_nothing_of_it():
    env, told = MotorEnvironment(), actions(10)[:, 0]
    fresh = played(env, told, seed=1)
    played(env, actions(7, seed=9)[:, 0], seed=5)
    assert alike(played(env, told, seed=1), fresh)


def test_some_of_many_may_be_reset():
    envs = MotorVectorEnvironment(3)
    envs.reset(seed=0)
    for _ in range(3):
        seen, *_ = envs.step(np.full((3, 1), 0.2))
    mask = np.array([False, True, False])
    again, info = envs.reset(options={"reset_mask": mask, "state": {"theta": 0.02}})
    np.testing.assert_array_equal(again[~mask], seen[~mask])
    assert again[1].tolist() == [0.0, 0.02, 0.0]
    assert info["work"][1] == 0.0 < info["work"][0]


def test_a_pickled_environment_goes_on_as_the_first_does():
    env, told = MotorEnvironment(), actions(10)[:, 0]
    played(env, told, seed=1)
    other = pickle.loads(pickle.dumps(env))
    for action in told:
        assert np.array_equal(env.step(action)[0], other.step(action)[0])
    assert env.reset()[0].tolist() == other.reset()[0].tolist()  # the generator too
    envs = MotorVectorEnvironment(33, threads=2)
    envs.reset(seed=0)
    twin = pickle.loads(pickle.dumps(envs))
    told = actions(1, 33)[0]
    assert np.array_equal(envs.step(told)[0], twin.step(told)[0])


@pytest.mark.slow
def test_processes_of_their_own_do_the_same():
    told = actions(30, 3)
    apart = gymnasium.vector.AsyncVectorEnv([MotorEnvironment] * 3, context="spawn")
    try:
        found = played(apart, told, seed=4)
    finally:
        apart.close()
    assert alike(found, played(MotorVectorEnvironment(3), told, seed=4))


def test_gymnasium_steps_many_by_the_vectorised_one():
    envs = gymnasium.make_vec("stickslip/Capsule-v0", num_envs=2)
    assert isinstance(envs, MotorVectorEnvironment)
    assert envs.task is CAPSULE
    assert envs.observation_space.contains(envs.reset(seed=0)[0])


@pytest.mark.parametrize("action", [np.array([np.nan]), np.array([0.1, 0.2]), np.array([])])
def test_what_is_no_action_is_refused_and_changes_nothing(action):
    env = MotorEnvironment()
    env.reset(seed=0)
    with pytest.raises(InputError, match="action"):
        env.step(action)
    twin = MotorEnvironment()
    twin.reset(seed=0)
    assert np.array_equal(env.step(np.array([0.1]))[0], twin.step(np.array([0.1]))[0])
    assert env.trajectory().span[1] == CART.period


def test_the_row_of_an_action_that_is_no_number_is_named():
    envs = MotorVectorEnvironment(3)
    envs.reset(seed=0)
    with pytest.raises(InputError, match="mechanism 2"):
        envs.step(np.array([[0.0], [0.0], [np.nan]]))


@pytest.mark.parametrize("beyond", [7.0, math.inf])
def test_an_action_beyond_its_bounds_is_the_bound(beyond):
    a, b = MotorEnvironment(), MotorEnvironment()
    a.reset(seed=0), b.reset(seed=0)
    assert np.array_equal(a.step(np.array([beyond]))[0], b.step(np.array([1.0]))[0])
    assert a.trajectory()["x"][-1] == b.trajectory()["x"][-1]


def test_a_cart_that_lifts_off_ends_its_episode_there():
    env = MotorEnvironment(HARD)
    env.reset(options={"state": {"theta": 0.0}})
    for _ in range(200):
        seen, _, terminated, _, info = env.step(np.array([1.0]))
        assert env.observation_space.contains(seen)
        if terminated:
            break
    assert info["ending"] == Status.LIFT_OFF.value
    run = env.trajectory()
    assert run.status is Status.LIFT_OFF
    np.testing.assert_allclose(info["state"], [run[n][-1] for n in run.states], atol=1e-6)
    # it stays where it lifted off until it is reset
    assert np.array_equal(env.step(np.array([1.0]))[4]["state"], info["state"])


def test_a_start_beyond_a_hard_stop_is_refused():
    inside = dataclasses.replace(
        CAPSULE.mechanism, lower_stop=-0.01, upper_stop=0.01, restitution=0.6
    )
    env = MotorEnvironment(dataclasses.replace(CAPSULE, mechanism=inside))
    with pytest.raises(InputError, match="upper stop"):
        env.reset(options={"state": {"xi": 0.015}})


def test_an_episode_ends_beyond_the_limits_of_the_pendulum():
    env = MotorEnvironment(CART)
    env.reset(options={"state": {"theta": 1.0, "omega": 3.0}})
    for _ in range(50):
        seen, _, terminated, _, info = env.step(np.array([1.0]))
        if terminated:
            break
    assert "limit" in info["ending"]
    assert abs(info["state"][1]) > CART.position_limit
    assert env.observation_space.contains(seen)


def test_an_episode_is_truncated_after_its_time():
    task = dataclasses.replace(CAPSULE, duration=0.03, period=0.01)
    assert task.steps == 3
    rows = played(MotorEnvironment(task), np.zeros((3, 1)), seed=0)
    assert [row[3] for row in rows] == [False, False, False, True]
    assert not any(row[2] for row in rows)


def test_without_friction_the_centre_of_mass_stays():
    task = dataclasses.replace(CAPSULE, law=Coulomb(kinetic_coefficient=0.0))
    env = MotorEnvironment(task)
    _, first = env.reset(seed=0)
    for action in actions(20)[:, 0]:
        *_, info = env.step(action)
    share = task.mechanism.inner_mass / (task.mechanism.capsule_mass + task.mechanism.inner_mass)
    centre = [float(i["state"][0] + share * i["state"][1]) for i in (first, info)]
    assert centre[1] == pytest.approx(centre[0], abs=1e-12)
    assert abs(info["travel"]) > 1e-5


def test_other_laws_and_mechanisms_serve():
    law = LuGre(
        kinetic_coefficient=0.2, static_coefficient=0.25, stribeck_velocity=0.01,
        bristle_stiffness=1e4, bristle_damping=10.0,
    )  # fmt: skip
    task = dataclasses.replace(CAPSULE, law=law, solver=EventDriven(tolerance=1e-6))
    env = MotorEnvironment(task)
    played(env, actions(5)[:, 0], seed=0)
    assert env.trajectory().certificate.certified
    still = MotorVectorEnvironment(
        2, dataclasses.replace(CART, law=Coulomb(kinetic_coefficient=5.0))
    )
    _, _ = still.reset(seed=0, options={"state": {"theta": 0.01}})
    *_, info = still.step(np.zeros((2, 1)))
    assert info["travel"].tolist() == [0.0, 0.0]  # it sticks


LAWS = [
    *(Coulomb(kinetic_coefficient=mu) for mu in (0.1, 0.2, 0.3)),
    Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.02),
    LuGre(
        kinetic_coefficient=0.2, static_coefficient=0.25, stribeck_velocity=0.01,
        bristle_stiffness=1e4, bristle_damping=10.0,
    ),
]  # fmt: skip
INCLINES = [-0.1, 0.0, "5 deg"]
DRAWN = {"laws": LAWS, "vary": {"incline": INCLINES}}


def test_a_seed_draws_a_law_and_parameters():
    env = MotorEnvironment("capsule", **DRAWN)
    drawn = [env.reset(seed=seed)[1]["drawn"] for seed in (*range(60), *range(60))]
    assert drawn[:60] == drawn[60:]
    assert {LAWS.index(entry["law"]) for entry in drawn} == {*range(len(LAWS))}
    inclines = {float(entry["mechanism.incline"]) for entry in drawn}
    assert inclines == {-0.1, 0.0, math.radians(5.0)}
    env.reset(seed=3)
    after = [env.reset()[1]["drawn"] for _ in range(3)]  # the generator goes on
    assert any(one != drawn[3] for one in after)


def test_each_law_is_as_likely():
    envs = MotorVectorEnvironment(600, "capsule", **DRAWN)
    laws = envs.reset(seed=0)[1]["drawn"]["law"]
    counts = [sum(one is law for one in laws) for law in LAWS]
    # 120 of each are expected, with a standard deviation of 9.8
    assert sum(counts) == 600
    assert max(abs(count - 120) for count in counts) < 40


def test_episodes_with_what_they_drew_are_runs_of_the_engine():
    env = MotorEnvironment("capsule", **DRAWN)
    ends = set()
    for seed in range(12):
        drawn = env.reset(seed=seed)[1]["drawn"]
        for action in actions(8, share=0.2, seed=seed)[:, 0]:
            *_, info = env.step(action)
        mechanism = dataclasses.replace(
            CAPSULE.mechanism, incline=float(drawn["mechanism.incline"])
        )
        task = dataclasses.replace(CAPSULE, law=drawn["law"], mechanism=mechanism)
        run = task.trajectory(env._start, env._actions)
        end = [run[name][-1] for name in run.states]
        np.testing.assert_allclose(info["state"], end, atol=1e-7)
        assert env.trajectory()["x"][-1] == run["x"][-1]
        ends.add(round(float(end[0]), 9))
    assert len(ends) > 3


def test_many_draw_what_each_draws_alone():
    task, told = dataclasses.replace(CAPSULE, duration=0.1), actions(40, 20, share=0.2)
    envs = MotorVectorEnvironment(20, task, threads=2, **DRAWN)
    _, info = envs.reset(seed=5)
    infos = [info] + [envs.step(action)[-1] for action in told]
    laws = set()
    for row in range(20):
        env = MotorEnvironment(task, **DRAWN)
        _, alone = env.reset(seed=5 + row)
        over = False
        for k, action in enumerate(told):
            if over:
                (_, alone), over = env.reset(), False
            else:
                *_, terminated, truncated, alone = env.step(action[row])
                over = terminated or truncated
            together = infos[k + 1]
            assert together["travel"][row] == alone["travel"]
            assert {n: together["drawn"][n][row] for n in alone["drawn"]} == alone["drawn"]
            laws.add(LAWS.index(alone["drawn"]["law"]))
    assert len(laws) == len(LAWS)


def test_without_lists_the_law_of_the_task_is_drawn_and_seeds_mean_the_same():
    env, listed = MotorEnvironment(), MotorEnvironment(laws=[CART.law], vary={"incline": [0.0]})
    told = actions(5)[:, 0]
    assert alike(played(env, told, seed=1), played(listed, told, seed=1))
    assert env.reset()[1]["drawn"] == {"law": CART.law}


def verdict_on_a_table():
    v = np.linspace(0.02, 1.0, 12)
    noise = np.random.default_rng(1).normal(size=12)
    table = Measurement(
        velocity=v, friction=1.2 + 0.3 * v + 0.02 * noise, load=np.linspace(4.0, 6.0, 12)
    )
    return select(Axis(inertia=1.0), None, table)


@pytest.mark.parametrize(
    "drawing",
    [lambda: TISSUES["wet"], pytest.param(verdict_on_a_table, marks=pytest.mark.slow)],
    ids=["tissue", "verdict"],
)
def test_a_verdict_or_a_tissue_draws_the_laws(drawing):
    made = drawing()
    laws = MotorVectorEnvironment(200, laws=made).reset(seed=0)[1]["drawn"]["law"]
    drawn = made.sample()
    assert len(drawn) == 20
    assert all(any(one == law for law in drawn) for one in laws)
    assert all(any(one == law for one in laws) for law in drawn)


def test_a_pickled_environment_draws_on():
    envs = MotorVectorEnvironment(33, threads=2, **DRAWN)
    envs.reset(seed=0)
    twin = pickle.loads(pickle.dumps(envs))
    both = [one.reset() for one in (envs, twin)]
    assert np.array_equal(both[0][0], both[1][0])
    assert [*both[0][1]["drawn"]["law"]] == [*both[1][1]["drawn"]["law"]]


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: MotorEnvironment(laws=[]), InputError, "at least one"),
        (lambda: MotorEnvironment(laws=LAWS[0]), InputError, r"laws must be .* got Coulomb"),
        (lambda: MotorEnvironment(laws=[*LAWS, 0.2]), InputError, "sample"),
        (lambda: MotorEnvironment(laws=TISSUES["intestine"]), ParameterError, "logarithmic_coeff"),
        (lambda: MotorEnvironment(vary={"inclin": [0]}), UnknownNameError, "incline"),
        (lambda: MotorEnvironment(vary={"incline": 0.1}), InputError, "linspace"),
        (lambda: MotorEnvironment(vary={"incline": []}), InputError, "linspace"),
        (lambda: MotorEnvironment(vary={"incline": "5 deg"}), InputError, "linspace"),
        (lambda: MotorEnvironment(vary={"incline": [7.0]}), ParameterError, "at most 1.57 rad"),
        (lambda: MotorEnvironment("car"), UnknownNameError, "cart"),
        (lambda: MotorEnvironment(7), InputError, "MotorTask or a name"),
        (lambda: MotorEnvironment(render_mode="human"), InputError, "rgb_array"),
        (lambda: MotorVectorEnvironment(0), InputError, "num_envs"),
        (lambda: MotorVectorEnvironment(2, render_mode="rgb_array"), InputError, "render_mode"),
        (lambda: MotorEnvironment().step(np.zeros(1)), InputError, "reset"),
        (lambda: MotorEnvironment().trajectory(), InputError, "reset"),
        (lambda: MotorVectorEnvironment(2).step(np.zeros((2, 1))), InputError, "reset"),
        (lambda: MotorVectorEnvironment(2).reset(seed=[1]), InputError, "seed"),
        (lambda: dataclasses.replace(CART, mechanism=Axis(inertia=1.0)), ParameterError, "motor"),
        (lambda: dataclasses.replace(CART, law=None), ParameterError, "law"),
        (lambda: dataclasses.replace(CART, mechanism=None), ParameterError, "mechanism"),
        (lambda: dataclasses.replace(CART, solver=None), ParameterError, "solver"),
        (lambda: MotorVectorEnvironment(2, threads=0), InputError, "threads"),
        (lambda: dataclasses.replace(CART, period=0.0), ParameterError, "T_s"),
        (lambda: dataclasses.replace(CART, start_spread=2.0), ParameterError, "position_limit"),
        (lambda: begun(1.0), InputError, "by name"),
        (lambda: begun({"phi": 1.0}), UnknownNameError, "phi"),
        (lambda: begun({"theta": np.nan}), InputError, "between"),
        (lambda: begun({"v": np.inf}), InputError, "finite"),
    ],
)  # fmt: skip
def test_wrong_arguments_are_named(make, error, words):
    with pytest.raises(error, match=words):
        make()


def test_a_picture_shows_the_scene():
    env = MotorEnvironment(CAPSULE, render_mode="rgb_array")
    env.reset(seed=0)
    env.step(np.array([0.5]))
    picture = env.render()
    assert (picture.shape, picture.dtype) == ((400, 880, 3), np.uint8)
    assert picture.std() > 0
    assert MotorEnvironment().render() is None


def positive_work(run, rate, effort):
    """Return the positive work of a torque in a run (fine trapezoids)."""
    t = np.linspace(*run.span, 100_001)
    power = effort(t) * run.at(t)[rate]
    return float(np.trapezoid(np.maximum(power, 0.0), t))


@pytest.mark.parametrize(
    ("task", "motion", "mechanism"),
    [
        (CART, ThreePhase(amplitude=math.pi / 4, fast=120.0, slow=30.0), "pendulum"),
        (CAPSULE, ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow"), "drive"),
    ],
    ids=["cart", "capsule"],
)
def test_the_weight_of_the_work_is_what_the_three_phase_motion_reaches(task, motion, mechanism):
    driven = dataclasses.replace(task.mechanism, **{mechanism: Prescribed(profile=motion)})
    run = simulate(driven, task.law, t_end=4 * float(motion.period))
    last = run.at([3 * float(motion.period), 4 * float(motion.period)])["x"]
    effort, rate = ("torque", "omega") if task is CART else ("force", "xi_dot")
    t = np.linspace(3 * float(motion.period), 4 * float(motion.period), 20_001)
    seen = run.at(t)
    work = np.trapezoid(np.maximum(seen[effort] * seen[rate], 0.0), t)
    assert (last[1] - last[0]) / work == pytest.approx(task.work_weight, rel=1e-3)
    assert np.abs(seen[effort]).max() > task.effort_limit  # the environment's motor is weaker


def trainer():
    return module_at(FILES / "train_cart.py")


@pytest.mark.slow
@pytest.mark.parametrize("seed", [11, 2024])
def test_the_trained_policy_beats_the_three_phase_motion_in_the_exact_engine(seed):
    train = trainer()
    numbers = json.loads((FILES / "cart-policy.json").read_text(encoding="utf-8"))
    policy = np.array([numbers[name] for name in train.NAMES])
    env = MotorEnvironment(CART)
    seen, _ = env.reset(seed=seed)
    told = []
    for step in range(CART.steps):
        told.append(float(train.act(policy, step * CART.period, seen)))
        seen, _, terminated, _, _ = env.step(np.array(told[-1:]))
        assert not terminated
    run = env.trajectory()
    assert run.status is Status.END_TIME
    assert run.certificate.certified
    drive = env.task.driven(told).drives()["motor"]
    torques = np.array([drive.value(k * CART.period + 1e-9) for k in range(CART.steps)])
    assert np.abs(torques).max() <= CART.effort_limit
    work = positive_work(
        run, "omega", lambda t: torques[np.minimum((t / CART.period).astype(int), CART.steps - 1)]
    )
    # from rest on; the three-phase swing reaches 0.0835 m/J in its steady cycle
    assert run["x"][-1] / work > 1.08 * CART.work_weight


@pytest.mark.slow
def test_training_improves_the_policy():
    train = trainer()
    envs = MotorVectorEnvironment(train.CANDIDATES * train.EPISODES, CART)
    first = train.scores(envs, np.tile(train.START, (train.CANDIDATES, 1)), seed=10**6).mean()
    _, score = train.train(12, told=lambda _: None)
    assert score > 1.5 * first


@pytest.mark.slow
def test_the_profile_of_the_worst_quarter_beats_the_three_phase_motion():
    train = module_at(FILES / "train_capsule.py")
    start = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    best = dataclasses.replace(start, amplitude=0.0135, fast=65.6, slow=12.3, last=12.5)
    laws = [Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.05)]
    first, then = (train.returned(train.following(one), laws, 7) for one in (start, best))
    assert 0.0 < first < then
    assert train.returned(train.constant(laws), laws, 7) == pytest.approx(0.0, abs=1e-3)
