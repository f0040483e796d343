"""Laws that ask the contact for more than speed and load, in runs with one contact."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import Axis, FixedStep, Pendulum, SpringBlock, ensemble, load_rig, simulate
from stickslip.data.rigs.rig_writer import rig_toml
from stickslip.errors import InputError, SimulationError, UnknownNameError
from stickslip.friction import bound, law
from stickslip.mechanisms import given_inputs
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.mechanisms.drives import Ramp, Sampled, Sine
from stickslip.quantities import Quantity

WARM = law("level + viscous * exponential[temperature]")(
    kinetic_coefficient=2.0, viscous_coefficient=10.0, viscous_temperature_decay=0.03
)
GEAR = law("level + stribeck + weight[transmitted] + viscous")(
    kinetic_coefficient=0.04,
    static_coefficient=0.07,
    stribeck_velocity=0.15,
    transmitted_coefficient=0.12,
    viscous_coefficient=0.06,
)
LIFTING = Pendulum(
    mass=0.5,
    length=0.16,
    drive=Sine(amplitude=1.1, frequency=0.25) + Sine(amplitude=0.45, frequency=0.9),
)


def test_a_law_without_its_input_says_law_input_and_cure():
    with pytest.raises(InputError, match=r"warm-viscous .*temperature.*bound\(law"):
        WARM.force(0.1, 1.0)
    with pytest.raises(InputError, match="depends on transmitted"):
        GEAR.break_away(1.0)
    assert bound(WARM, {"temperature": 0.0}).force(0.1, 1.0) == 3.0


def test_a_run_whose_mechanism_lacks_an_input_is_refused_before_it_begins():
    said = r"'temperature', which Axis does not tell; it tells motor, .*\[contact\]"
    for run in (
        lambda: simulate(Axis(inertia=1.0), WARM, t_end=1.0),
        lambda: ensemble(Axis(inertia=1.0), WARM, {"mechanism.inertia": [1.0]}, t_end=1.0),
        lambda: simulate(Axis(inertia=1.0), WARM, t_end=1.0, solver=FixedStep(dt=1e-3)),
    ):
        with pytest.raises(InputError, match=said):
            run()


def test_a_law_that_is_bound_already_is_refused_because_the_mechanism_tells_what_changes():
    warm = bound(WARM, {"temperature": 35.0})
    with pytest.raises(InputError, match=r"bound to temperature.*given_inputs"):
        simulate(Axis(inertia=1.0), warm, t_end=1.0)


def test_viscous_friction_at_a_temperature_slows_down_as_its_closed_form():
    rig = given_inputs(Axis(inertia=2.0), {"temperature": "35 degC"})
    run = simulate(rig, WARM, t_end=5.0, y0={"v": 1.0})
    c = 10.0 * np.exp(-0.03 * 35.0)
    (stop,) = (event.t for event in run.events if event.reason == "stop")
    assert stop == pytest.approx(2.0 / c * np.log1p(c / 2.0), rel=1e-9)


def test_a_temperature_in_time_is_followed_and_jumps_of_it_are_met():
    # 2 v' = -10 exp(-0.03 T) v - 2 in each stretch of constant temperature
    rig = given_inputs(
        Axis(inertia=2.0), {"temperature": Sampled(times=[0.0, 0.1], values=[0.0, 60.0])}
    )
    run = simulate(rig, WARM, t_end=0.3, y0={"v": 1.0})
    v = 1.0
    for c, span in ((10.0, 0.1), (10.0 * np.exp(-1.8), 0.2)):
        v = (v + 2.0 / c) * np.exp(-c / 2.0 * span) - 2.0 / c
    assert run["v"][-1] == pytest.approx(v, rel=1e-9)


@pytest.mark.slow
def test_a_gear_that_lifts_agrees_with_a_regularised_reference():
    run = simulate(LIFTING, GEAR, t_end=6.0)
    assert run.certificate.certified
    assert run.stick_time() > 0.1  # the level at rest moves with the load of the gear
    inertia, weight = 0.5 * 0.16**2, 0.5 * 9.81 * 0.16

    def rate(t, y, width):
        x, v = y
        motor = 1.1 * np.sin(0.5 * np.pi * t) + 0.45 * np.sin(1.8 * np.pi * t)
        external = -weight * np.sin(x)
        level = 0.04 + 0.03 * np.exp(-((v / 0.15) ** 2)) + 0.12 * abs(motor - external)
        return [v, (motor + external - level * np.tanh(v / width) - 0.06 * v) / inertia]

    found = [
        solve_ivp(rate, (0.0, 6.0), [0.0, 0.0], "Radau", args=(w,), rtol=1e-9, atol=1e-11).y[0, -1]
        for w in (4e-4, 5e-5)
    ]
    error = abs(found[1] - run["theta"][-1])
    # the reference creeps by what it rounds off: an eighth of that leaves less than half the error
    assert error < 0.5 * abs(found[0] - run["theta"][-1])
    assert error < 1e-4


LAWS = {
    "gear": GEAR,
    "directions of a gear": law(
        "level + stribeck + gear + gear_stribeck + gear_quadratic + viscous"
    )(
        kinetic_coefficient=0.04,
        static_coefficient=0.07,
        stribeck_velocity=0.15,
        motor_friction=0.12,
        external_friction=0.05,
        motor_static_friction=0.05,
        external_static_friction=0.03,
        motor_quadratic=0.04,
        external_quadratic=0.08,
        viscous_coefficient=0.06,
    ),
    "bristles": law("lugre((level + stribeck) * linear[gravity] + weight[transmitted]) + viscous")(
        kinetic_coefficient=0.04,
        static_coefficient=0.07,
        stribeck_velocity=0.15,
        gravity_slope=0.3,
        transmitted_coefficient=0.12,
        bristle_stiffness=100.0,
        bristle_damping=0.3,
        viscous_coefficient=0.06,
    ),
    "teeth": law("both_ways(level) * ripple[position] + viscous")(
        forward_kinetic_coefficient=0.05,
        backward_kinetic_coefficient=0.08,
        level_position_cosine=0.3,
        level_position_sine=0.1,
        level_position_harmonic=12.0,
        viscous_coefficient=0.06,
    ),
}
VARIED = {
    "gear": "transmitted_coefficient",
    "directions of a gear": "external_friction",
    "bristles": "gravity_slope",
    "teeth": "level_position_sine",
}


@pytest.mark.parametrize("name", LAWS)
def test_runs_are_certified_and_sensitivities_agree_with_differences(name):
    one, path = LAWS[name], VARIED[name]
    run = simulate(LIFTING, one, t_end=3.0)
    assert run.certificate.certified
    h = 1e-6
    ends = [
        simulate(LIFTING, replace(one, **{path: getattr(one, path) + d}), t_end=3.0)["theta"][-1]
        for d in (h, -h)
    ]
    slope = run.sensitivity("theta", path)[-1]
    # differences keep about half of the digits of a run with tolerances of 1e-10
    assert slope == pytest.approx((ends[0] - ends[1]) / (2.0 * h), rel=2e-4)


def test_a_constant_input_is_a_parameter_that_ensembles_vary():
    rig = given_inputs(Axis(inertia=2.0), {"temperature": 20.0})
    runs = ensemble(rig, WARM, {"contact_temperature": [0.0, 20.0, 60.0]}, t_end=0.2, y0={"v": 1.0})
    c = 10.0 * np.exp(-0.03 * np.array([0.0, 20.0, 60.0]))
    expected = (1.0 + 2.0 / c) * np.exp(-c / 2.0 * 0.2) - 2.0 / c
    assert runs["v"] == pytest.approx(expected, rel=1e-9)
    assert pickle.loads(pickle.dumps(rig)) == rig


def test_a_block_on_a_slope_loses_as_much_as_gravity_says():
    leaning = law("level * linear[gravity]")(kinetic_coefficient=0.3, level_gravity_slope=0.1)
    block = SpringBlock(mass=1.0, incline=0.1)
    run = simulate(block, leaning, t_end=3.0, y0={"v": 1.0})
    pull = 9.81 * np.sin(0.1)
    slowing = pull + 0.3 * (1.0 - 0.1 * pull) * 9.81 * np.cos(0.1)
    assert run["x"][-1] == pytest.approx(0.5 / slowing, rel=1e-9)


def test_a_factor_that_falls_towards_0_ends_a_run_before_friction_drives():
    cold = law("level + viscous * linear[temperature]")(
        kinetic_coefficient=1.0, viscous_coefficient=1.0, viscous_temperature_slope=-0.05
    )
    axis = Axis(inertia=1.0, drive=Sine(amplitude=3.0, frequency=1.0))
    warming = given_inputs(axis, {"temperature": Ramp(rate=40.0)})
    with pytest.raises(
        SimulationError, match=r"viscous \* linear\[temperature\] falls below 0.001"
    ):
        simulate(warming, cold, t_end=3.0)
    with pytest.raises(SimulationError, match=r"at t = 0\.5 s, viscous .* use EventDriven"):
        simulate(warming, cold, t_end=3.0, solver=FixedStep(dt=1e-3))
    run = simulate(warming, cold, t_end=3.0, throw=False)
    assert run.span[1] == pytest.approx(0.4995, abs=1e-9)  # 1 - 0.05 * 40 t = 0.001
    assert simulate(warming, cold, t_end=0.4).certificate.certified
    both = law("dahl(both_ways(level * linear[gravity])) + viscous")(
        forward_kinetic_coefficient=1.0,
        backward_kinetic_coefficient=1.0,
        forward_level_gravity_slope=0.0,
        backward_level_gravity_slope=-0.6,
        bristle_stiffness=100.0,
        viscous_coefficient=0.1,
    )
    lifting = Pendulum(mass=0.2, length=1.0, drive=Ramp(rate=-1.0))
    run = simulate(lifting, both, t_end=20.0, throw=False)
    assert run.events[-1].reason == "backward level * linear[gravity] falls below 0.001"
    angle = run["theta"][-1]
    assert -0.2 * 9.81 * np.sin(angle) == pytest.approx(0.999 / 0.6, rel=1e-6)


RIG = """
[mechanism]
type = "axis"
inertia = 2.0

[contact]
temperature = {temperature}

[friction.warm]
law = "level + viscous * exponential[temperature]"
kinetic_coefficient = 2.0
viscous_coefficient = 10.0
viscous_temperature_decay = 0.03
"""
SHAPE = '{ type = "sine", amplitude = 20.0, frequency = 0.5 }'


@pytest.mark.parametrize(
    ("text", "at_half"),
    [("35.0", 35.0), ('"35 degC"', 35.0), ('"308.15 K"', 35.0), ('"95 °F"', 35.0), (SHAPE, 20.0)],
)
def test_a_rig_file_gives_an_input_with_its_unit_or_in_time_and_is_written_back(
    tmp_path, text, at_half
):
    path = tmp_path / "rig.toml"
    path.write_text(RIG.format(temperature=text), encoding="utf-8")
    rig = load_rig(path)
    drives = {name: drive.value(0.5) for name, drive in rig.mechanism.drives().items()}
    told = rig.mechanism.contact_inputs(0.5, {"x": 0.0}, {"x": 0.0}, drives)
    assert told["temperature"] == pytest.approx(at_half, rel=1e-14)
    (one,) = rig.laws.values()
    path.write_text(rig_toml(rig.mechanism, one), encoding="utf-8")
    again = load_rig(path)
    assert again.mechanism == rig.mechanism
    assert simulate(again.mechanism, one, t_end=0.2, y0={"v": 1.0}).certificate.certified


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("temprature = 3.0", r"key in \[contact\] of .*Did you mean 'temperature'"),
        ('temperature = "3 mm"', "contact.temperature .T. must be in degC"),
        ('temperature = "-300 degC"', "contact.temperature .T. must be at least -273.15 degC"),
        ("position = 3.0", "computes contact.position from its motion and forces: leave it out"),
        ("temperature = true", "contact.temperature .T. must be a number"),
        ('temperature = { type = "ramp" }', "contact.temperature.rate .r. is missing"),
        ('temperature = { type = "ramps" }', "contact.temperature.type in .*Did you mean 'ramp'"),
    ],
)
def test_an_input_of_a_rig_file_that_cannot_be_used_is_named(tmp_path, text, said):
    path = tmp_path / "rig.toml"
    path.write_text(RIG.replace("temperature = {temperature}", text), encoding="utf-8")
    with pytest.raises((InputError, UnknownNameError), match=said):
        load_rig(path)


def test_a_parameter_in_the_unit_of_an_input_is_looked_for_at_the_inputs_size():
    own = Quantity("c_{0}", "{0}", above=0, scale="none", bounds=(0.1, 10.0), start=1.0)
    pressure = CONTACT_INPUTS["pressure"].over(own)
    assert (pressure.symbol, pressure.unit, pressure.scale) == ("c_P", "Pa", "none")
    assert (*pressure.bounds, pressure.start) == pytest.approx((1e4, 1e6, 1e5))
    assert CONTACT_INPUTS["temperature"].over(own).unit == "K"
    torque = CONTACT_INPUTS["transmitted"].over(own)
    assert (torque.scale, torque.start) == ("force", 1.0)
