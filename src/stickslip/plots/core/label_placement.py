"""Names beside curves: found a free place inside the plot, or stacked where the curves end."""

import re
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from stickslip.plots.core.helpers import Array
from stickslip.plots.core.theme import label_at, label_column, lay_out, pixel_of

LETTER: Final = 5.5
"""Mean width of a letter at 11 px [CSS px]; measured text would differ between machines."""
WIDEST: Final = 6.5
"""That of names with many wide letters, which then keep off what stands beside them."""
HALF_LINE: Final = 7.0
AWAY: Final = (11.0, 17.0, 25.0, 36.0)
"""Distances of a name from its curve that are tried [CSS px]."""
BESIDE: Final = 8.0
"""Distance of a name from its curve where it stands at its side [CSS px]."""
DOT: Final = 4.0
"""Half the size of a point with its surroundings [CSS px]."""
PLACES: Final = 36
"""Places along each curve that are tried."""
CROSSED: Final = 1e3
OUTSIDE: Final = 1e5


class Curve(NamedTuple):
    """A drawn curve and the name it wants; a curve without a name only stands in the way."""

    x: Array
    """Horizontal coordinates (n,), in the units of the axes."""
    y: Array
    """Vertical coordinates (n,), likewise."""
    text: str
    """Name to write beside the curve; empty if it has none."""
    colour: str
    """Colour of the name."""


class _Box(NamedTuple):
    left: float
    bottom: float
    right: float
    top: float

    def overlap(self, other: "_Box") -> float:
        """Return the shared area."""
        width = min(self.right, other.right) - max(self.left, other.left)
        height = min(self.top, other.top) - max(self.bottom, other.bottom)
        return max(width, 0.0) * max(height, 0.0)


def label_curves(axes: Axes, curves: Sequence[Curve], *, points: Array | None = None) -> None:
    """Write the name of each curve above or below it, where it is free and clearly meant.

    Names keep off points (n, 2) too. Set the limits of the axes before.
    """
    figure = axes.get_figure(root=True)
    if figure is None:
        return
    lay_out(figure)
    pixel = pixel_of(figure)
    frame = _Box(*(float(edge) * pixel for edge in axes.get_window_extent().extents))
    frame = frame._replace(left=frame.left + BESIDE)  # names do not stand on the axis
    drawn = [(curve, _in_pixels(axes, curve, pixel)) for curve in curves]
    drawn = [(curve, path) for curve, path in drawn if len(path)]  # others hide nothing
    paths = [path for _, path in drawn]
    taken = [
        _Box(*(float(edge) * pixel for edge in text.get_window_extent().extents))
        for text in axes.texts
    ]
    if points is not None:
        dots = axes.transData.transform(points) * pixel
        taken += [_Box(x - DOT, y - DOT, x + DOT, y + DOT) for x, y in dots.tolist()]
    for index, (curve, _) in enumerate(drawn):
        if not curve.text:
            continue
        half = WIDEST * _letters(curve.text) / 2
        tries = [
            (_cost(box, taken, paths, index, frame) + far, anchor, rank, box)
            for anchor in np.linspace(frame.left + 4, frame.right - 4, PLACES)
            for rank, (dx, dy, far) in enumerate(_shifts(half))
            for box in [_box(paths[index], float(anchor), dx, dy, half)]
        ]
        box = min(tries, key=lambda found: found[:3])[3]
        taken.append(box._replace(left=box.left - BESIDE / 2, right=box.right + BESIDE / 2))
        x, y = axes.transData.inverted().transform(
            ((box.left + box.right) / 2 / pixel, (box.bottom + box.top) / 2 / pixel)
        )
        name = label_at(axes, float(x), float(y), curve.text, curve.colour, offset=(0, 0),
                        align="center")  # fmt: skip
        name.set_in_layout(False)  # its place was found in the layout that is


def label_ends(
    axes: Axes,
    x: float,
    labels: Sequence[tuple[float, Sequence[str], str]],
) -> None:
    """Name curves where they end; a name may have several lines."""
    # Equal heights keep their order from below, so the last line goes first.
    rows = [(y, line, colour) for y, lines, colour in labels for line in reversed(lines)]
    label_column(axes, x, rows)


def _letters(text: str) -> int:
    r"""Count what is seen of a text; in mathtext a command is a letter, or only sets others.

    >>> _letters(r"A, $\mu_{\mathrm{k}}$ = 0.243")
    13
    """
    if "$" not in text:
        return len(text)
    letters = re.sub(r"\\[a-z]+", "x", re.sub(r"\\math[a-z]+", "", text))
    return len(re.sub(r"[${}_]", "", letters))


def _in_pixels(axes: Axes, curve: Curve, pixel: float) -> Array:
    points = axes.transData.transform(np.column_stack([curve.x, curve.y])) * pixel
    return np.asarray(points[np.isfinite(points).all(axis=1)])


def _height(path: Array, x: float) -> float:
    return float(np.interp(x, path[:, 0], path[:, 1]))


def _shifts(half: float) -> list[tuple[float, float, float]]:
    """Return the shifts of a name from a point of its curve, each with its price."""
    upright = [(0.0, side * away, away) for away in AWAY for side in (1.0, -1.0)]
    beside = [(side * (half + BESIDE), 0.0, AWAY[1]) for side in (-1.0, 1.0)]
    return upright + beside


def _box(path: Array, x: float, dx: float, dy: float, half: float) -> _Box:
    """Return the place of a name shifted from a point of its curve."""
    y = _height(path, x) + dy
    return _Box(x + dx - half, y - HALF_LINE, x + dx + half, y + HALF_LINE)


def _cost(box: _Box, taken: Sequence[_Box], paths: Sequence[Array], own: int, frame: _Box) -> float:
    cost = 0.0
    if box.left < frame.left or box.right > frame.right:
        cost += OUTSIDE
    if box.bottom < frame.bottom or box.top > frame.top + 2 * HALF_LINE:
        cost += OUTSIDE
    cost += CROSSED * sum(box.overlap(other) for other in taken)
    middle = (box.bottom + box.top) / 2
    # Its neighbours too: a name beside a steep curve is near it only at one end.
    columns = np.linspace(box.left - BESIDE, box.right + BESIDE, 17)
    own_heights = np.interp(columns, paths[own][:, 0], paths[own][:, 1])
    reach = float(np.min(np.abs(own_heights - middle)))
    for index, path in enumerate(paths):
        heights = np.interp(columns, path[:, 0], path[:, 1])
        inner = heights[1:-1]
        # Between two columns a steep curve may run through the whole name.
        highest, lowest = np.maximum(inner[1:], inner[:-1]), np.minimum(inner[1:], inner[:-1])
        cost += CROSSED * int(np.sum((highest > box.bottom - 1) & (lowest < box.top + 1)))
        if index != own:
            # A name is read as that of the nearest curve, so no other may be as near.
            distance = float(np.min(np.abs(heights - middle)))
            cost += 40.0 * max(0.0, 2.2 * max(reach, AWAY[0]) - distance)
    return cost
