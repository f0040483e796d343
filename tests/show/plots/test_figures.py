"""Figures of runs and laws say what they show, and are the same each time."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure
from tests.support import for_all, quick, wide_only

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    FixedStep,
    LuGre,
    SpringBlock,
    Stribeck,
    TowedBlock,
    Viscous,
    simulate,
)
from stickslip.identify import kinds
from stickslip.mechanisms.drives import Pulse, Sine
from stickslip.show import plots
from stickslip.show.plots import inline_svg
from stickslip.show.plots.axes import Curve, dense, grouped, horizon, label_curves, looks, wrapped
from stickslip.show.plots.laws import (
    characteristic_sizes,
    draw_characteristics,
    draw_presliding,
    presliding_sizes,
)
from stickslip.show.plots.measurements import SKETCHES, sketch
from stickslip.show.plots.runs import (
    FRICTION_SIZES,
    LOOP_SIZES,
    RUN_SIZES,
    draw_closed_loop,
    draw_friction_velocity,
    draw_run,
    draw_runs,
)
from stickslip.show.plots.studies import (
    CYCLE_SIZES,
    EXCITATION_SIZES,
    draw_cycles,
    draw_excitations,
    draw_fixed_steps,
    excitation_colours,
)
from stickslip.show.plots.theme import C1
from stickslip.study.control import PID, closed_loop

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
STEP_SIZES = {"wide": (880, 230), "narrow": (358, 370)}
COULOMB = Coulomb(kinetic_coefficient=0.25)
LAWS = {
    "Coulomb": COULOMB,
    "Viscous": Viscous(viscous_coefficient=5.73),
    "Coulomb + viscous": CoulombViscous(kinetic_coefficient=0.22, viscous_coefficient=0.5),
    "Stribeck": Stribeck(kinetic_coefficient=0.25, static_coefficient=0.35, stribeck_velocity=0.05),
    "Dahl": Dahl(kinetic_coefficient=0.25, bristle_stiffness=1000.0),
}
BRISTLE = {
    "Dahl": LAWS["Dahl"],
    "LuGre": LuGre(
        kinetic_coefficient=0.25,
        static_coefficient=0.35,
        stribeck_velocity=0.05,
        bristle_stiffness=1000.0,
        bristle_damping=1.0,
    ),
}


@pytest.fixture(scope="module")
def runs():
    return {title: simulate(RIG, law, t_end=1.5) for title, law in LAWS.items()}


@pytest.fixture(scope="module")
def figures(runs):
    """Return every figure with its sizes and some of the texts that it must carry."""
    pushed = SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))
    held = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True)
    readings = {
        "A, push": simulate(pushed, COULOMB, t_end=1.0),
        "B, released": runs["Coulomb"],
        "C, fixed": simulate(held, COULOMB, t_end=1.0),
    }
    fixed = {
        "10 ms, stick rule": simulate(RIG, COULOMB, t_end=1.0, solver=FixedStep(dt=0.01)),
        "10 ms, no stick rule": simulate(
            RIG, COULOMB, t_end=1.0, solver=FixedStep(dt=0.01, stick_rule=False)
        ),
    }
    return {
        "run": (draw_run(runs["Coulomb"]), RUN_SIZES, ["stick", "slip", "stop", "friction, N"]),
        "map": (draw_friction_velocity(runs["Dahl"]), FRICTION_SIZES, ["start", "velocity, m/s"]),
        "runs": (draw_runs(runs, chosen="Coulomb"), RUN_SIZES, ["Viscous", "displacement, m"]),
        "laws": (
            draw_characteristics(LAWS, 9.81, 0.7),
            characteristic_sizes(len(LAWS)),
            [*LAWS, "friction, N"],
        ),
        "presliding": (
            draw_presliding(BRISTLE, load=9.81),
            presliding_sizes(2),
            [*BRISTLE, "break-away 3.43 N", "displacement, mm"],
        ),
        "excitations": (
            draw_excitations(readings, chosen="B, released", band=(0.195, 0.205)),
            EXCITATION_SIZES,
            ["A, push: 0.154 m", "B, released: 0.204 m", "C, fixed: 0.098 m", "dot: block at rest"],
        ),
        "cycles": (
            draw_cycles(readings, chosen="C, fixed", cycle=(0.1, 0.8)),
            CYCLE_SIZES,
            ["A, push", "C, fixed", "displacement, m", "velocity near zero, m/s"],
        ),
        "steps": (
            draw_fixed_steps(runs["Coulomb"], fixed),
            STEP_SIZES,
            ["exact", "fixed step", "10 ms, no stick rule", "time from the exact stop, ms"],
        ),
    }


NAMES = ("run", "map", "runs", "laws", "presliding", "excitations", "cycles", "steps")


def texts_of(svg, css_class):
    roots = ElementTree.fromstring(f"<p>{svg}</p>")
    (root,) = (root for root in roots if root.get("class") == css_class)
    return ["".join(text.itertext()) for text in root.iter("text")]


@pytest.mark.parametrize("name", quick(NAMES, "run"))
def test_a_figure_is_the_same_each_time(figures, name):
    draw, sizes, _ = figures[name]
    with wide_only():
        drawing, other = (inline_svg(draw, alt=name, prefix=name, **sizes) for _ in range(2))
    assert drawing == other


@pytest.mark.parametrize("name", NAMES)
def test_a_figure_is_labelled(figures, name):
    draw, sizes, expected = figures[name]
    svg = inline_svg(draw, alt=f"Figure {name}", prefix=name, **sizes)
    assert svg.count(f'aria-label="Figure {name}"') == 2
    wide = texts_of(svg, "fw")
    assert set(expected) <= set(wide)
    assert len(texts_of(svg, "fn")) > 5
    assert not re.search(r"\b(?:nan|inf)\b|#[0-9a-f]{6}", svg)


def test_stick_and_slip_are_said_once(figures):
    draw, sizes, _ = figures["run"]
    words = texts_of(inline_svg(draw, alt="Run", prefix="r", **sizes), "fw")
    assert (words.count("stick"), words.count("slip")) == (1, 1)


def test_names_of_events_stand_above_the_panel_and_not_on_its_curve():
    block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    named = []

    def draw(figure, narrow):
        draw_run(simulate(block, law, t_end=30.0))(figure, narrow)
        panel = figure.axes[1]
        figure.draw_without_rendering()
        top = panel.get_window_extent().y1
        named.extend(text.get_text() for text in panel.texts)
        assert all(text.get_window_extent().y0 >= top for text in panel.texts)

    inline_svg(draw, alt="Run", prefix="r", **RUN_SIZES)
    assert {"break-away", "stop"} <= set(named)


@for_all(plots.__all__)
def test_a_figure_can_be_imported_from_its_room(name):
    assert getattr(plots, name) is not None


def test_every_drawing_is_named_by_its_room():
    drawn = {name for name in globals() if name.startswith("draw_")}
    assert drawn <= {*plots.__all__, *kinds.__all__}


def test_no_line_joins_the_velocities_before_and_after_a_body_hits_a_stop():
    drive = Sine(amplitude=60.0, frequency=2.0)
    axis = Axis(inertia=3.0, lower_stop=-0.02, upper_stop=0.02, restitution=0.4, drive=drive)
    run = simulate(axis, Coulomb(kinetic_coefficient=20.0), t_end=0.5)
    assert sum(event.reason == "hits stop" for event in run.events) > 10
    figure = Figure()
    draw_friction_velocity(run)(figure, False)
    v = max((line.get_xdata() for line in figure.axes[0].lines), key=len)
    # without a gap, a line would lead from sliding one way to sliding the other way
    far = np.abs(np.diff(v)) > 0.01 * np.nanmax(np.abs(v))
    assert not (far & (v[:-1] * v[1:] < 0.0)).any()
    assert np.isnan(v).any()


def test_the_axis_of_fixed_steps_names_a_stop_only_where_there_is_one(runs):
    said = {}
    for name, run in (("stops", runs["Coulomb"]), ("slides on", runs["Viscous"])):
        figure = Figure()
        draw_fixed_steps(run, {"1 ms": run})(figure, False)
        said[name] = figure.axes[0].get_xlabel()
    assert said == {
        "stops": "time from the exact stop, ms", "slides on": "time from the end of the run, ms"
    }  # fmt: skip


def test_stick_slip_that_goes_on_is_shown_to_its_end():
    block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    assert horizon(simulate(block, law, t_end=30.0)) > 25.0


def test_a_run_that_has_stopped_is_not_shown_for_long(runs):
    stop = runs["Coulomb"].events[-1].t
    assert stop < horizon(runs["Coulomb"]) < 1.5 * stop


def test_friction_jumps_upright_at_an_event(runs):
    seen = dense(runs["Coulomb"])
    stop = runs["Coulomb"].events[-1].t
    at = int(np.searchsorted(seen.t, stop))
    assert seen["friction"][at - 1] == pytest.approx(0.25 * 9.81)
    assert seen["friction"][at] == 0.0
    assert seen.t[at] - seen.t[at - 1] < 1e-15


@pytest.mark.parametrize("kind", SKETCHES)
def test_a_sketch_is_one_small_drawing_with_the_mass_on_the_block(kind):
    svg = sketch(kind, alt="Rig", prefix=kind, mass="2 kg")
    assert svg.count("<svg") == 1
    assert "2 kg" in svg
    assert ("10 N" in svg) is (kind == "push")


def test_the_chosen_series_is_blue_and_broad_and_no_two_of_25_look_alike():
    names = [f"law {i}" for i in range(25)]
    found = looks(names, "law 7")
    assert found["law 7"].colour == C1
    # the others are thin and lie upon it, so that both are seen where they coincide
    assert found["law 7"].order < min(look.order for n, look in found.items() if n != "law 7")
    rivals = {look[:2] for name, look in found.items() if name != "law 7"}
    assert len(rivals) == 20  # five colours in four dashes; beyond, labels alone


def test_the_reading_that_is_taken_is_blue():
    colours = excitation_colours(dict.fromkeys("ABCDEF"), "B")
    assert colours["B"] == C1
    assert len(set(colours.values())) == 6


def test_series_are_grouped_only_if_they_never_part():
    bent = np.array([0.0, 1.0, 0.0])
    assert grouped({"a": np.zeros(3), "b": bent, "c": np.zeros(3)}, 0.1) == [
        (0.0, ("a", "c")),
        (0.0, ("b",)),
    ]


def test_names_are_wrapped_without_being_cut():
    assert wrapped(["Coulomb + viscous", "Dahl"], 5) == ["Coulomb + viscous,", "Dahl"]


def test_names_of_curves_keep_clear_of_curves_and_of_each_other():
    boxes = []

    def draw(figure, narrow):
        axes = figure.add_subplot()
        x = np.linspace(0, 1, 50)
        curves = [Curve(x, level + 0 * x, f"level {level}", C1) for level in (0.0, 0.5, 1.0)]
        for curve in curves:
            axes.plot(curve.x, curve.y)
        axes.margins(y=0.2)
        label_curves(axes, curves)
        boxes.append(sorted(text.get_position()[1] for text in axes.texts))
        heights = sorted(text.xy[1] for text in axes.texts)
        assert np.diff(heights).min() > 0.2

    inline_svg(draw, alt="Levels", prefix="l")
    assert len(boxes) == 2


def test_a_curve_of_which_nothing_is_drawn_costs_nothing():
    named = []

    def draw(figure, narrow):
        axes = figure.add_subplot()
        x, nothing = np.linspace(0, 1, 50), np.zeros(0)
        axes.plot(x, x)
        curves = [Curve(nothing, nothing, "left", C1), Curve(x, x, "here", C1)]
        label_curves(axes, [*curves, Curve(x, np.nan * x, "lost", C1)])
        named.append([text.get_text() for text in axes.texts])

    inline_svg(draw, alt="Curves", prefix="c")
    assert named == [["here"], ["here"]]


def test_a_fixed_step_run_that_ends_before_the_exact_stop_is_drawn_empty(runs):
    fixed = simulate(RIG, COULOMB, t_end=0.1, solver=FixedStep(dt=0.001))
    svg = inline_svg(
        draw_fixed_steps(runs["Coulomb"], {"1 ms": fixed}),
        alt="Steps",
        prefix="e",
        **STEP_SIZES,
    )
    assert "exact" in texts_of(svg, "fw")


def test_a_closed_loop_shows_its_reference_and_what_breaks_it_away() -> None:
    pid = PID(proportional=100.0, integral=300.0, derivative=20.0, reference=0.1)
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    loop = closed_loop(Axis(inertia=1.0), law, pid, period=0.01, t_end=8.0)
    draw = draw_closed_loop(loop, reference=lambda t: 0.1, level=1.5, since=1.0)
    drawn = inline_svg(draw, alt="A loop", prefix="loop", **LOOP_SIZES)
    for text in ("x, m", "reference", "command, N", "break-away", "shaded: at rest"):
        assert text in drawn
    assert drawn == inline_svg(draw, alt="A loop", prefix="loop", **LOOP_SIZES)
