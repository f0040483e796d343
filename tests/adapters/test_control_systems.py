"""python-control on the equations of the engine, and describing functions against closed forms."""

import dataclasses
import math
from typing import Annotated, ClassVar

import control
import numpy as np
import pytest
from tests.solver.test_loops import Turned

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    LuGre,
    PendulumCart,
    Stribeck,
    TwoFeet,
    TwoMassAxis,
    simulate,
)
from stickslip.errors import InputError
from stickslip.exports.adapters import to_describing_function, to_nonlinear_system
from stickslip.friction import bound, law
from stickslip.mechanisms import Contact, Mechanism, Prescribed, given_inputs
from stickslip.mechanisms.drives import Drive, Sampled, Sine, ThreePhase
from stickslip.quantities import Quantity


@dataclasses.dataclass(frozen=True, kw_only=True)
class Pushed(Mechanism):
    """Two shafts with a clutch between them, one of which rubs on a floor too."""

    name: ClassVar[str] = "pushed"
    coordinates: ClassVar[tuple[str, ...]] = ("phi1", "phi2")
    rates: ClassVar[tuple[str, ...]] = ("w1", "w2")
    units: ClassVar[tuple[str, ...]] = ("rad", "rad")
    load: Annotated[float, Quantity("N_f", "N")] = 3.0
    drive: Drive | None = None

    def kinetic_energy(self, q, q_dot):
        return 0.5 * (q_dot["phi1"] * q_dot["phi1"] + 2.0 * q_dot["phi2"] * q_dot["phi2"])

    def potential_energy(self, t, q):
        return 0.0

    def drives(self):
        return {"drive": self.drive or Sampled(times=(0.0,), values=(0.0,))}

    def forces(self, t, q, q_dot, drives):
        return {"phi1": drives["drive"]}

    def contacts(self):
        return (
            Contact(name="clutch", slip={"phi1": 1.0, "phi2": -1.0}, load=2.0),
            Contact(name="floor", slip="phi2", load=self.load),
        )


AXIS = Axis(inertia=5.0, stiffness=40.0)
LAW = CoulombViscous(kinetic_coefficient=5.0, viscous_coefficient=30.0)


# of python-control 0.10.2 itself, with NumPy from 2.5 on
@pytest.mark.filterwarnings("ignore:Setting the shape:DeprecationWarning:control")
@pytest.mark.parametrize("amplitude", [1e-3, 0.5, 40.0])
def test_the_describing_function_of_coulomb_friction_is_that_of_a_relay(amplitude):
    friction = to_describing_function(Coulomb(kinetic_coefficient=0.2), load=10.0)
    level = 2.0
    closed = 4.0 * level / (math.pi * amplitude)
    assert friction.describing_function(amplitude) == pytest.approx(closed, rel=1e-12)
    (found,) = control.describing_function(friction, [amplitude])
    assert found == pytest.approx(closed, rel=1e-12)
    # its own quadrature takes 100 points a period, of which a jump hits two
    (theirs,) = control.describing_function(friction, [amplitude], try_method=False)
    assert theirs.real == pytest.approx(closed, rel=0.01)


def test_viscous_friction_adds_its_slope():
    friction = to_describing_function(LAW)
    closed = 4.0 * 5.0 / (math.pi * 0.3) + 30.0
    assert friction.describing_function(0.3) == pytest.approx(closed, rel=1e-12)


def test_a_stribeck_dip_far_below_the_amplitude_is_not_missed():
    law = Stribeck(kinetic_coefficient=1.0, static_coefficient=3.0, stribeck_velocity=1e-6)
    found = to_describing_function(law).describing_function(1.0)
    # the dip adds 4 / (pi A) times the integral of 2 exp(-(A phi / v_s)^2) phi, 1e-12 at most
    assert found == pytest.approx(4.0 / math.pi, rel=1e-11)
    wide = Stribeck(kinetic_coefficient=1.0, static_coefficient=3.0, stribeck_velocity=0.3)
    phi = (np.arange(200_000) + 0.5) * (math.pi / 2.0 / 200_000)
    mean = np.mean([wide.force(math.sin(p), 1.0) * math.sin(p) for p in phi[::100]])
    assert to_describing_function(wide).describing_function(1.0) == pytest.approx(
        2.0 * mean, rel=1e-3
    )


def test_python_control_finds_the_limit_of_a_loop_with_friction():
    s = control.tf("s")
    friction = to_describing_function(Coulomb(kinetic_coefficient=0.2), load=10.0)
    # velocity from force of a mass on a spring whose damping, -0.2 N s/m, is negative
    plant = s / (s**2 - 0.2 * s + 4.0)
    found = control.describing_function_response(
        plant, friction, np.geomspace(1.0, 100.0, 400), warn_nyquist=False
    )
    ((amplitude, frequency),) = found.intersections
    # both dampings cancel where 4 F / (pi A) is 0.2 N s/m; A lies on a grid, and chords err by 1e-2
    assert amplitude == pytest.approx(4.0 * 2.0 / (math.pi * 0.2), rel=1e-2)
    assert frequency == pytest.approx(2.0, rel=1e-2)


def test_slip_is_that_of_the_engine():
    force = Sine(amplitude=20.0, frequency=0.5, phase=math.pi / 2)
    system = to_nonlinear_system(AXIS, LAW, speed=1e-6)
    t = np.linspace(0.0, 0.15, 31)
    found = control.input_output_response(
        system, t, np.array([force.value(x) for x in t]), [0.0, 0.5],
        solve_ivp_kwargs={"rtol": 1e-10, "atol": 1e-12},
    )  # fmt: skip
    run = simulate(Axis(inertia=5.0, stiffness=40.0, drive=force), LAW, t_end=0.15, y0={"v": 0.5})
    seen = run.at(t)
    assert (seen["v"] > 1e-3).all()
    # between its samples python-control takes straight lines of the force: 20 (w dt)^2 / 8 N
    np.testing.assert_allclose(found.outputs, [seen["x"], seen["v"]], atol=1e-4)


FEET = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15, stiffness=50.0)
COULOMB = Coulomb(kinetic_coefficient=0.1)
BRISTLES = LuGre(
    kinetic_coefficient=0.1, static_coefficient=0.12, stribeck_velocity=0.05,
    bristle_stiffness=1e3, bristle_damping=10.0,
)  # fmt: skip
MASSES = TwoMassAxis(motor_inertia=0.5, load_inertia=1.5, stiffness=200.0, damping=0.5, rubs="both")
SEVERAL = {
    "reactions": (FEET, COULOMB, {"v": 2.0}),
    "bristles": (FEET, {"front": COULOMB, "rear": BRISTLES}, {"v": 2.0}),
    "two masses": (MASSES, LAW, {"v": 2.0, "other_dot": 2.5}),
    "slips that are sums": (Pushed(), {"clutch": Stribeck(
        kinetic_coefficient=0.4, static_coefficient=0.6, stribeck_velocity=0.5
    ), "floor": COULOMB}, {"w1": 4.0, "w2": 1.0}),
}  # fmt: skip


@pytest.mark.parametrize("case", SEVERAL)
def test_slip_of_several_contacts_is_that_of_the_engine(case):
    mechanism, law, start = SEVERAL[case]
    push, end = 1.5, 0.02
    driven = dataclasses.replace(mechanism, drive=Sampled(times=(0.0,), values=(push,)))
    system = to_nonlinear_system(mechanism, law, speed=1e-6)
    run = simulate(driven, law, t_end=end, y0=start)
    begin = [run[name][0] for name in system.state_labels]
    t = np.linspace(0.0, end, 11)
    found = control.input_output_response(
        system, t, np.full(11, push), begin, solve_ivp_kwargs={"rtol": 1e-9, "atol": 1e-11}
    )
    seen = run.at(t)
    assert not any(event.from_mode != event.to_mode for event in run.events)  # all slip
    np.testing.assert_allclose(
        found.outputs, [seen[name] for name in system.state_labels], rtol=1e-7, atol=1e-9
    )


def test_slips_of_a_loop_are_those_of_the_engine():
    loop = Turned(J0=1.0, J1=2.0, J2=3.0)
    laws = {f"c{i}": Coulomb(kinetic_coefficient=level) for i, level in enumerate((2.0, 3.0, 1.5))}
    system = to_nonlinear_system(loop, laws, speed=1e-6)
    t, start = np.linspace(0.0, 0.2, 11), {"v0": 6.0, "v1": 3.0}
    push = Sampled(times=(0.0,), values=(1.5,))
    run = simulate(dataclasses.replace(loop, torque=push), laws, t_end=0.2, y0=start)
    assert not run.events  # all slip, the closing one too
    begin = [run[name][0] for name in system.state_labels]
    found = control.input_output_response(
        system, t, np.full(11, 1.5), begin, solve_ivp_kwargs={"rtol": 1e-9, "atol": 1e-11}
    )
    seen = run.at(t)
    np.testing.assert_allclose(
        found.outputs, [seen[name] for name in system.state_labels], rtol=1e-7, atol=1e-9
    )


def test_a_contact_whose_load_is_gone_does_not_rub():
    def rate(load):
        system = to_nonlinear_system(dataclasses.replace(Pushed(), load=load), COULOMB)
        return system.dynamics(0.0, [0.0, 0.0, 4.0, 1.0], [0.0])

    np.testing.assert_array_equal(rate(-1.0), rate(0.0))
    assert rate(1.0)[3] < rate(0.0)[3]


def test_what_friction_holds_at_several_contacts_creeps():
    system = to_nonlinear_system(FEET, COULOMB, speed=1e-3)
    # feet on the ground at rest: loads 7.848 and 11.772 N, and a push of half of what breaks away
    push = 0.05 * 2.0 * 9.81
    assert system.dynamics(0.0, [0.0, 0.5e-3], [push]) == pytest.approx([0.5e-3, 0.0], abs=1e-12)


def test_a_held_body_creeps_no_faster_than_told():
    speed = 1e-3
    system = to_nonlinear_system(Axis(inertia=5.0), LAW, speed=speed)
    t = np.linspace(0.0, 2.0, 41)
    found = control.input_output_response(system, t, np.full(41, 4.0), [0.0, 0.0])
    # 4 of 5 N: 0.8 of the line between the two directions, of which 30 N s/m is a little
    creep = 4.0 / ((5.0 + 30.0 * speed) / speed)
    # python-control's tolerance is 1e-3
    assert found.outputs[1][-1] == pytest.approx(creep, rel=2e-3)
    assert 0.0 < creep < speed


def test_a_linearisation_has_damping_and_stiffness():
    found = control.linearize(to_nonlinear_system(AXIS, LAW), [0.1, 0.2], [0.0])
    np.testing.assert_allclose(found.A, [[0.0, 1.0], [-8.0, -6.0]], atol=1e-6)
    np.testing.assert_allclose(found.B, [[0.0], [0.2]], atol=1e-9)


def test_bristles_are_smooth_without_help_and_drives_add_up():
    law = LuGre(
        kinetic_coefficient=5.0, static_coefficient=6.0, stribeck_velocity=0.01,
        bristle_stiffness=1e4, bristle_damping=100.0,
    )  # fmt: skip
    pushed = Axis(inertia=5.0, drive=Sampled(times=(0.0,), values=(3.0,)))
    rates = [
        to_nonlinear_system(axis, law).dynamics(0.0, [0.0, 0.01, 1e-4], [u])
        for axis, u in ((pushed, 0.0), (Axis(inertia=5.0), 3.0))
    ]
    np.testing.assert_allclose(*rates, rtol=1e-12)
    assert len(rates[0]) == 3


def test_a_cart_has_its_inputs_and_outputs_by_name():
    cart = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3)
    system = to_nonlinear_system(cart, Coulomb(kinetic_coefficient=0.2), name="cart")
    assert system.name == "cart"
    assert system.input_labels == ["pendulum_drive"]
    assert system.output_labels == ["x", "theta", "v", "omega"]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: to_nonlinear_system(AXIS, LAW, speed=0.0), "speed"),
        (lambda: to_nonlinear_system(AXIS, LAW, drive="pull"), "drive"),
        (
            lambda: to_nonlinear_system(
                PendulumCart(
                    cart_mass=0.5, ball_mass=0.1, length=0.3,
                    pendulum=Prescribed(profile=ThreePhase(amplitude=0.5, fast=100.0, slow=30.0)),
                ),
                LAW,
            ),
            "prescribed",
        ),
        (
            lambda: to_nonlinear_system(FEET, dataclasses.replace(BRISTLES, static_switch=True)),
            "'front' has static_switch=True: leave it out",
        ),
        (lambda: to_describing_function(LAW, load=-1.0), "load"),
        (lambda: to_describing_function(LAW).describing_function(0.0), "amplitude"),
        (lambda: to_describing_function("coulomb"), "law"),
        (
            lambda: to_describing_function(
                LuGre(
                    kinetic_coefficient=5.0, static_coefficient=6.0, stribeck_velocity=0.01,
                    bristle_stiffness=1e4, bristle_damping=100.0,
                )
            ),
            "bristles",
        ),
    ],
)  # fmt: skip
def test_what_is_no_such_system_is_refused(make, words):
    with pytest.raises(InputError, match=words):
        make()


def test_a_describing_function_is_that_of_one_value_of_each_contact_input():
    gear = law("level + weight[transmitted]")(kinetic_coefficient=0.2, transmitted_coefficient=0.1)
    with pytest.raises(InputError, match="depends on transmitted"):
        to_describing_function(gear, load=10.0)
    told = bound(gear, {"transmitted": -3.0})
    found = to_describing_function(told, load=10.0).describing_function(0.5)
    assert found == pytest.approx(4.0 * (0.2 + 0.3) * 10.0 / (math.pi * 0.5), rel=1e-9)


def test_a_system_has_the_contact_inputs_of_its_mechanism():
    warm = law("level + viscous * exponential[temperature]")(
        kinetic_coefficient=0.1, viscous_coefficient=0.12, viscous_temperature_decay=0.03
    )
    with pytest.raises(InputError, match="which Axis does not tell"):
        to_nonlinear_system(Axis(inertia=2.0), warm)
    system = to_nonlinear_system(given_inputs(Axis(inertia=2.0), {"temperature": 30.0}), warm)
    rate = system.dynamics(0.0, np.array([0.0, 0.5]), np.array([0.0]))
    friction = bound(warm, {"temperature": 30.0}).force(0.5, 1.0)
    assert rate[1] == pytest.approx(-friction / 2.0, rel=1e-12)
