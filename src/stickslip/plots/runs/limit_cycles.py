"""A motion that repeats itself: its progress, and one cycle of its velocity about zero."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.control import ClosedLoop, limit_cycle
from stickslip.errors import InputError
from stickslip.formatting import scale_of
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, on_panels
from stickslip.plots.core.helpers import LineStyle, Sizes, dense, looks, motion_names
from stickslip.plots.core.label_placement import Curve, label_curves
from stickslip.plots.core.modes import within
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import MUTED, shade
from stickslip.trajectory import Trajectory

CYCLE_SIZES: Final = Sizes(wide=(880, 320), narrow=(358, 480))

ROOM: Final = 1.35
"""Height of the velocity panel on either side of zero, as a multiple of the lowest velocity."""
SAMPLES: Final = 700


def draw_cycles(
    runs: Mapping[str, Trajectory],
    *,
    chosen: str,
    cycle: tuple[float, float],
    slip: str = "x",
    rate: str = "v",
) -> Draw:
    """Return a drawing of displacement in time, and of the velocity near zero within a cycle."""
    look = looks(runs, chosen)

    def draw(figure: Figure, narrow: bool) -> None:
        left, right = figure.subplots(*((2, 1) if narrow else (1, 2)))
        left.margins(x=0, y=0.25 if narrow else 0.12)
        _progress(left, {name: dense(run) for name, run in runs.items()}, slip, look)
        _near_zero(right, runs, chosen, cycle, rate, look)
        for axes in (left, right):
            axes.set_xlabel("time, s")

    return draw


def _progress(
    axes: Axes, runs: Mapping[str, Trajectory], slip: str, look: Mapping[str, LineStyle]
) -> None:
    everything = np.concatenate([run[slip] for run in runs.values()])
    factor, unit = scale_of(everything, next(iter(runs.values())).units[slip])
    curves = []
    for name, run in runs.items():
        colour, dashes, width, order = look[name]
        y = factor * run[slip]
        axes.plot(run.t, y, color=colour, linestyle=dashes, linewidth=width, zorder=order)
        curves.append(Curve(run.t, y, name, colour))
    axes.set_ylabel(f"displacement, {unit}")
    axes.grid(axis="y")
    label_curves(axes, curves)


def _near_zero(
    axes: Axes,
    runs: Mapping[str, Trajectory],
    chosen: str,
    cycle: tuple[float, float],
    rate: str,
    look: Mapping[str, LineStyle],
) -> None:
    first, last = cycle
    # Fixed steps are shown where they stand, so that one sees them.
    times = {
        name: [first, *run.t[(run.t > first) & (run.t < last)], last] for name, run in runs.items()
    }
    times[chosen] = list(np.union1d(np.linspace(first, last, SAMPLES), times[chosen]))
    inside = {name: run.at(times[name]) for name, run in runs.items()}
    reach = -ROOM * min(float(run[rate].min()) for run in inside.values())
    factor, unit = scale_of([reach], next(iter(runs.values())).units[rate])
    for name, run in inside.items():
        colour, _, width, order = look[name]
        axes.plot(
            run.t, factor * run[rate], "-" if name == chosen else "o-", color=colour,
            linewidth=width, markersize=2.5, zorder=order,
        )  # fmt: skip
    spans = [(max(low, first), high) for low, high in runs[chosen].stick_spans() if high > first]
    shade(axes, within(spans, last))
    axes.axhline(0.0, color=MUTED, linewidth=0.8, zorder=1)
    axes.set_xlim(first, last)
    if reach > 0.0:
        axes.set_ylim(-factor * reach, factor * reach)
    axes.set_ylabel(f"velocity{' near zero' if reach > 0.0 else ''}, {unit}")


def plot_limit_cycle(
    run: Trajectory | ClosedLoop,
    ax: PanelTarget = None,
    *,
    slip: str | None = None,
    rate: str | None = None,
) -> Panels:
    """Plot a run that repeats itself, and its velocity near zero in the last cycle.

    Parameters
    ----------
    run : Trajectory or ClosedLoop
        The run.
    ax : sequence of Axes, Figure or SubFigure, optional
        Two Axes; a new figure if not given.
    slip, rate : str, optional
        Names of the coordinate and its rate; the first ones of the run if not given.

    Returns
    -------
    array of Axes (2,)
        Displacement against time, and velocity near zero; times at rest are shaded.

    Raises
    ------
    InputError
        If the velocity has no limit cycle.

    Examples
    --------
    >>> from stickslip import Coulomb, TowedBlock, simulate
    >>> block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> panels = plot_limit_cycle(simulate(block, law, t_end=80.0), Figure())
    >>> first, last = panels[1].get_xlim()
    >>> round(float(last - first), 3)
    7.611
    """
    run = run.run if isinstance(run, ClosedLoop) else run
    check_type("run", run, Trajectory, ClosedLoop)
    slip, rate = motion_names(run, slip, rate)
    cycle = limit_cycle(run, rate)
    if not cycle.is_limit_cycle:
        how = "fewer than three cycles" if cycle.kind == "none" else f"a {cycle.kind} motion"
        raise InputError(
            f"{rate} has no limit cycle: the second half of the run has {how}; plot_run shows it."
        )
    end = run.span[1]
    draw = draw_cycles({"": run}, chosen="", cycle=(end - cycle.period, end), slip=slip, rate=rate)
    return on_panels(draw, ax, CYCLE_SIZES["wide"])
