"""The block diagram with a fixed step: what it does wrong, and what it converges to."""

import itertools
import math

import numpy as np
import pytest
from tests.support import UNAIDED, example_of

from stickslip import Axis, Coulomb, Dahl, FixedStep, PendulumCart, SpringBlock, Stribeck, simulate
from stickslip.engine import Status
from stickslip.errors import InputError, ParameterError, SimulationError
from stickslip.friction import PRINTED_FORMS
from stickslip.friction.published import PrintedCoulomb
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import Pulse, ThreePhase
from stickslip.quantities import fields_of

LAW = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
RELEASED = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
PUSHED = SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))
TYPICAL = {"N": 9.81, "1": 0.25, "m/s": 0.01, "N/m": 1e3, "N s/m": 0.4}


def printed(kind):
    values = {name: TYPICAL[quantity.unit] for name, quantity in fields_of(kind).items()}
    return kind(**values)


def test_coulomb_friction_without_the_stick_rule_chatters_about_rest():
    dt = 0.01
    run = simulate(PUSHED, LAW, t_end=2.0, solver=FixedStep(dt=dt, stick_rule=False))
    late = run["v"][run.t > 1.0]
    assert late.min() < 0 < late.max()
    # friction changes the velocity by dt F / m a step, and no more is ever left
    assert np.abs(late).max() <= dt * 0.25 * 9.81 * (1 + 1e-12)


def test_a_fixed_step_finds_a_negative_velocity_where_there_is_none():
    solver = FixedStep(dt=0.01, stick_rule=False)
    assert simulate(RELEASED, LAW, t_end=2.0, solver=solver)["v"].min() < -1e-3
    assert simulate(RELEASED, LAW, t_end=2.0)["v"].min() >= 0


def test_the_stick_rule_holds_the_body_where_it_stopped():
    run = simulate(RELEASED, LAW, t_end=2.0, solver=FixedStep(dt=0.001))
    held = run["mode"] == 0
    assert held[-1]
    assert np.all(run["v"] >= 0)
    first = int(np.argmax(held & (run.t > 0.1)))
    assert np.all(run["x"][first:] == run["x"][first])


def test_the_stick_rule_lets_go_when_the_drive_exceeds_break_away():
    axis = Axis(inertia=1.0, drive=Pulse(level=2.0, duration=1.0, start=0.5))
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    run = simulate(axis, law, t_end=3.0, solver=FixedStep(dt=0.001))
    assert np.all(run["x"][run.t <= 0.5] == 0)
    assert math.isclose(run["x"][-1], 1.0, rel_tol=5e-3)  # two or three steps of 1e-3


@pytest.mark.parametrize("method", ["euler", "heun", "rk4"])
def test_travel_converges_to_the_exact_one_with_the_first_order(method):
    exact = 0.1**2 * 100.0 / (2 * 0.25 * 9.81)
    steps = np.array([0.008, 0.004, 0.002, 0.001, 0.0005])
    errors = np.array(
        [
            abs(
                simulate(RELEASED, LAW, t_end=1.0, solver=FixedStep(dt=dt, method=method))["x"][-1]
                - exact
            )
            for dt in steps
        ]
    )
    # release and stop fall anywhere within a step: a few steps' way at some 0.8 m/s, scattered
    assert np.all(errors <= 4 * 0.8 * steps)
    assert errors[-1] < errors.max() / 3


@pytest.mark.parametrize(
    ("method", "order", "dt"), [("euler", 1, 1e-3), ("heun", 2, 1e-2), ("rk4", 4, 2e-2)]
)
def test_smooth_motion_converges_with_the_order_of_the_method(method, order, dt):
    axis = Axis(inertia=1.0, stiffness=4.0)
    law = Coulomb(kinetic_coefficient=0.0)
    exact = math.cos(2.0) + 0.25 * math.sin(2.0)
    errors = []
    for step in (dt, dt / 2):
        solver = FixedStep(dt=step, method=method, stick_rule=False)
        run = simulate(axis, law, t_end=1.0, y0={"x": 1.0, "v": 0.5}, solver=solver)
        errors.append(abs(run["x"][-1] - exact))
    # the next term of the error is a few steps' size of the first
    assert math.isclose(math.log2(errors[0] / errors[1]), order, abs_tol=0.1)


# of a reset integrator, the force jumps where its deflection reaches the end: first order there too
STEPPED = [kind for kind in UNAIDED.values() if kind.name != "haessig-friedland"]


@pytest.mark.parametrize("kind", STEPPED, ids=lambda kind: kind.name)
def test_every_law_runs_and_ends_near_the_exact_run(kind):
    law = example_of(kind)
    exact = simulate(RELEASED, law, t_end=0.4)
    run = simulate(RELEASED, law, t_end=0.4, solver=FixedStep(dt=1e-4, method="heun"))
    # a thousand steps of first order at the events, 1e-4 each of some metres per second
    assert math.isclose(run["x"][-1], exact["x"][-1], rel_tol=5e-3)


def test_a_form_that_holds_without_limit_never_starts():
    form = printed(PRINTED_FORMS["printed-7"])
    axis = Axis(inertia=1.0, drive=Pulse(level=1e6, duration=10.0))
    run = simulate(axis, form, t_end=1.0, solver=FixedStep(dt=0.01))
    assert np.all(run["x"] == 0)


def test_equation_3_drives_a_body_that_moves_backwards_on():
    form = printed(PRINTED_FORMS["printed-3"])
    solver = FixedStep(dt=0.01, stick_rule=False)
    run = simulate(Axis(inertia=1.0), form, t_end=1.0, y0={"v": -0.1}, solver=solver)
    assert run["v"][-1] < -0.1


def test_equation_5_holds_below_its_static_level_and_starts_above():
    form = printed(PRINTED_FORMS["printed-5"])
    for level, moves in ((0.9, False), (1.1, True)):
        drive = Pulse(level=level * form.static_coefficient, duration=1.0)
        run = simulate(Axis(inertia=1.0, drive=drive), form, t_end=1.0, solver=FixedStep(dt=1e-3))
        assert (run["x"][-1] > 0) == moves


def test_a_form_that_grows_beyond_all_numbers_ends_with_a_status():
    form = PRINTED_FORMS["printed-5"](
        kinetic_coefficient=0.25, static_coefficient=0.35, stribeck_velocity=0.01
    )
    axis = Axis(inertia=1.0)
    solver = FixedStep(dt=0.01, stick_rule=False)
    run = simulate(axis, form, t_end=10.0, y0={"v": -1.0}, solver=solver, throw=False)
    assert run.status is Status.NOT_FINITE
    with pytest.raises(SimulationError, match="The state diverged"):
        simulate(axis, form, t_end=10.0, y0={"v": -1.0}, solver=solver)


@pytest.mark.parametrize("dt", [0.01, 0.001])
def test_bristles_that_grow_to_no_number_at_all_end_with_a_status(dt):
    # infinities of both signs meet: the sum is no error of arithmetic, but no number either
    law = Dahl.from_forces(load=9.81, kinetic_force=2.5, bristle_stiffness=1e5)
    run = simulate(RELEASED, law, t_end=1.0, solver=FixedStep(dt=dt), throw=False)
    assert run.status is Status.NOT_FINITE
    assert np.all(np.isfinite(run["x"]))


def test_a_fixed_step_is_never_certified_and_says_what_it_cost():
    run = simulate(RELEASED, LAW, t_end=1.0, solver=FixedStep(dt=0.01))
    assert not run.certificate.certified
    assert "fixed step" in run.certificate.problems[0]
    finer = simulate(RELEASED, LAW, t_end=1.0, solver=FixedStep(dt=0.0005))
    assert finer.certificate.energy_error < run.certificate.energy_error
    assert run.certificate.steps == 100


@pytest.mark.parametrize("method", ["euler", "heun", "rk4"])
def test_a_guided_coordinate_is_where_its_profile_says(method):
    swing = ThreePhase(amplitude=0.7, fast=120.0, slow=30.0)
    cart = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    )
    solver = FixedStep(dt=0.01, method=method)
    run = simulate(cart, LAW, t_end=2.0, solver=solver)
    np.testing.assert_array_equal(run["theta"], [swing.at(t)[0] for t in run.t])
    # another start moves all of it: by what is ahead, and by what the rate adds in time
    start = {"theta": -0.6, "omega": 0.25}
    other = simulate(cart, LAW, t_end=2.0, y0=start, solver=solver)
    # rounding of angles of some 1 rad
    np.testing.assert_allclose(other["theta"] - run["theta"], 0.1 + 0.25 * run.t, atol=1e-13)
    np.testing.assert_allclose(other["omega"] - run["omega"], 0.25, atol=1e-13)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"dt": 0.0}, r"FixedStep\.dt \(dt\) must be above 0 s, got 0"),
        ({"dt": -1.0}, r"FixedStep\.dt"),
        ({"dt": math.nan}, r"FixedStep\.dt"),
        ({"dt": 0.1, "method": "rk5"}, "must be one of euler, semi-implicit, heun, rk4, got 'rk5'"),
    ],
)
def test_bad_settings_are_refused_in_words(settings, words):
    with pytest.raises(ParameterError, match=words):
        FixedStep(**settings)


def test_a_step_longer_than_the_run_is_refused():
    with pytest.raises(ParameterError, match="dt"):
        simulate(RELEASED, LAW, t_end=1.0, solver=FixedStep(dt=2.0))


def test_a_complete_run_covers_all_the_time_asked_for_whatever_the_step():
    run = simulate(RELEASED, LAW, t_end=1.0, solver=FixedStep(dt=0.3))
    assert run.status.complete
    assert run.span == (0.0, 1.0)


def test_a_bristle_law_is_held_only_with_its_static_switch():
    held, free = (
        simulate(
            SpringBlock(mass=1.0, drive=Pulse(level=1.0, duration=10.0)),
            Dahl(kinetic_coefficient=0.25, bristle_stiffness=1e3, static_switch=switch),
            t_end=0.1,
            solver=FixedStep(dt=1e-4),
        )
        for switch in (True, False)
    )
    assert np.abs(held["x"]).max() == 0
    assert np.abs(free["x"]).max() > 0


def test_more_steps_than_memory_holds_are_refused():
    with pytest.raises(ParameterError, match="at least 1 × 10⁻⁷ s"):
        simulate(RELEASED, LAW, t_end=1.0, solver=FixedStep(dt=1e-9))


@pytest.mark.parametrize(
    ("break_away", "level"), [("zero", 0.0), ("kinetic", 0.25), ("static", 0.35)]
)
@pytest.mark.parametrize("rule", [True, False], ids=["stick rule", "none"])
@pytest.mark.parametrize("force", [10.0, -10.0])
def test_the_first_step_out_of_rest_has_the_friction_that_was_chosen(
    break_away, level, rule, force
):
    block = SpringBlock(mass=1.0, drive=Pulse(level=force, duration=1.0))
    solver = FixedStep(dt=0.01, stick_rule=rule, break_away=break_away)
    run = simulate(block, LAW, t_end=0.02, solver=solver)
    levels = np.array([level, 0.25]) * 9.81  # from the second step on it slides
    expected = math.copysign(1.0, force) * np.cumsum((10.0 - levels) * 0.01)
    np.testing.assert_allclose(run["v"][1:], expected, rtol=1e-12)


def test_a_body_at_rest_that_is_not_exceeded_stays_but_where_sgn_0_is_0():
    for break_away, block in itertools.product(
        ("zero", "kinetic", "static"),
        (
            SpringBlock(mass=1.0, drive=Pulse(level=3.0, duration=1.0)),
            SpringBlock(mass=0.7, incline=0.3),  # forces that leave roundings
        ),
    ):
        solver = FixedStep(dt=0.01, stick_rule=False, break_away=break_away)
        run = simulate(block, LAW, t_end=0.1, solver=solver)
        assert bool(run["x"][-1] == 0.0) is (break_away != "zero")


def test_the_sliding_level_out_of_rest_is_where_a_stribeck_curve_begins():
    law = Stribeck(kinetic_coefficient=0.25, static_coefficient=0.35, stribeck_velocity=0.01)
    runs = [
        simulate(PUSHED, law, t_end=0.05, solver=FixedStep(dt=0.01, break_away=name))
        for name in ("kinetic", "static")
    ]
    np.testing.assert_allclose(runs[0]["v"], runs[1]["v"], rtol=1e-12)


@pytest.mark.parametrize("name", ["printed-1", "printed-3", "printed-5"])
def test_printed_forms_have_no_stick_rule_unless_it_is_asked_for(name):
    form, start = printed(PRINTED_FORMS[name]), {"t_end": 0.05, "y0": {"v": 0.01}}
    plain, free, held = (
        simulate(SpringBlock(mass=1.0), form, solver=FixedStep(dt=0.01, stick_rule=rule), **start)
        for rule in (None, False, True)
    )
    np.testing.assert_array_equal(plain["x"], free["x"])
    assert held["v"][-1] == 0.0 > plain["v"].min()


def karnopp(band, dt, t_end):
    """Return travel and speeds of the pushed block by Karnopp's rule, written out (Euler)."""
    f_k, f_s, x, v, speeds = 0.25 * 9.81, 0.35 * 9.81, 0.0, 0.0, []
    for i in range(round(t_end / dt)):
        force = 10.0 if i < round(0.1 / dt) else 0.0
        held = abs(v) <= band and abs(force) <= f_s
        v = 0.0 if held else v
        level = f_k if v else min(f_s, abs(force))
        friction = force if held else math.copysign(level, v or force)
        x, v = x + dt * v, v + dt * (force - friction)
        speeds.append(v)
    return x, speeds


@pytest.mark.parametrize(("band", "rests"), [(0.03, True), (0.001, False)])
def test_a_zero_velocity_band_holds_the_body_only_if_a_step_cannot_jump_over_it(band, rests):
    """A step changes the velocity by F dt / m = 25 mm/s here: the band has to be as wide."""
    dt = 0.01
    solver = FixedStep(dt=dt, stick_rule=False, zero_velocity_band=band)
    run = simulate(PUSHED, LAW, t_end=2.0, solver=solver)
    travel, _ = karnopp(band, dt, 2.0)
    # the same operations in another order, 200 of them
    assert run["x"][-1] == pytest.approx(travel, rel=1e-12)
    assert bool(run["mode"][-1] == 0) is rests
    assert bool(run["v"][-1] == 0) is rests


def test_a_body_within_the_zero_velocity_band_is_held_from_the_start():
    solver = FixedStep(dt=0.01, stick_rule=False, zero_velocity_band=0.02)
    block = SpringBlock(mass=1.0)
    slow, fast = (simulate(block, LAW, t_end=0.1, y0={"v": v}, solver=solver) for v in (0.01, 0.5))
    assert np.all(slow["x"] == 0.0)
    assert fast["x"][-1] > 0.0


def test_a_friction_out_of_rest_that_is_not_known_is_refused():
    with pytest.raises(ParameterError, match=r"FixedStep.break_away must be one of zero, kinetic,"):
        FixedStep(dt=0.01, break_away="none")


def test_a_negative_zero_velocity_band_is_refused():
    with pytest.raises(ParameterError, match=r"zero_velocity_band \(D_v\) must be at least 0 m/s"):
        FixedStep(dt=0.01, zero_velocity_band=-1.0)


@pytest.mark.parametrize("break_away", ["static", "zero"])
@pytest.mark.parametrize(
    ("law", "why"),
    [
        (Dahl(kinetic_coefficient=0.25, bristle_stiffness=1e3), "the bristles of dahl carry"),
        (PrintedCoulomb(kinetic_coefficient=0.25), "an equation as printed, has its own"),
    ],
    ids=["bristles", "printed"],
)
def test_a_friction_out_of_rest_is_refused_where_it_has_no_effect(law, why, break_away):
    simulate(PUSHED, law, t_end=0.05, solver=FixedStep(dt=0.01))
    with pytest.raises(InputError, match=f"FixedStep.break_away .*{why}.*leave it out"):
        simulate(PUSHED, law, t_end=0.05, solver=FixedStep(dt=0.01, break_away=break_away))
