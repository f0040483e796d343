"""Figures of a run with several contacts."""

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.formatting import scale_of
from stickslip.plots.core.helpers import Sizes, dense
from stickslip.plots.core.modes import raster, within
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, C2, C3, C4, MUTED, SURFACE, shade
from stickslip.sweep import Band
from stickslip.trajectory import UNLOADED, Trajectory

MOST_PANELS: Final = 6
"""Contacts that have a panel of friction each; the modes of more are shown as a raster."""
STATE_SIZES: Final = Sizes(wide=(880, 380), narrow=(358, 320))
SERIES: Final = (C1, C2, C3, C4)
"""Colours of coordinates; more than these are not told apart."""
PANEL: Final = 130
"""Height of a panel [px]."""


def contact_sizes(run: Trajectory) -> Sizes:
    """Return the sizes of the figure: a panel for each contact, or the raster."""
    panels = len(run.contacts) or 1
    height = 60 + PANEL * panels if panels <= MOST_PANELS else min(160 + 12 * panels, 900)
    return Sizes(wide=(880, height), narrow=(358, height))


def draw_contacts(run: Trajectory, *, until: float | None = None) -> Draw:
    """Return a drawing of friction at each contact against time."""
    last = run.span[1] if until is None else min(until, run.span[1])
    seen = dense(run, last)

    def draw(figure: Figure, narrow: bool) -> None:
        if len(run.contacts) > MOST_PANELS:
            _raster(figure.subplots(), seen, narrow)
            return
        names = run.contacts or (run.only_contact,)
        panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for axes, name in zip(panels, names, strict=True):
            _friction(axes, run.contact(name), seen.contact(name), name, last)
        figure.align_ylabels()
        panels[-1].set_xlabel("time, s")

    return draw


def draw_states(run: Trajectory, *, band: Band | None = None) -> Draw:
    """Return a drawing of all coordinates against time, those of one unit together."""
    seen = dense(run, run.span[1])
    units: dict[str, list[str]] = {}
    for name in run.states:
        if run.units[name] in ("m", "rad") and ":" not in name:
            units.setdefault(run.units[name], []).append(name)
    times = sorted({event.t for event in run.events})

    def draw(figure: Figure, narrow: bool) -> None:
        panels = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
        for axes, names in zip(panels, units.values(), strict=True):
            _coordinates(axes, run, seen, names, times, band, narrow=narrow)
        figure.align_ylabels()
        panels[-1].set_xlabel("time, s")

    return draw


def shade_band(
    axes: Axes, band: Band, name: str, last: float, *, factor: float, colour: str
) -> None:
    """Show pale where 95 % of the runs of a band lie."""
    shown = band.t <= last
    low, _, high = factor * band.states[name][:, shown]
    axes.fill_between(band.t[shown], low, high, color=colour, alpha=0.22, linewidth=0)


def _coordinates(
    axes: Axes,
    run: Trajectory,
    seen: Trajectory,
    names: list[str],
    times: list[float],
    band: Band | None,
    *,
    narrow: bool,
) -> None:
    """Draw coordinates of one unit; those of a few are named, many are curves of one colour."""
    factor, unit = scale_of(np.concatenate([seen[name] for name in names]), run.units[names[0]])
    at = run.at(times)
    few = len(names) <= len(SERIES)
    for i, name in enumerate(names):
        colour = SERIES[i] if few else MUTED
        width = 1.8 if few else 0.9
        axes.plot(seen.t, factor * seen[name], color=colour, linewidth=width, label=name)
        if band is not None and name in band.states:
            shade_band(axes, band, name, seen.span[1], factor=factor, colour=colour)
        if few:
            axes.plot(times, factor * at[name], "o", color=colour, markersize=3.5, zorder=4)
    what = names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}"
    axes.set_ylabel(f"{what}, {unit}")
    axes.margins(x=0, y=0.1)
    axes.grid(axis="y")
    if few and len(names) > 1:
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            ncols=2 if narrow else len(names),
            frameon=False,
        )


def _friction(axes: Axes, own: Trajectory, seen: Trajectory, name: str, last: float) -> None:
    """Draw the friction of one contact."""
    factor, unit = scale_of(seen["friction"], seen.units["friction"])
    axes.plot(seen.t, factor * seen["friction"], color=C1, linewidth=1.8)
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
    """Draw the raster with what its colours mean."""
    raster(axes, seen, {-1: C2, 0: MUTED, 1: C1})
    axes.set_xlabel("time, s")
    modes = [np.rint(seen[f"mode:{name}"]) for name in seen.contacts]
    meanings = {"slip backward": C2, "stick": MUTED, "slip forward": C1}
    if np.any(np.array(modes) == UNLOADED):
        meanings["open"] = SURFACE
    for label, colour in meanings.items():
        axes.plot([], [], "s", color=colour, markeredgecolor=MUTED, label=label)
    axes.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=2 if narrow else len(meanings),
        frameon=False,
        fontsize="small" if narrow else "medium",
    )
