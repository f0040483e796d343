"""Small sketches of the rig: pushed, shot off by a spring, and fastened to it."""

from collections.abc import Callable
from types import MappingProxyType
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from stickslip.plots.svg import Draw, Size, inline_svg
from stickslip.plots.theme import C2, INK, MUTED

__all__ = ["SKETCHES", "SKETCH_SIZE", "draw_sketch", "sketch"]

SKETCH_SIZE: Final[Size] = (250, 84)
GROUND: Final = 70.0
BLOCK: Final = (40.0, 44.0)
TURNS: Final = 5


def draw_sketch(kind: str, *, mass: str = "1 kg", force: str = "10 N") -> Draw:
    """Return a drawing of a rig.

    Parameters
    ----------
    kind : str
        One of `SKETCHES`.
    mass, force : str
        What is written on the block, and beside the arrow of a push.

    Returns
    -------
    callable
        Draws it, 250 by 84 CSS px.
    """
    body = _BODIES[kind]

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_xlim(0, SKETCH_SIZE[0])
        axes.set_ylim(SKETCH_SIZE[1], 0)  # as on a page: downwards
        axes.set_axis_off()
        _ground(axes)
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

    Parameters
    ----------
    kind : str
        One of `SKETCHES`.
    alt : str
        What it shows, for readers who cannot see it.
    prefix : str
        Start of its ids.
    mass, force : str
        What is written on the block, and beside the arrow of a push.

    Returns
    -------
    str
        One ``<svg>`` element.

    Examples
    --------
    >>> sketch("push", alt="A force pushes a block", prefix="push")[:4]
    '<svg'
    """
    draw = draw_sketch(kind, mass=mass, force=force)
    return inline_svg(draw, alt=alt, prefix=prefix, wide=SKETCH_SIZE, narrow=None)


def _ground(axes: Axes) -> None:
    for x in range(14, 242, 12):
        axes.plot([x, x - 6], [GROUND, GROUND + 7], color=MUTED, linewidth=0.8, alpha=0.6)
    axes.plot([8, 242], [GROUND, GROUND], color=INK, linewidth=1.4)


def _arrow(axes: Axes, force: str) -> float:
    axes.plot([38, 82], [48, 48], color=C2, linewidth=1.8, solid_capstyle="butt")
    axes.add_patch(Polygon([(89, 48), (79, 43), (79, 53)], facecolor=C2, edgecolor="none"))
    axes.text(38, 36, force, va="center", fontsize=12)
    return 90.0


def _spring(axes: Axes, end: float) -> None:
    axes.plot([14, 14], [20, GROUND], color=INK, linewidth=1.4)
    x = np.linspace(14, end, 2 * TURNS + 3)
    y = np.array([46.0, *[46.0 + 7 * (-1) ** turn for turn in range(2 * TURNS + 1)], 46.0])
    axes.plot(x, y, color=INK, linewidth=1.4)


def _released(axes: Axes, _force: str) -> float:
    _spring(axes, 82)
    for y, length in ((40, 34), (48, 44), (56, 34)):
        axes.plot([160, 160 + length], [y, y], color=MUTED, linewidth=1.0)
    return 112.0


def _fixed(axes: Axes, _force: str) -> float:
    _spring(axes, 104)
    axes.plot([106], [46], "o", color=INK, markersize=6)
    return 108.0


_BODIES: Final = MappingProxyType[str, Callable[[Axes, str], float]](
    {"push": _arrow, "released-spring": _released, "fixed-spring": _fixed}
)
SKETCHES: Final = tuple(_BODIES)
"""The rigs that can be drawn."""
