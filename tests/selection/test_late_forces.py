"""A late force channel is told from presliding, named with its size, and corrected for."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks import force_maps

from stickslip import Axis, CoulombViscous, Measurement, RecordSettings, fit
from stickslip.errors import InputError, ParameterError
from stickslip.identification import model_errors
from stickslip.identification.estimation.bristle_integration import Path, follow
from stickslip.identification.settings import PROMPT, SensorResponse
from stickslip.identification.terms.findings import asked_of

LEVEL, VISCOUS, RATE = 2.0, 3.0, 200.0
AXIS = Axis(inertia=1.0)
LAWS = ["coulomb-viscous", "dahl"]
QUICK = RecordSettings(starts=1)


def record(response=None, *, law=None, drift=0.0, seed=0):
    """Friction along a sum of sines, as a force channel shows it."""
    t = np.arange(0.0, 8.0, 0.1 / RATE)
    x = 0.03 * np.sin(4.0 * t) + 0.01 * np.sin(11.3 * t + 1.0)
    v = np.gradient(x, t)
    if law is None:
        friction = LEVEL * np.sign(v) + VISCOUS * v
    else:
        path = Path(time=t, velocity=v, load=np.ones(len(t)), travel=np.diff(x))
        friction = law.force(v, 1.0, tuple(follow(law, path, np.zeros((1, 1)))[..., 0]))
    if response is not None:
        friction = response.shown(t, friction)
    rng = np.random.default_rng(seed)
    rows = slice(None, None, 10)
    t, x, friction = t[rows], x[rows], friction[rows] + drift * t[rows] / t[-1]
    return Measurement(
        time=t,
        position=x + 1e-6 * rng.normal(size=len(t)),
        friction=friction + 0.02 * LEVEL * rng.normal(size=len(t)),
        load=1.0,
    )


LATE = SensorResponse(delay=0.02)
SLOW = SensorResponse(lag=0.012)


@pytest.mark.slow
@pytest.mark.parametrize("response", [LATE, SensorResponse(delay=-0.02), SLOW])
def test_the_force_balance_shows_how_late_friction_is_recorded(response):
    found = fit(AXIS, CoulombViscous, record(response), settings=QUICK)
    error = found.model_errors[0]
    assert error.kind == ("lag" if response.lag else "delay")
    # of a motion that is 20 ms late the sign is the other one
    assert error.effect == pytest.approx(-response.late, rel=0.05)


@pytest.mark.parametrize(
    "response", [LATE, SensorResponse(delay=-0.02), SLOW, SensorResponse(delay=0.3)]
)
def test_what_the_channel_does_is_taken_off(response):
    own = replace(QUICK, friction_delay=response.delay, friction_lag=response.lag)
    found = fit(AXIS, CoulombViscous, record(response), settings=own)
    level, viscous, _ = (estimate.value for estimate in found.estimates)
    # when the direction changes within a sample is not known, which a filter spreads
    assert level == pytest.approx(LEVEL, rel=0.01)
    assert viscous == pytest.approx(VISCOUS, rel=0.08)
    assert found.model_errors == ()
    # of a long delay, too, within which no motion is known
    assert found.rms < (2.0 if response.lag else 1.5) * 0.02 * LEVEL


@pytest.mark.slow
def test_a_drifting_force_sensor_is_named():
    found = fit(AXIS, CoulombViscous, record(drift=0.5 * LEVEL), settings=QUICK)
    (error,) = found.model_errors
    assert error.kind == "drift of the offset"
    assert error.effect == pytest.approx(0.5 * LEVEL, rel=0.02)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_prompt_channel_shows_no_error(seed):
    assert fit(AXIS, CoulombViscous, record(seed=seed), settings=QUICK).model_errors == ()


def test_a_lag_shows_a_ramp_late_by_its_time_constant():
    t = np.linspace(0.0, 1.0, 501)
    shown = SensorResponse(lag=0.05).shown(t, 3.0 * t)
    # the closed form of a first-order system, which is exact for forces that are linear in time
    np.testing.assert_allclose(shown, 3.0 * (t - 0.05 * (1.0 - np.exp(-t / 0.05))), atol=1e-12)


@pytest.mark.parametrize(
    ("given", "error", "said"),
    [
        ({"friction_delay": np.nan}, ParameterError, "must be a finite number in s, got nan"),
        ({"friction_lag": -1e-3}, ParameterError, "must be at least 0 s, got -0.001"),
        ({"friction_delay": 20.0}, InputError, "shorter than the record of 8 s, got 20 s"),
    ],
)
def test_responses_that_make_no_sense_are_refused(given, error, said):
    with pytest.raises(error, match=said):
        fit(AXIS, CoulombViscous, record(), settings=RecordSettings(**given))


def test_a_response_is_of_measured_friction_in_time():
    v = np.linspace(-1.0, 1.0, 40)
    table = Measurement(velocity=v, friction=np.sign(v) + v)
    with pytest.raises(InputError, match="a table of friction against velocity has none"):
        fit(AXIS, CoulombViscous, table, settings=RecordSettings(friction_delay=0.01))
    driven = Measurement(time=np.arange(40) * 0.1, position=v, force=v)
    with pytest.raises(InputError, match=r"applies to measured friction \(route force-map\)"):
        fit(
            AXIS, CoulombViscous, driven, settings=RecordSettings(friction_lag=0.01),
            route="shooting",
        )  # fmt: skip


@pytest.mark.slow
def test_presliding_that_may_be_a_late_channel_is_one_finding_without_a_wrong_sign():
    # a force channel that is late by 8 ms, and no law with memory
    row, _, measured, _ = force_maps.drawn(1, 971)
    assert row["fault"] == "delay"
    asked = asked_of(force_maps.AXIS, measured, "zero", (), PROMPT)
    found = model_errors(asked.explanation, measured, "zero", PROMPT)
    assert [one.kind for one in found] == ["delay or presliding"]


@pytest.mark.parametrize(
    ("number", "seed", "kind"),
    [
        pytest.param(8, 9443, "lag", marks=pytest.mark.slow),
        pytest.param(8, 971, "late or elastic", marks=pytest.mark.slow),
        pytest.param(2, 9450, "delay or presliding", marks=pytest.mark.slow),
    ],
)
def test_a_filter_of_the_force_channel_does_not_pass_for_a_law_with_memory(number, seed, kind):
    """Both got "Use Dahl friction", with 7 and 9 times the stated error on another motion."""
    row, _, measured, _ = force_maps.drawn(number, seed)
    asked = asked_of(force_maps.AXIS, measured, "zero", (), PROMPT)
    (found,) = model_errors(asked.explanation, measured, "zero", PROMPT)
    assert found.kind == kind
    assert -found.effect == pytest.approx(row["size"], rel=0.06)


@pytest.mark.parametrize(
    ("number", "seed", "late"),
    [
        (14, 9462, True),
        pytest.param(13, 9462, True, marks=pytest.mark.slow),
        pytest.param(12, 9462, False, marks=pytest.mark.slow),
        pytest.param(30, 9465, False, marks=pytest.mark.slow),
    ],
)
def test_presliding_that_explains_more_behind_a_late_channel_is_in_doubt(number, seed, late):
    """Behind a filter of 8 ms, a stiffness of 45 N/mm was settled for one of 103."""
    row, law, measured, _ = force_maps.drawn(number, seed)
    asked = asked_of(force_maps.AXIS, measured, "zero", (), PROMPT)
    assert law.states
    assert asked.explanation.best.structure.memories
    found = model_errors(asked.explanation, measured, "zero", PROMPT)
    assert [one.kind for one in found] == ["delay or presliding"] * (row["fault"] != "none")
    assert late is bool(found)
