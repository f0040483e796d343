"""Tasks of one contact: a tribometer, rock, a slider over paper."""

import math

import numpy as np

from stickslip.benchmark.definition import Published, Task, between
from stickslip.benchmark.metrics import CoefficientError, FeatureError, ForceError
from stickslip.catalogue import dataset
from stickslip.experiments import Measurement
from stickslip.mechanisms import Axis, TowedBlock

NO_DYNAMICS = "friction was measured: there are no dynamics to discover or to roll out"
IRREGULAR = "irregular stick-slip is judged by its features, which no regression of samples gives"
STEP = 21_820.0
"""Time [s] of the clock of the rock's record from which it judges."""
MASS = 0.0307
"""Of the slider over paper [kg]."""


def _tribometer() -> tuple[Measurement, Measurement]:
    record = dataset("reciprocating_tribometer").measurement("train")
    return between(record, 12.0, 75.0), between(record, 75.0, 110.0)


def _rock() -> tuple[Measurement, Measurement]:
    record = dataset("rock_velocity_step").measurement()
    return between(record, -math.inf, STEP), record


def _slider(file: str) -> tuple[Measurement, Measurement]:
    record = dataset("spring_pulled_slider").measurement(file)
    time = np.asarray(record.time)
    middle = float(time[len(time) // 2])
    return between(record, -math.inf, middle), between(record, middle, math.inf)


def _slow() -> tuple[Measurement, Measurement]:
    return _slider("k168_v42")


def _fast() -> tuple[Measurement, Measurement]:
    return _slider("k1002_v4300")


TASKS = (
    Task(
        name="tribometer",
        title="Reciprocating tribometer, strokes of 0.23 mm",
        record="reciprocating_tribometer",
        files=("train",),
        fitted="12 to 75 s",
        judged="75 to 110 s",
        mechanism=Axis(inertia=1.0),
        split=_tribometer,
        metric=ForceError(),
        cutoff=5.0,
        published=(
            Published(
                what="sign(v), Dahl, LuGre",
                result="relative error of the force 94.5 %, 11.6 %, 9.1 %, whole file, in sample",
                source="notes of the catalogue",
            ),
        ),
        left_out={"pysindy": NO_DYNAMICS, "mujoco": NO_DYNAMICS},
    ),
    Task(
        name="rock",
        title="Sepiolite gouge at 30 MPa, a step from 0.2 to 2 µm/s",
        record="rock_velocity_step",
        files=("sepiolite",),
        fitted="the record up to the middle of what follows the step",
        judged="the rest of it",
        mechanism=TowedBlock(mass=1e-3, stiffness=1e3, speed=2e-7, load=1.0),
        split=_rock,
        metric=CoefficientError(since=STEP),
        vary=("friction.*", "mechanism.stiffness"),
        published=(
            Published(
                what="rate and state (a = 0.0157, b = 0)",
                result="rms 1.1e-3, whole record, in sample",
                source="Giacomel et al. 2024",
            ),
        ),
        left_out={
            "pysindy": NO_DYNAMICS,
            "mujoco": "its friction does not depend on speed and state",
        },
    ),
    *(
        Task(
            name=f"slider-{name}",
            title=f"Slider pulled over paper by a spring at {speed:g} µm/s",
            record="spring_pulled_slider",
            files=(file,),
            fitted="the first half",
            judged="the second half",
            mechanism=TowedBlock(mass=MASS, stiffness=stiffness, speed=speed * 1e-6),
            split=split,
            metric=FeatureError(),
            vary=("friction.*", "mechanism.mass"),
            left_out=dict.fromkeys(("scipy", "lmfit", "pysindy", "mujoco"), IRREGULAR),
        )
        for name, file, stiffness, speed, split in (
            ("slow", "k168_v42", 168.0, 42.0, _slow),
            ("fast", "k1002_v4300", 1002.0, 4300.0, _fast),
        )
    ),
)
