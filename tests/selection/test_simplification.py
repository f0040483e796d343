"""Laws without parts of which a record does not tell the parameters."""

import numpy as np

from stickslip import Axis, Measurement, RecordSettings, fit
from stickslip.friction import law
from stickslip.kinds.joints.admissibility import objection

AXIS = Axis(inertia=1.0)
SETTINGS = RecordSettings(starts=1)


def noise(count=100):
    return 0.01 * np.random.default_rng(4).normal(size=count)


def test_a_value_below_0_that_is_sure_is_no_objection():
    t = 0.01 * np.arange(2000)
    x, v = np.sin(t), np.cos(t)
    friction = 2.0 * (1.0 - 0.3 * x) * np.sign(v) + noise(len(t))
    record = Measurement(time=t, position=x, velocity=v, friction=friction)
    found = fit(AXIS, law("level * linear[position]"), record, settings=SETTINGS)
    (slope,) = [one for one in found.estimates if one.path.endswith("slope")]
    assert slope.high < 0.0
    assert not objection(found)
