"""Figure of the best motion over a cycle, the best three-phase motion beside it."""

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.formatting import scale_of
from stickslip.mechanisms import static_normal_forces
from stickslip.optimisation import (
    COSTS,
    Cycle,
    Optimum,
    ParetoFront,
    guide_of,
    load_shares,
    slip_of_body,
)
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, Target, on_axes, on_panels
from stickslip.plots.core.helpers import Array, Sizes
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, C2, INK, MUTED, label_at

PROFILE_SIZES: Final = Sizes(wide=(880, 620), narrow=(358, 1100))
FRONT_SIZE: Final = (560, 340)

SAMPLES: Final = 1200
DEGREES: Final = 180.0 / np.pi


def draw_profile(optimum: Optimum) -> Draw:
    """Return a drawing of the motion, what it takes and what it brings, over a cycle.

    Parameters
    ----------
    optimum : Optimum
        The best motion.

    Returns
    -------
    callable
        Draws it: six panels against time, limits as thin lines, the best three-phase motion dashed.
    """
    cycles = {optimum.kind: optimum.cycle}
    if optimum.kind != "three-phase" and optimum.three_phase is not None:
        cycles["three-phase"] = min(optimum.three_phase.cycles, key=optimum.goal.value)
    seen = {name: _columns(optimum, cycle) for name, cycle in cycles.items()}
    bounds, units = _bounds(optimum), _units(optimum)

    def draw(figure: Figure, narrow: bool) -> None:
        names = list(units)
        grid = figure.subplots(6 if narrow else 3, 1 if narrow else 2, sharex=True)
        # beside each other: the motion on the left, what comes of it on the right
        panels = dict(zip(names, np.asarray(grid).T.ravel(), strict=True))
        for column, axes in panels.items():
            _panel(axes, column, seen, units[column], bounds.get(column, ()))
        _name(panels[names[0]], seen, names[0], units[names[0]])
        figure.align_ylabels()
        for axes in np.atleast_2d(grid)[-1] if not narrow else [grid[-1]]:
            axes.set_xlabel("time in the cycle, s")

    return draw


def _columns(optimum: Optimum, cycle: Cycle) -> dict[str, Array]:
    """Return the columns over the last cycle, the travel from its beginning on."""
    run = cycle.run
    jumps = [event.t for event in run.events if event.t > cycle.begin]
    jumps += [float(p.start) for p in optimum.profile.pieces(run.span[1]) if p.start > cycle.begin]
    times = np.linspace(cycle.begin, run.span[1], SAMPLES)
    inside = np.array([t for t in jumps if t < run.span[1]])
    seen = run.at(np.union1d(times, np.concatenate([inside, np.nextafter(inside, -np.inf)])))
    found = {name: seen[name] for name in _names(optimum)}
    slip = slip_of_body(optimum.mechanism)
    return {"t": seen.t - cycle.begin} | found | {slip: found[slip] - found[slip][0]}


def _names(optimum: Optimum) -> tuple[str, ...]:
    mechanism = optimum.mechanism
    coordinate, rate, effort, _ = guide_of(mechanism)
    slip = slip_of_body(mechanism)
    speed = mechanism.rates[mechanism.coordinates.index(slip)]
    return coordinate, rate, effort, slip, speed, _least_loaded(optimum)


def _least_loaded(optimum: Optimum) -> str:
    """Return the column of the normal force that falls most, over that at rest."""
    shares = load_shares(optimum.mechanism, optimum.run)
    return min(shares, key=lambda column: float(shares[column].min()))


def _units(optimum: Optimum) -> dict[str, tuple[float, str]]:
    """Return factor and axis label of each column."""
    names, run = _names(optimum), optimum.run
    angular = optimum.mechanism.units[optimum.mechanism.coordinates.index(names[0])] == "rad"
    titles = ["angle" if angular else "position inside", "rate", names[2]]
    titles += ["displacement", "velocity", "normal force"]
    found = {}
    for name, title in zip(names, titles, strict=True):
        factor, unit = scale_of(run[name], run.units[name])
        if angular and name == names[0]:
            factor, unit = DEGREES, "degrees"
        found[name] = (factor, f"{title}, {unit}")
    return found


def _bounds(optimum: Optimum) -> dict[str, tuple[float, ...]]:
    """Return the limits by column."""
    given = optimum.limits.given()
    names = _names(optimum)
    found: dict[str, tuple[float, ...]] = {
        column: (-given[name], given[name])
        for column, name in zip(names, ("position", "rate", "effort"), strict=False)
        if name in given
    }
    column = names[-1]
    static = static_normal_forces(optimum.mechanism)
    contact = column.partition(":")[2]
    at_rest = static[contact] if contact else sum(static.values())  # of the only one
    return found | {column: (given["load_share"] * at_rest,)}


def _panel(
    axes: Axes,
    column: str,
    seen: dict[str, dict[str, Array]],
    unit: tuple[float, str],
    bounds: tuple[float, ...],
) -> None:
    factor, label = unit
    for bound in bounds:
        axes.axhline(factor * bound, color=INK, linewidth=0.8, linestyle=(0, (1, 2)))
    for (_, columns), (colour, dashes, width) in zip(
        reversed(list(seen.items())), _looks(len(seen)), strict=True
    ):
        axes.plot(
            columns["t"], factor * columns[column], color=colour, linestyle=dashes, linewidth=width
        )
    if not bounds:
        axes.axhline(0.0, color=MUTED, linewidth=0.6)
    axes.margins(x=0, y=0.1)
    axes.set_ylabel(label)
    axes.grid(axis="y")


def _looks(count: int) -> list[tuple[str, str, float]]:
    """Return how the curves are drawn, the best motion last and on top."""
    return [(C2, "--", 1.5), (C1, "-", 2.0)][2 - count :]


def _name(
    axes: Axes, seen: dict[str, dict[str, Array]], column: str, unit: tuple[float, str]
) -> None:
    """Name the curves at their highest points."""
    for (name, columns), colour in zip(seen.items(), (C1, C2), strict=False):
        top = int(np.argmax(columns[column]))
        label_at(
            axes,
            columns["t"][top],
            unit[0] * columns[column][top],
            name,
            colour,
            offset=(0, -12) if colour == C1 else (0, 9),
            align="center",
        )


def plot_profile(optimum: Optimum, ax: PanelTarget = None) -> Panels:
    """Plot the best motion over a cycle, what it takes and what it brings.

    Parameters
    ----------
    optimum : Optimum
        What `optimise_profile` returns.
    ax : sequence of Axes, Figure or SubFigure, optional
        Six Axes; a new figure if not given.

    Returns
    -------
    array of Axes (6,)
        The panels; limits are thin lines, the best three-phase motion is dashed.
    """
    check_type("optimum", optimum, Optimum)
    return on_panels(draw_profile(optimum), ax, PROFILE_SIZES["wide"])


def draw_front(front: ParetoFront) -> Draw:
    """Return a drawing of the mean speed of each motion of a front against its cost."""
    scale, unit = scale_of(front.costs, COSTS[front.cost])
    factor, speed_unit = scale_of(front.speeds, "m/s")
    title = {"energy": "work of the motor per travel", "back_slip": "back-slip per cycle"}

    def draw(figure: Figure, narrow: bool) -> None:  # noqa: ARG001  # one panel fits both
        axes = figure.add_subplot()
        axes.plot(scale * front.costs, factor * front.speeds, color=C1, marker="o", linewidth=1.0)
        axes.set_xlabel(f"{title[front.cost]}, {unit}")
        axes.set_ylabel(f"mean speed, {speed_unit}")
        axes.set_ylim(bottom=0.0)
        axes.grid(axis="y")

    return draw


def plot_front(front: ParetoFront, ax: Target = None) -> Axes:
    """Plot the mean speed of each motion of a front against its cost.

    Parameters
    ----------
    front : ParetoFront
        What `pareto_front` returns.
    ax : Axes, Figure or SubFigure, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    Axes
        Motions as points, the fastest at the right.
    """
    check_type("front", front, ParetoFront)
    return on_axes(draw_front(front), ax, FRONT_SIZE)
