"""Ensembles of rigs with hard stops: the runs that `simulate` makes."""

import dataclasses

import numpy as np
import pytest

from stickslip import Axis, Coulomb, EventDriven, SpringBlock, ensemble, simulate
from stickslip.engine import EventCount, EventTimes, Max, Status
from stickslip.engine.formulation import formulate
from stickslip.engine.solver.reducers import reasons
from stickslip.errors import InputError, ParameterError
from stickslip.mechanisms.drives import Sine

PYTHON = EventDriven(tier="python")
LAW = Coulomb(kinetic_coefficient=0.5, static_coefficient=0.7)
RIG = Axis(
    inertia=1.0,
    drive=Sine(amplitude=3.0, frequency=0.5),
    lower_stop=0.0,
    upper_stop=0.1,
    restitution=0.5,
)
WANTED = {
    "x": Max("x"),
    "hits": EventCount("hits stop"),
    "first": EventTimes("hits stop", 3),
    "leaves": EventTimes("leaves stop", 2),
}


@pytest.mark.parametrize("tier", ["python", pytest.param("compiled", marks=pytest.mark.slow)])
def test_an_ensemble_of_bouncing_blocks_equals_their_runs(tier):
    solver = EventDriven(tier=tier)
    varied = {
        "restitution": np.array([0.0, 0.3, 0.5, 0.9]),
        "upper_stop": np.array([0.1, 0.05, 0.2, 0.1]),
        "initial.v": np.array([0.0, 1.0, 0.5, -1.0]),
    }
    found = ensemble(RIG, LAW, varied, t_end=2.0, outputs=WANTED, solver=solver)
    assert found.certified.all()
    for i in range(4):
        rig = dataclasses.replace(
            RIG, **{name: varied[name][i] for name in ("restitution", "upper_stop")}
        )
        run = simulate(rig, LAW, t_end=2.0, y0={"v": varied["initial.v"][i]}, solver=PYTHON)
        hits = [event.t for event in run.events if event.reason == "hits stop"]
        leaves = [event.t for event in run.events if event.reason == "leaves stop"]
        assert found["hits"][i] == len(hits) > 1
        for name, times in (("first", hits), ("leaves", leaves)):
            expected = (times + [np.nan] * 3)[: found[name].shape[1]]
            np.testing.assert_array_equal(found[name][i], expected)
        # an impact is located just past the stop
        assert found["x"][i] == pytest.approx(rig.upper_stop, rel=1e-14)
        assert found.status[i] is run.status
        assert found.energy_error[i] == run.certificate.energy_error


def test_a_drop_leaves_its_energy_at_the_stop_whatever_the_restitution():
    rig = Axis(inertia=1.0, offset=9.81, lower_stop=0.0)
    found = ensemble(
        rig, Coulomb(kinetic_coefficient=0.0), {"restitution": np.linspace(0.0, 0.9, 10)},
        y0={"x": 1.0}, t_end=20.0, outputs=["x", "v"], solver=PYTHON,
    )  # fmt: skip
    assert set(found.status) == {Status.AT_REST}
    assert np.all(found["x"] == 0)
    assert np.all(found["v"] == 0)
    # the rounding of some hundred impacts, each of which leaves the energy of the next
    assert found.energy_error.max() < 1e-14


def test_a_run_that_begins_beyond_a_stop_is_named():
    with pytest.raises(InputError, match=r"run 1: it begins at x = 0.3 m, beyond the upper stop"):
        ensemble(RIG, LAW, {"initial.x": np.array([0.0, 0.3])}, t_end=1.0, solver=PYTHON)
    with pytest.raises(InputError, match=r"run 2: it begins at x = 0 m, beyond the lower stop"):
        ensemble(RIG, LAW, {"lower_stop": np.array([-1.0, 0.0, 0.05])}, t_end=1.0, solver=PYTHON)


def test_a_run_whose_stops_leave_no_room_is_named_though_each_is_within_the_others():
    varied = {"lower_stop": np.array([-1, 0.0, 1.0]), "upper_stop": np.array([0.5, -0.1, 2.0])}
    with pytest.raises(ParameterError, match=r"run 1: .* the upper stop of x must lie above"):
        ensemble(RIG, LAW, varied, t_end=1.0, solver=PYTHON)


def test_equations_are_shared_by_rigs_whose_stops_stand_on_the_same_sides_only():
    free, lower, upper = (
        SpringBlock(mass=1.0, **stops) for stops in ({}, {"lower_stop": -1}, {"upper_stop": 1})
    )
    both = dataclasses.replace(lower, upper_stop=1)
    models = [formulate(rig, LAW) for rig in (free, lower, upper, both)]
    assert len({model.text for model in models}) == 4
    assert formulate(dataclasses.replace(upper, upper_stop=2.0), LAW) is models[2]
    assert ["hits stop" in reasons(model) for model in models] == [False, True, True, True]
