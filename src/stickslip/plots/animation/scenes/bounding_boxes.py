"""How much room shapes take, and how long the arrows are."""

import math
from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

from stickslip.plots.animation.scenes.shapes import (
    Arrow,
    Ball,
    Box,
    Coil,
    Ground,
    Point,
    Rod,
    Shape,
    Turn,
    Wall,
    Word,
)

LONGEST: Final = 0.32
"""Length of the largest force of a run over the size of the mechanism."""
WALL: Final = 0.03
"""Depth of the hatching behind a wall over its length."""


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
