"""Balances of several joints about the parameters of the mechanism that they tell.

Of inertial parameters of a robot's links a motion tells only combinations.
"""

from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from scipy.linalg import qr

from stickslip.data import Measurement
from stickslip.errors import InputError, ParameterError
from stickslip.identify.bands import Array
from stickslip.identify.fits import SETTLED, TAKES_PART
from stickslip.identify.forces import doubts_of
from stickslip.identify.problems.joint_motions import resting_of
from stickslip.identify.problems.joints import (
    NONE_MOVES,
    JointRecords,
    Links,
    links_of,
    reduced_of,
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
        f"the motion cannot distinguish {joined(list(names))}: fix one of them, such as"
        f" {names[-1]}."
    )


def told_links(
    robot: Mechanism, measurement: Measurement, *, held: bool, zeros: bool
) -> tuple[Mechanism, tuple[str, ...]]:
    """Return a robot, and the paths of its links' parameters that records tell together.

    They are the largest set of independent slopes, by pivoted QR; what the others would do to the
    forces, these do. None is left as described because it is uncertain: other motions may show it.

    Source: M. Gautier, "Numerical calculation of the base inertial parameters of robots", 1991.
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
    slopes = [part.slopes for part in reduced_of(records, held, paths)]
    if not zeros:  # they are as small as usual
        slopes = [x[:, : len(paths)] for x in slopes]
    told = tuple(paths[i] for i in _independent(np.vstack(slopes), len(paths)))
    return _with_parameters(robot, told), told


def _with_parameters(robot: Robot, paths: Collection[str]) -> Robot:
    """Return a robot with parameters of its equations where some fields are 0."""
    result: dict[int, dict[str, Any]] = {}
    for path in paths:
        _, _, index, name = path.split(".")
        result.setdefault(int(index), {})[name] = getattr(robot.joints[int(index)], name) or NOTHING
    joints = [replace(joint, **result.get(i, {})) for i, joint in enumerate(robot.joints)]
    return replace(robot, joints=tuple(joints))


def _independent(table: Array, count: int) -> Sequence[int]:
    """Return which of the first columns are independent of each other and of all later ones."""
    size = np.linalg.norm(table, axis=0)
    scaled = table / np.where(size > 0.0, size, 1.0)
    basis = np.linalg.qr(scaled[:, count:])[0]
    columns = scaled[:, :count]
    _, triangle, order = qr(columns - basis @ (basis.T @ columns), mode="economic", pivoting=True)
    result = int(np.count_nonzero(np.abs(np.diagonal(triangle)) > TAKES_PART))
    return sorted(int(i) for i in order[:result])
