"""Robots in rig files: a description in URDF and what the file adds to its joints."""

import warnings
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.experiments.rigs.rig_models import Given, Number, Table, table_of
from stickslip.mechanisms import Robot, RobotDescription, RobotJoint, read_urdf
from stickslip.quantities import Quantity, fields_of

URDF = "urdf"
"""``type`` of a mechanism that a robot description gives."""
ADDED = (
    "damping", "armature", "coupling", "effort", "mass", "lower_stop", "upper_stop", "restitution",
)  # fmt: skip
"""What a rig file may say of a joint beside its description."""
ANGLE, DISTANCE = Quantity("q", "rad"), Quantity("q", "m")
Added = table_of(RobotJoint, "joint", only=ADDED)


class UrdfTable(Table):
    """A robot from a description in URDF."""

    type: Literal["urdf"]
    """Kind of the mechanism."""
    file: str = Field(description="robot description (URDF), relative to the rig file")
    moving: list[str] = Field(
        default=[], min_length=1, description="joints that move; the others are locked at 0"
    )
    locked: dict[str, Annotated[Any, Number(ANGLE, alternatives=(DISTANCE,))]] = Field(
        default={}, description="joint that is locked: where, an angle or a distance"
    )
    gravity: Annotated[Any, Number(fields_of(Robot)["gravity"])] = 9.81
    """Acceleration of free fall [m/s^2]."""
    joints: dict[str, Added] = Field(  # type: ignore[valid-type]  # made at run time
        default={},
        description="joint: damping, armature, mass, coupling, effort or stops of its own",
    )
    links: Literal["known", "unknown"] = Field(
        default="known",
        description="unknown: fits find what motion tells of masses and inertias of the links",
    )


def _described(table: UrdfTable, file: str) -> RobotDescription:
    """Read the description that a table names."""
    gravity = table.gravity.value if isinstance(table.gravity, Given) else table.gravity
    path, moving = Path(file).parent / table.file, table.moving or None
    try:
        return read_urdf(path, joints=moving, locked=table.locked, gravity=gravity)
    except UnknownNameError as error:
        raise UnknownNameError(f"{error.kind} named by {file}:", error.name, error.known) from None
    except InputError as error:
        raise type(error)(f"{file}: mechanism: {error}") from None


def robot_of(table: UrdfTable, added: Mapping[str, Mapping[str, Any]], file: str) -> Robot:
    """Return the robot of a table."""
    described = _described(table, file)
    for remark in described.remarks:
        warnings.warn(f"{file}: {remark}", stacklevel=2)
    robot = described.robot
    known = [one.joint for one in robot.joints]
    for name in added:
        if name not in known:
            raise UnknownNameError(f"moving joint in mechanism.joints of {file}:", name, known)
    try:
        joints = tuple(_with(one, added.get(one.joint, {})) for one in robot.joints)
        return replace(robot, joints=joints)
    except ParameterError as error:
        raise ParameterError(f"{file}: mechanism.joints: {error}") from None


def _with(joint: RobotJoint, added: Mapping[str, Any]) -> RobotJoint:
    """Return a joint with what a rig file adds; limits are of its angle, not of a motor's."""
    if added.get("coupling"):
        joint = replace(joint, lower_stop=None, upper_stop=None)
    return replace(joint, **added)


def fill_friction(
    raw: dict[str, Any], table: UrdfTable, contacts: Collection[str], file: str
) -> None:
    """Put the friction levels of a description in where a rig file gives nothing else."""
    friction = raw.setdefault("friction", {})
    if not isinstance(friction, dict) or not set(friction) <= set(contacts):
        return  # one law for all contacts, or what is refused elsewhere
    for name, level in _described(table, file).levels.items():
        own = {"coulomb": {"kinetic_coefficient": level}}
        if len(contacts) > 1:
            friction.setdefault(name, own)
        elif not friction:
            friction.update(own)
