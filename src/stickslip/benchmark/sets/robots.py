"""Tasks of several joints at once: an arm of two links, an industrial robot."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from stickslip.benchmark.definition import Published, Task, together
from stickslip.benchmark.metrics import ForceError
from stickslip.catalogue import dataset
from stickslip.experiments import Measurement, rows_of
from stickslip.identification import RecordSettings
from stickslip.mechanisms import Robot, RobotJoint, TwoLinkArm

Frame: TypeAlias = tuple[tuple[float, float, float], tuple[float, float, float]]
NO_LIBRARY = "its library of functions has no rigid-body terms of an arm"
NO_MODEL = "it rolls a model file out, and masses of the links are not published"
LAWS = ("coulomb-viscous", "stribeck", "power-viscous", "direction-dependent")
"""Laws that all joints are given alike."""
TX40 = (
    ((0.0, 0.0, 0.320), (0.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((0.225, 0.0, 0.035), (0.0, 0.0, 0.0)),
    ((0.0, -0.225, 0.0), (0.5, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (0.5, 1.0, 0.0)),
)
"""TX40: place [m], and roll, pitch and yaw [half turns] of each joint, which turns about z."""
SCHUNK = (
    ((0.0, 0.0, 0.205), (0.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((0.0, -0.350, 0.0), (1.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((0.0, 0.0, 0.305), (-0.5, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (0.5, 0.0, 0.0)),
)
"""The same of the Schunk arm, whose third joint is counted against the second."""
INERTIA = 0.01
"""Moment of inertia that each link is described with [kg m^2], which is not what it has."""
FITTED = ("143339", "143704", "143747", "144003", "154548")
JUDGED = ("143524", "144115")
EVEN = ("run080", "run084", "run088")
ODD = ("run082", "run086")
"""Runs in turn: their friction falls from one to the next."""


def robot_of(frames: Sequence[Frame], coupling: Mapping[str, Mapping[str, float]]) -> Robot:
    """Return a robot with links of which only the frames are right."""
    joints = [
        RobotJoint(
            joint=f"q{i}",
            parent=f"q{i - 1}" if i > 1 else "",
            place=place,
            orientation=_rotation(*turns),
            coupling=coupling.get(f"q{i}", {}),
            mass=1.0,
            inertia_xx=INERTIA,
            inertia_yy=INERTIA,
            inertia_zz=INERTIA,
        )
        for i, (place, turns) in enumerate(frames, 1)
    ]
    return Robot(joints=tuple(joints))


def tx40_robot() -> Robot:
    """Return the TX40, whose sixth motor turns with the fifth joint too."""
    return robot_of(TX40, {"q6": {"q5": 1.0}})


def _rotation(roll: float, pitch: float, yaw: float) -> tuple[float, ...]:
    (a, b, c), (d, e, f) = (
        [round(one(math.pi * x), 12) for x in (roll, pitch, yaw)] for one in (math.cos, math.sin)
    )
    rows = (
        (c * b, c * e * d - f * a, c * e * a + f * d),
        (f * b, f * e * d + c * a, f * e * a - c * d),
        (-e, b * d, b * a),
    )
    return tuple(x + 0.0 for row in rows for x in row)


def by_motors(record: Measurement) -> Measurement:
    """Return a record with place and torque of the sixth motor, which turns with both joints."""
    joints = dict(record.joints)
    fifth, sixth = joints["q5"], joints["q6"]
    joints["q5"] = replace(fifth, force=fifth.values("force") - sixth.values("force"))
    joints["q6"] = replace(sixth, position=fifth.values("position") + sixth.values("position"))
    return replace(record, joints=joints)


def _tx40() -> tuple[Measurement, Measurement]:
    record = by_motors(dataset("staubli_tx40").measurement())
    rows = len(np.asarray(record.time))
    return rows_of(record, 0, rows // 2), rows_of(record, rows // 2, rows)


def _schunk() -> tuple[Measurement, Measurement]:
    return together("schunk_arm", EVEN), together("schunk_arm", ODD)


def _arm() -> tuple[Measurement, Measurement]:
    return together("two_link_arm", FITTED), together("two_link_arm", JUDGED)


TASKS = (
    Task(
        name="two-link-arm",
        title="Arm of two links, motors at both joints",
        record="two_link_arm",
        files=(*FITTED, *JUDGED),
        fitted=f"records {', '.join(FITTED)}",
        judged=f"records {' and '.join(JUDGED)}",
        mechanism=TwoLinkArm(
            upper_mass=0.5,
            upper_length=0.2,
            upper_centre=0.1,
            upper_inertia=0.02,
            lower_mass=0.6,
            lower_centre=0.2,
            lower_inertia=0.03,
            rotor_inertia=6e-5,
            gear_ratio=6.0,
        ),
        split=_arm,
        metric=ForceError(),
        vary=(
            "friction.*",
            *(
                f"mechanism.{part}_{what}"
                for part in ("upper", "lower")
                for what in ("centre", "inertia")
            ),
        ),
        laws=LAWS,
        selects=False,
        settings=RecordSettings(hold="first", starts=1),
        cutoff=6.0,
        published=(
            Published(
                what="levels of Coulomb friction",
                result="0.16 to 0.175 N m at the shoulder, 0.11 to 0.12 N m at the elbow",
                source="Wiebe et al. 2023",
            ),
        ),
        left_out={"pysindy": NO_LIBRARY, "mujoco": NO_MODEL},
    ),
    Task(
        name="tx40",
        title="Stäubli TX40, six joints, links unknown",
        record="staubli_tx40",
        files=("train",),
        fitted="the first half",
        judged="the second half",
        mechanism=tx40_robot(),
        split=_tx40,
        metric=ForceError(),
        vary=("friction.*", "links"),
        laws=LAWS,
        selects=False,
        cutoff=80.0,
        published=(
            Published(
                what="Coulomb + viscous, joints 1 to 6",
                result="F_v 8.05, 5.53, 1.97, 1.11, 1.86, 0.65 N m s/rad;"
                " F_c 7.14, 8.26, 6.34, 2.48, 3.03, 0.282 N m",
                source="TX40_config.yaml of figaroh-examples",
            ),
        ),
        left_out={"pysindy": NO_LIBRARY, "mujoco": NO_MODEL},
    ),
    Task(
        name="schunk-arm",
        title="Schunk arm, six joints under replayed torques, links unknown",
        record="schunk_arm",
        files=(*EVEN, *ODD),
        fitted=f"runs {', '.join(one[3:] for one in EVEN)}",
        judged=f"runs {', '.join(one[3:] for one in ODD)}, between them",
        mechanism=robot_of(SCHUNK, {}),
        split=_schunk,
        metric=ForceError(),
        vary=("friction.*", "links"),
        laws=LAWS,
        selects=False,
        cutoff=6.0,
        left_out={"pysindy": NO_LIBRARY, "mujoco": NO_MODEL},
    ),
)
