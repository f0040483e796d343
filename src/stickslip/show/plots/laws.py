"""Figures of laws: curves, presliding loops, and measured friction with fitted laws."""

from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip import study
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, Stribeck
from stickslip.quantities import Quantity
from stickslip.show.formatting import number, scale_of
from stickslip.show.plots import theme
from stickslip.show.plots.axes import (
    Array,
    Curve,
    LineStyle,
    Sizes,
    Target,
    label_curves,
    looks,
    on_axes,
    panel_grid,
    wrapped,
)
from stickslip.show.plots.svg import Draw

# Figures of laws alone: friction against velocity, and against displacement before slip.

WIDE_COLUMNS: Final = 3
NARROW_COLUMNS: Final = 2
ROW_HEIGHT: Final = 165
LENGTHS: Final = 3.0
"""Widest presliding swing, over the presliding length: wide enough to see friction level off."""

LOAD: Final = Quantity("N", "N", above=0)
SPEED: Final = Quantity("v", "m/s", above=0)


def characteristic_sizes(count: int) -> Sizes:
    """Return the sizes of a figure of that many laws.

    Examples
    --------
    >>> characteristic_sizes(6)["wide"]
    (880, 380)
    """
    rows = {n: -(-count // n) for n in (WIDE_COLUMNS, NARROW_COLUMNS)}
    return Sizes(
        wide=(880, 50 + ROW_HEIGHT * rows[WIDE_COLUMNS]),
        narrow=(358, 50 + ROW_HEIGHT * rows[NARROW_COLUMNS]),
    )


def presliding_sizes(count: int) -> Sizes:
    """Return the sizes of a figure of that many laws.

    Examples
    --------
    >>> presliding_sizes(2)["narrow"]
    (358, 460)
    """
    return Sizes(wide=(880, 60 + 220 * (-(-count // WIDE_COLUMNS))), narrow=(358, 60 + 200 * count))


def draw_characteristics(
    laws: Mapping[str, FrictionLaw], load: float, v_max: float, *, chosen: str | None = None
) -> Draw:
    """Return a drawing of friction against slip velocity, a panel for each law.

    Parameters
    ----------
    laws : mapping of str to FrictionLaw
        Laws by title. At rest a law takes any force up to break-away; for laws with bristles the
        curve is that of steady sliding.
    load : float
        Normal force [N].
    v_max : float
        Highest slip speed [m/s].
    chosen : str, optional
        The law whose panel stands out; the first if not given.

    Returns
    -------
    callable
        Draws it; the other laws stand pale behind each.
    """
    chosen = next(iter(laws)) if chosen is None else chosen
    curves = {title: characteristic(law, load, v_max) for title, law in laws.items()}
    factor, unit = scale_of([v_max], "m/s")

    def draw(figure: Figure, narrow: bool) -> None:
        columns = min(NARROW_COLUMNS if narrow else WIDE_COLUMNS, len(curves))
        panels = panel_grid(figure, len(curves), columns, sharex=True, sharey=True)
        for axes, title in zip(panels, curves, strict=True):
            for other, (v, force) in curves.items():
                if other != title:
                    axes.plot(factor * v, force, color=theme.LINE, linewidth=1.2, zorder=1)
            v, force = curves[title]
            colour = theme.C1 if title == chosen else theme.INK
            axes.plot(factor * v, force, color=colour, linewidth=2.0, zorder=3)
            axes.set_title(title, color=colour)
            axes.axhline(0, color=theme.MUTED, linewidth=0.6, zorder=0)
            axes.margins(x=0.02, y=0.08)
        for axes in panels[-columns:]:
            axes.set_xlabel(f"velocity, {unit}")
            axes.tick_params(labelbottom=True)
        for axes in panels[::columns]:
            axes.set_ylabel("friction, N")

    return draw


def draw_stribeck(law: Stribeck, load: float) -> Draw:
    """Return a drawing of the Stribeck curve, its static and Coulomb level and velocity marked."""
    v_s = law.stribeck_velocity
    v = np.concatenate([[0.0], np.linspace(1e-9, 8.0 * v_s, 400)])
    force = np.asarray(law.sliding(v, load)) + np.zeros_like(v)
    f_s, f_c = law.static_coefficient * load, law.kinetic_coefficient * load
    at_v_s = float(law.sliding(v_s, load))
    factor, unit = scale_of([float(v[-1])], "m/s")

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_subplot()
        corner = ([0, factor * v_s, factor * v_s], [at_v_s, at_v_s, 0.0])
        for x, y in (([0, factor * v[-1]], [f_c, f_c]), corner):
            axes.plot(x, y, color=theme.MUTED, linewidth=0.9, linestyle=(0, (4, 3)))
        axes.plot([0, 0], [0, f_s], color=theme.C1, linewidth=2.2)
        axes.plot(factor * v, force, color=theme.C1, linewidth=2.2)
        axes.plot([0], [f_s], "o", color=theme.C1, markersize=5)
        axes.set_xlim(-0.02 * factor * v[-1], factor * v[-1])
        axes.set_ylim(0, 1.25 * f_s)
        axes.set_xlabel(f"velocity, {unit}")
        axes.set_ylabel("friction, N")
        static, coulomb, speed = map(theme.symbol_label, ("F_s", "F_c", "v_s"))
        end, mark = factor * v[-1], factor * v_s
        theme.label_at(
            axes, 0.0, f_s, f"{static} = {f_s:.2f} N, at rest up to this", theme.INK, offset=(9, 6)
        )
        theme.label_at(
            axes, end, f_c, f"{coulomb} = {f_c:.2f} N", theme.INK, offset=(0, -10), align="right"
        )
        theme.label_at(
            axes, mark, 0.0, f"{speed} = {number(mark)} {unit}", theme.INK, offset=(6, 14)
        )
        left = f"1/e of {static} − {coulomb} is left"
        theme.label_at(axes, mark, at_v_s, left, theme.MUTED, offset=(8, 6))

    return draw


def draw_presliding(
    laws: Mapping[str, FrictionLaw], *, load: float = 1.0, amplitude: float | None = None
) -> Draw:
    """Return a drawing of friction against a slow displacement to and fro, before full slip.

    Parameters
    ----------
    laws : mapping of str to FrictionLaw
        Laws by title.
    load : float
        Normal force [N].
    amplitude : float, optional
        Amplitude of the widest swing [m]; a few presliding lengths of each law if not given.

    Returns
    -------
    callable
        Draws a panel for each law, with its break-away level.
    """
    loops = {title: _loop(law, load, amplitude) for title, law in laws.items()}

    def draw(figure: Figure, narrow: bool) -> None:
        columns = 1 if narrow else min(len(loops), WIDE_COLUMNS)
        panels = panel_grid(figure, len(loops), columns)
        for axes, (title, loop) in zip(panels, loops.items(), strict=True):
            _presliding_curve(axes, loop, float(laws[title].break_away(load)))
            axes.set_title(title)
        for axes in panels[::columns]:
            axes.set_ylabel("friction, N")

    return draw


def _loop(law: FrictionLaw, load: float, amplitude: float | None) -> study.PreslidingLoop:
    return study.presliding_loop(
        law, amplitude or LENGTHS * study.presliding_length(law, load), load
    )


def _presliding_curve(axes: Axes, loop: study.PreslidingLoop, level: float | None) -> None:
    """Draw a loop, and the break-away level where it is known."""
    factor, unit = scale_of(loop.displacement, "m")
    axes.plot(factor * loop.displacement, loop.friction, color=theme.C1, linewidth=1.6)
    for side in () if level is None else (level, -level):
        axes.axhline(side, color=theme.MUTED, linewidth=0.8, linestyle=(0, (4, 3)))
    axes.margins(0.05, 0.14)
    if level is not None:
        _say_break_away(axes, level)
    axes.set_xlabel(f"displacement, {unit}")


def characteristic(law: FrictionLaw, load: float, v_max: float) -> tuple[Array, Array]:
    """Return velocity and force; at rest an upright line between the break-away levels.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> v, force = characteristic(Coulomb(kinetic_coefficient=0.25), load=4.0, v_max=0.1)
    >>> float(force[0]), float(force[-1])
    (-1.0, 1.0)
    """
    # Closer towards zero, where a static surplus fades within millimetres a second.
    speed = v_max * np.concatenate([np.geomspace(1e-6, 0.02, 120), np.linspace(0.021, 1.0, 150)])
    (back, held_back), (ahead, held) = (
        _one_way(law.towards(direction), speed, load) for direction in (-1, 1)
    )
    v = np.concatenate([-speed[::-1], [0.0, 0.0], speed])
    return v, np.concatenate([-back[::-1], [-held_back, held], ahead])


def _one_way(law: FrictionLaw, speed: Array, load: float) -> tuple[Array, float]:
    """Return the sizes of the force at slip speeds, and of what holds at rest."""
    force = np.asarray(law.steady(speed, load)) + np.zeros_like(speed)
    return force, float(force[0] if law.states else law.break_away(load))


def _say_break_away(axes: Axes, level: float) -> None:
    low = axes.get_xlim()[0]
    theme.label_at(axes, low, level, f"break-away {level:.3g} N", theme.MUTED, offset=(4, 8))


def plot_law(law: FrictionLaw, ax: Target = None, *, load: float = 1.0, speed: float = 0.1) -> Axes:
    """Plot the friction of a law against slip velocity.

    Parameters
    ----------
    law : FrictionLaw
        At rest it takes any force up to break-away; one with bristles is drawn as it slides
        steadily.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given. Several laws may be drawn on the same Axes.
    load : float
        Normal force [N].
    speed : float
        Highest slip speed [m/s].

    Returns
    -------
    matplotlib.axes.Axes
        The panel.

    Raises
    ------
    InputError
        If `law` is no law, or load or speed is not positive.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> ax = plot_law(Coulomb(kinetic_coefficient=0.25), Figure().add_subplot(), load=4.0)
    >>> float(ax.lines[0].get_ydata()[-1])
    1.0
    """
    theme.check_type("law", law, FrictionLaw)
    load = LOAD.check("plot_law", "load", load)
    speed = SPEED.check("plot_law", "speed", speed)
    draw = draw_characteristics({law.title: law}, load, speed)
    return on_axes(draw, ax, characteristic_sizes(4)["wide"])


def plot_presliding(
    loop: study.PreslidingLoop | FrictionLaw,
    ax: Target = None,
    *,
    load: float = 1.0,
    amplitude: float | None = None,
) -> Axes:
    """Plot friction against a slow displacement to and fro, before full slip.

    Parameters
    ----------
    loop : PreslidingLoop or FrictionLaw
        A loop as `presliding_loop` returns, or the law that it is made of.
    ax : Axes, Figure or SubFigure, optional
        Where; a new figure if not given.
    load : float
        Normal force of a law [N].
    amplitude : float, optional
        Amplitude of the widest swing of a law [m]; a few presliding lengths if not given.

    Returns
    -------
    matplotlib.axes.Axes
        The panel; of a law with its break-away level.

    Raises
    ------
    InputError
        If `loop` is neither, or load or amplitude is not positive.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=0.25, bristle_stiffness=1000.0)
    >>> plot_presliding(law, Figure().add_subplot(), load=10.0).get_xlabel()
    'displacement, mm'
    """
    theme.check_type("loop", loop, study.PreslidingLoop, FrictionLaw)
    title, level = "", None
    if isinstance(loop, FrictionLaw):
        if not loop.states:
            raise InputError(
                f"{loop.title} friction has no presliding: the contact does not move before it"
                " slips. Give a law with bristles, such as Dahl(...)."
            )
        load = LOAD.check("plot_presliding", "load", load)
        title, level = loop.title, float(loop.break_away(load))
        loop = _loop(loop, load, amplitude)
    shown = loop

    def draw(figure: Figure, _narrow: bool) -> None:
        axes = figure.add_subplot()
        _presliding_curve(axes, shown, level)
        axes.set_title(title)
        axes.set_ylabel("friction, N")

    return on_axes(draw, ax, characteristic_sizes(4)["wide"])


# Measured friction against velocity, with the laws that were fitted to it.

MAP_SIZES: Final = Sizes(wide=(880, 320), narrow=(358, 500))
LOW: Final = 0.25
"""Largest speed of the second panel over that of the first, before rounding."""
ONE_WAY: Final = 0.01
"""Share of the points below which a direction counts as not measured."""
SLOW_POINTS: Final = 30
"""Points below that speed with which a second panel is worth its place."""
OUTER: Final = 0.3
"""Share of the points [%] beyond each end of the vertical axis."""
SINGLE: Final = 100
"""Points up to which each is drawn to be seen by itself."""
SPREAD: Final = 100.0
"""Largest speed over the smallest from which readings in one direction have a logarithmic axis."""
TURNS: Final = {0: (theme.DATA, "o"), 1: (theme.C3, "o"), -1: (theme.C4, "^")}
"""Colour and marker of points by whether their speed rises or falls."""
FEWEST_POINTS: Final = 8
"""... with so many points at least."""
WIDTH: Final = 22
"""Letters of a line of a name."""


class MapLaw(NamedTuple):
    """A law of a friction map, and the constant force with it [N]."""

    law: FrictionLaw
    """The friction law."""
    offset: float
    """Constant force that adds to friction [N]."""


def low_speed(v_max: float) -> float:
    """Return the largest speed of the second panel, a round number.

    Examples
    --------
    >>> low_speed(0.128)
    0.02
    """
    top = LOW * v_max
    power = 10.0 ** np.floor(np.log10(top))
    return float(power * max(step for step in (1, 2, 5) if step * power <= top * (1 + 1e-9)))


def draw_friction_map(
    velocity: Array,
    friction: Array,
    laws: Mapping[str, MapLaw],
    load: float,
    *,
    chosen: str,
    trend: Array | None = None,
    units: tuple[str, str] = ("m/s", "N"),
    low_speeds: bool = True,
) -> Draw:
    """Return a drawing of friction against velocity: points, and laws as curves.

    Where only one direction was measured, laws are drawn in that direction alone.
    """
    v_max = float(np.max(np.abs(velocity)))
    factor, unit = scale_of([v_max], units[0])
    curves = {name: _curve(law, load, 1.05 * v_max, _sides(velocity)) for name, law in laws.items()}
    look = looks(laws, chosen)
    low = low_speed(v_max)
    slow = np.abs(velocity) <= low
    spread = _is_spread(velocity)
    spans = [_span(velocity, spread)]
    turn = np.zeros(len(velocity)) if trend is None else np.asarray(trend)
    if low_speeds and not spread and int(slow.sum()) >= SLOW_POINTS and not slow.all():
        spans.append(_span(velocity[slow], spread=False))

    def draw(figure: Figure, narrow: bool) -> None:
        shape = (len(spans), 1) if narrow else (1, len(spans))
        ratios = None if narrow else [3, 2][: len(spans)]
        grid = figure.subplots(*shape, squeeze=False, width_ratios=ratios)
        for axes, (first, last) in zip(grid.flat, spans, strict=True):
            seen = (velocity >= first) & (velocity <= last)
            _points(axes, factor * velocity[seen], friction[seen], turn[seen])
            lines = _inside(curves, first, last, factor)
            for name, (v, force) in lines.items():
                colour, _, width, order = look[name]
                dashes = "-" if name == chosen else (0, (5, 2))
                axes.plot(v, force, color=colour, linestyle=dashes, linewidth=width, zorder=order)
            # Set the limits: a few points far out are cut off rather than flatten the rest.
            low, high = np.percentile(friction[seen], [OUTER, 100 - OUTER])
            forces = np.concatenate([[low, high, 0.0], *[force for _, force in lines.values()]])
            margin = 0.06 * max(float(np.ptp(forces)), 1e-12)
            axes.set_xscale("log" if spread else "linear")
            axes.set_xlim(*(factor * first, factor * last))
            axes.set_ylim(float(forces.min()) - margin, float(forces.max()) + margin)
            axes.axhline(0.0, color=theme.LINE, linewidth=0.8, zorder=0)
            if not spread:
                axes.locator_params(axis="x", nbins=7)
                axes.axvline(0.0, color=theme.LINE, linewidth=0.8, zorder=0)
            axes.set(xlabel=f"velocity, {unit}", ylabel=f"friction, {units[1]}")
        if low_speeds:
            grid.flat[0].set_title("all speeds", color=theme.MUTED)
        if np.any(turn):
            _say_trend(grid.flat[0])
        if len(spans) > 1:
            grid.flat[1].set_title(f"below {number(factor * low)} {unit}", color=theme.MUTED)
        points = np.column_stack([factor * velocity, friction])
        shown = {name: (factor * v, f) for name, (v, f) in curves.items()}
        if spread:
            shown = _inside(curves, *spans[0], factor)
        _names(grid.flat[0], shown, look, chosen, points[: SINGLE if len(points) <= SINGLE else 0])

    return draw


def _inside(
    curves: Mapping[str, tuple[Array, Array]], first: float, last: float, factor: float
) -> dict[str, tuple[Array, Array]]:
    """Return curves between two velocities, in the unit shown."""
    return {
        name: (factor * v[inside], force[inside])
        for name, (v, force) in curves.items()
        for inside in [(v >= first) & (v <= last)]
    }


def _sides(velocity: Array) -> tuple[bool, bool]:
    """Return whether slip backwards and forwards was measured; both if nothing slips."""
    back, ahead = (float(np.mean(sign * velocity > 0.0)) >= ONE_WAY for sign in (-1.0, 1.0))
    return (back, ahead) if back or ahead else (True, True)


def _curve(law: MapLaw, load: float, v_max: float, sides: tuple[bool, bool]) -> tuple[Array, Array]:
    """Return a curve in the directions that were measured; at rest each ends at break-away."""
    v, force = characteristic(law.law, load, v_max)
    middle = len(v) // 2  # of an even number: two are at rest, one for each direction
    kept = slice(0 if sides[0] else middle, len(v) if sides[1] else middle)
    return v[kept], force[kept] + law.offset


def _is_spread(velocity: Array) -> bool:
    """Return whether these are readings at speeds of several powers of ten, in one direction."""
    slowest, fastest = float(velocity.min()), float(velocity.max())
    return len(velocity) <= SINGLE and 0.0 < slowest <= fastest / SPREAD


def _span(velocity: Array, spread: bool) -> tuple[float, float]:
    """Return the ends of the horizontal axis; 0 is on it, unless it is logarithmic."""
    if spread:
        margin = float(velocity.max() / velocity.min()) ** 0.03
        return float(velocity.min()) / margin, float(velocity.max()) * margin
    low, high = min(float(velocity.min()), 0.0), max(float(velocity.max()), 0.0)
    margin = 0.03 * (high - low)
    return low - margin, high + margin


def _points(axes: Axes, velocity: Array, friction: Array, turn: Array) -> None:
    # the readings of a table are seen one by one, above the lines; samples of a record as a cloud
    few = len(velocity) <= SINGLE
    size, alpha, order = (6.0, 0.9, 5) if few else (2.5, 0.6, 1)
    for sign, (colour, marker) in TURNS.items():
        own = turn == sign
        axes.plot(
            velocity[own], friction[own], marker, color=colour, markersize=size, alpha=alpha,
            markeredgewidth=0, linestyle="none", zorder=order,
        )  # fmt: skip


def _say_trend(axes: Axes) -> None:
    """Name the two kinds of points above the panel, each in its colour."""
    for text, colour, at in (
        ("● speeding up", theme.C3, 0.62),
        ("▲ slowing down", theme.C4, 0.995),
    ):
        axes.annotate(
            text, (at, 1.0), xycoords="axes fraction", xytext=(0, 3),
            textcoords="offset points", ha="right", va="bottom", color=colour,
            fontsize=theme.name_size(),
        )  # fmt: skip


def _names(
    axes: Axes,
    curves: Mapping[str, tuple[Array, Array]],
    look: Mapping[str, LineStyle],
    chosen: str,
    points: Array,
) -> None:
    """Name the laws in the quadrants that friction leaves free; beside the curves if one-way."""
    low, high = axes.get_xlim()
    if min(-low, high) < 0.2 * (high - low):
        named = [Curve(v, f, name, look[name].colour) for name, (v, f) in curves.items()]
        at_rest = [] if axes.get_xscale() == "log" else [_upright(axes)]
        label_curves(axes, [*named, *at_rest], points=points)
        return
    bottom, top = axes.get_ylim()
    ordered = sorted(curves, key=lambda name: name != chosen)
    for name, side in zip(ordered, (1, -1), strict=False):
        marked = name == chosen and len(curves) > 1
        lines = wrapped((f"chosen: {name}" if marked else name).split(), WIDTH)
        text = "\n".join(line.replace(",", "") for line in lines)
        theme.label_at(
            axes, side * 0.03 * (high - low), 0.3 * (bottom if side > 0 else top), text,
            look[name].colour, offset=(0, 0), align="left" if side > 0 else "right",
        )  # fmt: skip


def _upright(axes: Axes) -> Curve:
    """Return the line at rest, which no name stands across, from far below to far above."""
    (low, high), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    tall = top - bottom
    ends = np.array([0.0, 1e-6 * (high - low)]), np.array([bottom - tall, top + tall])
    return Curve(*ends, "", theme.LINE)
