"""Memories of several elements, and such that a latched switch leaves by another rule than it came.

Each is compared with an integration written here, which knows nothing of the package.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.pair_cases import PUSH, Pair, axis

from stickslip import EventDriven, FixedStep, ensemble, simulate
from stickslip.drives import Sine
from stickslip.errors import InputError
from stickslip.friction import law
from stickslip.maths import Latches, latched

CURVE = {
    "kinetic_coefficient": 1.0,
    "static_coefficient": 1.5,
    "stribeck_velocity": 0.05,
    "fading_exponent": 2.0,
}
STIFF, VISCOUS = {"bristle_stiffness": 1e4}, {"viscous_coefficient": 0.4}
GMS = law("gms[4](level + stribeck) + viscous")(**CURVE, **STIFF, **VISCOUS, attraction=100.0)
LEVEL_GMS = law("gms[4](level) + viscous")(
    kinetic_coefficient=1.0, **STIFF, **VISCOUS, attraction=100.0
)
MAXWELL = law("maxwell[4](level + stribeck) + viscous")(**CURVE, **STIFF, **VISCOUS)
RESET = law("reset(level + stribeck) + viscous")(
    **CURVE, **STIFF, **VISCOUS, bristle_damping=30.0, sticking_surplus=0.2
)
LATCHED = {"gms": GMS, "gms of one level": LEVEL_GMS}
SWITCHED = {**LATCHED, "maxwell": MAXWELL, "reset": RESET}
RIG = axis(Sine(amplitude=3.0, frequency=0.5))


def level(v):
    return 1.0 + 0.5 * math.exp(-((v / 0.05) ** 2))


def located(rates, margins, y, t_end):
    """Integrate x, v and elements of 1 kg under 3 sin(pi t) N; an element that slips does till v=0.

    `rates(v, z, slip, way)` gives the friction force and the rates of the elements, and
    `margins(v, z, way)` what falls below 0 where each begins to slip.
    """
    t, y, slip = 0.0, np.array(y), [False] * (len(y) - 2)
    way = 1.0

    def field(t, y):
        friction, z_dot = rates(y[1], y[2:], slip, way)
        return [y[1], 3.0 * math.sin(math.pi * t) - friction, *z_dot]

    def stop(now, y):
        return y[1] * way if now > begun else 1.0

    def reach(i):
        return lambda _, y: 1.0 if slip[i] else margins(y[1], y[2:], way)[i]

    events = [stop, *map(reach, range(len(slip)))]
    for one in events[1:]:
        one.terminal, one.direction = True, -1
    stop.terminal, stop.direction = True, -1
    while t < t_end:
        begun = t + 1e-9
        found = solve_ivp(
            field, (t, t_end), y, "DOP853", rtol=1e-11, atol=1e-14, events=events, max_step=0.02
        )
        t, y = found.t[-1], found.y[:, -1]
        if found.status == 0:
            break
        first = next(i for i, times in enumerate(found.t_events) if len(times))
        if first == 0:
            way, slip[:] = -way, [False] * len(slip)
        else:
            slip[first - 1] = True
    return y


def gms_rates(curve):
    def rates(v, z, slip, way):
        s_dot = [100.0 * (2 * (i + 1) / 5 / 1e4 * way - z[i] / curve(v)) for i in range(4)]
        return 2500.0 * sum(z) + 0.4 * v, [s_dot[i] if slip[i] else v for i in range(4)]

    return rates


def gms_margins(curve):
    return lambda v, z, way: [2 * (i + 1) / 5 * curve(v) / 1e4 - z[i] * way for i in range(4)]


def reset_rates(v, z, slip, way):
    force = 1e4 * z[0] * level(v) / 1.5
    return (force if slip[0] else 1.2 * force + 30.0 * v) + 0.4 * v, [0.0 if slip[0] else v]


def maxwell_rates(v, z, slip, way):
    force = 2500.0 * sum(z) * level(v) / 1.5
    return force + 0.4 * v, [0.0 if slip[i] else v for i in range(4)]


CASES = {
    "gms": (GMS, gms_rates(level), gms_margins(level)),
    "gms of one level": (LEVEL_GMS, gms_rates(lambda _: 1.0), gms_margins(lambda _: 1.0)),
    "maxwell": (MAXWELL, maxwell_rates, gms_margins(lambda _: 1.5)),
    "reset": (RESET, reset_rates, lambda v, z, way: [1.5e-4 - z[0] * way]),
}


@pytest.mark.parametrize(("own", "rates", "margins"), CASES.values(), ids=CASES)
def test_runs_agree_with_an_integration_that_locates_each_slip(own, rates, margins):
    run = simulate(RIG, own, t_end=3.0)
    assert run.certificate.certified
    assert run.certificate.steps < 1000  # by a switch without a latch GMS takes a million
    expected = located(rates, margins, [0.0, 0.0] + [0.0] * len(own.states), 3.0)
    names = ("x", "v", *own.states)
    # both integrate to about 1e-9 of what they integrate
    np.testing.assert_allclose([run[name][-1] for name in names], expected, rtol=1e-7, atol=1e-11)


@pytest.mark.parametrize("own", SWITCHED.values(), ids=SWITCHED)
def test_both_tiers_give_the_same_bits(own):
    plain, fast = (
        simulate(RIG, own, t_end=1.5, solver=EventDriven(tier=tier))
        for tier in ("python", "compiled")
    )
    for name in plain.names:
        np.testing.assert_array_equal(fast[name], plain[name])
    assert fast.certificate == plain.certificate


def test_runs_of_an_ensemble_are_those_of_simulate():
    values = np.linspace(1.1, 2.0, 40)
    found = ensemble(RIG, GMS, {"static_coefficient": values}, t_end=1.5)
    assert found.certified.all()
    for i in (0, 17, 39):
        alone = simulate(RIG, replace(GMS, static_coefficient=float(values[i])), t_end=1.5)
        assert found["x"][i] == alone["x"][-1]


@pytest.mark.parametrize("own", SWITCHED.values(), ids=SWITCHED)
def test_sensitivities_through_switches_are_those_of_differences(own):
    run = simulate(RIG, own, t_end=1.5)
    for name in ("kinetic_coefficient", "bristle_stiffness", "attraction", "sticking_surplus"):
        if not hasattr(own, name):
            continue
        value = getattr(own, name)
        ends = [
            simulate(RIG, replace(own, **{name: value * (1.0 + d)}), t_end=1.5)["x"][-1]
            for d in (-1e-4, 1e-4)
        ]
        difference = (ends[1] - ends[0]) / (2e-4 * value)
        # runs have errors of about 1e-10, and differences of second order 1e-7 of themselves
        assert run.sensitivity("x", name)[-1] == pytest.approx(
            difference, rel=1e-5, abs=2e-6 / value
        )


@pytest.mark.parametrize("own", SWITCHED.values(), ids=SWITCHED)
def test_a_contact_of_two_does_what_it_does_alone(own):
    alone = simulate(axis(PUSH), own, t_end=1.5)
    other = Sine(amplitude=3.0, frequency=0.7)
    both = simulate(
        Pair(left_drive=PUSH, right_drive=other), {"left": own, "right": GMS}, t_end=1.5
    )
    assert both.certificate.certified
    assert both["a"][-1] == pytest.approx(alone["x"][-1], abs=1e-8)
    assert both["b"][-1] == pytest.approx(simulate(axis(other), GMS, t_end=1.5)["x"][-1], abs=1e-8)


@pytest.mark.parametrize("own", LATCHED.values(), ids=LATCHED)
def test_fixed_steps_carry_the_latches_from_step_to_step(own):
    exact = simulate(RIG, own, t_end=0.5)["x"][-1]
    coarse, fine = (
        abs(simulate(RIG, own, t_end=0.5, solver=FixedStep(dt=dt))["x"][-1] - exact)
        for dt in (4e-4, 1e-4)
    )
    assert fine < 0.4 * coarse < 1e-3


def test_what_has_no_latches_is_refused_by_name():
    z = (0.0,) * 4
    with pytest.raises(InputError, match="latched switch, and numbers alone do not tell"):
        GMS.rates(0.1, 1.0, z)
    with pytest.raises(InputError, match="GMS has latched switches, which fixed steps"):
        simulate(Pair(), {"left": GMS, "right": GMS}, t_end=0.1, solver=FixedStep(dt=1e-3))
    assert GMS.force(0.1, 1.0, (1e-4,) * 4) == pytest.approx(1.04)


def test_latches_of_arrays_turn_entry_by_entry():
    flags = Latches()

    def slips(z, v):
        with flags:
            return latched(z - 1.0, z * v, 1.0, 0.0).tolist()

    ahead = np.array([1.0, 1.0, 1.0])
    assert slips(np.array([0.5, 1.5, 1.5]), ahead) == [0.0, 1.0, 1.0]
    flags.turn()
    now = np.array([1.5, 0.5, 0.5]), np.array([1.0, 1.0, -1.0])
    assert slips(*now) == [0.0, 1.0, 1.0]
    flags.turn()
    assert slips(*now) == [1.0, 1.0, 0.0]
