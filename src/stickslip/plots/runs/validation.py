"""What was measured beside what a law from elsewhere predicts."""

from typing import Final

import numpy as np
from matplotlib.figure import Figure

from stickslip.errors import InputError
from stickslip.formatting import scale_of
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, on_panels
from stickslip.plots.core.helpers import Sizes
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, C2, DATA, MUTED
from stickslip.sweep import ValidatedRecord, Validation

VALIDATION_SIZES: Final = Sizes(wide=(880, 420), narrow=(358, 420))
MOST_POINTS: Final = 1500
"""Samples of a record above which only every second, third, ... is drawn."""


def draw_validation(seen: Validation, *, record: int = 0) -> Draw:
    """Return a drawing of a record over its prediction and of the residual, or of all travels."""
    if not seen.records:
        return _travels(seen)
    if not 0 <= record < len(seen.records):
        raise InputError(
            f"record must be a whole number from 0 to {len(seen.records) - 1}, got {record!r}."
        )
    return _record(seen.records[record])


def _record(one: ValidatedRecord) -> Draw:
    kept = slice(None, None, max(1, len(one.t) // MOST_POINTS))
    t = one.t[kept]

    def draw(figure: Figure, narrow: bool) -> None:  # noqa: ARG001
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
        factor, unit = scale_of(one.predicted, one.unit)
        fine, fine_unit = scale_of(one.residual, one.unit)
        above.plot(t, factor * one.measured[kept], ".", color=DATA, markersize=3, label="measured")
        above.plot(t, factor * one.predicted[kept], color=C1, linewidth=1.6, label="predicted")
        below.plot(t, fine * one.residual[kept], ".", color=DATA, markersize=3)
        below.axhline(0.0, color=C1, linewidth=1.0)
        if one.band is not None:
            low, high = one.band[:, kept]
            above.fill_between(
                t, factor * low, factor * high, color=C1, alpha=0.22, linewidth=0, label="95 % band"
            )
            middle = one.predicted[kept]
            below.fill_between(
                t, fine * (low - middle), fine * (high - middle), color=C1, alpha=0.22, linewidth=0
            )
        above.legend(loc="best")
        above.set_ylabel(f"{'displacement' if one.quantity == 'position' else 'velocity'}, {unit}")
        below.set_ylabel(f"residual, {fine_unit}")
        below.set_xlabel("time, s")
        for axes in (above, below):
            axes.margins(x=0, y=0.12)
            axes.grid(axis="y")
        figure.align_ylabels()

    return draw


def _travels(seen: Validation) -> Draw:
    """Return a drawing of all readings beside their predictions, in the order of trials."""
    travels = seen.travels
    places = np.arange(1, len(travels) + 1)
    quantity = travels[0].quantity

    def draw(figure: Figure, narrow: bool) -> None:  # noqa: ARG001
        axes = figure.add_subplot()
        everything = [value for one in travels for value in (one.measured, one.predicted)]
        factor, unit = scale_of(everything, travels[0].unit)
        predicted = factor * np.array([one.predicted for one in travels])
        if all(one.low is not None for one in travels):
            ends = factor * np.array([[one.low, one.high] for one in travels], dtype=np.float64)
            axes.vlines(places, ends[:, 0], ends[:, 1], color=C1, alpha=0.4, linewidth=8)
        axes.plot(places, predicted, "_", color=C1, markersize=12, label="predicted, 95 % band")
        axes.errorbar(
            places,
            [factor * one.measured for one in travels],
            [1.96 * factor * one.uncertainty for one in travels],
            fmt="o",
            color=C2,
            markersize=4,
            label="measured, ± 1.96 standard errors",
        )
        axes.legend(loc="best")
        axes.locator_params(axis="x", integer=True)
        axes.set_xlim(0.5, len(travels) + 0.5)
        axes.set_xlabel("reading", color=MUTED)
        axes.set_ylabel(f"{quantity.replace('_', ' ')}, {unit}")
        axes.grid(axis="y")

    return draw


def plot_validation(seen: Validation, ax: PanelTarget = None, *, record: int = 0) -> Panels:
    """Plot a record over its prediction, with the 95 % band, and the residual; or all travels.

    Parameters
    ----------
    seen : Validation
        What `validate` returns.
    ax : Axes, sequence of Axes, Figure or SubFigure, optional
        Two Axes for a record, one for travels; a new figure if not given.
    record : int
        Which record, from 0.

    Returns
    -------
    array of Axes (2,) or (1,)
        The panels.

    Raises
    ------
    InputError
        If `ax` is no Axes or has another number of panels, or there is no such record.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock
    >>> from stickslip.sweep import validate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> law = Coulomb(kinetic_coefficient=0.25)
    >>> (axes,) = plot_validation(validate(rig, law, Measurement(travel=0.2)), Figure())
    >>> axes.get_ylabel()
    'travel, m'
    """
    check_type("seen", seen, Validation)
    return on_panels(draw_validation(seen, record=record), ax, VALIDATION_SIZES["wide"])
