"""Sensitivities of a run: closed forms, and for all laws and mechanisms an independent solution."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.solver.sensitivity_support import PYTHON, Case, mismatch
from tests.mechanisms.test_pendulum_cart import LAW as CART_LAW
from tests.mechanisms.test_pendulum_cart import cart_with
from tests.support import FIRST, example_of, pairs, quick

from stickslip import (
    Axis,
    Coulomb,
    Dahl,
    EventDriven,
    FixedStep,
    PendulumCart,
    SpringBlock,
    TowedBlock,
    ensemble,
    simulate,
)
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.friction import LAWS, PRINTED_FORMS
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse, Sine, Square, ThreePhase
from stickslip.quantities import fields_of

PULSE = Pulse(level=6.0, duration=0.4, start=0.1)
SINE = Sine(amplitude=6.0, frequency=0.8, phase=0.3)
LINES = PiecewiseLinear(times=(0.0, 0.1, 0.6, 1.0), values=(1.0, 7.0, -6.0, 0.0))
DRIVES = {"pulse": PULSE, "sine": SINE, "lines": LINES, "sum": PULSE + SINE}
RIGS = {
    "towed-block": TowedBlock(mass=1.0, stiffness=40.0, speed=0.3, damping=0.2),
    "towed-block, load": TowedBlock(mass=1.0, stiffness=40.0, speed=0.3, load=8.0),
    "spring-block": SpringBlock(mass=1.0, stiffness=100.0, compression=0.1),
}
for name, drive in DRIVES.items():
    RIGS[f"spring-block, {name}"] = SpringBlock(
        mass=1.0, stiffness=30.0, compression=0.05, drive=drive, attached=True
    )
    RIGS[f"axis, {name}"] = Axis(
        inertia=2.0, drive=drive, stiffness=3.0, damping=0.2, load=4.0, offset=0.1
    )
RIGS["spring-block, uphill, square"] = SpringBlock(
    mass=1.0, stiffness=30.0, compression=0.05, attached=True, incline=0.1,
    drive=Square(high=6.0, low=-2.0, period=0.37, duty=0.4, start=0.02),
)  # fmt: skip
SMOOTH_LAWS = {name: example_of(LAWS[name]) for name in FIRST}
BRISTLE_LAWS = {n: law for n, law in SMOOTH_LAWS.items() if law.states == ("z",)}
SMOOTH_LAWS = {n: law for n, law in SMOOTH_LAWS.items() if not law.states}
SMOOTH_LAWS |= {
    f"stribeck {n}": replace(SMOOTH_LAWS["stribeck"], fading_exponent=n) for n in (1.0, 1.5)
}
BRISTLE_LAWS |= {
    f"{name}, switch": replace(law, static_switch=True) for name, law in BRISTLE_LAWS.items()
}
FEWER = {n: rig for n, rig in RIGS.items() if not n.endswith((", pulse", ", sine", ", load"))}
"""Each mechanism and each drive once more, for laws that take many steps."""
KINETIC = Coulomb(kinetic_coefficient=0.25)
G = 9.81
EXACT = 1e-12
"""Roundings of a few series, and of the moments of events, over the size of the derivative."""


def at(run, t, state, path):
    """Return one sensitivity at one time."""
    return float(run.at(t).sensitivity(state, path)[0])


# Laws and mechanisms against an independent solution of the variational equations.


@pytest.mark.parametrize(("rig", "law"), list(pairs(SMOOTH_LAWS, RIGS, 8)))
def test_every_sensitivity_is_that_of_the_variational_equations(rig, law):
    # steps of 1e-12 on both sides, through layers that enlarge them some thousand times; a broken
    # exponent has no Taylor series at v = 0, and collocation loses its order there
    exponents = [name for name, quantity in fields_of(type(law)).items() if quantity.structural]
    whole = all(float(getattr(law, name)).is_integer() for name in exponents)
    assert mismatch(Case(rig, law, 1.3, (0.01, 0.2))) <= (1e-8 if whole else 5e-7)


@pytest.mark.parametrize(("rig", "law"), list(pairs(BRISTLE_LAWS, FEWER)))
def test_sensitivities_of_bristle_laws_are_those_of_the_variational_equations(rig, law):
    # steps of 1e-8 in the run; the motion is off by some of them, and so is its derivative
    assert mismatch(Case(rig, law, 0.15, (0.01, 0.1, 0.0))) <= 1e-6


@pytest.mark.parametrize("name", quick(BRISTLE_LAWS, "dahl, switch"))
def test_sensitivities_of_bristle_laws_hold_across_reversals_stops_and_break_aways(name):
    drive = Sine(amplitude=12.0, frequency=3.0, phase=0.5)
    axis = Axis(inertia=1.0, drive=drive, load=10.0)
    case = Case(axis, BRISTLE_LAWS[name], 0.5, (0.0, 0.05, 0.0))
    assert len(case.run().events) >= 2
    assert mismatch(case) <= 1e-5  # as above; events follow each other through still bristles


@pytest.mark.slow  # the default tolerance is tested above
@pytest.mark.parametrize("largest", [1e-5, pytest.param(1e-6, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", quick(["dahl", "lugre"], "dahl"))
def test_the_error_of_sensitivities_of_bristle_laws_falls_with_the_tolerance(name, largest):
    case = Case(RIGS["towed-block"], BRISTLE_LAWS[name], 0.1, (0.01, 0.1, 0.0))
    errors = [
        mismatch(case, EventDriven(tier="python", stiff_tolerance=tol))
        for tol in (largest, 1e-2 * largest, 1e-4 * largest)
    ]
    assert errors[1] <= largest  # a hundred tolerances
    assert errors[2] <= 0.1 * errors[1] <= 0.01 * errors[0]  # 1e-2 each, not all of it reached


# Closed forms.


def test_a_sliding_block_comes_to_rest_where_its_closed_form_says_and_so_do_its_derivatives():
    v, mu = 2.0, 0.25
    run = simulate(SpringBlock(mass=3.0), KINETIC, t_end=5.0, y0={"x": 0.3, "v": v}, solver=PYTHON)
    expected = {
        "initial.v": v / (mu * G),  # x = x_0 + v^2 / (2 mu g)
        "kinetic_coefficient": -(v**2) / (2 * mu**2 * G),
        "gravity": -(v**2) / (2 * mu * G**2),
        "initial.x": 1.0,
    }
    for path, known in expected.items():
        assert math.isclose(at(run, 5.0, "x", path), known, rel_tol=EXACT)
        assert abs(at(run, 5.0, "v", path)) <= 1e-15  # at rest: slope and jump cancel
    # masses cancel; what rounding leaves is that of the terms that do
    assert abs(at(run, 5.0, "x", "mass")) <= EXACT


def test_while_a_block_slides_its_derivatives_grow_with_time():
    run = simulate(SpringBlock(mass=3.0), KINETIC, t_end=0.5, y0={"v": 2.0}, solver=PYTHON)
    t = np.array([0.0, 0.1, 0.37, 0.5])
    close = {"rtol": EXACT, "atol": 1e-15}
    mu = run.at(t)
    np.testing.assert_allclose(mu.sensitivity("x", "kinetic_coefficient"), -G * t**2 / 2, **close)
    np.testing.assert_allclose(mu.sensitivity("v", "kinetic_coefficient"), -G * t, **close)
    np.testing.assert_allclose(mu.sensitivity("x", "initial.v"), t, **close)
    np.testing.assert_array_equal(mu.sensitivity("v", "initial.v"), np.ones(4))


def test_a_swing_between_reversals_has_the_derivatives_of_its_cosine():
    k, m, a, f = 100.0, 2.0, 0.3, 1.5
    run = simulate(
        Axis(inertia=m, stiffness=k), Coulomb(kinetic_coefficient=f), t_end=2.0, y0={"x": a},
        solver=PYTHON,
    )  # fmt: skip
    w = math.sqrt(k / m)
    for t in (0.3, 0.9, 1.3):  # in the first, the third, the last half swing
        n = int(w * t / math.pi)
        side, amplitude = (-1) ** n, a - (2 * n + 1) * f / k
        cos, sin = math.cos(w * t), math.sin(w * t)
        # backward at first: x = f / k (-1)^n + (a - (2 n + 1) f / k) cos(w t)
        by_f = side / k - (2 * n + 1) / k * cos
        by_w = -amplitude * t * sin
        by_k = -f / k * by_f + by_w * w / (2 * k)
        by_m = -by_w * w / (2 * m)
        for path, known in {
            "friction.kinetic_coefficient": by_f,
            "initial.x": cos,
            "stiffness": by_k,
            "inertia": by_m,
        }.items():
            # of the terms that make it up: some phase, times the rounding of the time
            assert abs(at(run, t, "x", path) - known) <= EXACT * 30 * (abs(known) + 1 / k)


def test_a_pulse_has_the_derivatives_of_the_travel_it_gives():
    level, duration, start, f, m = 5.0, 0.8, 0.3, 1.0, 2.0
    drive = Pulse(level=level, duration=duration, start=start)
    axis, law = Axis(inertia=m, drive=drive), Coulomb(kinetic_coefficient=f)
    run = simulate(axis, law, t_end=10.0, solver=PYTHON)
    # x = F (F - f) T^2 / (2 m f)
    expected = {
        "level": (2 * level - f) * duration**2 / (2 * m * f),
        "duration": level * (level - f) * duration / (m * f),
        "friction.kinetic_coefficient": -(level**2) * duration**2 / (2 * m * f**2),
        "inertia": -level * (level - f) * duration**2 / (2 * m**2 * f),
    }
    for path, known in expected.items():
        assert math.isclose(at(run, 10.0, "x", path), known, rel_tol=EXACT)
    assert abs(at(run, 10.0, "x", "start")) <= EXACT * 10  # a later start moves all, not the end
    during = (level - f) / m * 0.5  # dx/dt half a second into the pulse
    assert math.isclose(at(run, start + 0.5, "x", "start"), -during, rel_tol=EXACT)
    assert at(run, 0.2, "x", "start") == 0.0


def test_the_travel_of_a_towed_block_has_the_derivatives_of_its_stick_slip_period():
    m, k, speed, mu_k, mu_s = 1.0, 2.0, 0.1, 1.0, 1.5
    block = TowedBlock(mass=m, stiffness=k, speed=speed, load=1.0)
    law = Coulomb(kinetic_coefficient=mu_k, static_coefficient=mu_s)
    run = simulate(block, law, t_end=40.0, solver=PYTHON)
    stops = [event.t for event in run.events if event.reason == "stop"]
    assert len(stops) >= 3
    # at the n-th stop x = (2 n - 1) mu_s / k ... : each slip carries it 2 ((mu_s - mu_k) / k
    # + V (pi - arctan(q)) / w ... ), and a held block is where the slip of that number left it
    w = math.sqrt(k / m)
    lag = (mu_s - mu_k) / k
    slip = 2 * (math.pi - math.atan(lag * w / speed)) / w  # time of a slip
    for n, t in enumerate(stops[:3], 1):
        # spring at break-away mu_s, at the stop 2 mu_k - mu_s: the same force change each slip
        travel = 2 * lag + speed * slip
        held = t + 1.0
        run_at = run.at(held)
        assert math.isclose(run_at["x"][0], n * travel, rel_tol=1e-11)
        q = lag * w / speed
        by_lag = 2 - 2 / (1 + q * q)
        assert math.isclose(
            at(run, held, "x", "static_coefficient"), n * by_lag / k, rel_tol=1e-11
        )  # three slips' events, located to rounding of a time of some tens
        assert math.isclose(
            at(run, held, "x", "speed"), n * (slip + 2 * q / (1 + q * q) / w), rel_tol=1e-11
        )


# At rest, at events and at the start.


def test_a_held_body_depends_on_nothing_else_that_happens():
    drive = Sine(amplitude=0.1, frequency=1.0)
    run = simulate(Axis(inertia=1.0, drive=drive), KINETIC, t_end=3.0, solver=PYTHON)
    for path in ("amplitude", "frequency", "phase", "kinetic_coefficient", "inertia"):
        assert np.all(run.sensitivity("x", path) == 0.0)


def test_at_an_event_the_sensitivity_is_that_after_it():
    run = simulate(SpringBlock(mass=1.0), KINETIC, t_end=3.0, y0={"v": 1.0}, solver=PYTHON)
    (stop,) = [event.t for event in run.events]
    just_before = math.nextafter(stop, 0.0)
    mu = "kinetic_coefficient"
    assert at(run, stop, "v", mu) == 0.0
    assert math.isclose(at(run, just_before, "v", mu), -G * stop, rel_tol=EXACT)
    # the position has no jump: its velocity is 0 on both sides
    assert math.isclose(at(run, stop, "x", mu), at(run, just_before, "x", mu), rel_tol=EXACT)


def test_two_coordinates_have_sensitivities_as_well():
    cart = cart_with(
        cart_mass=2.0, ball_mass=0.5, length=0.4, torque=0.3, pivot_height=0.1, centre_height=0.1,
        pivot_stiffness=0.3, pivot_damping=0.02,
    )  # fmt: skip
    case = Case(cart, CART_LAW, 1.2, (0.0, 0.3, 1.0, 0.5))
    run = case.run()
    assert len(run.events) >= 2
    t = np.array([0.05, 0.4, 0.8, 1.2])
    tight = EventDriven(tolerance=1e-13)
    found = case.sensitivities(t)
    for c, (path, size) in enumerate(case.sizes().items()):
        value = case.paths()[path]
        if path == "mechanism.restitution":  # of no stop, and at its bound
            assert not found[:, :, c].any()
            continue

        def moved(by, path=path, value=value):
            there = case.run(tight, {path: value + by}).at(t)
            return np.column_stack([there[state] for state in case.states()])

        wide, narrow = ((moved(h * size) - moved(-h * size)) / (2 * h) for h in (2e-3, 1e-3))
        known = (4 * narrow - wide) / 3
        # noise of 1e-13 and more a step over 1e-3, and 1e-12 of what is beyond extrapolation
        assert np.abs(found[:, :, c] - known).max() <= 1e-6 * (1 + np.abs(known).max())


# Tiers, and what is refused.


def test_unknown_states_and_parameters_are_refused_with_the_nearest_names():
    run = simulate(RIGS["axis, sum"], SMOOTH_LAWS["stribeck"], t_end=0.1, solver=PYTHON)
    with pytest.raises(UnknownNameError, match=r"unknown state 'y'.*Known: v, x"):
        run.sensitivity("y", "inertia")
    with pytest.raises(UnknownNameError, match="unknown state 'friction'"):
        run.sensitivity("friction", "inertia")
    with pytest.raises(UnknownNameError, match=r"Did you mean 'friction\.kinetic_coefficient'"):
        run.sensitivity("x", "friction.kinetic_coeficient")
    with pytest.raises(ParameterError, match=r"fading_exponent \(n\) is a whole number, which"):
        run.sensitivity("x", "fading_exponent")
    run = simulate(RIGS["axis, sum"], KINETIC, t_end=0.1, solver=PYTHON)
    with pytest.raises(ParameterError, match=r"static_coefficient \(mu_s\) was not given"):
        run.sensitivity("x", "mu_s")


def test_a_symbol_stands_for_the_name_of_its_parameter():
    run = simulate(RIGS["axis, sum"], SMOOTH_LAWS["stribeck"], t_end=0.1, solver=PYTHON)
    for symbol, name in (("mu_k", "kinetic_coefficient"), ("friction.v_s", "stribeck_velocity")):
        np.testing.assert_array_equal(run.sensitivity("x", symbol), run.sensitivity("x", name))
    levels = np.array([0.2, 0.3])
    by_symbol = ensemble(RIGS["axis, sum"], KINETIC, {"mu_k": levels}, t_end=0.1)
    assert list(by_symbol.parameters) == ["friction.kinetic_coefficient"]


def test_next_to_a_whole_exponent_its_sensitivity_is_that_of_differences():
    rig = Axis(inertia=1.0, drive=Sine(amplitude=3.0, frequency=2.0))
    law = Dahl(kinetic_coefficient=1.0, bristle_stiffness=1e3, yield_exponent=1.000001)
    above, below = (replace(law, yield_exponent=1.0 + s * 1e-4) for s in (1.0, -1.0))
    ends = [simulate(rig, one, t_end=0.3, solver=PYTHON)["x"][-1] for one in (above, below)]
    run = simulate(rig, law, t_end=0.3, solver=PYTHON)
    found = run.sensitivity("x", "yield_exponent")[-1]
    assert found == pytest.approx((ends[0] - ends[1]) / 2e-4, rel=1e-3)


def test_a_last_name_that_two_parameters_have_is_refused_with_both():
    rig = Axis(inertia=1.0, drive=Pulse(level=2.0, duration=0.1) + PULSE)
    run = simulate(rig, KINETIC, t_end=0.5, solver=PYTHON)
    with pytest.raises(UnknownNameError, match=r"parts\.0\.level, .*parts\.1\.level"):
        run.sensitivity("x", "level")


@pytest.mark.parametrize("law", [KINETIC, PRINTED_FORMS["printed-1"](kinetic_coefficient=0.2)])
def test_fixed_steps_have_no_sensitivities_and_say_what_has(law):
    run = simulate(SpringBlock(mass=1.0), law, t_end=0.1, y0={"v": 1.0}, solver=FixedStep(dt=0.01))
    with pytest.raises(InputError, match=r"run it with solver=EventDriven\(\)"):
        run.sensitivity("x", "kinetic_coefficient")


@pytest.mark.parametrize("fast", [100.0, 150.0])
def test_switching_times_that_round_otherwise_in_complex_numbers_move_too(fast):
    # the first switch, sqrt(4 a / (1/A1 + 1/A2)) / A1, differs in its last digit for A1 = 150
    def cart(slow):
        swing = ThreePhase(amplitude=0.7, fast=fast, slow=slow)
        return PendulumCart(
            cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
        )

    def place(slow, t):
        return simulate(cart(slow), law, t_end=0.2).at([t])["x"][0]

    law, h = Coulomb(kinetic_coefficient=0.2), 1e-4
    t = cart(30.0).pendulum.profile.peak_rate / fast + 0.02
    found = simulate(cart(30.0), law, t_end=0.2).at([t]).sensitivity("x", "slow")[0]
    known = (place(30.0 + h, t) - place(30.0 - h, t)) / (2 * h)
    # differences of places of 1e-2 m known to 1e-15 over 2e-4
    assert found == pytest.approx(known, abs=1e-10)
    assert found > 1e-6
