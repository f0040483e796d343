"""Pieces of a record beside their predictions, and what the predictions are off by."""

from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.formatting import scale_of
from stickslip.plots.core.helpers import Array, Sizes, labelled, looks
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import DATA, LINE, MUTED, name_size

DASHED: Final = (0, (5, 2))
LINE_HEIGHT = 13
"""Distance of names below each other [pt]."""


class Piece(NamedTuple):
    """A stretch of a record: its name, times [s], what was measured, and predictions by title."""

    name: str
    """Name of the stretch."""
    t: Array
    """Times (n,) [s]."""
    measured: Array
    """What was measured (n,)."""
    predicted: Mapping[str, Array]
    """Predictions (n,), by title of the law."""


def piece_sizes(count: int) -> Sizes:
    """Return the sizes of a figure of so many pieces.

    Examples
    --------
    >>> piece_sizes(2)["wide"]
    (880, 380)
    """
    return Sizes(wide=(880, 380), narrow=(358, 330 * count))


def draw_pieces(pieces: Sequence[Piece], quantity: str, unit: str, *, chosen: str) -> Draw:
    """Return a drawing of pieces of a record: measured and predicted above, errors below."""
    look = looks(pieces[0].predicted, chosen)
    factor, shown = scale_of(np.concatenate([one.measured for one in pieces]), unit)
    gaps = [one.measured - y for one in pieces for y in one.predicted.values()]
    by, small = scale_of(np.concatenate(gaps), unit)

    def draw(figure: Figure, narrow: bool) -> None:
        for (above, below), one in zip(_places(figure, len(pieces), narrow), pieces, strict=True):
            above.plot(
                one.t, factor * one.measured, "o", color=DATA, markersize=2.5, alpha=0.6,
                markeredgewidth=0, zorder=1,
            )  # fmt: skip
            for name, y in one.predicted.items():
                style: dict[str, Any] = {
                    "color": look[name].colour, "linewidth": 0.75 * look[name].width,
                    "linestyle": "-" if name == chosen else DASHED, "zorder": look[name].order,
                }  # fmt: skip
                above.plot(one.t, factor * y, **style)
                below.plot(one.t, by * (one.measured - y), **style)
            above.set_title(one.name, color=MUTED)
            above.set_ylabel(labelled(quantity, shown))
            below.set_ylabel(labelled("error", small))
            below.axhline(0.0, color=LINE, linewidth=0.8, zorder=0)
            below.set_xlabel("time, s")
            below.margins(x=0.01, y=0.3)
        _name(below, {name: look[name].colour for name in look}, chosen)

    return draw


def _places(figure: Figure, count: int, narrow: bool) -> list[tuple[Axes, Axes]]:
    """Return for each piece the panel of values and that of errors; errors share one range."""
    if narrow:
        grid = figure.subplots(2 * count, 1, height_ratios=[3, 2] * count, squeeze=False)[:, 0]
        pairs = [(grid[2 * k], grid[2 * k + 1]) for k in range(count)]
    else:
        grid = figure.subplots(2, count, height_ratios=[3, 2], squeeze=False)
        pairs = [(grid[0, k], grid[1, k]) for k in range(count)]
    for above, below in pairs:
        below.sharex(above)
        if below is not pairs[0][1]:
            below.sharey(pairs[0][1])
    return pairs


def _name(axes: Axes, colours: Mapping[str, str], chosen: str) -> None:
    """Name the lines in the last panel, the chosen one above, the others in a column below."""
    others = [name for name in colours if name != chosen]
    for name, colour in colours.items():
        above = name == chosen
        axes.annotate(
            name, (0.99, 0.97 if above else 0.03), xycoords="axes fraction", color=colour,
            xytext=(0, 0 if above else LINE_HEIGHT * others.index(name)),
            textcoords="offset points", fontsize=name_size(), ha="right",
            va="top" if above else "bottom",
        )  # fmt: skip
