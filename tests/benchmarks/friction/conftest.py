"""A task of another package: a made-up axis whose law is known."""

from types import SimpleNamespace

import numpy as np
import pytest
from benchmarks.friction.definition import PositionError, Task
from benchmarks.friction.runs import tasks

from stickslip import Axis, CoulombViscous, Measurement, simulate
from stickslip.mechanisms.drives import Sampled

TRUE = {
    "mechanism.inertia": 2.0,
    "friction.kinetic_coefficient": 3.0,
    "friction.viscous_coefficient": 4.0,
}


def made_up():
    """Return two records of one axis, which two other motions drive."""
    time = np.arange(0.0, 8.0, 0.005)
    law = CoulombViscous(kinetic_coefficient=3.0, viscous_coefficient=4.0)
    records = []
    for first, second in ((1.1, 2.3), (0.9, 1.7)):
        force = 12.0 * np.sin(2.0 * np.pi * first * time / 2.0) + 6.0 * np.sin(second * time)
        drive = Sampled(times=time, values=force, hold="first")
        run = simulate(Axis(inertia=2.0, drive=drive), law, t_end=float(time[-1]))
        records.append(Measurement(time=time, position=run.at(time)["x"], force=force))
    return tuple(records)


MADE_UP = Task(
    name="made-up",
    title="A made-up axis",
    record="emps",
    files=(),
    fitted="one motion",
    judged="another",
    mechanism=Axis(inertia=1.5),
    split=made_up,
    metric=PositionError(horizon=1.0),
    vary=("friction.*", "mechanism.inertia"),
    laws=("coulomb-viscous", "viscous"),
    cutoff=30.0,
)


@pytest.fixture
def other_package(monkeypatch):
    """Install a package with the made-up task."""
    entry = SimpleNamespace(load=lambda: MADE_UP)
    monkeypatch.setattr("benchmarks.friction.runs.entry_points", lambda group: [entry])
    tasks.cache_clear()
    yield MADE_UP
    tasks.cache_clear()
