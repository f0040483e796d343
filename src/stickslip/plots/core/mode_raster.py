"""A raster of the modes of several contacts against time."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from stickslip.trajectory import Trajectory


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
