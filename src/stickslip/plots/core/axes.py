"""Drawings on the user's axes: `plot_*` functions are drawings of this package put there."""

from collections.abc import Sequence
from typing import Any, Final, TypeAlias, cast

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.plots.core import theme
from stickslip.plots.core.svg import Draw, Size

Panels: TypeAlias = NDArray[np.object_]
"""Axes (n,) in the order of reading."""
Target: TypeAlias = Axes | Figure | SubFigure | None
"""Where a plot of one panel is drawn."""
PanelTarget: TypeAlias = Axes | Figure | SubFigure | Sequence[Axes] | Panels | None
"""Where a plot of several panels is drawn."""

PER_INCH: Final = 88
"""CSS pixels of a page per inch of a new figure: the widest ones are 10 inches."""
OVERHANG: Final = 1.15
"""Height of a label over that of its panel, up to which it keeps off its neighbours."""
LEAST_LABEL: Final = 6.0
"""Size of letters to which labels of very low panels shrink [pt]."""
NARROW_BELOW: Final = 500
"""Width of axes [CSS px] below which curves are named inside them."""


def on_panels(draw: Draw, ax: PanelTarget, size: Size) -> Panels:
    """Draw on given axes, into a given figure, or into a new figure of pyplot.

    Examples
    --------
    >>> figure = Figure()
    >>> upper, lower = figure.subplots(2)
    >>> draw = lambda figure, narrow: [axes.plot([0, 1]) for axes in figure.subplots(2)]
    >>> [*on_panels(draw, [upper, lower], (880, 300))] == [upper, lower]
    True
    """
    if ax is None:
        from matplotlib import pyplot as plt

        # loads the backend: that of a notebook sets that figures are shown after each cell, which
        # would be taken back with the style
        plt.draw_if_interactive()  # type: ignore[no-untyped-call]  # of matplotlib
        settings = mpl.rcParams  # the user's: the house style counts in CSS pixels
        dpi, inches = settings["figure.dpi"], tuple(settings["figure.figsize"])
        if inches == tuple(mpl.rcParamsDefault["figure.figsize"]):
            inches = (size[0] / PER_INCH, size[1] / PER_INCH)
        width = 72 * inches[0]
        with theme.readers_style(width) as own:
            paper = own.get("figure.facecolor", theme.SURFACE)
            new = plt.figure(figsize=inches, dpi=dpi, layout="constrained", facecolor=paper)
            try:
                panels = _drawn(draw, new, None, narrow=width < NARROW_BELOW)
                new.draw_without_rendering()  # makes the ticks, in this style
                theme.restyle(new.findobj(), own)
                _fit_labels(panels)
            except BaseException:
                plt.close(new)
                raise
        return panels
    figure: Figure | SubFigure
    given: list[Axes] | None
    if isinstance(ax, Figure | SubFigure):
        figure, given, width = ax, None, ax.bbox.width
    else:
        given = _axes_of(ax)
        figure = cast("Figure", given[0].get_figure(root=True))
        width = min(one.get_window_extent().width for one in given)
    before = {artist for one in given or () for artist in one.findobj()}
    points = width * 72 / figure.dpi
    with theme.readers_style(points if given is None else None) as own:
        panels = _drawn(draw, figure, given, narrow=points < NARROW_BELOW)
        after = {artist for one in (*panels, *figure.legends) for artist in one.findobj()}
        theme.restyle(after - before, own)
        return panels


def on_axes(draw: Draw, ax: PanelTarget, size: Size) -> Axes:
    """Draw what has a single panel, as `on_panels` does.

    Examples
    --------
    >>> axes = Figure().add_subplot()
    >>> on_axes(lambda figure, narrow: figure.add_subplot().plot([0, 1]), axes, (9, 3)) is axes
    True
    """
    (axes,) = on_panels(draw, ax, size)
    return cast("Axes", axes)


def panel_grid(figure: Figure, count: int, columns: int, **layout: Any) -> list[Axes]:
    """Return so many panels in rows, in the order of reading; what the last row lacks is hidden."""
    grid = figure.subplots(-(-count // columns), columns, squeeze=False, **layout)
    panels = list(grid.flat)
    for axes in panels[count:]:
        axes.set_visible(False)
    return panels[:count]


def _axes_of(ax: object) -> list[Axes]:
    """Return the axes that were given, in one list."""
    found = [ax] if isinstance(ax, Axes) else list(np.ravel(np.asarray(ax, dtype=object)))
    if not found or not all(isinstance(one, Axes) for one in found):
        raise InputError(
            "ax must be matplotlib Axes, a sequence of Axes for several panels, or a Figure, got"
            f" {ax!r}."
        )
    axes = cast("list[Axes]", found)
    if any(one.get_figure(root=True) is None for one in axes):
        raise InputError("ax was removed from its figure; give axes that belong to one.")
    return axes


def _drawn(
    draw: Draw, figure: Figure | SubFigure, given: list[Axes] | None, *, narrow: bool
) -> Panels:
    stage = _Stage(figure, given)
    draw(cast("Figure", stage), narrow)
    if given is not None and len(stage.panels) != len(given):
        raise _miscounted(len(stage.panels), len(given))
    shown = [axes for axes in stage.panels if axes.get_visible()]
    panels = np.empty(len(shown), dtype=object)
    panels[:] = shown
    return panels


def _fit_labels(panels: Panels) -> None:
    """Break and shrink labels of vertical axes that are longer than their panels."""
    for axes in panels:
        label = axes.yaxis.label
        room = OVERHANG * axes.get_window_extent().height
        if label.get_window_extent().height > room:
            label.set_text(label.get_text().replace(", ", ",\n", 1))
        longest = label.get_window_extent().height
        if longest > room:
            label.set_fontsize(max(label.get_fontsize() * room / longest, LEAST_LABEL))


def _miscounted(wanted: int, got: int) -> InputError:
    what = "one Axes" if wanted == 1 else f"a sequence of {wanted} Axes"
    panels = "1 panel" if wanted == 1 else f"{wanted} panels"
    return InputError(f"this plot has {panels}: ax must be {what} or a Figure, got {got} Axes.")


class _Stage:
    """Stands in for the figure of a drawing: gives out the axes of the user, or new ones.

    Drawings ask a figure for axes and for little else; what else they ask goes to the figure that
    the axes are in.
    """

    def __init__(self, figure: Figure | SubFigure, given: list[Axes] | None) -> None:
        self.figure = figure
        self.given = given
        self.panels: list[Axes] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self.figure, name)

    def add_subplot(self, *place: Any, **layout: Any) -> Axes:
        """Return the next panel."""
        if self.given is None:
            self.panels.append(self.figure.add_subplot(*place, **layout))
        else:
            count = len(self.panels) + 1
            if count > len(self.given):
                raise _miscounted(count, len(self.given))
            self.panels.append(self.given[count - 1])
        return self.panels[-1]

    def subplots(
        self, rows: int = 1, columns: int = 1, *, squeeze: bool = True, **layout: Any
    ) -> Any:
        """Return a grid of panels; there must be as many as were given."""
        if self.given is None:
            grid = self.figure.subplots(rows, columns, squeeze=False, **layout)
        else:
            grid = np.empty((rows, columns), dtype=object)
            grid.flat[:] = self._all(rows * columns)
        self.panels += grid.flat
        if not squeeze:
            return grid
        return grid.item() if grid.size == 1 else grid.squeeze()

    def subplot_mosaic(self, mosaic: str, **layout: Any) -> dict[str, Axes]:
        """Return panels by letter, those of the mosaic in the order of reading."""
        if self.given is None:
            found = self.figure.subplot_mosaic(mosaic, **layout)
        else:
            letters = list(dict.fromkeys(letter for letter in mosaic if letter != ";"))
            found = dict(zip(letters, self._all(len(letters)), strict=True))
        self.panels += found.values()
        return found

    def _all(self, count: int) -> list[Axes]:
        given = self.given or []
        if len(given) != count:
            raise _miscounted(count, len(given))
        return given
