"""The figure of a verdict: what was measured, the band, and the law."""

import math
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.identify.bands import ALIKE, Array, MeasuredPoints, PredictionBand, RunCertificate
from stickslip.show.formatting import number, scale_of
from stickslip.show.plots import C1, C3, DATA, MAP_SIZES, on_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from stickslip.show.display import Drawing, Target
    from stickslip.show.plots import Draw

LETTERS = 36
"""Letters of a line of the legend."""
MARKERS = ("o", "s", "^", "D")
"""Marks of the loads, which are as many at most."""

PAST, PART = 0.6, 0.1
"""Share of a whole motion at which its enlarged part begins, and its length."""
MOST_POINTS = 2000
"""Points of a record that are drawn, about."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BandDrawing(MeasuredPoints):
    """What the figure of a verdict shows, in SI units."""

    speeds: Array
    """Velocities of the band (m,)."""
    band: PredictionBand
    other: PredictionBand | None = None
    """Band of another specimen there."""
    law: Array
    """Friction of the named law there (m,)."""
    title: str
    """Name of the law."""
    places: tuple[float, ...]
    """Velocities that are proposed."""
    units: tuple[str, str]
    """Units of velocity and friction."""
    by_load: Mapping[float, tuple[PredictionBand, Array]] = field(default_factory=dict)
    """Band and named law (m,) at each load [N] that is drawn apart, instead of those at one."""
    names: tuple[str, str] = ("velocity", "friction")
    """What is drawn over what: travels over a setting are drawn alike."""


def draw_band(what: BandDrawing) -> "Draw":
    """Return a drawing of readings, the band of friction, the named law and proposed readings."""

    def draw(figure: "Figure", narrow: bool) -> None:
        _draw_on(figure.add_subplot(), what, narrow)

    return draw


def draw_run(seen: RunCertificate, unit: str) -> "Draw":
    """Return a drawing of measured and simulated positions over time, one stretch enlarged."""
    factor, shown = scale_of([float(np.max(np.abs(x))) for _, x in seen.motion], unit)
    large, part = seen.typical, slice(None)
    if seen.is_whole:  # a part past the middle, where a run has had time to go astray
        part = slice(int(PAST * len(large.time)), int((PAST + PART) * len(large.time)) + 2)
    look: dict[str, dict[str, Any]] = {
        "measured": {"color": DATA, "linewidth": 3.5, "alpha": 0.4},
        "plain": {"color": C3, "linewidth": 1.0, "linestyle": (0, (4, 3))},
        "simulated": {"color": C1, "linewidth": 1.2},
    }
    names = {"measured": "measured", "plain": "Coulomb + viscous by least squares",
             "simulated": "this law and mechanism, run"}  # fmt: skip

    def draw(figure: "Figure", narrow: bool) -> None:
        left, right = figure.subplots(*((2, 1) if narrow else (1, 2)))
        for time, x in seen.motion:
            every = max(len(time) // MOST_POINTS, 1)
            left.plot(time[::every], factor * x[::every], **look["measured"])
        for item in seen.stretches:
            left.plot(item.time, factor * item.simulated, **look["simulated"])
        left.axvspan(*large.time[part][[0, -1]].tolist(), color=C3, alpha=0.15, linewidth=0)
        for name, label in names.items():
            values = factor * getattr(large, name)[part]
            right.plot(large.time[part], values, label=label, **look[name])
        for axes in (left, right):
            axes.grid(axis="y")
            axes.set_xlabel("time, s")
            axes.set_ylabel(f"{'velocity' if unit.endswith('/s') else 'position'}, {shown}")
        place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "frameon": False}
        right.legend(ncols=1, fontsize="small", **place)

    return draw


def draw_joints(drawings: Mapping[str, BandDrawing]) -> "Draw":
    """Return a drawing with a panel for each of several joints."""

    def draw(figure: "Figure", narrow: bool) -> None:
        panels = figure.subplots(len(drawings), 1, squeeze=False)[:, 0]
        for axes, (name, what) in zip(panels, drawings.items(), strict=True):
            _draw_on(axes, what, narrow)
            axes.set_ylabel(f"{name}: {axes.get_ylabel()}")

    return draw


def _draw_on(axes: "Axes", what: BandDrawing, narrow: bool) -> None:
    """Draw on axes."""
    v, friction = what.velocity, what.friction
    sizes = np.abs(v[v != 0.0])
    logarithmic = _by_ratios(np.unique(sizes)) and v.min() > 0.0
    factor, unit = scale_of([float(sizes.max())], what.units[0])
    force, force_unit = scale_of(np.abs(friction).tolist(), what.units[1])
    light = what.weights < 0.3 * float(np.median(what.weights))

    x = factor * what.speeds
    # a law of many terms would leave no room for the axes
    labels: dict[str, Any] = {
        "band": "95 % band over all candidate laws", "law": textwrap.fill(what.title, LETTERS),
        "other": "95 % band of another run or specimen",
    }  # fmt: skip
    for band, law in what.by_load.values() or [(what.band, what.law)]:
        for part in _directions(what.speeds):
            axes.fill_between(
                x[part],
                force * band.low[part],
                force * band.high[part],
                color=C1,
                alpha=0.18,
                linewidth=0,
                label=labels.pop("band", None),
            )
            axes.plot(x[part], force * law[part], color=C1, label=labels.pop("law", None))
    if what.other is not None and not what.by_load:
        for part in _directions(what.speeds):
            for end in (what.other.low, what.other.high):
                axes.plot(
                    x[part],
                    force * end[part],
                    color=C1,
                    linewidth=0.9,
                    linestyle=(0, (4, 3)),
                    label=labels.pop("other", None),
                )
    for k, load in enumerate(loads_apart(what.load)):
        at = np.isclose(what.load, load, rtol=ALIKE) if load else np.ones(len(v), dtype=bool)
        look: dict[str, Any] = {"color": DATA, "markersize": 4.5, "linestyle": "none"}
        marker = MARKERS[k % len(MARKERS)]
        label = f"readings at {number(load)} N" if load else "readings"
        kept = at & ~light
        axes.plot(factor * v[kept], force * friction[kept], marker, label=label, **look)
        kept = at & light
        axes.plot(factor * v[kept], force * friction[kept], marker, fillstyle="none", **look)
    look = {"color": C3, "linewidth": 0.8, "linestyle": (0, (2, 3))}
    for k, place in enumerate(dict.fromkeys(what.places)):
        axes.axvline(factor * place, label=None if k else "where to measure next", **look)
    if logarithmic:
        axes.set_xscale("log")
        _label_speeds(axes)
    axes.set_xlim(*_ticks_about(axes.xaxis))
    axes.set_ylim(*_ticks_about(axes.yaxis))
    axes.grid(axis="y")
    axes.set_xlabel(f"{what.names[0]}, {unit}")
    axes.set_ylabel(f"{what.names[1]}, {force_unit}")
    # above the axes, where no reading lies beneath it
    look = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "frameon": False}
    axes.legend(ncols=1 if narrow else 3, fontsize="small" if narrow else None, **look)


def _label_speeds(axes: "Axes") -> None:
    """Label a logarithmic axis in numbers instead of powers of ten."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: number(x)))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _ticks_about(axis: "Axis") -> tuple[float, float]:
    """Return the ticks of an axis that are nearest about what it shows."""
    low, high = sorted(axis.get_view_interval())
    ticks = np.asarray(axis.get_major_locator().tick_values(low, high))
    return float(np.max(ticks[ticks <= low])), float(np.min(ticks[ticks >= high]))


def _by_ratios(speeds: Array) -> bool:
    """Return whether speeds (n,) are set apart by ratios rather than by differences.

    Examples
    --------
    >>> _by_ratios(np.geomspace(0.1, 1.0, 5)), _by_ratios(np.linspace(0.1, 1.0, 5))
    (True, False)
    """
    if len(speeds) < 3:
        return False
    uneven = [
        float(np.std(gap) / np.mean(gap)) for gap in (np.diff(np.log(speeds)), np.diff(speeds))
    ]
    return uneven[0] < uneven[1]


def _directions(speeds: Array) -> "list[NDArray[np.intp]]":
    """Return the places of the speeds of each direction."""
    sides = (speeds < 0.0, speeds > 0.0)
    return [np.flatnonzero(side) for side in sides if side.any()]


def loads_apart(load: Array) -> list[float]:
    """Return the loads that are drawn apart; one 0 if there is but one."""
    known = np.unique(load)
    apart = np.concatenate([[True], np.diff(np.log(known)) > ALIKE])
    known = known[apart]
    if len(known) == 1:
        return [0.0]
    return [float(item) for item in known[:: math.ceil(len(known) / len(MARKERS))]]


def plot_band(what: BandDrawing, ax: "Target" = None) -> "Drawing":
    """Plot what was measured, the band of friction, and the law that is named."""
    axes: Axes = on_axes(draw_band(what), ax, MAP_SIZES["wide"])
    return axes
