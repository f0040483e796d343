"""A frame of an animation: a scene painted to scale, beside time plots with a cursor."""

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Rectangle
from matplotlib.text import Text

from stickslip.engine.trajectory import UNLOADED, Trajectory
from stickslip.mechanisms import Mechanism, driven_by_motor, motor_of, slipping
from stickslip.mechanisms.drives import Drive
from stickslip.show.formatting import scale_of
from stickslip.show.plots.animation import scenes
from stickslip.show.plots.axes import dense, raster, within
from stickslip.show.plots.theme import C1, C2, C3, C4, INK, MUTED, SLIP_BACK, STICK, SURFACE, shade

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
