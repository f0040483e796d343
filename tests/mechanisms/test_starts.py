"""Capsules begin to move where the forces of their drive begin with any power of the time."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import Capsule, Viscous, simulate
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import Sine

DAMPING = 9.81
RANDOM = np.random.default_rng(5)


def capsule(phase, stop, *, on="inner mass"):
    drive = Sine(amplitude=RANDOM.uniform(0.05, 1.0), frequency=RANDOM.uniform(2, 20), phase=phase)
    return Capsule(
        capsule_mass=RANDOM.uniform(0.02, 0.3), inner_mass=RANDOM.uniform(0.01, 0.2),
        stiffness=10.0 ** RANDOM.uniform(0, 3), damping=10.0 ** RANDOM.uniform(-3, -0.5),
        drive=Torque(drive=drive), drive_on=on, upper_stop=stop,
    )  # fmt: skip


@pytest.mark.parametrize("on", ["inner mass", "both"])
@pytest.mark.parametrize("stop", [None, 0.01])
@pytest.mark.parametrize("phase", [0.0, 0.5 * np.pi, np.pi, 4.8])
def test_a_capsule_in_a_viscous_film_starts_where_its_drive_does(phase, stop, on):
    for _ in range(6):  # forces that reach the capsule by rounding have either sign
        run = simulate(capsule(phase, stop, on=on), Viscous(viscous_coefficient=DAMPING), t_end=0.3)
        assert run.certificate.problems == ()


def test_the_motion_is_that_of_its_linear_equations():
    one = capsule(0.0, None)
    m, inner, drive = one.capsule_mass, one.inner_mass, one.drive.drive

    def rates(t, y):
        _, z, v, u = y  # the inner mass lies z from the capsule
        force = drive.amplitude * np.sin(2.0 * np.pi * drive.frequency * t)
        spring = one.stiffness * z + one.damping * u
        a = (spring - DAMPING * v) / m
        return [v, u, a, (force - spring) / inner - a]

    run = simulate(one, Viscous(viscous_coefficient=DAMPING), t_end=0.3)
    known = solve_ivp(rates, (0.0, 0.3), np.zeros(4), rtol=1e-11, atol=1e-14, method="DOP853")
    assert run["x"][-1] == pytest.approx(known.y[0, -1], rel=1e-9)
