"""Animations of runs by matplotlib's writers: a scene to scale beside time plots with a cursor.

What does not move is drawn once and becomes a picture behind the frames, so that a writer, which
draws the figure anew for each frame, draws that picture and what moves.
"""

import base64
import html
import math
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, TypeAlias

import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Rectangle
from matplotlib.text import Text
from matplotlib.transforms import ScaledTranslation, Transform
from mpl_toolkits.axes_grid1.anchored_artists import AnchoredSizeBar
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError
from stickslip.mechanisms import Mechanism, driven_by_motor, motor_of, slipping
from stickslip.mechanisms.drives import Drive
from stickslip.show.documents import unwritable
from stickslip.show.formatting import scale_of
from stickslip.show.plots import scenes, theme
from stickslip.show.plots.axes import dense, horizon, raster, within
from stickslip.show.plots.scenes import MODE_COLOURS, Drawn, Scene
from stickslip.show.plots.svg import Draw, Size, standalone_svg
from stickslip.show.plots.theme import C1, C2, C3, C4, INK, MUTED, SLIP_BACK, SURFACE, shade

# Paints shapes with matplotlib, in the colours of the theme.

Pixels: TypeAlias = NDArray[np.uint8]
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
    result: list[Artist] = []
    for order, shape in enumerate(shapes):
        for artist in _PAINTERS[type(shape)](shape, brush):
            # forces are seen whatever stands before them
            front = 60 if isinstance(shape, (scenes.Arrow, scenes.Turn)) else 0
            artist.set_zorder(3 + 0.5 * order + front)
            axes.add_artist(artist)
            result.append(artist)
    return sorted(result, key=lambda artist: artist.get_zorder())


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
    result: list[Artist] = [
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
        result.append(strip)
    return result


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
    return [_pointing((x, y), (x + length * dx, y + length * dy), shape.role)]


def _pointing(start: scenes.Point, end: scenes.Point, role: scenes.Role) -> FancyArrowPatch:
    """Return an arrow from one point to another."""
    return FancyArrowPatch(
        start, end, arrowstyle="-|>", mutation_scale=10, shrinkA=0, shrinkB=0,
        color=ROLE_COLOURS[role], linewidth=2.0,
    )  # fmt: skip


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
    tail, point = ((x + r * math.cos(at), y + r * math.sin(at)) for at in (tip, ahead))
    return [arc, _pointing(tail, point, shape.role)]


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
LOOKS: Final = 121
"""Times at which is looked how much room a scene takes."""
FAR: Final = 4.0
"""Travel over the mechanism's own width from which the view follows it."""
FLAT: Final = 0.42
"""Height over width of a scene below which it stands above the time plots, not beside them."""
BAR, KEY = 22.0, 44.0
"""Distance of the bar of a force, and of what arrows are, from the axes above them [CSS px]."""
LOW: Final = 380.0
"""Height below which time plots have no room for words beside them [CSS px]."""
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


class Painted:
    """Shapes of a mechanism, painted moment after moment.

    Parameters
    ----------
    picture : stickslip.show.plots.scenes.Picture
        How the run is drawn.
    moments : sequence of mapping
        Moments all over the run, for the room that it takes.
    """

    def __init__(self, picture: scenes.Picture, moments: Sequence[scenes.Moment]) -> None:
        self.picture = picture
        self._shown = shown = [picture.shapes(moment) for moment in moments]
        self._passing: list[Artist] = []
        bare = [scenes.extent_of(shapes) for shapes in shown]
        everything = scenes.joined(bare)
        wide = max(extent.width for extent in bare)
        self.follows = everything.width > FAR * wide
        size = max(wide if self.follows else everything.width / 2, everything.height)
        self.scales: scenes.Scales = scenes.scales_of(shown, size)
        whole = scenes.joined([scenes.extent_of(shapes, self.scales) for shapes in shown])
        if self.follows:
            middle = 0.5 * (bare[0].left + bare[0].right)
            whole = scenes.Extent(middle - wide, middle + wide, whole.bottom, whole.top)
        self.whole = whole

    def explain(self, axes: Axes, *, narrow: bool) -> None:
        """Say below a scene what its arrows are, and its unit of length."""
        kinds = {
            s.role: type(s)
            for shapes in self._shown
            for s in shapes
            if isinstance(s, (scenes.Arrow, scenes.Turn)) and _seen(s, self.scales)
        }
        names = {**NAMES, **(self.picture.names or {})}
        turn = f" (¼ of a turn: {self.scales.torque:.2g} N m)"
        keys = [
            Line2D([], [], color=ROLE_COLOURS[role], linewidth=2.0,
                   label=names[role] + (turn if kinds[role] is scenes.Turn else ""))
            for role in ROLE_COLOURS
            if role in kinds
        ]  # fmt: skip
        if keys:
            axes.legend(
                handles=keys, loc="upper left", bbox_to_anchor=(0.0, 0.0),
                bbox_transform=_below(axes, KEY), borderaxespad=0.0,
                ncols=1 if narrow else len(keys), frameon=False, handlelength=0.9,
                columnspacing=1.0, handletextpad=0.4, borderpad=0.0, fontsize=11,
            )  # fmt: skip
        axes.set_yticks([])
        axes.spines["bottom"].set_visible(True)
        factor, unit = (1e3, "mm") if self.whole.width < 1.0 else (1.0, "m")
        axes.set_xlabel(f"places in {unit}", loc="right", color=MUTED)
        axes.xaxis.set_major_formatter(
            lambda x, _: f"{factor * x + 0.0:g}".replace("-", "\N{MINUS SIGN}")
        )
        axes.locator_params(axis="x", nbins=5)

    def place(self, axes: Axes) -> None:
        """Set the limits of axes that have their place, and draw the length of a round force."""
        box = axes.get_window_extent()
        view = _padded(self.whole, box.height / box.width)
        axes.set(xlim=(view.left, view.right), ylim=(view.bottom, view.top))
        if not self.scales.metres:
            return
        force = scenes.nice(0.5 * min(view.width, view.height) / self.scales.metres)
        bar = AnchoredSizeBar(
            axes.transData, force * self.scales.metres, f"{force:g} N", "upper left",
            bbox_to_anchor=(0.0, 0.0), bbox_transform=_below(axes, BAR), borderpad=0.0, pad=0.0,
            sep=3, frameon=False, color=INK,
        )  # fmt: skip
        bar.set_gid("force-scale")
        axes.add_artist(bar)

    def update(self, axes: Axes, now: scenes.Moment, modes: Mapping[str, int]) -> list[Artist]:
        """Paint a moment in place of the last one; return what moved, from back to front."""
        for artist in self._passing:
            artist.remove()
        shapes = self.picture.shapes(now)
        if self.follows:
            low, high = axes.get_xlim()
            extent = scenes.extent_of(shapes)
            middle = 0.5 * (extent.left + extent.right)
            axes.set_xlim(middle - 0.5 * (high - low), middle + 0.5 * (high - low))
        self._passing = artists_of(axes, shapes, modes, self.scales)
        return [axes.xaxis, *self._passing] if self.follows else [*self._passing]


def _below(axes: Axes, points: float) -> Transform:
    """Return fractions of axes, moved down."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    return axes.transAxes + ScaledTranslation(0.0, -points / 72.0, figure.dpi_scale_trans)


def _seen(shape: scenes.Arrow | scenes.Turn, scales: scenes.Scales) -> bool:
    return abs(shape.value) > (0.01 * scales.torque if isinstance(shape, scenes.Turn) else 0.0)


def _padded(whole: scenes.Extent, shape: float) -> scenes.Extent:
    """Return a view of the given height over width around a box, with a margin."""
    margin = 0.05 * max(whole.width, whole.height)
    width, height = whole.width + 2 * margin, whole.height + 2 * margin
    bottom = whole.bottom - margin
    middle = 0.5 * (whole.left + whole.right)
    if height < shape * width:
        bottom -= 0.35 * (shape * width - height)  # what stands on the ground stands low
        height = shape * width
    else:
        width = height / shape
    return scenes.Extent(middle - 0.5 * width, middle + 0.5 * width, bottom, bottom + height)


def layout(figure: Figure, *, narrow: bool, flat: bool) -> tuple[Axes, list[Axes]]:
    """Return the axes of the scene and of three time plots: beside each other, or above."""
    names = ["place", "rate", "friction"]
    figure.set_layout_engine("constrained", w_pad=0.1, h_pad=0.06)
    if narrow:
        rows = [["scene"], *([name] for name in names)]
        heights, widths = [3.0, 1.0, 1.0, 1.0], [1.0]
    elif flat:
        rows = [["scene"] * 3, names]
        heights, widths = [1.3, 1.0], [1.0] * 3
    else:
        rows = [["scene", name] for name in names]
        heights, widths = [1.0] * 3, [1.15, 1.0]
    mosaic: Any = rows  # the stubs want a protocol that lists of lists do not meet
    result = figure.subplot_mosaic(mosaic, width_ratios=widths, height_ratios=heights)
    scene, *plots = (result[name] for name in ("scene", *names))
    scene.spines[:].set_visible(False)
    for plot in plots[1:]:
        plot.sharex(plots[0])
    return scene, plots


class Still(Artist):
    """A picture of the size of its figure, which lies behind all else.

    `Figure.figimage` would resample it for each frame.
    """

    zorder = -1.0

    def __init__(self, pixels: Pixels) -> None:
        super().__init__()
        self._pixels = np.ascontiguousarray(pixels[::-1])

    @override
    def draw(self, renderer: RendererBase) -> None:
        """Copy the picture into the figure."""
        context = renderer.new_gc()
        renderer.draw_image(context, 0.0, 0.0, self._pixels)
        context.restore()


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
        scene: Scene | None = None,
        narrow: bool = False,
        digits: int = 3,
    ) -> None:
        looks = np.linspace(run.span[0], until, LOOKS)
        seen = run.at(looks)
        result = scene or scenes.scene_of(mechanism)
        self.painted: Painted | None = None
        flat = False
        if result is None:
            picture = scenes.PICTURES[mechanism.name](mechanism, seen)
            self.painted = Painted(picture, moments_of(run, mechanism, looks))
            flat = self.painted.whole.height < FLAT * self.painted.whole.width
        self.figure, self.digits = figure, digits
        self.modes = {name: f"mode:{name}" for name in run.contacts} or {"": "mode"}
        self.axes, panels = layout(figure, narrow=narrow, flat=flat)
        self._title = self.axes.set_title("0 s", y=1.0, fontsize=11.5, color=INK)
        short = narrow or 72.0 * figure.get_figheight() < LOW
        self.cursors = _curves(panels, run, mechanism, until, short=short)
        if self.painted is not None:
            self.painted.explain(self.axes, narrow=narrow)
        self._update = None if result is None else result(self.axes, mechanism, seen)
        figure.align_ylabels(panels)
        figure.draw_without_rendering()  # finds places, which stay from here on
        figure.set_layout_engine("none")
        if self.painted is not None:
            self.painted.place(self.axes)

    def show(self, moment: scenes.Moment) -> list[Artist]:
        """Draw a moment in place of the last one; return what moved, from back to front."""
        modes = {name: round(moment[column]) for name, column in self.modes.items()}
        if self._update is not None:
            moved = [*self._update(moment)]
        else:
            assert self.painted is not None
            moved = self.painted.update(self.axes, moment, modes)
        self._title.set_text(f"{moment['t']:.{self.digits}f} s, {_words(modes)}")
        moved.append(self._title)
        for cursor, dots in self.cursors:
            cursor.set_xdata([moment["t"], moment["t"]])
            moved.append(cursor)
            for dot, name, factor in dots:
                dot.set_data([moment["t"]], [factor * moment[name]])
                moved.append(dot)
        return moved

    def settle(self, moved: Sequence[Artist]) -> None:
        """Put a picture of all that has not moved in its place, so that frames are drawn fast."""
        for artist in moved:
            artist.set_visible(False)
        canvas: Any = FigureCanvasAgg(self.figure)  # half of it has no types
        canvas.draw()
        still = Still(np.array(canvas.buffer_rgba()))
        for parent in (self.figure, *self.figure.axes):
            for artist in parent.get_children():
                if artist not in self.figure.axes and artist is not self.figure.patch:
                    artist.set_visible(False)
        for artist in moved:
            artist.set_visible(True)
        self.figure.add_artist(still)


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
    panels: Sequence[Axes], run: Trajectory, mechanism: Mechanism, until: float, *, short: bool
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
    result: list[Cursor] = []
    for axes, (title, names) in zip(panels, shown.items(), strict=False):
        factor, unit = scale_of(np.concatenate([seen[name] for name in names]), run.units[names[0]])
        dots = []
        for i, name in enumerate(names):
            colour = CURVES[i % len(CURVES)]
            axes.plot(seen.t, factor * seen[name], color=colour, linewidth=1.6)
            dots.append((axes.plot([], [], "o", color=colour, markersize=5)[0], name, factor))
        axes.set_ylabel(f"{names[0] if short and len(names) == 1 else title}, {unit}")
        axes.locator_params(axis="y", nbins=4)
        axes.margins(x=0, y=0.12)
        axes.grid(axis="y")
        if not run.contacts:
            shade(axes, within(run.stick_spans(), until))
            shade(axes, _spans(seen, -1), colour=SLIP_BACK)
        result.append((axes.axvline(float(seen.t[0]), color=INK, linewidth=1.0), dots))
    if run.contacts:
        raster(panels[-1], seen, MODE_COLOURS)
        along = {place.name: name for place in mechanism.contacts() for name in place.slips}
        for label, contact in zip(panels[-1].get_yticklabels(), run.contacts, strict=True):
            if (name := along[contact]) in places:  # a key to the curves above
                label.set_color(CURVES[places.index(name) % len(CURVES)])
        result.append((panels[-1].axvline(float(seen.t[0]), color=INK, linewidth=1.0), []))
    below = [bool((spec := axes.get_subplotspec()) and spec.is_last_row()) for axes in panels]
    for axes, last in zip(panels, below, strict=True):
        axes.tick_params(labelbottom=last)
    text = f"time, s{'' if run.contacts else _key(run, seen, until)}"
    if all(below):
        panels[0].get_figure(root=True).supxlabel(text, fontsize=11)  # type: ignore[union-attr]  # they have one
    else:
        panels[-1].set_xlabel(text)
    return result


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


# Frames of runs, by matplotlib's writers: GIF by Pillow, MP4 by the program ffmpeg.

ANIMATION_SIZE: Final[Size] = (880, 400)
NARROWEST: Final = 620.0
"""Below this width the scene stands above the time plots [CSS px]."""
MOST_FRAMES: Final = 2000
FASTEST: Final = 50.0
"""Frames a second that browsers show of a GIF."""
CENTISECONDS: Final = 100.0
"""Units in a second in which a GIF counts how long a frame stands [1/s]."""


class GifWriter(PillowWriter):
    """Matplotlib's writer of GIFs, with one palette for all frames.

    So only what changes is kept of a frame, which makes a file a fraction of the size.
    """

    @override
    def finish(self) -> None:
        """Write the frames that there are."""
        from PIL import Image

        frames: list[Any] = self._frames  # type: ignore[has-type]  # the stubs leave it out
        if not frames:
            return
        some: Any = Image.fromarray(np.vstack(frames[:: max(1, len(frames) // COLOURED)]))
        counts = sorted(some.getcolors(some.width * some.height), reverse=True)
        kept = np.zeros((0, 3), dtype=np.int64)
        for _, colour in counts:
            # areas keep their colours, shades of edges next to these go
            if len(kept) < 256 and (np.abs(kept - colour).max(axis=1) >= ALIKE).all():
                kept = np.vstack([kept, colour])
        palette = Image.new("P", (1, 1))
        palette.putpalette(kept.ravel().tolist())
        plain = Image.Dither.NONE
        self._frames = [frame.quantize(palette=palette, dither=plain) for frame in frames]
        super().finish()


COLOURED: Final = 8
"""Frames, spread over an animation, of which the colours of all are taken."""
ALIKE: Final = 8
"""Levels of red, green or blue below which Pillow may take a colour for its neighbour."""


def frame_rate(path: Path, fps: float) -> float:
    """Return how many frames a second a file of that name has, or say why nothing writes it.

    A GIF counts in hundredths of a second how long a frame stands.

    Examples
    --------
    >>> frame_rate(Path("cart.gif"), 25.0), round(frame_rate(Path("cart.gif"), 30.0), 3)
    (25.0, 33.333)
    """
    suffix = path.suffix.lower()
    if suffix not in {".gif", ".mp4"}:
        raise InputError(f"an animation is written as one of .gif, .mp4, got {path.name!r}.")
    if suffix == ".mp4" and not FFMpegWriter.isAvailable():
        raise InputError(
            "an .mp4 file needs the program ffmpeg, which is not on the PATH; install it (such as"
            " `apt install ffmpeg`, `brew install ffmpeg`), or write a .gif file."
        )
    theme.number("fps", fps)
    if fps <= 0:
        raise InputError(f"fps [1/s] must be above 0, got {fps:g}.")
    if suffix == ".mp4":
        return fps
    if fps > FASTEST:
        raise InputError(
            f"a GIF shows at most {FASTEST:g} frames a second, got fps={fps:g}; write an .mp4."
        )
    return CENTISECONDS / round(CENTISECONDS / fps)


def _writer(path: Path, fps: float) -> AbstractMovieWriter:
    if path.suffix.lower() == ".gif":
        # the writer cuts off parts of a millisecond, of which rounding may leave nearly a whole
        return GifWriter(fps=fps * (1.0 - 1e-9))  # type: ignore[arg-type]  # any real number does
    return FFMpegWriter(fps=fps, codec="h264", extra_args=["-movflags", "+faststart"])  # type: ignore[arg-type]


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
        Draws it with matplotlib, as `stickslip.show.plots.scenes.Scene` says.

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
        Frames a second; a GIF has the nearest of 50, 33.3, 25, 20, ..., and no more.
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
        Draws the mechanism with matplotlib, as `stickslip.show.plots.scenes.Scene` says.
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
    fps = frame_rate(path, fps)
    _check(size=size, dpi=dpi)
    times = frame_times(run, mechanism, fps=fps, speed=speed, until=until)
    beside = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        complete = _write(
            run, mechanism, beside, times, fps=fps, size=size, dpi=dpi, scene=scene,
            progress=progress,
        )  # fmt: skip
        if not complete:
            return None
        beside.replace(path)
    except OSError as error:
        raise unwritable(path, error) from error
    finally:
        beside.unlink(missing_ok=True)
    return path


def _write(
    run: Trajectory,
    mechanism: Drawn,
    path: Path,
    times: NDArray[np.float64],
    *,
    fps: float,
    size: Size,
    dpi: float,
    scene: Scene[Drawn] | None,
    progress: Callable[[int, int], object] | None = None,
) -> bool:
    """Write frames at some times into a file; return whether they all are in it."""
    writer = _writer(path, fps)
    try:
        with theme.house_style():
            stage = _stage(run, mechanism, times, size=size, dpi=dpi, scene=scene)
            with writer.saving(stage.figure, str(path), dpi):
                for done, moment in enumerate(moments_of(run, mechanism, times), 1):
                    moved = stage.show(moment)
                    if done == 1:
                        stage.settle(moved)
                    writer.grab_frame()
                    if progress is not None and progress(done, len(times)) is False:
                        return done == len(times)
    except (subprocess.CalledProcessError, BrokenPipeError) as error:
        words = (getattr(error, "stderr", "") or "").strip() or "no message"
        raise InputError(f"ffmpeg could not write {path.name}: {words}") from error
    return True


def _stage(
    run: Trajectory,
    mechanism: Drawn,
    times: NDArray[np.float64],
    *,
    size: Size,
    dpi: float,
    scene: Scene[Drawn] | None,
) -> Stage:
    figure = Figure(figsize=(size[0] / 72, size[1] / 72), dpi=dpi, facecolor=theme.SURFACE)
    return Stage(
        figure,
        run,
        mechanism,
        until=float(times[-1]) if times.size > 1 else run.span[1],
        scene=scene,
        narrow=size[0] < NARROWEST,
        digits=_digits(times),
    )


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


def _digits(times: NDArray[np.float64]) -> int:
    """Return decimals that tell neighbouring frames apart."""
    step = float(times[1] - times[0]) if times.size > 1 else 1.0
    return max(0, math.ceil(-math.log10(step) - 1e-9)) if step < 1.0 else 2


def _check(*, size: Size, dpi: float) -> None:
    theme.number("dpi", dpi)
    theme.check_size(size)
    if not (min(size) >= 200 and max(size) * dpi / 72 <= 8000):
        raise InputError(
            f"size must be at least 200 by 200 px and, times dpi / 72, at most 8000 px, got"
            f" {size[0]:g} by {size[1]:g} px at {dpi:g} dpi."
        )


# Animations inside HTML: a GIF of bounded size on screen, a still picture in print.

GIF: Final = Path("run.gif")
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
        rate = frame_rate(GIF, fps)
        while True:
            times = frame_times(run, mechanism, fps=rate, speed=speed, until=until)
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / GIF
                _write(run, mechanism, path, times, fps=rate, size=shape, dpi=72.0, scene=scene)
                content = path.read_bytes()
            if len(content) <= most_bytes:
                return content
            if rate <= SLOWEST:
                raise InputError(
                    f"the animation has {len(content)} bytes with {rate:g} frames a second, more"
                    f" than most_bytes={most_bytes}: show less of the run by `until`, or raise"
                    " `speed`."
                )
            rate = frame_rate(GIF, max(SLOWEST, 0.8 * rate * most_bytes / len(content)))

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
