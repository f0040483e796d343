"""Figures of runs: one or several over each other, several contacts, motion, closed loops."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stickslip.engine.trajectory import UNLOADED, Trajectory
from stickslip.errors import InputError
from stickslip.show.formatting import number, scale_of
from stickslip.show.plots import theme
from stickslip.show.plots.axes import (
    JUMP,
    Array,
    Curve,
    Panels,
    PanelTarget,
    Sizes,
    Target,
    coordinate_name,
    dense,
    grouped,
    horizon,
    label_curves,
    label_ends,
    legend_above,
    looks,
    motion_names,
    name_events,
    name_modes,
    name_panel,
    on_axes,
    on_panels,
    raster,
    thinned,
    within,
    wrapped,
)
from stickslip.show.plots.svg import Draw
from stickslip.study.control import ClosedLoop
from stickslip.study.sweep import Band

# Figures of a run with several contacts.

MOST_PANELS: Final = 6
"""Contacts that have a panel of friction each; the modes of more are shown as a raster."""
STATE_SIZES: Final = Sizes(wide=(880, 380), narrow=(358, 320))
SERIES: Final = (theme.C1, theme.C2, theme.C3, theme.C4)
"""Colours of coordinates; more than these are not told apart."""
PANEL: Final = 130
"""Height of a panel [px]."""


def contact_sizes(run: Trajectory) -> Sizes:
    """Return the sizes of the figure: a panel for each contact, or the raster."""
    panels = len(run.contacts) or 1
    height = 60 + PANEL * panels if panels <= MOST_PANELS else min(160 + 12 * panels, 900)
    return Sizes(wide=(880, height), narrow=(358, height))


def draw_contacts(run: Trajectory, *, until: float | None = None) -> Draw:
    """Return a drawing of friction at each contact against time."""
    last = run.span[1] if until is None else min(until, run.span[1])
    seen = dense(run, last)

    def draw(figure: Figure, narrow: bool) -> None:
        if len(run.contacts) > MOST_PANELS:
            _raster(figure.subplots(), seen, narrow)
            return
        names = run.contacts or (run.only_contact,)
        panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for axes, name in zip(panels, names, strict=True):
            _friction(axes, run.contact(name), seen.contact(name), name, last)
        figure.align_ylabels()
        panels[-1].set_xlabel("time, s")

    return draw


def draw_states(run: Trajectory, *, band: Band | None = None) -> Draw:
    """Return a drawing of all coordinates against time, those of one unit together."""
    seen = dense(run, run.span[1])
    units: dict[str, list[str]] = {}
    for name in run.states:
        if run.units[name] in ("m", "rad") and ":" not in name:
            units.setdefault(run.units[name], []).append(name)
    times = sorted({event.t for event in run.events})

    def draw(figure: Figure, narrow: bool) -> None:
        panels = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
        for axes, names in zip(panels, units.values(), strict=True):
            # Draw coordinates of one unit; those of a few are named, many are curves of one colour.
            factor, unit = scale_of(
                np.concatenate([seen[name] for name in names]), run.units[names[0]]
            )
            at = run.at(times)
            few = len(names) <= len(SERIES)
            for i, name in enumerate(names):
                colour = SERIES[i] if few else theme.MUTED
                width = 1.8 if few else 0.9
                axes.plot(seen.t, factor * seen[name], color=colour, linewidth=width, label=name)
                if band is not None and name in band.states:
                    shade_band(axes, band, name, seen.span[1], factor=factor, colour=colour)
                if few:
                    axes.plot(times, factor * at[name], "o", color=colour, markersize=3.5, zorder=4)
            what = names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}"
            name_panel(axes, y=f"{what}, {unit}", room=(0, 0.1))
            if few and len(names) > 1:
                legend_above(axes, 2 if narrow else len(names))
        figure.align_ylabels()
        panels[-1].set_xlabel("time, s")

    return draw


def shade_band(
    axes: Axes, band: Band, name: str, last: float, *, factor: float, colour: str
) -> None:
    """Show pale where 95 % of the runs of a band lie."""
    shown = band.t <= last
    low, _, high = factor * band.states[name][:, shown]
    axes.fill_between(band.t[shown], low, high, color=colour, alpha=0.22, linewidth=0)


def _friction(axes: Axes, own: Trajectory, seen: Trajectory, name: str, last: float) -> None:
    """Draw the friction of one contact."""
    factor, unit = scale_of(seen["friction"], seen.units["friction"])
    axes.plot(seen.t, factor * seen["friction"], color=theme.C1, linewidth=1.8)
    axes.set_ylabel(f"friction, {unit}")
    axes.set_title(name, loc="left", fontsize="medium")
    axes.margins(x=0, y=0.15)
    axes.grid(axis="y")
    theme.shade(axes, within(own.stick_spans(), last))
    events = [event for event in own.events if event.t <= last]
    if events:
        at = own.at([event.t for event in events])
        axes.plot(at.t, factor * at["friction"], "o", color=theme.C1, markersize=4, zorder=4)


def _raster(axes: Axes, seen: Trajectory, narrow: bool) -> None:
    """Draw the raster with what its colours mean."""
    raster(axes, seen, {-1: theme.C2, 0: theme.MUTED, 1: theme.C1})
    axes.set_xlabel("time, s")
    modes = [np.rint(seen[f"mode:{name}"]) for name in seen.contacts]
    meanings = {"slip backward": theme.C2, "stick": theme.MUTED, "slip forward": theme.C1}
    if np.any(np.array(modes) == UNLOADED):
        meanings["open"] = theme.SURFACE
    for label, colour in meanings.items():
        axes.plot([], [], "s", color=colour, markeredgecolor=theme.MUTED, label=label)
    legend_above(axes, 2 if narrow else len(meanings), small=narrow)


# Figures of one run, and of several over each other.

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
            axes.plot(seen.t, factor * seen[name], color=theme.C1, linewidth=2.0)
            axes.set_ylabel(f"{title}, {unit}")
            if band is not None and name in band.states:
                shade_band(axes, band, name, last, factor=factor, colour=theme.C1)
            axes.margins(x=0, y=0.12)
            axes.grid(axis="y")
            theme.shade(axes, within(run.stick_spans(), last))
            if events:
                at = run.at([event.t for event in events])
                axes.plot(at.t, factor * at[name], "o", color=theme.C1, markersize=4.5, zorder=4)
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
        axes.axhline(0, color=theme.MUTED, linewidth=0.8)
        axes.axvline(0, color=theme.MUTED, linewidth=0.8)
        axes.plot(
            np.insert(v, apart, np.nan),
            np.insert(force, apart, np.nan),
            color=theme.C1,
            linewidth=2.0,
        )
        name_panel(axes, x=f"velocity, {unit}", y=f"friction, {unit_of_force}", room=(0.08, 0.18))
        axes.plot(
            v[:1],
            force[:1],
            "o",
            color=theme.C1,
            markerfacecolor=theme.SURFACE,
            markersize=6,
            zorder=4,
        )
        axes.plot(v[-1:], force[-1:], "o", color=theme.C1, markersize=5, zorder=5)
        theme.label_at(axes, v[0], force[0], "start", theme.INK, offset=(8, -10))
        if abs(force[-1] - force[0]) > 0.15 * np.ptp(axes.get_ylim()):
            theme.label_at(axes, v[-1], force[-1], "end", theme.INK, offset=(8, 9))

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
        name_panel(axes, x="time, s", y=f"{title}, {unit}", room=(0, 0.1))
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
    theme.check_type("run", run, Trajectory)
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
    theme.check_type("run", run, Trajectory)
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
        theme.check_type("runs", run, Trajectory)
    shown = coordinate_name(next(iter(runs.values())), column)
    title = title or (shown.replace("_", " ") if column else "displacement")
    draw = draw_runs(runs, column=shown, title=title, chosen=chosen, until=until)
    return on_axes(draw, ax, FRICTION_SIZES["wide"])


# Several runs in one figure: displacement, velocity, a closer look, and their differences.

CLOSE_SAMPLES: Final = 6000
"""Samples of a run that is shown in part: so many that a tenth of it is still smooth."""
MOST_BESIDE: Final = 2
"""Panels side by side that leave room for names where the curves end."""


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
            axes.axhline(factor * level, color=theme.MUTED, linewidth=1.0, linestyle=(0, (5, 4)))
            ends = np.array(axes.dataLim.intervalx)
            curves.append(Curve(ends, np.full(2, factor * level), name, theme.MUTED))
        name_panel(axes, x="time, s", y=f"{view.title}, {unit}", room=(0, 0.1))
        if np.min(everything) < 0.0 or view.column != views[0].column:
            axes.axhline(0.0, color=theme.MUTED, linewidth=0.8, zorder=0)
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
                [(float(curve.y[-1]), [curve.text], curve.colour) for curve in named],
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
        close = {name: dense(run, end, CLOSE_SAMPLES) for name, run in runs.items()}
        seen = {name: run.at(run.t[run.t >= first]) for name, run in close.items()}
    if not view.difference:
        return {name: (run.t, run[view.column]) for name, run in seen.items()}
    result = {}
    for name in runs:
        if name != chosen:
            t = np.union1d(seen[name].t, seen[chosen].t)
            t = t[t <= min(runs[name].span[1], runs[chosen].span[1])]
            result[name] = t, runs[name].at(t)[view.column] - runs[chosen].at(t)[view.column]
    return result


# A run in closed loop: where the body is, and what the controller makes of it.

LOOP_SIZES: Final = Sizes(wide=(880, 380), narrow=(358, 420))
"""Sizes of the figure."""
SHORTEST_REST: Final = 1e-3
"""Share of the time shown that a rest must last to be shaded."""
DASHED: Final = (0, (5, 2))
LOOP_SAMPLES: Final = 1200
COMMANDS: Final = (theme.C3, theme.C4, theme.C1, theme.C2)
"""Colours of the commands of several drives, in turn."""


def draw_closed_loop(
    loop: ClosedLoop,
    *,
    state: str = "x",
    reference: float | Callable[[float], float] | None = None,
    level: float | None = None,
    since: float = 0.0,
    unit: str = "N",
) -> Draw:
    """Return a drawing of a state and of the command against time, rests shaded.

    Parameters
    ----------
    loop : ClosedLoop
        The run.
    state : str
        What is controlled.
    reference : float or callable, optional
        Where it should be, a number or a function of time.
    level : float, optional
        Break-away level, drawn on both sides of 0 beside the command.
    since : float
        First time shown [s].
    unit : str
        Unit of the command.

    Returns
    -------
    callable
        Draws it, one panel below the other.
    """
    run = dense(loop.run, samples=LOOP_SAMPLES)
    seen = run.at(run.t[run.t >= since])
    last = float(seen.t[-1])
    rests = [
        (max(a, since), b)
        for a, b in _seen_along(loop, state).stick_spans()
        if b - max(a, since) > SHORTEST_REST * (last - since)
    ]

    def draw(figure: Figure, narrow: bool) -> None:  # noqa: ARG001
        above, below = figure.subplots(2, 1, sharex=True)
        for axes in (above, below):
            theme.shade(axes, rests)
            axes.set_xlim(since, last)
            axes.margins(x=0.0, y=0.18)
        _place(above, seen, state, reference)
        _command(below, loop, since, last, level)
        below.set_title(f"command, {unit}", color=theme.MUTED)
        below.set_xlabel("time, s (shaded: at rest)")

    return draw


def _seen_along(loop: ClosedLoop, state: str) -> Trajectory:
    """Return the run as the contact along a state sees it, or else the first."""
    run, coordinates = loop.run, loop.mechanism.coordinates
    if not run.contacts:
        return run
    along = dict(zip(loop.mechanism.rates, coordinates, strict=True)).get(state, state)
    slips = {
        contact.name: contact.slips
        for contact in loop.mechanism.contacts()
        if contact.name in run.contacts
    }
    own = [name for name, among in slips.items() if along in among]
    return run.contact((own or list(slips))[0])


def _place(
    axes: Axes, seen: Trajectory, state: str, reference: float | Callable[[float], float] | None
) -> None:
    """Draw the state, and where it should be."""
    factor, unit = scale_of(seen[state], seen.units[state])
    curves = [Curve(seen.t, factor * seen[state], state, theme.C1)]
    axes.plot(seen.t, curves[0].y, color=theme.C1, zorder=3)
    if reference is not None:
        wanted = [reference(t) if callable(reference) else reference for t in seen.t]
        curves.append(Curve(seen.t, factor * np.array(wanted), "reference", theme.C2))
        axes.plot(seen.t, curves[-1].y, color=theme.C2, linestyle=DASHED, linewidth=1.2, zorder=2)
    axes.set_title(f"{state}, {unit}", color=theme.MUTED)
    label_curves(axes, curves)


def _command(axes: Axes, loop: ClosedLoop, since: float, last: float, level: float | None) -> None:
    """Draw the command when it acts, and what it must reach to break the body away."""
    when = loop.t + loop.delay
    curves = []
    shown = loop.commands if loop.drives else loop.commands[:, None]
    for i, values in enumerate(shown[when >= since].T):
        t, u = thinned(when[when >= since], values)
        style = "steps-post" if len(t) == int(np.sum(when >= since)) else "default"  # not held
        name = loop.drives[i] if loop.drives else ""  # the panel has its name
        colour = COMMANDS[i % len(COMMANDS)]
        axes.plot(t, u, drawstyle=style, color=colour, linewidth=1.2, zorder=3)
        curves.append(Curve(t, u, name, colour))
    if level is not None:
        for side in (-1.0, 1.0):
            axes.axhline(side * level, color=theme.MUTED, linestyle=DASHED, linewidth=1.0)
        curves.append(Curve(np.array([since, last]), np.full(2, level), "break-away", theme.MUTED))
    label_curves(axes, curves)


def plot_closed_loop(
    loop: ClosedLoop,
    ax: PanelTarget = None,
    *,
    state: str | None = None,
    reference: float | Callable[[float], float] | None = None,
    level: float | None = None,
    since: float = 0.0,
    unit: str = "N",
) -> Panels:
    """Plot a state and the command of a controller against time.

    Parameters
    ----------
    loop : ClosedLoop
        The run.
    ax : sequence of Axes, Figure or SubFigure, optional
        Two Axes; a new figure if not given.
    state : str, optional
        What is controlled; ``"x"`` or the first state if not given.
    reference : float or callable, optional
        Where it should be, a number or a function of time.
    level : float, optional
        Break-away level, drawn on both sides of 0 beside the command.
    since : float
        First time shown [s].
    unit : str
        Unit of the command.

    Returns
    -------
    array of Axes (2,)
        The panels; times at rest are shaded.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.study.control import PID, closed_loop
    >>> law = Coulomb(kinetic_coefficient=1.0)
    >>> control = PID(proportional=100.0, derivative=10.0, reference=0.1)
    >>> loop = closed_loop(Axis(inertia=1.0), law, control, period=1e-2, t_end=1.0)
    >>> [axes.get_title("left") for axes in plot_closed_loop(loop, Figure())]
    ['x, m', 'command, N']
    """
    theme.check_type("loop", loop, ClosedLoop)
    draw = draw_closed_loop(
        loop, state=coordinate_name(loop.run, state), reference=reference, level=level, since=since,
        unit=unit,
    )  # fmt: skip
    return on_panels(draw, ax, LOOP_SIZES["wide"])
