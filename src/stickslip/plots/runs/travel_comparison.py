"""Travels of fitted laws, and how far they lie apart on the way."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.plots.core.helpers import Array, LineStyle, Sizes, dense, horizon, looks
from stickslip.plots.core.label_placement import Curve, label_curves
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import MUTED, SLIP_BACK, label_at
from stickslip.trajectory import Trajectory

TRAVEL_SIZES: Final = Sizes(wide=(880, 310), narrow=(358, 500))

APART: Final = 0.04
"""Share of the travel by which a law must differ to have a name of its own on the left."""
OFF_SCALE: Final = 6.0
"""A law that differs this many times more than the middle one would flatten all others."""


def draw_travels(
    runs: Mapping[str, Trajectory],
    chosen: str,
    *,
    band: tuple[float, float] | None = None,
    slip: str = "x",
) -> Draw:
    """Return a drawing of the travel of each law, and of its difference from the chosen one."""
    arrived = horizon(runs[chosen], slip)
    last = min(1.6 * arrived, *(run.span[1] for run in runs.values()))
    times = dense(runs[chosen], last).t
    travel = {name: run.at(times)[slip] - run.at(run.span[:1])[slip] for name, run in runs.items()}
    apart = {name: 1e3 * (x - travel[chosen]) for name, x in travel.items()}
    look = looks(runs, chosen)

    def draw(figure: Figure, narrow: bool) -> None:
        if len(runs) == 1:
            _travels(figure.add_subplot(), times, travel, chosen, look, band)
            return
        left, right = figure.subplots(*((2, 1) if narrow else (1, 2)))
        _travels(left, times, travel, chosen, look, band)
        shown = times <= arrived
        near = {name: gap[shown] for name, gap in apart.items()}
        _differences(right, times[shown], near, chosen, look)

    return draw


def _travels(
    axes: Axes,
    times: Array,
    travel: Mapping[str, Array],
    chosen: str,
    look: Mapping[str, LineStyle],
    band: tuple[float, float] | None,
) -> None:
    reach = float(np.max(np.abs(travel[chosen]))) or 1.0
    if band:
        axes.axhspan(*band, facecolor=SLIP_BACK, edgecolor="none", zorder=0)
    _lines(axes, times, travel, look)
    axes.set_title("travel, m", color=MUTED)
    axes.set_xlabel("time, s")
    axes.margins(x=0, y=0.16)
    axes.grid(axis="y")
    far = [name for name, x in travel.items() if np.max(np.abs(x - travel[chosen])) > APART * reach]
    near = [name for name in travel if name not in far and name != chosen]
    joined = {0: chosen, 1: f"{chosen} and {''.join(near)}"}
    texts = {chosen: joined.get(len(near), f"{chosen} and {len(near)} others")}
    texts |= {name: name for name in far}
    curves = [Curve(times, x, texts.get(name, ""), look[name].colour) for name, x in travel.items()]
    if band:
        label_at(axes, float(times[0]), band[1], "measured", MUTED, offset=(5, 7))
    label_curves(axes, curves)


def _differences(
    axes: Axes, times: Array, apart: Mapping[str, Array], chosen: str, look: Mapping[str, LineStyle]
) -> None:
    largest = {name: float(np.max(np.abs(d))) for name, d in apart.items() if name != chosen}
    middle = float(np.median(list(largest.values())))
    beyond = [n for n, d in largest.items() if d > OFF_SCALE * middle > 0]
    shown = {name: d for name, d in apart.items() if name not in beyond}
    _lines(axes, times, shown, look)
    axes.set_title(f"difference from {chosen}, mm", color=MUTED)
    axes.set_xlabel("time, s")
    axes.margins(x=0, y=0.16)
    axes.grid(axis="y")
    if beyond:
        axes.margins(y=0.3)
        text = ", ".join(f"{name}: up to {largest[name]:.2g} mm" for name in beyond)
        axes.annotate(
            f"{text}, off the scale", (1.0, 1.0), xycoords="axes fraction", ha="right", va="top",
            color=look[beyond[0]].colour, fontsize=11,
        )  # fmt: skip
    label_curves(axes, [Curve(times, d, name, look[name].colour) for name, d in shown.items()])


def _lines(
    axes: Axes, times: Array, curves: Mapping[str, Array], look: Mapping[str, LineStyle]
) -> None:
    for name, y in curves.items():
        colour, dashes, width, order = look[name]
        axes.plot(times, y, color=colour, linestyle=dashes, linewidth=width, zorder=order)
