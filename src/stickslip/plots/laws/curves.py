"""Figures of laws alone: friction against velocity, and against displacement before slip."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.characterization import PreslidingLoop, presliding_length, presliding_loop
from stickslip.errors import InputError
from stickslip.formatting import number, scale_of
from stickslip.friction import FrictionLaw, Stribeck
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Target, on_axes, panel_grid
from stickslip.plots.core.helpers import Array, Sizes
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, INK, LINE, MUTED, label_at, symbol_label
from stickslip.quantities import Quantity

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
                    axes.plot(factor * v, force, color=LINE, linewidth=1.2, zorder=1)
            v, force = curves[title]
            colour = C1 if title == chosen else INK
            axes.plot(factor * v, force, color=colour, linewidth=2.0, zorder=3)
            axes.set_title(title, color=colour)
            axes.axhline(0, color=MUTED, linewidth=0.6, zorder=0)
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
            axes.plot(x, y, color=MUTED, linewidth=0.9, linestyle=(0, (4, 3)))
        axes.plot([0, 0], [0, f_s], color=C1, linewidth=2.2)
        axes.plot(factor * v, force, color=C1, linewidth=2.2)
        axes.plot([0], [f_s], "o", color=C1, markersize=5)
        axes.set_xlim(-0.02 * factor * v[-1], factor * v[-1])
        axes.set_ylim(0, 1.25 * f_s)
        axes.set_xlabel(f"velocity, {unit}")
        axes.set_ylabel("friction, N")
        static, coulomb, speed = map(symbol_label, ("F_s", "F_c", "v_s"))
        end, mark = factor * v[-1], factor * v_s
        label_at(axes, 0.0, f_s, f"{static} = {f_s:.2f} N, at rest up to this", INK, offset=(9, 6))
        label_at(axes, end, f_c, f"{coulomb} = {f_c:.2f} N", INK, offset=(0, -10), align="right")
        label_at(axes, mark, 0.0, f"{speed} = {number(mark)} {unit}", INK, offset=(6, 14))
        left = f"1/e of {static} − {coulomb} is left"
        label_at(axes, mark, at_v_s, left, MUTED, offset=(8, 6))

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
            _presliding(axes, loop, float(laws[title].break_away(load)))
            axes.set_title(title)
        for axes in panels[::columns]:
            axes.set_ylabel("friction, N")

    return draw


def _loop(law: FrictionLaw, load: float, amplitude: float | None) -> PreslidingLoop:
    return presliding_loop(law, amplitude or LENGTHS * presliding_length(law, load), load)


def _presliding(axes: Axes, loop: PreslidingLoop, level: float | None) -> None:
    """Draw a loop, and the break-away level where it is known."""
    factor, unit = scale_of(loop.displacement, "m")
    axes.plot(factor * loop.displacement, loop.friction, color=C1, linewidth=1.6)
    for side in () if level is None else (level, -level):
        axes.axhline(side, color=MUTED, linewidth=0.8, linestyle=(0, (4, 3)))
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
    label_at(axes, low, level, f"break-away {level:.3g} N", MUTED, offset=(4, 8))


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
    check_type("law", law, FrictionLaw)
    load = LOAD.check("plot_law", "load", load)
    speed = SPEED.check("plot_law", "speed", speed)
    draw = draw_characteristics({law.title: law}, load, speed)
    return on_axes(draw, ax, characteristic_sizes(4)["wide"])


def plot_presliding(
    loop: PreslidingLoop | FrictionLaw,
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
    check_type("loop", loop, PreslidingLoop, FrictionLaw)
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
        _presliding(axes, shown, level)
        axes.set_title(title)
        axes.set_ylabel("friction, N")

    return on_axes(draw, ax, characteristic_sizes(4)["wide"])
