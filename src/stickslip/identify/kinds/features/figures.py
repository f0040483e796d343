"""The force of a spring that pulls a block: the record, and some cycles beside a simulated one."""

from collections.abc import Sequence
from typing import Final, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec

from stickslip.show.plots import C1, DATA, INK, MUTED, SLIP_BACK, Array, Draw, Sizes

PULL_SIZES: Final = Sizes(wide=(880, 430), narrow=(358, 620))


class Half(NamedTuple):
    """A part of the record: first and last time [s] and mean of the force over the load."""

    start: float
    """First time [s]."""
    end: float
    """Last time [s]."""
    mean: float
    """Mean of the force over the load."""


class Excerpt(NamedTuple):
    """Some cycles: a name, measured and simulated force over the load, times [s] from 0."""

    name: str
    """Name of the excerpt."""
    time: Array
    """Times (n,) of the samples [s]."""
    measured: Array
    """Measured force (n,) over the load."""
    simulated_time: Array
    """Times (m,) of the simulation [s]."""
    simulated: Array
    """Simulated force (m,) over the load."""


def draw_pull(
    time: Array, force: Array, halves: Sequence[Half], excerpts: Sequence[Excerpt]
) -> Draw:
    """Return a drawing of a record of pulling and of excerpts beside a limit cycle.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0.0, 1.0, 50)
    >>> cycles = Excerpt("all", t, np.sin(9 * t), t, np.sin(9 * t))
    >>> figure = Figure()
    >>> draw_pull(t, np.sin(9 * t), [Half(0.0, 1.0, 0.0)], [cycles])(figure, False)
    >>> len(figure.axes)
    2
    """

    def draw(figure: Figure, narrow: bool) -> None:
        rows, columns = (1 + len(excerpts), 1) if narrow else (2, len(excerpts))
        grid = GridSpec(rows, columns, figure=figure)
        _record(figure.add_subplot(grid[0, :]), time, force, halves)
        first: Axes | None = None
        for i, one in enumerate(excerpts):
            place = grid[1 + i, 0] if narrow else grid[1, i]
            first = figure.add_subplot(place, sharey=first)
            _excerpt(first, one)
            first.tick_params(labelleft=narrow or i == 0)

    return draw


def _record(axes: Axes, time: Array, force: Array, halves: Sequence[Half]) -> None:
    axes.plot(time, force, color=DATA, linewidth=0.7)
    for i, half in enumerate(halves):
        if i % 2:
            axes.axvspan(half.start, half.end, color=SLIP_BACK, linewidth=0.0, zorder=0)
        axes.plot([half.start, half.end], [half.mean] * 2, color=INK, linewidth=1.6, zorder=4)
        middle = 0.5 * (half.start + half.end)
        axes.annotate(
            f"mean {half.mean:.3f}",
            (middle, 0.97),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="top",
            color=INK,
            zorder=5,
        )
    axes.set_title("spring force over load, whole record", color=MUTED)
    axes.set_xlabel("time, s")
    axes.margins(x=0.0, y=0.2)  # room for the means above


def _excerpt(axes: Axes, one: Excerpt) -> None:
    axes.plot(one.time, one.measured, ".", color=DATA, markersize=3.5, label="measured")
    axes.plot(one.simulated_time, one.simulated, color=C1, linewidth=1.5, label="simulated")
    axes.set_title(one.name, color=MUTED)
    axes.set_xlabel("time, s")
    axes.margins(x=0.0, y=0.1)
    axes.locator_params(axis="y", nbins=5)
