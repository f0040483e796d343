"""Animations of runs: frames as a GIF, an MP4, or inside HTML.

Frames are drawn once and then blitted: only what moves is painted anew. A GIF is written by Pillow,
an MP4 by ffmpeg, one picture after the other, so that no animation is held in memory.
"""

import base64
import contextlib
import html
import io
import itertools
import math
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Protocol, TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Rectangle
from matplotlib.text import Text
from numpy.typing import NDArray

from stickslip.engine.trajectory import UNLOADED, Trajectory
from stickslip.errors import InputError
from stickslip.mechanisms import Mechanism, driven_by_motor, motor_of, slipping
from stickslip.mechanisms.drives import Drive
from stickslip.show.documents import unwritable
from stickslip.show.formatting import scale_of
from stickslip.show.plots import scenes, theme
from stickslip.show.plots.axes import dense, horizon, raster, within
from stickslip.show.plots.scenes import Drawn, Scene
from stickslip.show.plots.svg import Draw, Size, standalone_svg
from stickslip.show.plots.theme import C1, C2, C3, C4, INK, MUTED, SLIP_BACK, STICK, SURFACE, shade

# A frame of an animation: a scene painted to scale, beside time plots with a cursor.

# Paints shapes with matplotlib, in the colours of the theme.

MODE_COLOURS: Final = MappingProxyType(
    {0: STICK, 2: STICK, -2: STICK, 1: SURFACE, -1: SLIP_BACK, UNLOADED: "none"}
)
"""Fill of the body that rubs, by mode: the bands behind curves have the same."""
ROLE_COLOURS: Final[MappingProxyType[scenes.Role, str]] = MappingProxyType(
    {"friction": C2, "normal": C3, "drive": C4}
)
BODY: Final = SURFACE
HATCH: Final = 11.0
"""Distance of hatches, about [CSS px]."""
SHORTEST_ARROW: Final = 3.0
"""Arrows below this length are left out: only a head would be seen [CSS px]."""


class _Brush:
    """What shapes need to know to be painted."""

    def __init__(self, axes: Axes, modes: Mapping[str, int], scales: scenes.Scales) -> None:
        self.axes, self.modes, self.scales = axes, modes, scales
        low, high = axes.get_xlim()
        self.left, self.right = low, high
        figure = axes.get_figure(root=True)
        dots = (figure.dpi if figure else 72.0) / 72.0
        self.pixel = (high - low) * dots / max(axes.get_window_extent().width, 1.0)
        """Metres in a CSS pixel."""
        self.spacing = _spacing(HATCH * self.pixel)

    def fill(self, fill: scenes.Fill, contact: str = "") -> str:
        """Return the colour of a fill; that of a contact without a law never changes."""
        if fill == "mode" and contact in self.modes:
            return MODE_COLOURS[self.modes[contact]]
        return {"mode": BODY, "body": BODY, "solid": INK, "none": "none"}[fill]


def artists_of(
    axes: Axes, shapes: Sequence[scenes.Shape], modes: Mapping[str, int], scales: scenes.Scales
) -> list[Artist]:
    """Return shapes as matplotlib artists of axes whose limits are set, from back to front."""
    brush = _Brush(axes, modes, scales)
    found: list[Artist] = []
    for order, shape in enumerate(shapes):
        for artist in _PAINTERS[type(shape)](shape, brush):
            # forces are seen whatever stands before them
            front = 60 if isinstance(shape, (scenes.Arrow, scenes.Turn)) else 0
            artist.set_zorder(3 + 0.5 * order + front)
            axes.add_artist(artist)
            found.append(artist)
    return sorted(found, key=lambda artist: artist.get_zorder())


def _line(xs: Any, ys: Any, *, colour: str = INK, width: float = 1.4, **style: Any) -> Line2D:
    return Line2D(xs, ys, color=colour, linewidth=width, **style)


def _box(shape: scenes.Box, brush: _Brush) -> list[Artist]:
    corner = (shape.left, shape.bottom)
    face = brush.fill(shape.fill, shape.contact)
    return [
        Rectangle(corner, shape.width, shape.height, facecolor=face, edgecolor=INK, linewidth=1.4)
    ]


def _ball(shape: scenes.Ball, brush: _Brush) -> list[Artist]:
    face = brush.fill(shape.fill, shape.contact)
    return [Circle(shape.centre, shape.radius, facecolor=face, edgecolor=INK, linewidth=1.4)]


def _rod(shape: scenes.Rod, _brush: _Brush) -> list[Artist]:
    xs, ys = zip(*shape.points, strict=True)
    return [_line(xs, ys, width=shape.width)]


def _coil(shape: scenes.Coil, _brush: _Brush) -> list[Artist]:
    (x0, y0), (x1, y1) = shape.start, shape.end
    length = math.hypot(x1 - x0, y1 - y0) or 1e-300
    along = np.array([0.0, 0.1, *np.linspace(0.1, 0.9, 2 * shape.turns + 1), 0.9, 1.0])
    swing = [(-1.0) ** i for i in range(2 * shape.turns - 1)]
    across = np.array([0.0, 0.0, 0.0, *swing, 0.0, 0.0, 0.0]) * shape.radius / length
    xs = x0 + along * (x1 - x0) - across * (y1 - y0)
    ys = y0 + along * (y1 - y0) + across * (x1 - x0)
    return [_line(xs, ys, width=1.3)]


def _ground(shape: scenes.Ground, brush: _Brush) -> list[Artist]:
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


def _wall(shape: scenes.Wall, brush: _Brush) -> list[Artist]:
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


def _arrow(shape: scenes.Arrow, brush: _Brush) -> list[Artist]:
    length = brush.scales.metres * shape.value
    if abs(length) < SHORTEST_ARROW * brush.pixel:
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


def _turn(shape: scenes.Turn, brush: _Brush) -> list[Artist]:
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


def _word(shape: scenes.Word, _brush: _Brush) -> list[Artist]:
    x, y = shape.at
    return [Text(x, y, shape.text, color=INK, ha=shape.align, va="baseline", fontsize=11)]


def _spacing(wanted: float) -> float:
    """Return a round distance, so that hatches do not wander while the view moves."""
    power = 10.0 ** math.floor(math.log10(wanted))
    return min((1.0, 2.0, 5.0, 10.0), key=lambda m: abs(math.log(m * power / wanted))) * power


_PAINTERS: Final[MappingProxyType[type, Callable[[Any, _Brush], list[Artist]]]] = MappingProxyType(
    {
        scenes.Box: _box,
        scenes.Ball: _ball,
        scenes.Rod: _rod,
        scenes.Coil: _coil,
        scenes.Ground: _ground,
        scenes.Wall: _wall,
        scenes.Arrow: _arrow,
        scenes.Turn: _turn,
        scenes.Word: _word,
    }
)


# A scene beside time plots with a cursor: what a frame of an animation is made of.

NAMES: Final[Mapping[scenes.Role, str]] = {
    "friction": "friction",
    "normal": "normal force",
    "drive": "drive",
}
LETTER: Final = 6.4
"""Width of a letter of the key [CSS px]."""
EDGE, TITLE, KEY, AXIS, LABEL, GAP = 14.0, 26.0, 62.0, 44.0, 72.0, 18.0
"""Margins [CSS px]: around all, above a scene, below it, below and left of time plots, between."""


def layout(figure: Figure, *, narrow: bool, flat: bool) -> tuple[Axes, list[Axes]]:
    """Return the axes of the scene and of three time plots.

    They stand beside each other where the scene is high, else one above the other; all places are
    given in pixels, so that they do not move from frame to frame.
    """
    figure.set_layout_engine("none")
    width, height = (72.0 * inches for inches in figure.get_size_inches())
    if narrow:
        low = 0.52 * height if not flat else 0.62 * height
        scene = (EDGE, low + KEY, width - EDGE, height - TITLE)
        panels = _stacked(LABEL, AXIS, width - EDGE, low - 0.4 * GAP)
    elif flat:
        low = 0.44 * height
        scene = (EDGE, low + KEY, width - EDGE, height - TITLE)
        each = (width - EDGE) / 3
        panels = [(i * each + LABEL, AXIS, (i + 1) * each, low - GAP) for i in range(3)]
    else:
        scene = (EDGE, KEY, 0.53 * width, height - TITLE)
        panels = _stacked(0.53 * width + LABEL, AXIS, width - EDGE, height - EDGE)
    axes, *plots = (
        figure.add_axes(((l / width), b / height, (r - l) / width, (t - b) / height))
        for l, b, r, t in (scene, *panels)  # noqa: E741  # left, bottom, right, top
    )
    axes.spines[:].set_visible(False)
    axes.set_yticks([])
    for plot in plots[1:]:
        plot.sharex(plots[0])
    return axes, plots


Place = tuple[float, float, float, float]


def _stacked(left: float, bottom: float, right: float, top: float) -> list[Place]:
    """Return three places one below the other."""
    each = (top - bottom + GAP) / 3
    return [(left, bottom + i * each, right, bottom + (i + 1) * each - GAP) for i in (2, 1, 0)]


def write_legend(
    axes: Axes,
    picture: scenes.Picture,
    shown: Sequence[Sequence[scenes.Shape]],
    scales: scenes.Scales,
) -> None:
    """Say below a scene, whose limits are set, what its arrows are and how long they are."""
    kinds = {
        s.role: type(s)
        for shapes in shown
        for s in shapes
        if isinstance(s, (scenes.Arrow, scenes.Turn)) and _seen(s, scales)
    }
    names = {**NAMES, **(picture.names or {})}
    x = 0.0
    for role, colour in ROLE_COLOURS.items():
        if role in kinds:
            _write(axes, x, -34.0, names[role], colour)
            x += LETTER * (len(names[role]) + 2)
    x = 0.0
    if scenes.Arrow in kinds.values() and scales.metres:
        x = _bar(axes, scales)
    if scenes.Turn in kinds.values():
        _write(axes, x, -52.0, f"¼ of a turn is {scales.torque:.2g} N m", MUTED)


def _bar(axes: Axes, scales: scenes.Scales) -> float:
    """Draw the length of a round force; return where it ends [CSS px]."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    force = scenes.nice(0.25 * min(right - left, high - low) / scales.metres)
    share = force * scales.metres / (right - left)
    figure = axes.get_figure(root=True)
    wide = 72.0 * axes.get_window_extent().width / (figure.dpi if figure else 72.0)
    height = -52.0 / (wide * (high - low) / (right - left))
    axes.plot(
        [0.0, share], [height, height], transform=axes.transAxes, color=INK, linewidth=2.0,
        clip_on=False, gid="force-scale", solid_capstyle="butt",
    )  # fmt: skip
    text = f"{force:g} N"
    _write(axes, share * wide + 6.0, -52.0, text, MUTED)
    return share * wide + 6.0 + LETTER * (len(text) + 3)


def _write(axes: Axes, x: float, y: float, text: str, colour: str) -> None:
    axes.annotate(
        text,
        (0.0, 0.0),
        xycoords="axes fraction",
        xytext=(x, y),
        textcoords="offset points",
        va="center",
        color=colour,
        fontsize=11,
        annotation_clip=False,
    )


def _seen(shape: scenes.Arrow | scenes.Turn, scales: scenes.Scales) -> bool:
    return abs(shape.value) > (0.01 * scales.torque if isinstance(shape, scenes.Turn) else 0.0)


LOOKS: Final = 121
"""Times at which is looked how much room a scene takes."""
FAR: Final = 4.0
"""Travel over the mechanism's own width from which the view follows it."""
FOLLOWED: Final = 1.0
"""Half the width of a view that follows over the mechanism's own width."""
FLAT: Final = 0.42
"""Height over width of a scene below which it stands above the time plots, not beside them."""
CURVES: Final = (C1, C2, C3, C4)
"""Colours of the coordinates of several contacts, in turn."""
NAMED: Final = 3
"""Contacts that stick and are named above the scene; of more their number is given."""
WORDS: Final = {0: "stick", 1: "slip forward", -1: "slip backward", 2: "at stop", -2: "at stop"}


def moments_of(
    run: Trajectory, mechanism: Mechanism, times: "np.typing.NDArray[np.float64]"
) -> list[scenes.Moment]:
    """Return the columns of a run, and its drives or the torque of its motor, at some times.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, simulate
    >>> from stickslip.mechanisms.drives import Sine
    >>> axis = Axis(inertia=1.0, drive=Sine(amplitude=3.0, frequency=1.0))
    >>> run = simulate(axis, Coulomb(kinetic_coefficient=1.0), t_end=1.0)
    >>> moment = moments_of(run, axis, np.array([0.25]))[0]
    >>> moment["t"], round(moment["drive"], 9)
    (0.25, 3.0)
    """
    seen = run.at(times)
    columns = {name: seen[name] for name in run.names}
    drives = {name: drive for name, drive in mechanism.drives().items() if name not in run.names}
    motor = motor_of(mechanism)
    side = mechanism.coordinates.index(driven_by_motor(mechanism)) if motor else 0

    def acting(drive: Drive, t: float, row: int) -> float:
        value = drive.value(t)
        if motor is None or drive is not motor.drive:
            return value
        place, rate = (
            columns[n][row] for n in (mechanism.coordinates[side], mechanism.rates[side])
        )
        return float(motor.force(value, place, rate))

    return [
        {
            "t": float(t),
            **{name: float(values[row]) for name, values in columns.items()},
            **{name: acting(drive, float(t), row) for name, drive in drives.items()},
        }
        for row, t in enumerate(times)
    ]


class Stage:
    """Draws moments of a run into a figure, one after the other.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        An empty figure.
    run : Trajectory
        What happens.
    mechanism : Mechanism
        What it happens to.
    until : float
        Last time shown [s].
    scene : callable, optional
        How the mechanism is drawn, if not as `scene_of` says.
    narrow : bool
        Whether the scene stands above the time plots.
    digits : int
        Decimals of the time that is shown.
    """

    def __init__(
        self,
        figure: Figure,
        run: Trajectory,
        mechanism: Mechanism,
        *,
        until: float,
        scene: scenes.Scene | None = None,
        narrow: bool = False,
        digits: int = 3,
    ) -> None:
        first = run.span[0]
        looks = np.linspace(first, until, LOOKS)
        self.picture: scenes.Picture = (scene or scenes.scene_of(mechanism))(
            mechanism, run.at(looks)
        )
        self.digits = digits
        self.modes = {name: f"mode:{name}" for name in run.contacts} or {"": "mode"}
        shown = [self.picture.shapes(m) for m in moments_of(run, mechanism, looks)]
        whole = self._measured(shown)
        self.axes, panels = layout(figure, narrow=narrow, flat=whole.height < FLAT * whole.width)
        box = self.axes.get_window_extent()
        view = _padded(whole, box.height / box.width, ground=self.picture.metric)
        self.axes.set_xlim(view.left, view.right)
        self.axes.set_ylim(view.bottom, view.top)
        _ruler(self.axes, view, metric=self.picture.metric)
        self.cursors = _curves(panels, run, mechanism, until, narrow=narrow)
        write_legend(self.axes, self.picture, shown, self.scales)
        self.passing: list[Artist] = []
        self._title = self.axes.set_title("", fontsize=11.5, color=INK)

    def _measured(self, shown: Sequence[Sequence[scenes.Shape]]) -> scenes.Extent:
        """Return what is seen, and choose how long arrows are."""
        bare = [scenes.extent_of(shapes) for shapes in shown]
        everything = scenes.joined(bare)
        own = max(extent.width for extent in bare)
        self.follows = everything.width > FAR * own
        size = max(own if self.follows else everything.width / 2, everything.height)
        self.scales: scenes.Scales = scenes.scales_of(shown, size)
        whole = scenes.joined([scenes.extent_of(shapes, self.scales) for shapes in shown])
        if not self.follows:
            return whole
        middle = 0.5 * (bare[0].left + bare[0].right)
        return scenes.Extent(
            middle - FOLLOWED * own, middle + FOLLOWED * own, whole.bottom, whole.top
        )

    def show(self, moment: scenes.Moment) -> list[Artist]:
        """Draw a moment in place of the last one; return what moved, from back to front."""
        for artist in self.passing:
            artist.remove()
        shapes = self.picture.shapes(moment)
        if self.follows:
            low, high = self.axes.get_xlim()
            extent = scenes.extent_of(shapes)
            middle = 0.5 * (extent.left + extent.right)
            half = 0.5 * (high - low)
            self.axes.set_xlim(middle - half, middle + half)
        modes = {name: round(moment[column]) for name, column in self.modes.items()}
        self.passing = artists_of(self.axes, shapes, modes, self.scales)
        self._title.set_text(f"{moment['t']:.{self.digits}f} s, {_words(modes)}")
        moved: list[Artist] = [*self.passing, self._title]
        for cursor, dots in self.cursors:
            cursor.set_xdata([moment["t"], moment["t"]])
            moved.append(cursor)
            for dot, name, factor in dots:
                dot.set_data([moment["t"]], [factor * moment[name]])
                moved.append(dot)
        return [self.axes.xaxis, *moved] if self.follows else moved


def _words(modes: Mapping[str, int]) -> str:
    """Return what the contacts do, in words."""
    if len(modes) == 1:
        return WORDS[next(iter(modes.values()))]
    held = [name for name, mode in modes.items() if mode == 0]
    if not held:
        return "no contact sticks"
    if len(held) == len(modes):
        return "all contacts stick"
    return f"sticks: {', '.join(held)}" if len(held) <= NAMED else f"{len(held)} contacts stick"


Cursor = tuple[Line2D, list[tuple[Line2D, str, float]]]
"""The line at the present time, and dots on curves with the columns that they follow."""


def _curves(
    panels: Sequence[Axes], run: Trajectory, mechanism: Mechanism, until: float, *, narrow: bool
) -> list[Cursor]:
    """Draw place, velocity and friction against time; return their cursors."""
    seen = dense(run, until)
    slips = slipping(mechanism)
    unit = max((run.units[name] for name in slips), key=[run.units[n] for n in slips].count)
    places = [name for name in slips if run.units[name] == unit]
    rates = [mechanism.rates[mechanism.coordinates.index(name)] for name in places]
    shown = {"angle" if unit == "rad" else "displacement": places, "velocity": rates}
    if not run.contacts:
        shown["friction"] = ["friction"]
    lowest = min(axes.get_position().y0 for axes in panels)
    pixel = 72 / panels[0].get_figure(root=True).dpi  # type: ignore[union-attr]  # they have one
    found: list[Cursor] = []
    for axes, (title, names) in zip(panels, shown.items(), strict=False):
        factor, unit = scale_of(np.concatenate([seen[name] for name in names]), run.units[names[0]])
        dots = []
        for i, name in enumerate(names):
            colour = CURVES[i % len(CURVES)]
            axes.plot(seen.t, factor * seen[name], color=colour, linewidth=1.6)
            dots.append((axes.plot([], [], "o", color=colour, markersize=5)[0], name, factor))
        axes.set_ylabel(f"{names[0] if narrow and len(names) == 1 else title}, {unit}")
        axes.yaxis.set_label_coords(-48 / max(axes.get_window_extent().width * pixel, 1.0), 0.5)
        axes.locator_params(axis="y", nbins=4)
        axes.margins(x=0, y=0.12)
        axes.grid(axis="y")
        if not run.contacts:
            shade(axes, within(run.stick_spans(), until))
            shade(axes, _spans(seen, -1), colour=SLIP_BACK)
        found.append((axes.axvline(float(seen.t[0]), color=INK, linewidth=1.0), dots))
    if run.contacts:
        raster(panels[-1], seen, MODE_COLOURS)
        along = {place.name: name for place in mechanism.contacts() for name in place.slips}
        for label, contact in zip(panels[-1].get_yticklabels(), run.contacts, strict=True):
            if (name := along[contact]) in places:  # a key to the curves above
                label.set_color(CURVES[places.index(name) % len(CURVES)])
        found.append((panels[-1].axvline(float(seen.t[0]), color=INK, linewidth=1.0), []))
    lower = [axes for axes in panels if axes.get_position().y0 <= lowest]
    for axes in panels:
        axes.tick_params(labelbottom=axes in lower)
    key = "" if run.contacts else _key(run, seen, until)
    lower[len(lower) // 2].set_xlabel(f"time, s{key}")  # longer than a panel beside others is wide
    return found


def _key(run: Trajectory, seen: Trajectory, until: float) -> str:
    """Return what the colours behind the curves mean, of those that are there."""
    parts = ["yellow: stick"] if within(run.stick_spans(), until) else []
    parts += ["blue: slip back"] if _spans(seen, -1) else []
    return f" ({', '.join(parts)})" if parts else ""


def _spans(seen: Trajectory, mode: int) -> list[tuple[float, float]]:
    """Return the stretches of time in a mode, from dense samples."""
    here = seen["mode"] == mode
    return [
        (float(a), float(b))
        for a, b, place, other in zip(seen.t[:-1], seen.t[1:], here[:-1], here[1:], strict=True)
        if place and other
    ]


def _padded(whole: scenes.Extent, shape: float, *, ground: bool) -> scenes.Extent:
    """Return a view of the given height over width around a box, with a margin."""
    margin = 0.05 * max(whole.width, whole.height)
    width, height = whole.width + 2 * margin, whole.height + 2 * margin
    bottom = whole.bottom - margin
    middle = 0.5 * (whole.left + whole.right)
    if height < shape * width:
        spare = shape * width - height
        # what stands on the ground stands low in the picture
        bottom -= 0.35 * spare if ground else 0.5 * spare
        height = shape * width
    else:
        width = height / shape
    return scenes.Extent(middle - 0.5 * width, middle + 0.5 * width, bottom, bottom + height)


def _ruler(axes: Axes, view: scenes.Extent, *, metric: bool) -> None:
    """Write the scale below the scene, in the unit that suits it."""
    if not metric:
        axes.set_xticks([])
        return
    factor, unit = (1e3, "mm") if view.width < 1.0 else (1.0, "m")
    axes.xaxis.set_major_formatter(
        lambda x, _: f"{factor * x + 0.0:g}".replace("-", "\N{MINUS SIGN}")
    )
    axes.locator_params(axis="x", nbins=5)
    axes.spines["bottom"].set_visible(True)
    axes.annotate(
        f"places in {unit}",
        (1.0, 0.0),
        xycoords="axes fraction",
        xytext=(0, -52),
        textcoords="offset points",
        ha="right",
        va="center",
        color=MUTED,
        fontsize=11,
    )


# Animations of runs: frames as a GIF, an MP4, or inside HTML.

# Pictures one after the other as a GIF, by Pillow, or as an MP4, by ffmpeg.

PAPERS: Final = (theme.SURFACE, theme.STICK, theme.SLIP_BACK)
INKS: Final = (theme.INK, theme.MUTED, theme.C1, theme.C2, theme.C3, theme.C4)
SHADES: Final = 9
"""Steps from each paper to each ink, for smooth edges. One palette for all frames makes a GIF a
fraction of the size: only what changes is kept of a frame."""


class Encoder(Protocol):
    """Writes pictures (height, width, 3) into a file."""

    def write(self, pictures: Iterator[Any], path: Path, fps: float) -> None:
        """Write them all, so many a second."""


@dataclass(frozen=True)
class Gif:
    """GIF by Pillow; durations are hundredths of a second, kept right on the whole."""

    def write(self, pictures: Iterator[Any], path: Path, fps: float) -> None:
        """Write them all, so many a second."""
        path.write_bytes(gif_of(pictures, fps))


def gif_of(pictures: Iterator[Any], fps: float) -> bytes:
    """Return pictures (height, width, 3) as a GIF that repeats itself, empty if there are none.

    Examples
    --------
    >>> import numpy as np
    >>> white = np.full((2, 3, 3), 255, dtype=np.uint8)
    >>> gif_of(iter([white, 0 * white]), 25.0)[:6]
    b'GIF89a'
    """
    from PIL import Image

    palette = Image.new("P", (1, 1))
    palette.putpalette(bytes(_palette()))
    frames = [
        Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE)
        for picture in pictures
    ]
    if not frames:
        return b""
    ends = [round(100.0 * (i + 1) / fps) for i in range(len(frames))]
    lengths = [10 * (b - a) for a, b in zip([0, *ends], ends, strict=False)]
    buffer = io.BytesIO()
    frames[0].save(
        buffer,
        format="GIF",
        save_all=True,
        append_images=frames[1:],
        duration=lengths,
        loop=0,
        optimize=True,
        disposal=1,
    )
    return buffer.getvalue()


def _palette() -> list[int]:
    """Return the colours of the theme and those between each paper and each ink, flat."""
    pairs = [(_rgb(paper), _rgb(ink)) for paper in PAPERS for ink in INKS]
    found = {
        tuple(round(a + (b - a) * step / (SHADES - 1)) for a, b in zip(paper, ink, strict=True))
        for paper, ink in pairs
        for step in range(SHADES)
    }
    found.add(_rgb(theme.LINE))  # too pale for shades, which would be taken for paper
    return [level for colour in sorted(found, reverse=True) for level in colour]


def _rgb(colour: str) -> tuple[int, ...]:
    return tuple(int(colour[i : i + 2], 16) for i in (1, 3, 5))


@dataclass(frozen=True)
class Mp4:
    """H.264 by the program ffmpeg, which reads raw pictures."""

    def write(self, pictures: Iterator[Any], path: Path, fps: float) -> None:
        """Write them all, so many a second."""
        first = next(pictures, None)
        if first is None:
            return
        height, width = first.shape[:2]
        command = [
            ffmpeg(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
            "-s", f"{width}x{height}", "-r", f"{fps:g}", "-i", "-", "-an",
            # players want even sizes and this form of colours
            "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p",
            "-c:v", "libx264", "-movflags", "+faststart", str(path),
        ]  # fmt: skip
        with tempfile.TemporaryFile() as said:
            with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said) as process:
                try:
                    _feed(process, first, pictures)
                except BaseException:
                    process.kill()
                    raise
            if process.returncode:
                said.seek(0)
                words = said.read().decode(errors="replace").strip() or "no message"
                raise InputError(f"ffmpeg could not write {path.name}: {words}")


def _feed(process: "subprocess.Popen[bytes]", first: Any, rest: Iterator[Any]) -> None:
    """Hand pictures on as they are made; an ffmpeg that has given up says itself why."""
    with contextlib.suppress(BrokenPipeError), process.stdin as pipe:  # type: ignore[union-attr]  # it is a pipe
        for picture in itertools.chain((first,), rest):
            pipe.write(picture.tobytes())


def ffmpeg() -> str:
    """Return where ffmpeg is."""
    found = shutil.which("ffmpeg")
    if found is None:
        raise InputError(
            "an .mp4 file needs the program ffmpeg, which is not on the PATH; install it (such as"
            " `apt install ffmpeg`, `brew install ffmpeg`), or write a .gif file."
        )
    return found


ENCODERS: Final[MappingProxyType[str, Encoder]] = MappingProxyType({".gif": Gif(), ".mp4": Mp4()})
"""By the ending of the file."""


def encoder_of(path: Path) -> Encoder:
    """Return what writes a file of that name, or say why nothing does.

    Examples
    --------
    >>> encoder_of(Path("cart.gif"))
    Gif()
    """
    suffix = path.suffix.lower()
    if suffix not in ENCODERS:
        known = ", ".join(ENCODERS)
        raise InputError(f"an animation is written as one of {known}, got {path.name!r}.")
    if suffix == ".mp4":
        ffmpeg()  # before the frames are drawn
    return ENCODERS[suffix]


# Animations of runs: a scene to scale beside time plots, as GIF or MP4.

ANIMATION_SIZE: Final[Size] = (880, 400)
NARROWEST: Final = 620.0
"""Below this width the scene stands above the time plots [CSS px]."""
MOST_FRAMES: Final = 2000
FASTEST: Final = 50.0
"""Frames a second that browsers show of a GIF."""

Pixels: TypeAlias = NDArray[np.uint8]


def draw_scene(
    run: Trajectory, mechanism: Drawn, t: float, *, scene: Scene[Drawn] | None = None
) -> Draw:
    """Return a drawing of a mechanism at one moment of a run, beside its time plots.

    Parameters
    ----------
    run : Trajectory
        The run.
    mechanism : Mechanism
        What moves in it.
    t : float
        The moment [s].
    scene : callable, optional
        How it is drawn, if not as `stickslip.show.plots.scenes.scene_of` says.

    Returns
    -------
    callable
        Draws it, as `stickslip.show.plots.save` and `standalone_svg` take it.

    Raises
    ------
    InputError
        If an argument cannot be used, or the run is not one of the mechanism.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> from stickslip.show.plots import standalone_svg
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> "slip forward" in standalone_svg(draw_scene(run, rig, 0.1), size=(880, 400))
    True
    """
    theme.check_scene(run, mechanism, scene)
    theme.number("t", t)
    first, last = run.span
    if not first <= t <= last:
        raise InputError(f"t must lie between {first:g} and {last:g} s, got {t:g} s.")

    def draw(figure: Figure, narrow: bool) -> None:
        stage = Stage(figure, run, mechanism, until=last, scene=scene, narrow=narrow)
        stage.show(moments_of(run, mechanism, np.array([t]))[0])

    return draw


def picture_of(run: Trajectory, mechanism: Drawn, t: float, *, size: Size) -> Pixels:
    """Return what `draw_scene` draws as a picture (height, width, 3) in RGB."""
    theme.check_scene(run, mechanism)
    (pixels,) = frames(run, mechanism, np.array([t]), size=size, dpi=72.0, scene=None)
    return pixels


def animate(
    run: Trajectory,
    mechanism: Drawn,
    path: str | Path,
    *,
    fps: float = 25.0,
    speed: float = 1.0,
    until: float | None = None,
    size: Size = ANIMATION_SIZE,
    dpi: float = 72.0,
    scene: Scene[Drawn] | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Path | None:
    """Write an animation of a run as a GIF or MP4 file, chosen by the ending of its name.

    The mechanism is drawn to scale, the body that rubs in the colour of stick or slip, forces as
    arrows of one scale, beside displacement, velocity and friction with a cursor that moves.

    Parameters
    ----------
    run : Trajectory
        The run.
    mechanism : Mechanism
        What moves in it.
    path : str or Path
        The file; it appears whole or not at all, and replaces one that is there. MP4 needs the
        program ``ffmpeg``.
    fps : float
        Frames a second, at most 50 for a GIF.
    speed : float
        Seconds of the run in a second of the animation: 0.1 is slow motion.
    until : float, optional
        Last time shown [s]; if not given the end of the run, or some time after the body has
        arrived.
    size : tuple of float
        Width and height [CSS px]; below a width of 620 the scene stands above the time plots.
    dpi : float
        Resolution: 72 makes a pixel of each CSS pixel, 144 four.
    scene : callable, optional
        How the mechanism is drawn, if not as `stickslip.show.plots.scenes.scene_of` says.
    progress : callable, optional
        Called with the number of frames done and of all; if it returns False, nothing is written.

    Returns
    -------
    Path or None
        The file, None if it was cancelled.

    Raises
    ------
    InputError
        If an argument cannot be used, the run is not one of the mechanism, or there is no
        ``ffmpeg``.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=2.0, y0={"theta": 0.5})
    >>> path = animate(run, clock, "clock.gif", fps=5, size=(600, 520))  # doctest: +SKIP
    """
    theme.check_scene(run, mechanism, scene)
    path = theme.file_of(path)
    encoder = encoder_of(path)
    _check(encoder, fps=fps, size=size, dpi=dpi)
    times = frame_times(run, mechanism, fps=fps, speed=speed, until=until)
    done = 0

    def told() -> Iterator[Pixels]:
        nonlocal done
        for pixels in frames(run, mechanism, times, size=size, dpi=dpi, scene=scene):
            yield pixels
            done += 1
            if progress is not None and progress(done, len(times)) is False:
                return

    beside = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        encoder.write(told(), beside, fps)
        if done < len(times):
            return None
        beside.replace(path)
    except OSError as error:
        raise unwritable(path, error) from error
    finally:
        beside.unlink(missing_ok=True)
    return path


def frame_times(
    run: Trajectory, mechanism: Mechanism, *, fps: float, speed: float, until: float | None = None
) -> NDArray[np.float64]:
    """Return the times of the frames of an animation [s]: evenly spaced, the start among them.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=2.0, y0={"theta": 0.5})
    >>> frame_times(run, clock, fps=4.0, speed=0.5).size
    17
    """
    theme.check_scene(run, mechanism)
    theme.number("fps", fps)
    theme.number("speed", speed)
    first, last = run.span
    if until is not None:
        theme.number("until", until)
        if not first < until <= last:
            raise InputError(f"until must lie between {first:g} and {last:g} s, got {until:g} s.")
        last = until
    else:
        last = max(horizon(run, slip) for slip in slipping(mechanism))
    for name, unit, value in (("fps", "1/s", fps), ("speed", "1", speed)):
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"{name} [{unit}] must be above 0, got {value:g}.")
    count = math.floor((last - first) * fps / speed * (1.0 + 1e-12)) + 1
    if count > MOST_FRAMES:
        raise InputError(
            f"{count} frames are more than {MOST_FRAMES}: show less of the run by `until`, or raise"
            f" `speed` from {speed:g}, or lower `fps` from {fps:g}."
        )
    times: NDArray[np.float64] = np.minimum(first + np.arange(count) * speed / fps, last)
    return times


def frames(
    run: Trajectory,
    mechanism: Mechanism,
    times: NDArray[np.float64],
    *,
    size: Size,
    dpi: float,
    scene: Scene | None,
) -> Iterator[Pixels]:
    """Yield pictures (height, width, 3) of a run at some times."""
    with theme.house_style():
        figure = Figure(figsize=(size[0] / 72, size[1] / 72), dpi=dpi, layout="constrained")
        figure.set_facecolor(theme.SURFACE)
        canvas: Any = FigureCanvasAgg(figure)  # half of it has no types
        stage = Stage(
            figure,
            run,
            mechanism,
            until=float(times[-1]) if times.size > 1 else run.span[1],
            scene=scene,
            narrow=size[0] < NARROWEST,
            digits=_digits(times),
        )
    moments = moments_of(run, mechanism, times)
    background = None
    for moment in moments:
        with theme.house_style():  # not across a yield: others may draw in between
            moving = stage.show(moment)
            if background is None:
                # what does not move is drawn once, which makes frames several times cheaper
                for artist in moving:
                    artist.set_animated(True)
                canvas.draw()
                background = canvas.copy_from_bbox(figure.bbox)
            canvas.restore_region(background)
            for artist in moving:
                artist.set_animated(True)
                figure.draw_artist(artist)
            pixels = np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
        yield pixels


def _digits(times: NDArray[np.float64]) -> int:
    """Return decimals that tell neighbouring frames apart."""
    step = float(times[1] - times[0]) if times.size > 1 else 1.0
    return max(0, math.ceil(-math.log10(step) - 1e-9)) if step < 1.0 else 2


def _check(encoder: Encoder, *, fps: float, size: Size, dpi: float) -> None:
    theme.number("fps", fps)
    theme.number("dpi", dpi)
    theme.check_size(size)
    if encoder is ENCODERS[".gif"] and fps > FASTEST:
        raise InputError(
            f"a GIF shows at most {FASTEST:g} frames a second, got fps={fps:g}; write an .mp4."
        )
    if not (min(size) >= 200 and max(size) * dpi / 72 <= 8000):
        raise InputError(
            f"size must be at least 200 by 200 px and, times dpi / 72, at most 8000 px, got"
            f" {size[0]:g} by {size[1]:g} px at {dpi:g} dpi."
        )


# Animations inside HTML: a GIF of bounded size on screen, a still picture in print.

MOST_BYTES: Final = 1_500_000
"""Bytes of a GIF in a page, if nothing else is asked for."""
PHONE: Final = 620
"""Width of a window up to which the narrow animation is shown [CSS px]."""
SLOWEST: Final = 5.0
"""Frames a second below which a motion is no motion any more."""


def animation_html(
    run: Trajectory,
    mechanism: Drawn,
    *,
    alt: str,
    fps: float = 20.0,
    speed: float = 1.0,
    until: float | None = None,
    size: Size = ANIMATION_SIZE,
    narrow: Size | None = None,
    still: float | None = None,
    most_bytes: int = MOST_BYTES,
    scene: Scene[Drawn] | None = None,
) -> str:
    """Return an animation of a run as HTML that needs no other file.

    The GIF stands in the page itself. If it is larger than `most_bytes` it is made again with fewer
    frames a second, at least 5. In print, and for readers who ask for less motion, a still picture
    stands in its place.

    Parameters
    ----------
    run : Trajectory
        The run.
    mechanism : Mechanism
        What moves in it.
    alt : str
        What is to be seen, for readers who cannot see it.
    fps : float
        Frames per second of the animation, as in `animate` [1/s].
    speed : float
        Seconds of the run per second of the animation.
    until : float, optional
        Last time shown [s]; if not given, as in `animate`.
    size : tuple of float
        Width and height [CSS px].
    narrow : tuple of float, optional
        Width and height of a second GIF, which phones show: there the scene stands above the plots.
    still : float, optional
        Time of the still picture [s]; the middle of what is shown if not given.
    most_bytes : int
        Largest GIF of each size [bytes].
    scene : callable, optional
        How the mechanism is drawn, as in `animate`.

    Returns
    -------
    str
        One ``<figure>`` element.

    Raises
    ------
    InputError
        If the GIF is too large with 5 frames a second too, or an argument cannot be used.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=1.0, y0={"theta": 0.5})
    >>> page = animation_html(run, clock, alt="A pendulum swings", fps=5, size=(600, 520))
    >>> page[:7], "data:image/gif;base64," in page
    ('<figure', True)
    """
    if not alt.strip():
        raise InputError("an animation needs an `alt` text that says what it shows, got none.")

    def gif(shape: Size) -> bytes:
        rate = fps
        while True:
            times = frame_times(run, mechanism, fps=rate, speed=speed, until=until)
            pictures = frames(run, mechanism, times, size=shape, dpi=72.0, scene=scene)
            content = gif_of(pictures, rate)
            if len(content) <= most_bytes:
                return content
            if rate <= SLOWEST:
                raise InputError(
                    f"the animation has {len(content)} bytes with {rate:g} frames a second, more"
                    f" than most_bytes={most_bytes}: show less of the run by `until`, or raise"
                    " `speed`."
                )
            rate = max(SLOWEST, 0.8 * rate * most_bytes / len(content))

    content = gif(size)
    phone = None if narrow is None else gif(narrow)
    times = frame_times(run, mechanism, fps=fps, speed=speed, until=until)
    moment = float(np.median(times)) if still is None else still
    picture = standalone_svg(
        draw_scene(run, mechanism, moment, scene=scene), size=size, title=alt, narrow=size[0] < 620
    )
    return _figure(content, phone, picture, html.escape(alt, quote=True), size)


def _figure(gif: bytes, phone: bytes | None, still: str, alt: str, size: Size) -> str:
    moving, quiet = _data("gif", gif), _data("svg+xml", still.encode())
    small = ""
    if phone is not None:
        small = f'<source media="(max-width: {PHONE}px)" srcset="{_data("gif", phone)}">'
    return (
        '<figure class="animation"><picture>'
        f'<source media="print, (prefers-reduced-motion: reduce)" srcset="{quiet}">{small}'
        f'<img src="{moving}" alt="{alt}" width="{size[0]:g}" height="{size[1]:g}"'
        ' style="max-width:100%;height:auto">'
        "</picture></figure>"
    )


def _data(kind: str, content: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
