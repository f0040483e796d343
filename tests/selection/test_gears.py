"""Selection among laws of gears, where the mechanism tells the load."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import (
    Axis,
    BamM5,
    Coulomb,
    CoulombViscous,
    Measurement,
    Pendulum,
    RecordSettings,
    fit,
    select,
    simulate,
)
from stickslip.drives import Sampled
from stickslip.friction import law
from stickslip.kinds.joints.admissibility import objection
from stickslip.mechanisms import DCMotor

T = np.arange(0.0, 12.0, 4e-3)
RIG = Pendulum(mass=1.2, length=0.3, inertia=0.03)
SETTINGS = RecordSettings(hold="first")


def motion():
    """Return positions, velocities and accelerations (n,)."""
    sizes, rates, phases = (0.5, 0.4, 0.2), (1.7, 3.9, 6.1), (0.3, 2.0, 4.4)
    parts = list(zip(sizes, rates, phases, strict=True))
    q = sum(a * np.sin(w * T + p) for a, w, p in parts)
    v = sum(a * w * np.cos(w * T + p) for a, w, p in parts)
    return q, v, -sum(a * w**2 * np.sin(w * T + p) for a, w, p in parts)


def swung(*, fading):
    """Return a record of a gear that loses 20 % of its torque, and at rest `fading` more."""
    q, v, a = motion()
    weight = 1.2 * 9.81 * 0.3 * np.sin(q)
    taken = weight + (1.2 * 0.3**2 + 0.03) * a
    lost = np.zeros_like(q)
    for _ in range(200):  # a share of a torque that it is itself a part of
        faded = np.exp(-np.abs(v) / 0.4)
        level = 0.1 + 0.5 * fading * faded + (0.2 + fading * faded) * np.abs(taken + lost + weight)
        lost = np.sign(v) * level + 0.05 * v
    random = np.random.default_rng(3)
    return Measurement(
        time=T,
        position=q + 5e-5 * random.standard_normal(len(T)),
        force=taken + lost + 5e-3 * random.standard_normal(len(T)),
        turning=True,
    )


@pytest.mark.slow
def test_a_load_that_fades_with_speed_is_a_load_and_accuses_no_rig():
    verdict = select(RIG, None, swung(fading=0.1))
    assert "gear" in verdict.family
    assert not [one.term for one in verdict.causes]


@pytest.mark.slow
def test_shares_of_both_torques_that_do_not_differ_are_said():
    found = fit(RIG, BamM5, swung(fading=0.0), settings=SETTINGS, route="inverse-dynamics")
    assert "$k_m$ and $k_e$ are not shown to differ" in objection(found, shown=True)


def test_measured_friction_beside_the_torque_of_a_gear_has_no_law_that_asks_for_more():
    q, v, _ = motion()
    torque = np.sin(0.7 * T + 1.0) + 0.4 * np.cos(2.3 * T)
    friction = np.sign(v) * (0.05 + 0.15 * np.abs(torque)) + 0.02 * v
    record = Measurement(
        time=T,
        position=q,
        velocity=v,
        friction=friction + 2e-3 * np.random.default_rng(0).standard_normal(len(T)),
        turning=True,
        inputs={"transmitted": torque},
    )
    verdict = select(Axis(inertia=1.0, rotary=True), None, record)
    assert verdict.best.name == "bam-m3"
    assert all({*c.fit.law.inputs} <= {"transmitted"} for c in verdict.candidates)


BOTH = ["mechanism.drive.resistance", "mechanism.drive.torque_constant"]


def driven(law, vary, *, voltages=(1.0,)):
    """Return a fit to a servo without an arm under voltages, whose friction is viscous too."""
    motor = DCMotor(resistance=4.0, torque_constant=0.4, rotor_inertia=2e-3)
    axis = Axis(inertia=4e-3, rotary=True, drive=motor)
    friction = CoulombViscous(kinetic_coefficient=0.05, viscous_coefficient=0.02)
    trials = []
    for k, times in enumerate(voltages):
        u = times * (4.0 * np.sin(1.7 * T) + 2.5 * np.sin(4.4 * T + 1.0))
        own = replace(motor, drive=Sampled(times=T, values=u, hold="first"))
        run = simulate(replace(axis, drive=own), friction, t_end=T[-1]).at(T)
        trials.append(
            Measurement(
                time=T,
                position=run["x"] + 2e-4 * np.random.default_rng(k).standard_normal(T.size),
                voltage=u,
                turning=True,
                inputs={"temperature": 20.0 + T},
                name=f"trial {k}",
            )
        )
    given = {"route": "inverse-dynamics", "settings": SETTINGS}
    return fit(axis, law, Measurement(trials=tuple(trials)), vary=vary, **given)


@pytest.mark.slow
def test_constants_of_a_motor_that_stand_for_viscous_friction_are_a_doubt():
    said = "$R$ and $k_t$ hold only if friction has no viscous part"
    # neither another voltage nor a temperature tells back-EMF from viscous friction
    warm = law("level * linear[temperature]")
    for found in (
        driven(Coulomb, ["friction.*", *BOTH], voltages=(1.0, 0.6)),
        driven(warm, ["friction.*", *BOTH]),
    ):
        (resistance,) = [one for one in found.estimates if one.path == BOTH[0]]
        assert resistance.bounded
        assert not resistance.low <= 4.0 <= resistance.high
        assert said in objection(found)
    assert said not in objection(driven(law("both_ways(level + viscous)"), ["friction.*", *BOTH]))
    assert said not in objection(driven(Coulomb, ["friction.*", *BOTH[:1]]))
    (*rest, last) = found.measurement.trials
    last = replace(last, overrides={"mechanism.drive.current_limit": 0.0})  # an open winding
    assert said not in objection(
        replace(found, measurement=replace(found.measurement, trials=(*rest, last)))
    )


def test_constants_of_a_motor_hold_with_the_viscous_part_that_was_held():
    true = CoulombViscous(kinetic_coefficient=0.04, viscous_coefficient=0.02)
    found = driven(true, ["friction.kinetic_coefficient", *BOTH])
    assert found.estimates[-2].low <= 4.0 <= found.estimates[-2].high
    assert "$R$ and $k_t$ hold only if friction has the viscous part that was held" in objection(
        found
    )
