"""Balances of several joints about the parameters of the mechanism that they tell.

Of inertial parameters of a robot's links a motion tells only combinations.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from scipy.linalg import qr

from stickslip.data import Measurement
from stickslip.errors import InputError, ParameterError
from stickslip.identify.bands import Array
from stickslip.identify.fits import RESOLUTION, SETTLED, SURE, TAKES_PART, positions_of
from stickslip.identify.forces import doubts_of
from stickslip.identify.problems.joint_motions import resting_of
from stickslip.identify.problems.joints import (
    NONE_MOVES,
    JointRecords,
    Links,
    Reduced,
    links_of,
    reduced_of,
    weighed,
)
from stickslip.mechanisms import LINKS, Mechanism, Robot, RobotJoint
from stickslip.quantities import fields_of, parameters, vary
from stickslip.show.formatting import joined

SOUGHT = tuple(name for name, item in fields_of(RobotJoint).items() if item.nuisance)
"""Fields of a joint that forces are linear in."""
NOTHING = 1e-12
"""Value of a field that is looked for from 0 [SI]: 0 is no parameter of equations."""
AGAIN = 8
"""Times that slopes are taken at the values that balances tell, at most."""


@dataclass(frozen=True, kw_only=True, eq=False)
class JointBalances:
    """Balances of all joints, with what they tell of parameters together."""

    mechanism: Mechanism
    """The mechanism with the values about which forces are slopes."""
    records: JointRecords
    links: Links
    made: "partial[JointRecords]"
    """Makes the records of another measurement."""

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        measurement: Measurement,
        paths: Sequence[str],
        *,
        held: bool,
        zeros: bool,
    ) -> "JointBalances":
        """Return the balances of records, about what they tell of parameters (paths).

        Forces are linear in most parameters, so that their values are taken twice, the second time
        about the first; others until they stay.
        """
        resting = resting_of(mechanism, measurement)
        for _ in range(AGAIN):
            own = cls.about(mechanism, measurement, paths, resting, held=held, zeros=zeros)
            values = own._values(paths)
            before = {path: value for path, _, value in parameters(mechanism, "mechanism")}
            each = ((x, x - before[path]) for path, x in values.items())
            if all(abs(change) < SETTLED * max(abs(x), 1e-300) for x, change in each):
                break
            with suppress(ParameterError):  # of what it does not take together
                mechanism = vary(mechanism, "mechanism", values)
            if not own.records.bent:
                return cls.about(mechanism, measurement, paths, resting, held=held, zeros=zeros)
        return own

    @classmethod
    def about(
        cls,
        mechanism: Mechanism,
        measurement: Measurement,
        paths: Sequence[str],
        resting: Sequence[str],
        *,
        held: bool,
        zeros: bool,
    ) -> "JointBalances":
        """Return the balances with slopes at the values of the mechanism."""
        doubts = doubts_of(mechanism, measurement, paths)
        made = partial(JointRecords.of, mechanism, unknown=(*paths, *doubts), resting=resting)
        records = made(measurement)
        if not records.records:
            raise InputError(NONE_MOVES)
        links = links_of(records, held, doubts, zeros=zeros)
        if records.bent and links.lost:
            _refuse_alike(links.lost)
        return cls(
            mechanism=mechanism,
            records=records,
            links=links,
            made=partial(made, bands=records.bands),
        )

    def _values(self, paths: Sequence[str]) -> dict[str, float]:
        """Return parameters as the balances tell them, within their ranges."""
        result, change = dict[str, float](), self.links.change
        for path, item, given in parameters(self.mechanism, "mechanism"):
            if path in paths:
                least = item.low if item.above is None else item.above + 1e-6 * abs(given)
                result[path] = min(max(given + change[path], least), item.high)
        return result


def _refuse_alike(names: Sequence[str]) -> None:
    """Refuse parameters that do the same to all forces, or nothing: their values do not settle."""
    if len(names) == 1:
        raise InputError(f"the forces of this motion do not depend on {names[0]}: fix it.")
    raise InputError(
        f"the motion does not tell {joined(list(names))} apart: fix one of them, such as"
        f" {names[-1]}."
    )


def told_links(
    robot: Mechanism, measurement: Measurement, *, held: bool, zeros: bool
) -> tuple[Mechanism, tuple[str, ...]]:
    """Return a robot, and the paths of its links' parameters that records tell, at their values.

    First the largest set of independent slopes, by pivoted QR; what the others would do to the
    forces, these do. Then those that are hardly other than described are left as they are, the
    least certain first, until all are certain. The robot is on the way there, as far as the mass
    matrix is positive in all poses.

    Sources: M. Gautier, "Numerical calculation of the base inertial parameters of robots", 1991;
    C. M. Pham, M. Gautier, "Essential parameters of robots", 1991.
    """
    if not isinstance(robot, Robot):
        raise InputError(
            f"vary={LINKS!r} asks for the links of a robot description, and the mechanism is a"
            f" {type(robot).__name__}: name its parameters, such as"
            f" {next(path for path, _, _ in parameters(robot, 'mechanism'))}."
        )
    paths = tuple(
        f"mechanism.joints.{i}.{name}" for i in range(len(robot.joints)) for name in SOUGHT
    )
    free = _with_parameters(robot, paths)
    records = JointRecords.of(
        free, measurement, unknown=paths, resting=resting_of(free, measurement)
    )
    if not records.records:
        raise InputError(NONE_MOVES)
    parts = reduced_of(records, held, paths)
    if not zeros:  # they are as small as usual
        parts = [replace(part, slopes=part.slopes[:, : len(paths)]) for part in parts]
    told = _independent(np.vstack([part.slopes for part in parts]), len(paths))
    count = parts[0].slopes.shape[1]
    at = [*told, *range(len(paths), count)]
    parts = weighed([replace(part, slopes=part.slopes[:, at]) for part in parts])
    triangle = np.asarray(
        np.linalg.qr(np.vstack([_rows(part) for part in parts]), mode="r"), dtype=float
    )
    kept, values = list(range(len(told))), dict[str, float]()
    while kept:
        result, errors = _solved(triangle, kept, len(told))
        certain = np.abs(result) / errors
        least = int(np.argmin(certain))
        values = dict(zip((paths[told[i]] for i in kept), result.tolist(), strict=True))
        if certain[least] > SURE:
            break
        del values[paths[told[kept[least]]]], kept[least]
    poses, about = _poses(robot, measurement), values
    while not _is_consistent(robot, about, poses):  # which forces, linear in them, need not be
        about = {path: 0.5 * value for path, value in about.items()}
    return _moved(robot, about), tuple(path for path in paths if path in values)


def _rows(part: Reduced) -> Array:
    """Return slopes and responses of a joint over its noise (n, p + 1), as far as they count."""
    both = np.column_stack([part.slopes, part.response])
    return both * (math.sqrt(part.kappa) / part.size)


def _with_parameters(robot: Robot, paths: Collection[str]) -> Robot:
    """Return a robot with parameters of its equations where some fields are 0."""
    result: dict[int, dict[str, Any]] = {}
    for path in paths:
        _, _, index, name = path.split(".")
        result.setdefault(int(index), {})[name] = getattr(robot.joints[int(index)], name) or NOTHING
    joints = [replace(joint, **result.get(i, {})) for i, joint in enumerate(robot.joints)]
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
    result = int(np.count_nonzero(np.abs(np.diagonal(triangle)) > TAKES_PART))
    return sorted(int(i) for i in order[:result])


def _solved(triangle: Array, kept: Sequence[int], count: int) -> tuple[Array, Array]:
    """Return values of parameters and their standard errors, by noise of 1 in every row."""
    columns = triangle[:, [*kept, *range(count, triangle.shape[1] - 1)]]
    size = np.linalg.norm(columns, axis=0)
    inverse = np.linalg.pinv(columns / np.where(size > 0.0, size, 1.0), rcond=1e-10)
    result = (inverse @ triangle[:, -1])[: len(kept)] / size[: len(kept)]
    return result, np.linalg.norm(inverse[: len(kept)], axis=1) / size[: len(kept)]


def _poses(robot: Robot, measurement: Measurement) -> Mapping[str, Array]:
    """Return some coordinates of records (n,), by name."""
    every = [
        np.concatenate([positions_of(record.joints[name]) for record in measurement.records()])
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
