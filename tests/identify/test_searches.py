"""Searches that find: grids over decades, starts from simpler laws, routes from the record."""

import numpy as np
import pytest

from stickslip import (
    Axis,
    CoulombViscous,
    LuGre,
    Measurement,
    Stribeck,
    fit,
)
from stickslip.engine.solver import EventDriven
from stickslip.study.control import closed_loop

SOLVER = EventDriven(tier="compiled", max_steps=1_000_000)


def controlled(law, *, seed, offset=0.0, duration=12.0):
    """Return a record of an axis of 3 kg that follows slow and fast moves; encoder 1 um."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, duration, 1e-3)
    corners, speeds, side = [0.0], [0.0], 1.0
    while corners[-1] < t[-1]:
        peak = side * 10.0 ** random.uniform(-3.0, -0.7)
        for stretch, speed in ((0.15, peak), (0.4, peak), (0.15, 0.0), (0.05, 0.0)):
            corners.append(corners[-1] + stretch)
            speeds.append(speed)
        side = -side
    v = np.interp(t, corners, speeds)
    x = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * 1e-3)])
    a = np.gradient(v, t)

    def control(now, seen):
        k = min(round(now * 1e3), len(t) - 1)
        return 3.0 * (a[k] + 1600.0 * (x[k] - seen["x"]) + 56.0 * (v[k] - seen["v"]))

    axis = Axis(inertia=3.0, offset=offset)
    loop = closed_loop(
        axis, law, control, period=1e-3, t_end=float(t[-1]), quantisation={"x": 1e-6}, solver=SOLVER
    )
    position = 1e-6 * np.round(np.asarray(loop.run.at(loop.t)["x"]) / 1e-6)
    force = loop.commands + 0.02 * random.standard_normal(len(loop.commands))
    return Measurement(time=loop.t, position=position, force=force)


LUGRE = LuGre(
    kinetic_coefficient=18.0,
    static_coefficient=26.0,
    stribeck_velocity=8e-3,
    bristle_stiffness=2.5e5,
    bristle_damping=600.0,
    viscous_coefficient=12.0,
)


@pytest.fixture(scope="module")
def lugre_record():
    return controlled(LUGRE, seed=5, offset=1.0)


@pytest.mark.slow
def test_all_eight_parameters_of_lugre_are_found_from_no_start_values(lugre_record):
    found = fit(Axis(inertia=4.0), LuGre, lugre_record, vary=["friction.*", "mechanism.inertia"])
    assert found.route == "balance"
    truth = {f"friction.{name}": getattr(LUGRE, name) for name in LuGre.fit_order}
    truth |= {"offset": 1.0, "mechanism.inertia": 3.0}
    for path, value in truth.items():
        estimate = found.estimate(path)
        # twice the half width of a 95 % interval: one miss in 10,000 of a normal estimate
        middle, half = 0.5 * (estimate.low + estimate.high), estimate.high - estimate.low
        assert abs(value - middle) < half, path
    assert found.estimate("stribeck_velocity").value == pytest.approx(8e-3, rel=0.2)


@pytest.mark.parametrize("v_s", [2e-3, 2e-2, 0.2])
def test_a_stribeck_velocity_is_found_over_two_decades(v_s):
    # friction against velocity with noise of 1 % of the level
    random = np.random.default_rng(11)
    v = np.linspace(-1.0, 1.0, 4001)
    law = Stribeck(
        kinetic_coefficient=18.0,
        static_coefficient=26.0,
        stribeck_velocity=v_s,
        viscous_coefficient=5.0,
    )
    table = Measurement(velocity=v, friction=law.force(v, 1.0) + 0.18 * random.normal(size=4001))
    found = fit(Axis(inertia=1.0), Stribeck, table)
    assert found.estimate("stribeck_velocity").value == pytest.approx(v_s, rel=0.25)


def test_an_exponent_outside_the_order_of_fits_is_fitted_where_it_is_named():
    v = np.linspace(-1.0, 1.0, 2001)
    law = Stribeck(
        kinetic_coefficient=18.0,
        static_coefficient=26.0,
        stribeck_velocity=0.05,
        fading_exponent=1.0,
    )
    friction = law.force(v, 1.0) + 0.05 * np.random.default_rng(2).normal(size=2001)
    table = Measurement(velocity=v, friction=friction)
    free = [*Stribeck.fit_order, "fading_exponent"]
    found = fit(Axis(inertia=1.0), Stribeck, table, vary=free)
    # noise of .05 N on a surplus of 8 N over a hundred rows
    assert found.estimate("fading_exponent").value == pytest.approx(1.0, abs=0.1)


def test_positions_that_rest_between_steps_of_an_encoder_have_the_noise_of_rounding():
    record = controlled(LUGRE, seed=6, duration=4.0)
    coarse = 2e-5 * np.round(np.asarray(record.values("position")) / 2e-5)
    still = Measurement(time=record.time, position=coarse, force=record.force)
    found = fit(
        Axis(inertia=3.0),
        CoulombViscous,
        still,
        route="balance",
        vary=["friction.*", "mechanism.inertia"],
    )
    level = found.estimate("kinetic_coefficient")
    assert level.low < 18.0 < level.high
