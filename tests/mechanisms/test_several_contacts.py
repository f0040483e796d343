"""Mechanisms of the package that have several contacts, against closed forms and references.

The reference numbers are those of `tests/engine/solver/test_contacts.py`.
"""

import dataclasses
import math

import numpy as np
import pytest
from benchmarks.several.brakes import ClutchTrain, DiscBrake, Lining, Rotor
from tests.contact_cases import clutches, coulomb

from stickslip import (
    BlockChain,
    EventDriven,
    PendulumCart,
    TowedBlock,
    TwoFeet,
    TwoMassAxis,
    simulate,
)
from stickslip.engine import Status
from stickslip.errors import InputError, ParameterError
from stickslip.mechanisms import Contact, Link, Prescribed, SerialArm, Torque
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse, Ramp, Sine, SineSwing

PLAIN = EventDriven(tier="python")


def run_of(mechanism, laws, t_end, y0=None, **settings):
    """Simulate in plain Python; every run must be certified."""
    return simulate(
        mechanism, laws, t_end=t_end, y0=y0, solver=EventDriven(tier="compiled", **settings)
    )


def modelica_clutches():
    """Return the example CoupledClutches of the Modelica library, and its start."""
    rotors = [Rotor(inertia=1.0, torque=Sine(amplitude=10.0, frequency=5.0))]
    presses = (
        Sine(amplitude=20.0, frequency=0.2, phase=0.5 * math.pi),
        Pulse(level=20.0, duration=10.0, start=0.4),
        Pulse(level=20.0, duration=10.0, start=0.9),
    )
    train = ClutchTrain(
        rotors=(*rotors, *[Rotor(inertia=1.0)] * 3),
        clutches=[Lining(radius=1.0, press=press) for press in presses],
    )
    return train, coulomb(0.5, 0.55), {"omega": 10.0, "psi1_dot": -10.0}


def test_a_clutch_train_moves_as_the_same_train_that_is_written_by_hand():
    train, law, start = modelica_clutches()
    by_hand, laws, other = clutches()
    run = run_of(train, law, 1.5, start)
    two = run_of(by_hand, laws, 1.5, other)
    assert run["omega"][-1] == pytest.approx(two["w"][-1], rel=1e-8)


def test_a_brake_stops_the_first_rotor_and_what_is_clutched_to_it():
    train = ClutchTrain(
        rotors=[Rotor(inertia=0.2), Rotor(inertia=0.3)],
        clutches=[Lining(radius=0.1, load=500.0)],
        brake=Lining(radius=0.2, load=50.0),
    )
    laws = {"clutch-1": coulomb(0.4), "brake": coulomb(0.5)}
    run = run_of(train, laws, 20.0, {"omega": 40.0})
    # 5 N m slow 0.5 kg m^2 from 40 rad/s; the clutch carries 3 of its 20 N m and does not slip
    assert run.status is Status.AT_REST
    assert [e.t for e in run.events if e.contact == "brake"] == pytest.approx([4.0], rel=1e-13)
    assert not np.any(run["psi1"])


def test_one_block_on_a_belt_is_a_towed_block_seen_from_the_belt():
    law = coulomb(0.7, 1.0)
    chain = BlockChain(blocks=1, mass=1.0, coupling=5.0, stiffness=2.0, speed=0.1)
    towed = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    run, other = (run_of(mechanism, law, 30.0) for mechanism in (chain, towed))
    # the belt is at rest there: the spring's other end moves the other way
    assert [e.t for e in run.events] == pytest.approx([e.t for e in other.events], abs=1e-12)
    assert run["x1"][-1] == pytest.approx(-other["x"][-1], abs=1e-12)
    assert run.contacts == ()
    assert run.contact("block-1") is run


def test_blocks_on_the_ground_rest_for_good_and_on_a_belt_that_stands_still_they_rest_too():
    chain = BlockChain(blocks=3, mass=1.0, coupling=4.0, stiffness=1.0)
    run = run_of(chain, coulomb(0.5), 5.0)
    assert run.status is Status.AT_REST
    assert not run.events
    still = run_of(dataclasses.replace(chain, speed=0.0), coulomb(0.5), 5.0)
    assert still.status is Status.END_TIME  # nothing says that the belt stays where it is
    assert not still.events


def test_a_cart_whose_wheels_and_pivot_rub():
    cart = PendulumCart(cart_mass=0.5, ball_mass=0.2, length=0.3, pivot_load=1.0)
    laws = {"wheels": coulomb(0.05, 0.08), "pivot": coulomb(0.01, 0.015)}
    run = run_of(cart, laws, 6.0, {"theta": math.pi + 1.5})
    assert len(run.events) == 21
    assert run["x"][-1] == pytest.approx(-0.0748188604520, abs=6e-12)
    assert run["theta"][-1] == pytest.approx(math.pi - 0.1592091101027, abs=6e-12)
    assert run.units["friction:pivot"] == "N m"
    assert run.units["friction:wheels"] == "N"


def test_a_cart_without_load_on_its_pivot_has_the_contact_that_it_always_had():
    swing = Torque(drive=Sine(amplitude=0.5, frequency=1.0))
    cart, other = (
        PendulumCart(cart_mass=0.5, ball_mass=0.2, length=0.3, pendulum=swing, **more)
        for more in ({}, {"pivot_load": 0.0})
    )
    assert cart == other
    assert cart.contacts() == (Contact(slip="x", normal="y"),)


def test_a_prescribed_swing_leaves_nothing_for_the_pivot_to_hold():
    swing = Prescribed(profile=SineSwing(amplitude=0.2, frequency=1.0))
    cart = PendulumCart(cart_mass=0.5, ball_mass=0.2, length=0.3, pendulum=swing, pivot_load=1.0)
    with pytest.raises(InputError, match="theta is a slip coordinate"):
        run_of(cart, coulomb(0.1), 1.0)


def test_a_belt_drive_whose_motor_and_load_rub_stops_where_work_and_momentum_say():
    """A stiff belt makes one axis of both, whose friction is that of motor and load together."""
    axis = TwoMassAxis(
        motor_inertia=0.5, load_inertia=1.5, stiffness=1e6, damping=1e3, rubs="both",
        drive=Pulse(level=5.0, duration=1.0),
    )  # fmt: skip
    laws = {"load": coulomb(0.6), "motor": coulomb(0.4)}
    run = run_of(axis, laws, 10.0)
    assert run.status is Status.AT_REST
    # 2 m/s^2 for 1 s, then -0.5 m/s^2; the belt gives some 5 N / 1e6 N/m
    assert run["x"][-1] == pytest.approx(5.0, abs=1e-4)
    changed = dataclasses.replace(axis, rubs="load")
    both, alone = run_of(axis, {**laws, "motor": None}, 1.0), run_of(changed, laws["load"], 1.0)
    assert both["x"][-1] == pytest.approx(alone["x"][-1], abs=1e-9)


def test_two_feet_turn_where_the_closed_form_says():
    body = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15, stiffness=50.0)
    laws = {"front": coulomb(0.6, 0.7), "rear": coulomb(0.2, 0.3)}
    run = run_of(body, laws, 3.0, {"x": 0.9})
    quarter = math.pi / 5.0
    turns = [-0.64774285714286, 0.32668831168831, -0.07443116883117]
    at = run.at([quarter, 2.0 * quarter, 3.0 * quarter])
    np.testing.assert_allclose(at["x"], turns, atol=2e-13)
    assert run.at(2.5)["normal_force:front"][0] == pytest.approx(8.96446753246753, abs=1e-11)


def test_a_high_body_that_is_braked_hard_lifts_its_rear_foot():
    body = TwoFeet(mass=2.0, front=0.1, rear=0.3, height=0.5)
    run = simulate(body, coulomb(0.8), t_end=1.0, y0={"v": 1.0}, solver=PLAIN, throw=False)
    assert run.status is Status.LIFT_OFF


def test_pads_share_the_torque_that_holds_the_disc():
    brake = DiscBrake(
        inertia=0.5,
        pads=(Lining(radius=0.10, load=100.0), Lining(radius=0.12, load=80.0)),
        drive=Ramp(rate=1.5),
    )
    run = run_of(
        brake, {"pad-1": coulomb(0.4, 0.5), "pad-2": coulomb(0.3, 0.4)}, 8.0, {"omega": 20.0}
    )
    stop, leave = 1.8110266003436, 5.8933333333333
    assert [e.t for e in run.events] == pytest.approx([stop, stop, leave, leave], abs=1e-12)
    held = run.at(4.0)
    assert held["friction:pad-1"][0] == pytest.approx(33.936651583710, rel=1e-12)
    assert held["friction:pad-2"][0] == pytest.approx(21.719457013575, rel=1e-12)
    assert run["phi"][-1] == pytest.approx(29.998614147705, abs=1e-12)


def test_a_disc_turns_on_while_its_pads_are_off():
    press = PiecewiseLinear(times=(0.0, 1.0, 2.0), values=(100.0, 0.0, 0.0))
    brake = DiscBrake(inertia=0.5, pads=(Lining(radius=0.1, press=press),))
    run = run_of(brake, coulomb(0.5), 3.0, {"omega": 20.0})
    assert [e.reason for e in run.events] == ["opens"]
    # the impulse of 5 N m (1 - t) over a second is 2.5 N m s
    assert run["omega"][-1] == pytest.approx(15.0, rel=1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: BlockChain(blocks=2.5, mass=1.0, coupling=1.0), "whole number"),
        (lambda: BlockChain(blocks=0, mass=1.0, coupling=1.0), "at least 1"),
        (lambda: DiscBrake(inertia=1.0, pads=()), "at least 1 of Lining"),
        (lambda: DiscBrake(inertia=1.0, pads=(Rotor(inertia=1.0),)), "at least 1 of Lining"),
        (lambda: ClutchTrain(rotors=(Rotor(inertia=1.0),), clutches=()), "at least 2 of Rotor"),
        (
            lambda: ClutchTrain(rotors=[Rotor(inertia=1.0)] * 2, clutches=[Lining(radius=1.0)] * 2),
            "2 rotors, which 1 clutches join; got 2",
        ),
        (
            lambda: ClutchTrain(
                rotors=[Rotor(inertia=1.0)] * 2, clutches=[Lining(radius=1.0)], brake=0.1
            ),
            "ClutchTrain.brake",
        ),
        (lambda: Contact(slip="x", load=1.0, name="a.b"), "kebab case"),
        (lambda: Contact(slip="x", load=1.0, name="Left Pad"), "kebab case"),
        (lambda: Contact(slip="x", load=1.0, name="1"), "kebab case"),
        # its inputs would stand in the fields of pad-2
        (lambda: Contact(slip="x", load=1.0, name="pad_2"), "kebab case"),
    ],
)
def test_what_no_such_mechanism_can_be_is_refused(make, message):
    with pytest.raises(ParameterError, match=message):
        make()


@pytest.mark.parametrize(
    ("height", "speed", "status", "reason"),
    [
        (0.3, 1.0, Status.LIFT_OFF, "lift-off"),  # the front foot brakes so hard that it tips over
        (0.6, 1.0, Status.PAINLEVE, "painleve"),  # no loads balance what they would brake with
        (1.5, 1.0, Status.PAINLEVE, "painleve"),
        (1.5, -1.0, Status.LIFT_OFF, "lift-off"),
    ],
)
def test_a_body_that_begins_where_its_loads_have_no_solution_says_so(height, speed, status, reason):
    # the loads are m g (b + h mu_r) and m g (a - h mu_f) over a + b - h (mu_f - mu_r)
    body = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=height)
    laws = {"front": coulomb(1.6, 1.6), "rear": coulomb(0.2, 0.2)}
    run = simulate(body, laws, t_end=1.0, y0={"v": speed}, solver=PLAIN, throw=False)
    assert run.status is status
    assert run.events[-1].reason == reason
    assert run.span[1] == 0.0


@pytest.mark.parametrize("tier", ["compiled", pytest.param("python", marks=pytest.mark.slow)])
@pytest.mark.parametrize("gravity", [0.0, 9.81])
@pytest.mark.parametrize("joints", [2, 3, 4, 6])
def test_joints_that_break_away_in_one_instant_move_as_if_it_were_nearly_one(joints, gravity, tier):
    def run(share):
        link = Link(mass=0.5, length=0.3, centre=0.15, inertia=0.015)
        links = tuple(
            dataclasses.replace(link, torque=Sine(amplitude=1.0 + share * i, frequency=0.5))
            for i in range(joints)
        )
        arm = SerialArm(links=links, gravity=gravity)
        return simulate(arm, coulomb(0.2), t_end=0.3, solver=EventDriven(tier=tier))

    tied, first, last = map(run, (0.0, -1e-7, 1e-7))
    assert tied.certificate.certified
    # all reach the level at once; reactions of the last joint hold those before it
    assert tied.events[0].contact == f"joint-{joints}"
    assert tied.events[1].t > tied.events[0].t + 0.01
    times = np.linspace(0.0, 0.3, 31)
    for name in tied.states[:joints]:
        for near in (first, last):
            # torques that differ by up to 6e-7 N m turned links by 6e-7 rad at most
            assert tied.at(times)[name] == pytest.approx(near.at(times)[name], abs=2e-6)
