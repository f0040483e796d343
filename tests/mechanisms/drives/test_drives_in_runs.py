"""What a run makes of its drive."""

import itertools
from collections import OrderedDict

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support import broken_lines, drives, examples, nearly, pulses

from stickslip import Axis, Coulomb, simulate
from stickslip.engine.formulation import formulate
from stickslip.engine.solver import starts as drive_schedule
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse, Ramp, Sampled, Sine

FREE = Coulomb(kinetic_coefficient=0.0)
sines = st.builds(Sine, amplitude=nearly(-9, 9), frequency=nearly(0.1, 3))
ramps = st.builds(Ramp, rate=nearly(-9, 9), start=nearly(-0.5, 1))
samples = st.builds(
    lambda values, hold: Sampled(times=range(len(values)), values=values, hold=hold),
    st.lists(nearly(-9, 9), min_size=1, max_size=5),
    st.sampled_from(["zero", "first"]),
)
any_drive = st.one_of(drives, sines, ramps, samples, st.builds(lambda a, b: a + b, sines, pulses))


@examples(40)
@given(drive=any_drive)
def test_a_free_body_gains_the_momentum_that_the_drive_gives(drive):
    inertia, t_end = 2.0, 1.7
    run = simulate(Axis(inertia=inertia, drive=drive), FREE, t_end=t_end)
    starts = [piece.start for piece in drive.pieces(t_end) if 0 < piece.start < t_end]
    edges = np.array([0.0, *starts, t_end])
    # Gauss-Legendre is exact for lines, and to 1e-14 for up to six waves at 60 nodes
    nodes, weights = np.polynomial.legendre.leggauss(60)
    impulse = size = 0.0
    for low, high in itertools.pairwise(edges):
        t = low + 0.5 * (high - low) * (nodes + 1)
        values = np.array([drive.value(float(moment)) for moment in t])
        impulse += 0.5 * (high - low) * float(weights @ values)
        size += 0.5 * (high - low) * float(weights @ np.abs(values))
    # the tolerance of the solver, 1e-12 a step, over some tens of steps
    assert abs(run["v"][-1] * inertia - impulse) <= 1e-10 * size


@examples(25)
@given(drive=st.one_of(pulses, broken_lines, ramps, samples, drives), t=st.floats(0.01, 1.69))
def test_the_force_that_holds_a_body_is_the_drive_at_every_time(drive, t):
    firm = Coulomb(kinetic_coefficient=1e3)
    run = simulate(Axis(inertia=2.0, drive=drive), firm, t_end=1.7)
    # carried from the start of the piece: a few roundings of slopes up to 200 N/s
    assert abs(run.at(t)["friction"][0] - drive.value(t)) <= 1e-12
    assert np.all(run["x"] == 0)


def test_a_body_is_held_again_from_the_moment_the_drive_allows():
    drive = PiecewiseLinear(times=(0.0, 1.0), values=(0.0, 2.0)) + Pulse(
        level=-2.0, duration=10.0, start=1.5
    )
    law = Coulomb(kinetic_coefficient=1.0)
    run = simulate(Axis(inertia=1.0, drive=drive), law, t_end=5.0)
    # slip from 0.5 s; (t - 0.5)^2 up to 1 s, then 1 m/s^2 to 1.5 s, then -1 m/s^2 to rest
    speed = 0.25 + 0.5
    assert [event.reason for event in run.events] == ["break-away", "stop"]
    np.testing.assert_allclose(
        [event.t for event in run.events], [0.5, 1.5 + speed], rtol=1e-12
    )  # located to rounding


def test_a_pulse_much_shorter_than_any_step_is_not_missed():
    drive = Pulse(level=1e6, duration=1e-6, start=3.0)
    run = simulate(Axis(inertia=1.0, drive=drive), Coulomb(kinetic_coefficient=0.1), t_end=100.0)
    v = (1e6 - 0.1) * 1e-6
    travel = 0.5 * v * 1e-6 + v * v / (2 * 0.1)
    # the pulse's length is only known to 4e-16 s in a clock that shows 3 s: 4e-10 of it
    np.testing.assert_allclose(run["x"][-1], travel, rtol=2e-9)


def test_schedules_are_kept_as_long_as_their_numbers_are_few(monkeypatch):
    monkeypatch.setattr(drive_schedule, "_KEPT", OrderedDict())
    # four numbers a piece: two of these drives fit, three do not
    monkeypatch.setattr(drive_schedule, "MOST_NUMBERS", 1000)
    times = np.arange(100) * 0.01
    axes = [Axis(inertia=1.0, drive=Sampled(times=times, values=times * k)) for k in range(3)]
    model = formulate(axes[0], FREE)

    def table(axis):
        return drive_schedule.gather(axis, FREE, model, 1.0).table

    first, second = table(axes[0]), table(axes[1])
    assert table(axes[0]).base is first.base
    third = table(axes[2])  # the one that was used last stays
    assert table(axes[0]).base is first.base
    assert table(axes[2]).base is third.base
    assert table(axes[1]).base is not second.base
    long = Axis(inertia=1.0, drive=Sampled(times=np.arange(300) * 0.01, values=np.zeros(300)))
    assert table(long).base is not table(long).base


def test_what_is_kept_is_not_counted_anew_for_each_short_schedule(monkeypatch):
    monkeypatch.setattr(drive_schedule, "_numbers", lambda: pytest.fail("counted"))
    for level in (1.0, 2.0):
        axis = Axis(inertia=1.0, drive=Pulse(level=level, duration=0.1))
        drive_schedule.gather(axis, FREE, formulate(axis, FREE), 1.0)
