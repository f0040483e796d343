"""Several runs in one figure: displacement, velocity, a closer look, and their differences."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.errors import InputError
from stickslip.formatting import number, scale_of
from stickslip.plots.core.helpers import Array, dense, horizon, looks
from stickslip.plots.core.label_placement import Curve, label_curves, label_ends
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import MUTED
from stickslip.trajectory import Trajectory

CLOSE: Final = 6000
"""Samples of a run that is shown in part: so many that a tenth of it is still smooth."""
MOST_BESIDE: Final = 2
"""Panels side by side that leave room for names where the curves end."""


@final
@dataclass(frozen=True, kw_only=True)
class MotionView:
    """What one panel shows."""

    column: str
    """Name of the coordinate or rate."""
    title: str
    """Title of the panel."""
    span: tuple[float, float] | None = None
    """First and last time [s]; all that is shown if not given."""
    difference: bool = False
    """Whether differences from the chosen run are drawn."""


MOTION: Final = (
    MotionView(column="x", title="displacement"),
    MotionView(column="v", title="velocity"),
)


def draw_motion(
    runs: Mapping[str, Trajectory],
    *,
    views: Sequence[MotionView] = MOTION,
    chosen: str | None = None,
    levels: Mapping[str, float] | None = None,
) -> Draw:
    """Return a drawing of runs against time, by default of displacement and velocity."""
    last = max(horizon(run, views[0].column) for run in runs.values())
    for view in views:
        _check(view, runs)
    look = looks(runs, chosen)
    chosen = next(iter(runs)) if chosen is None else chosen
    levels = levels or {}

    def panel(axes: Axes, view: MotionView, marks: Mapping[str, float]) -> list[Curve]:
        series = _series(runs, view, last, chosen)
        everything = np.concatenate([*(y for _, y in series.values()), [*marks.values()]])
        factor, unit = scale_of(everything, next(iter(runs.values())).units[view.column])
        curves = []
        for name, (t, y) in series.items():
            colour, dashes, width, order = look[name]
            axes.plot(t, factor * y, color=colour, linestyle=dashes, linewidth=width, zorder=order)
            curves.append(Curve(t, factor * y, name, colour))
        for name, level in marks.items():
            axes.axhline(factor * level, color=MUTED, linewidth=1.0, linestyle=(0, (5, 4)))
            ends = np.array(axes.dataLim.intervalx)
            curves.append(Curve(ends, np.full(2, factor * level), name, MUTED))
        axes.margins(x=0, y=0.1)
        axes.set_xlabel("time, s")
        axes.set_ylabel(f"{view.title}, {unit}")
        axes.grid(axis="y")
        if np.min(everything) < 0.0 or view.column != views[0].column:
            axes.axhline(0.0, color=MUTED, linewidth=0.8, zorder=0)
        return curves

    def draw(figure: Figure, narrow: bool) -> None:
        shape = (len(views), 1) if narrow else (1, len(views))
        panels = np.ravel(figure.subplots(*shape))
        named = panel(panels[0], views[0], levels)
        for axes, view in zip(panels[1:], views[1:], strict=True):
            panel(axes, view, {})
        if not narrow and len(views) > MOST_BESIDE:
            for axes in panels:
                axes.locator_params(axis="x", nbins=5)
        if narrow or len(views) > MOST_BESIDE:
            panels[0].margins(x=0, y=0.2)
            # The broad line is found without its name, so that the others choose first.
            label_curves(panels[0], sorted(named, key=lambda curve: curve.text == chosen))
        else:
            label_ends(
                panels[0],
                panels[0].get_xlim()[1],
                [(float(one.y[-1]), [one.text], one.colour) for one in named],
            )

    return draw


def _check(view: MotionView, runs: Mapping[str, Trajectory]) -> None:
    if view.span is None:
        return
    first, end = view.span
    known = min(run.span[1] for run in runs.values())
    if not first < end or first >= known:
        raise InputError(
            f"span of {view.title!r} must begin before it ends and before {number(known)} s, the"
            f" end of a run; got {number(first)} to {number(end)} s."
        )


def _series(
    runs: Mapping[str, Trajectory], view: MotionView, last: float, chosen: str
) -> dict[str, tuple[Array, Array]]:
    """Return times and values of each run, or its difference from the chosen one."""
    if view.span is None:
        seen = {name: dense(run, last) for name, run in runs.items()}
    else:
        first, end = view.span
        close = {name: dense(run, end, CLOSE) for name, run in runs.items()}
        seen = {name: run.at(run.t[run.t >= first]) for name, run in close.items()}
    if not view.difference:
        return {name: (run.t, run[view.column]) for name, run in seen.items()}
    found = {}
    for name in runs:
        if name != chosen:
            t = np.union1d(seen[name].t, seen[chosen].t)
            t = t[t <= min(runs[name].span[1], runs[chosen].span[1])]
            found[name] = t, runs[name].at(t)[view.column] - runs[chosen].at(t)[view.column]
    return found
