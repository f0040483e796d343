"""Segments simulated from states of their own: slopes, projections, exact records."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.friction.definition import error_of_segments

from stickslip import Axis, CoulombViscous, Measurement, Pendulum, fit, simulate
from stickslip.identify.fits import (
    FreeParameter,
    FreeParameters,
    Shooting,
    improve,
    measured_quantity,
    segments_of,
)
from stickslip.identify.fits.shooting.initial_states import AGREE, Known, LocalState, Start, Ways
from stickslip.mechanisms.drives import Sampled
from stickslip.quantities import parameters

TRUE = CoulombViscous(kinetic_coefficient=3.0, viscous_coefficient=8.0)
RIG = Axis(inertia=4.0, offset=-0.4)
RATE = 200.0
CLOCK = Pendulum(mass=0.2, length=0.5)
TRUE_DECAY = CoulombViscous(kinetic_coefficient=0.02, viscous_coefficient=0.003)


def record_of(rig, law, *, end=6.0):
    """Return an exact record: the force is held between samples, as it is in the segments."""
    t = np.arange(0.0, end, 1.0 / RATE)
    force = 9.0 * np.sin(2.0 * math.pi * 0.5 * t) + 4.0 * np.sin(2.0 * math.pi * 1.3 * t)
    drive = Sampled(times=t.tolist(), values=force.tolist())
    driven = Axis(inertia=rig.inertia, offset=rig.offset, drive=drive)
    run = simulate(driven, law, t_end=float(t[-1]))
    return Measurement(time=t, position=run.at(t)["x"], force=force)


def test_threads_change_no_digit(record, monkeypatch):
    problem, found = problem_of(record), []
    for count in ("1", "3"):
        monkeypatch.setenv("STICKSLIP_THREADS", count)
        near = problem.linearise(problem.free_parameters.start)
        again = problem.linearise(0.9 * problem.free_parameters.start, near)
        found.append(np.column_stack([again.residual, again.slopes]))
    assert np.array_equal(*found)


def problem_of(record):
    """Return runs of the axis, with two parameters of the law and two of the axis."""
    known = {path: (item, x) for path, item, x in parameters(RIG, "mechanism")}
    known |= {path: (item, x) for path, item, x in parameters(TRUE, "friction")}
    paths = [
        "friction.kinetic_coefficient", "friction.viscous_coefficient", "mechanism.offset",
        "mechanism.inertia",
    ]  # fmt: skip
    items = [
        FreeParameter(path=path, quantity=known[path][0], start=1.2 * known[path][1])
        for path in paths
    ]
    return Shooting(
        law=TRUE,
        free_parameters=FreeParameters(tuple(items)),
        segments=segments_of(RIG, record, length=0.5),
        quantity=measured_quantity(record),
    )


@pytest.fixture(scope="module")
def record():
    return record_of(RIG, TRUE)


@pytest.mark.parametrize("quantity", ["position", "velocity"])
def test_an_exact_record_gives_its_parameters_back(record, quantity):
    seen = record
    if quantity == "velocity":
        drive = Sampled(times=record.time.tolist(), values=record.force.tolist())
        run = simulate(replace(RIG, drive=drive), TRUE, t_end=float(record.time[-1]))
        seen = Measurement(time=record.time, velocity=run.at(record.time)["v"], force=record.force)
    problem = problem_of(seen)
    end = improve(problem, problem.free_parameters.start, rounds=60, least=1e-16)
    # initial states are settled to 1e-6 of the motion
    assert end.values == pytest.approx([3.0, 8.0, -0.4, 4.0], rel=1e-5)
    assert end.rms < 1e-6 * 0.2


def test_slopes_are_those_of_residuals_whose_initial_states_are_fitted(record):
    problem = problem_of(record)
    # what a change of the initial states' own slopes does is left out, and multiplies the residual
    at = np.array([3.0, 8.0, -0.4, 4.0])
    here = problem.linearise(at)
    for _ in range(3):
        here = problem.linearise(at, here)
    count = len(problem.segments[0].times)
    moving = slice(count, None)  # the first begins at rest, on the edge between stick and slip
    for i, value in enumerate(at):
        step = np.zeros(len(at))
        step[i] = 1e-4 * abs(value)
        ends = []
        for side in (1.0, -1.0):
            there = problem.linearise(at + side * step, here)
            ends.append(problem.linearise(at + side * step, there).residual)
        central = (ends[1] - ends[0]) / (2.0 * step[i])
        # central differences over 2e-4 of the value, and initial states fitted to second order
        scale = np.max(np.abs(central[moving]))
        np.testing.assert_allclose(here.slopes[moving, i], central[moving], atol=1e-3 * scale)


def test_residuals_have_next_to_nothing_left_that_an_initial_state_can_do(record):
    problem = problem_of(record)
    off = 0.99 * np.array([3.0, 8.0, -0.4, 4.0])
    here = problem.linearise(off)
    again = problem.linearise(off, here)
    assert (1.0 - AGREE) * here.cost < again.cost <= here.cost
    ends = np.cumsum([0, *(len(segment.times) for segment in problem.segments)])
    for k, local in here.memory.items():
        own = slice(ends[k], ends[k + 1])
        assert np.max(np.abs(local.basis.T @ here.slopes[own])) < 1e-9 * np.abs(local.slopes).max()


def test_values_that_no_law_can_have_are_infinitely_wrong(record):
    problem = problem_of(record)
    here = problem.linearise(-problem.free_parameters.start)
    assert math.isinf(here.cost)
    assert not improve(problem, np.full(4, math.nan), rounds=9, least=1e-9).finite


def decay_of(law, start, *, end=30.0, noise=1e-3, seed=0):
    """Return the decay of a pendulum that comes to rest after a third of the record."""
    run = simulate(CLOCK, law, t_end=end, y0={"theta": start})
    t = np.arange(0.0, end, 0.01)
    angle = np.asarray(run.at(np.minimum(t, run.t[-1]))["theta"])
    angle = angle + noise * np.random.default_rng(seed).normal(size=len(t))
    return Measurement(time=t, position=angle)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("level", "start", "other"),
    [
        (0.02, 0.8, 0.6),
        *(
            pytest.param(*one, marks=pytest.mark.slow)
            for one in ((0.02, 0.5, 0.4), (0.03, 0.7, 0.55))
        ),
    ],
)
def test_a_decay_that_ends_at_rest_is_fitted_and_predicted_to_its_noise(level, start, other):
    law = CoulombViscous(kinetic_coefficient=level, viscous_coefficient=0.003)
    found = fit(CLOCK, CoulombViscous, decay_of(law, start, seed=1))
    assert found.law.kinetic_coefficient == pytest.approx(level, rel=0.02)
    fresh = decay_of(law, other, seed=2)
    for horizon in (1.0, 4.0):
        assert error_of_segments(found, fresh, horizon).value == pytest.approx(1e-3, rel=0.1)


def dwelling(seed, *, noise=1e-5, end=16.0):
    """Return a record of an axis that is pushed in bursts, and held by stiction between them."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, end, 1.0 / RATE)
    force, at = np.zeros_like(t), 0.0
    while at < end:
        burst, dwell = random.uniform(0.3, 1.0), random.uniform(1.0, 3.0)
        force[(t >= at) & (t < at + burst)] = random.choice((-1.0, 1.0)) * random.uniform(5, 10)
        dwelt = (t >= at + burst) & (t < at + burst + dwell)
        force[dwelt] = random.uniform(-1.5, 1.5)
        at += burst + dwell
    drive = Sampled(times=t.tolist(), values=force.tolist())
    run = simulate(replace(RIG, drive=drive), TRUE, t_end=float(t[-1]))
    return Measurement(time=t, position=run.at(t)["x"] + noise * random.normal(size=len(t)),
                       force=force)  # fmt: skip


@pytest.mark.slow
def test_an_axis_that_dwells_under_stiction_is_fitted_and_predicted_to_its_noise():
    found = fit(Axis(inertia=1.0), CoulombViscous, dwelling(1), vary=["friction.*", "inertia"])
    estimates = {one.path: one for one in found.estimates}
    truth = {"friction.kinetic_coefficient": 3.0, "friction.viscous_coefficient": 8.0,
             "offset": -0.4, "mechanism.inertia": 4.0}  # fmt: skip
    for path, value in truth.items():
        assert estimates[path].low < value < estimates[path].high
    # with the time errors grow, and whether a body comes to rest in one sample or the next
    for horizon, most in ((0.5, 1.1e-5), (1.0, 3e-5)):
        assert error_of_segments(found, dwelling(11), horizon).value < most, horizon


@pytest.mark.parametrize("speed", [1e-12, 1e-9, 1e-6, 1e-4])
def test_an_initial_velocity_of_next_to_nothing_stays_within_what_the_motion_can_be(speed):
    record = decay_of(TRUE_DECAY, 0.4, seed=3)
    items = [
        FreeParameter(path=path, quantity=item, start=x)
        for path, item, x in parameters(TRUE_DECAY, "friction")
    ]
    problem = Shooting(
        law=TRUE_DECAY,
        free_parameters=FreeParameters(tuple(items)),
        segments=segments_of(CLOCK, record, length=1.0),
    )
    slow = [replace(s, guess=np.array([s.guess[0], speed])) for s in problem.segments[15:]]
    resting = replace(problem, segments=tuple(slow))
    # all that such a velocity does at rest is to shift where the body stops, by next to nothing
    seen = resting.linearise(np.array([0.02, 0.003]))
    for _ in range(3):
        seen = resting.linearise(np.array([0.02, 0.003]), seen)
        states = np.array([one.state for one in seen.memory.values()])
        assert np.max(np.abs(states[:, 1])) < 0.1
        assert np.max(np.abs(states[:, 0])) < 0.03


def test_where_a_moved_start_cannot_be_stepped_from_the_old_one_is_tried():
    def segment(state, misfit, *, able=True):
        ways = Ways(np.ones((1, 1)), np.ones(1), np.array([[1.0, 0.0]]))
        return LocalState(
            state=state, residual=np.array([misfit]), size=1.0, sense=Known(np.zeros((1, 1))),
            units=np.ones(2), ways=Known(ways if able else None),
        )  # fmt: skip

    before = segment(np.zeros(2), 2.0)

    def shoot(state):
        return segment(state, 1.0) if not state.any() else segment(state, 0.1, able=False)

    start = Start(shoot=shoot, rest=np.zeros(2), at_rest=False)
    found = start.followed(before, np.zeros(1))
    assert found.misfit == 1.0
    assert pickle.loads(pickle.dumps(found)).misfit == 1.0
