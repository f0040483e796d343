"""A record of velocity steps that is fitted in a tenth of a second."""

import numpy as np
import pytest

from stickslip import Measurement, RecordSettings, TowedBlock, select
from stickslip.friction import RateState
from stickslip.identify.kinds import simulate_velocity_steps

MACHINE = TowedBlock(mass=1e-3, stiffness=2e3, speed=1e-6, load=1.0)
LAW = RateState(
    reference_coefficient=0.6,
    direct_effect=0.010,
    evolution_effect=0.0,
    reference_velocity=1e-6,
    evolution="none",
)
"""Logarithmic in speed, of which runs have a closed form."""
KNOTS, PLACES = (0.0, 20.0, 40.0, 80.0), (0.0, 20e-6, 220e-6, 260e-6)
"""Times [s] and positions [m] of the load point: 1 um/s, 10 um/s and 1 um/s."""
NOISE = 5e-4


@pytest.fixture(scope="session")
def machine():
    return MACHINE


@pytest.fixture(scope="session")
def steps():
    """Return 400 samples of a load point with two steps and of friction with white noise."""
    t = np.arange(0.0, KNOTS[-1], 0.2)
    run = simulate_velocity_steps(LAW, stiffness=MACHINE.stiffness, time=KNOTS, pull=PLACES, at=t)
    noise = np.random.default_rng(0).normal(0.0, NOISE, len(t))
    pull = np.interp(t, KNOTS, PLACES)
    return Measurement(time=t, pull=pull, friction=run.coefficient + noise, load=1.0)


@pytest.fixture(scope="session")
def verdict(machine, steps):
    laws = ["constant-coefficient", "logarithmic"]
    return select(machine, laws, steps, settings=RecordSettings(starts=1))
