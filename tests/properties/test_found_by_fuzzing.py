"""What random cases brought to light, each reduced to a few lines.

A mark of expected failure goes when its fault does.
"""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import pytest
from benchmarks.several.brakes import ClutchTrain, DiscBrake, Lining, Rotor
from tests.properties.fuzzing.campaign import time_limit
from tests.properties.fuzzing.rigs import Chain, PendulumCart, ShakenBlock
from tests.properties.fuzzing.several import Dense

from stickslip import (
    Axis,
    BlockChain,
    Coulomb,
    Dahl,
    DirectionalStribeck,
    DirectionDependent,
    EventDriven,
    LuGre,
    PowerViscous,
    QuadraticDrag,
    SpringBlock,
    Stribeck,
    TowedBlock,
    TwoLinkArm,
    Viscous,
    simulate,
)
from stickslip.engine import Status
from stickslip.friction import SetValuedLaw, law
from stickslip.maths import where
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse, Ramp, Sampled, Sine
from stickslip.quantities import Quantity

FREE = Coulomb(kinetic_coefficient=0.0)
COULOMB = Coulomb(kinetic_coefficient=1.0)


def test_a_force_that_jumps_above_break_away_and_falls_below_it_in_one_step_moves_the_body():
    drive = Pulse(level=1.5, duration=5.0, start=1.0) + Ramp(rate=-1.0, start=1.0)
    run = simulate(Axis(inertia=1.0, drive=drive), COULOMB, t_end=3.0)
    # from 1 s: v = t (0.5 - t / 2), which ends 1 s later after 1 / 12 m
    assert [event.reason for event in run.events] == ["break-away", "stop"]
    assert math.isclose(run["x"][-1], 1.0 / 12.0, rel_tol=1e-9)


def test_a_lift_that_jumps_above_the_weight_and_falls_below_it_in_one_step_lifts_the_body():
    lift = Pulse(level=20.0, duration=1.0, start=1.0) + Ramp(rate=-20.0, start=1.0)
    run = simulate(ShakenBlock(mass=1.0, lift=lift), COULOMB, t_end=3.0, throw=False)
    assert run.status is Status.LIFT_OFF
    assert run.span[1] == 1.0


def test_a_body_that_will_be_lifted_off_does_not_rest_for_good():
    lift = Pulse(level=20.0, duration=1.0, start=1.0)
    law = Viscous(viscous_coefficient=1.0)
    run = simulate(ShakenBlock(mass=1.0, lift=lift), law, t_end=3.0, throw=False)
    assert run.status is Status.LIFT_OFF


@pytest.mark.parametrize("later", [1, 3])
def test_a_jump_given_as_two_points_a_rounding_apart_is_passed(later):
    after = 1.1 + later * math.ulp(1.1)
    drive = PiecewiseLinear(times=(1.1, after), values=(0.0, 1.4))
    with time_limit(2.0):
        run = simulate(Axis(inertia=1.0, drive=drive), COULOMB, t_end=2.1)
    assert math.isclose(run["x"][-1], 0.2, rel_tol=1e-9)  # 0.4 N for a second


def test_a_free_axis_that_is_moved_from_rest_to_rest_is_certified():
    there_and_back = Pulse(level=1.0, duration=1.0) + Pulse(level=-1.0, duration=1.0, start=1.0)
    run = simulate(Axis(inertia=1.0, drive=there_and_back), FREE, t_end=2.0, throw=False)
    assert math.isclose(run["x"][-1], 1.0, rel_tol=1e-12)
    assert run.certificate.certified


def test_a_block_that_its_bristles_swing_without_loss_is_certified():
    law = LuGre(
        kinetic_coefficient=1.0, static_coefficient=1.0, stribeck_velocity=1.0,
        bristle_stiffness=300.0, bristle_damping=0.0,
    )  # fmt: skip
    run = simulate(SpringBlock(mass=1.0), law, t_end=1.0, y0={"z": 1.0}, throw=False)
    assert math.isclose(run["x"][-1], -0.99982947552, rel_tol=1e-8)  # by a tolerance of 1e-12
    assert run.certificate.certified


def test_a_held_axis_without_load_follows_a_ramp_backward():
    law = Dahl(kinetic_coefficient=1.0, bristle_stiffness=1.0, static_switch=True)
    axis = Axis(inertia=1.0, load=0.0, drive=Ramp(rate=-1.0))
    run = simulate(axis, law, t_end=1.0, throw=False)
    assert run.status is Status.END_TIME
    assert math.isclose(run["x"][-1], -1.0 / 6.0, rel_tol=1e-7)


def test_a_mass_may_turn_round_long_before_the_first_step_ends():
    push = Pulse(level=0.7, duration=9.0)
    chain = Chain(mass=1.0, free=1.0, stiffness=1.0, damping=1.0, drive=push)
    law = Viscous(viscous_coefficient=0.0)
    run = simulate(chain, law, t_end=1.0, y0={"w": -1e-12}, throw=False)
    assert run.status is Status.END_TIME


def test_a_pendulum_may_start_from_rest_under_a_torque_that_grows_late():
    cart = PendulumCart(
        mass=1.0, ball=1.0, length=1.0, gravity=1.0, torque=Ramp(rate=1e4, start=10.0)
    )
    run = simulate(cart, COULOMB, t_end=11.0, throw=False)
    assert run.status is Status.LIFT_OFF


@pytest.mark.parametrize("rate", [1.0, -1.0])
@pytest.mark.parametrize("start", [0.0, 1.0])
def test_a_chain_on_bristles_may_start_from_rest_under_a_force_that_grows(start, rate):
    law = LuGre(
        kinetic_coefficient=0.25, static_coefficient=0.4, stribeck_velocity=0.01,
        bristle_stiffness=1e3, bristle_damping=1.0,
    )  # fmt: skip
    chain = Chain(mass=1.0, free=1.0, stiffness=1.0, drive=Ramp(rate=rate, start=start))
    solver = EventDriven(max_steps=2000)
    run = simulate(chain, law, t_end=start + 2.0, solver=solver, throw=False)
    assert run.status is Status.END_TIME


def test_a_body_on_bristles_changes_its_mode_with_an_event():
    law = Dahl(kinetic_coefficient=1.0, bristle_stiffness=100.0)
    axis = Axis(inertia=1.0, drive=Ramp(rate=-1.0, start=1.0))
    run = simulate(axis, law, t_end=1.1)
    before, after = run.at([0.5, 1.05])["mode"]
    assert after == -1
    assert before == after or run.events


def test_a_cart_that_breaks_away_off_the_ground_ends_there():
    M, m, l, tau, mu = 0.002, 1.0, 0.006, -0.001, 0.45  # noqa: E741
    cart = PendulumCart(mass=M, ball=m, length=l, torque=Pulse(level=tau, duration=1.0))
    law = Coulomb(kinetic_coefficient=mu, static_coefficient=0.8)
    run = simulate(cart, law, t_end=1.0, throw=False)
    assert run.status is Status.LIFT_OFF
    assert [event.reason for event in run.events[-2:]] == ["break-away", "lift-off"]
    s = run.events[-2].to_mode
    theta, omega = (float(run[name][-1]) for name in ("theta", "omega"))
    S, C = math.sin(theta), math.cos(theta)
    # as it slips, what holds it at rest no longer presses it down: no paradox, but no contact
    assert M + m * S**2 - mu * s * m * S * C > 0.0
    assert M * ((M + m) * 9.81 - m * l * omega**2 * C) - (M + m) * tau * S / l < 0.0
    assert run["normal_force"][-1] > 0.0


def test_a_block_that_starts_where_its_spring_ends_slides_to_rest():
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=10.0, y0={"x": 0.1, "v": 1e-3})
    way = 1e-3**2 / (2.0 * 0.25 * 9.81)
    assert math.isclose(run["x"][-1] - 0.1, way, rel_tol=1e-8)  # 1e-7 m beside 0.1 m
    assert run.status is Status.AT_REST


def test_a_body_that_stops_at_once_and_waits_long_breaks_away():
    law = Stribeck(
        kinetic_coefficient=0.0, static_coefficient=1.0, stribeck_velocity=1.0, fading_exponent=2.0
    )
    axis = Axis(inertia=1.0, drive=Ramp(rate=1.0))
    run = simulate(axis, law, t_end=3.0, y0={"v": 1e-149}, throw=False)
    assert run.status is Status.END_TIME  # the step that met the stop is no step at 1 s


@pytest.mark.parametrize("stiffness", [1e4, 3e5, 1e6])
def test_what_is_held_by_stiff_parts_stays_where_it_is(stiffness):
    chain = Chain(mass=1.0, free=1.0, stiffness=stiffness, damping=stiffness, drive=Ramp(rate=1.0))
    run = simulate(chain, COULOMB, t_end=1.0, throw=False)
    assert run.certificate.stick_drift == 0.0
    assert run.certificate.certified


@pytest.mark.parametrize("exponent", [1.0, 2.0])
def test_a_speed_that_starts_on_a_switch_of_the_law_falls_below_it(exponent):
    law = Stribeck(
        kinetic_coefficient=0.1,
        static_coefficient=0.2,
        stribeck_velocity=1.0,
        fading_exponent=exponent,
    )
    lift = Sine(amplitude=0.1, frequency=1.0)
    layer = 36.0 ** (1.0 / exponent)
    rig = ShakenBlock(mass=1.0, gravity=1.0, lift=lift)
    solver = EventDriven(max_steps=100)
    run = simulate(rig, law, t_end=1.0, y0={"v": layer}, solver=solver, throw=False)
    assert run.status is Status.END_TIME
    assert math.isclose(run["v"][-1], layer - 0.1, rel_tol=1e-12)  # mu g t, the lift averaged out


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_body_that_nothing_holds_follows_a_spring_from_rest(side):
    drive = Sine(amplitude=side, frequency=1.0, phase=math.pi / 2.0)
    chain = Chain(mass=1.0, free=1.0, stiffness=1.0, drive=drive)
    law = Viscous(viscous_coefficient=0.0)
    solver = EventDriven(max_steps=100)
    run = simulate(chain, law, t_end=1e-2, solver=solver, throw=False)
    assert run.status is Status.END_TIME
    assert math.isclose(run["x"][-1], side * 1e-8 / 24.0, rel_tol=1e-3)  # cos(2 pi t) is 1 - 2e-3


@pytest.mark.parametrize("start", [0.1, 1.0, 1000.0])
def test_what_begins_to_swing_late_takes_no_more_steps_for_the_rounding_of_the_time(start):
    cart = PendulumCart(
        mass=1.0, ball=1.0, length=1.0, gravity=1.0, torque=Ramp(rate=1.0, start=start)
    )
    run = simulate(cart, Viscous(viscous_coefficient=0.0), t_end=start + 1.0, throw=False)
    assert run.status is Status.END_TIME
    assert run.certificate.steps < 100


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_speed_too_small_to_matter_does_not_hide_which_way_a_body_is_drawn(side):
    block = TowedBlock(mass=1.0, stiffness=1.0, speed=-side)
    start = {"x": -1e-158 * side, "v": 1e-155 * side}
    run = simulate(block, Viscous(viscous_coefficient=0.0), t_end=1.0, y0=start, throw=False)
    assert run.status is Status.END_TIME
    assert math.isclose(run["x"][-1], -side * (1.0 - math.sin(1.0)), rel_tol=1e-12)


def test_a_run_whose_energy_is_no_number_is_not_certified():
    cart = PendulumCart(mass=0.00765, ball=0.0215, length=1000.0)
    law = Coulomb(kinetic_coefficient=6.4, static_coefficient=6.6)
    start = {"theta": 387.0, "v": -7300.0, "omega": 103.0}  # where rigid bodies with friction jam
    certificate = simulate(cart, law, t_end=64.0, y0=start, throw=False).certificate
    assert math.isfinite(certificate.energy_end) or not certificate.certified


def test_a_body_that_nothing_holds_may_come_to_rest_but_for_rounding():
    axis = Axis(
        inertia=0.0012552377361036936, stiffness=4620.611363484122, damping=1.2695733068710922,
        load=0.0, offset=-30.450970745262726,
        drive=PiecewiseLinear(
            times=(0.030258028818262582, 0.033713096051166104, 0.06863737856814581,
                   0.09485292147115842, 0.16230306971950806, 0.3184570231576693,
                   0.33919793273836457),
            values=(0.003880962278637666, 0.008845558350097312, -0.0038101380802272778,
                    0.003882914086570834, -0.060128977247773045, -0.012436512170767014,
                    0.008845558350097312),
        ),
    )  # fmt: skip
    law = Viscous(viscous_coefficient=0.002189941466615451)
    run = simulate(axis, law, t_end=0.4273258122437777, y0={"v": -3.6192565145260387}, throw=False)
    assert run.status is Status.END_TIME


def test_a_load_that_falls_to_zero_opens_what_nothing_pushes():
    pad = Lining(radius=1.0, load=1.0, press=Ramp(rate=-1.0))
    law = DirectionDependent(forward_kinetic_coefficient=0.3, backward_kinetic_coefficient=0.5)
    run = simulate(DiscBrake(inertia=1.0, pads=(pad,)), law, t_end=2.0)
    assert [(event.reason, event.t) for event in run.events] == [("opens", pytest.approx(1.0))]


@pytest.mark.parametrize("press", [None, Sine(amplitude=0.5, frequency=1.0)])
@pytest.mark.parametrize("torque", [0.7, -0.7])
def test_torques_that_cancel_but_for_rounding_break_nothing_away(torque, press):
    drive = Pulse(level=torque, duration=10.0)
    lining = Lining(radius=0.1, load=1.0, press=press)  # where it changes, steps replace the series
    inertias, drives = (1.3, 1.2e-6, 3e-7, 34.0), (drive, None, None, None)
    train = ClutchTrain(
        rotors=tuple(Rotor(inertia=J, torque=T) for J, T in zip(inertias, drives, strict=True)),
        clutches=(lining,) * 3,
    )
    laws = {
        "clutch-1": None,
        "clutch-2": PowerViscous(
            kinetic_coefficient=0.0, viscous_coefficient=10.0, viscous_exponent=2.0
        ),
        "clutch-3": Coulomb(kinetic_coefficient=0.1),
    }
    run = simulate(train, laws, t_end=1.0, throw=False)
    assert run.status is Status.END_TIME
    assert not run.events
    assert math.isclose(run["phi"][-1], 0.5 * torque / 1.3, rel_tol=1e-9)


def test_what_creeps_beside_large_forces_is_not_stopped_with_others():
    V, late = 1.0, 2e-4
    chain = BlockChain(blocks=2, mass=1e6, coupling=0.0, stiffness=1e6, speed=V, load=1e6)
    laws = {
        "block-1": QuadraticDrag(
            kinetic_coefficient=1.0, viscous_coefficient=0.0, quadratic_coefficient=1e-9
        ),
        "block-2": Coulomb(kinetic_coefficient=1e-9),
    }
    # block 1 breaks away at 1 s; block 2, (v + V) cos t - V, turns when block 1 has 2e-8 m/s
    v = V / math.cos(1.0 + late) - V
    run = simulate(chain, laws, t_end=1.01, y0={"v2": v})
    assert [event.reason for event in run.events if event.contact == "block-1"] == ["break-away"]
    assert [event.reason for event in run.events if event.contact == "block-2"] == ["reversal"]
    assert math.isclose(run["v1"][-1], V * (math.cos(0.01) - 1.0), rel_tol=1e-9)


def test_a_disc_that_its_damper_stops_at_once_has_its_energy_accounted_for():
    pads = (Lining(radius=0.04, load=95.0, press=Sine(amplitude=1.0, frequency=0.1)),)
    disc = DiscBrake(inertia=1e-7, damping=4e4, pads=pads)
    law = Coulomb(kinetic_coefficient=0.4)
    run = simulate(disc, law, t_end=1.0, y0={"omega": 18.0})
    assert run.certificate.energy_error < 1e-12
    assert math.isclose(run["phi"][-1], 18.0 * 1e-7 / 4e4, rel_tol=1e-3)


@pytest.mark.parametrize("beyond", [-1e-15, 0.0, 1e-15])
def test_a_spring_that_is_met_within_rounding_of_the_start_is_met_once(beyond):
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    law = Coulomb(kinetic_coefficient=0.1)
    run = simulate(rig, law, t_end=1.0, y0={"x": 0.1 + beyond, "v": -1.0}, throw=False)
    assert run.status is Status.END_TIME
    met = [] if beyond < 0.0 else ["spring touches"]
    assert [event.reason for event in run.events] == [*met, "reversal", "block leaves the spring"]


@pytest.mark.parametrize("place", [1e-20, -1e-20])
def test_a_block_may_fall_back_before_the_clock_can_tell(place):
    """No friction: one block's push ends at once, and its decided direction was tried for ever."""
    chain = BlockChain(blocks=2, mass=1.0, coupling=1.0, stiffness=1.0, speed=1.0, load=1.0)
    with time_limit(5.0):
        run = simulate(chain, Viscous(viscous_coefficient=0.0), t_end=1.0, y0={"x1": place})
    # both are pulled alike: x = t - sin t
    np.testing.assert_allclose([run["x1"][-1], run["x2"][-1]], math.sin(1.0) - 1.0, rtol=1e-12)


def test_a_body_beside_others_that_are_fast_begins_to_slip_though_its_forces_balance():
    """Static and kinetic level are equal, and the masses couple a slow body with fast ones."""
    pull = Sampled(
        times=tuple(0.07666034782215672 * i for i in range(10)),
        values=(
            -0.00164241958648, -0.00565891777629, -0.00756028931912, 0.000793334321530,
            0.00137727663362, 0.0, 0.00120174201065, 0.000967987374644, -0.00526342862788,
            0.00164241958648,
        ),
        hold="first",
    )  # fmt: skip
    turn = Sampled(
        times=(0.0, 1.1637943100318868), values=(0.00808053667728, 0.00173720296532), hold="first"
    )
    bodies = Dense(
        mass=(
            (2.7067348584478984e-05, 4.566197287314568e-05, 5.4701355789596187e-05),
            (4.566197287314568e-05, 0.00010996666597562274, 1.2640655559134407e-05),
            (5.4701355789596187e-05, 1.2640655559134407e-05, 0.0003098133117120891),
        ),
        stiffness=(
            (0.0022, -0.00038, 0.00046),
            (-0.00038, 0.00028, -0.00036),
            (0.00046, -0.00036, 0.00083),
        ),
        damping=((0.0,) * 3,) * 3,
        slips=((1, 1.0), (2, -2.5)),
        normal_forces=(0.0001, 0.0002),
        pushes=(pull + Pulse(level=0.008266, duration=1.0), turn, Ramp(rate=-0.019)),
        presses=(None, None),
    )  # fmt: skip
    run = simulate(
        bodies,
        Coulomb(kinetic_coefficient=3.6),
        t_end=0.7,
        y0={"v1": 30.0, "x1": 1.0, "x2": -2.67},
        throw=False,
    )
    assert run.status is Status.END_TIME


def test_a_steep_force_lets_go_of_one_contact_of_two_once():
    """Within a unit in the last place of the time, it passes the level by thousandths of it."""
    start, rate, level, mass = 1.6866534855013416e-3, 3.6e14, 2608.0, 434.0
    bodies = Dense(
        mass=((100.0, 0.0), (0.0, mass)),
        stiffness=((0.0,) * 2,) * 2,
        damping=((0.0,) * 2,) * 2,
        slips=((0, 1.0), (1, 1.0)),
        normal_forces=(level, level),
        pushes=(None, Ramp(rate=-rate, start=start)),
        presses=(None, None),
    )
    run = simulate(bodies, COULOMB, t_end=2.0 * start, throw=False)
    assert [event.reason for event in run.events] == ["break-away"]
    sliding = 2.0 * start - (start + level / rate)
    expected = -rate * sliding**2 / (2.0 * mass)  # the force over the level grows from 0
    assert math.isclose(run["v1"][-1], expected, rel_tol=1e-9)


def test_an_arm_that_nothing_holds_starts_as_well_late_as_at_once():
    """At rest without a force or a level there is nothing that errors could be compared with."""
    drag = QuadraticDrag(
        kinetic_coefficient=0.0, viscous_coefficient=0.01, quadratic_coefficient=0.8
    )
    late, span = 0.5, 0.2
    ends = []
    for start in (0.0, late):
        arm = TwoLinkArm(
            upper_mass=1.0,
            upper_length=0.3,
            upper_centre=0.15,
            upper_inertia=0.01,
            lower_mass=0.5,
            lower_centre=0.1,
            lower_inertia=0.007,
            gravity=9.81,
            shoulder_drive=Ramp(rate=20.0, start=start),
        )
        run = simulate(arm, drag, t_end=start + span)
        ends.append([run[name][-1] for name in ("shoulder", "elbow")])
    np.testing.assert_allclose(ends[1], ends[0], rtol=1e-7)


@pytest.mark.parametrize("place", [1e-11, 1e-50, 1e-100])
def test_a_motion_far_below_what_levels_could_give_ends_in_time(place):
    """The smallest ones are errors of what levels could give."""
    chain = BlockChain(blocks=2, mass=1.0, coupling=1.0, stiffness=1e4, load=1.0)
    laws = {"block-1": FREE, "block-2": COULOMB}
    run = simulate(chain, laws, t_end=20.0, y0={"x2": place}, throw=False)
    assert run.status is Status.END_TIME
    # held by the spring to the ground and pulled by the coupling to the block that holds
    omega = math.sqrt(1e4 + 1.0)
    expected = place / omega**2 * (1.0 - np.cos(omega * run.t))
    np.testing.assert_allclose(run["x1"], expected, atol=max(1e-6 * place / omega**2, 1e-30))


@pytest.mark.parametrize("tier", ["python", "compiled"])
@pytest.mark.parametrize("text", ["ramp(level)", "threlfall(level)"])
def test_several_blocks_start_from_rest_with_the_friction_that_their_law_has_there(text, tier):
    """Break-away was decided with the friction beyond the smoothing velocity, which held them."""
    smooth = law(text)(kinetic_coefficient=10.0, smoothing_velocity=0.6)
    chain = BlockChain(blocks=2, mass=1.0, coupling=0.0, stiffness=1e3, speed=0.01, load=10.0)
    solver = EventDriven(max_steps=300, tier=tier)
    run = simulate(chain, smooth, t_end=0.1, throw=False, solver=solver)
    assert run.status is Status.END_TIME
    block = TowedBlock(mass=1.0, stiffness=1e3, speed=0.01, load=10.0)  # seen from the belt
    alone = simulate(block, smooth, t_end=0.1, solver=solver)
    times = np.linspace(0.0, 0.1, 11)
    for name in ("x1", "x2"):
        expected = -alone.at(times)["x"]
        np.testing.assert_allclose(run.at(times)[name], expected, rtol=1e-8, atol=1e-15)


@dataclass(frozen=True, kw_only=True)
class Lesser(SetValuedLaw):
    """The lesser one of two levels."""

    name = "lesser"
    title = "The lesser level"
    formula = r"F = \min(\mu_1, \mu_2) N"
    sources = ()
    first: Annotated[float, Quantity("mu_1", low=0)]
    second: Annotated[float, Quantity("mu_2", low=0)]

    def sliding(self, speed, load):
        return self.break_away(load) + 0.0 * speed

    def break_away(self, load):
        return where(self.first < self.second, self.first, self.second) * load


@pytest.mark.parametrize(("first", "second"), [(1.0, 5.0), (5.0, 1.0)])
def test_a_level_that_a_comparison_chooses_holds_each_of_several_blocks(first, second):
    chain = BlockChain(blocks=2, mass=1.0, coupling=0.0, stiffness=1.0, speed=0.5)
    run = simulate(chain, Lesser(first=first, second=second), t_end=4.0)
    assert [event.reason for event in run.events] == ["break-away"] * 2
    np.testing.assert_allclose([event.t for event in run.events], 2.0, rtol=1e-12)


def test_a_step_that_errors_end_before_a_switch_does_not_turn_it():
    falling = DirectionalStribeck(
        forward_kinetic_coefficient=0.0,
        backward_kinetic_coefficient=0.0,
        forward_static_coefficient=0.0,
        backward_static_coefficient=1.0,
        forward_stribeck_velocity=1.0,
        backward_stribeck_velocity=1.0,
        forward_fading_exponent=1.0,
        forward_viscous_coefficient=0.0,
        backward_viscous_coefficient=0.0,
        backward_fading_exponent=2.0,
    )
    axis = Axis(rotary=True, inertia=0.005, stiffness=63000.0, damping=1.0, load=0.127)
    run = simulate(axis, falling, t_end=0.02, y0={"x": -1.0}, throw=False)
    assert run.status is Status.END_TIME
    # friction of 0.127 N m beside a spring of 63 kN m
    decay, omega = 100.0, math.sqrt(63000.0 / 0.005 - 1e4)
    turned = omega * run.t
    expected = -np.exp(-decay * run.t) * (np.cos(turned) + decay / omega * np.sin(turned))
    np.testing.assert_allclose(run["x"], expected, atol=1e-4)


@pytest.mark.parametrize("t_end", [0.02, 0.1, 5.0])
def test_friction_that_explodes_against_its_mode_gives_no_size_to_what_errors_are_compared_with(
    t_end,
):
    """The end of the run gives the length of a first trial, whose stages reach such speeds."""
    chain = Chain(mass=0.006, free=1.0, stiffness=5e5, damping=0.0, load=1e4)
    rising = law("threlfall(level)")(kinetic_coefficient=0.002, smoothing_velocity=0.5)
    solver = EventDriven(max_steps=400)
    run = simulate(chain, rising, t_end=t_end, y0={"u": 1.0}, solver=solver, throw=False)
    assert len(run.certificate.problems) == 1  # that so few steps do not lead to its end
    # one body of 6 g drawn by another of 1 kg, both slowed by at most 20 N
    assert np.abs(run["x"]).max() < run.span[1]
    assert np.abs(run["u"]).max() <= 1.0
