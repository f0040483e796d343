"""The shapes that scenes are made of, in metres; how they are painted is another matter."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, TypeAlias

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


Drawn = TypeVar("Drawn", bound=Mechanism, default=Any)
"""The mechanism that a scene is of."""
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
