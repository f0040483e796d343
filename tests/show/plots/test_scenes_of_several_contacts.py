"""Animations of mechanisms with several contacts."""

import math

import numpy as np
import pytest
from benchmarks.several.brakes import DiscBrake, Lining
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from tests.contact_cases import Arm, coulomb
from tests.support import SEVERAL, SHOWN

from stickslip import EventDriven, simulate
from stickslip.mechanisms import MECHANISMS, Link, Robot, RobotJoint, SerialArm
from stickslip.show.plots import draw_scene, standalone_svg
from stickslip.show.plots.animations import MODE_COLOURS, Stage, artists_of, frame_times, moments_of
from stickslip.show.plots.scenes import PICTURES, Ball, Box, Ground, bars, scene_of
from stickslip.show.plots.theme import SLIP_BACK, STICK, house_style

PLAIN = EventDriven(tier="python")
CASES = {name: rig for name, rig in SEVERAL.items() if rig.name in MECHANISMS}
CASES["two-link-arm"] = SHOWN["two-link-arm"]
BRAKE = DiscBrake(
    inertia=0.5, pads=(Lining(radius=0.10, load=100.0), Lining(radius=0.12, load=80.0))
)


def run_of(mechanism, t_end=0.4, y0=None):
    return simulate(mechanism, coulomb(0.3, 0.4), t_end=t_end, y0=y0, solver=PLAIN, throw=False)


def shapes_of(mechanism, run, t):
    picture = PICTURES[mechanism.name](mechanism, run.sampled(20))
    return picture.shapes(moments_of(run, mechanism, np.array([t]))[0])


def test_every_mechanism_of_ours_has_a_scene():
    names = {one.name for one in (*CASES.values(), *SHOWN.values())}
    assert names == set(MECHANISMS)
    assert set(PICTURES) == set(MECHANISMS)


@pytest.mark.parametrize("name", CASES)
def test_every_contact_is_seen_in_the_colour_of_its_mode(name):
    mechanism = CASES[name]
    rates = dict.fromkeys(mechanism.rates, 0.5)
    run = run_of(mechanism, y0=rates)
    names = {contact.name for contact in mechanism.contacts()} if run.contacts else {""}
    seen = set()
    for shape in shapes_of(mechanism, run, 0.2):
        if isinstance(shape, (Ball, Box)) and shape.fill == "mode":
            seen.add(shape.contact)
        elif isinstance(shape, Ground):
            seen.update(shape.contacts or [""] * len(shape.touched))
    assert seen == names
    svg = standalone_svg(draw_scene(run, mechanism, 0.2), size=(880, 400))
    assert "0.200 s" in svg


def test_a_contact_that_sticks_is_told_from_one_that_slips():
    arm = SerialArm(links=(Link(mass=0.5, length=0.3, centre=0.15, inertia=0.015),) * 3)
    run = run_of(arm, y0={"q1_dot": -1.0})
    with house_style():
        figure = Figure(figsize=(12, 5), dpi=72)
        FigureCanvasAgg(figure)
        stage = Stage(figure, run, arm, until=0.4)
        stage.show(moments_of(run, arm, np.array([0.02]))[0])
    assert stage._title.get_text() == "0.020 s, sticks: joint-2, joint-3"
    balls = [s for s in stage.painted.picture.shapes(moments_of(run, arm, np.array([0.02]))[0])
             if isinstance(s, Ball) and s.fill == "mode"]  # fmt: skip
    modes = {"joint-1": -1, "joint-2": 0, "joint-3": 3}
    drawn = artists_of(stage.axes, balls, modes, stage.painted.scales)
    assert [to_hex(one.get_facecolor()) for one in drawn[:2]] == [SLIP_BACK, STICK]
    assert drawn[2].get_facecolor()[3] == 0.0  # an open contact is seen through
    assert set(MODE_COLOURS) >= {-1, 0, 1, 3}


def test_joints_of_an_arm_are_drawn_where_they_are():
    links = tuple(Link(mass=0.5, length=l, centre=0.1, inertia=0.1) for l in (0.3, 0.2))  # noqa: E741
    arm = SerialArm(links=links)
    start = {"q1": 0.4, "q2": -1.1}
    shapes = shapes_of(arm, run_of(arm, y0=start), 0.0)
    elbow = (0.3 * math.sin(0.4), -0.3 * math.cos(0.4))
    end = (elbow[0] + 0.2 * math.sin(-0.7), elbow[1] - 0.2 * math.cos(-0.7))
    tip, _, second = (shape.centre for shape in shapes if isinstance(shape, Ball))
    assert tip == pytest.approx(end)
    assert second == pytest.approx(elbow)


def test_a_slide_is_drawn_along_its_axis():
    robot = Robot(
        joints=(
            RobotJoint(joint="lift", kind="prismatic", mass=1.0, place=(0.0, 0.0, 0.1)),
            RobotJoint(joint="arm", parent="lift", mass=1.0, centre_x=0.2, inertia_zz=0.1),
        )
    )
    one, other = (
        next(s for s in shapes_of(robot, run_of(robot, y0={"lift": z}), 0.0) if isinstance(s, Box))
        for z in (0.0, 0.5)
    )
    assert other.bottom > one.bottom + 0.3
    middles = [box.left + 0.5 * box.width for box in (one, other)]
    assert middles[0] == pytest.approx(middles[1], abs=1e-12)


def test_an_animation_ends_after_the_last_coordinate_has_arrived():
    run = run_of(BRAKE, t_end=8.0, y0={"omega": 5.0})
    times = frame_times(run, BRAKE, fps=5.0, speed=1.0)
    assert 0.1 < times[-1] < 2.0


def test_a_mechanism_that_nobody_has_drawn_is_shown_by_bars_in_the_colours_of_its_contacts():
    run = run_of(Arm(), y0={"shoulder": 1.0})
    assert scene_of(Arm()) is bars
    update = bars(Figure().add_subplot(), Arm(), run.sampled(20))
    (moment,) = moments_of(run, Arm(), np.array([0.1]))
    drawn = [to_hex(bar.get_facecolor()) for bar in update(moment) if isinstance(bar, Rectangle)]
    modes = [MODE_COLOURS[round(moment[f"mode:{contact}"])] for contact in run.contacts]
    assert drawn[: len(modes)] == modes
