"""Sketches of the rig in its three readings, and schematics of rig and cart with their symbols."""

from collections.abc import Callable
from types import MappingProxyType
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Polygon, Rectangle

from stickslip.plots.core.svg import Draw, Size, inline_svg
from stickslip.plots.core.theme import C1, C2, C4, INK, MUTED, SURFACE, symbol_label

SKETCH_SIZE: Final[Size] = (250, 84)
GROUND: Final = 70.0
BLOCK: Final = (40.0, 44.0)
TURNS: Final = 5
SCHEMATIC_SIZE: Final[Size] = (358, 220)


def draw_sketch(kind: str, *, mass: str = "1 kg", force: str = "10 N") -> Draw:
    """Return a drawing of a rig."""
    body = _BODIES[kind]

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_xlim(0, SKETCH_SIZE[0])
        axes.set_ylim(SKETCH_SIZE[1], 0)  # as on a page: downwards
        axes.set_axis_off()
        _ground_line(axes, 8, 242, GROUND)
        left = body(axes, force)
        axes.add_patch(
            Rectangle((left, GROUND - BLOCK[1]), *BLOCK, fill=False, edgecolor=INK, linewidth=1.4)
        )
        axes.text(
            left + BLOCK[0] / 2, GROUND - BLOCK[1] / 2, mass, ha="center", va="center", fontsize=12
        )

    return draw


def sketch(kind: str, *, alt: str, prefix: str, mass: str = "1 kg", force: str = "10 N") -> str:
    """Return the sketch of a rig as inline SVG.

    Examples
    --------
    >>> sketch("push", alt="A force pushes a block", prefix="push")[:4]
    '<svg'
    """
    draw = draw_sketch(kind, mass=mass, force=force)
    return inline_svg(draw, alt=alt, prefix=prefix, wide=SKETCH_SIZE, narrow=None)


def _ground_line(axes: Axes, left: int, right: int, height: float) -> None:
    for x in range(left + 6, right, 12):
        axes.plot([x, x - 6], [height, height + 7], color=MUTED, linewidth=0.8, alpha=0.6)
    axes.plot([left, right], [height, height], color=INK, linewidth=1.4)


def _arrow(axes: Axes, force: str) -> float:
    axes.plot([38, 82], [48, 48], color=C2, linewidth=1.8, solid_capstyle="butt")
    axes.add_patch(Polygon([(89, 48), (79, 43), (79, 53)], facecolor=C2, edgecolor="none"))
    axes.text(38, 36, force, va="center", fontsize=12)
    return 90.0


def _spring(axes: Axes, start: float, end: float, *, middle: float, bulge: float) -> None:
    x = np.linspace(start, end, 2 * TURNS + 3)
    turns = [middle + bulge * (-1) ** turn for turn in range(2 * TURNS + 1)]
    axes.plot(x, [middle, *turns, middle], color=INK, linewidth=1.4)


def _held_spring(axes: Axes, end: float) -> None:
    axes.plot([14, 14], [20, GROUND], color=INK, linewidth=1.4)
    _spring(axes, 14, end, middle=46, bulge=7)


def _released(axes: Axes, _force: str) -> float:
    _held_spring(axes, 82)
    for y, length in ((40, 34), (48, 44), (56, 34)):
        axes.plot([160, 160 + length], [y, y], color=MUTED, linewidth=1.0)
    return 112.0


def _fixed(axes: Axes, _force: str) -> float:
    _held_spring(axes, 104)
    axes.plot([106], [46], "o", color=INK, markersize=6)
    return 108.0


_BODIES: Final = MappingProxyType[str, Callable[[Axes, str], float]](
    {"push": _arrow, "released-spring": _released, "fixed-spring": _fixed}
)
SKETCHES: Final = tuple(_BODIES)
"""The rigs that can be drawn."""


def schematic(kind: str, *, alt: str, prefix: str) -> str:
    """Return a schematic with the symbols of the source paper as inline SVG.

    Examples
    --------
    >>> schematic("cart", alt="A cart with a pendulum", prefix="fig1")[:4]
    '<svg'
    """
    body = _SCHEMATICS[kind]

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_xlim(0, SCHEMATIC_SIZE[0])
        axes.set_ylim(SCHEMATIC_SIZE[1], 0)
        axes.set_axis_off()
        _ground_line(axes, 10, 348, 180)
        body(axes)

    return inline_svg(draw, alt=alt, prefix=prefix, wide=SCHEMATIC_SIZE, narrow=None)


def _cart(axes: Axes) -> None:
    pivot, ball = (150.0, 132.0), (84.0, 38.0)
    axes.add_patch(Rectangle((94, 132), 112, 48, fill=False, edgecolor=INK, linewidth=1.6))
    axes.plot(
        [pivot[0], pivot[0]], [pivot[1], 30], color=MUTED, linewidth=0.9, linestyle=(0, (5, 4))
    )
    axes.plot([pivot[0], ball[0]], [pivot[1], ball[1]], color=INK, linewidth=1.8)
    axes.add_patch(Circle(ball, 14, facecolor=INK, edgecolor=INK))
    axes.add_patch(Circle(pivot, 4, facecolor=SURFACE, edgecolor=INK, linewidth=1.6, zorder=4))
    axes.add_patch(Arc(pivot, 130, 130, theta1=235, theta2=270, color=MUTED, linewidth=1.1))
    axes.add_patch(Arc(pivot, 62, 62, theta1=275, theta2=30, color=C4, linewidth=1.6))
    _head(axes, (146.0, 101.0), (-1.0, 0.0), C4)
    _text(axes, 128, 58, "θ")
    _text(axes, 104, 88, "l")
    _text(axes, 60, 34, "m")
    _text(axes, 150, 158, "M")
    _text(axes, 196, 118, "τ", C4)
    _text(axes, 60, 168, "μ")
    _arrow_to(axes, (264, 120), (324, 120), C1)
    _text(axes, 294, 106, "x", C1)
    _arrow_to(axes, (88, 190), (44, 190), C2)
    _text(axes, 66, 204, symbol_label("F_f"), C2)
    _arrow_to(axes, (222, 180), (222, 132), MUTED)
    _text(axes, 234, 152, "N")


def _rig(axes: Axes) -> None:
    axes.plot([30, 30], [96, 180], color=INK, linewidth=1.8)
    for height in range(102, 184, 10):
        axes.plot([30, 23], [height, height + 6], color=MUTED, linewidth=0.8, alpha=0.6)
    _spring(axes, 30, 110, middle=152, bulge=10)
    axes.add_patch(Rectangle((110, 124), 58, 56, fill=False, edgecolor=INK, linewidth=1.6))
    axes.add_patch(
        Rectangle(
            (266, 124), 58, 56, fill=False, edgecolor=MUTED, linewidth=1.1, linestyle=(0, (5, 4))
        )
    )
    _text(axes, 139, 152, "m")
    _text(axes, 70, 128, "K")
    _arrow_to(axes, (172, 152), (216, 152), C2)
    _text(axes, 196, 138, "F = K x", C2)
    for left, right, height, name in ((110, 150, 104, "x"), (110, 266, 82, "s")):
        for end in (left, right):
            axes.plot([end, end], [height - 7, height + 7], color=MUTED, linewidth=0.8)
        _arrow_to(axes, (left, height), (right, height), C1)
        _text(axes, (left + right) / 2, height - 13, name, C1)
    _text(axes, 60, 200, f"{symbol_label('mu_d')}, {symbol_label('mu_s')}")


def _text(axes: Axes, x: float, y: float, text: str, colour: str = INK) -> None:
    axes.text(x, y, text, ha="center", va="center", fontsize=13, style="italic", color=colour)


def _arrow_to(
    axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str
) -> None:
    way = np.subtract(end, start) / np.hypot(*np.subtract(end, start))
    stop = np.subtract(end, 8 * way)
    axes.plot([start[0], stop[0]], [start[1], stop[1]], color=colour, linewidth=1.6)
    _head(axes, end, (float(way[0]), float(way[1])), colour)


def _head(axes: Axes, tip: tuple[float, float], way: tuple[float, float], colour: str) -> None:
    along = np.array(way) / np.hypot(*way)
    across = np.array([-along[1], along[0]])
    base = np.array(tip) - 9 * along
    axes.add_patch(
        Polygon([tip, base + 4 * across, base - 4 * across], facecolor=colour, edgecolor="none")
    )


_SCHEMATICS: Final = MappingProxyType[str, Callable[[Axes], None]]({"cart": _cart, "rig": _rig})
"""What is drawn with the symbols of the source paper."""
