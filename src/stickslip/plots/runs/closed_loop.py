"""A run in closed loop: where the body is, and what the controller makes of it."""

from collections.abc import Callable
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.control import ClosedLoop
from stickslip.formatting import scale_of
from stickslip.plots.core.arguments import check_type
from stickslip.plots.core.axes import Panels, PanelTarget, on_panels
from stickslip.plots.core.helpers import Sizes, coordinate_name, dense, thinned
from stickslip.plots.core.label_placement import Curve, label_curves
from stickslip.plots.core.svg import Draw
from stickslip.plots.core.theme import C1, C2, C3, C4, MUTED, shade
from stickslip.trajectory import Trajectory

LOOP_SIZES: Final = Sizes(wide=(880, 380), narrow=(358, 420))
"""Sizes of the figure."""
SHORTEST: Final = 1e-3
"""Share of the time shown that a rest must last to be shaded."""
DASHED: Final = (0, (5, 2))
SAMPLES: Final = 1200
COMMANDS: Final = (C3, C4, C1, C2)
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
    run = dense(loop.run, samples=SAMPLES)
    seen = run.at(run.t[run.t >= since])
    last = float(seen.t[-1])
    rests = [
        (max(a, since), b)
        for a, b in _seen_along(loop, state).stick_spans()
        if b - max(a, since) > SHORTEST * (last - since)
    ]

    def draw(figure: Figure, narrow: bool) -> None:  # noqa: ARG001
        above, below = figure.subplots(2, 1, sharex=True)
        for axes in (above, below):
            shade(axes, rests)
            axes.set_xlim(since, last)
            axes.margins(x=0.0, y=0.18)
        _place(above, seen, state, reference)
        _command(below, loop, since, last, level)
        below.set_title(f"command, {unit}", color=MUTED)
        below.set_xlabel("time, s (shaded: at rest)")

    return draw


def _seen_along(loop: ClosedLoop, state: str) -> Trajectory:
    """Return the run as the contact along a state sees it, or else the first."""
    run, coordinates = loop.run, loop.mechanism.coordinates
    if not run.contacts:
        return run
    along = dict(zip(loop.mechanism.rates, coordinates, strict=True)).get(state, state)
    slips = {one.name: one.slips for one in loop.mechanism.contacts() if one.name in run.contacts}
    own = [name for name, among in slips.items() if along in among]
    return run.contact((own or list(slips))[0])


def _place(
    axes: Axes, seen: Trajectory, state: str, reference: float | Callable[[float], float] | None
) -> None:
    """Draw the state, and where it should be."""
    factor, unit = scale_of(seen[state], seen.units[state])
    curves = [Curve(seen.t, factor * seen[state], state, C1)]
    axes.plot(seen.t, curves[0].y, color=C1, zorder=3)
    if reference is not None:
        wanted = [reference(t) if callable(reference) else reference for t in seen.t]
        curves.append(Curve(seen.t, factor * np.array(wanted), "reference", C2))
        axes.plot(seen.t, curves[-1].y, color=C2, linestyle=DASHED, linewidth=1.2, zorder=2)
    axes.set_title(f"{state}, {unit}", color=MUTED)
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
            axes.axhline(side * level, color=MUTED, linestyle=DASHED, linewidth=1.0)
        curves.append(Curve(np.array([since, last]), np.full(2, level), "break-away", MUTED))
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
    >>> from stickslip.control import PID, closed_loop
    >>> law = Coulomb(kinetic_coefficient=1.0)
    >>> control = PID(proportional=100.0, derivative=10.0, reference=0.1)
    >>> loop = closed_loop(Axis(inertia=1.0), law, control, period=1e-2, t_end=1.0)
    >>> [axes.get_title("left") for axes in plot_closed_loop(loop, Figure())]
    ['x, m', 'command, N']
    """
    check_type("loop", loop, ClosedLoop)
    draw = draw_closed_loop(
        loop, state=coordinate_name(loop.run, state), reference=reference, level=level, since=since,
        unit=unit,
    )  # fmt: skip
    return on_panels(draw, ax, LOOP_SIZES["wide"])
