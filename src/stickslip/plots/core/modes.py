"""What a figure of a run says about its modes and events: words, markers, a raster of contacts."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes

from stickslip.plots.core.label_placement import LETTER
from stickslip.plots.core.theme import INK, MUTED, name_size
from stickslip.trajectory import Event, Trajectory

MOST_NAMED: Final = 4


def within(spans: Sequence[tuple[float, float]], last: float) -> list[tuple[float, float]]:
    """Return the spans up to a time."""
    return [(low, min(high, last)) for low, high in spans if low < last]


def name_modes(axes: Axes, run: Trajectory, last: float) -> None:
    """Write "stick" and "slip" once, each in the longest stretch of its mode."""
    sticks = within(run.stick_spans(), last)
    if not sticks:
        return
    bounds = [run.span[0], *[end for span in sticks for end in span], last]
    slips = list(zip(bounds[::2], bounds[1::2], strict=True))
    for word, spans in (("stick", sticks), ("slip", slips)):
        low, high = max(spans, key=lambda span: span[1] - span[0])
        if high - low > 0.05 * (last - run.span[0]):
            axes.annotate(
                word,
                ((low + high) / 2, 1.03),
                xycoords=axes.get_xaxis_transform(),
                ha="center",
                va="bottom",
                color=MUTED,
                fontsize=name_size(),
            )


def name_events(axes: Axes, events: Sequence[Event], narrow: bool) -> None:
    """Say in words what each kind of event is, above the panel and at the first of its kind."""
    first = {event.reason: event for event in reversed(events)}
    if not first or len(first) > MOST_NAMED:
        return
    low, high = axes.get_xlim()
    letter = LETTER * (high - low) / (280 if narrow else 800)
    free_from = low
    for reason, event in sorted(first.items(), key=lambda item: item[1].t):
        width = letter * (len(reason) + 2)
        fits = event.t + width < high
        start = event.t if fits else event.t - width
        if start < free_from:
            continue
        free_from = start + width
        axes.axvline(event.t, color=MUTED, linewidth=0.8, linestyle=(0, (2, 2)), zorder=1)
        axes.annotate(
            reason,
            (event.t, 1.03),
            xycoords=axes.get_xaxis_transform(),
            ha="left" if fits else "right",
            va="bottom",
            color=INK,
            fontsize=name_size(),
        )


def raster(axes: Axes, seen: Trajectory, colours: Mapping[int, str]) -> None:
    """Draw a row for each contact: when it slips, sticks, or is open."""
    edges = np.append(seen.t, seen.t[-1])
    rows = np.arange(len(seen.contacts) + 1)
    modes = np.array([np.rint(seen[f"mode:{name}"]) for name in seen.contacts])
    for row, own in enumerate(modes):
        begins = np.flatnonzero(np.append(True, own[1:] != own[:-1]))
        ends = np.append(begins[1:], own.size)
        for mode, colour in colours.items():
            spans = [
                (float(edges[i]), float(edges[k] - edges[i]))
                for i, k in zip(begins, ends, strict=True)
                if own[i] == mode
            ]
            axes.broken_barh(spans, (row, 1.0), facecolor=colour, linewidth=0.0)
    axes.set_xlim(float(edges[0]), float(edges[-1]))
    axes.set_ylim(0.0, float(rows[-1]))
    axes.set_yticks(rows[:-1] + 0.5, seen.contacts, fontsize="x-small")
    axes.invert_yaxis()
