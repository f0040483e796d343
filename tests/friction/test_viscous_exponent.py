"""Bristles beside a viscous part that grows with a power of the speed."""

import math

import numpy as np
import pytest

from stickslip import Axis, Dahl, LuGre, simulate
from stickslip.engine.formulation import formulate
from stickslip.errors import ParameterError
from stickslip.friction.parts.flows import PLATEAU
from stickslip.mechanisms.drives import PiecewiseLinear, Sine
from stickslip.quantities import parameters, structure

DAHL = Dahl(kinetic_coefficient=0.4, bristle_stiffness=200.0, viscous_coefficient=0.7)
LUGRE = LuGre(
    kinetic_coefficient=0.4,
    static_coefficient=0.5,
    stribeck_velocity=0.01,
    bristle_stiffness=200.0,
    bristle_damping=0.5,
    viscous_coefficient=0.7,
)
each = pytest.mark.parametrize("law", [DAHL, LUGRE], ids=["dahl", "lugre"])


def thinned(law, exponent):
    return type(law)(**{**vars(law), "viscous_exponent": exponent})


@each
@pytest.mark.parametrize("p", [0.2, 0.5, 1.5])
@pytest.mark.parametrize("v", [0.3, -0.3, 0.0])
def test_the_viscous_part_is_the_power_and_nothing_else_changes(law, p, v):
    dry = type(law)(**{**vars(law), "viscous_coefficient": 0.0})
    own, z = thinned(law, p), (1e-3,)
    power = math.copysign(0.7 * abs(v) ** p, v)
    # sums of the same numbers, rounded
    assert own.force(v, 5.0, z) == pytest.approx(dry.force(v, 5.0, z) + power, rel=1e-14)
    assert own.steady(v, 5.0) == pytest.approx(dry.steady(v, 5.0) + power, rel=1e-14)
    assert own.rates(v, 5.0, z) == law.rates(v, 5.0, z)
    assert own.break_away(5.0) == law.break_away(5.0)


@each
def test_below_the_plateau_it_is_a_straight_line(law):
    own = thinned(law, 0.5)
    edge = own.force(PLATEAU, 0.0, (0.0,))
    assert edge == pytest.approx(0.7 * PLATEAU**0.5, rel=1e-14)
    assert own.force(-0.25 * PLATEAU, 0.0, (0.0,)) == pytest.approx(-0.25 * edge, rel=1e-14)


@each
def test_with_the_exponent_1_the_generated_equations_do_not_know_it(law):
    paths = [path for path, _, _ in parameters(law, "friction")]
    assert "friction.viscous_exponent" not in paths
    plain, power = (formulate(Axis(inertia=1.0), one).text for one in (law, thinned(law, 0.5)))
    assert repr(PLATEAU) in power
    assert repr(PLATEAU) not in plain
    assert structure(thinned(law, 0.5)) != structure(law)
    assert structure(thinned(law, 0.5)) == structure(thinned(law, 0.7))


@each
@pytest.mark.parametrize("p", [0.19, 1.6, 0.0, -1.0])
def test_exponents_that_no_lubricant_has_are_refused(law, p):
    with pytest.raises(ParameterError, match=r"viscous_exponent \(p\) must be at least 0.2"):
        thinned(law, p)


@each
@pytest.mark.parametrize("p", [0.5, 1.5])
def test_a_pull_ends_at_the_speed_whose_power_takes_it(law, p):
    rig = Axis(inertia=1.5, drive=PiecewiseLinear(times=(0.0, 200.0), values=(1.3, 1.3)))
    run = simulate(rig, thinned(law, p), t_end=120.0)
    # what differs fades by more than 0.3 a second; steps of the stiff solver are left
    assert run["v"][-1] == pytest.approx((0.9 / 0.7) ** (1.0 / p), rel=1e-6)


@each
def test_a_run_through_reversals_keeps_the_energy_balance(law):
    rig = Axis(inertia=1.0, drive=Sine(amplitude=3.0, frequency=1.0))
    run = simulate(rig, thinned(law, 0.5), t_end=3.0)
    assert np.count_nonzero(np.diff(np.sign(run["v"]))) >= 4
    assert run.certificate.certified
    # next to the exponent 1 the motion is next to that of the linear law
    near, plain = (simulate(rig, thinned(law, p), t_end=3.0) for p in (1.0 - 1e-9, 1.0))
    t = np.linspace(0.0, 3.0, 31)
    np.testing.assert_allclose(near.at(t)["x"], plain.at(t)["x"], rtol=0, atol=1e-6)


def test_forces_and_copies_carry_it():
    made = Dahl.from_forces(
        load=2.0, kinetic_force=0.8, bristle_stiffness=400.0, viscous_exponent=0.5
    )
    assert made.viscous_exponent == 0.5
