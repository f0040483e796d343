"""First deflections of bristles, and the slopes of segments that begin with one."""

import numpy as np
import pytest

from stickslip import Axis, CoulombViscous, Dahl, LuGre, Measurement, RecordSettings, fit, simulate
from stickslip.drives import Sampled
from stickslip.identification.records.problems import ProblemRequest, prepared
from stickslip.identification.shooting.first_deflections import deflection_slopes, first_deflection

SOFT = LuGre(
    kinetic_coefficient=3.0,
    static_coefficient=4.0,
    stribeck_velocity=0.02,
    bristle_stiffness=2e3,
    bristle_damping=40.0,
    viscous_coefficient=2.0,
)


def test_a_bristle_begins_with_the_deflection_of_steady_slip():
    z = first_deflection(SOFT, 5.0, 1.0)
    # far above the Stribeck velocity the bristle carries mu_k alone
    assert z == pytest.approx(3.0 / 2e3, rel=1e-3)
    assert first_deflection(SOFT, -5.0, 1.0) == -z


def test_slow_slip_winds_a_bristle_up_in_proportion():
    slow = first_deflection(SOFT, 1e-5, 1.0)
    assert slow == pytest.approx(0.02 * 1e-5, rel=1e-3)
    assert deflection_slopes(SOFT, 0.0, 1.0, ())[1] == pytest.approx(slow / 1e-5, rel=1e-3)


def test_laws_without_one_bristle_begin_without_deflection():
    law = CoulombViscous(kinetic_coefficient=1.0, viscous_coefficient=0.1)
    assert first_deflection(law, 1.0, 1.0) == 0.0


@pytest.fixture(scope="module")
def problem():
    t = np.arange(0.0, 4.0, 1e-3)
    force = 12.0 * np.sin(5.0 * t) + 4.0 * np.sin(13.0 * t)
    axis = Axis(inertia=3.0, drive=Sampled(times=t.tolist(), values=force.tolist()))
    x = simulate(axis, SOFT, t_end=float(t[-1])).at(t)["x"]
    record = Measurement(time=t, position=x, force=force)
    wanted = ProblemRequest(
        mechanism=Axis(inertia=3.0),
        law=SOFT,
        measurement=record,
        unknown=("inertia",),
        free=LuGre.fit_order,
        known=None,
        settings=RecordSettings(segment=0.5),
    )
    return prepared("shooting", wanted).problem


@pytest.mark.parametrize("number", [1, 4])
def test_slopes_of_a_segment_know_what_the_law_does_to_its_first_deflection(problem, number):
    values = problem.free_parameters.start
    segment = problem.segments[number]

    def residual(at):
        law, mechanisms = problem._changed(at)
        return problem._shot(segment, mechanisms[id(segment.mechanism)], law, segment.guess)

    slopes = residual(values).slopes
    for i, path in enumerate(problem.free_parameters.paths):
        step = 1e-5 * (abs(values[i]) or 1.0)
        own = step * (np.arange(len(values)) == i)
        ahead, behind = residual(values + own), residual(values - own)
        difference = (behind.residual - ahead.residual) / (2.0 * step)
        # the solver keeps six digits in modes with bristles, differences of 1e-5 lose three to four
        assert np.abs(slopes[:, i] - difference).max() < 0.01 * np.abs(difference).max(), path


def test_a_law_whose_exponent_is_whole_at_the_start_is_fitted_with_its_exponent():
    law = Dahl(kinetic_coefficient=3.0, bristle_stiffness=800.0, viscous_coefficient=2.0)
    t = np.arange(0.0, 2.0, 1e-3)
    force = 12.0 * np.sin(5.0 * t) + 4.0 * np.sin(13.0 * t)
    axis = Axis(inertia=3.0, drive=Sampled(times=t.tolist(), values=force.tolist()))
    x = simulate(axis, law, t_end=float(t[-1])).at(t)["x"]
    record = Measurement(time=t, position=x, force=force)
    start = Dahl(kinetic_coefficient=3.0, bristle_stiffness=2400.0, viscous_coefficient=2.0)
    free = ("kinetic_coefficient", "bristle_stiffness", "exponent", "viscous_coefficient")
    settings = RecordSettings(starts=1)
    found = fit(Axis(inertia=3.0), start, record, vary=free, route="shooting", settings=settings)
    # the first deflections of segments are guessed, and the true ones are not quite those
    assert found.law.bristle_stiffness == pytest.approx(800.0, rel=0.05)
    assert found.law.exponent == pytest.approx(1.0, abs=0.1)
