"""The arm with two joints: its equations against a textbook's, and against another arm."""

import numpy as np
import pytest
from tests.contact_cases import Arm, coulomb

from stickslip import TwoLinkArm, simulate
from stickslip.engine.formulation import JointTorques

LINEAR = [
    f"mechanism.{name}"
    for name in ("upper_centre", "upper_inertia", "lower_centre", "lower_inertia", "rotor_inertia")
]
SOME = TwoLinkArm(
    upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
    lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03, rotor_inertia=6e-5, gear_ratio=6.0,
)  # fmt: skip


def motion(count=50):
    """Return random coordinates, rates and accelerations."""
    return np.random.default_rng(3).normal(size=(3, count, 2))


def test_the_torques_that_a_motion_takes_are_those_of_the_textbook():
    q, v, a = motion()
    found, _ = JointTorques.of(SOME, []).along(SOME, np.zeros(len(q)), q, v, a)
    coupling, gear = 0.5 * 0.2 * 0.2, 6.0
    c, s = np.cos(q[:, 1]), np.sin(q[:, 1])
    lower = 0.03 + gear * 6e-5 + coupling * c
    whole = 0.012 + 0.03 + 0.5 * 0.2**2 + (gear**2 + 1.0) * 6e-5 + 2.0 * coupling * c
    weight = 9.81 * 0.5 * 0.2 * np.sin(q[:, 0] + q[:, 1])
    shoulder = (
        whole * a[:, 0] + lower * a[:, 1] - coupling * s * (2.0 * v[:, 0] + v[:, 1]) * v[:, 1]
        + 9.81 * (0.6 * 0.1 + 0.5 * 0.2) * np.sin(q[:, 0]) + weight
    )  # fmt: skip
    elbow = lower * a[:, 0] + (0.03 + gear**2 * 6e-5) * a[:, 1] + coupling * s * v[:, 0] ** 2
    # a few roundings of sums of some N m
    np.testing.assert_allclose(found, np.column_stack([shoulder, elbow + weight]), atol=1e-13)


def test_torques_are_linear_in_the_base_parameters():
    q, v, a = motion()
    takes, time = JointTorques.of(SOME, LINEAR), np.zeros(50)
    found, slopes = takes.along(SOME, time, q, v, a)
    other = TwoLinkArm(
        upper_mass=0.6, upper_length=0.2, upper_centre=0.3, upper_inertia=0.05,
        lower_mass=0.5, lower_centre=-0.1, lower_inertia=0.001, rotor_inertia=0.0, gear_ratio=6.0,
    )  # fmt: skip
    change = np.array([0.2, 0.038, -0.3, -0.029, -6e-5])
    np.testing.assert_allclose(
        takes.along(other, time, q, v, a)[0], found + slopes @ change, atol=1e-13
    )


@pytest.mark.parametrize("names", [["upper_length"], ["upper_mass", "upper_centre"]])
def test_forces_are_known_not_to_be_linear_in_lengths_or_in_a_mass_with_its_place(names):
    assert JointTorques.of(SOME, [f"mechanism.{name}" for name in names]).bent
    assert not JointTorques.of(SOME, LINEAR).bent


def test_it_moves_as_the_arm_of_the_reference_numbers():
    """Point masses at the ends of the links make both descriptions one."""
    known = Arm()
    arm = TwoLinkArm(
        upper_mass=known.upper_mass, upper_length=known.length, upper_centre=known.length,
        upper_inertia=known.upper_mass * known.length**2, lower_mass=known.lower_mass,
        lower_centre=known.length, lower_inertia=known.lower_mass * known.length**2,
    )  # fmt: skip
    laws = {"shoulder": coulomb(0.3, 0.45), "elbow": coulomb(0.12, 0.2)}
    bent = {"shoulder": 1.2, "elbow": 0.8}
    run, reference = (simulate(one, laws, t_end=2.0, y0=bent) for one in (arm, known))
    for name in arm.coordinates:  # both within the tolerance of the solver
        assert run[name][-1] == pytest.approx(reference[name][-1], abs=1e-7)
