"""Tasks of one coordinate under a known force: a ball-screw axis, a driven pendulum."""

import math

from stickslip.benchmark.definition import Published, Task, between
from stickslip.benchmark.metrics import PositionError
from stickslip.catalogue import dataset
from stickslip.experiments import Measurement
from stickslip.identification import RecordSettings
from stickslip.mechanisms import Axis, Pendulum

JANOT = "Janot, Gautier, Brunot 2019"
SWINGS = {"ddp": 6.0, "sac": 4.0, "ilqr": 2.8, "energy_shaping": 5.0}
"""Records of the pendulum with one mass, and until when [s] it moves as torque and weight have it.

People push it later. In ilqr it accelerates by 54 rad/s^2 at 3.0 s; torque and weight give 16.
"""
UNEVEN = 0.1
"""Time [s] from which the steps of all of them are even."""
SWINGING = RecordSettings(segment=0.5, position_zeros=False)
"""In segments of 0.5 s, as its published errors are."""


def swing(name: str) -> Measurement:
    """Return a record of the pendulum, driven by the torque that its drive reports."""
    return between(dataset("simple_pendulum_drive").measurement(name), UNEVEN, SWINGS[name])


def _emps() -> tuple[Measurement, Measurement]:
    record = dataset("emps").measurement()
    return between(record, -math.inf, 16.0), between(record, 16.0, math.inf)


def _pendulum() -> tuple[Measurement, Measurement]:
    first, others = ("ddp", "energy_shaping"), ("sac", "ilqr")
    both = [Measurement(trials=tuple(map(swing, own))) for own in (first, others)]
    return both[0], both[1]


EMPS = Task(
    name="emps",
    title="Ball-screw axis under position control",
    record="emps",
    files=("train",),
    fitted="the first 16 s",
    judged="the last 9 s",
    mechanism=Axis(inertia=95.0),
    split=_emps,
    metric=PositionError(horizon=1.0),
    vary=("friction.*", "mechanism.inertia"),
    cutoff=50.0,
    published=(
        Published(
            what="IDIM-LS, Coulomb + viscous",
            result="relative error of the force 4.08 %, whole record, in sample",
            source=JANOT,
        ),
        Published(
            what="IDIM-LS, by direction",
            result="relative error of the force 3.11 %, whole record, in sample",
            source=JANOT,
        ),
    ),
)
PENDULUM = Task(
    name="pendulum",
    title="Pendulum with a quasi-direct drive",
    record="simple_pendulum_drive",
    files=tuple(SWINGS),
    fitted="ddp (6 s) and energy_shaping (5 s)",
    judged="sac (4 s) and ilqr (2.8 s)",
    mechanism=Pendulum(mass=0.74, length=0.5, rest_angle=0.0),
    split=_pendulum,
    metric=PositionError(horizon=0.5, unit="rad"),
    vary=("friction.*", "mechanism.mass", "mechanism.inertia", "mechanism.rest_angle"),
    route="shooting",
    settings=SWINGING,
    cutoff=3.0,
    published=(
        Published(
            what="parameters printed with the record (J, m c, F_v, F_c)",
            result="0.15 to 0.60 rad over 0.5 s, by record",
            source="Wiebe et al. 2022; errors by the notes of the catalogue",
        ),
    ),
)
TASKS = (EMPS, PENDULUM)
