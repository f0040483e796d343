"""Figures of one run, and of several over each other."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.formatting import scale_of
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, Target, on_axes, on_panels
from stickslip.plots.core.helpers import (
    JUMP,
    Array,
    Sizes,
    coordinate_name,
    dense,
    grouped,
    horizon,
    looks,
    motion_names,
    wrapped,
)
from stickslip.plots.core.label_placement import Curve, label_curves, label_ends
from stickslip.plots.core.modes import name_events, name_modes, within
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, INK, MUTED, SURFACE, label_at, shade
from stickslip.plots.runs.contacts import contact_sizes, draw_contacts, shade_band
from stickslip.sweep import Band
from stickslip.trajectory import Trajectory

RUN_SIZES: Final = Sizes(wide=(880, 440), narrow=(358, 440))
FORCE_SIZES: Final = Sizes(wide=(880, 560), narrow=(358, 560))
"""Of `draw_run` with the normal force."""
FRICTION_SIZES: Final = Sizes(wide=(880, 280), narrow=(358, 250))

MOST_MARKED: Final = 40


def draw_run(
    run: Trajectory,
    *,
    slip: str = "x",
    rate: str = "v",
    until: float | None = None,
    normal_force: bool = False,
    band: Band | None = None,
) -> Draw:
    """Return a drawing of displacement, velocity, friction and perhaps normal force against time.

    Parameters
    ----------
    run : Trajectory
        The run.
    slip, rate : str
        Names of the slipping coordinate and its rate.
    until : float, optional
        Last time shown [s]; some time after the body has arrived if not given.
    normal_force : bool
        Whether the normal force has a panel too.
    band : Band, optional
        Where 95 % of the runs lie that have a law's parameters from its estimates; shown pale.

    Returns
    -------
    callable
        Draws it, with bands where the body sticks and dots at events.
    """
    last = horizon(run, slip) if until is None else min(until, run.span[1])
    seen = dense(run, last)
    titles = {slip: "displacement", rate: "velocity", "friction": "friction"}
    titles |= {"normal_force": "normal force"} if normal_force else {}

    def draw(figure: Figure, narrow: bool) -> None:
        panels = figure.subplots(len(titles), 1, sharex=True)
        events = [event for event in run.events if event.t <= last][:MOST_MARKED]
        for axes, (name, title) in zip(panels, titles.items(), strict=True):
            factor, unit = scale_of(seen[name], run.units[name])
            axes.plot(seen.t, factor * seen[name], color=C1, linewidth=2.0)
            axes.set_ylabel(f"{title}, {unit}")
            if band is not None and name in band.states:
                shade_band(axes, band, name, last, factor=factor, colour=C1)
            axes.margins(x=0, y=0.12)
            axes.grid(axis="y")
            shade(axes, within(run.stick_spans(), last))
            if events:
                at = run.at([event.t for event in events])
                axes.plot(at.t, factor * at[name], "o", color=C1, markersize=4.5, zorder=4)
        figure.align_ylabels()
        panels[-1].set_xlabel("time, s")
        name_modes(panels[0], run, last)
        name_events(panels[1], events, narrow)

    return draw


def draw_friction_velocity(
    run: Trajectory, *, rate: str = "v", until: float | None = None, slip: str = "x"
) -> Draw:
    """Return a drawing of friction against velocity along a run.

    Parameters
    ----------
    run : Trajectory
        The run.
    rate : str
        Name of the slip velocity.
    until : float, optional
        Last time shown [s].
    slip : str
        Name of the coordinate.

    Returns
    -------
    callable
        Draws it, with a ring where it begins and a dot where it ends.
    """
    last = horizon(run, slip) if until is None else min(until, run.span[1])
    seen = dense(run, last, samples=2500)

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_subplot()
        factor, unit = scale_of(seen[rate], run.units[rate])
        of_force, unit_of_force = scale_of(seen["friction"], run.units.get("friction", "N"))
        v, force = factor * seen[rate], of_force * seen["friction"]
        apart = _impacts(seen.t, v)
        axes.axhline(0, color=MUTED, linewidth=0.8)
        axes.axvline(0, color=MUTED, linewidth=0.8)
        axes.plot(
            np.insert(v, apart, np.nan), np.insert(force, apart, np.nan), color=C1, linewidth=2.0
        )
        axes.margins(0.08, 0.18)
        axes.set_xlabel(f"velocity, {unit}")
        axes.set_ylabel(f"friction, {unit_of_force}")
        axes.grid(axis="y")
        axes.plot(v[:1], force[:1], "o", color=C1, markerfacecolor=SURFACE, markersize=6, zorder=4)
        axes.plot(v[-1:], force[-1:], "o", color=C1, markersize=5, zorder=5)
        label_at(axes, v[0], force[0], "start", INK, offset=(8, -10))
        if abs(force[-1] - force[0]) > 0.15 * np.ptp(axes.get_ylim()):
            label_at(axes, v[-1], force[-1], "end", INK, offset=(8, 9))

    return draw


def _impacts(t: Array, v: Array) -> NDArray[np.intp]:
    """Return the places of samples before which the velocity jumps at an instant.

    No line joins the two states, since friction between them is that of neither.
    """
    at_once = np.diff(t) <= 4.0 * np.spacing(np.abs(t[1:]))
    return np.flatnonzero(at_once & (np.abs(np.diff(v)) > JUMP * np.abs(v).max(initial=0.0))) + 1


def draw_runs(
    runs: Mapping[str, Trajectory],
    *,
    column: str = "x",
    title: str = "displacement",
    chosen: str | None = None,
    until: float | None = None,
) -> Draw:
    """Return a drawing of several runs over each other, named where they end.

    Parameters
    ----------
    runs : mapping of str to Trajectory
        The runs by name.
    column, title : str
        What is drawn, and what it is called.
    chosen : str, optional
        The run that stands out; the first if not given.
    until : float, optional
        Last time shown [s].

    Returns
    -------
    callable
        Draws it.
    """
    end = min(run.span[1] for run in runs.values())
    last = min(until or max(horizon(run, column) for run in runs.values()), end)
    seen = {name: dense(run, last) for name, run in runs.items()}

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        look = looks(runs, chosen)
        times = np.linspace(0.0, last, 200)
        everything = np.concatenate([run[column] for run in seen.values()])
        factor, unit = scale_of(everything, next(iter(runs.values())).units[column])
        ends = {}
        for name, run in seen.items():
            colour, dashes, width, order = look[name]
            y = factor * run[column]
            axes.plot(run.t, y, color=colour, linestyle=dashes, linewidth=width, zorder=order)
            ends[name] = factor * runs[name].at(times)[column]
        axes.margins(x=0, y=0.1)
        axes.set_xlabel("time, s")
        axes.set_ylabel(f"{title}, {unit}")
        axes.grid(axis="y")
        groups = grouped(ends, 0.02 * float(np.ptp(axes.get_ylim())))
        if narrow:
            texts = {names[0]: ", ".join(names) for _, names in groups}
            label_curves(
                axes,
                [Curve(times, ends[n], texts.get(n, ""), look[n].colour) for n in ends],
            )
            return
        label_ends(axes, last, [(y, wrapped(ns, 30), look[ns[0]].colour) for y, ns in groups])

    return draw


def plot_run(
    run: Trajectory,
    ax: PanelTarget = None,
    *,
    slip: str | None = None,
    rate: str | None = None,
    until: float | None = None,
    normal_force: bool = False,
    band: Band | None = None,
) -> Panels:
    """Plot displacement, velocity, friction and perhaps normal force of a run against time.

    A run with several contacts has a panel for the friction of each of them instead, or a raster of
    their modes where there are more than six.

    Parameters
    ----------
    run : Trajectory
        The run.
    ax : sequence of Axes, Figure or SubFigure, optional
        Three Axes, or four with the normal force; a new figure if not given.
    slip, rate : str, optional
        Names of the coordinate and its rate; ``"x"`` and ``"v"``, or the first ones of the run, if
        not given.
    until : float, optional
        Last time shown [s]; some time after the body has arrived if not given.
    normal_force : bool
        Whether the normal force has a panel too.
    band : Band, optional
        Where 95 % of the runs lie that have a law's parameters from its estimates; shown pale.

    Returns
    -------
    array of Axes (3,) or (4,)
        The panels; times at rest are shaded, and events are dots.

    Raises
    ------
    InputError
        If `ax` is no Axes or has another number of panels.
    UnknownNameError
        If the run has no such column.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> [axes.get_ylabel() for axes in plot_run(run, Figure())]
    ['displacement, m', 'velocity, m/s', 'friction, N']
    """
    check_type("run", run, Trajectory)
    if run.contacts:
        return on_panels(draw_contacts(run, until=until), ax, contact_sizes(run)["wide"])
    slip, rate = motion_names(run, slip, rate)
    draw = draw_run(
        run, slip=slip, rate=rate, until=until, normal_force=normal_force, band=band
    )  # fmt: skip
    return on_panels(draw, ax, (FORCE_SIZES if normal_force else RUN_SIZES)["wide"])


def plot_friction_velocity(
    run: Trajectory,
    ax: Target = None,
    *,
    slip: str | None = None,
    rate: str | None = None,
    until: float | None = None,
) -> Axes:
    """Plot friction against velocity along a run.

    Parameters
    ----------
    run : Trajectory
        The run.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.
    slip : str, optional
        Name of the coordinate, as in `plot_run`.
    rate : str, optional
        Name of its rate, as in `plot_run`.
    until : float, optional
        Last time shown [s]; some time after the body has arrived if not given.

    Returns
    -------
    matplotlib.axes.Axes
        The panel; a ring is where the run begins, a dot where it ends.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> plot_friction_velocity(run, Figure().add_subplot()).get_xlabel()
    'velocity, m/s'
    """
    check_type("run", run, Trajectory)
    slip, rate = motion_names(run, slip, rate)
    draw = draw_friction_velocity(run, slip=slip, rate=rate, until=until)
    return on_axes(draw, ax, FRICTION_SIZES["wide"])


def plot_runs(
    runs: Mapping[str, Trajectory],
    ax: Target = None,
    *,
    column: str | None = None,
    title: str | None = None,
    chosen: str | None = None,
    until: float | None = None,
) -> Axes:
    """Plot one column of several runs against time.

    Parameters
    ----------
    runs : mapping of str to Trajectory
        The runs by name.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.
    column : str, optional
        What is drawn; the coordinate that `plot_run` shows if not given.
    title : str, optional
        What it is called; ``"displacement"`` or the name of the column if not given.
    chosen : str, optional
        The run that stands out; the first if not given.
    until : float, optional
        Last time shown [s].

    Returns
    -------
    matplotlib.axes.Axes
        The panel; each run is named where it ends.

    Raises
    ------
    InputError
        If there is no run.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> laws = {f"{mu}": Coulomb(kinetic_coefficient=mu) for mu in (0.2, 0.3)}
    >>> runs = {name: simulate(rig, law, t_end=1.0) for name, law in laws.items()}
    >>> len(plot_runs(runs, Figure()).lines)
    2
    """
    if not runs:
        raise InputError("plot_runs needs at least one run, got none.")
    for run in runs.values():
        check_type("runs", run, Trajectory)
    shown = coordinate_name(next(iter(runs.values())), column)
    title = title or (shown.replace("_", " ") if column else "displacement")
    draw = draw_runs(runs, column=shown, title=title, chosen=chosen, until=until)
    return on_axes(draw, ax, FRICTION_SIZES["wide"])
