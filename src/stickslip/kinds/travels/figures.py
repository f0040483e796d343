"""Travels of fitted laws: on the way, and as they predict them at other settings of the rig."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.formatting import count, scale_of
from stickslip.plots import (
    INK,
    MUTED,
    SLIP_BACK,
    STICK,
    SURFACE,
    Array,
    Curve,
    Draw,
    LineStyle,
    Sizes,
    dense,
    grouped,
    horizon,
    label_at,
    label_curves,
    label_ends,
    looks,
    wrapped,
)
from stickslip.trajectory import Trajectory

SEPARATION_SIZES: Final = Sizes(wide=(880, 320), narrow=(358, 300))
ROOM, NARROW_ROOM = 0.06, 0.12
"""Width of the number of a setting over that of all settings, in a wide and a narrow figure."""
NAMES: Final = 30
"""Letters of two names that have room beside a curve of a narrow figure."""


def draw_separation(
    settings: Sequence[float],
    predicted: Mapping[str, Sequence[float]],
    chosen: str,
    measured: Sequence[tuple[float, float]] = (),
    *,
    what: str,
    unit: str,
    proposed: Sequence[float] = (),
    titles: Mapping[str, str] | None = None,
) -> Draw:
    """Return a drawing of the travel that each law predicts against the setting of the rig.

    Parameters
    ----------
    settings : sequence of float
        Settings (n,) of one parameter, in any order [SI].
    predicted : mapping of str to sequence of float
        Travels (n,) at these settings [m], by law.
    chosen : str
        Key of the law that stands out.
    measured : sequence of tuple of float
        Setting and travel of what was measured.
    what : str
        Name of the parameter.
    unit : str
        Its SI unit.
    proposed : sequence of float
        Settings to measure next, such as those of a `Proposal`.
    titles : mapping of str to str, optional
        Names of the laws by key.

    Returns
    -------
    callable
        Draws it, with a band at each proposed setting.
    """
    order = np.argsort(settings)
    names = sorted(predicted, key=lambda name: name != chosen)
    titles = titles or {}
    factor, unit = scale_of(settings, unit)
    at = factor * np.asarray(settings)[order]
    paths = {name: np.asarray(predicted[name])[order] for name in names}
    look = looks(names, chosen)

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        for name in names:
            colour, dashes, width, above = look[name]
            y = paths[name]
            axes.plot(at, y, color=colour, linestyle=dashes, linewidth=width, zorder=above)
            axes.plot(at, y, "o", color=colour, markersize=3, zorder=above)
        axes.set_xlabel(f"{what}, {unit}")
        axes.set_ylabel("travel, m")
        axes.grid(axis="y")
        _ticks(axes, at, [factor * value for value in proposed], narrow)
        axes.margins(x=0.03)
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
        _where_to_measure(axes, [factor * value for value in proposed])
        shown = [(factor * x, y) for x, y in measured]
        _measured(axes, [(x, y) for x, y in shown if at[0] <= x <= at[-1]])
        _name_laws(axes, at, paths, look, titles, narrow)

    return draw


def _ticks(axes: Axes, settings: Array, proposed: Sequence[float], narrow: bool) -> None:
    """Number the settings that have room for it, those to measure next before all others."""
    least = (NARROW_ROOM if narrow else ROOM) * float(np.ptp(settings))
    shown: list[float] = []
    for at in [*proposed, settings[0], settings[-1], *settings]:
        if all(abs(at - other) >= least for other in shown):
            shown.append(float(at))
    axes.set_xticks(sorted(shown))
    axes.set_xticks(settings, minor=True)


def _name_laws(
    axes: Axes,
    settings: Array,
    paths: Mapping[str, Array],
    look: Mapping[str, LineStyle],
    titles: Mapping[str, str],
    narrow: bool,
) -> None:
    """Name each law with its last prediction; laws that end together share a name."""
    ends = {name: float(y[-1]) for name, y in paths.items()}
    groups = grouped(ends, 0.015 * float(np.ptp(axes.get_ylim())))
    if narrow:
        texts = {group[0]: f"{end:.3f} m {_short(group, titles)}" for end, group in groups}
        curves = [Curve(settings, y, texts.get(n, ""), look[n].colour) for n, y in paths.items()]
        label_curves(axes, curves)
        return
    labels = []
    for end, group in groups:
        lines = wrapped([titles.get(name, name) for name in group], 34)
        labels.append((end, [f"{end:.3f} m {lines[0]}", *lines[1:]], look[group[0]].colour))
    label_ends(axes, axes.get_xlim()[1], labels)


def _short(names: Sequence[str], titles: Mapping[str, str]) -> str:
    """Return the names of a group, or the first and how many others."""
    said = [titles.get(name, name) for name in names]
    whole = ", ".join(said)
    if len(said) < 2 or (len(said) == 2 and len(whole) <= NAMES):
        return whole
    return f"{said[0]} and {count(len(said) - 1, 'other')}"


def _where_to_measure(axes: Axes, settings: Sequence[float]) -> None:
    low, high = axes.get_xlim()
    half = 0.008 * (high - low)
    for at in settings:
        axes.axvspan(at - half, at + half, facecolor=STICK, edgecolor="none", zorder=0)
    place = axes.get_xaxis_transform()
    notes = ((0.92, "measure here", 8, "left"), (0.06, "and here", -8, "right"))
    for at, (height, text, side, align) in zip(settings, notes, strict=False):
        axes.annotate(
            text, (at, height), xycoords=place, xytext=(side, 0), textcoords="offset points",
            ha=align, color=MUTED, fontsize="medium",
        )  # fmt: skip


def _measured(axes: Axes, points: Sequence[tuple[float, float]]) -> None:
    for index, (x, y) in enumerate(points):
        axes.plot([x], [y], "o", color=INK, markersize=6, markeredgecolor=SURFACE, zorder=5)
        if index == 0:
            label_at(axes, x, y, "measured", INK, offset=(-8, 10), align="right")


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
            color=look[beyond[0]].colour, fontsize="medium",
        )  # fmt: skip
    label_curves(axes, [Curve(times, d, name, look[name].colour) for name, d in shown.items()])


def _lines(
    axes: Axes, times: Array, curves: Mapping[str, Array], look: Mapping[str, LineStyle]
) -> None:
    for name, y in curves.items():
        colour, dashes, width, order = look[name]
        axes.plot(times, y, color=colour, linestyle=dashes, linewidth=width, zorder=order)
