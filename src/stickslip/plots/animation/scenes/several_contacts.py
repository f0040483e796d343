"""The scenes of mechanisms with several contacts; each contact has the colour of its own mode."""

import itertools
import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final

import numpy as np

from stickslip.mechanisms import (
    BlockChain,
    ClutchTrain,
    DiscBrake,
    Robot,
    SerialArm,
    TwoFeet,
    TwoLinkArm,
    joint_places,
)
from stickslip.plots.animation.scenes.forces import TALL, standing_forces
from stickslip.plots.animation.scenes.shapes import (
    Arrow,
    Ball,
    Box,
    Coil,
    Ground,
    Moment,
    Picture,
    Point,
    Rod,
    Scene,
    Shape,
    Turn,
    Wall,
    Word,
)
from stickslip.trajectory import Trajectory

SIDEWAYS: Final = (0.87, 0.5, 0.0)
"""Where the axes of the ground point to the right in pictures of robots, seen from the front."""
UPWARDS: Final = (-0.17, 0.3, 0.94)
"""Where they point upwards."""


def _rubbing(corner: Point, width: float, height: float, contact: str) -> Box:
    """Return a box in the colour of its contact's mode, by its lower left corner."""
    left, bottom = corner
    return Box(left=left, bottom=bottom, width=width, height=height, fill="mode", contact=contact)


def block_chain(mechanism: BlockChain, run: Trajectory) -> Picture:
    """Return the blocks in their row and the springs between them; distances are for the eye.

    Places are those on the belt, which is drawn at rest.
    """
    names = mechanism.coordinates
    contacts = [one.name for one in mechanism.contacts()]
    several = len(names) > 1
    apart = np.diff([run[name] for name in names], axis=0) if several else np.zeros((1, 1))
    size = max(0.6 * float(np.abs(apart).max()), 0.1 * float(np.ptp(run[names[0]]))) or 0.1
    pitch = 1.8 * size + float(np.abs(apart).max())

    def shapes(now: Moment) -> list[Shape]:
        lefts = [i * pitch + now[name] for i, name in enumerate(names)]
        high = 0.5 * TALL * size
        touched = tuple((left, left + size) for left in lefts)
        found: list[Shape] = [Ground(touched=touched, contacts=tuple(contacts) if several else ())]
        for one, other in itertools.pairwise(lefts):
            start, end = (one + size, high), (other, high)
            found.append(Coil(start=start, end=end, radius=0.2 * TALL * size))
        for left, contact in zip(lefts, contacts, strict=True):
            own = contact if several else ""
            found.append(_rubbing((left, 0.0), size, TALL * size, own))
            found += standing_forces(now, left + 0.5 * size, size, normal=False, contact=own)
        return found

    return Picture(shapes=shapes)


def clutch_train(mechanism: ClutchTrain, _seen: Trajectory) -> Picture:
    """Return the rotors side by side, seen along their axes, with linings between them."""
    largest = max(rotor.inertia for rotor in mechanism.rotors)
    radii = [max(math.sqrt(rotor.inertia / largest), 0.35) for rotor in mechanism.rotors]

    def shapes(now: Moment) -> list[Shape]:
        found: list[Shape] = []
        angle = 0.0
        for i, (name, radius) in enumerate(zip(mechanism.coordinates, radii, strict=True)):
            angle += now[name]
            centre = (3.0 * i, 0.0)
            found += _wheel(centre, radius, angle)
            if i:
                found += _lining((3.0 * i - 1.5, 0.0), f"clutch-{i}", now)
        if mechanism.brake is not None:
            found += _lining((-1.5, 0.0), "brake", now)
        return found

    return Picture(shapes=shapes, metric=False)


def _wheel(centre: Point, radius: float, angle: float) -> list[Shape]:
    """Return a disc whose spokes show how it has turned."""
    x, y = centre
    spokes = [angle + 2.0 * math.pi * k / 3.0 for k in range(3)]
    ends = [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in spokes]
    first = (x + 0.8 * (ends[0][0] - x), y + 0.8 * (ends[0][1] - y))
    return [
        Ball(centre=centre, radius=radius),
        *(Rod(points=(centre, end), width=1.2) for end in ends),
        Ball(centre=first, radius=0.07 * radius, fill="solid"),
    ]


def _lining(centre: Point, contact: str, now: Moment) -> list[Shape]:
    """Return a lining with the pressing force on it."""
    x, y = centre
    load = now.get(f"normal_force:{contact}", 0.0)
    return [
        _rubbing((x - 0.2, y - 0.45), 0.4, 0.9, contact),
        Word(at=(x, y - 1.25), text=contact, align="center"),
        Word(at=(x, y + 0.6), text=f"{load:.3g} N", align="center"),
    ]


def disc_brake(mechanism: DiscBrake, _seen: Trajectory) -> Picture:
    """Return the disc with its pads, each at its radius."""
    outer = 1.25 * max(pad.radius for pad in mechanism.pads)
    several = len(mechanism.pads) > 1
    turns = [0.5 * math.pi + 2.0 * math.pi * i / len(mechanism.pads) for i in
             range(len(mechanism.pads))]  # fmt: skip
    side = 0.28 * outer

    def shapes(now: Moment) -> list[Shape]:
        found: list[Shape] = list(_wheel((0.0, 0.0), outer, now["phi"]))
        for i, (pad, turn) in enumerate(zip(mechanism.pads, turns, strict=True), 1):
            contact = f"pad-{i}" if several else ""
            c, s = math.cos(turn), math.sin(turn)
            x, y = pad.radius * c, pad.radius * s
            corner = (x - 0.5 * side, y - 0.5 * side)
            found.append(_rubbing(corner, side, side, contact))
            friction = now.get(f"friction:{contact}" if contact else "friction", 0.0)
            found.append(Arrow(at=(x, y), along=(s, -c), value=friction, role="friction"))
        drive = now.get("drive", 0.0)
        found.append(Turn(centre=(0.0, 0.0), radius=0.3 * outer, value=drive, role="drive"))
        return found

    return Picture(shapes=shapes, names={"drive": "torque"})


def two_feet(mechanism: TwoFeet, run: Trajectory) -> Picture:
    """Return the body on its feet; the length of the spring is for the eye."""
    width = mechanism.front + mechanism.rear
    centre = mechanism.height or 0.4 * width
    foot = 0.06 * width
    wall = float(np.min(run["x"])) - mechanism.rear - 0.8 * width

    def shapes(now: Moment) -> list[Shape]:
        x = now["x"]
        feet = {"front": x + mechanism.front, "rear": x - mechanism.rear}
        touched = tuple((at - foot, at + foot) for at in feet.values())
        found: list[Shape] = [Ground(touched=touched, contacts=tuple(feet))]
        left, low = feet["rear"] - foot, 0.5 * centre
        if mechanism.stiffness > 0.0:
            found.append(Wall(start=(wall, 0.0), end=(wall, 2.0 * centre)))
            found.append(Coil(start=(wall, centre), end=(left, centre), radius=0.25 * centre))
        found.append(Box(left=left, bottom=low, width=width + 2.0 * foot, height=centre))
        for contact, at in feet.items():
            found.append(_rubbing((at - foot, 0.0), 2.0 * foot, low, contact))
            found += standing_forces(now, at, 0.0, normal=True, contact=contact)
        found.append(Ball(centre=(x, centre), radius=0.3 * foot, fill="solid"))
        if "drive" in now:
            push = Arrow(at=(x, centre), along=(1.0, 0.0), value=now["drive"], role="drive")
            found.append(push)
        return found

    return Picture(shapes=shapes)


def arm(mechanism: SerialArm | TwoLinkArm | Robot, run: Trajectory) -> Picture:
    """Return the links as lines from joint to joint, with the joints that rub.

    Arms in a plane are drawn in it, with torques at their joints; robots are seen from the front,
    from above, in a parallel projection. The last link ends at twice the distance of its centre of
    mass, unless it says how long it is.
    """
    bodies = mechanism.bodies()
    contacts = [one.name for one in mechanism.contacts()]
    planar = not isinstance(mechanism, Robot)
    tips = [[2.0 * x / body.mass if body.mass else 0.0 for x in body.moment] for body in bodies]
    if isinstance(mechanism, SerialArm):
        tips[-1] = [mechanism.links[-1].length, 0.0, 0.0]
    carriers = {body.parent for body in bodies}
    leaves = [i for i in range(len(bodies)) if i not in carriers]

    def seen(point: Sequence[float]) -> Point:
        if planar:  # x points down there
            return (point[1], -point[0])
        right = sum(a * b for a, b in zip(SIDEWAYS, point, strict=True))
        return right, sum(a * b for a, b in zip(UPWARDS, point, strict=True))

    def points(now: Moment) -> tuple[list[Point], list[Point]]:
        at = joint_places(bodies, mechanism.joint_values(now))
        ends = [
            [p + sum(row[k] * tips[i][k] for k in range(3)) for p, row in zip(*at[i], strict=True)]
            for i in leaves
        ]
        return [seen(place) for place, _ in at], [seen(end) for end in ends]

    first = {name: float(run[name][0]) for name in mechanism.coordinates}
    joints, ends = points(first)
    everything = np.array([(0.0, 0.0), *joints, *ends])
    size = 0.04 * float(np.ptp(everything, axis=0).max() or 1.0)

    def shapes(now: Moment) -> list[Shape]:
        joints, ends = points(now)
        found: list[Shape] = [
            Wall(start=(-3.0 * size, 2.0 * size), end=(3.0 * size, 2.0 * size))
            if planar
            else Wall(start=(3.0 * size, -size), end=(-3.0 * size, -size))
        ]
        for body, joint in zip(bodies, joints, strict=True):
            base = (0.0, 2.0 * size if planar else -size)
            begin = joints[body.parent] if body.parent >= 0 else base
            found.append(Rod(points=(begin, joint), width=3.0))
        for i, end in zip(leaves, ends, strict=True):
            found.append(Rod(points=(joints[i], end), width=3.0))
            found.append(Ball(centre=end, radius=0.5 * size, fill="solid"))
        several = len(contacts) > 1
        for body, joint, contact in zip(bodies, joints, contacts, strict=True):
            own = contact if several else ""
            if body.slides:
                corner = (joint[0] - size, joint[1] - size)
                found.append(_rubbing(corner, 2.0 * size, 2.0 * size, own))
            else:
                found.append(Ball(centre=joint, radius=size, fill="mode", contact=own))
        if planar:
            names = dict(zip(contacts, joints, strict=True))
            found += _torques(now, names, 2.2 * size, several=several)
        return found

    return Picture(shapes=shapes, names={"drive": "torque"})


def _torques(
    now: Moment, joints: Mapping[str, Point], radius: float, *, several: bool
) -> list[Shape]:
    """Return friction and drive at the joints of an arm in a plane."""
    found: list[Shape] = []
    for i, (contact, centre) in enumerate(joints.items(), 1):
        friction = now.get(f"friction:{contact}" if several else "friction", 0.0)
        drive = now.get(f"torque-{i}", now.get(f"{contact}_drive", 0.0))
        found.append(Turn(centre=centre, radius=radius, value=-friction, role="friction"))
        found.append(Turn(centre=centre, radius=1.4 * radius, value=drive, role="drive"))
    return found


SEVERAL: Final[Mapping[str, Scene]] = MappingProxyType(
    {
        BlockChain.name: block_chain,
        ClutchTrain.name: clutch_train,
        DiscBrake.name: disc_brake,
        TwoFeet.name: two_feet,
        SerialArm.name: arm,
        TwoLinkArm.name: arm,
        Robot.name: arm,
    }
)
"""Scenes by the names of mechanisms."""
