"""Axes of every figure: drawings on those of users, samples, labels of curves, marks of modes.

A drawing is a function of a figure and of whether it is narrow. `plot_*` functions put it on axes
that a user gives, or on new ones; reports make SVG of it. Names stand beside their curves: at a
place inside the plot where no curve passes, or stacked where the curves end.
"""

import itertools
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final, NamedTuple, TypeAlias, TypedDict, cast

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from numpy.typing import NDArray

from stickslip.engine.trajectory import Event, Trajectory
from stickslip.errors import InputError, UnknownNameError
from stickslip.show.formatting import unit_text
from stickslip.show.plots import theme
from stickslip.show.plots.svg import Draw, Size

# Drawings on the user's axes: `plot_*` functions are drawings of this package put there.

Panels: TypeAlias = NDArray[np.object_]
"""Axes (n,) in the order of reading."""
Target: TypeAlias = Axes | Figure | SubFigure | None
"""Where a plot of one panel is drawn."""
PanelTarget: TypeAlias = Axes | Figure | SubFigure | Sequence[Axes] | Panels | None
"""Where a plot of several panels is drawn."""

PER_INCH: Final = 88
"""CSS pixels of a page per inch of a new figure: the widest ones are 10 inches."""
OVERHANG: Final = 1.15
"""Height of a label over that of its panel, up to which it keeps off its neighbours."""
LEAST_LABEL: Final = 6.0
"""Size of letters to which labels of very low panels shrink [pt]."""
NARROW_BELOW: Final = 500
"""Width of axes [CSS px] below which curves are named inside them."""


def name_panel(
    axes: Axes, x: str = "", y: str = "", room: tuple[float | None, float | None] = (None, None)
) -> None:
    """Name what a panel shows, rule it, and leave some shares of its width and height free."""
    axes.margins(x=room[0], y=room[1])
    if x:
        axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(axis="y")


def legend_above(axes: Axes, columns: int, *, small: bool = False) -> None:
    """Say above a panel what its colours mean."""
    axes.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, frameon=False,
        fontsize="small" if small else "medium",
    )  # fmt: skip


def on_panels(draw: Draw, ax: PanelTarget, size: Size) -> Panels:
    """Draw on given axes, into a given figure, or into a new figure of pyplot.

    Examples
    --------
    >>> figure = Figure()
    >>> upper, lower = figure.subplots(2)
    >>> draw = lambda figure, narrow: [axes.plot([0, 1]) for axes in figure.subplots(2)]
    >>> [*on_panels(draw, [upper, lower], (880, 300))] == [upper, lower]
    True
    """
    if ax is None:
        from matplotlib import pyplot as plt

        # loads the backend: that of a notebook sets that figures are shown after each cell, which
        # would be taken back with the style
        plt.draw_if_interactive()  # type: ignore[no-untyped-call]  # of matplotlib
        settings = mpl.rcParams  # the user's: the house style counts in CSS pixels
        dpi, inches = settings["figure.dpi"], tuple(settings["figure.figsize"])
        if inches == tuple(mpl.rcParamsDefault["figure.figsize"]):
            # A size that the user has set stays.
            inches = (size[0] / PER_INCH, size[1] / PER_INCH)
        width = 72 * inches[0]
        with theme.readers_style(width) as own:
            paper = own.get("figure.facecolor", theme.SURFACE)
            new = plt.figure(figsize=inches, dpi=dpi, layout="constrained", facecolor=paper)
            try:
                panels = _drawn(draw, new, None, narrow=width < NARROW_BELOW)
                new.draw_without_rendering()  # makes the ticks, in this style
                theme.restyle(new.findobj(), own)
                _fit_labels(panels)
            except BaseException:
                plt.close(new)
                raise
        return panels
    figure: Figure | SubFigure
    given: list[Axes] | None
    if isinstance(ax, Figure | SubFigure):
        figure, given, width = ax, None, ax.bbox.width
    else:
        given = _axes_of(ax)
        figure = cast("Figure", given[0].get_figure(root=True))
        width = min(axes.get_window_extent().width for axes in given)
    # What was on the axes before is the user's, and keeps its style.
    before = {artist for axes in given or () for artist in axes.findobj()}
    points = width * 72 / figure.dpi
    with theme.readers_style(points if given is None else None) as own:
        panels = _drawn(draw, figure, given, narrow=points < NARROW_BELOW)
        after = {artist for panel in (*panels, *figure.legends) for artist in panel.findobj()}
        theme.restyle(after - before, own)
        return panels


def on_axes(draw: Draw, ax: PanelTarget, size: Size) -> Axes:
    """Draw what has a single panel, as `on_panels` does.

    Examples
    --------
    >>> axes = Figure().add_subplot()
    >>> on_axes(lambda figure, narrow: figure.add_subplot().plot([0, 1]), axes, (9, 3)) is axes
    True
    """
    (axes,) = on_panels(draw, ax, size)
    return cast("Axes", axes)


def panel_grid(figure: Figure, count: int, columns: int, **layout: Any) -> list[Axes]:
    """Return so many panels in rows, in the order of reading; what the last row lacks is hidden."""
    # The number of rows is rounded up.
    grid = figure.subplots(-(-count // columns), columns, squeeze=False, **layout)
    panels = list(grid.flat)
    for axes in panels[count:]:
        axes.set_visible(False)
    return panels[:count]


def _axes_of(ax: object) -> list[Axes]:
    """Return the axes that were given, in one list."""
    result = [ax] if isinstance(ax, Axes) else list(np.ravel(np.asarray(ax, dtype=object)))
    if not result or not all(isinstance(panel, Axes) for panel in result):
        raise InputError(
            "ax must be matplotlib Axes, a sequence of Axes for several panels, or a Figure, got"
            f" {ax!r}."
        )
    axes = cast("list[Axes]", result)
    if any(panel.get_figure(root=True) is None for panel in axes):
        raise InputError("ax was removed from its figure; give axes that belong to one.")
    return axes


def _drawn(
    draw: Draw, figure: Figure | SubFigure, given: list[Axes] | None, *, narrow: bool
) -> Panels:
    stage = _Stage(figure, given)
    draw(cast("Figure", stage), narrow)
    if given is not None and len(stage.panels) != len(given):
        raise _miscounted(len(stage.panels), len(given))
    shown = [axes for axes in stage.panels if axes.get_visible()]
    panels = np.empty(len(shown), dtype=object)
    panels[:] = shown
    return panels


def _fit_labels(panels: Panels) -> None:
    """Break and shrink labels of vertical axes that are longer than their panels."""
    for axes in panels:
        label = axes.yaxis.label
        room = OVERHANG * axes.get_window_extent().height
        # Broken first: a smaller font is the last resort.
        if label.get_window_extent().height > room:
            label.set_text(label.get_text().replace(", ", ",\n", 1))
        longest = label.get_window_extent().height
        if longest > room:
            label.set_fontsize(max(label.get_fontsize() * room / longest, LEAST_LABEL))


def _miscounted(wanted: int, got: int) -> InputError:
    what = "one Axes" if wanted == 1 else f"a sequence of {wanted} Axes"
    panels = "1 panel" if wanted == 1 else f"{wanted} panels"
    return InputError(f"this plot has {panels}: ax must be {what} or a Figure, got {got} Axes.")


class _Stage:
    """Stands in for the figure of a drawing: gives out the axes of the user, or new ones.

    Drawings ask a figure for axes and for little else; what else they ask goes to the figure that
    the axes are in.
    """

    def __init__(self, figure: Figure | SubFigure, given: list[Axes] | None) -> None:
        self.figure = figure
        self.given = given
        self.panels: list[Axes] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self.figure, name)

    def add_subplot(self, *place: Any, **layout: Any) -> Axes:
        """Return the next panel."""
        if self.given is None:
            self.panels.append(self.figure.add_subplot(*place, **layout))
        else:
            count = len(self.panels) + 1
            if count > len(self.given):
                raise _miscounted(count, len(self.given))
            self.panels.append(self.given[count - 1])
        return self.panels[-1]

    def subplots(
        self, rows: int = 1, columns: int = 1, *, squeeze: bool = True, **layout: Any
    ) -> Any:
        """Return a grid of panels; there must be as many as were given."""
        if self.given is None:
            grid = self.figure.subplots(rows, columns, squeeze=False, **layout)
        else:
            grid = np.empty((rows, columns), dtype=object)
            grid.flat[:] = self._all(rows * columns)
        self.panels += grid.flat
        if not squeeze:
            return grid
        return grid.item() if grid.size == 1 else grid.squeeze()

    def subplot_mosaic(self, mosaic: str, **layout: Any) -> dict[str, Axes]:
        """Return panels by letter, those of the mosaic in the order of reading."""
        if self.given is None:
            result = self.figure.subplot_mosaic(mosaic, **layout)
        else:
            letters = list(dict.fromkeys(letter for letter in mosaic if letter != ";"))
            result = dict(zip(letters, self._all(len(letters)), strict=True))
        self.panels += result.values()
        return result

    def _all(self, count: int) -> list[Axes]:
        given = self.given or []
        if len(given) != count:
            raise _miscounted(count, len(given))
        return given


# What the figures of runs share: sizes, dense samples, a fitting end of time, colours.

Array: TypeAlias = NDArray[np.float64]

RIVALS: Final = (theme.C2, theme.C3, theme.C4, theme.INK, theme.MUTED)
DASHES: Final = ("-", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)))
SETTLED: Final = 0.01
"""Share of its largest excursion within which a body counts as having arrived."""
SAMPLES: Final = 700
MOST_STEPS: Final = 20_000
"""Steps of a run up to which jumps are looked for at each."""
JUMP: Final = 1e-3
"""Share of its largest size by which a force jumps, or more."""
LINE_POINTS: Final = 1200
"""Points of a line: more cannot be seen in a figure of 880 px."""


def labelled(name: str, unit: str) -> str:
    """Return the label of an axis: what it shows in words, with its unit if it has one.

    Examples
    --------
    >>> labelled("friction.stribeck_velocity", "m/s"), labelled("v", "m/s"), labelled("share", "1")
    ('stribeck velocity, m/s', 'v, m/s', 'share')
    """
    word, shown = name.rpartition(".")[2].replace("_", " "), unit_text(unit)
    return f"{word}, {shown}" if shown else word


class Sizes(TypedDict):
    """The two sizes of a figure, as `stickslip.show.plots.inline_svg` takes them."""

    wide: Size
    narrow: Size


class LineStyle(NamedTuple):
    """How one series is drawn."""

    colour: str
    """Colour of the line."""
    dashes: str | tuple[int, tuple[float, ...]]
    """Dash pattern, as matplotlib takes it."""
    width: float
    """Line width [CSS px]."""
    order: int
    """Drawing order; the largest is on top."""


def looks(names: Iterable[str], chosen: str | None = None) -> dict[str, LineStyle]:
    """Return how each series is drawn: the chosen one blue and broad, the others thin upon it.

    So curves that coincide are both seen.

    Examples
    --------
    >>> looks(["Dahl", "Coulomb"], "Coulomb")["Coulomb"].width
    3.0
    """
    names = list(names)
    chosen = names[0] if chosen is None and names else chosen
    result = {}
    rivals = [name for name in names if name != chosen]
    for index, name in enumerate(rivals):
        lap, place = divmod(index, len(RIVALS))
        result[name] = LineStyle(RIVALS[place], DASHES[lap % len(DASHES)], 1.4, 3)
    return {name: result.get(name, LineStyle(theme.C1, "-", 3.0, 2)) for name in names}


def dense(run: Trajectory, until: float | None = None, samples: int = SAMPLES) -> Trajectory:
    """Return a run at times close enough for a smooth curve, its events among them."""
    first, last = run.span
    last = last if until is None else min(until, last)
    events = [event.t for event in run.events if event.t <= last]
    # Also just before an event: friction jumps there, and the jump must be upright.
    before = [max(math.nextafter(t, -math.inf), first) for t in events]
    steps = _jumps(run, first, last)
    times = np.union1d(np.linspace(first, last, samples), [*before, *events, *steps])
    return run.at(times)


def _jumps(run: Trajectory, first: float, last: float) -> Array:
    """Return the solver's times at which a contact force jumps, and those just before.

    So it does where a drive or a swing steps, without an event.
    """
    after = run.t[(run.t > first) & (run.t <= last)]
    if not after.size or after.size > MOST_STEPS:
        return np.empty(0)
    # Just before each end of a step: forces may differ from those at the end.
    before = np.nextafter(after, -np.inf)
    now, then = run.at(after), run.at(before)
    apart = np.zeros(after.size, dtype=np.bool_)
    for force in ("friction", "normal_force"):
        if force in run.names:
            # Never 0: a force that is 0 throughout does not jump.
            size = max(float(np.abs(now[force]).max()), 1e-300)
            apart |= np.abs(now[force] - then[force]) > JUMP * size
    return np.concatenate([before[apart], after[apart]])


def horizon(run: Trajectory, slip: str = "x") -> float:
    """Return the time [s] up to which a figure shows a run: until it has arrived, and some more."""
    first, last = run.span
    # Closely, and at the steps, so that no excursion is missed.
    seen = run.at(np.union1d(np.linspace(first, last, 4000), run.t[run.t <= last]))
    x = seen[slip]
    far = np.abs(x - x[-1]) > SETTLED * max(float(np.ptp(x)), 1e-300)
    if not far.any():
        return last
    arrived = float(seen.t[np.flatnonzero(far)[-1]]) - first
    stops = [e.t for e in run.events if abs(e.to_mode) != 1 and e.t >= first + arrived]
    # The stop is shown, unless it is the end of a decay that one cannot see.
    arrived = max([arrived, *[stop - first for stop in stops[:1] if stop < 1.5 * arrived]])
    return min(first + 1.3 * arrived, last)


def thinned(t: Array, y: Array, most: int = LINE_POINTS) -> tuple[Array, Array]:
    """Return a line with fewer points: the least and the largest of each stretch of it.

    Examples
    --------
    >>> t = np.arange(10_000.0)
    >>> len(thinned(t, np.sin(t))[0]) <= 1200
    True
    """
    if len(t) <= most:
        return t, y
    kept = []
    # Two points from each stretch: half as many stretches as points.
    edges = np.linspace(0, len(t), most // 2 + 1).astype(int)
    for first, last in itertools.pairwise(edges.tolist()):
        kept += sorted(
            {first + int(np.argmin(y[first:last])), first + int(np.argmax(y[first:last]))}
        )
    return t[kept], y[kept]


def coordinate_name(run: Trajectory, name: str | None = None) -> str:
    """Return the column that a plot shows: the one given, ``"x"``, or the first of the run."""
    if name is not None and name not in run.names:
        raise UnknownNameError("column", name, run.names)
    known = run.states or run.names
    return name or ("x" if "x" in known else known[0])


def motion_names(run: Trajectory, slip: str | None, rate: str | None) -> tuple[str, str]:
    """Return the names of the coordinate and the rate that a plot shows, those given or the first.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=1.0, y0={"theta": 0.5})
    >>> motion_names(run, None, None)
    ('theta', 'omega')
    """
    slip = coordinate_name(run, slip)
    if rate is not None:
        return slip, coordinate_name(run, rate)
    unit = f"{run.units.get(slip, 'm')}/s"
    rates = [name for name in run.states or run.names if run.units.get(name) == unit]
    if not rates:
        raise InputError(f"no column of the run is the rate of {slip!r}: give its name as rate.")
    return slip, "v" if "v" in rates else rates[0]


def grouped(
    values: Mapping[str, float | Array], apart: float
) -> list[tuple[float, tuple[str, ...]]]:
    """Return the names of series that are nowhere `apart`, with the end of the first of them.

    Examples
    --------
    >>> grouped({"Coulomb": 0.450, "viscous": 0.300, "Dahl": 0.451}, 0.01)
    [(0.45, ('Coulomb', 'Dahl')), (0.3, ('viscous',))]
    """
    groups: list[tuple[Array, list[str]]] = []
    for name, value in values.items():
        series = np.atleast_1d(value)
        gaps = [float(np.max(np.abs(first - series))) for first, _ in groups]
        # The nearest group, where a series is near several.
        if gaps and min(gaps) < apart:
            groups[int(np.argmin(gaps))][1].append(name)
        else:
            groups.append((series, [name]))
    ends = [(float(series[-1]), tuple(names)) for series, names in groups]
    return sorted(ends, key=lambda group: -group[0])


def wrapped(names: Sequence[str], width: int) -> list[str]:
    """Return names joined by commas, in lines of at most `width` characters where they allow it.

    Examples
    --------
    >>> wrapped(["Coulomb", "Dahl", "LuGre"], 14)
    ['Coulomb, Dahl,', 'LuGre']
    """
    lines: list[str] = []
    for index, name in enumerate(names):
        part = name + ("," if index < len(names) - 1 else "")
        if lines and len(lines[-1]) + 1 + len(part) <= width:
            lines[-1] += f" {part}"
        else:
            lines.append(part)
    return lines


# Names beside curves: found a free place inside the plot, or stacked where the curves end.

LETTER: Final = 5.5
"""Mean width of a letter at 11 px [CSS px]; measured text would differ between machines."""
WIDEST: Final = 6.5
"""That of names with many wide letters, which then keep off what stands beside them."""
HALF_LINE: Final = 7.0
AWAY: Final = (11.0, 17.0, 25.0, 36.0)
"""Distances of a name from its curve that are tried [CSS px]."""
BESIDE: Final = 8.0
"""Distance of a name from its curve where it stands at its side [CSS px]."""
DOT: Final = 4.0
"""Half the size of a point with its surroundings [CSS px]."""
PLACES: Final = 36
"""Places along each curve that are tried."""
CROSSED: Final = 1e3
OUTSIDE: Final = 1e5


class Curve(NamedTuple):
    """A drawn curve and the name it wants; a curve without a name only stands in the way."""

    x: Array
    """Horizontal coordinates (n,), in the units of the axes."""
    y: Array
    """Vertical coordinates (n,), likewise."""
    text: str
    """Name to write beside the curve; empty if it has none."""
    colour: str
    """Colour of the name."""


class _Box(NamedTuple):
    left: float
    bottom: float
    right: float
    top: float

    def overlap(self, other: "_Box") -> float:
        """Return the shared area."""
        width = min(self.right, other.right) - max(self.left, other.left)
        height = min(self.top, other.top) - max(self.bottom, other.bottom)
        return max(width, 0.0) * max(height, 0.0)


def label_curves(axes: Axes, curves: Sequence[Curve], *, points: Array | None = None) -> None:
    """Write the name of each curve above or below it, where it is free and clearly meant.

    Names keep off points (n, 2) too. Set the limits of the axes before.
    """
    figure = axes.get_figure(root=True)
    if figure is None:
        return
    theme.lay_out(figure)
    pixel = theme.pixel_of(figure)
    frame = _Box(*(float(edge) * pixel for edge in axes.get_window_extent().extents))
    frame = frame._replace(left=frame.left + BESIDE)  # names do not stand on the axis
    # Without finite points in the frame there is nothing to hide.
    drawn = [(curve, _in_pixels(axes, curve, pixel)) for curve in curves]
    drawn = [(curve, path) for curve, path in drawn if len(path)]  # others hide nothing
    paths = [path for _, path in drawn]
    taken = [
        _Box(*(float(edge) * pixel for edge in text.get_window_extent().extents))
        for text in axes.texts
    ]
    if points is not None:
        dots = axes.transData.transform(points) * pixel
        taken += [_Box(x - DOT, y - DOT, x + DOT, y + DOT) for x, y in dots.tolist()]
    for index, (curve, _) in enumerate(drawn):
        if not curve.text:
            continue
        half = WIDEST * _letters(curve.text) / 2
        tries = [
            (_cost(box, taken, paths, index, frame) + far, anchor, rank, box)
            for anchor in np.linspace(frame.left + 4, frame.right - 4, PLACES)
            for rank, (dx, dy, far) in enumerate(_shifts(half))
            for box in [_box(paths[index], float(anchor), dx, dy, half)]
        ]
        # Cheapest place; of equal ones the leftmost, then the nearest.
        box = min(tries, key=lambda results: results[:3])[3]
        taken.append(box._replace(left=box.left - BESIDE / 2, right=box.right + BESIDE / 2))
        x, y = axes.transData.inverted().transform(
            ((box.left + box.right) / 2 / pixel, (box.bottom + box.top) / 2 / pixel)
        )
        name = theme.label_at(axes, float(x), float(y), curve.text, curve.colour, offset=(0, 0),
                        align="center")  # fmt: skip
        name.set_in_layout(False)  # its place was found in the layout that is


def label_ends(
    axes: Axes,
    x: float,
    labels: Sequence[tuple[float, Sequence[str], str]],
) -> None:
    """Name curves where they end; a name may have several lines."""
    # Equal heights keep their order from below, so the last line goes first.
    rows = [(y, line, colour) for y, lines, colour in labels for line in reversed(lines)]
    theme.label_column(axes, x, rows)


def _letters(text: str) -> int:
    r"""Count what is seen of a text; in mathtext a command is a letter, or only sets others.

    >>> _letters(r"A, $\mu_{\mathrm{k}}$ = 0.243")
    13
    """
    if "$" not in text:
        return len(text)
    letters = re.sub(r"\\[a-z]+", "x", re.sub(r"\\math[a-z]+", "", text))
    return len(re.sub(r"[${}_]", "", letters))


def _in_pixels(axes: Axes, curve: Curve, pixel: float) -> Array:
    points = axes.transData.transform(np.column_stack([curve.x, curve.y])) * pixel
    return np.asarray(points[np.isfinite(points).all(axis=1)])


def _height(path: Array, x: float) -> float:
    return float(np.interp(x, path[:, 0], path[:, 1]))


def _shifts(half: float) -> list[tuple[float, float, float]]:
    """Return the shifts of a name from a point of its curve, each with its price."""
    # Above first, then below, and further off only at its price.
    upright = [(0.0, side * away, away) for away in AWAY for side in (1.0, -1.0)]
    beside = [(side * (half + BESIDE), 0.0, AWAY[1]) for side in (-1.0, 1.0)]
    return upright + beside


def _box(path: Array, x: float, dx: float, dy: float, half: float) -> _Box:
    """Return the place of a name shifted from a point of its curve."""
    y = _height(path, x) + dy
    return _Box(x + dx - half, y - HALF_LINE, x + dx + half, y + HALF_LINE)


def _cost(box: _Box, taken: Sequence[_Box], paths: Sequence[Array], own: int, frame: _Box) -> float:
    cost = 0.0
    if box.left < frame.left or box.right > frame.right:
        cost += OUTSIDE
    if box.bottom < frame.bottom or box.top > frame.top + 2 * HALF_LINE:
        cost += OUTSIDE
    cost += CROSSED * sum(box.overlap(other) for other in taken)
    middle = (box.bottom + box.top) / 2
    # Its neighbours too: a name beside a steep curve is near it only at one end.
    columns = np.linspace(box.left - BESIDE, box.right + BESIDE, 17)
    own_heights = np.interp(columns, paths[own][:, 0], paths[own][:, 1])
    reach = float(np.min(np.abs(own_heights - middle)))
    for index, path in enumerate(paths):
        heights = np.interp(columns, path[:, 0], path[:, 1])
        inner = heights[1:-1]
        # Between two columns a steep curve may run through the whole name.
        highest, lowest = np.maximum(inner[1:], inner[:-1]), np.minimum(inner[1:], inner[:-1])
        cost += CROSSED * int(np.sum((highest > box.bottom - 1) & (lowest < box.top + 1)))
        if index != own:
            # A name is read as that of the nearest curve, so no other may be as near.
            distance = float(np.min(np.abs(heights - middle)))
            cost += 40.0 * max(0.0, 2.2 * max(reach, AWAY[0]) - distance)
    return cost


# What a figure of a run says about its modes and events: words, markers, a raster of contacts.

MOST_NAMED: Final = 4


def within(spans: Sequence[tuple[float, float]], last: float) -> list[tuple[float, float]]:
    """Return the spans up to a time."""
    return [(low, min(high, last)) for low, high in spans if low < last]


def name_modes(axes: Axes, run: Trajectory, last: float) -> None:
    """Write "stick" and "slip" once, each in the longest stretch of its mode."""
    sticks = within(run.stick_spans(), last)
    if not sticks:
        return
    bounds = [run.span[0], *[end for span in sticks for end in span], last]
    slips = list(zip(bounds[::2], bounds[1::2], strict=True))
    for word, spans in (("stick", sticks), ("slip", slips)):
        low, high = max(spans, key=lambda span: span[1] - span[0])
        if high - low > 0.05 * (last - run.span[0]):
            axes.annotate(
                word,
                ((low + high) / 2, 1.03),
                xycoords=axes.get_xaxis_transform(),
                ha="center",
                va="bottom",
                color=theme.MUTED,
                fontsize=theme.name_size(),
            )


def name_events(axes: Axes, events: Sequence[Event], narrow: bool) -> None:
    """Say in words what each kind of event is, above the panel and at the first of its kind."""
    first = {event.reason: event for event in reversed(events)}
    if not first or len(first) > MOST_NAMED:
        return
    low, high = axes.get_xlim()
    letter = LETTER * (high - low) / (280 if narrow else 800)
    free_from = low
    for reason, event in sorted(first.items(), key=lambda item: item[1].t):
        width = letter * (len(reason) + 2)
        fits = event.t + width < high
        start = event.t if fits else event.t - width
        if start < free_from:
            continue
        free_from = start + width
        axes.axvline(event.t, color=theme.MUTED, linewidth=0.8, linestyle=(0, (2, 2)), zorder=1)
        axes.annotate(
            reason,
            (event.t, 1.03),
            xycoords=axes.get_xaxis_transform(),
            ha="left" if fits else "right",
            va="bottom",
            color=theme.INK,
            fontsize=theme.name_size(),
        )


def raster(axes: Axes, seen: Trajectory, colours: Mapping[int, str]) -> None:
    """Draw a row for each contact: when it slips, sticks, or is open."""
    edges = np.append(seen.t, seen.t[-1])
    rows = np.arange(len(seen.contacts) + 1)
    modes = np.array([np.rint(seen[f"mode:{name}"]) for name in seen.contacts])
    for row, own in enumerate(modes):
        begins = np.flatnonzero(np.append(True, own[1:] != own[:-1]))
        ends = np.append(begins[1:], own.size)
        for mode, colour in colours.items():
            spans = [
                (float(edges[i]), float(edges[k] - edges[i]))
                for i, k in zip(begins, ends, strict=True)
                if own[i] == mode
            ]
            axes.broken_barh(spans, (row, 1.0), facecolor=colour, linewidth=0.0)
    axes.set_xlim(float(edges[0]), float(edges[-1]))
    axes.set_ylim(0.0, float(rows[-1]))
    axes.set_yticks(rows[:-1] + 0.5, seen.contacts, fontsize="x-small")
    axes.invert_yaxis()
