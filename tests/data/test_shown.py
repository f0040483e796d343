"""A measurement as a user sees it: in the terminal, in a notebook and drawn."""

import dataclasses
import re

import numpy as np
import pytest
from matplotlib.figure import Figure

from stickslip import Axis, Measurement, SpringBlock, fit, simulate
from stickslip.friction import Coulomb
from stickslip.show import plots

TIME = np.arange(300) / 100
RECORD = Measurement(
    name="Run 3", time=TIME, position=0.02 * np.abs(np.sin(TIME)), force=TIME - 1.0
)
TRAVELS = Measurement(
    trials=tuple(
        Measurement(travel=s, uncertainty=0.004, overrides={"mechanism.compression": x})
        for s, x in ((0.07, 0.06), (0.2, 0.1), ([0.30, 0.31], 0.12))
    )
)
SPEED = np.linspace(-1.0, 1.0, 40)
MAP = Measurement(velocity=SPEED, friction=2.0 * np.sign(SPEED), turning=True)
ARM = Measurement(
    time=TIME,
    position={"shoulder": np.sin(TIME), "elbow": np.cos(TIME)},
    force={"shoulder": TIME, "elbow": -TIME},
    turning=True,
)


def test_a_measurement_is_shown_by_what_it_holds_and_not_by_its_numbers():
    assert repr(RECORD) == (
        "<Measurement: Run 3\n samples: 300\n time: 0 to 2.99 s\n position: 0 to 20 mm\n"
        " force: −1 to 1.99 N>"
    )
    assert str(TRAVELS).splitlines() == [
        "Travels",
        "trials: 3",
        "travel: 0.07 to 0.31 m, uncertainty 4 mm (standard)",
        "mechanism.compression: 0.06 to 0.12 [SI]",
    ]
    assert "friction: −2 to 2 N m" in repr(MAP)
    assert "position.elbow: " in repr(ARM)
    assert "N m" in ARM._repr_html_()
    forty = tuple(dataclasses.replace(RECORD, name=f"Run {n}") for n in range(40))
    assert len(repr(Measurement(trials=forty))) < 300


@pytest.mark.parametrize(
    ("measurement", "labels"),
    [
        (RECORD, ["position, mm", "force, N"]),
        (TRAVELS, ["travel, m"]),
        (MAP, ["friction, N m"]),
        (
            ARM,
            [
                "shoulder\nposition, rad",
                "shoulder\nforce, N m",
                "elbow\nposition, rad",
                "elbow\nforce, N m",
            ],
        ),
    ],
)
def test_a_measurement_draws_itself_with_its_units(measurement, labels):
    assert [axes.get_ylabel() for axes in measurement.plot(Figure())] == labels


def test_all_trials_are_drawn_and_all_readings():
    (axes,) = plots.plot_measurement(TRAVELS, Figure())
    drawn = [y for line in axes.containers for y in line[0].get_ydata()]
    assert drawn == [0.07, 0.2, 0.3, 0.31]
    both = Measurement(trials=(RECORD, dataclasses.replace(RECORD, name="Run 4")))
    assert all(len(axes.lines) == 2 for axes in both.plot(Figure()))


def test_a_run_is_printed_as_how_it_ended_and_where():
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    run = simulate(block, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    lines = str(run).splitlines()
    assert lines[0] == "Came to rest: no drive can move the body again."
    assert "last values: x = 0.2039 m, v = 0 m/s" in lines
    assert repr(run).startswith("<Trajectory: Came to rest")
    assert "array" not in repr(run)
    assert "last values at 0.1 s: x = " in str(run.at([1.0, 0.1]))
    assert "last values" not in str(run.at([]))
    assert "certified: yes" in str(run.at([]))


def test_a_run_is_a_collection_of_its_columns():
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    run = simulate(block, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    assert [*run] == ["x", "v", "friction", "normal_force", "mode"]
    assert "x" in run
    assert "y" not in run


def test_no_public_result_prints_its_arrays():
    along = Measurement(velocity=SPEED, friction=2.0 * np.sign(SPEED) + 0.01 * np.sin(SPEED))
    fitted = fit(Axis(inertia=1.0), Coulomb, along)
    again = Measurement(velocity=SPEED, friction=2.02 * np.sign(SPEED))
    found = repr(fitted.predict(again))
    assert re.match(r"<Foreseen: [\d.]+ % of the 40 readings lie in the band;", found)
    assert "array" not in repr(fitted.predict(again))
    assert "array" not in repr(fitted)
