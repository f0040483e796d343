"""A record in time that laws can be fitted to in a second; pages with empty figures."""

import numpy as np
import pytest
from tests.support import sketched, wide_only

from stickslip import Axis, CoulombViscous, simulate
from stickslip.mechanisms.drives import Sampled

RATE = 200.0
"""Samples a second [Hz]."""
LAW = CoulombViscous(kinetic_coefficient=10.0, viscous_coefficient=30.0)
INERTIA = 5.0


@pytest.fixture(scope="session")
def axis_record():
    """Return time [s], position [m] and force [N] of an axis with known friction."""
    time = np.arange(round(6.0 * RATE)) / RATE
    force = 40.0 * np.sin(2.0 * np.pi * time) + 15.0 * np.sin(2.3 * time)
    drive = Sampled(times=time, values=force)  # held between samples, as a controller does
    run = simulate(Axis(inertia=INERTIA, drive=drive), LAW, t_end=6.0)
    noise = np.random.default_rng(0).normal(0.0, 1e-5, time.size)
    return {"t": time, "q": run.at(time)["x"] + noise, "u": force}


@pytest.fixture(autouse=True, scope="module")
def figures_are_not_laid_out():
    """Leave out what makes text of a drawing: tests of reports have it of the same sections."""
    with sketched():
        yield


@pytest.fixture
def drawn_figures(figures_are_not_laid_out):
    """Draw the figures of pages after all, for wide screens: what they say is asserted."""
    with wide_only():
        yield
