"""The verb `simulate`: its arguments, how it ends, and what it refuses."""

import math
import pickle

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    Dahl,
    EventDriven,
    FixedStep,
    LuGre,
    RecordSettings,
    SpringBlock,
    Stribeck,
    TowedBlock,
    TwoFeet,
    simulate,
)
from stickslip.engine import Max, Status
from stickslip.engine.simulation import ensemble
from stickslip.errors import InputError, ParameterError, SimulationError, UnknownNameError
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse, Sine
from stickslip.study.sweep import average_velocity

BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
BRISTLES = LuGre(
    kinetic_coefficient=0.25,
    static_coefficient=0.35,
    stribeck_velocity=0.01,
    bristle_stiffness=1e3,
    bristle_damping=1.0,
)


@pytest.mark.parametrize("t_end", [0, -1.0, math.nan, math.inf, "1 m", None, True], ids=repr)
def test_an_end_time_that_is_no_time_is_refused(t_end):
    with pytest.raises(ParameterError, match=r"t_end.*(above 0 s.*, got |got '1 m'.*above 0 s)"):
        simulate(BLOCK, LAW, t_end=t_end)


@pytest.mark.parametrize("law", [None, SpringBlock, 0.25, BLOCK], ids=str)
def test_what_is_no_law_is_refused(law):
    with pytest.raises(InputError, match="friction law such as Coulomb, or its name, got"):
        simulate(BLOCK, law, t_end=1.0)


@pytest.mark.parametrize("mechanism", [None, "block", SpringBlock, LAW], ids=str)
def test_what_is_no_mechanism_is_refused(mechanism):
    with pytest.raises(InputError, match="mechanism must be a Mechanism such as SpringBlock, got"):
        simulate(mechanism, LAW, t_end=1.0)


def test_an_unknown_state_lists_the_nearest():
    with pytest.raises(UnknownNameError, match="unknown state in y0 'velocity'"):
        simulate(BLOCK, LAW, t_end=1.0, y0={"velocity": 1.0})
    with pytest.raises(UnknownNameError, match="Known: v, x, z"):
        simulate(BLOCK, BRISTLES, t_end=1.0, y0={"w": 1.0})


@pytest.mark.parametrize("y0", [[], [0.0], [0.0, 0.0, 0.0]])
def test_a_start_of_the_wrong_length_is_refused_and_names_the_states(y0):
    with pytest.raises(InputError, match=rf"y0 must have 2 values \(x, v\), got {len(y0)}"):
        simulate(BLOCK, LAW, t_end=1.0, y0=y0)


@pytest.mark.parametrize("value", [math.nan, math.inf, None, True], ids=repr)
def test_a_start_that_is_no_number_is_refused(value):
    with pytest.raises(ParameterError, match=r"y0.*v\b.*number, got "):
        simulate(BLOCK, LAW, t_end=1.0, y0={"v": value})


def test_a_start_can_be_given_by_name_in_order_or_as_an_array():
    runs = [
        simulate(BLOCK, LAW, t_end=0.5, y0=y0)["x"][-1]
        for y0 in ({"v": 0.2}, [0.0, 0.2], (0, 0.2), np.array([0.0, 0.2]))
    ]
    assert len(set(runs)) == 1
    assert runs[0] != simulate(BLOCK, LAW, t_end=0.5)["x"][-1]


def test_giving_up_raises_or_is_told_as_asked():
    solver = EventDriven(max_steps=3)
    with pytest.raises(SimulationError, match="Reached the maximum number of steps"):
        simulate(BLOCK, LAW, t_end=1.0, solver=solver)
    run = simulate(BLOCK, LAW, t_end=1.0, solver=solver, throw=False)
    assert run.status is Status.STEP_LIMIT
    assert not run.status.complete
    assert run.certificate.steps == 3
    assert run.span[1] == run.t[-1] < 1.0


def test_a_law_by_name_has_its_typical_values():
    place = simulate(BLOCK, LAW, t_end=1.0)["x"][-1]
    for given in ("coulomb", Coulomb, "level + step"):
        assert simulate(BLOCK, given, t_end=1.0)["x"][-1] == place
    feet = TwoFeet(mass=1.0, front=0.1, rear=0.1)
    assert simulate(feet, {"front": "coulomb", "rear": Coulomb}, t_end=0.1).status.complete
    with pytest.raises(UnknownNameError, match="Did you mean 'coulomb'"):
        simulate(BLOCK, "coulom", t_end=1.0)
    with pytest.raises(InputError, match="has no typical values"):
        simulate(BLOCK, "level + power + drag", t_end=1.0)


@pytest.mark.parametrize(
    ("kind", "values", "said"),
    [
        (Coulomb, {"mu": 0.25}, r"of Coulomb 'mu'.*'kinetic_coefficient' \(mu_k\)"),
        (Coulomb, {"mu_k": 0.25}, r"'mu_k'. Did you mean 'kinetic_coefficient' \(mu_k\)\?"),
        (Coulomb, {}, r"Coulomb lacks kinetic_coefficient \(mu_k: at least 0\)"),
        (SpringBlock, {"mas": 1.0}, r"SpringBlock 'mas'. Did you mean 'mass' \(m\)\?"),
        (Pulse, {"levl": 1.0, "duration": 1.0}, r"Pulse 'levl'. Did you mean 'level'"),
        (EventDriven, {"tol": 1e-6}, r"EventDriven 'tol'. Did you mean 'tolerance'"),
        (FixedStep, {}, r"FixedStep lacks dt \(dt: above 0 s\)"),
        (RecordSettings, {"horizont": 1.0}, r"RecordSettings 'horizont'"),
        (Stribeck, {"exponent": 1.0}, r"Did you mean 'fading_exponent' \(n\)\?"),
    ],
)
def test_a_wrong_name_of_a_parameter_is_refused_with_the_nearest(kind, values, said):
    with pytest.raises(InputError, match=said) as caught:
        kind(**values)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_a_parameter_without_its_name_is_refused():
    with pytest.raises(InputError, match=r"write Coulomb\(kinetic_coefficient=...\), got 0.25"):
        Coulomb(0.25)


def test_the_tolerance_governs_laws_with_bristles_and_without():
    bristles = Dahl(kinetic_coefficient=0.2, bristle_stiffness=1e3)
    steps = [
        simulate(BLOCK, bristles, t_end=0.5, solver=solver).certificate.steps
        for solver in (EventDriven(tolerance=1e-4), EventDriven(), EventDriven(tolerance=1e-10))
    ]
    assert steps[0] < 0.5 * steps[1] < 0.5 * steps[2]
    both = EventDriven(tolerance=1e-6, stiff_tolerance=1e-4)
    assert [both.tolerance_for(law) for law in (bristles, Coulomb(kinetic_coefficient=0.2))] == [
        1e-4, 1e-6
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"tolerance": 0.0}, r"EventDriven\.tolerance"),
        ({"tolerance": 0.5}, r"EventDriven\.tolerance"),
        ({"stiff_tolerance": 1e-16}, r"EventDriven\.stiff_tolerance"),
        ({"max_steps": 0}, r"EventDriven\.max_steps"),
    ],
)
def test_bad_settings_are_refused(settings, words):
    with pytest.raises(ParameterError, match=words):
        EventDriven(**settings)


def test_a_start_beyond_all_numbers_ends_with_an_error_of_ours():
    start = {"v": 1e308}
    with pytest.raises(SimulationError):
        simulate(TowedBlock(mass=1.0, stiffness=1e10, speed=1.0), LAW, t_end=1.0, y0=start)


def test_a_run_that_cannot_take_a_single_step_still_gives_a_trajectory():
    run = simulate(
        TowedBlock(mass=1.0, stiffness=1e10, speed=1.0), LAW, t_end=1.0, y0={"v": 1e308},
        throw=False,
    )  # fmt: skip
    assert not run.status.complete


@pytest.mark.parametrize("offset", range(-4, 5))
def test_a_run_may_end_at_the_very_moment_of_an_event(offset):
    axis = Axis(inertia=1.0)
    law = Coulomb(kinetic_coefficient=0.7)
    (stop,) = simulate(axis, law, t_end=9.0, y0={"v": 1.3}).events
    t_end = stop.t + offset * math.ulp(stop.t)
    run = simulate(axis, law, t_end=t_end, y0={"v": 1.3})
    assert run.span == (0.0, t_end)
    assert math.isclose(run["x"][-1], 1.3**2 / 1.4, rel_tol=1e-12)  # the solver's tolerance


@pytest.mark.parametrize("offset", range(-4, 5))
@pytest.mark.parametrize("level", [0.5, -2.0])
def test_a_drive_may_change_at_the_very_moment_of_an_event(offset, level):
    law = Coulomb(kinetic_coefficient=0.7)
    (stop,) = simulate(Axis(inertia=1.0), law, t_end=9.0, y0={"v": 1.3}).events
    start = stop.t + offset * math.ulp(stop.t)
    axis = Axis(inertia=1.0, drive=Pulse(level=level, duration=1.0, start=start))
    run = simulate(axis, law, t_end=9.0, y0={"v": 1.3})
    forward = 1.3**2 / 1.4
    pulled = 0.0 if level > 0 else 2.0 * (2.0 - 0.7) / (2 * 0.7)  # F (F - f) T^2 / (2 m f)
    assert math.isclose(run["x"][-1], forward - pulled, rel_tol=1e-11)  # tolerance, three spans


def test_a_drive_may_hold_a_body_right_at_break_away_for_a_while():
    drive = PiecewiseLinear(times=(0.0, 1.0, 2.0, 3.0), values=(0.0, 1.0, 1.0, 0.0))
    run = simulate(Axis(inertia=1.0, drive=drive), Coulomb(kinetic_coefficient=1.0), t_end=4.0)
    assert run["x"][-1] == 0


def test_printed_forms_are_refused_by_the_exact_solver_with_the_cure():
    from stickslip.friction import PRINTED_FORMS

    form = PRINTED_FORMS["printed-1"](kinetic_coefficient=0.2)
    with pytest.raises(InputError, match=r"solver=FixedStep\(.*corrected law Coulomb"):
        simulate(BLOCK, form, t_end=1.0)


def test_what_is_no_solver_is_refused():
    with pytest.raises(InputError, match="solver"):
        simulate(BLOCK, LAW, t_end=1.0, solver="fast")
    with pytest.raises(InputError, match="solver"):
        simulate(BLOCK, LAW, t_end=1.0, solver=FixedStep)


@pytest.mark.parametrize("name", ["static_coefficient", "mu_s", "friction.mu_s"])
def test_a_parameter_that_was_not_given_is_varied_by_word_or_symbol(name):
    block = SpringBlock(mass=1.0, drive=Sine(amplitude=4.0, frequency=5.0))
    law, values = Coulomb(kinetic_coefficient=0.2), [0.2, 0.3]
    runs = ensemble(block, law, {name: values}, t_end=0.2, outputs={"fastest": Max("v")})
    assert runs["fastest"][0] > runs["fastest"][1]
    assert len(average_velocity(block, law, {name: values}, settle=1, cycles=2).velocity) == 2
