"""Displacement and velocity of several runs side by side."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.formatting import scale_of
from stickslip.plots.core.helpers import dense, grouped, horizon, looks, wrapped
from stickslip.plots.core.label_placement import label_ends
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import MUTED
from stickslip.trajectory import Trajectory

__all__ = ["draw_motion"]


def draw_motion(
    runs: Mapping[str, Trajectory],
    *,
    slip: str = "x",
    rate: str = "v",
    chosen: str | None = None,
    until: float | None = None,
) -> Draw:
    """Return a drawing of displacement and velocity against time, runs named where they end.

    Parameters
    ----------
    runs : mapping of str to Trajectory
        The runs by name.
    slip, rate : str
        Names of the slipping coordinate and its rate.
    chosen : str, optional
        The run that stands out; the first if not given.
    until : float, optional
        Last time shown [s].

    Returns
    -------
    callable
        Draws it: beside each other where there is room, else one below the other.
    """
    last = until or max(horizon(run, slip) for run in runs.values())
    seen = {name: dense(run, last) for name, run in runs.items()}
    look = looks(runs, chosen)

    def panel(axes: Axes, column: str, title: str) -> dict[str, float]:
        everything = np.concatenate([run[column] for run in seen.values()])
        factor, unit = scale_of(everything, next(iter(runs.values())).units[column])
        for name, run in seen.items():
            colour, dashes, width, order = look[name]
            axes.plot(
                run.t, factor * run[column], color=colour, linestyle=dashes, linewidth=width,
                zorder=order,
            )  # fmt: skip
        axes.margins(x=0, y=0.1)
        axes.set_xlabel("time, s")
        axes.set_ylabel(f"{title}, {unit}")
        axes.grid(axis="y")
        return {name: float(factor * run[column][-1]) for name, run in seen.items()}

    def draw(figure: Figure, narrow: bool) -> None:
        shape = (2, 1) if narrow else (1, 2)
        left, right = figure.subplots(*shape)
        ends = panel(left, slip, "displacement")
        panel(right, rate, "velocity")
        right.axhline(0.0, color=MUTED, linewidth=0.8, zorder=0)
        labels = [
            (y, wrapped(names, 14 if narrow else 18), look[names[0]].colour)
            for y, names in grouped(ends, 0.02 * float(np.ptp(left.get_ylim())))
        ]
        label_ends(left, last, labels)

    return draw
