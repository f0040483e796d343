"""Laws that ask several contacts for more than speed and load, in runs."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import pytest
from benchmarks.several.brakes import DiscBrake, Lining
from scipy.integrate import solve_ivp
from scipy.special import lambertw
from tests.contact_cases import Plain
from tests.friction.test_contact_inputs import GEAR, LAWS, LIFTING, VARIED, WARM
from tests.loop_cases import TRIANGLE

from stickslip import (
    BlockChain,
    Coulomb,
    EventDriven,
    FixedStep,
    SpringBlock,
    TwoFeet,
    TwoLinkArm,
    TwoMassAxis,
    simulate,
)
from stickslip.errors import InputError, SimulationError
from stickslip.friction import law
from stickslip.maths import cos, sin
from stickslip.mechanisms import Contact, gear_inputs, given_inputs
from stickslip.mechanisms.drives import Ramp, Sampled, Sine
from stickslip.quantities import Quantity

PLAIN, COMPILED = EventDriven(tier="python"), EventDriven(tier="compiled")
SWING = Sine(amplitude=1.1, frequency=0.25) + Sine(amplitude=0.45, frequency=0.9)
"""The drive of `LIFTING`."""
BENT = {"shoulder": 1.2, "elbow": 0.8}


@dataclass(frozen=True, kw_only=True)
class Servos(Plain):
    """Pendulums with a motor each, which know nothing of each other."""

    name: ClassVar[str] = "servos"
    coordinates: ClassVar[tuple[str, ...]] = ("a", "b", "c")
    rates: ClassVar[tuple[str, ...]] = ("a_dot", "b_dot", "c_dot")
    units: ClassVar[tuple[str, ...]] = ("rad",) * 3
    mass: Annotated[float, Quantity("m", "kg", above=0)] = 0.5
    length: Annotated[float, Quantity("l", "m", above=0)] = 0.16

    def kinetic_energy(self, q, q_dot):
        each = (self.length * q_dot[x] for x in self.coordinates)
        return 0.5 * self.mass * sum((v * v for v in each), 0.0)

    def potential_energy(self, t, q):
        lever = self.mass * 9.81 * self.length
        return -lever * sum((cos(q[x]) for x in self.coordinates), 0.0)

    def drives(self):
        return {"drive": SWING}

    def forces(self, t, q, q_dot, drives):
        return dict.fromkeys(self.coordinates, drives["drive"])

    def contacts(self):
        return tuple(Contact(slip=x, load=1.0, name=x) for x in self.coordinates)

    def contact_inputs(self, t, q, q_dot, drives):
        weights = {x: -self.mass * 9.81 * self.length * sin(q[x]) for x in self.coordinates}
        return {
            x: gear_inputs(drives["drive"], weight, gravity=weight, position=q[x])
            for x, weight in weights.items()
        }


@pytest.mark.parametrize("name", LAWS)
def test_contacts_that_know_nothing_of_each_other_do_what_each_does_alone(name):
    alone = simulate(LIFTING, LAWS[name], t_end=3.0, solver=COMPILED)
    run = simulate(Servos(), LAWS[name], t_end=3.0, solver=COMPILED)
    assert run.certificate.certified
    for x in Servos.coordinates:
        # the equations are rounded in another order: 3e-13 and 6e-12 s were seen
        assert run[x][-1] == pytest.approx(alone["theta"][-1], rel=1e-11)
        mine = [event for event in run.events if event.contact == x]
        assert [event.reason for event in mine] == [event.reason for event in alone.events]
        times = [event.t for event in alone.events]
        assert [event.t for event in mine] == pytest.approx(times, abs=1e-10)


ARM = TwoLinkArm(
    upper_mass=1.0, upper_length=0.4, upper_centre=0.2, upper_inertia=0.06,
    lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03,
    elbow_drive=Sine(amplitude=1.5, frequency=0.8),
)  # fmt: skip
OF_ARM = LAWS | {"bristles": replace(LAWS["bristles"], gravity_slope=0.05)}  # it is heavier


@pytest.mark.parametrize("name", LAWS)
def test_joints_of_an_arm_with_inputs_are_certified_and_sensitivities_agree_with_differences(name):
    laws = {"shoulder": OF_ARM[name], "elbow": replace(GEAR, viscous_coefficient=0.02)}
    settings = {"t_end": 2.0, "y0": BENT, "solver": COMPILED}
    run = simulate(ARM, laws, **settings)
    assert run.certificate.certified
    for contact, field in (("shoulder", VARIED[name]), ("elbow", "transmitted_coefficient")):
        one, h = laws[contact], 1e-6
        value = getattr(one, field)
        ends = [
            simulate(ARM, laws | {contact: replace(one, **{field: value + d})}, **settings)
            for d in (h, -h)
        ]
        for x in ("shoulder", "elbow"):
            slope = run.sensitivity(x, f"friction.{contact}.{field}")[-1]
            # differences keep about half of the digits of a run with tolerances of 1e-10
            expected = (ends[0][x][-1] - ends[1][x][-1]) / (2.0 * h)
            assert slope == pytest.approx(expected, rel=1e-3, abs=1e-6)
    h = 1e-6
    ends = [simulate(replace(ARM, lower_mass=0.5 + d), laws, **settings) for d in (h, -h)]
    slope = run.sensitivity("elbow", "mechanism.lower_mass")[-1]  # through gravity and inertia
    expected = (ends[0]["elbow"][-1] - ends[1]["elbow"][-1]) / (2.0 * h)
    assert slope == pytest.approx(expected, rel=1e-3)


BRAKE = DiscBrake(
    inertia=0.5,
    drive=Sine(amplitude=3.0, frequency=0.7),
    pads=(Lining(radius=0.1, load=60.0), Lining(radius=0.12, load=40.0)),
)


def test_the_levels_of_pads_at_rest_move_with_the_torque_through_0():
    # together 0.1 (6 + 4.8) + 0.005 |tau| (60 + 40), as |tau| is over each radius and back
    grows = law("level + weight[motor]")(kinetic_coefficient=0.1, motor_coefficient=0.005)
    run = simulate(BRAKE, grows, t_end=3.0, solver=COMPILED)
    first = run.events[0]
    assert first.t == pytest.approx(math.asin(1.08 / 0.5 / 3.0) / (1.4 * math.pi), rel=1e-12)
    assert first.contact == "pad-1"
    assert run.certificate.certified
    # a level that outgrows the torque holds, whatever the sign
    holds = replace(grows, motor_coefficient=0.012)
    held = simulate(BRAKE, holds, t_end=3.0, solver=COMPILED)
    assert not held.events
    assert not held["phi"].any()
    assert held.certificate.certified


def test_a_temperature_that_jumps_is_met_at_each_contact_that_has_it():
    chain = given_inputs(
        BlockChain(blocks=2, mass=2.0, coupling=0.0),
        {"temperature": Sampled(times=[0.0, 0.1], values=[0.0, 60.0])},
    )
    run = simulate(chain, WARM, t_end=0.3, y0={"v1": 1.0, "v2": -1.0}, solver=COMPILED)
    v = 1.0
    for c, span in ((10.0, 0.1), (10.0 * math.exp(-1.8), 0.2)):
        v = (v + 2.0 / c) * math.exp(-c / 2.0 * span) - 2.0 / c
    assert run["v1"][-1] == pytest.approx(v, rel=1e-9)
    assert run["v2"][-1] == -run["v1"][-1]


def test_a_factor_that_falls_towards_0_ends_a_run_with_the_name_of_the_contact():
    cold = law("level + viscous * linear[temperature]")(
        kinetic_coefficient=1.0, viscous_coefficient=1.0, viscous_temperature_slope=-0.05
    )
    chain = given_inputs(
        BlockChain(blocks=2, mass=1.0, coupling=0.1), {"temperature": Ramp(rate=40.0)}
    )
    laws = {"block-1": Coulomb(kinetic_coefficient=0.2), "block-2": cold}
    run = simulate(chain, laws, t_end=3.0, y0={"v1": 1.0}, throw=False)
    assert run.events[-1].reason == "block-2: viscous * linear[temperature] falls below 0.001"
    assert run.span[1] == pytest.approx(0.4995, abs=1e-9)  # 1 - 0.05 * 40 t = 0.001
    with pytest.raises(SimulationError, match=r"at t = 0\.5 s, block-2: .* use EventDriven"):
        simulate(chain, laws, t_end=3.0, y0={"v1": 1.0}, solver=FixedStep(dt=1e-3))
    with pytest.raises(SimulationError, match=r"block-2: viscous \* linear\[temperature\] falls"):
        simulate(chain, laws, t_end=3.0, y0={"v1": 1.0})


def test_an_input_that_a_contact_lacks_is_refused_with_its_name():
    laws = {"shoulder": WARM, "elbow": GEAR}
    with pytest.raises(InputError, match=r"'temperature', which TwoLinkArm at 'shoulder' does not"):
        simulate(ARM, laws, t_end=1.0)


def test_feet_whose_loads_are_reactions_have_inputs_as_a_block_has():
    # without height both feet carry half; the levels rise and fall along the ground
    rough = law("level * ripple[position]")(
        kinetic_coefficient=0.2,
        level_position_cosine=0.4,
        level_position_sine=0.0,
        level_position_harmonic=20.0,
    )
    body = TwoFeet(mass=1.0, front=0.2, rear=0.2)
    run = simulate(body, rough, t_end=2.0, y0={"v": 1.0}, solver=COMPILED)
    alone = simulate(SpringBlock(mass=1.0), rough, t_end=2.0, y0={"v": 1.0}, solver=COMPILED)
    assert run["x"][-1] == pytest.approx(alone["x"][-1], rel=1e-9)
    high = replace(body, height=0.1)
    both = {"front": rough, "rear": replace(rough, level_position_cosine=-0.4)}
    tilted = simulate(high, both, t_end=2.0, y0={"v": 1.0}, solver=COMPILED)
    assert tilted.certificate.certified
    h = 1e-6
    ends = [
        simulate(replace(high, height=0.1 + d), both, t_end=0.2, y0={"v": 1.0})["x"][-1]
        for d in (h, -h)
    ]
    slope = simulate(high, both, t_end=0.2, y0={"v": 1.0}).sensitivity("x", "mechanism.height")[-1]
    assert slope == pytest.approx((ends[0] - ends[1]) / (2.0 * h), rel=1e-3)


def test_clutches_of_a_loop_that_warm_up_let_go_where_their_fading_levels_say():
    # at constant levels two of them go at 4.2 N m; all fade as exp(-0.2 t), the torque is t
    fading = law("level * exponential[temperature]")
    levels = {
        name: fading(kinetic_coefficient=level, level_temperature_decay=0.01)
        for name, level in {"c0": 2.0, "c1": 3.0, "c2": 1.5}.items()
    }
    rotors = TRIANGLE(J0=1.0, J1=2.0, J2=3.0, R0=1.0)
    warming = given_inputs(rotors, {"temperature": Ramp(rate=20.0)})
    for solver in (PLAIN, COMPILED):
        run = simulate(warming, levels, t_end=3.0, solver=solver)
        assert [(event.contact, event.to_mode) for event in run.events] == [("c0", 1), ("c2", 1)]
        expected = 5.0 * lambertw(0.84).real
        assert [event.t for event in run.events] == pytest.approx([expected] * 2, rel=1e-12)
        assert run.certificate.certified


@pytest.mark.slow
def test_both_sides_of_a_belt_agree_with_a_regularised_reference():
    rig = TwoMassAxis(
        motor_inertia=0.4, load_inertia=0.7, stiffness=60.0, damping=0.5, offset=0.6,
        drive=Sine(amplitude=3.0, frequency=0.8), rubs="both",
    )  # fmt: skip
    load = replace(
        GEAR, kinetic_coefficient=0.3, static_coefficient=0.5, transmitted_coefficient=0.1
    )
    motor = replace(GEAR, kinetic_coefficient=0.2, static_coefficient=0.25)
    run = simulate(rig, {"load": load, "motor": motor}, t_end=3.0, solver=COMPILED)
    assert run.certificate.certified

    def rate(t, y, width):
        x, other, v, w = y
        torque = 3.0 * np.sin(1.6 * np.pi * t)
        wound = 60.0 * (other - x) + 0.5 * (w - v)

        def friction(law, v, transmitted):
            fades = np.exp(-((v / law.stribeck_velocity) ** 2))
            level = law.kinetic_coefficient + law.transmitted_coefficient * abs(transmitted)
            level += (law.static_coefficient - law.kinetic_coefficient) * fades
            return level * np.tanh(v / width) + law.viscous_coefficient * v

        pulled = wound - 0.6 - friction(load, v, wound + 0.6)
        return [v, w, pulled / 0.7, (torque - wound - friction(motor, w, torque + wound)) / 0.4]

    found = [
        solve_ivp(rate, (0.0, 3.0), [0.0] * 4, "Radau", args=(w,), rtol=1e-9, atol=1e-11).y[:, -1]
        for w in (4e-4, 5e-5)
    ]
    for place, x in enumerate(("x", "other")):
        error = abs(found[1][place] - run[x][-1])
        # the reference creeps by what it rounds off: an eighth of that leaves less
        assert error < abs(found[0][place] - run[x][-1])
        assert error < 1e-4
