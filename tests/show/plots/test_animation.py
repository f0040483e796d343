"""Animations: drawn to scale, coloured by stick and slip, as many frames as were asked for."""

import math
import stat
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from PIL import Image

from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    FixedStep,
    Pendulum,
    PendulumCart,
    PIDAxis,
    SpringBlock,
    TowedBlock,
    TwoMassAxis,
    TwoMassCapsule,
    animate,
    simulate,
)
from stickslip.errors import InputError
from stickslip.mechanisms import MECHANISMS, InnerMass, Prescribed, Torque
from stickslip.mechanisms.drives import Pulse, Sine, ThreePhase
from stickslip.show.plots import animation_html, draw_scene, standalone_svg
from stickslip.show.plots.animations import _PAINTERS as PAINTERS
from stickslip.show.plots.animations import MODE_COLOURS, Stage, frame_times, moments_of
from stickslip.show.plots.scenes import (
    PICTURES,
    Arrow,
    Ball,
    Box,
    Coil,
    Rod,
    Scales,
    Turn,
    bars,
    extent_of,
    scene_of,
)
from stickslip.show.plots.theme import SLIP_BACK, STICK, SURFACE, house_style

LAW = Coulomb(kinetic_coefficient=0.2)
SMALL = (440.0, 320.0)
KNOCK = Sine(amplitude=1.0, frequency=4.0)
SWING = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
CASES = {
    "spring-block": (SpringBlock(mass=1.0, stiffness=100.0, compression=0.1), {}),
    "towed-block": (TowedBlock(mass=1.0, stiffness=20.0, speed=0.1), {}),
    "axis": (
        Axis(inertia=2.0, drive=Sine(amplitude=5.0, frequency=1.0), stiffness=3.0, lower_stop=-0.1),
        {},
    ),
    "two-mass-axis": (
        TwoMassAxis(
            motor_inertia=0.5, load_inertia=1.5, stiffness=200.0,
            drive=Pulse(level=5.0, duration=1.0),
        ),
        {},
    ),
    "pid-axis": (
        PIDAxis(
            inertia=1.0, proportional=100.0, integral=300.0, derivative=20.0, reference=0.1,
            drive=Pulse(level=5.0, duration=0.7),
        ),
        {},
    ),
    "pendulum": (Pendulum(mass=0.2, length=0.5), {"theta": 0.9}),
    "pendulum-cart": (
        PendulumCart(
            cart_mass=0.5, ball_mass=0.1, length=0.3, wheelbase=0.8, pivot_height=0.05,
            pendulum=Prescribed(profile=SWING),
        ),
        {},
    ),
    "capsule": (
        Capsule(
            capsule_mass=0.8, inner_mass=0.2, stiffness=100.0, upper_stop=0.02, restitution=0.6,
            drive=Torque(drive=Sine(amplitude=1.0, frequency=4.0), limit=0.8),
        ),
        {},
    ),
    "two-mass-capsule": (
        TwoMassCapsule(
            capsule_mass=0.5,
            first=InnerMass(mass=0.2, stiffness=100.0, drive=Torque(drive=KNOCK)),
            second=InnerMass(
                mass=0.1, stiffness=400.0, damping=2.0, angle=math.pi / 2, drive=Torque(drive=KNOCK)
            ),
        ),
        {},
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def runs():
    return {
        name: simulate(mechanism, LAW, t_end=1.2, y0=y0) for name, (mechanism, y0) in CASES.items()
    }


def shapes_at(name, runs, t):
    mechanism, _ = CASES[name]
    run = runs[name]
    picture = PICTURES[mechanism.name](mechanism, run.sampled(50))
    (moment,) = moments_of(run, mechanism, np.array([t]))
    return moment, picture.shapes(moment)


def only(shapes, kind):
    return [shape for shape in shapes if isinstance(shape, kind)]


def test_every_mechanism_of_ours_with_one_contact_has_a_scene_and_a_case_here():
    alone = {name for name, kind in MECHANISMS.items() if not kind.contact_names}
    both = {"pendulum-cart", "two-mass-axis"}  # where a second contact need not rub
    assert set(CASES) == alone | both
    assert all(scene_of(mechanism) is None for mechanism, _ in CASES.values())


@pytest.mark.parametrize("name", CASES)
def test_every_scene_is_drawn_at_any_moment(name, runs):
    run = runs[name]
    svg = standalone_svg(draw_scene(run, CASES[name][0], run.span[1]), size=(880, 400))
    assert f"{run.span[1]:.3f} s" in svg


def test_what_colours_mean_is_said_once_below_panels_side_by_side(runs):
    svg = standalone_svg(draw_scene(runs["capsule"], CASES["capsule"][0], 1.0), size=(640, 400))
    assert svg.count("yellow: stick, blue: slip back") == 1


@pytest.mark.parametrize("name", ["spring-block", "pendulum-cart", "capsule"])
@pytest.mark.parametrize("beta", [0.2, -0.1])
def test_a_plumb_line_hangs_over_inclined_ground_as_gravity_points(name, beta):
    mechanism = replace(CASES[name][0], incline=beta)
    run = simulate(mechanism, LAW, t_end=0.3)
    picture = PICTURES[mechanism.name](mechanism, run.sampled(50))
    (moment,) = moments_of(run, mechanism, np.array([0.1]))
    level = PICTURES[mechanism.name](CASES[name][0], run.sampled(50)).shapes(moment)
    added = [shape for shape in picture.shapes(moment) if shape not in level]
    _, line = only(added, Rod)
    (top, bottom) = np.array(line.points)
    down = (bottom - top) / np.hypot(*(bottom - top))
    # in the frame of the ground gravity has -sin beta along x and -cos beta along the normal
    np.testing.assert_allclose(down, [-math.sin(beta), -math.cos(beta)], rtol=1e-12)


def test_the_cart_is_drawn_to_scale(runs):
    for t in (0.0, 0.31, 0.8):
        now, shapes = shapes_at("pendulum-cart", runs, t)
        (rod,) = only(shapes, Rod)
        pivot, ball = rod.points
        assert pivot == pytest.approx((now["x"], 0.05))
        assert math.dist(pivot, ball) == pytest.approx(0.3, rel=1e-12)
        assert ball[0] - now["x"] == pytest.approx(-0.3 * math.sin(now["theta"]), abs=1e-12)
        wheels = sorted(b.centre[0] for b in only(shapes, Ball) if b.centre[1] < 0.05)
        assert wheels == pytest.approx([now["x"] - 0.4, now["x"] + 0.4])


def test_the_pendulum_hangs_below_its_pivot(runs):
    now, shapes = shapes_at("pendulum", runs, 0.4)
    rod = only(shapes, Rod)[-1]
    assert rod.points[0] == (0.0, 0.0)
    assert rod.points[1] == pytest.approx(
        (0.5 * math.sin(now["theta"]), -0.5 * math.cos(now["theta"]))
    )


def test_the_spring_ends_at_the_block_until_the_block_leaves_it(runs):
    run = runs["spring-block"]
    (leaving,) = (e.t for e in run.events if e.reason == "block leaves the spring")
    now, shapes = shapes_at("spring-block", runs, 0.5 * leaving)
    assert only(shapes, Coil)[0].end[0] == only(shapes, Box)[0].left == now["x"]
    now, shapes = shapes_at("spring-block", runs, run.span[1])
    assert only(shapes, Coil)[0].end[0] == pytest.approx(0.1)  # its natural length
    assert only(shapes, Box)[0].left == now["x"] > 0.1


def test_the_far_end_of_a_towed_block_moves_at_its_speed(runs):
    ends = [only(shapes_at("towed-block", runs, t)[1], Coil)[0].end[0] for t in (0.0, 1.0)]
    assert ends[1] - ends[0] == pytest.approx(0.1)


def test_the_inner_mass_touches_the_stop_where_it_strikes_it(runs):
    run = runs["capsule"]
    t = next(event.t for event in run.events if event.reason == "xi hits stop")
    _, shapes = shapes_at("capsule", runs, t)
    post = next(box for box in only(shapes, Box) if box.fill == "solid")
    mass = next(box for box in only(shapes, Box) if box.fill == "body")
    # the event is located to rounding in time, at some tenths of a metre a second
    assert post.left == pytest.approx(mass.left + mass.width, abs=1e-9)


def test_a_motor_that_saturates_is_drawn_with_its_limit(runs):
    now, shapes = shapes_at("capsule", runs, 1.0 / 16.0)
    assert now["motor"] == pytest.approx(1.0)
    (force,) = (arrow for arrow in only(shapes, Arrow) if arrow.role == "drive")
    assert force.value == 0.8


def test_friction_points_against_the_slip_and_arrows_have_one_scale(runs):
    now, shapes = shapes_at("spring-block", runs, 0.1)
    friction, normal = only(shapes, Arrow)
    assert now["v"] > 0 > friction.along[0] * friction.value
    bare, full = extent_of(shapes), extent_of(shapes, Scales(0.01, 0.0))
    assert normal.value == pytest.approx(9.81)
    assert full.top == pytest.approx(max(bare.top, 0.0981))


def staged(name, runs, size=(880.0, 400.0)):
    mechanism, _ = CASES[name]
    figure = Figure(figsize=(size[0] / 72, size[1] / 72), dpi=72)
    FigureCanvasAgg(figure)
    run = runs[name]
    return figure, Stage(figure, run, mechanism, until=run.span[1])


@pytest.mark.parametrize("name", ["spring-block", "pendulum-cart"])
def test_a_metre_is_as_long_upwards_as_along_and_the_key_is_as_long_as_it_says(name, runs):
    with house_style():
        _, stage = staged(name, runs)
        box = stage.axes.get_window_extent()
        (left, right), (low, high) = stage.axes.get_xlim(), stage.axes.get_ylim()
        assert box.width / (right - left) == pytest.approx(box.height / (high - low))
        (bar,) = (one for one in stage.axes.artists if one.get_gid() == "force-scale")
        said = bar.txt_label.get_text()
        (line,) = bar.size_bar.get_children()
    force = float(said.removesuffix(" N"))
    assert line.get_width() == pytest.approx(force * stage.painted.scales.metres)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_arc_of_a_torque_stays_above_its_centre(sign):
    brush = SimpleNamespace(scales=Scales(metres=0.0, torque=2.0))
    turn = Turn(centre=(0.0, 1.0), radius=0.5, value=2.0 * sign, role="drive")
    arc, _ = PAINTERS[Turn](turn, brush)
    # the largest torque of a run: from the top to the side, and no further
    assert (arc.theta1, arc.theta2) == ((90.0, 180.0) if sign > 0 else (0.0, 90.0))


def test_what_rubs_has_the_colour_of_its_mode(runs):
    mechanism, _ = CASES["pendulum-cart"]
    run = runs["pendulum-cart"]
    times = np.linspace(0.0, 1.2, 40)
    seen = set()
    with house_style():
        _, stage = staged("pendulum-cart", runs)
        for moment in moments_of(run, mechanism, times):
            artists = stage.show(moment)
            touched = [a for a in artists if isinstance(a, Rectangle) and a.get_gid() == "contact"]
            assert len(touched) == 2  # one below each wheel
            mode = round(moment["mode"])
            assert {to_hex(a.get_facecolor()) for a in touched} == {MODE_COLOURS[mode]}
            seen.add(mode)
    assert seen == {-1, 0, 1}
    assert (MODE_COLOURS[0], MODE_COLOURS[1], MODE_COLOURS[-1]) == (STICK, SURFACE, SLIP_BACK)


def test_the_view_follows_what_goes_far():
    mechanism = TowedBlock(mass=1.0, stiffness=20.0, speed=0.1)
    law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.3)
    run = simulate(mechanism, law, t_end=60.0)
    with house_style():
        figure = Figure(figsize=(12, 5), dpi=72)
        FigureCanvasAgg(figure)
        stage = Stage(figure, run, mechanism, until=60.0)
        for moment in moments_of(run, mechanism, np.array([0.0, 30.0, 60.0])):
            stage.show(moment)
            left, right = stage.axes.get_xlim()
            assert left < moment["x"] < right
            assert right - left < 2.0  # of the 6 m that it goes


@pytest.mark.parametrize(("fps", "stands", "frames"), [(10, 100, 16), (8, 120, 13), (33, 30, 51)])
def test_a_gif_shows_the_run_at_the_speed_asked_for(fps, stands, frames, runs, tmp_path):
    mechanism, _ = CASES["pendulum-cart"]
    calls = []
    path = animate(
        runs["pendulum-cart"], mechanism, tmp_path / "cart.gif", fps=fps, speed=0.5, until=0.75,
        size=SMALL, progress=lambda done, total: calls.append((done, total)),
    )  # fmt: skip
    with Image.open(path) as gif:
        assert (gif.format, gif.n_frames, gif.size) == ("GIF", frames, (440, 320))
        assert gif.info["loop"] == 0
        lengths = set()
        for frame in range(gif.n_frames):
            gif.seek(frame)
            lengths.add(gif.info["duration"])
    # a GIF counts hundredths of a second: the frames are those of that rate
    assert lengths == {stands}
    assert (frames - 1) * stands <= 1500 < frames * stands
    assert calls == [(i + 1, frames) for i in range(frames)]
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", ["pendulum-cart", "towed-block"])
def test_frames_over_a_still_picture_are_those_that_are_drawn_anew(name, runs):
    mechanism, _ = CASES[name]
    run = simulate(mechanism, LAW, t_end=30.0) if name == "towed-block" else runs[name]
    moments = moments_of(run, mechanism, np.linspace(0.0, run.span[1], 3))
    pictures = []
    for settled in (False, True):
        figure = Figure(figsize=(10, 4.5), dpi=72)
        canvas = FigureCanvasAgg(figure)
        with house_style():
            stage = Stage(figure, run, mechanism, until=run.span[1])
            moved = stage.show(moments[0])
            if settled:
                stage.settle(moved)
                assert FigureCanvasAgg(figure) is not canvas
            for moment in moments[1:]:
                stage.show(moment)
            drawn = FigureCanvasAgg(figure)
            drawn.draw()
            pictures.append(np.asarray(drawn.buffer_rgba()).astype(int))
    difference = np.abs(pictures[0] - pictures[1]).max(axis=2)
    # edges that lie on each other are blended in another order
    assert np.mean(difference > 40) < 1e-3
    assert stage.painted.follows == (name == "towed-block")


def test_pixels_of_the_body_are_those_of_its_mode(runs, tmp_path):
    mechanism, _ = CASES["spring-block"]
    run = runs["spring-block"]
    path = animate(run, mechanism, tmp_path / "block.gif", fps=10, until=0.6, size=(880, 400))
    expected = {0: STICK, 1: SURFACE}
    with house_style():
        _, stage = staged("spring-block", runs)
    with Image.open(path) as gif:
        for frame in (2, 6):
            (moment,) = moments_of(run, mechanism, np.array([frame / 10]))
            body = next(s for s in stage.painted.picture.shapes(moment) if isinstance(s, Box))
            inside = (body.left + 0.15 * body.width, body.bottom + 0.85 * body.height)
            x, y = stage.axes.transData.transform(inside)
            gif.seek(frame)
            colour = to_hex(np.array(gif.convert("RGB").getpixel((int(x), 400 - int(y)))) / 255)
            assert colour == expected[round(moment["mode"])]


def test_a_cancelled_animation_leaves_nothing(runs, tmp_path):
    mechanism, _ = CASES["pendulum"]
    found = animate(
        runs["pendulum"], mechanism, tmp_path / "clock.gif", fps=5, size=SMALL,
        progress=lambda done, total: done < 2,
    )  # fmt: skip
    assert found is None
    assert list(tmp_path.iterdir()) == []


def test_a_scene_of_ones_own_is_made_of_artists(runs, tmp_path):
    mechanism, _ = CASES["spring-block"]
    run = runs["spring-block"]
    seen = []

    def scene(axes, mechanism, run):
        axes.set(xlim=(-0.2, 0.6), ylim=(0.0, 0.4))
        body = axes.add_patch(Rectangle((0.0, 0.0), 0.1, 0.1, facecolor="#ff0000"))

        def update(now):
            seen.append(now["x"])
            body.set_x(now["x"])
            return [body]

        return update

    path = tmp_path / "own.gif"
    animate(run, mechanism, path, fps=5, until=0.4, size=(880, 400), scene=scene)
    places = []
    with Image.open(path) as gif:
        for frame in range(gif.n_frames):
            gif.seek(frame)
            red = np.all(np.abs(np.array(gif.convert("RGB")) - (255.0, 0, 0)) < 20, axis=2)
            places.append(np.flatnonzero(red.any(axis=0))[0])
    assert seen == run.at(np.array([0.0, 0.2, 0.4]))["x"].tolist()
    # the scene has its own limits of 0.8 m
    steps = np.diff(places) / np.diff(seen)
    assert steps[0] == pytest.approx(steps[1], rel=0.05)


def test_a_mechanism_without_a_scene_has_a_bar_for_each_state(runs):
    mechanism, _ = CASES["pendulum-cart"]
    run = runs["pendulum-cart"]
    axes = Figure().add_subplot()
    update = bars(axes, mechanism, run.sampled(50))
    (moment,) = moments_of(run, mechanism, np.array([0.3]))
    drawn = [one for one in update(moment) if isinstance(one, Rectangle)]
    fills = [MODE_COLOURS[round(moment["mode"])], *[SURFACE] * 3]
    assert [to_hex(bar.get_facecolor()) for bar in drawn] == fills
    largest = float(np.abs(run.sampled(50)["theta"]).max())
    assert drawn[1].get_width() == pytest.approx(moment["theta"] / largest)
    assert [label.get_text() for label in axes.get_yticklabels()] == list(run.states)


@pytest.mark.parametrize(
    ("name", "settings", "words"),
    [
        ("cart.avi", {}, "one of .gif, .mp4"),
        ("cart.gif", {"fps": 60}, "at most 50 frames a second"),
        ("cart.gif", {"fps": 0}, "fps .* must be above 0"),
        ("cart.gif", {"speed": 1e-4}, "raise `speed`"),
        ("cart.gif", {"until": 99.0}, "until must lie between"),
        ("cart.gif", {"size": (20, 20)}, "size must be at least 200"),
        ("cart.gif", {"size": 400}, "size must be .width, height."),
        ("cart.gif", {"size": ("wide", 400)}, "size: width must be a finite number"),
        ("cart.gif", {"fps": "25"}, "fps must be a finite number, got '25'"),
        ("cart.gif", {"speed": None}, "speed must be a finite number"),
        ("cart.gif", {"dpi": "high"}, "dpi must be a finite number"),
        ("cart.gif", {"until": "end"}, "until must be a finite number"),
        ("cart.gif", {"scene": "cart"}, "scene must be a function"),
        ("no/folder/cart.gif", {"until": 0.1, "size": SMALL}, "cannot be written"),
    ],
)
def test_what_cannot_be_drawn_is_refused(name, settings, words, runs, tmp_path):
    with pytest.raises(InputError, match=words):
        animate(runs["pendulum-cart"], CASES["pendulum-cart"][0], tmp_path / name, **settings)
    assert list(tmp_path.iterdir()) == []


def test_a_path_is_a_text_or_a_path(runs):
    with pytest.raises(InputError, match="path must be the name of a file"):
        animate(runs["pendulum"], CASES["pendulum"][0], 3)


def test_a_run_of_another_mechanism_is_refused(runs, tmp_path):
    run, other = runs["pendulum-cart"], CASES["capsule"][0]
    words = "not a run of Capsule, whose states are .*xi"
    with pytest.raises(InputError, match=words):
        animate(run, other, tmp_path / "cart.gif")
    with pytest.raises(InputError, match=words):
        draw_scene(run, other, 0.1)
    with pytest.raises(InputError, match="run must be a Trajectory"):
        draw_scene(None, other, 0.1)
    with pytest.raises(InputError, match="mechanism must be a Mechanism"):
        draw_scene(run, None, 0.1)
    with pytest.raises(InputError, match="t must be a finite number"):
        draw_scene(run, CASES["pendulum-cart"][0], "late")


def test_runs_in_fixed_steps_are_drawn_too():
    clock = CASES["pendulum"][0]
    start = {"theta": 0.5}
    run = simulate(
        clock, Coulomb(kinetic_coefficient=0.02), t_end=1.0, y0=start, solver=FixedStep(dt=0.01)
    )
    assert "<svg" in standalone_svg(draw_scene(run, clock, 0.5), size=(880, 400))


def test_without_ffmpeg_an_mp4_is_refused_with_the_cure(runs, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="apt install ffmpeg"):
        animate(runs["pendulum"], CASES["pendulum"][0], tmp_path / "clock.mp4")


def ffmpeg(folder, body):
    """Put a program of that name on the PATH."""
    program = folder / "ffmpeg"
    program.write_text(f"#!{sys.executable}\nimport sys\n{body}\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)


def test_ffmpeg_is_given_every_frame(runs, tmp_path, monkeypatch):
    tools = tmp_path / "tools"
    tools.mkdir()
    ffmpeg(tools, "open(sys.argv[-1], 'wb').write(sys.stdin.buffer.read())")
    monkeypatch.setenv("PATH", str(tools))
    run, mechanism = runs["pendulum"], CASES["pendulum"][0]
    path = animate(run, mechanism, tmp_path / "clock.mp4", fps=5, until=1.0, size=SMALL)
    assert path.stat().st_size == 6 * 440 * 320 * 4


def test_what_ffmpeg_complains_of_is_passed_on(runs, tmp_path, monkeypatch):
    tools = tmp_path / "tools"
    tools.mkdir()
    ffmpeg(tools, "sys.exit('Unknown encoder libx264')")
    monkeypatch.setenv("PATH", str(tools))
    with pytest.raises(InputError, match="Unknown encoder libx264"):
        animate(runs["pendulum"], CASES["pendulum"][0], tmp_path / "clock.mp4", fps=5, size=SMALL)
    assert list(tmp_path.iterdir()) == [tools]


def test_the_animation_ends_some_time_after_the_body_has_arrived():
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=10.0)
    last = frame_times(run, rig, fps=25, speed=1.0)[-1]
    (stop,) = (event.t for event in run.events if event.reason == "stop")
    assert stop < last < 2 * stop


@pytest.mark.slow
def test_a_page_has_the_animation_bounded_and_a_still_for_print(runs):
    run, mechanism = runs["pendulum"], CASES["pendulum"][0]
    settings = {"alt": 'A "clock"', "fps": 20, "until": 1.0, "size": SMALL}
    page = animation_html(run, mechanism, **settings)
    assert 'alt="A &quot;clock&quot;"' in page
    assert page.index('media="print') < page.index("data:image/gif;base64,")
    small = animation_html(run, mechanism, most_bytes=len(page) // 3, **settings)
    assert len(small) < len(page)
    with pytest.raises(InputError, match="most_bytes"):
        animation_html(run, mechanism, most_bytes=100, **settings)
