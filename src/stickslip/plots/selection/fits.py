"""Plots of fits and verdicts, made of what these hold."""

import math
from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes

from stickslip.errors import InputError
from stickslip.formatting import scale_of
from stickslip.identification import Fit, RecordFit
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, Target, on_axes, on_panels
from stickslip.plots.core.svg import Draw
from stickslip.plots.laws.friction_map import MAP_SIZES, MapLaw, draw_friction_map
from stickslip.plots.selection.fit_data import MapPoints, map_points, residual_panels, sampled
from stickslip.plots.selection.intervals import INTERVAL_SIZE, Interval, draw_intervals
from stickslip.plots.selection.joints import refuse_joints
from stickslip.plots.selection.residuals import draw_residuals, residual_sizes
from stickslip.selection import Verdict


def draw_fitted_map(
    points: MapPoints, fits: Mapping[str, RecordFit], *, low_speeds: bool = True
) -> Draw:
    """Return a drawing of measured friction against velocity, and of fitted laws."""
    chosen = next(iter(fits))
    shown = sampled(len(points.velocity))
    measured = fits[chosen].measurement
    return draw_friction_map(
        points.velocity[shown],
        points.friction[shown],
        {title: MapLaw(fit.typical_law, fit.offset) for title, fit in fits.items()},
        points.load,
        chosen=chosen,
        trend=points.trend[shown],
        units=(measured.unit("velocity"), measured.unit("friction")),
        low_speeds=low_speeds,
    )


def plot_friction_map(fit: RecordFit | Mapping[str, RecordFit], ax: Target = None) -> Axes:
    """Plot measured friction against velocity, and the law that was fitted to it.

    Friction that was not measured is what inverse dynamics makes of the record.

    Parameters
    ----------
    fit : RecordFit or mapping of str to RecordFit
        A fit to records, or several of the same records by name, the first of which stands out.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.

    Returns
    -------
    matplotlib.axes.Axes
        The panel.

    Raises
    ------
    InputError
        If `fit` is of another type, or the record does not tell friction against velocity.

    Examples
    --------
    >>> import numpy as np
    >>> from matplotlib.figure import Figure
    >>> from stickslip import Axis, Coulomb, Measurement, fit
    >>> v = np.linspace(-1.0, 1.0, 40)
    >>> found = fit(Axis(inertia=1.0), Coulomb, Measurement(velocity=v, friction=2.0 * np.sign(v)))
    >>> plot_friction_map(found, Figure().add_subplot()).get_xlabel()
    'velocity, m/s'
    """
    check_type("fit", fit, RecordFit, Mapping)
    fits = {fit.law.title: fit} if isinstance(fit, RecordFit) else fit
    if not fits:
        raise InputError("plot_friction_map needs at least one fit, got none.")
    for one in fits.values():
        check_type("fit", one, RecordFit)
        refuse_joints(one, "plot_friction_map")
    points = map_points(next(iter(fits.values())))
    if points is None or not points.velocity.any():
        raise InputError(
            "friction against velocity cannot be computed from this record, which is too short or"
            " has no position or motion; plot_residuals shows the residuals of the fit."
        )
    return on_axes(draw_fitted_map(points, fits, low_speeds=False), ax, MAP_SIZES["wide"])


def plot_residuals(fit: RecordFit, ax: PanelTarget = None) -> Panels:
    """Plot what a fit leaves, against time, velocity and position.

    Parameters
    ----------
    fit : RecordFit
        A fit to records.
    ax : sequence of Axes, Figure or SubFigure, optional
        An Axes for each of time, velocity and position that is known; a new figure if not given.

    Returns
    -------
    array of Axes
        One to three panels: residuals as dots, and means of bins with two standard errors.

    Raises
    ------
    InputError
        If `fit` is no fit to records, or leaves too few residuals.

    Examples
    --------
    >>> import numpy as np
    >>> from matplotlib.figure import Figure
    >>> from stickslip import Axis, Coulomb, Measurement, fit
    >>> v = np.linspace(-1.0, 1.0, 400)
    >>> force = 2.0 * np.sign(v) + 0.1 * np.cos(50.0 * v)
    >>> found = fit(Axis(inertia=1.0), Coulomb, Measurement(velocity=v, friction=force))
    >>> [axes.get_xlabel() for axes in plot_residuals(found, Figure())]
    ['velocity, m/s']
    """
    check_type("fit", fit, RecordFit)
    refuse_joints(fit, "plot_residuals")
    if not all(map(math.isfinite, fit.residual)):
        raise InputError("the residuals of the fit are not finite and cannot be plotted.")
    unit = fit.measurement.unit(fit.problem.quantity)
    factor, shown = scale_of(fit.residual, unit)
    panels = list(residual_panels(fit, factor).values())
    if not panels:
        raise InputError(f"the fit has {len(fit.residual)} residuals, too few for bin means.")
    draw = draw_residuals(panels, f"residual, {shown}")
    return on_panels(draw, ax, residual_sizes(len(panels))["wide"])


def plot_fit(fit: Fit[Any], ax: Target = None) -> Axes:
    """Plot a fit beside what was measured.

    Parameters
    ----------
    fit : Fit
        A fit to records, travels, features or velocity steps, or one of another package whose class
        has a plot.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.

    Returns
    -------
    matplotlib.axes.Axes
        Of records: friction against velocity, as `plot_friction_map`. Of travels: measured less
        predicted, by trial. Of features: their relative errors, held out where they can be. Of
        velocity steps: the coefficient over time, measured and fitted.

    Raises
    ------
    InputError
        If `fit` is no fit, its class has no plot, or friction cannot be read off the record.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from stickslip import Coulomb, Measurement, SpringBlock, fit
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005)
    >>> plot_fit(fit(rig, Coulomb, reading), Figure()).get_xlabel()
    'measured minus predicted travel, mm'
    """
    check_type("fit", fit, Fit)
    return fit.plot(ax)


def plot_verdict(verdict: Verdict, ax: Target = None) -> Axes:
    """Plot the held-out error of each law of a selection.

    Parameters
    ----------
    verdict : Verdict
        What `select` returns.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.

    Returns
    -------
    matplotlib.axes.Axes
        Held-out errors with their standard errors, the law to use in blue. Where travels rank
        nothing, what laws predict at other settings, as `plot_separation`.

    Raises
    ------
    InputError
        If `verdict` is no verdict, or has neither.

    Examples
    --------
    >>> import numpy as np
    >>> from matplotlib.figure import Figure
    >>> from stickslip import Axis, Measurement, select
    >>> v = np.linspace(-1.0, 1.0, 400)
    >>> table = Measurement(velocity=v, friction=2.0 * np.sign(v) + 0.1 * np.cos(50.0 * v))
    >>> verdict = select(Axis(inertia=1.0), ["coulomb", "viscous"], table)
    >>> plot_verdict(verdict, Figure()).get_xlabel()
    'held-out error, N'
    """
    check_type("verdict", verdict, Verdict)
    return verdict.plot(ax)


def plot_scores(verdict: Verdict, ax: Target = None) -> Axes:
    """Plot held-out errors of the laws that have one."""
    best = verdict.best.name if verdict.best else ""
    rows = [
        Interval(
            one.title,
            one.score,
            math.nan if one.score_error is None else one.score_error,
            one.name == best,
        )
        for one in verdict.scored
        if one.score is not None
    ]
    if not rows:
        raise InputError(f"no law has a held-out error to plot. {verdict.words.no_score}".strip())
    rows.sort(key=lambda row: row.value)
    return on_axes(draw_intervals(rows, "held-out error", verdict.score_unit), ax, INTERVAL_SIZE)
