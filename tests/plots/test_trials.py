"""Figures of trials: parameters over a condition, coloured by it."""

import dataclasses

import numpy as np
import pytest
from matplotlib.figure import Figure

from stickslip import Axis, CoulombViscous, Measurement, compare_trials
from stickslip.errors import InputError, UnknownNameError
from stickslip.show.plots import draw_trials
from stickslip.show.plots.theme import C1, C2, house_style


def comparison(*conditions):
    draw, v = np.random.default_rng(0), 0.3 * np.sin(0.07 * np.arange(400))
    trials = tuple(
        Measurement(
            time=0.01 * np.arange(400),
            velocity=v,
            friction=(5.0 + i) * np.sign(v) + 4.0 * v + 0.1 * draw.normal(size=400),
            conditions=condition,
        )
        for i, condition in enumerate(conditions)
    )
    return compare_trials(Axis(inertia=1.0), CoulombViscous, Measurement(trials=trials))


def drawn(draw, narrow=False):
    with house_style():
        figure = Figure(figsize=(8, 4), dpi=72)
        draw(figure, narrow)
        figure.canvas.draw()
    return figure.axes


def test_trials_are_coloured_from_blue_to_orange_by_a_number():
    found = comparison(*({"temperature [degC]": t} for t in (20.0, 40.0, 60.0)))
    level, viscous, curves = drawn(draw_trials(found))
    assert level.get_title(loc="left") == r"$F_{\mathrm{c}}$, N"
    assert level.get_xlabel() == "temperature, °C"
    assert viscous.get_title(loc="left") == r"$\sigma_{\mathrm{2}}$, N s/m"
    colours = [line.get_color() for line in curves.get_lines()]
    assert (colours[0], colours[2]) == (C1, C2)
    assert colours[1] not in (C1, C2)
    points = [line for line in level.get_lines() if line.get_marker() == "o"]
    assert [line.get_xdata()[0] for line in points] == [20.0, 40.0, 60.0]
    assert [line.get_color() for line in points] == colours


def test_texts_have_a_place_and_a_colour_each():
    found = comparison({"oil": "dry"}, {"oil": "wet"}, {"oil": "dry"}, {})
    level, *_, curves = drawn(draw_trials(found), narrow=True)
    assert [text.get_text() for text in level.get_xticklabels()] == ["dry", "wet"]
    colours = [line.get_color() for line in curves.get_lines()]
    assert colours[0] == colours[2] != colours[1]
    assert len(set(colours)) == 3  # without the condition it is grey


def test_trials_without_conditions_are_numbered():
    level, *_ = drawn(draw_trials(comparison({}, {})))
    assert level.get_xlabel() == "trial"


def test_a_condition_that_no_trial_has_is_refused():
    with pytest.raises(UnknownNameError, match="condition"):
        draw_trials(comparison({"run": 1}, {"run": 2}), condition="temperature")


def test_a_trial_called_as_another_is_numbered_has_its_own_curve():
    first, second = comparison({"run": 1}, {"run": 2}).fit.measurement.records()
    slow = dataclasses.replace(second, velocity=0.1 * np.asarray(second.velocity))
    records = [dataclasses.replace(first, name="trial 2"), slow]
    again = compare_trials(Axis(inertia=1.0), CoulombViscous, Measurement(trials=tuple(records)))
    assert [trial.number for trial in again.trials] == [0, 1]
    *_, curves = drawn(draw_trials(again))
    assert max(curves.get_lines()[0].get_xdata()) > 0.2  # m/s, of the faster trial


def test_a_comparison_without_trials_is_not_drawn():
    found = dataclasses.replace(comparison({"run": 1}, {"run": 2}), trials=())
    with pytest.raises(InputError, match="nothing to draw"):
        draw_trials(found)
