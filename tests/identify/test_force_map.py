"""The route of measured friction: parameters from force against the motion measured with it."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import stickslip
from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    DirectionDependent,
    LuGre,
    Measurement,
    PowerViscous,
    QuadraticDrag,
    Stribeck,
    Viscous,
    load_measurement,
)
from stickslip.errors import InputError
from stickslip.friction import LAWS, BristleLaw, FrictionLaw

Array = NDArray[np.float64]

AXIS = Axis(inertia=1.0)
OFFSET = 0.3

TRUE: Mapping[str, FrictionLaw] = {
    law.name: law
    for law in (
        Coulomb(kinetic_coefficient=0.3),
        Viscous(viscous_coefficient=12.0),
        CoulombViscous(kinetic_coefficient=0.3, viscous_coefficient=8.0),
        DirectionDependent(
            forward_kinetic_coefficient=0.3,
            backward_kinetic_coefficient=0.4,
            forward_viscous_coefficient=5.0,
            backward_viscous_coefficient=9.0,
        ),
        PowerViscous(kinetic_coefficient=0.2, viscous_coefficient=6.0, viscous_exponent=0.4),
        QuadraticDrag(kinetic_coefficient=0.3, viscous_coefficient=4.0, quadratic_coefficient=20.0),
        Stribeck(
            kinetic_coefficient=0.25,
            static_coefficient=0.4,
            stribeck_velocity=0.02,
            viscous_coefficient=6.0,
        ),
        Dahl(
            kinetic_coefficient=0.4,
            bristle_stiffness=4e3,
            yield_exponent=0.6,
            viscous_coefficient=3.0,
        ),
        LuGre(
            kinetic_coefficient=0.3,
            static_coefficient=0.4,
            stribeck_velocity=0.02,
            bristle_stiffness=3e3,
            bristle_damping=0.5,
            viscous_coefficient=3.0,
        ),
    )
}


def motion(t: Array) -> tuple[Array, Array]:
    """Return position and velocity of a motion of many amplitudes that reverses often."""
    parts = ((1e-3, 3.0, 0.0), (6e-4, 7.1, 1.0), (1.2e-2, 0.9, 0.5))
    x = sum(a * np.sin(w * t + p) for a, w, p in parts)
    v = sum(a * w * np.cos(w * t + p) for a, w, p in parts)
    return np.asarray(x), np.asarray(v)


def yielding(x: Array, law: Dahl) -> Array:
    """Return Dahl's deflections in closed form: a power of displacement between turns."""
    k, n = law.bristle_stiffness / law.kinetic_coefficient, law.yield_exponent
    share = [0.0]
    for step in np.diff(x):
        r = 1.0 - share[-1] * np.sign(step)
        left = max(abs(r) ** (1.0 - n) - (1.0 - n) * k * abs(step), 0.0) ** (1.0 / (1.0 - n))
        share.append(np.sign(step) * (1.0 - math.copysign(left, r)))
    return np.array(share) / k


def solved(t: Array, law: BristleLaw) -> Array:
    """Return deflections by a solver that this package has no part in."""
    from scipy.integrate import solve_ivp

    def slope(time: float, z: Array) -> list[float]:
        now = float(motion(np.array([time]))[1][0])
        return [float(law.rates(now, 10.0, (float(z[0]),))[0])]

    # short steps, since it does not know where the motion turns
    return solve_ivp(
        slope, (0.0, t[-1]), [0.0], "LSODA", t_eval=t, rtol=1e-8, atol=1e-12, max_step=5e-3
    ).y[0]


def record_of(law: FrictionLaw, *, end: float = 12.0, rate: float = 500.0) -> Measurement:
    """Return friction of a law without noise, and an offset."""
    t = np.arange(0.0, end, 1.0 / rate)
    x, v = motion(t)
    load = 10.0 + 2.0 * np.sin(0.5 * t)
    if law.states:
        z = yielding(x, law) if isinstance(law, Dahl) else solved(t, law)
        force = law.force(v, load, (z,))
    else:
        force = law.force(v, load)  # type: ignore[attr-defined]
    offset = 0.0 if isinstance(law, DirectionDependent) else OFFSET
    return Measurement(time=t, position=x, velocity=v, friction=force + offset, load=load)


def strokes_and_rests(rate: float, noise: float) -> tuple[Array, Array, Array]:
    """Return times, noisy positions and velocities of strokes of 1 s with rests of 1 s between."""
    t = np.arange(0.0, 16.0, 1.0 / rate)
    v = np.where(np.floor(t) % 2, 0.0, 0.1 * np.sin(np.pi * t) * np.sign(np.sin(0.5 * np.pi * t)))
    v = np.where(np.floor(t / 4) % 2, -v, v)
    x = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) / rate)])
    return t, x + np.random.default_rng(1).normal(0.0, noise, len(t)), v


SLIDING = [name for name in TRUE if name not in ("dahl", "lugre")]


def values_of(found):
    """Return the values of a fit, by path."""
    return {one.path.removeprefix("mechanism."): one.value for one in found.estimates}


@pytest.mark.slow
@pytest.mark.parametrize("name", SLIDING)
def test_a_law_of_speed_alone_gives_its_parameters_back(name):
    record = record_of(TRUE[name], rate=200.0)
    found = stickslip.fit(AXIS, LAWS[name], record)
    assert {one.path for one in found.estimates} >= {f"friction.{x}" for x in LAWS[name].fit_order}
    for field in LAWS[name].fit_order:
        true, one = getattr(TRUE[name], field), found.estimate(field)
        # speeds up to the Stribeck velocity hardly tell a slope from a step: its interval says so
        assert one.value == pytest.approx(true, rel=0.02) or one.low <= true <= one.high, field


def test_a_table_without_time_is_compared_with_steady_friction():
    v = np.concatenate([-np.geomspace(1e-3, 0.3, 40), np.geomspace(1e-3, 0.3, 40)])
    truth = TRUE["stribeck"]
    table = Measurement(velocity=v, friction=truth.force(v, 10.0) + OFFSET, load=10.0)
    found = stickslip.fit(AXIS, Stribeck, table)
    assert found.verdict.route == "table"
    for name in ("kinetic_coefficient", "static_coefficient", "stribeck_velocity"):
        assert getattr(found.law, name) == pytest.approx(getattr(truth, name), rel=5e-3)
    assert found.estimate("offset").value == pytest.approx(OFFSET, rel=0.01)


def test_slip_in_one_direction_has_no_offset_of_its_own():
    v = np.geomspace(1e-3, 0.3, 40)
    record = Measurement(time=0.1 * np.arange(40.0), velocity=v, friction=2.0 + 8.0 * v)
    table = replace(record, time=None)
    found = stickslip.fit(AXIS, CoulombViscous, table)
    assert "offset" not in values_of(found)
    assert found.law.kinetic_coefficient == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize(
    ("record", "mechanism", "message"),
    [
        (
            Measurement(time=np.arange(20.0), friction=np.ones(20), name="run 3"),
            AXIS,
            r"needs position .* or velocity .* 'run 3' has friction",
        ),
        (
            Measurement(velocity=np.ones(4), friction=np.ones(4)),
            AXIS,
            "measure friction at more speeds",
        ),
        (
            Measurement(velocity=np.ones(20), friction=np.ones(20)),
            replace(AXIS, load=0.0),
            "a constant normal force above 0 N, and Axis has 0",
        ),
        (
            Measurement(velocity=np.ones(20), friction=np.ones(20), load=-5.0),
            AXIS,
            r"Measurement.load \(N\) of the record must be above 0 N, got −5",
        ),
        (
            Measurement(
                trials=(
                    Measurement(velocity=np.ones(20), friction=np.ones(20), load=5.0),
                    Measurement(velocity=np.ones(20), friction=np.ones(20)),
                )
            ),
            AXIS,
            "in only some of the trials",
        ),
    ],
)
def test_what_is_missing_is_said(record, mechanism, message):
    with pytest.raises(InputError, match=message):
        stickslip.fit(mechanism, Coulomb, record)


@pytest.fixture(scope="module")
def tribometer(data_dir: Path) -> Measurement:
    return load_measurement(
        data_dir / "reciprocating_tribometer/train.parquet",
        columns={"time": "t_s", "position": "x_m", "friction": "friction_N", "load": "normal_N"},
        gain={"friction": -1},
    )


def between(record: Measurement, first: float, last: float) -> Measurement:
    kept = (record.time >= first) & (record.time < last)
    return Measurement(
        **{name: getattr(record, name)[kept] for name in ("time", *record.quantities())}
    )


@pytest.mark.slow
def test_the_tribometer_record_is_predicted_better_than_published(tribometer):
    found = stickslip.fit(AXIS, Dahl, between(tribometer, 12.0, 75.0))
    late = between(tribometer, 75.0, 110.0)
    # published 11.6 % with Dahl's plain law; 4.8 % was reached by others; the bar is 5.5 %
    assert found.predict(late).error / np.sqrt(np.mean(late.friction**2)) < 0.055


@pytest.mark.slow
@pytest.mark.parametrize(("rate", "noise"), [(100.0, 0.0), (1000.0, 5e-6)])
def test_friction_at_rest_may_take_any_value_that_the_law_allows(rate, noise):
    # closed form: the table while it slips; at rest anything, here half of the level
    t, x, v = strokes_and_rests(rate, noise)
    friction = np.where(v == 0.0, 1.0, 2.0 * np.sign(v) + 14.0 * v)
    friction += np.random.default_rng(2).normal(0.0, 0.02, len(t))
    record = Measurement(time=t, position=x, friction=friction)
    found = stickslip.fit(AXIS, CoulombViscous, record)
    for name, true in (("kinetic_coefficient", 2.0), ("viscous_coefficient", 14.0)):
        estimate = found.estimate(name)
        # each is off by less than its interval, or by 1 % where noise hides the slowest slip
        assert abs(estimate.value - true) < max(estimate.high - estimate.value, 0.01 * true)


def test_a_table_may_have_rows_at_rest():
    v = np.concatenate([np.linspace(-1.0, 1.0, 40), np.zeros(20)])
    friction = 2.0 * np.sign(v) + v + np.where(v == 0.0, np.linspace(-1.9, 1.9, 60), 0.0)
    found = stickslip.fit(AXIS, CoulombViscous, Measurement(velocity=v, friction=friction))
    assert found.law.kinetic_coefficient == pytest.approx(2.0, abs=1e-3)
    assert found.law.viscous_coefficient == pytest.approx(1.0, abs=1e-3)


@pytest.mark.slow
def test_noise_of_positions_does_not_relax_bristles_at_rest():
    t, x, v = strokes_and_rests(1000.0, 5e-6)
    way = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) / 1000.0)])
    z = [0.0]
    for step in np.diff(way):  # closed form of Dahl's deflection along a displacement
        end = math.copysign(5e-3, step)
        z.append(end + (z[-1] - end) * math.exp(-abs(step) / 5e-3))
    friction = 4e2 * np.array(z) + np.random.default_rng(2).normal(0.0, 0.02, len(t))
    record = Measurement(time=t, position=x, friction=friction)
    found = stickslip.fit(AXIS, Dahl, record)
    assert found.law.kinetic_coefficient == pytest.approx(2.0, rel=0.01)
    assert found.law.bristle_stiffness == pytest.approx(4e2, rel=0.04)


@pytest.mark.parametrize(
    "law",
    [Dahl, LuGre, Dahl(kinetic_coefficient=0.4, bristle_stiffness=1e3)],
    ids=["dahl", "lugre", "an instance"],
)
def test_bristles_are_refused_where_friction_has_no_time(law):
    v = np.linspace(-1.0, 1.0, 40)
    table = Measurement(velocity=v, friction=2.0 * np.sign(v) + v)
    with pytest.raises(
        InputError, match=r"only in time|states that this measurement does not show"
    ):
        stickslip.fit(Axis(inertia=1.0), law, table)


def test_velocities_within_their_noise_have_no_direction():
    t = np.arange(0.0, 12.0, 0.01)
    v = 0.1 * np.sin(1.3 * t)
    random = np.random.default_rng(2)
    friction = 2.0 * np.sign(v) + 14.0 * v + random.normal(0.0, 0.04, len(t))
    noisy = v + random.normal(0.0, 0.002, len(t))
    record = Measurement(time=t, velocity=noisy, friction=friction)
    found = stickslip.fit(AXIS, CoulombViscous, record)
    assert found.law.kinetic_coefficient == pytest.approx(2.0, rel=0.01)


@pytest.mark.slow
def test_levels_at_speeds_that_the_record_never_reached_are_not_those_of_its_law(tribometer):
    # friction never exceeds 2.5 N; a level of 40 N at rest and of -2.5 N at the fastest speed,
    # which a bristle never reaches, fits the loops best
    record = between(tribometer, 12.0, 30.0)
    verdict = stickslip.select(AXIS, None, record)
    assert "Dahl" in verdict.closest.title
    level = next(one for one in verdict.parameters if one.path.endswith("kinetic_coefficient"))
    assert 0.4 < level.low < level.value < level.high < 0.5
    band = verdict.band(velocity=[-2.4e-4, 2.4e-4])
    assert np.all(np.abs(band.low) < 3.0)
    assert np.all(np.abs(band.high) < 3.0)
    assert np.all(band.low * [-1.0, 1.0] > 0.0)
