"""The figure of a verdict: what was measured, the band, and the law."""

import math
from typing import TYPE_CHECKING

import numpy as np

from stickslip.formatting import scale_of
from stickslip.identify.problem import Array
from stickslip.plots import C1, C3, DATA, on_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stickslip.display import Drawing, Target
    from stickslip.identify.verdict import BandVerdict
    from stickslip.plots import Draw

SIZE = (8.0, 3.4)
"""Size of the plot [in]."""
DECADES = 30.0
"""Ratio of the fastest to the slowest speed from which the axis is logarithmic."""
LOADS = 4
"""Loads that are drawn at most."""
MARKERS = ("o", "s", "^", "D")


def draw_band_verdict(verdict: "BandVerdict") -> "Draw":
    """Return a drawing of readings, the band of friction, the named law and proposed readings."""
    problem = verdict.judgement.problem
    rows, friction = problem.rows, problem.response
    v = np.asarray(rows.velocity)
    speeds = np.abs(v[v != 0.0])
    logarithmic = float(speeds.max() / speeds.min()) > DECADES and not (v.min() < 0.0 < v.max())
    measurement = verdict.measurement
    factor, unit = scale_of([float(speeds.max())], measurement.unit("velocity"))
    force, force_unit = scale_of(np.abs(friction).tolist(), measurement.unit("friction"))
    weights = verdict.judgement.regression.weights
    light = weights < 0.3 * float(np.median(weights))

    def draw(figure: "Figure", narrow: bool) -> None:
        axes = figure.add_subplot()
        x = factor * verdict.speeds
        for part in _directions(verdict.speeds):
            band = verdict.friction
            axes.fill_between(
                x[part], force * band.low[part], force * band.high[part], color=C1,
                alpha=0.18, linewidth=0, label="95 % band, whichever law holds" if part[0] == 0
                else None,
            )  # fmt: skip
            law = force * verdict.named_curve(verdict.speeds[part])
            axes.plot(x[part], law, color=C1, label=verdict.closest.title
                      if part[0] == 0 else None)  # fmt: skip
        for k, load in enumerate(_loads(rows.load)):
            at = np.isclose(rows.load, load, rtol=0.05) if load else np.ones(len(v), dtype=bool)
            marker = MARKERS[k % len(MARKERS)]
            label = f"readings at {load:.3g} N" if load else "readings"
            kept = at & ~light
            axes.plot(factor * v[kept], force * friction[kept], marker, color=DATA,
                      markersize=4.5, linestyle="none", label=label)  # fmt: skip
            axes.plot(
                factor * v[at & light],
                force * friction[at & light],
                marker,
                color=DATA,
                fillstyle="none",
                markersize=4.5,
                linestyle="none",
            )
        for place in dict.fromkeys(verdict.places):
            axes.axvline(factor * place, color=C3, linewidth=0.8, linestyle=(0, (2, 3)))
        if logarithmic:
            axes.set_xscale("log" if v.max() > 0.0 else "symlog")
        axes.grid(axis="y")
        axes.set_xlabel(f"velocity, {unit}")
        axes.set_ylabel(f"friction, {force_unit}")
        axes.legend(loc="best", fontsize="small" if narrow else None, frameon=False)

    return draw


def _directions(speeds: Array) -> list[Array]:
    """Return the places of the speeds of each direction."""
    sides = (speeds < 0.0, speeds > 0.0)
    return [np.flatnonzero(side) for side in sides if side.any()]


def _loads(load: Array) -> list[float]:
    """Return the loads that are drawn apart; one 0 if there is but one."""
    known = np.unique(np.round(np.log(load), 2))
    if len(known) == 1:
        return [0.0]
    step = math.ceil(len(known) / LOADS)
    return [float(math.exp(one)) for one in known[::step]]


def plot_band_verdict(verdict: "BandVerdict", ax: "Target" = None) -> "Drawing":
    """Plot what was measured, the band of friction, and the law that is named."""
    axes: Axes = on_axes(draw_band_verdict(verdict), ax, SIZE)
    return axes
