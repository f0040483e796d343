"""Figures of measurements and rigs: records, overviews, sketches of the rig."""

from collections.abc import Callable, Sequence
from types import MappingProxyType
from typing import Final, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.patches import Arc, Rectangle

from stickslip import data
from stickslip.show.formatting import scale_of
from stickslip.show.plots import scenes, theme
from stickslip.show.plots.animations import artists_of
from stickslip.show.plots.axes import Array, Panels, PanelTarget, name_panel, on_panels
from stickslip.show.plots.svg import Draw, Size, inline_svg

# A record in time: what was measured, one panel below the other.

PANEL: Final = 90
"""Height of a panel [CSS px]."""


# A measured record at a glance: signals, speeds, and force against velocity.

MOST_SIGNALS: Final = 5
MOST_NAMED: Final = 6
"""Trials at most whose curves have a name each."""
BINS: Final = 1200
"""Stretches of time of which smallest and largest value are drawn."""
SPEEDS: Final = 60
CELLS: Final = (90, 60)
EDGE: Final = 0.0005
"""Share of samples at either end that a histogram leaves out, or one outlier would squeeze it."""
SHORT: Final = {"spring_force": "spring"}


def overview_size(record: data.Measurement) -> Size:
    """Return the size of the overview of a record, wide enough for a page [CSS px].

    Examples
    --------
    >>> from stickslip import Measurement
    >>> overview_size(Measurement(time=[0, 1, 2], position=[0, 1, 2]))
    (880, 460)
    """
    return (880, 130 * len(_signals(record)) + (330 if _has_velocity(record) else 70))


def draw_overview(record: data.Measurement) -> Draw:
    """Return a drawing of a record as it was measured.

    Examples
    --------
    >>> from stickslip import Measurement
    >>> time = np.arange(500) / 100
    >>> record = Measurement(time=time, position=np.sin(time), force=np.cos(time))
    >>> figure = Figure()
    >>> draw_overview(record)(figure, False)
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['position, m', 'force, N', 'samples, %', 'force, N']
    """
    names = _signals(record)
    velocity, speeds = _velocity(record), record.unit("velocity")
    forces = [name for name in ("friction", "force", "spring_force") if _sampled(record, name)]

    def draw(figure: Figure, _narrow: bool) -> None:
        below = velocity is not None
        heights = [1.0] * len(names) + [1.8] * below
        grid = GridSpec(len(heights), 2, figure=figure, height_ratios=heights)
        first: Axes | None = None
        for row, name in enumerate(names):
            first = figure.add_subplot(grid[row, :], sharex=first)
            _series(first, record, name)
            first.tick_params(labelbottom=row == len(names) - 1)
        if first is not None:
            first.set_xlabel("time, s")
        if velocity is None:
            return
        left = figure.add_subplot(grid[-1, 0] if forces else grid[-1, :])
        _histogram(left, velocity, speeds)
        if forces:
            right = figure.add_subplot(grid[-1, 1])
            _density(right, (velocity, speeds), record, forces[0])
        figure.align_ylabels()

    return draw


def plot_measurement(measurement: data.Measurement, ax: PanelTarget = None) -> Panels:
    """Draw a measurement as it was made.

    Parameters
    ----------
    measurement : Measurement
        Records in time, friction maps or travels; all trials are drawn over each other.
    ax : sequence of Axes, Figure or SubFigure, optional
        Where. A new figure if not given.

    Returns
    -------
    array of Axes (n,)
        A panel for each signal against time; friction against velocity; or the travels of the
        trials, with their stated uncertainties.

    Raises
    ------
    InputError
        If `measurement` or `ax` is of another kind.

    Examples
    --------
    >>> from stickslip import Measurement
    >>> time = np.arange(500) / 100
    >>> record = Measurement(time=time, position=np.sin(time), force=np.cos(time))
    >>> [axes.get_ylabel() for axes in plot_measurement(record, Figure())]
    ['position, m', 'force, N']
    """
    theme.check_type("measurement", measurement, data.Measurement)
    records = measurement.records()
    series = measurement.kind == "series"
    names = [
        name
        for name in measurement.quantities()
        if series
        and any(np.ndim(record.values(name)) for record in records if name in record.quantities())
    ]

    def draw(figure: Figure, _narrow: bool) -> None:
        if series:
            panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
            for axes, name in zip(panels, names, strict=True):
                _overlay(axes, measurement, name)
            panels[-1].set_xlabel("time, s")
            figure.align_ylabels()
        elif measurement.kind == "friction-map":
            _map(figure.add_subplot(), measurement)
        else:
            _travels(figure.add_subplot(), measurement)

    return on_panels(draw, ax, (880, 110 * len(names) + 60 if series else 320))


def _colour(place: int, records: Sequence[data.Measurement]) -> str:
    return theme.DATA if len(records) == 1 else f"C{place % 10}"


def _overlay(axes: Axes, measurement: data.Measurement, name: str) -> None:
    """Draw a signal of all trials that have it."""
    records = measurement.records()
    all_values = np.concatenate([np.ravel(r.values(name)) for r in records if _has(r, name)])
    factor, unit = scale_of(all_values, measurement.unit(name))
    for place, record in enumerate(records):
        if _has(record, name) and record.time is not None:
            time, values = _envelope(
                np.asarray(record.time), factor * np.asarray(record.values(name))
            )
            axes.plot(time, values, color=_colour(place, records), linewidth=1.0)
    quantity, _, joint = name.partition(".")
    name_panel(axes, y=(f"{joint}\n" if joint else "") + _label(quantity, unit), room=(0, 0.08))


def _has(record: data.Measurement, name: str) -> bool:
    return name in record.quantities() and np.ndim(record.values(name)) > 0


def _map(axes: Axes, measurement: data.Measurement) -> None:
    """Draw friction against velocity, a point for each row."""
    records = measurement.records()
    for place, record in enumerate(records):
        v, f = record.values("velocity"), record.values("friction")
        label = record.name or f"trial {place + 1}"
        axes.plot(v, f, ".", color=_colour(place, records), markersize=4.0, label=label)
    if 1 < len(records) <= MOST_NAMED:
        axes.legend(frameon=False)
    name_panel(
        axes,
        x=_label("velocity", measurement.unit("velocity")),
        y=_label("friction", measurement.unit("friction")),
    )


def _travels(axes: Axes, measurement: data.Measurement) -> None:
    """Draw the numbers of each trial beside each other, with their uncertainties."""
    name = measurement.travelled or measurement.quantities()[0]
    records = [trial for trial in measurement.records() if name in trial.quantities()]
    values = [np.ravel(trial.values(name)) for trial in records]
    factor, unit = scale_of(np.concatenate(values), measurement.unit(name))
    for place, (record, value) in enumerate(zip(records, values, strict=True), 1):
        doubt = factor * record.uncertainty.get(name, 0.0)
        axes.errorbar(
            np.full(value.size, place),
            factor * value,
            yerr=doubt if np.any(doubt) else None,
            fmt="o",
            color=theme.DATA,
            markersize=5.0,
            capsize=4.0,
        )
    axes.set_xticks(
        range(1, len(records) + 1), [trial.name or f"{n}" for n, trial in enumerate(records, 1)]
    )
    axes.set_xlim(0.4, len(records) + 0.6)
    name_panel(axes, x="trial", y=_label(name, unit), room=(None, 0.15))


def _sampled(record: data.Measurement, name: str) -> bool:
    return isinstance(getattr(record, name), np.ndarray)


def _signals(record: data.Measurement) -> Sequence[str]:
    if record.time is None:
        return ()
    return [name for name in data.QUANTITIES if _sampled(record, name)][:MOST_SIGNALS]


def _has_velocity(record: data.Measurement) -> bool:
    return _sampled(record, "velocity") or (
        record.time is not None and _sampled(record, "position")
    )


def _velocity(record: data.Measurement) -> Array | None:
    if not _has_velocity(record):
        return None
    if record.time is None:
        return np.asarray(record.values("velocity"))
    return data.velocity_of(record)


def _label(name: str, unit: str) -> str:
    return f"{name.replace('_', ' ')}, {unit}"


def _series(axes: Axes, record: data.Measurement, name: str) -> None:
    """Draw a signal; where there are more samples than pixels, their extremes."""
    time, values = np.asarray(record.time), np.asarray(record.values(name))
    factor, unit = scale_of(
        values - (values.mean() if name == "position" else 0.0), record.unit(name)
    )
    shown_time, shown = _envelope(time, factor * values)
    axes.plot(shown_time, shown, color=theme.DATA, linewidth=1.0)
    steps = np.diff(time)
    late = np.flatnonzero(steps > data.GAP * data.interval_of(time))
    theme.shade(axes, [(time[i], time[i + 1]) for i in late[:200]], colour=theme.STICK)
    name_panel(axes, y=_label(name, unit), room=(0, 0.08))


def _envelope(time: Array, values: Array) -> tuple[Array, Array]:
    if values.size <= 4 * BINS:
        return time, values
    size = values.size // BINS
    cut = size * BINS
    rows = values[:cut].reshape(BINS, size)
    # In the order of time, so that no line runs back.
    at = np.sort(np.stack([rows.argmin(axis=1), rows.argmax(axis=1)], axis=1), axis=1)
    kept = np.append((at + size * np.arange(BINS)[:, None]).ravel(), np.arange(cut, values.size))
    return time[kept], values[kept]


def _middle(values: Array) -> tuple[float, float]:
    """Return the range of nearly all values, and some more."""
    low, high = (float(np.quantile(values, share)) for share in (EDGE, 1 - EDGE))
    edge = 0.03 * (high - low) or 1.0
    return low - edge, high + edge


def _histogram(axes: Axes, velocity: Array, speeds: str) -> None:
    factor, unit = scale_of(velocity, speeds)
    low, high = _middle(factor * velocity)
    counts, edges = np.histogram(factor * velocity, bins=SPEEDS, range=(low, high))
    axes.stairs(100 * counts / velocity.size, edges, fill=True, color=theme.SLIP_BACK)
    axes.stairs(100 * counts / velocity.size, edges, color=theme.DATA, linewidth=1.0)
    name_panel(axes, x=f"velocity, {unit}", y="samples, %", room=(0, None))


def _density(axes: Axes, moved: tuple[Array, str], record: data.Measurement, name: str) -> None:
    """Draw how often force and velocity meet, on a scale of powers of ten."""
    velocity, speeds = moved
    force = np.asarray(record.values(name))
    factor, unit = scale_of(velocity, speeds)
    across, up = _middle(factor * velocity), _middle(force)
    counts, _, _ = np.histogram2d(factor * velocity, force, bins=CELLS, range=(across, up))
    seen = np.ma.masked_equal(counts.T, 0)
    axes.imshow(
        np.log1p(seen),
        cmap=_shades(),
        vmin=0.0,
        extent=(*across, *up),
        origin="lower",
        aspect="auto",
        interpolation="nearest",
        zorder=2,
    )
    axes.axvline(0.0, color=theme.MUTED, linewidth=0.8, zorder=1)
    axes.axhline(0.0, color=theme.MUTED, linewidth=0.8, zorder=1)
    axes.set_xlim(*across)
    axes.set_ylim(*up)
    axes.set_xlabel(f"velocity, {unit}")
    axes.set_ylabel(_label(name, record.unit(name)))


def _shades() -> ListedColormap:
    """Return colours from that of a band to that of the darkest data."""
    pale, dark = np.array(to_rgb(theme.SLIP_BACK)), np.array(to_rgb(theme.C1))
    share = np.linspace(0.1, 1.0, 64)[:, None]
    return ListedColormap([*map(tuple, pale + share * (dark - pale))])


# Sketches of the rig in its three readings, and schematics of rig and cart with their symbols.
# Places are CSS px, upwards from the ground.

SKETCH_SIZE: Final[Size] = (250, 84)
SCHEMATIC_SIZE: Final[Size] = (358, 220)
BELOW: Final = MappingProxyType({SKETCH_SIZE: 14, SCHEMATIC_SIZE: 40})
"""Room below the ground."""
BLOCK: Final = (40.0, 44.0)
AS_DRAWN: Final = scenes.Scales(metres=1.0, torque=1.0)
"""Arrows are as long as their values."""


def _on_ground(figure: Figure, size: Size, shapes: Sequence[scenes.Shape]) -> Axes:
    """Return axes with shapes on the ground."""
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_xlim(0, size[0])
    axes.set_ylim(-BELOW[size], size[1] - BELOW[size])
    axes.set_axis_off()
    artists_of(axes, [scenes.Ground(), *shapes], {}, AS_DRAWN)
    return axes


def draw_sketch(kind: str, *, mass: str = "1 kg", force: str = "10 N") -> Draw:
    """Return a drawing of a rig."""
    left, shapes = _BODIES[kind](force)
    width, height = BLOCK
    block = scenes.Box(left=left, bottom=0.0, width=width, height=height)
    name = scenes.Word(at=(left + 0.5 * width, 0.5 * height - 4.0), text=mass, align="center")

    def draw(figure: Figure, _narrow: bool) -> None:
        _on_ground(figure, SKETCH_SIZE, [*shapes, block, name])

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


Body: TypeAlias = tuple[float, list[scenes.Shape]]
"""Left side of the block, and what acts on it."""


def _pushed(force: str) -> Body:
    push = scenes.Arrow(at=(38.0, 22.0), along=(1.0, 0.0), value=50.0, role="friction")
    return 90.0, [push, scenes.Word(at=(38.0, 32.0), text=force)]


def _spring(
    wall: float, top: float, end: float, middle: float, radius: float
) -> list[scenes.Shape]:
    return [
        scenes.Wall(start=(wall, 0.0), end=(wall, top)),
        scenes.Coil(start=(wall, middle), end=(end, middle), radius=radius, turns=5),
    ]


def _released(_force: str) -> Body:
    speed = ((14.0, 194.0), (22.0, 204.0), (30.0, 194.0))
    lines = [scenes.Rod(points=((160.0, y), (end, y)), width=1.0) for y, end in speed]
    return 112.0, [*_spring(14.0, 50.0, 82.0, 24.0, 7.0), *lines]


def _fixed(_force: str) -> Body:
    joint = scenes.Ball(centre=(105.0, 24.0), radius=3.0, fill="solid")
    return 108.0, [*_spring(14.0, 50.0, 104.0, 24.0, 7.0), joint]


_BODIES: Final = MappingProxyType[str, Callable[[str], Body]](
    {"push": _pushed, "released-spring": _released, "fixed-spring": _fixed}
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
    return inline_svg(
        lambda figure, _narrow: body(figure),
        alt=alt,
        prefix=prefix,
        wide=SCHEMATIC_SIZE,
        narrow=None,
    )


def _cart(figure: Figure) -> None:
    pivot, ball = (150.0, 48.0), (84.0, 142.0)
    shapes: list[scenes.Shape] = [
        scenes.Box(left=94.0, bottom=0.0, width=112.0, height=48.0),
        scenes.Rod(points=(pivot, ball), width=1.8),
        scenes.Ball(centre=ball, radius=14.0, fill="solid"),
        scenes.Ball(centre=pivot, radius=4.0),
        scenes.Turn(centre=pivot, radius=31.0, value=1.0, role="drive"),
    ]
    axes = _on_ground(figure, SCHEMATIC_SIZE, shapes)
    axes.plot([150, 150], [48, 150], color=theme.MUTED, linewidth=0.9, linestyle=(0, (5, 4)))
    axes.add_patch(Arc(pivot, 130, 130, theta1=90, theta2=125, color=theme.MUTED, linewidth=1.1))
    for x, y, name, colour in (
        (128, 122, "θ", theme.INK),
        (104, 92, "l", theme.INK),
        (60, 146, "m", theme.INK),
        (150, 22, "M", theme.INK),
        (108, 58, "τ", theme.C4),
        (60, 12, "μ", theme.INK),
        (294, 74, "x", theme.C1),
        (66, -24, theme.symbol_label("F_f"), theme.C2),
        (234, 28, "N", theme.INK),
    ):
        _text(axes, x, y, name, colour)
    _arrow(axes, (264, 60), (324, 60), theme.C1)
    _arrow(axes, (88, -10), (44, -10), theme.C2)
    _arrow(axes, (222, 0), (222, 48), theme.MUTED)


def _rig(figure: Figure) -> None:
    block = scenes.Box(left=110.0, bottom=0.0, width=58.0, height=56.0)
    axes = _on_ground(figure, SCHEMATIC_SIZE, [*_spring(30.0, 84.0, 110.0, 28.0, 10.0), block])
    axes.add_patch(
        Rectangle(
            (266, 0),
            58,
            56,
            fill=False,
            edgecolor=theme.MUTED,
            linewidth=1.1,
            linestyle=(0, (5, 4)),
        )
    )
    _text(axes, 139, 28, "m")
    _text(axes, 70, 52, "K")
    _arrow(axes, (172, 28), (216, 28), theme.C2)
    _text(axes, 196, 42, "F = K x", theme.C2)
    for left, right, height, name in ((110, 150, 76, "x"), (110, 266, 98, "s")):
        for end in (left, right):
            axes.plot([end, end], [height - 7, height + 7], color=theme.MUTED, linewidth=0.8)
        _arrow(axes, (left, height), (right, height), theme.C1)
        _text(axes, (left + right) / 2, height + 13, name, theme.C1)
    _text(axes, 60, -20, f"{theme.symbol_label('mu_d')}, {theme.symbol_label('mu_s')}")


def _text(axes: Axes, x: float, y: float, text: str, colour: str = theme.INK) -> None:
    axes.text(
        x, y, text, ha="center", va="center", fontsize=13, style="italic", color=colour, zorder=80
    )


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str) -> None:
    style = {"arrowstyle": "-|>", "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0, "color": colour}
    axes.annotate("", end, start, arrowprops=style)


_SCHEMATICS: Final = MappingProxyType[str, Callable[[Figure], None]]({"cart": _cart, "rig": _rig})
"""What is drawn with the symbols of the source paper."""
