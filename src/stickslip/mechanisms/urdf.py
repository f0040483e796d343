"""Reads robot descriptions in URDF."""

import math
import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.mechanisms.rigid_bodies import (
    UNIT,
    Matrix,
    Vector,
    about,
    both,
    plus,
    times,
    transposed,
    turned,
)
from stickslip.quantities import Quantity
from stickslip.show.documents import check_xml, read_bytes

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from stickslip.mechanisms import Robot, RobotJoint  # as stubs declare them for users
else:
    from stickslip.mechanisms.robots import Robot, RobotJoint

MOVES = ("revolute", "continuous", "prismatic")
"""Kinds of joints that move."""
ANGLE = Quantity("q")
"""Where a joint stands, an angle or a place."""
ROUNDED = 1e-3
"""Share of a moment of inertia by which those of a file may be off: they have a few digits."""
REFUSED = MappingProxyType(
    {
        "floating": "moves in six directions: fix the robot's base to the ground",
        "planar": "moves in three directions: give two prismatic joints and one that turns",
    }
)


@dataclass(frozen=True)
class RobotDescription:
    """What a URDF file says of a robot.

    Parameters
    ----------
    robot : Robot
        The mechanism.
    levels : mapping of str to float
        Friction levels by contact [N m] or [N] where the file gives them, in ``<dynamics
        friction="...">``.
    limits : mapping of str to (float, float)
        Lower and upper limits of coordinates [rad] or [m], where the file gives them: hard stops of
        the robot, without rebound.
    locked : mapping of str to float
        Joints that do not move, and where they stand [rad] or [m].
    remarks : tuple of str
        Links whose moments of inertia no body has; they are taken as they are.

    Examples
    --------
    >>> from importlib.resources import files
    >>> found = read_urdf(files("stickslip.mechanisms") / "desk_arm.urdf")
    >>> found.limits["elbow"]
    (-2.4, 2.4)
    """

    robot: Robot
    levels: Mapping[str, float]
    limits: Mapping[str, tuple[float, float]]
    locked: Mapping[str, float]
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Joint:
    """A joint as it stands in the file."""

    name: str
    kind: str
    parent: str
    child: str
    place: Vector
    turn: Matrix
    axis: Vector
    damping: float
    friction: float
    limits: tuple[float, float] | None


@dataclass(frozen=True)
class _Lump:
    """Mass, centre of mass, and inertia about that."""

    mass: float = 0.0
    centre: Vector = (0.0, 0.0, 0.0)
    inertia: Matrix = ((0.0, 0.0, 0.0),) * 3

    def moved(self, place: Vector, turn: Matrix) -> "_Lump":
        """Return the lump seen from axes in which its own stand so."""
        return _Lump(self.mass, plus(place, times(turn, self.centre)), turned(turn, self.inertia))

    def __add__(self, other: "_Lump") -> "_Lump":
        mass = self.mass + other.mass
        # Both about the common centre of mass: the reduced mass m_1 m_2 / (m_1 + m_2) at their
        # distance.
        share = other.mass / mass if mass else 0.0
        apart = [b - a for a, b in zip(self.centre, other.centre, strict=True)]
        more = about(self.mass * share, (0.0, 0.0, 0.0), apart)
        centre = plus(self.centre, [share * x for x in apart])
        return _Lump(mass, centre, both(both(self.inertia, other.inertia), more))


def read_urdf(
    path: str | Path,
    *,
    joints: Collection[str] | None = None,
    locked: Mapping[str, float] | None = None,
    gravity: float = 9.81,
) -> RobotDescription:
    """Read a robot description in URDF: a robot with friction in every joint that moves.

    Masses, inertias, places and axes of links and joints are taken, dampers of joints, their
    limits and their friction. What fixed joints join is one link. Meshes, colours and
    transmissions are passed over; xacro files have to be expanded before.

    Parameters
    ----------
    path : str or Path
        The file.
    joints : collection of str, optional
        Names of the joints that move; the others are locked. All move if not given.
    locked : mapping of str to float, optional
        Joints that are locked, and where [rad] or [m]; those that `joints` leaves out stand at 0.
    gravity : float
        Acceleration of free fall [m/s^2], along -z of the first link.

    Returns
    -------
    RobotDescription
        Robot, friction levels and limits.

    Raises
    ------
    InputError
        If the file cannot be read, or has what cannot be taken: joints that follow another one
        (mimic), that move in several directions, or move nothing.

    Examples
    --------
    >>> from importlib.resources import files
    >>> found = read_urdf(files("stickslip.mechanisms") / "desk_arm.urdf")
    >>> found.robot.coordinates, found.levels["shoulder"]
    (('turret', 'shoulder', 'elbow'), 0.4)
    """
    if not isinstance(path, str | os.PathLike):
        raise InputError(f"path must be the name of a URDF file, got {path!r}.")
    file = str(path)
    root = _parsed(path, file)
    remarks: list[str] = []
    links = {_name(node, file): _lump(node, file, remarks) for node in root.findall("link")}
    given = [_joint(element, file) for element in root.findall("joint")]
    for tag in ("link", "joint"):
        names = [_name(element, file) for element in root.findall(tag)]
        twice = [name for name in names if names.count(name) > 1]
        if twice:
            raise InputError(f"{file}: two {tag}s are called {twice[0]!r}; rename one.")
    if not links:
        raise InputError(f"{file}: there is no <link>; is it a URDF file?")
    stand = _standing(given, joints, dict(locked or {}), file)
    # of each link: the joint that moves it, and its place and axes in those of that joint's link
    on: dict[str, tuple[str, Vector, Matrix]] = {}
    moved: dict[str, tuple[_Joint, str, Vector, Matrix]] = {}
    lumps: dict[str, _Lump] = {}
    for link, joint in _ordered(given, links, file):
        if joint is None:
            on[link] = ("", (0.0, 0.0, 0.0), UNIT)
            continue
        carrier, place, turn = on[joint.parent]
        origin = plus(place, times(turn, joint.place))
        axes = _product(turn, joint.turn)
        if joint.name not in stand:
            on[link] = (joint.name, (0.0, 0.0, 0.0), UNIT)
            moved[joint.name] = (joint, carrier, origin, axes)
            lumps[joint.name] = links[link]
            continue
        origin, axes = _brought(joint, stand[joint.name], origin, axes)
        on[link] = (carrier, origin, axes)
        if carrier:  # what is fixed to the base moves nothing
            lumps[carrier] = lumps[carrier] + links[link].moved(origin, axes)
    if not moved:
        raise InputError(f"{file}: no joint moves; there must be a revolute or prismatic one.")
    try:
        made = {name: _made(*where, lumps[name]) for name, where in moved.items()}
        robot = Robot(joints=tuple(made.values()), gravity=gravity)
    except InputError as error:
        raise type(error)(f"{file}: {error}") from None
    return RobotDescription(
        robot=robot,
        levels={
            item.contact_name: moved[name][0].friction
            for name, item in made.items()
            if moved[name][0].friction > 0.0
        },
        limits={
            item.coordinate: ends
            for name, item in made.items()
            if (ends := moved[name][0].limits) is not None
        },
        locked=stand,
        remarks=tuple(remarks),
    )


def urdf_joints(path: str | Path) -> dict[str, str]:
    """Return the kinds of the joints in a file that may move by themselves, by name.

    Examples
    --------
    >>> from importlib.resources import files
    >>> urdf_joints(files("stickslip.mechanisms") / "desk_arm.urdf")
    {'turret': 'continuous', 'shoulder': 'revolute', 'elbow': 'revolute'}
    """
    file = str(path)
    given = [_joint(element, file) for element in _parsed(path, file).findall("joint")]
    return {joint.name: joint.kind for joint in given if joint.kind in MOVES}


def _made(joint: _Joint, carrier: str, place: Vector, axes: Matrix, lump: _Lump) -> RobotJoint:
    """Return a joint with the link that it carries and all that is fixed to that."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = lump.inertia
    return RobotJoint(
        joint=joint.name,
        kind="prismatic" if joint.kind == "prismatic" else "revolute",
        parent=carrier,
        place=tuple(place),
        orientation=tuple(x for row in axes for x in row),
        axis=tuple(joint.axis),
        damping=joint.damping,
        lower_stop=None if joint.limits is None else joint.limits[0],
        upper_stop=None if joint.limits is None else joint.limits[1],
        mass=lump.mass,
        centre_x=lump.centre[0],
        centre_y=lump.centre[1],
        centre_z=lump.centre[2],
        inertia_xx=max(xx, 0.0),  # but for roundings
        inertia_yy=max(yy, 0.0),
        inertia_zz=max(zz, 0.0),
        inertia_xy=xy,
        inertia_xz=xz,
        inertia_yz=yz,
    )


def _parsed(path: str | Path, file: str) -> "Element":
    """Return the root of the file."""
    from xml.etree import ElementTree

    data = read_bytes(Path(path), file)
    check_xml(data, file)
    root = ElementTree.fromstring(data)
    if root.tag != "robot":
        raise InputError(f"{file} has the root <{root.tag}>; a URDF file has <robot>.")
    if any("xacro" in str(tag.tag) or "${" in "".join(tag.attrib.values()) for tag in root.iter()):
        raise has_macros(file)
    return root


def has_macros(file: str) -> InputError:
    """Return the error of a file with macros."""
    return InputError(f"{file} has xacro macros: expand it first, with xacro {file} > out.urdf.")


def _name(element: "Element", file: str) -> str:
    name = element.get("name", "")
    if not name:
        raise InputError(f"{file}: a <{element.tag}> has no name.")
    return name


def _reals(
    element: "Element | None", key: str, count: int, default: Sequence[float], where: str
) -> Vector:
    """Return the numbers of an attribute."""
    text = None if element is None else element.get(key)
    if text is None:
        return tuple(default)
    try:
        result = tuple(float(x) for x in text.split())
    except ValueError:
        result = ()
    if len(result) != count or not all(map(math.isfinite, result)):
        raise ParameterError(
            f"{where}: {key} must be {count} finite number{'s' * (count > 1)}, got {text!r}."
        )
    return result


def _origin(element: "Element", where: str) -> tuple[Vector, Matrix]:
    """Return place and axes of an <origin>."""
    origin = element.find("origin")
    roll, pitch, yaw = _reals(origin, "rpy", 3, (0.0, 0.0, 0.0), where)
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    # Rz(yaw) Ry(pitch) Rx(roll): turns about fixed axes, as the format has them.
    turn = (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
    return _reals(origin, "xyz", 3, (0.0, 0.0, 0.0), where), turn


def _lump(link: "Element", file: str, remarks: list[str]) -> _Lump:
    """Return the inertia of a link about its own axes; note what no body has."""
    inertial = link.find("inertial")
    if inertial is None:
        return _Lump()
    where = f"{file}: link {_name(link, file)!r}"
    mass = _reals(inertial.find("mass"), "value", 1, (0.0,), where)[0]
    tensor = inertial.find("inertia")
    xx, yy, zz, xy, xz, yz = (
        _reals(tensor, key, 1, (0.0,), where)[0]
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    )
    if mass < 0.0:
        raise ParameterError(f"{where}: mass must be at least 0 kg, got {mass:g}.")
    rows = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    low, middle, high = (float(x) for x in np.linalg.eigvalsh(rows))
    said = f"{low:.3g}, {middle:.3g} and {high:.3g} kg m^2"
    if low < -ROUNDED * high:
        raise ParameterError(
            f"{where}: the principal moments of inertia are {said}: none may be below 0."
        )
    if high > (low + middle) * (1.0 + ROUNDED):
        remarks.append(
            f"link {link.get('name')!r}: no body has the principal moments of inertia {said}: one"
            " is above the sum of the others."
        )
    place, turn = _origin(inertial, where)
    return _Lump(mass, inertia=rows).moved(place, turn)


def _joint(tag: "Element", file: str) -> _Joint:
    """Return a joint as it stands in the file."""
    name, kind = _name(tag, file), tag.get("type", "")
    where = f"{file}: joint {name!r}"
    if kind in REFUSED:
        raise InputError(f"{where} of type {kind} {REFUSED[kind]}.")
    if kind != "fixed" and kind not in MOVES:
        raise InputError(
            f"{where} has the unknown type {kind!r}; known types are fixed, {', '.join(MOVES)}."
        )
    ends = []
    for end in ("parent", "child"):
        element = tag.find(end)
        link = "" if element is None else element.get("link", "")
        if not link:
            raise InputError(f"{where} has no <{end} link=...>.")
        ends.append(link)
    place, turn = _origin(tag, where)
    dynamics, limit = tag.find("dynamics"), tag.find("limit")
    damping = _reals(dynamics, "damping", 1, (0.0,), where)[0]
    friction = _reals(dynamics, "friction", 1, (0.0,), where)[0]
    if damping < 0.0 or friction < 0.0:
        raise ParameterError(
            f"{where}: damping and friction must be at least 0, got {damping:g} and {friction:g}."
        )
    ends_at = None
    if limit is not None and kind in ("revolute", "prismatic"):
        lower, upper = (_reals(limit, key, 1, (0.0,), where)[0] for key in ("lower", "upper"))
        # 0 and 0 stand where a file gives none.
        ends_at = (lower, upper) if lower < upper else None
    return _Joint(
        name=name,
        kind="mimic" if tag.find("mimic") is not None and kind != "fixed" else kind,
        parent=ends[0],
        child=ends[1],
        place=place,
        turn=turn,
        axis=_reals(tag.find("axis"), "xyz", 3, (1.0, 0.0, 0.0), where),
        damping=damping,
        friction=friction,
        limits=ends_at,
    )


def _standing(
    given: Sequence[_Joint], moving: Collection[str] | None, locked: dict[str, float], file: str
) -> dict[str, float]:
    """Return the joints that do not move and where they stand."""
    if isinstance(moving, str):
        raise InputError(f"joints must be several names, such as [{moving!r}], got {moving!r}.")
    known = [motion.name for motion in given]
    for name in (*(moving or ()), *locked):
        if name not in known:
            raise UnknownNameError(f"joint in {file}:", name, known)
    both = sorted({*locked} & {*(moving or ())})
    if both:
        raise InputError(
            f"{file}: the joint {both[0]!r} is locked and moves: leave one of them out."
        )
    stand = {name: ANGLE.check("locked", name, at) for name, at in locked.items()}
    for joint in given:
        if joint.kind == "fixed" and joint.name in locked:
            raise InputError(f"{file}: the joint {joint.name!r} is fixed: leave it out of locked.")
        left_out = moving is not None and joint.name not in moving
        if joint.kind == "fixed" or left_out:
            stand.setdefault(joint.name, 0.0)
        elif joint.kind == "mimic" and joint.name not in stand:
            raise InputError(
                f"{file}: the joint {joint.name!r} follows another one (mimic), which mechanisms do"
                f" not have: lock it, locked={{{joint.name!r}: 0.0}}."
            )
    return stand


def _ordered(
    given: Sequence[_Joint], links: Mapping[str, _Lump], file: str
) -> Iterator[tuple[str, _Joint | None]]:
    """Yield links from the first one outwards, with the joint behind which each stands."""
    behind: dict[str, list[_Joint]] = {}
    children: dict[str, str] = {}
    for item in given:
        for link in (item.parent, item.child):
            if link not in links:
                raise UnknownNameError(f"link of joint {item.name!r} in {file}:", link, links)
        if item.child in children:
            raise InputError(
                f"{file}: the link {item.child!r} hangs on the joints {children[item.child]!r} and"
                f" {item.name!r}; a robot must be a tree, without closed loops."
            )
        children[item.child] = item.name
        behind.setdefault(item.parent, []).append(item)
    roots = [link for link in links if link not in children]
    if len(roots) != 1:
        raise InputError(
            f"{file}: {len(roots)} links hang on no joint ({', '.join(roots) or 'a closed loop'});"
            " there must be one, the base."
        )
    waiting: list[tuple[str, _Joint | None]] = [(roots[0], None)]
    reached = set()
    while waiting:
        link, joint = waiting.pop()
        reached.add(link)
        yield link, joint
        waiting += [(motion.child, motion) for motion in reversed(behind.get(link, []))]
    lost = [link for link in links if link not in reached]
    if lost:
        raise InputError(
            f"{file}: the links {', '.join(lost)} hang on each other in a closed loop; a robot must"
            " be a tree."
        )


def _product(a: Matrix, b: Matrix) -> Matrix:
    columns = tuple(times(a, column) for column in transposed(b))
    return transposed(columns)


def _brought(joint: _Joint, at: float, origin: Vector, axes: Matrix) -> tuple[Vector, Matrix]:
    """Return place and axes of a link whose joint stands at a value."""
    size = math.sqrt(sum(x * x for x in joint.axis))
    if joint.kind == "fixed" or at == 0.0 or size == 0.0:
        return origin, axes
    axis = [x / size for x in joint.axis]
    if joint.kind == "prismatic":
        return plus(origin, times(axes, tuple(at * x for x in axis))), axes
    c, s = math.cos(at), math.sin(at)
    x, y, z = axis
    skew = ((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0))
    # Rodrigues' formula.
    turn = tuple(
        tuple(c * (i == j) + s * skew[i][j] + (1.0 - c) * axis[i] * axis[j] for j in range(3))
        for i in range(3)
    )
    return origin, _product(axes, turn)
