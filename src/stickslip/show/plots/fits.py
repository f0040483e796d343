"""Figures of fits and verdicts: data with predictions, residuals, pieces of a record."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.identify import JointLawFit, JointVerdict, Verdict, draw_joints
from stickslip.identify.fits import Fit, PlainBalance, RecordFit, load_of
from stickslip.show.formatting import scale_of
from stickslip.show.plots import axes as drawing
from stickslip.show.plots.laws import MAP_SIZES, MapLaw, draw_friction_map
from stickslip.show.plots.svg import Draw
from stickslip.show.plots.theme import C1, DATA, INK, LINE, MUTED, check_type, name_size

# What a fit leaves: residuals against time, velocity and position, and errors of predictions.

OUTER: Final = 0.2
"""Share of the residuals [%] beyond each end of the vertical axis."""


class ResidualPanel(NamedTuple):
    """Residuals against one quantity, as dots and as means of bins with their doubt."""

    label: str
    """Quantity and unit of the horizontal axis."""
    x: drawing.Array
    """The quantity (n,), in that unit."""
    residual: drawing.Array
    """Residuals (n,), in the unit shown."""
    centre: drawing.Array
    """Middles of the bins (k,), in the unit of `x`."""
    mean: drawing.Array
    """Means of the residuals in the bins (k,)."""
    doubt: drawing.Array
    """Twice the standard errors of these means (k,)."""


def residual_sizes(count: int) -> drawing.Sizes:
    """Return the sizes of a figure of that many panels.

    Examples
    --------
    >>> residual_sizes(3)["wide"]
    (880, 380)
    """
    return drawing.Sizes(wide=(880, 200 if count < 3 else 380), narrow=(358, 20 + 180 * count))


def draw_residuals(panels: Sequence[ResidualPanel], label: str) -> Draw:
    """Return a drawing of residuals in panels that share their vertical axis."""
    everything = np.concatenate([panel.residual for panel in panels])
    low, high = np.percentile(everything, [OUTER, 100 - OUTER])
    margin = 0.1 * max(float(high - low), 1e-300)

    def draw(figure: Figure, narrow: bool) -> None:
        if narrow:
            places = list(figure.subplots(len(panels), 1, squeeze=False).flat)
        elif len(panels) == 3:
            places = list(figure.subplot_mosaic("AA;BC").values())
        else:
            places = list(figure.subplots(1, len(panels), squeeze=False).flat)
        for axes, panel in zip(places, panels, strict=True):
            axes.set_ylim(low - margin, high + margin)
            _residual_panel(axes, panel)
            axes.set_ylabel(label)
        _say_mean(places[0])

    return draw


def _residual_panel(axes: Axes, panel: ResidualPanel) -> None:
    axes.axhline(0.0, color=MUTED, linewidth=0.8, zorder=0)
    axes.plot(
        panel.x, panel.residual, "o", color=DATA, markersize=2.2, alpha=0.6, markeredgewidth=0,
        zorder=1,
    )  # fmt: skip
    axes.errorbar(
        panel.centre, panel.mean, panel.doubt, color=C1, linewidth=1.8, elinewidth=1.2, zorder=3
    )
    axes.margins(x=0.01)
    axes.grid(axis="y")
    axes.set_xlabel(panel.label)


def _say_mean(axes: Axes) -> None:
    axes.annotate(
        "mean ± 2 standard errors",
        (0.995, 1.0),
        xycoords="axes fraction",
        xytext=(0, 2),
        textcoords="offset points",
        ha="right",
        va="bottom",
        color=C1,
        fontsize=name_size(),
    )


# The numbers behind the figures: what was measured, and what the fits leave of it.

MOST_POINTS: Final = 2400
SEED: Final = 0
BINS: Final = 16
DOTS: Final = 1000
"""Residuals drawn in each panel at most."""
FEWEST_ROWS: Final = 10
"""Rows of a bin from which its mean is shown."""
STEADY: Final = 0.05
"""Changes of speed below this share of what is rarely exceeded count as none."""


class MapPoints(NamedTuple):
    """Friction against velocity by a plain balance."""

    velocity: drawing.Array
    """Slip velocities (n,) [m/s]."""
    friction: drawing.Array
    """Friction forces (n,) [N]."""
    load: float
    """Normal force [N]; its median where it varies."""
    trend: drawing.Array
    """1 where the speed rises, -1 where it falls, 0 where it does neither."""


class Rows(NamedTuple):
    """Residuals of a fit with the motion that they belong to; None where it is not known."""

    t: drawing.Array
    """Times (n,) [s]; records follow one another."""
    velocity: drawing.Array | None
    """Velocities (n,) [m/s]."""
    position: drawing.Array | None
    """Positions (n,) [m]."""
    residual: drawing.Array
    """Residuals (n,) [SI]."""


def sampled(count: int, most: int = MOST_POINTS) -> NDArray[np.intp]:
    """Return which of so many points are drawn: all, or a random sample with a fixed seed.

    Every so manieth point of a periodic record would hide the cloud.

    Examples
    --------
    >>> len(sampled(10_000)), sampled(3).tolist()
    (2400, [0, 1, 2])
    """
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(SEED).choice(count, most, replace=False))


def map_points(fit: RecordFit) -> MapPoints | None:
    """Return friction against velocity by a plain balance; None where there is none."""
    try:
        result = PlainBalance.of(fit.mechanism, fit.measurement, inertia=False)
        load_now = load_of(fit.mechanism)
    except InputError:  # too short, without a position, or of several coordinates
        return None
    return MapPoints(
        result.velocity,
        result.friction,
        load_now,
        trend=trend_of(result.time, result.velocity),
    )


def trend_of(t: drawing.Array, velocity: drawing.Array) -> drawing.Array:
    """Return 1 where the speed rises, -1 where it falls, 0 where it hardly does either.

    Examples
    --------
    >>> trend_of(np.arange(5.0), np.array([-3.0, -2.0, -1.0, 0.0, 1.0])).tolist()
    [-1.0, -1.0, -1.0, 0.0, 1.0]
    """
    rate = np.zeros(len(t))
    forward = np.flatnonzero(np.diff(t, prepend=-np.inf) <= 0.0)  # several records, end to end
    for own in np.split(np.arange(len(t)), forward):
        if len(own) > 1:
            rate[own] = np.gradient(np.abs(velocity[own]), t[own])
    least = STEADY * float(np.percentile(np.abs(rate), 95.0)) if len(rate) else 0.0
    return np.sign(rate) * (np.abs(rate) > least)


def speeds_of(fit: RecordFit, record: Measurement) -> tuple[drawing.Array, drawing.Array] | None:
    """Return times and velocities of one record, measured or by differences."""
    if record.time is None:
        return None
    if "velocity" in record.quantities():
        return record.time, np.asarray(record.values("velocity"), dtype=float)
    if "position" not in record.quantities():
        return None
    try:
        result = PlainBalance.of(fit.mechanism, record, inertia=False)
    except InputError:  # too short to be filtered
        position = np.asarray(record.values("position"), dtype=float)
        return record.time, np.gradient(position, record.time)
    return result.time, result.velocity


def rows_of(fit: RecordFit) -> Rows:
    """Return the residuals of a fit with times, velocities and positions."""
    problem, seen = fit.problem, fit.optimum.best
    record = problem.spans[seen.segment, 0].astype(int)
    t, shift = problem.times, _shifts(problem.spans)
    columns: dict[str, drawing.Array | None] = {
        "velocity": np.zeros(len(t)),
        "position": np.zeros(len(t)),
    }
    for number, trial in enumerate(fit.measurement.records()):
        own = record == number
        motion: dict[str, tuple[drawing.Array, drawing.Array] | None] = {
            "velocity": speeds_of(fit, trial),
            "position": None,
        }
        if "position" in trial.quantities() and trial.time is not None:
            motion["position"] = trial.time, np.asarray(trial.values("position"))
        for name, pair in motion.items():
            column = columns[name]
            if pair is None or column is None:
                columns[name] = None
            else:
                column[own] = np.interp(t[own], *pair)
    placed = t + np.array([shift[number] for number in record])
    return Rows(placed, columns["velocity"], columns["position"], seen.residual)


def _shifts(spans: drawing.Array) -> dict[int, float]:
    """Return what times of each record are shifted by, so that several lie end to end."""
    order = np.unique(spans[:, 0]).astype(int).tolist()
    if len(order) == 1:
        return {order[0]: 0.0}
    result, at = {}, 0.0
    for record in order:
        own = spans[spans[:, 0] == record]
        result[record] = at - float(own[:, 1].min())
        at += float(own[:, 2].max() - own[:, 1].min())
    return result


def panel_of(
    label: str,
    x: drawing.Array,
    residual: drawing.Array,
    effective: float,
    shown: Sequence[int] | NDArray[np.intp],
) -> ResidualPanel:
    """Return residuals against a quantity, with means of bins and twice their standard errors.

    Neighbours are alike: a bin counts as many independent rows as its share of those of all.
    """
    edges = np.linspace(float(x.min()), float(x.max()), BINS + 1)
    place = np.clip(np.digitize(x, edges) - 1, 0, BINS - 1)
    centre, mean, doubt = [], [], []
    for number in range(BINS):
        own = residual[place == number]
        if len(own) < FEWEST_ROWS:
            continue
        independent = max(len(own) * min(effective / len(residual), 1.0), 1.0)
        centre.append(0.5 * (edges[number] + edges[number + 1]))
        mean.append(float(own.mean()))
        doubt.append(2.0 * float(own.std()) / independent**0.5)
    return ResidualPanel(
        label, x[shown], residual[shown], np.array(centre), np.array(mean), np.array(doubt)
    )


def residual_panels(fit: RecordFit, factor: float) -> dict[str, ResidualPanel]:
    """Return residuals, times a factor, against time, velocity and position, where known."""
    rows = rows_of(fit)
    residual = factor * rows.residual
    shown = sampled(len(residual), DOTS)
    result = {}
    against = {"time": rows.t, "velocity": rows.velocity, "position": rows.position}
    for name, x in against.items():
        if x is None or np.ptp(x) == 0.0:
            continue
        by, unit = scale_of(x, "s" if name == "time" else fit.measurement.unit(name))
        panel = panel_of(f"{name}, {unit}", by * x, residual, fit.inference.effective, shown)
        if len(panel.centre):
            result[name] = panel
    return result


# Plots of fits and verdicts, made of what these hold.

PANEL = 190
"""Height of a panel [px]."""
INTERVAL_SIZE: Final = (880, 300)


def plot_joints(fit: JointLawFit | JointVerdict, ax: drawing.PanelTarget = None) -> drawing.Panels:
    """Plot friction of each joint over its velocity, with its band and its law.

    Parameters
    ----------
    fit : JointLawFit or JointVerdict
        A fit to records of several joints, or a verdict on them.
    ax : sequence of Axes, Figure or SubFigure, optional
        An Axes for each joint; a new figure if not given.

    Returns
    -------
    array of Axes (m,)
        A panel for each joint.

    Raises
    ------
    InputError
        If it is neither.
    """
    check_type("fit", fit, JointLawFit, JointVerdict)
    drawings = {name: joint.drawing() for name, joint in fit.joints.items()}
    size = (880, 60 + 2 * PANEL * len(drawings))
    return drawing.on_panels(draw_joints(drawings), ax, size)


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


def plot_friction_map(fit: RecordFit | Mapping[str, RecordFit], ax: drawing.Target = None) -> Axes:
    """Plot measured friction against velocity, and the law that was fitted to it.

    Friction that was not measured is what a balance of forces leaves.

    Parameters
    ----------
    fit : RecordFit or mapping of str to RecordFit
        A fit to records by simulated segments, or several of the same records by name, the first of
        which stands out.
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
    >>> t = np.arange(240) / 40.0
    >>> run = {"position": -0.2 * np.sin(5.0 * t), "force": 6.0 * np.sin(5.0 * t)}
    >>> found = fit(Axis(inertia=1.0), Coulomb, Measurement(time=t, **run), route="shooting")
    >>> plot_friction_map(found, Figure().add_subplot()).get_xlabel()
    'velocity, m/s'
    """
    check_type("fit", fit, RecordFit, Mapping)
    fits = {fit.law.title: fit} if isinstance(fit, RecordFit) else fit
    if not fits:
        raise InputError("plot_friction_map needs at least one fit, got none.")
    for fitted in fits.values():
        check_type("fit", fitted, RecordFit)
    points = map_points(next(iter(fits.values())))
    if points is None or not points.velocity.any():
        raise InputError(
            "friction against velocity cannot be computed from this record, which is too short or"
            " has no position or motion; plot_residuals shows the residuals of the fit."
        )
    return drawing.on_axes(draw_fitted_map(points, fits, low_speeds=False), ax, MAP_SIZES["wide"])


def plot_residuals(fit: RecordFit, ax: drawing.PanelTarget = None) -> drawing.Panels:
    """Plot what a fit leaves, against time, velocity and position.

    Parameters
    ----------
    fit : RecordFit
        A fit to records by simulated segments.
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
    >>> t = np.arange(240) / 40.0
    >>> run = {"position": -0.2 * np.sin(5.0 * t), "force": 6.0 * np.sin(5.0 * t)}
    >>> found = fit(Axis(inertia=1.0), Coulomb, Measurement(time=t, **run), route="shooting")
    >>> [axes.get_xlabel() for axes in plot_residuals(found, Figure())]
    ['time, s', 'velocity, m/s', 'position, m']
    """
    check_type("fit", fit, RecordFit)
    if not all(map(math.isfinite, fit.residual)):
        raise InputError("the residuals of the fit are not finite and cannot be plotted.")
    unit = fit.measurement.unit(fit.problem.quantity)
    factor, shown = scale_of(fit.residual, unit)
    panels = list(residual_panels(fit, factor).values())
    if not panels:
        raise InputError(f"the fit has {len(fit.residual)} residuals, too few for bin means.")
    draw = draw_residuals(panels, f"residual, {shown}")
    return drawing.on_panels(draw, ax, residual_sizes(len(panels))["wide"])


def plot_fit(fit: Fit[Any], ax: drawing.Target = None) -> Axes:
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


def plot_verdict(verdict: Verdict, ax: drawing.Target = None) -> Axes:
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


def plot_scores(verdict: Verdict, ax: drawing.Target = None) -> Axes:
    """Plot held-out errors of the laws that have one."""
    best = verdict.best.name if verdict.best else ""
    rows = [
        Interval(candidate.title, candidate.score, chosen=candidate.name == best)
        for candidate in verdict.scored
        if candidate.score is not None
    ]
    if not rows:
        raise InputError(f"no law has a held-out error to plot. {verdict.words.no_score}".strip())
    rows.sort(key=lambda row: row.value)
    return drawing.on_axes(
        draw_intervals(rows, "held-out error", verdict.score_unit), ax, INTERVAL_SIZE
    )


# Pieces of a record beside their predictions, and what the predictions are off by.

DASHED: Final = (0, (5, 2))
LINE_HEIGHT = 13
"""Distance of names below each other [pt]."""


class Piece(NamedTuple):
    """A stretch of a record: its name, times [s], what was measured, and predictions by title."""

    name: str
    """Name of the stretch."""
    t: drawing.Array
    """Times (n,) [s]."""
    measured: drawing.Array
    """What was measured (n,)."""
    predicted: Mapping[str, drawing.Array]
    """Predictions (n,), by title of the law."""


def piece_sizes(count: int) -> drawing.Sizes:
    """Return the sizes of a figure of so many pieces.

    Examples
    --------
    >>> piece_sizes(2)["wide"]
    (880, 380)
    """
    return drawing.Sizes(wide=(880, 380), narrow=(358, 330 * count))


def draw_pieces(pieces: Sequence[Piece], quantity: str, unit: str, *, chosen: str) -> Draw:
    """Return a drawing of pieces of a record: measured and predicted above, errors below."""
    look = drawing.looks(pieces[0].predicted, chosen)
    factor, shown = scale_of(np.concatenate([piece.measured for piece in pieces]), unit)
    gaps = [piece.measured - y for piece in pieces for y in piece.predicted.values()]
    by, small = scale_of(np.concatenate(gaps), unit)

    def draw(figure: Figure, narrow: bool) -> None:
        for (above, below), piece in zip(_places(figure, len(pieces), narrow), pieces, strict=True):
            above.plot(
                piece.t, factor * piece.measured, "o", color=DATA, markersize=2.5, alpha=0.6,
                markeredgewidth=0, zorder=1,
            )  # fmt: skip
            for name, y in piece.predicted.items():
                style: dict[str, Any] = {
                    "color": look[name].colour, "linewidth": 0.75 * look[name].width,
                    "linestyle": "-" if name == chosen else DASHED, "zorder": look[name].order,
                }  # fmt: skip
                above.plot(piece.t, factor * y, **style)
                below.plot(piece.t, by * (piece.measured - y), **style)
            above.set_title(piece.name, color=MUTED)
            above.set_ylabel(drawing.labelled(quantity, shown))
            below.set_ylabel(drawing.labelled("error", small))
            below.axhline(0.0, color=LINE, linewidth=0.8, zorder=0)
            below.set_xlabel("time, s")
            below.margins(x=0.01, y=0.3)
        _name(below, {name: look[name].colour for name in look}, chosen)

    return draw


def _places(figure: Figure, count: int, narrow: bool) -> list[tuple[Axes, Axes]]:
    """Return for each piece the panel of values and that of errors; errors share one range."""
    if narrow:
        grid = figure.subplots(2 * count, 1, height_ratios=[3, 2] * count, squeeze=False)[:, 0]
        pairs = [(grid[2 * k], grid[2 * k + 1]) for k in range(count)]
    else:
        grid = figure.subplots(2, count, height_ratios=[3, 2], squeeze=False)
        pairs = [(grid[0, k], grid[1, k]) for k in range(count)]
    for above, below in pairs:
        below.sharex(above)
        if below is not pairs[0][1]:
            below.sharey(pairs[0][1])
    return pairs


def _name(axes: Axes, colours: Mapping[str, str], chosen: str) -> None:
    """Name the lines in the last panel, the chosen one above, the others in a column below."""
    others = [name for name in colours if name != chosen]
    for name, colour in colours.items():
        above = name == chosen
        axes.annotate(
            name, (0.99, 0.97 if above else 0.03), xycoords="axes fraction", color=colour,
            xytext=(0, 0 if above else LINE_HEIGHT * others.index(name)),
            textcoords="offset points", fontsize=name_size(), ha="right",
            va="top" if above else "bottom",
        )  # fmt: skip
