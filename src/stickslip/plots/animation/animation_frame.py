"""A scene beside time plots with a cursor: what a frame of an animation is made of."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from stickslip.drives import Drive
from stickslip.formatting import scale_of
from stickslip.mechanisms import Mechanism, driven_by_motor, motor_of, slipping
from stickslip.plots.animation.scenes.registry import scene_of
from stickslip.plots.animation.scenes.renderer import MODE_COLOURS, ROLE_COLOURS, artists_of
from stickslip.plots.animation.scenes.shapes import (
    Arrow,
    Extent,
    Moment,
    Picture,
    Role,
    Scales,
    Scene,
    Shape,
    Turn,
    extent_of,
    joined,
    nice,
    scales_of,
)
from stickslip.plots.core.helpers import dense
from stickslip.plots.core.modes import raster, within
from stickslip.plots.core.theme import C1, C2, C3, C4, INK, MUTED, SLIP_BACK, shade
from stickslip.trajectory import Trajectory

NAMES: Final[Mapping[Role, str]] = {
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
    axes: Axes, picture: Picture, shown: Sequence[Sequence[Shape]], scales: Scales
) -> None:
    """Say below a scene, whose limits are set, what its arrows are and how long they are."""
    kinds = {
        s.role: type(s)
        for shapes in shown
        for s in shapes
        if isinstance(s, (Arrow, Turn)) and _seen(s, scales)
    }
    names = {**NAMES, **(picture.names or {})}
    x = 0.0
    for role, colour in ROLE_COLOURS.items():
        if role in kinds:
            _write(axes, x, -34.0, names[role], colour)
            x += LETTER * (len(names[role]) + 2)
    x = 0.0
    if Arrow in kinds.values() and scales.metres:
        x = _bar(axes, scales)
    if Turn in kinds.values():
        _write(axes, x, -52.0, f"¼ of a turn is {scales.torque:.2g} N m", MUTED)


def _bar(axes: Axes, scales: Scales) -> float:
    """Draw the length of a round force; return where it ends [CSS px]."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    force = nice(0.25 * min(right - left, high - low) / scales.metres)
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


def _seen(shape: Arrow | Turn, scales: Scales) -> bool:
    return abs(shape.value) > (0.01 * scales.torque if isinstance(shape, Turn) else 0.0)


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
) -> list[Moment]:
    """Return the columns of a run, and its drives or the torque of its motor, at some times.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, simulate
    >>> from stickslip.drives import Sine
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
        scene: Scene | None = None,
        narrow: bool = False,
        digits: int = 3,
    ) -> None:
        first = run.span[0]
        looks = np.linspace(first, until, LOOKS)
        self.picture: Picture = (scene or scene_of(mechanism))(mechanism, run.at(looks))
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

    def _measured(self, shown: Sequence[Sequence[Shape]]) -> Extent:
        """Return what is seen, and choose how long arrows are."""
        bare = [extent_of(shapes) for shapes in shown]
        everything = joined(bare)
        own = max(extent.width for extent in bare)
        self.follows = everything.width > FAR * own
        size = max(own if self.follows else everything.width / 2, everything.height)
        self.scales: Scales = scales_of(shown, size)
        whole = joined([extent_of(shapes, self.scales) for shapes in shown])
        if not self.follows:
            return whole
        middle = 0.5 * (bare[0].left + bare[0].right)
        return Extent(middle - FOLLOWED * own, middle + FOLLOWED * own, whole.bottom, whole.top)

    def show(self, moment: Moment) -> list[Artist]:
        """Draw a moment in place of the last one; return what moved, from back to front."""
        for artist in self.passing:
            artist.remove()
        shapes = self.picture.shapes(moment)
        if self.follows:
            low, high = self.axes.get_xlim()
            extent = extent_of(shapes)
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
        along = {one.name: name for one in mechanism.contacts() for name in one.slips}
        for label, contact in zip(panels[-1].get_yticklabels(), run.contacts, strict=True):
            if (name := along[contact]) in places:  # a key to the curves above
                label.set_color(CURVES[places.index(name) % len(CURVES)])
        found.append((panels[-1].axvline(float(seen.t[0]), color=INK, linewidth=1.0), []))
    key = "" if run.contacts else _key(run, seen, until)
    for axes in panels:
        bottom = axes.get_position().y0 <= lowest
        axes.tick_params(labelbottom=bottom)
        if bottom:
            axes.set_xlabel(f"time, s{key}")
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
        for a, b, one, other in zip(seen.t[:-1], seen.t[1:], here[:-1], here[1:], strict=True)
        if one and other
    ]


def _padded(whole: Extent, shape: float, *, ground: bool) -> Extent:
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
    return Extent(middle - 0.5 * width, middle + 0.5 * width, bottom, bottom + height)


def _ruler(axes: Axes, view: Extent, *, metric: bool) -> None:
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
