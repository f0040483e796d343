"""Figures of campaigns: mean velocities, orbits, basins of attraction."""

import textwrap
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from stickslip.errors import InputError
from stickslip.show.formatting import percent, scale_of
from stickslip.show.plots.axes import LETTER, Target, labelled, legend_above, name_panel, on_axes
from stickslip.show.plots.svg import Draw
from stickslip.show.plots.theme import (
    C1,
    C2,
    C3,
    C4,
    DATA,
    INK,
    MUTED,
    SLIP_BACK,
    STICK,
    SURFACE,
    check_type,
    name_size,
    pixel_of,
    shade,
)
from stickslip.study.sweep import (
    CYCLE,
    Basins,
    Branch,
    EventCurve,
    Orbit,
    OrbitChart,
    OrbitDiagram,
    SensitivityIndices,
    VelocityBand,
    VelocityMap,
)
from stickslip.units import per_second

BASIN_COLOURS: Final = (SLIP_BACK, STICK, "#dcefe7", "#efe1ee", "#f6dfd0", "#e3e6e8")
"""Fill of each basin, the largest first."""
POINT_COLOURS: Final = (C1, C2, C3, C4, INK, MUTED)
"""Points of the motion each basin leads to."""
DIVERGING: Final = LinearSegmentedColormap.from_list("direction", [C2, SURFACE, C1])
"""Backward, nowhere, forward."""

STOPPED: Final[Mapping[str, Any]] = MappingProxyType(
    {"facecolor": "none", "edgecolor": DATA, "hatch": "////", "linewidth": 0.0}
)
"""How it is marked where runs ended early."""
REASON_WIDTH: Final = 0.48
"""Share of the width of a figure that a line of a reason takes."""

COLUMN: Final = 290
"""Width of a column of a legend above a panel [CSS px]."""
SWEEP_SIZE: Final = (880, 380)


def draw_velocity_map(result: VelocityMap) -> Draw:
    """Return a drawing of mean velocities: a curve over one axis, colours over two.

    Parameters
    ----------
    result : VelocityMap
        Over one or two parameters.

    Returns
    -------
    callable
        Draws it. Backward motion has a band behind the curve, and reversals are marked; where runs
        ended early it is hatched, with the reason in a legend.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> from stickslip.study.sweep import average_velocity
    >>> axis = Axis(inertia=1.0, drive=Sine(amplitude=4.0, frequency=1.0))
    >>> result = average_velocity(
    ...     axis, Coulomb(kinetic_coefficient=0.5), {"frequency": [1.0, 2.0]}, settle=20, cycles=4
    ... )
    >>> callable(draw_velocity_map(result))
    True
    """
    if len(result.axes) not in (1, 2):
        raise InputError(
            f"a map cannot show {len(result.axes)} parameters; fix all but two of them."
        )

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_subplot()
        factor, unit = scale_of(result.velocity[np.isfinite(result.velocity)], result.unit)
        of = f" of {result.coordinate}" if result.coordinate else ""
        label = f"mean velocity{of}, {unit}"
        if len(result.axes) == 1:
            _curve(axes, result, factor, label)
        else:
            _colours(figure, axes, result, factor, label)

    return draw


def _curve(axes: Axes, result: VelocityMap, factor: float, label: str) -> None:
    ((path, values),) = result.axes.items()
    axes.plot(values, factor * result.velocity, color=C1, marker="o", markersize=2.5, linewidth=1.6)
    axes.margins(x=0.01, y=0.12)
    axes.axhline(0.0, color=MUTED, linewidth=0.8)
    still = ~result.moves() & np.isfinite(result.velocity)
    shade(axes, _stretches(values, still))
    shade(axes, _stretches(values, (result.velocity < 0) & ~still), colour=SLIP_BACK)
    turns = result.reversals()
    axes.plot(turns, 0.0 * turns, "o", color=C1, markerfacecolor=SURFACE, markersize=7, zorder=4)
    for place in turns:
        axes.annotate(
            f"{place:.3g}",
            (place, 0.0),
            xytext=(7, 8),
            textcoords="offset points",
            color=INK,
            fontsize=name_size(),
        )
    chaotic = result.chaotic
    if chaotic.any():
        axes.errorbar(
            values[chaotic], factor * result.velocity[chaotic], factor * result.spread[chaotic],
            fmt="o", color=C2, markersize=3.5, elinewidth=1.0, zorder=3,
            label="chaotic; bars: starts 1e-9 apart",
        )  # fmt: skip
    open_ = np.isfinite(result.velocity) & (result.closes == 0) & ~chaotic
    if open_.any():
        axes.plot(
            values[open_], factor * result.velocity[open_], "o", color=C1, markersize=4,
            markerfacecolor=SURFACE, zorder=3, label="not closed, not chaotic",
        )  # fmt: skip
    _mark_early_ends(axes, values, result.status)
    name_panel(axes, x=labelled(path, result.units[path]), y=label)


def draw_velocity_band(
    result: VelocityBand,
    measured: Mapping[float, float] | Sequence[tuple[float, float]] | None = None,
) -> Draw:
    """Return a drawing of the band of the mean velocity over many laws, and what was measured."""

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        low, median, high = result.low, result.median, result.high
        factor, unit = scale_of(median[np.isfinite(median)], result.velocity_unit)
        label = f"{percent(result.level)} band over all candidate laws"
        axes.fill_between(
            result.values,
            factor * low,
            factor * high,
            color=C1,
            alpha=0.3,
            linewidth=0,
            label=label,
        )
        axes.plot(result.values, factor * median, color=C1, linewidth=1.4, label="median")
        if measured:
            pairs = measured.items() if isinstance(measured, Mapping) else measured
            points = np.array([*pairs])
            axes.plot(
                points[:, 0],
                factor * points[:, 1],
                "o",
                color=DATA,
                markersize=3.0 if narrow else 4.5,
                label="measured",
            )
        axes.axhline(0.0, color=MUTED, linewidth=0.8)
        name_panel(
            axes,
            x=labelled(result.path, result.unit),
            y=f"mean velocity, {unit}",
            room=(0.01, 0.08),
        )
        legend_above(axes, 1 if narrow else 3, small=True)
        if not np.isfinite(result.velocities).all():
            _mark_early_ends(axes, result.values, result.status.T)

    return draw


def plot_velocity_band(
    result: VelocityBand, ax: Target = None, *, measured: Mapping[float, float] | None = None
) -> Axes:
    """Plot the band of the mean velocity over many laws, and what was measured.

    Parameters
    ----------
    result : VelocityBand
        What `velocity_band` returns.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.
    measured : mapping of float to float, optional
        Value of the parameter -> mean velocity [m/s], drawn as points.

    Returns
    -------
    matplotlib.axes.Axes
        The panel.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> from stickslip.study.sweep import velocity_band
    >>> axis = Axis(inertia=1.0, drive=Sine(amplitude=4.0, frequency=1.0))
    >>> laws = [Coulomb(kinetic_coefficient=mu) for mu in (0.4, 0.5)]
    >>> result = velocity_band(axis, laws, {"frequency": [1.0, 2.0]}, settle=20, cycles=4)
    >>> plot_velocity_band(result, Figure(), measured={1.0: 0.0}).get_xlabel()
    'frequency, Hz'
    """
    check_type("result", result, VelocityBand)
    return on_axes(draw_velocity_band(result, measured), ax, SWEEP_SIZE)


def _mark_early_ends(axes: Axes, values: Any, status: Any) -> None:
    """Hatch where runs ended early along the horizontal axis, with the reasons in a legend."""
    early = np.array(
        [[not ending.complete for ending in row] for row in status.reshape(len(values), -1)]
    )
    for low, high in _stretches(values, early.any(axis=1)):
        axes.axvspan(low, high, zorder=0, **STOPPED)
    _name_early_ends(axes, status)


def _name_early_ends(axes: Axes, status: Any) -> None:
    """Name what is hatched above the panel: the reasons for which runs ended early, if some did."""
    reasons = dict.fromkeys(ending.label for ending in status.ravel() if not ending.complete)
    handles, _ = axes.get_legend_handles_labels()
    figure = cast("Figure", axes.get_figure(root=True))
    width = figure.bbox.width * pixel_of(figure)
    letters = int(REASON_WIDTH * width / LETTER)
    handles += [
        Patch(label=textwrap.fill(f"No value: {reason}", max(letters, 20)), **STOPPED)
        for reason in reasons
    ]
    if handles:
        axes.legend(
            handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2,
            ncols=max(1, int(width // COLUMN)),
        )  # fmt: skip


def _stretches(values: Any, chosen: Any) -> list[tuple[float, float]]:
    """Return the spans between the middles of neighbouring points that are chosen."""
    edges = _edges(np.asarray(values))
    edges[0], edges[-1] = values[0], values[-1]
    spans = zip(edges[:-1], edges[1:], chosen, strict=True)
    return [(min(a, b), max(a, b)) for a, b, wanted in spans if wanted]


def _colours(figure: Figure, axes: Axes, result: VelocityMap, factor: float, label: str) -> None:
    (across, xs), (up, ys) = reversed(list(result.axes.items()))
    velocity = factor * result.velocity
    largest = float(np.nanmax(np.abs(velocity), initial=0.0)) or 1.0
    mesh = axes.pcolormesh(
        _edges(xs), _edges(ys), velocity, cmap=DIVERGING, vmin=-largest, vmax=largest,
        rasterized=True,
    )  # fmt: skip
    _hatch_cells(axes, xs, ys, result.status)
    moving = np.ma.masked_where(~_judged(result), velocity)
    if min(velocity.shape) > 1 and moving.count() and moving.min() < 0.0 < moving.max():
        axes.contour(xs, ys, moving, levels=[0.0], colors=[INK], linewidths=1.0)
    if result.chaotic.any():
        j, i = np.nonzero(result.chaotic)
        axes.plot(xs[i], ys[j], ".", color=INK, markersize=2, label="chaotic")
    axes.set_xlabel(labelled(across, result.units[across]))
    axes.set_ylabel(labelled(up, result.units[up]))
    bar = figure.colorbar(mesh, ax=axes, pad=0.02)
    bar.set_label(label)
    bar.outline.set_visible(False)
    _name_early_ends(axes, result.status)


def _hatch_cells(axes: Axes, xs: Any, ys: Any, status: Any) -> None:
    """Hatch the cells of a map whose runs ended early; what is drawn on them covers that."""
    early = [[not ending.complete for ending in row] for row in status]
    if not np.any(early):
        return
    x, y = _edges(np.asarray(xs)), _edges(np.asarray(ys))
    axes.add_patch(Rectangle((x[0], y[0]), x[-1] - x[0], y[-1] - y[0], zorder=0, **STOPPED))


def _judged(result: VelocityMap) -> Any:
    """Return where the velocity has a sign, or lies right between two signs."""
    sign = np.where(result.moves(), np.sign(result.velocity), 0.0)
    rows, columns = sign.shape
    around = np.pad(sign, 1)
    shifts = [(i, j) for i in range(3) for j in range(3)]
    near = np.stack([around[i : i + rows, j : j + columns] for i, j in shifts])
    between = (near.max(axis=0) > 0) & (near.min(axis=0) < 0)
    return ((sign != 0) | between) & np.isfinite(result.velocity)


def draw_orbits(result: OrbitDiagram | Branch, show: str | None = None) -> Draw:
    """Return a drawing of branches of periodic orbits: solid where stable, dashed where not.

    Parameters
    ----------
    result : OrbitDiagram or Branch
        The branches; settled runs of a diagram are dots behind them.
    show : str, optional
        What stands over the parameter: a coordinate that advances from cycle to cycle, by its mean
        velocity, or a free state at the start of a cycle. The first that advances if not given, or
        the first state where none does.

    Returns
    -------
    callable
        Draws it, with marks at folds, period doublings, grazing contacts, and where sticking
        changes.

    Raises
    ------
    InputError
        If the orbits have neither a free state nor an advance of that name.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> from stickslip.study.sweep import continue_orbit, periodic_orbit
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=2.0))
    >>> orbit = periodic_orbit(axis, Coulomb(kinetic_coefficient=0.5))
    >>> callable(draw_orbits(continue_orbit(orbit, "frequency", (1.9, 2.4))))
    True
    """
    branches = result.branches if isinstance(result, OrbitDiagram) else (result,)
    name, velocity = _shown(result, show)

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_subplot()
        curves = [_heights(branch, name, velocity=velocity) for branch in branches]
        dots = _settled(result, name, velocity=velocity)
        known = np.concatenate([*curves, np.ravel(dots[1])])
        unit = result.units.get(name, "1")
        unit = per_second(unit) if velocity else unit
        factor, unit = scale_of(known, unit)
        for marks, chosen in zip(SETTLED, (~dots[2], dots[2]), strict=True):
            axes.plot(dots[0][chosen], factor * dots[1][chosen], **marks)
        for branch, heights in zip(branches, curves, strict=True):
            colour = POINT_COLOURS[(branch.cycles - 1) % len(POINT_COLOURS)]
            for style, chosen in (("-", branch.stable), ("--", ~branch.stable)):
                spread_ = chosen.copy()
                spread_[1:] |= chosen[:-1]  # a line goes on to the first point of the other kind
                line = np.where(spread_, factor * heights, np.nan)
                axes.plot(branch.values, line, style, color=colour, linewidth=1.5)
        axes.margins(x=0.01, y=0.06)
        axes.autoscale_view()
        kinds = dict[str, None]()
        taken = np.empty((0, 2))  # pixels of marks: those of wide branches come first
        for branch in sorted(branches, key=lambda branch: -float(np.ptp(branch.values))):
            for event in (e for e in branch.events if e.kind in MARKS):
                place = event.value, factor * _height(event.orbit, name, velocity=velocity)
                pixel = axes.transData.transform(place)
                if np.all(np.hypot(*(taken - pixel).T) > MARK):
                    taken = np.vstack([taken, pixel])
                    kinds[event.kind] = None
                    axes.plot(*place, MARKS[event.kind], zorder=4, **MARKED)
        _name_orbits(axes, branches, kinds, chosen=dots[2])
        axes.set_xlabel(labelled(result.path, result.unit))
        what = f"mean velocity of {name}" if velocity else f"{name} at the start of a cycle"
        what = "length of a cycle" if name == CYCLE else what
        axes.set_ylabel(f"{what}, {unit}")
        axes.grid(axis="y")

    return draw


MARKS: Final[Mapping[str, str]] = MappingProxyType(
    {"fold": "o", "period doubling": "D", "branch point": "s", "torus": "*", "grazing": "^",
     "sticking": "v"}
)  # fmt: skip
"""Marks of events of branches."""
MARKED: Final[Mapping[str, Any]] = MappingProxyType(
    {"color": MUTED, "markerfacecolor": SURFACE, "markersize": 4.0, "markeredgewidth": 0.8}
)
SETTLED: Final[tuple[Mapping[str, Any], ...]] = (
    MappingProxyType({"linestyle": "", "marker": ".", "color": INK, "markersize": 2, "zorder": 3}),
    MappingProxyType({"linestyle": "", "marker": ".", "color": DATA, "markersize": 2, "zorder": 2}),
)
"""Marks of settled runs: regular and chaotic ones."""
MARK: Final = 8.0
"""Distance of marks from each other, at least [px]: nearer ones are left out."""


def _name_orbits(
    axes: Axes, branches: Sequence[Branch], kinds: Mapping[str, object], *, chosen: Any
) -> None:
    """Name lines, marks and dots in a legend above the panel."""
    for cycles in sorted({branch.cycles for branch in branches}):
        colour = POINT_COLOURS[(cycles - 1) % len(POINT_COLOURS)]
        axes.plot([], [], "-", color=colour, label=f"period {cycles}")
    if not all(branch.stable.all() for branch in branches):
        axes.plot([], [], "--", color=MUTED, label="unstable")
    for kind in kinds:
        axes.plot([], [], MARKS[kind], label=kind, **MARKED)
    names = ("settled runs", bool((~chosen).any())), ("chaotic runs", bool(chosen.any()))
    for marks, (name, there) in zip(SETTLED, names, strict=True):
        if there:
            axes.plot([], [], **{**marks, "markersize": 4, "label": name})
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, ncols=4)


def _shown(result: OrbitDiagram | Branch, show: str | None) -> tuple[str, bool]:
    """Return what stands over the parameter, and whether it is a mean velocity."""
    advance = result.velocities if isinstance(result, OrbitDiagram) else result.advances
    moving, free = tuple(advance), result.states
    if show is None and CYCLE in free:
        return CYCLE, False
    if show is None:
        return (moving[0], True) if moving else (free[0], False)
    if show not in (*moving, *free):
        raise InputError(
            f"draw_orbits: show must be one of {', '.join((*moving, *free))}, got {show!r}."
        )
    return show, show in moving


def _heights(branch: Branch, name: str, *, velocity: bool) -> Any:
    if velocity:
        return branch.mean_velocity(name)
    return branch.starts[:, branch.states.index(name)]


def _height(orbit: Orbit, name: str, *, velocity: bool) -> float:
    if name == CYCLE:
        return orbit.period / orbit.cycles
    return orbit.mean_velocity[name] if velocity else orbit.start[name]


def _settled(result: OrbitDiagram | Branch, name: str, *, velocity: bool) -> tuple[Any, Any, Any]:
    """Return parameter and height of the dots of settled runs, if any, and which are chaotic."""
    if isinstance(result, Branch):
        return np.empty(0), np.empty(0), np.empty(0, dtype=bool)
    if velocity:
        return result.values, result.velocities[name], result.chaotic
    points = result.samples[:, :, result.states.index(name)]
    values, chaotic = (np.repeat(x, points.shape[1]) for x in (result.values, result.chaotic))
    return values, points.ravel(), chaotic


CURVES: Final[Mapping[str, Any]] = MappingProxyType(
    {
        "fold": {"color": INK, "linewidth": 1.4},
        "period doubling": {"color": C3, "linewidth": 1.4},
        "grazing": {"color": C4, "linewidth": 1.4, "linestyle": "--"},
        "sticking": {"color": MUTED, "linewidth": 0.9, "linestyle": ":"},
    }
)
"""Lines of curves of events."""
COINCIDE: Final = ("cusp", "fold-flip", "with fold", "with flip", "with grazing", "with sticking")
"""Ends of names of points of codimension two."""
POINT_MARKS: Final = "*Dos^v"
"""Their marks."""
NAMED: Final = 0.01
"""Least share of the cells of a region that has its number of stable motions written in it."""


def draw_orbit_chart(result: OrbitChart | EventCurve) -> Draw:
    """Return a drawing of curves of events over two parameters, and of the motions behind them.

    Parameters
    ----------
    result : OrbitChart or EventCurve
        The curves. Cells of a chart are coloured by the mean velocity of the fastest stable motion
        and regions have the number of stable motions written in them.

    Returns
    -------
    callable
        Draws it, with marks at points of codimension two.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> from stickslip.study.sweep import orbit_chart
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=2.0))
    >>> ranges = {"frequency": (1.9, 2.4), "amplitude": (3.0, 4.0)}
    >>> law = Coulomb(kinetic_coefficient=0.5)
    >>> chart = orbit_chart(axis, law, ranges, cycles=1, values=(4, 3), lines=1, runs=2)
    >>> callable(draw_orbit_chart(chart))
    True
    """
    curves = result.curves if isinstance(result, OrbitChart) else (result,)

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        if isinstance(result, OrbitChart):
            _motions(figure, axes, result)
        named = dict[str, None]()
        for curve in curves:
            label = None if curve.kind in named else curve.kind
            named[curve.kind] = None
            axes.plot(*curve.values.T, label=label, **CURVES[curve.kind])
        for ending, mark in zip(COINCIDE, POINT_MARKS, strict=True):
            points = [p.values for c in curves for p in c.points if p.kind.endswith(ending)]
            if points:
                axes.plot(
                    *np.transpose(points), mark, zorder=4, label=ending, linestyle="none", **MARKED
                )
        across, up = map(labelled, result.paths, result.parameter_units)
        axes.set_xlabel(across)
        axes.set_ylabel(up)
        # of the figure, as it is wider than the panel beside its colour bar
        handles = axes.get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper left", ncols=2 if narrow else 5)

    return draw


def _motions(figure: Figure, axes: Axes, result: OrbitChart) -> None:
    """Colour cells by the mean velocity, and hatch them by the number of stable motions."""
    xs, ys = result.axes
    edges = _edges(xs), _edges(ys)
    axes.set_xlim(xs[0], xs[-1])
    axes.set_ylim(ys[0], ys[-1])
    for name, speeds in [*result.velocities.items()][:1]:
        factor, unit = scale_of(speeds[np.isfinite(speeds)], per_second(result.units[name]))
        largest = factor * float(np.nanmax(np.abs(speeds), initial=0.0)) or 1.0
        mesh = axes.pcolormesh(
            *edges, factor * speeds.T, cmap=DIVERGING, vmin=-largest, vmax=largest, rasterized=True
        )
        bar = figure.colorbar(mesh, ax=axes, pad=0.02)
        bar.set_label(f"mean velocity of {name}, {unit}")
        bar.outline.set_visible(False)
    for number in np.unique(result.count).tolist():
        for i, j in _middles(result.count == number):
            # at an edge half of a number in the middle of its cell would lie on the axis
            ha = {0: "left", len(xs) - 1: "right"}.get(i, "center")
            va = {0: "bottom", len(ys) - 1: "top"}.get(j, "center")
            axes.text(xs[i], ys[j], str(number), color=INK, ha=ha, va=va)
    axes.plot([], [], linestyle="none", label="numbers: stable motions")


def _middles(chosen: Any) -> list[tuple[int, int]]:
    """Return the cell farthest from the edge of each part of a grid, of parts of some size."""
    from scipy.ndimage import distance_transform_edt, label

    parts, count = label(chosen)
    depth, result = distance_transform_edt(np.pad(chosen, 1))[1:-1, 1:-1], []
    for part in range(1, count + 1):
        own = parts == part
        if own.sum() >= NAMED * chosen.size:
            i, j = np.unravel_index(np.argmax(np.where(own, depth, 0.0)), own.shape)
            result.append((int(i), int(j)))
    return result


def draw_basins(result: Basins) -> Draw:
    """Return a drawing of basins of attraction with the points of the motions they lead to.

    Parameters
    ----------
    result : Basins
        The basins. Hatched are starts whose runs ended early, with the reason in the legend.

    Returns
    -------
    callable
        Draws it.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> from stickslip.study.sweep import basins
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=1.0))
    >>> grid = {"x": [-1.0, 0.0, 1.0], "v": [-1.0, 1.0]}
    >>> callable(draw_basins(basins(axis, Coulomb(kinetic_coefficient=0.5), grid, settle=30)))
    True
    """

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        (across, xs), (up, ys) = result.starts.items()
        count = max(1, len(result.attractors))
        fills = [BASIN_COLOURS[i % len(BASIN_COLOURS)] for i in range(count)]
        axes.pcolormesh(
            _edges(xs), _edges(ys), np.ma.masked_less(result.index.T, 0),
            cmap=ListedColormap(fills), vmin=-0.5, vmax=count - 0.5, rasterized=True,
        )  # fmt: skip
        _hatch_cells(axes, xs, ys, result.status.T)
        axes.set_xlim(xs.min(), xs.max())
        axes.set_ylim(ys.min(), ys.max())
        axes.set_xlabel(labelled(f"initial {across}", result.units[across]))
        axes.set_ylabel(labelled(f"initial {up}", result.units[up]))
        for number, motion in enumerate(result.attractors):
            colour = POINT_COLOURS[number % len(POINT_COLOURS)]
            if {across, up} <= set(result.states):
                i, j = result.states.index(across), result.states.index(up)
                axes.plot(
                    motion.points[:, i], motion.points[:, j], "o", color=colour, markersize=4.5
                )
            kind = f"period {motion.period}" if motion.period else "not periodic"
            axes.plot([], [], "o", color=colour, label=f"{100 * motion.share:.0f} %, {kind}")
        if narrow:
            axes.locator_params(axis="x", nbins=4)  # numbers of small starts are long
        _name_early_ends(axes, result.status)

    return draw


def _edges(values: Any) -> Any:
    """Return the borders of cells around points."""
    if len(values) == 1:
        half = 0.5 * (abs(values[0]) or 1.0)
        return np.array([values[0] - half, values[0] + half])
    middles = 0.5 * (values[1:] + values[:-1])
    ends = 1.5 * values[[0, -1]] - 0.5 * values[[1, -2]]
    return np.concatenate([ends[:1], middles, ends[1:]])


def draw_sensitivity(results: Sequence[SensitivityIndices]) -> Draw:
    """Return a drawing of sensitivity indices with their intervals, a panel for each output."""

    def draw(figure: Figure, _narrow: bool) -> None:
        panels = figure.subplots(len(results), squeeze=False)
        for axes, result in zip(panels[:, 0], results, strict=True):
            _bars(axes, result)

    return draw


def _bars(axes: Axes, result: SensitivityIndices) -> None:
    shown = [name for name in result.indices if name in result.half_widths]
    places = np.arange(len(result.factors), dtype=np.float64)
    height = 0.7 / len(shown)
    for row, (name, colour) in enumerate(zip(shown, (C1, C2), strict=False)):
        axes.barh(
            places + (row - 0.5 * (len(shown) - 1)) * height,
            result.indices[name],
            0.9 * height,
            xerr=result.half_widths[name],
            color=colour,
            ecolor=INK,
            label={"mu_star": "mean size of the change"}.get(name, f"{name} index"),
        )
    axes.set_yticks(places, [labelled(path, "1") for path in result.factors])
    axes.invert_yaxis()
    axes.axvline(0.0, color=MUTED, linewidth=0.8)
    of_change = result.method == "morris"
    axes.set_xlabel(labelled(result.output, result.unit) if of_change else "share of the variance")
    axes.set_title(f"{result.output}, 95 % intervals", loc="left")
    axes.set_axisbelow(True)
    axes.grid(axis="x")
    if len(shown) > 1:
        axes.legend(loc="lower right")


def plot_sweep(
    result: VelocityMap
    | Basins
    | SensitivityIndices
    | OrbitDiagram
    | Branch
    | OrbitChart
    | EventCurve,
    ax: Target = None,
) -> Axes:
    """Plot mean velocities, orbits, basins, or sensitivity indices.

    Parameters
    ----------
    result : VelocityMap, Basins, SensitivityIndices, OrbitDiagram, Branch, OrbitChart, EventCurve
        What `average_velocity`, `basins`, `CampaignRuns.sensitivity`, `orbit_diagram`,
        `continue_orbit`, `orbit_chart` or `continue_event` returns.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.

    Returns
    -------
    matplotlib.axes.Axes
        The panel. A colour bar, of velocities over two parameters, is beside it.

    Raises
    ------
    InputError
        If `result` is of another type, or a map of more than two parameters.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> from stickslip.study.sweep import average_velocity
    >>> axis = Axis(inertia=1.0, drive=Sine(amplitude=4.0, frequency=1.0))
    >>> law = Coulomb(kinetic_coefficient=0.5)
    >>> result = average_velocity(axis, law, {"frequency": [1.0, 2.0]}, settle=20, cycles=4)
    >>> plot_sweep(result, Figure()).get_xlabel()
    'frequency, Hz'
    """
    kinds = (
        VelocityMap, Basins, SensitivityIndices, OrbitDiagram, Branch, OrbitChart, EventCurve
    )  # fmt: skip
    check_type("result", result, *kinds)
    if isinstance(result, VelocityMap):
        draw = draw_velocity_map(result)
    elif isinstance(result, SensitivityIndices):
        draw = draw_sensitivity([result])
    elif isinstance(result, OrbitDiagram | Branch):
        draw = draw_orbits(result)
    elif isinstance(result, OrbitChart | EventCurve):
        draw = draw_orbit_chart(result)
    else:
        draw = draw_basins(result)
    return on_axes(draw, ax, SWEEP_SIZE)
