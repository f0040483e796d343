"""Plots of many runs: an output over what was varied, and the band that runs lie in."""

import textwrap
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.errors import InputError, UnknownNameError
from stickslip.formatting import scale_of
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Target, on_axes
from stickslip.plots.core.helpers import labelled
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, C2
from stickslip.quantities import full_path
from stickslip.sweep import Band
from stickslip.trajectory import Ensemble

SIZE: Final = (880, 320)
REASON_WIDTH: Final = 30
"""Letters of a line of a reason in the legend."""


def draw_ensemble(runs: Ensemble, output: str, parameter: str | None) -> Draw:
    """Return a drawing of an output of each run over a parameter; of its number without one."""
    values = runs[output]
    columns = values[:, None] if values.ndim == 1 else values
    places = np.arange(len(runs)) if parameter is None else runs.parameters[parameter]
    early = np.array([not status.complete for status in runs.status])

    reasons = dict.fromkeys(one.label for one in runs.status if not one.complete)
    ended = "\n".join(["ended early:", *(textwrap.fill(one, REASON_WIDTH) for one in reasons)])

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_subplot()
        for chosen, colour, fill in ((~early, C1, C1), (early, C2, "none")):
            if chosen.any():
                across = np.repeat(places[chosen], columns.shape[1])
                axes.plot(
                    across, columns[chosen].ravel(), "o", color=colour, markerfacecolor=fill,
                    markersize=4, label=ended if colour == C2 else "reached the end",
                )  # fmt: skip
        if early.any():
            axes.legend()
        axes.grid(axis="y")
        over = "run" if parameter is None else labelled(parameter, runs.units[parameter])
        axes.set_xlabel(over)
        axes.set_ylabel(labelled(output, runs.units[output]))

    return draw


def plot_ensemble(
    runs: Ensemble,
    ax: Target = None,
    *,
    output: str | None = None,
    parameter: str | None = None,
) -> Axes:
    """Plot an output of each run of an ensemble over a parameter.

    Parameters
    ----------
    runs : Ensemble
        What `ensemble` returns.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.
    output : str, optional
        Name of an output; the first if not given.
    parameter : str, optional
        Path of what was varied, or its last name; the first if not given.

    Returns
    -------
    matplotlib.axes.Axes
        The panel, a dot a run; runs that ended early are rings. Values are SI.

    Raises
    ------
    InputError
        If `runs` is no ensemble or has no outputs.
    UnknownNameError
        If the ensemble has no such output or parameter.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, ensemble
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> levels = {"kinetic_coefficient": np.array([0.2, 0.25, 0.3])}
    >>> runs = ensemble(rig, Coulomb(kinetic_coefficient=0.25), levels, t_end=1.0)
    >>> ax = plot_ensemble(runs, Figure(), output="x")
    >>> ax.get_xlabel(), len(ax.lines[0].get_xdata())
    ('kinetic coefficient', 3)
    >>> ax.get_ylabel()
    'x, m'
    """
    check_type("runs", runs, Ensemble)
    if not runs.outputs:
        raise InputError("the ensemble has no outputs to plot.")
    output = output or next(iter(runs.outputs))
    known = list(runs.parameters)
    path = full_path(parameter, known) if parameter else next(iter(known), None)
    return on_axes(draw_ensemble(runs, output, path), ax, SIZE)


def draw_band(band: Band, state: str) -> Draw:
    """Return a drawing of the median of a state against time, and of where 95 % of runs lie."""
    factor, unit = scale_of(np.abs(band.states[state]).ravel(), band.units[state])
    low, median, high = factor * band.states[state]

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_subplot()
        axes.fill_between(band.t, low, high, color=C1, alpha=0.22, linewidth=0)
        axes.plot(band.t, median, color=C1)
        axes.margins(x=0, y=0.1)
        axes.grid(axis="y")
        axes.set_xlabel("time, s")
        axes.set_ylabel(f"{state}, {unit}")

    return draw


def plot_band(band: Band, ax: Target = None, *, state: str | None = None) -> Axes:
    """Plot the median of runs with uncertain parameters, and where 95 % of them lie.

    Parameters
    ----------
    band : Band
        What `band_of` returns.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.
    state : str, optional
        The coordinate that slips or its rate; the coordinate if not given.

    Returns
    -------
    matplotlib.axes.Axes
        The panel.

    Raises
    ------
    InputError
        If `band` is of another type.
    UnknownNameError
        If the band has no such state.
    """
    check_type("band", band, Band)
    state = state or next(iter(band.states))
    if state not in band.states:
        raise UnknownNameError("state", state, band.states)
    return on_axes(draw_band(band, state), ax, SIZE)
