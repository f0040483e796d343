"""Room for the rows of steps and events: runs go on with more, to the same bits."""

import numpy as np
import pytest

from stickslip import Coulomb, EventDriven, Stribeck, TowedBlock, ensemble, simulate
from stickslip.engine.kernels.driver import events_are_full, log_is_full
from stickslip.engine.kernels.state_layout import (
    EVENT_COLUMNS,
    FULL,
    ROW_COLUMNS,
    RUNNING,
    STATUS,
    STEPS,
)
from stickslip.engine.solver import Final, Sensitivity, ensembles, run

BLOCK = TowedBlock(mass=1.0, stiffness=1.0, speed=0.1)
LAW = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.05)
TIERS = [EventDriven(tier="python"), EventDriven(tier="compiled")]


@pytest.fixture(params=["little", "plenty"])
def room(request, monkeypatch):
    """Begin with room for one row, or for many."""
    rows = {"little": 1, "plenty": 1000}[request.param]
    monkeypatch.setattr(run, "FIRST_ROWS", rows)
    monkeypatch.setattr(ensembles, "FIRST_ROWS", rows)
    return rows


@pytest.fixture(scope="module")
def usual():
    return simulate(BLOCK, LAW, t_end=30.0, solver=TIERS[0])


@pytest.mark.parametrize("solver", TIERS, ids=["python", "compiled"])
def test_a_run_finds_room_for_its_rows(room, usual, solver):
    found = simulate(BLOCK, LAW, t_end=30.0, solver=solver)
    assert len(found.t) > 20
    np.testing.assert_array_equal(found.t, usual.t)
    np.testing.assert_array_equal(found["x"], usual["x"])
    assert found.events == usual.events
    assert found.certificate == usual.certificate


@pytest.mark.parametrize("solver", TIERS, ids=["python", "compiled"])
def test_rows_of_an_ensemble_go_on_where_there_was_no_room(room, usual, solver):
    speeds = np.array([0.05, 0.1, 0.2])
    slope = Sensitivity("x", "mechanism.stiffness")
    runs = ensemble(
        BLOCK, LAW, {"mechanism.speed": speeds}, t_end=30.0, solver=solver,
        outputs={"x": Final("x"), "slope": slope},
    )  # fmt: skip
    assert runs["x"][1] == usual["x"][-1]
    assert runs["slope"][1] == pytest.approx(usual.sensitivity("x", "stiffness")[-1], rel=1e-9)


def test_a_kernel_without_room_says_so_and_changes_nothing_else():
    from stickslip.engine.formulation import formulate
    from stickslip.engine.solver.backend import runner_of

    model = formulate(BLOCK, Coulomb(kinetic_coefficient=0.2))
    for compiled in (False, True):
        runner = runner_of(model, compiled=compiled)
        iw = runner.iw()
        log, events = runner.zeros(runner.header[ROW_COLUMNS]), runner.zeros(99 * EVENT_COLUMNS)
        assert log_is_full(iw, log)
        assert not events_are_full(iw, events)
        w = runner.working([1.0] * len(runner.places))
        table, bounds = runner.zeros(1), runner.zeros(1)
        runner.kernels.enter_run(w, iw, table, bounds, 1.0, 1e-9, 1.0, 99, log, events)
        assert (iw[STATUS], iw[STEPS]) == (FULL, 0)
        longer, _ = runner.with_room(iw, log, events)
        runner.kernels.enter_run(w, iw, table, bounds, 1.0, 1e-9, 1.0, 1, longer, events)
        assert iw[STATUS] not in (FULL, RUNNING)
        assert iw[STEPS] > 0
