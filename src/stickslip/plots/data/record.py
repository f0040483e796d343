"""A record in time: what was measured, one panel below the other."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from stickslip.formatting import Scale, scale_of
from stickslip.plots.core.helpers import Array
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import DATA, INK, MUTED, SLIP_BACK, shade

PANEL: Final = 90
"""Height of a panel [CSS px]."""


class Channel(NamedTuple):
    """A quantity of a record: its name, SI unit, times and values."""

    name: str
    """Name of the quantity."""
    unit: str
    """Its SI unit."""
    t: Array
    """Times (n,) [s]."""
    values: Array
    """Values (n,) [SI]."""
    scale: Scale | None = None
    """What they are shown in; the largest chooses if not given."""


def draw_record(channels: Sequence[Channel], reverse: Sequence[tuple[float, float]] = ()) -> Draw:
    """Return a drawing of a record against time."""

    def draw(figure: Figure, narrow: bool) -> None:  # noqa: ARG001
        panels = figure.subplots(len(channels), 1, sharex=True, squeeze=False)[:, 0]
        for axes, channel in zip(panels, channels, strict=True):
            factor, unit = channel.scale or scale_of(channel.values, channel.unit)
            shade(axes, reverse, colour=SLIP_BACK)
            axes.plot(channel.t, factor * channel.values, color=INK, linewidth=1.1)
            axes.set_title(f"{channel.name}, {unit}", color=MUTED)
            axes.margins(x=0.0, y=0.1)
            if np.min(channel.values) < 0.0 < np.max(channel.values):
                axes.axhline(0.0, color=DATA, linewidth=0.6, zorder=1)
            axes.locator_params(axis="y", nbins=4)
        panels[-1].set_xlabel("time, s")

    return draw
