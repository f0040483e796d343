"""What is given in place of a drive, a motor or a truth value is refused with the cure."""

import numpy as np
import pytest
from benchmarks.several.brakes import ClutchTrain, Rotor

from stickslip import Axis, Capsule, SpringBlock
from stickslip.errors import ParameterError
from stickslip.mechanisms import Prescribed, Torque
from stickslip.mechanisms.drives import Sampled, Sine, Sum, ThreePhase

SINE = Sine(amplitude=1.0, frequency=2.0)
MOTION = ThreePhase(amplitude=0.1, fast=9.0, slow=3.0)
SAMPLES = "Give samples of the function f, Sampled"


def swing(t: float) -> float:
    return 3.0 * t


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Axis(inertia=1.0, drive=lambda t: t), f"Axis.drive .* got a function. {SAMPLES}"),
        (lambda: Axis(inertia=1.0, drive=swing), SAMPLES),
        (lambda: SpringBlock(mass=1.0, stiffness=9.0, drive=swing), "SpringBlock.drive must be"),
        (lambda: Axis(inertia=1.0, drive=3.0), r"constant is Sampled\(times=\[0.0\], values=\[3\]"),
        (lambda: Axis(inertia=1.0, drive=Sine), r"got the class Sine. Give its parameters: Sine\("),
        (lambda: Axis(inertia=1.0, drive=np.zeros(3)), "Give the times of the samples too"),
        (lambda: Axis(inertia=1.0, drive="sine"), r"such as Sine\(...\) or None, got 'sine'"),
        (lambda: Rotor(inertia=1.0, torque=swing), "Rotor.torque must be a drive"),
        (lambda: Torque(drive=swing), "Torque.drive must be a drive .* got a function"),
        (lambda: Torque(drive=MOTION), r"an acceleration: a motor takes it, as Prescribed\("),
        (lambda: Axis(inertia=1.0, drive=MOTION), r"Axis.drive must .* as Prescribed\("),
        (lambda: SINE + MOTION, r"Sum.parts must .* as Prescribed\(profile=...\)"),
        (lambda: Sum(parts=(3.0,)), r"Sum.parts must .* Sampled\(times=\[0.0\], values=\[3\]\)"),
        (lambda: Prescribed(profile=SINE), "must be a motion profile such as ThreePhase"),
        (lambda: Capsule(capsule_mass=1.0, inner_mass=0.2, drive=SINE), "Write Torque"),
        (lambda: Capsule(capsule_mass=1.0, inner_mass=0.2, drive=swing), SAMPLES),
        (lambda: SpringBlock(mass=1.0, stiffness=9.0, attached="no"), "True or False, got 'no'"),
        (lambda: ClutchTrain(rotors=(), clutches=(), brake=3.0), "of the class Lining or None"),
    ],
)
def test_a_part_of_another_kind_is_refused_with_the_cure(make, words):
    with pytest.raises(ParameterError, match=words):
        make()


def test_the_cures_work():
    times = np.linspace(0.0, 1.0, 11)
    ramp = Sampled(times=times, values=[swing(s) for s in times], hold="first")
    assert Axis(inertia=1.0, drive=ramp).drive.value(0.55) == pytest.approx(1.65)
    assert Sampled(times=[0.0], values=[3]).value(7.0) == 3.0
