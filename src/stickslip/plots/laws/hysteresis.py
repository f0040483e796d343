"""Friction against displacement: measured loops, and those of laws along the same motion."""

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from stickslip.formatting import scale_of
from stickslip.plots.core.helpers import Array, Sizes, looks, wrapped
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import DATA, LINE

WIDTH: Final = 34
"""Letters of a line of a name."""


class Loop(NamedTuple):
    """Once to and fro: displacements [m], measured friction [N], that of each law by its title."""

    displacement: Array
    """Displacements (n,) [m]."""
    measured: Array
    """Measured friction (n,) [N]."""
    predicted: Mapping[str, Array]
    """Friction (n,) [N] of each law, by its title."""


def loop_sizes(count: int) -> Sizes:
    """Return the sizes of a figure of the loops of so many laws.

    Examples
    --------
    >>> loop_sizes(2)["narrow"]
    (358, 560)
    """
    return Sizes(wide=(880, 300), narrow=(358, 280 * count))


def draw_loops(loops: Sequence[Loop], *, chosen: str, units: tuple[str, str] = ("m", "N")) -> Draw:
    """Return a drawing of friction against displacement, one panel for each law."""
    names = sorted(loops[0].predicted, key=lambda name: name != chosen)
    look = looks(names, chosen)
    factor, unit = scale_of(np.concatenate([one.displacement for one in loops]), units[0])

    def draw(figure: Figure, narrow: bool) -> None:
        shape = (len(names), 1) if narrow else (1, len(names))
        panels = figure.subplots(*shape, squeeze=False, sharex=True, sharey=True)
        for axes, name in zip(panels.flat, names, strict=True):
            colour, _, width, _ = look[name]
            dashes = "-" if name == chosen else (0, (5, 2))
            for one in loops:
                x = factor * one.displacement
                axes.plot(
                    x, one.measured, "o", color=DATA, markersize=2.5, alpha=0.6,
                    markeredgewidth=0, zorder=1,
                )  # fmt: skip
                axes.plot(
                    x, one.predicted[name], color=colour, linestyle=dashes, linewidth=0.75 * width,
                    zorder=3,
                )  # fmt: skip
            axes.axhline(0.0, color=LINE, linewidth=0.8, zorder=0)
            axes.set_title(
                "\n".join(wrapped(name.split(" "), WIDTH)).replace(",", ""), color=colour
            )
            axes.margins(x=0.03)
        for axes in panels[-1]:
            axes.set_xlabel(f"displacement, {unit}")
        for row in panels:
            row[0].set_ylabel(f"friction, {units[1]}")

    return draw
