"""Twins: other programs' friction, beside the programs themselves where they are installed."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from tests.commands import commands

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    FixedStep,
    LuGre,
    Stribeck,
    TwoFeet,
    Viscous,
    simulate,
)
from stickslip.data import Rig
from stickslip.engine.solver import SoftConstraint
from stickslip.errors import InputError, SimulationError
from stickslip.exports import PROGRAMS, Drake, Karnopp, MuJoCo, MuJoCoMotor, Simscape, export, twin
from stickslip.mechanisms.drives import PiecewiseLinear, Sine

LAW = CoulombViscous(kinetic_coefficient=5.0, viscous_coefficient=0.5)
BRISTLES = LuGre.from_forces(
    load=1.0, kinetic_force=1.0, static_force=1.5, stribeck_velocity=0.1, bristle_stiffness=2e3,
    bristle_damping=4.0, viscous_coefficient=0.3,
)  # fmt: skip
SLOW = (MuJoCo(), MuJoCo(timestep=0.005), MuJoCo(timestep=0.001, time_constant=0.002,
        impedance=0.999, largest_impedance=0.9999))  # fmt: skip


def pushed(amplitude=7.0, *, rotary=False):
    return Axis(
        inertia=2.0, load=1.0, drive=Sine(amplitude=amplitude, frequency=1.0), rotary=rotary
    )


def held(force):
    """Return an axis under a constant force, from rest."""
    return Axis(inertia=2.0, load=1.0, drive=PiecewiseLinear(times=(0.0, 1.0), values=(force,) * 2))


def of_mujoco(found, mass, force, t_end, *, rotary=False, spring=0.0, start=0.0):
    """Return times and positions of MuJoCo itself with the settings that a twin spells."""
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")
    attributes, _, step = found.settings.rpartition(" timestep=")
    kind = "hinge" if rotary else "slide"
    model = mujoco.MjModel.from_xml_string(f"""
      <mujoco><option timestep={step} gravity="0 0 0" integrator="implicitfast"/>
        <worldbody><body>
          <joint name="j" type="{kind}" axis="1 0 0" {attributes} stiffness="{spring}"/>
          <inertial pos="0 0 0" mass="{mass}" diaginertia="{mass} {mass} {mass}"/>
        </body></worldbody>
        <actuator><motor joint="j"/></actuator>
      </mujoco>""")
    data = mujoco.MjData(model)
    data.qpos[0] = start
    rows = [(0.0, start)]
    while data.time < t_end - 1e-9:
        data.ctrl[0] = force(data.time)
        mujoco.mj_step(model, data)
        rows.append((data.time, data.qpos[0]))
    t, x = np.array(rows).T
    return np.clip(t, 0.0, t_end), x


@pytest.mark.parametrize("rotary", [False, True])
@pytest.mark.parametrize("program", SLOW)
@pytest.mark.parametrize("amplitude", [4.9, 7.0, 20.0])
def test_the_twin_of_frictionloss_is_the_run_of_mujoco(program, amplitude, rotary):
    found = twin(pushed(amplitude, rotary=rotary), LAW, program, t_end=2.0)
    t, x = of_mujoco(
        found, 2.0, lambda t: amplitude * math.sin(2.0 * math.pi * t), 2.0, rotary=rotary
    )
    measured = np.abs(x - found.exact.at(t)["x"]).max()
    print(f"{program}: predicted error {found.peak_error:.4g}, of MuJoCo {measured:.4g}")
    # the same arithmetic in another order, over up to 2,000 steps
    np.testing.assert_allclose(found.run.at(t)["x"], x, rtol=0.0, atol=1e-9)
    # between its steps the twin is a straight line, a chord of v' h^2 / 8 = 0.4 um at 1 ms
    assert found.peak_error == pytest.approx(measured, rel=0.02, abs=4e-7)


def test_a_spring_is_in_the_twin_as_well():
    axis = Axis(inertia=1.0, load=9.81, stiffness=100.0)
    law = Coulomb(kinetic_coefficient=0.25)
    found = twin(axis, law, "mujoco", t_end=1.0, y0={"x": -0.1})
    t, x = of_mujoco(found, 1.0, lambda _: 0.0, 1.0, spring=100.0, start=-0.1)
    np.testing.assert_allclose(found.run.at(t)["x"], x, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("program", SLOW)
def test_a_held_body_creeps_in_mujoco_as_predicted(program):
    found = twin(held(3.0), LAW, program, t_end=1.0, force=3.0)
    assert not found.exact["x"].any()
    t, x = of_mujoco(found, 2.0, lambda _: 3.0, 1.0)
    late = t > 0.5
    creep = float(np.polyfit(t[late], x[late], 1)[0])
    print(f"{program}: predicted creep {found.creep:.5g} m/s, of MuJoCo {creep:.5g} m/s")
    # after 50 time constants of 1 / (d b)
    assert creep == pytest.approx(found.creep, rel=1e-4)


@pytest.mark.parametrize("damping", [0.0, 10.0, 1500.0])
@pytest.mark.parametrize("program", [MuJoCo(), Drake(stiction_tolerance=0.01), Simscape()])
def test_the_damping_of_a_joint_slows_its_creep(program, damping):
    law = CoulombViscous(kinetic_coefficient=5.0, viscous_coefficient=damping)
    found = twin(held(3.0), law, program, t_end=2.0, force=3.0)
    x = found.run.at([1.5, 2.0])["x"]
    # the run itself, to the tolerance of a tenth of a millimetre's travel
    assert found.creep == pytest.approx((x[1] - x[0]) / 0.5, rel=1e-5)
    if isinstance(program, MuJoCo):  # an attribute of MJCF is a number without separators
        assert f' damping="{damping:g}" ' in found.settings


@pytest.mark.parametrize("damping", [0.0, 4.0])
def test_the_twin_of_dcmotor_is_the_run_of_mujoco(damping):
    mujoco = pytest.importorskip("mujoco", minversion="3.7", reason="needs MuJoCo 3.7: dcmotor")
    law = replace(BRISTLES, bristle_damping=damping)
    axis = Axis(inertia=0.02, load=1.0, drive=Sine(amplitude=2.5, frequency=1.0))
    rig = Rig(mechanism=axis, laws={law.name: law}, named=(law.name,), t_end=1.0)
    (text,) = export(rig, "mjcf", name="joint").files.values()
    model = mujoco.MjModel.from_xml_string(text)
    data, rows = mujoco.MjData(model), [(0.0, 0.0)]
    while data.time < 1.0 - 1e-9:
        data.ctrl[0] = 2.5 * np.sin(2.0 * np.pi * data.time)
        mujoco.mj_step(model, data)
        rows.append((data.time, data.qpos[0]))
    t, x = np.array(rows).T
    t = np.clip(t, 0.0, 1.0)
    found = twin(axis, law, MuJoCoMotor(timestep=model.opt.timestep), t_end=1.0)
    measured = np.abs(x - found.exact.at(t)["x"]).max()
    print(f"dcmotor: predicted error {found.peak_error:.4g}, of MuJoCo {measured:.4g}")
    # the exported motor has a back-EMF of 1e-12 N s/m
    np.testing.assert_allclose(found.run.at(t)["x"], x, rtol=0.0, atol=1e-8)
    assert found.creep == 0.0


def of_drake(force, tolerance, step, t_end):
    """Return times and positions of a body on the ground in Drake, held by contact friction."""
    drake = pytest.importorskip(
        "pydrake.all", reason="Drake is not installed: pip install drake", exc_type=ImportError
    )
    builder = drake.DiagramBuilder()
    settings = drake.MultibodyPlantConfig()
    settings.time_step, settings.stiction_tolerance = step, tolerance
    plant, _ = drake.AddMultibodyPlant(settings, builder)
    point = drake.SpatialInertia(1e-9, [0, 0, 0], drake.UnitInertia(1, 1, 1))
    mass = drake.SpatialInertia(2.0 - 1e-9, [0, 0, 0], drake.UnitInertia(1, 1, 1))
    slider, body = plant.AddRigidBody("x", point), plant.AddRigidBody("body", mass)
    along = plant.AddJoint(
        drake.PrismaticJoint("x", plant.world_frame(), slider.body_frame(), [1, 0, 0], damping=0.5)
    )
    plant.AddJoint(
        drake.PrismaticJoint("z", slider.body_frame(), body.body_frame(), [0, 0, 1])
    ).set_default_translation(0.09996076)
    rough = drake.CoulombFriction(5.0 / 19.62, 5.0 / 19.62)
    pose = drake.RigidTransform()
    plant.RegisterCollisionGeometry(plant.world_body(), pose, drake.HalfSpace(), "floor", rough)
    plant.RegisterCollisionGeometry(body, pose, drake.Sphere(0.1), "ball", rough)
    plant.AddJointActuator("push", along)
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -9.81])
    plant.Finalize()
    source = builder.AddSystem(force(drake))
    builder.Connect(source.get_output_port(0), plant.get_actuation_input_port())
    log = drake.LogVectorOutput(plant.get_state_output_port(), builder, step)
    simulator = drake.Simulator(builder.Build())
    simulator.AdvanceTo(t_end)
    found = log.FindLog(simulator.get_context())
    return found.sample_times(), found.data()[0]


@pytest.mark.parametrize("tolerance", [1e-4, 1e-3])
def test_the_error_of_drake_is_predicted(tolerance):
    t, x = of_drake(lambda drake: drake.Sine(7.0, 2.0 * math.pi, 0.0, 1), tolerance, 1e-4, 2.0)
    found = twin(pushed(), LAW, Drake(stiction_tolerance=tolerance), t_end=2.0)
    measured = np.abs(x - found.exact.at(np.minimum(t, 2.0))["x"]).max()
    print(f"{tolerance}: predicted error {found.peak_error:.4g} m, of Drake {measured:.4g} m")
    # Drake's own step of 0.1 ms changes it by 0.5 % at most
    assert found.peak_error == pytest.approx(measured, rel=0.01)


def test_the_creep_of_drake_is_predicted():
    t, x = of_drake(lambda drake: drake.ConstantVectorSource([3.0]), 1e-4, 1e-3, 1.0)
    late = t > 0.5
    creep = float(np.polyfit(t[late], x[late], 1)[0])
    predicted = twin(held(3.0), LAW, "drake", t_end=1.0, force=3.0).creep
    print(f"predicted creep {predicted:.6g} m/s, of Drake {creep:.6g} m/s")
    assert predicted == pytest.approx(7.5e-5, rel=1e-12)  # 0.6 / sqrt(1 - 0.36) of the tolerance
    assert creep == pytest.approx(predicted, rel=1e-3)


@pytest.mark.parametrize("program", ["drake", "simscape"])
def test_a_body_at_rest_creeps_in_the_run_as_predicted(program):
    found = twin(held(3.0), LAW, program, t_end=1.0, force=3.0)
    # viscous friction is in the creep of Simscape's block, and takes 1e-5 of the force in Drake
    assert found.run["v"][-1] == pytest.approx(found.creep, rel=1e-4)
    assert found.peak_error == pytest.approx(found.creep, rel=0.05)


def test_the_block_of_simscape_has_its_printed_formula():
    law = Stribeck(
        kinetic_coefficient=4.0, static_coefficient=5.0, stribeck_velocity=0.01,
        viscous_coefficient=0.5,
    )  # fmt: skip
    found = twin(pushed(), law, Simscape(breakaway_velocity=0.02), t_end=2.0)
    taken = found.taken.law
    F_C, F_brk, f = taken.kinetic_coefficient, taken.static_coefficient, taken.viscous_coefficient
    v = np.linspace(1e-4, 0.3, 50)
    v_St, v_Coul = 0.02 * math.sqrt(2.0), 0.02 / 10.0
    printed = (
        math.sqrt(2.0 * math.e) * (F_brk - F_C) * np.exp(-((v / v_St) ** 2)) * v / v_St
        + F_C * np.tanh(v / v_Coul)
        + f * v
    )
    np.testing.assert_allclose(taken.steady(v, 1.0), printed, rtol=1e-13)
    assert F_brk == 5.0
    assert "Breakaway friction force 5 N" in found.settings


def test_karnopp_holds_within_a_band_that_no_step_jumps_over():
    found = twin(pushed(), LAW, Karnopp(step=0.002), t_end=2.0)
    # twice what 5 N change of 2 kg in 2 ms
    assert "dead band 10 mm/s" in found.settings
    same = FixedStep(dt=0.002, stick_rule=False, zero_velocity_band=0.01)
    run = simulate(pushed(), LAW, t_end=2.0, solver=same)
    np.testing.assert_array_equal(run["x"], found.run["x"])
    rests = twin(held(3.0), LAW, "karnopp", t_end=1.0)
    assert not rests.run["x"].any()
    assert "stays where it is" in rests.sentences[1]


@pytest.mark.parametrize("program", [name for name in PROGRAMS if name != "mujoco-dcmotor"])
def test_the_cure_brings_each_program_near_the_law(program):
    found = twin(pushed(), LAW, program, t_end=2.0)
    cured = found.cured()
    assert cured.peak_error < 0.15 * found.peak_error
    assert cured.force == found.force
    assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["program"] == program


def test_what_a_program_cannot_have_is_said():
    law = Stribeck(kinetic_coefficient=4.0, static_coefficient=5.0, stribeck_velocity=0.01)
    said = " ".join(twin(pushed(), law, "mujoco", t_end=1.0).sentences)
    assert "Static friction: rest holds 5 N" in said
    assert "falls with speed" in said


@pytest.mark.parametrize(
    ("mechanism", "law", "program", "options", "message"),
    [
        (pushed(), LAW, "mujco", {}, "Did you mean 'mujoco'"),
        (pushed(), LAW, "mujoco-dcmotor", {}, "use mujoco"),
        (pushed(), LAW, "drake", {"force": 5.0}, "below the largest friction at rest, 5 N"),
        (pushed(), Viscous(viscous_coefficient=1.0), "drake", {}, "no friction at rest"),
        (
            pushed(),
            Dahl(kinetic_coefficient=5.0, bristle_stiffness=1e3),
            "karnopp",
            {},
            "holds nothing at rest",
        ),
        (pushed(rotary=True), LAW, "drake", {}, "joints of Drake have no dry friction"),
        (TwoFeet(mass=1.0, front=0.1, rear=0.1), LAW, "mujoco", {}, "one contact"),
    ],
)
def test_what_has_no_twin_is_refused_in_words(mechanism, law, program, options, message):
    with pytest.raises(InputError, match=message):
        twin(mechanism, law, program, t_end=1.0, **options)


def test_a_run_that_diverges_names_its_settings_and_a_cure():
    stiff = replace(BRISTLES, bristle_damping=400.0)
    axis = Axis(inertia=0.02, load=1.0, drive=Sine(amplitude=2.5, frequency=1.0))
    with pytest.raises(
        SimulationError, match="take a smaller step, or the settings of MuJoCoMotor"
    ):
        twin(axis, stiff, "mujoco-dcmotor", t_end=1.0)


def test_a_soft_constraint_is_of_one_contact_and_a_law_without_memory():
    soft = SoftConstraint(impedance=0.9, damping=100.0)
    with pytest.raises(InputError, match="without memory, not by lugre"):
        simulate(pushed(), BRISTLES, t_end=1.0, solver=FixedStep(dt=0.01, soft=soft))
    feet = TwoFeet(mass=1.0, front=0.1, rear=0.1)
    with pytest.raises(InputError, match="take a mechanism with one contact"):
        simulate(feet, LAW, t_end=1.0, solver=FixedStep(dt=0.01, soft=soft))


def test_semi_implicit_steps_keep_the_energy_of_an_oscillator():
    axis = Axis(inertia=1.0, stiffness=100.0)
    free = Coulomb(kinetic_coefficient=0.0)
    swings = {
        method: np.ptp(simulate(axis, free, t_end=20.0, y0={"x": 0.1}, solver=FixedStep(
            dt=0.01, method=method, stick_rule=False))["x"][-70:])
        for method in ("euler", "semi-implicit")
    }  # fmt: skip
    # forward Euler grows by (1 + (omega h)^2)^(n/2) = e^10; the other swings within omega h / 2
    assert swings["euler"] > 1e3 * 0.2
    assert swings["semi-implicit"] == pytest.approx(0.2, rel=0.06)


RIG = """
title = "Slide"
[mechanism]
type = "axis"
inertia = "2 kg"
load = "20 N"
[[mechanism.drive]]
type = "sine"
amplitude = "7 N"
frequency = "1 Hz"
[friction.coulomb-viscous]
kinetic_coefficient = 0.25
viscous_coefficient = 0.5
[run]
t_end = "1 s"
"""


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "slide.toml").write_text(RIG)
    return commands(capsys, "simulate", "slide.toml")


def test_the_command_runs_as_another_program_does(run, tmp_path):
    code, out, err = run("--as", "mujoco:timestep=1 ms", "-o", "run.csv")
    assert code == 0, err
    assert "Under 3 N (60 % of the largest friction at rest), a body at rest creeps at" in out
    assert "With settings that come closer" in out
    assert (tmp_path / "run.csv").exists()
    code, out, _ = run("--as", "drake", "--json")
    assert code == 0
    told = json.loads(out)["twin"]
    # 5 N v / sqrt(v^2 + (1e-4)^2) + 0.5 N s/m v = 3 N: the damping takes 2e-5 of it off
    assert told["creep"] == pytest.approx(7.49985e-5, rel=1e-6)
    assert told["settings"] == {"stiction_tolerance": 1e-4}


def test_settings_that_come_no_closer_are_not_told(run, tmp_path):
    held = RIG.replace('amplitude = "7 N"', 'amplitude = "1 N"')  # below break-away, 5 N
    (tmp_path / "slide.toml").write_text(held)
    code, out, err = run("--as", "karnopp")
    assert code == 0, err
    assert "Largest error of x: 0 m" in out
    assert "closer" not in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--as", "mujoco:stiffness=3"), "unknown setting of mujoco 'stiffness'. Known: impedance"),
        (("--as", "mujoco:timestep=-1"), "--as mujoco: timestep (h) must be above 0 s, got -1"),
        (("--as", "karnopp:break_away=no"), "break_away must be one of zero, kinetic, static"),
        (("--as", "drake", "--fixed-step", "0.01"), "--as runs in the way of another program"),
    ],
)
def test_settings_are_checked_before_the_run(run, arguments, message):
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert len(err.splitlines()) == 1
    assert message in err
