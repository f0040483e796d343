"""Figures of runs and laws say what they show, and are the same each time."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure
from tests.support import quick, wide_only

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    FixedStep,
    LuGre,
    SpringBlock,
    Stribeck,
    Viscous,
    simulate,
)
from stickslip.mechanisms.drives import Pulse, Sine
from stickslip.show.plots import inline_svg
from stickslip.show.plots.axes import dense
from stickslip.show.plots.laws import (
    characteristic_sizes,
    draw_characteristics,
    draw_presliding,
    presliding_sizes,
)
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
    fixed_step_sizes,
)
from stickslip.study.control import PID, closed_loop

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
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
            fixed_step_sizes(2),
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


def test_friction_jumps_upright_at_an_event(runs):
    seen = dense(runs["Coulomb"])
    stop = runs["Coulomb"].events[-1].t
    at = int(np.searchsorted(seen.t, stop))
    assert seen["friction"][at - 1] == pytest.approx(0.25 * 9.81)
    assert seen["friction"][at] == 0.0
    assert seen.t[at] - seen.t[at - 1] < 1e-15


def test_a_closed_loop_shows_its_reference_and_what_breaks_it_away() -> None:
    pid = PID(proportional=100.0, integral=300.0, derivative=20.0, reference=0.1)
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    loop = closed_loop(Axis(inertia=1.0), law, pid, period=0.01, t_end=8.0)
    draw = draw_closed_loop(loop, reference=lambda t: 0.1, level=1.5, since=1.0)
    drawn = inline_svg(draw, alt="A loop", prefix="loop", **LOOP_SIZES)
    for text in ("x, m", "reference", "command, N", "break-away", "shaded: at rest"):
        assert text in drawn
    assert drawn == inline_svg(draw, alt="A loop", prefix="loop", **LOOP_SIZES)
