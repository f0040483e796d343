"""What is measured of a steady cycle: closed forms, reference numbers, energy."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import pytest

from stickslip import Axis, Capsule, Coulomb, Mechanism, PendulumCart, TowedBlock, TwoFeet
from stickslip.engine.simulation import event_driven_law
from stickslip.errors import InputError
from stickslip.mechanisms import Contact, Prescribed, Torque, static_normal_forces
from stickslip.mechanisms.drives import Sine, SineSwing, SplineSwing, Square, ThreePhase
from stickslip.quantities import Quantity
from stickslip.study.optimisation import measure, units_of

G, MU, P, STROKE_LENGTH, FAST = 9.81, 0.2, 0.2, 0.02, 50.0
LAW = Coulomb(kinetic_coefficient=MU)
STROKE = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
CAPSULE = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=STROKE))
SWING = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
CART = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=SWING))


def test_capsule_travels_and_takes_what_the_closed_form_says():
    slow = MU * G / P
    rate = math.sqrt(2 * STROKE_LENGTH / (1 / slow + 1 / FAST))
    brake = 2 * rate / FAST
    fastest = (P * FAST - MU * G) * brake
    travel = fastest * brake / 2 + fastest**2 / (4 * MU * G)
    cycle = measure(CAPSULE, LAW)
    # events are located to rounding, and travel sums a few of them
    assert cycle.travel == pytest.approx(travel, rel=1e-9)
    assert cycle.period == pytest.approx(2 * rate / slow + brake, rel=1e-12)
    assert cycle.largest["xi_dot"] == pytest.approx(rate, rel=1e-9)
    assert cycle.largest["xi"] == pytest.approx(STROKE_LENGTH / 2, rel=1e-9)
    assert cycle.largest["acceleration"] == FAST
    # nothing lifts the capsule, and the slow phase holds it exactly
    assert cycle.load_share == pytest.approx(1.0, rel=1e-12)
    assert cycle.back_slip == 0.0
    # the middle phase, in which the mass is pushed back against a capsule that slides:
    # m (x'' + xi'') with x'' = p w2 - mu g on the way forward
    inner = 0.2 * (FAST - (P * FAST - MU * G))
    assert cycle.peak_force == cycle.largest["force"] == pytest.approx(inner, rel=1e-9)


def test_cart_repeats_the_reference_travel_and_least_normal_force():
    cycle = measure(CART, LAW)
    assert cycle.repeats
    assert round(cycle.travel, 7) == 0.0634659
    assert round(cycle.period, 5) == 0.72360
    # 3.462 N is given with four digits
    assert cycle.load_share * 0.6 * G == pytest.approx(3.462, abs=5e-4)


def test_positive_work_covers_what_friction_takes():
    # over a steady cycle the motor's net work is the friction's, and the positive part is more
    cycle = measure(CART, LAW)
    t = np.linspace(cycle.begin, cycle.run.span[1], 40_001)
    seen = cycle.run.at(t)
    net = np.trapezoid(seen["torque"] * seen["omega"], t)
    lost = np.trapezoid(seen["friction"] * seen["v"], t)
    positive = np.trapezoid(np.maximum(seen["torque"] * seen["omega"], 0.0), t)
    # the trapezoidal rule meets jumps of powers of 10 W somewhere within a step of 2e-5 s
    assert net == pytest.approx(lost, abs=4e-4)
    assert cycle.work == pytest.approx(positive, abs=4e-4)


@pytest.mark.parametrize("drive_on", ["both", "inner mass"])
def test_the_net_work_of_a_force_is_that_of_friction_and_damper(drive_on):
    push = Torque(drive=Square(high=1.0, low=-0.4, period=0.2, duty=0.3), limit=0.8)
    capsule = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.3, drive=push,
        drive_on=drive_on,
    )  # fmt: skip
    cycle = measure(capsule, LAW)
    assert cycle.repeats
    assert cycle.peak_force == 0.8
    t = np.linspace(cycle.begin, cycle.run.span[1], 40_001)
    seen = cycle.run.at(t)
    lost = np.trapezoid(seen["friction"] * seen["v"] + 0.3 * seen["xi_dot"] ** 2, t)
    push_of = np.where((t - cycle.begin) % 0.2 < 0.06, 0.8, -0.4)
    rate = seen["xi_dot"] + (seen["v"] if drive_on == "inner mass" else 0.0)
    assert np.trapezoid(push_of * rate, t) == pytest.approx(lost, rel=1e-3)
    assert cycle.work == pytest.approx(
        np.trapezoid(np.maximum(push_of * seen["xi_dot"], 0.0), t)
        + (
            np.trapezoid(np.maximum(push_of * seen["v"], 0.0), t)
            if drive_on == "inner mass"
            else 0.0
        ),
        rel=1e-3,
    )


def test_a_symmetric_swing_brings_nothing():
    swing = SineSwing(amplitude=0.4, frequency=1.5)
    cycle = measure(replace(CART, pendulum=Prescribed(profile=swing)), LAW)
    # the parts of which nothing is left are millimetres
    assert abs(cycle.travel) < 1e-9


def test_a_motion_that_lifts_the_cart_off_says_how_far_it_came():
    wild = ThreePhase(amplitude=1.0, fast=900.0, slow=500.0)
    cycle = measure(replace(CART, pendulum=Prescribed(profile=wild)), LAW)
    assert not cycle.repeats
    assert 0.0 < cycle.lasted < 1.0
    assert math.isnan(cycle.travel)


def test_a_body_that_hardly_rubs_does_not_repeat_itself():
    # with nothing to hold it, the first jerk leaves it a drift that friction takes minutes to stop
    profile = SplineSwing(positions=(-0.5, 0.2, 0.5, -0.1), duration=0.5)
    swung = replace(CART, pendulum=Prescribed(profile=profile))
    cycle = measure(swung, Coulomb(kinetic_coefficient=1e-5))
    assert not cycle.repeats
    assert cycle.lasted == 1.0
    # a mean over the later half of the cycles
    x = cycle.run.at([cycle.begin, cycle.run.span[1]])["x"]
    assert cycle.travel == pytest.approx((x[1] - x[0]) / 48, rel=1e-9)


def test_units_are_those_of_the_mechanism():
    assert units_of(CART, "x")["torque"] == "N m"
    assert units_of(CART, "x")["peak_force"] == "N m"
    assert units_of(CAPSULE, "x")["xi_dot"] == "m/s"


def test_a_mechanism_without_a_cycle_is_refused():
    with pytest.raises(InputError, match="has no drive"):
        measure(Axis(inertia=1.0), LAW)


def test_the_limit_of_a_motor_ends_a_run_that_needs_more():
    weak = replace(CART, pendulum=Prescribed(profile=SWING, limit=0.5))
    assert measure(weak, LAW).lasted < 1.0


WEIGHT = 9.81


@dataclass(frozen=True, kw_only=True)
class Sled(Mechanism):
    """1 kg, of which 0.2 kg move inside; half of the weight on each runner."""

    name: ClassVar[str] = "sled"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "xi")
    rates: ClassVar[tuple[str, ...]] = ("v", "xi_dot")
    units: ClassVar[tuple[str, ...]] = ("m", "m")
    share: Annotated[float, Quantity("s", low=0, high=1)] = 0.5
    drive: Prescribed = None

    def kinetic_energy(self, q, q_dot):
        inner = q_dot["x"] + q_dot["xi"]
        return 0.4 * q_dot["x"] * q_dot["x"] + 0.1 * inner * inner

    def potential_energy(self, t, q):
        return 0.0 * q["x"]

    def forces(self, t, q, q_dot, drives):
        return {"xi": self.drive.force(drives)}

    def contacts(self):
        return (
            Contact(name="left", slip="x", load=self.share * WEIGHT),
            Contact(name="right", slip="x", load=(1.0 - self.share) * WEIGHT),
        )

    def drives(self):
        return self.drive.drives()

    def start(self):
        return self.drive.start("xi", "xi_dot")

    def guided(self):
        return {"xi": self.drive.guide("force", "N")}


SLED = Sled(drive=Prescribed(profile=STROKE))


def test_a_cycle_on_two_runners_is_that_on_one_contact():
    both, alone = measure(SLED, LAW), measure(CAPSULE, LAW)
    assert both.travel == pytest.approx(alone.travel, abs=1e-12)
    assert both.work == pytest.approx(alone.work, rel=1e-9)
    assert both.load_share == pytest.approx(1.0, abs=1e-12)
    assert static_normal_forces(SLED) == {"left": WEIGHT / 2, "right": WEIGHT / 2}


def test_a_runner_that_bears_nothing_at_rest_has_no_share_of_its_load():
    assert measure(replace(SLED, share=0.0), LAW).load_share == pytest.approx(1.0, abs=1e-12)


def test_a_force_that_presses_a_body_does_no_work():
    towed = TowedBlock(
        mass=1.0, stiffness=20.0, speed=0.1, modulation=Sine(amplitude=2.0, frequency=3.0)
    )
    cycle = measure(towed, LAW)
    assert math.isnan(cycle.work)
    assert math.isnan(cycle.peak_force)
    assert cycle.speed == pytest.approx(0.1, rel=0.02)


def test_laws_by_contact_act_together():
    laws = {"left": LAW, "right": Coulomb(kinetic_coefficient=0.25)}
    both = measure(SLED, event_driven_law(SLED, laws))
    middle = measure(SLED, Coulomb(kinetic_coefficient=0.225))
    assert both.travel == pytest.approx(middle.travel, abs=1e-12)


def test_weights_of_feet_follow_from_where_the_weight_acts():
    body = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15)
    found = static_normal_forces(body)
    assert found == pytest.approx({"front": 19.62 * 0.4, "rear": 19.62 * 0.6}, rel=1e-9)
