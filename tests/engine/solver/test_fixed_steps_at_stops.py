"""Hard stops in fixed steps: errors against exact runs and closed forms fall with the step."""

import math

import numpy as np
import pytest
from tests.contact_cases import coulomb
from tests.engine.solver.test_capsule_stops import LAW, robot, setting

from stickslip import Axis, FixedStep, Viscous, simulate
from stickslip.engine.solver import SoftConstraint
from stickslip.errors import InputError
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import PiecewiseLinear


def gap(exact, rig, law, dt, state, **settings):
    """Return the largest error of a state in a run, and the run."""
    y0 = settings.pop("y0", None)
    solver = FixedStep(dt=dt, **settings)
    run = simulate(rig, law, t_end=exact.span[1], y0=y0, solver=solver)
    return float(np.abs(run[state] - exact.at(run.t)[state]).max()), run


@pytest.mark.parametrize("method", ["euler", "semi-implicit"])
@pytest.mark.parametrize("seed", [2, 10, 31])
def test_errors_of_capsules_fall_with_the_step(seed, method):
    one = setting(seed)
    cycle = 1.0 / one.frequency
    exact = simulate(one.capsule, one.law, t_end=2.0 * cycle)
    coarse, fine = (
        gap(exact, one.capsule, one.law, cycle / n, "x", method=method)[0] for n in (300, 1200)
    )
    size = np.ptp(exact["x"])
    assert fine < 0.2 * size
    # a quarter, but for the luck of where impacts lie in a step
    assert fine < 0.5 * coarse + 1e-3 * size


@pytest.mark.parametrize("restitution", [0.0, 0.6])
@pytest.mark.parametrize("lower", [None, -0.0015])
def test_a_mass_rests_presses_and_leaves_as_in_an_exact_run(restitution, lower):
    rig = robot(6.0, restitution, lower)
    exact = simulate(rig, LAW, t_end=4.0 / 6.0)
    error, run = gap(exact, rig, LAW, 2e-4, "xi", method="semi-implicit")
    assert error < 0.02 * np.ptp(exact["xi"])
    assert run["xi"].max() == 0.002
    share = np.isclose(exact.at(run.t)["xi"], 0.002, rtol=1e-12).mean()
    rests = (run["xi"] == 0.002) & (run["xi_dot"] == 0.0)
    if restitution == 0.0:
        assert rests.mean() == pytest.approx(share, abs=0.02)
        assert rests.mean() > 0.05
    work = exact.certificate.work_stops
    assert run.certificate.work_stops == pytest.approx(work, rel=0.02)
    assert run.certificate.energy_error < 0.1


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_a_ball_bounces_and_its_bounces_end(restitution):
    # falls by 1 m onto a floor: it hits it after sqrt(2 / g), then hops of 2 e v / g each
    g, e = 9.81, restitution
    push = Torque(drive=PiecewiseLinear(times=(0.0,), values=(-g,))).drive
    ball = Axis(inertia=1.0, drive=push, lower_stop=0.0, restitution=e)
    law = Viscous(viscous_coefficient=0.0)
    solver = FixedStep(dt=1e-4)
    run = simulate(ball, law, t_end=2.0, y0={"x": 1.0}, solver=solver)
    first, speed = math.sqrt(2.0 / g), math.sqrt(2.0 * g)
    hop = first + e * speed / g
    highest = e**2
    assert run.at(hop)["x"][0] == pytest.approx(highest, abs=2e-3)
    last = first + 2.0 * speed / g * e / (1.0 - e) if e < 1.0 else math.inf
    rests = (run["x"] == 0.0) & (run["v"] == 0.0)
    if last < 2.0:
        assert run.t[rests][0] == pytest.approx(last, abs=5e-3)
        assert rests[run.t > last + 5e-3].all()
        assert run.certificate.work_stops == pytest.approx(g, rel=1e-3)
    else:
        assert not rests.any()


def test_a_body_pressed_against_its_stop_leaves_when_friction_lets_it():
    # pressed from 0 on, by a force that turns: 2 N at 0, -4 N after 3 s; break-away at 1.5 N
    turning = PiecewiseLinear(times=(0.0, 3.0), values=(2.0, -4.0))
    axis = Axis(inertia=1.0, drive=turning, load=1.0, upper_stop=0.5)
    law = coulomb(1.0, 1.5)
    exact = simulate(axis, law, t_end=2.5, y0={"x": 0.5})
    (leaves,) = (event.t for event in exact.events if event.from_mode == 2)
    assert leaves == pytest.approx(1.75, rel=1e-12)
    coarse, fine = (gap(exact, axis, law, dt, "x", y0={"x": 0.5})[0] for dt in (2e-3, 5e-4))
    assert fine < 0.3 * coarse < 0.3e-2
    run = simulate(axis, law, t_end=2.5, y0={"x": 0.5}, solver=FixedStep(dt=5e-4))
    held = run.t <= 1.75
    assert (run["x"][held] == 0.5).all()
    np.testing.assert_allclose(  # friction takes what it can, and the stop the rest
        run["friction"][held], np.clip(2.0 - 2.0 * run.t[held], -1.5, 1.5), atol=1e-9
    )


@pytest.mark.parametrize(
    ("law", "settings"),
    [(LAW, {"soft": SoftConstraint(impedance=0.9, damping=50.0)}), (LAW, {"viscous": 0.1})],
)
def test_rules_of_one_sliding_body_are_refused(law, settings):
    with pytest.raises(InputError, match="no hard stops"):
        simulate(robot(6.0), law, t_end=0.1, solver=FixedStep(dt=1e-4, **settings))
