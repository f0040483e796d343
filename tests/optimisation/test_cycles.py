"""What is measured of a steady cycle: closed forms, the reference numbers, energy."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip import Axis, Coulomb
from stickslip.errors import InputError
from stickslip.mechanisms import Prescribed, static_normal_force, static_normal_forces
from stickslip.mechanisms.drives import SevenStep, SineSwing, SplineSwing, ThreePhase
from stickslip.show.plots.studies import _bounds
from stickslip.study.optimisation import GOALS, Limits, ScoredMotion, measure, units_of_limits
from stickslip.study.optimisation.problem import fitted

G, MU, P, STROKE_LENGTH, FAST = 9.81, 0.2, 0.2, 0.02, 50.0


def test_capsule_travels_and_takes_what_the_closed_form_says(capsule, law):
    slow = MU * G / P
    rate = math.sqrt(2 * STROKE_LENGTH / (1 / slow + 1 / FAST))
    brake = 2 * rate / FAST
    fastest = (P * FAST - MU * G) * brake
    travel = fastest * brake / 2 + fastest**2 / (4 * MU * G)
    cycle = measure(capsule, law)
    # events are located to rounding, and travel sums a few of them
    assert cycle.travel == pytest.approx(travel, rel=1e-9)
    assert cycle.period == pytest.approx(2 * rate / slow + brake, rel=1e-12)
    assert cycle.rate == pytest.approx(rate, rel=1e-9)
    assert cycle.position == pytest.approx(STROKE_LENGTH / 2, rel=1e-9)
    # nothing lifts the capsule, and the slow phase holds it exactly
    assert cycle.load_share == pytest.approx(1.0, rel=1e-12)
    assert cycle.back_slip == 0.0
    # the middle phase, in which the mass is pushed back against a capsule that slides:
    # m (x'' + xi'') with x'' = p w2 - mu g on the way forward
    inner = 0.2 * (FAST - (P * FAST - MU * G))
    assert cycle.effort == pytest.approx(inner, rel=1e-9)


def test_cart_repeats_the_reference_travel_and_least_normal_force(cart, law):
    cycle = measure(cart, law)
    assert cycle.repeats
    assert round(cycle.travel, 7) == 0.0634659
    assert round(cycle.period, 5) == 0.72360
    # 3.462 N is given with four digits
    assert cycle.load_share * 0.6 * G == pytest.approx(3.462, abs=5e-4)


def test_positive_work_covers_what_friction_takes(cart, law):
    # over a steady cycle the motor's net work is the friction's, and the positive part is more
    cycle = measure(cart, law)
    t = np.linspace(cycle.begin, cycle.run.span[1], 40_001)
    seen = cycle.run.at(t)
    net = np.trapezoid(seen["torque"] * seen["omega"], t)
    lost = np.trapezoid(seen["friction"] * seen["v"], t)
    positive = np.trapezoid(np.maximum(seen["torque"] * seen["omega"], 0.0), t)
    # the trapezoidal rule meets jumps of powers of 10 W somewhere within a step of 2e-5 s
    assert net == pytest.approx(lost, abs=4e-4)
    assert cycle.work == pytest.approx(positive, abs=4e-4)


def test_extremes_do_not_miss_what_lies_between_samples(cart, law):
    coarse, fine = (measure(cart, law, samples=n) for n in (65, 8193))
    # the second look divides a cell by eight: 1/64 of the error of the first, of 1e-3
    for name in ("position", "rate", "effort", "load_share"):
        assert getattr(coarse, name) == pytest.approx(getattr(fine, name), rel=1e-4)


def test_a_swing_that_is_its_own_mirror_image_brings_nothing(cart, law):
    swing = SineSwing(amplitude=0.5, frequency=2.0)
    cycle = measure(fitted(cart, swing), law)
    # half a period later everything is mirrored; the parts of which nothing is left are millimetres
    assert abs(cycle.travel) < 1e-9


def test_a_motion_that_lifts_the_cart_off_tells_how_far_it_came(cart, law):
    wild = ThreePhase(amplitude=1.0, fast=900.0, slow=500.0)
    cycle = measure(fitted(cart, wild), law)
    assert not cycle.repeats
    assert 0.0 < cycle.lasted < 1.0
    scored = ScoredMotion(profile=wild, value=0.0, margins=(), cycles=(cycle,))
    assert scored.early_end.startswith("its run stopped at ")
    assert scored.early_end.endswith("s: Lift-off: the normal force fell to zero.")
    assert scored.shown(GOALS["travel"]) is cycle


def test_a_body_that_hardly_rubs_is_said_not_to_repeat_itself(cart):
    # with nothing to hold it, the first jerk leaves it a drift that friction takes minutes to stop
    profile = SplineSwing(positions=(-0.5, 0.2, 0.5, -0.1), duration=0.5)
    cycle = measure(fitted(cart, profile), Coulomb(kinetic_coefficient=1e-5))
    assert not cycle.repeats
    assert cycle.lasted == 1.0


@pytest.mark.parametrize(
    "profile",
    [
        SevenStep(amplitude=0.4, fast=55.0, slow=36.0, top_rate=4.0, pause=0.05),
        SevenStep(amplitude=0.4, fast=55.0, slow=36.0, top_rate=4.0),
        SplineSwing(positions=(-0.4, 0.0, 0.5, 0.3, 0.1), duration=1.0),
        SineSwing(amplitude=0.4, frequency=1.5),
    ],
)
def test_peaks_of_the_stretches_hold_the_extreme_of_the_cycle(cart, law, profile):
    cycle = measure(fitted(cart, profile), law)
    for name in ("position", "rate", "effort"):
        assert cycle.peaks[name].max() == pytest.approx(getattr(cycle, name), rel=1e-12)
    assert cycle.peaks["load_share"].min() == pytest.approx(cycle.load_share, rel=1e-12)


def test_weight_and_units_are_read_off_the_mechanism(cart, capsule):
    assert static_normal_force(cart) == pytest.approx(0.6 * G, rel=1e-12)
    assert units_of_limits(cart)["effort"] == "N m"
    assert units_of_limits(capsule)["rate"] == "m/s"


def test_a_mechanism_without_a_motion_is_refused(law):
    with pytest.raises(InputError, match=r"Prescribed\(profile=...\)"):
        measure(Axis(inertia=1.0), law)


def test_the_limit_of_a_motor_ends_a_run_that_needs_more(cart, law):
    weak = replace(cart, pendulum=Prescribed(profile=cart.pendulum.profile, limit=0.5))
    assert measure(weak, law).lasted < 1.0


@pytest.mark.parametrize("mass", [0.3, 0.5, 0.7, 1.1])
def test_the_bound_of_the_load_that_a_figure_draws_is_that_of_the_load_at_rest(cart, law, mass):
    heavy = replace(cart, cart_mass=mass)
    (force,) = static_normal_forces(heavy).values()
    best = SimpleNamespace(
        mechanism=heavy,
        run=measure(heavy, law).run,
        limits=Limits(load_share=0.1, rate=12.0, position=1.0),
    )
    assert _bounds(best)["normal_force"] == (0.1 * force,)
