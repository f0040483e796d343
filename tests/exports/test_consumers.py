"""A law fitted to a rotary axis turns in other programs as it does in the engine."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.exports.compiled import library, numbers
from tests.exports.fmus import need_tools

from stickslip import Axis, RecordSettings, Stribeck, export, fit, load_rig, simulate
from stickslip.exports import export_fmu
from stickslip.exports.joints import simplified
from stickslip.exports.program import Subject
from stickslip.mechanisms.drives import Sampled

INERTIA, PERIOD, END = 0.02, 1e-3, 3.0
TRUE = Stribeck(
    kinetic_coefficient=0.4,
    static_coefficient=0.65,
    stribeck_velocity=0.3,
    viscous_coefficient=0.05,
)
TIMES = PERIOD * np.arange(round(END / PERIOD) + 1)


def torque(first: float, second: float) -> np.ndarray:
    """Return a torque that stops and reverses the axis several times."""
    slow, fast = np.sin(2 * np.pi * 0.5 * TIMES), np.sin(2 * np.pi * 1.7 * TIMES)
    return first * slow + second * fast


HELD = torque(1.1, -0.3)
"""Torque in use, other than that of the record, held over each period."""


@pytest.fixture(scope="module")
def used(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The file of a law that was fitted to angles and torques, and the motion in use with it."""
    folder = tmp_path_factory.mktemp("rotary")
    given = torque(0.9, 0.35)
    drive = Sampled(times=TIMES, values=given, hold="first")
    run = simulate(Axis(inertia=INERTIA, drive=drive), TRUE, t_end=END).at(TIMES)
    noise = np.random.default_rng(3).normal(0.0, 2e-5, TIMES.size)
    rows = zip(TIMES, np.degrees(run["x"] + noise), given, strict=True)
    table = "\n".join(f"{t:.4f},{q:.6f},{f:.8f}" for t, q, f in rows)
    (folder / "run.csv").write_text(f"t [s],angle [deg],torque [N m]\n{table}\n")
    (folder / "rig.toml").write_text(
        '[mechanism]\ntype = "axis"\ninertia = 0.02\n[data]\nfile = "run.csv"\nhold = "first"\n'
        'columns = { time = "t [s]", position = "angle [deg]", force = "torque [N m]" }\n'
    )
    rig = load_rig(folder / "rig.toml")
    settings = RecordSettings(hold="first", starts=1)
    found = fit(rig.mechanism, TRUE, rig.measurement, settings=settings)
    found.save(folder / "law.toml")
    law = load_rig(folder / "law.toml")
    axis = Axis(inertia=INERTIA, drive=Sampled(times=TIMES, values=HELD, hold="zero"), rotary=True)
    true = simulate(axis, found.law, t_end=END)
    return SimpleNamespace(folder=folder, rig=law, law=found.law, axis=axis, run=true)


def far(angle: np.ndarray, run: Any) -> float:
    """Return the largest distance from the engine's motion, over the way between its ends."""
    x = run.at(TIMES)["x"]
    return float(np.abs(angle - x).max() / np.ptp(x))


def test_the_record_stops_the_axis_and_the_law_file_knows_that_it_turns(used):
    assert used.rig.mechanism.rotary
    assert used.rig.estimates.levels == "torques"
    modes = used.run.at(TIMES)["mode"]
    assert np.any(modes[100:] == 0)  # else nothing below would tell how it sticks
    assert {-1, 0, 1} <= set(modes.tolist())
    for name in ("kinetic_coefficient", "static_coefficient", "viscous_coefficient"):
        assert getattr(used.law, name) == pytest.approx(getattr(TRUE, name), rel=0.01)


@pytest.mark.parametrize("target", ["c", "matlab", "mjcf", "urdf", "csv", "json"])
def test_no_file_of_a_rotary_axis_has_a_unit_of_a_linear_one(used, target):
    text = "\n".join(export(used.rig, target).files.values())
    for wrong in ("[N]", "[m/s]", "[kg]", "[m]", "N s/m", 'type="slide"', "prismatic", 'unit="m'):
        loads = text.replace("load: normal force; taken as 0 where it is negative [N]", "")
        assert wrong not in loads, wrong
    assert "rad/s" in text
    assert any(name in text for name in ("N m", "N.m"))


def test_the_compiled_law_moves_the_axis_as_the_engine_does(used):
    step = numbers(
        library(used.folder / "c", export(used.rig, "c", name="axis").files),
        "axis_step",
        ["velocity_end", "displacement", "friction", "sticks"],
    )
    velocity, angle = 0.0, [0.0]
    for held in HELD[:-1]:
        moved = step(held, velocity, 1.0, INERTIA, PERIOD)
        velocity = moved["velocity_end"]
        angle.append(angle[-1] + moved["displacement"])
    # of order 2 in a period that is a hundredth of the time in which friction falls to a third
    assert far(np.array(angle), used.run) < 2e-3


@pytest.mark.parametrize(("kind", "close"), [("CoSimulation", 0.0), ("ModelExchange", 1e-6)])
@pytest.mark.parametrize("fmi", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_the_unit_turns_as_the_engine_does_at_the_tolerance_that_it_stores(used, kind, close, fmi):
    need_tools()
    from fmpy import read_model_description, simulate_fmu

    path = export_fmu(
        used.axis, used.law, used.folder / f"axis{fmi}.fmu", t_end=END, fmi=fmi, portable=False,
        force=True,
    )  # fmt: skip
    units = {
        variable.name: variable.unit
        for variable in read_model_description(str(path)).modelVariables
    }
    assert (units["x"], units["v"], units["friction"]) == ("rad", "rad/s", "N m")
    assert units["mechanism.inertia"] == "kg m^2"
    found = simulate_fmu(
        str(path), fmi_type=kind, stop_time=END, output_interval=PERIOD, output=["x"],
        record_events=False,
    )  # fmt: skip
    assert far(found["x"], used.run) <= close


def test_the_joint_of_mujoco_turns_as_its_friction_does_and_holds(used):
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")
    files = export(used.rig, "mjcf", name="axis").files
    model = mujoco.MjModel.from_xml_string(files["axis.xml"])
    assert model.jnt_type[0] == mujoco.mjtJoint.mjJNT_HINGE
    data, angle = mujoco.MjData(model), [0.0]
    for held in HELD[:-1]:
        data.ctrl[0] = held
        mujoco.mj_step(model, data)
        angle.append(data.qpos[0])
    speed = used.rig.estimates.largest_speed
    law = Subject(law=used.law, name="axis", load=1.0, largest_speed=speed)
    joint = simplified(law).joint
    # the joint's own friction: steps of order 1, of a thousandth of the way each at most
    alone = simulate(used.axis, joint, t_end=END)
    assert far(np.array(angle), alone) < 5e-3
    # and the law's: what least squares leave, which the engine tells without MuJoCo
    assert far(np.array(angle), used.run) == pytest.approx(
        far(alone.at(TIMES)["x"], used.run), abs=5e-3
    )
    data = mujoco.MjData(model)
    data.ctrl[0] = 0.6 * joint.level
    for _ in range(2000):
        mujoco.mj_step(model, data)
    said = 0.6 * 1.0009e-6 * joint.level / INERTIA * 2.0
    assert data.qpos[0] == pytest.approx(said, rel=0.01)  # as the file says


def test_a_law_by_hand_turns_if_it_is_said():
    linear, rotary = (export(TRUE, "c", rotary=value).files["stribeck.h"] for value in (None, True))
    assert "[N m s/rad]" in rotary
    assert "Levels are torques" in rotary
    assert "[N s/m]" in linear
    assert (
        "hinge"
        in export(TRUE, "mjcf", rotary=True, largest_speed="300 deg/s").files["stribeck.xml"]
    )
    assert replace(Axis(inertia=1.0), rotary=True) == Axis(inertia="1 kg m^2")
