"""Machines with one thing wrong are stepped as the engine would, and their study can be resumed."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks import faults
from benchmarks.rigs import SOLVER
from tests.support import quick

from stickslip import simulate
from stickslip.drives import Sampled
from stickslip.identification import ModelError


def test_a_machine_without_a_fault_moves_as_the_engine_says():
    random = np.random.default_rng(3)
    machine = replace(faults.machine_of(random), closed=False)
    rig = replace(machine.rig, noise=0.0, disturbance=0.0)
    found = replace(machine, rig=rig).run(np.random.default_rng(4))
    assert found is not None
    pushed = Sampled(times=found.time.tolist(), values=np.asarray(found.force).tolist())
    run = simulate(
        replace(rig.axis, drive=pushed), rig.law, t_end=float(found.time[-1]), solver=SOLVER
    )
    x = run.at(found.time)["x"]
    # eight steps a sample of second order, but of first order at reversals: a few micrometres
    assert np.max(np.abs(x - found.position)) < 1e-3 * np.ptp(x)


def test_a_late_actuator_and_a_late_sensor_shift_the_motion_alike():
    machine = replace(faults.machine_of(np.random.default_rng(3)), closed=False)
    rig = replace(machine.rig, noise=0.0, disturbance=0.0)

    def moved(**late):
        return replace(machine, rig=rig, **late).run(np.random.default_rng(4)).position

    acted, seen = moved(force_delay=0.01), moved(position_delay=0.01)
    # a machine at rest does not care when it is not pushed; the delay is a whole number of steps
    assert np.max(np.abs(acted - seen)) < 1e-3 * np.ptp(seen)
    assert np.max(np.abs(seen - moved())) > 1e-3 * np.ptp(seen)


def test_there_are_26_faults():
    assert len(faults.FAULTS) == 26


@pytest.mark.parametrize("name", quick(faults.FAULTS, *[*faults.FAULTS][::5]))
def test_each_fault_makes_a_record(name):
    _, found = faults.faulty(name, np.random.default_rng([8, len(name)]))
    assert np.all(np.isfinite(found.position))
    assert np.all(np.isfinite(found.force))


def test_a_killed_study_goes_on_where_it_was(tmp_path):
    path = tmp_path / "faults.jsonl"
    row = '{"fault": "cogging", "seed": 1, "route": "shooting", "said": [], "named": false}\n'
    path.write_text(row + '{"fault": "imbal', encoding="utf-8")
    tasks = [(_row, (name, 1, "shooting"), name) for name in ("cogging", "imbalance")]
    assert len(list(faults.run(path, tasks, 1))) == 1
    assert [row["fault"] for row in faults.stored(path)] == ["cogging", "imbalance"]


def _row(name, seed, route):
    return {"fault": name, "seed": seed, "route": route, "said": [], "wrong": []}


@pytest.mark.parametrize(("said", "silent"), [([], 1), (["delay"], 0)])
def test_a_parameter_outside_its_interval_counts_where_nothing_is_said(said, silent):
    row = {
        "fault": "sensor-delay", "said": said, "wrong": ["inertia 1.1"], "far": [], "named": 0,
        "false": [],
    }  # fmt: skip
    assert f"said: {silent} of 1" in "\n".join(faults.summary([row]))


@pytest.mark.parametrize(
    ("kind", "named", "false"),
    [
        ("delay", True, []),
        ("delay or presliding", True, []),
        ("unexplained", False, []),
        ("flexibility", False, ["flexibility"]),
    ],
)
def test_a_group_that_has_the_fault_names_it_and_another_kind_is_wrong(kind, named, false):
    error = ModelError(
        kind=kind, finding="", consequence="", effect=0.0, interval=(0.0, 0.0), share=0.0
    )
    found = faults.outcome([error], [], ["delay"])
    assert (found["named"], found["false"]) == (named, false)
