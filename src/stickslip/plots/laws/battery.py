"""Figures of the battery: a test of one law, or of several in one panel."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from stickslip.characterization import (
    BreakAway,
    Characteristic,
    Characterization,
    Cost,
    Creep,
    Drift,
    Hunting,
    Lag,
    Passivity,
    Presliding,
    SteadyCurve,
    StickSlipMap,
)
from stickslip.errors import InputError
from stickslip.formatting import number, scale_of
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, Target, on_axes, on_panels, panel_grid
from stickslip.plots.core.helpers import LineStyle, looks
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C2, INK, MUTED, STICK, SURFACE, label_at

Drawn: TypeAlias = Mapping[str, Any]
"""Results of one test by law."""
SIZE: Final = (880, 320)
PANEL: Final = (440, 260)
"""Size of a panel of a page with all tests [CSS px]."""
FILL: Final = LinearSegmentedColormap.from_list("amplitude", [SURFACE, STICK, C2])
LONG: Final = 36
"""Letters of a name from which on names stand below each other."""
LEGEND: Final = 2
"""Curves from which on a legend names them."""


def draw_characteristic(results: Mapping[str, Characteristic]) -> Draw:
    """Return a drawing of one test of several laws."""

    def draw(figure: Figure, narrow: bool) -> None:
        axes = figure.add_subplot()
        _panel(axes, results)
        _name(figure, [axes], narrow)

    return draw


def _panel(axes: Axes, results: Mapping[str, Characteristic]) -> None:
    PANELS[type(next(iter(results.values())))](axes, results, looks(results))


def _name(figure: Figure, panels: Sequence[Axes], narrow: bool) -> None:
    """Name the curves of all panels once, where there are several."""
    found = [one.get_legend_handles_labels() for one in panels if one.get_legend() is None]
    handles, labels = max(found, key=lambda one: len(one[1]), default=([], []))
    if len(labels) < LEGEND:
        return
    if figure.get_layout_engine() is None:  # of a user: nothing makes room beside the panels
        panels[0].legend(handles, labels, fontsize="small")
        return
    columns = 1 if narrow or max(map(len, labels)) > LONG else min(len(labels), 3)
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, fontsize="small")


def _line(axes: Axes, x: Any, y: Any, look: LineStyle, label: str = "", **more: Any) -> None:
    style = {"color": look.colour, "linestyle": look.dashes, "linewidth": 0.7 * look.width}
    axes.plot(x, y, label=label or "_", zorder=look.order, **{**style, **more})


def _steady(axes: Axes, results: Drawn, style: Mapping[str, LineStyle]) -> None:
    factor, unit = scale_of([max(one.velocity.max() for one in results.values())], "m/s")
    for title, one in results.items():
        half = len(one.velocity) // 2 if max(one.break_away) > 0.0 else None
        for part in (slice(None, half), slice(half, None)) if half else (slice(None),):
            name = title if part.start is None else ""
            _line(axes, factor * one.velocity[part], one.force[part], style[title], name)
        if max(one.break_away) > 0.0:
            _line(axes, [0, 0], [-one.break_away[0], one.break_away[1]], style[title])
    slow = factor * 10.0 * min(np.abs(one.velocity).min() for one in results.values())
    fast = factor * max(one.velocity.max() for one in results.values())
    decades = 10.0 ** np.arange(np.floor(np.log10(fast) + 0.01), np.log10(slow) + 0.5, -2)[::-1]
    axes.set_xscale("asinh", linear_width=slow)  # logarithmic on both sides, without a corner
    ticks = [*-decades[::-1], 0.0, *decades]
    axes.set_xticks(ticks, [number(one) for one in ticks])
    axes.set_xticks([], minor=True)
    axes.axhline(0, color=MUTED, linewidth=0.6, zorder=0)
    axes.set_xlabel(f"velocity, {unit} (logarithmic)")
    axes.set_ylabel("friction, N")


def _presliding(axes: Axes, results: Drawn, style: Mapping[str, LineStyle]) -> None:
    factor, unit = scale_of([max(one.displacement.max() for one in results.values())], "m")
    for title, one in results.items():
        _line(axes, factor * one.displacement, one.force, style[title], title)
    axes.set_xlabel(f"displacement, {unit}")
    axes.set_ylabel("friction, N")


def _break_away(axes: Axes, results: Drawn, style: Mapping[str, LineStyle]) -> None:
    for title, one in results.items():
        _line(axes, one.rate, one.force, style[title], title, marker="o", markersize=4)
    axes.set_xscale("log")
    _none_if_empty(axes, "no peak at break-away")
    axes.set_xlabel("rate of the force, N/s")
    axes.set_ylabel("break-away, N")


def _lag(axes: Axes, results: Drawn, style: Mapping[str, LineStyle]) -> None:
    factor, unit = scale_of([max(one.velocity.max() for one in results.values())], "m/s")
    for title, one in results.items():
        for i, (velocity, force) in enumerate(zip(one.velocity, one.force, strict=True)):
            faint = 1.0 if i == len(one.frequency) - 1 else 0.45
            name = title if faint == 1.0 else ""
            _line(axes, factor * velocity, force, style[title], name, alpha=faint)
    axes.set_xlabel(f"velocity, {unit}")
    axes.set_ylabel("friction, N")


def _map(axes: Axes, results: Drawn, style: Mapping[str, LineStyle]) -> None:
    first = next(iter(results.values()))
    factor, unit = scale_of([float(np.median(first.speed))], "m/s")
    shown = np.where(first.sticks, np.log10(np.maximum(first.amplitude, 1e-2)), np.nan)
    axes.pcolormesh(factor * first.speed, first.stiffness, shown, cmap=FILL, shading="nearest")
    for title, one in results.items():
        inside = np.isfinite(one.boundary)
        name = title if len(results) > 1 else "stick-slip up to here"
        _line(axes, factor * one.boundary[inside], one.stiffness[inside], style[title], name)
        if len(results) == 1:
            linear = np.isfinite(one.linear) & (one.linear > 0.0)
            if linear.any():
                x, y = factor * one.linear[linear], one.stiffness[linear]
                axes.plot(x, y, ":", color=MUTED, label="steady sliding is stable beyond")
            if np.isfinite(one.closed_form).any():
                x = factor * one.closed_form
                axes.plot(x, one.stiffness, "--", color=C2, label="closed form")
            axes.legend(fontsize="small", loc="upper right")
    if not first.sticks.any():
        axes.text(0.5, 0.5, "nowhere", transform=axes.transAxes, color=MUTED, ha="center")
    axes.set(xscale="log", yscale="log", xlim=factor * first.speed[[0, -1]])
    axes.set_ylim(*first.stiffness[[0, -1]])
    axes.set_xlabel(f"belt speed, {unit}")
    axes.set_ylabel("stiffness, N/m")


def _motion(axes: Axes, results: Drawn, style: Mapping[str, LineStyle]) -> None:
    reach = [float(np.abs(one.position).max()) for one in results.values()]
    factor, unit = scale_of([max(*reach, 1e-12)], "m")
    for title, one in results.items():
        _line(axes, one.t, factor * one.position, style[title], title)
    axes.set_xlabel("time, s")
    axes.set_ylabel(f"position, {unit}")


def _hunting(axes: Axes, results: Drawn, style: Mapping[str, LineStyle]) -> None:
    _motion(axes, results, style)
    one = next(iter(results.values()))
    factor, _ = scale_of([float(np.abs(one.position).max())], "m")
    axes.axhline(factor * one.target, color=MUTED, linewidth=0.8, linestyle=(0, (4, 3)))


def _passivity(axes: Axes, results: Drawn, style: Mapping[str, LineStyle]) -> None:
    names = [*results]
    energies = [one.worst for one in results.values()]
    factor, unit = _energy_scale(energies)
    colours = [style[name].colour for name in names]
    axes.barh(range(len(names)), [factor * one for one in energies], color=colours, height=0.5)
    for place, name in enumerate(names if len(names) > 1 else []):
        label_at(axes, 0.0, place - 0.32, name, INK, offset=(-6, 3), align="right")
    axes.set_yticks([])
    axes.set_ylim(len(names), -1)
    axes.axvline(0, color=MUTED, linewidth=0.8)
    axes.set_xlabel(f"least energy that friction takes in a cycle, {unit}")


def _energy_scale(energies: list[float]) -> tuple[float, str]:
    largest = max(map(abs, energies))
    for factor, unit in ((1.0, "J"), (1e3, "mJ")):
        if largest * factor >= 1.0 or largest == 0.0:
            return factor, unit
    return 1e6, "µJ"


def _cost(axes: Axes, results: Drawn, style: Mapping[str, LineStyle]) -> None:
    fastest = [float(one.speed.max(initial=0.0)) for one in results.values()]
    factor, unit = scale_of([0.01 * max(fastest)], "m/s")
    for title, one in results.items():
        seen = one.rate > 0.0
        _line(axes, factor * one.speed[seen], one.rate[seen], style[title], title)
    axes.set(xscale="log", yscale="log")
    _none_if_empty(axes, "no rate is fast, or none is known")
    axes.set_xlabel(f"velocity, {unit}")
    axes.set_ylabel("fastest rate, 1/s")


def _none_if_empty(axes: Axes, text: str) -> None:
    lines = [np.asarray(line.get_ydata(), dtype=float) for line in axes.lines]
    if not any(np.isfinite(line).any() for line in lines):
        axes.set(xscale="linear", yscale="linear")
        axes.text(0.5, 0.5, text, transform=axes.transAxes, color=MUTED, ha="center")


PANELS: Final[Mapping[type, Callable[[Axes, Drawn, Mapping[str, LineStyle]], None]]] = {
    SteadyCurve: _steady,
    Presliding: _presliding,
    BreakAway: _break_away,
    Lag: _lag,
    StickSlipMap: _map,
    Drift: _motion,
    Creep: _motion,
    Hunting: _hunting,
    Passivity: _passivity,
    Cost: _cost,
}


def plot_characteristic(result: Characteristic, ax: Target = None) -> Axes:
    """Plot a test of the battery.

    Parameters
    ----------
    result : Characteristic
        What a test gave.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.

    Returns
    -------
    matplotlib.axes.Axes
        The panel.

    Raises
    ------
    InputError
        If `result` is none.

    Examples
    --------
    >>> from stickslip import Coulomb, characterize
    >>> found = characterize(Coulomb(kinetic_coefficient=0.25), tests=["steady"])
    >>> plot_characteristic(found.steady, Figure().add_subplot()).get_ylabel()
    'friction, N'
    """
    check_type("result", result, Characteristic)
    return on_axes(draw_characteristic({result.title: result}), ax, SIZE)


def plot_characterization(result: Characterization, ax: PanelTarget = None) -> Panels:
    """Plot all tests of a law that were made, and those of the others beside it.

    Parameters
    ----------
    result : Characterization
        What the battery gave.
    ax : Axes, sequence of Axes, Figure or SubFigure, optional
        Where; a panel for each test. A new figure if not given.

    Returns
    -------
    array of Axes (n,)
        The panels.

    Raises
    ------
    InputError
        If `result` is none, or no test could be made.

    Examples
    --------
    >>> from stickslip import Coulomb, characterize
    >>> found = characterize(Coulomb(kinetic_coefficient=0.25), tests=["steady", "drift"])
    >>> len(plot_characterization(found, Figure()))
    2
    """
    check_type("result", result, Characterization)
    by_test = result.by_test
    if not by_test:
        raise InputError(f"no test of {result.title} could be made, so there is nothing to plot.")
    rows = -(-len(by_test) // 2)

    def draw(figure: Figure, narrow: bool) -> None:
        panels = panel_grid(figure, len(by_test), 1 if narrow else 2)
        for axes, results in zip(panels, by_test.values(), strict=True):
            _panel(axes, results)
            axes.set_title(next(iter(results.values())).title)
        if len(result.all) > 1:
            _name(figure, panels, narrow)

    return on_panels(draw, ax, (2 * PANEL[0], rows * PANEL[1]))
