"""First deflections of bristles, and the slopes of segments that begin with one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import integrate

from stickslip import Axis, Dahl, LuGre, Measurement, RecordSettings, fit, simulate
from stickslip.friction import law
from stickslip.identify.fits.parameters import FreeParameters
from stickslip.identify.fits.shooting.initial_states import (
    FirstDeflections,
    Path,
    RecordedMotion,
    follow,
)
from stickslip.identify.fits.shooting.problems import simulated
from stickslip.identify.fits.validation import Parameters
from stickslip.mechanisms.drives import Sampled

SOFT = LuGre(
    kinetic_coefficient=3.0,
    static_coefficient=4.0,
    stribeck_velocity=0.02,
    bristle_stiffness=2e3,
    bristle_damping=40.0,
    viscous_coefficient=2.0,
)


def begun(law, velocity, held=0.0):
    """Deflections (b,) where nothing but the first velocity, or the force at rest, is known."""
    deflections = FirstDeflections(
        law=law,
        free_parameters=FreeParameters(()),
        values=np.zeros(0),
        motion=replace(RecordedMotion.unknown(0, 0.0).begun(velocity), held=held),
        starts=np.zeros(1),
        length=1.0,
    )
    return deflections.states[0], deflections.velocity_slopes[0]


def test_a_bristle_begins_with_the_deflection_of_steady_slip():
    (z,), _ = begun(SOFT, 5.0)
    # far above the Stribeck velocity the bristle carries mu_k alone
    assert z == pytest.approx(3.0 / 2e3, rel=1e-3)
    assert begun(SOFT, -5.0)[0] == -z


def test_slow_slip_winds_a_bristle_up_in_proportion():
    (slow,), _ = begun(SOFT, 1e-5)
    assert slow == pytest.approx(0.02 * 1e-5, rel=1e-3)
    assert begun(SOFT, 0.0)[1] == pytest.approx([slow / 1e-5], rel=1e-3)


def test_bristles_of_a_body_at_rest_balance_the_other_forces():
    assert begun(SOFT, 0.0, held=2.0)[0] == pytest.approx([2.0 / 2e3])
    assert begun(SOFT, 0.0, held=-9.0)[0] == pytest.approx([-4.0 / 2e3])  # no more than breaks away


def test_elements_begin_with_the_deflections_of_steady_slip_too():
    of_three = law("maxwell[3](level)")(kinetic_coefficient=3.0, bristle_stiffness=2e3)
    assert begun(of_three, 5.0)[0] == pytest.approx([0.75e-3, 1.5e-3, 2.25e-3])


@pytest.mark.parametrize("text", ["lugre(level) + viscous", "maxwell[3](level) + viscous"])
def test_bristles_of_segments_are_followed_along_the_measured_motion(text):
    kind = law(text)
    values = {"bristle_damping": 20.0} if "lugre" in text else {}
    own = kind(kinetic_coefficient=3.0, bristle_stiffness=2e3, viscous_coefficient=2.0, **values)
    run, record = recorded(own, 4.0, noise=2e-5)
    found = problem_of(own, record)
    known = {f"friction.{name}": getattr(own, name) for name in kind.fit_order}
    at = np.array([known.get(path, 3.0) for path in found.free_parameters.paths])
    begin = found._begun(own, at, range(1, 8))
    for number, one in begin.items():
        seen = run.at([found.segments[number].start])
        # of a presliding of 1.5 mm, whatever the velocity is there
        states = [float(seen[name][0]) for name in own.states]
        assert one.deflections(0.0) == pytest.approx(states, abs=6e-5)


def recorded(own, t_end, noise=0.0):
    t = np.arange(0.0, t_end, 1e-3)
    force = 12.0 * np.sin(5.0 * t) + 4.0 * np.sin(13.0 * t)
    axis = Axis(inertia=3.0, drive=Sampled(times=t.tolist(), values=force.tolist()))
    run = simulate(axis, own, t_end=float(t[-1]))
    x = run.at(t)["x"] + noise * np.random.default_rng(1).normal(size=len(t))
    return run, Measurement(time=t, position=x, force=force)


def problem_of(own, record):
    wanted = Parameters(
        mechanism=Axis(inertia=3.0), law=own, unknown=("inertia",), free=type(own).fit_order
    )
    settings = RecordSettings(segment=0.5)
    return simulated(settings, wanted, record, {}).problem


@pytest.fixture(scope="module")
def problem():
    return problem_of(SOFT, recorded(SOFT, 4.0)[1])


@pytest.mark.parametrize("number", [0, 1, 4])
def test_slopes_of_a_segment_know_what_the_law_does_to_its_first_deflection(problem, number):
    values = problem.free_parameters.start
    segment = problem.segments[number]

    def residual(at):
        own, mechanisms = problem._changed(at)
        begin = problem._begun(own, at, [number])[number]
        mechanism = mechanisms[id(segment.mechanism)]
        return problem._shot(segment, mechanism, own, begin, segment.guess)

    slopes = residual(values).slopes
    for i, path in enumerate(problem.free_parameters.paths):
        step = 1e-5 * max(abs(values[i]), 1.0)
        change = step * (np.arange(len(values)) == i)
        ahead, behind = residual(values + change), residual(values - change)
        difference = (behind.residual - ahead.residual) / (2.0 * step)
        # the solver keeps six digits in modes with bristles, differences of 1e-5 lose three to four
        assert np.abs(slopes[:, i] - difference).max() < 0.01 * np.abs(difference).max(), path


@pytest.mark.slow
def test_a_law_whose_exponent_is_whole_at_the_start_is_fitted_with_its_exponent():
    own = Dahl(kinetic_coefficient=3.0, bristle_stiffness=800.0, viscous_coefficient=2.0)
    t = np.arange(0.0, 2.0, 1e-3)
    force = 12.0 * np.sin(5.0 * t) + 4.0 * np.sin(13.0 * t)
    axis = Axis(inertia=3.0, drive=Sampled(times=t.tolist(), values=force.tolist()))
    x = simulate(axis, own, t_end=float(t[-1])).at(t)["x"]
    record = Measurement(time=t, position=x, force=force)
    start = Dahl(kinetic_coefficient=3.0, bristle_stiffness=2400.0, viscous_coefficient=2.0)
    free = ("kinetic_coefficient", "bristle_stiffness", "yield_exponent", "viscous_coefficient")
    settings = RecordSettings(starts=1)
    found = fit(Axis(inertia=3.0), start, record, vary=free, route="shooting", settings=settings)
    # the first deflections of segments are those of the measured motion, sampled
    assert found.law.bristle_stiffness == pytest.approx(800.0, rel=0.05)
    assert found.law.yield_exponent == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("exponent", [0.3, 0.7, 1.3, 2.0, 3.0])
@pytest.mark.parametrize("start", [0.0, 4e-4, -8e-4, 2e-3])
def test_a_bristle_that_yields_sharply_or_softly_follows_its_equation(exponent, start):
    law = Dahl(kinetic_coefficient=25.0, bristle_stiffness=3e4, yield_exponent=exponent)
    for v in (0.01, -0.01):
        path = Path(
            time=np.array([0.0, 0.1]),
            velocity=np.full(2, v),
            load=np.ones(2),
            travel=np.array([0.1 * v]),
        )
        found = follow(law, path, np.array([[start]]))[0, -1, 0]
        run = integrate.solve_ivp(
            lambda _t, z, v=v: [float(law.rates(v, 1.0, (z[0],))[0])],
            (0.0, 0.1),
            [start],
            method="LSODA",
            rtol=1e-10,
            atol=1e-14,
        )
        # of a largest deflection of 8e-4; rates are rounded within 1e-6 of it where n < 1
        assert found == pytest.approx(run.y[0, -1], abs=1e-8)
