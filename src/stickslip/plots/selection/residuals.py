"""What a fit leaves: residuals against time, velocity and position, and errors of predictions."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.plots.core.helpers import Array, Sizes, looks
from stickslip.plots.core.label_placement import LETTER
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, DATA, LINE, MUTED, name_size

ERROR_SIZES: Final = Sizes(wide=(880, 330), narrow=(358, 380))
OUTER: Final = 0.2
"""Share of the residuals [%] beyond each end of the vertical axis."""


class ResidualPanel(NamedTuple):
    """Residuals against one quantity, as dots and as means of bins with their doubt."""

    label: str
    """Quantity and unit of the horizontal axis."""
    x: Array
    """The quantity (n,), in that unit."""
    residual: Array
    """Residuals (n,), in the unit shown."""
    centre: Array
    """Middles of the bins (k,), in the unit of `x`."""
    mean: Array
    """Means of the residuals in the bins (k,)."""
    doubt: Array
    """Twice the standard errors of these means (k,)."""


class ErrorSeries(NamedTuple):
    """Errors of one law: over time, and by block."""

    t: Array
    """Times (n,) [s]; records follow one another."""
    error: Array
    """Errors of the predictions (n,), in the unit shown; NaN between segments."""
    blocks: Array
    """Root mean square error of each held-out block (folds,), in the unit shown."""


def residual_sizes(count: int) -> Sizes:
    """Return the sizes of a figure of that many panels.

    Examples
    --------
    >>> residual_sizes(3)["wide"]
    (880, 380)
    """
    return Sizes(wide=(880, 200 if count < 3 else 380), narrow=(358, 20 + 180 * count))


def draw_residuals(panels: Sequence[ResidualPanel], label: str) -> Draw:
    """Return a drawing of residuals in panels that share their vertical axis."""
    everything = np.concatenate([panel.residual for panel in panels])
    low, high = np.percentile(everything, [OUTER, 100 - OUTER])
    margin = 0.1 * max(float(high - low), 1e-300)

    def draw(figure: Figure, narrow: bool) -> None:
        if narrow:
            places = list(figure.subplots(len(panels), 1, squeeze=False).flat)
        elif len(panels) == 3:
            places = list(figure.subplot_mosaic("AA;BC").values())
        else:
            places = list(figure.subplots(1, len(panels), squeeze=False).flat)
        for axes, panel in zip(places, panels, strict=True):
            axes.set_ylim(low - margin, high + margin)
            _residual_panel(axes, panel)
            axes.set_ylabel(label)
        _say_mean(places[0])

    return draw


def _residual_panel(axes: Axes, panel: ResidualPanel) -> None:
    axes.axhline(0.0, color=MUTED, linewidth=0.8, zorder=0)
    axes.plot(
        panel.x, panel.residual, "o", color=DATA, markersize=2.2, alpha=0.6, markeredgewidth=0,
        zorder=1,
    )  # fmt: skip
    axes.errorbar(
        panel.centre, panel.mean, panel.doubt, color=C1, linewidth=1.8, elinewidth=1.2, zorder=3
    )
    axes.margins(x=0.01)
    axes.grid(axis="y")
    axes.set_xlabel(panel.label)


def _say_mean(axes: Axes) -> None:
    axes.annotate(
        "mean ± 2 standard errors",
        (0.995, 1.0),
        xycoords="axes fraction",
        xytext=(0, 2),
        textcoords="offset points",
        ha="right",
        va="bottom",
        color=C1,
        fontsize=name_size(),
    )


def draw_prediction_error(
    series: Mapping[str, ErrorSeries],
    edges: Array,
    label: str,
    *,
    chosen: str,
    above: str = "predicted with parameters from all of the record",
    below: str = "held out: root mean square of each block",
) -> Draw:
    """Return a drawing of prediction errors over time, and below of held-out errors by block."""
    look = looks(series, chosen)

    def draw(figure: Figure, narrow: bool) -> None:
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[3, 2])
        for axes in (upper, lower):
            for edge in edges[1:-1]:
                axes.axvline(edge, color=LINE, linewidth=0.8, zorder=0)
        for name, one in series.items():
            colour, _, width, order = look[name]
            dashes = "-" if name == chosen else (0, (5, 2))
            upper.plot(
                one.t, one.error, color=colour, linestyle=dashes, linewidth=0.75 * width,
                zorder=order,
            )  # fmt: skip
            lower.stairs(
                one.blocks, edges, baseline=None, color=colour, linestyle=dashes, linewidth=width,
                zorder=order,
            )  # fmt: skip
        upper.axhline(0.0, color=MUTED, linewidth=0.8, zorder=0)
        upper.set_ylabel(label)
        upper.set_title(above, color=MUTED)
        lower.set_title(below, color=MUTED)
        top = max(float(np.nanmax(one.blocks)) for one in series.values())
        lower.set_ylim(0.0, (1.5 if _fit_one_line(series, narrow) else 1.9) * top)
        lower.set_xlim(edges[0], edges[-1])
        lower.set_xlabel("time, s")
        lower.set_ylabel(label)
        _name_lines(lower, series, chosen, {n: look[n].colour for n in series}, narrow)

    return draw


def _fit_one_line(names: Iterable[str], narrow: bool) -> bool:
    return LETTER * sum(len(name) + 2 for name in names) < (290 if narrow else 800)


def _name_lines(
    axes: Axes, names: Iterable[str], chosen: str, colours: Mapping[str, str], narrow: bool
) -> None:
    """Name the lines above all blocks, the chosen one at the left."""
    names = sorted(names, key=lambda name: name != chosen)
    step = 0.0 if _fit_one_line(names, narrow) else 0.18
    for index, name in enumerate(names):
        at = (0.01, 0.9) if index == 0 else (0.99, 0.9 - step)
        axes.annotate(
            name, at, xycoords="axes fraction", color=colours[name], fontsize=name_size(),
            ha="left" if index == 0 else "right", va="center",
        )  # fmt: skip
