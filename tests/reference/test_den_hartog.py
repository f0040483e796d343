"""Den Hartog 1931: forced vibrations with Coulomb friction, motion without stops."""

import math

import numpy as np
import pytest
from scipy.optimize import root

from stickslip import Axis, Coulomb, simulate
from stickslip.mechanisms.drives import Sine

# ratio of frequencies, ratio of friction to force, amplitude times k / P
TABLE = [
    (0.8, 0.2, 2.711415),
    (0.8, 0.4, 2.501788),
    (0.8, 0.6, 2.106551),
    (1.2, 0.2, 2.185954),
    (1.2, 0.4, 1.902028),
    (1.2, 0.6, 1.297397),
    (1.5, 0.2, 0.765942),
    (1.5, 0.4, 0.653197),
    (1.5, 0.6, 0.400000),
]


def amplitude(b, ratio):
    V = 1 / (1 - b * b)
    U = math.sin(math.pi / b) / (b * (1 + math.cos(math.pi / b)))
    return math.sqrt(V * V - (ratio * U) ** 2)


@pytest.mark.parametrize(("b", "ratio", "printed"), TABLE)
def test_the_closed_form_gives_the_printed_amplitude(b, ratio, printed):
    assert math.isclose(amplitude(b, ratio), printed, abs_tol=5.1e-7)


def half_cycle(b, ratio, start, phase):
    """Return the state after half a period of the force, from a turning point."""
    force = Sine(amplitude=1.0, frequency=b / math.tau, phase=phase)
    axis = Axis(inertia=1.0, stiffness=1.0, drive=force)
    law = Coulomb(kinetic_coefficient=ratio)
    run = simulate(axis, law, t_end=math.pi / b, y0={"x": start})
    return run["x"][-1], run["v"][-1]


@pytest.mark.parametrize(("b", "ratio", "printed"), TABLE)
def test_the_symmetric_cycle_has_the_amplitude_of_the_closed_form(b, ratio, printed):
    def miss(unknown):
        x, v = half_cycle(b, ratio, *unknown)
        return [x + unknown[0], v]

    guesses = [(printed, phase) for phase in np.linspace(0.0, math.tau, 24, endpoint=False)]
    guess = min(guesses, key=lambda unknown: math.hypot(*miss(unknown)))
    found = root(miss, guess, tol=1e-12)
    assert math.hypot(*miss(found.x)) < 1e-9
    # the miss, multiplied by the ten or so of its sensitivity
    assert math.isclose(found.x[0], amplitude(b, ratio), abs_tol=1e-8)


def test_a_run_from_rest_settles_on_the_symmetric_cycle():
    axis = Axis(inertia=1.0, stiffness=1.0, drive=Sine(amplitude=1.0, frequency=1.5 / math.tau))
    run = simulate(axis, Coulomb(kinetic_coefficient=0.4), t_end=400.0)
    (last,) = run.at(run.events[-1].t)["x"]
    assert math.isclose(abs(last), 0.653197, abs_tol=1e-6)  # known digits
