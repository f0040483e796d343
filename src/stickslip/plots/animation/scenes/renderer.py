"""Paints shapes with matplotlib, in the colours of the theme."""

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Rectangle
from matplotlib.text import Text

from stickslip.plots.animation.scenes.shapes import (
    Arrow,
    Ball,
    Box,
    Coil,
    Fill,
    Ground,
    Rod,
    Role,
    Scales,
    Shape,
    Turn,
    Wall,
    Word,
)
from stickslip.plots.core.theme import C2, C3, C4, INK, MUTED, SLIP_BACK, STICK, SURFACE
from stickslip.trajectory import UNLOADED

MODE_COLOURS: Final = MappingProxyType(
    {0: STICK, 2: STICK, -2: STICK, 1: SURFACE, -1: SLIP_BACK, UNLOADED: "none"}
)
"""Fill of the body that rubs, by mode: the bands behind curves have the same."""
ROLE_COLOURS: Final[MappingProxyType[Role, str]] = MappingProxyType(
    {"friction": C2, "normal": C3, "drive": C4}
)
BODY: Final = SURFACE
HATCH: Final = 11.0
"""Distance of hatches, about [CSS px]."""
SHORTEST: Final = 3.0
"""Arrows below this length are left out: only a head would be seen [CSS px]."""


class _Brush:
    """What shapes need to know to be painted."""

    def __init__(self, axes: Axes, modes: Mapping[str, int], scales: Scales) -> None:
        self.axes, self.modes, self.scales = axes, modes, scales
        low, high = axes.get_xlim()
        self.left, self.right = low, high
        figure = axes.get_figure(root=True)
        dots = (figure.dpi if figure else 72.0) / 72.0
        self.pixel = (high - low) * dots / max(axes.get_window_extent().width, 1.0)
        """Metres in a CSS pixel."""
        self.spacing = _spacing(HATCH * self.pixel)

    def fill(self, fill: Fill, contact: str = "") -> str:
        """Return the colour of a fill; that of a contact without a law never changes."""
        if fill == "mode" and contact in self.modes:
            return MODE_COLOURS[self.modes[contact]]
        return {"mode": BODY, "body": BODY, "solid": INK, "none": "none"}[fill]


def artists_of(
    axes: Axes, shapes: Sequence[Shape], modes: Mapping[str, int], scales: Scales
) -> list[Artist]:
    """Return shapes as matplotlib artists of axes whose limits are set, from back to front."""
    brush = _Brush(axes, modes, scales)
    found: list[Artist] = []
    for order, shape in enumerate(shapes):
        for artist in _PAINTERS[type(shape)](shape, brush):
            # forces are seen whatever stands before them
            front = 60 if isinstance(shape, (Arrow, Turn)) else 0
            artist.set_zorder(3 + 0.5 * order + front)
            axes.add_artist(artist)
            found.append(artist)
    return sorted(found, key=lambda artist: artist.get_zorder())


def _line(xs: Any, ys: Any, *, colour: str = INK, width: float = 1.4, **style: Any) -> Line2D:
    return Line2D(xs, ys, color=colour, linewidth=width, **style)


def _box(shape: Box, brush: _Brush) -> list[Artist]:
    corner = (shape.left, shape.bottom)
    face = brush.fill(shape.fill, shape.contact)
    return [
        Rectangle(corner, shape.width, shape.height, facecolor=face, edgecolor=INK, linewidth=1.4)
    ]


def _ball(shape: Ball, brush: _Brush) -> list[Artist]:
    face = brush.fill(shape.fill, shape.contact)
    return [Circle(shape.centre, shape.radius, facecolor=face, edgecolor=INK, linewidth=1.4)]


def _rod(shape: Rod, _brush: _Brush) -> list[Artist]:
    xs, ys = zip(*shape.points, strict=True)
    return [_line(xs, ys, width=shape.width)]


def _coil(shape: Coil, _brush: _Brush) -> list[Artist]:
    (x0, y0), (x1, y1) = shape.start, shape.end
    length = math.hypot(x1 - x0, y1 - y0) or 1e-300
    along = np.array([0.0, 0.1, *np.linspace(0.1, 0.9, 2 * shape.turns + 1), 0.9, 1.0])
    swing = [(-1.0) ** i for i in range(2 * shape.turns - 1)]
    across = np.array([0.0, 0.0, 0.0, *swing, 0.0, 0.0, 0.0]) * shape.radius / length
    xs = x0 + along * (x1 - x0) - across * (y1 - y0)
    ys = y0 + along * (y1 - y0) + across * (x1 - x0)
    return [_line(xs, ys, width=1.3)]


def _ground(shape: Ground, brush: _Brush) -> list[Artist]:
    step, y = brush.spacing, shape.height
    first = math.floor(brush.left / step) * step  # strokes stay where they are on the ground
    feet = np.arange(first, brush.right + 2 * step, step)
    gaps = np.full_like(feet, np.nan)
    xs = np.column_stack([feet, feet - 0.7 * step, gaps]).ravel()
    ys = np.column_stack([np.full_like(feet, y), np.full_like(feet, y - 0.7 * step), gaps]).ravel()
    found: list[Artist] = [
        _line(xs, ys, colour=MUTED, width=0.8, alpha=0.6),
        _line([brush.left, brush.right], [y, y]),
    ]
    deep = 5.0 * brush.pixel
    contacts = shape.contacts or ("",) * len(shape.touched)
    for (low, high), contact in zip(shape.touched, contacts, strict=True):
        face = brush.fill("mode", contact)
        strip = Rectangle(
            (low, y - deep), high - low, deep, facecolor=face, edgecolor=INK, linewidth=0.9
        )
        strip.set_gid("contact")
        found.append(strip)
    return found


def _wall(shape: Wall, brush: _Brush) -> list[Artist]:
    (x0, y0), (x1, y1) = shape.start, shape.end
    length = math.hypot(x1 - x0, y1 - y0) or 1e-300
    count = max(3, round(length / brush.spacing))
    share = np.linspace(0.0, 1.0, count + 1)[1:]
    back = 0.7 * min(length / count, brush.spacing)
    tx, ty = (x1 - x0) / length, (y1 - y0) / length
    xs = x0 + share * (x1 - x0)
    ys = y0 + share * (y1 - y0)
    gaps = np.full_like(xs, np.nan)
    ends = xs - back * (tx + ty), ys - back * (ty - tx)
    return [
        _line(
            np.column_stack([xs, ends[0], gaps]).ravel(),
            np.column_stack([ys, ends[1], gaps]).ravel(),
            colour=MUTED,
            width=0.8,
            alpha=0.6,
        ),
        _line([x0, x1], [y0, y1], width=1.6),
    ]


def _arrow(shape: Arrow, brush: _Brush) -> list[Artist]:
    length = brush.scales.metres * shape.value
    if abs(length) < SHORTEST * brush.pixel:
        return []
    (x, y), (dx, dy) = shape.at, shape.along
    return [
        FancyArrowPatch(
            (x, y),
            (x + length * dx, y + length * dy),
            arrowstyle="-|>",
            mutation_scale=10,
            shrinkA=0,
            shrinkB=0,
            color=ROLE_COLOURS[shape.role],
            linewidth=2.0,
        )
    ]


def _turn(shape: Turn, brush: _Brush) -> list[Artist]:
    if not brush.scales.torque or abs(shape.value) < 0.01 * brush.scales.torque:
        return []
    colour, r = ROLE_COLOURS[shape.role], shape.radius
    sweep = 90.0 * shape.value / brush.scales.torque
    start, end = (90.0, 90.0 + sweep) if sweep > 0 else (90.0 + sweep, 90.0)
    arc = Arc(shape.centre, 2 * r, 2 * r, theta1=start, theta2=end, color=colour, linewidth=2.0)
    tip = math.radians(90.0 + sweep)
    ahead = tip + math.copysign(0.05, sweep)
    x, y = shape.centre
    head = FancyArrowPatch(
        (x + r * math.cos(tip), y + r * math.sin(tip)),
        (x + r * math.cos(ahead), y + r * math.sin(ahead)),
        arrowstyle="-|>",
        mutation_scale=10,
        shrinkA=0,
        shrinkB=0,
        color=colour,
    )
    return [arc, head]


def _word(shape: Word, _brush: _Brush) -> list[Artist]:
    x, y = shape.at
    return [Text(x, y, shape.text, color=INK, ha=shape.align, va="baseline", fontsize=11)]


def _spacing(wanted: float) -> float:
    """Return a round distance, so that hatches do not wander while the view moves."""
    power = 10.0 ** math.floor(math.log10(wanted))
    return min((1.0, 2.0, 5.0, 10.0), key=lambda m: abs(math.log(m * power / wanted))) * power


_PAINTERS: Final[MappingProxyType[type, Callable[[Any, _Brush], list[Artist]]]] = MappingProxyType(
    {
        Box: _box,
        Ball: _ball,
        Rod: _rod,
        Coil: _coil,
        Ground: _ground,
        Wall: _wall,
        Arrow: _arrow,
        Turn: _turn,
        Word: _word,
    }
)
