"""Plots of fits and verdicts, made of what these hold."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.formatting import Scale, scale_of
from stickslip.identification import Fit, Prediction, RecordFit
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, Target, on_axes, on_panels
from stickslip.plots.core.svg import Draw, Size
from stickslip.plots.core.theme import C1, DATA, INK, MUTED
from stickslip.plots.laws.friction_map import MAP_SIZES, MapLaw, draw_friction_map
from stickslip.plots.selection.fit_data import MapPoints, map_points, residual_panels, sampled
from stickslip.plots.selection.residuals import draw_residuals, residual_sizes
from stickslip.quantities import turned
from stickslip.selection import Verdict

PANEL = 190
"""Height of a panel [px]."""
INTERVAL_SIZE: Final = (880, 300)


def plot_joints(
    fit: RecordFit,
    ax: PanelTarget = None,
    *,
    measurement: Measurement | None = None,
    record: int = 0,
) -> Panels:
    """Plot the measured and the predicted force of each joint of one record against time.

    Parameters
    ----------
    fit : RecordFit
        A fit to records of several joints.
    ax : sequence of Axes, Figure or SubFigure, optional
        An Axes for each joint; a new figure if not given.
    measurement : Measurement, optional
        What is predicted; what was fitted if not given.
    record : int
        Which of its records is shown, from 0.

    Returns
    -------
    array of Axes (m,)
        A panel for each joint.

    Raises
    ------
    InputError
        If the fit is not one of several joints, or there is no such record.
    """
    check_type("fit", fit, RecordFit)
    if fit.problem.joints is None:
        raise InputError("plot_joints takes a fit of several joints: plot_fit draws this one.")
    seen = fit.predict(measurement)
    if record not in seen.record:
        raise InputError(f"record must be from 0 to {int(seen.record.max())}, got {record!r}.")
    draw = joint_figure(fit, measurement=measurement, record=record)
    return on_panels(draw, ax, joint_sizes(fit)["wide"])


def joint_sizes(fit: RecordFit) -> dict[str, Size]:
    """Return the sizes of the figure of all joints of a fit, for screens and phones."""
    assert fit.problem.joints is not None
    height = 60 + PANEL * len(np.unique(fit.problem.joints))
    return {"wide": (880, height), "narrow": (390, height)}


def joint_figure(
    fit: RecordFit, *, measurement: Measurement | None = None, record: int = 0
) -> Draw:
    """Return what draws the forces of the joints, as `plot_joints` does."""
    seen = fit.predict(measurement)
    turning = [unit == "rad" for unit in fit.mechanism.units]
    units = dict(zip(fit.mechanism.coordinates, (turned("N", t) for t in turning), strict=True))
    assert seen.joint is not None
    fitted = np.unique(seen.joint[seen.record == record])  # others rest
    units = {name: unit for name, unit in units.items() if name in fitted}
    shown: dict[str, list[NDArray[np.float64]]] = {}
    for name, unit in units.items():
        own = seen.of(name)
        shown.setdefault(unit, []).append(own.measured[own.record == record])
    scales = {unit: scale_of(np.concatenate(values), unit) for unit, values in shown.items()}

    def draw(figure: Figure, narrow: bool) -> None:
        panels = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
        for axes, (name, unit) in zip(panels, units.items(), strict=True):
            own = seen.of(name)
            _draw_one(axes, own, own.record == record, unit, scales[unit])
            axes.set_title(name, loc="left", fontsize="medium")
        panels[0].legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False,
            fontsize="small" if narrow else "medium",
        )  # fmt: skip
        panels[-1].set_xlabel("time, s")
        figure.align_ylabels()

    return draw


def _draw_one(
    axes: Axes, own: Prediction, rows: NDArray[np.bool_], unit: str, scale: Scale
) -> None:
    """Draw the force of one joint."""
    factor, shown = scale
    order = own.t[rows].argsort()
    t = own.t[rows][order]
    axes.plot(t, factor * own.measured[rows][order], color=DATA, linewidth=2.2, label="measured")
    axes.plot(t, factor * own.predicted[rows][order], color=C1, linewidth=1.4, label="predicted")
    axes.axhline(0.0, color=MUTED, linewidth=0.6, zorder=0)
    axes.set_ylabel(f"{'torque' if unit == 'N m' else 'force'}, {shown}")
    axes.margins(x=0.01, y=0.15)


def refuse_joints(fit: RecordFit, plot: str) -> None:
    """Refuse a fit of several joints, of which `plot_joints` shows the forces."""
    if fit.problem.joints is not None:
        raise InputError(
            f"{plot} takes a fit of one contact: plot_joints draws one of several joints."
        )


class Interval(NamedTuple):
    """A value and its standard error, NaN where it is not known."""

    name: str
    """Name of the row."""
    value: float
    """The value, in the unit of the axis."""
    error: float = np.nan
    """Its standard error, in the same unit."""
    chosen: bool = False
    """Whether the row stands out."""


def draw_intervals(rows: Sequence[Interval], label: str, unit: str) -> Draw:
    """Return a drawing of values as dots, with bars of one standard error, the first on top."""
    values = np.array([row.value for row in rows])
    errors = np.array([row.error for row in rows])
    factor, shown = (
        (100.0, "%") if unit == "1" else scale_of(np.abs(values) + np.nan_to_num(errors), unit)
    )

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_subplot()
        for place, (row, error) in enumerate(zip(rows, errors, strict=True)):
            bar = [factor * error] if np.isfinite(error) else None
            axes.errorbar(
                [factor * row.value], [place], xerr=bar, fmt="o", markersize=5, elinewidth=1.5,
                color=C1 if row.chosen else INK,
            )  # fmt: skip
        axes.set_yticks(range(len(rows)), [row.name for row in rows])
        axes.set_ylim(len(rows) - 0.5, -0.5)
        if np.any(values < 0.0):
            axes.axvline(0.0, color=MUTED, linewidth=0.8, zorder=0)
        else:
            axes.set_xlim(left=0.0)
        axes.grid(axis="x")
        axes.set_xlabel(f"{label}, {shown}" if shown else label)

    return draw


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
        Held-out errors with their standard errors, the law to use in blue; of tables, records and
        travels, the band of friction over the velocity or of the travel over the setting.

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
    'velocity, m/s'
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
