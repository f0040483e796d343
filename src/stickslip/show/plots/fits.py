"""Figures of fits and verdicts: data with predictions, pieces of a record."""

from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.errors import InputError
from stickslip.identify import JointLawFit, JointVerdict, Verdict, draw_joints
from stickslip.identify.fits import Fit
from stickslip.show.formatting import scale_of
from stickslip.show.plots import axes as drawing
from stickslip.show.plots.svg import Draw
from stickslip.show.plots.theme import C1, DATA, INK, LINE, MUTED, check_type, name_size

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
        Of records: friction against velocity, with its band. Of travels: measured less
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
