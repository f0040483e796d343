"""Dahl's bristles with a viscous part beside them."""

import math

import numpy as np
import pytest

from stickslip import Axis, Dahl, EventDriven, load_rig, simulate
from stickslip.mechanisms.drives import Sine

VALUES = {"kinetic_coefficient": 0.4, "bristle_stiffness": 200.0}
PLAIN = Dahl(**VALUES)
WET = Dahl(**VALUES, viscous_coefficient=0.7)
RIG = """
[mechanism]
type = "axis"
inertia = 1.0
[friction.dahl.forces]
load = "2 N"
kinetic_force = "0.8 N"
bristle_stiffness = "400 N/m"
viscous_coefficient = "0.7 N s/m"
"""


@pytest.mark.parametrize("v", [0.3, -0.3, 0.0])
def test_the_force_is_the_sum_of_both_parts(v):
    z = (1e-3,)
    assert WET.force(v, 5.0, z) == PLAIN.force(v, 5.0, z) + 0.7 * v
    assert WET.steady(v, 5.0) == PLAIN.steady(v, 5.0) + 0.7 * v
    assert WET.rates(v, 5.0, z) == PLAIN.rates(v, 5.0, z)
    assert WET.break_away(5.0) == PLAIN.break_away(5.0)


def test_a_run_is_that_of_plain_bristles_and_a_damper_beside_them():
    drive = Sine(amplitude=3.0, frequency=1.0)
    solver = EventDriven(stiff_tolerance=1e-10)
    wet = simulate(Axis(inertia=1.0, drive=drive, load=2.0), WET, t_end=2.0, solver=solver)
    damped = Axis(inertia=1.0, drive=drive, load=2.0, damping=0.7)
    dry = simulate(damped, PLAIN, t_end=2.0, solver=solver)
    t = np.linspace(0.0, 2.0, 21)
    # some hundred steps of 1e-10
    np.testing.assert_allclose(wet.at(t)["x"], dry.at(t)["x"], rtol=0, atol=1e-7)
    parts = dry.at(t)["friction"] + 0.7 * dry.at(t)["v"]
    np.testing.assert_allclose(wet.at(t)["friction"], parts, rtol=0, atol=1e-6)


def test_a_rig_gives_it_among_the_forces_and_the_load_does_not_divide_it(tmp_path):
    (tmp_path / "rig.toml").write_text(RIG)
    law = load_rig(tmp_path / "rig.toml").laws["dahl"]
    assert math.isclose(law.kinetic_coefficient, 0.4)
    assert math.isclose(law.bristle_stiffness, 200.0)
    assert law.viscous_coefficient == 0.7
    made = Dahl.from_forces(
        load=2.0, kinetic_force=0.8, bristle_stiffness=400.0, viscous_coefficient=0.7
    )
    assert law == made
