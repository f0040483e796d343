"""What mechanisms tell friction laws of their contacts: forces along the motion, positions."""

import math
import pickle
from dataclasses import replace

import pytest
from benchmarks.several.brakes import ClutchTrain, DiscBrake, Lining, Rotor

from stickslip import Axis, BlockChain, Capsule, Pendulum, PendulumCart, SpringBlock, TwoFeet
from stickslip.errors import InputError, UnknownNameError
from stickslip.mechanisms import (
    Link,
    SerialArm,
    Torque,
    TowedBlock,
    TwoLinkArm,
    TwoMassAxis,
    given_inputs,
    given_names,
    of_contact,
    without_given,
)
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.mechanisms.drives import Sampled

PUSH = Sampled(times=[0.0], values=[1.7])
RIGS = {
    "axis": Axis(inertia=2.0, drive=PUSH, stiffness=3.0, damping=0.4, offset=0.3),
    "pendulum": Pendulum(mass=0.3, length=0.4, inertia=0.01, drive=PUSH, damping=0.1),
    "spring": SpringBlock(mass=1.0, stiffness=50.0, compression=0.1, incline=0.2, drive=PUSH),
    "fastened": SpringBlock(
        mass=1.0, stiffness=50.0, compression=0.1, attached=True, incline=0.2, drive=PUSH
    ),
    "towed": TowedBlock(mass=1.0, stiffness=30.0, speed=0.2, damping=0.5),
    "coupled": TwoMassAxis(
        motor_inertia=1.0, load_inertia=2.0, stiffness=40.0, damping=0.3, offset=0.2, drive=PUSH
    ),
    "behind": TwoMassAxis(
        motor_inertia=1.0, load_inertia=2.0, stiffness=40.0, damping=0.3, drive=PUSH, rubs="motor"
    ),
    "both": TwoMassAxis(
        motor_inertia=1.0, load_inertia=2.0, stiffness=40.0, damping=0.3, drive=PUSH, rubs="both"
    ),
    "pivot": PendulumCart(
        cart_mass=1.0, ball_mass=0.2, length=0.3, pendulum=Torque(drive=PUSH), pivot_load=1.0,
        pivot_stiffness=0.7, pivot_angle=0.1, pivot_damping=0.05, incline=0.1,
    ),
    "arm": TwoLinkArm(
        upper_mass=1.0, upper_length=0.4, upper_centre=0.2, upper_inertia=0.06,
        lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03, elbow_drive=PUSH,
    ),
    "serial": SerialArm(
        links=tuple(
            Link(mass=0.5, length=0.3, centre=0.1, inertia=0.02, damping=0.2) for _ in range(3)
        ),
    ),
    "feet": TwoFeet(
        mass=2.0, front=0.3, rear=0.2, height=0.1, stiffness=50.0, damping=0.4, drive=PUSH
    ),
    "chain": BlockChain(
        blocks=3, mass=1.0, coupling=4.0, stiffness=2.0, damping=0.3, speed=0.2
    ),
    "ground": BlockChain(blocks=2, mass=1.0, coupling=4.0, damping=0.3),
}  # fmt: skip


def state(rig):
    """Return coordinates and rates of a rig that are all different, held coordinates at 0."""
    q = {name: 0.02 + 0.03 * i for i, name in enumerate(rig.coordinates)}
    q_dot = {name: 0.1 - 0.07 * i for i, name in enumerate(rig.coordinates)}
    held = dict.fromkeys(
        (*rig.held(), *(n for contact in rig.contacts() for n in contact.normals)), 0.0
    )
    return q | held, q_dot | held


def told_by(rig, t, q, q_dot, drives):
    """Return the inputs of each contact by the coordinate that slips."""
    found = rig.contact_inputs(t, q, q_dot, drives)
    contacts = rig.contacts()
    return {
        contact.slips[0]: found[contact.name] if len(contacts) > 1 else found
        for contact in contacts
    }


@pytest.mark.parametrize("name", RIGS)
def test_motor_and_external_are_all_forces_along_the_motion_without_inertia(name):
    rig, t = RIGS[name], 0.3
    (q, q_dot), drives = state(rig), {one: drive.value(t) for one, drive in rig.drives().items()}
    forces = rig.forces(t, q, q_dot | dict.fromkeys(rig.coordinates, 0.0), drives)
    damped = rig.forces(t, q, q_dot, drives)
    for x, found in told_by(rig, t, q, q_dot, drives).items():
        assert set(found) <= set(CONTACT_INPUTS)
        assert found["position"] == q[x]
        if "motor" not in found:
            continue
        assert found["transmitted"] == found["motor"] - found["external"]
        h = 1e-6
        ahead, back = (rig.potential_energy(t, q | {x: q[x] + d}) for d in (h, -h))
        # forces of arms hold their weight already; centrifugal ones count as inertia
        kept = 0.0 if name in ("arm", "serial") else (ahead - back) / (2.0 * h)
        arms = {"arm": 0.0, "serial": -0.2 * q_dot[x]}
        own = forces[x] + arms[name] if name in arms else damped[x]
        assert found["motor"] + found["external"] == pytest.approx(own - kept, rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("name", ["pendulum", "spring", "fastened", "pivot", "arm", "serial"])
def test_gravity_is_the_slope_of_the_potential_energy(name):
    rig = RIGS[name]
    (q, q_dot), h = state(rig), 1e-6
    for x, found in told_by(rig, 0.0, q, q_dot, dict.fromkeys(rig.drives(), 0.0)).items():
        heavy = rig.potential_energy(0.0, q | {x: q[x] - h}) - rig.potential_energy(
            0.0, q | {x: q[x] + h}
        )
        others = {"spring": 50.0 * (0.1 - q[x]), "fastened": 50.0 * (0.1 - q[x])}
        wound = -0.7 * (q[x] - 0.1) if (name, x) == ("pivot", "theta") else 0.0
        expected = heavy / (2.0 * h) - others.get(name, 0.0) - wound
        assert found["gravity"] == pytest.approx(expected, rel=1e-8, abs=1e-9)


HOLDING = {
    "axis": (Axis(inertia=2.0, offset=3.0, drive=PUSH), {}, 3.0),
    "pendulum": (
        Pendulum(mass=0.3, length=0.4, drive=PUSH),
        {"theta": 0.5},
        0.3 * 9.81 * 0.4 * math.sin(0.5),
    ),
    "block": (SpringBlock(mass=1.0, incline=0.3, drive=PUSH), {}, 9.81 * math.sin(0.3)),
}


@pytest.mark.parametrize("name", HOLDING)
def test_holding_a_weight_loads_the_gear_with_twice_the_weight(name):
    rig, at, weight = HOLDING[name]
    q = dict.fromkeys(rig.coordinates, 0.0) | at
    still = dict.fromkeys(rig.coordinates, 0.0)
    found = rig.contact_inputs(0.0, q, still, {"drive": weight})
    assert found["motor"] + found["external"] == pytest.approx(0.0, abs=1e-12)
    assert found["transmitted"] == pytest.approx(2.0 * weight, rel=1e-15)


def test_a_joint_of_an_arm_that_holds_itself_carries_twice_its_weight():
    rig = RIGS["arm"]
    q, still = {"shoulder": 0.4, "elbow": 0.3}, {"shoulder": 0.0, "elbow": 0.0}
    weights = rig.contact_inputs(0.0, q, still, {})
    held = {f"{name}_drive": -weight["gravity"] for name, weight in weights.items()}
    for found in rig.contact_inputs(0.0, q, still, held).values():
        assert found["transmitted"] == pytest.approx(-2.0 * found["gravity"], rel=1e-14)


def test_a_capsule_tells_its_slope_but_no_motor_because_the_force_is_inside():
    capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, incline=0.1)
    found = capsule.contact_inputs(0.0, {"x": 0.5, "xi": 0.1}, {"x": 0.0, "xi": 0.0}, {})
    assert found == {"gravity": -9.81 * math.sin(0.1), "position": 0.5}


def test_a_chain_of_blocks_counts_what_a_moving_belt_drags_too():
    rig, t = RIGS["chain"], 0.3
    (q, q_dot), moved = state(rig), 0.2 * 0.3
    found = rig.contact_inputs(t, q, q_dot, {})
    expected = -2.0 * (q["x2"] + moved) - 0.3 * (q_dot["x2"] + 0.2)
    expected += 4.0 * (q["x1"] - 2.0 * q["x2"] + q["x3"])
    assert found["block-2"]["external"] == pytest.approx(expected, rel=1e-14)


PADS = (Lining(radius=0.1, load=10.0), Lining(radius=0.12, load=8.0))


def test_pads_that_hold_a_wound_spring_against_the_drive_see_twice_its_force_at_their_radius():
    rig = DiscBrake(inertia=0.5, stiffness=30.0, drive=PUSH, pads=PADS)
    found = rig.contact_inputs(0.0, {"phi": -0.2}, {"phi": 0.0}, {"drive": -6.0})
    for pad, told in zip(PADS, found.values(), strict=True):
        assert told["motor"] + told["external"] == 0.0
        assert told["transmitted"] == pytest.approx(-12.0 / pad.radius, rel=1e-15)
        assert told["position"] == pytest.approx(-0.2 * pad.radius, rel=1e-15)
    # a turn against the spring takes as much as the torques that the forces are
    moving = rig.contact_inputs(0.0, {"phi": 0.1}, {"phi": 2.0}, {"drive": 1.0})
    whole = rig.forces(0.0, {"phi": 0.1}, {"phi": 2.0}, {"drive": 1.0})["phi"] - 30.0 * 0.1
    for pad, told in zip(PADS, moving.values(), strict=True):
        assert pad.radius * (told["motor"] + told["external"]) == pytest.approx(whole, rel=1e-14)


def test_both_sides_of_a_belt_that_holds_a_weight_transmit_twice_the_weight():
    rig = TwoMassAxis(
        motor_inertia=1.0, load_inertia=2.0, stiffness=40.0, offset=3.0, drive=PUSH, rubs="both"
    )
    q, still = {"x": 0.0, "other": 3.0 / 40.0}, {"x": 0.0, "other": 0.0}
    for found in rig.contact_inputs(0.0, q, still, {"drive": 3.0}).values():
        assert found["motor"] + found["external"] == pytest.approx(0.0, abs=1e-14)
        assert found["transmitted"] == pytest.approx(6.0, rel=1e-14)


def test_joints_of_a_serial_arm_that_holds_itself_carry_twice_their_weights():
    links = RIGS["serial"].links
    rig = SerialArm(links=tuple(replace(link, torque=PUSH) for link in links))
    q = {f"q{i}": 0.3 - 0.2 * i for i in (1, 2, 3)}
    still = dict.fromkeys(q, 0.0)
    none = dict.fromkeys(rig.drives(), 0.0)
    weights = rig.contact_inputs(0.0, q, still, none)
    held = {drive: -weight["gravity"] for drive, weight in zip(none, weights.values(), strict=True)}
    for found in rig.contact_inputs(0.0, q, still, held).values():
        assert found["transmitted"] == pytest.approx(-2.0 * found["gravity"], rel=1e-14)


def test_a_foot_that_a_drive_holds_against_a_spring_sees_twice_its_force():
    rig = RIGS["feet"]
    found = rig.contact_inputs(0.0, {"x": 0.1}, {"x": 0.0}, {"drive": 5.0})
    assert {entry["transmitted"] for entry in found.values()} == {10.0}


def test_a_clutch_tells_how_far_it_has_slipped_and_no_force_which_its_own_friction_decides():
    train = ClutchTrain(rotors=(Rotor(inertia=1.0),) * 3, clutches=PADS, brake=PADS[0])
    q = {"phi": 2.0, "psi1": 0.5, "psi2": -0.25}
    found = train.contact_inputs(0.0, q, dict.fromkeys(q, 0.0), {})
    assert found == {
        "clutch-1": {"position": 0.05},
        "clutch-2": {"position": -0.03},
        "brake": {"position": 0.2},
    }


def test_one_contact_is_told_what_others_are_not():
    brake = DiscBrake(inertia=0.5, pads=PADS)
    hot = given_inputs(brake, {"temperature": 20.0, "pad-2": {"temperature": PUSH}})
    told = hot.contact_inputs(0.0, {"phi": 0.0}, {"phi": 0.0}, {"contact_pad_2_temperature": 90.0})
    assert of_contact(told, "pad-1")["temperature"] == 20.0
    assert of_contact(told, "pad-2")["temperature"] == 90.0
    assert of_contact(told, "pad-2")["position"] == 0.0
    assert given_names(hot, "pad-2") == ("temperature",)
    assert pickle.loads(pickle.dumps(hot)) == hot
    assert without_given(hot) == (brake, {"temperature": 20.0, "pad-2": {"temperature": PUSH}})
    cold = given_inputs(hot, {"pad-2": {"temperature": 30.0}})
    assert cold.contact_temperature == 20.0
    assert cold.contact_pad_2_temperature == 30.0
    with pytest.raises(UnknownNameError, match=r"unknown contact of DiscBrake 'pad-3'.*'pad-2'"):
        given_inputs(brake, {"pad-3": {"temperature": 20.0}})
    with pytest.raises(UnknownNameError, match="contact input 'heat'"):
        given_inputs(brake, {"pad-1": {"heat": 20.0}})
    with pytest.raises(InputError, match=r"the contact 'pad-1' are given by name.*got 20.0"):
        given_inputs(brake, {"pad-1": 20.0})
