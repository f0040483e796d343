"""Den Hartog 1931: forced vibrations with Coulomb friction, motion without stops."""

import math

import numpy as np
import pytest

from stickslip import Axis, Coulomb, Sine, simulate

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


@pytest.mark.parametrize(("b", "ratio", "printed"), TABLE)
def test_the_steady_amplitude_is_that_of_the_closed_form(b, ratio, printed):
    axis = Axis(inertia=1.0, stiffness=1.0, drive=Sine(amplitude=1.0, frequency=b / math.tau))
    run = simulate(axis, Coulomb(kinetic_coefficient=ratio), t_end=500.0)
    turns = [event.t for event in run.events[-200:]]
    assert all(event.reason == "reversal" for event in run.events[-10:])
    peaks = np.abs(run.at(turns)["x"])
    # what is left of the transient alternates, decays, and averages out over whole beats
    assert math.isclose(peaks[-1], amplitude(b, ratio), abs_tol=1e-4)
    assert math.isclose(peaks[-1], printed, abs_tol=1e-4)
