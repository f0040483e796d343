"""Inertial parameters of a robot's links, of which a motion tells only combinations apart."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.formulation import JointTorques
from stickslip.identification.force_map.joint_balance import joint_stretches, regression_of
from stickslip.identification.settings import Hold
from stickslip.mechanisms import LINKS, Mechanism, Robot, RobotJoint
from stickslip.quantities import fields_of, parameters

Array = NDArray[np.float64]

SOUGHT = tuple(name for name, one in fields_of(RobotJoint).items() if one.nuisance)
"""Fields of a joint that forces are linear in."""
NOTHING = 1e-12
"""Value of a field that is looked for from 0 [SI]: 0 is no parameter of equations."""
TOLD = 1e-2
"""Share of a slope that others do not span, from which a motion tells it apart."""


def told_links(
    robot: Mechanism, measurement: Measurement, hold: Hold, *, zeros: bool
) -> tuple[Mechanism, tuple[str, ...]]:
    """Return a robot and the paths of its links' parameters that records tell apart.

    The largest set of independent slopes, by pivoted QR behind friction and a constant force of
    each joint; what the others would do to the forces, these do.

    Source: M. Gautier, "Numerical calculation of the base inertial parameters of robots", 1991.
    """
    if not isinstance(robot, Robot):
        raise InputError(
            f"vary={LINKS!r} asks for the links of a robot description, and the mechanism is a"
            f" {type(robot).__name__}: name its parameters, such as"
            f" {next(path for path, _, _ in parameters(robot, 'mechanism'))}."
        )
    paths = [f"mechanism.joints.{i}.{name}" for i in range(len(robot.joints)) for name in SOUGHT]
    free = _with_parameters(robot, paths)
    torques = JointTorques.of(free, paths, by_position=zeros)
    (stretches,) = joint_stretches(torques, free, measurement, hold=hold, slipping=True)
    table, _, joint = regression_of(stretches, len(paths))
    spread = [np.std(np.concatenate([one.applied for one in own])) for own in stretches]
    table = table / np.maximum(spread, 1e-300)[joint, None]
    told = [paths[i] for i in _independent(table[:, : len(paths)], table[:, len(paths) :])]
    told = tuple(path for path in paths if path in told)
    return _with_parameters(robot, told), told


def _with_parameters(robot: Robot, paths: Collection[str]) -> Robot:
    """Return a robot with parameters of its equations where some fields are 0."""
    found: dict[int, dict[str, float]] = {}
    for path in paths:
        _, _, index, name = path.split(".")
        found.setdefault(int(index), {})[name] = getattr(robot.joints[int(index)], name) or NOTHING
    joints = [replace(one, **found.get(i, {})) for i, one in enumerate(robot.joints)]
    return replace(robot, joints=tuple(joints))


def _independent(columns: Array, others: Array) -> Sequence[int]:
    """Return which columns are independent of others and of each other."""
    size = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(size > 0.0, size, 1.0)
    basis = np.linalg.qr(others / np.maximum(np.linalg.norm(others, axis=0), 1e-300))[0]
    _, triangle, order = qr(scaled - basis @ (basis.T @ scaled), mode="economic", pivoting=True)
    count = int(np.count_nonzero(np.abs(np.diagonal(triangle)) > TOLD))
    return [int(i) for i in order[:count]]
