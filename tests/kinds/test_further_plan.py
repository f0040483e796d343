"""What to measure beside a measurement: readings of tables, and what `select` says of records."""

import io

import numpy as np
import pandas as pd
import pytest

from stickslip import Axis, Measurement, plan, select
from stickslip.errors import InputError
from stickslip.identify import FurtherPlan

AXIS = Axis(inertia=1.0)
SPEEDS = np.tile(np.geomspace(0.01, 0.3, 6), 3)
LOADS = np.repeat([10.0, 20.0, 40.0], 6)


def noisy(friction, seed=1):
    """Return readings with 2 % of noise."""
    return friction * (1.0 + 0.02 * np.random.default_rng(seed).normal(size=len(friction)))


@pytest.fixture(scope="module")
def loaded() -> FurtherPlan:
    """Return eight readings beside a table under three loads, with stated errors."""
    friction = 0.2 * LOADS + 0.1 * LOADS * np.exp(-((SPEEDS / 0.05) ** 2)) + 3.0 * SPEEDS
    table = Measurement(
        velocity=SPEEDS, friction=noisy(friction), load=LOADS,
        uncertainty={"friction": np.full(18, 0.1)},
    )  # fmt: skip
    result = plan(AXIS, None, table, readings=8)
    assert isinstance(result, FurtherPlan)
    return result


def test_readings_under_loads_have_a_load_each_within_those_measured(loaded):
    assert {*loaded.readings} == {"velocity", "load"}
    velocity, load = (np.array(loaded.readings[name]) for name in ("velocity", "load"))
    assert len(velocity) == len(load) == 8
    assert 10.0 <= load.min() <= load.max() <= 40.0
    assert 0.0099 < velocity.min() <= velocity.max() < 0.301


def test_the_table_to_fill_in_has_what_was_read_and_lacks_what_is_to_be(loaded):
    table = pd.read_csv(io.StringIO(loaded.csv()))
    assert list(table) == [
        "velocity [m/s]", "friction [N]", "friction_uncertainty [N]", "load [N]",
    ]  # fmt: skip
    assert table["friction [N]"].isna().tolist() == [False] * 18 + [True] * 8
    # readings to make are taken to be as good as those that were made
    assert (table["friction_uncertainty [N]"] == 0.1).all()
    assert tuple(table["velocity [m/s]"][18:]) == loaded.readings["velocity"]


def test_trials_get_a_trial_of_their_own():
    trials = tuple(
        Measurement(velocity=SPEEDS[:6], friction=noisy(2.0 + 3.0 * SPEEDS[:6], k), name=f"{k}")
        for k in range(3)
    )
    further = plan(AXIS, None, Measurement(trials=trials), readings=5)
    table = pd.read_csv(io.StringIO(further.csv()))
    assert (len(table), table["friction [N]"].isna().all()) == (5, True)


def test_a_record_has_no_readings_and_is_told_what_select_proposes():
    t = np.arange(0.0, 6.0, 0.01)
    x = 0.1 * np.sin(2.0 * t) + 0.03 * np.sin(5.3 * t)
    v, a = np.gradient(x, t), np.gradient(np.gradient(x, t), t)
    noise = 0.05 * np.random.default_rng(3).normal(size=len(t))
    record = Measurement(time=t, position=x, force=a + 2.0 * np.tanh(v / 1e-3) + 1.5 * v + noise)
    further = plan(AXIS, None, record)
    assert further.lines == select(AXIS, None, record).words.measure_next
    assert further.csv() == ""
    with pytest.raises(InputError, match="this measurement is neither"):
        plan(AXIS, None, record, readings=4)
