"""What to measure beside a measurement: readings of tables, and what `select` says of records."""

import io

import numpy as np
import pandas as pd
import pytest

from stickslip import Axis, Measurement, SpringBlock, load_measurement, plan, select
from stickslip.data import Layout, Reading
from stickslip.errors import InputError
from stickslip.identify import Plan
from stickslip.identify.problems.table_model import Rows
from stickslip.identify.selection import _settable, with_readings

pytestmark = pytest.mark.slow

AXIS = Axis(inertia=1.0)
SPEEDS = np.tile(np.geomspace(0.01, 0.3, 6), 3)
LOADS = np.repeat([10.0, 20.0, 40.0], 6)


def noisy(friction, seed=1):
    """Return readings with 2 % of noise."""
    return friction * (1.0 + 0.02 * np.random.default_rng(seed).normal(size=len(friction)))


@pytest.fixture(scope="module")
def loaded() -> Plan:
    """Return eight readings beside a table under three loads, with stated errors."""
    friction = 0.2 * LOADS + 0.1 * LOADS * np.exp(-((SPEEDS / 0.05) ** 2)) + 3.0 * SPEEDS
    table = Measurement(
        velocity=SPEEDS, friction=noisy(friction), load=LOADS,
        uncertainty={"friction": np.full(18, 0.1)},
    )  # fmt: skip
    result = plan(AXIS, None, table, readings=8)
    assert isinstance(result, Plan)
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


def test_the_force_of_a_motor_on_which_friction_depends_is_in_the_table():
    random, force = np.random.default_rng(2), np.tile([0.0, 1.0, 2.0, 4.0], 6)
    v = np.repeat([10.0, 20.0, 50.0, 100.0, 150.0, 200.0], 4)
    friction = 0.05 + 0.03 * force + 1e-3 * v + 0.005 * random.normal(size=24)
    table = Measurement(velocity=v, friction=friction, force=force)
    further = plan(AXIS, None, table, readings=3)
    sheet = pd.read_csv(io.StringIO(further.csv()))
    assert sheet["force [N]"].notna().all()
    assert set(sheet["force [N]"].tail(3)) <= {0.0, 1.75, 4.0}  # the mean and the ends


def test_a_condition_that_the_readings_give_stands_once_in_the_table():
    sheet = Measurement(
        velocity=np.full(4, 0.1), friction=np.ones(4), inputs={"temperature": np.arange(4.0)}
    )
    further = Plan(verdict=None, lines=(), readings={"velocity": (0.1,)}, sheet=sheet)
    head = further.csv(Reading(conditions=("temperature",))).splitlines()[0]
    assert head.count("temperature") == 1


@pytest.mark.slow
def test_what_select_and_plan_expect_of_the_same_readings_is_one_number():
    v = np.geomspace(0.01, 0.5, 14)
    verdict = select(AXIS, None, Measurement(velocity=v, friction=noisy(3.0 + 3.0 * v)))
    further = plan(AXIS, None, verdict.measurement)
    assert verdict.shrinks == further.widths[1] < 0.95
    assert sorted(verdict.places) == sorted(further.readings["velocity"])


@pytest.mark.slow
def test_readings_while_friction_falls_are_expected_to_widen_the_band():
    random, count = np.random.default_rng(4), 16
    v = random.permutation(np.tile(np.geomspace(0.01, 0.5, 8), 2))
    falling = (3.0 + 3.0 * v) * (1.0 - 0.15 * np.arange(count) / count)
    table = Measurement(velocity=v, friction=falling * (1.0 + 0.01 * random.normal(size=count)))
    assert plan(AXIS, None, table).sentence.startswith("Friction drifts")
    # a fall of 30 % instead of 15 %
    assert plan(AXIS, None, table, readings=count).widths[1] == pytest.approx(2.0, rel=0.15)


def test_a_law_that_does_not_hold_is_planned_for_as_any():
    random, v = np.random.default_rng(6), np.linspace(0.1, 1.0, 20)
    friction = (2.0 + 1.2 * v) * (1.0 + 0.01 * random.normal(size=20))
    further = plan(AXIS, ["coulomb"], Measurement(velocity=v, friction=friction), readings=4)
    assert isinstance(further, Plan)
    assert 0.0 < further.widths[0] <= further.widths[2]


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
    with pytest.raises(InputError, match="this measurement is none"):
        plan(AXIS, None, record, readings=4)


READINGS = (
    Reading(),
    Reading(columns={"velocity": "Speed (mm/s)", "friction": "F"},
            units={"velocity": "mm/s", "friction": "kN"}),
    Reading(units={"velocity": "mm/s"}, gain={"friction": -1}),
    Reading(columns={"friction": "U"}, units={"friction": "V"}, gain={"friction": 35.0}),
    Reading(units={"friction": "V", "temperature": "K"}, gain={"friction": "35 N/V"}),
    Reading(offset={"friction": 0.5}),
    Reading(columns={"velocity": "Speed"}, units={"velocity": "mm/s"},
            layout=Layout(separator=";", decimal=",", preface=2, units_row=True)),
)  # fmt: skip


@pytest.mark.parametrize("reading", READINGS, ids=range(len(READINGS)))
def test_the_table_has_the_columns_units_and_layout_of_the_rig(reading, tmp_path):
    v, f, t = np.array([[0.1, 0.2, 0.3, 0.15], [1.0, 2.0, 3.0, 0.0], [20.0, 25.0, 30.0, 27.0]])
    sheet = Measurement(
        velocity=v, friction=f, load=np.full(4, 5.0), inputs={"temperature": t},
        uncertainty={"friction": np.array([0.1, 0.2, 0.1, 0.1])},
    )  # fmt: skip
    further = Plan(verdict=None, lines=(), readings={"velocity": (0.15,)}, sheet=sheet)
    separator = (reading.layout or Layout()).separator
    *rows, made, new = further.csv(reading).splitlines()
    cells = new.split(separator)
    assert cells[1] == ""
    cells[1] = made.split(separator)[1]  # 3 N
    (tmp_path / "next.csv").write_text("\n".join([*rows, made, separator.join(cells)]) + "\n")
    given = {"layout": reading.layout} if reading.layout else {}
    again = load_measurement(
        tmp_path / "next.csv", columns=reading.columns, units=reading.units, gain=reading.gain,
        offset=reading.offset, **given,
    )  # fmt: skip
    np.testing.assert_allclose(again.values("velocity"), v, rtol=1e-9)
    np.testing.assert_allclose(again.values("friction"), [1.0, 2.0, 3.0, 3.0], rtol=1e-9)
    np.testing.assert_allclose(again.inputs["temperature"], t, rtol=1e-9)
    np.testing.assert_allclose(again.uncertainty["friction"], [0.1, 0.2, 0.1, 0.1], rtol=1e-9)


@pytest.mark.parametrize(
    ("values", "known", "expected"),
    [
        ([1234.4999], [1234.5, 1234.5], [1234.5]),  # does not vary
        ([298.3512, 0.0], [298.15, 299.65], [298.35, 0.0]),
        ([0.00123456, -0.456789], [-1.0, 1.0], [0.00123, -0.457]),
    ],
)
def test_settings_have_digits_enough_for_what_they_span(values, known, expected):
    assert _settable(np.array(values), np.array(known)).tolist() == expected


def test_an_input_that_never_changed_stays_in_the_table():
    first = Measurement(
        velocity=SPEEDS[:3], friction=SPEEDS[:3], inputs={"temperature": np.full(3, 35.0)}
    )
    one = np.array([0.05])
    rows = Rows(velocity=one, load=np.ones(1), run=np.zeros(1), order=one, inputs={})
    assert with_readings(first, rows).inputs["temperature"].tolist() == [35.0] * 4


def test_few_readings_are_given_with_their_small_gain():
    v = np.linspace(0.05, 0.4, 40)
    further = plan(AXIS, "viscous", Measurement(velocity=v, friction=noisy(3.0 * v)), readings=1)
    assert len(further.readings["velocity"]) == len(further.to_dataframe()) == 1
    assert "of its width" in further.sentence
    assert "<table>" in further._repr_html_()


BLOCK = SpringBlock(mass=0.82, stiffness=145.0, compression=0.08)
TABLE = Measurement(velocity=SPEEDS, friction=1.0 + SPEEDS)


@pytest.mark.parametrize(
    ("mechanism", "measurement", "options", "said"),
    [
        (AXIS, TABLE, {"readings": 0}, "readings .* at least 1"),
        (BLOCK, None, {}, r"docs/howto/which-experiment\.md"),
        (AXIS, TABLE, {"vary": "inertia"}, "no effect on `select` and `plan`"),
    ],
)
def test_what_has_no_effect_or_no_sense_is_refused(mechanism, measurement, options, said):
    with pytest.raises(InputError, match=said):
        plan(mechanism, None, measurement, **options)
