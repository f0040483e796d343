"""A plot as a contributor would write it: work of friction over time."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.engine.trajectory import Trajectory
from stickslip.show.plots.axes import Target, on_axes
from stickslip.show.plots.svg import Draw


def draw_toy(run: Trajectory) -> Draw:
    """Return a drawing of the travel of a run."""

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        axes.plot(run.t, run["x"])
        axes.set_xlabel("time, s" if narrow else "time since the start, s")

    return draw


def plot_toy(run: Trajectory, ax: Target = None) -> Axes:
    """Plot the travel of a run."""
    return on_axes(draw_toy(run), ax, (700, 300))
