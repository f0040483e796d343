"""What a verdict on records says: second records, records that no law explains, proposals."""

import dataclasses
import math

import numpy as np

from stickslip import (
    Axis,
    Measurement,
    RecordSettings,
    Stribeck,
    check,
    fit,
)
from stickslip.formatting import Scale
from stickslip.kinds.joints.wording import first_of
from stickslip.selection.candidates import checked
from stickslip.selection.identifiable import settled_estimates
from stickslip.selection.verdict import corrections, score_text

AXIS = Axis(inertia=1.0)
QUICK = RecordSettings(starts=1)
LAWS = ["coulomb", "coulomb-viscous", "direction-dependent"]


TIME = np.linspace(0.0, 12.0, 240, endpoint=False)
RATE = 2.0 * math.pi / 3.0
PLACE, SPEED = -0.3 / RATE * np.cos(RATE * TIME + 0.3), 0.3 * np.sin(RATE * TIME + 0.3)


def rubbed(friction, **more):
    """A record of friction (n,) in time, along a motion that is measured to and fro."""
    return Measurement(time=TIME, position=PLACE, velocity=SPEED, friction=friction, **more)


def record(seed, *, forward=5.0, backward=5.0, level=2.0, noise=0.05, **more):
    """A record of friction whose viscous part may differ by direction."""
    slope = np.where(SPEED > 0.0, forward, backward)
    scatter = noise * np.random.default_rng([21, seed]).normal(size=SPEED.size)
    return rubbed(level * np.sign(SPEED) + slope * SPEED + scatter, **more)


def test_what_no_correction_answers_is_not_called_one():
    v = np.linspace(0.01, 0.3, 30)
    one_way = check(Measurement(velocity=v, friction=2.0 + v))
    said = "All velocities are forward: friction level and offset cannot be separated."
    assert corrections(one_way) == (f"Measure in the other direction, too: {said}",)
    time = np.concatenate([np.arange(100), np.arange(140, 300)]) * 1e-3
    moved = Measurement(time=time, position=0.1 * time, force=np.full(time.size, 2.0))
    found = check(moved)
    assert {one.kind for one in found.findings if one.severity == "warning"} > {"gap"}
    (first,) = corrections(found)  # what can be corrected comes first
    assert first.startswith("First correct the record: Gap of ")


def test_scores_have_the_digits_that_their_standard_error_allows():
    assert score_text(Scale(1e3, "mm"), 0.00043, 0.000079) == ("0.43", "± 0.08")
    assert score_text(Scale(1.0, "N"), 1.0, math.inf) == ("1.00", "")
    assert score_text(Scale(1.0, "rad"), 0.2, 0.03) == ("0.20", "± 0.03")


def test_a_law_with_several_objections_is_told_by_the_first():
    assert first_of("c is estimated as 0") == "c is estimated as 0"
    assert first_of("a is 0; b is 0") == "a is 0, and 1 more objection"


def test_a_step_in_doubt_settles_no_static_level_and_no_velocity():
    v = np.linspace(-0.3, 0.3, 120)
    friction = 2.0 * np.sign(v) + 5.0 * v + 0.05 * np.random.default_rng(4).normal(size=120)
    found = fit(AXIS, Stribeck, Measurement(velocity=v, friction=friction), settings=QUICK)
    low = found.estimate("static_coefficient").low
    assert low <= found.estimate("kinetic_coefficient").high  # the step may be 0
    settled = {one.path for one in settled_estimates(found)}
    assert not {"friction.static_coefficient", "friction.stribeck_velocity"} & settled
    clear = 2.0 * np.sign(v) * (1.0 + np.exp(-np.square(v / 0.05))) + 5.0 * v
    found = fit(AXIS, Stribeck, Measurement(velocity=v, friction=clear), settings=QUICK)
    step = {"friction.static_coefficient", "friction.stribeck_velocity"}
    assert step <= {one.path for one in settled_estimates(found)}
    bound = dataclasses.replace(found, at_bounds={"friction.stribeck_velocity": "lower"})
    assert not step & {one.path for one in settled_estimates(bound)}


def test_a_mass_that_is_looked_for_is_no_fault_of_the_record():
    t = np.arange(0.0, 10.0, 0.01)
    v = 0.1 * (np.sin(2.5 * t) + 0.6 * np.sin(4.3 * t + 1.0))
    x = np.concatenate([[0.0], np.cumsum(0.005 * (v[1:] + v[:-1]))])
    force = 20.0 * np.gradient(v, t) + 0.5 * np.sign(v)
    record = Measurement(time=t, position=x, force=force)
    assert [one.kind for one in checked(AXIS, record).findings if one.severity == "warning"]
    found = checked(AXIS, record, unknown=["mechanism.inertia"])
    assert not [one for one in found.findings if one.kind == "units"]
    turned = dataclasses.replace(record, force=-force)
    assert checked(AXIS, turned, unknown=["mechanism.inertia"]).of("units")
