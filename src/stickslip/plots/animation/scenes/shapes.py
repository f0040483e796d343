"""The shapes that scenes are made of, in metres; how they are painted is another matter."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, NamedTuple, TypeAlias

from typing_extensions import TypeVar

from stickslip.described import Described
from stickslip.mechanisms import Mechanism
from stickslip.trajectory import Trajectory

Point: TypeAlias = tuple[float, float]
Fill: TypeAlias = Literal["mode", "body", "solid", "none"]
"""``"mode"``: the colour of stick or slip, for the body that rubs."""
Role: TypeAlias = Literal["friction", "normal", "drive"]
Moment: TypeAlias = Mapping[str, float]
"""Columns of a run at one time, ``"t"``, and the present value of each drive by its name."""
TALL: Final = 0.6
"""Height of a block over its length."""
Drawn = TypeVar("Drawn", bound=Mechanism, default=Any)
"""The mechanism that a scene is of."""
LONGEST: Final = 0.32
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
    metric: bool = True
    """Whether places are metres, and a scale is shown below."""
    names: Mapping[Role, str] | None = None
    """What the arrows are called; friction, normal force and drive if not given."""


Scene: TypeAlias = Callable[[Drawn, Trajectory], Picture]
"""Called once with the mechanism and its run, sampled evenly; dimensions that the mechanism does
not have follow from the run.
"""


def standing_forces(
    now: Moment, x: float, width: float, *, normal: bool, contact: str = ""
) -> list[Shape]:
    """Return friction and normal force where a body stands on the ground at y = 0."""
    of = f":{contact}" if contact else ""
    friction, load = now.get(f"friction{of}", 0.0), now.get(f"normal_force{of}", 0.0)
    found: list[Shape] = [Arrow(at=(x, 0.0), along=(-1.0, 0.0), value=friction, role="friction")]
    if normal:
        foot = (x + 0.25 * width, 0.0)
        found.append(Arrow(at=foot, along=(0.0, 1.0), value=load, role="normal"))
    return found


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
    return Scales(LONGEST * size / largest if largest else 0.0, max(torques, default=0.0))


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
