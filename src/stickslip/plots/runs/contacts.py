"""Figures of a run with several contacts."""

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from stickslip.formatting import scale_of
from stickslip.plots.core.event_markers import within
from stickslip.plots.core.helpers import Sizes, dense
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, C2, MUTED, SURFACE, shade
from stickslip.trajectory import Trajectory

__all__ = ["contact_sizes", "draw_contacts"]

MOST_PANELS: Final = 6
"""Contacts that have a panel of friction each; the modes of more are shown as a raster."""
PANEL: Final = 130
"""Height of a panel [px]."""


def contact_sizes(run: Trajectory) -> Sizes:
    """Return the sizes of the figure: a panel for each contact, or the raster."""
    panels = len(run.contacts)
    height = 60 + PANEL * panels if panels <= MOST_PANELS else min(160 + 12 * panels, 900)
    return Sizes(wide=(880, height), narrow=(358, height))


def draw_contacts(run: Trajectory, *, until: float | None = None) -> Draw:
    """Return a drawing of friction at each contact against time.

    Parameters
    ----------
    run : Trajectory
        A run with several contacts.
    until : float, optional
        Last time shown [s]; the end of the run if not given.

    Returns
    -------
    callable
        Draws it, with bands where a contact sticks and dots at its events. More than six contacts
        are drawn as a raster of their modes.
    """
    last = run.span[1] if until is None else min(until, run.span[1])
    seen = dense(run, last)

    def draw(figure: Figure, narrow: bool) -> None:
        if len(run.contacts) > MOST_PANELS:
            _raster(figure.subplots(), seen, narrow)
            return
        panels = figure.subplots(len(run.contacts), 1, sharex=True)
        for axes, name in zip(panels, run.contacts, strict=True):
            _friction(axes, run.contact(name), seen, name, last)
        figure.align_ylabels()
        panels[-1].set_xlabel("time, s")

    return draw


def _friction(axes: Axes, own: Trajectory, seen: Trajectory, name: str, last: float) -> None:
    """Draw the friction of one contact."""
    column = f"friction:{name}"
    factor, unit = scale_of(seen[column], seen.units[column])
    axes.plot(seen.t, factor * seen[column], color=C1, linewidth=1.8)
    axes.set_ylabel(f"friction, {unit}")
    axes.set_title(name, loc="left", fontsize="medium")
    axes.margins(x=0, y=0.15)
    axes.grid(axis="y")
    shade(axes, within(own.stick_spans(), last))
    events = [event for event in own.events if event.t <= last]
    if events:
        at = own.at([event.t for event in events])
        axes.plot(at.t, factor * at["friction"], "o", color=C1, markersize=4, zorder=4)


def _raster(axes: Axes, seen: Trajectory, narrow: bool) -> None:
    """Draw the mode of each contact over time: slip backward, stick, slip forward, open."""
    modes = np.array([seen[f"mode:{name}"] for name in seen.contacts])
    colours = ListedColormap([C2, MUTED, C1, SURFACE])
    edges = np.append(seen.t, seen.t[-1])
    rows = np.arange(len(seen.contacts) + 1)
    axes.pcolormesh(edges, rows, modes, cmap=colours, vmin=-1.5, vmax=2.5, rasterized=True)
    axes.set_yticks(rows[:-1] + 0.5, seen.contacts, fontsize="x-small")
    axes.invert_yaxis()
    axes.set_xlabel("time, s")
    for colour, label in ((C2, "slip backward"), (MUTED, "stick"), (C1, "slip forward")):
        axes.plot([], [], "s", color=colour, label=label)
    axes.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=3,
        frameon=False,
        fontsize="small" if narrow else "medium",
    )
