"""Laws without parts of which a record does not tell the parameters."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, CoulombViscous, Measurement, PowerViscous, RecordSettings, Stribeck, fit
from stickslip.friction import law
from stickslip.kinds.records import selection as records
from stickslip.kinds.joints.admissibility import objection, unidentified
from stickslip.kinds.joints.simplification import one_part_less, untold
from stickslip.kinds.joints.joint_verdict import RecordCandidate
from stickslip.selection.cross_validation import CrossValidation

AXIS = Axis(inertia=1.0)
SETTINGS = RecordSettings(starts=1)


def noise(count=100):
    return 0.01 * np.random.default_rng(4).normal(size=count)


def table(step):
    """Friction at steady speeds of both directions, with a Stribeck step."""
    v = np.linspace(0.02, 1.0, 50)
    v = np.concatenate([-v[::-1], v])
    friction = (2.0 + step * np.exp(-((v / 0.1) ** 2))) * np.sign(v) + 3.0 * v
    return Measurement(velocity=v, friction=friction + noise())


@pytest.fixture(scope="module")
def spare():
    return fit(AXIS, Stribeck, table(0.0), settings=SETTINGS)


def test_a_law_without_what_a_record_does_not_tell_begins_at_the_values_of_the_whole(spare):
    # which of the two is not told is chance, where there is no step
    assert unidentified(spare) & {"static_coefficient", "stribeck_velocity"}
    ((candidate, begin),) = one_part_less(spare)
    assert (candidate.name, candidate.free) == ("coulomb-viscous", CoulombViscous.fit_order)
    levels = spare.law.kinetic_coefficient, spare.law.static_coefficient  # which become one
    assert begin.values["friction.kinetic_coefficient"] == pytest.approx(np.mean(levels))
    assert begin.values["friction.viscous_coefficient"] == spare.law.viscous_coefficient
    assert begin.cost == np.inf  # nothing was fitted: no search is measured by it


def test_a_law_that_the_record_tells_has_no_simpler_one():
    found = fit(AXIS, Stribeck, table(1.0), settings=SETTINGS)
    assert not unidentified(found)
    assert not [*one_part_less(found)]


def test_a_value_that_the_simpler_law_does_not_allow_begins_at_its_limit():
    v = np.linspace(0.02, 1.0, 50)
    v = np.concatenate([-v[::-1], v])
    friction = np.sign(v) * 5.0 * np.abs(v) ** 0.12 + noise()
    thin = fit(AXIS, PowerViscous, Measurement(velocity=v, friction=friction), settings=SETTINGS)
    assert thin.law.viscous_exponent < 0.2
    begins = [begin for _, begin in one_part_less(thin)]
    powers = [one.law.viscous_exponent for one in begins if hasattr(one.law, "viscous_exponent")]
    assert powers == [0.2]


def test_levels_of_both_directions_begin_at_their_mean():
    v = np.concatenate([np.linspace(-1.0, -0.02, 50), np.linspace(0.02, 1.0, 50)])
    readings = Measurement(velocity=v, friction=2.0 * np.sign(v) + noise())
    both = fit(AXIS, law("both_ways(level + power)"), readings, settings=SETTINGS)
    found = {one.name: (one, begin) for one, begin in one_part_less(both)}
    one, begin = found["power-viscous"]
    levels = both.law.forward_kinetic_coefficient, both.law.backward_kinetic_coefficient
    assert begin.values["friction.kinetic_coefficient"] == pytest.approx(np.mean(levels))
    assert {*one.free} == {"kinetic_coefficient", "viscous_coefficient", "viscous_exponent"}


@pytest.mark.parametrize(("force", "step", "told"), [(0, 0, False), (1, 0, False), (0, 1, True)])
def test_levels_that_differ_by_direction_by_a_constant_force_are_one(force, step, told):
    v = np.concatenate([np.linspace(-1.0, -0.02, 50), np.linspace(0.02, 1.0, 50)])
    level = 2.0 + np.where(v > 0.0, 0.5 + 0.5 * step, 0.5) * np.exp(-((v / 0.1) ** 2))
    readings = Measurement(velocity=v, friction=level * np.sign(v) + 3.0 * v + force + noise())
    kind = law("both_ways[levels](level + stribeck) + viscous")
    both = fit(AXIS, kind, readings, settings=SETTINGS)
    assert bool(untold(both) & {"forward_static_coefficient"}) is not told
    assert ("stribeck" in [one.name for one, _ in one_part_less(both)]) is not told


def test_a_value_below_0_that_is_sure_is_no_objection():
    t = 0.01 * np.arange(2000)
    x, v = np.sin(t), np.cos(t)
    friction = 2.0 * (1.0 - 0.3 * x) * np.sign(v) + noise(len(t))
    record = Measurement(time=t, position=x, velocity=v, friction=friction)
    found = fit(AXIS, law("level * linear[position]"), record, settings=SETTINGS)
    (slope,) = [one for one in found.estimates if one.path.endswith("slope")]
    assert slope.high < 0.0
    assert not objection(found)


def candidate(name, errors, fit, **more):
    """A candidate of a selection with errors of held-out blocks."""
    losses = tuple(np.square(errors))
    validation = CrossValidation(losses=losses, extrapolation=np.nan)
    return RecordCandidate(name=name, title=name, fit=fit, validation=validation, **more)


@pytest.mark.parametrize(
    ("errors", "named"),
    [
        ((1.05, 1.06, 1.04, 1.05), "rich"),  # told apart
        ((1.2, 0.9, 1.3, 1.1), "rich"),  # not told apart, but a tenth more
        ((1.2, 0.9, 1.2, 0.8), "less"),
    ],
)
def test_a_law_with_less_is_named_where_it_predicts_as_well(spare, errors, named):
    simple = fit(AXIS, CoulombViscous, table(0.0), settings=SETTINGS)
    whole = candidate("rich", (1.0, 1.0, 1.0, 1.0), spare)
    less = candidate("less", errors, simple, simplifies="rich")
    assert records._told(whole, [whole, less], (), uncertainty=0.0).name == named
    # what the balance rejects by far is not named, nor what is no less known
    assert records._told(whole, [whole, less], {"less"}, uncertainty=0.0).name == "rich"
    alike = replace(less, fit=spare)
    assert records._told(whole, [whole, alike], (), uncertainty=0.0).name == "rich"


def test_an_exponent_that_may_be_1_is_not_told_from_viscous_friction():
    found = fit(AXIS, law("level + power"), table(0.0), settings=SETTINGS)
    assert not unidentified(found)
    assert untold(found) == {"viscous_exponent"}
    assert next(one.name for one, _ in one_part_less(found)) == "coulomb-viscous"
