"""Runs that go on together are those that go on alone."""

import dataclasses

import numpy as np
import pytest
from tests.engine.solver.test_slip_directions import shafts

from stickslip import Axis, Coulomb, EventDriven, LuGre, TwoFeet, simulate
from stickslip.engine import Status
from stickslip.engine.kernels.state_layout import NUMBERS, POLYNOMIAL, SIZE, Y
from stickslip.engine.simulation import check_pair
from stickslip.engine.solver import IncrementalEnsemble, gather
from stickslip.engine.solver.backend import runner_of
from stickslip.errors import InputError
from stickslip.mechanisms.drives import Sampled
from stickslip.quantities import vary

ZERO = Sampled(times=(0.0,), values=(0.0,))
PERIOD, STEPS, COUNT = 0.02, 25, 33
FORCES = np.random.default_rng(0).uniform(-3.0, 3.0, (STEPS, COUNT))
CASES = {
    "series": (Axis(inertia=1.0, stiffness=20.0, drive=ZERO), Coulomb(kinetic_coefficient=1.0)),
    "bristles": (
        Axis(inertia=1.0, drive=ZERO),
        LuGre(
            kinetic_coefficient=1.0, static_coefficient=1.5, stribeck_velocity=0.05,
            bristle_stiffness=1e3, bristle_damping=10.0,
        ),
    ),
    "two contacts": (
        TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15, stiffness=50.0, drive=ZERO),
        Coulomb(kinetic_coefficient=0.1),
    ),
}  # fmt: skip


def going(mechanism, law, **settings):
    runs = IncrementalEnsemble(mechanism, law, count=COUNT, solver=EventDriven(), **settings)
    states = np.zeros((COUNT, len(runs.model.states)))
    states[:, 0] = np.linspace(-0.1, 0.1, COUNT)
    runs.begin(np.arange(COUNT), states)
    return runs


def advanced(runs, steps=range(STEPS)):
    for k in steps:
        runs.advance(np.full(COUNT, (k + 1) * PERIOD), FORCES[k])
    return runs


@pytest.mark.parametrize("case", CASES)
def test_each_run_is_that_of_the_forces_as_a_drive(case):
    mechanism, law = CASES[case]
    runs = advanced(going(mechanism, law, threads=2))
    np.testing.assert_array_equal(runs.t, STEPS * PERIOD)
    assert runs.running.all()
    for row in (0, COUNT - 1):
        times = tuple(k * PERIOD for k in range(STEPS))
        drive = Sampled(times=times, values=tuple(FORCES[:, row]))
        told = dataclasses.replace(mechanism, drive=drive)
        begin = {mechanism.coordinates[0]: float(np.linspace(-0.1, 0.1, COUNT)[row])}
        run = simulate(told, law, t_end=STEPS * PERIOD, y0=begin, throw=False)
        end = [run[name][-1] for name in runs.model.states]
        # bristles are held to 1e-8, and sizes of errors begin with other forces
        np.testing.assert_allclose(runs.states[row], end, rtol=1e-7, atol=1e-8)


def test_states_are_those_of_the_mechanism_where_slips_are_sums():
    mechanism, _, laws, _ = shafts()
    runs = IncrementalEnsemble(
        mechanism, check_pair(mechanism, laws), count=3, solver=EventDriven(), threads=1
    )
    starts = np.zeros((3, 8))
    starts[:, 0], starts[:, 4] = (0.3, 0.2, 0.1), (10.0, 9.0, 8.0)
    runs.begin([0, 1], starts[:2])
    # the clutches close one after the other
    for until, *presses in ((0.4, 0.0, 0.0), (0.9, 20.0, 0.0), (1.2, 20.0, 20.0)):
        runs.advance(np.array([until, until, 0.0]), np.array([presses] * 3))
    runs.begin([1], starts[2:])
    run = simulate(mechanism, laws, t_end=1.2, y0={"phi1": 0.3, "w1": 10.0})
    end = [run[name][-1] for name in runs.model.states]
    assert min(end) > 0.2
    # both hold steps to 1e-10; the second run has not moved yet, and the third has not begun
    np.testing.assert_allclose(runs.states[0], end, rtol=1e-8)
    np.testing.assert_array_equal(runs.states[1:], [starts[2], np.zeros(8)])


def test_values_of_another_shape_are_refused():
    runs = going(*CASES["series"])
    with pytest.raises(InputError, match=r"values must have the shape \(33, 1\), got \(33, 2\)"):
        runs.advance(np.full(COUNT, PERIOD), np.zeros((COUNT, 2)))
    with pytest.raises(InputError, match=r"untils must have the shape \(33,\), got \(2,\)"):
        runs.advance(np.full(2, PERIOD), np.zeros((COUNT, 1)))


def test_a_run_that_begins_anew_leaves_the_others():
    runs = advanced(going(*CASES["series"]), range(5))
    before = runs.states
    runs.begin([3], np.array([[0.05, 0.0]]))
    assert runs.states[3].tolist() == [0.05, 0.0]
    assert runs.t[3] == 0.0 < runs.t[4]
    others = np.arange(COUNT) != 3
    np.testing.assert_array_equal(runs.states[others], before[others])


def test_runs_may_begin_with_other_parameters():
    mechanism, law = CASES["series"]
    other = vary(mechanism, "mechanism", {"mechanism.inertia": 3.0})
    rough = dataclasses.replace(law, kinetic_coefficient=2.0 * law.kinetic_coefficient)
    runs, others = going(mechanism, law), going(other, rough)
    plain = advanced(going(mechanism, law)).states
    rows = np.arange(0, COUNT, 2)
    runs.begin(rows, others.states[rows], other, rough)
    mixed, far = advanced(runs).states, advanced(others).states
    np.testing.assert_array_equal(mixed[::2], far[::2])
    np.testing.assert_array_equal(mixed[1::2], plain[1::2])
    assert not np.array_equal(far, plain)


def test_a_run_that_is_left_stays_where_it_is_until_it_begins():
    runs = advanced(going(*CASES["series"]), range(5))
    runs.leave([3])
    assert np.flatnonzero(~runs.running).tolist() == [3]
    before = runs.states[3]
    advanced(runs, range(5, 10))
    assert runs.states[3].tolist() == before.tolist()
    runs.begin([3], before[None])
    assert runs.running.all()


def test_a_run_that_took_too_many_steps_has_ended():
    mechanism, law = CASES["bristles"]
    runs = IncrementalEnsemble(mechanism, law, count=1, solver=EventDriven(max_steps=2))
    assert not runs.running[0]  # it has not begun
    runs.begin([0], np.array([[0.0, 1.0, 0.0]]))
    assert runs.running[0]
    runs.advance(np.array([10.0]), np.array([1.0]))
    assert runs.status(0) is Status.STEP_LIMIT
    t = runs.t[0]
    runs.advance(np.array([20.0]), np.array([1.0]))
    assert runs.t[0] == t


def test_a_state_that_is_no_number_is_refused():
    runs = going(*CASES["series"])
    with pytest.raises(InputError, match="finite"):
        runs.begin([0], np.array([[np.nan, 0.0]]))


def test_plain_python_gives_the_same_bits():
    mechanism, law = CASES["series"]
    runs = IncrementalEnsemble(mechanism, law, count=2, solver=EventDriven(), threads=1)
    start = np.array([[0.1, 0.0], [0.0, 0.5]])
    runs.begin([0, 1], start)
    plain = runner_of(runs.model, compiled=False)
    header = plain.header
    iw = plain.int_vectors(header)
    base = plain.working(gather(mechanism, law, runs.model, 0.0).p)
    base = [*base[:POLYNOMIAL], *base[NUMBERS:]]
    kept = [*base, *base]
    place = POLYNOMIAL + header[Y] - NUMBERS
    for row, state in enumerate(start.tolist()):
        kept[row * len(base) + place : row * len(base) + place + 2] = state
    int_vectors = [*header, *header]
    room = (plain.zeros(header[SIZE]), iw, plain.zeros(4), plain.zeros(9000), plain.zeros(900))
    for k in range(6):
        forces, until = FORCES[k, :2], (k + 1) * PERIOD
        runs.advance(np.full(2, until), forces)
        told = (forces.tolist(), [until] * 2, [np.inf] * 2, 1e-12, np.inf, 1000, kept, int_vectors)
        assert plain.kernels.enter_stretches(0, 2, *told, *room) == 2
    for row in range(2):
        found = kept[row * len(base) + place : row * len(base) + place + 2]
        assert found == runs.states[row].tolist()
