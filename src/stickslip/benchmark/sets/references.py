"""Tasks of reference simulations by other programs, whose laws are known."""

import numpy as np

from stickslip.benchmark.definition import Task, between
from stickslip.benchmark.metrics import PositionError
from stickslip.catalogue import dataset
from stickslip.experiments import Measurement
from stickslip.identification import RecordSettings
from stickslip.mechanisms import Axis

EVERY = 10
"""Rows of the Modelica result that become one: 200 Hz."""


def _modelica() -> tuple[Measurement, Measurement]:
    import pandas as pd

    table = pd.read_parquet(dataset("modelica_friction").path()).drop_duplicates("time")
    time = np.asarray(table["time"])[::EVERY]
    record = Measurement(
        time=time,
        position=np.asarray(table["stop1.s"])[::EVERY],
        force=25.0 * np.sin(0.5 * np.pi * time),
    )
    return between(record, 0.0, 3.0), between(record, 3.0, 6.0)


def _siconos() -> tuple[Measurement, Measurement]:
    import pandas as pd

    table = pd.read_parquet(dataset("siconos_friction_oscillator").path())
    record = Measurement(time=np.asarray(table["t_s"]), position=np.asarray(table["x"]))
    return between(record, 0.0, 12.0), between(record, 12.0, 22.0)


TASKS = (
    Task(
        name="modelica-friction",
        title="Mass under a sine force with a Stribeck law, simulated by Dymola",
        record="modelica_friction",
        files=("reference",),
        fitted="the first 3 s",
        judged="the last 2 s",
        mechanism=Axis(inertia=1.0),
        split=_modelica,
        metric=PositionError(horizon=1.0),
        route="shooting",
        settings=RecordSettings(hold="first"),
        cutoff=60.0,
        truth={"level": 5.0, "excess at rest": 10.0, "viscous": 1.0, "inertia": 1.0},
    ),
    Task(
        name="siconos-oscillator",
        title="Oscillator with Coulomb friction, simulated by Siconos",
        record="siconos_friction_oscillator",
        files=("reference",),
        fitted="the first 12 s",
        judged="12 to 22 s",
        mechanism=Axis(inertia=1.0, stiffness=1.0),
        split=_siconos,
        metric=PositionError(horizon=2.0),
        cutoff=10.0,
        truth={"level": 1.0},
        left_out={"mujoco": "nothing drives it: mujoco.sysid is given records with a force"},
    ),
)
