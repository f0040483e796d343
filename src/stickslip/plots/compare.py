"""Figures that compare fitted laws: their travels, and what they predict at other settings."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.plots.labels import Curve, label_curves, label_ends
from stickslip.plots.series import Array, Look, Sizes, dense, grouped, horizon, looks, wrapped
from stickslip.plots.svg import Draw
from stickslip.plots.theme import INK, MUTED, SLIP_BACK, STICK, SURFACE, label_at
from stickslip.selection.separation import Separation
from stickslip.trajectory import Trajectory

__all__ = ["SEPARATION_SIZES", "TRAVEL_SIZES", "draw_separation", "draw_travels"]

TRAVEL_SIZES: Final = Sizes(wide=(880, 310), narrow=(358, 500))
SEPARATION_SIZES: Final = Sizes(wide=(880, 320), narrow=(358, 300))

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
    """Return a drawing of the travel of each law, and of its difference from the chosen one.

    Parameters
    ----------
    runs : mapping of str to Trajectory
        Runs by title of the law, over the same time.
    chosen : str
        The law that stands out.
    band : tuple of float, optional
        Range of the measured travel [m].
    slip : str
        Name of the slipping coordinate.

    Returns
    -------
    callable
        Draws it.
    """
    last = min(1.6 * horizon(runs[chosen], slip), runs[chosen].span[1])
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
        _differences(right, times, apart, chosen, look)

    return draw


def _travels(
    axes: Axes,
    times: Array,
    travel: Mapping[str, Array],
    chosen: str,
    look: Mapping[str, Look],
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
        width = 0.22 * float(np.ptp(times))
        top = np.array([band[1], band[1] + 0.1 * reach])
        curves.append(Curve(times[0] + np.array([0.0, width]), top, "", MUTED))
    label_curves(axes, curves)


def _differences(
    axes: Axes, times: Array, apart: Mapping[str, Array], chosen: str, look: Mapping[str, Look]
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


def _lines(axes: Axes, times: Array, curves: Mapping[str, Array], look: Mapping[str, Look]) -> None:
    for name, y in curves.items():
        colour, dashes, width, order = look[name]
        axes.plot(times, y, color=colour, linestyle=dashes, linewidth=width, zorder=order)


def draw_separation(
    separations: Sequence[Separation],
    chosen: str,
    measured: Sequence[tuple[float, float]] = (),
    *,
    titles: Mapping[str, str] | None = None,
) -> Draw:
    """Return a drawing of the travel that each law predicts against the setting of the rig.

    Parameters
    ----------
    separations : sequence of Separation
        Predictions at several settings of one parameter.
    chosen : str
        Key of the law that stands out.
    measured : sequence of tuple of float
        Setting and travel of what was measured.
    titles : mapping of str to str, optional
        Names of the laws by key.

    Returns
    -------
    callable
        Draws it, with a band at the settings that tell most.
    """
    rows = sorted(separations, key=lambda row: row.value)
    names = list(rows[0].predicted)
    names.sort(key=lambda name: name != chosen)
    titles = titles or {}
    what = rows[0].path.rpartition(".")[2].replace("_", " ")
    in_mm = rows[0].unit == "m"
    settings = np.array([row.value for row in rows]) * (1e3 if in_mm else 1.0)
    look = looks(names, chosen)

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        ends = {}
        for name in names:
            colour, dashes, width, order = look[name]
            y = np.array([row.predicted[name] for row in rows])
            x, smooth = _smooth(settings, y)
            axes.plot(x, smooth, color=colour, linestyle=dashes, linewidth=width, zorder=order)
            ends[name] = float(y[-1])
        axes.set_xlabel(f"{what}, {'mm' if in_mm else rows[0].unit}")
        axes.set_ylabel("travel, m")
        axes.grid(axis="y")
        axes.set_xticks(settings)
        axes.margins(x=0.03)
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
        _where_to_measure(axes, settings)
        _measured(axes, [(x * (1e3 if in_mm else 1.0), y) for x, y in measured])
        labels = []
        for y, group in grouped(ends, 0.015 * float(np.ptp(axes.get_ylim()))):
            lines = wrapped([titles.get(n, n) for n in group], 16 if narrow else 34)
            labels.append((y, [f"{y:.3f} m {lines[0]}", *lines[1:]], look[group[0]].colour))
        label_ends(axes, axes.get_xlim()[1], labels)

    return draw


def _smooth(x: Array, y: Array) -> tuple[Array, Array]:
    """Return a curve through a few points: travels are smooth in what a rig can be set to."""
    degree = min(len(x) - 1, 3)
    fine = np.linspace(x[0], x[-1], 60)
    fit = np.polynomial.Polynomial.fit(x, y, degree)
    if np.max(np.abs(fit(x) - y)) > 0.01 * np.ptp(y):
        return x, y
    return fine, fit(fine)


def _where_to_measure(axes: Axes, settings: Array) -> None:
    low, high = axes.get_xlim()
    half = 0.008 * (high - low)
    for at in (settings[0], settings[-1]):
        axes.axvspan(at - half, at + half, facecolor=STICK, edgecolor="none", zorder=0)
    place = axes.get_xaxis_transform()
    for at, text, side, align in (
        (settings[0], "measure here", 8, "left"),
        (settings[-1], "and here", -8, "right"),
    ):
        axes.annotate(
            text, (at, 0.06), xycoords=place, xytext=(side, 0), textcoords="offset points",
            ha=align, color=MUTED, fontsize=11,
        )  # fmt: skip


def _measured(axes: Axes, points: Sequence[tuple[float, float]]) -> None:
    for index, (x, y) in enumerate(points):
        axes.plot([x], [y], "o", color=INK, markersize=6, markeredgecolor=SURFACE, zorder=5)
        if index == 0:
            label_at(axes, x, y, "measured", INK, offset=(-8, 10), align="right")
