"""Inertial parameters of a robot's links, of which a motion tells only combinations."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from stickslip.data import Measurement
from stickslip.engine.formulation import JointTorques
from stickslip.errors import InputError, ParameterError
from stickslip.identify.fits.force_map.joint_balance import joint_stretches, regression_of
from stickslip.identify.fits.series.inverse_dynamics import positions_of
from stickslip.identify.fits.settings import RESOLUTION, SURE, TAKES_PART, Hold
from stickslip.mechanisms import LINKS, Mechanism, Robot, RobotJoint
from stickslip.quantities import fields_of, parameters, vary

Array = NDArray[np.float64]

SOUGHT = tuple(name for name, one in fields_of(RobotJoint).items() if one.nuisance)
"""Fields of a joint that forces are linear in."""
NOTHING = 1e-12
"""Value of a field that is looked for from 0 [SI]: 0 is no parameter of equations."""


def told_links(
    robot: Mechanism, measurement: Measurement, hold: Hold, *, zeros: bool
) -> tuple[Mechanism, tuple[str, ...]]:
    """Return a robot, and the paths of its links' parameters that records tell, at their values.

    First the largest set of independent slopes, by pivoted QR; what the others would do to the
    forces, these do. Then those that are hardly other than described are left as they are, the
    least certain first, until all are certain and the mass matrix is positive in all poses.

    Sources: M. Gautier, "Numerical calculation of the base inertial parameters of robots", 1991;
    C. M. Pham, M. Gautier, "Essential parameters of robots", 1991.
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
    table, forces, joint = regression_of(stretches, len(paths))
    told = _independent(table, len(paths))
    table = table[:, [*told, *range(len(paths), table.shape[1])]]
    residual = forces - table @ np.linalg.lstsq(table, forces, rcond=None)[0]
    rows = np.bincount(joint, minlength=len(stretches))
    left = np.sqrt(np.bincount(joint, residual**2, minlength=len(stretches)) / np.maximum(rows, 1))
    weighed = np.column_stack([table, forces]) / np.maximum(left, 1e-300)[joint, None]
    triangle = np.asarray(np.linalg.qr(weighed, mode="r"), dtype=float)
    passed = min((one.passed or 1.0 for own in stretches for one in own), default=1.0)
    poses = _poses(robot, measurement)
    kept, values = list(range(len(told))), dict[str, float]()
    while kept:
        found, errors = _solved(triangle, kept, len(told))
        certain = np.abs(found) * np.sqrt(passed) / errors
        least = int(np.argmin(certain))
        values = dict(zip((paths[told[i]] for i in kept), found.tolist(), strict=True))
        if certain[least] > SURE and _is_consistent(robot, values, poses):
            break
        del values[paths[told[kept[least]]]], kept[least]
    return _moved(robot, values), tuple(path for path in paths if path in values)


def _with_parameters(robot: Robot, paths: Collection[str]) -> Robot:
    """Return a robot with parameters of its equations where some fields are 0."""
    found: dict[int, dict[str, Any]] = {}
    for path in paths:
        _, _, index, name = path.split(".")
        found.setdefault(int(index), {})[name] = getattr(robot.joints[int(index)], name) or NOTHING
    joints = [replace(one, **found.get(i, {})) for i, one in enumerate(robot.joints)]
    return replace(robot, joints=tuple(joints))


def _moved(robot: Robot, changes: Mapping[str, float]) -> Robot:
    """Return a robot with parameters changed by so much."""
    free = _with_parameters(robot, list(changes))
    before = {path: value for path, _, value in parameters(free, "mechanism")}
    after = {path: before[path] + change for path, change in changes.items()}
    return vary(free, "mechanism", after)


def _independent(table: Array, count: int) -> Sequence[int]:
    """Return which of the first columns are independent of each other and of all later ones."""
    size = np.linalg.norm(table, axis=0)
    scaled = table / np.where(size > 0.0, size, 1.0)
    basis = np.linalg.qr(scaled[:, count:])[0]
    columns = scaled[:, :count]
    _, triangle, order = qr(columns - basis @ (basis.T @ columns), mode="economic", pivoting=True)
    found = int(np.count_nonzero(np.abs(np.diagonal(triangle)) > TAKES_PART))
    return sorted(int(i) for i in order[:found])


def _solved(triangle: Array, kept: Sequence[int], count: int) -> tuple[Array, Array]:
    """Return values of parameters and their standard errors, by noise of 1 in every row."""
    columns = triangle[:, [*kept, *range(count, triangle.shape[1] - 1)]]
    size = np.linalg.norm(columns, axis=0)
    inverse = np.linalg.pinv(columns / np.where(size > 0.0, size, 1.0), rcond=1e-10)
    found = (inverse @ triangle[:, -1])[: len(kept)] / size[: len(kept)]
    return found, np.linalg.norm(inverse[: len(kept)], axis=1) / size[: len(kept)]


def _poses(robot: Robot, measurement: Measurement) -> Mapping[str, Array]:
    """Return some coordinates of records (n,), by name."""
    every = [
        np.concatenate([positions_of(one.joints[name]) for one in measurement.records()])
        for name in robot.coordinates
    ]
    step = max(1, len(every[0]) // RESOLUTION)
    return {name: q[::step] for name, q in zip(robot.coordinates, every, strict=True)}


def _is_consistent(robot: Robot, values: Mapping[str, float], poses: Mapping[str, Array]) -> bool:
    """Whether accelerations take force with parameters of links: the mass matrix is positive."""
    try:
        moved = _moved(robot, values)
    except ParameterError:
        return False
    count = len(next(iter(poses.values())))
    rows = [[np.broadcast_to(x, count) for x in row] for row in moved.mass_matrix(poses)]
    sizes = np.linalg.eigvalsh(np.moveaxis(np.array(rows, dtype=float), -1, 0))
    return bool(sizes.min() > 0.0)
