"""Soft stops of the capsule against independent integrations, scales and mirrors."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import Capsule, Coulomb, EventDriven, simulate
from stickslip.errors import ParameterError
from stickslip.mechanisms import Prescribed, SoftStop, Torque
from stickslip.mechanisms.drives import Sine, SineSwing

GRAVITY = 9.81
FORCE = Sine(amplitude=0.25, frequency=7.0)
CAPSULE = Capsule(
    capsule_mass=0.08,
    inner_mass=0.02,
    stiffness=60.0,
    damping=0.03,
    drive=Torque(drive=FORCE),
    lower_soft_stop=SoftStop(place=-3e-3, stiffness=500.0),
    upper_soft_stop=SoftStop(place=2e-3, stiffness=3000.0, damping=0.8),
)
STICKING = replace(CAPSULE, upper_soft_stop=replace(CAPSULE.upper_soft_stop, sticks=True))
FROM_OUTSIDE = replace(CAPSULE, drive_on="inner mass")
CAPSULES = {"pushing": CAPSULE, "sticking": STICKING, "from outside": FROM_OUTSIDE}


def force_of_stops(capsule, xi, rate):
    """Force on the inner mass [N]."""
    total = 0.0
    for stop, side in ((capsule.lower_soft_stop, -1), (capsule.upper_soft_stop, 1)):
        depth = side * (xi - stop.place)
        if depth > 0.0:
            push = stop.stiffness * depth + side * stop.damping * rate
            total -= side * (push if stop.sticks else max(push, 0.0))
    return total


@pytest.mark.parametrize("name", CAPSULES)
@pytest.mark.parametrize("mu", [0.0, 50.0])
def test_without_slip_changes_it_is_the_solution_of_an_ordinary_equation(name, mu):
    """Frictionless two bodies, or a capsule that nothing moves."""
    capsule = CAPSULES[name]

    def slopes(t, y):
        between = -60.0 * y[2] - 0.03 * y[3] + force_of_stops(capsule, y[2], y[3])
        drive = FORCE.value(t)
        outside = capsule.drive_on == "inner mass"
        body = 0.0 if mu else (-between - (0.0 if outside else drive)) / capsule.capsule_mass
        return [y[1], body, y[3], (drive + between) / capsule.inner_mass - body]

    run = simulate(capsule, Coulomb(kinetic_coefficient=mu), t_end=0.6)
    known = solve_ivp(slopes, (0.0, 0.6), np.zeros(4), rtol=1e-9, atol=1e-13, max_step=5e-5)
    found = [run[column][-1] for column in ("x", "v", "xi", "xi_dot")]
    # a damper that begins to act changes the force by a jump within a step of the reference
    np.testing.assert_allclose(found, known.y[:, -1], rtol=1e-4, atol=1e-7)
    assert run.certificate.energy_error < 1e-9
    assert {event.reason for event in run.events} >= {
        "meets upper soft stop", "leaves upper soft stop",
    }  # fmt: skip


def stepped(capsule, mu, t_end, h):
    """Moreau's time stepping: position of the capsule at the end [m]."""
    total, m = capsule.capsule_mass + capsule.inner_mass, capsule.inner_mass
    x = v = xi = rate = 0.0
    for i in range(round(t_end / h)):
        drive, middle = FORCE.value((i + 0.5) * h), xi + 0.5 * h * rate
        between = -60.0 * middle - 0.03 * rate + force_of_stops(capsule, middle, rate)
        body = -between - (0.0 if capsule.drive_on == "inner mass" else drive)
        free = v + h * body / capsule.capsule_mass
        loss = h * mu * total * GRAVITY / capsule.capsule_mass
        after = math.copysign(max(abs(free) - loss, 0.0), free)
        rate_after = rate + h * (drive + between) / m - (after - v)
        x, xi = x + 0.5 * h * (v + after), xi + 0.5 * h * (rate + rate_after)
        v, rate = after, rate_after
    return x


@pytest.mark.parametrize("name", CAPSULES)
def test_with_stick_and_slip_it_is_where_time_steps_lead(name):
    run = simulate(CAPSULES[name], Coulomb(kinetic_coefficient=0.2), t_end=0.6)
    # whose error is that of the steps in which the mass meets a stop or the capsule turns
    assert abs(stepped(CAPSULES[name], 0.2, 0.6, 1e-5) - run["x"][-1]) < 1e-3 * np.ptp(run["x"])
    assert run.certificate.certified


def test_dimensionless_numbers_describe_a_capsule_up_to_its_scales():
    """Times by sqrt(m / k), lengths by the friction over k."""
    mu = 0.2
    capsule = replace(
        FROM_OUTSIDE,
        lower_soft_stop=None,
        upper_soft_stop=SoftStop(place=1e-3, stiffness=900.0),
        drive=Torque(drive=replace(FORCE, phase=0.5 * math.pi)),
    )
    numbers = capsule.dimensionless_numbers(mu)
    scaled = Capsule.dimensionless(**numbers, coefficient=mu)
    length, time = mu * GRAVITY * 0.1 / 60.0, math.sqrt(0.02 / 60.0)
    law = Coulomb(kinetic_coefficient=mu)
    ours, theirs = simulate(capsule, law, t_end=0.5), simulate(scaled, law, t_end=0.5 / time)
    assert theirs["x"][-1] * length == pytest.approx(ours["x"][-1], rel=1e-8)
    assert len(theirs.events) == len(ours.events)


def test_a_mirrored_capsule_goes_the_other_way():
    mirrored = replace(
        CAPSULE,
        drive=Torque(drive=replace(FORCE, amplitude=-0.25)),
        lower_soft_stop=replace(CAPSULE.upper_soft_stop, place=-2e-3),
        upper_soft_stop=replace(CAPSULE.lower_soft_stop, place=3e-3),
    )
    law = Coulomb(kinetic_coefficient=0.2)
    ours, theirs = (simulate(one, law, t_end=1.0) for one in (CAPSULE, mirrored))
    assert theirs["x"][-1] == pytest.approx(-ours["x"][-1], rel=1e-12)


def test_a_prescribed_motion_cannot_come_from_outside():
    motion = Prescribed(profile=SineSwing(amplitude=0.001, frequency=3.0))
    with pytest.raises(ParameterError, match="drive_on is 'inner mass', but the drive prescribes"):
        replace(FROM_OUTSIDE, drive=motion)
    with pytest.raises(ParameterError, match="drive_on must be 'both' or 'inner mass', got 'it'"):
        replace(CAPSULE, drive_on="it")


@pytest.mark.parametrize("restitution", [0.0, 0.6])
@pytest.mark.parametrize("damping", [0.0, 0.1])
def test_a_soft_stop_at_a_hard_one_is_left_as_often_as_it_is_met(restitution, damping):
    hard = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, upper_stop=2e-3,
        restitution=restitution, drive=Torque(drive=Sine(amplitude=0.2, frequency=7.0)),
    )  # fmt: skip
    soft = SoftStop(place=2e-3, stiffness=3000.0, damping=damping)
    both = replace(hard, upper_soft_stop=soft)
    own = Coulomb(kinetic_coefficient=0.2)
    alone, run = (simulate(one, own, t_end=0.6) for one in (hard, both))
    reasons = [event.reason for event in run.events if "soft" in event.reason]
    assert reasons.count("meets upper soft stop") >= 3
    assert reasons[::2] == ["meets upper soft stop"] * (len(reasons) // 2)
    assert reasons[1::2] == ["leaves upper soft stop"] * (len(reasons) // 2)
    assert run["x"][-1] == pytest.approx(alone["x"][-1], rel=1e-9)  # it is never pressed in
    tiers = [
        simulate(both, own, t_end=0.06, solver=EventDriven(tier=t)) for t in ("compiled", "python")
    ]
    assert [(e.t, e.reason) for e in tiers[0].events] == [(e.t, e.reason) for e in tiers[1].events]
