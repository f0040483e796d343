"""Velocity around the stop: the exact run, and what a fixed step makes of it."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.formatting import scale_of
from stickslip.plots.core.axes import panel_grid
from stickslip.plots.core.helpers import Sizes
from stickslip.plots.core.label_placement import Curve, label_curves
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, C2, MUTED
from stickslip.trajectory import Trajectory

STEPS_SHOWN: Final = 9
"""Steps before and after the stop: chatter is as high as the velocity lost in one or two."""
COLUMNS: Final = 2


def fixed_step_sizes(count: int) -> Sizes:
    """Return the sizes of a figure of that many fixed-step runs.

    Examples
    --------
    >>> fixed_step_sizes(4)["wide"]
    (880, 420)
    """
    rows = -(-count // COLUMNS)
    return Sizes(wide=(880, 40 + 190 * rows), narrow=(358, 40 + 165 * count))


def draw_fixed_steps(
    exact: Trajectory, fixed: Mapping[str, Trajectory], *, rate: str = "v"
) -> Draw:
    """Return a drawing of the velocity around the stop, a panel for each fixed-step run.

    Parameters
    ----------
    exact : Trajectory
        The event-driven run.
    fixed : mapping of str to Trajectory
        Fixed-step runs by what they are called, such as "10 ms, no stick rule".
    rate : str
        Name of the slip velocity.

    Returns
    -------
    callable
        Draws it; each panel covers the same number of steps, so that chatter is as wide.
    """
    found = next((e.t for e in reversed(exact.events) if e.to_mode == 0), None)
    stop = exact.span[1] if found is None else found

    def draw(figure: Figure, narrow: bool) -> None:
        columns = 1 if narrow else min(COLUMNS, len(fixed))
        panels = panel_grid(figure, len(fixed), columns)
        for index, (axes, (label, run)) in enumerate(zip(panels, fixed.items(), strict=True)):
            axes.set_title(label)
            _panel(axes, exact, run, stop, rate, named=index == 0)
        for axes in panels[-columns:]:
            origin = "end of the run" if found is None else "exact stop"
            axes.set_xlabel(f"time from the {origin}, ms")

    return draw


def _panel(
    axes: Axes, exact: Trajectory, run: Trajectory, stop: float, rate: str, *, named: bool
) -> None:
    step = float(np.median(np.diff(run.t))) if len(run.t) > 1 else exact.span[1] - stop
    first = max(stop - STEPS_SHOWN * step, exact.span[0])
    last = min(stop + 2 * STEPS_SHOWN * step, exact.span[1])
    inside = (run.t >= first) & (run.t <= last)
    seen = exact.at(np.union1d(np.linspace(first, last, 300), [min(max(stop, first), last)]))
    v, v_exact = run[rate][inside], seen[rate]
    factor, unit = scale_of(np.concatenate([v, v_exact]), exact.units[rate])
    curves = [
        Curve(1e3 * (seen.t - stop), factor * v_exact, "exact", C1),
        Curve(1e3 * (run.t[inside] - stop), factor * v, "fixed step", C2),
    ]
    axes.axhline(0, color=MUTED, linewidth=0.8, zorder=1)
    axes.plot(curves[0].x, curves[0].y, color=C1, linewidth=2.2, zorder=2)
    axes.plot(curves[1].x, curves[1].y, "o-", color=C2, linewidth=1.2, markersize=3.5, zorder=3)
    axes.set_ylabel(f"velocity, {unit}")
    axes.margins(x=0.01, y=0.18)
    if named:
        label_curves(axes, curves)
