"""Figures of what many runs show: ensembles, cycles, profiles, comparisons of runs."""

import textwrap
from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.engine.trajectory import Ensemble, Trajectory
from stickslip.errors import InputError, UnknownNameError
from stickslip.quantities import full_path
from stickslip.show.formatting import scale_of
from stickslip.show.plots import axes as drawing
from stickslip.show.plots.svg import Draw
from stickslip.show.plots.theme import (
    C1,
    C2,
    MUTED,
    SLIP_BACK,
    check_type,
    label_at,
    name_size,
    shade,
)
from stickslip.study.control import ClosedLoop, limit_cycle
from stickslip.study.optimisation import Optimum
from stickslip.study.sweep import Band

# Plots of many runs: an output over what was varied, and the band that runs lie in.

SIZE: Final = (880, 320)
REASON_WIDTH: Final = 30
"""Letters of a line of a reason in the legend."""


def draw_ensemble(runs: Ensemble, output: str, parameter: str | None) -> Draw:
    """Return a drawing of an output of each run over a parameter; of its number without one."""
    values = runs[output]
    columns = values[:, None] if values.ndim == 1 else values
    places = np.arange(len(runs)) if parameter is None else runs.parameters[parameter]
    early = np.array([not status.complete for status in runs.status])

    reasons = dict.fromkeys(ending.label for ending in runs.status if not ending.complete)
    ended = "\n".join(
        ["ended early:", *(textwrap.fill(reason, REASON_WIDTH) for reason in reasons)]
    )

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
        over = "run" if parameter is None else drawing.labelled(parameter, runs.units[parameter])
        axes.set_xlabel(over)
        axes.set_ylabel(drawing.labelled(output, runs.units[output]))

    return draw


def plot_ensemble(
    runs: Ensemble,
    ax: drawing.Target = None,
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
    return drawing.on_axes(draw_ensemble(runs, output, path), ax, SIZE)


def draw_band(band: Band, state: str) -> Draw:
    """Return a drawing of the median of a state against time, and of where 95 % of runs lie."""
    factor, unit = scale_of(np.abs(band.states[state]).ravel(), band.units[state])
    low, median, high = factor * band.states[state]

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_subplot()
        axes.fill_between(band.t, low, high, color=C1, alpha=0.22, linewidth=0)
        axes.plot(band.t, median, color=C1)
        drawing.name_panel(axes, x="time, s", y=f"{state}, {unit}", room=(0, 0.1))

    return draw


def plot_band(band: Band, ax: drawing.Target = None, *, state: str | None = None) -> Axes:
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
    return drawing.on_axes(draw_band(band, state), ax, SIZE)


# Travel of one block under several readings of how it was set in motion.

EXCITATION_SIZES: Final = drawing.Sizes(wide=(880, 310), narrow=(358, 300))


def excitation_colours(labels: Mapping[str, object], chosen: str | None = None) -> dict[str, str]:
    """Return the colour of each reading: blue for the one that is taken.

    Examples
    --------
    >>> excitation_colours({"push": 0, "spring": 0}, "spring")["spring"] == C1
    True
    """
    chosen = next(iter(labels)) if chosen is None else chosen
    others = iter(drawing.RIVALS * len(labels))
    return {label: C1 if label == chosen else next(others) for label in labels}


def draw_excitations(
    runs: Mapping[str, Trajectory],
    *,
    chosen: str | None = None,
    band: tuple[float, float] | None = None,
    measured: str = "measured",
    slip: str = "x",
) -> Draw:
    """Return a drawing of the travel in several readings, named with their values at the end.

    Parameters
    ----------
    runs : mapping of str to Trajectory
        Runs by what they are called.
    chosen : str, optional
        The reading that is taken; the first if not given.
    band : tuple of float, optional
        Range of the measured travel [m]; a line if its ends are equal.
    measured : str
        What the band is called.
    slip : str
        Name of the slipping coordinate.

    Returns
    -------
    callable
        Draws it, with a dot where the block has come to rest.
    """
    last = max(drawing.horizon(run, slip) for run in runs.values())
    colours = excitation_colours(runs, chosen)
    chosen = next(iter(runs)) if chosen is None else chosen

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        curves = [
            _reading(axes, label, run, last, slip, colours[label], label == chosen)
            for label, run in runs.items()
        ]
        axes.margins(x=0, y=0.16 if narrow else 0.1)
        if band:
            if band[1] > band[0]:
                axes.axhspan(*band, facecolor=SLIP_BACK, edgecolor="none", zorder=0)
            else:
                axes.axhline(band[0], color=MUTED, linewidth=1.0, zorder=1)
            label_at(axes, 0.0, band[1], measured, MUTED, offset=(6, 8))
        if any(_rest(run, last) for run in runs.values()):
            axes.annotate(
                "dot: block at rest", (0.98, 0.06), xycoords="axes fraction",
                ha="right", color=MUTED, fontsize=name_size(),
            )  # fmt: skip
        drawing.name_panel(axes, x="time, s", y="travel, m")
        if narrow:
            drawing.label_curves(axes, curves)
        else:
            drawing.label_ends(axes, last, [(float(c.y[-1]), [c.text], c.colour) for c in curves])

    return draw


def _reading(
    axes: Axes, label: str, run: Trajectory, last: float, slip: str, colour: str, is_chosen: bool
) -> drawing.Curve:
    """Draw one reading, and return its curve with its name and value."""
    seen = drawing.dense(run, last)
    start = float(run.at(run.span[:1])[slip][0])
    x = seen[slip] - start
    axes.plot(seen.t, x, color=colour, linewidth=2.2 if is_chosen else 1.5, zorder=3)
    stop = _rest(run, last)
    if stop is not None:
        at = run.at([stop])[slip] - start
        axes.plot([stop], at, "o", color=colour, markersize=5, zorder=4)
    value = f"{float(x[-1]):.3f} m".replace("-", "−")
    return drawing.Curve(seen.t, x, f"{label}: {value}", colour)


def _rest(run: Trajectory, last: float) -> float | None:
    """Return when the last stop was, if the body stays there and it is shown."""
    if not run.events or abs(run.events[-1].to_mode) == 1 or run.events[-1].t > last:
        return None
    return run.events[-1].t


# Velocity around the stop: the exact run, and what a fixed step makes of it.

STEPS_SHOWN: Final = 9
"""Steps before and after the stop: chatter is as high as the velocity lost in one or two."""
COLUMNS: Final = 2


def draw_fixed_steps(
    exact: Trajectory, fixed: Mapping[str, Trajectory], *, rate: str = "v"
) -> Draw:
    """Return a drawing of the velocity around the stop, a panel for each fixed-step run.

    Parameters
    ----------
    exact : Trajectory
        The event-driven run.
    fixed : mapping of str to Trajectory
        Fixed-step runs by what they are called, such as "10 ms, no stick rule".
    rate : str
        Name of the slip velocity.

    Returns
    -------
    callable
        Draws it; each panel covers the same number of steps, so that chatter is as wide.
    """
    result = next((e.t for e in reversed(exact.events) if e.to_mode == 0), None)
    stop = exact.span[1] if result is None else result

    def draw(figure: Figure, narrow: bool) -> None:
        columns = 1 if narrow else min(COLUMNS, len(fixed))
        panels = drawing.panel_grid(figure, len(fixed), columns)
        for index, (axes, (label, run)) in enumerate(zip(panels, fixed.items(), strict=True)):
            axes.set_title(label)
            _stop_panel(axes, exact, run, stop, rate, named=index == 0)
        for axes in panels[-columns:]:
            origin = "end of the run" if result is None else "exact stop"
            axes.set_xlabel(f"time from the {origin}, ms")

    return draw


def _stop_panel(
    axes: Axes, exact: Trajectory, run: Trajectory, stop: float, rate: str, *, named: bool
) -> None:
    step = float(np.median(np.diff(run.t))) if len(run.t) > 1 else exact.span[1] - stop
    first = max(stop - STEPS_SHOWN * step, exact.span[0])
    last = min(stop + 2 * STEPS_SHOWN * step, exact.span[1])
    inside = (run.t >= first) & (run.t <= last)
    seen = exact.at(np.union1d(np.linspace(first, last, 300), [min(max(stop, first), last)]))
    v, v_exact = run[rate][inside], seen[rate]
    factor, unit = scale_of(np.concatenate([v, v_exact]), exact.units[rate])
    curves = [
        drawing.Curve(1e3 * (seen.t - stop), factor * v_exact, "exact", C1),
        drawing.Curve(1e3 * (run.t[inside] - stop), factor * v, "fixed step", C2),
    ]
    axes.axhline(0, color=MUTED, linewidth=0.8, zorder=1)
    axes.plot(curves[0].x, curves[0].y, color=C1, linewidth=2.2, zorder=2)
    axes.plot(curves[1].x, curves[1].y, "o-", color=C2, linewidth=1.2, markersize=3.5, zorder=3)
    axes.set_ylabel(f"velocity, {unit}")
    axes.margins(x=0.01, y=0.18)
    if named:
        drawing.label_curves(axes, curves)


# A motion that repeats itself: its progress, and one cycle of its velocity about zero.

CYCLE_SIZES: Final = drawing.Sizes(wide=(880, 320), narrow=(358, 480))

CYCLE_ROOM: Final = 1.35
"""Height of the velocity panel on either side of zero, as a multiple of the lowest velocity."""
CYCLE_SAMPLES: Final = 700


def draw_cycles(
    runs: Mapping[str, Trajectory],
    *,
    chosen: str,
    cycle: tuple[float, float],
    slip: str = "x",
    rate: str = "v",
) -> Draw:
    """Return a drawing of displacement in time, and of the velocity near zero within a cycle."""
    look = drawing.looks(runs, chosen)

    def draw(figure: Figure, narrow: bool) -> None:
        left, right = figure.subplots(*((2, 1) if narrow else (1, 2)))
        left.margins(x=0, y=0.25 if narrow else 0.12)
        _progress(left, {name: drawing.dense(run) for name, run in runs.items()}, slip, look)
        first, last = cycle
        # Fixed steps are shown where they stand, so that one sees them.
        times = {
            name: [first, *run.t[(run.t > first) & (run.t < last)], last]
            for name, run in runs.items()
        }
        times[chosen] = list(np.union1d(np.linspace(first, last, CYCLE_SAMPLES), times[chosen]))
        inside = {name: run.at(times[name]) for name, run in runs.items()}
        reach = -CYCLE_ROOM * min(float(run[rate].min()) for run in inside.values())
        factor, unit = scale_of([reach], next(iter(runs.values())).units[rate])
        for name, run in inside.items():
            colour, _, width, order = look[name]
            right.plot(
                run.t, factor * run[rate], "-" if name == chosen else "o-", color=colour,
                linewidth=width, markersize=2.5, zorder=order,
            )  # fmt: skip
        spans = [
            (max(low, first), high) for low, high in runs[chosen].stick_spans() if high > first
        ]
        shade(right, drawing.within(spans, last))
        right.axhline(0.0, color=MUTED, linewidth=0.8, zorder=1)
        right.set_xlim(first, last)
        if reach > 0.0:
            right.set_ylim(-factor * reach, factor * reach)
        right.set_ylabel(f"velocity{' near zero' if reach > 0.0 else ''}, {unit}")
        for axes in (left, right):
            axes.set_xlabel("time, s")

    return draw


def _progress(
    axes: Axes, runs: Mapping[str, Trajectory], slip: str, look: Mapping[str, drawing.LineStyle]
) -> None:
    everything = np.concatenate([run[slip] for run in runs.values()])
    factor, unit = scale_of(everything, next(iter(runs.values())).units[slip])
    curves = []
    for name, run in runs.items():
        colour, dashes, width, order = look[name]
        y = factor * run[slip]
        axes.plot(run.t, y, color=colour, linestyle=dashes, linewidth=width, zorder=order)
        curves.append(drawing.Curve(run.t, y, name, colour))
    axes.set_ylabel(f"displacement, {unit}")
    axes.grid(axis="y")
    drawing.label_curves(axes, curves)


def plot_limit_cycle(
    run: Trajectory | ClosedLoop,
    ax: drawing.PanelTarget = None,
    *,
    slip: str | None = None,
    rate: str | None = None,
) -> drawing.Panels:
    """Plot a run that repeats itself, and its velocity near zero in the last cycle.

    Parameters
    ----------
    run : Trajectory or ClosedLoop
        The run.
    ax : sequence of Axes, Figure or SubFigure, optional
        Two Axes; a new figure if not given.
    slip, rate : str, optional
        Names of the coordinate and its rate; the first ones of the run if not given.

    Returns
    -------
    array of Axes (2,)
        Displacement against time, and velocity near zero; times at rest are shaded.

    Raises
    ------
    InputError
        If the velocity has no limit cycle.

    Examples
    --------
    >>> from stickslip import Coulomb, TowedBlock, simulate
    >>> block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> panels = plot_limit_cycle(simulate(block, law, t_end=80.0), Figure())
    >>> first, last = panels[1].get_xlim()
    >>> round(float(last - first), 3)
    7.611
    """
    run = run.run if isinstance(run, ClosedLoop) else run
    check_type("run", run, Trajectory, ClosedLoop)
    slip, rate = drawing.motion_names(run, slip, rate)
    cycle = limit_cycle(run, rate)
    if not cycle.is_limit_cycle:
        how = "fewer than three cycles" if cycle.kind == "none" else f"a {cycle.kind} motion"
        raise InputError(
            f"{rate} has no limit cycle: the second half of the run has {how}; plot_run shows it."
        )
    end = run.span[1]
    draw = draw_cycles({"": run}, chosen="", cycle=(end - cycle.period, end), slip=slip, rate=rate)
    return drawing.on_panels(draw, ax, CYCLE_SIZES["wide"])


# The best motion over its cycles, or the front of two objectives.

FRONT_SIZE: Final = (560, 340)


def draw_optimum(optimum: Optimum) -> Draw:
    """Return a drawing of the best motion: its last cycle, or the front of two objectives."""
    if len(optimum.goals) > 1:
        return _front(optimum)
    cycle = optimum.best.cycles[0]
    slip, rate = optimum.travel
    return draw_cycles(
        {"": optimum.run},
        chosen="",
        cycle=(optimum.run.span[1] - cycle.period, optimum.run.span[1]),
        slip=slip,
        rate=rate,
    )


def _front(optimum: Optimum) -> Draw:
    columns = [[motion.goals[goal.name] for motion in optimum.motions] for goal in optimum.goals]
    scales = [
        scale_of(values, optimum.units[goal.name])
        for values, goal in zip(columns, optimum.goals, strict=True)
    ]

    def draw(figure: Figure, narrow: bool) -> None:  # noqa: ARG001  # one panel fits both
        axes = figure.add_subplot()
        (y, x), ((high, y_unit), (wide, x_unit)) = columns, scales
        axes.plot(wide * np.array(x), high * np.array(y), color=C1, marker="o", linewidth=1.0)
        axes.set_xlabel(f"{optimum.goals[1].title}, {x_unit}")
        axes.set_ylabel(f"{optimum.goals[0].title}, {y_unit}")
        axes.grid()

    return draw


def plot_optimum(optimum: Optimum, ax: drawing.PanelTarget = None) -> drawing.Panels:
    """Plot the best motion over its cycles, or the front of two objectives.

    Parameters
    ----------
    optimum : Optimum
        What `optimise` returns.
    ax : Axes, sequence of Axes, Figure or SubFigure, optional
        Two Axes for one objective, one for two; a new figure if not given.

    Returns
    -------
    array of Axes (2,) or (1,)
        Displacement and velocity of the best motion; or its motions as points.
    """
    check_type("optimum", optimum, Optimum)
    size = FRONT_SIZE if len(optimum.goals) > 1 else CYCLE_SIZES["wide"]
    return drawing.on_panels(draw_optimum(optimum), ax, size)
