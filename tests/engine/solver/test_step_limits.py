"""What a run that reaches its step limit says of the cause."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

import pytest
from tests.contact_cases import coulomb

from stickslip import (
    Axis,
    BlockChain,
    Coulomb,
    EventDriven,
    LuGre,
    Stribeck,
    TowedBlock,
    TwoLinkArm,
    TwoMassAxis,
    Viscous,
    simulate,
)
from stickslip.engine import Status
from stickslip.engine.formulation import formulate
from stickslip.engine.solver.event_driven import fastest_motion
from stickslip.engine.solver.run import execute
from stickslip.engine.solver.starts import gather, within_stops
from stickslip.errors import InputError, SimulationError
from stickslip.maths import where
from stickslip.mechanisms import Contact, Mechanism
from stickslip.mechanisms.drives import Sine
from stickslip.quantities import Quantity
from stickslip.show.formatting import quantity

FEW = EventDriven(max_steps=20, tier="python")
LAYER = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.01)
BRISTLES = LuGre(
    kinetic_coefficient=1.0,
    static_coefficient=1.5,
    stribeck_velocity=0.1,
    bristle_stiffness=1e15,
    bristle_damping=0.0,
)


FEW_OF_A_RIDGE = EventDriven(max_steps=2000, tier="python")


@final
@dataclass(frozen=True, kw_only=True)
class Ridge(Mechanism):
    """A body that is driven back to where place and speed add up to zero."""

    name: ClassVar[str] = "ridge"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)

    push: Annotated[float, Quantity("F", "N", low=0)]

    def kinetic_energy(self, q, q_dot):
        return 0.5 * q_dot["x"] * q_dot["x"]

    def potential_energy(self, t, q):
        return 0.0

    def forces(self, t, q, q_dot, drives):
        right = q["x"] + q_dot["x"] > 0
        return {
            "x": where(right, -self.push, self.push, ("right of the ridge", "left of the ridge"))
        }

    def contacts(self):
        return (Contact(slip="x", load=1.0),)

    def drives(self):
        return {}


def fastest_of(mechanism, law, y0):
    model = formulate(mechanism, law)
    inputs = gather(mechanism, law, model, 10.0)
    start = within_stops(mechanism, y0)
    record = execute(model, inputs, start, t_end=10.0, tolerance=1e-9, limit=20, tier="python")
    return fastest_motion(model, inputs, record)


@pytest.mark.parametrize("mode", ["sliding", "held"])
def test_masses_on_a_spring_have_the_time_scale_of_the_textbook(mode):
    m1, m2, k = 1e-7, 3e-7, 1e13
    axis = TwoMassAxis(motor_inertia=m1, load_inertia=m2, stiffness=k, damping=0.0)
    found = fastest_of(axis, Viscous(viscous_coefficient=0.0), [0.0, 0.0, float(mode[0] == "s"), 0])
    assert found.time_scale == pytest.approx(math.sqrt(m1 * m2 / (m1 + m2) / k), rel=1e-6)
    powers = dict(found.influences)
    # half the logarithm of m1 m2 / (m1 + m2) / k
    assert powers["mechanism.stiffness"] == pytest.approx(-0.5, rel=1e-5)
    assert powers["mechanism.motor_inertia"] == pytest.approx(0.5 * m2 / (m1 + m2), rel=1e-5)
    assert powers["mechanism.load_inertia"] == pytest.approx(0.5 * m1 / (m1 + m2), rel=1e-5)


def test_blocks_in_a_row_have_the_time_scale_of_their_highest_mode():
    chain = BlockChain(blocks=3, mass=2.0, coupling=1e9)
    found = fastest_of(chain, coulomb(0.5), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
    assert found.time_scale == pytest.approx(math.sqrt(2.0 / 3e9), rel=1e-6)
    assert dict(found.influences) == {
        "mechanism.coupling": pytest.approx(-0.5, rel=1e-5),
        "mechanism.mass": pytest.approx(0.5, rel=1e-5),
    }


def test_a_run_that_ends_at_its_limit_names_the_parameters_and_a_cure():
    tow = TowedBlock(mass=2.0, stiffness=2.0, speed=0.1, load=1.0)
    with pytest.raises(SimulationError) as caught:
        simulate(tow, BRISTLES, t_end=60.0, solver=FEW)
    # sqrt(m / (sigma_0 N))
    assert "time scale of 0.045 µs" in str(caught.value)
    assert "friction.bristle_stiffness = 1 × 10¹⁵ 1/m" in str(caught.value)
    assert "mechanism.mass = 2 kg" in str(caught.value)
    assert "max_steps" in str(caught.value)
    run = simulate(tow, BRISTLES, t_end=60.0, solver=FEW, throw=False)
    assert run.ending == f"{Status.STEP_LIMIT.value} {run.cause}"
    assert "bristle_stiffness" in repr(run._summary().sentence)


def test_a_drive_that_is_faster_than_all_motion_is_named_instead():
    axis = Axis(inertia=1.0, drive=Sine(amplitude=5.0, frequency=1e6))
    run = simulate(axis, LAYER, t_end=60.0, solver=FEW, throw=False)
    assert "A drive changes within" in run.cause


def test_a_run_whose_switches_lead_back_to_each_other_names_them():
    ridge = Ridge(push=1.0)
    weak = Coulomb(kinetic_coefficient=0.01)
    run = simulate(ridge, weak, t_end=2.0, y0={"x": 1.0}, solver=FEW_OF_A_RIDGE, throw=False)
    assert run.status is Status.ZENO
    assert "right of the ridge and left of the ridge" in run.cause or (
        "left of the ridge and right of the ridge" in run.cause
    )
    assert f"At {quantity(run.span[1], 's', 4)} " in run.cause


def test_a_run_without_a_step_short_enough_says_where():
    axis = Axis(inertia=1e-100, stiffness=1e100)
    run = simulate(axis, LAYER, t_end=1.0, y0={"x": 1e200}, solver=FEW, throw=False)
    assert run.status is Status.STEP_TOO_SMALL
    assert "That was at 0 s. Rates of states there are no finite numbers" in run.ending


def test_a_link_whose_inertia_is_about_its_centre_is_found_in_the_mass_matrix():
    arm = TwoLinkArm(
        upper_mass=1.0,
        upper_length=0.3,
        upper_centre=0.15,
        upper_inertia=0.01,
        lower_mass=0.5,
        lower_centre=0.1,
        lower_inertia=0.004,  # about the elbow it is at least 0.005
    )
    with pytest.raises(InputError, match=r"must be positive definite.*about its joint is at"):
        simulate(arm, Coulomb(kinetic_coefficient=0.1), t_end=1.0, y0=(1.0, 0, 0, 0))
