"""Where scene, time plots and the key of the arrows stand in an animation."""

from collections.abc import Mapping, Sequence
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.plots.animation.scenes.bounding_boxes import Scales, nice
from stickslip.plots.animation.scenes.renderer import ROLE_COLOURS
from stickslip.plots.animation.scenes.shapes import Arrow, Picture, Role, Shape, Turn
from stickslip.plots.core.theme import INK, MUTED

NAMES: Final[Mapping[Role, str]] = {
    "friction": "friction",
    "normal": "normal force",
    "drive": "drive",
}
LETTER: Final = 6.4
"""Width of a letter of the key [CSS px]."""
EDGE, TITLE, KEY, AXIS, LABEL, GAP = 14.0, 26.0, 62.0, 44.0, 72.0, 18.0
"""Margins [CSS px]: around all, above a scene, below it, below and left of time plots, between."""


def layout(figure: Figure, *, narrow: bool, flat: bool) -> tuple[Axes, list[Axes]]:
    """Return the axes of the scene and of three time plots.

    They stand beside each other where the scene is high, else one above the other; all places are
    given in pixels, so that they do not move from frame to frame.
    """
    figure.set_layout_engine("none")
    width, height = (72.0 * inches for inches in figure.get_size_inches())
    if narrow:
        low = 0.52 * height if not flat else 0.62 * height
        scene = (EDGE, low + KEY, width - EDGE, height - TITLE)
        panels = _stacked(LABEL, AXIS, width - EDGE, low - 0.4 * GAP)
    elif flat:
        low = 0.44 * height
        scene = (EDGE, low + KEY, width - EDGE, height - TITLE)
        each = (width - EDGE) / 3
        panels = [(i * each + LABEL, AXIS, (i + 1) * each, low - GAP) for i in range(3)]
    else:
        scene = (EDGE, KEY, 0.53 * width, height - TITLE)
        panels = _stacked(0.53 * width + LABEL, AXIS, width - EDGE, height - EDGE)
    axes, *plots = (
        figure.add_axes(((l / width), b / height, (r - l) / width, (t - b) / height))
        for l, b, r, t in (scene, *panels)  # noqa: E741  # left, bottom, right, top
    )
    axes.spines[:].set_visible(False)
    axes.set_yticks([])
    for plot in plots[1:]:
        plot.sharex(plots[0])
    return axes, plots


Place = tuple[float, float, float, float]


def _stacked(left: float, bottom: float, right: float, top: float) -> list[Place]:
    """Return three places one below the other."""
    each = (top - bottom + GAP) / 3
    return [(left, bottom + i * each, right, bottom + (i + 1) * each - GAP) for i in (2, 1, 0)]


def write_legend(
    axes: Axes, picture: Picture, shown: Sequence[Sequence[Shape]], scales: Scales
) -> None:
    """Say below a scene, whose limits are set, what its arrows are and how long they are."""
    kinds = {
        s.role: type(s)
        for shapes in shown
        for s in shapes
        if isinstance(s, (Arrow, Turn)) and _seen(s, scales)
    }
    names = {**NAMES, **(picture.names or {})}
    x = 0.0
    for role, colour in ROLE_COLOURS.items():
        if role in kinds:
            _write(axes, x, -34.0, names[role], colour)
            x += LETTER * (len(names[role]) + 2)
    x = 0.0
    if Arrow in kinds.values() and scales.metres:
        x = _bar(axes, scales)
    if Turn in kinds.values():
        _write(axes, x, -52.0, f"¼ of a turn is {scales.torque:.2g} N m", MUTED)


def _bar(axes: Axes, scales: Scales) -> float:
    """Draw the length of a round force; return where it ends [CSS px]."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    force = nice(0.25 * min(right - left, high - low) / scales.metres)
    share = force * scales.metres / (right - left)
    figure = axes.get_figure(root=True)
    wide = 72.0 * axes.get_window_extent().width / (figure.dpi if figure else 72.0)
    height = -52.0 / (wide * (high - low) / (right - left))
    axes.plot(
        [0.0, share], [height, height], transform=axes.transAxes, color=INK, linewidth=2.0,
        clip_on=False, gid="force-scale", solid_capstyle="butt",
    )  # fmt: skip
    text = f"{force:g} N"
    _write(axes, share * wide + 6.0, -52.0, text, MUTED)
    return share * wide + 6.0 + LETTER * (len(text) + 3)


def _write(axes: Axes, x: float, y: float, text: str, colour: str) -> None:
    axes.annotate(
        text,
        (0.0, 0.0),
        xycoords="axes fraction",
        xytext=(x, y),
        textcoords="offset points",
        va="center",
        color=colour,
        fontsize=11,
        annotation_clip=False,
    )


def _seen(shape: Arrow | Turn, scales: Scales) -> bool:
    return abs(shape.value) > (0.01 * scales.torque if isinstance(shape, Turn) else 0.0)
