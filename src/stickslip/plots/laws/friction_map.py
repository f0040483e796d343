"""Measured friction against velocity, with the laws that were fitted to it."""

from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.formatting import number, scale_of
from stickslip.friction import FrictionLaw
from stickslip.plots.core.helpers import Array, LineStyle, Sizes, looks, wrapped
from stickslip.plots.core.label_placement import Curve, label_curves
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C3, C4, DATA, LINE, MUTED, label_at, name_size
from stickslip.plots.laws.curves import characteristic

MAP_SIZES: Final = Sizes(wide=(880, 320), narrow=(358, 500))
LOW: Final = 0.25
"""Largest speed of the second panel over that of the first, before rounding."""
ONE_WAY: Final = 0.01
"""Share of the points below which a direction counts as not measured."""
FEW: Final = 30
"""Points below that speed with which a second panel is worth its place."""
OUTER: Final = 0.3
"""Share of the points [%] beyond each end of the vertical axis."""
SINGLE: Final = 100
"""Points up to which each is drawn to be seen by itself."""
SPREAD: Final = 100.0
"""Largest speed over the smallest from which readings in one direction have a logarithmic axis."""
TURNS: Final = {0: (DATA, "o"), 1: (C3, "o"), -1: (C4, "^")}
"""Colour and marker of points by whether their speed rises or falls."""
LEAST: Final = 8
"""... with so many points at least."""
WIDTH: Final = 22
"""Letters of a line of a name."""


class MapLaw(NamedTuple):
    """A law of a friction map, and the constant force with it [N]."""

    law: FrictionLaw
    """The friction law."""
    offset: float
    """Constant force that adds to friction [N]."""


def low_speed(v_max: float) -> float:
    """Return the largest speed of the second panel, a round number.

    Examples
    --------
    >>> low_speed(0.128)
    0.02
    """
    top = LOW * v_max
    power = 10.0 ** np.floor(np.log10(top))
    return float(power * max(step for step in (1, 2, 5) if step * power <= top * (1 + 1e-9)))


def draw_friction_map(
    velocity: Array,
    friction: Array,
    laws: Mapping[str, MapLaw],
    load: float,
    *,
    chosen: str,
    trend: Array | None = None,
    units: tuple[str, str] = ("m/s", "N"),
    low_speeds: bool = True,
) -> Draw:
    """Return a drawing of friction against velocity: points, and laws as curves.

    Where only one direction was measured, laws are drawn in that direction alone.
    """
    v_max = float(np.max(np.abs(velocity)))
    factor, unit = scale_of([v_max], units[0])
    curves = {name: _curve(one, load, 1.05 * v_max, _sides(velocity)) for name, one in laws.items()}
    look = looks(laws, chosen)
    low = low_speed(v_max)
    slow = np.abs(velocity) <= low
    spread = _is_spread(velocity)
    spans = [_span(velocity, spread)]
    turn = np.zeros(len(velocity)) if trend is None else np.asarray(trend)
    if low_speeds and not spread and int(slow.sum()) >= FEW and not slow.all():
        spans.append(_span(velocity[slow], spread=False))

    def draw(figure: Figure, narrow: bool) -> None:
        shape = (len(spans), 1) if narrow else (1, len(spans))
        ratios = None if narrow else [3, 2][: len(spans)]
        grid = figure.subplots(*shape, squeeze=False, width_ratios=ratios)
        for axes, (first, last) in zip(grid.flat, spans, strict=True):
            seen = (velocity >= first) & (velocity <= last)
            _points(axes, factor * velocity[seen], friction[seen], turn[seen])
            lines = _inside(curves, first, last, factor)
            _lines(axes, lines, look, chosen)
            _frame(axes, (factor * first, factor * last), friction[seen], lines, spread)
            axes.set(xlabel=f"velocity, {unit}", ylabel=f"friction, {units[1]}")
        if low_speeds:
            grid.flat[0].set_title("all speeds", color=MUTED)
        if np.any(turn):
            _say_trend(grid.flat[0])
        if len(spans) > 1:
            grid.flat[1].set_title(f"below {number(factor * low)} {unit}", color=MUTED)
        points = np.column_stack([factor * velocity, friction])
        shown = {name: (factor * v, f) for name, (v, f) in curves.items()}
        if spread:
            shown = _inside(curves, *spans[0], factor)
        _names(grid.flat[0], shown, look, chosen, points[: SINGLE if len(points) <= SINGLE else 0])

    return draw


class MapSplit(NamedTuple):
    """What friction may depend on beside the velocity, at the points of a map."""

    label: str
    """What it is, for the title of a panel."""
    values: Array
    """Its values (n,), in the unit shown."""
    unit: str
    """That unit."""


def _inside(
    curves: Mapping[str, tuple[Array, Array]], first: float, last: float, factor: float
) -> dict[str, tuple[Array, Array]]:
    """Return curves between two velocities, in the unit shown."""
    return {
        name: (factor * v[inside], force[inside])
        for name, (v, force) in curves.items()
        for inside in [(v >= first) & (v <= last)]
    }


def _sides(velocity: Array) -> tuple[bool, bool]:
    """Return whether slip backwards and forwards was measured; both if nothing slips."""
    back, ahead = (float(np.mean(sign * velocity > 0.0)) >= ONE_WAY for sign in (-1.0, 1.0))
    return (back, ahead) if back or ahead else (True, True)


def _curve(one: MapLaw, load: float, v_max: float, sides: tuple[bool, bool]) -> tuple[Array, Array]:
    """Return a curve in the directions that were measured; at rest each ends at break-away."""
    v, force = characteristic(one.law, load, v_max)
    middle = len(v) // 2  # of an even number: two are at rest, one for each direction
    kept = slice(0 if sides[0] else middle, len(v) if sides[1] else middle)
    return v[kept], force[kept] + one.offset


def _is_spread(velocity: Array) -> bool:
    """Return whether these are readings at speeds of several powers of ten, in one direction."""
    slowest, fastest = float(velocity.min()), float(velocity.max())
    return len(velocity) <= SINGLE and 0.0 < slowest <= fastest / SPREAD


def _span(velocity: Array, spread: bool) -> tuple[float, float]:
    """Return the ends of the horizontal axis; 0 is on it, unless it is logarithmic."""
    if spread:
        margin = float(velocity.max() / velocity.min()) ** 0.03
        return float(velocity.min()) / margin, float(velocity.max()) * margin
    low, high = min(float(velocity.min()), 0.0), max(float(velocity.max()), 0.0)
    margin = 0.03 * (high - low)
    return low - margin, high + margin


def _points(axes: Axes, velocity: Array, friction: Array, turn: Array) -> None:
    # the readings of a table are seen one by one, above the lines; samples of a record as a cloud
    few = len(velocity) <= SINGLE
    size, alpha, order = (6.0, 0.9, 5) if few else (2.5, 0.6, 1)
    for sign, (colour, marker) in TURNS.items():
        own = turn == sign
        axes.plot(
            velocity[own], friction[own], marker, color=colour, markersize=size, alpha=alpha,
            markeredgewidth=0, linestyle="none", zorder=order,
        )  # fmt: skip


def _say_trend(axes: Axes) -> None:
    """Name the two kinds of points above the panel, each in its colour."""
    for text, colour, at in (("● speeding up", C3, 0.62), ("▲ slowing down", C4, 0.995)):
        axes.annotate(
            text, (at, 1.0), xycoords="axes fraction", xytext=(0, 3),
            textcoords="offset points", ha="right", va="bottom", color=colour, fontsize=name_size(),
        )  # fmt: skip


def _lines(
    axes: Axes,
    lines: Mapping[str, tuple[Array, Array]],
    look: Mapping[str, LineStyle],
    chosen: str,
) -> None:
    for name, (v, force) in lines.items():
        colour, _, width, order = look[name]
        dashes = "-" if name == chosen else (0, (5, 2))
        axes.plot(v, force, color=colour, linestyle=dashes, linewidth=width, zorder=order)


def _frame(
    axes: Axes,
    span: tuple[float, float],
    friction: Array,
    lines: Mapping[str, tuple[Array, Array]],
    spread: bool,
) -> None:
    """Set the limits: a few points far out are cut off rather than flatten the rest."""
    low, high = np.percentile(friction, [OUTER, 100 - OUTER])
    forces = np.concatenate([[low, high, 0.0], *[force for _, force in lines.values()]])
    margin = 0.06 * max(float(np.ptp(forces)), 1e-12)
    axes.set_xscale("log" if spread else "linear")
    axes.set_xlim(*span)
    axes.set_ylim(float(forces.min()) - margin, float(forces.max()) + margin)
    axes.axhline(0.0, color=LINE, linewidth=0.8, zorder=0)
    if not spread:
        axes.locator_params(axis="x", nbins=7)
        axes.axvline(0.0, color=LINE, linewidth=0.8, zorder=0)


def _names(
    axes: Axes,
    curves: Mapping[str, tuple[Array, Array]],
    look: Mapping[str, LineStyle],
    chosen: str,
    points: Array,
) -> None:
    """Name the laws in the quadrants that friction leaves free; beside the curves if one-way."""
    low, high = axes.get_xlim()
    if min(-low, high) < 0.2 * (high - low):
        named = [Curve(v, f, name, look[name].colour) for name, (v, f) in curves.items()]
        at_rest = [] if axes.get_xscale() == "log" else [_upright(axes)]
        label_curves(axes, [*named, *at_rest], points=points)
        return
    bottom, top = axes.get_ylim()
    ordered = sorted(curves, key=lambda name: name != chosen)
    for name, side in zip(ordered, (1, -1), strict=False):
        told = name == chosen and len(curves) > 1
        lines = wrapped((f"chosen: {name}" if told else name).split(), WIDTH)
        text = "\n".join(line.replace(",", "") for line in lines)
        label_at(
            axes, side * 0.03 * (high - low), 0.3 * (bottom if side > 0 else top), text,
            look[name].colour, offset=(0, 0), align="left" if side > 0 else "right",
        )  # fmt: skip


def _upright(axes: Axes) -> Curve:
    """Return the line at rest, which no name stands across, from far below to far above."""
    (low, high), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    tall = top - bottom
    ends = np.array([0.0, 1e-6 * (high - low)]), np.array([bottom - tall, top + tall])
    return Curve(*ends, "", LINE)
