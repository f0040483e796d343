"""Optimisation: known optima in closed form, limits, scenarios, fronts, messages.

The closed forms are those of a body of mass M on the ground with Coulomb friction and an inner mass
m with a bounded rate U and acceleration W, the problem of F. L. Chernousko (2002):
v' = -m / (M + m) xi'' - friction / (M + m).
"""

import json
import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import cma
import numpy as np
import pytest

from stickslip import Axis, Capsule, Coulomb, PendulumCart, load_rig, optimise, simulate
from stickslip.errors import ConvergenceError, InputError, ParameterError, UnknownNameError
from stickslip.mechanisms import DCMotor, Link, Prescribed, SerialArm, SoftStop, Torque
from stickslip.mechanisms.drives import Sine, SplineSwing, Square, ThreePhase
from stickslip.study.optimisation import GOALS, Margin, Optimum, measure
from stickslip.study.optimisation.search import WIDTH

GRAVITY, SHARE = 9.81, 0.2
STROKE = ThreePhase(amplitude=0.008, fast=20.0, slow=9.0, first="slow")
CAPSULE = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=STROKE))
LAW = Coulomb(kinetic_coefficient=0.2)
PROFILE = "mechanism.drive.profile."
STROKES = {PROFILE + "amplitude": (1e-3, 0.01), PROFILE + "slow": (1.0, 15.0)}
PUSHED = Capsule(
    capsule_mass=0.08,
    inner_mass=0.02,
    stiffness=60.0,
    damping=0.03,
    drive=Torque(drive=Square(high=0.15, low=0.0, period=0.15, duty=0.4)),
    upper_soft_stop=SoftStop(place=1e-3, stiffness=5000.0),
)
"""A capsule that a force with a duty cycle drives against a stop."""
GAPS = {"drive.drive.duty": (0.1, 0.9), "upper_soft_stop.place": (1e-4, 3e-3)}


def speed_within_rate(rate, acceleration, coefficient):
    """Mean speed of three phases with equal outer ones, at rest in the first.

    The outer acceleration is the largest that leaves the body at rest. In the middle phase it gains
    2 U (m / (M + m) - a / W), a = mu g, and loses it at 2 a in the last.
    """
    a = coefficient * GRAVITY
    q = SHARE - a / acceleration
    way = 2.0 * rate**2 * q**2 * (1.0 / (acceleration * q) + 0.5 / a)
    return way / (2.0 * rate * (1.0 / acceleration + SHARE / a))


@pytest.mark.slow
def test_the_optimum_of_the_closed_form_is_reached_within_the_limit():
    known = speed_within_rate(0.2, 50.0, 0.2)
    ends = {**STROKES, PROFILE + "fast": (20.0, 50.0)}
    best = optimise(CAPSULE, LAW, ends, limits={"xi_dot": 0.2}, evaluations=600)
    assert best.value == pytest.approx(known, rel=1e-3)
    assert best.value <= known
    assert best.best.parameters[PROFILE + "slow"] == pytest.approx(0.2 * GRAVITY / SHARE, rel=1e-2)
    (margin,) = best.best.margins
    assert margin.kept
    assert margin.reached <= 0.2 * (1.0 + 1e-9)
    assert best.run.certificate.certified
    # 300 runs of 96 cycles take 8 GB
    assert all(cycle.run is None for motion in best.motions for cycle in motion.cycles)


def test_a_limit_of_the_acceleration_is_that_of_the_profile():
    ends = {**STROKES, PROFILE + "fast": (20.0, 100.0)}
    best = optimise(CAPSULE, LAW, ends, limits={"acceleration": 40.0}, evaluations=60)
    assert best.best.parameters[PROFILE + "fast"] <= 40.0 * (1.0 + 1e-9)
    (margin,) = best.best.margins
    assert margin.unit == "m/s^2"
    assert margin.reached == pytest.approx(best.best.parameters[PROFILE + "fast"], rel=1e-9)


@pytest.mark.slow
def test_a_capsule_that_a_force_drives_is_optimised():
    best = optimise(PUSHED, LAW, GAPS, evaluations=60, limits={"xi": 0.05})
    assert best.value > 3.0 * best.start.goals["speed"] > 0.0
    cycle = measure(best.mechanism, LAW)
    assert cycle.speed == best.value
    assert cycle.peak_force == pytest.approx(0.15, rel=1e-12)
    assert best.mechanism.drive.drive.duty == best.best.parameters["mechanism.drive.drive.duty"]


def test_a_search_that_has_converged_begins_again_from_another_start(monkeypatch):
    begun = []
    usual = cma.CMAEvolutionStrategy

    def watched(place, width, options):
        begun.append((np.round(place, 6).tolist(), width))
        return usual(place, width, {**options, "maxiter": 2})  # as if it had converged

    monkeypatch.setattr(cma, "CMAEvolutionStrategy", watched)
    good, better = ({PROFILE + "amplitude": 5e-3, PROFILE + "slow": x} for x in (9.0, 9.8))
    asked = {"evaluations": 40, "seed": 3}
    found = optimise(CAPSULE, LAW, STROKES, starts=[good, better], **asked)
    log = math.log
    places = [[log(5.0) / log(10.0), log(x) / log(15.0)] for x in (9.8, 9.0)]
    as_given = [log(8.0) / log(10.0), log(9.0) / log(15.0)]
    known = sorted(map(tuple, np.round([*places, as_given], 6).tolist()))
    assert sorted(tuple(place) for place, _ in begun[:3]) == known
    assert {width for _, width in begun[:3]} == {0.5 * WIDTH}
    assert len(begun) > 3
    assert begun[3][1] == WIDTH
    assert found.evaluations == 3 + 40 + (-40 % 6)  # generations of six, all of them used
    again = optimise(CAPSULE, LAW, STROKES, starts=[good, better], **asked)
    assert again.best.parameters == found.best.parameters


def test_motions_that_do_not_repeat_may_be_beyond_a_limit():
    wild = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, restitution=0.6,
        upper_stop=2e-3, lower_stop=-1.5e-3,
        drive=Torque(drive=Sine(amplitude=0.49, frequency=14.0)),
    )  # fmt: skip
    assert not measure(wild, LAW).repeats
    path, limits = "drive.drive.amplitude", {"unsettled": 0.0}
    starts = [{path: 0.05}]
    found = optimise(wild, LAW, {path: (0.02, 0.5)}, limits=limits, starts=starts, evaluations=4)
    assert found.start.reason == "exceeds unsettled"
    assert found.best.cycles[0].repeats
    assert measure(found.mechanism, LAW).repeats


def test_the_positions_of_a_spline_are_parameters():
    spline = SplineSwing(positions=(-0.004, -0.002, 0.001, 0.005, 0.004), duration=0.2)
    swung = replace(CAPSULE, drive=Prescribed(profile=spline))
    ends = {f"drive.profile.positions.{k}": (-0.01, 0.01) for k in range(5)}
    best = optimise(swung, LAW, ends, limits={"xi": 0.012}, evaluations=40)
    assert best.value > best.start.goals["speed"]
    positions = tuple(best.best.parameters.values())
    assert best.mechanism.drive.profile.positions == positions


def test_two_goals_give_a_front_on_which_none_is_better_in_both():
    pytest.importorskip("pymoo")
    ends = {**STROKES, PROFILE + "fast": (20.0, 100.0)}
    front = optimise(CAPSULE, LAW, ends, goals=("speed", "energy"), evaluations=160)
    speeds, costs = ([m.goals[name] for m in front.motions] for name in ("speed", "energy"))
    assert len(speeds) > 5
    assert (np.diff(speeds) < 0.0).all()
    assert (np.diff(costs) < 0.0).all()
    # friction takes mu (M + m) g a metre, which no motor gets back
    assert min(costs) > 0.2 * 1.0 * GRAVITY
    assert [*front.to_dataframe().columns][:2] == ["speed", "energy"]
    again = optimise(CAPSULE, LAW, ends, goals=("speed", "energy"), evaluations=160)
    assert json.dumps(again.to_dict()) == json.dumps(front.to_dict())


def test_the_same_seed_gives_the_same_result_whoever_runs_it():
    ask = {"limits": {"xi": 0.01}, "evaluations": 24, "seed": 3}
    here = optimise(CAPSULE, LAW, STROKES, **ask)
    with ThreadPoolExecutor(2) as pool:
        there = optimise(CAPSULE, LAW, STROKES, executor=pool, **ask)
    assert json.dumps(here.to_dict()) == json.dumps(there.to_dict())
    assert (
        here.best.parameters != optimise(CAPSULE, LAW, STROKES, **ask | {"seed": 4}).best.parameters
    )


@pytest.mark.parametrize(
    ("quantile", "statistic"),
    [(0.0, np.min), (0.25, lambda x: np.quantile(x, 0.25)), ("mean", np.mean)],
)
def test_what_counts_of_scenarios_is_a_quantile_or_the_mean(quantile, statistic):
    laws = [Coulomb(kinetic_coefficient=mu) for mu in (0.18, 0.19, 0.2, 0.21)]
    found = optimise(CAPSULE, LAW, STROKES, scenarios=laws, quantile=quantile, evaluations=8)
    speeds = [measure(found.mechanism, law).speed for law in laws]
    assert found.value == pytest.approx(statistic(speeds), rel=1e-9)


def test_scenarios_are_values_of_parameters_too():
    cases = [{"kinetic_coefficient": 0.18}, {"incline": 0.02}]
    found = optimise(CAPSULE, LAW, STROKES, scenarios=cases, quantile=0.0, evaluations=8)
    speeds = [
        measure(found.mechanism, Coulomb(kinetic_coefficient=0.18)).speed,
        measure(replace(found.mechanism, incline=0.02), LAW).speed,
    ]
    assert found.value == pytest.approx(min(speeds), rel=1e-9)
    assert found.scenarios == "the worst of 2 scenarios"


def test_the_result_is_never_worse_than_the_mechanism_as_given():
    best = optimise(CAPSULE, LAW, STROKES, evaluations=1, limits={"xi": 0.02})
    assert best.start.feasible
    assert best.value >= best.start.goals["speed"]


def test_a_stopped_search_keeps_the_best_so_far():
    best = optimise(CAPSULE, LAW, STROKES, progress=lambda *_: False)
    assert best.cancelled
    assert best.evaluations < 20


def test_the_rig_file_reads_back(tmp_path):
    best = optimise(PUSHED, LAW, GAPS, evaluations=8)
    (tmp_path / "rig.toml").write_text(best.to_toml())
    assert load_rig(tmp_path / "rig.toml").mechanism == best.mechanism


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"goals": "sped"}, "Did you mean 'speed'"),
        ({"goals": ("speed", "speed")}, "one or two of"),
        ({"parameters": {}}, "at least one"),
        ({"parameters": {"drive.profile.slow": (2.0, 1.0)}}, "must increase"),
        ({"parameters": {"drive.profile.slow": 3.0}}, "must be"),
        ({"parameters": {"drive.profile.slow": (-1.0, 3.0)}}, "above 0"),
        ({"parameters": {"drive.profile.last": (1.0, 3.0)}}, "no value yet"),
        ({"parameters": {"lower_stop": (1.0, 3.0)}}, "no value yet"),
        ({"parameters": {"stifness": (1.0, 3.0)}}, "unknown parameter"),
        ({"limits": {"xy": 1.0}}, "unknown limit"),
        ({"limits": {"xi": -1.0}}, "at least 0"),
        ({"scenarios": []}, "at least one"),
        ({"quantile": 2.0}, "quantile"),
        ({"evaluations": 0}, "at least 1"),
        ({"seed": -1}, "at least 0"),
        ({"progress": 3}, "progress must be callable"),
    ],
)
def test_bad_arguments_are_refused_with_a_cure(change, message):
    ask = {"parameters": STROKES, **change}
    with pytest.raises((InputError, ParameterError, UnknownNameError), match=message):
        optimise(CAPSULE, LAW, **ask)


def test_limits_that_no_motion_keeps_are_refused_with_the_reason():
    with pytest.raises(ConvergenceError, match="exceeds xi_dot"):
        optimise(CAPSULE, LAW, STROKES, limits={"xi_dot": 1e-6}, evaluations=8)


def test_a_voltage_is_no_force():
    motor = DCMotor(resistance=2.0, torque_constant=0.5, drive=Sine(amplitude=3.0, frequency=2.0))
    axis = Axis(inertia=1e-3, drive=motor)
    law = Coulomb(kinetic_coefficient=0.05)
    with pytest.raises(InputError, match="exert no force"):
        optimise(axis, law, {"inertia": (1e-3, 1e-2)}, goals="energy", evaluations=4)


def test_a_voltage_at_a_joint_is_no_force_either():
    motor = DCMotor(resistance=2.0, torque_constant=0.5, drive=Sine(amplitude=3.0, frequency=2.0))
    link = Link(mass=0.5, length=0.3, centre=0.15, inertia=0.01, torque=motor)
    arm = SerialArm(links=(link,))
    law = Coulomb(kinetic_coefficient=0.05)
    with pytest.raises(InputError, match="exert no force"):
        optimise(arm, law, {"links.0.mass": (0.4, 0.6)}, goals="peak_force", evaluations=4)


def test_a_run_that_ends_early_has_no_objective():
    wild = ThreePhase(amplitude=1.0, fast=900.0, slow=500.0)
    cart = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=wild))
    with pytest.raises(ConvergenceError, match="Lift-off: the normal force fell to zero"):
        optimise(cart, LAW, {"pendulum.profile.fast": (800.0, 900.0)}, evaluations=4)


@pytest.mark.parametrize(
    ("name", "allowed", "beyond"),
    [("xi", 0.01, 0.01 + 2.3e-16), ("load_share", 0.1, 0.1 * (1.0 - 0.9e-9))],
)
def test_a_limit_that_is_just_reached_is_not_exceeded_by_rounding(name, allowed, beyond):
    def margin(reached):
        return Margin(name=name, allowed=allowed, reached=reached, unit="")

    assert margin(allowed).kept
    assert margin(beyond).kept
    assert not margin(allowed + math.copysign(1e-6, beyond - allowed)).kept


def test_goals_pickle_and_show(tmp_path):
    assert [*GOALS] == ["speed", "energy", "peak_force"]
    best = optimise(PUSHED, LAW, GAPS, evaluations=8)
    assert isinstance(best, Optimum)
    assert "mean speed" in repr(best)
    run = simulate(best.mechanism, best.law, t_end=best.run.span[1])
    assert run["x"][-1] == pytest.approx(best.run["x"][-1], rel=1e-6)
