"""The force: what was measured beside the fitted limit cycle."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.formatting import quantity
from stickslip.identification import FeatureFit, towed_load
from stickslip.plots import PULL_SIZES, Excerpt, Half, draw_pull, inline_svg, thinned
from stickslip.report.core.blocks import Figure
from stickslip.report.core.documents import Section
from stickslip.selection import FeatureVerdict

Array: TypeAlias = NDArray[np.float64]

CYCLES = 8
"""Cycles of the record that an excerpt shows."""
SHIFTS = 64
"""Phases of the limit cycle that are tried, of which the nearest is drawn."""
MOST = 1500


def force_section(verdict: FeatureVerdict) -> Section | None:
    """Return the section with the measured and the simulated force."""
    fit = verdict.best.fit if verdict.best else None
    if fit is None or fit.held_out is None:
        return None
    load = towed_load(fit.mechanism)
    time, force = np.asarray(fit.measurement.time), np.asarray(fit.measurement.spring_force) / load
    middle = len(time) // 2
    halves = [
        Half(float(time[0]), float(time[middle - 1]), fit.observed.mean),
        Half(float(time[middle]), float(time[-1]), fit.held_out.mean),
    ]
    excerpts = [
        _excerpt(fit, time, force, name, 0.5 * (half.start + half.end))
        for name, half in zip(("first half, fitted", "second half, held out"), halves, strict=True)
    ]
    svg = inline_svg(
        draw_pull(*thinned(time, force, MOST), halves, excerpts),
        alt="Spring force over load against time: the whole record, and some cycles of each half"
        " beside the fitted limit cycle",
        prefix="force-figure",
        **PULL_SIZES,
    )
    shown = quantity(float(np.ptp(excerpts[0].time)), "s", 2)
    caption = (
        "**The force of the spring over the load.** Above: the record, with the mean of each half."
        f" Below: {shown} from the middle of each half (grey) and the fitted limit cycle (blue)."
        " Its phase is chosen to match best; only frequency, mean and standard deviation were"
        " fitted, since no law follows an irregular record cycle by cycle."
    )
    heading = "The measured force and the predicted motion"
    block = Figure(svg=svg, caption=caption)
    return Section(id="force", nav="Force", heading=heading, blocks=(block,))


def _excerpt(fit: FeatureFit, time: Array, force: Array, name: str, middle: float) -> Excerpt:
    """Return some cycles about a time, with the limit cycle shifted to lie nearest."""
    period = 1.0 / fit.observed.frequency
    kept = np.abs(time - middle) <= 0.5 * CYCLES * period
    t, measured = time[kept] - time[kept][0], force[kept]
    fine = np.linspace(0.0, float(t[-1]) + period, 40 * (CYCLES + 1) + 1)
    cycle = fit.limit_cycle(fine) / towed_load(fit.mechanism)
    shifts = np.linspace(0.0, period, SHIFTS, endpoint=False)
    misfit = [float(np.sum((np.interp(t + s, fine, cycle) - measured) ** 2)) for s in shifts]
    shift = float(shifts[int(np.argmin(misfit))])
    inside = (fine >= shift) & (fine - shift <= t[-1])
    return Excerpt(name, t, measured, fine[inside] - shift, cycle[inside])
