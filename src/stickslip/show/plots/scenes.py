"""What mechanisms look like: shapes in metres, and where they are at a moment of a run.

A picture of ours gives the shapes of each moment, which `animations` paints. Other mechanisms have
a scene of matplotlib's artists, which an installed package registers, or bars for their states.
"""

import functools
import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import entry_points
from types import MappingProxyType
from typing import Any, Final, Literal, NamedTuple, TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from typing_extensions import TypeVar

from stickslip import mechanisms
from stickslip.engine.trajectory import UNLOADED, Trajectory
from stickslip.errors import StickslipError
from stickslip.show.described import Described
from stickslip.show.plots import theme

# The shapes that scenes are made of, in metres; how they are painted is another matter.

Point: TypeAlias = tuple[float, float]
Fill: TypeAlias = Literal["mode", "body", "solid", "none"]
"""``"mode"``: the colour of stick or slip, for the body that rubs."""
Role: TypeAlias = Literal["friction", "normal", "drive"]
Moment: TypeAlias = Mapping[str, float]
"""Columns of a run at one time, ``"t"``, and the present value of each drive by its name."""
MODE_COLOURS: Final = MappingProxyType(
    {
        0: theme.STICK,
        2: theme.STICK,
        -2: theme.STICK,
        1: theme.SURFACE,
        -1: theme.SLIP_BACK,
        UNLOADED: "none",
    }
)
"""Fill of the body that rubs, by mode: the bands behind curves have the same."""
TALL: Final = 0.6
"""Height of a block over its length."""
Drawn = TypeVar("Drawn", bound=mechanisms.Mechanism, default=Any)
"""The mechanism that a scene is of."""
LONGEST_ARROW: Final = 0.32
"""Length of the largest force of a run over the size of the mechanism."""
WALL: Final = 0.03
"""Depth of the hatching behind a wall over its length."""


@dataclass(frozen=True, kw_only=True)
class Box(metaclass=Described):
    """A body with straight sides."""

    left: float
    """Smallest x [m]."""
    bottom: float
    """Smallest y [m]."""
    width: float
    """Its extent in x [m]."""
    height: float
    """Its extent in y [m]."""
    fill: Fill = "body"
    """How its area is filled."""
    contact: str = ""
    """Contact whose mode colours it, where there are several."""


@dataclass(frozen=True, kw_only=True)
class Ball(metaclass=Described):
    """A ball, a wheel or a pivot."""

    centre: Point
    """x and y of its centre [m]."""
    radius: float
    """Its radius [m]."""
    fill: Fill = "body"
    """How its area is filled."""
    contact: str = ""
    """Contact whose mode colours it, where there are several."""


@dataclass(frozen=True, kw_only=True)
class Rod(metaclass=Described):
    """A rod, a string, a rail: straight lines from point to point."""

    points: tuple[Point, ...]
    """x and y of each point [m], in order."""
    width: float = 1.6
    """Line width [CSS px]."""


@dataclass(frozen=True, kw_only=True)
class Coil(metaclass=Described):
    """A spring from one point to another."""

    start: Point
    """x and y of one end [m]."""
    end: Point
    """x and y of the other end [m]."""
    radius: float
    """Radius of the turns [m]."""
    turns: int = 6
    """Number of turns."""


@dataclass(frozen=True, kw_only=True)
class Ground(metaclass=Described):
    """Hatched ground from side to side of the view, with the part that is rubbed at the moment."""

    height: float = 0.0
    """y of the surface [m]."""
    touched: tuple[tuple[float, float], ...] = ()
    """Left and right ends of what rubs: coloured by stick and slip."""
    contacts: tuple[str, ...] = ()
    """Contact of each of these, where there are several."""


@dataclass(frozen=True, kw_only=True)
class Wall(metaclass=Described):
    """A face that does not move, hatched behind: a support or a hard stop."""

    start: Point
    """x and y of one end [m]."""
    end: Point
    """The hatching is on the left of the way from start to end."""


@dataclass(frozen=True, kw_only=True)
class Arrow(metaclass=Described):
    """A force on a body; all arrows of an animation have one scale, which is stated."""

    at: Point
    """x and y of the point where the force acts [m]."""
    along: Point
    """Direction of a positive value, of length 1."""
    value: float
    """Force [N]."""
    role: Role
    """What the force is, which sets the colour of the arrow."""


@dataclass(frozen=True, kw_only=True)
class Turn(metaclass=Described):
    """A torque about a point, as an arc from the top, a quarter of a turn for the largest one.

    So the arc stays above its centre, where it hides nothing of a cart.
    """

    centre: Point
    """x and y of the point that the torque turns about [m]."""
    radius: float
    """Radius of the arc [m]."""
    value: float
    """Torque, anticlockwise positive [N m]."""
    role: Role
    """What the torque is, which sets the colour of the arc."""


@dataclass(frozen=True, kw_only=True)
class Word(metaclass=Described):
    """A text."""

    at: Point
    """x and y of the anchor of the text [m]."""
    text: str
    """The text."""
    align: Literal["left", "center", "right"] = "left"
    """Which part of the text stands at the anchor."""


Shape: TypeAlias = Box | Ball | Rod | Coil | Ground | Wall | Arrow | Turn | Word


@dataclass(frozen=True, kw_only=True)
class Picture(metaclass=Described):
    """How a run is drawn."""

    shapes: Callable[[Moment], Sequence[Shape]]
    """What is to be seen at a moment, from back to front."""
    names: Mapping[Role, str] | None = None
    """What the arrows are called; friction, normal force and drive if not given."""


Update: TypeAlias = Callable[[Moment], Iterable[Artist]]
"""Moves artists to a moment and returns those that it has moved or made."""
Scene: TypeAlias = Callable[[Axes, Drawn, Trajectory], Update]
"""Draws the mechanism into empty axes, with matplotlib; called once, with its run, sampled evenly.
"""


def standing_forces(
    now: Moment, x: float, width: float, *, normal: bool, contact: str = ""
) -> list[Shape]:
    """Return friction and normal force where a body stands on the ground at y = 0."""
    of = f":{contact}" if contact else ""
    friction, load = now.get(f"friction{of}", 0.0), now.get(f"normal_force{of}", 0.0)
    result: list[Shape] = [Arrow(at=(x, 0.0), along=(-1.0, 0.0), value=friction, role="friction")]
    if normal:
        foot = (x + 0.25 * width, 0.0)
        result.append(Arrow(at=foot, along=(0.0, 1.0), value=load, role="normal"))
    return result


class Extent(NamedTuple):
    """A box around shapes [m]."""

    left: float
    """Smallest x [m]."""
    right: float
    """Largest x [m]."""
    bottom: float
    """Smallest y [m]."""
    top: float
    """Largest y [m]."""

    @property
    def width(self) -> float:
        """Its width [m]."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Its height [m]."""
        return self.top - self.bottom


class Scales(NamedTuple):
    """What the arrows of an animation mean."""

    metres: float
    """Length of an arrow of 1 N [m]."""
    torque: float
    """Torque of a quarter of a turn [N m]; 0 if there is none."""


def extent_of(shapes: Iterable[Shape], scales: Scales | None = None) -> Extent:
    """Return the box around shapes; around their arrows too if there are scales.

    Examples
    --------
    >>> extent_of([Ball(centre=(0.0, 1.0), radius=0.1)])
    Extent(left=-0.1, right=0.1, bottom=0.9, top=1.1)
    """
    points = [point for shape in shapes for point in _corners(shape, scales)]
    xs, ys = [x for x, _ in points] or [0.0], [y for _, y in points] or [0.0]
    return Extent(min(xs), max(xs), min(ys), max(ys))


def joined(extents: Sequence[Extent]) -> Extent:
    """Return the box around boxes."""
    lefts, rights, bottoms, tops = zip(*extents, strict=True)
    return Extent(min(lefts), max(rights), min(bottoms), max(tops))


def scales_of(moments: Sequence[Sequence[Shape]], size: float) -> Scales:
    """Return scales with which the largest force is about a third of the mechanism.

    Examples
    --------
    >>> push = Arrow(at=(0.0, 0.0), along=(1.0, 0.0), value=16.0, role="drive")
    >>> scales_of([[push]], 1.0)
    Scales(metres=0.02, torque=0.0)
    """
    forces = [abs(s.value) for m in moments for s in m if isinstance(s, Arrow)]
    torques = [abs(s.value) for m in moments for s in m if isinstance(s, Turn)]
    largest = max(forces, default=0.0)
    return Scales(LONGEST_ARROW * size / largest if largest else 0.0, max(torques, default=0.0))


def nice(value: float) -> float:
    """Return the largest of 1, 2, 5, 10, ... that is not above a value.

    Examples
    --------
    >>> nice(0.37), nice(4.9), nice(5.0)
    (0.2, 2.0, 5.0)
    """
    power = 10.0 ** math.floor(math.log10(value))
    return float(f"{max(m for m in (1, 2, 5) if m * power <= value * (1 + 1e-12)) * power:.1g}")


def _corners(shape: Shape, scales: Scales | None) -> Sequence[Point]:
    match shape:
        case Box():
            right, top = shape.left + shape.width, shape.bottom + shape.height
            return [(shape.left, shape.bottom), (right, top)]
        case Ball(centre=(x, y), radius=r) | Turn(centre=(x, y), radius=r):
            return [(x - r, y - r), (x + r, y + r)]
        case Rod():
            return shape.points
        case Coil(start=start, end=end, radius=r):
            return [(start[0], start[1] - r), (end[0], end[1] + r), start, end]
        case Ground(height=y):
            return [(x, y) for touched in shape.touched for x in touched]
        case Wall(start=start, end=end):
            depth = WALL * math.dist(start, end)
            return [(x + s * depth, y) for x, y in (start, end) for s in (-1.0, 1.0)]
        case Arrow(at=(x, y), along=(dx, dy), value=value) if scales is not None:
            length = scales.metres * value
            return [(x, y), (x + length * dx, y + length * dy)]
        case Word(at=at):
            return [at]
        case _:
            return []


# The scenes of our mechanisms; each of several contacts has the colour of its own mode.
#
# Lengths that a mechanism has are drawn to scale; bodies it gives no size of are as large as suits
# the motion. Heights above the ground are for the eye where the equations do not know them.

SIDEWAYS: Final = (0.87, 0.5, 0.0)
"""Where the axes of the ground point to the right in pictures of robots, seen from the front."""
UPWARDS: Final = (-0.17, 0.3, 0.94)
"""Where they point upwards."""


def _rubbing(corner: Point, width: float, height: float, contact: str = "") -> Box:
    """Return a box in the colour of its contact's mode, by its lower left corner."""
    left, bottom = corner
    return Box(left=left, bottom=bottom, width=width, height=height, fill="mode", contact=contact)


def _driven(now: Moment, at: Point) -> list[Shape]:
    """Return the arrow of a drive along the ground, where there is one."""
    drive = now.get("drive")
    return [] if drive is None else [Arrow(at=at, along=(1.0, 0.0), value=drive, role="drive")]


def block_chain(mechanism: mechanisms.BlockChain, run: Trajectory) -> Picture:
    """Return the blocks in their row and the springs between them; distances are for the eye.

    Places are those on the belt, which is drawn at rest.
    """
    names = mechanism.coordinates
    contacts = [place.name for place in mechanism.contacts()]
    several = len(names) > 1
    apart = np.diff([run[name] for name in names], axis=0) if several else np.zeros((1, 1))
    size = max(0.6 * float(np.abs(apart).max()), 0.1 * float(np.ptp(run[names[0]]))) or 0.1
    pitch = 1.8 * size + float(np.abs(apart).max())

    def shapes(now: Moment) -> list[Shape]:
        lefts = [i * pitch + now[name] for i, name in enumerate(names)]
        high = 0.5 * TALL * size
        touched = tuple((left, left + size) for left in lefts)
        result: list[Shape] = [Ground(touched=touched, contacts=tuple(contacts) if several else ())]
        for value, other in itertools.pairwise(lefts):
            start, end = (value + size, high), (other, high)
            result.append(Coil(start=start, end=end, radius=0.2 * TALL * size))
        for left, contact in zip(lefts, contacts, strict=True):
            own = contact if several else ""
            result.append(_rubbing((left, 0.0), size, TALL * size, own))
            result += standing_forces(now, left + 0.5 * size, size, normal=False, contact=own)
        return result

    return Picture(shapes=shapes)


def two_feet(mechanism: mechanisms.TwoFeet, run: Trajectory) -> Picture:
    """Return the body on its feet; the length of the spring is for the eye."""
    width = mechanism.front + mechanism.rear
    centre = mechanism.height or 0.4 * width
    foot = 0.06 * width
    wall = float(np.min(run["x"])) - mechanism.rear - 0.8 * width

    def shapes(now: Moment) -> list[Shape]:
        x = now["x"]
        feet = {"front": x + mechanism.front, "rear": x - mechanism.rear}
        touched = tuple((at - foot, at + foot) for at in feet.values())
        result: list[Shape] = [Ground(touched=touched, contacts=tuple(feet))]
        left, low = feet["rear"] - foot, 0.5 * centre
        if mechanism.stiffness > 0.0:
            result.append(Wall(start=(wall, 0.0), end=(wall, 2.0 * centre)))
            result.append(Coil(start=(wall, centre), end=(left, centre), radius=0.25 * centre))
        result.append(Box(left=left, bottom=low, width=width + 2.0 * foot, height=centre))
        for contact, at in feet.items():
            result.append(_rubbing((at - foot, 0.0), 2.0 * foot, low, contact))
            result += standing_forces(now, at, 0.0, normal=True, contact=contact)
        result.append(Ball(centre=(x, centre), radius=0.3 * foot, fill="solid"))
        return [*result, *_driven(now, (x, centre))]

    return Picture(shapes=shapes)


def arm(
    mechanism: mechanisms.SerialArm | mechanisms.TwoLinkArm | mechanisms.Robot, run: Trajectory
) -> Picture:
    """Return the links as lines from joint to joint, with the joints that rub.

    Arms in a plane are drawn in it, with torques at their joints; robots are seen from the front,
    from above, in a parallel projection. The last link ends at twice the distance of its centre of
    mass, unless it says how long it is.
    """
    bodies = mechanism.bodies()
    contacts = [place.name for place in mechanism.contacts()]
    planar = not isinstance(mechanism, mechanisms.Robot)
    tips = [[2.0 * x / body.mass if body.mass else 0.0 for x in body.moment] for body in bodies]
    if isinstance(mechanism, mechanisms.SerialArm):
        tips[-1] = [mechanism.links[-1].length, 0.0, 0.0]
    carriers = {body.parent for body in bodies}
    leaves = [i for i in range(len(bodies)) if i not in carriers]

    def seen(point: Sequence[float]) -> Point:
        if planar:  # x points down there
            return (point[1], -point[0])
        right = sum(a * b for a, b in zip(SIDEWAYS, point, strict=True))
        return right, sum(a * b for a, b in zip(UPWARDS, point, strict=True))

    def points(now: Moment) -> tuple[list[Point], list[Point]]:
        at = mechanisms.joint_places(bodies, mechanism.joint_values(now))
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
        result: list[Shape] = [
            Wall(start=(-3.0 * size, 2.0 * size), end=(3.0 * size, 2.0 * size))
            if planar
            else Wall(start=(3.0 * size, -size), end=(-3.0 * size, -size))
        ]
        for body, joint in zip(bodies, joints, strict=True):
            base = (0.0, 2.0 * size if planar else -size)
            begin = joints[body.parent] if body.parent >= 0 else base
            result.append(Rod(points=(begin, joint), width=3.0))
        for i, end in zip(leaves, ends, strict=True):
            result.append(Rod(points=(joints[i], end), width=3.0))
            result.append(Ball(centre=end, radius=0.5 * size, fill="solid"))
        several = len(contacts) > 1
        for body, joint, contact in zip(bodies, joints, contacts, strict=True):
            own = contact if several else ""
            if body.slides:
                corner = (joint[0] - size, joint[1] - size)
                result.append(_rubbing(corner, 2.0 * size, 2.0 * size, own))
            else:
                result.append(Ball(centre=joint, radius=size, fill="mode", contact=own))
        if planar:
            names = dict(zip(contacts, joints, strict=True))
            result += _torques(now, names, 2.2 * size, several=several)
        return result

    return Picture(shapes=shapes, names={"drive": "torque"})


def _torques(
    now: Moment, joints: Mapping[str, Point], radius: float, *, several: bool
) -> list[Shape]:
    """Return friction and drive at the joints of an arm in a plane."""
    result: list[Shape] = []
    for i, (contact, centre) in enumerate(joints.items(), 1):
        friction = now.get(f"friction:{contact}" if several else "friction", 0.0)
        drive = now.get(f"torque-{i}", now.get(f"{contact}_drive", 0.0))
        result.append(Turn(centre=centre, radius=radius, value=-friction, role="friction"))
        result.append(Turn(centre=centre, radius=1.4 * radius, value=drive, role="drive"))
    return result


def _range(seen: Trajectory, name: str) -> float:
    return float(np.ptp(seen[name]))


def _plumb(incline: float, at: Point, length: float) -> list[Shape]:
    """Return a plumb line where the ground is inclined: pictures are drawn along the ground.

    From a point that it hangs from, down as gravity points: turned clockwise from the picture's
    vertical where positive x is uphill.
    """
    if incline == 0.0:
        return []
    x, y = at
    angle = f"{math.degrees(incline):.3g}\N{DEGREE SIGN}".replace("-", "\N{MINUS SIGN}")
    bob = (x - length * math.sin(incline), y - length * math.cos(incline))
    return [
        Rod(points=((x, y), (x, y - 1.1 * length)), width=0.6),
        Rod(points=(at, bob), width=1.0),
        Ball(centre=bob, radius=0.08 * length, fill="solid"),
        Word(at=(x + 0.12 * length, y - 0.1 * length), text=angle),
    ]


def _effort(motor: mechanisms.Motor, now: Moment, column: str) -> float:
    """Return the force or torque of a motor: what the motion takes, or what it is told."""
    if isinstance(motor, mechanisms.Prescribed):
        return now[column]
    wanted = now.get("motor", 0.0)
    limit = motor.limit if isinstance(motor, mechanisms.Torque) else None
    return wanted if limit is None else max(-limit, min(limit, wanted))


def spring_block(mechanism: mechanisms.SpringBlock, run: Trajectory) -> Picture:
    """Return the block and the spring that shoots it off; `x` is the face that the spring meets."""
    x_0 = mechanism.compression
    side = -1.0 if x_0 < 0 else 1.0
    size = 0.35 * max(abs(x_0), 0.5 * _range(run, "x")) or 0.1
    squeezed = float(np.max(side * (x_0 - run["x"]), initial=abs(x_0)))
    natural = max(2.2 * squeezed, 1.5 * size)
    foot = x_0 - side * natural

    def shapes(now: Moment) -> list[Shape]:
        x = now["x"]
        left = x if side > 0 else x - size
        middle = left + 0.5 * size
        result: list[Shape] = [Ground(touched=((left, left + size),))]
        if mechanism.stiffness > 0:
            end = x if mechanism.attached or side * (x_0 - x) > 0 else x_0
            high = 0.5 * TALL * size
            corners = ((foot, 0.0), (foot, 1.6 * TALL * size))
            start, stop = corners if side > 0 else corners[::-1]
            result.append(Wall(start=start, end=stop))
            result.append(Coil(start=(foot, high), end=(end, high), radius=0.32 * TALL * size))
        result += _stops(mechanism.lower_stop, mechanism.upper_stop, left - x, size)
        result.append(_rubbing((left, 0.0), size, TALL * size))
        result += _plumb(
            mechanism.incline, (left + 0.15 * size, 1.7 * TALL * size), 0.6 * TALL * size
        )
        result += standing_forces(now, middle, size, normal=True)
        return [*result, *_driven(now, (middle, 0.6 * TALL * size))]

    return Picture(shapes=shapes)


def _stops(lower: float | None, upper: float | None, left: float, size: float) -> list[Shape]:
    """Return hard stops of a block whose left face is at ``x + left``."""
    result: list[Shape] = []
    if lower is not None:
        place = lower + left
        result.append(Wall(start=(place, 0.0), end=(place, 0.8 * TALL * size)))
    if upper is not None:
        place = upper + left + size
        result.append(Wall(start=(place, 0.8 * TALL * size), end=(place, 0.0)))
    return result


def towed_block(mechanism: mechanisms.TowedBlock, run: Trajectory) -> Picture:
    """Return the block, its spring and the far end that pulls; its natural length is ours."""
    stretch = mechanism.speed * run.t - run["x"]
    side = -1.0 if mechanism.speed < 0 else 1.0
    most = float(np.max(np.abs(stretch))) or 0.1
    size = 0.5 * most
    natural = 1.3 * most + 0.2 * size

    def shapes(now: Moment) -> list[Shape]:
        x, far = now["x"], mechanism.speed * now["t"] + side * natural
        left, high = (x - size if side > 0 else x), 0.5 * TALL * size
        middle = left + 0.5 * size
        result: list[Shape] = [
            Ground(touched=((left, left + size),)),
            Coil(start=(x, high), end=(far, high), radius=0.25 * TALL * size),
            Rod(points=((far, 0.7 * high), (far, 1.3 * high)), width=3.0),
            Rod(points=((far, high), (far + side * 0.3 * size, high))),
            _rubbing((left, 0.0), size, TALL * size),
            *standing_forces(
                now, middle, size, normal=mechanism.load is None or mechanism.load != 1.0
            ),
        ]
        if "modulation" in now:
            top = (middle - 0.25 * size, TALL * size)
            value = now["modulation"]
            result.append(Arrow(at=top, along=(0.0, -1.0), value=value, role="drive"))
        return result

    return Picture(shapes=shapes, names={"drive": "modulation"})


def axis(mechanism: mechanisms.Axis, run: Trajectory) -> Picture:
    """Return a carriage on its rail; `x` is its middle."""
    reach = float(np.max(np.abs(run["x"]), initial=0.0))
    size = 0.35 * max(_range(run, "x"), 0.3 * reach) or 0.1
    foot = -1.6 * reach - 1.5 * size

    def shapes(now: Moment) -> list[Shape]:
        x, left = now["x"], now["x"] - 0.5 * size
        high = 0.5 * TALL * size
        result: list[Shape] = [Ground(touched=((left, left + size),))]
        if mechanism.stiffness > 0:
            result.append(Wall(start=(foot, 0.0), end=(foot, 1.6 * TALL * size)))
            result.append(Coil(start=(foot, high), end=(left, high), radius=0.3 * TALL * size))
        result += _stops(mechanism.lower_stop, mechanism.upper_stop, -0.5 * size, size)
        result.append(_rubbing((left, 0.0), size, TALL * size))
        result += standing_forces(now, x, size, normal=mechanism.load != 1.0)
        return [*result, *_driven(now, (x, 1.2 * high))]

    return Picture(shapes=shapes)


def pid_axis(mechanism: mechanisms.PIDAxis, run: Trajectory) -> Picture:
    """Return the carriage of an axis that its loop alone holds."""
    return axis(mechanisms.Axis(inertia=mechanism.inertia, load=mechanism.load), run)


def two_mass_axis(mechanism: mechanisms.TwoMassAxis, run: Trajectory) -> Picture:
    """Return motor and load on a rail with what joins them; its length is for the eye."""
    reach = max(_range(run, "x"), _range(run, "other"))
    stretch = float(np.max(np.abs(run["x"] - run["other"]), initial=0.0))
    size = 0.25 * max(reach, stretch) or 0.1
    gap = 1.2 * size + 1.2 * stretch
    of_motor, of_load = ("x", "other") if mechanism.rubs == "motor" else ("other", "x")
    both = mechanism.rubs == "both"

    def shapes(now: Moment) -> list[Shape]:
        motor, load = now[of_motor] - size, now[of_load] + gap
        sides = {"motor": motor, "load": load}
        rubbing = {name: left for name, left in sides.items() if both or name == mechanism.rubs}
        names = tuple(rubbing) if both else ()
        high = 0.5 * TALL * size
        raised = 0.12 * TALL * size  # what does not rub runs on rollers
        touched = tuple((left, left + size) for left in rubbing.values())
        result: list[Shape] = [Ground(touched=touched, contacts=names)]
        result.append(Coil(start=(motor + size, high), end=(load, high), radius=0.3 * TALL * size))
        for side, place in sides.items():
            rubs = side in rubbing
            base = 0.0 if rubs else raised
            if not rubs:
                for share in (0.25, 0.75):
                    centre = (place + share * size, 0.5 * raised)
                    result.append(Ball(centre=centre, radius=0.5 * raised, fill="solid"))
            body = _rubbing((place, base), size, TALL * size - base, side if both else "")
            result.append(body if rubs else replace(body, fill="body"))
        for side, left in rubbing.items():
            middle, own = left + 0.5 * size, side if both else ""
            normal = mechanism.load != 1.0
            result += standing_forces(now, middle, size, normal=normal, contact=own)
        return [*result, *_driven(now, (motor + 0.5 * size, 1.2 * high))]

    return Picture(shapes=shapes)


def pendulum(mechanism: mechanisms.Pendulum, _seen: Trajectory) -> Picture:
    """Return the rod that hangs from its pivot at (0, 0), which rubs."""
    l, bob = mechanism.length, 0.09 * mechanism.length  # noqa: E741  # the symbol of PHYSICS

    def shapes(now: Moment) -> list[Shape]:
        theta = now["theta"]
        end = (l * math.sin(theta), -l * math.cos(theta))
        result: list[Shape] = [
            Wall(start=(-0.35 * l, 0.14 * l), end=(0.35 * l, 0.14 * l)),
            Rod(points=((0.0, 0.14 * l), (0.0, 0.0))),
            Rod(points=((0.0, 0.0), end), width=2.4),
            Ball(centre=end, radius=bob, fill="solid"),
            Ball(centre=(0.0, 0.0), radius=0.06 * l, fill="mode"),
            Turn(centre=(0.0, 0.0), radius=0.17 * l, value=-now["friction"], role="friction"),
        ]
        if "drive" in now:
            result.append(
                Turn(centre=(0.0, 0.0), radius=0.25 * l, value=now["drive"], role="drive")
            )
        return result

    return Picture(shapes=shapes)


def pendulum_cart(mechanism: mechanisms.PendulumCart, _seen: Trajectory) -> Picture:
    """Return the cart with its wheels and the inverted pendulum, to scale.

    The wheelbase, the height of the pivot and the rod are those of the mechanism; a cart without
    wheelbase or height is given some for the eye.
    """
    l = mechanism.length  # noqa: E741  # the symbol of PHYSICS
    rubs = mechanism.pivot_load is not None
    base = mechanism.wheelbase or 0.6 * l
    pivot = mechanism.pivot_height or 0.24 * l
    wheel = min(0.07 * l, 0.4 * pivot)
    overhang = 1.6 * wheel
    wheels, joint = (contact.name for contact in mechanism.contacts()) if rubs else ("", "")

    def shapes(now: Moment) -> list[Shape]:
        x, theta = now["x"], now["theta"]
        ball = (x - l * math.sin(theta), pivot + l * math.cos(theta))
        feet = (x - 0.5 * base, x + 0.5 * base)
        # the arrow of a torque turns as theta does, anticlockwise
        return [
            Ground(
                touched=tuple((foot - wheel, foot + wheel) for foot in feet),
                contacts=(wheels, wheels),
            ),
            _rubbing((feet[0] - overhang, wheel), base + 2.0 * overhang, pivot - wheel, wheels),
            *(Ball(centre=(foot, wheel), radius=wheel, fill="solid") for foot in feet),
            Rod(points=((x, pivot), ball), width=2.4),
            Ball(centre=ball, radius=0.08 * l, fill="solid"),
            Ball(
                centre=(x, pivot),
                radius=(0.05 if rubs else 0.03) * l,
                fill="mode" if rubs else "none",
                contact=joint,
            ),
            *_spiral(mechanism, (x, pivot), theta),
            *_plumb(mechanism.incline, (feet[1] + base, pivot + l), 0.4 * l),
            *standing_forces(now, x, base, normal=True, contact=wheels),
            Turn(
                centre=(x, pivot),
                radius=0.13 * l,
                value=-now.get(f"friction:{joint}", 0.0) if rubs else 0.0,
                role="friction",
            ),
            Turn(
                centre=(x, pivot),
                radius=0.2 * l,
                value=_effort(mechanism.pendulum, now, "torque"),
                role="drive",
            ),
        ]

    return Picture(shapes=shapes, names={"drive": "torque"})


def _spiral(mechanism: mechanisms.PendulumCart, centre: Point, theta: float) -> list[Shape]:
    """Return the spring at the pivot: two turns from the cart up to the rod."""
    if mechanism.pivot_stiffness == 0.0:
        return []
    turns = np.linspace(-0.5 * math.pi, 4.5 * math.pi + theta, 61)
    radii = mechanism.length * np.linspace(0.05, 0.13, turns.size)
    xs, ys = centre[0] + radii * np.cos(turns), centre[1] + radii * np.sin(turns)
    return [Rod(points=tuple(zip(xs.tolist(), ys.tolist(), strict=True)), width=1.1)]


def capsule(mechanism: mechanisms.Capsule, run: Trajectory) -> Picture:
    """Return the capsule with its inner mass, spring and stops; `x` and `xi` are their middles."""
    if mechanism.angle is not None:
        return inclined_masses(mechanism, run)
    places = [float(np.abs(run["xi"]).max()), 0.0]
    places += [abs(s) for s in (mechanism.lower_stop, mechanism.upper_stop) if s is not None]
    soft = ((mechanism.lower_soft_stop, -1.0), (mechanism.upper_soft_stop, 1.0))
    places += [abs(stop.place) for stop, _ in soft if stop is not None]
    reach = max(places) or 0.1
    inner = 0.7 * reach
    post = 0.35 * inner
    half = reach + 0.5 * inner + 3.0 * post
    tall = 1.1 * reach

    def shapes(now: Moment) -> list[Shape]:
        x, place = now["x"], now["x"] + now["xi"]
        left, face = x - half, place - 0.5 * inner
        middle = 0.5 * tall
        result: list[Shape] = [
            Ground(touched=((left, x + half),)),
            _rubbing((left, 0.0), 2.0 * half, tall),
        ]
        if mechanism.stiffness > 0:
            coil = Coil(start=(left, middle), end=(face, middle), radius=0.16 * tall, turns=7)
            result.append(coil)
        for stop, side in ((mechanism.lower_stop, -1.0), (mechanism.upper_stop, 1.0)):
            if stop is None:
                continue
            near = x + stop + side * 0.5 * inner
            start = near if side > 0 else near - post
            for bottom in (0.0, 0.72 * tall):
                result.append(
                    Box(left=start, bottom=bottom, width=post, height=0.28 * tall, fill="solid")
                )
        for elastic, side in soft:
            if elastic is None:
                continue
            touched = side * max(side * elastic.place, side * now["xi"]) + side * 0.5 * inner
            ends = (x + touched, 0.25 * tall), (x + side * half, 0.25 * tall)
            result.append(Coil(start=ends[0], end=ends[1], radius=0.1 * tall, turns=4))
        box = Box(left=face, bottom=0.15 * tall, width=inner, height=0.7 * tall)
        effort = _effort(mechanism.drive, now, "force")
        result += [
            box,
            *_plumb(mechanism.incline, (x, 1.9 * tall), 0.7 * tall),
            *standing_forces(now, x, 1.8 * half, normal=True),
            Arrow(at=(place, middle), along=(1.0, 0.0), value=effort, role="drive"),
        ]
        return result

    return Picture(shapes=shapes, names={"drive": "force on the inner mass"})


def inclined_masses(
    mechanism: mechanisms.Capsule | mechanisms.TwoMassCapsule, run: Trajectory
) -> Picture:
    """Return the capsule with its masses on their lines, which cross in its middle."""
    inner: dict[str, mechanisms.Capsule | mechanisms.InnerMass]
    if isinstance(mechanism, mechanisms.Capsule):
        inner = {"xi": mechanism}
    else:
        inner = {"xi": mechanism.first, "zeta": mechanism.second}
    reach = max(float(np.abs(run[name]).max()) for name in inner) or 0.1
    half = 1.5 * reach

    def shapes(now: Moment) -> list[Shape]:
        x = now["x"]
        result: list[Shape] = [
            Ground(touched=((x - half, x + half),)),
            _rubbing((x - half, 0.0), 2.0 * half, 2.0 * half),
        ]
        for name, mass in inner.items():
            along, up = math.cos(mass.angle or 0.0), math.sin(mass.angle or 0.0)
            ends = [(x + side * reach * along, half + side * reach * up) for side in (-1.0, 1.0)]
            result.append(Rod(points=(ends[0], ends[1]), width=0.6))
            middle = (x + along * now[name], half + up * now[name])
            if mass.stiffness > 0:
                result.append(Coil(start=ends[0], end=middle, radius=0.1 * reach, turns=6))
            result.append(Ball(centre=middle, radius=0.25 * reach))
        result += _plumb(mechanism.incline, (x, 3.0 * half), half)
        return [*result, *standing_forces(now, x, 1.8 * half, normal=True)]

    return Picture(shapes=shapes, names={})


PICTURES: Final[Mapping[str, Callable[[Any, Trajectory], Picture]]] = MappingProxyType(
    {
        mechanisms.SpringBlock.name: spring_block,
        mechanisms.TowedBlock.name: towed_block,
        mechanisms.Axis.name: axis,
        mechanisms.PIDAxis.name: pid_axis,
        mechanisms.TwoMassAxis.name: two_mass_axis,
        mechanisms.Pendulum.name: pendulum,
        mechanisms.PendulumCart.name: pendulum_cart,
        mechanisms.Capsule.name: capsule,
        mechanisms.TwoMassCapsule.name: inclined_masses,
        mechanisms.BlockChain.name: block_chain,
        mechanisms.TwoFeet.name: two_feet,
        mechanisms.SerialArm.name: arm,
        mechanisms.TwoLinkArm.name: arm,
        mechanisms.Robot.name: arm,
    }
)
"""How our mechanisms are drawn, by the names of these."""


# Which scene a mechanism has: ours, that of an installed package, or bars.


def bars(axes: Axes, mechanism: mechanisms.Mechanism, run: Trajectory) -> Update:
    """Draw bars for the states, each over its largest value in the run.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from stickslip import Axis, Coulomb, simulate
    >>> from stickslip.mechanisms.drives import Pulse
    >>> axis = Axis(inertia=2.0, drive=Pulse(level=5.0, duration=1.0))
    >>> run = simulate(axis, Coulomb(kinetic_coefficient=1.0), t_end=10.0).sampled(50)
    >>> update = bars(Figure().add_subplot(), axis, run)
    >>> bar, *_ = update({"x": float(run["x"].max()), "v": 0.0, "mode": 0.0})
    >>> bar.get_width()
    1.0
    """
    contacts = mechanism.contacts()
    columns = {
        name: f"mode:{place.name}" if len(contacts) > 1 else "mode"
        for place in contacts
        for name in place.slips
    }
    names = tuple(run.states or (*mechanism.coordinates, *mechanism.rates))
    largest = {name: float(np.abs(run[name]).max()) or 1.0 for name in names}
    axes.set(xlim=(-1.0, 1.0), xticks=[], yticks=range(len(names)), yticklabels=names)
    axes.invert_yaxis()
    axes.axvline(0.0, color=theme.INK, linewidth=1.2)
    drawn = list(axes.barh(names, [0.0] * len(names), height=0.4, edgecolor=theme.INK))
    texts = [axes.text(1.0, row - 0.3, "", ha="right", va="bottom") for row in range(len(names))]

    def update(now: Moment) -> list[Artist]:
        for name, bar, text in zip(names, drawn, texts, strict=True):
            mode = round(now[columns[name]]) if name in columns else None
            bar.set_width(now[name] / largest[name])
            bar.set_facecolor(theme.SURFACE if mode is None else MODE_COLOURS[mode])
            text.set_text(f"{now[name] + 0.0:.3g} {run.units.get(name, '1')}")
        return [*drawn, *texts]

    return update


GROUP = "stickslip.scenes"


@functools.cache
def _registered() -> Mapping[str, Scene]:
    result: dict[str, Scene] = {}
    for entry in entry_points(group=GROUP):
        scene = entry.load()
        if not callable(scene):
            raise StickslipError(f"entry point {entry.value} of {GROUP} is not a function.")
        result[entry.name] = scene
    return MappingProxyType(result)


def scene_of(mechanism: mechanisms.Mechanism) -> Scene | None:
    """Return the scene that a package registers, or bars; None where ours is drawn, by shapes.

    Packages add scenes under the entry point ``stickslip.scenes``, by the name of the mechanism.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> scene_of(Pendulum(mass=0.2, length=0.5)) is None
    True
    """
    result = _registered().get(mechanism.name)
    return result if result or mechanism.name in PICTURES else bars
