import dataclasses
import itertools
import math
import re

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    DirectionDependent,
    Measurement,
    RecordSettings,
    SpringBlock,
    Stribeck,
    simulate,
)
from stickslip.drives import Sampled
from stickslip.formatting import Scale, quantity
from stickslip.identification.estimation.levenberg_marquardt import improve
from stickslip.identification.records.fit import settled
from stickslip.identification.records.fitting import fit_record
from stickslip.kinds.joints.admissibility import objection
from stickslip.kinds.joints.wording import (
    distinct,
    friction_of,
    in_sentence,
)
from stickslip.kinds.records import error_text
from stickslip.selection.candidates import one_way
from stickslip.selection.cross_validation import Plan, cross_validate, plan_of
from stickslip.selection.identifiable import settled_estimates, traded

TRUTH = DirectionDependent(
    forward_kinetic_coefficient=4.0,
    backward_kinetic_coefficient=5.0,
    forward_viscous_coefficient=3.0,
    backward_viscous_coefficient=9.0,
)
AXIS = Axis(inertia=2.0)
QUICK = RecordSettings(starts=1)


def recorded(law, *, seed=0, noise=1e-5, length=8.0):
    """Return a record of the axis under a random force, as an encoder and a controller give it."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, length, 0.005)
    phases, sizes = random.uniform(0, 2 * math.pi, 5), random.uniform(4.0, 9.0, 5)
    force = sum(
        a * np.sin(2 * math.pi * f * t + p)
        for f, a, p in zip((0.23, 0.41, 0.67, 1.1, 1.7), sizes, phases, strict=True)
    )
    drive = Sampled(times=t.tolist(), values=force.tolist())
    run = simulate(dataclasses.replace(AXIS, drive=drive), law, t_end=float(t[-1]))
    return Measurement(
        time=t, position=run.at(t)["x"] + random.normal(0.0, noise, len(t)), force=force
    )


@pytest.fixture(scope="module")
def record():
    return recorded(TRUTH)


@pytest.mark.slow
def test_a_held_out_error_is_that_of_a_fit_to_the_other_segments_alone():
    record = recorded(TRUTH, length=10.0)
    exact = RecordSettings(starts=1, resolution=200)  # every sample of the force is a piece
    fit = fit_record(AXIS, DirectionDependent, record, unknown=["inertia"], settings=exact)
    plan = plan_of(fit, horizon=1.0)
    found = cross_validate(fit, plan)
    spans = fit.problem.spans[:, 1:]
    edges = np.linspace(0.0, spans[-1, 1], plan.folds + 1)
    losses = []
    for first, last in itertools.pairwise(edges):
        away = (spans[:, 1] <= first - plan.gap) | (spans[:, 0] >= last + plan.gap)
        middle = spans.mean(axis=1)
        own = [s for s, keep in zip(fit.problem.segments, away, strict=True) if keep]
        held = [s for s, at in zip(fit.problem.segments, middle, strict=True) if first <= at < last]
        anew, _ = improve(
            dataclasses.replace(fit.problem, segments=tuple(own)), fit.values, rounds=8
        )
        seen = dataclasses.replace(fit.problem, segments=tuple(held))
        judged = settled(seen, anew.values)
        losses.append(judged.cost / len(judged.residual))
    # by hand; searches end where a step gains less than 1e-4 of the cost
    np.testing.assert_allclose(found.losses, losses, rtol=0.02)


def test_titles_stand_in_sentences_as_one_says_them():
    assert friction_of("Dahl with exponent") == "Dahl friction with exponent"
    assert friction_of("Coulomb + viscous") == "Coulomb + viscous friction"
    assert in_sentence("Viscous") == "viscous"


def test_gaps_and_horizon_fit_the_record(record):
    fit = fit_record(AXIS, CoulombViscous, record, unknown=["inertia"], settings=QUICK)
    plan = plan_of(fit, horizon=100.0)
    assert plan.horizon == pytest.approx(plan.length / plan.folds)
    assert 0.0 < plan.gap <= 0.25 * plan.horizon
    assert isinstance(plan, Plan)


def decays(*compressions, noise=2e-5):
    """Return free decays of a block on a spring, and the block."""
    rig = SpringBlock(mass=1.0, stiffness=400.0, compression=0.1, attached=True)
    law = CoulombViscous(kinetic_coefficient=0.02, viscous_coefficient=0.3)
    t, random = np.arange(0.0, 4.0, 0.01), np.random.default_rng(4)
    trials = [
        Measurement(
            time=t,
            position=simulate(dataclasses.replace(rig, compression=x), law, t_end=4.0).at(t)["x"]
            + random.normal(0.0, noise, t.size),
            overrides={"mechanism.compression": x},
        )
        for x in compressions
    ]
    return rig, Measurement(trials=tuple(trials)) if len(trials) > 1 else trials[0]


def test_of_several_decays_only_the_block_is_left_out():
    rig, record = decays(0.1, 0.06)
    fit = fit_record(rig, CoulombViscous, record, settings=QUICK)
    assert len(fit.problem.spans) == 2
    found = cross_validate(fit, plan_of(fit, horizon=0.5))
    # as above: every block is predicted to its noise, from what is left of its own decay too
    assert len(found.losses) == 8
    assert found.score == pytest.approx(2e-5, rel=0.1)


def test_angles_are_written_in_thousandths_below_a_tenth():
    assert error_text(0.2, "position", turning=True) == "0.2 rad"
    assert error_text(0.02, "position", turning=True) == "20 mrad"


def test_scores_are_written_with_their_unit():
    assert error_text(0.00024, "position") == "0.24 mm"
    assert error_text(1.234, "friction") == "1.23 N"


@pytest.mark.parametrize(("way", "expected"), [(1.0, True), (-1.0, True), (0.0, False)])
def test_noise_on_positions_is_no_second_direction(way, expected):
    t = np.arange(0.0, 10.0, 0.004)
    x = 0.1 * np.sin(2.0 * math.pi * 0.3 * t) if way == 0.0 else way * 0.05 * t
    noisy = x + 1e-4 * np.random.default_rng(5).normal(size=len(t))
    assert one_way(Measurement(time=t, position=noisy, force=np.cos(t))) is expected


def test_scores_that_read_alike_have_the_digits_that_tell_them_apart():
    millimetres = Scale(1e3, "mm")
    pair = (1.2341e-3, 1.2344e-3)
    assert [distinct(millimetres, pair, one) for one in pair] == ["1.2341 mm", "1.2344 mm"]
    # equal scores, and what is no score of these, are written as ever
    assert distinct(millimetres, (pair[0], pair[0]), pair[0]) == "1.23 mm"
    assert distinct(millimetres, pair, 2e-6) == "0.00200 mm"
    assert distinct(Scale(1.0, "N"), (1.234, 1.2339999999), 1.234) == "1.23 N"


def test_a_step_that_may_be_none_is_told_with_its_unit():
    found = table_fit(Stribeck, np.linspace(0.01, 0.2, 80))
    said = objection(dataclasses.replace(found, at_bounds={}))
    assert re.search(r"its static step of \S+ N \(−\S+ to \S+\) includes 0", said)


def table_fit(law, v, noise=0.05):
    """A fit of measured friction at velocities, without an offset of the sensor."""
    friction = 2.0 * np.sign(v) + 5.0 * v
    friction += noise * np.random.default_rng(1).normal(size=len(v))
    return fit_record(AXIS, law, Measurement(velocity=v, friction=friction), settings=QUICK)


def test_what_trades_off_is_not_settled_for_itself():
    narrow = table_fit(CoulombViscous, np.linspace(0.15, 0.2, 80))
    assert traded(narrow) == {"friction.kinetic_coefficient", "friction.viscous_coefficient"}
    assert settled_estimates(narrow) == ()
    variances = np.diag(np.diag(narrow.inference.covariance))
    alone = dataclasses.replace(narrow.inference, covariance=variances)
    apart = dataclasses.replace(narrow, inference=alone)
    assert traded(apart) == frozenset()
    known = settled_estimates(apart)
    assert {e.path for e in known} == traded(narrow)
    assert (known[0].high - known[0].low) / known[0].value < (known[1].high - known[1].low) / known[
        1
    ].value


def test_an_estimate_whose_interval_holds_0_settles_nothing():
    v = np.linspace(-0.2, 0.2, 80)
    friction = 2.0 * np.sign(v) + 0.1 * v + 0.05 * np.random.default_rng(1).normal(size=80)
    found = fit_record(
        AXIS, CoulombViscous, Measurement(velocity=v, friction=friction), settings=QUICK
    )
    level, slope = (
        next(e for e in found.estimates if e.path == f"friction.{name}_coefficient")
        for name in ("kinetic", "viscous")
    )
    assert slope.bounded
    assert slope.low < 0.0 < slope.high
    assert traded(found) == frozenset()
    assert settled_estimates(found) == (level,)


def test_what_laws_that_are_not_told_apart_disagree_on_is_not_settled():
    # Coulomb friction alone takes the part that grows with the speed for its level
    v = np.linspace(0.1, 0.2, 80) * np.resize((1.0, -1.0), 80)
    friction = np.sign(v) * (2.0 + np.sqrt(np.abs(v)))
    friction += 0.01 * np.random.default_rng(3).normal(size=80)
    linear, constant = (
        fit_record(AXIS, law, Measurement(velocity=v, friction=friction), settings=QUICK)
        for law in (CoulombViscous, Coulomb)
    )
    level = "friction.kinetic_coefficient"
    variances = np.diag(np.diag(linear.inference.covariance))
    alone = dataclasses.replace(
        linear, inference=dataclasses.replace(linear.inference, covariance=variances)
    )
    assert level in {e.path for e in settled_estimates(alone)}
    assert level in {e.path for e in settled_estimates(alone, [alone])}
    assert level not in {e.path for e in settled_estimates(alone, [constant])}


def test_a_bound_is_told_with_its_unit():
    # the level falls by less than nothing: Stribeck's step goes, or its velocity runs away
    found = table_fit(Stribeck, np.linspace(0.01, 0.2, 80))
    said = {}
    for path, side in (("friction.static_coefficient", "upper"), ("friction.stribeck_velocity",
                                                                  "lower")):  # fmt: skip
        said[path] = objection(dataclasses.replace(found, at_bounds={path: side}))
    level = found.estimate("static_coefficient").value
    assert (
        f"$mu_s$ reached its upper bound of {quantity(level, 'N', 2)}"
        in said["friction.static_coefficient"]
    )
    speed = found.estimate("stribeck_velocity").value
    assert (
        f"$v_s$ reached its lower bound of {quantity(speed, 'm/s', 2)}"
        in said["friction.stribeck_velocity"]
    )
